//! Drawn encounters as Parquet.
//!
//! | file | one row | columns |
//! |---|---|---|
//! | obstacles around a line | an obstacle at t = 0 | those of the CSV file, with `kind` |
//! | aircraft with tracks | an aircraft at a time | those below |
//!
//! Rows of an encounter stand together, and within it rows of an aircraft; the first aircraft is the
//! ownship. The reader finds columns by name; it does without `seed`, `weight` and `kind`.

use alloc::sync::Arc;
use std::io::Write;

use fga_formats::build;
use fga_formats::daa::Recording;
use fga_formats::encounters::{self, Encounter};
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::{DrawnContent, Origin};
use crate::values::{columns, put};

/// Columns of the tracks: each as in the schema, and behind the semicolon its meaning.
pub(super) const TRACK_COLUMNS: &str = "
    required int64 encounter (INTEGER(64,false)); number of the encounter
    required int64 seed (INTEGER(64,false)); its master seed
    required double weight; for how many encounters of its source it stands
    required binary aircraft (STRING); name; the first of an encounter is the ownship
    required double t_s; time, s
    required double x_m; position to the east, m
    required double y_m; position to the north, m
    required double z_m; altitude, m
    required double vx_mps; velocity over the ground to the east, m/s
    required double vy_mps; to the north, m/s
    required double vz_mps; up, m/s
    required double east_sigma_m; standard deviation of the position to the east, m
    required double north_sigma_m; to the north, m
    required double east_north_sigma_m; east and north together, signed, m
    required double up_sigma_m; of the altitude, m
    required double east_sigma_mps; standard deviation of the velocity to the east, m/s
    required double north_sigma_mps; to the north, m/s
    required double east_north_sigma_mps; east and north together, signed, m/s
    required double up_sigma_mps; of the climb, m/s
    optional double air_vx_mps; velocity through the air to the east, m/s; empty where it is not known
    optional double air_vy_mps; to the north, m/s
";

/// Velocity through the air, the only columns with empty fields.
pub(super) const AIR: [&str; 2] = ["air_vx_mps", "air_vy_mps"];

/// Columns of tracks before the deviations, and before the velocity through the air.
pub(super) const DEVIATIONS_FROM: usize = 11;
pub(super) const AIR_FROM: usize = 19;

/// Columns of obstacles around a line, in the same way.
pub(super) const ROW_COLUMNS: &str = "
    required int64 encounter (INTEGER(64,false)); number of the encounter
    required int64 obstacle (INTEGER(64,false)); number of the obstacle in it
    required double x_m; position at t = 0 ahead of the ownship, m
    required double y_m; to its left, m
    required double z_m; above it, m
    required double vx_mps; velocity over the ground along the ownship's line, m/s
    required double vy_mps; to its left, m/s
    required double vz_mps; up, m/s
    required double radius_m; radius of the protected volume, m
    required binary kind (STRING); how it may move: still, straight, aircraft or uas
";

/// Rows in a group: some ten megabytes in memory.
const GROUP: usize = 100_000;

/// Writes encounters of one kind.
pub struct DrawnWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
    wholes: Vec<Vec<i64>>,
    weights: Vec<f64>,
    numbers: Vec<Vec<f64>>,
    air: Vec<Option<[f64; 2]>>,
    texts: Vec<ByteArray>,
    content: DrawnContent,
}

impl<W: Write + Send> DrawnWriter<W> {
    /// Begins a file for encounters of this kind.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn new(output: W, content: DrawnContent) -> Result<Self, ParquetError> {
        let table = match content {
            DrawnContent::Rows => ROW_COLUMNS,
            DrawnContent::Tracks => TRACK_COLUMNS,
        };
        let schema: Vec<&str> = columns(table).map(|(column, ..)| column).collect();
        let words: serde_json::Map<_, _> = columns(table)
            .map(|(_, name, meaning)| (name.to_owned(), meaning.into()))
            .collect();
        let properties = WriterProperties::builder()
            .set_created_by(format!("fga {}", env!("CARGO_PKG_VERSION")))
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(vec![
                KeyValue::new("fga.commit".to_owned(), build::commit().to_owned()),
                KeyValue::new(
                    "fga.columns".to_owned(),
                    serde_json::Value::Object(words).to_string(),
                ),
            ]));
        let schema = parse_message_type(&format!("message encounters {{{};}}", schema.join(";")))?;
        Ok(Self {
            file: SerializedFileWriter::new(output, schema.into(), Arc::new(properties.build()))?,
            wholes: vec![Vec::new(); 2],
            weights: Vec::new(),
            numbers: vec![Vec::new(); AIR_FROM - 4],
            air: Vec::new(),
            texts: Vec::new(),
            content,
        })
    }

    /// Adds obstacles around a line.
    ///
    /// # Errors
    /// Errors of the output; a movement that has no word.
    pub fn push_rows(&mut self, encounter: &Encounter) -> Result<(), ParquetError> {
        for obstacle in &encounter.obstacles {
            let kind = encounters::kind_of(obstacle.movement).ok_or_else(|| {
                ParquetError::General("an obstacle's movement has no word".into())
            })?;
            self.wholes[0].push(encounter.id.cast_signed());
            self.wholes[1].push(i64::from(obstacle.id));
            let (p, v) = (obstacle.position_m, obstacle.velocity_mps);
            let values = [p.x, p.y, p.z, v.x, v.y, v.z, obstacle.volume.radius_m()];
            for (column, value) in self.numbers.iter_mut().zip(values) {
                column.push(value);
            }
            self.texts.push(ByteArray::from(kind));
        }
        self.flush_if(GROUP)
    }

    /// Adds aircraft with tracks.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn push_tracks(
        &mut self,
        recording: &Recording,
        origin: &Origin,
    ) -> Result<(), ParquetError> {
        for track in &recording.aircraft {
            let name = ByteArray::from(track.name.as_str());
            for sample in &track.samples {
                self.wholes[0].push(origin.number.unwrap_or(0).cast_signed());
                self.wholes[1].push(origin.seed.unwrap_or(0).cast_signed());
                self.weights.push(origin.weight);
                self.texts.push(name.clone());
                let (p, v) = (sample.position_m, sample.velocity_mps);
                let values = [sample.time_s, p.x, p.y, p.z, v.x, v.y, v.z];
                let values = values.into_iter().chain(sample.deviation.to_array());
                for (column, value) in self.numbers.iter_mut().zip(values) {
                    column.push(value);
                }
                self.air.push(sample.air_mps.map(|air| [air.x, air.y]));
            }
        }
        self.flush_if(GROUP)
    }

    fn flush_if(&mut self, rows: usize) -> Result<(), ParquetError> {
        if self.texts.len() < rows {
            return Ok(());
        }
        let mut group = self.file.next_row_group()?;
        for column in &self.wholes {
            put::<W, Int64Type>(&mut group, column, None)?;
        }
        if self.content == DrawnContent::Tracks {
            put::<W, DoubleType>(&mut group, &self.weights, None)?;
            put::<W, ByteArrayType>(&mut group, &self.texts, None)?;
        }
        for column in self.numbers.iter().filter(|column| !column.is_empty()) {
            put::<W, DoubleType>(&mut group, column, None)?;
        }
        if self.content == DrawnContent::Rows {
            put::<W, ByteArrayType>(&mut group, &self.texts, None)?;
        } else {
            let air = &self.air;
            let levels: Vec<i16> = air.iter().map(|air| i16::from(air.is_some())).collect();
            for axis in 0..2 {
                let values: Vec<f64> = air.iter().flatten().map(|air| air[axis]).collect();
                put::<W, DoubleType>(&mut group, &values, Some(&levels))?;
            }
        }
        group.close()?;
        self.wholes.iter_mut().for_each(Vec::clear);
        self.numbers.iter_mut().for_each(Vec::clear);
        self.air.clear();
        self.weights.clear();
        self.texts.clear();
        Ok(())
    }

    /// Finishes the file and returns the output.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn finish(mut self) -> Result<W, ParquetError> {
        self.flush_if(1)?;
        self.file.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use fga::Vec3;
    use fga::situation::{Obstacle, ProtectedVolume};
    use fga_alerts::Deviation;
    use fga_formats::InputError;
    use fga_formats::daa::{Track, TrackSample};

    use super::*;
    use crate::drawn::read::{content, rows, tracks};

    fn recording(weight: f64) -> Recording {
        let track = |name: &str, along_mps: f64| Track {
            name: name.into(),
            samples: (0..3)
                .map(|second| TrackSample {
                    // The wind is not known at every time.
                    air_mps: (second != 1).then_some(Vec3::new(along_mps - 0.1, 1.0 / 7.0, 0.0)),
                    deviation: Deviation {
                        east_north_mps: -1.0 / 3.0,
                        up_m: f64::from(second),
                        ..Deviation::default()
                    },
                    ..TrackSample::new(
                        0.1 + f64::from(second),
                        Vec3::new(along_mps * f64::from(second), 1.0 / 3.0, 7.0),
                        Vec3::X * along_mps,
                    )
                })
                .collect(),
        };
        let mut recording = Recording {
            aircraft: vec![track("own", 40.0), track("its", -50.0)],
            frame: None,
            parameters: Vec::new(),
            tally: fga_formats::tally::Tally::default(),
        };
        let origin = Origin {
            number: Some(3),
            seed: Some(9),
            weight,
        };
        origin.mark(&mut recording);
        recording
    }

    fn table(recordings: &[Recording]) -> Vec<u8> {
        let mut writer = DrawnWriter::new(Vec::new(), DrawnContent::Tracks).unwrap();
        for recording in recordings {
            let origin = Origin::of(recording).unwrap();
            writer.push_tracks(recording, &origin).unwrap();
        }
        writer.finish().unwrap()
    }

    #[test]
    fn tracks_are_read_back_as_written() {
        let written = recording(1.0 / 7.0);
        let path = Path::new("t.parquet");
        let read = tracks(table(core::slice::from_ref(&written)), path).unwrap();
        assert_eq!((read.named.len(), read.tally.read()), (1, 6));
        assert_eq!(read.named[0].recording, written);
        assert_eq!(
            content(table(&[written]), path).unwrap(),
            DrawnContent::Tracks
        );
    }

    #[test]
    fn an_encounter_in_two_places_and_times_that_go_back_are_refused() {
        let path = Path::new("t.parquet");
        let mut other = recording(1.0);
        Origin {
            number: Some(4),
            seed: None,
            weight: 1.0,
        }
        .mark(&mut other);
        let said = tracks(
            table(&[recording(1.0), other.clone(), recording(1.0)]),
            path,
        );
        let said = said.unwrap_err().to_string();
        assert!(said.contains("encounter 3 stands in two places"), "{said}");
        other.aircraft[1].samples[2].time_s = 0.5;
        let said = tracks(table(core::slice::from_ref(&other)), path);
        let said = said.unwrap_err().to_string();
        assert!(
            said.contains("encounter 4, aircraft \"its\": the time goes from 1.1 s to 0.5 s"),
            "{said}"
        );
        other.aircraft[1].samples[2].time_s = 5.0;
        other.aircraft[1].samples[2].deviation.up_m = -1.0;
        let said = tracks(table(core::slice::from_ref(&other)), path);
        let said = said.unwrap_err().to_string();
        assert!(
            said.contains("column up_sigma_m holds -1, expected a deviation of 0 or more"),
            "{said}"
        );
        let said = tracks(b"PAR1".to_vec(), path).unwrap_err().to_string();
        assert!(said.contains("is no readable Parquet file"), "{said}");
    }

    #[test]
    fn obstacles_around_a_line_are_read_back_as_written() {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let place = Vec3::new(1.0 / 3.0, -2.0, 5.0);
        let written = Encounter {
            id: 12,
            obstacles: vec![Obstacle::straight(4, place, Vec3::X * -0.7, volume)],
        };
        let mut writer = DrawnWriter::new(Vec::new(), DrawnContent::Rows).unwrap();
        writer.push_rows(&written).unwrap();
        let bytes = writer.finish().unwrap();
        let path = Path::new("e.parquet");
        assert_eq!(content(bytes.clone(), path).unwrap(), DrawnContent::Rows);
        assert_eq!(rows(bytes, path).unwrap(), [written]);
    }

    /// Every byte of a good file changed in turn, and the file cut there: read, or refused in one sentence. A panic
    /// of the crate `parquet` would fail this test.
    #[test]
    fn l14_no_corrupt_table_makes_a_reader_panic() {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let mut writer = DrawnWriter::new(Vec::new(), DrawnContent::Rows).unwrap();
        for id in 0..20 {
            let obstacle = Obstacle::straight(4, Vec3::X * 700.0, Vec3::X * -0.7, volume);
            let obstacles = vec![obstacle];
            writer.push_rows(&Encounter { id, obstacles }).unwrap();
        }
        let path = Path::new("e.parquet");
        let sentence = |error: InputError| {
            let said = error.to_string();
            assert!(
                said.starts_with("e.parquet: ") && !said.contains('\n'),
                "{said}"
            );
        };
        for good in [writer.finish().unwrap(), table(&[recording(1.0)])] {
            let refused = |bytes: Vec<u8>| {
                let _ = content(bytes.clone(), path).map_err(sentence);
                let _ = rows(bytes.clone(), path).map_err(sentence);
                tracks(bytes, path).map_err(sentence).is_err()
            };
            let mut damaged = 0;
            for at in 0..good.len() {
                for byte in [0xff, good[at] ^ 0x01, good[at] ^ 0x80] {
                    let mut bytes = good.clone();
                    bytes[at] = byte;
                    damaged += u32::from(refused(bytes));
                }
                assert!(refused(good[..at].to_vec()));
            }
            assert!(damaged > 1000, "{damaged}");
        }
    }
}

//! Drawn encounters as Parquet.
//!
//! | file | one row | columns |
//! |---|---|---|
//! | obstacles around a line | an obstacle at t = 0 | those of the CSV file, with `kind` |
//! | aircraft with tracks | an aircraft at a time | [`TRACK_COLUMNS`] |
//!
//! Rows of an encounter stand together, and within it rows of an aircraft; the first aircraft is the
//! ownship. The reader finds columns by name; it does without `seed`, `weight` and `kind`.

use alloc::sync::Arc;
use core::fmt::Write as _;
use std::io::Write;
use std::path::Path;

use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_alerts::Deviation;
use fga_formats::InputError;
use fga_formats::daa::{Recording, Track, TrackSample};
use fga_formats::encounters::{self, Encounter};
use fga_formats::error::shown;
use fga_formats::recordings::Named;
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use super::columns::{Group, Table};
use super::{Content, Origin};

/// Columns of the tracks, with their meanings.
pub const TRACK_COLUMNS: [(&str, &str); 21] = [
    ("encounter", "number of the encounter"),
    ("seed", "its master seed"),
    ("weight", "for how many encounters of its source it stands"),
    ("aircraft", "name; the first of an encounter is the ownship"),
    ("t_s", "time, s"),
    ("x_m", "position to the east, m"),
    ("y_m", "position to the north, m"),
    ("z_m", "altitude, m"),
    ("vx_mps", "velocity over the ground to the east, m/s"),
    ("vy_mps", "to the north, m/s"),
    ("vz_mps", "up, m/s"),
    (
        "east_sigma_m",
        "standard deviation of the position to the east, m",
    ),
    ("north_sigma_m", "to the north, m"),
    ("east_north_sigma_m", "east and north together, signed, m"),
    ("up_sigma_m", "of the altitude, m"),
    (
        "east_sigma_mps",
        "standard deviation of the velocity to the east, m/s",
    ),
    ("north_sigma_mps", "to the north, m/s"),
    (
        "east_north_sigma_mps",
        "east and north together, signed, m/s",
    ),
    ("up_sigma_mps", "of the climb, m/s"),
    (
        AIR[0],
        "velocity through the air to the east, m/s; empty where it is not known",
    ),
    (AIR[1], "to the north, m/s"),
];

/// Velocity through the air, the only columns with empty fields.
const AIR: [&str; 2] = ["air_vx_mps", "air_vy_mps"];

/// Columns of tracks before the deviations, and before the velocity through the air.
const DEVIATIONS_FROM: usize = 11;
const AIR_FROM: usize = 19;

/// Columns of obstacles around a line, with their meanings.
pub const ROW_COLUMNS: [(&str, &str); 10] = [
    ("encounter", "number of the encounter"),
    ("obstacle", "number of the obstacle in it"),
    ("x_m", "position at t = 0 ahead of the ownship, m"),
    ("y_m", "to its left, m"),
    ("z_m", "above it, m"),
    (
        "vx_mps",
        "velocity over the ground along the ownship's line, m/s",
    ),
    ("vy_mps", "to its left, m/s"),
    ("vz_mps", "up, m/s"),
    ("radius_m", "radius of the protected volume, m"),
    ("kind", "how it may move: still, straight, aircraft or uas"),
];

/// Rows in a group: some ten megabytes in memory.
const GROUP: usize = 100_000;

/// The largest plausible position and time, metres and seconds, and speed, metres per second.
const LARGEST: f64 = 1e11;
const LARGEST_SPEED_MPS: f64 = 5000.0;

/// Writes encounters of one kind.
pub struct TableWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
    wholes: Vec<Vec<i64>>,
    weights: Vec<f64>,
    numbers: Vec<Vec<f64>>,
    air: Vec<Option<[f64; 2]>>,
    texts: Vec<ByteArray>,
    content: Content,
}

impl<W: Write + Send> TableWriter<W> {
    /// Begins a file for encounters of this kind.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn new(output: W, content: Content) -> Result<Self, ParquetError> {
        let columns: &[(&str, &str)] = match content {
            Content::Rows => &ROW_COLUMNS,
            Content::Tracks => &TRACK_COLUMNS,
        };
        let mut schema = String::from("message encounters {");
        for (name, _) in columns {
            let kind = match *name {
                "encounter" | "obstacle" | "seed" => "int64",
                "aircraft" | "kind" => "binary",
                _ => "double",
            };
            let more = match kind {
                "int64" => " (INTEGER(64,false))",
                "binary" => " (STRING)",
                _ => "",
            };
            // Writing to a text does not fail.
            let need = if AIR.contains(name) {
                "optional"
            } else {
                "required"
            };
            let _ = write!(schema, "{need} {kind} {name}{more};");
        }
        schema.push('}');
        let words: serde_json::Map<_, _> = columns
            .iter()
            .map(|(name, meaning)| ((*name).to_owned(), (*meaning).into()))
            .collect();
        let properties = WriterProperties::builder()
            .set_created_by(format!("fga {}", env!("CARGO_PKG_VERSION")))
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(vec![KeyValue::new(
                "fga.columns".to_owned(),
                serde_json::Value::Object(words).to_string(),
            )]));
        let schema = Arc::new(parse_message_type(&schema)?);
        Ok(Self {
            file: SerializedFileWriter::new(output, schema, Arc::new(properties.build()))?,
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
                let values = values.into_iter().chain(deviations(&sample.deviation));
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
            put::<W, Int64Type>(&mut group, column)?;
        }
        if self.content == Content::Tracks {
            put::<W, DoubleType>(&mut group, &self.weights)?;
            put::<W, ByteArrayType>(&mut group, &self.texts)?;
        }
        for column in self.numbers.iter().filter(|column| !column.is_empty()) {
            put::<W, DoubleType>(&mut group, column)?;
        }
        if self.content == Content::Rows {
            put::<W, ByteArrayType>(&mut group, &self.texts)?;
        } else {
            put_air(&mut group, &self.air)?;
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

fn put<W: Write + Send, T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("has too few columns".into()));
    };
    column.typed::<T>().write_batch(values, None, None)?;
    column.close()
}

/// Puts the velocities through the air, with empty fields where there is none.
fn put_air<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    air: &[Option<[f64; 2]>],
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = air.iter().map(|air| i16::from(air.is_some())).collect();
    for axis in 0..2 {
        let values: Vec<f64> = air.iter().flatten().map(|air| air[axis]).collect();
        let Some(mut column) = group.next_column()? else {
            return Err(ParquetError::General("has too few columns".into()));
        };
        let typed = column.typed::<DoubleType>();
        typed.write_batch(&values, Some(&levels), None)?;
        column.close()?;
    }
    Ok(())
}

/// The deviations in the order of their columns.
fn deviations(deviation: &Deviation) -> [f64; 8] {
    [
        deviation.east_m,
        deviation.north_m,
        deviation.east_north_m,
        deviation.up_m,
        deviation.east_mps,
        deviation.north_mps,
        deviation.east_north_mps,
        deviation.up_mps,
    ]
}

/// The content of a table, by its columns.
pub(super) fn content(bytes: Vec<u8>, path: &Path) -> Result<Content, InputError> {
    let table = Table::open(bytes, path)?;
    match (table.has("aircraft"), table.has("obstacle")) {
        (true, false) => Ok(Content::Tracks),
        (false, true) => Ok(Content::Rows),
        _ => Err(InputError::in_file(
            path,
            "holds no encounters, expected a column aircraft (tracks) or obstacle (obstacles around a line)",
        )),
    }
}

/// Obstacles around a line.
pub(super) fn rows(bytes: Vec<u8>, path: &Path) -> Result<Vec<Encounter>, InputError> {
    let table = Table::open(bytes, path)?;
    let mut found = Vec::new();
    for group in table.groups() {
        let group = group?;
        let [encounter, obstacle] = [group.wholes("encounter")?, group.wholes("obstacle")?];
        let numbers = ROW_COLUMNS[2..9]
            .iter()
            .map(|(name, _)| group.numbers(name))
            .collect::<Result<Vec<_>, _>>()?;
        let kinds = if table.has("kind") {
            group.texts("kind")?
        } else {
            vec!["straight".to_owned(); group.count]
        };
        for row in 0..group.count {
            let at = |column: usize| numbers[column][row];
            let movement = encounters::movement_of(kinds[row].as_bytes()).ok_or_else(|| {
                InputError::in_file(
                    path,
                    format!(
                        "column kind holds {}, expected still, straight, aircraft or uas",
                        shown(&kinds[row])
                    ),
                )
            })?;
            let id = u32::try_from(obstacle[row]).map_err(|_| {
                InputError::in_file(
                    path,
                    format!(
                        "column obstacle holds {}, expected less than 2^32",
                        obstacle[row]
                    ),
                )
            })?;
            let volume = ProtectedVolume::Sphere { radius_m: at(6) };
            let mut obstacle = Obstacle::new(
                id,
                Vec3::new(at(0), at(1), at(2)),
                Vec3::new(at(3), at(4), at(5)),
                volume,
            );
            obstacle.movement = movement;
            found.push((encounter[row], obstacle));
        }
    }
    encounters::from_rows(found).map_err(|message| InputError::in_file(path, message))
}

/// Aircraft with tracks.
pub(super) fn tracks(bytes: Vec<u8>, path: &Path) -> Result<Vec<Named>, InputError> {
    let table = Table::open(bytes, path)?;
    let mut found: Vec<(u64, Named)> = Vec::new();
    for group in table.groups() {
        take_tracks(&group?, &table, path, &mut found)?;
    }
    let mut numbers: Vec<u64> = found.iter().map(|(number, _)| *number).collect();
    numbers.sort_unstable();
    if let Some([twice, _]) = numbers
        .windows(2)
        .filter_map(|pair| pair.as_array::<2>())
        .find(|[a, b]| a == b)
    {
        return Err(InputError::in_file(
            path,
            format!("encounter {twice} stands in two places, expected its rows together"),
        ));
    }
    for (number, named) in &found {
        let message = match named.recording.aircraft.as_slice() {
            [_] => "has one aircraft only, expected the ownship and at least one more",
            _ => continue,
        };
        return Err(InputError::in_file(
            path,
            format!("encounter {number} {message}"),
        ));
    }
    if found.is_empty() {
        return Err(InputError::in_file(
            path,
            "holds no rows, expected at least one",
        ));
    }
    Ok(found.into_iter().map(|(_, named)| named).collect())
}

/// The columns that a table may lack.
struct Extras {
    deviations: [Option<Vec<f64>>; 8],
    air: Option<[Vec<Option<f64>>; 2]>,
}

impl Extras {
    fn of(group: &Group<'_>, table: &Table<'_>) -> Result<Self, InputError> {
        let mut deviations: [Option<Vec<f64>>; 8] = Default::default();
        for (column, (name, _)) in deviations
            .iter_mut()
            .zip(&TRACK_COLUMNS[DEVIATIONS_FROM..AIR_FROM])
        {
            if table.has(name) {
                *column = Some(group.numbers(name)?);
            }
        }
        let [east, north] = AIR;
        let air = if table.has(east) && table.has(north) {
            Some([group.maybe_numbers(east)?, group.maybe_numbers(north)?])
        } else {
            None
        };
        Ok(Self { deviations, air })
    }

    fn air_mps(&self, row: usize) -> Option<Vec3> {
        let [east, north] = self.air.as_ref()?;
        Some(Vec3::new(east[row]?, north[row]?, 0.0))
    }

    fn deviation(&self, row: usize) -> Result<Deviation, String> {
        let of = |index: usize| self.deviations[index].as_ref().map_or(0.0, |v| v[row]);
        let columns = &TRACK_COLUMNS[DEVIATIONS_FROM..AIR_FROM];
        for (index, (name, _)) in columns.iter().enumerate() {
            if of(index) < 0.0 && !name.starts_with("east_north") {
                return Err(format!(
                    "column {name} holds {}, expected a deviation of 0 or more",
                    of(index)
                ));
            }
        }
        Ok(Deviation {
            east_m: of(0),
            north_m: of(1),
            east_north_m: of(2),
            up_m: of(3),
            east_mps: of(4),
            north_mps: of(5),
            east_north_mps: of(6),
            up_mps: of(7),
        })
    }
}

/// Adds the rows of a group; an encounter may go on from one group to the next.
fn take_tracks(
    group: &Group<'_>,
    table: &Table<'_>,
    path: &Path,
    found: &mut Vec<(u64, Named)>,
) -> Result<(), InputError> {
    let numbers = group.wholes("encounter")?;
    let seeds = if table.has("seed") {
        Some(group.wholes("seed")?)
    } else {
        None
    };
    let weights = if table.has("weight") {
        Some(group.numbers("weight")?)
    } else {
        None
    };
    let names = group.texts("aircraft")?;
    let values = TRACK_COLUMNS[4..DEVIATIONS_FROM]
        .iter()
        .map(|(name, _)| group.numbers(name))
        .collect::<Result<Vec<_>, _>>()?;
    let extras = Extras::of(group, table)?;
    for row in 0..group.count {
        let number = numbers[row];
        let at = |column: usize| values[column][row];
        let wrong = |message: String| {
            let name = shown(&names[row]);
            InputError::in_file(
                path,
                format!("encounter {number}, aircraft {name}: {message}"),
            )
        };
        if found.last().is_none_or(|(last, _)| *last != number) {
            let origin = Origin {
                number: Some(number),
                seed: seeds.as_ref().map(|seeds| seeds[row]),
                weight: weights.as_ref().map_or(1.0, |weights| weights[row]),
            };
            let mut recording = Recording {
                aircraft: Vec::new(),
                frame: None,
                parameters: Vec::new(),
            };
            origin.mark(&mut recording);
            let name = format!("{number:08}");
            found.push((number, Named { name, recording }));
        }
        let Some((_, named)) = found.last_mut() else {
            continue;
        };
        let aircraft = &mut named.recording.aircraft;
        if aircraft.last().is_none_or(|last| last.name != names[row]) {
            if aircraft.iter().any(|known| known.name == names[row]) {
                return Err(wrong(
                    "stands in two places, expected its rows together".into(),
                ));
            }
            aircraft.push(Track {
                name: names[row].clone(),
                samples: Vec::new(),
            });
        }
        let sample = TrackSample {
            air_mps: extras.air_mps(row),
            deviation: extras.deviation(row).map_err(wrong)?,
            ..TrackSample::new(
                at(0),
                Vec3::new(at(1), at(2), at(3)),
                Vec3::new(at(4), at(5), at(6)),
            )
        };
        let is_far = (0..4).any(|column| at(column).abs() > LARGEST);
        if is_far || sample.velocity_mps.length() > LARGEST_SPEED_MPS {
            return Err(wrong(format!(
                "has a position, speed or time out of range at {} s",
                sample.time_s
            )));
        }
        let Some(track) = aircraft.last_mut() else {
            continue;
        };
        if let Some(last) = track.samples.last()
            && last.time_s >= sample.time_s
        {
            return Err(wrong(format!(
                "the time goes from {} s to {} s, expected it to grow",
                last.time_s, sample.time_s
            )));
        }
        track.samples.push(sample);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut writer = TableWriter::new(Vec::new(), Content::Tracks).unwrap();
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
        assert_eq!(read.len(), 1);
        assert_eq!(read[0].recording, written);
        assert_eq!(content(table(&[written]), path).unwrap(), Content::Tracks);
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
            obstacles: vec![Obstacle::new(4, place, Vec3::X * -0.7, volume)],
        };
        let mut writer = TableWriter::new(Vec::new(), Content::Rows).unwrap();
        writer.push_rows(&written).unwrap();
        let bytes = writer.finish().unwrap();
        let path = Path::new("e.parquet");
        assert_eq!(content(bytes.clone(), path).unwrap(), Content::Rows);
        assert_eq!(rows(bytes, path).unwrap(), [written]);
    }
}

//! Reads the tables that [`DrawnWriter`](super::TableWriter) writes, and those of others with their columns.

use core::ops::Range;
use std::path::Path;

use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_alerts::Deviation;
use fga_formats::InputError;
use fga_formats::daa::{Recording, Track, TrackSample};
use fga_formats::encounters::{self, Encounter};
use fga_formats::error::shown;
use fga_formats::recordings::{Encounters, Named};
use fga_formats::tally::Tally;

use super::columns::{ColumnGroup, ColumnTable, reading};
use super::tables::{AIR, AIR_FROM, DEVIATIONS_FROM, ROW_COLUMNS, TRACK_COLUMNS};
use super::{DrawnContent, Origin};
use crate::values::columns;

/// The largest plausible position and time, metres and seconds, and speed, metres per second.
const LARGEST: f64 = 1e11;
const LARGEST_SPEED_MPS: f64 = 5000.0;

/// The names of some columns of a table.
fn column_names(table: &'static str, which: Range<usize>) -> impl Iterator<Item = &'static str> {
    let columns = columns(table).skip(which.start).take(which.len());
    columns.map(|(_, name, _)| name)
}

/// The content of a table, by its columns.
pub(super) fn content(bytes: Vec<u8>, path: &Path) -> Result<DrawnContent, InputError> {
    let table = reading(path, || ColumnTable::open(bytes, path))?;
    match (table.has("aircraft"), table.has("obstacle")) {
        (true, false) => Ok(DrawnContent::Tracks),
        (false, true) => Ok(DrawnContent::Rows),
        _ => Err(InputError::in_file(
            path,
            "holds no encounters, expected a column aircraft (tracks) or obstacle (obstacles around a line)",
        )),
    }
}

/// Obstacles around a line.
pub(super) fn rows(bytes: Vec<u8>, path: &Path) -> Result<Vec<Encounter>, InputError> {
    reading(path, || read_rows(bytes, path))
}

fn read_rows(bytes: Vec<u8>, path: &Path) -> Result<Vec<Encounter>, InputError> {
    let table = ColumnTable::open(bytes, path)?;
    let mut found = Vec::new();
    for group in table.groups() {
        let group = group?;
        let [encounter, obstacle] = [group.wholes("encounter")?, group.wholes("obstacle")?];
        let numbers = column_names(ROW_COLUMNS, 2..9)
            .map(|name| group.numbers(name))
            .collect::<Result<Vec<_>, _>>()?;
        let kinds = if table.has("kind") {
            group.texts("kind")?
        } else {
            vec!["straight".to_owned(); group.count]
        };
        for row in 0..group.count {
            let at = |column: usize| numbers[column][row];
            let wrong = |column: &str, found: &str, expected: &str| {
                let message = format!("column {column} holds {found}, expected {expected}");
                InputError::in_file(path, message)
            };
            let movement = encounters::movement_of(kinds[row].as_bytes()).ok_or_else(|| {
                let kinds_known = "still, straight, aircraft or uas";
                wrong("kind", &shown(&kinds[row]), kinds_known)
            })?;
            let id = u32::try_from(obstacle[row])
                .map_err(|_| wrong("obstacle", &obstacle[row].to_string(), "less than 2^32"))?;
            let volume = ProtectedVolume::Sphere { radius_m: at(6) };
            let mut obstacle = Obstacle::straight(
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
pub(super) fn tracks(bytes: Vec<u8>, path: &Path) -> Result<Encounters, InputError> {
    reading(path, || read_tracks(bytes, path))
}

fn read_tracks(bytes: Vec<u8>, path: &Path) -> Result<Encounters, InputError> {
    let table = ColumnTable::open(bytes, path)?;
    let mut found: Vec<(u64, Named)> = Vec::new();
    for group in table.groups() {
        take_tracks(&group?, &table, path, &mut found)?;
    }
    let wrong = |message: String| Err(InputError::in_file(path, message));
    let mut numbers: Vec<u64> = found.iter().map(|(number, _)| *number).collect();
    numbers.sort_unstable();
    if let Some(pair) = numbers.windows(2).find(|pair| pair[0] == pair[1]) {
        let twice = pair[0];
        return wrong(format!(
            "encounter {twice} stands in two places, expected its rows together"
        ));
    }
    let is_alone = |(_, named): &&(u64, Named)| named.recording.aircraft.len() == 1;
    if let Some((number, _)) = found.iter().find(is_alone) {
        return wrong(format!(
            "encounter {number} has one aircraft only, expected the ownship and at least one more"
        ));
    }
    if found.is_empty() {
        return wrong("holds no rows, expected at least one".into());
    }
    let named: Vec<Named> = found.into_iter().map(|(_, named)| named).collect();
    let tracks = named.iter().flat_map(|named| &named.recording.aircraft);
    let rows: usize = tracks.map(|track| track.samples.len()).sum();
    let tally = Tally::all_used(rows as u64);
    Ok(Encounters { named, tally })
}

/// The columns that a table may lack.
struct ExtraColumns {
    deviations: [Option<Vec<f64>>; 8],
    air: Option<[Vec<Option<f64>>; 2]>,
}

impl ExtraColumns {
    fn of(group: &ColumnGroup<'_>, table: &ColumnTable<'_>) -> Result<Self, InputError> {
        let mut deviations: [Option<Vec<f64>>; 8] = Default::default();
        let names = column_names(TRACK_COLUMNS, DEVIATIONS_FROM..AIR_FROM);
        for (column, name) in deviations.iter_mut().zip(names) {
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
        let values = self.deviations.each_ref();
        let values = values.map(|column| column.as_ref().map_or(0.0, |column| column[row]));
        for (place, value) in values.into_iter().enumerate() {
            // That of east and north together has a sign.
            if value < 0.0 && place % 4 != 2 {
                let mut names = column_names(TRACK_COLUMNS, DEVIATIONS_FROM..AIR_FROM);
                let name = names.nth(place).unwrap_or_default();
                return Err(format!(
                    "column {name} holds {value}, expected a deviation of 0 or more"
                ));
            }
        }
        Ok(Deviation::from_array(values))
    }
}

/// Adds the rows of a group; an encounter may go on from one group to the next.
fn take_tracks(
    group: &ColumnGroup<'_>,
    table: &ColumnTable<'_>,
    path: &Path,
    found: &mut Vec<(u64, Named)>,
) -> Result<(), InputError> {
    let numbers = group.wholes("encounter")?;
    let seeds = table.has("seed").then(|| group.wholes("seed"));
    let weights = table.has("weight").then(|| group.numbers("weight"));
    let (seeds, weights) = (seeds.transpose()?, weights.transpose()?);
    let names = group.texts("aircraft")?;
    let values = column_names(TRACK_COLUMNS, 4..DEVIATIONS_FROM)
        .map(|name| group.numbers(name))
        .collect::<Result<Vec<_>, _>>()?;
    let extras = ExtraColumns::of(group, table)?;
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
                tally: Tally::default(),
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

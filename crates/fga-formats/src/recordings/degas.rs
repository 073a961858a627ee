//! Encounters of MIT-LL's DEGAS: a row each second with both aircraft side by side.
//!
//! The first line names the columns, with two numbers for two aircraft, and the units:
//! `# xE1,xE2,xN1,xN2,h1,h2,vE1,vE2,vN1,vN2,hdot1,hdot2 [ft, ft/s], 1 Hz`.

use crate::daa::{Recording, Track, TrackSample};
use crate::error::{InputError, shown};
use crate::tally::Tally;
use crate::units::FOOT_M;
use glam::DVec3;
use std::path::Path;

/// Columns of a row, in their order.
const COLUMNS: [&str; 12] = [
    "xE1", "xE2", "xN1", "xN2", "h1", "h2", "vE1", "vE2", "vN1", "vN2", "hdot1", "hdot2",
];

/// The largest plausible distance and speed, metres and metres per second.
const LARGEST: f64 = 1e7;

/// Whether a text begins like such a file.
pub(super) fn is_degas(text: &str) -> bool {
    text.strip_prefix('#')
        .is_some_and(|rest| rest.trim_start().starts_with("xE1"))
}

/// Reads the encounter.
pub(super) fn parse(text: &str, path: &Path) -> Result<Recording, InputError> {
    let head = text.trim_start().lines().next().unwrap_or_default();
    let names = head.trim_start_matches(['#', ' ']).split('[').next();
    let names = names.unwrap_or_default().split(',').map(str::trim);
    let names: Vec<&str> = names.collect();
    let wrong = |found: String| {
        let expected = COLUMNS.join(",");
        let message = format!("{found}, expected {expected} [ft, ft/s], 1 Hz");
        InputError::at_line(path, 1, message)
    };
    if names != COLUMNS {
        return Err(wrong(format!("names the columns {}", names.join(","))));
    }
    if !head.contains("[ft, ft/s]") || !head.contains("1 Hz") {
        return Err(wrong("has other units or another rate".into()));
    }
    let mut samples = [Vec::new(), Vec::new()];
    for (line, number) in text.lines().zip(1_u64..) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let at = |message: String| InputError::at_line(path, number, message);
        let number_of = |field: &str| {
            let feet: Option<f64> = field.trim().parse().ok();
            let value = feet.map(|feet| feet * FOOT_M);
            let wrong = || at(format!("holds {}, expected a number", shown(field.trim())));
            value
                .filter(|value| value.abs() <= LARGEST)
                .ok_or_else(wrong)
        };
        let row: Vec<f64> = line.split(',').map(number_of).collect::<Result<_, _>>()?;
        let [e1, e2, n1, n2, h1, h2, ve1, ve2, vn1, vn2, hd1, hd2] =
            *<&[f64; 12]>::try_from(row.as_slice())
                .map_err(|_| at(format!("has {} fields, expected 12", row.len())))?;
        let states = [
            (DVec3::new(e1, n1, h1), DVec3::new(ve1, vn1, hd1)),
            (DVec3::new(e2, n2, h2), DVec3::new(ve2, vn2, hd2)),
        ];
        for (samples, (position_m, velocity_mps)) in samples.iter_mut().zip(states) {
            let time_s = samples.len() as f64;
            samples.push(TrackSample::new(time_s, position_m, velocity_mps));
        }
    }
    if samples.iter().any(Vec::is_empty) {
        let message = "holds no rows, expected at least one below the column names";
        return Err(InputError::in_file(path, message));
    }
    let rows = samples.first().map_or(0, Vec::len);
    let tally = Tally::all_used(rows as u64);
    let aircraft = ["1", "2"]
        .into_iter()
        .zip(samples)
        .map(|(name, samples)| Track {
            name: name.to_owned(),
            samples,
        })
        .collect();
    Ok(Recording {
        aircraft,
        tally,
        ..Recording::default()
    })
}

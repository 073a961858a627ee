//! SRTM's `.hgt`: a square of a degree, whole metres, big endian, from the north-west; the name is its south-west corner.

use std::io::Read;

use super::field::{HeightField, HeightGrid, Heights};
use super::{Datum, Stated, name};

/// Posts of a side and the bytes of the file: three seconds of arc apart, and one.
const SIDES: [(usize, usize); 2] = [(1201, 2 * 1201 * 1201), (3601, 2 * 3601 * 3601)];

/// SRTM's absolute vertical accuracy, metres: 90 % of the heights are nearer.
pub(super) const ERROR: Stated<f64> = Stated {
    value: 16.0,
    source: "the specification of SRTM, 90 %",
};

pub(super) const DATUM: Stated<Datum> = Stated {
    value: Datum::Egm96,
    source: "the format",
};

/// Reads a file of this many bytes piece by piece, so that it is in memory once.
pub(super) fn parse(
    mut input: impl Read,
    size: u64,
    file_name: &str,
) -> Result<HeightField, String> {
    let Some((side, _)) = SIDES.iter().find(|(_, bytes)| *bytes as u64 == size) else {
        return Err(format!(
            "has {size} bytes, expected {} or {} of a .hgt file ({} or {} heights a side)",
            SIDES[0].1, SIDES[1].1, SIDES[0].0, SIDES[1].0
        ));
    };
    let [south_deg, west_deg] = name::corner(file_name)?
        .ok_or("has no place in its name, expected a .hgt file to be named after its south-west corner, as in N47E008.hgt")?;
    let mut heights = Vec::with_capacity(side * side);
    let mut row = vec![0; 2 * side];
    for number in 0..*side {
        input.read_exact(&mut row).map_err(|error| {
            format!("cannot be read at row {number} ({error}), expected {side}")
        })?;
        let (pairs, _) = row.as_chunks::<2>();
        heights.extend(pairs.iter().map(|pair| i16::from_be_bytes(*pair)));
    }
    let step_deg = 1.0 / (side - 1) as f64;
    let grid = HeightGrid {
        south_deg,
        west_deg,
        step_north_deg: step_deg,
        step_east_deg: step_deg,
        rows: *side,
        columns: *side,
    };
    HeightField::new(grid, Heights::Whole(heights))
}

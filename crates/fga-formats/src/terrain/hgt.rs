//! SRTM's `.hgt`: a square of a degree, whole metres, big endian, from the north-west; the name is its south-west corner.

use std::io::Read;

use super::field::{HeightField, HeightGrid};
use super::file::SRTM_ERROR;
use super::{Datum, Stated, TerrainFile, name};
use crate::gzip::fill;

/// Posts of a side: three seconds of arc apart, and one.
const SIDES: [usize; 2] = [1201, 3601];

const DATUM: Stated<Datum> = Stated {
    value: Datum::Egm96,
    source: "the format",
};

pub(super) fn parse(mut input: impl Read, file_name: &str) -> Result<TerrainFile, String> {
    let [few, many] = SIDES.map(|side| side * side);
    let mut heights = Vec::with_capacity(many);
    let mut part = Vec::new();
    let mut size = 0;
    while size <= 2 * many {
        fill(&mut input, &mut part, 2 * SIDES[0])?;
        if part.is_empty() {
            break;
        }
        size += part.len();
        let (pairs, _) = part.as_chunks::<2>();
        heights.extend(pairs.iter().copied().map(i16::from_be_bytes));
    }
    let Some(side) = SIDES.into_iter().find(|side| 2 * side * side == size) else {
        return Err(format!(
            "has {}{size} bytes, expected {} or {} of a .hgt file ({} or {} heights a side)",
            if size > 2 * many { "at least " } else { "" },
            2 * few,
            2 * many,
            SIDES[0],
            SIDES[1]
        ));
    };
    heights.shrink_to_fit();
    let [south_deg, west_deg] = name::corner(file_name)?
        .ok_or("has no place in its name, expected a .hgt file to be named after its south-west corner, as in N47E008.hgt")?;
    let step_deg = 1.0 / (side - 1) as f64;
    let grid = HeightGrid {
        south_deg,
        west_deg,
        step_north_deg: step_deg,
        step_east_deg: step_deg,
        rows: side,
        columns: side,
    };
    let fields = vec![HeightField::new(grid, heights)?];
    let error = Some(SRTM_ERROR);
    Ok(TerrainFile::new("SRTM", fields, DATUM, error))
}

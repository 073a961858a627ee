//! ArduPilot's terrain `.DAT`: blocks of 2,048 bytes, little endian, each a grid of 28 rows and 32 columns, spaced in metres.
//!
//! Facts from the public source of `AP_Terrain`: layout of the block, its checksum (CRC-16 of CCITT, beginning at 0, over the
//! first 1,821 bytes with the checksum as 0), 24 rows and 28 columns from one block to the next, and the metres of a degree. A block's longitude
//! spacing has the scale at the middle latitude between its degree and its rows; older files have the scale of their degree.

use std::io::Read;

use super::field::{HOLE, HeightField, HeightGrid};
use super::file::{MOST_BYTES, SRTM_ERROR};
use super::{Datum, Stated, TerrainFile, name};
use crate::gzip::fill;
use crate::units::DEGREE_RAD;

const BLOCK: usize = 2048;
const CHECKED: usize = 1821;
pub(super) const ROWS: usize = 28;
pub(super) const COLUMNS: usize = 32;
/// Posts from one block to the next, north and east.
pub(super) const TO_NEXT: [f64; 2] = [24.0, 28.0];
/// Posts of a piece that a ground station sends.
pub(super) const PIECE: usize = 4;
/// Metres of a degree of latitude.
pub(super) const DEGREE_M: f64 = 111_318.845_021_450_34;
/// A corner may differ from that of its number by a metre: ArduPilot computes in single precision. Degrees.
const CORNER_DEG: f64 = 1e-5;

const DATUM: Stated<Datum> = Stated {
    value: Datum::Egm96,
    source: "ArduPilot's files are made from SRTM",
};

/// The blocks of a file.
pub(super) fn parse(mut input: impl Read, file_name: &str) -> Result<TerrainFile, String> {
    let mut fields = Vec::new();
    let mut empty_blocks = 0;
    let mut damaged = 0_usize;
    let mut first_error = None;
    let mut bytes = Vec::new();
    let mut blocks = 0;
    loop {
        fill(&mut input, &mut bytes, BLOCK)?;
        if bytes.is_empty() && blocks > 0 {
            break;
        }
        if bytes.len() < BLOCK {
            return Err(format!(
                "has {} bytes, expected whole blocks of {BLOCK} bytes; block {blocks} is cut off",
                blocks * BLOCK + bytes.len()
            ));
        }
        if blocks * BLOCK >= MOST_BYTES {
            return Err(format!(
                "has more than {blocks} blocks, expected at most {blocks}"
            ));
        }
        match block(&bytes, file_name) {
            Ok(Some(field)) => fields.push(field),
            Ok(None) => empty_blocks += 1,
            Err(message) => {
                damaged += 1;
                first_error.get_or_insert((blocks, message));
            }
        }
        blocks += 1;
    }
    if let Some((number, message)) = first_error {
        return Err(format!(
            "block {number} {message} ({damaged} of {blocks} blocks unusable)"
        ));
    }
    if fields.is_empty() {
        return Err(format!(
            "has no heights in any of its {blocks} blocks, expected at least one"
        ));
    }
    let error = Some(SRTM_ERROR);
    Ok(TerrainFile {
        empty_blocks,
        ..TerrainFile::new("ArduPilot's terrain", fields, DATUM, error)
    })
}

fn crc(block: &[u8]) -> u16 {
    let mut crc = 0_u16;
    for (index, byte) in block.iter().take(CHECKED).enumerate() {
        let byte = if index == 16 || index == 17 { 0 } else { *byte };
        let mut carried = crc >> 8 ^ u16::from(byte);
        carried ^= carried >> 4;
        crc = crc << 8 ^ carried << 12 ^ carried << 5 ^ carried;
    }
    crc
}

/// The field of a block; `None` for a block that was never filled.
fn block(block: &[u8], file_name: &str) -> Result<Option<HeightField>, String> {
    let read = |at: usize| -> [u8; 2] {
        let pair = block.get(at..at + 2).unwrap_or_default();
        pair.try_into().unwrap_or_default()
    };
    let word = |at: usize| u16::from_le_bytes(read(at));
    let long = |at: usize| {
        let [[a, b], [c, d]] = [read(at), read(at + 2)];
        i32::from_le_bytes([a, b, c, d])
    };
    let filled = u64::from(word(0))
        | u64::from(word(2)) << 16
        | u64::from(word(4)) << 32
        | u64::from(word(6)) << 48;
    if filled == 0 {
        return Ok(None);
    }
    let (stored, computed) = (word(16), crc(block));
    if stored != computed {
        return Err(format!(
            "has the checksum {stored:#06x}, expected {computed:#06x}"
        ));
    }
    let (version, spacing_m) = (word(18), word(20));
    if version != 1 || !(1..=2000).contains(&spacing_m) {
        return Err(format!(
            "has version {version} and spacing {spacing_m} m, expected version 1 and 1 to 2000 m"
        ));
    }
    let after = 22 + 2 * ROWS * COLUMNS;
    let index = [word(after), word(after + 2)].map(f64::from);
    let degree = [
        f64::from(block.get(after + 6).map_or(0, |byte| byte.cast_signed())),
        f64::from(i16::from_le_bytes(read(after + 4))),
    ];
    let corner = [long(8), long(12)].map(|number| f64::from(number) * 1e-7);
    if let Ok(Some(named)) = name::corner(file_name)
        && named != degree
    {
        return Err(format!(
            "is of the degree {}, {}, expected that of the file's name, {}, {}",
            degree[0], degree[1], named[0], named[1]
        ));
    }
    let grid = grid(f64::from(spacing_m), index, degree, corner)?;
    let mut heights = Vec::with_capacity(ROWS * COLUMNS);
    // The file begins in the south.
    for row in (0..ROWS).rev() {
        for column in 0..COLUMNS {
            let piece = row / PIECE * (COLUMNS / PIECE) + column / PIECE;
            let height = i16::from_le_bytes(read(22 + 2 * (row * COLUMNS + column)));
            let known = filled >> piece & 1 == 1 && height != i16::MAX;
            heights.push(if known { height } else { HOLE });
        }
    }
    HeightField::new(grid, heights).map(Some)
}

/// Degrees of latitude in a degree of longitude, as ArduPilot has them.
pub(super) fn scale(latitude_deg: f64) -> f64 {
    libm::cos(latitude_deg * DEGREE_RAD).max(0.01)
}

/// The posts of a block of this number in this degree, whose south-west corner the file gives too.
pub(super) fn grid(
    spacing_m: f64,
    index: [f64; 2],
    degree: [f64; 2],
    corner: [f64; 2],
) -> Result<HeightGrid, String> {
    let first = [index[0] * TO_NEXT[0], index[1] * TO_NEXT[1]];
    let south_deg = degree[0] + first[0] * spacing_m / DEGREE_M;
    let east_deg = |scale: f64| first[1] * spacing_m / (DEGREE_M * scale);
    let middle = |row: f64| scale(0.5 * (degree[0] + south_deg + row * spacing_m / DEGREE_M));
    let off_deg = |scale: f64| (corner[1] - degree[1] - east_deg(scale)).abs();
    let [old, new] = [scale(degree[0]), middle(0.0)].map(off_deg);
    if (corner[0] - south_deg).abs() > CORNER_DEG || old.min(new) > CORNER_DEG {
        return Err(format!(
            "has the corner {:.6}, {:.6}, expected {south_deg:.6}, {:.6} by its number",
            corner[0],
            corner[1],
            degree[1] + east_deg(middle(0.0))
        ));
    }
    let scale = if new <= old {
        middle(0.5 * (ROWS - 1) as f64)
    } else {
        scale(degree[0])
    };
    Ok(HeightGrid {
        south_deg,
        west_deg: degree[1] + east_deg(scale),
        step_north_deg: spacing_m / DEGREE_M,
        step_east_deg: spacing_m / (DEGREE_M * scale),
        rows: ROWS,
        columns: COLUMNS,
    })
}

//! DTED levels 0, 1 and 2 (MIL-PRF-89020B): three headers, then a record of heights for each line of longitude, from the west;
//! in it heights from the south, with a sign and a magnitude, or, from some producers, in two's complement.

use std::io::Read;

use super::field::{HOLE, HeightField, HeightGrid};
use super::{Datum, Stated, TerrainFile, name};
use crate::gzip::fill;

const UHL: usize = 80;
const DSI: usize = 648;
const ACC: usize = 2700;
const HEADERS: usize = UHL + DSI + ACC;
/// Bytes of a record before its heights.
const BEFORE: usize = 8;
/// Bytes of the checksum behind them.
const CHECKSUM: usize = 4;
/// The first byte of a record.
const SENTINEL: u8 = 0xAA;
/// A height that is not known: the largest negative one, all bits set.
const UNKNOWN: i16 = -1;
/// The same where a producer wrote negative heights in two's complement.
const UNKNOWN_IN_TWOS: i16 = -32_767;
/// No height has this magnitude as a sign and a magnitude: it stands in two's complement, metres.
const TWOS_FROM_M: i16 = 16_000;

pub(super) fn parse(mut input: impl Read, file_name: &str) -> Result<TerrainFile, String> {
    let mut bytes = Vec::new();
    fill(&mut input, &mut bytes, HEADERS)?;
    let text = |at: usize, length: usize| {
        let part = bytes.get(at..at + length).unwrap_or_default();
        String::from_utf8_lossy(part).into_owned()
    };
    if bytes.len() < HEADERS {
        return Err(format!(
            "has {} bytes, expected at least {HEADERS} for the headers of DTED",
            bytes.len()
        ));
    }
    for (at, expected) in [(0, "UHL1"), (UHL, "DSI"), (UHL + DSI, "ACC")] {
        let found = text(at, expected.len());
        if found != expected {
            return Err(format!(
                "has {} at byte {at}, expected the header {expected} of DTED",
                crate::error::shown(&found)
            ));
        }
    }
    let number = |at: usize, length: usize, what: &str| -> Result<u32, String> {
        let found = text(at, length);
        found.trim().parse().map_err(|_| {
            format!(
                "has {} as {what}, expected a whole number",
                crate::error::shown(&found)
            )
        })
    };
    let columns = number(47, 4, "number of longitude lines")? as usize;
    let rows = number(51, 4, "number of heights of a line")? as usize;
    let west_deg = angle(&text(4, 8), ['E', 'W'])?;
    let south_deg = angle(&text(12, 8), ['N', 'S'])?;
    let tenths = |at, what| number(at, 4, what).map(|tenths| f64::from(tenths) / 36_000.0);
    let grid = HeightGrid {
        south_deg,
        west_deg,
        step_north_deg: tenths(24, "latitude interval")?,
        step_east_deg: tenths(20, "longitude interval")?,
        rows,
        columns,
    };
    let horizontal = text(UHL + 144, 5);
    if horizontal != "WGS84" && !horizontal.trim().is_empty() {
        return Err(format!(
            "has the horizontal datum {}, expected WGS84",
            crate::error::shown(&horizontal)
        ));
    }
    let datum = datum(&text(UHL + 141, 3))?;
    let heights = heights(input, rows, columns)?;
    let error = [28, UHL + DSI + 7].into_iter().find_map(|at| {
        let value: f64 = text(at, 4).trim().parse().ok()?;
        (0.0..=1000.0).contains(&value).then_some(Stated {
            value,
            source: "the header of the file, 90 %",
        })
    });
    let field = HeightField::new(grid, heights)?;
    name::agrees(file_name, &field.grid().area())?;
    Ok(TerrainFile::new("DTED", vec![field], datum, error))
}

fn datum(text: &str) -> Result<Stated<Datum>, String> {
    let (value, source) = match text {
        "E96" => (Datum::Egm96, "the header of the file"),
        "E08" => (Datum::Egm2008, "the header of the file"),
        "MSL" => (
            Datum::Egm96,
            "the header says mean sea level; EGM96 is assumed",
        ),
        _ if text.trim().is_empty() => (Datum::Egm96, "the format"),
        _ => {
            return Err(format!(
                "has the vertical datum {}, expected MSL, E96 or E08",
                crate::error::shown(text)
            ));
        }
    };
    Ok(Stated { value, source })
}

/// An angle as degrees, minutes, seconds and a letter, as in `0083000E`; degrees.
fn angle(text: &str, letters: [char; 2]) -> Result<f64, String> {
    let wrong = || {
        format!(
            "has {} as its origin, expected degrees, minutes, seconds and {} or {}, as in 0473000{}",
            crate::error::shown(text),
            letters[0],
            letters[1],
            letters[0]
        )
    };
    let part = |from: usize, to: usize| -> Option<f64> {
        let digits = text.get(from..to)?;
        let all = digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse().ok().filter(|_| all)
    };
    let (Some(degrees), Some(minutes), Some(seconds)) = (part(0, 3), part(3, 5), part(5, 7)) else {
        return Err(wrong());
    };
    let letter = text.chars().last().unwrap_or_default();
    if !letters.contains(&letter) || minutes >= 60.0 || seconds >= 60.0 {
        return Err(wrong());
    }
    let value = degrees + minutes / 60.0 + seconds / 3600.0;
    Ok(if letter == letters[0] { value } else { -value })
}

/// The heights by rows from the north.
fn heights(mut input: impl Read, rows: usize, columns: usize) -> Result<Vec<i16>, String> {
    let length = BEFORE + 2 * rows + CHECKSUM;
    let expected = HEADERS + columns * length;
    let wrong = |found: &str| {
        format!("has {found} bytes, expected {expected} for {columns} lines of {rows} heights")
    };
    let mut heights = vec![HOLE; rows * columns];
    let mut record = Vec::new();
    for column in 0..columns {
        fill(&mut input, &mut record, length)?;
        if record.len() < length {
            let found = HEADERS + column * length + record.len();
            return Err(wrong(&found.to_string()));
        }
        let (content, checksum) = record.split_at(length - CHECKSUM);
        let stored = checksum
            .iter()
            .fold(0_u32, |sum, byte| sum << 8 | u32::from(*byte));
        let computed = content
            .iter()
            .fold(0_u32, |sum, byte| sum.wrapping_add(u32::from(*byte)));
        if content.first() != Some(&SENTINEL) || stored != computed {
            return Err(format!(
                "longitude line {column} has the checksum {stored}, expected {computed} and a first byte {SENTINEL:#04x}"
            ));
        }
        let line = content.get(4..6).map_or(0, |pair| {
            usize::from(u16::from_be_bytes(pair.try_into().unwrap_or_default()))
        });
        if line != column {
            return Err(format!(
                "longitude line {column} has the number {line}, expected {column}"
            ));
        }
        let (pairs, _) = content.get(BEFORE..).unwrap_or_default().as_chunks::<2>();
        for (from_south, pair) in pairs.iter().enumerate() {
            let raw = u16::from_be_bytes(*pair);
            let index = (rows - 1 - from_south) * columns + column;
            if let Some(post) = heights.get_mut(index) {
                *post = raw.cast_signed();
            }
        }
    }
    signed(&mut heights);
    fill(&mut input, &mut record, 1)?;
    if !record.is_empty() {
        return Err(wrong(&format!("more than {expected}")));
    }
    Ok(heights)
}

/// Gives heights their sign. Those that no place has as a sign and a magnitude show that a producer wrote two's complement.
fn signed(heights: &mut [i16]) {
    let magnitude = |height: i16| height & i16::MAX;
    let is_twos =
        |height: &i16| *height < 0 && *height != UNKNOWN && magnitude(*height) > TWOS_FROM_M;
    let twos = heights.iter().any(is_twos);
    for height in heights.iter_mut().filter(|height| **height < 0) {
        *height = match *height {
            UNKNOWN => HOLE,
            UNKNOWN_IN_TWOS if twos => HOLE,
            _ if twos => *height,
            _ => -magnitude(*height),
        };
    }
}

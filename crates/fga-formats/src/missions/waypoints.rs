//! Lists of items in lines: `QGC WPL 110`.
//!
//! Number, current, frame, command, four parameters, latitude, longitude, altitude, continue; between them tabs, or
//! spaces. Item 0 is home where it is a waypoint, whatever its frame: ArduPilot and the stations that write it never fly it, and its height is
//! above mean sea level.

use std::path::Path;

use super::MissionFile;
use super::items::{Item, ItemReader};
use crate::error::InputError;

/// The first words of a list of waypoints.
pub(super) const LIST: &str = "QGC WPL";

/// Fields of a line.
const FIELDS: usize = 12;

pub(super) fn parse(text: &str, path: &Path) -> Result<MissionFile, InputError> {
    let mut lines = (1..)
        .zip(text.lines().map(str::trim))
        .filter(|(_, line)| !line.is_empty());
    let (number, first) = lines.next().unwrap_or((1, ""));
    let version = first.strip_prefix(LIST).unwrap_or(first).trim();
    if version != "110" {
        let version = crate::error::shown(version);
        let message = format!("is version {version}, expected QGC WPL 110");
        return Err(InputError::at_line(path, number, message));
    }
    let items = lines
        .filter(|(_, line)| !line.starts_with('#'))
        .map(|(number, line)| item(line, number, path))
        .collect::<Result<Vec<Item>, _>>()?;
    let mut reader = ItemReader::new(path);
    // Stations fly the lines in their order, and mostly number them so.
    let next = items.iter().zip(items.iter().skip(1));
    let mut odd = next.filter(|(before, item)| item.number != before.number + 1);
    if let Some((before, item)) = odd.next() {
        reader.note(&format!(
            "line {} holds item {} after item {}: the items are flown in the order of their lines, as stations do; is one missing?",
            item.line.unwrap_or(1),
            item.number,
            before.number
        ));
    }
    let items = match items.split_first() {
        Some((first, rest)) if (first.number, first.command) == (0, 16) => {
            if first.frame != 0 {
                let frame = first.frame;
                let sentence = format!(
                    "item 0 is home, whose height is above mean sea level whatever its frame ({frame})"
                );
                reader.note(&sentence);
            }
            reader.take_home(&Item { frame: 0, ..*first })?;
            rest
        }
        _ => items.as_slice(),
    };
    for item in items {
        reader.take(item)?;
    }
    reader.finish()
}

fn item(line: &str, number: u64, path: &Path) -> Result<Item, InputError> {
    let fields: Vec<&str> = line.split_whitespace().collect();
    if fields.len() != FIELDS {
        let message = format!("has {} fields, expected {FIELDS}", fields.len());
        return Err(InputError::at_line(path, number, message));
    }
    let wrong = |index: usize, expected: &str| {
        let text = fields.get(index).copied().unwrap_or_default();
        let found = crate::error::shown(text);
        let message = format!("field {} is {found}, expected {expected}", index + 1);
        InputError::at_line(path, number, message)
    };
    let value = |index: usize| {
        let value: Option<f64> = fields.get(index).and_then(|text| text.parse().ok());
        // Stations write NaN for what the vehicle decides.
        value
            .map(|value| Some(value).filter(|value| value.is_finite()))
            .ok_or_else(|| wrong(index, "a number"))
    };
    let whole = |index: usize| -> Result<u16, InputError> {
        let value = fields.get(index).and_then(|text| text.parse().ok());
        value.ok_or_else(|| wrong(index, "a whole number"))
    };
    Ok(Item {
        number: u64::from(whole(0)?),
        line: Some(number),
        frame: whole(2)?,
        command: whole(3)?,
        first_parameter: value(4)?,
        group: value(5)?,
        at: [value(8)?, value(9)?, value(10)?],
    })
}

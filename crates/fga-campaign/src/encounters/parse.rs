//! Cells by name, for examples and campaigns.

use super::{DrawnThreats, EncounterSource, Family, Landscape, Range};

impl EncounterSource {
    /// Reads a cell such as `threats:3:100-500:45-60,planar`: a family with its numbers, then
    /// `planar` and `bystanders` as wanted, with Table 4's aircraft.
    ///
    /// # Errors
    /// The expected text at the first fault.
    pub fn parse(cell: &str, seed: u64) -> Result<Self, String> {
        let mut options = cell.split(',');
        let family: Vec<&str> = options.next().unwrap_or("").split(':').collect();
        let family = match family.as_slice() {
            ["threats", count, seen, speed] => Family::Threats(threats(count, seen, speed)?),
            ["from-anywhere", count, seen, speed] => {
                Family::FromAnywhere(threats(count, seen, speed)?)
            }
            [name, count, seen, speed] if let Some(place) = Landscape::named(name) => {
                Family::Among(place, threats(count, seen, speed)?)
            }
            ["head-on", seen, speed] => Family::HeadOn {
                first_seen_m: range(seen)?,
                speed_mps: range(speed)?,
            },
            ["overtaking"] => Family::Overtaking,
            ["wall"] => Family::Wall { gap: false },
            ["wall-gap"] => Family::Wall { gap: true },
            ["stream", count_] => Family::Stream {
                count: count(count_)?,
            },
            ["pincer", count_] => Family::Pincer {
                count: count(count_)?,
            },
            _ => {
                return Err(format!(
                    "{cell}: expected threats:COUNT:SEEN:SPEED, from-anywhere:COUNT:SEEN:SPEED, valley:COUNT:SEEN:SPEED, \
                     ridges:COUNT:SEEN:SPEED, ground-wall:COUNT:SEEN:SPEED, corridor:COUNT:SEEN:SPEED, \
                     head-on:SEEN:SPEED, overtaking, wall, wall-gap, stream:COUNT or pincer:COUNT"
                ));
            }
        };
        let mut source = Self::table_4(family, false, seed);
        for option in options {
            match (option, family) {
                ("planar", _) => source.planar = true,
                ("bystanders", Family::Threats(threats) | Family::FromAnywhere(threats)) => {
                    source.bystanders = Some(threats.count);
                }
                _ => return Err(format!("{option}: expected planar or bystanders")),
            }
        }
        Ok(source)
    }
}

fn threats(count_: &str, seen: &str, speed: &str) -> Result<DrawnThreats, String> {
    Ok(DrawnThreats {
        count: count(count_)?,
        first_seen_m: range(seen)?,
        speed_mps: range(speed)?,
    })
}

/// A number of obstacles.
///
/// # Errors
/// The expected text.
pub(crate) fn count(text: &str) -> Result<u32, String> {
    text.parse()
        .ok()
        .filter(|n| (1..=1000).contains(n))
        .ok_or_else(|| format!("{text}: expected a number of obstacles from 1 to 1000"))
}

/// A number that is not negative, or a range `FROM-TO`.
///
/// # Errors
/// The expected text.
pub(crate) fn range(text: &str) -> Result<Range, String> {
    let number = |part: &str| {
        part.parse::<f64>()
            .ok()
            .filter(|n| n.is_finite() && *n >= 0.0)
            .ok_or_else(|| format!("{text}: expected a number or FROM-TO"))
    };
    let (from, to) = text.split_once('-').unwrap_or((text, text));
    let (from, to) = (number(from)?, number(to)?);
    if from <= to {
        Ok(Range(from, to))
    } else {
        Err(format!("{text}: expected FROM not above TO"))
    }
}

//! Airspace in `OpenAir`: <https://github.com/naviter/seeyou_file_formats/blob/main/OpenAir_File_Format_Support.md>.

use openair::{Airspace, Altitude, Coord, Direction, Geometry, PolygonSegment};

use super::arcs::CircleArc;
use super::area::{AreaLimit, EdgeLine, NamedArea, Reference};
use super::limits::SaidLimit;
use super::taken::Areas;
use crate::error::InputError;
use crate::units::{FOOT_M, NAUTICAL_MILE_M};

/// Whether a text begins like such a file: with remarks and a class.
pub(super) fn is_openair(text: &str) -> bool {
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(['*', '#']));
    let word = first.and_then(|first| first.split_once([' ', '\t']));
    word.is_some_and(|(word, _)| ["AC", "AN", "AI", "AY"].contains(&word))
}

impl Areas<'_> {
    pub(super) fn take_openair(&mut self, text: &str) -> Result<(), InputError> {
        for block in blocks(text) {
            let airspace = match openair::parse(block.as_bytes()).next() {
                Some(Ok(airspace)) => airspace,
                None => continue,
                Some(Err(error)) => {
                    let name = block.lines().find_map(|line| line.strip_prefix("AN "));
                    let name = name.unwrap_or_default().trim();
                    self.leave_out(&format!("airspace {name} ({error})"));
                    continue;
                }
            };
            let Airspace {
                name,
                lower_bound,
                upper_bound,
                geom,
                activation_times,
                ..
            } = airspace;
            self.like = NamedArea {
                name: name.as_deref().and_then(Self::name),
                edges: EdgeLine::Geodesic,
                is_timed: activation_times.is_some(),
                ..NamedArea::default()
            };
            self.like.limits = [
                self.altitude(&lower_bound, "lower"),
                self.altitude(&upper_bound, "upper"),
            ];
            match geom {
                Geometry::Circle {
                    centerpoint,
                    radius,
                } => {
                    let radius_m = f64::from(radius) * NAUTICAL_MILE_M;
                    self.take_circle(&place(&centerpoint), radius_m)?;
                }
                Geometry::Polygon { segments } => {
                    let parts = segments.iter().map(places);
                    match parts.collect::<Result<Vec<_>, String>>() {
                        Err(message) => self.leave_out(&format!("airspace with {message}")),
                        Ok(parts) => {
                            let mut ring = parts.concat();
                            ring.extend(ring.first().cloned());
                            self.take(&[ring])?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn altitude(&mut self, said: &Altitude, what: &str) -> Option<AreaLimit> {
        let feet = |feet: f64, above| {
            let height_m = feet * FOOT_M;
            Some(AreaLimit { height_m, above })
        };
        match said {
            Altitude::Gnd => feet(0.0, Reference::Ground),
            Altitude::FeetAmsl(height) => feet(f64::from(*height), Reference::Sea),
            Altitude::FeetAgl(height) => feet(f64::from(*height), Reference::Ground),
            Altitude::FlightLevel(level) => feet(100.0 * f64::from(*level), Reference::Pressure),
            Altitude::Unlimited => None,
            Altitude::Other(text) => {
                let mut said = SaidLimit::default();
                said.take(text);
                self.named(&said, what)
            }
        }
    }
}

/// The lines of each airspace that say its name, its limits, its times for the first time, and its place.
fn blocks(text: &str) -> Vec<String> {
    let mut blocks: Vec<String> = Vec::new();
    let mut was_head = false;
    for line in text.trim_start_matches('\u{feff}').lines().map(str::trim) {
        let line = line.replace('\t', " ");
        let letters = line.chars().filter(|letter| !letter.is_whitespace());
        let kind: String = letters.take(2).collect();
        let is_head = ["AC", "AN", "AL", "AH", "AA"].contains(&kind.as_str());
        if !is_head && !kind.starts_with('D') && !["VX", "VD"].contains(&kind.as_str()) {
            continue;
        }
        // The crate takes two digits for degrees of latitude; some files have three.
        let words = line.split_inclusive([' ', '=', ',']);
        let line: String = words
            .map(|word| {
                word.strip_prefix('0')
                    .filter(|_| word.get(3..4) == Some(":"))
                    .unwrap_or(word)
            })
            .collect();
        // An airspace without a place, too, ends where the next class stands.
        let has_class = |block: &String| block.lines().any(|line| line.starts_with("AC"));
        let is_again = kind == "AC" && blocks.last().is_some_and(has_class);
        let is_next = is_head && (!was_head || is_again);
        was_head = is_head;
        match blocks.last_mut().filter(|_| !is_next) {
            Some(block) if kind == "AA" && block.contains("\nAA") => (),
            Some(block) => *block = format!("{block}\n{line}"),
            None => blocks.push(line),
        }
    }
    blocks
}

fn place(at: &Coord) -> [f64; 2] {
    [at.lng, at.lat]
}

fn places(segment: &PolygonSegment) -> Result<Vec<Vec<f64>>, String> {
    let arc = match segment {
        PolygonSegment::Point(at) => return Ok(vec![place(at).to_vec()]),
        PolygonSegment::Arc(arc) => {
            let ends = [place(&arc.start), place(&arc.end)];
            CircleArc::between(
                place(&arc.centerpoint),
                ends,
                arc.direction == Direction::Cw,
            )
        }
        PolygonSegment::ArcSegment(arc) => CircleArc {
            center_deg: place(&arc.centerpoint),
            radius_m: [f64::from(arc.radius) * NAUTICAL_MILE_M; 2],
            bearing_deg: [arc.angle_start, arc.angle_end].map(f64::from),
            clockwise: arc.direction == Direction::Cw,
        },
    };
    arc.places()
}

//! Airspace in AIXM 5.1, as the services of the UK and of Eurocontrol write it.

use roxmltree::{Document, Node};
use serde_json::Value;

use super::arcs::CircleArc;
use super::area::{EdgeLine, NamedArea};
use super::limits::SaidLimit;
use super::taken::Areas;
use crate::error::{InputError, shown};
use crate::units::{Dimension, Unit};

type Element<'a> = Node<'a, 'a>;

pub(super) fn is(node: &Element<'_>, name: &str) -> bool {
    node.tag_name().name() == name
}

/// The elements of some names within another one.
pub(super) fn all<'a>(node: Element<'a>, names: &[&str]) -> impl Iterator<Item = Element<'a>> {
    let named = |inner: &Element<'_>| names.contains(&inner.tag_name().name());
    node.descendants().filter(named)
}

/// The text of a child.
pub(super) fn text<'a>(node: Element<'a>, name: &str) -> Option<&'a str> {
    let child = node.children().find(|child| is(child, name))?;
    child.text().map(str::trim).filter(|text| !text.is_empty())
}

/// A ring, or a circle by its centre and its radius, metres.
enum Outline {
    Ring(Vec<Vec<f64>>),
    Circle([f64; 2], f64),
}

impl Areas<'_> {
    pub(super) fn take_aixm(&mut self, document: &Document<'_>) -> Result<(), InputError> {
        for slice in all(document.root(), &["AirspaceTimeSlice"]) {
            let names = [text(slice, "name"), text(slice, "designator")].into_iter();
            let name = names.flatten().find_map(Self::name);
            let is_timed = slice.children().any(|child| is(&child, "activation"));
            for part in all(slice, &["AirspaceGeometryComponent"]) {
                if text(part, "operation") == Some("SUBTR") {
                    self.leave_out("volume to subtract (SUBTR)");
                    continue;
                }
                let Some(volume) = all(part, &["AirspaceVolume"]).next() else {
                    continue;
                };
                self.like = NamedArea {
                    name: name.clone(),
                    edges: EdgeLine::Geodesic,
                    is_timed,
                    ..NamedArea::default()
                };
                self.like.limits = ["lower", "upper"].map(|side| self.aixm_limit(volume, side));
                let Some(surface) = all(volume, &["horizontalProjection"]).next() else {
                    self.leave_out("volume without an outline of its own");
                    continue;
                };
                let rings = all(surface, &["exterior", "interior"]);
                let outlines = match rings.map(outline).collect::<Result<Vec<Outline>, String>>() {
                    Ok(outlines) => outlines,
                    Err(message) => {
                        self.leave_out(&format!("volume with {message}"));
                        continue;
                    }
                };
                if let [Outline::Circle(center, radius_m)] = &outlines[..] {
                    self.take_circle(center, *radius_m)?;
                    continue;
                }
                let rings = outlines.into_iter().map(|outline| match outline {
                    Outline::Ring(ring) => Some(ring),
                    Outline::Circle(..) => None,
                });
                match rings.collect::<Option<Vec<_>>>() {
                    Some(rings) if !rings.is_empty() => self.take(&rings)?,
                    _ => self.leave_out("volume with an outline of another kind"),
                }
            }
        }
        Ok(())
    }

    fn aixm_limit(&mut self, volume: Element<'_>, side: &str) -> Option<super::AreaLimit> {
        let name = format!("{side}Limit");
        let mut said = SaidLimit::default();
        let node = volume.children().find(|child| is(child, &name))?;
        let height = node.text().unwrap_or_default().trim();
        said.take(height);
        if let Some(unit) = node.attribute("uom") {
            said.take_unit(&Value::from(unit));
        }
        if let Some(reference) = text(volume, &format!("{name}Reference"))
            && !["GND", "SFC", "UNL"].contains(&height)
        {
            said.take_reference(&Value::from(reference));
        }
        self.named(&said, side)
    }
}

/// The outline of a ring of GML.
fn outline(ring: Element<'_>) -> Result<Outline, String> {
    let mut places: Vec<Vec<f64>> = Vec::new();
    for node in ring.descendants().filter(Node::is_element) {
        if node.attributes().any(|given| given.name() == "href") {
            return Err("an outline elsewhere (xlink)".into());
        }
        match node.tag_name().name() {
            "GeodesicString" | "Geodesic" | "LineStringSegment" | "LinearRing" => {
                places.extend(positions(node)?);
            }
            "CircleByCenterPoint" => {
                let center = center(node)?;
                return Ok(Outline::Circle(center, length_m(node)?));
            }
            "ArcByCenterPoint" => {
                let angle = |name: &str| text(node, name).and_then(|text| text.parse().ok());
                let (Some(begin), Some(end)) = (angle("startAngle"), angle("endAngle")) else {
                    return Err("an arc without angles".into());
                };
                // In latitude and longitude angles grow from north to east.
                let arc = CircleArc {
                    center_deg: center(node)?,
                    radius_m: [length_m(node)?; 2],
                    bearing_deg: [begin, end],
                    clockwise: end >= begin,
                };
                places.extend(arc.places()?);
            }
            "Arc" | "ArcString" | "Circle" | "CubicSpline" | "Bezier" | "Clothoid" => {
                return Err(format!("a curve of the kind {}", node.tag_name().name()));
            }
            _ => (),
        }
    }
    places.dedup();
    if places.first() != places.last() {
        places.extend(places.first().cloned());
    }
    Ok(Outline::Ring(places))
}

/// Longitudes and latitudes of the positions within an element.
fn positions(node: Element<'_>) -> Result<Vec<Vec<f64>>, String> {
    let mut places = Vec::new();
    for inner in all(node, &["pos", "posList"]) {
        let mut named = inner
            .ancestors()
            .filter_map(|outer| outer.attribute("srsName"));
        let is_longitude_first = match named.next() {
            None => false,
            Some(name) if name.contains("CRS84") => true,
            Some(name) if name.contains("4326") => false,
            Some(name) => return Err(format!("the coordinates {}", shown(name))),
        };
        let numbers = inner
            .text()
            .unwrap_or_default()
            .split_whitespace()
            .map(str::parse);
        let numbers: Result<Vec<f64>, _> = numbers.collect();
        let numbers = numbers.map_err(|_| "a position that is no number".to_owned())?;
        for pair in numbers.chunks(2) {
            match *pair {
                [longitude, latitude] if is_longitude_first => {
                    places.push(vec![longitude, latitude]);
                }
                [latitude, longitude] => places.push(vec![longitude, latitude]),
                _ => return Err("half a position".into()),
            }
        }
    }
    Ok(places)
}

fn center(node: Element<'_>) -> Result<[f64; 2], String> {
    match positions(node)?.first().map(Vec::as_slice) {
        Some(&[longitude, latitude]) => Ok([longitude, latitude]),
        _ => Err("a circle without a centre".into()),
    }
}

fn length_m(node: Element<'_>) -> Result<f64, String> {
    let radius = node.children().find(|child| is(child, "radius"));
    let radius = radius.ok_or("a circle without a radius")?;
    let unit = radius.attribute("uom").unwrap_or_default();
    let unit = Unit::parse(unit.trim_matches(['[', ']']).trim_end_matches("_i"));
    let unit = unit.filter(|unit| unit.dimension == Dimension::Length);
    let value: Option<f64> = radius.text().and_then(|text| text.trim().parse().ok());
    let length = value.zip(unit).map(|(value, unit)| unit.to_si(value));
    length.ok_or_else(|| "a radius without a known unit".into())
}

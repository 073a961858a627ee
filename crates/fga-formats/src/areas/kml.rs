//! Areas in KML.

use roxmltree::Document;

use serde_json::Value;

use super::aixm::{all, is, text};
use super::area::{EdgeLine, NamedArea};
use super::taken::Areas;
use crate::error::{InputError, shown};

impl Areas<'_> {
    pub(super) fn take_kml(&mut self, document: &Document<'_>) -> Result<(), InputError> {
        for node in document.descendants() {
            let what = match node.tag_name().name() {
                "Point" => "point",
                "LineString" | "LinearRing"
                    if !node.ancestors().any(|outer| is(&outer, "Polygon")) =>
                {
                    "line"
                }
                "Track" | "MultiTrack" => "track",
                "Model" => "model",
                "NetworkLink" => "link to another file (NetworkLink)",
                "GroundOverlay" => "image (GroundOverlay)",
                _ => "",
            };
            if !what.is_empty() {
                self.leave_out(what);
            }
            if !is(&node, "Polygon") {
                continue;
            }
            let placemark = node.ancestors().find(|outer| is(outer, "Placemark"));
            let name = placemark.and_then(|outer| text(outer, "name"));
            self.like = NamedArea {
                name: name.and_then(Self::name),
                edges: EdgeLine::Geodesic,
                ..NamedArea::default()
            };
            let data = placemark.into_iter();
            let data = data.flat_map(|outer| all(outer, &["Data", "SimpleData"]));
            let data = data.filter_map(|inner| {
                let value = inner.descendants().find(|value| is(value, "value"));
                let value = value.unwrap_or(inner).text()?.trim();
                Some((inner.attribute("name")?.to_owned(), Value::from(value)))
            });
            self.take_limits(&data.collect(), None);
            let mode = text(node, "altitudeMode").unwrap_or_default();
            let is_clamped = ["", "clampToGround", "clampToSeaFloor"].contains(&mode);
            let mut rings = Vec::new();
            for ring in node.descendants().filter(|inner| is(inner, "coordinates")) {
                let places = ring.text().unwrap_or_default().split_whitespace();
                let numbers = places.map(|place| place.split(',').map(str::parse).collect());
                match numbers.collect::<Result<Vec<Vec<f64>>, _>>() {
                    Ok(places) => {
                        let is_hole = ring.ancestors().any(|outer| is(&outer, "innerBoundaryIs"));
                        rings.push((is_hole, places));
                    }
                    Err(_) => {
                        return self.refuse(
                            "has a corner that is no row of numbers, expected longitude,latitude",
                        );
                    }
                }
            }
            rings.sort_by_key(|(is_hole, _)| *is_hole);
            let rings: Vec<_> = rings.into_iter().map(|(_, ring)| ring).collect();
            let is_high = |place: &Vec<f64>| place.get(2).is_some_and(|height_m| *height_m != 0.0);
            if !is_clamped && rings.iter().flatten().any(is_high) {
                self.note(&format!(
                    "has heights at its corners (altitudeMode {}), which are not read as limits",
                    shown(mode)
                ));
            }
            self.take(&rings)?;
        }
        Ok(())
    }
}

//! Areas in KML.

use roxmltree::{Document, Node};

use super::{Areas, NamedArea};
use crate::error::InputError;

impl Areas<'_> {
    pub(super) fn take_kml(&mut self, text: &str) -> Result<(), InputError> {
        let document = Document::parse(text).map_err(|error| {
            let line = u64::from(error.pos().row);
            self.unreadable(line, "KML", error.to_string().split(" at ").next())
        })?;
        let is = |node: &Node<'_, '_>, name: &str| node.tag_name().name() == name;
        for node in document.descendants() {
            if ["Point", "LineString", "Track", "Model"]
                .iter()
                .any(|name| is(&node, name))
            {
                return self.refuse("is no area, expected Polygon");
            }
            if !is(&node, "Polygon") {
                continue;
            }
            let placemark = node.ancestors().find(|outer| is(outer, "Placemark"));
            let name = placemark.and_then(|outer| {
                let mut inner = outer.children();
                inner.find(|child| is(child, "name"))?.text()
            });
            self.like = NamedArea {
                name: name.and_then(Self::name),
                ..NamedArea::default()
            };
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
            self.take(&rings)?;
        }
        Ok(())
    }
}

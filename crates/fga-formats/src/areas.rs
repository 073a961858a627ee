//! Polygons of an area: GeoJSON (RFC 7946) and KML 2.2.
//!
//! Both hold corners as longitude, latitude and perhaps an altitude, and end a ring with its first corner. Nothing of a file is left
//! out: what is no polygon, and a polygon with a hole, is refused.

use std::path::Path;

use roxmltree::{Document, Node};
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::error::{InputError, read_text};

/// A polygon of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedArea {
    /// Its name.
    pub name: Option<String>,
    /// Latitude and longitude of each corner, degrees; the last is joined to the first.
    pub corners_deg: Vec<[f64; 2]>,
}

/// Reads the polygons of a GeoJSON or a KML file, at least one.
///
/// # Errors
/// An unreadable file, one of neither kind, anything but polygons without holes, a ring that is not closed, a corner out of range.
pub fn read(path: &Path) -> Result<Vec<NamedArea>, InputError> {
    parse(&read_text(path)?, path)
}

/// The same of a file's text; the name of its kind decides nothing.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Vec<NamedArea>, InputError> {
    let mut areas = Areas {
        path,
        all: Vec::new(),
    };
    if text.trim_start().starts_with('<') {
        areas.take_kml(text)?;
    } else {
        let json = serde_json::from_str(text).map_err(|error| {
            let line = u64::try_from(error.line()).unwrap_or(1);
            let told = error.to_string();
            let told = told.split(" at line ").next().unwrap_or_default();
            InputError::at_line(path, line, format!("is no GeoJSON and no KML: {told}"))
        })?;
        areas.take_geojson(json, None)?;
    }
    if areas.all.is_empty() {
        return Err(InputError::in_file(
            path,
            "has no polygon, expected at least one",
        ));
    }
    Ok(areas.all)
}

/// An object of GeoJSON.
#[derive(Debug, Deserialize)]
#[serde(tag = "type")]
enum GeoJson {
    FeatureCollection {
        features: Vec<Self>,
    },
    Feature {
        geometry: Option<Box<Self>>,
        properties: Option<Map<String, Value>>,
    },
    GeometryCollection {
        geometries: Vec<Self>,
    },
    Polygon {
        coordinates: Vec<Vec<Vec<f64>>>,
    },
    MultiPolygon {
        coordinates: Vec<Vec<Vec<Vec<f64>>>>,
    },
    #[serde(other)]
    Other,
}

struct Areas<'a> {
    path: &'a Path,
    all: Vec<NamedArea>,
}

impl Areas<'_> {
    fn refuse<T>(&self, message: &str) -> Result<T, InputError> {
        let number = self.all.len() + 1;
        let message = format!("polygon {number} {message}");
        Err(InputError::in_file(self.path, message))
    }

    fn take_geojson(&mut self, json: GeoJson, name: Option<&str>) -> Result<(), InputError> {
        match json {
            GeoJson::FeatureCollection { features: all }
            | GeoJson::GeometryCollection { geometries: all } => {
                for each in all {
                    self.take_geojson(each, name)?;
                }
                Ok(())
            }
            GeoJson::Feature {
                geometry,
                properties,
            } => {
                let name = properties
                    .as_ref()
                    .and_then(|all| all.get("name")?.as_str());
                match geometry {
                    Some(geometry) => self.take_geojson(*geometry, name),
                    None => self.refuse("is a feature without a place, expected a polygon"),
                }
            }
            GeoJson::Polygon { coordinates } => self.take(name, &coordinates),
            GeoJson::MultiPolygon { coordinates } => {
                let mut all = coordinates.iter();
                all.try_for_each(|rings| self.take(name, rings))
            }
            GeoJson::Other => self.refuse("is no polygon, expected Polygon or MultiPolygon"),
        }
    }

    fn take_kml(&mut self, text: &str) -> Result<(), InputError> {
        let document = Document::parse(text).map_err(|error| {
            let line = u64::from(error.pos().row);
            let told = error.to_string();
            let told = told.split(" at ").next().unwrap_or_default();
            InputError::at_line(self.path, line, format!("is no KML: {told}"))
        })?;
        let is = |node: &Node<'_, '_>, name: &str| node.tag_name().name() == name;
        for node in document.descendants() {
            if ["Point", "LineString", "Track", "Model"]
                .iter()
                .any(|name| is(&node, name))
            {
                return self.refuse("is no polygon, expected Polygon");
            }
            if !is(&node, "Polygon") {
                continue;
            }
            let mut rings = Vec::new();
            for ring in node.descendants().filter(|inner| is(inner, "coordinates")) {
                let places = ring.text().unwrap_or_default().split_whitespace();
                let numbers = places.map(|place| place.split(',').map(str::parse).collect());
                match numbers.collect::<Result<Vec<Vec<f64>>, _>>() {
                    Ok(ring) => rings.push(ring),
                    Err(_) => {
                        return self.refuse(
                            "has a corner that is no row of numbers, expected longitude,latitude",
                        );
                    }
                }
            }
            let placemark = node.ancestors().find(|outer| is(outer, "Placemark"));
            let name = placemark.and_then(|outer| {
                let mut inner = outer.children();
                inner.find(|child| is(child, "name"))?.text()
            });
            self.take(name.map(str::trim), &rings)?;
        }
        Ok(())
    }

    /// Takes a polygon by its rings, the first of which is its outline.
    fn take(&mut self, name: Option<&str>, rings: &[Vec<Vec<f64>>]) -> Result<(), InputError> {
        let [outline] = rings else {
            return self.refuse(match rings {
                [] => "has no corners, expected a ring",
                _ => "has a hole, expected one without: what surrounds a hole takes two polygons",
            });
        };
        let [corners @ .., last] = outline.as_slice() else {
            return self.refuse("has no corners, expected a ring");
        };
        // Altitudes do not count.
        if corners.first().map(|first| first.get(..2)) != Some(last.get(..2)) {
            return self.refuse("is not closed, expected its first corner at its end again");
        }
        let mut corners_deg = Vec::new();
        for (corner, number) in corners.iter().zip(1..) {
            match *corner.as_slice() {
                [longitude_deg, latitude_deg, ..]
                    if latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0 =>
                {
                    corners_deg.push([latitude_deg, longitude_deg]);
                }
                _ => {
                    return self.refuse(&format!(
                        "has corner {number} out of range, expected longitude from -180 to 180 and latitude from -90 to 90"
                    ));
                }
            }
        }
        let name = name.filter(|name| !name.is_empty()).map(str::to_owned);
        self.all.push(NamedArea { name, corners_deg });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RING: &str = "[[8.5,47.3],[8.6,47.3],[8.6,47.4],[8.5,47.3]]";

    fn areas(text: &str) -> Result<Vec<NamedArea>, String> {
        parse(text, Path::new("a")).map_err(|error| error.to_string())
    }

    fn triangle(name: Option<&str>) -> NamedArea {
        NamedArea {
            name: name.map(str::to_owned),
            corners_deg: vec![[47.3, 8.5], [47.3, 8.6], [47.4, 8.6]],
        }
    }

    #[test]
    fn polygons_of_geojson_and_kml_are_the_same() {
        let polygon = format!(r#"{{"type":"Polygon","coordinates":[{RING}]}}"#);
        assert_eq!(areas(&polygon).unwrap(), [triangle(None)]);
        let many = format!(r#"{{"type":"MultiPolygon","coordinates":[[{RING}],[{RING}]]}}"#);
        let file = format!(
            r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","properties":{{"name":"yard"}},"geometry":{polygon}}},
            {{"type":"Feature","properties":null,"geometry":{many}}}]}}"#
        );
        let all = [triangle(Some("yard")), triangle(None), triangle(None)];
        assert_eq!(areas(&file).unwrap(), all);
        let kml = "<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><Placemark><name> yard </name>
            <Polygon><outerBoundaryIs><LinearRing><coordinates>
            8.5,47.3,0 8.6,47.3,0
            8.6,47.4 8.5,47.3,90</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>";
        assert_eq!(areas(kml).unwrap(), [triangle(Some("yard"))]);
    }

    #[test]
    fn what_is_no_polygon_is_one_sentence() {
        for (text, expected) in [
            ("", "is no GeoJSON and no KML"),
            (
                r#"{"type":"Polygon","coordinates":[[[8.5,47.3]"#,
                "is no GeoJSON and no KML",
            ),
            (
                r#"{"type":"Polygon","coordinates":[[[8.5,NaN]]]}"#,
                "is no GeoJSON and no KML",
            ),
            (
                r#"{"type":"Polygon","coordinates":[]}"#,
                "polygon 1 has no corners",
            ),
            (
                r#"{"type":"Polygon","coordinates":[[]]}"#,
                "polygon 1 has no corners",
            ),
            (
                r#"{"type":"Polygon","coordinates":[[[1,2],[3,4],[5,6]]]}"#,
                "polygon 1 is not closed",
            ),
            (
                r#"{"type":"Polygon","coordinates":[[[1,2],[3],[5,6],[1,2]]]}"#,
                "corner 2 out of range",
            ),
            (
                r#"{"type":"Polygon","coordinates":[[[1,97],[3,4],[5,6],[1,97]]]}"#,
                "corner 1 out of range",
            ),
            (
                r#"{"type":"Point","coordinates":[1,2]}"#,
                "polygon 1 is no polygon",
            ),
            (
                r#"{"type":"FeatureCollection","features":[]}"#,
                "has no polygon",
            ),
            (
                r#"{"type":"Feature","geometry":null,"properties":null}"#,
                "without a place",
            ),
            ("<kml><Polygon>", "is no KML"),
            ("<kml></kml>", "has no polygon"),
            ("<kml><Point/></kml>", "polygon 1 is no polygon"),
            (
                "<kml><Polygon><coordinates>1,x</coordinates></Polygon></kml>",
                "no row of numbers",
            ),
            (
                "<kml><Polygon><coordinates>1,NaN 2,3 1,NaN</coordinates></Polygon></kml>",
                "not closed",
            ),
        ] {
            let told = areas(text).unwrap_err();
            assert!(
                told.contains(expected) && !told.contains('\n'),
                "{text}: {told}"
            );
        }
        let hole = format!(r#"{{"type":"Polygon","coordinates":[{RING},{RING}]}}"#);
        assert!(areas(&hole).unwrap_err().contains("has a hole"));
    }
}

//! Areas of a map and of authorities: GeoJSON (RFC 7946), KML 2.2, and UAS geographical zones as EUROCAE ED-269 and ED-318 write them.
//!
//! All hold corners as longitude, latitude and perhaps an altitude, and end a ring with its first corner. Nothing of a file is left
//! out: what is no area is refused.

mod ed269;
mod geojson;
mod kml;

use core::fmt::Display;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::{InputError, read_text};
use crate::units::FOOT_M;

/// A circle has at most this radius, metres.
const LARGEST_M: f64 = 1e7;

/// An area of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NamedArea {
    /// Its name.
    pub name: Option<String>,
    /// Its outline.
    pub outline: AreaOutline,
    /// Its floor and its ceiling, where the file states them.
    pub limits: [Option<AreaLimit>; 2],
    /// Whether the file restricts no flight in it (`NO_RESTRICTION`).
    pub is_free: bool,
    /// Whether the file states times at which it applies.
    pub is_timed: bool,
}

/// The outline of an area.
#[derive(Debug, Clone, PartialEq)]
pub enum AreaOutline {
    /// A polygon by its rings, the outline and its holes: latitude and longitude of each corner, degrees; the last corner of a ring is
    /// joined to the first.
    Polygon(Vec<Vec<[f64; 2]>>),
    /// A circle.
    Circle {
        /// Latitude and longitude of its centre, degrees.
        center_deg: [f64; 2],
        /// Its radius, metres.
        radius_m: f64,
    },
}

impl Default for AreaOutline {
    fn default() -> Self {
        Self::Polygon(Vec::new())
    }
}

/// A limit of an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaLimit {
    /// Metres above the reference.
    pub height_m: f64,
    /// What it counts from.
    pub above: Reference,
}

/// What a limit counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// Mean sea level (`AMSL`).
    Sea,
    /// The ground or the water (`AGL`).
    Ground,
    /// The ellipsoid of WGS 84 (`WGS84`).
    Ellipsoid,
}

/// Reads the areas of a file, at least one.
///
/// # Errors
/// An unreadable file, one of no kind that is read here, anything but polygons and circles, a ring that is not closed, a corner out of
/// range, a limit without a known unit and reference.
pub fn read(path: &Path) -> Result<Vec<NamedArea>, InputError> {
    parse(&read_text(path)?, path)
}

/// The same of a file's text; its content decides its kind.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Vec<NamedArea>, InputError> {
    let mut areas = Areas {
        path,
        like: NamedArea::default(),
        all: Vec::new(),
    };
    if text.trim_start().starts_with('<') {
        areas.take_kml(text)?;
    } else if text.contains("\"horizontalProjection\"") {
        areas.take_ed269(areas.json(text, "ED-269")?)?;
    } else {
        areas.take_geojson(areas.json(text, "GeoJSON, no ED-269 and no KML")?)?;
    }
    if areas.all.is_empty() {
        return Err(InputError::in_file(
            path,
            "has no area, expected at least one",
        ));
    }
    Ok(areas.all)
}

/// The areas of a file so far.
struct Areas<'a> {
    path: &'a Path,
    /// What the file says of the next one.
    like: NamedArea,
    all: Vec<NamedArea>,
}

impl Areas<'_> {
    fn json<T: DeserializeOwned>(&self, text: &str, kind: &str) -> Result<T, InputError> {
        serde_json::from_str(text).map_err(|error| {
            let line = u64::try_from(error.line()).unwrap_or(1);
            self.unreadable(line, kind, error.to_string().split(" at line ").next())
        })
    }

    /// What is wrong with the text of a kind, as one line whatever it quotes.
    fn unreadable(&self, line: u64, kind: &str, told: Option<&str>) -> InputError {
        let told = told.unwrap_or_default().replace(char::is_control, " ");
        InputError::at_line(self.path, line, format!("is no {kind}: {told}"))
    }

    fn refuse<T>(&self, message: impl Display) -> Result<T, InputError> {
        let number = self.all.len() + 1;
        let name = self.like.name.as_ref();
        let name = name.map_or_else(String::new, |name| format!(" ({name})"));
        let message = format!("area {number}{name} {message}");
        Err(InputError::in_file(self.path, message))
    }

    /// Takes a polygon by its rings, the first of which is its outline.
    fn take(&mut self, rings: &[Vec<Vec<f64>>]) -> Result<(), InputError> {
        let mut rings_deg = Vec::new();
        for ring in rings {
            let [corners @ .., last] = ring.as_slice() else {
                return self.refuse("has no corners, expected a ring");
            };
            // Altitudes do not count.
            if corners.first().map(|first| first.get(..2)) != Some(last.get(..2)) {
                return self.refuse("is not closed, expected its first corner at its end again");
            }
            let corners = corners.iter().zip(1..);
            let corners =
                corners.map(|(at, number)| self.place(at, format_args!("corner {number}")));
            let mut corners_deg = corners.collect::<Result<Vec<_>, _>>()?;
            // Published outlines repeat a corner.
            corners_deg.dedup();
            if corners_deg.len() > 1 && corners_deg.first() == corners_deg.last() {
                corners_deg.pop();
            }
            rings_deg.push(corners_deg);
        }
        if rings_deg.is_empty() {
            return self.refuse("has no corners, expected a ring");
        }
        self.push(AreaOutline::Polygon(rings_deg));
        Ok(())
    }

    fn take_circle(&mut self, center: &[f64], radius_m: f64) -> Result<(), InputError> {
        let center_deg = self.place(center, "its centre")?;
        if !(radius_m > 0.0 && radius_m <= LARGEST_M) {
            return self.refuse(format_args!(
                "has a radius of {radius_m} m, expected more than 0, up to 10,000 km"
            ));
        }
        self.push(AreaOutline::Circle {
            center_deg,
            radius_m,
        });
        Ok(())
    }

    /// A name as one line, unless it is empty.
    fn name(text: &str) -> Option<String> {
        let words = text.split(|each: char| each.is_whitespace() || each.is_control());
        let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
        (!words.is_empty()).then(|| words.join(" "))
    }

    fn push(&mut self, outline: AreaOutline) {
        let like = self.like.clone();
        self.all.push(NamedArea { outline, ..like });
    }

    /// Latitude and longitude of a place, degrees.
    fn place(&self, at: &[f64], what: impl Display) -> Result<[f64; 2], InputError> {
        let is_place = |latitude_deg: f64, longitude_deg: f64| {
            latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0
        };
        match *at {
            [longitude_deg, latitude_deg, ..] if is_place(latitude_deg, longitude_deg) => {
                Ok([latitude_deg, longitude_deg])
            }
            [one, other, ..] if is_place(one, other) => self.refuse(format_args!(
                "has {what} out of range: latitude and longitude look exchanged, expected the longitude first"
            )),
            _ => self.refuse(format_args!(
                "has {what} out of range, expected longitude from -180 to 180 and latitude from -90 to 90"
            )),
        }
    }

    /// A unit of lengths, metres.
    fn unit_m(&self, unit: &str) -> Result<f64, InputError> {
        match unit.to_ascii_lowercase().as_str() {
            "m" => Ok(1.0),
            "ft" => Ok(FOOT_M),
            _ => self.refuse(format_args!("has the unit {unit:?}, expected m or ft")),
        }
    }

    /// A limit in a unit, metres, above a reference; `None` without one.
    fn limit(
        &self,
        value: Option<&Value>,
        unit_m: f64,
        reference: Option<&str>,
    ) -> Result<Option<AreaLimit>, InputError> {
        let height = match value {
            None | Some(Value::Null) => return Ok(None),
            // Some authorities write numbers as texts.
            Some(Value::String(text)) => text.trim().parse().ok(),
            Some(other) => other.as_f64(),
        };
        let Some(height) = height.filter(|height| height.is_finite()) else {
            let value = value.unwrap_or(&Value::Null);
            return self.refuse(format_args!("has the limit {value}, expected a number"));
        };
        let above = match reference.map(str::to_ascii_uppercase).as_deref() {
            Some("AMSL") => Reference::Sea,
            Some("AGL") => Reference::Ground,
            Some("WGS84") => Reference::Ellipsoid,
            other => {
                let other = other.unwrap_or_default();
                return self.refuse(format_args!(
                    "has a limit above {other:?}, expected the vertical reference AGL, AMSL or WGS84"
                ));
            }
        };
        let height_m = height * unit_m;
        Ok(Some(AreaLimit { height_m, above }))
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
        let corners_deg = vec![[47.3, 8.5], [47.3, 8.6], [47.4, 8.6]];
        NamedArea {
            name: name.map(str::to_owned),
            outline: AreaOutline::Polygon(vec![corners_deg]),
            ..NamedArea::default()
        }
    }

    fn circle(name: &str, radius_m: f64) -> NamedArea {
        NamedArea {
            name: Some(name.to_owned()),
            outline: AreaOutline::Circle {
                center_deg: [47.3, 8.5],
                radius_m,
            },
            ..NamedArea::default()
        }
    }

    const fn above(above: Reference, height_m: f64) -> AreaLimit {
        AreaLimit { height_m, above }
    }

    /// A zone of ED-269 with some volumes.
    fn ed269(volumes: &str) -> String {
        format!(
            r#"{{"title":"made","features":[{{"identifier":"AAA001","country":"XXX","name":"yard","type":"COMMON",
            "restriction":"CONDITIONAL","reason":["NOISE"],"applicability":[{{"permanent":"NO"}}],"geometry":[{volumes}]}}]}}"#
        )
    }

    /// A volume of ED-269 with an outline.
    fn volume(projection: &str) -> String {
        format!(
            r#"{{"uomDimensions":"M","lowerLimit":0,"lowerVerticalReference":"AGL","upperLimit":120,"upperVerticalReference":"AGL",
            "horizontalProjection":{projection}}}"#
        )
    }

    /// A zone of ED-318 with a geometry.
    fn ed318(geometry: &str) -> String {
        format!(
            r#"{{"type":"FeatureCollection","metadata":{{"issued":"2026-01-01T00:00:00Z"}},"features":[{{"type":"Feature","properties":
            {{"identifier":"AAA001","country":"XXX","name":[{{"text":"yard","lang":"en-GB"}}],"type":"NO_RESTRICTION","variant":"COMMON",
            "limitedApplicability":[{{"schedule":[{{"day":["ANY"]}}]}}]}},"geometry":{geometry}}}]}}"#
        )
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
    fn repeated_corners_are_one_and_names_are_one_line() {
        let ring = "[[8.5,47.3],[8.5,47.3],[8.6,47.3],[8.6,47.4],[8.5,47.3,9],[8.5,47.3]]";
        let polygon = polygon(&format!("[{ring}]"));
        let file = format!(
            r#"{{"type":"Feature","properties":{{"name":" the\n yard\u001b "}},"geometry":{polygon}}}"#
        );
        assert_eq!(areas(&file).unwrap(), [triangle(Some("the yard"))]);
    }

    #[test]
    fn holes_are_rings_after_the_outline() {
        let hole = "[[8.58,47.31],[8.59,47.31],[8.59,47.32],[8.58,47.31]]";
        let rings = vec![
            vec![[47.3, 8.5], [47.3, 8.6], [47.4, 8.6]],
            vec![[47.31, 8.58], [47.31, 8.59], [47.32, 8.59]],
        ];
        let outline = AreaOutline::Polygon(rings);
        let polygon = format!(r#"{{"type":"Polygon","coordinates":[{RING},{hole}]}}"#);
        assert_eq!(areas(&polygon).unwrap()[0].outline, outline);
        assert_eq!(
            areas(&ed269(&volume(&polygon))).unwrap()[0].outline,
            outline
        );
        let kml = "<kml><Polygon><innerBoundaryIs><coordinates>8.58,47.31 8.59,47.31 8.59,47.32 8.58,47.31</coordinates></innerBoundaryIs>
            <outerBoundaryIs><coordinates>8.5,47.3 8.6,47.3 8.6,47.4 8.5,47.3</coordinates></outerBoundaryIs></Polygon></kml>";
        assert_eq!(areas(kml).unwrap()[0].outline, outline);
    }

    #[test]
    fn zones_of_ed269_have_volumes_limits_and_times() {
        let polygon = volume(&format!(r#"{{"type":"Polygon","coordinates":[{RING}]}}"#));
        let feet = volume(r#"{"type":"Circle","center":[8.5,47.3],"radius":1000}"#)
            .replace(r#""M""#, r#""ft""#)
            .replace(
                r#""upperLimit":120,"upperVerticalReference":"AGL""#,
                r#""upperLimit":"2500","upperVerticalReference":"AMSL""#,
            );
        let file = ed269(&format!("{polygon},{feet}"));
        let common = NamedArea {
            is_timed: true,
            ..triangle(Some("yard"))
        };
        let ground = Some(above(Reference::Ground, 0.0));
        let expected = [
            NamedArea {
                limits: [ground, Some(above(Reference::Ground, 120.0))],
                ..common.clone()
            },
            NamedArea {
                limits: [ground, Some(above(Reference::Sea, 762.0))],
                outline: circle("yard", 304.8).outline,
                ..common
            },
        ];
        assert_eq!(areas(&file).unwrap(), expected);
        // The list of the interface that serves zones, limits that are absent, and a zone that restricts nothing.
        let file = file
            .replace(r#""features""#, r#""UASZoneList""#)
            .replace(r#""upperLimit":120"#, r#""upperLimit":null"#)
            .replace(r#"[{"permanent":"NO"}]"#, r#"{"permanent":"YES"}"#)
            .replace("CONDITIONAL", "NO_RESTRICTION")
            .replace(r#""name":"yard""#, r#""name":" ""#);
        let found = areas(&file).unwrap();
        assert_eq!(found[0].limits, [ground, None]);
        assert_eq!(found[0].name.as_deref(), Some("AAA001"));
        assert_eq!((found[0].is_free, found[0].is_timed), (true, false));
    }

    #[test]
    fn zones_of_ed318_have_layers_and_circles() {
        let layer = r#""layer":{"upper":2000,"upperReference":"AMSL","lower":0,"lowerReference":"AGL","uom":"ft"}"#;
        let point = r#""type":"Point","coordinates":[8.5,47.3],"extent":{"subType":"Circle","radius":1000}"#;
        let polygon = format!(
            r#"{{"type":"Polygon","coordinates":[{RING}],"layer":{{"upper":900,"upperReference":"WGS84","lower":50,"lowerReference":"AGL"}}}}"#
        );
        let file = ed318(&format!(
            r#"{{"type":"GeometryCollection","geometries":[{{{point},{layer}}},{polygon},{{{point}}}]}}"#
        ));
        let said = NamedArea {
            is_free: true,
            is_timed: true,
            ..circle("yard", 1000.0)
        };
        let expected = [
            NamedArea {
                limits: [
                    Some(above(Reference::Ground, 0.0)),
                    Some(above(Reference::Sea, 609.6)),
                ],
                ..said.clone()
            },
            NamedArea {
                limits: [
                    Some(above(Reference::Ground, 50.0)),
                    Some(above(Reference::Ellipsoid, 900.0)),
                ],
                outline: triangle(None).outline,
                ..said.clone()
            },
            said,
        ];
        assert_eq!(areas(&file).unwrap(), expected);
        // As ENAIRE writes them.
        let file = format!(
            r#"{{"type":"Feature","properties":{{"UASZone":{{"identifier":"AAA","name":"","type":"PROHIBITED"}},"verticalLayer":
            {{"upper":900,"upperReference":"AGL","lower":45,"lowerReference":"AGL","UOM":""}}}},"geometry":{{"type":"Polygon",
            "coordinates":[{RING}]}}}}"#
        );
        let expected = NamedArea {
            limits: [
                Some(above(Reference::Ground, 45.0)),
                Some(above(Reference::Ground, 900.0)),
            ],
            ..triangle(Some("AAA"))
        };
        assert_eq!(areas(&file).unwrap(), [expected]);
    }

    fn refused(all: &[(String, &str)]) {
        for (text, expected) in all {
            let told = areas(text).expect_err(text);
            assert!(
                told.contains(expected) && !told.contains('\n'),
                "{text}: {told}"
            );
        }
    }

    fn polygon(rings: &str) -> String {
        format!(r#"{{"type":"Polygon","coordinates":{rings}}}"#)
    }

    #[test]
    fn what_is_no_area_is_one_sentence() {
        refused(&[
            (String::new(), "is no GeoJSON, no ED-269 and no KML"),
            (
                polygon("[[[8.5,47.3]").replace('}', ""),
                "line 1: is no GeoJSON",
            ),
            (polygon("[[[8.5,NaN]]]"), "line 1: is no GeoJSON"),
            (polygon("[[[8.5,1e999]]]"), "line 1: is no GeoJSON"),
            (polygon("[]"), "area 1 has no corners"),
            (polygon("[[]]"), "area 1 has no corners"),
            (polygon("[[[1,2],[3,4],[5,6]]]"), "area 1 is not closed"),
            (
                polygon("[[[1,2],[3],[5,6],[1,2]]]"),
                "corner 2 out of range",
            ),
            (
                polygon("[[[1,197],[3,4],[5,6],[1,197]]]"),
                "corner 1 out of range",
            ),
            (
                polygon("[[[47,108],[47,109],[48,108],[47,108]]]"),
                "latitude and longitude look exchanged",
            ),
            (polygon(&format!("[{RING},[]]")), "area 1 has no corners"),
            (
                r#"{"type":"Point","coordinates":[1,2]}"#.into(),
                "area 1 is no area",
            ),
            (
                r#"{"type":"FeatureCollection","features":[]}"#.into(),
                "has no area",
            ),
            (
                r#"{"type":"Feature","geometry":null,"properties":null}"#.into(),
                "without a place",
            ),
            ("<kml><Polygon>".into(), "is no KML"),
            ("<kml><a/\n></kml>".into(), "line 1: is no KML"),
            ("<kml></kml>".into(), "has no area"),
            ("<kml><Point/></kml>".into(), "area 1 is no area"),
            (
                "<kml><Polygon><coordinates>1,x</coordinates></Polygon></kml>".into(),
                "no row of numbers",
            ),
            (
                "<kml><Polygon><coordinates>1,NaN 2,3 1,NaN</coordinates></Polygon></kml>".into(),
                "not closed",
            ),
        ]);
    }

    #[test]
    fn what_is_no_zone_of_an_authority_is_one_sentence() {
        let made = ed269(&volume(&polygon(&format!("[{RING}]"))));
        let round = |circle: &str| ed269(&volume(circle));
        let point = |extent: &str| {
            ed318(&format!(
                r#"{{"type":"Point","coordinates":[8.5,47.3],"extent":{{{extent}}}}}"#
            ))
        };
        let layer = |layer: &str| {
            ed318(&format!(
                r#"{{"type":"Polygon","coordinates":[{RING}],"layer":{{{layer}}}}}"#
            ))
        };
        refused(&[
            (made[..made.len() - 9].into(), "is no ED-269"),
            (made.replace("120", "NaN"), "line 2: is no ED-269"),
            (made.replace("120", "Infinity"), "is no ED-269"),
            (
                made.replace("120", r#""NaN""#),
                "area 1 (yard) has the limit \"NaN\", expected a number",
            ),
            (
                made.replace("120", "[1]"),
                "has the limit [1], expected a number",
            ),
            (
                made.replace(r#""M""#, r#""KM""#),
                "has the unit \"KM\", expected m or ft",
            ),
            (
                made.replace(r#""uomDimensions":"M","#, ""),
                "missing field `uomDimensions`",
            ),
            (
                made.replace("AGL", "FL"),
                "above \"FL\", expected the vertical reference AGL, AMSL or WGS84",
            ),
            (
                made.replace("8.5", "108.5").replace(",47", ",147"),
                "corner 1 out of range",
            ),
            (ed269(""), "is no GeoJSON"),
            (
                ed269("").replace("AAA001", "\",\"horizontalProjection\":\""),
                "without a place",
            ),
            (
                round(r#"{"type":"Circle","center":[8.5,47.3],"radius":0}"#),
                "has a radius of 0 m",
            ),
            (
                round(r#"{"type":"Circle","center":[8.5,47.3],"radius":-3}"#),
                "has a radius of -3 m",
            ),
            (
                round(r#"{"type":"Circle","center":[8.5],"radius":3}"#),
                "has its centre out of range",
            ),
            (
                round(r#"{"type":"Circle","center":[47.3,108.5],"radius":3}"#),
                "look exchanged",
            ),
            (
                round(r#"{"type":"El\nlipse"}"#),
                "unknown variant `El lipse`",
            ),
            (
                point(r#""subType":"Circle","radius":0"#),
                "has a radius of 0 m",
            ),
            (point(r#""subType":"Square","radius":9"#), "is no area"),
            (point(r#""subType":"Circle""#), "missing field `radius`"),
            (
                layer(r#""lower":1,"lowerReference":"AGL","uom":"km""#),
                "has the unit \"km\"",
            ),
            (layer(r#""lower":1"#), "expected the vertical reference"),
            (
                layer(r#""lower":1,"lowerReference":"STD""#),
                "above \"STD\"",
            ),
        ]);
    }
}

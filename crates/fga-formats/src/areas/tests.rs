//! Files of each kind, and every refusal.

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
        r#"{{"title":"made","features":[{{"identifier":"AAA001","country":"DEU","name":"yard","type":"COMMON",
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
            {{"identifier":"AAA001","country":"DEU","name":[{{"text":"yard","lang":"en-GB"}}],"type":"NO_RESTRICTION","variant":"COMMON",
            "limitedApplicability":[{{"schedule":[{{"day":["ANY"]}}]}}]}},"geometry":{geometry}}}]}}"#
    )
}

#[test]
fn fences_of_a_mission_say_whether_they_keep_in() {
    let list = "QGC WPL 110\n0 0 3 5003 90 0 0 0 47.3 8.5 0 1\n1 0 3 5004 80 0 0 0 47.3 8.5 0 1\n";
    let fence = |name, radius_m, keep_in| NamedArea {
        keep_in: Some(keep_in),
        ..circle(name, radius_m)
    };
    let fences = vec![fence("fence 1", 90.0, true), fence("fence 2", 80.0, false)];
    assert_eq!(areas(list), Ok(fences));
    let mission = "QGC WPL 110\n0 0 3 16 0 0 0 0 47.3 8.5 0 1\n";
    assert_eq!(
        areas(mission),
        Err("a: has no area, expected at least one".into())
    );
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
    let point =
        r#""type":"Point","coordinates":[8.5,47.3],"extent":{"subType":"Circle","radius":1000}"#;
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
        (
            polygon("[[[8.5,null]]]"),
            "a: is no GeoJSON, no ED-269 and no KML: found null, expected a number",
        ),
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
            "corner 1 out of range",
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
        (round(r#"{"type":"El\nlipse"}"#), "unknown word `El lipse`"),
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

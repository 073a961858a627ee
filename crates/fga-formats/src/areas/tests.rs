//! Files of each kind, and every refusal.

use super::*;
use crate::geodesy::{Earth, Geodetic, LocalFrame};
use crate::units::FOOT_M;
use crate::zones::surrounds;

const RING: &str = "[[8.5,47.3],[8.6,47.3],[8.6,47.4],[8.5,47.3]]";

fn file(text: &str) -> Result<AreaFile, String> {
    parse(text, Path::new("a")).map_err(|error| error.to_string())
}

fn areas(text: &str) -> Result<Vec<NamedArea>, String> {
    file(text).map(|file| file.areas)
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
    assert_eq!(areas(kml).unwrap(), [geodesic(triangle(Some("yard")))]);
}

fn geodesic(area: NamedArea) -> NamedArea {
    let edges = EdgeLine::Geodesic;
    NamedArea { edges, ..area }
}

/// A feature of GeoJSON with properties.
fn feature(properties: &str) -> String {
    format!(
        r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"Polygon","coordinates":[{RING}]}}}}"#
    )
}

#[test]
fn limits_in_properties_are_read_where_their_names_are_known() {
    use Reference::{Ellipsoid, Ground, Pressure, Sea};
    let [ft, nothing] = [FOOT_M, 0.0];
    for (properties, lower, upper) in [
        // ED-269 with its outline elsewhere, also as a list of one.
        (
            r#""geometry":{"uomDimensions":"FT","lowerLimit":60,"lowerVerticalReference":"AMSL","upperLimit":"200","upperVerticalReference":"AGL"}"#,
            (Sea, 60.0 * ft),
            (Ground, 200.0 * ft),
        ),
        (
            r#""geometry":[{"uomDimensions":"M","lowerLimit":-5,"lowerVerticalReference":"W84","upperLimit":200,"upperVerticalReference":"AMSL"}]"#,
            (Ellipsoid, -5.0),
            (Sea, 200.0),
        ),
        // A service of features.
        (
            r#""upper_limit_unit":"FL","upper_limit_altitude":"100","upper_limit_alt_ref":"STD","lower_limit_altitude":"1500","lower_limit_unit":"ft","lower_limit_alt_ref":"AMSL""#,
            (Sea, 1500.0 * ft),
            (Pressure, 10_000.0 * ft),
        ),
        // OpenAIP.
        (
            r#""lowerLimit":{"value":0,"unit":1,"referenceDatum":0},"upperLimit":{"value":65,"unit":6,"referenceDatum":2}"#,
            (Ground, nothing),
            (Pressure, 6500.0 * ft),
        ),
        // The airspace of the FAA, names with units, and words.
        (
            r#""LOWER_VAL":700,"LOWER_UOM":"FT","LOWER_CODE":"SFC","UPPER_VAL":"1200","UPPER_UOM":"FT","UPPER_CODE":"MSL","UPPER_DESC":"TI""#,
            (Ground, 700.0 * ft),
            (Sea, 1200.0 * ft),
        ),
        (
            r#""floor_m_amsl":120,"ceiling_ft_agl":"400""#,
            (Sea, 120.0),
            (Ground, 400.0 * ft),
        ),
        (
            r#""lower":"GND","upper":"2500 ft AMSL""#,
            (Ground, nothing),
            (Sea, 2500.0 * ft),
        ),
        (
            r#""Floor":"SFC","Ceiling":"FL95""#,
            (Ground, nothing),
            (Pressure, 9500.0 * ft),
        ),
    ] {
        let file = file(&feature(properties)).unwrap();
        let expected = [Some(above(lower.0, lower.1)), Some(above(upper.0, upper.1))];
        for (found, expected) in file.areas[0].limits.iter().zip(expected) {
            let (found, expected) = (found.unwrap(), expected.unwrap());
            assert_eq!(found.above, expected.above, "{properties}");
            assert!(
                (found.height_m - expected.height_m).abs() < 1e-9,
                "{properties}"
            );
        }
        assert!(file.notes.is_empty(), "{properties}: {:?}", file.notes);
    }
    let unlimited = file(&feature(r#""lower":"100 m AGL","upper":"UNL""#)).unwrap();
    assert_eq!(
        unlimited.areas[0].limits,
        [Some(above(Ground, 100.0)), None]
    );
    assert!(unlimited.notes.is_empty());
    let free = areas(&feature(
        r#""restriction":"NO_RESTRICTION","applicability":[{"permanent":"NO"}]"#,
    ));
    assert_eq!(
        free.map(|all| (all[0].is_free, all[0].is_timed)),
        Ok((true, true))
    );
}

#[test]
fn limits_that_cannot_be_read_are_named() {
    for (properties, expected) in [
        (
            r#""CEILING":400,"UNIT":"Feet""#,
            "upper limit \"400\" without what it counts from",
        ),
        (
            r#""upperLimit":120,"upperReference":"AGL""#,
            "upper limit \"120 AGL\" without a unit",
        ),
        (r#""lower":"60 furlongs AGL""#, "\"FURLONGS\" is not known"),
        (r#""lower":"by NOTAM""#, "is not known"),
        (
            r#""lowerLimit":{"value":60,"unit":17,"referenceDatum":1}"#,
            "is not known",
        ),
        (r#""lower":"1000 ft 2000 ft AMSL""#, "as a second height"),
    ] {
        let file = file(&feature(properties)).unwrap();
        assert_eq!(file.areas[0].limits, [None; 2], "{properties}");
        assert!(
            file.notes.len() == 1 && file.notes[0].contains(expected),
            "{properties}: {:?}",
            file.notes
        );
    }
    // What says nothing of heights is no limit.
    let other =
        feature(r##""fill":"#f00","max-zoom":12,"base":null,"topic":"a","Bufferzone":"5 km""##);
    assert_eq!(file(&other).unwrap().notes, [""; 0]);
    // KML: data beside a polygon, and heights at its corners.
    let kml = "<kml><Placemark><ExtendedData><Data name=\"upper\"><value>120 m AGL</value></Data></ExtendedData><Polygon>
        <altitudeMode>absolute</altitudeMode><outerBoundaryIs><LinearRing><coordinates>8.5,47.3,90 8.6,47.3,90 8.6,47.4,90 8.5,47.3,90
        </coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></kml>";
    let found = file(kml).unwrap();
    assert_eq!(
        found.areas[0].limits,
        [None, Some(above(Reference::Ground, 120.0))]
    );
    assert!(
        found.notes[0].contains("has heights at its corners"),
        "{:?}",
        found.notes
    );
}

#[test]
fn what_is_no_area_is_named_beside_areas() {
    let polygon = format!(r#"{{"type":"Polygon","coordinates":[{RING}]}}"#);
    let point = r#"{"type":"Feature","properties":{"name":"a"},"geometry":{"type":"Point","coordinates":[8.5,47.3]}}"#;
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[{point},{},{point},{{"type":"Feature","properties":null,"geometry":null}}]}}"#,
        feature("").replace("{}", "null")
    );
    let found = file(&text).unwrap();
    assert_eq!(found.areas, [triangle(None)]);
    assert_eq!(
        found.notes,
        ["1 feature without a place left out", "2 points left out"]
    );
    assert_eq!(found.areas, areas(&polygon).unwrap());
    let kml = "<kml><Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>8.5,47.3 8.6,47.3 8.6,47.4 8.5,47.3</coordinates>
        </LinearRing></outerBoundaryIs></Polygon><Point/><LineString/></Placemark><NetworkLink/></kml>";
    let found = file(kml).unwrap();
    assert_eq!(found.areas, [geodesic(triangle(None))]);
    let named = [
        "1 line left out",
        "1 link to another file (NetworkLink) left out",
        "1 point left out",
    ];
    assert_eq!(found.notes, named);
}

#[test]
fn airspace_of_openair_is_read() {
    let text = "* made\nAC R\nAN TEST R1\nAH 2000ft MSL\nAL GND\nV X=45:00:00 N 005:01:48 E\nDC 0.3\n\nAC D\nAN Arc\nAL 1500ft AGL\nAH FL65\n\
        DP 45:00:00 N 005:00:00 E\nV X=45:00:00 N 005:06:00 E\nV D=+\nDB 45:06:00 N 005:06:00 E, 45:00:00 N 005:12:00 E\n\nAC Q\nAN Odd\n\
        AL by NOTAM\nAH UNL\nDP 45:00:00 N 005:00:00 E\nDP 45:01:00 N 005:00:00 E\nDP 45:00:00 N 005:01:00 E\n";
    let found = file(text).unwrap();
    let [circle, arc, odd] = &found.areas[..] else {
        panic!("{found:?}");
    };
    assert_eq!(circle.name.as_deref(), Some("TEST R1"));
    let AreaOutline::Circle {
        center_deg,
        radius_m,
    } = circle.outline
    else {
        panic!("{circle:?}");
    };
    assert!((radius_m - 555.6).abs() < 1e-3 && (center_deg[1] - 5.03).abs() < 1e-9);
    assert_eq!(circle.limits[0], Some(above(Reference::Ground, 0.0)));
    let [feet, level] = arc.limits.map(Option::unwrap);
    assert_eq!(
        (feet.above, level.above),
        (Reference::Ground, Reference::Pressure)
    );
    assert!((level.height_m - 1981.2).abs() < 1e-9);
    // A quarter of a circle to the right from north to east, 11.1 km round its centre shrinking to 7.9 km.
    let AreaOutline::Polygon(rings) = &arc.outline else {
        panic!("{arc:?}");
    };
    let north_east = rings[0]
        .iter()
        .filter(|at| at[0] > 45.01 && at[1] > 5.11)
        .count();
    assert!(north_east > 10 && rings[0].iter().all(|at| at[0] < 45.11 && at[1] < 5.21));
    assert_eq!(arc.check(), Ok(()));
    assert_eq!(odd.limits, [None; 2]);
    assert_eq!(found.notes.len(), 1);
    assert!(
        found.notes[0].contains("area 3 (Odd) has the lower limit"),
        "{:?}",
        found.notes
    );
}

#[test]
fn airspace_of_aixm_is_read() {
    let part = |limits: &str, ring: &str| {
        format!(
        "<aixm:geometryComponent><aixm:AirspaceGeometryComponent><aixm:operation>BASE</aixm:operation><aixm:theAirspaceVolume>
        <aixm:AirspaceVolume>{limits}<aixm:horizontalProjection><aixm:Surface srsName=\"urn:ogc:def:crs:EPSG::4326\"><gml:patches>
        <gml:PolygonPatch><gml:exterior>{ring}</gml:exterior></gml:PolygonPatch></gml:patches></aixm:Surface></aixm:horizontalProjection>
        </aixm:AirspaceVolume></aixm:theAirspaceVolume></aixm:AirspaceGeometryComponent></aixm:geometryComponent>"
    )
    };
    let limits = "<aixm:upperLimit uom=\"FL\">65</aixm:upperLimit><aixm:upperLimitReference>STD</aixm:upperLimitReference>
        <aixm:lowerLimit uom=\"FT\">0</aixm:lowerLimit><aixm:lowerLimitReference>SFC</aixm:lowerLimitReference>";
    let string = "<gml:Ring><gml:curveMember><gml:Curve><gml:segments><gml:GeodesicString><gml:posList>47.3 8.5 47.3 8.6 47.4 8.6 47.3 8.5
        </gml:posList></gml:GeodesicString></gml:segments></gml:Curve></gml:curveMember></gml:Ring>";
    let circle = "<gml:Ring><gml:curveMember><gml:Curve><gml:segments><gml:CircleByCenterPoint numArc=\"1\"><gml:pos>47.3 8.5</gml:pos>
        <gml:radius uom=\"[nmi_i]\">2</gml:radius></gml:CircleByCenterPoint></gml:segments></gml:Curve></gml:curveMember></gml:Ring>";
    let arc = "<gml:Ring><gml:curveMember><gml:Curve><gml:segments><gml:ArcByCenterPoint><gml:pos>47.3 8.5</gml:pos>
        <gml:radius uom=\"km\">10</gml:radius><gml:startAngle uom=\"deg\">0</gml:startAngle><gml:endAngle uom=\"deg\">90</gml:endAngle>
        </gml:ArcByCenterPoint><gml:GeodesicString><gml:pos>47.3 8.63</gml:pos><gml:pos>47.3 8.5</gml:pos></gml:GeodesicString></gml:segments>
        </gml:Curve></gml:curveMember></gml:Ring>";
    let border = "<gml:Ring><gml:curveMember xlink:href=\"#border\"/></gml:Ring>";
    let parts = [
        part(limits, string),
        part("", circle),
        part("", arc),
        part("", border),
    ]
    .concat();
    let text = format!(
        "<?xml version=\"1.0\"?><message:AIXMBasicMessage xmlns:message=\"m\" xmlns:aixm=\"a\" xmlns:gml=\"g\" xmlns:xlink=\"x\">
        <aixm:Airspace><aixm:timeSlice><aixm:AirspaceTimeSlice><aixm:type>R</aixm:type><aixm:designator>R1</aixm:designator>
        <aixm:name>yard</aixm:name>{parts}</aixm:AirspaceTimeSlice></aixm:timeSlice></aixm:Airspace></message:AIXMBasicMessage>"
    );
    let found = file(&text).unwrap();
    let [plain, round, quarter] = &found.areas[..] else {
        panic!("{found:?}");
    };
    let limits = [
        Some(above(Reference::Ground, 0.0)),
        Some(above(Reference::Pressure, 65.0 * 100.0 * FOOT_M)),
    ];
    let near = |one: Option<AreaLimit>, other: Option<AreaLimit>| {
        (one.unwrap().height_m - other.unwrap().height_m).abs() < 1e-9
            && one.unwrap().above == other.unwrap().above
    };
    assert!(
        near(plain.limits[0], limits[0]) && near(plain.limits[1], limits[1]),
        "{plain:?}"
    );
    assert_eq!(plain.outline, triangle(None).outline);
    assert_eq!(round.outline, self::circle("", 3704.0).outline);
    let AreaOutline::Polygon(rings) = &quarter.outline else {
        panic!("{quarter:?}");
    };
    assert!(rings[0].iter().all(|at| at[0] >= 47.299 && at[1] >= 8.499) && rings[0].len() > 20);
    assert_eq!(
        found.notes,
        ["1 volume with an outline elsewhere (xlink) left out"]
    );
    refused(&[
        (
            "<gpx/>".into(),
            "is XML of the kind \"gpx\", expected KML or AIXM 5.1",
        ),
        ("<m:AIXMBasicMessage xmlns:m=\"m\"/>".into(), "has no area"),
    ]);
}

#[test]
fn fence_points_of_ardupilot_are_a_fence_to_stay_in() {
    let found =
        file("45.0 5.0\n45.01 5.01\n44.99 5.01\n44.99 4.99\n45.01 4.99\n45.01 5.01\n").unwrap();
    let corners = vec![[45.01, 5.01], [44.99, 5.01], [44.99, 4.99], [45.01, 4.99]];
    assert_eq!(found.areas[0].outline, AreaOutline::Polygon(vec![corners]));
    assert_eq!(found.areas[0].keep_in, Some(true));
    assert_eq!(found.notes, ["1 return point left out"]);
    refused(&[(
        "45.0 5.0\n45.01 5.01\n44.99 5.01\n44.99 4.99\n".into(),
        "is not closed",
    )]);
}

#[test]
fn an_archive_of_kml_is_read() {
    use std::io::Write as _;
    let kml = |name: &str| {
        format!(
        "<kml><Placemark><name>{name}</name><Polygon><outerBoundaryIs><LinearRing><coordinates>8.5,47.3 8.6,47.3 8.6,47.4 8.5,47.3</coordinates>
        </LinearRing></outerBoundaryIs></Polygon></Placemark></kml>"
    )
    };
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, content) in [
        ("files/a.png", String::new()),
        ("more/b.kml", kml("b")),
        ("doc.kml", kml("yard")),
    ] {
        archive.start_file(name, options).unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    let bytes = archive.finish().unwrap().into_inner();
    let path = std::env::temp_dir().join(format!("fga-areas-{}.kmz", std::process::id()));
    let read_all = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let found = read(&path);
        std::fs::remove_file(&path).unwrap();
        found
    };
    let found = read_all(&bytes).unwrap();
    assert_eq!(found.areas, [geodesic(triangle(Some("yard")))]);
    assert_eq!(
        found.notes,
        ["1 other .kml file of the archive left out: doc.kml is read"]
    );
    for keep in [5, bytes.len() / 2, bytes.len() - 1] {
        let told = read_all(&bytes[..keep]).unwrap_err().to_string();
        assert!(
            told.contains("is no usable archive") && !told.contains('\n'),
            "{told}"
        );
    }
}

fn frame(latitude_deg: f64, longitude_deg: f64) -> LocalFrame {
    let origin = Geodetic::new(latitude_deg, longitude_deg, 0.0).unwrap();
    LocalFrame::new(origin, Earth::Wgs84)
}

/// Least distance of a place from the edges of a ring, metres.
fn beside_m(ring: &[fga::Vec2], at: fga::Vec2) -> f64 {
    let next = ring.iter().cycle().skip(1);
    let edges = ring.iter().zip(next);
    let distances_m = edges.map(|(a, b)| {
        let (edge, offset) = (*b - *a, at - *a);
        let share = (offset.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        (offset - edge * share).length()
    });
    distances_m.fold(f64::INFINITY, f64::min)
}

/// Places of the shortest lines by `GeographicLib` (pyproj 3.7, `Geod.fwd` at a quarter, half and three quarters).
#[test]
fn edges_are_the_lines_of_their_formats() {
    let ring = |from: [f64; 2], to: [f64; 2]| {
        let apex = [to[0] - 1.5, 0.5 * (from[1] + to[1])];
        NamedArea {
            outline: AreaOutline::Polygon(vec![vec![from, to, apex]]),
            ..NamedArea::default()
        }
    };
    for (from, to, shortest) in [
        (
            [45.0, 3.7],
            [45.0, 6.3],
            [
                [45.005_549_504_760_69, 4.349_958_161_424_952_5],
                [45.007_399_497_360_3, 5.0],
                [45.005_549_504_760_69, 5.650_041_838_575_048],
            ],
        ),
        (
            [44.0, 3.0],
            [47.0, 8.0],
            [
                [44.770_304_376_723_146, 4.200_744_105_600_106],
                [45.527_543_735_197_284, 5.433_559_805_581_249],
                [46.271_019_764_005_46, 6.699_598_599_577_104],
            ],
        ),
    ] {
        let frame = frame(45.0, 5.0);
        let local = |[latitude_deg, longitude_deg]: [f64; 2]| {
            let place = Geodetic::new(latitude_deg, longitude_deg, 0.0).unwrap();
            frame.to_local_m(place).truncate()
        };
        let area = ring(from, to);
        let straight = area.on_plane(&frame, false);
        let bent = geodesic(area).on_plane(&frame, false);
        assert_eq!((straight.grown_m, bent.grown_m), (0.0, 0.0));
        for (share, shortest) in [0.25, 0.5, 0.75].into_iter().zip(shortest) {
            let degrees = [0, 1].map(|axis: usize| from[axis] + share * (to[axis] - from[axis]));
            let off_m = [
                beside_m(&straight.polygons[0][0], local(degrees)),
                beside_m(&bent.polygons[0][0], local(shortest)),
            ];
            assert!(
                off_m.iter().all(|off_m| *off_m <= 1.0),
                "{share}: {off_m:?}"
            );
            let apart_m = beside_m(&straight.polygons[0][0], local(shortest));
            assert!(apart_m > 300.0, "{apart_m}");
        }
    }
    // An outline that reaches far away is cut, and its edge stays.
    let far = vec![vec![
        [45.0, 3.7],
        [45.0, 6.3],
        [80.0, 100.0],
        [80.0, -100.0],
    ]];
    let area = NamedArea {
        outline: AreaOutline::Polygon(far),
        ..NamedArea::default()
    };
    let cut = area.on_plane(&frame(45.0, 5.0), false);
    let off_m = beside_m(&cut.polygons[0][0], fga::Vec2::ZERO);
    assert!(
        off_m <= 1.0 + cut.grown_m && cut.grown_m < 10.0,
        "{off_m}, {}",
        cut.grown_m
    );
    // Over the antimeridian, with an end on the other side.
    let area = geodesic(NamedArea {
        outline: AreaOutline::Polygon(vec![vec![[60.0, 179.0], [61.0, -178.0], [59.5, -179.5]]]),
        ..NamedArea::default()
    });
    let frame = frame(60.5, -179.5);
    let plane = area.on_plane(&frame, false);
    let place = Geodetic::new(60.508_446_057_26, -179.523_104_293_57, 0.0).unwrap();
    let off_m = beside_m(&plane.polygons[0][0], frame.to_local_m(place).truncate());
    assert!(off_m <= 1.0, "{off_m}");
}

#[test]
fn an_outline_round_the_world_with_a_country_as_its_hole_is_cut() {
    let world = vec![
        [-89.9, -179.9],
        [-89.9, 179.9],
        [89.9, 179.9],
        [89.9, -179.9],
    ];
    let country = vec![[44.8, 4.8], [45.2, 4.8], [45.2, 5.2], [44.8, 5.2]];
    let area = NamedArea {
        outline: AreaOutline::Polygon(vec![world, country]),
        ..NamedArea::default()
    };
    assert_eq!(area.check(), Ok(()));
    let plane = area.on_plane(&frame(45.0, 5.0), false);
    let [rings] = &plane.polygons[..] else {
        panic!("{plane:?}");
    };
    assert_eq!((rings.len(), plane.grown_m), (2, 0.0));
    let border_m = beside_m(&rings[1], fga::Vec2::ZERO);
    assert!((15_000.0..16_000.0).contains(&border_m), "{border_m}");
}

#[test]
fn an_outline_of_twenty_thousand_corners_grows_by_the_metres_that_it_says() {
    let corner = |k: u32| {
        let angle = f64::from(k) * core::f64::consts::TAU / 20_000.0;
        let waves = 1.0 + 0.2 * libm::sin(7.0 * angle) + 1e-4 * libm::sin(900.0 * angle);
        [
            47.0 + 0.05 * waves * libm::sin(angle),
            8.0 + 0.07 * waves * libm::cos(angle),
        ]
    };
    let area = NamedArea {
        outline: AreaOutline::Polygon(vec![(0..20_000).map(corner).collect()]),
        ..NamedArea::default()
    };
    assert_eq!(area.check(), Ok(()));
    let frame = frame(47.0, 8.0);
    for keep_in in [false, true] {
        let plane = area.on_plane(&frame, keep_in);
        assert!(
            plane.grown_m <= 16.0 && plane.polygons.len() == 1,
            "{}",
            plane.grown_m
        );
        let ring = &plane.polygons[0][0];
        assert!(ring.len() <= 256);
        for k in 0..20_000 {
            let [latitude_deg, longitude_deg] = corner(k);
            let place = Geodetic::new(latitude_deg, longitude_deg, 0.0).unwrap();
            let at_m = frame.to_local_m(place).truncate();
            let is_inside = crate::zones::surrounds(ring, at_m);
            let off_m = beside_m(ring, at_m);
            assert!(
                is_inside != keep_in && off_m <= plane.grown_m + 1.0,
                "{k}: {off_m}"
            );
        }
    }
}

/// A town whose outline is as jagged as its plots is no smooth one, however far it grows.
#[test]
fn a_jagged_outline_is_cut_into_zones_that_hold_all_of_it() {
    let corner = |k: u32| {
        let angle = f64::from(k) * core::f64::consts::TAU / 1600.0;
        let jagged = 1.0 + 0.02 * f64::from(k * 7919 % 13) - 0.03 * f64::from(k % 2);
        [
            47.0 + 0.1 * jagged * libm::sin(angle),
            8.0 + 0.14 * jagged * libm::cos(angle),
        ]
    };
    let area = NamedArea {
        outline: AreaOutline::Polygon(vec![(0..1600).map(corner).collect()]),
        ..NamedArea::default()
    };
    let frame = frame(47.0, 8.0);
    let plane = area.on_plane(&frame, false);
    assert!(plane.grown_m <= 16.0, "{}", plane.grown_m);
    assert!(
        (2..=64).contains(&plane.polygons.len()),
        "{}",
        plane.polygons.len()
    );
    let outline_m: Vec<fga::Vec2> = (0..1600)
        .map(|k| {
            let [latitude_deg, longitude_deg] = corner(k);
            let place = Geodetic::new(latitude_deg, longitude_deg, 0.0).unwrap();
            frame.to_local_m(place).truncate()
        })
        .collect();
    let holds = |rings: &Vec<Vec<fga::Vec2>>, at: fga::Vec2| {
        rings
            .iter()
            .filter(|ring| crate::zones::surrounds(ring, at))
            .count()
            % 2
            == 1
    };
    let mut inside = 0;
    for k in 0_u32..40_000 {
        // Places all over the outline's square.
        let [x, y] = [k % 200, k / 200].map(|n| (f64::from(n) + 0.37) / 100.0 - 1.0);
        let at = 15_000.0 * fga::Vec2::new(x, y);
        let held = plane.polygons.iter().any(|rings| holds(rings, at));
        if crate::zones::surrounds(&outline_m, at) {
            inside += 1;
            assert!(held, "{at}");
        } else if held {
            assert!(beside_m(&outline_m, at) <= plane.grown_m + 1.0, "{at}");
        }
    }
    assert!(inside > 10_000, "{inside}");
    for rings in plane.polygons {
        let zone = crate::zones::with_holes(rings[0].clone(), rings[1..].to_vec());
        assert!(zone.unwrap().len() <= 256);
    }
    // One to stay in is whole.
    assert_eq!(area.on_plane(&frame, true).polygons.len(), 1);
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
        ..geodesic(triangle(Some("yard")))
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
fn zones_of_ed269_may_be_a_list_alone() {
    let ring =
        "{\"type\":\"Polygon\",\"coordinates\":[[[8.5,47.3],[8.6,47.3],[8.6,47.4],[8.5,47.3]]]}";
    let whole = ed269(&volume(ring));
    let (_, list) = whole.split_once("\"features\":").unwrap();
    let list = list.trim_end().strip_suffix('}').unwrap();
    assert!(is_areas(list), "{list}");
    assert_eq!(areas(list), areas(&whole));
    assert!(!is_areas("[{\"icao24\":\"4b1617\"}]"));
}

/// A zone from 0 to 0 m, as ENAIRE writes one of all heights, is no flat one.
#[test]
fn a_floor_at_its_ceiling_has_no_ceiling() {
    let layer = "\"layer\":{\"lower\":0,\"lowerReference\":\"AGL\",\"upper\":0,\"upperReference\":\"AGL\",\"uom\":\"\"}";
    let text = ed318(&format!(
        "{{\"type\":\"Polygon\",\"coordinates\":[{RING}],{layer}}}"
    ));
    let file = file(&text).unwrap();
    assert_eq!(
        file.areas[0].limits,
        [Some(above(Reference::Ground, 0.0)), None]
    );
    let told = "area 1 (yard) has its floor and its ceiling at 0 m: the ceiling counts as unknown";
    assert_eq!(file.notes, [told]);
    assert!(file.areas[0].check().is_ok());
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
        (
            polygon("[[[1,2],[3,4],[1,2]]]"),
            "has no area, 1 area with fewer than 3 corners left out",
        ),
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
            "has no area, 1 point left out",
        ),
        (
            r#"{"type":"FeatureCollection","features":[]}"#.into(),
            "has no area",
        ),
        (
            r#"{"type":"Feature","geometry":null,"properties":null}"#.into(),
            "has no area, 1 feature without a place left out",
        ),
        ("<kml><Polygon>".into(), "is no KML"),
        ("<kml><a/\n></kml>".into(), "line 1: is no KML"),
        ("<kml></kml>".into(), "has no area"),
        (
            "<kml><Point/></kml>".into(),
            "has no area, 1 point left out",
        ),
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
            made.replace(r#""M""#, r#""KN""#),
            "area 1 (yard) has the unit \"KN\", expected m or ft",
        ),
        (
            made.replace(r#""uomDimensions":"M","#, ""),
            "missing field `uomDimensions`",
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
    ]);
    // One limit that cannot be read leaves the zone, which is larger without it.
    for (text, expected) in [
        (
            made.replace("120", r#""NaN""#),
            r#"upper limit "NAN AGL" ("NaN" is not known)"#,
        ),
        (made.replace("120", "[1]"), r#"("[1]" is not known)"#),
        (
            made.replace("AGL", "QFE"),
            r#"lower limit "0 QFE" ("QFE" is not known)"#,
        ),
        (
            layer(r#""lower":1,"lowerReference":"AGL","uom":"kn""#),
            "\"KN\" is not known",
        ),
        (
            layer(r#""lower":1"#),
            r#"lower limit "1" without what it counts from"#,
        ),
    ] {
        let file = file(&text).unwrap();
        assert!(
            file.notes.iter().any(|note| note.contains(expected)),
            "{expected}: {:?}",
            file.notes
        );
        assert!(file.areas[0].limits.contains(&None), "{expected}");
    }
}

/// A ring of longitudes and latitudes around 8.5, 47.3, in thousandths of a degree.
fn ring(corners: &[[i32; 2]]) -> String {
    let corners = corners.iter();
    let corners = corners.map(|[x, y]| format!("[8.{},47.{}]", 500 + x, 300 + y));
    polygon(&format!("[[{}]]", corners.collect::<Vec<_>>().join(",")))
}

/// Square degrees that the first rings of areas cover.
fn covered(file: &AreaFile) -> f64 {
    let twice = |area: &NamedArea| {
        let AreaOutline::Polygon(rings) = &area.outline else {
            return 0.0;
        };
        let next = rings[0].iter().cycle().skip(1);
        let edges = rings[0].iter().zip(next);
        edges.map(|(a, b)| a[1] * b[0] - b[1] * a[0]).sum::<f64>()
    };
    file.areas.iter().map(|area| 0.5 * twice(area).abs()).sum()
}

#[test]
fn outlines_as_authorities_publish_them_are_read() {
    let square = [[0, 0], [100, 0], [100, 100], [0, 100], [0, 0]];
    let twice = [&square[..4], &square[..]].concat();
    let [spike, loops, touches] = [
        [
            [0, 0],
            [100, 0],
            [100, 100],
            [150, 150],
            [100, 100],
            [0, 100],
        ]
        .as_slice(),
        &[[0, 0], [100, 0], [100, 100], [98, 100], [101, 99], [0, 99]],
        &[
            [0, 0],
            [50, 0],
            [50, 50],
            [100, 50],
            [100, 100],
            [50, 100],
            [50, 50],
            [0, 50],
        ],
    ]
    .map(|ring| [ring, &[[0, 0]]].concat());
    for (corners, parts, area) in [
        (twice, 1, 1e-2),
        (spike, 1, 1e-2),
        (loops, 3, 0.99e-2),
        (touches, 2, 0.5e-2),
    ] {
        let found = file(&ring(&corners)).unwrap();
        assert!(
            found.notes[0].contains("crosses or touches itself"),
            "{corners:?}"
        );
        assert_eq!(found.areas.len(), parts, "{corners:?}");
        assert!((covered(&found) - area).abs() < 1e-5, "{corners:?}");
        assert!(found.areas.iter().all(|area| area.check().is_ok()));
    }
    // Corners in a wrong order surround something else.
    let tie = ring(&[[0, 0], [100, 100], [100, 0], [0, 100], [0, 0]]);
    let error = areas(&tie).unwrap()[0].check().unwrap_err();
    assert!(error.to_string().contains("polygon crosses itself"));
    // An outline that does not end where it begins.
    let open = file(&ring(&square[..4])).unwrap();
    assert_eq!(
        open.notes,
        ["area 1 is not closed: its last corner is joined to its first one"]
    );
    assert!((covered(&open) - 0.01).abs() < 1e-9);
}

#[test]
fn geojson_with_names_of_ed269_in_its_properties_is_geojson() {
    // As Estonia writes it: the volume without its outline, and both limits again in words and in rounded metres.
    let volume = r#""geometry":{"uomDimensions":"FT","lowerLimit":0,"lowerVerticalReference":"AGL","upperLimit":6000,
        "upperVerticalReference":"AGL"},"lower":"SFC","lowerMeters":0,"upper":"6000 FT AGL","upperMeters":1800"#;
    let text = feature(&format!(r#"{volume},"at":"\"horizontalProjection\"""#));
    let found = file(&text).unwrap();
    assert_eq!(found.notes, [""; 0]);
    let upper = above(Reference::Ground, 6000.0 * FOOT_M);
    assert_eq!(
        found.areas[0].limits,
        [Some(above(Reference::Ground, 0.0)), Some(upper)]
    );
    let other = file(&text.replace("1800", "600")).unwrap();
    assert!(other.notes[0].contains("\"600 as a second height\" is not known"));
}

#[test]
fn one_airspace_that_cannot_be_read_is_named_beside_the_others() {
    let good = "AC R\nAN GOOD\nTO drawn\nSB 1,2,3\nAA NONE\nAA 2026-01-01T00:00Z/2026-02-01T00:00Z\nAH FL65\nAL GND\nV Z=100\n\
        V X=045:00:00 N 005:00:00 E\nDC 1\n";
    let bad = "AC R\nAN BAD\nAH FL65\nV X=45:00:00 N 005:00:00 E\nDC 1\n";
    let found = file(&format!("* made\n{bad}\n{good}{bad}")).unwrap();
    assert_eq!(found.areas.len(), 1);
    assert_eq!(found.areas[0].name.as_deref(), Some("GOOD"));
    assert_eq!(
        found.notes,
        ["2 airspaces BAD (Missing lower bound for 'BAD') left out"]
    );
    // The arc has a radius larger than the Earth.
    let wide = format!(
        "{good}AC R\nAN WIDE\nAH FL65\nAL GND\nV X=45:00:00 N 005:00:00 E\nDA 1e20,270,290\n"
    );
    let found = file(&wide).unwrap();
    assert_eq!(found.areas.len(), 1);
    assert!(found.notes[0].starts_with("1 airspace with an arc with a radius of"));
}

/// RFC 7946 cuts what crosses the antimeridian; many writers do not.
#[test]
fn an_outline_that_is_not_cut_at_the_antimeridian_lies_on_both_sides_of_it() {
    let outline = "[[179.9,10],[-179.9,10],[-179.8,10.1],[-179.9,10.2],[179.9,10.2],[179.9,10]]";
    let hole = "[[-179.95,10.05],[179.95,10.05],[179.95,10.1],[-179.95,10.05]]";
    let text = format!(r#"{{"type":"Polygon","coordinates":[{outline},{hole}]}}"#);
    let file = parse(&text, Path::new("a.geojson")).unwrap();
    assert!(file.notes[0].contains("antimeridian"), "{:?}", file.notes);
    let inside = |longitude_deg: f64, latitude_deg: f64| {
        let plane = file.areas[0].on_plane(&frame(latitude_deg, longitude_deg), false);
        let rings = plane.polygons.iter().flatten();
        let around = rings.filter(|ring| surrounds(ring, fga::Vec2::ZERO));
        around.count() % 2 == 1
    };
    assert!(inside(179.92, 10.02) && inside(-179.92, 10.15) && inside(-179.82, 10.1));
    assert!(!inside(179.97, 10.06) && !inside(5.0, 10.1) && !inside(-179.7, 10.1));
    // Round the earth.
    let text =
        r#"{"type":"Polygon","coordinates":[[[-180,10],[180,10],[180,20],[-180,20],[-180,10]]]}"#;
    let file = parse(text, Path::new("a.geojson")).unwrap();
    assert!(file.notes.is_empty());
    let plane = file.areas[0].on_plane(&frame(15.0, 5.0), false);
    assert!(surrounds(&plane.polygons[0][0], fga::Vec2::ZERO));
}

/// Tabs for blanks, and a class where the airspace before has no place.
#[test]
fn openair_with_tabs_and_without_places_is_told_apart() {
    let text = "AC\tR\nAN\tNowhere\nAH 100 ft\nAC D\nAN Here\nAL GND\nAH FL65\nDP 45:00:00 N 005:00:00 E\nDP 45:00:00 N 005:06:00 E\nDP\t45:06:00 N 005:06:00 E\n";
    assert!(is_areas(text));
    let file = parse(text, Path::new("a.txt")).unwrap();
    assert_eq!(file.areas.len(), 1);
    assert_eq!(file.areas[0].name.as_deref(), Some("Here"));
    assert!(
        file.notes[0].contains("airspace Nowhere"),
        "{:?}",
        file.notes
    );
}

//! The exports, each read by another program or library.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::flight::{HOSTILE, flight, odd_flights};
use crate::common::python;
use alloc::collections::BTreeMap;
use fga_formats::error::OutputError;
use fga_formats::export::{self, Format, czml, flightgear, geojson as map, kml, mcap as log};
use fga_formats::flight::{Flight, FlightZone};
use serde_json::Value;
use std::path::Path;

/// One degree of longitude on the equator of the ellipsoid at 100 m: 2π (a + 100 m) / 360.
const DEGREE_M: f64 = 111_321.235_7;

/// The hostile name in XML: without the characters that XML forbids.
fn xml_name() -> String {
    HOSTILE.replace(['\u{1}', '\u{fffe}'], "")
}

#[test]
fn kml_is_read_by_a_strict_parser() {
    let text = kml::text(&flight());
    let document = roxmltree::Document::parse(&text).unwrap();
    let named = |tag: &str| -> Vec<roxmltree::Node<'_, '_>> {
        document
            .descendants()
            .filter(|node| node.tag_name().name() == tag)
            .collect()
    };
    assert!(
        named("name")
            .iter()
            .any(|node| node.text() == Some(&*format!("{} (published)", xml_name())))
    );
    assert!(named("img").is_empty() && named("script").is_empty());

    // Two tracks with equal numbers of times and positions; the aircraft's last place is 600 m to the east.
    let tracks = named("Track");
    assert_eq!(tracks.len(), 2);
    for track in &tracks {
        let count = |tag: &str| {
            track
                .children()
                .filter(|n| n.tag_name().name() == tag)
                .count()
        };
        assert_eq!(count("when"), count("coord"));
    }
    let whens: Vec<&str> = named("when")
        .iter()
        .filter_map(roxmltree::Node::text)
        .collect();
    assert_eq!(whens[0], "2024-02-28T23:59:59.250Z");
    assert_eq!(whens[300], "2024-02-29T00:00:29.250Z");
    let last = named("coord")[300].text().unwrap().to_owned();
    let place: Vec<f64> = last.split(' ').map(|part| part.parse().unwrap()).collect();
    assert!(
        (place[0] - (10.0 + 600.0 / DEGREE_M)).abs() < 2e-8,
        "{place:?}"
    );
    assert!(place[1].abs() < 1e-8 && (place[2] - 150.0).abs() < 1e-9);

    // The mast's surface: a lid, a floor and a wall of 24 faces, each ring closed; its top at
    // 160 m.
    let rings = named("LinearRing");
    let mast: Vec<Vec<&str>> = rings[..26]
        .iter()
        .map(|ring| {
            ring.children()
                .find_map(|n| n.text())
                .unwrap()
                .split_whitespace()
                .collect()
        })
        .collect();
    assert!(mast.iter().all(|ring| ring.first() == ring.last()));
    assert_eq!(
        mast.iter().map(Vec::len).filter(|len| *len == 25).count(),
        2
    );
    let top = mast
        .iter()
        .flatten()
        .filter_map(|p| p.rsplit(',').next()?.parse::<f64>().ok())
        .fold(0.0, f64::max);
    assert!((top - 160.0).abs() < 1e-9);
    // The moving volume has adjacent time spans from 5 s to 25 s.
    let begins: Vec<&str> = named("begin")
        .iter()
        .filter_map(roxmltree::Node::text)
        .collect();
    let ends: Vec<&str> = named("end")
        .iter()
        .filter_map(roxmltree::Node::text)
        .collect();
    assert_eq!(begins[0], "2024-02-29T00:00:04.250Z");
    assert_eq!(ends.last(), Some(&"2024-02-29T00:00:24.250Z"));
    assert_eq!(begins[1..], ends[..ends.len() - 1]);
}

#[test]
fn kml_is_read_by_python() {
    let folder = tempfile::tempdir().unwrap();
    for (index, flight) in odd_flights().iter().chain([&flight()]).enumerate() {
        let path = folder.path().join(format!("{index}.kml"));
        export::write(flight, Format::Kml, &path).unwrap();
        let script = "import sys, xml.etree.ElementTree as E\n\
            k='{http://www.opengis.net/kml/2.2}'\n\
            r=E.parse(sys.argv[1]).getroot()\n\
            assert r.tag==k+'kml', r.tag\n\
            for c in r.iter(k+'coordinates'):\n\
            \x20   for p in c.text.split():\n\
            \x20       x,y,z=map(float,p.split(',')); assert -180<=x<=180 and -90<=y<=90\n\
            print(len(list(r.iter(k+'Placemark'))))";
        let Some(placemarks) = python("xml.etree.ElementTree", script, &[&path]) else {
            return;
        };
        assert!(placemarks.trim().parse::<u32>().unwrap() > 1);
    }
}

#[test]
fn czml_places_and_attitudes_are_right() {
    let packets: Vec<Value> = serde_json::from_str(&czml::text(&flight())).unwrap();
    assert_eq!(packets[0]["id"], "document");
    assert_eq!(
        packets[0]["clock"]["interval"],
        "2024-02-28T23:59:59.250Z/2024-02-29T00:00:29.250Z"
    );
    let mut ids: Vec<&str> = packets.iter().map(|p| p["id"].as_str().unwrap()).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "every packet has its own id");
    let aircraft = packets.iter().find(|p| p["id"] == "aircraft").unwrap();
    let places = aircraft["position"]["cartographicDegrees"]
        .as_array()
        .unwrap();
    assert_eq!(places.len(), 301 * 4);
    assert!((places[1201].as_f64().unwrap() - (10.0 + 600.0 / DEGREE_M)).abs() < 2e-8);
    // Eastward and level at 0° N 10° E: forward is (−sin 10°, cos 10°, 0) earth-centred, left is
    // the pole, up is (cos 10°, sin 10°, 0). The quaternion must turn the axes there.
    let q: Vec<f64> = aircraft["orientation"]["unitQuaternion"]
        .as_array()
        .unwrap()[1..5]
        .iter()
        .map(|v| v.as_f64().unwrap())
        .collect();
    let turned = |v: [f64; 3]| {
        let [x, y, z, w] = [q[0], q[1], q[2], q[3]];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let t = cross([x, y, z], v).map(|c| 2.0 * c);
        let u = cross([x, y, z], t);
        [
            v[0] + w * t[0] + u[0],
            v[1] + w * t[1] + u[1],
            v[2] + w * t[2] + u[2],
        ]
    };
    let (sin, cos) = 10.0_f64.to_radians().sin_cos();
    for (axis, expected) in [
        ([1.0, 0.0, 0.0], [-sin, cos, 0.0]),
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 1.0], [cos, sin, 0.0]),
    ] {
        let found = turned(axis);
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-9),
            "{found:?}"
        );
    }
    let mast = packets.iter().find(|p| p["id"] == "obstacle/0").unwrap();
    assert_eq!(mast["name"], HOSTILE);
    assert_eq!(mast["cylinder"]["length"], 120.0);
    let event = packets.iter().find(|p| p["id"] == "event/0").unwrap();
    assert!(!event["description"].as_str().unwrap().contains("<img"));
    for odd in odd_flights() {
        let packets: Vec<Value> = serde_json::from_str(&czml::text(&odd)).unwrap();
        assert!(packets.len() > 1);
    }
}

#[test]
fn geojson_is_read_by_its_library() {
    let text = map::text(&flight());
    let collection: geojson::FeatureCollection = text
        .parse::<geojson::GeoJson>()
        .unwrap()
        .try_into()
        .unwrap();
    let kinds: Vec<&str> = collection
        .features
        .iter()
        .map(|f| f.property("kind").unwrap().as_str().unwrap())
        .collect();
    assert_eq!(
        kinds,
        [
            "track", "track", "track", "mission", "obstacle", "volume", "obstacle", "volume",
            "event", "event"
        ]
    );
    // The pieces of the track meet, so that the line has no gaps.
    let line = |index: usize| match &collection.features[index].geometry.as_ref().unwrap().value {
        geojson::GeometryValue::LineString { coordinates } => coordinates.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(line(0).last(), line(1).first());
    assert_eq!(line(1).last(), line(2).first());
    // Rings are closed and anticlockwise, as the format requires.
    let geojson::GeometryValue::Polygon { coordinates } =
        &collection.features[5].geometry.as_ref().unwrap().value
    else {
        panic!("a polygon");
    };
    let ring = &coordinates[0];
    assert_eq!(ring.first(), ring.last());
    let area: f64 = ring
        .windows(2)
        .map(|p| p[0][0] * p[1][1] - p[1][0] * p[0][1])
        .sum();
    assert!(area > 0.0);
    // The intruder is 40 m to the side when they meet (its closing speed is 40 m/s: 22.5 s):
    // 10 m outside its sphere.
    let margin = collection.features[7]
        .property("least_margin_m")
        .unwrap()
        .as_f64()
        .unwrap();
    assert!((margin - 10.0).abs() < 1e-6, "{margin}");
    assert_eq!(collection.features[4].property("name").unwrap(), HOSTILE);
    for odd in odd_flights() {
        assert!(map::text(&odd).parse::<geojson::GeoJson>().is_ok());
    }
}

/// A village without a ceiling, clockwise, and a corridor to stay within.
fn zones() -> [FlightZone; 2] {
    [
        FlightZone {
            name: HOSTILE.into(),
            keep_in: false,
            ring_m: vec![[0.0, 0.0], [100.0, 300.0], [100.0, 0.0], [0.0, 0.0]],
            floor_m: Some(10.0),
            ceiling_m: None,
        },
        FlightZone {
            name: "corridor".into(),
            keep_in: true,
            ring_m: vec![[-50.0, -90.0], [700.0, -90.0], [0.0, 90.0], [-50.0, -90.0]],
            floor_m: Some(20.0),
            ceiling_m: Some(80.0),
        },
    ]
}

/// The origin lies 100 m above the datum, and the flight 50 m above it.
#[test]
fn zones_are_drawn_between_their_altitudes() {
    let flight = Flight {
        zones: zones().to_vec(),
        ..flight()
    };
    flight.check().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    flight.write(&path).unwrap();
    assert_eq!(Flight::read(&path).unwrap(), flight);

    let text = kml::text(&flight);
    let document = roxmltree::Document::parse(&text).unwrap();
    let folder = document
        .descendants()
        .find(|node| {
            node.has_tag_name("Folder") && node.descendants().any(|n| n.text() == Some("Zones"))
        })
        .unwrap();
    let faces: Vec<Vec<f64>> = (folder.descendants())
        .filter(|node| node.has_tag_name("coordinates"))
        .map(|node| {
            let places = node.text().unwrap().split_whitespace();
            places
                .map(|place| place.rsplit(',').next().unwrap().parse().unwrap())
                .collect()
        })
        .collect();
    // Three walls, floor and lid; and three walls. Without a ceiling the village ends 100 m above the flight.
    assert_eq!(faces.len(), 5 + 3);
    let heights = |faces: &[Vec<f64>]| {
        let all = || faces.iter().flatten().copied();
        (
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
        )
    };
    assert_eq!(heights(&faces[..5]), (110.0, 250.0));
    assert_eq!(heights(&faces[5..]), (120.0, 180.0));

    let packets: Vec<Value> = serde_json::from_str(&czml::text(&flight)).unwrap();
    let packet = |id: &str| packets.iter().find(|p| p["id"] == id).unwrap();
    let village = &packet("zone/0")["polygon"];
    assert_eq!(
        (&village["height"], &village["extrudedHeight"]),
        (&110.0.into(), &250.0.into())
    );
    let wall = &packet("zone/1")["wall"];
    assert_eq!(
        wall["maximumHeights"]["array"],
        serde_json::json!([180.0, 180.0, 180.0, 180.0])
    );

    let map: Value = serde_json::from_str(&map::text(&flight)).unwrap();
    let features = map["features"].as_array().unwrap();
    let zones: Vec<&Value> = features
        .iter()
        .filter(|f| f["properties"]["kind"] == "zone")
        .collect();
    let [village, corridor] = zones[..] else {
        panic!("{zones:?}")
    };
    assert_eq!(village["properties"]["zone"], "keep-out");
    assert_eq!(village["properties"]["ceiling_m"], Value::Null);
    assert_eq!(corridor["properties"]["ceiling_m"], 180.0);
    for zone in [village, corridor] {
        let ring: Vec<[f64; 2]> =
            serde_json::from_value(zone["geometry"]["coordinates"][0].clone()).unwrap();
        let edges = ring.windows(2);
        assert!(
            edges
                .map(|e| e[0][0] * e[1][1] - e[1][0] * e[0][1])
                .sum::<f64>()
                > 0.0
        );
    }
}

/// Known but for the fifth to the tenth second, 30 m above the datum where the flight is 150 m above it; the track alone knows each tenth.
#[test]
fn the_height_above_the_ground_is_drawn_where_the_ground_is_known() {
    let mut flight = flight();
    for sample in &mut flight.samples {
        let is_known = !(4.95..10.05).contains(&sample.time_s);
        sample.ground_m = is_known.then_some(-70.0);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    flight.write(&path).unwrap();
    assert_eq!(Flight::read(&path).unwrap(), flight);

    let packets: Vec<Value> = serde_json::from_str(&czml::text(&flight)).unwrap();
    let walls: Vec<&Value> = packets.iter().filter_map(|p| p.get("wall")).collect();
    let counts = walls.iter().map(|wall| {
        let places = wall["positions"]["cartographicDegrees"].as_array().unwrap();
        let lowest = wall["minimumHeights"]["array"].as_array().unwrap();
        assert_eq!(places.len(), 3 * lowest.len());
        assert!((places[2].as_f64().unwrap() - 150.0).abs() < 1e-6);
        assert!((lowest[0].as_f64().unwrap() - 30.0).abs() < 1e-6);
        lowest.len()
    });
    assert_eq!(counts.collect::<Vec<_>>(), [5, 20]);

    let text = kml::text(&flight);
    let document = roxmltree::Document::parse(&text).unwrap();
    let curtains = document.descendants().filter(|node| {
        node.has_tag_name("Placemark")
            && node
                .descendants()
                .any(|n| n.text() == Some("Height above the ground"))
    });
    let faces =
        curtains.map(|node| {
            let faces = node.descendants().filter(|n| n.has_tag_name("coordinates"));
            let faces: Vec<&str> = faces.filter_map(|face| face.text()).collect();
            assert!(faces.iter().all(|face| face.matches(",30.00 ").count() == 3
                && face.matches(",150.00 ").count() == 2));
            faces.len()
        });
    assert_eq!(faces.collect::<Vec<_>>(), [4, 19]);

    let map: Value = serde_json::from_str(&map::text(&flight)).unwrap();
    let above_m = map["features"][0]["properties"]["above_ground_m"]
        .as_array()
        .unwrap();
    let known: Vec<&Value> = above_m
        .iter()
        .filter(|above_m| !above_m.is_null())
        .collect();
    assert_eq!(
        (above_m.len(), known.len(), known[0]),
        (100, 50, &120.0.into())
    );
    flight.samples[0].ground_m = Some(f64::NAN);
    assert!(flight.check().unwrap_err().contains("not finite"));
}

/// An outline that is open, too short or not finite is refused.
#[test]
fn a_flight_whose_zone_is_no_outline_is_refused() {
    for ring_m in [
        vec![],
        vec![[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]],
        vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        vec![[0.0, 0.0], [1.0, f64::NAN], [1.0, 1.0], [0.0, 0.0]],
    ] {
        let [village, _] = zones();
        let flight = Flight {
            zones: vec![FlightZone { ring_m, ..village }],
            ..flight()
        };
        let error = flight.check().unwrap_err();
        assert!(error.contains("closed ring"), "{error}");
    }
}

#[test]
fn mcap_is_read_by_the_library() {
    let bytes = log::bytes(&flight()).unwrap();
    let mut counts: BTreeMap<String, u32> = BTreeMap::new();
    let mut least_m = f64::INFINITY;
    let mut last = 0;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        *counts.entry(message.channel.topic.clone()).or_default() += 1;
        assert_eq!(
            message.channel.schema.as_ref().unwrap().encoding,
            "jsonschema"
        );
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        assert!(message.log_time >= last);
        last = message.log_time;
        if message.channel.topic == "/separations" {
            least_m = least_m.min(value["least_margin_m"].as_f64().unwrap_or(f64::INFINITY));
        }
    }
    assert!((least_m - 10.0).abs() < 1e-6, "{least_m}");
    assert_eq!(counts["/events"], 2);
    assert_eq!(counts["/aircraft/pose"], 301);
    assert_eq!(counts["/scene"], 301);
    assert_eq!(counts["/aircraft/location"], 301);
    for odd in odd_flights() {
        let bytes = log::bytes(&odd).unwrap();
        assert!(
            mcap::MessageStream::new(&bytes)
                .unwrap()
                .all(|message| message.is_ok())
        );
    }
}

#[test]
fn mcap_is_read_by_another_language() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.mcap");
    export::write(&flight(), Format::Mcap, &path).unwrap();
    let script = "import sys, json\n\
        from mcap.reader import make_reader\n\
        with open(sys.argv[1],'rb') as f:\n\
        \x20   r=make_reader(f, validate_crcs=True)\n\
        \x20   n={}\n\
        \x20   for schema, channel, message in r.iter_messages():\n\
        \x20       json.loads(schema.data); d=json.loads(message.data)\n\
        \x20       n[channel.topic]=n.get(channel.topic,0)+1\n\
        \x20       if channel.topic=='/events' and d['kind']=='start': name=d['detail']['obstacle']\n\
        \x20   s=r.get_summary().statistics\n\
        \x20   assert s.message_count==sum(n.values())\n\
        print(json.dumps([n['/scene'],n['/separations'],n['/events'],name,s.message_start_time]))";
    let Some(found) = python("mcap.reader", script, &[&path]) else {
        return;
    };
    let found: Value = serde_json::from_str(&found).unwrap();
    let expected = serde_json::json!([301, 301, 2, HOSTILE, 1_709_164_799_250_000_000_u64]);
    assert_eq!(found, expected);
}

#[test]
fn flightgear_lines_fit_the_protocol_file() {
    let protocol = roxmltree::Document::parse(flightgear::PROTOCOL_XML).unwrap();
    let chunks = protocol
        .descendants()
        .filter(|n| n.has_tag_name("chunk"))
        .count();
    let mut flight = flight();
    flight.samples[0].bank_rad = 0.5;
    flight.samples[0].climb_rad = -0.1;
    let line = flightgear::line(&flight.frame(), &flight.samples[0], 20.0);
    let text = String::from_utf8(line).unwrap();
    let fields: Vec<f64> = text
        .trim_end()
        .split('\t')
        .map(|f| f.parse().unwrap())
        .collect();
    assert_eq!(fields.len(), chunks);
    // 150 m are 492.13 ft; a left bank of 0.5 rad is −28.648°; −0.1 rad is −5.730°; east is 90°.
    let expected = [0.0, 10.0, 492.13, -28.648, -5.730, 90.0, 38.88];
    assert!(
        fields
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-3 + 5e-3),
        "{text}"
    );

    let listener = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    listener
        .set_read_timeout(Some(core::time::Duration::from_secs(5)))
        .unwrap();
    let sender =
        flightgear::FlightGearSender::new(&listener.local_addr().unwrap().to_string()).unwrap();
    sender.send(&flight.frame(), &flight.samples[0], 20.0);
    let mut datagram = [0; 256];
    let (length, _) = listener.recv_from(&mut datagram).unwrap();
    assert_eq!(&datagram[..length], text.as_bytes());
}

#[test]
fn a_flight_is_kept_as_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    for flight in odd_flights().into_iter().chain([flight()]) {
        flight.write(&path).unwrap();
        assert_eq!(Flight::read(&path).unwrap(), flight);
    }
    let refused = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Flight::read(&path).unwrap_err().to_string()
    };
    assert!(refused("{}").ends_with("holds no samples, expected at least one"));
    assert!(refused("{\"samples\": 3}").contains("line 1: is no recorded flight"));
    let back = flight();
    let mut text = serde_json::to_string(&back).unwrap();
    text = text.replacen("\"time_s\":0.1,", "\"time_s\":-1,", 1);
    assert!(refused(&text).ends_with("goes from 0 s to -1 s, expected it to grow"));
}

#[test]
fn formats_have_names() {
    for format in Format::ALL {
        assert_eq!(format.name().to_uppercase().parse::<Format>(), Ok(format));
    }
    let error = "kmz".parse::<Format>().unwrap_err();
    assert_eq!(
        error,
        "the format \"kmz\" is unknown, expected kml, czml, geojson or mcap"
    );
    let error: OutputError =
        export::write(&flight(), Format::Kml, Path::new("/nonexistent/a.kml")).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("there is no such file or folder"),
        "{error}"
    );
}

//! Missions as QGroundControl, Mission Planner and MAVProxy write them.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of steps"
)]

use core::fmt::Write as _;

use fga::situation::Passing;
use fga_formats::areas::AreaOutline;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::missions::{MissionFence, MissionFile, Waypoint, is_mission, parse};
use fga_formats::terrain::{self, Given, Terrain};
use proptest::prelude::*;
use std::path::Path;

/// Take-off, three waypoints, a servo, a jump and a return, as Mission Planner writes them.
const LIST: &str = "QGC WPL 110\r
0\t1\t0\t16\t0\t0\t0\t0\t-35.3632620\t149.1652370\t584.000000\t1\r
1\t0\t3\t22\t15.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t50.000000\t1\r
2\t0\t3\t16\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t-35.35900000\t149.16500000\t100.000000\t1\r
3\t0\t3\t183\t9.00000000\t1900.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.000000\t1\r
4\t0\t0\t16\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t-35.35900000\t149.17500000\t700.000000\t1\r
5\t0\t3\t18\t2.00000000\t0.00000000\t60.00000000\t0.00000000\t-35.36500000\t149.17500000\t100.000000\t1\r
6\t0\t3\t177\t2.00000000\t3.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.000000\t1\r
7\t0\t3\t20\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.000000\t1\r
";

#[test]
fn n8_a_list_of_mission_planner_is_read() {
    let file = parse(LIST, Path::new("a.waypoints")).unwrap();
    let heights: Vec<f64> = file.waypoints.iter().map(|w| w.place.altitude_m).collect();
    // Over home at the height of the take-off; above home, above the sea, above home; over home again.
    assert_eq!(heights, [634.0, 684.0, 700.0, 684.0, 684.0]);
    let home = file.home.unwrap();
    assert_eq!(home.latitude_deg, -35.363_262);
    let last = file.waypoints.last().unwrap();
    assert_eq!(last.place.longitude_deg, home.longitude_deg);
    assert_eq!(file.waypoints[3].passing, Passing::FlyOver);
    let notes = file.notes.join("\n");
    for part in [
        "take-off is not flown",
        "1 loiter item flown past",
        "2 items without a leg not flown: DO_JUMP 1, DO_SET_SERVO 1",
        "the return ends over home",
    ] {
        assert!(notes.contains(part), "{part}: {notes}");
    }
}

/// A plan with a survey, a landing pattern, fences and a rally point, as QGroundControl writes them.
const PLAN: &str = r#"{
    "fileType": "Plan",
    "geoFence": {
        "circles": [{"circle": {"center": [47.5, 8.6], "radius": 120.5}, "inclusion": false, "version": 1}],
        "polygons": [{"inclusion": true, "polygon": [[47.3, 8.4], [47.5, 8.4], [47.5, 8.7]], "version": 1}],
        "version": 2
    },
    "groundStation": "QGroundControl",
    "mission": {
        "cruiseSpeed": 15, "firmwareType": 3, "globalPlanAltitudeMode": 1, "hoverSpeed": 5,
        "items": [
            {"AMSLAltAboveTerrain": null, "Altitude": 50, "AltitudeMode": 1, "autoContinue": true, "command": 22,
             "doJumpId": 1, "frame": 3, "params": [15, 0, 0, null, 47.397, 8.545, 50], "type": "SimpleItem"},
            {"autoContinue": true, "command": 178, "doJumpId": 2, "frame": 2,
             "params": [1, 18, -1, 0, 0, 0, 0], "type": "SimpleItem"},
            {"TransectStyleComplexItem": {"CameraCalc": {"DistanceMode": 1}, "Items": [
                {"autoContinue": true, "command": 16, "doJumpId": 3, "frame": 3,
                 "params": [0, 0, 0, null, 47.40, 8.55, 80], "type": "SimpleItem"},
                {"autoContinue": true, "command": 206, "doJumpId": 4, "frame": 2,
                 "params": [25, 0, 1, 0, 0, 0, 0], "type": "SimpleItem"},
                {"autoContinue": true, "command": 16, "doJumpId": 5, "frame": 3,
                 "params": [0, 0, 0, null, 47.41, 8.55, 80], "type": "SimpleItem"}
             ]}, "angle": 0, "complexItemType": "survey", "polygon": [], "type": "ComplexItem", "version": 5},
            {"altitudesAreRelative": true, "complexItemType": "fwLandingPattern",
             "landCoordinate": [47.398, 8.546, 0], "landingApproachCoordinate": [47.405, 8.546, 40],
             "loiterClockwise": true, "loiterRadius": 75, "type": "ComplexItem", "version": 2}
        ],
        "plannedHomePosition": [47.3977, 8.5456, 488.1], "vehicleType": 1, "version": 2
    },
    "rallyPoints": {"points": [[47.39, 8.54, 60]], "version": 2},
    "version": 1
}"#;

#[test]
fn n8_a_plan_of_qgroundcontrol_is_read() {
    assert!(is_mission(PLAN));
    let file = parse(PLAN, Path::new("a.plan")).unwrap();
    let heights: Vec<f64> = file
        .waypoints
        .iter()
        .map(|w| w.place.altitude_m - 488.1)
        .collect();
    let expected = [50.0, 80.0, 80.0, 40.0];
    assert!(
        heights
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-9),
        "{heights:?}"
    );
    assert_eq!(heights.len(), expected.len());
    assert_eq!(file.cruise_mps, Some(15.0));
    assert_eq!(file.fences.len(), 2);
    assert!(!file.fences[0].keep_in && file.fences[1].keep_in);
    assert_eq!(
        file.fences[0].outline,
        AreaOutline::Circle {
            center_deg: [47.5, 8.6],
            radius_m: 120.5
        }
    );
    assert!((file.rally[0].altitude_m - 548.1).abs() < 1e-9);
    let notes = file.notes.join("\n");
    for part in [
        "1 rally point read",
        "the landing is not flown",
        "DO_CHANGE_SPEED 1, DO_SET_CAM_TRIGG_DIST 1",
    ] {
        assert!(notes.contains(part), "{part}: {notes}");
    }
}

#[test]
fn the_first_row_of_a_list_is_home_whatever_its_frame() {
    let list = |frame: u16| {
        format!(
            "QGC WPL 110\n0 0 {frame} 16 0 0 0 0 45.0 5.0 343.0 1\n1 0 3 22 15 0 0 0 0 0 40 1\n2 0 3 16 0 0 0 0 45.01 5.0 50 1\n"
        )
    };
    let expected = parse(&list(0), Path::new("a.waypoints")).unwrap();
    assert_eq!(expected.home.map(|home| home.altitude_m), Some(343.0));
    for frame in [3, 6, 10] {
        let found = parse(&list(frame), Path::new("a.waypoints")).unwrap();
        assert_eq!(
            (found.home, &found.waypoints),
            (expected.home, &expected.waypoints)
        );
        assert!(
            found.notes[0].starts_with("item 0 is home"),
            "{:?}",
            found.notes
        );
    }
}

#[test]
fn heights_that_contradict_each_other_are_named() {
    let plan = |params: &str, sea: &str| {
        format!(
            r#"{{"fileType":"Plan","version":1,"mission":{{"version":2,"plannedHomePosition":[45.0,5.0,480.0],"items":[
            {{"type":"SimpleItem","command":16,"frame":0,"params":[0,0,0,null,45.0,5.01,{params}],"Altitude":16,"AltitudeMode":3,
              "AMSLAltAboveTerrain":{sea}}}]}}}}"#
        )
    };
    let notes = |params, sea| {
        let file = parse(&plan(params, sea), Path::new("a.plan"));
        file.map(|file| file.notes.join("; "))
            .map_err(|error| error.to_string())
    };
    let told = notes("16", "505").unwrap();
    assert!(
        told.contains(
            "item 1 is flown 16 m above the sea (params), though 16 m above the terrain are 505 m"
        ),
        "{told}"
    );
    assert!(told.contains("item 1 is 464 m below home"), "{told}");
    let agreed = notes("505", "505").unwrap();
    assert!(!agreed.contains("item 1"), "{agreed}");
    let told = notes("null", "null").unwrap_err();
    assert!(
        told.contains("item 1 is 16 m above the terrain, whose height the station did not write"),
        "{told}"
    );
}

#[test]
fn groups_of_fences_that_are_joined_are_named() {
    let list = |groups: [u8; 2]| {
        let mut text = String::from("QGC WPL 110\n0 1 0 16 0 0 0 0 45.0 5.0 200 1\n");
        for (index, group) in groups.iter().enumerate() {
            for (corner, place) in ["44.99\t4.98", "45.01\t4.98", "45.01\t5.03"]
                .iter()
                .enumerate()
            {
                let number = 1 + 3 * index + corner;
                let _ = writeln!(
                    text,
                    "{number}\t0\t3\t5001\t3\t{group}\t0\t0\t{place}\t0\t1"
                );
            }
        }
        parse(&text, Path::new("a.waypoints")).unwrap().notes
    };
    assert!(list([0, 0]).is_empty());
    assert!(
        list([0, 1])[0].contains("are of 2 groups"),
        "{:?}",
        list([0, 1])
    );
}

#[test]
fn n8_fences_and_rally_points_of_mission_planner_are_read() {
    let row = |number: u32, command: u32, first: f64, place: &str| {
        format!("{number}\t0\t3\t{command}\t{first}\t0\t0\t0\t{place}\t100\t1\n")
    };
    let text = format!(
        "QGC WPL 110\n{}{}{}{}{}{}",
        "0\t1\t0\t16\t0\t0\t0\t0\t45\t5\t100\t1\n",
        row(1, 5001, 3.0, "45.0\t5.0"),
        row(2, 5001, 3.0, "45.1\t5.0"),
        row(3, 5001, 3.0, "45.1\t5.1"),
        row(4, 5004, 80.0, "45.05\t5.02"),
        row(5, 5100, 0.0, "45.02\t5.01"),
    );
    let file = parse(&text, Path::new("fence.waypoints")).unwrap();
    assert_eq!(file.holds(), "0 waypoints, 2 fences, 1 rally point");
    // Their heights do not count, in whatever frame.
    let above_terrain = text.replace("\t0\t3\t5", "\t0\t10\t5");
    let file = parse(&above_terrain, Path::new("fence.waypoints")).unwrap();
    assert_eq!(file.holds(), "0 waypoints, 2 fences, 0 rally points");
    assert!(
        file.notes[0].ends_with("rally point above the terrain 1"),
        "{:?}",
        file.notes
    );
    // A circle around home, where the file has one; a file of fences alone says what it does not read.
    let around = text.replace("4\t0\t3\t5004\t80", "4\t0\t3\t5005\t80");
    let file = parse(&around, Path::new("fence.waypoints")).unwrap();
    let center_deg = [45.0, 5.0];
    let outline = AreaOutline::Circle {
        center_deg,
        radius_m: 80.0,
    };
    assert_eq!(
        file.fences[1],
        MissionFence {
            outline,
            keep_in: true
        }
    );
    let alone = "QGC WPL 110\n0 0 0 5005 50 0 0 0 0 0 0 0\n";
    let file = parse(alone, Path::new("fence.waypoints")).unwrap();
    let told = "1 item without a leg not flown: fence around a home that the file does not give 1";
    assert_eq!(
        (file.fences.len(), &file.notes[..]),
        (0, &[told.to_owned()][..])
    );
    let unfinished = text.replace("3\t0\t3\t5001", "3\t0\t3\t5003");
    let error = parse(&unfinished, Path::new("f.waypoints")).unwrap_err();
    assert!(error.message.contains("2 of 3 corners"), "{error}");
}

#[test]
fn n8_what_cannot_be_understood_is_named_with_its_line() {
    let of_list =
        |from: &str, to: &str| parse(&LIST.replacen(from, to, 1), Path::new("a.waypoints"));
    let of_plan = |from: &str, to: &str| parse(&PLAN.replacen(from, to, 1), Path::new("a.plan"));
    for (found, expected) in [
        (
            of_list("110", "120"),
            "a.waypoints, line 1: is version \"120\", expected QGC WPL 110",
        ),
        (
            of_list("2\t0\t3\t16", "2\t0\t7\t16"),
            "a.waypoints, line 4: item 2 has frame 7, expected 0 or 5",
        ),
        (
            of_list("-35.359", "-95.359"),
            "a.waypoints, line 4: item 2 is at latitude -95.359",
        ),
        (
            of_list("-35.3632620", "-95.363"),
            "a.waypoints, line 2: item 0 is at latitude -95.363",
        ),
        (
            of_list("-35.3632620", "nan"),
            "a.waypoints, line 2: item 0 has ",
        ),
        (
            of_list("584.000000", "nan"),
            "a.waypoints, line 2: item 0 has ",
        ),
        (
            of_list("100.000000\t1\r", "100.000000\r"),
            "a.waypoints, line 4: has 11 fields, expected 12",
        ),
        (
            of_list("-35.359", "S35.359"),
            "a.waypoints, line 4: field 9 is \"S35.35900000\", expected a number",
        ),
        (
            of_plan("\"inclusion\": true", "\"inclusion\": 1"),
            "a.plan, line 5: is no plan of QGroundControl: found integer `1`, expected true or false",
        ),
        (
            of_plan("\"Plan\"", "\"Mission\""),
            "a.plan: is of type \"Mission\", expected a Plan",
        ),
        (of_plan("47.397, 8.545", "47.397, 1e9"), ""),
        (
            of_plan("\"survey\"", "survey"),
            "a.plan, line 23: is no plan of QGroundControl",
        ),
        (
            of_plan("\"landingApproachCoordinate\"", "\"x\""),
            "a.plan: item 6 is a complex item of type \"fwLandingPattern\"",
        ),
        (
            of_plan("47.40, 8.55, 80", "47.40, null, 80"),
            "a.plan: item 3 has no place",
        ),
        (
            of_plan("[47.3977, 8.5456, 488.1]", "[47.3977]"),
            "a.plan: has an unusable plannedHomePosition",
        ),
        (
            of_plan("\"radius\": 120.5", "\"radius\": -1"),
            "a.plan: item 1 is no fence",
        ),
        (
            of_plan("[47.5, 8.6]", "[147.5, 8.6]"),
            "a.plan: item 1 is at latitude 147.5",
        ),
        (
            of_plan("[47.5, 8.7]", "[47.5, -8.7]"),
            "a.plan: item 2 is 1293 km from where the mission begins",
        ),
    ] {
        match found {
            Ok(_) => assert!(expected.is_empty(), "{expected}"),
            Err(error) => assert!(
                !expected.is_empty() && error.to_string().starts_with(expected),
                "{error}"
            ),
        }
    }
}

#[test]
fn n8_an_unknown_version_or_order_is_refused() {
    let plan = |from: &str, to: &str| {
        let text = PLAN.replacen(from, to, 1);
        assert_ne!(text, PLAN);
        parse(&text, Path::new("a.plan")).map_err(|error| error.to_string())
    };
    let list = |from: &str, to: &str| {
        let text = LIST.replacen(from, to, 1);
        assert_ne!(text, LIST);
        parse(&text, Path::new("a.waypoints")).map_err(|error| error.to_string())
    };
    let version = "\"version\": ";
    for (found, expected) in [
        (
            plan("\n    \"version\": 1\n", "\n    \"version\": 99\n"),
            "a.plan: has version 99, expected 1",
        ),
        (
            plan("1, \"version\": 2\n    }", "1, \"version\": 99\n    }"),
            "a.plan: has mission.version 99, expected 2",
        ),
        (
            plan(
                "],\n        \"version\": 2",
                "],\n        \"version\": \"2\"",
            ),
            "a.plan: has geoFence.version \"2\", expected 1 or 2",
        ),
        (
            plan("60]], \"version\": 2", "60]], \"version\": 3"),
            "a.plan: has rallyPoints.version 3, expected 2",
        ),
        (
            plan("\"doJumpId\": 4", "\"doJumpId\": 9"),
            "a.plan: item 5 has doJumpId 5 after 9, expected whole numbers that grow",
        ),
        (
            plan("\"doJumpId\": 1", "\"doJumpId\": \"1\""),
            "a.plan: item 1 has doJumpId \"1\", expected whole numbers that grow",
        ),
        (
            plan("\"params\": [15, 0", "\"params\": [\"15\", 0"),
            "a.plan: item 1 cannot be read: found string \"15\", expected a number",
        ),
        (
            plan(
                "\"items\": [\n            {\"AMSL",
                "\"items\": 3, \"x\": [\n            {\"AMSL",
            ),
            "a.plan, line 11: is no plan of QGroundControl: found integer `3`",
        ),
        (
            list("QGC WPL 110", "\r\nQGC WPL x 110"),
            "a.waypoints, line 2: is version \"x 110\", expected QGC WPL 110",
        ),
    ] {
        let error = found.expect_err(expected);
        assert!(error.starts_with(expected), "{error}\n{expected}");
    }
    // Stations fly the lines of a list in their order; a number out of it may be a line that is lost.
    for (from, to, told) in [
        (
            "2\t0\t3\t16",
            "3\t0\t3\t16",
            "line 4 holds item 3 after item 1: ",
        ),
        (
            "5\t0\t3\t18",
            "4\t0\t3\t18",
            "line 7 holds item 4 after item 4: ",
        ),
    ] {
        let file = list(from, to).unwrap();
        assert!(file.notes[0].starts_with(told), "{:?}", file.notes);
        assert_eq!(file.waypoints.len(), 5);
    }
    // A station that knows no ground writes no altitude of home.
    let level = plan("8.5456, 488.1", "8.5456, null").unwrap();
    assert!(
        level.notes[0].starts_with("home has no altitude"),
        "{:?}",
        level.notes
    );
    // A version that is left out is the known one, and version 1 of a fence has one polygon.
    let bare = PLAN.replace(version, "\"x\": ");
    assert!(parse(&bare, Path::new("a.plan")).is_ok());
}

/// The run-up of a mission of one place, such as a plan with a single item over home.
#[test]
fn n8_a_mission_of_one_place_has_a_way_to_it() {
    let text = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t45\t5\t100\t1\n1\t0\t3\t16\t0\t0\t0\t0\t45\t5\t100\t1\n";
    let file = parse(text, Path::new("a.waypoints")).unwrap();
    assert_eq!(file.waypoints.len(), 2);
    assert_eq!(file.waypoints[1].place.altitude_m, 200.0);
    assert!(file.notes[0].contains("begins 1000 m south of it"));
}

/// A mission over the file `strips.tif`, whose formula is in `terrain/fixtures.py`: from above the sea to 80 m and to 120 m above the ground, and
/// above the sea again.
const ABOVE_GROUND: &str = "QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t46.51\t9.21\t1000\t1
1\t0\t0\t16\t0\t0\t0\t0\t46.51\t9.21\t1500\t1
2\t0\t10\t16\t0\t0\t0\t0\t46.51\t9.29\t80\t1
3\t0\t11\t17\t0\t0\t0\t0\t46.56\t9.30\t120\t1
";

fn heights(name: &str, bytes: &[u8]) -> Terrain {
    let file = terrain::parse(bytes, Path::new(name), &Given::default()).unwrap();
    Terrain::new(vec![file]).unwrap()
}

#[test]
fn a_mission_above_the_ground_follows_it() {
    let file = parse(ABOVE_GROUND, Path::new("a.waypoints")).unwrap();
    assert_eq!((file.waypoints.len(), file.above_ground()), (3, 2));
    let ground = heights("strips.tif", include_bytes!("terrain/strips.tif"));
    let frame = LocalFrame::new(file.home.unwrap(), Earth::Wgs84);
    // The places of the way each few metres, and the waypoints of the file by their index.
    let way = |flown: &MissionFile| -> Vec<(Geodetic, usize)> {
        let at = |waypoint: &Waypoint| frame.to_local_m(waypoint.place);
        let mut leg = 0;
        let pairs = flown.waypoints.windows(2);
        let places = pairs.flat_map(|pair| {
            let (from, to) = (at(&pair[0]), at(&pair[1]));
            let begun = leg;
            let place = pair[1].place;
            let is_file_s = |known: &Waypoint| {
                (known.place.latitude_deg - place.latitude_deg).abs() < 1e-8
                    && (known.place.longitude_deg - place.longitude_deg).abs() < 1e-8
            };
            leg += usize::from(file.waypoints.iter().any(is_file_s));
            let steps = libm::ceil(from.distance(to) / 7.0);
            let shares = (0..=steps as usize).map(move |step| step as f64 / steps);
            shares
                .map(move |share| (frame.to_geodetic(from.lerp(to, share)), begun))
                .collect::<Vec<_>>()
        });
        places.collect()
    };
    let above_m = |place: Geodetic| {
        place.altitude_m
            - ground
                .height_m(place.latitude_deg, place.longitude_deg)
                .unwrap()
    };
    // As steep as the ground.
    let flown = file.clone().over(&ground, f64::INFINITY).unwrap();
    assert_eq!(flown.above_ground(), 0);
    assert!(flown.waypoints.len() > 8, "{}", flown.waypoints.len());
    let first_m = above_m(flown.waypoints[0].place);
    assert!((flown.waypoints[0].place.altitude_m - 1500.0).abs() < 1e-6);
    let corners = [file.waypoints[0], file.waypoints[1], file.waypoints[2]];
    for (place, leg) in way(&flown) {
        let at = |waypoint: Waypoint| {
            let to = Geodetic {
                altitude_m: 0.0,
                ..waypoint.place
            };
            Geodetic {
                altitude_m: 0.0,
                ..place
            }
            .distance_m(to)
        };
        let (from, to) = (at(corners[leg]), at(corners[leg + 1]));
        let share = from / (from + to);
        let asked_m = [[first_m, 80.0], [80.0, 120.0]][leg];
        let asked_m = asked_m[0] + share * (asked_m[1] - asked_m[0]);
        // Two metres by the places between, a decimetre by the bend of the earth along a leg.
        assert!(
            (above_m(place) - asked_m).abs() < 2.2,
            "{place:?} {asked_m} {}",
            above_m(place)
        );
    }
    assert!(
        flown
            .notes
            .iter()
            .any(|note| note.starts_with("2 waypoints above the ground, with "))
    );
    // An aircraft that climbs less steeply than the ground begins earlier; it is nowhere lower.
    let gentle = file.clone().over(&ground, 0.08).unwrap();
    let told = gentle.notes.last().unwrap();
    assert!(
        told.starts_with("the ground is steeper than the aircraft flies"),
        "{told}"
    );
    for (place, leg) in way(&gentle) {
        assert!(above_m(place) > [80.0, 80.0][leg] - 2.2, "{place:?}");
    }
    for pair in gentle.waypoints.windows(2).skip(1) {
        let [from, to] = [&pair[0], &pair[1]].map(|each| frame.to_local_m(each.place));
        let way_m = from.truncate().distance(to.truncate());
        assert!((to.z - from.z).abs() <= 0.08 * way_m + 2.0, "{from} {to}");
    }
    // What the files do not know, and what is not above the sea, is refused.
    let away = ABOVE_GROUND.replace("46.56", "47.56");
    let away = parse(&away, Path::new("a.waypoints")).unwrap();
    let error = away.over(&ground, 1.0).unwrap_err();
    assert!(
        error.starts_with("leads over unknown ground to waypoint 3"),
        "{error}"
    );
    let ellipsoid = heights("ellipsoid.tif", include_bytes!("terrain/ellipsoid.tif"));
    let error = file.clone().over(&ellipsoid, 1.0).unwrap_err();
    assert!(error.contains("expected mean sea level"), "{error}");
}

proptest! {
    /// Whatever a text holds, it is refused in one sentence or gives places on the earth.
    #[test]
    fn any_text_is_a_mission_of_places_or_refused(
        rows in prop::collection::vec((0u16..6000, 0u16..12, prop::collection::vec("[-0-9.eN]{0,6}", 7)), 0..20),
    ) {
        let mut text = String::from("QGC WPL 110\n");
        for (index, (command, frame, rest)) in rows.iter().enumerate() {
            let rest = rest.join(" ");
            writeln!(text, "{index} 0 {frame} {command} {rest} 1").unwrap();
        }
        match parse(&text, Path::new("a.waypoints")) {
            Ok(file) => prop_assert!(file.waypoints.iter().all(|w| w.place.latitude_deg.abs() <= 91.0)),
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }
}

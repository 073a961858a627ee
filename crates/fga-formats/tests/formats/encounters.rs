//! The batch file: content, refusals and their sentences.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use fga::situation::{Movement, Obstacle, ProtectedVolume};
use fga_formats::encounters::{self, Encounter};
use glam::DVec3;
use proptest::prelude::*;
use std::path::Path;

const HEADER: &str = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n";

fn parse(text: &str) -> Result<Vec<Encounter>, String> {
    encounters::parse(text.as_bytes(), Path::new("e.csv")).map_err(|error| error.to_string())
}

#[test]
fn rows_are_grouped_in_the_order_of_first_appearance() {
    let text = format!(
        "{HEADER}7,0,1,2,3,4,5,6,30\n3,1,0,0,0,0,0,0,0\n\n# note\n7,4,1e2,-2,.5,4,5,6,30.5\n"
    );
    let found = parse(&text).unwrap();
    assert_eq!(found.iter().map(|e| e.id).collect::<Vec<_>>(), [7, 3]);
    assert_eq!(
        found[0].obstacles[1],
        Obstacle::straight(
            4,
            DVec3::new(100.0, -2.0, 0.5),
            DVec3::new(4.0, 5.0, 6.0),
            ProtectedVolume::Sphere { radius_m: 30.5 },
        )
    );
}

#[test]
fn the_kind_says_how_an_obstacle_may_move() {
    let header = HEADER.trim_end();
    let rows = ["still", "straight", "aircraft", "uas", ""]
        .iter()
        .zip(0..)
        .map(|(kind, id)| format!("1,{id},1,2,3,0,0,0,30,{kind}"))
        .collect::<Vec<_>>()
        .join("\n");
    let found = parse(&format!("{header},kind\n{rows}")).unwrap();
    let movements: Vec<Movement> = found[0].obstacles.iter().map(|o| o.movement).collect();
    assert_eq!(
        movements,
        [
            Movement::AtRest,
            Movement::Straight,
            Movement::CREWED,
            Movement::SMALL_UAS,
            Movement::Straight
        ]
    );
    let wrong = parse(&format!("{header},kind\n1,0,1,2,3,4,5,6,30,bird\n")).unwrap_err();
    assert!(
        wrong.ends_with("column kind holds \"bird\", expected still, straight, aircraft or uas"),
        "{wrong}"
    );
    let moving = parse(&format!("{header},kind\n1,7,1,2,3,4,5,6,30,still\n")).unwrap_err();
    let expected = "line 2: obstacle 7 of kind still moves at 4, 5, 6 m/s, expected a velocity of 0 or another kind";
    assert!(moving.ends_with(expected), "{moving}");
}

#[test]
fn columns_are_found_by_name_in_any_order() {
    let text = "radius_m, note ,vz_mps,vy_mps,vx_mps,z_m,y_m,x_m,Obstacle,encounter\r\n30,\"a, b\",6,5,4,3,2,1,8,9\r\n";
    let found = parse(text).unwrap();
    assert_eq!(found[0].id, 9);
    assert_eq!(found[0].obstacles[0].position_m, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        found[0].obstacles[0].velocity_mps,
        DVec3::new(4.0, 5.0, 6.0)
    );
}

#[test]
fn wrong_files_are_refused_with_file_line_and_reason() {
    let good = "1,0,1,2,3,4,5,6,30\n";
    for (text, message) in [
        (
            String::new(),
            "e.csv: is empty, expected the columns encounter,",
        ),
        (
            HEADER.into(),
            "e.csv: holds no encounter, expected at least one row",
        ),
        (
            HEADER.replace("vy_mps,", ""),
            "e.csv, line 1: the column vy_mps is missing, expected",
        ),
        (
            HEADER.replace("y_m,", "x_m,"),
            "e.csv, line 1: the column x_m appears twice, expected it once",
        ),
        (
            format!("{HEADER}{good}{good}"),
            "e.csv, line 3: encounter 1 has a second obstacle 0, expected each number once",
        ),
        (
            format!("{HEADER}{good}2,0,1,2,3,4,5,6,-30\n"),
            "e.csv, line 3: column radius_m holds \"-30\", expected a radius of 0 metres or more",
        ),
        (
            format!("{HEADER}1,0,NaN,2,3,4,5,6,30\n"),
            "e.csv, line 2: column x_m holds \"NaN\", expected a finite number of at most 1e8 metres",
        ),
        (
            format!("{HEADER}1,0,1,2,3,inf,5,6,30\n"),
            "e.csv, line 2: column vx_mps holds \"inf\", expected a finite number",
        ),
        (
            format!("{HEADER}1,0,1,2,3,,5,6,30\n"),
            "e.csv, line 2: column vx_mps holds \"\", expected a finite number of at most 1e5 metres per second",
        ),
        (
            format!("{HEADER}1,-1,1,2,3,4,5,6,30\n"),
            "e.csv, line 2: column obstacle holds \"-1\", expected a whole number from 0",
        ),
        (
            format!("{HEADER}1.5,1,1,2,3,4,5,6,30\n"),
            "e.csv, line 2: column encounter holds \"1.5\", expected a whole number from 0",
        ),
        (
            format!("{HEADER}1,1,1e300,2,3,4,5,6,30\n"),
            "e.csv, line 2: column x_m holds \"1e300\", expected a finite number of at most 1e8 metres either way",
        ),
        (
            format!("{HEADER}{good}2,0,1,2,3\n"),
            "e.csv, line 3: has 5 columns, expected 9 as in the first line",
        ),
    ] {
        let error = parse(&text).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    let error = encounters::read(Path::new("/nonexistent/e.csv")).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("there is no such file or folder")
    );
    let error = encounters::read(Path::new("/")).unwrap_err();
    assert!(error.to_string().contains("cannot be read"), "{error}");
}

proptest! {
    #[test]
    fn written_recordings_are_read_back(
        rows in proptest::collection::vec(
            (proptest::array::uniform6(-1e5..1e5_f64), 0.0..1e4_f64), 1..20),
        split in 1..5_usize, kinds in 1..5usize,
    ) {
        let round = |value: f64| (value * 1e6).round() / 1e6;
        let made: Vec<Encounter> = rows.chunks(split).zip(100..).map(|(chunk, id)| Encounter {
            id,
            obstacles: chunk.iter().zip(0..).map(|((v, radius), id)| {
                let movements = [Movement::Straight, Movement::AtRest, Movement::CREWED, Movement::SMALL_UAS];
                let movement = movements[id as usize % kinds];
                let moves = f64::from(u8::from(movement != Movement::AtRest));
                Obstacle { movement, ..Obstacle::straight(
                id,
                DVec3::new(round(v[0]), round(v[1]), round(v[2])),
                DVec3::new(round(v[3]), round(v[4]), round(v[5])) * moves,
                ProtectedVolume::Sphere { radius_m: round(*radius) },
            )}}).collect(),
        }).collect();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("e.csv");
        encounters::write(&path, &made).unwrap();
        let found = encounters::read(&path).unwrap();
        prop_assert_eq!(found.len(), made.len());
        for (found, made) in found.iter().zip(&made) {
            prop_assert_eq!(found.id, made.id);
            for (found, made) in found.obstacles.iter().zip(&made.obstacles) {
                prop_assert!((found.position_m - made.position_m).length() < 1e-8);
                prop_assert!((found.velocity_mps - made.velocity_mps).length() < 1e-8);
                prop_assert_eq!(found.movement, made.movement);
            }
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = encounters::parse(bytes.as_slice(), Path::new("e.csv"));
        let mut rows = HEADER.as_bytes().to_vec();
        rows.extend(bytes);
        let _ = encounters::parse(rows.as_slice(), Path::new("e.csv"));
    }

    #[test]
    fn rows_of_odd_fields_are_read_or_refused(text in "(([0-9.eE+-]{0,8}|NaN|inf),){8}[0-9-]{0,4}\n") {
        let _ = parse(&format!("{HEADER}{text}"));
    }
}

use super::*;
use alloc::vec::Vec;
use fga::Vec3;
use fga::situation::ProtectedVolume;
use proptest::prelude::*;

fn ownship(course_rad: f64) -> Ownship {
    Ownship {
        position_m: Vec3::new(5.0, -7.0, 100.0),
        course_rad,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 15.0,
    }
}

fn ball(ahead_m: f64, left_m: f64, up_m: f64, velocity: Vec3) -> Hazard {
    let position = Vec3::new(5.0 + ahead_m, -7.0 + left_m, 100.0 + up_m);
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    Hazard::exact(1, position, velocity, volume)
}

/// Table 7: neighbouring rows differ by 0.02 = 0.2 · 0.1 rad, columns by 0.015 = 0.5 · 0.03 rad.
#[test]
fn costs_are_those_of_table_7() {
    let grid = Grid {
        heading_range_rad: 2.4,
        climb_min_rad: -0.27,
        climb_max_rad: 0.27,
        ..Grid::default()
    };
    let cost = |k, j| {
        grid.table(&ownship(0.0), &[], 0.0)
            .find(|e| (e.heading_index, e.pitch_index) == (k, j))
            .unwrap()
            .cost
    };
    assert!((cost(5, 3) - cost(4, 3) - 0.02).abs() < 1e-12);
    assert!((cost(5, 3) - cost(5, 2) - 0.015).abs() < 1e-12);
    assert!((cost(-5, -3) - (0.2 * 0.5 + 0.5 * 0.09)).abs() < 1e-12);
    assert_eq!(cost(0, 0), 0.0);
}

#[test]
fn the_grid_holds_both_ends_the_middle_and_its_mirror_image() {
    let own = ownship(0.3);
    let table: Vec<GridEntry> = Grid::default().table(&own, &[], 0.0).collect();
    // 135°/0.1 rad = 23.6 → 24 steps a side; 15°/0.03 rad = 8.7 → 9.
    assert_eq!(table.len(), 49 * 19);
    let range = 135f64.to_radians();
    for change in [-range, 0.0, range] {
        assert!(
            table
                .iter()
                .any(|e| (e.heading_change_rad - change).abs() < 1e-12)
        );
    }
    for entry in &table {
        assert!(entry.heading_change_rad.abs() <= range + 1e-12);
        assert!(
            table
                .iter()
                .any(|e| e.heading_change_rad == -entry.heading_change_rad
                    && e.climb_rad == -entry.climb_rad
                    && e.cost == entry.cost)
        );
    }
}

#[test]
fn nothing_in_the_way_changes_nothing() {
    let Some(Choice::Clear(entry)) = select(&Grid::default(), &ownship(1.0), &[], 0.0) else {
        panic!()
    };
    assert_eq!((entry.cost, entry.mode()), (0.0, None));
}

/// A sphere of 30 m, 100 m ahead and 10 m to the left: its tangents stand at asin 0.2985 ± 5.71°,
/// so a heading turn to the right needs 11.66° (0.2035 rad): the third step of 0.098.
#[test]
fn a_heading_turn_is_the_least_that_clears() {
    let grid = Grid {
        mode: TurnMode::HeadingOnly,
        ..Grid::default()
    };
    let choice = select(
        &grid,
        &ownship(0.0),
        &[ball(100.0, 10.0, 0.0, Vec3::ZERO)],
        0.0,
    );
    let Some(Choice::Clear(entry)) = choice else {
        panic!("{choice:?}")
    };
    assert_eq!((entry.heading_index, entry.pitch_index), (-3, 0));
    // The tangent angle, found by hand: distance of (100, 10) from the line at −3 steps.
    let angle: f64 = -3.0 * 135f64.to_radians() / 24.0;
    let distance = 10.0 * angle.cos() - 100.0 * angle.sin();
    assert!((entry.margin_m - (distance - 30.0)).abs() < 1e-9);
}

#[test]
fn a_pitching_turn_takes_the_shorter_way() {
    let grid = Grid {
        mode: TurnMode::PitchOnly,
        ..Grid::default()
    };
    let obstacle = ball(200.0, 0.0, -10.0, Vec3::ZERO);
    let Some(Choice::Clear(entry)) = select(&grid, &ownship(0.0), &[obstacle], 0.0) else {
        panic!()
    };
    assert!(entry.climb_rad > 0.0 && entry.heading_index == 0);
    assert_eq!(entry.mode(), Some(TurnMode::PitchOnly));
}

#[test]
fn head_on_turns_right() {
    let grid = Grid {
        mode: TurnMode::HeadingOnly,
        ..Grid::default()
    };
    let choice = select(
        &grid,
        &ownship(0.0),
        &[ball(200.0, 0.0, 0.0, Vec3::ZERO)],
        0.0,
    );
    assert!(choice.unwrap().entry().heading_change_rad < 0.0);
}

/// Waiting moves both: after 4 s an obstacle at 20 m/s towards us is (15 + 20)·4 = 140 m nearer.
#[test]
fn a_later_start_sees_the_obstacles_where_they_are_then() {
    let now = ball(160.0, 4.0, 0.0, Vec3::new(-20.0, 0.0, 0.0));
    let later = ball(300.0, 4.0, 0.0, Vec3::new(-20.0, 0.0, 0.0));
    let one = select(&Grid::default(), &ownship(0.0), &[now], 0.0).unwrap();
    let other = select(&Grid::default(), &ownship(0.0), &[later], 4.0).unwrap();
    assert!((one.entry().margin_m - other.entry().margin_m).abs() < 1e-9);
    assert_eq!(one.entry().heading_index, other.entry().heading_index);
}

#[test]
fn a_fast_obstacle_that_no_direction_clears_gets_the_best_one() {
    // 60 m/s from behind at 60 m: the aircraft is hit whatever it does at once? Surround it.
    let ring: Vec<Hazard> = (0..12)
        .map(|i| {
            let turn = f64::from(i) * core::f64::consts::TAU / 12.0;
            let way = direction(turn, 0.0);
            ball(way.x * 50.0, way.y * 50.0, 0.0, way * -5.0)
        })
        .collect();
    let grid = Grid {
        mode: TurnMode::HeadingOnly,
        ..Grid::default()
    };
    let Some(Choice::Best(entry)) = select(&grid, &ownship(0.0), &ring, 0.0) else {
        panic!()
    };
    let most = grid
        .table(&ownship(0.0), &ring, 0.0)
        .map(|e| e.margin_m)
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(entry.margin_m >= most - 1e-9);
}

#[test]
fn inside_a_volume_the_quickest_way_out_is_taken() {
    // The centre is 20 m to the left: out to the right is 10 m, so 10/15 s.
    let choice = select(
        &Grid::default(),
        &ownship(0.0),
        &[ball(0.0, 20.0, 0.0, Vec3::ZERO)],
        0.0,
    );
    let Some(Choice::Best(entry)) = choice else {
        panic!("{choice:?}")
    };
    assert!(
        (entry.exit_s - 10.0 / 15.0).abs() < 0.01,
        "{}",
        entry.exit_s
    );
    assert!((entry.heading_change_rad + core::f64::consts::FRAC_PI_2).abs() < 0.06);
}

#[test]
fn wrong_input_is_refused() {
    let grid = Grid {
        heading_step_rad: f64::NAN,
        ..Grid::default()
    };
    assert_eq!(select(&grid, &ownship(0.0), &[], 0.0), None);
    assert_eq!(select(&Grid::default(), &ownship(f64::NAN), &[], 0.0), None);
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(select(&Grid::default(), &ownship(0.0), &[], bad), None);
    }
}

#[test]
fn a_tiny_step_does_not_take_forever() {
    let grid = Grid {
        heading_step_rad: 1e-300,
        mode: TurnMode::HeadingOnly,
        ..Grid::default()
    };
    assert_eq!(grid.table(&ownship(0.0), &[], 0.0).count(), 2001);
}

type Row = ((f64, f64, f64), (f64, f64, f64), f64);

fn rows() -> impl Strategy<Value = Vec<Row>> {
    let place = (-300.0..300.0f64, -300.0..300.0f64, -60.0..60.0f64);
    let motion = (-40.0..40.0f64, -40.0..40.0f64, -5.0..5.0f64);
    proptest::collection::vec((place, motion, 5.0..40.0f64), 1..4)
}

/// The obstacles, in a frame turned by `turn` and mirrored or not.
fn world(rows: &[Row], turn: f64, mirror: f64) -> Vec<Hazard> {
    let place = |(ahead, left, up): (f64, f64, f64)| {
        direction(turn, 0.0) * ahead
            + direction(turn + core::f64::consts::FRAC_PI_2, 0.0) * (left * mirror)
            + Vec3::Z * up
    };
    (0..)
        .zip(rows)
        .map(|(id, (p, v, radius_m))| {
            let volume = ProtectedVolume::Sphere {
                radius_m: *radius_m,
            };
            Hazard::exact(id, ownship(0.0).position_m + place(*p), place(*v), volume)
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// No entry of the table that clears is cheaper, and the margins agree with stepping in time.
    #[test]
    fn the_choice_is_the_cheapest_that_clears(rows in rows()) {
        let (grid, own) = (Grid::default(), ownship(0.7));
        let obstacles = world(&rows, 0.7, 1.0);
        let choice = select(&grid, &own, &obstacles, 0.0).unwrap();
        let least = grid.table(&own, &obstacles, 0.0).filter(|e| e.clears).map(|e| e.cost).fold(f64::INFINITY, f64::min);
        match choice {
            Choice::Clear(entry) => {
                prop_assert!((entry.cost - least).abs() < 1e-8);
                let velocity = direction(entry.course_rad, entry.climb_rad) * 15.0;
                for step in 0..400 {
                    let after = f64::from(step) * 0.1;
                    for obstacle in &obstacles {
                        let offset = own.position_m + velocity * after - obstacle.position_after_m(after);
                        prop_assert!(obstacle.volume.margin_m(offset) > -1e-6);
                    }
                }
            }
            Choice::Best(_) => prop_assert!(least.is_infinite()),
        }
    }

    #[test]
    fn turning_the_world_turns_the_choice(rows in rows(), turn in -3.0..3.0f64) {
        let plain = select(&Grid::default(), &ownship(0.0), &world(&rows, 0.0, 1.0), 0.0).unwrap();
        let turned = select(&Grid::default(), &ownship(turn), &world(&rows, turn, 1.0), 0.0).unwrap();
        prop_assert!((plain.entry().cost - turned.entry().cost).abs() < 1e-9);
        prop_assert!((plain.entry().margin_m - turned.entry().margin_m).abs() < 1e-6 || plain.entry().exit_s > 0.0);
    }

    #[test]
    fn mirroring_the_world_mirrors_the_choice(rows in rows()) {
        let plain = select(&Grid::default(), &ownship(0.0), &world(&rows, 0.0, 1.0), 0.0).unwrap();
        let mirrored = select(&Grid::default(), &ownship(0.0), &world(&rows, 0.0, -1.0), 0.0).unwrap();
        let (one, other) = (plain.entry(), mirrored.entry());
        prop_assert!((one.cost - other.cost).abs() < 1e-9);
        prop_assert!((one.heading_change_rad + other.heading_change_rad).abs() < 1e-9 || one.heading_index.abs() == other.heading_index.abs());
    }

    #[test]
    fn every_number_gives_numbers_or_none(p: [f64; 3], v: [f64; 3], q: [f64; 3], radius_m: f64, speed: f64, course: f64, start: f64) {
        let own = Ownship { position_m: Vec3::from_array(q), course_rad: course, airspeed_mps: speed, ..ownship(0.0) };
        let obstacle = Hazard::exact(1, Vec3::from_array(p), Vec3::from_array(v), ProtectedVolume::Sphere { radius_m });
        if let Some(choice) = select(&Grid::default(), &own, &[obstacle], start) {
            let entry = choice.entry();
            prop_assert!(entry.course_rad.is_finite() && entry.climb_rad.is_finite() && entry.cost.is_finite());
            prop_assert!(!entry.margin_m.is_nan());
        }
    }
}

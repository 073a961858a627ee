//! Algorithms 2 and 3, Table 7.

use crate::{ball, flown_separation, ownship};
use fga::Vec3;
use fga_paper::conflict::Relative;
use fga_paper::dubins::ClimbLimits;
use fga_paper::grid::{Choice, Grid, TurnMode, select};
use fga_paper::paths::RoundObstacle;
use fga_paper::printed::{self, LiteralGrid};
use fga_paper::waypoint::{Reach, next_waypoint};

/// The printed grid never turns left (positive): it ends at 0 and leaves out its other end, too.
#[test]
fn the_grid_reaches_both_sides() {
    let own = ownship();
    let printed = LiteralGrid::default();
    let range = printed.heading_range_rad;
    assert!(
        printed
            .table(&own, &[])
            .all(|e| e.course_rad <= 1e-12 && e.course_rad > -range)
    );
    let grid = Grid::default();
    let changes = || grid.table(&own, &[], 0.0).map(|e| e.heading_change_rad);
    for wanted in [-range, 0.0, range] {
        assert!(changes().any(|change| (change - wanted).abs() < 1e-12));
    }
    // An obstacle on the right side: the way out is to the left, 20 m against 40 m.
    let right = ball(100.0, -10.0, Vec3::ZERO);
    let flat = Grid {
        mode: TurnMode::HeadingOnly,
        ..grid
    };
    let choice = select(&flat, &own, &[right], 0.0).unwrap();
    assert!(choice.entry().heading_change_rad > 0.0);
    assert!(
        printed::select(&printed, &own, &[right])
            .unwrap()
            .course_rad
            < 0.0
    );
}

/// Line 18 gives a speed: at 15 m/s at most 15, so nothing ever reaches 30, and the choice is always the
/// corner of the grid.
#[test]
fn a_separation_is_a_distance() {
    let own = ownship();
    let far_aside = Vec3::new(100.0, 2000.0, 0.0);
    assert!(printed::separation(own.velocity_mps(), far_aside) < 30.0);
    let obstacle = ball(100.0, 2000.0, Vec3::ZERO);
    let printed = printed::select(&LiteralGrid::default(), &own, &[obstacle]).unwrap();
    assert!(!printed.marked && printed.course_rad < -2.0 && printed.climb_rad < -0.2);
    // By hand: straight on it is passed at 2,000 m.
    let Some(Choice::Clear(entry)) = select(&Grid::default(), &own, &[obstacle], 0.0) else {
        panic!()
    };
    assert_eq!(entry.cost, 0.0);
    assert!((entry.margin_m - 1970.0).abs() < 1e-9);
}

/// An intruder from the right on a collision course, although the line to it is far off the course.
#[test]
fn a_separation_counts_the_motion_of_the_obstacle() {
    let own = ownship();
    let crossing = ball(150.0, -200.0, Vec3::Y * 20.0);
    // With a speed of 60 m/s the printed value is 48, "clear" of 30; flown, both meet after 10 s.
    let printed = printed::separation(Vec3::X * 60.0, crossing.position_m);
    assert!(printed > 30.0);
    let straight = flown_separation(
        15.0,
        30.0,
        0.0,
        0.0,
        (crossing.position_m, crossing.velocity_mps),
        15.0,
    );
    assert!(straight < 0.1);
    let held = Grid::default()
        .table(&own, &[crossing], 0.0)
        .find(|e| e.cost == 0.0)
        .unwrap();
    assert!((held.margin_m + 30.0).abs() < 1e-6);
}

/// Table 7's own numbers: along a row the cost falls by 0.015 from `θ_1` to `θ_2` and rises by 0.045
/// from `θ_j` to `θ_n`; down a column it falls by 0.02 and ends above its begin. A cost that is linear in
/// the signed deviation can only do one of both.
#[test]
fn deviations_cost_without_their_sign() {
    let first_row = [0.4137_f64, 0.3987, 0.1863, 0.2313];
    let first_column = [0.4137_f64, 0.3937, 0.3737, 0.4337];
    assert!(first_row[1] < first_row[0] && first_row[3] > first_row[2]);
    assert!(first_column[2] < first_column[0] && first_column[3] > first_column[0]);
    let own = ownship();
    let printed = LiteralGrid::default();
    let cheapest = |k: usize| printed.table(&own, &[]).nth(k).unwrap().cost;
    assert!(cheapest(0) < 0.0);
    // Signed, the hardest turn is the cheapest; absolute, no turn is.
    let chosen = printed::select(&printed, &own, &[]).unwrap();
    assert!(chosen.course_rad < -2.0);
    assert_eq!(
        select(&Grid::default(), &own, &[], 0.0)
            .unwrap()
            .entry()
            .cost,
        0.0
    );
}

/// Head-on at 60 m, ρ = d = 30 m: Alg. 2 takes the first grid course beyond 30°. Flown at once it
/// would be clear; with its real turn it is not. The manoeuvre that counts the turn (α =
/// 60°) is clear from 52 m on.
#[test]
fn a_turn_takes_its_time() {
    let own = ownship();
    let obstacle = ball(60.0, 0.0, Vec3::ZERO);
    let grid = Grid {
        mode: TurnMode::HeadingOnly,
        ..Grid::default()
    };
    let Some(Choice::Clear(entry)) = select(&grid, &own, &[obstacle], 0.0) else {
        panic!()
    };
    let target = (obstacle.position_m, Vec3::ZERO);
    let flown = |turn, start| flown_separation(15.0, 30.0, turn, start, target, 12.0);
    assert!(flown(entry.heading_change_rad, 0.0) < 28.5);
    let round = RoundObstacle::new(30.0, 30.0, 0.0).unwrap();
    let start_s = (60.0 - round.before_m) / 15.0;
    assert!(flown(round.away.angle_rad, start_s) > 30.0 - 0.02);
}

/// Every waypoint but one exactly behind passes `θ_w` < π, also one inside the turning circle that
/// takes a full loop, and one in the middle of a volume.
#[test]
fn the_next_waypoint_is_ahead_and_can_be_flown_to() {
    let own = ownship();
    let bias = |w: Vec3| {
        Relative::new(w, own.velocity_mps())
            .unwrap()
            .bias_rad()
            .unwrap()
    };
    let (beside, covered, good) = (
        Vec3::new(5.0, 20.0, 0.0),
        Vec3::new(150.0, 20.0, 0.0),
        Vec3::new(400.0, 20.0, 0.0),
    );
    let almost_behind = Vec3::new(-100.0, 1e-6, 0.0);
    for waypoint in [almost_behind, beside, covered, good] {
        assert!(printed::waypoint_accepted(bias(waypoint)));
    }
    let reach = Reach {
        turn_radius_m: 30.0,
        climb: ClimbLimits::LEVEL,
        altitude_tolerance_m: 1.0,
        margin_m: 0.0,
    };
    let obstacles = [
        ball(150.0, 60.0, Vec3::ZERO),
        ball(150.0, 20.0, Vec3::Z * 0.1),
    ];
    // Without the second volume the waypoint at 150 m counts; with it, it may not be chosen.
    let route = [almost_behind, beside, covered, good];
    let free = next_waypoint(&reach, &own, &route, &obstacles[..1]).unwrap();
    assert_eq!(free.index, 2);
    let next = next_waypoint(&reach, &own, &route, &obstacles);
    assert!(next.is_none_or(|n| ![1, 2].contains(&n.index)));
}

/// "Always true" is not quite so: straight behind the angle is π, and not below.
#[test]
fn a_waypoint_straight_behind_is_the_one_that_alg_3_refuses() {
    let behind = Relative::new(Vec3::X * -100.0, Vec3::X * 15.0).unwrap();
    assert_eq!(behind.bias_rad(), Some(core::f64::consts::PI));
    assert!(!printed::waypoint_accepted(behind.bias_rad().unwrap()));
}

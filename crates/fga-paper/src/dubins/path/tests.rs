use super::*;
use crate::dubins::Clearance;
use core::f64::consts::{FRAC_PI_2, PI};
use fga::certificate::Hazard;
use fga::situation::ProtectedVolume;
use proptest::prelude::*;

fn pose(x: f64, y: f64, z: f64, course_rad: f64) -> Pose {
    Pose {
        position_m: Vec3::new(x, y, z),
        course_rad,
    }
}

fn level(start: Pose, end: Pose, radius_m: f64) -> DubinsPath {
    DubinsPath::shortest(start, end, radius_m, ClimbLimits::LEVEL).unwrap()
}

#[test]
fn straight_ahead_is_straight() {
    for course in [0.0, 1.0, -2.5, PI] {
        let end = fga::angle::direction(course, 0.0) * 250.0;
        let path = level(
            pose(0.0, 0.0, 0.0, course),
            pose(end.x, end.y, 0.0, course),
            30.0,
        );
        assert!((path.length_m() - 250.0).abs() < 1e-6, "{course}");
    }
}

/// Half a circle to the left: π ρ. Beside and back: π ρ and a straight piece.
#[test]
fn lengths_by_hand() {
    let u_turn = level(pose(0.0, 0.0, 0.0, 0.0), pose(0.0, 60.0, 0.0, PI), 30.0);
    assert!((u_turn.length_m() - PI * 30.0).abs() < 1e-6);
    assert_eq!(u_turn.segments()[0].kind, SegmentKind::Turn(Side::Left));
    let wide = level(pose(0.0, 0.0, 0.0, 0.0), pose(0.0, -100.0, 0.0, PI), 30.0);
    assert!((wide.length_m() - (PI * 30.0 + 40.0)).abs() < 1e-6);
    assert_eq!(wide.segments()[0].kind, SegmentKind::Turn(Side::Right));
}

/// Back to the same place with the opposite course: three arcs, 7π/3 ρ.
#[test]
fn turning_on_the_spot_takes_three_arcs() {
    let path = level(pose(0.0, 0.0, 0.0, 0.0), pose(0.0, 0.0, 0.0, PI), 30.0);
    assert!((path.length_m() - 7.0 * PI / 3.0 * 30.0).abs() < 1e-6);
}

#[test]
fn a_gentle_climb_goes_along_the_path() {
    let climb = ClimbLimits {
        min_rad: -0.2,
        max_rad: 0.2,
        may_circle: false,
    };
    let path = DubinsPath::shortest(
        pose(0.0, 0.0, 10.0, 0.0),
        pose(300.0, 0.0, 40.0, 0.0),
        30.0,
        climb,
    )
    .unwrap();
    assert!((path.climb_rad() - f64::atan(0.1)).abs() < 1e-9);
    assert_eq!(path.short_by_m(), 0.0);
    assert!((path.sample(150.0).position_m.z - 25.0).abs() < 1e-6);
    // 3-D length over speed.
    assert!((path.duration_s(15.0) - libm::hypot(300.0, 30.0) / 15.0).abs() < 1e-9);
}

#[test]
fn a_steep_climb_is_cut_or_circled() {
    let mut climb = ClimbLimits {
        min_rad: -0.2,
        max_rad: 0.2,
        may_circle: false,
    };
    let (start, end) = (pose(0.0, 0.0, 0.0, 0.0), pose(300.0, 0.0, -200.0, 0.0));
    let cut = DubinsPath::shortest(start, end, 30.0, climb).unwrap();
    assert_eq!(cut.climb_rad(), -0.2);
    assert!((cut.short_by_m() + 200.0 - 300.0 * f64::tan(0.2)).abs() < 1e-6);
    climb.may_circle = true;
    let circled = DubinsPath::shortest(start, end, 30.0, climb).unwrap();
    assert_eq!(circled.short_by_m(), 0.0);
    assert!(circled.end().position_m.distance(end.position_m) < 1e-6);
    // 200/tan 0.2 = 986.6 m of path: 686.6 more, four circles of 188.5 m.
    assert!((circled.length_m() - (300.0 + 4.0 * TAU * 30.0)).abs() < 1e-6);
    let never = DubinsPath::shortest(start, end, 30.0, ClimbLimits::LEVEL).unwrap();
    assert_eq!((never.climb_rad(), never.short_by_m()), (0.0, -200.0));
}

#[test]
fn wrong_input_is_refused() {
    let good = pose(0.0, 0.0, 0.0, 0.0);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(
            DubinsPath::shortest(pose(bad, 0.0, 0.0, 0.0), good, 30.0, ClimbLimits::LEVEL)
                .is_none()
        );
        assert!(
            DubinsPath::shortest(good, pose(0.0, 0.0, bad, 0.0), 30.0, ClimbLimits::LEVEL)
                .is_none()
        );
        assert!(DubinsPath::shortest(good, good, bad, ClimbLimits::LEVEL).is_none());
    }
    assert!(
        DubinsPath::shortest(
            good,
            pose(0.0, 0.0, 0.0, f64::NAN),
            30.0,
            ClimbLimits::LEVEL
        )
        .is_none()
    );
    for radius in [0.0, -1.0] {
        assert!(DubinsPath::shortest(good, good, radius, ClimbLimits::LEVEL).is_none());
    }
    let steep = ClimbLimits {
        max_rad: 2.0,
        ..ClimbLimits::LEVEL
    };
    assert!(DubinsPath::shortest(good, good, 30.0, steep).is_none());
}

#[test]
fn clearance_is_certified() {
    let path = level(pose(0.0, 0.0, 0.0, 0.0), pose(300.0, 0.0, 0.0, 0.0), 30.0);
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let at = |y: f64, vy: f64| {
        let velocity = Vec3::new(0.0, vy, 0.0);
        Hazard::exact(1, Vec3::new(150.0, y, 0.0), velocity, volume)
    };
    let Clearance::Clear { least_margin_m } = path.clearance(15.0, &[at(40.0, 0.0)], 0.0) else {
        panic!()
    };
    assert!((5.0..=10.0).contains(&least_margin_m));
    assert!(path.clearance(15.0, &[at(40.0, 0.0)], 9.9).is_clear());
    assert!(!path.clearance(15.0, &[at(40.0, 0.0)], 10.0).is_clear());
    // Crosses the path's middle when the aircraft is there, after ten seconds.
    let crossing = path.clearance(15.0, &[at(200.0, -20.0)], 0.0);
    let Clearance::Violated { at_s, margin_m } = crossing else {
        panic!()
    };
    // The distance 250 m shrinks by 25 m/s: 30 m are left after 8.8 s.
    assert!((at_s - 8.8).abs() < 0.02 && margin_m.abs() < 0.02);
    assert_eq!(
        path.clearance(15.0, &[at(f64::NAN, 0.0)], 0.0),
        Clearance::Undecided
    );
    assert_eq!(path.clearance(0.0, &[], 0.0), Clearance::Undecided);
    assert!(path.clearance(15.0, &[], 0.0).is_clear());
}

fn poses() -> impl Strategy<Value = (Pose, Pose)> {
    let one = || {
        (
            -200.0..200.0f64,
            -200.0..200.0f64,
            -50.0..50.0f64,
            -7.0..7.0f64,
        )
            .prop_map(|(x, y, z, course)| pose(x, y, z, course))
    };
    (one(), one())
}

proptest! {
    /// Poses on one arc or one straight line, where rounding could add a full circle.
    #[test]
    fn rounding_adds_no_circle(course in -7.0..7.0f64, length in 1.0..2000.0f64, turn in -3.0..3.0f64, radius in 5.0..80.0f64) {
        let way = fga::angle::direction(course, 0.0) * length;
        let straight = DubinsPath::all(pose(0.0, 0.0, 0.0, course), pose(way.x, way.y, 0.0, course), radius, ClimbLimits::LEVEL);
        let same_side = [[LEFT, STRAIGHT, LEFT], [RIGHT, STRAIGHT, RIGHT]];
        for path in straight.into_iter().flatten() {
            if same_side.contains(&[path.segments[0].kind, path.segments[1].kind, path.segments[2].kind]) {
                prop_assert!((path.length_m() - length).abs() < 1e-5 * (radius + length));
            }
        }
        let signed = radius * turn.signum();
        let arc_end = pose(
            signed * (f64::sin(course + turn) - f64::sin(course)),
            signed * (f64::cos(course) - f64::cos(course + turn)),
            0.0,
            course + turn,
        );
        let arc = level(pose(0.0, 0.0, 0.0, course), arc_end, radius);
        prop_assert!(arc.length_m() <= radius * turn.abs() + 1e-4 * radius, "{} {}", arc.length_m(), radius * turn.abs());
    }

    #[test]
    fn every_path_arrives_and_is_continuous((start, end) in poses(), radius in 5.0..80.0f64) {
        let climb = ClimbLimits { min_rad: -0.3, max_rad: 0.3, may_circle: true };
        let paths = DubinsPath::all(start, end, radius, climb);
        prop_assert!(paths[0].is_some());
        for path in paths.into_iter().flatten() {
            prop_assert!(path.end().position_m.distance(end.position_m) < 1e-3);
            prop_assert!(wrap_pi(path.end().course_rad - end.course_rad).abs() < 1e-5);
            prop_assert!(path.length_m() >= paths[0].unwrap().length_m());
            // Chords of a path sampled each metre: never longer than the arc, never bent more.
            let step = 1.0;
            for at in (0..10_000).map(f64::from).take_while(|at| at + step <= path.length_m()) {
                let (a, b) = (path.sample(at), path.sample(at + step));
                let moved = b.position_m - a.position_m;
                prop_assert!(libm::hypot(moved.x, moved.y) <= step + 1e-9);
                prop_assert!((b.course_rad - a.course_rad).abs() <= step / radius + 1e-9);
                let chord = fga::angle::course_of(moved);
                prop_assert!(wrap_pi(chord - f64::midpoint(a.course_rad, b.course_rad)).abs() < step / radius + 1e-6);
            }
        }
    }

    /// Never shorter than the straight line, never longer than two full turns about it.
    #[test]
    fn lengths_are_bounded((start, end) in poses(), radius in 5.0..80.0f64) {
        let path = level(start, end, radius);
        let offset = end.position_m - start.position_m;
        let direct = libm::hypot(offset.x, offset.y);
        prop_assert!(path.length_m() >= direct - 1e-6);
        prop_assert!(path.length_m() <= direct + 2.0 * TAU * radius + 4.0 * radius);
    }

    #[test]
    fn reversed_mirrored_and_scaled_paths_are_as_long((start, end) in poses(), radius in 5.0..80.0f64, scale in 0.2..5.0f64) {
        let length = level(start, end, radius).length_m();
        let back = |p: Pose| Pose { course_rad: p.course_rad + PI, ..p };
        let mirror = |p: Pose| pose(p.position_m.x, -p.position_m.y, p.position_m.z, -p.course_rad);
        let scaled = |p: Pose| Pose { position_m: p.position_m * scale, ..p };
        let quarter = |p: Pose| pose(-p.position_m.y, p.position_m.x, 0.0, p.course_rad + FRAC_PI_2);
        let close = |other: f64| (other - length).abs() < 1e-5 * (1.0 + length);
        prop_assert!(close(level(back(end), back(start), radius).length_m()));
        prop_assert!(close(level(mirror(start), mirror(end), radius).length_m()));
        prop_assert!(close(level(quarter(start), quarter(end), radius).length_m()));
        prop_assert!(close(level(scaled(start), scaled(end), radius * scale).length_m() / scale));
    }

    #[test]
    fn every_number_gives_numbers_or_none(p: [f64; 3], q: [f64; 3], a: f64, b: f64, radius: f64, at: f64) {
        let start = Pose { position_m: Vec3::from_array(p), course_rad: a };
        let end = Pose { position_m: Vec3::from_array(q), course_rad: b };
        if let Some(path) = DubinsPath::shortest(start, end, radius, ClimbLimits::LEVEL) {
            prop_assert!(path.length_m().is_finite());
            prop_assert!(path.sample(at).position_m.is_finite());
        }
    }

    /// Stepping finely through a clear path finds nothing nearer than the wanted margin.
    #[test]
    fn a_clear_path_is_clear(
        (start, end) in poses(),
        rows in proptest::collection::vec((-200.0..200.0f64, -200.0..200.0f64, -15.0..15.0f64, -15.0..15.0f64), 1..4),
    ) {
        let path = level(start, end, 30.0);
        let volume = ProtectedVolume::Cylinder { radius_m: 25.0, half_height_m: 60.0 };
        let obstacles: alloc::vec::Vec<Hazard> = (0..).zip(&rows).map(|(id, (x, y, vx, vy))| {
            Hazard::exact(id, Vec3::new(*x, *y, 0.0), Vec3::new(*vx, *vy, 0.0), volume)
        }).collect();
        let least = (0..=5000).map(|i| {
            let at = path.duration_s(15.0) * f64::from(i) / 5000.0;
            let position = path.sample(15.0 * at).position_m;
            obstacles.iter().map(|o| o.volume.margin_m(position - o.position_after_m(at))).fold(f64::INFINITY, f64::min)
        }).fold(f64::INFINITY, f64::min);
        match path.clearance(15.0, &obstacles, 1.0) {
            Clearance::Clear { least_margin_m } => prop_assert!(least >= least_margin_m && least >= 1.0),
            Clearance::Violated { .. } => prop_assert!(least < 1.5),
            Clearance::Undecided => prop_assert!(false),
        }
    }
}

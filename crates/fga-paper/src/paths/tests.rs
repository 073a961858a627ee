use super::*;
use crate::turn::turned;
use alloc::vec::Vec;
use fga::Vec3;
use fga::search::Side;
use fga::situation::Ownship;
use fga::vehicle::Vehicle;
use proptest::prelude::*;

/// Flies the three arcs from (−before, s), the obstacle at the origin, in fine steps.
fn flown(round: &RoundObstacle, across_m: f64) -> Vec<Vec3> {
    let mut ownship = Ownship {
        position_m: Vec3::new(-round.before_m, across_m, 0.0),
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 1.0,
    };
    let mut points = Vec::new();
    for (arc, sign) in [(round.away, 1.0), (round.around, -1.0), (round.back, 1.0)] {
        for i in 0..=4000 {
            let at = arc.length_m() * f64::from(i) / 4000.0;
            points.push(turned(&ownship, sign / arc.radius_m, at).position_m);
        }
        ownship = turned(&ownship, sign / arc.radius_m, arc.length_m());
    }
    assert!(ownship.course_rad.abs() < 1e-9);
    points
}

/// ρ = d = 30, s = 0: cos α = 1/2, α = 60°; before = 60 sin 60° = 51.96 m.
#[test]
fn head_on_by_hand() {
    let round = RoundObstacle::new(30.0, 30.0, 0.0).unwrap();
    assert!((round.away.angle_rad.to_degrees() - 60.0).abs() < 1e-9);
    assert!((round.before_m - 51.961_524).abs() < 1e-6);
    assert!((round.length_m() - 4.0 * core::f64::consts::PI * 10.0).abs() < 1e-9);
    assert!((round.widest_m - 30.0).abs() < 1e-9);
    assert!((round.before_m - round.after_m).abs() < 1e-9);
}

/// First seen at 300 m head-on, ρ = d = 30 m: `L_3` = 301.5 m from U; the late start flies
/// 248.0 m straight and then `L_1` = 62.8 m, 310.9 m in all. So `L_1` < `L_3` says nothing about
/// the whole path: there the late start is the longer one (§3.4.3, Fig. 9).
#[test]
fn the_late_start_is_the_longer_path() {
    let late = 300.0 - RoundObstacle::new(30.0, 30.0, 0.0).unwrap().before_m
        + length_1_m(30.0, 30.0, 0.0).unwrap();
    let early = length_3_m(30.0, 30.0, 0.0, 300.0).unwrap();
    assert!(
        (late - 310.87).abs() < 0.01 && (early - 301.51).abs() < 0.01,
        "{late} {early}"
    );
    assert!(length_1_m(30.0, 30.0, 0.0).unwrap() < early);
}

/// A Dubins path onto the point abeam with the initial course, found by another solver, is `L_3`
/// where ρ = d.
#[test]
fn length_3_agrees_with_a_dubins_path() {
    use dubins_paths::f64::DubinsPath;
    for (radius, across, along) in [(30.0, 0.0, 300.0), (30.0, 12.0, 150.0), (80.0, 50.0, 400.0)] {
        let path = DubinsPath::shortest_from(
            [-along, across, 0.0].into(),
            [0.0, radius, 0.0].into(),
            radius,
        )
        .unwrap();
        let ours = length_3_m(radius, radius, across, along).unwrap();
        assert!(
            (path.length() - ours).abs() < 1e-6,
            "{} {ours}",
            path.length()
        );
    }
    // With ρ = 60 > d = 30 the last arc is that of ρ: again a Dubins path.
    let path = DubinsPath::shortest_from([-300.0, 5.0, 0.0].into(), [0.0, 30.0, 0.0].into(), 60.0);
    let ours = length_3_m(60.0, 30.0, 5.0, 300.0).unwrap();
    assert!((path.unwrap().length() - ours).abs() < 1e-6);
}

#[test]
fn the_bound_of_k_2_is_where_the_bounds_meet() {
    for k_1 in [0.2, 1.0, 3.0] {
        let k_2 = least_detection_ratio(k_1).unwrap();
        let (d, early) = (25.0, |k: f64| length_3_bound_m(k * 25.0, 25.0).unwrap());
        let late = length_1_bound_m(k_1 * d, d).unwrap();
        assert!((early(k_2) - late).abs() < 1e-9);
        assert!(early(k_2 * 1.01) > late && early(k_2 * 0.99) < late);
    }
    assert_eq!(least_detection_ratio(f64::NAN), None);
    assert_eq!(least_detection_ratio(0.0), None);
}

#[test]
fn a_gentle_turn_from_afar_passes_at_the_wanted_distance() {
    let encounter = Geometry {
        along_m: 300.0,
        across_m: 0.0,
        closing_mps: 15.0,
        radius_m: 60.0,
    };
    // (300² − 60²) / 120 = 720 m.
    let radius = turn_radius_for_separation_m(&encounter, 30.0).unwrap();
    assert!((radius - 720.0).abs() < 1e-9);
    assert_eq!(turn_radius_for_separation_m(&encounter, 721.0), None);
    assert_eq!(turn_radius_for_separation_m(&encounter, f64::NAN), None);
}

#[test]
fn wrong_input_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        assert!(RoundObstacle::new(bad, 30.0, 0.0).is_none());
        assert!(RoundObstacle::new(30.0, bad, 0.0).is_none());
        assert!(length_3_m(30.0, 30.0, 0.0, bad).is_none());
        assert!(length_3_bound_m(bad, 30.0).is_none());
        assert!(length_1_bound_m(bad, 30.0).is_none());
    }
    assert!(RoundObstacle::new(30.0, 30.0, 30.0).is_none());
    assert!(length_2_m(30.0, 30.0, -1.0).is_none());
    assert!(length_3_m(30.0, 30.0, 0.0, 40.0).is_none());
    let round = RoundObstacle::new(30.0, 30.0, 0.0).unwrap();
    assert!(
        round
            .maneuver(0.0, f64::NAN, 0.0, Side::Left, (15.0, 30.0))
            .is_none()
    );
    assert!(
        round
            .maneuver(-1.0, 0.0, 0.0, Side::Left, (15.0, 30.0))
            .is_none()
    );
}

#[test]
fn its_stages_turn_away_round_and_back() {
    let round = RoundObstacle::new(30.0, 60.0, 10.0).unwrap();
    let vehicle = Vehicle::table_4();
    let limits = (vehicle.airspeed_mps, vehicle.turn_radius_m);
    let maneuver = round.maneuver(2.0, 1.0, 0.0, Side::Right, limits).unwrap();
    let [away, around, back] = maneuver.stages() else {
        panic!()
    };
    assert_eq!((away.start_s, back.course_rad), (2.0, 1.0));
    assert!(away.course_rad < 1.0 && around.course_rad > 1.0);
    assert_eq!((away.rate_share, around.rate_share), (1.0, 0.5));
    assert!((around.start_s - 2.0 - round.away.length_m() / 15.0).abs() < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The flown arcs touch the protected circle, never enter it, and end on the initial line.
    #[test]
    fn the_manoeuvre_touches_and_returns(rho in 5.0..200.0f64, d in 5.0..200.0f64, share in 0.0..0.98f64) {
        let s = share * d;
        let round = RoundObstacle::new(rho, d, s).unwrap();
        let points = flown(&round, s);
        let least = points.iter().map(|p| p.length()).fold(f64::INFINITY, f64::min);
        prop_assert!((least - d).abs() < 1e-3 * d, "{least} {d}");
        let end = points.last().unwrap();
        prop_assert!(end.distance(Vec3::new(round.after_m, s, 0.0)) < 1e-6);
        let widest = points.iter().map(|p| p.y - s).fold(0.0, f64::max);
        prop_assert!((widest - round.widest_m).abs() < 1e-3 * (1.0 + widest));
        // The path up to abeam, added up chord by chord.
        let mut length = 0.0;
        for pair in points.windows(2) {
            if pair[1].x > 0.0 { break; }
            length += pair[0].distance(pair[1]);
        }
        prop_assert!((length - round.to_abeam_m).abs() < 1e-3 * (rho + d));
        prop_assert!(round.extra_path_m() > 0.0);
    }

    /// §3.4.3: `L_2` > `L_1` in both cases, and d tan α_1 ≥ ρ tan α_2 in the second.
    #[test]
    fn following_the_obstacle_is_shorter_than_the_tangent(rho in 5.0..200.0f64, d in 5.0..200.0f64, share in 0.0..0.98f64) {
        let one = length_1_m(rho, d, share * d).unwrap();
        let two = length_2_m(rho, d, share * d).unwrap();
        prop_assert!(two > one);
        if rho > d {
            let alpha_1 = deviation_rad(rho, d, share * d).unwrap();
            let alpha_2 = one / rho - alpha_1;
            prop_assert!(alpha_1 < core::f64::consts::FRAC_PI_3);
            prop_assert!(alpha_2 > 0.0 && alpha_2 < alpha_1);
            prop_assert!(d * f64::tan(alpha_1) >= rho * f64::tan(alpha_2) * (1.0 - 1e-12));
        }
    }

    /// A turn of the chosen radius, flown in fine steps, passes at exactly `d_m`.
    #[test]
    fn the_chosen_radius_passes_at_the_wanted_distance(along in 100.0..500.0f64, d in 10.0..90.0f64, share in 0.0..0.95f64) {
        let encounter = Geometry { along_m: along, across_m: share * d, closing_mps: 15.0, radius_m: d };
        let radius = turn_radius_for_separation_m(&encounter, 1.0).unwrap();
        let start = Ownship { position_m: Vec3::new(-along, share * d, 0.0), course_rad: 0.0, climb_rad: 0.0, bank_rad: 0.0, airspeed_mps: 1.0 };
        let arc = (1.6 * radius).min(2.0 * along);
        let least = (0..20_000)
            .map(|i| turned(&start, 1.0 / radius, arc * f64::from(i) / 20_000.0).position_m.length())
            .fold(f64::INFINITY, f64::min);
        prop_assert!((least - d).abs() < 1e-2, "{least} {d}");
    }

    #[test]
    fn scaling_the_world_scales_the_lengths(rho in 5.0..200.0f64, d in 5.0..200.0f64, share in 0.0..0.98f64, k in 0.1..10.0f64) {
        let one = RoundObstacle::new(rho, d, share * d).unwrap().length_m() * k;
        let other = RoundObstacle::new(rho * k, d * k, share * d * k).unwrap().length_m();
        prop_assert!((one - other).abs() < 1e-6 * (1.0 + one));
    }

    #[test]
    fn every_number_gives_numbers_or_none(a: f64, b: f64, c: f64, e: f64) {
        if let Some(round) = RoundObstacle::new(a, b, c) {
            prop_assert!(round.length_m().is_finite() && round.extra_path_m().is_finite());
        }
        for value in [length_1_m(a, b, c), length_2_m(a, b, c), length_3_m(a, b, c, e), length_3_bound_m(a, b), length_1_bound_m(a, b), least_detection_ratio(a)].into_iter().flatten() {
            prop_assert!(value.is_finite());
        }
    }
}

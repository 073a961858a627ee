//! The oracle against geometry, against a flight integrated by other means, and against itself
//! mirrored.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_campaign::encounters::{EncounterSource, Random, Range};
use fga_campaign::oracle::{
    AVOIDABLE_MARGIN_M, OracleAnswer, OracleFlight, OracleManeuver, OracleObstacle, OracleSettings,
    OracleStart, OracleVehicle, Stages, best_margin, least_departure,
};

const HORIZON_S: f64 = 60.0;

fn search(vehicle: &OracleVehicle, obstacles: &[OracleObstacle], stages: Stages) -> OracleAnswer {
    let settings = OracleSettings {
        stages,
        ..OracleSettings::default()
    };
    best_margin(&OracleStart::ORIGIN, vehicle, obstacles, &settings)
}

fn cell(name: &str, number: u64) -> Vec<OracleObstacle> {
    EncounterSource::parse(name, 7)
        .unwrap()
        .encounter(number)
        .unwrap()
        .obstacles
        .iter()
        .map(OracleObstacle::from)
        .collect()
}

/// The margin of a manoeuvre by small Euler-midpoint steps of Eq. 10–12, with the response from its
/// definition and its own distances to the volumes.
fn sampled_margin(
    start: &OracleStart,
    vehicle: &OracleVehicle,
    maneuver: &OracleManeuver,
    obstacles: &[OracleObstacle],
) -> f64 {
    const STEPS: u32 = 240_000;
    let h = HORIZON_S / f64::from(STEPS);
    let (mut position, mut course, mut climb, mut bank) = (
        start.position_m,
        start.course_rad,
        start.climb_rad,
        start.bank_rad,
    );
    let t1 = vehicle.dead_time_s + maneuver.wait_s;
    let t2 = t1 + maneuver.turn1_rad.abs() / vehicle.course_rate_radps;
    let t3 = t2 + maneuver.straight_s;
    let t4 = t3 + maneuver.turn2_rad.abs() / vehicle.course_rate_radps;
    let mut least = f64::INFINITY;
    for step in 0..=STEPS {
        let t = f64::from(step) * h;
        for o in obstacles {
            let r = position - o.position_m - o.velocity_mps * t;
            let margin = match o.volume {
                ProtectedVolume::Sphere { radius_m } => r.length() - radius_m,
                ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m,
                } => {
                    let (wall, face) = (r.x.hypot(r.y) - radius_m, r.z.abs() - half_height_m);
                    wall.max(0.0).hypot(face.max(0.0)) + wall.max(face).min(0.0)
                }
            };
            least = least.min(margin);
        }
        // The share of the step with the turn on.
        let on = |from: f64, to: f64| ((t + h).min(to) - t.max(from)).max(0.0) / h;
        let command = on(t1, t2) * sign(maneuver.turn1_rad) + on(t3, t4) * sign(maneuver.turn2_rad);
        let rate = if vehicle.bank_time_constant_s > 0.0 {
            let before = bank;
            if t >= vehicle.dead_time_s {
                bank += h * (command * vehicle.bank_max_rad - bank) / vehicle.bank_time_constant_s;
            }
            vehicle.turn_rate_factor * 9.806_65 * (0.5 * (before + bank)).tan()
                / vehicle.airspeed_mps
        } else {
            command * vehicle.course_rate_radps
        };
        let target = if t + 0.5 * h < t1 {
            start.climb_rad
        } else if t + 0.5 * h < t3 {
            maneuver.climb1_rad
        } else {
            maneuver.climb2_rad
        };
        let most = vehicle.climb_rate_radps * h;
        let climb_step = (target - climb).clamp(-most, most);
        let (psi, theta) = (course + 0.5 * h * rate, climb + 0.5 * climb_step);
        position += Vec3::new(
            theta.cos() * psi.cos(),
            theta.cos() * psi.sin(),
            theta.sin(),
        ) * (vehicle.airspeed_mps * h);
        course += h * rate;
        climb += climb_step;
    }
    least
}

fn sign(turn: f64) -> f64 {
    if turn == 0.0 { 0.0 } else { turn.signum() }
}

#[test]
fn a_sphere_dead_ahead_is_passed_by_the_turning_circle() {
    // Turning at once on the circle of radius ρ = 30 m about (0, 30), the aircraft comes as close
    // as √(r² + ρ²) − ρ to the centre: margin 0 at r = √(60² − 30²) = 51.96 m.
    let vehicle = OracleVehicle::table_4().planar();
    for distance in [46.0, 51.0, 52.5, 55.0, 70.0, 120.0_f64] {
        let sphere = OracleObstacle::sphere(Vec3::X * distance, Vec3::ZERO, 30.0);
        let expected = (distance.hypot(30.0) - 60.0).min(distance - 30.0);
        for stages in [Stages::One, Stages::Two] {
            let answer = search(&vehicle, &[sphere], stages);
            assert!(
                (answer.best_margin_m - expected).abs() < 0.01,
                "{distance}: {answer:?}, {expected}"
            );
            assert_eq!(answer.avoidable(), distance > 52.1);
            assert!((answer.do_nothing_margin_m + 30.0).abs() < 1e-3);
        }
    }
}

#[test]
fn holding_the_course_gives_the_straight_line_miss() {
    let vehicle = OracleVehicle::table_4();
    let answer = search(
        &vehicle,
        &[OracleObstacle::sphere(
            Vec3::new(200.0, 40.0, 0.0),
            Vec3::new(-10.0, 0.0, 0.0),
            30.0,
        )],
        Stages::One,
    );
    assert!((answer.do_nothing_margin_m - 10.0).abs() < 1e-9);
    assert!(answer.best_margin_m > 100.0);
    assert!(
        search(&vehicle, &[], Stages::Two)
            .best_margin_m
            .is_infinite()
    );
}

#[test]
fn mirrored_encounters_are_as_hard() {
    let planar = OracleVehicle::table_4().planar();
    for number in 0..6 {
        let obstacles = cell("threats:3:100-300:30-60,planar", number);
        let mirrored: Vec<_> = obstacles
            .iter()
            .map(|o| {
                let flip = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
                OracleObstacle {
                    position_m: flip(o.position_m),
                    velocity_mps: flip(o.velocity_mps),
                    ..*o
                }
            })
            .collect();
        let a = search(&planar, &obstacles, Stages::Two).best_margin_m;
        let b = search(&planar, &mirrored, Stages::Two).best_margin_m;
        assert!((a - b).abs() < 0.05, "{number}: {a}, {b}");
    }
}

#[test]
fn margins_are_those_of_the_path_sampled_finely() {
    let ideal = OracleVehicle::table_4();
    let slow = OracleVehicle {
        dead_time_s: 0.3,
        bank_time_constant_s: 0.6,
        turn_rate_factor: 0.74,
        course_rate_radps: 0.37,
        ..ideal
    };
    // tan φ = V²/(g ρ), Eq. 8.
    assert!((ideal.bank_max_rad.tan() - 225.0 / (9.806_65 * 30.0)).abs() < 1e-12);
    let mut random = Random::new(3, 0);
    for case in 0..40 {
        let vehicle = if case % 2 == 0 { ideal } else { slow };
        let maneuver = OracleManeuver {
            wait_s: random.within(Range(0.0, 5.0)),
            turn1_rad: random.within(Range(-4.0, 4.0)),
            climb1_rad: random.within(Range(-0.26, 0.26)),
            straight_s: random.within(Range(0.0, 5.0)),
            turn2_rad: random.within(Range(-4.0, 4.0)),
            climb2_rad: random.within(Range(-0.26, 0.26)),
        };
        let start = OracleStart {
            position_m: Vec3::new(5.0, -3.0, 2.0),
            course_rad: random.within(Range(-3.0, 3.0)),
            climb_rad: random.within(Range(-0.2, 0.2)),
            bank_rad: 0.0,
        };
        let obstacles: Vec<_> = (0..3)
            .map(|k| OracleObstacle {
                position_m: random.direction(false) * random.within(Range(50.0, 300.0)),
                velocity_mps: random.direction(false) * random.within(Range(0.0, 40.0)),
                volume: if k == 0 {
                    ProtectedVolume::Cylinder {
                        radius_m: 40.0,
                        half_height_m: 15.0,
                    }
                } else {
                    ProtectedVolume::Sphere { radius_m: 30.0 }
                },
            })
            .collect();
        let flown = OracleFlight::new(&start, &vehicle, &maneuver, HORIZON_S);
        for obstacle in &obstacles {
            let one = core::slice::from_ref(obstacle);
            let exact = flown.least_margin_m(one);
            let sampled = sampled_margin(&start, &vehicle, &maneuver, one);
            // The samples are 0.25 ms apart and the reference's bank is a first-order integral.
            let tolerance = if case % 2 == 0 { 2e-3 } else { 2e-2 };
            assert!(
                (exact - sampled).abs() < tolerance,
                "{case}: {exact} against {sampled}"
            );
        }
    }
}

#[test]
fn two_turns_escape_a_pincer_that_one_turn_does_not() {
    let vehicle = OracleVehicle::table_4();
    let obstacles = cell("pincer:3", 0);
    let one = search(&vehicle, &obstacles, Stages::One);
    let two = search(&vehicle, &obstacles, Stages::Two);
    assert!(one.best_margin_m < 0.0 && two.best_margin_m >= AVOIDABLE_MARGIN_M);
    let sampled = sampled_margin(&OracleStart::ORIGIN, &vehicle, &two.maneuver, &obstacles);
    assert!((sampled - two.best_margin_m).abs() < 2e-3);
}

#[test]
fn the_third_dimension_never_makes_it_worse() {
    let vehicle = OracleVehicle::table_4();
    let sphere = OracleObstacle::sphere(Vec3::X * 50.0, Vec3::ZERO, 30.0);
    let planar = search(&vehicle.planar(), &[sphere], Stages::Two).best_margin_m;
    let spatial = search(&vehicle, &[sphere], Stages::Two).best_margin_m;
    assert!(spatial > planar + 0.1, "{spatial} against {planar}");
}

#[test]
fn a_quick_response_is_nearly_the_ideal_vehicle_and_a_slow_one_is_worse() {
    let ideal = OracleVehicle::table_4();
    let with = |bank_time_constant_s, dead_time_s| OracleVehicle {
        bank_time_constant_s,
        dead_time_s,
        ..ideal
    };
    for number in 0..4 {
        let obstacles = cell("threats:2:100-300:45-60", number);
        let margin = |vehicle| search(&vehicle, &obstacles, Stages::One).best_margin_m;
        let best = margin(ideal);
        // A bank that follows within 0.02 s costs at most that time at the closing speed.
        assert!((margin(with(0.02, 0.0)) - best).abs() < 0.02 * 75.0);
        assert!(margin(with(0.6, 0.0)) < best + 0.01);
        assert!(margin(with(0.6, 0.5)) < margin(with(0.6, 0.0)) + 0.01);
    }
}

#[test]
fn wind_is_obstacles_that_move_the_other_way() {
    // Still air and a sphere coming at 10 m/s, or 10 m/s of headwind and a sphere at rest.
    let vehicle = OracleVehicle::table_4();
    let coming = OracleObstacle::sphere(
        Vec3::new(250.0, 10.0, 0.0),
        Vec3::new(-10.0, 0.0, 0.0),
        30.0,
    );
    let standing = OracleObstacle {
        velocity_mps: Vec3::ZERO,
        ..coming
    }
    .in_wind(Vec3::new(10.0, 0.0, 0.0));
    assert_eq!(
        search(&vehicle, &[coming], Stages::One),
        search(&vehicle, &[standing], Stages::One)
    );
}

#[test]
fn enough_stops_early_with_a_true_lower_bound() {
    let vehicle = OracleVehicle::table_4();
    let obstacles = cell("threats:2:300:15-30", 1);
    let all = search(&vehicle, &obstacles, Stages::Two).best_margin_m;
    let quick = best_margin(
        &OracleStart::ORIGIN,
        &vehicle,
        &obstacles,
        &OracleSettings {
            enough_m: Some(1.0),
            ..OracleSettings::default()
        },
    );
    assert!(quick.best_margin_m >= 1.0 && quick.best_margin_m <= all + 0.02);
}

#[test]
fn the_least_departure_from_a_head_on_sphere_is_its_radius() {
    // A static sphere of radius 30 m on the line, far ahead, in the plane: a pass at a margin of 0.1 m leads
    // 30.1 m off the line at the moment of passing, and no pass leads less.
    let vehicle = OracleVehicle::table_4().planar();
    let sphere = OracleObstacle::sphere(Vec3::X * 200.0, Vec3::ZERO, 30.0);
    let answer = least_departure(
        &OracleStart::ORIGIN,
        &vehicle,
        &[sphere],
        &OracleSettings::default(),
        0.1,
    )
    .unwrap();
    assert!((answer.max_cross_track_m - 30.1).abs() < 0.3, "{answer:?}");
}

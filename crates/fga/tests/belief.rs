//! What is flown among aircraft that may do many things.

use fga::avoider::belief::BeliefAvoider;
use fga::avoider::{Decision, Settings, State};
use fga::meter::Meter;
use fga::prediction::{Flyer, MotionState};
use fga::situation::{
    Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation, Uncertainty,
};
use fga::vehicle::{Response, Vehicle};
use fga::zone::{ALL_HEIGHTS_M, Outline, Zone};
use fga::{Vec2, Vec3};
use fga_belief::{Belief, Errors, Report, Sigma, Source};

const VEHICLE: Vehicle = Vehicle {
    airspeed_mps: 30.0,
    turn_radius_m: 200.0,
    climb_min_rad: -0.1,
    climb_max_rad: 0.1,
    climb_rate_radps: 0.05,
    response: Response::IDEAL,
};

const WAYPOINTS_M: [Vec3; 2] = [Vec3::new(0.0, 0.0, 300.0), Vec3::new(2e4, 0.0, 300.0)];

fn errors() -> Errors {
    let sigma = |value| Sigma::new(value, Source::Sensor);
    Errors {
        position_m: sigma(15.0),
        altitude_m: sigma(2.0),
        velocity_mps: sigma(1.0),
        climb_mps: sigma(1.0),
        lasting_position_m: sigma(0.0),
        lasting_altitude_m: sigma(20.0),
    }
}

fn pilot() -> BeliefAvoider {
    BeliefAvoider::new(Settings::default(), VEHICLE, errors()).unwrap()
}

/// Level, along x.
const fn ownship(position_m: Vec3) -> Ownship {
    Ownship {
        position_m,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 30.0,
    }
}

/// Of another aircraft a report without an error.
fn aircraft(place_m: Vec3, velocity_mps: Vec3) -> Obstacle {
    let volume = ProtectedVolume::Cylinder {
        radius_m: 609.6,
        half_height_m: 76.2,
    };
    Obstacle {
        movement: Movement::CREWED,
        ..Obstacle::straight(7, place_m, velocity_mps, volume)
    }
}

/// The last decision after reports for ten seconds of an aircraft that is at a place after them, with a velocity.
fn decided(mission: Mission<'_>, at_m: Vec3, velocity_mps: Vec3) -> Decision {
    decided_by(&mut pilot(), mission, &aircraft(at_m, velocity_mps))
}

fn decided_by(pilot: &mut BeliefAvoider, mission: Mission<'_>, last: &Obstacle) -> Decision {
    let mut decision = Decision::default();
    for second in 0..=10 {
        let (time_s, left_s) = (f64::from(second), f64::from(10 - second));
        let obstacle = Obstacle {
            position_m: last.position_m - last.velocity_mps * left_s,
            ..*last
        };
        decision = pilot.step(&Situation {
            time_s,
            ownship: ownship(Vec3::new(30.0 * time_s, 0.0, 300.0)),
            obstacles: Obstacles::Rows(&[obstacle]),
            mission,
            wind_mps: Vec3::ZERO,
        });
    }
    decision
}

const TOWARDS_MPS: Vec3 = Vec3::new(-60.0, 0.0, 0.0);

#[test]
fn a_head_on_aircraft_is_avoided_and_one_far_above_is_not() {
    let mission = Mission::new(&WAYPOINTS_M);
    let near = decided(mission, Vec3::new(2600.0, 0.0, 300.0), TOWARDS_MPS);
    let record = &near.record;
    assert_eq!(near.state, State::Avoiding, "{near:?}");
    assert!(record.p_loss_hold.unwrap() > 0.8 && record.p_loss.unwrap() < 0.2);
    assert!(near.command.certified().is_some(), "{near:?}");
    assert_eq!(record.threat.map(|threat| threat.id), Some(7));
    let above = decided(mission, Vec3::new(2600.0, 0.0, 700.0), TOWARDS_MPS);
    assert_eq!(above.state, State::Cruise, "{above:?}");
    assert!(above.record.p_loss_hold.unwrap() < 0.05, "{above:?}");
}

/// The σ of a report counts in the place of one that is assumed, and not in the place of one that somebody said.
#[test]
fn a_report_that_says_its_own_errors_is_believed_by_them() {
    let near = aircraft(Vec3::new(2600.0, 200.0, 300.0), TOWARDS_MPS);
    let worse = Obstacle {
        uncertainty: Uncertainty {
            position_m: 80.0,
            velocity_mps: 4.0,
        },
        ..near
    };
    let by = |errors: Errors, reported: &Obstacle| {
        let mut pilot = BeliefAvoider::new(Settings::default(), VEHICLE, errors).unwrap();
        decided_by(&mut pilot, Mission::new(&WAYPOINTS_M), reported)
    };
    let with = |source, position_m, velocity_mps| Errors {
        position_m: Sigma::new(position_m, source),
        velocity_mps: Sigma::new(velocity_mps, source),
        climb_mps: Sigma::new(velocity_mps, source),
        ..errors()
    };
    let said = with(Source::Sensor, 15.0, 1.0);
    let wide = by(with(Source::Sensor, 80.0, 4.0), &near);
    assert_eq!(by(with(Source::Assumed, 15.0, 1.0), &worse), wide);
    assert_eq!(by(said, &worse), by(said, &near));
    assert_ne!(by(said, &near), wide);
}

/// The last reports of a near aircraft are not finite: it is kept clear of all the same, as one that is not reported.
#[test]
fn an_aircraft_whose_reports_are_not_finite_is_kept_clear_of() {
    let near = aircraft(Vec3::new(2600.0, 0.0, 300.0), TOWARDS_MPS);
    let mut pilot = pilot();
    decided_by(&mut pilot, Mission::new(&WAYPOINTS_M), &near);
    let broken = Obstacle {
        velocity_mps: Vec3::new(f64::NAN, 0.0, 0.0),
        ..near
    };
    let last = |obstacles: &[Obstacle]| {
        let mut pilot = pilot.clone();
        let mut decision = Decision::default();
        for second in 11..=16 {
            let time_s = f64::from(second);
            decision = pilot.step(&Situation {
                time_s,
                ownship: ownship(Vec3::new(30.0 * time_s, 0.0, 300.0)),
                obstacles: Obstacles::Rows(obstacles),
                mission: Mission::new(&WAYPOINTS_M),
                wind_mps: Vec3::ZERO,
            });
        }
        let threat = decision.record.threat.map(|threat| threat.id);
        (
            decision.state,
            threat,
            decision.record.proven_share.is_some(),
        )
    };
    assert_eq!(last(&[broken]), (State::Avoiding, Some(7), true));
    assert_eq!(last(&[]), (State::Avoiding, Some(7), true));
}

/// An aircraft that is reported at rest is no aircraft any more: nothing is believed of it.
#[test]
fn what_comes_to_rest_is_where_it_is() {
    let near = aircraft(Vec3::new(2600.0, 0.0, 300.0), TOWARDS_MPS);
    let mut pilot = pilot();
    decided_by(&mut pilot, Mission::new(&WAYPOINTS_M), &near);
    let rests = Obstacle::straight(7, Vec3::new(2600.0, 3000.0, 300.0), Vec3::ZERO, near.volume);
    pilot.step(&Situation {
        time_s: 11.0,
        ownship: ownship(Vec3::new(330.0, 0.0, 300.0)),
        obstacles: Obstacles::Rows(&[rests]),
        mission: Mission::new(&WAYPOINTS_M),
        wind_mps: Vec3::ZERO,
    });
    assert_eq!(pilot.beliefs().each().count(), 0);
}

/// Two minutes away nothing is lost yet, and it waits.
#[test]
fn a_conflict_far_ahead_is_waited_for() {
    let mission = Mission::new(&WAYPOINTS_M);
    let far = decided(mission, Vec3::new(5600.0, 300.0, 300.0), TOWARDS_MPS);
    assert_ne!(far.state, State::Avoiding, "{far:?}");
    assert!(far.record.p_loss_hold.unwrap() > 0.1, "{far:?}");
}

#[test]
fn the_same_reports_give_the_same_decision() {
    let decided = || {
        decided(
            Mission::new(&WAYPOINTS_M),
            Vec3::new(2500.0, 500.0, 320.0),
            Vec3::new(-40.0, -10.0, 0.0),
        )
    };
    assert_eq!(decided(), decided());
}

/// Flies a mission for some seconds past an obstacle that is where it is said at a time; `watch` sees the aircraft after each step, and the
/// obstacle as it was.
fn fly_past(
    mission: Mission<'_>,
    seconds: u32,
    obstacle: impl Fn(f64) -> Obstacle,
    mut watch: impl FnMut(&MotionState, &Obstacle, f64),
) {
    let (mut pilot, flyer) = (pilot(), Flyer::new(&VEHICLE));
    let mut own = MotionState::of(&ownship(Vec3::new(0.0, 0.0, 300.0)));
    for step in 0..10 * seconds {
        let time_s = 0.1 * f64::from(step);
        let obstacle = obstacle(time_s);
        let decision = pilot.step(&Situation {
            time_s,
            ownship: Ownship {
                position_m: own.position_m,
                course_rad: own.course_rad,
                climb_rad: own.climb_rad,
                bank_rad: own.bank_rad,
                airspeed_mps: 30.0,
            },
            obstacles: Obstacles::Rows(&[obstacle]),
            mission,
            wind_mps: Vec3::ZERO,
        });
        let stages = decision.command.stages();
        own = fga::prediction::flown(&flyer, &own, stages, 0.1, &Meter::unlimited());
        own.time_s = 0.0;
        watch(&own, &obstacle, time_s);
    }
}

/// A head-on aircraft between walls 600 m to either side, under a ceiling 30 m above: the flight of a minute stays within them, though
/// without them it leaves by more.
#[test]
fn zones_and_limits_bound_what_is_flown() {
    let corners_m =
        [(-1e4, -600.0), (3e4, -600.0), (3e4, 600.0), (-1e4, 600.0)].map(|(x, y)| Vec2::new(x, y));
    let fence = [Zone {
        keep_in: true,
        outline: Outline::Polygon(&corners_m),
        heights_m: ALL_HEIGHTS_M,
    }];
    let flown = |mission: Mission<'_>| {
        let mut most_m = (0.0_f64, 0.0_f64);
        let head_on = |time_s| {
            let at_m = Vec3::new(3400.0, 100.0, 300.0) + TOWARDS_MPS * time_s;
            aircraft(at_m, TOWARDS_MPS)
        };
        fly_past(mission, 60, head_on, |own, _, _| {
            most_m = (
                most_m.0.max(own.position_m.y.abs()),
                most_m.1.max(own.position_m.z),
            );
        });
        most_m
    };
    let free_m = flown(Mission::new(&WAYPOINTS_M));
    let bound_m = flown(Mission {
        zones: &fence,
        limits_m: (250.0, 330.0),
        ..Mission::new(&WAYPOINTS_M)
    });
    assert!(free_m.0 > 600.0 || free_m.1 > 330.0, "{free_m:?}");
    assert!(bound_m.0 < 600.0 && bound_m.1 < 330.0, "{bound_m:?}");
}

/// Sampled each 0.1 s: every future that comes into the volume is left out, and those that stay outside by more than a chord bows are counted.
#[test]
fn a_proven_share_is_the_weight_of_the_futures_that_are_kept_clear_of() {
    let flyer = Flyer::new(&VEHICLE);
    let start = MotionState::of(&ownship(Vec3::new(300.0, 0.0, 300.0)));
    let mut shares = (0, 0);
    for place in 0..20 {
        let (x, y) = (
            1400.0 + 25.0 * f64::from(place),
            300.0 - 40.0 * f64::from(place % 16),
        );
        let (at_m, velocity_mps) = (Vec3::new(x, y, 300.0), Vec3::new(-45.0, 4.0, 0.0));
        let decision = decided(Mission::new(&WAYPOINTS_M), at_m, velocity_mps);
        let Some(share) = decision.record.proven_share else {
            assert!(decision.command.certified().is_none());
            continue;
        };
        let report = |second: i32| Report {
            time_s: f64::from(second),
            position_m: at_m - velocity_mps * f64::from(10 - second),
            velocity_mps: Some(velocity_mps),
            carried_s: 0.0,
            errors: errors(),
        };
        let bounds = Movement::CREWED.bounds().unwrap();
        let mut belief = Belief::new(&report(0), &bounds);
        for second in 1..=10 {
            belief.update(&report(second));
        }
        let futures = belief.futures(10.0);
        let volume = aircraft(at_m, velocity_mps).volume;
        let stages = decision.command.stages();
        let least_m = |future: &fga_belief::future::Future| {
            let margins = (0..=600_u16).map(|step| {
                let after_s = 0.1 * f32::from(step);
                let own = fga::prediction::flown(
                    &flyer,
                    &start,
                    stages,
                    after_s.into(),
                    &Meter::unlimited(),
                );
                let [x, y, z] = future.position_m(after_s).map(f64::from);
                volume.margin_m(own.position_m - (futures.origin_m + Vec3::new(x, y, z)))
            });
            margins.fold(f64::INFINITY, f64::min)
        };
        let weigh = |least_from_m: f64| {
            let kept = futures
                .each()
                .filter(|future| least_m(future) >= least_from_m);
            kept.map(|future| f64::from(future.weight)).sum::<f64>()
        };
        assert!(
            weigh(6.0) <= share + 1e-6 && share <= weigh(-0.01) + 1e-6,
            "{place}: {share}, {} to {}",
            weigh(6.0),
            weigh(-0.01)
        );
        shares.0 += u32::from(share < 0.98);
        shares.1 += u32::from(share > 0.5);
    }
    assert!(shares.0 > 2 && shares.1 > 4, "{shares:?}");
}

/// Two aircraft fly side by side for ten minutes, the first time one in the other's volume: ours leaves that, and is near its mission in the end.
#[test]
fn who_flies_alongside_keeps_no_aircraft_away_for_ever() {
    for (beside_m, speed_mps, radius_m) in [
        (150.0, 30.0, 609.6),
        (400.0, 30.0, 609.6),
        (700.0, 31.0, 609.6),
        (900.0, 29.0, 609.6),
        (30.0, 30.0, 60.0),
        (90.0, 30.0, 60.0),
    ] {
        let velocity_mps = Vec3::new(speed_mps, 0.0, 0.0);
        let alongside = |time_s| Obstacle {
            volume: ProtectedVolume::Cylinder {
                radius_m,
                half_height_m: 30.0,
            },
            ..aircraft(
                Vec3::new(-0.3 * radius_m, beside_m, 300.0) + velocity_mps * time_s,
                velocity_mps,
            )
        };
        let mut last_m = Vec3::ZERO;
        fly_past(
            Mission::new(&WAYPOINTS_M),
            600,
            alongside,
            |own, obstacle, time_s| {
                last_m = own.position_m;
                if (time_s - 30.0).abs() < 0.01 {
                    let away_m = last_m - (obstacle.position_m + velocity_mps * 0.1);
                    assert!(
                        obstacle.volume.margin_m(away_m) > 0.0,
                        "{beside_m}: {away_m}"
                    );
                }
            },
        );
        assert!(last_m.y.abs() < 2500.0, "{beside_m}: {last_m}");
    }
}

/// An aircraft that hovers on the mission is passed: turning away from it is no way past it.
#[test]
fn who_hovers_ahead_is_passed() {
    let hovers = |_| Obstacle {
        volume: ProtectedVolume::Sphere { radius_m: 60.0 },
        movement: Movement::SMALL_UAS,
        ..aircraft(Vec3::new(2500.0, 12.0, 305.0), Vec3::ZERO)
    };
    let (mut least_m, mut most_m, mut last_m) = (f64::INFINITY, 0.0_f64, Vec3::ZERO);
    fly_past(
        Mission::new(&WAYPOINTS_M),
        200,
        hovers,
        |own, obstacle, _| {
            last_m = own.position_m;
            least_m = least_m.min(last_m.distance(obstacle.position_m));
            most_m = most_m.max(last_m.y.abs());
        },
    );
    assert!(least_m > 60.0 && most_m < 600.0, "{least_m} {most_m}");
    assert!(last_m.x > 5000.0 && last_m.y.abs() < 20.0, "{last_m}");
}

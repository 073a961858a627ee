use super::*;
use crate::assumptions::CLIMB_CHANGES_S;
use crate::situation::{Movement, ProtectedVolume};
use alloc::vec::Vec;

const BOUNDS: MovementBounds = MovementBounds::CREWED;

const EXACT: Clearance = Clearance {
    beyond_m: 0.0,
    margin_m: 0.0,
    is_unproven: false,
};

fn intruder() -> Obstacle {
    let volume = ProtectedVolume::Cylinder {
        radius_m: 150.0,
        half_height_m: 30.0,
    };
    Obstacle {
        movement: Movement::CREWED,
        ..Obstacle::straight(
            7,
            Vec3::new(900.0, 300.0, 20.0),
            Vec3::new(-52.0, 21.0, 1.5),
            volume,
        )
    }
}

fn motions(freedom: Freedom, trend: Trend) -> Vec<Hazard> {
    let obstacle = intruder();
    let mut motions = Vec::new();
    let hazard = Hazard::new(&obstacle, Vec3::ZERO, 3.0);
    add_aircraft(
        &mut |hazard| motions.push(hazard),
        &hazard,
        (&obstacle, trend),
        (freedom, EXACT),
        MOTIONS,
    );
    motions
}

fn motions_of(obstacle: &Obstacle, freedom: Freedom, turns: usize) -> Vec<Hazard> {
    let mut motions = Vec::new();
    let hazard = Hazard::new(obstacle, Vec3::ZERO, 3.0);
    let trend = Trend::of(obstacle);
    add_aircraft(
        &mut |hazard| motions.push(hazard),
        &hazard,
        (obstacle, trend),
        (freedom, EXACT),
        turns,
    );
    motions
}

/// The intruder after a turn at a rate for a time and a change of climb, by small steps.
fn flown(rate_radps: f64, for_s: f64, climb_mps: f64, until_s: f64) -> Vec3 {
    let Obstacle {
        mut position_m,
        velocity_mps: v,
        ..
    } = intruder();
    let mut course = v.y.atan2(v.x);
    let (speed, dt) = (v.x.hypot(v.y), 1e-3);
    let steps = (until_s / dt).round();
    let mut time_s = 0.0;
    while time_s < steps * dt - 0.5 * dt {
        let turn = if time_s < for_s - 0.5 * dt {
            rate_radps * dt
        } else {
            0.0
        };
        course += 0.5 * turn;
        let climb = v.z
            + if time_s < CLIMB_CHANGES_S {
                climb_mps
            } else {
                0.0
            };
        position_m += Vec3::new(speed * course.cos(), speed * course.sin(), climb) * dt;
        course += 0.5 * turn;
        time_s += dt;
    }
    position_m
}

/// Whether a hazard that exists at that time contains the volume about a position.
fn is_within(motions: &[Hazard], place_m: Vec3, at_s: f64) -> bool {
    motions.iter().any(|hazard| {
        let (from_s, until_s) = hazard.window_s;
        let volume = intruder().volume;
        let room_m = hazard.volume.radius_m() - volume.radius_m() + hazard.growth_mps * at_s;
        let (now_m, more_mps) = hazard.stretch_m;
        let off = place_m - (hazard.position_m + hazard.velocity_mps * at_s);
        (from_s..=until_s).contains(&at_s)
            && off.x.hypot(off.y) <= room_m
            && off.z.abs() <= now_m + more_mps * at_s + room_m
    })
}

/// An earlier version raised cylinders by the bows of chords and by what a change of speed makes.
#[test]
fn level_motions_make_no_volume_higher() {
    let mut level = MovementBounds::CREWED;
    level.climb_change_mps = 0.0;
    let obstacle = Obstacle {
        movement: Movement::Aircraft(level),
        velocity_mps: intruder().velocity_mps.with_z(0.0),
        ..intruder()
    };
    for freedom in [
        Freedom::Share(0.0, 0.0),
        Freedom::Share(0.5, 0.0),
        Freedom::Brief,
    ] {
        let motions = motions_of(&obstacle, freedom, MOTIONS);
        let heights_m = motions.iter().map(|row| {
            let (now_m, more_mps) = row.stretch_m;
            (row.volume.half_height_m() + now_m, more_mps)
        });
        let share = f64::from(freedom != Freedom::Share(0.0, 0.0));
        let most_m = obstacle.volume.half_height_m() + TRACKING_M * share + 1e-9;
        for (height_m, more_mps) in heights_m {
            assert!(
                height_m <= most_m && more_mps == 0.0,
                "{freedom:?}: {height_m}"
            );
        }
    }
}

/// An earlier version withstood each aircraft for 20 s: among small ones a way back waited for a minute.
#[test]
fn a_way_back_withstands_a_turn_for_as_long_as_it_takes() {
    for (movement, turn_s) in [(Movement::SMALL_UAS, 6.0), (Movement::CREWED, 20.0)] {
        let obstacle = Obstacle {
            movement,
            ..intruder()
        };
        let ends_s = |freedom, turns| {
            let motions = motions_of(&obstacle, freedom, turns);
            let ends_s = motions.iter().map(|row| row.window_s.1);
            ends_s.fold(0.0, f64::max)
        };
        for turns in [MOTIONS, 0] {
            let brief_s = ends_s(Freedom::Brief, turns);
            assert!((brief_s - turn_s).abs() < 1e-9, "{turns}");
        }
        assert_eq!(ends_s(Freedom::Share(0.5, 0.0), MOTIONS), f64::INFINITY);
    }
}

#[test]
fn the_margin_counts_towards_the_distance_for_tracking_errors() {
    let growth_m = |beyond_m, margin_m, share| {
        let clearance = Clearance {
            beyond_m,
            margin_m,
            is_unproven: false,
        };
        clearance.growth_m(share)
    };
    assert_eq!(growth_m(0.0, 0.0, 1.0), TRACKING_M);
    assert_eq!(growth_m(0.0, 4.0, 1.0), TRACKING_M - 4.0);
    assert_eq!(growth_m(3.0, 9.0, 1.0), 3.0);
    assert_eq!(growth_m(3.0, 4.0, 0.0), 0.0);
}

/// An aircraft that flies on for some seconds and turns then is where a motion has it.
#[test]
fn a_share_of_the_turns_begins_at_once_or_later() {
    let obstacle = Obstacle {
        volume: ProtectedVolume::Sphere { radius_m: 30.0 },
        ..intruder()
    };
    let bounds = obstacle.movement.bounds().unwrap();
    let after = |later_s: f64, time_s: f64| {
        let rate_radps = bounds.turn_rate_radps;
        let for_s = 0.5 * bounds.turn_rad / rate_radps;
        // Along the circle by its chord, then along the new course.
        let begins_m = obstacle.position_after_m(later_s);
        let half_rad = 0.5 * rate_radps * for_s;
        let turned = |by_rad: f64| {
            let (sin, cos) = by_rad.sin_cos();
            let v = obstacle.velocity_mps;
            Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
        };
        let level = Vec3::new(1.0, 1.0, 0.0);
        let chord_m = turned(half_rad) * level * (for_s * half_rad.sin() / half_rad);
        let climbed_m = Vec3::Z * obstacle.velocity_mps.z * for_s;
        let left_s = time_s - later_s - for_s;
        begins_m + chord_m + climbed_m + turned(2.0 * half_rad) * left_s
    };
    let is_met = |at_m: Vec3, motions| {
        let motions = motions_of(&obstacle, Freedom::Share(0.5, 3.0), motions);
        let mut rows = motions.iter();
        let at_s = 30.0;
        rows.any(|row| {
            let is_now = (row.window_s.0..row.window_s.1).contains(&at_s);
            is_now && row.margin_m(at_m, at_s) < 0.0
        })
    };
    for (later_s, met) in [(0.0, [true; 2]), (3.0, [false, true])] {
        let at_m = after(later_s, 30.0);
        assert_eq!([AT_ONCE, MOTIONS].map(|most| is_met(at_m, most)), met);
    }
}

#[test]
fn a_climb_that_becomes_steeper_is_expected_to_go_on() {
    let climbing = |climb_mps: f64| Obstacle {
        velocity_mps: Vec3::new(50.0, 0.0, climb_mps),
        ..intruder()
    };
    let mut trend = Trend::of(&climbing(4.0));
    let mut fly = |climb_mps: f64, for_s: u32| {
        let now = climbing(climb_mps);
        for _ in 0..10 * for_s {
            trend.learn(now.velocity_mps, now.velocity_mps, 0.1);
        }
        trend.climb_change_mps(&now)
    };
    assert_eq!(fly(4.0, 60), 0.0);
    let pulls_up = fly(14.0, 1);
    assert!((10.0..11.0).contains(&pulls_up), "{pulls_up}");
    let goes_on = fly(14.0, 60);
    assert!(goes_on < 1e-6, "{goes_on}");
    let levels_off = fly(0.0, 1);
    assert!(levels_off < 0.0, "{levels_off}");
    let mut noisy = climbing(4.0);
    noisy.uncertainty.velocity_mps = 4.0;
    assert!(trend.climb_change_mps(&noisy) < 0.0);
}

#[test]
fn a_turn_and_a_climb_within_the_share_stay_within_the_hazards() {
    for share in [0.25, 0.5, 1.0] {
        let motions = motions(Freedom::Share(share, 0.0), Trend::STRAIGHT);
        let for_s = share * BOUNDS.turn_rad / BOUNDS.turn_rate_radps;
        for side in [-1.0, 1.0] {
            for climb in [-1.0, 0.0, 0.7, 1.0] {
                for at_s in [0.0, 1.3, 4.0, 7.7, 12.1, 19.9, 20.1, 33.0] {
                    let rate = side * BOUNDS.turn_rate_radps;
                    let most = f64::min(CLIMB_SHARE * share, 1.0);
                    let climb_mps = climb * most * BOUNDS.climb_change_mps;
                    let place_m = flown(rate, for_s, climb_mps, at_s);
                    assert!(
                        is_within(&motions, place_m, at_s),
                        "share {share}, side {side}, climb {climb}, {at_s} s"
                    );
                }
            }
        }
    }
}

/// The room that is kept for an aircraft is enough for it, and hardly more.
#[test]
fn d4_an_aircraft_takes_the_room_that_is_kept_for_it() {
    let obstacle = intruder();
    let mut turning = Trend::STRAIGHT;
    turning.rate_radps = 0.05;
    for trend in [Trend::STRAIGHT, turning] {
        let shares = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| Freedom::Share(share, 0.0));
        for freedom in shares
            .into_iter()
            .chain([Freedom::Expected, Freedom::Brief])
        {
            let most = super::most_hazards(freedom, (&obstacle, trend), MOTIONS);
            let taken = motions(freedom, trend).len();
            assert!(
                (taken..=taken + 4).contains(&most),
                "{freedom:?}: {taken} of {most}"
            );
        }
    }
}

#[test]
fn d3_a_climb_may_end_at_any_moment() {
    let climbing = Obstacle {
        velocity_mps: Vec3::new(-52.0, 21.0, 7.62),
        ..intruder()
    };
    for (turns, share) in [(MOTIONS, 1.0), (0, 1.0), (MOTIONS, 0.5)] {
        let motions = motions_of(&climbing, Freedom::Share(share, 0.0), turns);
        for ends_s in [0.0, 4.0, 19.0, 31.0] {
            for at_s in [0.0, 3.0, 12.0, 20.0, 45.0] {
                let kept_mps = (1.0 - share) * climbing.velocity_mps.z;
                let climbs_s = f64::min(at_s, ends_s);
                let place_m = climbing.position_m
                    + climbing.velocity_mps.with_z(kept_mps) * at_s
                    + Vec3::Z * (climbing.velocity_mps.z - kept_mps) * climbs_s;
                assert!(
                    is_within(&motions, place_m, at_s),
                    "{turns} turns, share {share}, ends after {ends_s} s, {at_s} s"
                );
            }
        }
        let below_m = climbing.position_m - Vec3::Z * 90.0;
        assert!(!is_within(&motions, below_m, 0.0), "{turns} turns, {share}");
    }
}

#[test]
fn d2_its_motion_may_have_changed_since_its_report() {
    for age_s in [-1e-12, 0.5, 2.0, 9.0] {
        let reported = intruder();
        let seen = Obstacle {
            position_m: reported.position_m + reported.velocity_mps * age_s,
            age_s,
            ..reported
        };
        let motions = motions_of(&seen, Freedom::Share(1.0, 0.0), MOTIONS);
        let for_s = BOUNDS.turn_rad / BOUNDS.turn_rate_radps;
        for side in [-1.0, 1.0] {
            for at_s in [0.0, 4.0, 7.7, 19.9, 33.0] {
                let climb_mps = side * BOUNDS.climb_change_mps;
                let rate = side * BOUNDS.turn_rate_radps;
                let place_m = flown(rate, for_s, climb_mps, age_s + at_s);
                assert!(
                    is_within(&motions, place_m, at_s),
                    "{age_s} s old, side {side}, {at_s} s"
                );
            }
        }
    }
}

/// An earlier version widened the volume at once by all that the speed may change in ten seconds.
#[test]
fn a_change_of_speed_takes_its_time() {
    let faster_m = |at_s: f64| 0.5 * BOUNDS.acceleration_mps2 * at_s * at_s;
    for age_s in [0.0, 2.0] {
        let reported = intruder();
        let seen = Obstacle {
            position_m: reported.position_m + reported.velocity_mps * age_s,
            age_s,
            ..reported
        };
        let motions = motions_of(&seen, Freedom::Brief, MOTIONS);
        let ahead = reported.velocity_mps.with_z(0.0).normalize();
        for side in [-1.0, 1.0] {
            for at_s in [0.0, 1.3, 4.0, 7.7, 10.0 - age_s] {
                let straight_m = seen.position_m + seen.velocity_mps * at_s;
                let place_m = straight_m + side * ahead * faster_m(age_s + at_s);
                assert!(is_within(&motions, place_m, at_s), "{side} {at_s} s");
            }
        }
        let place_m = seen.position_m - ahead * (TRACKING_M + faster_m(10.0));
        assert!(!is_within(&motions, place_m, 0.0), "{age_s} s old");
    }
}

#[test]
fn a_larger_turn_leaves_the_hazards_of_a_smaller_share() {
    let motions = motions(Freedom::Share(0.25, 0.0), Trend::STRAIGHT);
    let place_m = flown(BOUNDS.turn_rate_radps, 20.0, 0.0, 30.0);
    assert!(!is_within(&motions, place_m, 30.0));
}

#[test]
fn a_turn_is_learned_from_reports_and_expected_to_go_on() {
    let mut trend = Trend::STRAIGHT;
    let rate = 0.05_f64;
    let velocity = |time_s: f64| {
        Vec3::new(
            50.0 * (rate * time_s).cos(),
            50.0 * (rate * time_s).sin(),
            0.0,
        )
    };
    for k in 1..=60 {
        let time_s = 0.1 * f64::from(k);
        trend.learn(velocity(time_s - 0.1), velocity(time_s), 0.1);
    }
    let expected = trend.expected_radps(&intruder(), &BOUNDS);
    assert!((expected - rate).abs() < 0.1 * rate, "{expected}");
    let motions = motions(Freedom::Expected, trend);
    let place_m = flown(expected, TURNS_ON_S, 0.0, 14.0);
    assert!(is_within(&motions, place_m, 14.0));
    // Half of the course noise of 1 m/s in 50 m/s may be a turn of this rate.
    let noisy = Obstacle {
        uncertainty: crate::situation::Uncertainty {
            position_m: 0.0,
            velocity_mps: 2.0,
        },
        ..intruder()
    };
    assert_eq!(trend.expected_radps(&noisy, &BOUNDS), 0.0);
}

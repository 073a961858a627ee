//! One test for each way from state to state.

use fga::Vec3;
use fga::angle::wrap_pi;
use fga::avoider::{Reason, Settings, SettingsError, Start, State};
use fga::mission::{BACK_WITHIN_M, BACK_WITHIN_RAD};
use fga::prediction::Flyer;
use fga::vehicle::Vehicle;

use fga::situation::{Obstacle, ProtectedVolume};

use crate::flight::{Flies as _, Flight, PERIOD_S, planar, sphere, vehicle};
use crate::policies::{POLICIES, Policy, avoider, settings};

impl Flight {
    /// Flies until the decision's state is `state`; returns the number of steps.
    pub(crate) fn until(&mut self, state: State, obstacles: &mut [Obstacle]) -> usize {
        for steps in 0..900 {
            if self.cycle(obstacles).state == state {
                return steps;
            }
        }
        panic!("never {state:?}");
    }

    /// The states of a flight, without repetitions in a row.
    pub(crate) fn states(&mut self, obstacles: &mut [Obstacle], cycles: usize) -> Vec<State> {
        let mut states: Vec<State> = (0..cycles).map(|_| self.cycle(obstacles).state).collect();
        states.dedup();
        states
    }
}

const AHEAD: Vec3 = Vec3::new(200.0, 5.0, 0.0);

fn standing(at: Vec3) -> [fga::situation::Obstacle; 1] {
    [sphere(7, at, Vec3::ZERO, 30.0)]
}

fn flight(start: Start) -> Flight {
    avoider(settings(start), planar())
}

#[test]
fn nothing_around_keeps_the_cruise() {
    let mut flight = flight(Start::Free);
    for _ in 0..50 {
        let decision = flight.cycle(&mut []);
        assert_eq!(decision.state, State::Cruise);
        assert_eq!(decision.record.reason, Reason::Clear);
    }
    assert_eq!(flight.own.position_m.y, 0.0);
}

#[test]
fn a_late_start_waits_avoids_comes_back_and_cruises() {
    let mut flight = flight(Start::Latest);
    let mut obstacles = standing(AHEAD);
    let states = flight.states(&mut obstacles, 400);
    let expected = [
        State::Threatened,
        State::Avoiding,
        State::Recovering,
        State::Cruise,
    ];
    assert_eq!(states, expected);
    assert!(flight.own.position_m.y.abs() < 1.0);
}

#[test]
fn a_start_at_detection_does_not_wait() {
    let mut flight = flight(Start::AtDetection);
    let decision = flight.cycle(&mut standing(AHEAD));
    assert_eq!(decision.state, State::Avoiding);
    assert_eq!(decision.record.reason, Reason::ManeuverChosen);
    assert_eq!(decision.record.threat.map(|threat| threat.id), Some(7));
}

#[test]
fn a_threat_that_vanishes_before_the_start_is_forgotten() {
    let mut flight = flight(Start::Latest);
    let mut obstacles = standing(AHEAD);
    flight.until(State::Threatened, &mut obstacles);
    obstacles[0].position_m = Vec3::new(200.0, 250.0, 0.0);
    let mut state = State::Threatened;
    for _ in 0..100 {
        state = flight.cycle(&mut obstacles).state;
        assert_ne!(state, State::Recovering);
    }
    // The plan may continue to its start, but no further.
    let states = flight.states(&mut [], 300);
    assert_eq!(states.last(), Some(&State::Cruise), "{state:?} {states:?}");
    assert!(flight.own.position_m.y.abs() < 1.0);
}

#[test]
fn an_obstacle_that_vanishes_during_the_manoeuvre_lets_it_come_back() {
    let mut flight = flight(Start::AtDetection);
    flight.until(State::Avoiding, &mut standing(AHEAD));
    for _ in 0..20 {
        flight.cycle(&mut standing(AHEAD));
    }
    assert!(flight.own.position_m.y.abs() > 1.0, "{:?}", flight.own);
    let steps = flight.until(State::Recovering, &mut []);
    assert!(steps < 60, "{steps}");
    flight.until(State::Cruise, &mut []);
    assert!(flight.own.position_m.y.abs() < 1.0);
}

/// The aircraft turns more slowly than its vehicle, or the wind is another one: at the planned end of the way back it is beside its leg.
#[test]
fn the_aircraft_is_back_by_its_position_and_course() {
    let mut late = 0;
    for (wider, drift_mps) in [(1.0, 0.0), (1.5, 0.0), (1.0, 3.0), (1.0, -3.0), (1.5, 3.0)] {
        let mut flight = flight(Start::AtDetection);
        flight.flyer = Flyer::new(&Vehicle {
            turn_radius_m: wider * planar().turn_radius_m,
            ..planar()
        });
        let (mut obstacles, mut was_away, mut planned_s) = (standing(AHEAD), false, f64::INFINITY);
        let mut rejoined = 0;
        for _ in 0..600 {
            let (own, time_s) = (flight.own, flight.time_s);
            let decision = flight.cycle(&mut obstacles);
            flight.own.position_m.y += drift_mps * PERIOD_S;
            let is_away = matches!(decision.state, State::Avoiding | State::Recovering);
            if decision.record.reason == Reason::RejoinKept && decision.command.proof().is_none() {
                // On the way back without a plan any more.
                planned_s = planned_s.min(time_s);
            }
            if was_away && !is_away {
                let off_rad = wrap_pi(own.course_rad).abs();
                assert!(own.position_m.y.abs() <= BACK_WITHIN_M, "{own:?}");
                assert!(off_rad <= BACK_WITHIN_RAD, "{own:?}");
                assert_eq!(decision.record.reason, Reason::Rejoined);
                rejoined += 1;
                late += u32::from(time_s > planned_s);
            }
            was_away = is_away;
        }
        assert_eq!((rejoined, was_away), (1, false), "{wider} {drift_mps}");
    }
    assert!(late > 0, "no flight shows it");
}

#[test]
fn a_new_threat_on_the_way_back_is_avoided() {
    let mut flight = flight(Start::AtDetection);
    let mut obstacles = standing(AHEAD).to_vec();
    flight.until(State::Recovering, &mut obstacles);
    let on_the_way = flight.own.position_m + Vec3::new(110.0, 0.0, 0.0);
    obstacles.push(sphere(
        8,
        Vec3::new(on_the_way.x, 0.0, 0.0),
        Vec3::ZERO,
        30.0,
    ));
    let decision = flight.cycle(&mut obstacles);
    assert_ne!(decision.state, State::Recovering);
    assert_eq!(decision.record.threat.map(|threat| threat.id), Some(8));
    let mut least_m = f64::INFINITY;
    for _ in 0..400 {
        flight.cycle(&mut obstacles);
        least_m = obstacles
            .iter()
            .map(|o| (o.position_m - flight.own.position_m).length())
            .fold(least_m, f64::min);
    }
    assert!(least_m >= 30.0, "{least_m}");
    assert!(flight.own.position_m.y.abs() < 1.0);
}

#[test]
fn a_manoeuvre_is_kept_only_while_everything_goes_as_it_was_certified() {
    // A flight without noise keeps its certificate by comparison. One in which every position is off
    // by less than a hair certifies again each cycle: both must keep the manoeuvre.
    let reasons = |hair_m: f64| {
        let mut flight = flight(Start::AtDetection);
        let mut obstacles = [sphere(7, AHEAD, Vec3::new(-10.0, 2.0, 0.0), 30.0)];
        let mut reasons = Vec::new();
        for cycle in 0..200 {
            let side = if cycle % 2 == 0 { 1.0 } else { -1.0 };
            let decision = flight.cycle(&mut obstacles);
            obstacles[0].position_m.y += side * hair_m;
            reasons.push(decision.record.reason);
        }
        reasons
    };
    assert_eq!(reasons(0.0), reasons(1e-5));
    // Any change is noticed at once, however recent the last certificate.
    let moves: [fn(&mut Flight, &mut Obstacle); 4] = [
        |flight, obstacle| {
            obstacle.position_m = flight.own.position_m + flight.own.velocity_mps() * 4.0;
        },
        |flight, obstacle| {
            let back = flight.own.position_m + flight.own.velocity_mps() * 6.0;
            obstacle.velocity_mps = (back - obstacle.position_m) / 6.0;
        },
        |_, obstacle| obstacle.volume = ProtectedVolume::Sphere { radius_m: 60.0 },
        |flight, _| flight.own.course_rad = 0.5,
    ];
    for (place, change) in moves.into_iter().enumerate() {
        let mut flight = flight(Start::AtDetection);
        let mut obstacles = standing(AHEAD);
        flight.until(State::Avoiding, &mut obstacles);
        for _ in 0..3 {
            let kept = flight.cycle(&mut obstacles);
            assert_eq!(kept.record.reason, Reason::ManeuverKept);
        }
        change(&mut flight, &mut obstacles[0]);
        let next = flight.cycle(&mut obstacles);
        assert_ne!(next.record.reason, Reason::ManeuverKept, "change {place}");
    }
}

#[test]
fn a_second_flight_starts_over() {
    let mut first = flight(Start::Latest);
    first.until(State::Avoiding, &mut standing(AHEAD));
    assert_starts_over(first, flight(Start::Latest));
}

/// An earlier version kept the rolls from the bank of the last flight, and counted other work in the next one.
#[test]
fn a_second_flight_of_a_lagged_vehicle_counts_the_same_work() {
    let begins = || {
        let mut lagged = planar();
        lagged.response.bank_time_constant_s = 0.5;
        let mut flight = avoider(settings(Start::AtDetection), lagged);
        flight.own.bank_rad = 0.3;
        flight
    };
    let mut first = begins();
    first.until(State::Avoiding, &mut standing(AHEAD));
    assert_starts_over(first, begins());
}

fn assert_starts_over(mut first: Flight, mut fresh: Flight) {
    first.pilot.restart();
    (first.own, first.time_s) = (fresh.own, fresh.time_s);
    let (mut around, mut again) = (standing(AHEAD), standing(AHEAD));
    for _ in 0..300 {
        assert_eq!(first.cycle(&mut around), fresh.cycle(&mut again));
    }
}

#[test]
fn a_clock_that_jumps_back_starts_over() {
    let mut flight = flight(Start::Latest);
    flight.time_s = 1000.0;
    flight.until(State::Avoiding, &mut standing(AHEAD));
    flight.time_s = 3.0;
    let clear = flight.cycle(&mut []);
    assert_eq!(clear.state, State::Cruise);
    assert_eq!(clear.record.reason, Reason::Clear);
    flight.time_s = 1.0;
    let again = flight.cycle(&mut standing(flight.own.position_m + AHEAD));
    assert!(again.record.threat.is_some());
    assert!(again.record.start_s.is_some_and(|start_s| start_s < 60.0));
}

#[test]
fn unusable_input_holds_and_changes_nothing() {
    let mut flight = flight(Start::Latest);
    let mut obstacles = standing(AHEAD);
    flight.until(State::Avoiding, &mut obstacles);
    let good = (flight.own, flight.time_s);
    for field in 0..6 {
        let wrong = [f64::NAN, f64::INFINITY][field % 2];
        match field {
            0 => flight.own.position_m.z = wrong,
            1 => flight.own.course_rad = wrong,
            2 => flight.own.climb_rad = wrong,
            3 => flight.own.airspeed_mps = wrong,
            4 => flight.own.airspeed_mps = 0.0,
            _ => flight.time_s = wrong,
        }
        let decision = flight.decide(&obstacles);
        assert_eq!(decision.record.reason, Reason::InvalidInput, "{field}");
        assert_eq!(decision.state, State::Avoiding);
        assert!(decision.command.stages().is_empty());
        (flight.own, flight.time_s) = good;
    }
    let decision = flight.decide(&obstacles);
    assert_eq!(decision.state, State::Avoiding);
    assert_ne!(decision.record.reason, Reason::InvalidInput);
}

#[test]
fn n10_an_obstacle_with_unusable_numbers_is_left_out_and_counted() {
    for policy in POLICIES {
        let mut plain = policy.flight(vehicle(), 1.0, 300.0);
        let mut spoiled = policy.flight(vehicle(), 1.0, 300.0);
        let mut with = standing(AHEAD).to_vec();
        with.insert(
            0,
            sphere(1, Vec3::new(f64::NAN, 0.0, 0.0), Vec3::ZERO, 30.0),
        );
        with.push(sphere(
            2,
            Vec3::X * 100.0,
            Vec3::Y * f64::NEG_INFINITY,
            30.0,
        ));
        with.push(sphere(3, Vec3::X * 100.0, Vec3::ZERO, -1.0));
        with.push(sphere(4, Vec3::X * 100.0, Vec3::ZERO, f64::NAN));
        for _ in 0..20 {
            let clean = plain.cycle(&mut standing(AHEAD));
            let mut found = spoiled.cycle(&mut with.clone());
            let unusable = core::mem::take(&mut found.record.work.unusable);
            assert_eq!(found, clean, "{policy:?}");
            assert_eq!(unusable, if policy == Policy::Mission { 0 } else { 4 });
        }
    }
}

#[test]
fn inside_a_volume_it_leaves() {
    for start in [Start::Free, Start::AtDetection, Start::Latest] {
        let mut flight = avoider(settings(start), vehicle());
        let mut obstacles = standing(Vec3::new(10.0, 12.0, 0.0));
        let decision = flight.cycle(&mut obstacles);
        assert_eq!(decision.state, State::Avoiding);
        assert_eq!(decision.record.reason, Reason::InsideVolume);
        let states = flight.states(&mut obstacles, 300);
        assert_eq!(states.last(), Some(&State::Cruise), "{states:?}");
        let distance_m = (flight.own.position_m - obstacles[0].position_m).length();
        assert!(distance_m > 30.0, "{distance_m}");
    }
}

#[test]
fn limits_and_settings_that_are_not_numbers_are_refused() {
    let refused = |change: &dyn Fn(&mut fga::avoider::Settings, &mut fga::vehicle::Vehicle)| {
        let (mut settings, mut vehicle) = (settings(Start::Free), vehicle());
        change(&mut settings, &mut vehicle);
        let error: SettingsError = fga::avoider::Avoider::new(settings, vehicle).unwrap_err();
        error.name
    };
    assert_eq!(refused(&|s, _| s.horizon_s = f64::INFINITY), "horizon_s");
    assert_eq!(refused(&|s, _| s.margin_m = f64::NAN), "margin_m");
    assert_eq!(
        refused(&|s, _| s.surveillance_radius_m = f64::NAN),
        "surveillance_radius_m"
    );
    assert_eq!(refused(&|_, v| v.airspeed_mps = f64::NAN), "airspeed_mps");
    assert_eq!(
        refused(&|_, v| v.turn_radius_m = f64::INFINITY),
        "turn_radius_m"
    );
    assert_eq!(refused(&|_, v| v.climb_max_rad = f64::NAN), "climb_max_rad");
    assert_eq!(refused(&|s, _| s.start = Start::Score(f64::NAN)), "C_s");
}

/// A floor, a ceiling and posts to either side leave only a descent that levels off.
#[test]
fn between_floor_and_ceiling_it_descends_and_levels_off() {
    let cylinder = |id, position_m, velocity_mps, radius_m, half_height_m| {
        let volume = ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        };
        Obstacle::straight(id, position_m, velocity_mps, volume)
    };
    let layer = |id, z_m| cylinder(id, Vec3::Z * z_m, Vec3::ZERO, 1e5, 2000.0);
    let oncoming = Vec3::new(600.0, 0.0, -10.0);
    let mut obstacles = vec![
        cylinder(1, oncoming, -15.0 * Vec3::X, 40.0, 30.0),
        layer(2, 2015.0),
        layer(3, -2080.0),
    ];
    for k in 0..20_u32 {
        let x_m = 40.0 * f64::from(k) - 100.0;
        for (side, y_m) in [(0, -35.0), (1, 35.0)] {
            let post = cylinder(
                10 + 2 * k + side,
                Vec3::new(x_m, y_m, 0.0),
                Vec3::ZERO,
                20.0,
                300.0,
            );
            obstacles.push(post);
        }
    }
    // A layer's centre is far away.
    let settings = Settings {
        surveillance_radius_m: f64::INFINITY,
        ..settings(Start::Free)
    };
    let mut flight = avoider(settings, vehicle());
    let mut lowest_m = 0.0_f64;
    for _ in 0..600 {
        flight.cycle(&mut obstacles);
        lowest_m = lowest_m.min(flight.own.position_m.z);
        for obstacle in &obstacles {
            let offset_m = flight.own.position_m - obstacle.position_m;
            assert!(obstacle.volume.margin_m(offset_m) > 0.0, "{obstacle:?}");
        }
    }
    assert!(lowest_m < -40.0, "{lowest_m}");
    assert!(flight.own.position_m.z.abs() < 1.0);
}

/// A wide obstacle at rest, a little to the left: the way back is long.
fn wide() -> [Obstacle; 1] {
    [sphere(7, Vec3::new(700.0, 5.0, 0.0), Vec3::ZERO, 160.0)]
}

/// An earlier version turned onto the mission at the planned moment, up to 46 m beyond it.
#[test]
fn an_aircraft_that_is_faster_than_planned_does_not_fly_past_the_mission_on_its_way_back() {
    let mut flight = flight(Start::Free);
    let mut obstacles = wide();
    flight.until(State::Recovering, &mut obstacles);
    let side = flight.own.position_m.y.signum();
    let (mut past_m, mut cycles) = (0.0_f64, 0);
    loop {
        let state = flight.cycle(&mut obstacles).state;
        let (sin, cos) = flight.own.course_rad.sin_cos();
        let faster_m = 0.1 * flight.own.airspeed_mps * PERIOD_S;
        flight.own.position_m += Vec3::new(cos, sin, 0.0) * faster_m;
        past_m = past_m.max(-side * flight.own.position_m.y);
        cycles += 1;
        if state == State::Cruise && cycles > 10 {
            break;
        }
        assert!(cycles < 900);
    }
    assert!(past_m < 5.0, "{past_m} m beyond the mission");
}

/// Work of the searches of a flight between two obstacles that each let it pass and together do not, and the number of
/// searches.
fn spent_on_the_hopeless(aside_m: f64, lag_s: f64) -> (u32, usize) {
    let mut vehicle = vehicle();
    vehicle.response.bank_time_constant_s = lag_s;
    let mut flight = avoider(settings(Start::Free), vehicle);
    let closing_mps = Vec3::new(-40.0, 0.0, 0.0);
    let mut obstacles = [
        sphere(1, Vec3::new(125.0, aside_m, 0.0), closing_mps, 30.0),
        sphere(2, Vec3::new(125.0, -aside_m, 0.0), closing_mps, 30.0),
    ];
    let works: Vec<u32> = (0..22)
        .map(|_| flight.cycle(&mut obstacles).record.work)
        .filter(|work| work.candidates > 0)
        .map(|work| work.work)
        .collect();
    (works.iter().sum(), works.len())
}

#[test]
fn what_cannot_succeed_is_soon_given_up() {
    for lag_s in [0.0, 0.6] {
        for aside_m in [20.0, 24.0, 27.0] {
            let (work, searches) = spent_on_the_hopeless(aside_m, lag_s);
            // Where little is missing, each of the four parts of the two-turn rows may take a cycle; then each tenth cycle looks
            // again, twice here.
            // Searches in each cycle are 16 and take up to 1.2 million units.
            assert!(searches <= 6, "{lag_s} s, {aside_m} m: {searches} searches");
            assert!(work <= 380_000, "{lag_s} s, {aside_m} m: {work} of work");
        }
    }
}

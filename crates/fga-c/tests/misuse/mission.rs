//! A mission that is replaced in flight is flown, whatever was flown before.

use core::ptr::null_mut;

use fga_c::*;

use crate::flight::{Flight, Unit, mast, situation, vehicle};

/// An aircraft that flies what its avoider decides.
struct Flown {
    flight: Flight,
    /// Where its prover lies.
    _storage: Vec<Unit>,
    prover: *mut fga_prover,
    own: fga_ownship,
    time_s: f64,
}

/// Waypoints at 100 m: east and north, metres.
fn waypoints<const COUNT: usize>(of: [(f64, f64); COUNT]) -> [fga_waypoint; COUNT] {
    of.map(|(east, north)| fga_waypoint {
        position_m: fga_enu {
            east,
            north,
            up: 100.0,
        },
        passing: fga_passing::FlyBy as u32,
    })
}

const EAST: [(f64, f64); 2] = [(0.0, 0.0), (600.0, 0.0)];
const NORTH: [(f64, f64); 2] = [(0.0, 0.0), (0.0, 3000.0)];

impl Flown {
    /// At the origin, to the east, without a mission.
    fn new() -> Self {
        let mut storage = vec![Unit([0; FGA_ALIGN]); FGA_PROVER_BYTES.div_ceil(FGA_ALIGN)];
        let mut prover = null_mut();
        // SAFETY: right pointers.
        let status = unsafe {
            fga_prover_init(
                storage.as_mut_ptr().cast(),
                FGA_PROVER_BYTES,
                FGA_ABI_VERSION,
                &vehicle(),
                &raw mut prover,
                null_mut(),
            )
        };
        assert_eq!(status, fga_status::Ok);
        let mut flown = Self {
            flight: Flight::with_room(2, 3),
            _storage: storage,
            prover,
            own: situation(0.0, &[]).ownship,
            time_s: 0.0,
        };
        flown.set(&[]);
        flown
    }

    fn set(&mut self, mission: &[fga_waypoint]) {
        let status = self.flight.set_mission(mission, f64::NEG_INFINITY);
        assert_eq!(status, fga_status::Ok);
    }

    /// Flies for a time; the last decision.
    fn fly(&mut self, for_s: f64, obstacles: &[fga_obstacle]) -> fga_decision {
        let end_s = self.time_s + for_s;
        loop {
            let now = fga_situation {
                time_s: self.time_s,
                ownship: self.own,
                ..situation(0.0, obstacles)
            };
            let (status, decision) = self.flight.step_with(&now);
            assert_eq!(status, fga_status::Ok);
            if self.time_s >= end_s {
                return decision;
            }
            let mut then = self.own;
            // SAFETY: right pointers.
            let status = unsafe {
                fga_predict(
                    self.prover,
                    &raw const self.own,
                    decision.stages.as_ptr(),
                    decision.stage_count,
                    now.wind_mps,
                    0.1,
                    &raw mut then,
                    null_mut(),
                )
            };
            assert_eq!(status, fga_status::Ok);
            self.own = then;
            self.time_s += 0.1;
        }
    }

    /// Whether it flies along a leg to the north, and its last decision.
    fn is_northward(&mut self) -> bool {
        let decision = self.fly(100.0, &[]);
        let at_m = self.own.position_m;
        let off_rad = self.own.course_from_east_rad - core::f64::consts::FRAC_PI_2;
        decision.reason == fga_reason::Clear
            && decision.state == fga_state::Cruise
            && at_m.east.abs() < 1.0
            && off_rad.sin().abs() < 0.02
            && off_rad.cos() > 0.0
    }
}

#[test]
fn a_mission_set_after_a_step_without_one_is_flown() {
    let mut flown = Flown::new();
    assert_eq!(flown.fly(1.0, &[]).reason, fga_reason::MissionComplete);
    flown.set(&waypoints(NORTH));
    assert!(flown.is_northward());
}

#[test]
fn a_mission_set_after_a_finished_one_is_flown() {
    let mut flown = Flown::new();
    flown.set(&waypoints(EAST));
    assert_eq!(flown.fly(45.0, &[]).reason, fga_reason::MissionComplete);
    flown.set(&waypoints(NORTH));
    assert!(flown.is_northward());
}

#[test]
fn a_mission_set_on_a_leg_of_another_is_flown() {
    let mut flown = Flown::new();
    flown.set(&waypoints([(0.0, 0.0), (5000.0, 0.0)]));
    assert_eq!(flown.fly(10.0, &[]).reason, fga_reason::Clear);
    flown.set(&waypoints(NORTH));
    assert!(flown.is_northward());
}

/// Half of a command's period, then the rest of it as a command that is half a period old: where the whole leads in one.
#[test]
fn a_command_that_is_under_way_is_predicted_by_its_age() {
    let flown = Flown::new();
    let stage = |start_s, course_from_east_rad| fga_stage {
        start_s,
        course_from_east_rad,
        climb_rad: 0.0,
        rate_share: 1.0,
    };
    let predict = |own: &fga_ownship, age_s: f64, after_s: f64| {
        let stages = [stage(0.0, 1.0), stage(0.6, -0.5), stage(3.0, 0.2)].map(|at| fga_stage {
            start_s: at.start_s - age_s,
            ..at
        });
        let mut then = *own;
        // SAFETY: right pointers.
        let status = unsafe {
            fga_predict(
                flown.prover,
                own,
                stages.as_ptr(),
                3,
                situation(0.0, &[]).wind_mps,
                after_s,
                &raw mut then,
                null_mut(),
            )
        };
        assert_eq!(status, fga_status::Ok);
        then
    };
    let whole = predict(&flown.own, 0.0, 9.0);
    for age_s in [0.1, 0.6, 1.0, 4.0] {
        let rest = predict(&predict(&flown.own, 0.0, age_s), age_s, 9.0 - age_s);
        let [to, also] = [whole.position_m, rest.position_m];
        assert!(
            (to.east - also.east).hypot(to.north - also.north) < 1e-6,
            "{age_s}"
        );
        assert!((whole.course_from_east_rad - rest.course_from_east_rad).abs() < 1e-9);
    }
}

/// Its first leg ends 50 m behind the aircraft.
#[test]
fn a_first_leg_that_lies_behind_is_flown_from_its_beginning() {
    let mut flown = Flown::new();
    flown.set(&waypoints(EAST));
    flown.fly(43.5, &[]);
    flown.set(
        &waypoints([(0.0, 0.0), (600.0, 0.0), (600.0, 900.0)]).map(|waypoint| fga_waypoint {
            passing: fga_passing::FlyOver as u32,
            ..waypoint
        }),
    );
    let (mut legs, mut least_m) = (Vec::new(), [f64::INFINITY; 2]);
    for _ in 0..2_000 {
        let decision = flown.fly(0.1, &[]);
        if legs.last() != Some(&decision.leg_index) {
            legs.push(decision.leg_index);
        }
        let at_m = flown.own.position_m;
        for (least_m, end) in least_m.iter_mut().zip([0.0, 600.0]) {
            *least_m = least_m.min((at_m.east - end).hypot(at_m.north));
        }
    }
    assert_eq!(legs, [0, 1, 2]);
    assert!(
        least_m.into_iter().all(|least_m| least_m < 6.0),
        "{least_m:?}"
    );
}

/// In cruise, past the end, and in a manoeuvre: the commands are those of a flight on which nothing was set.
#[test]
fn the_same_mission_again_changes_nothing() {
    let east = waypoints(EAST);
    let [mut once, mut always] = [Flown::new(), Flown::new()];
    once.set(&east);
    let mut states = Vec::new();
    for _ in 0..500 {
        always.set(&east);
        let rows = [mast(1, 300.0, 4.0)];
        let [one, other] = [&mut once, &mut always].map(|flown| flown.fly(0.1, &rows));
        assert_eq!(one.stage_count, other.stage_count);
        assert_eq!(
            (one.state, one.reason, one.leg_index),
            (other.state, other.reason, other.leg_index)
        );
        states.push(one.state);
    }
    let [one, other] = [&once, &always].map(|flown| flown.own.position_m);
    assert_eq!((one.east, one.north), (other.east, other.north));
    assert!(states.contains(&fga_state::Avoiding) && states.contains(&fga_state::Recovering));
}

/// A third waypoint is appended on the last leg, or after it.
#[test]
fn what_is_appended_is_flown_from_where_the_aircraft_is() {
    for after_s in [20.0, 43.0] {
        let mut flown = Flown::new();
        flown.set(&waypoints(EAST));
        flown.fly(after_s, &[]);
        flown.set(&waypoints([EAST[0], EAST[1], (600.0, 3000.0)]));
        assert_eq!(flown.fly(0.1, &[]).leg_index, u32::from(after_s > 40.0));
        flown.fly(90.0, &[]);
        let at_m = flown.own.position_m;
        assert!(
            (at_m.east - 600.0).abs() < 1.0 && at_m.north > 500.0,
            "{after_s}"
        );
    }
}

/// The manoeuvre about a mast goes on, and then leads to the other mission.
#[test]
fn a_mission_replaced_in_a_manoeuvre_is_what_it_leads_back_to() {
    let mut flown = Flown::new();
    flown.set(&waypoints([(0.0, 0.0), (5000.0, 0.0)]));
    let rows = [mast(1, 300.0, 4.0)];
    while flown.fly(0.1, &rows).state != fga_state::Avoiding {}
    flown.set(&waypoints(NORTH));
    let mut least_m = f64::INFINITY;
    for step in 0..900 {
        let decision = flown.fly(0.1, &rows);
        assert!(step > 0 || decision.state != fga_state::Cruise);
        let at_m = flown.own.position_m;
        least_m = least_m.min((at_m.east - 300.0).hypot(at_m.north - 4.0));
    }
    assert!(least_m >= 30.0 && flown.is_northward(), "{least_m}");
}

//! Beliefs: what is refused, what is counted, and that a step on them decides as Rust does.

use core::ptr::{null, null_mut};

use fga::Vec3;
use fga::avoider::belief::{BeliefDecider, Errors, Report, Sigma, Source};
use fga::avoider::{Avoider, Decision, Settings};
use fga::situation::{
    Mission, MovementBounds, Obstacles, Ownship, Passing, ProtectedVolume, Situation,
};
use fga::vehicle::Vehicle;
use fga_c::*;

use crate::flight::{Flight, Unit, mast, situation, sized, words};

/// Beliefs about aircraft with volumes of 100 m.
struct Believer {
    storage: Vec<Unit>,
    beliefs: *mut fga_beliefs,
    why: fga_refusal,
}

const HERE: fga_enu = fga_enu {
    east: 0.0,
    north: 0.0,
    up: 100.0,
};

impl Believer {
    fn new() -> Self {
        let mut believer = Self {
            storage: vec![Unit([0; FGA_ALIGN]); fga_beliefs_size().div_ceil(FGA_ALIGN)],
            beliefs: null_mut(),
            why: sized(),
        };
        let status = believer.init(FGA_ABI_VERSION, fga_beliefs_size());
        assert_eq!(status, fga_status::Ok);
        believer
    }

    fn init(&mut self, version: u32, bytes: usize) -> fga_status {
        let storage = self.storage.as_mut_ptr().cast();
        let (beliefs, why) = (&raw mut self.beliefs, &raw mut self.why);
        // SAFETY: right pointers; the storage is not smaller than `bytes` where these suffice.
        unsafe { fga_beliefs_init(storage, bytes, version, beliefs, why) }
    }

    fn hear(&mut self, report: &fga_report, radius_m: f64, now_s: f64) -> fga_status {
        let why = &raw mut self.why;
        // SAFETY: right pointers.
        unsafe { fga_beliefs_hear(self.beliefs, report, radius_m, 0.0, now_s, HERE, why) }
    }

    fn counts(&self) -> [u32; 4] {
        let mut counts: fga_report_counts = sized();
        // SAFETY: right pointers.
        let status = unsafe { fga_beliefs_counts(self.beliefs, &raw mut counts) };
        assert_eq!(status, fga_status::Ok);
        [counts.heard, counts.unusable, counts.late, counts.left_out]
    }
}

/// An aircraft that comes from the east.
fn report(id: u32, time_s: f64, east: f64) -> fga_report {
    let mut report = fga_report {
        id,
        movement: fga_movement::Crewed as u32,
        has_velocity: 1,
        time_s,
        position_m: fga_enu { east, ..HERE },
        velocity_mps: fga_enu {
            east: -30.0,
            north: 0.0,
            up: 0.0,
        },
        ..sized()
    };
    // SAFETY: a right pointer.
    let status = unsafe { fga_report_set_adsb(&raw mut report, 9, 2) };
    assert_eq!(status, fga_status::Ok);
    report
}

#[test]
fn unusable_reports_are_refused_with_their_name_and_counted() {
    type Change = fn(&mut fga_report);
    let rows: [(Change, f64, &str, fga_status); 5] = [
        (
            |r| r.movement = 2,
            1.0,
            "movement",
            fga_status::UnknownValue,
        ),
        (
            |r| r.movement = 5,
            1.0,
            "movement",
            fga_status::UnknownValue,
        ),
        (|r| r.time_s = 102.0, 1.0, "time_s", fga_status::OutOfRange),
        (
            |r| r.lasting_altitude_sigma_m = f64::NAN,
            1.0,
            "lasting_altitude_sigma_m",
            fga_status::OutOfRange,
        ),
        (|_| {}, -1.0, "radius_m", fga_status::OutOfRange),
    ];
    let mut believer = Believer::new();
    for (change, radius_m, field, status) in rows {
        let mut wrong = report(1, 100.0, 500.0);
        change(&mut wrong);
        assert_eq!(believer.hear(&wrong, radius_m, 100.0), status, "{field}");
        assert_eq!(words(&believer.why).0, field);
    }
    assert_eq!(believer.counts(), [5, 5, 0, 0]);
}

#[test]
fn late_reports_and_those_without_room_are_counted() {
    let mut believer = Believer::new();
    for id in 0..16 {
        let one = report(id, 100.0, 1000.0 + f64::from(id));
        assert_eq!(believer.hear(&one, 100.0, 100.0), fga_status::Ok);
        assert_eq!(believer.hear(&one, 100.0, 100.0), fga_status::Ok);
    }
    let far = report(16, 100.0, 2000.0);
    assert_eq!(believer.hear(&far, 100.0, 100.0), fga_status::Incomplete);
    let near = report(17, 100.0, 900.0);
    assert_eq!(believer.hear(&near, 100.0, 100.0), fga_status::Incomplete);
    let old = report(18, 91.0, 100.0);
    assert_eq!(believer.hear(&old, 100.0, 100.0), fga_status::Ok);
    assert_eq!(believer.counts(), [35, 0, 17, 2]);
    // What is left out may be met: nothing is claimed of all aircraft, for as long as it may be around.
    let mut flight = Flight::new(2);
    for (time_s, is_left_out) in [(100.1, true), (109.0, false)] {
        if !is_left_out {
            let one = report(17, time_s, 600.0);
            assert_eq!(believer.hear(&one, 100.0, time_s), fga_status::Ok);
        }
        let (status, decision) = step(&mut flight, &believer, time_s);
        assert_eq!(status == fga_status::Incomplete, is_left_out, "{time_s}");
        assert_eq!(decision.work_limit_met == 1, is_left_out, "{time_s}");
        let has_share = decision.has & FGA_HAS_PROVEN_SHARE != 0;
        assert!(!(is_left_out && has_share), "{time_s}");
    }
}

/// Six masts are all that is weighed, and an aircraft far behind is believed to be there: the mast ahead is avoided.
#[test]
fn masts_are_avoided_beside_a_far_aircraft() {
    let (mut believer, mut flight) = (Believer::new(), Flight::new(20));
    let far = report(9, 100.0, -9000.0);
    assert_eq!(believer.hear(&far, 100.0, 100.0), fga_status::Ok);
    let masts = [0.0, 200.0, -200.0, 220.0, -220.0, 240.0]
        .map(|north| mast(10, 300.0, north))
        .into_iter()
        .zip(10..)
        .map(|(mast, id)| fga_obstacle { id, ..mast });
    let masts: Vec<_> = masts.collect();
    let mut now = situation(0.0, &masts);
    now.time_s = 100.1;
    let (status, decision) = step_in(&mut flight, &believer, &now);
    assert_eq!(status, fga_status::Ok);
    assert!(decision.p_loss_hold > 0.9, "{}", decision.p_loss_hold);
    assert_ne!(decision.state, fga_state::Cruise);
}

/// The avoider has no room for the aircraft: nothing is claimed of it.
#[test]
fn who_finds_no_room_in_the_avoider_is_told() {
    let (mut believer, mut flight) = (Believer::new(), Flight::new(0));
    let near = report(7, 100.0, 600.0);
    assert_eq!(believer.hear(&near, 100.0, 100.0), fga_status::Ok);
    let (status, decision) = step(&mut flight, &believer, 100.1);
    assert_eq!(status, fga_status::Incomplete);
    assert_eq!(decision.has & FGA_HAS_PROVEN_SHARE, 0);
    assert_eq!(flight.counts().incomplete_steps, 1);
}

/// A report of a later clock, which was set back since, does not keep an aircraft where it was.
#[test]
fn a_clock_that_was_set_back_freezes_nobody() {
    let (mut believer, mut flight) = (Believer::new(), Flight::new(2));
    let later = report(7, 5000.0, 3000.0);
    assert_eq!(believer.hear(&later, 100.0, 5000.0), fga_status::Ok);
    step(&mut flight, &believer, 100.0);
    for second in 1..4_u32 {
        let time_s = 100.0 + f64::from(second);
        let now = report(7, time_s, 400.0 - 30.0 * (time_s - 100.0));
        assert_eq!(believer.hear(&now, 100.0, time_s), fga_status::Ok);
        let (_, decision) = step(&mut flight, &believer, time_s);
        assert!(decision.p_loss_hold > 0.5, "{time_s}");
    }
    assert_eq!(believer.counts(), [4, 0, 0, 0]);
}

/// A step of a flight that began at 100 s.
fn step(flight: &mut Flight, believer: &Believer, time_s: f64) -> (fga_status, fga_decision) {
    let mut now = situation(time_s - 100.0, &[]);
    now.time_s = time_s;
    step_in(flight, believer, &now)
}

fn step_in(
    flight: &mut Flight,
    believer: &Believer,
    now: &fga_situation,
) -> (fga_status, fga_decision) {
    let mut decision = sized();
    // SAFETY: right pointers.
    let status = unsafe {
        let (decision, why) = (&raw mut decision, &raw mut flight.why);
        fga_avoider_step_on_beliefs(flight.avoider, believer.beliefs, now, decision, why)
    };
    (status, decision)
}

/// The same numbers as in Rust, to the last bit: what is flown, the chances, and what is proven.
#[test]
fn a_step_on_beliefs_is_that_of_rust() {
    let (mut believer, mut flight) = (Believer::new(), Flight::new(2));
    let vehicle = Vehicle::from_bank(15.0, 0.7).unwrap();
    let mut avoider = Avoider::new(Settings::default(), vehicle).unwrap();
    let mut decider = BeliefDecider::new(Errors::default());
    let volume = ProtectedVolume::Sphere { radius_m: 100.0 };
    let waypoints_m = [0.0, 1000.0].map(|east| Vec3::new(east, 0.0, 100.0));
    let mut most = 0.0_f64;
    for cycle in 0..200_u32 {
        let time_s = 100.0 + 0.1 * f64::from(cycle);
        if cycle % 10 == 0 {
            let mut of = report(7, time_s - 0.5, 1500.0 - 30.0 * (time_s - 100.5));
            of.position_m.north = if cycle % 20 == 0 { 9.0 } else { -8.0 };
            assert_eq!(believer.hear(&of, 100.0, time_s), fga_status::Ok);
            let errors = Errors {
                lasting_position_m: Sigma::new(0.0, Source::Report),
                ..Errors::of_adsb(9, 2)
            };
            let (at, to) = (of.position_m, of.velocity_mps);
            let report = Report {
                time_s: of.time_s,
                position_m: Vec3::new(at.east, at.north, at.up),
                velocity_mps: Some(Vec3::new(to.east, to.north, to.up)),
                carried_s: 0.0,
                errors,
            };
            let own_m = Vec3::new(HERE.east, HERE.north, HERE.up);
            let heard = decider.hear((7, volume), &report, &MovementBounds::CREWED, own_m);
            assert_eq!(heard, Some(true));
        }
        let (status, decision) = step(&mut flight, &believer, time_s);
        let now = Situation {
            time_s,
            ownship: Ownship {
                position_m: Vec3::new(15.0 * (time_s - 100.0), 0.0, 100.0),
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: 15.0,
            },
            wind_mps: Vec3::ZERO,
            obstacles: Obstacles::Rows(&[]),
            mission: Mission {
                waypoints_m: &waypoints_m,
                passing: &[Passing::FlyBy; 2],
                limits_m: (f64::NEG_INFINITY, f64::INFINITY),
                zones: &[],
                ground: None,
            },
        };
        let mut theirs = Decision::default();
        decider.step_into(&mut avoider, &now, &mut theirs);
        assert_eq!(status, fga_status::Ok);
        let record = &theirs.record;
        most = most.max(decision.p_loss_hold);
        let chances = (decision.has & FGA_HAS_CHANCES != 0)
            .then_some((decision.p_loss_hold, decision.p_loss));
        assert_eq!(chances, record.p_loss_hold.zip(record.p_loss), "{time_s}");
        let share = (decision.has & FGA_HAS_PROVEN_SHARE != 0).then_some(decision.proven_share);
        assert_eq!(share, record.proven_share, "{time_s}");
        let stages = &decision.stages[..decision.stage_count as usize];
        let stages = stages
            .iter()
            .map(|stage| [stage.start_s, stage.course_from_east_rad, stage.climb_rad]);
        let theirs = theirs.command.stages().iter();
        let theirs = theirs.map(|stage| [stage.start_s, stage.course_rad, stage.climb_rad]);
        assert!(stages.eq(theirs), "{time_s}");
    }
    assert!(most > 0.5, "{most}");
}

#[test]
fn wrong_storage_versions_and_pointers_are_refused() {
    let mut believer = Believer::new();
    let bytes = fga_beliefs_size();
    assert_eq!(bytes, FGA_BELIEFS_BYTES);
    for (version, bytes, status) in [
        (2, bytes, fga_status::WrongVersion),
        (FGA_ABI_VERSION, bytes - 1, fga_status::StorageTooSmall),
    ] {
        assert_eq!(believer.init(version, bytes), status);
    }
    let (mut believer, flight) = (Believer::new(), Flight::new(2));
    let (now, why) = (situation(0.0, &[]), null_mut());
    let mut decision: fga_decision = sized();
    let (now, place) = (&raw const now, &raw mut decision);
    let right = report(1, 0.0, 1.0);
    let mut elsewhere = vec![Unit([0; FGA_ALIGN]); bytes.div_ceil(FGA_ALIGN)];
    let wrong = elsewhere.as_mut_ptr().cast::<fga_beliefs>();
    let beliefs = believer.beliefs;
    let storage = believer.storage.as_mut_ptr();
    // SAFETY: each pointer is null or leads to what its type says; what is wrong about the others is found.
    unsafe {
        let hear =
            |beliefs, report| fga_beliefs_hear(beliefs, report, 1.0, 0.0, 0.0, HERE, null_mut());
        assert_eq!(hear(null_mut(), &raw const right), fga_status::Null);
        assert_eq!(hear(beliefs, null()), fga_status::Null);
        assert_eq!(hear(wrong, &raw const right), fga_status::NotInitialized);
        let step = |beliefs, decision| {
            fga_avoider_step_on_beliefs(flight.avoider, beliefs, now, decision, why)
        };
        assert_eq!(step(null_mut(), place), fga_status::Null);
        assert_eq!(step(wrong, place), fga_status::NotInitialized);
        assert_eq!(step(beliefs, null_mut()), fga_status::Null);
        let within = storage.add(64).cast::<fga_decision>();
        within.cast::<u32>().write(decision.size);
        assert_eq!(step(beliefs, within), fga_status::Aliased);
        assert_eq!(step(beliefs, place), fga_status::Ok);
        assert_eq!(fga_beliefs_counts(beliefs, null_mut()), fga_status::Null);
        assert_eq!(fga_beliefs_restart(null_mut()), fga_status::Null);
        assert_eq!(fga_report_set_adsb(null_mut(), 8, 1), fga_status::Null);
    }
}

//! Each misuse has its status, a right program its decisions, and nothing is dropped without a count.

#![allow(unsafe_code, reason = "calls the interface as C does")]

extern crate alloc;

mod airspace;
mod beliefs;
mod flight;
#[path = "../built/known.rs"]
mod known;
mod learned;
mod mission;
mod reports;

use alloc::collections::BTreeSet;
use core::ffi::c_char;
use core::ptr::{null, null_mut};

use fga_c::*;

use flight::{Flight, Unit, mast, settings, situation, size, sized, text, vehicle, words};

/// What makes a structure a wrong one.
type Change<T> = fn(&mut T);

/// What a number means.
type Text = extern "C" fn(u32) -> *const c_char;

#[test]
fn every_status_state_and_reason_has_a_sentence_of_its_own() {
    for (of, count) in [
        (fga_status_text as Text, 13),
        (fga_state_text, 4),
        (fga_reason_text, 14),
    ] {
        let known: BTreeSet<String> = (0..count).map(|value| text(of(value))).collect();
        assert_eq!(known.len(), count as usize);
        assert!(text(of(count)).starts_with("no ") && text(of(u32::MAX)).starts_with("no "));
    }
}

#[test]
fn a_mast_ahead_is_avoided() {
    let mut flight = Flight::new(2);
    let (status, decision) = flight.step(0.0, &[mast(7, 120.0, 5.0)]);
    assert_eq!(status, fga_status::Ok);
    assert!(decision.state != fga_state::Cruise && decision.stage_count > 0);
    assert!(decision.has & FGA_HAS_THREAT != 0 && decision.threat.id == 7);
    assert!(decision.has & FGA_HAS_CERTIFICATE != 0 && decision.certified_margin_m >= 0.05);
    // SAFETY: a right pointer.
    assert_eq!(
        unsafe { fga_avoider_restart(flight.avoider) },
        fga_status::Ok
    );
    let (status, decision) = flight.step(0.0, &[]);
    assert_eq!(
        (status, decision.state),
        (fga_status::Ok, fga_state::Cruise)
    );
}

#[test]
fn what_cannot_be_used_is_refused_with_its_name() {
    let mut flight = Flight::new(2);
    let bytes = fga_avoider_size(2, 2);
    let (right, limits) = (settings(), vehicle());
    let rows: [(Change<fga_settings>, &str, fga_status); 8] = [
        (
            |s| s.horizon_s = f64::NAN,
            "horizon_s",
            fga_status::OutOfRange,
        ),
        (|s| s.margin_m = -1.0, "margin_m", fga_status::OutOfRange),
        // The core did not check it.
        (
            |s| s.drift_mps = f64::NAN,
            "drift_mps",
            fga_status::OutOfRange,
        ),
        (
            |s| s.surveillance_radius_m = 0.0,
            "surveillance_radius_m",
            fga_status::OutOfRange,
        ),
        (|s| s.work_limit = 9, "work_limit", fga_status::OutOfRange),
        (|s| s.start = 4, "start", fga_status::UnknownValue),
        (|s| s.objective = 3, "objective", fga_status::UnknownValue),
        (
            |s| (s.start, s.start_score) = (fga_start::Score as u32, 1.5),
            "start_score",
            fga_status::OutOfRange,
        ),
    ];
    for (change, field, expected) in rows {
        let mut wrong = right;
        change(&mut wrong);
        assert_eq!(
            flight.init(FGA_ABI_VERSION, bytes, 2, &wrong, &limits),
            expected,
            "{field}"
        );
        assert_eq!(words(&flight.why).0, field);
        assert!(!words(&flight.why).1.is_empty());
    }
    let slow = fga_vehicle {
        airspeed_mps: 0.0,
        ..limits
    };
    assert_eq!(
        flight.init(FGA_ABI_VERSION, bytes, 2, &right, &slow),
        fga_status::OutOfRange
    );
    assert_eq!(
        words(&flight.why),
        ("airspeed_mps".into(), "1 to 1,000".into())
    );
    let mut vehicle = sized();
    // SAFETY: right pointers.
    let flat = unsafe { fga_vehicle_from_bank(15.0, 1.6, &raw mut vehicle, &raw mut flight.why) };
    assert_eq!(flat, fga_status::OutOfRange);
    assert_eq!(
        words(&flight.why),
        ("bank_max_rad".into(), "above 0, below π/2".into())
    );
}

#[test]
fn wrong_versions_sizes_and_storage_are_refused() {
    let mut flight = Flight::new(2);
    let (settings, vehicle, bytes) = (settings(), vehicle(), fga_avoider_size(2, 2));
    let init = |flight: &mut Flight, version, bytes, most| {
        flight.init(version, bytes, most, &settings, &vehicle)
    };
    assert_eq!(
        init(&mut flight, FGA_ABI_VERSION + 1, bytes, 2),
        fga_status::WrongVersion
    );
    assert_eq!(
        init(&mut flight, FGA_ABI_VERSION, bytes - 1, 2),
        fga_status::StorageTooSmall
    );
    assert_eq!(
        init(&mut flight, FGA_ABI_VERSION, bytes, 3),
        fga_status::StorageTooSmall
    );
    assert_eq!(
        init(&mut flight, FGA_ABI_VERSION, bytes, u32::MAX),
        fga_status::TooMany
    );
    assert_eq!(words(&flight.why).0, "obstacles_most");
    assert_eq!(
        (
            fga_avoider_size(FGA_CAPACITY_MOST + 1, 0),
            fga_avoider_size(0, u32::MAX)
        ),
        (0, 0)
    );
    // What was refused before it began has left the avoider as it was.
    assert_eq!(flight.step(0.0, &[]).0, fga_status::Ok);
    let short = fga_settings {
        size: settings.size - 8,
        ..settings
    };
    let status = flight.init(FGA_ABI_VERSION, bytes, 2, &short, &vehicle);
    assert_eq!(status, fga_status::WrongSize);
}

#[test]
fn wrong_pointers_are_refused() {
    let mut flight = Flight::new(2);
    let obstacles = [mast(1, 300.0, 0.0)];
    let right = situation(0.0, &obstacles);
    let mut decision: fga_decision = sized();
    let out = &raw mut decision;
    let (avoider, storage) = (flight.avoider, flight.storage.as_mut_ptr());
    // SAFETY: pointers are right, null, misaligned, or lead into the storage.
    unsafe {
        let step = |avoider, situation, out| fga_avoider_step(avoider, situation, out, null_mut());
        assert_eq!(step(null_mut(), &raw const right, out), fga_status::Null);
        assert_eq!(step(avoider, null(), out), fga_status::Null);
        assert_eq!(
            step(avoider, &raw const right, null_mut()),
            fga_status::Null
        );
        let odd = out.wrapping_byte_add(4);
        assert_eq!(step(avoider, &raw const right, odd), fga_status::Misaligned);
        let elsewhere = storage.add(4).cast::<fga_avoider>();
        assert_eq!(
            step(elsewhere, &raw const right, out),
            fga_status::NotInitialized
        );
        // A decision into the middle of the avoider, of the right size.
        let within = storage.add(256).cast::<fga_decision>();
        within.cast::<u32>().write(size::<fga_decision>());
        assert_eq!(step(avoider, &raw const right, within), fga_status::Aliased);
        let there = fga_situation {
            obstacles: storage.add(256).cast(),
            ..right
        };
        assert_eq!(step(avoider, &raw const there, out), fga_status::Aliased);
        let nowhere = fga_situation {
            obstacles: null(),
            ..right
        };
        assert_eq!(step(avoider, &raw const nowhere, out), fga_status::Null);
        let endless = fga_situation {
            obstacle_count: u32::MAX,
            ..right
        };
        assert_eq!(step(avoider, &raw const endless, out), fga_status::TooMany);
        let old = [fga_obstacle {
            size: 8,
            ..obstacles[0]
        }];
        assert_eq!(
            step(avoider, &situation(0.0, &old), out),
            fga_status::WrongSize
        );
    }
    assert!(flight.counts().refused_calls >= 7 && flight.counts().steps == 0);
    // A copied avoider counts as not initialized.
    let mut moved = flight.storage.clone();
    // SAFETY: right pointers.
    let status = unsafe { fga_avoider_restart(moved.as_mut_ptr().cast()) };
    assert_eq!(status, fga_status::NotInitialized);
}

#[test]
fn an_unusable_state_is_refused_and_changes_nothing() {
    let mut flight = Flight::new(2);
    let obstacles = [mast(7, 120.0, 5.0)];
    let rows: [(Change<fga_situation>, &str); 6] = [
        (|s| s.time_s = f64::NAN, "time_s"),
        (
            |s| s.ownship.position_m.north = f64::INFINITY,
            "position_m.north",
        ),
        (
            |s| s.ownship.course_from_east_rad = f64::NAN,
            "course_from_east_rad",
        ),
        (|s| s.ownship.bank_left_rad = 1e16, "bank_left_rad"),
        (|s| s.ownship.airspeed_mps = 0.0, "airspeed_mps"),
        (|s| s.wind_mps.up = f64::NAN, "wind_mps.up"),
    ];
    for (change, field) in rows {
        let mut wrong = situation(0.0, &obstacles);
        change(&mut wrong);
        let (status, decision) = flight.step_with(&wrong);
        assert_eq!(
            (status, decision.stage_count),
            (fga_status::OutOfRange, 0),
            "{field}"
        );
        assert_eq!(words(&flight.why).0, field);
    }
    assert_eq!(flight.counts().refused_calls, 6);
    let (_, after) = flight.step(0.0, &obstacles);
    let (_, alone) = Flight::new(2).step(0.0, &obstacles);
    assert_eq!(after.stages[0], alone.stages[0]);
}

#[test]
fn unusable_obstacles_are_ignored_and_counted() {
    let mut flight = Flight::new(8);
    let changes: [Change<fga_obstacle>; 7] = [
        |o| o.velocity_mps.north = -20.0,
        |o| o.position_m.up = f64::NAN,
        |o| o.radius_m = -1.0,
        |o| o.volume = 0,
        |o| o.movement = 0,
        |o| o.velocity_sigma_mps = f64::INFINITY,
        |o| o.age_s = f64::NAN,
    ];
    let mut obstacles = vec![mast(7, 120.0, 5.0)];
    for (id, change) in (10..).zip(changes) {
        let mut wrong = mast(id, 400.0, 0.0);
        change(&mut wrong);
        obstacles.push(wrong);
    }
    let (status, decision) = flight.step(0.0, &obstacles);
    assert_eq!(
        (status, decision.obstacles_ignored),
        (fga_status::Incomplete, 7)
    );
    let (field, expected) = words(&flight.why);
    assert_eq!((flight.why.index, flight.why.value), (1, 20.0));
    assert_eq!(field, "obstacles.velocity_mps");
    assert!(
        expected.starts_with("0 of FGA_MOVEMENT_AT_REST"),
        "{expected}"
    );
    assert_eq!((decision.obstacles_tracked, decision.threat.id), (1, 7));
    let (_, alone) = Flight::new(8).step(0.0, &obstacles[..1]);
    assert_eq!(decision.stages, alone.stages);
    let counts = flight.counts();
    assert_eq!(
        (
            counts.steps,
            counts.incomplete_steps,
            counts.obstacles_ignored
        ),
        (1, 1, 7)
    );
}

#[test]
fn of_too_many_obstacles_those_count_that_can_be_met_first() {
    let mut flight = Flight::new(2);
    let far = |id: u32| mast(id, 700.0, 50.0 * f64::from(id));
    let obstacles = [
        far(1),
        far(2),
        mast(7, 120.0, 5.0),
        far(3),
        mast(8, 200.0, 150.0),
    ];
    let (status, decision) = flight.step(0.0, &obstacles);
    assert_eq!(
        (status, decision.obstacles_left_out),
        (fga_status::Incomplete, 3)
    );
    assert_eq!(decision.threat.id, 7);
    let (_, alone) = Flight::new(2).step(0.0, &[obstacles[2], obstacles[4]]);
    assert_eq!(decision.stages, alone.stages);
    assert_eq!(flight.counts().obstacles_left_out, 3);
}

#[test]
fn a_refused_mission_leaves_the_old_one() {
    let mut flight = Flight::new(2);
    let way = |north: f64, passing: u32| fga_waypoint {
        position_m: fga_enu {
            east: 500.0,
            north,
            up: 100.0,
        },
        passing,
    };
    let no_limit = f64::NEG_INFINITY;
    let nan = [way(0.0, 0), way(f64::NAN, 0)];
    assert_eq!(flight.set_mission(&nan, no_limit), fga_status::OutOfRange);
    assert_eq!(
        (flight.why.index, words(&flight.why).0),
        (1, "position_m.north".into())
    );
    assert_eq!(
        flight.set_mission(&[way(0.0, 2)], no_limit),
        fga_status::UnknownValue
    );
    assert_eq!(
        flight.set_mission(&[way(0.0, 0); 3], no_limit),
        fga_status::TooMany
    );
    assert_eq!(
        flight.set_mission(&[], f64::INFINITY),
        fga_status::OutOfRange
    );
    assert_eq!(flight.set_mission(&[], f64::NAN), fga_status::OutOfRange);
    let (_, after) = flight.step(0.0, &[mast(7, 120.0, 5.0)]);
    let (_, alone) = Flight::new(2).step(0.0, &[mast(7, 120.0, 5.0)]);
    assert_eq!(after.stages, alone.stages);
}

#[test]
fn a_second_call_meanwhile_is_refused() {
    let flight = Flight::new(2);
    let address = flight.avoider as usize;
    let steps = || {
        let obstacles = [mast(7, 120.0, 5.0)];
        let mut done = 0;
        for _ in 0..200 {
            let (situation, mut decision) = (situation(0.0, &obstacles), sized());
            // SAFETY: right pointers; the other thread has its own.
            let status = unsafe {
                fga_avoider_step(
                    address as *mut _,
                    &raw const situation,
                    &raw mut decision,
                    null_mut(),
                )
            };
            match status {
                fga_status::Ok => done += 1,
                other => assert_eq!(other, fga_status::Busy),
            }
        }
        done
    };
    let done: u32 = std::thread::scope(|scope| {
        let threads = [scope.spawn(steps), scope.spawn(steps)];
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap())
            .sum()
    });
    assert_eq!(
        (flight.counts().steps, flight.counts().refused_calls),
        (done, 0)
    );
}

#[test]
fn a_proof_covers_every_obstacle_or_is_refused() {
    let mut storage = vec![Unit([0; FGA_ALIGN]); fga_prover_size().div_ceil(FGA_ALIGN)];
    let (mut prover, mut why, limits) = (null_mut(), sized(), vehicle());
    // SAFETY: right pointers.
    let status = unsafe {
        fga_prover_init(
            storage.as_mut_ptr().cast(),
            fga_prover_size(),
            FGA_ABI_VERSION,
            &raw const limits,
            &raw mut prover,
            &raw mut why,
        )
    };
    assert_eq!(status, fga_status::Ok);
    let question = fga_question {
        work_limit: 20_000,
        horizon_s: 60.0,
        target_m: 1.0,
        ..sized()
    };
    let mut certify = |obstacles: &[fga_obstacle], question: &fga_question, course_rad: f64| {
        let (situation, mut certificate) = (situation(0.0, obstacles), sized());
        let stage = fga_stage {
            start_s: 0.0,
            course_from_east_rad: course_rad,
            climb_rad: 0.0,
            rate_share: 1.0,
        };
        // SAFETY: right pointers.
        let status = unsafe {
            fga_certify(
                prover,
                &raw const situation,
                &raw const stage,
                1,
                question,
                &raw mut certificate,
                &raw mut why,
            )
        };
        (status, certificate, words(&why).0)
    };
    let masts = [mast(3, 500.0, 300.0), mast(7, 200.0, 0.0)];
    let (status, certificate, _) = certify(&masts, &question, 0.0);
    assert_eq!(
        (status, certificate.verdict),
        (fga_status::Ok, fga_verdict::BelowTarget)
    );
    assert_eq!(
        (certificate.obstacle_id, certificate.obstacle_count),
        (7, 2)
    );
    // A lower bound, less what rounding takes.
    assert!((-1e-4..=0.0).contains(&(certificate.margin_m + 30.0)));
    assert!((certificate.at_s - 200.0 / 15.0).abs() < 0.1);
    let (status, certificate, _) = certify(&masts, &question, -1.0);
    assert_eq!(
        (status, certificate.verdict),
        (fga_status::Ok, fga_verdict::Proven)
    );
    assert_eq!(
        (certificate.margin_m, certificate.straight_aircraft),
        (1.0, 0)
    );
    // Nothing is proven without work.
    let (status, certificate, _) = certify(
        &masts,
        &fga_question {
            work_limit: 3,
            ..question
        },
        -1.0,
    );
    assert_eq!(
        (status, certificate.verdict),
        (fga_status::Ok, fga_verdict::LimitMet)
    );
    let aircraft = fga_obstacle {
        movement: fga_movement::Crewed as u32,
        ..masts[0]
    };
    assert_eq!(certify(&[aircraft], &question, -1.0).1.straight_aircraft, 1);
    // No obstacle is left out of a proof.
    let unusable = fga_obstacle {
        radius_m: f64::NAN,
        ..masts[0]
    };
    let mut moves = masts[0];
    moves.velocity_mps.east = -20.0;
    for (wrong, named) in [(unusable, "obstacles"), (moves, "obstacles.velocity_mps")] {
        let (status, _, field) = certify(&[masts[1], wrong], &question, -1.0);
        assert_eq!((status, field.as_str()), (fga_status::OutOfRange, named));
    }
    let many = vec![masts[1]; FGA_PROVER_OBSTACLES_MOST + 1];
    assert_eq!(certify(&many, &question, -1.0).0, fga_status::TooMany);
    let (status, _, field) = certify(&masts, &question, f64::NAN);
    assert_eq!(
        (status, field.as_str()),
        (fga_status::OutOfRange, "course_from_east_rad")
    );
}

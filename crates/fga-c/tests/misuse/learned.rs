//! A learner: what it finds of an aircraft of which the vehicle file is wrong, and what it refuses.

use core::ptr::{null, null_mut};

use fga_c::*;

use crate::flight::{Unit, sized, vehicle, words};
use crate::known::assert_in_order;

const GRAVITY_MPS2: f64 = 9.806_65;
const HERE: fga_enu = fga_enu {
    east: 0.0,
    north: 0.0,
    up: 0.0,
};

struct Learner {
    storage: Vec<Unit>,
    learned: *mut fga_learned,
    why: fga_refusal,
}

impl Learner {
    fn new(file: &fga_vehicle) -> Self {
        let mut learner = Self {
            storage: vec![Unit([0; FGA_ALIGN]); FGA_LEARNED_BYTES / FGA_ALIGN],
            learned: null_mut(),
            why: sized(),
        };
        let status = learner.init(FGA_ABI_VERSION, fga_learned_size(), file);
        assert_eq!(status, fga_status::Ok);
        learner
    }

    fn init(&mut self, version: u32, bytes: usize, file: &fga_vehicle) -> fga_status {
        let storage = self.storage.as_mut_ptr().cast();
        let (learned, why) = (&raw mut self.learned, &raw mut self.why);
        // SAFETY: right pointers; the storage is not smaller than `bytes` where these suffice.
        unsafe { fga_learned_init(storage, bytes, version, file, learned, why) }
    }

    fn see(&mut self, state: &fga_seen_state) -> fga_status {
        // SAFETY: right pointers.
        unsafe { fga_learned_see(self.learned, state, &raw mut self.why) }
    }

    fn known(&self) -> fga_known_aircraft {
        let mut known = sized();
        // SAFETY: right pointers.
        let status = unsafe { fga_learned_known(self.learned, &raw mut known) };
        assert_eq!(status, fga_status::Ok);
        known
    }

    fn vehicle(&mut self) -> fga_vehicle {
        let mut vehicle = sized();
        // SAFETY: right pointers.
        let status =
            unsafe { fga_learned_vehicle(self.learned, &raw mut vehicle, &raw mut self.why) };
        assert_eq!(status, fga_status::Ok);
        vehicle
    }
}

/// The aircraft: its turn-rate factor is 0.8 of the file's, its bank 0.3 s later, in a wind that nobody reports.
struct Aircraft {
    time_s: f64,
    bank_rad: f64,
    course_rad: f64,
    position_m: [f64; 2],
}

impl Aircraft {
    const FACTOR: f64 = 0.8;
    const LAG_S: f64 = 0.7;
    const SPEED_MPS: f64 = 25.0;
    const WIND_MPS: [f64; 2] = [6.0, -4.0];
    const STEP_S: f64 = 0.01;

    fn file() -> fga_vehicle {
        let mut file = sized();
        // SAFETY: right pointers.
        let status =
            unsafe { fga_vehicle_from_bank(Self::SPEED_MPS, 0.7, &raw mut file, null_mut()) };
        assert_eq!(status, fga_status::Ok);
        file.bank_time_constant_s = 0.4;
        file
    }

    const fn start() -> Self {
        Self {
            time_s: 0.0,
            bank_rad: 0.0,
            course_rad: 0.3,
            position_m: [0.0; 2],
        }
    }

    fn rate_radps(&self) -> f64 {
        Self::FACTOR * GRAVITY_MPS2 * self.bank_rad.tan() / Self::SPEED_MPS
    }

    fn velocity_mps(&self) -> [f64; 2] {
        let (north, east) = self.course_rad.sin_cos();
        let [along_east, along_north] = Self::WIND_MPS;
        [
            Self::SPEED_MPS * east + along_east,
            Self::SPEED_MPS * north + along_north,
        ]
    }

    fn fly(&mut self, commanded_rad: f64) {
        let stays = (-Self::STEP_S / Self::LAG_S).exp();
        self.bank_rad = commanded_rad + (self.bank_rad - commanded_rad) * stays;
        self.course_rad += self.rate_radps() * Self::STEP_S;
        let [east, north] = self.velocity_mps();
        self.position_m[0] += east * Self::STEP_S;
        self.position_m[1] += north * Self::STEP_S;
        self.time_s += Self::STEP_S;
    }

    fn seen(&self, commanded_rad: f64) -> fga_seen_state {
        let [east, north] = self.velocity_mps();
        fga_seen_state {
            has: FGA_SEEN_COMMAND | FGA_SEEN_VELOCITY,
            time_s: self.time_s,
            bank_left_rad: self.bank_rad,
            turn_rate_left_radps: self.rate_radps(),
            airspeed_mps: Self::SPEED_MPS,
            bank_command_left_rad: commanded_rad,
            velocity_mps: fga_enu {
                east,
                north,
                up: 0.0,
            },
            ..sized()
        }
    }

    fn ownship(&self) -> fga_ownship {
        let [east, north] = self.position_m;
        fga_ownship {
            position_m: fga_enu {
                east,
                north,
                up: 100.0,
            },
            course_from_east_rad: self.course_rad,
            climb_rad: 0.0,
            bank_left_rad: self.bank_rad,
            airspeed_mps: Self::SPEED_MPS,
        }
    }
}

/// A minute of turns to both sides of 4 s each, seen by a learner this many times a second.
fn turns(
    learner: &mut Learner,
    hertz: u32,
    wild: impl Fn(u32) -> Option<fga_seen_state>,
) -> Aircraft {
    let mut aircraft = Aircraft::start();
    for step in 0..6000 {
        let commanded_rad = if step / 400 % 2 == 0 { 0.6 } else { -0.6 };
        if step % (100 / hertz) == 0 {
            if let Some(wild) = wild(step) {
                let _ = learner.see(&wild);
            }
            let seen = aircraft.seen(commanded_rad);
            assert_eq!(learner.see(&seen), fga_status::Ok);
        }
        aircraft.fly(commanded_rad);
    }
    aircraft
}

/// How far a turn of full bank is off its prediction after 5 s, metres.
fn off_m(aircraft: &Aircraft, by: &fga_vehicle) -> f64 {
    let mut storage = vec![Unit([0; FGA_ALIGN]); FGA_PROVER_BYTES / FGA_ALIGN];
    let (mut prover, mut then) = (null_mut(), aircraft.ownship());
    let (own, bytes) = (aircraft.ownship(), FGA_PROVER_BYTES);
    let stage = fga_stage {
        start_s: 0.0,
        course_from_east_rad: own.course_from_east_rad + 3.0,
        climb_rad: 0.0,
        rate_share: 1.0,
    };
    let [east, north] = Aircraft::WIND_MPS;
    let wind_mps = fga_enu {
        east,
        north,
        up: 0.0,
    };
    let storage = storage.as_mut_ptr().cast();
    let (from, stages) = (&raw const own, &raw const stage);
    let (place, then_place, why) = (&raw mut prover, &raw mut then, null_mut());
    // SAFETY: right pointers.
    unsafe {
        let status = fga_prover_init(storage, bytes, FGA_ABI_VERSION, by, place, why);
        assert_eq!(status, fga_status::Ok);
        let status = fga_predict(prover, from, stages, 1, wind_mps, 5.0, then_place, why);
        assert_eq!(status, fga_status::Ok);
    }
    let [mut east, mut north] = aircraft.position_m;
    let mut flown = Aircraft::start();
    (flown.bank_rad, flown.course_rad) = (aircraft.bank_rad, aircraft.course_rad);
    for _ in 0..500 {
        flown.fly(0.7);
    }
    (east, north) = (east + flown.position_m[0], north + flown.position_m[1]);
    (then.position_m.east - east).hypot(then.position_m.north - north)
}

fn is_in(interval: &fga_interval, truth: f64) -> bool {
    interval.low <= truth && truth <= interval.high && interval.low <= interval.mean
}

#[test]
fn after_a_minute_of_turns_a_turn_is_predicted_however_wrong_the_file() {
    for hertz in [10, 20, 50, 100] {
        let file = Aircraft::file();
        let mut learner = Learner::new(&file);
        let before = learner.known();
        assert_eq!((before.has, before.turn_rate_factor.mean), (0, 1.0));
        assert!((learner.vehicle().turn_rate_factor - 1.0).abs() < 1e-12);
        let aircraft = turns(&mut learner, hertz, |_| None);
        let known = learner.known();
        let all = FGA_KNOWN_TURN_RATE | FGA_KNOWN_LAG | FGA_KNOWN_WIND;
        assert_eq!(known.has, all);
        let late_s = Aircraft::LAG_S;
        for (interval, truth) in [
            (known.turn_rate_factor, Aircraft::FACTOR),
            (known.bank_time_constant_s, late_s),
            (known.dead_time_s, 0.0),
            (known.late_s, late_s),
            (known.wind_east_mps, Aircraft::WIND_MPS[0]),
            (known.wind_north_mps, Aircraft::WIND_MPS[1]),
        ] {
            assert!(is_in(&interval, truth), "{hertz} Hz: {interval:?} {truth}");
        }
        let (ours_m, files_m) = (
            off_m(&aircraft, &learner.vehicle()),
            off_m(&aircraft, &file),
        );
        println!("{hertz} Hz: off by {ours_m:.1} m, by the file {files_m:.1} m, {known:?}");
        let allowed_m = 3.0 + 0.02 * 5.0 * Aircraft::SPEED_MPS;
        assert!(ours_m < allowed_m && files_m > 2.0 * allowed_m);
        // Of another aircraft a tenth is kept.
        let half = |of: &fga_interval| of.high - of.low;
        // SAFETY: a right pointer.
        assert_eq!(
            unsafe { fga_learned_forget(learner.learned) },
            fga_status::Ok
        );
        assert!(half(&learner.known().turn_rate_factor) > half(&known.turn_rate_factor));
    }
}

#[test]
fn straight_flight_and_a_bank_that_nobody_commands_show_nothing() {
    let mut learner = Learner::new(&Aircraft::file());
    for n in 0..1000 {
        let mut seen = Aircraft::start().seen(0.0);
        (seen.has, seen.time_s) = (0, 0.1 * f64::from(n));
        // What is not read may be anything.
        (seen.bank_command_left_rad, seen.velocity_mps.east) = (f64::NAN, f64::NAN);
        seen.bank_left_rad = if n % 40 < 20 { 0.1 } else { -0.1 };
        assert_eq!(learner.see(&seen), fga_status::Ok);
    }
    let known = learner.known();
    assert_eq!((known.has, known.turn_rate_factor.mean), (0, 1.0));
    assert!((known.bank_time_constant_s.mean - 0.4).abs() < 1e-9);
}

#[test]
fn what_is_refused_or_not_flown_leaves_nothing_behind() {
    type Change = fn(&mut fga_seen_state);
    let rows: [(Change, &str, fga_status); 8] = [
        (|s| s.has = 4, "has", fga_status::UnknownValue),
        (|s| s.time_s = f64::NAN, "time_s", fga_status::OutOfRange),
        (|s| s.time_s -= 0.5, "time_s", fga_status::OutOfRange),
        (
            |s| s.bank_left_rad = f64::NAN,
            "bank_left_rad",
            fga_status::OutOfRange,
        ),
        (
            |s| s.turn_rate_left_radps = f64::INFINITY,
            "turn_rate_left_radps",
            fga_status::OutOfRange,
        ),
        (
            |s| s.airspeed_mps = f64::NAN,
            "airspeed_mps",
            fga_status::OutOfRange,
        ),
        (
            |s| s.bank_command_left_rad = f64::NAN,
            "bank_command_left_rad",
            fga_status::OutOfRange,
        ),
        (
            |s| s.velocity_mps.north = f64::NAN,
            "velocity_mps.north",
            fga_status::OutOfRange,
        ),
    ];
    let file = Aircraft::file();
    let mut undisturbed = Learner::new(&file);
    let aircraft = turns(&mut undisturbed, 20, |_| None);
    let expected = undisturbed.known();
    for (change, field, status) in rows {
        let mut learner = Learner::new(&file);
        turns(&mut learner, 20, |step| {
            let mut wrong = Aircraft::start().seen(0.3);
            wrong.time_s = f64::from(step) * 0.01 - 0.02;
            change(&mut wrong);
            (step > 100).then_some(wrong)
        });
        let mut wrong = aircraft.seen(0.6);
        change(&mut wrong);
        assert_eq!(learner.see(&wrong), status, "{field}");
        assert_eq!(words(&learner.why).0, field);
        let known = learner.known();
        assert_eq!(known.turn_rate_factor, expected.turn_rate_factor, "{field}");
        assert_eq!(known.late_s, expected.late_s, "{field}");
        assert_eq!(known.wind_east_mps, expected.wind_east_mps, "{field}");
    }
}

/// The learner keeps what it learned when the clock is set, and learns on.
#[test]
fn a_clock_that_is_set_takes_nothing_away() {
    let mut learner = Learner::new(&Aircraft::file());
    turns(&mut learner, 20, |_| None);
    let before = learner.known();
    let first = Aircraft::start().seen(0.6);
    assert_eq!(learner.see(&first), fga_status::Ok);
    assert_eq!(learner.known().turn_rate_factor, before.turn_rate_factor);
    let again = fga_seen_state {
        time_s: -0.1,
        ..first
    };
    assert_eq!(learner.see(&again), fga_status::OutOfRange);
    let aircraft = turns(&mut learner, 20, |_| None);
    let known = learner.known();
    assert!(is_in(&known.late_s, Aircraft::LAG_S), "{known:?}");
    assert!(off_m(&aircraft, &learner.vehicle()) < 5.5);
}

#[test]
fn wrong_storage_versions_and_pointers_are_refused() {
    let file = Aircraft::file();
    let mut learner = Learner::new(&file);
    let bytes = fga_learned_size();
    assert_eq!((bytes, fga_learned_align()), (FGA_LEARNED_BYTES, FGA_ALIGN));
    assert_eq!(learner.init(2, bytes, &file), fga_status::WrongVersion);
    let small = learner.init(FGA_ABI_VERSION, bytes - 1, &file);
    assert_eq!(small, fga_status::StorageTooSmall);
    let slow = fga_vehicle {
        airspeed_mps: f64::NAN,
        ..vehicle()
    };
    let refused = learner.init(FGA_ABI_VERSION, bytes, &slow);
    assert_eq!(refused, fga_status::OutOfRange);
    assert_eq!(words(&learner.why).0, "airspeed_mps");

    let (learned, why) = (learner.learned, null_mut());
    let right = Aircraft::start().seen(0.0);
    let short = fga_seen_state { size: 1, ..right };
    let mut elsewhere = [Unit([0; FGA_ALIGN]); FGA_LEARNED_BYTES / FGA_ALIGN];
    let wrong = elsewhere.as_mut_ptr().cast::<fga_learned>();
    let (mut known, mut limits): (fga_known_aircraft, fga_vehicle) = (sized(), sized());
    let (known_place, limits_place) = (&raw mut known, &raw mut limits);
    let misaligned = (&raw const right).wrapping_byte_add(1);
    // SAFETY: each pointer is null or leads to what its type says; what is wrong about the others is found.
    unsafe {
        let see = |learned, state| fga_learned_see(learned, state, why);
        assert_eq!(see(null_mut(), &raw const right), fga_status::Null);
        assert_eq!(see(learned, null()), fga_status::Null);
        assert_eq!(see(learned, misaligned), fga_status::Misaligned);
        assert_eq!(see(learned, &raw const short), fga_status::WrongSize);
        assert_eq!(see(wrong, &raw const right), fga_status::NotInitialized);
        let of = |learned, known| fga_learned_known(learned, known);
        assert_eq!(of(learned, null_mut()), fga_status::Null);
        assert_eq!(of(wrong, known_place), fga_status::NotInitialized);
        let within = |learned, limits| fga_learned_vehicle(learned, limits, why);
        assert_eq!(within(learned, null_mut()), fga_status::Null);
        assert_eq!(within(null_mut(), limits_place), fga_status::Null);
        assert_eq!(within(learned, limits_place), fga_status::Ok);
        assert_eq!(fga_learned_forget(null_mut()), fga_status::Null);
        assert_eq!(fga_learned_forget(wrong), fga_status::NotInitialized);
        // What was refused has changed nothing.
        assert_eq!(see(learned, &raw const right), fga_status::Ok);
    }
    assert_eq!(limits.airspeed_mps, file.airspeed_mps);
}

/// Intervals stay finite and in order after states with numbers of any size. The learner gives a vehicle or a refusal.
#[test]
fn wild_numbers_leave_intervals_that_can_be_calculated_with() {
    let mut seed = 1_u64;
    let mut unit = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut seen_count, mut learner) = (0, Learner::new(&Aircraft::file()));
    let mut time_s = 0.0;
    for n in 0..100_000 {
        let mut wild = |most: f64| {
            let size = if unit() < 0.9 {
                most
            } else {
                10_f64.powf(18.0 * unit() - 10.0)
            };
            if unit() < 0.001 {
                f64::NAN
            } else {
                size * (2.0 * unit() - 1.0)
            }
        };
        time_s += 0.1 + wild(0.1);
        if time_s.is_nan() || time_s > 1e9 {
            time_s = 0.0;
        }
        let state = fga_seen_state {
            has: n % 4,
            time_s,
            bank_left_rad: wild(1.0),
            turn_rate_left_radps: wild(0.5),
            airspeed_mps: wild(20.0).abs(),
            bank_command_left_rad: wild(1.0),
            velocity_mps: fga_enu {
                east: wild(40.0),
                north: wild(40.0),
                up: wild(1.0),
            },
            ..sized()
        };
        seen_count += u32::from(learner.see(&state) == fga_status::Ok);
        if n % 100 > 0 {
            continue;
        }
        assert_in_order(&learner.known());
        let mut vehicle: fga_vehicle = sized();
        let why = &raw mut learner.why;
        // SAFETY: right pointers.
        let status = unsafe { fga_learned_vehicle(learner.learned, &raw mut vehicle, why) };
        assert!(matches!(status, fga_status::Ok | fga_status::OutOfRange));
    }
    assert!(seen_count > 80_000, "{seen_count}");
}

/// A bank that lags more than a proof allows is no vehicle for one.
#[test]
fn a_vehicle_that_no_proof_allows_is_refused_with_its_name() {
    // 15 m/s on a radius of 15 m: at most 1.5 s, in a file that is believed within 0.3 s.
    let file = fga_vehicle {
        turn_radius_m: 15.0,
        bank_time_constant_s: 1.5,
        ..vehicle()
    };
    let mut learner = Learner::new(&file);
    let (mut time_s, mut bank_rad) = (0.0, 0.0_f64);
    for n in 0..1200 {
        let commanded_rad = if n % 160 < 80 { 0.6 } else { -0.6 };
        let seen = fga_seen_state {
            has: FGA_SEEN_COMMAND,
            time_s,
            bank_left_rad: bank_rad,
            airspeed_mps: 15.0,
            turn_rate_left_radps: GRAVITY_MPS2 * bank_rad.tan() / 15.0,
            bank_command_left_rad: commanded_rad,
            velocity_mps: HERE,
            ..sized()
        };
        assert_eq!(learner.see(&seen), fga_status::Ok);
        bank_rad = commanded_rad + (bank_rad - commanded_rad) * (-0.05_f64 / 1.8).exp();
        time_s += 0.05;
    }
    let mut limits: fga_vehicle = sized();
    let why = &raw mut learner.why;
    // SAFETY: right pointers.
    let status = unsafe { fga_learned_vehicle(learner.learned, &raw mut limits, why) };
    assert_eq!(status, fga_status::OutOfRange, "{limits:?}");
    assert_eq!(words(&learner.why).0, "bank_time_constant_s");
    assert_eq!(limits.airspeed_mps, 0.0);
}

//! Drawn calls through the C interface, right and wrong: none crashes, none writes outside of what it is lent, every misuse is
//! a status, and a refused call changes nothing.
//!
//! `FGA_C_CALLS` is the number of calls, 10,000 without it; `FGA_C_SEED` draws others. Under the address sanitizer:
//! `RUSTFLAGS=-Zsanitizer=address cargo +nightly test --release -p fga-c --test fuzz --target x86_64-unknown-linux-gnu`;
//! without `--release` a million take an hour.

#![allow(unsafe_code, reason = "calls the interface as C does")]

mod airspace;
mod beliefs;
mod drawn;
#[path = "../built/known.rs"]
mod known;
mod learned;
mod lent;
mod reports;

use core::ffi::CStr;
use core::ptr;

use fga_c::*;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

use drawn::enu;
use lent::Lent;

const OBSTACLES_MOST: u32 = 6;
const WAYPOINTS_MOST: u32 = 5;

/// What a call must answer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Expected {
    Result,
    Refusal,
    Either,
}

struct Fuzz {
    rng: ChaCha8Rng,
    /// What was done wrong in the present call.
    expected: Expected,
    avoider: Lent,
    prover: Lent,
    /// The handles; null until they are initialized.
    flying: *mut fga_avoider,
    proving: *mut fga_prover,
    decision: Lent,
    certificate: Lent,
    counts: Lent,
    why: Lent,
    time_s: f64,
    own: fga_ownship,
    around: airspace::Airspace,
    listener: reports::Listener,
    learner: learned::Learner,
    believer: beliefs::Believer,
    results: u64,
    refusals: u64,
}

impl Fuzz {
    fn new(seed: u64) -> Self {
        let size = fga_avoider_size(OBSTACLES_MOST, WAYPOINTS_MOST);
        Self {
            rng: ChaCha8Rng::seed_from_u64(seed),
            expected: Expected::Result,
            avoider: Lent::new(size, 0x5A),
            prover: Lent::new(fga_prover_size(), 0x5A),
            flying: ptr::null_mut(),
            proving: ptr::null_mut(),
            decision: Lent::new(size_of::<fga_decision>(), 0x11),
            certificate: Lent::new(size_of::<fga_certificate>(), 0x11),
            counts: Lent::new(size_of::<fga_counts>(), 0x11),
            why: Lent::new(size_of::<fga_refusal>(), 0x11),
            time_s: 0.0,
            own: fga_ownship {
                position_m: enu(0.0, 0.0, 100.0),
                course_from_east_rad: 0.0,
                climb_rad: 0.0,
                bank_left_rad: 0.0,
                airspeed_mps: 15.0,
            },
            around: airspace::Airspace::default(),
            listener: reports::Listener::default(),
            learner: learned::Learner::default(),
            believer: beliefs::Believer::default(),
            results: 0,
            refusals: 0,
        }
    }

    /// Checks an answer against what was done wrong; returns whether there is a result.
    fn check(&mut self, status: fga_status, call: &str) -> bool {
        let is_result = matches!(status, fga_status::Ok | fga_status::Incomplete);
        match self.expected {
            Expected::Result => assert!(is_result, "{call} refused a right call: {status:?}"),
            Expected::Refusal => assert!(!is_result, "{call} took a wrong call: {status:?}"),
            Expected::Either => {}
        }
        if is_result {
            self.results += 1;
        } else {
            self.refusals += 1;
        }
        for lent in [
            &self.avoider,
            &self.prover,
            &self.decision,
            &self.certificate,
            &self.counts,
            &self.why,
        ] {
            lent.assert_guarded();
        }
        is_result
    }

    fn init_avoider(&mut self) {
        let (mut settings, mut vehicle) = (self.settings(), self.vehicle());
        let storage: *mut u8 = self.avoider.at();
        let too_small = self.one_in(50);
        if too_small {
            self.wrong();
        }
        let size = self.avoider.len - usize::from(too_small);
        let version = if self.one_in(50) {
            self.wrong();
            self.below(5) + 2
        } else {
            FGA_ABI_VERSION
        };
        let mut avoider = ptr::null_mut();
        let answer = self.pointer(&raw mut avoider);
        let (settings, vehicle) = (
            self.apart(&raw mut settings, storage),
            self.apart(&raw mut vehicle, storage),
        );
        let (lent, why) = (self.pointer(storage), self.why());
        let (obstacles, waypoints) = (OBSTACLES_MOST, WAYPOINTS_MOST);
        // SAFETY: every pointer leads to what it says, is null, is misaligned, or leads into the storage.
        let status = unsafe {
            fga_avoider_init(
                lent.cast(),
                size,
                version,
                obstacles,
                waypoints,
                settings,
                vehicle,
                answer,
                why,
            )
        };
        if self.check(status, "fga_avoider_init") {
            self.flying = avoider;
        } else if self.flying.is_null() || !matches!(status, fga_status::WrongVersion) {
            // What lay there may be gone.
            // SAFETY: as above.
            let alive = unsafe { fga_avoider_restart(self.flying) } == fga_status::Ok;
            self.flying = if alive { self.flying } else { ptr::null_mut() };
        }
    }

    fn init_prover(&mut self) {
        let mut vehicle = self.vehicle();
        let storage: *mut u8 = self.prover.at();
        let size = self.prover.len;
        let mut prover = ptr::null_mut();
        let answer = self.pointer(&raw mut prover);
        let (vehicle, lent) = (self.apart(&raw mut vehicle, storage), self.pointer(storage));
        let why = self.why();
        // SAFETY: as above.
        let status =
            unsafe { fga_prover_init(lent.cast(), size, FGA_ABI_VERSION, vehicle, answer, why) };
        if self.check(status, "fga_prover_init") {
            self.proving = prover;
        }
    }

    fn set_mission(&mut self) {
        let count = self.below(WAYPOINTS_MOST + 2);
        if count > WAYPOINTS_MOST {
            self.wrong();
        }
        let mut east = self.own.position_m.east;
        let mut waypoints: Vec<fga_waypoint> = (0..count)
            .map(|_| {
                east += self.real(-100.0, 900.0);
                fga_waypoint {
                    position_m: enu(east, self.number(-300.0, 300.0), self.number(60.0, 140.0)),
                    passing: self.enumerated(0, 1),
                }
            })
            .collect();
        let list = if count == 0 {
            ptr::null_mut()
        } else {
            waypoints.as_mut_ptr()
        };
        let bounded = self.one_in(2);
        let mut mission = fga_mission {
            size: self.size::<fga_mission>(),
            waypoint_count: count,
            waypoints: if count == 0 { list } else { self.pointer(list) },
            floor_m: if bounded { 20.0 } else { f64::NEG_INFINITY },
            ceiling_m: if bounded { 220.0 } else { f64::INFINITY },
        };
        if self.one_in(100) {
            self.wrong();
            mission.floor_m = if bounded { 300.0 } else { f64::NAN };
        }
        let storage = self.avoider.at();
        let mission = self.apart(&raw mut mission, storage);
        let (flying, why) = (self.flying(), self.why());
        // SAFETY: as above.
        let status = unsafe { fga_avoider_set_mission(flying, mission, why) };
        self.check(status, "fga_avoider_set_mission");
    }

    fn set_vehicle(&mut self) {
        let mut vehicle = self.vehicle();
        let storage = self.avoider.at();
        let vehicle = self.apart(&raw mut vehicle, storage);
        let in_need = self.one_in(2);
        if in_need && vehicle.is_null() && self.expected == Expected::Refusal {
            // No limits in need: a right call, unless something else was wrong.
            self.expected = Expected::Either;
        }
        let (flying, why) = (self.flying(), self.why());
        // SAFETY: as above.
        let status = unsafe {
            if in_need {
                fga_avoider_set_vehicle_in_need(flying, vehicle, why)
            } else {
                fga_avoider_set_vehicle(flying, vehicle, why)
            }
        };
        self.check(status, "fga_avoider_set_vehicle");
    }

    fn step(&mut self) {
        let count = self.below(10);
        let mut obstacles: Vec<fga_obstacle> = (0..count).map(|id| self.obstacle(id)).collect();
        let mut situation = self.situation(&mut obstacles);
        if self.one_in(500) {
            self.wrong();
            situation.obstacle_count = u32::MAX - self.below(3);
        }
        let storage = self.avoider.at();
        let situation = self.apart(&raw mut situation, storage);
        let size = self.size::<fga_decision>();
        let at = self.decision.at::<u32>();
        // SAFETY: the first field.
        unsafe { at.write(size) };
        let right = self.decision.at();
        let decision: *mut fga_decision = self.apart(right, storage);
        let before = self.decision.content().to_vec();
        let (flying, why) = (self.flying(), self.why());
        let beliefs = self.believer.beliefs;
        let is_believed = !beliefs.is_null() && self.one_in(2);
        let status = if is_believed {
            // SAFETY: as above.
            unsafe { fga_avoider_step_on_beliefs(flying, beliefs, situation, decision, why) }
        } else {
            // SAFETY: as above.
            unsafe { fga_avoider_step(flying, situation, decision, why) }
        };
        if !self.check(status, "a step") {
            assert!(
                before == self.decision.content(),
                "a refused step wrote a decision"
            );
            return;
        }
        let decision: fga_decision = self.decision.get();
        let missing = decision.obstacles_ignored + decision.obstacles_left_out;
        let is_incomplete = status == fga_status::Incomplete;
        assert!(missing == 0 || is_incomplete);
        // Beliefs leave out more.
        assert!(missing > 0 || is_believed || !is_incomplete);
        assert!(decision.stage_count as usize <= FGA_STAGES_MOST);
        assert_eq!(decision.size as usize, size_of::<fga_decision>());
        for stage in &decision.stages[..decision.stage_count as usize] {
            assert!(stage.course_from_east_rad.is_finite() && stage.climb_rad.is_finite());
        }
        // Flies on, roughly.
        self.time_s += 0.1;
        let stage = decision.stages[..decision.stage_count as usize].first();
        let course = stage.map_or(self.own.course_from_east_rad, |stage| {
            stage.course_from_east_rad
        });
        self.own.course_from_east_rad +=
            (course - self.own.course_from_east_rad).clamp(-0.05, 0.05);
        self.own.position_m.east += 1.5 * self.own.course_from_east_rad.cos();
        self.own.position_m.north += 1.5 * self.own.course_from_east_rad.sin();
    }

    fn counts(&mut self) {
        let size = self.size::<fga_counts>();
        let at = self.counts.at::<u32>();
        // SAFETY: the first field.
        unsafe { at.write(size) };
        let (storage, right) = (self.avoider.at(), self.counts.at());
        let counts: *mut fga_counts = self.apart(right, storage);
        let flying = self.flying();
        // SAFETY: as above.
        let status = unsafe { fga_avoider_counts(flying, counts) };
        self.check(status, "fga_avoider_counts");
    }

    fn certify(&mut self) {
        let count = self.below(5);
        let mut obstacles: Vec<fga_obstacle> = (0..count).map(|id| self.obstacle(id)).collect();
        let mut situation = self.situation(&mut obstacles);
        let mut stages = self.stages();
        let mut question = fga_question {
            size: self.size::<fga_question>(),
            work_limit: self.below(20_000),
            horizon_s: self.number(1.0, 90.0),
            target_m: self.number(0.0, 50.0),
            confidence_sigmas: self.number(0.0, 4.0),
        };
        let storage = self.prover.at();
        let situation = self.apart(&raw mut situation, storage);
        let question = self.apart(&raw mut question, storage);
        let size = self.size::<fga_certificate>();
        let at = self.certificate.at::<u32>();
        // SAFETY: the first field.
        unsafe { at.write(size) };
        let right = self.certificate.at();
        let certificate: *mut fga_certificate = self.apart(right, storage);
        let before = self.certificate.content().to_vec();
        let stage_count = u32::try_from(stages.len()).unwrap();
        let list = match stage_count {
            0 => ptr::null_mut(),
            _ => self.pointer(stages.as_mut_ptr()),
        };
        if self.expected == Expected::Result {
            // An unusable obstacle is refused here.
            self.expected = Expected::Either;
        }
        let (proving, why) = (self.proving(), self.why());
        // SAFETY: as above.
        let status = unsafe {
            fga_certify(
                proving,
                situation,
                list,
                stage_count,
                question,
                certificate,
                why,
            )
        };
        if self.check(status, "fga_certify") {
            let found: fga_certificate = self.certificate.get();
            assert_eq!(found.obstacle_count, count);
        } else {
            assert!(
                before == self.certificate.content(),
                "a refused proof wrote a certificate"
            );
        }
    }

    fn predict(&mut self) {
        let mut own = self.own;
        let mut then = own;
        let mut stages = self.stages();
        let stage_count = u32::try_from(stages.len()).unwrap();
        let list = match stage_count {
            0 => ptr::null_mut(),
            _ => self.pointer(stages.as_mut_ptr()),
        };
        let wind_mps = enu(self.number(-5.0, 5.0), 0.0, 0.0);
        let after_s = self.number(0.0, 100.0);
        let to = if self.one_in(100) {
            self.wrong();
            &raw mut own
        } else {
            self.pointer(&raw mut then)
        };
        let (from, proving, why) = (self.pointer(&raw mut own), self.proving(), self.why());
        if from == to {
            self.wrong();
        }
        // SAFETY: as above.
        let status =
            unsafe { fga_predict(proving, from, list, stage_count, wind_mps, after_s, to, why) };
        if self.check(status, "fga_predict") {
            assert!(then.position_m.east.is_finite() && then.course_from_east_rad.is_finite());
        }
    }

    fn words(&mut self) {
        let any = if self.one_in(2) {
            self.below(20)
        } else {
            self.rng.next_u32()
        };
        for text in [
            fga_status_text(any),
            fga_state_text(any),
            fga_reason_text(any),
        ] {
            // SAFETY: a text of the library, for ever.
            assert!(!unsafe { CStr::from_ptr(text) }.is_empty());
        }
        let (airspeed_mps, bank_rad) = (self.number(12.0, 60.0), self.number(0.2, 1.0));
        let mut vehicle = Lent::new(size_of::<fga_vehicle>(), 0);
        let size = self.size::<fga_vehicle>();
        let at = vehicle.at::<u32>();
        // SAFETY: the first field.
        unsafe { at.write(size) };
        let (to, why) = (self.pointer(vehicle.at::<fga_vehicle>()), self.why());
        // SAFETY: as above.
        let status = unsafe { fga_vehicle_from_bank(airspeed_mps, bank_rad, to, why) };
        self.check(status, "fga_vehicle_from_bank");
        vehicle.assert_guarded();
    }

    fn call(&mut self) {
        self.expected = Expected::Result;
        match self.below(100) {
            0..3 => self.init_avoider(),
            3..5 => self.init_prover(),
            5..10 => self.set_mission(),
            10..14 => self.set_vehicle(),
            14 => {
                let flying = self.flying();
                // SAFETY: as above.
                let status = unsafe { fga_avoider_restart(flying) };
                self.check(status, "fga_avoider_restart");
            }
            15..20 => self.counts(),
            20..35 => self.certify(),
            35..50 => self.predict(),
            50..55 => self.words(),
            55 => self.init_reports(),
            56..66 => self.hear(),
            66 => self.init_learner(),
            67..77 => self.learn(),
            77 => self.init_beliefs(),
            78..83 => self.believe(),
            _ => self.step(),
        }
    }
}

#[test]
fn drawn_calls_never_crash_write_outside_or_pass_a_misuse() {
    let number = |name: &str, otherwise: u64| {
        std::env::var(name).map_or(otherwise, |text| text.parse().expect("a number"))
    };
    let (calls, seed) = (number("FGA_C_CALLS", 10_000), number("FGA_C_SEED", 37));
    // Frames of the address sanitizer are large.
    let flown = std::thread::Builder::new()
        .stack_size(8 << 20)
        .spawn(move || {
            let mut fuzz = Fuzz::new(seed);
            for _ in 0..calls {
                fuzz.call();
            }
            (fuzz.results, fuzz.refusals)
        });
    let (results, refusals) = flown.expect("a thread").join().expect("no panic");
    println!("{calls} calls: {results} results, {refusals} refusals");
    assert!(results > calls / 2 && refusals > calls / 20);
}

//! Drawn calls through the C interface, right and wrong: none crashes, none writes outside of what it is lent, every misuse is
//! a status, and a refused call changes nothing.
//!
//! `FGA_C_CALLS` is the number of calls, 10,000 without it. Under the address sanitizer:
//! `RUSTFLAGS=-Zsanitizer=address cargo +nightly test -p fga-c --test fuzz --target x86_64-unknown-linux-gnu`.

#![allow(unsafe_code, reason = "calls the interface as C does")]

use core::ffi::CStr;
use core::ptr;

use fga_c::*;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Bytes on either side of all that is lent.
const GUARD: usize = 256;

/// What is in them.
const WATCHED: u8 = 0xA5;

const OBSTACLES_MOST: u32 = 6;
const WAYPOINTS_MOST: u32 = 5;

/// Memory lent to the library, between guards.
struct Lent {
    bytes: Vec<u8>,
    start: usize,
    len: usize,
}

impl Lent {
    fn new(len: usize, fill: u8) -> Self {
        let mut bytes = vec![WATCHED; len + 2 * GUARD + FGA_ALIGN];
        let start = GUARD + bytes[GUARD..].as_ptr().align_offset(FGA_ALIGN);
        bytes[start..start + len].fill(fill);
        Self { bytes, start, len }
    }

    fn of<T: Copy>(value: T) -> Self {
        let mut lent = Self::new(size_of::<T>(), 0);
        lent.set(value);
        lent
    }

    fn at<T>(&mut self) -> *mut T {
        self.bytes[self.start..].as_mut_ptr().cast()
    }

    fn set<T: Copy>(&mut self, value: T) {
        assert_eq!(self.len, size_of::<T>());
        let at = self.at::<T>();
        // SAFETY: aligned, and as large as a `T`.
        unsafe { at.write(value) };
    }

    fn get<T: Copy>(&mut self) -> T {
        assert_eq!(self.len, size_of::<T>());
        let at = self.at::<T>();
        // SAFETY: a `T` lies there: numbers, which any bytes are.
        unsafe { at.read() }
    }

    fn content(&self) -> &[u8] {
        &self.bytes[self.start..self.start + self.len]
    }

    fn assert_guarded(&self) {
        let outside = self.bytes[..self.start]
            .iter()
            .chain(&self.bytes[self.start + self.len..]);
        assert!(
            outside.copied().all(|byte| byte == WATCHED),
            "written outside of what is lent"
        );
    }
}

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
            results: 0,
            refusals: 0,
        }
    }

    fn below(&mut self, most: u32) -> u32 {
        self.rng.next_u32() % most
    }

    fn one_in(&mut self, most: u32) -> bool {
        self.below(most) == 0
    }

    fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.rng.next_u32()) / f64::from(u32::MAX)
    }

    /// The call must be refused, whatever else.
    fn wrong(&mut self) {
        self.expected = Expected::Refusal;
    }

    /// A number that may be anything that the interface refuses.
    fn number(&mut self, low: f64, high: f64) -> f64 {
        match self.below(300) {
            0 => {
                self.wrong();
                f64::NAN
            }
            1 => {
                self.wrong();
                f64::INFINITY
            }
            2 => {
                self.wrong();
                -1e16
            }
            _ => self.real(low, high),
        }
    }

    /// A number that is usable, but may be far from any flight.
    fn wild(&mut self, low: f64, high: f64) -> f64 {
        match self.below(200) {
            0 => self.real(-1e15, 1e15),
            1 => 0.0,
            2 => 5e-324,
            3 => -0.0,
            _ => self.real(low, high),
        }
    }

    /// The size of a structure, sometimes a wrong one.
    fn size<T>(&mut self) -> u32 {
        let size = u32::try_from(size_of::<T>()).unwrap();
        if self.one_in(150) {
            self.wrong();
            let other = [0, size - 1, size + 8, u32::MAX][self.below(4) as usize];
            return other;
        }
        size
    }

    /// A pointer, sometimes a wrong one: null, misaligned, or into the storage of the avoider or the prover.
    fn pointer<T>(&mut self, right: *mut T) -> *mut T {
        match self.below(400) {
            0 => {
                self.wrong();
                ptr::null_mut()
            }
            1 => {
                self.wrong();
                right.wrapping_byte_add(1 + self.below(3) as usize)
            }
            _ => right,
        }
    }

    /// The same for a pointer that may not lead into the storage of the object.
    fn apart<T>(&mut self, right: *mut T, storage: *mut u8) -> *mut T {
        if self.one_in(400) {
            self.wrong();
            let within = 8 * self.below(2000) as usize;
            return storage.wrapping_add(within).cast();
        }
        self.pointer(right)
    }

    /// Where the refusal goes: sometimes nowhere.
    fn why(&mut self) -> *mut fga_refusal {
        let mut refusal = [0_u8; size_of::<fga_refusal>()];
        self.rng.fill_bytes(&mut refusal);
        self.why.bytes[self.why.start..self.why.start + self.why.len].copy_from_slice(&refusal);
        let size = self.size::<fga_refusal>();
        let at = self.why.at::<u32>();
        // SAFETY: the first field.
        unsafe { at.write(size) };
        match self.below(20) {
            // Nobody asks, so its size is not read.
            0 if size as usize == size_of::<fga_refusal>() => ptr::null_mut(),
            _ => self.why.at(),
        }
    }

    fn flying(&mut self) -> *mut fga_avoider {
        let right = self.flying;
        if right.is_null() {
            self.wrong();
        }
        if self.one_in(300) {
            // Storage in which no avoider begins.
            self.wrong();
            return self
                .avoider
                .at::<u8>()
                .wrapping_add(64 + FGA_ALIGN * self.below(8) as usize)
                .cast();
        }
        self.pointer(right)
    }

    fn proving(&mut self) -> *mut fga_prover {
        let right = self.proving;
        if right.is_null() {
            self.wrong();
        }
        self.pointer(right)
    }

    fn vehicle(&mut self) -> fga_vehicle {
        let climbs = !self.one_in(3);
        let lags = self.one_in(2);
        fga_vehicle {
            size: self.size::<fga_vehicle>(),
            airspeed_mps: self.number(12.0, 60.0),
            turn_radius_m: self.number(40.0, 400.0),
            climb_min_rad: if climbs { self.number(-0.3, 0.0) } else { 0.0 },
            climb_max_rad: if climbs { self.number(0.0, 0.3) } else { 0.0 },
            climb_rate_radps: self.number(0.05, 0.5),
            dead_time_s: self.number(0.0, 1.0),
            bank_time_constant_s: if lags { self.number(0.1, 2.0) } else { 0.0 },
            turn_rate_factor: self.number(0.5, 1.2),
        }
    }

    fn settings(&mut self) -> fga_settings {
        let mut settings = Lent::of(fga_settings_of(size_of::<fga_settings>()));
        // SAFETY: a structure of this size.
        assert_eq!(
            unsafe { fga_settings_default(settings.at()) },
            fga_status::Ok
        );
        let mut settings: fga_settings = settings.get();
        settings.size = self.size::<fga_settings>();
        settings.start = self.enumerated(0, 3);
        settings.start_score = self.real(0.0, 1.0);
        settings.objective = self.enumerated(0, 2);
        settings.horizon_s = self.number(10.0, 90.0);
        settings.margin_m = self.number(0.0, 10.0);
        settings.drift_mps = self.number(0.0, 2.0);
        settings.work_limit = 10_000 + self.below(10_000);
        settings
    }

    /// A value of an enumeration, sometimes none.
    fn enumerated(&mut self, low: u32, high: u32) -> u32 {
        if self.one_in(200) {
            self.wrong();
            return high + 1 + self.below(u32::MAX - high - 1);
        }
        low + self.below(high - low + 1)
    }

    /// An obstacle, most of them near; unusable ones are ignored by a step, and refused by a proof.
    fn obstacle(&mut self, id: u32) -> fga_obstacle {
        let before = self.expected;
        let own = self.own.position_m;
        let mut obstacle = fga_obstacle {
            size: u32::try_from(size_of::<fga_obstacle>()).unwrap(),
            id,
            position_m: enu(
                own.east + self.wild(-300.0, 900.0),
                own.north + self.wild(-400.0, 400.0),
                own.up + self.wild(-60.0, 60.0),
            ),
            velocity_mps: enu(
                self.wild(-40.0, 40.0),
                self.wild(-40.0, 40.0),
                self.wild(-3.0, 3.0),
            ),
            volume: self.enumerated(1, 2),
            movement: self.enumerated(1, 5),
            radius_m: self.wild(1.0, 150.0),
            half_height_m: self.wild(1.0, 60.0),
            position_sigma_m: self.wild(0.0, 5.0),
            velocity_sigma_mps: self.wild(0.0, 1.0),
            bounds: fga_bounds {
                turn_rate_radps: self.wild(0.0, 0.5),
                brief_turn_rate_radps: self.wild(0.0, 0.8),
                turn_rad: self.wild(0.0, 2.0),
                climb_change_mps: self.wild(0.0, 5.0),
                acceleration_mps2: self.wild(0.0, 3.0),
            },
        };
        match self.below(40) {
            0 => obstacle.radius_m = -1.0,
            1 => obstacle.velocity_mps.north = f64::NAN,
            2 => obstacle.position_m.up = f64::INFINITY,
            _ => {}
        }
        // A wrong number of an obstacle is no wrong call.
        self.expected = before;
        if self.one_in(300) {
            self.wrong();
            obstacle.size = self.below(100);
        }
        obstacle
    }

    fn situation(&mut self, obstacles: &mut [fga_obstacle]) -> fga_situation {
        let (time_s, own) = (self.time_s, self.own);
        let mut ownship = own;
        ownship.climb_rad = self.number(-0.2, 0.2);
        ownship.bank_left_rad = self.number(-0.6, 0.6);
        ownship.course_from_east_rad += self.number(-0.1, 0.1);
        if self.one_in(300) {
            self.wrong();
            ownship.airspeed_mps = [0.0, -3.0, f64::NAN][self.below(3) as usize];
        }
        let count = u32::try_from(obstacles.len()).unwrap();
        let list = match count {
            0 => ptr::null_mut(),
            _ => self.pointer(obstacles.as_mut_ptr()),
        };
        fga_situation {
            size: self.size::<fga_situation>(),
            obstacle_count: count,
            obstacles: list,
            time_s: if self.one_in(100) {
                self.number(-10.0, 1e4)
            } else {
                time_s
            },
            ownship,
            wind_mps: enu(
                self.number(-5.0, 5.0),
                self.number(-5.0, 5.0),
                self.number(-0.5, 0.5),
            ),
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
        // SAFETY: as above.
        let status = unsafe { fga_avoider_step(flying, situation, decision, why) };
        if !self.check(status, "fga_avoider_step") {
            assert!(
                before == self.decision.content(),
                "a refused step wrote a decision"
            );
            return;
        }
        let decision: fga_decision = self.decision.get();
        let missing = decision.obstacles_ignored + decision.obstacles_left_out;
        assert_eq!(missing > 0, status == fga_status::Incomplete);
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

    fn stages(&mut self) -> Vec<fga_stage> {
        let mut start_s = 0.0;
        let count = self.below(4);
        (0..count)
            .map(|_| {
                let stage = fga_stage {
                    start_s,
                    course_from_east_rad: self.number(-4.0, 4.0),
                    climb_rad: self.number(-0.3, 0.3),
                    rate_share: 1.0,
                };
                start_s += self.real(0.0, 20.0);
                stage
            })
            .collect()
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
            _ => self.step(),
        }
    }
}

fn enu(east: f64, north: f64, up: f64) -> fga_enu {
    fga_enu { east, north, up }
}

/// Settings that say nothing but a size.
fn fga_settings_of(size: usize) -> fga_settings {
    fga_settings {
        size: u32::try_from(size).unwrap(),
        start: 0,
        start_score: 0.0,
        decision_period_s: 0.0,
        surveillance_radius_m: 0.0,
        horizon_s: 0.0,
        margin_m: 0.0,
        drift_mps: 0.0,
        confidence_sigmas: 0.0,
        heading_cost: 0.0,
        pitch_cost: 0.0,
        objective: 0,
        work_limit: 0,
    }
}

#[test]
fn drawn_calls_never_crash_write_outside_or_pass_a_misuse() {
    let calls = std::env::var("FGA_C_CALLS").map_or(10_000, |text| text.parse().expect("a number"));
    // The present core needs half a megabyte of stack.
    let flown = std::thread::Builder::new()
        .stack_size(8 << 20)
        .spawn(move || {
            let mut fuzz = Fuzz::new(37);
            for _ in 0..calls {
                fuzz.call();
            }
            (fuzz.results, fuzz.refusals)
        });
    let (results, refusals) = flown.expect("a thread").join().expect("no panic");
    println!("{calls} calls: {results} results, {refusals} refusals");
    assert!(results > calls / 2 && refusals > calls / 20);
}

//! Drawn states, plausible and wild: intervals stay finite and in order, and the learner gives a vehicle or a refusal.

use core::ptr;

use fga_c::*;

use crate::drawn::enu;
use crate::known::assert_in_order;
use crate::lent::Lent;
use crate::{Expected, Fuzz};

/// A learner in watched storage.
pub(crate) struct Learner {
    storage: Lent,
    known: Lent,
    vehicle: Lent,
    learned: *mut fga_learned,
    time_s: f64,
}

impl Default for Learner {
    fn default() -> Self {
        Self {
            storage: Lent::new(fga_learned_size(), 0x5A),
            known: Lent::new(size_of::<fga_known_aircraft>(), 0x11),
            vehicle: Lent::new(size_of::<fga_vehicle>(), 0x11),
            learned: ptr::null_mut(),
            time_s: 0.0,
        }
    }
}

impl Fuzz {
    /// A pointer that may not lead into the storage of the learner, sometimes a wrong one.
    fn beside_learner<T>(&mut self, right: *mut T) -> *mut T {
        if self.one_in(400) {
            self.wrong();
            let within = 8 * self.below(600) as usize;
            return self.learner.storage.at::<u8>().wrapping_add(within).cast();
        }
        self.pointer(right)
    }

    pub(crate) fn init_learner(&mut self) {
        let mut vehicle = self.vehicle();
        let too_small = self.one_in(20);
        if too_small {
            self.wrong();
        }
        let size = self.learner.storage.len - usize::from(too_small);
        let storage: *mut u8 = self.learner.storage.at();
        let mut learned = ptr::null_mut();
        let (answer, lent) = (self.pointer(&raw mut learned), self.pointer(storage));
        let (vehicle, why) = (self.beside_learner(&raw mut vehicle), self.why());
        // SAFETY: every pointer leads to what it says, is null, is misaligned, or leads into the storage.
        let status =
            unsafe { fga_learned_init(lent.cast(), size, FGA_ABI_VERSION, vehicle, answer, why) };
        if self.check(status, "fga_learned_init") {
            self.learner.learned = learned;
        }
    }

    pub(crate) fn learn(&mut self) {
        if self.learner.learned.is_null() {
            return self.init_learner();
        }
        self.learner.time_s += self.wild(-0.02, 0.25);
        let mut state = fga_seen_state {
            size: self.size::<fga_seen_state>(),
            has: self.enumerated(0, 3),
            time_s: self.learner.time_s,
            bank_left_rad: self.wild(-0.9, 0.9),
            turn_rate_left_radps: self.wild(-0.6, 0.6),
            airspeed_mps: self.wild(10.0, 40.0),
            bank_command_left_rad: self.wild(-0.9, 0.9),
            velocity_mps: enu(
                self.wild(-40.0, 40.0),
                self.wild(-40.0, 40.0),
                self.wild(-3.0, 3.0),
            ),
        };
        if self.expected == Expected::Result {
            // It may come late, and what is wild may be beyond what is usable.
            self.expected = Expected::Either;
        }
        if self.one_in(100) {
            self.wrong();
            state.bank_left_rad = f64::NAN;
        }
        let (given, why) = (self.beside_learner(&raw mut state), self.why());
        let learned = self.learner.learned;
        // SAFETY: as above.
        let status = unsafe { fga_learned_see(learned, given, why) };
        if !self.check(status, "fga_learned_see") && !self.learner.time_s.is_finite() {
            self.learner.time_s = 0.0;
        }
        if self.one_in(200) {
            // SAFETY: as above.
            assert_eq!(unsafe { fga_learned_forget(learned) }, fga_status::Ok);
        }
        self.ask_learner();
    }

    fn ask_learner(&mut self) {
        let learned = self.learner.learned;
        self.expected = Expected::Result;
        let size = self.size::<fga_known_aircraft>();
        let right = self.learner.known.at::<fga_known_aircraft>();
        // SAFETY: the first field.
        unsafe { right.cast::<u32>().write(size) };
        let known = self.beside_learner(right);
        // SAFETY: as above.
        let status = unsafe { fga_learned_known(learned, known) };
        if self.check(status, "fga_learned_known") {
            let known: fga_known_aircraft = self.learner.known.get();
            assert_in_order(&known);
        }
        // A bank may lag more than a proof allows.
        self.expected = Expected::Either;
        let size = self.size::<fga_vehicle>();
        let right = self.learner.vehicle.at::<fga_vehicle>();
        // SAFETY: the first field.
        unsafe { right.cast::<u32>().write(size) };
        let (vehicle, why) = (self.beside_learner(right), self.why());
        // SAFETY: as above.
        let status = unsafe { fga_learned_vehicle(learned, vehicle, why) };
        if self.check(status, "fga_learned_vehicle") {
            let vehicle: fga_vehicle = self.learner.vehicle.get();
            assert!(vehicle.turn_rate_factor > 0.0 && vehicle.turn_rate_factor.is_finite());
        }
        for lent in [
            &self.learner.storage,
            &self.learner.known,
            &self.learner.vehicle,
        ] {
            lent.assert_guarded();
        }
    }
}

//! Drawn reports for beliefs, and steps on them.

use core::ptr;

use fga_c::*;

use crate::Fuzz;
use crate::lent::Lent;

/// Beliefs in watched storage.
pub(crate) struct Believer {
    storage: Lent,
    pub(crate) beliefs: *mut fga_beliefs,
}

impl Default for Believer {
    fn default() -> Self {
        Self {
            storage: Lent::new(fga_beliefs_size(), 0x5A),
            beliefs: ptr::null_mut(),
        }
    }
}

impl Fuzz {
    pub(crate) fn init_beliefs(&mut self) {
        let storage: *mut u8 = self.believer.storage.at();
        let too_small = self.one_in(20);
        if too_small {
            self.wrong();
        }
        let size = self.believer.storage.len - usize::from(too_small);
        let mut beliefs = ptr::null_mut();
        let (answer, lent) = (self.pointer(&raw mut beliefs), self.pointer(storage));
        let why = self.why();
        // SAFETY: every pointer leads to what it says, is null, is misaligned, or leads into the storage.
        let status = unsafe { fga_beliefs_init(lent.cast(), size, FGA_ABI_VERSION, answer, why) };
        if self.check(status, "fga_beliefs_init") {
            self.believer.beliefs = beliefs;
        }
    }

    pub(crate) fn believe(&mut self) {
        if self.believer.beliefs.is_null() {
            return self.init_beliefs();
        }
        let mut report = self.report(3);
        let storage = self.believer.storage.at();
        let given = self.apart(&raw mut report, storage);
        let (now_s, own_m) = (self.time_s, self.own.position_m);
        let (radius_m, half_m) = (self.number(0.0, 200.0), self.number(0.0, 60.0));
        let (beliefs, why) = (self.believer.beliefs, self.why());
        // SAFETY: as above.
        let status =
            unsafe { fga_beliefs_hear(beliefs, given, radius_m, half_m, now_s, own_m, why) };
        self.check(status, "fga_beliefs_hear");
        self.believer.storage.assert_guarded();
    }
}

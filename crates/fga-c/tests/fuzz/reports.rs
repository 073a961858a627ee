//! Drawn reports, plausible and wild: what comes out are obstacles that a step can use, or nothing.

use core::ptr;

use fga_c::*;

use crate::drawn::enu;
use crate::lent::Lent;
use crate::{Expected, Fuzz};

/// Room for this many aircraft: more storage than a wrong pointer leads into it.
const AIRCRAFT_MOST: u32 = 32;

/// A filter in watched storage.
pub(crate) struct Listener {
    storage: Lent,
    obstacles: Lent,
    reports: *mut fga_reports,
}

impl Default for Listener {
    fn default() -> Self {
        let obstacles = AIRCRAFT_MOST as usize * size_of::<fga_obstacle>();
        Self {
            storage: Lent::new(fga_reports_size(AIRCRAFT_MOST), 0x5A),
            obstacles: Lent::new(obstacles, 0x11),
            reports: ptr::null_mut(),
        }
    }
}

impl Fuzz {
    pub(crate) fn init_reports(&mut self) {
        let storage: *mut u8 = self.listener.storage.at();
        let too_small = self.one_in(20);
        if too_small {
            self.wrong();
        }
        let size = self.listener.storage.len - usize::from(too_small);
        let mut reports = ptr::null_mut();
        let (answer, lent) = (self.pointer(&raw mut reports), self.pointer(storage));
        let lifetime_s = self.number(1.0, 40.0);
        let why = self.why();
        // SAFETY: every pointer leads to what it says, is null, is misaligned, or leads into the storage.
        let status = unsafe {
            let most = AIRCRAFT_MOST;
            fga_reports_init(
                lent.cast(),
                size,
                FGA_ABI_VERSION,
                most,
                lifetime_s,
                answer,
                why,
            )
        };
        if self.check(status, "fga_reports_init") {
            self.listener.reports = reports;
        }
    }

    /// A report, plausible or wild, of a movement from a least one on.
    pub(crate) fn report(&mut self, least_movement: u32) -> fga_report {
        let report = fga_report {
            size: self.size::<fga_report>(),
            id: self.below(36),
            movement: self.enumerated(least_movement, 4),
            has_velocity: self.below(2),
            time_s: self.time_s - self.real(0.0, 30.0),
            position_m: enu(
                self.wild(-3e3, 3e3),
                self.wild(-3e3, 3e3),
                self.wild(0.0, 500.0),
            ),
            velocity_mps: enu(
                self.wild(-60.0, 60.0),
                self.wild(-60.0, 60.0),
                self.wild(-5.0, 5.0),
            ),
            position_sigma_m: self.wild(0.0, 50.0),
            velocity_sigma_mps: self.wild(0.0, 10.0),
            altitude_sigma_m: self.wild(0.0, 50.0),
            lasting_position_sigma_m: self.wild(0.0, 30.0),
            lasting_altitude_sigma_m: self.wild(0.0, 30.0),
        };
        if self.expected == Expected::Result {
            // What is wild may be beyond what is usable.
            self.expected = Expected::Either;
        }
        report
    }

    pub(crate) fn hear(&mut self) {
        if self.listener.reports.is_null() {
            return self.init_reports();
        }
        let mut report = self.report(1);
        let storage = self.listener.storage.at();
        let given = self.apart(&raw mut report, storage);
        let (now_s, own_m, why) = (self.time_s, self.own.position_m, self.why());
        let reports = self.listener.reports;
        // SAFETY: as above.
        let status = unsafe { fga_reports_hear(reports, given, now_s, own_m, why) };
        self.check(status, "fga_reports_hear");

        self.expected = Expected::Result;
        let mut count = u32::MAX;
        let (right, storage) = (self.listener.obstacles.at(), self.listener.storage.at());
        let obstacles: *mut fga_obstacle = self.apart(right, storage);
        let counted = self.pointer(&raw mut count);
        let later_s = now_s + self.number(0.0, 10.0);
        let (radius_m, most, why) = (self.number(0.0, 200.0), AIRCRAFT_MOST, self.why());
        // SAFETY: as above.
        let status = unsafe {
            fga_reports_obstacles(
                reports, later_s, radius_m, 0.0, obstacles, most, counted, why,
            )
        };
        let is_done = self.check(status, "fga_reports_obstacles");
        self.listener.storage.assert_guarded();
        self.listener.obstacles.assert_guarded();
        if !is_done {
            return;
        }
        assert!(count <= AIRCRAFT_MOST);
        // SAFETY: the first `count` of them were written.
        let written = unsafe { core::slice::from_raw_parts(right.cast_const(), count as usize) };
        for obstacle in written {
            let obstacle: &fga_obstacle = obstacle;
            let (at, to) = (obstacle.position_m, obstacle.velocity_mps);
            let numbers = [at.east, at.north, at.up, to.east, to.north, to.up];
            assert!(
                numbers.iter().all(|number| number.is_finite()),
                "{obstacle:?}"
            );
            assert!(obstacle.position_sigma_m >= 0.0 && obstacle.velocity_sigma_mps >= 0.0);
        }
    }
}

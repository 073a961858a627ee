//! What is drawn: numbers, pointers and structures, right ones and wrong ones.

use core::ptr;

use fga_c::*;
use rand_core::Rng as _;

use crate::lent::Lent;
use crate::{Expected, Fuzz};

impl Fuzz {
    pub(crate) fn below(&mut self, most: u32) -> u32 {
        self.rng.next_u32() % most
    }

    pub(crate) fn one_in(&mut self, most: u32) -> bool {
        self.below(most) == 0
    }

    pub(crate) fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.rng.next_u32()) / f64::from(u32::MAX)
    }

    /// The call must be refused, whatever else.
    pub(crate) fn wrong(&mut self) {
        self.expected = Expected::Refusal;
    }

    /// A number that may be anything that the interface refuses.
    pub(crate) fn number(&mut self, low: f64, high: f64) -> f64 {
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
    pub(crate) fn wild(&mut self, low: f64, high: f64) -> f64 {
        match self.below(200) {
            0 => self.real(-1e15, 1e15),
            1 => 0.0,
            2 => 5e-324,
            3 => -0.0,
            _ => self.real(low, high),
        }
    }

    /// The size of a structure, sometimes a wrong one.
    pub(crate) fn size<T>(&mut self) -> u32 {
        let size = u32::try_from(size_of::<T>()).unwrap();
        if self.one_in(150) {
            self.wrong();
            let other = [0, size - 1, size + 8, u32::MAX][self.below(4) as usize];
            return other;
        }
        size
    }

    /// A pointer, sometimes a wrong one: null, misaligned, or into the storage of the avoider or the prover.
    pub(crate) fn pointer<T>(&mut self, right: *mut T) -> *mut T {
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
    pub(crate) fn apart<T>(&mut self, right: *mut T, storage: *mut u8) -> *mut T {
        if self.one_in(400) {
            self.wrong();
            let within = 8 * self.below(2000) as usize;
            return storage.wrapping_add(within).cast();
        }
        self.pointer(right)
    }

    /// Where the refusal goes: sometimes nowhere.
    pub(crate) fn why(&mut self) -> *mut fga_refusal {
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

    pub(crate) fn flying(&mut self) -> *mut fga_avoider {
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

    pub(crate) fn proving(&mut self) -> *mut fga_prover {
        let right = self.proving;
        if right.is_null() {
            self.wrong();
        }
        self.pointer(right)
    }

    pub(crate) fn vehicle(&mut self) -> fga_vehicle {
        let climbs = !self.one_in(3);
        let lags = self.one_in(2);
        fga_vehicle {
            size: self.size::<fga_vehicle>(),
            airspeed_mps: self.number(12.0, 60.0),
            // Wide enough that the longest lag turns no further than a vehicle may: 1.5 radians.
            turn_radius_m: self.number(80.0, 400.0),
            climb_min_rad: if climbs { self.number(-0.3, 0.0) } else { 0.0 },
            climb_max_rad: if climbs { self.number(0.0, 0.3) } else { 0.0 },
            climb_rate_radps: self.number(0.05, 0.5),
            dead_time_s: self.number(0.0, 1.0),
            bank_time_constant_s: if lags { self.number(0.1, 2.0) } else { 0.0 },
            turn_rate_factor: self.number(0.5, 1.2),
        }
    }

    pub(crate) fn settings(&mut self) -> fga_settings {
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
        settings.loss_price_m = self.number(100.0, 1e6);
        settings.work_limit = 10_000 + self.below(10_000);
        settings
    }

    /// A value of an enumeration, sometimes none.
    pub(crate) fn enumerated(&mut self, low: u32, high: u32) -> u32 {
        if self.one_in(200) {
            self.wrong();
            return high + 1 + self.below(u32::MAX - high - 1);
        }
        low + self.below(high - low + 1)
    }

    /// An obstacle, most of them near; unusable ones are ignored by a step, and refused by a proof.
    pub(crate) fn obstacle(&mut self, id: u32) -> fga_obstacle {
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
            age_s: self.wild(0.0, 3.0),
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

    pub(crate) fn situation(&mut self, obstacles: &mut [fga_obstacle]) -> fga_situation {
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
        let mut situation = fga_situation {
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
            zone_count: 0,
            zones: ptr::null(),
            ground: ptr::null(),
        };
        self.lend(&mut situation);
        situation
    }

    pub(crate) fn stages(&mut self) -> Vec<fga_stage> {
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
}

pub(crate) fn enu(east: f64, north: f64, up: f64) -> fga_enu {
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
        loss_price_m: 42_000.0,
        work_limit: 0,
    }
}

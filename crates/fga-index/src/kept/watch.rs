//! When could an obstacle be within surveillance or reach? A bound on the closing speed gives the moment.
//!
//! The clock of the watch passes with the situation's clock, or with the distance that the aircraft covers at the watch's
//! speed, whichever is more. So in a second of this clock the aircraft and an obstacle close by at most a second at the sum
//! of their speeds, whatever the aircraft flies. A jump of the position or of the situation's clock makes this clock pass faster.

use crate::kept::block::{ALWAYS, Slot};
use crate::situation::Situation;
use fga_proof::Vec3;

/// Share added to distances and times for rounding: a million times what rounding takes.
const ROUNDING: f64 = 1e-9;

/// Distance added for rounding, metres.
const ROUNDING_M: f64 = 1e-6;

/// Time added at each reading of the clock for rounding, seconds.
const ROUNDING_S: f64 = 1e-11;

/// The clock starts again at this time, seconds: up to it a double resolves [`ROUNDING_S`].
const LONGEST_S: f64 = 1e5;

/// An obstacle that could matter sooner than this is looked at in every step, seconds.
const SOON_S: f64 = 1.0;

/// The distances at which obstacles matter, and the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    radius_m: f64,
    horizon_s: f64,
    /// Airspeeds of the aircraft up to this one, metres per second.
    airspeed_mps: f64,
    /// Winds that differ from this one by at most `change_mps`, metres per second.
    wind_mps: Vec3,
    change_mps: f64,
    /// Speed over the ground at which the clock passes with the aircraft's way, metres per second.
    speed_mps: f64,
    /// The situation's clock and the aircraft's position at the last reading.
    last_s: f64,
    last_m: Vec3,
    /// The time, seconds.
    pub(super) clock_s: f64,
}

impl Watch {
    pub(super) fn new(situation: &Situation<'_>, (radius_m, horizon_s): (f64, f64)) -> Self {
        let airspeed_mps = 1.2 * situation.ownship.airspeed_mps + 1.0;
        let wind_mps = situation.wind_mps.length();
        let change_mps = 2.0 + 0.2 * wind_mps;
        Self {
            radius_m,
            horizon_s,
            airspeed_mps,
            wind_mps: situation.wind_mps,
            change_mps,
            speed_mps: airspeed_mps + wind_mps + change_mps,
            last_s: situation.time_s,
            last_m: situation.ownship.position_m,
            clock_s: 0.0,
        }
    }

    /// Whether its distances hold in a situation.
    fn holds(&self, situation: &Situation<'_>, (radius_m, horizon_s): (f64, f64)) -> bool {
        self.radius_m == radius_m
            && self.horizon_s == horizon_s
            && situation.ownship.airspeed_mps <= self.airspeed_mps
            && (situation.wind_mps - self.wind_mps).length() <= self.change_mps
    }

    /// Lets the clock pass to a situation; false if all obstacles must be looked at again.
    pub(super) fn pass(&mut self, situation: &Situation<'_>, limits: (f64, f64)) -> bool {
        let passed_s = (situation.time_s - self.last_s).abs();
        let flown_m = (situation.ownship.position_m - self.last_m).length();
        let passed_s = passed_s.max(flown_m / self.speed_mps);
        let clock_s = self.clock_s + passed_s * (1.0 + ROUNDING) + ROUNDING_S;
        if clock_s > LONGEST_S || !self.holds(situation, limits) {
            *self = Self::new(situation, limits);
            return false;
        }
        self.clock_s = clock_s;
        (self.last_s, self.last_m) = (situation.time_s, situation.ownship.position_m);
        true
    }

    /// The distance beyond which an obstacle does not matter, metres: that of surveillance, or without one where
    /// [`Situation::is_out_of_reach`] holds.
    fn reach_m(&self, slot: &Slot) -> f64 {
        if self.radius_m.is_finite() {
            return self.radius_m;
        }
        let square = |x: f64| x * x;
        let obstacle = &slot.obstacle;
        let air_mps = (obstacle.velocity_mps - self.wind_mps).length() + self.change_mps;
        let size_m = obstacle.volume.radius_m() + obstacle.volume.half_height_m() + 1e3;
        let speeds = 2.0 * (square(self.airspeed_mps) + square(air_mps));
        libm::sqrt(2.0 * (speeds * square(self.horizon_s) + square(size_m)))
    }

    /// When an obstacle could matter next, and whether it could matter now.
    pub(super) fn next_s(&self, slot: &Slot, now_m: Vec3, own_m: Vec3, age_s: f64) -> (f64, bool) {
        let speed_mps = slot.obstacle.velocity_mps.length();
        let moves_mps = if slot.is_at_rest() { 0.0 } else { speed_mps };
        let reach_m = self.reach_m(slot);
        let sizes_m =
            slot.obstacle.position_m.length() + own_m.length() + moves_mps * age_s.abs() + reach_m;
        let beyond_m = (now_m - own_m).length() - reach_m - ROUNDING * sizes_m - ROUNDING_M;
        if beyond_m <= 0.0 {
            return (ALWAYS, true);
        }
        let wait_s = beyond_m / (self.speed_mps + moves_mps) * (1.0 - ROUNDING);
        let due_s = if wait_s > SOON_S {
            self.clock_s + wait_s - ROUNDING_S
        } else {
            ALWAYS
        };
        (due_s, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::flying;
    use crate::kept::Kept;
    use crate::kept::block::Block;
    use crate::situation::{Movement, Obstacle, ProtectedVolume};

    /// For an aircraft of 10 m/s the watch allows for 13 m/s and 2 m/s of wind.
    #[test]
    fn the_clock_passes_with_time_or_with_the_way_of_the_aircraft() {
        let limits = (1000.0, 60.0);
        let mut watch = Watch::new(&flying(0.0, 0.0, 10.0), limits);
        for (time_s, x_m, clock_s) in [(5.0, 50.0, 5.0), (6.0, 200.0, 15.0), (4.0, 200.0, 17.0)] {
            assert!(watch.pass(&flying(time_s, x_m, 10.0), limits));
            assert!((watch.clock_s - clock_s).abs() < 1e-6, "{watch:?}");
        }
        // Faster than the watch allows for, or with another radius, all obstacles need a look.
        assert!(!watch.pass(&flying(5.0, 200.0, 14.0), limits));
        assert!(!watch.pass(&flying(5.0, 200.0, 14.0), (2000.0, 60.0)));
    }

    /// 1,500 m beyond surveillance: the aircraft closes at 15 m/s, a flying obstacle at 5 m/s.
    #[test]
    fn an_obstacle_needs_a_look_once_it_could_have_come() {
        let watch = Watch::new(&flying(0.0, 0.0, 10.0), (1000.0, 60.0));
        let mut blocks = [Block::EMPTY];
        let mut kept = Kept::new(&mut blocks);
        let mut next_s = |away_m: f64, movement: Movement| {
            let (place_m, velocity_mps) = (Vec3::new(away_m, 0.0, 0.0), Vec3::new(0.0, 5.0, 0.0));
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let mut obstacle = Obstacle::straight(1, place_m, velocity_mps, volume);
            obstacle.movement = movement;
            kept.put(&obstacle, 0.0).unwrap();
            watch.next_s(kept.memory.slot(0).unwrap(), place_m, Vec3::ZERO, 0.0)
        };
        for (movement, wait_s) in [(Movement::AtRest, 100.0), (Movement::Straight, 75.0)] {
            let (due_s, is_near) = next_s(2500.0, movement);
            assert!(!is_near && (due_s - wait_s).abs() < 1e-4, "{due_s}");
        }
        assert_eq!(next_s(900.0, Movement::Straight), (ALWAYS, true));
        // What could come within a second needs a look in each step.
        assert_eq!(next_s(1010.0, Movement::Straight), (ALWAYS, false));
    }
}

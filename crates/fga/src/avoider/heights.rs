//! The altitudes between which a manoeuvre stays, and its climb angles.

use super::Avoider;
use super::tracks::Places;
use crate::limit::Limit as _;
use crate::situation::{Ownship, Situation};

impl Avoider<dyn Places + '_> {
    /// Adds what bounds a manoeuvre: limits of altitude, zones and ground. A manoeuvre may be as low and as high as the mission is.
    pub(super) fn bind(&mut self, situation: &Situation<'_>) {
        if self.can_climb() {
            // What it can no longer keep above, or is already below, leads back all the same.
            let [lowest_m, highest_m] = self.levels_m(&situation.ownship);
            let apart_m = 2.0 * self.wanted_m();
            let (mut floor_m, mut ceiling_m) = situation.mission.limits_m;
            for waypoint_m in situation.mission.waypoints_m {
                floor_m = floor_m.min(waypoint_m.z - apart_m);
                ceiling_m = ceiling_m.max(waypoint_m.z + apart_m);
            }
            let limits_m = [
                floor_m.min(lowest_m - apart_m),
                ceiling_m.max(highest_m + apart_m),
            ];
            self.tracks.stay_between(limits_m);
        }
        let flown = (&*self.flyer, self.climb_limits_rad());
        let leg = self.progress.index();
        self.tracks
            .add_zones(leg, flown, self.wanted_m(), situation);
    }

    /// The lowest and the highest altitude that the aircraft comes to if it levels off after the next step, metres.
    fn levels_m(&self, own: &Ownship) -> [f64; 2] {
        let (sin, cos) = libm::sincos(own.climb_rad);
        let rate_radps = self.flyer.climb_rate_radps().max(f64::MIN_POSITIVE);
        let levels_m = self.flyer.airspeed_mps() * (1.0 - cos) / rate_radps;
        let period_s = self.settings.decision_period_s;
        // The climb angle c changes meanwhile by r p at most: v p (c + r p), and level from there v ((c + r p)² - c²) / 2r more.
        let steps_m =
            2.0 * self.flyer.airspeed_mps() * period_s * (sin.abs() + rate_radps * period_s);
        let z_m = own.position_m.z;
        let down_m = if sin < 0.0 { levels_m } else { 0.0 };
        let up_m = if sin > 0.0 { levels_m } else { 0.0 };
        [z_m - down_m - steps_m, z_m + up_m + steps_m]
    }

    /// The climb angles with which the aircraft stays between the mission's limits of altitude, radians: level near one of them.
    pub(super) fn level_rad(&self, situation: &Situation<'_>) -> (f64, f64) {
        let [lowest_m, highest_m] = self.levels_m(&situation.ownship);
        let (floor_m, ceiling_m) = situation.mission.limits_m;
        let level = |is_near, otherwise| if is_near { 0.0 } else { otherwise };
        (
            level(lowest_m < floor_m, f64::NEG_INFINITY),
            level(highest_m > ceiling_m, f64::INFINITY),
        )
    }

    pub(super) fn climb_limits_rad(&self) -> (f64, f64) {
        (self.vehicle.climb_min_rad, self.vehicle.climb_max_rad)
    }

    /// Whether its climb angles differ.
    pub(super) fn can_climb(&self) -> bool {
        self.vehicle.climb_min_rad < self.vehicle.climb_max_rad
    }

    /// The same for a manoeuvre, which stays between the limits of altitude.
    pub(super) fn maneuver_climbs_rad(&self) -> (f64, f64) {
        let (low_rad, high_rad) = self.level_rad;
        let limits = self.climb_limits_rad();
        let within = |climb_rad: f64| climb_rad.limited(low_rad, high_rad);
        (within(limits.0), within(limits.1))
    }
}

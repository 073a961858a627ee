//! Does an aircraft look far enough?
//!
//! One place for scenario, vehicle and link files, because the answer needs keys of several tables: how far away an
//! obstacle counts, the volume kept about it, how fast both close in, and how long the aircraft takes to get out of
//! the way. `docs/how-far-to-see.md` gives both formulas.

use fga::situation::ProtectedVolume;
use fga::vehicle::Vehicle;

/// Speed of crewed traffic that may come head-on, metres per second: 175 kn, more than light aircraft fly at the
/// heights of small unmanned ones.
pub const CREWED_MPS: f64 = 90.0;

/// The surveillance radius of a file without one, metres: what closes at the speed of crewed traffic and could
/// enter the volume within the horizon.
pub fn derived_m(airspeed_mps: f64, horizon_s: f64, volume: ProtectedVolume, margin_m: f64) -> f64 {
    volume.bounding_radius_m() + margin_m + (airspeed_mps + CREWED_MPS) * horizon_s
}

/// An aircraft that must keep out of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evasion {
    /// Its limits.
    pub vehicle: Vehicle,
    /// Time until a manoeuvre begins after the obstacle is near enough: a decision, a look, the age of a look, seconds.
    pub late_s: f64,
    /// The volume.
    pub volume: ProtectedVolume,
    /// Distance kept beyond it, metres.
    pub margin_m: f64,
}

impl Evasion {
    /// Time from first sight until the aircraft is out of the way, sideways or by climb or descent, whichever is
    /// shorter, seconds.
    pub fn time_s(&self) -> f64 {
        let Vehicle {
            airspeed_mps,
            turn_radius_m,
            climb_min_rad,
            climb_max_rad,
            climb_rate_radps,
            response,
        } = self.vehicle;
        let response_s = response.dead_time_s + response.bank_time_constant_s;
        let radius_m = turn_radius_m / response.turn_rate_factor;
        let aside_m = self.volume.radius_m() + self.margin_m;
        // A turn of up to a quarter of a circle, then straight.
        let turn_rad = libm::acos((1.0 - aside_m / radius_m).max(0.0));
        let aside_s = (radius_m * turn_rad + (aside_m - radius_m).max(0.0)) / airspeed_mps;
        let climb_rad = climb_max_rad.max(-climb_min_rad);
        let up_mps = airspeed_mps * libm::sin(climb_rad);
        let up_s = if up_mps > 0.0 && climb_rate_radps > 0.0 {
            (self.volume.half_height_m() + self.margin_m) / up_mps + climb_rad / climb_rate_radps
        } else {
            f64::INFINITY
        };
        self.late_s + response_s + aside_s.min(up_s)
    }

    /// Distance at which an obstacle that closes at `closing_mps` must be seen, metres.
    pub fn needed_m(&self, closing_mps: f64) -> f64 {
        self.volume.radius_m() + self.margin_m + closing_mps * self.time_s()
    }

    /// Why an obstacle that closes at `closing_mps` is seen too late within `seen_m`, or why the horizon is too short;
    /// one sentence. `key` is what limits the sight, `whom` the obstacle.
    pub fn shortfall(
        &self,
        (key, seen_m): (&str, f64),
        horizon_s: f64,
        closing_mps: f64,
        whom: &str,
    ) -> Option<String> {
        let time_s = self.time_s();
        if horizon_s < time_s {
            return Some(format!(
                "horizon_s is {horizon_s}, too short for {whom}: getting out of the way takes {time_s:.1} s"
            ));
        }
        let (radius_m, needed_m) = (self.volume.radius_m(), self.needed_m(closing_mps));
        (seen_m < needed_m).then(|| {
            format!(
                "{key} is {seen_m} m, too near for {whom}: {needed_m:.0} m are needed to get out of the way \
                 (radius {radius_m} m + margin {} m + closing speed {closing_mps:.0} m/s x {time_s:.1} s)",
                self.margin_m
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter turn of 30 m at 15 m/s takes π s and moves the aircraft aside by 30 m.
    #[test]
    fn the_time_is_that_of_a_turn_and_a_straight() {
        let mut evasion = Evasion {
            vehicle: Vehicle {
                climb_min_rad: 0.0,
                climb_max_rad: 0.0,
                ..Vehicle::table_4()
            },
            late_s: 0.1,
            volume: ProtectedVolume::Sphere { radius_m: 30.0 },
            margin_m: 0.0,
        };
        assert!((evasion.time_s() - 0.1 - core::f64::consts::PI).abs() < 1e-9);
        evasion.volume = ProtectedVolume::Sphere { radius_m: 75.0 };
        assert!((evasion.time_s() - 3.1 - core::f64::consts::PI).abs() < 1e-9);
        // Up is shorter: 10 m at 15 m/s x sin 30 degrees, and the climb angle at 0.2 rad/s.
        evasion.volume = ProtectedVolume::Cylinder {
            radius_m: 75.0,
            half_height_m: 3.75,
        };
        evasion.vehicle.climb_max_rad = 30f64.to_radians();
        let up_s = 0.5 + 30f64.to_radians() / 0.2;
        assert!((evasion.time_s() - 0.1 - up_s).abs() < 1e-9);
    }
}

//! The mission as an aircraft flies it: its legs in the wind, and what the aircraft can do.

use crate::bend::{Exit, Turner};
use crate::leg::Leg;
use fga_proof::Vec3;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::Stage;
use fga_proof::meter::Meter;
use fga_proof::situation::{Mission, Passing};

/// Straight flight in which the lag of a turn dies out, as a multiple of the distance by which a quarter turn is late: the
/// lag acts at either end of a turn, and as much again is room.
const SETTLING: f64 = 4.0;

/// Work of laying a leg and looking whether it is over.
pub(crate) const LEG: usize = 4;

/// Most legs of a search for a way onto the mission.
pub(crate) const MOST_LEGS: usize = 96;

/// A mission, who flies it, and in which wind.
#[derive(Debug, Clone, Copy)]
pub struct Route<'a> {
    /// The mission.
    pub mission: &'a Mission<'a>,
    /// The vehicle's motion and turns.
    pub flyer: &'a Turner,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
    /// Steepest descent and climb, radians.
    pub climb_limits_rad: (f64, f64),
    /// Counts the work.
    pub meter: &'a Meter,
}

/// A leg that begins elsewhere than at its waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Restart {
    /// Index of the waypoint before its end.
    pub(crate) index: usize,
    /// Its start, metres.
    pub(crate) from_m: Vec3,
}

/// The legs of a route.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Legs<'a> {
    pub(crate) route: &'a Route<'a>,
    /// Course of a leg between waypoints above each other, radians.
    pub(crate) course_rad: f64,
    pub(crate) restart: Option<Restart>,
}

impl Route<'_> {
    /// Airspeed, metres per second, and wind.
    pub(crate) fn air(&self) -> (f64, Vec3) {
        (self.flyer.airspeed_mps(), self.wind_mps)
    }

    /// Radius of the tightest turn, metres.
    pub(crate) fn radius_m(&self) -> f64 {
        self.flyer.turn_radius_m()
    }

    /// Whether the aircraft flies over the waypoint at the end of a leg.
    pub(crate) fn is_flown_over(&self, index: usize) -> bool {
        self.mission.passing.get(index + 1) == Some(&Passing::FlyOver)
    }

    /// The climb angle of a leg, as far as the aircraft can fly it, radians.
    pub(crate) fn climb_rad(&self, leg: &Leg) -> f64 {
        let (low, high) = self.climb_limits_rad;
        leg.climb_rad.limited(low, high)
    }

    /// A stage at the full course rate with the climb angle of a leg.
    pub(crate) fn stage(&self, start_s: f64, course_rad: f64, leg: &Leg) -> Stage {
        Stage::turn(start_s, course_rad, self.climb_rad(leg))
    }

    /// The line on which a turn to the left from level flight ends.
    pub(crate) fn exit(&self, turn_rad: f64) -> Exit {
        let exit = self.flyer.level().exit(self.flyer, turn_rad);
        exit.unwrap_or_default()
    }

    /// Distance in which an aircraft settles on a leg after a turn, metres; 0 without bank lag.
    pub(crate) fn settling_m(&self) -> f64 {
        if self.flyer.is_ideal() {
            return 0.0;
        }
        let quarter = self.exit(core::f64::consts::FRAC_PI_2);
        let late_m = (quarter.from_m.x - self.radius_m()).max(0.0);
        self.radius_m() + SETTLING * late_m
    }
}

impl Legs<'_> {
    /// The leg that begins at a waypoint.
    pub(crate) fn leg(&self, index: usize) -> Option<Leg> {
        let waypoints_m = self.route.mission.waypoints_m;
        let to_m = *waypoints_m.get(index + 1)?;
        let restart = self.restart.filter(|restart| restart.index == index);
        let from_m = restart.map_or(*waypoints_m.get(index)?, |restart| restart.from_m);
        Some(Leg::new([from_m, to_m], self.route.air(), self.course_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{along, table_4};
    use fga_proof::vehicle::Vehicle;

    #[test]
    fn legs_lead_from_waypoint_to_waypoint_or_from_a_restart() {
        table_4(&[(0.0, 0.0), (100.0, 0.0), (100.0, 50.0)], |route| {
            let mut legs = Legs {
                route,
                course_rad: 0.0,
                restart: None,
            };
            let lengths_m = |legs: &Legs<'_>| [0, 1, 2].map(|at| Some(legs.leg(at)?.length_m));
            assert_eq!(lengths_m(&legs), [Some(100.0), Some(50.0), None]);
            legs.restart = Some(Restart {
                index: 1,
                from_m: Vec3::new(100.0, 30.0, 0.0),
            });
            assert_eq!(lengths_m(&legs), [Some(100.0), Some(20.0), None]);
        });
    }

    #[test]
    fn only_a_lagged_aircraft_needs_room_to_settle() {
        let settling_m = |lag_s: f64| {
            let mission = Mission::new(&[]);
            along(&Vehicle::lagged(lag_s), Vec3::ZERO, &mission, |route| {
                (route.settling_m(), route.radius_m())
            })
        };
        assert_eq!(settling_m(0.0).0, 0.0);
        let [(quick_m, radius_m), (slow_m, _)] = [0.3, 0.9].map(settling_m);
        assert!(radius_m < quick_m && quick_m < slow_m && slow_m < 5.0 * radius_m);
    }
}

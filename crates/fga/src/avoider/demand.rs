//! What is asked of a manoeuvre: a ladder of demands, the most that is asked first.

use crate::avoider::intruders::{Clearance, Freedom};
use crate::avoider::{Avoider, Places};
use crate::certificate::Hazard;

/// The separation that a manoeuvre must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Demand {
    /// Share of the bounds of aircraft that it withstands: turns of this share, changes of climb of 1.4 times it.
    pub(super) share: f64,
    /// Distance beyond every volume, metres.
    pub(super) margin_m: f64,
    /// How far ahead, seconds.
    pub(super) horizon_s: f64,
    /// Whether the limits in need apply.
    pub(super) in_need: bool,
}

/// A rung of the ladder.
struct Rung {
    /// Share of the bounds of aircraft.
    share: f64,
    /// Share of the distance that is kept for drift, beside the margin of the settings.
    drift: f64,
    /// Whether the horizon is the longer one.
    is_far: bool,
    /// Whether the limits in need apply.
    in_need: bool,
}

impl Rung {
    const fn of(share: f64, drift: f64) -> Self {
        Self {
            share,
            drift,
            is_far: false,
            in_need: false,
        }
    }
}

/// The demands, the highest first. An aircraft may turn by half of its bounds, and change its climb by 0.7 of them.
const LADDER: [Rung; 5] = [
    Rung {
        is_far: true,
        ..Rung::of(0.5, 1.0)
    },
    Rung::of(0.5, 1.0),
    Rung::of(0.25, 0.5),
    Rung::of(0.0, 0.0),
    Rung {
        in_need: true,
        ..Rung::of(0.0, 0.0)
    },
];

/// Number of rungs.
pub(super) const RUNGS: usize = LADDER.len();

/// The first rung without the longer horizon.
pub(super) const WANTED: usize = 1;

/// Choosing a manoeuvre takes this much more distance beyond the volumes of aircraft than keeping it, metres:
/// the error of their vertical speed (0.2 m/s), over a quarter of a minute.
pub(super) const BEYOND_M: f64 = 3.0;

impl Avoider<dyn Places + '_> {
    /// The demand of a rung.
    pub(super) fn demand_of(&self, rung: usize) -> Demand {
        let [highest, ..] = &LADDER;
        let rung = LADDER.get(rung).unwrap_or(highest);
        Demand {
            // Nothing else turns.
            share: if self.tracks.has_aircraft() {
                rung.share
            } else {
                1.0
            },
            margin_m: self.settings.margin_m + rung.drift * self.drift_m,
            horizon_s: if rung.is_far {
                self.far_s
            } else {
                self.settings.horizon_s
            },
            in_need: rung.in_need,
        }
    }

    /// The demand for which threats are looked for: with the longer horizon where nothing turns.
    pub(super) fn first_demand(&self) -> Demand {
        self.demand_of(WANTED * usize::from(self.tracks.has_aircraft()))
    }

    /// The demand of a rung, if it differs from that of the rung above and the vehicle has its limits.
    pub(super) fn distinct_demand(&self, rung: usize) -> Option<Demand> {
        let demand = self.demand_of(rung);
        let above = rung.checked_sub(1).map(|above| self.demand_of(above));
        let is_known = above == Some(demand) || demand.in_need && self.in_need.is_none();
        (!is_known).then_some(demand)
    }

    /// Takes the motions of aircraft that a demand covers as hazards, with some distance beyond their volumes, metres.
    pub(super) fn ask(&mut self, demand: &Demand, beyond_m: f64) {
        let freedom = Freedom::Share(demand.share, self.vehicle.response.bank_time_constant_s);
        self.withstand(&|_| freedom, (beyond_m, demand.margin_m));
    }

    /// Takes motions of aircraft as hazards, with a distance beyond their volumes and the margin that is asked for, metres.
    pub(super) fn withstand(
        &mut self,
        freedom: &dyn Fn(&Hazard) -> Freedom,
        (beyond_m, margin_m): (f64, f64),
    ) {
        if !self.tracks.has_aircraft() {
            return self.tracks.as_expected();
        }
        let clearance = Clearance {
            beyond_m,
            margin_m,
            is_unproven: false,
        };
        self.tracks.withstand(freedom, clearance, &self.meter);
    }

    /// Does something with the limits of a demand.
    pub(super) fn within_limits<T>(
        &mut self,
        demand: &Demand,
        act: impl FnOnce(&mut Self) -> T,
    ) -> T {
        if demand.in_need {
            self.change_limits();
        }
        let answer = act(self);
        if demand.in_need {
            self.change_limits();
        }
        answer
    }

    /// Takes the limits in need in place of the normal ones, or back again.
    pub(super) fn change_limits(&mut self) {
        if let Some(vehicle) = &mut self.in_need {
            core::mem::swap(vehicle, &mut self.vehicle);
            self.flyer.set(&self.vehicle);
            self.tables.forget_turns();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avoider::Settings;
    use crate::vehicle::Vehicle;

    fn margins_m(avoider: &Avoider) -> alloc::vec::Vec<f64> {
        let rungs = (0..RUNGS).filter_map(|rung| avoider.distinct_demand(rung));
        rungs.map(|demand| demand.margin_m).collect()
    }

    #[test]
    fn without_drift_and_aircraft_there_is_one_demand() {
        let avoider = Avoider::new(Settings::default(), Vehicle::lagged(0.0)).unwrap();
        assert_eq!(margins_m(&avoider), [0.05]);
    }

    #[test]
    fn each_rung_asks_for_less_of_the_distance_for_drift() {
        let mut avoider = Avoider::new(Settings::default(), Vehicle::lagged(0.0)).unwrap();
        avoider.drift_m = 9.0;
        assert_eq!(margins_m(&avoider), [9.05, 4.55, 0.05]);
        avoider.far_s = 240.0;
        assert_eq!(margins_m(&avoider), [9.05, 9.05, 4.55, 0.05]);
    }

    #[test]
    fn the_limits_in_need_come_last_and_go_again() {
        let mut avoider = Avoider::new(Settings::default(), Vehicle::lagged(0.0)).unwrap();
        let steep = Vehicle {
            turn_radius_m: 0.5 * avoider.vehicle().turn_radius_m,
            ..*avoider.vehicle()
        };
        avoider.set_vehicle_in_need(Some(steep)).unwrap();
        assert_eq!(margins_m(&avoider), [0.05, 0.05]);
        let last = avoider.distinct_demand(RUNGS - 1).unwrap();
        let radius_m = |avoider: &mut Avoider<dyn Places>| avoider.flyer.turn_radius_m();
        let normal_m = radius_m(&mut avoider);
        assert_eq!(avoider.within_limits(&last, radius_m), 0.5 * normal_m);
        assert_eq!(radius_m(&mut avoider), normal_m);
    }
}

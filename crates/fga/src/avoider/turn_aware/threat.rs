//! Which obstacles a manoeuvre comes too close to: the first one, and those of the same encounter. Zones, ground and limits of altitude are
//! no threat: they only bound what a manoeuvre may be.

use crate::avoider::demand::Demand;
use crate::avoider::{Against, Avoider, Now, Places, Threat};
use crate::maneuver::Maneuver;

use super::NEXT_ENCOUNTER_S;

/// Parts of a step's work: one is kept for the search while the threat is looked for.
const THREAT_PARTS: u32 = 2;

/// Halvings for the moment of an entry.
const ENTRY_HALVINGS: usize = 24;

impl Avoider<dyn Places + '_> {
    /// The obstacle that a manoeuvre comes too close to first, and those of the same encounter. Keeps work for the search that
    /// follows.
    pub(in crate::avoider) fn first_threat(
        &mut self,
        nominal: &Maneuver,
        now: &Now<'_>,
        demand: &Demand,
    ) -> Option<(Threat, Against)> {
        self.meter.reserve(THREAT_PARTS);
        let first = self.first_of_all(nominal, now, demand);
        self.meter.extend(THREAT_PARTS);
        first
    }

    fn first_of_all(
        &mut self,
        nominal: &Maneuver,
        now: &Now<'_>,
        demand: &Demand,
    ) -> Option<(Threat, Against)> {
        let (horizon_s, target_m) = (demand.horizon_s, demand.margin_m);
        self.predict(nominal, now, horizon_s);
        let mut first: Option<Threat> = None;
        for hazard in self.tracks.obstacles() {
            let closest = self.certify_one(hazard, (horizon_s, f64::MIN, target_m));
            // A hazard that was not examined to its end may be anything.
            if closest.margin_m >= target_m && !self.meter.is_met() {
                continue;
            }
            // The margin up to a moment only falls with time: halve to the entry.
            let (mut before_s, mut after_s) = (0.0, closest.at_s);
            let entered_m = (closest.margin_m + 1e-3).max(0.0).min(target_m);
            for _ in 0..ENTRY_HALVINGS {
                if self.meter.is_met() {
                    break;
                }
                let middle = 0.5 * (before_s + after_s);
                let so_far = self.certify_one(hazard, (middle, f64::MIN, target_m));
                if so_far.margin_m > entered_m {
                    before_s = middle;
                } else {
                    after_s = middle;
                }
            }
            if first.is_none_or(|threat| after_s < threat.entry_s) {
                first = Some(Threat {
                    id: hazard.id(),
                    entry_s: after_s,
                    closest_s: closest.at_s,
                    margin_m: closest.margin_m,
                });
            }
            if self.meter.is_met() {
                break;
            }
        }
        let first = first?;
        let mut against = Against::default();
        against.add(first.id);
        let same_s = (first.entry_s + NEXT_ENCOUNTER_S).min(horizon_s);
        Some((first, self.with_close(against, (same_s, target_m))))
    }

    /// The obstacles of an encounter and those that a manoeuvre comes too close to.
    #[inline(never)]
    pub(super) fn also_against(
        &mut self,
        maneuver: &Maneuver,
        now: &Now<'_>,
        against: Against,
        target_m: f64,
    ) -> Against {
        if self.meter.is_met() {
            return against;
        }
        let reach = (self.settings.horizon_s, target_m);
        self.predict(maneuver, now, reach.0);
        self.with_close(against, reach)
    }

    /// An encounter with the obstacles that the path comes too close to before a time, seconds.
    fn with_close(&self, mut against: Against, (until_s, target_m): (f64, f64)) -> Against {
        for hazard in self.tracks.obstacles() {
            if self.meter.is_met() {
                break;
            }
            let closest = self.certify_one(hazard, (until_s, target_m, target_m));
            if closest.margin_m < target_m && !against.contains(hazard.id()) {
                against.add(hazard.id());
            }
        }
        against
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{among, sphere};
    use super::*;
    use crate::avoider::demand::WANTED;
    use crate::meter::Meter;

    /// At 15 m/s the surface of a sphere of 30 m is met 2 s before its centre.
    #[test]
    fn the_first_threat_is_the_first_that_is_entered() {
        let rows = [
            sphere(1, (800.0, 0.0), (0.0, 0.0)),
            sphere(2, (180.0, 0.0), (0.0, 0.0)),
            sphere(3, (280.0, 10.0), (0.0, 0.0)),
            sphere(4, (150.0, 61.0), (0.0, 0.0)),
        ];
        let (threat, against) = among(&rows, |avoider, _, now| {
            let demand = avoider.demand_of(WANTED);
            let straight = Maneuver::turn(0.0, 0.0, 0.0);
            avoider.first_threat(&straight, now, &demand).unwrap()
        });
        assert_eq!(threat.id, 2);
        assert!((threat.entry_s - 10.0).abs() < 0.01, "{threat:?}");
        assert!((threat.closest_s - 12.0).abs() < 0.01, "{threat:?}");
        assert!((threat.margin_m + 30.0).abs() < 0.01, "{threat:?}");
        // Number 3 is entered 10 s after it at most, number 1 later, number 4 never.
        let of_it = [1, 2, 3, 4].map(|id| against.contains(id));
        assert_eq!(of_it, [false, true, true, false]);
    }

    /// Whatever the work suffices for, what may be a threat is one.
    #[test]
    fn a_threat_is_found_whenever_the_work_is_done() {
        let rows = [
            sphere(1, (800.0, 300.0), (0.0, 0.0)),
            sphere(2, (300.0, 0.0), (0.0, 0.0)),
        ];
        for limit in 0..100 {
            let found = among(&rows, |avoider, _, now| {
                let demand = avoider.demand_of(WANTED);
                avoider.meter = Meter::new(limit, 1000);
                let straight = Maneuver::turn(0.0, 0.0, 0.0);
                avoider.first_threat(&straight, now, &demand).is_some()
            });
            assert!(found, "{limit}");
        }
    }
}

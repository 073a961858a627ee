//! The manoeuvre that comes least deep into cylinders, where none stays out of them.

use crate::avoider::Avoider;
use crate::avoider::demand::Demand;
use crate::avoider::intruders::{Clearance, Freedom};
use crate::certificate::Hazard;
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::search::{Effort, Found};

use super::{CLEARLY_BETTER_M, ENOUGH_M};

/// With less of a step's work left nothing is searched.
const DEPTH_WORK: u32 = 4000;

impl Avoider {
    /// An uncertified manoeuvre if it has more than the margin beside the `flown` one, metres. If it enters a cylinder,
    /// the one that comes least deep takes its place, if that is clearly less deep than the `flown` one.
    pub(super) fn least_deep(
        &mut self,
        answer: &(Found, Maneuver),
        flown: Option<(&Maneuver, f64)>,
        now: &MotionState,
        demand: &Demand,
    ) -> Option<(Found, Maneuver)> {
        let cylinders = self.tracks.hazards().rows().iter().any(Hazard::is_cylinder);
        if answer.0.margin_m >= 0.0 || !cylinders || self.meter.left() < DEPTH_WORK {
            let more_than_m = flown.map_or(f64::MIN, |(_, more_than_m)| more_than_m);
            return (answer.0.margin_m > more_than_m).then_some(*answer);
        }
        self.by_depth(now);
        let asked = (demand.horizon_s, f64::MIN, ENOUGH_M);
        let flown_m = flown.map_or(f64::MIN, |(flown, _)| self.margin_of(flown, now, asked));
        let variety = self.cycle;
        let (deep, ..) = self.search(&Maneuver::hold(), now, demand, |search| {
            let (found, _) = search.best(Some(&answer.1), Effort::Quick, variety)?;
            Some((found, search.maneuver(&found.turns, now)))
        });
        self.tracks.as_expected();
        let (found, maneuver) =
            deep.filter(|(found, _)| found.margin_m > flown_m + CLEARLY_BETTER_M)?;
        let margin_m = self.margin_of(&maneuver, now, asked);
        Some((Found { margin_m, ..found }, maneuver))
    }

    /// Replaces the hazards by the expected motions of all obstacles, with margins by depth.
    pub(super) fn by_depth(&mut self, now: &MotionState) {
        let clearance = Clearance {
            beyond_m: 0.0,
            margin_m: 0.0,
            by_depth: true,
        };
        self.tracks.withstand(
            |_| Freedom::Share(0.0),
            now.position_m,
            clearance,
            &self.meter,
        );
    }
}

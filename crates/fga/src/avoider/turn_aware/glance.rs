//! A glance at a way back that is not flown: whether it leads to an obstacle.

use crate::avoider::{Avoider, Plan};
use crate::certificate::{Hazard, Line};
use crate::limit::Limit as _;
use crate::mission::Way;
use crate::prediction::MotionState;
use crate::situation::Situation;

use super::NEXT_ENCOUNTER_S;
use super::way_back::passes_s;

/// A way that is not flown leads hardly farther than this from where it seems to, turn radii: without bank lag and with it.
const ROUGHLY: [f64; 2] = [0.002, 0.02];

/// It meets obstacles at most this much sooner or later, seconds.
const ROUGHLY_S: f64 = 0.5;

impl Avoider {
    /// Whether a way back leads into an obstacle, wherever in its neighbourhood it lies.
    pub(super) fn leads_to_obstacle(
        &self,
        way: &Way,
        index: usize,
        plan: &Plan,
        now: (&Situation<'_>, &MotionState),
    ) -> bool {
        let is_here = index == self.progress.index();
        self.is_blocked(way) || is_here && self.leads_back(way, plan, now)
    }

    /// Whether a way back leads into an obstacle that stands on it.
    fn is_blocked(&self, way: &Way) -> bool {
        let inside_m = self.target_m - self.roughly_m();
        let hazards = self.tracks.hazards().rows();
        way.lines().any(|(line, bow_m)| {
            let duration_s = line.duration_s.min(self.far_s - line.at_s);
            if duration_s <= 0.0 || !self.meter.take(hazards.len()) {
                return false;
            }
            let line = Line { duration_s, ..line };
            let into = |hazard: &Hazard| hazard.least_on_line(&line, inside_m - bow_m, &self.meter);
            hazards.iter().any(|hazard| into(hazard).is_some())
        })
    }

    /// Whether a way back onto the present leg leads into an obstacle of the same encounter once it is there.
    fn leads_back(
        &self,
        way: &Way,
        plan: &Plan,
        (situation, now): (&Situation<'_>, &MotionState),
    ) -> bool {
        let Some((end_m, end_s)) = way.end().map(|end| (end.at_m, end.at_s)) else {
            return false;
        };
        let leg = self.progress.leg(now);
        let (low, high) = self.climb_limits_rad();
        let on_leg = MotionState {
            course_rad: leg.air_course_rad,
            climb_rad: leg.climb_rad.limited(low, high),
            ..*now
        };
        let left_m = leg.length_m - leg.position(end_m, end_s).along_m;
        let left_s = left_m / leg.ground_speed_mps.max(f64::MIN_POSITIVE);
        let line = Line {
            from_m: end_m,
            velocity_mps: self.flyer.velocity_mps(&on_leg),
            at_s: end_s,
            duration_s: left_s.min(self.far_s - end_s).max(0.0),
        };
        let inside_m = self.target_m - self.roughly_m();
        let hazards = self.tracks.hazards().rows();
        if !self.meter.take(hazards.len()) {
            return false;
        }
        let mut same = hazards.iter().filter(|h| plan.against.contains(h.id));
        same.any(|hazard| {
            let until_s = passes_s(hazard, situation) + NEXT_ENCOUNTER_S - ROUGHLY_S;
            let into = hazard.least_on_line(&line, inside_m, &self.meter);
            into.is_some_and(|(_, at_s)| at_s < until_s && at_s < end_s + line.duration_s)
        })
    }

    /// Whether a way back comes too close to an obstacle that it passes under its first command, flown as it is. Most ways
    /// that lead to an obstacle do so there.
    pub(super) fn begins_too_close(&mut self, way: &Way, now: &MotionState) -> bool {
        let maneuver = way.shot.maneuver(now.time_s);
        let Some(second) = maneuver.stages().get(1) else {
            return false;
        };
        self.look_s = second.start_s;
        self.predict(&maneuver, now);
        let closest = self.certificate_of_path((f64::MIN, self.target_m));
        let passes = !self.meter.is_met() && closest.at_s < self.look_s;
        self.look_s = self.settings.horizon_s;
        passes && closest.margin_m < self.target_m
    }

    /// A way that is not flown leads hardly farther than this from where it seems to, metres.
    pub(super) fn roughly_m(&self) -> f64 {
        let [ideal, lagged] = ROUGHLY;
        let radii = if self.flyer.is_ideal() { ideal } else { lagged };
        radii * self.flyer.turn_radius_m()
    }
}

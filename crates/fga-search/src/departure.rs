//! How far a manoeuvre departs from the mission.

use fga_proof::Vec3;
use fga_proof::assumptions::Assumptions;
use fga_proof::certificate::certify_set;
use fga_proof::prediction::{MotionState, flown};

use super::tuned::LONGEST_PASS_S;
use super::{Departure, Search, Turns};

/// Conflicts of which one unit of work tells when they have passed.
const PASSED: usize = 4;

impl Search<'_> {
    /// How far the line on which a turn ends departs from the mission until the obstacles have passed.
    pub(super) fn departure_on(
        &mut self,
        wait_s: f64,
        end: &MotionState,
        velocity_mps: Vec3,
    ) -> Departure {
        let until_s = self.passed_s(wait_s, end, velocity_mps);
        let there_m = end.position_m + velocity_mps * (until_s - end.time_s);
        self.departure_at(there_m, until_s)
    }

    /// How far a manoeuvre departs from the mission until the obstacles that it avoids have passed.
    pub fn departure_of(&mut self, turns: &Turns) -> Departure {
        if self.limit_met() {
            return Departure::UNKNOWN;
        }
        let scene = self.scene;
        let from_rad = self.departure(turns.wait_s).course_rad;
        self.find_conflicts();
        self.predict(turns, from_rad);
        let last = self.path.nodes().last();
        let end = last.map_or(scene.start, |node| node.state);
        let until_s = self.passed_s(turns.wait_s, &end, self.path.end_velocity_mps());
        let there = self.path.state_at(scene.flyer, until_s);
        self.departure_at(there.unwrap_or(scene.start).position_m, until_s)
    }

    /// How far a place is from where the mission would have brought the aircraft by then.
    pub(super) fn departure_at(&self, there_m: Vec3, at_s: f64) -> Departure {
        let scene = self.scene;
        let nominal = scene.nominal.stages();
        let planned = flown(scene.flyer, &scene.start, nominal, at_s, &self.meter);
        let offset_m = there_m - planned.position_m;
        let behind_m = -offset_m.dot(self.along);
        Departure {
            aside_m: (offset_m + self.along * behind_m).length(),
            behind_m,
        }
    }

    /// When a manoeuvre that ends straight has passed what comes too close on the mission, seconds.
    fn passed_s(&mut self, wait_s: f64, end: &MotionState, end_velocity_mps: Vec3) -> f64 {
        self.find_conflicts();
        let conflicts = &*self.conflicts;
        let rows = self.scene.around.rows.iter().zip(&conflicts.marks);
        let rows = rows.filter_map(|(hazard, is_close)| is_close.then_some(hazard));
        if !self.meter.take(rows.clone().count().div_ceil(PASSED)) {
            return wait_s;
        }
        let passes_s = rows.map(|hazard| {
            let offset = end.position_m - hazard.position_after_m(end.time_s);
            let relative = end_velocity_mps - hazard.velocity_mps;
            let after_s = -offset.dot(relative) / relative.length_squared().max(1e-9);
            (end.time_s + after_s.max(0.0)).min(LONGEST_PASS_S)
        });
        passes_s.fold(wait_s.max(conflicts.closest_s), f64::max)
    }

    /// Finds what comes too close on the mission, once. Uses the path.
    #[inline(never)]
    fn find_conflicts(&mut self) {
        if self.conflicts.is_known || self.limit_met() {
            return;
        }
        self.conflicts.is_known = true;
        let scene = self.scene;
        let (start, horizon_s) = (&scene.start, scene.horizon_s);
        (self.path).predict_within(scene.flyer, start, scene.nominal, horizon_s, &self.meter);
        let asked = (scene.horizon_s, f64::MIN, scene.target_m);
        let conflicts = &mut *self.conflicts;
        for (hazard, mark) in scene.around.rows.iter().zip(&mut conflicts.marks) {
            if self.meter.is_met() {
                break;
            }
            let one = Assumptions::only(core::slice::from_ref(hazard));
            let closest = certify_set(scene.flyer, self.path, &one, asked, &self.meter);
            if closest.margin_m < scene.target_m {
                *mark = true;
                conflicts.closest_s = conflicts.closest_s.max(closest.at_s);
            }
        }
    }
}

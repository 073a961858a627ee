//! Decisions that need not be made: those of a pilot that flies straight on whatever it sees.
//!
//! Nothing happens in straight flight until it ends, so the engine flies it as one arc and measures it in
//! closed form. Its last cycles are flown one by one, which find the end as in every flight.

use fga::Vec3;
use fga::avoider::Decision;
use fga::pilot::Pilot;

use super::flight::EngineFlight;
use crate::track::Track;
use crate::whole::whole;
use crate::world::Ending;

/// A flight that drifts off its line by more than this is not straight along it, metres.
const ALONG_WITHIN_M: f64 = 1e-6;

impl EngineFlight<'_> {
    /// Number of cycles for which a decision stands whatever the pilot sees; at least one.
    pub(super) fn cycles_alike(
        &self,
        time_s: f64,
        decision: &Decision,
        pilot: &(impl Pilot + ?Sized),
    ) -> u32 {
        let stands_s = pilot.stands_s(&self.situation(time_s));
        let is_known = stands_s > 0.0
            && self.replaying().is_none()
            && self.state.progress.is_one_leg()
            && self.plant.is_straight_under(&decision.command);
        if is_known {
            self.straight_cycles(time_s, stands_s)
        } else {
            1
        }
    }

    /// Number of cycles of straight flight on which nothing ends; at least one.
    fn straight_cycles(&self, time_s: f64, stands_s: f64) -> u32 {
        let world = self.world;
        // Guidance corrects a drift once it has grown.
        let along = self.state.progress.direction();
        let drift_mps = self.plant.ground_velocity_mps().cross(along).length();
        let left_s = stands_s
            .min(ALONG_WITHIN_M / drift_mps)
            .min(world.horizon_s - time_s)
            .min(self.goes_on_s(time_s));
        let cycles = libm::floor(left_s / world.settings.avoider.decision_period_s) - 1.0;
        whole(cycles).max(1)
    }

    /// How long the flight cannot end before its horizon if the aircraft flies straight on, seconds.
    fn goes_on_s(&self, time_s: f64) -> f64 {
        if self.world.ending != Ending::BackAndPassed {
            return f64::INFINITY;
        }
        let position_m = self.plant.ownship().position_m;
        let velocity_mps = self.plant.ground_velocity_mps();
        let obstacles = &self.world.obstacles;
        obstacles.iter().fold(0.0, |latest_s: f64, obstacle| {
            latest_s.max(passes_in_s(
                &obstacle.track,
                time_s,
                position_m,
                velocity_mps,
            ))
        })
    }
}

/// When an aircraft that flies straight passes an obstacle, seconds from now; 0 where a track may bend.
fn passes_in_s(track: &Track, time_s: f64, position_m: Vec3, velocity_mps: Vec3) -> f64 {
    let (Track::Straight { .. }, Some((at_m, moving_mps))) = (track, track.at(time_s)) else {
        return 0.0;
    };
    let closing_mps = velocity_mps - moving_mps;
    let square = closing_mps.length_squared();
    if square > 0.0 {
        ((at_m - position_m).dot(closing_mps) / square).max(0.0)
    } else {
        0.0
    }
}

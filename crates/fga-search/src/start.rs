//! The latest moment at which a certified manoeuvre still exists: the exact counterpart of `t_c`.

use super::sweep::Sweep;
use super::{MAX_TURN_RAD, Search};
use fga_proof::angle::Side;
use fga_proof::prediction::MotionState;

/// Moments tried before halving.
const MOMENTS: u32 = 12;

/// Halvings between the last successful moment and the next failing one.
const HALVINGS: u32 = 6;

impl Search<'_> {
    /// Latest wait, seconds, at most `until_s`, after which a certified single turn exists.
    ///
    /// `until_s` is the time of the entry into a volume on the mission.
    pub fn latest_start_s(&mut self, until_s: f64) -> Option<f64> {
        let step_s = until_s.max(0.0) / f64::from(MOMENTS);
        let mut index = (0..=MOMENTS).rev();
        let last = index.find(|index| self.is_avoidable(f64::from(*index) * step_s))?;
        let mut latest_s = f64::from(last) * step_s;
        if last == MOMENTS {
            return Some(latest_s);
        }
        let mut width_s = step_s;
        for _ in 0..HALVINGS {
            width_s *= 0.5;
            if self.is_avoidable(latest_s + width_s) {
                latest_s += width_s;
            }
        }
        Some(latest_s)
    }

    /// Whether a certified single turn exists after a wait.
    pub fn is_avoidable(&mut self, wait_s: f64) -> bool {
        self.is_avoidable_within(wait_s, MAX_TURN_RAD)
    }

    /// Whether a certified single turn of at most `max_turn_rad` exists after a wait.
    pub fn is_avoidable_within(&mut self, wait_s: f64, max_turn_rad: f64) -> bool {
        let target_m = self.scene.target_m;
        let before_m = self.margin_before(wait_s);
        if before_m < target_m {
            return false;
        }
        let departure = self.departure(wait_s);
        let level_rad = self.scene.original.1;
        let mut climbs = self.scene.extreme_climbs().skip(1);
        let mut has_turn =
            |climb_rad| self.has_turn(&departure, before_m, &Side::BOTH, (climb_rad, max_turn_rad));
        has_turn(level_rad) || climbs.any(has_turn)
    }

    /// Whether a certified single turn to one of some sides exists at the original climb angle, or at the steepest
    /// climb or descent: where neither does, hardly ever does one in between.
    pub(super) fn has_extreme_turn(
        &mut self,
        from: &MotionState,
        before_m: f64,
        sides: &[Side],
    ) -> bool {
        let mut climbs = self.scene.extreme_climbs();
        climbs.any(|climb_rad| self.has_turn(from, before_m, sides, (climb_rad, MAX_TURN_RAD)))
    }

    fn has_turn(
        &mut self,
        from: &MotionState,
        before_m: f64,
        sides: &[Side],
        (climb_rad, max_turn_rad): (f64, f64),
    ) -> bool {
        let target_m = self.scene.target_m;
        sides.iter().any(|side| {
            let Some(from_rad) = self.first_turn_rad(from, *side, climb_rad) else {
                return false;
            };
            self.sweep(&Sweep {
                from: *from,
                first: None,
                before_m,
                side: *side,
                climb_rad,
                from_rad,
                max_turn_rad,
                floor_m: target_m,
                enough_m: target_m,
            })
            .is_some()
        })
    }
}

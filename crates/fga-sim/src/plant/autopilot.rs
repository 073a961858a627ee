//! The autopilot's controllers.

use fga::vehicle::Vehicle;

use super::pi_controller::PiController;

/// How commands become bank and climb.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Autopilot {
    /// Course and climb angle at their rate limits straight to the command.
    #[default]
    Direct,
    /// Proportional and integral control of course and climb angle (Eq. 13–14), rates limited.
    ProportionalIntegral {
        /// `K_p`, per second.
        proportional_per_s: f64,
        /// `K_i`, per second squared.
        integral_per_s2: f64,
    },
}

impl Autopilot {
    /// The controllers of course and climb angle at rest (Eq. 13, 14); none under the direct autopilot.
    pub(super) fn controllers(self, vehicle: &Vehicle) -> [Option<PiController>; 2] {
        let Self::ProportionalIntegral {
            proportional_per_s,
            integral_per_s2,
        } = self
        else {
            return [None; 2];
        };
        [vehicle.course_rate_radps(), vehicle.climb_rate_radps]
            .map(|limit| PiController::new(proportional_per_s, integral_per_s2, limit))
    }
}

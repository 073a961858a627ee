//! The autopilot's controllers.

use fga::vehicle::Vehicle;

use super::pi_controller::{PiController, PiGains};

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

/// The controllers of the PI autopilot (Eq. 13, 14); none under the direct one.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Controllers {
    pub(super) course: Option<PiController>,
    pub(super) climb: Option<PiController>,
}

impl Controllers {
    /// Controllers at rest.
    pub(super) fn new(autopilot: Autopilot, vehicle: &Vehicle) -> Self {
        let Autopilot::ProportionalIntegral {
            proportional_per_s,
            integral_per_s2,
        } = autopilot
        else {
            return Self::default();
        };
        let controller = |rate_limit_radps| {
            PiController::new(PiGains {
                proportional: proportional_per_s,
                integral: integral_per_s2,
                rate_limit_radps,
            })
        };
        Self {
            course: controller(vehicle.course_rate_radps()),
            climb: controller(vehicle.climb_rate_radps),
        }
    }
}

//! What a hand gets, and what it does.

use core::fmt::Debug;

use fga::maneuver::Maneuver;
use fga::vehicle::Vehicle;
use fga_formats::geodesy::LocalFrame;

use crate::commands::Commands;
use crate::mode::Mode;
use crate::outgoing::Outbox;
use crate::ownship::OwnState;
use crate::parameters::VehicleParameters;

/// A hand's access to the vehicle, and the knowledge about it.
pub struct HandReach<'a> {
    /// Messages to send.
    pub outbox: &'a mut Outbox,
    /// Commands with repetition until an answer.
    pub commands: &'a mut Commands,
    /// Parameters of the vehicle.
    pub parameters: &'a VehicleParameters,
    /// The local frame, once a position is known.
    pub frame: Option<&'a LocalFrame>,
    /// System id of the vehicle.
    pub system: u8,
    /// The vehicle's clock, milliseconds since it booted.
    pub boot_ms: u32,
    /// Measured airspeed, m/s; 0 if unknown.
    pub airspeed_mps: f64,
    /// Local clock, seconds.
    pub now_s: f64,
}

/// The order for now.
#[derive(Debug, Clone, Copy)]
pub struct HandTarget<'a> {
    /// The decision.
    pub maneuver: &'a Maneuver,
    /// Age of the decision, seconds.
    pub elapsed_s: f64,
    /// The aircraft when a command sent now takes effect.
    pub own: &'a OwnState,
    /// The limits of the plan.
    pub vehicle: &'a Vehicle,
    /// The largest bank to command, radians.
    pub bank_limit_rad: f64,
    /// Whether the vehicle has confirmed the hand's mode.
    pub is_confirmed: bool,
}

/// Flies the vehicle by the messages of one command mode.
pub trait Hand: Debug + Send {
    /// The vehicle's mode during a manoeuvre.
    fn mode(&self) -> Mode;

    /// The only mode from which it takes over; `None` leaves the choice to the configuration.
    fn takes_over_from(&self) -> Option<Mode> {
        None
    }

    /// Delay that the vehicle's answer to its commands adds to the bank's lag, seconds.
    fn lag_s(&self) -> f64 {
        0.0
    }

    /// Whether it commands a bank, and so can command a steeper one in need.
    fn commands_bank(&self) -> bool {
        false
    }

    /// Observes the vehicle while somebody else flies it.
    fn watch(&mut self, _own: &OwnState) {}

    /// Begins a manoeuvre.
    fn begin(&mut self) {}

    /// Commands a target. Returns the bank that the vehicle should take up, radians, positive to the
    /// left; `None` if no command was possible.
    fn fly(&mut self, target: &HandTarget<'_>, reach: &mut HandReach<'_>) -> Option<f64>;

    /// Commands straight flight during the return of the mode.
    fn fly_straight(&mut self, _reach: &mut HandReach<'_>) {}

    /// Cancels commands that the vehicle would go on following.
    fn let_go(&mut self, reach: &mut HandReach<'_>);
}

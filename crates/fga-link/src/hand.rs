//! How decisions reach the vehicle: one [`Hand`] for each command mode.
//!
//! | mode | hand | flown in |
//! |---|---|---|
//! | `attitude` | [`attitude`]: roll and pitch by `SET_ATTITUDE_TARGET` | GUIDED |
//! | `heading` | [`heading`]: heading and altitude by commands | GUIDED |
//! | `paper` | [`sticks`]: roll by `RC_CHANNELS_OVERRIDE`, as in Algorithm 4 | FBWB |

pub mod attitude;
pub mod heading;
pub mod sticks;

use core::fmt::Debug;

use fga::maneuver::Maneuver;
use fga::vehicle::Vehicle;
use fga_formats::geodesy::LocalFrame;

use crate::commands::Commands;
use crate::config::CommandMode;
use crate::mode::Mode;
use crate::outgoing::Outbox;
use crate::ownship::State;
use crate::parameters::VehicleParameters;

/// What a hand reaches the vehicle by, and what is known of the vehicle.
pub struct Reach<'a> {
    /// Messages to send.
    pub outbox: &'a mut Outbox,
    /// Commands that are repeated until they are answered.
    pub commands: &'a mut Commands,
    /// Parameters of the vehicle.
    pub parameters: &'a VehicleParameters,
    /// The local frame, once a position is known.
    pub frame: Option<&'a LocalFrame>,
    /// System id of the vehicle.
    pub system: u8,
    /// The vehicle's clock, milliseconds since it booted.
    pub boot_ms: u32,
    /// Measured airspeed, m/s; 0 where it is not known.
    pub airspeed_mps: f64,
    /// Local clock, seconds.
    pub now_s: f64,
}

/// What is to be flown now.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// What was decided.
    pub maneuver: &'a Maneuver,
    /// How long ago it was decided, seconds.
    pub elapsed_s: f64,
    /// The aircraft when a command of now takes effect.
    pub own: &'a State,
    /// The limits that the manoeuvre was planned with.
    pub vehicle: &'a Vehicle,
    /// The largest bank to command, radians.
    pub bank_limit_rad: f64,
    /// Whether the vehicle has confirmed the mode that the hand flies in.
    pub is_confirmed: bool,
}

/// Flies the vehicle as decided, by the messages of one command mode.
pub trait Hand: Debug + Send {
    /// The mode that the vehicle is flown in.
    fn mode(&self) -> Mode;

    /// The only mode from which it takes over; `None` leaves that to the configuration.
    fn takes_over_from(&self) -> Option<Mode> {
        None
    }

    /// What the vehicle's answer to its commands adds to the bank's lag, seconds.
    fn lag_s(&self) -> f64 {
        0.0
    }

    /// Whether it commands a bank, so that it can command a steeper one in need.
    fn commands_bank(&self) -> bool {
        false
    }

    /// Watches the vehicle while somebody else flies it.
    fn watch(&mut self, _own: &State) {}

    /// A manoeuvre begins.
    fn begin(&mut self) {}

    /// Commands a target. Returns the bank that the vehicle should take up, radians, positive to the
    /// left; `None` where nothing could be commanded.
    fn fly(&mut self, target: &Target<'_>, reach: &mut Reach<'_>) -> Option<f64>;

    /// Asks for straight flight while the vehicle is given back.
    fn fly_straight(&mut self, _reach: &mut Reach<'_>) {}

    /// Takes back whatever the vehicle would go on following.
    fn let_go(&mut self, reach: &mut Reach<'_>);
}

/// The hand of a command mode.
pub fn of(mode: CommandMode) -> Box<dyn Hand> {
    match mode {
        CommandMode::Attitude => Box::new(attitude::AttitudeHand::default()),
        CommandMode::Heading => Box::new(heading::HeadingHand::default()),
        CommandMode::Paper => Box::new(sticks::StickHand),
    }
}

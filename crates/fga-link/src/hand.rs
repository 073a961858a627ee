//! How decisions reach the vehicle: one [`Hand`] for each command mode.
//!
//! | mode | hand | flown in |
//! |---|---|---|
//! | `attitude` | [`attitude`]: roll and pitch by `SET_ATTITUDE_TARGET` | GUIDED |
//! | `heading` | [`heading`]: heading and altitude by commands | GUIDED |
//! | `paper` | [`sticks`]: roll by `RC_CHANNELS_OVERRIDE`, as in Algorithm 4 | FBWB |

pub mod attitude;
pub mod heading;
mod reach;
pub mod sticks;

pub use reach::{Hand, HandReach, HandTarget};

use crate::config::CommandMode;

/// The hand of a command mode.
pub fn of(mode: CommandMode) -> Box<dyn Hand> {
    match mode {
        CommandMode::Attitude => Box::new(attitude::AttitudeHand::default()),
        CommandMode::Heading => Box::new(heading::HeadingHand::default()),
        CommandMode::Paper => Box::new(sticks::StickHand::default()),
    }
}

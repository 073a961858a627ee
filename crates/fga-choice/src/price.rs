//! Prices, in metres of departure from the mission: what a user may weigh.
//!
//! Taken from an experiment on the campaign `campaigns/low-altitude-adsb.toml` (another filter, the same kind of choice), but the price of a
//! loss: 30,000 m leave 0.021 of the losses of well clear there, and act in 12.5 of 100 encounters that stay well clear, 378 m aside; 60,000 m
//! leave 0.023, in 15, 443 m aside (1,000 encounters, seed 2). In recorded flights, well clear, 1 Hz with σ of 15 m and all delays, 21 and 11
//! losses of 164 are left. What lies between them is a choice. The filter of these measurements expected turns 1.2 times as often.

use crate::chance::Chance;

/// A loss of the protected volume, metres.
pub const LOSS_M: f64 = 40_000.0;

/// The inner part of the volume, as a multiple of a loss.
pub const INNER: f64 = 0.5;

/// A near mid-air collision, as a multiple of a loss.
pub const COLLISION: f64 = 5.0;

/// A metre of extra path, metres.
pub const EXTRA_PATH: f64 = 2.0;

/// A second away from the mission, metres.
pub const SECOND_M: f64 = 10.0;

/// A manoeuvre that begins, metres, where a loss is not likely.
pub const START_M: f64 = 300.0;

/// Another manoeuvre than the present one, metres.
pub const CHANGE_M: f64 = 300.0;

/// Another manoeuvre must save this share of what the present one costs, up to half of a loss: a cost is that of a few futures, seen through
/// noise. Without it recorded flights, well clear, seen once a second with σ of 15 m and all delays, leave 16 losses of 164 and turn to the other
/// side more than three times in 87 encounters; with it 9 and 11.
pub const CHANGE_SHARE: f64 = 0.3;

/// A conflict that is waited for ends by itself within this time, seconds, in 63 of 100 cases that end.
pub const DISSOLVES_S: f64 = 10.0;

/// A smaller chance of a loss on the mission counts as 0.
const NO_CHANCE: f64 = 1e-4;

/// The same for each minute away from the mission, after the first one: who flies alongside must not keep an aircraft away for ever.
const NO_CHANCE_A_MINUTE: f64 = 0.01;

/// The chance of a loss on the mission that counts as 0 after some seconds away from it.
pub(crate) fn no_chance(away_s: f64) -> f64 {
    if away_s < 60.0 {
        NO_CHANCE
    } else {
        NO_CHANCE_A_MINUTE * away_s / 60.0
    }
}

/// The price of some chances, metres.
pub(crate) fn loss_m(chance: &Chance) -> f64 {
    LOSS_M * (chance.loss + INNER * chance.inner + COLLISION * chance.collision)
}

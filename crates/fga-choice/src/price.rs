//! Prices, in metres of departure from the mission: what a user may weigh.
//!
//! What lies between them is a choice. It was measured on the first 600 encounters of seeds 1 and 2 of `campaigns/low-altitude-adsb.toml`: 713
//! losses of well clear, 487 that stay well clear, the median of the departure. Recorded flights are once a second, σ of 15 m, all delays, four
//! draws: 164 losses of well clear, and how many of 232 flights change the side of their bank more than three times.
//!
//! | loss, start, change | losses left | acted needlessly | departure | recorded flights: left, change sides |
//! |---|---|---|---|---|
//! | 30,000 m, 1,500 m, 120 m | 14 | 72 | 289 m | 10, 92 |
//! | 40,000 m, 2,200 m, 160 m | 11 | 68 | 332 m | 10, 83 |
//! | 45,000 m, 2,700 m, 200 m | 13 | 64 | 371 m | 7, 72 |
//! | 40,000 m, 2,600 m, 200 m; extra path 0.4, a second 2 m | 12 | 61 | 401 m | 9, 63 |
//! | 50,000 m, 2,800 m, 200 m; the same | 9 | 64 | 407 m | 7, 66 |
//! | these | 12 | 64 | 364 m | 8, 67 |

use crate::chance::Chance;

/// A loss of the protected volume, metres, where nobody says another price.
pub const LOSS_M: f64 = 42_000.0;

/// The inner part of the volume, as a multiple of a loss.
pub const INNER: f64 = 0.5;

/// A near mid-air collision, as a multiple of a loss.
pub const COLLISION: f64 = 5.0;

/// A metre of extra path, metres.
pub const EXTRA_PATH: f64 = 0.7;

/// A second away from the mission, metres.
pub const SECOND_M: f64 = 3.5;

/// The start of a manoeuvre, metres, less the chance of a loss on the mission; the whole price while the aircraft is away from the mission.
pub const START_M: f64 = 2500.0;

/// Another manoeuvre than the present one, or a way back that may be left again, metres.
pub const CHANGE_M: f64 = 200.0;

/// What a change costs however small it is, as a share of [`CHANGE_M`].
pub const SMALL_CHANGE: f64 = 0.4;

/// Another manoeuvre must save this share of what the present one costs, at most of half a loss, because costs are estimates. In the recorded
/// flights, as above, a tenth left 6 of 164 losses, 720 m aside, when it was chosen; three tenths left 7, 825 m aside. Without it, and with
/// futures that did not wander, the aircraft turned to the other side more than three times in 87 of 232 flights.
pub const CHANGE_SHARE: f64 = 0.1;

/// What the mission may cost by chances of a loss that counts as nothing, as a share of a loss.
const NO_LOSS: f64 = 1e-4;

/// The same for each minute away from the mission, after the first one: an aircraft alongside must not keep ours away for ever.
const NO_LOSS_A_MINUTE: f64 = 0.01;

/// The largest of these shares.
const MOST_NO_LOSS: f64 = 0.1;

/// What the mission may cost by chances of a loss that counts as nothing, after some seconds away from it, as a share of a loss.
pub(crate) fn no_loss(away_s: f64) -> f64 {
    if away_s < 60.0 {
        NO_LOSS
    } else {
        (NO_LOSS + NO_LOSS_A_MINUTE * (away_s - 60.0) / 60.0).min(MOST_NO_LOSS)
    }
}

/// The price of a start, metres, for what the mission meets.
pub(crate) fn starts_m(hold: &Chance, is_away: bool) -> f64 {
    if is_away {
        START_M
    } else {
        START_M * (1.0 - hold.loss.min(1.0))
    }
}

/// How many losses some chances are.
pub(crate) fn losses(chance: &Chance) -> f64 {
    chance.loss + INNER * chance.inner + COLLISION * chance.collision
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_of_no_loss_grows_without_a_step() {
        for second in 0..600 {
            let step = no_loss(f64::from(second + 1)) - no_loss(f64::from(second));
            assert!((0.0..2e-4).contains(&step), "{second}: {step}");
        }
        assert_eq!(no_loss(0.0), NO_LOSS);
    }
}

//! When a way back that leads to an obstacle is worth another look.
//!
//! From look to look a way back leads into an obstacle by fewer metres or by more. It is not looked at again before it could
//! be clear, as far as that trend tells.

use crate::avoider::Plan;

use super::way_back::{INTERCEPTS, INTERCEPTS_RAD};

/// Another look follows after this long at the latest, seconds: at the nearest way and where more than one angle leads the
/// same way, and at each of the others.
const MOST_S: [f64; 2] = [1.0, 4.0];

/// Another look follows once the trend has led out of the obstacle by this share.
const SHARE: f64 = 0.5;

/// The intercept angles for which a way back was looked at.
pub(super) struct Places {
    /// The one that it was looked at for.
    pub place: usize,
    /// From this intercept angle on it is the same, radians.
    pub same_from_rad: f64,
}

/// Rounding of times, seconds: a moment has come this much before it.
const ROUNDING_S: f64 = 1e-6;

/// A look at a way back that led into an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Refusal {
    /// When it was, and when another is worth it, seconds on the situation's clock.
    time_s: f64,
    until_s: f64,
    /// By how much the way led into the obstacle, metres.
    into_m: f64,
}

/// The last looks at ways back that led to obstacles, by intercept angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::avoider) struct Refusals {
    /// When the manoeuvre was decided from which they lead back, seconds on the situation's clock.
    decided_s: f64,
    all: [Option<Refusal>; INTERCEPTS],
}

impl Refusals {
    /// None yet.
    pub(in crate::avoider) const NONE: Self = Self {
        decided_s: f64::NEG_INFINITY,
        all: [None; INTERCEPTS],
    };

    fn of(&self, place: usize, plan: &Plan) -> Option<Refusal> {
        let refusal = self.all.get(place).copied().flatten();
        refusal.filter(|_| self.decided_s == plan.decided_s)
    }

    /// Whether the way back at an intercept angle still leads to an obstacle, as far as the last looks tell.
    pub(super) fn holds(&self, place: usize, plan: &Plan, time_s: f64) -> bool {
        // A clock that was set back leaves moments that are too late.
        self.of(place, plan)
            .is_some_and(|last| time_s >= last.time_s && time_s + ROUNDING_S < last.until_s)
    }

    /// Remembers a look at a way back that leads into an obstacle by some metres.
    pub(super) fn refuse(&mut self, places: &Places, plan: &Plan, (time_s, into_m): (f64, f64)) {
        if self.decided_s != plan.decided_s {
            *self = Self {
                decided_s: plan.decided_s,
                ..Self::NONE
            };
        }
        let slots = self.all.iter_mut().zip(INTERCEPTS_RAD).enumerate();
        for (place, (slot, intercept_rad)) in slots {
            let is_same = intercept_rad >= places.same_from_rad;
            if place != places.place && !is_same {
                continue;
            }
            let [soon_s, late_s] = MOST_S;
            let most_s = if place == 0 || is_same {
                soon_s
            } else {
                late_s
            };
            let for_s = slot.map_or(0.0, |before| {
                let out_m = before.into_m - into_m;
                let passed_s = time_s - before.time_s;
                if out_m > 0.0 {
                    (SHARE * into_m * passed_s / out_m).min(most_s)
                } else {
                    most_s
                }
            });
            *slot = Some(Refusal {
                time_s,
                until_s: time_s + for_s.max(0.0),
                into_m,
            });
        }
    }
}

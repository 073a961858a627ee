//! Gaps in the telemetry: the companion flies on a proven manoeuvre, from the last known state.
//!
//! The commands since then are known, and so is the vehicle's response; the prediction loses value with
//! every second, and the obstacles grow by the same amount. Decisions continue with that. The companion
//! restores the mode when nothing is proven any more, unless the restored course is known to collide: then
//! that is the last choice.

use super::voice::Voice;
use crate::authority::Severity;

/// Least time to fly on, seconds …
const LEAST_BLIND_S: f64 = 3.0;
/// … and longest time, seconds.
pub(super) const MOST_BLIND_S: f64 = 8.0;
/// The companion reports a gap that lasts this long, s.
const TOLD_S: f64 = 1.5;
/// Possible error of the prediction's acceleration, metres per second squared: gusts, and a turn rate
/// known to a few per cent.
const UNKNOWN_MPS2: f64 = 0.8;

/// The reports about the present gap.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gap {
    begun: bool,
    collision: bool,
}

/// Extra uncertainty of our own position after a gap of `age_s`, m.
pub(super) fn growth_m(age_s: f64) -> f64 {
    let age_s = age_s.min(MOST_BLIND_S);
    0.5 * UNKNOWN_MPS2 * age_s * age_s
}

impl Gap {
    /// Telemetry is here again, or somebody else flies.
    pub(super) fn end(&mut self) {
        *self = Self::default();
    }

    /// Whether the gap has lasted too long: nothing is proven any more, and the restored course is not known to collide.
    pub(super) fn is_over(
        &mut self,
        age_s: f64,
        is_proven: bool,
        collides: bool,
        voice: &mut Voice,
    ) -> bool {
        if age_s > TOLD_S && !core::mem::replace(&mut self.begun, true) {
            voice.warn("fga: no telemetry, flies on as proven");
        }
        if is_proven || age_s <= LEAST_BLIND_S {
            return false;
        }
        if collides && !core::mem::replace(&mut self.collision, true) {
            let words = "fga: no telemetry, not given back: collision";
            voice.tell(Severity::Critical, words);
        }
        !collides
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_ends_when_nothing_is_proven_unless_the_vehicle_would_collide() {
        let (mut gap, mut voice) = (Gap::default(), Voice::default());
        let mut judge = |age_s, is_proven, collides| {
            let over = gap.is_over(age_s, is_proven, collides, &mut voice);
            (over, voice.texts())
        };
        assert_eq!(judge(1.0, false, false), (false, 0));
        assert_eq!(judge(2.0, false, false), (false, 1));
        assert_eq!(judge(4.0, true, false), (false, 1));
        assert_eq!(judge(4.0, false, true), (false, 2));
        assert_eq!(judge(5.0, false, true), (false, 2), "told once");
        assert_eq!(judge(6.0, false, false), (true, 2));
        // Half of 0.8 m/s² over 5 s, and no more than over 8 s.
        assert!((growth_m(5.0) - 10.0).abs() < 1e-9);
        assert_eq!(growth_m(100.0), growth_m(8.0));
    }
}

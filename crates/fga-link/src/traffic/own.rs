//! Is a received aircraft the vehicle's own transponder?
//!
//! Each report checks that belief: reports of our transponder lie on the way that the
//! vehicle has just flown, at its speed, some seconds late. When they do not, it is another aircraft.

use alloc::collections::VecDeque;

use fga::Vec3;

/// Memory of the flown way, seconds, and its resolution.
const KEPT_S: f64 = 8.0;
const SPACING_S: f64 = 0.2;
/// A report of our transponder is at most this late, and this early by the prediction of our own state, seconds.
const LATE_S: f64 = 4.0;
const EARLY_S: f64 = 0.6;
/// The belief begins when reports lie this near for this long.
const PLACE_M: f64 = 40.0;
const HEIGHT_M: f64 = 30.0;
const VELOCITY_MPS: f64 = 5.0;
const FOR_S: f64 = 8.0;
/// The belief continues while they lie this near; a second report that does not ends it.
const KEPT_PLACE_M: f64 = 60.0;
const KEPT_HEIGHT_M: f64 = 50.0;
const KEPT_VELOCITY_MPS: f64 = 8.0;
const MOST_MISSES: u8 = 2;

/// The way that the vehicle has just flown.
#[derive(Debug, Clone, Default)]
pub struct FlownWay {
    samples: VecDeque<(f64, Vec3, Vec3)>,
}

/// A report for the comparison with the flown way.
#[derive(Debug, Clone, Copy)]
pub struct OwnReport {
    /// Its time of validity, seconds.
    pub valid_s: f64,
    /// Position, metres, local frame.
    pub position_m: Vec3,
    /// Velocity over the ground, metres per second.
    pub velocity_mps: Vec3,
    /// Possible error of its height, metres.
    pub height_bound_m: f64,
}

/// The belief about one track.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OwnTransponder {
    since_s: Option<f64>,
    held: bool,
    misses: u8,
}

impl FlownWay {
    /// Adds the vehicle's state.
    pub fn push(&mut self, at_s: f64, position_m: Vec3, velocity_mps: Vec3) {
        if let Some((last_s, ..)) = self.samples.back() {
            // A clock that went back, or a state that is no later.
            if at_s < *last_s {
                self.samples.clear();
            } else if at_s - last_s < SPACING_S {
                return;
            }
        }
        self.samples.push_back((at_s, position_m, velocity_mps));
        while self
            .samples
            .front()
            .is_some_and(|(first_s, ..)| at_s - first_s > KEPT_S)
        {
            self.samples.pop_front();
        }
    }

    /// Forgets it.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// Whether a report lies on the flown way.
    fn holds(&self, seen: &OwnReport, place_m: f64, height_m: f64, velocity_mps: f64) -> bool {
        self.samples
            .iter()
            .filter(|(at_s, ..)| (-LATE_S..=EARLY_S).contains(&(at_s - seen.valid_s)))
            .any(|(_, own_m, own_mps)| {
                let offset = seen.position_m - *own_m;
                libm::hypot(offset.x, offset.y) < place_m
                    && offset.z.abs() < height_m + seen.height_bound_m
                    && seen.velocity_mps.distance(*own_mps) < velocity_mps
            })
    }
}

impl OwnTransponder {
    /// Whether it counts as our transponder.
    pub const fn holds(&self) -> bool {
        self.held
    }

    /// Checks it with a new report; `named` if the configuration names this aircraft as ours.
    pub fn check(&mut self, seen: &OwnReport, flown: &FlownWay, named: bool, now_s: f64) {
        if self.held {
            let kept = flown.holds(seen, KEPT_PLACE_M, KEPT_HEIGHT_M, KEPT_VELOCITY_MPS);
            self.misses = if kept { 0 } else { self.misses + 1 };
            if self.misses >= MOST_MISSES {
                *self = Self::default();
            }
            return;
        }
        if !flown.holds(seen, PLACE_M, HEIGHT_M, VELOCITY_MPS) {
            self.since_s = None;
            return;
        }
        let since_s = *self.since_s.get_or_insert(now_s);
        self.held = named || now_s - since_s >= FOR_S;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flown() -> FlownWay {
        let mut flown = FlownWay::default();
        for n in 0..40_u8 {
            let at_s = f64::from(n) * 0.2;
            flown.push(at_s, Vec3::Y * (25.0 * at_s), Vec3::Y * 25.0);
        }
        flown
    }

    fn seen(at_s: f64, north_m: f64, north_mps: f64) -> OwnReport {
        OwnReport {
            valid_s: at_s,
            position_m: Vec3::Y * north_m,
            velocity_mps: Vec3::Y * north_mps,
            height_bound_m: 0.0,
        }
    }

    #[test]
    fn a_late_transponder_is_believed_and_then_not() {
        let flown = flown();
        let mut belief = OwnTransponder::default();
        // 2 s late.
        belief.check(&seen(7.8, 145.0, 25.0), &flown, false, 0.0);
        assert!(!belief.holds());
        belief.check(&seen(7.8, 145.0, 25.0), &flown, false, 8.0);
        assert!(belief.holds());
        belief.check(&seen(7.8, 600.0, 25.0), &flown, false, 9.0);
        assert!(belief.holds(), "one stray report");
        belief.check(&seen(7.8, 600.0, 25.0), &flown, false, 10.0);
        assert!(!belief.holds());
    }

    #[test]
    fn an_aircraft_that_meets_the_vehicle_is_not_its_transponder() {
        let flown = flown();
        let mut belief = OwnTransponder::default();
        for now_s in 0..20_u8 {
            belief.check(&seen(7.8, 195.0, -25.0), &flown, true, f64::from(now_s));
            assert!(!belief.holds());
        }
    }
}

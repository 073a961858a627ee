//! The height that a flight keeps above the ground, looked up along the flown track.
//!
//! The ground is a function: the height of a place above it, metres; `None` where the ground is unknown.

use fga_proof::Vec3;

use crate::arc::Arc;
use crate::separation::Least;

/// A track is looked at each time it has flown as far as this, metres.
const LOOK_M: f64 = 0.25;

/// The least height of a flight above the ground so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundSeparation {
    /// Least height above known ground, metres, and its time; infinite where none was known.
    pub least: Least,
    /// When the aircraft was first over unknown ground, seconds.
    pub unknown_s: Option<f64>,
}

impl GroundSeparation {
    /// Measured at the start of a flight.
    pub fn begun(above_m: impl Fn(Vec3) -> Option<f64>, at_m: Vec3) -> Self {
        let mut separation = Self {
            least: Least::NONE,
            unknown_s: None,
        };
        separation.note(above_m(at_m), 0.0);
        separation
    }

    /// Measures a flown arc.
    pub fn observe(&mut self, above_m: impl Fn(Vec3) -> Option<f64>, arc: &Arc) {
        let steps = libm::ceil(arc.speed_bound_mps() * arc.duration_s / LOOK_M).max(1.0);
        let mut step = 1.0;
        while step <= steps {
            let after_s = arc.duration_s * step / steps;
            self.note(above_m(arc.position_at_m(after_s)), arc.start_s + after_s);
            step += 1.0;
        }
    }

    fn note(&mut self, above_m: Option<f64>, time_s: f64) {
        match above_m {
            Some(value_m) => self.least.note(value_m, time_s),
            None => {
                self.unknown_s.get_or_insert(time_s);
            }
        }
    }
}

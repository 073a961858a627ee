//! The height that a flight of a world keeps above the ground.
//!
//! It is looked up along the flown track with code of its own: it shares nothing with the certificate.

use fga::Vec3;
pub use fga_formats::terrain::LocalGround as WorldGround;

use crate::plant::Arc;
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
    pub(crate) fn begun(ground: &WorldGround, at_m: Vec3) -> Self {
        let mut separation = Self {
            least: Least::NONE,
            unknown_s: None,
        };
        separation.note(ground, at_m, 0.0);
        separation
    }

    /// Measures a flown arc.
    pub(crate) fn observe(&mut self, ground: &WorldGround, arc: &Arc) {
        let steps = libm::ceil(arc.speed_bound_mps() * arc.duration_s / LOOK_M).max(1.0);
        let mut step = 1.0;
        while step <= steps {
            let after_s = arc.duration_s * step / steps;
            self.note(ground, arc.position_at_m(after_s), arc.start_s + after_s);
            step += 1.0;
        }
    }

    fn note(&mut self, ground: &WorldGround, at_m: Vec3, time_s: f64) {
        match ground.above_m(at_m) {
            Some(value_m) => self.least.note(value_m, time_s),
            None => {
                self.unknown_s.get_or_insert(time_s);
            }
        }
    }
}

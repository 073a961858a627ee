//! Whether a path stays clear of moving volumes, certified in continuous time.

use super::path::DubinsPath;
use fga::certificate::Hazard;

/// Resolution of the certificate, metres: it may call a separation violated that exceeds the wanted one
/// by up to this, but never calls a lower one clear.
const RESOLUTION_M: f64 = 0.01;
/// Most steps along one path.
const MAX_STEPS: u32 = 100_000;

/// The result of flying a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clearance {
    /// The separation from every volume is at least the wanted margin all the way.
    Clear {
        /// A lower bound of the least signed distance to the volumes, metres; infinite without any.
        least_margin_m: f64,
    },
    /// It comes too near.
    Violated {
        /// Time, seconds from the start.
        at_s: f64,
        /// Signed distance at that time, metres.
        margin_m: f64,
    },
    /// The path needs too many steps for certainty, or a number is not finite: treat it as violated.
    Undecided,
}

impl Clearance {
    /// Whether it is certified clear.
    pub const fn is_clear(&self) -> bool {
        matches!(self, Self::Clear { .. })
    }
}

impl DubinsPath {
    /// Flies the path at a constant total airspeed among obstacles on straight courses, from their
    /// positions at its start, and keeps `margin_m` from their volumes.
    ///
    /// Conservative advancement: the margin m cannot shrink faster than the closing speed v, so for
    /// (m − wanted)/v seconds nothing can happen. Any answer but [`Clearance::Clear`] may be
    /// pessimistic by a centimetre; that one never is.
    pub fn clearance(&self, airspeed_mps: f64, obstacles: &[Hazard], margin_m: f64) -> Clearance {
        let usable = airspeed_mps.is_finite() && airspeed_mps > 0.0 && margin_m.is_finite();
        let duration_s = self.duration_s(airspeed_mps);
        if !usable || !duration_s.is_finite() || !obstacles.iter().all(|row| row.is_valid()) {
            return Clearance::Undecided;
        }
        let level_mps = airspeed_mps * libm::cos(self.climb_rad());
        let fastest_mps = obstacles
            .iter()
            .map(|obstacle| obstacle.velocity_mps.length())
            .fold(0.0, f64::max);
        let (mut at_s, mut least_m) = (0.0, f64::INFINITY);
        for _ in 0..MAX_STEPS {
            let position_m = self.sample(level_mps * at_s).position_m;
            let now_m = obstacles
                .iter()
                .map(|o| o.volume.margin_m(position_m - o.position_after_m(at_s)))
                .fold(f64::INFINITY, f64::min);
            if now_m < margin_m + RESOLUTION_M {
                return Clearance::Violated {
                    at_s,
                    margin_m: now_m,
                };
            }
            // Half way to the wanted margin: the bound of the step is the other half.
            let spare_m = (now_m - margin_m) / 2.0;
            least_m = least_m.min(now_m - spare_m);
            if at_s >= duration_s {
                return Clearance::Clear {
                    least_margin_m: least_m,
                };
            }
            at_s = (at_s + spare_m / (airspeed_mps + fastest_mps)).min(duration_s);
        }
        Clearance::Undecided
    }
}

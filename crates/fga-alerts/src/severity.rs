//! The severity of a loss of well clear.
//!
//! The severity of RTCA DO-365 (`SLoWC`) is 0 on the edge of well clear and 1 at a collision: the
//! Fernández-Guasti norm joins the depths in range, miss distance and height.

use crate::aircraft::Pair;
use crate::plane::time_to_closest_s;
use crate::volume::WellClear;

/// Joins two depths: 0 only if both are 0, 1 if either is 1.
fn join(a: f64, b: f64) -> f64 {
    libm::sqrt((a * a + (1.0 - a * a) * b * b).clamp(0.0, 1.0))
}

/// Severity of a loss of well clear now, from 0 to 1; `None` while well clear.
///
/// The range counts against the distance at which this closing speed violates the modified tau.
pub fn severity(volume: &WellClear, pair: &Pair) -> Option<f64> {
    if !volume.is_violated(pair) {
        return None;
    }
    let (s, v) = pair.plane();
    let (height_m, _) = pair.vertical();
    let range_m = s.length();
    let reach_m = volume.distance_m;
    let closing_mps = if range_m > 0.0 {
        (-s.dot(v) / range_m).max(0.0)
    } else {
        0.0
    };
    let tau_m = closing_mps * volume.tau_s;
    let edge_m = 0.5 * (libm::sqrt(tau_m * tau_m + 4.0 * reach_m * reach_m) + tau_m);
    let closest_s = time_to_closest_s(s, v).map_or(0.0, |time_s| time_s.max(0.0));
    let miss_m = (s + v * closest_s).length();
    let part = |value: f64, of: f64| if of > 0.0 { (value / of).min(1.0) } else { 1.0 };
    let range = part(range_m, edge_m.max(reach_m));
    let miss = part(miss_m, reach_m);
    let height = part(height_m.abs(), volume.height_m);
    Some(1.0 - join(join(range, miss), height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::AircraftState;
    use glam::DVec3;

    fn pair(position_m: DVec3, velocity_mps: DVec3) -> Pair {
        let ownship = AircraftState {
            position_m,
            velocity_mps,
        };
        Pair::exact(ownship, AircraftState::default())
    }

    #[test]
    fn severity_goes_from_nothing_at_the_edge_to_one_at_a_collision() {
        let volume = WellClear::EN_ROUTE;
        let at = |x, z| severity(&volume, &pair(DVec3::new(x, 0.0, z), DVec3::ZERO));
        assert_eq!(at(volume.distance_m + 1.0, 0.0), None);
        assert!(at(volume.distance_m, 0.0).unwrap() < 1e-9);
        assert!(at(0.0, volume.height_m).unwrap() < 1e-9);
        assert!((at(0.0, 0.0).unwrap() - 1.0).abs() < 1e-12);
        // Half as deep in range and miss distance, level: 1 − √(¼ + ¾·¼).
        let half = at(volume.distance_m / 2.0, 0.0).unwrap();
        assert!((half - (1.0 - 0.4375_f64.sqrt())).abs() < 1e-12, "{half}");
    }

    #[test]
    fn a_fast_approach_far_out_is_no_severe_loss() {
        let volume = WellClear::EN_ROUTE;
        let found = pair(DVec3::new(0.0, -9000.0, 0.0), DVec3::new(0.0, 280.0, 0.0));
        let severity = severity(&volume, &found).unwrap();
        assert!((0.0..0.2).contains(&severity), "{severity}");
    }
}

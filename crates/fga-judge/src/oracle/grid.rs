//! The resolution of the tree: the values of wait, turn, straight and climb angle.

use super::OracleVehicle;

/// The resolution of the tree.
pub(super) struct OracleGrid {
    pub(super) waits_s: Vec<f64>,
    pub(super) straights_s: Vec<f64>,
    pub(super) turns_rad: Vec<f64>,
    pub(super) climbs: Vec<f64>,
    /// Largest distance of a seed's margin below the best leaf, metres.
    pub(super) slack_m: f64,
    /// Number of refined seeds.
    pub(super) seeds: usize,
}

pub(super) fn degrees(list: &[(f64, f64, f64)]) -> Vec<f64> {
    let mut angles = vec![0.0];
    for &(from, to, step) in list {
        let mut at = from;
        while at <= to + 1e-9 {
            angles.push(at.to_radians());
            at += step;
        }
    }
    angles
}

impl OracleGrid {
    pub(super) fn one_turn(vehicle: &OracleVehicle, horizon_s: f64) -> Self {
        let most = (vehicle.course_rate_radps * horizon_s).to_degrees();
        Self {
            waits_s: (0..=40).map(|k| 0.5 * f64::from(k)).collect(),
            straights_s: Vec::new(),
            turns_rad: degrees(&[(2.5, 40.0, 2.5), (45.0, 360.0, 7.5), (375.0, most, 15.0)]),
            climbs: climbs(vehicle, 5),
            slack_m: 5.0,
            seeds: 16,
        }
    }

    pub(super) fn coarse(vehicle: &OracleVehicle) -> Self {
        Self {
            waits_s: vec![0.0, 1.0, 3.0, 7.0],
            straights_s: vec![0.0, 1.0, 2.0, 3.5, 6.0, 10.0],
            turns_rad: degrees(&[
                (5.0, 5.0, 1.0),
                (12.0, 12.0, 1.0),
                (20.0, 30.0, 10.0),
                (45.0, 90.0, 15.0),
                (110.0, 150.0, 20.0),
                (180.0, 330.0, 30.0),
            ]),
            climbs: climbs(vehicle, 3),
            slack_m: 8.0,
            seeds: 48,
        }
    }

    pub(super) fn fine(vehicle: &OracleVehicle) -> Self {
        Self {
            waits_s: vec![0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 14.0],
            straights_s: vec![0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0, 20.0],
            turns_rad: degrees(&[
                (4.0, 4.0, 1.0),
                (8.0, 8.0, 1.0),
                (15.0, 180.0, 7.5),
                (195.0, 360.0, 15.0),
            ]),
            climbs: climbs(vehicle, 5),
            slack_m: 3.0,
            seeds: 48,
        }
    }
}

/// `count` (odd) climb angles from the steepest climb to the steepest descent, level first.
pub(super) fn climbs(vehicle: &OracleVehicle, count: usize) -> Vec<f64> {
    let mut all = vec![0.0];
    if vehicle.can_climb() {
        let half = count / 2;
        for k in (1..=half).rev() {
            let share = k as f64 / half as f64;
            all.push(vehicle.climb_max_rad * share);
            all.push(vehicle.climb_min_rad * share);
        }
    }
    all
}

//! The protected distance from its four parts (Eq. 15).

/// The parts of the protected distance, metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProtectionTerms {
    /// `d_ma`: for the obstacle's size and speed.
    pub obstacle_m: f64,
    /// `d_mu`: for the aircraft's own size and speed.
    pub ownship_m: f64,
    /// `d_lim,air`: for airspace limitations.
    pub airspace_m: f64,
    /// `d_lim,obs`: for the space that nearby obstacles leave.
    pub nearby_obstacles_m: f64,
}

/// The coefficients `c_1` to `c_4`, "determined based on mission constraints".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProtectionCoefficients {
    /// `c_1`, of the obstacle's part.
    pub obstacle: f64,
    /// `c_2`, of the aircraft's own part.
    pub ownship: f64,
    /// `c_3`, of the airspace's part.
    pub airspace: f64,
    /// `c_4`, of the part for nearby obstacles.
    pub nearby_obstacles: f64,
}

impl Default for ProtectionCoefficients {
    /// All 1: a plain sum.
    fn default() -> Self {
        Self {
            obstacle: 1.0,
            ownship: 1.0,
            airspace: 1.0,
            nearby_obstacles: 1.0,
        }
    }
}

/// `d_m` = `c_1` `d_ma` + `c_2` `d_mu` + `c_3` `d_lim,air` + `c_4` `d_lim,obs`, metres (Eq. 15).
///
/// The limitations may reduce the distance (a negative product); the result may not be
/// negative. `None` if it would be, or if a number is not finite.
///
/// ```
/// use fga_paper::protection::{ProtectionCoefficients, ProtectionTerms, protected_radius_m};
/// let terms = ProtectionTerms { obstacle_m: 20.0, ownship_m: 10.0, ..Default::default() };
/// assert_eq!(protected_radius_m(&ProtectionCoefficients::default(), &terms), Some(30.0));
/// ```
pub fn protected_radius_m(
    coefficients: &ProtectionCoefficients,
    terms: &ProtectionTerms,
) -> Option<f64> {
    let radius_m = coefficients.obstacle * terms.obstacle_m
        + coefficients.ownship * terms.ownship_m
        + coefficients.airspace * terms.airspace_m
        + coefficients.nearby_obstacles * terms.nearby_obstacles_m;
    (radius_m.is_finite() && radius_m >= 0.0).then_some(radius_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_has_its_own_coefficient() {
        let coefficients = ProtectionCoefficients {
            obstacle: 2.0,
            ownship: 3.0,
            airspace: 5.0,
            nearby_obstacles: -7.0,
        };
        let terms = ProtectionTerms {
            obstacle_m: 10.0,
            ownship_m: 100.0,
            airspace_m: 1000.0,
            nearby_obstacles_m: 1.0,
        };
        // 20 + 300 + 5000 − 7.
        assert_eq!(protected_radius_m(&coefficients, &terms), Some(5313.0));
    }

    #[test]
    fn a_negative_distance_is_refused() {
        let terms = |airspace_m| ProtectionTerms {
            airspace_m,
            ..ProtectionTerms::default()
        };
        let ones = ProtectionCoefficients::default();
        assert_eq!(protected_radius_m(&ones, &terms(-1.0)), None);
        assert_eq!(protected_radius_m(&ones, &terms(f64::NAN)), None);
        assert_eq!(protected_radius_m(&ones, &terms(f64::INFINITY)), None);
        assert_eq!(protected_radius_m(&ones, &terms(0.0)), Some(0.0));
    }
}

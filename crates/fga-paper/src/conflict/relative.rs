//! Relative position and velocity, and the closest point of approach (Eq. 1, Alg. 1 lines 2–5).

use fga::Vec3;
use fga::certificate::Hazard;
use fga::limit::LARGEST_M;
use fga::situation::Ownship;

/// An obstacle seen from the aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relative {
    position_m: Vec3,
    velocity_mps: Vec3,
}

/// The closest point of approach on straight courses, from now on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestApproach {
    /// When, seconds from now; 0 where the distance only grows or never changes.
    pub time_s: f64,
    /// Distance of the centres then, metres.
    pub distance_m: f64,
}

impl Relative {
    /// From r = A − U, metres, and `V_r` = `V_u` − `V_a`, metres per second.
    ///
    /// `None` where a component is not finite or beyond [`LARGEST_M`].
    pub fn new(position_m: Vec3, velocity_mps: Vec3) -> Option<Self> {
        let usable = |v: Vec3| v.is_finite() && v.abs().max_element() <= LARGEST_M;
        (usable(position_m) && usable(velocity_mps)).then_some(Self {
            position_m,
            velocity_mps,
        })
    }

    /// From an obstacle and the aircraft (Alg. 1 lines 2, 3).
    ///
    /// `None` where a number is not finite or out of range.
    pub fn of(ownship: &Ownship, obstacle: &Hazard) -> Option<Self> {
        Self::new(
            obstacle.position_m - ownship.position_m,
            ownship.velocity_mps() - obstacle.velocity_mps,
        )
    }

    /// r = A − U, metres.
    pub const fn position_m(&self) -> Vec3 {
        self.position_m
    }

    /// `V_r` = `V_u` − `V_a`, metres per second.
    pub const fn velocity_mps(&self) -> Vec3 {
        self.velocity_mps
    }

    /// Distance of the centres `r_0`, metres.
    pub fn distance_m(&self) -> f64 {
        self.position_m.length()
    }

    /// Relative speed ‖`V_r`‖, metres per second.
    pub fn speed_mps(&self) -> f64 {
        self.velocity_mps.length()
    }

    /// Position of the centre `after_s` seconds from now, relative to the aircraft, metres.
    pub fn position_after_m(&self, after_s: f64) -> Vec3 {
        self.position_m - self.velocity_mps * after_s
    }

    /// Whether the distance shrinks now: r · `V_r` > 0, that is cos `θ_t0` > 0.
    pub fn is_closing(&self) -> bool {
        self.position_m.dot(self.velocity_mps) > 0.0
    }

    /// Bias angle `θ_t0` between `V_r` and r, radians in [0, π] (Eq. 1 in space).
    ///
    /// `None` if one of them is zero.
    pub fn bias_rad(&self) -> Option<f64> {
        let across = self.position_m.cross(self.velocity_mps).length();
        let along = self.position_m.dot(self.velocity_mps);
        (across != 0.0 || along != 0.0).then(|| libm::atan2(across, along))
    }

    /// `r_0` cos `θ_t0`, metres: how far ahead along `V_r` the closest point is; 0 for `V_r` = 0.
    pub fn along_m(&self) -> f64 {
        let speed = self.speed_mps();
        if speed > 0.0 {
            self.position_m.dot(self.velocity_mps) / speed
        } else {
            0.0
        }
    }

    /// `r_0` sin `θ_t0`, metres, never negative: distance of the obstacle from the line along `V_r`;
    /// `r_0` for `V_r` = 0.
    pub fn across_m(&self) -> f64 {
        let speed = self.speed_mps();
        if speed > 0.0 {
            self.position_m.cross(self.velocity_mps).length() / speed
        } else {
            self.distance_m()
        }
    }

    /// The closest point of approach from now on (Alg. 1 line 5, corrected for receding obstacles).
    pub fn closest(&self) -> ClosestApproach {
        let speed_squared = self.velocity_mps.length_squared();
        let closing = self.position_m.dot(self.velocity_mps);
        if closing > 0.0 && speed_squared > 0.0 {
            let time_s = closing / speed_squared;
            if time_s.is_finite() {
                return ClosestApproach {
                    time_s,
                    distance_m: self.across_m(),
                };
            }
        }
        ClosestApproach {
            time_s: 0.0,
            distance_m: self.distance_m(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::angle::direction;
    use fga::situation::ProtectedVolume;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vec3> {
        (-size..size, -size..size, -size..size).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    #[test]
    fn a_collision_course_has_no_bias() {
        let ownship = Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        };
        // Both reach (150, 0, 0) after ten seconds.
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let crossing = Hazard::exact(
            1,
            Vec3::new(150.0, 200.0, 0.0),
            Vec3::new(0.0, -20.0, 0.0),
            volume,
        );
        let relative = Relative::of(&ownship, &crossing).unwrap();
        assert!(relative.bias_rad().unwrap() < 1e-12);
        let closest = relative.closest();
        assert!((closest.time_s - 10.0).abs() < 1e-12 && closest.distance_m < 1e-9);
    }

    #[test]
    fn nothing_moves_and_numbers_that_are_none() {
        let still = Relative::new(Vec3::X, Vec3::ZERO).unwrap();
        assert_eq!(still.bias_rad(), None);
        assert_eq!(still.closest().time_s, 0.0);
        assert_eq!(still.closest().distance_m, 1.0);
        for bad in [f64::NAN, f64::INFINITY, 1e16] {
            assert!(Relative::new(Vec3::splat(bad), Vec3::X).is_none());
            assert!(Relative::new(Vec3::X, Vec3::new(0.0, bad, 0.0)).is_none());
        }
    }

    proptest! {
        /// The least distance over ten thousand times is never below the closest approach, and close to it.
        #[test]
        fn closest_approach_agrees_with_brute_force(r in vector(300.0), v in vector(60.0)) {
            let relative = Relative::new(r, v).unwrap();
            let closest = relative.closest();
            let horizon = (closest.time_s * 2.0).max(10.0);
            let least = (0..=10_000)
                .map(|i| relative.position_after_m(horizon * f64::from(i) / 10_000.0).length())
                .fold(f64::INFINITY, f64::min);
            let coarse = horizon / 10_000.0 * relative.speed_mps();
            prop_assert!(least >= closest.distance_m - 1e-9);
            prop_assert!(least <= closest.distance_m + coarse);
        }

        #[test]
        fn along_and_across_are_the_legs_of_r_0(r in vector(300.0), v in vector(60.0)) {
            let relative = Relative::new(r, v).unwrap();
            let hypotenuse = libm::hypot(relative.along_m(), relative.across_m());
            prop_assert!((hypotenuse - r.length()).abs() < 1e-9);
            let bias = relative.bias_rad().unwrap();
            prop_assert!((relative.along_m() - r.length() * f64::cos(bias)).abs() < 1e-9);
        }

        #[test]
        fn turning_and_mirroring_the_world_change_nothing(r in vector(300.0), v in vector(60.0), turn in -4.0..4.0f64) {
            let plain = Relative::new(r, v).unwrap();
            let rotate = |a: Vec3| {
                let (x, y) = (direction(turn, 0.0), direction(turn + core::f64::consts::FRAC_PI_2, 0.0));
                x * a.x + y * a.y + Vec3::Z * a.z
            };
            let mirror = |a: Vec3| Vec3::new(a.x, -a.y, a.z);
            for other in [
                Relative::new(rotate(r), rotate(v)).unwrap(),
                Relative::new(mirror(r), mirror(v)).unwrap(),
            ] {
                prop_assert!((plain.closest().distance_m - other.closest().distance_m).abs() < 1e-8);
                prop_assert!((plain.bias_rad().unwrap() - other.bias_rad().unwrap()).abs() < 1e-8);
            }
        }

        #[test]
        fn scaling_the_world_scales_the_distance(r in vector(300.0), v in vector(60.0), scale in 0.1..10.0f64) {
            let plain = Relative::new(r, v).unwrap().closest();
            let scaled = Relative::new(r * scale, v * scale).unwrap().closest();
            prop_assert!((scaled.distance_m - scale * plain.distance_m).abs() < 1e-7);
            prop_assert!((scaled.time_s - plain.time_s).abs() < 1e-7 * (1.0 + plain.time_s));
        }

        #[test]
        fn every_number_gives_numbers_or_none(a: [f64; 3], b: [f64; 3]) {
            if let Some(relative) = Relative::new(Vec3::from_array(a), Vec3::from_array(b)) {
                let closest = relative.closest();
                prop_assert!(closest.time_s.is_finite() && closest.distance_m.is_finite());
                prop_assert!(relative.along_m().is_finite() && relative.across_m().is_finite());
                prop_assert!(relative.bias_rad().is_none_or(f64::is_finite));
            }
        }
    }
}

//! Avoidance time, last feasible time, critical time and distance (Eq. 16–25).

use super::Geometry;

fn positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// √((ρ + d)² − (ρ + s)²) for s ≤ d, written without cancellation.
fn tangent_distance_m(turn_radius_m: f64, radius_m: f64, across_m: f64) -> f64 {
    let squared = (radius_m - across_m) * (2.0 * turn_radius_m + radius_m + across_m);
    libm::sqrt(squared.max(0.0))
}

/// When a turn away of radius ρ must begin to touch the volume and not enter it, seconds from now
/// (Eq. 16; with `ρ_min` the last feasible time `t_L`, Eq. 17).
///
/// Negative: it is too late. `None` where the volume is not on the path (s ≥ `d_m` or not closing),
/// or where ρ is not positive.
pub fn avoidance_time_s(geometry: &Geometry, turn_radius_m: f64) -> Option<f64> {
    if !geometry.is_threat() || !positive(turn_radius_m) {
        return None;
    }
    let tangent_m = tangent_distance_m(turn_radius_m, geometry.radius_m, geometry.across_m);
    let time_s = (geometry.along_m - tangent_m) / geometry.closing_mps;
    time_s.is_finite().then_some(time_s)
}

/// Least distance from which a turn still avoids a head-on static obstacle, metres:
/// `r_L` = √((ρ + `d_m`)² − ρ²) (Eq. 22).
///
/// `None` unless both are positive.
pub fn last_feasible_distance_m(turn_radius_m: f64, radius_m: f64) -> Option<f64> {
    (positive(turn_radius_m) && positive(radius_m))
        .then(|| tangent_distance_m(turn_radius_m, radius_m, 0.0))
}

/// Critical distance of a head-on static obstacle, metres: `r_c` = ρ + `d_m` (Eq. 23), never less
/// than [`last_feasible_distance_m`] (Eq. 24).
///
/// `None` unless both are positive.
pub fn critical_distance_m(turn_radius_m: f64, radius_m: f64) -> Option<f64> {
    (positive(turn_radius_m) && positive(radius_m)).then_some(turn_radius_m + radius_m)
}

/// The times and distances of one obstacle that threatens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// `t_L`: the last geometrically feasible start of the tightest turn, seconds from now (Eq. 17).
    pub last_feasible_s: f64,
    /// Eq. 19, the start with the buffer as printed, seconds from now. It is later than `t_L` where
    /// ρ < `d_m`/√2 and s is near `d_m`/2.
    pub buffered_s: f64,
    /// `t_c` = min of both, seconds from now: never too late for a static obstacle.
    pub critical_s: f64,
    /// `r_c`: distance of the centres at `t_c`, metres (Eq. 20, corrected).
    pub critical_distance_m: f64,
    /// `t_k` = `t_c` − `t_res`: when to command, seconds from now (Eq. 21).
    pub command_s: f64,
}

impl Times {
    /// Of a threat, for the tightest turn `ρ_min` and a response time `t_res` (Eq. 17–21).
    ///
    /// `None` where the volume is not on the path, or a length or time is out of range.
    pub fn of(geometry: &Geometry, turn_radius_m: f64, response_s: f64) -> Option<Self> {
        let last_feasible_s = avoidance_time_s(geometry, turn_radius_m)?;
        let buffer_end_m = turn_radius_m + geometry.radius_m - geometry.across_m;
        let buffered_s = (geometry.along_m - buffer_end_m) / geometry.closing_mps;
        let critical_s = last_feasible_s.min(buffered_s);
        let left_m = geometry.along_m - critical_s * geometry.closing_mps;
        let times = Self {
            last_feasible_s,
            buffered_s,
            critical_s,
            critical_distance_m: libm::sqrt(
                left_m * left_m + geometry.across_m * geometry.across_m,
            ),
            command_s: critical_s - response_s,
        };
        let finite = times.critical_s.is_finite()
            && times.critical_distance_m.is_finite()
            && response_s >= 0.0
            && times.command_s.is_finite();
        finite.then_some(times)
    }

    /// The buffer `t_b` = `t_L` − `t_c`, seconds, never negative (Eq. 18).
    pub fn buffer_s(&self) -> f64 {
        self.last_feasible_s - self.critical_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conflict::Relative;
    use crate::turn::turned;
    use fga::Vec3;
    use fga::situation::Ownship;
    use proptest::prelude::*;

    fn geometry(along_m: f64, across_m: f64, radius_m: f64, closing_mps: f64) -> Geometry {
        Geometry {
            along_m,
            across_m,
            closing_mps,
            radius_m,
        }
    }

    /// Flies straight to the start, then the tightest turn to the left, and measures the least
    /// distance to an obstacle at (along, −across) by brute force.
    fn flown_separation(geometry: &Geometry, turn_radius: f64, start_s: f64) -> f64 {
        let speed = geometry.closing_mps;
        let obstacle = Vec3::new(geometry.along_m, -geometry.across_m, 0.0);
        let at_start = Ownship {
            position_m: Vec3::new(speed * start_s, 0.0, 0.0),
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: speed,
        };
        let quarter = core::f64::consts::FRAC_PI_2 * turn_radius / speed;
        (0..=20_000)
            .map(|i| {
                let after = quarter * f64::from(i) / 20_000.0;
                turned(&at_start, speed / turn_radius, after)
                    .position_m
                    .distance(obstacle)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// 300 m head-on, ρ = `d_m` = 30 m, 15 m/s: the turn's circle touches the sphere when the
    /// centres are 60 m apart, √(60² − 30²) = 51.96 m ahead; Eq. 23 asks for 60 m.
    #[test]
    fn head_on_numbers_by_hand() {
        let head_on = geometry(300.0, 0.0, 30.0, 15.0);
        let times = Times::of(&head_on, 30.0, 0.5).unwrap();
        assert!((times.last_feasible_s - (300.0 - 51.961_524) / 15.0).abs() < 1e-6);
        assert!((times.critical_s - 16.0).abs() < 1e-12);
        assert!((times.critical_distance_m - 60.0).abs() < 1e-12);
        assert!((times.command_s - 15.5).abs() < 1e-12);
        assert!((times.buffer_s() - 8.038_476 / 15.0).abs() < 1e-6);
        assert!((last_feasible_distance_m(30.0, 30.0).unwrap() - 51.961_524).abs() < 1e-6);
        assert_eq!(critical_distance_m(30.0, 30.0), Some(60.0));
    }

    #[test]
    fn obstacles_without_a_threat_have_no_times() {
        for harmless in [
            geometry(300.0, 30.0, 30.0, 15.0),
            geometry(-300.0, 0.0, 30.0, 15.0),
        ] {
            assert_eq!(Times::of(&harmless, 30.0, 0.0), None);
        }
        let threat = geometry(300.0, 0.0, 30.0, 15.0);
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            assert_eq!(avoidance_time_s(&threat, bad), None);
            assert_eq!(last_feasible_distance_m(bad, 30.0), None);
            assert_eq!(critical_distance_m(30.0, bad), None);
        }
        assert_eq!(Times::of(&threat, 30.0, f64::NAN), None);
        assert_eq!(Times::of(&threat, 30.0, -1.0), None);
    }

    #[test]
    fn no_relative_motion_has_no_geometry() {
        let still = Relative::new(Vec3::X * 100.0, Vec3::ZERO).unwrap();
        assert_eq!(Geometry::spatial(&still, 30.0), None);
        let rising = Relative::new(Vec3::X * 100.0, Vec3::Z).unwrap();
        assert_eq!(Geometry::horizontal(&rising, 30.0), None);
        assert!(Geometry::level_section(&rising, 30.0).is_none());
    }

    /// A level turn past a sphere 25 m above: its section has the radius √(900 − 625) = 16.58 m.
    #[test]
    fn a_level_turn_is_timed_by_the_level_section() {
        let relative = Relative::new(Vec3::new(300.0, 0.0, 25.0), Vec3::X * 15.0).unwrap();
        let section = Geometry::level_section(&relative, 30.0).unwrap();
        let start_s = avoidance_time_s(&section, 30.0).unwrap();
        let level = flown_separation(&section, 30.0, start_s);
        assert!((libm::hypot(level, 25.0) - 30.0).abs() < 1e-6);
    }

    proptest! {
        /// A turn at `t_L` touches the volume; a slightly later one enters it.
        #[test]
        fn a_turn_at_the_last_feasible_time_touches(
            radius in 10.0..200.0f64, share in 0.0..0.99f64, turn_radius in 10.0..200.0f64, speed in 5.0..60.0f64,
        ) {
            let threat = geometry(600.0, share * radius, radius, speed);
            let start = avoidance_time_s(&threat, turn_radius).unwrap();
            let touched = flown_separation(&threat, turn_radius, start);
            prop_assert!((touched - radius).abs() < 1e-4, "{touched}");
            prop_assert!(flown_separation(&threat, turn_radius, start + 0.1) < radius);
        }

        #[test]
        fn a_turn_at_the_critical_time_is_clear_and_r_c_is_the_distance_then(
            radius in 10.0..200.0f64, share in 0.0..0.99f64, turn_radius in 10.0..200.0f64,
        ) {
            let threat = geometry(600.0, share * radius, radius, 15.0);
            let times = Times::of(&threat, turn_radius, 0.0).unwrap();
            prop_assert!(flown_separation(&threat, turn_radius, times.critical_s) >= radius - 1e-4);
            prop_assert!(times.buffer_s() >= 0.0);
            let position = Vec3::new(15.0 * times.critical_s, 0.0, 0.0);
            let obstacle = Vec3::new(600.0, -share * radius, 0.0);
            prop_assert!((position.distance(obstacle) - times.critical_distance_m).abs() < 1e-9);
        }

        /// Twice the world at twice the speed takes the same times.
        #[test]
        fn scaling_the_world_keeps_the_times(share in 0.0..0.99f64, scale in 0.1..10.0f64) {
            let one = Times::of(&geometry(600.0, share * 30.0, 30.0, 15.0), 40.0, 0.0).unwrap();
            let other = geometry(600.0 * scale, share * 30.0 * scale, 30.0 * scale, 15.0 * scale);
            let other = Times::of(&other, 40.0 * scale, 0.0).unwrap();
            prop_assert!((one.critical_s - other.critical_s).abs() < 1e-9);
        }

        #[test]
        fn every_number_gives_numbers_or_none(r: [f64; 3], v: [f64; 3], radius: f64, turn_radius: f64, response: f64) {
            let Some(relative) = Relative::new(Vec3::from_array(r), Vec3::from_array(v)) else {
                return Ok(());
            };
            for geometry in [Geometry::spatial(&relative, radius), Geometry::horizontal(&relative, radius), Geometry::level_section(&relative, radius)] {
                if let Some(times) = geometry.and_then(|g| Times::of(&g, turn_radius, response)) {
                    prop_assert!(times.last_feasible_s.is_finite() && times.command_s.is_finite());
                    prop_assert!(times.critical_distance_m.is_finite());
                }
            }
        }
    }
}

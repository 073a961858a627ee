//! Flying a line in a wind.

use fga::Vec3;
use fga::angle::{climb_of, course_of};

/// Course and climb angle through the air that fly along a ground direction in a wind; `None`
/// if the wind is too strong.
pub fn crab(direction: Vec3, airspeed_mps: f64, wind_mps: Vec3) -> Option<(f64, f64)> {
    let along_mps = wind_mps.dot(direction);
    let across_mps = wind_mps - direction * along_mps;
    let rest = airspeed_mps * airspeed_mps - across_mps.length_squared();
    let forward_mps = libm::sqrt(rest.max(0.0));
    if rest <= 0.0 || forward_mps + along_mps <= 0.0 {
        return None;
    }
    let air_mps = direction * forward_mps - across_mps;
    Some((course_of(air_mps), climb_of(air_mps)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crab_angle_flies_along_the_line() {
        let wind = Vec3::new(3.0, -5.0, 1.0);
        let (course, climb) = crab(Vec3::X, 15.0, wind).unwrap();
        let ground = fga::angle::direction(course, climb) * 15.0 + wind;
        assert!(ground.y.abs() < 1e-12 && ground.z.abs() < 1e-12 && ground.x > 15.0);
        assert_eq!(crab(Vec3::X, 15.0, Vec3::new(-16.0, 0.0, 0.0)), None);
        assert_eq!(crab(Vec3::X, 15.0, Vec3::new(0.0, 15.0, 0.0)), None);
    }
}

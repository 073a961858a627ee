//! Airspeed and wind: each is checked against the velocity over the ground.

use fga::Vec3;
use mavlink::dialects::ardupilotmega::{VFR_HUD_DATA, WIND_DATA};

use super::{FASTEST_MPS, FLYING_SPEED_MPS, OwnshipEstimate, WIND_LIFETIME_S};

/// Wind is rounded to this, metres per second: each change makes new legs.
const WIND_STEP_MPS: f64 = 0.25;
/// Wind and airspeed that together differ from the velocity over the ground by more than this are wrong, metres per second.
const WIND_OFF_MPS: f64 = 15.0;
/// Faster than this over the ground, after the wind is taken off, an aircraft has airspeed, metres per second.
const COVERS_GROUND_MPS: f64 = 10.0;

impl OwnshipEstimate {
    /// Takes airspeed.
    pub fn take_hud(&mut self, data: &VFR_HUD_DATA) {
        let airspeed = f64::from(data.airspeed);
        if (0.0..FASTEST_MPS).contains(&airspeed) {
            self.airspeeds_mps.rotate_left(1);
            self.airspeeds_mps[2] = Some(airspeed);
        }
    }

    /// Takes wind.
    pub fn take_wind(&mut self, data: &WIND_DATA, now_s: f64) {
        let from_rad = f64::from(data.direction).to_radians();
        let speed = f64::from(data.speed);
        if !from_rad.is_finite() || !(0.0..100.0).contains(&speed) {
            return;
        }
        let step = |value: f64| (value / WIND_STEP_MPS).round() * WIND_STEP_MPS;
        let velocity = Vec3::new(
            step(-speed * libm::sin(from_rad)),
            step(-speed * libm::cos(from_rad)),
            0.0,
        );
        if self.airspeed_fails() {
            // The vehicle makes its wind of the same sensor: the last wind holds.
            if let Some((heard_s, _)) = &mut self.wind {
                *heard_s = now_s;
                return;
            }
        }
        if let (Some(position), Some(airspeed_mps)) = (self.position, self.airspeed_mps()) {
            let through_air_mps = (position.velocity_mps - velocity).length();
            if (through_air_mps - airspeed_mps).abs() > WIND_OFF_MPS {
                return;
            }
        }
        self.wind = Some((now_s, velocity));
    }

    /// Airspeed, metres per second: as measured, or from ground speed and wind where the sensor fails.
    pub fn airspeed_mps(&self) -> Option<f64> {
        if self.airspeed_fails() {
            self.through_air_mps()
        } else {
            self.measured_airspeed_mps()
        }
    }

    /// Whether the airspeed sensor contradicts the velocity over the ground: it reads next to nothing while the aircraft
    /// covers ground, or the wind does not explain the difference.
    pub fn airspeed_fails(&self) -> bool {
        let Some((measured_mps, through_mps)) =
            self.measured_airspeed_mps().zip(self.through_air_mps())
        else {
            return false;
        };
        let reads_nothing = measured_mps < FLYING_SPEED_MPS && through_mps > COVERS_GROUND_MPS;
        let unexplained =
            self.known_wind_mps().is_some() && (through_mps - measured_mps).abs() > WIND_OFF_MPS;
        reads_nothing || unexplained
    }

    /// Speed through the air by ground speed and wind, metres per second.
    fn through_air_mps(&self) -> Option<f64> {
        let wind_mps = self.known_wind_mps().unwrap_or(Vec3::ZERO);
        Some((self.position?.velocity_mps - wind_mps).length())
    }

    /// The wind at the last position, metres per second.
    fn known_wind_mps(&self) -> Option<Vec3> {
        let (heard_s, wind_mps) = self.wind?;
        (self.position?.measured_s - heard_s < WIND_LIFETIME_S).then_some(wind_mps)
    }

    fn measured_airspeed_mps(&self) -> Option<f64> {
        let mut known = self.airspeeds_mps;
        known.sort_by(|a, b| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
        match known {
            [Some(_), Some(middle), Some(_)] => Some(middle),
            // Unknown ones sort first.
            [_, _, newest] => newest,
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use fga::vehicle::Response;
    use mavlink::dialects::ardupilotmega::GLOBAL_POSITION_INT_DATA;

    use super::super::tests::{position, take_level_north};
    use super::*;
    use crate::commanded::Commanded;

    #[test]
    fn wind_separates_course_from_track() {
        let mut estimate = OwnshipEstimate::default();
        take_level_north(&mut estimate);
        // From the west with 5 m/s: it carries to the east, so the nose points west of north.
        let wind = WIND_DATA {
            direction: 270.0,
            speed: 5.0,
            speed_z: 0.0,
        };
        estimate.take_wind(&wind, 10.0);
        let state = estimate
            .state_at(10.0, &Commanded::default(), &Response::default())
            .unwrap();
        assert!(state.wind_mps.distance(Vec3::new(5.0, 0.0, 0.0)) < 1e-9);
        assert!(state.ownship.course_rad > FRAC_PI_2);
        assert!(
            state
                .ground_velocity_mps
                .distance(Vec3::new(0.0, 25.0, 0.0))
                < 1e-9
        );
    }

    /// A blocked pitot tube, also with the wind that the vehicle then estimates; and a light aircraft that hovers.
    #[test]
    fn l9_ground_speed_and_wind_stand_in_for_a_blocked_pitot_tube() {
        let hud = |airspeed| VFR_HUD_DATA {
            airspeed,
            ..VFR_HUD_DATA::DEFAULT
        };
        let wind = |speed| WIND_DATA {
            direction: 180.0,
            speed,
            speed_z: 0.0,
        };
        let mut estimate = OwnshipEstimate::default();
        estimate.take_position(&position(1000, 376_189_000, -1_223_750_000), 10.0);
        (0..3).for_each(|_| estimate.take_hud(&hud(20.0)));
        estimate.take_wind(&wind(5.0), 10.0);
        assert_eq!(
            (estimate.airspeed_mps(), estimate.airspeed_fails()),
            (Some(20.0), false)
        );
        (0..3).for_each(|_| estimate.take_hud(&hud(0.0)));
        assert!(estimate.airspeed_fails());
        for n in 1..200_u32 {
            estimate.take_wind(&wind(25.0), 10.0 + f64::from(n));
            let boot_ms = 1000 + n * 1000;
            estimate.take_position(
                &position(boot_ms, 376_189_000, -1_223_750_000),
                10.0 + f64::from(n),
            );
            let airspeed_mps = estimate.airspeed_mps().unwrap();
            assert!((airspeed_mps - 20.0).abs() < 0.3, "{airspeed_mps}");
        }
        (0..3).for_each(|_| estimate.take_hud(&hud(21.0)));
        assert_eq!(
            (estimate.airspeed_mps(), estimate.airspeed_fails()),
            (Some(21.0), false)
        );
        let mut hovers = OwnshipEstimate::default();
        let still = GLOBAL_POSITION_INT_DATA {
            vx: 300,
            ..position(1000, 376_189_000, -1_223_750_000)
        };
        hovers.take_position(&still, 10.0);
        hovers.take_hud(&hud(1.0));
        assert_eq!(hovers.airspeed_mps(), Some(1.0));
    }
}

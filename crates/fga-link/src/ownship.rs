//! The aircraft's own state from its telemetry, as of now.
//!
//! The vehicle's boot time dates each message ([`crate::clock`]); the state is extrapolated from
//! the moment of measurement to the requested moment, along the arc that the aircraft flies.
//! Handedness: the autopilot counts headings clockwise and banks to the right, the core counts
//! courses anticlockwise from east and banks to the left. Only this module and [`crate::hand`] convert.

mod air;
mod carry;
mod take;

use fga::Vec3;
use fga::situation::Ownship;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use mavlink::dialects::ardupilotmega::ATTITUDE_DATA;

use crate::clock::BootClock;

/// Longest extrapolation, seconds: as long as a manoeuvre may fly on without telemetry.
const LONGEST_CARRY_S: f64 = 11.0;
/// An older altitude counts as unknown, seconds.
const ALTITUDE_LIFETIME_S: f64 = 1.5;
/// Older wind counts as unknown, seconds.
const WIND_LIFETIME_S: f64 = 10.0;
/// A position beyond this distance from the origin moves the local frame, m. Before its receiver
/// has a fix, ArduPlane sends a place near latitude and longitude 0; and that far out the plane of the
/// frame lies 30 m above the sea.
const FRAME_REACH_M: f64 = 20_000.0;
/// The fastest aircraft, metres per second.
const FASTEST_MPS: f64 = 150.0;
/// Each message is late by up to this for itself, seconds; by more where all wait in a queue.
const JITTER_S: f64 = 0.3;
/// Slower than this over the ground or through the air it does not fly, metres per second.
pub const FLYING_SPEED_MPS: f64 = 5.0;

#[derive(Debug, Clone, Copy)]
struct Position {
    measured_s: f64,
    place: Geodetic,
    place_m: Vec3,
    velocity_mps: Vec3,
    above_home_m: f64,
}

#[derive(Debug, Clone, Copy)]
struct Attitude {
    measured_s: f64,
    bank_rad: f64,
    pitch_rad: f64,
    heading_rad: f64,
    yaw_rate_radps: f64,
    /// Whether it is rolling.
    rolls: bool,
}

/// The newest message.
#[derive(Debug, Clone, Copy)]
struct Arrival {
    at_s: f64,
    late_s: f64,
}

/// Whether a message was new.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// It was new.
    Fresh,
    /// It is older than the known state, or unusable.
    Ignored,
    /// The vehicle restarted.
    Restarted,
}

/// The core's state, with its context.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnState {
    /// The state in the air mass; the position is over the ground.
    pub ownship: Ownship,
    /// Velocity over the ground, metres per second.
    pub ground_velocity_mps: Vec3,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
    /// Height above home, metres.
    pub above_home_m: f64,
    /// Pitch angle as measured, radians.
    pub pitch_rad: f64,
    /// Rate of turn ψ̇, radians per second, positive to the left.
    pub course_rate_radps: f64,
}

/// Rate of turn about the vertical, radians per second, clockwise positive: ψ̇ = (q sin φ + r cos φ) / cos θ, from the rates about the
/// body's axes. In a steep turn that settles, r / cos φ alone shows the rate of a coordinated turn that is not flown yet.
pub fn turn_rate_radps(data: &ATTITUDE_DATA) -> f64 {
    let (sin, cos) = libm::sincos(f64::from(data.roll));
    let level = libm::cos(f64::from(data.pitch)).max(0.3);
    (f64::from(data.pitchspeed) * sin + f64::from(data.yawspeed) * cos) / level
}

/// Collects telemetry of one vehicle.
#[derive(Debug, Default)]
pub struct OwnshipEstimate {
    frame: Option<LocalFrame>,
    position_clock: BootClock,
    attitude_clock: BootClock,
    heard: Option<Arrival>,
    position: Option<Position>,
    attitude: Option<Attitude>,
    /// The last airspeeds, newest last; the middle one counts, so that a single wrong one does not.
    airspeeds_mps: [Option<f64>; 3],
    /// Since when the height above home differs from the known one, seconds.
    home_moved_s: Option<f64>,
    /// Whether home stays where it was, and how much lower the vehicle has reported its height above home since, metres.
    holds_home: bool,
    home_rose_m: f64,
    wind: Option<(f64, Vec3)>,
    /// The last returned course through the air, not wrapped.
    last_course_rad: Option<f64>,
}

impl OwnshipEstimate {
    /// The local frame: its origin is the first position of the flight, or a later one.
    pub const fn frame(&self) -> Option<&LocalFrame> {
        self.frame.as_ref()
    }

    /// Moves the local frame to the last position if that is far from the origin; the caller then forgets
    /// everything in the old frame.
    pub fn move_frame(&mut self) -> bool {
        let Some(position) = &mut self.position else {
            return false;
        };
        if libm::hypot(position.place_m.x, position.place_m.y) <= FRAME_REACH_M {
            return false;
        }
        let frame = LocalFrame::new(position.place, Earth::Wgs84);
        position.place_m = frame.to_local_m(position.place);
        self.frame = Some(frame);
        true
    }

    /// Altitude of home above mean sea level, metres.
    pub fn home_altitude_m(&self) -> Option<f64> {
        let position = self.position?;
        Some(self.frame?.origin().altitude_m + position.place_m.z - position.above_home_m)
    }

    /// Whether home stays where it is in a manoeuvre, whatever the vehicle reports: its height is the one above the sea. How far
    /// home has risen since, metres.
    pub const fn hold_home(&mut self, holds: bool) -> f64 {
        self.holds_home = holds;
        if !holds {
            self.home_rose_m = 0.0;
        }
        self.home_rose_m
    }

    /// Present altitude above mean sea level, metres; `None` if the last position is too old for it.
    pub fn altitude_m(&self, now_s: f64) -> Option<f64> {
        let position = self.position?;
        let age_s = now_s - position.measured_s;
        (age_s < ALTITUDE_LIFETIME_S)
            .then_some(position.place.altitude_m + position.velocity_mps.z * age_s)
    }

    /// Takes a round trip of the vehicle's clock ([`BootClock::round_trip`]).
    pub fn round_trip(&mut self, sent_s: f64, boot_s: f64, now_s: f64) {
        self.position_clock.round_trip(sent_s, boot_s, now_s);
        self.attitude_clock.round_trip(sent_s, boot_s, now_s);
    }

    /// How long the newest message waited in a queue, seconds: what came with it waited in it too.
    pub fn queued_s(&self) -> f64 {
        let waited = self.heard.filter(|heard| heard.late_s > JITTER_S);
        waited.map_or(0.0, |heard| heard.late_s)
    }

    /// Whether neither position nor attitude has come for a while, and the next message may have waited in a queue.
    pub fn is_silent(&self, now_s: f64) -> bool {
        self.heard
            .is_some_and(|heard| now_s - heard.at_s > JITTER_S)
    }

    /// Age of the older of position and attitude, seconds; `None` before both have come.
    pub fn age_s(&self, now_s: f64) -> Option<f64> {
        let oldest = self.position?.measured_s.min(self.attitude?.measured_s);
        Some(now_s - oldest)
    }

    /// Its position at `now_s` if it flew straight since the last one, metres, local frame.
    pub fn position_m(&self, now_s: f64) -> Option<Vec3> {
        let position = self.position?;
        let carry_s = (now_s - position.measured_s).clamp(0.0, LONGEST_CARRY_S);
        Some(position.place_m + position.velocity_mps * carry_s)
    }

    /// Age of the attitude, seconds.
    pub fn attitude_age_s(&self, now_s: f64) -> Option<f64> {
        Some(now_s - self.attitude?.measured_s)
    }

    /// Last measured bank, radians, positive to the left.
    pub fn bank_rad(&self) -> Option<f64> {
        self.attitude.map(|attitude| attitude.bank_rad)
    }

    /// Heading of the nose in the core's sense, radians.
    pub fn heading_rad(&self) -> Option<f64> {
        self.attitude.map(|attitude| attitude.heading_rad)
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use fga::vehicle::Response;
    use mavlink::dialects::ardupilotmega::GLOBAL_POSITION_INT_DATA;

    use super::*;
    use crate::commanded::Commanded;

    pub(super) fn position(boot_ms: u32, lat: i32, lon: i32) -> GLOBAL_POSITION_INT_DATA {
        GLOBAL_POSITION_INT_DATA {
            time_boot_ms: boot_ms,
            lat,
            lon,
            alt: 104_000,
            relative_alt: 100_000,
            vx: 2500,
            vy: 0,
            vz: 0,
            ..GLOBAL_POSITION_INT_DATA::DEFAULT
        }
    }

    /// A place and a level attitude at the same moment, flying north.
    pub(super) fn take_level_north(estimate: &mut OwnshipEstimate) {
        estimate.take_position(&position(1000, 376_189_000, -1_223_750_000), 10.0);
        estimate.take_attitude(
            &ATTITUDE_DATA {
                time_boot_ms: 1000,
                ..ATTITUDE_DATA::DEFAULT
            },
            10.0,
        );
    }

    #[test]
    fn north_flight_is_carried_north() {
        let mut estimate = OwnshipEstimate::default();
        assert!(
            estimate
                .state_at(0.0, &Commanded::default(), &Response::default())
                .is_none()
        );
        take_level_north(&mut estimate);
        let state = estimate
            .state_at(10.4, &Commanded::default(), &Response::default())
            .unwrap();
        assert!(state.ownship.position_m.distance(Vec3::new(0.0, 10.0, 0.0)) < 1e-6);
        assert!((state.ownship.course_rad - FRAC_PI_2).abs() < 1e-9);
        assert!((state.above_home_m - 100.0).abs() < 1e-9);
        assert!((estimate.home_altitude_m().unwrap() - 4.0).abs() < 1e-9);
    }

    /// ArduPlane's reported place before and after the first fix.
    #[test]
    fn the_frame_is_laid_where_the_aircraft_is() {
        let mut estimate = OwnshipEstimate::default();
        for (n, lat) in (0_u32..80).zip(1000_i32..) {
            let update = estimate.take_position(&position(n * 100, lat, -224), f64::from(n) * 0.1);
            assert_eq!(update, Update::Fresh);
        }
        let place = |boot_ms| position(boot_ms, -353_632_621, 1_491_652_370);
        assert_eq!(
            estimate.take_position(&place(8000), 8.0),
            Update::Ignored,
            "it cannot have flown there"
        );
        assert!(!estimate.move_frame());
        // After repeated reports it counts.
        for n in 81_u32..120 {
            estimate.take_position(&place(n * 100), f64::from(n) * 0.1);
        }
        assert!(estimate.move_frame());
        assert!(!estimate.move_frame());
        let origin = estimate.frame().unwrap().origin();
        assert!((origin.latitude_deg + 35.363_262_1).abs() < 1e-9);
        assert!((estimate.home_altitude_m().unwrap() - 4.0).abs() < 1e-9);
    }

    #[test]
    fn a_right_bank_bends_the_path_to_the_right() {
        let mut estimate = OwnshipEstimate::default();
        estimate.take_position(&position(1000, 376_189_000, -1_223_750_000), 10.0);
        // 25 m/s, 45°: g/V = 0.392 rad/s; the yaw gyro sees cos φ of it, the pitch gyro sin φ.
        let rate = 9.806_65_f64 / 25.0;
        let attitude = ATTITUDE_DATA {
            time_boot_ms: 1000,
            roll: core::f32::consts::FRAC_PI_4,
            pitchspeed: crate::number::single(rate * libm::sin(core::f64::consts::FRAC_PI_4)),
            yawspeed: crate::number::single(rate * libm::cos(core::f64::consts::FRAC_PI_4)),
            ..ATTITUDE_DATA::DEFAULT
        };
        estimate.take_attitude(&attitude, 10.0);
        let state = estimate
            .state_at(11.0, &Commanded::default(), &Response::default())
            .unwrap();
        let radius = 25.0 / rate;
        let expected = Vec3::new(
            radius * (1.0 - libm::cos(rate)),
            radius * libm::sin(rate),
            0.0,
        );
        assert!(
            state.ownship.position_m.distance(expected) < 0.05,
            "{state:?}"
        );
        assert!((state.ownship.course_rad - (FRAC_PI_2 - rate)).abs() < 1e-3);
        assert!(state.ownship.bank_rad < 0.0);
    }

    #[test]
    fn rubbish_is_ignored() {
        let mut estimate = OwnshipEstimate::default();
        assert_eq!(
            estimate.take_position(&position(1, 0, 0), 1.0),
            Update::Ignored
        );
        assert_eq!(
            estimate.take_position(&position(1, i32::MAX, 5), 1.0),
            Update::Ignored
        );
        let attitude = ATTITUDE_DATA {
            roll: f32::NAN,
            ..ATTITUDE_DATA::DEFAULT
        };
        assert_eq!(estimate.take_attitude(&attitude, 1.0), Update::Ignored);
    }
}

//! The aircraft's own state from its telemetry, as of now.
//!
//! The vehicle's boot time dates each message ([`crate::clock`]); the state is extrapolated from
//! the moment of measurement to the requested moment, along the arc that the aircraft flies.
//! Handedness: the autopilot counts headings clockwise and banks to the right, the core counts
//! courses anticlockwise from east and banks to the left. Only this module and [`crate::hand`] convert.

use core::f64::consts::FRAC_PI_2;

use fga::Vec3;
use fga::angle::{course_of, wrap_pi};
use fga::situation::Ownship;
use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2};
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use mavlink::dialects::ardupilotmega::{
    ATTITUDE_DATA, GLOBAL_POSITION_INT_DATA, VFR_HUD_DATA, WIND_DATA,
};

use crate::clock::{BootClock, Stamp};
use crate::commanded::Commanded;
use crate::number::degrees_from_e7;

/// Longest extrapolation, seconds: as long as a manoeuvre may fly on without telemetry.
const LONGEST_CARRY_S: f64 = 11.0;
/// An older altitude counts as unknown, seconds.
const ALTITUDE_LIFETIME_S: f64 = 1.5;
/// The measured rate of turn beyond the bank's holds for this long, then it fades, seconds.
const RATE_HOLDS_S: f64 = 0.5;
const RATE_FADES_S: f64 = 1.0;
/// Older wind counts as unknown, seconds.
const WIND_LIFETIME_S: f64 = 10.0;
/// Wind is rounded to this, metres per second: each change makes new legs.
const WIND_STEP_MPS: f64 = 0.25;
/// Rolling means that the bank changes faster than this, radians per second.
const ROLLS_RADPS: f64 = 0.15;
/// Most pieces of the extrapolation's arc, and the longest one, seconds.
const STEPS: u32 = 8;
const LONGEST_STEP_S: f64 = 0.2;
/// A position farther than this from the origin moves the local frame, m. Before its receiver
/// has a fix, ArduPlane sends a place near latitude and longitude 0; and that far out the plane of the
/// frame lies 30 m above the sea.
const FRAME_REACH_M: f64 = 20_000.0;
/// A position farther from the last one than this, metres, and than the fastest aircraft flies,
/// metres per second, does not count …
const JUMP_M: f64 = 200.0;
const FASTEST_MPS: f64 = 150.0;
/// … unless the last is older than this, seconds: longer than telemetry may be stale.
const BELIEVED_AGAIN_S: f64 = 3.0;
/// A velocity that differs from the last one by more than this, metres per second, and than the hardest turn makes of it,
/// metres per second squared, does not count either.
const SPEED_JUMP_MPS: f64 = 15.0;
const HARDEST_MPS2: f64 = 40.0;
/// A bank that differs from the last one by more than this, radians, and than the fastest roll makes of it, radians per
/// second, does not count, unless the last is older than this, seconds.
const BANK_JUMP_RAD: f64 = 0.35;
const FASTEST_ROLL_RADPS: f64 = 7.0;
const BANK_BELIEVED_AGAIN_S: f64 = 0.5;
/// No plane turns its nose faster, radians per second.
const FASTEST_NOSE_RADPS: f64 = 10.0;
/// Home seldom moves up or down by more than this, metres: until it has done so for the time after which a position is believed
/// again, the old height counts.
const HOME_JUMP_M: f64 = 50.0;
/// Wind and airspeed that together differ from the velocity over the ground by more than this are wrong, metres per second.
const WIND_OFF_MPS: f64 = 15.0;
/// Faster than this over the ground, after the wind is taken off, an aircraft has airspeed, metres per second.
const COVERS_GROUND_MPS: f64 = 10.0;
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
pub struct State {
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

/// Collects telemetry of one vehicle.
#[derive(Debug, Default)]
pub struct OwnshipEstimate {
    frame: Option<LocalFrame>,
    position_clock: BootClock,
    attitude_clock: BootClock,
    position: Option<Position>,
    attitude: Option<Attitude>,
    /// The last airspeeds, newest last; the middle one counts, so that a single wrong one does not.
    airspeeds_mps: [Option<f64>; 3],
    /// Since when the height above home differs from the known one, seconds.
    home_moved_s: Option<f64>,
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
    pub fn lay_frame_anew(&mut self) -> bool {
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

    /// Takes a position.
    pub fn take_position(&mut self, data: &GLOBAL_POSITION_INT_DATA, now_s: f64) -> Update {
        let place = Geodetic::new(
            degrees_from_e7(data.lat),
            degrees_from_e7(data.lon),
            f64::from(data.alt) * 1e-3,
        );
        // A receiver without a fix reports zero.
        let Some(place) = place.filter(|_| data.lat != 0 || data.lon != 0) else {
            return Update::Ignored;
        };
        let velocity_mps = Vec3::new(
            f64::from(data.vy) * 0.01,
            f64::from(data.vx) * 0.01,
            -f64::from(data.vz) * 0.01,
        );
        if velocity_mps.length() > FASTEST_MPS {
            return Update::Ignored;
        }
        let (measured_s, update) = match self.position_clock.stamp(data.time_boot_ms, now_s) {
            Stamp::New { measured_s } => (measured_s, Update::Fresh),
            Stamp::Restarted { measured_s } => (measured_s, Update::Restarted),
            Stamp::Old => return Update::Ignored,
        };
        let frame = self
            .frame
            .get_or_insert_with(|| LocalFrame::new(place, Earth::Wgs84));
        let place_m = frame.to_local_m(place);
        if let Some(last) = self.position.filter(|_| update == Update::Fresh) {
            let gap_s = (measured_s - last.measured_s).max(0.0);
            let reached_m = JUMP_M + FASTEST_MPS * gap_s;
            let turned_mps = SPEED_JUMP_MPS + HARDEST_MPS2 * gap_s;
            let jumps = place_m.distance(last.place_m) > reached_m
                || velocity_mps.distance(last.velocity_mps) > turned_mps;
            if gap_s < BELIEVED_AGAIN_S && jumps {
                return Update::Ignored;
            }
        }
        let told_m = f64::from(data.relative_alt) * 1e-3;
        let above_home_m = self.above_home_m(told_m, place_m, measured_s, update);
        self.position = Some(Position {
            measured_s,
            place,
            place_m,
            velocity_mps,
            above_home_m,
        });
        update
    }

    /// The height above home: the reported one, unless home jumps with it.
    fn above_home_m(&mut self, told_m: f64, place_m: Vec3, now_s: f64, update: Update) -> f64 {
        let Some(last) = self.position.filter(|_| update == Update::Fresh) else {
            self.home_moved_s = None;
            return told_m;
        };
        let known_m = last.above_home_m + place_m.z - last.place_m.z;
        if (told_m - known_m).abs() <= HOME_JUMP_M {
            self.home_moved_s = None;
            return told_m;
        }
        let since_s = *self.home_moved_s.get_or_insert(now_s);
        if now_s - since_s < BELIEVED_AGAIN_S {
            known_m
        } else {
            told_m
        }
    }

    /// Takes an attitude.
    pub fn take_attitude(&mut self, data: &ATTITUDE_DATA, now_s: f64) -> Update {
        let finite = [data.roll, data.pitch, data.yaw, data.yawspeed]
            .iter()
            .all(|v| v.is_finite());
        let plausible = data.roll.abs() <= 4.0
            && data.pitch.abs() <= 2.0
            && f64::from(data.yawspeed).abs() <= FASTEST_NOSE_RADPS;
        if !finite || !plausible {
            return Update::Ignored;
        }
        let (measured_s, update) = match self.attitude_clock.stamp(data.time_boot_ms, now_s) {
            Stamp::New { measured_s } => (measured_s, Update::Fresh),
            Stamp::Restarted { measured_s } => (measured_s, Update::Restarted),
            Stamp::Old => return Update::Ignored,
        };
        let bank_rad = -f64::from(data.roll);
        if let Some(last) = self.attitude.filter(|_| update == Update::Fresh) {
            let gap_s = (measured_s - last.measured_s).max(0.0);
            let rolled_rad = wrap_pi(bank_rad - last.bank_rad).abs();
            let jumps = rolled_rad > BANK_JUMP_RAD + FASTEST_ROLL_RADPS * gap_s;
            if gap_s < BANK_BELIEVED_AGAIN_S && jumps {
                return Update::Ignored;
            }
        }
        self.attitude = Some(Attitude {
            measured_s,
            bank_rad,
            pitch_rad: f64::from(data.pitch),
            heading_rad: wrap_pi(FRAC_PI_2 - f64::from(data.yaw)),
            // Body axis to vertical: ψ̇ = r cos φ / cos θ + q …; in a level coordinated turn
            // r = ψ̇ cos φ.
            yaw_rate_radps: -f64::from(data.yawspeed) / libm::cos(bank_rad).max(0.3),
            rolls: data.rollspeed.is_finite() && f64::from(data.rollspeed).abs() > ROLLS_RADPS,
        });
        update
    }

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

    /// Last measured bank, radians, positive to the left.
    pub fn bank_rad(&self) -> Option<f64> {
        self.attitude.map(|attitude| attitude.bank_rad)
    }

    /// The state at `at_s` on the local clock, somewhat later than the last measurement.
    ///
    /// The recent bank commands bend the path between the measurement and `at_s`.
    /// `None` before the first position and attitude, or when the aircraft does not fly.
    pub fn state_at(
        &mut self,
        at_s: f64,
        commanded: &Commanded,
        response: &Response,
    ) -> Option<State> {
        let (position, attitude) = (self.position?, self.attitude?);
        let wind_mps = self
            .wind
            .filter(|(heard_s, _)| at_s - heard_s < WIND_LIFETIME_S)
            .map_or(Vec3::ZERO, |(_, wind)| wind);
        let air_mps = position.velocity_mps - wind_mps;
        let speed = air_mps.length();
        if speed < FLYING_SPEED_MPS {
            return None;
        }
        let bank_at = |at_s: f64| {
            let latest_s = attitude.measured_s + LONGEST_CARRY_S;
            let at_s = at_s.min(latest_s);
            commanded.bank_at(attitude.bank_rad, attitude.measured_s, at_s, response)
        };
        let rate_of = |bank_rad: f64| {
            response.turn_rate_factor * STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad.clamp(-1.3, 1.3))
                / speed
        };
        // In a steady turn the measured rate is more accurate than the bank. While it rolls, the nose swings
        // later than the course, and may even swing to the other side.
        let offset_radps = if attitude.rolls {
            0.0
        } else {
            (attitude.yaw_rate_radps - rate_of(attitude.bank_rad)).clamp(-0.15, 0.15)
        };
        let carry_s = (at_s - position.measured_s).clamp(0.0, LONGEST_CARRY_S);
        let (mut place_m, mut course_rad) = (position.place_m, course_of(air_mps));
        let climb_rad = libm::asin((air_mps.z / speed).clamp(-1.0, 1.0));
        let level = speed * libm::cos(climb_rad);
        let steps = (carry_s / LONGEST_STEP_S).ceil().max(f64::from(STEPS));
        let step_s = carry_s / steps;
        for n in 0..crate::number::to_u16(steps) {
            let step_at_s = at_s - carry_s + (f64::from(n) + 0.5) * step_s;
            let beyond_s = (step_at_s - attitude.measured_s - RATE_HOLDS_S).max(0.0);
            let offset_radps = offset_radps * libm::exp(-beyond_s / RATE_FADES_S);
            let rate = rate_of(bank_at(step_at_s)) + offset_radps;
            let middle_rad = course_rad + 0.5 * rate * step_s;
            place_m += Vec3::new(
                (level * libm::cos(middle_rad) + wind_mps.x) * step_s,
                (level * libm::sin(middle_rad) + wind_mps.y) * step_s,
                air_mps.z * step_s,
            );
            course_rad += rate * step_s;
        }
        // Unwrapped along the flight, so that stages can express turns beyond 180°.
        let reference = self.last_course_rad.unwrap_or(course_rad);
        let course_rad = reference + wrap_pi(course_rad - reference);
        self.last_course_rad = Some(course_rad);
        let ownship = Ownship {
            position_m: place_m,
            course_rad,
            climb_rad,
            bank_rad: bank_at(at_s),
            airspeed_mps: speed,
        };
        Some(State {
            ownship,
            ground_velocity_mps: ownship.velocity_mps() + wind_mps,
            wind_mps,
            above_home_m: position.above_home_m + place_m.z - position.place_m.z,
            pitch_rad: attitude.pitch_rad,
            course_rate_radps: attitude.yaw_rate_radps,
        })
    }

    /// Heading of the nose in the core's sense, radians.
    pub fn heading_rad(&self) -> Option<f64> {
        self.attitude.map(|attitude| attitude.heading_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(boot_ms: u32, lat: i32, lon: i32) -> GLOBAL_POSITION_INT_DATA {
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

    #[test]
    fn north_flight_is_carried_north() {
        let mut estimate = OwnshipEstimate::default();
        assert!(
            estimate
                .state_at(0.0, &Commanded::default(), &Response::default())
                .is_none()
        );
        estimate.take_position(&position(1000, 376_189_000, -1_223_750_000), 10.0);
        estimate.take_attitude(
            &ATTITUDE_DATA {
                time_boot_ms: 1000,
                ..ATTITUDE_DATA::DEFAULT
            },
            10.0,
        );
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
        assert!(!estimate.lay_frame_anew());
        // After repeated reports it counts.
        for n in 81_u32..120 {
            estimate.take_position(&place(n * 100), f64::from(n) * 0.1);
        }
        assert!(estimate.lay_frame_anew());
        assert!(!estimate.lay_frame_anew());
        let origin = estimate.frame().unwrap().origin();
        assert!((origin.latitude_deg + 35.363_262_1).abs() < 1e-9);
        assert!((estimate.home_altitude_m().unwrap() - 4.0).abs() < 1e-9);
    }

    #[test]
    fn a_right_bank_bends_the_path_to_the_right() {
        let mut estimate = OwnshipEstimate::default();
        estimate.take_position(&position(1000, 376_189_000, -1_223_750_000), 10.0);
        // 25 m/s, 45°: g/V = 0.392 rad/s; the yaw gyro sees cos φ of it.
        let rate = 9.806_65_f64 / 25.0;
        let attitude = ATTITUDE_DATA {
            time_boot_ms: 1000,
            roll: core::f32::consts::FRAC_PI_4,
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
    fn wind_separates_course_from_track() {
        let mut estimate = OwnshipEstimate::default();
        estimate.take_position(&position(1000, 376_189_000, -1_223_750_000), 10.0);
        estimate.take_attitude(
            &ATTITUDE_DATA {
                time_boot_ms: 1000,
                ..ATTITUDE_DATA::DEFAULT
            },
            10.0,
        );
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

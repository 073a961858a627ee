//! Roll and pitch in GUIDED: the law that follows the manoeuvre, and its messages.

use fga::maneuver::Maneuver;
use fga::prediction::Flyer;
use fga::situation::Ownship;
use fga::vehicle::Vehicle;
use mavlink::dialects::ardupilotmega::{
    AttitudeTargetTypemask, MavMessage, SET_ATTITUDE_TARGET_DATA,
};

use super::{Hand, HandReach, HandTarget};
use crate::mode::Mode;
use crate::number::single;
use crate::outgoing::AUTOPILOT;
use crate::ownship::OwnState;

/// A turn rolls out over this many bank time constants …
const ROLL_OUT_LAGS: f64 = 1.0;
/// … and over at least this time, seconds.
const SHORTEST_ROLL_OUT_S: f64 = 0.6;
/// Pitch per metre of altitude error in level stages, radians; and its limit.
const PITCH_PER_METRE: f64 = 0.012;
const MOST_PITCH_CORRECTION_RAD: f64 = 0.07;
/// A climb angle this small is level flight, radians.
const LEVEL_RAD: f64 = 0.004;

/// Bank and pitch to command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeCommand {
    /// Bank, radians, positive to the left.
    pub bank_rad: f64,
    /// Wanted climb angle, radians; `None` leaves the altitude to the autopilot.
    pub climb_rad: Option<f64>,
}

/// The target of a manoeuvre some time after its decision.
///
/// Full bank until the remaining turn equals the turn made while rolling out; then bank proportional to what remains.
pub fn attitude_for(
    maneuver: &Maneuver,
    elapsed_s: f64,
    ownship: &Ownship,
    vehicle: &Vehicle,
    bank_limit_rad: f64,
) -> AttitudeCommand {
    let Some(stage) = maneuver.stage_at(elapsed_s) else {
        return AttitudeCommand {
            bank_rad: 0.0,
            climb_rad: None,
        };
    };
    let flyer = Flyer::new(vehicle);
    let lag_s = vehicle.response.bank_time_constant_s;
    let turn_left = stage.course_rad - ownship.course_rad;
    // Turn made while the bank decays to level: f g τ (φ + φ³/9 + …) / V.
    let rolling_out = lag_s * flyer.rate_radps(ownship.bank_rad);
    let rest = turn_left - rolling_out;
    let over_s = (ROLL_OUT_LAGS * lag_s).max(SHORTEST_ROLL_OUT_S);
    let most = vehicle.course_rate_radps() * stage.rate_share.clamp(0.0, 1.0);
    let rate = (rest / over_s).clamp(-most, most);
    let bank_rad = flyer.bank_rad(rate).clamp(-bank_limit_rad, bank_limit_rad);
    let climbs = stage.climb_rad.abs() > LEVEL_RAD;
    AttitudeCommand {
        bank_rad,
        climb_rad: climbs.then_some(stage.climb_rad),
    }
}

/// Flies by `SET_ATTITUDE_TARGET`. It keeps the altitude in level stages once it commands the pitch.
#[derive(Debug, Default)]
pub struct AttitudeHand {
    /// The pitch angle of level flight, radians.
    level_pitch_rad: Option<f64>,
    held_altitude_m: Option<f64>,
    in_command: bool,
}

impl AttitudeHand {
    /// The pitch angle to command, radians; `None` while the autopilot keeps the altitude.
    fn pitch_rad(&mut self, climb_rad: Option<f64>, altitude_m: f64) -> Option<f64> {
        let level = self.level_pitch_rad.unwrap_or(0.0);
        if let Some(climb_rad) = climb_rad {
            self.in_command = true;
            self.held_altitude_m = None;
            return Some(level + climb_rad);
        }
        if !self.in_command {
            return None;
        }
        // GUIDED would return to the altitude of its entry: hold the present one instead.
        let held = *self.held_altitude_m.get_or_insert(altitude_m);
        let correction = PITCH_PER_METRE * (held - altitude_m);
        Some(level + correction.clamp(-MOST_PITCH_CORRECTION_RAD, MOST_PITCH_CORRECTION_RAD))
    }
}

impl Hand for AttitudeHand {
    fn mode(&self) -> Mode {
        Mode::GUIDED
    }

    fn commands_bank(&self) -> bool {
        true
    }

    /// Learns the pitch angle of level flight.
    fn watch(&mut self, own: &OwnState) {
        let offset = own.pitch_rad - own.ownship.climb_rad;
        if offset.abs() < 0.3 {
            let known = self.level_pitch_rad.unwrap_or(offset);
            self.level_pitch_rad = Some(known + 0.02 * (offset - known));
        }
    }

    fn begin(&mut self) {
        self.held_altitude_m = None;
        self.in_command = false;
    }

    fn fly(&mut self, target: &HandTarget<'_>, reach: &mut HandReach<'_>) -> Option<f64> {
        let own = &target.own.ownship;
        let (elapsed_s, limit_rad) = (target.elapsed_s, target.bank_limit_rad);
        let wanted = attitude_for(target.maneuver, elapsed_s, own, target.vehicle, limit_rad);
        let climb_rad = wanted.climb_rad.filter(|_| target.vehicle.can_climb());
        let pitch_rad = self.pitch_rad(climb_rad, own.position_m.z);
        let message = attitude_message(wanted.bank_rad, pitch_rad, reach.boot_ms, reach.system);
        reach.outbox.send(message);
        Some(wanted.bank_rad)
    }

    /// Attitude targets time out by themselves.
    fn let_go(&mut self, _reach: &mut HandReach<'_>) {}
}

/// The message that commands a bank, and a pitch where given.
///
/// A cleared rate bit selects that axis of the attitude, and the bit of the attitude itself stays
/// set: cleared, it selects all axes, and ArduPlane would hold pitch and rudder at zero. Throttle
/// and the other axes stay with the autopilot.
pub fn attitude_message(
    bank_rad: f64,
    pitch_rad: Option<f64>,
    time_boot_ms: u32,
    target_system: u8,
) -> MavMessage {
    let mut type_mask = AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
        | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
        | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE;
    if pitch_rad.is_none() {
        type_mask |= AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE;
    }
    MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
        time_boot_ms,
        q: quaternion(-bank_rad, pitch_rad.unwrap_or(0.0)),
        target_system,
        target_component: AUTOPILOT,
        type_mask,
        ..SET_ATTITUDE_TARGET_DATA::DEFAULT
    })
}

/// Quaternion w, x, y, z of a roll (right positive) and a pitch, heading north.
fn quaternion(roll_rad: f64, pitch_rad: f64) -> [f32; 4] {
    let (sin_roll, cos_roll) = libm::sincos(0.5 * roll_rad);
    let (sin_pitch, cos_pitch) = libm::sincos(0.5 * pitch_rad);
    [
        single(cos_roll * cos_pitch),
        single(sin_roll * cos_pitch),
        single(cos_roll * sin_pitch),
        single(-sin_roll * sin_pitch),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::Vec3;
    use fga::vehicle::Response;

    fn vehicle() -> Vehicle {
        let response = Response {
            dead_time_s: 0.2,
            bank_time_constant_s: 0.6,
            turn_rate_factor: 0.74,
        };
        Vehicle {
            response,
            ..Vehicle::from_bank(25.0, 43.0_f64.to_radians()).unwrap()
        }
    }

    fn own(course_rad: f64, bank_rad: f64) -> Ownship {
        Ownship {
            position_m: Vec3::ZERO,
            course_rad,
            climb_rad: 0.0,
            bank_rad,
            airspeed_mps: 25.0,
        }
    }

    #[test]
    fn a_turn_begins_at_full_bank_and_ends_level() {
        let maneuver = Maneuver::turn(0.0, 1.0, 0.0);
        let limit = 43.0_f64.to_radians();
        let begin = attitude_for(&maneuver, 0.0, &own(0.0, 0.0), &vehicle(), limit);
        assert!((begin.bank_rad - limit).abs() < 1e-9);
        assert_eq!(begin.climb_rad, None);
        let end = attitude_for(&maneuver, 5.0, &own(1.0, 0.0), &vehicle(), limit);
        assert!(end.bank_rad.abs() < 1e-9);
        // Nearly there but still banked: the other way, to roll out.
        let late = attitude_for(&maneuver, 5.0, &own(0.98, limit), &vehicle(), limit);
        assert!(late.bank_rad < 0.0);
    }

    #[test]
    fn the_quaternion_is_the_right_roll() {
        let left_30 = 30.0_f64.to_radians();
        let MavMessage::SET_ATTITUDE_TARGET(data) = attitude_message(left_30, None, 0, 1) else {
            panic!("another message")
        };
        // cos 15°, −sin 15°.
        assert!((data.q[0] - 0.965_925_8).abs() < 1e-6);
        assert!((data.q[1] + 0.258_819_05).abs() < 1e-6);
        assert_eq!(data.type_mask.bits(), 0b1100_0110);
    }

    #[test]
    fn after_a_climb_the_new_altitude_is_held() {
        let mut keeper = AttitudeHand::default();
        let level = OwnState {
            ownship: own(0.0, 0.0),
            ground_velocity_mps: Vec3::X * 25.0,
            wind_mps: Vec3::ZERO,
            above_home_m: 100.0,
            pitch_rad: 0.05,
            course_rate_radps: 0.0,
        };
        for _ in 0..500 {
            keeper.watch(&level);
        }
        keeper.begin();
        assert_eq!(keeper.pitch_rad(None, 100.0), None);
        assert!((keeper.pitch_rad(Some(0.1), 100.0).unwrap() - 0.15).abs() < 1e-6);
        assert!((keeper.pitch_rad(None, 120.0).unwrap() - 0.05).abs() < 1e-6);
        assert!(keeper.pitch_rad(None, 118.0).unwrap() > 0.05);
    }
}

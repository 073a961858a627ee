//! Roll by `RC_CHANNELS_OVERRIDE` in FBWB, as in Algorithm 4.

use fga::maneuver::Maneuver;
use fga::prediction::Flyer;
use fga::situation::Ownship;
use fga::vehicle::Vehicle;
use fga_paper::algorithm_4::{PWM_NEUTRAL_US, pwm_us};
use mavlink::dialects::ardupilotmega::{MavMessage, RC_CHANNELS_OVERRIDE_DATA};

use super::{Hand, Reach, Target};
use crate::mode::Mode;
use crate::number::to_u16;

/// A turn ends this close to its course, radians.
const REACHED_RAD: f64 = 0.01;
/// Ground station's system id if the vehicle's parameter is unknown.
const GROUND_SYSTEM: f64 = 255.0;

/// Flies by the roll stick; full stick is the vehicle's own bank limit.
#[derive(Debug)]
pub struct StickHand;

impl StickHand {
    /// Overrides count only from the ground station's system id.
    fn send(sticks: Option<[u16; 3]>, reach: &mut Reach<'_>) {
        let ground = reach
            .parameters
            .get("MAV_GCS_SYSID")
            .unwrap_or(GROUND_SYSTEM);
        let ground = u8::try_from(to_u16(ground)).unwrap_or(u8::MAX);
        let message = override_message(sticks, reach.system);
        reach.outbox.send_as(ground, message);
    }

    fn roll(roll_us: u16, reach: &mut Reach<'_>) {
        let named = |name: &str| reach.parameters.get(name).unwrap_or(0.0);
        let (lowest_mps, highest_mps) = (named("AIRSPEED_MIN"), named("AIRSPEED_MAX"));
        let throttle_us = throttle_us(reach.airspeed_mps, lowest_mps, highest_mps);
        Self::send(Some([roll_us, to_u16(PWM_NEUTRAL_US), throttle_us]), reach);
    }
}

impl Hand for StickHand {
    fn mode(&self) -> Mode {
        Mode::FBWB
    }

    fn takes_over_from(&self) -> Option<Mode> {
        Some(Mode::CRUISE)
    }

    fn fly(&mut self, target: &Target<'_>, reach: &mut Reach<'_>) -> Option<f64> {
        let full_rad = reach.parameters.get("ROLL_LIMIT_DEG")?.to_radians();
        let bank_rad = bank_for(
            target.maneuver,
            target.elapsed_s,
            &target.own.ownship,
            target.vehicle,
        );
        let bank_rad = bank_rad.clamp(-target.bank_limit_rad, target.bank_limit_rad);
        Self::roll(to_u16(pwm_us(bank_rad, full_rad)?), reach);
        Some(bank_rad)
    }

    /// CRUISE locks its heading once the stick is centred.
    fn fly_straight(&mut self, reach: &mut Reach<'_>) {
        Self::roll(to_u16(PWM_NEUTRAL_US), reach);
    }

    /// The vehicle would hold the sticks for seconds, and CRUISE would go on turning.
    fn let_go(&mut self, reach: &mut Reach<'_>) {
        Self::send(None, reach);
    }
}

/// The bank of a manoeuvre, radians, positive to the left: the stage's bank until rolling out ends on its course.
fn bank_for(maneuver: &Maneuver, elapsed_s: f64, own: &Ownship, vehicle: &Vehicle) -> f64 {
    let Some(stage) = maneuver.stage_at(elapsed_s) else {
        return 0.0;
    };
    let flyer = Flyer::new(vehicle);
    let left_rad = stage.course_rad - own.course_rad - flyer.rollout_rad(own.bank_rad);
    if left_rad.abs() < REACHED_RAD {
        return 0.0;
    }
    let rate_radps = vehicle.course_rate_radps() * stage.rate_share.clamp(0.0, 1.0);
    flyer.bank_rad(rate_radps.copysign(left_rad))
}

/// Leaves a channel unchanged.
const LEAVE: u16 = u16::MAX;
/// Returns a channel to the pilot's transmitter.
const RELEASE: u16 = 0;

/// The message that holds roll, pitch and throttle; `None` releases them.
pub fn override_message(sticks: Option<[u16; 3]>, target_system: u8) -> MavMessage {
    let [roll, pitch, throttle] = sticks.unwrap_or([RELEASE; 3]);
    MavMessage::RC_CHANNELS_OVERRIDE(RC_CHANNELS_OVERRIDE_DATA {
        chan1_raw: roll,
        chan2_raw: pitch,
        chan3_raw: throttle,
        chan4_raw: LEAVE,
        chan5_raw: LEAVE,
        chan6_raw: LEAVE,
        chan7_raw: LEAVE,
        chan8_raw: LEAVE,
        target_system,
        target_component: crate::outgoing::AUTOPILOT,
        ..RC_CHANNELS_OVERRIDE_DATA::DEFAULT
    })
}

/// Throttle stick for an airspeed in FBWB, microseconds.
pub fn throttle_us(airspeed_mps: f64, lowest_mps: f64, highest_mps: f64) -> u16 {
    let span = highest_mps - lowest_mps;
    let share = if span > 0.1 {
        (airspeed_mps - lowest_mps) / span
    } else {
        0.5
    };
    to_u16(1000.0 + 1000.0 * share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::Vec3;

    #[test]
    fn a_turn_is_flown_at_full_bank_until_rolling_out_ends_it() {
        let vehicle = Vehicle::from_bank(20.0, 0.7).unwrap();
        let own = |course_rad| Ownship {
            position_m: Vec3::ZERO,
            course_rad,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 20.0,
        };
        let bank_at = |course_rad: f64, at_s: f64| {
            let maneuver = Maneuver::turn(1.0, 0.5, 0.0);
            bank_for(&maneuver, at_s, &own(course_rad), &vehicle)
        };
        assert_eq!(bank_at(0.0, 0.5), 0.0);
        assert!((bank_at(0.0, 1.0) - 0.7).abs() < 1e-9);
        assert!((bank_at(0.4, 1.0) - 0.7).abs() < 1e-9);
        assert_eq!(bank_at(0.495, 1.0), 0.0);
        assert!((bank_at(0.6, 1.0) + 0.7).abs() < 1e-9);
    }

    #[test]
    fn the_throttle_stick_spans_the_airspeeds() {
        assert_eq!(throttle_us(12.0, 12.0, 30.0), 1000);
        assert_eq!(throttle_us(21.0, 12.0, 30.0), 1500);
        assert_eq!(throttle_us(99.0, 12.0, 30.0), 2000);
    }
}

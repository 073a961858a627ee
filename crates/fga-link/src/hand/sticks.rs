//! Roll by `RC_CHANNELS_OVERRIDE` in FBWB, as in Algorithm 4.

use fga_paper::algorithm_4::{PWM_NEUTRAL_US, pwm_us};
use mavlink::dialects::ardupilotmega::{MavMessage, RC_CHANNELS_OVERRIDE_DATA};

use super::attitude::attitude_for;
use super::{Hand, HandReach, HandTarget};
use crate::mode::Mode;
use crate::number::to_u16;

/// Flies by the roll stick; full stick is the vehicle's own bank limit.
#[derive(Debug, Default)]
pub struct StickHand {
    /// The throttle stick of this manoeuvre, microseconds. In FBWB it sets the airspeed: a stick that followed the
    /// measured airspeed would let it wander (on an ArduPlane by ±2.3 m/s every 8 s, with ±3 m of height).
    throttle_us: Option<u16>,
}

impl StickHand {
    /// Overrides count only from the ground station's system id.
    fn send(sticks: Option<[u16; 3]>, reach: &mut HandReach<'_>) {
        let ground = to_u16(reach.parameters.ground_system());
        let ground = u8::try_from(ground).unwrap_or(u8::MAX);
        let message = override_message(sticks, reach.system);
        reach.outbox.send_as(ground, message);
    }

    fn roll(&mut self, roll_us: u16, reach: &mut HandReach<'_>) {
        let named = |name: &str| reach.parameters.get(name).unwrap_or(0.0);
        let (lowest_mps, highest_mps) = (named("AIRSPEED_MIN"), named("AIRSPEED_MAX"));
        let airspeed_mps = reach.airspeed_mps;
        let throttle_us = *self
            .throttle_us
            .get_or_insert_with(|| throttle_us(airspeed_mps, lowest_mps, highest_mps));
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

    fn begin(&mut self) {
        self.throttle_us = None;
    }

    fn fly(&mut self, target: &HandTarget<'_>, reach: &mut HandReach<'_>) -> Option<f64> {
        let full_rad = reach.parameters.get("ROLL_LIMIT_DEG")?.to_radians();
        let own = &target.own.ownship;
        let (elapsed_s, limit_rad) = (target.elapsed_s, target.bank_limit_rad);
        let wanted = attitude_for(target.maneuver, elapsed_s, own, target.vehicle, limit_rad);
        self.roll(to_u16(pwm_us(wanted.bank_rad, full_rad)?), reach);
        Some(wanted.bank_rad)
    }

    /// CRUISE locks its heading once the stick is centred.
    fn fly_straight(&mut self, reach: &mut HandReach<'_>) {
        self.roll(to_u16(PWM_NEUTRAL_US), reach);
    }

    /// The vehicle would hold the sticks for seconds, and CRUISE would go on turning.
    fn let_go(&mut self, reach: &mut HandReach<'_>) {
        Self::send(None, reach);
    }
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

    #[test]
    fn the_throttle_stick_spans_the_airspeeds() {
        assert_eq!(throttle_us(12.0, 12.0, 30.0), 1000);
        assert_eq!(throttle_us(21.0, 12.0, 30.0), 1500);
        assert_eq!(throttle_us(99.0, 12.0, 30.0), 2000);
    }
}

//! The paper's own way to fly: Algorithm 4 with roll by `RC_CHANNELS_OVERRIDE`.
//!
//! The decisions are [`fga_paper::algorithm_4`]'s; here are the vehicle's turn-rate factor and lag, which
//! the paper's formulas leave out, and the stick positions. The largest bank is replaced by the one
//! that would give the flown radius ideally, the triggers are moved earlier by the time that the
//! roll takes, and round the obstacle the bank of Eq. 60 is corrected by how far the aircraft is from
//! its circle: commanded once and for all it was flown up to 8 m into a disc of 150 m.

use fga::Vec3;
use fga::situation::{Obstacle, Ownship};
use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2};
use fga_paper::algorithm_4::{Execution, Phase, Plan, pwm_us};
use mavlink::dialects::ardupilotmega::{MavMessage, RC_CHANNELS_OVERRIDE_DATA};

use crate::number::to_u16;

/// Faster than this an obstacle is not at rest, metres per second.
const AT_REST_MPS: f64 = 1.0;

/// The turn-rate factor is planned with a little low. Round the obstacle that is the wrong side: the
/// circle would be tighter than meant. There it is taken larger by this.
const ROUND_FACTOR: f64 = 1.07;

/// How fast a distance from the circle is taken back, radians per second: that of the oscillation that
/// its damping forbids.
const BACK_RADPS: f64 = 0.25;

/// Its damping ratio.
const DAMPING: f64 = 0.8;

/// Sticks to hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sticks {
    /// Where the manoeuvre stands.
    pub phase: Phase,
    /// Bank, radians, positive to the left.
    pub bank_rad: f64,
    /// Roll channel, microseconds.
    pub roll_us: u16,
}

/// Flies Algorithm 4 round one obstacle after the other.
#[derive(Debug, Clone, Default)]
pub struct PaperPilot {
    flown: Option<Flown>,
}

#[derive(Debug, Clone, Copy)]
struct Flown {
    execution: Execution,
    obstacle: Obstacle,
    planned_s: f64,
}

impl PaperPilot {
    /// The obstacle that is flown round, or will be.
    pub fn obstacle(&self) -> Option<&Obstacle> {
        self.flown.as_ref().map(|flown| &flown.obstacle)
    }

    /// Whether a turn has begun and not ended.
    pub fn is_turning(&self) -> bool {
        self.flown
            .is_some_and(|flown| !matches!(flown.execution.phase(), Phase::Waiting | Phase::Done))
    }

    /// Looks for an obstacle at rest in the way, and flies round it.
    ///
    /// `bank_limit_rad` is what may be commanded, `full_stick_rad` the vehicle's own limit, which a
    /// full stick gives. `None` while nothing is in the way.
    pub fn step(
        &mut self,
        time_s: f64,
        (ownship, wind_mps): (&Ownship, Vec3),
        obstacles: &[Obstacle],
        margin_m: f64,
        response: &Response,
        (bank_limit_rad, full_stick_rad): (f64, f64),
    ) -> Option<Sticks> {
        let factor = response.turn_rate_factor;
        let ideal_rad = libm::atan(factor * libm::tan(bank_limit_rad));
        let early_s = response.dead_time_s + response.bank_time_constant_s;
        let over = self
            .flown
            .is_none_or(|flown| flown.execution.phase() == Phase::Done);
        let waits = self
            .flown
            .is_some_and(|flown| flown.execution.phase() == Phase::Waiting);
        if over || waits {
            let first = obstacles
                .iter()
                .filter(|obstacle| obstacle.velocity_mps.length() < AT_REST_MPS)
                .filter(|obstacle| {
                    let offset = obstacle.position_m - ownship.position_m;
                    offset.z.abs() < obstacle.volume.half_height_m()
                })
                .filter_map(|obstacle| {
                    let radius_m = obstacle.volume.radius_m() + margin_m;
                    let plan = Plan::of(ownship, obstacle.position_m, radius_m, ideal_rad)?;
                    Some((plan, obstacle))
                })
                .min_by(|a, b| a.0.critical_s.total_cmp(&b.0.critical_s));
            self.flown = first.map(|(plan, obstacle)| Flown {
                execution: Execution::new(plan),
                obstacle: *obstacle,
                planned_s: time_s,
            });
        }
        let flown = self.flown.as_mut()?;
        let offset = flown.obstacle.position_m - ownship.position_m;
        let range_m = range_of(offset) - ownship.airspeed_mps * early_s;
        let elapsed_s = time_s - flown.planned_s + early_s;
        // The last turn ends on the course before: what is turned while rolling out is left out.
        let rolling_out_rad = match flown.execution.phase() {
            Phase::TurningBack => {
                response.bank_time_constant_s
                    * factor
                    * STANDARD_GRAVITY_MPS2
                    * libm::tan(ownship.bank_rad)
                    / ownship.airspeed_mps
            }
            _ => 0.0,
        };
        let course_rad = ownship.course_rad + rolling_out_rad;
        let command = flown.execution.step(elapsed_s, range_m, course_rad);
        // Back from the ideal bank to the one that is flown, and to the stick.
        let factor = match command.phase {
            Phase::RoundObstacle => factor * ROUND_FACTOR,
            _ => factor,
        };
        let mut rate_radps =
            STANDARD_GRAVITY_MPS2 * libm::tan(command.bank_rad) / ownship.airspeed_mps;
        if command.phase == Phase::RoundObstacle {
            let ground_mps = ownship.velocity_mps() + wind_mps;
            let off_m = range_of(offset) - flown.execution.plan().round.around.radius_m;
            let leaving_mps =
                -(offset.x * ground_mps.x + offset.y * ground_mps.y) / range_of(offset);
            let inwards_mps2 =
                2.0 * DAMPING * BACK_RADPS * leaving_mps + BACK_RADPS * BACK_RADPS * off_m;
            let tighter_radps = inwards_mps2 / ownship.airspeed_mps;
            let side = rate_radps.signum();
            rate_radps = side * (rate_radps.abs() + tighter_radps).max(0.0);
        }
        let tangent = rate_radps * ownship.airspeed_mps / (STANDARD_GRAVITY_MPS2 * factor);
        let bank_rad = libm::atan(tangent).clamp(-bank_limit_rad, bank_limit_rad);
        let roll_us = to_u16(pwm_us(bank_rad, full_stick_rad)?);
        Some(Sticks {
            phase: command.phase,
            bank_rad,
            roll_us,
        })
    }
}

/// Leaves a channel as it is.
const LEAVE: u16 = u16::MAX;
/// Gives a channel back to the pilot's transmitter.
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

/// Throttle stick that asks for an airspeed in FBWB, microseconds.
pub fn throttle_us(airspeed_mps: f64, lowest_mps: f64, highest_mps: f64) -> u16 {
    let span = highest_mps - lowest_mps;
    let share = if span > 0.1 {
        (airspeed_mps - lowest_mps) / span
    } else {
        0.5
    };
    to_u16(1000.0 + 1000.0 * share.clamp(0.0, 1.0))
}

/// Horizontal length, metres.
fn range_of(offset_m: Vec3) -> f64 {
    libm::hypot(offset_m.x, offset_m.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::Vec3;
    use fga::situation::ProtectedVolume;

    #[test]
    fn a_full_right_turn_is_a_full_right_stick() {
        let limit = 45.0_f64.to_radians();
        let own = Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 20.0,
        };
        let volume = ProtectedVolume::Sphere { radius_m: 100.0 };
        // To the left of the course, inside its radius: the turn is to the right.
        let obstacle = Obstacle::new(1, Vec3::new(120.0, 10.0, 0.0), Vec3::ZERO, volume);
        let mut pilot = PaperPilot::default();
        let response = Response::default();
        let sticks = pilot
            .step(
                0.0,
                (&own, Vec3::ZERO),
                &[obstacle],
                0.0,
                &response,
                (limit, limit),
            )
            .unwrap();
        assert_eq!((sticks.phase, sticks.roll_us), (Phase::TurningAway, 2000));
        assert!(pilot.is_turning());
        let moving = Obstacle {
            velocity_mps: Vec3::new(5.0, 0.0, 0.0),
            ..obstacle
        };
        let mut other = PaperPilot::default();
        assert!(
            other
                .step(
                    0.0,
                    (&own, Vec3::ZERO),
                    &[moving],
                    0.0,
                    &response,
                    (limit, limit)
                )
                .is_none()
        );
    }

    #[test]
    fn the_throttle_stick_spans_the_airspeeds() {
        assert_eq!(throttle_us(12.0, 12.0, 30.0), 1000);
        assert_eq!(throttle_us(21.0, 12.0, 30.0), 1500);
        assert_eq!(throttle_us(99.0, 12.0, 30.0), 2000);
    }
}

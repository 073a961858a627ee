//! Heading and altitude commands in GUIDED.

use core::f64::consts::{FRAC_PI_2, PI};

use fga::angle::wrap_pi;
use fga::maneuver::Stage;
use fga::vehicle::STANDARD_GRAVITY_MPS2;
use mavlink::dialects::ardupilotmega::MavCmd;

use super::{Hand, HandReach, HandTarget};
use crate::commands::VehicleCommand;
use crate::mode::Mode;
use crate::number::single;
use crate::ownship::OwnState;

/// A heading target is repeated when it changes by this, radians, or after this time, seconds.
const STEP_RAD: f64 = 0.035;
const AGAIN_S: f64 = 1.0;
/// Farthest heading target from the present heading, radians: less than half a turn,
/// so that the autopilot turns to the intended side.
const FARTHEST_RAD: f64 = 2.6;
/// A climb becomes an altitude this far ahead, seconds.
const CLIMB_AHEAD_S: f64 = 4.0;
/// A climb angle this small is level flight, radians.
const LEVEL_RAD: f64 = 0.01;
/// Slow tail of heading commands, seconds.
const TAIL_S: f64 = 0.6;

/// Flies by `MAV_CMD_GUIDED_CHANGE_HEADING` and `MAV_CMD_GUIDED_CHANGE_ALTITUDE`.
#[derive(Debug, Default)]
pub struct HeadingHand {
    /// The last heading, radians, and the time of its repetition, seconds.
    last: Option<(f64, f64)>,
}

impl HeadingHand {
    fn turn(&mut self, stage: &Stage, target: &HandTarget<'_>, reach: &mut HandReach<'_>) -> bool {
        let own = &target.own.ownship;
        let turn_rad = stage.course_rad - own.course_rad;
        let heading_rad = own.course_rad + turn_rad.clamp(-FARTHEST_RAD, FARTHEST_RAD);
        let changed = self
            .last
            .is_none_or(|(last_rad, _)| wrap_pi(heading_rad - last_rad).abs() > STEP_RAD);
        let due = self.last.is_none_or(|(_, again_s)| reach.now_s >= again_s);
        let busy = reach
            .commands
            .is_waiting(MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING);
        if !changed && (!due || busy) {
            return false;
        }
        self.last = Some((heading_rad, reach.now_s + AGAIN_S));
        let compass_deg = (FRAC_PI_2 - heading_rad).rem_euclid(2.0 * PI).to_degrees();
        let acceleration_mps2 = STANDARD_GRAVITY_MPS2 * libm::tan(target.bank_limit_rad);
        // The heading of the nose (1), not the course over the ground: the plan is in the air mass.
        let (heading_deg, acceleration_mps2) = (single(compass_deg), single(acceleration_mps2));
        let parameters = [1.0, heading_deg, acceleration_mps2, 0.0, 0.0, 0.0, 0.0];
        let command = VehicleCommand::int(MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING, parameters);
        reach.commands.send(command, true);
        true
    }
}

/// Commands the altitude that a climb reaches some seconds ahead.
fn climb(stage: &Stage, own: &OwnState, reach: &mut HandReach<'_>) {
    let Some(frame) = reach.frame else { return };
    let climb_m = own.ownship.airspeed_mps * libm::sin(stage.climb_rad) * CLIMB_AHEAD_S;
    let altitude_m = frame.origin().altitude_m + own.ownship.position_m.z + climb_m;
    let parameters = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, single(altitude_m)];
    let command = VehicleCommand::int(MavCmd::MAV_CMD_GUIDED_CHANGE_ALTITUDE, parameters);
    reach.commands.send(command, true);
}

impl Hand for HeadingHand {
    fn mode(&self) -> Mode {
        Mode::GUIDED
    }

    fn lag_s(&self) -> f64 {
        TAIL_S
    }

    fn begin(&mut self) {
        self.last = None;
    }

    fn fly(&mut self, target: &HandTarget<'_>, reach: &mut HandReach<'_>) -> Option<f64> {
        // Outside of GUIDED the vehicle refuses the commands: wait for the confirmation.
        if target.is_confirmed
            && let Some(stage) = target.maneuver.stage_at(target.elapsed_s).copied()
            && self.turn(&stage, target, reach)
            && target.vehicle.can_climb()
            && stage.climb_rad.abs() > LEVEL_RAD
        {
            climb(&stage, target.own, reach);
        }
        // The autopilot chooses the bank: whatever it flies is the requested one.
        Some(target.own.ownship.bank_rad)
    }

    fn let_go(&mut self, reach: &mut HandReach<'_>) {
        reach.commands.cancel(MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING);
        reach
            .commands
            .cancel(MavCmd::MAV_CMD_GUIDED_CHANGE_ALTITUDE);
    }
}

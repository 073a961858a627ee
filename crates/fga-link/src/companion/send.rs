//! What is sent: heartbeat, requests, targets, values.

use core::f64::consts::{FRAC_PI_2, PI};

use fga::angle::wrap_pi;
use fga::situation::Obstacle;
use fga::vehicle::STANDARD_GRAVITY_MPS2;
use mavlink::dialects::ardupilotmega::{
    HEARTBEAT_DATA, MavAutopilot, MavCmd, MavFrame, MavMessage, MavModeFlag, MavState, MavType,
};

use super::Companion;
use crate::attitude::{AttitudeCommand, attitude_for, attitude_message};
use crate::authority::{Authority, Fault};
use crate::commands::Command;
use crate::config::CommandMode;
use crate::number::single;
use crate::ownship::State;
use crate::paper::{override_message, throttle_us};
use crate::telling;

/// The fence is downloaded again this long after the last time, seconds.
const FENCE_AGAIN_S: f64 = 10.0;
/// A heading target is sent again when it changes by this, or after this time.
const HEADING_STEP_RAD: f64 = 0.035;
const HEADING_AGAIN_S: f64 = 1.0;
/// Farthest ahead of the present heading that a heading target may lie: less than half a turn, so
/// that the autopilot turns to the side that is meant.
const FARTHEST_HEADING_RAD: f64 = 2.6;
/// Time between targets until the vehicle has confirmed the mode, seconds.
const TAKING_PERIOD_S: f64 = 0.02;
/// A climb is commanded as an altitude this far ahead, seconds.
const CLIMB_AHEAD_S: f64 = 4.0;

impl Companion {
    pub(super) fn send_regular(&mut self, now_s: f64) {
        if now_s >= self.due.heartbeat_s {
            self.due.heartbeat_s = now_s + 1.0;
            // From the beginning: a peer that waits on a UDP port answers only who spoke first.
            self.outbox.send(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode: 0,
                mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
                autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
                base_mode: MavModeFlag::empty(),
                system_status: MavState::MAV_STATE_ACTIVE,
                mavlink_version: 3,
            }));
        }
        let Some(system) = self.vehicle_system() else {
            return;
        };
        // Each target answers an attitude.
        let attitude_s = 1.0 / self.config.command.rate_hz;
        self.rates.tick(attitude_s, now_s, system, &mut self.outbox);
        self.parameters.tick(now_s, system, &mut self.outbox);
        if self.mission.tick(now_s, system, &mut self.outbox) {
            self.mission_arrived(now_s);
        }
        if !self.mission.is_busy() && self.fence_download.tick(now_s, system, &mut self.outbox) {
            self.fence_arrived(now_s);
        }
        self.probe_lists(system, now_s);
        self.ask_for_round_trip(system, now_s);
        self.look_for_fence(now_s);
        if now_s >= self.due.values_s {
            self.due.values_s = now_s + 0.5;
            self.send_values(now_s);
        }
    }

    /// Downloads the fence now and then: no message tells every change of it.
    fn look_for_fence(&mut self, now_s: f64) {
        if self.fence_download.is_busy() {
            self.due.fence_s = now_s + FENCE_AGAIN_S;
        } else if now_s >= self.due.fence_s
            && self.fence_download.changes() > 0
            && !self.keeper.is_engaged()
        {
            self.fence_download.begin();
        }
    }

    pub(super) fn send_commands(&mut self, now_s: f64) {
        let Some(system) = self.vehicle_system() else {
            return;
        };
        let hearing = &mut self.hearing;
        let asks = |change| hearing.ask(change, now_s);
        let outcome = self.commands.tick(now_s, system, asks, &mut self.outbox);
        if let Some(outcome) = outcome {
            self.command_ended(outcome, now_s);
        }
    }

    /// Where the authority stands; it neither is ready nor commands while nothing can be decided.
    fn send_state(&mut self, now_s: f64) {
        let state = match self.keeper.state() {
            Authority::Ready | Authority::Taking { .. } | Authority::InCommand { .. }
                if !self.can_decide(now_s) =>
            {
                0.0
            }
            Authority::Waiting | Authority::Resuming { .. } => 0.0,
            Authority::Ready => 1.0,
            Authority::Taking { .. } => 2.0,
            Authority::InCommand { .. } => 3.0,
            Authority::Returning { .. } => 4.0,
            Authority::Released { .. } => 5.0,
        };
        self.outbox
            .send(telling::value("FGA_STATE", state, self.boot_ms));
    }

    fn send_values(&mut self, now_s: f64) {
        self.send_state(now_s);
        let Some(decided) = self.decided else { return };
        let own = decided.own.ownship.position_m;
        let margin = |obstacle: &Obstacle| obstacle.volume.margin_m(own - obstacle.position_m);
        let least_m = self
            .obstacles
            .iter()
            .map(margin)
            .fold(f64::INFINITY, f64::min);
        let boot_ms = self.boot_ms;
        if least_m.is_finite() {
            self.outbox
                .send(telling::value("FGA_MARGIN", least_m, boot_ms));
        }
        if let Some(threat) = decided.decision.record.threat {
            self.outbox
                .send(telling::value("FGA_ENTRY", threat.entry_s, boot_ms));
        }
        let response = self.response.response();
        for (name, value) in [
            ("FGA_TURN", response.turn_rate_factor),
            ("FGA_LAG", response.bank_time_constant_s),
            ("FGA_DEAD", response.dead_time_s),
        ] {
            self.outbox.send(telling::value(name, value, boot_ms));
        }
    }

    pub(super) fn send_collision(&mut self, now_s: f64) {
        if now_s < self.due.collision_s {
            return;
        }
        let Some(decided) = self.decided else { return };
        let Some(threat) = decided.decision.record.threat else {
            return;
        };
        self.due.collision_s = now_s + 0.5;
        let icao = self.tracks.get(threat.id).map_or(0, |track| track.icao);
        let id = if icao == 0 { threat.id } else { icao };
        let engaged = self.keeper.is_engaged();
        let message = telling::collision(
            &decided.decision,
            &self.obstacles,
            &decided.own,
            engaged,
            id,
        );
        if let Some(message) = message {
            self.outbox.send(message);
        }
    }

    /// Sends targets that follow the last decision, where it has the authority to.
    pub(super) fn command(&mut self, now_s: f64) {
        self.due.command_s = now_s + self.command_period_s();
        let returning = matches!(self.keeper.state(), Authority::Returning { .. });
        if returning && self.config.command.mode == CommandMode::Paper {
            // CRUISE locks its heading once the stick is centred.
            self.send_override(Some(1500));
            return;
        }
        if !self.keeper.commands() || self.dry_run {
            return;
        }
        let Some(state) = self.state_ahead(now_s) else {
            return;
        };
        match self.config.command.mode {
            CommandMode::Attitude => self.command_attitude(now_s, &state),
            // Refused outside GUIDED: the confirmation is waited for.
            CommandMode::Heading if matches!(self.keeper.state(), Authority::Taking { .. }) => {}
            CommandMode::Heading => self.command_heading(now_s, &state),
            CommandMode::Paper => self.command_sticks(),
        }
        self.commanded_lately.push(now_s, self.commanded.bank_rad);
        self.watch_following(now_s);
    }

    /// Time from one target to the next, seconds: short until the mode is confirmed. Targets that reach
    /// the vehicle before its mode has changed count for nothing, and without one GUIDED circles.
    pub(super) fn command_period_s(&self) -> f64 {
        let period_s = 1.0 / self.config.command.rate_hz;
        if matches!(self.keeper.state(), Authority::Taking { .. }) {
            period_s.min(TAKING_PERIOD_S)
        } else {
            period_s
        }
    }

    fn command_attitude(&mut self, now_s: f64, state: &State) {
        let (Some(decided), Some(system)) = (self.decided, self.vehicle_system()) else {
            return;
        };
        let Some(avoider) = &self.avoider else { return };
        let Some(normal_rad) = self.bank_limit_rad() else {
            return;
        };
        let in_need = avoider
            .vehicle_in_need()
            .zip(self.bank_in_need_rad())
            .filter(|_| decided.decision.record.in_need);
        let (vehicle, limit_rad) = in_need.unwrap_or((avoider.vehicle(), normal_rad));
        let ahead_s = self.response.response().dead_time_s;
        let elapsed_s = (now_s + ahead_s - decided.for_s).max(0.0);
        self.commanded = attitude_for(
            &decided.decision.command,
            elapsed_s,
            &state.ownship,
            vehicle,
            limit_rad,
        );
        let climb_rad = self.commanded.climb_rad.filter(|_| vehicle.can_climb());
        let pitch_rad = self.pitch.pitch_rad(climb_rad, state.ownship.position_m.z);
        let message = attitude_message(self.commanded.bank_rad, pitch_rad, self.boot_ms, system);
        self.outbox.send(message);
    }

    fn command_heading(&mut self, now_s: f64, state: &State) {
        let Some(decided) = self.decided else { return };
        let Some(limit_rad) = self.bank_limit_rad() else {
            return;
        };
        let elapsed_s = (now_s - decided.for_s).max(0.0);
        let Some(stage) = decided.decision.command.stage_at(elapsed_s).copied() else {
            return;
        };
        let turn_rad = stage.course_rad - state.ownship.course_rad;
        let target_rad =
            state.ownship.course_rad + turn_rad.clamp(-FARTHEST_HEADING_RAD, FARTHEST_HEADING_RAD);
        // For the check whether it follows, and for the estimate of the response.
        self.commanded = AttitudeCommand {
            bank_rad: state.ownship.bank_rad,
            climb_rad: None,
        };
        let changed = self
            .last_heading_rad
            .is_none_or(|last| wrap_pi(target_rad - last).abs() > HEADING_STEP_RAD);
        if !changed && now_s < self.due.heading_s {
            return;
        }
        let busy = self
            .commands
            .is_waiting(MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING);
        if busy && !changed {
            return;
        }
        self.due.heading_s = now_s + HEADING_AGAIN_S;
        self.last_heading_rad = Some(target_rad);
        let compass_deg = (FRAC_PI_2 - target_rad).rem_euclid(2.0 * PI).to_degrees();
        let acceleration = STANDARD_GRAVITY_MPS2 * libm::tan(limit_rad);
        // The heading of the nose (1), not the course over the ground: the plan is in the air mass.
        let parameters = [
            1.0,
            single(compass_deg),
            single(acceleration),
            0.0,
            0.0,
            0.0,
            0.0,
        ];
        self.commands.send(
            Command {
                command: MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING,
                parameters,
                frame: Some(MavFrame::MAV_FRAME_GLOBAL),
                change: None,
            },
            true,
        );
        let climbs = self
            .avoider
            .as_ref()
            .is_some_and(|avoider| avoider.vehicle().can_climb());
        if climbs
            && stage.climb_rad.abs() > 0.01
            && let Some(frame) = self.ownship.frame()
        {
            let climb_m = state.ownship.airspeed_mps * libm::sin(stage.climb_rad) * CLIMB_AHEAD_S;
            let altitude_m = frame.origin().altitude_m + state.ownship.position_m.z + climb_m;
            self.commands.send(
                Command {
                    command: MavCmd::MAV_CMD_GUIDED_CHANGE_ALTITUDE,
                    parameters: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, single(altitude_m)],
                    frame: Some(MavFrame::MAV_FRAME_GLOBAL),
                    change: None,
                },
                true,
            );
        }
        self.send_commands(now_s);
    }

    fn command_sticks(&mut self) {
        self.send_override(Some(self.paper_roll_us));
    }

    pub(super) fn send_override(&mut self, roll_us: Option<u16>) {
        let Some(system) = self.vehicle_system() else {
            return;
        };
        if self.dry_run {
            return;
        }
        let named = |name: &str, other: f64| self.parameters.get(name).unwrap_or(other);
        let airspeed_mps = self.ownship.airspeed_mps().unwrap_or(0.0);
        let throttle = throttle_us(
            airspeed_mps,
            named("AIRSPEED_MIN", 0.0),
            named("AIRSPEED_MAX", 0.0),
        );
        let sticks = roll_us.map(|roll| [roll, 1500, throttle]);
        // Overrides count only from the ground station's system id.
        let ground =
            u8::try_from(crate::number::to_u16(named("MAV_GCS_SYSID", 255.0))).unwrap_or(u8::MAX);
        self.outbox
            .send_as(ground, override_message(sticks, system));
    }

    fn watch_following(&mut self, now_s: f64) {
        let commands = matches!(self.keeper.state(), Authority::InCommand { .. });
        if self.recorded || !commands || self.is_blind(now_s) {
            self.following_since_s = None;
            return;
        }
        let tolerance_rad = self.config.safety.follow_tolerance_deg.to_radians();
        let Some(bank_rad) = self.ownship.bank_rad() else {
            return;
        };
        if (self.commanded.bank_rad - bank_rad).abs() <= tolerance_rad {
            self.following_since_s = None;
            return;
        }
        let since_s = *self.following_since_s.get_or_insert(now_s);
        if now_s - since_s > self.config.safety.follow_time_s {
            self.fault(Fault::NotFollowing, now_s);
        }
    }
}

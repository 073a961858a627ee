//! The outgoing messages: heartbeat, requests, targets, values.

use fga::situation::Obstacle;
use mavlink::dialects::ardupilotmega::{MavCmd, MavType};
use serde_json::json;

use super::Companion;
use crate::authority::{Authority, Fault};
use crate::commands::{CommandEnd, VehicleCommand};
use crate::hand::{Hand, HandReach, HandTarget};
use crate::mode::Mode;
use crate::ownship::OwnState;
use crate::telling;

/// Time between targets until the vehicle has confirmed the mode, seconds.
const TAKING_PERIOD_S: f64 = 0.02;

impl Companion {
    pub(super) fn send_regular(&mut self, now_s: f64) {
        if now_s >= self.due.heartbeat_s {
            self.due.heartbeat_s = now_s + 1.0;
            // From the beginning: a peer that waits on a UDP port answers only to a first message.
            let kind = MavType::MAV_TYPE_ONBOARD_CONTROLLER;
            self.voice.send(telling::heartbeat(kind));
        }
        let Some(system) = self.vehicle_system() else {
            return;
        };
        // Each target answers an attitude.
        let attitude_s = 1.0 / self.config.command.rate_hz;
        let engaged = self.keeper.is_engaged();
        self.requests.tick(engaged, attitude_s, &mut self.voice);
        self.lay_fence();
        let age_s = self.telemetry_age_s(now_s);
        if let Some(request) = self.lead.request(age_s, system, now_s) {
            self.voice.send(request);
        }
        if now_s >= self.due.values_s {
            self.due.values_s = now_s + 0.5;
            self.send_values(now_s);
        }
    }

    pub(super) fn send_commands(&mut self, now_s: f64) {
        if self.vehicle_system().is_none() {
            return;
        }
        let (session, keeper) = (&mut self.session, &mut self.keeper);
        let asks = |change| {
            let may = session.ask(change, now_s);
            if may {
                keeper.asked(change, now_s);
            }
            may
        };
        let outcome = self.requests.send_commands(asks, &mut self.voice);
        if let Some(outcome) = outcome {
            self.command_ended(outcome, now_s);
        }
    }

    pub(super) fn ask_for_mode(&mut self, to: Mode, from: Mode, now_s: f64) {
        if self.session.is_dry_run() {
            return;
        }
        self.requests.command(VehicleCommand::set_mode(to, from));
        self.send_commands(now_s);
    }

    pub(super) fn command_ended(&mut self, outcome: CommandEnd, now_s: f64) {
        let (command, refused) = match outcome {
            CommandEnd::Accepted(_) => return,
            CommandEnd::Refused(command, result) => (command, Some(result)),
            CommandEnd::Unanswered(command) => (command, None),
        };
        let result = refused.map_or("no answer".to_owned(), |result| format!("{result:?}"));
        self.voice.note(
            "refused",
            json!({ "command": format!("{:?}", command.command), "result": result }),
        );
        match command.command {
            MavCmd::MAV_CMD_DO_SET_MODE => {
                self.keep(now_s, |keeper| keeper.mode_refused(now_s));
            }
            MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING if self.keeper.commands() => {
                self.fault(Fault::NotFollowing, now_s);
            }
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => {
                self.voice.warn("fga: mission item not set");
            }
            _ => {}
        }
    }

    /// The state of the authority; while no decision is possible, neither ready nor in command.
    fn send_state(&mut self, now_s: f64) {
        let state = match self.keeper.state() {
            Authority::Ready | Authority::Taking { .. } | Authority::InCommand { .. }
                if !self.decisions.are_possible(now_s) =>
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
        self.voice
            .send(telling::value("FGA_STATE", state, self.session.boot_ms()));
    }

    fn send_values(&mut self, now_s: f64) {
        self.send_state(now_s);
        let Some(decided) = self.decisions.last() else {
            return;
        };
        let own = decided.own.ownship.position_m;
        let margin = |obstacle: &Obstacle| obstacle.volume.margin_m(own - obstacle.position_m);
        let least_m = self
            .around
            .obstacles()
            .iter()
            .map(margin)
            .fold(f64::INFINITY, f64::min);
        let boot_ms = self.session.boot_ms();
        if least_m.is_finite() {
            self.voice
                .send(telling::value("FGA_MARGIN", least_m, boot_ms));
        }
        if let Some(threat) = decided.decision.record.threat {
            self.voice
                .send(telling::value("FGA_ENTRY", threat.entry_s, boot_ms));
        }
        let response = self.response();
        for (name, value) in [
            ("FGA_TURN", response.turn_rate_factor),
            ("FGA_STEEP", self.lead.steep_response().turn_rate_factor),
            ("FGA_LAG", response.bank_time_constant_s),
            ("FGA_DEAD", response.dead_time_s),
        ] {
            self.voice.send(telling::value(name, value, boot_ms));
        }
    }

    pub(super) fn send_collision(&mut self, now_s: f64) {
        if now_s < self.due.collision_s {
            return;
        }
        let Some(decided) = self.decisions.last() else {
            return;
        };
        let Some(threat) = decided.decision.record.threat else {
            return;
        };
        self.due.collision_s = now_s + 0.5;
        let id = self.around.number(threat.id);
        let engaged = self.keeper.is_engaged();
        let message = telling::collision_of(
            &decided.decision,
            self.around.obstacles(),
            &decided.own,
            engaged,
            id,
        );
        if let Some(message) = message {
            self.voice.send(message);
        }
    }

    /// Sends targets that follow the last decision, if it has the authority.
    pub(super) fn command(&mut self, now_s: f64) {
        self.due.command_s = now_s + self.command_period_s();
        if matches!(self.keeper.state(), Authority::Returning { .. }) {
            self.fly_straight(now_s);
            return;
        }
        if !self.keeper.commands() {
            return;
        }
        let Some(state) = self.state_ahead(now_s) else {
            return;
        };
        let bank_rad = self.fly(&state, now_s);
        self.lead.command(bank_rad, now_s);
        self.send_commands(now_s);
        self.watch_following(now_s);
    }

    /// Commands the decision; returns the bank that the vehicle should take up, radians.
    fn fly(&mut self, state: &OwnState, now_s: f64) -> Option<f64> {
        let decided = *self.decisions.last()?;
        let normal_rad = self.bank_limit_rad()?;
        let pilot = self.decisions.pilot()?;
        let in_need = pilot
            .vehicle_in_need()
            .zip(self.bank_in_need_rad())
            .filter(|_| decided.decision.record.in_need);
        let (vehicle, bank_limit_rad) = in_need.unwrap_or((pilot.vehicle(), normal_rad));
        let vehicle = *vehicle;
        let elapsed_s = (self.lead.acts_s(now_s) - decided.for_s).max(0.0);
        let is_confirmed = self.is_in_command();
        self.with_hand(now_s, |hand, reach| {
            let target = HandTarget {
                maneuver: &decided.decision.command,
                elapsed_s,
                own: state,
                vehicle: &vehicle,
                bank_limit_rad,
                is_confirmed,
            };
            hand.fly(&target, reach)
        })?
    }

    /// Flies straight while the vehicle changes back its mode.
    pub(super) fn fly_straight(&mut self, now_s: f64) {
        self.with_hand(now_s, |hand, reach| hand.fly_straight(reach));
    }

    /// Cancels commands that the vehicle would go on following.
    pub(super) fn let_go(&mut self, now_s: f64) {
        self.with_hand(now_s, |hand, reach| hand.let_go(reach));
    }

    /// Lets the hand act, once a vehicle is known; never in a dry run.
    fn with_hand<T>(
        &mut self,
        now_s: f64,
        act: impl FnOnce(&mut dyn Hand, &mut HandReach<'_>) -> T,
    ) -> Option<T> {
        let system = self.session.commanded_system()?;
        let (_, parameters, commands) = self.requests.for_commands();
        let mut reach = HandReach {
            outbox: self.voice.outbox(),
            commands,
            parameters,
            frame: self.ownship.frame(),
            system,
            boot_ms: self.session.boot_ms(),
            airspeed_mps: self.ownship.airspeed_mps().unwrap_or(0.0),
            now_s,
        };
        Some(act(self.hand.as_mut(), &mut reach))
    }

    /// Time from one target to the next, seconds: short until the vehicle confirms the mode. Targets that arrive
    /// before the change of the mode do not count, and without a target GUIDED circles.
    pub(super) fn command_period_s(&self) -> f64 {
        let period_s = 1.0 / self.config.command.rate_hz;
        if matches!(self.keeper.state(), Authority::Taking { .. }) {
            period_s.min(TAKING_PERIOD_S)
        } else {
            period_s
        }
    }

    fn watch_following(&mut self, now_s: f64) {
        let commands = self.is_in_command();
        let is_watched = commands && !self.session.is_recorded() && !self.is_blind(now_s);
        let bank_rad = self.ownship.bank_rad().filter(|_| is_watched);
        let tolerance_rad = self.config.safety.follow_tolerance_deg.to_radians();
        let apart_s = self.lead.apart_s(bank_rad, tolerance_rad, now_s);
        if apart_s > self.config.safety.follow_time_s {
            self.fault(Fault::NotFollowing, now_s);
        }
    }
}

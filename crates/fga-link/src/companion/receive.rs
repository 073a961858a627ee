//! The effect of each message.

use fga::avoider::{Reason, State as AvoiderState};
use fga_formats::geodesy::LocalFrame;
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    ATTITUDE_DATA, HEARTBEAT_DATA, MavCmd, MavMessage, MavMissionType, MavResult,
    MavSysStatusSensor,
};
use serde_json::json;

use super::Companion;
use super::session::{News, Noted, SILENT_S};
use crate::authority::{Beat, Fault, Severity, reaction};
use crate::commands::{Command, Outcome};
use crate::config::CommandMode;
use crate::mode::Mode;
use crate::outgoing::{AUTOPILOT, OWN_COMPONENT};
use crate::ownship::Update;
use crate::traffic::fence;

impl Companion {
    /// Takes a message.
    pub fn receive(&mut self, header: &MavHeader, message: &MavMessage, now_s: f64) {
        if self.take_traffic(*header, message, now_s) {
            return;
        }
        if let MavMessage::TERRAIN_DATA(data) = message {
            self.take_terrain(data, now_s);
            return;
        }
        let Ok(system) = u8::try_from(header.system_id) else {
            return;
        };
        if header.component_id == OWN_COMPONENT && Some(system) == self.vehicle_system() {
            // Ourselves, sent back by a router.
            return;
        }
        if let MavMessage::HEARTBEAT(data) = message {
            self.take_heartbeat(*header, system, data, now_s);
            if self.vehicle_system() == Some(system) && header.component_id == AUTOPILOT {
                self.rates.heard(message, now_s);
            }
            return;
        }
        let from_vehicle =
            self.vehicle_system() == Some(system) && header.component_id == AUTOPILOT;
        if from_vehicle {
            self.take_telemetry(message, now_s);
            self.take_held_reports(now_s);
        }
        self.take_request(system, header.component_id, message, now_s);
    }

    fn take_heartbeat(&mut self, header: MavHeader, system: u8, data: &HEARTBEAT_DATA, now_s: f64) {
        let (session, voice) = (&mut self.session, &mut self.voice);
        let Some(beat) = Beat::of_plane(header, data) else {
            session.hear_stranger(header, data, voice, now_s);
            return;
        };
        match session.hear(system, beat, voice, now_s) {
            News::Nothing => {}
            News::First => {
                self.mission.begin();
                if self.config.safety.use_fence {
                    self.fence_download.begin();
                }
                self.read_rally_again();
            }
            News::Next {
                mode,
                mode_was,
                silent_s,
                contradicts,
                disarmed,
            } => {
                if mode != mode_was {
                    self.watch.mode_changed(now_s);
                }
                if silent_s > SILENT_S {
                    self.keeper.excuse(silent_s);
                }
                // The mode first: whoever changed it wins, whatever else this message contains.
                let actions = self.keeper.heartbeat(mode, beat.armed, now_s);
                self.perform(&actions, now_s);
                if mode == Mode::AUTO {
                    self.mission_goes_on();
                }
                if mode == Mode::AUTO && mode_was == self.keeper.target() {
                    self.set_item_to_resume(now_s);
                }
                if contradicts {
                    self.heartbeats_contradict(mode, now_s);
                }
                if disarmed {
                    self.fault(Fault::Disarmed, now_s);
                }
            }
        }
    }

    fn heartbeats_contradict(&mut self, mode: Mode, now_s: f64) {
        self.voice
            .note(now_s, "contradiction", json!({ "mode": mode.name() }));
        if self.keeper.is_engaged() {
            self.fault(Fault::Contradiction, now_s);
        } else {
            let row = reaction(Fault::Contradiction);
            let actions = self.keeper.readiness(false, now_s);
            self.perform(&actions, now_s);
            self.voice.tell(row.severity, row.text, now_s);
        }
    }

    /// A program that was restarted in a manoeuvre continues it once the vehicle's clock shows
    /// that its note counts.
    fn take_note(&mut self, boot_ms: u32, now_s: f64) {
        let target = self.keeper.target();
        match self
            .session
            .take_note(boot_ms, target, &mut self.voice, now_s)
        {
            Some(Noted::Doubt(note)) => {
                self.keeper
                    .doubt(Mode(note.owned_mode), note.previous(), now_s);
            }
            Some(Noted::Resume(note)) => {
                self.keeper.resume(note.previous(), now_s);
                self.resume_passing(note.item);
            }
            None => {}
        }
    }

    fn take_telemetry(&mut self, message: &MavMessage, now_s: f64) {
        self.rates.heard(message, now_s);
        match message {
            MavMessage::GLOBAL_POSITION_INT(data) => {
                self.session
                    .take_position(data, self.ownship.frame(), now_s);
                let update = self.ownship.take_position(data, now_s);
                self.after_update(update, now_s);
                self.renew_frame(now_s);
            }
            MavMessage::ATTITUDE(data) => {
                self.session.stamp(data.time_boot_ms, now_s);
                self.take_note(data.time_boot_ms, now_s);
                let update = self.ownship.take_attitude(data, now_s);
                if update == Update::Fresh {
                    self.session.set_boot_ms(data.time_boot_ms);
                    self.learn_response(data, now_s);
                }
                self.after_update(update, now_s);
                if update == Update::Fresh {
                    self.prompted(now_s);
                }
            }
            MavMessage::SYS_STATUS(data) => {
                let fence = MavSysStatusSensor::MAV_SYS_STATUS_GEOFENCE;
                self.fence_enabled = Some(data.onboard_control_sensors_enabled.contains(fence));
            }
            MavMessage::DISTANCE_SENSOR(data) => self.take_rangefinder(data, now_s),
            MavMessage::RANGEFINDER(data) if data.distance > 0.0 => {
                self.take_distance(f64::from(data.distance), now_s);
            }
            MavMessage::VFR_HUD(data) => self.ownship.take_hud(data),
            MavMessage::WIND(data) => self.ownship.take_wind(data, now_s),
            MavMessage::SCALED_PRESSURE(data) => {
                if let Some(altitude_m) = self.ownship.altitude_m(now_s) {
                    let hpa = f64::from(data.press_abs);
                    self.tracks
                        .levels_mut()
                        .take_pressure(hpa, altitude_m, now_s);
                }
            }
            MavMessage::GPS_RAW_INT(data) => self.take_geoid(data),
            MavMessage::PARAM_VALUE(data) => {
                self.parameters.take(data);
            }
            MavMessage::MISSION_COUNT(data) => {
                if self.mission.contradicts_count(data) {
                    self.read_mission_again();
                } else if self.fence_download.contradicts_count(data) {
                    self.read_fence_again();
                } else if self.mission.take_count(data) {
                    self.mission_arrived(now_s);
                } else if self.fence_download.take_count(data) {
                    self.fence_arrived(now_s);
                } else {
                    self.take_rally_count(data, now_s);
                }
            }
            MavMessage::MISSION_ITEM_INT(data) => {
                self.compare_item(data);
                if self.mission.take_item(data) {
                    self.mission_arrived(now_s);
                }
                if self.fence_download.take_item(data) {
                    self.fence_arrived(now_s);
                }
                self.take_rally_point(data, now_s);
            }
            MavMessage::MISSION_CURRENT(data) => self.take_mission_current(data),
            MavMessage::POSITION_TARGET_GLOBAL_INT(data) => self.take_position_target(data, now_s),
            MavMessage::NAV_CONTROLLER_OUTPUT(data) => self.take_nav(data, now_s),
            MavMessage::TIMESYNC(data) => self.take_round_trip(data, now_s),
            MavMessage::STATUSTEXT(data) => self.take_vehicle_text(data),
            MavMessage::MISSION_ACK(data)
                if data.target_system != 0 && data.target_component != OWN_COMPONENT =>
            {
                self.list_uploaded(data.mission_type);
            }
            MavMessage::MISSION_ACK(data) => self.take_mission_refusal(data),
            MavMessage::COMMAND_ACK(data) => {
                // An answer to nobody in particular may be to somebody else's request.
                if data.command == MavCmd::MAV_CMD_DO_SET_MODE
                    && data.target_component == OWN_COMPONENT
                {
                    let accepted = data.result == MavResult::MAV_RESULT_ACCEPTED;
                    self.keeper.answered(accepted, now_s);
                }
                let for_us = data.target_component == OWN_COMPONENT || data.target_component == 0;
                if for_us && let Some(outcome) = self.commands.acknowledge(data, now_s) {
                    self.command_ended(outcome, now_s);
                }
            }
            _ => {}
        }
    }

    fn after_update(&mut self, update: Update, now_s: f64) {
        if update == Update::Restarted {
            self.fault(Fault::AutopilotRestarted, now_s);
            self.rates.restart();
            self.forget_plan();
        }
    }

    /// Moves the local frame if the aircraft is far from its origin and nothing threatens;
    /// the companion then learns everything in the old frame again.
    fn renew_frame(&mut self, now_s: f64) {
        let busy = self
            .decider
            .as_ref()
            .is_some_and(|decider| decider.state() != AvoiderState::Cruise);
        if self.keeper.is_engaged() || busy || !self.ownship.move_frame() {
            return;
        }
        self.tracks.clear();
        self.fence = fence::Fence::default();
        self.fence_laid = 0;
        self.forget_ground();
        self.way_mode = None;
        self.watch.mode_changed(now_s);
        self.forget_plan();
        if let Some(origin) = self.ownship.frame().map(LocalFrame::origin) {
            self.voice.note(
                now_s,
                "frame",
                json!({
                    "latitude_deg": origin.latitude_deg,
                    "longitude_deg": origin.longitude_deg,
                }),
            );
        }
    }

    fn learn_response(&mut self, data: &ATTITUDE_DATA, now_s: f64) {
        let Some(airspeed_mps) = self.ownship.airspeed_mps() else {
            return;
        };
        let measured_s = now_s - self.ownship.attitude_age_s(now_s).unwrap_or(0.0);
        let normal_rad = self.bank_limit_rad().unwrap_or(f64::INFINITY);
        self.lead.learn(data, measured_s, airspeed_mps, normal_rad);
    }

    /// Somebody else has just uploaded a list: reads it again.
    fn list_uploaded(&mut self, kind: MavMissionType) {
        if kind == self.mission.kind() {
            self.read_mission_again();
        }
        if kind == self.fence_download.kind() {
            self.read_fence_again();
        }
        if kind == MavMissionType::MAV_MISSION_TYPE_RALLY {
            self.read_rally_again();
        }
    }

    pub(super) fn mission_arrived(&mut self, now_s: f64) {
        if let Some(system) = self.vehicle_system() {
            self.voice.send(self.mission.closing(system));
        }
        if self.mission_laid == self.mission.changes() {
            return;
        }
        let again = self.mission_laid > 0;
        self.mission_laid = self.mission.changes();
        self.watch.read();
        let count = self.mission.items().map_or(0, <[_]>::len);
        self.voice.note(now_s, "mission", json!({ "items": count }));
        if again {
            self.voice
                .tell(Severity::Notice, "fga: the mission has changed", now_s);
        }
    }

    pub(super) fn fence_arrived(&mut self, now_s: f64) {
        if let Some(system) = self.vehicle_system() {
            self.voice.send(self.fence_download.closing(system));
        }
        self.lay_fence(now_s);
    }

    pub(super) fn lay_fence(&mut self, now_s: f64) {
        let (Some(items), Some(frame)) = (self.fence_download.items(), self.ownship.frame()) else {
            return;
        };
        let changes = self.fence_download.changes();
        if self.fence_laid == changes {
            return;
        }
        let again = self.fence_laid > 0;
        self.fence_laid = changes;
        let count = items.len();
        self.fence = fence::Fence::new(items, frame);
        self.voice.note(
            now_s,
            "fence",
            json!({ "items": count, "incomplete": self.fence.incomplete }),
        );
        if again {
            self.voice
                .tell(Severity::Notice, "fga: the fence has changed", now_s);
        }
        if self.fence.incomplete {
            self.voice.tell(
                Severity::Warning,
                "fga: part of the fence was not understood",
                now_s,
            );
        }
        let has_fence = self.fence.zones().next().is_some();
        if has_fence {
            self.parameters.ask_for_fence();
        }
        if has_fence && self.config.command.mode == CommandMode::Paper {
            let words = "fga: Algorithm 4 knows no fence";
            self.voice.tell(Severity::Warning, words, now_s);
        }
    }

    pub(super) fn command_ended(&mut self, outcome: Outcome, now_s: f64) {
        let (command, refused) = match outcome {
            Outcome::Accepted(_) => return,
            Outcome::Refused(command, result) => (command, Some(result)),
            Outcome::Unanswered(command) => (command, None),
        };
        let result = refused.map_or("no answer".to_owned(), |result| format!("{result:?}"));
        self.voice.note(
            now_s,
            "refused",
            json!({ "command": format!("{:?}", command.command), "result": result }),
        );
        match command.command {
            MavCmd::MAV_CMD_DO_SET_MODE => {
                let actions = self.keeper.mode_refused(now_s);
                self.perform(&actions, now_s);
            }
            MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING if self.keeper.commands() => {
                self.fault(Fault::NotFollowing, now_s);
            }
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => {
                self.voice
                    .tell(Severity::Warning, "fga: mission item not set", now_s);
            }
            _ => {}
        }
    }

    /// After telemetry: decides and commands when due.
    fn prompted(&mut self, now_s: f64) {
        // The target that follows the plan goes out first: a search may take longer.
        if now_s >= self.due.command_s - 0.2 / self.config.command.rate_hz {
            self.command(now_s);
        }
        // A little early is better than a whole period late.
        let slack_s = 0.2 * self.config.command.decision_period_s;
        if now_s >= self.due.decision_s - slack_s {
            self.decide(now_s);
            let reason = self.decided.map(|decided| decided.decision.record.reason);
            let is_new = matches!(
                reason,
                Some(
                    Reason::ManeuverChosen
                        | Reason::ManeuverReplaced
                        | Reason::BestAvailable
                        | Reason::RejoinChosen
                )
            );
            if is_new {
                self.command(now_s);
            }
        }
    }

    pub(super) fn ask_for_mode(&mut self, to: Mode, from: Mode, now_s: f64) {
        if self.session.is_dry_run() {
            return;
        }
        self.commands.send(Command::set_mode(to, from), true);
        self.send_commands(now_s);
    }
}

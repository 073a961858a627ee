//! The effect of each message.

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    ATTITUDE_DATA, GPS_RAW_INT_DATA, GpsFixType, HEARTBEAT_DATA, MavCmd, MavMessage, MavResult,
    POSITION_TARGET_GLOBAL_INT_DATA,
};
use serde_json::json;

use super::Companion;
use super::others::{OtherOrders, is_order};
use super::over_ground::distance_m;
use super::session::{News, Noted, SILENT_S};
use super::traffic::{ReportContext, TrafficReports};
use crate::authority::{Beat, Fault, reaction};
use crate::config::CommandMode;
use crate::mode::Mode;
use crate::number::place_from_e7;
use crate::outgoing::{AUTOPILOT, OWN_COMPONENT};
use crate::ownship::Update;
use crate::parameters::FENCE_OPTIONS;
use crate::traffic::PlaceReport;
use crate::traffic::receiver::FeedStatus;

impl Companion {
    /// Takes a message.
    pub fn receive(&mut self, header: &MavHeader, message: &MavMessage, now_s: f64) {
        self.voice.at(now_s);
        let (reports, mut at) = self.reports_here();
        if reports.take_message(*header, message, &mut at) {
            return;
        }
        if let MavMessage::TERRAIN_DATA(data) = message {
            self.over.take_terrain(data, &mut self.voice);
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
            self.hear_vehicle(system, header.component_id, message);
            return;
        }
        if self.hear_vehicle(system, header.component_id, message) {
            self.take_telemetry(header.sequence, message, now_s);
            self.take_held_reports();
        } else if self.is_in_command()
            && is_order(message, self.vehicle_system(), self.keeper.target())
        {
            self.fault(Fault::OthersCommand, now_s);
        }
        self.take_request(system, header.component_id, message, now_s);
    }

    /// Takes what the vehicle was asked for; `false` for a message of somebody else.
    fn hear_vehicle(&mut self, system: u8, component: u8, message: &MavMessage) -> bool {
        let is_vehicle = self.vehicle_system() == Some(system) && component == AUTOPILOT;
        if is_vehicle {
            let in_auto = self.session.mode() == Some(Mode::AUTO);
            let (ownship, voice) = (&self.ownship, &mut self.voice);
            self.requests.hear(message, ownship, in_auto, voice);
        }
        is_vehicle
    }

    fn take_heartbeat(&mut self, header: MavHeader, system: u8, data: &HEARTBEAT_DATA, now_s: f64) {
        let (session, voice) = (&mut self.session, &mut self.voice);
        let Some(beat) = Beat::of_plane(header, data) else {
            session.hear_stranger(header, data, voice);
            return;
        };
        match session.hear(system, beat, voice) {
            News::Nothing => {}
            News::First => self.requests.begin(),
            News::Overtaken => self.keep(now_s, |keeper| keeper.overtaken(beat, now_s)),
            News::Next {
                mode,
                mode_was,
                silent_s,
                contradicts,
                disarmed,
            } => {
                if mode != mode_was {
                    self.requests.mode_changed(now_s);
                }
                if silent_s > SILENT_S {
                    self.keeper.excuse(silent_s);
                }
                // The mode first: whoever changed it wins, whatever else this message contains.
                self.keep(now_s, |keeper| keeper.heartbeat(beat, now_s));
                if mode == Mode::AUTO {
                    self.passing.mission_goes_on();
                }
                if mode == Mode::AUTO && mode_was == self.keeper.target() {
                    let (lists, _, commands) = self.requests.for_commands();
                    let (ownship, voice) = (&self.ownship, &mut self.voice);
                    self.passing.has_auto_back(lists, ownship, commands, voice);
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
            .note("contradiction", json!({ "mode": mode.name() }));
        if self.keeper.is_engaged() {
            self.fault(Fault::Contradiction, now_s);
        } else {
            let row = reaction(Fault::Contradiction);
            self.keep(now_s, |keeper| keeper.readiness(false, now_s));
            self.voice.tell(row.severity, row.text);
        }
    }

    /// A program that was restarted in a manoeuvre continues it once the vehicle's clock shows
    /// that its note counts.
    fn take_note(&mut self, boot_ms: u32, now_s: f64) {
        let target = self.keeper.target();
        match self.session.take_note(boot_ms, target, &mut self.voice) {
            Some(Noted::Doubt(note)) => {
                self.keeper
                    .doubt(Mode(note.owned_mode), note.previous(), now_s);
            }
            Some(Noted::Resume(note)) => {
                self.keeper.resume(note.previous(), now_s);
                self.passing.resume(note.item);
            }
            None => {}
        }
    }

    fn take_telemetry(&mut self, sequence: u8, message: &MavMessage, now_s: f64) {
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
                self.boundary.take_status(data);
            }
            MavMessage::TERRAIN_REPORT(data) => self.over.take_report(data, &mut self.voice),
            MavMessage::DISTANCE_SENSOR(data) => {
                if let Some(distance_m) = distance_m(data) {
                    self.take_distance(distance_m, now_s);
                }
            }
            MavMessage::RANGEFINDER(data) if data.distance > 0.0 => {
                self.take_distance(f64::from(data.distance), now_s);
            }
            MavMessage::VFR_HUD(data) => self.ownship.take_hud(data),
            MavMessage::WIND(data) => self.ownship.take_wind(data, now_s),
            MavMessage::SCALED_PRESSURE(data) => {
                if let Some(altitude_m) = self.ownship.altitude_m(now_s) {
                    let hpa = f64::from(data.press_abs);
                    self.around
                        .tracks_mut()
                        .levels_mut()
                        .take_pressure(hpa, altitude_m, now_s);
                }
            }
            MavMessage::GPS_RAW_INT(data) => self.take_geoid(data),
            MavMessage::MISSION_COUNT(_) | MavMessage::MISSION_ITEM_INT(_) => self.lay_fence(),
            MavMessage::POSITION_TARGET_GLOBAL_INT(data) => self.watch_target(data, now_s),
            MavMessage::TIMESYNC(data) => self.take_round_trip(data, now_s),
            MavMessage::COMMAND_ACK(data) => {
                if data.command == MavCmd::MAV_CMD_DO_SET_MODE
                    && data.target_component == OWN_COMPONENT
                {
                    let accepted = data.result == MavResult::MAV_RESULT_ACCEPTED;
                    self.keep(now_s, |keeper| keeper.answered(sequence, accepted, now_s));
                }
                if let Some(outcome) = self.requests.acknowledge(data, now_s) {
                    self.command_ended(outcome, now_s);
                }
            }
            _ => {}
        }
    }

    /// Takes the vehicle's target: one that moves while the companion commands is somebody else's order.
    fn watch_target(&mut self, data: &POSITION_TARGET_GLOBAL_INT_DATA, now_s: f64) {
        if !self.is_in_command() || self.keeper.target() != Mode::GUIDED {
            self.others = OtherOrders::default();
            return;
        }
        let place = place_from_e7(data.lat_int, data.lon_int, 0.0);
        let Some((place, frame)) = place.zip(self.ownship.frame()) else {
            return;
        };
        let (target_m, boot_ms) = (frame.to_local_m(place), self.session.boot_ms());
        if self
            .others
            .is_set_by_others(target_m, data.time_boot_ms, boot_ms)
        {
            self.fault(Fault::OthersCommand, now_s);
        }
    }

    /// A receiver that sends both altitudes gives the height of the geoid.
    fn take_geoid(&mut self, data: &GPS_RAW_INT_DATA) {
        let fixed = data.fix_type as u32 >= GpsFixType::GPS_FIX_TYPE_3D_FIX as u32;
        // Zero: the extension field is missing.
        if fixed && data.alt_ellipsoid != 0 {
            self.around.tracks_mut().levels_mut().take_geoid(
                f64::from(data.alt_ellipsoid) * 1e-3,
                f64::from(data.alt) * 1e-3,
            );
        }
    }

    /// Takes a report of traffic, from a receiver or a message.
    pub fn take_report(&mut self, report: &PlaceReport, now_s: f64) {
        self.voice.at(now_s);
        let (reports, mut at) = self.reports_here();
        reports.take(report, &mut at);
    }

    /// Takes what a receiver has given so far.
    pub fn take_feed(&mut self, status: FeedStatus, now_s: f64) {
        self.reports.take_feed(status, self.voice.at(now_s));
    }

    pub(super) fn take_held_reports(&mut self) {
        let (reports, mut at) = self.reports_here();
        reports.take_held(&mut at);
    }

    /// The reports of traffic, and what they need.
    fn reports_here(&mut self) -> (&mut TrafficReports, ReportContext<'_>) {
        let at = ReportContext {
            config: &self.config,
            system: self.session.system(),
            lead: &self.lead,
            ownship: &mut self.ownship,
            around: &mut self.around,
            voice: &mut self.voice,
        };
        (&mut self.reports, at)
    }

    fn take_distance(&mut self, distance_m: f64, now_s: f64) {
        if let (Some(at_m), Some(decided)) = (self.ownship.position_m(now_s), self.decisions.last())
        {
            self.over
                .take_distance(distance_m, at_m, &decided.own, &mut self.voice);
        }
    }

    fn after_update(&mut self, update: Update, now_s: f64) {
        if update == Update::Restarted {
            self.fault(Fault::AutopilotRestarted, now_s);
            self.requests.restart();
            self.forget_plan();
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

    /// Lays the fence in the local frame, once both are known.
    pub(super) fn lay_fence(&mut self) {
        let (Some(fence), Some(frame)) = (self.requests.lists().fence(), self.ownship.frame())
        else {
            return;
        };
        if !self.boundary.lay(fence, frame, &mut self.voice) {
            return;
        }
        self.requests.ask_for(FENCE_OPTIONS);
        if self.config.command.mode == CommandMode::Paper {
            self.voice.warn("fga: Algorithm 4 knows no fence");
        }
    }
}

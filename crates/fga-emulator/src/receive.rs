//! The autopilot's reaction to a message.

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, AUTOPILOT_VERSION_DATA, AttitudeTargetTypemask, COMMAND_ACK_DATA,
    COMMAND_INT_DATA, COMMAND_LONG_DATA, MISSION_ACK_DATA, MISSION_COUNT_DATA,
    MISSION_REQUEST_INT_DATA, MavCmd, MavMessage, MavMissionResult, MavMissionType, MavParamType,
    MavResult, PARAM_VALUE_DATA, PING_DATA, RC_CHANNELS_OVERRIDE_DATA, SET_ATTITUDE_TARGET_DATA,
    TERRAIN_REPORT_DATA, TIMESYNC_DATA,
};

use crate::commanded::HeadingTarget;
use crate::mission::{MissionItem, Upload};
use crate::mode::PlaneMode;
use crate::{Emulator, LONGEST_INTRUDER_LIST};

impl Emulator {
    /// Takes a message.
    pub fn receive(&mut self, header: &MavHeader, message: &MavMessage) {
        self.received += 1;
        if self.is_initialising() {
            return;
        }
        let from = (
            u8::try_from(header.system_id).unwrap_or(0),
            header.component_id,
        );
        let own = self.settings.system_id;
        let for_us = |system: u8, component: u8| (system == own || system == 0) && (component <= 1);
        match message {
            MavMessage::COMMAND_LONG(data) if for_us(data.target_system, data.target_component) => {
                let before = self.outbox.len();
                let result = self.command_long(data, from);
                self.answer(data.command, result, from, before);
            }
            MavMessage::COMMAND_INT(data) if for_us(data.target_system, data.target_component) => {
                let before = self.outbox.len();
                let result = self.command_int(data, from);
                self.answer(data.command, result, from, before);
            }
            MavMessage::SET_MODE(data) if data.target_system == own => {
                if let Some(mode) = PlaneMode::from_number(data.custom_mode)
                    && !self.refuse_commands
                {
                    self.change_mode(mode, from.1);
                }
            }
            MavMessage::SET_ATTITUDE_TARGET(data)
                if for_us(data.target_system, data.target_component) =>
            {
                self.attitude_target(data);
            }
            MavMessage::RC_CHANNELS_OVERRIDE(data) if data.target_system == own => {
                self.override_channels(data, from.0);
            }
            MavMessage::PING(data) if data.target_system == 0 => {
                self.outbox.push(MavMessage::PING(PING_DATA {
                    time_usec: data.time_usec,
                    seq: data.seq,
                    target_system: from.0,
                    target_component: from.1,
                }));
            }
            MavMessage::TIMESYNC(data) if data.tc1 == 0 => {
                self.outbox.push(MavMessage::TIMESYNC(TIMESYNC_DATA {
                    tc1: i64::from(self.boot_ms()) * 1_000_000,
                    ts1: data.ts1,
                    target_system: from.0,
                    target_component: from.1,
                }));
            }
            // It names no receiver: passed on to the other link, where a ground station may answer.
            MavMessage::TERRAIN_REQUEST(_) => self.second_outbox.push(message.clone()),
            MavMessage::TERRAIN_CHECK(data) => {
                let (card, now_s) = (&mut self.card, self.time_s);
                let is_on = self.parameters.value("TERRAIN_ENABLE") != 0.0;
                let card = card.as_mut().filter(|_| is_on);
                let report = card.map(|card| card.answer(data, now_s));
                // Without terrain of its own: a spacing of 0.
                let unknown = || TERRAIN_REPORT_DATA {
                    lat: data.lat,
                    lon: data.lon,
                    ..TERRAIN_REPORT_DATA::DEFAULT
                };
                let report = report.unwrap_or_else(unknown);
                self.outbox.push(MavMessage::TERRAIN_REPORT(report));
            }
            MavMessage::ADSB_VEHICLE(data) => self.hear_intruder(data),
            MavMessage::STATUSTEXT(data) => {
                if self.texts.len() < 1000 {
                    self.texts
                        .push(data.text.to_str().unwrap_or_default().to_owned());
                }
            }
            other => self.receive_transfer(other, from),
        }
    }

    /// Parameters, mission and fence.
    fn receive_transfer(&mut self, message: &MavMessage, from: (u8, u8)) {
        let own = self.settings.system_id;
        match message {
            MavMessage::PARAM_REQUEST_READ(data) if data.target_system == own => {
                let index = if data.param_index >= 0 {
                    usize::try_from(data.param_index).ok()
                } else {
                    let name = data.param_id.to_str().unwrap_or_default();
                    self.parameters.rows().iter().position(|row| row.0 == name)
                };
                self.send_parameter(index);
            }
            MavMessage::PARAM_REQUEST_LIST(data) if data.target_system == own => {
                for index in 0..self.parameters.rows().len() {
                    self.send_parameter(Some(index));
                }
            }
            MavMessage::PARAM_SET(data) if data.target_system == own => {
                let name = data.param_id.to_str().unwrap_or_default().to_owned();
                self.parameters.set(&name, f64::from(data.param_value));
                let index = self.parameters.rows().iter().position(|row| row.0 == name);
                self.send_parameter(index);
            }
            MavMessage::MISSION_REQUEST_LIST(data)
                if data.target_system == own && self.is_uploading(data.mission_type, from) =>
            {
                self.refuse_list(
                    data.mission_type,
                    MavMissionResult::MAV_MISSION_DENIED,
                    from,
                );
            }
            MavMessage::MISSION_REQUEST_INT(data)
                if data.target_system == own && self.is_uploading(data.mission_type, from) =>
            {
                self.refuse_list(
                    data.mission_type,
                    MavMissionResult::MAV_MISSION_DENIED,
                    from,
                );
            }
            MavMessage::MISSION_REQUEST_LIST(data) if data.target_system == own => {
                let count = self.items(data.mission_type).len();
                self.outbox
                    .push(MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
                        count: u16::try_from(count).unwrap_or(u16::MAX),
                        target_system: from.0,
                        target_component: from.1,
                        mission_type: data.mission_type,
                        opaque_id: 0,
                    }));
            }
            MavMessage::MISSION_REQUEST_INT(data) if data.target_system == own => {
                let item = self
                    .items(data.mission_type)
                    .get(usize::from(data.seq))
                    .copied();
                if let Some(item) = item {
                    let reply = item.message(data.seq, data.mission_type, from);
                    self.outbox.push(MavMessage::MISSION_ITEM_INT(reply));
                } else {
                    let result = MavMissionResult::MAV_MISSION_INVALID_SEQUENCE;
                    self.refuse_list(data.mission_type, result, from);
                }
            }
            MavMessage::MISSION_COUNT(data) if data.target_system == own => {
                self.upload = Some(Upload {
                    mission_type: data.mission_type,
                    count: data.count,
                    items: Vec::new(),
                    from,
                });
                self.continue_upload();
            }
            MavMessage::MISSION_ITEM_INT(data) if data.target_system == own => {
                if let Some(upload) = &mut self.upload
                    && usize::from(data.seq) == upload.items.len()
                    && data.mission_type == upload.mission_type
                {
                    upload.items.push(MissionItem::from_message(data));
                    self.continue_upload();
                }
            }
            MavMessage::MISSION_SET_CURRENT(data) if data.target_system == own => {
                self.set_current(data.seq);
                self.send_mission_current();
            }
            _ => {}
        }
    }

    /// Whether somebody else uploads a list: then nobody may read it.
    fn is_uploading(&self, mission_type: MavMissionType, from: (u8, u8)) -> bool {
        self.upload
            .as_ref()
            .is_some_and(|upload| upload.mission_type == mission_type && upload.from != from)
    }

    fn refuse_list(
        &mut self,
        mission_type: MavMissionType,
        result: MavMissionResult,
        (target_system, target_component): (u8, u8),
    ) {
        self.outbox.push(MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system,
            target_component,
            mavtype: result,
            mission_type,
            opaque_id: 0,
        }));
    }

    fn items(&self, mission_type: MavMissionType) -> &[MissionItem] {
        match mission_type {
            MavMissionType::MAV_MISSION_TYPE_MISSION => &self.mission,
            MavMissionType::MAV_MISSION_TYPE_FENCE => &self.fence,
            MavMissionType::MAV_MISSION_TYPE_RALLY => &self.rally,
            MavMissionType::MAV_MISSION_TYPE_ALL => &[],
        }
    }

    fn continue_upload(&mut self) {
        let Some(upload) = self.upload.take() else {
            return;
        };
        let (target_system, target_component) = upload.from;
        let mission_type = upload.mission_type;
        if upload.items.len() < usize::from(upload.count) {
            let seq = u16::try_from(upload.items.len()).unwrap_or(u16::MAX);
            self.upload = Some(upload);
            self.outbox
                .push(MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                    seq,
                    target_system,
                    target_component,
                    mission_type,
                }));
            return;
        }
        match mission_type {
            MavMissionType::MAV_MISSION_TYPE_FENCE => self.fence = upload.items,
            MavMissionType::MAV_MISSION_TYPE_RALLY => self.rally = upload.items,
            MavMissionType::MAV_MISSION_TYPE_MISSION => {
                self.set_mission(upload.items, 1);
                if self.mode == PlaneMode::Auto {
                    self.say_item();
                }
            }
            MavMissionType::MAV_MISSION_TYPE_ALL => {}
        }
        self.outbox.push(MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system,
            target_component,
            mavtype: MavMissionResult::MAV_MISSION_ACCEPTED,
            mission_type,
            opaque_id: 0,
        }));
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "parameters are floats on the wire"
    )]
    fn send_parameter(&mut self, index: Option<usize>) {
        let rows = self.parameters.rows();
        let Some((index, row)) = index.and_then(|index| Some((index, rows.get(index)?))) else {
            return;
        };
        self.outbox.push(MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: row.1 as f32,
            param_count: u16::try_from(rows.len()).unwrap_or(u16::MAX),
            param_index: u16::try_from(index).unwrap_or(u16::MAX),
            param_id: row.0.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        }));
    }

    /// Answers a command before what it made to be sent, as ArduPlane does: it only queues the heartbeat
    /// with a new mode.
    fn answer(&mut self, command: MavCmd, result: MavResult, to: (u8, u8), before: usize) {
        let made = self.outbox.split_off(before);
        self.acknowledge(command, result, to);
        self.outbox.extend(made);
    }

    fn acknowledge(&mut self, command: MavCmd, result: MavResult, to: (u8, u8)) {
        self.outbox.push(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
            command,
            result,
            progress: 0,
            result_param2: 0,
            target_system: to.0,
            target_component: to.1,
        }));
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers in float fields, as the protocol has it; casts saturate"
    )]
    fn command_long(&mut self, data: &COMMAND_LONG_DATA, from: (u8, u8)) -> MavResult {
        if self.refuse_commands {
            return MavResult::MAV_RESULT_DENIED;
        }
        match data.command {
            MavCmd::MAV_CMD_DO_SET_MODE => match PlaneMode::from_number(data.param2 as u32) {
                Some(mode) => {
                    self.change_mode(mode, from.1);
                    MavResult::MAV_RESULT_ACCEPTED
                }
                None => MavResult::MAV_RESULT_FAILED,
            },
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL => {
                let interval_s = match data.param2 {
                    interval if interval < 0.0 => None,
                    0.0 => Some(1.0),
                    interval => Some((f64::from(interval) * 1e-6).max(crate::STEP_S)),
                };
                if self
                    .streams
                    .set(data.param1 as u32, interval_s, self.time_s)
                {
                    MavResult::MAV_RESULT_ACCEPTED
                } else {
                    MavResult::MAV_RESULT_FAILED
                }
            }
            MavCmd::MAV_CMD_REQUEST_MESSAGE => {
                if data.param1 as u32 == 148 {
                    self.outbox
                        .push(MavMessage::AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA {
                            flight_sw_version: 0x0407_0000,
                            ..AUTOPILOT_VERSION_DATA::DEFAULT
                        }));
                    return MavResult::MAV_RESULT_ACCEPTED;
                }
                match self.state_message(data.param1 as u32) {
                    Some(message) => {
                        self.outbox.push(message);
                        MavResult::MAV_RESULT_ACCEPTED
                    }
                    None => MavResult::MAV_RESULT_FAILED,
                }
            }
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => {
                self.set_armed(data.param1 == 1.0);
                MavResult::MAV_RESULT_ACCEPTED
            }
            MavCmd::MAV_CMD_DO_CHANGE_SPEED => {
                self.set_airspeed(f64::from(data.param2));
                MavResult::MAV_RESULT_ACCEPTED
            }
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => {
                if self.set_current(data.param1 as u16) {
                    MavResult::MAV_RESULT_ACCEPTED
                } else {
                    MavResult::MAV_RESULT_FAILED
                }
            }
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    fn set_current(&mut self, item: u16) -> bool {
        if usize::from(item) >= self.mission.len() {
            return false;
        }
        if self.mode != PlaneMode::Auto {
            // As ArduPlane: the flown item is the present one; what comes before it runs when AUTO begins.
            let flown = self.flown_from(item);
            self.guidance.begin_item(flown, &self.plant, false);
            self.guidance.resume_at = (flown != item).then_some(item);
        } else if item != self.guidance.item {
            self.guidance.begin_item(item, &self.plant, false);
            self.skip_to_flown();
            self.say_item();
        }
        true
    }

    fn command_int(&mut self, data: &COMMAND_INT_DATA, from: (u8, u8)) -> MavResult {
        if self.refuse_commands {
            return MavResult::MAV_RESULT_DENIED;
        }
        match data.command {
            MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING if self.mode == PlaneMode::Guided => {
                if !(0.0..=360.0).contains(&data.param2) {
                    return MavResult::MAV_RESULT_DENIED;
                }
                self.guided.heading = Some(HeadingTarget {
                    heading_rad: f64::from(data.param2).to_radians(),
                    is_course: data.param1 == 0.0,
                    acceleration_mps2: f64::from(data.param3),
                });
                MavResult::MAV_RESULT_ACCEPTED
            }
            MavCmd::MAV_CMD_GUIDED_CHANGE_ALTITUDE if self.mode == PlaneMode::Guided => {
                // A rate other than 0 barely moves the aircraft.
                if data.param3 == 0.0 {
                    let altitude = f64::from(data.z);
                    self.guided.altitude_m = match data.frame {
                        mavlink::dialects::ardupilotmega::MavFrame::MAV_FRAME_GLOBAL => {
                            altitude - self.settings.home.altitude_m
                        }
                        _ => altitude,
                    };
                }
                MavResult::MAV_RESULT_ACCEPTED
            }
            MavCmd::MAV_CMD_DO_SET_HOME => {
                self.home_up_m = f64::from(data.z) - self.settings.home.altitude_m;
                MavResult::MAV_RESULT_ACCEPTED
            }
            MavCmd::MAV_CMD_DO_REPOSITION => {
                let change_mode = data.param2 == 1.0;
                if change_mode {
                    self.change_mode(PlaneMode::Guided, from.1);
                }
                if self.mode != PlaneMode::Guided {
                    return MavResult::MAV_RESULT_DENIED;
                }
                let item = MissionItem {
                    command: data.command,
                    frame: data.frame,
                    parameters: [0.0; 4],
                    latitude_e7: data.x,
                    longitude_e7: data.y,
                    altitude_m: data.z,
                };
                if let Some(position_m) = item.position_m(&self.settings.home) {
                    self.guided.point_m = position_m;
                    self.guided.altitude_m = position_m[2];
                    self.guided.heading = None;
                }
                MavResult::MAV_RESULT_ACCEPTED
            }
            MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING | MavCmd::MAV_CMD_GUIDED_CHANGE_ALTITUDE => {
                MavResult::MAV_RESULT_FAILED
            }
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    fn attitude_target(&mut self, data: &SET_ATTITUDE_TARGET_DATA) {
        if self.mode != PlaneMode::Guided {
            return;
        }
        let [w, x, y, z] = data.q.map(f64::from);
        let norm = libm::sqrt(w * w + x * x + y * y + z * z);
        if !norm.is_finite() || norm < 0.5 {
            return;
        }
        let (w, x, y, z) = (w / norm, x / norm, y / norm, z / norm);
        let roll = libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
        let pitch = libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0));
        // A cleared bit of a body rate selects that axis of the attitude; the cleared bit of the
        // attitude selects all axes.
        let ignores = |bit| data.type_mask.contains(bit);
        let all = !ignores(AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE);
        if all || !ignores(AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE) {
            self.guided.bank = Some((roll, self.time_s));
        }
        if all || !ignores(AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE)
        {
            self.guided.pitch = Some((pitch, self.time_s));
        }
    }

    fn override_channels(&mut self, data: &RC_CHANNELS_OVERRIDE_DATA, system_id: u8) {
        if f64::from(system_id) != self.parameters.value("MAV_GCS_SYSID") {
            return;
        }
        let values = [
            data.chan1_raw,
            data.chan2_raw,
            data.chan3_raw,
            data.chan4_raw,
            data.chan5_raw,
            data.chan6_raw,
            data.chan7_raw,
            data.chan8_raw,
        ];
        for (slot, value) in self.overrides.0.iter_mut().zip(values) {
            match value {
                u16::MAX => {}
                0 => *slot = None,
                value => *slot = Some((value, self.time_s)),
            }
        }
    }

    fn hear_intruder(&mut self, data: &ADSB_VEHICLE_DATA) {
        if self.parameters.value("ADSB_TYPE") <= 0.0 {
            return;
        }
        let entry = (data.ICAO_address, self.time_s, data.clone());
        if let Some(known) = self
            .intruders
            .iter_mut()
            .find(|known| known.0 == data.ICAO_address)
        {
            *known = entry;
        } else if self.intruders.len() < LONGEST_INTRUDER_LIST {
            self.intruders.push(entry);
        }
    }
}

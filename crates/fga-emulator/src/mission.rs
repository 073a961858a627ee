//! Mission and fence items, and their upload.

use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMissionType};

use crate::geometry::{Home, WirePlace};

/// An item of a mission or a fence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MissionItem {
    /// The command.
    pub command: MavCmd,
    /// The frame of the altitude.
    pub frame: MavFrame,
    /// Parameters 1 to 4.
    pub parameters: [f32; 4],
    /// Latitude, 1e-7 degrees.
    pub latitude_e7: i32,
    /// Longitude, 1e-7 degrees.
    pub longitude_e7: i32,
    /// Altitude, metres, in the frame.
    pub altitude_m: f32,
}

impl MissionItem {
    /// A waypoint at a local position, with its altitude above home.
    #[expect(clippy::cast_possible_truncation, reason = "altitudes fit")]
    pub fn waypoint(home: &Home, position_m: [f64; 3]) -> Self {
        let place = home.to_place(position_m);
        Self {
            command: MavCmd::MAV_CMD_NAV_WAYPOINT,
            frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
            parameters: [0.0; 4],
            latitude_e7: place.latitude_e7,
            longitude_e7: place.longitude_e7,
            altitude_m: position_m[2] as f32,
        }
    }

    /// The target of a navigation item, metres, local frame; `None` for an item without a place.
    pub fn position_m(&self, home: &Home) -> Option<[f64; 3]> {
        if self.latitude_e7 == 0 && self.longitude_e7 == 0 {
            return None;
        }
        let place = WirePlace {
            latitude_e7: self.latitude_e7,
            longitude_e7: self.longitude_e7,
            altitude_mm: 0,
        };
        let [x, y, _] = home.to_local_m(place);
        let altitude = f64::from(self.altitude_m);
        let z = match self.frame {
            MavFrame::MAV_FRAME_GLOBAL | MavFrame::MAV_FRAME_GLOBAL_INT => {
                altitude - home.altitude_m
            }
            _ => altitude,
        };
        Some([x, y, z])
    }

    /// Whether the aircraft flies to it; a plane flies no splines.
    pub fn is_waypoint(&self) -> bool {
        matches!(
            self.command,
            MavCmd::MAV_CMD_NAV_WAYPOINT
                | MavCmd::MAV_CMD_NAV_LOITER_UNLIM
                | MavCmd::MAV_CMD_NAV_LOITER_TIME
                | MavCmd::MAV_CMD_NAV_LOITER_TURNS
                | MavCmd::MAV_CMD_NAV_LOITER_TO_ALT
                | MavCmd::MAV_CMD_NAV_LAND
                | MavCmd::MAV_CMD_NAV_TAKEOFF
                | MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF
                | MavCmd::MAV_CMD_NAV_VTOL_LAND
                | MavCmd::MAV_CMD_NAV_PAYLOAD_PLACE
        )
    }

    /// Its message.
    pub fn message(
        &self,
        sequence: u16,
        mission_type: MavMissionType,
        target: (u8, u8),
    ) -> MISSION_ITEM_INT_DATA {
        MISSION_ITEM_INT_DATA {
            param1: self.parameters[0],
            param2: self.parameters[1],
            param3: self.parameters[2],
            param4: self.parameters[3],
            x: self.latitude_e7,
            y: self.longitude_e7,
            z: self.altitude_m,
            seq: sequence,
            command: self.command,
            target_system: target.0,
            target_component: target.1,
            frame: self.frame,
            current: 0,
            autocontinue: 1,
            mission_type,
        }
    }

    pub(crate) fn from_message(data: &MISSION_ITEM_INT_DATA) -> Self {
        Self {
            command: data.command,
            frame: data.frame,
            parameters: [data.param1, data.param2, data.param3, data.param4],
            latitude_e7: data.x,
            longitude_e7: data.y,
            altitude_m: data.z,
        }
    }
}

/// An upload in progress.
#[derive(Debug)]
pub(crate) struct Upload {
    pub(crate) mission_type: MavMissionType,
    pub(crate) count: u16,
    pub(crate) items: Vec<MissionItem>,
    pub(crate) from: (u8, u8),
}

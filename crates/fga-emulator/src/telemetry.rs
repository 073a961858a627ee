//! The messages that the autopilot sends unasked.

use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, ATTITUDE_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, GpsFixType,
    HEARTBEAT_DATA, MISSION_CURRENT_DATA, MISSION_ITEM_REACHED_DATA, MavAutopilot, MavMessage,
    MavModeFlag, MavSeverity, MavState, MavSysStatusSensor, MavType, NAV_CONTROLLER_OUTPUT_DATA,
    POSITION_TARGET_GLOBAL_INT_DATA, SCALED_PRESSURE_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA,
    SYSTEM_TIME_DATA, VFR_HUD_DATA, WIND_DATA,
};

use crate::geometry::{bearing, distance_m};
use crate::streams::{
    ADSB_VEHICLE, ATTITUDE, GLOBAL_POSITION_INT, GPS_RAW_INT, HEARTBEAT, INITIALISING,
    MISSION_CURRENT, NAV_CONTROLLER_OUTPUT, POSITION_TARGET_GLOBAL_INT, SCALED_PRESSURE,
    SYS_STATUS, SYSTEM_TIME, VFR_HUD, WIND,
};
use crate::{Emulator, PlaneMode, WirePlace};

impl Emulator {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "milliseconds since boot run over after 49 days, as the autopilot's do"
    )]
    pub(crate) fn boot_ms(&self) -> u32 {
        (self.time_s * 1e3).round() as u64 as u32
    }

    pub(crate) fn send_heartbeat(&mut self) {
        let armed = if self.armed {
            MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED
        } else {
            MavModeFlag::empty()
        };
        self.outbox.push(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: if self.is_initialising() {
                INITIALISING
            } else {
                self.mode.number()
            },
            mavtype: MavType::MAV_TYPE_FIXED_WING,
            autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            base_mode: MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | armed,
            system_status: if self.armed {
                MavState::MAV_STATE_ACTIVE
            } else {
                MavState::MAV_STATE_STANDBY
            },
            mavlink_version: 3,
        }));
    }

    pub(crate) fn send_reached(&mut self, item: u16) {
        self.outbox.push(MavMessage::MISSION_ITEM_REACHED(
            MISSION_ITEM_REACHED_DATA { seq: item },
        ));
    }

    /// A text for every ground station.
    pub(crate) fn send_text(&mut self, words: &str) {
        self.outbox.push(MavMessage::STATUSTEXT(STATUSTEXT_DATA {
            severity: MavSeverity::MAV_SEVERITY_INFO,
            text: words.into(),
            ..STATUSTEXT_DATA::DEFAULT
        }));
    }

    /// The target of its mode, metres, local frame.
    fn target_m(&self) -> [f64; 3] {
        if self.mode != PlaneMode::Auto {
            return self.guided.point_m;
        }
        self.item_place_m(self.guidance.item)
            .unwrap_or(self.guided.point_m)
    }

    pub(crate) fn send_mission_current(&mut self) {
        self.outbox
            .push(MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
                seq: self.guidance.item,
                total: u16::try_from(self.mission.len()).unwrap_or(u16::MAX),
                ..MISSION_CURRENT_DATA::DEFAULT
            }));
    }

    pub(crate) fn send_telemetry(&mut self) {
        let fastest_s = self.settings.fastest_interval_s;
        for message_id in self.streams.due(self.time_s, fastest_s) {
            if self.is_initialising() && message_id != HEARTBEAT {
                continue;
            }
            match message_id {
                HEARTBEAT => self.send_heartbeat(),
                MISSION_CURRENT => self.send_mission_current(),
                ADSB_VEHICLE => {
                    let list: Vec<ADSB_VEHICLE_DATA> = self
                        .intruders
                        .iter()
                        .map(|intruder| intruder.2.clone())
                        .collect();
                    self.outbox
                        .extend(list.into_iter().map(MavMessage::ADSB_VEHICLE));
                }
                other => {
                    if let Some(message) = self.state_message(other) {
                        self.outbox.push(message);
                    }
                }
            }
        }
    }

    /// The position that the autopilot reports: without a fix it dead-reckons from latitude and
    /// longitude 0.
    #[expect(clippy::cast_possible_truncation, reason = "small numbers")]
    fn place(&self) -> WirePlace {
        if self.time_s < self.settings.fix_s {
            return WirePlace {
                latitude_e7: 1000 + (50.0 * self.time_s) as i32,
                longitude_e7: -224,
                altitude_mm: 90,
            };
        }
        self.settings.home.to_place(self.plant.position_m())
    }

    /// Static pressure at the aircraft, hectopascals: the standard atmosphere over the pressure at
    /// sea level.
    fn pressure_hpa(&self) -> Option<f64> {
        let altitude_m = self.plant.position_m()[2] + self.settings.home.altitude_m;
        let kelvin = 288.15 - 0.0065 * altitude_m;
        Some(self.settings.sea_level_hpa? * libm::pow(kelvin / 288.15, 5.255_88))
    }

    /// Whether the fence is enabled: one that only reports has no status.
    fn status(&self) -> MavMessage {
        let fence = MavSysStatusSensor::MAV_SYS_STATUS_GEOFENCE;
        let acts = self.parameters.value("FENCE_ACTION") != 0.0;
        let enabled = acts && self.parameters.value("FENCE_ENABLE") != 0.0;
        MavMessage::SYS_STATUS(SYS_STATUS_DATA {
            onboard_control_sensors_present: fence,
            onboard_control_sensors_enabled: if enabled {
                fence
            } else {
                MavSysStatusSensor::empty()
            },
            ..SYS_STATUS_DATA::DEFAULT
        })
    }

    /// The message for a part of the state.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the wire's own units; casts of floats saturate"
    )]
    pub(crate) fn state_message(&self, message_id: u32) -> Option<MavMessage> {
        let time_boot_ms = self.boot_ms();
        // Disarmed, it stands.
        let (velocity, airspeed_mps) = if self.armed {
            (self.plant.velocity_mps(), self.plant.airspeed_mps())
        } else {
            ([0.0; 3], 0.0)
        };
        let degrees = self.plant.heading_rad().to_degrees().rem_euclid(360.0);
        Some(match message_id {
            SYS_STATUS => self.status(),
            SYSTEM_TIME => MavMessage::SYSTEM_TIME(SYSTEM_TIME_DATA {
                time_unix_usec: 1_700_000_000_000_000 + (self.time_s * 1e6) as u64,
                time_boot_ms,
            }),
            ATTITUDE => MavMessage::ATTITUDE(ATTITUDE_DATA {
                time_boot_ms,
                roll: self.plant.bank_rad() as f32,
                pitch: self.plant.pitch_rad() as f32,
                yaw: self.plant.heading_rad() as f32,
                rollspeed: self.plant.roll_rate_radps() as f32,
                // A level turn: the nose's rate about the vertical, in the axes of the banked body.
                pitchspeed: (self.plant.nose_rate_radps() * libm::sin(self.plant.bank_rad()))
                    as f32,
                yawspeed: (self.plant.nose_rate_radps() * libm::cos(self.plant.bank_rad())) as f32,
            }),
            GPS_RAW_INT => {
                let fixed = self.time_s >= self.settings.fix_s;
                let place = self.place();
                MavMessage::GPS_RAW_INT(GPS_RAW_INT_DATA {
                    time_usec: (self.time_s * 1e6) as u64,
                    lat: if fixed { place.latitude_e7 } else { 0 },
                    lon: if fixed { place.longitude_e7 } else { 0 },
                    alt: if fixed { place.altitude_mm } else { 0 },
                    fix_type: if fixed {
                        GpsFixType::GPS_FIX_TYPE_3D_FIX
                    } else {
                        GpsFixType::GPS_FIX_TYPE_NO_FIX
                    },
                    ..GPS_RAW_INT_DATA::DEFAULT
                })
            }
            GLOBAL_POSITION_INT => {
                let place = self.place();
                MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
                    time_boot_ms,
                    lat: place.latitude_e7,
                    lon: place.longitude_e7,
                    alt: place.altitude_mm,
                    relative_alt: ((self.plant.position_m()[2] - self.home_up_m) * 1e3).round()
                        as i32,
                    vx: (velocity[1] * 100.0).round() as i16,
                    vy: (velocity[0] * 100.0).round() as i16,
                    vz: (-velocity[2] * 100.0).round() as i16,
                    hdg: (degrees * 100.0) as u16,
                })
            }
            SCALED_PRESSURE => MavMessage::SCALED_PRESSURE(SCALED_PRESSURE_DATA {
                time_boot_ms,
                press_abs: self.pressure_hpa()? as f32,
                ..SCALED_PRESSURE_DATA::DEFAULT
            }),
            NAV_CONTROLLER_OUTPUT => {
                let to_m = self.target_m();
                let here_m = self.plant.position_m();
                let bearing_deg = bearing(here_m, to_m).to_degrees();
                MavMessage::NAV_CONTROLLER_OUTPUT(NAV_CONTROLLER_OUTPUT_DATA {
                    nav_roll: self.plant.commanded_bank_rad().to_degrees() as f32,
                    target_bearing: bearing_deg.round() as i16,
                    wp_dist: distance_m(here_m, to_m) as u16,
                    ..NAV_CONTROLLER_OUTPUT_DATA::DEFAULT
                })
            }
            POSITION_TARGET_GLOBAL_INT => {
                let place = self.settings.home.to_place(self.target_m());
                MavMessage::POSITION_TARGET_GLOBAL_INT(POSITION_TARGET_GLOBAL_INT_DATA {
                    time_boot_ms,
                    lat_int: place.latitude_e7,
                    lon_int: place.longitude_e7,
                    alt: place.altitude_mm as f32 * 1e-3,
                    ..POSITION_TARGET_GLOBAL_INT_DATA::DEFAULT
                })
            }
            VFR_HUD => MavMessage::VFR_HUD(VFR_HUD_DATA {
                airspeed: airspeed_mps as f32,
                groundspeed: libm::hypot(velocity[0], velocity[1]) as f32,
                alt: (self.plant.position_m()[2] + self.settings.home.altitude_m) as f32,
                climb: velocity[2] as f32,
                heading: degrees as i16,
                throttle: 50,
            }),
            WIND => {
                let [east, north] = self.plant.wind_mps();
                MavMessage::WIND(WIND_DATA {
                    // The direction from which the wind blows.
                    direction: libm::atan2(-east, -north).to_degrees() as f32,
                    speed: libm::hypot(east, north) as f32,
                    speed_z: 0.0,
                })
            }
            _ => return None,
        })
    }
}

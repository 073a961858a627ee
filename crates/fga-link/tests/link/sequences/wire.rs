//! The network of a sequence, both ways.

use crate::common::beat::heartbeat;
use fga_link::authority::Beat;
use fga_link::mode::{Mode as LinkMode, ModeChange};
use fga_link::wire::encode;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbFlags, MavCmd, MavMessage, MavModeFlag,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader};

use super::plan::{Fault, PILOTS};
use super::{Packet, Rig};

impl Rig {
    pub(super) fn forge(&mut self, sequence: u8, mode: u32, armed: bool) {
        self.to_companion.push_back(Packet {
            due_s: self.time_s,
            // Not the vehicle's: it shows nothing of the pilot.
            sent_s: f64::NEG_INFINITY,
            header: MavHeader {
                system_id: 1,
                component_id: 1,
                sequence,
            },
            message: heartbeat(mode, armed),
            signed: None,
        });
    }

    /// Sends the messages of the vehicle and the receiver on their way.
    pub(super) fn telemetry(&mut self) {
        let lost = [Fault::Deaf, Fault::Cut, Fault::Version1]
            .into_iter()
            .any(|fault| self.is_on(fault));
        let delay_s = if self.is_on(Fault::Late) { 1.5 } else { 0.02 };
        for mut message in self.emulator.drain() {
            if let MavMessage::VFR_HUD(data) = &mut message
                && self.is_on(Fault::Pitot)
            {
                data.airspeed = 0.0;
            }
            let sequence = self.sequences[0];
            self.sequences[0] = sequence.wrapping_add(1);
            let is_beat = matches!(message, MavMessage::HEARTBEAT(_));
            if lost || (self.is_on(Fault::Telemetry) && !is_beat) {
                continue;
            }
            let header = MavHeader {
                system_id: 1,
                component_id: 1,
                sequence,
            };
            self.to_companion.push_back(Packet {
                due_s: self.time_s + delay_s,
                sent_s: self.time_s,
                signed: self.signed(false, header, &message),
                header,
                message,
            });
        }
        let own_m = self.emulator.plant().position_m();
        let range_m = (self.intruder_m[1] - own_m[1]).hypot(self.intruder_m[0] - own_m[0]);
        if range_m < 900.0 && self.time_s >= self.report_s {
            self.report_s = self.time_s + self.trial.report_every_s;
            self.judge.reported_s = self.time_s;
            let place = self.emulator.home().to_place(self.intruder_m);
            let message = MavMessage::ADSB_VEHICLE(ADSB_VEHICLE_DATA {
                ICAO_address: 0xAB_CDEF,
                lat: place.latitude_e7,
                lon: place.longitude_e7,
                altitude: place.altitude_mm,
                heading: 18_000,
                hor_velocity: 2500,
                flags: AdsbFlags::ADSB_FLAGS_VALID_COORDS
                    | AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE
                    | AdsbFlags::ADSB_FLAGS_VALID_HEADING
                    | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY,
                altitude_type: AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC,
                callsign: "TEST".into(),
                ..ADSB_VEHICLE_DATA::DEFAULT
            });
            let header = MavHeader {
                system_id: 200,
                component_id: 156,
                sequence: 0,
            };
            self.to_companion.push_back(Packet {
                due_s: self.time_s + 0.02,
                sent_s: self.time_s,
                signed: self.signed(false, header, &message),
                header,
                message,
            });
        }
    }

    /// The reading thread.
    pub(super) fn read(&mut self) {
        // Delays that shrink again deliver in order, as a stream does.
        while self
            .to_companion
            .front()
            .is_some_and(|p| p.due_s <= self.time_s)
        {
            let Some(packet) = self.to_companion.pop_front() else {
                break;
            };
            if !self.believes(false, &packet) {
                continue;
            }
            let header = packet.header;
            match &packet.message {
                MavMessage::HEARTBEAT(data) if header.system_id == 1 => {
                    let beat = Beat {
                        sequence: header.sequence,
                        mode: LinkMode(data.custom_mode),
                        armed: data
                            .base_mode
                            .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED),
                    };
                    self.hearing.hear(beat, self.time_s);
                    if let Some((mode, chosen_s)) = self.judge.pilot
                        && packet.sent_s >= chosen_s
                        && data.custom_mode == mode.number()
                    {
                        self.judge.known_s.get_or_insert(self.time_s);
                    }
                }
                MavMessage::ATTITUDE(data) => {
                    self.hearing.stamp(data.time_boot_ms, self.time_s);
                    self.judge.telemetry_s = self.time_s;
                }
                _ => {}
            }
            self.inbox.push_back(packet);
        }
    }

    /// The writing thread: checks at the last moment what leaves a mode.
    pub(super) fn send(&mut self, change: Option<ModeChange>, message: MavMessage) {
        if change.is_some_and(|change| !self.hearing.ask(change, self.time_s)) {
            return;
        }
        if self.is_on(Fault::Mute) || self.is_on(Fault::Cut) {
            return;
        }
        let delay_s = 0.01 + self.random.uniform(0.0, 0.02) + self.queue_s();
        let due_s = self
            .to_vehicle
            .back()
            .map_or(0.0, |packet| packet.due_s)
            .max(self.time_s + delay_s);
        let header = MavHeader {
            system_id: 1,
            component_id: 196,
            sequence: 0,
        };
        self.to_vehicle.push_back(Packet {
            due_s,
            sent_s: self.time_s,
            signed: self.signed(true, header, &message),
            header,
            message,
        });
    }

    /// Delay by a queue on the way to the vehicle, seconds.
    fn queue_s(&self) -> f64 {
        let time_s = self.time_s;
        let queues = self.planned.iter().map(|row| match row.fault {
            Fault::Queue(queue_s) if time_s >= row.begin_s && time_s < row.end_s => queue_s,
            _ => 0.0,
        });
        queues.fold(0.0, f64::max)
    }

    /// The bytes of a message on a signed link.
    fn signed(
        &self,
        to_vehicle: bool,
        header: MavHeader,
        message: &MavMessage,
    ) -> Option<MAVLinkV2MessageRaw> {
        let [vehicle, program] = self.signing.as_ref()?;
        let signer = if to_vehicle { program } else { vehicle };
        Some(encode(header, message, Some(signer)))
    }

    /// Whether the receiver of a packet believes its signature.
    fn believes(&self, by_vehicle: bool, packet: &Packet) -> bool {
        self.signing.as_ref().is_none_or(|[vehicle, program]| {
            let receiver = if by_vehicle { vehicle } else { program };
            let signed = packet.signed.as_ref();
            signed.is_some_and(|raw| receiver.accepts(raw))
        })
    }

    /// A packet reaches the vehicle.
    pub(super) fn arrive(&mut self, packet: &Packet) {
        if !self.believes(true, packet) {
            return;
        }
        if let MavMessage::COMMAND_LONG(data) = &packet.message
            && data.command == MavCmd::MAV_CMD_DO_SET_MODE
        {
            let mode = self.emulator.mode();
            let by_pilot = self
                .emulator
                .mode_changes()
                .last()
                .is_some_and(|change| change.component_id == 0);
            self.say(&format!("mode {} asked for in {mode:?}", data.param2));
            let knew = self.judge.known_s.is_some_and(|s| packet.sent_s > s);
            if by_pilot && knew && PILOTS.contains(&mode) {
                self.fail(format!(
                    "a mode was commanded in {mode:?}, which the pilot chose and it had heard"
                ));
            }
        }
        self.emulator.receive(&packet.header, &packet.message);
    }
}

//! The steps of a flight in its telemetry log: with them a replay repeats the flight.
//!
//! A telemetry log holds what came and went, but not when the program looked at it, nor what receivers beside the link gave it. So the log
//! has a message of its own for each step, `ENCAPSULATED_DATA` from the companion's component, which is never sent. The time of its
//! frame is the time of the step on the flight's clock; that clock has whole microseconds, as the log has.

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use fga_formats::tally::Tally;
use mavlink::dialects::ardupilotmega::{ENCAPSULATED_DATA_DATA, MavMessage};

use crate::traffic::receiver::FeedStatus;
use crate::traffic::report::Quality;
use crate::traffic::{AltitudeReference, PlaceReport, ReportSender, ReportSource};

/// Bytes that one message holds.
const MOST_BYTES: usize = 253;
const SOURCES: [ReportSource; 4] = [
    ReportSource::Sbs,
    ReportSource::Beast,
    ReportSource::Gdl90,
    ReportSource::Flarm,
];
const ALTITUDES: [AltitudeReference; 5] = [
    AltitudeReference::MeanSeaLevel,
    AltitudeReference::Ellipsoid,
    AltitudeReference::Pressure,
    AltitudeReference::Geometric,
    AltitudeReference::Unknown,
];

/// A step of the program that flies.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// The flight's clock begins: which configuration is flown ([`fingerprint`]), and whether it only reports.
    Begin {
        /// The configuration.
        configuration: u64,
        /// Whether the program only reports.
        dry_run: bool,
    },
    /// The time advances.
    Tick,
    /// A receiver reported an aircraft. The message with the same content follows, for other readers of the log.
    Report(PlaceReport),
    /// What a receiver has given so far.
    Feed(FeedStatus),
    /// The ground that was asked for is made.
    Ground,
    /// The program is to end; at once, or when nothing threatens.
    End {
        /// Whether at once.
        at_once: bool,
    },
}

/// A number that differs between configurations (FNV-1a of all their values).
pub fn fingerprint(config: &crate::Config) -> u64 {
    let text = format!("{config:?}");
    text.bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    })
}

impl Step {
    /// The message for the log; `None` where it does not fit.
    pub fn message(&self) -> Option<MavMessage> {
        let mut bytes = Vec::new();
        let seqnr = match self {
            Self::Begin {
                configuration,
                dry_run,
            } => {
                bytes.extend(configuration.to_le_bytes());
                bytes.push(u8::from(*dry_run));
                0
            }
            Self::Tick => 1,
            Self::Report(report) => {
                put_report(report, &mut bytes)?;
                2
            }
            Self::Feed(status) => {
                put_sender(status.sender, &mut bytes)?;
                bytes.push(u8::from(status.was_connected));
                bytes.extend(status.positions.to_le_bytes());
                put_text(&serde_json::to_string(&status.tally).ok()?, &mut bytes)?;
                3
            }
            Self::Ground => 4,
            Self::End { at_once } => {
                bytes.push(u8::from(*at_once));
                5
            }
        };
        let mut data = [0; MOST_BYTES];
        data.get_mut(..bytes.len())?.copy_from_slice(&bytes);
        Some(MavMessage::ENCAPSULATED_DATA(ENCAPSULATED_DATA_DATA {
            seqnr,
            data,
        }))
    }

    /// The step in a message of the log.
    pub fn of_message(message: &MavMessage) -> Option<Self> {
        let MavMessage::ENCAPSULATED_DATA(message) = message else {
            return None;
        };
        let from = &mut message.data.as_slice();
        Some(match message.seqnr {
            0 => Self::Begin {
                configuration: u64::from_le_bytes(take(from)?),
                dry_run: take_flag(from)?,
            },
            1 => Self::Tick,
            2 => Self::Report(take_report(from)?),
            3 => Self::Feed(FeedStatus {
                sender: take_sender(from)?,
                was_connected: take_flag(from)?,
                positions: u64::from_le_bytes(take(from)?),
                tally: serde_json::from_str::<Tally>(&take_text(from)?).ok()?,
            }),
            4 => Self::Ground,
            5 => Self::End {
                at_once: take_flag(from)?,
            },
            _ => return None,
        })
    }
}

fn index_in<T: PartialEq>(all: &[T], one: &T) -> Option<u8> {
    u8::try_from(all.iter().position(|other| other == one)?).ok()
}

fn put_text(text: &str, to: &mut Vec<u8>) -> Option<()> {
    to.push(u8::try_from(text.len()).ok()?);
    to.extend(text.bytes());
    Some(())
}

fn put_sender(sender: ReportSender, to: &mut Vec<u8>) -> Option<()> {
    to.push(index_in(&SOURCES, &sender.source)?);
    to.extend(sender.number.to_le_bytes());
    Some(())
}

/// A report of a receiver beside the link: its identity, movement and class follow from the rest.
fn put_report(report: &PlaceReport, to: &mut Vec<u8>) -> Option<()> {
    let quality = &report.quality;
    put_sender(report.sender, to)?;
    to.extend(report.icao.to_le_bytes());
    put_text(&report.callsign, to)?;
    let place = report.place;
    let velocity_mps = report.velocity_mps.unwrap_or(Vec3::ZERO);
    let numbers = [
        place.latitude_deg,
        place.longitude_deg,
        place.altitude_m,
        velocity_mps.x,
        velocity_mps.y,
        velocity_mps.z,
        report.valid_s,
        quality.position_m,
        quality.velocity_mps,
        quality.height_m,
    ];
    to.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    let flags = [
        report.velocity_mps.is_some(),
        quality.velocity_sigma_is_known,
        quality.climb_is_known,
    ];
    to.extend(flags.map(u8::from));
    to.push(index_in(&ALTITUDES, &quality.altitude)?);
    Some(())
}

fn take<const N: usize>(from: &mut &[u8]) -> Option<[u8; N]> {
    let (bytes, rest) = from.split_first_chunk()?;
    *from = rest;
    Some(*bytes)
}

fn take_flag(from: &mut &[u8]) -> Option<bool> {
    take::<1>(from).map(|[flag]| flag != 0)
}

fn take_one<T: Copy>(all: &[T], from: &mut &[u8]) -> Option<T> {
    let [index] = take(from)?;
    all.get(usize::from(index)).copied()
}

fn take_text(from: &mut &[u8]) -> Option<String> {
    let [length] = take(from)?;
    let (text, rest) = from.split_at_checked(usize::from(length))?;
    *from = rest;
    core::str::from_utf8(text).ok().map(str::to_owned)
}

fn take_sender(from: &mut &[u8]) -> Option<ReportSender> {
    Some(ReportSender {
        source: take_one(&SOURCES, from)?,
        number: u16::from_le_bytes(take(from)?),
    })
}

fn take_report(from: &mut &[u8]) -> Option<PlaceReport> {
    let sender = take_sender(from)?;
    let icao = u32::from_le_bytes(take(from)?);
    let callsign = take_text(from)?;
    let mut numbers = [0.0; 10];
    for number in &mut numbers {
        *number = f64::from_le_bytes(take(from)?);
    }
    let [
        latitude_deg,
        longitude_deg,
        altitude_m,
        east_mps,
        north_mps,
        up_mps,
        valid_s,
        position_m,
        sigma_mps,
        height_m,
    ] = numbers;
    let has_velocity = take_flag(from)?;
    let place = Geodetic {
        latitude_deg,
        longitude_deg,
        altitude_m,
    };
    let quality = Quality {
        position_m,
        velocity_mps: sigma_mps,
        velocity_sigma_is_known: take_flag(from)?,
        climb_is_known: take_flag(from)?,
        height_m,
        altitude: take_one(&ALTITUDES, from)?,
    };
    Some(PlaceReport {
        icao,
        callsign,
        velocity_mps: has_velocity.then(|| Vec3::new(east_mps, north_mps, up_mps)),
        ..PlaceReport::of_position(sender, place, valid_s, quality)
    })
}

#[cfg(test)]
mod tests {
    use fga_formats::tally::LeftOut;

    use super::*;

    #[test]
    fn each_step_comes_back_from_the_log_to_the_bit() {
        let sender = ReportSender::receiver(ReportSource::Beast, "localhost:30005");
        let place = Geodetic::new(47.1, 8.3 / 7.0, 1e3 / 3.0).unwrap();
        let quality = Quality {
            velocity_sigma_is_known: true,
            ..Quality::of_position(0.1, AltitudeReference::Geometric)
        };
        let report = PlaceReport {
            icao: 0x00AB_CDEF,
            callsign: "SWR12".to_owned(),
            velocity_mps: Some(Vec3::new(0.1, -1.0 / 3.0, 0.0)),
            ..PlaceReport::of_position(sender, place, 12.345_678, quality)
        };
        let mut tally = Tally::all_used(70_000);
        LeftOut::all()
            .take(9)
            .for_each(|reason| tally.leave_out(reason));
        let feed = FeedStatus {
            sender,
            was_connected: true,
            tally,
            positions: 7,
        };
        for step in [
            Step::Begin {
                configuration: fingerprint(&crate::Config::default()),
                dry_run: true,
            },
            Step::Tick,
            Step::Report(PlaceReport {
                velocity_mps: None,
                ..report.clone()
            }),
            Step::Report(report),
            Step::Feed(feed),
            Step::Ground,
            Step::End { at_once: false },
        ] {
            let message = step.message().expect("it fits");
            assert_eq!(Step::of_message(&message), Some(step));
        }
    }
}

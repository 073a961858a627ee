//! Receivers of ADS-B on the network: BaseStation and Beast over TCP.

use core::str::FromStr;
use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
#[cfg(feature = "beast")]
use fga_formats::traffic::beast;
use fga_formats::traffic::{Altitude, Generations, TrafficReport, sbs};

use super::report::{AltitudeReference, Quality, Report, Sender, Source};
use crate::endpoint::{Endpoint, Received, open};

/// A receiver: `sbs:HOST:PORT` or `beast:HOST:PORT`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReceiverEndpoint {
    /// Which wire it speaks.
    pub source: Source,
    /// Host and port.
    pub address: String,
}

/// A text that names no receiver.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no receiver, expected sbs:HOST:PORT, or beast:HOST:PORT where the program was built with it"
)]
pub struct ReceiverError(String);

impl FromStr for ReceiverEndpoint {
    type Err = ReceiverError;

    fn from_str(text: &str) -> Result<Self, ReceiverError> {
        let error = || ReceiverError(text.to_owned());
        let (kind, address) = text.split_once(':').ok_or_else(error)?;
        let source = match kind {
            "sbs" => Source::Sbs,
            "beast" if cfg!(feature = "beast") => Source::Beast,
            _ => return Err(error()),
        };
        let (host, port) = address.rsplit_once(':').ok_or_else(error)?;
        if host.is_empty() || port.parse::<u16>().is_err() {
            return Err(error());
        }
        Ok(Self {
            source,
            address: address.to_owned(),
        })
    }
}

/// A receiver without a word for this long is connected to again: the air may be empty.
const SILENT: Duration = Duration::from_mins(1);
/// Aircraft whose messages are joined; those not heard for longest make room.
const MOST_AIRCRAFT: usize = 32_768;
/// An altitude or a velocity is used with positions for so long, seconds.
const PART_LIFETIME_S: f64 = 15.0;
/// σ of a position without quality figures, metres.
const UNKNOWN_SIGMA_M: f64 = 15.0;
/// A radius of containment holds the position with near certainty: four σ and more.
const SIGMAS_IN_CONTAINMENT: f64 = 4.0;

/// What is known of one aircraft between its messages.
#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    altitude: Option<(Altitude, f64)>,
    velocity_mps: Option<([f64; 2], f64)>,
    climb_mps: f64,
    callsign: Option<fga_formats::traffic::Callsign>,
    sigma_m: Option<f64>,
    on_ground: bool,
}

/// Joins messages that each hold a part (position, velocity, call sign) to whole reports.
#[derive(Debug)]
pub struct Joiner {
    sender: Sender,
    aircraft: Generations<Parts>,
}

impl Joiner {
    /// Nothing heard yet.
    pub fn new(source: Source) -> Self {
        Self::of(Sender { source, number: 0 })
    }

    /// The same for one of several receivers.
    pub fn of(sender: Sender) -> Self {
        Self {
            sender,
            aircraft: Generations::new(MOST_AIRCRAFT),
        }
    }

    /// Aircraft held in memory.
    pub fn aircraft(&self) -> usize {
        self.aircraft.len()
    }

    /// Takes a message; gives a report where it held a position and the altitude is known.
    pub fn take(&mut self, message: &TrafficReport, now_s: f64) -> Option<Report> {
        let parts = self.aircraft.entry(message.address);
        if let Some(altitude) = message.altitude {
            parts.altitude = Some((altitude, now_s));
        }
        if let Some(velocity) = message.ground_velocity_mps() {
            parts.velocity_mps = Some((velocity, now_s));
        }
        if let Some(climb_mps) = message.climb_mps {
            parts.climb_mps = climb_mps;
        }
        if let Some(containment_m) = message.containment_m {
            parts.sigma_m = Some(containment_m / SIGMAS_IN_CONTAINMENT);
        }
        parts.callsign = message.callsign.or(parts.callsign);
        parts.on_ground = message.on_ground.unwrap_or(parts.on_ground);
        if parts.on_ground {
            return None;
        }
        let [latitude_deg, longitude_deg] = message.place_deg?;
        let (altitude, _) = parts
            .altitude
            .filter(|(_, heard_s)| now_s - heard_s < PART_LIFETIME_S)?;
        let velocity = parts
            .velocity_mps
            .filter(|(_, heard_s)| now_s - heard_s < PART_LIFETIME_S)
            .map(|([east, north], _)| Vec3::new(east, north, parts.climb_mps));
        Some(Report {
            source: self.sender.source,
            sender: self.sender,
            icao: message.address,
            callsign: parts.callsign.map_or_else(String::new, |callsign| {
                super::report::tidy_callsign(callsign.as_str())
            }),
            place: Geodetic::new(latitude_deg, longitude_deg, altitude.metres())?,
            velocity_mps: velocity,
            valid_s: now_s,
            quality: Quality {
                position_m: parts.sigma_m.unwrap_or(UNKNOWN_SIGMA_M),
                velocity_mps: 0.0,
                altitude: match altitude {
                    Altitude::Pressure(_) => AltitudeReference::Pressure,
                    Altitude::Ellipsoid(_) => AltitudeReference::Ellipsoid,
                },
            },
        })
    }
}

/// Reads a receiver until `stop` is set, connecting again where the connection is lost; each report
/// goes to `take`, which says whether to go on. `clock_s` tells the time of what was just read,
/// seconds.
pub fn read(
    endpoint: &ReceiverEndpoint,
    clock_s: impl Fn() -> f64,
    stop: &AtomicBool,
    mut take: impl FnMut(Report) -> bool,
) {
    let mut buffer = vec![0; 16_384];
    let mut joiner = Joiner::of(Sender::receiver(endpoint.source, &endpoint.address));
    let mut lines = sbs::Stream::new();
    #[cfg(feature = "beast")]
    let mut frames = beast::Stream::new();
    let mut reader = None;
    while !stop.load(Ordering::Relaxed) {
        let Some(open_reader) = &mut reader else {
            // The name may become known later.
            match open(&Endpoint::Tcp(endpoint.address.clone())) {
                Ok((mut new, _)) => {
                    new.set_silent(SILENT);
                    reader = Some(new);
                }
                Err(_) => std::thread::sleep(Duration::from_secs(2)),
            }
            continue;
        };
        match open_reader.read(&mut buffer) {
            Received::Bytes(count) => {
                let bytes = buffer.get(..count).unwrap_or_default();
                let now_s = clock_s();
                let mut goes_on = true;
                let mut report = |message: TrafficReport| {
                    if let Some(report) = joiner.take(&message, now_s) {
                        goes_on &= take(report);
                    }
                };
                match endpoint.source {
                    #[cfg(feature = "beast")]
                    Source::Beast => frames.push(bytes, now_s, &mut report),
                    _ => lines.push(bytes, &mut report),
                }
                if !goes_on {
                    return;
                }
            }
            Received::NewConnection => {
                lines = sbs::Stream::new();
                #[cfg(feature = "beast")]
                {
                    frames = beast::Stream::new();
                }
            }
            Received::Nothing => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn receivers_are_named() {
        let parsed: ReceiverEndpoint = "sbs:localhost:30003".parse().unwrap();
        assert_eq!(parsed.address, "localhost:30003");
        assert_eq!(
            "beast:h:30005".parse::<ReceiverEndpoint>().is_ok(),
            cfg!(feature = "beast")
        );
        for wrong in ["localhost:30003", "sbs:host", "sbs::1", "avr:h:1"] {
            assert!(wrong.parse::<ReceiverEndpoint>().is_err());
        }
    }

    #[test]
    fn parts_are_joined_and_memory_is_bounded() {
        let mut joiner = Joiner::new(Source::Sbs);
        let empty = TrafficReport {
            address: 7,
            ..TrafficReport::default()
        };
        let velocity = TrafficReport {
            ground_speed_mps: Some(50.0),
            course_rad: Some(0.0),
            ..empty
        };
        let place = TrafficReport {
            place_deg: Some([37.0, -122.0]),
            altitude: Some(Altitude::Pressure(300.0)),
            ..empty
        };
        assert!(joiner.take(&velocity, 0.0).is_none());
        let report = joiner.take(&place, 1.0).unwrap();
        assert!(
            report
                .velocity_mps
                .unwrap()
                .distance(Vec3::new(50.0, 0.0, 0.0))
                < 1e-9
        );
        let late = joiner.take(&place, 40.0).unwrap();
        assert_eq!(late.velocity_mps, None);
        let ground = TrafficReport {
            on_ground: Some(true),
            ..place
        };
        assert!(joiner.take(&ground, 41.0).is_none());
        for address in 0..200_000 {
            joiner.take(&TrafficReport { address, ..place }, 50.0);
            assert!(joiner.aircraft() <= MOST_AIRCRAFT);
        }
        assert!(joiner.aircraft() >= MOST_AIRCRAFT / 2);
    }
}

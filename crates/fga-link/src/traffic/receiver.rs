//! Receivers of ADS-B on the network: BaseStation, Beast and FLARM over TCP, GDL 90 over UDP.

use core::str::FromStr;
use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use fga_formats::tally::{LeftOut, Tally};
#[cfg(feature = "beast")]
use fga_formats::traffic::beast;
use fga_formats::traffic::{Altitude, Generations, TrafficReport, flarm, gdl90, sbs};

use super::report::{
    AltitudeReference, PlaceReport, Quality, ReportSender, ReportSource, SIGMAS_IN_95,
    tidy_callsign,
};
use crate::endpoint::{Endpoint, LinkRead, open};

/// A receiver: `sbs:HOST:PORT`, `beast:HOST:PORT` or `flarm:HOST:PORT`, which are connected to; `gdl90:HOST:PORT`, where datagrams are waited for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReceiverEndpoint {
    /// The kind of wire.
    pub source: ReportSource,
    /// Host and port.
    pub address: String,
}

/// Text that names no receiver.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no receiver, expected sbs:HOST:PORT, flarm:HOST:PORT, gdl90:HOST:PORT, or beast:HOST:PORT where the program was built with it"
)]
pub struct ReceiverError(String);

impl FromStr for ReceiverEndpoint {
    type Err = ReceiverError;

    fn from_str(text: &str) -> Result<Self, ReceiverError> {
        let error = || ReceiverError(text.to_owned());
        let (kind, address) = text.split_once(':').ok_or_else(error)?;
        let source = match kind {
            "sbs" => ReportSource::Sbs,
            "gdl90" => ReportSource::Gdl90,
            "flarm" => ReportSource::Flarm,
            "beast" if cfg!(feature = "beast") => ReportSource::Beast,
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

impl ReceiverEndpoint {
    fn socket(&self) -> Endpoint {
        let address = self.address.clone();
        match self.source {
            ReportSource::Gdl90 => Endpoint::UdpIn(address),
            _ => Endpoint::Tcp(address),
        }
    }
}

/// A receiver silent for this long is connected again: the air may be empty.
const SILENT: Duration = Duration::from_mins(1);
/// Most aircraft with joined messages; those not heard for longest make room.
const MOST_AIRCRAFT: usize = 32_768;
/// Validity of an altitude, a velocity, a climb or a place on the ground for later positions, seconds.
const PART_LIFETIME_S: f64 = 15.0;
/// σ of a position without quality figures, metres.
const UNKNOWN_SIGMA_M: f64 = 15.0;
/// A radius of containment means near certainty: at least four σ.
const SIGMAS_IN_CONTAINMENT: f64 = 4.0;
/// A position without source integrity is worse by this factor, and at least by this, metres.
const WITHOUT_INTEGRITY: f64 = 2.0;
const WITHOUT_INTEGRITY_M: f64 = 30.0;
/// σ is at most this, metres: an aircraft that knows nothing would fill the sky.
const MOST_SIGMA_M: f64 = 300.0;
/// σ of a velocity without quality figures, and of one with a known lack of quality, metres per second.
const UNKNOWN_VELOCITY_MPS: f64 = 1.0;
const POOR_VELOCITY_MPS: f64 = 8.0;
/// A velocity ages by this, metres per second squared.
const VELOCITY_AGES_MPS2: f64 = 1.5;

/// The parts known of one aircraft between its messages.
#[derive(Debug, Clone, Copy, Default)]
struct KnownParts {
    altitude: Option<(Altitude, f64)>,
    velocity_mps: Option<([f64; 2], f64)>,
    climb_mps: Option<(f64, f64)>,
    callsign: Option<fga_formats::traffic::Callsign>,
    containment_m: Option<f64>,
    error_m: Option<f64>,
    integrity: Option<u8>,
    velocity_error_mps: Option<f64>,
    on_ground: Option<(bool, f64)>,
}

/// A part that is still valid.
fn fresh<T>(part: Option<(T, f64)>, now_s: f64) -> Option<(T, f64)> {
    part.filter(|(_, heard_s)| now_s - heard_s < PART_LIFETIME_S)
}

impl KnownParts {
    /// σ of the horizontal position along an axis, metres.
    fn sigma_m(&self) -> f64 {
        let by_error = self.error_m.map(|m| m / SIGMAS_IN_95);
        let by_containment = self.containment_m.map(|m| m / SIGMAS_IN_CONTAINMENT);
        let sigma_m = match self.integrity {
            // The accuracy holds only while nothing fails, and nothing says how often it does.
            Some(0) => by_error
                .map_or(UNKNOWN_SIGMA_M, |m| m * WITHOUT_INTEGRITY)
                .max(by_containment.unwrap_or(0.0))
                .max(WITHOUT_INTEGRITY_M),
            _ => by_error.or(by_containment).unwrap_or(UNKNOWN_SIGMA_M),
        };
        sigma_m.min(MOST_SIGMA_M)
    }

    /// σ of the velocity along an axis, `age_s` after its report, metres per second.
    fn velocity_sigma_mps(&self, age_s: f64) -> f64 {
        let told = self.velocity_error_mps.map(|mps| mps / SIGMAS_IN_95);
        let sigma_mps = told.unwrap_or(UNKNOWN_VELOCITY_MPS).min(POOR_VELOCITY_MPS);
        sigma_mps + VELOCITY_AGES_MPS2 * age_s.max(0.0)
    }
}

/// Joins messages that each hold a part (position, velocity, call sign) to whole reports.
#[derive(Debug)]
pub struct Joiner {
    sender: ReportSender,
    aircraft: Generations<KnownParts, MOST_AIRCRAFT>,
}

impl Joiner {
    /// Nothing heard yet.
    pub fn new(source: ReportSource) -> Self {
        Self::of(ReportSender { source, number: 0 })
    }

    /// The same for one of several receivers.
    pub fn of(sender: ReportSender) -> Self {
        Self {
            sender,
            aircraft: Generations::default(),
        }
    }

    /// Number of aircraft in memory.
    pub fn aircraft(&self) -> usize {
        self.aircraft.len()
    }

    /// Takes a message; returns a report if it has a position.
    pub fn take(&mut self, message: &TrafficReport, now_s: f64) -> Option<PlaceReport> {
        let parts = self.aircraft.entry(message.address);
        if let Some(altitude) = message.altitude {
            parts.altitude = Some((altitude, now_s));
        }
        if let Some(velocity) = message.ground_velocity_mps() {
            parts.velocity_mps = Some((velocity, now_s));
        }
        if let Some(climb_mps) = message.climb_mps {
            parts.climb_mps = Some((climb_mps, now_s));
        }
        if let Some(on_ground) = message.on_ground {
            parts.on_ground = Some((on_ground, now_s));
        }
        parts.containment_m = message.containment_m.or(parts.containment_m);
        parts.error_m = message.position_error_m.or(parts.error_m);
        parts.integrity = message.source_integrity.or(parts.integrity);
        parts.velocity_error_mps = message.velocity_error_mps.or(parts.velocity_error_mps);
        parts.callsign = message.callsign.or(parts.callsign);
        if fresh(parts.on_ground, now_s).is_some_and(|(is_so, _)| is_so) {
            return None;
        }
        let [latitude_deg, longitude_deg] = message.place_deg?;
        let known_mps = fresh(parts.climb_mps, now_s).map(|(climb_mps, _)| climb_mps);
        let climb_mps = known_mps.unwrap_or(0.0);
        let altitude = fresh(parts.altitude, now_s);
        let velocity = fresh(parts.velocity_mps, now_s);
        let altitude_m = altitude.map_or(0.0, |(altitude, altitude_s)| {
            altitude.metres() + climb_mps * (now_s - altitude_s).max(0.0)
        });
        let reference = match altitude {
            Some((Altitude::Pressure(_), _)) => AltitudeReference::Pressure,
            Some((Altitude::Ellipsoid(_), _)) => AltitudeReference::Ellipsoid,
            None => AltitudeReference::Unknown,
        };
        let quality = Quality {
            velocity_mps: velocity.map_or(0.0, |(_, heard_s)| {
                parts.velocity_sigma_mps(now_s - heard_s)
            }),
            velocity_sigma_is_known: parts.velocity_error_mps.is_some() && velocity.is_some(),
            climb_is_known: known_mps.is_some(),
            ..Quality::of_position(parts.sigma_m(), reference)
        };
        let callsign = parts.callsign;
        let place = Geodetic::new(latitude_deg, longitude_deg, altitude_m)?;
        Some(PlaceReport {
            icao: message.address,
            callsign: callsign.map_or_else(String::new, |name| tidy_callsign(name.as_str())),
            velocity_mps: velocity.map(|([east, north], _)| Vec3::new(east, north, climb_mps)),
            ..PlaceReport::of_position(self.sender, place, now_s, quality)
        })
    }
}

/// What a receiver has given so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FeedStatus {
    /// The receiver.
    pub sender: ReportSender,
    /// Whether there has been a connection.
    pub was_connected: bool,
    /// What became of its lines or frames.
    pub tally: Tally,
    /// Positions of aircraft in them.
    pub positions: u64,
}

impl FeedStatus {
    /// What is passed on at once when it changes: all but larger counts.
    fn news(&self) -> (bool, bool, u64, Vec<LeftOut>) {
        let reasons = self.tally.reasons().map(|(reason, _)| reason);
        let lost = self.tally.lost().min(FIRST);
        (
            self.was_connected,
            self.positions > 0,
            lost,
            reasons.collect(),
        )
    }
}

/// Counts are passed on at once up to this number of lost parts, and at these times at the latest, seconds.
const FIRST: u64 = 10;
const COUNTS_EVERY_S: f64 = 10.0;

/// A receiver that was connected again and still gives nothing is silent, after this time, seconds. In empty air dump1090 and readsb send
/// their heartbeat once a minute, GDL 90 and FLARM once a second.
pub(crate) const SILENT_S: f64 = 2.0 * SILENT.as_secs() as f64 + COUNTS_EVERY_S;

/// The lines or frames of a receiver.
struct Wire {
    lines: sbs::LineStream,
    messages: gdl90::Datagrams,
    sentences: flarm::Sentences,
    #[cfg(feature = "beast")]
    frames: beast::Stream,
    source: ReportSource,
}

impl Wire {
    fn new(source: ReportSource) -> Self {
        Self {
            lines: sbs::LineStream::default(),
            messages: gdl90::Datagrams::default(),
            sentences: flarm::Sentences::default(),
            #[cfg(feature = "beast")]
            frames: beast::Stream::default(),
            source,
        }
    }

    fn push(&mut self, bytes: &[u8], now_s: f64, report: impl FnMut(TrafficReport)) {
        match self.source {
            #[cfg(feature = "beast")]
            ReportSource::Beast => self.frames.push(bytes, now_s, report),
            ReportSource::Gdl90 => self.messages.push(bytes, report),
            ReportSource::Flarm => self.sentences.push(bytes, report),
            _ => {
                let _ = now_s;
                self.lines.push(bytes, report);
            }
        }
    }

    fn reconnect(&mut self) {
        self.lines.reconnect();
        self.messages.reconnect();
        self.sentences.reconnect();
        #[cfg(feature = "beast")]
        self.frames.reconnect();
    }

    fn tally(&self) -> Tally {
        match self.source {
            #[cfg(feature = "beast")]
            ReportSource::Beast => self.frames.tally(),
            ReportSource::Gdl90 => self.messages.tally(),
            ReportSource::Flarm => self.sentences.tally(),
            _ => self.lines.tally(),
        }
    }
}

/// Reads a receiver until `stop` is set, and connects again after a loss; `take` gets each report
/// and says whether to go on. `feed` gets what the receiver has given so far, when that changes, and says whether it has
/// arrived. `clock_s` gives the time of the data just read, seconds.
pub fn read(
    endpoint: &ReceiverEndpoint,
    clock_s: impl Fn() -> f64,
    stop: &AtomicBool,
    mut take: impl FnMut(PlaceReport) -> bool,
    mut feed: impl FnMut(FeedStatus) -> bool,
) {
    let mut buffer = vec![0; 16_384];
    let sender = ReportSender::receiver(endpoint.source, &endpoint.address);
    let mut joiner = Joiner::of(sender);
    let mut wire = Wire::new(endpoint.source);
    let mut reader = None;
    let mut status = FeedStatus {
        sender,
        was_connected: false,
        tally: Tally::default(),
        positions: 0,
    };
    let mut passed_on: Option<(FeedStatus, f64)> = None;
    while !stop.load(Ordering::Relaxed) {
        status.tally = wire.tally();
        let now_s = clock_s();
        let is_due = passed_on.is_none_or(|(last, at_s)| {
            last.news() != status.news() || (last != status && now_s - at_s >= COUNTS_EVERY_S)
        });
        if is_due && feed(status) {
            passed_on = Some((status, now_s));
        }
        let Some(open_reader) = &mut reader else {
            // The name may become resolvable later.
            match open(&endpoint.socket()) {
                Ok((mut new, _)) => {
                    new.set_silent(SILENT);
                    reader = Some(new);
                }
                Err(_) => std::thread::sleep(Duration::from_secs(2)),
            }
            continue;
        };
        match open_reader.read(&mut buffer) {
            LinkRead::Bytes(count) => {
                let bytes = buffer.get(..count).unwrap_or_default();
                let now_s = clock_s();
                // Datagrams come without a connection.
                status.was_connected = true;
                let mut goes_on = true;
                wire.push(bytes, now_s, |message: TrafficReport| {
                    status.positions += u64::from(message.place_deg.is_some());
                    if let Some(mut report) = joiner.take(&message, now_s) {
                        report.valid_s -= message.age_s;
                        goes_on &= take(report);
                    }
                });
                if !goes_on {
                    return;
                }
            }
            LinkRead::NewConnection => {
                status.was_connected = true;
                wire.reconnect();
            }
            LinkRead::Nothing => {}
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
        let parsed: ReceiverEndpoint = "gdl90:0.0.0.0:4000".parse().unwrap();
        assert_eq!(parsed.socket(), Endpoint::UdpIn("0.0.0.0:4000".into()));
        for wrong in ["localhost:30003", "sbs:host", "sbs::1", "avr:h:1"] {
            assert!(wrong.parse::<ReceiverEndpoint>().is_err());
        }
    }

    #[test]
    fn quality_figures_make_the_uncertainty() {
        let place = TrafficReport {
            address: 7,
            place_deg: Some([37.0, -122.0]),
            altitude: Some(Altitude::Pressure(300.0)),
            ground_speed_mps: Some(50.0),
            course_rad: Some(0.0),
            ..TrafficReport::default()
        };
        let quality = |report: TrafficReport| {
            let mut joiner = Joiner::new(ReportSource::Beast);
            joiner.take(&report, 0.0).unwrap().quality
        };
        assert_eq!(quality(place).position_m, UNKNOWN_SIGMA_M);
        // A category of 9: 30 m in 95 of 100 cases.
        let good = TrafficReport {
            position_error_m: Some(30.0),
            source_integrity: Some(3),
            containment_m: Some(185.2),
            velocity_error_mps: Some(10.0),
            ..place
        };
        assert!((quality(good).position_m - 12.26).abs() < 0.01);
        assert!((quality(good).velocity_mps - 4.085).abs() < 0.01);
        let unfounded = TrafficReport {
            source_integrity: Some(0),
            ..good
        };
        assert!(quality(unfounded).position_m >= 46.0);
        let nothing = TrafficReport {
            containment_m: Some(f64::INFINITY),
            velocity_error_mps: Some(f64::INFINITY),
            ..place
        };
        assert_eq!(quality(nothing).position_m, MOST_SIGMA_M);
        assert_eq!(quality(nothing).velocity_mps, POOR_VELOCITY_MPS);
        // A velocity of 10 s ago says less, and the altitude has gone on with the climb.
        let mut joiner = Joiner::new(ReportSource::Beast);
        let climbing = TrafficReport {
            climb_mps: Some(5.0),
            ..good
        };
        joiner.take(&climbing, 0.0);
        let later = TrafficReport {
            address: 7,
            place_deg: Some([37.0, -122.0]),
            ..TrafficReport::default()
        };
        let report = joiner.take(&later, 10.0).unwrap();
        assert!(report.quality.velocity_mps > 15.0);
        assert!((report.place.altitude_m - 350.0).abs() < 1e-9);
    }

    /// A place on the ground and a climb of long ago: the aircraft took off since, and levelled off.
    #[test]
    fn t4_no_part_of_long_ago_hides_or_moves_an_aircraft() {
        let place = TrafficReport {
            address: 7,
            place_deg: Some([37.0, -122.0]),
            altitude: Some(Altitude::Pressure(300.0)),
            ..TrafficReport::default()
        };
        let ground = TrafficReport {
            on_ground: Some(true),
            climb_mps: Some(10.0),
            ..place
        };
        let mut joiner = Joiner::new(ReportSource::Sbs);
        assert!(joiner.take(&ground, 0.0).is_none());
        assert!(joiner.take(&place, 14.0).is_none());
        assert!(joiner.take(&place, 16.0).is_some());
        let bare = TrafficReport {
            altitude: None,
            ..place
        };
        assert_eq!(joiner.take(&bare, 26.0).unwrap().place.altitude_m, 300.0);
    }

    #[test]
    fn parts_are_joined_and_memory_is_bounded() {
        let mut joiner = Joiner::new(ReportSource::Sbs);
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

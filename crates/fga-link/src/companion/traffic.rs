//! Who reports other aircraft: ADS-B, Remote ID, radars or cameras on board, and receivers beside the link?

use fga::Vec3;
use fga::situation::Movement;
use fga_formats::geodesy::Geodetic;
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, MavFrame, MavMessage, OBSTACLE_DISTANCE_3D_DATA,
};
use serde_json::{Value, json};

use super::around::ObstaclesAround;
use super::feeds::Feeds;
use super::lead::Lead;
use super::voice::Voice;
use crate::config::{Config, GeometricDatum};
use crate::outgoing::AUTOPILOT;
use crate::ownship::OwnshipEstimate;
use crate::traffic::receiver::FeedStatus;
use crate::traffic::report::{Quality, TrackKey, adsb_address, adsb_place};
use crate::traffic::{
    AircraftClass, AltitudeReference, Defect, Defects, PlaceReport, ReportSender, ReportSource,
};

/// σ of a sensor's position without a configuration, metres, and as a share of its distance.
const SENSOR_SIGMA_M: f64 = 10.0;
const SENSOR_SIGMA_SHARE: f64 = 0.02;
/// Largest range of a sensor, m.
const SENSOR_REACH_M: f64 = 20_000.0;
/// An altitude farther below home than this, metres, or higher than this is wrong by its sign or unit.
const FARTHEST_BELOW_M: f64 = 500.0;
const HIGHEST_M: f64 = 30_000.0;
/// So is an altitude above this, metres, of an aircraft slower than this, metres per second, that is no balloon: no wing
/// flies that slowly in air that thin.
const SLOW_MPS: f64 = 40.0;
const HIGHEST_SLOW_M: f64 = 7_500.0;
/// A report that breaks a silence of the telemetry waits this long for it, seconds, …
const HELD_S: f64 = 0.1;
/// … with at most this number of others.
const MOST_HELD: usize = 64;
/// An obstacle without a number of its own.
const UNNUMBERED: u16 = u16::MAX;

/// The reports of traffic and their faults.
#[derive(Debug, Default)]
pub(super) struct TrafficReports {
    feeds: Feeds,
    defects: Defects,
    /// Reports that broke a silence of the telemetry, and when, seconds.
    held: Vec<(MavHeader, ADSB_VEHICLE_DATA, f64)>,
}

/// What a report needs: where the aircraft is, whose traffic counts, and where it goes.
pub(super) struct ReportContext<'a> {
    pub(super) config: &'a Config,
    /// System id of the vehicle, once heard.
    pub(super) system: Option<u8>,
    pub(super) lead: &'a Lead,
    pub(super) ownship: &'a mut OwnshipEstimate,
    pub(super) around: &'a mut ObstaclesAround,
    pub(super) voice: &'a mut Voice,
}

impl ReportContext<'_> {
    /// σ of a configured sensor, metres.
    fn sensor_sigma_m(&self, system: u8, component: u8) -> Option<f64> {
        let mut sensors = self.config.traffic.sensor.iter();
        let sensor = sensors
            .find(|sensor| sensor.system_id == system && sensor.component_id == component)?;
        Some(sensor.position_sigma_m)
    }
}

impl TrafficReports {
    /// Takes a message about other aircraft; `false` for any other message.
    pub(super) fn take_message(
        &mut self,
        header: MavHeader,
        message: &MavMessage,
        at: &mut ReportContext<'_>,
    ) -> bool {
        let now_s = at.voice.now_s();
        let system = u8::try_from(header.system_id).unwrap_or(u8::MAX);
        let on_board = Some(system) == at.system;
        let sender = |source| ReportSender::mavlink(source, system, header.component_id);
        let remote = sender(ReportSource::RemoteId);
        let report = match message {
            MavMessage::ADSB_VEHICLE(data)
                if at.ownship.is_silent(now_s) && self.held.len() < MOST_HELD =>
            {
                self.held.push((header, data.clone(), now_s));
                None
            }
            MavMessage::ADSB_VEHICLE(data) => self.adsb_report(data, header, now_s, at),
            MavMessage::OPEN_DRONE_ID_BASIC_ID(data) => {
                let (remote_id, _) = at.around.tracks_mut().remote_id();
                remote_id.take_basic_id(data, remote, now_s);
                None
            }
            // Without an identity of the transmitter, messages of the vehicle's system describe the
            // vehicle itself.
            MavMessage::OPEN_DRONE_ID_LOCATION(data) if on_board && data.id_or_mac == [0; 20] => {
                None
            }
            MavMessage::OPEN_DRONE_ID_MESSAGE_PACK(data)
                if on_board && data.id_or_mac == [0; 20] =>
            {
                None
            }
            MavMessage::OPEN_DRONE_ID_LOCATION(data) => {
                let (remote_id, levels) = at.around.tracks_mut().remote_id();
                let taken = remote_id.take_location(data, remote, levels, now_s);
                self.with_position(taken, at)
            }
            MavMessage::OPEN_DRONE_ID_MESSAGE_PACK(data) => {
                let (remote_id, levels) = at.around.tracks_mut().remote_id();
                let taken = remote_id.take_pack(data, remote, levels, now_s);
                self.with_position(taken, at)
            }
            MavMessage::OBSTACLE_DISTANCE_3D(data) => {
                let sender = sender(ReportSource::Sensor);
                let sigma_m = at.sensor_sigma_m(system, header.component_id);
                // A stranger's sensor sees from another place.
                if on_board || sigma_m.is_some() {
                    sensor_report(data, sender, sigma_m.unwrap_or(SENSOR_SIGMA_M), at)
                } else {
                    None
                }
            }
            _ => return false,
        };
        if let Some(report) = report {
            self.take(&report, at);
        }
        true
    }

    /// The report of Remote ID; an aircraft without a position is counted.
    fn with_position(
        &mut self,
        taken: Result<Option<PlaceReport>, TrackKey>,
        at: &mut ReportContext<'_>,
    ) -> Option<PlaceReport> {
        taken.unwrap_or_else(|key| {
            self.count_defect(Defect::NoPosition, key, None, at);
            None
        })
    }

    /// Takes the reports that broke a silence: the telemetry behind them shows whether they waited in its queue, or does not
    /// come.
    pub(super) fn take_held(&mut self, at: &mut ReportContext<'_>) {
        let now_s = at.voice.now_s();
        let waits = |heard_s: f64| at.ownship.is_silent(now_s) && now_s - heard_s < HELD_S;
        let first = self.held.first();
        if first.is_none_or(|(_, _, heard_s)| waits(*heard_s)) {
            return;
        }
        for (header, data, heard_s) in core::mem::take(&mut self.held) {
            if let Some(report) = self.adsb_report(&data, header, heard_s, at) {
                self.take(&report, at);
            }
        }
    }

    fn adsb_report(
        &mut self,
        data: &ADSB_VEHICLE_DATA,
        header: MavHeader,
        heard_s: f64,
        at: &mut ReportContext<'_>,
    ) -> Option<PlaceReport> {
        let system = u8::try_from(header.system_id).unwrap_or(u8::MAX);
        let own = at.system == Some(system) && header.component_id == AUTOPILOT;
        let configured = at.sensor_sigma_m(system, header.component_id);
        let source = match configured {
            _ if own => ReportSource::AutopilotList,
            Some(_) => ReportSource::Sensor,
            None => ReportSource::Mavlink,
        };
        let sigma_m = configured.unwrap_or(at.config.traffic.position_sigma_m);
        let sender = ReportSender::mavlink(source, system, header.component_id);
        let sent_s = heard_s - at.ownship.queued_s();
        let report = PlaceReport::from_adsb(data, sender, sent_s, sigma_m);
        if let Err(defect) = report {
            let key = match adsb_address(data) {
                0 => TrackKey::Unnamed(sender),
                icao => TrackKey::Address(icao),
            };
            self.count_defect(defect, key, adsb_place(data), at);
        }
        let mut report = report.ok()?;
        if report.quality.altitude == AltitudeReference::Geometric {
            report.quality.altitude = match at.config.traffic.geometric {
                GeometricDatum::Unconfirmed => AltitudeReference::Geometric,
                GeometricDatum::SeaLevel => AltitudeReference::MeanSeaLevel,
                GeometricDatum::Ellipsoid => AltitudeReference::Ellipsoid,
            };
        }
        if source == ReportSource::Sensor && report.icao != 0 {
            // A sensor numbers its detections; its numbers are no addresses.
            let number = u16::try_from(report.icao & 0xFFFF).unwrap_or(UNNUMBERED);
            report.key = Some(TrackKey::Seen(sender, number));
            report.icao = 0;
        }
        Some(report)
    }

    /// Takes a report of traffic, from a receiver or a message.
    pub(super) fn take(&mut self, report: &PlaceReport, at: &mut ReportContext<'_>) {
        let now_s = at.voice.now_s();
        let Some(frame) = at.ownship.frame() else {
            return;
        };
        let mut report = report.clone();
        let home_m = at.ownship.home_altitude_m().unwrap_or(0.0);
        let is_slow = report.class != AircraftClass::GliderBalloon
            && report.velocity_mps.is_some_and(|v| v.length() < SLOW_MPS);
        let highest_m = if is_slow { HIGHEST_SLOW_M } else { HIGHEST_M };
        let likely_m = home_m - FARTHEST_BELOW_M..highest_m;
        if !likely_m.contains(&report.place.altitude_m) {
            report.quality.altitude = AltitudeReference::Unknown;
        }
        let report = &report;
        let tracks = at.around.tracks_mut();
        tracks.take(report, frame, now_s);
        let key = report.key();
        let has_no_altitude = report.quality.altitude == AltitudeReference::Unknown;
        let defects = [
            (Defect::Old, tracks.is_old(report, now_s)),
            (Defect::NoAltitude, has_no_altitude),
            (Defect::FalseVelocity, tracks.contradicts_itself(key)),
        ];
        let first = defects.into_iter().find(|(_, has)| *has);
        if let Some((defect, _)) = first {
            self.count_defect(defect, key, Some(report.place), at);
        }
    }

    /// Counts a defect, and reports the first of its kind within the surveillance radius to the operator; an aircraft
    /// without any position may be near.
    fn count_defect(
        &mut self,
        defect: Defect,
        key: TrackKey,
        place: Option<Geodetic>,
        at: &mut ReportContext<'_>,
    ) {
        let (ownship, config) = (&at.ownship, at.config);
        let range_m = place.zip(ownship.frame()).and_then(|(place, frame)| {
            let off_m = frame.to_local_m(place) - ownship.position_m(at.voice.now_s())?;
            Some(libm::hypot(off_m.x, off_m.y))
        });
        let airspeed_mps = ownship.airspeed_mps().unwrap_or_default();
        let surveillance_m = config.surveillance_m(airspeed_mps);
        let is_near = range_m.is_none_or(|m| m <= surveillance_m);
        let is_own = matches!(key, TrackKey::Address(icao) if config.own_icao() == Ok(Some(icao)));
        if is_own {
            return;
        }
        if let Some(words) = self.defects.count(defect, key, is_near) {
            at.voice.warn(&words);
        }
    }

    /// Takes what a receiver has given so far.
    pub(super) fn take_feed(&mut self, status: FeedStatus, voice: &mut Voice) {
        self.feeds.take(status, voice);
    }

    /// The receivers of traffic.
    pub(super) const fn feeds(&self) -> &Feeds {
        &self.feeds
    }

    /// Tells the operator once of each reason for which a feed's parts are left out, and of each silence.
    pub(super) fn tell_left_out(&mut self, voice: &mut Voice) {
        self.feeds.tell(voice);
    }

    /// The defects of reports so far.
    pub(super) const fn defects(&self) -> &Defects {
        &self.defects
    }

    /// Notes the number of reports and aircraft with each defect.
    pub(super) fn note_defects(&self, voice: &mut Voice) {
        let counts = Defect::ALL.map(|defect| {
            let count = json!({
                "reports": self.defects.reports(defect),
                "aircraft": self.defects.aircraft(defect),
            });
            (defect.name().to_owned(), count)
        });
        voice.note("defects", Value::Object(counts.into_iter().collect()));
    }
}

/// A place relative to the vehicle.
fn sensor_report(
    data: &OBSTACLE_DISTANCE_3D_DATA,
    sender: ReportSender,
    sigma_m: f64,
    at: &mut ReportContext<'_>,
) -> Option<PlaceReport> {
    let now_s = at.voice.now_s();
    let offset = Vec3::new(f64::from(data.x), f64::from(data.y), f64::from(data.z));
    let distance_m = offset.length();
    let farthest_m = f64::from(data.max_distance).min(SENSOR_REACH_M);
    if !offset.is_finite() || distance_m > farthest_m || distance_m < f64::from(data.min_distance) {
        return None;
    }
    let state = at.lead.state_now(at.ownship, now_s)?;
    let heading_rad = at.ownship.heading_rad()?;
    let (bank_rad, pitch_rad) = match data.frame {
        // The body's axes: forward, right, down.
        MavFrame::MAV_FRAME_BODY_FRD => (-state.ownship.bank_rad, state.pitch_rad),
        // The same, but level.
        MavFrame::MAV_FRAME_LOCAL_FRD => (0.0, 0.0),
        _ => return None,
    };
    let east_north_up = from_body(offset, bank_rad, pitch_rad, heading_rad);
    let frame = at.ownship.frame()?;
    let place = frame.to_geodetic(state.ownship.position_m + east_north_up);
    let key = match data.obstacle_id {
        UNNUMBERED => TrackKey::Unnamed(sender),
        number => TrackKey::Seen(sender, number),
    };
    let sigma_m = libm::hypot(sigma_m, SENSOR_SIGMA_SHARE * distance_m);
    let quality = Quality::of_position(sigma_m, AltitudeReference::MeanSeaLevel);
    Some(PlaceReport {
        key: Some(key),
        // It may be any flying object.
        movement: Movement::SMALL_UAS,
        ..PlaceReport::of_position(sender, place, now_s, quality)
    })
}

/// Forward, right and down in east, north and up: bank positive to the right, pitch positive up,
/// heading anticlockwise from east.
fn from_body(offset: Vec3, bank_rad: f64, pitch_rad: f64, heading_rad: f64) -> Vec3 {
    let (sin_bank, cos_bank) = libm::sincos(bank_rad);
    let right_m = offset.y * cos_bank - offset.z * sin_bank;
    let down_m = offset.y * sin_bank + offset.z * cos_bank;
    let (sin_pitch, cos_pitch) = libm::sincos(pitch_rad);
    let ahead_m = offset.x * cos_pitch + down_m * sin_pitch;
    let down_m = down_m * cos_pitch - offset.x * sin_pitch;
    let (sin, cos) = libm::sincos(heading_rad);
    Vec3::new(
        ahead_m * cos + right_m * sin,
        ahead_m * sin - right_m * cos,
        -down_m,
    )
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn body_axes_turn_with_the_aircraft() {
        let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-9, "{a} {b}");
        // Heading north: right is east.
        near(from_body(Vec3::Y, 0.0, 0.0, FRAC_PI_2), Vec3::X);
        // Nose up by 90°: ahead is up.
        near(from_body(Vec3::X, 0.0, FRAC_PI_2, FRAC_PI_2), Vec3::Z);
        // Banked right by 90°: the right wing points down.
        near(from_body(Vec3::Y, FRAC_PI_2, 0.0, FRAC_PI_2), -Vec3::Z);
        // Heading east, down is down.
        near(from_body(Vec3::Z, 0.0, 0.0, 0.0), -Vec3::Z);
    }
}

//! Remote ID (ASTM F3411): unmanned aircraft that broadcast their position, as a receiver passes
//! it on in `OPEN_DRONE_ID_LOCATION`, `OPEN_DRONE_ID_BASIC_ID` and packs of both.

use alloc::collections::BTreeMap;

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use mavlink::dialects::ardupilotmega::{
    MavOdidStatus, OPEN_DRONE_ID_BASIC_ID_DATA, OPEN_DRONE_ID_LOCATION_DATA,
    OPEN_DRONE_ID_MESSAGE_PACK_DATA,
};

pub use super::identity::Transmitter;

use super::class::AircraftClass;
use super::report::{
    AltitudeReference, PlaceReport, Quality, ReportSender, SIGMAS_IN_95, TrackKey, tidy_callsign,
};
use super::vertical::DatumLevels;
use crate::number::{degrees_from_e7, velocity_mps};

/// Most aircraft with a remembered name and clock.
const MOST_AIRCRAFT: usize = 1024;
/// One not heard for this long makes room, seconds.
const FORGOTTEN_S: f64 = 60.0;
/// Bytes of a broadcast message, and of the messages in a pack.
const MESSAGE: usize = 25;
/// Timestamps count tenths of a second from the full hour.
const HOUR_S: f64 = 3600.0;
/// Messages that say no later time for this long come from a clock that stands or was set back, seconds.
const CLOCK_S: f64 = 3.0;
/// Highest altitude that the broadcast can say, metres.
const HIGHEST_M: f64 = 31_767.5;
/// A message this much later than the fastest one has another clock, seconds.
const LATEST_S: f64 = 60.0;
/// Assumed accuracies if missing: metres, metres, metres per second.
const UNKNOWN_SIGMA_M: f64 = 30.0;
const UNKNOWN_HEIGHT_M: f64 = 50.0;
const UNKNOWN_VELOCITY_MPS: f64 = 4.0;

/// An aircraft's reported state.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Location {
    on_ground: bool,
    latitude_deg: f64,
    longitude_deg: f64,
    pressure_altitude_m: Option<f64>,
    ellipsoid_altitude_m: Option<f64>,
    /// Degrees clockwise from north, metres per second.
    direction_deg: Option<f64>,
    speed_mps: Option<f64>,
    climb_mps: Option<f64>,
    /// Categories of the standard.
    horizontal_accuracy: u8,
    vertical_accuracy: u8,
    pressure_accuracy: u8,
    speed_accuracy: u8,
    /// Seconds since the full hour.
    timestamp_s: Option<f64>,
}

#[derive(Debug, Clone, Default)]
struct RemoteAircraft {
    name: String,
    heard_s: f64,
    /// Least difference between the local clock and its timestamps, seconds.
    least_delay_s: Option<f64>,
    last_timestamp_s: Option<f64>,
    /// Since when its messages say no later time, seconds.
    no_later_since_s: Option<f64>,
}

/// The remembered transmitters.
#[derive(Debug, Clone, Default)]
pub struct RemoteId {
    aircraft: BTreeMap<Transmitter, RemoteAircraft>,
}

impl RemoteId {
    /// Number of aircraft in memory.
    pub fn aircraft(&self) -> usize {
        self.aircraft.len()
    }

    /// Takes a name.
    pub fn take_basic_id(
        &mut self,
        data: &OPEN_DRONE_ID_BASIC_ID_DATA,
        sender: ReportSender,
        now_s: f64,
    ) {
        self.name(transmitter(data.id_or_mac, sender), &data.uas_id, now_s);
    }

    /// Takes a location; `None` of an aircraft on the ground, or a repetition.
    ///
    /// # Errors
    /// The identity of an aircraft without a position.
    pub fn take_location(
        &mut self,
        data: &OPEN_DRONE_ID_LOCATION_DATA,
        sender: ReportSender,
        levels: &DatumLevels,
        now_s: f64,
    ) -> Result<Option<PlaceReport>, TrackKey> {
        let told = |value: f64, unknown: f64| (value < unknown).then_some(value);
        let altitude = |metres: f32| {
            let metres = f64::from(metres);
            (metres > -1000.0 && metres <= HIGHEST_M).then_some(metres)
        };
        let location = Location {
            on_ground: data.status == MavOdidStatus::MAV_ODID_STATUS_GROUND,
            latitude_deg: degrees_from_e7(data.latitude),
            longitude_deg: degrees_from_e7(data.longitude),
            pressure_altitude_m: altitude(data.altitude_barometric),
            ellipsoid_altitude_m: altitude(data.altitude_geodetic),
            direction_deg: told(f64::from(data.direction) * 0.01, 360.5),
            speed_mps: told(f64::from(data.speed_horizontal) * 0.01, 255.0),
            climb_mps: told(f64::from(data.speed_vertical) * 0.01, 63.0),
            horizontal_accuracy: data.horizontal_accuracy as u8,
            vertical_accuracy: data.vertical_accuracy as u8,
            pressure_accuracy: data.barometer_accuracy as u8,
            speed_accuracy: data.speed_accuracy as u8,
            timestamp_s: told(f64::from(data.timestamp), HOUR_S + 1.0),
        };
        self.report(
            transmitter(data.id_or_mac, sender),
            &location,
            sender,
            levels,
            now_s,
        )
    }

    /// Takes a pack of broadcast messages of one aircraft; `None` without a location in the air.
    ///
    /// # Errors
    /// As [`Self::take_location`], and for a pack of another layout.
    pub fn take_pack(
        &mut self,
        data: &OPEN_DRONE_ID_MESSAGE_PACK_DATA,
        sender: ReportSender,
        levels: &DatumLevels,
        now_s: f64,
    ) -> Result<Option<PlaceReport>, TrackKey> {
        let from = transmitter(data.id_or_mac, sender);
        if usize::from(data.single_message_size) != MESSAGE {
            return Err(TrackKey::Transmitter(from));
        }
        let (messages, _) = data.messages.as_chunks::<MESSAGE>();
        let mut found = None;
        for message in messages.iter().take(usize::from(data.msg_pack_size)) {
            match message[0] >> 4 {
                0 => {
                    if let Some((_, rest)) = message.split_first_chunk::<2>()
                        && let Some(name) = rest.first_chunk::<20>()
                    {
                        self.name(from, name, now_s);
                    }
                }
                1 => found = Location::decode(message),
                _ => {}
            }
        }
        found.map_or(Ok(None), |location| {
            self.report(from, &location, sender, levels, now_s)
        })
    }

    /// The entry of a transmitter; `None` without room for another one.
    fn entry(&mut self, from: Transmitter, now_s: f64) -> Option<&mut RemoteAircraft> {
        if !self.aircraft.contains_key(&from) && self.aircraft.len() >= MOST_AIRCRAFT {
            self.aircraft
                .retain(|_, aircraft| now_s - aircraft.heard_s < FORGOTTEN_S);
            if self.aircraft.len() >= MOST_AIRCRAFT {
                return None;
            }
        }
        let aircraft = self.aircraft.entry(from).or_default();
        aircraft.heard_s = now_s;
        Some(aircraft)
    }

    fn name(&mut self, from: Transmitter, name: &[u8; 20], now_s: f64) {
        let text: String = name.iter().map(|byte| char::from(*byte)).collect();
        // The end of a serial number is more specific than the maker's code at its beginning.
        let text: String = text.chars().filter(char::is_ascii_graphic).collect();
        let tail = text.len().saturating_sub(super::report::LONGEST_CALLSIGN);
        if let Some(aircraft) = self.entry(from, now_s) {
            aircraft.name = tidy_callsign(text.get(tail..).unwrap_or_default());
        }
    }

    fn report(
        &mut self,
        from: Transmitter,
        location: &Location,
        sender: ReportSender,
        levels: &DatumLevels,
        now_s: f64,
    ) -> Result<Option<PlaceReport>, TrackKey> {
        let key = TrackKey::Transmitter(from);
        if location.on_ground {
            return Ok(None);
        }
        if location.latitude_deg == 0.0 && location.longitude_deg == 0.0 {
            return Err(key);
        }
        let (altitude_m, altitude, accuracy) =
            location
                .altitude(levels, now_s)
                .unwrap_or((0.0, AltitudeReference::Unknown, 0));
        let place = Geodetic::new(location.latitude_deg, location.longitude_deg, altitude_m);
        let sigma = |bound: f64| bound / SIGMAS_IN_95;
        let sigma_m =
            bound(&HORIZONTAL_M, location.horizontal_accuracy).map_or(UNKNOWN_SIGMA_M, sigma);
        let sigma_mps = bound(&SPEED_MPS, location.speed_accuracy).map(sigma);
        let quality = Quality {
            velocity_mps: sigma_mps.unwrap_or(UNKNOWN_VELOCITY_MPS),
            velocity_sigma_is_known: sigma_mps.is_some(),
            climb_is_known: location.climb_mps.is_some(),
            height_m: bound(&VERTICAL_M, accuracy).unwrap_or(UNKNOWN_HEIGHT_M),
            ..Quality::of_position(sigma_m, altitude)
        };
        let class = AircraftClass::SmallUnmanned;
        let mut report = PlaceReport {
            key: Some(key),
            velocity_mps: location.velocity_mps(),
            movement: class.movement(),
            class,
            ..PlaceReport::of_position(sender, place.ok_or(key)?, now_s, quality)
        };
        if let Some(aircraft) = self.entry(from, now_s) {
            report.callsign.clone_from(&aircraft.name);
            let Some(age_s) = aircraft.age_s(location.timestamp_s, now_s) else {
                return Ok(None);
            };
            report.valid_s = now_s - age_s;
        }
        Ok(Some(report))
    }
}

/// Zeros mean the sender's own aircraft: one for each system.
fn transmitter(id: Transmitter, sender: ReportSender) -> Transmitter {
    if id != [0; 20] {
        return id;
    }
    let mut own = [0; 20];
    let [system, _] = sender.number.to_be_bytes();
    own[19] = system;
    own
}

impl RemoteAircraft {
    /// The age of a location, seconds, by its timestamp against the fastest one; `None` for a repetition
    /// or one older than the last.
    fn age_s(&mut self, timestamp_s: Option<f64>, now_s: f64) -> Option<f64> {
        let Some(timestamp_s) = timestamp_s else {
            return Some(0.0);
        };
        if let Some(last_s) = self.last_timestamp_s {
            let on_s = (timestamp_s - last_s).rem_euclid(HOUR_S);
            // No later, or from before: in the half hour behind the last.
            if on_s == 0.0 || on_s > 0.5 * HOUR_S {
                let since_s = *self.no_later_since_s.get_or_insert(now_s);
                if now_s - since_s < CLOCK_S {
                    return None;
                }
                self.last_timestamp_s = Some(timestamp_s);
                self.least_delay_s = None;
                return Some(0.0);
            }
        }
        self.no_later_since_s = None;
        self.last_timestamp_s = Some(timestamp_s);
        let delay_s = (now_s - timestamp_s).rem_euclid(HOUR_S);
        let least_s = self.least_delay_s.unwrap_or(delay_s);
        let late_s = (delay_s - least_s).rem_euclid(HOUR_S);
        if late_s > LATEST_S {
            // Faster than the fastest so far, or another clock.
            self.least_delay_s = Some(delay_s);
            return Some(0.0);
        }
        self.least_delay_s = Some(least_s);
        Some(late_s)
    }
}

impl Location {
    /// A broadcast message: little endian, angles in 10⁻⁷ degrees, altitudes in half metres from
    /// −1,000 m, speeds in quarters of a metre per second or above 63.75 m/s in three quarters.
    fn decode(message: &[u8; MESSAGE]) -> Option<Self> {
        let [_, flags, direction, speed, climb, rest @ ..] = *message;
        let (places, rest) = rest.split_first_chunk::<8>()?;
        let [a, b, c, d, e, f, g, h] = *places;
        let (altitudes, rest) = rest.split_first_chunk::<6>()?;
        let [p0, p1, e0, e1, _, _] = *altitudes;
        let [accuracy, more, t0, t1, ..] = *rest.first_chunk::<4>()?;
        let altitude = |bytes: [u8; 2]| {
            let steps = u16::from_le_bytes(bytes);
            (steps != 0).then(|| f64::from(steps) * 0.5 - 1000.0)
        };
        let west_deg = if flags & 2 != 0 { 180.0 } else { 0.0 };
        let speed_mps = if flags & 1 != 0 {
            f64::from(speed) * 0.75 + 63.75
        } else {
            f64::from(speed) * 0.25
        };
        let climb_mps = f64::from(i8::from_le_bytes([climb])) * 0.5;
        let timestamp = u16::from_le_bytes([t0, t1]);
        Some(Self {
            on_ground: flags >> 4 == 1,
            latitude_deg: degrees_from_e7(i32::from_le_bytes([a, b, c, d])),
            longitude_deg: degrees_from_e7(i32::from_le_bytes([e, f, g, h])),
            pressure_altitude_m: altitude([p0, p1]),
            ellipsoid_altitude_m: altitude([e0, e1]),
            direction_deg: (direction < 180).then(|| f64::from(direction) + west_deg),
            speed_mps: (speed != 255).then_some(speed_mps),
            climb_mps: (climb_mps < 63.0).then_some(climb_mps),
            horizontal_accuracy: accuracy & 0xF,
            vertical_accuracy: accuracy >> 4,
            pressure_accuracy: more >> 4,
            speed_accuracy: more & 0xF,
            timestamp_s: (timestamp <= 36_000).then(|| f64::from(timestamp) * 0.1),
        })
    }

    /// The altitude that compares best with the vehicle's, metres, and its accuracy.
    fn altitude(&self, levels: &DatumLevels, now_s: f64) -> Option<(f64, AltitudeReference, u8)> {
        let pressure = self
            .pressure_altitude_m
            .map(|m| (m, AltitudeReference::Pressure, self.pressure_accuracy));
        let ellipsoid = self
            .ellipsoid_altitude_m
            .map(|m| (m, AltitudeReference::Ellipsoid, self.vertical_accuracy));
        if levels.knows_pressure(now_s) && !levels.knows_geoid() {
            pressure.or(ellipsoid)
        } else {
            ellipsoid.or(pressure)
        }
    }

    fn velocity_mps(&self) -> Option<Vec3> {
        let (speed_mps, track_rad) = (self.speed_mps?, self.direction_deg?.to_radians());
        Some(velocity_mps(
            speed_mps,
            track_rad,
            self.climb_mps.unwrap_or(0.0),
        ))
    }
}

/// Radii that contain 95 of 100 positions, metres, for the categories from 1 on.
const HORIZONTAL_M: [f64; 12] = [
    18_520.0, 7_408.0, 3_704.0, 1_852.0, 926.0, 555.6, 185.2, 92.6, 30.0, 10.0, 3.0, 1.0,
];
/// Bounds of the altitude's error in 95 of 100 cases, metres.
const VERTICAL_M: [f64; 6] = [150.0, 45.0, 25.0, 10.0, 3.0, 1.0];
/// Bounds of the velocity's error in 95 of 100 cases, metres per second.
const SPEED_MPS: [f64; 4] = [10.0, 3.0, 1.0, 0.3];

/// The bound of a category; `None` for an unknown one.
fn bound(bounds: &[f64], category: u8) -> Option<f64> {
    let index = usize::from(category).checked_sub(1)?;
    bounds.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traffic::ReportSource;

    const SENDER: ReportSender = ReportSender::mavlink(ReportSource::RemoteId, 7, 236);

    /// 37.5° north, 122.25° west, 300 m above the ellipsoid, to the west with 20 m/s, climbing with
    /// 2 m/s, 12.3 s after the hour.
    fn encoded() -> [u8; MESSAGE] {
        let mut message = [0; MESSAGE];
        message[0] = 0x12;
        message[1] = 0x22;
        message[2] = 90;
        message[3] = 80;
        message[4] = 4;
        message[5..9].copy_from_slice(&375_000_000_i32.to_le_bytes());
        message[9..13].copy_from_slice(&(-1_222_500_000_i32).to_le_bytes());
        message[15..17].copy_from_slice(&2600_u16.to_le_bytes());
        message[19] = 0x4A;
        message[20] = 0x03;
        message[21..23].copy_from_slice(&123_u16.to_le_bytes());
        message
    }

    #[test]
    fn a_pack_gives_a_named_report() {
        let mut messages = [0; 225];
        messages[0] = 0x02;
        messages[1] = 0x12;
        messages[2..17].copy_from_slice(b"1581F1234567890");
        messages[25..50].copy_from_slice(&encoded());
        let pack = OPEN_DRONE_ID_MESSAGE_PACK_DATA {
            id_or_mac: [5; 20],
            single_message_size: 25,
            msg_pack_size: 2,
            messages,
            ..OPEN_DRONE_ID_MESSAGE_PACK_DATA::DEFAULT
        };
        let mut remote_id = RemoteId::default();
        let report = remote_id
            .take_pack(&pack, SENDER, &DatumLevels::default(), 100.0)
            .unwrap()
            .unwrap();
        assert_eq!(report.callsign, "234567890");
        assert!((report.place.latitude_deg - 37.5).abs() < 1e-9);
        assert!((report.place.longitude_deg + 122.25).abs() < 1e-9);
        assert!((report.place.altitude_m - 300.0).abs() < 1e-9);
        let velocity = report.velocity_mps.unwrap();
        assert!(
            velocity.distance(Vec3::new(-20.0, 0.0, 2.0)) < 1e-9,
            "{velocity}"
        );
        assert_eq!(report.quality.altitude, AltitudeReference::Ellipsoid);
        // Categories 10 (10 m), 4 (10 m) and 3 (1 m/s).
        assert!((report.quality.position_m - 10.0 / 2.4477).abs() < 1e-9);
        assert_eq!(report.quality.height_m, 10.0);
        // The same again, and older ones, say nothing; later ones are as late as they come.
        assert!(
            remote_id
                .take_pack(&pack, SENDER, &DatumLevels::default(), 101.0)
                .unwrap()
                .is_none()
        );
        let mut later = pack.clone();
        later.messages[46..48].copy_from_slice(&133_u16.to_le_bytes());
        let report = remote_id
            .take_pack(&later, SENDER, &DatumLevels::default(), 104.0)
            .unwrap()
            .unwrap();
        assert!((report.valid_s - 101.0).abs() < 1e-9, "{}", report.valid_s);
        assert!(
            remote_id
                .take_pack(&pack, SENDER, &DatumLevels::default(), 105.0)
                .unwrap()
                .is_none()
        );
    }

    #[test]
    fn locations_that_say_nothing_are_left_out_and_memory_is_bounded() {
        let mut remote_id = RemoteId::default();
        let levels = DatumLevels::default();
        let mut take = |data: OPEN_DRONE_ID_LOCATION_DATA| {
            remote_id.take_location(&data, SENDER, &levels, 1.0)
        };
        let good = OPEN_DRONE_ID_LOCATION_DATA {
            latitude: 375_000_000,
            longitude: -1_222_500_000,
            altitude_barometric: 120.0,
            altitude_geodetic: -1000.0,
            timestamp: 65_535.0,
            direction: 36_100,
            ..OPEN_DRONE_ID_LOCATION_DATA::DEFAULT
        };
        let report = take(good.clone()).unwrap().unwrap();
        assert_eq!(report.quality.altitude, AltitudeReference::Pressure);
        assert_eq!(report.velocity_mps, None);
        let grounded = OPEN_DRONE_ID_LOCATION_DATA {
            status: MavOdidStatus::MAV_ODID_STATUS_GROUND,
            ..good.clone()
        };
        assert_eq!(take(grounded), Ok(None));
        let nowhere = OPEN_DRONE_ID_LOCATION_DATA {
            latitude: 0,
            longitude: 0,
            ..good.clone()
        };
        assert!(take(nowhere).is_err());
        let somewhere_above = OPEN_DRONE_ID_LOCATION_DATA {
            altitude_barometric: f32::NAN,
            ..good.clone()
        };
        let report = take(somewhere_above).unwrap().unwrap();
        assert_eq!(report.quality.altitude, AltitudeReference::Unknown);
        let far_above = OPEN_DRONE_ID_LOCATION_DATA {
            altitude_barometric: 1e9,
            ..good.clone()
        };
        let report = take(far_above).unwrap().unwrap();
        assert_eq!(report.quality.altitude, AltitudeReference::Unknown);
        for n in 0..5000_u32 {
            let mut other = good.clone();
            other.id_or_mac[..4].copy_from_slice(&n.to_be_bytes());
            take(other).unwrap();
        }
        assert!(remote_id.aircraft() <= MOST_AIRCRAFT);
    }

    /// A clock set back by minutes, one that stands, and one that jumps on: a report is missed for 3 s at most.
    #[test]
    fn t4_no_clock_of_a_sender_makes_its_aircraft_vanish() {
        let clocks: [fn(f32) -> f32; 4] = [
            |now_s| {
                if now_s < 20.0 {
                    900.0 + now_s
                } else {
                    400.0 + now_s
                }
            },
            |_| 0.0,
            |now_s| if now_s < 20.0 { now_s } else { 2700.0 + now_s },
            // Past the full hour.
            |now_s| (3580.0 + now_s).rem_euclid(3600.0),
        ];
        for (number, clock_s) in clocks.into_iter().enumerate() {
            let mut remote_id = RemoteId::default();
            let mut heard_s = 0.0;
            for second in 0..60_u8 {
                let now_s = f64::from(second);
                let data = OPEN_DRONE_ID_LOCATION_DATA {
                    latitude: 375_000_000 + 1000 * i32::from(second),
                    longitude: -1_222_500_000,
                    timestamp: clock_s(f32::from(second)),
                    ..OPEN_DRONE_ID_LOCATION_DATA::DEFAULT
                };
                let taken = remote_id.take_location(&data, SENDER, &DatumLevels::default(), now_s);
                if let Some(report) = taken.unwrap() {
                    assert!(now_s - report.valid_s < 2.0, "clock {number}: {report:?}");
                    heard_s = now_s;
                }
                assert!(now_s - heard_s <= CLOCK_S, "clock {number} at {now_s} s");
            }
        }
    }
}

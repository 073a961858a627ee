//! Tracks of many aircraft from the log of a receiver.

use std::io::Read;

use crate::geodesy::{Earth, Geodetic, LocalFrame};
use crate::tally::{LeftOut, Tally};
use crate::traffic::{Altitude, Callsign, TrafficReport, address_in_words, sbs};
use alloc::collections::BTreeMap;
use glam::DVec3;

/// Validity of an altitude, a velocity and a place on the ground for later positions, seconds: a receiver may
/// miss some of an aircraft's messages.
const PART_LIFETIME_S: f64 = 15.0;
/// No aircraft flies faster than this, metres per second, and a position may be off by this, metres.
const FASTEST_MPS: f64 = 1000.0;
const OFF_M: f64 = 2000.0;
/// From one instant alone aircraft fly straight on for this long, with a position each so often, seconds.
const STRAIGHT_S: f64 = 180.0;
const EVERY_S: f64 = 10.0;

/// One aircraft, times strictly increasing.
#[derive(Debug, Clone, PartialEq)]
pub struct ReceivedTrack {
    /// Name of the flight, else the address, else the call sign.
    pub name: String,
    /// Address as in [`TrafficReport::address`], if it has one.
    pub address: Option<u32>,
    /// Call sign; may be empty.
    pub callsign: String,
    /// Whether its altitudes are by pressure, not above the ellipsoid.
    pub is_by_pressure: bool,
    /// Its positions.
    pub heard: Vec<Heard>,
}

/// One report with a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heard {
    /// Time, seconds.
    pub time_s: f64,
    /// Position, with the altitude as the aircraft reports it.
    pub place: Geodetic,
    /// East, north, up at that place, metres per second; `None` if not received.
    pub velocity_mps: Option<DVec3>,
}

impl Heard {
    /// Whether an aircraft gets from here to a later position.
    pub(super) fn reaches(&self, later: &Self) -> bool {
        let farthest_m = FASTEST_MPS * (later.time_s - self.time_s) + OFF_M;
        self.place.distance_m(later.place) <= farthest_m
    }

    /// Later positions of straight flight for a time, seconds; none without a velocity.
    pub(super) fn straight(self, for_s: f64) -> impl Iterator<Item = Self> {
        let frame = LocalFrame::new(self.place, Earth::Wgs84);
        let after_s = (1..).map(|step| f64::from(step) * EVERY_S);
        let after_s = after_s.take_while(move |after_s| *after_s <= for_s);
        after_s.map_while(move |after_s| {
            Some(Self {
                time_s: self.time_s + after_s,
                place: frame.to_geodetic(self.velocity_mps? * after_s),
                velocity_mps: None,
            })
        })
    }
}

/// Who an aircraft is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Who<'a> {
    pub(super) name: &'a str,
    pub(super) address: Option<u32>,
    pub(super) callsign: Option<&'a str>,
    pub(super) is_by_pressure: bool,
}

/// The aircraft of a receiver's log.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Received {
    /// The aircraft with positions in the air, in the order of their names.
    pub tracks: Vec<ReceivedTrack>,
    /// What became of the log's lines or state vectors.
    pub tally: Tally,
    /// What of it is not read, one sentence each.
    pub notes: Vec<String>,
}

/// Collects positions by aircraft.
#[derive(Debug, Default)]
pub(super) struct Collector {
    tracks: BTreeMap<String, ReceivedTrack>,
}

impl Collector {
    /// Adds a position of an aircraft.
    pub(super) fn push(&mut self, who: Who<'_>, heard: Heard) {
        let track = self
            .tracks
            .entry(who.name.to_ascii_lowercase())
            .or_insert_with(|| ReceivedTrack {
                name: who.name.to_owned(),
                address: who.address,
                callsign: String::new(),
                is_by_pressure: who.is_by_pressure,
                heard: Vec::new(),
            });
        if let Some(callsign) = who.callsign.map(str::trim).filter(|text| !text.is_empty()) {
            callsign.clone_into(&mut track.callsign);
        }
        track.heard.push(heard);
    }

    /// The tracks, sorted by time; of several reports of one time the first stays, and what is out of reach of the rest of its track
    /// goes. The tally counts all of them as used.
    pub(super) fn finish(self, mut tally: Tally) -> Received {
        let tracks = self.tracks.into_values().map(|mut track| {
            let mut heard = core::mem::take(&mut track.heard);
            let all = heard.len();
            heard.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
            heard.dedup_by(|later, earlier| later.time_s <= earlier.time_s);
            let apart = heard.len();
            track.heard = in_reach(heard);
            (apart..all).for_each(|_| tally.refuse(LeftOut::SameTime));
            (track.heard.len()..apart).for_each(|_| tally.refuse(LeftOut::Jump));
            track
        });
        Received {
            tracks: tracks.collect(),
            tally,
            notes: Vec::new(),
        }
    }
}

/// At most this many rows of positions are followed; the shortest one makes way.
const ROWS: usize = 32;

/// The longest row of positions, in order of time, each of which is in reach of the one before. However many positions are elsewhere,
/// next to each other or not, they are no part of it. Of a mixture of which no row is more than half, nothing stays.
fn in_reach(heard: Vec<Heard>) -> Vec<Heard> {
    let count = heard.len();
    let mut rows: Vec<Vec<Heard>> = Vec::new();
    for this in heard {
        let reaches = |row: &&mut Vec<Heard>| row.last().is_some_and(|last| last.reaches(&this));
        if let Some(row) = rows.iter_mut().filter(reaches).max_by_key(|row| row.len()) {
            row.push(this);
            continue;
        }
        if rows.len() == ROWS {
            let shortest = (0..).zip(&rows).min_by_key(|(_, row)| row.len());
            rows.remove(shortest.map_or(0, |(index, _)| index));
        }
        rows.push(vec![this]);
    }
    let longest = rows.into_iter().max_by_key(Vec::len);
    let most = longest.filter(|row| 2 * row.len() > count);
    most.unwrap_or_default()
}

impl Received {
    /// Aircraft that were all heard once only, at one instant, fly straight on from there.
    pub(super) fn carried_on(mut self) -> Self {
        if self.tracks.iter().any(|track| track.heard.len() > 1) {
            return self;
        }
        for track in &mut self.tracks {
            if let Some(from) = track.heard.first().copied() {
                track.heard.extend(from.straight(STRAIGHT_S));
            }
        }
        self
    }
}

/// The parts known of one aircraft between its messages, each with its time.
#[derive(Debug, Default)]
struct ReceivedParts {
    altitude: Option<(Altitude, f64)>,
    velocity_mps: Option<([f64; 2], f64)>,
    climb_mps: Option<(f64, f64)>,
    on_ground: Option<(bool, f64)>,
    callsign: Option<Callsign>,
}

impl ReceivedParts {
    fn take(&mut self, report: &TrafficReport, time_s: f64) {
        fn put<T>(part: &mut Option<(T, f64)>, value: Option<T>, time_s: f64) {
            if let Some(value) = value {
                *part = Some((value, time_s));
            }
        }
        put(&mut self.altitude, report.altitude, time_s);
        put(&mut self.velocity_mps, report.ground_velocity_mps(), time_s);
        put(&mut self.climb_mps, report.climb_mps, time_s);
        put(&mut self.on_ground, report.on_ground, time_s);
        self.callsign = report.callsign.or(self.callsign);
    }

    /// A part that is still valid.
    fn valid<T: Copy>(part: Option<(T, f64)>, time_s: f64) -> Option<T> {
        part.filter(|(_, heard_s)| (time_s - heard_s).abs() <= PART_LIFETIME_S)
            .map(|(value, _)| value)
    }

    /// The position in a report; `None` without one.
    fn heard(&self, report: &TrafficReport, time_s: f64) -> Option<Result<Heard, LeftOut>> {
        let [latitude_deg, longitude_deg] = report.place_deg?;
        if Self::valid(self.on_ground, time_s) == Some(true) {
            return Some(Err(LeftOut::OnGround));
        }
        let Some(altitude) = Self::valid(self.altitude, time_s) else {
            return Some(Err(LeftOut::NoAltitude));
        };
        let Some(place) = Geodetic::new(latitude_deg, longitude_deg, altitude.metres()) else {
            return Some(Err(LeftOut::UnreadableField));
        };
        let climb_mps = Self::valid(self.climb_mps, time_s).unwrap_or(0.0);
        let velocity_mps = Self::valid(self.velocity_mps, time_s)
            .map(|[east, north]| DVec3::new(east, north, climb_mps));
        Some(Ok(Heard {
            time_s,
            place,
            velocity_mps,
        }))
    }
}

/// The tracks of a BaseStation log. Aircraft on the ground are left out.
pub(super) fn from_sbs(input: impl Read) -> Received {
    let mut collector = Collector::default();
    let mut aircraft: BTreeMap<u32, ReceivedParts> = BTreeMap::new();
    let mut log = sbs::Log::new(input);
    let mut refused = Tally::default();
    for line in &mut log {
        let Ok(report) = line.report else { continue };
        let parts = aircraft.entry(report.address).or_default();
        parts.take(&report, line.time_s);
        match parts.heard(&report, line.time_s) {
            Some(Ok(heard)) => {
                let who = Who {
                    name: &address_in_words(report.address),
                    address: Some(report.address),
                    callsign: parts.callsign.as_ref().map(Callsign::as_str),
                    is_by_pressure: matches!(parts.altitude, Some((Altitude::Pressure(_), _))),
                };
                collector.push(who, heard);
            }
            Some(Err(reason)) => refused.leave_out(reason),
            None => {}
        }
    }
    let mut tally = log.tally();
    tally.used -= refused.read();
    tally += refused;
    collector.finish(tally)
}

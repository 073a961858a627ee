//! Tracks: reports of the same aircraft joined, aged, extrapolated; keeps the threatening ones.
//!
//! - Each sender has a share of the table. Within it the least urgent track makes room, never
//!   another sender's.
//! - Reports under one key that do not continue each other open a track each, a hypothesis. The companion
//!   avoids all of them until one dies: its reports have ended while another of the same sender goes on.
//! - Work for one report does not grow with the number of tracks, except for the choice of the least
//!   urgent one among at most [`MOST_OF_A_SENDER`].

use alloc::collections::BTreeMap;

use fga::Vec3;
use fga::situation::{Obstacle, ObstacleKind};
use fga_formats::geodesy::LocalFrame;

use super::class::Volumes;
use super::own::{self, FlownWay};
use super::remote_id::RemoteId;
use super::report::{AltitudeReference, PlaceReport, ReportSender, ReportSource, TrackKey};
use super::threat::{TrackUrgency, VolumeReach, WaysAhead};
use super::track::{AircraftTrack, LocalReport, bit};
use super::vertical::{DatumLevels, Shift, taller};
use crate::config::{Config, TrafficConfig};

/// Most tracks of one sender.
pub const MOST_OF_A_SENDER: usize = 512;
/// Senders with a separate share; all others share one, the last.
const MOST_SENDERS: usize = 8;
/// Most tracks.
pub const MOST_TRACKS: usize = MOST_OF_A_SENDER * MOST_SENDERS;
/// Most hypotheses under one key, and under the key of nameless aircraft.
const MOST_HYPOTHESES: usize = 8;
const MOST_UNNAMED: usize = 32;
/// The autopilot's own list does not count after a recent report of another source, seconds.
const BETTER_SOURCE_S: f64 = 3.0;
/// Its positions are at most this late, seconds, and otherwise this far off, metres.
const LIST_LATE_S: f64 = 4.0;
const LIST_OFF_M: f64 = 60.0;
/// Least remaining life of a hypothesis whose reports have ended, seconds.
const SILENT_S: f64 = 3.0;
/// Number of reports that make a line.
const LINE: u32 = 3;
/// Overload ends after this long without, seconds.
const OVERLOAD_S: f64 = 60.0;

/// The request for a list of obstacles.
#[derive(Debug, Clone, Copy)]
pub struct Wanted {
    /// The moment, seconds.
    pub at_s: f64,
    /// Own position, metres.
    pub own_m: Vec3,
    /// Own altitude above mean sea level, metres.
    pub own_altitude_m: f64,
    /// Farther tracks do not count, metres.
    pub within_m: f64,
    /// The protected volumes around them.
    pub volumes: Volumes,
    /// Largest number.
    pub most: usize,
    /// Whether obstacles are as last reported, for a policy that filters by itself, instead of as the track has them.
    pub as_reported: bool,
}

/// All tracks.
#[derive(Debug)]
pub struct TrackTable {
    drop_after_s: f64,
    own_icao: Option<u32>,
    own_callsign: Option<String>,
    tracks: Vec<AircraftTrack>,
    /// Indices in `tracks` of all hypotheses under a key.
    index: BTreeMap<TrackKey, Vec<usize>>,
    senders: [Option<(ReportSender, f64)>; MOST_SENDERS - 1],
    shares: [usize; MOST_SENDERS],
    flown: FlownWay,
    ahead: WaysAhead,
    levels: DatumLevels,
    remote_id: RemoteId,
    /// Own height in the frame and own altitude above mean sea level, metres.
    own_height_m: Option<(f64, f64)>,
    /// The protected volumes around them.
    volumes: Volumes,
    overload_s: Option<f64>,
    overload_told: bool,
    next_id: u32,
}

/// Identifiers from here on are tracks; lower ones are virtual obstacles, the fence and the floor.
const FIRST_ID: u32 = 100_000;

/// What a height that its sender calls geometric may mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Claims {
    /// Every datum, and an altimeter with any ordinary setting.
    All,
    /// Every datum.
    Datums,
}

impl TrackTable {
    /// An empty table.
    pub fn new(config: &TrafficConfig, own_icao: Option<u32>) -> Self {
        Self {
            drop_after_s: config.drop_after_s,
            own_icao,
            own_callsign: config.own_callsign.clone().filter(|name| !name.is_empty()),
            tracks: Vec::new(),
            index: BTreeMap::new(),
            senders: [None; MOST_SENDERS - 1],
            shares: [0; MOST_SENDERS],
            flown: FlownWay::default(),
            ahead: WaysAhead::default(),
            levels: DatumLevels::default(),
            remote_id: RemoteId::default(),
            own_height_m: None,
            volumes: Volumes::new(&Config::default()),
            overload_s: None,
            overload_told: false,
            next_id: FIRST_ID,
        }
    }

    /// The tracks, in no particular order.
    pub fn tracks(&self) -> &[AircraftTrack] {
        &self.tracks
    }

    /// Forgets all tracks: the local frame has changed.
    pub fn clear(&mut self) {
        self.tracks.clear();
        self.index.clear();
        self.shares = [0; MOST_SENDERS];
        self.flown.clear();
        self.ahead = WaysAhead::default();
    }

    /// The track with a number.
    pub fn get(&self, id: u32) -> Option<&AircraftTrack> {
        self.tracks.iter().find(|track| track.id == id)
    }

    /// The transmitters of Remote ID, and the datums of altitudes.
    pub const fn remote_id(&mut self) -> (&mut RemoteId, &DatumLevels) {
        (&mut self.remote_id, &self.levels)
    }

    /// The datums of altitudes.
    pub const fn levels_mut(&mut self) -> &mut DatumLevels {
        &mut self.levels
    }

    /// Sets the vehicle's way from now on, which determines the threats.
    pub fn set_ahead(&mut self, ahead: WaysAhead) {
        self.ahead = ahead;
    }

    /// Whether there is more traffic than the limits: `true` once, when it begins.
    pub fn is_new_overload(&mut self, now_s: f64) -> bool {
        let overloaded = self
            .overload_s
            .is_some_and(|at_s| now_s - at_s < OVERLOAD_S);
        let is_new = overloaded && !self.overload_told;
        self.overload_told = overloaded;
        is_new
    }

    /// Whether a report is too old to use.
    pub fn is_old(&self, report: &PlaceReport, now_s: f64) -> bool {
        now_s - report.valid_s > self.drop_after_s
    }

    /// Indices in `tracks` of all hypotheses under a key.
    fn members(&self, key: TrackKey) -> &[usize] {
        self.index.get(&key).map_or(&[], Vec::as_slice)
    }

    /// All hypotheses under a key.
    fn hypotheses(&self, key: TrackKey) -> impl Iterator<Item = &AircraftTrack> {
        let members = self.members(key).iter();
        members.filter_map(|place| self.tracks.get(*place))
    }

    /// Whether a track of this identity contradicts its own velocity.
    pub fn contradicts_itself(&self, key: TrackKey) -> bool {
        self.hypotheses(key).any(AircraftTrack::contradicts_itself)
    }

    /// Takes a report; `false` if it was nothing new.
    pub fn take(&mut self, report: &PlaceReport, frame: &LocalFrame, now_s: f64) -> bool {
        let position_m = frame.to_local_m(report.place);
        let velocity_mps = report
            .velocity_mps
            .map(|v| frame.velocity_mps(report.place, v));
        let fits = position_m.is_finite()
            && report.valid_s.is_finite()
            && velocity_mps.is_none_or(|v| v.is_finite() && v.length() < 2000.0);
        if !fits || self.is_old(report, now_s) {
            return false;
        }
        let seen = LocalReport {
            valid_s: report.valid_s,
            position_m,
            velocity_mps,
            quality: report.quality,
            source: report.sender.source,
            slot: self.slot(report.sender, now_s),
        };
        let key = report.key();
        if seen.source == ReportSource::AutopilotList && self.is_known_better(key, &seen, now_s) {
            return false;
        }
        let members = self.members(key);
        let best = members
            .iter()
            .filter_map(|place| {
                let misfit = self.tracks.get(*place)?.misfit(&seen)?;
                Some((*place, misfit))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(place, _)| place);
        if let Some(track) = best.and_then(|place| self.tracks.get_mut(place)) {
            if track.callsign.is_empty() {
                track.callsign.clone_from(&report.callsign);
            }
            if track.is_repetition(&seen, now_s) {
                track.doubt(&seen);
                return false;
            }
            return track.update(&seen, now_s);
        }
        let members = self.index.get(&key).map_or(&[][..], Vec::as_slice);
        for place in members {
            if let Some(track) = self.tracks.get_mut(*place)
                && track.is_repetition(&seen, now_s)
            {
                return false;
            }
        }
        self.open(report, key, seen, now_s)
    }

    /// Whether a better source reports the aircraft that the autopilot's list reports late.
    fn is_known_better(&self, key: TrackKey, seen: &LocalReport, now_s: f64) -> bool {
        self.hypotheses(key).any(|track| {
            let off = seen.position_m - track.position_m(now_s);
            track.source != ReportSource::AutopilotList
                && now_s - track.heard_s < BETTER_SOURCE_S
                && libm::hypot(off.x, off.y)
                    < LIST_OFF_M + LIST_LATE_S * track.velocity_mps().length()
        })
    }

    /// The share of a sender's tracks.
    fn slot(&mut self, sender: ReportSender, now_s: f64) -> u8 {
        let known = self
            .senders
            .iter()
            .position(|known| known.is_some_and(|(other, _)| other == sender));
        let free = || {
            self.senders
                .iter()
                .zip(&self.shares)
                .position(|(known, share)| {
                    *share == 0
                        && known.is_none_or(|(_, heard_s)| now_s - heard_s > self.drop_after_s)
                })
        };
        let place = known.or_else(free);
        if let Some(entry) = place.and_then(|place| self.senders.get_mut(place)) {
            *entry = Some((sender, now_s));
        }
        let place = place.unwrap_or(MOST_SENDERS - 1);
        u8::try_from(place).unwrap_or(u8::MAX)
    }

    /// Opens a track, if there is room or a less urgent one of the same sender.
    fn open(&mut self, report: &PlaceReport, key: TrackKey, seen: LocalReport, now_s: f64) -> bool {
        let mut track = AircraftTrack::new(self.next_id, report, seen, now_s);
        track.keep_s = self.urgency(&track, now_s, Claims::All).keep_s();
        let members = self.index.get(&key).map_or(&[][..], Vec::as_slice);
        let most = match key {
            TrackKey::Unnamed(_) => MOST_UNNAMED,
            _ => MOST_HYPOTHESES,
        };
        if members.len() >= most {
            self.overload_s = Some(now_s);
            // A line of reports does not make room for a single one.
            let single = members
                .iter()
                .copied()
                .filter(|place| self.tracks.get(*place).is_some_and(|t| t.hits < LINE))
                .max_by(|a, b| self.kept_s(*a).total_cmp(&self.kept_s(*b)));
            let Some(place) = single else { return false };
            self.remove(place);
        }
        let slot = usize::from(seen.slot);
        if self.shares.get(slot).is_none_or(|n| *n >= MOST_OF_A_SENDER) {
            self.overload_s = Some(now_s);
            let least = self
                .tracks
                .iter()
                .enumerate()
                .filter(|(_, other)| other.slot == seen.slot)
                .max_by(|a, b| a.1.keep_s.total_cmp(&b.1.keep_s))
                .map(|(place, other)| (place, other.keep_s));
            match least {
                Some((place, keep_s)) if keep_s > track.keep_s => self.remove(place),
                _ => return false,
            }
        }
        self.next_id = self.next_id.checked_add(1).unwrap_or(FIRST_ID);
        if let Some(share) = self.shares.get_mut(slot) {
            *share += 1;
        }
        self.index.entry(key).or_default().push(self.tracks.len());
        self.tracks.push(track);
        true
    }

    fn kept_s(&self, place: usize) -> f64 {
        self.tracks
            .get(place)
            .map_or(f64::INFINITY, |track| track.keep_s)
    }

    /// Removes a track; the last one takes its index.
    fn remove(&mut self, place: usize) {
        if place >= self.tracks.len() {
            return;
        }
        let track = self.tracks.swap_remove(place);
        if let Some(share) = self.shares.get_mut(usize::from(track.slot)) {
            *share = share.saturating_sub(1);
        }
        if let Some(members) = self.index.get_mut(&track.key) {
            members.retain(|member| *member != place);
            if members.is_empty() {
                self.index.remove(&track.key);
            }
        }
        let from = self.tracks.len();
        if let Some(moved) = self.tracks.get(place)
            && let Some(members) = self.index.get_mut(&moved.key)
        {
            for member in members.iter_mut().filter(|member| **member == from) {
                *member = place;
            }
        }
    }

    /// The altitude of a track above its datum comes from the height in the frame: the
    /// vehicle's own differs by as much as the positions do.
    fn shift(&self, track: &AircraftTrack, height_m: f64, now_s: f64, claims: Claims) -> Shift {
        let (own_m, own_altitude_m) = self.own_height_m.unwrap_or((height_m, height_m));
        let altitude_m = own_altitude_m + height_m - own_m;
        let mut shift = match (track.altitude_reference(), claims) {
            (AltitudeReference::Geometric, Claims::Datums) => {
                self.levels
                    .geometric_by_datums(altitude_m, own_altitude_m, now_s)
            }
            (reference, _) => self
                .levels
                .shift(reference, altitude_m, own_altitude_m, now_s),
        };
        shift.bound_m += track.height_bound_m(now_s);
        shift
    }

    fn urgency(&self, track: &AircraftTrack, now_s: f64, claims: Claims) -> TrackUrgency {
        let mut position_m = track.position_m(now_s);
        let shift = self.shift(track, position_m.z, now_s, claims);
        position_m.z -= shift.by_m;
        let volume = self.volumes.of(track.class);
        let reach = VolumeReach {
            radius_m: volume.radius_m() + 2.0 * track.sigma_m(now_s),
            half_height_m: volume.half_height_m() + shift.bound_m,
        };
        self.ahead
            .urgency(position_m, track.velocity_mps(), now_s, reach)
    }

    /// Drops tracks that are too old or contradicted, checks which track is our transponder, and orders
    /// the rest by urgency; `own` is the vehicle's position and velocity.
    pub fn tidy(&mut self, now_s: f64, own: Option<(Vec3, Vec3)>) {
        if let Some((own_m, own_mps)) = own {
            self.flown.push(now_s, own_m, own_mps);
        }
        let mut place = 0;
        while let Some(track) = self.tracks.get(place) {
            if track.age_s(now_s) > self.drop_after_s || self.has_ended(track, now_s) {
                self.remove(place);
            } else {
                place += 1;
            }
        }
        for place in 0..self.tracks.len() {
            let Some(track) = self.tracks.get(place) else {
                break;
            };
            let keep_s = self.urgency(track, now_s, Claims::All).keep_s();
            let height_m = track.last_seen().position_m.z;
            let named = self.is_named_own(track);
            let shift = match track.altitude_reference() {
                // A wide bound would make a wingman above or below ours.
                AltitudeReference::Geometric => Some(Shift {
                    by_m: 0.0,
                    bound_m: track.height_bound_m(now_s),
                }),
                AltitudeReference::Unknown if named != Some(true) => None,
                _ => Some(self.shift(track, height_m, now_s, Claims::All)),
            };
            if let Some(track) = self.tracks.get_mut(place) {
                track.keep_s = keep_s;
                if let Some(shift) = shift {
                    check_own(track, &self.flown, shift, named, now_s);
                }
            }
        }
    }

    /// Whether the reports of a hypothesis have ended while its sender's continue with another one.
    fn has_ended(&self, track: &AircraftTrack, now_s: f64) -> bool {
        if now_s - track.heard_s < track.silence_s(SILENT_S) {
            return false;
        }
        self.hypotheses(track.key).any(|other| {
            let goes_on = other.id != track.id && other.heard_s > track.heard_s;
            let same_sender = other.senders & bit(track.last_seen().slot) != 0;
            // A single report is no line, whoever sent it.
            goes_on && other.hits >= LINE && (same_sender || track.hits == 1)
        })
    }

    /// With a configured address, only that aircraft can be ours.
    fn is_named_own(&self, track: &AircraftTrack) -> Option<bool> {
        let by_address = self.own_icao.filter(|_| track.icao != 0);
        let by_callsign = self
            .own_callsign
            .as_ref()
            .is_some_and(|own| *own == track.callsign);
        match by_address {
            Some(own) => Some(own == track.icao),
            None if by_callsign => Some(true),
            None => None,
        }
    }

    /// The tracks as obstacles, at most `wanted.most`: those in conflict with the way ahead first, in
    /// half of the places, then those that could be near soonest.
    pub fn obstacles(&mut self, wanted: &Wanted, into: &mut Vec<Obstacle>) {
        self.volumes = wanted.volumes;
        self.own_height_m = Some((wanted.own_m.z, wanted.own_altitude_m));
        let candidates = |claims| -> Vec<(TrackUrgency, Obstacle)> {
            let others = self.tracks.iter().filter(|track| !track.is_own());
            others
                .filter_map(|track| self.obstacle(track, wanted, claims))
                .collect()
        };
        let mut chosen = candidates(Claims::All);
        if chosen.len() > wanted.most {
            // The volumes that cover every claim of this many aircraft leave no room.
            chosen = candidates(Claims::Datums);
            self.overload_s = Some(wanted.at_s);
            chosen.sort_by(|a, b| a.0.conflict_s.total_cmp(&b.0.conflict_s));
            let firm = chosen
                .iter()
                .take(wanted.most / 2)
                .take_while(|(urgency, _)| urgency.conflict_s.is_finite())
                .count();
            if let Some(rest) = chosen.get_mut(firm..) {
                rest.sort_by(|a, b| a.0.reach_s.total_cmp(&b.0.reach_s));
            }
            chosen.truncate(wanted.most);
        }
        into.extend(chosen.into_iter().map(|(_, obstacle)| obstacle));
    }

    fn obstacle(
        &self,
        track: &AircraftTrack,
        wanted: &Wanted,
        claims: Claims,
    ) -> Option<(TrackUrgency, Obstacle)> {
        let (mut position_m, uncertainty) = if wanted.as_reported {
            track.as_reported(wanted.at_s)
        } else {
            track.smoothed(wanted.at_s)
        };
        let off = position_m - wanted.own_m;
        if libm::hypot(off.x, off.y) > wanted.within_m {
            return None;
        }
        let shift = self.shift(track, position_m.z, wanted.at_s, claims);
        position_m.z -= shift.by_m;
        if (position_m.z - wanted.own_m.z).abs() > wanted.within_m + shift.bound_m {
            return None;
        }
        let obstacle = Obstacle {
            id: track.id,
            position_m,
            velocity_mps: track.velocity_mps(),
            volume: taller(wanted.volumes.of(track.class), shift.bound_m),
            kind: ObstacleKind::Unknown,
            movement: track.movement,
            age_s: (wanted.at_s - track.last_seen().valid_s).max(0.0),
            uncertainty,
        };
        Some((self.urgency(track, wanted.at_s, claims), obstacle))
    }
}

fn check_own(
    track: &mut AircraftTrack,
    flown: &FlownWay,
    shift: Shift,
    named: Option<bool>,
    now_s: f64,
) {
    if named == Some(false) || track.checked {
        return;
    }
    track.checked = true;
    let last = track.last_seen();
    let mut position_m = last.position_m;
    position_m.z -= shift.by_m;
    let seen = own::OwnReport {
        valid_s: last.valid_s,
        position_m,
        velocity_mps: last
            .velocity_mps
            .filter(|_| !track.contradicts_itself())
            .unwrap_or_else(|| track.velocity_mps()),
        height_bound_m: shift.bound_m,
    };
    track.own.check(&seen, flown, named == Some(true), now_s);
}

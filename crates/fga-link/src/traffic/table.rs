//! Tracks: reports of the same aircraft joined, aged, carried forward, and merged.

use fga::Vec3;
use fga::situation::{Movement, Obstacle, ObstacleKind, ProtectedVolume, Uncertainty};
use fga_formats::geodesy::LocalFrame;

use super::report::{Report, Source};
use crate::config::TrafficConfig;

/// Most tracks that are kept; the one that was heard longest ago makes room.
pub const MOST_TRACKS: usize = 512;
/// A report farther than this from where the track should be is not smoothed but believed after
/// two in a row, metres.
const JUMP_M: f64 = 150.0;
/// Part of the difference between report and prediction that is taken over.
const SMOOTHING: f64 = 0.6;
/// The autopilot's own list is not listened to where another source spoke of late, seconds.
const BETTER_SOURCE_S: f64 = 3.0;
/// Two tracks are one aircraft when they stay this close (horizontally, vertically, in velocity)
/// for so long.
const SAME_PLACE_M: f64 = 100.0;
const SAME_HEIGHT_M: f64 = 60.0;
const SAME_VELOCITY_MPS: f64 = 8.0;
const SAME_FOR_S: f64 = 3.0;
/// A received aircraft that flies inside the own one for so long is the own transponder.
const OWN_PLACE_M: f64 = 40.0;
const OWN_HEIGHT_M: f64 = 30.0;
const OWN_VELOCITY_MPS: f64 = 5.0;
const OWN_FOR_S: f64 = 8.0;
/// An aircraft may turn or change speed by this, metres per second squared.
const MANEUVER_MPS2: f64 = 1.5;
/// σ of the position never grows beyond this, metres.
const MOST_SIGMA_M: f64 = 150.0;
/// Part of the age that is not counted: the message is that fresh anyway.
const FRESH_S: f64 = 1.2;

/// One aircraft.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Number in obstacles and logs; never used again.
    pub id: u32,
    /// ICAO address; 0 where unknown.
    pub icao: u32,
    /// Call sign; may be empty.
    pub callsign: String,
    /// Who reported last.
    pub source: Source,
    /// Whether it is the own transponder.
    pub is_own: bool,
    position_m: Vec3,
    velocity_mps: Vec3,
    has_velocity: bool,
    valid_s: f64,
    heard_s: f64,
    sigma_m: f64,
    geometric: bool,
    jumps: u8,
    last_report: (f64, Vec3),
    own_since_s: Option<f64>,
    twin: Option<(u32, f64)>,
}

impl Track {
    /// Where it is at `at_s`, metres, local frame.
    pub fn position_m(&self, at_s: f64) -> Vec3 {
        self.position_m + self.velocity_mps * (at_s - self.valid_s)
    }

    /// Velocity over the ground, metres per second.
    pub const fn velocity_mps(&self) -> Vec3 {
        self.velocity_mps
    }

    /// Time since the last report was true, seconds.
    pub fn age_s(&self, now_s: f64) -> f64 {
        now_s - self.valid_s
    }

    /// σ of the position along an axis at `at_s`, metres: the report's, and what an aircraft may
    /// do since.
    pub fn sigma_m(&self, at_s: f64) -> f64 {
        let age_s = (self.age_s(at_s) - FRESH_S).max(0.0);
        // Half of a t² is the farthest; a third of it as the standard deviation.
        (self.sigma_m + MANEUVER_MPS2 * age_s * age_s / 6.0).min(MOST_SIGMA_M)
    }

    /// Name for the operator: call sign, else address, else number.
    pub fn name(&self) -> String {
        if !self.callsign.is_empty() {
            self.callsign.clone()
        } else if self.icao != 0 {
            format!("{:06X}", self.icao)
        } else {
            format!("#{}", self.id)
        }
    }
}

/// All tracks.
#[derive(Debug)]
pub struct TrackTable {
    drop_after_s: f64,
    own_icao: Option<u32>,
    own_callsign: Option<String>,
    tracks: Vec<Track>,
    next_id: u32,
}

/// Identifiers from here on are tracks; below are virtual obstacles, the fence and the floor.
const FIRST_ID: u32 = 100_000;

impl TrackTable {
    /// An empty table.
    pub fn new(config: &TrafficConfig, own_icao: Option<u32>) -> Self {
        Self {
            drop_after_s: config.drop_after_s,
            own_icao,
            own_callsign: config.own_callsign.clone().filter(|name| !name.is_empty()),
            tracks: Vec::new(),
            next_id: FIRST_ID,
        }
    }

    /// The tracks.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Forgets all tracks.
    pub fn clear(&mut self) {
        self.tracks.clear();
    }

    /// The track with a number.
    pub fn get(&self, id: u32) -> Option<&Track> {
        self.tracks.iter().find(|track| track.id == id)
    }

    /// When anything was last heard, seconds.
    pub fn last_heard_s(&self) -> Option<f64> {
        self.tracks
            .iter()
            .map(|track| track.heard_s)
            .reduce(f64::max)
    }

    /// Takes a report; `false` where it told nothing new.
    pub fn take(&mut self, report: &Report, frame: &LocalFrame, now_s: f64) -> bool {
        let position_m = frame.to_local_m(report.place);
        let velocity = report
            .velocity_mps
            .map(|v| frame.velocity_mps(report.place, v));
        let fits = position_m.is_finite()
            && report.valid_s.is_finite()
            && velocity.is_none_or(|v| v.is_finite() && v.length() < 2000.0);
        if !fits || now_s - report.valid_s > self.drop_after_s {
            return false;
        }
        if let Some(track) = self.find(report) {
            if report.source == Source::AutopilotList
                && track.source != Source::AutopilotList
                && now_s - track.heard_s < BETTER_SOURCE_S
            {
                return false;
            }
            return update(track, report, position_m, velocity, now_s);
        }
        let is_own = self.is_known_own(report);
        if self.tracks.len() >= MOST_TRACKS {
            let oldest = self
                .tracks
                .iter()
                .enumerate()
                .min_by(|a, b| a.1.heard_s.total_cmp(&b.1.heard_s))
                .map(|(index, _)| index);
            if let Some(index) = oldest {
                self.tracks.swap_remove(index);
            }
        }
        let id = self.next_id;
        self.next_id = self.next_id.checked_add(1).unwrap_or(FIRST_ID);
        self.tracks.push(Track {
            id,
            icao: report.icao,
            callsign: report.callsign.clone(),
            source: report.source,
            is_own,
            position_m,
            velocity_mps: velocity.unwrap_or(Vec3::ZERO),
            has_velocity: velocity.is_some(),
            valid_s: report.valid_s,
            heard_s: now_s,
            sigma_m: report.quality.position_m,
            geometric: report.quality.geometric_altitude,
            jumps: 0,
            last_report: (report.valid_s, position_m),
            own_since_s: None,
            twin: None,
        });
        true
    }

    fn find(&mut self, report: &Report) -> Option<&mut Track> {
        self.tracks.iter_mut().find(|track| {
            if report.icao != 0 || track.icao != 0 {
                report.icao == track.icao
            } else {
                // Without an address the call sign has to do.
                !report.callsign.is_empty()
                    && report.callsign == track.callsign
                    && report.source == track.source
            }
        })
    }

    fn is_known_own(&self, report: &Report) -> bool {
        (report.icao != 0 && Some(report.icao) == self.own_icao)
            || (!report.callsign.is_empty() && self.own_callsign.as_ref() == Some(&report.callsign))
    }

    /// Drops what is too old, recognises the own transponder, merges what is one aircraft.
    pub fn tidy(&mut self, now_s: f64, own: Option<(Vec3, Vec3)>) {
        let drop_after_s = self.drop_after_s;
        self.tracks
            .retain(|track| track.age_s(now_s) <= drop_after_s);
        if let Some((own_m, own_mps)) = own {
            for track in &mut self.tracks {
                recognise_own(track, now_s, own_m, own_mps, self.own_icao);
            }
        }
        self.merge(now_s);
    }

    fn merge(&mut self, now_s: f64) {
        let places: Vec<(u32, u32, Source, Vec3, Vec3)> = self
            .tracks
            .iter()
            .map(|t| (t.id, t.icao, t.source, t.position_m(now_s), t.velocity_mps))
            .collect();
        let mut gone = Vec::new();
        for track in &mut self.tracks {
            let here = track.position_m(now_s);
            // Only an older track of another source takes this one over, and never one with an
            // address of its own: two addresses are two aircraft, however close.
            let twin = places.iter().find(|(id, icao, source, place, velocity)| {
                let offset = *place - here;
                *id < track.id
                    && *source != track.source
                    && (*icao == 0 || track.icao == 0)
                    && libm::hypot(offset.x, offset.y) < SAME_PLACE_M
                    && offset.z.abs() < SAME_HEIGHT_M
                    && velocity.distance(track.velocity_mps) < SAME_VELOCITY_MPS
            });
            match (twin, track.twin) {
                (None, _) => track.twin = None,
                (Some(twin), Some((id, since_s))) if id == twin.0 => {
                    if now_s - since_s >= SAME_FOR_S {
                        gone.push((track.id, id, track.icao));
                    }
                }
                (Some(twin), _) => track.twin = Some((twin.0, now_s)),
            }
        }
        for (id, heir, icao) in gone {
            if let Some(heir) = self.tracks.iter_mut().find(|track| track.id == heir)
                && heir.icao == 0
            {
                heir.icao = icao;
            }
            self.tracks.retain(|track| track.id != id);
        }
    }

    /// The tracks as obstacles at `at_s`, nearest first, at most `most`.
    pub fn obstacles(
        &self,
        at_s: f64,
        own_m: Vec3,
        within_m: f64,
        volume: ProtectedVolume,
        most: usize,
        into: &mut Vec<Obstacle>,
    ) {
        let first = into.len();
        for track in self.tracks.iter().filter(|track| !track.is_own) {
            let position_m = track.position_m(at_s);
            if position_m.distance_squared(own_m) > within_m * within_m {
                continue;
            }
            let volume = if track.geometric {
                volume
            } else {
                taller(&volume)
            };
            into.push(Obstacle {
                id: track.id,
                position_m,
                velocity_mps: track.velocity_mps,
                volume,
                kind: ObstacleKind::Unknown,
                uncertainty: Uncertainty {
                    position_m: track.sigma_m(at_s),
                    velocity_mps: 0.0,
                },
                // Whether it carries people is not known.
                movement: Movement::CREWED,
            });
        }
        if let Some(new) = into.get_mut(first..)
            && new.len() > most
        {
            new.sort_by(|a, b| {
                let distance = |o: &Obstacle| o.position_m.distance_squared(own_m);
                distance(a).total_cmp(&distance(b))
            });
            into.truncate(first + most);
        }
    }
}

/// A pressure altitude is off by what the weather makes of it: a cylinder grows by that.
fn taller(volume: &ProtectedVolume) -> ProtectedVolume {
    const PRESSURE_ALTITUDE_M: f64 = 30.0;
    match *volume {
        ProtectedVolume::Sphere { .. } => *volume,
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => ProtectedVolume::Cylinder {
            radius_m,
            half_height_m: half_height_m + PRESSURE_ALTITUDE_M,
        },
    }
}

fn recognise_own(track: &mut Track, now_s: f64, own_m: Vec3, own_mps: Vec3, own_icao: Option<u32>) {
    // Where the own address is known, an aircraft with another one is another aircraft.
    if track.is_own || track.source == Source::Virtual || (own_icao.is_some() && track.icao != 0) {
        return;
    }
    let offset = track.position_m(now_s) - own_m;
    let inside = libm::hypot(offset.x, offset.y) < OWN_PLACE_M
        && offset.z.abs() < OWN_HEIGHT_M
        && track.velocity_mps.distance(own_mps) < OWN_VELOCITY_MPS;
    if !inside {
        track.own_since_s = None;
        return;
    }
    let since_s = *track.own_since_s.get_or_insert(now_s);
    track.is_own = now_s - since_s >= OWN_FOR_S;
}

fn update(
    track: &mut Track,
    report: &Report,
    position_m: Vec3,
    velocity: Option<Vec3>,
    now_s: f64,
) -> bool {
    let (last_s, last_m) = track.last_report;
    if report.valid_s < last_s - 0.5 {
        return false;
    }
    // The same place again from something that moves is an old report sent again.
    let moves = velocity.unwrap_or(track.velocity_mps).length() > 2.0;
    if moves && position_m.distance(last_m) < 0.05 {
        return false;
    }
    let predicted_m = track.position_m(report.valid_s);
    let since_s = report.valid_s - last_s;
    if track.callsign.is_empty() {
        track.callsign.clone_from(&report.callsign);
    }
    match velocity {
        Some(velocity) => track.velocity_mps = velocity,
        None if !track.has_velocity && since_s > 0.3 => {
            let seen = (position_m - last_m) / since_s;
            if seen.length() < 1000.0 {
                let known = track.velocity_mps != Vec3::ZERO;
                let part = if known { 0.4 } else { 1.0 };
                track.velocity_mps += (seen - track.velocity_mps) * part;
            }
        }
        None => {}
    }
    track.has_velocity |= velocity.is_some();
    track.last_report = (report.valid_s, position_m);
    let off = position_m - predicted_m;
    if off.length() > JUMP_M && track.jumps < 1 {
        // One stray position is not believed, two are.
        track.jumps += 1;
        return false;
    }
    let smooth = off.length() <= JUMP_M && track.has_velocity && since_s < 3.0;
    track.jumps = 0;
    track.position_m = if smooth {
        predicted_m + off * SMOOTHING
    } else {
        position_m
    };
    track.valid_s = report.valid_s.max(track.valid_s);
    if smooth {
        track.position_m += track.velocity_mps * (track.valid_s - report.valid_s);
    }
    track.heard_s = now_s;
    track.source = report.source;
    track.sigma_m = report.quality.position_m;
    track.geometric = report.quality.geometric_altitude;
    true
}

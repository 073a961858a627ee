//! One aircraft from one line of reports: extrapolated, smoothed, aged.
//!
//! An address is a claim. Where two lines of reports claim one address, there are two tracks, and
//! each report moves the one that it continues; see [`super::table`].
//!
//! A velocity is a claim too. It counts while the reported positions bear it out; a sender whose velocity
//! contradicts its positions moves as its positions do (`motion`).

use alloc::collections::VecDeque;

use fga::Vec3;
use fga::situation::{Movement, Uncertainty};

use super::class::AircraftClass;
use super::motion::{self, ReportedPlace};
use super::own::OwnTransponder;
use super::report::{AltitudeReference, PlaceReport, Quality, ReportSource, TrackKey};

/// A report continues a track if it is within this distance of it, metres, …
const GATE_M: f64 = 25.0;
/// … plus this many σ, …
const GATE_SIGMAS: f64 = 3.0;
/// … plus the distance flown while a message is on its way, seconds, …
const GATE_DELAY_S: f64 = 0.6;
/// … plus the effect of a turn in the time between, metres per second squared …
const GATE_MPS2: f64 = 5.0;
/// … if the velocity is known; else this speed, metres per second.
const GATE_UNKNOWN_MPS: f64 = 120.0;
/// A report that only this speed connects to the track continues it worse than this, from 0 to 1.
const REACHED_MISFIT: f64 = 0.5;
/// The same for heights, metres and metres per second.
const GATE_HEIGHT_M: f64 = 40.0;
const GATE_CLIMB_MPS: f64 = 20.0;
/// Of two tracks that a report continues, it continues the one with the nearer velocity: a difference up to this, metres
/// per second and metres per second squared, does not show another aircraft.
const GATE_VELOCITY_MPS: f64 = 15.0;
const GATE_TURN_MPS2: f64 = 10.0;
/// Share of the difference between report and prediction that the track takes over.
const SMOOTHING: f64 = 0.6;
/// Share of the mean square of these differences that each report keeps.
const REMEMBERED: f64 = 0.7;
/// An aircraft may turn or change speed by this, metres per second squared.
const MANEUVER_MPS2: f64 = 1.5;
/// Age increases σ of the position up to this, metres.
const MOST_SIGMA_M: f64 = 150.0;
/// Part of the age that does not count: the message is that fresh anyway, seconds.
const FRESH_S: f64 = 1.2;
/// Number of remembered reports for detecting a repetition, and their age, seconds.
const MOST_REMEMBERED: usize = 24;
const REMEMBERED_S: f64 = 10.0;
/// A repetition lies this near to the reported way, metres, with this velocity, metres per
/// second.
const REPEATED_M: f64 = 3.0;
const REPEATED_MPS: f64 = 1.0;
/// Repetitions alone for this long are no repetitions, seconds.
const REPEATED_FOR_S: f64 = 3.0;
/// Slower than this, metres per second, an aircraft may really be at its old place.
const MOVES_MPS: f64 = 2.0;
/// An altitude above the sea holds for this long against a pressure altitude, seconds.
const BETTER_HEIGHT_S: f64 = 3.0;
/// A height is unknown after this long without a report of it, seconds; until then its error grows by this, metres per second.
const HEIGHT_LIFETIME_S: f64 = 15.0;
const HEIGHT_CLIMB_MPS: f64 = 8.0;
/// After a silence of this or three usual intervals, seconds, a report may have waited in a queue: the places before it and the times of
/// those that come with it, within this of each other, seconds, show no motion.
const STALLED_S: f64 = 2.5;
const AT_ONCE_S: f64 = 0.1;
/// Longest usual time between reports, seconds.
const LONGEST_INTERVAL_S: f64 = 5.0;

/// A report in the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalReport {
    pub valid_s: f64,
    pub position_m: Vec3,
    pub velocity_mps: Option<Vec3>,
    pub quality: Quality,
    pub source: ReportSource,
    /// Index of the sender in the table of senders.
    pub slot: u8,
}

/// One aircraft.
#[derive(Debug, Clone, PartialEq)]
pub struct AircraftTrack {
    /// Number in obstacles and logs; never reused.
    pub id: u32,
    /// ICAO address; 0 where unknown.
    pub icao: u32,
    /// Call sign; may be empty.
    pub callsign: String,
    /// Last sender.
    pub source: ReportSource,
    /// Its possible motion.
    pub movement: Movement,
    /// How much room it gets.
    pub class: AircraftClass,
    pub(super) key: TrackKey,
    pub(super) own: OwnTransponder,
    /// The sender that opened it, and all that have continued it, as bits.
    pub(super) slot: u8,
    pub(super) senders: u8,
    /// Reports that continued it.
    pub(super) hits: u32,
    pub(super) heard_s: f64,
    /// The order for keeping it, seconds.
    pub(super) keep_s: f64,
    /// Whether the last report was compared with our own way.
    pub(super) checked: bool,
    position_m: Vec3,
    velocity_mps: Vec3,
    has_velocity: bool,
    valid_s: f64,
    interval_s: f64,
    quality: Quality,
    residual_m2: f64,
    /// σ of an estimated velocity, metres per second.
    estimated_mps: f64,
    /// The velocity that the last positions show, metres per second.
    shown_mps: Option<Vec3>,
    /// Whether the last reported velocity contradicts the positions.
    contradicts: bool,
    height_s: f64,
    last: LocalReport,
    reported: VecDeque<ReportedPlace>,
    repeated_since_s: Option<f64>,
    /// When a report last broke a silence, seconds.
    stall_ended_s: f64,
}

impl AircraftTrack {
    /// A track that begins with a report.
    pub(super) fn new(id: u32, report: &PlaceReport, seen: LocalReport, now_s: f64) -> Self {
        let mut track = Self {
            id,
            icao: report.icao,
            callsign: report.callsign.clone(),
            source: report.sender.source,
            movement: report.movement,
            class: report.class,
            key: report.key(),
            own: OwnTransponder::default(),
            slot: seen.slot,
            senders: bit(seen.slot),
            hits: 1,
            heard_s: now_s,
            keep_s: f64::INFINITY,
            checked: false,
            position_m: seen.position_m,
            velocity_mps: seen.velocity_mps.unwrap_or(Vec3::ZERO),
            has_velocity: seen.velocity_mps.is_some(),
            valid_s: seen.valid_s,
            interval_s: 1.0,
            quality: seen.quality,
            residual_m2: 0.0,
            estimated_mps: 0.0,
            shown_mps: None,
            contradicts: false,
            height_s: seen.valid_s,
            last: seen,
            reported: VecDeque::new(),
            repeated_since_s: None,
            stall_ended_s: f64::NEG_INFINITY,
        };
        track.remember(&seen);
        track
    }

    /// Its position at `at_s`, metres, local frame; its height above its datum.
    pub fn position_m(&self, at_s: f64) -> Vec3 {
        self.position_m + self.velocity_mps * (at_s - self.valid_s)
    }

    /// Velocity over the ground, metres per second.
    pub const fn velocity_mps(&self) -> Vec3 {
        self.velocity_mps
    }

    /// The datum of its altitudes.
    pub const fn altitude_reference(&self) -> AltitudeReference {
        self.quality.altitude
    }

    /// Bound of its altitude's error at `at_s`, metres, besides the error of the datum: it grows while reports have
    /// no altitude.
    pub(super) fn height_bound_m(&self, at_s: f64) -> f64 {
        let unheard_s = if self.last.quality.altitude == AltitudeReference::Unknown {
            (at_s - self.height_s).max(0.0)
        } else {
            0.0
        };
        self.quality.height_m + HEIGHT_CLIMB_MPS * unheard_s
    }

    /// Whether its reported velocity contradicts its reported positions, which then show its motion.
    pub const fn contradicts_itself(&self) -> bool {
        self.contradicts
    }

    /// Whether it counts as our transponder.
    pub const fn is_own(&self) -> bool {
        self.own.holds()
    }

    /// Time since the last report's validity, seconds.
    pub fn age_s(&self, now_s: f64) -> f64 {
        now_s - self.valid_s
    }

    /// σ of the position along an axis at `at_s`, metres: the report's own figure, the distance of reports
    /// from their prediction, and the possible motion of an aircraft since.
    pub fn sigma_m(&self, at_s: f64) -> f64 {
        let age_s = self.age_s(at_s).max(0.0);
        let drift_m = (self.quality.velocity_mps + self.estimated_mps) * age_s;
        let reported_m = libm::sqrt(
            self.quality.position_m * self.quality.position_m
                + self.residual_m2
                + drift_m * drift_m,
        );
        let since_s = (age_s - FRESH_S).max(0.0);
        // Half of a t² is the farthest; a third of it as the standard deviation.
        let grown_m = reported_m + MANEUVER_MPS2 * since_s * since_s / 6.0;
        grown_m.min(MOST_SIGMA_M.max(self.quality.position_m))
    }

    /// σ of the velocity along an axis for the time ahead, metres per second: the reported σ, or
    /// the error of the velocity that the positions show. Zero without a report: then the movement bounds the velocity.
    pub fn velocity_sigma_mps(&self) -> f64 {
        let reported_mps = if self.quality.velocity_sigma_is_known && !self.contradicts {
            self.quality.velocity_mps
        } else {
            0.0
        };
        reported_mps + self.estimated_mps
    }

    /// Its position at `at_s`, metres, and its uncertainty then.
    pub(super) fn smoothed(&self, at_s: f64) -> (Vec3, Uncertainty) {
        let uncertainty = Uncertainty {
            position_m: self.sigma_m(at_s),
            velocity_mps: self.velocity_sigma_mps(),
        };
        (self.position_m(at_s), uncertainty)
    }

    /// The position of its last report carried on to `at_s`, metres, and the errors of that report, those that a receiver assumes too.
    pub(super) fn as_reported(&self, at_s: f64) -> (Vec3, Uncertainty) {
        let last = &self.last;
        let mut position_m = last.position_m + self.velocity_mps * (at_s - last.valid_s);
        if last.quality.altitude != self.quality.altitude {
            position_m.z = self.position_m(at_s).z;
        }
        let uncertainty = Uncertainty {
            // The filter knows of no error of the time.
            position_m: libm::hypot(
                last.quality.position_m,
                motion::TIME_S * self.velocity_mps.length(),
            ),
            velocity_mps: self.reported_velocity_sigma_mps(),
        };
        (position_m, uncertainty)
    }

    /// σ of the last report's velocity along the worst of its axes, metres per second: [`Uncertainty`] has one for all. The velocity that
    /// positions or altitudes show is no second measurement beside them.
    fn reported_velocity_sigma_mps(&self) -> f64 {
        let last = &self.last;
        if last.velocity_mps.is_none() || self.contradicts {
            0.5 * GATE_UNKNOWN_MPS
        } else if last.quality.climb_is_known {
            last.quality.velocity_mps
        } else {
            last.quality.velocity_mps.max(motion::CLIMB_MPS)
        }
    }

    /// Name for the operator: call sign, else address, else number.
    pub fn name(&self) -> String {
        if !self.callsign.is_empty() {
            self.callsign.clone()
        } else if self.icao != 0 {
            fga_formats::traffic::address_in_words(self.icao)
        } else {
            format!("#{}", self.id)
        }
    }

    /// The last report, and whether it had a velocity.
    pub(super) const fn last_seen(&self) -> &LocalReport {
        &self.last
    }

    /// After this time without a report the line has ended if another one of the same sender goes on,
    /// seconds.
    pub(super) fn silence_s(&self, least_s: f64) -> f64 {
        least_s.max(3.0 * self.interval_s)
    }

    /// How badly a report continues this track, from 0 to 1; `None` if it does not.
    pub(super) fn misfit(&self, seen: &LocalReport) -> Option<f64> {
        let apart_s = (seen.valid_s - self.valid_s).abs();
        let misfit = self
            .misfit_from(self.position_m(seen.valid_s), self.velocity_mps, seen)
            .min(self.misfit_from_places(seen));
        if misfit > 1.0 {
            return None;
        }
        let turned = seen
            .velocity_mps
            .zip(self.last.velocity_mps)
            .map_or(0.0, |(velocity_mps, last_mps)| {
                velocity_mps.distance(last_mps)
            });
        let turned = turned / (GATE_VELOCITY_MPS + GATE_TURN_MPS2 * apart_s);
        Some(misfit.max(turned.min(1.0)))
    }

    /// The misfit to a predicted place, metres, and velocity, metres per second; beyond 1 it does not continue it.
    fn misfit_from(&self, predicted_m: Vec3, velocity_mps: Vec3, seen: &LocalReport) -> f64 {
        let apart_s = (seen.valid_s - self.valid_s).abs();
        let speed_mps = velocity_mps.length();
        let moved_m = if self.has_velocity || self.hits > 1 {
            // The turn's effect is at most the distance flown.
            (0.5 * GATE_MPS2 * apart_s * apart_s).min(2.0 * (speed_mps + 10.0) * apart_s)
        } else {
            GATE_UNKNOWN_MPS * apart_s
        };
        let gate_m = self.gate_m(seen) + speed_mps * GATE_DELAY_S + moved_m;
        let off = seen.position_m - predicted_m;
        let misfit = libm::hypot(off.x, off.y) / gate_m;
        misfit.max(self.height_misfit(predicted_m.z, seen))
    }

    /// The misfit to the motion that the positions show, whatever velocity was reported: a second report continues the
    /// first wherever an aircraft can have flown.
    fn misfit_from_places(&self, seen: &LocalReport) -> f64 {
        let since_s = seen.valid_s - self.last.valid_s;
        if let Some(shown_mps) = self.shown_mps {
            let predicted_m = self.last.position_m + shown_mps * since_s;
            return self.misfit_from(predicted_m, shown_mps, seen);
        }
        let off = seen.position_m - self.last.position_m;
        let gate_m = self.gate_m(seen) + GATE_UNKNOWN_MPS * since_s.abs();
        let misfit = libm::hypot(off.x, off.y) / gate_m;
        let misfit = misfit.max(self.height_misfit(self.last.position_m.z, seen));
        REACHED_MISFIT + (1.0 - REACHED_MISFIT) * misfit
    }

    fn gate_m(&self, seen: &LocalReport) -> f64 {
        GATE_M + GATE_SIGMAS * self.quality.position_m.max(seen.quality.position_m)
    }

    fn height_misfit(&self, predicted_m: f64, seen: &LocalReport) -> f64 {
        if seen.quality.altitude != self.quality.altitude {
            return 0.0;
        }
        let apart_s = (seen.valid_s - self.valid_s).abs();
        (seen.position_m.z - predicted_m).abs() / (GATE_HEIGHT_M + GATE_CLIMB_MPS * apart_s)
    }

    /// Whether a report only repeats earlier reports of this track: sent again, or late by a detour. Such a
    /// report has no meaning, unless nothing else comes.
    pub(super) fn is_repetition(&mut self, seen: &LocalReport, now_s: f64) -> bool {
        if !self.repeats(seen) {
            return false;
        }
        if now_s - self.heard_s < REPEATED_FOR_S {
            self.repeated_since_s = None;
            return true;
        }
        let since_s = *self.repeated_since_s.get_or_insert(now_s);
        now_s - since_s < REPEATED_FOR_S
    }

    /// A repetition near the track does not move it, but it may be the truth and the others late.
    pub(super) fn doubt(&mut self, seen: &LocalReport) {
        let off = seen.position_m - self.position_m(seen.valid_s);
        let off_m2 = off.x * off.x + off.y * off.y;
        self.residual_m2 = REMEMBERED * self.residual_m2 + (1.0 - REMEMBERED) * off_m2;
    }

    fn repeats(&self, seen: &LocalReport) -> bool {
        let velocity_mps = seen.velocity_mps.unwrap_or(self.velocity_mps);
        if velocity_mps.length() <= MOVES_MPS {
            return false;
        }
        let same_height = seen.quality.altitude == self.last.quality.altitude;
        let flat = |offset: Vec3| {
            if same_height {
                offset
            } else {
                Vec3::new(offset.x, offset.y, 0.0)
            }
        };
        if flat(seen.position_m - self.last.position_m).length() < 0.05 {
            return true;
        }
        // Along the reported way, behind its end.
        let behind = self.reported.iter().zip(self.reported.iter().skip(1));
        for (from, to) in behind {
            let way = flat(to.position_m - from.position_m);
            let length2 = way.length_squared();
            if to.valid_s - from.valid_s > 3.0 || length2 < 1.0 {
                continue;
            }
            let part = (flat(seen.position_m - from.position_m).dot(way) / length2).clamp(0.0, 1.0);
            let near = flat(seen.position_m - (from.position_m + way * part)).length() < REPEATED_M;
            let is_end = self
                .reported
                .back()
                .is_some_and(|end| flat(seen.position_m - end.position_m).length() < REPEATED_M);
            let same_velocity = seen
                .velocity_mps
                .is_none_or(|v| v.distance(from.velocity_mps) < REPEATED_MPS);
            if near && !is_end && same_velocity {
                return true;
            }
        }
        false
    }

    /// Takes a report that continues this track; `false` if it is older than the known state.
    pub(super) fn update(&mut self, seen: &LocalReport, now_s: f64) -> bool {
        // Another sender's clock may differ.
        if seen.slot == self.last.slot && seen.valid_s < self.last.valid_s - 0.5 {
            return false;
        }
        let since_s = seen.valid_s - self.last.valid_s;
        let off = seen.position_m - self.position_m(seen.valid_s);
        let quiet_s = now_s - self.heard_s;
        if quiet_s > self.silence_s(STALLED_S) {
            self.reported.clear();
            self.stall_ended_s = now_s;
        } else if now_s - self.stall_ended_s < AT_ONCE_S {
            self.reported.pop_back();
        }
        self.take_velocity(seen);
        let new_height = seen.quality.altitude != self.quality.altitude;
        let better_height = self.has_better_height(seen);
        let smooth = self.has_velocity && since_s.abs() < 3.0;
        let predicted_m = self.position_m(seen.valid_s);
        let mut position_m = if smooth {
            seen.position_m - off * (1.0 - SMOOTHING)
        } else {
            seen.position_m
        };
        if new_height {
            position_m.z = if better_height {
                predicted_m.z
            } else {
                seen.position_m.z
            };
        }
        if self.hits > 1 || self.has_velocity {
            let off_m2 = off.x * off.x + off.y * off.y;
            self.residual_m2 = REMEMBERED * self.residual_m2 + (1.0 - REMEMBERED) * off_m2;
        }
        let valid_s = seen.valid_s.max(self.valid_s);
        self.position_m = position_m + self.velocity_mps * (valid_s - seen.valid_s);
        self.valid_s = valid_s;
        let altitude = if new_height && better_height {
            self.quality.altitude
        } else {
            self.height_s = seen.valid_s;
            seen.quality.altitude
        };
        self.quality = Quality {
            altitude,
            height_m: if altitude == seen.quality.altitude {
                seen.quality.height_m
            } else {
                self.quality.height_m
            },
            ..seen.quality
        };
        let heard_after_s = (now_s - self.heard_s).clamp(0.0, LONGEST_INTERVAL_S);
        self.interval_s += 0.2 * (heard_after_s - self.interval_s);
        self.heard_s = now_s;
        self.source = seen.source;
        self.senders |= bit(seen.slot);
        self.hits = self.hits.saturating_add(1);
        self.checked = false;
        self.repeated_since_s = None;
        self.last = *seen;
        self.remember(seen);
        true
    }

    /// Whether the known height counts for longer than the report's: one is missing, or its datum is a claim.
    fn has_better_height(&self, seen: &LocalReport) -> bool {
        let lifetime_s = match (self.quality.altitude, seen.quality.altitude) {
            (AltitudeReference::Unknown, _) => return false,
            (_, AltitudeReference::Unknown) => HEIGHT_LIFETIME_S,
            (AltitudeReference::Geometric, _) => return false,
            (_, AltitudeReference::Geometric) | (AltitudeReference::MeanSeaLevel, _) => {
                BETTER_HEIGHT_S
            }
            _ => return false,
        };
        seen.valid_s - self.height_s < lifetime_s
    }

    /// The reported velocity while the positions bear it out, else the velocity that the positions show.
    fn take_velocity(&mut self, seen: &LocalReport) {
        let place = self.place(seen);
        let places = || self.reported.iter().copied().chain([place]);
        let shown = motion::shown(places, self.quality.position_m.max(seen.quality.position_m));
        self.shown_mps = shown.map(|shown| shown.velocity_mps);
        // Without a new claim the last velocity holds as long as the positions bear it out.
        let held_mps = self.has_velocity.then_some(self.velocity_mps);
        let Some(claimed_mps) = seen.velocity_mps.or(held_mps) else {
            if let Some(shown) = shown {
                self.velocity_mps = shown.velocity_mps;
                self.estimated_mps = shown.sigma_mps;
            }
            return;
        };
        self.has_velocity = true;
        self.velocity_mps = claimed_mps;
        let climb_is_known = seen.velocity_mps.is_none() || seen.quality.climb_is_known;
        if !climb_is_known {
            self.velocity_mps.z = motion::climb_mps(places());
        }
        self.estimated_mps = 0.0;
        self.contradicts = false;
        let Some(shown) = shown else { return };
        let mut false_ways = motion::contradictions(places, &shown);
        false_ways.vertical &= climb_is_known;
        if false_ways.horizontal {
            self.velocity_mps.x = shown.velocity_mps.x;
            self.velocity_mps.y = shown.velocity_mps.y;
            self.estimated_mps = shown.sigma_mps;
        }
        if false_ways.vertical {
            self.velocity_mps.z = shown.velocity_mps.z;
        }
        self.contradicts = false_ways.horizontal || false_ways.vertical;
    }

    fn place(&self, seen: &LocalReport) -> ReportedPlace {
        let mut velocity_mps = seen.velocity_mps.unwrap_or(self.velocity_mps);
        if !seen.quality.climb_is_known {
            velocity_mps.z = self.velocity_mps.z;
        }
        ReportedPlace {
            valid_s: seen.valid_s,
            position_m: seen.position_m,
            velocity_mps,
            altitude: seen.quality.altitude,
        }
    }

    fn remember(&mut self, seen: &LocalReport) {
        let place = self.place(seen);
        self.reported.push_back(place);
        while self.reported.len() > MOST_REMEMBERED
            || self
                .reported
                .front()
                .is_some_and(|place| seen.valid_s - place.valid_s > REMEMBERED_S)
        {
            self.reported.pop_front();
        }
    }
}

pub(super) const fn bit(slot: u8) -> u8 {
    1 << (slot % 8)
}

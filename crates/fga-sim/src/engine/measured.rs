//! What is measured of a flight: the separations from the obstacles and the length of the path, the times of events, and
//! its result.
//!
//! A straight arc goes on from decision to decision. It is measured as a whole, once it has ended: a flight measures the
//! same whether its decisions are made one by one or known ones are left out.

use fga::Vec3;
use fga::avoider::{Decision, Reason, State};
use fga_judge::ground::GroundSeparation;
use fga_judge::zone;

use crate::plant::Arc;
use crate::progress::MissionProgress;
use crate::separation::{Least, Separation};
use crate::world::World;

/// The measurements of a flight.
#[derive(Debug, Clone, Default)]
pub(super) struct Measured {
    pub(super) separations: Vec<Separation>,
    pub(super) from_zones: Vec<Least>,
    pub(super) from_ground: Option<GroundSeparation>,
    /// A straight arc that may go on, and its end.
    pub(super) straight: Option<(Arc, Vec3)>,
    /// Path over the ground, metres.
    pub(super) flown_m: f64,
}

impl Measured {
    /// Measures the start of a flight.
    pub(super) fn begin(&mut self, world: &World) {
        let at_m = world.start.position_m;
        self.separations.clear();
        self.separations
            .extend(world.obstacles.iter().map(|obstacle| {
                let mut separation = Separation::new(obstacle.volume);
                if let Some((position_m, _)) = obstacle.track.at(0.0) {
                    separation.observe_moment(0.0, at_m - position_m);
                }
                separation
            }));
        self.from_zones.clear();
        let from_zones = world.zones.iter().map(|zone| Least {
            value_m: zone.margin_m(at_m),
            time_s: 0.0,
        });
        self.from_zones.extend(from_zones);
        let ground = world.ground.as_ref();
        self.from_ground =
            ground.map(|ground| GroundSeparation::begun(|at_m| ground.above_m(at_m), at_m));
        (self.straight, self.flown_m) = (None, 0.0);
    }

    /// Takes an arc and its end, in order; a straight one again as it goes on.
    pub(super) fn take(&mut self, world: &World, arc: &Arc, end_m: Vec3) {
        let goes_on = |(before, _): &(Arc, Vec3)| before.start_s == arc.start_s;
        if !self.straight.as_ref().is_some_and(goes_on) {
            self.end(world);
        }
        if arc.is_straight() {
            self.straight = Some((*arc, end_m));
        } else {
            self.measure(world, arc, end_m);
        }
    }

    /// Measures a straight arc that has ended.
    pub(super) fn end(&mut self, world: &World) {
        if let Some((arc, end_m)) = self.straight.take() {
            self.measure(world, &arc, end_m);
        }
    }

    fn measure(&mut self, world: &World, arc: &Arc, end_m: Vec3) {
        self.flown_m += if arc.wind_mps == Vec3::ZERO {
            arc.airspeed_mps * arc.duration_s
        } else {
            arc.position_m.distance(end_m)
        };
        for (separation, obstacle) in self.separations.iter_mut().zip(&world.obstacles) {
            separation.observe(arc, end_m, &obstacle.track);
        }
        for (least, zone) in self.from_zones.iter_mut().zip(&world.zones) {
            zone::observe(least, &zone.zone(), arc, end_m);
        }
        if let (Some(separation), Some(ground)) = (self.from_ground.as_mut(), &world.ground) {
            separation.observe(|at_m| ground.above_m(at_m), arc);
        }
    }

    /// The result of a flight that has ended and missed a number of waypoints.
    pub(super) fn outcome(
        &self,
        end_s: f64,
        milestones: &Milestones,
        progress: &MissionProgress,
        missed: usize,
    ) -> Outcome {
        let separations = self.separations.iter();
        let least = |value: fn(&Separation) -> f64| {
            separations.clone().map(value).fold(f64::INFINITY, f64::min)
        };
        Outcome {
            min_separation_m: least(|s| s.distance().value_m),
            min_margin_m: least(|s| s.margin().value_m),
            threat_s: milestones.threat_s,
            start_s: milestones.start_s,
            clear_s: milestones.clear_s,
            rejoined_s: milestones.rejoined_s,
            max_cross_track_m: progress.max_cross_track_m(),
            extra_path_m: self.flown_m - progress.along_m(),
            end_s,
            mission_flown: missed == 0 && progress.is_at_end(),
            waypoints_missed: missed,
            min_terrain_clearance_m: self.from_ground.map(|ground| ground.least.value_m),
            min_zone_margin_m: (self.from_zones.iter())
                .map(|least| least.value_m)
                .reduce(f64::min),
            work_most: milestones.work_most,
        }
    }
}

/// Times of events.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Milestones {
    threat_s: Option<f64>,
    start_s: Option<f64>,
    clear_s: Option<f64>,
    rejoined_s: Option<f64>,
    /// Whether the pilot says that it is back, which counts once the track is.
    says_back: bool,
    /// Whether the pilot says that it has passed the last waypoint.
    pub(super) says_flown: bool,
    pub(super) last: State,
    work_most: u32,
}

impl Milestones {
    pub(super) fn note(&mut self, time_s: f64, decision: &Decision) {
        let state = decision.state;
        if state != State::Cruise && self.threat_s.is_none() {
            self.threat_s = Some(time_s);
        }
        if state == State::Avoiding && self.last != State::Avoiding {
            self.start_s.get_or_insert(time_s);
            self.clear_s = None;
            self.rejoined_s = None;
            self.says_back = false;
        }
        if self.last == State::Avoiding && state != State::Avoiding {
            self.clear_s = Some(time_s);
        }
        let away = self.last.is_away();
        if away && !state.is_away() {
            self.rejoined_s = None;
            self.says_back = true;
        } else if state.is_away() {
            self.says_back = false;
        }
        self.says_flown = decision.record.reason == Reason::MissionComplete;
        self.last = state;
        self.work_most = self.work_most.max(decision.record.work.work);
    }

    /// The pilot says that it is back, and the track says so too.
    pub(super) fn confirm(&mut self, time_s: f64, is_on_line: bool) {
        if self.says_back && is_on_line && self.rejoined_s.is_none() {
            self.rejoined_s = Some(time_s);
        }
    }
}

/// The result of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Least distance to the centre of any obstacle, metres; infinite without obstacles.
    pub min_separation_m: f64,
    /// Least signed distance to any protected volume, metres; infinite without obstacles.
    pub min_margin_m: f64,
    /// First time with a known threat, seconds.
    pub threat_s: Option<f64>,
    /// Start of the first manoeuvre, seconds.
    pub start_s: Option<f64>,
    /// End of the last manoeuvre, seconds.
    pub clear_s: Option<f64>,
    /// Time at which the aircraft was back on its mission for the last time, seconds.
    pub rejoined_s: Option<f64>,
    /// Largest distance from the mission, horizontal and vertical together, metres.
    pub max_cross_track_m: f64,
    /// Path flown less progress along the mission, metres.
    pub extra_path_m: f64,
    /// End of the flight, seconds.
    pub end_s: f64,
    /// Whether the aircraft flew the mission to its end and missed no waypoint.
    pub mission_flown: bool,
    /// Number of passed waypoints that it passed farther away than planned.
    pub waypoints_missed: usize,
    /// Least height above the ground where it is known, metres; `None` in a world without ground.
    pub min_terrain_clearance_m: Option<f64>,
    /// Least signed distance from the zones, metres, negative on the wrong side; `None` in a world without zones.
    pub min_zone_margin_m: Option<f64>,
    /// Largest work of a decision, in units of the core's meter; 0 for a pilot that counts none.
    pub work_most: u32,
}

impl Outcome {
    /// Whether the flight entered no protected volume.
    pub fn separated(&self) -> bool {
        self.min_margin_m >= 0.0
    }

    /// Largest work of a decision, in units of the core's meter; `None` for a pilot that counts none.
    pub fn work(&self) -> Option<f64> {
        (self.work_most > 0).then(|| f64::from(self.work_most))
    }
}

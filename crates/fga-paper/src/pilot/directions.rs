//! Algorithms 1–3, corrected and as printed.
//!
//! The paper leaves some points open; here the start counts from the first sight of a threat; while
//! avoiding, a new choice replaces a direction that no longer clears the obstacles; an obstacle has
//! passed once it no longer closes; Algorithm 3 may return to points of the legs ahead, two turn radii
//! apart, and to the waypoints.

use fga::Vec3;
use fga::angle::direction;
use fga::assumptions::Assumptions;
use fga::avoider::{Against, Decision, Reason, Start, State, Threat};
use fga::certificate::{Hazard, certify_set};
use fga::limit::Limit as _;
use fga::maneuver::{Maneuver, Stage};
use fga::meter::Meter;
use fga::prediction::MotionState;
use fga::situation::{ObstacleKind, Situation};

use super::{Edition, PaperPilot, Planned, threat};
use crate::classification::safety_score;
use crate::conflict::{Relative, threatens};
use crate::dubins::{ClimbLimits, DubinsPath, SegmentKind};
use crate::grid::{Grid, select};
use crate::printed;
use crate::timing::{Geometry, Times};
use crate::waypoint::{Reach, next_waypoint};

/// Most points for Algorithm 3.
const MAX_POINTS: usize = 24;

/// How far from a point's altitude a path back may end, metres.
const ALTITUDE_TOLERANCE_M: f64 = 10.0;

impl PaperPilot {
    pub(super) fn step_directions(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        edition: Edition,
        start: Start,
    ) -> Decision {
        match self.state {
            State::Cruise | State::Threatened => self.detect(situation, now, edition, start),
            State::Avoiding => self.hold_direction(situation, now, edition, start),
            State::Recovering => self.fly_back(situation, now, |pilot| {
                pilot.detect(situation, now, edition, start)
            }),
        }
    }

    /// Algorithm 1, and the start of Algorithm 2.
    fn detect(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        edition: Edition,
        start: Start,
    ) -> Decision {
        let time_s = situation.time_s;
        let nominal = self.guidance(situation, now);
        let known = self.plan.filter(|_| self.state == State::Threatened);
        let mut start_s = known.map_or(f64::INFINITY, |plan| plan.start_s);
        let old = known.map_or_else(Against::default, |plan| plan.against);
        let mut against = Against::default();
        let mut first: Option<Threat> = None;
        let own = situation.ownship;
        for (obstacle, kind) in self.around.iter() {
            let Some(relative) = Relative::of(&own, obstacle) else {
                continue;
            };
            let Some(threat) = threat(&relative, obstacle, edition) else {
                continue;
            };
            against.add(obstacle.id());
            if !old.contains(obstacle.id()) {
                let wait_s = self.start_of(&relative, (obstacle, kind), edition, start);
                start_s = start_s.min(time_s + wait_s.max(0.0));
            }
            if first.is_none_or(|known| threat.entry_s < known.entry_s) {
                first = Some(threat);
            }
        }
        let Some(threat) = first else {
            self.state = State::Cruise;
            self.plan = None;
            return self.decision(&nominal, Reason::Clear);
        };
        let plan = Planned {
            maneuver: nominal,
            decided_s: time_s,
            start_s,
            joined_s: f64::INFINITY,
            clears: false,
            margin_m: f64::NEG_INFINITY,
            cost: 0.0,
            latest_start_s: None,
            threat: Some(threat),
            against,
        };
        self.plan = Some(plan);
        let wait_s = start_s - time_s;
        if wait_s >= self.settings.decision_period_s {
            self.state = State::Threatened;
            return self.report(&plan, time_s, Reason::WaitingForStart);
        }
        self.state = State::Avoiding;
        self.choose_direction(
            situation,
            now,
            edition,
            wait_s.max(0.0),
            Reason::ManeuverChosen,
        )
    }

    /// Start of an obstacle's manoeuvre, seconds from now (Eq. 18–21, §3.3).
    fn start_of(
        &self,
        relative: &Relative,
        (obstacle, kind): (&Hazard, ObstacleKind),
        edition: Edition,
        start: Start,
    ) -> f64 {
        let score = match start {
            Start::Free | Start::AtDetection => return 0.0,
            Start::Latest => safety_score(kind, 1.0),
            Start::Score(score) => safety_score(kind, score),
        };
        let response = self.vehicle.response;
        let radius_m = self.flyer.turn_radius_m();
        match edition {
            Edition::AsPrinted => {
                let bias = relative.bias_rad().unwrap_or(0.0);
                let (distance, speed) = (relative.distance_m(), relative.speed_mps());
                let protected_m = obstacle.volume.radius_m();
                score * printed::critical_s(distance, bias, radius_m, protected_m, speed)
            }
            Edition::Corrected => {
                let response_s = response.dead_time_s + response.bank_time_constant_s;
                Geometry::of(relative, &obstacle.volume)
                    .and_then(|geometry| Times::of(&geometry, radius_m, response_s))
                    .map_or(0.0, |times| score * times.command_s)
            }
        }
    }

    /// Algorithm 2: the cheapest direction that clears every obstacle.
    fn choose_direction(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        edition: Edition,
        wait_s: f64,
        reason: Reason,
    ) -> Decision {
        let Some(plan) = self.plan else {
            return self.decision(&Maneuver::hold(), Reason::BestAvailable);
        };
        let own = situation.ownship;
        let grid = Grid {
            heading_range_rad: self.settings.grid.heading_range_rad,
            heading_step_rad: self.settings.grid.heading_step_rad,
            climb_min_rad: self.vehicle.climb_min_rad,
            climb_max_rad: self.vehicle.climb_max_rad,
            pitch_step_rad: self.settings.grid.pitch_step_rad,
            heading_cost: self.settings.heading_cost,
            pitch_cost: self.settings.pitch_cost,
            margin_m: self.settings.margin_m,
            ..Grid::default()
        };
        let chosen = match edition {
            Edition::Corrected => {
                select(&grid, &own, self.around.hazards(), wait_s).map(|choice| {
                    let entry = *choice.entry();
                    let turn_rad = entry.heading_change_rad;
                    (
                        turn_rad,
                        entry.climb_rad,
                        entry.cost,
                        entry.margin_m,
                        entry.clears,
                    )
                })
            }
            Edition::AsPrinted => {
                let grid = printed::LiteralGrid {
                    heading_range_rad: grid.heading_range_rad,
                    pitch_range_rad: grid.climb_max_rad,
                    heading_cost: grid.heading_cost,
                    pitch_cost: grid.pitch_cost,
                    ..printed::LiteralGrid::default()
                };
                printed::select(&grid, &own, self.around.hazards()).map(|entry| {
                    let turn_rad = entry.course_rad - own.course_rad;
                    (
                        turn_rad,
                        entry.climb_rad,
                        entry.cost,
                        f64::INFINITY,
                        entry.marked,
                    )
                })
            }
        };
        let Some((turn_rad, climb_rad, cost, margin_m, clears)) = chosen else {
            return self.decision(&Maneuver::hold(), Reason::BestAvailable);
        };
        let maneuver = Maneuver::turn(wait_s, now.course_rad + turn_rad, climb_rad);
        let time_s = situation.time_s;
        let plan = Planned {
            maneuver,
            decided_s: time_s,
            clears,
            margin_m,
            cost,
            ..plan
        };
        self.plan = Some(plan);
        let reason = if clears {
            reason
        } else {
            Reason::BestAvailable
        };
        self.report(&plan, time_s, reason)
    }

    /// Holds the direction until the obstacles have passed; chooses again if it no longer clears them.
    fn hold_direction(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        edition: Edition,
        start: Start,
    ) -> Decision {
        let time_s = situation.time_s;
        let Some(plan) = self.plan else {
            self.state = State::Cruise;
            return self.detect(situation, now, edition, start);
        };
        let own = situation.ownship;
        let velocity = own.velocity_mps();
        let passed = self
            .around
            .hazards()
            .iter()
            .filter(|obstacle| plan.against.contains(obstacle.id()))
            .all(|obstacle| {
                let offset = obstacle.position_m - own.position_m;
                offset.dot(velocity - obstacle.velocity_mps) <= 0.0
            });
        if passed && let Some(back) = self.back_to_waypoint(situation, edition, &plan) {
            self.plan = Some(back);
            self.state = State::Recovering;
            return self.report(&back, time_s, Reason::RejoinChosen);
        }
        let remaining = plan.remaining(time_s);
        let Some(flown) = remaining.stages().last().copied() else {
            return self.report(&plan, time_s, Reason::ManeuverKept);
        };
        let started = time_s >= plan.start_s;
        let velocity_mps = direction(flown.course_rad, flown.climb_rad) * own.airspeed_mps;
        let mut against = plan.against;
        let mut clear = true;
        for obstacle in self.around.hazards() {
            let offset = obstacle.position_m - own.position_m;
            let relative = Relative::new(offset, velocity_mps - obstacle.velocity_mps);
            if relative.is_some_and(|relative| threatens(&relative, &obstacle.volume)) {
                clear = false;
                if !against.contains(obstacle.id()) {
                    against.add(obstacle.id());
                }
            }
        }
        if clear || !started || edition == Edition::AsPrinted {
            return self.report(&plan, time_s, Reason::ManeuverKept);
        }
        self.plan = Some(Planned { against, ..plan });
        self.choose_direction(situation, now, edition, 0.0, Reason::ManeuverReplaced)
    }

    /// Points of the mission ahead of the aircraft, nearest first: every `spacing_m` along the present leg, then the
    /// waypoints. Returns the number of filled `points`.
    fn points_ahead(
        &self,
        situation: &Situation<'_>,
        spacing_m: f64,
        points: &mut [Vec3; MAX_POINTS],
    ) -> usize {
        let leg = self.progress.leg(&MotionState::of(&situation.ownship));
        let from_m = leg.position(situation.ownship.position_m, 0.0).along_m;
        // The last ones are the waypoints'.
        let along = (1u32..)
            .map(|k| from_m + f64::from(k) * spacing_m)
            .take(MAX_POINTS * 2 / 3)
            .take_while(|along_m| *along_m < leg.length_m)
            .map(|along_m| leg.point_m(along_m));
        let waypoints = situation.mission.waypoints_m.iter().copied();
        let ahead = along.chain(waypoints.skip(self.progress.index() + 1));
        points
            .iter_mut()
            .zip(ahead)
            .fold(0, |count, (slot, point)| {
                *slot = point;
                count + 1
            })
    }

    /// Algorithm 3: the next point of the mission that a Dubins path reaches.
    fn back_to_waypoint(
        &mut self,
        situation: &Situation<'_>,
        edition: Edition,
        plan: &Planned,
    ) -> Option<Planned> {
        let own = situation.ownship;
        let radius_m = self.flyer.turn_radius_m();
        let mut points = [Vec3::ZERO; MAX_POINTS];
        let count = self.points_ahead(situation, 2.0 * radius_m, &mut points);
        let margin_m = match edition {
            Edition::Corrected => self.settings.margin_m,
            // Every waypoint passes line 4 as printed.
            Edition::AsPrinted => -1e9,
        };
        let reach = Reach {
            turn_radius_m: radius_m,
            climb: ClimbLimits {
                min_rad: self.vehicle.climb_min_rad,
                max_rad: self.vehicle.climb_max_rad,
                may_circle: false,
            },
            altitude_tolerance_m: ALTITUDE_TOLERANCE_M,
            margin_m,
        };
        let next = next_waypoint(&reach, &own, points.get(..count)?, self.around.hazards())?;
        let duration_s = next.path.duration_s(own.airspeed_mps);
        Some(Planned {
            maneuver: along(&next.path, own.course_rad, own.airspeed_mps, radius_m),
            decided_s: situation.time_s,
            joined_s: situation.time_s + duration_s,
            clears: true,
            ..*plan
        })
    }

    /// Flies a way back to its end, then continues with `detect`.
    fn fly_back(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        detect: impl FnOnce(&mut Self) -> Decision,
    ) -> Decision {
        let time_s = situation.time_s;
        if let Some(plan) = self.plan
            && time_s < plan.joined_s
        {
            let left_s = plan.joined_s - time_s;
            self.path
                .predict(&self.flyer, now, &plan.remaining(time_s), left_s);
            self.load_tracks(situation);
            let hazards = self.tracks.rows();
            let ahead = certify_set(
                &self.flyer,
                &self.path,
                &Assumptions::only(hazards),
                (left_s, 0.0, 0.0),
                &Meter::unlimited(),
            );
            if ahead.margin_m >= 0.0 {
                return self.report(&plan, time_s, Reason::RejoinKept);
            }
        }
        self.plan = None;
        self.state = State::Cruise;
        let mut decision = detect(self);
        if decision.record.reason == Reason::Clear {
            decision.record.reason = Reason::Rejoined;
        }
        decision
    }
}

/// A Dubins path as a manoeuvre of an aircraft on `course_rad`.
fn along(path: &DubinsPath, course_rad: f64, airspeed_mps: f64, least_radius_m: f64) -> Maneuver {
    let climb_rad = path.climb_rad();
    let level_mps = airspeed_mps * libm::cos(climb_rad);
    let rate_share = (libm::cos(climb_rad) * least_radius_m / path.radius_m()).limited(0.0, 1.0);
    let mut maneuver = Maneuver::hold();
    let (mut at_s, mut course_rad) = (0.0, course_rad);
    for segment in path.segments() {
        let turn_rad = segment.length_m / path.radius_m();
        course_rad += match segment.kind {
            SegmentKind::Straight => 0.0,
            SegmentKind::Turn(side) => side.sign() * turn_rad,
        };
        if segment.length_m > 0.0 {
            maneuver.push(Stage {
                start_s: at_s,
                course_rad,
                climb_rad,
                rate_share,
            });
            at_s += segment.length_m / level_mps;
        }
    }
    maneuver.push(Stage {
        start_s: at_s,
        course_rad,
        climb_rad: 0.0,
        rate_share,
    });
    maneuver
}

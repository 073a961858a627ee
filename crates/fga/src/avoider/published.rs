//! The published policies: Algorithms 1–3 corrected and as printed, and the turn round a static
//! obstacle of Fig. 8 and Algorithm 4.
//!
//! What the paper leaves open is settled here: the start is counted from the first sight of a
//! threat; while avoiding, a direction that no longer clears the obstacles is chosen anew; an
//! obstacle has passed once it no longer closes; the points that Algorithm 3 may return to are
//! points of the legs ahead, two turn radii apart, and the waypoints.

use crate::Vec3;
use crate::angle::{Side, direction};
use crate::avoider::{Against, Avoider, Decision, Plan, Reason, Start, State, Threat};
use crate::certificate::certify_set;
use crate::conflict::{Conflict, Relative, assess, detect, threatens};
use crate::limit::Limit as _;
use crate::maneuver::{Maneuver, Stage};
use crate::paths::RoundObstacle;
use crate::prediction::MotionState;
use crate::recovery::dubins::{ClimbLimits, DubinsPath, SegmentKind};
use crate::recovery::waypoint::{Reach, next_waypoint};
use crate::search::Proof;
use crate::selection::{literal, published};
use crate::situation::Situation;
use crate::situation::{Motion, Obstacle, Ownship};
use crate::timing::{Geometry, Times};

/// Most points that Algorithm 3 looks at.
const MAX_POINTS: usize = 24;

/// Speed up to which an obstacle counts as static, metres per second.
const STATIC_MPS: f64 = 0.1;

/// How far from a point's altitude a path back may end, metres.
const ALTITUDE_TOLERANCE_M: f64 = 10.0;

/// Which formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edition {
    /// With the errata applied.
    Corrected,
    /// As printed.
    Literal,
}

impl Avoider {
    pub(super) fn step_published(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        edition: Edition,
        start: Start,
    ) -> Decision {
        self.load_tracks(situation);
        match self.state {
            State::Cruise | State::Threatened => self.detect(situation, now, edition, start),
            State::Avoiding => self.hold_direction(situation, now, edition, start),
            State::Recovering => self.fly_back(situation, now, |avoider| {
                avoider.detect(situation, now, edition, start)
            }),
        }
    }

    /// The aircraft in the air mass.
    fn own(situation: &Situation<'_>) -> Ownship {
        situation.ownship
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
        let (nominal, _) = self.guidance(situation, now);
        let known = self.plan.filter(|_| self.state == State::Threatened);
        let mut start_s = known.map_or(f64::INFINITY, |plan| plan.start_s);
        let old = known.map_or_else(Against::default, |plan| plan.against);
        let mut against = Against::default();
        let mut first: Option<Threat> = None;
        let own = Self::own(situation);
        for obstacle in self.tracks.obstacles() {
            let Some(relative) = Relative::of(&own, obstacle) else {
                continue;
            };
            let Some(threat) = threat(&relative, obstacle, edition) else {
                continue;
            };
            against.add(obstacle.id);
            if !old.contains(obstacle.id) {
                let wait_s = self.start_of(&relative, obstacle, edition, start);
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
        let plan = Plan {
            maneuver: nominal,
            decided_s: time_s,
            start_s,
            joined_s: f64::INFINITY,
            proof: Proof::Open,
            open_since_s: f64::INFINITY,
            picture: self.tracks.picture(),
            margin_m: f64::NEG_INFINITY,
            cost: 0.0,
            latest_start_s: None,
            threat: Some(threat),
            next_start_s: None,
            basis: None,
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

    /// When an obstacle's manoeuvre begins, seconds from now (Eq. 18–21, §3.3).
    fn start_of(
        &self,
        relative: &Relative,
        obstacle: &Obstacle,
        edition: Edition,
        start: Start,
    ) -> f64 {
        let score = match start {
            Start::Free | Start::AtDetection => return 0.0,
            Start::Latest => obstacle.kind.safety_score(1.0),
            Start::Score(score) => obstacle.kind.safety_score(score),
        };
        let response = self.vehicle.response;
        let radius_m = self.flyer.airspeed_mps() / self.flyer.course_rate_radps();
        match edition {
            Edition::Literal => {
                let bias = relative.bias_rad().unwrap_or(0.0);
                let (distance, speed) = (relative.distance_m(), relative.speed_mps());
                let protected_m = obstacle.volume.radius_m();
                score * literal::critical_s(distance, bias, radius_m, protected_m, speed)
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
        let own = Self::own(situation);
        let grid = published::Grid {
            heading_range_rad: self.settings.grid_heading_range_rad,
            heading_step_rad: self.settings.grid_heading_step_rad,
            climb_min_rad: self.vehicle.climb_min_rad,
            climb_max_rad: self.vehicle.climb_max_rad,
            pitch_step_rad: self.settings.grid_pitch_step_rad,
            heading_cost: self.settings.heading_cost,
            pitch_cost: self.settings.pitch_cost,
            margin_m: self.settings.margin_m,
            ..published::Grid::default()
        };
        let chosen = match edition {
            Edition::Corrected => published::select(&grid, &own, self.tracks.obstacles(), wait_s)
                .map(|choice| {
                    let entry = *choice.entry();
                    let turn_rad = entry.heading_change_rad;
                    (
                        turn_rad,
                        entry.climb_rad,
                        entry.cost,
                        entry.margin_m,
                        entry.clears,
                    )
                }),
            Edition::Literal => {
                let grid = literal::LiteralGrid {
                    heading_range_rad: grid.heading_range_rad,
                    pitch_range_rad: grid.climb_max_rad,
                    heading_cost: grid.heading_cost,
                    pitch_cost: grid.pitch_cost,
                    ..literal::LiteralGrid::default()
                };
                literal::select(&grid, &own, self.tracks.obstacles()).map(|entry| {
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
        let plan = Plan {
            maneuver,
            decided_s: time_s,
            proof: if clears {
                Proof::Certified
            } else {
                Proof::Open
            },
            open_since_s: f64::INFINITY,
            picture: self.tracks.picture(),
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

    /// Holds the direction until the obstacles have passed; chooses anew where it no longer clears.
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
        let own = Self::own(situation);
        let velocity = own.velocity_mps();
        let passed = self
            .tracks
            .obstacles()
            .iter()
            .filter(|obstacle| plan.against.contains(obstacle.id))
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
        for obstacle in self.tracks.obstacles() {
            let offset = obstacle.position_m - own.position_m;
            let relative = Relative::new(offset, velocity_mps - obstacle.velocity_mps);
            if relative.is_some_and(|relative| threatens(&relative, &obstacle.volume)) {
                clear = false;
                if !against.contains(obstacle.id) {
                    against.add(obstacle.id);
                }
            }
        }
        if clear || !started || edition == Edition::Literal {
            return self.report(&plan, time_s, Reason::ManeuverKept);
        }
        self.plan = Some(Plan { against, ..plan });
        self.choose_direction(situation, now, edition, 0.0, Reason::ManeuverReplaced)
    }

    /// Algorithm 3: the next point of the mission that a Dubins path reaches.
    fn back_to_waypoint(
        &mut self,
        situation: &Situation<'_>,
        edition: Edition,
        plan: &Plan,
    ) -> Option<Plan> {
        let own = Self::own(situation);
        let radius_m = self.flyer.airspeed_mps() / self.flyer.course_rate_radps();
        let mut points = [Vec3::ZERO; MAX_POINTS];
        let count = self.progress.points_ahead(
            &situation.mission,
            own.position_m,
            2.0 * radius_m,
            &mut points,
        );
        let margin_m = match edition {
            Edition::Corrected => self.settings.margin_m,
            // Every waypoint passes line 4 as printed.
            Edition::Literal => -1e9,
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
        let next = next_waypoint(&reach, &own, points.get(..count)?, self.tracks.obstacles())?;
        let duration_s = next.path.duration_s(own.airspeed_mps);
        Some(Plan {
            maneuver: along(&next.path, own.course_rad, own.airspeed_mps, radius_m),
            decided_s: situation.time_s,
            joined_s: situation.time_s + duration_s,
            proof: Proof::Certified,
            open_since_s: f64::INFINITY,
            picture: self.tracks.picture(),
            ..*plan
        })
    }

    /// Flies a way back to its end, then goes on with `detect`.
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
            let hazards = self.tracks.hazards();
            let ahead = certify_set(&self.flyer, &self.path, hazards, left_s, 0.0, 0.0);
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

    /// The policy `circle`: round one static obstacle in the plane (Fig. 8, Alg. 4).
    pub(super) fn step_circle(&mut self, situation: &Situation<'_>, now: &MotionState) -> Decision {
        self.load_tracks(situation);
        let time_s = situation.time_s;
        if let Some(plan) = self.plan {
            let begun = time_s >= plan.start_s;
            if time_s < plan.joined_s {
                self.state = if begun {
                    State::Avoiding
                } else {
                    State::Threatened
                };
                let reason = if begun {
                    Reason::ManeuverKept
                } else {
                    Reason::WaitingForStart
                };
                return self.report(&plan, time_s, reason);
            }
            self.plan = None;
        }
        self.state = State::Cruise;
        let (nominal, _) = self.guidance(situation, now);
        let own = Self::own(situation);
        let radius_m = self.flyer.airspeed_mps() / self.flyer.course_rate_radps();
        let mut first: Option<(f64, Side, RoundObstacle, Threat)> = None;
        for detection in detect(&own, self.tracks.obstacles(), f64::INFINITY) {
            let Some(obstacle) = self.tracks.obstacles().get(detection.index) else {
                continue;
            };
            if obstacle.motion(Vec3::ZERO, STATIC_MPS) != Motion::Static {
                continue;
            }
            let round = level_geometry(&detection.relative, obstacle).and_then(|geometry| {
                let kept_m = geometry.radius_m + self.settings.margin_m;
                let round = RoundObstacle::new(radius_m, kept_m, geometry.across_m)?;
                Some((geometry, round))
            });
            let Some((geometry, round)) = round else {
                continue;
            };
            // The arcs follow their commands late by the bank's lag.
            let late_s = self.vehicle.response.bank_time_constant_s;
            let wait_s = (geometry.along_m - round.before_m) / geometry.closing_mps - late_s;
            let left_m = own.velocity_mps().cross(detection.relative.position_m()).z;
            let side = if left_m > 0.0 {
                Side::Right
            } else {
                Side::Left
            };
            let Some(threat) = threat(&detection.relative, obstacle, Edition::Corrected) else {
                continue;
            };
            if first.is_none_or(|(known_s, ..)| wait_s < known_s) {
                first = Some((wait_s, side, round, threat));
            }
        }
        let Some((wait_s, side, round, threat)) = first else {
            return self.decision(&nominal, Reason::Clear);
        };
        let wait_s = wait_s.max(0.0);
        let speeds = (own.airspeed_mps, radius_m);
        let Some(maneuver) = round.maneuver(wait_s, own.course_rad, now.climb_rad, side, speeds)
        else {
            return self.decision(&nominal, Reason::Clear);
        };
        let plan = Plan {
            maneuver,
            decided_s: time_s,
            start_s: time_s + wait_s,
            joined_s: time_s + wait_s + round.length_m() / own.airspeed_mps,
            proof: Proof::Certified,
            open_since_s: f64::INFINITY,
            picture: self.tracks.picture(),
            margin_m: self.settings.margin_m,
            cost: 0.0,
            latest_start_s: Some(time_s + wait_s),
            threat: Some(threat),
            next_start_s: None,
            basis: None,
            against: Against::default(),
        };
        self.plan = Some(plan);
        let begins = wait_s < self.settings.decision_period_s;
        self.state = if begins {
            State::Avoiding
        } else {
            State::Threatened
        };
        let reason = if begins {
            Reason::ManeuverChosen
        } else {
            Reason::WaitingForStart
        };
        self.report(&plan, time_s, reason)
    }
}

/// The section of an obstacle at the aircraft's height.
fn level_geometry(relative: &Relative, obstacle: &Obstacle) -> Option<Geometry> {
    let radius_m = obstacle.volume.radius_m();
    match obstacle.volume {
        crate::situation::ProtectedVolume::Sphere { .. } => {
            Geometry::level_section(relative, radius_m)
        }
        crate::situation::ProtectedVolume::Cylinder { .. } => {
            Geometry::horizontal(relative, radius_m)
        }
    }
}

/// The threat that an obstacle is, if it is one (Alg. 1).
fn threat(relative: &Relative, obstacle: &Obstacle, edition: Edition) -> Option<Threat> {
    let closest = relative.closest();
    let of = |entry_s: f64, margin_m: f64| Threat {
        id: obstacle.id,
        entry_s,
        closest_s: closest.time_s,
        margin_m,
    };
    match edition {
        Edition::Literal => {
            let bias = relative.bias_rad()?;
            let radius_m = obstacle.volume.radius_m();
            let distance_m = relative.distance_m();
            literal::is_dangerous(distance_m, bias, radius_m)
                .then(|| of(closest.time_s, distance_m * libm::sin(bias) - radius_m))
        }
        Edition::Corrected => match assess(relative, &obstacle.volume) {
            Conflict::Passing { .. } | Conflict::Receding { .. } => None,
            Conflict::Inside { margin_m } => Some(of(0.0, margin_m)),
            Conflict::Threat {
                entry_s,
                closest_s,
                margin_m,
            } => Some(Threat {
                id: obstacle.id,
                entry_s,
                closest_s,
                margin_m,
            }),
        },
    }
}

/// A Dubins path as a manoeuvre of an aircraft that flies `course_rad` now.
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

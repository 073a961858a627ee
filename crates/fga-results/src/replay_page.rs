//! From the log of a flight to its replay page.

use alloc::sync::Arc;

use fga::Vec3;
use fga::assumptions::Assumptions;
use fga::avoider::{Decision, Reason, State};
use fga::certificate::{Hazard, Status, certify_set};
use fga::maneuver::Maneuver;
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::Ownship;
use fga::vehicle::Vehicle;
use fga_formats::words::{decision_words, reason_words};
use fga_report::replay::{
    Replay, ReplayDecision, ReplayEvent, ReplayFutures, ReplayGround, ReplayObstacle,
    ReplayOutcome, ReplayPath, ReplayPathKind, ReplayPiece, ReplayRun, ReplaySample, render,
};
use fga_report::zone::DrawnZone;
use fga_sim::progress::MissedWaypoint;
use fga_sim::run::{AircraftFutures, DecisionLog, FutureWay, Plan, RunLog};
use fga_sim::track::Track;
use fga_sim::world::WorldGround;
use fga_sim::world::WorldZone;

use crate::{flight_file, replay_guidance};

/// The text of the records of a flight without a policy.
const NO_POLICY: &str = "no policy decides, the mission is flown";
/// Least time between kept records without news, seconds.
const RECORD_EVERY_S: f64 = 0.5;
/// Length of the drawn paths, seconds.
const DRAWN_S: f64 = 15.0;
/// Longest drawn way back, seconds.
const WAY_BACK_S: f64 = 60.0;
/// Time between the points of a drawn path, seconds.
const POINT_EVERY_S: f64 = 0.25;
/// Turns drawn as alternatives, degrees to the left.
const FAN_DEG: [f64; 11] = [
    120.0, 90.0, 60.0, 40.0, 20.0, 0.0, -20.0, -40.0, -60.0, -90.0, -120.0,
];

/// The page of an encounter: its flights in one scene; the first one is in focus.
pub fn page<'a>(logs: impl IntoIterator<Item = &'a RunLog>) -> String {
    guided_page(logs, None)
}

/// The same with alerts and bands as settings give them.
pub fn guided_page<'a>(
    logs: impl IntoIterator<Item = &'a RunLog>,
    settings: Option<&fga_alerts::AlertSettings>,
) -> String {
    let mut logs = logs.into_iter().peekable();
    let title = logs
        .peek()
        .map_or_else(String::new, |log| log.plan.name.clone());
    let ground = logs
        .peek()
        .and_then(|log| log.plan.world.ground.as_deref().map(replay_ground));
    let runs = logs.map(|log| {
        let mut run = replay_run(log);
        if let Some(settings) = settings {
            replay_guidance::add(&mut run, log, settings);
        }
        run
    });
    render(&Replay {
        title,
        runs: runs.collect(),
        ground,
    })
}

/// The ground for the page.
pub fn replay_ground(ground: &WorldGround) -> ReplayGround {
    let ((corner_m, spacing_m), columns, heights_m) = ground.posts();
    ReplayGround {
        corner_m: corner_m.to_array(),
        spacing_m: spacing_m.to_array(),
        columns,
        heights_m: heights_m.to_vec(),
    }
}

/// The flight for the page, named after its policy. `run.json` has the durations of the decisions: so
/// the page is the same every time; live pages show the durations.
fn replay_run(log: &RunLog) -> ReplayRun {
    let mut drawer = Drawer::new(&log.plan);
    let least = log
        .obstacles
        .iter()
        .filter(|obstacle| obstacle.margin.value_m.is_finite())
        .min_by(|a, b| a.margin.value_m.total_cmp(&b.margin.value_m));
    let mut run = ReplayRun {
        name: log.policy.clone(),
        samples: log.samples.iter().map(sample).collect(),
        mission_m: log.mission_line_m().iter().map(Vec3::to_array).collect(),
        obstacles: obstacles(log),
        zones: planned_zones(&log.plan),
        decisions: drawer.decisions(log),
        decision_times: Vec::new(),
        events: replay_events(log),
        outcome: least.map(|obstacle| ReplayOutcome {
            min_margin_m: obstacle.margin.value_m,
            t_s: obstacle.margin.time_s,
            obstacle: obstacle.id,
        }),
        ..ReplayRun::default()
    };
    if log.policy == "none" {
        say_no_policy(&mut run);
    }
    run
}

/// Decisions with news, and missed waypoints, in time order.
fn replay_events(log: &RunLog) -> Vec<ReplayEvent> {
    let decisions = log.decisions.iter().filter(|moment| moment.changed);
    let mut events: Vec<ReplayEvent> = decisions
        .map(|moment| ReplayEvent {
            t_s: moment.time_s,
            text: event_words(&log.plan, moment),
        })
        .chain(log.missed.iter().map(|missed| ReplayEvent {
            t_s: missed.time_s,
            text: missed_words(missed),
        }))
        .collect();
    events.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
    events
}

/// Without a policy nobody looks, so "nothing comes too close" would be false.
fn say_no_policy(run: &mut ReplayRun) {
    let clear = reason_words(Reason::Clear);
    for event in run.events.iter_mut().filter(|event| event.text == clear) {
        NO_POLICY.clone_into(&mut event.text);
    }
    for decision in &mut run.decisions {
        for line in decision
            .lines
            .iter_mut()
            .filter(|line| **line == sentence(clear))
        {
            *line = sentence(NO_POLICY);
        }
    }
}

fn sample(sample: &fga_sim::engine::Sample) -> ReplaySample {
    ReplaySample {
        t_s: sample.time_s,
        position_m: sample.position_m.to_array(),
        course_rad: sample.course_rad,
        climb_rad: sample.climb_rad,
        bank_rad: sample.bank_rad,
        state: sample.state.into(),
    }
}

/// A decision in a few words.
pub fn event_words(plan: &Plan, moment: &DecisionLog) -> String {
    let record = &moment.decision.record;
    let reason = reason_words(record.reason);
    match record.threat {
        Some(threat) => format!("{reason} ({})", name_of(plan, threat.id)),
        None => reason.to_owned(),
    }
}

/// The zones of a plan.
pub fn planned_zones(plan: &Plan) -> Vec<DrawnZone> {
    let drawn = |zone: &WorldZone| {
        let zone = flight_file::zone(zone);
        DrawnZone {
            name: zone.name,
            keep_in: zone.keep_in,
            ring_m: zone.ring_m,
            floor_m: zone.floor_m,
            ceiling_m: zone.ceiling_m,
        }
    };
    plan.world.zones.iter().map(drawn).collect()
}

fn obstacles(log: &RunLog) -> Vec<ReplayObstacle> {
    let mut obstacles = planned_obstacles(&log.plan);
    for (obstacle, outcome) in obstacles.iter_mut().zip(&log.obstacles) {
        obstacle.known_from_s = match outcome.first_seen_s {
            Some(first_s) => (first_s > 0.0).then_some(first_s),
            // Never seen: not before the end.
            None => Some(log.outcome.end_s + 1.0),
        };
    }
    obstacles
}

/// The obstacles of a plan, known from their appearance on.
pub fn planned_obstacles(plan: &Plan) -> Vec<ReplayObstacle> {
    let named = plan.world.obstacles.iter().zip(&plan.names);
    named
        .map(|(obstacle, name)| {
            let presence = obstacle.track.presence_s();
            ReplayObstacle {
                id: obstacle.id,
                name: name.clone(),
                volume: obstacle.volume,
                motion: motion(&obstacle.track),
                present_s: (presence.0.is_finite() || presence.1.is_finite())
                    .then_some([presence.0, presence.1]),
                known_from_s: (obstacle.appears_s > 0.0).then_some(obstacle.appears_s),
            }
        })
        .collect()
}

fn name_of(plan: &Plan, id: u32) -> String {
    let named = plan.world.obstacles.iter().zip(&plan.names);
    let name = named.into_iter().find(|(obstacle, _)| obstacle.id == id);
    name.map_or_else(|| "unknown".to_owned(), |(_, name)| name.clone())
}

fn motion(track: &Track) -> Vec<ReplayPiece> {
    let mut pieces = Vec::new();
    let (from_s, to_s) = track.presence_s();
    let from_s = if from_s.is_finite() { from_s } else { 0.0 };
    track.for_each_leg(from_s, to_s, |leg| {
        let position = leg.position_at_m(leg.from_s);
        let second_s = (leg.to_s - leg.from_s).clamp(1e-3, 1.0);
        let velocity = (leg.position_at_m(leg.from_s + second_s) - position) / second_s;
        pieces.push(ReplayPiece {
            start_s: leg.from_s,
            position_m: position.to_array(),
            velocity_mps: velocity.to_array(),
        });
    });
    pieces
}

/// Draws the decision and its alternatives.
pub struct Drawer {
    flyer: Flyer,
    path: Box<FlightPath>,
    wind_mps: Vec3,
    horizon_s: f64,
    margin_m: f64,
    zones: Vec<WorldZone>,
    ground: Option<Arc<WorldGround>>,
}

impl Drawer {
    /// For the aircraft of a plan.
    pub fn new(plan: &Plan) -> Self {
        let world = &plan.world;
        let settings = &world.settings.avoider;
        Self {
            zones: world.zones.clone(),
            ground: world.ground.clone(),
            ..Self::of(
                &world.vehicle,
                world.wind_mps,
                settings.horizon_s,
                settings.margin_m,
            )
        }
    }

    /// For an aircraft in a wind, with the horizon and the margin of its certificates.
    pub fn of(vehicle: &Vehicle, wind_mps: Vec3, horizon_s: f64, margin_m: f64) -> Self {
        Self {
            flyer: Flyer::new(vehicle),
            path: Box::default(),
            wind_mps,
            horizon_s,
            margin_m,
            zones: Vec::new(),
            ground: None,
        }
    }

    fn decisions(&mut self, log: &RunLog) -> Vec<ReplayDecision> {
        let mut kept: Vec<ReplayDecision> = Vec::new();
        for moment in &log.decisions {
            let last_s = kept.last().map(|last| last.t_s);
            if due(last_s, moment.time_s, has_news(moment)) {
                kept.push(self.decision(&log.plan, moment, true));
            }
        }
        kept
    }

    /// A record; on request with alternative turns.
    pub fn decision(&mut self, plan: &Plan, moment: &DecisionLog, compare: bool) -> ReplayDecision {
        let hazards = compare.then(|| known_hazards(plan, moment));
        let name = |id: u32| name_of(plan, id);
        let DecisionLog {
            time_s,
            decision,
            ownship,
            ..
        } = moment;
        let record = self.record(*time_s, decision, ownship, name, hazards.as_deref());
        ReplayDecision {
            futures: moment.futures.iter().map(futures).collect(),
            ..record
        }
    }

    /// A record; if the obstacles are known, also with alternative turns.
    pub fn record(
        &mut self,
        time_s: f64,
        decision: &Decision,
        own: &Ownship,
        name: impl Fn(u32) -> String,
        hazards: Option<&[Hazard]>,
    ) -> ReplayDecision {
        let record = &decision.record;
        let mut lines: Vec<String> = decision_words(decision, own, name)
            .split("; ")
            .map(sentence)
            .collect();
        let mut paths = Vec::new();
        if let Some(hazards) = hazards.filter(|_| threatened(decision.state)) {
            for turn_deg in FAN_DEG {
                let course_rad = own.course_rad + turn_deg.to_radians();
                let turn = Maneuver::turn(0.0, course_rad, own.climb_rad);
                paths.push(self.compared(own, &turn, hazards));
            }
            let certified = |p: &&ReplayPath| p.kind == ReplayPathKind::Certified;
            lines.push(format!(
                "{} of {} ways on from here, drawn for comparison, stay clear.",
                paths.iter().filter(certified).count(),
                paths.len()
            ));
        }
        if let Some((maneuver, other)) = &record.alternative {
            let (kind, margin_m) = (other.verdict.into(), finite(other.margin_m));
            paths.push(self.drawn(own, &maneuver.to(), kind, margin_m, DRAWN_S));
        }
        if decision.state == State::Recovering {
            let kind = ReplayPathKind::WayBack;
            let margin_m = record.chosen.and_then(|c| finite(c.margin_m));
            paths.push(self.drawn(own, &decision.command, kind, margin_m, WAY_BACK_S));
        } else if let Some(chosen) = &record.chosen {
            let margin_m = finite(chosen.margin_m);
            let kind = ReplayPathKind::Chosen;
            let last_s = decision.command.stages().last().map_or(0.0, |s| s.start_s);
            let until_s = (last_s + DRAWN_S).min(WAY_BACK_S);
            paths.push(self.drawn(own, &decision.command, kind, margin_m, until_s));
        }
        ReplayDecision {
            t_s: time_s,
            state: decision.state.into(),
            lines,
            threat: record.threat.map(|threat| threat.id),
            latest_start_s: record.latest_start_s,
            paths,
            p_loss: record.p_loss_hold.zip(record.p_loss).map(<[f64; 2]>::from),
            futures: Vec::new(),
        }
    }

    /// Places over the ground along the path as drawn, metres.
    fn drawn_m(&self) -> impl Iterator<Item = Vec3> {
        let times_s = (0..).map(|point| POINT_EVERY_S * f64::from(point));
        let drawn_s = times_s.take_while(|at_s| *at_s <= DRAWN_S);
        drawn_s.filter_map(|at_s| {
            let state = self.path.state_at(&self.flyer, at_s)?;
            Some(state.position_m + self.wind_mps * at_s)
        })
    }

    /// Whether the path as drawn enters no zone that the aircraft has not entered before.
    fn keeps_to_zones(&self, own_m: Vec3) -> bool {
        let zones = self.zones.iter();
        let mut outside = zones.filter(|zone| zone.margin_m(own_m) >= 0.0);
        outside.all(|zone| self.drawn_m().all(|at_m| zone.margin_m(at_m) >= 0.0))
    }

    /// Whether the path as drawn clears the ground, where the aircraft does.
    fn keeps_above_ground(&self, own_m: Vec3) -> bool {
        self.ground.as_ref().is_none_or(|ground| {
            let needed_m = ground.clearance_m() + ground.error_m();
            let clears = |at_m| {
                ground
                    .above_m(at_m)
                    .is_some_and(|above_m| above_m >= needed_m)
            };
            !clears(own_m) || self.drawn_m().all(clears)
        })
    }

    /// An alternative manoeuvre, certified against the obstacles known at that moment.
    fn compared(&mut self, own: &Ownship, maneuver: &Maneuver, hazards: &[Hazard]) -> ReplayPath {
        let start = MotionState::of(own);
        self.path
            .predict(&self.flyer, &start, maneuver, self.horizon_s);
        let certificate = certify_set(
            &self.flyer,
            &self.path,
            &Assumptions::only(hazards),
            (self.horizon_s, f64::MIN, f64::INFINITY),
            &Meter::unlimited(),
        );
        let clear = certificate.status == Status::Proven
            && certificate.margin_m >= self.margin_m
            && self.keeps_to_zones(own.position_m)
            && self.keeps_above_ground(own.position_m);
        let kind = if clear {
            ReplayPathKind::Certified
        } else {
            ReplayPathKind::Rejected
        };
        self.drawn(own, maneuver, kind, finite(certificate.margin_m), DRAWN_S)
    }

    fn drawn(
        &mut self,
        own: &Ownship,
        maneuver: &Maneuver,
        kind: ReplayPathKind,
        margin_m: Option<f64>,
        until_s: f64,
    ) -> ReplayPath {
        let start = MotionState::of(own);
        self.path.predict(&self.flyer, &start, maneuver, until_s);
        let mut points_m = Vec::new();
        let mut at_s = 0.0;
        while at_s <= until_s {
            if let Some(state) = self.path.state_at(&self.flyer, at_s) {
                // Predicted in the air mass, drawn over the ground.
                points_m.push((state.position_m + self.wind_mps * at_s).to_array());
            }
            at_s += POINT_EVERY_S;
        }
        ReplayPath {
            kind,
            margin_m,
            points_m,
        }
    }
}

const fn threatened(state: State) -> bool {
    matches!(state, State::Threatened | State::Avoiding)
}

/// The obstacles that the decision knew, with their uncertainty, each on a straight line from there.
fn known_hazards(plan: &Plan, moment: &DecisionLog) -> Vec<Hazard> {
    let world = &plan.world;
    let sigmas = world.settings.avoider.confidence_sigmas;
    (moment.known.iter())
        .map(|known| Hazard::new(known, world.wind_mps, sigmas))
        .collect()
}

/// What an aircraft may do, for the page.
fn futures(of: &AircraftFutures) -> ReplayFutures {
    let points_m = |way: &FutureWay| way.points_m.iter().map(Vec3::to_array).collect();
    let ways = of.ways.iter();
    ReplayFutures {
        obstacle: of.obstacle,
        ways: (ways.map(|way| (way.weight.into(), points_m(way)))).collect(),
    }
}

/// Whether a decision has news for the page.
pub const fn has_news(moment: &DecisionLog) -> bool {
    moment.changed || !moment.futures.is_empty()
}

/// Whether a decision, with or without news, deserves a record after the one at `last_s`.
pub fn due(last_s: Option<f64>, time_s: f64, changed: bool) -> bool {
    changed || last_s.is_none_or(|last_s| time_s - last_s >= RECORD_EVERY_S - 1e-6)
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// A phrase as a sentence.
fn sentence(phrase: &str) -> String {
    let mut letters = phrase.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    format!("{}{}.", first.unwrap_or_default(), letters.as_str())
}

/// A missed waypoint, in words; waypoints count from 1.
pub fn missed_words(missed: &MissedWaypoint) -> String {
    format!(
        "waypoint {} missed by {:.1} m",
        missed.index + 1,
        missed.distance_m
    )
}

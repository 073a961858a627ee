//! Round one static obstacle in the plane (Fig. 8, Algorithm 4): the policy `circle` of the simulator
//! and the command mode `paper` of a link.
//!
//! The phases come from [`Execution`]. Three things are not in the paper. A turn ends when a roll-out
//! that starts now ends on its course, so every turn allows for the bank's lag. A turn may end between two
//! decisions. Round the obstacle the turn corrects the aircraft's distance from its circle.

use fga::Vec3;
use fga::angle::{direction, wrap_pi};
use fga::avoider::{Candidate, Decision, Reason, State, Threat, Verdict};
use fga::certificate::Hazard;
use fga::limit::Limit as _;
use fga::maneuver::{Maneuver, Stage};
use fga::prediction::{Flyer, MotionState};
use fga::situation::{Ownship, ProtectedVolume, Situation};
use fga::vehicle::bank_for_radius_rad;

use super::{Edition, PaperPilot, threat};
use crate::algorithm_4::{Execution, Phase, Plan};
use crate::classification::{Motion, motion};
use crate::conflict::{Relative, detect};

/// Speed over the ground up to which an obstacle counts as static, m/s: no aircraft flies so slowly.
const STATIC_MPS: f64 = 1.0;

/// Iterations that widen the way round by the drift during its flight.
const DRIFT_STEPS: u32 = 6;

/// Natural frequency of the motion back to the circle, rad/s.
const BACK_RADPS: f64 = 0.25;

/// The damping ratio of that motion.
const DAMPING: f64 = 0.8;

/// The gentlest turn round the obstacle, as a share of the largest course rate.
const LEAST_SHARE: f64 = 0.01;

/// A turn that ended between two decisions overshot its course by this, rad.
const PAST_RAD: f64 = 1e-6;

/// A way round one obstacle, flown or awaited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Round {
    execution: Execution,
    /// Position of the obstacle when it is abeam, on the ground at `decided_s`, metres. It moves with
    /// the air, because the way round is relative to the air.
    place_m: Vec3,
    /// Time of the plan, seconds on the situation's clock.
    decided_s: f64,
    /// Start of the first turn, seconds on the situation's clock.
    start_s: f64,
    /// End of the present turn, seconds on the situation's clock.
    ends_s: f64,
    threat: Threat,
}

impl Round {
    /// Advances to the present phase. The period in which the first turn begins decides it.
    fn advance(&mut self, situation: &Situation<'_>, flyer: &Flyer, period_s: f64) {
        let (own, time_s) = (&situation.ownship, situation.time_s);
        let plan = *self.execution.plan();
        let side = plan.side.sign();
        let mut course_rad = own.course_rad + flyer.rollout_rad(own.bank_rad);
        if time_s >= self.ends_s {
            let deviation_rad = match self.execution.phase() {
                Phase::RoundObstacle => -plan.round.back.angle_rad - PAST_RAD,
                Phase::TurningAway => plan.round.away.angle_rad + PAST_RAD,
                Phase::Waiting | Phase::TurningBack | Phase::Done => PAST_RAD,
            };
            course_rad = plan.initial_course_rad + side * deviation_rad;
        }
        // The range adds nothing to the time: a waiting plan is renewed at each moment.
        let trigger_s = plan.critical_s + time_s + period_s - self.start_s;
        self.execution.step(trigger_s, f64::INFINITY, course_rad);
    }

    /// From the aircraft to the centre of the circle round the obstacle, level, metres.
    fn centre_offset_m(&self, situation: &Situation<'_>) -> Vec3 {
        let plan = self.execution.plan();
        let drifted_m = situation.wind_mps * (situation.time_s - self.decided_s);
        // If the turn radius exceeds the protected one, the circle touches from outside: the
        // centres of both turns and the obstacle lie on one line.
        let past_m = plan.round.around.radius_m - plan.radius_m;
        let to_obstacle_rad = plan.initial_course_rad
            - plan.side.sign() * (core::f64::consts::FRAC_PI_2 - plan.round.away.angle_rad);
        let centre_m = self.place_m + direction(to_obstacle_rad, 0.0) * past_m;
        (centre_m + drifted_m - situation.ownship.position_m).with_z(0.0)
    }

    /// Share of the largest course rate that brings the aircraft onto its circle and keeps it there;
    /// `rate_radps` is the circle's rate.
    fn share_round(&self, situation: &Situation<'_>, rate_radps: f64, full_radps: f64) -> f64 {
        let offset_m = self.centre_offset_m(situation);
        let distance_m = offset_m.length().max(1.0);
        let velocity_mps = situation.ownship.velocity_mps();
        let leaving_mps = -offset_m.dot(velocity_mps) / distance_m;
        let off_m = distance_m - self.execution.plan().round.around.radius_m;
        let inwards_mps2 =
            2.0 * DAMPING * BACK_RADPS * leaving_mps + BACK_RADPS * BACK_RADPS * off_m;
        let tighter_radps = inwards_mps2 / situation.ownship.airspeed_mps;
        ((rate_radps + tighter_radps) / full_radps).limited(LEAST_SHARE, 1.0)
    }

    /// The rest of the way. The vehicle may turn faster than planned by the factor `excess`.
    fn maneuver(&mut self, situation: &Situation<'_>, flyer: &Flyer, excess: f64) -> Maneuver {
        let (own, plan) = (&situation.ownship, *self.execution.plan());
        let phase = self.execution.phase();
        let (side, round) = (plan.side.sign(), plan.round);
        let level_mps = own.airspeed_mps * libm::cos(own.climb_rad);
        let full_radps = level_mps / plan.turn_radius_m;
        let round_radps = level_mps / (round.around.radius_m * excess);
        let share = match phase {
            Phase::RoundObstacle => self.share_round(situation, round_radps, full_radps),
            _ => (round_radps / full_radps).limited(LEAST_SHARE, 1.0),
        };
        let turns = [
            (Phase::TurningAway, round.away.angle_rad, 1.0),
            (Phase::RoundObstacle, -round.back.angle_rad, share),
            (Phase::TurningBack, 0.0, 1.0),
        ];
        let left = match phase {
            Phase::Waiting | Phase::TurningAway => turns.get(..),
            Phase::RoundObstacle => turns.get(1..),
            Phase::TurningBack => turns.get(2..),
            Phase::Done => None,
        };
        let deviation_rad = side * wrap_pi(own.course_rad - plan.initial_course_rad);
        let mut from_rad = deviation_rad + side * flyer.rollout_rad(own.bank_rad);
        let mut at_s = (self.start_s - situation.time_s).max(0.0);
        let mut maneuver = Maneuver::hold();
        for &(turn, to_rad, rate_share) in left.unwrap_or(&[]) {
            maneuver.push(Stage {
                start_s: at_s,
                course_rad: own.course_rad + side * (to_rad - deviation_rad),
                climb_rad: own.climb_rad,
                rate_share,
            });
            at_s += (to_rad - from_rad).abs() / (rate_share * full_radps);
            from_rad = to_rad;
            if turn == phase {
                self.ends_s = situation.time_s + at_s;
            }
        }
        maneuver
    }
}

impl PaperPilot {
    /// The policy `circle`: round one static obstacle in the plane (Fig. 8, Alg. 4).
    pub(super) fn step_circle(&mut self, situation: &Situation<'_>, now: &MotionState) -> Decision {
        let nominal = self.guidance(situation, now);
        let period_s = self.settings.decision_period_s;
        let before = self.round.map(|round| round.execution.phase());
        if let Some(round) = &mut self.round {
            round.advance(situation, &self.flyer, period_s);
        }
        let is_flown =
            |round: &Round| !matches!(round.execution.phase(), Phase::Waiting | Phase::Done);
        if !self.round.as_ref().is_some_and(is_flown) {
            self.round = self.nearest(situation);
            if let Some(round) = &mut self.round {
                round.advance(situation, &self.flyer, period_s);
            }
        }
        let Some(mut round) = self.round else {
            self.state = State::Cruise;
            return self.decision(&nominal, Reason::Clear);
        };
        let phase = round.execution.phase();
        let begins = before != Some(phase);
        let reason;
        (self.state, reason) = match phase {
            Phase::Waiting => (State::Threatened, Reason::WaitingForStart),
            Phase::TurningAway if begins => (State::Avoiding, Reason::ManeuverChosen),
            Phase::TurningAway | Phase::RoundObstacle => (State::Avoiding, Reason::ManeuverKept),
            Phase::TurningBack if begins => (State::Recovering, Reason::RejoinChosen),
            Phase::TurningBack => (State::Recovering, Reason::RejoinKept),
            Phase::Done => (State::Cruise, Reason::Clear),
        };
        let excess = self.settings.turn_rate_excess;
        let command = round.maneuver(situation, &self.flyer, excess);
        self.round = Some(round);
        self.tell_round(&round, &command, situation.time_s, reason)
    }

    fn tell_round(
        &self,
        round: &Round,
        command: &Maneuver,
        time_s: f64,
        reason: Reason,
    ) -> Decision {
        let mut decision = self.decision(command, reason);
        let record = &mut decision.record;
        let elapsed_s = time_s - round.decided_s;
        // After the predicted entry the threat is history.
        let threat = Some(round.threat).filter(|threat| threat.entry_s >= elapsed_s);
        record.threat = threat.map(|threat| Threat {
            entry_s: threat.entry_s - elapsed_s,
            closest_s: threat.closest_s - elapsed_s,
            ..threat
        });
        record.start_s = Some(round.start_s - time_s);
        record.latest_start_s = record.start_s;
        record.chosen = Some(Candidate {
            maneuver: *command,
            margin_m: self.settings.margin_m,
            cost: 0.0,
            verdict: Verdict::Chosen,
        });
        decision
    }

    /// The way round the static obstacle whose first turn is due first.
    fn nearest(&self, situation: &Situation<'_>) -> Option<Round> {
        let own = &situation.ownship;
        // The arcs follow their commands with the bank's lag.
        let late_s = self.vehicle.response.bank_time_constant_s;
        let hazards = self.around.hazards();
        detect(own, hazards, f64::INFINITY)
            .filter_map(|detection| {
                let hazard = hazards.get(detection.index)?;
                if motion(hazard, situation.wind_mps, STATIC_MPS) != Motion::Static {
                    return None;
                }
                let (place_m, plan) = self.way_round(own, &detection.relative, hazard)?;
                Some(Round {
                    execution: Execution::new(plan),
                    place_m,
                    decided_s: situation.time_s,
                    start_s: situation.time_s + (plan.critical_s - late_s).max(0.0),
                    ends_s: f64::INFINITY,
                    threat: threat(&detection.relative, hazard, Edition::Corrected)?,
                })
            })
            .min_by(|a, b| a.start_s.total_cmp(&b.start_s))
    }

    /// The way round an obstacle at rest on the ground, planned in the air mass, where the obstacle moves
    /// against the wind: round its position when it is abeam, wide enough for its drift from the first turn
    /// to the last. Returns that position and the way.
    fn way_round(
        &self,
        own: &Ownship,
        relative: &Relative,
        obstacle: &Hazard,
    ) -> Option<(Vec3, Plan)> {
        let level_mps = own.airspeed_mps * libm::cos(own.climb_rad);
        let bank_rad = bank_for_radius_rad(level_mps, level_mps / self.flyer.course_rate_radps())?;
        let drift_mps = obstacle.velocity_mps;
        let abeam_m = relative.position_m() + drift_mps * relative.closest().time_s;
        let place_m = own.position_m + abeam_m;
        let least_m = level_radius_m(&obstacle.volume, abeam_m.z)? + self.settings.margin_m;
        let mut plan = Plan::of(own, place_m, least_m, bank_rad)?;
        // A wider way takes longer, and the obstacle drifts farther.
        for _ in 0..DRIFT_STEPS {
            let half_s = 0.5 * plan.round.length_m() / own.airspeed_mps;
            let kept_m = least_m + drift_mps.length() * half_s;
            plan = Plan::of(own, place_m, kept_m, bank_rad)?;
        }
        Some((place_m, plan))
    }
}

/// Radius of a volume's section `above_m` from its middle, metres; `None` beyond a sphere's top.
fn level_radius_m(volume: &ProtectedVolume, above_m: f64) -> Option<f64> {
    match *volume {
        ProtectedVolume::Sphere { radius_m } => {
            let squared = radius_m * radius_m - above_m * above_m;
            (squared > 0.0).then(|| libm::sqrt(squared))
        }
        ProtectedVolume::Cylinder { radius_m, .. } => Some(radius_m),
    }
}

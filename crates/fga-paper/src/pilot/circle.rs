//! Round one static obstacle in the plane (Fig. 8, Algorithm 4): the policy `circle` of the simulator
//! and the command mode `paper` of a link.
//!
//! The phases are Algorithm 4's. Three things are not in the paper: the way is laid over the ground, where the
//! obstacle rests, and not in the air, which moves; every turn allows for the bank's lag; and the way is predicted
//! before it begins. Where the prediction does not keep the volume, the record says so and the mission is flown on.

mod round;
mod way;

use fga::Vec3;
use fga::avoider::{Candidate, Decision, Reason, State, Threat, Verdict};
use fga::certificate::Hazard;
use fga::maneuver::Maneuver;
use fga::prediction::MotionState;
use fga::situation::{ProtectedVolume, Situation};

pub(super) use self::round::Round;
use self::way::{Air, Way};
use super::{Edition, PaperPilot, threat};
use crate::algorithm_4::Phase;
use crate::classification::{Motion, motion};
use crate::conflict::Relative;
use crate::timing::Geometry;

/// Speed over the ground up to which an obstacle counts as static, m/s: no aircraft flies so slowly.
const STATIC_MPS: f64 = 1.0;

/// A plan counts until the wind changes by more, m/s.
const SAME_WIND_MPS: f64 = 0.5;

/// A plan counts until the track over the ground changes by more, radians.
const SAME_TRACK_RAD: f64 = 0.02;

/// A way with rolls is predicted to this, metres: in wind of 0.8 of the airspeed flights come nearer than planned by up to 5 cm.
const ROLLED_M: f64 = 0.05;

/// Where no way keeps the volume, the next plan is made after this time, seconds.
const NEXT_PLAN_S: f64 = 1.0;

impl PaperPilot {
    fn air(&self, wind_mps: Vec3) -> Air<'_> {
        Air {
            flyer: &self.flyer,
            wind_mps: wind_mps.with_z(0.0),
            lag_s: self.vehicle.response.bank_time_constant_s,
            period_s: self.settings.decision_period_s,
            excess: self.settings.turn_rate_excess,
        }
    }

    /// The policy `circle`: round one static obstacle in the plane (Fig. 8, Alg. 4).
    pub(super) fn step_circle(&mut self, situation: &Situation<'_>, now: &MotionState) -> Decision {
        let nominal = self.guidance(situation, now);
        let before = self
            .round
            .and_then(|round| round.way)
            .map(|way| way.phase());
        if !self.round.as_ref().is_some_and(Round::is_flown) {
            self.round = self.nearest(situation, now);
        }
        let Some(mut round) = self.round else {
            self.state = State::Cruise;
            return self.decision(&nominal, Reason::Clear);
        };
        let Some(way) = &mut round.way else {
            self.state = State::Threatened;
            return self.tell_round(&round, &nominal, situation.time_s, Reason::BestAvailable);
        };
        let command = way.command((situation.time_s, now), &self.air(situation.wind_mps));
        let phase = way.phase();
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
        self.round = Some(round);
        if phase == Phase::Done {
            self.round = None;
            return self.decision(&nominal, reason);
        }
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
        let elapsed_s = time_s - round.told_s;
        // After the predicted entry the threat is history.
        let threat = Some(round.threat).filter(|threat| threat.entry_s >= elapsed_s);
        record.threat = threat.map(|threat| Threat {
            entry_s: threat.entry_s - elapsed_s,
            closest_s: threat.closest_s - elapsed_s,
            ..threat
        });
        record.start_s = round.way.map(|way| way.start_s() - time_s);
        record.latest_start_s = record.start_s;
        record.chosen = round.way.map(|_| Candidate {
            margin_m: self.settings.margin_m,
            cost: 0.0,
            verdict: Verdict::Chosen,
        });
        decision
    }

    /// The way round the static obstacle that the aircraft would enter first.
    fn nearest(&self, situation: &Situation<'_>, now: &MotionState) -> Option<Round> {
        let time_s = situation.time_s;
        let (hazard, relative, least_m, _) = self
            .around
            .hazards()
            .iter()
            .filter(|hazard| motion(hazard, situation.wind_mps, STATIC_MPS) == Motion::Static)
            .filter_map(|hazard| {
                let relative = Relative::of(&situation.ownship, hazard)?;
                let (least_m, entry_m) = self.entry_m(&relative, hazard)?;
                Some((hazard, relative, least_m, entry_m))
            })
            .min_by(|a, b| a.3.total_cmp(&b.3))?;
        let air = self.air(situation.wind_mps);
        let obstacle_m = hazard.position_m;
        let known = self.round.filter(|round| {
            let is_same = round.id == hazard.id()
                && round.wind_mps.distance(situation.wind_mps) <= SAME_WIND_MPS;
            let along = relative.velocity_mps().with_z(0.0);
            is_same
                && round
                    .way
                    .map_or(time_s < round.planned_s + NEXT_PLAN_S, |way| {
                        way.along().angle_between(along) <= SAME_TRACK_RAD
                    })
        });
        // Without a threat to the volume itself, the margin would be entered.
        let closest = relative.closest();
        let told = threat(&relative, hazard, Edition::Corrected).unwrap_or(Threat {
            id: hazard.id(),
            entry_s: closest.time_s,
            closest_s: closest.time_s,
            margin_m: closest.distance_m - least_m + self.settings.margin_m,
        });
        let mut round = known.unwrap_or_else(|| Round {
            way: Way::plan((time_s, now), obstacle_m, least_m, &air),
            id: hazard.id(),
            wind_mps: situation.wind_mps,
            planned_s: time_s,
            told_s: time_s,
            threat: told,
        });
        (round.told_s, round.threat) = (time_s, told);
        if let Some(way) = &mut round.way {
            way.renew((time_s, now), &air);
        }
        Some(round)
    }

    /// Distance that is kept beyond a volume, metres.
    fn kept_m(&self) -> f64 {
        let rolled_m = if self.flyer.is_ideal() { 0.0 } else { ROLLED_M };
        self.settings.margin_m + rolled_m
    }

    /// Distance that is kept from an obstacle, and distance along the track until it is not, metres; `None` for one
    /// that does not threaten.
    fn entry_m(&self, relative: &Relative, hazard: &Hazard) -> Option<(f64, f64)> {
        let above_m = relative.position_after_m(relative.closest().time_s).z;
        let least_m = level_radius_m(&hazard.volume, above_m)? + self.kept_m();
        let encounter = Geometry::horizontal(relative, least_m)?;
        let (across_m, along_m) = (encounter.across_m, encounter.along_m);
        let entry_m = along_m - libm::sqrt((least_m * least_m - across_m * across_m).max(0.0));
        encounter.is_threat().then_some((least_m, entry_m))
    }

    /// Range at which the way round an obstacle at rest begins, metres: the obstacle has to be seen at it. The
    /// aircraft flies along a level unit vector over the ground; the centre lies `left_m` to the left of its track,
    /// to the right if negative. `None` where no way keeps `radius_m`.
    pub fn sight_for_circle_m(
        &self,
        along: Vec3,
        left_m: f64,
        radius_m: f64,
        wind_mps: Vec3,
    ) -> Option<f64> {
        let air = self.air(wind_mps);
        Way::sight_m(along, left_m, radius_m + self.kept_m(), &air)
    }
}

/// Radius of a volume's section `above_m` from its middle, metres; `None` beyond a sphere's top or a
/// cylinder's.
fn level_radius_m(volume: &ProtectedVolume, above_m: f64) -> Option<f64> {
    match *volume {
        ProtectedVolume::Sphere { radius_m } => {
            let squared = radius_m * radius_m - above_m * above_m;
            (squared > 0.0).then(|| libm::sqrt(squared))
        }
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => (above_m.abs() < half_height_m).then_some(radius_m),
    }
}

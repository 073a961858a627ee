//! From telemetry and tracks to a decision, and from the decision to who flies.

use fga::avoider::{
    Avoider, Decision, Reason, Record, Settings, Start, State as AvoiderState, Threat,
};
use fga::maneuver::Maneuver;
use fga::situation::{Mission, Obstacles, Situation};
use fga::vehicle::{Response, Vehicle};
use fga_paper::algorithm_4::Phase;
use serde_json::json;

use super::{Companion, Decided};
use crate::authority::{Authority, Fault, Severity};
use crate::config::CommandMode;
use crate::ownship::State;
use crate::telling;

/// Back on the leg for so long, the vehicle is given back, seconds.
const ON_LEG_FOR_S: f64 = 0.4;
/// A manoeuvre that begins within this is prepared for by taking over, seconds.
const PREPARE_S: f64 = 0.6;
/// A difference of airspeed or response that makes new limits worth while, as a share.
const LIMITS_CHANGE: f64 = 0.02;
/// Telemetry is stale after this many of its measured intervals, where these are long.
const STALE_INTERVALS: f64 = 2.5;
/// After this many refusals in a row the operator has to arm it again.
const MOST_REFUSALS: u32 = 3;

impl Companion {
    /// The state at the moment at which a command sent now takes effect.
    pub(super) fn state_ahead(&mut self, now_s: f64) -> Option<State> {
        let response = self.flown_response();
        self.ownship.state_at(
            now_s + response.dead_time_s,
            &self.commanded_lately,
            &response,
        )
    }

    /// Whether the last decision is flown with the bank in need.
    pub(super) fn is_in_need(&self) -> bool {
        self.decided
            .is_some_and(|decided| decided.decision.record.in_need)
    }

    /// How the vehicle follows at banks steeper than the normal one.
    fn steep_response(&self) -> Response {
        self.steep_response.steep_response(self.response.response())
    }

    /// How the vehicle follows what is flown now.
    pub(super) fn flown_response(&self) -> Response {
        if self.is_in_need() {
            self.steep_response()
        } else {
            self.response.response()
        }
    }

    pub(super) fn decide(&mut self, now_s: f64) {
        self.due.decision_s = now_s + self.config.command.decision_period_s;
        let fresh = !self.is_blind(now_s);
        let state = if fresh || self.flies_blind(now_s) {
            self.state_ahead(now_s)
        } else {
            None
        };
        let lacking = self.lacking(now_s, state.as_ref().filter(|_| fresh));
        let before = self.keeper.state();
        let actions = self.keeper.readiness(lacking.is_none(), now_s);
        self.perform(&actions, now_s);
        self.tell_readiness(lacking, now_s);
        if before == Authority::Waiting && self.keeper.state() == Authority::Ready {
            self.forget_plan();
        }
        let Some(state) = state else { return };
        self.lay_fence(now_s);
        if self.keeper.is_engaged() && state.above_home_m < self.config.safety.floor_m - 10.0 {
            self.fault(Fault::BelowFloor, now_s);
        }
        if !self.keeper.commands() {
            self.pitch.observe(state.pitch_rad, state.ownship.climb_rad);
        }
        let Some(decision) = self.decision_for(&state, now_s) else {
            self.undecided_s.get_or_insert(now_s);
            return;
        };
        self.counts.decisions += 1;
        self.undecided_s = None;
        let ahead_s = self.response.response().dead_time_s;
        self.decided = Some(Decided {
            decision,
            for_s: now_s + ahead_s,
            own: state,
        });
        if decision.record.in_need
            && self.keeper.commands()
            && !core::mem::replace(&mut self.told.need, true)
        {
            self.tell(Severity::Warning, "fga: bank in need", now_s);
        }
        self.log_decision(now_s);
        self.send_collision(now_s);
        self.act_on(&decision, &state, now_s);
        self.judge_gap(&decision, &state, now_s);
    }

    /// Telemetry older than this is stale, seconds: as configured, or more than two messages late
    /// where the vehicle sends them slowly.
    pub(super) fn stale_s(&self) -> f64 {
        let configured_s = self.config.safety.telemetry_stale_s;
        let interval_s = self.rates.interval_s().filter(|_| self.rates.is_usable());
        interval_s.map_or(configured_s, |s| configured_s.max(STALE_INTERVALS * s))
    }

    fn decision_for(&mut self, state: &State, now_s: f64) -> Option<Decision> {
        self.renew_way(state, now_s);
        self.renew_avoider(now_s)?;
        self.gather_obstacles(state, now_s);
        self.grow_obstacles(now_s);
        if self.config.command.mode == CommandMode::Paper {
            return self.paper_decision(state, now_s);
        }
        let situation = Situation {
            time_s: now_s + self.response.response().dead_time_s,
            ownship: state.ownship,
            obstacles: Obstacles::Rows(&self.obstacles),
            mission: Mission::new(&self.way.waypoints_m),
            wind_mps: state.wind_mps,
        };
        Some(self.avoider.as_mut()?.step(&situation))
    }

    fn paper_decision(&mut self, state: &State, now_s: f64) -> Option<Decision> {
        let limit_rad = self.bank_limit_rad()?;
        let full_rad = self.parameters.get("ROLL_LIMIT_DEG")?.to_radians();
        let response = self.response.response();
        let sticks = self.paper.step(
            now_s + response.dead_time_s,
            (&state.ownship, state.wind_mps),
            &self.obstacles,
            self.config.protection.margin_m,
            &response,
            (limit_rad, full_rad),
        );
        let threat = self.paper.obstacle().map(|obstacle| {
            let offset = obstacle.position_m - state.ownship.position_m;
            let margin_m = obstacle.volume.margin_m(offset);
            let entry_s = margin_m / state.ownship.airspeed_mps;
            Threat {
                id: obstacle.id,
                entry_s,
                closest_s: entry_s,
                margin_m,
            }
        });
        let (avoider_state, reason) = match sticks.map(|sticks| sticks.phase) {
            None | Some(Phase::Done) => (AvoiderState::Cruise, Reason::Clear),
            Some(Phase::Waiting) => (AvoiderState::Threatened, Reason::WaitingForStart),
            Some(Phase::TurningBack) => (AvoiderState::Recovering, Reason::RejoinKept),
            Some(_) => (AvoiderState::Avoiding, Reason::ManeuverKept),
        };
        self.paper_roll_us = sticks.map_or(1500, |sticks| sticks.roll_us);
        self.commanded.bank_rad = sticks.map_or(0.0, |sticks| sticks.bank_rad);
        let record = Record {
            reason,
            threat,
            ..Record::default()
        };
        Some(Decision {
            state: avoider_state,
            command: Maneuver::hold(),
            record,
        })
    }

    /// Airspeed as measured, or the one of cruise, metres per second.
    fn airspeed_mps(&self) -> Option<f64> {
        let measured = self.ownship.airspeed_mps().filter(|v| *v > 5.0);
        measured.or_else(|| self.parameters.get("AIRSPEED_CRUISE"))
    }

    /// The largest bank that is commanded now, radians.
    pub(super) fn bank_limit_rad(&self) -> Option<f64> {
        self.parameters
            .bank_limit_rad(&self.config, self.airspeed_mps()?)
    }

    /// The largest bank that is commanded in need, radians; `None` where there is none of its own.
    pub(super) fn bank_in_need_rad(&self) -> Option<f64> {
        self.parameters
            .bank_in_need_rad(&self.config, self.airspeed_mps()?)
    }

    /// The limits in need: only a bank that is commanded can be steeper.
    fn vehicle_in_need(&self, airspeed_mps: f64) -> Option<Vehicle> {
        if self.config.command.mode != CommandMode::Attitude {
            return None;
        }
        let response = Response {
            dead_time_s: 0.0,
            ..self.steep_response()
        };
        self.parameters
            .vehicle_in_need(&self.config, airspeed_mps, response)
    }

    fn renew_avoider(&mut self, now_s: f64) -> Option<()> {
        let mut response = self.response.response();
        // The dead time is spent before the state that the avoider is given; the rest is planned.
        response.dead_time_s = 0.0;
        if self.config.command.mode == CommandMode::Heading {
            // Heading commands are followed with a slow tail.
            response.bank_time_constant_s += 0.6;
        }
        let airspeed_mps = self.airspeed_mps()?;
        let wanted = self
            .parameters
            .vehicle(&self.config, airspeed_mps, response)?;
        let in_need = self.vehicle_in_need(airspeed_mps);
        if let Some(avoider) = &mut self.avoider {
            // One that cannot be flown is none.
            let _ = avoider.set_vehicle_in_need(in_need);
            let known = *avoider.vehicle();
            let off = |a: f64, b: f64| (a - b).abs() > LIMITS_CHANGE * b.abs();
            // Also the limits of a climb: the parameters for them may come later than the others.
            let changed = off(wanted.airspeed_mps, known.airspeed_mps)
                || off(wanted.climb_max_rad, known.climb_max_rad)
                || off(wanted.climb_min_rad, known.climb_min_rad)
                || off(wanted.course_rate_radps(), known.course_rate_radps())
                || off(
                    wanted.response.bank_time_constant_s,
                    known.response.bank_time_constant_s,
                );
            // Limits that get worse count at once; better ones only between manoeuvres.
            let worse = wanted.course_rate_radps() < known.course_rate_radps();
            if changed && (worse || avoider.state() == AvoiderState::Cruise) {
                // Checked by the same rules when the avoider was made.
                let _ = avoider.set_vehicle(wanted);
            }
            return Some(());
        }
        let protection = &self.config.protection;
        let start = protection.safety_score.map_or(Start::Free, Start::Score);
        let settings = Settings {
            start,
            decision_period_s: self.config.command.decision_period_s,
            // What is too far away is left out before.
            surveillance_radius_m: f64::INFINITY,
            horizon_s: protection.horizon_s,
            margin_m: protection.margin_m,
            confidence_sigmas: protection.confidence_sigmas,
            ..Settings::default()
        };
        match Avoider::new(settings, wanted) {
            Ok(avoider) => {
                self.avoider = Some(Box::new(avoider));
                Some(())
            }
            Err(error) => {
                self.note(now_s, "limits", json!({ "error": error.to_string() }));
                None
            }
        }
    }

    /// Takes over, goes on, or hands back.
    fn act_on(&mut self, decision: &Decision, state: &State, now_s: f64) {
        let wants = match decision.state {
            AvoiderState::Avoiding => true,
            AvoiderState::Threatened => {
                decision
                    .record
                    .start_s
                    .is_some_and(|start_s| start_s < PREPARE_S)
                    && self.config.command.mode != CommandMode::Paper
            }
            AvoiderState::Cruise | AvoiderState::Recovering => false,
        };
        if self.keeper.state() == Authority::Ready && wants && now_s >= self.pause_until_s {
            let Some(heard) = self.heard else { return };
            if self.dry_run {
                self.pause_until_s = now_s + 5.0;
                self.tell_dry(decision, now_s);
                return;
            }
            if self.refusals >= MOST_REFUSALS {
                self.refusals = 0;
                self.set_enabled(false, now_s);
                self.tell(
                    Severity::Critical,
                    "fga: refused too often, switched off",
                    now_s,
                );
                return;
            }
            let actions = self.keeper.take_over(heard.mode, now_s);
            self.perform(&actions, now_s);
            self.command(now_s);
            return;
        }
        if !self.keeper.commands() {
            return;
        }
        let done = match self.config.command.mode {
            CommandMode::Paper => !self.paper.is_turning(),
            _ => self.is_back(decision, state, now_s),
        };
        if done {
            if self.config.command.mode == CommandMode::Paper {
                // The stick is centred before CRUISE sees it.
                self.send_override(Some(1500));
            }
            self.resume_item(now_s);
            let actions = self.keeper.hand_back(now_s);
            self.perform(&actions, now_s);
        }
    }

    fn tell_dry(&mut self, decision: &Decision, now_s: f64) {
        let name = decision
            .record
            .threat
            .map_or("?".to_owned(), |t| self.obstacle_name(t.id));
        self.tell(
            Severity::Warning,
            &format!("fga: would avoid {name} (dry run)"),
            now_s,
        );
    }

    /// Whether the way is met again and nothing threatens.
    fn is_back(&mut self, decision: &Decision, state: &State, now_s: f64) -> bool {
        if decision.state != AvoiderState::Cruise {
            self.resumed = false;
        }
        // The way back of a manoeuvre that an earlier run began is the vehicle's own.
        let on_way =
            decision.state == AvoiderState::Cruise && (self.resumed || self.is_on_leg(state));
        if !on_way {
            self.on_way_since_s = None;
            return false;
        }
        now_s - *self.on_way_since_s.get_or_insert(now_s) >= ON_LEG_FOR_S
    }

    fn log_decision(&mut self, now_s: f64) {
        let Some(decided) = self.decided else { return };
        let (state, reason) = (decided.decision.state, decided.decision.record.reason);
        let again = match self.last_logged {
            Some((last_state, last_reason, at_s)) => {
                (last_state, last_reason) != (state, reason)
                    || (state != AvoiderState::Cruise && now_s - at_s >= 1.0)
            }
            None => true,
        };
        if !again {
            return;
        }
        self.last_logged = Some((state, reason, now_s));
        let line = telling::decision_line(
            now_s,
            &decided.decision,
            &decided.own,
            &self.keeper.state(),
            |id| self.obstacle_name(id),
        );
        self.push_log(line);
    }
}

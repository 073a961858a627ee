//! From telemetry and tracks to a decision, and from the decision to who flies.

use fga::avoider::{Decision, Reason, State as AvoiderState};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga::situation::{Mission, Obstacles, Ownship, Situation};
use fga::vehicle::{Response, Vehicle};
use fga::zone::Zone;
use serde_json::json;

use super::decider::Decider;
use super::{Companion, Decided};
use crate::authority::{Authority, Fault, Severity};
use crate::ownship::State;
use crate::telling;

/// The vehicle gets its mode back after this long on the leg, seconds.
const ON_LEG_FOR_S: f64 = 0.4;
/// A manoeuvre that is taken up again listens this long for traffic before it may end, seconds: the longest interval of reports
/// (5 s), and the delay of one.
const LISTENS_S: f64 = 6.0;
/// A program that is to end gives the mode back when the vehicle's own course keeps this much more clear than the margin, m.
const ENDS_CLEAR_M: f64 = 30.0;
/// Without a threat the vehicle gets its mode back beside the leg after this long, seconds, and flies to the leg by itself.
const BESIDE_LEG_S: f64 = 30.0;
/// The companion takes over when a manoeuvre begins within this time, seconds.
const PREPARE_S: f64 = 0.6;
/// A change of airspeed or response that requires new limits, as a share.
const LIMITS_CHANGE: f64 = 0.02;
/// How fast the moment of a decision follows the estimated dead time, as a share of the clock's pace.
const AHEAD_PACE: f64 = 0.5;
/// A mission climbs or descends where its waypoint is this much higher or lower, metres.
const CLIMBS_M: f64 = 10.0;
/// Telemetry is stale after this many of its measured intervals, if these are long.
const STALE_INTERVALS: f64 = 2.5;
/// After this many refusals in a row the operator must arm the companion again.
const MOST_REFUSALS: u32 = 3;

impl Companion {
    /// The state at the moment at which a command sent now takes effect.
    pub(super) fn state_ahead(&mut self, now_s: f64) -> Option<State> {
        let response = self.flown_response();
        self.ownship
            .state_at(now_s + self.ahead_s, &self.commanded_lately, &response)
    }

    /// Whether the last decision uses the bank in need.
    pub(super) fn is_in_need(&self) -> bool {
        self.decided
            .is_some_and(|decided| decided.decision.record.in_need)
    }

    /// How the vehicle follows at banks steeper than the normal one.
    fn steep_response(&self) -> Response {
        self.steep_response.steep_response(self.link_response())
    }

    /// How the vehicle follows over the link.
    pub(super) fn link_response(&self) -> Response {
        let response = self.response.response();
        Response {
            dead_time_s: response.dead_time_s + self.link_dead_time_s,
            ..response
        }
    }

    /// How the vehicle follows its present commands.
    pub(super) fn flown_response(&self) -> Response {
        if self.is_in_need() {
            self.steep_response()
        } else {
            self.link_response()
        }
    }

    /// Follows the estimated dead time, slower than the clock: the moment of a decision never goes back,
    /// because the avoider would forget its plan.
    fn follow_dead_time(&mut self, now_s: f64) {
        let most_s = AHEAD_PACE * (now_s - self.ahead_at_s).max(0.0);
        self.link_dead_time_s = self.trips.dead_time_s();
        let off_s = self.link_response().dead_time_s - self.ahead_s;
        self.ahead_s += off_s.clamp(-most_s, most_s);
        self.ahead_at_s = now_s;
    }

    pub(super) fn decide(&mut self, now_s: f64) {
        self.follow_dead_time(now_s);
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
        self.tell_airspeed(now_s);
        self.tell_readiness(lacking, now_s);
        if before == Authority::Waiting && self.keeper.state() == Authority::Ready {
            self.forget_plan();
        }
        // Before the take-off too: a ground station needs minutes.
        self.order_ground(now_s);
        let Some(state) = state else { return };
        self.lay_fence(now_s);
        if self.keeper.is_engaged() && state.above_home_m < self.config.limits.floor_m - 10.0 {
            self.fault(Fault::BelowFloor, now_s);
        }
        if !self.keeper.commands() {
            self.hand.watch(&state);
        }
        let Some(mut decision) = self.decision_for(&state, now_s) else {
            self.undecided_s.get_or_insert(now_s);
            return;
        };
        self.counts.decisions += 1;
        self.undecided_s = None;
        self.watch_passing(state.ownship.position_m);
        let is_back = decision.state == AvoiderState::Cruise;
        if self.keeper.commands() && self.listens(now_s) && is_back {
            // The course of the manoeuvre: the way back may lead to what was not heard yet.
            decision.command = Maneuver::hold();
        }
        self.decided = Some(Decided {
            decision,
            for_s: now_s + self.ahead_s,
            own: state,
        });
        if decision.record.in_need
            && self.keeper.commands()
            && !core::mem::replace(&mut self.told.need, true)
        {
            self.tell(Severity::Warning, "fga: bank in need", now_s);
        }
        let no_way = decision.state == AvoiderState::Threatened
            && decision.record.reason == Reason::BestAvailable;
        if core::mem::replace(&mut self.told.no_way, no_way) != no_way && no_way {
            let id = decision.record.threat.map(|threat| threat.id);
            let name = id.map_or("?".to_owned(), |id| self.obstacle_name(id));
            let words = format!("fga: no way round {name} keeps it, not begun");
            self.tell(Severity::Warning, &words, now_s);
        }
        self.watch_ground(&decision, &state, now_s);
        self.log_decision(now_s);
        self.send_collision(now_s);
        self.act_on(&decision, &state, now_s);
        self.judge_gap(&decision, &state, now_s);
    }

    /// Telemetry older than this is stale, seconds: as configured, or more than two messages late
    /// if the vehicle sends them slowly.
    pub(super) fn stale_s(&self) -> f64 {
        let configured_s = self.config.safety.telemetry_stale_s;
        let interval_s = self.rates.interval_s().filter(|_| self.rates.is_usable());
        interval_s.map_or(configured_s, |s| configured_s.max(STALE_INTERVALS * s))
    }

    fn decision_for(&mut self, state: &State, now_s: f64) -> Option<Decision> {
        self.renew_way(state, now_s);
        self.renew_decider(now_s)?;
        self.gather_obstacles(state, now_s);
        self.watch_alerts(state, now_s);
        self.watch_crossing(state.ownship.position_m, now_s);
        self.grow_obstacles(now_s);
        let decider = self.decider.take()?;
        let zones = self.fence_zones(state.ownship.position_m);
        let ground = self.bounding_ground(now_s);
        let step = |mut decider: Decider, bounds| {
            let decision = decider.step(&self.situation(state, bounds, now_s));
            (decider, decision)
        };
        // Fence and ground bound manoeuvres and begin none: a vehicle that flies by itself among nothing else is left alone.
        let is_bounded = !zones.is_empty() || ground.is_some();
        let free =
            (is_bounded && !self.keeper.is_engaged()).then(|| step(decider.clone(), (&[], None)));
        let quiet = free.filter(|(_, decision)| decision.state == AvoiderState::Cruise);
        let (decider, decision, without) = if let Some((decider, decision)) = quiet {
            (decider, decision, None)
        } else {
            let before = self.known_ground().map(|_| decider.clone());
            let (decider, decision) = step(decider, (&zones, ground.as_ref()));
            let before = before.filter(|_| self.asks_without_ground(&decision));
            let without = before.map(|before| step(before, (&zones, None)).1);
            (decider, decision, without)
        };
        drop(zones);
        self.note_bounds(&decision, without.as_ref());
        self.decider = Some(decider);
        Some(decision)
    }

    fn situation<'a>(
        &'a self,
        state: &State,
        (zones, ground): (&'a [Zone<'a>], Option<&'a Ground<'a>>),
        now_s: f64,
    ) -> Situation<'a> {
        Situation {
            time_s: now_s + self.ahead_s,
            ownship: Ownship {
                climb_rad: self.lasting_climb_rad(state),
                ..state.ownship
            },
            obstacles: Obstacles::Rows(&self.obstacles),
            mission: Mission {
                zones,
                ground,
                ..Mission::new(&self.way.waypoints_m)
            },
            wind_mps: state.wind_mps,
        }
    }

    /// The climb angle that lasts, radians: a vehicle that keeps its altitude climbs and sinks by some degrees in a turn, and levels off.
    pub(super) fn lasting_climb_rad(&self, state: &State) -> f64 {
        let climb_rad = state.ownship.climb_rad;
        let waypoint_m = self.way.waypoints_m.get(1);
        let to_climb_m = waypoint_m.map_or(0.0, |m| m.z - state.ownship.position_m.z);
        let follows_mission =
            !self.keeper.commands() && to_climb_m * climb_rad > 0.0 && to_climb_m.abs() > CLIMBS_M;
        if self.config.vehicle.vertical || follows_mission {
            climb_rad
        } else {
            0.0
        }
    }

    /// Measured airspeed, or cruise airspeed, metres per second.
    fn airspeed_mps(&self) -> Option<f64> {
        let measured = self.ownship.airspeed_mps().filter(|v| *v > 5.0);
        measured.or_else(|| self.parameters.get("AIRSPEED_CRUISE"))
    }

    /// The largest bank to command now, radians.
    pub(super) fn bank_limit_rad(&self) -> Option<f64> {
        self.parameters
            .bank_limit_rad(&self.config, self.airspeed_mps()?)
    }

    /// The largest bank to command in need, radians; `None` without a separate one.
    pub(super) fn bank_in_need_rad(&self) -> Option<f64> {
        self.parameters
            .bank_in_need_rad(&self.config, self.airspeed_mps()?)
    }

    /// The limits in need: only a hand that commands a bank can bank more.
    fn vehicle_in_need(&self, airspeed_mps: f64) -> Option<Vehicle> {
        if !self.hand.commands_bank() {
            return None;
        }
        let response = Response {
            dead_time_s: 0.0,
            ..self.steep_response()
        };
        self.parameters
            .vehicle_in_need(&self.config, airspeed_mps, response)
    }

    /// Makes the decider, or gives it the vehicle's present limits.
    fn renew_decider(&mut self, now_s: f64) -> Option<()> {
        let mut response = self.response.response();
        // The decider's state is after the dead time, so its response has no dead time; the rest stays in the plan.
        response.dead_time_s = 0.0;
        response.bank_time_constant_s += self.hand.lag_s();
        let airspeed_mps = self.airspeed_mps()?;
        let wanted = self
            .parameters
            .vehicle(&self.config, airspeed_mps, response)?;
        let in_need = self.vehicle_in_need(airspeed_mps);
        if let Some(decider) = &mut self.decider {
            decider.set_vehicle_in_need(in_need);
            let known = decider.vehicle();
            // Worse limits count at once; better ones only between manoeuvres, or where no proof rests on the limits.
            let worse = wanted.course_rate_radps() < known.course_rate_radps();
            let idle = decider.state() == AvoiderState::Cruise;
            if differs(&wanted, known) && (worse || idle || !decider.proves()) {
                decider.retune(&wanted);
            }
            return Some(());
        }
        match Decider::new(&self.config, wanted) {
            Ok(decider) => {
                self.decider = Some(decider);
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
            AvoiderState::Threatened => decision
                .record
                .start_s
                .is_some_and(|start_s| start_s < PREPARE_S),
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
        let is_back = self.is_back(decision, state, now_s);
        // The vehicle answers while the aircraft settles on the leg.
        let is_set = self.on_way_since_s.is_some() && self.item_is_set(now_s);
        let clear_m = self.config.protection.margin_m + ENDS_CLEAR_M;
        let ends = self.ending_s.is_some()
            && !self.listens(now_s)
            && (is_back || !self.given_back_collides(state, clear_m));
        if !(is_back && is_set || ends && self.item_is_set(now_s)) {
            return;
        }
        if ends {
            self.fault(Fault::ProgramEnds, now_s);
        } else {
            self.fly_straight(now_s);
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

    /// Whether it has taken up a manoeuvre so lately that aircraft may not have reported yet: nothing heard is no
    /// evidence that nothing threatens.
    fn listens(&self, now_s: f64) -> bool {
        self.resumed_s
            .is_some_and(|since_s| now_s - since_s < LISTENS_S)
    }

    /// Whether the aircraft is back on its way and nothing threatens.
    fn is_back(&mut self, decision: &Decision, state: &State, now_s: f64) -> bool {
        if decision.state != AvoiderState::Cruise {
            self.cruises_since_s = None;
        }
        if self.listens(now_s) {
            return false;
        }
        let on_way = match decision.state {
            AvoiderState::Cruise => {
                let since_s = *self.cruises_since_s.get_or_insert(now_s);
                self.is_on_leg(state) || now_s - since_s >= BESIDE_LEG_S
            }
            // The end of a planned way back leaves time for the slowest roll.
            AvoiderState::Recovering => {
                decision.record.threat.is_none()
                    && self.turns_onto_leg(decision)
                    && self.is_on_leg(state)
            }
            AvoiderState::Threatened | AvoiderState::Avoiding => false,
        };
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
            self.known_ground()
                .and_then(|ground| ground.above_m(decided.own.ownship.position_m)),
            |id| self.obstacle_name(id),
        );
        self.push_log(line);
    }
}

/// Whether limits differ enough to plan with the new ones.
fn differs(wanted: &Vehicle, known: &Vehicle) -> bool {
    let off = |a: f64, b: f64| (a - b).abs() > LIMITS_CHANGE * b.abs();
    // Also the limits of a climb: their parameters may come later than the others.
    off(wanted.airspeed_mps, known.airspeed_mps)
        || off(wanted.climb_max_rad, known.climb_max_rad)
        || off(wanted.climb_min_rad, known.climb_min_rad)
        || off(wanted.course_rate_radps(), known.course_rate_radps())
        || off(
            wanted.response.bank_time_constant_s,
            known.response.bank_time_constant_s,
        )
}

//! What is to be flown: from a state and its surroundings to a decision.

use fga::Vec3;
use fga::angle::course_of;
use fga::avoider::{Decision, Reason, State as AvoiderState};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga::situation::{Mission, Obstacles, Ownship, Situation};
use fga::vehicle::{Response, Vehicle};
use fga::zone::Zone;
use serde_json::json;

use super::Companion;
use super::decider::CompanionPilot;
use super::decisions::Decided;
use super::nearest::LeastSeparation;
use super::route::RouteMoment;
use crate::mode::Mode;
use crate::ownship::OwnState;
use crate::telling;

/// The last seconds before the closest approach, in which no turn makes up for what is not known of the turn; and the standard deviations
/// of a drift that the avoider keeps clear.
const TOO_LATE_S: f64 = 3.0;
const DRIFT_SIGMAS: f64 = 3.0;
/// A mission climbs or descends where its waypoint is this much higher or lower, metres.
const CLIMBS_M: f64 = 10.0;

impl Companion {
    /// Observes, decides, authorizes, and commands at once what has just been taken over.
    pub(super) fn decide(&mut self, now_s: f64) {
        self.due.decision_s = now_s + self.config.command.decision_period_s;
        let Some(state) = self.observe(now_s) else {
            return;
        };
        let Some(decision) = self.decision_for(&state, now_s) else {
            self.decisions.miss(now_s);
            return;
        };
        self.watch_promise(&decision, &state, now_s);
        self.report(&decision, &state, now_s);
        if self.authorize(&decision, &state, now_s) {
            self.command(now_s);
        }
    }

    /// After telemetry: decides and commands when due.
    pub(super) fn prompted(&mut self, now_s: f64) {
        // The target that follows the plan goes out first: a search may take longer.
        if now_s >= self.due.command_s - 0.2 / self.config.command.rate_hz {
            self.command(now_s);
        }
        // A little early is better than a whole period late.
        let slack_s = 0.2 * self.config.command.decision_period_s;
        if now_s >= self.due.decision_s - slack_s {
            self.decide(now_s);
            let decided = self.decisions.last();
            let reason = decided.map(|decided| decided.decision.record.reason);
            let is_new = matches!(
                reason,
                Some(
                    Reason::ManeuverChosen
                        | Reason::ManeuverReplaced
                        | Reason::BestAvailable
                        | Reason::RejoinChosen
                )
            );
            if is_new {
                self.command(now_s);
            }
        }
    }

    /// Compares the flight with what was certified; one that is off takes away most of what was learned.
    fn watch_promise(&mut self, decision: &Decision, state: &OwnState, now_s: f64) {
        let at_s = self.lead.acts_s(now_s);
        let goes_on = matches!(
            decision.record.reason,
            Reason::ManeuverKept | Reason::RejoinKept
        );
        if !self.keeper.commands() {
            return self.promise.end();
        }
        if goes_on {
            let Some(off_m) = self.promise.compare(state, at_s) else {
                return;
            };
            self.lead.forget();
            self.told.missed(off_m, &mut self.voice);
            return;
        }
        let own = self.lasting(state);
        let pilot = self.decisions.pilot();
        let vehicle = pilot.and_then(|pilot| {
            if decision.record.in_need {
                pilot.vehicle_in_need()
            } else {
                Some(pilot.vehicle())
            }
        });
        if let Some(vehicle) = vehicle.filter(|_| pilot.is_some_and(CompanionPilot::certifies)) {
            self.promise.make(&decision.command, &own, vehicle, at_s);
        }
    }

    /// Tells the operator and the log of a decision.
    fn report(&mut self, decision: &Decision, state: &OwnState, now_s: f64) {
        if decision.record.in_need && self.keeper.commands() {
            self.told.need(&mut self.voice);
        }
        let no_way = decision.state == AvoiderState::Threatened
            && decision.record.reason == Reason::BestAvailable;
        let round = no_way.then(|| self.threat_name(decision));
        self.told.no_way(round, &mut self.voice);
        let lasting = self.lasting(state);
        let (own_m, parameters) = (state.ownship.position_m, self.requests.parameters());
        if self.keeper.commands() && self.boundary.is_outside(own_m, parameters) {
            self.told.outside_fence(&mut self.voice);
        }
        let (around, keeper, voice) = (&self.around, &self.keeper, &mut self.voice);
        self.over.watch(decision, &lasting, around, keeper, voice);
        self.log_decision(now_s);
        self.send_collision(now_s);
    }

    /// The decision about a state; `None` until the vehicle's limits are known.
    fn decision_for(&mut self, state: &OwnState, now_s: f64) -> Option<Decision> {
        self.renew_way(state);
        self.renew_pilot()?;
        self.look_around(state, now_s);
        let pilot = self.decisions.lend_pilot()?;
        let own_m = state.ownship.position_m;
        let zones = self.boundary.zones(self.requests.parameters(), own_m);
        let ground = self.over.raised(self.growth_m(now_s));
        let step = |mut pilot: CompanionPilot, bounds| {
            let decision = pilot.step(&self.situation(state, bounds, now_s));
            (pilot, decision)
        };
        // Fence and ground bound manoeuvres and begin none: a vehicle that flies by itself among nothing else is left alone.
        let is_bounded = !zones.is_empty() || ground.is_some();
        let free =
            (is_bounded && !self.keeper.is_engaged()).then(|| step(pilot.clone(), (&[], None)));
        let quiet = free.filter(|(_, decision)| decision.state == AvoiderState::Cruise);
        let (pilot, mut decision, without) = if let Some((pilot, decision)) = quiet {
            (pilot, decision, None)
        } else {
            let before = self.over.known().map(|_| pilot.clone());
            let (pilot, decision) = step(pilot, (&zones, ground.as_ref()));
            let before = before.filter(|_| self.over.asks_without(&decision));
            let without = before.map(|before| step(before, (&zones, None)).1);
            (pilot, decision, without)
        };
        drop(zones);
        self.over.note_bounds(&decision, without.as_ref());
        self.route.fly_leg(pilot.leg_index());
        self.passing.watch(self.route.way(), own_m);
        let is_back = decision.state == AvoiderState::Cruise;
        if self.keeper.commands() && self.handover.listens(now_s) && is_back {
            // The course of the manoeuvre: the way back may lead to what was not heard yet.
            decision.command = Maneuver::hold().into();
        }
        let decided = Decided {
            decision,
            for_s: self.lead.acts_s(now_s),
            own: *state,
        };
        self.decisions.take(pilot, &decided);
        Some(decision)
    }

    /// Looks at the way that the vehicle would fly by itself; another one needs another plan.
    fn renew_way(&mut self, state: &OwnState) {
        let Some(heard) = self.session.mode() else {
            return;
        };
        let (owed, is_engaged) = (self.keeper.owed(), self.keeper.is_engaged());
        if owed.is_some() && owed == self.route.mode() && !is_engaged {
            return;
        }
        let has_pilot = self.decisions.pilot().is_some();
        let moment = RouteMoment {
            own_m: state.ownship.position_m,
            track_rad: course_of(state.ground_velocity_mps),
            mode: owed.unwrap_or(heard),
            is_engaged: is_engaged && has_pilot,
            is_busy: self.decisions.is_busy(),
        };
        let (lists, parameters) = (self.requests.lists(), self.requests.parameters());
        let (ownship, voice) = (&self.ownship, &mut self.voice);
        if self.route.renew(&moment, lists, ownship, parameters, voice) {
            self.decisions.begin_way();
            self.passing
                .begin_way(&self.route, moment.own_m, lists, ownship);
        }
    }

    /// Gathers what the decision is about, and reports what the alerts and the fence say of it.
    fn look_around(&mut self, state: &OwnState, now_s: f64) {
        let at = (state, self.lead.acts_s(now_s));
        let (frame, route, voice) = (self.ownship.frame(), &self.route, &mut self.voice);
        self.around.gather(at, frame, route, &self.config, voice);
        let (around, own_m) = (&self.around, state.ownship.position_m);
        LeastSeparation::watch(&mut self.least, own_m, now_s, around.obstacles(), |id| {
            around.name(id)
        });
        let vehicle = self.decisions.pilot().map(CompanionPilot::vehicle);
        if vehicle.is_some_and(Vehicle::can_climb) {
            self.around.add_layers(state, route, &self.config);
        }
        if let (Some(alerts), Some(_)) = (&mut self.alerts, vehicle) {
            let threat = self.decisions.threat();
            if let Some(start) = alerts.watch(state, threat, &self.around, voice) {
                self.decisions.set_start(start);
            }
        }
        // Until the vehicle has answered which kinds of fence count, all do.
        let parameters = self.requests.parameters();
        if route.mode() == Some(Mode::AUTO) && parameters.is_complete() {
            let (met_m, left_m) = route.left_m(state.ownship.position_m);
            let way_m: Vec<Vec3> = core::iter::once(met_m)
                .chain(left_m.iter().copied())
                .collect();
            let mission = self.requests.lists().mission_number();
            self.boundary
                .watch_crossing(mission, &way_m, parameters, voice);
        }
        self.around.grow(self.growth_m(now_s));
    }

    fn situation<'a>(
        &'a self,
        state: &OwnState,
        (zones, ground): (&'a [Zone<'a>], Option<&'a Ground<'a>>),
        now_s: f64,
    ) -> Situation<'a> {
        Situation {
            time_s: self.lead.acts_s(now_s),
            ownship: self.lasting(state).ownship,
            obstacles: Obstacles::Rows(self.around.obstacles()),
            mission: Mission {
                zones,
                ground,
                ..Mission::new(self.route.waypoints_m())
            },
            wind_mps: state.wind_mps,
        }
    }

    /// The state with the climb that lasts: a vehicle that keeps its altitude climbs and sinks by some degrees in a turn, and levels off.
    pub(super) fn lasting(&self, state: &OwnState) -> OwnState {
        let waypoint_m = self.route.waypoints_m().get(1);
        let to_climb_m = waypoint_m.map_or(0.0, |m| m.z - state.ownship.position_m.z);
        let follows_mission = !self.keeper.commands()
            && to_climb_m * state.ownship.climb_rad > 0.0
            && to_climb_m.abs() > CLIMBS_M;
        if self.config.vehicle.vertical || follows_mission {
            return *state;
        }
        let ownship = Ownship {
            climb_rad: 0.0,
            ..state.ownship
        };
        OwnState {
            ownship,
            ground_velocity_mps: ownship.velocity_mps() + state.wind_mps,
            ..*state
        }
    }

    /// The limits in need: only a hand that commands a bank can bank more.
    fn vehicle_in_need(&self, airspeed_mps: f64) -> Option<Vehicle> {
        let bank_rad = self
            .bank_in_need_rad()
            .filter(|_| self.hand.commands_bank())?;
        let response = Response {
            dead_time_s: 0.0,
            ..self.lead.steep_response()
        };
        self.requests
            .parameters()
            .vehicle(bank_rad, &self.config, airspeed_mps, response)
    }

    /// Makes the pilot, or gives it the vehicle's present limits.
    fn renew_pilot(&mut self) -> Option<()> {
        let mut response = self.lead.response();
        // The pilot's state is after the dead time, so its response has no dead time; the rest stays in the plan.
        response.dead_time_s = 0.0;
        response.bank_time_constant_s += self.hand.lag_s();
        let airspeed_mps = self.airspeed_mps()?;
        if self.keeper.commands() {
            self.told.flies_at(airspeed_mps, &mut self.voice);
        }
        let bank_rad = self.bank_limit_rad()?;
        let parameters = self.requests.parameters();
        let wanted = parameters.vehicle(bank_rad, &self.config, airspeed_mps, response)?;
        let in_need = self.vehicle_in_need(airspeed_mps);
        let asks_margin = self.config.response.margin || self.promise.counts().1 > 0;
        let off_m = self.lead.off_m(bank_rad, TOO_LATE_S) * f64::from(u8::from(asks_margin));
        let drift_mps = off_m / (DRIFT_SIGMAS * TOO_LATE_S);
        let tuned = self
            .decisions
            .tune(&self.config, &wanted, in_need, drift_mps);
        if let Err(error) = &tuned {
            self.voice
                .note("limits", json!({ "error": error.to_string() }));
        }
        tuned.ok()
    }

    fn log_decision(&mut self, now_s: f64) {
        let Some(decided) = self.decisions.news(now_s) else {
            return;
        };
        let line = telling::decision_line(
            now_s,
            &decided.decision,
            &decided.own,
            &self.keeper.state(),
            self.over
                .known()
                .and_then(|ground| ground.above_m(decided.own.ownship.position_m)),
            |id| self.around.name(id),
        );
        self.voice.log(line);
    }
}

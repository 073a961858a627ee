//! Who flies: the companion takes over, goes on or hands back.

use fga::avoider::Decision;
use fga::vehicle::Vehicle;

use super::Companion;
use crate::authority::{Authority, Fault, Severity};
use crate::mode::Mode;
use crate::ownship::OwnState;

/// A program that is to end gives the mode back when the vehicle's own course keeps this much more clear than the margin, m.
const ENDS_CLEAR_M: f64 = 30.0;

impl Companion {
    /// Takes over, goes on, or hands back; `true` where a manoeuvre has just begun.
    pub(super) fn authorize(&mut self, decision: &Decision, state: &OwnState, now_s: f64) -> bool {
        let is_ready = self.keeper.state() == Authority::Ready;
        let begins = is_ready
            && self.handover.wants_control(decision, now_s)
            && self.take_over(decision, now_s);
        if !begins && self.keeper.commands() {
            self.hand_back(decision, state, now_s);
        }
        self.judge_gap(decision, state, now_s);
        begins
    }

    fn take_over(&mut self, decision: &Decision, now_s: f64) -> bool {
        let Some(mode) = self.session.mode() else {
            return false;
        };
        if self.session.is_dry_run() {
            self.handover.pause(now_s);
            let name = self.threat_name(decision);
            self.voice
                .warn(&format!("fga: would avoid {name} (dry run)"));
            return false;
        }
        if self.handover.is_refused_too_often() {
            self.set_enabled(false, now_s);
            self.voice
                .tell(Severity::Critical, "fga: refused too often, switched off");
            return false;
        }
        self.keep(now_s, |keeper| keeper.take_over(mode, now_s));
        true
    }

    fn hand_back(&mut self, decision: &Decision, state: &OwnState, now_s: f64) {
        let climbs = self.vehicle().is_some_and(Vehicle::can_climb);
        let on_leg = self.route.is_on_leg(state, climbs);
        let turns_onto_leg = self.route.turns_onto_leg(&decision.command, state);
        let is_back = self
            .handover
            .is_back(decision, on_leg, turns_onto_leg, now_s);
        // The vehicle answers while the aircraft settles on the leg.
        let is_set = self.handover.settles() && self.item_is_set();
        let clear_m = self.config.protection.margin_m + ENDS_CLEAR_M;
        let is_clear =
            || decision.record.threat.is_none() && !self.given_back_collides(state, clear_m);
        let ends =
            self.handover.is_ending() && !self.handover.listens(now_s) && (is_back || is_clear());
        if !(is_back && is_set || ends && self.item_is_set()) {
            return;
        }
        if ends {
            self.fault(Fault::ProgramEnds, now_s);
        } else {
            if !on_leg {
                let beside_m = self.route.beside_leg_m(state).unwrap_or(0.0);
                self.voice
                    .warn(&format!("fga: gives back {beside_m:.0} m beside the leg"));
            }
            self.fly_straight(now_s);
            self.keep(now_s, |keeper| keeper.hand_back(now_s));
        }
    }

    /// Decides whether to fly on through a gap of the telemetry.
    fn judge_gap(&mut self, decision: &Decision, state: &OwnState, now_s: f64) {
        if !self.flies_blind(now_s) {
            self.gap.end();
            return;
        }
        let (age_s, by_m) = (self.telemetry_age_s(now_s), self.growth_m(now_s));
        let is_proven = !decision.record.reason.is_unproven();
        let collides = !is_proven && self.given_back_collides(state, -by_m);
        if self
            .gap
            .is_over(age_s, is_proven, collides, &mut self.voice)
        {
            self.end_gap(now_s);
        }
    }

    /// The gap has lasted too long.
    pub(super) fn end_gap(&mut self, now_s: f64) {
        self.gap.end();
        let link_lost_s = self.config.safety.link_lost_s;
        let lost = self
            .session
            .silent_s(now_s)
            .is_some_and(|s| s > link_lost_s);
        let fault = if lost {
            Fault::LinkLost
        } else {
            Fault::TelemetryStale
        };
        self.fault(fault, now_s);
    }

    /// Whether the vehicle, with its mode restored now, is known to come nearer to a volume than `clear_m`.
    pub(super) fn given_back_collides(&self, state: &OwnState, clear_m: f64) -> bool {
        self.vehicle().is_some_and(|vehicle| {
            let rate_radps = vehicle.course_rate_radps();
            self.route
                .given_back_collides(state, rate_radps, self.around.obstacles(), clear_m)
        })
    }

    /// Whether the vehicle goes on with its mission where it should, once its mode is restored.
    fn item_is_set(&mut self) -> bool {
        let (lists, parameters, commands) = self.requests.for_commands();
        let voice = &mut self.voice;
        self.keeper.owed() != Some(Mode::AUTO)
            || self
                .passing
                .item_is_set(&self.route, lists, parameters, commands, voice)
    }
}

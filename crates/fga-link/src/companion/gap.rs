//! Gaps in the telemetry: the companion flies on a proven manoeuvre, from the last known state.
//!
//! The commands since then are known, and so is the vehicle's response; the prediction loses value with
//! every second, and the obstacles grow by the same amount. Decisions continue with that. The companion
//! restores the mode when nothing is proven any more, unless the restored course is known to collide: then
//! that is the last choice.

use fga::avoider::Decision;
use mavlink::dialects::ardupilotmega::TIMESYNC_DATA;

use super::Companion;
use super::decider::Decider;
use super::session::SILENT_S;
use super::trips::round_trip_of;
use crate::authority::{Fault, Severity};
use crate::ownship::State;

/// Least time to fly on, seconds …
const LEAST_BLIND_S: f64 = 3.0;
/// … and longest time, seconds.
const MOST_BLIND_S: f64 = 8.0;
/// The companion reports a gap that lasts this long, s.
const TOLD_S: f64 = 1.5;
/// Possible error of the prediction's acceleration, metres per second squared: gusts, and a turn rate
/// known to a few per cent.
const UNKNOWN_MPS2: f64 = 0.8;

/// The reports about the present gap.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gap {
    begun: bool,
    collision: bool,
}

impl Companion {
    /// Age of the telemetry, seconds; infinite before the first.
    pub(super) fn telemetry_age_s(&self, now_s: f64) -> f64 {
        self.ownship.age_s(now_s).unwrap_or(f64::INFINITY)
    }

    /// Whether the telemetry is too old to use unchanged.
    pub(super) fn is_blind(&self, now_s: f64) -> bool {
        self.telemetry_age_s(now_s) > self.stale_s()
    }

    /// Whether the companion flies on without telemetry.
    pub(super) fn flies_blind(&self, now_s: f64) -> bool {
        self.keeper.commands()
            && self.decider.as_ref().is_some_and(Decider::certifies)
            && self.decided.is_some()
            && self.is_blind(now_s)
            && self.telemetry_age_s(now_s) <= MOST_BLIND_S
    }

    /// Whether heartbeats are missing, so that requests have no visible effect.
    pub(super) fn is_silent(&self, now_s: f64) -> bool {
        self.session.silent_s(now_s).is_some_and(|s| s > SILENT_S)
    }

    /// Extra uncertainty of our own position, m.
    pub(super) fn growth_m(&self, now_s: f64) -> f64 {
        if !self.is_blind(now_s) {
            return 0.0;
        }
        let age_s = self.telemetry_age_s(now_s).min(MOST_BLIND_S);
        0.5 * UNKNOWN_MPS2 * age_s * age_s
    }

    /// Decides whether to fly on through the gap.
    pub(super) fn judge_gap(&mut self, decision: &Decision, state: &State, now_s: f64) {
        if !self.flies_blind(now_s) {
            self.gap = Gap::default();
            return;
        }
        let age_s = self.telemetry_age_s(now_s);
        if age_s > TOLD_S && !core::mem::replace(&mut self.gap.begun, true) {
            self.voice.warn("fga: no telemetry, flies on as proven");
        }
        let proven = !decision.record.reason.is_unproven();
        if proven || age_s <= LEAST_BLIND_S {
            return;
        }
        if self.given_back_collides(state, -self.growth_m(now_s)) {
            if !core::mem::replace(&mut self.gap.collision, true) {
                let words = "fga: no telemetry, not given back: collision";
                self.voice.tell(Severity::Critical, words);
            }
            return;
        }
        self.end_gap(now_s);
    }

    /// The gap has lasted too long.
    pub(super) fn end_gap(&mut self, now_s: f64) {
        self.gap = Gap::default();
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
    pub(super) fn given_back_collides(&self, state: &State, clear_m: f64) -> bool {
        self.vehicle().is_some_and(|vehicle| {
            let rate_radps = vehicle.course_rate_radps();
            self.route
                .given_back_collides(state, rate_radps, self.around.obstacles(), clear_m)
        })
    }

    /// Takes the vehicle's answer to what its clock reads.
    pub(super) fn take_round_trip(&mut self, data: &TIMESYNC_DATA, now_s: f64) {
        self.lead.take_round_trip(data, now_s);
        if let Some((sent_s, boot_s)) = round_trip_of(data, now_s) {
            self.ownship.round_trip(sent_s, boot_s, now_s);
            self.session.round_trip(sent_s, boot_s, now_s);
        }
    }
}

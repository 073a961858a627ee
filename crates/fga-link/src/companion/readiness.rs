//! Whether the companion may act.

use super::Companion;
use super::boundary::acts_in_guided;
use super::lacking::Lacking;
use crate::mission::is_take_off_or_landing;
use crate::mode::Mode;
use crate::ownship::State;

/// After this long without a decision no decision is possible, seconds.
const NO_DECISION_S: f64 = 0.5;

/// Below this share of its least airspeed a vehicle does not fly on its wing.
const SLOW_SHARE: f64 = 0.7;

impl Companion {
    /// Whether decisions are made.
    pub(super) fn can_decide(&self, now_s: f64) -> bool {
        self.undecided_s
            .is_none_or(|since_s| now_s - since_s <= NO_DECISION_S)
    }

    /// Whether the vehicle is too slow to fly on its wing: a quadplane that hovers in AUTO would speed up in GUIDED.
    fn is_slow(&self) -> bool {
        let least_mps = self.parameters.get("AIRSPEED_MIN");
        let airspeed_mps = self.ownship.airspeed_mps();
        airspeed_mps
            .zip(least_mps)
            .is_some_and(|(airspeed_mps, least_mps)| airspeed_mps < SLOW_SHARE * least_mps)
    }

    /// Whether the vehicle takes off or lands in its mission.
    fn takes_off_or_lands(&self) -> bool {
        let item = self.lists.item();
        item.and_then(|item| self.lists.mission_item(item))
            .is_some_and(is_take_off_or_landing)
    }

    /// The missing condition for a take-over, or for flying on.
    pub(super) fn lacking(&self, now_s: f64, state: Option<&State>) -> Option<Lacking> {
        let engaged = self.keeper.is_engaged();
        let link_lost_s = self.config.safety.link_lost_s;
        if let Some(lacking) = self.session.lacking(link_lost_s, engaged, now_s) {
            return Some(lacking);
        }
        let mode = self.session.mode()?;
        // Before all that changes with the mode: two avoiders would take turns.
        if !engaged && self.parameters.avoids_by_itself() {
            return Some(Lacking::OtherAvoider);
        }
        if !engaged && self.lead.is_too_long(now_s) {
            return Some(Lacking::SlowLink);
        }
        if !self.rates.is_usable() {
            return Some(Lacking::Rate);
        }
        let Some(state) = state else {
            return Some(Lacking::Telemetry);
        };
        // Before the vehicle is armed the operator can still mend it.
        if let Some(lacking) = self.feeds.lacking().filter(|_| !engaged) {
            return Some(lacking);
        }
        if !self.session.is_armed() {
            return Some(Lacking::Disarmed);
        }
        let floor_m = self.config.limits.floor_m;
        // A little above the floor at first, so that the manoeuvre does not cross it at once.
        let high_enough = state.above_home_m >= floor_m + 5.0
            || (engaged && state.above_home_m >= floor_m - 10.0);
        if !high_enough {
            return Some(Lacking::Height);
        }
        if !engaged && self.is_slow() {
            return Some(Lacking::Slow);
        }
        if !(engaged || self.take_over.contains(&mode)) {
            return Some(Lacking::Mode);
        }
        let mode = self.keeper.owed().filter(|_| engaged).unwrap_or(mode);
        if mode == Mode::AUTO && !self.lists.is_way_known(now_s) {
            return Some(Lacking::Mission);
        }
        if mode == Mode::AUTO && !engaged && self.takes_off_or_lands() {
            return Some(Lacking::TakeOffOrLanding);
        }
        if !self.parameters.is_sufficient() {
            return Some(Lacking::Limits);
        }
        if !engaged && acts_in_guided(&self.parameters) {
            return Some(Lacking::FenceAction);
        }
        if !engaged && self.over.is_awaited() {
            return Some(Lacking::Ground);
        }
        if self.bank_limit_rad().is_none() {
            return Some(Lacking::BankLimit);
        }
        (!self.can_decide(now_s)).then_some(Lacking::Decision)
    }
}

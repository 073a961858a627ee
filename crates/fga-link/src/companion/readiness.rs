//! Whether the companion may act, and the words for a missing condition.

use super::Companion;
use crate::authority::{Authority, Severity};
use crate::mission::is_take_off_or_landing;
use crate::mode::Mode;
use crate::ownship::State;

/// After this long without a decision no decision is possible, seconds.
const NO_DECISION_S: f64 = 0.5;
/// The companion reports what is missing after this long, s …
const LOST_S: f64 = 1.0;
/// … and if it was never ready, after this long, seconds.
const NEVER_READY_S: f64 = 8.0;

/// `FENCE_ACTION`: to the return point in GUIDED, with the pilot's throttle or not.
const FENCE_ACTS_IN_GUIDED: [f64; 2] = [6.0, 7.0];

/// Below this share of its least airspeed a vehicle does not fly on its wing.
const SLOW_SHARE: f64 = 0.7;

/// A missing condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lacking {
    Link,
    Contradiction,
    Rate,
    Telemetry,
    Disarmed,
    Height,
    Slow,
    Mode,
    Mission,
    TakeOffOrLanding,
    Limits,
    FenceAction,
    BankLimit,
    Decision,
    TwoVehicles,
    Listens,
    TwoSenders,
    FeedUnreadable,
    FeedSilent,
    OtherAvoider,
    SlowLink,
    Ground,
}

impl Lacking {
    /// What the operator reads.
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Link => "fga: not ready: no heartbeat",
            Self::Contradiction => "fga: not ready: heartbeats contradict",
            Self::Rate => "fga: not ready: telemetry comes too seldom",
            Self::Telemetry => "fga: not ready: no fresh telemetry",
            Self::Disarmed => "fga: not ready: vehicle is disarmed",
            Self::Height => "fga: not ready: too low",
            Self::Slow => "fga: not ready: too slow to fly a turn",
            Self::Mode => "fga: not ready: mode is not to be taken over",
            Self::Mission => "fga: not ready: mission is not known",
            Self::TakeOffOrLanding => "fga: not ready: take-off or landing",
            Self::FenceAction => "fga: not ready: FENCE_ACTION uses GUIDED",
            Self::Listens => "fga: not ready: listens for other vehicles",
            Self::TwoSenders => "fga: not ready: two senders with one id",
            Self::TwoVehicles => "fga: not ready: two vehicles, set system_id",
            Self::Limits => "fga: not ready: vehicle's limits not known",
            Self::OtherAvoider => "fga: not ready: AVD_F_ACTION avoids by itself",
            Self::SlowLink => "fga: not ready: link answers too late",
            Self::BankLimit => "fga: not ready: bank limit cannot be flown",
            Self::Decision => "fga: not ready: no decision possible",
            Self::FeedUnreadable => "fga: not ready: traffic feed not understood",
            Self::FeedSilent => "fga: not ready: no traffic feed",
            Self::Ground => "fga: not ready: the ground is not made yet",
        }
    }

    /// The operator's own action is no news for the operator.
    const fn severity(self) -> Severity {
        match self {
            Self::Mode | Self::Disarmed | Self::TakeOffOrLanding => Severity::Info,
            _ => Severity::Warning,
        }
    }
}

/// The reports about readiness and need.
#[derive(Debug, Clone, Copy)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each report is made once, by itself"
)]
pub(super) struct Told {
    /// Missing now, and since when, seconds.
    lacking: Option<(Lacking, f64)>,
    /// Whether the operator has read that the companion is ready.
    ready: bool,
    /// The last report.
    last: Option<Lacking>,
    /// Whether the bank in need was reported.
    pub(super) need: bool,
    /// Whether an obstacle without a way round was reported.
    pub(super) no_way: bool,
    /// Whether a failing airspeed sensor was reported, and since when it fails, seconds.
    airspeed: bool,
    airspeed_fails_s: Option<f64>,
}

impl Told {
    pub(super) const NOTHING: Self = Self {
        lacking: None,
        ready: false,
        last: None,
        need: false,
        no_way: false,
        airspeed: false,
        airspeed_fails_s: None,
    };
}

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

    /// Whether the way in AUTO is known: the mission, or while it is read the vehicle's own target and its item.
    fn knows_mission(&self, now_s: f64) -> bool {
        let Some(item) = self.mission_item else {
            return false;
        };
        let known = self.mission.items().is_some();
        known || (self.mission.item(item).is_some() && self.own_target_m(now_s).is_some())
    }

    /// Whether the vehicle takes off or lands in its mission.
    fn takes_off_or_lands(&self) -> bool {
        let item = self.mission_item.and_then(|item| self.mission.item(item));
        item.is_some_and(is_take_off_or_landing)
    }

    /// Whether the fence flies the vehicle in GUIDED: that mode would not be the companion's alone.
    fn fence_acts_in_guided(&self) -> bool {
        let value = |name| self.parameters.get(name).unwrap_or(0.0);
        value("FENCE_ENABLE") != 0.0 && FENCE_ACTS_IN_GUIDED.contains(&value("FENCE_ACTION"))
    }

    /// The missing condition for a take-over, or for flying on.
    pub(super) fn lacking(&self, now_s: f64, state: Option<&State>) -> Option<Lacking> {
        let Some(heard) = self.heard else {
            return Some(Lacking::Link);
        };
        if now_s - heard.heartbeat_s > self.config.safety.link_lost_s {
            return Some(Lacking::Link);
        }
        if self.hearing.is_contradicted(now_s) {
            return Some(Lacking::Contradiction);
        }
        if self.neighbors.is_ambiguous(now_s) {
            return Some(Lacking::TwoVehicles);
        }
        let alone =
            self.wanted_system().is_some() || !self.neighbors.may_come(heard.since_s, now_s);
        if !alone {
            return Some(Lacking::Listens);
        }
        if !self.keeper.is_engaged() && self.senders.are_two(now_s) {
            return Some(Lacking::TwoSenders);
        }
        // Before all that changes with the mode: two avoiders would take turns.
        if !self.keeper.is_engaged() && self.parameters.avoids_by_itself() {
            return Some(Lacking::OtherAvoider);
        }
        if !self.keeper.is_engaged() && self.trips.is_too_long(now_s) {
            return Some(Lacking::SlowLink);
        }
        if !self.rates.is_usable() {
            return Some(Lacking::Rate);
        }
        if self.is_blind(now_s) {
            return Some(Lacking::Telemetry);
        }
        let engaged = self.keeper.is_engaged();
        // Before the vehicle is armed the operator can still mend it.
        if let Some(lacking) = self.feeds.lacking().filter(|_| !engaged) {
            return Some(lacking);
        }
        if !heard.armed {
            return Some(Lacking::Disarmed);
        }
        // It stands or rolls.
        let Some(state) = state else {
            return Some(if self.takes_off_or_lands() {
                Lacking::TakeOffOrLanding
            } else {
                Lacking::Slow
            });
        };
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
        if !(engaged || self.take_over.contains(&heard.mode)) {
            return Some(Lacking::Mode);
        }
        let mode = self.keeper.owed().filter(|_| engaged).unwrap_or(heard.mode);
        if mode == Mode::AUTO && !self.knows_mission(now_s) {
            return Some(Lacking::Mission);
        }
        if mode == Mode::AUTO && !engaged && self.takes_off_or_lands() {
            return Some(Lacking::TakeOffOrLanding);
        }
        if !self.parameters.is_sufficient() {
            return Some(Lacking::Limits);
        }
        if !engaged && self.fence_acts_in_guided() {
            return Some(Lacking::FenceAction);
        }
        if !engaged && self.waits_for_ground() {
            return Some(Lacking::Ground);
        }
        if self.bank_limit_rad().is_none() {
            return Some(Lacking::BankLimit);
        }
        (!self.can_decide(now_s)).then_some(Lacking::Decision)
    }

    /// Reports once that ground speed and wind stand in for the airspeed sensor.
    pub(super) fn tell_airspeed(&mut self, now_s: f64) {
        if !self.ownship.airspeed_fails() {
            self.told.airspeed_fails_s = None;
            return;
        }
        // In a take-off run the airspeed comes after the ground speed.
        let since_s = *self.told.airspeed_fails_s.get_or_insert(now_s);
        if now_s - since_s >= LOST_S && !self.told.airspeed {
            self.told.airspeed = true;
            let words = "fga: airspeed sensor fails, ground speed used";
            self.tell(Severity::Warning, words, now_s);
        }
    }

    /// Reports to the operator a lost ability, or why it does not come.
    pub(super) fn tell_readiness(&mut self, lacking: Option<Lacking>, now_s: f64) {
        if self.keeper.state() == Authority::Ready {
            self.told.ready = true;
            self.told.last = None;
            self.neighbors.choose();
        }
        let Some(lacking) = lacking else {
            self.told.lacking = None;
            return;
        };
        let since_s = match self.told.lacking {
            Some((before, since_s)) if before == lacking => since_s,
            _ => now_s,
        };
        self.told.lacking = Some((lacking, since_s));
        let after_s = if self.told.ready {
            LOST_S
        } else {
            NEVER_READY_S
        };
        let is_due = now_s - since_s >= after_s && self.told.last != Some(lacking);
        if is_due && self.heard.is_some() {
            self.told.ready = false;
            self.told.last = Some(lacking);
            self.tell(lacking.severity(), lacking.words(), now_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Lacking;

    #[test]
    fn every_text_fits_into_one_message() {
        for lacking in [
            Lacking::Link,
            Lacking::Contradiction,
            Lacking::Rate,
            Lacking::Telemetry,
            Lacking::Disarmed,
            Lacking::Height,
            Lacking::Slow,
            Lacking::Mode,
            Lacking::Mission,
            Lacking::TakeOffOrLanding,
            Lacking::Limits,
            Lacking::FenceAction,
            Lacking::BankLimit,
            Lacking::Decision,
            Lacking::TwoVehicles,
            Lacking::Listens,
            Lacking::TwoSenders,
            Lacking::FeedUnreadable,
            Lacking::FeedSilent,
            Lacking::OtherAvoider,
            Lacking::SlowLink,
            Lacking::Ground,
        ] {
            assert!(lacking.words().len() <= 50, "{lacking:?}");
        }
    }
}

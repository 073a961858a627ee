//! What is known now: the state, how old it is, and what is missing to act on it.

use fga_formats::geodesy::LocalFrame;
use mavlink::dialects::ardupilotmega::TIMESYNC_DATA;
use serde_json::json;

use super::Companion;
use super::boundary::acts_in_guided;
use super::gap::{self, MOST_BLIND_S};
use super::lacking::Lacking;
use super::session::SILENT_S;
use super::trips::round_trip_of;
use crate::authority::{Authority, Fault};
use crate::mission::is_take_off_or_landing;
use crate::mode::Mode;
use crate::ownship::{FLYING_SPEED_MPS, OwnState};
use crate::parameters::TERRAIN_ENABLE;

/// Telemetry is stale after this many of its measured intervals, if these are long.
const STALE_INTERVALS: f64 = 2.5;
/// Below this share of its least airspeed a vehicle does not fly on its wing.
const SLOW_SHARE: f64 = 0.7;

impl Companion {
    /// The state to decide about, with what is missing reported; `None` while it is not known.
    pub(super) fn observe(&mut self, now_s: f64) -> Option<OwnState> {
        self.lead.follow(now_s);
        let fresh = !self.is_blind(now_s);
        let state = if fresh || self.flies_blind(now_s) {
            self.state_ahead(now_s)
        } else {
            None
        };
        let lacking = self.lacking(now_s, state.as_ref().filter(|_| fresh));
        let before = self.keeper.state();
        self.keep(now_s, |keeper| keeper.readiness(lacking.is_none(), now_s));
        self.tell_readiness(lacking);
        if before == Authority::Waiting && self.keeper.state() == Authority::Ready {
            self.forget_plan();
        }
        // Before the take-off too: a ground station needs minutes.
        let (route, lists, voice) = (&self.route, self.requests.lists(), &mut self.voice);
        self.over.follow_arming(self.session.is_armed());
        let has_terrain = self.requests.parameters().get(TERRAIN_ENABLE) != Some(0.0);
        self.over
            .order(route, lists, (&self.ownship, has_terrain), voice);
        let rose_m = self.ownship.hold_home(self.keeper.is_engaged());
        self.told.home_moved(rose_m, &mut self.voice);
        let state = state?;
        self.lay_fence();
        if self.keeper.is_engaged() && state.above_home_m < self.config.limits.floor_m - 10.0 {
            self.fault(Fault::BelowFloor, now_s);
        }
        if !self.keeper.commands() {
            self.hand.watch(&state);
        }
        Some(state)
    }

    /// The state at the moment at which a command sent now takes effect.
    pub(super) fn state_ahead(&mut self, now_s: f64) -> Option<OwnState> {
        let in_need = self.decisions.is_in_need();
        self.lead.state(&mut self.ownship, in_need, now_s)
    }

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
            && self.decisions.is_certified()
            && self.is_blind(now_s)
            && self.telemetry_age_s(now_s) <= MOST_BLIND_S
    }

    /// Whether heartbeats are missing, so that requests have no visible effect.
    pub(super) fn is_silent(&self, now_s: f64) -> bool {
        self.session.silent_s(now_s).is_some_and(|s| s > SILENT_S)
    }

    /// Extra uncertainty of our own position, m.
    pub(super) fn growth_m(&self, now_s: f64) -> f64 {
        if self.is_blind(now_s) {
            gap::growth_m(self.telemetry_age_s(now_s))
        } else {
            0.0
        }
    }

    /// Telemetry older than this is stale, seconds: as configured, or more than two messages late
    /// if the vehicle sends them slowly.
    pub(super) fn stale_s(&self) -> f64 {
        let configured_s = self.config.safety.telemetry_stale_s;
        let interval_s = self.requests.usable_interval_s();
        interval_s.map_or(configured_s, |s| configured_s.max(STALE_INTERVALS * s))
    }

    /// Measured airspeed, or cruise airspeed, metres per second.
    pub(super) fn airspeed_mps(&self) -> Option<f64> {
        let measured = self
            .ownship
            .airspeed_mps()
            .filter(|v| *v > FLYING_SPEED_MPS);
        measured.or_else(|| self.requests.parameters().get("AIRSPEED_CRUISE"))
    }

    /// The largest bank to command now, radians.
    pub(super) fn bank_limit_rad(&self) -> Option<f64> {
        self.requests
            .parameters()
            .bank_limit_rad(&self.config, self.airspeed_mps()?)
    }

    /// The largest bank to command in need, radians; `None` without a separate one.
    pub(super) fn bank_in_need_rad(&self) -> Option<f64> {
        self.requests
            .parameters()
            .bank_in_need_rad(&self.config, self.airspeed_mps()?)
    }

    /// Reports what has changed about readiness.
    fn tell_readiness(&mut self, lacking: Option<Lacking>) {
        let voice = &mut self.voice;
        self.told.airspeed(self.ownship.airspeed_fails(), voice);
        if self.keeper.state() == Authority::Ready {
            self.told.ready();
            self.session.choose();
        }
        // Before the first heartbeat no operator reads it.
        if lacking.is_none() || self.session.system().is_some() {
            self.told.lacking(lacking, voice);
        }
    }

    /// Takes the vehicle's answer to what its clock reads.
    pub(super) fn take_round_trip(&mut self, data: &TIMESYNC_DATA, now_s: f64) {
        self.lead.take_round_trip(data, now_s);
        if let Some((sent_s, boot_s)) = round_trip_of(data, now_s) {
            self.ownship.round_trip(sent_s, boot_s, now_s);
            self.session.round_trip(sent_s, boot_s, now_s);
        }
    }

    /// Moves the local frame if the aircraft is far from its origin and nothing threatens;
    /// the companion then learns everything in the old frame again.
    pub(super) fn renew_frame(&mut self, now_s: f64) {
        if self.keeper.is_engaged() || self.decisions.is_busy() || !self.ownship.move_frame() {
            return;
        }
        self.around.tracks_mut().clear();
        self.boundary.forget();
        self.over.forget();
        self.route.forget();
        self.requests.mode_changed(now_s);
        self.forget_plan();
        if let Some(origin) = self.ownship.frame().map(LocalFrame::origin) {
            self.voice.note(
                "frame",
                json!({
                    "latitude_deg": origin.latitude_deg,
                    "longitude_deg": origin.longitude_deg,
                }),
            );
        }
    }

    /// Whether the vehicle is too slow to fly on its wing: a quadplane that hovers in AUTO would speed up in GUIDED.
    fn is_slow(&self) -> bool {
        let least_mps = self.requests.parameters().get("AIRSPEED_MIN");
        let airspeed_mps = self.ownship.airspeed_mps();
        airspeed_mps
            .zip(least_mps)
            .is_some_and(|(airspeed_mps, least_mps)| airspeed_mps < SLOW_SHARE * least_mps)
    }

    /// Whether the vehicle takes off or lands in its mission.
    fn takes_off_or_lands(&self) -> bool {
        let lists = self.requests.lists();
        let item = lists.item();
        item.and_then(|item| lists.mission_item(item))
            .is_some_and(is_take_off_or_landing)
    }

    /// The missing condition for a take-over, or for flying on.
    pub(super) fn lacking(&self, now_s: f64, state: Option<&OwnState>) -> Option<Lacking> {
        let engaged = self.keeper.is_engaged();
        let link_lost_s = self.config.safety.link_lost_s;
        if let Some(lacking) = self.session.lacking(link_lost_s, engaged, now_s) {
            return Some(lacking);
        }
        let mode = self.session.mode()?;
        let (lists, parameters) = (self.requests.lists(), self.requests.parameters());
        let owed = self.keeper.owed().filter(|_| engaged);
        let in_auto = owed.unwrap_or(mode) == Mode::AUTO;
        let takes_off_or_lands = self.takes_off_or_lands();
        let can_bank = self.bank_limit_rad().is_some();
        // A little above the floor at first, so that the manoeuvre does not cross it at once.
        let above_floor_m = if engaged { -10.0 } else { 5.0 };
        let lowest_m = self.config.limits.floor_m + above_floor_m;
        let is_high = state.is_some_and(|state| state.above_home_m >= lowest_m);
        let conditions = [
            // Before all that changes with the mode: two avoiders would take turns.
            (!engaged && parameters.avoids_by_itself()).then_some(Lacking::OtherAvoider),
            (!engaged && self.lead.is_too_long(now_s)).then_some(Lacking::SlowLink),
            self.requests
                .usable_interval_s()
                .is_none()
                .then_some(Lacking::Rate),
            self.is_blind(now_s).then_some(Lacking::Telemetry),
            // Before the vehicle is armed the operator can still mend it.
            self.reports
                .feeds()
                .lacking(now_s, self.session.is_armed())
                .filter(|_| !engaged),
            (!self.session.is_armed()).then_some(Lacking::Disarmed),
            // Without a state it stands or rolls.
            (state.is_none() && takes_off_or_lands).then_some(Lacking::TakeOffOrLanding),
            state.is_none().then_some(Lacking::Slow),
            (!is_high).then_some(Lacking::Height),
            (!engaged && self.is_slow()).then_some(Lacking::Slow),
            (!engaged && !self.handover.takes_over(mode)).then_some(Lacking::Mode),
            (in_auto && !lists.is_way_known(now_s)).then_some(Lacking::Mission),
            (in_auto && !engaged && takes_off_or_lands).then_some(Lacking::TakeOffOrLanding),
            (!parameters.is_sufficient()).then_some(Lacking::Limits),
            (!engaged && acts_in_guided(parameters)).then_some(Lacking::FenceAction),
            (!engaged && self.over.is_awaited()).then_some(Lacking::Ground),
            (!can_bank).then_some(Lacking::BankLimit),
            (!self.decisions.are_possible(now_s)).then_some(Lacking::Decision),
        ];
        conditions.into_iter().flatten().next()
    }
}

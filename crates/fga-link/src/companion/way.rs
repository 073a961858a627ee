//! The vehicle's intended way, and whether it is back on it.

use core::ops::Range;

use fga::Vec3;
use fga::angle::{course_of, wrap_pi};
use fga::avoider::{Decision, State as AvoiderState};
use mavlink::dialects::ardupilotmega::MavCmd;
use serde_json::json;

use super::Companion;
use super::decider::Decider;
use super::rally::SAME_TARGET_M;
use crate::authority::Severity;
use crate::commands::Command;
use crate::mission::{Item, Way, item_position_m, way_ahead};
use crate::mode::Mode;
use crate::number::single;
use crate::ownship::State;

/// Length of the line in CRUISE, metres.
const CRUISE_AHEAD_M: f64 = 50_000.0;
/// In CRUISE a new line begins when the aircraft is off the old one by this, m and rad.
const CRUISE_OFF_M: f64 = 12.0;
const CRUISE_OFF_RAD: f64 = 0.05;
/// Back on the leg: this close, this well aligned. A way back from far ends up to 16 m beside the leg; the vehicle flies these
/// last metres by itself.
const ON_LEG_M: f64 = 18.0;
const ON_LEG_RAD: f64 = 0.06;
const ON_LEG_HEIGHT_M: f64 = 12.0;
/// Copies of the request to set an item arrive within this time after its answer, seconds.
const SET_SETTLES_S: f64 = 0.3;
/// A waypoint that is passed farther off was not flown to, metres; `WP_RADIUS` where that is less.
const NEAR_WAYPOINT_M: f64 = 30.0;

impl Companion {
    /// The way that the vehicle would fly by itself; unchanged while the companion flies, except
    /// for another mission.
    pub(super) fn renew_way(&mut self, state: &State, now_s: f64) {
        let Some(heard_mode) = self.session.mode() else {
            return;
        };
        let engaged = self.keeper.is_engaged() && self.decider.is_some();
        // In a manoeuvre, and after one while its debt is left, the way belongs to the mode from before.
        let left = self.keeper.owed();
        let mode = left.unwrap_or(heard_mode);
        if left.is_some() && left == self.way_mode && !self.keeper.is_engaged() {
            return;
        }
        let own_m = state.ownship.position_m;
        if engaged && mode == Mode::RTL && self.way_mode == Some(Mode::RTL) {
            let (frame, laid_m) = (self.ownship.frame(), self.way.waypoints_m.last().copied());
            let to_m = self.return_place_m(own_m);
            let rally = self.lists.rally();
            if let Some(to_m) = rally.other_return_place_m(own_m, to_m, laid_m, frame) {
                self.lay_return(own_m, Some(to_m));
                self.way_laid(mode, now_s);
            }
            return;
        }
        if engaged && (mode != Mode::AUTO || self.way_mode != Some(Mode::AUTO)) {
            return;
        }
        let track_rad = course_of(state.ground_velocity_mps);
        let busy = self
            .decider
            .as_ref()
            .is_some_and(|a| a.state() != AvoiderState::Cruise);
        match mode {
            Mode::AUTO => {
                if !self.renew_mission_way(own_m, engaged, busy, now_s) {
                    return;
                }
            }
            Mode::RTL => {
                // Home, or a rally point: the vehicle's own target is better than the list.
                let reported_m = self
                    .lists
                    .own_target_m(now_s)
                    .map(|at_m| at_m.with_z(own_m.z));
                let moved = reported_m.is_some_and(|reported_m| {
                    let laid_m = self.way.waypoints_m.last();
                    laid_m.is_none_or(|laid_m| {
                        (reported_m - laid_m).truncate().length() > SAME_TARGET_M
                    })
                });
                if self.way_mode == Some(Mode::RTL) && (busy || !moved) {
                    return;
                }
                self.lay_return(own_m, reported_m.or_else(|| self.return_place_m(own_m)));
            }
            mode => {
                let off = self.way.waypoints_m.first().is_none_or(|from| {
                    let ahead = self
                        .way
                        .waypoints_m
                        .get(1)
                        .map_or(Vec3::X, |to| *to - *from);
                    let along = ahead.normalize_or_zero();
                    let across = (own_m - *from).cross(along).length();
                    across > CRUISE_OFF_M
                        || wrap_pi(course_of(ahead) - track_rad).abs() > CRUISE_OFF_RAD
                });
                if busy || (self.way_mode == Some(mode) && !off) {
                    return;
                }
                let ahead = Vec3::new(libm::cos(track_rad), libm::sin(track_rad), 0.0);
                self.way = Way {
                    waypoints_m: vec![own_m, own_m + ahead * CRUISE_AHEAD_M],
                    items: vec![None, None],
                    ..Way::default()
                };
            }
        }
        self.way_laid(mode, now_s);
    }

    fn lay_return(&mut self, own_m: Vec3, to_m: Option<Vec3>) {
        self.way = Way {
            waypoints_m: to_m.map_or_else(Vec::new, |to_m| vec![own_m, to_m]),
            items: vec![None, None],
            ..Way::default()
        };
    }

    /// Another way counts from here on.
    fn way_laid(&mut self, mode: Mode, now_s: f64) {
        self.way_mode = Some(mode);
        self.way_item = self.lists.item();
        self.decider = None;
        self.passing.nearest_m.clear();
        self.begin_passing();
        self.voice.note(
            now_s,
            "way",
            json!({
                "mode": mode.name(),
                "item": self.lists.item(),
                "waypoints_m": self.way.waypoints_m.iter().map(|w| [w.x, w.y, w.z]).collect::<Vec<_>>(),
            }),
        );
    }

    /// Lays the way along the mission, or to the vehicle's own target while the mission is in doubt;
    /// `false` if it stays the same.
    fn renew_mission_way(&mut self, own_m: Vec3, engaged: bool, busy: bool, now_s: f64) -> bool {
        let laid = self.way_mode == Some(Mode::AUTO);
        let in_doubt = self.lists.is_in_doubt(&self.ownship, now_s);
        if in_doubt && let Some(target_m) = self.lists.own_target_m(now_s).filter(|_| !engaged) {
            let to_m = target_m.with_z(own_m.z);
            let led_there = self.way_mission.is_none()
                && self
                    .way
                    .waypoints_m
                    .last()
                    .is_some_and(|laid_m| (to_m - laid_m).truncate().length() <= SAME_TARGET_M);
            if laid && led_there {
                return false;
            }
            self.way = Way {
                waypoints_m: vec![own_m, to_m],
                items: vec![None, self.lists.item()],
                ..Way::default()
            };
            self.way_mission = None;
            return true;
        }
        let same_mission = self.way_mission == Some(self.lists.mission_number());
        // The decider and the vehicle pass a waypoint at slightly different moments.
        let same_item =
            self.way_item == self.lists.item() || self.current_leg_item() == self.lists.item();
        let goes_on = same_item || engaged || (busy && self.item_is_ahead());
        // While the companion reads the new way, it keeps the old one.
        if laid && ((same_mission && goes_on) || (engaged && in_doubt)) {
            return false;
        }
        let (Some(items), Some(item), Some(frame), Some(home_m)) = (
            self.lists.mission(),
            self.lists.item(),
            self.ownship.frame(),
            self.ownship.home_altitude_m(),
        ) else {
            return false;
        };
        self.way = way_ahead(items, item, own_m, frame, home_m);
        if self.passing.pending.is_empty()
            && let Some(asked) = self.passing.asked
        {
            // A program that was restarted finds what waits for AUTO.
            let asked = way_ahead(items, asked, own_m, frame, home_m);
            if asked.items.get(1) == Some(&Some(item)) {
                self.passing.pending = asked.commands.get(1).cloned().unwrap_or_default();
            }
        }
        self.way_mission = Some(self.lists.mission_number());
        true
    }

    /// The target of RTL from here by the lists, metres, local frame, at the aircraft's height.
    fn return_place_m(&self, own_m: Vec3) -> Option<Vec3> {
        let home_m = self.lists.home_m(&self.ownship, own_m.z);
        let frame = self.ownship.frame();
        self.lists
            .rally()
            .return_place_m(own_m, home_m, frame, &self.parameters)
    }

    /// The mission item at the end of the decider's leg.
    fn current_leg_item(&self) -> Option<u16> {
        let leg = self.decider.as_ref().map_or(0, Decider::leg_index);
        let last = self.way.items.len().saturating_sub(1);
        self.way.items.get((leg + 1).min(last)).copied().flatten()
    }

    /// The rest of the way: the point of the present leg nearest to the aircraft, and the waypoints after it.
    pub(super) fn way_left(&self, own_m: Vec3) -> (Vec3, &[Vec3]) {
        let leg = self.decider.as_ref().map_or(0, Decider::leg_index);
        let Some((from_m, left_m)) = self
            .way
            .waypoints_m
            .get(leg..)
            .and_then(<[Vec3]>::split_first)
        else {
            return (own_m, &[]);
        };
        let along_m = left_m.first().map_or(Vec3::ZERO, |to_m| *to_m - *from_m);
        let share = (own_m - *from_m).dot(along_m) / along_m.length_squared().max(1.0);
        (*from_m + along_m * share.clamp(0.0, 1.0), left_m)
    }

    /// Whether the vehicle's item belongs to the way.
    fn item_is_ahead(&self) -> bool {
        self.lists.item().is_some() && self.way.items.contains(&self.lists.item())
    }

    /// Begin and end of the decider's leg.
    fn leg_m(&self) -> Option<(Vec3, Vec3)> {
        let leg = self.decider.as_ref().map_or(0, Decider::leg_index);
        let begin_m = self.way.waypoints_m.get(leg).copied();
        begin_m.zip(self.way.waypoints_m.get(leg + 1).copied())
    }

    /// Whether the present command is the course of the leg: the last turn of the way back, or the leg itself.
    pub(super) fn turns_onto_leg(&self, decision: &Decision) -> bool {
        self.leg_m()
            .zip(decision.command.stage_at(0.0))
            .is_some_and(|((from, to), stage)| {
                wrap_pi(stage.course_rad - course_of(to - from)).abs() < ON_LEG_RAD
            })
    }

    pub(super) fn is_on_leg(&self, state: &State) -> bool {
        let Some((from, to)) = self.leg_m() else {
            return true;
        };
        let ahead = to - from;
        let level = Vec3::new(ahead.x, ahead.y, 0.0).normalize_or_zero();
        let offset = state.ownship.position_m - from;
        let across_m = (offset.x * level.y - offset.y * level.x).abs();
        let along = (offset.x * level.x + offset.y * level.y).max(0.0);
        let length_m = libm::hypot(ahead.x, ahead.y).max(1.0);
        let height_m = from.z + ahead.z * (along / length_m).min(1.0);
        let angle_rad = wrap_pi(course_of(state.ground_velocity_mps) - course_of(level));
        let climbs = self
            .decider
            .as_ref()
            .is_some_and(|decider| decider.vehicle().can_climb());
        across_m < ON_LEG_M
            && angle_rad.abs() < ON_LEG_RAD
            && (!climbs || (state.ownship.position_m.z - height_m).abs() < ON_LEG_HEIGHT_M)
    }

    /// Whether the vehicle begins its mission again with each change to AUTO.
    pub(super) fn restarts_mission(&self) -> bool {
        self.parameters.get("MIS_RESTART") == Some(1.0)
    }

    /// Where the vehicle begins its mission again with each change to AUTO, sets the item to go on with.
    pub(super) fn set_item_to_resume(&mut self, now_s: f64) {
        if let Some(item) = self.item_to_resume.take() {
            self.tell_repeated(now_s);
            self.set_item(item, now_s);
        }
    }

    fn set_item(&mut self, item: u16, now_s: f64) {
        self.commands.send(
            Command::long(
                MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
                single(f64::from(item)),
                0.0,
            ),
            true,
        );
        self.voice.note(now_s, "set-item", json!({ "item": item }));
    }

    /// A manoeuvre begins, or another way in one: from here on waypoints are passed without the vehicle.
    pub(super) fn begin_passing(&mut self) {
        // The decider and the vehicle pass a waypoint at different moments: after a manoeuvre that a fault ended, the vehicle flies to
        // one that the decider has long passed.
        let leg = self.decider.as_ref().map_or(0, Decider::leg_index);
        let flown_to = (0..self.way.items.len())
            .filter(|index| self.flown_to(*index..=*index).is_some())
            .min_by_key(|index| index.abs_diff(leg + 1));
        let next = flown_to.unwrap_or(leg + 1);
        // What an earlier manoeuvre has passed on the way to the same item counts too.
        if self.passing.known != self.lists.item() {
            self.passing.nearest_m.clear();
        }
        let mut nearest_m = core::mem::take(&mut self.passing.nearest_m);
        nearest_m.resize(self.way.waypoints_m.len(), f64::INFINITY);
        self.passing = Passing {
            next,
            known: self.lists.item(),
            nearest_m,
            pending: core::mem::take(&mut self.passing.pending),
            asked: self.passing.asked,
            ..Passing::default()
        };
    }

    /// The first of some indices of the way whose waypoint is the vehicle's present item.
    fn flown_to(&self, mut indices: impl Iterator<Item = usize>) -> Option<usize> {
        let item = self.lists.item()?;
        indices.find(|index| self.way.items.get(*index) == Some(&Some(item)))
    }

    /// Measures how near the aircraft comes to each waypoint.
    pub(super) fn watch_passing(&mut self, own_m: Vec3) {
        for (nearest_m, waypoint_m) in self.passing.nearest_m.iter_mut().zip(&self.way.waypoints_m)
        {
            *nearest_m = nearest_m.min((own_m - *waypoint_m).truncate().length());
        }
    }

    /// The waypoints of the way that this manoeuvre has passed and the vehicle has not.
    fn passed(&mut self) -> Range<usize> {
        let known = self.lists.item();
        if known != self.passing.known {
            self.passing.known = known;
            // An item before that was asked for earlier, or set by a ground station: it stays.
            if let Some(index) = self.flown_to(self.passing.next + 1..self.way.items.len()) {
                self.passing.next = index;
                // The vehicle goes on where it was asked to, and the commands there wait for AUTO.
                let before = self.way.items.get(index - 1).copied().flatten();
                let is_asked = known >= self.passing.asked && before < self.passing.asked;
                if !is_asked {
                    self.passing.pending.clear();
                }
            }
        }
        let leg = self.decider.as_ref().map_or(0, Decider::leg_index);
        self.passing.next..leg + 1
    }

    /// Reports the items that the manoeuvre has passed and the vehicle will not make up for: commands that do not run, and waypoints
    /// that were passed far off.
    fn tell_passed(&mut self, passed: Range<usize>, now_s: f64) {
        let near_m = self.parameters.get("WP_RADIUS").unwrap_or(NEAR_WAYPOINT_M);
        let near_m = near_m.min(NEAR_WAYPOINT_M);
        let mut words = Vec::new();
        for index in passed.clone() {
            let item = self.way.items.get(index).copied().flatten();
            let nearest_m = self.passing.nearest_m.get(index).copied();
            if let (Some(item), Some(nearest_m)) = (item, nearest_m)
                && nearest_m > near_m
            {
                words.push(format!("fga: waypoint {item} passed {nearest_m:.0} m off"));
            }
        }
        // The commands before the first one ran when the vehicle began to fly there, or wait for AUTO.
        let mut lost = core::mem::take(&mut self.passing.pending);
        let later = passed
            .skip(1)
            .filter_map(|index| self.way.commands.get(index));
        lost.extend(later.flatten());
        for item in lost {
            let name = self.command_name(item);
            words.push(format!("fga: item {item} not run: {name}"));
        }
        for words in &words {
            self.voice.tell(Severity::Warning, words, now_s);
        }
    }

    /// Name of an item's command.
    fn command_name(&self, item: u16) -> String {
        let name = self
            .lists
            .mission_item(item)
            .map(|item| format!("{:?}", item.command));
        let name = name.as_deref().unwrap_or("unreadable");
        name.trim_start_matches("MAV_CMD_").to_owned()
    }

    /// Whether the vehicle goes on with its mission where it should when it gets AUTO back: at the first item after the last
    /// waypoint that the manoeuvre has passed. Sets that item; the vehicle is still in GUIDED when it answers, so that no
    /// repeated request runs a command twice.
    pub(super) fn item_is_set(&mut self, now_s: f64) -> bool {
        if self.owed_mode() != Some(Mode::AUTO) {
            return true;
        }
        let passed = self.passed();
        let last = passed.end.checked_sub(1).filter(|_| !passed.is_empty());
        let item = last.and_then(|last| self.way.items.get(last).copied().flatten());
        if let Some(item) = item {
            let (next, item) = (passed.end, item.saturating_add(1));
            self.tell_passed(passed, now_s);
            self.passing.pending = self.way.commands.get(next).cloned().unwrap_or_default();
            self.passing.next = next;
            self.passing.asked = Some(item);
            self.passing.settled_s = None;
            if !self.restarts_mission() {
                self.set_item(item, now_s);
            }
        }
        let asked = self.passing.asked;
        if self.restarts_mission() {
            self.item_to_resume = asked.or(self.lists.item());
            return true;
        }
        let waits = self
            .commands
            .is_waiting(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
        let reported = self.way.items.get(self.passing.next) == Some(&self.lists.item());
        if asked.is_none() || waits && !reported {
            return asked.is_none();
        }
        // The vehicle answered, or reports the item.
        self.commands.cancel(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
        now_s - *self.passing.settled_s.get_or_insert(now_s) >= SET_SETTLES_S
    }

    /// The vehicle flies its mission: it runs what waited for that.
    pub(super) fn mission_goes_on(&mut self) {
        self.passing.pending.clear();
        self.passing.asked = None;
    }

    /// The item that the vehicle was asked to go on with, and has not gone on with yet.
    pub(super) const fn item_asked_for(&self) -> Option<u16> {
        self.passing.asked
    }

    /// An earlier run asked the vehicle to go on with an item.
    pub(super) const fn resume_passing(&mut self, asked: Option<u16>) {
        self.passing.asked = asked;
    }

    /// Where the vehicle begins its mission again with each change to AUTO: the commands before its first waypoint run again.
    pub(super) fn tell_repeated(&mut self, now_s: f64) {
        let Some((items, frame)) = self.lists.mission().zip(self.ownship.frame()) else {
            return;
        };
        let is_flown = |item: &Item| {
            item.as_ref()
                .is_some_and(|item| item_position_m(item, frame, 0.0, 0.0).is_some())
        };
        let first = items.iter().skip(1).position(is_flown).unwrap_or(0);
        let repeated: Vec<u16> = (1..=first)
            .filter_map(|item| u16::try_from(item).ok())
            .collect();
        for item in repeated {
            let words = format!("fga: item {item} runs again: {}", self.command_name(item));
            self.voice.tell(Severity::Warning, &words, now_s);
        }
    }
}

/// What a manoeuvre has passed of the way.
#[derive(Debug, Clone, Default)]
pub(super) struct Passing {
    /// Index of the waypoint that the vehicle flies to when it gets AUTO back, and the vehicle's item when that was found.
    next: usize,
    known: Option<u16>,
    /// The commands that it runs then.
    pending: Vec<u16>,
    /// Least distance to each waypoint, metres.
    nearest_m: Vec<f64>,
    /// The item that the vehicle was asked to go on with.
    asked: Option<u16>,
    /// When the answer was heard, seconds.
    settled_s: Option<f64>,
}

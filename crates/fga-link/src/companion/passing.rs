//! What of the mission has a manoeuvre passed, and where does the vehicle go on?

use core::ops::Range;

use fga::Vec3;
use mavlink::dialects::ardupilotmega::MavCmd;
use serde_json::json;

use super::lists::Lists;
use super::route::{LaidRoute, way_to};
use super::voice::Voice;
use crate::commands::{Commands, VehicleCommand};
use crate::mission::{LegsAhead, ListItem, item_position_m};
use crate::number::single;
use crate::ownship::OwnshipEstimate;
use crate::parameters::VehicleParameters;

/// Copies of the request to set an item arrive within this time after its answer, seconds.
const SET_SETTLES_S: f64 = 0.3;
/// A waypoint that is passed farther off was not flown to, metres; `WP_RADIUS` where that is less.
const NEAR_WAYPOINT_M: f64 = 30.0;

/// What a manoeuvre has passed of the way.
#[derive(Debug, Default)]
pub(super) struct PassedItems {
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
    /// The item to go on with, where the vehicle begins its mission again with each change to AUTO.
    after_restart: Option<u16>,
}

/// Whether the vehicle begins its mission again with each change to AUTO.
fn restarts_mission(parameters: &VehicleParameters) -> bool {
    parameters.get("MIS_RESTART") == Some(1.0)
}

/// The first of some indices of a way whose waypoint is the vehicle's present item.
fn flown_to(
    way: &LegsAhead,
    item: Option<u16>,
    mut indices: impl Iterator<Item = usize>,
) -> Option<usize> {
    indices.find(|index| item.is_some() && way.items.get(*index) == Some(&item))
}

/// Name of an item's command.
fn command_name(lists: &Lists, item: u16) -> String {
    let name = lists
        .mission_item(item)
        .map(|item| format!("{:?}", item.command));
    let name = name.as_deref().unwrap_or("unreadable");
    name.trim_start_matches("MAV_CMD_").to_owned()
}

fn set_item(item: u16, commands: &mut Commands, voice: &mut Voice) {
    let command = MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT;
    commands.send(
        VehicleCommand::long(command, single(f64::from(item)), 0.0),
        true,
    );
    voice.note("set-item", json!({ "item": item }));
}

impl PassedItems {
    /// A manoeuvre begins: from here on waypoints are passed without the vehicle.
    pub(super) fn begin_maneuver(
        &mut self,
        route: &LaidRoute,
        item: Option<u16>,
        parameters: &VehicleParameters,
    ) {
        self.after_restart = item.filter(|_| restarts_mission(parameters));
        self.begin(route, item);
    }

    /// Another way is laid, perhaps in a manoeuvre.
    pub(super) fn begin_way(
        &mut self,
        route: &LaidRoute,
        own_m: Vec3,
        lists: &Lists,
        ownship: &OwnshipEstimate,
    ) {
        if self.pending.is_empty()
            && route.is_mission()
            && let Some(asked) = self.asked
        {
            // A program that was restarted finds what waits for AUTO.
            let asked = way_to(asked, own_m, lists, ownship).unwrap_or_default();
            if asked.items.get(1) == Some(&lists.item()) {
                self.pending = asked.commands.get(1).cloned().unwrap_or_default();
            }
        }
        self.nearest_m.clear();
        self.begin(route, lists.item());
    }

    fn begin(&mut self, route: &LaidRoute, item: Option<u16>) {
        let (way, leg) = (route.way(), route.leg());
        // The decider and the vehicle pass a waypoint at different moments: after a manoeuvre that a fault ended, the vehicle flies to
        // one that the decider has long passed.
        let flown_to = (0..way.items.len())
            .filter(|index| flown_to(way, item, *index..=*index).is_some())
            .min_by_key(|index| index.abs_diff(leg + 1));
        self.next = flown_to.unwrap_or(leg + 1);
        // What an earlier manoeuvre has passed on the way to the same item counts too.
        if self.known != item {
            self.nearest_m.clear();
        }
        self.nearest_m.resize(way.waypoints_m.len(), f64::INFINITY);
        self.known = item;
        self.settled_s = None;
    }

    /// Measures how near the aircraft comes to each waypoint.
    pub(super) fn watch(&mut self, way: &LegsAhead, own_m: Vec3) {
        for (nearest_m, waypoint_m) in self.nearest_m.iter_mut().zip(&way.waypoints_m) {
            *nearest_m = nearest_m.min((own_m - *waypoint_m).truncate().length());
        }
    }

    /// The waypoints of the way that this manoeuvre has passed and the vehicle has not.
    fn passed(&mut self, route: &LaidRoute, item: Option<u16>) -> Range<usize> {
        let way = route.way();
        if item != self.known {
            self.known = item;
            // An item before that was asked for earlier, or set by a ground station: it stays.
            if let Some(index) = flown_to(way, item, self.next + 1..way.items.len()) {
                self.next = index;
                // The vehicle goes on where it was asked to, and the commands there wait for AUTO.
                let before = way.items.get(index - 1).copied().flatten();
                let is_asked = item >= self.asked && before < self.asked;
                if !is_asked {
                    self.pending.clear();
                }
            }
        }
        self.next..route.leg() + 1
    }

    /// Reports the items that the manoeuvre has passed and the vehicle will not make up for: commands that do not run, and waypoints
    /// that were passed farther off than `near_m`.
    fn tell_passed(
        &mut self,
        passed: Range<usize>,
        way: &LegsAhead,
        near_m: f64,
        lists: &Lists,
        voice: &mut Voice,
    ) {
        for index in passed.clone() {
            let item = way.items.get(index).copied().flatten();
            let nearest_m = self.nearest_m.get(index).copied();
            if let (Some(item), Some(nearest_m)) = (item, nearest_m)
                && nearest_m > near_m
            {
                voice.warn(&format!("fga: waypoint {item} passed {nearest_m:.0} m off"));
            }
        }
        // The commands before the first one ran when the vehicle began to fly there, or wait for AUTO.
        let mut lost = core::mem::take(&mut self.pending);
        let later = passed.skip(1).filter_map(|index| way.commands.get(index));
        lost.extend(later.flatten());
        for item in lost {
            voice.warn(&format!(
                "fga: item {item} not run: {}",
                command_name(lists, item)
            ));
        }
    }

    /// Whether the vehicle goes on with its mission where it should when it gets AUTO back: at the first item after the last
    /// waypoint that the manoeuvre has passed. Sets that item; the vehicle is still in GUIDED when it answers, so that no
    /// repeated request runs a command twice.
    pub(super) fn item_is_set(
        &mut self,
        route: &LaidRoute,
        lists: &Lists,
        parameters: &VehicleParameters,
        commands: &mut Commands,
        voice: &mut Voice,
    ) -> bool {
        let now_s = voice.now_s();
        let way = route.way();
        let passed = self.passed(route, lists.item());
        let last = passed.end.checked_sub(1).filter(|_| !passed.is_empty());
        let item = last.and_then(|last| way.items.get(last).copied().flatten());
        if let Some(item) = item {
            let (next, item) = (passed.end, item.saturating_add(1));
            let near_m = parameters.get("WP_RADIUS").unwrap_or(NEAR_WAYPOINT_M);
            let near_m = near_m.min(NEAR_WAYPOINT_M);
            self.tell_passed(passed, way, near_m, lists, voice);
            self.pending = way.commands.get(next).cloned().unwrap_or_default();
            self.next = next;
            self.asked = Some(item);
            self.settled_s = None;
            if !restarts_mission(parameters) {
                set_item(item, commands, voice);
            }
        }
        if restarts_mission(parameters) {
            self.after_restart = self.asked.or(lists.item());
            return true;
        }
        let waits = commands.is_waiting(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
        let reported = way.items.get(self.next) == Some(&lists.item());
        if self.asked.is_none() || waits && !reported {
            return self.asked.is_none();
        }
        // The vehicle answered, or reports the item.
        commands.cancel(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
        now_s - *self.settled_s.get_or_insert(now_s) >= SET_SETTLES_S
    }

    /// The vehicle flies its mission: it runs what waited for that.
    pub(super) fn mission_goes_on(&mut self) {
        self.pending.clear();
        self.asked = None;
    }

    /// The item that the vehicle was asked to go on with, and has not gone on with yet.
    pub(super) const fn asked(&self) -> Option<u16> {
        self.asked
    }

    /// An earlier run asked the vehicle to go on with an item.
    pub(super) const fn resume(&mut self, asked: Option<u16>) {
        self.asked = asked;
    }

    /// Somebody else flies: the vehicle's mission is left alone.
    pub(super) const fn leave_alone(&mut self) {
        self.after_restart = None;
    }

    /// The vehicle has AUTO back. Where it begins its mission again with each change to AUTO, reports the commands that run
    /// again, those before its first waypoint, and sets the item to go on with.
    pub(super) fn has_auto_back(
        &mut self,
        lists: &Lists,
        ownship: &OwnshipEstimate,
        commands: &mut Commands,
        voice: &mut Voice,
    ) {
        let Some(item) = self.after_restart.take() else {
            return;
        };
        if let Some((items, frame)) = lists.mission().zip(ownship.frame()) {
            let is_flown = |item: &ListItem| {
                item.as_ref()
                    .is_some_and(|item| item_position_m(item, frame, 0.0, 0.0).is_some())
            };
            let first = items.iter().skip(1).position(is_flown).unwrap_or(0);
            for item in (1..=first).filter_map(|item| u16::try_from(item).ok()) {
                voice.warn(&format!(
                    "fga: item {item} runs again: {}",
                    command_name(lists, item)
                ));
            }
        }
        set_item(item, commands, voice);
    }
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega::{MISSION_CURRENT_DATA, PARAM_VALUE_DATA};

    use super::*;

    /// A way over the items 1, 2, 4 and 5; item 3 is a command, run on the way to item 4.
    fn route(leg: usize) -> LaidRoute {
        let way = LegsAhead {
            waypoints_m: (0..4).map(|n| Vec3::X * 1e3 * f64::from(n)).collect(),
            items: vec![Some(1), Some(2), Some(4), Some(5)],
            commands: vec![vec![], vec![], vec![3], vec![]],
        };
        LaidRoute::of(way, leg)
    }

    fn lists(item: u16) -> Lists {
        let mut lists = Lists::new(false, false);
        lists.take_current(&MISSION_CURRENT_DATA {
            seq: item,
            ..MISSION_CURRENT_DATA::DEFAULT
        });
        lists
    }

    #[test]
    fn the_vehicle_is_asked_to_go_on_after_the_last_passed_waypoint_until_it_answers() {
        let (mut commands, mut voice) = (Commands::default(), Voice::default());
        let (mut passing, parameters) = (PassedItems::default(), VehicleParameters::default());
        let mut is_set = |passing: &mut PassedItems, leg, item, now_s| {
            let (route, lists) = (route(leg), lists(item));
            let set =
                passing.item_is_set(&route, &lists, &parameters, &mut commands, voice.at(now_s));
            (set, voice.texts(), passing.asked())
        };
        passing.begin_maneuver(&route(0), Some(2), &parameters);
        assert_eq!(is_set(&mut passing, 0, 2, 0.0), (true, 0, None));
        // Past item 2, 40 m beside it: it is named, and item 3 runs on the way on.
        passing.watch(route(0).way(), Vec3::new(1e3, 40.0, 0.0));
        assert_eq!(is_set(&mut passing, 1, 2, 1.0), (false, 1, Some(3)));
        assert_eq!(is_set(&mut passing, 1, 2, 2.0), (false, 1, Some(3)));
        // The vehicle reports the waypoint there, and copies of the request arrive.
        assert_eq!(is_set(&mut passing, 1, 4, 3.0), (false, 1, Some(3)));
        assert_eq!(is_set(&mut passing, 1, 4, 3.4), (true, 1, Some(3)));
        // Past item 4 too: item 3 does not run any more, and item 4 was passed far off.
        assert_eq!(is_set(&mut passing, 2, 4, 4.0), (false, 3, Some(5)));
        passing.mission_goes_on();
        assert_eq!(passing.asked(), None);
    }

    #[test]
    fn a_mission_that_begins_again_goes_on_once_the_vehicle_has_auto_back() {
        let (mut commands, mut voice) = (Commands::default(), Voice::default());
        let (mut passing, mut parameters) = (PassedItems::default(), VehicleParameters::default());
        parameters.take(&PARAM_VALUE_DATA {
            param_id: "MIS_RESTART".into(),
            param_value: 1.0,
            ..PARAM_VALUE_DATA::DEFAULT
        });
        let ownship = OwnshipEstimate::default();
        let mut back = |passing: &mut PassedItems| {
            passing.has_auto_back(&lists(2), &ownship, &mut commands, voice.at(1.0));
            let waits = commands.is_waiting(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
            commands.cancel(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
            waits
        };
        assert!(!back(&mut passing));
        passing.begin_maneuver(&route(0), Some(2), &parameters);
        assert!(back(&mut passing) && !back(&mut passing), "once");
        passing.begin_maneuver(&route(0), Some(2), &parameters);
        passing.leave_alone();
        assert!(!back(&mut passing));
    }
}

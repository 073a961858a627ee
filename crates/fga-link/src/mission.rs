//! Mission and fence: downloads from the vehicle, in the local frame.

use fga::Vec3;
use fga_formats::geodesy::{Geodetic, LocalFrame};
use mavlink::dialects::ardupilotmega::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA,
    MISSION_REQUEST_LIST_DATA, MavCmd, MavFrame, MavMessage, MavMissionResult, MavMissionType,
};

use crate::number::degrees_from_e7;
use crate::outgoing::{AUTOPILOT, Outbox};

/// Time to wait for an answer, seconds.
const ANSWER_S: f64 = 0.4;
/// Longest accepted list.
pub const MOST_ITEMS: usize = 2000;
/// Most items requested at a time.
const WINDOW: usize = 5;
/// Attempts before an item counts as unreadable (a command that this dialect lacks): enough that no
/// link loses all of them.
const MOST_ATTEMPTS: u8 = 25;
/// Attempts before giving up the whole list, to begin again later.
const LIST_PAUSE_S: f64 = 3.0;

/// An item; `None` for one that could not be read.
pub type Item = Option<MISSION_ITEM_INT_DATA>;

/// An item without the fields that differ between messages about the same item.
fn bare(data: &MISSION_ITEM_INT_DATA) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        current: 0,
        target_system: 0,
        target_component: 0,
        ..data.clone()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Idle,
    Count,
    Items,
}

/// An item in transit.
#[derive(Debug, Clone)]
struct Awaited {
    /// The result; the inner `None` is an item that was given up.
    item: Option<Item>,
    attempts: u8,
    again_s: f64,
}

impl Awaited {
    const NEW: Self = Self {
        item: None,
        attempts: 0,
        again_s: f64::NEG_INFINITY,
    };
}

/// A download of one kind of list.
#[derive(Debug)]
pub struct Download {
    kind: MavMissionType,
    stage: Stage,
    arriving: Vec<Awaited>,
    attempts: u8,
    again_s: f64,
    /// The item to read first.
    first: u16,
    items: Option<Vec<Item>>,
    changes: u32,
}

impl Download {
    /// Nothing downloaded yet.
    pub const fn new(kind: MavMissionType) -> Self {
        Self {
            kind,
            stage: Stage::Idle,
            arriving: Vec::new(),
            attempts: 0,
            again_s: f64::NEG_INFINITY,
            first: 0,
            items: None,
            changes: 0,
        }
    }

    /// The kind of list.
    pub const fn kind(&self) -> MavMissionType {
        self.kind
    }

    /// Number of downloads that differed from the previous one.
    pub const fn changes(&self) -> u32 {
        self.changes
    }

    /// An item of the last complete list, or one that has arrived of the list that is being read for the first time.
    pub fn item(&self, index: u16) -> Option<&MISSION_ITEM_INT_DATA> {
        let index = usize::from(index);
        match &self.items {
            Some(items) => items.get(index)?.as_ref(),
            None => self.arriving.get(index)?.item.as_ref()?.as_ref(),
        }
    }

    /// Reads this item before the others.
    pub const fn read_first(&mut self, index: u16) {
        self.first = index;
    }

    /// The vehicle refuses an item: the list has changed while it was read. Begins again.
    pub fn refused(&mut self) {
        if self.stage != Stage::Count {
            self.begin();
        }
    }

    /// The last complete list.
    pub fn items(&self) -> Option<&[Item]> {
        self.items.as_deref()
    }

    /// Whether a download is in progress.
    pub fn is_busy(&self) -> bool {
        self.stage != Stage::Idle
    }

    /// Begins to download.
    pub fn begin(&mut self) {
        self.stage = Stage::Count;
        self.arriving.clear();
        self.attempts = 0;
        self.again_s = f64::NEG_INFINITY;
    }

    /// Whether an unrequested number of items differs from the known list.
    pub fn contradicts_count(&self, data: &MISSION_COUNT_DATA) -> bool {
        data.mission_type == self.kind
            && self.stage == Stage::Idle
            && self
                .items()
                .is_some_and(|items| items.len() != usize::from(data.count).min(MOST_ITEMS))
    }

    /// Whether a single requested item differs from the one in the known list.
    pub fn contradicts_item(&self, data: &MISSION_ITEM_INT_DATA) -> bool {
        data.mission_type == self.kind
            && self.stage == Stage::Idle
            && self
                .items()
                .and_then(|items| items.get(usize::from(data.seq)))
                .is_none_or(|known| known.as_ref().is_some_and(|known| *known != bare(data)))
    }

    /// Takes the number of items; `true` if that completes the list.
    pub fn take_count(&mut self, data: &MISSION_COUNT_DATA) -> bool {
        if data.mission_type != self.kind || self.stage != Stage::Count {
            return false;
        }
        self.arriving = vec![Awaited::NEW; usize::from(data.count).min(MOST_ITEMS)];
        self.stage = Stage::Items;
        self.finish_if_whole()
    }

    /// Takes an item, in any order; `true` if that completes the list.
    pub fn take_item(&mut self, data: &MISSION_ITEM_INT_DATA) -> bool {
        if data.mission_type != self.kind || self.stage != Stage::Items {
            return false;
        }
        match self.arriving.get_mut(usize::from(data.seq)) {
            Some(awaited) if awaited.item.is_none() => awaited.item = Some(Some(bare(data))),
            _ => return false,
        }
        self.finish_if_whole()
    }

    fn finish_if_whole(&mut self) -> bool {
        if self.arriving.iter().any(|awaited| awaited.item.is_none()) {
            return false;
        }
        let arrived = core::mem::take(&mut self.arriving);
        let arrived: Option<Vec<Item>> = arrived.into_iter().map(|awaited| awaited.item).collect();
        if arrived != self.items {
            self.items = arrived;
            self.changes += 1;
        }
        self.stage = Stage::Idle;
        true
    }

    /// Requests missing items; `true` if giving up the rest completes the list.
    pub fn tick(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) -> bool {
        match self.stage {
            Stage::Idle => false,
            Stage::Count => {
                self.ask_for_count(now_s, target_system, outbox);
                false
            }
            Stage::Items => {
                self.ask_for_items(now_s, target_system, outbox);
                self.finish_if_whole()
            }
        }
    }

    fn ask_for_count(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) {
        if now_s < self.again_s {
            return;
        }
        if self.attempts >= MOST_ATTEMPTS {
            self.attempts = 0;
            self.again_s = now_s + LIST_PAUSE_S;
            return;
        }
        self.attempts += 1;
        self.again_s = now_s + ANSWER_S;
        outbox.send(self.count_request(target_system));
    }

    fn ask_for_items(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) {
        let kind = self.kind;
        // From the first wanted one on, then those before it.
        let first = usize::from(self.first).min(self.arriving.len());
        let (before, from) = self.arriving.split_at_mut(first);
        let missing = (first..)
            .zip(from)
            .chain((0..).zip(before))
            .filter(|(_, awaited)| awaited.item.is_none());
        for (index, awaited) in missing.take(WINDOW) {
            if now_s < awaited.again_s {
                continue;
            }
            if awaited.attempts >= MOST_ATTEMPTS {
                awaited.item = Some(None);
                continue;
            }
            awaited.attempts += 1;
            awaited.again_s = now_s + ANSWER_S;
            let seq = u16::try_from(index).unwrap_or(u16::MAX);
            outbox.send(item_request(kind, seq, target_system));
        }
    }

    /// The message that requests the number of items.
    pub fn count_request(&self, target_system: u8) -> MavMessage {
        MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
            target_system,
            target_component: AUTOPILOT,
            mission_type: self.kind,
        })
    }

    /// The message that requests one item.
    pub fn item_request(&self, seq: u16, target_system: u8) -> MavMessage {
        item_request(self.kind, seq, target_system)
    }

    /// The closing message of a download, which the vehicle waits for.
    pub fn closing(&self, target_system: u8) -> MavMessage {
        MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system,
            target_component: AUTOPILOT,
            mavtype: MavMissionResult::MAV_MISSION_ACCEPTED,
            mission_type: self.kind,
            opaque_id: 0,
        })
    }
}

fn item_request(kind: MavMissionType, seq: u16, target_system: u8) -> MavMessage {
    MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
        seq,
        target_system,
        target_component: AUTOPILOT,
        mission_type: kind,
    })
}

/// Whether the autopilot takes off or lands at an item: nobody else may fly then.
pub const fn is_take_off_or_landing(item: &MISSION_ITEM_INT_DATA) -> bool {
    matches!(
        item.command,
        MavCmd::MAV_CMD_NAV_TAKEOFF
            | MavCmd::MAV_CMD_NAV_LAND
            | MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF
            | MavCmd::MAV_CMD_NAV_VTOL_LAND
            | MavCmd::MAV_CMD_NAV_PAYLOAD_PLACE
    )
}

/// Latitude and longitude of an item, at an altitude in metres; `None` for an item without a place.
pub fn place_of(item: &MISSION_ITEM_INT_DATA, altitude_m: f64) -> Option<Geodetic> {
    if item.x == 0 && item.y == 0 {
        return None;
    }
    Geodetic::new(degrees_from_e7(item.x), degrees_from_e7(item.y), altitude_m)
}

/// The target of an item in the local frame, metres.
///
/// `level_m` is the height, local frame, for altitudes above terrain, which are unknown here.
pub fn item_position_m(
    item: &MISSION_ITEM_INT_DATA,
    frame: &LocalFrame,
    home_altitude_m: f64,
    level_m: f64,
) -> Option<Vec3> {
    let flown_to = matches!(
        item.command,
        MavCmd::MAV_CMD_NAV_WAYPOINT
            | MavCmd::MAV_CMD_NAV_LOITER_UNLIM
            | MavCmd::MAV_CMD_NAV_LOITER_TIME
            | MavCmd::MAV_CMD_NAV_LOITER_TURNS
            | MavCmd::MAV_CMD_NAV_LOITER_TO_ALT
            | MavCmd::MAV_CMD_NAV_LAND
            | MavCmd::MAV_CMD_NAV_VTOL_LAND
            | MavCmd::MAV_CMD_NAV_PAYLOAD_PLACE
            | MavCmd::MAV_CMD_NAV_TAKEOFF
    );
    if !flown_to || (item.x == 0 && item.y == 0) {
        return None;
    }
    let altitude = f64::from(item.z);
    let origin_m = frame.origin().altitude_m;
    let altitude_m = match item.frame {
        MavFrame::MAV_FRAME_GLOBAL | MavFrame::MAV_FRAME_GLOBAL_INT => altitude,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT | MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => {
            altitude + home_altitude_m
        }
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT => {
            level_m + origin_m
        }
        _ => return None,
    };
    let place = Geodetic::new(degrees_from_e7(item.x), degrees_from_e7(item.y), altitude_m)?;
    let position_m = frame.to_local_m(place);
    position_m.is_finite().then_some(position_m)
}

/// The way ahead: its waypoints and the mission item of each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Way {
    /// Waypoints, metres, local frame; the first is the start of the present leg.
    pub waypoints_m: Vec<Vec3>,
    /// The mission item of each; `None` for a start that is no item.
    pub items: Vec<Option<u16>>,
}

/// Most legs ahead.
const MOST_WAYPOINTS: usize = 12;
/// Most jumps ahead: jumps that lead to each other end.
const MOST_JUMPS: u32 = 4;
/// Waypoints closer together than this count as one, metres.
const SAME_PLACE_M: f64 = 1.0;
/// An aircraft this near to a leg, or with its end ahead within this angle of the leg's direction, flies along it: m and rad.
const NEAR_LEG_M: f64 = 200.0;
const ALONG_RAD: f64 = 0.785;

/// The target of an endless jump.
fn jump_for_ever(item: &MISSION_ITEM_INT_DATA) -> Option<usize> {
    let to = usize::from(crate::number::to_u16(f64::from(item.param1)));
    (item.param2 < 0.0 && to > 0).then_some(to)
}

/// Whether an aircraft flies along a leg: near it, or towards its end about as the leg leads. A vehicle that was sent to an item
/// flies there from where it is.
fn flies_along(at_m: Vec3, begin_m: Vec3, end_m: Vec3) -> bool {
    let (leg_m, left_m) = ((end_m - begin_m).truncate(), (end_m - at_m).truncate());
    let share = 1.0 - left_m.dot(leg_m) / leg_m.length_squared().max(1.0);
    let off_m = (leg_m * (1.0 - share.clamp(0.0, 1.0)) - left_m).length();
    off_m <= NEAR_LEG_M || leg_m.angle_to(left_m).abs() < ALONG_RAD
}

/// The way ahead in AUTO, from the item before the present one on. Where the aircraft is far from that leg, it begins at the aircraft.
///
/// It ends at a landing, where it circles, and at a counted jump: what follows is not a leg, or
/// unknown.
pub fn way_ahead(
    items: &[Item],
    current: u16,
    from_m: Vec3,
    frame: &LocalFrame,
    home_altitude_m: f64,
) -> Way {
    let place = |index: usize| {
        let item = items.get(index)?.as_ref()?;
        item_position_m(item, frame, home_altitude_m, from_m.z)
    };
    let current = usize::from(current);
    let before = (1..current)
        .rev()
        .find_map(|index| place(index).map(|at_m| (index, at_m)));
    let mut way = Way::default();
    let (item, begin_m) = match before {
        Some((index, at_m))
            if place(current).is_none_or(|to_m| flies_along(from_m, at_m, to_m)) =>
        {
            (u16::try_from(index).ok(), at_m)
        }
        _ => (None, from_m),
    };
    way.waypoints_m.push(begin_m);
    way.items.push(item);
    let (mut next, mut jumps) = (current.max(1), 0);
    while next < items.len() && way.waypoints_m.len() < MOST_WAYPOINTS {
        let index = next;
        next += 1;
        let item = items.get(index).and_then(|item| item.as_ref());
        let command = item.map(|item| item.command);
        if command == Some(MavCmd::MAV_CMD_DO_JUMP) {
            let to = item.and_then(jump_for_ever).filter(|_| jumps < MOST_JUMPS);
            let Some(to) = to else { break };
            jumps += 1;
            next = to;
            continue;
        }
        if let Some(at_m) = place(index) {
            let repeated = way
                .waypoints_m
                .last()
                .is_some_and(|last| last.distance(at_m) < SAME_PLACE_M);
            if repeated && way.waypoints_m.len() == 1 {
                // The first leg has no length: begin it at the aircraft.
                way.waypoints_m.clear();
                way.items.clear();
                way.waypoints_m.push(from_m);
                way.items.push(None);
            } else if repeated {
                continue;
            }
            way.waypoints_m.push(at_m);
            way.items.push(u16::try_from(index).ok());
        }
        let ends = matches!(
            command,
            Some(
                MavCmd::MAV_CMD_NAV_LAND
                    | MavCmd::MAV_CMD_NAV_VTOL_LAND
                    | MavCmd::MAV_CMD_NAV_PAYLOAD_PLACE
                    | MavCmd::MAV_CMD_NAV_LOITER_UNLIM
                    | MavCmd::MAV_CMD_NAV_LOITER_TIME
                    | MavCmd::MAV_CMD_NAV_LOITER_TURNS
                    | MavCmd::MAV_CMD_NAV_LOITER_TO_ALT
                    | MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH
            )
        );
        if ends {
            break;
        }
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_formats::geodesy::Earth;

    fn item(seq: u16, command: MavCmd, x: i32, y: i32) -> MISSION_ITEM_INT_DATA {
        MISSION_ITEM_INT_DATA {
            seq,
            command,
            x,
            y,
            z: 100.0,
            frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
            ..MISSION_ITEM_INT_DATA::DEFAULT
        }
    }

    #[test]
    fn a_list_is_downloaded_through_losses() {
        let mut outbox = Outbox::default();
        let mut download = Download::new(MavMissionType::MAV_MISSION_TYPE_MISSION);
        download.begin();
        download.tick(0.0, 1, &mut outbox);
        download.tick(1.0, 1, &mut outbox);
        assert_eq!(outbox.take().len(), 2);
        let count = MISSION_COUNT_DATA {
            count: 2,
            ..MISSION_COUNT_DATA::DEFAULT
        };
        assert!(!download.take_count(&count));
        let first = item(0, MavCmd::MAV_CMD_NAV_WAYPOINT, 1, 1);
        let second = item(1, MavCmd::MAV_CMD_NAV_WAYPOINT, 2, 2);
        download.tick(1.0, 1, &mut outbox);
        assert_eq!(outbox.take().len(), 2, "both at once");
        assert!(!download.take_item(&second), "out of order");
        assert!(!download.take_item(&second), "a copy");
        assert!(download.take_item(&first));
        let items = download.items().unwrap();
        assert_eq!(items.len(), 2);
        assert_eq!(items[1].as_ref().unwrap().x, 2);
        // The same list again is no change, whatever its current item.
        download.begin();
        download.take_count(&count);
        download.take_item(&first);
        let flown_to = MISSION_ITEM_INT_DATA {
            current: 1,
            target_system: 1,
            ..second
        };
        assert!(download.take_item(&flown_to));
        assert_eq!(download.changes(), 1);
        assert!(!download.contradicts_item(&flown_to));
        let moved = MISSION_ITEM_INT_DATA { x: 3, ..flown_to };
        assert!(download.contradicts_item(&moved));
    }

    #[test]
    fn an_unreadable_item_does_not_stop_the_list() {
        let mut outbox = Outbox::default();
        let mut download = Download::new(MavMissionType::MAV_MISSION_TYPE_MISSION);
        download.begin();
        download.take_count(&MISSION_COUNT_DATA {
            count: 1,
            ..MISSION_COUNT_DATA::DEFAULT
        });
        for n in 0..40_u8 {
            download.tick(f64::from(n), 1, &mut outbox);
        }
        assert_eq!(download.items(), Some(&[None][..]));
    }

    /// After an upload with its item set: a take-off far away is not where the leg to that item begins.
    #[test]
    fn a_leg_that_the_aircraft_does_not_fly_along_begins_at_the_aircraft() {
        let here = Vec3::new(0.0, 0.0, 100.0);
        let ahead = Vec3::new(0.0, 600.0, 100.0);
        for (begin, along) in [
            (Vec3::new(0.0, -5000.0, 100.0), true),
            (Vec3::new(-400.0, -1000.0, 100.0), true),
            (Vec3::new(150.0, 0.0, 100.0), true),
            (Vec3::new(0.0, 5000.0, 100.0), false),
            (Vec3::new(6000.0, 1000.0, 100.0), false),
            (Vec3::new(-4000.0, -500.0, 100.0), false),
        ] {
            assert_eq!(flies_along(here, begin, ahead), along, "{begin}");
        }
        // A short leg that was just begun at a sharp corner.
        let short = Vec3::new(60.0, -10.0, 100.0);
        assert!(flies_along(here, Vec3::new(10.0, 40.0, 100.0), short));
    }

    #[test]
    fn the_way_ahead_skips_what_is_no_place_and_ends_at_a_jump() {
        let origin = Geodetic::new(37.0, -122.0, 10.0).unwrap();
        let frame = LocalFrame::new(origin, Earth::Wgs84);
        let north = |n: i32| 370_000_000 + n * 10_000;
        let items: Vec<Item> = [
            item(0, MavCmd::MAV_CMD_NAV_WAYPOINT, 370_000_000, -1_220_000_000),
            item(1, MavCmd::MAV_CMD_NAV_WAYPOINT, north(1), -1_220_000_000),
            item(2, MavCmd::MAV_CMD_DO_CHANGE_SPEED, 0, 0),
            item(3, MavCmd::MAV_CMD_NAV_WAYPOINT, north(2), -1_220_000_000),
            item(4, MavCmd::MAV_CMD_DO_JUMP, 0, 0),
            item(5, MavCmd::MAV_CMD_NAV_WAYPOINT, north(3), -1_220_000_000),
        ]
        .into_iter()
        .map(Some)
        .collect();
        let here = Vec3::new(5.0, 0.0, 90.0);
        let way = way_ahead(&items, 3, here, &frame, 10.0);
        assert_eq!(way.items, [Some(1), Some(3)]);
        // 1e-3° of latitude is 111 m (110.97 m at 37°, by the standard formula).
        assert!((way.waypoints_m[0].y - 110.97).abs() < 0.05, "{way:?}");
        assert!((way.waypoints_m[0].z - 100.0).abs() < 1e-9);
        let first = way_ahead(&items, 1, here, &frame, 10.0);
        assert_eq!(first.items, [None, Some(1), Some(3)]);
        assert_eq!(first.waypoints_m[0], here);
    }

    /// The way north from the first item of a list of commands, one waypoint's distance apart.
    fn way_of(commands: &[(MavCmd, f32, f32)]) -> Way {
        let origin = Geodetic::new(37.0, -122.0, 10.0).unwrap();
        let frame = LocalFrame::new(origin, Earth::Wgs84);
        let home = item(0, MavCmd::MAV_CMD_NAV_WAYPOINT, 370_000_000, -1_220_000_000);
        let mut items = vec![Some(home)];
        for (n, (command, param1, param2)) in (1..).zip(commands) {
            let place = 370_000_000 + i32::from(n) * 10_000;
            items.push(Some(MISSION_ITEM_INT_DATA {
                param1: *param1,
                param2: *param2,
                ..item(n, *command, place, -1_220_000_000)
            }));
        }
        way_ahead(&items, 1, Vec3::ZERO, &frame, 10.0)
    }

    const WAYPOINT: (MavCmd, f32, f32) = (MavCmd::MAV_CMD_NAV_WAYPOINT, 0.0, 0.0);

    #[test]
    fn a_jump_for_ever_is_followed_and_a_counted_one_ends_the_way() {
        let for_ever = (MavCmd::MAV_CMD_DO_JUMP, 1.0, -1.0);
        let way = way_of(&[WAYPOINT, WAYPOINT, for_ever, WAYPOINT]);
        assert_eq!(way.items[..5], [None, Some(1), Some(2), Some(1), Some(2)]);
        let counted = (MavCmd::MAV_CMD_DO_JUMP, 1.0, 3.0);
        let way = way_of(&[WAYPOINT, WAYPOINT, counted, WAYPOINT]);
        assert_eq!(way.items, [None, Some(1), Some(2)]);
        let to_itself = (MavCmd::MAV_CMD_DO_JUMP, 2.0, -1.0);
        assert_eq!(way_of(&[WAYPOINT, to_itself]).items, [None, Some(1)]);
    }

    #[test]
    fn the_way_ends_where_it_circles_or_lands() {
        for command in [
            MavCmd::MAV_CMD_NAV_LOITER_UNLIM,
            MavCmd::MAV_CMD_NAV_LOITER_TIME,
            MavCmd::MAV_CMD_NAV_LOITER_TURNS,
            MavCmd::MAV_CMD_NAV_LOITER_TO_ALT,
            MavCmd::MAV_CMD_NAV_LAND,
        ] {
            let way = way_of(&[WAYPOINT, (command, 3.0, 0.0), WAYPOINT]);
            assert_eq!(way.items, [None, Some(1), Some(2)], "{command:?}");
        }
        let home = (MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, 0.0, 0.0);
        assert_eq!(way_of(&[WAYPOINT, home, WAYPOINT]).items, [None, Some(1)]);
    }

    #[test]
    fn items_that_a_plane_does_not_fly_are_skipped() {
        for command in [
            MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT,
            MavCmd::MAV_CMD_DO_LAND_START,
        ] {
            let way = way_of(&[WAYPOINT, (command, 0.0, 0.0), WAYPOINT]);
            assert_eq!(way.items, [None, Some(1), Some(3)], "{command:?}");
        }
    }
}

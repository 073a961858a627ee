//! Mission, fence and rally points: the way ahead that their items give, in the local frame.

mod download;

use fga::Vec3;
use fga_formats::geodesy::LocalFrame;
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd, MavFrame};

use crate::number::place_from_e7;

pub use download::{Download, ListItem, MOST_ITEMS};

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
    if !flown_to {
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
    let position_m = frame.to_local_m(place_from_e7(item.x, item.y, altitude_m)?);
    position_m.is_finite().then_some(position_m)
}

/// The way ahead: its waypoints and the mission item of each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LegsAhead {
    /// Waypoints, metres, local frame; the first is the start of the present leg.
    pub waypoints_m: Vec<Vec3>,
    /// The mission item of each; `None` for a start that is no item.
    pub items: Vec<Option<u16>>,
    /// The items without a place that run when the leg to each begins.
    pub commands: Vec<Vec<u16>>,
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
    items: &[ListItem],
    current: u16,
    from_m: Vec3,
    frame: &LocalFrame,
    home_altitude_m: f64,
) -> LegsAhead {
    let place = |index: usize| {
        let item = items.get(index)?.as_ref()?;
        item_position_m(item, frame, home_altitude_m, from_m.z)
    };
    let current = usize::from(current);
    let before = (1..current)
        .rev()
        .find_map(|index| place(index).map(|at_m| (index, at_m)));
    let mut way = LegsAhead::default();
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
    way.commands.push(Vec::new());
    let mut commands = Vec::new();
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
                // Passed with the one before.
                if let (Some(item), Some(before)) = (way.items.last_mut(), way.commands.last_mut())
                {
                    *item = u16::try_from(index).ok();
                    before.append(&mut commands);
                }
                continue;
            }
            way.waypoints_m.push(at_m);
            way.items.push(u16::try_from(index).ok());
            way.commands.push(core::mem::take(&mut commands));
        } else if !matches!(
            command,
            Some(MavCmd::MAV_CMD_DO_LAND_START | MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT)
        ) {
            commands.extend(u16::try_from(index));
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
    use fga_formats::geodesy::Geodetic;

    pub(super) fn item(seq: u16, command: MavCmd, x: i32, y: i32) -> MISSION_ITEM_INT_DATA {
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
        let items: Vec<ListItem> = [
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
        assert!(way.commands.iter().all(Vec::is_empty), "it ran before");
        // 1e-3° of latitude is 111 m (110.97 m at 37°, by the standard formula).
        assert!((way.waypoints_m[0].y - 110.97).abs() < 0.05, "{way:?}");
        assert!((way.waypoints_m[0].z - 100.0).abs() < 1e-9);
        let first = way_ahead(&items, 1, here, &frame, 10.0);
        assert_eq!(first.items, [None, Some(1), Some(3)]);
        assert_eq!(first.commands, [vec![], vec![], vec![2_u16]]);
        assert_eq!(first.waypoints_m[0], here);
    }

    /// The way north from the first item of a list of commands, one waypoint's distance apart.
    fn way_of(commands: &[(MavCmd, f32, f32)]) -> LegsAhead {
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

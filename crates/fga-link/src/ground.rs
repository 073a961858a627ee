//! The ground around a flight, made from heights by latitude and longitude.
//!
//! That may take longer than a decision, so that it is an order that the companion gives, and whoever drives the companion carries
//! out: the program on a thread of its own. The ground is a square around the vehicle, made again when the vehicle has left its
//! middle, so that it has one size whatever the mission.

mod asked;

use alloc::sync::Arc;

use fga::{Vec2, Vec3};
use fga_formats::geodesy::LocalFrame;
use fga_formats::terrain::{LocalGround, Terrain};
use mavlink::dialects::ardupilotmega::MavFrame;

pub(crate) use self::asked::Asked;
use crate::mission::{Item, is_take_off_or_landing, item_position_m};

/// The square reaches 3 km beyond this from the vehicle, metres …
const AROUND_M: f64 = 3_000.0;
/// … so that its sides are, metres:
pub(crate) const SIDES_M: Vec2 = Vec2::splat(2.0 * (AROUND_M + 3_000.0));
/// It is made again when the vehicle is this far from its middle, metres.
const MOVED_M: f64 = 2_000.0;

/// A leg of a mission, metres in the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    item: u16,
    from_m: Vec3,
    to_m: Vec3,
}

/// The legs of a mission that lead over ground; a take-off and a landing are low by their nature, and over altitudes above the ground
/// the vehicle keeps its height itself.
fn legs(items: &[Item], frame: &LocalFrame, home_altitude_m: f64) -> Vec<Leg> {
    let mut legs = Vec::new();
    let mut before = None;
    for (number, item) in (0_u16..).zip(items).skip(1) {
        let Some(item) = item else {
            before = None;
            continue;
        };
        // An altitude above the ground is not known here.
        let level = item_position_m(item, frame, home_altitude_m, f64::NAN);
        if let Some((from_m, to_m)) = before.zip(level)
            && !is_take_off_or_landing(item)
        {
            legs.push(Leg {
                item: number,
                from_m,
                to_m,
            });
        }
        let is_over_ground = matches!(
            item.frame,
            MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT
        );
        before = level.or(before).filter(|_| !is_over_ground);
    }
    legs
}

/// Where ground is made, and of which heights.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Place {
    frame: LocalFrame,
    middle_m: Vec2,
    /// The number of the heights, of those that come piece by piece.
    heights: u32,
}

impl Place {
    /// The place of a vehicle, metres, with the number of the heights.
    pub(crate) fn new(frame: &LocalFrame, at_m: Vec3, heights: u32) -> Self {
        Self {
            frame: *frame,
            middle_m: at_m.truncate(),
            heights,
        }
    }

    /// Whether ground made here serves at another place too.
    pub(crate) fn serves(&self, other: &Self) -> bool {
        let moved_m = (self.middle_m - other.middle_m).abs().max_element();
        self.is_in(&other.frame) && self.heights == other.heights && moved_m <= MOVED_M
    }

    /// Whether its heights are older than those of a number.
    pub(crate) const fn is_older(&self, heights: u32) -> bool {
        self.heights != heights
    }

    /// Whether it is in a frame.
    pub(crate) fn is_in(&self, frame: &LocalFrame) -> bool {
        self.frame == *frame
    }
}

/// Ground to make.
#[derive(Debug, Clone)]
pub struct GroundOrder {
    place: Place,
    terrain: Arc<Terrain>,
    legs: Vec<Leg>,
    clearance_m: f64,
    /// Whether the ground is to be made, or a mission alone is to be checked.
    makes: bool,
}

/// Where a mission is lower than it takes to clear the ground, or over unknown ground.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct LowLegs {
    /// The items at the end of legs that are too low, with the least height above the ground, metres.
    pub(crate) low: Vec<(u16, f64)>,
    /// The items at the end of legs over unknown ground.
    pub(crate) unknown: Vec<u16>,
}

/// Ground that is made.
#[derive(Debug, Clone)]
pub struct MadeGround {
    pub(crate) place: Place,
    /// The ground, or why there is none; `None` where the present one stays.
    pub(crate) ground: Option<Result<LocalGround, String>>,
    pub(crate) legs: LowLegs,
}

impl GroundOrder {
    /// An order for a place, with the heights, a mission, the altitude of home and the clearance that is asked for, metres, and
    /// whether the ground is to be made too.
    pub(crate) fn new(
        place: Place,
        terrain: &Arc<Terrain>,
        (items, home_altitude_m): (&[Item], f64),
        (clearance_m, makes): (f64, bool),
    ) -> Self {
        Self {
            legs: legs(items, &place.frame, home_altitude_m),
            place,
            terrain: Arc::clone(terrain),
            clearance_m,
            makes,
        }
    }

    /// Whether the ground is to be made.
    pub(crate) const fn makes(&self) -> bool {
        self.makes
    }

    /// Makes the ground, and checks the mission.
    pub fn make(self) -> MadeGround {
        let frame = &self.place.frame;
        let corners_m = [-AROUND_M, AROUND_M].map(|by_m| (self.place.middle_m + by_m).extend(0.0));
        let ground = || LocalGround::around(&self.terrain, frame, &corners_m, self.clearance_m);
        let needed_m = self.clearance_m + self.terrain.vertical_error_m();
        let mut legs = LowLegs::default();
        for leg in &self.legs {
            let found = self.terrain.clearance(frame, leg.from_m, leg.to_m);
            let lowest = found.lowest.map(|lowest| lowest.clearance_m);
            if let Some(above_m) = lowest.filter(|above_m| *above_m < needed_m) {
                legs.low.push((leg.item, above_m));
            }
            if found.unknown_at.is_some() {
                legs.unknown.push(leg.item);
            }
        }
        MadeGround {
            ground: self.makes.then(ground),
            place: self.place,
            legs,
        }
    }

    /// The same without any ground, where making it has failed.
    pub fn fail(self) -> MadeGround {
        MadeGround {
            place: self.place,
            ground: Some(Err("could not be made".to_owned())),
            legs: LowLegs::default(),
        }
    }
}

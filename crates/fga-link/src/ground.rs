//! The ground around a flight, made from heights by latitude and longitude.
//!
//! That may take longer than a decision, so that it is an order that the companion gives, and whoever drives the companion carries
//! out: the program on a thread of its own. The ground is a square around the vehicle, made again when the vehicle has left its
//! middle, so that it has one size whatever the mission.

mod ahead;
mod asked;

use alloc::sync::Arc;

use fga::{Vec2, Vec3};
use fga_formats::geodesy::{Geodetic, LocalFrame};
use fga_formats::terrain::{LocalGround, Terrain};
use mavlink::dialects::ardupilotmega::MavFrame;

pub use self::ahead::AboveGround;
pub(crate) use self::ahead::each_second;
pub(crate) use self::asked::AskedBlocks;
use crate::mission::{ListItem, is_take_off_or_landing, item_position_m};

/// The square reaches 3 km beyond this from the vehicle, metres …
const AROUND_M: f64 = 3_000.0;
/// … so that its sides are, metres:
pub(crate) const SIDES_M: Vec2 = Vec2::splat(2.0 * (AROUND_M + 3_000.0));
/// It is made again when the vehicle is this far from its middle, metres.
const MOVED_M: f64 = 2_000.0;

/// A leg of a mission, metres in the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FlownLeg {
    item: u16,
    from_m: Vec3,
    to_m: Vec3,
}

/// The legs of a mission that lead over ground; a take-off and a landing are low by their nature, and over altitudes above the ground
/// the vehicle keeps its height itself.
fn legs(items: &[ListItem], frame: &LocalFrame, home_altitude_m: f64) -> Vec<FlownLeg> {
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
            legs.push(FlownLeg {
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

/// The square of ground around a vehicle, with what it is made of.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Square {
    frame: LocalFrame,
    middle_m: Vec2,
    /// The numbers of the mission, and of the heights where these come piece by piece.
    numbers: (u32, u32),
}

impl Square {
    /// Around a place, metres, with the numbers of mission and heights.
    pub(crate) fn new(frame: &LocalFrame, at_m: Vec3, numbers: (u32, u32)) -> Self {
        Self {
            frame: *frame,
            middle_m: at_m.truncate(),
            numbers,
        }
    }

    /// Whether it serves in the place of another one too.
    pub(crate) fn serves(&self, other: &Self) -> bool {
        let moved_m = (self.middle_m - other.middle_m).abs().max_element();
        self.is_in(&other.frame) && self.numbers == other.numbers && moved_m <= MOVED_M
    }

    /// Whether it is in a frame.
    pub(crate) fn is_in(&self, frame: &LocalFrame) -> bool {
        self.frame == *frame
    }
}

/// Ground to make.
#[derive(Debug, Clone)]
pub struct GroundOrder {
    square: Square,
    terrain: Arc<Terrain>,
    legs: Vec<FlownLeg>,
    clearance_m: f64,
}

/// Ground that is made.
#[derive(Debug, Clone)]
pub struct MadeGround {
    pub(crate) square: Square,
    /// The ground, or the reason for its absence.
    pub(crate) ground: Result<Arc<LocalGround>, String>,
    /// The items at the end of legs that are lower than it takes to clear the ground, with the least height above it, metres.
    pub(crate) low: Vec<(u16, f64)>,
    /// The items at the end of legs over unknown ground, with the first unknown place.
    pub(crate) unknown: Vec<(u16, Geodetic)>,
}

impl GroundOrder {
    /// An order for a square, with the heights, a mission, the altitude of home and the clearance that is asked for, metres.
    pub(crate) fn new(
        square: Square,
        terrain: &Arc<Terrain>,
        (items, home_altitude_m): (&[ListItem], f64),
        clearance_m: f64,
    ) -> Self {
        Self {
            legs: legs(items, &square.frame, home_altitude_m),
            square,
            terrain: Arc::clone(terrain),
            clearance_m,
        }
    }

    /// Makes the ground, and checks the mission.
    pub fn make(self) -> MadeGround {
        let frame = &self.square.frame;
        let corners_m = [-AROUND_M, AROUND_M].map(|by_m| (self.square.middle_m + by_m).extend(0.0));
        let ground = LocalGround::around(&self.terrain, frame, &corners_m, self.clearance_m);
        let needed_m = self.clearance_m + self.terrain.vertical_error_m();
        let (mut low, mut unknown) = (Vec::new(), Vec::new());
        for leg in &self.legs {
            let found = self.terrain.clearance(frame, leg.from_m, leg.to_m);
            let lowest_m = found.lowest.map(|lowest| lowest.clearance_m);
            let lowest_m = lowest_m.filter(|above_m| *above_m < needed_m);
            low.extend(lowest_m.map(|above_m| (leg.item, above_m)));
            unknown.extend(found.unknown_at.map(|place| (leg.item, place)));
        }
        MadeGround {
            square: self.square,
            ground: ground.map(Arc::new),
            low,
            unknown,
        }
    }

    /// Without any ground, where making it has failed.
    pub fn fail(self) -> MadeGround {
        MadeGround {
            square: self.square,
            ground: Err("could not be made".to_owned()),
            low: Vec::new(),
            unknown: Vec::new(),
        }
    }
}

//! Rally points: where RTL leads instead of home.
//!
//! ArduPlane chooses when RTL begins: the nearest rally point, if it is within `RALLY_LIMIT_KM` and, with
//! `RALLY_INCL_HOME`, nearer than home. It chooses again when RTL resumes after a manoeuvre. The list
//! matters only if the companion may take over RTL; it is read again when its number, one of its items or the
//! vehicle's number for it changes.

use fga::Vec3;
use fga_formats::geodesy::LocalFrame;
use mavlink::dialects::ardupilotmega::{
    MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavMissionResult, MavMissionType,
};

use super::voice::Voice;
use super::watched::Watched;
use crate::mission::place_of;
use crate::parameters::VehicleParameters;

/// Interval of requests for the number of points, seconds.
const COUNT_S: f64 = 1.5;
/// Least interval of requests for a point, seconds.
const POINT_S: f64 = 0.15;
/// A rally point must be nearer than the present target by this to replace it, metres.
const NEARER_M: f64 = 50.0;
/// ArduPlane's own value of `RALLY_LIMIT_KM`.
const LIMIT_KM: f64 = 5.0;
/// Targets closer together than this count as one, metres.
pub(super) const SAME_TARGET_M: f64 = 5.0;

/// The vehicle's rally points.
#[derive(Debug)]
pub(super) struct Rally {
    list: Watched,
}

impl Rally {
    /// Nothing is known yet; the list matters if RTL may be taken over.
    pub(super) const fn new(is_used: bool) -> Self {
        let kind = MavMissionType::MAV_MISSION_TYPE_RALLY;
        Self {
            list: Watched::new(kind, is_used, COUNT_S, POINT_S),
        }
    }

    pub(super) fn read_again(&mut self) {
        self.list.read_again();
    }

    /// Goes on reading, or asks for what would show another list.
    pub(super) fn tick(&mut self, voice: &mut Voice) {
        if self.list.tick(voice) {
            self.arrived(voice);
        } else {
            self.list.look(true, voice);
        }
    }

    pub(super) fn take_count(&mut self, data: &MISSION_COUNT_DATA, voice: &mut Voice) {
        if self.list.take_count(data, voice) {
            self.arrived(voice);
        }
    }

    pub(super) fn take_point(&mut self, data: &MISSION_ITEM_INT_DATA, voice: &mut Voice) {
        if self.list.take_item(data, voice) {
            self.arrived(voice);
        }
    }

    /// The vehicle refuses a known point, or has no such list.
    pub(super) fn refused(&mut self, result: MavMissionResult) {
        if result == MavMissionResult::MAV_MISSION_UNSUPPORTED {
            self.list.leave();
        } else {
            self.list.read_again();
        }
    }

    fn arrived(&mut self, voice: &mut Voice) {
        let words = "fga: the rally points have changed";
        self.list.report(("rally", "points"), words, voice);
    }

    /// The target of RTL from here by the lists, of which one gives home; metres, local frame, at the aircraft's height.
    pub(super) fn return_place_m(
        &self,
        own_m: Vec3,
        home_m: Option<Vec3>,
        frame: Option<&LocalFrame>,
        parameters: &VehicleParameters,
    ) -> Option<Vec3> {
        let away_m = |place_m: &Vec3| (*place_m - own_m).truncate().length();
        let limit_m = 1e3 * parameters.get("RALLY_LIMIT_KM").unwrap_or(LIMIT_KM);
        let with_home = parameters.get("RALLY_INCL_HOME") == Some(1.0);
        let rally_m = self
            .points_m(own_m, frame)
            .min_by(|a, b| away_m(a).total_cmp(&away_m(b)))
            .filter(|at_m| limit_m <= 0.0 || away_m(at_m) <= limit_m)
            .filter(|at_m| {
                !with_home || home_m.is_none_or(|home_m| away_m(at_m) < away_m(&home_m))
            });
        rally_m.or(home_m)
    }

    /// The target of RTL once it is restored, `to_m`, if it differs from the present way's, `laid_m`.
    pub(super) fn other_return_place_m(
        &self,
        own_m: Vec3,
        to_m: Option<Vec3>,
        laid_m: Option<Vec3>,
        frame: Option<&LocalFrame>,
    ) -> Option<Vec3> {
        // Without a list only the vehicle's report from before the manoeuvre is known.
        self.list.items()?;
        let away_m = |place_m: Vec3| (place_m - own_m).truncate().length();
        let (to_m, laid_m) = to_m.zip(laid_m)?;
        if (to_m - laid_m).truncate().length() <= SAME_TARGET_M {
            return None;
        }
        let still_there = self
            .points_m(own_m, frame)
            .any(|at_m| (at_m - laid_m).truncate().length() < 1.0);
        let nearer = away_m(to_m) + NEARER_M < away_m(laid_m);
        (!still_there || nearer).then_some(to_m)
    }

    /// The points, metres, local frame, at the aircraft's height.
    fn points_m<'a>(
        &'a self,
        own_m: Vec3,
        frame: Option<&'a LocalFrame>,
    ) -> impl Iterator<Item = Vec3> + 'a {
        let items = self.list.items().unwrap_or_default();
        items.iter().filter_map(move |item| {
            let item = item.as_ref()?;
            if item.command != MavCmd::MAV_CMD_NAV_RALLY_POINT {
                return None;
            }
            let place = place_of(item, own_m.z)?;
            Some(frame?.to_local_m(place).with_z(own_m.z))
        })
    }
}

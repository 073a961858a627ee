//! Rally points: where RTL leads instead of home.
//!
//! ArduPlane chooses when RTL begins: the nearest rally point, if it is within `RALLY_LIMIT_KM` and, with
//! `RALLY_INCL_HOME`, nearer than home. It chooses again when RTL resumes after a manoeuvre. The list
//! matters only if the companion may take over RTL; it is read again when its number, one of its items or the
//! vehicle's number for it changes.

use fga::Vec3;
use fga_formats::geodesy::LocalFrame;
use mavlink::dialects::ardupilotmega::MavCmd;

use crate::mission::ListItem;
use crate::number::place_from_e7;
use crate::parameters::VehicleParameters;

/// A rally point must be nearer than the present target by this to replace it, metres.
const NEARER_M: f64 = 50.0;
/// ArduPlane's own value of `RALLY_LIMIT_KM`.
const LIMIT_KM: f64 = 5.0;
/// Targets closer together than this count as one, metres.
pub(super) const SAME_TARGET_M: f64 = 5.0;

/// The vehicle's rally points, once read, from where the aircraft is, metres.
#[derive(Clone, Copy)]
pub(super) struct ReturnPlaces<'a> {
    pub(super) items: Option<&'a [ListItem]>,
    pub(super) own_m: Vec3,
    pub(super) frame: Option<&'a LocalFrame>,
}

impl ReturnPlaces<'_> {
    fn away_m(&self, place_m: Vec3) -> f64 {
        (place_m - self.own_m).truncate().length()
    }

    /// The target of RTL from here by the lists, of which one gives home; metres, local frame, at the aircraft's height.
    pub(super) fn return_place_m(
        &self,
        home_m: Option<Vec3>,
        parameters: &VehicleParameters,
    ) -> Option<Vec3> {
        let limit_m = 1e3 * parameters.get("RALLY_LIMIT_KM").unwrap_or(LIMIT_KM);
        let with_home = parameters.get("RALLY_INCL_HOME") == Some(1.0);
        let nearest_m = (self.points_m())
            .min_by(|a, b| self.away_m(*a).total_cmp(&self.away_m(*b)))
            .filter(|at_m| limit_m <= 0.0 || self.away_m(*at_m) <= limit_m)
            .filter(|at_m| {
                !with_home || home_m.is_none_or(|home_m| self.away_m(*at_m) < self.away_m(home_m))
            });
        nearest_m.or(home_m)
    }

    /// The target of RTL once it is restored, `to_m`, if it differs from the present way's, `laid_m`.
    pub(super) fn other_return_place_m(
        &self,
        to_m: Option<Vec3>,
        laid_m: Option<Vec3>,
    ) -> Option<Vec3> {
        // Without a list only the vehicle's report from before the manoeuvre is known.
        self.items?;
        let (to_m, laid_m) = to_m.zip(laid_m)?;
        if (to_m - laid_m).truncate().length() <= SAME_TARGET_M {
            return None;
        }
        let still_there = (self.points_m()).any(|at_m| (at_m - laid_m).truncate().length() < 1.0);
        let nearer = self.away_m(to_m) + NEARER_M < self.away_m(laid_m);
        (!still_there || nearer).then_some(to_m)
    }

    /// The points, metres, local frame, at the aircraft's height.
    fn points_m(&self) -> impl Iterator<Item = Vec3> {
        let height_m = self.own_m.z;
        let items = self.items.unwrap_or_default().iter().flatten();
        items
            .filter(|item| item.command == MavCmd::MAV_CMD_NAV_RALLY_POINT)
            .filter_map(move |item| {
                let place = place_from_e7(item.x, item.y, height_m)?;
                Some(self.frame?.to_local_m(place).with_z(height_m))
            })
    }
}

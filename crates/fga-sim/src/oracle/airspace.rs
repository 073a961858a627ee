//! The ground, the zones and the altitude limits between which the oracle flies.
//!
//! They stand over the ground, the oracle flies in the air mass. A margin is the least of: the height above the lowest altitude that
//! clears the ground, the distance from each zone, the distances from floor and ceiling. Places of the path give it, close together:
//! as close as the judge of a flight looks where a manoeuvre is judged, farther apart in the tree. What the aircraft begins on the
//! wrong side of does not bound it.

use alloc::sync::Arc;

use fga::Vec3;

use crate::encounters::Scenery;
use crate::world::{World, WorldGround, WorldZone};

/// Distance between the places of a path at which a manoeuvre is judged, metres: that of the judge of a flight.
pub(super) const EXACT_M: f64 = 0.25;

/// Distance between the places of a path in the tree, metres.
pub(super) const COARSE_M: f64 = 5.0;

/// Over unknown ground, metres: lower than any start of an encounter is.
const UNKNOWN_M: f64 = -1e4;

/// Ground, zones and altitude limits for the oracle.
#[derive(Debug, Clone)]
pub struct OracleAirspace {
    ground: Option<Arc<WorldGround>>,
    zones: Vec<WorldZone>,
    limits_m: (f64, f64),
    wind_mps: Vec3,
}

impl OracleAirspace {
    /// Those of a world; `None` where it has none.
    pub fn of(world: &World) -> Option<Self> {
        let scenery = Scenery {
            ground: world.ground.clone(),
            zones: world.zones.clone(),
        };
        Self::among(&scenery, world.limits_m, world.blows_mps())
    }

    /// Ground and zones, and a lowest and a highest altitude, metres, in air that moves; `None` where nothing bounds it.
    pub fn among(scenery: &Scenery, limits_m: (f64, f64), wind_mps: Vec3) -> Option<Self> {
        let has_limits = limits_m.0.is_finite() || limits_m.1.is_finite();
        (has_limits || *scenery != Scenery::default()).then(|| Self {
            ground: scenery.ground.clone(),
            zones: scenery.zones.clone(),
            limits_m,
            wind_mps,
        })
    }

    /// Without what an aircraft that begins at a place is on the wrong side of.
    pub(super) fn seen_from(mut self, start_m: Vec3) -> Self {
        let (floor_m, ceiling_m) = self.limits_m;
        self.limits_m = (floor_m.min(start_m.z), ceiling_m.max(start_m.z));
        self.zones.retain(|zone| zone.margin_m(start_m) >= 0.0);
        if self.height_margin_m(start_m) < 0.0 {
            self.ground = None;
        }
        self
    }

    /// The margin at a place of the air mass at a time, metres and seconds.
    pub(super) fn margin_m(&self, at_m: Vec3, time_s: f64) -> f64 {
        let over_m = at_m + self.wind_mps * time_s;
        self.height_margin_m(over_m).min(self.zone_margin_m(over_m))
    }

    fn height_margin_m(&self, over_m: Vec3) -> f64 {
        let (floor_m, ceiling_m) = self.limits_m;
        let limits_m = (over_m.z - floor_m).min(ceiling_m - over_m.z);
        let Some(ground) = &self.ground else {
            return limits_m;
        };
        let above_m = ground.above_m(over_m);
        let asked_m = ground.error_m() + ground.clearance_m();
        limits_m.min(above_m.map_or(UNKNOWN_M, |above_m| above_m - asked_m))
    }

    fn zone_margin_m(&self, over_m: Vec3) -> f64 {
        let margins_m = self.zones.iter().map(|zone| zone.margin_m(over_m));
        margins_m.fold(f64::INFINITY, f64::min)
    }

    /// The lesser of `running` and the margins at places of a way, metres, `every_m` apart or closer.
    pub(super) fn least_m(
        &self,
        (length_m, every_m): (f64, f64),
        place: impl Fn(f64) -> (f64, Vec3),
        running: f64,
    ) -> f64 {
        let mut least_m = running;
        let steps = libm::ceil(length_m / every_m).max(1.0);
        // A distance changes by no more than the way from where it was known.
        let mut known: Option<(f64, Vec3)> = None;
        let mut step = 0.0;
        while step <= steps {
            let (time_s, at_m) = place(step / steps);
            let over_m = at_m + self.wind_mps * time_s;
            least_m = least_m.min(self.height_margin_m(over_m));
            let at_least_m = known.map_or(f64::NEG_INFINITY, |(zone_m, from)| {
                zone_m - from.distance(over_m)
            });
            if at_least_m < least_m {
                let zone_m = self.zone_margin_m(over_m);
                least_m = least_m.min(zone_m);
                known = Some((zone_m, over_m));
            }
            step += 1.0;
        }
        least_m
    }
}

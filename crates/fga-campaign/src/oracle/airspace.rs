//! The ground, the zones and the altitude limits of a world for the oracle.

use alloc::sync::Arc;

use fga::Vec3;
use fga_judge::oracle::{OracleAirspace, OracleBoundary};
use fga_sim::world::World;

use crate::encounters::Scenery;

/// Over unknown ground, metres: lower than any start of an encounter is.
const UNKNOWN_M: f64 = -1e4;

/// Those of a world; `None` where it has none.
pub fn airspace_of(world: &World) -> Option<OracleAirspace> {
    let scenery = Scenery {
        ground: world.ground.clone(),
        zones: world.zones.clone(),
    };
    airspace_among(&scenery, world.limits_m, world.blows_mps())
}

/// Ground and zones, and a lowest and a highest altitude, metres, in air that moves; `None` where nothing bounds it.
pub(super) fn airspace_among(
    scenery: &Scenery,
    limits_m: (f64, f64),
    wind_mps: Vec3,
) -> Option<OracleAirspace> {
    let has_limits = limits_m.0.is_finite() || limits_m.1.is_finite();
    if !has_limits && *scenery == Scenery::default() {
        return None;
    }
    let ground = scenery.ground.clone().map(|ground| -> OracleBoundary {
        let asked_m = ground.error_m() + ground.clearance_m();
        let margin_m = move |above_m: f64| above_m - asked_m;
        Arc::new(move |at_m| ground.above_m(at_m).map_or(UNKNOWN_M, margin_m))
    });
    let zones = scenery.zones.iter().cloned();
    let zones = zones.map(|zone| -> OracleBoundary { Arc::new(move |at_m| zone.margin_m(at_m)) });
    Some(OracleAirspace {
        ground,
        zones: zones.collect(),
        limits_m,
        wind_mps,
    })
}

//! The ground, the zones and the altitude limits between which the oracle flies.
//!
//! They stand over the ground, the oracle flies in the air mass. A margin is the least of: the height above the lowest altitude that
//! clears the ground, the distance from each zone, the distances from floor and ceiling. Places of the path give it, close together:
//! as close as the judge of a flight looks where a manoeuvre is judged, farther apart in the tree. What the aircraft begins on the
//! wrong side of does not bound it.

use alloc::sync::Arc;

use fga_proof::Vec3;

/// Distance between the places of a path at which a manoeuvre is judged, metres: that of the judge of a flight.
pub(super) const EXACT_M: f64 = 0.25;

/// Distance between the places of a path in the tree, metres.
pub(super) const COARSE_M: f64 = 5.0;

/// How far a place over the ground is on the allowed side of something, metres; negative on the other side.
pub type OracleBoundary = Arc<dyn Fn(Vec3) -> f64 + Send + Sync>;

/// Ground, zones and altitude limits for the oracle.
#[derive(Clone)]
pub struct OracleAirspace {
    /// The ground, with what is asked for above it.
    pub ground: Option<OracleBoundary>,
    /// The zones.
    pub zones: Vec<OracleBoundary>,
    /// The lowest and the highest altitude, metres; infinite without a limit.
    pub limits_m: (f64, f64),
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
}

impl OracleAirspace {
    /// Without what an aircraft that begins at a place is on the wrong side of.
    pub(super) fn seen_from(mut self, start_m: Vec3) -> Self {
        let (floor_m, ceiling_m) = self.limits_m;
        self.limits_m = (floor_m.min(start_m.z), ceiling_m.max(start_m.z));
        self.zones.retain(|zone| zone(start_m) >= 0.0);
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
        let ground_m = self.ground.as_ref().map(|margin_m| margin_m(over_m));
        limits_m.min(ground_m.unwrap_or(f64::INFINITY))
    }

    fn zone_margin_m(&self, over_m: Vec3) -> f64 {
        let margins_m = self.zones.iter().map(|zone| zone(over_m));
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

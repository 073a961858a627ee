//! What is measured of the arcs of a flight: the separations from the obstacles and the length of the path.
//!
//! A straight arc goes on from decision to decision. It is measured as a whole, once it has ended: a flight measures the
//! same whether its decisions are made one by one or known ones are left out.

use fga::Vec3;

use crate::ground::GroundSeparation;
use crate::plant::Arc;
use crate::separation::Separation;
use crate::world::{WorldGround, WorldObstacle, WorldZone};
use crate::zone::ZoneSeparation;

/// Measures the arcs of a flight.
pub(super) struct Measured<'a> {
    pub(super) obstacles: &'a [WorldObstacle],
    pub(super) separations: &'a mut [Separation],
    pub(super) zones: &'a [WorldZone],
    pub(super) from_zones: &'a mut [ZoneSeparation],
    pub(super) ground: Option<&'a WorldGround>,
    pub(super) from_ground: &'a mut Option<GroundSeparation>,
    /// A straight arc that may go on, and its end.
    pub(super) straight: &'a mut Option<(Arc, Vec3)>,
    /// Path over the ground, metres.
    pub(super) flown_m: &'a mut f64,
}

impl Measured<'_> {
    /// Takes an arc and its end, in order; a straight one again as it goes on.
    pub(super) fn take(&mut self, arc: &Arc, end_m: Vec3) {
        let goes_on = |(before, _): &(Arc, Vec3)| before.start_s == arc.start_s;
        if !self.straight.as_ref().is_some_and(goes_on) {
            self.end();
        }
        if arc.is_straight() {
            *self.straight = Some((*arc, end_m));
        } else {
            self.measure(arc, end_m);
        }
    }

    /// Measures a straight arc that has ended.
    pub(super) fn end(&mut self) {
        if let Some((arc, end_m)) = self.straight.take() {
            self.measure(&arc, end_m);
        }
    }

    fn measure(&mut self, arc: &Arc, end_m: Vec3) {
        *self.flown_m += if arc.wind_mps == Vec3::ZERO {
            arc.airspeed_mps * arc.duration_s
        } else {
            arc.position_m.distance(end_m)
        };
        for (separation, obstacle) in self.separations.iter_mut().zip(self.obstacles) {
            separation.observe(arc, end_m, &obstacle.track);
        }
        for (separation, zone) in self.from_zones.iter_mut().zip(self.zones) {
            separation.observe(zone, arc, end_m);
        }
        if let (Some(separation), Some(ground)) = (self.from_ground.as_mut(), self.ground) {
            separation.observe(ground, arc);
        }
    }
}

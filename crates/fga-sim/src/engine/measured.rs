//! What is measured of the arcs of a flight: the separations from the obstacles and the length of the path.
//!
//! A straight arc goes on from decision to decision. It is measured as a whole, once it has ended: a flight measures the
//! same whether its decisions are made one by one or known ones are left out.

use fga::Vec3;

use crate::ground::GroundSeparation;
use crate::plant::Arc;
use crate::separation::{Least, Separation};
use crate::world::World;
use crate::zone;

/// The measurements of a flight.
#[derive(Debug, Clone, Default)]
pub(super) struct Measured {
    pub(super) separations: Vec<Separation>,
    pub(super) from_zones: Vec<Least>,
    pub(super) from_ground: Option<GroundSeparation>,
    /// A straight arc that may go on, and its end.
    pub(super) straight: Option<(Arc, Vec3)>,
    /// Path over the ground, metres.
    pub(super) flown_m: f64,
}

impl Measured {
    /// Measures the start of a flight.
    pub(super) fn begin(&mut self, world: &World) {
        let at_m = world.start.position_m;
        self.separations.clear();
        self.separations
            .extend(world.obstacles.iter().map(|obstacle| {
                let mut separation = Separation::new(obstacle.volume);
                if let Some((position_m, _)) = obstacle.track.at(0.0) {
                    separation.observe_moment(0.0, at_m - position_m);
                }
                separation
            }));
        self.from_zones.clear();
        let from_zones = world.zones.iter().map(|zone| Least {
            value_m: zone.margin_m(at_m),
            time_s: 0.0,
        });
        self.from_zones.extend(from_zones);
        let ground = world.ground.as_ref();
        self.from_ground = ground.map(|ground| GroundSeparation::begun(ground, at_m));
        (self.straight, self.flown_m) = (None, 0.0);
    }

    /// Takes an arc and its end, in order; a straight one again as it goes on.
    pub(super) fn take(&mut self, world: &World, arc: &Arc, end_m: Vec3) {
        let goes_on = |(before, _): &(Arc, Vec3)| before.start_s == arc.start_s;
        if !self.straight.as_ref().is_some_and(goes_on) {
            self.end(world);
        }
        if arc.is_straight() {
            self.straight = Some((*arc, end_m));
        } else {
            self.measure(world, arc, end_m);
        }
    }

    /// Measures a straight arc that has ended.
    pub(super) fn end(&mut self, world: &World) {
        if let Some((arc, end_m)) = self.straight.take() {
            self.measure(world, &arc, end_m);
        }
    }

    fn measure(&mut self, world: &World, arc: &Arc, end_m: Vec3) {
        self.flown_m += if arc.wind_mps == Vec3::ZERO {
            arc.airspeed_mps * arc.duration_s
        } else {
            arc.position_m.distance(end_m)
        };
        for (separation, obstacle) in self.separations.iter_mut().zip(&world.obstacles) {
            separation.observe(arc, end_m, &obstacle.track);
        }
        for (least, zone) in self.from_zones.iter_mut().zip(&world.zones) {
            zone::observe(least, zone, arc, end_m);
        }
        if let (Some(separation), Some(ground)) = (self.from_ground.as_mut(), &world.ground) {
            separation.observe(ground, arc);
        }
    }
}

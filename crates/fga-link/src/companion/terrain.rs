//! The ground of a flight, for whoever drives the companion: heights in, orders out, and what was made of them.

use alloc::sync::Arc;

use fga_formats::terrain::Terrain;

use super::Companion;
use crate::ground::{GroundOrder, MadeGround};

impl Companion {
    /// Gives it the heights of the ground, before the flight.
    pub fn set_terrain(&mut self, terrain: Option<Arc<Terrain>>) {
        if let Some(terrain) = terrain {
            self.over.set_terrain(terrain);
        }
    }

    /// Ground to make, if any is due: [`GroundOrder::make`] takes longer than a decision may.
    pub fn ground_order(&mut self) -> Option<GroundOrder> {
        self.over.take_order()
    }

    /// Makes the ground that is due, where nobody waits for a decision.
    pub fn make_ground(&mut self, now_s: f64) {
        if let Some(order) = self.ground_order() {
            self.take_ground(order.make(), now_s);
        }
    }

    /// Takes ground that was made, and what it means for the mission.
    pub fn take_ground(&mut self, made: MadeGround, now_s: f64) {
        let is_here = |frame| made.square.is_in(frame);
        if self.ownship.frame().is_some_and(is_here) {
            self.over.take_ground(made, self.voice.at(now_s));
        }
    }
}

//! The tree's state and steps: chords against the bodies, leaves, pruning.

use fga_proof::Vec3;

use super::OracleManeuver;
use super::arc::{ArcNode, TurnArc};
use super::separation::OracleBody;

/// The start of a turn.
#[derive(Clone, Copy)]
pub(super) struct Here {
    pub(super) time_s: f64,
    pub(super) position: Vec3,
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) running: f64,
}

impl Here {
    /// The end of a turn to the left (1) or right (−1), at a place and with the running minimum there.
    fn turned(&self, node: &ArcNode, sign: f64, position: Vec3, running: f64) -> Self {
        Self {
            time_s: self.time_s + node.time_s,
            position,
            cos: self.cos * node.cos - sign * self.sin * node.sin,
            sin: self.sin * node.cos + sign * self.cos * node.sin,
            running,
        }
    }

    pub(super) fn offset(&self, along: f64, left: f64, up: f64) -> Vec3 {
        self.position
            + Vec3::new(
                self.cos * along - self.sin * left,
                self.sin * along + self.cos * left,
                up,
            )
    }
}

pub(super) struct Tree<'a> {
    pub(super) bodies: &'a [OracleBody],
    pub(super) horizon_s: f64,
    pub(super) slack_m: f64,
    pub(super) best: f64,
    pub(super) enough: f64,
    pub(super) done: bool,
    /// The best leaf of each kind.
    pub(super) leaves: Vec<(f64, OracleManeuver)>,
}

impl Tree<'_> {
    pub(super) fn threshold(&self) -> f64 {
        self.best - self.slack_m
    }

    pub(super) fn chord(&self, t0: f64, p0: Vec3, t1: f64, p1: Vec3, running: f64) -> f64 {
        let mut running = running;
        for body in self.bodies {
            running = body.chord(t0, p0, t1, p1, running);
        }
        running
    }

    pub(super) fn leaf(&mut self, kind: usize, margin: f64, maneuver: OracleManeuver) {
        if let Some(slot) = self.leaves.get_mut(kind)
            && margin > slot.0
        {
            *slot = (margin, maneuver);
        }
        if margin > self.best {
            self.best = margin;
            self.done = margin >= self.enough;
        }
    }

    /// The margin of a turn that ends at `exit`, a node of an arc; `None` when it cannot improve the result.
    pub(super) fn finish(&self, arc: &TurnArc, node: &ArcNode, exit: &Here) -> Option<f64> {
        let (mut time_s, mut position, mut margin) = (exit.time_s, exit.position, exit.running);
        for rise in node.rises.iter().flatten() {
            let next = exit.offset(rise.along, 0.0, rise.up);
            let next_s = exit.time_s + rise.time_s;
            margin = self.chord(time_s, position, next_s, next, margin);
            if margin <= self.threshold() {
                return None;
            }
            (time_s, position) = (next_s, next);
        }
        if time_s < self.horizon_s {
            let left_s = self.horizon_s - time_s;
            let end = position
                + Vec3::new(
                    exit.cos * arc.speed_along,
                    exit.sin * arc.speed_along,
                    arc.speed_up,
                ) * left_s;
            margin = self.chord(time_s, position, self.horizon_s, end, margin);
        }
        (margin > self.threshold()).then_some(margin)
    }

    /// Walks one turn node by node. `visit` sees each surviving node, and where the turn ends there.
    pub(super) fn walk(
        &mut self,
        arc: &TurnArc,
        here: &Here,
        sign: f64,
        mut visit: impl FnMut(&mut Self, &ArcNode, Here),
    ) {
        let (mut time_s, mut position, mut running) = (here.time_s, here.position, here.running);
        for node in &arc.nodes {
            let next_s = here.time_s + node.time_s;
            if next_s > self.horizon_s {
                return;
            }
            let next = here.offset(node.along, sign * node.left, node.up);
            running = self.chord(time_s, position, next_s, next, running);
            if running <= self.threshold() {
                return;
            }
            (time_s, position) = (next_s, next);
            visit(self, node, here.turned(node, sign, position, running));
            if self.done {
                return;
            }
        }
    }

    /// The best leaves, best first.
    pub(super) fn seeds(self, count: usize) -> Vec<(f64, OracleManeuver)> {
        let threshold = self.threshold();
        let mut seeds: Vec<_> = self
            .leaves
            .into_iter()
            .filter(|leaf| leaf.0 > threshold)
            .collect();
        seeds.sort_by(|a, b| b.0.total_cmp(&a.0));
        seeds.truncate(count);
        seeds
    }
}

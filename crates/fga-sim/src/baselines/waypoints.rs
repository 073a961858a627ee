//! The two planners of the paper that generate waypoints (Table 6, "Optimal 1" and "Optimal 2").
//!
//! Both follow the paper's one sentence about them (§1): they test all points around a cube, develop
//! a path to the chosen sub-waypoint, and repeat the step until they find an obstacle-free path.
//! The greedy one takes the best clear point at a time; the optimal one searches all sequences for
//! the shortest path (best first, with the straight distance to the goal as the estimate). Legs are
//! straight; the planner tests them against the straight motion of every obstacle at the aircraft's
//! airspeed. It keeps the path while it stays clear and rebuilds it otherwise.

mod cube;
mod search;

pub use cube::Cube;

use fga::Vec3;

use super::Steering;
use super::view::View;

/// A planner of sub-waypoints.
#[derive(Debug, Clone)]
pub struct Waypoints {
    cube: Cube,
    /// The most sub-waypoints that the optimal planner extends in one search; the greedy one takes one clear sub-waypoint after the
    /// other, each the best by distance flown and left.
    most_extended: Option<usize>,
    /// The present path: sub-waypoints relative to the aircraft, next first.
    points_m: Vec<Vec3>,
}

impl Waypoints {
    /// A planner with these candidates: the greedy one, or the optimal one with the most sub-waypoints that it extends in one search.
    pub const fn new(cube: Cube, most_extended: Option<usize>) -> Self {
        Self {
            cube,
            most_extended,
            points_m: Vec::new(),
        }
    }

    /// The greedy planner with the best settings.
    pub const fn greedy() -> Self {
        let cube = Cube {
            half_edge_m: 120.0,
            points: 9,
            inflation: 1.4,
            goal_m: 300.0,
        };
        Self::new(cube, None)
    }

    /// The optimal planner with the best settings.
    pub const fn optimal() -> Self {
        let cube = Cube {
            half_edge_m: 90.0,
            points: 5,
            inflation: 1.2,
            goal_m: 300.0,
        };
        Self::new(cube, Some(60))
    }

    /// Moves with the aircraft and drops passed sub-waypoints.
    fn advance(&mut self, view: &View<'_>) {
        let moved = view.velocity_mps * view.period_s;
        for point in &mut self.points_m {
            *point -= moved;
        }
        let radius = view.vehicle.turn_radius_m;
        while let [first, _, ..] = self.points_m.as_slice() {
            // The aircraft can only pass a point beside it, within its turning circle.
            let passed = first.dot(view.velocity_mps) <= 0.0 && first.length() < 2.0 * radius;
            if first.length() >= 0.5 * radius && !passed {
                break;
            }
            self.points_m.remove(0);
        }
    }
}

impl Steering for Waypoints {
    fn restart(&mut self) {
        self.points_m.clear();
    }

    /// The next sub-waypoint of a path that is kept while it is clear and planned again otherwise;
    /// `None` where the mission itself is clear.
    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let cube = self.cube;
        if cube.is_clear(view, &cube.nominal(view)) {
            self.points_m.clear();
            return None;
        }
        self.advance(view);
        if let Some(last) = self.points_m.last_mut() {
            // The goal moves along the mission with the aircraft.
            *last = cube.goal_m(view);
        }
        if self.points_m.is_empty() || !cube.is_clear(view, &self.points_m) {
            let candidates = cube.candidates(view);
            self.points_m = match self.most_extended {
                None => search::greedy(&cube, view, &candidates),
                Some(most) => search::shortest(&cube, view, &candidates, most),
            };
        }
        self.points_m.first().copied()
    }
}

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

/// The present path: sub-waypoints relative to the aircraft, next first.
#[derive(Debug, Clone, Default)]
struct WaypointPath {
    points_m: Vec<Vec3>,
}

impl WaypointPath {
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

    /// The next sub-waypoint of a path that is kept while it is clear; `plan` rebuilds it otherwise;
    /// `None` where the mission itself is clear.
    fn follow(
        &mut self,
        cube: &Cube,
        view: &View<'_>,
        plan: impl FnOnce(&[Vec3]) -> Vec<Vec3>,
    ) -> Option<Vec3> {
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
            self.points_m = plan(&cube.candidates(view));
        }
        self.points_m.first().copied()
    }
}

/// One clear sub-waypoint after the other, each the best by distance flown and left.
#[derive(Debug, Clone)]
pub struct WaypointGreedy {
    cube: Cube,
    path: WaypointPath,
}

impl Default for WaypointGreedy {
    fn default() -> Self {
        Self::new(Cube {
            half_edge_m: 120.0,
            points: 9,
            inflation: 1.4,
            goal_m: 300.0,
        })
    }
}

impl WaypointGreedy {
    /// A planner with these candidates.
    pub fn new(cube: Cube) -> Self {
        Self {
            cube,
            path: WaypointPath::default(),
        }
    }
}

impl Steering for WaypointGreedy {
    fn restart(&mut self) {
        self.path = WaypointPath::default();
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let cube = self.cube;
        self.path.follow(&cube, view, |candidates| {
            search::greedy(&cube, view, candidates)
        })
    }
}

/// The shortest clear path over sub-waypoints on cubes around sub-waypoints.
#[derive(Debug, Clone)]
pub struct WaypointOptimal {
    cube: Cube,
    most_extended: usize,
    path: WaypointPath,
}

impl Default for WaypointOptimal {
    fn default() -> Self {
        let cube = Cube {
            half_edge_m: 90.0,
            points: 5,
            inflation: 1.2,
            goal_m: 300.0,
        };
        Self::new(cube, 60)
    }
}

impl WaypointOptimal {
    /// A planner with these candidates that extends at most `most_extended` sub-waypoints in one
    /// search.
    pub fn new(cube: Cube, most_extended: usize) -> Self {
        Self {
            cube,
            most_extended,
            path: WaypointPath::default(),
        }
    }
}

impl Steering for WaypointOptimal {
    fn restart(&mut self) {
        self.path = WaypointPath::default();
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let (cube, most) = (self.cube, self.most_extended);
        self.path.follow(&cube, view, |candidates| {
            search::shortest(&cube, view, candidates, most)
        })
    }
}

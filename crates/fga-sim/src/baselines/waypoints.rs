//! The two planners of the paper that generate waypoints (Table 6, "Optimal 1" and "Optimal 2").
//!
//! Both follow the paper's one sentence about them (§1): they test all points around a cube, develop
//! a path to the chosen sub-waypoint, and repeat the step until they find an obstacle-free path.
//! The greedy one takes the best clear point at a time; the optimal one searches all sequences for
//! the shortest path (best first, with the straight distance to the goal as the estimate). Legs are
//! straight; the planner tests them against the straight motion of every obstacle at the aircraft's
//! airspeed. It keeps the path while it stays clear and rebuilds it otherwise.

mod search;

use fga::Vec3;

use super::Steering;
use super::view::View;

/// The cube of candidates, and the goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cube {
    /// Half the edge of the cube, metres.
    pub half_edge_m: f64,
    /// Points along an edge, at least 2; the planner tests all points on the cube's surface.
    pub points: u32,
    /// Factor on the protected radii.
    pub inflation: f64,
    /// Distance of the goal ahead on the mission, metres.
    pub goal_m: f64,
}

impl Cube {
    /// Least clearance of a leg, metres; below zero it is blocked.
    fn clearance_m(&self, view: &View<'_>, from_m: Vec3, to_m: Vec3, start_s: f64) -> f64 {
        view.spheres
            .iter()
            .map(|sphere| {
                let grown = sphere.inflated(self.inflation);
                grown.clearance_m(from_m, to_m, start_s, view.speed_mps())
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether the whole path stays clear.
    fn is_clear(&self, view: &View<'_>, points_m: &[Vec3]) -> bool {
        let mut from_m = Vec3::ZERO;
        let mut flown_m = 0.0;
        points_m.iter().all(|point| {
            let clear = self.clearance_m(view, from_m, *point, flown_m / view.speed_mps()) >= 0.0;
            flown_m += from_m.distance(*point);
            from_m = *point;
            clear
        })
    }

    /// The goal: a point of the mission ahead.
    fn goal_m(&self, view: &View<'_>) -> Vec3 {
        view.route.foot_m + view.route.along * self.goal_m
    }

    /// The path of the guidance: onto the leg at 45°, then along it.
    fn nominal(&self, view: &View<'_>) -> [Vec3; 2] {
        let foot = view.route.foot_m;
        let ahead = foot.length().min(self.goal_m);
        [foot + view.route.along * ahead, self.goal_m(view)]
    }

    /// The candidates within the aircraft's climb limits: points on the surface of the cube, whose
    /// edges lie along the mission.
    fn candidates(&self, view: &View<'_>) -> Vec<Vec3> {
        let along = Vec3::new(view.route.along.x, view.route.along.y, 0.0).normalize_or(Vec3::X);
        let across = Vec3::new(-along.y, along.x, 0.0);
        let last = self.points.max(2) - 1;
        let place =
            |index: u32| (2.0 * f64::from(index) / f64::from(last) - 1.0) * self.half_edge_m;
        let on_face = |index: &u32| *index == 0 || *index == last;
        let mut points = Vec::new();
        for i in 0..=last {
            for j in 0..=last {
                for k in 0..=last {
                    let point = along * place(i) + across * place(j) + Vec3::Z * place(k);
                    if [i, j, k].iter().any(on_face) && view.can_climb_along(point) {
                        points.push(point);
                    }
                }
            }
        }
        points
    }
}

/// The present path: sub-waypoints relative to the aircraft, next first.
#[derive(Debug, Clone, Default)]
struct Path {
    points_m: Vec<Vec3>,
}

impl Path {
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
    path: Path,
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
            path: Path::default(),
        }
    }
}

impl Steering for WaypointGreedy {
    fn restart(&mut self) {
        self.path = Path::default();
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
    path: Path,
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
            path: Path::default(),
        }
    }
}

impl Steering for WaypointOptimal {
    fn restart(&mut self) {
        self.path = Path::default();
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let (cube, most) = (self.cube, self.most_extended);
        self.path.follow(&cube, view, |candidates| {
            search::shortest(&cube, view, candidates, most)
        })
    }
}

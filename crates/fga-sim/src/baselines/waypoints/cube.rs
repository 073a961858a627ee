//! The candidates for sub-waypoints: points on the surface of a cube around the aircraft.

use fga::Vec3;

use crate::baselines::view::View;

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
    pub(super) fn clearance_m(
        &self,
        view: &View<'_>,
        from_m: Vec3,
        to_m: Vec3,
        start_s: f64,
    ) -> f64 {
        view.spheres
            .iter()
            .map(|sphere| {
                let grown = sphere.inflated(self.inflation);
                grown.clearance_m(from_m, to_m, start_s, view.speed_mps())
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether the whole path stays clear.
    pub(super) fn is_clear(&self, view: &View<'_>, points_m: &[Vec3]) -> bool {
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
    pub(super) fn goal_m(&self, view: &View<'_>) -> Vec3 {
        view.route.foot_m + view.route.along * self.goal_m
    }

    /// The path of the guidance: onto the leg at 45°, then along it.
    pub(super) fn nominal(&self, view: &View<'_>) -> [Vec3; 2] {
        let foot = view.route.foot_m;
        let ahead = foot.length().min(self.goal_m);
        [foot + view.route.along * ahead, self.goal_m(view)]
    }

    /// The candidates within the aircraft's climb limits: points on the surface of the cube, whose
    /// edges lie along the mission.
    pub(super) fn candidates(&self, view: &View<'_>) -> Vec<Vec3> {
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

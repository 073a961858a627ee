//! The vehicle's fence, the floor and the ceiling as obstacles at rest.
//!
//! An exclusion circle is a cylinder. The edges of polygons, and an inclusion circle, are rows of
//! cylinders on the forbidden side: the aircraft flies along the row with a ripple of at most
//! [`RIPPLE_M`] metres. The ground below the floor and the sky above the ceiling are very wide
//! cylinders.

use fga::Vec3;
use fga::situation::{Movement, Obstacle, ObstacleKind, ProtectedVolume};
use fga_formats::geodesy::{Geodetic, LocalFrame};
use mavlink::dialects::ardupilotmega::MavCmd;

use crate::mission::Item;
use crate::number::degrees_from_e7;

/// Radius of the cylinders along an edge, metres.
const POST_RADIUS_M: f64 = 80.0;
/// Depth of the dents between them, metres: 80 − √(80² − 25²) = 4.0.
pub const RIPPLE_M: f64 = 4.0;
const POST_SPACING_M: f64 = 50.0;
/// Taller than anything flies, metres.
const TALL_M: f64 = 50_000.0;
/// Most posts of a whole fence; a longer one is refused.
const MOST_POSTS: usize = 4096;
/// Posts farther from the aircraft than this do not matter yet, metres.
const NEAR_M: f64 = 700.0;
/// Most posts in one step.
const MOST_NEAR: usize = 48;
const FIRST_ID: u32 = 10_000;
/// Identifiers of floor and ceiling.
pub const FLOOR_ID: u32 = 1;
/// See [`FLOOR_ID`].
pub const CEILING_ID: u32 = 2;

/// A fence in the local frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fence {
    posts: Vec<(Vec3, f64)>,
    /// Items that were unintelligible, or too many.
    pub incomplete: bool,
}

impl Fence {
    /// Lays the items of a fence download.
    pub fn new(items: &[Item], frame: &LocalFrame) -> Self {
        let mut fence = Self::default();
        let mut polygon: Vec<Vec3> = Vec::new();
        for item in items {
            let Some(item) = item else {
                fence.incomplete = true;
                continue;
            };
            let place = Geodetic::new(degrees_from_e7(item.x), degrees_from_e7(item.y), 0.0);
            let Some(place) = place else {
                fence.incomplete = true;
                continue;
            };
            let mut at_m = frame.to_local_m(place);
            at_m.z = 0.0;
            let number = f64::from(item.param1);
            match item.command {
                MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
                | MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION => {
                    polygon.push(at_m);
                    // Each vertex has the number of the polygon's vertices.
                    if (polygon.len() as f64) >= number {
                        let inside =
                            item.command == MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
                        fence.add_polygon(&polygon, inside);
                        polygon.clear();
                    }
                }
                MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION if number > 0.0 => {
                    fence.add_post(at_m, number);
                }
                MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION if number > 0.0 => {
                    let around = number + POST_RADIUS_M;
                    let count = (core::f64::consts::TAU * around / POST_SPACING_M)
                        .ceil()
                        .max(8.0);
                    let mut n = 0.0;
                    while n < count && !fence.incomplete {
                        let angle = core::f64::consts::TAU * n / count;
                        let out = Vec3::new(libm::cos(angle), libm::sin(angle), 0.0);
                        fence.add_post(at_m + out * around, POST_RADIUS_M);
                        n += 1.0;
                    }
                }
                MavCmd::MAV_CMD_NAV_FENCE_RETURN_POINT => {}
                _ => fence.incomplete = true,
            }
        }
        fence.incomplete |= !polygon.is_empty();
        fence
    }

    fn add_post(&mut self, at_m: Vec3, radius_m: f64) {
        if self.posts.len() < MOST_POSTS && at_m.is_finite() && radius_m.is_finite() {
            self.posts.push((at_m, radius_m));
        } else {
            self.incomplete = true;
        }
    }

    /// Posts along each edge, on the outer side of an inclusion and the inner of an exclusion.
    fn add_polygon(&mut self, vertices: &[Vec3], inclusion: bool) {
        if vertices.len() < 3 {
            self.incomplete = true;
            return;
        }
        let next = |index: usize| vertices.get((index + 1) % vertices.len()).copied();
        let doubled_area: f64 = vertices
            .iter()
            .enumerate()
            .filter_map(|(index, a)| next(index).map(|b| a.x * b.y - b.x * a.y))
            .sum();
        // Outward is to the right of an edge of an anticlockwise polygon.
        let outward = if (doubled_area > 0.0) == inclusion {
            1.0
        } else {
            -1.0
        };
        for (index, from) in vertices.iter().enumerate() {
            let Some(to) = next(index) else { continue };
            let edge = to - *from;
            let length = edge.length();
            if length < 0.1 {
                continue;
            }
            let along = edge / length;
            let side = Vec3::new(along.y, -along.x, 0.0) * outward;
            let mut at = 0.0;
            while at < length + POST_SPACING_M && !self.incomplete {
                let foot = *from + along * at.min(length);
                self.add_post(foot + side * POST_RADIUS_M, POST_RADIUS_M);
                at += POST_SPACING_M;
            }
        }
    }

    /// Whether there is a fence.
    pub fn is_empty(&self) -> bool {
        self.posts.is_empty()
    }

    /// The posts near the aircraft as obstacles; whether the way enters one.
    ///
    /// A fence bounds manoeuvres; the way itself is the operator's choice. So a post is as large as leaves the way clear by
    /// `clear_m`, and the vehicle flies by itself where its mission leads beside the fence or across it.
    pub fn obstacles(
        &self,
        own_m: Vec3,
        way_m: &[Vec3],
        clear_m: f64,
        into: &mut Vec<Obstacle>,
    ) -> bool {
        let mut near: Vec<(f64, u32, Vec3, f64)> = Vec::new();
        let mut crossed = false;
        for (id, (at_m, radius_m)) in (FIRST_ID..).zip(&self.posts) {
            let distance = libm::hypot(at_m.x - own_m.x, at_m.y - own_m.y) - radius_m;
            if distance >= NEAR_M {
                continue;
            }
            let off_m = off_way_m(way_m, *at_m);
            crossed |= off_m < *radius_m;
            let left_m = radius_m.min(off_m - clear_m);
            if left_m > 0.0 {
                near.push((distance, id, *at_m, left_m));
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, id, at_m, radius_m) in near.into_iter().take(MOST_NEAR) {
            let volume = ProtectedVolume::Cylinder {
                radius_m,
                half_height_m: TALL_M,
            };
            let mut obstacle = Obstacle::straight(id, at_m, Vec3::ZERO, volume);
            obstacle.kind = ObstacleKind::NaturalBarrier;
            obstacle.movement = Movement::AtRest;
            into.push(obstacle);
        }
        crossed
    }
}

/// Distance of a place from a way in the plane, metres; infinite without a way.
fn off_way_m(way_m: &[Vec3], at_m: Vec3) -> f64 {
    way_m
        .iter()
        .zip(way_m.iter().skip(1))
        .map(|(from_m, to_m)| {
            let (leg_m, to_place_m) = ((*to_m - *from_m).truncate(), (at_m - *from_m).truncate());
            let share = to_place_m.dot(leg_m) / leg_m.length_squared().max(1e-6);
            (to_place_m - leg_m * share.clamp(0.0, 1.0)).length()
        })
        .fold(f64::INFINITY, f64::min)
}

/// The forbidden air below `height_m` (or above it) as an obstacle; heights in the local frame.
pub fn layer(id: u32, height_m: f64, below: bool, own_m: Vec3) -> Obstacle {
    const DEPTH_M: f64 = 2_000.0;
    const WIDTH_M: f64 = 100_000.0;
    let z = if below {
        height_m - DEPTH_M
    } else {
        height_m + DEPTH_M
    };
    let volume = ProtectedVolume::Cylinder {
        radius_m: WIDTH_M,
        half_height_m: DEPTH_M,
    };
    let mut obstacle = Obstacle::straight(id, Vec3::new(own_m.x, own_m.y, z), Vec3::ZERO, volume);
    obstacle.kind = ObstacleKind::NaturalBarrier;
    obstacle.movement = Movement::AtRest;
    obstacle
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_formats::geodesy::Earth;
    use mavlink::dialects::ardupilotmega::MISSION_ITEM_INT_DATA;

    fn frame() -> LocalFrame {
        LocalFrame::new(Geodetic::new(37.0, -122.0, 0.0).unwrap(), Earth::Wgs84)
    }

    fn vertex(
        command: MavCmd,
        frame: &LocalFrame,
        x: f64,
        y: f64,
        param1: f32,
    ) -> MISSION_ITEM_INT_DATA {
        let place = frame.to_geodetic(Vec3::new(x, y, 0.0));
        MISSION_ITEM_INT_DATA {
            command,
            param1,
            x: crate::number::degrees_to_e7(place.latitude_deg),
            y: crate::number::degrees_to_e7(place.longitude_deg),
            ..MISSION_ITEM_INT_DATA::DEFAULT
        }
    }

    /// Distance from a point to the nearest post, metres.
    fn clearance(fence: &Fence, at: Vec3) -> f64 {
        fence
            .posts
            .iter()
            .map(|(post, radius)| libm::hypot(post.x - at.x, post.y - at.y) - radius)
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn an_inclusion_polygon_is_closed_outside_and_open_inside() {
        let frame = frame();
        let inclusion = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
        for corners in [
            [
                (-500.0, -500.0),
                (500.0, -500.0),
                (500.0, 500.0),
                (-500.0, 500.0),
            ],
            [
                (-500.0, 500.0),
                (500.0, 500.0),
                (500.0, -500.0),
                (-500.0, -500.0),
            ],
        ] {
            let items: Vec<Item> = corners
                .iter()
                .map(|(x, y)| Some(vertex(inclusion, &frame, *x, *y, 4.0)))
                .collect();
            let fence = Fence::new(&items, &frame);
            assert!(!fence.incomplete);
            assert!(clearance(&fence, Vec3::ZERO) > 499.0);
            for at in [-480.0, -237.0, 0.0, 123.0, 499.0] {
                // The edge blocks the way, at the latest a ripple beyond it.
                assert!(clearance(&fence, Vec3::new(at, 500.0 + RIPPLE_M + 0.1, 0.0)) < 0.0);
                assert!(clearance(&fence, Vec3::new(at, 499.0, 0.0)) > 0.0);
            }
        }
    }

    #[test]
    fn circles_bar_inside_or_outside() {
        let frame = frame();
        let out = vertex(
            MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
            &frame,
            0.0,
            0.0,
            100.0,
        );
        let fence = Fence::new(&[Some(out)], &frame);
        assert!(clearance(&fence, Vec3::new(99.0, 0.0, 0.0)) < 0.0);
        assert!(clearance(&fence, Vec3::new(101.0, 0.0, 0.0)) > 0.0);
        let around = vertex(
            MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
            &frame,
            0.0,
            0.0,
            800.0,
        );
        let fence = Fence::new(&[Some(around)], &frame);
        for n in 0..360_u16 {
            let angle = f64::from(n).to_radians();
            let at = |radius: f64| Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
            assert!(clearance(&fence, at(795.0)) > 0.0);
            assert!(clearance(&fence, at(800.0 + RIPPLE_M + 0.5)) < 0.0);
        }
    }

    #[test]
    fn l6_a_post_leaves_the_way_clear_and_is_whole_elsewhere() {
        let frame = frame();
        let circle = |x, y| {
            let command = MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION;
            Some(vertex(command, &frame, x, y, 100.0))
        };
        let fence = Fence::new(
            &[
                circle(0.0, 300.0),
                circle(110.0, 300.0),
                circle(200.0, 300.0),
            ],
            &frame,
        );
        let way_m = [Vec3::ZERO, Vec3::new(0.0, 600.0, 0.0)];
        let mut posts = Vec::new();
        assert!(fence.obstacles(Vec3::ZERO, &way_m, 30.0, &mut posts));
        let radii_m: Vec<f64> = posts.iter().map(|post| post.volume.radius_m()).collect();
        assert_eq!(radii_m.len(), 2, "the way leads through the first one");
        assert!(
            radii_m.iter().any(|r| (r - 80.0).abs() < 0.1),
            "{radii_m:?}"
        );
        assert!(
            radii_m.iter().any(|r| (r - 100.0).abs() < 0.1),
            "{radii_m:?}"
        );
        posts.clear();
        assert!(!fence.obstacles(Vec3::ZERO, &[], 30.0, &mut posts));
        assert_eq!(posts.len(), 3);
    }

    #[test]
    fn an_unusable_fence_is_reported() {
        let frame = frame();
        let inclusion = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
        let half = vertex(inclusion, &frame, 0.0, 0.0, 4.0);
        assert!(Fence::new(&[Some(half)], &frame).incomplete);
        assert!(Fence::new(&[None], &frame).incomplete);
        let huge = vertex(
            MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
            &frame,
            0.0,
            0.0,
            1e9,
        );
        assert!(Fence::new(&[Some(huge)], &frame).incomplete);
    }

    #[test]
    fn the_floor_reaches_up_to_its_height() {
        let floor = layer(FLOOR_ID, 30.0, true, Vec3::new(500.0, 0.0, 100.0));
        let own = Vec3::new(500.0, 0.0, 100.0);
        assert!((floor.volume.margin_m(own - floor.position_m) - 70.0).abs() < 1e-9);
    }
}

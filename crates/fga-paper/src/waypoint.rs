//! Algorithm 3, corrected: the next waypoint that the aircraft can fly to.
//!
//! As printed every waypoint passes the test (a bias angle is always below π). The intention (§3) is:
//! from the nearest to the farthest, the first one that lies ahead and that a path within `ρ_min`
//! and the climb limits reaches without entering a protected volume.

use super::dubins::{ClimbLimits, DubinsPath, Pose, SegmentKind};
use fga::Vec3;
use fga::angle::course_of;
use fga::certificate::Hazard;
use fga::situation::Ownship;

/// Longest arc of a path, radians: three quarters of a circle. Longer ones loop back to a waypoint inside
/// the turning circle.
pub const LONGEST_ARC_RAD: f64 = 1.5 * core::f64::consts::PI;

/// Requirements on a path to a waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Turn radius to plan with, at least `ρ_min`, metres.
    pub turn_radius_m: f64,
    /// Climb limits to plan with.
    pub climb: ClimbLimits,
    /// Largest difference from the waypoint's altitude at the end of the path, metres.
    pub altitude_tolerance_m: f64,
    /// Separation beyond every volume, metres.
    pub margin_m: f64,
}

/// The chosen waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NextWaypoint {
    /// Its index in the slice.
    pub index: usize,
    /// Whether it lies ahead of the aircraft; false if no waypoint ahead is within reach.
    pub is_ahead: bool,
    /// The path to it, arriving on the course of the leg that leaves it.
    pub path: DubinsPath,
}

/// The nearest waypoint ahead within reach; without one, the nearest behind (Alg. 3).
///
/// `waypoints_m` are the remaining ones, in the mission's order: the path arrives at each on
/// the course to the next one, at the last one on the course from the previous one. Positions
/// and obstacles are in the same frame; obstacles fly straight from their present positions. `None`
/// if none is within reach, or if the aircraft's state is invalid.
pub fn next_waypoint(
    reach: &Reach,
    ownship: &Ownship,
    waypoints_m: &[Vec3],
    obstacles: &[Hazard],
) -> Option<NextWaypoint> {
    if !ownship.is_valid() {
        return None;
    }
    [true, false].into_iter().find_map(|is_ahead| {
        nearest_first(ownship, waypoints_m, is_ahead).find_map(|index| {
            let path = path_to(reach, ownship, waypoints_m, index, obstacles)?;
            Some(NextWaypoint {
                index,
                is_ahead,
                path,
            })
        })
    })
}

/// Whether a waypoint lies ahead: cos `θ_w` > 0 between the line to it and the aircraft's velocity.
fn ahead(ownship: &Ownship, waypoint_m: Vec3) -> bool {
    (waypoint_m - ownship.position_m).dot(ownship.velocity_mps()) > 0.0
}

/// Indices of the waypoints ahead (or behind), from the nearest to the farthest, without a buffer:
/// each is the least after the previous one.
fn nearest_first(
    ownship: &Ownship,
    waypoints_m: &[Vec3],
    is_ahead: bool,
) -> impl Iterator<Item = usize> {
    let key = move |(index, waypoint): (usize, &Vec3)| {
        let distance_m = waypoint.distance(ownship.position_m);
        (distance_m.is_finite() && ahead(ownship, *waypoint) == is_ahead)
            .then_some((distance_m, index))
    };
    let after = move |last: Option<(f64, usize)>| {
        waypoints_m
            .iter()
            .enumerate()
            .filter_map(key)
            .filter(|next| last.is_none_or(|last| *next > last))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
    };
    core::iter::successors(after(None), move |last| after(Some(*last))).map(|(_, index)| index)
}

fn path_to(
    reach: &Reach,
    ownship: &Ownship,
    waypoints_m: &[Vec3],
    index: usize,
    obstacles: &[Hazard],
) -> Option<DubinsPath> {
    let waypoint_m = *waypoints_m.get(index)?;
    // The leg that leaves it, else the arriving one, else straight from here.
    let leaving = waypoints_m.get(index + 1).map(|next| *next - waypoint_m);
    let arriving = index
        .checked_sub(1)
        .and_then(|before| waypoints_m.get(before))
        .map(|before| waypoint_m - *before);
    let along_m = [leaving, arriving]
        .into_iter()
        .flatten()
        .find(|leg| leg.is_finite() && (leg.x != 0.0 || leg.y != 0.0))
        .unwrap_or(waypoint_m - ownship.position_m);
    let start = Pose {
        position_m: ownship.position_m,
        course_rad: ownship.course_rad,
    };
    let end = Pose {
        position_m: waypoint_m,
        course_rad: course_of(along_m),
    };
    DubinsPath::all(start, end, reach.turn_radius_m, reach.climb)
        .into_iter()
        .flatten()
        .find(|path| {
            path.short_by_m().abs() <= reach.altitude_tolerance_m
                && flies_there(path)
                && path
                    .clearance(ownship.airspeed_mps, obstacles, reach.margin_m)
                    .is_clear()
        })
}

fn flies_there(path: &DubinsPath) -> bool {
    let longest_m = LONGEST_ARC_RAD * path.radius_m();
    let is_straight = |kind| kind == SegmentKind::Straight;
    path.segments()
        .iter()
        .take(3)
        .all(|segment| is_straight(segment.kind) || segment.length_m <= longest_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::situation::ProtectedVolume;
    use proptest::prelude::*;

    const REACH: Reach = Reach {
        turn_radius_m: 30.0,
        climb: ClimbLimits::LEVEL,
        altitude_tolerance_m: 1.0,
        margin_m: 0.0,
    };

    fn ownship() -> Ownship {
        Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    fn route(rows: &[(f64, f64)]) -> alloc::vec::Vec<Vec3> {
        rows.iter().map(|(x, y)| Vec3::new(*x, *y, 0.0)).collect()
    }

    fn ball(x: f64, y: f64, radius_m: f64) -> Hazard {
        let volume = ProtectedVolume::Sphere { radius_m };
        Hazard::exact(1, Vec3::new(x, y, 0.0), Vec3::ZERO, volume)
    }

    #[test]
    fn the_nearest_ahead_is_next() {
        let waypoints = route(&[(-50.0, 0.0), (100.0, 20.0), (400.0, 20.0)]);
        let next = next_waypoint(&REACH, &ownship(), &waypoints, &[]).unwrap();
        assert_eq!((next.index, next.is_ahead), (1, true));
        // It arrives on the leg's course.
        assert!(next.path.end().course_rad.abs() < 1e-9);
        assert!(next.path.end().position_m.distance(waypoints[1]) < 1e-6);
    }

    /// 40 m abeam and barely ahead: inside the turning circle, every path loops. The next one counts.
    #[test]
    fn a_waypoint_inside_the_turning_circle_is_left_out() {
        let waypoints = route(&[(5.0, 20.0), (300.0, 20.0)]);
        let next = next_waypoint(&REACH, &ownship(), &waypoints, &[]).unwrap();
        assert_eq!(next.index, 1);
    }

    #[test]
    fn a_waypoint_behind_an_obstacle_is_left_out() {
        let waypoints = route(&[(200.0, 0.0), (400.0, 0.0)]);
        let covered = [ball(200.0, 0.0, 30.0)];
        let next = next_waypoint(&REACH, &ownship(), &waypoints, &covered);
        // The straight way to the second is blocked too, and no word goes round it.
        assert!(next.is_none_or(|n| n.index == 1));
        let beside = [ball(200.0, 60.0, 30.0)];
        let next = next_waypoint(&REACH, &ownship(), &waypoints, &beside).unwrap();
        assert_eq!(next.index, 0);
    }

    #[test]
    fn none_ahead_turns_back() {
        let waypoints = route(&[(-200.0, 0.0), (-400.0, 0.0)]);
        let next = next_waypoint(&REACH, &ownship(), &waypoints, &[]).unwrap();
        assert_eq!((next.index, next.is_ahead), (0, false));
        assert!(next_waypoint(&REACH, &ownship(), &[], &[]).is_none());
    }

    #[test]
    fn a_waypoint_out_of_the_climb_limits_is_not_reached() {
        let high = [Vec3::new(200.0, 0.0, 80.0)];
        assert!(next_waypoint(&REACH, &ownship(), &high, &[]).is_none());
        let climbing = Reach {
            climb: ClimbLimits {
                max_rad: 0.5,
                ..ClimbLimits::LEVEL
            },
            ..REACH
        };
        assert!(next_waypoint(&climbing, &ownship(), &high, &[]).is_some());
    }

    #[test]
    fn wrong_input_is_refused() {
        let mut own = ownship();
        own.course_rad = f64::NAN;
        assert!(next_waypoint(&REACH, &own, &route(&[(100.0, 0.0)]), &[]).is_none());
        let broken = [Vec3::NAN, Vec3::new(100.0, 0.0, 0.0)];
        assert_eq!(
            next_waypoint(&REACH, &ownship(), &broken, &[])
                .unwrap()
                .index,
            1
        );
        let unknown = [ball(f64::NAN, 0.0, 1.0)];
        assert!(next_waypoint(&REACH, &ownship(), &broken, &unknown).is_none());
    }

    proptest! {
        #[test]
        fn waypoints_are_tried_nearest_first(rows in proptest::collection::vec((-500.0..500.0f64, -500.0..500.0f64), 0..12)) {
            let waypoints = route(&rows);
            let own = ownship();
            let order: alloc::vec::Vec<usize> = nearest_first(&own, &waypoints, true).collect();
            prop_assert_eq!(order.len(), waypoints.iter().filter(|w| w.x > 0.0).count());
            for pair in order.windows(2) {
                prop_assert!(waypoints[pair[0]].length() <= waypoints[pair[1]].length());
            }
        }

        /// The path found stays clear when flown in fine steps.
        #[test]
        fn the_way_found_is_clear(x in 100.0..400.0f64, y in -200.0..200.0f64, ox in 60.0..300.0f64, oy in -100.0..100.0f64) {
            let waypoints = route(&[(x, y), (x + 300.0, y)]);
            let obstacles = [ball(ox, oy, 25.0)];
            if let Some(next) = next_waypoint(&REACH, &ownship(), &waypoints, &obstacles) {
                for i in 0..=4000 {
                    let at = next.path.length_m() * f64::from(i) / 4000.0;
                    let apart = next.path.sample(at).position_m.distance(obstacles[0].position_m);
                    prop_assert!(apart >= 25.0);
                }
            }
        }
    }
}

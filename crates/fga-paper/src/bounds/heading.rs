//! Bound 3: the courses that stay clear, as a union of intervals (Eq. 46–48).
//!
//! In the horizontal plane, at the aircraft's horizontal speed, against the disc of each volume's
//! horizontal radius. Courses increase to the left.

use core::f64::consts::{FRAC_PI_2, PI};

use fga::angle::{direction, wrap_pi};
use fga::certificate::Hazard;
use fga::situation::Ownship;

/// Most intervals in a set. One obstacle forbids at most two arcs, so 31 always fit.
pub const MAX_INTERVALS: usize = 64;

/// The least rotations that make a course admissible (Eq. 46), radians, both at least 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotations {
    /// `φ_2`: to the left (anticlockwise).
    pub left_rad: f64,
    /// `φ_1`: to the right (clockwise).
    pub right_rad: f64,
}

/// A set of courses: disjoint closed intervals in [−π, π], in order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingSet {
    intervals: [(f64, f64); MAX_INTERVALS],
    len: usize,
}

impl HeadingSet {
    /// No course.
    pub const EMPTY: Self = Self {
        intervals: [(0.0, 0.0); MAX_INTERVALS],
        len: 0,
    };

    /// Every course.
    pub fn full() -> Self {
        let mut set = Self::EMPTY;
        set.push(-PI, PI);
        set
    }

    /// `Φ_i`: the courses on which the aircraft stays clear of one obstacle (Eq. 46).
    ///
    /// Inside the disc: the courses away from the centre. `None` if a number is not finite or out of
    /// range.
    pub fn of(ownship: &Ownship, obstacle: &Hazard) -> Option<Self> {
        let encounter = Planar::of(ownship, obstacle)?;
        let mut cuts = [-PI, PI, PI, PI, PI, PI];
        for (slot, cut) in cuts.iter_mut().skip(1).zip(encounter.boundaries()) {
            *slot = cut.unwrap_or(PI);
        }
        cuts.sort_unstable_by(f64::total_cmp);
        let mut set = Self::EMPTY;
        for pair in cuts.windows(2) {
            if let [from, to] = *pair
                && from < to
                && encounter.admits(f64::midpoint(from, to))
            {
                set.push(from, to);
            }
        }
        Some(set)
    }

    /// ∩ `Φ_i` over all obstacles (Eq. 47); not empty if a solution exists (Eq. 48).
    ///
    /// Invalid obstacles do not count.
    pub fn of_all(ownship: &Ownship, obstacles: &[Hazard]) -> Self {
        obstacles
            .iter()
            .filter_map(|obstacle| Self::of(ownship, obstacle))
            .fold(Self::full(), |all, one| all.intersection(&one))
    }

    /// The intervals, in order.
    pub fn intervals(&self) -> &[(f64, f64)] {
        self.intervals.get(..self.len).unwrap_or(&[])
    }

    /// Whether no course is in the set.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether a course, wrapped or not, is in the set.
    pub fn contains(&self, course_rad: f64) -> bool {
        let course_rad = wrap_pi(course_rad);
        self.intervals()
            .iter()
            .any(|&(from, to)| from <= course_rad && course_rad <= to)
    }

    /// The sum of the intervals' widths, radians: 2π for every course.
    pub fn width_rad(&self) -> f64 {
        self.intervals().iter().map(|(from, to)| to - from).sum()
    }

    /// The courses in both.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let mut set = Self::EMPTY;
        for &(from, to) in self.intervals() {
            for &(other_from, other_to) in other.intervals() {
                let (start, end) = (from.max(other_from), to.min(other_to));
                if start < end {
                    set.push(start, end);
                }
            }
        }
        set
    }

    /// The least rotations from a course to an admissible one (`φ_2` and −`φ_1` of Eq. 46); both 0
    /// for an admissible course. `None` for an empty set.
    pub fn rotations(&self, course_rad: f64) -> Option<Rotations> {
        if self.is_empty() {
            return None;
        }
        if self.contains(course_rad) {
            return Some(Rotations {
                left_rad: 0.0,
                right_rad: 0.0,
            });
        }
        let turn = |angle: f64| libm::fmod(angle + 4.0 * PI, 2.0 * PI);
        let course_rad = wrap_pi(course_rad);
        let least = |a: f64, b: f64| a.min(b);
        Some(Rotations {
            left_rad: self
                .intervals()
                .iter()
                .map(|(from, _)| turn(from - course_rad))
                .fold(2.0 * PI, least),
            right_rad: self
                .intervals()
                .iter()
                .map(|(_, to)| turn(course_rad - to))
                .fold(2.0 * PI, least),
        })
    }

    /// Appends an interval behind the others, or joins it to the last if they touch. In a full set
    /// the narrowest interval goes, so that the set stays a subset of the true one.
    fn push(&mut self, from: f64, to: f64) {
        if let Some(last) = self
            .len
            .checked_sub(1)
            .and_then(|i| self.intervals.get_mut(i))
            && last.1 == from
        {
            last.1 = to;
            return;
        }
        if self.len == MAX_INTERVALS {
            let width = |(from, to): (f64, f64)| to - from;
            let narrowest = self
                .intervals()
                .iter()
                .enumerate()
                .min_by(|a, b| width(*a.1).total_cmp(&width(*b.1)))
                .map_or(0, |(index, _)| index);
            if let Some([_, rest @ ..]) = self.intervals.get(narrowest..) {
                let mut moved = self.intervals;
                for (slot, interval) in moved.iter_mut().skip(narrowest).zip(rest) {
                    *slot = *interval;
                }
                self.intervals = moved;
            }
            self.len -= 1;
        }
        if let Some(slot) = self.intervals.get_mut(self.len) {
            *slot = (from, to);
            self.len += 1;
        }
    }
}

/// An encounter in the horizontal plane.
struct Planar {
    /// A − U.
    offset: (f64, f64),
    /// `V_a`.
    obstacle: (f64, f64),
    /// Horizontal part of `V_u`.
    speed: f64,
    radius: f64,
}

fn dot(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.0 + a.1 * b.1
}

impl Planar {
    fn of(ownship: &Ownship, obstacle: &Hazard) -> Option<Self> {
        let relative = crate::conflict::Relative::of(ownship, obstacle)?;
        let offset = relative.position_m();
        let speed = ownship.airspeed_mps * libm::cos(ownship.climb_rad);
        (obstacle.is_valid() && ownship.is_valid()).then_some(Self {
            offset: (offset.x, offset.y),
            obstacle: (obstacle.velocity_mps.x, obstacle.velocity_mps.y),
            speed,
            radius: obstacle.volume.radius_m(),
        })
    }

    fn is_inside(&self) -> bool {
        dot(self.offset, self.offset) < self.radius * self.radius
    }

    /// Whether the course stays clear: the decision of Eq. 3–6 in the plane.
    fn admits(&self, course: f64) -> bool {
        let way = direction(course, 0.0) * self.speed;
        let relative = (way.x - self.obstacle.0, way.y - self.obstacle.1);
        let closing = dot(self.offset, relative);
        let cross = self.offset.0 * relative.1 - self.offset.1 * relative.0;
        closing <= 0.0
            || (!self.is_inside()
                && cross * cross >= self.radius * self.radius * dot(relative, relative))
    }

    /// The courses at which admissibility may change.
    fn boundaries(&self) -> [Option<f64>; 4] {
        let bearing = libm::atan2(self.offset.1, self.offset.0);
        if self.is_inside() {
            // V_r · r = 0.
            let (sin, cos) = libm::sincos(bearing);
            let share = dot(self.obstacle, (cos, sin)) / self.speed;
            let half = (share.abs() <= 1.0).then(|| libm::acos(share));
            return [
                half.map(|h| wrap_pi(bearing + h)),
                half.map(|h| wrap_pi(bearing - h)),
                None,
                None,
            ];
        }
        let distance = libm::sqrt(dot(self.offset, self.offset));
        let opening = if distance > 0.0 {
            libm::asin((self.radius / distance).min(1.0))
        } else {
            FRAC_PI_2
        };
        let [a, b] = self.on_edge(bearing + opening);
        let [c, d] = self.on_edge(bearing - opening);
        [a, b, c, d]
    }

    /// Courses at which `V_r` lies on an edge of the cone: |`V_a` + λ û| = `V_u`, λ ≥ 0.
    fn on_edge(&self, edge: f64) -> [Option<f64>; 2] {
        let (sin, cos) = libm::sincos(edge);
        let along = dot(self.obstacle, (cos, sin));
        let rest = dot(self.obstacle, self.obstacle) - self.speed * self.speed;
        let root = libm::sqrt(along * along - rest);
        [-along - root, -along + root].map(|lambda| {
            (lambda >= 0.0).then(|| {
                libm::atan2(
                    self.obstacle.1 + lambda * sin,
                    self.obstacle.0 + lambda * cos,
                )
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conflict::{Relative, threatens};
    use fga::Vec3;
    use fga::situation::ProtectedVolume;
    use proptest::prelude::*;

    fn ownship(course_rad: f64) -> Ownship {
        Ownship {
            position_m: Vec3::new(3.0, 4.0, 50.0),
            course_rad,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    fn ball(x: f64, y: f64, vx: f64, vy: f64, radius_m: f64) -> Hazard {
        let volume = ProtectedVolume::Sphere { radius_m };
        Hazard::exact(
            1,
            Vec3::new(3.0 + x, 4.0 + y, 50.0),
            Vec3::new(vx, vy, 0.0),
            volume,
        )
    }

    /// A static sphere hides asin(30/100) = 17.46° to each side.
    #[test]
    fn a_static_obstacle_forbids_its_tangent_cone() {
        let set = HeadingSet::of(&ownship(0.0), &ball(100.0, 0.0, 0.0, 0.0, 30.0)).unwrap();
        let half = f64::asin(0.3);
        assert!((set.width_rad() - 2.0 * (PI - half)).abs() < 1e-12);
        let rotations = set.rotations(0.1).unwrap();
        assert!((rotations.left_rad - (half - 0.1)).abs() < 1e-12);
        assert!((rotations.right_rad - (half + 0.1)).abs() < 1e-12);
        assert!(set.contains(3.0) && !set.contains(0.1 + 2.0 * PI));
        // Behind, the forbidden arc lies across ±π.
        let behind = HeadingSet::of(&ownship(0.0), &ball(-100.0, 0.0, 0.0, 0.0, 30.0)).unwrap();
        assert_eq!(behind.intervals().len(), 1);
        let rotations = behind.rotations(PI).unwrap();
        assert!((rotations.left_rad - half).abs() < 1e-12);
        assert!((rotations.right_rad - half).abs() < 1e-12);
    }

    #[test]
    fn two_gates_leave_the_intersection() {
        let obstacles = [
            ball(100.0, 0.0, 0.0, 0.0, 30.0),
            ball(0.0, 100.0, 0.0, 0.0, 30.0),
        ];
        let set = HeadingSet::of_all(&ownship(0.0), &obstacles);
        assert!(!set.contains(0.0) && !set.contains(FRAC_PI_2) && set.contains(0.8));
        assert!((set.width_rad() - (2.0 * PI - 4.0 * f64::asin(0.3))).abs() < 1e-9);
        let nothing = set.intersection(&HeadingSet::EMPTY);
        assert!(nothing.is_empty() && nothing.rotations(0.0).is_none());
        assert_eq!(HeadingSet::full().rotations(1.0).unwrap().left_rad, 0.0);
    }

    #[test]
    fn inside_every_course_that_leads_away_is_left() {
        let set = HeadingSet::of(&ownship(0.0), &ball(10.0, 0.0, 0.0, 0.0, 30.0)).unwrap();
        assert!((set.width_rad() - PI).abs() < 1e-9);
        assert!(set.contains(PI) && !set.contains(0.0));
    }

    #[test]
    fn too_fast_an_obstacle_leaves_no_course() {
        // Head-on at 60 m/s needs 18 m/s (bound 2).
        let set = HeadingSet::of(&ownship(0.0), &ball(100.0, 0.0, -60.0, 0.0, 30.0)).unwrap();
        assert!(set.is_empty());
    }

    #[test]
    fn wrong_input_is_refused() {
        assert!(HeadingSet::of(&ownship(f64::NAN), &ball(100.0, 0.0, 0.0, 0.0, 30.0)).is_none());
        assert!(HeadingSet::of(&ownship(0.0), &ball(f64::INFINITY, 0.0, 0.0, 0.0, 30.0)).is_none());
        assert!(HeadingSet::of(&ownship(0.0), &ball(100.0, 0.0, 0.0, 0.0, -30.0)).is_none());
    }

    #[test]
    fn more_obstacles_than_fit_leave_a_subset() {
        let many: alloc::vec::Vec<Hazard> = (0..90)
            .map(|i| {
                let way = direction(f64::from(i) * 2.0 * PI / 90.0, 0.0) * 1000.0;
                ball(way.x, way.y, 0.0, 0.0, 5.0)
            })
            .collect();
        let set = HeadingSet::of_all(&ownship(0.0), &many);
        assert!(!set.is_empty() && set.intervals().len() <= MAX_INTERVALS);
        for &(from, to) in set.intervals() {
            let way = f64::midpoint(from, to);
            assert!(
                many.iter()
                    .all(|o| HeadingSet::of(&ownship(0.0), o).unwrap().contains(way))
            );
        }
    }

    proptest! {
        /// Course by course the set is what the threat decision of `conflict` says.
        #[test]
        fn the_set_is_the_threat_decision(
            x in -300.0..300.0f64, y in -300.0..300.0f64, vx in -60.0..60.0f64, vy in -60.0..60.0f64,
            course in -3.1..3.1f64, radius in 5.0..60.0f64,
        ) {
            prop_assume!(libm::hypot(x, y) > radius);
            let obstacle = ball(x, y, vx, vy, radius);
            let set = HeadingSet::of(&ownship(0.0), &obstacle).unwrap();
            let near_an_end = set.intervals().iter().any(|(a, b)| (course - a).abs() < 1e-6 || (course - b).abs() < 1e-6);
            prop_assume!(!near_an_end);
            let relative = Relative::of(&ownship(course), &obstacle).unwrap();
            prop_assert_eq!(set.contains(course), !threatens(&relative, &obstacle.volume));
        }

        #[test]
        fn intersection_is_membership_in_both(
            rows in proptest::collection::vec((-300.0..300.0f64, -300.0..300.0f64, -30.0..30.0f64, -30.0..30.0f64), 1..6),
            course in -3.1..3.1f64,
        ) {
            let obstacles: alloc::vec::Vec<Hazard> = rows.iter().map(|r| ball(r.0, r.1, r.2, r.3, 30.0)).collect();
            let all = HeadingSet::of_all(&ownship(0.0), &obstacles);
            let each = obstacles.iter().all(|o| HeadingSet::of(&ownship(0.0), o).unwrap().contains(course));
            prop_assert_eq!(all.contains(course), each);
        }

        #[test]
        fn every_number_gives_numbers_or_none(p: [f64; 2], v: [f64; 2], radius: f64, course: f64) {
            if let Some(set) = HeadingSet::of(&ownship(course), &ball(p[0], p[1], v[0], v[1], radius)) {
                prop_assert!(set.width_rad().is_finite());
                prop_assert!(set.rotations(course).is_none_or(|r| r.left_rad.is_finite() && r.right_rad.is_finite()));
            }
        }
    }
}

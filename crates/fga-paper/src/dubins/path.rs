//! A shortest path.

use core::f64::consts::TAU;

use dubins_paths::PathType;
use dubins_paths::f64::{Intermediate, PosRot};

use fga::Vec3;
use fga::angle::wrap_pi;
use fga::limit::{LARGEST_M, Limit as _};
use fga::search::Side;

/// A position and the course through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Position, metres.
    pub position_m: Vec3,
    /// Course ψ, radians.
    pub course_rad: f64,
}

/// The kind of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SegmentKind {
    /// Straight on.
    Straight,
    /// An arc to this side.
    Turn(Side),
}

/// A piece of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Its kind.
    pub kind: SegmentKind,
    /// Its horizontal length, metres.
    pub length_m: f64,
}

/// The climb limits of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClimbLimits {
    /// Steepest descent, radians, at most 0.
    pub min_rad: f64,
    /// Steepest climb, radians, at least 0.
    pub max_rad: f64,
    /// Whether to add full circles at the end if the path is too short for its climb.
    pub may_circle: bool,
}

impl ClimbLimits {
    /// No climb at all.
    pub const LEVEL: Self = Self {
        min_rad: 0.0,
        max_rad: 0.0,
        may_circle: false,
    };
}

/// Most circles added for a climb.
const MAX_CIRCLES: f64 = 1000.0;

/// A flyable path: up to three segments and, if needed, circles at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DubinsPath {
    start: Pose,
    radius_m: f64,
    segments: [Segment; 4],
    climb_rad: f64,
    short_by_m: f64,
}

impl DubinsPath {
    /// The shortest path between two poses at a turn radius.
    ///
    /// `None` where a number is not finite or out of range, or the radius is not positive.
    pub fn shortest(start: Pose, end: Pose, radius_m: f64, climb: ClimbLimits) -> Option<Self> {
        Self::all(start, end, radius_m, climb)
            .into_iter()
            .flatten()
            .next()
    }

    /// All words that lead there, shortest first (up to six; `None` behind the last).
    pub fn all(start: Pose, end: Pose, radius_m: f64, climb: ClimbLimits) -> [Option<Self>; 6] {
        let mut paths = PathType::ALL.map(|word| Self::word(start, end, radius_m, climb, word));
        let length = |path: &Option<Self>| path.map_or(f64::INFINITY, |p| p.length_m());
        // Stable by construction: equal lengths keep the crate's order, insertion sort of six.
        for last in 1..paths.len() {
            for at in (1..=last).rev() {
                let swap = matches!((paths.get(at - 1), paths.get(at)), (Some(a), Some(b)) if length(b) < length(a));
                if !swap {
                    break;
                }
                paths.swap(at - 1, at);
            }
        }
        paths
    }

    fn word(
        start: Pose,
        end: Pose,
        radius_m: f64,
        climb: ClimbLimits,
        word: PathType,
    ) -> Option<Self> {
        let usable = |pose: &Pose| {
            pose.position_m.abs().max_element() <= LARGEST_M
                && pose.position_m.is_finite()
                && pose.course_rad.is_finite()
        };
        let limits_ok = climb.min_rad <= 0.0
            && climb.max_rad >= 0.0
            && climb.min_rad > -core::f64::consts::FRAC_PI_2
            && climb.max_rad < core::f64::consts::FRAC_PI_2;
        if !usable(&start) || !usable(&end) || !limits_ok {
            return None;
        }
        if !(1e-9..=LARGEST_M).contains(&radius_m) {
            return None;
        }
        // Moves the start to the origin, so that far-away coordinates lose no precision.
        let offset = end.position_m - start.position_m;
        let from = PosRot::from_floats(0.0, 0.0, wrap_pi(start.course_rad));
        let to = PosRot::from_floats(offset.x, offset.y, wrap_pi(end.course_rad));
        let kinds = match word {
            PathType::LSL => [LEFT, STRAIGHT, LEFT],
            PathType::LSR => [LEFT, STRAIGHT, RIGHT],
            PathType::RSL => [RIGHT, STRAIGHT, LEFT],
            PathType::RSR => [RIGHT, STRAIGHT, RIGHT],
            PathType::RLR => [RIGHT, LEFT, RIGHT],
            PathType::LRL => [LEFT, RIGHT, LEFT],
        };
        let segment = |kind, length: f64| {
            // Rounding makes a full circle of no arc.
            let full = kind != SegmentKind::Straight && length > TAU - 1e-7;
            let length_m = if full { 0.0 } else { length * radius_m };
            Segment { kind, length_m }
        };
        let [k, l, m] = kinds;
        let arriving = |[a, b, c]: [f64; 3]| {
            let path = Self {
                start,
                radius_m,
                segments: [segment(k, a), segment(l, b), segment(m, c), segment(m, 0.0)],
                climb_rad: 0.0,
                short_by_m: 0.0,
            };
            let reached = path.sample(path.length_m());
            let level = Vec3::new(offset.x, offset.y, 0.0);
            let missed = reached.position_m - start.position_m - level;
            let tolerance_m = 1e-6 * (radius_m + level.length());
            let arrives = libm::hypot(missed.x, missed.y) <= tolerance_m
                && wrap_pi(reached.course_rad - end.course_rad).abs() < 1e-6;
            arrives.then_some(path)
        };
        // One arc all the way: its straight piece of no length has no direction to compute with.
        let turn_rad = wrap_pi(end.course_rad) - wrap_pi(start.course_rad);
        let one_arc = match word {
            PathType::LSL => arriving([libm::fmod(turn_rad + TAU, TAU), 0.0, 0.0]),
            PathType::RSR => arriving([libm::fmod(TAU - turn_rad, TAU), 0.0, 0.0]),
            _ => None,
        };
        let mut path = match one_arc {
            Some(path) => path,
            None => arriving(Intermediate::new(from, to, radius_m).word(word).ok()?)?,
        };
        path.climb_to(offset.z, climb);
        Some(path)
    }

    fn climb_to(&mut self, rise_m: f64, limits: ClimbLimits) {
        let limit_rad = if rise_m < 0.0 {
            limits.min_rad
        } else {
            limits.max_rad
        };
        let needed_m = rise_m / libm::tan(limit_rad);
        let length_m = self.length_m();
        if limits.may_circle && limit_rad != 0.0 && needed_m > length_m {
            let circle_m = TAU * self.radius_m;
            let circles = libm::ceil((needed_m - length_m) / circle_m);
            if circles <= MAX_CIRCLES {
                let [_, _, last, circling] = &mut self.segments;
                circling.kind = last.kind;
                if circling.kind == SegmentKind::Straight {
                    circling.kind = LEFT;
                }
                circling.length_m = circles * circle_m;
            }
        }
        let length_m = self.length_m();
        let wanted_rad = libm::atan2(rise_m, length_m);
        self.climb_rad = if rise_m == 0.0 {
            0.0
        } else {
            wanted_rad.limited(limits.min_rad, limits.max_rad)
        };
        let short_by_m = rise_m - length_m * libm::tan(self.climb_rad);
        self.short_by_m = if self.climb_rad == wanted_rad || rise_m == 0.0 {
            0.0
        } else {
            short_by_m
        };
    }

    /// Its start.
    pub const fn start(&self) -> Pose {
        self.start
    }

    /// Turn radius, metres.
    pub const fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// The segments in order; some may have no length. The fourth holds circles for the climb.
    pub const fn segments(&self) -> &[Segment; 4] {
        &self.segments
    }

    /// The climb angle along the whole path, radians.
    pub const fn climb_rad(&self) -> f64 {
        self.climb_rad
    }

    /// Altitude change that the climb limits do not reach, metres; 0 if it arrives.
    pub const fn short_by_m(&self) -> f64 {
        self.short_by_m
    }

    /// Horizontal length, metres.
    pub fn length_m(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length_m).sum()
    }

    /// Time to fly it at a constant total airspeed (Eq. 10–12), seconds.
    pub fn duration_s(&self, airspeed_mps: f64) -> f64 {
        self.length_m() / (airspeed_mps * libm::cos(self.climb_rad))
    }

    /// The pose after a horizontal distance along the path, metres; its course is not wrapped, so
    /// that it has no jump. Beyond the path, its nearer end.
    pub fn sample(&self, at_m: f64) -> Pose {
        let mut pose = self.start;
        let at_m = if at_m.is_nan() { 0.0 } else { at_m.max(0.0) };
        let mut left_m = at_m;
        let mut flown_m = 0.0;
        for segment in &self.segments {
            let length_m = left_m.min(segment.length_m);
            pose = self.advanced(pose, segment.kind, length_m);
            left_m -= length_m;
            flown_m += length_m;
            if left_m <= 0.0 {
                break;
            }
        }
        pose.position_m.z = self.start.position_m.z + flown_m * libm::tan(self.climb_rad);
        pose
    }

    /// Its end.
    pub fn end(&self) -> Pose {
        self.sample(f64::INFINITY)
    }

    fn advanced(&self, pose: Pose, kind: SegmentKind, length_m: f64) -> Pose {
        let (sin, cos) = libm::sincos(pose.course_rad);
        match kind {
            SegmentKind::Straight => Pose {
                position_m: pose.position_m + Vec3::new(cos, sin, 0.0) * length_m,
                ..pose
            },
            SegmentKind::Turn(side) => {
                let course_rad = pose.course_rad + side.sign() * length_m / self.radius_m;
                let (sin_end, cos_end) = libm::sincos(course_rad);
                let signed_m = side.sign() * self.radius_m;
                let moved = Vec3::new(sin_end - sin, cos - cos_end, 0.0) * signed_m;
                Pose {
                    position_m: pose.position_m + moved,
                    course_rad,
                }
            }
        }
    }
}

const LEFT: SegmentKind = SegmentKind::Turn(Side::Left);
const RIGHT: SegmentKind = SegmentKind::Turn(Side::Right);
const STRAIGHT: SegmentKind = SegmentKind::Straight;

#[cfg(test)]
mod tests;

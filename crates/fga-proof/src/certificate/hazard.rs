//! An obstacle for the certificate: how close a line comes to it.

use crate::Vec3;
use crate::limit::Limit as _;
use crate::meter::{LEAST_STEP, LOOK, Meter};
use crate::situation::ProtectedVolume;

/// Most steps to the least margin of a cylinder on a line; six are usual.
const MOST_STEPS: u32 = 40;

/// Largest number of an extent, metres, metres per second: a limit of altitude is a sphere of 10⁹ m, the surface of which is known to a
/// micrometre.
const MOST_M: f64 = 2e9;

/// Accuracy of a cylinder's least margin on a line, metres.
const LEAST_KNOWN_M: f64 = 1e-9;

/// A volume that moves straight and grows, for a time, in the air mass.
///
/// A curved motion is several of these, one after the other, each valid only within its own window of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Centre at time 0, metres, air-mass frame; where the window begins later, extended backwards.
    pub position_m: Vec3,
    /// Velocity in the air mass, metres per second.
    pub velocity_mps: Vec3,
    /// The volume at time 0, uncertainty included.
    pub volume: ProtectedVolume,
    /// Outward speed of its surface as the prediction ages, metres per second.
    pub growth_mps: f64,
    /// Stretch of the volume up and down, metres: at time 0, and per second; never negative within the window.
    pub stretch_m: (f64, f64),
    /// Its window of time: from and until, seconds from the decision.
    pub window_s: (f64, f64),
    /// How deep a flight may come into a cylinder, metres, or [`NO_DEPTH`]: the margin is this less the depth, or plus
    /// the distance outside. The depth is s·w·f/(w + f), with the distances to wall and face as shares w and f of radius
    /// and half height, and s the smaller of the two: at one height it grows towards the axis.
    pub allowed_depth_m: f64,
}

/// What a hazard stands for, the strongest assumption first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Assumption {
    /// An obstacle as it was reported, with its uncertainty, that keeps its velocity.
    Reported,
    /// One motion out of all that its aircraft may fly.
    Possible,
    /// An extent that somebody else answers for.
    Given,
    /// A volume that the aircraft is already in, made smaller so that a way out of it keeps clear of the rest.
    Leaving,
    /// A volume to compare manoeuvres by: nothing is proven against it.
    Compared,
}

/// What a flight keeps clear of: an extent, the obstacle that it belongs to, and what it stands for. Everybody may read it,
/// and only the makers of [`assumptions`](crate::assumptions) may make one against which anything is proven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hazard {
    pub(crate) extent: Extent,
    pub(crate) id: u32,
    pub(crate) stands_for: Assumption,
}

impl Hazard {
    /// The identifier of its obstacle.
    #[inline]
    pub const fn id(&self) -> u32 {
        self.id
    }

    /// What it stands for.
    pub const fn stands_for(&self) -> Assumption {
        self.stands_for
    }
}

impl core::ops::Deref for Hazard {
    type Target = Extent;

    #[inline]
    fn deref(&self) -> &Extent {
        &self.extent
    }
}

/// The margin inside is minus the distance to the nearest surface.
pub const NO_DEPTH: f64 = f64::NEG_INFINITY;

/// The window of a permanent hazard, seconds.
pub const ALWAYS: (f64, f64) = (0.0, f64::INFINITY);

/// A point in straight motion for a while, in the air mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Its first position, metres.
    pub from_m: Vec3,
    /// Its velocity, metres per second.
    pub velocity_mps: Vec3,
    /// Its start, seconds from the decision.
    pub at_s: f64,
    /// Its duration, seconds.
    pub duration_s: f64,
}

impl Line {
    /// From one place to another one, metres, from a moment on, in a time, seconds.
    #[inline]
    pub fn over((from_m, to_m): (Vec3, Vec3), at_s: f64, duration_s: f64) -> Self {
        Self {
            from_m,
            velocity_mps: (to_m - from_m) / duration_s,
            at_s,
            duration_s,
        }
    }

    /// From one place to another one in a second.
    pub fn between(from_m: Vec3, to_m: Vec3) -> Self {
        Self::over((from_m, to_m), 0.0, 1.0)
    }

    /// At a place.
    pub fn at(place_m: Vec3) -> Self {
        Self::between(place_m, place_m)
    }
}

impl Extent {
    /// A volume that keeps its size and its velocity.
    pub const fn exact(position_m: Vec3, velocity_mps: Vec3, volume: ProtectedVolume) -> Self {
        Self {
            position_m,
            velocity_mps,
            volume,
            growth_mps: 0.0,
            stretch_m: (0.0, 0.0),
            window_s: ALWAYS,
            allowed_depth_m: NO_DEPTH,
        }
    }

    /// Centre `after_s` seconds from now, metres.
    #[inline]
    pub fn position_after_m(&self, after_s: f64) -> Vec3 {
        self.position_m + self.velocity_mps * after_s
    }

    /// Whether its numbers are finite and in the range of the claim, and no length is negative within its window.
    pub fn is_valid(&self) -> bool {
        let (from_s, until_s) = self.window_s;
        let (stretch_m, stretch_mps) = self.stretch_m;
        let is_length = |length_m: f64| (0.0..=MOST_M).contains(&length_m);
        let is_near = |vector: Vec3| vector.abs().cmple(Vec3::splat(MOST_M)).all();
        let first_m = stretch_m + stretch_mps * from_s.max(0.0);
        let last_m = if until_s < f64::INFINITY {
            stretch_m + stretch_mps * until_s
        } else {
            stretch_mps
        };
        is_near(self.position_m)
            && is_near(self.velocity_mps)
            && is_length(self.volume.radius_m())
            && is_length(self.volume.half_height_m())
            && is_length(self.growth_mps)
            && (from_s > until_s || is_length(first_m) && last_m >= 0.0)
    }

    /// Whether its volume is a cylinder.
    pub const fn is_cylinder(&self) -> bool {
        matches!(self.volume, ProtectedVolume::Cylinder { .. })
    }

    fn offset_m(&self, position_m: Vec3, at_s: f64) -> Vec3 {
        position_m - self.position_after_m(at_s)
    }

    /// Margin at a time, metres: signed distance from the volume's surface, negative inside, or by
    /// [`Self::allowed_depth_m`].
    pub fn margin_m(&self, position_m: Vec3, at_s: f64) -> f64 {
        let offset = self.offset_m(position_m, at_s);
        self.margin_and_slope(offset, Vec3::ZERO, at_s).0
    }

    fn is_stretched(&self) -> bool {
        self.stretch_m != (0.0, 0.0)
    }

    /// The part of a line that lies in its window.
    fn within_window(&self, line: &Line) -> Option<Line> {
        let (from_s, until_s) = self.window_s;
        let skipped_s = (from_s - line.at_s).max(0.0);
        let end_s = line.duration_s.min(until_s - line.at_s);
        (end_s >= skipped_s).then(|| Line {
            from_m: line.from_m + line.velocity_mps * skipped_s,
            at_s: line.at_s + skipped_s,
            duration_s: end_s - skipped_s,
            ..*line
        })
    }

    /// The least margin on a line and when, if it is below one; minus infinity if the meter refuses the look.
    #[inline]
    pub fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        if self.window_s == ALWAYS {
            self.least_within(line, below_m, meter)
        } else {
            self.least_within(&self.within_window(line)?, below_m, meter)
        }
    }

    /// The least margin on a line within its window.
    fn least_within(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        let (at_s, duration_s) = (line.at_s, line.duration_s);
        let offset = self.offset_m(line.from_m, at_s);
        let velocity = line.velocity_mps - self.velocity_mps;
        // Squares only, until the sphere is close enough to matter.
        let square = velocity.length_squared();
        let along = -offset.dot(velocity);
        let (nearest, nearest_s) = if along <= 0.0 {
            (offset, 0.0)
        } else {
            let nearest_s = if along >= square * duration_s {
                duration_s
            } else {
                along / square
            };
            (offset + velocity * nearest_s, nearest_s)
        };
        let (stretch_m, stretch_mps) = self.stretch_m;
        let radius = self.volume.bounding_radius_m();
        let grown = (self.growth_mps + stretch_mps) * (at_s + duration_s) + stretch_m;
        let reach = radius + grown + below_m;
        let nearest_square = nearest.length_squared();
        if reach < 0.0 || nearest_square >= reach * reach {
            return None;
        }
        if !meter.take(LOOK) {
            return Some((f64::NEG_INFINITY, at_s));
        }
        if self.is_cylinder() || self.growth_mps != 0.0 || self.is_stretched() {
            return self.least_without_form(line, below_m, meter);
        }
        let margin = libm::sqrt(nearest_square) - radius;
        (margin < below_m).then_some((margin, at_s + nearest_s))
    }

    /// The same for all but a sphere that neither grows nor stretches.
    #[inline(never)]
    fn least_without_form(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        let (at_s, duration_s, growth) = (line.at_s, line.duration_s, self.growth_mps);
        let offset = self.offset_m(line.from_m, at_s);
        let velocity = line.velocity_mps - self.velocity_mps;
        let (margin, when) = if self.is_cylinder() || self.is_stretched() {
            let margin = |t: f64| self.margin_and_slope(offset + velocity * t, velocity, at_s + t);
            least_of_convex(margin, duration_s, below_m, meter)?
        } else {
            let when = growing_nearest_s(offset, velocity, growth, duration_s);
            let distance = (offset + velocity * when).length();
            let radius = self.volume.radius_m() + growth * at_s;
            (distance - radius - growth * when, when)
        };
        (margin < below_m).then_some((margin, at_s + when))
    }

    /// Margin at an offset from the centre, metres, and its slope for a moving offset, metres per
    /// second.
    fn margin_and_slope(&self, offset: Vec3, velocity: Vec3, at_s: f64) -> (f64, f64) {
        let (now_m, more_mps) = self.stretch_m;
        let mut height = offset.z.abs() - (now_m + more_mps * at_s);
        let mut rise = libm::copysign(velocity.z, velocity.z * offset.z) - more_mps;
        if self.is_stretched() && height < 0.0 {
            (height, rise) = (0.0, 0.0);
        }
        let aside = offset.truncate().length();
        let departs = if aside > 0.0 {
            offset.truncate().dot(velocity.truncate()) / aside
        } else {
            0.0
        };
        let (radius_m, half_m) = (self.volume.radius_m(), self.volume.half_height_m());
        let (wall, face, room) = if self.is_cylinder() {
            (aside - radius_m, height - half_m, 0.0)
        } else {
            (aside, height, radius_m)
        };
        let (margin, slope) = if !self.is_cylinder() || (wall > 0.0 && face > 0.0) {
            let distance = libm::sqrt(wall * wall + face * face);
            let slope = (wall * departs + face * rise) / distance.max(f64::MIN_POSITIVE);
            (distance - room, slope)
        } else if self.allowed_depth_m >= 0.0 && wall < 0.0 && face < 0.0 {
            let (w, f) = (wall / radius_m, face / half_m);
            let least_m = radius_m.min(half_m);
            let of_wall = w / (w + f).min(-f64::MIN_POSITIVE);
            let of_face = 1.0 - of_wall;
            let slope = of_face * of_face * departs / radius_m + of_wall * of_wall * rise / half_m;
            (least_m * of_wall * f, least_m * slope)
        } else if wall > face {
            (wall, departs)
        } else {
            (face, rise)
        };
        let allowed_m = self.allowed_depth_m.max(0.0) - self.growth_mps * at_s;
        (margin + allowed_m, slope - self.growth_mps)
    }
}

/// The time of the least |q + w t| − g t on [0, duration]: where the closing speed falls to the growth.
fn growing_nearest_s(offset: Vec3, velocity: Vec3, growth: f64, duration_s: f64) -> f64 {
    let square = velocity.length_squared();
    let faster = square - growth * growth;
    if faster <= 0.0 {
        // The volume grows faster than the aircraft can leave: the end is worst.
        return duration_s;
    }
    let foot_s = -offset.dot(velocity) / square;
    let miss = (offset + velocity * foot_s).length();
    let beyond_s = growth * miss / libm::sqrt(square * faster);
    (foot_s + beyond_s).limited(0.0, duration_s)
}

/// Minimum of a convex function on [0, duration], from below, and its time, from its values and
/// slopes: `None` if it is not below `below`.
///
/// The tangents at two points with the minimum between them meet below it.
fn least_of_convex(
    function: impl Fn(f64) -> (f64, f64),
    duration: f64,
    below: f64,
    meter: &Meter,
) -> Option<(f64, f64)> {
    if !meter.take(LEAST_STEP) {
        return Some((f64::NEG_INFINITY, 0.0));
    }
    let mut low = (0.0, function(0.0));
    if low.1.1 >= 0.0 || duration <= 0.0 {
        return Some((low.1.0, low.0));
    }
    let mut high = (duration, function(duration));
    if high.1.1 <= 0.0 {
        return Some((high.1.0, high.0));
    }
    let mut bound = f64::NEG_INFINITY;
    let mut at = 0.0;
    for step in 0..MOST_STEPS {
        let ((a, (at_a, slope_a)), (b, (at_b, slope_b))) = (low, high);
        let meet = a + (at_b - at_a - slope_b * (b - a)) / (slope_a - slope_b);
        at = meet.max(a).min(b);
        bound = (at_a + slope_a * (at - a)).min(at_b + slope_b * (at - b));
        if bound >= below {
            return None;
        }
        if at_a.min(at_b) - bound < LEAST_KNOWN_M {
            break;
        }
        // Where the tangents meet for a kink, where the slope is zero for a smooth minimum.
        let next = if step % 2 == 0 {
            at
        } else {
            a - slope_a * (b - a) / (slope_b - slope_a)
        };
        if next <= a || next >= b || !meter.take(LEAST_STEP) {
            break;
        }
        let there = (next, function(next));
        if there.1.1 < 0.0 {
            low = there;
        } else {
            high = there;
        }
    }
    Some((bound, at))
}

/// What a flight keeps a margin from.
pub trait Obstruction {
    /// The identifier of the obstacle, if it is one.
    fn obstacle(&self) -> Option<u32>;

    /// Least margin of a point in straight motion, and its time, if it is below `below_m`; minus infinity if a meter refuses
    /// the look.
    fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)>;

    /// Whether that is below `below_m`.
    #[inline]
    fn is_near(&self, line: &Line, below_m: f64, meter: &Meter) -> bool {
        self.least_on_line(line, below_m, meter).is_some()
    }
}

impl Obstruction for Hazard {
    #[inline]
    fn obstacle(&self) -> Option<u32> {
        Some(self.id)
    }

    #[inline]
    fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        self.extent.least_on_line(line, below_m, meter)
    }
}

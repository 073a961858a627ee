//! The obstacles for the certificate, one by one and four at a time.

use glam::{BVec4, DVec4};

use super::zones::Zones;
use crate::Vec3;
use crate::list::List;
use crate::meter::{LEAST_STEP, LOOK, Meter};
use crate::situation::{Obstacle, ProtectedVolume};

/// Most hazards of a [`Hazards`].
pub const MAX_HAZARDS: usize = 128;

/// Hazards of a block.
const LANES: usize = 4;

/// Fewer hazards than this are quicker one by one than in a block.
const FEW: usize = 3;

/// Most steps to the least margin of a cylinder on a line; six are usual.
const MOST_STEPS: u32 = 40;

/// Accuracy of a cylinder's least margin on a line, metres.
const LEAST_KNOWN_M: f64 = 1e-9;

/// An obstacle for the certificate: a volume that moves straight and grows, for a time.
///
/// A curved motion is several of these, one after the other, each valid only within its own window of
/// time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hazard {
    /// Index in the caller's list of hazards.
    pub index: u32,
    /// The obstacle's identifier.
    pub id: u32,
    /// Centre at time 0, metres, air-mass frame; where the window begins later, extended backwards.
    pub position_m: Vec3,
    /// Velocity in the air mass, metres per second.
    pub velocity_mps: Vec3,
    /// The volume at time 0, uncertainty included.
    pub volume: ProtectedVolume,
    /// Outward speed of its surface as the prediction ages, metres per second.
    pub growth_mps: f64,
    /// Stretch of the volume upwards and downwards, metres: at time 0, and the increase per
    /// second; never negative within the window.
    pub stretch_m: (f64, f64),
    /// Its window of time: from and until, seconds from the decision.
    pub window_s: (f64, f64),
    /// How deep a flight may come into a cylinder, metres, or [`NO_DEPTH`]: the margin is this less the depth, or plus
    /// the distance outside. The depth is s·w·f/(w + f), with the distances to wall and face as shares w and f of radius
    /// and half height, and s the smaller of the two: at one height it grows towards the axis.
    pub allowed_depth_m: f64,
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
    /// From one place to another one in a second.
    pub fn between(from_m: Vec3, to_m: Vec3) -> Self {
        Self {
            from_m,
            velocity_mps: to_m - from_m,
            at_s: 0.0,
            duration_s: 1.0,
        }
    }

    /// At a place.
    pub fn at(place_m: Vec3) -> Self {
        Self::between(place_m, place_m)
    }
}

impl Hazard {
    /// Zeros, which are written without a copy.
    const NONE: Self = Self {
        window_s: (0.0, 0.0),
        allowed_depth_m: 0.0,
        ..Self::exact(
            0,
            Vec3::ZERO,
            Vec3::ZERO,
            ProtectedVolume::Sphere { radius_m: 0.0 },
        )
    };

    /// The obstacle in an air mass that moves with `wind_mps`, its volume widened by `sigmas`
    /// standard deviations of position now and of velocity over time.
    pub fn new(index: u32, obstacle: &Obstacle, wind_mps: Vec3, sigmas: f64) -> Self {
        let uncertainty = obstacle.uncertainty;
        let volume = obstacle.volume.grown(sigmas * uncertainty.position_m);
        let velocity_mps = obstacle.velocity_mps - wind_mps;
        Self {
            index,
            growth_mps: sigmas * uncertainty.velocity_mps,
            ..Self::exact(obstacle.id, obstacle.position_m, velocity_mps, volume)
        }
    }

    /// A hazard known exactly, by its motion in the air mass.
    pub const fn exact(
        id: u32,
        position_m: Vec3,
        velocity_mps: Vec3,
        volume: ProtectedVolume,
    ) -> Self {
        Self {
            index: 0,
            id,
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

    /// Whether every number is finite and no length is negative.
    pub fn is_valid(&self) -> bool {
        let length_ok = |length: f64| length.is_finite() && length >= 0.0;
        self.position_m.is_finite()
            && self.velocity_mps.is_finite()
            && self.growth_mps.is_finite()
            && length_ok(self.volume.radius_m())
            && length_ok(self.volume.half_height_m())
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

    /// The part of a line that lies in the hazard's window.
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

    /// Least margin of a point in straight motion, and its time, if it is below `below_m`; minus infinity if a meter refuses
    /// the look.
    #[inline]
    pub fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        if self.window_s == ALWAYS {
            self.least_within(line, below_m, meter)
        } else {
            self.least_within(&self.within_window(line)?, below_m, meter)
        }
    }

    /// The same on a line within the hazard's window.
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
        let aside = libm::sqrt(offset.x * offset.x + offset.y * offset.y);
        let departs = if aside > 0.0 {
            (offset.x * velocity.x + offset.y * velocity.y) / aside
        } else {
            0.0
        };
        let (wall, face, room) = match self.volume {
            ProtectedVolume::Sphere { radius_m } => (aside, height, radius_m),
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            } => (aside - radius_m, height - half_height_m, 0.0),
        };
        let is_sphere = !self.is_cylinder();
        let (margin, slope) = if is_sphere || (wall > 0.0 && face > 0.0) {
            let distance = libm::sqrt(wall * wall + face * face);
            let slope = (wall * departs + face * rise) / distance.max(f64::MIN_POSITIVE);
            (distance - room, slope)
        } else if self.allowed_depth_m >= 0.0 && wall < 0.0 && face < 0.0 {
            let (radius_m, half_m) = (self.volume.radius_m(), self.volume.half_height_m());
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
    let when = foot_s + beyond_s;
    if when > duration_s {
        duration_s
    } else if when > 0.0 {
        when
    } else {
        0.0
    }
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
    /// Its index in the caller's list.
    fn index(&self) -> u32;

    /// Least margin of a point in straight motion, and its time, if it is below `below_m`; minus infinity if a meter refuses
    /// the look.
    fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)>;
}

impl Obstruction for Hazard {
    #[inline]
    fn index(&self) -> u32 {
        self.index
    }

    #[inline]
    fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        Self::least_on_line(self, line, below_m, meter)
    }
}

/// Hazards, and which of them a line may come close to.
pub trait HazardSet {
    /// One of them.
    type Each: Obstruction;

    /// Shows each hazard whose margin on `line` may be below `below_m`, metres, and perhaps others,
    /// until `visit` returns false. Returns whether none did, and the meter did not refuse it.
    fn each_close(
        &self,
        line: &Line,
        below_m: f64,
        meter: &Meter,
        visit: impl FnMut(&Self::Each) -> bool,
    ) -> bool;

    /// The zones beside them.
    fn zones(&self) -> Option<&Zones> {
        None
    }
}

impl HazardSet for [Hazard] {
    type Each = Hazard;

    fn each_close(
        &self,
        _: &Line,
        _: f64,
        meter: &Meter,
        visit: impl FnMut(&Hazard) -> bool,
    ) -> bool {
        meter.take(self.len().div_ceil(2)) && self.iter().all(visit)
    }
}

/// Four hazards side by side, as spheres about their volumes.
///
/// Three coordinates of four hazards each, so that the arithmetic becomes vector instructions.
#[derive(Debug, Clone, Copy)]
struct Block {
    position_m: [[f64; LANES]; 3],
    velocity_mps: [[f64; LANES]; 3],
    radius_m: [f64; LANES],
    /// Growth and stretch together.
    growth_mps: [f64; LANES],
    from_s: [f64; LANES],
    until_s: [f64; LANES],
}

impl Block {
    const NONE: Self = Self {
        position_m: [[0.0; LANES]; 3],
        velocity_mps: [[0.0; LANES]; 3],
        radius_m: [0.0; LANES],
        growth_mps: [0.0; LANES],
        from_s: [0.0; LANES],
        until_s: [0.0; LANES],
    };

    /// Marks the ones of the four that may have a margin below `below_m` on the line: the first part of
    /// [`Hazard::least_on_line`].
    #[inline]
    fn close(&self, line: &Line, below_m: f64) -> BVec4 {
        let [px, py, pz] = self.position_m.map(DVec4::from_array);
        let [vx, vy, vz] = self.velocity_mps.map(DVec4::from_array);
        let (from, speed) = (line.from_m, line.velocity_mps);
        let dx = DVec4::splat(from.x) - (px + vx * line.at_s);
        let dy = DVec4::splat(from.y) - (py + vy * line.at_s);
        let dz = DVec4::splat(from.z) - (pz + vz * line.at_s);
        let wx = DVec4::splat(speed.x) - vx;
        let wy = DVec4::splat(speed.y) - vy;
        let wz = DVec4::splat(speed.z) - vz;
        let square = wx * wx + wy * wy + wz * wz;
        let along = dx * wx + dy * wy + dz * wz;
        // Without relative motion 0/0 is no number; `max` then gives its other argument.
        let nearest_s = (-along / square)
            .max(DVec4::ZERO)
            .min(DVec4::splat(line.duration_s));
        let nx = dx + wx * nearest_s;
        let ny = dy + wy * nearest_s;
        let nz = dz + wz * nearest_s;
        let growth = DVec4::from_array(self.growth_mps) * (line.at_s + line.duration_s);
        let radius = DVec4::from_array(self.radius_m);
        let reach = (radius + growth + DVec4::splat(below_m)).max(DVec4::ZERO);
        let near = (nx * nx + ny * ny + nz * nz).cmplt(reach * reach);
        if !near.any() {
            return near;
        }
        let begun = DVec4::from_array(self.from_s).cmple(DVec4::splat(line.at_s + line.duration_s));
        let lasts = DVec4::from_array(self.until_s).cmpge(DVec4::splat(line.at_s));
        near & begun & lasts
    }

    fn put(&mut self, lane: usize, hazard: &Hazard) {
        let Self {
            position_m: [px, py, pz],
            velocity_mps: [vx, vy, vz],
            radius_m,
            growth_mps,
            from_s,
            until_s,
        } = self;
        let (position, velocity) = (hazard.position_m, hazard.velocity_mps);
        let values = [
            (px, position.x),
            (py, position.y),
            (pz, position.z),
            (vx, velocity.x),
            (vy, velocity.y),
            (vz, velocity.z),
            (
                radius_m,
                hazard.volume.bounding_radius_m() + hazard.stretch_m.0,
            ),
            (growth_mps, hazard.growth_mps + hazard.stretch_m.1),
            (from_s, hazard.window_s.0),
            (until_s, hazard.window_s.1),
        ];
        for (lanes, value) in values {
            if let Some(slot) = lanes.get_mut(lane) {
                *slot = value;
            }
        }
    }
}

/// Hazards one by one.
pub type Rows = List<Hazard, MAX_HAZARDS>;

/// A set of hazards of fixed capacity; it finds those near a line in blocks of four.
#[derive(Debug, Clone)]
pub struct Hazards {
    rows: Rows,
    blocks: [Block; MAX_HAZARDS / LANES],
    /// The zones, which are no rows: certificates of flights count these too.
    pub zones: Zones,
}

impl Default for Hazards {
    fn default() -> Self {
        Self::new()
    }
}

impl Hazards {
    /// No hazards.
    pub const fn new() -> Self {
        Self {
            rows: Rows::new(Hazard::NONE),
            blocks: [Block::NONE; MAX_HAZARDS / LANES],
            zones: Zones::NONE,
        }
    }

    /// Forgets all hazards that are rows.
    pub const fn clear(&mut self) {
        self.rows.clear();
    }

    /// The hazards one by one.
    #[inline]
    pub fn rows(&self) -> &[Hazard] {
        &self.rows
    }

    /// Number of blocks of four in use.
    #[inline]
    pub(crate) fn block_count(&self) -> usize {
        self.rows.len().div_ceil(LANES)
    }

    /// Puts a hazard at an index: replaces one, or appends behind the last one. False for any other
    /// index.
    pub fn put(&mut self, place: usize, hazard: Hazard) -> bool {
        let block = self.blocks.get_mut(place / LANES);
        let fits = self.rows.put(place, hazard);
        if let Some(block) = block.filter(|_| fits) {
            block.put(place % LANES, &hazard);
        }
        fits
    }
}

impl HazardSet for Hazards {
    type Each = Hazard;

    #[inline]
    fn each_close(
        &self,
        line: &Line,
        below_m: f64,
        meter: &Meter,
        mut visit: impl FnMut(&Hazard) -> bool,
    ) -> bool {
        if !meter.take(self.block_count().max(1)) {
            return false;
        }
        if self.rows.len() <= FEW {
            return self.rows().iter().all(visit);
        }
        let rows = self.rows().chunks(LANES);
        for (block, rows) in self.blocks.iter().zip(rows) {
            let close = block.close(line, below_m);
            if !close.any() {
                continue;
            }
            for (row, close) in rows.iter().zip(<[bool; LANES]>::from(close)) {
                if close && !visit(row) {
                    return false;
                }
            }
        }
        true
    }

    fn zones(&self) -> Option<&Zones> {
        (!self.zones.is_empty()).then_some(&self.zones)
    }
}

//! The obstacles for the certificate, together: which of them a line may come close to.

use glam::{BVec4, DVec4};

use super::hazard::{Hazard, Line, Obstruction};
use super::zones::{Fixed, Zones};
use crate::ground::Ground;
use crate::list::List;
use crate::meter::Meter;

/// Most hazards of a [`Hazards`].
pub const MAX_HAZARDS: usize = 128;

/// Hazards of a block.
const LANES: usize = 4;

/// Fewer hazards than this are quicker one by one than in a block.
const FEW: usize = 3;

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

    /// What is fixed over the ground beside them.
    fn fixed(&self) -> Option<Fixed<'_>> {
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

impl HazardSet for Fixed<'_> {
    type Each = Self;

    #[inline]
    fn each_close(
        &self,
        _: &Line,
        _: f64,
        _: &Meter,
        mut visit: impl FnMut(&Self) -> bool,
    ) -> bool {
        self.is_empty() || visit(self)
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

    /// The hazards and the ground below.
    pub const fn over<'a>(&'a self, ground: Option<&'a Ground<'a>>) -> Around<'a> {
        let hazards = self;
        Around { hazards, ground }
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

/// Hazards, and the ground below.
#[derive(Debug, Clone, Copy)]
pub struct Around<'a> {
    pub(super) hazards: &'a Hazards,
    ground: Option<&'a Ground<'a>>,
}

impl<'a> Around<'a> {
    /// What is fixed over the ground.
    pub const fn all_fixed(&self) -> Fixed<'a> {
        let (zones, ground) = (&self.hazards.zones, self.ground);
        Fixed { zones, ground }
    }
}

impl HazardSet for Around<'_> {
    type Each = Hazard;

    #[inline]
    fn each_close(
        &self,
        line: &Line,
        below_m: f64,
        meter: &Meter,
        mut visit: impl FnMut(&Hazard) -> bool,
    ) -> bool {
        if !meter.take(self.hazards.rows.len().div_ceil(LANES).max(1)) {
            return false;
        }
        if self.hazards.rows.len() <= FEW {
            return self.hazards.rows().iter().all(visit);
        }
        let rows = self.hazards.rows().chunks(LANES);
        for (block, rows) in self.hazards.blocks.iter().zip(rows) {
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

    fn fixed(&self) -> Option<Fixed<'_>> {
        Some(self.all_fixed())
    }
}

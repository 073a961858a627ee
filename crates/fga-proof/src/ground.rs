//! The ground: a grid of heights, and how high a line is above what it takes to clear them.
//!
//! Between four posts the ground is bilinear. A flight clears it by a margin if everything within that margin of it, to each side, up
//! and down, is higher than the ground, its vertical error and the clearance. Within a square that moves straight, the highest ground
//! is at a post, where a side meets a line of posts, or at a corner. While no side crosses a line of posts, these heights change
//! evenly, but for those below the corners, whose bend is known: what is above them at both ends is, but for that, above them between.

use crate::certificate::Line;
use crate::limit::SettingsError;
use crate::meter::{GROUND, Meter};
use crate::{Vec2, Vec3};

/// Blocks of peaks have this many smaller ones a side, and a look at a box takes this many a side at most.
const SIDE: usize = 4;

/// Heights are this uncertain by rounding, metres.
const ROUNDED_M: f64 = 1e-6;

/// A line over unknown ground is this far below what it takes, metres: barely, so that it is no worse than any volume.
const UNKNOWN_M: f64 = -ROUNDED_M;

/// The ground's bend within a piece of a line may be left at this, metres.
const BEND_M: f64 = 1e-3;

/// How deep a line comes is known to this, metres.
const DEPTH_M: f64 = 0.1;

/// A margin is known to one part in this many, or to a centimetre.
const MARGIN_PARTS: f64 = 64.0;
const MARGIN_M: f64 = 0.01;

/// Two moments, seconds, or places, cells, that are so near are one.
const MET: f64 = 1e-9;

/// Most looks along a line: one that is not decided then does not clear the ground.
const MOST_LOOKS: u32 = 10_000;

/// Heights of the ground on a regular grid, with a hierarchy of the largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground<'a> {
    corner_m: Vec2,
    spacing_m: Vec2,
    columns: usize,
    heights_m: &'a [f32],
    peaks_m: &'a [f32],
    needed_m: f64,
}

/// What binds of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Binding {
    /// It counts as so much lower than it is, metres.
    pub lowered_m: f64,
    /// Whether unknown ground is not to be flown over.
    pub unknown: bool,
}

impl Binding {
    /// Everything.
    pub const ALL: Self = Self {
        lowered_m: 0.0,
        unknown: true,
    };
}

/// The largest of some heights, not a number if one of them is unknown.
fn largest(heights_m: impl Iterator<Item = f32>) -> f32 {
    heights_m.fold(f32::NEG_INFINITY, |most, each| {
        let is_known = each.is_finite() && !most.is_nan();
        if is_known { most.max(each) } else { f32::NAN }
    })
}

/// Numbers of blocks, one level of peaks after the other, of a grid of cells.
fn levels(mut cells: (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
    core::iter::from_fn(move || {
        let is_more = cells.0.max(cells.1) > SIDE;
        cells = (cells.0.div_ceil(SIDE), cells.1.div_ceil(SIDE));
        is_more.then_some(cells)
    })
}

/// Posts a side as cells a side.
const fn cells(columns: usize, posts: usize) -> (usize, usize) {
    let rows = match posts.checked_div(columns) {
        Some(rows) => rows,
        None => 0,
    };
    (columns.saturating_sub(1), rows.saturating_sub(1))
}

impl<'a> Ground<'a> {
    /// The number of peaks of a grid of so many posts in all and a row.
    pub fn peak_count(columns: usize, posts: usize) -> usize {
        levels(cells(columns, posts))
            .map(|(wide, high)| wide * high)
            .sum()
    }

    /// Fills in the peaks of heights row by row, so many a row: the largest of each four times four cells, of each four times four of
    /// these, and so on.
    pub fn fill_peaks(columns: usize, heights_m: &[f32], peaks_m: &mut [f32]) {
        let cells = cells(columns, heights_m.len());
        let (mut done, mut below) = (0, cells);
        for (level, (wide, high)) in levels(cells).enumerate() {
            let (known_m, rest_m) = peaks_m.split_at_mut(done.min(peaks_m.len()));
            // The posts at its edges belong to a block of cells.
            let edge = usize::from(level == 0);
            let (lower_m, stride) = if level == 0 {
                (heights_m, columns)
            } else {
                let first = known_m.len().saturating_sub(below.0 * below.1);
                (known_m.get(first..).unwrap_or(&[]), below.0)
            };
            for (place, slot) in rest_m.iter_mut().take(wide * high).enumerate() {
                let (column, row) = (SIDE * (place % wide), SIDE * (place / wide));
                let last = |first: usize, count: usize| (first + SIDE).min(count) + edge;
                let columns = column..last(column, below.0);
                *slot = largest((row..last(row, below.1)).flat_map(|row| {
                    let of_row = row * stride..;
                    let of_row = lower_m.get(of_row).unwrap_or(&[]).iter().copied();
                    of_row.take(columns.end).skip(columns.start)
                }));
            }
            (done, below) = (done + wide * high, (wide, high));
        }
    }

    /// The ground over a grid: its south-west post and the spacing east and north, metres; the number of posts a row; the heights row by
    /// row from the south, in each row from the west, metres, not a number where unknown; their [peaks](Self::fill_peaks); the vertical
    /// error of the heights and the clearance that is asked for, metres.
    ///
    /// # Errors
    /// A number that is not finite, or a slice that is too short.
    pub fn new(
        (corner_m, spacing_m): (Vec2, Vec2),
        columns: usize,
        (heights_m, peaks_m): (&'a [f32], &'a [f32]),
        (error_m, clearance_m): (f64, f64),
    ) -> Result<Self, SettingsError> {
        let (wide, high) = cells(columns, heights_m.len());
        let is_sized = spacing_m.is_finite() && spacing_m.min_element() > 0.0;
        let asked = [
            (corner_m.is_finite(), "corner_m", corner_m.x, "a number"),
            (is_sized, "spacing_m", spacing_m.x, "above 0"),
            (wide > 0 && high > 0, "posts", columns as f64, "two a side"),
            (
                peaks_m.len() == Self::peak_count(columns, heights_m.len()),
                "peaks",
                peaks_m.len() as f64,
                "as many as peak_count says",
            ),
            (error_m >= 0.0, "error_m", error_m, "0 or above"),
            (clearance_m >= 0.0, "clearance_m", clearance_m, "0 or above"),
        ];
        for (is_right, name, value, expected) in asked {
            SettingsError::unless(is_right, name, value, expected)?;
        }
        Ok(Self {
            corner_m,
            spacing_m,
            columns,
            heights_m,
            peaks_m,
            needed_m: error_m + clearance_m + ROUNDED_M,
        })
    }

    /// The heights at the corners of a cell, metres: south-west, south-east, north-west, north-east. `None` if one is unknown.
    fn posts_m(&self, column: usize, row: usize) -> Option<[f64; 4]> {
        let first = row * self.columns + column;
        let south = self.heights_m.get(first..first + 2)?;
        let first = first + self.columns;
        let north = self.heights_m.get(first..first + 2)?;
        let [[a, b], [c, d]] = [south.try_into().ok()?, north.try_into().ok()?];
        let posts_m = [a, b, c, d].map(f64::from);
        (posts_m.iter().all(|post_m| post_m.is_finite())).then_some(posts_m)
    }

    /// A place in cells from the south-west post.
    fn in_cells(&self, at_m: Vec2) -> Vec2 {
        (at_m - self.corner_m) / self.spacing_m
    }

    /// The cell of a place in cells, kept within the grid.
    fn cell(&self, at: Vec2) -> (usize, usize) {
        let (wide, high) = cells(self.columns, self.heights_m.len());
        (index(at.x, wide), index(at.y, high))
    }

    /// The height, metres, of the highest known ground of a box; infinite where blocks of which something is unknown are not looked
    /// into; and whether all of it is known.
    fn peak_m(&self, low_m: Vec2, high_m: Vec2) -> (f64, bool) {
        let count = cells(self.columns, self.heights_m.len());
        let most = Vec2::new(count.0 as f64, count.1 as f64);
        let (low, high) = (self.in_cells(low_m), self.in_cells(high_m));
        let mut is_known = low.cmpge(Vec2::ZERO).all() && high.cmple(most).all();
        let mut peak_m = f64::NEG_INFINITY;
        if !(high.cmpge(Vec2::ZERO).all() && low.cmple(most).all()) {
            return (peak_m, false);
        }
        let (mut first, mut last) = (self.cell(low), self.cell(high));
        let (mut before, mut begin, mut stride) = (count, None, 0);
        for (wide, high) in levels(count) {
            if last.0 - first.0 < SIDE && last.1 - first.1 < SIDE {
                break;
            }
            begin = Some(begin.map_or(0, |begin| begin + before.0 * before.1));
            [first, last] = [first, last].map(|(x, y)| (x / SIDE, y / SIDE));
            (before, stride) = ((wide, high), wide);
        }
        for row in first.1..=last.1 {
            if let Some(begin) = begin {
                let of_row = begin + row * stride;
                let blocks_m = self.peaks_m.get(of_row + first.0..=of_row + last.0);
                for block_m in blocks_m.unwrap_or(&[f32::NAN]) {
                    is_known &= !block_m.is_nan();
                    let block_m = if block_m.is_nan() {
                        f32::INFINITY
                    } else {
                        *block_m
                    };
                    peak_m = peak_m.max(block_m.into());
                }
                continue;
            }
            for column in first.0..=last.0 {
                let Some([a, b, c, d]) = self.posts_m(column, row) else {
                    is_known = false;
                    continue;
                };
                // The part of the box within the cell.
                let corner = Vec2::new(column as f64, row as f64);
                let [low, high] = [low, high].map(|at| (at - corner).clamp(Vec2::ZERO, Vec2::ONE));
                for north in [low.y, high.y] {
                    let (west_m, east_m) = (a + (c - a) * north, b + (d - b) * north);
                    for east in [low.x, high.x] {
                        peak_m = peak_m.max(west_m + (east_m - west_m) * east);
                    }
                }
            }
        }
        (peak_m, is_known)
    }

    /// How high the lowest of a box, `beside_m` within all of its sides, is above what it takes to clear the ground, metres.
    fn above_m(&self, (from_m, to_m): (Vec3, Vec3), beside_m: f64, binding: Binding) -> f64 {
        // What begins at a line of posts counts on that line, whatever rounding says.
        let beside = Vec2::splat(beside_m + ROUNDED_M);
        let [low_m, high_m] = [from_m.min(to_m), from_m.max(to_m)];
        let (peak_m, is_known) = self.peak_m(low_m.truncate() - beside, high_m.truncate() + beside);
        let above_m = low_m.z - beside_m - (peak_m + self.needed_m - binding.lowered_m);
        if binding.unknown && !is_known {
            above_m.min(UNKNOWN_M)
        } else {
            above_m
        }
    }

    /// Until a side of a square crosses the next line of posts, seconds.
    fn crosses_s(&self, at_m: Vec2, beside_m: f64, velocity_mps: Vec2) -> f64 {
        let rates = velocity_mps / self.spacing_m;
        let sides = [-beside_m, beside_m].map(|aside_m| self.in_cells(at_m + aside_m));
        let next_s = |at: f64, rate: f64| {
            // One that is met counts as crossed.
            let ahead = if rate > 0.0 { at } else { -at };
            (libm::floor(ahead + MET) + 1.0 - ahead) / rate.abs()
        };
        sides.iter().fold(f64::INFINITY, |least_s, at| {
            least_s
                .min(next_s(at.x, rates.x))
                .min(next_s(at.y, rates.y))
        })
    }

    /// How much higher the ground below the corners of a square may be between two moments than its ends say, metres.
    fn bend_m(&self, middle_m: Vec2, beside_m: f64, way_m: Vec2) -> f64 {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let over = (way_m / self.spacing_m).element_product();
        corners.iter().fold(0.0, |most_m, (x, y)| {
            let (column, row) = self.cell(self.in_cells(middle_m + beside_m * Vec2::new(*x, *y)));
            let twist_m = self
                .posts_m(column, row)
                .map_or(0.0, |[a, b, c, d]| a - b - c + d);
            f64::max(most_m, -0.25 * twist_m * over)
        })
    }

    /// How far a line over the ground and all within a distance of it is above what it takes to clear the ground, metres, where that is
    /// least, and the moment, seconds after its start: 0 if it clears it; otherwise to a tenth of a metre, or anything below a stop.
    fn lowest(
        &self,
        line: &Line,
        (beside_m, stop_m): (f64, f64),
        binding: Binding,
        meter: &Meter,
    ) -> (f64, f64) {
        let at_m = |after_s| line.from_m + line.velocity_mps * after_s;
        let (mut from_s, mut step_s) = (0.0, line.duration_s);
        let mut least = (0.0, 0.0);
        for _ in 0..MOST_LOOKS {
            if !meter.take(GROUND) {
                break;
            }
            let to_s = f64::min(from_s + step_s, line.duration_s);
            step_s = to_s - from_s;
            let (from_m, to_m) = (at_m(from_s), at_m(to_s));
            let known_m = if least.0 < 0.0 { DEPTH_M } else { 0.0 };
            let whole_m = self.above_m((from_m, to_m), beside_m, binding);
            if whole_m < least.0 - known_m {
                let ends = [(from_m, from_s), (to_m, to_s)];
                let ends =
                    ends.map(|(at_m, at_s)| (self.above_m((at_m, at_m), beside_m, binding), at_s));
                let lower = if ends[0].0 <= ends[1].0 {
                    ends[0]
                } else {
                    ends[1]
                };
                if lower.0 < least.0 {
                    least = lower;
                }
                if least.0 < stop_m {
                    return least;
                }
                let velocity_mps = line.velocity_mps.truncate();
                let crosses_s = self.crosses_s(from_m.truncate(), beside_m, velocity_mps);
                let middle_m = from_m.midpoint(to_m).truncate();
                let bend_m = self.bend_m(middle_m, beside_m, velocity_mps * step_s);
                if step_s > crosses_s + MET {
                    step_s = crosses_s.max(0.5 * step_s);
                    continue;
                }
                let between_m = lower.0 - bend_m;
                if between_m < least.0 - known_m {
                    if bend_m > BEND_M.max(known_m) {
                        step_s *= 0.5;
                        continue;
                    }
                    least = (between_m, lower.1);
                }
            }
            if to_s >= line.duration_s {
                return (least.0 - known_m, least.1);
            }
            (from_s, step_s) = (to_s, 2.0 * step_s);
        }
        (f64::NEG_INFINITY, from_s)
    }

    /// The least margin of a line over the ground, metres, and its moment, seconds, if it is below one; negative, by its depth, if it
    /// comes lower than it takes to clear the ground. Minus infinity if the meter refuses work.
    pub fn least_on_line(
        &self,
        line: &Line,
        below_m: f64,
        binding: Binding,
        meter: &Meter,
    ) -> Option<(f64, f64)> {
        let clears = |margin_m| self.lowest(line, (margin_m, 0.0), binding, meter);
        let mut high_m = below_m.max(0.0);
        let (mut short_m, mut after_s) = clears(high_m);
        if short_m >= 0.0 {
            return None;
        }
        let mut margin_m = 0.0;
        if high_m == 0.0 || clears(0.0).0 < 0.0 {
            (margin_m, after_s) = self.lowest(line, (0.0, f64::NEG_INFINITY), binding, meter);
        } else {
            while high_m - margin_m > MARGIN_M.max(high_m / MARGIN_PARTS) {
                let middle_m = 0.5 * (margin_m + high_m);
                (short_m, _) = clears(middle_m);
                if short_m < 0.0 {
                    high_m = middle_m;
                } else {
                    margin_m = middle_m;
                }
            }
        }
        if meter.is_spent() {
            margin_m = f64::NEG_INFINITY;
        }
        (margin_m < below_m).then_some((margin_m, line.at_s + after_s))
    }
}

/// The number of a cell along an axis of so many.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "limited to the cells before the cast"
)]
fn index(at: f64, count: usize) -> usize {
    at.max(0.0).min(count.saturating_sub(1) as f64) as usize
}

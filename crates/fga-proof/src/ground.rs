//! The ground: a grid of heights, and how high a line is above what it takes to clear them.
//!
//! Between four posts the ground is bilinear.

use crate::limit::{LARGEST_M, SettingsError};
use crate::{Vec2, Vec3};

/// A block of the hierarchy has two to the power of this smaller ones a side, ...
const BITS: u32 = 2;

/// ... and a look takes as many a side at most.
const SIDE: usize = 1 << BITS;

/// Rounding makes heights and the edge of the ground uncertain by this, metres; unknown ground counts as too high by as much.
const ROUNDED_M: f64 = 1e-6;

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
    /// Whether unknown ground may be flown over.
    pub spares_unknown: bool,
}

impl Binding {
    /// Everything.
    pub const ALL: Self = Self {
        lowered_m: 0.0,
        spares_unknown: false,
    };
}

/// The number of cells in a row, and the number of rows of cells, from the number of posts in a row and in all.
fn cells(columns: usize, posts: usize) -> (usize, usize) {
    let rows = posts.checked_div(columns).unwrap_or(0);
    (columns.saturating_sub(1), rows.saturating_sub(1))
}

/// The levels of the hierarchy: the cells a side of a block, as a power of two, blocks a row, and rows of them.
fn levels((wide, high): (usize, usize)) -> impl Iterator<Item = (u32, usize, usize)> {
    let most = wide.max(high).saturating_sub(1);
    let all = core::iter::successors(Some(BITS), |bits| Some(bits + BITS));
    let all = all.take_while(move |bits| most.checked_shr(*bits).is_some_and(|left| left > 0));
    all.map(move |bits| {
        let [wide, high] = [wide, high].map(|count| (count.saturating_sub(1) >> bits) + 1);
        (bits, wide, high)
    })
}

impl<'a> Ground<'a> {
    /// The number of heights in the hierarchy, from the number of posts in a row and in all.
    pub fn peak_count(columns: usize, posts: usize) -> usize {
        let levels = levels(cells(columns, posts));
        levels.map(|(_, wide, high)| wide * high).sum()
    }

    /// Fills in the hierarchy of a grid with `columns` posts in a row: the largest height of each block of 4 x 4 cells, metres, then of each
    /// block of 16 x 16 cells, and so on. The heights are row by row.
    pub fn fill_peaks(columns: usize, heights_m: &[f32], peaks_m: &mut [f32]) {
        let levels = levels(cells(columns, heights_m.len()));
        let blocks = levels.flat_map(|(bits, wide, high)| {
            let rows = (0..high).map(move |row| row << bits);
            let of_row = move |row| (0..wide).map(move |column| (bits, column << bits, row));
            rows.flat_map(of_row)
        });
        for (slot, (bits, column, row)) in peaks_m.iter_mut().zip(blocks) {
            // The posts at its far edges belong to a block.
            let count = (1 << bits) + 1;
            let posts_m = (row..row + count).flat_map(|row| {
                let of_row = heights_m.get(row * columns..).unwrap_or(&[]).iter();
                of_row.take(columns).skip(column).take(count)
            });
            *slot = posts_m.fold(f32::NEG_INFINITY, |most_m, post_m| {
                let is_known = post_m.is_finite() && !most_m.is_nan();
                if is_known {
                    most_m.max(*post_m)
                } else {
                    f32::NAN
                }
            });
        }
    }

    /// The ground over a grid: its south-west post and the spacing east and north, metres; posts a row; heights row by row from the
    /// south, each from the west, metres, not a number where unknown, and their [hierarchy](Self::fill_peaks); the vertical error of the
    /// heights and the clearance that is asked for, metres.
    ///
    /// # Errors
    /// The first number that is not finite or out of range; slices of another length.
    pub fn new(
        (corner_m, spacing_m): (Vec2, Vec2),
        columns: usize,
        (heights_m, peaks_m): (&'a [f32], &'a [f32]),
        (error_m, clearance_m): (f64, f64),
    ) -> Result<Self, SettingsError> {
        let (wide, high) = cells(columns, heights_m.len());
        let is_sized = wide.min(high) > 0
            && heights_m.len().is_multiple_of(columns)
            && peaks_m.len() == Self::peak_count(columns, heights_m.len());
        let rows = "rows of 2 posts or more, two of them or more, and their hierarchy";
        SettingsError::unless(is_sized, "heights_m", heights_m.len() as f64, rows)?;
        let (far_m, least_m) = (corner_m.abs().max_element(), spacing_m.min_element());
        let is_near = (corner_m + spacing_m).is_finite();
        SettingsError::unless(is_near, "corner", far_m, "finite numbers")?;
        SettingsError::unless(least_m > 0.0, "spacing", least_m, "above 0")?;
        for (name, length_m) in [("error_m", error_m), ("clearance_m", clearance_m)] {
            let is_length = (0.0..=LARGEST_M).contains(&length_m);
            SettingsError::unless(is_length, name, length_m, "0 to 1e7")?;
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

    /// Its south-west post and the spacing, metres; posts a row; the heights; and how high above them it takes to clear it, metres.
    pub const fn posts(&self) -> ((Vec2, Vec2), usize, &'a [f32], f64) {
        let place = (self.corner_m, self.spacing_m);
        (place, self.columns, self.heights_m, self.needed_m)
    }

    /// The highest ground of a cell within a box in cells, metres; `None` where a post is unknown.
    fn of_cell_m(&self, (column, row): (usize, usize), (low, high): (Vec2, Vec2)) -> Option<f64> {
        let south = row * self.columns + column;
        let post_m = |place| {
            self.heights_m
                .get(place)
                .map_or(f64::NAN, |post_m| f64::from(*post_m))
        };
        let [a, b] = [south, south + 1].map(post_m);
        let [c, d] = [south, south + 1].map(|place| post_m(place + self.columns));
        let corner = Vec2::new(column as f64, row as f64);
        let [low, high] = [low, high].map(|at| (at - corner).max(Vec2::ZERO).min(Vec2::ONE));
        let along_m = |north: f64, east: f64| {
            let (west_m, east_m) = (a + (c - a) * north, b + (d - b) * north);
            west_m + (east_m - west_m) * east
        };
        let south_m = along_m(low.y, low.x).max(along_m(low.y, high.x));
        let most_m = south_m.max(along_m(high.y, low.x).max(along_m(high.y, high.x)));
        (a + b + c + d).is_finite().then_some(most_m)
    }

    /// The height of the highest known ground of a box, metres, and whether all of it is known; infinite if that is not known of a block.
    fn peak_m(&self, low_m: Vec2, high_m: Vec2) -> (f64, bool) {
        let count = cells(self.columns, self.heights_m.len());
        let [low, high] = [low_m, high_m].map(|at_m| (at_m - self.corner_m) / self.spacing_m);
        let most = Vec2::new(count.0 as f64, count.1 as f64);
        let mut is_known = low.min_element() >= 0.0 && high.cmple(most).all();
        let mut peak_m = f64::NEG_INFINITY;
        if !(high.min_element() >= 0.0 && low.cmple(most).all()) {
            return (peak_m, false);
        }
        let [first, last] = [low, high].map(|at| (index(at.x, count.0), index(at.y, count.1)));
        let (mut bits, mut wide, mut begin, mut next) = (0, 0, 0, 0);
        let span = |bits: u32| {
            let along = [(first.0, last.0), (first.1, last.1)];
            along.map(|(first, last)| first >> bits..=last >> bits)
        };
        for level in levels(count) {
            if span(bits)
                .iter()
                .all(|cells| cells.end() - cells.start() < SIDE)
            {
                break;
            }
            (bits, wide, begin) = (level.0, level.1, next);
            next += wide * level.2;
        }
        let [columns, rows] = span(bits);
        for row in rows {
            for column in columns.clone() {
                let most_m = if bits == 0 {
                    self.of_cell_m((column, row), (low, high))
                } else {
                    let block_m = self.peaks_m.get(begin + row * wide + column);
                    block_m
                        .copied()
                        .map(f64::from)
                        .filter(|block_m| block_m.is_finite())
                };
                match most_m {
                    Some(most_m) => peak_m = peak_m.max(most_m),
                    None if bits > 0 => return (f64::INFINITY, false),
                    None => is_known = false,
                }
            }
        }
        (peak_m, is_known)
    }

    /// How high the lowest place within a distance of a box is above what it takes to clear the ground, metres.
    pub(crate) fn above_m(
        &self,
        (from_m, to_m): (Vec3, Vec3),
        beside_m: f64,
        binding: Binding,
    ) -> f64 {
        let (low_m, high_m) = (from_m.min(to_m), from_m.max(to_m));
        let beside = Vec2::splat(beside_m + ROUNDED_M);
        let (peak_m, is_known) = self.peak_m(low_m.truncate() - beside, high_m.truncate() + beside);
        let above_m = low_m.z - beside_m - (peak_m + self.needed_m - binding.lowered_m);
        let is_barred = !(is_known || binding.spares_unknown);
        above_m.min(if is_barred { -ROUNDED_M } else { f64::INFINITY })
    }
}

/// The index of the cell at a place along an axis with `count` cells.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "limited to the cells before the cast"
)]
fn index(at: f64, count: usize) -> usize {
    at.max(0.0).min(count.saturating_sub(1) as f64) as usize
}

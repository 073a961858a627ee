//! One regular grid of heights.

use super::Area;
use crate::number::count;

/// Heights beyond this are no ground: the highest mountain has 8,849 m, metres.
const MOST_M: f64 = 9_000.0;
/// A place within this of a line of posts is on the line, share of the spacing.
pub(super) const ON_LINE: f64 = 1e-6;
/// A hole in whole metres, as SRTM writes it.
pub(super) const HOLE: i16 = i16::MIN;

/// Heights, metres. Whole heights take two bytes each, and a hole is [`HOLE`]; other heights take four, and a hole is not a number.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Heights {
    Whole(Vec<i16>),
    Single(Vec<f32>),
}

impl From<Vec<i16>> for Heights {
    fn from(heights: Vec<i16>) -> Self {
        Self::Whole(heights)
    }
}

impl From<Vec<f32>> for Heights {
    fn from(heights: Vec<f32>) -> Self {
        let is_whole =
            |height: &f32| height.is_nan() || (height.fract() == 0.0 && height.abs() < 32_767.0);
        if !heights.iter().all(is_whole) {
            return Self::Single(heights);
        }
        #[expect(clippy::cast_possible_truncation, reason = "whole and in range")]
        let whole = |height: f32| if height.is_nan() { HOLE } else { height as i16 };
        Self::Whole(heights.into_iter().map(whole).collect())
    }
}

impl Heights {
    const fn len(&self) -> usize {
        match self {
            Self::Whole(heights) => heights.len(),
            Self::Single(heights) => heights.len(),
        }
    }

    /// The height at an index; `None` for a hole.
    fn get(&self, index: usize) -> Option<f64> {
        match self {
            Self::Whole(heights) => {
                let height = heights.get(index).filter(|height| **height != HOLE);
                height.copied().map(f64::from)
            }
            Self::Single(heights) => {
                let height = heights.get(index).filter(|height| !height.is_nan());
                height.copied().map(f64::from)
            }
        }
    }

    /// All that are no holes.
    pub(super) fn known(&self) -> impl Iterator<Item = f64> + Clone {
        (0..self.len()).filter_map(|index| self.get(index))
    }
}

/// Where the posts of a field are: latitudes and longitudes, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightGrid {
    /// Latitude of the southernmost row.
    pub south_deg: f64,
    /// Longitude of the westernmost column, from −180 up to 180.
    pub west_deg: f64,
    /// From one row to the next.
    pub step_north_deg: f64,
    /// From one column to the next.
    pub step_east_deg: f64,
    /// Posts from south to north.
    pub rows: usize,
    /// Posts from west to east.
    pub columns: usize,
}

impl HeightGrid {
    /// The area between the outermost posts.
    pub fn area(&self) -> Area {
        Area {
            south_deg: self.south_deg,
            west_deg: self.west_deg,
            north_deg: self.latitude_deg(0),
            east_deg: self.longitude_deg(self.columns.saturating_sub(1)),
        }
    }

    /// Latitude of a row, the northernmost of which is row 0.
    pub fn latitude_deg(&self, row: usize) -> f64 {
        self.south_deg + self.rows.saturating_sub(row + 1) as f64 * self.step_north_deg
    }

    /// Longitude of a column, the westernmost of which is column 0.
    pub fn longitude_deg(&self, column: usize) -> f64 {
        self.west_deg + column as f64 * self.step_east_deg
    }

    /// How far a place is from the south-west post: steps north, steps east; `None` outside.
    pub(super) fn steps(&self, latitude_deg: f64, longitude_deg: f64) -> Option<[f64; 2]> {
        let within = |steps: f64, posts: usize| {
            let last = posts.saturating_sub(1) as f64;
            let nearest = libm::rint(steps);
            let steps = if (steps - nearest).abs() < ON_LINE {
                nearest
            } else {
                steps
            };
            (0.0..=last).contains(&steps).then_some(steps)
        };
        let mut east_deg = longitude_deg - self.west_deg;
        east_deg -= 360.0 * libm::floor(east_deg / 360.0);
        if east_deg > 360.0 - ON_LINE * self.step_east_deg {
            east_deg = 0.0;
        }
        Some([
            within(
                (latitude_deg - self.south_deg) / self.step_north_deg,
                self.rows,
            )?,
            within(east_deg / self.step_east_deg, self.columns)?,
        ])
    }

    fn check(&self) -> Result<(), String> {
        let area = self.area();
        let is_finite = area.north_deg.is_finite() && area.east_deg.is_finite();
        if !(is_finite && self.step_north_deg > 0.0 && self.step_east_deg > 0.0) {
            return Err(format!(
                "has the corner {}, {} and the spacing {} x {} degrees, expected a corner and a spacing above 0",
                self.south_deg, self.west_deg, self.step_north_deg, self.step_east_deg
            ));
        }
        if self.rows < 2 || self.columns < 2 {
            return Err(format!(
                "has {} x {} heights, expected at least 2 x 2",
                self.rows, self.columns
            ));
        }
        if area.south_deg <= -90.0 || area.north_deg >= 90.0 {
            return Err(format!(
                "reaches from latitude {} to {}, expected an area that reaches no pole",
                area.south_deg, area.north_deg
            ));
        }
        if !(-180.0..180.0).contains(&area.west_deg) || area.east_deg > 180.0 + 1e-9 {
            return Err(format!(
                "reaches from longitude {} to {}, expected an area from -180 to 180 that does not cross the antimeridian",
                area.west_deg, area.east_deg
            ));
        }
        Ok(())
    }
}

/// Heights of the ground on a regular grid of latitudes and longitudes; between four posts the ground is bilinear.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightField {
    grid: HeightGrid,
    /// Row by row from the north, in each row from the west.
    heights: Heights,
}

impl HeightField {
    /// A field of this grid; heights are in rows from the north. The message of an error lacks the file.
    pub(super) fn new(grid: HeightGrid, heights: impl Into<Heights>) -> Result<Self, String> {
        grid.check()?;
        let heights = heights.into();
        let count = heights.len();
        if count != grid.rows * grid.columns {
            return Err(format!(
                "holds {count} heights, expected {} x {}",
                grid.rows, grid.columns
            ));
        }
        let field = Self { grid, heights };
        let height_m = |index: usize| field.heights.get(index).unwrap_or_default();
        if let Some(index) = (0..count).find(|index| height_m(*index).abs() > MOST_M) {
            let (row, column) = (index / grid.columns, index % grid.columns);
            return Err(format!(
                "has the height {} m at latitude {:.4}, longitude {:.4}, expected {} to {MOST_M} m; is its byte order another?",
                height_m(index),
                grid.latitude_deg(row),
                grid.longitude_deg(column),
                -MOST_M
            ));
        }
        if field.is_swapped() {
            return Err(
                "has only multiples of 256 m as heights, expected heights in the byte order of the format".into(),
            );
        }
        Ok(field)
    }

    /// Whether all heights are multiples of 256 m, as low ground in the other byte order is.
    fn is_swapped(&self) -> bool {
        let mut land = self.heights.known().filter(|height_m| *height_m != 0.0);
        let first = land.next();
        first.is_some_and(|first| land.any(|height_m| height_m != first))
            && self.heights.known().all(|height_m| height_m % 256.0 == 0.0)
    }

    /// Where its posts are.
    pub const fn grid(&self) -> &HeightGrid {
        &self.grid
    }

    /// The height of a post, the northernmost row of which is row 0, metres; `None` for a hole and outside.
    pub fn post_m(&self, row: usize, column: usize) -> Option<f64> {
        if row >= self.grid.rows || column >= self.grid.columns {
            return None;
        }
        self.heights.get(row * self.grid.columns + column)
    }

    /// The bilinear height at a place, metres; `None` outside and beside a hole.
    pub fn height_m(&self, latitude_deg: f64, longitude_deg: f64) -> Option<f64> {
        let steps = self.grid.steps(latitude_deg, longitude_deg)?;
        self.cell(steps).height_m(steps)
    }

    /// The four posts around a place, given in steps from the south-west post.
    pub(super) fn cell(&self, [north, east]: [f64; 2]) -> GridCell {
        let (from_south, _) = before(north, self.grid.rows);
        let (column, _) = before(east, self.grid.columns);
        let south_row = self.grid.rows.saturating_sub(from_south + 1);
        let north_row = south_row.saturating_sub(1);
        GridCell {
            corner: [from_south as f64, column as f64],
            posts_m: [
                self.post_m(south_row, column),
                self.post_m(south_row, column + 1),
                self.post_m(north_row, column),
                self.post_m(north_row, column + 1),
            ],
        }
    }

    /// The least and the largest height of the cells that an area touches, metres; `None` where a part of the area is outside or
    /// beside a hole.
    pub fn range_m(&self, area: &Area) -> Option<[f64; 2]> {
        let [south, west] = self.grid.steps(area.south_deg, area.west_deg)?;
        let [north, east] = self.grid.steps(area.north_deg, area.east_deg)?;
        let mut range_m = [f64::INFINITY, f64::NEG_INFINITY];
        for row in touched(south, north, self.grid.rows) {
            for column in touched(west, east, self.grid.columns) {
                let height_m = self.post_m(self.grid.rows.saturating_sub(row + 1), column)?;
                range_m = [range_m[0].min(height_m), range_m[1].max(height_m)];
            }
        }
        (range_m[0] <= range_m[1]).then_some(range_m)
    }

    /// The least and the largest height, if any is known, metres, and the number of holes.
    pub fn summary(&self) -> (Option<[f64; 2]>, usize) {
        let known = self.heights.known();
        let holes = self.heights.len() - known.clone().count();
        let range_m = known.fold([f64::INFINITY, f64::NEG_INFINITY], |range_m, height_m| {
            [range_m[0].min(height_m), range_m[1].max(height_m)]
        });
        ((range_m[0] <= range_m[1]).then_some(range_m), holes)
    }

    /// The heights as they are stored.
    pub(super) const fn heights(&self) -> &Heights {
        &self.heights
    }
}

/// The post before a number of steps, behind which there is another one, and the share of the way to that.
pub(super) fn before(steps: f64, posts: usize) -> (usize, f64) {
    let low = count(steps).min(posts.saturating_sub(2));
    (low, steps - low as f64)
}

/// The posts of the cells from one number of steps to another.
fn touched(from: f64, to: f64, posts: usize) -> core::ops::RangeInclusive<usize> {
    let (first, last) = (count(from), count(libm::ceil(to)));
    first..=last.min(posts.saturating_sub(1))
}

/// Four posts and the bilinear ground between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridCell {
    /// Steps north and east of its south-west post.
    pub corner: [f64; 2],
    /// South-west, south-east, north-west, north-east, metres.
    posts_m: [Option<f64>; 4],
}

impl GridCell {
    /// Whether all four posts are known.
    pub(super) fn is_known(&self) -> bool {
        self.posts_m.iter().all(Option::is_some)
    }

    /// The height at a place, given in steps from the field's south-west post, metres; a post without weight may be a
    /// hole.
    pub(super) fn height_m(&self, steps: [f64; 2]) -> Option<f64> {
        let [north, east] = [steps[0] - self.corner[0], steps[1] - self.corner[1]];
        let weights = [
            (1.0 - north) * (1.0 - east),
            (1.0 - north) * east,
            north * (1.0 - east),
            north * east,
        ];
        let mut height_m = 0.0;
        for (post, weight) in self.posts_m.iter().zip(weights) {
            if weight != 0.0 {
                height_m += weight * (*post)?;
            }
        }
        Some(height_m)
    }
}

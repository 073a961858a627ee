//! Heights on a map's grid (UTM, national grids) as posts of latitudes and longitudes, nowhere below the file's.
//!
//! Definitions are those of EPSG. Shifts of old datums are Helmert's, true within about 5 m; a datum that needs a grid of shifts is refused.

use fga::Vec2;
use proj4rs::Proj;
use proj4rs::transform::transform;

use super::field::{HeightField, HeightGrid, before};
use super::file::MOST_BYTES;
use crate::number::{self, single};

/// Posts from one that is projected to the next; between them places are linear, which is within 1/200 of a step of 1 km.
const EXACT_POSTS: usize = 16;

/// A map's grid, as a pair of projections.
struct Map {
    map: Proj,
    earth: Proj,
}

impl Map {
    fn new(code: u16) -> Result<Self, String> {
        let name = format!("has the coordinates EPSG:{code}");
        let expected = "expected UTM, a national grid or degrees";
        let Some(found) = crs_definitions::from_code(code) else {
            return Err(format!("{name}, which is no known grid, {expected}"));
        };
        let words = found.proj4;
        let is_shifted = ["+towgs84=", "+nadgrids=@null", "+datum="]
            .iter()
            .any(|word| words.contains(word));
        // NAD27 needs a grid of shifts, and would be taken without one.
        if !is_shifted || words.contains("+datum=NAD27") {
            return Err(format!(
                "{name}, whose datum cannot be shifted to WGS84 without a grid of shifts, {expected}"
            ));
        }
        let known = |words: &str| {
            let found = Proj::from_proj_string(words);
            found.map_err(|error| format!("{name} ({error}), {expected}"))
        };
        let (map, earth) = (known(words)?, known("+proj=longlat +datum=WGS84")?);
        if map.is_latlong() || map.is_geocent() {
            return Err(format!("{name}, which is no map's grid, {expected}"));
        }
        Ok(Self { map, earth })
    }

    /// Longitude and latitude of a place of the map, degrees.
    fn degrees(&self, place: Vec2) -> Option<Vec2> {
        let mut place = (place.x, place.y, 0.0);
        transform(&self.map, &self.earth, &mut place).ok()?;
        Some(Vec2::new(place.0.to_degrees(), place.1.to_degrees()))
    }

    /// East and north of a longitude and latitude on the map.
    fn place(&self, degrees: Vec2) -> Option<Vec2> {
        let mut place = (degrees.x.to_radians(), degrees.y.to_radians(), 0.0);
        transform(&self.earth, &self.map, &mut place).ok()?;
        Some(Vec2::new(place.0, place.1))
    }
}

/// The field of heights on a grid of EPSG, from its first post's west and north and the steps between posts.
pub(super) fn field(
    code: u16,
    [west, north, east_step, north_step]: [f64; 4],
    size: [usize; 2],
    heights: &[f32],
) -> Result<HeightField, String> {
    if !(east_step > 0.0 && north_step > 0.0) || size.into_iter().any(|count| count < 2) {
        let [rows, columns] = size;
        return Err(format!(
            "has {rows} x {columns} heights with the spacing {east_step} x {north_step}, expected at least 2 x 2 and a spacing above 0"
        ));
    }
    let source = MapGrid {
        map: Map::new(code)?,
        first: Vec2::new(west, north),
        step: Vec2::new(east_step, -north_step),
        size,
        heights,
    };
    let beyond = || {
        format!(
            "has places outside of the grid EPSG:{code} or across the antimeridian, expected places within it"
        )
    };
    let grid = source.posts().ok_or_else(beyond)?;
    let mut posts = source.sampled(&grid);
    source.raise(&grid, &mut posts);
    HeightField::new(grid, posts)
}

/// Heights on a map's grid.
struct MapGrid<'a> {
    map: Map,
    /// East and north of the first post, and the steps to the next column and row.
    first: Vec2,
    step: Vec2,
    /// Rows and columns.
    size: [usize; 2],
    heights: &'a [f32],
}

impl MapGrid<'_> {
    fn at(&self, row: usize, column: usize) -> Vec2 {
        self.first + self.step * Vec2::new(column as f64, row as f64)
    }

    fn post_m(&self, row: usize, column: usize) -> f64 {
        let post_m = self.heights.get(row * self.size[1] + column);
        post_m.copied().map_or(f64::NAN, f64::from)
    }

    /// Posts of latitude and longitude over all of it, as far apart as in its middle; `None` beyond the map.
    fn posts(&self) -> Option<HeightGrid> {
        let [rows, columns] = self.size;
        let (last_row, last_column) = (rows - 1, columns - 1);
        let sides = (0..rows).flat_map(|row| [(row, 0), (row, last_column)]);
        let ends = (0..columns).flat_map(|column| [(0, column), (last_row, column)]);
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for (row, column) in sides.chain(ends) {
            let place = self.map.degrees(self.at(row, column))?;
            (low, high) = (low.min(place), high.max(place));
        }
        let middle = self.map.degrees(self.at(rows / 2, columns / 2))?;
        let level = Vec2::new(libm::cos(middle.y.to_radians()), 1.0);
        let apart = |row: usize, column: usize| {
            let next = self
                .map
                .degrees(self.at(rows / 2 + row, columns / 2 + column))?;
            Some((level * (next - middle)).length())
        };
        let step = Vec2::new(apart(0, 1)?, apart(1, 0)?) / level;
        let count = ((high - low) / step).ceil() + 1.0;
        // Also false for what is not a number.
        if !(4.0 * count.element_product() <= MOST_BYTES as f64 && count.min_element() >= 2.0) {
            return None;
        }
        Some(HeightGrid {
            south_deg: low.y,
            west_deg: low.x,
            step_north_deg: step.y,
            step_east_deg: step.x,
            rows: number::count(count.y),
            columns: number::count(count.x),
        })
    }

    /// The bilinear heights at new posts, metres; not a number outside and beside holes.
    fn sampled(&self, grid: &HeightGrid) -> Vec<f32> {
        let mut posts = vec![f32::NAN; grid.rows * grid.columns];
        for (row, line) in posts.chunks_mut(grid.columns).enumerate() {
            let latitude_deg = grid.latitude_deg(row);
            let place = |column: usize| {
                let longitude_deg = grid.longitude_deg(column);
                self.map.place(Vec2::new(longitude_deg, latitude_deg))
            };
            along(line.len(), place, |column, place| {
                let around = around((place - self.first) / self.step, self.size);
                if let (Some(around), Some(post)) = (around, line.get_mut(column)) {
                    let weighted = around.iter().filter(|(_, _, weight)| *weight > 0.0);
                    let heights_m =
                        weighted.map(|(row, column, weight)| weight * self.post_m(*row, *column));
                    *post = single(heights_m.sum());
                }
            });
        }
        posts
    }

    /// Raises new posts where the ground between them is below a post of the file.
    fn raise(&self, grid: &HeightGrid, posts: &mut [f32]) {
        let first = Vec2::new(grid.west_deg, grid.latitude_deg(0));
        let step = Vec2::new(grid.step_east_deg, -grid.step_north_deg);
        let index = |row: usize, column: usize| row * grid.columns + column;
        for row in 0..self.size[0] {
            let place = |column: usize| self.map.degrees(self.at(row, column));
            along(self.size[1], place, |column, place| {
                let Some(around) = around((place - first) / step, [grid.rows, grid.columns]) else {
                    return;
                };
                let new_m = around.iter().map(|(row, column, weight)| {
                    let post_m = posts.get(index(*row, *column));
                    weight * f64::from(post_m.copied().unwrap_or(f32::NAN))
                });
                let lacks_m = single(self.post_m(row, column) - new_m.sum::<f64>());
                if lacks_m > 0.0 {
                    for (row, column, _) in around {
                        if let Some(post) = posts.get_mut(index(row, column)) {
                            *post += lacks_m;
                        }
                    }
                }
            });
        }
    }
}

/// Calls `each` with the places of a row: each [`EXACT_POSTS`]th exact, those between them linear.
fn along(count: usize, place: impl Fn(usize) -> Option<Vec2>, mut each: impl FnMut(usize, Vec2)) {
    let mut first = 0;
    while first < count {
        let last = (first + EXACT_POSTS).min(count);
        if let (Some(from), Some(to)) = (place(first), place(last)) {
            for index in first..last {
                let share = (index - first) as f64 / (last - first) as f64;
                each(index, from.lerp(to, share));
            }
        }
        first = last;
    }
}

/// The four posts around a place in steps from the first one, with their weights; `None` outside.
fn around(steps: Vec2, [rows, columns]: [usize; 2]) -> Option<[(usize, usize, f64); 4]> {
    const ON_LINE: f64 = 1e-3;
    let within = |steps: f64, count: usize| {
        let last = count.saturating_sub(1) as f64;
        let inside = steps.clamp(0.0, last);
        // Not a number is not within either.
        let is_within = (steps - inside).abs() < ON_LINE;
        is_within.then(|| before(inside, count))
    };
    let ((row, down), (column, right)) = (within(steps.y, rows)?, within(steps.x, columns)?);
    Some([
        (row, column, (1.0 - down) * (1.0 - right)),
        (row, column + 1, (1.0 - down) * right),
        (row + 1, column, down * (1.0 - right)),
        (row + 1, column + 1, down * right),
    ])
}

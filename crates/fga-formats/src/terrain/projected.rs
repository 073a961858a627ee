//! Heights on a map's grid (UTM, national grids) as posts of latitudes and longitudes, nowhere below the file's.
//!
//! Definitions are those of EPSG. Shifts of old datums are Helmert's, true within about 5 m; a datum that needs a grid of shifts is refused.

use proj4rs::Proj;
use proj4rs::transform::transform;

use super::field::{HOLE, HeightField, HeightGrid, Heights};
use super::file::MOST_BYTES;

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
        // Without the first, the datum is unknown; the second lacks its grid of shifts.
        let is_shifted = ["+towgs84=", "+nadgrids=@null", "+datum="]
            .iter()
            .any(|word| words.contains(word));
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
    fn degrees(&self, [east, north]: [f64; 2]) -> Option<[f64; 2]> {
        let mut place = (east, north, 0.0);
        transform(&self.map, &self.earth, &mut place).ok()?;
        Some([place.0, place.1].map(f64::to_degrees))
    }

    /// East and north of a longitude and latitude on the map.
    fn place(&self, degrees: [f64; 2]) -> Option<[f64; 2]> {
        let [longitude, latitude] = degrees.map(f64::to_radians);
        let mut place = (longitude, latitude, 0.0);
        transform(&self.earth, &self.map, &mut place).ok()?;
        Some([place.0, place.1])
    }
}

/// The field of heights on a grid of EPSG, from its first post's west and north and the steps between posts.
pub(super) fn field(
    code: u16,
    [west, north, east_step, north_step]: [f64; 4],
    [rows, columns]: [usize; 2],
    heights: &Heights,
) -> Result<HeightField, String> {
    let map = Map::new(code)?;
    let at = |row: usize, column: usize| {
        [
            west + column as f64 * east_step,
            north - row as f64 * north_step,
        ]
    };
    let beyond = || {
        format!(
            "has places outside of the grid EPSG:{code} or across the antimeridian, expected places within it"
        )
    };
    if !(east_step > 0.0 && north_step > 0.0) {
        return Err(format!(
            "has the spacing {east_step} x {north_step}, expected one above 0"
        ));
    }
    if rows < 2 || columns < 2 {
        return Err(format!(
            "has {rows} x {columns} heights, expected at least 2 x 2"
        ));
    }
    let (last_row, last_column) = (rows - 1, columns - 1);
    let border = (0..rows)
        .flat_map(|row| [(row, 0), (row, last_column)])
        .chain((0..columns).flat_map(|column| [(0, column), (last_row, column)]));
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (row, column) in border {
        let place = map.degrees(at(row, column)).ok_or_else(beyond)?;
        for axis in 0..2 {
            low[axis] = low[axis].min(place[axis]);
            high[axis] = high[axis].max(place[axis]);
        }
    }
    // The steps in the middle.
    let [middle, east, top] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[right, up]| {
        let [x, y] = at(rows / 2, columns / 2);
        map.degrees([x + right * east_step, y + up * north_step])
    });
    let (middle, east, top) = (
        middle.ok_or_else(beyond)?,
        east.ok_or_else(beyond)?,
        top.ok_or_else(beyond)?,
    );
    let level = libm::cos(middle[1].to_radians());
    let apart = |to: [f64; 2]| libm::hypot(level * (to[0] - middle[0]), to[1] - middle[1]);
    let (step_east_deg, step_north_deg) = (apart(east) / level, apart(top));
    let count = |axis: usize, step: f64| libm::ceil((high[axis] - low[axis]) / step) + 1.0;
    let (wide, tall) = (count(0, step_east_deg), count(1, step_north_deg));
    // Also false for what is not a number.
    if !(wide * tall * 4.0 <= MOST_BYTES as f64 && wide >= 2.0 && tall >= 2.0) {
        return Err(beyond());
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 2 to the bytes of a file"
    )]
    let grid = HeightGrid {
        south_deg: low[1],
        west_deg: low[0],
        step_north_deg,
        step_east_deg,
        rows: tall as usize,
        columns: wide as usize,
    };
    let post_m = |row: usize, column: usize| match heights {
        Heights::Whole(all) => {
            let post_m = all
                .get(row * columns + column)
                .filter(|post| **post != HOLE);
            post_m.map_or(f64::NAN, |post_m| f64::from(*post_m))
        }
        Heights::Fraction(all) => {
            let post_m = all.get(row * columns + column);
            post_m.map_or(f64::NAN, |post_m| f64::from(*post_m))
        }
    };
    let mut posts = vec![f32::NAN; grid.rows * grid.columns];
    for (row, line) in posts.chunks_mut(grid.columns).enumerate() {
        let latitude_deg = grid.latitude_deg(row);
        let place = |column: usize| map.place([grid.longitude_deg(column), latitude_deg]);
        along(line.len(), place, |column, [x, y]| {
            let steps = [(north - y) / north_step, (x - west) / east_step];
            let around = around(steps, [rows, columns]);
            if let (Some(around), Some(post)) = (around, line.get_mut(column)) {
                let height_m = around
                    .iter()
                    .filter(|(_, _, weight)| *weight > 0.0)
                    .map(|(row, column, weight)| weight * post_m(*row, *column));
                *post = single(height_m.sum());
            }
        });
    }
    // Where the ground between the new posts is below a post of the file, they are raised.
    let north_deg = grid.latitude_deg(0);
    for row in 0..rows {
        let place = |column: usize| map.degrees(at(row, column));
        along(columns, place, |column, [x, y]| {
            let steps = [
                (north_deg - y) / step_north_deg,
                (x - grid.west_deg) / step_east_deg,
            ];
            let Some(around) = around(steps, [grid.rows, grid.columns]) else {
                return;
            };
            let index = |row: usize, column: usize| row * grid.columns + column;
            let new_m = around.iter().map(|(row, column, weight)| {
                let post_m = posts.get(index(*row, *column));
                weight * f64::from(post_m.copied().unwrap_or(f32::NAN))
            });
            let lacks_m = single(post_m(row, column) - new_m.sum::<f64>());
            if lacks_m > 0.0 {
                for (row, column, _) in around {
                    if let Some(post) = posts.get_mut(index(row, column)) {
                        *post += lacks_m;
                    }
                }
            }
        });
    }
    HeightField::new(grid, Heights::Fraction(posts))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a height beyond the range of f32 becomes infinite and is refused"
)]
const fn single(height_m: f64) -> f32 {
    height_m as f32
}

/// Calls `each` with the places of a row: each [`EXACT_POSTS`]th exact, those between them linear.
fn along(
    count: usize,
    place: impl Fn(usize) -> Option<[f64; 2]>,
    mut each: impl FnMut(usize, [f64; 2]),
) {
    let mut first = 0;
    while first < count {
        let last = (first + EXACT_POSTS).min(count);
        if let (Some(from), Some(to)) = (place(first), place(last)) {
            for index in first..last {
                let share = (index - first) as f64 / (last - first) as f64;
                let of = |axis: usize| from[axis] + share * (to[axis] - from[axis]);
                each(index, [of(0), of(1)]);
            }
        }
        first = last;
    }
}

/// The four posts around a place in steps from the first one, with their weights; `None` outside.
fn around(
    [down, right]: [f64; 2],
    [rows, columns]: [usize; 2],
) -> Option<[(usize, usize, f64); 4]> {
    const ON_LINE: f64 = 1e-3;
    let within = |steps: f64, count: usize| {
        let last = count.saturating_sub(1) as f64;
        let inside = steps.clamp(0.0, last);
        if !((steps - inside).abs() < ON_LINE) {
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the posts"
        )]
        let low = (libm::floor(inside) as usize).min(count.saturating_sub(2));
        Some((low, inside - low as f64))
    };
    let ((row, down), (column, right)) = (within(down, rows)?, within(right, columns)?);
    Some([
        (row, column, (1.0 - down) * (1.0 - right)),
        (row, column + 1, (1.0 - down) * right),
        (row + 1, column, down * (1.0 - right)),
        (row + 1, column + 1, down * right),
    ])
}

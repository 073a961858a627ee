//! Ground as a flight takes it: heights at posts of the local frame.

use fga::ground::Ground;
use fga::limit::SettingsError;
use fga::{Vec2, Vec3};

use super::field::before;
use super::{HeightField, Terrain};
use crate::geodesy::LocalFrame;
use crate::number::{self, single};

/// The ground is known this far beside the places of a flight, metres.
const BESIDE_M: f64 = 3_000.0;

/// Most posts: a square of 120 km with a post each 30 m.
const MOST_POSTS: f64 = 16e6;

/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_132.0;

/// Latitudes and longitudes are exact at places so far apart, metres.
const EXACT_M: f64 = 500.0;

/// A way is looked at each time it has gone as far as this, metres.
const LOOK_M: f64 = 0.25;

/// Ground by the heights of posts of the local frame, bilinear between them, with the height that a flight keeps above it.
///
/// The height above it is looked up with code of its own: it shares nothing with the certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalGround {
    /// The south-west post, and how far posts are apart.
    place_m: (Vec2, Vec2),
    columns: usize,
    heights_m: Vec<f32>,
    peaks_m: Vec<f32>,
    error_m: f64,
    clearance_m: f64,
}

impl LocalGround {
    /// Ground by the heights of posts, row by row from the south-west one on, each row from the west, metres, not a number where
    /// unknown; with the vertical error of the heights and the clearance that is asked for, metres.
    ///
    /// # Errors
    /// As [`Ground::new`].
    pub fn new(
        place_m: (Vec2, Vec2),
        columns: usize,
        heights_m: Vec<f32>,
        (error_m, clearance_m): (f64, f64),
    ) -> Result<Self, SettingsError> {
        let mut peaks_m = vec![0.0; Ground::peak_count(columns, heights_m.len())];
        Ground::fill_peaks(columns, &heights_m, &mut peaks_m);
        let slices = (heights_m.as_slice(), peaks_m.as_slice());
        let asked_m = (error_m, clearance_m);
        Ground::new(place_m, columns, slices, asked_m)?;
        Ok(Self {
            place_m,
            columns,
            heights_m,
            peaks_m,
            error_m,
            clearance_m,
        })
    }

    /// The ground of files around places of a frame, metres, with a clearance, metres. Its posts are as far apart as those of the files,
    /// and higher where the ground between them would be lower than that of the files.
    ///
    /// # Errors
    /// Heights above the ellipsoid, too large an area, or one that the files know nothing of; a sentence without its subject.
    pub fn around(
        terrain: &Terrain,
        frame: &LocalFrame,
        places_m: &[Vec3],
        clearance_m: f64,
    ) -> Result<Self, String> {
        terrain.sea_level()?;
        let places_m = places_m.iter().map(|place_m| place_m.truncate());
        let low_m = places_m.clone().fold(Vec2::INFINITY, Vec2::min) - BESIDE_M;
        let high_m = places_m.fold(Vec2::NEG_INFINITY, Vec2::max) + BESIDE_M;
        let (spacing_m, count) = terrain.posts(frame.origin().latitude_deg, high_m - low_m)?;
        let (columns, rows) = (number::count(count.x), number::count(count.y));
        let at = |column: f64, row: f64| low_m + spacing_m * Vec2::new(column, row);
        let places = Places::new(terrain, frame, low_m, at(count.x, count.y));
        let of_file = |at: Vec2| places.height_m(at);
        let heights_m: Vec<f32> = (0..columns * rows)
            .map(|index| at((index % columns) as f64, (index / columns) as f64))
            .map(|at| of_file(at).map_or(f32::NAN, single))
            .collect();
        if !heights_m.iter().any(|height_m| height_m.is_finite()) {
            return Err(
                "knows no ground within 3 km of the mission, expected a file of its area".into(),
            );
        }
        let place = (low_m, spacing_m);
        let own_height_m = |at_m| bilinear(place, columns, &heights_m, at_m);
        // Between the posts, where the two differ most.
        let mut raised = heights_m.clone();
        for index in 0..columns * rows {
            let (column, row) = ((index % columns) as f64, (index / columns) as f64);
            let [east, north] = [1, columns];
            for (beside, at) in [
                ([0, east].as_slice(), (0.5, 0.0)),
                (&[0, north], (0.0, 0.5)),
                (&[0, east, north, north + east], (0.5, 0.5)),
            ] {
                let at_m = low_m + spacing_m * Vec2::new(column + at.0, row + at.1);
                let Some((of_file_m, own_m)) = of_file(at_m).zip(own_height_m(at_m)) else {
                    continue;
                };
                let more_m = single(of_file_m - own_m);
                for post in beside.iter().map(|post| index + post) {
                    if let (Some(raised_m), Some(post_m)) =
                        (raised.get_mut(post), heights_m.get(post))
                    {
                        *raised_m = raised_m.max(post_m + more_m);
                    }
                }
            }
        }
        let errors = (terrain.vertical_error_m(), clearance_m);
        Self::new(place, columns, raised, errors).map_err(|error| error.to_string())
    }

    /// The ground as the core takes it.
    pub fn ground(&self) -> Option<Ground<'_>> {
        self.raised(0.0)
    }

    /// The ground for an aircraft whose own height is uncertain by so much more, metres.
    pub fn raised(&self, by_m: f64) -> Option<Ground<'_>> {
        let slices = (self.heights_m.as_slice(), self.peaks_m.as_slice());
        let errors = (self.error_m + by_m, self.clearance_m);
        Ground::new(self.place_m, self.columns, slices, errors).ok()
    }

    /// Its south-west post and the spacing, metres; posts a row; and the heights, metres, as [`LocalGround::new`] takes them.
    pub fn posts(&self) -> ((Vec2, Vec2), usize, &[f32]) {
        (self.place_m, self.columns, &self.heights_m)
    }

    /// A copy of what a situation lends; all that it takes to clear it counts as clearance.
    pub fn of(ground: &Ground<'_>) -> Option<Self> {
        let (place, columns, heights_m, needed_m) = ground.posts();
        Self::new(place, columns, heights_m.to_vec(), (0.0, needed_m)).ok()
    }

    /// Its vertical error, metres.
    pub const fn error_m(&self) -> f64 {
        self.error_m
    }

    /// The height above the ground that is asked for, metres, without the vertical error.
    pub const fn clearance_m(&self) -> f64 {
        self.clearance_m
    }

    /// The height of the ground at a place, metres; `None` where it is not known.
    pub fn height_m(&self, at: Vec2) -> Option<f64> {
        bilinear(self.place_m, self.columns, &self.heights_m, at)
    }

    /// The height of a place above the ground, metres; `None` where that is not known.
    pub fn above_m(&self, at_m: Vec3) -> Option<f64> {
        Some(at_m.z - self.height_m(at_m.truncate())?)
    }

    /// The least height of a straight way above known ground, metres, and whether all of the ground is known.
    pub fn along_m(&self, from_m: Vec3, to_m: Vec3) -> (f64, bool) {
        let (mut least_m, mut is_known) = (f64::INFINITY, true);
        let steps = libm::ceil(from_m.distance(to_m) / LOOK_M).max(1.0);
        let mut step = 0.0;
        while step <= steps {
            match self.above_m(from_m.lerp(to_m, step / steps)) {
                Some(above_m) => least_m = least_m.min(above_m),
                None => is_known = false,
            }
            step += 1.0;
        }
        (least_m, is_known)
    }
}

/// The height of the ground at a place by posts as [`LocalGround::new`] takes them, metres; `None` where it is not known.
fn bilinear(
    (corner_m, spacing_m): (Vec2, Vec2),
    columns: usize,
    heights_m: &[f32],
    at: Vec2,
) -> Option<f64> {
    let steps = (at - corner_m) / spacing_m;
    let rows = heights_m.len() / columns;
    let last = Vec2::new(columns as f64 - 1.0, rows as f64 - 1.0);
    if !(steps.cmpge(Vec2::ZERO).all() && steps.cmple(last).all()) {
        return None;
    }
    let ((column, east), (row, north)) = (before(steps.x, columns), before(steps.y, rows));
    let first = row * columns + column;
    let post_m = |index: usize| {
        let post_m = heights_m.get(index);
        post_m.map_or(f64::NAN, |post_m| f64::from(*post_m))
    };
    let row_m = |first: usize| (1.0 - east) * post_m(first) + east * post_m(first + 1);
    let height_m = (1.0 - north) * row_m(first) + north * row_m(first + columns);
    height_m.is_finite().then_some(height_m)
}

impl Terrain {
    /// How far apart the posts of [`LocalGround`] of a size, metres, are at a latitude, metres, and how many they are: each east and north.
    ///
    /// # Errors
    /// Too many; a sentence without its subject.
    pub fn posts(&self, latitude_deg: f64, size_m: Vec2) -> Result<(Vec2, Vec2), String> {
        let level = libm::cos(latitude_deg.to_radians());
        let spacing_m = self.fields().fold(Vec2::splat(BESIDE_M), |least_m, field| {
            let grid = field.grid();
            least_m.min(DEGREE_M * Vec2::new(grid.step_east_deg * level, grid.step_north_deg))
        });
        let count = (size_m / spacing_m).ceil() + 1.0;
        if count.element_product() > MOST_POSTS {
            return Err(format!(
                "has a height each {:.0} x {:.0} m, and {:.0} x {:.0} km are flown over: {:.0} million heights, expected at most {:.0}",
                spacing_m.x,
                spacing_m.y,
                1e-3 * size_m.x,
                1e-3 * size_m.y,
                1e-6 * count.element_product(),
                1e-6 * MOST_POSTS
            ));
        }
        Ok((spacing_m, count))
    }
}

/// Latitudes and longitudes of places of a frame: exact each half kilometre and linear between, which is within a centimetre up to a latitude of 60°.
/// Each exact one takes as long as looking up ten heights.
struct Places<'a> {
    /// What may know the ground there.
    fields: Vec<&'a HeightField>,
    low_m: Vec2,
    columns: usize,
    /// Latitudes and longitudes, degrees, row by row.
    exact: Vec<Vec2>,
    /// The altitude of the frame, metres.
    level_m: f64,
}

impl<'a> Places<'a> {
    fn new(terrain: &'a Terrain, frame: &LocalFrame, low_m: Vec2, high_m: Vec2) -> Self {
        let count = ((high_m - low_m) / EXACT_M).floor() + 2.0;
        let (columns, rows) = (number::count(count.x), number::count(count.y));
        let origin = frame.origin();
        let exact = (0..columns * rows).map(|index| {
            let steps = Vec2::new((index % columns) as f64, (index / columns) as f64);
            let place = frame.to_geodetic((low_m + EXACT_M * steps).extend(0.0));
            let east_deg = libm::remainder(place.longitude_deg - origin.longitude_deg, 360.0);
            Vec2::new(place.latitude_deg, origin.longitude_deg + east_deg)
        });
        let exact: Vec<Vec2> = exact.collect();
        let low = exact.iter().copied().fold(Vec2::INFINITY, Vec2::min);
        let high = exact.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max);
        let is_near = |field: &&HeightField| {
            let held = field.grid().area();
            let is_beside = |turn_deg: f64| {
                low.y <= held.east_deg + turn_deg && held.west_deg + turn_deg <= high.y
            };
            low.x <= held.north_deg
                && held.south_deg <= high.x
                && [-360.0, 0.0, 360.0].into_iter().any(is_beside)
        };
        Self {
            fields: terrain.fields().filter(is_near).collect(),
            low_m,
            columns,
            exact,
            level_m: origin.altitude_m,
        }
    }

    /// The height of the ground of files at a place, metres in the frame.
    fn height_m(&self, at_m: Vec2) -> Option<f64> {
        let steps = (at_m - self.low_m) / EXACT_M;
        let rows = self.exact.len() / self.columns;
        let ((column, east), (row, north)) = (before(steps.x, self.columns), before(steps.y, rows));
        let first = row * self.columns + column;
        let row = |index: usize| {
            let (west, other) = (self.exact.get(index)?, self.exact.get(index + 1)?);
            Some(west.lerp(*other, east))
        };
        let place = row(first)?.lerp(row(first + self.columns)?, north);
        let fields = self.fields.iter();
        let mut heights_m = fields.filter_map(|field| field.height_m(place.x, place.y));
        Some(heights_m.next()? - self.level_m)
    }
}

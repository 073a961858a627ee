//! Several files as one ground.

use std::path::PathBuf;

use super::field::{GridCell, HeightField, HeightGrid};
use super::{Area, Datum, Given, TerrainFile, reader};
use crate::error::InputError;
use crate::number::single;

/// Grids whose posts agree within this are one lattice, share of the spacing.
const ALIGNED: f64 = 1e-3;

/// Ground from files. Where several know a height, the first one counts.
///
/// Between the outermost posts of two neighbours that are one spacing apart, as tiles of Copernicus are, the ground is
/// bilinear too.
///
/// ```
/// use fga_formats::terrain::{Given, Terrain};
///
/// let error = Terrain::read(&["no/such.hgt".into()], &Given::default()).unwrap_err();
/// assert_eq!(error.to_string(), "no/such.hgt: cannot be read: there is no such file or folder");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    files: Vec<TerrainFile>,
    seams: Vec<HeightField>,
}

impl Terrain {
    /// Reads files of heights above one datum.
    ///
    /// # Errors
    /// As [`read`](super::read); no file; files above different datums.
    pub fn read(paths: &[PathBuf], given: &Given) -> Result<Self, InputError> {
        let files = paths.iter().map(|path| reader::read(path, given));
        Self::new(files.collect::<Result<_, _>>()?)
    }

    /// Ground from files that are read.
    ///
    /// # Errors
    /// No file; files above different datums.
    pub fn new(files: Vec<TerrainFile>) -> Result<Self, InputError> {
        let Some(first) = files.first() else {
            return Err(InputError::in_file(
                "terrain",
                "no file is given, expected at least one",
            ));
        };
        if let Some(other) = files
            .iter()
            .find(|file| file.datum.value != first.datum.value)
        {
            let message = format!(
                "has heights above {}, expected {} as in {}",
                other.datum.value.words(),
                first.datum.value.words(),
                first.path.display()
            );
            return Err(InputError::in_file(&other.path, message));
        }
        // The blocks of one file overlap.
        let alone = files.iter().filter_map(|file| match &file.fields[..] {
            [field] => Some(field),
            _ => None,
        });
        let fields: Vec<&HeightField> = alone.collect();
        let east = seams(&fields, true);
        let all: Vec<&HeightField> = fields.into_iter().chain(&east).collect();
        let north = seams(&all, false);
        let seams = [east, north].concat();
        Ok(Self { files, seams })
    }

    /// The files, in their order.
    pub fn files(&self) -> &[TerrainFile] {
        &self.files
    }

    /// The grids of the files, then those between neighbours.
    pub fn fields(&self) -> impl Iterator<Item = &HeightField> {
        let fields = self.files.iter().flat_map(|file| &file.fields);
        fields.chain(&self.seams)
    }

    /// What the heights are above.
    pub fn datum(&self) -> Datum {
        self.files
            .first()
            .map_or(Datum::Egm96, |file| file.datum.value)
    }

    /// Whether its heights are above the sea, as altitudes of missions are.
    ///
    /// # Errors
    /// Heights above the ellipsoid; a sentence without its subject.
    pub fn sea_level(&self) -> Result<(), String> {
        let datum = self.datum();
        if datum.is_sea_level() {
            return Ok(());
        }
        Err(format!(
            "has heights above {}, expected mean sea level, as altitudes of missions are",
            datum.words()
        ))
    }

    /// The largest vertical error of the files, metres.
    pub fn vertical_error_m(&self) -> f64 {
        let errors = self.files.iter().map(|file| file.vertical_error_m.value);
        errors.fold(0.0, f64::max)
    }

    /// The smallest area around all files.
    pub fn area(&self) -> Option<Area> {
        let areas = self.files.iter().filter_map(TerrainFile::area);
        areas.reduce(|all, area| all.with(&area))
    }

    /// The height of the ground at a place, metres above the datum; `None` where it is not known.
    pub fn height_m(&self, latitude_deg: f64, longitude_deg: f64) -> Option<f64> {
        self.fields()
            .find_map(|field| field.height_m(latitude_deg, longitude_deg))
    }

    /// The least and the largest height of the ground in an area, metres; at most one spacing outside of it. `None` where a part of the area
    /// is not known.
    pub fn range_m(&self, area: &Area) -> Option<[f64; 2]> {
        let mut missing = vec![*area];
        let mut range_m = [f64::INFINITY, f64::NEG_INFINITY];
        for field in self.fields() {
            let held = field.grid().area();
            let mut left = Vec::new();
            for part in missing {
                let Some(common) = common(&part, &held) else {
                    left.push(part);
                    continue;
                };
                let [least_m, largest_m] = field.range_m(&common)?;
                range_m = [range_m[0].min(least_m), range_m[1].max(largest_m)];
                left.extend(around(&part, &common));
            }
            missing = left;
            if missing.is_empty() {
                return Some(range_m);
            }
        }
        None
    }

    /// The first field whose four posts around a place are all known, the place in its steps, and these posts.
    pub(super) fn cell(
        &self,
        latitude_deg: f64,
        longitude_deg: f64,
    ) -> Option<(&HeightField, [f64; 2], GridCell)> {
        self.fields().find_map(|field| {
            let steps = field.grid().steps(latitude_deg, longitude_deg)?;
            let cell = field.cell(steps);
            cell.is_known().then_some((field, steps, cell))
        })
    }
}

/// Slivers below this are rounding, degrees.
const SLIVER_DEG: f64 = 1e-9;

/// The area that two areas have in common.
fn common(a: &Area, b: &Area) -> Option<Area> {
    let common = Area {
        south_deg: a.south_deg.max(b.south_deg),
        west_deg: a.west_deg.max(b.west_deg),
        north_deg: a.north_deg.min(b.north_deg),
        east_deg: a.east_deg.min(b.east_deg),
    };
    (common.south_deg <= common.north_deg && common.west_deg <= common.east_deg).then_some(common)
}

/// What is left of an area without a part of it.
fn around(area: &Area, part: &Area) -> impl Iterator<Item = Area> {
    let [south, west, north, east] = [part.south_deg, part.west_deg, part.north_deg, part.east_deg];
    let pieces = [
        [north, area.west_deg, area.north_deg, area.east_deg],
        [area.south_deg, area.west_deg, south, area.east_deg],
        [south, area.west_deg, north, west],
        [south, east, north, area.east_deg],
    ];
    pieces.map(Area::of).into_iter().filter(|piece| {
        piece.north_deg - piece.south_deg > SLIVER_DEG
            && piece.east_deg - piece.west_deg > SLIVER_DEG
    })
}

/// How many steps one number is from another, if a whole number.
pub(super) fn whole_steps(from: f64, to: f64, step: f64) -> Option<i64> {
    let steps = (to - from) / step;
    let nearest = libm::rint(steps);
    #[expect(clippy::cast_possible_truncation, reason = "far below 2^53")]
    let whole = nearest as i64;
    ((steps - nearest).abs() < ALIGNED && nearest.abs() < 1e9).then_some(whole)
}

/// Whether two grids have the same spacing.
pub(super) fn same_spacing(a: &HeightGrid, b: &HeightGrid) -> bool {
    let same = |a: f64, b: f64| (a - b).abs() < 1e-6 * a;
    same(a.step_north_deg, b.step_north_deg) && same(a.step_east_deg, b.step_east_deg)
}

/// The strips between neighbours one spacing apart: each to the east of another, or to the north.
fn seams(fields: &[&HeightField], east: bool) -> Vec<HeightField> {
    let pairs = fields
        .iter()
        .flat_map(|first| fields.iter().map(move |second| (first, second)));
    pairs
        .filter_map(|(first, second)| seam(first, second, east))
        .collect()
}

fn seam(first: &HeightField, second: &HeightField, east: bool) -> Option<HeightField> {
    let lattice = first.grid();
    let (a, b) = (lattice.area(), second.grid().area());
    let north_steps = |from: f64, to: f64| whole_steps(from, to, lattice.step_north_deg);
    let east_steps = |from: f64, to: f64| whole_steps(from, to, lattice.step_east_deg);
    // Along the seam from the first post that both have to the last; across it from one to the other.
    let (mut south_deg, mut north_deg) =
        (a.south_deg.max(b.south_deg), a.north_deg.min(b.north_deg));
    let (mut west_deg, mut east_deg) = (a.west_deg.max(b.west_deg), a.east_deg.min(b.east_deg));
    let across = if east {
        (west_deg, east_deg) = (a.east_deg, b.west_deg);
        east_steps(west_deg, east_deg)
    } else {
        (south_deg, north_deg) = (a.north_deg, b.south_deg);
        north_steps(south_deg, north_deg)
    };
    // Posts lie on one lattice.
    north_steps(a.south_deg, b.south_deg)?;
    east_steps(a.west_deg, b.west_deg)?;
    if across != Some(1) || !same_spacing(lattice, second.grid()) {
        return None;
    }
    let grid = HeightGrid {
        south_deg,
        west_deg,
        rows: usize::try_from(north_steps(south_deg, north_deg)? + 1).ok()?,
        columns: usize::try_from(east_steps(west_deg, east_deg)? + 1).ok()?,
        ..*lattice
    };
    let posts = (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column)));
    let height_m = |(row, column): (usize, usize)| {
        // A post has the height of the nearest one of its field.
        let is_second = if east { column == 1 } else { row == 0 };
        let field = if is_second { second } else { first };
        let of = field.grid();
        let north = (grid.latitude_deg(row) - of.south_deg) / of.step_north_deg;
        let east = (grid.longitude_deg(column) - of.west_deg) / of.step_east_deg;
        let steps = [libm::rint(north), libm::rint(east)];
        field.cell(steps).height_m(steps).map_or(f32::NAN, single)
    };
    HeightField::new(grid, posts.map(height_m).collect::<Vec<f32>>()).ok()
}

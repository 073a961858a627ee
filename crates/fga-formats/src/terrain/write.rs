//! A part of the ground as a file of its own.
//!
//! The file is a GeoTIFF whatever it was cut from: of the formats that other programs read, GeoTIFF alone holds any area
//! with its datum and its holes.

use std::io::Cursor;
use std::path::Path;

use tiff::encoder::colortype::{ColorType, Gray32Float, GrayI16};
use tiff::encoder::{Compression, TiffEncoder, TiffValue};
use tiff::tags::Tag;
use tiff::{TiffError, TiffResult};

use super::field::{HOLE, HeightField, HeightGrid, Heights};
use super::file::MOST_BYTES;
use super::geokeys::{self, codes};
use super::geotiff::{ERROR_ITEM, GDAL_METADATA};
use super::mosaic::{Terrain, same_spacing, whole_steps};
use super::{Area, Datum};
use crate::atomic;
use crate::error::OutputError;
use crate::number::{self, single};

/// A part of the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Its heights.
    pub field: HeightField,
    /// What the heights are above.
    pub datum: Datum,
    /// Vertical error of the files, metres.
    pub vertical_error_m: f64,
    /// Whether heights were interpolated, because not all files have their posts on one lattice.
    pub is_resampled: bool,
}

impl Terrain {
    /// The ground of an area, grown to whole posts of the first file that has some of it.
    ///
    /// # Errors
    /// An area without known ground, or with more posts than 512 MB hold.
    pub fn cut(&self, area: &Area) -> Result<Cut, String> {
        let outside = || {
            let held = self
                .area()
                .map_or_else(String::new, |held| held.to_string());
            format!("the area {area} has no known ground, expected a part of {held}")
        };
        let within: Vec<&HeightField> = self
            .fields()
            .filter(|field| field.grid().area().overlaps(area))
            .collect();
        let lattice = *within.first().ok_or_else(outside)?.grid();
        let grid = grid(&lattice, area)?;
        let is_resampled = !within.iter().all(|field| {
            let other = field.grid();
            same_spacing(&lattice, other)
                && whole_steps(lattice.south_deg, other.south_deg, lattice.step_north_deg).is_some()
                && whole_steps(lattice.west_deg, other.west_deg, lattice.step_east_deg).is_some()
        });
        let mut heights = Vec::with_capacity(grid.rows * grid.columns);
        for row in 0..grid.rows {
            let latitude_deg = grid.latitude_deg(row);
            let beside: Vec<&HeightField> = within
                .iter()
                .copied()
                .filter(|field| {
                    let held = field.grid().area();
                    let slack_deg = field.grid().step_north_deg;
                    held.south_deg - slack_deg < latitude_deg
                        && latitude_deg < held.north_deg + slack_deg
                })
                .collect();
            heights.extend((0..grid.columns).map(|column| {
                let longitude_deg = grid.longitude_deg(column);
                let height_m = beside
                    .iter()
                    .find_map(|field| field.height_m(latitude_deg, longitude_deg));
                height_m.map_or(f32::NAN, single)
            }));
        }
        if heights.iter().all(|height| height.is_nan()) {
            return Err(outside());
        }
        Ok(Cut {
            field: HeightField::new(grid, heights)?,
            datum: self.datum(),
            vertical_error_m: self.vertical_error_m(),
            is_resampled,
        })
    }
}

/// The posts of a lattice around an area.
fn grid(lattice: &HeightGrid, area: &Area) -> Result<HeightGrid, String> {
    let around = |from: f64, to: f64, first: f64, step: f64| {
        // A side on a line of posts needs no post beyond.
        let low = libm::floor((from - first) / step + 1e-6);
        let high = libm::ceil((to - first) / step - 1e-6);
        (first + low * step, high - low + 1.0)
    };
    let (south_deg, rows) = around(
        area.south_deg,
        area.north_deg,
        lattice.south_deg,
        lattice.step_north_deg,
    );
    let (west_deg, columns) = around(
        area.west_deg,
        area.east_deg,
        lattice.west_deg,
        lattice.step_east_deg,
    );
    if rows * columns * 4.0 > MOST_BYTES as f64 {
        return Err(format!(
            "the area {area} has {rows} x {columns} heights, expected at most {} of them",
            MOST_BYTES / 4
        ));
    }
    let [rows, columns] = [rows, columns].map(number::count);
    Ok(HeightGrid {
        south_deg,
        west_deg,
        rows,
        columns,
        ..*lattice
    })
}

impl Cut {
    /// Writes the part as a GeoTIFF, complete or not at all.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let failed = |error| {
            let error = match error {
                TiffError::IoError(error) => error,
                other => std::io::Error::other(other),
            };
            OutputError::new(path, error)
        };
        atomic::write(path, self.bytes().map_err(failed)?)
    }

    /// The bytes of the file, in whole metres where all heights are.
    fn bytes(&self) -> TiffResult<Vec<u8>> {
        match self.field.heights() {
            Heights::Whole(heights) => self.encode::<GrayI16>(heights, &HOLE.to_string()),
            Heights::Single(heights) => self.encode::<Gray32Float>(heights, "nan"),
        }
    }

    fn encode<C: ColorType>(&self, heights: &[C::Inner], hole: &str) -> TiffResult<Vec<u8>>
    where
        [C::Inner]: TiffValue,
    {
        let grid = self.field.grid();
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes)?
            .with_compression(Compression::Deflate(tiff::encoder::DeflateLevel::Balanced));
        let size = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let mut image = encoder.new_image::<C>(size(grid.columns), size(grid.rows))?;
        let tags = image.encoder();
        let scale = [grid.step_east_deg, grid.step_north_deg, 0.0];
        tags.write_tag(Tag::ModelPixelScaleTag, &scale[..])?;
        let north_west = [0.0, 0.0, 0.0, grid.west_deg, grid.latitude_deg(0), 0.0];
        tags.write_tag(Tag::ModelTiepointTag, &north_west[..])?;
        let (geographic, vertical) = codes(self.datum);
        let mut keys = vec![
            [geokeys::MODEL, 0, 1, 2],
            [geokeys::RASTER, 0, 1, 2],
            [geokeys::GEOGRAPHIC, 0, 1, geographic],
        ];
        if let Some(vertical) = vertical {
            keys.push([geokeys::VERTICAL, 0, 1, vertical]);
        }
        let count = u16::try_from(keys.len()).unwrap_or_default();
        keys.insert(0, [1, 1, 1, count]);
        tags.write_tag(Tag::GeoKeyDirectoryTag, keys.as_flattened())?;
        tags.write_tag(Tag::GdalNodata, hole)?;
        let metadata = format!(
            "<GDALMetadata><Item name=\"{ERROR_ITEM}\">{}</Item></GDALMetadata>",
            self.vertical_error_m
        );
        tags.write_tag(Tag::Unknown(GDAL_METADATA), metadata.as_str())?;
        image.write_data(heights)?;
        Ok(bytes.into_inner())
    }
}

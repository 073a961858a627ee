//! Heights in a GeoTIFF: one band of 16-bit integers or of floats, in strips or tiles, geographic coordinates.

use std::io::{Read, Seek, SeekFrom};

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::field::{HOLE, HeightField, HeightGrid, Heights};
use super::file::{MOST_BYTES, Parsed, Stated};
use super::geokeys::{self, GeoKeys};
use super::name;
use crate::gzip::unread;

/// A compressed file holds at most this many times its bytes: the most that deflate makes of its input, and the headers.
const MOST_TIMES: u64 = 1_100;
/// Metadata of GDAL as XML.
pub(super) const GDAL_METADATA: u16 = 42112;
/// The name of the vertical error in it.
pub(super) const ERROR_ITEM: &str = "VERTICAL_ERROR_M";

/// Whether these are the first bytes of a TIFF, also of a big one.
pub(super) fn is_tiff(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]
        .iter()
        .any(|magic| bytes.starts_with(*magic))
}

pub(super) fn parse(mut input: impl Read + Seek, file_name: &str) -> Result<Parsed, String> {
    let size = input
        .seek(SeekFrom::End(0))
        .map_err(|error| unread(&error))?;
    input.rewind().map_err(|error| unread(&error))?;
    let failed = |error: TiffError| sentence(&error);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MOST_BYTES;
    let mut decoder = Decoder::new(input).map_err(failed)?.with_limits(limits);
    let (columns, rows) = decoder.dimensions().map_err(failed)?;
    let color = decoder.colortype().map_err(failed)?;
    let ColorType::Gray(bits @ (16 | 32 | 64)) = color else {
        return Err(format!(
            "has pixels of the kind {color:?}, expected one band of heights with 16 or 32 bits"
        ));
    };
    let promised = u64::from(columns)
        .saturating_mul(u64::from(rows))
        .saturating_mul(u64::from(bits / 8));
    if promised > (MOST_BYTES as u64).min(size.saturating_mul(MOST_TIMES)) {
        return Err(format!(
            "promises {columns} x {rows} heights in {size} bytes, expected at most {MOST_BYTES} bytes of heights and \
             {MOST_TIMES} times the file"
        ));
    }
    let directory = decoder
        .find_tag_unsigned_vec::<u16>(Tag::GeoKeyDirectoryTag)
        .map_err(failed)?
        .ok_or("is a TIFF without a place (no GeoKeys), expected a GeoTIFF")?;
    let keys = geokeys::read(&directory)?;
    let grid = grid(
        &mut decoder,
        &keys,
        [rows, columns].map(|count| count as usize),
    )?;
    let unknown = match decoder.find_tag(Tag::GdalNodata).map_err(failed)? {
        Some(value) => Some(nodata(&value.into_string().map_err(failed)?)?),
        None => None,
    };
    let error = match decoder
        .find_tag(Tag::Unknown(GDAL_METADATA))
        .map_err(failed)?
    {
        Some(value) => metadata(&value.into_string().map_err(failed)?)?,
        None => None,
    };
    let image = decoder.read_image().map_err(failed)?;
    let field = HeightField::new(grid, heights(image, unknown)?)?;
    name::agrees(file_name, &field.grid().area())?;
    Ok(Parsed::one("GeoTIFF", field, keys.datum, error))
}

/// An error of the reader as words without its line breaks.
fn sentence(error: &TiffError) -> String {
    let words = error.to_string().replace('\n', " ");
    format!(
        "is no usable TIFF ({words}), expected a whole one, uncompressed or compressed by deflate, LZW or PackBits"
    )
}

/// The posts: the pixels, or the middles of pixels that are areas.
fn grid<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    keys: &GeoKeys,
    [rows, columns]: [usize; 2],
) -> Result<HeightGrid, String> {
    let mut numbers = |tag: Tag| -> Result<Vec<f64>, String> {
        let found = decoder.find_tag(tag).map_err(|error| sentence(&error))?;
        let numbers = found
            .map(tiff::decoder::ifd::Value::into_f64_vec)
            .transpose();
        Ok(numbers
            .map_err(|error| sentence(&error))?
            .unwrap_or_default())
    };
    let scale = numbers(Tag::ModelPixelScaleTag)?;
    let tie = numbers(Tag::ModelTiepointTag)?;
    let matrix = numbers(Tag::ModelTransformationTag)?;
    // West and north of the first pixel's corner, and the size of a pixel.
    let [west_deg, north_deg, east_step, north_step] = match (&scale[..], &tie[..], &matrix[..]) {
        ([east, north, ..], [column, row, _, west, top, _], _) => {
            [west - column * east, top + row * north, *east, *north]
        }
        (_, _, [east, 0.0, _, west, 0.0, south, _, top, ..]) => [*west, *top, *east, -south],
        _ => {
            return Err(
                "has no place for its pixels, expected one tie point and a pixel scale, or a matrix without rotation"
                    .into(),
            );
        }
    };
    let half = if keys.is_point { 0.0 } else { 0.5 };
    let mut west_deg = west_deg + half * east_step;
    if west_deg >= 180.0 - 1e-9 {
        west_deg -= 360.0;
    }
    let north_deg = north_deg - half * north_step;
    Ok(HeightGrid {
        south_deg: north_deg - rows.saturating_sub(1) as f64 * north_step,
        west_deg,
        step_north_deg: north_step,
        step_east_deg: east_step,
        rows,
        columns,
    })
}

/// The height that stands for a hole.
fn nodata(text: &str) -> Result<f64, String> {
    let text = text.trim_matches(|c: char| c == '\0' || c.is_whitespace());
    text.parse().map_err(|_| {
        format!(
            "has {} as the value of a hole, expected a number",
            crate::error::shown(text)
        )
    })
}

/// The vertical error in the metadata, if it stands there; scaled heights are refused.
fn metadata(text: &str) -> Result<Option<Stated<f64>>, String> {
    if text.contains("role=\"scale\"") || text.contains("role=\"offset\"") {
        return Err(
            "has scaled heights (GDAL's scale or offset), expected heights in metres".into(),
        );
    }
    let value = text
        .split_once(ERROR_ITEM)
        .and_then(|(_, rest)| rest.split_once('>'))
        .and_then(|(_, rest)| rest.split_once('<'))
        .and_then(|(value, _)| value.trim().parse::<f64>().ok());
    Ok(value
        .filter(|value| (0.0..=1000.0).contains(value))
        .map(|value| Stated {
            value,
            source: "the file's metadata",
        }))
}

fn heights(image: DecodingResult, unknown: Option<f64>) -> Result<Heights, String> {
    /// As 32-bit floats: no height of the earth needs more.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a height beyond the range of f32 becomes infinite and is refused"
    )]
    fn fraction(heights: impl Iterator<Item = f64>, unknown: Option<f64>) -> Heights {
        let known = |height: f64| Some(height) != unknown;
        Heights::Fraction(
            heights
                .map(|height| {
                    if known(height) {
                        height as f32
                    } else {
                        f32::NAN
                    }
                })
                .collect(),
        )
    }
    Ok(match image {
        DecodingResult::I16(mut heights) => {
            if let Some(unknown) = unknown.filter(|unknown| *unknown != f64::from(HOLE)) {
                for height in &mut heights {
                    if f64::from(*height) == unknown {
                        *height = HOLE;
                    }
                }
            }
            Heights::Whole(heights)
        }
        DecodingResult::F32(mut heights) => {
            for height in &mut heights {
                if Some(f64::from(*height)) == unknown {
                    *height = f32::NAN;
                }
            }
            Heights::Fraction(heights)
        }
        DecodingResult::U16(heights) => fraction(heights.into_iter().map(f64::from), unknown),
        DecodingResult::I32(heights) => fraction(heights.into_iter().map(f64::from), unknown),
        DecodingResult::F64(heights) => fraction(heights.into_iter(), unknown),
        _ => {
            return Err(
                "has pixels of another kind, expected signed integers of 16 bits or floats of 32 bits"
                    .into(),
            );
        }
    })
}

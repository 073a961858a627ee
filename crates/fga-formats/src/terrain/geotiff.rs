//! Heights in a GeoTIFF: one band of 16-bit integers or of floats, in strips or tiles, in degrees or on a map's grid, with its mask.

use std::io::{Cursor, Read, Seek, SeekFrom};

use roxmltree::{Document, Node};

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::field::{HOLE, HeightField, HeightGrid};
use super::file::{MOST_BYTES, Stated, TerrainFile};
use super::geokeys::{self, GeoKeys};
use super::tags::{content, numbers, sentence, set, whole_tags};
use super::{chunks, name, projected};
use crate::gzip::unread;
use crate::number::{finite, single};
use crate::units::{Dimension, Unit};

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

pub(super) fn parse(mut input: impl Read + Seek, file_name: &str) -> Result<TerrainFile, String> {
    let size = input
        .seek(SeekFrom::End(0))
        .map_err(|error| unread(&error))?;
    input.rewind().map_err(|error| unread(&error))?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MOST_BYTES;
    let mut decoder = Decoder::new(input)
        .map_err(sentence)?
        .with_limits(limits.clone());
    whole_tags(&mut decoder, size)?;
    let (columns, rows) = decoder.dimensions().map_err(sentence)?;
    let color = decoder.colortype().map_err(sentence)?;
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
        .map_err(sentence)?
        .ok_or("is a TIFF without a place (no GeoKeys), expected a GeoTIFF")?;
    let keys = geokeys::read(&directory)?;
    let size = [rows, columns].map(|count| count as usize);
    let scale = numbers(&mut decoder, Tag::ModelPixelScaleTag)?;
    let tie = numbers(&mut decoder, Tag::ModelTiepointTag)?;
    let matrix = numbers(&mut decoder, Tag::ModelTransformationTag)?;
    let corner = corner(&scale, &tie, &matrix, &keys)?;
    let mut text = |tag| -> Result<Option<String>, String> {
        let value = decoder.find_tag(tag).map_err(sentence)?;
        value
            .map(|value| value.into_string().map_err(sentence))
            .transpose()
    };
    let unknown = text(Tag::GdalNodata)?
        .map(|text| nodata(&text))
        .transpose()?;
    let metadata = text(Tag::Unknown(GDAL_METADATA))?;
    let metadata =
        metadata.map_or_else(|| Ok(Metadata::default()), |text| Metadata::read(&text))?;
    let unit_m = metadata.unit_m.unwrap_or(keys.vertical_unit_m);
    let line = metadata
        .line
        .map_or_else(|| line(&scale, &tie, &keys), Ok)?;
    let line = line.map(|number| number * unit_m);
    let heights_of = |image| heights(image, unknown, line);
    let mut heights = match chunks::heights(&mut decoder, size, limits, heights_of)? {
        Some(heights) => heights,
        None => heights_of(decoder.read_image().map_err(sentence)?)?,
    };
    if let Some(known) = mask(decoder, [columns, rows])? {
        let masked = heights.iter_mut().zip(known).filter(|(_, known)| !known);
        masked.for_each(|(height, _)| *height = f32::NAN);
    }
    let field = match keys.projected {
        Some(code) => projected::field(code, corner, size, &heights)?,
        None => HeightField::new(grid(corner, size), heights)?,
    };
    name::agrees(file_name, &field.grid().area())?;
    Ok(TerrainFile::new(
        "GeoTIFF",
        vec![field],
        keys.datum,
        metadata.error,
    ))
}

/// Whether each pixel is known, by the mask that follows the image; `None` without one. Smaller images are overviews.
fn mask<R: Read + Seek>(
    mut decoder: Decoder<R>,
    size: [u32; 2],
) -> Result<Option<Vec<bool>>, String> {
    while decoder.more_images() {
        decoder.next_image().map_err(sentence)?;
        let (width, height) = decoder.dimensions().map_err(sentence)?;
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType);
        let kind = kind.map_err(sentence)?.unwrap_or(0);
        let color = decoder.find_tag_unsigned::<u16>(Tag::PhotometricInterpretation);
        let is_mask = kind & 4 != 0 || color.map_err(sentence)? == Some(TRANSPARENCY_MASK);
        if kind & 1 != 0 || (!is_mask && (width < size[0] || height < size[1])) {
            continue;
        }
        if !is_mask || [width, height] != size {
            let what = if is_mask { "a mask" } else { "a second image" };
            let [columns, rows] = size;
            return Err(format!(
                "has {what} of {width} x {height} pixels beside {columns} x {rows} heights, expected one image, its mask and overviews"
            ));
        }
        let directory = decoder.ifd_pointer().map_or(0, |at| at.0);
        let mut bytes = content(&mut decoder)?;
        // Gray, for the decoder reads no image that calls itself a mask.
        set(&mut bytes, directory, Tag::PhotometricInterpretation, 1)?;
        return gray_mask(bytes, directory, size).map(Some);
    }
    Ok(None)
}

/// A mask as its photometric interpretation names it.
const TRANSPARENCY_MASK: u16 = 4;

/// Whether each pixel is known, by the gray image of a directory: what is black is a hole.
fn gray_mask(
    bytes: Vec<u8>,
    directory: u64,
    [columns, rows]: [u32; 2],
) -> Result<Vec<bool>, String> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(sentence)?;
    while decoder.ifd_pointer().map(|at| at.0) != Some(directory) {
        decoder.next_image().map_err(sentence)?;
    }
    let [columns, rows] = [columns, rows].map(|count| count as usize);
    let color = decoder.colortype().map_err(sentence)?;
    let image = decoder.read_image().map_err(sentence)?;
    let known: Vec<bool> = match (color, image) {
        (ColorType::Gray(1), DecodingResult::U8(bits)) => {
            let lines = bits.chunks(columns.div_ceil(8)).flat_map(|line| {
                let bits = line
                    .iter()
                    .flat_map(|byte| (0..8).map(move |bit| byte & (0x80 >> bit) != 0));
                bits.take(columns)
            });
            lines.collect()
        }
        (ColorType::Gray(8), DecodingResult::U8(values)) => {
            values.iter().map(|value| *value != 0).collect()
        }
        _ => {
            return Err(format!(
                "has a mask of the kind {color:?}, expected one with 1 or 8 bits"
            ));
        }
    };
    let count = known.len();
    if count != columns * rows {
        return Err(format!(
            "has a mask of {count} pixels, expected {columns} x {rows}"
        ));
    }
    Ok(known)
}

/// Scale and offset of pixels that are heights.
const AS_THEY_ARE: [f64; 2] = [1.0, 0.0];

/// Scale and offset of the pixels by the third number of the pixel scale, as GDAL writes them where keys name a vertical datum.
fn line(scale: &[f64], tie: &[f64], keys: &GeoKeys) -> Result<[f64; 2], String> {
    let &[_, _, scale, ..] = scale else {
        return Ok(AS_THEY_ARE);
    };
    let offset = match tie {
        [_, _, pixel, _, _, height, ..] => height - pixel * scale,
        _ => 0.0,
    };
    let line = [scale, offset];
    if scale == 0.0 || line == AS_THEY_ARE {
        return Ok(AS_THEY_ARE);
    }
    if !keys.is_vertical || !line.iter().all(|number| number.is_finite()) {
        return Err(format!(
            "has the vertical scale {scale} and the offset {offset} without a vertical datum, expected both with one, or neither"
        ));
    }
    Ok(line)
}

/// West and north of the first post, and the steps east and north: the pixels, or the middles of pixels that are areas.
fn corner(scale: &[f64], tie: &[f64], matrix: &[f64], keys: &GeoKeys) -> Result<[f64; 4], String> {
    // West and north of the first pixel's corner, and the size of a pixel.
    let [west, north, east_step, north_step] = match (scale, tie, matrix) {
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
    let (west, north) = (west + half * east_step, north - half * north_step);
    Ok([west, north, east_step, north_step])
}

/// A grid of degrees.
fn grid([west, north, east_step, north_step]: [f64; 4], [rows, columns]: [usize; 2]) -> HeightGrid {
    HeightGrid {
        south_deg: north - rows.saturating_sub(1) as f64 * north_step,
        west_deg: if west >= 180.0 - 1e-9 {
            west - 360.0
        } else {
            west
        },
        step_north_deg: north_step,
        step_east_deg: east_step,
        rows,
        columns,
    }
}

/// The height that stands for a hole.
fn nodata(text: &str) -> Result<f64, String> {
    let text = text.trim_matches(|c: char| c == '\0' || c.is_whitespace());
    let found = crate::error::shown(text);
    let wrong = |_| format!("has {found} as the value of a hole, expected a number");
    text.parse().map_err(wrong)
}

/// What GDAL's metadata say of the only band.
#[derive(Debug, Default)]
struct Metadata {
    /// The vertical error, if it stands there.
    error: Option<Stated<f64>>,
    /// Scale and offset of the pixels, in the unit.
    line: Option<[f64; 2]>,
    /// The unit, metres.
    unit_m: Option<f64>,
}

impl Metadata {
    fn read(text: &str) -> Result<Self, String> {
        let text = text.trim_matches(|c: char| c == '\0' || c.is_whitespace());
        let mut found = Self::default();
        let document = Document::parse(text)
            .map_err(|error| format!("has unreadable metadata of GDAL ({error}), expected XML"))?;
        for item in document.descendants().filter(Node::is_element) {
            let value = item.text().unwrap_or_default().trim();
            let number = || {
                let shown = crate::error::shown(value);
                finite(value).ok_or(format!(
                    "has the scale or offset {shown}, expected a number"
                ))
            };
            let of_first = item.attribute("sample").is_none_or(|sample| sample == "0");
            let role = item.attribute("role").map(str::to_ascii_lowercase);
            match role.as_deref() {
                Some("scale") if of_first => found.line.get_or_insert(AS_THEY_ARE)[0] = number()?,
                Some("offset") if of_first => found.line.get_or_insert(AS_THEY_ARE)[1] = number()?,
                Some("unittype") if of_first && !value.is_empty() => {
                    found.unit_m = Some(unit_m(value)?);
                }
                _ if item.attribute("name") == Some(ERROR_ITEM) => {
                    let value = value.parse().ok();
                    let value = value.filter(|value| (0.0..=1000.0).contains(value));
                    let source = "the file's metadata";
                    found.error = value.map(|value| Stated { value, source });
                }
                _ => (),
            }
        }
        Ok(found)
    }
}

/// A unit of heights by its name in a file, metres.
fn unit_m(name: &str) -> Result<f64, String> {
    let words = name.to_ascii_lowercase().replace(['_', '-'], " ");
    match words.as_str() {
        "us survey foot" | "us survey feet" | "us ft" | "sft" | "foot us" | "ft us" | "ftus" => {
            Ok(geokeys::SURVEY_FOOT_M)
        }
        other => {
            let unit = Unit::parse(other).filter(|unit| unit.dimension == Dimension::Length);
            let expected = || {
                let shown = crate::error::shown(name);
                format!("has heights in {shown}, expected metres or feet")
            };
            unit.map(|unit| unit.factor).ok_or_else(expected)
        }
    }
}

/// The heights in metres: the pixels times a scale, plus an offset; not a number for a hole, whose value is one of the pixels.
fn heights(
    image: DecodingResult,
    unknown: Option<f64>,
    [scale, offset]: [f64; 2],
) -> Result<Vec<f32>, String> {
    // As 32-bit floats: no height of the earth needs more. Programs write the value of a hole with the digits of either.
    let height_m = |pixel: f64| {
        let is_hole = |unknown| pixel == unknown || single(pixel) == single(unknown);
        if unknown.is_some_and(is_hole) {
            f32::NAN
        } else {
            single(pixel * scale + offset)
        }
    };
    // The most negative one is a hole, whether or not the file says so.
    let whole = |pixel: i16| {
        if pixel == HOLE {
            f32::NAN
        } else {
            height_m(f64::from(pixel))
        }
    };
    Ok(match image {
        DecodingResult::I16(pixels) => pixels.into_iter().map(whole).collect(),
        DecodingResult::U16(pixels) => pixels.into_iter().map(f64::from).map(height_m).collect(),
        DecodingResult::I32(pixels) => pixels.into_iter().map(f64::from).map(height_m).collect(),
        DecodingResult::U32(pixels) => pixels.into_iter().map(f64::from).map(height_m).collect(),
        DecodingResult::F32(pixels) => pixels.into_iter().map(f64::from).map(height_m).collect(),
        DecodingResult::F64(pixels) => pixels.into_iter().map(height_m).collect(),
        _ => {
            return Err(
                "has pixels of another kind, expected integers of 16 or 32 bits or floats".into(),
            );
        }
    })
}

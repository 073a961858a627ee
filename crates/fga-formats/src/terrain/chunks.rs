//! Heights of a TIFF by its strips and tiles, where the decoder does not read the image whole.

use std::io::{Cursor, Read, Seek, SeekFrom};

use lerc::SampleData;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::tags::{content, sentence, set, whole};
use crate::gzip::unread;

/// The numbers of compressions.
const LZW: u64 = 5;
const LERC: u64 = 34_887;
/// The tag of LERC's version and of what compresses its blobs: 0 nothing, 1 deflate, 2 ZSTD.
const PARAMETERS: u16 = 50_674;

/// The heights of an image of this size in strips or tiles of LERC, or in tiles of LZW; `None` for another image.
pub(super) fn heights<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    [rows, columns]: [usize; 2],
    limits: Limits,
    heights_of: impl Fn(DecodingResult) -> Result<Vec<f32>, String>,
) -> Result<Option<Vec<f32>>, String> {
    for lengths in [Tag::TileByteCounts, Tag::StripByteCounts] {
        if whole(decoder, lengths)?.contains(&0) {
            return Err("lacks a part (sparse), expected all of its strips or tiles".into());
        }
    }
    let tiles = whole(decoder, Tag::TileOffsets)?.len();
    let posts = match whole(decoder, Tag::Compression)?[..] {
        [LERC] => blobs(decoder, heights_of)?,
        [LZW] if tiles > 0 => heights_of(column(decoder, tiles, limits)?)?,
        _ => return Ok(None),
    };
    let (width, height) = decoder.chunk_dimensions();
    let (width, height) = ((width as usize).max(1), (height as usize).max(1));
    let across = columns.div_ceil(width);
    let post = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let chunk = row / height * across + column / width;
        let post = posts.get((chunk * height + row % height) * width + column % width);
        post.copied().unwrap_or(f32::NAN)
    };
    Ok(Some((0..rows * columns).map(post).collect()))
}

/// The tiles one below the other. The decoder takes the end of many tiles of LZW for damage where it reads them line by line into a wider
/// image (image-tiff, issue 395).
fn column<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    tiles: usize,
    limits: Limits,
) -> Result<DecodingResult, String> {
    let (width, height) = decoder.chunk_dimensions();
    let directory = decoder.ifd_pointer().map_or(0, |at| at.0);
    let mut bytes = content(decoder)?;
    let below = u32::try_from(tiles).map_or(u32::MAX, |tiles| tiles.saturating_mul(height));
    set(&mut bytes, directory, Tag::ImageWidth, width)?;
    set(&mut bytes, directory, Tag::ImageLength, below)?;
    let column = Decoder::new(Cursor::new(bytes)).map_err(sentence)?;
    column.with_limits(limits).read_image().map_err(sentence)
}

/// The heights of blobs of LERC one below the other, not a number where a blob leaves them out.
fn blobs<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    heights_of: impl Fn(DecodingResult) -> Result<Vec<f32>, String>,
) -> Result<Vec<f32>, String> {
    if !matches!(whole(decoder, Tag::Unknown(PARAMETERS))?[..], [] | [_, 0]) {
        return Err("has LERC within deflate or ZSTD, expected LERC alone".into());
    }
    let offsets = [
        whole(decoder, Tag::TileOffsets)?,
        whole(decoder, Tag::StripOffsets)?,
    ]
    .concat();
    let lengths = [
        whole(decoder, Tag::TileByteCounts)?,
        whole(decoder, Tag::StripByteCounts)?,
    ]
    .concat();
    let (width, height) = decoder.chunk_dimensions();
    let mut posts = Vec::new();
    for (offset, length) in offsets.into_iter().zip(lengths) {
        let input = decoder.inner();
        let at = SeekFrom::Start(offset);
        input.seek(at).map_err(|error| unread(&error))?;
        let mut blob = Vec::new();
        let read = input.take(length).read_to_end(&mut blob);
        read.map_err(|error| unread(&error))?;
        let image = lerc::decode(&blob)
            .map_err(|error| format!("has damaged LERC ({error}), expected a whole file"))?;
        if image.width != width || image.height > height {
            let (columns, rows) = (image.width, image.height);
            return Err(format!(
                "has a part of LERC of {columns} x {rows} heights, expected {width} x {height}"
            ));
        }
        let part = heights_of(match image.data {
            SampleData::I16(pixels) => DecodingResult::I16(pixels),
            SampleData::U16(pixels) => DecodingResult::U16(pixels),
            SampleData::F32(pixels) => DecodingResult::F32(pixels),
            _ => return Err("has LERC of another kind, expected 16-bit integers or floats".into()),
        })?;
        let mask = image.valid_masks.first();
        let is_known = |at: usize| mask.is_none_or(|mask| mask.is_valid(at));
        let known = part.into_iter().enumerate();
        posts.extend(known.map(|(at, height_m)| if is_known(at) { height_m } else { f32::NAN }));
        posts.resize(
            posts
                .len()
                .next_multiple_of(width as usize * height as usize),
            f32::NAN,
        );
    }
    Ok(posts)
}

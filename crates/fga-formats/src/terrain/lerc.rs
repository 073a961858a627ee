//! Heights that a TIFF holds as blobs of LERC, one for each strip or tile.

use std::io::{Read, Seek, SeekFrom};

use lerc::SampleData;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use super::tags::whole;
use crate::gzip::unread;

/// The number of this compression.
const LERC: u64 = 34_887;
/// The tag of LERC's version and of what compresses its blobs: 0 nothing, 1 deflate, 2 ZSTD.
const PARAMETERS: u16 = 50_674;

/// The heights of an image of this size that LERC compresses, not a number where a blob leaves them out; `None` for another compression.
pub(super) fn heights<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    [rows, columns]: [usize; 2],
    heights_of: impl Fn(DecodingResult) -> Result<Vec<f32>, String>,
) -> Result<Option<Vec<f32>>, String> {
    if whole(decoder, Tag::Compression)? != [LERC] {
        return Ok(None);
    }
    if !matches!(whole(decoder, Tag::Unknown(PARAMETERS))?[..], [] | [_, 0]) {
        return Err("has LERC within deflate or ZSTD, expected LERC alone".into());
    }
    let mut offsets = whole(decoder, Tag::TileOffsets)?;
    let mut lengths = whole(decoder, Tag::TileByteCounts)?;
    if offsets.is_empty() {
        offsets = whole(decoder, Tag::StripOffsets)?;
        lengths = whole(decoder, Tag::StripByteCounts)?;
    }
    let (width, height) = decoder.chunk_dimensions();
    let across = columns.div_ceil((width as usize).max(1)).max(1);
    let mut heights = vec![f32::NAN; rows * columns];
    for (index, (offset, length)) in offsets.into_iter().zip(lengths).enumerate() {
        let input = decoder.inner();
        let at = SeekFrom::Start(offset);
        input.seek(at).map_err(|error| unread(&error))?;
        let mut blob = Vec::new();
        let read = input.take(length).read_to_end(&mut blob);
        read.map_err(|error| unread(&error))?;
        let image = lerc::decode(&blob)
            .map_err(|error| format!("has damaged LERC ({error}), expected a whole file"))?;
        let (image_width, mask) = (image.width as usize, image.valid_masks.first());
        let part = heights_of(match image.data {
            SampleData::I16(pixels) => DecodingResult::I16(pixels),
            SampleData::U16(pixels) => DecodingResult::U16(pixels),
            SampleData::F32(pixels) => DecodingResult::F32(pixels),
            _ => return Err("has LERC of another kind, expected 16-bit integers or floats".into()),
        })?;
        let (top, left) = (
            index / across * height as usize,
            index % across * width as usize,
        );
        for (at, height_m) in part.into_iter().enumerate() {
            let (row, column) = (top + at / image_width, left + at % image_width);
            let is_known = column < columns && mask.is_none_or(|mask| mask.is_valid(at));
            let post = heights.get_mut(row * columns + column);
            if let Some(post) = post.filter(|_| is_known) {
                *post = height_m;
            }
        }
    }
    Ok(Some(heights))
}

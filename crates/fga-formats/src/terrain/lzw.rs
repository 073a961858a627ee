//! Heights in tiles that LZW compresses.

use std::io::{Cursor, Read, Seek};

use tiff::TiffError;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::tags::{content, sentence, set, whole};

/// The number of this compression.
const LZW: u64 = 5;

/// The heights of an image of this size in such tiles; `None` for another image.
///
/// The decoder takes the end of many tiles for damage where it reads them line by line into a wider image (image-tiff, issue 395). It reads
/// them well where each lies below the one before.
pub(super) fn heights<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    [rows, columns]: [usize; 2],
    limits: Limits,
    heights_of: impl Fn(DecodingResult) -> Result<Vec<f32>, String>,
) -> Result<Option<Vec<f32>>, String> {
    let tiles = whole(decoder, Tag::TileOffsets)?.len();
    if tiles == 0 || whole(decoder, Tag::Compression)? != [LZW] {
        return Ok(None);
    }
    let failed = |error: TiffError| sentence(&error);
    let (width, height) = decoder.chunk_dimensions();
    let directory = decoder.ifd_pointer().map_or(0, |at| at.0);
    let mut bytes = content(decoder)?;
    let below = u32::try_from(tiles).map_or(u32::MAX, |tiles| tiles.saturating_mul(height));
    for (tag, value) in [(Tag::ImageWidth, width), (Tag::ImageLength, below)] {
        set(&mut bytes, directory, tag, value)?;
    }
    let column = Decoder::new(Cursor::new(bytes)).map_err(failed)?;
    let image = column.with_limits(limits).read_image().map_err(failed)?;
    let posts = heights_of(image)?;
    let (width, height) = (width as usize, height as usize);
    let across = columns.div_ceil(width);
    let post = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let tile = row / height * across + column / width;
        let post = posts.get((tile * height + row % height) * width + column % width);
        post.copied().unwrap_or(f32::NAN)
    };
    Ok(Some((0..rows * columns).map(post).collect()))
}

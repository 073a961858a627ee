//! The tags of a TIFF.

use std::io::{Read, Seek};

use tiff::TiffError;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// An error of the reader as words without its line breaks.
pub(super) fn sentence(error: &TiffError) -> String {
    let words = error.to_string().replace('\n', " ");
    format!(
        "is no usable TIFF ({words}), expected a whole one, uncompressed or compressed by deflate, LZW, PackBits, ZSTD or LERC"
    )
}

/// The numbers of a tag; empty without it.
pub(super) fn numbers<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    tag: Tag,
) -> Result<Vec<f64>, String> {
    let found = decoder.find_tag(tag).map_err(|error| sentence(&error))?;
    let numbers = found.map(tiff::decoder::ifd::Value::into_f64_vec);
    let numbers = numbers.transpose().map_err(|error| sentence(&error))?;
    Ok(numbers.unwrap_or_default())
}

/// The whole numbers of a tag; empty without it.
pub(super) fn whole<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    tag: Tag,
) -> Result<Vec<u64>, String> {
    let found = decoder.find_tag_unsigned_vec(tag);
    found
        .map(Option::unwrap_or_default)
        .map_err(|error| sentence(&error))
}

//! The tags of a TIFF.

use std::io::{Read, Seek};

use tiff::TiffError;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::file::MOST_BYTES;
use crate::gzip::{fill, unread};

/// An error of the reader as words without its line breaks.
#[expect(clippy::needless_pass_by_value, reason = "as map_err gives it")]
pub(super) fn sentence(error: TiffError) -> String {
    let words = error.to_string().replace('\n', " ");
    format!(
        "is no usable TIFF ({words}), expected a whole one, uncompressed or compressed by deflate, LZW, PackBits, ZSTD or LERC"
    )
}

/// Refuses tags that count more values than a file has bytes. The reader also prints what it makes of such a text.
pub(super) fn whole_tags<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    size: u64,
) -> Result<(), String> {
    let Some(place) = decoder.ifd_pointer() else {
        return Ok(());
    };
    let directory = decoder.read_directory(place).map_err(sentence)?;
    let mut tags = directory.iter();
    let too_long = tags.find(|(_, entry)| entry.count() > size);
    too_long.map_or(Ok(()), |(tag, entry)| {
        let count = entry.count();
        Err(format!(
            "has a tag {tag:?} of {count} values in {size} bytes, expected a whole TIFF"
        ))
    })
}

/// The numbers of a tag; empty without it.
pub(super) fn numbers<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    tag: Tag,
) -> Result<Vec<f64>, String> {
    let found = decoder.find_tag(tag).map_err(sentence)?;
    let numbers = found.map(tiff::decoder::ifd::Value::into_f64_vec);
    Ok(numbers.transpose().map_err(sentence)?.unwrap_or_default())
}

/// The whole numbers of a tag; empty without it.
pub(super) fn whole<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    tag: Tag,
) -> Result<Vec<u64>, String> {
    let found = decoder.find_tag_unsigned_vec(tag).map_err(sentence)?;
    Ok(found.unwrap_or_default())
}

/// All bytes of a file.
pub(super) fn content<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let input = decoder.inner();
    input.rewind().map_err(|error| unread(&error))?;
    fill(input, &mut bytes, MOST_BYTES).map(|()| bytes)
}

/// Sets a tag of the directory at a place of a file to a number.
pub(super) fn set(bytes: &mut [u8], directory: u64, tag: Tag, value: u32) -> Result<(), String> {
    let is_little = bytes.starts_with(b"I");
    let is_big = bytes.get(2..4).is_some_and(|version| version.contains(&43));
    let (count_bytes, entry_bytes, at) = if is_big { (8, 20, 12) } else { (2, 12, 8) };
    let short = |number: u16| {
        if is_little {
            number.to_le_bytes()
        } else {
            number.to_be_bytes()
        }
    };
    let long = if is_little {
        value.to_le_bytes()
    } else {
        value.to_be_bytes()
    };
    let begin = usize::try_from(directory)
        .unwrap_or(usize::MAX)
        .saturating_add(count_bytes);
    let entries = bytes.get_mut(begin..).unwrap_or_default();
    let mut entries = entries.chunks_exact_mut(entry_bytes);
    let entry = entries.find(|entry| entry.starts_with(&short(tag.to_u16())));
    let entry = entry.ok_or_else(|| format!("has no tag {tag:?}, expected a whole TIFF"))?;
    // A number of 32 bits.
    let parts = entry.iter_mut().skip(2).zip(short(4));
    parts.for_each(|(byte, new)| *byte = new);
    let parts = entry.iter_mut().skip(at).zip(long);
    parts.for_each(|(byte, new)| *byte = new);
    Ok(())
}

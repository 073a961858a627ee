//! Structures that begin with their size.

/// A structure of C that begins with its size, as a `u32`.
///
/// # Safety
/// It is `repr(C)`, its first field is a `u32`, and zeros are a value of it.
pub(crate) unsafe trait Growable: Copy {}

/// The size of a structure for its first field.
#[expect(
    clippy::cast_possible_truncation,
    reason = "structures of this interface are far below 4 GB"
)]
pub(crate) const fn size_word<T>() -> u32 {
    size_of::<T>() as u32
}

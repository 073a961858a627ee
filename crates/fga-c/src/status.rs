//! What a call answers, and why it refuses.

use core::ffi::{CStr, c_char};

use fga::limit::SettingsError;

use crate::growable::{Growable, size_word};

/// The answer of a call. `FGA_STATUS_OK` and `FGA_STATUS_INCOMPLETE` come with a result; after any other
/// nothing has changed, and nothing is written but the refusal.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_status {
    /// Done.
    Ok = 0,
    /// Done without some obstacles: a number of theirs is unusable, or there is no room for them.
    Incomplete = 1,
    /// A pointer is null.
    Null = 2,
    /// The size at the beginning of a structure is not that of this version of the library.
    WrongSize = 3,
    /// The caller was compiled with the header of another version of the interface.
    WrongVersion = 4,
    /// A pointer is not aligned for what it points to.
    Misaligned = 5,
    /// The storage is too small.
    StorageTooSmall = 6,
    /// Two of the pointers lead to memory that overlaps.
    Aliased = 7,
    /// The storage holds no such object: it was never initialized, or it was moved.
    NotInitialized = 8,
    /// Another call is at work on this object.
    Busy = 9,
    /// A number is not finite or out of range; the refusal names it.
    OutOfRange = 10,
    /// A number stands for none of the values of its enumeration; the refusal names it.
    UnknownValue = 11,
    /// More than there is room for; the refusal names it.
    TooMany = 12,
}

impl fga_status {
    const ALL: [Self; 13] = [
        Self::Ok,
        Self::Incomplete,
        Self::Null,
        Self::WrongSize,
        Self::WrongVersion,
        Self::Misaligned,
        Self::StorageTooSmall,
        Self::Aliased,
        Self::NotInitialized,
        Self::Busy,
        Self::OutOfRange,
        Self::UnknownValue,
        Self::TooMany,
    ];

    const fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::Incomplete => {
                c"done without some obstacles: a number of theirs is unusable, or there is no room for them"
            }
            Self::Null => c"a pointer is null",
            Self::WrongSize => {
                c"the size at the beginning of a structure is not that of this version of the library"
            }
            Self::WrongVersion => {
                c"the caller was compiled with the header of another version of the interface"
            }
            Self::Misaligned => c"a pointer is not aligned for what it points to",
            Self::StorageTooSmall => c"the storage is too small",
            Self::Aliased => c"two of the pointers lead to memory that overlaps",
            Self::NotInitialized => {
                c"the storage holds no such object: it was never initialized, or it was moved"
            }
            Self::Busy => c"another call is at work on this object",
            Self::OutOfRange => {
                c"a number is not finite or out of range; the refusal names it"
            }
            Self::UnknownValue => {
                c"a number stands for none of the values of its enumeration; the refusal names it"
            }
            Self::TooMany => c"more than there is room for; the refusal names it",
        }
    }
}

/// The sentence of a status, for logs; never null, and valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn fga_status_text(status: u32) -> *const c_char {
    let known = fga_status::ALL
        .into_iter()
        .find(|&known| known as u32 == status);
    known
        .map_or(c"no status of this library", fga_status::text)
        .as_ptr()
}

/// Bytes of `fga_refusal::field`, with the zero at its end.
pub const FGA_REFUSAL_FIELD_BYTES: usize = 48;

/// Bytes of `fga_refusal::expected`, with the zero at its end.
pub const FGA_REFUSAL_EXPECTED_BYTES: usize = 80;

/// What was refused, written by a call that answers `FGA_STATUS_OUT_OF_RANGE`, `FGA_STATUS_UNKNOWN_VALUE` or
/// `FGA_STATUS_TOO_MANY`; by a step also for the first obstacle that it ignores.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_refusal {
    /// `sizeof(fga_refusal)`.
    pub size: u32,
    /// Index in its list, of a waypoint, an obstacle or a stage; otherwise 0.
    pub index: u32,
    /// The value.
    pub value: f64,
    /// Name of the field or the argument.
    pub field: [c_char; FGA_REFUSAL_FIELD_BYTES],
    /// What was expected, in words.
    pub expected: [c_char; FGA_REFUSAL_EXPECTED_BYTES],
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_refusal {}

/// A refusal on its way to the caller.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Refused {
    pub(crate) status: fga_status,
    index: u32,
    value: f64,
    field: &'static str,
    expected: &'static str,
}

impl From<fga_status> for Refused {
    fn from(status: fga_status) -> Self {
        Self {
            status,
            index: 0,
            value: 0.0,
            field: "",
            expected: "",
        }
    }
}

impl From<SettingsError> for Refused {
    fn from(error: SettingsError) -> Self {
        let field = match error.name {
            "C_s" => "start_score",
            name => name,
        };
        Self::out_of_range(field, error.value, error.expected)
    }
}

impl Refused {
    pub(crate) const fn out_of_range(
        field: &'static str,
        value: f64,
        expected: &'static str,
    ) -> Self {
        Self {
            status: fga_status::OutOfRange,
            index: 0,
            value,
            field,
            expected,
        }
    }

    pub(crate) fn unknown(field: &'static str, value: u32, expected: &'static str) -> Self {
        Self {
            status: fga_status::UnknownValue,
            ..Self::out_of_range(field, f64::from(value), expected)
        }
    }

    pub(crate) fn too_many(field: &'static str, value: u32, expected: &'static str) -> Self {
        Self {
            status: fga_status::TooMany,
            ..Self::out_of_range(field, f64::from(value), expected)
        }
    }

    /// Whether it names a field.
    pub(crate) const fn is_named(&self) -> bool {
        !self.field.is_empty()
    }

    /// The same about one of a list.
    pub(crate) fn at(self, index: usize) -> Self {
        Self {
            index: u32::try_from(index).unwrap_or(u32::MAX),
            ..self
        }
    }

    /// The same with another status.
    pub(crate) const fn with(self, status: fga_status) -> Self {
        Self { status, ..self }
    }

    /// As the caller reads it; what does not fit is cut off.
    pub(crate) fn written(&self) -> fga_refusal {
        let mut refusal = fga_refusal {
            size: size_word::<fga_refusal>(),
            index: self.index,
            value: self.value,
            field: [0; FGA_REFUSAL_FIELD_BYTES],
            expected: [0; FGA_REFUSAL_EXPECTED_BYTES],
        };
        copy(self.field, &mut refusal.field);
        copy(self.expected, &mut refusal.expected);
        refusal
    }
}

/// Copies a text as UTF-8, and leaves a zero at the end.
fn copy(text: &str, into: &mut [c_char]) {
    let mut fits = text.len().min(into.len().saturating_sub(1));
    while !text.is_char_boundary(fits) {
        fits -= 1;
    }
    for (slot, byte) in into.iter_mut().zip(text.bytes().take(fits)) {
        *slot = c_char::from_ne_bytes([byte]);
    }
}

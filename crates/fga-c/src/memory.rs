//! Memory of the caller: what is checked before anything is read or written, and the unsafe code that does so.
//!
//! Null, misalignment, sizes and overlaps are found here. What no library can find is a pointer to memory that is not there:
//! the header says what each pointer must lead to.

use core::marker::PhantomData;
use core::sync::atomic::{AtomicBool, Ordering};

use crate::floating::by_default;
use crate::growable::{Growable, size_word};
use crate::status::{Refused, fga_refusal, fga_status};

/// The memory that a pointer of the caller leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LentSpan {
    start: usize,
    bytes: usize,
}

impl LentSpan {
    /// No memory.
    pub(crate) const NONE: Self = Self { start: 0, bytes: 0 };

    /// `count` values behind a pointer, which is neither null nor misaligned.
    pub(crate) fn of<T>(pointer: *const T, count: usize) -> Result<Self, fga_status> {
        if pointer.is_null() {
            return Err(fga_status::Null);
        }
        if !pointer.is_aligned() {
            return Err(fga_status::Misaligned);
        }
        let start = pointer.addr();
        let bytes = count.checked_mul(size_of::<T>());
        let fits =
            |&bytes: &usize| isize::try_from(bytes).is_ok() && start.checked_add(bytes).is_some();
        let bytes = bytes.filter(fits).ok_or(fga_status::TooMany)?;
        Ok(Self { start, bytes })
    }

    const fn overlaps(&self, other: &Self) -> bool {
        self.bytes > 0
            && other.bytes > 0
            && self.start < other.start + other.bytes
            && other.start < self.start + self.bytes
    }
}

/// Checks that no two of some spans overlap.
pub(crate) fn apart(spans: &[LentSpan]) -> Result<(), fga_status> {
    let mut rest = spans;
    while let [span, others @ ..] = rest {
        if others.iter().any(|other| span.overlaps(other)) {
            return Err(fga_status::Aliased);
        }
        rest = others;
    }
    Ok(())
}

/// A structure that the caller gives.
///
/// # Safety
/// Behind a pointer that is not null and aligned lies what the caller says: a `u32` at least, and where that is the size
/// of `T`, a `T`.
pub(crate) unsafe fn given<T: Growable>(pointer: *const T) -> Result<(T, LentSpan), fga_status> {
    // SAFETY: as this function.
    let span = unsafe { sized(pointer) }?;
    // SAFETY: not null, aligned, and as large as a `T`, by the line above.
    Ok((unsafe { pointer.read() }, span))
}

/// The memory of a structure of the right size, given or to be written.
///
/// # Safety
/// As [`given`].
pub(crate) unsafe fn sized<T: Growable>(pointer: *const T) -> Result<LentSpan, fga_status> {
    let span = LentSpan::of(pointer, 1)?;
    // SAFETY: not null, aligned for more than a `u32`, and by the trait the first field is one.
    let size = unsafe { pointer.cast::<u32>().read() };
    if size != size_word::<T>() {
        return Err(fga_status::WrongSize);
    }
    Ok(span)
}

/// A list that the caller gives: no pointer is needed for an empty one.
///
/// # Safety
/// Behind a pointer that is not null and aligned lie `count` values, which nobody changes for `'a`.
pub(crate) unsafe fn list<'a, T: Copy>(
    pointer: *const T,
    count: u32,
) -> Result<(&'a [T], LentSpan), fga_status> {
    if count == 0 {
        return Ok((&[], LentSpan::NONE));
    }
    let count = count as usize;
    let span = LentSpan::of(pointer, count)?;
    // SAFETY: not null, aligned, within the address space, and there by the caller's word.
    Ok((unsafe { core::slice::from_raw_parts(pointer, count) }, span))
}

/// Fills a structure of the caller, which a call has checked with [`sized`]: all that is not filled is zero, but the size.
///
/// # Safety
/// [`sized`] has accepted the pointer in this call, and nothing else points into the structure meanwhile.
pub(crate) unsafe fn fill<T: Growable>(pointer: *mut T, fill: impl FnOnce(&mut T)) {
    // SAFETY: a `T` lies there; zeros are a value of it, and then the reference leads to a value.
    unsafe {
        pointer.write_bytes(0, 1);
        pointer.cast::<u32>().write(size_word::<T>());
        fill(&mut *pointer);
    }
}

/// Where a call writes why it refuses: nowhere, or a structure of the caller.
#[derive(Debug)]
struct Why {
    pointer: *mut fga_refusal,
    span: LentSpan,
}

impl Why {
    /// # Safety
    /// As [`given`], with null for a caller that does not ask.
    unsafe fn new(pointer: *mut fga_refusal) -> Result<Self, fga_status> {
        let span = if pointer.is_null() {
            LentSpan::NONE
        } else {
            // SAFETY: as this function.
            unsafe { sized(pointer) }?
        };
        Ok(Self { pointer, span })
    }

    /// The status of what a call came to; a refusal of a value is written down.
    fn answer(&self, done: Result<fga_status, Refused>) -> fga_status {
        match done {
            Ok(status) => status,
            Err(refused) => {
                if refused.is_named() && !self.pointer.is_null() {
                    // SAFETY: `new` has found a refusal there, and nobody else refers to it.
                    unsafe { self.pointer.write(refused.written()) };
                }
                refused.status
            }
        }
    }
}

/// Answers a call. `call` gets the memory in which a refusal is written.
///
/// # Safety
/// As [`Why::new`].
pub(crate) unsafe fn answered(
    why: *mut fga_refusal,
    call: impl FnOnce(LentSpan) -> Result<fga_status, Refused>,
) -> fga_status {
    // SAFETY: as this function.
    match unsafe { Why::new(why) } {
        Ok(why) => why.answer(by_default(|| call(why.span))),
        Err(status) => status,
    }
}

/// Answers a call that works on an object.
///
/// # Safety
/// As [`Object::enter`] and [`Why::new`].
pub(crate) unsafe fn work<T: Kind>(
    object: *mut Object<T>,
    why: *mut fga_refusal,
    work: impl FnOnce(&mut AtWork<'_, T>, LentSpan) -> Result<fga_status, Refused>,
) -> fga_status {
    let enter = |why| {
        // SAFETY: as this function.
        let mut object = unsafe { Object::enter(object) }?;
        work(&mut object, why)
    };
    // SAFETY: as this function.
    unsafe { answered(why, enter) }
}

/// An object in storage that the caller lends.
#[repr(C)]
pub(crate) struct Object<T> {
    /// Its own address, changed by what is in it: found only where such an object was initialized.
    mark: usize,
    busy: AtomicBool,
    /// All of the storage that it uses.
    bytes: usize,
    value: T,
}

/// What is in a storage, for its mark.
pub(crate) trait Kind {
    /// A number of its own.
    const MARK: usize;
}

/// An object at work: nobody else is until it is dropped.
pub(crate) struct AtWork<'a, T> {
    object: *mut Object<T>,
    pub(crate) span: LentSpan,
    lives: PhantomData<&'a mut T>,
}

impl<T: Kind> Object<T> {
    /// Bytes of the object alone.
    pub(crate) const BYTES: usize = size_of::<Self>();

    fn mark_at(pointer: *const Self) -> usize {
        pointer.addr() ^ T::MARK
    }

    /// The storage for an object of a number of bytes in all.
    pub(crate) fn storage(
        storage: *mut u8,
        storage_bytes: usize,
        bytes: usize,
    ) -> Result<(*mut Self, LentSpan), fga_status> {
        let object = storage.cast::<Self>();
        let span = LentSpan::of(object, 1)?;
        if storage_bytes < bytes {
            return Err(fga_status::StorageTooSmall);
        }
        let span = LentSpan { bytes, ..span };
        if span.start.checked_add(bytes).is_none() {
            return Err(fga_status::StorageTooSmall);
        }
        Ok((object, span))
    }

    /// Constructs an object in place, by a function that writes all of its value or fails.
    ///
    /// # Safety
    /// [`Self::storage`] has accepted it, and nobody else uses the storage. After a success of `construct` the value is there.
    pub(crate) unsafe fn init<E>(
        object: *mut Self,
        span: LentSpan,
        construct: impl FnOnce(*mut T) -> Result<(), E>,
    ) -> Result<(), E> {
        // SAFETY: the storage is large enough and aligned; fields are written by address, without a reference to what is not
        // there yet. The mark comes last.
        unsafe {
            (&raw mut (*object).mark).write(0);
            construct(&raw mut (*object).value)?;
            (&raw mut (*object).busy).write(AtomicBool::new(false));
            (&raw mut (*object).bytes).write(span.bytes);
            (&raw mut (*object).mark).write(Self::mark_at(object));
        }
        Ok(())
    }

    /// Begins to work on an object of the caller.
    ///
    /// # Safety
    /// Behind a pointer that is not null and aligned lie as many bytes as an object has.
    pub(crate) unsafe fn enter<'a>(object: *mut Self) -> Result<AtWork<'a, T>, fga_status> {
        let span = LentSpan::of(object, 1)?;
        // SAFETY: not null, aligned and readable by the caller's word. For a wrong caller this reads what happens to lie there:
        // a number, whatever it is.
        if unsafe { (&raw const (*object).mark).read() } != Self::mark_at(object) {
            return Err(fga_status::NotInitialized);
        }
        // SAFETY: the mark says that the object is initialized here.
        let busy = unsafe { &(*object).busy };
        if busy.swap(true, Ordering::Acquire) {
            return Err(fga_status::Busy);
        }
        // SAFETY: the same.
        let bytes = unsafe { (&raw const (*object).bytes).read() };
        Ok(AtWork {
            object,
            span: LentSpan { bytes, ..span },
            lives: PhantomData,
        })
    }
}

impl<T> AtWork<'_, T> {
    /// Its value.
    pub(crate) fn value(&mut self) -> &mut T {
        // SAFETY: initialized, and `busy` keeps every other call out.
        unsafe { &mut (*self.object).value }
    }

    /// The address of a list in the storage, this number of bytes after its beginning.
    pub(crate) const fn list<P>(&self, after_bytes: usize) -> *mut P {
        self.object.wrapping_byte_add(after_bytes).cast()
    }
}

impl<T> Drop for AtWork<'_, T> {
    fn drop(&mut self) {
        // SAFETY: initialized, and set by `enter`.
        unsafe { &(*self.object).busy }.store(false, Ordering::Release);
    }
}

//! Memory that is watched while the library has it.

use fga_c::FGA_ALIGN;

/// Bytes on either side of all that is lent.
const GUARD: usize = 256;

/// What is in them.
const WATCHED: u8 = 0xA5;

/// Memory lent to the library, between guards.
pub(crate) struct Lent {
    pub(crate) bytes: Vec<u8>,
    pub(crate) start: usize,
    pub(crate) len: usize,
}

impl Lent {
    pub(crate) fn new(len: usize, fill: u8) -> Self {
        let mut bytes = vec![WATCHED; len + 2 * GUARD + FGA_ALIGN];
        let start = GUARD + bytes[GUARD..].as_ptr().align_offset(FGA_ALIGN);
        bytes[start..start + len].fill(fill);
        Self { bytes, start, len }
    }

    pub(crate) fn of<T: Copy>(value: T) -> Self {
        let mut lent = Self::new(size_of::<T>(), 0);
        lent.set(value);
        lent
    }

    pub(crate) fn at<T>(&mut self) -> *mut T {
        self.bytes[self.start..].as_mut_ptr().cast()
    }

    pub(crate) fn set<T: Copy>(&mut self, value: T) {
        assert_eq!(self.len, size_of::<T>());
        let at = self.at::<T>();
        // SAFETY: aligned, and as large as a `T`.
        unsafe { at.write(value) };
    }

    pub(crate) fn get<T: Copy>(&mut self) -> T {
        assert_eq!(self.len, size_of::<T>());
        let at = self.at::<T>();
        // SAFETY: a `T` lies there: numbers, which any bytes are.
        unsafe { at.read() }
    }

    pub(crate) fn content(&self) -> &[u8] {
        &self.bytes[self.start..self.start + self.len]
    }

    pub(crate) fn assert_guarded(&self) {
        let outside = self.bytes[..self.start]
            .iter()
            .chain(&self.bytes[self.start + self.len..]);
        assert!(
            outside.copied().all(|byte| byte == WATCHED),
            "written outside of what is lent"
        );
    }
}

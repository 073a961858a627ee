//! A list of fixed capacity.

/// At most `N` items in order: a slice of them.
#[derive(Debug, Clone, Copy)]
pub struct List<T, const N: usize> {
    all: [T; N],
    len: usize,
}

impl<T: Copy, const N: usize> List<T, N> {
    /// No items; `filler` is in none of its answers.
    pub const fn new(filler: T) -> Self {
        Self {
            all: [filler; N],
            len: 0,
        }
    }

    /// Forgets all.
    pub const fn clear(&mut self) {
        self.len = 0;
    }

    /// Keeps only the first items.
    pub fn truncate(&mut self, most: usize) {
        self.len = self.len.min(most);
    }

    /// Puts an item at an index: replaces one, or appends behind the last one. False for any other index.
    pub fn put(&mut self, place: usize, item: T) -> bool {
        let slot = self.all.get_mut(place).filter(|_| place <= self.len);
        let fits = slot.map(|slot| *slot = item).is_some();
        self.len = self.len.max((place + 1) * usize::from(fits));
        fits
    }

    /// Appends an item: its index, or `None` without room.
    pub fn push(&mut self, item: T) -> Option<usize> {
        let place = self.len;
        self.put(place, item).then_some(place)
    }
}

impl<T: PartialEq, const N: usize> PartialEq for List<T, N> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T, const N: usize> core::ops::Deref for List<T, N> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        self.all.get(..self.len).unwrap_or(&[])
    }
}

impl<T, const N: usize> core::ops::DerefMut for List<T, N> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        self.all.get_mut(..self.len).unwrap_or(&mut [])
    }
}

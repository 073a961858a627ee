//! A bounded memory of aircraft.

use std::collections::HashMap;

/// A memory for at most `MOST` addresses.
///
/// It has two generations: a used entry moves to the young one; when that is full it becomes the old
/// one, and the previous old one is forgotten. Each call is a few look-ups, however many addresses the
/// network invents. An address in use is forgotten only when as many others as half the bound come
/// between two of its messages.
#[derive(Debug, Clone, Default)]
pub struct Generations<T, const MOST: usize> {
    young: HashMap<u32, T>,
    old: HashMap<u32, T>,
}

impl<T: Default, const MOST: usize> Generations<T, MOST> {
    /// Addresses held.
    pub fn len(&self) -> usize {
        self.young.len() + self.old.len()
    }

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.young.is_empty() && self.old.is_empty()
    }

    /// The entry of an address; the default for an unknown one.
    pub fn entry(&mut self, address: u32) -> &mut T {
        if !self.young.contains_key(&address) && self.young.len() >= (MOST / 2).max(1) {
            self.old = core::mem::take(&mut self.young);
        }
        let Self { young, old, .. } = self;
        young
            .entry(address)
            .or_insert_with(|| old.remove(&address).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::Generations;

    #[test]
    fn an_address_in_use_survives_a_flood() {
        let mut memory = Generations::<u32, 100>::default();
        *memory.entry(7) = 1;
        for address in 1000..2000 {
            *memory.entry(address) = 2;
            if address % 40 == 0 {
                assert_eq!(*memory.entry(7), 1);
            }
            assert!(memory.len() <= 100);
        }
        for address in 1000..1200 {
            memory.entry(address);
        }
        assert_eq!(*memory.entry(7), 0, "forgotten");
    }
}

//! The obstacles of one encounter.

/// Identifiers of the obstacles of one encounter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Against {
    ids: [u32; 16],
    len: usize,
}

impl Against {
    /// Adds an identifier. Once full, every identifier counts as contained.
    pub fn add(&mut self, id: u32) {
        if let Some(slot) = self.ids.get_mut(self.len) {
            *slot = id;
            self.len += 1;
        }
    }

    /// Whether an id is among them.
    pub fn contains(&self, id: u32) -> bool {
        self.len == self.ids.len() || self.ids.iter().take(self.len).any(|held| *held == id)
    }
}

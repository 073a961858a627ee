//! The memory of kept obstacles, and a tree over the moments at which each must be looked at.

use crate::situation::{Movement, Obstacle, ProtectedVolume};
use fga_proof::Vec3;

/// Obstacles of a block, and children of a node of the tree.
const WIDTH: usize = 16;

/// Most levels of the tree: 16⁷ blocks.
const LEVELS: usize = 7;

/// No slot.
pub(super) const NONE: u32 = u32::MAX;

/// The moment of an obstacle that is due in every step.
pub(super) const ALWAYS: f64 = f64::NEG_INFINITY;

/// Memory for [`Block::OBSTACLES`] kept obstacles, to be lent to a [`Kept`](super::Kept): some 3 kB.
#[derive(Debug, Clone)]
pub struct Block {
    slots: [Slot; WIDTH],
    /// The moment at which each must be looked at, seconds on the clock of the watch.
    due_s: [f64; WIDTH],
    /// Nodes of the tree: the earliest moment of their children.
    node_s: [f64; WIDTH],
}

impl Block {
    /// The number of obstacles for which it has room.
    pub const OBSTACLES: usize = WIDTH;

    /// Without obstacles.
    pub const EMPTY: Self = Self {
        slots: [Slot::EMPTY; WIDTH],
        due_s: [f64::INFINITY; WIDTH],
        node_s: [f64::INFINITY; WIDTH],
    };
}

/// Memory for one obstacle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub(super) obstacle: Obstacle,
    /// The time of its report, seconds.
    pub(super) reported_s: f64,
    pub(super) is_used: bool,
    /// The next slot of those whose identifiers have one hash, or the next free one.
    pub(super) next: u32,
    /// The first slot of those whose identifiers' hash is the index of this slot.
    pub(super) first: u32,
    /// Its place in the list of obstacles ahead.
    pub(super) place: u32,
    /// The slot that stands at this place of that list.
    pub(super) listed: u32,
}

impl Slot {
    const EMPTY: Self = Self {
        obstacle: Obstacle::straight(
            0,
            Vec3::ZERO,
            Vec3::ZERO,
            ProtectedVolume::Sphere { radius_m: 0.0 },
        ),
        reported_s: 0.0,
        is_used: false,
        next: NONE,
        first: NONE,
        place: NONE,
        listed: NONE,
    };

    /// Whether the obstacle stays where it was reported.
    pub(super) const fn is_at_rest(&self) -> bool {
        matches!(self.obstacle.movement, Movement::AtRest)
    }

    /// The obstacle at a time: straight on from its report, its position as uncertain as its velocity has made it.
    pub(super) fn at(&self, time_s: f64) -> Obstacle {
        let mut obstacle = self.obstacle;
        let age_s = time_s - self.reported_s;
        if !self.is_at_rest() {
            obstacle.position_m = obstacle.position_after_m(age_s);
        }
        obstacle.age_s += age_s.max(0.0);
        let uncertainty = &mut obstacle.uncertainty;
        uncertainty.position_m += uncertainty.velocity_mps * age_s.max(0.0);
        obstacle
    }
}

/// The blocks, and the levels of the tree: the leaves are the moments of the slots.
#[derive(Debug)]
pub(super) struct Memory<'m> {
    blocks: &'m mut [Block],
    /// First block and number of groups of nodes of each level.
    levels: [(usize, usize); LEVELS],
    /// Number of levels.
    height: usize,
}

impl<'m> Memory<'m> {
    pub(super) fn new(blocks: &'m mut [Block]) -> Self {
        let mut levels = [(0, 0); LEVELS];
        let (mut height, mut first, mut groups) = (0, 0, blocks.len());
        for level in &mut levels {
            if groups <= 1 {
                break;
            }
            groups = groups.div_ceil(WIDTH);
            *level = (first, groups);
            first += groups;
            height += 1;
        }
        let mut memory = Self {
            blocks,
            levels,
            height,
        };
        memory.clear();
        memory
    }

    pub(super) fn clear(&mut self) {
        for block in &mut *self.blocks {
            block.slots.fill(Slot::EMPTY);
            block.due_s.fill(f64::INFINITY);
            block.node_s.fill(f64::INFINITY);
        }
    }

    pub(super) const fn capacity(&self) -> usize {
        self.blocks.len() * WIDTH
    }

    pub(super) fn slot(&self, at: u32) -> Option<&Slot> {
        let at = at as usize;
        self.blocks.get(at / WIDTH)?.slots.get(at % WIDTH)
    }

    pub(super) fn slot_mut(&mut self, at: u32) -> Option<&mut Slot> {
        let at = at as usize;
        self.blocks.get_mut(at / WIDTH)?.slots.get_mut(at % WIDTH)
    }

    /// All slots in order.
    pub(super) fn slots(&self) -> impl Iterator<Item = &Slot> {
        self.blocks.iter().flat_map(|block| &block.slots)
    }

    /// A node of the tree: group and place among the children of one parent.
    fn node(&mut self, level: usize, index: usize) -> Option<&mut f64> {
        let (first, groups) = *self.levels.get(level)?;
        let group = index / WIDTH;
        if group >= groups {
            return None;
        }
        let block = self.blocks.get_mut(first + group)?;
        block.node_s.get_mut(index % WIDTH)
    }

    /// Makes the obstacle of a slot due from a moment on: always or never.
    pub(super) fn set_due(&mut self, at: u32, due_s: f64) {
        let mut index = at as usize;
        let leaf = self.blocks.get_mut(index / WIDTH);
        if let Some(leaf) = leaf.and_then(|block| block.due_s.get_mut(index % WIDTH)) {
            *leaf = due_s;
        }
        for level in 0..self.height {
            index /= WIDTH;
            if let Some(node) = self.node(level, index) {
                *node = node.min(due_s);
            }
        }
    }

    /// Makes every obstacle due.
    pub(super) fn wake_all(&mut self) {
        for block in &mut *self.blocks {
            for (due_s, slot) in block.due_s.iter_mut().zip(&block.slots) {
                if slot.is_used {
                    *due_s = ALWAYS;
                }
            }
            block.node_s.fill(ALWAYS);
        }
    }

    /// Looks at each obstacle that is due, in the order of the slots; `look` gives its next moment.
    pub(super) fn each_due(&mut self, now_s: f64, look: &mut impl FnMut(&Slot) -> f64) {
        self.visit(self.height, 0, now_s, look);
    }

    /// The earliest moment in a part of the tree after a look at it.
    fn visit(
        &mut self,
        level: usize,
        group: usize,
        now_s: f64,
        look: &mut impl FnMut(&Slot) -> f64,
    ) -> f64 {
        let mut least_s = f64::INFINITY;
        let Some(below) = level.checked_sub(1) else {
            if let Some(block) = self.blocks.get_mut(group) {
                for (due_s, slot) in block.due_s.iter_mut().zip(&block.slots) {
                    if *due_s <= now_s {
                        *due_s = look(slot);
                    }
                    least_s = least_s.min(*due_s);
                }
            }
            return least_s;
        };
        for index in group * WIDTH..(group + 1) * WIDTH {
            let Some(mut due_s) = self.node(below, index).map(|node| *node) else {
                break;
            };
            if due_s <= now_s {
                due_s = self.visit(below, index, now_s, look);
                if let Some(node) = self.node(below, index) {
                    *node = due_s;
                }
            }
            least_s = least_s.min(due_s);
        }
        least_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use alloc::vec::Vec;

    /// The slots that are looked at at a moment, all of which get another moment.
    fn due(memory: &mut Memory<'_>, now_s: f64, next_s: f64) -> Vec<u32> {
        let mut ids = Vec::new();
        memory.each_due(now_s, &mut |slot| {
            ids.push(slot.obstacle.id);
            next_s
        });
        ids
    }

    /// In one block, in two levels of blocks and in three.
    #[test]
    fn exactly_what_is_due_is_looked_at_in_the_order_of_the_slots() {
        for count in [1_usize, 19, 300] {
            let mut blocks = vec![Block::EMPTY; count];
            let mut memory = Memory::new(&mut blocks);
            let slots = u32::try_from(memory.capacity()).unwrap();
            for at in 0..slots {
                let slot = memory.slot_mut(at).unwrap();
                (slot.obstacle.id, slot.is_used) = (at, true);
            }
            assert!(due(&mut memory, 1e9, 0.0).is_empty());
            let some: Vec<u32> = (0..slots).filter(|at| at % 7 == 3).collect();
            for at in some.iter().rev() {
                memory.set_due(*at, ALWAYS);
            }
            assert_eq!(due(&mut memory, 0.0, 5.0), some);
            assert!(due(&mut memory, 4.0, 9.0).is_empty());
            assert_eq!(due(&mut memory, 5.0, 9.0), some);
            memory.set_due(some[0], f64::INFINITY);
            assert_eq!(due(&mut memory, 9.0, 9.0), some[1..]);
            memory.wake_all();
            assert_eq!(due(&mut memory, 0.0, 1.0).len(), memory.capacity());
        }
    }

    /// A reported obstacle flies straight on and becomes less certain; one at rest stays.
    #[test]
    fn a_slot_moves_its_obstacle_on() {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let mut slot = Slot::EMPTY;
        slot.obstacle = Obstacle::straight(1, Vec3::ZERO, Vec3::new(20.0, 0.0, 0.0), volume);
        slot.obstacle.uncertainty.velocity_mps = 0.5;
        slot.reported_s = 10.0;
        let later = slot.at(14.0);
        assert_eq!(later.position_m, Vec3::new(80.0, 0.0, 0.0));
        assert_eq!((later.age_s, later.uncertainty.position_m), (4.0, 2.0));
        slot.obstacle.movement = Movement::AtRest;
        assert_eq!(slot.at(14.0).position_m, Vec3::ZERO);
    }
}

//! Obstacles kept from step to step: a step looks only at those that could matter.
//!
//! A bound on the closing speed gives for each obstacle the earliest moment at which it could come within surveillance, or
//! within reach where surveillance has no bound; a step looks at the obstacles whose moment has come. While the aircraft follows
//! a line, a quiet step looks at the obstacles that may come near this line.

mod block;
mod line;
mod watch;

pub use block::Block;

use crate::quiet::LineAhead;
use crate::situation::{Obstacle, Situation};
use block::{ALWAYS, Memory, NONE};
use fga_proof::limit::{FASTEST_MPS, LARGEST_M, LATEST_S};
use line::Line;
use watch::Watch;

/// The obstacles about an aircraft, kept from step to step in memory lent by the caller.
///
/// An obstacle flies straight on from its last report; one [at rest](crate::situation::Movement::AtRest) stays. The standard
/// deviation of its position grows by that of its velocity. So a report is needed only where an obstacle came, turned or left.
///
/// The avoider's `step_kept` takes it. It serves one aircraft: it is slow for others, and as right.
#[derive(Debug)]
pub struct Kept<'m> {
    memory: Memory<'m>,
    len: u32,
    /// The last slot that became free, and the number of slots that were ever used.
    free: u32,
    used: u32,
    watch: Option<Watch>,
    line: Option<Line>,
    /// Number of obstacles that may come near the line.
    ahead: u32,
    /// Obstacles looked at in this step.
    looked: u32,
    /// The time of this step, seconds.
    now_s: f64,
}

/// A report that is not kept; what was kept stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeptError {
    /// There is no room for another obstacle.
    Full {
        /// The number of obstacles for which there is room.
        capacity: usize,
    },
    /// A number of the report is not finite, beyond [`LARGEST_M`] or [`FASTEST_MPS`], or a negative length.
    Unusable {
        /// The obstacle's identifier.
        id: u32,
    },
}

impl core::fmt::Display for KeptError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Full { capacity } => {
                write!(
                    f,
                    "{capacity} obstacles are kept, there is no room for more"
                )
            }
            Self::Unusable { id } => {
                write!(
                    f,
                    "obstacle {id} has an unusable number, expected places up to 1e7 m, speeds up to 1e4 m/s and no negative length"
                )
            }
        }
    }
}

impl core::error::Error for KeptError {}

impl<'m> Kept<'m> {
    /// Without obstacles, with room for [`Block::OBSTACLES`] in each block.
    pub fn new(blocks: &'m mut [Block]) -> Self {
        let most = NONE as usize / Block::OBSTACLES;
        let count = blocks.len().min(most);
        let (blocks, _) = blocks.split_at_mut_checked(count).unwrap_or_default();
        Self {
            memory: Memory::new(blocks),
            len: 0,
            free: NONE,
            used: 0,
            watch: None,
            line: None,
            ahead: 0,
            looked: 0,
            now_s: 0.0,
        }
    }

    /// Number of obstacles.
    pub const fn len(&self) -> usize {
        self.len as usize
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The number of obstacles for which there is room.
    pub const fn capacity(&self) -> usize {
        self.memory.capacity()
    }

    /// Obstacles that the last step looked at; one that it looked at twice counts twice.
    pub const fn looked(&self) -> usize {
        self.looked as usize
    }

    /// All obstacles at a time, in the order in which a step takes them.
    pub fn obstacles(&self, time_s: f64) -> impl Iterator<Item = Obstacle> {
        let used = self.memory.slots().filter(|slot| slot.is_used);
        used.map(move |slot| slot.at(time_s))
    }

    /// Keeps the report of an obstacle at a time on the clock of the situations, in place of one with the same identifier.
    ///
    /// # Errors
    /// An unusable number, or no room; nothing is changed then.
    pub fn put(&mut self, obstacle: &Obstacle, reported_s: f64) -> Result<(), KeptError> {
        let id = obstacle.id;
        if !is_usable(obstacle, reported_s) {
            return Err(KeptError::Unusable { id });
        }
        let at = match self.find(id) {
            Some(at) => at,
            None => self.add(id)?,
        };
        if let Some(slot) = self.memory.slot_mut(at) {
            slot.obstacle = *obstacle;
            slot.reported_s = reported_s;
        }
        self.memory.set_due(at, ALWAYS);
        self.update_listing(at);
        Ok(())
    }

    /// Forgets an obstacle; false if there is none with this identifier.
    pub fn remove(&mut self, id: u32) -> bool {
        let Some(at) = self.find(id) else {
            return false;
        };
        self.unlist(at);
        self.unchain(id, at);
        self.memory.set_due(at, f64::INFINITY);
        if let Some(slot) = self.memory.slot_mut(at) {
            slot.is_used = false;
            slot.next = self.free;
            self.free = at;
        }
        self.len = self.len.saturating_sub(1);
        true
    }

    /// Forgets all obstacles.
    pub fn clear(&mut self) {
        self.memory.clear();
        (self.len, self.free, self.used) = (0, NONE, 0);
        self.ahead = 0;
    }

    /// A step begins.
    pub const fn begin(&mut self, time_s: f64) {
        self.now_s = time_s;
        self.looked = 0;
    }

    /// Shows every obstacle within surveillance and reach, and perhaps others, in order. Returns how many that it does not show
    /// are within surveillance.
    pub fn for_each_near(
        &mut self,
        situation: &Situation<'_>,
        limits: (f64, f64),
        mut take: impl FnMut(&Obstacle),
    ) -> u32 {
        let now_s = self.now_s;
        // The clock of the watch passes with the caller's clock, not with the avoider's.
        let situation = &Situation {
            time_s: now_s,
            ..*situation
        };
        let watched = self.watch.as_mut();
        if !watched.is_some_and(|watch| watch.pass(situation, limits)) {
            self.memory.wake_all();
        }
        let watch = *self
            .watch
            .get_or_insert_with(|| Watch::new(situation, limits));
        let own_m = situation.ownship.position_m;
        let (mut near, mut looked) = (0, 0);
        self.memory.each_due(watch.clock_s, &mut |slot| {
            looked += 1;
            let obstacle = slot.at(now_s);
            let age_s = now_s - slot.reported_s;
            let (due_s, is_near) = watch.next_s(slot, obstacle.position_m, own_m, age_s);
            if is_near {
                near += 1;
                take(&obstacle);
            }
            due_s
        });
        self.looked = self.looked.saturating_add(looked);
        if limits.0.is_finite() {
            0
        } else {
            self.len.saturating_sub(near)
        }
    }

    /// Whether every obstacle stays clear of the line ahead, or is out of surveillance.
    pub fn is_clear_of(&mut self, ahead: &LineAhead) -> bool {
        let line = self.line.as_ref();
        if !line.is_some_and(|line| line.is_followed(ahead, self.now_s)) {
            self.line = Some(Line::new(ahead, self.now_s));
            self.rebuild_list();
        }
        self.looked = self.looked.saturating_add(self.ahead);
        (0..self.ahead).all(|place| {
            let at = self.memory.slot(place).map_or(NONE, |slot| slot.listed);
            let slot = self.memory.slot(at);
            slot.is_none_or(|slot| !ahead.may_meet(&slot.at(self.now_s)))
        })
    }

    /// The slot at which the chain of an identifier's hash begins.
    fn hash(&self, id: u32) -> u32 {
        let scattered = u64::from(id.wrapping_mul(0x9e37_79b1));
        // Below the capacity, which is below 2³².
        ((scattered * self.memory.capacity() as u64) >> 32) as u32
    }

    fn find(&self, id: u32) -> Option<u32> {
        let mut at = self.memory.slot(self.hash(id))?.first;
        while let Some(slot) = self.memory.slot(at) {
            if slot.obstacle.id == id {
                return Some(at);
            }
            at = slot.next;
        }
        None
    }

    /// A slot for a new identifier.
    fn add(&mut self, id: u32) -> Result<u32, KeptError> {
        let capacity = self.memory.capacity();
        let at = if self.free == NONE {
            self.used
        } else {
            self.free
        };
        let Some(next_free) = self.memory.slot(at).map(|slot| slot.next) else {
            return Err(KeptError::Full { capacity });
        };
        if self.free == NONE {
            self.used += 1;
        } else {
            self.free = next_free;
        }
        let hash = self.hash(id);
        let first = self.memory.slot_mut(hash).map(|slot| &mut slot.first);
        let next = first.map_or(NONE, |first| core::mem::replace(first, at));
        if let Some(slot) = self.memory.slot_mut(at) {
            slot.is_used = true;
            slot.next = next;
            slot.place = NONE;
        }
        self.len += 1;
        Ok(at)
    }

    /// Takes a slot out of those with the same hash.
    fn unchain(&mut self, id: u32, at: u32) {
        let next = self.memory.slot(at).map_or(NONE, |slot| slot.next);
        let hash = self.hash(id);
        let Some(head) = self.memory.slot_mut(hash) else {
            return;
        };
        if head.first == at {
            head.first = next;
            return;
        }
        let mut before = head.first;
        while let Some(slot) = self.memory.slot_mut(before) {
            if slot.next == at {
                slot.next = next;
                return;
            }
            before = slot.next;
        }
    }

    /// Lists the obstacles that may come near the line.
    fn rebuild_list(&mut self) {
        self.ahead = 0;
        for at in 0..self.used {
            if let Some(slot) = self.memory.slot_mut(at) {
                slot.place = NONE;
            }
            if self.memory.slot(at).is_some_and(|slot| slot.is_used) {
                self.update_listing(at);
            }
        }
        self.looked = self.looked.saturating_add(self.len);
    }

    /// Lists an obstacle, or not, by whether it may come near the line.
    fn update_listing(&mut self, at: u32) {
        let Some((line, slot)) = self.line.as_ref().zip(self.memory.slot(at)) else {
            return;
        };
        let is_listed = slot.place != NONE;
        match (line.may_meet(slot), is_listed) {
            (true, false) => {
                let place = self.ahead;
                self.set_place(at, place);
                self.ahead += 1;
            }
            (false, true) => self.unlist(at),
            _ => {}
        }
    }

    /// Takes an obstacle off the list; the last one gets its place.
    fn unlist(&mut self, at: u32) {
        let Some(slot) = self.memory.slot_mut(at).filter(|slot| slot.place != NONE) else {
            return;
        };
        let place = core::mem::replace(&mut slot.place, NONE);
        self.ahead = self.ahead.saturating_sub(1);
        let last = self
            .memory
            .slot(self.ahead)
            .map_or(NONE, |slot| slot.listed);
        if last != at {
            self.set_place(last, place);
        }
    }

    fn set_place(&mut self, at: u32, place: u32) {
        if let Some(slot) = self.memory.slot_mut(at) {
            slot.place = place;
        }
        if let Some(slot) = self.memory.slot_mut(place) {
            slot.listed = at;
        }
    }
}

/// Whether no sum or product of a report's numbers and those of a usable situation overflows.
fn is_usable(obstacle: &Obstacle, reported_s: f64) -> bool {
    let uncertainty = obstacle.uncertainty;
    let lengths = [
        obstacle.volume.radius_m(),
        obstacle.volume.half_height_m(),
        uncertainty.position_m,
        obstacle.position_m.abs().max_element(),
    ];
    obstacle.is_valid()
        && lengths.iter().all(|length| *length <= LARGEST_M)
        && obstacle.velocity_mps.abs().max_element() <= FASTEST_MPS
        && uncertainty.velocity_mps <= FASTEST_MPS
        && reported_s.abs() <= LATEST_S
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::flying;
    use crate::situation::ProtectedVolume;
    use alloc::vec::Vec;
    use fga_proof::Vec3;

    fn at(id: u32, x_m: f64, y_m: f64) -> Obstacle {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        Obstacle::straight(id, Vec3::new(x_m, y_m, 0.0), Vec3::ZERO, volume)
    }

    fn ids(kept: &Kept<'_>) -> Vec<u32> {
        let mut ids: Vec<u32> = kept.obstacles(0.0).map(|obstacle| obstacle.id).collect();
        ids.sort_unstable();
        ids
    }

    #[test]
    fn a_report_comes_replaces_and_leaves() {
        let mut blocks = [Block::EMPTY];
        let mut kept = Kept::new(&mut blocks);
        // Identifiers of one hash among them.
        for id in 0..16 {
            kept.put(&at(id * 16, 0.0, 0.0), 0.0).unwrap();
        }
        let full = Err(KeptError::Full { capacity: 16 });
        assert_eq!(kept.put(&at(1, 0.0, 0.0), 0.0), full);
        kept.put(&at(32, 7.0, 0.0), 0.0).unwrap();
        assert!(kept.remove(48) && !kept.remove(48));
        assert_eq!((kept.len(), kept.capacity()), (15, 16));
        assert!(!ids(&kept).contains(&48) && ids(&kept).contains(&240));
        let moved = kept.obstacles(0.0).find(|obstacle| obstacle.id == 32);
        assert_eq!(moved.unwrap().position_m.x, 7.0);
        kept.put(&at(1, 0.0, 0.0), 0.0).unwrap();
        let unusable = Err(KeptError::Unusable { id: 2 });
        assert_eq!(kept.put(&at(2, f64::NAN, 0.0), 0.0), unusable);
        kept.clear();
        assert!(kept.is_empty() && ids(&kept).is_empty());
    }

    /// Of three masts one stands in the way, one aside and one out of surveillance.
    #[test]
    fn a_step_looks_at_what_is_near() {
        let mut blocks = [Block::EMPTY];
        let mut kept = Kept::new(&mut blocks);
        for mast in [at(1, 500.0, 10.0), at(2, 500.0, 400.0), at(3, 9e3, 0.0)] {
            kept.put(&mast, 0.0).unwrap();
        }
        let situation = flying(0.0, 0.0, 15.0);
        kept.begin(0.0);
        let mut near = Vec::new();
        let others = kept.for_each_near(&situation, (1000.0, 60.0), |mast| near.push(mast.id));
        near.sort_unstable();
        assert_eq!((near, others, kept.looked()), (alloc::vec![1, 2], 0, 3));
        let ahead = LineAhead {
            position_m: Vec3::ZERO,
            velocity_mps: Vec3::new(15.0, 0.0, 0.0),
            surveillance_radius_m: 1000.0,
            margin_m: 5.0,
            sigmas: 3.0,
            horizon_s: 60.0,
        };
        assert!(!kept.is_clear_of(&ahead));
        kept.remove(1);
        assert!(kept.is_clear_of(&ahead));
        // Along the same line only the one mast ahead needs another look.
        kept.begin(1.0);
        let on = LineAhead {
            position_m: Vec3::new(15.0, 0.0, 0.0),
            ..ahead
        };
        assert!(kept.is_clear_of(&on) && kept.looked() <= 1);
    }
}

//! What climbs towards the largest margin, and from which seeds.

use fga_proof::Vec3;
use fga_proof::list::List;
use fga_proof::meter::{COMPARED, Meter};
use fga_proof::prediction::Flyer;

use super::terms::{ENOUGH_M, Turns};
use super::tuned::{ROUNDS, SEEDS};

/// Most seeds that climb.
pub(super) const CLIMBERS: usize = ROUNDS[0].0;

/// Parameters of a manoeuvre: wait s, turn rad, climb rad, after s, turn rad, climb rad.
pub(super) const PARAMETERS: usize = 6;

/// Natural steps of the parameters, times as the angles turned in them.
const STEPS_RAD: Vector = [0.2, 0.2, 0.1, 0.2, 0.2, 0.1];

/// Most obstacles of a step: the closest ones.
pub(super) const CLOSEST: usize = 8;

pub(super) type Vector = [f64; PARAMETERS];

/// The closest approach to an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Approach {
    pub position_m: Vec3,
    pub margin_m: f64,
    pub at_s: f64,
}

/// The closest approaches to the closest obstacles, in no order, and the places of these.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approaches {
    all: List<Approach, CLOSEST>,
    places: [u8; CLOSEST],
}

impl Approaches {
    pub(super) const NONE: Self = Self {
        all: List::new(Approach {
            position_m: Vec3::ZERO,
            margin_m: 0.0,
            at_s: 0.0,
        }),
        places: [0; CLOSEST],
    };

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (u8, &Approach)> {
        self.places.into_iter().zip(self.all.iter())
    }

    /// The least margin, metres.
    pub(super) fn closest_m(&self) -> f64 {
        (self.all.iter()).fold(ENOUGH_M, |least, a| least.min(a.margin_m))
    }

    /// Adds one, or replaces the farthest if full.
    pub(super) fn note(&mut self, place: u8, new: Approach) {
        let added = self.all.push(new);
        let replaced = || {
            let all = self.all.iter_mut().enumerate();
            let farthest = all.max_by(|(_, a), (_, b)| a.margin_m.total_cmp(&b.margin_m));
            let (index, farthest) = farthest.filter(|(_, it)| it.margin_m > new.margin_m)?;
            *farthest = new;
            Some(index)
        };
        if let Some(slot) = added
            .or_else(replaced)
            .and_then(|at| self.places.get_mut(at))
        {
            *slot = place;
        }
    }
}

/// A manoeuvre to climb from, and about its margin, metres; a place without one has the margin `f64::MIN`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seed {
    pub turns: Turns,
    pub margin_m: f64,
}

/// A climb in progress.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ascent {
    pub at: Vector,
    pub approaches: Approaches,
    /// Half the width of the box of the next step, in units of the natural steps.
    pub size: f64,
    /// The margin of its seed, metres, and the seed's place.
    seed_m: f64,
    pub seed: u8,
    pub used: u8,
    pub done: bool,
}

impl Ascent {
    pub(super) const NONE: Self = Self {
        at: [0.0; PARAMETERS],
        approaches: Approaches::NONE,
        size: 0.0,
        seed_m: 0.0,
        seed: 0,
        used: 0,
        done: false,
    };

    /// Whether it climbs from any manoeuvre.
    pub(super) const fn is_some(&self) -> bool {
        self.used > 0
    }

    /// From the manoeuvre at a place.
    fn new(seed: &Seed, place: u8) -> Self {
        Self {
            at: to_vector(&seed.turns),
            size: 1.0,
            seed_m: seed.margin_m,
            seed: place,
            used: if seed.turns.second.is_some() { 6 } else { 3 },
            ..Self::NONE
        }
    }

    /// The least margin so far, metres, not yet certified; without a manoeuvre the least number.
    pub(super) fn least_m(&self) -> f64 {
        if !self.is_some() {
            f64::MIN
        } else if self.approaches.len() == 0 {
            self.seed_m
        } else {
            self.approaches.closest_m()
        }
    }
}

/// Sorts some, the highest first, without a copy of any.
#[inline(never)]
pub(super) fn sort(climbers: &mut [Ascent]) {
    for count in 1..=climbers.len() {
        let Some([before @ .., last]) = climbers.get_mut(..count) else {
            return;
        };
        let mut higher = last;
        for lower in before.iter_mut().rev() {
            if lower.least_m() >= higher.least_m() {
                break;
            }
            core::mem::swap(lower, higher);
            higher = lower;
        }
    }
}

/// Natural steps of the parameters.
pub(super) fn scales(flyer: &Flyer) -> Vector {
    let [wait, turn, climb, after, turn2, climb2] = STEPS_RAD;
    let rate = flyer.course_rate_radps();
    [wait / rate, turn, climb, after / rate, turn2, climb2]
}

fn to_vector(turns: &Turns) -> Vector {
    let second = turns.second.unwrap_or_default();
    [
        turns.wait_s,
        turns.turn_rad,
        turns.climb_rad,
        second.after_s,
        second.turn_rad,
        second.climb_rad,
    ]
}

/// The best seeds, one of each row, and what climbs from them.
#[derive(Debug, Clone)]
pub(super) struct Climbs {
    pub seeds: [Seed; SEEDS],
    pub climbers: [Ascent; CLIMBERS],
}

impl Climbs {
    pub(super) const NONE: Self = Self {
        seeds: [Seed {
            turns: Turns {
                wait_s: 0.0,
                turn_rad: 0.0,
                climb_rad: 0.0,
                second: None,
            },
            margin_m: 0.0,
        }; SEEDS],
        climbers: [Ascent::NONE; CLIMBERS],
    };

    /// Forgets all from a place on.
    pub(super) fn clear(&mut self, from: usize) {
        for seed in self.seeds.iter_mut().skip(from) {
            seed.margin_m = f64::MIN;
        }
    }

    /// Replaces the least one if it is less.
    pub(super) fn take(&mut self, seed: Seed) {
        let least = self
            .seeds
            .iter_mut()
            .min_by(|a, b| a.margin_m.total_cmp(&b.margin_m));
        if let Some(slot) = least.filter(|least| least.margin_m < seed.margin_m) {
            *slot = seed;
        }
    }

    /// The margin of the least one, which others have to exceed, metres.
    pub(super) fn floor_m(&self) -> f64 {
        self.seeds
            .iter()
            .fold(f64::INFINITY, |least, seed| least.min(seed.margin_m))
    }

    /// Begins to climb from the best seeds, as far as a meter allows.
    pub(super) fn begin(&mut self, meter: &Meter) {
        let mut is_given = true;
        for place in 0..CLIMBERS {
            is_given = is_given && meter.take(SEEDS / COMPARED);
            let seed = is_given.then(|| self.best_at(place)).flatten();
            let climber = seed.zip(u8::try_from(place).ok());
            let climber = climber.map_or(Ascent::NONE, |(seed, place)| Ascent::new(seed, place));
            if let Some(slot) = self.climbers.get_mut(place) {
                *slot = climber;
            }
        }
    }

    /// Moves the best one from a place on to there.
    pub(super) fn best_at(&mut self, place: usize) -> Option<&mut Seed> {
        let rest = self.seeds.get_mut(place..)?;
        let best = (rest.iter().enumerate()).max_by(|a, b| a.1.margin_m.total_cmp(&b.1.margin_m));
        let (from, best) = best.filter(|(_, best)| best.margin_m > f64::MIN)?;
        let mut moved = *best;
        for slot in rest.iter_mut().take(from + 1) {
            core::mem::swap(slot, &mut moved);
        }
        rest.first_mut()
    }
}

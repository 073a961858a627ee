//! The values that are free of conflicts with some aircraft.

use crate::bands::intervals::Intervals;
use crate::bands::met::{meetings, meetings_once};
use crate::bands::picture::{Contribution, Picture};
use crate::bands::pool::{Key, level_key};
use crate::bands::quantity::QuantityBands;
use crate::bands::search::Task;
use crate::bands::span::Span;
use crate::bands::ways::Search;
use crate::volume::{Cylinder, Volume};
use alloc::vec::Vec;

/// The volume that counts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kept {
    /// Each aircraft's own volume.
    Own,
    /// A cylinder instead.
    Cylinder(Cylinder),
}

/// Whether some value is free of conflicts with an aircraft; `whole` are all values that are searched.
pub(super) fn frees_some(
    search: &Search,
    task: &Task,
    span: &Span,
    whole: &Intervals,
    free: &mut Intervals,
) -> bool {
    if !search.some_free(task, span, free) {
        return false;
    }
    if whole.overlaps(free) {
        return true;
    }
    // A part is enough unless its edges count as one.
    search.free(task, span, free);
    whole.overlaps(free)
}

impl QuantityBands {
    /// The values free of conflicts with these aircraft.
    pub(super) fn free_of(
        &mut self,
        picture: &Picture,
        span: &Span,
        aircraft: &[Contribution],
        kept: Kept,
    ) -> Intervals {
        let mut free = span.whole();
        let mut of_one = Intervals::default();
        for contribution in aircraft {
            let searched = self.search_of(picture, contribution, kept, |search, task| {
                search.free(task, span, &mut of_one);
            });
            if searched.is_none() {
                continue;
            }
            free.intersect(&of_one);
            if free.is_empty() {
                break;
            }
        }
        free
    }

    /// Whether some value is free of a cylinder around these aircraft.
    pub(super) fn frees_any(
        &mut self,
        picture: &Picture,
        span: &Span,
        aircraft: &[Contribution],
        cylinder: Cylinder,
    ) -> bool {
        let kept = Kept::Cylinder(cylinder);
        if let [one] = aircraft {
            let (whole, mut free) = (span.whole(), Intervals::default());
            let found = self.search_of(picture, one, kept, |search, task| {
                frees_some(search, task, span, &whole, &mut free)
            });
            if let Some(found) = found {
                return found;
            }
        }
        !self.free_of(picture, span, aircraft, kept).is_empty()
    }

    /// Asks a search against one aircraft; `None` for one that contributes nothing.
    pub(super) fn search_of<T>(
        &mut self,
        picture: &Picture,
        contribution: &Contribution,
        kept: Kept,
        ask: impl FnOnce(&Search, &Task) -> T,
    ) -> Option<T> {
        let settings = picture.settings;
        let intruder = contribution.intruder;
        let level = contribution.level(settings)?;
        let met = picture.met(intruder)?;
        let cylinder;
        let (volume, key) = match kept {
            Kept::Own => (
                &level.volume,
                level_key(settings, contribution.alerter, contribution.level),
            ),
            Kept::Cylinder(kept) => {
                cylinder = Volume::Cylinder(kept);
                (&cylinder, Key::Cylinder(kept))
            }
        };
        let task = Task {
            from_s: 0.0,
            until_s: contribution.horizon_s,
        };
        let lines = self.ways.lines();
        let place = self.pool.ensure(intruder, (volume, key), lines);
        let meetings = meetings(&met, volume, lines, self.pool.windows(place));
        Some(ask(&self.ways.search(&meetings, None), &task))
    }

    /// Whether some values are surely free of a cylinder around these aircraft, found without looking at all
    /// values.
    ///
    /// Two neighbouring values that lead past all aircraft are such a part, unless it lies on an edge of the
    /// scale or the resolution of edges swallows it.
    pub(super) fn surely_frees_any(
        &self,
        picture: &Picture,
        span: &Span,
        aircraft: &[Contribution],
        cylinder: Cylinder,
    ) -> bool {
        let volume = Volume::Cylinder(cylinder);
        let lines = self.ways.lines();
        let met = aircraft.iter().filter_map(|contribution| {
            contribution.level(picture.settings)?;
            let met = picture.met(contribution.intruder)?;
            let task = Task {
                from_s: 0.0,
                until_s: contribution.horizon_s,
            };
            Some((meetings_once(&met, &volume, lines), task))
        });
        let met: Vec<_> = met.collect();
        let neighbors = self.ways.common_neighbors(&met, span);
        span.tells_steps_apart()
            && neighbors.is_some_and(|(low, high)| {
                span.is_circular || (span.modulus == 0.0 && span.min <= low && high <= span.max)
            })
    }

    /// Whether an intruder is in a cylinder already, or is met before a maneuver begins: then
    /// nothing is free of it.
    pub(super) fn is_blocked_at_once(
        &self,
        picture: &Picture,
        aircraft: &[Contribution],
        cylinder: Cylinder,
    ) -> bool {
        let volume = Volume::Cylinder(cylinder);
        let lines = self.ways.lines();
        aircraft.iter().any(|contribution| {
            let task = Task {
                from_s: 0.0,
                until_s: contribution.horizon_s,
            };
            picture.met(contribution.intruder).is_some_and(|met| {
                let meetings = meetings_once(&met, &volume, lines);
                self.ways.search(&meetings, None).is_blocked_at_once(&task)
            })
        })
    }
}

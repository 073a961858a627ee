//! The values that are free of conflicts with some aircraft.

use crate::bands::intervals::Intervals;
use crate::bands::met::{Met, meetings_once};
use crate::bands::pool::{Key, WindowPool, level_key};
use crate::bands::search::Task;
use crate::bands::span::Span;
use crate::bands::ways::{Search, Ways};
use crate::bands::{Contribution, Picture, QuantityBands};
use crate::volume::{Cylinder, Volume};

/// Volumes that count instead of the aircraft's own.
#[derive(Debug, Clone, Copy)]
pub(super) enum Instead {
    /// Each aircraft's own volume.
    Own,
    /// A cylinder.
    Cylinder(Cylinder),
    /// A cylinder until a time, each aircraft's own volume afterwards.
    Until(Cylinder, f64),
}

impl QuantityBands {
    /// The values free of conflicts with these aircraft.
    pub(super) fn free_of(
        &mut self,
        picture: &Picture,
        span: &Span,
        aircraft: &[Contribution],
        instead: Instead,
    ) -> Intervals {
        let mut free = span.whole();
        let mut of_one = Intervals::default();
        for contribution in aircraft {
            let searched = self.search_of(picture, contribution, instead, |search, task| {
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

    /// Whether some value is free of conflicts with these aircraft.
    pub(super) fn frees_any(
        &mut self,
        picture: &Picture,
        span: &Span,
        aircraft: &[Contribution],
        instead: Instead,
    ) -> bool {
        if let [one] = aircraft {
            let mut free = span.whole();
            let mut some = Intervals::default();
            let found = self.search_of(picture, one, instead, |search, task| {
                search.some_free(task, span, &mut some)
            });
            free.intersect(&some);
            match found {
                Some(false) => return false,
                // A part is enough unless its edges count as one.
                Some(true) if !free.is_empty() => return true,
                _ => {}
            }
        }
        !self.free_of(picture, span, aircraft, instead).is_empty()
    }

    /// Asks a search against one aircraft; `None` for one that contributes nothing.
    pub(super) fn search_of<T>(
        &mut self,
        picture: &Picture,
        contribution: &Contribution,
        instead: Instead,
        ask: impl FnOnce(&Search, &Task) -> T,
    ) -> Option<T> {
        let settings = picture.settings;
        let intruder = contribution.intruder;
        let level = contribution.level(settings)?;
        let met = picture.met(intruder)?;
        let own_key = level_key(settings, contribution.alerter, contribution.level);
        let horizon_s = contribution.horizon_s;
        let (cylinder, is_own, from_s) = match instead {
            Instead::Own => (None, true, 0.0),
            Instead::Cylinder(cylinder) => (Some(cylinder), false, 0.0),
            // Beyond the aircraft's horizon only the cylinder counts.
            Instead::Until(cylinder, time_s) if time_s > horizon_s => (Some(cylinder), false, 0.0),
            Instead::Until(cylinder, time_s) => (Some(cylinder), true, time_s),
        };
        let cylinder_volume = cylinder.map(Volume::Cylinder);
        let cylinder = cylinder_volume.as_ref().zip(cylinder.map(Key::Cylinder));
        let own = is_own.then_some((&level.volume, own_key));
        // The cylinder counts before the alerter's volume, or without it.
        let (later, before) = match own {
            Some(own) => (own, cylinder),
            None => (cylinder?, None),
        };
        let task = Task {
            from_s,
            until_s: horizon_s,
        };
        let search = Self::search(
            &self.ways,
            &mut self.pool,
            &met,
            (intruder, &task),
            later,
            before,
        );
        Some(ask(&search, &task))
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
        let neighbors = self.ways.common_neighbors(met, span);
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
                self.ways
                    .search(meetings, None, None)
                    .is_blocked_at_once(&task)
            })
        })
    }

    /// A search against one intruder; its windows, and the openings between two volumes, are found once.
    pub(super) fn search<'a>(
        ways: &'a Ways,
        pool: &'a mut WindowPool,
        met: &Met<'a>,
        (intruder, task): (usize, &Task),
        later: (&'a Volume, Key),
        before: Option<(&'a Volume, Key)>,
    ) -> Search<'a> {
        let lines = ways.lines();
        let mut place =
            |(volume, key): (&Volume, Key)| pool.ensure(intruder, key, met, volume, lines);
        let (later_place, before_place) = (place(later), before.map(place));
        let open_place =
            later_place
                .zip(before_place.flatten())
                .zip(before)
                .map(|(places, (volume, _))| {
                    pool.ensure_open(places, task.until_s, |pool, openings| {
                        let later = pool.meetings(later_place, met, later.0, lines);
                        let before = pool.meetings(before_place.flatten(), met, volume, lines);
                        ways.open(&later, &before, task, openings);
                    })
                });
        let pool = &*pool;
        let openings = open_place.and_then(|place| pool.openings(place));
        let before = before.zip(before_place);
        let before = before.map(|((volume, _), place)| pool.meetings(place, met, volume, lines));
        let later = pool.meetings(later_place, met, later.0, lines);
        ways.search(later, before, openings)
    }
}

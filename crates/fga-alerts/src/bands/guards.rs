//! When recovery may change from a cylinder around the aircraft to their own volumes.

use crate::bands::free::frees_some;
use crate::bands::intervals::Intervals;
use crate::bands::level::{LevelSearch, Levels, Target};
use crate::bands::met::Meeting;
use crate::bands::opening::{Opening, Openings};
use crate::bands::path::Fan;
use crate::bands::search::Task;
use crate::bands::span::Span;
use crate::bands::steps::Steps;
use crate::bands::ways::{Search, Ways};
use crate::settings::Settings;
use alloc::vec::Vec;

/// An aircraft that recovery keeps away from: until a change out of a cylinder, from then on out of its own volume.
pub(super) struct Guard<'a> {
    pub(super) own: [Meeting<'a>; 2],
    pub(super) cylinder: [Meeting<'a>; 2],
    /// Horizon of its conflict, seconds.
    pub(super) horizon_s: f64,
}

impl Guard<'_> {
    fn search<'a>(&'a self, ways: &'a Ways, change_s: f64) -> (Search<'a>, Task) {
        let until_s = self.horizon_s;
        if self.is_always_cylinder(change_s) {
            let from_s = 0.0;
            let search = ways.search(&self.cylinder, None);
            return (search, Task { from_s, until_s });
        }
        let from_s = change_s;
        let search = ways.search(&self.own, Some(&self.cylinder));
        (search, Task { from_s, until_s })
    }

    /// Whether only the cylinder counts: the change lies beyond the aircraft's horizon.
    fn is_always_cylinder(&self, change_s: f64) -> bool {
        change_s > self.horizon_s
    }

    /// The meetings of one side with the own volume, where it counts at all, and with the cylinder.
    fn side(&self, side: usize, change_s: f64) -> Option<(Option<&Meeting<'_>>, &Meeting<'_>)> {
        let own = self.own.get(side)?;
        let own = (!self.is_always_cylinder(change_s)).then_some(own);
        Some((own, self.cylinder.get(side)?))
    }
}

/// The aircraft that recovery keeps away from.
pub(super) struct Guards<'a> {
    pub(super) ways: &'a Ways,
    pub(super) span: &'a Span,
    pub(super) aircraft: Vec<Guard<'a>>,
}

/// Changes at which some value is free.
struct Changes {
    openings: Openings,
    /// Valid after a time and up to another, seconds: the same aircraft's own volumes count.
    valid: (f64, f64),
}

impl Guards<'_> {
    /// The values free of conflicts if recovery changes at a time.
    pub(super) fn free(&self, change_s: f64) -> Intervals {
        let mut free = self.span.whole();
        let mut of_one = Intervals::default();
        for guard in &self.aircraft {
            let (search, task) = guard.search(self.ways, change_s);
            search.free(&task, self.span, &mut of_one);
            free.intersect(&of_one);
            if free.is_empty() {
                break;
            }
        }
        free
    }

    /// Whether any value is free of conflicts if recovery changes at a time.
    fn frees_any(&self, change_s: f64) -> bool {
        match self.aircraft.as_slice() {
            [one] => {
                let (search, task) = one.search(self.ways, change_s);
                let mut free = Intervals::default();
                frees_some(&search, &task, self.span, &self.span.whole(), &mut free)
            }
            _ => !self.free(change_s).is_empty(),
        }
    }

    /// The earliest time, to half a second, after which well clear is possible again.
    pub(super) fn recovery_time_s(&self, settings: &Settings) -> f64 {
        let lookahead_s = settings.lookahead_s;
        let mut changes: Option<Changes> = None;
        let mut is_open = |change_s: f64| {
            if !self.has_openings() {
                return self.frees_any(change_s);
            }
            let known = changes.take().filter(|known| {
                let (after_s, until_s) = known.valid;
                after_s < change_s && change_s <= until_s
            });
            let known = known.unwrap_or_else(|| self.changes(change_s, lookahead_s));
            let is_open = known.openings.is_open(change_s);
            changes = Some(known);
            is_open.unwrap_or_else(|| self.frees_any(change_s))
        };
        let (mut blocked_s, mut open_s) = (0.0, lookahead_s + 1.0);
        let mut tried_s = open_s - 1.0;
        while open_s - blocked_s > 0.5 {
            if is_open(tried_s) {
                open_s = tried_s;
            } else {
                blocked_s = tried_s;
            }
            tried_s = f64::midpoint(blocked_s, open_s);
        }
        if open_s <= lookahead_s {
            lookahead_s.min(open_s + settings.recovery_stability_s)
        } else {
            blocked_s
        }
    }

    /// Whether openings say where a value is free: windows do not depend on the time asked for, and a common part
    /// of the aircraft's free values has two neighbouring values.
    fn has_openings(&self) -> bool {
        self.span.tells_steps_apart()
            && (self.span.is_circular || self.span.modulus == 0.0)
            && self.aircraft.iter().all(|guard| {
                let [own, _] = &guard.own;
                !own.depends_on_time
            })
    }

    /// The changes at which some value is free, among those of which each aircraft's own volume counts as at this
    /// one.
    fn changes(&self, change_s: f64, lookahead_s: f64) -> Changes {
        let mut openings = Openings::new(lookahead_s);
        match self.ways {
            Ways::Fan(fan) => {
                for (side, sign) in [(0, -1.0), (1, 1.0)] {
                    self.add_steps(fan, (side, sign), change_s, &mut openings);
                }
            }
            Ways::Levels(levels) => self.add_levels(levels, change_s, &mut openings),
        }
        let mut valid = (f64::NEG_INFINITY, f64::INFINITY);
        for guard in &self.aircraft {
            if guard.is_always_cylinder(change_s) {
                valid.0 = guard.horizon_s.max(valid.0);
            } else {
                valid.1 = guard.horizon_s.min(valid.1);
            }
        }
        Changes { openings, valid }
    }

    /// Whether two neighbouring values surely are a part of the free ones that has a length.
    fn is_sure(&self, one: f64, other: f64) -> bool {
        let span = self.span;
        span.is_circular || (span.min <= one.min(other) && one.max(other) <= span.max)
    }

    /// Adds the changes at which two neighbouring steps of one side are free.
    fn add_steps(
        &self,
        fan: &Fan,
        (side, sign): (usize, f64),
        change_s: f64,
        openings: &mut Openings,
    ) {
        let aircraft = self.aircraft.iter().filter_map(|guard| {
            let meetings = guard.side(side, change_s)?;
            Some(Steps::new(meetings, guard.horizon_s, fan.step_s))
        });
        let mut aircraft: Vec<Steps> = aircraft.collect();
        let value = |index: usize| self.span.value + sign * self.span.step * index as f64;
        let is_sure = |index: usize| self.is_sure(value(index.saturating_sub(1)), value(index));
        let count = fan.sides.get(side).map_or(0, Vec::len);
        // A few steps say how early a change may be at least: then most of the others need no close look.
        for quarter in 1..=4 {
            let index = (count * quarter / 4).saturating_sub(1);
            if index > 0 && fan.step_s * (index as f64) < openings.best_s() {
                let before = opening_of_all(&mut aircraft, index - 1, openings);
                let here = before.and_then(|before| {
                    Some(before.with(opening_of_all(&mut aircraft, index, openings)?))
                });
                openings.add(here.unwrap_or(Opening::NEVER), is_sure(index));
            }
        }
        let mut before = Opening::NEVER;
        for index in 0..count {
            let Some(here) = opening_of_all(&mut aircraft, index, openings) else {
                let best_s = openings.best_s();
                // The aircraft that closes a step is the first one; perhaps it closes all later ones.
                let closing = aircraft.first();
                if closing.is_some_and(|steps| steps.closes_after(index, best_s, openings.clear_s))
                {
                    return;
                }
                before = Opening::NEVER;
                continue;
            };
            openings.add(before.with(here), is_sure(index));
            before = here;
        }
    }

    /// Adds the changes at which two neighbouring altitudes are free.
    fn add_levels(&self, levels: &Levels, change_s: f64, openings: &mut Openings) {
        let value = |step: i32| self.span.step * f64::from(step) + self.span.min;
        let mut before = Opening::NEVER;
        for (part, target) in levels.parts() {
            let mut here = Opening::ALWAYS;
            for guard in &self.aircraft {
                let Some(meetings) = guard.side(0, change_s) else {
                    continue;
                };
                let best_s = openings.best_s();
                here = here.with(of_target(levels, target, meetings, guard.horizon_s, best_s));
                if here.is_over(openings.clear_s) {
                    here = Opening::NEVER;
                    break;
                }
            }
            let (first, is_long) = (part.first, part.first != part.last);
            openings.add(
                before.with(here),
                self.is_sure(value(first - 1), value(first)),
            );
            if is_long {
                openings.add(here, self.is_sure(value(first), value(first + 1)));
            }
            before = here;
        }
    }
}

/// The changes with which a step is reached and free of all aircraft; `None` for none that matters, and then the
/// aircraft that closes it is moved to the first place.
fn opening_of_all(aircraft: &mut [Steps], index: usize, openings: &Openings) -> Option<Opening> {
    let best_s = openings.best_s();
    let mut here = Opening::ALWAYS;
    for (place, steps) in aircraft.iter_mut().enumerate() {
        here = here.with(steps.opening(index, best_s));
        if here.is_over(openings.clear_s) {
            aircraft.swap(0, place);
            return None;
        }
    }
    Some(here)
}

/// The opening of an altitude against one aircraft.
fn of_target(
    levels: &Levels,
    target: &Target,
    (own, cylinder): (Option<&Meeting>, &Meeting),
    until_s: f64,
    best_s: f64,
) -> Opening {
    let Some(own) = own else {
        let search = LevelSearch {
            levels,
            later: cylinder,
            before: None,
        };
        let from_s = 0.0;
        return Opening::of_cylinder(search.leads_past(target, &Task { from_s, until_s }));
    };
    Opening::of_target([own, cylinder], levels, target, until_s, best_s)
}

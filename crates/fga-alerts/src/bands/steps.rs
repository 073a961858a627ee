//! With which changes of recovery the steps of a fan are reached and free of one aircraft.

use crate::bands::met::Meeting;
use crate::bands::opening::Opening;

/// The steps of one side against one aircraft.
///
/// A step is reached if neither the cylinder is met on the way to it before the change, nor the own volume after it:
/// the change comes before the first step that the cylinder stops at, and after the last one that the own volume
/// does.
pub(super) struct Steps<'a> {
    /// The own volume, where it counts.
    own: Option<&'a Meeting<'a>>,
    cylinder: &'a Meeting<'a>,
    horizon_s: f64,
    step_s: f64,
    /// How many steps were looked at for the first one that the cylinder stops at, and that one.
    first: (usize, Option<usize>),
    /// How many steps were looked at for the last one that the own volume stops at, and that one.
    last: (usize, Option<usize>),
}

impl<'a> Steps<'a> {
    pub(super) fn new(
        (own, cylinder): (Option<&'a Meeting<'a>>, &'a Meeting<'a>),
        horizon_s: f64,
        step_s: f64,
    ) -> Self {
        Self {
            own,
            cylinder,
            horizon_s,
            step_s,
            first: (0, None),
            last: (0, None),
        }
    }

    /// The changes with which a step is reached and free, as far as they are before the best time known.
    pub(super) fn opening(&mut self, index: usize, best_s: f64) -> Opening {
        let mut until_s = self.horizon_s;
        if self.step_s > 0.0 {
            let since_s = self.step_s * index as f64;
            until_s = self.cylinder.met.horizon_s(until_s, since_s);
        }
        let Some(own) = self.own else {
            let is_free =
                self.first_stop(index).is_none() && !self.cylinder.meets_later(index, 0.0, until_s);
            return Opening::of_cylinder(is_free);
        };
        if own.is_surely_on(index, best_s - 2.0 * own.clear_s, until_s) {
            return Opening::NEVER;
        }
        let mut opening = Opening::ALWAYS.after(own.left_s(index, until_s));
        if let Some(last) = self.last_stop(own, index) {
            opening = opening.after(self.step_s * last as f64);
        }
        if opening.begins_after(best_s) {
            return Opening::NEVER;
        }
        if let Some(first) = self.first_stop(index) {
            opening = opening.before(self.step_s * first as f64);
        }
        opening.before(self.cylinder.met_s(index, f64::INFINITY))
    }

    /// Whether no step after one that was looked at is reached with a change before the best time known.
    pub(super) fn closes_after(&self, index: usize, best_s: f64, clear_s: f64) -> bool {
        let first = self.first.1.filter(|first| *first <= index);
        if self.own.is_none() {
            return first.is_some();
        }
        let (count, last) = self.last;
        let mut reached = Opening::ALWAYS;
        if let Some(last) = last.filter(|_| count <= index + 1) {
            reached = reached.after(self.step_s * last as f64);
        }
        if let Some(first) = first {
            reached = reached.before(self.step_s * first as f64);
        }
        reached.is_over(clear_s) || reached.begins_after(best_s)
    }

    /// The first step, up to this one, on the way from which the cylinder is met.
    fn first_stop(&mut self, index: usize) -> Option<usize> {
        let (count, found) = &mut self.first;
        if found.is_none() {
            let mut steps = *count..=index;
            *found = steps.find(|index| is_stop(self.cylinder, *index, self.step_s));
            *count = (*count).max(index + 1);
        }
        found.filter(|first| *first <= index)
    }

    /// The last step, up to this one, on the way from which the own volume is met.
    fn last_stop(&mut self, own: &Meeting, index: usize) -> Option<usize> {
        let (count, known) = match self.last {
            (count, known) if count <= index + 1 => (count, known),
            _ => (0, None),
        };
        let mut steps = (count..=index).rev();
        let found = steps.find(|index| is_stop(own, *index, self.step_s));
        self.last = (index + 1, found.or(known));
        self.last.1
    }
}

/// Whether a volume is met on the way from a step to the next one, within the horizon.
fn is_stop(meeting: &Meeting, index: usize, step_s: f64) -> bool {
    step_s > 0.0
        && index as f64 <= meeting.met.settings.lookahead_s / step_s
        && !meeting.is_surely_off(index, step_s)
        && meeting.meets_on_the_way(index, step_s)
}

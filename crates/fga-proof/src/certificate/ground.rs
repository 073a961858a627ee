//! The ground for the certificate: how close a line comes to it.
//!
//! A flight clears the ground by a margin if all within that margin of it, to each side, up and down, is higher than ground, vertical
//! error and clearance. A piece of a line is clear where its lowest point is above the highest ground within the margin, which a
//! hierarchy knows; otherwise it is halved, until an end of it is too low, or it is so short that it counts as that.

use super::hazard::Line;
use crate::ground::{Binding, Ground};
use crate::meter::{GROUND, Meter};

/// A piece of a line that is as short as this, metres, is not halved.
const SHORT_M: f64 = 0.01;

/// How deep a line comes is known to this, metres.
const DEEP_M: f64 = 0.1;

/// A margin is known to this, metres, or to this share of it.
const KNOWN_M: f64 = 0.01;
const KNOWN_SHARE: f64 = 0.25;

/// Most looks along a line.
const MOST_LOOKS: u32 = 10_000;

impl Ground<'_> {
    /// How high a line over the ground and all within a distance of it is above what it takes to clear the ground, metres, where that is
    /// least, and the moment, seconds after its start: 0 if it clears it; otherwise what is known of it, or anything below a stop.
    pub(super) fn lowest(
        &self,
        line: &Line,
        (beside_m, stop_m): (f64, f64),
        binding: Binding,
        meter: &Meter,
    ) -> (f64, f64) {
        let at_m = |after_s| line.from_m + line.velocity_mps * after_s;
        let short_s = SHORT_M / line.velocity_mps.abs().max_element();
        let (mut from_s, mut step_s) = (0.0, line.duration_s);
        let mut least = (0.0, 0.0);
        for _ in 0..MOST_LOOKS {
            if !meter.take(GROUND) {
                break;
            }
            let to_s = f64::min(from_s + step_s, line.duration_s);
            let known_m = if least.0 < 0.0 { DEEP_M } else { 0.0 };
            let whole_m = self.above_m((at_m(from_s), at_m(to_s)), beside_m, binding);
            if whole_m < least.0 - known_m {
                for after_s in [from_s, to_s] {
                    let above_m = self.above_m((at_m(after_s), at_m(after_s)), beside_m, binding);
                    if above_m < least.0 {
                        least = (above_m, after_s);
                    }
                }
                if least.0 < stop_m {
                    return least;
                }
                if step_s > short_s {
                    step_s *= 0.5;
                    continue;
                }
                least = (whole_m.min(least.0), from_s);
            }
            if to_s >= line.duration_s {
                return (least.0 - known_m, least.1);
            }
            (from_s, step_s) = (to_s, 2.0 * step_s);
        }
        (f64::NEG_INFINITY, from_s)
    }

    /// How deep a line is lower than it takes to clear the ground, metres, negative, where that is most, and the moment, seconds after its
    /// start; 0 if it clears it.
    pub fn deepest(&self, line: &Line, binding: Binding, meter: &Meter) -> (f64, f64) {
        self.lowest(line, (0.0, f64::NEG_INFINITY), binding, meter)
    }

    /// The least margin of a line over the ground, metres, and its moment, seconds, if it is below one; negative, by how deep it is, if it comes
    /// lower than it takes to clear the ground. Minus infinity if the meter refuses work.
    pub fn least_on_line(
        &self,
        line: &Line,
        below_m: f64,
        binding: Binding,
        meter: &Meter,
    ) -> Option<(f64, f64)> {
        let above = |beside_m| self.lowest(line, (beside_m, 0.0), binding, meter);
        let (mut margin_m, mut high_m) = (0.0, below_m.max(0.0));
        let mut found = above(high_m);
        if found.0 >= 0.0 {
            return None;
        }
        let entered = self.deepest(line, binding, meter);
        if entered.0 < 0.0 {
            (margin_m, found) = (entered.0, entered);
        }
        // No margin is larger than a height.
        let lowest_m = line.from_m + line.velocity_mps * found.1;
        high_m = high_m.min(self.above_m((lowest_m, lowest_m), 0.0, binding));
        while margin_m >= 0.0 && high_m - margin_m > KNOWN_M.max(KNOWN_SHARE * margin_m) {
            let between_m = 0.5 * (margin_m + high_m);
            if above(between_m).0 < 0.0 {
                high_m = between_m;
            } else {
                margin_m = between_m;
            }
        }
        if meter.is_spent() {
            margin_m = f64::NEG_INFINITY;
        }
        (margin_m < below_m).then_some((margin_m, line.at_s + found.1))
    }
}

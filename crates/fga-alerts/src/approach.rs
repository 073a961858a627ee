//! The approach of two aircraft along straight lines.

use crate::aircraft::Pair;
use crate::almost::Closeness;
use crate::plane::{modified_tau_s, time_to_closest_s};

impl Pair {
    /// Horizontal distance now, metres.
    pub fn horizontal_separation_m(&self) -> f64 {
        self.plane().0.length()
    }

    /// Vertical distance now, metres.
    pub fn vertical_separation_m(&self) -> f64 {
        self.vertical().0.abs()
    }

    /// Horizontal relative speed, metres per second.
    pub fn horizontal_relative_speed_mps(&self) -> f64 {
        self.plane().1.length()
    }

    /// Vertical relative speed, metres per second.
    pub fn vertical_relative_speed_mps(&self) -> f64 {
        self.vertical().1.abs()
    }

    /// Time to the horizontal closest approach, seconds, 0 where it has passed; `None` without
    /// horizontal relative motion.
    pub fn time_to_closest_s(&self) -> Option<f64> {
        let (s, v) = self.plane();
        time_to_closest_s(s, v).map(|time_s| if time_s > 0.0 { time_s } else { 0.0 })
    }

    /// Horizontal distance at the closest approach from now on, metres; `None` without horizontal
    /// relative motion.
    pub fn distance_at_closest_m(&self) -> Option<f64> {
        let (s, v) = self.plane();
        time_to_closest_s(s, v).map(|time_s| (s + v * time_s.max(0.0)).length())
    }

    /// Least horizontal distance within a time, metres.
    pub fn horizontal_miss_m(&self, within_s: f64) -> f64 {
        let (s, v) = self.plane();
        let time_s = if s.dot(v) < 0.0 {
            time_to_closest_s(s, v).map_or(0.0, |time_s| time_s.min(within_s))
        } else {
            0.0
        };
        (s + v * time_s).length()
    }

    /// Least vertical distance within a time, metres.
    pub fn vertical_miss_m(&self, within_s: f64) -> f64 {
        let (height_m, climb_mps) = self.vertical();
        if height_m * climb_mps >= 0.0 {
            return height_m.abs();
        }
        if -height_m / climb_mps <= within_s {
            0.0
        } else {
            (height_m + within_s * climb_mps).abs()
        }
    }

    /// Time to co-altitude, seconds, negative in the past; `None` without vertical relative motion.
    pub fn time_to_coaltitude_s(&self) -> Option<f64> {
        let (height_m, climb_mps) = self.vertical();
        if Closeness::Rounding.same(climb_mps, 0.0) {
            return None;
        }
        Some(if height_m == 0.0 {
            0.0
        } else {
            -height_m / climb_mps
        })
    }

    /// Modified tau to a distance, seconds; `None` within it or where the aircraft do not
    /// converge.
    pub fn modified_tau_s(&self, distance_m: f64) -> Option<f64> {
        let (s, v) = self.plane();
        if s.length_squared() <= distance_m * distance_m {
            return None;
        }
        modified_tau_s(s, v, distance_m)
    }
}

//! Altitude manoeuvres: accelerate, hold the rate, level out.

use crate::aircraft::State;
use crate::almost::Closeness::Rounding;
use crate::bands::path::{Line, way_m};
use crate::plane::{Crossing, root};
use crate::settings::Settings;

/// A climb or descent to an altitude: accelerate, hold the rate, level out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LevelChange {
    ownship: State,
    target_m: f64,
    /// First and second acceleration, m/s².
    first_mps2: f64,
    second_mps2: f64,
    /// End of the first acceleration, seconds.
    rate_since_s: f64,
    /// Start of the second one.
    rate_until_s: f64,
    /// Time of arrival at the altitude.
    level_since_s: f64,
}

/// Vertical distance until a climb has stopped, metres.
fn braking_way_m(climb_mps: f64, acceleration: f64) -> f64 {
    way_m(climb_mps, acceleration, -climb_mps / acceleration)
}

impl LevelChange {
    /// The change to an altitude at the settings' vertical rate and acceleration, both positive.
    pub(super) fn to(target_m: f64, settings: &Settings, ownship: &State) -> Self {
        let acceleration = settings.vertical_acceleration_mps2;
        let (height_m, climb_mps) = (ownship.position_m.z, ownship.velocity_mps.z);
        let goes_up = target_m >= height_m;
        let against = if goes_up { -acceleration } else { acceleration };
        let same_way = (climb_mps >= 0.0) == goes_up || Rounding.same(climb_mps, 0.0);
        let braking_m = braking_way_m(climb_mps, against);
        if same_way && (target_m - height_m).abs() >= braking_m.abs() {
            return Self::from(target_m, settings, ownship, (height_m, climb_mps, 0.0));
        }
        // First the climb stops; then the change starts from rest.
        let stopping = if same_way { against } else { -against };
        let (rest_m, rest_s) = (braking_way_m(climb_mps, stopping), -climb_mps / stopping);
        Self::from(
            target_m,
            settings,
            ownship,
            (height_m + rest_m, 0.0, rest_s),
        )
    }

    /// A change that begins at a height and climb, later by a delay.
    fn from(
        target_m: f64,
        settings: &Settings,
        ownship: &State,
        (height_m, climb_mps, delay_s): (f64, f64, f64),
    ) -> Self {
        let acceleration = settings.vertical_acceleration_mps2;
        let sign = if target_m >= height_m { 1.0 } else { -1.0 };
        let rate_mps = sign * settings.vertical_rate_mps.abs().max(climb_mps.abs());
        let to_go_m = target_m - height_m;
        let first = if rate_mps >= climb_mps {
            acceleration
        } else {
            -acceleration
        };
        let second = -sign * acceleration;
        let reached_s = (rate_mps - climb_mps) / first;
        let reached_mps = climb_mps + first * reached_s;
        let accelerating_m = way_m(climb_mps, first, reached_s);
        let braking_m = braking_way_m(reached_mps, second);
        let (since_s, until_s, level_s);
        if to_go_m.abs() >= (accelerating_m + braking_m).abs() {
            let hold_s = (to_go_m - accelerating_m - braking_m) / rate_mps;
            since_s = reached_s;
            until_s = reached_s + hold_s;
            level_s = until_s + -rate_mps / second;
        } else {
            // The rate is out of reach: brake from the peak.
            let ratio = first / second;
            let a = 0.5 * first * (1.0 - ratio);
            let b = climb_mps * (1.0 - ratio);
            let c = -climb_mps * climb_mps / (2.0 * second) - to_go_m;
            let late = root(a, b, c, Crossing::Exit);
            let early = root(a, b, c, Crossing::Entry);
            since_s = match (late, early) {
                (Some(late), Some(early)) if late >= 0.0 && early >= 0.0 => late.min(early),
                (Some(late), _) if late >= 0.0 => late,
                (_, Some(early)) => early,
                _ => f64::NAN,
            };
            until_s = since_s;
            level_s = since_s + -(climb_mps + first * since_s) / second;
        }
        Self {
            ownship: *ownship,
            target_m,
            first_mps2: first,
            second_mps2: second,
            rate_since_s: delay_s + since_s,
            rate_until_s: delay_s + until_s,
            level_since_s: delay_s + level_s,
        }
    }

    /// Whether this change, of the same ownship, has the same lines within the horizon as another: up to the rate, which
    /// both hold beyond the horizon.
    pub(super) fn is_flown_as(&self, other: &Self, horizon_s: f64) -> bool {
        let leaves_late = |change: &Self| {
            change.rate_since_s >= 0.0
                && change.rate_until_s > horizon_s
                && change.level_since_s > horizon_s
        };
        self.rate_since_s == other.rate_since_s
            && self.first_mps2 == other.first_mps2
            && leaves_late(self)
            && leaves_late(other)
    }

    /// Calls `take` with each line in the order in which they are flown, and until when it is flown; `None` for a moment,
    /// which is looked at in each second while the vertical speed changes.
    pub(super) fn fly(&self, horizon_s: f64, mut take: impl FnMut(Line, Option<f64>)) {
        let (t1, t2) = (self.rate_since_s, self.rate_until_s);
        let t3 = self.level_since_s + 1.0;
        if !(t1.is_finite() && t2.is_finite() && t3.is_finite()) {
            return take(self.line_at(0.0), Some(f64::INFINITY));
        }
        for time_s in seconds(0.0, libm::floor(t1), horizon_s) {
            take(self.line_at(time_s), None);
        }
        take(self.line_at(t1.max(0.0)), Some(t2));
        for time_s in seconds(libm::ceil(t2), libm::floor(t3), horizon_s) {
            take(self.line_at(time_s), None);
        }
        take(self.line_at(t3.max(0.0)), Some(f64::INFINITY));
    }

    /// The ownship's line at a time.
    fn line_at(&self, time_s: f64) -> Line {
        let (s, v) = (self.ownship.position_m, self.ownship.velocity_mps);
        let (t1, t2, t3) = (self.rate_since_s, self.rate_until_s, self.level_since_s);
        let reached_s = if t1 < 0.0 { 0.0 } else { t3 };
        let (height_m, climb_mps) = if time_s > reached_s {
            (self.target_m, 0.0)
        } else if time_s <= t1 {
            (
                s.z + way_m(v.z, self.first_mps2, time_s),
                v.z + self.first_mps2 * time_s,
            )
        } else {
            let rate_mps = v.z + self.first_mps2 * t1;
            let reached_m = s.z + way_m(v.z, self.first_mps2, t1);
            if time_s <= t2 {
                (reached_m + rate_mps * (time_s - t1), rate_mps)
            } else {
                let braking_s = time_s - t2;
                (
                    reached_m + rate_mps * (t2 - t1) + way_m(rate_mps, self.second_mps2, braking_s),
                    rate_mps + self.second_mps2 * braking_s,
                )
            }
        };
        let position_m = (s + v * time_s).with_z(height_m);
        Line::at(time_s, position_m, v.with_z(climb_mps))
    }

    /// The line of an altitude reached at once.
    pub(super) fn instantly(target_m: f64, ownship: &State) -> Line {
        let (s, v) = (ownship.position_m, ownship.velocity_mps);
        Line::at(0.0, s.with_z(target_m), v.with_z(0.0))
    }
}

/// Whole seconds from one to another, within the horizon.
fn seconds(first_s: f64, last_s: f64, horizon_s: f64) -> impl Iterator<Item = f64> {
    let (first_s, last_s) = (first_s.max(0.0), last_s.min(horizon_s));
    core::iter::successors(Some(first_s), |second_s| Some(second_s + 1.0))
        .take_while(move |second_s| *second_s <= last_s)
}

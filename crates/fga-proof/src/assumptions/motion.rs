//! The possible motions of an aircraft: a turn and changes of climb and speed, as a chain of hazards.
//!
//! Each hazard of a chain has a window of time: chords of the turn, widened by the turn's bow, then a straight line. A change
//! of climb stretches the volume upwards and downwards. A climb may also end at any moment: the volume is stretched over all
//! heights between that of an aircraft that levels off at once and that of one that goes on. All of it may have begun when the
//! aircraft was last reported.

use crate::certificate::{Assumption, Extent, Hazard};
use crate::limit::whole;
use crate::situation::ProtectedVolume;
use crate::{Vec2, Vec3};

/// Duration of a change of climb, seconds.
pub const CLIMB_CHANGES_S: f64 = 20.0;

/// Duration of a change of speed, seconds: that of a turn of 60° at 6 °/s.
pub const SPEED_CHANGES_S: f64 = 10.0;

/// Longest chord of a turn, radians (15°): at 60 m/s and 3°/s it bows by 10 m.
const CHORD_RAD: f64 = 0.27;

/// A turn of an aircraft, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Turn rate, radians per second, left positive.
    pub rate_radps: f64,
    /// How long it turns, seconds.
    pub for_s: f64,
    /// How long it flies straight before, seconds.
    pub later_s: f64,
}

impl Turn {
    /// Number of its chords.
    pub fn chords(&self) -> usize {
        if self.rate_radps == 0.0 {
            return 0;
        }
        whole((self.rate_radps * self.for_s).abs() / CHORD_RAD, 5)
    }
}

/// How heights and speeds may have changed since a report, and may change: by a change of climb, by its end, by a change of speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Changes {
    /// Age of the report, seconds.
    pub age_s: f64,
    /// Change of climb, metres per second.
    pub change_mps: f64,
    /// Half of the climb that may end, metres per second.
    pub end_mps: f64,
    /// The way that a change of speed makes in its time, metres.
    pub speeds_m: f64,
}

impl Hazard {
    /// The same obstacle up to a moment, seconds, as one of the motions of an aircraft.
    #[must_use]
    pub fn possible_until(&self, until_s: f64) -> Self {
        let window_s = (self.window_s.0, until_s.min(self.window_s.1));
        // Nothing is proven beyond its end.
        let stands_for = if until_s < f64::INFINITY {
            Assumption::Compared
        } else {
            Assumption::Possible
        };
        let mut hazard = self.with(|extent| extent.window_s = window_s);
        hazard.stands_for = hazard.stands_for.max(stands_for);
        hazard
    }

    /// Straight flight with the whole change of climb and of speed from the start on.
    #[must_use]
    pub fn straight(&self, changes: &Changes) -> Self {
        let at = changes.report(self);
        self.with(|extent| {
            extent.volume = widened(extent.volume, changes.speeds_m);
            extent.velocity_mps = at.velocity_mps;
            extent.position_m = at.position_m + at.velocity_mps * changes.age_s;
            extent.stretch_m = changes.later_m();
        })
    }

    /// Adds the chain of a turn, then straight on, of a hazard that stretches.
    pub fn motion(&self, turn: &Turn, changes: &Changes, add: &mut impl FnMut(Self)) {
        let mut extent = self.extent;
        let mut at = changes.report(self);
        let begins_s = at.at_s;
        extent.stretch_m = changes.first_m();
        let mut leg = |extent: &Extent, from: &Moment, to: &Moment, rate_radps: f64| {
            add(self.with(|own| *own = from.leg(to, rate_radps, extent)));
        };
        if turn.later_s > 0.0 {
            let next = at.turned(0.0, turn.later_s);
            leg(&extent, &at, &next, 0.0);
            at = next;
        }
        let chords = turn.chords();
        for _ in 0..chords {
            let next = at.turned(turn.rate_radps, turn.for_s / chords as f64);
            let faster = changes.faster(&extent, next.at_s);
            leg(&faster, &at, &next, turn.rate_radps);
            at = next;
        }
        let left_s = begins_s + SPEED_CHANGES_S - at.at_s;
        if left_s > 0.0 && changes.speeds_m > 0.0 {
            let next = at.turned(0.0, left_s);
            leg(&changes.faster(&extent, next.at_s), &at, &next, 0.0);
            at = next;
        }
        extent.volume = widened(extent.volume, changes.speeds_m);
        let left_s = begins_s + CLIMB_CHANGES_S - at.at_s;
        if left_s > 0.0 && changes.change_mps > 0.0 {
            let next = at.turned(0.0, left_s);
            leg(&extent, &at, &next, 0.0);
            at = next;
        }
        extent.position_m = at.position_m - at.velocity_mps * at.at_s;
        extent.velocity_mps = at.velocity_mps;
        extent.stretch_m = changes.later_m();
        extent.window_s.0 = at.at_s;
        add(self.with(|own| *own = extent));
    }
}

/// A volume with places to all sides of it at the same height.
const fn widened(volume: ProtectedVolume, by_m: f64) -> ProtectedVolume {
    volume.resized(volume.radius_m() + by_m, volume.half_height_m())
}

impl Changes {
    /// The aircraft at its report, with a climb halfway between going on and ending.
    fn report(&self, hazard: &Hazard) -> Moment {
        let position_m = hazard.position_m - hazard.velocity_mps * self.age_s;
        Moment {
            at_s: -self.age_s,
            position_m,
            velocity_mps: hazard.velocity_mps - Vec3::new(0.0, 0.0, self.end_mps),
        }
    }

    /// An extent while the speed changes, up to a moment, seconds: the way ½ a t² is below its chord.
    fn faster(&self, extent: &Extent, until_s: f64) -> Extent {
        let grows_mps =
            self.speeds_m * (until_s + self.age_s) / (SPEED_CHANGES_S * SPEED_CHANGES_S);
        Extent {
            volume: widened(extent.volume, grows_mps * self.age_s),
            growth_mps: extent.growth_mps + grows_mps,
            ..*extent
        }
    }

    /// The stretch while the climb changes, metres: at time 0, and its increase per second.
    fn first_m(&self) -> (f64, f64) {
        let rate_mps = self.change_mps + self.end_mps.abs();
        (rate_mps * self.age_s, rate_mps)
    }

    /// The same from then on.
    fn later_m(&self) -> (f64, f64) {
        let rate_mps = self.end_mps.abs();
        (
            rate_mps * self.age_s + self.change_mps * CLIMB_CHANGES_S,
            rate_mps,
        )
    }
}

/// An aircraft at a moment, in the air mass.
#[derive(Clone, Copy)]
struct Moment {
    at_s: f64,
    position_m: Vec3,
    velocity_mps: Vec3,
}

impl Moment {
    /// The same aircraft after a turn at a constant rate.
    fn turned(&self, rate_radps: f64, for_s: f64) -> Self {
        let (level_mps, up_mps) = (self.velocity_mps.truncate(), self.velocity_mps.z);
        let angle = rate_radps * for_s;
        let (sin, cos) = libm::sincos(angle);
        // ∫ R(ω t) v dt = (sin a · v + (1 − cos a) · v⊥) / ω
        let (along_s, across_s) = if angle.abs() < 1e-9 {
            (for_s, 0.0)
        } else {
            (sin / rate_radps, (1.0 - cos) / rate_radps)
        };
        let moved_m = Vec2::new(along_s, across_s).rotate(level_mps);
        Self {
            at_s: self.at_s + for_s,
            position_m: self.position_m + moved_m.extend(up_mps * for_s),
            velocity_mps: Vec2::new(cos, sin).rotate(level_mps).extend(up_mps),
        }
    }

    /// The chord to a later moment of a turn.
    fn leg(&self, to: &Self, rate_radps: f64, extent: &Extent) -> Extent {
        let duration_s = to.at_s - self.at_s;
        let velocity_mps = (to.position_m - self.position_m) / duration_s;
        let speed_mps = self.velocity_mps.truncate().length();
        let bow_m = speed_mps * rate_radps.abs() * duration_s * duration_s / 8.0;
        Extent {
            position_m: self.position_m - velocity_mps * self.at_s,
            velocity_mps,
            volume: widened(extent.volume, bow_m),
            window_s: (self.at_s, to.at_s.min(extent.window_s.1)),
            ..*extent
        }
    }
}

//! The vertical modes: a steady climb rate, and one that changes.

use crate::prior;

/// How a mode moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Steady,
    Changing,
}

impl Kind {
    pub(crate) const ALL: [Self; 2] = [Self::Steady, Self::Changing];

    /// Chance to be another one after a time, seconds.
    pub(crate) fn chance_to(self, other: Self, after_s: f32) -> f32 {
        let rate = match self {
            Self::Steady => prior::CLIMB_CHANGES_PER_S,
            Self::Changing => prior::CLIMB_SETTLES_PER_S,
        };
        let change = (rate * after_s).min(0.5);
        if self == other { 1.0 - change } else { change }
    }
}

/// A Gaussian of altitude and climb rate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Climb {
    /// Altitude from the belief's origin, metres; climb rate, metres per second.
    pub(crate) at: [f32; 2],
    /// Their variances.
    pub(crate) own: [f32; 2],
    /// Their covariance.
    pub(crate) cross: f32,
}

impl Climb {
    /// The Gaussian with mean and covariance of a mixture, whose weights add up to one.
    pub(crate) fn mixed(parts: &[(f32, Self)]) -> Self {
        let mut all = Self::default();
        for (weight, part) in parts {
            for (sum, at) in all.at.iter_mut().zip(part.at) {
                *sum += weight * at;
            }
        }
        for (weight, part) in parts {
            let [z, w] = [part.at[0] - all.at[0], part.at[1] - all.at[1]];
            all.own[0] += weight * (part.own[0] + z * z);
            all.own[1] += weight * (part.own[1] + w * w);
            all.cross += weight * (part.cross + z * w);
        }
        all
    }

    /// The same aircraft as a mode begins: a change of the climb rate, metres per second.
    pub(crate) fn entering(mut self, kind: Kind, change_mps: f32) -> Self {
        if kind == Kind::Changing {
            self.own[1] += change_mps * change_mps;
        }
        self
    }

    /// Carries it on, seconds, with the usual change of a climb rate, metres per second.
    pub(crate) fn advance(&mut self, kind: Kind, change_mps: f32, t: f32) {
        let white = match kind {
            Kind::Steady => prior::STEADY_CLIMB,
            Kind::Changing => prior::CLIMB_CHANGE * change_mps * change_mps,
        };
        self.at[0] += self.at[1] * t;
        self.own[0] += t * (2.0 * self.cross + t * self.own[1]) + white * t * t * t / 3.0;
        self.cross += t * self.own[1] + white * t * t / 2.0;
        self.own[1] += white * t;
    }

    /// Takes a measurement of the altitude: the log of its likelihood.
    pub(crate) fn see_altitude(&mut self, seen: f32, variance: f32) -> f32 {
        let gain = [self.own[0], self.cross];
        self.take(seen - self.at[0], gain, self.own[0] + variance)
    }

    /// Takes a measurement of the climb rate: the log of its likelihood.
    pub(crate) fn see_climb(&mut self, seen: f32, variance: f32) -> f32 {
        let gain = [self.cross, self.own[1]];
        self.take(seen - self.at[1], gain, self.own[1] + variance)
    }

    fn take(&mut self, off: f32, gain: [f32; 2], total: f32) -> f32 {
        let [z, w] = gain;
        self.at[0] += z * off / total;
        self.at[1] += w * off / total;
        self.own[0] = (self.own[0] - z * z / total).max(1e-9);
        self.own[1] = (self.own[1] - w * w / total).max(1e-9);
        self.cross -= z * w / total;
        -0.5 * (off * off / total + libm::logf(core::f32::consts::TAU * total))
    }
}

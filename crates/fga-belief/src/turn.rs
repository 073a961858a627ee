//! The horizontal modes: steady, wavering, turning left, turning right.

use crate::complex::{Complex, turned};
use crate::prior;

/// How a mode moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Steady,
    Wavering,
    Left,
    Right,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Steady, Self::Wavering, Self::Left, Self::Right];

    /// Side of its turn: 1 to the left, −1 to the right, 0 straight.
    pub(crate) const fn side(self) -> f32 {
        match self {
            Self::Steady | Self::Wavering => 0.0,
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// How often it ends, per second.
    pub(crate) fn ends_per_s(self) -> f32 {
        Self::ALL.map(|other| self.rate_to(other)).iter().sum()
    }

    /// Chance per second to change into another one.
    const fn rate_to(self, other: Self) -> f32 {
        let turn = 0.5 * prior::TURN_SEEN_PER_S;
        match (self, other) {
            (Self::Steady, Self::Wavering) => prior::WAVERING_BEGINS_PER_S,
            (Self::Wavering, Self::Steady) => prior::WAVERING_ENDS_PER_S,
            (Self::Steady, Self::Left | Self::Right) => turn,
            // What wavers often is a turn that begins.
            (Self::Wavering, Self::Left | Self::Right) => 10.0 * turn,
            (Self::Left | Self::Right, Self::Steady | Self::Wavering) => {
                0.5 * prior::TURN_ENDS_PER_S
            }
            (Self::Left, Self::Right) | (Self::Right, Self::Left) => prior::TURN_CHANGES_SIDE_PER_S,
            _ => 0.0,
        }
    }

    /// Chance to be another one after a time, seconds.
    pub(crate) fn chance_to(self, other: Self, after_s: f32) -> f32 {
        let change = |to: Self| (self.rate_to(to) * after_s).min(0.2);
        if self == other {
            1.0 - Self::ALL.into_iter().map(change).sum::<f32>()
        } else {
            change(other)
        }
    }
}

/// A Gaussian of position, velocity and acceleration: means, and covariances along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Turn {
    /// Position from the belief's origin, metres; velocity, metres per second; acceleration, m/s².
    pub(crate) at: [Complex; 3],
    /// Variances of the three.
    pub(crate) own: [f32; 3],
    /// Covariances of position and velocity, position and acceleration, velocity and acceleration: ½ E[a conj b].
    pub(crate) cross: [Complex; 3],
}

impl Turn {
    /// The Gaussian of a new aircraft, in a mode.
    pub(crate) fn new(velocity: Complex, variances: [f32; 2], kind: Kind, turn_radps: f32) -> Self {
        let [position, speed] = variances;
        let mode = Self {
            at: [Complex::ZERO, velocity, Complex::ZERO],
            own: [position, speed, 0.0],
            cross: [Complex::ZERO; 3],
        };
        mode.entering(kind, turn_radps)
    }

    /// Its turn rate by velocity and acceleration, radians per second.
    pub(crate) fn rate_radps(&self) -> f32 {
        let [_, velocity, acceleration] = self.at;
        // Slower than this a direction means nothing.
        (acceleration * velocity.conj()).y / velocity.squared().max(25.0)
    }

    /// The same aircraft as a mode begins, with the acceleration of it.
    pub(crate) fn entering(mut self, kind: Kind, turn_radps: f32) -> Self {
        let (mean, sigma) = prior::TURN_SHARE;
        let usual = self.at[1].left() * (kind.side() * turn_radps);
        self.at[2] = usual * mean;
        self.own[2] = usual.squared() * sigma * sigma;
        self.cross[1] = Complex::ZERO;
        self.cross[2] = Complex::ZERO;
        self
    }

    /// The Gaussian with mean and covariance of a mixture, whose weights add up to one.
    pub(crate) fn mixed(parts: &[(f32, Self)]) -> Self {
        let mut all = Self::default();
        for (weight, part) in parts {
            for (sum, at) in all.at.iter_mut().zip(part.at) {
                *sum = *sum + at * *weight;
            }
        }
        let [p, v, a] = all.at;
        for (weight, part) in parts {
            let off = [part.at[0] - p, part.at[1] - v, part.at[2] - a];
            let product = |i: Complex, j: Complex| i * j.conj() * 0.5;
            let [dp, dv, da] = off;
            for ((sum, own), d) in all.own.iter_mut().zip(part.own).zip(off) {
                *sum += weight * (own + 0.5 * d.squared());
            }
            let spread = [product(dp, dv), product(dp, da), product(dv, da)];
            for ((sum, cross), d) in all.cross.iter_mut().zip(part.cross).zip(spread) {
                *sum = *sum + (cross + d) * *weight;
            }
        }
        all
    }

    /// Carries it on, seconds, with the turn rate of a usual turn and the white acceleration of what wavers.
    pub(crate) fn advance(&mut self, kind: Kind, (turn_radps, wavering): (f32, f32), t: f32) {
        let most = 2.0 * turn_radps;
        let rate = self.rate_radps().max(-most).min(most);
        let (g, f) = turned(rate, t);
        let r = Complex::unit(rate * t);
        let [p, v, a] = self.at;
        let [pp, vv, aa] = self.own;
        let [pv, pa, va] = self.cross;
        self.at = [p + v * t + f * a, v + g * a, r * a];
        let usual = self.at[1].squared() * turn_radps * turn_radps;
        let (white, jerk) = match kind {
            Kind::Steady => (prior::STEADY, 0.0),
            Kind::Wavering => (wavering, 0.0),
            Kind::Left | Kind::Right => (prior::STEADY, prior::TURN_DRIFT * usual),
        };
        let (t2, t3) = (t * t, t * t * t);
        self.own = [
            pp + t2 * vv
                + f.squared() * aa
                + 2.0 * (pv * t + pa * f.conj() + va * f.conj() * t).x
                + white * t3 / 3.0
                + jerk * t2 * t3 / 20.0,
            vv + 2.0 * (va * g.conj()).x + g.squared() * aa + white * t + jerk * t3 / 3.0,
            aa + jerk * t,
        ];
        self.cross = [
            pv + pa * g.conj()
                + va * g.conj() * t
                + f * va.conj()
                + f * g.conj() * aa
                + Complex::new(vv * t + white * t2 / 2.0 + jerk * t2 * t2 / 8.0, 0.0),
            (pa + va * t + f * aa) * r.conj() + Complex::new(jerk * t3 / 6.0, 0.0),
            (va + g * aa) * r.conj() + Complex::new(jerk * t2 / 2.0, 0.0),
        ];
    }

    /// Takes a measurement of the position: the log of its likelihood.
    pub(crate) fn see_position(&mut self, seen: Complex, variance: f32) -> f32 {
        let pp = self.own[0];
        let [pv, pa, _] = self.cross;
        let gain = [Complex::new(pp, 0.0), pv.conj(), pa.conj()];
        self.take(seen - self.at[0], gain, pp + variance)
    }

    /// Takes a measurement of the velocity: the log of its likelihood.
    pub(crate) fn see_velocity(&mut self, seen: Complex, variance: f32) -> f32 {
        let vv = self.own[1];
        let [pv, _, va] = self.cross;
        let gain = [pv, Complex::new(vv, 0.0), va.conj()];
        self.take(seen - self.at[1], gain, vv + variance)
    }

    /// A Kalman update by an innovation, its covariance with the state, and its variance.
    fn take(&mut self, off: Complex, gain: [Complex; 3], total: f32) -> f32 {
        let share = 1.0 / total;
        for (at, gain) in self.at.iter_mut().zip(gain) {
            *at = *at + gain * off * share;
        }
        for (own, gain) in self.own.iter_mut().zip(gain) {
            *own = (*own - gain.squared() * share).max(1e-9);
        }
        let [p, v, a] = gain;
        let products = [p * v.conj(), p * a.conj(), v * a.conj()];
        for (cross, product) in self.cross.iter_mut().zip(products) {
            *cross = *cross - product * share;
        }
        -0.5 * off.squared() * share - libm::logf(core::f32::consts::TAU * total)
    }
}

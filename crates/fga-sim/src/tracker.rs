//! Tracks from noisy looks: one constant-velocity Kalman filter for each obstacle.
//!
//! Each look measures position and velocity with the same σ on every axis, so the three axes share one
//! covariance. A small white acceleration keeps the filter open to change. When an obstacle turns, its
//! looks no longer fit the track, and the track starts again. Its σ holds for obstacles that keep their
//! velocity.

use fga::Vec3;
use fga::situation::Uncertainty;

/// Density of the assumed acceleration of an obstacle, m²/s³: 0.1 m/s after ten seconds.
const ACCELERATION_DENSITY: f64 = 1e-3;

/// The track starts again where the squared distance of a look, in position or velocity, is above this many variances: of tracks
/// that fit, three axes exceed it once in 1,000 looks.
const MISFIT_LIMIT: f64 = 16.3;

/// A track ends after this time without a look, seconds.
const ENDS_AFTER_S: f64 = 5.0;

/// σ of one look along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookNoise {
    /// Of the position, metres.
    pub position_m: f64,
    /// Of the velocity, metres per second.
    pub velocity_mps: f64,
}

/// The estimate of one obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackEstimate {
    /// Position, metres.
    pub position_m: Vec3,
    /// Velocity, metres per second.
    pub velocity_mps: Vec3,
    /// Variance of the position along an axis, m².
    position_variance: f64,
    /// Covariance of position and velocity along an axis, m²/s.
    covariance: f64,
    /// Variance of the velocity along an axis, m²/s².
    velocity_variance: f64,
    time_s: f64,
}

impl TrackEstimate {
    /// A track that begins with one look.
    pub fn new(time_s: f64, position_m: Vec3, velocity_mps: Vec3, noise: &LookNoise) -> Self {
        Self {
            position_m,
            velocity_mps,
            position_variance: noise.position_m * noise.position_m,
            covariance: 0.0,
            velocity_variance: noise.velocity_mps * noise.velocity_mps,
            time_s,
        }
    }

    /// σ along an axis.
    pub fn uncertainty(&self) -> Uncertainty {
        Uncertainty {
            position_m: libm::sqrt(self.position_variance.max(0.0)),
            velocity_mps: libm::sqrt(self.velocity_variance.max(0.0)),
        }
    }

    /// Extrapolates the track to a later time.
    pub fn predict(&mut self, time_s: f64) {
        let dt = time_s - self.time_s;
        if dt <= 0.0 {
            return;
        }
        let noise = ACCELERATION_DENSITY * dt;
        self.position_m += self.velocity_mps * dt;
        self.position_variance +=
            dt * (2.0 * self.covariance + dt * self.velocity_variance) + noise * dt * dt / 3.0;
        self.covariance += dt * self.velocity_variance + noise * dt / 2.0;
        self.velocity_variance += noise;
        self.time_s = time_s;
    }

    /// Updates the track with a look.
    pub fn look(&mut self, time_s: f64, position_m: Vec3, velocity_mps: Vec3, noise: &LookNoise) {
        self.predict(time_s);
        let fits = |off: Vec3, variance: f64, sigma: f64| {
            off.length_squared() <= MISFIT_LIMIT * (variance + sigma * sigma)
        };
        let [off_m, off_mps] = [
            position_m - self.position_m,
            velocity_mps - self.velocity_mps,
        ];
        if !fits(off_m, self.position_variance, noise.position_m)
            || !fits(off_mps, self.velocity_variance, noise.velocity_mps)
        {
            *self = Self::new(time_s, position_m, velocity_mps, noise);
            return;
        }
        let position = (&mut self.position_m, &mut self.position_variance);
        let velocity = (&mut self.velocity_mps, &mut self.velocity_variance);
        let seen = (position_m, noise.position_m * noise.position_m);
        take(position, velocity, &mut self.covariance, seen);
        let position = (&mut self.position_m, &mut self.position_variance);
        let velocity = (&mut self.velocity_mps, &mut self.velocity_variance);
        let seen = (velocity_mps, noise.velocity_mps * noise.velocity_mps);
        take(velocity, position, &mut self.covariance, seen);
    }

    /// Whether its last look is too long ago.
    pub fn has_ended(&self, time_s: f64) -> bool {
        time_s - self.time_s > ENDS_AFTER_S
    }
}

/// Takes what is seen of a vector, with its variance, into its estimate and that of another vector, each with its variance.
fn take(
    (own, own_variance): (&mut Vec3, &mut f64),
    (other, other_variance): (&mut Vec3, &mut f64),
    covariance: &mut f64,
    (seen, variance): (Vec3, f64),
) {
    let total = *own_variance + variance;
    if total <= 0.0 {
        *own = seen;
        return;
    }
    let off = seen - *own;
    let gain = *own_variance / total;
    let cross_gain = *covariance / total;
    *own += off * gain;
    *other += off * cross_gain;
    *other_variance -= cross_gain * *covariance;
    *own_variance *= 1.0 - gain;
    *covariance *= 1.0 - gain;
}

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

/// Share of the newest look in the running mean of the misfit.
const MISFIT_SHARE: f64 = 0.2;

/// The track starts again above this mean misfit. A track that fits has mean 6 (three positions
/// and three velocities, in σ²) and a standard deviation of 1.2.
const MISFIT_LIMIT: f64 = 14.0;

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
    misfit: f64,
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
            misfit: 6.0,
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
        let misfit = self.take_position(position_m, noise.position_m * noise.position_m)
            + self.take_velocity(velocity_mps, noise.velocity_mps * noise.velocity_mps);
        self.misfit += MISFIT_SHARE * (misfit - self.misfit);
        if self.misfit > MISFIT_LIMIT {
            *self = Self::new(time_s, position_m, velocity_mps, noise);
        }
    }

    /// Returns the squared misfit over its variance.
    fn take_position(&mut self, position_m: Vec3, variance: f64) -> f64 {
        let total = self.position_variance + variance;
        if total <= 0.0 {
            self.position_m = position_m;
            return 0.0;
        }
        let off = position_m - self.position_m;
        let gain = self.position_variance / total;
        let cross_gain = self.covariance / total;
        self.position_m += off * gain;
        self.velocity_mps += off * cross_gain;
        self.velocity_variance -= cross_gain * self.covariance;
        self.position_variance *= 1.0 - gain;
        self.covariance *= 1.0 - gain;
        off.length_squared() / total
    }

    fn take_velocity(&mut self, velocity_mps: Vec3, variance: f64) -> f64 {
        let total = self.velocity_variance + variance;
        if total <= 0.0 {
            self.velocity_mps = velocity_mps;
            return 0.0;
        }
        let off = velocity_mps - self.velocity_mps;
        let gain = self.velocity_variance / total;
        let cross_gain = self.covariance / total;
        self.velocity_mps += off * gain;
        self.position_m += off * cross_gain;
        self.position_variance -= cross_gain * self.covariance;
        self.velocity_variance *= 1.0 - gain;
        self.covariance *= 1.0 - gain;
        off.length_squared() / total
    }
}

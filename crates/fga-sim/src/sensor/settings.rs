//! The errors of a sensor.

use fga::Vec3;
use fga::angle::{course_of, wrap_pi};
use fga_belief::{Errors, Sigma, Source};
use fga_files::sensors::SensorSource;

use crate::tracker::LookNoise;

/// Quality and rate of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorSettings {
    /// Range, metres; infinity allowed.
    pub range_m: f64,
    /// Time between two looks, seconds; 0 looks at every decision. Between looks the sensor extrapolates
    /// in a straight line.
    pub update_period_s: f64,
    /// σ of the noise on each component of the position, metres.
    pub position_sigma_m: f64,
    /// σ of the noise on each component of the velocity, metres per second.
    pub velocity_sigma_mps: f64,
    /// Whether noisy looks become tracks by a Kalman filter; without it each look passes
    /// unchanged.
    pub tracked: bool,
    /// Whether a belief makes the tracks, in place of the Kalman filter.
    pub by_belief: bool,
    /// Horizontal field of view, radians, half of it to either side of the course; a full turn
    /// sees all around.
    pub field_of_regard_rad: f64,
    /// Probability that a look sees a visible obstacle.
    pub detection_probability: f64,
    /// Age of a look, seconds; the sensor extrapolates it in a straight line.
    pub delay_s: f64,
    /// σ of the noise on the altitude, metres; without it that of the other components.
    pub altitude_sigma_m: Option<f64>,
    /// σ of each horizontal component of an error that an obstacle's position keeps, metres.
    pub position_bias_m: f64,
    /// σ of an error that its altitude keeps, metres, as of pressure altitude.
    pub altitude_bias_m: f64,
    /// Share of the obstacles that the source can see at all, as those with a transponder.
    pub equipped_share: f64,
    /// Interruptions of the whole source in a minute, on average.
    pub dropouts_per_min: f64,
    /// Length of an interruption, seconds.
    pub dropout_s: f64,
    /// An obstacle that is no longer seen is extrapolated for this long, seconds.
    pub coast_s: f64,
}

impl Default for SensorSettings {
    /// Perfect sight.
    fn default() -> Self {
        Self {
            range_m: f64::INFINITY,
            update_period_s: 0.0,
            position_sigma_m: 0.0,
            velocity_sigma_mps: 0.0,
            tracked: true,
            by_belief: false,
            field_of_regard_rad: core::f64::consts::TAU,
            detection_probability: 1.0,
            delay_s: 0.0,
            altitude_sigma_m: None,
            position_bias_m: 0.0,
            altitude_bias_m: 0.0,
            equipped_share: 1.0,
            dropouts_per_min: 0.0,
            dropout_s: 0.0,
            coast_s: 0.0,
        }
    }
}

impl From<&SensorSource> for SensorSettings {
    /// The sensor that a campaign's `[[sensor]]` describes.
    fn from(source: &SensorSource) -> Self {
        let perfect = Self::default();
        Self {
            range_m: source.range_m.unwrap_or(perfect.range_m),
            update_period_s: source.update_rate_hz.map_or(0.0, |rate| 1.0 / rate),
            position_sigma_m: source.position_sigma_m.unwrap_or_default(),
            velocity_sigma_mps: source.velocity_sigma_mps.unwrap_or_default(),
            tracked: source.tracked.unwrap_or(false),
            by_belief: source.belief.unwrap_or(false),
            field_of_regard_rad: source
                .field_of_regard_deg
                .map_or(perfect.field_of_regard_rad, f64::to_radians),
            detection_probability: source.detection_probability.unwrap_or(1.0),
            delay_s: source.delay_s.unwrap_or_default(),
            altitude_sigma_m: source.altitude_sigma_m,
            position_bias_m: source.position_bias_m.unwrap_or_default(),
            altitude_bias_m: source.altitude_bias_m.unwrap_or_default(),
            equipped_share: source.equipped_share.unwrap_or(1.0),
            dropouts_per_min: source.dropouts_per_min.unwrap_or_default(),
            dropout_s: source.dropout_s.unwrap_or_default(),
            coast_s: source.coast_s.unwrap_or_default(),
        }
    }
}

impl SensorSettings {
    /// Whether an obstacle at this offset is within the field of regard.
    pub(super) fn regards(&self, offset_m: Vec3, course_rad: f64) -> bool {
        self.field_of_regard_rad >= core::f64::consts::TAU
            || wrap_pi(course_of(offset_m) - course_rad).abs() <= 0.5 * self.field_of_regard_rad
    }

    pub(super) fn altitude_sigma_m(&self) -> f64 {
        self.altitude_sigma_m.unwrap_or(self.position_sigma_m)
    }

    /// The tracker has one σ for all axes: the larger one. A late position was carried on along the velocity.
    pub(super) fn look_noise(&self) -> LookNoise {
        let position_m = self.position_sigma_m.max(self.altitude_sigma_m());
        LookNoise {
            position_m: libm::hypot(position_m, self.velocity_sigma_mps * self.delay_s),
            velocity_mps: self.velocity_sigma_mps,
        }
    }

    pub(super) fn is_noisy(&self) -> bool {
        self.look_noise().position_m > 0.0 || self.velocity_sigma_mps > 0.0
    }

    /// The errors of its reports.
    pub(crate) fn errors(&self) -> Errors {
        #[expect(clippy::cast_possible_truncation, reason = "standard deviations")]
        let sigma = |value: f64| Sigma::new(value as f32, Source::Sensor);
        Errors {
            position_m: sigma(self.position_sigma_m),
            altitude_m: sigma(self.altitude_sigma_m()),
            velocity_mps: sigma(self.velocity_sigma_mps),
            climb_mps: sigma(self.velocity_sigma_mps),
            lasting_position_m: sigma(self.position_bias_m),
            lasting_altitude_m: sigma(self.altitude_bias_m),
        }
    }

    /// The larger σ of the errors that an obstacle keeps, metres.
    pub(super) fn bias_m(&self) -> f64 {
        self.position_bias_m.max(self.altitude_bias_m)
    }
}

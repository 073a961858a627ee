//! Sources of a campaign's knowledge about other aircraft: `[[sensor]]` in its file.
//!
//! They take the place of the vehicle file's sensor. Each is a radar, a camera, a receiver of transponders or a ground
//! station with its own quality; where several see an aircraft, the one with the smallest σ of its position counts.

use serde::{Deserialize, Serialize};

/// A source; a missing number means a perfect one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorSource {
    /// Its name in reports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Range, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_m: Option<f64>,
    /// Horizontal angle of view, degrees, half of it to either side of the course.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field_of_regard_deg: Option<f64>,
    /// Looks in a second; without it one at each decision.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub update_rate_hz: Option<f64>,
    /// Probability that a look sees an aircraft within range and view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detection_probability: Option<f64>,
    /// Age of a look, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<f64>,
    /// σ of the noise on each coordinate of a position, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_sigma_m: Option<f64>,
    /// σ of the noise on the altitude, metres; without it `position_sigma_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub altitude_sigma_m: Option<f64>,
    /// σ of the noise on each component of a velocity, metres per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_sigma_mps: Option<f64>,
    /// σ of each horizontal coordinate of an error that lasts for the encounter, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_bias_m: Option<f64>,
    /// σ of an error of the altitude that lasts for the encounter, metres, as of pressure altitude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub altitude_bias_m: Option<f64>,
    /// Share of the intruders that the source can see at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub equipped_share: Option<f64>,
    /// Interruptions of the whole source in a minute, on average.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dropouts_per_min: Option<f64>,
    /// Length of an interruption, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dropout_s: Option<f64>,
    /// An aircraft that is no longer seen is extrapolated for this long, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coast_s: Option<f64>,
    /// Whether noisy looks become tracks by a Kalman filter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracked: Option<bool>,
    /// Whether a belief makes these tracks, in place of the Kalman filter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub belief: Option<bool>,
}

impl SensorSource {
    /// Checks the numbers; an infinite range becomes `None`.
    ///
    /// # Errors
    /// One sentence that names the key.
    pub fn check(&mut self) -> Result<(), String> {
        self.range_m = self.range_m.filter(|range_m| *range_m != f64::INFINITY);
        let within = [
            ("range_m", self.range_m, 1.0, 1e7),
            ("field_of_regard_deg", self.field_of_regard_deg, 1.0, 360.0),
            ("update_rate_hz", self.update_rate_hz, 1e-3, 1e3),
            (
                "detection_probability",
                self.detection_probability,
                0.0,
                1.0,
            ),
            ("delay_s", self.delay_s, 0.0, 10.0),
            ("position_sigma_m", self.position_sigma_m, 0.0, 1e4),
            ("altitude_sigma_m", self.altitude_sigma_m, 0.0, 1e4),
            ("velocity_sigma_mps", self.velocity_sigma_mps, 0.0, 1e3),
            ("position_bias_m", self.position_bias_m, 0.0, 1e4),
            ("altitude_bias_m", self.altitude_bias_m, 0.0, 1e4),
            ("equipped_share", self.equipped_share, 0.0, 1.0),
            ("dropouts_per_min", self.dropouts_per_min, 0.0, 600.0),
            ("dropout_s", self.dropout_s, 0.0, 3600.0),
            ("coast_s", self.coast_s, 0.0, 60.0),
        ];
        for (key, value, least, most) in within {
            if let Some(value) = value
                && !(least..=most).contains(&value)
            {
                return Err(format!("{key} is {value}, expected {least} to {most}"));
            }
        }
        if self.dropouts_per_min.is_some() != self.dropout_s.is_some() {
            return Err("has one of dropouts_per_min and dropout_s, expected both or none".into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_and_half_of_a_pair_are_refused() {
        let mut source = SensorSource {
            range_m: Some(f64::INFINITY),
            equipped_share: Some(1.5),
            ..SensorSource::default()
        };
        let said = source.check().unwrap_err();
        assert_eq!(said, "equipped_share is 1.5, expected 0 to 1");
        source.equipped_share = None;
        source.dropouts_per_min = Some(2.0);
        let said = source.check().unwrap_err();
        assert!(said.contains("dropouts_per_min and dropout_s"), "{said}");
        source.dropout_s = Some(3.0);
        assert_eq!(source.check(), Ok(()));
        assert_eq!(source.range_m, None);
    }
}

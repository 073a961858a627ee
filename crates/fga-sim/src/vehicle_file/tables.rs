//! The tables of a vehicle file, as written and as checked.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga::vehicle::Response;
use fga_formats::InputError;
use fga_paper::pilot::GridSteps;
use serde::Deserialize;
use toml::Spanned;

use crate::plant::Autopilot;
use crate::sensor::SensorSettings;
use crate::toml_input::TomlText;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Protection {
    radius_m: Spanned<f64>,
    half_height_m: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Cost {
    pub(super) heading: Option<Spanned<f64>>,
    pub(super) pitch: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Grid {
    heading_range_deg: Option<Spanned<f64>>,
    heading_step_rad: Option<Spanned<f64>>,
    pitch_step_rad: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ResponseTable {
    dead_time_s: Option<Spanned<f64>>,
    bank_time_constant_s: Option<Spanned<f64>>,
    turn_rate_factor: Option<Spanned<f64>>,
}

/// Standard deviation of the velocity by which an aircraft that is not ideal is carried off its prediction,
/// metres per second: gusts in the light wind of a calm day, a tenth of 3 m/s (MIL-F-8785C).
const REAL_DRIFT_MPS: f64 = 0.3;

impl ResponseTable {
    /// The drift of an aircraft with this response.
    pub(super) fn drift_mps(&self) -> f64 {
        let given = [&self.dead_time_s, &self.bank_time_constant_s];
        let lags = given
            .into_iter()
            .flatten()
            .any(|value| *value.get_ref() > 0.0);
        if lags { REAL_DRIFT_MPS } else { 0.0 }
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Avoidance {
    pub(super) margin_m: Option<Spanned<f64>>,
    pub(super) drift_mps: Option<Spanned<f64>>,
    pub(super) confidence_sigmas: Option<Spanned<f64>>,
    pub(super) horizon_s: Option<Spanned<f64>>,
    #[serde(default)]
    pub(super) objective: ObjectiveName,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ObjectiveName {
    #[default]
    PaperCost,
    LeastDeviation,
    ShortestPath,
}

/// A constant wind: the velocity of the air over the ground.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::struct_field_names,
    reason = "the names are the keys of the file, and those end in their unit"
)]
pub(crate) struct WindTable {
    east_mps: Option<Spanned<f64>>,
    north_mps: Option<Spanned<f64>>,
    up_mps: Option<Spanned<f64>>,
}

#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct NoiseTable {
    position_m: Option<Spanned<f64>>,
    velocity_mps: Option<Spanned<f64>>,
}

#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct SensorTable {
    range_m: Option<Spanned<f64>>,
    update_rate_hz: Option<Spanned<f64>>,
    /// Whether noisy looks become tracks by a Kalman filter.
    tracked: Option<bool>,
    field_of_regard_deg: Option<Spanned<f64>>,
    detection_probability: Option<Spanned<f64>>,
    delay_s: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct AutopilotTable {
    #[serde(default)]
    kind: AutopilotKind,
    kp: Option<Spanned<f64>>,
    ki: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum AutopilotKind {
    #[default]
    Direct,
    Pi,
}

pub(super) fn not_negative(
    text: &TomlText<'_>,
    key: &str,
    value: Option<&Spanned<f64>>,
    otherwise: f64,
) -> Result<f64, InputError> {
    value.map_or(Ok(otherwise), |value| text.not_negative(key, value))
}

pub(super) fn positive(
    text: &TomlText<'_>,
    key: &str,
    value: Option<&Spanned<f64>>,
    otherwise: f64,
) -> Result<f64, InputError> {
    value.map_or(Ok(otherwise), |value| text.positive(key, value))
}

pub(super) fn angle(
    text: &TomlText<'_>,
    key: &str,
    value: Option<&Spanned<f64>>,
    limits_deg: (f64, f64),
    otherwise_deg: f64,
) -> Result<f64, InputError> {
    value
        .map_or(Ok(otherwise_deg), |value| {
            text.within(key, value, limits_deg)
        })
        .map(f64::to_radians)
}

impl Grid {
    pub(super) fn checked(&self, text: &TomlText<'_>) -> Result<GridSteps, InputError> {
        let default = GridSteps::default();
        Ok(GridSteps {
            heading_range_rad: angle(
                text,
                "heading_range_deg",
                self.heading_range_deg.as_ref(),
                (1.0, 180.0),
                default.heading_range_rad.to_degrees(),
            )?,
            heading_step_rad: positive(
                text,
                "heading_step_rad",
                self.heading_step_rad.as_ref(),
                default.heading_step_rad,
            )?,
            pitch_step_rad: positive(
                text,
                "pitch_step_rad",
                self.pitch_step_rad.as_ref(),
                default.pitch_step_rad,
            )?,
        })
    }
}

impl Protection {
    pub(super) fn checked(&self, text: &TomlText<'_>) -> Result<ProtectedVolume, InputError> {
        let radius_m = text.positive("radius_m", &self.radius_m)?;
        Ok(match &self.half_height_m {
            None => ProtectedVolume::Sphere { radius_m },
            Some(half_height) => ProtectedVolume::Cylinder {
                radius_m,
                half_height_m: text.positive("half_height_m", half_height)?,
            },
        })
    }
}

impl ResponseTable {
    pub(super) fn checked(&self, text: &TomlText<'_>) -> Result<Response, InputError> {
        let limited = |key, value: &Option<Spanned<f64>>, limits, otherwise| {
            value
                .as_ref()
                .map_or(Ok(otherwise), |value| text.within(key, value, limits))
        };
        Ok(Response {
            dead_time_s: limited("dead_time_s", &self.dead_time_s, (0.0, 5.0), 0.0)?,
            bank_time_constant_s: match &self.bank_time_constant_s {
                Some(value) if *value.get_ref() != 0.0 => {
                    text.within("bank_time_constant_s", value, (0.01, 10.0))?
                }
                _ => 0.0,
            },
            turn_rate_factor: limited(
                "turn_rate_factor",
                &self.turn_rate_factor,
                (0.05, 2.0),
                1.0,
            )?,
        })
    }
}

impl WindTable {
    pub(crate) fn checked(&self, text: &TomlText<'_>) -> Result<Vec3, InputError> {
        let component = |key, value: &Option<Spanned<f64>>| {
            value
                .as_ref()
                .map_or(Ok(0.0), |value| text.within(key, value, (-200.0, 200.0)))
        };
        Ok(Vec3::new(
            component("east_mps", &self.east_mps)?,
            component("north_mps", &self.north_mps)?,
            component("up_mps", &self.up_mps)?,
        ))
    }
}

impl SensorTable {
    pub(crate) fn checked(
        &self,
        noise: &NoiseTable,
        text: &TomlText<'_>,
        otherwise: SensorSettings,
    ) -> Result<SensorSettings, InputError> {
        Ok(SensorSettings {
            range_m: positive(text, "range_m", self.range_m.as_ref(), otherwise.range_m)?,
            update_period_s: match &self.update_rate_hz {
                None => otherwise.update_period_s,
                Some(rate) => 1.0 / text.positive("update_rate_hz", rate)?,
            },
            position_sigma_m: not_negative(
                text,
                "position_m",
                noise.position_m.as_ref(),
                otherwise.position_sigma_m,
            )?,
            velocity_sigma_mps: not_negative(
                text,
                "velocity_mps",
                noise.velocity_mps.as_ref(),
                otherwise.velocity_sigma_mps,
            )?,
            tracked: self.tracked.unwrap_or(otherwise.tracked),
            field_of_regard_rad: match &self.field_of_regard_deg {
                None => otherwise.field_of_regard_rad,
                Some(degrees) => text
                    .within("field_of_regard_deg", degrees, (1.0, 360.0))?
                    .to_radians(),
            },
            detection_probability: match &self.detection_probability {
                None => otherwise.detection_probability,
                Some(share) => text.within("detection_probability", share, (0.0, 1.0))?,
            },
            delay_s: match &self.delay_s {
                None => otherwise.delay_s,
                Some(seconds) => text.within("delay_s", seconds, (0.0, 10.0))?,
            },
            ..otherwise
        })
    }
}

impl AutopilotTable {
    pub(super) fn checked(&self, text: &TomlText<'_>) -> Result<Autopilot, InputError> {
        match self.kind {
            AutopilotKind::Direct => match self.kp.as_ref().or(self.ki.as_ref()) {
                Some(gain) => Err(text.error_at(
                    gain,
                    "the direct autopilot has no gains, expected kind = \"pi\"",
                )),
                None => Ok(Autopilot::Direct),
            },
            AutopilotKind::Pi => Ok(Autopilot::ProportionalIntegral {
                proportional_per_s: positive(text, "kp", self.kp.as_ref(), 2.0)?,
                integral_per_s2: not_negative(text, "ki", self.ki.as_ref(), 0.1)?,
            }),
        }
    }
}

//! Checks the tables of a vehicle file, and gives what they mean.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga::vehicle::Response;
use fga_files::TomlText;
use fga_files::vehicle::{
    AutopilotKind, AutopilotTable, GridSettings, LimitsTable, NoiseTable, Protection,
    ResponseTable, SensorTable, WindTable,
};
use fga_formats::InputError;
use fga_paper::pilot::GridSteps;
use toml::Spanned;

use crate::plant::Autopilot;
use crate::sensor::SensorSettings;

/// Standard deviation of the velocity by which an aircraft that is not ideal is carried off its prediction,
/// metres per second: gusts in the light wind of a calm day, a tenth of 3 m/s (MIL-F-8785C).
const REAL_DRIFT_MPS: f64 = 0.3;

/// A table whose values are checked one by one.
pub(crate) trait Checked {
    /// What the table describes.
    type Meaning;

    /// What the table describes, if each value is within its limits.
    ///
    /// # Errors
    /// The first value that is not, with its line.
    fn checked(&self, text: &TomlText<'_>) -> Result<Self::Meaning, InputError>;
}

/// The drift of an aircraft with this response.
pub(super) fn drift_mps(response: &ResponseTable) -> f64 {
    let given = [&response.dead_time_s, &response.bank_time_constant_s];
    let lags = given
        .into_iter()
        .flatten()
        .any(|value| *value.get_ref() > 0.0);
    if lags { REAL_DRIFT_MPS } else { 0.0 }
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

impl Checked for GridSettings {
    type Meaning = GridSteps;

    fn checked(&self, text: &TomlText<'_>) -> Result<GridSteps, InputError> {
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

impl Checked for Protection {
    type Meaning = ProtectedVolume;

    fn checked(&self, text: &TomlText<'_>) -> Result<ProtectedVolume, InputError> {
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

impl Checked for LimitsTable {
    type Meaning = (f64, f64);

    fn checked(&self, text: &TomlText<'_>) -> Result<(f64, f64), InputError> {
        let limit = |key, value: &Option<Spanned<f64>>, otherwise| {
            let known = |value| text.within(key, value, (-1000.0, 50_000.0));
            value.as_ref().map_or(Ok(otherwise), known)
        };
        let floor_m = limit("floor_m", &self.floor_m, f64::NEG_INFINITY)?;
        let ceiling_m = limit("ceiling_m", &self.ceiling_m, f64::INFINITY)?;
        match &self.ceiling_m {
            Some(ceiling) if ceiling_m <= floor_m => Err(text.error_at(
                ceiling,
                format!("ceiling_m is {ceiling_m}, expected more than floor_m, {floor_m}"),
            )),
            _ => Ok((floor_m, ceiling_m)),
        }
    }
}

impl Checked for ResponseTable {
    type Meaning = Response;

    fn checked(&self, text: &TomlText<'_>) -> Result<Response, InputError> {
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

impl Checked for WindTable {
    type Meaning = Vec3;

    fn checked(&self, text: &TomlText<'_>) -> Result<Vec3, InputError> {
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

/// The sensor of a table and the noise beside it; what they leave out is as in `otherwise`.
pub(crate) fn sensor(
    table: &SensorTable,
    noise: &NoiseTable,
    text: &TomlText<'_>,
    otherwise: SensorSettings,
) -> Result<SensorSettings, InputError> {
    Ok(SensorSettings {
        range_m: positive(text, "range_m", table.range_m.as_ref(), otherwise.range_m)?,
        update_period_s: match &table.update_rate_hz {
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
        tracked: table.tracked.unwrap_or(otherwise.tracked),
        field_of_regard_rad: match &table.field_of_regard_deg {
            None => otherwise.field_of_regard_rad,
            Some(degrees) => text
                .within("field_of_regard_deg", degrees, (1.0, 360.0))?
                .to_radians(),
        },
        detection_probability: match &table.detection_probability {
            None => otherwise.detection_probability,
            Some(share) => text.within("detection_probability", share, (0.0, 1.0))?,
        },
        delay_s: match &table.delay_s {
            None => otherwise.delay_s,
            Some(seconds) => text.within("delay_s", seconds, (0.0, 10.0))?,
        },
        ..otherwise
    })
}

impl Checked for AutopilotTable {
    type Meaning = Autopilot;

    fn checked(&self, text: &TomlText<'_>) -> Result<Autopilot, InputError> {
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

//! Checks the tables of a vehicle file, and gives what they mean. Each function ends with the first value out of its limits, with its line.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga::vehicle::Response;
use fga_files::TomlText;
use fga_files::vehicle::{
    AutopilotKind, AutopilotTable, GridSettings, NoiseTable, PlantTable, Protection, ResponseTable,
    SensorTable, WindTable,
};
use fga_formats::InputError;
use fga_paper::pilot::GridSteps;
use toml::Spanned;

use crate::plant::{Autopilot, PlantDifference};
use crate::sensor::SensorSettings;

/// Standard deviation of the velocity by which an aircraft that is not ideal is carried off its prediction,
/// metres per second: gusts in the light wind of a calm day, a tenth of 3 m/s (MIL-F-8785C).
const REAL_DRIFT_MPS: f64 = 0.3;

/// The value of a key, checked by a method of [`TomlText`]; what follows the semicolon where the table lacks the key.
macro_rules! given {
    ($text:ident, $table:ident.$key:ident $check:ident $($limits:expr)?; $otherwise:expr) => {
        match &$table.$key {
            Some(value) => $text.$check(stringify!($key), value $(, $limits)?)?,
            None => $otherwise,
        }
    };
}
pub(super) use given;

/// The drift of an aircraft with this response.
pub(super) fn drift_mps(response: &ResponseTable) -> f64 {
    let given = [&response.dead_time_s, &response.bank_time_constant_s];
    let lags = given
        .into_iter()
        .flatten()
        .any(|value| *value.get_ref() > 0.0);
    if lags { REAL_DRIFT_MPS } else { 0.0 }
}

pub(super) fn grid(table: &GridSettings, text: TomlText<'_>) -> Result<GridSteps, InputError> {
    let usual = GridSteps::default();
    let range_deg = usual.heading_range_rad.to_degrees();
    let range_deg = given!(text, table.heading_range_deg within (1.0, 180.0); range_deg);
    Ok(GridSteps {
        heading_range_rad: range_deg.to_radians(),
        heading_step_rad: given!(text, table.heading_step_rad positive; usual.heading_step_rad),
        pitch_step_rad: given!(text, table.pitch_step_rad positive; usual.pitch_step_rad),
    })
}

pub(super) fn protection(
    table: &Protection,
    text: TomlText<'_>,
) -> Result<ProtectedVolume, InputError> {
    let radius_m = text.positive("radius_m", &table.radius_m)?;
    Ok(match &table.half_height_m {
        None => ProtectedVolume::Sphere { radius_m },
        Some(half_height) => ProtectedVolume::Cylinder {
            radius_m,
            half_height_m: text.positive("half_height_m", half_height)?,
        },
    })
}

/// The floor and the ceiling of a table, metres; infinite where the table lacks the key.
pub(crate) fn limits(
    [floor, ceiling]: [&Option<Spanned<f64>>; 2],
    text: TomlText<'_>,
) -> Result<(f64, f64), InputError> {
    let limit = |key, value: &Option<Spanned<f64>>, otherwise| {
        let known = |value| text.within(key, value, (-1000.0, 50_000.0));
        value.as_ref().map_or(Ok(otherwise), known)
    };
    let floor_m = limit("floor_m", floor, f64::NEG_INFINITY)?;
    let ceiling_m = limit("ceiling_m", ceiling, f64::INFINITY)?;
    match ceiling {
        Some(ceiling) if ceiling_m <= floor_m => Err(text.error_at(
            ceiling,
            format!("ceiling_m is {ceiling_m}, expected more than floor_m, {floor_m}"),
        )),
        _ => Ok((floor_m, ceiling_m)),
    }
}

/// Limits of the keys that a response and a plant both have.
const DEAD_TIME_S: (f64, f64) = (0.0, 5.0);
const TURN_RATE_FACTOR: (f64, f64) = (0.05, 2.0);
const WIND_MPS: (f64, f64) = (-200.0, 200.0);

pub(super) fn response(table: &ResponseTable, text: TomlText<'_>) -> Result<Response, InputError> {
    Ok(Response {
        dead_time_s: given!(text, table.dead_time_s within DEAD_TIME_S; 0.0),
        bank_time_constant_s: match &table.bank_time_constant_s {
            Some(lag) => bank_time_constant_s(lag, text)?,
            None => 0.0,
        },
        turn_rate_factor: given!(text, table.turn_rate_factor within TURN_RATE_FACTOR; 1.0),
    })
}

/// None, or not too short to compute with.
fn bank_time_constant_s(lag: &Spanned<f64>, text: TomlText<'_>) -> Result<f64, InputError> {
    if *lag.get_ref() == 0.0 {
        return Ok(0.0);
    }
    text.within("bank_time_constant_s", lag, (0.01, 10.0))
}

/// What a table says that the plant does otherwise than its pilot believes.
///
/// # Errors
/// A value out of its limits, with its line.
pub fn plant(table: &PlantTable, text: TomlText<'_>) -> Result<PlantDifference, InputError> {
    let within = |key, value: &Option<Spanned<f64>>, limits| {
        let value = value.as_ref().map(|value| text.within(key, value, limits));
        value.transpose()
    };
    let lag = table.bank_time_constant_s.as_ref();
    if let Some(error) = &table.wind_error_mps
        && !(error.get_ref().iter()).all(|value| (WIND_MPS.0..=WIND_MPS.1).contains(value))
    {
        let message = format!(
            "wind_error_mps is {:?}, expected east, north and up from {} to {}",
            error.get_ref(),
            WIND_MPS.0,
            WIND_MPS.1
        );
        return Err(text.error_at(error, message));
    }
    Ok(PlantDifference {
        airspeed_mps: within("airspeed_mps", &table.airspeed_mps, (1.0, 1e3))?,
        climb_rate_radps: within("climb_rate_radps", &table.climb_rate_radps, (0.0, 10.0))?,
        dead_time_s: within("dead_time_s", &table.dead_time_s, DEAD_TIME_S)?,
        bank_time_constant_s: lag.map(|lag| bank_time_constant_s(lag, text)).transpose()?,
        turn_rate_factor: within(
            "turn_rate_factor",
            &table.turn_rate_factor,
            TURN_RATE_FACTOR,
        )?,
        wind_error_mps: table.wind_error_mps.as_ref().map(|error| *error.get_ref()),
    })
}

pub(crate) fn wind(table: &WindTable, text: TomlText<'_>) -> Result<Vec3, InputError> {
    Ok(Vec3::new(
        given!(text, table.east_mps within WIND_MPS; 0.0),
        given!(text, table.north_mps within WIND_MPS; 0.0),
        given!(text, table.up_mps within WIND_MPS; 0.0),
    ))
}

/// The sensor of a table and the noise beside it; what they leave out is as in `usual`.
pub(crate) fn sensor(
    table: &SensorTable,
    noise: &NoiseTable,
    text: TomlText<'_>,
    usual: SensorSettings,
) -> Result<SensorSettings, InputError> {
    let regard = table.field_of_regard_deg.as_ref();
    Ok(SensorSettings {
        range_m: given!(text, table.range_m positive; usual.range_m),
        update_period_s: match &table.update_rate_hz {
            None => usual.update_period_s,
            Some(rate) => 1.0 / text.positive("update_rate_hz", rate)?,
        },
        position_sigma_m: given!(text, noise.position_m not_negative; usual.position_sigma_m),
        altitude_sigma_m: (noise.altitude_m.as_ref())
            .map(|sigma_m| text.not_negative("altitude_m", sigma_m))
            .transpose()?
            .or(usual.altitude_sigma_m),
        velocity_sigma_mps: given!(text, noise.velocity_mps not_negative; usual.velocity_sigma_mps),
        position_bias_m: given!(text, noise.lasting_position_m not_negative; usual.position_bias_m),
        altitude_bias_m: given!(text, noise.lasting_altitude_m not_negative; usual.altitude_bias_m),
        tracked: table.tracked.unwrap_or(usual.tracked),
        by_belief: usual.by_belief,
        field_of_regard_rad: regard.map_or(Ok(usual.field_of_regard_rad), |degrees| {
            let degrees = text.within("field_of_regard_deg", degrees, (1.0, 360.0));
            degrees.map(f64::to_radians)
        })?,
        detection_probability: given!(text, table.detection_probability within (0.0, 1.0); usual.detection_probability),
        delay_s: given!(text, table.delay_s within (0.0, 10.0); usual.delay_s),
        ..usual
    })
}

pub(super) fn autopilot(
    table: &AutopilotTable,
    text: TomlText<'_>,
) -> Result<Autopilot, InputError> {
    match table.kind {
        AutopilotKind::Direct => match table.kp.as_ref().or(table.ki.as_ref()) {
            Some(gain) => Err(text.error_at(
                gain,
                "the direct autopilot has no gains, expected kind = \"pi\"",
            )),
            None => Ok(Autopilot::Direct),
        },
        AutopilotKind::Pi => Ok(Autopilot::ProportionalIntegral {
            proportional_per_s: given!(text, table.kp positive; 2.0),
            integral_per_s2: given!(text, table.ki not_negative; 0.1),
        }),
    }
}

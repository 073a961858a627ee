//! Vehicle files: an aircraft, its protected volume and its sensor in TOML.
//!
//! Units are in the keys. Required: `name`, `airspeed_mps`, one of `turn_radius_m` and
//! `max_bank_deg`, and `[protection] radius_m`. Everything else has the default of
//! `vehicles/paper.toml` (no response lag, no wind, perfect sight); an unknown key is an error.

use std::path::Path;

use fga::Vec3;
use fga::avoider::Settings;
use fga::search::Objective;
use fga::situation::ProtectedVolume;
use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2, Vehicle};
use fga_formats::InputError;
use fga_formats::error::read_text;
use fga_paper::pilot::GridSteps;
use serde::Deserialize;
use toml::Spanned;

use crate::fingerprint::fingerprint;
use crate::plant::Autopilot;
use crate::sensor::SensorSettings;
use crate::settings::PolicySettings;
use crate::toml_input::TomlText;

/// The built-in vehicle: Table 4 of the paper.
const BUILT_IN: &str = include_str!("../vehicles/paper.toml");

/// The vehicle of recordings without one: a light aircraft.
const RECORDED: &str = include_str!("../vehicles/general-aviation.toml");

/// An aircraft as its file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct VehicleModel {
    /// Its name for people.
    pub name: String,
    /// SHA-256 of its file's text, in hexadecimal.
    pub sha256: String,
    /// Its limits.
    pub vehicle: Vehicle,
    /// The decision settings; the policy is chosen elsewhere.
    pub settings: PolicySettings,
    /// The protected volume about each obstacle.
    pub protection: ProtectedVolume,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
    /// The sensor.
    pub sensor: SensorSettings,
    /// Further sources beside it, which a campaign gives.
    pub more_sensors: Vec<SensorSettings>,
    /// How commands become bank and climb.
    pub autopilot: Autopilot,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    airspeed_mps: Spanned<f64>,
    turn_radius_m: Option<Spanned<f64>>,
    max_bank_deg: Option<Spanned<f64>>,
    climb_min_deg: Option<Spanned<f64>>,
    climb_max_deg: Option<Spanned<f64>>,
    climb_rate_radps: Option<Spanned<f64>>,
    surveillance_radius_m: Option<Spanned<f64>>,
    decision_period_s: Option<Spanned<f64>>,
    protection: Protection,
    #[serde(default)]
    cost: Cost,
    #[serde(default)]
    grid: Grid,
    #[serde(default)]
    response: ResponseTable,
    #[serde(default)]
    avoidance: Avoidance,
    #[serde(default)]
    wind: WindTable,
    #[serde(default)]
    noise: NoiseTable,
    #[serde(default)]
    sensor: SensorTable,
    #[serde(default)]
    autopilot: AutopilotTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Protection {
    radius_m: Spanned<f64>,
    half_height_m: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct Cost {
    heading: Option<Spanned<f64>>,
    pitch: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct Grid {
    heading_range_deg: Option<Spanned<f64>>,
    heading_step_rad: Option<Spanned<f64>>,
    pitch_step_rad: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ResponseTable {
    dead_time_s: Option<Spanned<f64>>,
    bank_time_constant_s: Option<Spanned<f64>>,
    turn_rate_factor: Option<Spanned<f64>>,
}

/// Standard deviation of the velocity by which an aircraft that is not ideal is carried off its prediction,
/// metres per second: gusts in the light wind of a calm day, a tenth of 3 m/s (MIL-F-8785C).
const REAL_DRIFT_MPS: f64 = 0.3;

impl ResponseTable {
    /// The drift of an aircraft with this response.
    fn drift_mps(&self) -> f64 {
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
struct Avoidance {
    margin_m: Option<Spanned<f64>>,
    drift_mps: Option<Spanned<f64>>,
    confidence_sigmas: Option<Spanned<f64>>,
    horizon_s: Option<Spanned<f64>>,
    #[serde(default)]
    objective: ObjectiveName,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum ObjectiveName {
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
struct AutopilotTable {
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

impl VehicleModel {
    /// The vehicle of Table 4, which needs no file.
    ///
    /// # Errors
    /// None in practice: the file is part of the program.
    pub fn built_in() -> Result<Self, InputError> {
        Self::parse(TomlText::new(Path::new("vehicles/paper.toml"), BUILT_IN))
    }

    /// The light aircraft that flies recordings without a given vehicle.
    ///
    /// # Errors
    /// None in practice: the file is part of the program.
    pub fn recorded() -> Result<Self, InputError> {
        let path = Path::new("vehicles/general-aviation.toml");
        Self::parse(TomlText::new(path, RECORDED))
    }

    /// Reads a vehicle file.
    ///
    /// # Errors
    /// An unreadable file, an unknown or missing key, a value out of range.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(TomlText::new(path, &read_text(path)?))
    }

    /// Reads the text of a vehicle file.
    ///
    /// # Errors
    /// As [`VehicleModel::read`].
    pub fn parse(text: TomlText<'_>) -> Result<Self, InputError> {
        let file: File = text.read()?;
        let airspeed_mps = text.within("airspeed_mps", &file.airspeed_mps, (1.0, 1e3))?;
        let turn_radius_m = match (&file.turn_radius_m, &file.max_bank_deg) {
            (Some(radius), None) => {
                // No turn of more than 10 g.
                let tightest_m = airspeed_mps * airspeed_mps / (10.0 * STANDARD_GRAVITY_MPS2);
                text.within("turn_radius_m", radius, (tightest_m.max(1.0), 1e6))?
            }
            (None, Some(bank)) => {
                let bank_deg = text.within("max_bank_deg", bank, (1.0, 80.0))?;
                // Eq. 8.
                airspeed_mps * airspeed_mps
                    / (STANDARD_GRAVITY_MPS2 * libm::tan(bank_deg.to_radians()))
            }
            (Some(_), Some(bank)) => {
                return Err(text.error_at(
                    bank,
                    "both turn_radius_m and max_bank_deg are given, expected one of them",
                ));
            }
            (None, None) => {
                return Err(
                    text.error("neither turn_radius_m nor max_bank_deg is given, expected one")
                );
            }
        };
        let vehicle = Vehicle {
            airspeed_mps,
            turn_radius_m,
            climb_min_rad: angle(
                &text,
                "climb_min_deg",
                file.climb_min_deg.as_ref(),
                (-60.0, 0.0),
                -15.0,
            )?,
            climb_max_rad: angle(
                &text,
                "climb_max_deg",
                file.climb_max_deg.as_ref(),
                (0.0, 60.0),
                15.0,
            )?,
            climb_rate_radps: file.climb_rate_radps.as_ref().map_or(Ok(0.2), |rate| {
                text.within("climb_rate_radps", rate, (0.0, 10.0))
            })?,
            response: file.response.checked(&text)?,
        };
        Ok(Self {
            vehicle,
            settings: file.settings(&text)?,
            protection: file.protection.checked(&text)?,
            wind_mps: file.wind.checked(&text)?,
            sensor: SensorTable::checked(
                &file.sensor,
                &file.noise,
                &text,
                SensorSettings::default(),
            )?,
            more_sensors: Vec::new(),
            autopilot: file.autopilot.checked(&text)?,
            name: file.name,
            sha256: fingerprint(text.text().as_bytes()),
        })
    }
}

fn not_negative(
    text: &TomlText<'_>,
    key: &str,
    value: Option<&Spanned<f64>>,
    otherwise: f64,
) -> Result<f64, InputError> {
    value.map_or(Ok(otherwise), |value| text.not_negative(key, value))
}

fn positive(
    text: &TomlText<'_>,
    key: &str,
    value: Option<&Spanned<f64>>,
    otherwise: f64,
) -> Result<f64, InputError> {
    value.map_or(Ok(otherwise), |value| text.positive(key, value))
}

fn angle(
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

impl File {
    fn settings(&self, text: &TomlText<'_>) -> Result<PolicySettings, InputError> {
        let default = Settings::default();
        let (cost, avoidance) = (&self.cost, &self.avoidance);
        let surveillance_radius_m = match &self.surveillance_radius_m {
            None => default.surveillance_radius_m,
            // Infinity: everything that the sensor sees.
            Some(value) if *value.get_ref() == f64::INFINITY => f64::INFINITY,
            Some(value) => text.positive("surveillance_radius_m", value)?,
        };
        let avoider = Settings {
            start: default.start,
            work_limit: default.work_limit,
            decision_period_s: self
                .decision_period_s
                .as_ref()
                .map_or(Ok(default.decision_period_s), |value| {
                    text.within("decision_period_s", value, (0.01, 10.0))
                })?,
            surveillance_radius_m,
            horizon_s: avoidance
                .horizon_s
                .as_ref()
                .map_or(Ok(default.horizon_s), |value| {
                    text.within("horizon_s", value, (1.0, 600.0))
                })?,
            margin_m: not_negative(
                text,
                "margin_m",
                avoidance.margin_m.as_ref(),
                default.margin_m,
            )?,
            drift_mps: avoidance
                .drift_mps
                .as_ref()
                .map_or(Ok(self.response.drift_mps()), |value| {
                    text.within("drift_mps", value, (0.0, 100.0))
                })?,
            confidence_sigmas: not_negative(
                text,
                "confidence_sigmas",
                avoidance.confidence_sigmas.as_ref(),
                default.confidence_sigmas,
            )?,
            heading_cost: not_negative(
                text,
                "heading",
                cost.heading.as_ref(),
                default.heading_cost,
            )?,
            pitch_cost: not_negative(text, "pitch", cost.pitch.as_ref(), default.pitch_cost)?,
            objective: match avoidance.objective {
                ObjectiveName::PaperCost => Objective::PaperCost,
                ObjectiveName::LeastDeviation => Objective::LeastDeviation,
                ObjectiveName::ShortestPath => Objective::ShortestPath,
            },
        };
        Ok(PolicySettings {
            avoider,
            grid: self.grid.checked(text)?,
        })
    }
}

impl Grid {
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

impl Protection {
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

impl ResponseTable {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<VehicleModel, String> {
        VehicleModel::parse(TomlText::new(Path::new("v.toml"), text)).map_err(|e| e.to_string())
    }

    #[test]
    fn the_built_in_vehicle_is_table_4() {
        let model = VehicleModel::built_in().unwrap();
        assert_eq!(model.vehicle.airspeed_mps, 15.0);
        assert_eq!(model.vehicle.turn_radius_m, 30.0);
        assert_eq!(model.vehicle.course_rate_radps(), 0.5);
        assert_eq!(model.protection, ProtectedVolume::Sphere { radius_m: 30.0 });
        assert_eq!(model.settings, PolicySettings::default());
        assert_eq!(model.autopilot, Autopilot::Direct);
    }

    #[test]
    fn every_shipped_vehicle_is_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vehicles");
        let mut names = Vec::new();
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let model = VehicleModel::read(&path).unwrap();
            assert_eq!(model.name, path.file_stem().unwrap().to_str().unwrap());
            names.push(model.name);
        }
        assert!(names.len() >= 5);
    }

    #[test]
    fn errors_name_file_line_and_expectation() {
        let good = "name='a'\nairspeed_mps=15\nturn_radius_m=30\n[protection]\nradius_m=30\n";
        parse(good).unwrap();
        for (from, to, expected) in [
            (
                "turn_radius_m=30",
                "turn_radius_km=30",
                "v.toml, line 3: unknown field `turn_radius_km`",
            ),
            (
                "airspeed_mps=15",
                "airspeed_mps=-15",
                "v.toml, line 2: airspeed_mps is -15, expected a number from 1 to 1000",
            ),
            (
                "radius_m=30\n[",
                "radius_m=nan\n[",
                "v.toml, line 3: turn_radius_m is NaN, expected a number from 2.29",
            ),
            (
                "turn_radius_m=30\n",
                "",
                "v.toml: neither turn_radius_m nor max_bank_deg is given, expected one",
            ),
            (
                "]\nradius_m=30",
                "]\nradius_m=-3",
                "v.toml, line 5: radius_m is -3, expected a positive number",
            ),
            ("name='a'", "name=", "v.toml, line 1: "),
        ] {
            let text = good.replacen(from, to, 1);
            let error = parse(&text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}

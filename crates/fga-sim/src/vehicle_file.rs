//! Vehicle files: an aircraft, its protected volume and its sensor in TOML.
//!
//! Units are in the keys. Required: `name`, `airspeed_mps`, one of `turn_radius_m` and
//! `max_bank_deg`, and `[protection] radius_m`. Everything else has the default of
//! `vehicles/paper.toml` (no response lag, no wind, perfect sight), but for the surveillance radius, which
//! [`surveillance`] derives; an unknown key is an error.

pub(crate) mod checks;

use std::path::Path;

use fga::Vec3;
use fga::avoider::{Settings, SettingsError};
use fga::search::Objective;
use fga::situation::ProtectedVolume;
use fga::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};
use fga_files::TomlText;
use fga_files::surveillance;
use fga_files::vehicle::{ObjectiveName, VehicleFile};
use fga_formats::InputError;
use fga_formats::error::read_text;

use crate::fingerprint::fingerprint;
use crate::plant::{Autopilot, PlantDifference};
use crate::sensor::SensorSettings;
use crate::settings::PolicySettings;

pub use checks::plant;

use checks::{drift_mps, given};

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
    /// The lowest and the highest altitude of a manoeuvre, metres; infinite without a limit.
    pub limits_m: (f64, f64),
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
    /// The sensor.
    pub sensor: SensorSettings,
    /// Further sources beside it, which a campaign gives.
    pub more_sensors: Vec<SensorSettings>,
    /// How commands become bank and climb.
    pub autopilot: Autopilot,
    /// What the simulated aircraft does otherwise than its pilot believes.
    pub plant: PlantDifference,
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

    /// The limits of the aircraft that flies.
    pub fn flies(&self) -> Vehicle {
        self.plant.vehicle(&self.vehicle)
    }

    /// The wind that blows, metres per second.
    pub fn blows_mps(&self) -> Vec3 {
        self.plant.wind_mps(self.wind_mps)
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
        let file = VehicleFile::read(&text)?;
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
            climb_min_rad: given!(text, file.climb_min_deg within (-60.0, 0.0); -15.0).to_radians(),
            climb_max_rad: given!(text, file.climb_max_deg within (0.0, 60.0); 15.0).to_radians(),
            climb_rate_radps: given!(text, file.climb_rate_radps within (0.0, 10.0); 0.2),
            response: checks::response(&file.response, text)?,
        };
        let protection = checks::protection(&file.protection, text)?;
        let mut settings = settings(&file, text)?;
        settings.avoider.surveillance_radius_m =
            surveillance_m(&file, &text, airspeed_mps, protection, &settings.avoider)?;
        let checked = vehicle.check().and_then(|()| settings.avoider.check());
        checked.map_err(|error| refused(&file, &text, error))?;
        Ok(Self {
            vehicle,
            settings,
            protection,
            limits_m: checks::limits([&file.limits.floor_m, &file.limits.ceiling_m], text)?,
            wind_mps: checks::wind(&file.wind, text)?,
            sensor: checks::sensor(&file.sensor, &file.noise, text, SensorSettings::default())?,
            more_sensors: Vec::new(),
            autopilot: checks::autopilot(&file.autopilot, text)?,
            plant: checks::plant(&file.plant, text)?,
            name: file.name,
            sha256: fingerprint(text.text().as_bytes()),
        })
    }
}

/// What the core refuses though each value is in its own range, at the line of its key.
fn refused(file: &VehicleFile, text: &TomlText<'_>, error: SettingsError) -> InputError {
    let value = match error.name {
        "heading_cost" => &file.cost.heading,
        "pitch_cost" => &file.cost.pitch,
        "margin_m" => &file.avoidance.margin_m,
        "confidence_sigmas" => &file.avoidance.confidence_sigmas,
        _ => &file.response.bank_time_constant_s,
    };
    match value {
        Some(value) => text.error_at(value, error.to_string()),
        None => text.error(error.to_string()),
    }
}

/// The surveillance radius of the file, or the one that follows from its other keys, metres.
fn surveillance_m(
    file: &VehicleFile,
    text: &TomlText<'_>,
    airspeed_mps: f64,
    protection: ProtectedVolume,
    settings: &Settings,
) -> Result<f64, InputError> {
    let Some(value) = &file.surveillance_radius_m else {
        let (horizon_s, margin_m) = (settings.horizon_s, settings.margin_m);
        let derived_m = surveillance::derived_m(airspeed_mps, horizon_s, protection, margin_m);
        return Ok(derived_m);
    };
    // Infinity: everything that the sensor sees.
    if *value.get_ref() == f64::INFINITY {
        return Ok(f64::INFINITY);
    }
    let radius_m = text.positive("surveillance_radius_m", value)?;
    if radius_m <= protection.radius_m() {
        let message = format!(
            "surveillance_radius_m is {radius_m}, expected more than protection.radius_m, {}",
            protection.radius_m()
        );
        return Err(text.error_at(value, message));
    }
    Ok(radius_m)
}

fn settings(file: &VehicleFile, text: TomlText<'_>) -> Result<PolicySettings, InputError> {
    let usual = Settings::default();
    let usual_drift_mps = drift_mps(&file.response);
    let (cost, avoidance) = (&file.cost, &file.avoidance);
    let avoider = Settings {
        decision_period_s: given!(text, file.decision_period_s within (0.01, 10.0); usual.decision_period_s),
        horizon_s: given!(text, avoidance.horizon_s within (1.0, 600.0); usual.horizon_s),
        margin_m: given!(text, avoidance.margin_m not_negative; usual.margin_m),
        drift_mps: given!(text, avoidance.drift_mps within (0.0, 100.0); usual_drift_mps),
        confidence_sigmas: given!(text, avoidance.confidence_sigmas not_negative; usual.confidence_sigmas),
        heading_cost: given!(text, cost.heading not_negative; usual.heading_cost),
        pitch_cost: given!(text, cost.pitch not_negative; usual.pitch_cost),
        objective: match avoidance.objective {
            ObjectiveName::PaperCost => Objective::PaperCost,
            ObjectiveName::LeastDeviation => Objective::LeastDeviation,
            ObjectiveName::ShortestPath => Objective::ShortestPath,
        },
        loss_price_m: given!(text, avoidance.loss_price_m within (100.0, 1e7); usual.loss_price_m),
        ..usual
    };
    Ok(PolicySettings {
        avoider,
        grid: checks::grid(&file.grid, text)?,
        ..PolicySettings::default()
    })
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
        let mut expected = PolicySettings::default();
        expected.avoider.surveillance_radius_m = 300.0;
        assert_eq!(model.settings, expected);
        assert_eq!(model.autopilot, Autopilot::Direct);
    }

    /// Whoever comes head-on as fast as crewed traffic and could enter within the horizon is seen.
    #[test]
    fn n1_a_surveillance_radius_that_is_not_named_follows_from_the_other_keys() {
        let text = "name='a'\nairspeed_mps=18\nturn_radius_m=30\n[protection]\nradius_m=150\n\
            half_height_m=50\n[avoidance]\nmargin_m=5\nhorizon_s=40\n";
        let model = parse(text).unwrap();
        let corner_m = (150.0_f64 * 150.0 + 50.0 * 50.0).sqrt();
        let expected_m = corner_m + 5.0 + (18.0 + 90.0) * 40.0;
        assert!((model.settings.avoider.surveillance_radius_m - expected_m).abs() < 1e-6);
        assert!(model.warnings().is_empty());
        let near = text.replace("turn", "surveillance_radius_m=300\nturn");
        let warnings = parse(&near).unwrap().warnings();
        assert!(warnings[0].starts_with("surveillance_radius_m is 300 m, too near for crewed"));
    }

    #[test]
    fn every_shipped_vehicle_is_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vehicles");
        let mut names = Vec::new();
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let model = VehicleModel::read(&path).unwrap();
            assert_eq!(model.name, path.file_stem().unwrap().to_str().unwrap());
            // The paper's radii are toy values, and only its own vehicles have them.
            let toy = model.name.starts_with("paper");
            assert_eq!(model.warnings().is_empty(), !toy, "{:?}", model.warnings());
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
            (
                "turn_radius_m=30",
                "turn_radius_m=30\nsurveillance_radius_m=30",
                "v.toml, line 4: surveillance_radius_m is 30, expected more than protection.radius_m, 30",
            ),
            (
                "radius_m=30\n[",
                "radius_m=30\n[response]\nbank_time_constant_s=4\n[",
                "v.toml, line 5: bank_time_constant_s is 4, expected 0, or 0.01 to 10, and no turn",
            ),
            (
                "radius_m=30\n[",
                "radius_m=30\n[avoidance]\nmargin_m=20000\n[",
                "v.toml, line 5: margin_m is 20000, expected 0 to 10,000",
            ),
            (
                "radius_m=30\n[",
                "radius_m=30\n[avoidance]\nconfidence_sigmas=1e5\n[",
                "v.toml, line 5: confidence_sigmas is 100000, expected 0 to 10",
            ),
            (
                "radius_m=30\n[",
                "radius_m=30\n[cost]\nheading=1e18\n[",
                "v.toml, line 5: heading_cost is 1000000000000000000, expected 0 to a million",
            ),
            ("name='a'", "name=", "v.toml, line 1: "),
        ] {
            let text = good.replacen(from, to, 1);
            let error = parse(&text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}

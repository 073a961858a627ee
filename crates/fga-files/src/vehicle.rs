//! The tables of a vehicle file. `docs/vehicle-files.md` gives the limits and defaults of each key.

use fga_formats::InputError;
use serde::Deserialize;
use toml::Spanned;

use crate::TomlText;

/// A vehicle file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleFile {
    /// Name for people.
    pub name: String,
    /// True airspeed, metres per second.
    pub airspeed_mps: Spanned<f64>,
    /// Turn radius in still air, metres; it or `max_bank_deg`.
    pub turn_radius_m: Option<Spanned<f64>>,
    /// Bank in a turn, degrees; it or `turn_radius_m`.
    pub max_bank_deg: Option<Spanned<f64>>,
    /// Steepest descent through the air, degrees, negative.
    pub climb_min_deg: Option<Spanned<f64>>,
    /// Steepest climb through the air, degrees.
    pub climb_max_deg: Option<Spanned<f64>>,
    /// Rate of change of the climb angle, radians per second.
    pub climb_rate_radps: Option<Spanned<f64>>,
    /// Obstacles farther away are not looked at, metres.
    pub surveillance_radius_m: Option<Spanned<f64>>,
    /// Time between two decisions, seconds.
    pub decision_period_s: Option<Spanned<f64>>,
    /// Volume about an obstacle without a volume of its own.
    pub protection: Protection,
    /// Altitudes of every flight.
    #[serde(default)]
    pub limits: LimitsTable,
    /// Weights of the paper's cost.
    #[serde(default)]
    pub cost: Cost,
    /// Grid of the paper's search.
    #[serde(default)]
    pub grid: GridSettings,
    /// How commands become turns.
    #[serde(default)]
    pub response: ResponseTable,
    /// Settings of decisions.
    #[serde(default)]
    pub avoidance: Avoidance,
    /// Wind of a scenario without a wind of its own.
    #[serde(default)]
    pub wind: WindTable,
    /// Noise of the sensor.
    #[serde(default)]
    pub noise: NoiseTable,
    /// The sensor.
    #[serde(default)]
    pub sensor: SensorTable,
    /// The autopilot of the simulated aircraft.
    #[serde(default)]
    pub autopilot: AutopilotTable,
    /// What the simulated aircraft does otherwise than decisions believe.
    #[serde(default)]
    pub plant: PlantTable,
}

impl VehicleFile {
    /// Reads the tables of a vehicle file.
    ///
    /// # Errors
    /// Text that is not TOML, or an unknown or missing key, with its line.
    pub fn read(text: &TomlText<'_>) -> Result<Self, InputError> {
        text.read()
    }
}

/// `[protection]`: a sphere, or a cylinder if it has a height.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Protection {
    /// Radius, metres.
    pub radius_m: Spanned<f64>,
    /// Half of a cylinder's height, metres.
    pub half_height_m: Option<Spanned<f64>>,
}

/// `[limits]` of altitude.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct LimitsTable {
    /// Lowest altitude of a manoeuvre, metres.
    pub floor_m: Option<Spanned<f64>>,
    /// Highest altitude of a manoeuvre, metres.
    pub ceiling_m: Option<Spanned<f64>>,
}

/// `[cost]`: weights, without unit.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Weight of a change of heading.
    pub heading: Option<Spanned<f64>>,
    /// Weight of a change of pitch.
    pub pitch: Option<Spanned<f64>>,
}

/// `[grid]` of the paper's rules.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct GridSettings {
    /// Largest change of heading to either side, degrees.
    pub heading_range_deg: Option<Spanned<f64>>,
    /// Step of the headings, radians.
    pub heading_step_rad: Option<Spanned<f64>>,
    /// Step of the pitches, radians.
    pub pitch_step_rad: Option<Spanned<f64>>,
}

/// `[response]`: how a command becomes a turn.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct ResponseTable {
    /// Time before anything happens, seconds.
    pub dead_time_s: Option<Spanned<f64>>,
    /// Time constant of the bank, seconds.
    pub bank_time_constant_s: Option<Spanned<f64>>,
    /// Turn rate that comes, over the one of the bank, without unit.
    pub turn_rate_factor: Option<Spanned<f64>>,
}

/// `[avoidance]`: settings of decisions.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct Avoidance {
    /// Distance kept beyond protected volumes, metres.
    pub margin_m: Option<Spanned<f64>>,
    /// Standard deviation of the velocity by which the aircraft leaves its prediction, metres per second.
    pub drift_mps: Option<Spanned<f64>>,
    /// Number of standard deviations that a volume grows by.
    pub confidence_sigmas: Option<Spanned<f64>>,
    /// How far decisions look ahead, seconds.
    pub horizon_s: Option<Spanned<f64>>,
    /// What is best among what is certified.
    #[serde(default)]
    pub objective: ObjectiveName,
    /// Price of a loss of a protected volume, metres of departure.
    pub loss_price_m: Option<Spanned<f64>>,
}

/// Word for an objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum ObjectiveName {
    /// `paper-cost`
    #[default]
    PaperCost,
    /// `least-deviation`
    LeastDeviation,
    /// `shortest-path`
    ShortestPath,
}

/// `[wind]`: the velocity of the air over the ground.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct WindTable {
    /// Towards the east, metres per second.
    pub east_mps: Option<Spanned<f64>>,
    /// Towards the north, metres per second.
    pub north_mps: Option<Spanned<f64>>,
    /// Upwards, metres per second.
    pub up_mps: Option<Spanned<f64>>,
}

/// `[noise]`: standard deviation on each axis.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct NoiseTable {
    /// On a position, metres.
    pub position_m: Option<Spanned<f64>>,
    /// On an altitude, metres; without it as on the other axes.
    pub altitude_m: Option<Spanned<f64>>,
    /// On a velocity, metres per second.
    pub velocity_mps: Option<Spanned<f64>>,
    /// Of an error that a horizontal position keeps, metres.
    pub lasting_position_m: Option<Spanned<f64>>,
    /// Of an error that an altitude keeps, metres.
    pub lasting_altitude_m: Option<Spanned<f64>>,
}

/// `[sensor]`: what is seen, and when.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct SensorTable {
    /// Range, metres.
    pub range_m: Option<Spanned<f64>>,
    /// Looks in a second.
    pub update_rate_hz: Option<Spanned<f64>>,
    /// Whether noisy looks become tracks by a Kalman filter.
    pub tracked: Option<bool>,
    /// Horizontal angle of view, degrees, half of it to either side of the course.
    pub field_of_regard_deg: Option<Spanned<f64>>,
    /// Probability that a look sees an aircraft within range and view.
    pub detection_probability: Option<Spanned<f64>>,
    /// Age of a look, seconds.
    pub delay_s: Option<Spanned<f64>>,
}

/// `[plant]`: what the simulated aircraft does otherwise than decisions believe.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct PlantTable {
    /// True airspeed, metres per second.
    pub airspeed_mps: Option<Spanned<f64>>,
    /// Rate of change of the climb angle, radians per second.
    pub climb_rate_radps: Option<Spanned<f64>>,
    /// Time before anything happens, seconds.
    pub dead_time_s: Option<Spanned<f64>>,
    /// Time constant of the bank, seconds.
    pub bank_time_constant_s: Option<Spanned<f64>>,
    /// Turn rate that comes, over the one of the bank, without unit.
    pub turn_rate_factor: Option<Spanned<f64>>,
    /// Velocity of the air beyond the wind: east, north, up, metres per second.
    pub wind_error_mps: Option<Spanned<[f64; 3]>>,
}

/// `[autopilot]` of the simulated aircraft.
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct AutopilotTable {
    /// How it follows a heading.
    #[serde(default)]
    pub kind: AutopilotKind,
    /// Proportional gain, 1/s.
    pub kp: Option<Spanned<f64>>,
    /// Integral gain, 1/s².
    pub ki: Option<Spanned<f64>>,
}

/// Word for an autopilot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Default)]
#[serde(rename_all = "lowercase")]
pub enum AutopilotKind {
    /// `direct`: turns at the limit until the heading is reached.
    #[default]
    Direct,
    /// `pi`: proportional and integral.
    Pi,
}

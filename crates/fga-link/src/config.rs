//! The configuration file of `fga fly`.
//!
//! Every key has a default, so that an empty file is valid; an unknown key is an error. Angles are in degrees and
//! speeds in metres per second, as the names say; this module converts them to the core's units.

mod check;
mod terrain;
mod volumes;

use fga_files::scenario::TerrainFiles;
use serde::Deserialize;

/// An unusable configuration.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ConfigError(pub String);

/// The whole file.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// The vehicle and its limits.
    pub vehicle: VehicleConfig,
    /// What is kept clear, and how far ahead.
    pub protection: ProtectionConfig,
    /// The protected volumes about other aircraft, by class.
    pub volumes: VolumesConfig,
    /// The commands.
    pub command: CommandConfig,
    /// The altitudes that bound a flight.
    pub limits: LimitsConfig,
    /// The ground.
    pub terrain: TerrainConfig,
    /// The conditions for acting and stopping.
    pub safety: SafetyConfig,
    /// The vehicle's response.
    pub response: ResponseConfig,
    /// Tracks of other aircraft.
    pub traffic: TrafficConfig,
    /// Alert levels.
    pub alerts: AlertsConfig,
    /// Identity and signing on the link.
    pub link: LinkConfig,
    /// Virtual obstacles.
    pub obstacle: Vec<VirtualObstacle>,
}

/// The vehicle and its limits.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VehicleConfig {
    /// System id; 0 takes the first fixed-wing autopilot on the link.
    pub system_id: u8,
    /// Largest commanded bank, degrees; at most the vehicle's own limit less 2°.
    pub max_bank_deg: f64,
    /// Largest bank if nothing is certified with that one, degrees; at most the vehicle's own
    /// limit less 2°. Unused if it equals `max_bank_deg`.
    pub max_bank_in_need_deg: f64,
    /// Whether a manoeuvre may leave the altitude.
    pub vertical: bool,
    /// Steepest climb and descent, degrees; at most what the vehicle's own climb rates allow.
    pub max_climb_deg: f64,
    /// Modes that the companion may take over, by ArduPlane's names.
    pub take_over: Vec<String>,
}

impl Default for VehicleConfig {
    fn default() -> Self {
        Self {
            system_id: 0,
            max_bank_deg: 45.0,
            max_bank_in_need_deg: 70.0,
            vertical: false,
            max_climb_deg: 8.0,
            take_over: vec!["AUTO".to_owned(), "CRUISE".to_owned()],
        }
    }
}

/// What is kept clear, and how far ahead.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProtectionConfig {
    /// Radius around every other aircraft, metres, whatever its class; without it `[volumes]` count.
    pub radius_m: Option<f64>,
    /// With a radius: half height, metres; without it the volume is a sphere.
    pub half_height_m: Option<f64>,
    /// Distance kept beyond the volume, metres.
    pub margin_m: f64,
    /// Standard deviations of the uncertainty that widen the volume.
    pub confidence_sigmas: f64,
    /// Obstacles farther away are not considered, metres; without it [`Config::surveillance_m`] derives it.
    pub surveillance_m: Option<f64>,
    /// Horizon of the certificate, seconds.
    pub horizon_s: f64,
    /// Safety score `C_s`: share of the time until the latest safe start that it waits for obstacles at rest; 0.9
    /// without it.
    pub safety_score: Option<f64>,
}

impl Default for ProtectionConfig {
    fn default() -> Self {
        Self {
            radius_m: None,
            half_height_m: None,
            margin_m: 4.0,
            confidence_sigmas: 2.0,
            surveillance_m: None,
            horizon_s: 60.0,
            safety_score: None,
        }
    }
}

/// An upright cylinder about an aircraft.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VolumeConfig {
    /// Radius, metres.
    pub radius_m: f64,
    /// Half of its height, metres.
    pub half_height_m: f64,
}

/// A near mid-air collision: 500 ft and 100 ft (RTCA DO-365).
pub const NMAC: VolumeConfig = VolumeConfig {
    radius_m: 152.4,
    half_height_m: 30.48,
};

/// The protected volumes about other aircraft, by class. `docs/how-to-choose-volumes.md` gives the sources.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VolumesConfig {
    /// Crewed aircraft, and those of unknown class.
    pub crewed: VolumeConfig,
    /// Small unmanned aircraft.
    pub small_unmanned: VolumeConfig,
    /// Gliders, balloons, airships, parachutes.
    pub glider_balloon: VolumeConfig,
}

impl Default for VolumesConfig {
    fn default() -> Self {
        Self {
            crewed: NMAC,
            // Four times the near mid-air collision of small unmanned aircraft, 50 ft and 15 ft.
            small_unmanned: VolumeConfig {
                radius_m: 60.96,
                half_height_m: 18.288,
            },
            // A balloon's envelope reaches 30 m above the basket that reports.
            glider_balloon: VolumeConfig {
                half_height_m: 60.96,
                ..NMAC
            },
        }
    }
}

impl VolumesConfig {
    /// The classes with their keys.
    const fn each(&self) -> [(&'static str, VolumeConfig); 3] {
        [
            ("crewed", self.crewed),
            ("small_unmanned", self.small_unmanned),
            ("glider_balloon", self.glider_balloon),
        ]
    }
}

/// The messages that fly the manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommandMode {
    /// GUIDED with roll and pitch by `SET_ATTITUDE_TARGET`.
    #[default]
    Attitude,
    /// GUIDED with heading and altitude commands.
    Heading,
    /// Algorithm 4: CRUISE, FBWB with roll by `RC_CHANNELS_OVERRIDE`, CRUISE.
    Paper,
}

/// The commands.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CommandConfig {
    /// The messages that fly the manoeuvre.
    pub mode: CommandMode,
    /// Rate of attitude targets, hertz.
    pub rate_hz: f64,
    /// Time from one decision to the next, seconds.
    pub decision_period_s: f64,
}

impl Default for CommandConfig {
    fn default() -> Self {
        Self {
            mode: CommandMode::Attitude,
            rate_hz: 20.0,
            decision_period_s: 0.1,
        }
    }
}

/// The altitudes that bound a flight.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LimitsConfig {
    /// Lowest altitude above home at which the companion acts and to which it descends, metres.
    pub floor_m: f64,
    /// Highest altitude above home to which it climbs, metres.
    pub ceiling_m: Option<f64>,
}

impl Default for LimitsConfig {
    fn default() -> Self {
        Self {
            floor_m: 30.0,
            ceiling_m: None,
        }
    }
}

/// The ground that manoeuvres keep above.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TerrainConfig {
    /// Files of heights, beside the configuration.
    pub file: Option<TerrainFiles>,
    /// Who is asked for the heights where no file is given.
    pub source: Option<TerrainSource>,
    /// Least height above the ground beyond its vertical error, metres.
    pub clearance_m: Option<f64>,
}

/// Who is asked for heights of the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TerrainSource {
    /// The ground station, by `TERRAIN_REQUEST`.
    GroundStation,
    /// The vehicle, by `TERRAIN_CHECK`.
    Vehicle,
}

/// The conditions for acting and stopping.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SafetyConfig {
    /// The former place of [`LimitsConfig::floor_m`].
    pub floor_m: Option<f64>,
    /// The former place of [`LimitsConfig::ceiling_m`].
    pub ceiling_m: Option<f64>,
    /// Telemetry older than this is stale, seconds.
    pub telemetry_stale_s: f64,
    /// After this long without a heartbeat the link is lost, seconds.
    pub link_lost_s: f64,
    /// The vehicle does not follow when its bank stays this far from the command, degrees …
    pub follow_tolerance_deg: f64,
    /// … for this long, seconds.
    pub follow_time_s: f64,
    /// Whether the vehicle's fence bounds the manoeuvre.
    pub use_fence: bool,
    /// Whether it may act from the start; otherwise it waits until the operator arms it.
    pub armed_at_start: bool,
}

impl Default for SafetyConfig {
    fn default() -> Self {
        Self {
            floor_m: None,
            ceiling_m: None,
            telemetry_stale_s: 1.0,
            link_lost_s: 3.5,
            follow_tolerance_deg: 15.0,
            follow_time_s: 3.0,
            use_fence: true,
            armed_at_start: true,
        }
    }
}

/// The vehicle's response; the starting point of the estimate in flight.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ResponseConfig {
    /// Flown turn rate over the ideal one, as a starting value.
    pub turn_rate_factor: f64,
    /// First-order bank lag, seconds, as a starting value.
    pub bank_time_constant_s: f64,
    /// Time from a decision until the vehicle has it, seconds.
    pub dead_time_s: f64,
    /// Whether to estimate factor and lag in flight.
    pub estimate: bool,
}

impl Default for ResponseConfig {
    fn default() -> Self {
        Self {
            turn_rate_factor: 0.68,
            bank_time_constant_s: 0.4,
            dead_time_s: 0.25,
            estimate: true,
        }
    }
}

/// Tracks of other aircraft.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrafficConfig {
    /// A track without a report for this long is dropped, seconds.
    pub drop_after_s: f64,
    /// ICAO address of the vehicle's transponder, hexadecimal.
    pub own_icao: Option<String>,
    /// Call sign of the vehicle's transponder.
    pub own_callsign: Option<String>,
    /// σ of a position without quality figures, metres.
    pub position_sigma_m: f64,
    /// What the senders of `ADSB_VEHICLE` mean by a geometric altitude.
    pub geometric: GeometricDatum,
    /// Radars and cameras that report detections.
    pub sensor: Vec<SensorConfig>,
}

/// What a geometric altitude counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GeometricDatum {
    /// Nobody has confirmed it: the volume contains every datum that the label is used for.
    #[default]
    Unconfirmed,
    /// Mean sea level, as the vehicle's own altitude does.
    SeaLevel,
    /// The WGS-84 ellipsoid.
    Ellipsoid,
}

/// A radar or a camera, identified by the sender of its `OBSTACLE_DISTANCE_3D` or `ADSB_VEHICLE`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorConfig {
    /// System id of its messages.
    pub system_id: u8,
    /// Component id of its messages.
    pub component_id: u8,
    /// σ of its positions along an axis, metres.
    pub position_sigma_m: f64,
}

impl Default for TrafficConfig {
    fn default() -> Self {
        Self {
            drop_after_s: 20.0,
            own_icao: None,
            own_callsign: None,
            position_sigma_m: 2.0,
            geometric: GeometricDatum::Unconfirmed,
            sensor: Vec::new(),
        }
    }
}

/// Which alert levels are reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlertScheme {
    /// None.
    #[default]
    Off,
    /// Four levels around the volume of ASTM F3442.
    F3442,
    /// Three levels of RTCA DO-365B, en route.
    #[serde(rename = "do-365b")]
    Do365b,
}

/// Alert levels as the standards give them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AlertsConfig {
    /// Which levels are reported.
    pub levels: AlertScheme,
    /// The level from which on a manoeuvre begins at once; below it the latest certified start is
    /// waited for. 0 leaves the start to `protection.safety_score`.
    pub act_at_level: u8,
}

impl AlertScheme {
    /// How many levels there are.
    pub const fn most(self) -> u8 {
        match self {
            Self::Off => 0,
            Self::F3442 => 4,
            Self::Do365b => 3,
        }
    }
}

/// Identity and signing on the link.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkConfig {
    /// Key of MAVLink 2 signing, 64 hexadecimal digits.
    pub signing_key: Option<String>,
    /// Whether unsigned messages are still taken when a key is set.
    pub allow_unsigned: bool,
    /// System id of the ground station, which alone may switch this component on and off; 0 takes the
    /// vehicle's `MAV_GCS_SYSID`.
    pub ground_system_id: u8,
}

/// An obstacle that only the configuration knows.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VirtualObstacle {
    /// Its name in texts and logs.
    #[serde(default)]
    pub name: String,
    /// Latitude, degrees.
    pub latitude_deg: f64,
    /// Longitude, degrees.
    pub longitude_deg: f64,
    /// Altitude of the centre above mean sea level, metres.
    pub altitude_m: f64,
    /// Protected radius, metres.
    pub radius_m: f64,
    /// Half height of a cylinder, metres; without it a sphere.
    #[serde(default)]
    pub half_height_m: Option<f64>,
    /// Direction in which it moves, degrees clockwise from north.
    #[serde(default)]
    pub track_deg: f64,
    /// Speed over the ground, metres per second.
    #[serde(default)]
    pub speed_mps: f64,
    /// Rate of climb, metres per second.
    #[serde(default)]
    pub climb_mps: f64,
}

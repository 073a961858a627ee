//! The configuration file of `fga fly`.
//!
//! Every key has a default, so that an empty file is valid; an unknown key is an error. Angles are in degrees and
//! speeds in metres per second, as the names say; this module converts them to the core's units.

mod check;
mod terrain;
mod volumes;

use fga_files::scenario::TerrainFiles;
use serde::Deserialize;
use serde::de::value::{Error as ValueError, StrDeserializer};

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

/// The tables of the file: what each key says, and its value where the file does not have it.
macro_rules! tables {
    ($($(#[$of_table:meta])* $table:ident {
        $($(#[$of_key:meta])* $key:ident: $kind:ty = $value:expr,)*
    })*) => {
        $($(#[$of_table])*
        #[derive(Debug, Clone, PartialEq, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $table {
            $($(#[$of_key])* pub $key: $kind,)*
        }

        impl Default for $table {
            fn default() -> Self {
                Self { $($key: $value,)* }
            }
        })*
    };
}

tables! {
    /// The vehicle and its limits.
    VehicleConfig {
        /// System id; 0 takes the first fixed-wing autopilot on the link.
        system_id: u8 = 0,
        /// Largest commanded bank, degrees; at most the vehicle's own limit less 2°.
        max_bank_deg: f64 = 45.0,
        /// Largest bank if nothing is certified with that one, degrees; at most the vehicle's own
        /// limit less 2°. Unused if it equals `max_bank_deg`.
        max_bank_in_need_deg: f64 = 70.0,
        /// Whether a manoeuvre may leave the altitude.
        vertical: bool = false,
        /// Steepest climb and descent, degrees; at most what the vehicle's own climb rates allow.
        max_climb_deg: f64 = 8.0,
        /// Modes that the companion may take over, by ArduPlane's names.
        take_over: Vec<String> = vec!["AUTO".to_owned(), "CRUISE".to_owned()],
    }

    /// What is kept clear, and how far ahead.
    ProtectionConfig {
        /// Radius around every other aircraft, metres, whatever its class; without it `[volumes]` count.
        radius_m: Option<f64> = None,
        /// With a radius: half height, metres; without it the volume is a sphere.
        half_height_m: Option<f64> = None,
        /// Distance kept beyond the volume, metres.
        margin_m: f64 = 4.0,
        /// Standard deviations of the uncertainty that widen the volume.
        confidence_sigmas: f64 = 2.0,
        /// Obstacles farther away are not considered, metres; without it [`Config::surveillance_m`] derives it.
        surveillance_m: Option<f64> = None,
        /// Horizon of the certificate, seconds.
        horizon_s: f64 = 60.0,
        /// Safety score `C_s`: share of the time until the latest safe start that it waits for obstacles at rest; 0.9
        /// without it.
        safety_score: Option<f64> = None,
    }

    /// The protected volumes about other aircraft, by class. `docs/how-to-choose-volumes.md` gives the sources.
    #[derive(Copy)]
    VolumesConfig {
        /// Crewed aircraft, and those of unknown class.
        crewed: VolumeConfig = NMAC,
        /// Small unmanned aircraft.
        // Four times the near mid-air collision of small unmanned aircraft, 50 ft and 15 ft.
        small_unmanned: VolumeConfig = VolumeConfig {
            radius_m: 60.96,
            half_height_m: 18.288,
        },
        /// Gliders, balloons, airships, parachutes.
        // A balloon's envelope reaches 30 m above the basket that reports.
        glider_balloon: VolumeConfig = VolumeConfig {
            half_height_m: 60.96,
            ..NMAC
        },
    }

    /// The commands.
    CommandConfig {
        /// The messages that fly the manoeuvre.
        mode: CommandMode = CommandMode::Attitude,
        /// What decides what is flown.
        policy: PolicyName = PolicyName::WorstCase,
        /// Rate of attitude targets, hertz.
        rate_hz: f64 = 20.0,
        /// Time from one decision to the next, seconds.
        decision_period_s: f64 = 0.1,
    }

    /// The altitudes that bound a flight.
    LimitsConfig {
        /// Lowest altitude above home at which the companion acts and to which it descends, metres.
        floor_m: f64 = 30.0,
        /// Highest altitude above home to which it climbs, metres.
        ceiling_m: Option<f64> = None,
    }

    /// The ground that manoeuvres keep above.
    TerrainConfig {
        /// Files of heights, beside the configuration.
        file: Option<TerrainFiles> = None,
        /// Who is asked for the heights where no file is given.
        source: Option<TerrainSource> = None,
        /// Least height above the ground beyond its vertical error, metres.
        clearance_m: Option<f64> = None,
    }

    /// The conditions for acting and stopping.
    SafetyConfig {
        /// The former place of [`LimitsConfig::floor_m`].
        floor_m: Option<f64> = None,
        /// The former place of [`LimitsConfig::ceiling_m`].
        ceiling_m: Option<f64> = None,
        /// Telemetry older than this is stale, seconds.
        telemetry_stale_s: f64 = 1.0,
        /// After this long without a heartbeat the link is lost, seconds.
        link_lost_s: f64 = 3.5,
        /// The vehicle does not follow when its bank stays this far from the command, degrees …
        follow_tolerance_deg: f64 = 15.0,
        /// … for this long, seconds.
        follow_time_s: f64 = 3.0,
        /// Whether the vehicle's fence bounds the manoeuvre.
        use_fence: bool = true,
        /// Whether it may act from the start; otherwise it waits until the operator switches it on.
        armed_at_start: bool = true,
    }

    /// The vehicle's response; the starting point of the estimate in flight.
    ResponseConfig {
        /// Flown turn rate over the ideal one, as a starting value.
        turn_rate_factor: f64 = 0.68,
        /// First-order bank lag, seconds, as a starting value.
        bank_time_constant_s: f64 = 0.4,
        /// Time from a decision until the vehicle has it, seconds.
        dead_time_s: f64 = 0.25,
        /// Whether to estimate factor and lag in flight.
        estimate: bool = true,
        /// Whether manoeuvres keep clear of what is not known of factor and lag from the start; otherwise only once the vehicle has
        /// not flown what was certified.
        margin: bool = false,
    }

    /// Tracks of other aircraft.
    TrafficConfig {
        /// A track without a report for this long is dropped, seconds.
        drop_after_s: f64 = 20.0,
        /// ICAO address of the vehicle's transponder, hexadecimal.
        own_icao: Option<String> = None,
        /// Call sign of the vehicle's transponder.
        own_callsign: Option<String> = None,
        /// σ of a position without quality figures, metres.
        position_sigma_m: f64 = 2.0,
        /// What the senders of `ADSB_VEHICLE` mean by a geometric altitude.
        geometric: GeometricDatum = GeometricDatum::Unconfirmed,
        /// Radars and cameras that report detections.
        sensor: Vec<SensorConfig> = Vec::new(),
    }

    /// Alert levels as the standards give them.
    AlertsConfig {
        /// Which levels are reported.
        levels: AlertScheme = AlertScheme::Off,
        /// The level from which on a manoeuvre begins at once; below it the latest certified start is
        /// waited for. 0 leaves the start to `protection.safety_score`.
        act_at_level: u8 = 0,
    }

    /// Identity and signing on the link.
    LinkConfig {
        /// Key of MAVLink 2 signing, 64 hexadecimal digits.
        signing_key: Option<String> = None,
        /// Whether unsigned messages are still taken when a key is set.
        allow_unsigned: bool = false,
        /// System id of the ground station, which alone may switch this component on and off; 0 takes the
        /// vehicle's `MAV_GCS_SYSID`.
        ground_system_id: u8 = 0,
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

/// What decides what is flown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PolicyName {
    /// The worst of what each aircraft may do.
    #[serde(alias = "turn-aware")]
    WorstCase,
    /// The least expected cost among what each aircraft may do, from its reports as they came.
    Belief,
}

impl PolicyName {
    /// The policy with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::deserialize(StrDeserializer::<ValueError>::new(name)).ok()
    }
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

//! The configuration file of `fga fly`.
//!
//! Every key has a default, so that an empty file is valid; an unknown key is an
//! error. Angles are in degrees and speeds in metres per second, as the names say; this module
//! converts them to the core's units.

mod volumes;

pub use volumes::{NMAC, VolumeConfig, VolumesConfig};

use fga_formats::error::toml_sentence;
use serde::Deserialize;

use crate::number::Checked;

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

/// The conditions for acting and stopping.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SafetyConfig {
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

/// The fault of a file that is no configuration, with its line.
fn in_one_sentence(error: &toml::de::Error, text: &str) -> ConfigError {
    let message = error.message();
    let limit = ["floor_m", "ceiling_m"]
        .into_iter()
        .find(|key| message.starts_with(&format!("unknown field `{key}`")));
    let message = match limit {
        Some(key) => format!("{key} is out of place, expected limits.{key}"),
        None => toml_sentence(message),
    };
    ConfigError(match error.span() {
        Some(span) => {
            let before = text.get(..span.start).unwrap_or_default();
            format!("line {}: {message}", 1 + before.matches('\n').count())
        }
        None => message,
    })
}

impl Config {
    /// Reads and checks a configuration.
    ///
    /// # Errors
    /// The fault, with the key and the expected value.
    pub fn parse(text: &str) -> Result<Self, ConfigError> {
        let config: Self = toml::from_str(text).map_err(|error| in_one_sentence(&error, text))?;
        config.check()?;
        Ok(config)
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// The first key out of range.
    pub fn check(&self) -> Result<(), ConfigError> {
        let mut checked = Checked::default();
        checked
            .within(
                "vehicle.max_bank_deg",
                self.vehicle.max_bank_deg,
                10.0,
                70.0,
            )
            .within(
                "vehicle.max_bank_in_need_deg",
                self.vehicle.max_bank_in_need_deg,
                10.0,
                70.0,
            )
            .within(
                "vehicle.max_climb_deg",
                self.vehicle.max_climb_deg,
                0.0,
                45.0,
            )
            .within("protection.margin_m", self.protection.margin_m, 0.0, 1000.0)
            .within(
                "protection.confidence_sigmas",
                self.protection.confidence_sigmas,
                0.0,
                10.0,
            )
            .within(
                "protection.horizon_s",
                self.protection.horizon_s,
                5.0,
                300.0,
            )
            .within("command.rate_hz", self.command.rate_hz, 2.0, 50.0)
            .within(
                "command.decision_period_s",
                self.command.decision_period_s,
                0.02,
                1.0,
            )
            .within("limits.floor_m", self.limits.floor_m, 0.0, 10_000.0)
            .within(
                "safety.telemetry_stale_s",
                self.safety.telemetry_stale_s,
                0.3,
                5.0,
            )
            .within("safety.link_lost_s", self.safety.link_lost_s, 1.5, 30.0)
            .within(
                "safety.follow_tolerance_deg",
                self.safety.follow_tolerance_deg,
                5.0,
                60.0,
            )
            .within("safety.follow_time_s", self.safety.follow_time_s, 1.0, 30.0)
            .within(
                "response.turn_rate_factor",
                self.response.turn_rate_factor,
                0.2,
                1.2,
            )
            .within(
                "response.bank_time_constant_s",
                self.response.bank_time_constant_s,
                0.0,
                5.0,
            )
            .within("response.dead_time_s", self.response.dead_time_s, 0.0, 3.0)
            .within(
                "traffic.drop_after_s",
                self.traffic.drop_after_s,
                2.0,
                120.0,
            )
            .within(
                "traffic.position_sigma_m",
                self.traffic.position_sigma_m,
                0.0,
                1000.0,
            );
        let most = f64::from(self.alerts.levels.most());
        let act_at = f64::from(self.alerts.act_at_level);
        checked.within("alerts.act_at_level", act_at, 0.0, most);
        self.check_optional(&mut checked);
        checked.finish().map_err(ConfigError)?;
        self.check_across()?;
        self.own_icao()?;
        self.signing_key()?;
        self.take_over()?;
        Ok(())
    }

    /// The keys that may be absent, and the obstacles.
    fn check_optional(&self, checked: &mut Checked) {
        if let Some(value) = self.protection.radius_m {
            checked.within("protection.radius_m", value, 1.0, 5000.0);
        }
        if let Some(value) = self.protection.surveillance_m {
            checked.within("protection.surveillance_m", value, 50.0, 50_000.0);
        }
        for (name, volume) in self.volumes.each() {
            let VolumeConfig {
                radius_m,
                half_height_m,
            } = volume;
            checked
                .within(&format!("volumes.{name}.radius_m"), radius_m, 1.0, 5000.0)
                .within(
                    &format!("volumes.{name}.half_height_m"),
                    half_height_m,
                    1.0,
                    5000.0,
                );
        }
        if let Some(value) = self.protection.half_height_m {
            checked.within("protection.half_height_m", value, 1.0, 5000.0);
        }
        if let Some(value) = self.protection.safety_score {
            checked.within("protection.safety_score", value, 0.0, 1.0);
        }
        if let Some(value) = self.limits.ceiling_m {
            checked.within(
                "limits.ceiling_m",
                value,
                self.limits.floor_m + 1.0,
                20_000.0,
            );
        }
        for sensor in &self.traffic.sensor {
            let sigma_m = sensor.position_sigma_m;
            checked.within("traffic.sensor.position_sigma_m", sigma_m, 0.0, 1000.0);
        }
        for obstacle in &self.obstacle {
            checked
                .within("obstacle.latitude_deg", obstacle.latitude_deg, -90.0, 90.0)
                .within(
                    "obstacle.longitude_deg",
                    obstacle.longitude_deg,
                    -360.0,
                    360.0,
                )
                .within(
                    "obstacle.altitude_m",
                    obstacle.altitude_m,
                    -1000.0,
                    100_000.0,
                )
                .within("obstacle.radius_m", obstacle.radius_m, 0.1, 50_000.0)
                .within("obstacle.track_deg", obstacle.track_deg, -360.0, 360.0)
                .within("obstacle.speed_mps", obstacle.speed_mps, 0.0, 1000.0)
                .within("obstacle.climb_mps", obstacle.climb_mps, -200.0, 200.0);
            if let Some(value) = obstacle.half_height_m {
                checked.within("obstacle.half_height_m", value, 0.1, 50_000.0);
            }
        }
    }

    /// The vehicle's ICAO address.
    ///
    /// # Errors
    /// A text that is not up to six hexadecimal digits.
    pub fn own_icao(&self) -> Result<Option<u32>, ConfigError> {
        let Some(text) = &self.traffic.own_icao else {
            return Ok(None);
        };
        u32::from_str_radix(text, 16)
            .ok()
            .filter(|address| *address <= 0x00FF_FFFF)
            .map(Some)
            .ok_or_else(|| {
                ConfigError(format!(
                    "traffic.own_icao is '{text}', expected up to six hexadecimal digits"
                ))
            })
    }

    /// The key of signing.
    ///
    /// # Errors
    /// A text that is not 64 hexadecimal digits.
    pub fn signing_key(&self) -> Result<Option<[u8; 32]>, ConfigError> {
        let Some(text) = &self.link.signing_key else {
            return Ok(None);
        };
        let error = || ConfigError("link.signing_key: expected 64 hexadecimal digits".to_owned());
        let digits: Option<Vec<u8>> = text
            .chars()
            .map(|c| c.to_digit(16).and_then(|d| u8::try_from(d).ok()))
            .collect();
        let digits = digits
            .filter(|digits| digits.len() == 64)
            .ok_or_else(error)?;
        let mut key = [0; 32];
        for (byte, pair) in key.iter_mut().zip(digits.chunks_exact(2)) {
            *byte = pair.iter().fold(0, |value, digit| value * 16 + digit);
        }
        Ok(Some(key))
    }

    /// The modes that may be taken over.
    ///
    /// # Errors
    /// A name that is no mode, or a mode that the companion cannot take over.
    pub fn take_over(&self) -> Result<Vec<crate::mode::Mode>, ConfigError> {
        self.vehicle
            .take_over
            .iter()
            .map(|name| {
                crate::mode::Mode::from_name(name).filter(|mode| mode.can_be_taken_over()).ok_or_else(|| {
                    ConfigError(format!(
                        "vehicle.take_over: '{name}' cannot be taken over, expected AUTO, CRUISE, FBWB or RTL"
                    ))
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_file_is_valid() {
        assert_eq!(Config::parse("").unwrap(), Config::default());
    }

    #[test]
    fn wrong_keys_and_ranges_are_named() {
        let error = |text: &str| Config::parse(text).unwrap_err().0;
        assert!(error("[safety]\nflor_m = 3").contains("flor_m"));
        assert_eq!(
            error("[safety]\nceiling_m = 120"),
            "line 2: ceiling_m is out of place, expected limits.ceiling_m"
        );
        assert!(error("[vehicle]\nmax_bank_deg = 90.0").contains("vehicle.max_bank_deg is 90"));
        assert!(error("[vehicle]\ntake_over = [\"GUIDED\"]").contains("GUIDED"));
        assert!(error("[traffic]\nown_icao = \"xyz\"").contains("own_icao"));
        assert!(error("[link]\nsigning_key = \"00\"").contains("64"));
        assert!(error("[response]\ndead_time_s = nan").contains("dead_time_s"));
    }

    #[test]
    fn obstacles_and_keys_are_read() {
        let key = "0f".repeat(32);
        let text = format!(
            "[link]\nsigning_key = \"{key}\"\n[[obstacle]]\nlatitude_deg = 37.6\nlongitude_deg = -122.4\naltitude_m = 100.0\nradius_m = 150.0\n"
        );
        let config = Config::parse(&text).unwrap();
        assert_eq!(config.obstacle.len(), 1);
        assert_eq!(config.signing_key().unwrap(), Some([0x0F; 32]));
    }
}

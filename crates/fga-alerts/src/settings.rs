//! The settings: horizons, dynamics, regions, memories, alerters.

use crate::hysteresis::HysteresisSettings;
use crate::quantity::PerManeuver;
use crate::units::{DEGREE_RAD, FOOT_M, FOOT_PER_MINUTE_MPS, GRAVITY_MPS2, KNOT_MPS};
use crate::volume::{DeviationFactors, Volume};
use alloc::string::String;
use alloc::vec::Vec;

/// The urgency of a band's conflict, in the order in which regions cover each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Region {
    /// No conflict.
    None,
    /// Preventive.
    Far,
    /// Corrective, in most configurations.
    Mid,
    /// Warning.
    Near,
    /// A resolution of a certain violation.
    Recovery,
}

impl Region {
    /// The three regions of conflicts, nearest first.
    pub const CONFLICTS: [Self; 3] = [Self::Near, Self::Mid, Self::Far];

    /// The region's name in configuration files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "NONE",
            Self::Far => "FAR",
            Self::Mid => "MID",
            Self::Near => "NEAR",
            Self::Recovery => "RECOVERY",
        }
    }

    /// Whether a manoeuvre into the region leads into a conflict.
    pub const fn is_conflict(self) -> bool {
        matches!(self, Self::Far | Self::Mid | Self::Near)
    }

    /// Severity of the conflict: 1 to 3, 0 without a conflict.
    pub(crate) const fn severity(self) -> u8 {
        if self.is_conflict() { self as u8 } else { 0 }
    }

    /// What belongs to this region, of what is in the order of [`Region::CONFLICTS`].
    pub(crate) fn of<T>(self, by_region: &[T; 3]) -> Option<&T> {
        by_region.get(self.conflict_index()?)
    }

    /// Index in [`Region::CONFLICTS`].
    pub(crate) fn conflict_index(self) -> Option<usize> {
        Self::CONFLICTS.iter().position(|region| *region == self)
    }
}

/// The range in which a manoeuvre may change a quantity, in its SI unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ValueRange {
    /// Least value.
    pub least: f64,
    /// Greatest value.
    pub greatest: f64,
    /// Searched range below the current value; 0 with `above` 0: down to the least; negative: down to the
    /// least.
    pub below: f64,
    /// Searched range above; see `below`.
    pub above: f64,
    /// Distance between the searched values.
    pub step: f64,
}

/// The terminal area, with its own alerter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TerminalArea {
    /// The rule inside.
    pub guidance: TerminalGuidance,
    /// Latitude of the center, radians.
    pub latitude_rad: f64,
    /// Longitude of the center, radians.
    pub longitude_rad: f64,
    /// Radius, metres.
    pub radius_m: f64,
    /// Upper altitude limit, metres.
    pub height_m: f64,
    /// The alerter inside, counted from 0.
    pub alerter: Option<usize>,
}

/// The guidance in the terminal area after a corrective alert.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TerminalGuidance {
    /// The terminal area does not count.
    #[default]
    Off,
    /// Departing: horizontal recovery stays; no descent.
    Departing,
    /// Landing: directions are all in conflict; no descent.
    Landing,
}

/// The direction bands of an ownship below its least airspeed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlowDirections {
    /// As always.
    #[default]
    Kinematic,
    /// As if a turn took no time.
    Instantaneous,
}

/// Thresholds of one alert level.
#[derive(Debug, Clone, PartialEq)]
pub struct AlertLevel {
    /// The volume whose violation alerts.
    pub volume: Volume,
    /// Time before the violation at which the alert starts, seconds.
    pub alerting_s: f64,
    /// Time before the violation within which an active alert stays on, seconds.
    pub early_alerting_s: f64,
    /// The region of bands that the level paints.
    pub region: Region,
    /// Manoeuvres of the ownship that also raise the alert, in SI units; 0 for none.
    pub spread: PerManeuver<f64>,
}

impl AlertLevel {
    /// Time before the violation within which the alert is on, if it is on already or not, seconds.
    pub(crate) const fn time_s(&self, is_on: bool) -> f64 {
        if is_on {
            self.early_alerting_s
        } else {
            self.alerting_s
        }
    }
}

/// Alert levels in the order of severity.
#[derive(Debug, Clone, PartialEq)]
pub struct Alerter {
    /// Its name.
    pub name: String,
    /// The levels; the first is level 1.
    pub levels: Vec<AlertLevel>,
}

impl Alerter {
    /// The lowest level (counted from 1) that paints a region.
    pub fn level_for(&self, region: Region) -> Option<usize> {
        self.levels
            .iter()
            .position(|level| level.region == region)
            .map(|index| index + 1)
    }

    /// A level, counted from 1.
    pub fn level(&self, number: usize) -> Option<&AlertLevel> {
        self.levels.get(number.checked_sub(1)?)
    }
}

/// All settings.
#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "switches of the file format, each for itself"
)]
pub struct AlertSettings {
    /// Horizon of conflicts, seconds.
    pub lookahead_s: f64,
    /// Searched directions to the left, radians.
    pub left_rad: f64,
    /// Searched directions to the right, radians.
    pub right_rad: f64,
    /// Step of directions, radians.
    pub direction_step_rad: f64,
    /// Least airspeed, metres per second.
    pub least_airspeed_mps: f64,
    /// Horizontal speeds, metres per second.
    pub horizontal_speed: ValueRange,
    /// Vertical speeds, metres per second.
    pub vertical_speed: ValueRange,
    /// Altitudes, metres.
    pub altitude: ValueRange,
    /// Acceleration along the flight, m/s²; 0 for instantaneous changes.
    pub horizontal_acceleration_mps2: f64,
    /// Vertical acceleration, m/s²; 0 for instantaneous changes.
    pub vertical_acceleration_mps2: f64,
    /// Turn rate, radians per second; 0 for turns by the bank angle.
    pub turn_rate_radps: f64,
    /// Bank angle, radians; if the turn rate is also 0, turns are instantaneous.
    pub bank_rad: f64,
    /// Vertical speed of altitude manoeuvres, metres per second; 0 for instantaneous ones.
    pub vertical_rate_mps: f64,
    /// Horizontal distance in recovery, metres; 0 for the TCAS II table.
    pub recovery_distance_m: f64,
    /// Vertical distance in recovery, metres; 0 for the TCAS II table.
    pub recovery_height_m: f64,
    /// The kinds of manoeuvre with recovery bands.
    pub recovers: PerManeuver<bool>,
    /// Whether recovery may shrink its distances down to the NMAC volume.
    pub shrinks_recovery: bool,
    /// Factor of one shrinking.
    pub recovery_shrinking: f64,
    /// Radius of the NMAC volume, metres.
    pub nmac_distance_m: f64,
    /// Half height of the NMAC volume, metres.
    pub nmac_height_m: f64,
    /// Time added to the time of recovery, seconds.
    pub recovery_stability_s: f64,
    /// Memory of alert levels and bands.
    pub hysteresis: HysteresisSettings,
    /// Whether a conflict band persists after the ownship enters it.
    pub bands_persist: bool,
    /// Largest difference that keeps a preferred resolution, SI units.
    pub resolution_persistence: PerManeuver<f64>,
    /// Whether conflicts ask for the most urgent aircraft's coordination. Without an
    /// urgency strategy, which no file sets, it changes nothing.
    pub coordinates_conflicts: bool,
    /// The same in recovery.
    pub coordinates_recovery: bool,
    /// Mitigated deviations of volumes without their own.
    pub deviation_factors: DeviationFactors,
    /// Range of the contours of conflict to either side, radians.
    pub contour_rad: f64,
    /// The terminal area.
    pub terminal: TerminalArea,
    /// Directions below the least airspeed.
    pub slow_directions: SlowDirections,
    /// Whether the ownship's alerter judges every aircraft.
    pub ownship_centric: bool,
    /// Whether the time of a maneuver counts against the alerting time.
    pub counts_maneuver_time: bool,
    /// The region from which on a manoeuvre is required.
    pub corrective_region: Region,
    /// The alerters.
    pub alerters: Vec<Alerter>,
}

impl Default for AlertSettings {
    /// The defaults of a file.
    fn default() -> Self {
        let unbounded_below = |least: f64, greatest: f64, step: f64| ValueRange {
            least,
            greatest,
            below: 0.0,
            above: 0.0,
            step,
        };
        Self {
            lookahead_s: 180.0,
            left_rad: 180.0 * DEGREE_RAD,
            right_rad: 180.0 * DEGREE_RAD,
            direction_step_rad: DEGREE_RAD,
            least_airspeed_mps: 10.0 * KNOT_MPS,
            horizontal_speed: unbounded_below(10.0 * KNOT_MPS, 700.0 * KNOT_MPS, 5.0 * KNOT_MPS),
            vertical_speed: unbounded_below(
                -6000.0 * FOOT_PER_MINUTE_MPS,
                6000.0 * FOOT_PER_MINUTE_MPS,
                100.0 * FOOT_PER_MINUTE_MPS,
            ),
            altitude: unbounded_below(100.0 * FOOT_M, 50_000.0 * FOOT_M, 100.0 * FOOT_M),
            horizontal_acceleration_mps2: 2.0,
            vertical_acceleration_mps2: 0.25 * GRAVITY_MPS2,
            turn_rate_radps: 3.0 * DEGREE_RAD,
            bank_rad: 0.0,
            vertical_rate_mps: 500.0 * FOOT_PER_MINUTE_MPS,
            recovery_distance_m: 0.0,
            recovery_height_m: 0.0,
            recovers: PerManeuver {
                direction: true,
                horizontal_speed: true,
                vertical_speed: true,
                altitude: true,
            },
            shrinks_recovery: false,
            recovery_shrinking: 0.1,
            nmac_distance_m: 500.0 * FOOT_M,
            nmac_height_m: 100.0 * FOOT_M,
            recovery_stability_s: 3.0,
            hysteresis: HysteresisSettings::default(),
            bands_persist: false,
            resolution_persistence: PerManeuver::default(),
            coordinates_conflicts: false,
            coordinates_recovery: false,
            deviation_factors: DeviationFactors::default(),
            contour_rad: 180.0 * DEGREE_RAD,
            terminal: TerminalArea::default(),
            slow_directions: SlowDirections::Kinematic,
            ownship_centric: true,
            counts_maneuver_time: false,
            corrective_region: Region::Near,
            alerters: Vec::new(),
        }
    }
}

impl AlertSettings {
    /// The level (counted from 1) from which on an alerter requires a manoeuvre.
    pub fn corrective_level(&self, alerter: usize) -> Option<usize> {
        self.alerters
            .get(alerter)?
            .level_for(self.corrective_region)
    }

    /// The most levels any alerter has.
    pub fn most_levels(&self) -> usize {
        self.alerters
            .iter()
            .map(|alerter| alerter.levels.len())
            .max()
            .unwrap_or(0)
    }
}

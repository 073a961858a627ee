//! The keys of the top level.

use super::Configuration;
use super::entries::{Allowed, Entries, Number};
use crate::error::InputError;
use crate::units::Dimension;
use Allowed::{Any, NotNegative, Positive};
use core::f64::consts::{PI, TAU};
use fga_alerts::volume::DeviationFactors;
use fga_alerts::{Region, SlowDirections, TerminalGuidance};

/// Names of regions that bands paint.
pub(super) const CONFLICT_REGIONS: [(&str, Region); 3] = [
    ("FAR", Region::Far),
    ("MID", Region::Mid),
    ("NEAR", Region::Near),
];

/// More steps only cost time.
const MOST_STEPS: f64 = 20_000.0;

/// The name of a key in the file: its older one where only that is there.
fn name(entries: &Entries, names: &[&'static str]) -> &'static str {
    let mut names = names.iter().copied();
    let first = names.next().unwrap_or_default();
    names
        .find(|older| !entries.has(first) && entries.has(older))
        .unwrap_or(first)
}

/// Takes the keys of a table in its order. Each has a name, perhaps an older one, the quantity (or `plain`), the numbers that it
/// accepts, its setting, and perhaps the unit in which tables show that.
macro_rules! take_numbers {
    ($entries:ident, $configuration:ident, $($name:literal $(or $older:literal)?: $measure:tt $allowed:ident
     => $($setting:ident).+ $(, shown in $unit:ident)?;)+) => {
        $(
            let key = name($entries, &[$name $(, $older)?]);
            let number = $entries.number(key, take_numbers!(@ $measure), $allowed)?;
            if let Some(Number { si, unit: _unit }) = number {
                $configuration.settings.$($setting).+ = si;
                $($configuration.units.$unit = _unit.unwrap_or($configuration.units.$unit.clone());)?
            }
        )+
    };
    (@ plain) => { None };
    (@ $dimension:ident) => { Some(Dimension::$dimension) };
}

/// The same for keys that are true or false.
macro_rules! take_booleans {
    ($entries:ident, $configuration:ident, $($name:literal $(or $older:literal)? => $($setting:ident).+;)+) => {
        $(
            let key = name($entries, &[$name $(, $older)?]);
            if let Some(value) = $entries.boolean(key)? {
                $configuration.settings.$($setting).+ = value;
            }
        )+
    };
}

/// Reads the keys of the top level.
pub(super) fn read(
    entries: &mut Entries,
    configuration: &mut Configuration,
) -> Result<(), InputError> {
    take_numbers! { entries, configuration,
        "lookahead_time": Time Positive => lookahead_s;
        "left_hdir" or "left_trk": Angle Any => left_rad;
        "right_hdir" or "right_trk": Angle Any => right_rad;
        "min_airspeed": Speed NotNegative => least_airspeed_mps;
        "min_hs" or "min_gs": Speed NotNegative => horizontal_speed.least;
        "max_hs" or "max_gs": Speed NotNegative => horizontal_speed.greatest;
        "below_relative_hs": Speed Any => horizontal_speed.below;
        "above_relative_hs": Speed Any => horizontal_speed.above;
        "step_hs" or "gs_step": Speed Positive => horizontal_speed.step, shown in horizontal_speed;
        "min_vs": Speed Any => vertical_speed.least;
        "max_vs": Speed Any => vertical_speed.greatest;
        "below_relative_vs": Speed Any => vertical_speed.below;
        "above_relative_vs": Speed Any => vertical_speed.above;
        "step_vs" or "vs_step": Speed Positive => vertical_speed.step, shown in vertical_speed;
        "min_alt": Length Any => altitude.least;
        "max_alt": Length Any => altitude.greatest;
        "below_relative_alt": Length Any => altitude.below;
        "above_relative_alt": Length Any => altitude.above;
        "step_alt" or "alt_step": Length Positive => altitude.step, shown in altitude;
        "step_hdir" or "trk_step": Angle Positive => direction_step_rad, shown in direction;
        "horizontal_accel": Acceleration NotNegative => horizontal_acceleration_mps2;
        "vertical_accel": Acceleration NotNegative => vertical_acceleration_mps2;
        "turn_rate": AngularRate NotNegative => turn_rate_radps;
        "bank_angle": Angle NotNegative => bank_rad;
        "vertical_rate": Speed NotNegative => vertical_rate_mps;
        "min_horizontal_recovery": Length NotNegative => recovery_distance_m, shown in horizontal_distance;
        "min_vertical_recovery": Length NotNegative => recovery_height_m, shown in vertical_distance;
        "ca_factor": plain Positive => recovery_shrinking;
        "horizontal_nmac": Length Positive => nmac_distance_m;
        "vertical_nmac": Length Positive => nmac_height_m;
        "recovery_stability_time": Time NotNegative => recovery_stability_s;
        "hysteresis_time" or "resolution_hysteresis_time": Time NotNegative => hysteresis.memory_s;
        "persistence_time": Time NotNegative => hysteresis.persistence_s;
        "persistence_preferred_hdir" or "max_delta_resolution_hdir": Angle NotNegative => resolution_persistence.direction;
        "persistence_preferred_hs" or "max_delta_resolution_hs": Speed NotNegative => resolution_persistence.horizontal_speed;
        "persistence_preferred_vs" or "max_delta_resolution_vs": Speed NotNegative => resolution_persistence.vertical_speed;
        "persistence_preferred_alt" or "max_delta_resolution_alt": Length NotNegative => resolution_persistence.altitude;
        "contour_thr": Angle NotNegative => contour_rad;
        "dta_latitude": Angle Any => terminal.latitude_rad;
        "dta_longitude": Angle Any => terminal.longitude_rad;
        "dta_radius": Length NotNegative => terminal.radius_m;
        "dta_height": Length NotNegative => terminal.height_m;
    }
    take_booleans! { entries, configuration,
        "recovery_hdir" or "recovery_trk" => recovers.direction;
        "recovery_hs" or "recovery_gs" => recovers.horizontal_speed;
        "recovery_vs" => recovers.vertical_speed;
        "recovery_alt" => recovers.altitude;
        "ca_bands" => shrinks_recovery;
        "bands_persistence" => bands_persist;
        "conflict_crit" => coordinates_conflicts;
        "recovery_crit" => coordinates_recovery;
        "ownship_centric_alerting" => ownship_centric;
        "bands_add_time_to_maneuver" => counts_maneuver_time;
    }
    take_factors(entries, "", &mut configuration.settings.deviation_factors)?;
    words_and_counts(entries, configuration)?;
    check(entries, configuration)
}

/// Takes the factors behind a prefix, those of the top level or of a detector of its own.
pub(super) fn take_factors(
    entries: &mut Entries,
    prefix: &str,
    factors: &mut DeviationFactors,
) -> Result<(), InputError> {
    for (key, target) in [
        ("h_pos_z_score", &mut factors.horizontal_position),
        ("h_vel_z_score_min", &mut factors.horizontal_velocity_least),
        ("h_vel_z_score_max", &mut factors.horizontal_velocity_most),
        ("v_pos_z_score", &mut factors.vertical_position),
        ("v_vel_z_score", &mut factors.vertical_velocity),
    ] {
        let number = entries.number(&format!("{prefix}{key}"), None, NotNegative)?;
        *target = number.map_or(*target, |number| number.si);
    }
    let key = format!("{prefix}h_vel_z_distance");
    if let Some(distance) = entries.number(&key, Some(Dimension::Length), NotNegative)? {
        factors.velocity_distance_m = distance.si;
    }
    Ok(())
}

/// The keys that are words or whole numbers.
fn words_and_counts(
    entries: &mut Entries,
    configuration: &mut Configuration,
) -> Result<(), InputError> {
    let settings = &mut configuration.settings;
    for (key, count) in [
        ("alerting_m", &mut settings.hysteresis.agreeing),
        ("alerting_n", &mut settings.hysteresis.remembered),
    ] {
        if let Some(found) = entries.count(key, 64)? {
            *count = found;
        }
    }
    let slow = [
        ("0", SlowDirections::Kinematic),
        ("-1", SlowDirections::Kinematic),
        ("1", SlowDirections::Instantaneous),
    ];
    if let Some(found) = entries.word("hdir_bands_below_min_as", &slow)? {
        settings.slow_directions = found;
    }
    if let Some(region) = entries.word("corrective_region", &CONFLICT_REGIONS)? {
        settings.corrective_region = region;
    }
    let guidances = [
        ("0", TerminalGuidance::Off),
        ("1", TerminalGuidance::Departing),
        ("-1", TerminalGuidance::Landing),
    ];
    if let Some(guidance) = entries.word("dta_logic", &guidances)? {
        settings.terminal.guidance = guidance;
    }
    if let Some(number) = entries.count("dta_alerter", 1000)? {
        settings.terminal.alerter = number.checked_sub(1);
    }
    Ok(())
}

/// Checks numbers against each other.
fn check(entries: &Entries, configuration: &mut Configuration) -> Result<(), InputError> {
    let settings = &mut configuration.settings;
    for side_rad in [&mut settings.left_rad, &mut settings.right_rad] {
        // An angle to one side is at most half a turn.
        let rest = *side_rad - libm::floor(*side_rad / TAU) * TAU;
        *side_rad = if rest > PI { (rest - TAU).abs() } else { rest };
    }
    let wrong = |message: String| Err(entries.missing(message));
    for (name, reach) in [
        ("hs", settings.horizontal_speed),
        ("vs", settings.vertical_speed),
        ("alt", settings.altitude),
    ] {
        if reach.least >= reach.greatest {
            return wrong(format!(
                "min_{name} is not below max_{name}, expected it below"
            ));
        }
        let steps = (reach.greatest - reach.least) / reach.step;
        if steps > MOST_STEPS {
            return wrong(format!(
                "step_{name} divides the scale into {steps:.0} steps, expected at most {MOST_STEPS}"
            ));
        }
    }
    if TAU / settings.direction_step_rad > MOST_STEPS {
        return wrong(format!(
            "step_hdir divides the circle into more than {MOST_STEPS} steps, expected fewer"
        ));
    }
    if settings.recovery_shrinking > 1.0 {
        return wrong(format!(
            "ca_factor is {}, expected more than 0 and at most 1",
            settings.recovery_shrinking
        ));
    }
    let (agreeing, remembered) = (settings.hysteresis.agreeing, settings.hysteresis.remembered);
    if agreeing > remembered {
        return wrong(format!(
            "alerting_m is {agreeing} and alerting_n {remembered}, expected m of n"
        ));
    }
    Ok(())
}

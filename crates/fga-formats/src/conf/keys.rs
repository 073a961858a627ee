//! The keys of the top level.

use super::entries::{Allowed, ConfMeasure, Entries};
use super::{Configuration, ShownUnit};
use crate::error::InputError;
use crate::units::Dimension::{Acceleration, Angle, AngularRate, Length, Speed, Time};
use core::f64::consts::{PI, TAU};
use fga_alerts::{Region, SlowDirections, TerminalGuidance};

/// Names of regions that bands paint.
pub(super) const CONFLICT_REGIONS: [(&str, Region); 3] = [
    ("FAR", Region::Far),
    ("MID", Region::Mid),
    ("NEAR", Region::Near),
];

/// An older name of a key.
const ALIASES: [(&str, &str); 15] = [
    ("left_hdir", "left_trk"),
    ("right_hdir", "right_trk"),
    ("min_hs", "min_gs"),
    ("max_hs", "max_gs"),
    ("step_hdir", "trk_step"),
    ("step_hs", "gs_step"),
    ("step_vs", "vs_step"),
    ("step_alt", "alt_step"),
    ("recovery_hdir", "recovery_trk"),
    ("recovery_hs", "recovery_gs"),
    ("hysteresis_time", "resolution_hysteresis_time"),
    ("persistence_preferred_hdir", "max_delta_resolution_hdir"),
    ("persistence_preferred_hs", "max_delta_resolution_hs"),
    ("persistence_preferred_vs", "max_delta_resolution_vs"),
    ("persistence_preferred_alt", "max_delta_resolution_alt"),
];

/// Reads keys under any of their names.
struct KeyReader<'a> {
    entries: &'a mut Entries,
}

impl KeyReader<'_> {
    /// The name of a key in the file.
    fn name(&self, key: &'static str) -> &'static str {
        let alias = ALIASES.iter().find(|(name, _)| *name == key);
        match alias {
            Some((_, alias)) if !self.entries.has(key) => alias,
            _ => key,
        }
    }

    fn set(
        &mut self,
        key: &'static str,
        measure: ConfMeasure,
        allowed: Allowed,
        target: &mut f64,
    ) -> Result<Option<ShownUnit>, InputError> {
        let number = self.entries.number(self.name(key), measure, allowed)?;
        Ok(number.and_then(|number| {
            *target = number.si;
            number
                .unit
                .map(|(symbol, factor)| ShownUnit { symbol, factor })
        }))
    }

    fn quantity(
        &mut self,
        key: &'static str,
        dimension: crate::units::Dimension,
        allowed: Allowed,
        target: &mut f64,
    ) -> Result<(), InputError> {
        self.set(key, ConfMeasure::Of(dimension), allowed, target)?;
        Ok(())
    }

    /// A quantity in the unit in which tables show it.
    fn shown(
        &mut self,
        key: &'static str,
        dimension: crate::units::Dimension,
        allowed: Allowed,
        target: &mut f64,
        unit: &mut ShownUnit,
    ) -> Result<(), InputError> {
        if let Some(found) = self.set(key, ConfMeasure::Of(dimension), allowed, target)? {
            *unit = found;
        }
        Ok(())
    }

    fn plain(
        &mut self,
        key: &'static str,
        allowed: Allowed,
        target: &mut f64,
    ) -> Result<(), InputError> {
        self.set(key, ConfMeasure::Plain, allowed, target)?;
        Ok(())
    }

    fn boolean(&mut self, key: &'static str, target: &mut bool) -> Result<(), InputError> {
        if let Some(value) = self.entries.boolean(self.name(key))? {
            *target = value;
        }
        Ok(())
    }

    fn count(&mut self, key: &'static str, target: &mut usize) -> Result<(), InputError> {
        if let Some(value) = self.entries.integer(key, 0..=64)? {
            *target = usize::try_from(value).unwrap_or(0);
        }
        Ok(())
    }
}

/// Reads the keys of the top level.
pub(super) fn read(
    entries: &mut Entries,
    configuration: &mut Configuration,
) -> Result<(), InputError> {
    let mut reader = KeyReader { entries };
    scales(&mut reader, configuration)?;
    dynamics(&mut reader, configuration)?;
    recovery(&mut reader, configuration)?;
    memory(&mut reader, configuration)?;
    alerting(&mut reader, configuration)?;
    terminal(&mut reader, configuration)
}

use Allowed::{Any, NotNegative, Positive};

/// Horizon and scales.
fn scales(reader: &mut KeyReader, configuration: &mut Configuration) -> Result<(), InputError> {
    let Configuration { settings, units } = configuration;
    reader.quantity("lookahead_time", Time, Positive, &mut settings.lookahead_s)?;
    reader.quantity("left_hdir", Angle, Any, &mut settings.left_rad)?;
    reader.quantity("right_hdir", Angle, Any, &mut settings.right_rad)?;
    for side_rad in [&mut settings.left_rad, &mut settings.right_rad] {
        // An angle to one side is at most half a turn.
        let rest = *side_rad - libm::floor(*side_rad / TAU) * TAU;
        *side_rad = if rest > PI { (rest - TAU).abs() } else { rest };
    }
    let airspeed = &mut settings.least_airspeed_mps;
    reader.quantity("min_airspeed", Speed, NotNegative, airspeed)?;
    let reach = &mut settings.horizontal_speed;
    reader.quantity("min_hs", Speed, NotNegative, &mut reach.least)?;
    reader.quantity("max_hs", Speed, NotNegative, &mut reach.greatest)?;
    reader.quantity("below_relative_hs", Speed, Any, &mut reach.below)?;
    reader.quantity("above_relative_hs", Speed, Any, &mut reach.above)?;
    let unit = &mut units.horizontal_speed;
    reader.shown("step_hs", Speed, Positive, &mut reach.step, unit)?;
    let reach = &mut settings.vertical_speed;
    reader.quantity("min_vs", Speed, Any, &mut reach.least)?;
    reader.quantity("max_vs", Speed, Any, &mut reach.greatest)?;
    reader.quantity("below_relative_vs", Speed, Any, &mut reach.below)?;
    reader.quantity("above_relative_vs", Speed, Any, &mut reach.above)?;
    let unit = &mut units.vertical_speed;
    reader.shown("step_vs", Speed, Positive, &mut reach.step, unit)?;
    let reach = &mut settings.altitude;
    reader.quantity("min_alt", Length, Any, &mut reach.least)?;
    reader.quantity("max_alt", Length, Any, &mut reach.greatest)?;
    reader.quantity("below_relative_alt", Length, Any, &mut reach.below)?;
    reader.quantity("above_relative_alt", Length, Any, &mut reach.above)?;
    let unit = &mut units.altitude;
    reader.shown("step_alt", Length, Positive, &mut reach.step, unit)?;
    let step = &mut settings.direction_step_rad;
    reader.shown("step_hdir", Angle, Positive, step, &mut units.direction)?;
    for (name, reach) in [
        ("hs", settings.horizontal_speed),
        ("vs", settings.vertical_speed),
        ("alt", settings.altitude),
    ] {
        if reach.least >= reach.greatest {
            return Err(reader.entries.missing(format!(
                "min_{name} is not below max_{name}, expected it below"
            )));
        }
        let steps = (reach.greatest - reach.least) / reach.step;
        if steps > MOST_STEPS {
            return Err(reader.entries.missing(format!(
                "step_{name} divides the scale into {steps:.0} steps, expected at most {MOST_STEPS}"
            )));
        }
    }
    if TAU / settings.direction_step_rad > MOST_STEPS {
        return Err(reader.entries.missing(format!(
            "step_hdir divides the circle into more than {MOST_STEPS} steps, expected fewer"
        )));
    }
    Ok(())
}

/// More steps only cost time.
const MOST_STEPS: f64 = 20_000.0;

fn dynamics(reader: &mut KeyReader, configuration: &mut Configuration) -> Result<(), InputError> {
    let settings = &mut configuration.settings;
    let acceleration = &mut settings.horizontal_acceleration_mps2;
    reader.quantity("horizontal_accel", Acceleration, NotNegative, acceleration)?;
    let acceleration = &mut settings.vertical_acceleration_mps2;
    reader.quantity("vertical_accel", Acceleration, NotNegative, acceleration)?;
    let rate = &mut settings.turn_rate_radps;
    reader.quantity("turn_rate", AngularRate, NotNegative, rate)?;
    reader.quantity("bank_angle", Angle, NotNegative, &mut settings.bank_rad)?;
    let rate = &mut settings.vertical_rate_mps;
    reader.quantity("vertical_rate", Speed, NotNegative, rate)
}

fn recovery(reader: &mut KeyReader, configuration: &mut Configuration) -> Result<(), InputError> {
    let Configuration { settings, units } = configuration;
    reader.shown(
        "min_horizontal_recovery",
        Length,
        NotNegative,
        &mut settings.recovery_distance_m,
        &mut units.horizontal_distance,
    )?;
    reader.shown(
        "min_vertical_recovery",
        Length,
        NotNegative,
        &mut settings.recovery_height_m,
        &mut units.vertical_distance,
    )?;
    reader.boolean("recovery_hdir", &mut settings.recovers.direction)?;
    reader.boolean("recovery_hs", &mut settings.recovers.horizontal_speed)?;
    reader.boolean("recovery_vs", &mut settings.recovers.vertical_speed)?;
    reader.boolean("recovery_alt", &mut settings.recovers.altitude)?;
    reader.boolean("ca_bands", &mut settings.shrinks_recovery)?;
    reader.plain("ca_factor", Positive, &mut settings.recovery_shrinking)?;
    if settings.recovery_shrinking > 1.0 {
        let message = format!(
            "ca_factor is {}, expected more than 0 and at most 1",
            settings.recovery_shrinking
        );
        return Err(reader.entries.missing(message));
    }
    let distance = &mut settings.nmac_distance_m;
    reader.quantity("horizontal_nmac", Length, Positive, distance)?;
    let height = &mut settings.nmac_height_m;
    reader.quantity("vertical_nmac", Length, Positive, height)
}

fn memory(reader: &mut KeyReader, configuration: &mut Configuration) -> Result<(), InputError> {
    let settings = &mut configuration.settings;
    let stability = &mut settings.recovery_stability_s;
    reader.quantity("recovery_stability_time", Time, NotNegative, stability)?;
    let hysteresis = &mut settings.hysteresis;
    reader.quantity(
        "hysteresis_time",
        Time,
        NotNegative,
        &mut hysteresis.memory_s,
    )?;
    let persistence = &mut hysteresis.persistence_s;
    reader.quantity("persistence_time", Time, NotNegative, persistence)?;
    reader.count("alerting_m", &mut hysteresis.agreeing)?;
    reader.count("alerting_n", &mut hysteresis.remembered)?;
    if hysteresis.agreeing > hysteresis.remembered {
        let message = format!(
            "alerting_m is {} and alerting_n {}, expected m of n",
            hysteresis.agreeing, hysteresis.remembered
        );
        return Err(reader.entries.missing(message));
    }
    reader.boolean("bands_persistence", &mut settings.bands_persist)?;
    let kept = &mut settings.resolution_persistence;
    reader.quantity(
        "persistence_preferred_hdir",
        Angle,
        NotNegative,
        &mut kept.direction,
    )?;
    let speed = &mut kept.horizontal_speed;
    reader.quantity("persistence_preferred_hs", Speed, NotNegative, speed)?;
    let climb = &mut kept.vertical_speed;
    reader.quantity("persistence_preferred_vs", Speed, NotNegative, climb)?;
    reader.quantity(
        "persistence_preferred_alt",
        Length,
        NotNegative,
        &mut kept.altitude,
    )
}

/// Coordination, deviations, contours, regions.
fn alerting(reader: &mut KeyReader, configuration: &mut Configuration) -> Result<(), InputError> {
    let settings = &mut configuration.settings;
    reader.boolean("conflict_crit", &mut settings.coordinates_conflicts)?;
    reader.boolean("recovery_crit", &mut settings.coordinates_recovery)?;
    let factors = &mut settings.deviation_factors;
    reader.plain(
        "h_pos_z_score",
        NotNegative,
        &mut factors.horizontal_position,
    )?;
    let least = &mut factors.horizontal_velocity_least;
    reader.plain("h_vel_z_score_min", NotNegative, least)?;
    let most = &mut factors.horizontal_velocity_most;
    reader.plain("h_vel_z_score_max", NotNegative, most)?;
    let distance = &mut factors.velocity_distance_m;
    reader.quantity("h_vel_z_distance", Length, NotNegative, distance)?;
    reader.plain("v_pos_z_score", NotNegative, &mut factors.vertical_position)?;
    reader.plain("v_vel_z_score", NotNegative, &mut factors.vertical_velocity)?;
    reader.quantity("contour_thr", Angle, NotNegative, &mut settings.contour_rad)?;
    let slow = [
        ("0", SlowDirections::Kinematic),
        ("-1", SlowDirections::Kinematic),
        ("1", SlowDirections::Instantaneous),
    ];
    if let Some(found) = reader.entries.word("hdir_bands_below_min_as", &slow)? {
        settings.slow_directions = found;
    }
    reader.boolean("ownship_centric_alerting", &mut settings.ownship_centric)?;
    let counts = &mut settings.counts_maneuver_time;
    reader.boolean("bands_add_time_to_maneuver", counts)?;
    let region = reader
        .entries
        .word("corrective_region", &CONFLICT_REGIONS)?;
    if let Some(region) = region {
        settings.corrective_region = region;
    }
    Ok(())
}

fn terminal(reader: &mut KeyReader, configuration: &mut Configuration) -> Result<(), InputError> {
    let area = &mut configuration.settings.terminal;
    let guidances = [
        ("0", TerminalGuidance::Off),
        ("1", TerminalGuidance::Departing),
        ("-1", TerminalGuidance::Landing),
    ];
    if let Some(guidance) = reader.entries.word("dta_logic", &guidances)? {
        area.guidance = guidance;
    }
    reader.quantity("dta_latitude", Angle, Any, &mut area.latitude_rad)?;
    reader.quantity("dta_longitude", Angle, Any, &mut area.longitude_rad)?;
    reader.quantity("dta_radius", Length, NotNegative, &mut area.radius_m)?;
    reader.quantity("dta_height", Length, NotNegative, &mut area.height_m)?;
    if let Some(number) = reader.entries.integer("dta_alerter", 0..=1000)? {
        area.alerter = usize::try_from(number).unwrap_or(0).checked_sub(1);
    }
    Ok(())
}

//! Alerters, their levels and their detectors.

use super::entries::{Allowed, Entries};
use super::keys::{CONFLICT_REGIONS, take_factors};
use crate::error::{InputError, shown};
use crate::units::Dimension::{self, Angle, Length, Speed, Time};
use fga_alerts::volume::{
    Advisory, Cylinder, DeviationFactors, HorizontalTime, Sensitivity, UncertainWellClear,
    VerticalTime, Volume, WellClear,
};
use fga_alerts::{AlertLevel, AlertSettings, Alerter, PerManeuver, Region, TerminalGuidance};

/// The most levels of an alerter.
const MOST_LEVELS: usize = 100;

/// Reads the alerters.
pub(super) fn read(entries: &mut Entries, settings: &mut AlertSettings) -> Result<(), InputError> {
    let factors = settings.deviation_factors;
    if let Some((line, text)) = entries.text("conflict_level") {
        // A file of DAIDALUS 1: one alerter without a prefix.
        let alerter = alerter(entries, "default", "", &factors)?;
        let level: usize = text.parse().unwrap_or(0);
        let Some(corrective) = alerter.level(level) else {
            return Err(entries.refused(
                line,
                format!(
                    "conflict_level is {}, expected a level from 1 to {}",
                    shown(&text),
                    alerter.levels.len()
                ),
            ));
        };
        settings.corrective_region = corrective.region;
        settings.alerters = vec![alerter];
    } else {
        let Some((line, text)) = entries.text("alerters") else {
            return Err(entries.missing("has no alerters, expected a key alerters"));
        };
        let names = text.split([',', ' ', '\t']).filter(|name| !name.is_empty());
        settings.alerters = names
            .map(|name| alerter(entries, name, &format!("{name}_"), &factors))
            .collect::<Result<_, _>>()?;
        if settings.alerters.is_empty() {
            return Err(entries.refused(line, "alerters is empty, expected a name"));
        }
    }
    let count = settings.alerters.len();
    let is_none = (settings.terminal.alerter).is_some_and(|index| index >= count);
    if is_none && settings.terminal.guidance == TerminalGuidance::Off {
        // Without guidance in the terminal area nothing uses the alerter.
        settings.terminal.alerter = None;
    } else if is_none {
        return Err(entries.missing(format!(
            "dta_alerter names none of the {count} alerters, expected a number from 0 to {count}"
        )));
    }
    Ok(())
}

fn alerter(
    entries: &mut Entries,
    name: &str,
    prefix: &str,
    factors: &DeviationFactors,
) -> Result<Alerter, InputError> {
    let mut levels = Vec::new();
    let mut used: Vec<(String, Volume)> = Vec::new();
    for number in 1..=MOST_LEVELS {
        let prefix_of_level = format!("{prefix}alert_{number}_");
        if entries.after(&prefix_of_level).is_empty() {
            break;
        }
        levels.push(level(
            entries,
            prefix,
            &prefix_of_level,
            factors,
            &mut used,
        )?);
    }
    if levels.is_empty() {
        return Err(entries.missing(format!(
            "the alerter {name} has no levels, expected keys {prefix}alert_1_…"
        )));
    }
    // Detectors that no level uses are read too, so that their keys are known.
    for detector in entries.after(&format!("{prefix}load_core_detection_")) {
        volume(entries, prefix, &detector, factors)?;
    }
    Ok(Alerter {
        name: name.to_owned(),
        levels,
    })
}

fn level(
    entries: &mut Entries,
    alerter: &str,
    prefix: &str,
    factors: &DeviationFactors,
    used: &mut Vec<(String, Volume)>,
) -> Result<AlertLevel, InputError> {
    let regions: Vec<(&str, Region)> = [("NONE", Region::None)]
        .into_iter()
        .chain(CONFLICT_REGIONS)
        .collect();
    let region_key = format!("{prefix}region");
    let region = entries
        .word(&region_key, &regions)?
        .ok_or_else(|| entries.missing(format!("the key {region_key} is missing")))?;
    let alerting_s = quantity(entries, &format!("{prefix}alerting_time"), Time)?.unwrap_or(0.0);
    let early_s = quantity(entries, &format!("{prefix}early_alerting_time"), Time)?;
    let mut spread = |name: &str, older: &str, dimension| -> Result<f64, InputError> {
        let found = quantity(entries, &format!("{prefix}spread_{name}"), dimension)?;
        match found {
            Some(value) => Ok(value),
            None if older.is_empty() => Ok(0.0),
            None => {
                let older = format!("{prefix}spread_{older}");
                Ok(quantity(entries, &older, dimension)?.unwrap_or(0.0))
            }
        }
    };
    let spread = PerManeuver {
        direction: spread("hdir", "trk", Angle)?,
        horizontal_speed: spread("hs", "gs", Speed)?,
        vertical_speed: spread("vs", "", Speed)?,
        altitude: spread("alt", "", Length)?,
    };
    let detector_key = format!("{prefix}detector");
    let Some((_, detector)) = entries.text(&detector_key) else {
        return Err(entries.missing(format!("the key {detector_key} is missing")));
    };
    let known = used.iter().find(|(name, _)| *name == detector);
    let volume = if let Some((_, volume)) = known {
        volume.clone()
    } else {
        let volume = volume(entries, alerter, &detector, factors)?;
        used.push((detector, volume.clone()));
        volume
    };
    Ok(AlertLevel {
        volume,
        alerting_s,
        early_alerting_s: early_s.unwrap_or(alerting_s).max(alerting_s),
        region,
        spread,
    })
}

/// A quantity of 0 or more, in SI units.
fn quantity(
    entries: &mut Entries,
    key: &str,
    dimension: Dimension,
) -> Result<Option<f64>, InputError> {
    let number = entries.number(key, Some(dimension), Allowed::NotNegative)?;
    Ok(number.map(|number| number.si))
}

/// The volume of a detector of an alerter.
fn volume(
    entries: &mut Entries,
    alerter: &str,
    detector: &str,
    factors: &DeviationFactors,
) -> Result<Volume, InputError> {
    let class_key = format!("{alerter}load_core_detection_{detector}");
    let Some((line, class)) = entries.text(&class_key) else {
        return Err(entries.missing(format!(
            "the key {class_key} is missing, expected the class of the detector {detector}"
        )));
    };
    let prefix = format!("{alerter}{detector}_");
    // The detector's own name is its identifier.
    entries.text(&format!("{prefix}id"));
    let class_name = class.rsplit('.').next().unwrap_or_default();
    let times = match class_name {
        "WCV_TCPA" => (HorizontalTime::ClosestApproach, VerticalTime::Coaltitude),
        "WCV_TEP" => (HorizontalTime::Entry, VerticalTime::Coaltitude),
        "WCV_HZ" => (HorizontalTime::ModifiedTau, VerticalTime::RelativeClimb),
        _ => (HorizontalTime::ModifiedTau, VerticalTime::Coaltitude),
    };
    match class_name {
        "WCV_TAUMOD" | "WCV_TCPA" | "WCV_TEP" | "WCV_HZ" => {
            Ok(Volume::WellClear(thresholds(entries, &prefix, times)?))
        }
        "WCV_TAUMOD_SUM" => {
            let (volume, mut factors) = (thresholds(entries, &prefix, times)?, *factors);
            take_factors(entries, &prefix, &mut factors)?;
            Ok(Volume::Uncertain(UncertainWellClear { volume, factors }))
        }
        "CDCylinder" => {
            let default = Cylinder::CD3D;
            let radius_m = quantity(entries, &format!("{prefix}D"), Length)?;
            let half_height_m = quantity(entries, &format!("{prefix}H"), Length)?;
            Ok(Volume::Cylinder(Cylinder::new(
                radius_m.unwrap_or(default.radius_m),
                half_height_m.unwrap_or(default.half_height_m),
            )))
        }
        "TCAS3D" => advisory(entries, &prefix, line),
        _ => Err(entries.refused(
            line,
            format!(
                "{class_key} is {}, expected WCV_TAUMOD, WCV_TAUMOD_SUM, WCV_TCPA, WCV_TEP, WCV_HZ, \
                 CDCylinder or TCAS3D",
                shown(&class)
            ),
        )),
    }
}

fn thresholds(
    entries: &mut Entries,
    prefix: &str,
    (horizontal_time, vertical_time): (HorizontalTime, VerticalTime),
) -> Result<WellClear, InputError> {
    let mut threshold = |key: &str, dimension| -> Result<f64, InputError> {
        let key = format!("{prefix}WCV_{key}");
        let found = quantity(entries, &key, dimension)?;
        found.ok_or_else(|| entries.missing(format!("the key {key} is missing")))
    };
    let volume = WellClear::do_365(
        threshold("DTHR", Length)?,
        threshold("TTHR", Time)?,
        threshold("ZTHR", Length)?,
        threshold("TCOA", Time)?,
    );
    Ok(WellClear {
        horizontal_time,
        vertical_time,
        ..volume
    })
}

fn advisory(entries: &mut Entries, prefix: &str, line: u64) -> Result<Volume, InputError> {
    let filters = entries.boolean(&format!("{prefix}TCAS_HMDFilter"))?;
    let bounds = entries
        .after(&format!("{prefix}TCAS_level_"))
        .iter()
        .filter_map(|number| number.parse::<usize>().ok())
        .max()
        .unwrap_or(0)
        .min(MOST_LEVELS);
    let mut levels = Vec::new();
    for number in 1..=bounds + 1 {
        let mut value = |key: &str, dimension| -> Result<f64, InputError> {
            let key = format!("{prefix}TCAS_{key}_{number}");
            Ok(quantity(entries, &key, dimension)?.unwrap_or(0.0))
        };
        levels.push(Sensitivity {
            up_to_m: if number <= bounds {
                value("level", Length)?
            } else {
                f64::INFINITY
            },
            tau_s: value("TAU", Time)?,
            coaltitude_s: value("TCOA", Time)?,
            distance_m: value("DMOD", Length)?,
            miss_distance_m: value("HMD", Length)?,
            height_m: value("ZTHR", Length)?,
        });
    }
    Advisory::new(levels, filters.unwrap_or(false))
        .map(Volume::Advisory)
        .ok_or_else(|| {
            entries.refused(
                line,
                format!("the altitudes of {prefix}TCAS_level_… do not grow, expected them to"),
            )
        })
}

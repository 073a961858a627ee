//! The safety case of a campaign: what its rows say, the worst encounters flown again, what was assumed.

use std::path::Path;

use fga::situation::ProtectedVolume;
use fga::vehicle::Vehicle;
use fga_campaign::campaign::risk::{LossCount, PolicyRisk, RiskClass, RiskRatio, Risks};
use fga_campaign::campaign::{Campaign, CampaignError, Folder, Manifest, Row, RowFiles};
use fga_campaign::drawn::TRACKS;
use fga_campaign::recorded::RecordingSource;
use fga_formats::atomic;
use fga_report::interval::Estimate;
use fga_report::safety_case::{Assumed, ClassCase, Lost, PolicyCase, SafetyCase, WorstCase};
use fga_sim::policy::PolicyChoice;
use fga_sim::sensor::SensorSettings;

use crate::replay_page;
use crate::worst::Worst;

/// Folder of the replays beside the page.
const REPLAYS: &str = "worst";

/// Most turns from away to back, or the reverse, in a calm flight.
const RESTLESS: f64 = 3.0;

/// The safety case of a complete campaign, with replay pages of the `worst` worst encounters of each policy beside it; each page
/// also shows the flight of the policy `beside`, if it is another one.
///
/// # Errors
/// A table that cannot be read, or a folder that cannot be written.
pub fn safety_case(
    campaign: &Campaign,
    manifest: &Manifest,
    folder: &Folder,
    worst: usize,
    beside: Option<&PolicyChoice>,
) -> Result<SafetyCase, CampaignError> {
    with_traffic(campaign, manifest, folder, (worst, beside), None)
}

/// The same with losses in a flight hour, for traffic of a density, aircraft in a cubic kilometre.
///
/// # Errors
/// As [`safety_case`]; encounters that stand for no cylinder of an uncorrelated model.
pub fn with_traffic(
    campaign: &Campaign,
    manifest: &Manifest,
    folder: &Folder,
    (worst, beside): (usize, Option<&PolicyChoice>),
    per_km3: Option<f64>,
) -> Result<SafetyCase, CampaignError> {
    let cylinder_m = campaign.cylinder_m();
    if per_km3.is_some() && cylinder_m.is_none() {
        return Err(CampaignError::Other(
            "--traffic-per-km3 needs encounters of uncorrelated models alone, with one cylinder_m: others stand for no volume of traffic"
                .into(),
        ));
    }
    let mut gathered = Gathered::new(campaign, worst);
    RowFiles::of(folder)?.read(campaign, |row| gathered.take(row))?;
    let (weight, slowness) = gathered.weights;
    let mut case = gathered.case(campaign, manifest, folder.path(), beside)?;
    case.per_hour = per_km3.zip(cylinder_m).map(|(per_km3, cylinder_m)| {
        // The model draws intruders in proportion to the relative speed: the mean over the traffic is harmonic.
        let mean_mps = weight / slowness.max(1e-12);
        (per_km3, encounters_per_h(per_km3, cylinder_m, mean_mps))
    });
    Ok(case)
}

/// Closest approaches within a cylinder in a flight hour: density times the cross section, 2 radii wide and 2 half heights high, times the mean relative
/// speed.
fn encounters_per_h(per_km3: f64, [radius_m, half_height_m]: [f64; 2], mean_mps: f64) -> f64 {
    const SECONDS: f64 = 3600.0;
    const KM3_PER_M3: f64 = 1e-9;
    per_km3 * KM3_PER_M3 * 4.0 * radius_m * half_height_m * mean_mps * SECONDS
}

/// The content of the rows.
struct Gathered {
    risks: Risks,
    policies: Vec<PolicyCase>,
    worst: Vec<Worst<Row>>,
    nominal_horizontal_m: Vec<f64>,
    corrective_leads_s: Vec<f64>,
    warning_leads_s: Vec<f64>,
    /// Weights of the encounters of the first policy, and weights over the horizontal relative speeds.
    weights: (f64, f64),
}

impl Gathered {
    fn new(campaign: &Campaign, worst: usize) -> Self {
        let policies = &campaign.configuration.policies;
        Self {
            risks: Risks::default(),
            policies: policies
                .iter()
                .map(|policy| PolicyCase {
                    policy: policy.clone(),
                    ..PolicyCase::default()
                })
                .collect(),
            worst: policies.iter().map(|_| Worst::new(worst)).collect(),
            nominal_horizontal_m: Vec::new(),
            corrective_leads_s: Vec::new(),
            warning_leads_s: Vec::new(),
            weights: (0.0, 0.0),
        }
    }

    fn take(&mut self, row: &Row) {
        self.risks.take(row);
        let metrics = &row.metrics;
        let is_lost = metrics.nominal_lowc == Some(true);
        if row.policy == 0 {
            self.nominal_horizontal_m
                .extend(metrics.nominal_horizontal_m);
            let level_mps = metrics.closing_mps.zip(metrics.intruder_climb_mps);
            if let Some((closing_mps, climb_mps)) = level_mps {
                let square = closing_mps * closing_mps - climb_mps * climb_mps;
                self.weights.0 += row.weight;
                self.weights.1 += row.weight / libm::sqrt(square.max(1.0));
            }
            if is_lost {
                self.corrective_leads_s.extend(metrics.corrective_s);
                self.warning_leads_s.extend(metrics.warning_s);
            }
        }
        let index = row.policy as usize;
        if let Some(worst) = self.worst.get_mut(index)
            && let Some(badness) = badness(row)
        {
            worst.take([badness, row.min_separation_m], *row);
        }
        let Some(policy) = self.policies.get_mut(index) else {
            return;
        };
        policy.failed += u64::from(metrics.policy_failure.is_some());
        policy.horizontal_m.extend(metrics.horizontal_m);
        policy.severities.extend(metrics.severity);
        policy.restless += u64::from(metrics.changes.is_some_and(|changes| changes > RESTLESS));
        if row.start_s.is_some() {
            policy.not_back += u64::from(row.rejoined_s.is_none());
            policy.departures_m.push(row.max_cross_track_m);
            policy.away_s.extend(row.time_away_s());
            if is_lost {
                policy.action_leads_s.extend(metrics.action_s);
            }
        }
    }

    fn case(
        mut self,
        campaign: &Campaign,
        manifest: &Manifest,
        folder: &Path,
        beside: Option<&PolicyChoice>,
    ) -> Result<SafetyCase, CampaignError> {
        let worst = self.fly_worst(campaign, folder, beside)?;
        let configuration = &campaign.configuration;
        for (index, case) in (0..).zip(&mut self.policies) {
            let Some(risk) = self.risks.of(index) else {
                continue;
            };
            let [nmac, lowc, do365] = &risk.losses;
            case.nmac = lost(nmac, risk, true);
            case.nmac.tail = risk.tail().map(|tail| {
                let estimate = Estimate {
                    value: tail.ratio,
                    low: tail.interval.low,
                    high: tail.interval.high,
                };
                (tail.above, estimate)
            });
            case.lowc = lost(lowc, risk, true);
            case.do365 = lost(do365, risk, false);
            case.acted = risk.acted;
            case.needless = lowc.needless;
            case.clear = lowc.clear;
        }
        let first = self.risks.of(0);
        Ok(SafetyCase {
            name: configuration.name.clone(),
            facts: vec![
                ("version".into(), configuration.version.clone()),
                ("commit".into(), manifest.stamp.commit.clone()),
                ("target".into(), manifest.stamp.target.clone()),
                (
                    "configuration".into(),
                    campaign.hash.chars().take(16).collect(),
                ),
                ("vehicle".into(), campaign.model.name.clone()),
            ],
            encounters: first.map_or(0, |risk| risk.encounters),
            effective: first.map_or(0.0, PolicyRisk::effective),
            classes: self.classes(campaign),
            policies: self.policies,
            nominal_horizontal_m: self.nominal_horizontal_m,
            corrective_leads_s: self.corrective_leads_s,
            warning_leads_s: self.warning_leads_s,
            worst,
            assumed: assumed(campaign),
            stands_for: stands_for(campaign),
            per_hour: None,
            traffic_source: None,
            is_stress: !campaign.configuration.recordings.is_empty(),
            reactions: reactions(campaign),
        })
    }

    fn classes(&self, campaign: &Campaign) -> Vec<ClassCase> {
        let policies = &campaign.configuration.policies;
        let is_one_source = campaign.source_names().len() == 1;
        self.risks
            .iter()
            .filter(|(_, class, _)| {
                **class != RiskClass::All
                    && !(is_one_source && matches!(class, RiskClass::Source(_)))
            })
            .filter_map(|(policy, class, risk)| {
                let policy = policies.get(policy as usize)?;
                let [nmac, lowc, _] = &risk.losses;
                (policy != "none").then(|| ClassCase {
                    policy: policy.clone(),
                    class: class.name(campaign.source_names()),
                    encounters: risk.encounters,
                    nmac: lost(nmac, risk, false),
                    lowc: lost(lowc, risk, false),
                })
            })
            .collect()
    }

    /// Flies the worst encounters again and writes their replay pages.
    fn fly_worst(
        &mut self,
        campaign: &Campaign,
        folder: &Path,
        beside: Option<&PolicyChoice>,
    ) -> Result<Vec<WorstCase>, CampaignError> {
        let replays = folder.join(REPLAYS);
        let mut cases = Vec::new();
        let policies = campaign
            .configuration
            .policies
            .iter()
            .zip(&campaign.policies);
        for ((name, policy), worst) in policies.zip(core::mem::take(&mut self.worst)) {
            if name == "none" {
                continue;
            }
            for row in worst.into_items() {
                atomic::prepare_folder(&replays)?;
                let mut logs = vec![campaign.show(row.encounter, policy)?];
                if let Some(beside) = beside.filter(|beside| *beside != policy) {
                    logs.push(campaign.show(row.encounter, beside)?);
                }
                let file = format!("{}-{}.html", row.encounter, file_name(name));
                atomic::write(&replays.join(&file), replay_page::page(&logs))?;
                let called = row
                    .name
                    .and_then(|name| campaign.encounter_names().get(name as usize));
                let metrics = &row.metrics;
                cases.push(WorstCase {
                    policy: name.clone(),
                    encounter: called
                        .map_or_else(|| format!("encounter {}", row.encounter), Clone::clone),
                    what: in_words(&row),
                    separation_m: [
                        metrics.nominal_horizontal_m.zip(metrics.nominal_vertical_m),
                        metrics.horizontal_m.zip(metrics.vertical_m),
                    ],
                    href: format!("{REPLAYS}/{file}"),
                });
            }
        }
        Ok(cases)
    }
}

/// A policy's name in the name of a file.
pub fn file_name(policy: &str) -> String {
    let part = |c: char| {
        if c.is_ascii_alphanumeric() || c == '.' {
            c
        } else {
            '-'
        }
    };
    policy.chars().map(part).collect()
}

/// How bad an encounter is, the worst least: a near mid-air collision, induced first, then a loss of
/// well clear, by the remaining separations; of obstacles that are no aircraft an entered volume, by its margin; `None` without a
/// manoeuvre and without a loss.
fn badness(row: &Row) -> Option<f64> {
    let metrics = &row.metrics;
    if metrics.nmac.is_none() && !row.separated {
        // Far less than 1,000 m: caused ones first.
        return Some(if row.caused { -1e4 } else { -1e3 } + row.min_margin_m);
    }
    let (horizontal_m, vertical_m) = (metrics.horizontal_m?, metrics.vertical_m?);
    // At most 2, of separations that count.
    let left = (horizontal_m / 609.6).min(1.0) + (vertical_m / 76.2).min(1.0);
    let class = match (metrics.nmac?, metrics.nominal_nmac?, metrics.lowc?) {
        (true, false, _) => 0.0,
        (true, true, _) => 10.0,
        (false, _, true) => 20.0,
        _ if row.start_s.is_some() => 30.0,
        _ => return None,
    };
    Some(class + left)
}

fn in_words(row: &Row) -> String {
    let metrics = &row.metrics;
    let is = |flag: Option<bool>| flag == Some(true);
    let induced = |nominal: Option<bool>| if is(nominal) { "" } else { ", induced" };
    if metrics.nmac.is_none() && !row.separated {
        let margin_m = row.min_margin_m;
        let caused = if row.caused { ", caused" } else { "" };
        return format!("volume entered by {:.1} m{caused}", -margin_m);
    }
    if is(metrics.nmac) {
        format!("NMAC{}", induced(metrics.nominal_nmac))
    } else if is(metrics.lowc) {
        format!("LoWC{}", induced(metrics.nominal_lowc))
    } else {
        "stays well clear".into()
    }
}

fn estimate(ratio: &RiskRatio) -> Estimate {
    let interval = ratio.interval();
    Estimate {
        value: ratio.ratio,
        low: interval.low,
        high: interval.high,
    }
}

fn lost(count: &LossCount, risk: &PolicyRisk, with_curve: bool) -> Lost {
    let (nominal_rate, rate) = count.rates(risk.weight);
    Lost {
        nominal: count.nominal,
        flown: count.flown,
        induced: count.induced,
        nominal_rate,
        rate,
        ratio: count.ratio().as_ref().map(estimate),
        tail: None,
        convergence: if with_curve {
            let curve = count.convergence(risk.encounters);
            curve
                .iter()
                .map(|(encounters, ratio)| (*encounters, estimate(ratio)))
                .collect()
        } else {
            Vec::new()
        },
    }
}

/// What the encounters represent.
fn stands_for(campaign: &Campaign) -> Vec<String> {
    let configuration = &campaign.configuration;
    let mut lines = Vec::new();
    let is_drawn =
        |source: &RecordingSource| source.path.file_name().is_some_and(|name| name == TRACKS);
    if configuration.recordings.iter().any(is_drawn) {
        lines.push("Drawn encounters, read from a table: they stand for what drew them.".into());
    }
    if !configuration.recordings.iter().all(is_drawn) {
        lines.push(
            "Recorded encounters: what pilots flew. Encounters that were flown on purpose, such as intercepts, are a stress set: they say \
             how a system does in them, not how often they happen in an airspace."
                .into(),
        );
    }
    if !configuration.models.is_empty() {
        lines.push(
            "Encounters drawn from encounter models: intruders turn, climb and accelerate as the radar data from which the models were made. \
             Weighted counts stand for the encounters of the model with miss distances in its cylinder; alone they are no rate per flight hour."
                .into(),
        );
    }
    lines
}

/// How the intruders react.
fn reactions(campaign: &Campaign) -> String {
    match &campaign.configuration.intruders {
        None => "Intruders do not react.".into(),
        Some(intruders) => format!("Intruders react by the policy {intruders}."),
    }
}

/// The assumptions.
fn assumed(campaign: &Campaign) -> Assumed {
    let configuration = &campaign.configuration;
    let model = &campaign.model;
    let mut assumed = Assumed::default();
    let encounters = &mut assumed.encounters;
    let mut add = |name: &str, value: String| encounters.push((name.into(), value));
    if !configuration.recordings.is_empty() {
        let folders: Vec<&str> = campaign
            .source_names()
            .iter()
            .filter(|name| configuration.recordings.iter().any(|r| r.source == **name))
            .map(String::as_str)
            .collect();
        add(
            "recordings",
            format!(
                "{} files of {}",
                configuration.recordings.len(),
                folders.join(", ")
            ),
        );
        add(
            "left out as damaged",
            configuration.damaged.len().to_string(),
        );
    }
    for file in &configuration.models {
        let name = file.path.file_name().unwrap_or_default().to_string_lossy();
        add(
            "encounter model",
            format!(
                "{name}, SHA-256 {}…; {}",
                file.sha256.chars().take(12).collect::<String>(),
                serde_json::to_string(&file.pairing).unwrap_or_default()
            ),
        );
    }
    let heard = "the ownship hears their rows and carries them on for two seconds";
    add(
        "intruders",
        match &configuration.intruders {
            None => format!("do not react; {heard}"),
            Some(intruders) => format!(
                "fly their tracks until they react by the policy {intruders}, as light aircraft at their airspeed with the ownship’s sensor; {heard}"
            ),
        },
    );
    add("seeds", format!("{:?}", configuration.seeds));
    add("judged", "while both aircraft are recorded, along straight lines between rows, by code apart from the one that decides".into());
    let conditions = &mut assumed.conditions;
    let mut add = |name: &str, value: String| conditions.push((name.into(), value));
    add(
        "ownship",
        "flies as recorded or drawn until it acts, then at the airspeed of that moment with the vehicle’s limits".into(),
    );
    add("vehicle", vehicle_words(&model.vehicle));
    add(
        "protected volume that it avoids",
        match model.protection {
            ProtectedVolume::Sphere { radius_m } => format!("sphere of {radius_m} m"),
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            } => format!("cylinder of {radius_m} m and ±{half_height_m} m"),
        },
    );
    let wind = model.wind_mps;
    add(
        "wind",
        format!("{} m/s east, {} north, {} up", wind.x, wind.y, wind.z),
    );
    let sensors = &mut assumed.sensors;
    let mut add = |name: &str, value: String| sensors.push((name.into(), value));
    if configuration.sensors.is_empty() {
        add("sensor", sensor_words(&model.sensor));
    }
    for (number, source) in (1..).zip(&configuration.sensors) {
        let name = source.name.as_ref().map_or_else(
            || format!("sensor {number}"),
            |name| format!("sensor {name}"),
        );
        add(&name, sensor_words(&source.into()));
    }
    assumed
}

/// A vehicle's limits in words.
fn vehicle_words(vehicle: &Vehicle) -> String {
    let response = &vehicle.response;
    format!(
        "airspeed {} m/s (recorded flights: as recorded), turn radius {:.0} m at that speed, climb angle {:.1}° to {:.1}° at {} rad/s, \
         dead time {} s, bank lag {} s, turn-rate factor {}",
        vehicle.airspeed_mps,
        vehicle.turn_radius_m,
        vehicle.climb_min_rad.to_degrees(),
        vehicle.climb_max_rad.to_degrees(),
        vehicle.climb_rate_radps,
        response.dead_time_s,
        response.bank_time_constant_s,
        response.turn_rate_factor,
    )
}

/// A sensor in words.
fn sensor_words(sensor: &SensorSettings) -> String {
    let range = if sensor.range_m.is_finite() {
        format!("range {} m", sensor.range_m)
    } else {
        "unlimited range".into()
    };
    let rate = if sensor.update_period_s > 0.0 {
        format!("a look each {} s", sensor.update_period_s)
    } else {
        "a look at each decision".into()
    };
    let mut words = format!(
        "{range}, {rate}, field of regard {:.0}°, detection probability {}, delay {} s, noise {} m and {} m/s",
        sensor.field_of_regard_rad.to_degrees(),
        sensor.detection_probability,
        sensor.delay_s,
        sensor.position_sigma_m,
        sensor.velocity_sigma_mps,
    );
    let mut also = |given: bool, more: String| {
        if given {
            words.push_str(", ");
            words.push_str(&more);
        }
    };
    if let Some(sigma_m) = sensor.altitude_sigma_m {
        also(true, format!("altitude noise {sigma_m} m"));
    }
    also(
        sensor.position_bias_m > 0.0 || sensor.altitude_bias_m > 0.0,
        format!(
            "lasting errors {} m and {} m in altitude",
            sensor.position_bias_m, sensor.altitude_bias_m
        ),
    );
    also(
        sensor.equipped_share < 1.0,
        format!("sees {} of the intruders", sensor.equipped_share),
    );
    also(
        sensor.dropouts_per_min > 0.0,
        format!(
            "{} interruptions a minute of {} s",
            sensor.dropouts_per_min, sensor.dropout_s
        ),
    );
    also(
        sensor.coast_s > 0.0,
        format!("extrapolates for {} s", sensor.coast_s),
    );
    words
}

#[cfg(test)]
mod tests {
    /// Ten aircraft in 1,000 km³, a cross section of 4 km by 0.8 km, 50 m/s: 180 km flown relative to them sweep 576 km³, which hold 5.76.
    #[test]
    fn encounters_of_an_hour_fill_the_swept_volume() {
        let per_h = super::encounters_per_h(0.01, [2000.0, 400.0], 50.0);
        assert!((per_h - 5.76).abs() < 1e-12, "{per_h}");
    }
}

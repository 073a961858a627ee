//! Alerts and bands of a flight, as the replay page shows them.

use fga::Vec3;
use fga_alerts::{
    Aircraft, AircraftId, AircraftState, AlertSettings, Band, Monitor, Quantity, Recovery, Region,
};
use fga_report::replay::{
    ReplayAlert, ReplayBand, ReplayBands, ReplayEvent, ReplayGuidance, ReplayRegion, ReplayRun,
};
use fga_sim::engine::Sample;
use fga_sim::run::RunLog;

/// Time from one look to the next, seconds.
const EVERY_S: f64 = 1.0;

/// Adds alerts and bands, once a second, and an event for each change of the highest level.
///
/// The states are the true ones: what a perfect sensor would show. An aircraft counts from when it
/// was first seen; what never moves is no aircraft.
pub(crate) fn add(run: &mut ReplayRun, log: &RunLog, settings: &AlertSettings) {
    let mut monitor = Monitor::new(settings.clone());
    run.alert_levels = settings.most_levels();
    let mut level = 0;
    let mut next_s = f64::NEG_INFINITY;
    for pair in log.samples.windows(2) {
        let [sample, after] = pair else { continue };
        if sample.time_s < next_s {
            continue;
        }
        next_s = sample.time_s + EVERY_S;
        let Some(ownship) = ownship(log, sample, after) else {
            continue;
        };
        let traffic = traffic(log, sample.time_s);
        // A state that is not finite has no guidance.
        if monitor.step(sample.time_s, &ownship, &traffic).is_err() {
            continue;
        }
        let now = guidance(&monitor, sample.time_s, &ownship, &traffic);
        if now.level != level {
            level = now.level;
            run.events.push(ReplayEvent {
                t_s: sample.time_s,
                text: format!("alert level {level} of {}", run.alert_levels),
            });
        }
        run.guidance.push(now);
    }
    run.events.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
}

/// An aircraft of a place in the local frame; bands count altitudes from sea level.
fn aircraft(log: &RunLog, id: u64, place_m: Vec3, velocity_mps: Vec3) -> Aircraft {
    let frame = log.plan.frame.as_ref();
    let above_sea_m = frame.map_or(0.0, |frame| frame.origin().altitude_m);
    let state = AircraftState {
        position_m: place_m + Vec3::new(0.0, 0.0, above_sea_m),
        velocity_mps,
    };
    Aircraft::new(AircraftId(id), state)
}

/// The ownship between two samples; `None` where no time passes.
fn ownship(log: &RunLog, sample: &Sample, after: &Sample) -> Option<Aircraft> {
    let lasts_s = after.time_s - sample.time_s;
    let velocity_mps = (after.position_m - sample.position_m) / lasts_s;
    // Obstacles are numbered below 2^32.
    (lasts_s > 0.0).then(|| {
        aircraft(
            log,
            u64::MAX,
            sample.position_m,
            velocity_mps - log.plan.world.wind_mps,
        )
    })
}

/// The aircraft that are there and have been seen.
fn traffic(log: &RunLog, time_s: f64) -> Vec<Aircraft> {
    let obstacles = log.plan.world.obstacles.iter().zip(&log.obstacles);
    obstacles
        .filter(|(_, outcome)| outcome.first_seen_s.is_some_and(|seen_s| seen_s <= time_s))
        .filter(|(obstacle, _)| obstacle.track.speed_bound_mps() != Some(0.0))
        .filter_map(|(obstacle, _)| {
            let (position_m, velocity_mps) = obstacle.track.at(time_s)?;
            let id = u64::from(obstacle.id);
            Some(aircraft(
                log,
                id,
                position_m,
                velocity_mps - log.plan.world.wind_mps,
            ))
        })
        .collect()
}

fn guidance(
    monitor: &Monitor,
    time_s: f64,
    ownship: &Aircraft,
    traffic: &[Aircraft],
) -> ReplayGuidance {
    let settings = monitor.settings();
    let alerts = traffic.iter().zip(monitor.alerts()).enumerate();
    let aircraft = alerts.filter_map(|(index, (aircraft, alert))| {
        let corrective = settings.corrective_level(alert.alerter?)?;
        let loss = monitor.violation(index, corrective);
        Some(ReplayAlert {
            obstacle: u32::try_from(aircraft.id.0).ok()?,
            level: alert.level.unwrap_or(0),
            violation_s: loss
                .filter(|loss| loss.is_conflict())
                .map(|loss| loss.entry_s),
        })
    });
    ReplayGuidance {
        t_s: time_s,
        level: monitor.highest_level(),
        aircraft: aircraft.collect(),
        quantities: Quantity::ALL.map(|quantity| bands(monitor, quantity, ownship)),
    }
}

fn bands(monitor: &Monitor, quantity: Quantity, ownship: &Aircraft) -> ReplayBands {
    let found = monitor.bands(quantity);
    ReplayBands {
        value: quantity.of(&ownship.state),
        bands: found.bands().iter().map(band).collect(),
        recovery_s: match found.recovery() {
            Recovery::NotNeeded => None,
            Recovery::Impossible { .. } => Some(-1.0),
            Recovery::Found { time_s, .. } => Some(time_s),
        },
    }
}

fn band(band: &Band) -> ReplayBand {
    ReplayBand {
        low: band.low,
        high: band.high,
        region: match band.region {
            None => ReplayRegion::Outside,
            Some(Region::None) => ReplayRegion::Free,
            Some(Region::Far) => ReplayRegion::Far,
            Some(Region::Mid) => ReplayRegion::Mid,
            Some(Region::Near) => ReplayRegion::Near,
            Some(Region::Recovery) => ReplayRegion::Recovery,
        },
    }
}

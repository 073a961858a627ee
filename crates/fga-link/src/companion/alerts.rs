//! Alert levels as the standards give them: reported, and acted on where that is configured.

use fga::avoider::Start;
use fga::situation::Obstacle;
use fga_alerts::{Aircraft, AircraftId, Monitor, Pair, schemes};
use mavlink::dialects::ardupilotmega::{
    COLLISION_DATA, MavCollisionAction, MavCollisionSrc, MavCollisionThreatLevel, MavMessage,
};
use serde_json::json;

use super::Companion;
use crate::authority::Severity;
use crate::config::{AlertScheme, AlertsConfig};
use crate::number::single;
use crate::ownship::State;

/// Time between the messages about alerting aircraft, seconds.
const REPORT_EVERY_S: f64 = 0.5;
/// The most aircraft that messages are sent about.
const MOST_REPORTED: usize = 8;

/// The alert levels of one companion.
#[derive(Debug)]
pub(super) struct Watch {
    monitor: Monitor,
    /// The most levels that there are.
    most: usize,
    /// The lowest level at which it acts; 0: it acts at no level.
    act_at: usize,
    told: usize,
    report_s: f64,
}

/// The aircraft that alerts most.
struct Urgent {
    id: u32,
    level: usize,
    /// Until the corrective volume is violated, seconds.
    entry_s: Option<f64>,
}

impl Watch {
    /// The levels of a configuration; `None` where they are off.
    pub(super) fn new(config: &AlertsConfig) -> Option<Self> {
        let settings = match config.levels {
            AlertScheme::Off => return None,
            AlertScheme::F3442 => schemes::f3442(),
            AlertScheme::Do365b => schemes::do_365b(),
        };
        Some(Self {
            most: usize::from(config.levels.most()),
            act_at: usize::from(config.act_at_level),
            monitor: Monitor::new(settings),
            told: 0,
            report_s: f64::NEG_INFINITY,
        })
    }

    /// Takes the aircraft of a moment and says which one alerts most.
    fn step(&mut self, time_s: f64, own: &State, obstacles: &[&Obstacle]) -> Option<Urgent> {
        let ownship = aircraft(
            u64::MAX,
            own.ownship.position_m,
            own.ground_velocity_mps,
            own,
        );
        let traffic: Vec<Aircraft> = obstacles
            .iter()
            .map(|o| aircraft(u64::from(o.id), o.position_m, o.velocity_mps, own))
            .collect();
        // A state that is not finite has no level.
        self.monitor.step_levels(time_s, &ownship, &traffic).ok()?;
        let alerts = self.monitor.alerts().iter().enumerate();
        alerts
            .filter_map(|(index, alert)| {
                let corrective = self.monitor.settings().corrective_level(alert.alerter?)?;
                let loss = self.monitor.violation(index, corrective)?;
                Some(Urgent {
                    id: u32::try_from(alert.id.0).ok()?,
                    level: alert.level.filter(|level| *level > 0)?,
                    entry_s: loss.is_conflict().then_some(loss.entry_s),
                })
            })
            .max_by(|a, b| {
                let sooner = |urgent: &Urgent| -urgent.entry_s.unwrap_or(f64::INFINITY);
                let by_time = sooner(a).total_cmp(&sooner(b));
                a.level.cmp(&b.level).then(by_time)
            })
    }

    /// The level from which on the standard asks for a manoeuvre.
    fn corrective(&self) -> usize {
        self.monitor
            .settings()
            .corrective_level(0)
            .unwrap_or(self.most)
    }

    fn severity(&self, level: usize) -> Severity {
        if level == 0 {
            Severity::Info
        } else if level < self.corrective() {
            Severity::Notice
        } else if level < self.most {
            Severity::Warning
        } else {
            Severity::Critical
        }
    }
}

/// An aircraft of which the velocity over the ground is given.
fn aircraft(id: u64, position_m: fga::Vec3, over_ground_mps: fga::Vec3, own: &State) -> Aircraft {
    let state = fga_alerts::State {
        position_m,
        velocity_mps: over_ground_mps - own.wind_mps,
    };
    Aircraft::new(AircraftId(id), state)
}

impl Companion {
    /// Reports the alert level, and lets it say when a manoeuvre begins.
    pub(super) fn watch_alerts(&mut self, own: &State, now_s: f64) {
        let Some(mut watch) = self.alerts.take() else {
            return;
        };
        let aircraft: Vec<&Obstacle> = self
            .obstacles
            .iter()
            .filter(|o| self.tracks.get(o.id).is_some() || o.velocity_mps != fga::Vec3::ZERO)
            .collect();
        let urgent = watch.step(now_s, own, &aircraft);
        let level = urgent.as_ref().map_or(0, |urgent| urgent.level);
        if now_s >= watch.report_s {
            watch.report_s = now_s + REPORT_EVERY_S;
            self.report_alerts(&watch, own);
        }
        if level != watch.told {
            watch.told = level;
            self.tell_alert(&watch, urgent.as_ref());
        }
        if watch.act_at > 0
            && let Some(decider) = &mut self.decider
        {
            decider.set_start(if level >= watch.act_at {
                Start::AtDetection
            } else {
                Start::Latest
            });
        }
        self.alerts = Some(watch);
    }

    fn tell_alert(&mut self, watch: &Watch, urgent: Option<&Urgent>) {
        let words = match urgent {
            None => "fga: no alert".to_owned(),
            Some(urgent) => {
                let when = urgent
                    .entry_s
                    .map_or_else(String::new, |entry_s| format!(", {entry_s:.0} s"));
                let name = self.obstacle_name(urgent.id);
                format!(
                    "fga: alert {} of {}, {name}{when}",
                    urgent.level, watch.most
                )
            }
        };
        self.voice.tell(watch.severity(watch.told), &words);
        self.voice.note(
            "alert",
            json!({
                "level": watch.told,
                "levels": watch.most,
                "id": urgent.map(|urgent| urgent.id),
                "entry_s": urgent.and_then(|urgent| urgent.entry_s),
            }),
        );
    }

    /// Sends `COLLISION` about each alerting aircraft, but not about the threat of the last
    /// decision, about which it is sent anyway.
    fn report_alerts(&mut self, watch: &Watch, own: &State) {
        let threat = self
            .decided
            .and_then(|decided| decided.decision.record.threat);
        let level_of = |id: u32| {
            let id = AircraftId(u64::from(id));
            let alert = watch.monitor.alerts().iter().find(|alert| alert.id == id);
            alert.and_then(|alert| alert.level).unwrap_or(0)
        };
        let own_state = aircraft(
            u64::MAX,
            own.ownship.position_m,
            own.ground_velocity_mps,
            own,
        )
        .state;
        let messages: Vec<MavMessage> = self
            .obstacles
            .iter()
            .filter(|o| threat.is_none_or(|threat| threat.id != o.id))
            .filter_map(|o| {
                let level = level_of(o.id);
                let other = aircraft(0, o.position_m, o.velocity_mps, own).state;
                let pair = Pair::exact(own_state, other);
                let icao = self.tracks.get(o.id).map_or(0, |track| track.icao);
                (level > 0).then(|| {
                    let id = if icao == 0 { o.id } else { icao };
                    collision(id, &pair, level >= watch.corrective())
                })
            })
            .take(MOST_REPORTED)
            .collect();
        for message in messages {
            self.voice.send(message);
        }
    }
}

/// `COLLISION` about an aircraft on its straight way.
fn collision(id: u32, pair: &Pair, asks_for_maneuver: bool) -> MavMessage {
    let closest_s = pair.time_to_closest_s().unwrap_or(0.0);
    let relative_m = pair.ownship.position_m - pair.intruder.position_m;
    let relative_mps = pair.ownship.velocity_mps - pair.intruder.velocity_mps;
    let then_m = relative_m + relative_mps * closest_s;
    MavMessage::COLLISION(COLLISION_DATA {
        id,
        time_to_minimum_delta: single(closest_s),
        altitude_minimum_delta: single(then_m.z.abs()),
        horizontal_minimum_delta: single(libm::hypot(then_m.x, then_m.y)),
        src: MavCollisionSrc::MAV_COLLISION_SRC_ADSB,
        action: MavCollisionAction::MAV_COLLISION_ACTION_REPORT,
        threat_level: if asks_for_maneuver {
            MavCollisionThreatLevel::MAV_COLLISION_THREAT_LEVEL_HIGH
        } else {
            MavCollisionThreatLevel::MAV_COLLISION_THREAT_LEVEL_LOW
        },
    })
}

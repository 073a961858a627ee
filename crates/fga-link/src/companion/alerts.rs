//! Alert levels as the standards give them: reported, and acted on where that is configured.

use fga::avoider::{Start, Threat};
use fga::situation::Obstacle;
use fga_alerts::{Aircraft, AircraftId, Monitor, Pair, schemes};
use mavlink::dialects::ardupilotmega::{MavCollisionAction, MavMessage};
use serde_json::json;

use super::around::ObstaclesAround;
use super::voice::Voice;
use crate::authority::Severity;
use crate::config::{AlertScheme, AlertsConfig};
use crate::ownship::OwnState;
use crate::telling;

/// Time between the messages about alerting aircraft, seconds.
const REPORT_EVERY_S: f64 = 0.5;
/// The most aircraft that messages are sent about.
const MOST_REPORTED: usize = 8;

/// The alert levels of one companion.
#[derive(Debug)]
pub(super) struct AlertWatch {
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

impl AlertWatch {
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
    fn step(&mut self, time_s: f64, own: &OwnState, obstacles: &[&Obstacle]) -> Option<Urgent> {
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
        self.monitor
            .step_for(&[], time_s, &ownship, &traffic)
            .ok()?;
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
fn aircraft(
    id: u64,
    position_m: fga::Vec3,
    over_ground_mps: fga::Vec3,
    own: &OwnState,
) -> Aircraft {
    let state = fga_alerts::AircraftState {
        position_m,
        velocity_mps: over_ground_mps - own.wind_mps,
    };
    Aircraft::new(AircraftId(id), state)
}

impl AlertWatch {
    /// Reports the alert level, and sends `COLLISION` about each alerting aircraft but the threat of the last decision, about
    /// which it is sent anyway. When a manoeuvre begins, where the levels say that.
    pub(super) fn watch(
        &mut self,
        own: &OwnState,
        threat: Option<Threat>,
        around: &ObstaclesAround,
        voice: &mut Voice,
    ) -> Option<Start> {
        let now_s = voice.now_s();
        let is_aircraft = |o: &&Obstacle| {
            around.tracks().get(o.id).is_some() || o.velocity_mps != fga::Vec3::ZERO
        };
        let aircraft: Vec<&Obstacle> = around.obstacles().iter().filter(is_aircraft).collect();
        let urgent = self.step(now_s, own, &aircraft);
        let level = urgent.as_ref().map_or(0, |urgent| urgent.level);
        if now_s >= self.report_s {
            self.report_s = now_s + REPORT_EVERY_S;
            self.report(own, threat, around, voice);
        }
        if level != self.told {
            self.told = level;
            self.tell(urgent.as_ref(), around, voice);
        }
        (self.act_at > 0).then_some(if level >= self.act_at {
            Start::AtDetection
        } else {
            Start::Latest
        })
    }

    fn tell(&self, urgent: Option<&Urgent>, around: &ObstaclesAround, voice: &mut Voice) {
        let words = urgent.map_or("fga: no alert".to_owned(), |urgent| {
            let when = urgent
                .entry_s
                .map_or_else(String::new, |entry_s| format!(", {entry_s:.0} s"));
            let (level, most, name) = (urgent.level, self.most, around.name(urgent.id));
            format!("fga: alert {level} of {most}, {name}{when}")
        });
        voice.tell(self.severity(self.told), &words);
        voice.note(
            "alert",
            json!({
                "level": self.told,
                "levels": self.most,
                "id": urgent.map(|urgent| urgent.id),
                "entry_s": urgent.and_then(|urgent| urgent.entry_s),
            }),
        );
    }

    fn report(
        &self,
        own: &OwnState,
        threat: Option<Threat>,
        around: &ObstaclesAround,
        voice: &mut Voice,
    ) {
        let level_of = |id: u32| {
            let id = AircraftId(u64::from(id));
            let alert = self.monitor.alerts().iter().find(|alert| alert.id == id);
            alert.and_then(|alert| alert.level).unwrap_or(0)
        };
        let (own_m, own_mps) = (own.ownship.position_m, own.ground_velocity_mps);
        let own_state = aircraft(u64::MAX, own_m, own_mps, own).state;
        let others = around.obstacles().iter();
        let alerting = others
            .filter(|o| threat.is_none_or(|threat| threat.id != o.id))
            .map(|o| (o, level_of(o.id)))
            .filter(|(_, level)| *level > 0);
        for (o, level) in alerting.take(MOST_REPORTED) {
            let other = aircraft(0, o.position_m, o.velocity_mps, own).state;
            let pair = Pair::exact(own_state, other);
            let id = around.number(o.id);
            voice.send(collision(id, &pair, level >= self.corrective()));
        }
    }
}

/// `COLLISION` about an aircraft on its straight way.
fn collision(id: u32, pair: &Pair, asks_for_maneuver: bool) -> MavMessage {
    let closest_s = pair.time_to_closest_s().unwrap_or(0.0);
    let relative_m = pair.ownship.position_m - pair.intruder.position_m;
    let relative_mps = pair.ownship.velocity_mps - pair.intruder.velocity_mps;
    let then_m = relative_m + relative_mps * closest_s;
    let action = MavCollisionAction::MAV_COLLISION_ACTION_REPORT;
    telling::collision(id, (closest_s, then_m), action, asks_for_maneuver)
}

//! `fga fly --live`: the flight in the browser.
//!
//! The flight hands pictures over and never waits: a separate thread draws them, and drops those that
//! it cannot draw in time.

use alloc::sync::Arc;
use core::net::SocketAddr;
use core::time::Duration;
use std::collections::HashMap;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use fga::Vec3;
use fga::angle::{climb_of, course_of};
use fga::avoider::{Reason, State};
use fga::certificate::Hazard;
use fga::situation::Obstacle;
use fga_formats::terrain::LocalGround;
use fga_formats::words::reason_words;
use fga_link::Companion;
use fga_link::authority::Authority;
use fga_link::companion::FlightPicture;
use fga_report::replay::{
    LiveMessage, ReplayEvent, ReplayObstacle, ReplayPiece, ReplayRun, ReplaySample, ReplayState,
};
use fga_view::{Live, Server};

use fga_results::replay_page::{Drawer, due, replay_ground};

/// Most pictures in the queue.
const WAITING: usize = 32;
/// Time for browsers to take the last messages.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// The page gets an update when an obstacle is this far from where the page expects it, metres and metres per
/// second, at most once in this time, seconds.
const OFF_M: f64 = 3.0;
const OFF_MPS: f64 = 1.0;
const TOLD_EVERY_S: f64 = 1.0;
/// An unseen obstacle is gone after this time, seconds.
const GONE_AFTER_S: f64 = 5.0;
/// An obstacle unseen for this long is forgotten here, seconds; the page keeps it.
const FORGOTTEN_AFTER_S: f64 = 600.0;
/// Most straight pieces of an obstacle's track; the oldest ones are dropped.
const MOST_PIECES: usize = 500;

/// Shows a flight in progress.
pub(crate) struct FlyLive {
    server: Server,
    live: Live,
    pictures: SyncSender<FlightPicture>,
    painter: JoinHandle<()>,
    shown_s: Option<f64>,
}

impl FlyLive {
    /// Begins to serve the page.
    pub(crate) fn begin(address: SocketAddr) -> io::Result<Self> {
        let (server, live) = Server::live(address, "fga fly")?;
        live.send(&LiveMessage::Run(Box::new(ReplayRun::named("fga fly"))));
        let (pictures, to_draw) = sync_channel(WAITING);
        let mut painter = Painter::new(live.clone());
        let painter = thread::Builder::new()
            .name("fga-live".into())
            .spawn(move || painter.draw_all(&to_draw))?;
        Ok(Self {
            server,
            live,
            pictures,
            painter,
            shown_s: None,
        })
    }

    /// The address of the page.
    pub(crate) fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Shows the last decision, unless the page has it or the painter is behind. None is left out for
    /// coming early: a manoeuvre begins in one decision only.
    pub(crate) fn show(&mut self, companion: &Companion) {
        if companion.decided_for_s() != self.shown_s
            && let Some(picture) = companion.picture()
        {
            self.shown_s = Some(picture.time_s);
            let _ = self.pictures.try_send(picture);
        }
    }

    /// Sends the end, and gives the browsers time to take it.
    pub(crate) fn end(self) {
        drop(self.pictures);
        // A panic there has printed its own message.
        let _ = self.painter.join();
        self.live.send(&LiveMessage::End {
            run: 0,
            outcome: None,
        });
        self.live.drain(LAST_WORDS);
    }
}

/// An obstacle as the browsers know it.
struct TerminalTold {
    obstacle: ReplayObstacle,
    since_s: f64,
    seen_s: f64,
    sent_s: f64,
    gone: bool,
}

impl TerminalTold {
    /// Records a sight; returns whether the browsers need an update.
    fn see(&mut self, obstacle: &Obstacle, name: &str, time_s: f64) -> bool {
        self.seen_s = time_s;
        let piece = piece(obstacle, time_s);
        let off = self.obstacle.motion.last().is_none_or(|last| {
            let velocity_mps = Vec3::from_array(last.velocity_mps);
            let told_m = Vec3::from_array(last.position_m) + velocity_mps * (time_s - last.start_s);
            obstacle.position_m.distance(told_m) > OFF_M
                || obstacle.velocity_mps.distance(velocity_mps) > OFF_MPS
        });
        let known = !off && self.obstacle.name == name && self.obstacle.volume == obstacle.volume;
        if !self.gone && (known || time_s - self.sent_s < TOLD_EVERY_S) {
            return false;
        }
        self.gone = false;
        self.sent_s = time_s;
        name.clone_into(&mut self.obstacle.name);
        self.obstacle.volume = obstacle.volume;
        self.obstacle.present_s = Some([self.since_s, f64::INFINITY]);
        if off {
            self.obstacle.motion.push(piece);
            let most = self.obstacle.motion.len().saturating_sub(MOST_PIECES);
            self.obstacle.motion.drain(..most);
        }
        true
    }

    /// Whether it has gone since the last look.
    fn miss(&mut self, time_s: f64) -> bool {
        let gone = !self.gone && time_s - self.seen_s > GONE_AFTER_S;
        if gone {
            self.gone = true;
            self.obstacle.present_s = Some([self.since_s, self.seen_s]);
        }
        gone
    }
}

fn piece(obstacle: &Obstacle, time_s: f64) -> ReplayPiece {
    ReplayPiece {
        start_s: time_s,
        position_m: obstacle.position_m.to_array(),
        velocity_mps: obstacle.velocity_mps.to_array(),
    }
}

/// Turns pictures into messages.
struct Painter {
    live: Live,
    mission_m: Vec<[f64; 3]>,
    ground: Option<Arc<LocalGround>>,
    obstacles: HashMap<u32, TerminalTold>,
    /// State, reason and threat of the last shown decision.
    last: Option<(State, Reason, Option<u32>)>,
    authority: &'static str,
    record_s: Option<f64>,
}

impl Painter {
    fn new(live: Live) -> Self {
        Self {
            live,
            mission_m: Vec::new(),
            ground: None,
            obstacles: HashMap::new(),
            last: None,
            authority: "",
            record_s: None,
        }
    }

    fn draw_all(&mut self, pictures: &Receiver<FlightPicture>) {
        while let Ok(picture) = pictures.recv() {
            self.draw(&picture);
        }
    }

    fn draw(&mut self, picture: &FlightPicture) {
        let t_s = picture.time_s;
        let mission_m: Vec<[f64; 3]> = picture.waypoints_m.iter().map(Vec3::to_array).collect();
        if mission_m != self.mission_m {
            self.mission_m.clone_from(&mission_m);
            self.live.send(&LiveMessage::Mission { run: 0, mission_m });
        }
        self.draw_ground(picture.ground.as_ref());
        self.draw_obstacles(picture);
        let sample = sample(picture);
        self.live.send(&LiveMessage::Sample { run: 0, sample });
        let record = &picture.decision.record;
        let threat = record.threat.map(|threat| threat.id);
        let now = (picture.decision.state, record.reason, threat);
        let changed = self.last != Some(now);
        self.last = Some(now);
        if due(self.record_s, t_s, changed) {
            self.record_s = Some(t_s);
            self.draw_decision(picture);
        }
        if changed {
            let reason = reason_words(record.reason);
            self.tell(
                t_s,
                match &picture.threat_name {
                    Some(name) => format!("{reason} ({name})"),
                    None => reason.to_owned(),
                },
            );
        }
        let authority = authority_words(&picture.authority);
        if authority != self.authority {
            self.authority = authority;
            self.tell(t_s, authority.to_owned());
        }
    }

    /// Sends ground that the page does not have. Where none is known any more, the page keeps the last one.
    fn draw_ground(&mut self, ground: Option<&Arc<LocalGround>>) {
        let Some(ground) = ground else { return };
        if self
            .ground
            .as_ref()
            .is_none_or(|shown| !Arc::ptr_eq(shown, ground))
        {
            self.ground = Some(Arc::clone(ground));
            let ground = replay_ground(ground);
            self.live.send(&LiveMessage::Ground { run: 0, ground });
        }
    }

    fn tell(&self, t_s: f64, text: String) {
        let event = ReplayEvent { t_s, text };
        self.live.send(&LiveMessage::Event { run: 0, event });
    }

    fn draw_obstacles(&mut self, picture: &FlightPicture) {
        let t_s = picture.time_s;
        let mut news = Vec::new();
        for (obstacle, name) in &picture.obstacles {
            let told = self
                .obstacles
                .entry(obstacle.id)
                .or_insert_with(|| TerminalTold {
                    obstacle: ReplayObstacle {
                        id: obstacle.id,
                        name: name.clone(),
                        volume: obstacle.volume,
                        motion: Vec::new(),
                        present_s: None,
                        known_from_s: None,
                    },
                    since_s: t_s,
                    seen_s: t_s,
                    sent_s: f64::NEG_INFINITY,
                    gone: false,
                });
            if told.see(obstacle, name, t_s) {
                news.push(told.obstacle.clone());
            }
        }
        let missed = self
            .obstacles
            .values_mut()
            .filter_map(|told| told.miss(t_s).then(|| told.obstacle.clone()));
        news.extend(missed);
        // One that comes again later begins a new track on the page.
        self.obstacles
            .retain(|_, told| t_s - told.seen_s < FORGOTTEN_AFTER_S);
        for obstacle in news {
            self.live.send(&LiveMessage::Obstacle { run: 0, obstacle });
        }
    }

    fn draw_decision(&self, picture: &FlightPicture) {
        let wind_mps = picture.own.wind_mps;
        let mut drawer = Drawer::of(
            &picture.vehicle,
            wind_mps,
            picture.horizon_s,
            picture.margin_m,
        );
        let hazards: Vec<Hazard> = (picture.obstacles.iter())
            .map(|(obstacle, _)| Hazard::new(obstacle, wind_mps, 0.0))
            .collect();
        let name = |_| picture.threat_name.clone().unwrap_or_default();
        let mut decision = drawer.record(
            picture.time_s,
            &picture.decision,
            &picture.own.ownship,
            name,
            Some(&hazards),
        );
        let above = picture.above_ground;
        decision
            .lines
            .extend(above.map(|above| format!("{above}.")));
        self.live.send(&LiveMessage::Decision { run: 0, decision });
    }
}

fn sample(picture: &FlightPicture) -> ReplaySample {
    let own = &picture.own;
    ReplaySample {
        t_s: picture.time_s,
        position_m: own.ownship.position_m.to_array(),
        course_rad: course_of(own.ground_velocity_mps),
        climb_rad: climb_of(own.ground_velocity_mps),
        bank_rad: own.ownship.bank_rad,
        state: match picture.authority {
            Authority::Waiting | Authority::Resuming { .. } | Authority::Released { .. } => {
                ReplayState::Manual
            }
            _ => picture.decision.state.into(),
        },
    }
}

/// Who flies, in a few words.
const fn authority_words(authority: &Authority) -> &'static str {
    match authority {
        Authority::Waiting => "waits until all that must hold to take over holds",
        Authority::Ready => "ready, the autopilot flies",
        Authority::Taking { .. } => "takes over",
        Authority::InCommand { .. } => "in command",
        Authority::Returning { .. } => "gives back",
        Authority::Resuming { .. } => "about to go on with the manoeuvre",
        Authority::Released { .. } => "released",
    }
}

#[cfg(test)]
mod tests {
    use fga::situation::ProtectedVolume;

    use super::*;

    #[test]
    fn an_obstacle_is_sent_again_when_it_leaves_its_expected_path() {
        let at = |x_m: f64, speed_mps: f64| {
            let volume = ProtectedVolume::Sphere { radius_m: 60.0 };
            Obstacle::straight(7, Vec3::X * x_m, Vec3::X * speed_mps, volume)
        };
        let first = at(0.0, 10.0);
        let mut told = TerminalTold {
            obstacle: ReplayObstacle {
                id: 7,
                name: "N7".into(),
                volume: first.volume,
                motion: Vec::new(),
                present_s: None,
                known_from_s: None,
            },
            since_s: 1.0,
            seen_s: 1.0,
            sent_s: f64::NEG_INFINITY,
            gone: false,
        };
        assert!(told.see(&first, "N7", 1.0));
        assert!(!told.see(&at(30.0, 10.0), "N7", 4.0), "as told");
        assert!(told.see(&at(45.0, 10.0), "N7", 5.0), "5 m farther");
        assert!(!told.see(&at(55.0, 15.0), "N7", 5.5), "told a moment ago");
        assert!(told.see(&at(55.0, 15.0), "N7", 6.0), "5 m/s faster");
        assert!(told.see(&at(70.0, 15.0), "KLM12", 7.0), "it has a name");
        assert_eq!(told.obstacle.motion.len(), 3);
        assert!(!told.miss(11.0));
        assert!(told.miss(12.5) && !told.miss(13.0), "gone once");
        assert_eq!(told.obstacle.present_s, Some([1.0, 7.0]));
        assert!(told.see(&at(160.0, 15.0), "KLM12", 13.0), "back again");
        assert_eq!(told.obstacle.present_s, Some([1.0, f64::INFINITY]));
    }
}

//! `fga run --live`: a flight in the browser in real time.

use core::net::{Ipv4Addr, SocketAddr};
use core::time::Duration;
use std::io;
use std::time::Instant;

use fga::Vec3;
use fga_report::replay::{
    LiveMessage, ReplayDecisionTime, ReplayEvent, ReplayOutcome, ReplayRun, ReplaySample,
};
use fga_sim::run::{DecisionLog, Plan, RunLog};
use fga_view::{Live, Server};

use fga_results::replay_page::{
    Drawer, due, event_words, has_news, planned_obstacles, planned_zones, replay_ground,
};

/// Time for browsers to take the last messages.
const LAST_WORDS: Duration = Duration::from_secs(5);

/// Shows a flight in progress, at a multiple of real time.
pub(crate) struct LiveView {
    server: Server,
    live: Live,
    plan: Plan,
    drawer: Drawer,
    begun: Instant,
    speed: f64,
    last_record_s: Option<f64>,
}

impl LiveView {
    /// Begins to serve the page of a plan on a free port of this machine.
    pub(crate) fn begin(plan: &Plan, policy: &str, speed: f64) -> io::Result<Self> {
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let (server, live) = Server::live(address, &plan.name)?;
        let mut run = ReplayRun::named(policy);
        run.mission_m = plan.world.mission_m.iter().map(Vec3::to_array).collect();
        run.obstacles = planned_obstacles(plan);
        run.zones = planned_zones(plan);
        live.send(&LiveMessage::Run(Box::new(run)));
        if let Some(ground) = plan.world.ground.as_deref() {
            let ground = replay_ground(ground);
            live.send(&LiveMessage::Ground { run: 0, ground });
        }
        Ok(Self {
            server,
            live,
            drawer: Drawer::new(plan),
            plan: plan.clone(),
            begun: Instant::now(),
            speed,
            last_record_s: None,
        })
    }

    /// The address of the page.
    pub(crate) fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Shows a decision and waits until its time has come.
    pub(crate) fn show(&mut self, moment: &DecisionLog) {
        let t_s = moment.time_s;
        let state = moment.decision.state.into();
        // Over the ground, plus the motion of the air.
        let own = &moment.ownship;
        let over_ground = own.velocity_mps() + self.plan.world.wind_mps;
        self.live.send(&LiveMessage::Sample {
            run: 0,
            sample: ReplaySample {
                t_s,
                position_m: own.position_m.to_array(),
                course_rad: fga::angle::course_of(over_ground),
                climb_rad: fga::angle::climb_of(over_ground),
                bank_rad: own.bank_rad,
                state,
            },
        });
        self.live.send(&LiveMessage::DecisionTime {
            run: 0,
            time: ReplayDecisionTime {
                t_s,
                decision_us: moment.elapsed_ns as f64 / 1000.0,
            },
        });
        if due(self.last_record_s, t_s, has_news(moment)) {
            self.last_record_s = Some(t_s);
            let decision = self.drawer.decision(&self.plan, moment, false);
            self.live.send(&LiveMessage::Decision { run: 0, decision });
        }
        if moment.changed {
            let text = event_words(&self.plan, moment);
            let event = ReplayEvent { t_s, text };
            self.live.send(&LiveMessage::Event { run: 0, event });
        }
        let due_s = t_s / self.speed - self.begun.elapsed().as_secs_f64();
        // Nobody watches beyond a day; a negative time means that the flight is late.
        if (0.0..86_400.0).contains(&due_s) {
            std::thread::sleep(Duration::from_secs_f64(due_s));
        }
    }

    /// Sends the end, and gives the browsers time to take it.
    pub(crate) fn end(self, log: &RunLog) {
        let least = log
            .obstacles
            .iter()
            .filter(|obstacle| obstacle.margin.value_m.is_finite())
            .min_by(|a, b| a.margin.value_m.total_cmp(&b.margin.value_m));
        let outcome = least.map(|obstacle| ReplayOutcome {
            min_margin_m: obstacle.margin.value_m,
            t_s: obstacle.margin.time_s,
            obstacle: obstacle.id,
        });
        self.live.send(&LiveMessage::End { run: 0, outcome });
        self.live.drain(LAST_WORDS);
    }
}

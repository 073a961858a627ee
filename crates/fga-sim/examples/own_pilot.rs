//! A pilot of your own in the simulator, beside the default one.
//!
//! This one knows a single rule of the air: when an obstacle ahead comes close, turn 30 degrees to the right until it has passed.
//! It flies the shipped scenario, and so does the default policy; the simulator measures both the same way.
//!
//! `cargo run --release -p fga-sim --example own_pilot`

use std::path::Path;

use fga::avoider::{Decision, State};
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_sim::engine::{Engine, Outcome};
use fga_sim::mission_pilot::MissionPilot;
use fga_sim::policy::PolicyChoice;
use fga_sim::run::Plan;

/// It turns away from obstacles nearer than this, seconds of its own flight.
const LOOK_AHEAD_S: f64 = 12.0;

/// Turns to the right of close obstacles ahead; otherwise flies the mission.
struct GiveWay {
    mission: MissionPilot,
}

impl Pilot for GiveWay {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        let mission = self.mission.step(situation);
        let own = &situation.ownship;
        let reach_m = LOOK_AHEAD_S * own.airspeed_mps;
        let is_in_the_way = situation.obstacles.iter().any(|obstacle| {
            let offset = obstacle.position_m - own.position_m;
            let closing = (obstacle.velocity_mps - own.velocity_mps()).dot(offset) < 0.0;
            let ahead = offset.dot(own.velocity_mps()) > 0.0;
            closing && ahead && offset.length() < reach_m
        });
        if !is_in_the_way {
            return mission;
        }
        // A right turn decreases the course.
        let course_rad = own.course_rad - 30_f64.to_radians();
        Decision {
            state: State::Avoiding,
            command: Maneuver::turn(0.0, course_rad, 0.0).into(),
            ..mission
        }
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.mission.retune(vehicle);
    }

    fn restart(&mut self) {
        self.mission.restart();
    }
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/first-flight.toml");
    let world = Plan::read(&scenario, None)?.world;
    let mut own = GiveWay {
        mission: MissionPilot::new(world.settings.avoider.horizon_s, world.vehicle)?,
    };
    let mut default = PolicyChoice::default().pilot(&world.settings, &world.vehicle)?;
    let mut engine = Engine::new();
    print("give way", &engine.fly(&world, &mut own, &mut ()));
    print("turn-aware", &engine.fly(&world, default.as_mut(), &mut ()));
    Ok(())
}

fn print(name: &str, outcome: &Outcome) {
    println!(
        "{name:>10}: least margin {:6.1} m, {:6.1} m off the mission at most, {:5.0} m of extra path",
        outcome.min_margin_m, outcome.max_cross_track_m, outcome.extra_path_m
    );
}

//! How many of the encounters that the aircraft's limits allow to be saved are saved when nothing
//! is ideal: noisy sight, a bank that lags, a turn that is slower than assumed, wind.
//!
//! `robustness SEED COUNT [CELL…]`, CELL as in `EncounterSource::parse`; without cells the hundred of
//! {1, 2, 3, 5, 10} threats × {100–500, 300} m × five speeds, in space and in the plane. Each
//! encounter is drawn for the ground speed in its wind, whose direction goes round with the
//! encounter's number. The oracle has the same limits and perfect sight. Options are taken from the
//! environment, so that one cause can be left out at a time: `NOISE=0`, `WIND=0`, `LAG=0`,
//! `FACTOR=1`, `SIGMAS=3`, `MARGIN=0.05`, `START=free`, `VERBOSE=1`, `ONLY=number`.

use std::process::ExitCode;

use fga::Vec3;
use fga::avoider::{Reason, State};
use fga_formats::encounters::Encounter;
use fga_sim::batch::{BatchSettings, crab, empty_world};
use fga_sim::encounters::EncounterSource;
use fga_sim::engine::{DecisionMoment, Engine, Observer, Outcome};
use fga_sim::oracle::{OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin};
use fga_sim::policy::PolicyChoice;
use fga_sim::track::Track;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::{World, WorldObstacle};
use rayon::prelude::*;

/// Wind directions of successive encounters are this far apart, radians: the golden angle.
const NEXT_WIND_RAD: f64 = 2.399_963_229_728_653;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn setting(name: &str, otherwise: f64) -> Result<f64, String> {
    std::env::var(name).map_or(Ok(otherwise), |text| {
        text.parse()
            .map_err(|e| format!("{name}={text}: expected a number: {e}"))
    })
}

/// What is not ideal.
#[derive(Debug, Clone, Copy)]
struct Conditions {
    noise: f64,
    wind_mps: f64,
    lag_s: f64,
    factor: f64,
    sigmas: f64,
    margin_m: f64,
    policy: PolicyChoice,
}

impl Conditions {
    fn from_environment() -> Result<Self, String> {
        let start = std::env::var("START").ok();
        let policy = std::env::var("POLICY").unwrap_or_else(|_| "turn-aware".into());
        Ok(Self {
            noise: setting("NOISE", 1.0)?,
            wind_mps: setting("WIND", 8.0)?,
            lag_s: setting("LAG", 0.6)?,
            factor: setting("FACTOR", 0.74)?,
            sigmas: setting("SIGMAS", 3.0)?,
            margin_m: setting("MARGIN", 0.05)?,
            policy: PolicyChoice::parse(&policy, start.as_deref())?,
        })
    }

    /// The aircraft with its wind for an encounter.
    fn settings(&self, planar: bool, number: u64, seed: u64) -> Result<BatchSettings, String> {
        let mut model = VehicleModel::built_in().map_err(|e| e.to_string())?;
        if planar {
            (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
        }
        model.vehicle.response.bank_time_constant_s = self.lag_s;
        model.vehicle.response.turn_rate_factor = self.factor;
        model.settings.avoider.confidence_sigmas = self.sigmas;
        model.settings.avoider.margin_m = self.margin_m;
        model.sensor.position_sigma_m = 3.0 * self.noise;
        model.sensor.velocity_sigma_mps = 0.5 * self.noise;
        let (sin, cos) = libm::sincos(number as f64 * NEXT_WIND_RAD);
        model.wind_mps = Vec3::new(cos, sin, 0.0) * self.wind_mps;
        Ok(BatchSettings {
            model,
            policy: self.policy,
            horizon_s: 60.0,
            seed,
            tracks: false,
        })
    }
}

/// States and reasons as they change, and how often each reason stood.
#[derive(Debug, Default)]
struct Story {
    changes: Vec<String>,
    last: Option<(State, Reason)>,
    reasons: Vec<(Reason, u32)>,
}

impl Observer for Story {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let decision = moment.decision;
        let now = (decision.state, decision.record.reason);
        match self.reasons.iter_mut().find(|(reason, _)| *reason == now.1) {
            Some((_, count)) => *count += 1,
            None => self.reasons.push((now.1, 1)),
        }
        if self.last != Some(now) {
            let margin = decision
                .record
                .chosen
                .map_or(f64::NAN, |chosen| chosen.margin_m);
            self.changes.push(format!(
                "{:.1} {:?}/{:?} {margin:.1}",
                moment.time_s, now.0, now.1
            ));
            self.last = Some(now);
        }
    }
}

/// What came of an encounter.
struct Flown {
    number: u64,
    outcome: Outcome,
    oracle_m: f64,
    story: Story,
}

fn fly(source: &EncounterSource, conditions: &Conditions, number: u64) -> Result<Flown, String> {
    let settings = conditions.settings(source.planar, number, source.seed)?;
    let model = &settings.model;
    let (course_rad, climb_rad) = crab(Vec3::X, model.vehicle.airspeed_mps, model.wind_mps)
        .ok_or("the wind is too strong to hold the line")?;
    let mut world: World = empty_world(&settings).ok_or("the wind is too strong")?;
    let heading = fga::angle::direction(course_rad, climb_rad) * model.vehicle.airspeed_mps;
    let drawn = EncounterSource {
        airspeed_mps: (heading + model.wind_mps).x,
        ..*source
    };
    let encounter: Encounter = drawn.encounter(number);
    world.stream = number;
    world.obstacles = encounter
        .obstacles
        .iter()
        .map(|o| {
            let track = Track::straight(o.position_m, o.velocity_mps);
            WorldObstacle::new(o.id, track, o.volume)
        })
        .collect();
    let mut pilot = settings
        .policy
        .pilot(&world.settings, &world.vehicle)
        .map_err(|e| e.to_string())?;
    let mut story = Story::default();
    let outcome = Engine::new().fly(&world, pilot.as_mut(), &mut story);
    let start = OracleStart {
        course_rad,
        climb_rad,
        ..OracleStart::ORIGIN
    };
    let obstacles: Vec<OracleObstacle> = encounter
        .obstacles
        .iter()
        .map(|o| OracleObstacle::from(o).in_wind(model.wind_mps))
        .collect();
    let oracle_m = if outcome.separated() {
        // Saved is saved: only what is lost has to be judged.
        f64::INFINITY
    } else {
        let oracle_settings = OracleSettings {
            enough_m: Some(1.0),
            ..OracleSettings::default()
        };
        let vehicle = OracleVehicle::from(&model.vehicle);
        best_margin(&start, &vehicle, &obstacles, &oracle_settings).best_margin_m
    };
    Ok(Flown {
        number,
        outcome,
        oracle_m,
        story,
    })
}

fn cells() -> Vec<String> {
    let mut cells = Vec::new();
    for option in ["", ",planar"] {
        for seen in ["100-500", "300"] {
            for count in [1, 2, 3, 5, 10] {
                for speed in ["0", "0-15", "15-30", "30-45", "45-60"] {
                    cells.push(format!("threats:{count}:{seen}:{speed}{option}"));
                }
            }
        }
    }
    cells
}

fn run(arguments: &[String]) -> Result<(), String> {
    let [seed, count, chosen @ ..] = arguments else {
        return Err("usage: robustness SEED COUNT [CELL…]".into());
    };
    let number = |text: &str| {
        text.parse::<u64>()
            .map_err(|e| format!("{text}: expected a number: {e}"))
    };
    let (seed, count) = (number(seed)?, number(count)?);
    let conditions = Conditions::from_environment()?;
    let verbose = std::env::var_os("VERBOSE").is_some();
    let only = std::env::var("ONLY").ok().map(|n| number(&n)).transpose()?;
    let cells = if chosen.is_empty() {
        cells()
    } else {
        chosen.to_vec()
    };
    println!("cell,saved,lost,not avoidable,share saved %");
    let (mut all_saved, mut all_lost) = (0, 0);
    for cell in &cells {
        let source = EncounterSource::parse(cell, seed)?;
        let flown: Vec<Flown> = (0..count)
            .into_par_iter()
            .filter(|n| only.is_none_or(|only| only == *n))
            .map(|n| fly(&source, &conditions, n))
            .collect::<Result<_, _>>()?;
        let saved = flown.iter().filter(|f| f.outcome.separated()).count();
        let is_lost = |f: &&Flown| !f.outcome.separated() && f.oracle_m >= 0.1;
        let lost = flown.iter().filter(is_lost).count();
        let share = 100.0 * saved as f64 / (saved + lost).max(1) as f64;
        println!(
            "{cell},{saved},{lost},{},{share:.1}",
            flown.len() - saved - lost
        );
        for f in flown.iter().filter(is_lost) {
            println!(
                "  lost {}: {:.2} m, oracle {:.2} m, {:?}",
                f.number, f.outcome.min_margin_m, f.oracle_m, f.story.reasons
            );
            if verbose {
                println!("    {}", f.story.changes.join("; "));
            }
        }
        all_saved += saved;
        all_lost += lost;
    }
    let share = 100.0 * all_saved as f64 / (all_saved + all_lost).max(1) as f64;
    println!("all,{all_saved},{all_lost},,{share:.2}");
    Ok(())
}

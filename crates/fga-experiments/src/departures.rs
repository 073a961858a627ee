//! How far policies depart from the mission, when they start, and whether they come back.
//!
//! | mode | what |
//! |---|---|
//! | `compare` | `turn-aware` and `published --start t0` on the same encounters: the number that each saves, and over those that both save the medians of the largest cross-track deviation and the extra path; each flight continues until it is back, at most 300 s |
//! | `oracle` | `turn-aware` and the oracle's safe manoeuvre of least departure, followed by the same way back once the obstacles have passed |
//! | `latest` | `turn-aware --start latest`: its start against the last moment at which the oracle still finds a way out |
//! | `needless` | traffic that passes close but clear: does the policy act, and does it enter anything? |

use clap::{Args, ValueEnum};
use fga::Vec3;
use fga::avoider::{Decision, Settings, State};
use fga::maneuver::{Maneuver, Stage};
use fga::situation::Situation;
use fga::situation::{Obstacle, ProtectedVolume};
use fga::vehicle::Vehicle;
use fga_campaign::encounters::{EncounterSource, Random, Range};
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin, least_departure,
};
use fga_formats::encounters::Encounter;
use fga_sim::engine::{DecisionMoment, Engine, Observer, Outcome, Sample};
use fga_sim::mission_pilot::MissionPilot;
use fga_sim::policy::{Pilot, PolicyChoice};
use rayon::prelude::*;

use crate::common::{DrawOptions, median, model, oracle_obstacles, pilot, settings, world};

/// Back on the leg: within this of the line, metres, and of its direction, radians.
const BACK: (f64, f64) = (20.0, 5.0 * core::f64::consts::PI / 180.0);

/// Longest flight, seconds.
const LONGEST_S: f64 = 300.0;

/// The last sample, and the last change of state.
#[derive(Default)]
struct Last {
    sample: Option<Sample>,
    states: Vec<String>,
}

impl Observer for Last {
    fn sample(&mut self, sample: &Sample) {
        self.sample = Some(*sample);
    }

    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let now = format!(
            "{:?}/{:?}",
            moment.decision.state, moment.decision.record.reason
        );
        if self.states.last().is_none_or(|last| !last.ends_with(&now)) {
            self.states.push(format!("{:.1} {now}", moment.time_s));
        }
    }
}

impl Last {
    fn is_back(&self) -> bool {
        self.sample.is_some_and(|sample| {
            let beside_m = sample.position_m.y.hypot(sample.position_m.z);
            let direction = fga::angle::direction(sample.course_rad, sample.climb_rad);
            beside_m <= BACK.0 && direction.angle_between(Vec3::X) <= BACK.1
        })
    }
}

fn fly(
    encounter: &Encounter,
    planar: bool,
    policy: &str,
    start: Option<&str>,
) -> Result<(Outcome, Last), String> {
    let policy = PolicyChoice::parse(policy, start)?;
    fly_under(encounter, planar, policy, |pilot| pilot)
}

/// Flies an encounter under a policy's pilot, or under a pilot made from it.
fn fly_under(
    encounter: &Encounter,
    planar: bool,
    policy: PolicyChoice,
    make: impl FnOnce(Box<dyn Pilot + Send>) -> Box<dyn Pilot + Send>,
) -> Result<(Outcome, Last), String> {
    let settings = settings(planar, policy, LONGEST_S)?;
    let world = world(&settings, encounter)?;
    let pilot = pilot(&settings, &world)?;
    let mut pilot = make(pilot);
    let mut last = Last::default();
    let outcome = Engine::new().fly(&world, pilot.as_mut(), &mut last);
    Ok((outcome, last))
}

/// Flies a manoeuvre of the oracle, then the policy's way back.
struct OraclePilot {
    maneuver: Maneuver,
    until_s: f64,
    /// Duration of the decisions until then.
    idle: MissionPilot,
    back: Box<dyn Pilot + Send>,
}

impl Pilot for OraclePilot {
    fn retune(&mut self, vehicle: &Vehicle) {
        self.idle.retune(vehicle);
        self.back.retune(vehicle);
    }

    fn restart(&mut self) {
        self.idle.restart();
        self.back.restart();
    }

    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        if situation.time_s >= self.until_s {
            return self.back.step(situation);
        }
        Decision {
            state: State::Avoiding,
            command: self.maneuver.after(situation.time_s).into(),
            ..self.idle.step(situation)
        }
    }
}

/// Flies the oracle's safe manoeuvre of least departure; `None` if the oracle finds none.
fn fly_oracle(encounter: &Encounter, planar: bool) -> Result<Option<Outcome>, String> {
    let vehicle = OracleVehicle::from(&model(planar)?.vehicle);
    let obstacles = oracle_obstacles(encounter);
    let (start, settings) = (OracleStart::ORIGIN, OracleSettings::default());
    let Some(best) = least_departure(&start, &vehicle, &obstacles, &settings, 0.05) else {
        return Ok(None);
    };
    let of = best.maneuver;
    let rate_radps = vehicle.course_rate_radps;
    let mut maneuver = Maneuver::hold();
    let mut stage = |start_s, course_rad, climb_rad| {
        maneuver.push(Stage {
            start_s,
            course_rad,
            climb_rad,
            rate_share: 1.0,
        });
    };
    stage(of.wait_s, of.turn1_rad, of.climb1_rad);
    let second_s = of.wait_s + of.turn1_rad.abs() / rate_radps + of.straight_s;
    stage(second_s, of.turn1_rad + of.turn2_rad, of.climb2_rad);
    let horizon_s = Settings::default().horizon_s;
    let idle = MissionPilot::new(horizon_s, model(planar)?.vehicle).map_err(|e| e.to_string())?;
    let policy = PolicyChoice::parse("turn-aware", None)?;
    let flown = fly_under(encounter, planar, policy, |back| {
        Box::new(OraclePilot {
            maneuver,
            until_s: best.passed_s,
            idle,
            back,
        })
    })?;
    Ok(Some(flown.0))
}

fn beside_oracle(cell: &str, source: &EncounterSource, count: u64) -> Result<(), String> {
    let flown: Vec<_> = (0..count)
        .into_par_iter()
        .map(|n| {
            let encounter = source.encounter(n)?;
            let (ours, _) = fly(&encounter, source.planar, "turn-aware", None)?;
            Ok(fly_oracle(&encounter, source.planar)?.map(|best| (ours, best)))
        })
        .collect::<Result<_, String>>()?;
    let both: Vec<_> = flown
        .into_iter()
        .flatten()
        .filter(|(ours, best)| ours.separated() && best.separated())
        .collect();
    let of = |value: fn(&Outcome) -> f64| {
        let ours = median(both.iter().map(|pair| value(&pair.0)).collect());
        let best = median(both.iter().map(|pair| value(&pair.1)).collect());
        format!("{ours:.2},{best:.2}")
    };
    let (cross, extra) = (of(|o| o.max_cross_track_m), of(|o| o.extra_path_m));
    let ours_m: f64 = both.iter().map(|pair| pair.0.max_cross_track_m).sum();
    let best_m: f64 = both.iter().map(|pair| pair.1.max_cross_track_m).sum();
    let mut ratios: Vec<f64> = both
        .iter()
        .map(|(ours, best)| ours.max_cross_track_m / best.max_cross_track_m)
        .collect();
    ratios.sort_by(f64::total_cmp);
    let most_of = ratios.len().saturating_sub(1) * 9 / 10;
    println!(
        "{cell},{},{cross},{extra},{:.2},{:.2}",
        both.len(),
        ours_m / best_m,
        ratios.get(most_of).unwrap_or(&f64::NAN)
    );
    Ok(())
}

fn compare(cell: &str, source: &EncounterSource, count: u64) -> Result<(), String> {
    let flown: Vec<_> = (0..count)
        .into_par_iter()
        .map(|n| {
            let encounter = source.encounter(n)?;
            let ours = fly(&encounter, source.planar, "turn-aware", None)?;
            let published = fly(&encounter, source.planar, "published", Some("t0"))?;
            Ok((n, ours, published))
        })
        .collect::<Result<_, String>>()?;
    let saved = flown.iter().filter(|f| f.1.0.separated()).count();
    let stranded: Vec<_> = flown
        .iter()
        .filter(|f| f.1.0.separated() && !f.1.1.is_back())
        .collect();
    let published = flown.iter().filter(|f| f.2.0.separated()).count();
    let both = || {
        flown
            .iter()
            .filter(|f| f.1.0.separated() && f.2.0.separated())
    };
    let back = || both().filter(|f| f.1.0.end_s < LONGEST_S && f.2.0.end_s < LONGEST_S);
    println!(
        "{cell},{saved},{published},{},{},{:.2},{:.2},{:.2},{:.2}",
        stranded.len(),
        both().count(),
        median(both().map(|f| f.1.0.max_cross_track_m).collect()),
        median(both().map(|f| f.2.0.max_cross_track_m).collect()),
        median(back().map(|f| f.1.0.extra_path_m).collect()),
        median(back().map(|f| f.2.0.extra_path_m).collect()),
    );
    for (n, (outcome, last), _) in stranded {
        let from = last.states.len().saturating_sub(6);
        println!(
            "  stranded {n}: end {:.0} s, {:?}, {}",
            outcome.end_s,
            last.sample.map(|s| (s.position_m, s.course_rad)),
            last.states[from..].join("; ")
        );
    }
    Ok(())
}

/// The last moment on the line, in steps of 0.05 s, from which the oracle still finds a way out.
fn latest_s(encounter: &Encounter, planar: bool) -> Result<Option<f64>, String> {
    let vehicle = OracleVehicle::from(&model(planar)?.vehicle);
    let settings = OracleSettings {
        enough_m: Some(0.1),
        ..OracleSettings::default()
    };
    let still = |wait_s: f64| {
        let start = OracleStart {
            position_m: Vec3::X * (vehicle.airspeed_mps * wait_s),
            ..OracleStart::ORIGIN
        };
        let obstacles: Vec<OracleObstacle> = encounter
            .obstacles
            .iter()
            .map(|o| {
                let mut later = OracleObstacle::from(o);
                later.position_m = o.position_after_m(wait_s);
                later
            })
            .collect();
        best_margin(&start, &vehicle, &obstacles, &settings).best_margin_m >= 0.05
    };
    if !still(0.0) {
        return Ok(None);
    }
    // On the line until it enters the first volume.
    let entry_s = |o: &Obstacle| {
        let relative = o.velocity_mps - Vec3::X * vehicle.airspeed_mps;
        let (square, along) = (relative.length_squared(), -o.position_m.dot(relative));
        let radius_m = o.volume.radius_m();
        let outside = o.position_m.length_squared() - radius_m * radius_m;
        let root = along * along - square * outside;
        if root > 0.0 && along > 0.0 {
            (along - root.sqrt()) / square
        } else {
            60.0
        }
    };
    let first = encounter.obstacles.iter().map(entry_s);
    let (mut good, mut bad) = (0.0, first.fold(60.0, f64::min));
    while bad - good > 0.05 {
        let middle = 0.5 * (good + bad);
        if still(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Ok(Some(good))
}

fn latest(cell: &str, source: &EncounterSource, count: u64) -> Result<(), String> {
    let flown: Vec<_> = (0..count)
        .into_par_iter()
        .map(|n| {
            let encounter = source.encounter(n)?;
            let (outcome, _) = fly(&encounter, source.planar, "turn-aware", Some("latest"))?;
            let latest_s = latest_s(&encounter, source.planar)?;
            Ok((n, outcome, latest_s))
        })
        .collect::<Result<_, String>>()?;
    let avoidable = || flown.iter().filter(|f| f.2.is_some());
    let lost: Vec<u64> = avoidable()
        .filter(|f| !f.1.separated())
        .map(|f| f.0)
        .collect();
    let before = |f: &(u64, Outcome, Option<f64>)| Some(f.2? - f.1.start_s?);
    println!(
        "{cell},{},{},{:.2},{:.2},{lost:?}",
        avoidable().count(),
        avoidable().filter(|f| f.1.separated()).count(),
        median(avoidable().filter_map(before).collect()),
        avoidable().filter_map(before).fold(f64::MIN, f64::max),
    );
    Ok(())
}

/// Traffic that passes close, but not too close.
fn clear_traffic(seed: u64, number: u64, planar: bool) -> Encounter {
    let mut random = Random::new(seed, number);
    let count = random.count(1, 10);
    let margin = |position: Vec3, velocity: Vec3| {
        let relative = velocity - Vec3::X * 15.0;
        let when = (-position.dot(relative) / relative.length_squared().max(1e-12)).max(0.0);
        (position + relative * when).length() - 30.0
    };
    let mut obstacles = Vec::new();
    while obstacles.len() < count as usize {
        let position_m = random.direction(planar) * random.within(Range(40.0, 500.0));
        let velocity_mps = random.direction(planar) * random.within(Range(0.0, 60.0));
        // The first one passes within fifteen metres of its volume.
        let limit = if obstacles.is_empty() { 15.0 } else { 1e9 };
        if (0.05..limit).contains(&margin(position_m, velocity_mps)) {
            let id = u32::try_from(obstacles.len()).unwrap_or(u32::MAX);
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            obstacles.push(Obstacle::straight(id, position_m, velocity_mps, volume));
        }
    }
    Encounter {
        id: number,
        obstacles,
    }
}

fn needless(seed: u64, count: u64) -> Result<(), String> {
    for planar in [false, true] {
        let flown: Vec<_> = (0..count)
            .into_par_iter()
            .map(|n| {
                let encounter = clear_traffic(seed, n, planar);
                let (outcome, _) = fly(&encounter, planar, "turn-aware", None)?;
                Ok((n, outcome))
            })
            .collect::<Result<_, String>>()?;
        let numbers = |test: fn(&Outcome) -> bool| -> Vec<u64> {
            let kept = flown.iter().filter(|f| test(&f.1));
            kept.map(|f| f.0).collect()
        };
        let acted = numbers(|o| o.start_s.is_some());
        let entered = numbers(|o| !o.separated());
        println!(
            "planar {planar}: {count} flown, {} manoeuvred {:?}, {} entered {entered:?}",
            acted.len(),
            acted.iter().take(10).collect::<Vec<_>>(),
            entered.len()
        );
    }
    Ok(())
}

/// The measurement.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum DepartureMode {
    /// Against the published rule.
    Compare,
    /// Against the oracle's manoeuvre of least departure.
    Oracle,
    /// The latest start against the oracle's.
    Latest,
    /// Traffic that passes clear; takes no cells.
    Needless,
}

/// Options of `departures`.
#[derive(Args, Debug)]
pub(crate) struct DeparturesArgs {
    /// The measurement.
    mode: DepartureMode,
    #[command(flatten)]
    draw: DrawOptions,
}

/// Measures a cell, given by name and source, over a number of encounters, and prints its row.
type DepartureMeasure = fn(&str, &EncounterSource, u64) -> Result<(), String>;

/// Prints a row for each cell.
pub(crate) fn run(args: &DeparturesArgs) -> Result<(), String> {
    let count = args.draw.count;
    let (head, measure): (&str, DepartureMeasure) = match args.mode {
        DepartureMode::Needless => return needless(args.draw.seed, count),
        DepartureMode::Compare => (
            "cell,saved,saved by published,stranded,saved by both,cross m,published cross m,\
                 extra m,published extra m",
            compare,
        ),
        DepartureMode::Oracle => (
            "cell,saved by both,cross m,oracle cross m,extra m,oracle extra m,ratio of mean cross,90 % of the ratios",
            beside_oracle,
        ),
        DepartureMode::Latest => (
            "cell,avoidable,saved,median s before the latest,most s,lost",
            latest,
        ),
    };
    println!("{head}");
    args.draw
        .sources()?
        .iter()
        .try_for_each(|(cell, source)| measure(cell, source, count))
}

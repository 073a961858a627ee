//! Which encounters does the oracle save and a policy lose?
//!
//! With `--turning` the closest intruder turns by 45° after the policy has avoided for a second: to the
//! left in encounters of an even number, else to the right. The oracle learns of the turn when the
//! policy does: it starts from the aircraft's state at that moment.
//!
//! With `--layer` the aircraft must stay so near to the altitude of its mission. The oracle knows the layer as two wide cylinders.

use core::f64::consts::FRAC_PI_4;

use clap::Args;
use fga::Vec3;
use fga::avoider::State;
use fga::situation::ProtectedVolume;
use fga_campaign::batch::BatchSettings;
use fga_campaign::campaign::parse_policy;
use fga_campaign::oracle::{
    AVOIDABLE_MARGIN_M, OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin,
};
use fga_formats::encounters::Encounter;
use fga_sim::engine::{DecisionMoment, Engine, Observer, Outcome};
use fga_sim::track::{Track, TrackPoint};
use fga_sim::world::{World, WorldObstacle};
use rayon::prelude::*;

use crate::common::{DrawOptions, median, oracle_obstacles, pilot, settings, world};

/// Options of `lost`.
#[derive(Args, Debug)]
pub(crate) struct LostArgs {
    #[command(flatten)]
    draw: DrawOptions,
    /// The policy, as in "published --start t0".
    #[arg(long, default_value = "turn-aware")]
    policy: String,
    /// The closest intruder turns by 45° after a second of avoidance.
    #[arg(long)]
    turning: bool,
    /// Half of the height of the layer around the mission in which the aircraft must stay, whole metres.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    layer: Option<u32>,
}

/// Longest flight, seconds.
const HORIZON_S: f64 = 60.0;

/// Time from the beginning of the avoidance to the intruder's turn, seconds.
const TURNS_AFTER_S: f64 = 1.0;

/// Radius and half height of the cylinders that bound a layer, metres: farther than an aircraft flies.
const SLAB_M: (f64, f64) = (1e5, 1e4);

/// A layer is left by more than the accuracy of a sample, metres.
const LEFT_M: f64 = 0.01;

/// Follows a flight: the start of the avoidance, the entries, the largest altitude above or below the mission, and the state of
/// everything when an intruder is to turn.
#[derive(Default)]
struct LostStory {
    off_m: f64,
    avoids_s: Option<f64>,
    states: Vec<(f64, State)>,
    turn: Option<(f64, OracleStart)>,
}

impl Observer for LostStory {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let state = moment.decision.state;
        self.off_m = f64::max(self.off_m, moment.situation.ownship.position_m.z.abs());
        if self.states.last().is_none_or(|(_, last)| *last != state) {
            self.states.push((moment.time_s, state));
        }
        if state == State::Avoiding {
            self.avoids_s.get_or_insert(moment.time_s);
        }
        let due = |begun_s| moment.time_s >= begun_s + TURNS_AFTER_S - 1e-9;
        if self.turn.is_none() && self.avoids_s.is_some_and(due) {
            let own = &moment.situation.ownship;
            let start = OracleStart {
                position_m: own.position_m,
                course_rad: own.course_rad,
                climb_rad: own.climb_rad,
                ..OracleStart::ORIGIN
            };
            self.turn = Some((moment.time_s, start));
        }
    }
}

/// The result of an encounter.
struct LostFlight {
    number: u64,
    outcome: Outcome,
    states: Vec<(f64, State)>,
    /// Largest altitude above or below the mission, metres.
    off_m: f64,
    /// The oracle's margin, metres, if the flight entered a volume.
    oracle_m: Option<f64>,
}

fn fly(
    settings: &BatchSettings,
    encounter: &Encounter,
    args: &LostArgs,
) -> Result<LostFlight, String> {
    let mut world = world(settings, encounter)?;
    if let Some(layer_m) = args.layer.map(f64::from) {
        world.limits_m = (-layer_m, layer_m);
    }
    let mut story = LostStory::default();
    let mut outcome = Engine::new().fly(&world, pilot(settings, &world)?.as_mut(), &mut story);
    let mut start = OracleStart::ORIGIN;
    let mut obstacles = oracle_obstacles(encounter);
    if args.turning
        && let Some((turn_s, from)) = story.turn
    {
        // Until the turn, the second flight repeats the first one.
        obstacles = turn_closest(&mut world, turn_s, from.position_m, encounter.id);
        start = from;
        story = LostStory::default();
        outcome = Engine::new().fly(&world, pilot(settings, &world)?.as_mut(), &mut story);
    }
    let is_lost = !outcome.separated()
        || args
            .layer
            .is_some_and(|m| story.off_m > f64::from(m) + LEFT_M);
    let oracle_m = is_lost.then(|| {
        obstacles.extend(args.layer.map(f64::from).into_iter().flat_map(slabs));
        let vehicle = OracleVehicle::from(&settings.model.vehicle);
        best_margin(&start, &vehicle, &obstacles, &OracleSettings::default()).best_margin_m
    });
    Ok(LostFlight {
        number: encounter.id,
        outcome,
        off_m: story.off_m,
        states: story.states,
        oracle_m,
    })
}

/// What is above and below a layer.
fn slabs(layer_m: f64) -> [OracleObstacle; 2] {
    let (radius_m, half_height_m) = SLAB_M;
    [-1.0, 1.0].map(|side| OracleObstacle {
        position_m: Vec3::new(0.0, 0.0, side * (layer_m + half_height_m)),
        velocity_mps: Vec3::ZERO,
        volume: ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        },
    })
}

/// Turns the obstacle closest to a position at a time; returns the state of all obstacles at that time.
fn turn_closest(
    world: &mut World,
    turn_s: f64,
    position_m: Vec3,
    number: u64,
) -> Vec<OracleObstacle> {
    let distance_m = |obstacle: &WorldObstacle| {
        let at = obstacle.track.at(turn_s);
        at.map_or(f64::INFINITY, |(at_m, _)| at_m.distance(position_m))
    };
    let closest = world
        .obstacles
        .iter_mut()
        .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
    if let Some(obstacle) = closest
        && let Track::Straight {
            position_m,
            velocity_mps: v,
        } = obstacle.track
    {
        let side = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (sin, cos) = libm::sincos(side * FRAC_PI_4);
        let turned_mps = Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
        let corner_m = position_m + v * turn_s;
        let after_s = 2.0 * HORIZON_S;
        let turned = Track::through(vec![
            TrackPoint {
                time_s: 0.0,
                position_m,
            },
            TrackPoint {
                time_s: turn_s,
                position_m: corner_m,
            },
            TrackPoint {
                time_s: turn_s + after_s,
                position_m: corner_m + turned_mps * after_s,
            },
        ]);
        obstacle.track = turned.unwrap_or(Track::Straight {
            position_m,
            velocity_mps: v,
        });
    }
    world
        .obstacles
        .iter()
        .filter_map(|obstacle| {
            let (position_m, velocity_mps) = obstacle.track.at(turn_s + 1e-6)?;
            Some(OracleObstacle {
                position_m,
                velocity_mps,
                volume: obstacle.volume,
            })
        })
        .collect()
}

/// Flies every cell and prints one line for it, and one for each encounter that is lost although
/// the oracle saves it.
pub(crate) fn run(args: &LostArgs) -> Result<(), String> {
    let policy = parse_policy(&args.policy)?;
    let (mut all_avoidable, mut all_lost) = (0, 0);
    println!("cell,saved,lost,not avoidable,not back,median cross m,median extra m");
    for (cell, source) in args.draw.sources()? {
        let settings = settings(source.planar, policy.clone(), HORIZON_S)?;
        let flown: Vec<LostFlight> = (0..args.draw.count)
            .into_par_iter()
            .map(|number| fly(&settings, &source.encounter(number)?, args))
            .collect::<Result<_, _>>()?;
        let left = |f: &LostFlight| args.layer.is_some_and(|m| f.off_m > f64::from(m) + LEFT_M);
        let saved: Vec<&LostFlight> = flown
            .iter()
            .filter(|f| f.outcome.separated() && !left(f))
            .collect();
        let is_lost = |f: &&LostFlight| {
            f.oracle_m
                .is_some_and(|best_m| best_m >= AVOIDABLE_MARGIN_M)
        };
        let lost = flown.iter().filter(is_lost).count();
        let back: Vec<&&LostFlight> = saved
            .iter()
            .filter(|f| f.outcome.end_s < HORIZON_S)
            .collect();
        println!(
            "{cell},{},{lost},{},{},{:.2},{:.2}",
            saved.len(),
            flown.len() - saved.len() - lost,
            saved.len() - back.len(),
            median(saved.iter().map(|f| f.outcome.max_cross_track_m).collect()),
            median(back.iter().map(|f| f.outcome.extra_path_m).collect()),
        );
        for f in flown.iter().filter(|f| is_lost(f) || left(f)) {
            println!(
                "  lost {}: flown {:.3} m, {:.2} m above or below the mission, oracle {:.3} m, {:?}",
                f.number,
                f.outcome.min_margin_m,
                f.off_m,
                f.oracle_m.unwrap_or(f64::NAN),
                f.states
            );
        }
        all_avoidable += saved.len() + lost;
        all_lost += lost;
    }
    println!("all: {all_lost} lost of {all_avoidable} avoidable");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: LostArgs,
    }

    #[test]
    fn no_flight_leaves_its_layer() {
        for (layer_m, cell) in [(60, "threats:2:300:30-45"), (40, "threats:3:300:15-30")] {
            let layer = format!("--layer={layer_m}");
            let args = Line::parse_from(["lost", "7", "20", cell, layer.as_str()]).args;
            let policy = parse_policy(&args.policy).unwrap();
            let settings = settings(false, policy, HORIZON_S).unwrap();
            let (_, source) = args.draw.sources().unwrap().remove(0);
            let flown: Vec<LostFlight> = (0..args.draw.count)
                .map(|number| fly(&settings, &source.encounter(number).unwrap(), &args).unwrap())
                .collect();
            assert!(flown.iter().any(|f| f.off_m > 1.0), "none climbs: {cell}");
            assert!(
                flown.iter().all(|f| f.off_m <= f64::from(layer_m) + LEFT_M),
                "{cell}"
            );
        }
    }
}

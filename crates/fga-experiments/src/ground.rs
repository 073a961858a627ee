//! Drawn encounters over ground and among zones, seen as by ADS-B: how many flights come into the ground, leave a fence or enter a protected
//! volume, and which of them does an oracle save that knows the same ground and zones?
//!
//! Every third intruder keeps its velocity for the policy, every third is an unmanned aircraft, every third a crewed one; all fly straight.

use clap::Args;
use fga::avoider::Start;
use fga::situation::Movement;
use fga_campaign::encounters::{EncounterSource, Scenery};
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, airspace_of, best_margin_within,
};
use fga_sim::engine::{DecisionMoment, Engine, Observer, Sample};
use fga_sim::policy::PolicyChoice;
use fga_sim::sensor::SensorSettings;
use rayon::prelude::*;

use crate::common::{pilot, settings, world};

/// Numbers, distances and speeds of the intruders.
const INTRUDERS: [&str; 3] = ["1:200-1000:0-60", "2:200-1000:0-60", "3:200-1000:0-60"];

/// Longest flight, seconds.
const LONGEST_S: f64 = 90.0;

/// Horizon of the oracle, seconds: every threat has passed by then.
const ORACLE_S: f64 = 60.0;

/// Options of `ground`.
#[derive(Args, Debug)]
pub(crate) struct SceneryArgs {
    /// Number of encounters, over all families.
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Families, as in a campaign's cells.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "valley,ridges,ground-wall,corridor"
    )]
    families: Vec<String>,
    /// σ of a reported position along each axis, metres.
    #[arg(long, default_value_t = 0.0)]
    position_sigma_m: f64,
    /// σ of a reported velocity along each axis, metres per second.
    #[arg(long, default_value_t = 0.0)]
    velocity_sigma_mps: f64,
}

/// One flight.
struct GroundFlight {
    number: u64,
    unproven: bool,
    /// Least margin of the protected volumes, metres.
    margin_m: f64,
    /// Least height above the lowest that clears the ground, and above the ground itself, metres.
    above_m: (f64, f64),
    /// Least distance of the zones, metres; negative on the wrong side.
    zone_m: f64,
    over_unknown: bool,
    /// Whether the same flight comes into the ground or to the wrong side of a zone where the policy does not know of them.
    blind_is_in: bool,
    /// What the oracle keeps where the flight does not, metres.
    oracle_m: Option<f64>,
}

impl GroundFlight {
    fn entered(&self) -> bool {
        self.margin_m < 0.0
    }

    fn is_avoidable(&self) -> bool {
        self.oracle_m.is_some_and(|oracle_m| oracle_m >= 0.1)
    }
}

/// Whether some decision was not certified.
#[derive(Default)]
struct Unproven(bool);

impl Observer for Unproven {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        self.0 |= moment.decision.record.reason.is_unproven();
    }
}

/// Whether a flight comes into ground or zones of which its world has nothing.
struct Blind<'a> {
    scenery: &'a Scenery,
    is_in: bool,
}

impl Observer for Blind<'_> {
    fn sample(&mut self, sample: &Sample) {
        let at_m = sample.position_m;
        let ground = self.scenery.ground.as_ref();
        let above_m = ground.and_then(|ground| ground.above_m(at_m));
        let mut zones = self.scenery.zones.iter();
        self.is_in |= above_m.is_some_and(|above_m| above_m < 0.0)
            || zones.any(|zone| zone.margin_m(at_m) < 0.0);
    }
}

/// Flies all families and prints the counts.
pub(crate) fn run(args: &SceneryArgs) -> Result<(), String> {
    let mut all = Vec::new();
    for (family, index) in args.families.iter().zip(0..) {
        let sources: Result<Vec<EncounterSource>, String> = INTRUDERS
            .iter()
            .map(|intruders| EncounterSource::parse(&format!("{family}:{intruders}"), args.seed))
            .collect();
        let sources = sources?;
        let count = args.count.div_ceil(args.families.len() as u64);
        let flown: Result<Vec<GroundFlight>, String> = (index * count..(index + 1) * count)
            .into_par_iter()
            .map(|number| fly_one(&sources[kind_of(number)], number, args))
            .collect();
        let flown = flown?;
        show(family, &flown);
        all.extend(flown);
    }
    show("all", &all);
    Ok(())
}

/// The place in [`INTRUDERS`] of a flight's number.
fn kind_of(number: u64) -> usize {
    usize::try_from(number / 3 % INTRUDERS.len() as u64).unwrap_or(0)
}

fn show(name: &str, flown: &[GroundFlight]) {
    let count = |is: &dyn Fn(&GroundFlight) -> bool| flown.iter().filter(|f| is(f)).count();
    let entered = count(&GroundFlight::entered);
    let avoidable = count(&|f| f.entered() && f.is_avoidable());
    let saved = flown.len() - entered;
    println!(
        "{name}: flown {}, with a decision that is not certified {}; into the ground {}, below the clearance {}, over unknown ground {}, on the wrong \
         side of a zone {}; in a volume {entered}, of them avoidable {avoidable}: {:.2} % of what the oracle saves; unknown to the policy, in the ground or on the wrong side of a zone {}",
        flown.len(),
        count(&|f| f.unproven),
        count(&|f| f.above_m.1 < 0.0),
        count(&|f| f.above_m.0 < 0.0),
        count(&|f| f.over_unknown),
        count(&|f| f.zone_m < 0.0),
        100.0 * avoidable as f64 / (saved + avoidable).max(1) as f64,
        count(&|f| f.blind_is_in),
    );
    for f in flown.iter().filter(|_| name != "all") {
        let is_bad = f.entered() || f.above_m.0 < 0.0 || f.zone_m < 0.0 || f.over_unknown;
        if is_bad {
            println!(
                "  {}: volume {:.2} m, above the ground {:.2} m, zone {:.2} m, unknown ground {}, not certified {}, oracle {:.2} m",
                f.number,
                f.margin_m,
                f.above_m.1,
                f.zone_m,
                f.over_unknown,
                f.unproven,
                f.oracle_m.unwrap_or(f64::NAN),
            );
        }
    }
}

fn fly_one(
    source: &EncounterSource,
    number: u64,
    args: &SceneryArgs,
) -> Result<GroundFlight, String> {
    let settings = settings(false, PolicyChoice::Avoider(Start::Free), LONGEST_S)?;
    let encounter = source.encounter(number)?;
    let mut world = world(&settings, &encounter)?;
    world.sensor = SensorSettings {
        update_period_s: 1.0,
        delay_s: 0.5,
        position_sigma_m: args.position_sigma_m,
        velocity_sigma_mps: args.velocity_sigma_mps,
        ..SensorSettings::default()
    };
    let movement = match number % 3 {
        0 => Movement::Straight,
        1 => Movement::SMALL_UAS,
        _ => Movement::CREWED,
    };
    for obstacle in &mut world.obstacles {
        obstacle.movement = movement;
    }
    let scenery = source.scenery(number);
    let mut blind = Blind {
        scenery: &scenery,
        is_in: false,
    };
    Engine::new().fly(&world, pilot(&settings, &world)?.as_mut(), &mut blind);
    let blind_is_in = blind.is_in;
    scenery.place(&mut world);
    let mut seen = Unproven::default();
    let mut engine = Engine::new();
    let mut pilot = pilot(&settings, &world)?;
    let outcome = engine.fly(&world, pilot.as_mut(), &mut seen);
    let ground = engine.ground_separation();
    let above_m = outcome.min_terrain_clearance_m.unwrap_or(f64::INFINITY);
    let asked_m =
        (world.ground.as_ref()).map_or(0.0, |ground| ground.error_m() + ground.clearance_m());
    let zone_m = outcome.min_zone_margin_m.unwrap_or(f64::INFINITY);
    let mut flight = GroundFlight {
        number,
        unproven: seen.0,
        margin_m: outcome.min_margin_m,
        above_m: (above_m - asked_m, above_m),
        zone_m,
        over_unknown: ground.is_some_and(|ground| ground.unknown_s.is_some()),
        blind_is_in,
        oracle_m: None,
    };
    if flight.entered() || above_m < 0.0 || zone_m < 0.0 {
        let obstacles: Vec<OracleObstacle> = encounter
            .obstacles
            .iter()
            .map(OracleObstacle::from)
            .collect();
        let answer = best_margin_within(
            &OracleStart::ORIGIN,
            &OracleVehicle::from(&world.vehicle),
            &obstacles,
            airspace_of(&world),
            &OracleSettings {
                horizon_s: ORACLE_S,
                enough_m: Some(0.5),
                ..OracleSettings::default()
            },
        );
        flight.oracle_m = Some(answer.best_margin_m);
    }
    Ok(flight)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Once a flight went on towards a ridge until no circle was left, and one had its work used up by turns into the ground. Reports are
    /// noisier than they say.
    #[test]
    fn a_ridge_ahead_is_turned_from_while_a_circle_is_left() {
        for (family, seed, number) in [("ridges", 5, 53), ("valley", 9, 421)] {
            let args = SceneryArgs {
                count: 1,
                seed,
                families: Vec::new(),
                position_sigma_m: 8.0,
                velocity_sigma_mps: 1.0,
            };
            let intruders = INTRUDERS[kind_of(number)];
            let source = EncounterSource::parse(&format!("{family}:{intruders}"), seed).unwrap();
            let flown = fly_one(&source, number, &args).unwrap();
            assert!(flown.above_m.0 >= 0.0, "{number}: {:?}", flown.above_m);
        }
    }
}

//! What a step costs over ground: the work and the time of the first search of each drawn encounter, with its ground and without, both from
//! the same situation; and the time of the quiet steps, on the mission without a search, of both flights.

use clap::Args;
use fga::avoider::{Start, State};
use fga::situation::Movement;
use fga_campaign::encounters::EncounterSource;
use fga_sim::engine::{DecisionMoment, Engine, Observer};
use fga_sim::policy::PolicyChoice;
use fga_sim::world::World;

use crate::common::{pilot, settings, world};

/// Work and time of a search, microseconds.
type SearchCost = [f64; 2];

/// Numbers, distances and speeds of the obstacles: at rest, and intruders.
const OBSTACLES: [(&str, &str, Movement); 2] = [
    ("at rest", "3:100-600:0-0", Movement::Straight),
    ("aircraft", "3:200-1000:20-60", Movement::CREWED),
];

/// Options of `ground-cost`.
#[derive(Args, Debug)]
pub(crate) struct CostArgs {
    /// Number of encounters of each family.
    count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Families, as in a campaign's cells.
    #[arg(long, value_delimiter = ',', default_value = "valley,ridges")]
    families: Vec<String>,
}

/// The steps of a flight.
struct Steps<'a> {
    first_search: Option<SearchCost>,
    /// Times of the quiet ones of all flights, microseconds.
    quiet_us: &'a mut Vec<f64>,
}

impl Observer for Steps<'_> {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let (work, step_us) = (moment.decision.record.work, 1e-3 * moment.elapsed_ns as f64);
        if work.candidates > 0 {
            self.first_search
                .get_or_insert([f64::from(work.work), step_us]);
        } else if moment.decision.state == State::Cruise {
            self.quiet_us.push(step_us);
        }
    }
}

/// The value below which this many of a hundred sorted ones are.
fn at(values: &[f64], percent: usize) -> f64 {
    let place = values.len() * percent / 100;
    values.get(place).copied().unwrap_or(f64::NAN)
}

/// Flies all families and prints what the searches cost.
pub(crate) fn run(args: &CostArgs) -> Result<(), String> {
    let settings = settings(false, PolicyChoice::Avoider(Start::Free), 30.0)?;
    for (words, obstacles, movement) in OBSTACLES {
        let mut searches: Vec<(SearchCost, SearchCost)> = Vec::new();
        let mut quiet_us = [Vec::new(), Vec::new()];
        for family in &args.families {
            let source = EncounterSource::parse(&format!("{family}:{obstacles}"), args.seed)?;
            for number in 0..args.count {
                let mut world = world(&settings, &source.encounter(number)?)?;
                for obstacle in &mut world.obstacles {
                    obstacle.movement = movement;
                }
                let first = |world: &World, quiet_us: &mut _| -> Result<_, String> {
                    let mut steps = Steps {
                        first_search: None,
                        quiet_us,
                    };
                    Engine::new().fly(world, pilot(&settings, world)?.as_mut(), &mut steps);
                    Ok(steps.first_search)
                };
                let [without_us, with_us] = &mut quiet_us;
                let without = first(&world, without_us)?;
                source.scenery(number).place(&mut world);
                searches.extend(without.zip(first(&world, with_us)?));
            }
        }
        for (unit, part) in [("units of work", 0), ("microseconds", 1)] {
            let all = |of: &dyn Fn(&(SearchCost, SearchCost)) -> f64| {
                let mut all: Vec<f64> = searches.iter().map(of).collect();
                all.sort_by(f64::total_cmp);
                all
            };
            let (without, with) = (all(&|both| both.0[part]), all(&|both| both.1[part]));
            let ratios = all(&|both| both.1[part] / both.0[part]);
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
            println!(
                "{words}, {unit}, {} searches: median {:.1} without ground, {:.1} with; mean {:.1} and {:.1}; 90 % {:.1} and {:.1}; 99 % {:.1} and \
                 {:.1}; ratio of one search: median {:.2}, 90 % {:.2}",
                searches.len(),
                at(&without, 50),
                at(&with, 50),
                mean(&without),
                mean(&with),
                at(&without, 90),
                at(&with, 90),
                at(&without, 99),
                at(&with, 99),
                at(&ratios, 50),
                at(&ratios, 90),
            );
        }
        for (ground, mut steps_us) in ["without", "with"].into_iter().zip(quiet_us) {
            steps_us.sort_by(f64::total_cmp);
            let count = steps_us.len();
            let [half, most, nearly_all] = [50, 90, 99].map(|percent| at(&steps_us, percent));
            println!(
                "{words}, {count} quiet steps {ground} ground: median {half:.2} µs, 90 % {most:.2} µs, 99 % {nearly_all:.2} µs"
            );
        }
    }
    Ok(())
}

//! What choosing a manoeuvre costs over ground: the work and the time of the first search of each drawn encounter, with its ground and
//! without. Both searches begin with the same situation.

use clap::Args;
use fga::avoider::Start;
use fga::situation::Movement;
use fga_sim::encounters::EncounterSource;
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

/// The first search.
#[derive(Default)]
struct FirstSearch(Option<SearchCost>);

impl Observer for FirstSearch {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let work = moment.decision.record.work;
        let begins = work.candidates > 0 && self.0.is_none();
        if begins {
            self.0 = Some([f64::from(work.work), 1e-3 * moment.elapsed_ns as f64]);
        }
    }
}

/// Flies all families and prints what the searches cost.
pub(crate) fn run(args: &CostArgs) -> Result<(), String> {
    let settings = settings(false, PolicyChoice::Avoider(Start::Free), 30.0)?;
    for (words, obstacles, movement) in OBSTACLES {
        let mut searches: Vec<(SearchCost, SearchCost)> = Vec::new();
        for family in &args.families {
            let source = EncounterSource::parse(&format!("{family}:{obstacles}"), args.seed)?;
            for number in 0..args.count {
                let mut world = world(&settings, &source.encounter(number))?;
                for obstacle in &mut world.obstacles {
                    obstacle.movement = movement;
                }
                let first = |world: &World| -> Result<Option<SearchCost>, String> {
                    let mut first = FirstSearch::default();
                    Engine::new().fly(world, pilot(&settings, world)?.as_mut(), &mut first);
                    Ok(first.0)
                };
                let without = first(&world)?;
                source.scenery(number).place(&mut world);
                searches.extend(without.zip(first(&world)?));
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
            let at = |values: &[f64], percent: usize| {
                let place = values.len() * percent / 100;
                values.get(place).copied().unwrap_or(f64::NAN)
            };
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
    }
    Ok(())
}

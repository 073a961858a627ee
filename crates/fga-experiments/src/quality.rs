//! What does a smaller limit of work cost? The share of the avoidable encounters that the policy saves at several
//! limits, and the largest work of a step.
//!
//! An encounter is avoidable if the policy saves it at some limit, or else if the oracle saves it.

use clap::Args;
use fga::avoider::{LEAST_WORK, Settings};
use fga_campaign::batch::BatchSettings;
use fga_campaign::oracle::{
    AVOIDABLE_MARGIN_M, OracleSettings, OracleStart, OracleVehicle, best_margin,
};
use fga_formats::encounters::Encounter;
use fga_sim::engine::{DecisionMoment, Observer};
use fga_sim::policy::PolicyChoice;
use rayon::prelude::*;

use crate::common::{DrawOptions, fly, median, oracle_obstacles, settings};

/// Longest flight, seconds.
const HORIZON_S: f64 = 60.0;

/// Options of `quality`.
#[derive(Args, Debug)]
pub(crate) struct QualityArgs {
    #[command(flatten)]
    draw: DrawOptions,
    /// Limits of work, as percentages of the default one; a smaller one than the least that the
    /// avoider accepts counts as that.
    #[arg(long, value_delimiter = ',', default_values_t = [10.0, 25.0, 50.0, 100.0])]
    limits: Vec<f64>,
    /// Time constant of the bank, seconds.
    #[arg(long, default_value_t = 0.0)]
    lag: f64,
    /// Flown turn rate, as a share of the bank's ideal one.
    #[arg(long, default_value_t = 1.0)]
    factor: f64,
}

/// The work of the steps of one flight or of several.
#[derive(Debug, Clone, Copy, Default)]
struct StepCounts {
    count: u64,
    /// Steps that met their limit.
    cut: u64,
    largest: u32,
}

impl Observer for StepCounts {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let work = &moment.decision.record.work;
        self.count += 1;
        self.cut += u64::from(work.limit_met);
        self.largest = self.largest.max(work.work);
    }
}

/// One encounter at one limit.
#[derive(Debug, Clone, Copy)]
struct LimitFlight {
    is_saved: bool,
    cross_m: f64,
    steps: StepCounts,
}

/// The settings of the flights at each limit, with the limits.
fn at_limits(args: &QualityArgs, planar: bool) -> Result<Vec<(u32, BatchSettings)>, String> {
    let at = |percent: &f64| {
        let mut settings = settings(planar, PolicyChoice::default(), HORIZON_S)?;
        let share = 0.01 * percent * f64::from(Settings::default().work_limit);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast of a float saturates, and the avoider checks it"
        )]
        let limit = (share as u32).max(LEAST_WORK);
        settings.model.settings.avoider.work_limit = limit;
        settings.model.vehicle.response.bank_time_constant_s = args.lag;
        settings.model.vehicle.response.turn_rate_factor = args.factor;
        Ok((limit, settings))
    };
    args.limits.iter().map(at).collect()
}

/// Flies an encounter at each limit; also says whether it can be avoided.
fn flown(
    encounter: &Encounter,
    limits: &[(u32, BatchSettings)],
) -> Result<(bool, Vec<LimitFlight>), String> {
    let at = |(_, settings): &(u32, BatchSettings)| {
        let mut steps = StepCounts::default();
        let outcome = fly(settings, encounter, &mut steps)?;
        Ok(LimitFlight {
            is_saved: outcome.separated(),
            cross_m: outcome.max_cross_track_m,
            steps,
        })
    };
    let flown: Vec<LimitFlight> = limits.iter().map(at).collect::<Result<_, String>>()?;
    let is_avoidable = flown.iter().any(|flown| flown.is_saved)
        || limits.first().is_some_and(|(_, settings)| {
            let vehicle = OracleVehicle::from(&settings.model.vehicle);
            let obstacles = oracle_obstacles(encounter);
            let asked = OracleSettings::default();
            let answer = best_margin(&OracleStart::ORIGIN, &vehicle, &obstacles, &asked);
            answer.best_margin_m >= AVOIDABLE_MARGIN_M
        });
    Ok((is_avoidable, flown))
}

/// Prints a row for each limit, over all cells.
pub(crate) fn run(args: &QualityArgs) -> Result<(), String> {
    let mut all = Vec::new();
    let mut limits = Vec::new();
    for (_, source) in args.draw.sources()? {
        limits = at_limits(args, source.planar)?;
        let flown: Vec<(bool, Vec<LimitFlight>)> = (0..args.draw.count)
            .into_par_iter()
            .map(|number| flown(&source.encounter(number)?, &limits))
            .collect::<Result<_, _>>()?;
        all.extend(flown);
    }
    println!("work limit,avoidable,lost,saved %,median cross m,steps,steps cut,largest work");
    for (place, (limit, _)) in limits.iter().enumerate() {
        let mut avoidable = 0;
        let mut cross_m = Vec::new();
        let mut steps = StepCounts::default();
        for (is_avoidable, flown) in &all {
            let Some(flown) = flown.get(place) else {
                continue;
            };
            avoidable += usize::from(*is_avoidable);
            cross_m.extend(flown.is_saved.then_some(flown.cross_m));
            steps.count += flown.steps.count;
            steps.cut += flown.steps.cut;
            steps.largest = steps.largest.max(flown.steps.largest);
        }
        let saved = cross_m.len();
        println!(
            "{limit},{avoidable},{},{:.2},{:.2},{},{},{}",
            avoidable - saved,
            100.0 * saved as f64 / avoidable.max(1) as f64,
            median(cross_m),
            steps.count,
            steps.cut,
            steps.largest
        );
        if steps.largest > *limit {
            return Err(format!(
                "a step took {} units of work, expected at most {limit}",
                steps.largest
            ));
        }
    }
    Ok(())
}

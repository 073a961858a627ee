//! How many avoidable encounters does the policy save when nothing is ideal: noisy sight, bank lag, a turn
//! that is slower than assumed, wind? Avoidable means within the aircraft's limits.
//!
//! Each encounter is drawn for the ground speed in its wind, whose direction rotates with the encounter's
//! number. The oracle has the same limits and perfect sight. Every cause has an option, so that it can be
//! left out.

use clap::Args;
use fga::Vec3;
use fga::avoider::{Reason, State};
use fga_campaign::batch::BatchSettings;
use fga_campaign::campaign::parse_policy;
use fga_campaign::encounters::EncounterSource;
use fga_campaign::oracle::{Judge, OracleSettings};
use fga_sim::engine::{DecisionMoment, Observer, Outcome};
use fga_sim::wind::crab;
use rayon::prelude::*;

use crate::common::{self, DrawOptions, model};

/// Angle between the wind directions of successive encounters, radians: the golden angle.
const NEXT_WIND_RAD: f64 = 2.399_963_229_728_653;

/// Options of `robustness`: the imperfections.
#[derive(Args, Debug)]
pub(crate) struct RobustnessArgs {
    #[command(flatten)]
    draw: DrawOptions,
    /// Noise of the sensor, times 3 m and 0.5 m/s.
    #[arg(long, default_value_t = 1.0)]
    noise: f64,
    /// Wind, metres per second.
    #[arg(long, default_value_t = 8.0)]
    wind: f64,
    /// Time constant of the bank, seconds.
    #[arg(long, default_value_t = 0.6)]
    lag: f64,
    /// Flown turn rate, as a share of the bank's ideal one.
    #[arg(long, default_value_t = 0.74)]
    factor: f64,
    /// Standard deviations within the margin.
    #[arg(long, default_value_t = 3.0)]
    sigmas: f64,
    /// Margin kept, metres.
    #[arg(long, default_value_t = 0.05)]
    margin: f64,
    /// The policy, as in "turn-aware --start latest".
    #[arg(long, default_value = "turn-aware")]
    policy: String,
    /// Fly only the encounter with this number.
    #[arg(long)]
    only: Option<u64>,
    /// Print the changes of state in lost encounters.
    #[arg(long)]
    verbose: bool,
}

impl RobustnessArgs {
    /// The aircraft with its wind for an encounter.
    fn settings(&self, planar: bool, number: u64, seed: u64) -> Result<BatchSettings, String> {
        let mut model = model(planar)?;
        model.vehicle.response.bank_time_constant_s = self.lag;
        model.vehicle.response.turn_rate_factor = self.factor;
        model.settings.avoider.confidence_sigmas = self.sigmas;
        model.settings.avoider.margin_m = self.margin;
        model.sensor.position_sigma_m = 3.0 * self.noise;
        model.sensor.velocity_sigma_mps = 0.5 * self.noise;
        let (sin, cos) = libm::sincos(number as f64 * NEXT_WIND_RAD);
        model.wind_mps = Vec3::new(cos, sin, 0.0) * self.wind;
        Ok(BatchSettings {
            seed,
            ..BatchSettings::of(model, parse_policy(&self.policy)?)
        })
    }
}

/// States and reasons at each change, and the number of decisions with each reason.
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

/// The result of an encounter.
struct RobustFlight {
    number: u64,
    outcome: Outcome,
    oracle_m: f64,
    story: Story,
}

fn fly(
    source: &EncounterSource,
    conditions: &RobustnessArgs,
    number: u64,
) -> Result<RobustFlight, String> {
    let settings = conditions.settings(source.planar, number, source.seed)?;
    let model = &settings.model;
    let (course_rad, climb_rad) = crab(Vec3::X, model.vehicle.airspeed_mps, model.wind_mps)
        .ok_or("the wind is too strong to hold the line")?;
    let heading = fga::angle::direction(course_rad, climb_rad) * model.vehicle.airspeed_mps;
    let drawn = EncounterSource {
        airspeed_mps: (heading + model.wind_mps).x,
        ..*source
    };
    let encounter = drawn.encounter(number)?;
    let mut story = Story::default();
    let outcome = common::fly(&settings, &encounter, &mut story)?;
    let oracle_m = if outcome.separated() {
        // Saved is saved: only losses need the oracle.
        f64::INFINITY
    } else {
        let judge = Judge::new(model, OracleSettings::default().horizon_s)?;
        judge.until(1.0).best_margin_m(&encounter)
    };
    Ok(RobustFlight {
        number,
        outcome,
        oracle_m,
        story,
    })
}

/// Prints a row for each cell, and each encounter that is lost although the oracle saves it.
pub(crate) fn run(args: &RobustnessArgs) -> Result<(), String> {
    println!("cell,saved,lost,not avoidable,share saved %");
    let (mut all_saved, mut all_lost) = (0, 0);
    for (cell, source) in &args.draw.sources()? {
        let flown: Vec<RobustFlight> = (0..args.draw.count)
            .into_par_iter()
            .filter(|n| args.only.is_none_or(|only| only == *n))
            .map(|n| fly(source, args, n))
            .collect::<Result<_, _>>()?;
        let saved = flown.iter().filter(|f| f.outcome.separated()).count();
        let is_lost = |f: &&RobustFlight| !f.outcome.separated() && f.oracle_m >= 0.1;
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
            if args.verbose {
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

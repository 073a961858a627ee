//! Does every aircraft return to its mission once nothing is near?
//!
//! Drawn flights of five families: fleets in which every aircraft flies fga, traffic whose tracks end, conflicts at corners and
//! at the mission's end, masts; wind up to 0.9 of the airspeed, bank lag and dead time up to 1 s. The judge is [`flier`]: it looks
//! at positions and at the word of the state, and shares no code with the decisions.

pub(crate) mod airspaces;
mod draw;
mod flier;
mod fly;
pub(crate) mod traps;

use clap::Args;
use rayon::prelude::*;

use self::draw::{FAMILIES, ReturnFlight};
use self::flier::STUCK_S;
use crate::common::DrawnArgs;

/// Options of `returns`.
#[derive(Args, Debug)]
pub(crate) struct ReturnsArgs {
    #[command(flatten)]
    drawn: DrawnArgs,
    /// Fly only the flight with this number, and print its aircraft twice a minute.
    #[arg(long)]
    only: Option<u64>,
}

/// What went wrong in flights of a family.
#[derive(Debug, Default, Clone)]
struct ReturnCount {
    flights: usize,
    aircraft: usize,
    stuck: Vec<u64>,
    longest_s: f64,
    strayed: Vec<u64>,
    open: Vec<u64>,
    end_missed: Vec<u64>,
    /// Those whose last waypoint an obstacle near it kept them from.
    kept_off: Vec<u64>,
    low: Vec<u64>,
    entered: usize,
    given_up: usize,
}

impl ReturnCount {
    fn and(mut self, other: Self) -> Self {
        self.flights += other.flights;
        self.aircraft += other.aircraft;
        self.longest_s = self.longest_s.max(other.longest_s);
        self.entered += other.entered;
        self.given_up += other.given_up;
        self.stuck.extend(other.stuck);
        self.strayed.extend(other.strayed);
        self.open.extend(other.open);
        self.end_missed.extend(other.end_missed);
        self.kept_off.extend(other.kept_off);
        self.low.extend(other.low);
        self
    }

    fn row(&self, family: &str) -> String {
        let named = |numbers: &[u64]| {
            let first: Vec<String> = numbers.iter().take(4).map(u64::to_string).collect();
            format!("{} [{}]", numbers.len(), first.join(" "))
        };
        format!(
            "{family}: {} flights, {} aircraft; avoiding with nothing near more than {STUCK_S} s: {} (longest {:.1} s); strayed: {}; \
             mission not ended: {}; last waypoint missed: {}, kept off it: {}; below the floor: {}; {} entered a volume; {} waypoints given up",
            self.flights,
            self.aircraft,
            named(&self.stuck),
            self.longest_s,
            named(&self.strayed),
            named(&self.open),
            named(&self.end_missed),
            named(&self.kept_off),
            named(&self.low),
            self.entered,
            self.given_up,
        )
    }
}

fn counted(count: u64, seed: u64) -> Vec<ReturnCount> {
    (0..FAMILIES.len() as u64)
        .map(|family| {
            (0..count)
                .into_par_iter()
                .filter(|number| number % FAMILIES.len() as u64 == family)
                .map(|number| ReturnFlight::drawn(seed, number).fly(number, false))
                .reduce(ReturnCount::default, ReturnCount::and)
        })
        .collect()
}

/// Runs the experiment.
pub(crate) fn run(args: &ReturnsArgs) {
    if let Some(number) = args.only {
        println!(
            "{}",
            ReturnFlight::drawn(args.drawn.seed, number)
                .fly(number, true)
                .row("this")
        );
        return;
    }
    for (count, family) in counted(args.drawn.count, args.drawn.seed)
        .iter()
        .zip(FAMILIES)
    {
        println!("{}", count.row(family));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn d1_with_nothing_near_every_aircraft_returns() {
        for (count, family) in counted(500, 1).iter().zip(FAMILIES) {
            let faults = [
                &count.stuck,
                &count.strayed,
                &count.open,
                &count.end_missed,
                &count.kept_off,
                &count.low,
            ];
            assert!(
                faults.iter().all(|numbers| numbers.is_empty()),
                "{}",
                count.row(family)
            );
        }
    }
    /// Flights that once came back before the same mast for ever, ended beside or above their last waypoint, avoided with nothing near for
    /// half a minute, or flew away.
    #[test]
    fn d1_flights_that_once_did_not_end_are_flown() {
        for (seed, number) in [
            (102, 614),
            (103, 2174),
            (104, 374),
            (101, 1031),
            (101, 1414),
            (106, 1753),
            (107, 804),
            (105, 3924),
            (108, 4624),
            (108, 4902),
            (111, 110),
            (111, 3637),
            (112, 590),
            (112, 1598),
            (112, 4762),
            (112, 3797),
            (114, 3302),
            (114, 1173),
            (114, 4098),
            (116, 4022),
            (116, 4318),
            (116, 694),
            (117, 3086),
            (117, 4906),
            (402, 68),
            (510, 9240),
        ] {
            let count = ReturnFlight::drawn(seed, number).fly(number, false);
            let faults = [
                &count.stuck,
                &count.strayed,
                &count.open,
                &count.end_missed,
                &count.kept_off,
            ];
            let is_flown = faults.iter().all(|numbers| numbers.is_empty());
            assert!(is_flown, "seed {seed}, {}", count.row("flight"));
        }
    }
}

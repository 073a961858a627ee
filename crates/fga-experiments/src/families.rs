//! Encounters that are hard in ways of their own: strong wind, slow traffic alongside, formations, gaps that close,
//! traffic that arrives together, a corridor. Is the aircraft kept clear where the oracle is, and is it back in time?
//!
//! The aircraft of Table 4 flies at one altitude; every obstacle keeps its velocity. "Kept clear" comes from the
//! engine's separation over continuous time.

use clap::{Args, ValueEnum};
use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_campaign::batch::BatchSettings;
use fga_campaign::encounters::{Random, Range};
use fga_campaign::oracle::{AVOIDABLE_MARGIN_M, Judge};
use fga_formats::encounters::Encounter;
use fga_sim::engine::{DecisionMoment, Observer, Outcome};
use fga_sim::wind::crab;
use rayon::prelude::*;

use crate::common::{self, model};

/// Radius of every protected sphere, metres.
const RADIUS_M: f64 = 30.0;

/// Horizon of the oracle, seconds.
const ORACLE_S: f64 = 60.0;

/// Options of `families`.
#[derive(Args, Debug)]
pub(crate) struct FamiliesArgs {
    /// Number of encounters of each family.
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Fly only this family.
    #[arg(long)]
    only: Option<DrawnFamily>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DrawnFamily {
    /// One sphere at rest ahead, wind of 30 to 80 % of the airspeed from any side.
    Wind,
    /// One to three aircraft ahead on nearly the same course at 30 to 95 % of the airspeed.
    Slow,
    /// Three to eight aircraft with one velocity, near that of the aircraft, around it.
    Formation,
    /// Two rows that close from both sides.
    Squeeze,
    /// Three to five fast ones that arrive together.
    Pincer,
    /// Two walls of spheres along the mission, and one aircraft that comes between them.
    Corridor,
}

impl DrawnFamily {
    const ALL: [Self; 6] = [
        Self::Wind,
        Self::Slow,
        Self::Formation,
        Self::Squeeze,
        Self::Pincer,
        Self::Corridor,
    ];

    /// Time in which the aircraft is to be back, seconds.
    const fn back_within_s(self) -> f64 {
        match self {
            Self::Wind => 400.0,
            _ => 420.0,
        }
    }

    fn wind_mps(self, airspeed_mps: f64, random: &mut Random) -> Vec3 {
        match self {
            Self::Wind => level(
                any_course_rad(random),
                airspeed_mps * within(random, 0.3, 0.8),
            ),
            _ => Vec3::ZERO,
        }
    }

    /// The obstacles; `along_mps` is the speed of the aircraft over the ground on its mission.
    fn draw(self, along_mps: f64, random: &mut Random) -> Vec<(Vec3, Vec3)> {
        let mut all = Vec::new();
        match self {
            Self::Wind => {
                let ahead_m = (along_mps * within(random, 15.0, 40.0)).max(2.0 * RADIUS_M);
                let aside_m = within(random, -0.8, 0.8) * RADIUS_M;
                all.push((Vec3::new(ahead_m, aside_m, 0.0), Vec3::ZERO));
            }
            Self::Slow => {
                for _ in 0..random.count(1, 3) {
                    let place_m = Vec3::new(
                        within(random, 70.0, 300.0),
                        within(random, -40.0, 40.0),
                        0.0,
                    );
                    let speed_mps = along_mps * within(random, 0.3, 0.95);
                    all.push((place_m, level(within(random, -0.1, 0.1), speed_mps)));
                }
            }
            Self::Formation => {
                let course_rad = within(random, -0.5, 0.5);
                let velocity_mps = level(course_rad, along_mps * within(random, 0.7, 1.3));
                for _ in 0..random.count(3, 8) {
                    let distance_m = within(random, 60.0, 250.0);
                    all.push((level(any_course_rad(random), distance_m), velocity_mps));
                }
            }
            Self::Squeeze => {
                let meets_s = within(random, 10.0, 25.0);
                for side in [-1.0, 1.0] {
                    let closes_mps = within(random, 3.0, 12.0);
                    for _ in 0..random.count(1, 3) {
                        let ahead_m = along_mps * (meets_s + within(random, -6.0, 6.0));
                        let gap_m = within(random, 5.0, 45.0);
                        let aside_m = side * (gap_m + closes_mps * meets_s);
                        let velocity_mps =
                            Vec3::new(within(random, -3.0, 3.0), -side * closes_mps, 0.0);
                        all.push((Vec3::new(ahead_m, aside_m, 0.0), velocity_mps));
                    }
                }
            }
            Self::Pincer => {
                let meets_s = within(random, 8.0, 20.0);
                for _ in 0..random.count(3, 5) {
                    let velocity_mps = level(any_course_rad(random), within(random, 20.0, 50.0));
                    let miss_m = Vec3::new(
                        within(random, -25.0, 25.0),
                        within(random, -25.0, 25.0),
                        0.0,
                    );
                    let meets_m = Vec3::X * (along_mps * meets_s) + miss_m;
                    all.push((meets_m - velocity_mps * meets_s, velocity_mps));
                }
            }
            Self::Corridor => {
                let half_m = RADIUS_M + within(random, 35.0, 90.0);
                for side in [-1.0, 1.0] {
                    for k in 0..8 {
                        let ahead_m = 120.0 + 55.0 * f64::from(k);
                        all.push((Vec3::new(ahead_m, side * half_m, 0.0), Vec3::ZERO));
                    }
                }
                let place_m = Vec3::new(
                    within(random, 350.0, 900.0),
                    within(random, -25.0, 25.0),
                    0.0,
                );
                all.push((place_m, Vec3::new(-within(random, 5.0, 25.0), 0.0, 0.0)));
            }
        }
        // Nobody begins inside a volume.
        all.retain(|(place_m, _)| place_m.length() > 1.2 * RADIUS_M);
        all
    }
}

fn within(random: &mut Random, low: f64, high: f64) -> f64 {
    random.within(Range(low, high))
}

/// Any course, radians.
fn any_course_rad(random: &mut Random) -> f64 {
    within(random, -core::f64::consts::PI, core::f64::consts::PI)
}

fn level(course_rad: f64, length: f64) -> Vec3 {
    let (sin, cos) = libm::sincos(course_rad);
    Vec3::new(cos, sin, 0.0) * length
}

/// The result of an encounter.
struct FamilyFlight {
    number: u64,
    outcome: Outcome,
    /// Where it was entered or the aircraft was not back: the oracle's margin, metres.
    oracle_m: Option<f64>,
    is_back: bool,
    /// Where the flight ended during a manoeuvre and went on: when that began, and when the aircraft was back, seconds.
    late: Option<LastManeuver>,
}

/// The last manoeuvre that began by some time.
#[derive(Debug, Clone, Copy)]
struct LastManeuver {
    by_s: f64,
    is_open: bool,
    began_s: f64,
    back_s: Option<f64>,
}

impl Observer for LastManeuver {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let time_s = moment.time_s;
        let is_open = moment.decision.state.is_away();
        if is_open && !self.is_open && time_s < self.by_s {
            (self.began_s, self.back_s) = (time_s, None);
        } else if !is_open && self.is_open {
            self.back_s.get_or_insert(time_s);
        }
        self.is_open = is_open;
    }
}

fn fly(family: DrawnFamily, number: u64, seed: u64) -> Result<FamilyFlight, String> {
    let mut random = Random::new(seed ^ ((family as u64) << 32), number);
    let mut model = model(true)?;
    let airspeed_mps = model.vehicle.airspeed_mps;
    model.wind_mps = family.wind_mps(airspeed_mps, &mut random);
    let (course_rad, climb_rad) = crab(Vec3::X, airspeed_mps, model.wind_mps)
        .ok_or("the wind is too strong to hold the line")?;
    let over_ground_mps =
        fga::angle::direction(course_rad, climb_rad) * airspeed_mps + model.wind_mps;
    let drawn = family.draw(over_ground_mps.x, &mut random);
    let obstacles = drawn.into_iter().zip(0..);
    let encounter = Encounter {
        id: number,
        obstacles: obstacles
            .map(|((position_m, velocity_mps), id)| {
                let volume = ProtectedVolume::Sphere { radius_m: RADIUS_M };
                Obstacle::straight(id, position_m, velocity_mps, volume)
            })
            .collect(),
    };
    let settings = BatchSettings {
        model,
        ..common::settings(
            true,
            fga_sim::policy::PolicyChoice::default(),
            family.back_within_s(),
        )?
    };
    let outcome = common::fly(&settings, &encounter, &mut ())?;
    let is_back = outcome.start_s.is_none() || outcome.rejoined_s.is_some();
    let mut late = None;
    if !is_back {
        let mut last = LastManeuver {
            by_s: settings.horizon_s,
            is_open: false,
            began_s: 0.0,
            back_s: None,
        };
        let longer = BatchSettings {
            horizon_s: 2.0 * settings.horizon_s,
            ..settings.clone()
        };
        common::fly(&longer, &encounter, &mut last)?;
        late = Some(last);
    }
    let judge = Judge::new(&settings.model, ORACLE_S)?.until(1.0);
    let oracle_m = (!outcome.separated() || !is_back).then(|| judge.best_margin_m(&encounter));
    Ok(FamilyFlight {
        number,
        outcome,
        oracle_m,
        is_back,
        late,
    })
}

/// Flies some encounters of a family on all cores.
fn fly_all(family: DrawnFamily, count: u64, seed: u64) -> Result<Vec<FamilyFlight>, String> {
    (0..count)
        .into_par_iter()
        .map(|number| fly(family, number, seed))
        .collect()
}

/// Flies the families and shows a row for each, and each encounter that went wrong although the oracle saves it.
pub(crate) fn run(args: &FamiliesArgs) -> Result<(), String> {
    println!(
        "family,flown,acted,entered,lost although avoidable,not back in time,time back median s,most s"
    );
    let mut wrong = 0;
    for family in DrawnFamily::ALL {
        if args.only.is_some_and(|only| only != family) {
            continue;
        }
        let flown = fly_all(family, args.count, args.seed)?;
        let entered = flown.iter().filter(|f| !f.outcome.separated());
        let avoidable = |f: &&FamilyFlight| f.oracle_m.is_some_and(|m| m >= AVOIDABLE_MARGIN_M);
        let lost: Vec<&FamilyFlight> = entered.clone().filter(avoidable).collect();
        let late: Vec<&FamilyFlight> = flown
            .iter()
            .filter(|f| f.outcome.separated() && !f.is_back)
            .collect();
        let mut back_s: Vec<f64> = flown.iter().filter_map(|f| f.outcome.rejoined_s).collect();
        back_s.sort_by(f64::total_cmp);
        println!(
            "{family:?},{},{},{},{},{},{:.0},{:.0}",
            flown.len(),
            flown.iter().filter(|f| f.outcome.start_s.is_some()).count(),
            entered.count(),
            lost.len(),
            late.len(),
            back_s.get(back_s.len() / 2).copied().unwrap_or(f64::NAN),
            back_s.last().copied().unwrap_or(f64::NAN)
        );
        for f in lost.iter().chain(&late) {
            let back = f.late.map_or_else(
                || "back in time".to_owned(),
                |late| {
                    let back = late.back_s.map(|back_s| format!("back at {back_s:.0} s"));
                    let back = back.unwrap_or_else(|| "never back".to_owned());
                    format!("last manoeuvre from {:.0} s, {back}", late.began_s)
                },
            );
            let (margin_m, oracle_m) = (f.outcome.min_margin_m, f.oracle_m.unwrap_or(f64::NAN));
            println!(
                "  {}: {margin_m:.2} m, oracle {oracle_m:.2} m, {back}",
                f.number
            );
        }
        wrong += lost.len() + late.len();
    }
    println!("all: {wrong} lost although avoidable or not back in time");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Earlier versions came back before the same obstacle again and again: 1 of 30 in strong wind, 1 of 200 beside
    /// slow traffic. Those that begin to avoid just before the end may be late, but are back within half a minute or so.
    #[test]
    fn the_aircraft_is_kept_clear_and_back_in_time() {
        for family in DrawnFamily::ALL {
            let flown = fly_all(family, 300, 3).unwrap();
            let numbers = |wrong: fn(&FamilyFlight) -> bool| -> Vec<u64> {
                let wrong = flown.iter().filter(|f| wrong(f));
                wrong.map(|f| f.number).collect()
            };
            let lost = numbers(|f| {
                !f.outcome.separated() && f.oracle_m.is_some_and(|m| m >= AVOIDABLE_MARGIN_M)
            });
            assert!(lost.is_empty(), "{family:?} lost {lost:?}");
            let late = numbers(|f| f.outcome.separated() && !f.is_back);
            let few = match family {
                DrawnFamily::Slow | DrawnFamily::Formation => 2,
                _ => 0,
            };
            assert!(late.len() <= few, "{family:?} late {late:?}");
        }
    }

    /// Earlier versions flew along inside these formations for ever: no way back of one short detour leads around all of one.
    #[test]
    fn the_aircraft_leaves_a_formation_that_surrounds_it() {
        for number in [7484, 7862, 8044] {
            let flown = fly(DrawnFamily::Formation, number, 5).unwrap();
            assert!(flown.outcome.separated(), "{number}");
            assert!(flown.is_back, "{number}");
        }
    }
}

//! Climbing from a manoeuvre to one nearby with a larger margin.

use crate::limit::Limit as _;
use crate::maneuver::{Certificate, certify};

use super::{ENOUGH_M, Found, MAX_TURN_RAD, Search, SecondTurn, Turns};

/// Parameters of a manoeuvre: wait s, turn rad, climb rad, after s, turn rad, climb rad.
const PARAMETERS: usize = 6;

/// Natural steps of the parameters.
const SCALES: [f64; PARAMETERS] = [0.4, 0.2, 0.1, 0.4, 0.2, 0.1];

/// Obstacles that a step takes into account: the closest ones.
const CLOSEST: usize = 12;

/// Obstacles farther than the closest one by this do not matter to a climb, metres.
const NEAR_M: f64 = 60.0;

/// Most steps.
const STEPS: u32 = 24;

/// Step of the differences, in units of [`SCALES`].
const DIFFERENCE: f64 = 2e-3;

/// Rounds of the linear program.
const ROUNDS: u32 = 80;

/// The box of a step is never smaller than this, in units of [`SCALES`].
const SMALLEST_BOX: f64 = 4e-3;

type Vector = [f64; PARAMETERS];

/// The margins of the closest obstacles, and the least of all.
#[derive(Clone, Copy)]
struct Margins {
    of: [f64; CLOSEST],
    least_m: f64,
}

/// A climb under way.
pub(super) struct Ascent {
    best: Found,
    at: Vector,
    /// Places of the closest obstacles.
    closest: [usize; CLOSEST],
    count: usize,
    used: usize,
}

impl Ascent {
    pub(super) fn new(seed: Found) -> Self {
        let used = if seed.turns.second.is_some() {
            PARAMETERS
        } else {
            3
        };
        let at = to_vector(&seed.turns);
        Self {
            best: seed,
            at,
            closest: [0; CLOSEST],
            count: 0,
            used,
        }
    }

    /// Climbs until it is certified, no longer gets higher, or the work limit is met.
    pub(super) fn run(mut self, search: &mut Search<'_>) -> Found {
        self.find_closest(search);
        let Some(mut margins) = self.margins(search, &self.at) else {
            return self.best;
        };
        let mut size = 1.0;
        for _ in 0..STEPS {
            if margins.least_m >= search.scene.target_m || search.limit_met() {
                break;
            }
            let slopes = self.slopes(search, &margins);
            let mut improved = false;
            while size > SMALLEST_BOX {
                let step = self.best_step(&margins, &slopes, size);
                let mut tried = self.at;
                for ((x, step), scale) in tried.iter_mut().zip(step).zip(SCALES) {
                    *x += step * scale;
                }
                let tried = within(tried, search.scene.climb_limits_rad);
                match self.margins(search, &tried) {
                    Some(there) if there.least_m > margins.least_m + 1e-4 => {
                        (self.at, margins) = (tried, there);
                        improved = true;
                        size = (1.6 * size).min(2.0);
                        break;
                    }
                    _ => size *= 0.4,
                }
            }
            if !improved {
                break;
            }
        }
        let turns = self.turns(&self.at);
        let departure = search.departure(turns.wait_s);
        let certificate = search.certify(&turns, &departure, f64::MIN);
        if certificate.margin_m > self.best.margin_m {
            let cost = search.cost(&turns, &departure);
            self.best = Found {
                turns,
                margin_m: certificate.margin_m,
                cost,
            };
        }
        self.best
    }

    fn turns(&self, at: &Vector) -> Turns {
        let [
            wait_s,
            turn_rad,
            climb_rad,
            after_s,
            second_turn,
            second_climb,
        ] = *at;
        let second = (self.used == PARAMETERS).then_some(SecondTurn {
            after_s,
            turn_rad: second_turn,
            climb_rad: second_climb,
        });
        Turns {
            wait_s,
            turn_rad,
            climb_rad,
            second,
        }
    }

    /// Notes the obstacles that come closest on the seed's path.
    fn find_closest(&mut self, search: &mut Search<'_>) {
        let turns = self.turns(&self.at);
        predict(search, &turns);
        let scene = search.scene;
        let mut margins = [f64::INFINITY; CLOSEST];
        for (place, hazard) in scene.hazards.iter().enumerate() {
            let one = certify(
                scene.flyer,
                search.path,
                hazard,
                scene.horizon_s,
                f64::MIN,
                ENOUGH_M,
            );
            // Insertion into the short sorted list.
            let mut entry = (one.margin_m, place);
            for (margin, closest) in margins.iter_mut().zip(&mut self.closest) {
                if entry.0 < *margin {
                    core::mem::swap(margin, &mut entry.0);
                    core::mem::swap(closest, &mut entry.1);
                }
            }
        }
        let [least_m, ..] = margins;
        let near = margins
            .iter()
            .filter(|margin| **margin < least_m + NEAR_M)
            .count();
        self.count = scene.hazards.len().min(near);
        search.work = search
            .work
            .saturating_add(work_of(search, scene.hazards.len()));
    }

    /// Margins of the closest obstacles; `None` where the path cannot be predicted to its end.
    fn margins(&self, search: &mut Search<'_>, at: &Vector) -> Option<Margins> {
        search.evaluated += 1;
        let turns = self.turns(at);
        predict(search, &turns);
        if !search.path.is_complete() {
            return None;
        }
        let scene = search.scene;
        let mut margins = Margins {
            of: [f64::INFINITY; CLOSEST],
            least_m: ENOUGH_M,
        };
        let places = self.closest.iter().take(self.count);
        for (margin, place) in margins.of.iter_mut().zip(places) {
            let Some(hazard) = scene.hazards.get(*place) else {
                continue;
            };
            let one: Certificate = certify(
                scene.flyer,
                search.path,
                hazard,
                scene.horizon_s,
                f64::MIN,
                ENOUGH_M,
            );
            *margin = one.margin_m;
            margins.least_m = margins.least_m.min(one.margin_m);
        }
        search.work = search.work.saturating_add(work_of(search, self.count));
        Some(margins)
    }

    /// How each margin changes with each parameter, per unit of [`SCALES`].
    fn slopes(&self, search: &mut Search<'_>, here: &Margins) -> [Vector; CLOSEST] {
        let mut slopes = [[0.0; PARAMETERS]; CLOSEST];
        for parameter in 0..self.used {
            let mut moved = self.at;
            let scale = SCALES.get(parameter).copied().unwrap_or(1.0);
            let Some(x) = moved.get_mut(parameter) else {
                continue;
            };
            // Away from a limit that it stands at.
            let (_, high) = search.scene.climb_limits_rad;
            let is_climb = parameter == 2 || parameter == 5;
            let sign = if is_climb && *x + DIFFERENCE * scale > high {
                -1.0
            } else {
                1.0
            };
            *x += sign * DIFFERENCE * scale;
            let Some(there) = self.margins(search, &moved) else {
                continue;
            };
            for ((slope, there), here) in slopes.iter_mut().zip(there.of).zip(here.of) {
                if let Some(slope) = slope.get_mut(parameter)
                    && there.is_finite()
                {
                    *slope = sign * (there - here) / DIFFERENCE;
                }
            }
        }
        slopes
    }

    /// The step within the box ±`size` that lifts the least margin most, to first order: the
    /// linear program max t, mᵢ + sᵢ·d ≥ t, |dⱼ| ≤ size, by averaged subgradients.
    fn best_step(&self, here: &Margins, slopes: &[Vector; CLOSEST], size: f64) -> Vector {
        let mut step = [0.0; PARAMETERS];
        let mut best = (here.least_m, step);
        for round in 1..=ROUNDS {
            let mut least: Option<(f64, &Vector)> = None;
            for (margin, slope) in here.of.iter().zip(slopes).take(self.count) {
                let lifted = margin + dot(slope, &step);
                if least.is_none_or(|(known, _)| lifted < known) {
                    least = Some((lifted, slope));
                }
            }
            let Some((lifted, slope)) = least else { break };
            if lifted > best.0 {
                best = (lifted, step);
            }
            let norm = libm::sqrt(dot(slope, slope));
            if norm <= 0.0 {
                break;
            }
            let pace = 1.5 * size / (norm * libm::sqrt(f64::from(round)));
            for (x, slope) in step.iter_mut().zip(slope) {
                *x = (*x + pace * slope).limited(-size, size);
            }
        }
        best.1
    }
}

/// Predicts a manoeuvre into the search's path.
fn predict(search: &mut Search<'_>, turns: &Turns) {
    let departure = search.departure(turns.wait_s);
    let maneuver = search.maneuver(turns, &departure);
    let scene = search.scene;
    search
        .path
        .predict(scene.flyer, &scene.start, &maneuver, scene.horizon_s);
}

/// Line tests of certifying the path against some obstacles.
fn work_of(search: &Search<'_>, obstacles: usize) -> u32 {
    let tests = 2 * search.path.nodes().len() * obstacles;
    u32::try_from(tests)
        .unwrap_or(u32::MAX)
        .saturating_add(super::PREDICTION_WORK)
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The parameters within their limits.
fn within(at: Vector, (low, high): (f64, f64)) -> Vector {
    let [wait_s, turn, climb, after_s, second_turn, second_climb] = at;
    [
        wait_s.max(0.0),
        turn.limited(-MAX_TURN_RAD, MAX_TURN_RAD),
        climb.limited(low, high),
        after_s.max(0.0),
        second_turn.limited(-MAX_TURN_RAD, MAX_TURN_RAD),
        second_climb.limited(low, high),
    ]
}

fn to_vector(turns: &Turns) -> Vector {
    let second = turns.second.unwrap_or(SecondTurn {
        after_s: 0.0,
        turn_rad: 0.0,
        climb_rad: 0.0,
    });
    [
        turns.wait_s,
        turns.turn_rad,
        turns.climb_rad,
        second.after_s,
        second.turn_rad,
        second.climb_rad,
    ]
}

//! The yardstick: an aircraft with the same limits that learns each turn and its end when the turn begins,
//! and flies the manoeuvre with the largest margin.

use fga::Vec3;

use super::flight::Own;
use super::setting::{RADIUS_M, VEHICLE};
use super::traffic::Intruder;

/// Horizon, seconds.
const AHEAD_S: f64 = 40.0;

/// Rows of 50 ms between two checks of the distance along a manoeuvre.
const EVERY: usize = 4;

/// A larger margin is no better than this, metres.
const ENOUGH_M: f64 = 60.0;

/// Turn, fly straight, turn again; climb angles of both turns.
#[derive(Debug, Clone, Copy)]
struct TwoTurns {
    first: (f64, f64),
    straight_s: f64,
    second: (f64, f64),
}

impl TwoTurns {
    /// Margin of the rest of the manoeuvre from a state, with the positions of the intruders.
    fn margin_m(&self, own: &Own, places_m: &[Vec<Vec3>], enough_m: f64) -> f64 {
        let step_s = EVERY as f64 * 0.05;
        let mut state = *own;
        let turn_radps = VEHICLE.airspeed_mps / VEHICLE.turn_radius_m;
        let course_rad = own.course_rad + self.first.0;
        let turns_s = self.first.0.abs() / turn_radps + self.straight_s;
        let mut least_m = f64::INFINITY;
        for row in 0..places_m.first().map_or(0, Vec::len) {
            for intruder in places_m {
                least_m = least_m.min(state.position_m.distance(intruder[row]) - RADIUS_M);
            }
            if least_m < enough_m {
                return least_m;
            }
            let is_first = row as f64 * step_s < turns_s;
            let (course_rad, climb_rad) = if is_first {
                (course_rad, self.first.1)
            } else {
                (course_rad + self.second.0, self.second.1)
            };
            state.fly(course_rad, climb_rad, step_s, Vec3::ZERO);
        }
        least_m.min(ENOUGH_M)
    }

    fn all() -> Vec<Self> {
        let mut ways = Vec::new();
        let climbs = [0.0, VEHICLE.climb_max_rad, VEHICLE.climb_min_rad];
        for climb_rad in climbs {
            for twelfth in -12..=12 {
                let turn_rad = f64::from(twelfth) * core::f64::consts::FRAC_PI_8;
                let one = Self {
                    first: (turn_rad, climb_rad),
                    straight_s: 0.0,
                    second: (0.0, climb_rad),
                };
                ways.push(one);
                for straight_s in [1.0, 3.0, 7.0] {
                    for quarter in [-4, -2, -1, 1, 2, 4] {
                        let turn_rad = f64::from(quarter) * core::f64::consts::FRAC_PI_4;
                        ways.push(Self {
                            straight_s,
                            second: (turn_rad, climb_rad),
                            ..one
                        });
                    }
                }
            }
        }
        ways
    }
}

/// The margin that it keeps from intruders whose whole flight the judge knows.
pub(crate) fn margin_m(intruders: &[Intruder], horizon_s: f64) -> f64 {
    let mut news_s: Vec<f64> = intruders.iter().flat_map(Intruder::changes_s).collect();
    news_s.push(0.0);
    if intruders.iter().any(|intruder| !intruder.pieces.is_empty()) {
        // It also decides again each second.
        news_s.extend((1..horizon_s as u32).map(f64::from));
    }
    news_s.retain(|time_s| *time_s < horizon_s);
    for time_s in &mut news_s {
        *time_s = (*time_s / 0.2).ceil() * 0.2;
    }
    news_s.sort_by(f64::total_cmp);
    news_s.dedup();
    news_s.push(horizon_s);
    let ways = TwoTurns::all();
    let mut own = Own::START;
    let mut least_m = f64::INFINITY;
    for pair in news_s.windows(2) {
        let (now_s, until_s) = (pair[0], pair[1]);
        let places_m: Vec<Vec<Vec3>> = intruders
            .iter()
            .map(|intruder| intruder.expected_m(now_s, AHEAD_S, EVERY))
            .collect();
        let mut best: Option<(f64, &TwoTurns)> = None;
        for way in &ways {
            let floor_m = best.map_or(f64::MIN, |best| best.0);
            let margin_m = way.margin_m(&own, &places_m, floor_m);
            if margin_m > floor_m {
                best = Some((margin_m, way));
            }
        }
        let Some((_, way)) = best else { return least_m };
        let turn_radps = VEHICLE.airspeed_mps / VEHICLE.turn_radius_m;
        let course_rad = own.course_rad + way.first.0;
        let turns_s = way.first.0.abs() / turn_radps + way.straight_s;
        let mut at_s = now_s;
        while at_s < until_s - 1e-9 {
            let step_s = (until_s - at_s).min(0.05);
            let (course_rad, climb_rad) = if at_s - now_s < turns_s {
                (course_rad, way.first.1)
            } else {
                (course_rad + way.second.0, way.second.1)
            };
            own.fly(course_rad, climb_rad, step_s, Vec3::ZERO);
            at_s += step_s;
            for intruder in intruders {
                let (position_m, _) = intruder.at(at_s);
                least_m = least_m.min(own.position_m.distance(position_m) - RADIUS_M);
            }
        }
        if least_m < 0.0 {
            return least_m;
        }
    }
    least_m
}

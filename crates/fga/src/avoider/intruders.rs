//! The possible next motions of aircraft, as hazards.
//!
//! The expected motion of an aircraft is straight and, if it turns, along its turn for some
//! time. It may also turn to either side and change its climb, within its bounds. Each of these
//! motions is a chain of hazards, each with a window of time: chords of the turn, widened by the
//! turn's bow, then a straight line. A change of climb stretches the volume upwards and
//! downwards. A climb may also end at any moment: the volume is stretched over all heights between
//! that of an aircraft that levels off at once and that of one that goes on. All of it may have
//! begun when the aircraft was last reported.

use crate::Vec3;
use crate::angle::wrap_pi;
use crate::assumptions::{Changes, SPEED_CHANGES_S, Turn};
use crate::certificate::Hazard;
use crate::limit::Limit as _;
use crate::situation::{MovementBounds, Obstacle};

/// Expected duration of an aircraft's present turn, seconds.
const TURNS_ON_S: f64 = 10.0;

/// Smaller turn rates count as straight flight, radians per second (0.5°/s).
const STRAIGHT_RADPS: f64 = 0.009;

/// Distance kept beyond the volumes of an aircraft at least, for errors of its track and of our own
/// flight, metres; the margin of a search counts towards it.
const TRACKING_M: f64 = 5.0;

/// A way back withstands an aircraft for the time of its turn, at most this, seconds: 60° at the standard rate take as long.
pub(super) const BACK_WITHSTANDS_S: f64 = 20.0;

/// Averaging time of a turn rate, seconds.
const TURN_AVERAGED_S: f64 = 1.5;

/// Averaging time of a climb, seconds.
const CLIMB_AVERAGED_S: f64 = 3.0;

/// The present climb is expected to become steeper by this multiple of what it has added to the average climb. `fga-experiments climbs 300`
/// and the recordings chose it.
const CLIMB_GOES_ON: f64 = 1.5;

/// A share of turns comes with this many times as much of the change of climb, at most all of it.
/// `fga-experiments climbs 300` and the recordings chose it.
const CLIMB_SHARE: f64 = 1.4;

/// Below this speed over the ground an aircraft has no course, metres per second.
const HOVERS_MPS: f64 = 2.0;

/// Turn rates below this many standard deviations are noise.
const NOISE_SIGMAS: f64 = 3.0;

/// The motions that a check covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Freedom {
    /// The expected motion; climbs may change.
    Expected,
    /// Also this share of turns, from 0 to 1, with [`CLIMB_SHARE`] times that of the change of climb. Turns begin at the report, or
    /// this many seconds after now, when our aircraft answers what it decides now.
    Share(f64, f64),
    /// All turns at the brief rate that begin at the report or now, all changes of climb and of speed, for the time of a turn: a way back
    /// withstands these.
    Brief,
}

/// The distance that a search keeps beyond the volumes of aircraft.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    /// More for choosing a manoeuvre than for keeping it, metres.
    pub(super) beyond_m: f64,
    /// The margin of the search itself, metres.
    pub(super) margin_m: f64,
    /// Whether manoeuvres without a certificate are compared: by the volumes without uncertainty, by depth in cylinders.
    pub(super) is_unproven: bool,
}

impl Clearance {
    /// The growth of the volumes for a share of the bounds, metres.
    fn growth_m(self, share: f64) -> f64 {
        (TRACKING_M * share - self.margin_m).max(0.0) + self.beyond_m * share
    }
}

/// The turn rate and the changes of climb of an aircraft, learned from its reports.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Trend {
    /// Average turn rate, radians per second, left positive.
    rate_radps: f64,
    /// Average climb, metres per second.
    climb_mps: f64,
}

impl Trend {
    /// Straight and level.
    pub(super) const STRAIGHT: Self = Self {
        rate_radps: 0.0,
        climb_mps: 0.0,
    };

    /// Straight on, as first reported.
    pub(super) fn of(obstacle: &Obstacle) -> Self {
        Self {
            climb_mps: obstacle.velocity_mps.z,
            ..Self::STRAIGHT
        }
    }

    /// Adds the change of velocity from one report to the next.
    pub(super) fn learn(&mut self, before_mps: Vec3, now_mps: Vec3, passed_s: f64) {
        if passed_s <= 0.0 {
            return;
        }
        let kept = libm::exp(-passed_s / CLIMB_AVERAGED_S);
        self.climb_mps = now_mps.z + kept * (self.climb_mps - now_mps.z);
        let slow = |v: Vec3| v.x * v.x + v.y * v.y < HOVERS_MPS * HOVERS_MPS;
        if slow(before_mps) || slow(now_mps) {
            return;
        }
        let turned_rad =
            wrap_pi(libm::atan2(now_mps.y, now_mps.x) - libm::atan2(before_mps.y, before_mps.x));
        let gain = 1.0 - libm::exp(-passed_s / TURN_AVERAGED_S);
        self.rate_radps += gain * (turned_rad / passed_s - self.rate_radps);
    }

    /// How much steeper the present climb or descent is expected to become, metres per second; of what it became, noise does not count.
    fn climb_change_mps(self, obstacle: &Obstacle) -> f64 {
        let steeper_mps = obstacle.velocity_mps.z.abs() - self.climb_mps.abs();
        CLIMB_GOES_ON * (steeper_mps - NOISE_SIGMAS * obstacle.uncertainty.velocity_mps)
    }

    /// The expected turn rate, radians per second: zero if it may be noise.
    fn expected_radps(self, obstacle: &Obstacle, bounds: &MovementBounds) -> f64 {
        let velocity = obstacle.velocity_mps;
        let speed_mps = libm::sqrt(velocity.x * velocity.x + velocity.y * velocity.y);
        let noise = obstacle.uncertainty.velocity_mps / speed_mps.max(HOVERS_MPS);
        let least = STRAIGHT_RADPS.max(NOISE_SIGMAS * noise / TURN_AVERAGED_S);
        if self.rate_radps.abs() < least {
            return 0.0;
        }
        let most = bounds.brief_turn_rate_radps;
        self.rate_radps.limited(-most, most)
    }
}

/// Straight on, on along the present turn, and a turn to either side at once.
pub(super) const AT_ONCE: usize = 4;

/// The same, and a turn to either side later.
pub(super) const MOTIONS: usize = AT_ONCE + 2;

/// The turns of an aircraft's motions.
fn turns(
    freedom: Freedom,
    (obstacle, trend): (&Obstacle, Trend),
    bounds: &MovementBounds,
) -> [Option<Turn>; MOTIONS] {
    let (share, rate_radps) = match freedom {
        Freedom::Expected => (0.0, 0.0),
        Freedom::Share(share, _) => (share, bounds.turn_rate_radps),
        Freedom::Brief => (1.0, bounds.brief_turn_rate_radps),
    };
    let expected_radps = trend.expected_radps(obstacle, bounds);
    let turn = |rate_radps, for_s, later_s| Turn {
        rate_radps,
        for_s,
        later_s,
    };
    let expected = (expected_radps != 0.0).then_some(turn(expected_radps, TURNS_ON_S, 0.0));
    let for_s = share * bounds.turn_rad / rate_radps;
    let turns = share > 0.0 && rate_radps != 0.0;
    let to = |rate_radps, later_s| turns.then_some(turn(rate_radps, for_s, later_s));
    let answers_s = match freedom {
        Freedom::Share(_, answers_s) => answers_s,
        _ => 0.0,
    };
    let later_s = obstacle.age_s.max(0.0) + answers_s;
    let later = |rate_radps| to(rate_radps, later_s).filter(|_| later_s > 0.0);
    [
        Some(turn(0.0, 0.0, 0.0)),
        expected,
        to(rate_radps, 0.0),
        to(-rate_radps, 0.0),
        later(rate_radps),
        later(-rate_radps),
    ]
}

/// The number of hazards of the first motions of an obstacle, at most: with each turn's chords a change of climb and the line after it.
pub(super) fn most_hazards(
    freedom: Freedom,
    (obstacle, trend): (&Obstacle, Trend),
    motions: usize,
) -> usize {
    let Some(bounds) = obstacle.movement.bounds() else {
        return 1;
    };
    let all = turns(freedom, (obstacle, trend), &bounds).into_iter();
    let legs = 2 + usize::from(freedom == Freedom::Brief);
    let legs_of = |turn: Turn| turn.chords() + legs + usize::from(turn.later_s > 0.0);
    all.take(motions).flatten().map(legs_of).sum()
}

/// Adds the first motions of an obstacle, or with 0 one hazard: straight flight, stretched by the whole change of climb from the
/// start on. `hazard` is its straight motion.
pub(super) fn add_aircraft(
    add: &mut impl FnMut(Hazard),
    hazard: &Hazard,
    (obstacle, trend): (&Obstacle, Trend),
    (freedom, clearance): (Freedom, Clearance),
    motions: usize,
) {
    let hazard = if clearance.is_unproven {
        hazard.by_depth()
    } else {
        *hazard
    };
    let Some(bounds) = obstacle.movement.bounds() else {
        return add(hazard);
    };
    let speeds_m = 0.5 * bounds.acceleration_mps2 * SPEED_CHANGES_S * SPEED_CHANGES_S;
    let turn_s = (bounds.turn_rad / bounds.turn_rate_radps).min(BACK_WITHSTANDS_S);
    let always = f64::INFINITY;
    let (climbs, changes, speeds_m, until_s) = match freedom {
        Freedom::Expected => (1.0, 1.0, 0.0, always),
        Freedom::Share(share, _) => (share, (CLIMB_SHARE * share).min(1.0), 0.0, always),
        Freedom::Brief => (1.0, 1.0, speeds_m, turn_s),
    };
    let hazard = hazard
        .possible_until(until_s)
        .grown(clearance.growth_m(climbs));
    let change_mps = (changes * bounds.climb_change_mps).max(trend.climb_change_mps(obstacle));
    let changes = Changes {
        age_s: obstacle.age_s.max(0.0),
        change_mps,
        end_mps: 0.5 * climbs * obstacle.velocity_mps.z,
        speeds_m,
    };
    if motions == 0 {
        return add(hazard.straight(&changes));
    }
    let all = turns(freedom, (obstacle, trend), &bounds).into_iter();
    for turn in all.take(motions).flatten() {
        hazard.motion(&turn, &changes, add);
    }
}

#[cfg(test)]
mod tests;

//! The belief about one aircraft.

use fga_proof::Vec3;
use fga_proof::limit::whole;
use fga_proof::situation::MovementBounds;

use crate::climb::{self, Climb};
use crate::complex::Complex;
use crate::prior;
use crate::report::{Errors, Report};
use crate::turn::{self, Turn};

/// Longest step in which the modes are carried on, seconds.
const STEP_S: f64 = 1.0;

/// Most steps from a report to the next: a longer gap has longer steps.
const MOST_STEPS: usize = 8;

/// A belief ends after this time without a report, seconds.
pub const ENDS_AFTER_S: f64 = 8.0;

/// Least σ of a report, metres and metres per second: a report is rounded, and flight is no model.
const ROUNDED: f32 = 0.05;

/// What is known of one aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief {
    /// The origin of its positions: where the aircraft was last reported, metres.
    pub(crate) origin_m: Vec3,
    time_s: f64,
    pub(crate) turns: [(f32, Turn); 4],
    pub(crate) climbs: [(f32, Climb); 2],
    errors: Errors,
    /// Odds that it is about nothing.
    lost: f32,
    pub(crate) bounds: MovementBounds,
}

/// Mean and covariance of a belief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The time of the estimate, seconds.
    pub time_s: f64,
    /// Mean of the position, metres.
    pub position_m: Vec3,
    /// Mean of the velocity, metres per second.
    pub velocity_mps: Vec3,
    /// Mean turn rate, radians per second, positive to the left.
    pub turn_rate_radps: f64,
    /// Variances along a horizontal axis of position and velocity, m² and m²/s², without what lasts.
    pub horizontal_variance: [f64; 2],
    /// Covariance of the two along an axis, m²/s.
    pub horizontal_covariance: f64,
    /// Variances of altitude and climb rate, m² and m²/s², without what lasts.
    pub vertical_variance: [f64; 2],
    /// Covariance of the two, m²/s.
    pub vertical_covariance: f64,
    /// σ of the lasting errors, metres: of each horizontal axis, and of the altitude.
    pub lasting_m: [f64; 2],
    /// Weights of the modes: steady, wavering, turning left, turning right.
    pub modes: [f64; 4],
}

impl Estimate {
    /// Standard deviations of position and velocity along the axis on which each is larger, metres and metres per second, without what
    /// lasts.
    pub fn sigmas(&self) -> [f64; 2] {
        let (across, up) = (self.horizontal_variance, self.vertical_variance);
        [across[0].max(up[0]), across[1].max(up[1])].map(libm::sqrt)
    }
}

/// New weights of modes that may change into each other, and what each is made of.
fn mixture<M: Copy, K: Copy, const N: usize>(
    modes: &[(f32, M); N],
    kinds: [K; N],
    to: K,
    chance: impl Fn(K, K) -> f32,
    enter: impl Fn(M, K, K) -> M,
) -> (f32, [(f32, M); N]) {
    let mut parts = *modes;
    for ((weight, mode), from) in parts.iter_mut().zip(kinds) {
        *weight *= chance(from, to).max(0.0);
        *mode = enter(*mode, from, to);
    }
    let sum: f32 = parts.iter().map(|part| part.0).sum();
    for part in &mut parts {
        part.0 /= sum.max(f32::MIN_POSITIVE);
    }
    (sum, parts)
}

/// Takes log likelihoods into weights: the log of the likelihood of all, and each weight if the report is true.
fn weighed<M: Copy, const N: usize>(modes: &[(f32, M); N], logs: [f32; N]) -> (f32, [f32; N]) {
    let best = logs.iter().fold(f32::MIN, |best, log| best.max(*log));
    let mut weights = logs;
    for (weight, mode) in weights.iter_mut().zip(modes) {
        *weight = mode.0 * libm::expf((*weight - best).max(-60.0));
    }
    let sum = weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
    (best + libm::logf(sum), weights.map(|weight| weight / sum))
}

impl Belief {
    /// The belief after a first report, of an aircraft with these bounds. The report must be [valid](Report::is_valid).
    pub fn new(report: &Report, bounds: &MovementBounds) -> Self {
        let errors = &report.errors;
        let speed = report.velocity_mps.unwrap_or_default();
        let (speed_variance, climb_variance) = match report.velocity_mps {
            Some(_) => (
                errors.velocity_mps.variance(ROUNDED),
                errors.climb_mps.variance(ROUNDED),
            ),
            None => (prior::SPEED_MPS * prior::SPEED_MPS, f32::INFINITY),
        };
        let variances = [errors.position_m.variance(ROUNDED), speed_variance];
        let velocity = Complex::of(speed);
        let turn_radps = bounds.turn_rate_radps as f32;
        let mut turns =
            turn::Kind::ALL.map(|kind| (0.0, Turn::new(velocity, variances, kind, turn_radps)));
        for (turn, share) in turns.iter_mut().zip(prior::MODES) {
            turn.0 = share;
        }
        // A climb rate that is known badly is more likely small.
        let usual = prior::CLIMB_MPS * prior::CLIMB_MPS;
        let known = usual / (usual + climb_variance);
        let climb = Climb {
            at: [0.0, speed.z as f32 * known],
            own: [errors.altitude_m.variance(ROUNDED), usual * (1.0 - known)],
            cross: 0.0,
        };
        let carried = -report.carried_s;
        let mut belief = Self {
            origin_m: report.position_m,
            time_s: report.time_s,
            turns,
            climbs: [
                (prior::STEADY_CLIMBS, climb),
                (1.0 - prior::STEADY_CLIMBS, climb),
            ],
            errors: *errors,
            lost: prior::LOST,
            bounds: *bounds,
        };
        // The report's position was carried on along the velocity.
        for (_, turn) in &mut belief.turns {
            turn.at[0] = velocity * carried;
        }
        for (_, climb) in &mut belief.climbs {
            climb.at[0] = climb.at[1] * carried;
        }
        belief
    }

    /// The time of the last report, seconds.
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Where its last report was, metres.
    pub const fn reported_m(&self) -> Vec3 {
        self.origin_m
    }

    /// Whether its last report is too long ago.
    pub fn has_ended(&self, time_s: f64) -> bool {
        time_s - self.time_s > ENDS_AFTER_S
    }

    /// What is believed after a report: what was believed before and has not ended goes on, otherwise a new belief begins.
    pub fn after(before: Option<Self>, report: &Report, bounds: &MovementBounds) -> Self {
        let Some(mut belief) = before.filter(|belief| !belief.has_ended(report.time_s)) else {
            return Self::new(report, bounds);
        };
        belief.update(report);
        belief
    }

    /// The bounds of the aircraft's manoeuvres.
    pub const fn bounds(&self) -> &MovementBounds {
        &self.bounds
    }

    /// The errors of the last report.
    pub const fn errors(&self) -> &Errors {
        &self.errors
    }

    /// Takes a report. One that is not valid, or not later than the last one, changes nothing.
    pub fn update(&mut self, report: &Report) {
        if !report.is_valid() || report.time_s <= self.time_s {
            return;
        }
        self.advance(report.time_s);
        self.errors = report.errors;
        let errors = &report.errors;
        let velocity = report.velocity_mps;
        // It was carried on along the velocity that it states, errors included.
        let carried_m = velocity.unwrap_or_default() * f64::from(report.carried_s);
        let off = report.position_m - carried_m - self.origin_m;
        let seen = Complex::of(off);
        let (mut turns, mut climbs) = (self.turns, self.climbs);
        let turn_logs = turns.each_mut().map(|(_, turn)| {
            let variance = errors.position_m.variance(ROUNDED);
            let log = turn.see_position(seen, variance);
            velocity.map_or(log, |velocity| {
                let velocity = Complex::of(velocity);
                log + turn.see_velocity(velocity, errors.velocity_mps.variance(ROUNDED))
            })
        });
        let climb_logs = climbs.each_mut().map(|(_, climb)| {
            let variance = errors.altitude_m.variance(ROUNDED);
            let log = climb.see_altitude(off.z as f32, variance);
            velocity.map_or(log, |velocity| {
                log + climb.see_climb(velocity.z as f32, errors.climb_mps.variance(ROUNDED))
            })
        });
        let (turn_log, turn_weights) = weighed(&self.turns, turn_logs);
        let (climb_log, climb_weights) = weighed(&self.climbs, climb_logs);
        // Is it false, or is the belief about nothing?
        let [around_m, around_mps, above_m, above_mps] = prior::ANYWHERE;
        let pi = core::f32::consts::PI;
        let places = pi * around_m * around_m * 2.0 * above_m;
        let speeds = pi * around_mps * around_mps * 2.0 * above_mps;
        let anywhere = -libm::logf(places) - velocity.map_or(0.0, |_| libm::logf(speeds));
        let odds = libm::expf((turn_log + climb_log - anywhere).clamp(-60.0, 60.0));
        let foretold = (1.0 - prior::FALSE_REPORTS) * odds + prior::FALSE_REPORTS;
        self.lost = (self.lost / foretold).max(prior::LOST);
        if self.lost > 1.0 {
            *self = Self::new(report, &self.bounds);
            return;
        }
        let truth = (1.0 - prior::FALSE_REPORTS) * odds / foretold;
        for ((old, new), weight) in self.turns.iter_mut().zip(turns).zip(turn_weights) {
            let after = truth * weight + (1.0 - truth) * old.0;
            let share = truth * weight / after.max(f32::MIN_POSITIVE);
            *old = (after, Turn::mixed(&[(share, new.1), (1.0 - share, old.1)]));
        }
        for ((old, new), weight) in self.climbs.iter_mut().zip(climbs).zip(climb_weights) {
            let after = truth * weight + (1.0 - truth) * old.0;
            let share = truth * weight / after.max(f32::MIN_POSITIVE);
            *old = (after, Climb::mixed(&[(share, new.1), (1.0 - share, old.1)]));
        }
        self.move_origin(report.position_m);
    }

    /// Positions from another origin.
    fn move_origin(&mut self, origin_m: Vec3) {
        let by = self.origin_m - origin_m;
        for (_, turn) in &mut self.turns {
            turn.at[0] = turn.at[0] + Complex::of(by);
        }
        for (_, climb) in &mut self.climbs {
            climb.at[0] += by.z as f32;
        }
        self.origin_m = origin_m;
    }

    /// White acceleration while it wavers, m²/s³: what gains speed faster than crewed aircraft wavers more.
    pub(crate) fn wavering(&self) -> f32 {
        let usual_mps2 = MovementBounds::CREWED.acceleration_mps2;
        let faster = (self.bounds.acceleration_mps2 / usual_mps2).max(1.0) as f32;
        prior::WAVERING * faster * faster
    }

    /// Carries it on to a later time, seconds: modes change, and spread.
    fn advance(&mut self, time_s: f64) {
        let gap_s = time_s - self.time_s;
        let steps = whole(gap_s / STEP_S, MOST_STEPS);
        let step_s = (gap_s / steps as f64) as f32;
        let turn_radps = self.bounds.turn_rate_radps as f32;
        let change_mps = self.bounds.climb_change_mps as f32;
        let wavering = self.wavering();
        for _ in 0..steps {
            self.turns = turn::Kind::ALL.map(|to| {
                let (weight, parts) = mixture(
                    &self.turns,
                    turn::Kind::ALL,
                    to,
                    |from, to| from.chance_to(to, step_s),
                    |mode, from, to| {
                        if from == to {
                            mode
                        } else {
                            mode.entering(to, turn_radps)
                        }
                    },
                );
                let mut mode = Turn::mixed(&parts);
                mode.advance(to, (turn_radps, wavering), step_s);
                (weight, mode)
            });
            self.climbs = climb::Kind::ALL.map(|to| {
                let (weight, parts) = mixture(
                    &self.climbs,
                    climb::Kind::ALL,
                    to,
                    |from, to| from.chance_to(to, step_s),
                    |mode, from, to| {
                        if from == to {
                            mode
                        } else {
                            mode.entering(to, change_mps)
                        }
                    },
                );
                let mut mode = Climb::mixed(&parts);
                mode.advance(to, change_mps, step_s);
                (weight, mode)
            });
        }
        self.time_s = time_s;
    }

    /// The belief at a later time without a report, seconds; at an earlier one as it is.
    #[must_use]
    pub fn later(&self, time_s: f64) -> Self {
        let mut later = *self;
        if time_s > self.time_s {
            later.advance(time_s);
        }
        later
    }

    /// Mean and covariance at a time, seconds, not before the last report.
    pub fn at(&self, time_s: f64) -> Estimate {
        let later = self.later(time_s);
        let turn = Turn::mixed(&later.turns);
        let climb = Climb::mixed(&later.climbs);
        let [position, velocity, _] = turn.at;
        let offset_m = Vec3::new(position.x.into(), position.y.into(), climb.at[0].into());
        Estimate {
            time_s: later.time_s,
            position_m: later.origin_m + offset_m,
            velocity_mps: Vec3::new(velocity.x.into(), velocity.y.into(), climb.at[1].into()),
            turn_rate_radps: turn.rate_radps().into(),
            horizontal_variance: [turn.own[0].into(), turn.own[1].into()],
            horizontal_covariance: turn.cross[0].x.into(),
            vertical_variance: climb.own.map(f64::from),
            vertical_covariance: climb.cross.into(),
            lasting_m: [
                later.errors.lasting_position_m.value.into(),
                later.errors.lasting_altitude_m.value.into(),
            ],
            modes: later.turns.map(|(weight, _)| weight.into()),
        }
    }
}

//! What the aircraft's own flight shows of it: how fast it turns, how late its bank follows, and the wind, each with an interval.
//!
//! [`Learned`] holds evidence alone. [`Learned::known`] joins it with what is believed beforehand, as of a vehicle file: where nothing
//! was seen, the interval is the one believed beforehand, and only evidence narrows it. Straight flight says nothing about turns; a
//! bank that nobody commanded says nothing about the lag; a flight in one direction says little about the wind across it.
//!
//! An error of the attitude that stays (a bank that always reads 2 % low) is part of the turn-rate factor: a prediction starts from the
//! same readings. Nothing here reads a clock, allocates or panics; what is not finite is not seen.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

use core::f64::consts::{FRAC_1_SQRT_2, PI};
use fga_proof::vehicle::{Response, STANDARD_GRAVITY_MPS2};

use fga_proof::{Vec2, Vec3};

/// Share of the estimated factor in the plan.
pub const IN_HAND: f64 = 0.97;
/// How wrong a vehicle file may be: the factor as a share, the lag and the dead time, seconds.
const FILE_WRONG: (f64, f64, f64) = (0.25, 0.3, 0.1);
/// Factors in plans, beside the one of the file.
const FACTOR_RANGE: (f64, f64) = (0.4, 1.05);
/// A gap between states outside of this range, seconds, shows nothing: a clock that jumps, or telemetry that paused.
pub const GAPS_S: core::ops::Range<f64> = 0.005..0.35;
/// Smallest bank of a turn, radians; the largest rate of roll at which a bank is steady, radians per second.
const LEAST_BANK_RAD: f64 = 0.15;
const STEADY_RADPS: f64 = 0.08;
/// Slower and faster aircraft do not fly, metres per second; no bank is beyond this, radians.
const LEAST_SPEED_MPS: f64 = 3.0;
const MOST_SPEED_MPS: f64 = 300.0;
const MOST_BANK_RAD: f64 = 1.4;
/// Length of one measurement of the turn-rate factor, seconds of steady turning.
const WINDOW_S: f64 = 1.0;
/// A ratio of turn rates outside of this range was not flown.
const RATIOS: core::ops::Range<f64> = -0.5..2.0;
/// Seconds of turning after which the flight weighs as much as what is believed beforehand; the most that are remembered.
const AS_BELIEVED_S: f64 = 4.0;
const MOST_TURNING_S: f64 = 120.0;
/// Standard deviation of a ratio at least; the errors of this many measurements in a row are one; the interval's standard deviations;
/// and what is added to it.
const LEAST_SCATTER: f64 = 0.03;
const ALIKE: f64 = 2.0;
const SIGMAS: f64 = 3.0;
const LEAST_HALF: f64 = 0.01;
/// Measurements in the recent mean, and how far it may be off the whole one, in its own standard deviations and beyond.
const RECENT: f64 = 4.0;
const OTHER_SIGMAS: f64 = 5.0;
/// Share of the evidence that stays when the aircraft becomes another one; a change of airspeed that makes it one, as a share; and the
/// time over which an airspeed is averaged, seconds.
const KEPT_SHARE: f64 = 0.1;
const OTHER_SPEED: f64 = 0.15;
const SPEED_OVER_S: f64 = 10.0;
/// Bank time constants that are compared: this one and each larger by this ratio, seconds; dead times: from 0 in these steps, seconds.
const LAGS: usize = 14;
const LEAST_LAG_S: f64 = 0.1;
const LAG_RATIO: f64 = 1.25;
const DEADS: usize = 16;
const DEAD_STEP_S: f64 = 0.05;
/// A bank nearer to its command than this shows no lag, radians.
const LEAST_ERROR_RAD: f64 = 0.08;
/// A lag counts while its error is within this of the best one's, rad² s, and within this share of it.
const LEAST_APART: f64 = 0.002;
const APART_SHARE: f64 = 0.5;
/// How steeply a worse pair weighs less in the mean.
const SHARP: f64 = 16.0;
/// Rolling after which the flight weighs as much as what is believed beforehand, rad² s; the most that is remembered.
const AS_BELIEVED: f64 = 0.05;
const MOST_ROLLING: f64 = 5.0;
/// Time between velocities that count, seconds; their error, metres per second; the time in which the wind changes, seconds; and the
/// error of the airspeed that is allowed for, as a share.
const WIND_EVERY_S: f64 = 1.0;
const WIND_ERROR_MPS: f64 = 1.0;
const WIND_LASTS_S: f64 = 120.0;
const AIRSPEED_SHARE: f64 = 0.1;

/// A value and the interval that it lies in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The value that is expected.
    pub mean: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// A value with the same error to both sides, both not negative.
    pub const fn about(mean: f64, half: f64) -> Self {
        let (low, high) = (mean - half, mean + half);
        Self { low, mean, high }
    }

    /// Half of its width.
    pub const fn half(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Whether a value lies in it.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The way from this interval to another one by a share: what lies in both lies in it.
    fn towards(&self, to: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + share * (b - a);
        let (low, high) = (between(self.low, to.low), between(self.high, to.high));
        let mean = between(self.mean, to.mean);
        Self { low, mean, high }
    }
}

/// What is known of the aircraft and the wind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownAircraft {
    /// Flown course rate over g·tan φ / V.
    pub turn_rate_factor: Interval,
    /// Time constant of the bank, seconds.
    pub bank_time_constant_s: Interval,
    /// Time before a command has any effect, seconds.
    pub dead_time_s: Interval,
    /// Dead time and time constant together, seconds: known better than either.
    pub late_s: Interval,
    /// Velocity of the air to the east and to the north, metres per second.
    pub wind_mps: [Interval; 2],
}

impl KnownAircraft {
    /// A vehicle file that may be wrong: the factor by a share of it, the time constant and the dead time by these seconds, and the wind
    /// by these metres per second.
    pub fn within(
        response: &Response,
        wind_mps: Vec2,
        (factor_share, lag_s, dead_s, off_mps): (f64, f64, f64, f64),
    ) -> Self {
        let (factor, time_s) = (response.turn_rate_factor, response.bank_time_constant_s);
        let not_negative = |mean: f64, half: f64| {
            let low = (mean - half).max(0.0);
            Interval {
                low,
                ..Interval::about(mean, half)
            }
        };
        Self {
            turn_rate_factor: Interval::about(factor, factor_share * factor),
            bank_time_constant_s: not_negative(time_s, lag_s),
            dead_time_s: not_negative(response.dead_time_s, dead_s),
            late_s: not_negative(time_s + response.dead_time_s, lag_s + dead_s),
            wind_mps: [wind_mps.x, wind_mps.y].map(|mps| Interval::about(mps, off_mps)),
        }
    }

    /// A vehicle file as it is believed before a flight, and a wind within these metres per second to the east and to the north.
    pub fn of_file(response: &Response, wind_mps: Vec2, off_mps: f64) -> Self {
        let (factor_share, lag_s, dead_s) = FILE_WRONG;
        Self::within(response, wind_mps, (factor_share, lag_s, dead_s, off_mps))
    }

    /// How the aircraft follows, as expected.
    pub const fn response(&self) -> Response {
        Response {
            dead_time_s: self.dead_time_s.mean,
            bank_time_constant_s: self.bank_time_constant_s.mean,
            turn_rate_factor: self.turn_rate_factor.mean,
        }
    }

    /// How far a flight may be from the expected one after some seconds in a turn with this bank, radians, that begins now, metres, by
    /// what is not known of the response: ½·V·ψ̇·t²·Δf/f for the rate of turn, and V·ψ̇·t·Δ for the time at which it begins.
    pub fn off_m(&self, bank_rad: f64, after_s: f64) -> f64 {
        let mps2 = STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad.abs().min(MOST_BANK_RAD));
        let (factor, late_s) = (self.turn_rate_factor, self.late_s.half());
        mps2 * after_s * (0.5 * factor.half() * after_s + factor.mean * late_s)
    }
}

/// A state of the aircraft, in the conventions of this crate: angles are positive to the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenState {
    /// When it was measured, seconds on any clock.
    pub time_s: f64,
    /// Bank, radians.
    pub bank_rad: f64,
    /// Rate of turn about the vertical, or of the course through the air, radians per second.
    pub turn_rate_radps: f64,
    /// Airspeed, metres per second.
    pub airspeed_mps: f64,
    /// Velocity over the ground, metres per second, where it was measured with this state.
    pub velocity_mps: Option<Vec2>,
}

/// The turn-rate factor: seconds of turning, the mean of its ratios, the sum of the squares about it, and the recent mean.
#[derive(Debug, Clone, Copy, Default)]
struct TurnRatios {
    /// Steady turning in this window, seconds; flown and ideal turn in it, radians.
    window: (f64, f64, f64),
    weight_s: f64,
    mean: f64,
    squares: f64,
    recent: f64,
}

impl TurnRatios {
    /// Takes a turn over some time; whether the aircraft turns unlike before.
    fn see(&mut self, gap_s: f64, flown_rad: f64, ideal_rad: f64) -> bool {
        let window = &mut self.window;
        *window = (window.0 + gap_s, window.1 + flown_rad, window.2 + ideal_rad);
        if window.0 < WINDOW_S {
            return false;
        }
        let (seconds, flown_rad, ideal_rad) = core::mem::take(window);
        let ratio = flown_rad / ideal_rad;
        if !RATIOS.contains(&ratio) {
            return false;
        }
        if self.weight_s <= 0.0 {
            self.recent = ratio;
        }
        self.weight_s += seconds;
        let off = ratio - self.mean;
        self.mean += off * seconds / self.weight_s;
        self.squares += seconds * off * (ratio - self.mean);
        self.recent += (ratio - self.recent) / RECENT;
        if self.weight_s > MOST_TURNING_S {
            self.keep(0.5);
        }
        // The recent mean's own variance is that of 2·RECENT − 1 measurements.
        let recent = libm::sqrt(self.variance() * ALIKE / (2.0 * RECENT - 1.0));
        (self.recent - self.mean).abs() > OTHER_SIGMAS * recent
    }

    /// Variance of a ratio.
    fn variance(&self) -> f64 {
        self.squares.max(0.0) / self.weight_s.max(WINDOW_S) + LEAST_SCATTER * LEAST_SCATTER
    }

    fn keep(&mut self, share: f64) {
        self.weight_s *= share;
        self.squares *= share;
    }

    fn known(&self, believed: &Interval) -> Interval {
        let measured = (self.weight_s / WINDOW_S).max(1.0);
        let half = SIGMAS * libm::sqrt(self.variance() * ALIKE / measured) + LEAST_HALF;
        let trust = self.weight_s / (self.weight_s + AS_BELIEVED_S);
        believed.towards(&Interval::about(self.mean, half), trust)
    }
}

/// The bank that each pair of lag and dead time makes of the commands, and its error so far, rad² s.
#[derive(Debug, Clone, Copy, Default)]
struct Rolling {
    rows: [[(f64, f64); LAGS]; DEADS],
    is_following: bool,
    evidence: f64,
}

/// Lags and dead times with what they are in the grid.
fn lags_s() -> impl Iterator<Item = f64> {
    core::iter::successors(Some(LEAST_LAG_S), |lag_s| Some(LAG_RATIO * lag_s))
}
fn deads_s() -> impl Iterator<Item = f64> {
    (0..16_u8).map(|step| DEAD_STEP_S * f64::from(step))
}

impl Rolling {
    fn see(&mut self, gap_s: f64, bank_rad: f64, before: &dyn Fn(f64) -> Option<f64>) {
        let mut commanded_rad = [0.0; DEADS];
        for (commanded_rad, dead_s) in commanded_rad.iter_mut().zip(deads_s()) {
            let Some(rad) = before(dead_s + 0.5 * gap_s).filter(|rad| rad.abs() < PI) else {
                self.is_following = false;
                return;
            };
            *commanded_rad = rad;
        }
        let begins = !core::mem::replace(&mut self.is_following, true);
        let error = |most: f64, rad: &f64| most.max((rad - bank_rad).abs());
        let error_rad = commanded_rad.iter().fold(0.0, error);
        let counts_s = if begins || error_rad < LEAST_ERROR_RAD {
            0.0
        } else {
            gap_s
        };
        for (row, commanded_rad) in self.rows.iter_mut().zip(commanded_rad) {
            for ((at_rad, error), lag_s) in row.iter_mut().zip(lags_s()) {
                let stays = libm::exp(-gap_s / lag_s);
                let moved_rad = commanded_rad + (*at_rad - commanded_rad) * stays;
                *at_rad = if begins { bank_rad } else { moved_rad };
                *error += counts_s * (*at_rad - bank_rad) * (*at_rad - bank_rad);
            }
        }
        self.evidence += counts_s * error_rad * error_rad;
        if self.evidence > MOST_ROLLING {
            self.keep(0.5);
        }
    }

    fn keep(&mut self, share: f64) {
        self.evidence *= share;
        let errors = self.rows.iter_mut().flatten();
        errors.for_each(|(_, error)| *error *= share);
    }

    /// Each pair with its error, beside what is believed: at the edge of that it is as bad as one that no longer counts.
    fn pairs(&self, believed: &KnownAircraft) -> impl Iterator<Item = (f64, f64, f64)> {
        let (lag, dead) = (believed.bank_time_constant_s, believed.dead_time_s);
        let off = |of: &Interval, at: f64| (at - of.mean).abs() / (of.high - of.mean).max(1e-3);
        let rows = self.rows.iter().zip(deads_s());
        rows.flat_map(move |(row, dead_s)| {
            let cells = row.iter().zip(lags_s());
            cells.map(move |(&(_, error), lag_s)| {
                let off = off(&lag, lag_s).max(off(&dead, dead_s));
                (lag_s, dead_s, error + LEAST_APART * off * off)
            })
        })
    }

    /// Time constant, dead time and both together.
    fn known(&self, believed: &KnownAircraft) -> [Interval; 3] {
        let errors = self.rows.iter().flatten().map(|(_, error)| *error);
        let apart = LEAST_APART + APART_SHARE * errors.fold(f64::INFINITY, f64::min);
        let least = |least: f64, pair: (f64, f64, f64)| least.min(pair.2);
        let least = self.pairs(believed).fold(f64::INFINITY, least);
        let none = Interval::about(0.0, f64::NEG_INFINITY);
        let (mut found, mut weights) = ([none; 3], 0.0);
        for (lag_s, dead_s, error) in self.pairs(believed) {
            let beyond = (error - least) / apart;
            if beyond > 1.0 {
                continue;
            }
            let weight = libm::exp(-SHARP * beyond);
            weights += weight;
            let apart_s = (lag_s * (LAG_RATIO - 1.0), DEAD_STEP_S);
            let late = (lag_s + dead_s, 0.5 * (apart_s.0 + apart_s.1));
            let rows = [(lag_s, apart_s.0), (dead_s, apart_s.1), late];
            for (found, (at_s, to_s)) in found.iter_mut().zip(rows) {
                found.low = found.low.min((at_s - to_s).max(0.0));
                found.mean += weight * at_s;
                found.high = found.high.max(at_s + to_s);
            }
        }
        let trust = self.evidence / (self.evidence + AS_BELIEVED);
        let (lag, dead) = (&believed.bank_time_constant_s, &believed.dead_time_s);
        let mut believed = [lag, dead, &believed.late_s].into_iter();
        found.map(|found| {
            let mean = found.mean / weights;
            let found = Interval { mean, ..found };
            believed
                .next()
                .map_or(found, |believed| believed.towards(&found, trust))
        })
    }
}

/// The wind by the circle that velocities over the ground lie on: |v|² − V² = 2·w·v + c, divided by 2·V; as information about the wind
/// and c, of which the airspeed's error is a part.
#[derive(Debug, Clone, Copy, Default)]
struct WindCircle {
    rows: [Vec3; 3],
    sums: Vec3,
    last_s: Option<f64>,
    airspeed_mps: f64,
}

impl WindCircle {
    fn see(&mut self, time_s: f64, velocity_mps: Vec2, airspeed_mps: f64) {
        let gap_s = self.last_s.map_or(WIND_EVERY_S, |last_s| time_s - last_s);
        if (0.0..WIND_EVERY_S).contains(&gap_s) {
            return;
        }
        (self.last_s, self.airspeed_mps) = (Some(time_s), airspeed_mps);
        self.keep(libm::exp(-gap_s.max(0.0) / WIND_LASTS_S));
        let row = (velocity_mps / airspeed_mps).extend(1.0);
        let squares = velocity_mps.length_squared() - airspeed_mps * airspeed_mps;
        let weight = 1.0 / (ALIKE * WIND_ERROR_MPS * WIND_ERROR_MPS);
        for (sums, at) in self.rows.iter_mut().zip(row.to_array()) {
            *sums += row * (at * weight);
        }
        self.sums += row * (weight * 0.5 * squares / airspeed_mps);
    }

    fn keep(&mut self, share: f64) {
        self.rows = self.rows.map(|row| row * share);
        self.sums *= share;
    }

    fn known(&self, believed: &[Interval; 2]) -> [Interval; 2] {
        let [east, north] = believed;
        let speed_mps = self.airspeed_mps.max(LEAST_SPEED_MPS);
        let wind_mps = Vec2::new(east.mean, north.mean);
        // c is −|w|² / 2V beside the airspeed's error: near the wind believed it changes as that one's way there says.
        let start = wind_mps.extend(-0.5 * wind_mps.length_squared() / speed_mps);
        let along = (wind_mps / speed_mps).extend(1.0);
        let off = Vec2::new(east.half(), north.half());
        let c_mps = AIRSPEED_SHARE * speed_mps + 0.5 * off.length_squared() / speed_mps;
        let halves = off.extend(c_mps);
        let sigmas = halves.max(Vec3::splat(0.1)) / SIGMAS;
        let prior = (sigmas * sigmas).recip();
        let [a, b, c] = self.rows;
        let rest = self.sums - Vec3::new(a.dot(start), b.dot(start), c.dot(start));
        let pull = along * prior.z;
        let (a, b, c) = (a + pull * along.x, b + pull * along.y, c + pull);
        let (a, b) = (a + Vec3::X * prior.x, b + Vec3::Y * prior.y);
        let part = |believed: &Interval, row: Vec3, variance: f64| {
            let half_mps = SIGMAS * libm::sqrt(variance.max(0.0));
            Interval::about(believed.mean + row.dot(rest), half_mps)
        };
        let [first, second] = [b.cross(c), c.cross(a)].map(|row| row / a.dot(b.cross(c)));
        [part(east, first, first.x), part(north, second, second.y)]
    }
}

/// The evidence of a flight.
#[derive(Debug, Clone, Copy, Default)]
pub struct Learned {
    turning: TurnRatios,
    rolling: Rolling,
    wind: WindCircle,
    last: Option<(f64, f64)>,
    /// The airspeed of late, and the one that the evidence is of, metres per second.
    airspeed_mps: Option<(f64, f64)>,
}

impl Learned {
    /// Sees a state; `commanded_before` is the bank that was commanded this many seconds before it, radians, if somebody knows.
    pub fn see(&mut self, seen: &SeenState, commanded_before: impl Fn(f64) -> Option<f64>) {
        let (time_s, bank_rad, airspeed_mps) = (seen.time_s, seen.bank_rad, seen.airspeed_mps);
        let is_flown = (LEAST_SPEED_MPS..MOST_SPEED_MPS).contains(&airspeed_mps);
        let turns = bank_rad.abs() < MOST_BANK_RAD && seen.turn_rate_radps.is_finite();
        if !is_flown || !turns || !time_s.is_finite() {
            return;
        }
        let moves = |mps: &Vec2| mps.is_finite() && mps.length() < 2.0 * MOST_SPEED_MPS;
        if let Some(velocity_mps) = seen.velocity_mps.filter(moves) {
            self.wind.see(time_s, velocity_mps, airspeed_mps);
        }
        let last = self.last.replace((time_s, bank_rad));
        let near = last.filter(|(last_s, _)| GAPS_S.contains(&(time_s - last_s)));
        let Some((last_s, last_rad)) = near else {
            self.rolling.is_following = false;
            self.turning.window = (0.0, 0.0, 0.0);
            return;
        };
        let gap_s = time_s - last_s;
        let (lately, of) = self.airspeed_mps.unwrap_or((airspeed_mps, airspeed_mps));
        let lately = lately + (airspeed_mps - lately) * gap_s / SPEED_OVER_S;
        self.airspeed_mps = Some((lately, of));
        let mut is_other = (lately - of).abs() > OTHER_SPEED * of;
        let is_steady = (bank_rad - last_rad).abs() < STEADY_RADPS * gap_s;
        if bank_rad.abs() > LEAST_BANK_RAD && is_steady {
            let ideal_radps = STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad.abs()) / airspeed_mps;
            let flown_rad = gap_s * seen.turn_rate_radps * libm::copysign(1.0, bank_rad);
            is_other |= self.turning.see(gap_s, flown_rad, gap_s * ideal_radps);
        }
        self.rolling.see(gap_s, bank_rad, &commanded_before);
        if is_other {
            self.forget();
        }
    }

    /// Keeps a tenth of the evidence: the aircraft has become another one, by its load or speed, or it did not fly as known.
    pub fn forget(&mut self) {
        self.turning.keep(KEPT_SHARE);
        self.turning.mean = self.turning.recent;
        self.rolling.keep(KEPT_SHARE);
        self.airspeed_mps = self.airspeed_mps.map(|(lately, _)| (lately, lately));
    }

    /// What is known, from what is believed beforehand and the flight so far.
    pub fn known(&self, believed: &KnownAircraft) -> KnownAircraft {
        let [bank_time_constant_s, dead_time_s, late_s] = self.rolling.known(believed);
        KnownAircraft {
            turn_rate_factor: self.turning.known(&believed.turn_rate_factor),
            bank_time_constant_s,
            dead_time_s,
            late_s,
            wind_mps: self.wind.known(&believed.wind_mps),
        }
    }

    /// Whether the flight weighs more than what is believed beforehand: of the turn-rate factor, of lag and dead time, and of the wind.
    pub fn outweighs(&self, believed: &KnownAircraft) -> [bool; 3] {
        let wind_mps = self.wind.known(&believed.wind_mps);
        let mut winds = wind_mps.iter().zip(&believed.wind_mps);
        // Of two measurements that weigh the same, the joint one has half of the variance.
        let wind = winds.all(|(known, believed)| known.half() < FRAC_1_SQRT_2 * believed.half());
        let rolling = self.rolling.evidence > AS_BELIEVED;
        [self.turning.weight_s > AS_BELIEVED_S, rolling, wind]
    }

    /// What plans are made with: what is known from a vehicle file and the flight so far, without the wind; its factor is this share of the
    /// one that is expected.
    pub fn planned(&self, file: &Response, in_hand: f64) -> KnownAircraft {
        let believed = Response {
            turn_rate_factor: file.turn_rate_factor / in_hand,
            ..*file
        };
        let mut known = self.known(&KnownAircraft::of_file(&believed, Vec2::ZERO, 0.0));
        let factor = &mut known.turn_rate_factor;
        let (least, most) = FACTOR_RANGE;
        let least = file.turn_rate_factor.min(least);
        let most = file.turn_rate_factor.max(most);
        // `clamp` panics where the ends are not in order.
        factor.mean = (in_hand * factor.mean).max(least).min(most);
        known
    }
}

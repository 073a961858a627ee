//! Rolling from one bank to another: the bank follows its command exponentially.
//!
//! The flight of a roll consists of a few pieces. In each the course rate is quadratic in time: the nearest one to the
//! roll's, with the exact change of course. `docs/proof.md` derives how far the flight may be from it.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// Abscissas and weights of Gauss's rule with four points on [0, 1]; the other two lie symmetric to the middle.
pub const GAUSS: [(f64, f64); 2] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_9),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
];

/// Largest integral of the course error within a piece, as a share of the bound of the rate's third derivative times the fifth
/// power of the duration (proof.md §3).
const BOW: f64 = 8.3e-5;

/// Largest course error within a piece, as a share of that bound times the fourth power of the duration (proof.md §3).
const WAVE: f64 = 5.3e-4;

/// Error of the turn of a piece, as a share of the ninth power of the duration times d (1 + d)⁷ of the bank d to move (proof.md §3).
const TURN_ERROR: f64 = 2.3e-9;

/// What a piece is to bow at the usual pace.
const USUAL_BOW: f64 = 3.7e-4;

/// A roll is over when so little of it is left, radians, at the usual pace; the turn of the rest counts.
const SETTLED_RAD: f64 = 1e-5;

/// The piece that ends a roll may bow by this many times what the others may, so that rolls take fewer.
const LAST_SHARE: f64 = 3.0;

/// Within a shorter piece the course rate is constant, time constants.
const SHORTEST_GROWTH: f64 = 1e-9;

/// Share of its distance from 90° by which the bank may move in a piece.
const FROM_UPRIGHT: f64 = 0.4;

/// A piece of a roll, with time in units of the time constant and course in units of the turn at a bank of
/// 45° in one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Roll {
    /// Bank at its beginning, radians.
    pub from_rad: f64,
    /// The commanded bank, radians.
    pub command_rad: f64,
    /// Its duration.
    pub lasts: f64,
    /// Change of course.
    pub turn: f64,
    /// Course rate at its beginning.
    pub rate: f64,
    /// Slope of the course rate at its beginning.
    pub growth: f64,
    /// Slope of that slope.
    pub curve: f64,
    /// Bank at its end, radians.
    pub to_rad: f64,
    /// Bound of the course rate within it, the roll's and this one.
    pub fastest: f64,
    /// Bound of the integral of the course error from its beginning.
    pub bow: f64,
    /// Bound of the course error within it.
    pub wave: f64,
    /// Bound of the error of its turn, once the rest has been rolled.
    pub turn_error: f64,
    /// What is left of the roll at its end although it counts as over, radians.
    pub left_rad: f64,
}

impl Roll {
    /// The next piece of a roll, at most `most` long; `pace`, at most 1, is the share of the usual error that it may have.
    pub(super) fn new(from_rad: f64, command_rad: f64, most: f64, pace: f64) -> Self {
        let size = (from_rad - command_rad).abs();
        let bow = BOW * unevenness(libm::tan(from_rad.abs()), size);
        let usual = pace * USUAL_BOW;
        let settles = libm::log(size / (pace * SETTLED_RAD)).max(1.0);
        if settles <= most && bow * fourth(settles) * settles <= LAST_SHARE * usual {
            return Self::part(from_rad, command_rad, settles).settled();
        }
        let longest = libm::exp(0.2 * libm::log(usual / bow));
        let upright = FRAC_PI_2 - from_rad.abs().max(command_rad.abs());
        let room = FROM_UPRIGHT * upright;
        let longest = if size > room {
            longest.min(-libm::log(1.0 - room / size))
        } else {
            longest
        };
        Self::part(from_rad, command_rad, longest.min(most))
    }

    /// A piece of a given length.
    pub(super) fn part(from_rad: f64, command_rad: f64, lasts: f64) -> Self {
        let off_rad = from_rad - command_rad;
        // What is left of the roll at the abscissas, and so at the end.
        let [(first, outer), (second, inner)] = GAUSS;
        let left = [first, second, 1.0 - second, 1.0 - first].map(|at| libm::exp(-lasts * at));
        let banks_rad = left.map(|left| command_rad + off_rad * left);
        let [a, b, c, d] = banks_rad.map(libm::tan);
        let to_rad = command_rad + off_rad * (left[0] * left[3]);
        // The course rate in Legendre's polynomials over the piece.
        let (even, odd) = (
            |at: f64| 5.0 + 30.0 * at * (at - 1.0),
            |at: f64| 3.0 - 6.0 * at,
        );
        let (outer_sum, inner_sum) = (outer * (a + d), inner * (b + c));
        let linear = odd(first) * outer * (d - a) + odd(second) * inner * (c - b);
        let quadratic = even(first) * outer_sum + even(second) * inner_sum;
        let mut mean = outer_sum + inner_sum;
        let rates = if lasts > SHORTEST_GROWTH {
            // The poles of the tangent at ±90° are integrated exactly, the rest by the rule (proof.md §3).
            let [p, q, r, s] = banks_rad.map(poles);
            mean += poles_integral(from_rad, command_rad, lasts) / lasts
                - (outer * (p + s) + inner * (q + r));
            let growth = (2.0 * linear - 6.0 * quadratic) / lasts;
            let curve = 12.0 * quadratic / (lasts * lasts);
            (mean - linear + quadratic, growth, curve)
        } else {
            // The quotient of what is left by rounding says nothing, and that of zeros is no number.
            (mean, 0.0, 0.0)
        };
        let (rate, growth, curve) = rates;
        // Both course rates are fastest at an end, or this one where its slope is zero.
        let end = rate + (growth + 0.5 * curve * lasts) * lasts;
        let vertex = -growth / curve;
        let within = if vertex > 0.0 && vertex < lasts {
            rate + 0.5 * growth * vertex
        } else {
            0.0
        };
        let steepest = libm::tan(from_rad.abs().max(to_rad.abs()));
        let fastest = [rate, end, within].map(f64::abs);
        let third = unevenness(steepest, off_rad) * fourth(lasts);
        let d = off_rad.abs();
        let ninth = TURN_ERROR * d * fourth(lasts) * fourth(lasts) * lasts;
        Self {
            from_rad,
            command_rad,
            lasts,
            turn: mean * lasts,
            rate,
            growth,
            curve,
            to_rad,
            fastest: fastest.into_iter().fold(steepest, f64::max),
            bow: BOW * third * lasts,
            wave: WAVE * third,
            turn_error: ninth * fourth(1.0 + d) * fourth(1.0 + d) / (1.0 + d),
            left_rad: 0.0,
        }
    }

    /// The same as the end of the roll: it turns the rest too.
    fn settled(mut self) -> Self {
        let left_rad = self.to_rad - self.command_rad;
        let steady = libm::tan(self.command_rad);
        self.turn_to(self.turn + (1.0 + steady * steady) * left_rad);
        // The rest's second order (proof.md §4).
        let square = self.fastest * self.fastest;
        self.turn_error += self.fastest * (1.0 + square) * left_rad * left_rad;
        self.to_rad = self.command_rad;
        self.left_rad = left_rad.abs();
        self
    }

    /// Turns by another angle at a course rate that is shifted throughout; the shift counts as a course error within it.
    pub(super) fn turn_to(&mut self, turn: f64) {
        let more = turn - self.turn;
        self.turn = turn;
        self.rate += more / self.lasts;
        self.fastest += more.abs() / self.lasts;
        self.bow += more.abs() * self.lasts;
        self.wave += more.abs();
    }
}

fn fourth(x: f64) -> f64 {
    let square = x * x;
    square * square
}

/// The part of the tangent that its poles at ±90° make.
fn poles(bank_rad: f64) -> f64 {
    2.0 * bank_rad / (FRAC_PI_2 * FRAC_PI_2 - bank_rad * bank_rad)
}

/// The integral of [`poles`] over a piece of a roll (proof.md §3).
fn poles_integral(from_rad: f64, command_rad: f64, lasts: f64) -> f64 {
    let back_rad = -(from_rad - command_rad) * libm::expm1(-lasts);
    // Of 1/(90° − φ); the other pole is that of the opposite bank.
    let pole = |from_rad: f64, command_rad: f64, back_rad: f64| {
        let moved = libm::log1p(back_rad / (FRAC_PI_2 - from_rad));
        (lasts + moved) / (FRAC_PI_2 - command_rad)
    };
    pole(from_rad, command_rad, back_rad) - pole(-from_rad, -command_rad, -back_rad)
}

/// Bound of the third derivative of the course rate over time while a bank moves over a distance from its command, from
/// the largest course rate.
///
/// With t = tan φ and the distance d it is at most (1 + t²) d (1 + 6 t d + (2 + 6 t²) d²) (proof.md §2).
fn unevenness(fastest: f64, off_rad: f64) -> f64 {
    let (square, d) = (fastest * fastest, off_rad.abs());
    (1.0 + square) * d * (1.0 + 6.0 * fastest * d + (2.0 + 6.0 * square) * d * d)
}

/// The series in u² of ∫ tan(u)/u du, by u, without the part of the pole at 90°.
const SERIES: [f64; 9] = [
    0.189_430_530_861_297_83,
    0.001_607_300_394_478_202_4,
    3.853_295_029_288_789e-5,
    1.196_205_952_173_013_2e-6,
    4.140_883_808_687_578e-8,
    1.519_517_149_504_477e-9,
    5.781_681_370_596_545e-11,
    2.255_296_798_919_955e-12,
    8.959_523_479_911_502e-14,
];

/// ∫ tan(u)/u du from 0 to a bank: the turn made while rolling out to level, in the units of
/// [`Roll`].
///
/// tan(u)/u is 8/(π² − 4u²), whose pole is at 90°, and a series for the rest, good to 10⁻¹¹.
pub(super) fn roll_out(bank_rad: f64) -> f64 {
    let square = bank_rad * bank_rad;
    let series = SERIES
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * square + coefficient);
    let twice = 2.0 * bank_rad;
    FRAC_2_PI * libm::log((PI + twice) / (PI - twice)) + bank_rad * series
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ tan(u)/u du by Simpson's rule.
    fn integrated(bank_rad: f64) -> f64 {
        let count = 2000;
        let h = bank_rad / f64::from(count);
        let value = |u: f64| if u == 0.0 { 1.0 } else { u.tan() / u };
        let inner: f64 = (1..count)
            .map(|k| value(f64::from(k) * h) * if k % 2 == 1 { 4.0 } else { 2.0 })
            .sum();
        (value(0.0) + inner + value(bank_rad)) * h / 3.0
    }

    #[test]
    fn a_roll_out_turns_the_integral_of_the_tangent_over_the_bank() {
        for bank in [-1.3, -0.4, 0.0, 1e-6, 0.2, 0.7, 0.899, 0.901, 1.05, 1.35] {
            let error = (roll_out(bank) - integrated(bank)).abs();
            assert!(
                error < 1e-9 * (1.0 + roll_out(bank).abs()),
                "{bank}: {error}"
            );
        }
    }

    #[test]
    fn a_piece_of_no_length_has_the_rate_of_its_bank() {
        for lasts in [5e-324, 1e-300, 1e-103, 1e-20, 1e-8] {
            let piece = Roll::part(0.5, -0.2, lasts);
            assert!((piece.rate - 0.5_f64.tan()).abs() < 1e-6, "{piece:?}");
            assert!(
                piece.growth.is_finite() && piece.turn.is_finite(),
                "{piece:?}"
            );
            assert!((piece.to_rad - 0.5).abs() < 1e-7, "{piece:?}");
        }
    }

    #[test]
    fn the_pieces_of_a_roll_turn_what_small_steps_do() {
        for (from, command) in [
            (0.0, 0.785),
            (0.785, 0.0),
            (-0.6, 0.9),
            (0.3, 1.3),
            (1.3, -1.3),
        ] {
            let (mut bank, mut turn, mut lasts, mut pieces) = (from, 0.0, 0.0, 0);
            while bank != command {
                let roll = Roll::new(bank, command, f64::INFINITY, 1.0);
                turn += roll.turn;
                lasts += roll.lasts;
                bank = roll.to_rad;
                pieces += 1;
                assert!(pieces < 40, "{from} to {command} takes too many pieces");
            }
            let steps = 100_000;
            let h = 30.0 / f64::from(steps);
            let excess: f64 = (0..steps)
                .map(|k| {
                    let u = (f64::from(k) + 0.5) * h;
                    let bank: f64 = command + (from - command) * f64::exp(-u);
                    (bank.tan() - f64::tan(command)) * h
                })
                .sum();
            let error = turn - f64::tan(command) * lasts - excess;
            assert!(error.abs() < 1e-5, "{from} to {command}: {error}");
        }
    }

    /// With the time constant and the course's unit as units, the way aside is the integral of the course.
    #[test]
    fn no_piece_is_farther_from_the_roll_than_it_says() {
        let mut largest = 0.0_f64;
        for pace in [1.0, 0.5] {
            for (from, command) in [
                (0.0, 0.785),
                (0.785, 0.0),
                (-0.785, 0.785),
                (-0.6, 0.9),
                (0.3, 1.3),
                (1.3, -1.3),
                (0.02, 0.0),
                (0.7, 0.72),
            ] {
                let mut bank = from;
                while bank != command {
                    let piece = Roll::new(bank, command, f64::INFINITY, pace);
                    let steps = 4000;
                    let h = piece.lasts / f64::from(steps);
                    let (mut course, mut told) = (0.0, 0.0);
                    let (mut aside, mut told_aside) = (0.0, 0.0);
                    let mut off = 0.0_f64;
                    for step in 0..steps {
                        let u = (f64::from(step) + 0.5) * h;
                        let rate = f64::tan(command + (bank - command) * f64::exp(-u));
                        let told_rate = piece.rate + (piece.growth + 0.5 * piece.curve * u) * u;
                        assert!(told_rate.abs() <= piece.fastest * (1.0 + 1e-9) + 1e-12);
                        aside += (course + 0.5 * rate * h) * h;
                        told_aside += (told + 0.5 * told_rate * h) * h;
                        course += rate * h;
                        told += told_rate * h;
                        off = off.max((aside - told_aside).abs());
                        assert!((course - told).abs() <= piece.wave + 1e-6);
                    }
                    assert!(
                        off <= piece.bow + 1e-6,
                        "{bank} to {command}, {}: {off} of {}",
                        piece.lasts,
                        piece.bow
                    );
                    largest = largest.max(off / piece.bow);
                    bank = piece.to_rad;
                }
            }
        }
        assert!(largest > 0.3, "{largest}: the bound may be closer");
    }

    /// By Peano's theorem: the largest integral of the absolute error for the third derivative's kernels (x − s)²/2.
    #[test]
    fn the_shares_of_bow_and_wave_are_those_of_peanos_kernel() {
        let [(first, outer), (second, inner)] = GAUSS;
        let nodes = [
            (first, outer),
            (second, inner),
            (1.0 - second, inner),
            (1.0 - first, outer),
        ];
        let (mut bow, mut wave) = ([0.0_f64; 101], [0.0_f64; 101]);
        let kernels = 2000;
        for kernel in 0..kernels {
            let x = (f64::from(kernel) + 0.5) / f64::from(kernels);
            let power = |s: f64, n: i32| (s - x).max(0.0).powi(n);
            let moment = |polynomial: &dyn Fn(f64) -> f64| -> f64 {
                let terms = nodes.map(|(s, w)| 0.5 * w * power(s, 2) * polynomial(s));
                terms.iter().sum()
            };
            let linear = 3.0 * moment(&|s| 2.0 * s - 1.0);
            let quadratic = 5.0 * moment(&|s| 1.0 + 6.0 * s * (s - 1.0));
            let mean = power(1.0, 3) / 6.0;
            for (k, (bow, wave)) in bow.iter_mut().zip(&mut wave).enumerate() {
                let t = k as f64 / 100.0;
                let course =
                    t * (mean + linear * (t - 1.0) + quadratic * (1.0 + t * (2.0 * t - 3.0)));
                let aside = t * t * (mean / 2.0 + linear * (t / 3.0 - 0.5))
                    + quadratic * t * t * (0.5 + t * (0.5 * t - 1.0));
                *wave += (course - power(t, 3) / 6.0).abs() / f64::from(kernels);
                *bow += (aside - power(t, 4) / 24.0).abs() / f64::from(kernels);
            }
        }
        let largest = |all: [f64; 101]| all.into_iter().fold(0.0, f64::max);
        let (bow, wave) = (largest(bow), largest(wave));
        assert!(bow < BOW && bow > 0.99 * BOW, "{bow}");
        assert!(wave < WAVE && wave > 0.99 * WAVE, "{wave}");
    }
}

//! Rolling from one bank to another: the bank follows its command exponentially.
//!
//! The flight of a roll consists of a few pieces. In each the course rate is quadratic in time: it comes as near to
//! the roll's as it can, with the exact change of course and its integral over time, so that course and position at the end
//! of a piece are right to fractions of a millimetre; a bound covers the path in between.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// Abscissas and weights of Gauss's rule with four points on [0, 1]; the other two lie symmetric to the middle.
pub(super) const GAUSS: [(f64, f64); 2] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_9),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
];

/// Largest distance of a flight from that with the nearest quadratic course rate, as a share of the bound of the rate's
/// third derivative times the fifth power of the duration: √5/30,000.
const BOW: f64 = 7.454e-5;

/// What a piece is to bow at the usual pace.
const USUAL_BOW: f64 = 3.3e-4;

/// The last piece of a roll, in time constants; it includes the whole rest.
const LAST: f64 = 3.5;

/// The course rate of a decay e^−u that makes its turn within the last piece: the curve that keeps it nearest to
/// the decay's path, and the distance then.
const LAST_CURVE: f64 = 0.366_42;
const LAST_BOW: f64 = 0.0321;

/// The last piece may bow by as many times what the others do.
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
    /// Largest course rate within it.
    pub fastest: f64,
    /// Bound of the distance of the flight from that with this course rate.
    pub bow: f64,
}

impl Roll {
    pub(super) const NONE: Self = Self {
        from_rad: 0.0,
        command_rad: 0.0,
        lasts: 0.0,
        turn: 0.0,
        rate: 0.0,
        growth: 0.0,
        curve: 0.0,
        to_rad: 0.0,
        fastest: 0.0,
        bow: 0.0,
    };

    /// The next piece of a roll, at most `most` long; `pace` stretches the usual length.
    pub(super) fn new(from_rad: f64, command_rad: f64, most: f64, pace: f64) -> Self {
        let size = (from_rad - command_rad).abs();
        let upright = FRAC_PI_2 - from_rad.abs().max(command_rad.abs());
        let unevenness = unevenness(libm::tan(from_rad.abs()), size);
        let square = pace * pace;
        let may_end = LAST_BOW * unevenness <= LAST_SHARE * USUAL_BOW * square * square * pace;
        let longest = if may_end {
            LAST
        } else {
            pace * libm::exp(0.2 * libm::log(USUAL_BOW / (BOW * unevenness)))
        };
        let room = FROM_UPRIGHT * upright;
        let longest = if size > room {
            longest.min(-libm::log(1.0 - room / size))
        } else {
            longest
        };
        if may_end && longest >= LAST && most >= LAST {
            Self::last(from_rad, command_rad)
        } else {
            Self::part(from_rad, command_rad, longest.min(most))
        }
    }

    /// A piece of a given length.
    pub(super) fn part(from_rad: f64, command_rad: f64, lasts: f64) -> Self {
        let off_rad = from_rad - command_rad;
        // What is left of the roll at the abscissas, and so at the end.
        let [(first, outer), (second, inner)] = GAUSS;
        let left = [first, second, 1.0 - second, 1.0 - first].map(|at| libm::exp(-lasts * at));
        let [a, b, c, d] = left.map(|left| libm::tan(command_rad + off_rad * left));
        let to_rad = command_rad + off_rad * (left[0] * left[3]);
        // The course rate in Legendre's polynomials over the piece.
        let (even, odd) = (
            |at: f64| 5.0 + 30.0 * at * (at - 1.0),
            |at: f64| 3.0 - 6.0 * at,
        );
        let (outer_sum, inner_sum) = (outer * (a + d), inner * (b + c));
        let mean = outer_sum + inner_sum;
        let linear = odd(first) * outer * (d - a) + odd(second) * inner * (c - b);
        let quadratic = even(first) * outer_sum + even(second) * inner_sum;
        let rates = if lasts > SHORTEST_GROWTH {
            let growth = (2.0 * linear - 6.0 * quadratic) / lasts;
            let curve = 12.0 * quadratic / (lasts * lasts);
            (mean - linear + quadratic, growth, curve)
        } else {
            // The quotient of what is left by rounding says nothing, and that of zeros is no number.
            (mean, 0.0, 0.0)
        };
        let fastest = libm::tan(from_rad.abs().max(to_rad.abs()));
        let square = lasts * lasts;
        Self {
            from_rad,
            command_rad,
            lasts,
            turn: mean * lasts,
            to_rad,
            bow: BOW * square * square * lasts * unevenness(fastest, off_rad),
            ..Self::with_rates(rates, lasts, fastest)
        }
    }

    /// The end of a roll: small enough to include its whole rest.
    fn last(from_rad: f64, command_rad: f64) -> Self {
        let off_rad = from_rad - command_rad;
        let steady = libm::tan(command_rad);
        let slope = 1.0 + steady * steady;
        // ∫ tan(c + d e^−u) − tan c du by its series in d, and how long it is missing altogether.
        let rest = slope * off_rad * (1.0 + 0.5 * steady * off_rad);
        let late = slope * off_rad * (1.0 + 0.25 * steady * off_rad);
        let curve = LAST_CURVE * slope * off_rad;
        // The turn of the rest and its integral over time, as if it were already turned, without the curve's.
        let turn = rest - curve * LAST * LAST * LAST / 6.0;
        let area = rest * LAST - late - curve * LAST * LAST * LAST * LAST / 24.0;
        let growth = 12.0 * (0.5 * turn * LAST - area) / (LAST * LAST * LAST);
        let rate = steady + turn / LAST - 0.5 * growth * LAST;
        let fastest = libm::tan(from_rad.abs().max(command_rad.abs()));
        Self {
            from_rad,
            command_rad,
            lasts: LAST,
            turn: steady * LAST + rest,
            to_rad: command_rad,
            // What is left of it at the end moves whatever comes next by as much again.
            bow: 2.0 * LAST_BOW * unevenness(fastest, off_rad),
            ..Self::with_rates((rate, growth, curve), LAST, fastest)
        }
    }

    /// With a course rate, its slope and its curve, for a time, which come near to one that is never faster.
    fn with_rates((rate, growth, curve): (f64, f64, f64), lasts: f64, fastest: f64) -> Self {
        let end = rate + (growth + 0.5 * curve * lasts) * lasts;
        Self {
            rate,
            growth,
            curve,
            fastest: fastest.max(rate.abs()).max(end.abs()),
            ..Self::NONE
        }
    }
}

/// Bound of the third derivative of the course rate over time while a bank moves over a distance from its command, from
/// the largest course rate.
///
/// With t = tan φ and the distance d it is at most (1 + t²) d (1 + 6 t d + (2 + 6 t²) d²), and less on the way to steeper banks.
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
                    // The last one includes the rest, which is long over by then.
                    let until = if piece.to_rad == command {
                        12.0
                    } else {
                        piece.lasts
                    };
                    let steps = 4000;
                    let h = until / f64::from(steps);
                    let (mut course, mut told) = (0.0, 0.0);
                    let (mut aside, mut told_aside) = (0.0, 0.0);
                    let mut off = 0.0_f64;
                    for step in 0..steps {
                        let u = (f64::from(step) + 0.5) * h;
                        let rate = f64::tan(command + (bank - command) * f64::exp(-u));
                        let told_rate = if u < piece.lasts {
                            piece.rate + (piece.growth + 0.5 * piece.curve * u) * u
                        } else {
                            f64::tan(command)
                        };
                        assert!(told_rate.abs() <= piece.fastest * (1.0 + 1e-9) + 1e-12);
                        aside += (course + 0.5 * rate * h) * h;
                        told_aside += (told + 0.5 * told_rate * h) * h;
                        course += rate * h;
                        told += told_rate * h;
                        off = off.max((aside - told_aside).abs());
                    }
                    // Steps of another width than the piece's end in the wrong one.
                    let inexact = 1e-6 + 2e-3 * h * bank.abs().max(command.abs());
                    assert!(
                        off <= piece.bow + inexact,
                        "{bank} to {command}, {}: {off} of {}",
                        piece.lasts,
                        piece.bow
                    );
                    largest = largest.max(off / piece.bow);
                    bank = piece.to_rad;
                }
            }
        }
        assert!(largest > 0.5, "{largest}: the bound may be closer");
    }
}

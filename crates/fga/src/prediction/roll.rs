//! Rolling from one bank to another: the bank follows its command exponentially.
//!
//! The flight of a roll consists of a few pieces. In each the course rate is linear in time,
//! with the exact change of course and its integral over time, so that course and position at the end
//! of a piece are right to fractions of a millimetre; a bound covers the path in between.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// Abscissas and weights of Gauss's rule with four points on [0, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_9),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_9),
];

/// Longest pieces, in time constants, while the bank is farther than an angle from its command,
/// radians.
const LONGEST: [(f64, f64); 4] = [(0.3, 0.6), (0.1, 0.9), (0.02, 1.2), (0.004, 1.6)];

/// The last piece of a roll, in time constants; it includes the whole rest.
const LAST: f64 = 3.0;

/// Largest change of tan(bank) in the last piece at the usual pace: its path stays within millimetres of the roll's.
const LAST_CHANGE: f64 = 0.02;

/// Within a shorter piece the course rate is constant, time constants.
const SHORTEST_GROWTH: f64 = 1e-9;

/// Share of its distance from 90° by which the bank may move in a piece.
const FROM_UPRIGHT: f64 = 0.4;

/// Bound of the distance from the flight with a linear course rate, as a share of the roll's size times
/// the fourth power of the piece's length.
const BOW: f64 = 2e-3;

/// The same for the last piece, as a share of the roll's size.
const LAST_BOW: f64 = 0.12;

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
    /// Course rate at its beginning, for a linear course rate.
    pub rate: f64,
    /// Slope of the course rate.
    pub growth: f64,
    /// Bank at its end, radians.
    pub to_rad: f64,
    /// Largest course rate within it.
    pub fastest: f64,
    /// Bound of the difference between the course and the linear rate's, times the duration.
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
        to_rad: 0.0,
        fastest: 0.0,
        bow: 0.0,
    };

    /// The next piece of a roll, at most `most` long; `pace` stretches the usual length.
    pub(super) fn new(from_rad: f64, command_rad: f64, most: f64, pace: f64) -> Self {
        let off_rad = from_rad - command_rad;
        let size = off_rad.abs();
        let upright = FRAC_PI_2 - from_rad.abs().max(command_rad.abs());
        let longest = LONGEST
            .iter()
            .find(|(beyond, _)| size > *beyond)
            .or_else(|| {
                LONGEST
                    .last()
                    .filter(|_| !Self::may_end(from_rad, command_rad, pace))
            })
            .map_or(LAST, |(_, longest)| pace * longest);
        let room = FROM_UPRIGHT * upright;
        let longest = if size > room {
            longest.min(-libm::log(1.0 - room / size))
        } else {
            longest
        };
        if longest >= LAST && most >= LAST {
            Self::last(from_rad, command_rad)
        } else {
            Self::part(from_rad, command_rad, longest.min(most))
        }
    }

    /// Whether the last piece may be next: the pace falls as the fifth root of the roll's sideways distance.
    fn may_end(from_rad: f64, command_rad: f64, pace: f64) -> bool {
        let steepest = tan(from_rad.abs().max(command_rad.abs()));
        let change = (from_rad - command_rad).abs() * (1.0 + steepest * steepest);
        let square = pace * pace;
        change <= LAST_CHANGE * square * square * pace
    }

    /// A piece of a given length.
    pub(super) fn part(from_rad: f64, command_rad: f64, lasts: f64) -> Self {
        let off_rad = from_rad - command_rad;
        // What is left of the roll at the abscissas, which lie symmetric to the middle, and at the end.
        let [(first, _), (second, _), ..] = GAUSS;
        let middle = libm::exp(-0.5 * lasts);
        let outer = libm::exp(lasts * (0.5 - first));
        let inner = libm::exp(lasts * (0.5 - second));
        let left = [
            middle * outer,
            middle * inner,
            middle / inner,
            middle / outer,
        ];
        let to_rad = command_rad + off_rad * middle * middle;
        // The change of course and its integral over time.
        let (mut turn, mut area) = (0.0, 0.0);
        for ((at, weight), left) in GAUSS.into_iter().zip(left) {
            let rate = tan(command_rad + off_rad * left);
            turn += weight * rate;
            area += weight * rate * (1.0 - at);
        }
        turn *= lasts;
        area *= lasts * lasts;
        // The quotient of what is left by rounding says nothing, and that of zeros is no number.
        let growth = if lasts > SHORTEST_GROWTH {
            12.0 * (0.5 * turn * lasts - area) / (lasts * lasts * lasts)
        } else {
            0.0
        };
        let rate = if lasts > SHORTEST_GROWTH {
            turn / lasts - 0.5 * growth * lasts
        } else {
            tan(from_rad)
        };
        Self {
            lasts,
            turn,
            rate,
            growth,
            to_rad,
            ..Self::bounded(from_rad, command_rad, lasts)
        }
    }

    /// The end of a roll: small enough to include its whole rest.
    fn last(from_rad: f64, command_rad: f64) -> Self {
        let off_rad = from_rad - command_rad;
        let steady = tan(command_rad);
        let slope = 1.0 + steady * steady;
        // ∫ tan(c + d e^−u) − tan c du by its series in d.
        let rest = slope * off_rad * (1.0 + 0.5 * steady * off_rad);
        let turn = steady * LAST + rest;
        // The integral of the course over time, as if the rest were already turned.
        let growth = 12.0 * rest * (1.0 - 0.5 * LAST) / (LAST * LAST * LAST);
        Self {
            lasts: LAST,
            turn,
            rate: turn / LAST - 0.5 * growth * LAST,
            growth,
            to_rad: command_rad,
            ..Self::bounded(from_rad, command_rad, LAST)
        }
    }

    fn bounded(from_rad: f64, command_rad: f64, lasts: f64) -> Self {
        let off_rad = from_rad - command_rad;
        let fastest = tan(from_rad.abs().max(command_rad.abs()));
        let steepness = 1.0 + fastest * fastest;
        let square = lasts * lasts;
        let bow = (BOW * square * square).min(LAST_BOW);
        Self {
            from_rad,
            command_rad,
            fastest,
            bow: bow * off_rad.abs() * steepness,
            ..Self::NONE
        }
    }
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

/// tan(u)/u by the same series, good to 10⁻¹¹ for banks up to 80°.
pub(super) fn tan_share(bank_rad: f64) -> f64 {
    let square = bank_rad * bank_rad;
    let (mut series, mut degree) = (0.0, 2.0 * SERIES.len() as f64 - 1.0);
    for coefficient in SERIES.iter().rev() {
        series = series * square + degree * coefficient;
        degree -= 2.0;
    }
    8.0 / (PI * PI - 4.0 * square) + series
}

fn tan(bank_rad: f64) -> f64 {
    bank_rad * tan_share(bank_rad)
}

/// Up to this bank a polynomial tells the turn of a roll-out, radians.
const MODERATE_RAD: f64 = 0.9;

/// The polynomial in u² of ∫ tan(u)/u du, by u: it meets it at twelve Chebyshev points, good to 10⁻¹³.
const MODERATE: [f64; 12] = [
    0.999_999_999_999_950_9,
    0.111_111_111_128_527_9,
    0.026_666_665_647_242_96,
    0.007_709_773_825_228_495,
    0.002_429_670_506_494_86,
    0.000_807_622_214_240_716_7,
    0.000_268_226_982_066_033_25,
    0.000_119_777_916_348_911_17,
    -7.089_337_432_458_716e-06,
    6.182_451_941_441_808e-05,
    -3.000_825_693_091_690_2e-05,
    1.365_245_090_697_023e-05,
];

/// ∫ tan(u)/u du from 0 to a bank: the turn made while rolling out to level, in the units of
/// [`Roll`].
///
/// Beyond moderate banks, tan(u)/u is 8/(π² − 4u²), whose pole is at 90°, and a series for the rest, good to 10⁻¹¹.
pub(super) fn roll_out(bank_rad: f64) -> f64 {
    let square = bank_rad * bank_rad;
    if bank_rad.abs() <= MODERATE_RAD {
        // By pairs: half as many steps wait for the one before.
        let fourth = square * square;
        let pairs = MODERATE.as_chunks::<2>().0.iter().rev();
        return bank_rad * pairs.fold(0.0, |sum, [a, b]| sum * fourth + (a + b * square));
    }
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
}

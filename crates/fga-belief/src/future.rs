//! Weighted futures of an aircraft.

use fga_proof::Vec3;

use crate::Belief;
use crate::climb::Climb;
use crate::complex::{Complex, turned};
use crate::prior;
pub use crate::table::FUTURES;
use crate::table::{TABLE, normal, unit};
use crate::turn::{Kind, Turn};

/// A turn is followed by chords that bow by this, metres,
const BOW_M: f32 = 3.0;

/// ... but last this long at least, seconds, however fast an aircraft says it is.
const LEAST_CHORD_S: f32 = 1.0;

/// A turn rate above this is a turn, radians per second: six σ of what wanders, less than any turn that begins.
const TURNS_RADPS: f32 = 0.015;

/// From this climb rate on a climb levels off as often as climbs do, metres per second; a smaller one less often, in proportion.
const CLIMBS_MPS: f32 = 1.0;

/// The complement of the error function is the -16th power of 1 + a₁x + … + a₆x⁶ within 3e-7 (Abramowitz and Stegun, 7.1.28).
const ERFC: [f32; 6] = [
    0.070_523_08,
    0.042_282_01,
    0.009_270_527,
    0.000_152_014_3,
    0.000_276_567_2,
    0.000_043_063_8,
];

/// A piece of a future: straight or turning at a constant rate, with a constant climb rate.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    /// Its beginning, seconds from the first one's.
    from_s: f32,
    /// Position and velocity at its beginning, from the origin of the futures.
    at: Complex,
    velocity: Complex,
    altitude_m: f32,
    climb_mps: f32,
    turn_radps: f32,
}

impl Leg {
    /// Its position at a moment, seconds from the beginning of the first one, metres.
    fn position_m(&self, at_s: f32) -> [f32; 3] {
        let after_s = at_s - self.from_s;
        let at = self.at + turned(self.turn_radps, after_s).0 * self.velocity;
        [at.x, at.y, self.altitude_m + self.climb_mps * after_s]
    }

    /// A later moment of it.
    fn later(&self, from_s: f32) -> Self {
        let [x, y, altitude_m] = self.position_m(from_s);
        Self {
            from_s,
            at: Complex::new(x, y),
            velocity: self.velocity * Complex::unit(self.turn_radps * (from_s - self.from_s)),
            altitude_m,
            ..*self
        }
    }
}

/// How far a future may be off along an axis, beside what lasts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Variances of place and velocity, m² and m²/s², and their covariance, m²/s, at its beginning.
    own: [f32; 2],
    cross: f32,
    /// White acceleration, m²/s³.
    white: f32,
    /// From this moment on the velocity is another one, seconds.
    until_s: f32,
}

impl Spread {
    /// Of what is known exactly.
    pub const NONE: Self = Self {
        own: [0.0; 2],
        cross: 0.0,
        white: 0.0,
        until_s: 0.0,
    };

    /// Of the altitude.
    const fn above(climb: &Climb, until_s: f32) -> Self {
        Self {
            own: climb.own,
            cross: climb.cross,
            white: prior::CLIMB_AHEAD,
            until_s,
        }
    }

    /// Along a horizontal axis. What wavers does so until that ends.
    fn beside(turn: &Turn, kind: Kind, wavering: f32) -> Self {
        let [place, mut velocity, _] = turn.own;
        if kind == Kind::Wavering {
            velocity += wavering / kind.ends_per_s();
        }
        Self {
            own: [place, velocity],
            cross: turn.cross[0].x,
            white: prior::STEADY,
            until_s: f32::INFINITY,
        }
    }

    /// The variance after a time, in two parts: the σ of the part that reports show by an earlier time, metres, and the variance that remains,
    /// m². Times in seconds. A belief stays as sharp as it is.
    pub fn parted(&self, after_s: f32, learned_s: f32) -> (f32, f32) {
        let then = Self {
            until_s: (self.until_s - learned_s).max(0.0),
            ..*self
        };
        let left_m2 = then.variance((after_s - learned_s).max(0.0));
        let learned_m2 = self.variance(after_s) - left_m2;
        (libm::sqrtf(learned_m2.max(0.0)), left_m2)
    }

    /// The variance after a time, seconds, m².
    pub fn variance(&self, after_s: f32) -> f32 {
        let t = after_s.min(self.until_s);
        let wavers_s = t.min(prior::WAVERS_FOR_S);
        let [place, velocity] = self.own;
        place + t * (2.0 * self.cross + t * velocity + self.white * wavers_s * wavers_s / 3.0)
    }
}

/// One motion that a belief allows: at most three pieces, the last one for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Future {
    /// Its weight; all weights of an aircraft add up to one.
    pub weight: f32,
    /// How far it may be off along each horizontal axis.
    pub beside: Spread,
    /// The same for its altitude.
    pub above: Spread,
    /// Where it is off along the axes, in σ of what is learned later.
    pub off: [f32; 3],
    legs: [Leg; 3],
}

impl Future {
    /// Chords of its path up to a moment, seconds: when each begins and ends, and how far it bows, metres.
    pub fn chords(&self, until_s: f64) -> impl Iterator<Item = ([f32; 2], f32)> {
        let (mut from_s, until_s) = (0.0, until_s as f32);
        core::iter::from_fn(move || {
            let next = self.legs.iter().position(|leg| leg.from_s > from_s);
            let leg = self.legs.get(next.unwrap_or(self.legs.len()) - 1)?;
            let ends_s = next
                .and_then(|next| self.legs.get(next))
                .map_or(until_s, |next| next.from_s.min(until_s));
            // The way to the side, a t² / 2, bows by a t² / 8.
            let across_mps2 = libm::sqrtf(leg.velocity.squared()) * leg.turn_radps.abs();
            let chord_s = libm::sqrtf(8.0 * BOW_M / across_mps2.max(1e-3)).max(LEAST_CHORD_S);
            let to_s = ends_s.min(from_s + chord_s);
            let lasts_s = to_s - from_s;
            let chord = ([from_s, to_s], across_mps2 * lasts_s * lasts_s / 8.0);
            from_s = to_s;
            (lasts_s > 0.0).then_some(chord)
        })
    }

    /// Its position after a time, seconds, from the origin of the futures, metres.
    pub fn position_m(&self, after_s: f32) -> [f32; 3] {
        let [first, second, third] = &self.legs;
        let leg = if after_s < second.from_s {
            first
        } else if after_s < third.from_s {
            second
        } else {
            third
        };
        leg.position_m(after_s)
    }
}

/// What an aircraft may do in place of any of its futures: a turn, a climb, a descent or another speed within its bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Otherwise {
    /// The chance that it does.
    pub share: f32,
    speed_mps: f32,
    across_mps2: f32,
    along_mps2: f32,
    climb_mps: f32,
}

impl Otherwise {
    /// How far it may be off after a time along a horizontal axis and in altitude, as σ of an even distribution, metres.
    pub fn off_m(&self, after_s: f32) -> [f32; 2] {
        let turned_m = (self.across_mps2 * after_s / 2.0).min(self.speed_mps) * after_s;
        let faster_s = after_s.min(prior::FASTER_FOR_S);
        let faster_m = self.along_mps2 * faster_s * (after_s - faster_s / 2.0);
        let beside_m = turned_m.max(faster_m);
        [beside_m, self.climb_mps * after_s].map(|most_m| most_m * 0.577)
    }
}

/// The futures of an aircraft from a moment on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Futures {
    /// The origin of their positions, metres.
    pub origin_m: Vec3,
    /// Variances of the errors that last, along each horizontal axis and of the altitude, m².
    pub lasting_m2: [f32; 2],
    /// What it may do in place of each.
    pub otherwise: Otherwise,
    /// How well place and velocity are known now: variances along a horizontal axis and of the altitude, m² and m²/s².
    pub known: [[f32; 2]; 2],
    /// The belief at that moment; the mode that each future begins in, and its weight.
    now: Belief,
    begins: [(usize, f32); FUTURES],
}

impl Futures {
    /// The futures, each made as it is asked for; the first of them need not be the most likely one.
    pub fn each(&self) -> impl Iterator<Item = Future> {
        let rows = TABLE.iter().zip(&self.begins).zip(0..);
        rows.map(|((row, begin), n)| self.now.drawn(*row, n, *begin))
    }

    /// The chance that what is off by a distance in `least_m..=most_m` comes within `half_m`, given its σ, metres.
    pub fn comes_within(least_m: f32, most_m: f32, half_m: f32, sigma_m: f32) -> f32 {
        let sigma_m = sigma_m.max(0.01);
        let below = |x: f32| {
            let sigmas = x / sigma_m;
            let by = sigmas.abs() * core::f32::consts::FRAC_1_SQRT_2;
            let sum = 1.0 + ERFC.iter().rev().fold(0.0, |sum, a| (sum + a) * by);
            let beyond = 0.5 / (0..4).fold(sum, |power, _| power * power);
            if sigmas > 0.0 { 1.0 - beyond } else { beyond }
        };
        (below(half_m - least_m) - below(-half_m - most_m)).max(0.0)
    }
}

/// The acceleration of a turn, given the mean of place and velocity: mean, and σ along an axis.
fn acceleration(turn: &Turn) -> (Complex, f32) {
    let [pp, vv, aa] = turn.own;
    let [pv, pa, va] = turn.cross;
    let root = |variance: f32| libm::sqrtf(variance.max(1e-12));
    let p = root(pp);
    let (v_p, a_p) = (pv.conj() * (1.0 / p), pa.conj() * (1.0 / p));
    let v = root(vv - v_p.squared());
    let a_v = (va.conj() - a_p * v_p.conj()) * (1.0 / v);
    (turn.at[2], root(aa - a_p.squared() - a_v.squared()))
}

impl Belief {
    /// Its futures from a time on, seconds, not before the last report.
    pub fn futures(&self, time_s: f64) -> Futures {
        let now = self.later(time_s);
        let errors = now.errors();
        let lasting_m2 =
            [errors.lasting_position_m, errors.lasting_altitude_m].map(|sigma| sigma.variance(0.0));
        let turn = Turn::mixed(&now.turns);
        let speed_mps = libm::sqrtf(turn.at[1].squared());
        let otherwise = Otherwise {
            share: prior::OTHERWISE,
            speed_mps,
            across_mps2: speed_mps * now.bounds.brief_turn_rate_radps as f32,
            along_mps2: now.bounds.acceleration_mps2 as f32,
            climb_mps: now.bounds.climb_change_mps as f32,
        };
        Futures {
            origin_m: now.origin_m,
            lasting_m2,
            otherwise,
            known: [[turn.own[0], turn.own[1]], Climb::mixed(&now.climbs).own],
            begins: now.begins(),
            now,
        }
    }

    /// The modes that the futures begin in, and the weight of each future. What is less likely has more futures than its share, each of less
    /// weight, so that a small chance grows in small steps: numbers in proportion to the roots of the weights.
    fn begins(&self) -> [(usize, f32); FUTURES] {
        let roots = self.turns.map(|(weight, _)| libm::sqrtf(weight));
        let sum = roots.iter().sum::<f32>();
        let mut begins = [(0, 0.0); FUTURES];
        let mut drawn = [0.0; Kind::ALL.len()];
        for ((mode, _), n) in begins.iter_mut().zip(0..) {
            *mode = picked(roots, unit(n) * sum);
            if let Some(drawn) = drawn.get_mut(*mode) {
                *drawn += 1.0;
            }
        }
        let weights = self.turns.iter().zip(&drawn);
        let weights = weights.filter(|(_, drawn)| **drawn > 0.0);
        let all = weights.map(|((weight, _), _)| weight).sum::<f32>();
        for (mode, share) in &mut begins {
            let weight = self.turns.get(*mode).map_or(0.0, |(weight, _)| *weight);
            let drawn = drawn.get(*mode).copied().unwrap_or(1.0);
            *share = if all > 0.0 {
                weight / (all * drawn)
            } else {
                1.0 / FUTURES as f32
            };
        }
        begins
    }

    /// A future by the `n`th row of the table: of a mode and with a weight, with two changes. Place, velocity and altitude are the means of
    /// that mode: how far they may be off is integrated, not drawn.
    fn drawn(&self, row: [u8; 8], n: u8, (mode, weight): (usize, f32)) -> Future {
        let [a0, a1, t1, what1, how1, t2, what2, how2] = row;
        let kind = Kind::ALL.get(mode).copied().unwrap_or(Kind::Steady);
        let (_, turn) = self.turns.get(mode).unwrap_or(&self.turns[0]);
        let level = picked(self.climbs.map(|(weight, _)| weight), unit(a1));
        let (_, climb) = self.climbs.get(level).unwrap_or(&self.climbs[0]);
        let [at, velocity, _] = turn.at;
        let (mean, sigma) = acceleration(turn);
        let speed2 = velocity.squared().max(25.0);
        let rate = (mean * velocity.conj()).y / speed2;
        let first = Leg {
            from_s: 0.0,
            at,
            velocity,
            altitude_m: climb.at[0],
            climb_mps: climb.at[1],
            turn_radps: if kind.side() == 0.0 {
                normal(a0) * prior::WANDERS_RADPS
            } else {
                let change = prior::TURN_CHANGE * self.bounds.turn_rate_radps as f32;
                let off = normal(a0) * libm::hypotf(sigma / libm::sqrtf(speed2), change);
                let brief = self.bounds.brief_turn_rate_radps as f32;
                (rate + off).max(-brief).min(brief)
            },
        };
        let second = self.changed(&first, [t1, what1, how1].map(unit));
        let third = self.changed(&second, [t2, what2, how2].map(unit));
        let changes = |leg: &&Leg| leg.climb_mps != first.climb_mps;
        let until_s = [&second, &third].into_iter().find(changes);
        let until_s = until_s.map_or(f32::INFINITY, |leg| leg.from_s);
        Future {
            weight,
            beside: Spread::beside(turn, kind, self.wavering()),
            above: Spread::above(climb, until_s),
            off: off(n),
            legs: [first, second, third],
        }
    }

    /// The piece after a piece: when, what, how, by numbers in (0, 1).
    fn changed(&self, leg: &Leg, [when, what, how]: [f32; 3]) -> Leg {
        let turns = leg.turn_radps.abs() > TURNS_RADPS;
        let turn_rate = if turns {
            prior::TURN_ENDS_PER_S + prior::TURN_CHANGES_SIDE_PER_S
        } else {
            prior::TURN_BEGINS_PER_S
        };
        let level_rate = prior::LEVELS_OFF_PER_S * (leg.climb_mps.abs() / CLIMBS_MPS).min(1.0);
        let climb_rate = level_rate + prior::CLIMB_BEGINS_PER_S;
        let all = turn_rate + climb_rate + prior::SPEED_CHANGES_PER_S;
        // Whole seconds, as futures are looked at.
        let after_s = libm::ceilf(-libm::logf(when) / all);
        let mut next = leg.later(leg.from_s + after_s);
        let side = 2.0 * how - 1.0;
        let share = side.abs();
        if what * all < turn_rate {
            let usual = libm::copysignf(
                self.bounds.turn_rate_radps as f32 * (0.4 + 1.2 * share),
                side,
            );
            let ends = what * all < prior::TURN_ENDS_PER_S;
            next.turn_radps = match (turns, ends) {
                (true, true) => 0.0,
                (true, false) => libm::copysignf(usual, -leg.turn_radps),
                (false, _) => usual,
            };
        } else if what * all < turn_rate + climb_rate {
            let usual = libm::copysignf(
                self.bounds.climb_change_mps as f32 * (0.4 + 1.3 * share),
                side,
            );
            let levels_off = what * all < turn_rate + level_rate;
            next.climb_mps = if levels_off { 0.0 } else { usual };
        } else {
            next.velocity = next.velocity * (1.0 + prior::SPEED_CHANGE * 1.7 * side);
        }
        next
    }
}

/// Where the `n`th future is off: numbers of another row, so that they say nothing of its changes.
fn off(n: u8) -> [f32; 3] {
    let row = (usize::from(n) + FUTURES / 2) % FUTURES;
    let [.., what1, how1, _, what2, _] = TABLE.get(row).copied().unwrap_or_default();
    [what1, how1, what2].map(normal)
}

/// The first of some weights up to which they add up to more than a number; the first of all if they do not.
fn picked<const N: usize>(weights: [f32; N], at: f32) -> usize {
    let mut sum = 0.0;
    let mut weights = weights.into_iter();
    let picked = weights.position(|weight| {
        sum += weight;
        at < sum
    });
    picked.unwrap_or(0)
}

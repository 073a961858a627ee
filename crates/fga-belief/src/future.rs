//! Weighted futures of an aircraft.

use fga_proof::Vec3;

use crate::Belief;
use crate::climb::Climb;
use crate::complex::{Complex, turned};
use crate::prior;
use crate::table::{DRAWN, TABLE, normal, unit};
use crate::turn::{Kind, Turn};

/// Futures that stand for the edges of its bounds: a hard turn to either side, a climb, a descent.
const EDGES: usize = 4;

/// Futures of an aircraft.
pub const FUTURES: usize = DRAWN + EDGES;

/// Weight of each edge.
const EDGE_WEIGHT: f32 = 0.005;

/// A climb rate above this is a climb, metres per second.
const CLIMBS_MPS: f32 = 0.5;

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
    /// A later moment of it.
    fn later(&self, from_s: f32) -> Self {
        let (chord, _) = turned(self.turn_radps, from_s - self.from_s);
        Self {
            from_s,
            at: self.at + chord * self.velocity,
            velocity: self.velocity * Complex::unit(self.turn_radps * (from_s - self.from_s)),
            altitude_m: self.altitude_m + self.climb_mps * (from_s - self.from_s),
            ..*self
        }
    }
}

/// How far the altitude of a future may be off, beside what lasts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Variances of altitude and climb rate, m² and m²/s², and their covariance, m²/s, at its beginning.
    own: [f32; 2],
    cross: f32,
    /// From this moment on the climb rate is another one, seconds.
    until_s: f32,
}

impl Spread {
    /// Of an altitude that is known exactly.
    pub const NONE: Self = Self {
        own: [0.0; 2],
        cross: 0.0,
        until_s: 0.0,
    };

    fn of(climb: &Climb, until_s: f32) -> Self {
        Self {
            own: climb.own,
            cross: climb.cross,
            until_s,
        }
    }

    /// Variance of the altitude after a time, seconds, m².
    pub fn variance(&self, after_s: f32) -> f32 {
        let t = after_s.min(self.until_s);
        let [zz, ww] = self.own;
        let n = t.min(15.0);
        zz + t * (2.0 * self.cross + t * ww + prior::STEADY_CLIMB * n * n / 3.0)
    }
}

/// One motion that a belief allows: at most three pieces, the last one for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Future {
    /// Its weight; all weights of an aircraft add up to one.
    pub weight: f32,
    /// How far its altitude may be off.
    pub spread: Spread,
    legs: [Leg; 3],
}

impl Future {
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
        let later = leg.later(after_s);
        [later.at.x, later.at.y, later.altitude_m]
    }
}

/// The futures of an aircraft from a moment on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Futures {
    /// The origin of their positions, metres.
    pub origin_m: Vec3,
    /// σ of the altitude's lasting error, metres: the same in all of them.
    pub lasting_altitude_m: f32,
    /// The futures; the first of them need not be the most likely one.
    pub all: [Future; FUTURES],
}

impl Futures {
    /// The chance that an altitude within `lowest_m..=highest_m` above the own one comes within `half_height_m`, given its σ.
    pub fn meets(lowest_m: f32, highest_m: f32, half_height_m: f32, sigma_m: f32) -> f32 {
        let below =
            |x: f32| 0.5 * libm::erfcf(-x / (core::f32::consts::SQRT_2 * sigma_m.max(0.01)));
        (below(half_height_m - lowest_m) - below(-half_height_m - highest_m)).max(0.0)
    }
}

/// A Gaussian vector by its Cholesky factors: position, velocity, acceleration.
fn drawn(turn: &Turn, lasting_m2: f32, by: [Complex; 3]) -> [Complex; 3] {
    let [pp, vv, aa] = turn.own;
    let [pv, pa, va] = turn.cross;
    let root = |variance: f32| libm::sqrtf(variance.max(1e-12));
    let p = root(pp);
    let (v_p, a_p) = (pv.conj() * (1.0 / p), pa.conj() * (1.0 / p));
    let v = root(vv - v_p.squared());
    let a_v = (va.conj() - a_p * v_p.conj()) * (1.0 / v);
    let a = root(aa - a_p.squared() - a_v.squared());
    let [first, second, third] = by;
    let [at, velocity, acceleration] = turn.at;
    [
        at + first * root(pp + lasting_m2),
        velocity + v_p * first + second * v,
        acceleration + a_p * first + a_v * second + third * a,
    ]
}

impl Belief {
    /// Its futures from a time on, seconds, not before the last report.
    pub fn futures(&self, time_s: f64) -> Futures {
        let now = self.later(time_s);
        let errors = now.errors();
        let lasting_m2 = errors.lasting_position_m.variance(0.0);
        let (brief, change_mps) = (
            now.bounds.brief_turn_rate_radps as f32,
            now.bounds.climb_change_mps as f32,
        );
        let middle = now.middle();
        let still = Future {
            weight: EDGE_WEIGHT,
            legs: [middle; 3],
            spread: Spread::of(&Climb::mixed(&now.climbs), f32::INFINITY),
        };
        let mut all = [still; FUTURES];
        let (some, edges) = all.split_at_mut(DRAWN);
        for ((future, row), n) in some.iter_mut().zip(&TABLE).zip(0_u8..) {
            future.weight = (1.0 - EDGES as f32 * EDGE_WEIGHT) / DRAWN as f32;
            (future.legs, future.spread) = now.drawn(row, n, lasting_m2, brief);
        }
        let turn_s = now.bounds.turn_rad as f32 / brief.max(1e-3);
        for (future, [side, up]) in
            (edges.iter_mut()).zip([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        {
            let first = Leg {
                turn_radps: if side == 0.0 {
                    middle.turn_radps
                } else {
                    side * brief
                },
                climb_mps: middle.climb_mps + up * change_mps,
                ..middle
            };
            let straight = Leg {
                turn_radps: 0.0,
                ..first.later(turn_s)
            };
            future.legs = [first, straight, straight];
        }
        Futures {
            origin_m: now.origin_m,
            lasting_altitude_m: errors.lasting_altitude_m.value,
            all,
        }
    }

    /// The mean motion.
    fn middle(&self) -> Leg {
        let turn = Turn::mixed(&self.turns);
        let climb = Climb::mixed(&self.climbs);
        let [at, velocity, _] = turn.at;
        Leg {
            from_s: 0.0,
            at,
            velocity,
            altitude_m: climb.at[0],
            climb_mps: climb.at[1],
            turn_radps: turn.rate_radps(),
        }
    }

    /// The pieces of a future by a row of the table: a state of the `n`th part of the belief, and two changes; and how far its altitude
    /// may be off, which is integrated, not drawn.
    fn drawn(
        &self,
        row: &[u8; 12],
        n: u8,
        lasting_m2: f32,
        brief_radps: f32,
    ) -> ([Leg; 3], Spread) {
        let [p0, p1, v0, v1, a0, a1, t1, what1, how1, t2, what2, how2] = *row;
        let (kind, turn) = picked(
            &self.turns,
            Kind::ALL,
            unit(n),
            (Kind::Steady, self.turns[0].1),
        );
        let ((), climb) = picked(&self.climbs, [(); 2], unit(a1), ((), self.climbs[0].1));
        let pair = |x: u8, y: u8| Complex::new(normal(x), normal(y));
        let [at, velocity, acceleration] = drawn(
            &turn,
            lasting_m2,
            [pair(p0, p1), pair(v0, v1), pair(a0, a1)],
        );
        let rate = (acceleration * velocity.conj()).y / velocity.squared().max(25.0);
        let first = Leg {
            from_s: 0.0,
            at,
            velocity,
            altitude_m: climb.at[0],
            climb_mps: climb.at[1],
            turn_radps: if kind.side() == 0.0 {
                0.0
            } else {
                rate.clamp(-brief_radps, brief_radps)
            },
        };
        let second = self.changed(&first, [t1, what1, how1].map(unit));
        let third = self.changed(&second, [t2, what2, how2].map(unit));
        let changes = |leg: &&Leg| leg.climb_mps != first.climb_mps;
        let until_s = [&second, &third].into_iter().find(changes);
        let until_s = until_s.map_or(f32::INFINITY, |leg| leg.from_s);
        ([first, second, third], Spread::of(&climb, until_s))
    }

    /// The piece after a piece: when, what, how, by numbers in (0, 1).
    fn changed(&self, leg: &Leg, [when, what, how]: [f32; 3]) -> Leg {
        let (turns, climbs) = (leg.turn_radps != 0.0, leg.climb_mps.abs() > CLIMBS_MPS);
        let turn_rate = if turns {
            prior::TURN_ENDS_PER_S + prior::TURN_CHANGES_SIDE_PER_S
        } else {
            prior::TURN_BEGINS_PER_S
        };
        let climb_rate = if climbs {
            prior::LEVELS_OFF_PER_S
        } else {
            prior::CLIMB_BEGINS_PER_S
        };
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
            next.turn_radps = if turns { 0.0 } else { usual };
        } else if what * all < turn_rate + climb_rate {
            let usual = libm::copysignf(
                self.bounds.climb_change_mps as f32 * (0.4 + 1.3 * share),
                side,
            );
            next.climb_mps = if climbs { 0.0 } else { usual };
        } else {
            next.velocity = next.velocity * (1.0 + prior::SPEED_CHANGE * 1.7 * side);
        }
        next
    }
}

/// The first mode up to which the weights add up to a number in (0, 1); the last one if none does.
fn picked<M: Copy, K: Copy, const N: usize>(
    modes: &[(f32, M); N],
    kinds: [K; N],
    at: f32,
    otherwise: (K, M),
) -> (K, M) {
    let mut sum = 0.0;
    let mut modes = modes.iter().zip(kinds);
    modes
        .find(|((weight, _), _)| {
            sum += weight;
            at < sum
        })
        .map_or(otherwise, |((_, mode), kind)| (kind, *mode))
}

//! The chance that a path meets the others.

use fga_belief::{FUTURES, Futures};
use fga_proof::Vec3;
use fga_proof::situation::{Obstacle, ProtectedVolume};

/// Seconds ahead.
pub const SECONDS: usize = 60;

/// Up to this time each second is looked at, later each other one.
const EACH_S: usize = 20;

/// Moments that are looked at.
pub(crate) const MOMENTS: usize = moment_at(SECONDS) + 1;

/// When a moment is, whole seconds from now.
const fn seconds_at(moment: usize) -> usize {
    if moment <= EACH_S {
        moment
    } else {
        2 * moment - EACH_S
    }
}

/// The last moment up to a time, seconds from now.
pub(crate) const fn moment_at(seconds: usize) -> usize {
    if seconds <= EACH_S {
        seconds
    } else {
        usize::midpoint(seconds, EACH_S)
    }
}

/// The same as a real number.
pub(crate) const fn time_s(moment: usize) -> f32 {
    seconds_at(moment) as f32
}

/// A path: a position each moment, metres from where the aircraft is now, over the ground.
pub(crate) type Path = [[f32; 3]; MOMENTS];

/// The inner part of a volume: its radius and half height as shares.
const INNER: (f32, f32) = (0.62, 0.7);

/// A near mid-air collision: radius and half height, metres (500 ft and 100 ft). Within a smaller volume every loss is one.
const COLLISION_M: (f32, f32) = (152.4, 30.48);

/// A volume that the aircraft is in is lost only if it is in it after this time, seconds; up to there moments are seconds.
const LEAVES_S: usize = 15;

/// How far paths may be off what the moments show of them, σ along an axis, metres: between two of them a turn bows by up to 3 m.
const BETWEEN_M: f32 = 2.0;

/// Heights count while a future is within the radius and this many σ of its place.
const NEAR_SIGMAS: f32 = 2.0;

/// What a future that is not met counts for when an aircraft is passed, where none is.
const MET: f64 = 1e-6;

/// What passes at its nearest, or is nearest now and flies alongside, may be somewhere else this much later, seconds.
const CHANGED_S: usize = 20;

/// Futures that are less than this apart look the same later, however sharp the sight, because they differ in what they have not begun: place
/// and velocity along a horizontal axis, and in altitude, metres and metres per second. In the recorded flights, seen exactly ten times a
/// second, the policy `belief` leaves 1 of 41 losses of well clear. Without this limit it leaves 5.
const SAME: [[f32; 2]; 2] = [[10.0, 2.0], [5.0, 1.0]];

/// Chances of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// To enter the protected volume of an aircraft.
    pub loss: f64,
    /// To enter the inner part of one.
    pub inner: f64,
    /// Of a near mid-air collision.
    pub collision: f64,
    /// Mean time at which the futures that are met come closest, seconds.
    pub passed_s: f64,
}

impl Chance {
    /// Of nothing.
    pub(crate) const NONE: Self = Self {
        loss: 0.0,
        inner: 0.0,
        collision: 0.0,
        passed_s: 0.0,
    };

    /// The mean of chances with these weights.
    pub(crate) fn mean(each: &[Self; FUTURES], weights: &[f32; FUTURES]) -> Self {
        let (mut sum, mut met) = (Self::NONE, 0.0);
        for (chance, weight) in each.iter().zip(weights) {
            let weight = f64::from(*weight);
            let meets = weight * (chance.loss + MET);
            met += meets;
            sum = Self {
                loss: sum.loss + weight * chance.loss,
                inner: sum.inner + weight * chance.inner,
                collision: sum.collision + weight * chance.collision,
                passed_s: sum.passed_s + meets * chance.passed_s,
            };
        }
        sum.passed_s /= met.max(f64::MIN_POSITIVE);
        sum
    }

    /// The chances with one more aircraft, whose passing counts by its share.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            loss: self.loss + other.loss,
            inner: self.inner + other.inner,
            collision: self.collision + other.collision,
            passed_s: self.passed_s + other.passed_s,
        }
    }
}

/// How a path passes a future.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    /// Horizontal distance, and the σ of both axes, metres.
    expected: [f32; 3],
    /// How far the future is above the path there, metres.
    dz_m: f32,
    /// The σ of both axes if it does something else, metres.
    other_m: [f32; 2],
}

impl Meeting {
    /// The chance that what does something else is in a volume of this radius and half height, metres.
    fn other(&self, radius_m: f32, half_m: f32) -> f32 {
        let ([away_m, ..], [beside_m, above_m]) = (self.expected, self.other_m);
        let beside = Futures::comes_within(away_m, away_m, radius_m, beside_m);
        beside * Futures::comes_within(self.dz_m, self.dz_m, half_m, above_m)
    }
}

/// How a path passes the futures of an aircraft.
struct Passes {
    /// How far each is below and above the path while it is near, by volumes, metres.
    low: [[f32; FUTURES]; 3],
    high: [[f32; FUTURES]; 3],
    /// The square of the least distance of each, m², and its moment: among all moments, and among those after a volume is left.
    nearest: [[(f32, usize); FUTURES]; 2],
}

/// How the futures may look at a later moment, each like one of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Looks {
    /// How likely each look is.
    pub(crate) chances: [f32; FUTURES],
    /// How likely each future is then, in one row for each look.
    pub(crate) futures: [[f32; FUTURES]; FUTURES],
}

impl Looks {
    pub(crate) const NONE: Self = Self {
        chances: [0.0; FUTURES],
        futures: [[0.0; FUTURES]; FUTURES],
    };

    /// The mean of a number over the looks that there may be.
    pub(crate) fn mean(&self, each: &[f64; FUTURES]) -> f64 {
        let all = each.iter().zip(&self.chances);
        all.map(|(each, chance)| each * f64::from(*chance)).sum()
    }
}

/// Positions of the futures of an aircraft at each moment, metres from the ownship's present position.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ahead {
    x: [[f32; FUTURES]; MOMENTS],
    y: [[f32; FUTURES]; MOMENTS],
    z: [[f32; FUTURES]; MOMENTS],
    weights: [f32; FUTURES],
    /// σ along a horizontal axis, metres.
    beside_m: [[f32; FUTURES]; MOMENTS],
    /// σ of the altitude, metres.
    above_m: [[f32; FUTURES]; MOMENTS],
    /// The chance that it does something else, and how far off it is then: σ of both axes, metres.
    other: f32,
    other_m: [[f32; 2]; MOMENTS],
    /// Variances as of [`Futures::known`], at least those of [`SAME`].
    known: [[f32; 2]; 2],
    radius_m: f32,
    half_height_m: f32,
}

impl Ahead {
    pub(crate) const NONE: Self = Self {
        x: [[0.0; FUTURES]; MOMENTS],
        y: [[0.0; FUTURES]; MOMENTS],
        z: [[0.0; FUTURES]; MOMENTS],
        weights: [0.0; FUTURES],
        beside_m: [[0.0; FUTURES]; MOMENTS],
        above_m: [[0.0; FUTURES]; MOMENTS],
        other: 0.0,
        other_m: [[0.0; 2]; MOMENTS],
        known: [[0.0; 2]; 2],
        radius_m: 0.0,
        half_height_m: 0.0,
    };

    /// Takes the futures of an aircraft as they will be known after some seconds: what is learned until then of how far a future is off is
    /// drawn, the rest stays its spread.
    pub(crate) fn set(
        &mut self,
        futures: &Futures,
        own_m: Vec3,
        volume: &ProtectedVolume,
        learned_s: f32,
    ) {
        let off = futures.origin_m - own_m;
        let [ox, oy, oz] = [off.x as f32, off.y as f32, off.z as f32];
        let [lasting_m2, above_m2] = (futures.lasting_m2).map(|m2| m2 + BETWEEN_M * BETWEEN_M);
        for (n, future) in futures.each().enumerate() {
            if let Some(weight) = self.weights.get_mut(n) {
                *weight = future.weight;
            }
            let rows = self.x.iter_mut().zip(&mut self.y).zip(&mut self.z);
            let rows = rows.zip(&mut self.beside_m).zip(&mut self.above_m);
            for (((((xs, ys), zs), besides), aboves), moment) in rows.zip(0..) {
                let after_s = time_s(moment);
                let [dx, dy, dz] = future.position_m(after_s);
                let [nx, ny, nz] = future.off;
                let (beside_m, beside_m2) = future.beside.parted(after_s, learned_s);
                let (up_m, up_m2) = future.above.parted(after_s, learned_s);
                for (of, number) in [
                    (xs, ox + dx + nx * beside_m),
                    (ys, oy + dy + ny * beside_m),
                    (zs, oz + dz + nz * up_m),
                    (besides, libm::sqrtf(beside_m2 + lasting_m2)),
                    (aboves, libm::sqrtf(up_m2 + above_m2)),
                ] {
                    if let Some(place) = of.get_mut(n) {
                        *place = number;
                    }
                }
            }
        }
        let known = self.known.iter_mut().zip(futures.known).zip(SAME);
        for ((known, variances), [place_m, velocity_mps]) in known {
            *known = [
                variances[0].max(place_m * place_m),
                variances[1].max(velocity_mps * velocity_mps),
            ];
        }
        self.other = futures.otherwise.share;
        for (other_m, moment) in self.other_m.iter_mut().zip(0..) {
            let after_s = (time_s(moment) - learned_s).max(0.0);
            *other_m = futures.otherwise.off_m(after_s);
        }
        self.radius_m = volume.radius_m() as f32;
        self.half_height_m = volume.half_height_m() as f32;
    }

    /// Takes an obstacle that keeps its velocity, or rests.
    pub(crate) fn set_straight(&mut self, obstacle: &Obstacle, own_m: Vec3) {
        let (off, v) = (obstacle.position_m - own_m, obstacle.velocity_mps);
        let rows = self.x.iter_mut().zip(&mut self.y).zip(&mut self.z);
        for (((xs, ys), zs), moment) in rows.zip(0..) {
            let at = off + v * f64::from(time_s(moment));
            xs.fill(at.x as f32);
            ys.fill(at.y as f32);
            zs.fill(at.z as f32);
        }
        self.weights = [0.0; FUTURES];
        self.weights[0] = 1.0;
        self.beside_m = [[BETWEEN_M; FUTURES]; MOMENTS];
        self.above_m = self.beside_m;
        self.other = 0.0;
        self.known = SAME.map(|sigmas| sigmas.map(|sigma| sigma * sigma));
        self.radius_m = obstacle.volume.radius_m() as f32;
        self.half_height_m = obstacle.volume.half_height_m() as f32;
    }

    /// The chances of a path with this aircraft, if it flies each of its futures. A volume that the path begins in may be left first, unless
    /// the path leaves its mission later.
    pub(crate) fn meets(&self, path: &Path, may_leave: bool) -> [Chance; FUTURES] {
        let (radius_m, half_m) = (self.radius_m, self.half_height_m);
        let sizes = [
            (radius_m, half_m),
            (radius_m * INNER.0, half_m * INNER.1),
            (radius_m.min(COLLISION_M.0), half_m.min(COLLISION_M.1)),
        ];
        let leaves = sizes.map(|size| may_leave && self.is_in(path, size));
        let Passes { low, high, nearest } = self.passes(path, sizes, leaves);
        let [nearest, later] = nearest;
        let mut each = [Chance::NONE; FUTURES];
        let all = nearest.iter().zip(&later).zip(&mut each);
        for (future, (((_, at), (_, later)), chance)) in all.enumerate() {
            let passing = self.passing(path, *at, future);
            let later = if leaves.contains(&true) {
                self.passing(path, *later, future)
            } else {
                passing
            };
            let changed = moment_at((seconds_at(*at) + CHANGED_S).min(SECONDS));
            let changed = self.passing(path, changed, future);
            chance.passed_s = time_s(*at).into();
            let Chance {
                loss,
                inner,
                collision,
                ..
            } = chance;
            let all = [loss, inner, collision].into_iter().zip(&low);
            let all = all.zip(&high).zip(sizes).zip(leaves);
            for ((((chance, low), high), (radius_m, half_m)), leaves) in all {
                let (Some(low), Some(high)) = (low.get(future), high.get(future)) else {
                    continue;
                };
                let passing = if leaves { &later } else { &passing };
                let [away_m, beside_m, above_m] = passing.expected;
                let (low_m, high_m) = (low.min(passing.dz_m), high.max(passing.dz_m));
                let beside = Futures::comes_within(away_m, away_m, radius_m, beside_m);
                let above = Futures::comes_within(low_m, high_m, half_m, above_m);
                let other = passing.other(radius_m, half_m);
                let other = other.max(changed.other(radius_m, half_m));
                *chance = ((1.0 - self.other) * beside * above + self.other * other).into();
            }
        }
        each
    }

    /// How a path passes each future.
    fn passes(&self, path: &Path, sizes: [(f32, f32); 3], leaves: [bool; 3]) -> Passes {
        let mut low = [[f32::MAX; FUTURES]; 3];
        let mut high = [[f32::MIN; FUTURES]; 3];
        // The nearest moment of all; and, where the path may leave a volume first, the nearest one after that.
        let looks = if leaves.contains(&true) { 2 } else { 1 };
        let mut nearest = [[(f32::MAX, 0_usize); FUTURES]; 2];
        let rows = self.x.iter().zip(&self.y).zip(&self.z).zip(&self.beside_m);
        for (((((xs, ys), zs), sigmas), [x, y, z]), moment) in rows.zip(path).zip(0..) {
            let mut away = [0.0; FUTURES];
            for ((away, fx), fy) in away.iter_mut().zip(xs).zip(ys) {
                let (dx, dy) = (fx - x, fy - y);
                *away = dx * dx + dy * dy;
            }
            let is_near = away.iter().zip(sigmas).any(|(away, sigma)| {
                let reach_m = self.radius_m + NEAR_SIGMAS * sigma;
                *away < reach_m * reach_m
            });
            let sizes = if is_near { sizes.as_slice() } else { &[] };
            for (((low, high), (radius_m, _)), leaves) in
                low.iter_mut().zip(&mut high).zip(sizes).zip(leaves)
            {
                if leaves && moment < LEAVES_S {
                    continue;
                }
                let rows = low.iter_mut().zip(high).zip(&away).zip(zs).zip(sigmas);
                for ((((low, high), away), fz), sigma) in rows {
                    let dz = fz - z;
                    let reach_m = radius_m + NEAR_SIGMAS * sigma;
                    let is_near = *away < reach_m * reach_m;
                    *low = if is_near { low.min(dz) } else { *low };
                    *high = if is_near { high.max(dz) } else { *high };
                }
            }
            for (nearest, from) in nearest.iter_mut().zip([0, LEAVES_S]).take(looks) {
                for ((least, at), away) in nearest.iter_mut().zip(&away) {
                    if moment >= from && *away < *least {
                        (*least, *at) = (*away, moment);
                    }
                }
            }
        }
        Passes { low, high, nearest }
    }

    /// How the futures may look at one of the first moments, which are a second apart. What is known then of place and velocity is as sharp as what
    /// is known now.
    pub(crate) fn looks_after(&self, after: usize, looks: &mut Looks) {
        let axes = [&self.x, &self.y, &self.z];
        let [beside, above] = self.known;
        let Looks { chances, futures } = looks;
        for (look, row) in futures.iter_mut().enumerate() {
            for (future, like) in row.iter_mut().enumerate() {
                let mut apart = 0.0;
                for (of, [place_m2, velocity_m2ps2]) in
                    axes.into_iter().zip([beside, beside, above])
                {
                    let apart_m = |moment| value(of, moment, future) - value(of, moment, look);
                    let place_m = apart_m(after);
                    // Of the second before: what begins then is not known yet.
                    let velocity_mps = place_m - apart_m(after.saturating_sub(1));
                    apart +=
                        place_m * place_m / place_m2 + velocity_mps * velocity_mps / velocity_m2ps2;
                }
                // The likelihood exp(-d² / 2), with the error of what happens and that of what is known of it.
                *like = libm::expf(-apart / 4.0);
            }
        }
        // A future looks like any of them, in proportion; what it looks like says how likely each is (Bayes).
        let mut sums = [0.0; FUTURES];
        for (row, sum) in futures.iter().zip(&mut sums) {
            *sum = row.iter().sum::<f32>();
        }
        for (row, chance) in futures.iter_mut().zip(chances) {
            for ((like, sum), weight) in row.iter_mut().zip(&sums).zip(&self.weights) {
                *like *= weight / sum.max(f32::MIN_POSITIVE);
            }
            *chance = row.iter().sum::<f32>();
            for like in row {
                *like /= chance.max(f32::MIN_POSITIVE);
            }
        }
    }

    /// Weights of the futures.
    pub(crate) const fn weights(&self) -> &[f32; FUTURES] {
        &self.weights
    }

    /// How a path passes a future near a moment.
    fn passing(&self, path: &Path, at: usize, future: usize) -> Meeting {
        let [beside_m, above_m] = [&self.beside_m, &self.above_m].map(|of| value(of, at, future));
        let other_m = self.other_m.get(at).copied().unwrap_or_default();
        let (away_m, dz_m) = self.closest_m(path, at, future);
        Meeting {
            expected: [away_m, beside_m, above_m],
            dz_m,
            other_m: [
                libm::hypotf(beside_m, other_m[0]),
                libm::hypotf(above_m, other_m[1]),
            ],
        }
    }

    /// Whether a path begins in a volume of this radius and half height, metres, as most futures have it.
    fn is_in(&self, path: &Path, (radius_m, half_m): (f32, f32)) -> bool {
        let [x, y, z] = path.first().copied().unwrap_or_default();
        let [xs, ys, zs] = [&self.x, &self.y, &self.z].map(|rows| rows.iter().flatten());
        let places = xs.zip(ys).zip(zs).zip(&self.weights);
        let inside = places.filter(|(((fx, fy), fz), _)| {
            let (dx, dy) = (*fx - x, *fy - y);
            dx * dx + dy * dy < radius_m * radius_m && (*fz - z).abs() < half_m
        });
        inside.map(|(_, weight)| weight).sum::<f32>() > 0.5
    }

    /// The least horizontal distance of a path from a future, which is near at a moment, and how far the future is above it there, metres:
    /// between moments both fly straight.
    fn closest_m(&self, path: &Path, at: usize, future: usize) -> (f32, f32) {
        let off = |moment: usize| {
            let own = path.get(moment).copied().unwrap_or_default();
            let axes = [&self.x, &self.y, &self.z].into_iter().zip(own);
            let mut off = [0.0; 3];
            for (off, (of, own)) in off.iter_mut().zip(axes) {
                *off = value(of, moment, future) - own;
            }
            off
        };
        let [x, y, z] = off(at);
        let mut least = (x * x + y * y, z);
        for other in [at.saturating_sub(1), (at + 1).min(MOMENTS - 1)] {
            let [to_x, to_y, to_z] = off(other);
            let (dx, dy) = (to_x - x, to_y - y);
            let share = (-(x * dx + y * dy) / (dx * dx + dy * dy).max(1e-6)).clamp(0.0, 1.0);
            let (x, y) = (x + share * dx, y + share * dy);
            if x * x + y * y < least.0 {
                least = (x * x + y * y, z + share * (to_z - z));
            }
        }
        (libm::sqrtf(least.0), least.1)
    }
}

/// A number of a future at a moment.
fn value(of: &[[f32; FUTURES]; MOMENTS], moment: usize, future: usize) -> f32 {
    let row = of.get(moment).and_then(|row| row.get(future));
    row.copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Futures that are alike, each as likely, known as well as can be.
    fn alike() -> Ahead {
        let mut ahead = Ahead::NONE;
        ahead.weights = [1.0 / FUTURES as f32; FUTURES];
        ahead.known = SAME.map(|sigmas| sigmas.map(|sigma| sigma * sigma));
        ahead
    }

    /// Of 28 futures one goes aside at 20 m/s, one at 0.5 m/s: after five seconds the first is known from all others, the second from none.
    #[test]
    fn what_is_begun_is_learned_and_what_is_hardly_apart_is_not() {
        let mut ahead = alike();
        for (ys, second) in ahead.y.iter_mut().zip(0_u8..) {
            ys[0] = 20.0 * f32::from(second);
            ys[1] = 0.5 * f32::from(second);
        }
        let mut looks = Looks::NONE;
        ahead.looks_after(5, &mut looks);
        let Looks { chances, futures } = looks;
        for row in futures {
            assert!((row.iter().sum::<f32>() - 1.0).abs() < 1e-4);
        }
        for future in 0..FUTURES {
            let rows = futures.iter().zip(chances);
            let sum: f32 = rows.map(|(row, chance)| chance * row[future]).sum();
            assert!(
                (sum - ahead.weights[future]).abs() < 1e-4,
                "what is learned must keep what is believed"
            );
        }
        let looks = futures;
        assert!(looks[0][0] > 0.99 && looks[2][0] < 0.01);
        assert!((looks[2][1] / looks[2][3] - 1.0).abs() < 0.1);
    }

    /// What begins in the second that is looked at is not known yet.
    #[test]
    fn what_begins_now_is_not_learned_yet() {
        let mut ahead = alike();
        for (ys, second) in ahead.y.iter_mut().zip(0_u8..) {
            ys[0] = 20.0 * f32::from(second.saturating_sub(5));
        }
        let mut looks = Looks::NONE;
        ahead.looks_after(5, &mut looks);
        let looks = looks.futures;
        assert!((looks[1][0] / looks[1][1] - 1.0).abs() < 1e-3);
    }

    #[test]
    fn an_aircraft_is_passed_when_those_futures_are_that_are_met() {
        let mut each = [Chance::NONE; FUTURES];
        (each[0].loss, each[0].passed_s) = (0.5, 40.0);
        let weights = alike().weights;
        let mean = Chance::mean(&each, &weights);
        assert!((mean.passed_s - 40.0).abs() < 0.01, "{}", mean.passed_s);
        let none = Chance::mean(&[Chance::NONE; FUTURES], &weights);
        assert!(none.passed_s == 0.0);
    }

    /// What the moments show a metre outside of it may be inside between them. An earlier version called the chance of that none, and flew
    /// ways back unproven through the edges of masts.
    #[test]
    fn a_path_along_the_edge_of_what_is_exact_may_enter_it() {
        let path: Path = core::array::from_fn(|moment| [20.0 * time_s(moment), 0.0, 0.0]);
        let loss = |outside_m: f64| {
            let volume = ProtectedVolume::Cylinder {
                radius_m: 30.0,
                half_height_m: 100.0,
            };
            let mast_m = Vec3::new(300.0, 30.0 + outside_m, 0.0);
            let mut ahead = Ahead::NONE;
            ahead.set_straight(
                &Obstacle::straight(1, mast_m, Vec3::ZERO, volume),
                Vec3::ZERO,
            );
            Chance::mean(&ahead.meets(&path, true), &ahead.weights).loss
        };
        assert!(loss(-20.0) > 0.99 && loss(12.0) < 1e-4);
        assert!((0.2..0.5).contains(&loss(1.0)), "{}", loss(1.0));
    }

    /// All futures of an aircraft fly along 800 m to the side, so they are nearest now. None of them turns towards the own aircraft.
    #[test]
    fn an_aircraft_alongside_may_do_something_else() {
        let mut ahead = alike();
        (ahead.radius_m, ahead.half_height_m) = (609.6, 76.2);
        ahead.x = [[800.0; FUTURES]; MOMENTS];
        let chance = |ahead: &Ahead| {
            let each = ahead.meets(&[[0.0; 3]; MOMENTS], true);
            Chance::mean(&each, &ahead.weights).loss
        };
        assert!(chance(&ahead) < 1e-6);
        ahead.other = 0.02;
        for (other_m, second) in ahead.other_m.iter_mut().zip(0_u8..) {
            *other_m = [10.0 * f32::from(second), f32::from(second)];
        }
        assert!(chance(&ahead) > 1e-3, "{}", chance(&ahead));
    }
}

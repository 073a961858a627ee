//! The chance that a path meets the others.

use fga_belief::future::Spread;
use fga_belief::{FUTURES, Futures};
use fga_proof::Vec3;
use fga_proof::situation::{Obstacle, ProtectedVolume};

/// Seconds ahead.
pub const SECONDS: usize = 60;

/// A path: a position each second, metres from where the aircraft is now, over the ground.
pub(crate) type Path = [[f32; 3]; SECONDS + 1];

/// The inner part of a volume: its radius and half height as shares.
const INNER: (f32, f32) = (0.62, 0.7);

/// A near mid-air collision: radius and half height, metres (500 ft and 100 ft). Within a smaller volume every loss is one.
const COLLISION_M: (f32, f32) = (152.4, 30.48);

/// A volume that the aircraft is in is lost only if it is in it after this time, seconds, or again.
const LEAVES_S: usize = 15;

/// Heights count while a future is within the radius and this many σ of its place.
const NEAR_SIGMAS: f32 = 2.0;

/// Chances of a path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Chance {
    /// To enter the protected volume of an aircraft.
    pub loss: f64,
    /// To enter the inner part of one.
    pub inner: f64,
    /// Of a near mid-air collision.
    pub collision: f64,
    /// When the last aircraft is at its closest, on average, seconds.
    pub passed_s: f64,
}

impl Chance {
    /// The chances with one more aircraft.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            loss: self.loss + other.loss,
            inner: self.inner + other.inner,
            collision: self.collision + other.collision,
            passed_s: self.passed_s.max(other.passed_s),
        }
    }
}

/// The positions of an aircraft's futures, second by second, metres from where the own aircraft is now.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ahead {
    x: [[f32; FUTURES]; SECONDS + 1],
    y: [[f32; FUTURES]; SECONDS + 1],
    z: [[f32; FUTURES]; SECONDS + 1],
    weights: [f32; FUTURES],
    /// σ along a horizontal axis, metres.
    beside_m: [[f32; FUTURES]; SECONDS + 1],
    above: [Spread; FUTURES],
    /// Variance of the lasting error of the altitude, m².
    lasting_above_m2: f32,
    radius_m: f32,
    half_height_m: f32,
}

impl Ahead {
    pub(crate) const NONE: Self = Self {
        x: [[0.0; FUTURES]; SECONDS + 1],
        y: [[0.0; FUTURES]; SECONDS + 1],
        z: [[0.0; FUTURES]; SECONDS + 1],
        weights: [0.0; FUTURES],
        beside_m: [[0.0; FUTURES]; SECONDS + 1],
        above: [Spread::NONE; FUTURES],
        lasting_above_m2: 0.0,
        radius_m: 0.0,
        half_height_m: 0.0,
    };

    /// Takes the futures of an aircraft.
    pub(crate) fn set(&mut self, futures: &Futures, own_m: Vec3, volume: &ProtectedVolume) {
        let off = futures.origin_m - own_m;
        let [ox, oy, oz] = [off.x as f32, off.y as f32, off.z as f32];
        let rows = self.x.iter_mut().zip(&mut self.y).zip(&mut self.z);
        for (((xs, ys), zs), second) in rows.zip(0_u8..) {
            let row = xs.iter_mut().zip(ys).zip(zs).zip(&futures.all);
            for (((x, y), z), future) in row {
                let [dx, dy, dz] = future.position_m(f32::from(second));
                (*x, *y, *z) = (ox + dx, oy + dy, oz + dz);
            }
        }
        for (weight, future) in self.weights.iter_mut().zip(&futures.all) {
            *weight = future.weight;
        }
        for (above, future) in self.above.iter_mut().zip(&futures.all) {
            *above = future.above;
        }
        let [lasting_m2, above_m2] = futures.lasting_m2;
        for (sigmas, second) in self.beside_m.iter_mut().zip(0_u8..) {
            for (sigma, future) in sigmas.iter_mut().zip(&futures.all) {
                let variance = future.beside.variance(f32::from(second));
                *sigma = libm::sqrtf(variance + lasting_m2);
            }
        }
        self.lasting_above_m2 = above_m2;
        self.radius_m = volume.radius_m() as f32;
        self.half_height_m = volume.half_height_m() as f32;
    }

    /// Takes an obstacle that keeps its velocity, or rests.
    pub(crate) fn set_straight(&mut self, obstacle: &Obstacle, own_m: Vec3) {
        let (off, v) = (obstacle.position_m - own_m, obstacle.velocity_mps);
        let rows = self.x.iter_mut().zip(&mut self.y).zip(&mut self.z);
        for (((xs, ys), zs), second) in rows.zip(0_u8..) {
            let at = off + v * f64::from(second);
            xs.fill(at.x as f32);
            ys.fill(at.y as f32);
            zs.fill(at.z as f32);
        }
        self.weights = [0.0; FUTURES];
        self.weights[0] = 1.0;
        self.beside_m = [[0.0; FUTURES]; SECONDS + 1];
        self.above = [Spread::NONE; FUTURES];
        self.lasting_above_m2 = 0.0;
        self.radius_m = obstacle.volume.radius_m() as f32;
        self.half_height_m = obstacle.volume.half_height_m() as f32;
    }

    /// The chances of a path with this aircraft. A volume that it begins in may be left first, unless the path leaves its mission later.
    pub(crate) fn meets(&self, path: &Path, may_leave: bool) -> Chance {
        let (radius_m, half_m) = (self.radius_m, self.half_height_m);
        let sizes = [
            (radius_m, half_m),
            (radius_m * INNER.0, half_m * INNER.1),
            (radius_m.min(COLLISION_M.0), half_m.min(COLLISION_M.1)),
        ];
        let leaves = sizes.map(|size| may_leave && self.is_in(path, size));
        let mut low = [[f32::MAX; FUTURES]; 3];
        let mut high = [[f32::MIN; FUTURES]; 3];
        // The nearest second of all; and, where the path may leave a volume first, the nearest one after that.
        let looks = if leaves.contains(&true) { 2 } else { 1 };
        let mut nearest = [[(f32::MAX, 0_usize); FUTURES]; 2];
        let rows = self.x.iter().zip(&self.y).zip(&self.z).zip(&self.beside_m);
        for (((((xs, ys), zs), sigmas), [x, y, z]), second) in rows.zip(path).zip(0..) {
            let mut away = [0.0; FUTURES];
            for ((away, fx), fy) in away.iter_mut().zip(xs).zip(ys) {
                let (dx, dy) = (fx - x, fy - y);
                *away = dx * dx + dy * dy;
            }
            for (((low, high), (radius_m, _)), leaves) in
                low.iter_mut().zip(&mut high).zip(sizes).zip(leaves)
            {
                if leaves && second < LEAVES_S {
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
                    if second >= from && *away < *least {
                        (*least, *at) = (*away, second);
                    }
                }
            }
        }
        let [nearest, later] = nearest;
        let mut chances = [0.0_f64; 3];
        let mut passed_s = 0.0;
        for (future, ((_, at), (_, later))) in nearest.iter().zip(&later).enumerate() {
            let weight = self.weights.get(future).copied().unwrap_or(0.0);
            passed_s += weight * *at as f32;
            let passing = self.passing(path, *at, future);
            let later = if looks == 2 {
                self.passing(path, *later, future)
            } else {
                passing
            };
            let all = chances
                .iter_mut()
                .zip(&low)
                .zip(&high)
                .zip(sizes)
                .zip(leaves);
            for ((((chance, low), high), (radius_m, half_m)), leaves) in all {
                let (Some(low), Some(high)) = (low.get(future), high.get(future)) else {
                    continue;
                };
                if low <= high {
                    let [away_m, beside_m, above_m] = if leaves { later } else { passing };
                    let beside = Futures::comes_within(away_m, away_m, radius_m, beside_m);
                    let above = Futures::comes_within(*low, *high, half_m, above_m);
                    *chance += f64::from(weight * (beside * above));
                }
            }
        }
        let [loss, inner, collision] = chances;
        Chance {
            loss,
            inner,
            collision,
            passed_s: passed_s.into(),
        }
    }

    /// How far a path passes a future beside, near a second, and the σ of both axes there, metres: distance, σ beside, σ above.
    fn passing(&self, path: &Path, at: usize, future: usize) -> [f32; 3] {
        let spread = self.above.get(future).copied().unwrap_or(Spread::NONE);
        let above_m = libm::sqrtf(spread.variance(at as f32) + self.lasting_above_m2);
        [
            self.closest_m(path, at, future),
            value(&self.beside_m, at, future),
            above_m,
        ]
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

    /// The least horizontal distance of a path from a future, which is near at a second, metres: between seconds both fly straight.
    fn closest_m(&self, path: &Path, at: usize, future: usize) -> f32 {
        let off = |second: usize| {
            let [x, y, _] = path.get(second).copied().unwrap_or_default();
            let (fx, fy) = (
                value(&self.x, second, future),
                value(&self.y, second, future),
            );
            (fx - x, fy - y)
        };
        let (x, y) = off(at);
        let mut least = x * x + y * y;
        for other in [at.saturating_sub(1), (at + 1).min(SECONDS)] {
            let (dx, dy) = (off(other).0 - x, off(other).1 - y);
            let share = (-(x * dx + y * dy) / (dx * dx + dy * dy).max(1e-6)).clamp(0.0, 1.0);
            let (x, y) = (x + share * dx, y + share * dy);
            least = least.min(x * x + y * y);
        }
        libm::sqrtf(least)
    }
}

/// A number of a future at a second.
fn value(of: &[[f32; FUTURES]; SECONDS + 1], second: usize, future: usize) -> f32 {
    let row = of.get(second).and_then(|row| row.get(future));
    row.copied().unwrap_or(0.0)
}

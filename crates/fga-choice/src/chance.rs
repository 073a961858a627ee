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

/// A near mid-air collision: radius and half height, metres (500 ft and 100 ft), with 20 m for the step of a second. Within a smaller volume
/// every loss is one.
const COLLISION_M: (f32, f32) = (172.4, 30.48);

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
    spreads: [Spread; FUTURES],
    lasting_altitude_m: f32,
    radius_m: f32,
    half_height_m: f32,
}

impl Ahead {
    pub(crate) const NONE: Self = Self {
        x: [[0.0; FUTURES]; SECONDS + 1],
        y: [[0.0; FUTURES]; SECONDS + 1],
        z: [[0.0; FUTURES]; SECONDS + 1],
        weights: [0.0; FUTURES],
        spreads: [Spread::NONE; FUTURES],
        lasting_altitude_m: 0.0,
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
        for (spread, future) in self.spreads.iter_mut().zip(&futures.all) {
            *spread = future.spread;
        }
        self.lasting_altitude_m = futures.lasting_altitude_m;
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
        self.spreads = [Spread::NONE; FUTURES];
        self.lasting_altitude_m = 0.0;
        self.radius_m = obstacle.volume.radius_m() as f32;
        self.half_height_m = obstacle.volume.half_height_m() as f32;
    }

    /// The chances of a path with this aircraft.
    pub(crate) fn meets(&self, path: &Path) -> Chance {
        let (radius_m, half_m) = (self.radius_m, self.half_height_m);
        let sizes = [
            (radius_m, half_m),
            (radius_m * INNER.0, half_m * INNER.1),
            (radius_m.min(COLLISION_M.0), half_m.min(COLLISION_M.1)),
        ];
        let squares = sizes.map(|(radius, _)| radius * radius);
        let mut low = [[f32::MAX; FUTURES]; 3];
        let mut high = [[f32::MIN; FUTURES]; 3];
        let mut nearest = [(f32::MAX, 0.0); FUTURES];
        let rows = self.x.iter().zip(&self.y).zip(&self.z).zip(path);
        for ((((xs, ys), zs), [x, y, z]), second) in rows.zip(0_u8..) {
            let mut away = [0.0; FUTURES];
            for ((away, fx), fy) in away.iter_mut().zip(xs).zip(ys) {
                let (dx, dy) = (fx - x, fy - y);
                *away = dx * dx + dy * dy;
            }
            for ((low, high), square) in low.iter_mut().zip(&mut high).zip(squares) {
                for (((low, high), away), fz) in low.iter_mut().zip(high).zip(&away).zip(zs) {
                    let dz = fz - z;
                    let is_inside = *away < square;
                    *low = if is_inside { low.min(dz) } else { *low };
                    *high = if is_inside { high.max(dz) } else { *high };
                }
            }
            for ((least, at), away) in nearest.iter_mut().zip(&away) {
                if *away < *least {
                    (*least, *at) = (*away, f32::from(second));
                }
            }
        }
        // As well as an altitude is known when it is nearest.
        let lasting_m2 = self.lasting_altitude_m * self.lasting_altitude_m;
        let mut sigmas_m = [0.0; FUTURES];
        for ((sigma, spread), (_, at_s)) in sigmas_m.iter_mut().zip(&self.spreads).zip(&nearest) {
            *sigma = libm::sqrtf(spread.variance(*at_s) + lasting_m2);
        }
        let mut chances = [0.0_f64; 3];
        for (((chance, low), high), (_, half)) in chances.iter_mut().zip(&low).zip(&high).zip(sizes)
        {
            let each = low.iter().zip(high).zip(sigmas_m).zip(self.weights);
            for (((low, high), sigma_m), weight) in each {
                if low <= high {
                    let meets = Futures::meets(*low, *high, half, sigma_m);
                    *chance += f64::from(weight * meets);
                }
            }
        }
        let [loss, inner, collision] = chances;
        let passed = nearest
            .iter()
            .zip(self.weights)
            .map(|((_, at), weight)| at * weight);
        Chance {
            loss,
            inner,
            collision,
            passed_s: passed.sum::<f32>().into(),
        }
    }
}

//! Many obstacles at once, as rows and as columns.

use fga::Vec3;
use fga::certificate::Hazard;
use fga::situation::Columns;
use fga::situation::{Obstacle, Ownship, ProtectedVolume};
use fga_campaign::encounters::{Random, Range};

/// Protected radius, metres.
const RADIUS_M: f64 = 30.0;

/// Half of the width of the drawn crowds, metres.
const HALF_M: f64 = 5e3;

/// The aircraft of Table 4 at the origin, level along +x.
pub const fn ownship() -> Ownship {
    Ownship {
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 15.0,
    }
}

/// Obstacles that fly in every direction, within 10 km and 1 km of altitude.
#[derive(Debug, Clone, PartialEq)]
pub struct Crowd {
    /// One record per obstacle.
    pub rows: Vec<Obstacle>,
    id: Vec<u32>,
    numbers: [Vec<f64>; 7],
}

impl Crowd {
    /// The obstacles in still air.
    pub fn hazards(&self) -> Vec<Hazard> {
        let hazard = |row: &Obstacle| Hazard::new(row, Vec3::ZERO, 0.0);
        self.rows.iter().map(hazard).collect()
    }

    /// Unfiltered: about one in a hundred threatens.
    pub fn drawn(count: usize, seed: u64) -> Self {
        Self::keep(count, seed, HALF_M, |_| true)
    }

    /// Without those that would come closer than 60 m.
    pub fn in_the_clear(count: usize, seed: u64) -> Self {
        Self::clear_by(count, seed, 2.0 * RADIUS_M, HALF_M)
    }

    /// Up to `half_m` metres to each side, without those that would come closer than `clear_m` metres.
    pub fn clear_by(count: usize, seed: u64, clear_m: f64, half_m: f64) -> Self {
        Self::keep(count, seed, half_m, |obstacle| {
            let (r, v) = (
                obstacle.position_m,
                ownship().velocity_mps() - obstacle.velocity_mps,
            );
            let closest_s = (r.dot(v) / v.length_squared().max(1e-9)).max(0.0);
            (r - v * closest_s).length() > clear_m
        })
    }

    fn keep(count: usize, seed: u64, half_m: f64, wanted: impl Fn(&Obstacle) -> bool) -> Self {
        let mut random = Random::new(seed, 0);
        let mut within = |from: f64, to: f64| random.within(Range(from, to));
        let volume = ProtectedVolume::Sphere { radius_m: RADIUS_M };
        let mut rows = Vec::with_capacity(count);
        while rows.len() < count {
            let id = u32::try_from(rows.len()).unwrap_or(u32::MAX);
            let (x, y) = (within(-half_m, half_m), within(-half_m, half_m));
            let position = Vec3::new(x, y, within(-500.0, 500.0));
            let velocity = Vec3::new(within(-40.0, 40.0), within(-40.0, 40.0), within(-5.0, 5.0));
            let obstacle = Obstacle::straight(id, position, velocity, volume);
            if wanted(&obstacle) {
                rows.push(obstacle);
            }
        }
        let column = |of: fn(&Obstacle) -> f64| rows.iter().map(of).collect();
        Self {
            id: rows.iter().map(|o| o.id).collect(),
            numbers: [
                column(|o| o.position_m.x),
                column(|o| o.position_m.y),
                column(|o| o.position_m.z),
                column(|o| o.velocity_mps.x),
                column(|o| o.velocity_mps.y),
                column(|o| o.velocity_mps.z),
                column(|o| o.volume.radius_m()),
            ],
            rows,
        }
    }

    /// The same, one slice per quantity.
    pub fn columns(&self) -> Columns<'_> {
        let [x_m, y_m, z_m, vx_mps, vy_mps, vz_mps, radius_m] = &self.numbers;
        Columns {
            id: &self.id,
            x_m,
            y_m,
            z_m,
            vx_mps,
            vy_mps,
            vz_mps,
            radius_m,
            half_height_m: None,
            uncertainty: None,
            movement: None,
        }
    }
}

//! Algorithm 2 as printed; corrected: [`crate::grid`].

use fga::Vec3;
use fga::angle::direction;
use fga::certificate::Hazard;
use fga::situation::Ownship;

/// The printed grid: `k_1` courses and `j_1` climb angles, absolute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiteralGrid {
    /// `φ_range`, radians.
    pub heading_range_rad: f64,
    /// `θ_range`, radians.
    pub pitch_range_rad: f64,
    /// `k_1`.
    pub heading_count: u16,
    /// `j_1`.
    pub pitch_count: u16,
    /// `η_ψ`, per radian.
    pub heading_cost: f64,
    /// `η_θ`, per radian.
    pub pitch_cost: f64,
}

impl Default for LiteralGrid {
    /// As many directions as in the corrected grid.
    fn default() -> Self {
        Self {
            heading_range_rad: 135.0_f64.to_radians(),
            pitch_range_rad: 15.0_f64.to_radians(),
            heading_count: 49,
            pitch_count: 19,
            heading_cost: 0.2,
            pitch_cost: 0.5,
        }
    }
}

/// A direction of the printed grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiteralEntry {
    /// φ, radians: −range + range/`k_1` · k (line 13).
    pub course_rad: f64,
    /// θ, radians (line 14).
    pub climb_rad: f64,
    /// The least of the `d_l` (line 18); infinite without obstacles.
    pub separation: f64,
    /// `η_ψ` (φ − `φ_ori`) + `η_θ` (θ − `θ_ori`), with its sign (line 20).
    pub cost: f64,
    /// Whether the printed separation is at least each volume's radius.
    pub marked: bool,
}

/// Line 18: |`V_ut` × r| / |r|. It is a speed, not a distance, and ignores the obstacle's motion.
pub fn separation(velocity_mps: Vec3, offset_m: Vec3) -> f64 {
    velocity_mps.cross(offset_m).length() / offset_m.length()
}

impl LiteralGrid {
    /// Every direction of the grid, in the order of the loops.
    pub fn table<'a>(
        &'a self,
        ownship: &'a Ownship,
        obstacles: &'a [Hazard],
    ) -> impl Iterator<Item = LiteralEntry> + 'a {
        let place = |range: f64, count: u16, index: u16| {
            -range + range / f64::from(count) * f64::from(index)
        };
        (1..=self.heading_count)
            .flat_map(move |k| (1..=self.pitch_count).map(move |j| (k, j)))
            .map(move |(k, j)| {
                let course_rad = place(self.heading_range_rad, self.heading_count, k);
                let climb_rad = place(self.pitch_range_rad, self.pitch_count, j);
                let velocity_mps = direction(course_rad, climb_rad) * ownship.airspeed_mps;
                let each = |obstacle: &Hazard| {
                    let offset_m = obstacle.position_m - ownship.position_m;
                    separation(velocity_mps, offset_m)
                };
                LiteralEntry {
                    course_rad,
                    climb_rad,
                    separation: obstacles.iter().map(each).fold(f64::INFINITY, f64::min),
                    cost: self.heading_cost * (course_rad - ownship.course_rad)
                        + self.pitch_cost * (climb_rad - ownship.climb_rad),
                    marked: obstacles
                        .iter()
                        .all(|obstacle| each(obstacle) >= obstacle.volume.radius_m()),
                }
            })
    }
}

/// The marked direction of least cost (§3.5 (1) to (3)); without a marked one, the direction of least
/// cost (line 23). `None` for an empty grid.
pub fn select(grid: &LiteralGrid, ownship: &Ownship, obstacles: &[Hazard]) -> Option<LiteralEntry> {
    grid.table(ownship, obstacles).reduce(|best, entry| {
        let better = match (entry.marked, best.marked) {
            (true, false) => true,
            (false, true) => false,
            _ => entry.cost < best.cost,
        };
        if better { entry } else { best }
    })
}

//! Is anything near the straight line ahead? Nearly every cycle ends with this test.
//!
//! Conservative: an obstacle that passes the test cannot come closer than its volume on the line ahead. Of columns most groups
//! pass clear in the plane alone, without a square root or a branch per obstacle, so that the compiler makes vector code of it;
//! the obstacles of the others are tested as rows.

use crate::situation::{Columns, Obstacle, Obstacles};
use fga_proof::Vec3;

/// Obstacles of a group: four vectors of four, or two of eight.
const LANES: usize = 16;

/// One quantity of a group.
type Lanes = [f64; LANES];

/// More than rounding takes from a distance in the plane out to 1,000 km, metres: what passes clear in the plane passes
/// clear in space, to the last bit.
const ROUNDING_M: f64 = 0.1;

/// Added to the distance that an aircraft can cover, metres.
const NEAR_M: f64 = 200.0;

/// The line ahead of the aircraft and the clear space around it, over the ground.
#[derive(Debug, Clone, Copy)]
pub struct LineAhead {
    /// Position of the aircraft, metres, local frame.
    pub position_m: Vec3,
    /// Its velocity over the ground, metres per second.
    pub velocity_mps: Vec3,
    /// Surveillance radius, metres: obstacles farther away are not considered.
    pub surveillance_radius_m: f64,
    /// Distance kept beyond every volume, metres.
    pub margin_m: f64,
    /// Standard deviations that widen an uncertain volume.
    pub sigmas: f64,
    /// Horizon of the separation, seconds.
    pub horizon_s: f64,
}

impl LineAhead {
    /// Whether every obstacle stays clear of the line, or is out of surveillance.
    pub fn is_clear_of(&self, obstacles: &Obstacles<'_>) -> bool {
        match obstacles {
            Obstacles::Columns(columns) if columns.movement.is_none() => {
                self.is_clear_of_columns(columns)
            }
            _ => obstacles.iter().all(|row| !self.may_meet(&row)),
        }
    }

    /// Whether an obstacle may come within its volume on the line, or near the aircraft if it may turn.
    #[inline(never)]
    pub fn may_meet(&self, row: &Obstacle) -> bool {
        let offset = row.position_m - self.position_m;
        let velocity = self.velocity_mps - row.velocity_mps;
        let distance = offset.length_squared();
        if distance > square(self.surveillance_radius_m) {
            return false;
        }
        let speed_mps = self.velocity_mps.length() + row.velocity_mps.length();
        if row.movement.bounds().is_some() && libm::sqrt(distance) <= self.near_m(row, speed_mps) {
            return true;
        }
        // Closer than d while it closes, (r² − d²) V_r² < (r · V_r)² (Eq. 4 without its arc sine), or there already. True for
        // values that are not numbers.
        let outside = distance - square(self.reach_m(row));
        let along = offset.dot(velocity);
        let clear = along <= 0.0 || outside * velocity.length_squared() > along * along;
        !(outside > 0.0 && clear)
    }

    /// Distance on the line at which an obstacle may be met, metres.
    pub fn reach_m(&self, row: &Obstacle) -> f64 {
        let volume_m = row.volume.radius_m() + row.volume.half_height_m();
        let uncertainty = row.uncertainty;
        let growth_m = uncertainty.position_m + uncertainty.velocity_mps * self.horizon_s;
        volume_m + self.sigmas * growth_m + self.margin_m
    }

    /// Distance at which an aircraft could come near within the horizon, whatever its turns, at the sum of the speeds,
    /// metres.
    pub fn near_m(&self, row: &Obstacle, speed_mps: f64) -> f64 {
        speed_mps * self.horizon_s + self.reach_m(row) - self.margin_m + NEAR_M
    }

    fn is_clear_of_columns(&self, columns: &Columns<'_>) -> bool {
        let groups =
            |column| -> core::slice::Iter<'_, Lanes> { <[f64]>::as_chunks(column).0.iter() };
        let pairs = |(one, other)| groups(one).zip(groups(other));
        // A sphere keeps clear as far above its middle as beside it.
        let half_height_m = columns.half_height_m.unwrap_or(columns.radius_m);
        let places = pairs((columns.x_m, columns.y_m)).zip(pairs((columns.vx_mps, columns.vy_mps)));
        let mut growths = columns.uncertainty.map(pairs);
        let may_meet = |place: usize| columns.get(place).is_some_and(|row| self.may_meet(&row));
        let mut from = 0;
        for (place, size) in places.zip(pairs((columns.radius_m, half_height_m))) {
            let growth = growths.as_mut().and_then(Iterator::next);
            let near = self.near_in_plane(place, size, growth);
            let are_near = near.iter().any(|near| *near != 0);
            let mut near = (from..).zip(near).filter(|(_, near)| *near != 0);
            if are_near && near.any(|(place, _)| may_meet(place)) {
                return false;
            }
            from += LANES;
        }
        !(from..columns.len()).any(may_meet)
    }

    /// For each obstacle of a group 1 where the line through it along its relative velocity passes within its reach in the
    /// plane, ahead or behind, `(r × V_r)² ≤ d² V_r²`, or where a value is not a number; otherwise 0.
    #[inline]
    fn near_in_plane(
        &self,
        ((x, y), (vx, vy)): ((&Lanes, &Lanes), (&Lanes, &Lanes)),
        (radius, half_height): (&Lanes, &Lanes),
        growth: Option<(&Lanes, &Lanes)>,
    ) -> [u64; LANES] {
        let mut reach = [self.margin_m + ROUNDING_M; LANES];
        for ((reach, radius), half_height) in reach.iter_mut().zip(radius).zip(half_height) {
            *reach += radius + half_height;
        }
        if let Some((position, velocity)) = growth {
            for ((reach, position), velocity) in reach.iter_mut().zip(position).zip(velocity) {
                *reach += self.sigmas * (position + velocity * self.horizon_s);
            }
        }
        // As wide as the numbers, for vector code.
        let mut near = [0; LANES];
        let lanes = x.iter().zip(y).zip(vx.iter().zip(vy)).zip(&reach);
        for (near, (((x, y), (vx, vy)), reach)) in near.iter_mut().zip(lanes) {
            let (x, y) = (self.position_m.x - x, self.position_m.y - y);
            let (vx, vy) = (self.velocity_mps.x - vx, self.velocity_mps.y - vy);
            let is_clear = square(x * vy - y * vx) > square(*reach) * (vx * vx + vy * vy);
            *near = u64::from(!is_clear);
        }
        near
    }
}

fn square(x: f64) -> f64 {
    x * x
}

#[cfg(test)]
mod tests {
    use alloc::vec;
    use alloc::vec::Vec;

    use super::*;
    use crate::draw::Draw;
    use crate::situation::{ProtectedVolume, Uncertainty};

    impl Draw {
        fn below(&mut self, count: usize) -> usize {
            self.within(0.0, 1.0);
            usize::try_from(self.0 >> 33).unwrap() % count
        }

        fn line(&mut self) -> LineAhead {
            let limits_m = [f64::INFINITY, self.within(0.0, 5e3)];
            LineAhead {
                position_m: self.vector(1e3),
                velocity_mps: self.vector(20.0),
                surveillance_radius_m: limits_m[usize::from(self.0 & (1 << 40) != 0)],
                margin_m: self.within(0.0, 5.0),
                sigmas: 3.0,
                horizon_s: 60.0,
            }
        }

        /// An obstacle that passes the line at its reach and some metres, level, above or below it.
        fn obstacle(
            &mut self,
            line: &LineAhead,
            (is_cylinder, is_certain): (bool, bool),
            beyond_m: f64,
        ) -> Obstacle {
            let radius_m = self.within(0.0, 50.0);
            let half_height_m = self.within(0.0, 50.0);
            let volume = if is_cylinder {
                ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m,
                }
            } else {
                ProtectedVolume::Sphere { radius_m }
            };
            let mut obstacle = Obstacle::straight(1, Vec3::ZERO, self.vector(30.0), volume);
            if !is_certain {
                obstacle.uncertainty = Uncertainty {
                    position_m: self.within(0.0, 5.0),
                    velocity_mps: self.within(0.0, 0.5),
                };
            }
            let relative = line.velocity_mps - obstacle.velocity_mps;
            let across = if self.within(0.0, 1.0) < 0.5 {
                Vec3::Z
            } else {
                self.vector(1.0)
            };
            let aside = relative.cross(across).normalize_or_zero();
            let aside_m = line.reach_m(&obstacle) + beyond_m;
            let after_s = self.within(-20.0, 100.0);
            obstacle.position_m = line.position_m + relative * after_s + aside * aside_m;
            obstacle
        }
    }

    /// A sphere of 30 m keeps 60 m clear, and the margin of 5 m.
    #[test]
    fn a_line_is_clear_of_what_passes_beyond_its_reach() {
        let line = LineAhead {
            position_m: Vec3::ZERO,
            velocity_mps: Vec3::new(15.0, 0.0, 0.0),
            surveillance_radius_m: 2000.0,
            margin_m: 5.0,
            sigmas: 3.0,
            horizon_s: 60.0,
        };
        let at = |x_m: f64, y_m: f64, uncertain_m: f64| {
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let mut row = Obstacle::straight(1, Vec3::new(x_m, y_m, 0.0), Vec3::ZERO, volume);
            row.uncertainty.position_m = uncertain_m;
            line.may_meet(&row)
        };
        assert!(at(500.0, 64.9, 0.0) && !at(500.0, 65.1, 0.0));
        assert!(at(500.0, 67.9, 1.0) && !at(500.0, 68.1, 1.0));
        // Behind the aircraft, and beyond surveillance.
        assert!(!at(-70.0, 0.0, 0.0) && at(-60.0, 0.0, 0.0));
        assert!(at(1990.0, 0.0, 0.0) && !at(2010.0, 0.0, 0.0));
    }

    fn column(rows: &[Obstacle], of: impl Fn(&Obstacle) -> f64) -> Vec<f64> {
        rows.iter().map(of).collect()
    }

    /// Whether obstacles are clear as columns.
    fn is_clear_of_columns(
        line: &LineAhead,
        rows: &[Obstacle],
        (is_cylinder, is_certain): (bool, bool),
    ) -> bool {
        let id = vec![1; rows.len()];
        let [x_m, y_m, z_m] = [0, 1, 2].map(|axis| column(rows, |o| o.position_m[axis]));
        let [vx_mps, vy_mps, vz_mps] = [0, 1, 2].map(|axis| column(rows, |o| o.velocity_mps[axis]));
        let radius_m = column(rows, |o| o.volume.radius_m());
        let half_height_m = column(rows, |o| o.volume.half_height_m());
        let sigma_m = column(rows, |o| o.uncertainty.position_m);
        let sigma_mps = column(rows, |o| o.uncertainty.velocity_mps);
        let columns = Columns {
            id: &id,
            x_m: &x_m,
            y_m: &y_m,
            z_m: &z_m,
            vx_mps: &vx_mps,
            vy_mps: &vy_mps,
            vz_mps: &vz_mps,
            radius_m: &radius_m,
            half_height_m: is_cylinder.then_some(&half_height_m),
            uncertainty: (!is_certain).then_some((&sigma_m, &sigma_mps)),
            movement: None,
        };
        line.is_clear_of(&Obstacles::Columns(columns))
    }

    /// Also where one obstacle of many is met or missed by less than a nanometre, wherever it stands.
    #[test]
    fn columns_are_clear_exactly_where_rows_are() {
        let mut draw = Draw(7);
        let mut met = 0;
        for case in 0..4000 {
            let line = draw.line();
            let form = (case % 2 == 0, case % 3 == 0);
            let most = [20, 200, 1300][case % 3];
            let count = draw.below(most);
            let mut rows = Vec::new();
            while rows.len() < count {
                let beyond_m = draw.within(0.0, 20.0) + draw.within(-5.0, 800.0).max(0.0);
                let row = draw.obstacle(&line, form, beyond_m);
                if !line.may_meet(&row) {
                    rows.push(row);
                }
            }
            assert!(
                is_clear_of_columns(&line, &rows, form),
                "{case}: {count} clear ones"
            );
            let beyond_m = draw.within(-1.0, 1.0) * [1.0, 1e-9, 1e-13][case % 3];
            let row = draw.obstacle(&line, form, beyond_m);
            rows.insert(draw.below(count + 1), row);
            let meets = line.may_meet(&row);
            met += usize::from(meets);
            let is_clear = is_clear_of_columns(&line, &rows, form);
            assert_eq!(is_clear, !meets, "{case}: {line:?} {row:?}");
        }
        assert!((1000..3000).contains(&met), "{met}");
    }

    /// Wherever the obstacle stands, unless its line passes clear whatever its altitude.
    #[test]
    fn columns_with_unusable_numbers_are_not_clear() {
        let mut draw = Draw(9);
        for case in 0..300 {
            let line = LineAhead {
                surveillance_radius_m: f64::INFINITY,
                ..draw.line()
            };
            let form = (case % 2 == 0, case % 3 == 0);
            let mut rows: Vec<Obstacle> =
                (0..40).map(|_| draw.obstacle(&line, form, 900.0)).collect();
            assert!(is_clear_of_columns(&line, &rows, form));
            let row = &mut rows[case % 40];
            let number = match case % 4 {
                0 => &mut row.position_m.x,
                1 => &mut row.position_m.y,
                2 => &mut row.velocity_mps.x,
                _ => &mut row.velocity_mps.y,
            };
            *number = f64::NAN;
            assert!(!is_clear_of_columns(&line, &rows, form), "{case}");
        }
    }
}

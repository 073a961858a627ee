//! Is anything near the straight line ahead? Nearly every cycle ends with this test.
//!
//! Conservative: an obstacle that passes the test cannot come closer than its volume on the line ahead. No
//! square root, and over columns no branch per obstacle, so that the compiler makes vector code of it. Of columns it reads
//! places, velocities and radii in the plane, 40 bytes an obstacle; altitudes only where these do not decide.

use crate::situation::Obstacle;
use crate::situation::{Columns, Obstacles};
use fga_proof::Vec3;

/// Obstacles tested before the first look at the result.
const BLOCK: usize = 256;

/// Obstacles whose distances are tested before their lines are.
const IN_RANGE_BLOCK: usize = 64;

/// Obstacles of a group: four vectors of four, or two of eight.
const LANES: usize = 16;

/// Obstacles collected for the test in space.
const NEAR: usize = 64;

/// More than rounding takes from a distance in the plane out to 1,000 km, metres: what passes clear in the plane passes
/// clear in space, to the last bit.
const ROUNDING_M: f64 = 0.1;

/// Added to the possible distance of an aircraft, metres.
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
            Obstacles::Rows(rows) => rows.iter().all(|row| !self.may_meet_row(row)),
            Obstacles::Columns(columns) if columns.movement.is_some() => {
                obstacles.iter().all(|row| !self.may_meet_row(&row))
            }
            Obstacles::Columns(columns) => self.is_clear_of_columns(columns),
        }
    }

    /// Whether an obstacle may come within its volume on the line, or near the aircraft if it may turn.
    pub fn may_meet_row(&self, row: &Obstacle) -> bool {
        let offset = row.position_m - self.position_m;
        let velocity = self.velocity_mps - row.velocity_mps;
        if row.movement.bounds().is_some() && self.may_come_near(row) {
            return true;
        }
        let reach_m = self.reach_m(row);
        let beyond = offset.length_squared() > square(self.surveillance_radius_m);
        !beyond
            && may_meet(
                offset.dot(offset),
                offset.dot(velocity),
                velocity.dot(velocity),
                reach_m,
            )
    }

    /// Distance on the line at which an obstacle may be met, metres.
    pub fn reach_m(&self, row: &Obstacle) -> f64 {
        let volume_m = row.volume.radius_m() + row.volume.half_height_m();
        let growth_m = self.sigmas
            * (row.uncertainty.position_m + row.uncertainty.velocity_mps * self.horizon_s);
        volume_m + growth_m + self.margin_m
    }

    /// Distance at which an aircraft could come near within the horizon, whatever its turns, at the sum of the speeds,
    /// metres.
    pub fn near_m(&self, row: &Obstacle, speed_mps: f64) -> f64 {
        let volume_m = row.volume.radius_m() + row.volume.half_height_m();
        let uncertain_m = self.sigmas
            * (row.uncertainty.position_m + row.uncertainty.velocity_mps * self.horizon_s);
        speed_mps * self.horizon_s + volume_m + uncertain_m + NEAR_M
    }

    fn may_come_near(&self, row: &Obstacle) -> bool {
        let offset = row.position_m - self.position_m;
        let distance_m = offset.length();
        let speed_mps = self.velocity_mps.length() + row.velocity_mps.length();
        let reach_m = self.near_m(row, speed_mps);
        distance_m <= self.surveillance_radius_m && distance_m <= reach_m
    }

    /// Blocks out of surveillance are passed over by x and y alone. Of the others most pass clear in the plane, whatever the
    /// altitudes; the few that do not are collected and tested in space, so that they wait for the memory together.
    fn is_clear_of_columns(&self, columns: &Columns<'_>) -> bool {
        let count = columns.len();
        let unlimited = self.surveillance_radius_m == f64::INFINITY;
        let block = if unlimited { BLOCK } else { IN_RANGE_BLOCK };
        let mut near = Near {
            places: [0; NEAR],
            count: 0,
        };
        let mut to = 0;
        while to < count {
            // At least a group, with some of the last block again.
            let from = to.min(count.saturating_sub(LANES));
            to = (from + block).min(count);
            if (unlimited || self.any_in_range(columns, from, to))
                && self.may_meet_any(columns, (from, to), &mut near)
            {
                return false;
            }
        }
        !self.may_meet_any_of(columns, &mut near)
    }

    /// Whether any obstacle of a block is within the surveillance radius, by x and y alone.
    fn any_in_range(&self, columns: &Columns<'_>, from: usize, to: usize) -> bool {
        let (Some(x), Some(y)) = (columns.x_m.get(from..to), columns.y_m.get(from..to)) else {
            return false;
        };
        let limit = square(self.surveillance_radius_m);
        let mut any = false;
        for (x, y) in x.iter().zip(y) {
            any |= square(x - self.position_m.x) + square(y - self.position_m.y) <= limit;
        }
        any
    }

    /// Tests a block in the plane. What may be met there is added to `near`, and tested in space once that is full.
    fn may_meet_any(&self, columns: &Columns<'_>, range: (usize, usize), near: &mut Near) -> bool {
        if columns.half_height_m.is_none() && columns.uncertainty.is_none() {
            let radius = part(columns.radius_m, range);
            return self.may_meet_any_within(columns, range, radius, near);
        }
        let mut reach = [0.0; BLOCK];
        self.add_reach(columns, range, &mut reach);
        let reach = part(&reach, (0, range.1 - range.0));
        self.may_meet_any_within(columns, range, reach, near)
    }

    /// `reach` is without the margin.
    fn may_meet_any_within(
        &self,
        columns: &Columns<'_>,
        range: (usize, usize),
        reach: &[f64],
        near: &mut Near,
    ) -> bool {
        let block = [columns.x_m, columns.y_m, columns.vx_mps, columns.vy_mps];
        let [x, y, vx, vy] = block.map(|column| part(column, range));
        let groups = x.as_chunks().0.iter().zip(y.as_chunks().0);
        let groups = groups.zip(vx.as_chunks().0).zip(vy.as_chunks().0);
        // One bit for each group; the rest is one more, with some of the last again.
        let mut found = u64::from(x.len() % LANES != 0) << (x.len() / LANES);
        for (group, ((((x, y), vx), vy), reach)) in groups.zip(reach.as_chunks().0).enumerate() {
            found |= u64::from(self.may_pass_near([x, y, vx, vy, reach])) << group;
        }
        while found != 0 {
            let first = LANES * found.trailing_zeros() as usize;
            let first = first.min(x.len().saturating_sub(LANES));
            let group = [x, y, vx, vy, reach].map(|column| column.get(first..)?.first_chunk());
            let mut lanes = match group {
                [Some(x), Some(y), Some(vx), Some(vy), Some(reach)] => {
                    self.may_meet_in_plane([x, y, vx, vy, reach])
                }
                // Fewer than a group: all of them.
                _ => (1 << x.len()) - 1,
            };
            while lanes != 0 {
                let is_full = near.add(range.0 + first + lanes.trailing_zeros() as usize);
                if is_full && self.may_meet_any_of(columns, near) {
                    return true;
                }
                lanes &= lanes - 1;
            }
            found &= found - 1;
        }
        false
    }

    /// Whether the line through any obstacle of a group along its relative velocity passes within its reach in the plane, ahead
    /// or behind: `(r × V_r)² ≤ d² V_r²`. True for values that are not numbers.
    #[expect(
        clippy::inline_always,
        reason = "what is the same for all groups stays in registers"
    )]
    #[inline(always)]
    fn may_pass_near(&self, [x, y, vx, vy, reach]: [&[f64; LANES]; 5]) -> bool {
        let margin_m = self.margin_m + ROUNDING_M;
        // As wide as the numbers, for vector code.
        let mut any = 0_u64;
        for ((((x, y), vx), vy), reach) in x.iter().zip(y).zip(vx).zip(vy).zip(reach) {
            let (x, y) = (self.position_m.x - x, self.position_m.y - y);
            let (vx, vy) = (self.velocity_mps.x - vx, self.velocity_mps.y - vy);
            let clear = square(x * vy - y * vx) > square(reach + margin_m) * (vx * vx + vy * vy);
            any |= u64::from(!clear);
        }
        any != 0
    }

    /// Which obstacles of a group may be met in the plane ahead, one bit each. The distance in space is at least that in
    /// the plane; an altitude that is not a number counts as far, for the avoider ignores such obstacles.
    fn may_meet_in_plane(&self, [x, y, vx, vy, reach]: [&[f64; LANES]; 5]) -> u64 {
        let margin_m = self.margin_m + ROUNDING_M;
        let mut lanes = 0;
        let numbers = x.iter().zip(y).zip(vx.iter().zip(vy)).zip(reach);
        for (lane, (((x, y), (vx, vy)), reach)) in numbers.enumerate() {
            let (x, y) = (x - self.position_m.x, y - self.position_m.y);
            let (vx, vy) = (self.velocity_mps.x - vx, self.velocity_mps.y - vy);
            let (distance, along) = (x * x + y * y, x * vx + y * vy);
            let meets = may_meet(distance, along, vx * vx + vy * vy, reach + margin_m);
            lanes |= u64::from(meets) << lane;
        }
        lanes
    }

    /// Tests collected obstacles in space, and forgets them. Their altitudes are all read first: they wait for the memory at
    /// once.
    fn may_meet_any_of(&self, columns: &Columns<'_>, near: &mut Near) -> bool {
        let places = near.places.get(..near.count).unwrap_or(&near.places);
        let [mut z, mut vz] = [[f64::NAN; NEAR]; 2];
        for (column, to) in [(columns.z_m, &mut z), (columns.vz_mps, &mut vz)] {
            for (to, place) in to.iter_mut().zip(places) {
                *to = column.get(*place).copied().unwrap_or(f64::NAN);
            }
        }
        let mut meets = false;
        for (place, (z, vz)) in places.iter().zip(z.iter().zip(&vz)) {
            meets |= self.may_meet_at(columns, *place, (*z, *vz));
        }
        near.count = 0;
        meets
    }

    /// As [`Self::may_meet_row`], without reading more than it needs.
    fn may_meet_at(&self, columns: &Columns<'_>, place: usize, (z, vz): (f64, f64)) -> bool {
        let at = |column: &[f64]| column.get(place).copied().unwrap_or(f64::NAN);
        let place_m = Vec3::new(at(columns.x_m), at(columns.y_m), z);
        let velocity_mps = Vec3::new(at(columns.vx_mps), at(columns.vy_mps), vz);
        let offset = place_m - self.position_m;
        let velocity = self.velocity_mps - velocity_mps;
        let mut reach = [0.0];
        self.add_reach(columns, (place, place + 1), &mut reach);
        let [reach_m] = reach;
        let distance = offset.length_squared();
        let meets = may_meet(
            distance,
            offset.dot(velocity),
            velocity.dot(velocity),
            reach_m + self.margin_m,
        );
        let beyond = distance > square(self.surveillance_radius_m);
        !beyond & meets
    }

    /// Adds the distances at which obstacles may be met, without the margin, metres.
    fn add_reach(&self, columns: &Columns<'_>, range: (usize, usize), reach: &mut [f64]) {
        for (reach, radius) in reach.iter_mut().zip(part(columns.radius_m, range)) {
            *reach += radius;
        }
        if let Some(half_height) = columns.half_height_m {
            for (reach, half_height) in reach.iter_mut().zip(part(half_height, range)) {
                *reach += half_height;
            }
        }
        if let Some((position, velocity)) = columns.uncertainty {
            let growth = part(position, range).iter().zip(part(velocity, range));
            for (reach, (position, velocity)) in reach.iter_mut().zip(growth) {
                *reach += self.sigmas * (position + velocity * self.horizon_s);
            }
        }
    }
}

/// Obstacles to be tested in space.
struct Near {
    places: [usize; NEAR],
    count: usize,
}

impl Near {
    /// Adds one. Whether it is full.
    fn add(&mut self, place: usize) -> bool {
        if let Some(free) = self.places.get_mut(self.count) {
            *free = place;
            self.count += 1;
        }
        self.count == NEAR
    }
}

/// A part of a column.
fn part(column: &[f64], (from, to): (usize, usize)) -> &[f64] {
    column.get(from..to).unwrap_or(&[])
}

/// Whether a point at squared distance `distance`, seen along the relative velocity at
/// `along = r · V_r` with `speed = V_r²`, comes within `reach_m`: `(r² − d²) V_r² < (r · V_r)²` while
/// closing (Eq. 4 without its arc sine), or is already there. True for values that are not numbers.
#[inline]
#[expect(
    clippy::needless_bitwise_bool,
    reason = "branches would keep it from vector code"
)]
fn may_meet(distance: f64, along: f64, speed: f64, reach_m: f64) -> bool {
    let outside = distance - reach_m * reach_m;
    let clear = (outside > 0.0) & ((along <= 0.0) | (outside * speed > along * along));
    !clear
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
            // Rows of spheres keep twice their radius clear: columns of spheres are as rows of flat cylinders.
            let half_height_m = if is_cylinder {
                self.within(0.0, 50.0)
            } else {
                0.0
            };
            let volume = ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
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
                if !line.may_meet_row(&row) {
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
            let meets = line.may_meet_row(&row);
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

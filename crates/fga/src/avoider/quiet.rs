//! Is anything near the straight line ahead? Nearly every cycle ends with this test.
//!
//! Conservative: an obstacle that passes the test cannot come closer than its volume on the line ahead. No
//! square root, and over columns no branch per obstacle, so that the compiler makes vector code of it.

use crate::Vec3;
use crate::situation::Obstacle;
use crate::situation::{Columns, Obstacles};

/// Obstacles tested before the first check of the result.
const BLOCK: usize = 64;

/// Added to the possible distance of an aircraft, metres.
const NEAR_M: f64 = 200.0;

/// The line ahead of the aircraft and the clear space around it, over the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct LineAhead {
    pub position_m: Vec3,
    pub velocity_mps: Vec3,
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
    pub(super) fn is_clear_of(&self, obstacles: &Obstacles<'_>) -> bool {
        match obstacles {
            Obstacles::Rows(rows) => rows.iter().all(|row| !self.may_meet_row(row)),
            Obstacles::Columns(columns) if columns.movement.is_some() => {
                obstacles.iter().all(|row| !self.may_meet_row(&row))
            }
            Obstacles::Columns(columns) => self.is_clear_of_columns(columns),
        }
    }

    /// Whether an obstacle may come within its volume on the line, or near the aircraft if it may turn.
    pub(super) fn may_meet_row(&self, row: &Obstacle) -> bool {
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
    pub(super) fn reach_m(&self, row: &Obstacle) -> f64 {
        let volume_m = row.volume.radius_m() + row.volume.half_height_m();
        let growth_m = self.sigmas
            * (row.uncertainty.position_m + row.uncertainty.velocity_mps * self.horizon_s);
        volume_m + growth_m + self.margin_m
    }

    /// Distance at which an aircraft could come near within the horizon, whatever its turns, at the sum of the speeds,
    /// metres.
    pub(super) fn near_m(&self, row: &Obstacle, speed_mps: f64) -> f64 {
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

    fn is_clear_of_columns(&self, columns: &Columns<'_>) -> bool {
        let count = columns.len();
        let unlimited = self.surveillance_radius_m == f64::INFINITY;
        let mut from = 0;
        while from < count {
            let to = (from + BLOCK).min(count);
            if (unlimited || self.any_in_range(columns, from, to))
                && self.may_meet_any(columns, from, to)
            {
                return false;
            }
            from = to;
        }
        true
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

    fn may_meet_any(&self, columns: &Columns<'_>, from: usize, to: usize) -> bool {
        fn part(column: &[f64], (from, to): (usize, usize)) -> &[f64] {
            column.get(from..to).unwrap_or(&[])
        }
        let range = (from, to);
        let mut reach = [0.0; BLOCK];
        for (reach, radius) in reach.iter_mut().zip(part(columns.radius_m, range)) {
            *reach = radius + self.margin_m;
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
        let places = [columns.x_m, columns.y_m, columns.z_m].map(|column| part(column, range));
        let velocities =
            [columns.vx_mps, columns.vy_mps, columns.vz_mps].map(|column| part(column, range));
        // Lanes of known length need no test for their end.
        match (whole(places), whole(velocities)) {
            (Some(places), Some(velocities)) => self.may_meet_any_of(
                places.map(<[f64; BLOCK]>::as_slice),
                velocities.map(<[f64; BLOCK]>::as_slice),
                &reach,
            ),
            _ => self.may_meet_any_of(places, velocities, &reach),
        }
    }

    #[expect(
        clippy::needless_bitwise_bool,
        reason = "a branch would keep it from vector code"
    )]
    #[expect(
        clippy::inline_always,
        reason = "a copy for blocks of known length, another one for the rest"
    )]
    #[inline(always)]
    fn may_meet_any_of(
        &self,
        [x, y, z]: [&[f64]; 3],
        [vx, vy, vz]: [&[f64]; 3],
        reach: &[f64; BLOCK],
    ) -> bool {
        let limit = square(self.surveillance_radius_m);
        let places = x.iter().zip(y).zip(z);
        let velocities = vx.iter().zip(vy).zip(vz);
        // As wide as the numbers, for vector code.
        let mut any = 0_u64;
        for ((((x, y), z), ((vx, vy), vz)), reach) in places.zip(velocities).zip(reach) {
            let offset = Vec3::new(*x, *y, *z) - self.position_m;
            let velocity = self.velocity_mps - Vec3::new(*vx, *vy, *vz);
            let distance = offset.dot(offset);
            let meets = may_meet(
                distance,
                offset.dot(velocity),
                velocity.dot(velocity),
                *reach,
            );
            any |= u64::from(meets & (distance <= limit));
        }
        any != 0
    }
}

/// Three columns of a whole block.
fn whole([x, y, z]: [&[f64]; 3]) -> Option<[&[f64; BLOCK]; 3]> {
    Some([x.first_chunk()?, y.first_chunk()?, z.first_chunk()?])
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

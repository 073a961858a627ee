//! A way onto the mission: onto the present leg, or onto one after it.

use crate::Progress;
use crate::corner::{LONG_RADII, corner};
use crate::join::{Join, join};
use crate::leg::Leg;
use crate::route::{LEG, MOST_LEGS, Route};
use crate::turn_round::turn_round;
use fga_proof::prediction::MotionState;

/// A search for a way onto the mission tries this many legs one by one; after them one in each half turn radius.
const ONE_BY_ONE: usize = 8;

impl Progress {
    /// A way onto the mission: onto the leg, or onto the first leg after it, at most `skipped` on, that the aircraft joins before
    /// the leg's end. The way enters a leg with a required beginning, and a long leg that was not begun, only at the beginning.
    /// `None` without such a leg.
    pub fn way_back(
        &self,
        route: &Route<'_>,
        state: &MotionState,
        intercept_rad: f64,
        skipped: usize,
    ) -> Option<Join> {
        let legs = self.legs(route);
        let long_m = LONG_RADII * route.radius_m();
        let round = |index: usize, leg: &Leg| turn_round(route, (index, leg), state);
        let (mut index, mut leg, mut corner_here) = (self.index, self.leg?, self.corner);
        if self.is_unentered {
            return round(index, &leg);
        }
        let mut passed_m = 0.0;
        for count in 0..MOST_LEGS {
            if !route.meter.take(LEG) {
                return None;
            }
            let is_far_on = passed_m >= 0.5 * route.radius_m();
            if count < ONE_BY_ONE || is_far_on || corner_here.is_none() {
                passed_m = 0.0;
                let joined = join(route, (index, &leg), state, intercept_rad);
                let room_m = match &corner_here {
                    Some(corner) => leg.length_m - corner.lead_m,
                    None if route.is_flown_over(index) => leg.length_m,
                    None => f64::INFINITY,
                };
                let is_behind = joined.along_m > room_m;
                let is_before = joined.along_m < -long_m;
                if count > 0 && (is_before || is_behind && leg.length_m > long_m) {
                    return round(index, &leg);
                }
                if !is_behind {
                    return Some(joined);
                }
            }
            let may_skip = index < self.index + skipped && !route.meter.is_met();
            let next = corner_here.as_ref().filter(|_| may_skip)?;
            index = next.join.index;
            leg = legs.leg(index)?;
            if next.is_turn_round {
                return round(index, &leg);
            }
            passed_m += leg.length_m;
            corner_here = corner(&legs, index, &leg);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::table_4;
    use fga_proof::Vec3;

    /// The way back from a place, of which an aircraft has begun to fly the first leg.
    fn found(
        waypoints_m: &[(f64, f64)],
        (x_m, y_m, course_rad): (f64, f64, f64),
        skipped: usize,
    ) -> Option<Join> {
        table_4(waypoints_m, |route| {
            let state = MotionState {
                position_m: Vec3::new(x_m, y_m, 0.0),
                course_rad,
                ..MotionState::ahead(0.0)
            };
            let mut progress = Progress::new();
            progress.update(route, &MotionState::ahead(0.0), 0.0);
            progress.way_back(route, &state, 0.79, skipped)
        })
    }

    #[test]
    fn the_present_leg_is_joined_where_it_is_long_enough() {
        let corner_m = [(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0)];
        let join = found(&corner_m, (200.0, 100.0, 0.0), 1).unwrap();
        assert_eq!(join.index, 0);
        assert!(join.along_m > 300.0 && join.along_m < 400.0, "{join:?}");
    }

    /// 50 m before the corner there is no room: the next leg is joined, if one may be skipped.
    #[test]
    fn the_next_leg_is_joined_where_the_present_one_ends_too_soon() {
        let corner_m = [(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0)];
        let aside = (950.0, 100.0, 0.0);
        assert_eq!(found(&corner_m, aside, 0), None);
        assert_eq!(found(&corner_m, aside, 1).unwrap().index, 1);
    }

    /// The survey line back is entered at its beginning alone.
    #[test]
    fn a_leg_after_a_turn_round_is_entered_at_its_beginning() {
        let lines_m = [(0.0, 0.0), (400.0, 0.0), (400.0, 20.0), (0.0, 20.0)];
        let join = found(&lines_m, (390.0, 50.0, 0.0), 8).unwrap();
        assert_eq!((join.index, join.along_m), (2, 0.0));
    }
}

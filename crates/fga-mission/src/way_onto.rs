//! A way onto the mission: onto the leg, or onto one after it.

use super::corner::{Air, LONG_RADII, Legs as _, arrival, corner};
use super::join::{Join, JoinLimits, join};
use super::leg::Leg;
use super::turnaround::turnaround;
use super::{LEG, Progress};
use fga_proof::prediction::{Flyer, MotionState};
use fga_proof::situation::Mission;

/// Most legs that a search for a way onto the mission examines one by one; after them one in each
/// half turn radius.
const ONE_BY_ONE: usize = 8;

/// Most legs of a search for a way onto the mission.
pub(super) const MOST_LEGS: usize = 96;

impl Progress {
    /// A way onto the beginning of a leg, by a turn round.
    pub(super) fn round_to_beginning(
        leg: &Leg,
        state: &MotionState,
        air: &Air<'_>,
    ) -> Option<Join> {
        let to = arrival(leg, air);
        let found = turnaround(air, state, &to)?;
        let along_m = leg.position(to.position_m, 0.0).along_m;
        Some(Join {
            maneuver: found.maneuver,
            joined_s: found.arrives_s,
            along_m,
            cross_m: 0.0,
            above_m: 0.0,
        })
    }

    /// A way onto the mission: onto the leg, or onto the first one after it that it joins before
    /// its end, at most `skipped` legs on. Also returns the index of its first waypoint; `None`
    /// if there is none. A way enters a leg with a required beginning, and a long one that was not
    /// begun, only at its beginning.
    pub fn way_back(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        limits: &JoinLimits,
        skipped: usize,
    ) -> Option<(Join, usize)> {
        let meter = self.meter();
        let air = self.air(flyer, &meter);
        let onto = |leg: &Leg| {
            let joined = join(flyer, leg, state, limits, &meter);
            (joined.along_m, joined)
        };
        let round = |leg: &Leg| Self::round_to_beginning(leg, state, &air);
        let found = self.way_onto(mission, state, &air, skipped, (onto, round));
        self.note(&meter);
        // If a cut search got to the same leg as the last one, the next begins again.
        self.looked_to = found.as_ref().err().copied().unwrap_or(0);
        found.ok().flatten()
    }

    /// The way onto the first leg that one joins, by a join, of which `onto` also says how far along the leg it ends, metres, or
    /// by a turn round; or the number of legs examined before the work ended.
    fn way_onto<T>(
        &self,
        mission: &Mission<'_>,
        state: &MotionState,
        air: &Air<'_>,
        skipped: usize,
        (mut onto, round): (impl FnMut(&Leg) -> (f64, T), impl Fn(&Leg) -> Option<T>),
    ) -> Result<Option<(T, usize)>, usize> {
        let mut leg = self.leg(state);
        let round = |leg: &Leg, index: usize| Ok(round(leg).map(|way| (way, index)));
        if self.from_start {
            return round(&leg, self.index);
        }
        let laid = self.laid(mission);
        let radius_m = air.radius_m();
        let mut next = self.corner;
        let mut index = self.index;
        let mut passed_m = 0.0;
        for count in 0..MOST_LEGS {
            if !air.meter.take(LEG) {
                return Err(0);
            }
            let is_tried = count < ONE_BY_ONE || passed_m >= 0.5 * radius_m || next.is_none();
            if is_tried && count >= self.looked_to {
                passed_m = 0.0;
                let (along_m, way) = onto(&leg);
                let room_m = match next {
                    Some(next) => leg.length_m - next.lead_m,
                    None if Self::ends_over(mission, index) => leg.length_m,
                    None => f64::INFINITY,
                };
                let is_behind = along_m > room_m;
                let is_far_before = count > 0 && along_m < -LONG_RADII * radius_m;
                if is_far_before || (is_behind && count > 0 && leg.length_m > LONG_RADII * radius_m)
                {
                    return round(&leg, index);
                }
                if !is_behind {
                    return Ok(Some((way, index)));
                }
            }
            let Some(corner_here) = next else { break };
            if index >= self.index + skipped {
                break;
            }
            if air.meter.is_met() {
                return Err(if count > self.looked_to { count } else { 0 });
            }
            index = corner_here.next;
            let Some(next_leg) = laid.leg(index) else {
                break;
            };
            leg = next_leg;
            if corner_here.is_turnaround {
                return round(&leg, index);
            }
            passed_m += leg.length_m;
            next = corner(&laid, index, &leg, air);
        }
        Ok(None)
    }
}

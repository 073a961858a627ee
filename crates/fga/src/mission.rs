//! How does the aircraft follow its mission, and how does it get back onto it?
//!
//! | question | answer |
//! |---|---|
//! | which leg, and what to fly along it? | [`Progress`] |
//! | where does it stand on a leg? | [`leg`] |
//! | which way onto the leg? | [`join`] |

pub mod join;
pub mod leg;

use self::join::{Join, JoinLimits, is_on_leg, join};
use self::leg::Leg;
use crate::Vec3;
use crate::angle::wrap_pi;
use crate::limit::Limit as _;
use crate::maneuver::{Maneuver, Stage};
use crate::prediction::{Flyer, MotionState};
use crate::situation::Mission;

/// Most legs that a way back may leave out because it cannot join them before they end.
pub const MAX_SKIPPED: usize = 4;

/// Stages that corners leave for the turns of an avoidance.
const ROOM_TO_AVOID: usize = 2;

/// Intercept angle of the guidance along the mission, radians.
const GUIDANCE_INTERCEPT_RAD: f64 = 0.785;

/// A moment from which a manoeuvre flies along a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Index of the waypoint at the start of the leg.
    pub index: usize,
    /// The moment, seconds from the decision.
    pub straight_s: f64,
    /// How far along the leg it is then, metres.
    pub along_m: f64,
}

/// The leg that is flown, and the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Index of the waypoint at the start of the leg.
    index: usize,
    leg: Option<Leg>,
    next: Option<Leg>,
    /// How far before the leg's end the turn onto the next one begins, metres.
    lead_m: f64,
    wind_mps: Vec3,
    airspeed_mps: f64,
    complete: bool,
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// At the start of a mission that is not known yet.
    pub const fn new() -> Self {
        Self {
            index: 0,
            leg: None,
            next: None,
            lead_m: 0.0,
            wind_mps: Vec3::ZERO,
            airspeed_mps: 0.0,
            complete: false,
        }
    }

    /// Index of the waypoint at the start of the leg.
    pub const fn index(&self) -> usize {
        self.index
    }

    /// Whether the last waypoint was passed.
    pub const fn is_complete(&self) -> bool {
        self.complete
    }

    /// The leg that is flown.
    pub fn leg(&self, state: &MotionState) -> Leg {
        self.leg.unwrap_or_else(|| {
            Leg::endless(
                state.position_m,
                state.course_rad,
                self.airspeed_mps,
                self.wind_mps,
            )
        })
    }

    fn load(&mut self, mission: &Mission<'_>, state: &MotionState, flyer: &Flyer) {
        self.leg = self.leg_at(mission, self.index);
        self.next = self.leg_at(mission, self.index + 1);
        self.lead_m = match (self.leg, self.next) {
            (Some(leg), Some(next)) => leg.lead_m(&next, radius_m(flyer)),
            _ => 0.0,
        };
        if self.leg.is_none() && !self.complete {
            // Past the last waypoint, or no mission: hold course and height from here.
            self.complete = true;
            let course = state.course_rad;
            self.leg = Some(Leg::endless(
                state.position_m,
                course,
                self.airspeed_mps,
                self.wind_mps,
            ));
        }
    }

    /// Goes on to the leg that is to be flown from `state`.
    pub fn update(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        wind_mps: Vec3,
    ) {
        let airspeed_mps = flyer.airspeed_mps();
        if self.leg.is_none() || wind_mps != self.wind_mps || airspeed_mps != self.airspeed_mps {
            (self.wind_mps, self.airspeed_mps) = (wind_mps, airspeed_mps);
            if !self.complete {
                self.load(mission, state, flyer);
            }
        }
        while let (Some(leg), false) = (self.leg, self.complete) {
            let position = leg.position(state.position_m, state.time_s);
            if position.along_m < leg.length_m - self.lead_m {
                break;
            }
            self.index += 1;
            self.leg = None;
            self.load(mission, state, flyer);
        }
    }

    /// The leg that begins at a waypoint.
    fn leg_at(&self, mission: &Mission<'_>, index: usize) -> Option<Leg> {
        let from = *mission.waypoints_m.get(index)?;
        let to = *mission.waypoints_m.get(index + 1)?;
        let course_rad = self.leg.map_or(0.0, |leg| leg.course_rad);
        Some(Leg::new(
            from,
            to,
            self.airspeed_mps,
            self.wind_mps,
            course_rad,
        ))
    }

    /// A way onto the mission: onto the leg, or onto the first one after it that is joined before
    /// it ends, no more than `skipped` legs on. Returns the index of its first waypoint too, `None`
    /// where it would be joined beyond its end.
    pub fn way_back(
        &self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        limits: &JoinLimits,
        skipped: usize,
    ) -> Option<(Join, usize)> {
        let leg = self.leg(state);
        let mut joined = join(flyer, &leg, state, limits);
        let mut left_m = leg.length_m - self.lead_m;
        let mut next = self.next;
        let mut index = self.index;
        while let Some(leg) = next {
            if joined.along_m <= left_m {
                break;
            }
            if index >= self.index + skipped {
                return None;
            }
            index += 1;
            joined = join(flyer, &leg, state, limits);
            next = self.leg_at(mission, index + 1);
            let lead_m = next.map_or(0.0, |next| leg.lead_m(&next, radius_m(flyer)));
            left_m = leg.length_m - lead_m;
        }
        Some((joined, index))
    }

    /// Goes on to the leg that begins at a waypoint.
    pub fn advance_to(
        &mut self,
        index: usize,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
    ) {
        if index > self.index && !self.complete {
            self.index = index;
            self.leg = None;
            self.load(mission, state, flyer);
        }
    }

    /// Points of the mission ahead of `position_m`, nearest first: every `spacing_m` along the leg
    /// that is flown, then the waypoints. Returns how many of `points` were filled.
    pub fn points_ahead(
        &self,
        mission: &Mission<'_>,
        position_m: Vec3,
        spacing_m: f64,
        points: &mut [Vec3],
    ) -> usize {
        let Some(leg) = self.leg else { return 0 };
        let from_m = leg.position(position_m, 0.0).along_m;
        // The last ones are the waypoints'.
        let on_leg = points.len() * 2 / 3;
        let along = (1u32..)
            .map(|k| from_m + f64::from(k) * spacing_m)
            .take(on_leg)
            .take_while(|along_m| *along_m < leg.length_m)
            .map(|along_m| leg.point_m(along_m));
        let waypoints = mission.waypoints_m.iter().skip(self.index + 1).copied();
        let mut count = 0;
        for (slot, point) in points.iter_mut().zip(along.chain(waypoints)) {
            *slot = point;
            count += 1;
        }
        count
    }

    /// The course to hold where the aircraft is on its leg and no corner comes within `horizon_s`.
    pub fn straight_on_rad(
        &self,
        state: &MotionState,
        flyer: &Flyer,
        horizon_s: f64,
    ) -> Option<f64> {
        let leg = self.leg?;
        let left_m = leg.length_m - self.lead_m - leg.position(state.position_m, 0.0).along_m;
        let straight = left_m > leg.ground_speed_mps * horizon_s || self.next.is_none();
        (straight && flyer.is_level_at(state) && is_on_leg(&leg, state))
            .then(|| state.course_rad + leg.turn_onto_rad(state))
    }

    /// What to fly along the mission from `state`: onto the leg, and round the corners up to
    /// `horizon_s`. Returns it with the moment from which it is straight.
    pub fn guidance(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        climb_limits_rad: (f64, f64),
        horizon_s: f64,
    ) -> (Maneuver, f64) {
        let leg = self.leg(state);
        let (mut maneuver, straight_s, along_m) = if is_on_leg(&leg, state) {
            let course_rad = state.course_rad + leg.turn_onto_rad(state);
            let climb_rad = leg
                .climb_rad
                .limited(climb_limits_rad.0, climb_limits_rad.1);
            let maneuver = Maneuver::turn(0.0, course_rad, climb_rad);
            (
                maneuver,
                0.0,
                leg.position(state.position_m, state.time_s).along_m,
            )
        } else {
            let limits = JoinLimits {
                intercept_rad: GUIDANCE_INTERCEPT_RAD,
                climb_limits_rad,
            };
            let back = self.way_back(mission, state, flyer, &limits, MAX_SKIPPED);
            let joined = if let Some((joined, index)) = back {
                self.advance_to(index, mission, state, flyer);
                joined
            } else {
                join(flyer, &leg, state, &limits)
            };
            (joined.maneuver, joined.joined_s, joined.along_m)
        };
        let index = self.index;
        let bend = Bend {
            index,
            straight_s,
            along_m,
        };
        self.round_corners(
            mission,
            flyer,
            climb_limits_rad,
            horizon_s,
            &mut maneuver,
            bend,
        )
        .map_or((maneuver, straight_s), |straight_s| (maneuver, straight_s))
    }

    /// Appends the corners up to `horizon_s` to a manoeuvre that flies along a leg from `bend` on.
    /// Returns the moment from which it is straight, `None` where there is no corner.
    pub fn round_corners(
        &self,
        mission: &Mission<'_>,
        flyer: &Flyer,
        climb_limits_rad: (f64, f64),
        horizon_s: f64,
        maneuver: &mut Maneuver,
        bend: Bend,
    ) -> Option<f64> {
        let Bend {
            mut index,
            mut straight_s,
            mut along_m,
        } = bend;
        let mut turned = None;
        let mut leg = self.leg_or_loaded(mission, index)?;
        while let Some(following) = self.leg_or_loaded(mission, index + 1) {
            let lead_m = leg.lead_m(&following, radius_m(flyer));
            let left_m = leg.length_m - lead_m - along_m;
            let corner_s = straight_s + (left_m / leg.ground_speed_mps.max(0.1)).max(0.0);
            let last = maneuver.stages().last().copied()?;
            // Corners beyond the room are for a later cycle: straight on is a whole flight too.
            if corner_s > horizon_s || maneuver.room() <= ROOM_TO_AVOID {
                break;
            }
            let turn_rad = wrap_pi(following.air_course_rad - last.course_rad);
            let (low, high) = climb_limits_rad;
            let stage = Stage {
                start_s: corner_s,
                course_rad: last.course_rad + turn_rad,
                climb_rad: following.climb_rad.limited(low, high),
                rate_share: 1.0,
            };
            if !maneuver.push(stage) {
                break;
            }
            straight_s = corner_s + turn_rad.abs() / flyer.course_rate_radps();
            turned = Some(straight_s);
            along_m = lead_m;
            leg = following;
            index += 1;
        }
        turned
    }

    fn leg_or_loaded(&self, mission: &Mission<'_>, index: usize) -> Option<Leg> {
        if index == self.index {
            self.leg
        } else if index == self.index + 1 {
            self.next
        } else {
            self.leg_at(mission, index)
        }
    }
}

/// Radius of the tightest turn that is really flown, metres.
fn radius_m(flyer: &Flyer) -> f64 {
    flyer.airspeed_mps() / flyer.course_rate_radps()
}

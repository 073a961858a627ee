//! Which leg does the aircraft fly, and which command along it?

use crate::corner::{Corner, INTERCEPT_RAD, LONG_RADII, corner};
use crate::join::{Join, is_on_leg, join};
use crate::leg::Leg;
use crate::restart::Restart;
use crate::route::{LEG, Legs, MOST_LEGS, Route};
use crate::turn_round::turn_round;
use core::f64::consts::FRAC_PI_2;
use fga_proof::Vec3;
use fga_proof::angle::{course_of, wrap_pi};
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::prediction::{Flyer, MotionState, flown};

/// Stages that corners leave free for the turns of an avoidance.
const ROOM_TO_AVOID: usize = 2;

/// A smaller bank counts as wings level, radians.
const LEVEL_BANK_RAD: f64 = 1e-3;

/// A turn round is planned again once the aircraft is off it by this, turn radii: less than [`ENTERED_RADII`].
const OFF_TURN_RADII: f64 = 0.2;

/// An aircraft past the beginning of a leg has entered it within this distance and angle: turn radii and radians (11°). The
/// larger distance holds near the beginning while no turn round is in progress: an obstacle may stand there, and from 1.5 radii
/// aside two turns of 2.6 radii lead onto the leg, where a circle takes 6.3.
const ENTERED_RADII: [f64; 2] = [0.3, 1.5];
const ENTERED_RAD: f64 = 0.2;

/// An aircraft is back on its leg within this distance, beside it and in height, metres, and this angle of its course, radians (11°):
/// from there the guidance of an autopilot takes it on.
pub const BACK_WITHIN_M: f64 = 15.0;
/// See [`BACK_WITHIN_M`].
pub const BACK_WITHIN_RAD: f64 = 0.2;

/// A turn round in progress.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    join: Join,
    from: MotionState,
    /// Its start, seconds on the situation's clock.
    begun_s: f64,
}

/// Where the aircraft is in its mission: the present leg, and the corner at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Index of the waypoint at the start of the leg.
    pub(crate) index: usize,
    pub(crate) leg: Option<Leg>,
    pub(crate) corner: Option<Corner>,
    /// Whether the aircraft must still enter the leg at its beginning, by a turn round.
    pub(crate) is_unentered: bool,
    turn: Option<Turn>,
    /// Turns round onto this leg that the aircraft came off; after a second one it joins the leg anywhere. An aircraft that turns otherwise
    /// than its file says comes off each of them.
    missed: u8,
    time_s: f64,
    /// Airspeed, metres per second, and wind, for which leg and corner are laid; and the climb limits, radians.
    air: (f64, Vec3),
    climb_limits_rad: (f64, f64),
    pub(crate) is_complete: bool,
    /// Whether the meter refused the corner: the next step plans it.
    is_cut: bool,
    /// The leg that begins at a place of the aircraft, not at its waypoint.
    pub(crate) restart: Option<Restart>,
    /// Passes aside of the last waypoint since the nearest one, and the distance of that one, metres.
    pub(crate) passes: u8,
    pub(crate) nearest_m: f64,
    /// The nearest to the end of the leg, metres, and how long obstacles at rest have kept the aircraft from coming nearer, seconds.
    pub(crate) kept_off: (f64, f64),
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// At the start of an unknown mission.
    pub const fn new() -> Self {
        Self {
            index: 0,
            leg: None,
            corner: None,
            is_unentered: false,
            turn: None,
            missed: 0,
            time_s: 0.0,
            air: (0.0, Vec3::ZERO),
            climb_limits_rad: (0.0, 0.0),
            is_complete: false,
            is_cut: false,
            restart: None,
            passes: 0,
            nearest_m: f64::INFINITY,
            kept_off: (f64::INFINITY, 0.0),
        }
    }

    /// Takes up another mission, whose first `kept` waypoints are those of before. Where the present leg ends at one of them, its
    /// flight goes on; else the mission begins at its first leg, by a turn round where that ends behind the aircraft.
    pub fn take_up(&mut self, kept: usize) {
        // A complete mission goes on from its last waypoint.
        let end = self.index + usize::from(!self.is_complete);
        if end < kept {
            (self.is_cut, self.is_complete) = (true, false);
        } else {
            *self = Self {
                is_unentered: true,
                ..Self::new()
            };
        }
    }

    /// Index of the waypoint at the start of the leg.
    pub const fn index(&self) -> usize {
        self.index
    }

    /// Whether the aircraft passed the last waypoint.
    pub const fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Whether the aircraft flies back to the last waypoint, which it passed aside.
    pub const fn returns(&self) -> bool {
        self.nearest_m < f64::INFINITY && self.corner.is_none() && !self.is_complete
    }

    /// Lets the aircraft join its leg anywhere, not only at its beginning, near which an obstacle may stand.
    pub const fn join_anywhere(&mut self) {
        (self.is_unentered, self.turn) = (false, None);
    }

    /// Whether the aircraft has come off the turn round by which it was to enter its leg.
    pub const fn is_off_turn(&self) -> bool {
        self.is_unentered && self.turn.is_none()
    }

    /// How long the flight along the leg takes from a state to the leg's end, seconds; negative beyond it.
    pub fn to_end_s(&self, state: &MotionState) -> f64 {
        let leg = self.leg(state);
        let along_m = leg.position(state.position_m, state.time_s).along_m;
        (leg.length_m - along_m) / leg.ground_speed_mps.max(f64::MIN_POSITIVE)
    }

    /// The present leg; before the first [`Self::update`] straight on.
    pub fn leg(&self, state: &MotionState) -> Leg {
        let ahead = || Leg::endless(state.position_m, state.course_rad, self.air);
        self.leg.unwrap_or_else(ahead)
    }

    /// Whether the wind is too strong to fly along the present leg.
    pub fn is_adrift(&self) -> bool {
        let leg = self.leg.filter(|_| !self.is_complete);
        leg.is_some_and(|leg| !leg.can_be_flown())
    }

    /// Whether the aircraft is back on the present leg, or has no leg to return to; its height counts where it can climb. A leg that
    /// begins at a place of the aircraft is a way back.
    pub fn is_back(&self, state: &MotionState, can_climb: bool) -> bool {
        let is_on = |leg: &Leg| {
            let position = leg.position(state.position_m, state.time_s);
            let above_m = if can_climb { position.above_m } else { 0.0 };
            position.cross_m.abs().max(above_m.abs()) <= BACK_WITHIN_M
                && leg.turn_onto_rad(state).abs() <= BACK_WITHIN_RAD
        };
        let is_own = self.restart.is_some_and(|own| own.index == self.index);
        self.is_complete || !self.is_unentered && !is_own && self.leg.as_ref().is_some_and(is_on)
    }

    pub(crate) fn legs<'a>(&self, route: &'a Route<'a>) -> Legs<'a> {
        Legs {
            route,
            course_rad: self.leg.map_or(0.0, |leg| leg.course_rad),
            restart: self.restart,
        }
    }

    /// Distance before the corner, or before the leg's end, metres.
    fn left_m(&self, leg: &Leg, state: &MotionState) -> f64 {
        let lead_m = self.corner.map_or(0.0, |corner| corner.lead_m);
        leg.length_m - lead_m - leg.position(state.position_m, state.time_s).along_m
    }

    /// Advances to the leg for a state at a time on the situation's clock, seconds.
    #[inline(never)]
    pub fn update(&mut self, route: &Route<'_>, state: &MotionState, time_s: f64) {
        let passed_s = time_s - self.time_s;
        self.time_s = time_s;
        let laid_for = (route.air(), route.climb_limits_rad);
        let is_first = self.leg.is_none();
        if is_first || self.is_cut || laid_for != (self.air, self.climb_limits_rad) {
            (self.air, self.climb_limits_rad) = laid_for;
            if !self.is_complete {
                self.load(route, state);
            }
        }
        if is_first {
            let is_behind = |leg: Leg| self.left_m(&leg, state) <= 0.0;
            self.is_unentered &= self.leg.is_some_and(is_behind);
        }
        self.update_turn(route, state);
        while let (Some(leg), false, false) = (self.leg, self.is_complete, self.is_unentered) {
            let is_over = self.left_m(&leg, state) <= 0.0;
            let goes_on = is_over && !self.returns_over_waypoint(route, (&leg, state), passed_s);
            if !goes_on || self.is_cut || route.meter.is_met() {
                break;
            }
            let next = self
                .corner
                .map(|corner| (corner.join.index, corner.is_turn_round));
            let (index, is_unentered) = next.unwrap_or((self.index + 1, false));
            self.go_to(route, state, index, is_unentered);
        }
        if self.is_adrift() {
            self.restart_here(route, state);
        }
    }

    /// Lays the leg and the corner.
    fn load(&mut self, route: &Route<'_>, state: &MotionState) {
        let legs = self.legs(route);
        self.is_cut = !route.meter.take(LEG);
        self.leg = legs.leg(self.index);
        self.corner = self
            .leg
            .filter(|_| !self.is_cut)
            .and_then(|leg| corner(&legs, self.index, &leg));
        self.is_cut |= route.meter.is_spent();
        if self.leg.is_none() {
            // Past the last waypoint, or no mission: hold track and height from here.
            self.is_complete = true;
            let track_rad = course_of(route.flyer.velocity_mps(state) + route.wind_mps);
            self.leg = Some(Leg::endless(state.position_m, track_rad, self.air));
        }
    }

    pub(crate) fn go_to(
        &mut self,
        route: &Route<'_>,
        state: &MotionState,
        index: usize,
        is_unentered: bool,
    ) {
        if index != self.index {
            self.kept_off = (f64::INFINITY, 0.0);
            self.missed = 0;
            (self.passes, self.nearest_m) = (0, f64::INFINITY);
        }
        self.index = index;
        self.is_unentered = is_unentered;
        self.turn = None;
        self.load(route, state);
    }

    /// Advances to the leg that begins at a waypoint.
    pub fn advance_to(&mut self, route: &Route<'_>, state: &MotionState, index: usize) {
        if index > self.index && !self.is_complete {
            self.go_to(route, state, index, false);
        }
    }

    /// Whether the aircraft flies along the leg, past its beginning, before its end and near it.
    fn has_entered(&self, leg: &Leg, state: &MotionState, radius_m: f64) -> bool {
        let position = leg.position(state.position_m, state.time_s);
        let [beside, alone] = ENTERED_RADII;
        let is_begun = position.along_m > LONG_RADII * radius_m;
        let within = if self.turn.is_some() || is_begun {
            beside
        } else {
            alone
        };
        position.along_m > 0.0
            && position.along_m < leg.length_m
            && position.cross_m.abs() < within * radius_m
            && leg.turn_onto_rad(state).abs() < ENTERED_RAD
    }

    /// Ends a turn round that has arrived, and drops one that the aircraft does not follow.
    fn update_turn(&mut self, route: &Route<'_>, state: &MotionState) {
        let Some(leg) = self.leg.filter(|_| self.is_unentered) else {
            return;
        };
        let radius_m = route.radius_m();
        if is_on_leg(&leg, state) || self.has_entered(&leg, state, radius_m) {
            self.join_anywhere();
        } else if let Some(turn) = self.turn {
            let since_s = self.time_s - turn.begun_s;
            let stages = turn.join.stages();
            let there = flown(route.flyer, &turn.from, stages, since_s, route.meter);
            if route.meter.is_spent() {
                return;
            }
            let planned_m = there.position_m + route.wind_mps * since_s;
            let off_m = planned_m.distance(state.position_m);
            let is_followed = off_m <= OFF_TURN_RADII * radius_m && since_s >= 0.0;
            let has_arrived = since_s >= turn.join.joined_s - 1e-9;
            if !is_followed || has_arrived {
                self.turn = None;
                self.is_unentered &= !is_followed && self.missed == 0;
                self.missed = self.missed.saturating_add(u8::from(!is_followed));
            }
        }
    }

    /// From when on a way onto the mission follows it, seconds from the decision: on its leg, or at the end of one that begins elsewhere than
    /// at its waypoint.
    pub fn back_s(&self, joined: &Join) -> f64 {
        let is_own = |restart: &Restart| restart.index == joined.index;
        let leg = self
            .leg
            .filter(|_| self.restart.as_ref().is_some_and(is_own));
        leg.map_or(joined.joined_s, |leg| {
            let left_m = (leg.length_m - joined.along_m).max(0.0);
            joined.joined_s + left_m / leg.ground_speed_mps.max(f64::MIN_POSITIVE)
        })
    }

    /// How long the leg leads straight on from a state, seconds: until its corner or its end; 0 off the leg.
    pub fn straight_for_s(&self, state: &MotionState) -> f64 {
        let leg = self
            .leg
            .filter(|leg| !self.is_unentered && is_on_leg(leg, state));
        leg.map_or(0.0, |leg| self.left_m(&leg, state) / leg.ground_speed_mps)
    }

    /// The course to hold if the aircraft is on its leg and no corner comes within `horizon_s`.
    pub fn straight_course_rad(
        &self,
        state: &MotionState,
        flyer: &Flyer,
        horizon_s: f64,
    ) -> Option<f64> {
        let leg = self
            .leg
            .filter(|leg| !self.is_unentered && is_on_leg(leg, state))?;
        let is_straight = self.corner.is_none() || self.straight_for_s(state) > horizon_s;
        let is_level = flyer.is_ideal() || state.bank_rad.abs() < LEVEL_BANK_RAD;
        (is_straight && is_level).then(|| state.course_rad + leg.turn_onto_rad(state))
    }

    /// Sets a command to the guidance along the mission from a state: onto the leg, and round the corners up to
    /// `horizon_s`. Returns the moment from which it is straight.
    #[inline(never)]
    pub fn guidance(
        &mut self,
        route: &Route<'_>,
        state: &MotionState,
        horizon_s: f64,
        command: &mut Maneuver,
    ) -> f64 {
        let onto = self.capture(route, state);
        command.set(onto.stages().iter().copied());
        let straight_s = self.round_corners(route, horizon_s, command, &onto);
        straight_s.unwrap_or(onto.joined_s)
    }

    /// The way onto the leg, or along it.
    #[inline(never)]
    fn capture(&mut self, route: &Route<'_>, state: &MotionState) -> Join {
        let leg = self.leg(state);
        if let Some(turn) = self.turning(route, state) {
            return turn;
        }
        if self.is_adrift() {
            let into_wind_rad = wrap_pi(course_of(-route.wind_mps) - state.course_rad);
            let mut held = Join::new(self.index, 0.0);
            let course_rad = state.course_rad + into_wind_rad;
            held.stages.push(Stage::turn(0.0, course_rad, 0.0));
            return held;
        }
        if is_on_leg(&leg, state) {
            let along_m = leg.position(state.position_m, state.time_s).along_m;
            let mut held = Join::new(self.index, along_m);
            let course_rad = state.course_rad + leg.turn_onto_rad(state);
            held.stages.push(route.stage(0.0, course_rad, &leg));
            return held;
        }
        let index = self.index;
        let onto_leg = || join(route, (index, &leg), state, INTERCEPT_RAD);
        let at = leg.position(state.position_m, state.time_s);
        let is_in_first_half = at.along_m.max(at.cross_m.abs()) < 0.5 * leg.length_m;
        let is_beside = at.along_m < leg.length_m
            && at.cross_m.abs() < ENTERED_RADII[1] * route.radius_m()
            && leg.turn_onto_rad(state).abs() < FRAC_PI_2;
        if (is_in_first_half || is_beside) && !self.is_unentered {
            // Near its leg and along it, or at its beginning, the aircraft leaves no leg out, however soon this one ends.
            return onto_leg();
        }
        let found = (self.way_back(route, state, INTERCEPT_RAD, MOST_LEGS))
            .or_else(|| self.direct_way_or_none(route, state));
        let Some(joined) = found else {
            return onto_leg();
        };
        self.advance_to(route, state, joined.index);
        joined
    }

    /// The rest of the turn round to the beginning of the leg; it begins now if none is in progress.
    #[inline(never)]
    fn turning(&mut self, route: &Route<'_>, state: &MotionState) -> Option<Join> {
        let leg = self.leg.filter(|_| self.is_unentered)?;
        let begins = || {
            let join = turn_round(route, (self.index, &leg), state)?;
            Some(Turn {
                join,
                from: *state,
                begun_s: self.time_s,
            })
        };
        self.turn = self.turn.or_else(begins);
        let turn = self.turn?;
        let since_s = self.time_s - turn.begun_s;
        let mut rest = Join::new(turn.join.index, turn.join.along_m);
        rest.stages.set_later(&turn.join.stages, since_s);
        rest.joined_s = turn.join.joined_s - since_s;
        Some(rest)
    }

    /// Appends the corners up to `horizon_s` to a manoeuvre that flies along a leg once it has joined it.
    /// Returns the moment from which it is straight, `None` without a corner.
    pub fn round_corners(
        &self,
        route: &Route<'_>,
        horizon_s: f64,
        maneuver: &mut Maneuver,
        joined: &Join,
    ) -> Option<f64> {
        let legs = self.legs(route);
        let (mut straight_s, mut along_m) = (joined.joined_s, joined.along_m);
        let mut turned = None;
        let is_here = joined.index == self.index;
        let mut leg = if is_here {
            self.leg
        } else {
            legs.leg(joined.index)
        }?;
        let mut ahead = if is_here {
            self.corner
        } else {
            corner(&legs, joined.index, &leg)
        };
        let after_s = |leg: &Leg, left_m: f64| left_m / leg.ground_speed_mps.max(f64::MIN_POSITIVE);
        while let Some(here) = &ahead {
            let left_m = leg.length_m - here.lead_m - along_m;
            let corner_s = straight_s + after_s(&leg, left_m).max(0.0);
            let stages = here.join.stages();
            // Corners beyond the room are for a later cycle: straight on is also a complete flight.
            let is_full = maneuver.room() < stages.len() + ROOM_TO_AVOID;
            if corner_s > horizon_s || is_full || route.meter.is_met() {
                break;
            }
            let onto_rad = maneuver.stages().last()?.course_rad - leg.air_course_rad;
            for stage in stages {
                maneuver.push(Stage {
                    start_s: corner_s + stage.start_s,
                    course_rad: onto_rad + stage.course_rad,
                    ..*stage
                });
            }
            straight_s = corner_s + here.join.joined_s;
            turned = Some(straight_s);
            along_m = here.join.along_m;
            let index = here.join.index;
            leg = legs.leg(index)?;
            ahead = corner(&legs, index, &leg);
        }
        let end_s = straight_s + after_s(&leg, leg.length_m - along_m);
        let is_sloped_end = ahead.is_none() && leg.climb_rad != 0.0 && end_s < horizon_s;
        if is_sloped_end && maneuver.room() > ROOM_TO_AVOID {
            // Beyond the last waypoint it flies level.
            maneuver.push(Stage {
                start_s: end_s.max(straight_s),
                climb_rad: 0.0,
                ..*maneuver.stages().last()?
            });
        }
        turned
    }
}

#[cfg(test)]
mod tests;

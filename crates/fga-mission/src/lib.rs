//! How does the aircraft follow its mission, and how does it get back onto it?
//!
//! | question | answer |
//! |---|---|
//! | which leg, and which command along it? | [`Progress`] |
//! | where is the aircraft on a leg? | [`leg`] |
//! | how does it get from one leg onto the next? | `corner` |
//! | which way onto the leg? | [`mod@join`] |
//! | which leg does a way onto the mission join? | `way_onto` |
//! | what where no leg can be joined, or a waypoint was missed? | `restart` |
//! | which way onto the beginning of the leg? | `turnaround` |
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

#[cfg(test)]
extern crate std;

mod aim;
mod corner;
pub mod join;
pub mod leg;
mod restart;
mod turnaround;
mod way_onto;

use self::corner::{Air, Corner, INTERCEPT_RAD, Legs, arrival, corner};
use self::join::{Join, JoinLimits, has_entered, is_on_leg, join};
use self::leg::Leg;
use self::restart::Restart;
use self::way_onto::MOST_LEGS;
use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::Meter;
use fga_proof::prediction::{Flyer, MotionState, flown};
use fga_proof::situation::{Mission, Passing};

/// Stages that corners leave free for the turns of an avoidance.
const ROOM_TO_AVOID: usize = 2;

/// Work of laying a leg and looking whether it is over.
const LEG: usize = 4;

/// A turn round is planned again when the aircraft is off it by this, turn radii: less than a leg is entered within.
const OFF_TURN_RADII: f64 = 0.2;

/// A moment from which a manoeuvre flies along a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Index of the waypoint at the start of the leg.
    pub index: usize,
    /// The moment, seconds from the decision.
    pub straight_s: f64,
    /// Distance along the leg at that time, metres.
    pub along_m: f64,
}

/// A turn round in progress.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    maneuver: Maneuver,
    from: MotionState,
    /// Its start and its arrival, seconds on the situation's clock.
    begun_s: f64,
    arrives_s: f64,
}

/// The mission's legs at an airspeed in a wind.
struct Laid<'a> {
    mission: &'a Mission<'a>,
    airspeed_mps: f64,
    wind_mps: Vec3,
    /// Course of a leg between waypoints above each other, radians.
    course_rad: f64,
    /// The leg that begins elsewhere than at its waypoint.
    restart: Option<Restart>,
}

impl Legs for Laid<'_> {
    fn leg(&self, index: usize) -> Option<Leg> {
        let waypoint_m = *self.mission.waypoints_m.get(index)?;
        let to = *self.mission.waypoints_m.get(index + 1)?;
        let restart = self.restart.filter(|restart| restart.index == index);
        let from = restart.map_or(waypoint_m, |restart| restart.from_m);
        Some(Leg::new(
            from,
            to,
            self.airspeed_mps,
            self.wind_mps,
            self.course_rad,
        ))
    }

    fn passing(&self, index: usize) -> Passing {
        self.mission.passing.get(index).copied().unwrap_or_default()
    }
}

/// The present leg, and the corner at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Index of the waypoint at the start of the leg.
    index: usize,
    leg: Option<Leg>,
    corner: Option<Corner>,
    /// Whether the aircraft must still enter the leg at its beginning, by a turn round.
    from_start: bool,
    turn: Option<Turn>,
    time_s: f64,
    wind_mps: Vec3,
    airspeed_mps: f64,
    climb_limits_rad: (f64, f64),
    complete: bool,
    /// Work of this step at which it finishes, work that it may do at most, and work done.
    work: (u32, u32, u32),
    /// Whether the corner was refused: it is planned in the next step.
    is_cut: bool,
    /// The leg at which the next search for a way onto the mission begins after a cut.
    looked_to: usize,
    /// The leg that begins at a place of the aircraft, not at its waypoint.
    restart: Option<Restart>,
    /// How often the aircraft has passed the last waypoint aside, hardly nearer than in its nearest pass, metres.
    passes: u8,
    nearest_m: f64,
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
            from_start: false,
            turn: None,
            time_s: 0.0,
            wind_mps: Vec3::ZERO,
            airspeed_mps: 0.0,
            climb_limits_rad: (0.0, 0.0),
            complete: false,
            work: (u32::MAX, u32::MAX, 0),
            is_cut: false,
            looked_to: 0,
            restart: None,
            passes: 0,
            nearest_m: f64::INFINITY,
        }
    }

    /// Begins a step, whose work finishes after `limit` units and is `most` units at most.
    pub const fn begin_step(&mut self, limit: u32, most: u32) {
        self.work = (limit, most, 0);
    }

    /// Allows some of them until they are taken.
    pub fn allow(&mut self, most: u32) {
        self.work.1 = self.work.1.min(most);
    }

    /// Work since the last call in this step.
    pub const fn take_work(&mut self) -> u32 {
        let (limit, most, done) = self.work;
        self.work = (limit.saturating_sub(done), most.saturating_sub(done), 0);
        done
    }

    /// A meter for the remaining work.
    const fn meter(&self) -> Meter {
        let (limit, most, done) = self.work;
        Meter::new(limit.saturating_sub(done), most.saturating_sub(done))
    }

    /// Counts what a meter has counted.
    const fn note(&mut self, meter: &Meter) {
        // Outside of a step nothing limits it.
        if self.work.1 < u32::MAX {
            self.work.2 = self.work.2.saturating_add(meter.done());
        }
    }

    /// Index of the waypoint at the start of the leg.
    pub const fn index(&self) -> usize {
        self.index
    }

    /// Whether the aircraft passed the last waypoint.
    pub const fn is_complete(&self) -> bool {
        self.complete
    }

    /// The present leg.
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

    const fn air<'a>(&self, flyer: &'a Flyer, meter: &'a Meter) -> Air<'a> {
        Air {
            flyer,
            wind_mps: self.wind_mps,
            climb_limits_rad: self.climb_limits_rad,
            meter,
        }
    }

    fn laid<'a>(&self, mission: &'a Mission<'a>) -> Laid<'a> {
        Laid {
            mission,
            airspeed_mps: self.airspeed_mps,
            wind_mps: self.wind_mps,
            course_rad: self.leg.map_or(0.0, |leg| leg.course_rad),
            restart: self.restart,
        }
    }

    /// Distance of the corner's start before the leg's end, metres.
    fn lead_m(&self) -> f64 {
        self.corner.map_or(0.0, |corner| corner.lead_m)
    }

    fn load(&mut self, mission: &Mission<'_>, state: &MotionState, flyer: &Flyer) {
        let laid = self.laid(mission);
        let meter = self.meter();
        self.is_cut = !meter.take(LEG);
        self.leg = laid.leg(self.index);
        self.corner = self
            .leg
            .filter(|_| !self.is_cut)
            .and_then(|leg| corner(&laid, self.index, &leg, &self.air(flyer, &meter)));
        self.is_cut |= meter.is_spent();
        self.note(&meter);
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

    /// Advances to the leg for `state` at `time_s` on the situation's clock.
    pub fn update(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        wind_mps: Vec3,
        (time_s, climb_limits_rad): (f64, (f64, f64)),
    ) {
        let airspeed_mps = flyer.airspeed_mps();
        let passed_s = time_s - self.time_s;
        self.time_s = time_s;
        if self.leg.is_none()
            || self.is_cut
            || wind_mps != self.wind_mps
            || airspeed_mps != self.airspeed_mps
            || climb_limits_rad != self.climb_limits_rad
        {
            (self.wind_mps, self.airspeed_mps) = (wind_mps, airspeed_mps);
            self.climb_limits_rad = climb_limits_rad;
            if !self.complete {
                self.load(mission, state, flyer);
            }
        }
        self.update_turn(state, flyer);
        while let (Some(leg), false, false) = (self.leg, self.complete, self.from_start) {
            let position = leg.position(state.position_m, state.time_s);
            let is_on = position.along_m < leg.length_m - self.lead_m();
            let flies_back = !is_on && self.flies_back(mission, (&leg, state, flyer), passed_s);
            if is_on || flies_back || self.is_cut || self.meter().is_met() {
                break;
            }
            let (next, turns_round) = self
                .corner
                .map_or((self.index + 1, false), |c| (c.next, c.is_turnaround));
            self.go_to(next, turns_round, mission, state, flyer);
        }
        if self.is_adrift() {
            self.begin_here(mission, state, flyer);
        }
    }

    fn go_to(
        &mut self,
        index: usize,
        from_start: bool,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
    ) {
        self.index = index;
        self.leg = None;
        self.from_start = from_start;
        self.turn = None;
        self.load(mission, state, flyer);
    }

    /// Ends a turn round that has arrived; forgets one that the aircraft does not follow.
    fn update_turn(&mut self, state: &MotionState, flyer: &Flyer) {
        let Some(leg) = self.leg.filter(|_| self.from_start) else {
            return;
        };
        let meter = self.meter();
        let radius_m = self.air(flyer, &meter).radius_m();
        if is_on_leg(&leg, state) || has_entered(&leg, state, radius_m, self.turn.is_some()) {
            self.turn = None;
            self.from_start = false;
        } else if let Some(turn) = self.turn {
            let since_s = self.time_s - turn.begun_s;
            let there = flown(flyer, &turn.from, &turn.maneuver, since_s, &meter);
            self.note(&meter);
            if meter.is_spent() {
                return;
            }
            let planned_m = there.position_m + self.wind_mps * since_s;
            let off_m = planned_m.distance(state.position_m);
            if !(0.0..=OFF_TURN_RADII * radius_m).contains(&off_m) || since_s < 0.0 {
                self.turn = None;
            } else if self.time_s >= turn.arrives_s - 1e-9 {
                self.turn = None;
                self.from_start = false;
            }
        }
    }

    /// Advances to the leg that begins at a waypoint.
    pub fn advance_to(
        &mut self,
        index: usize,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
    ) {
        if index > self.index && !self.complete {
            self.go_to(index, false, mission, state, flyer);
        }
    }

    /// The course to hold if the aircraft is on its leg and no corner comes within `horizon_s`.
    pub fn straight_on_rad(
        &self,
        state: &MotionState,
        flyer: &Flyer,
        horizon_s: f64,
    ) -> Option<f64> {
        let leg = self.leg.filter(|_| !self.from_start)?;
        let left_m = leg.length_m - self.lead_m() - leg.position(state.position_m, 0.0).along_m;
        let straight = left_m > leg.ground_speed_mps * horizon_s || self.corner.is_none();
        (straight && flyer.is_level_at(state) && is_on_leg(&leg, state))
            .then(|| state.course_rad + leg.turn_onto_rad(state))
    }

    /// How long the leg leads straight on from `state`, seconds: until its corner or its end; 0 off the leg.
    pub fn straight_for_s(&self, state: &MotionState) -> f64 {
        let leg = self
            .leg
            .filter(|leg| !self.from_start && is_on_leg(leg, state));
        leg.map_or(0.0, |leg| {
            let along_m = leg.position(state.position_m, state.time_s).along_m;
            (leg.length_m - self.lead_m() - along_m) / leg.ground_speed_mps
        })
    }

    /// The least time in which an aircraft can be on the line of the leg, on its course, seconds.
    pub fn least_s_onto_leg(&self, state: &MotionState, flyer: &Flyer) -> f64 {
        self.leg.map_or(0.0, |leg| {
            let flies = (flyer.airspeed_mps(), flyer.course_rate_radps());
            leg.least_s_onto(state, flies) + flyer.settles_late_s()
        })
    }

    /// The guidance along the mission from `state`: onto the leg, and round the corners up to
    /// `horizon_s`, with the moment from which it is straight.
    pub fn guidance(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        horizon_s: f64,
    ) -> (Maneuver, f64) {
        let leg = self.leg(state);
        let (low, high) = self.climb_limits_rad;
        let (mut maneuver, straight_s, along_m) = if let Some(join) = self.turning(state, flyer) {
            (join.maneuver, join.joined_s, join.along_m)
        } else if self.is_adrift() {
            let against_rad = libm::atan2(-self.wind_mps.y, -self.wind_mps.x);
            let course_rad = state.course_rad + wrap_pi(against_rad - state.course_rad);
            (Maneuver::turn(0.0, course_rad, 0.0), 0.0, 0.0)
        } else if is_on_leg(&leg, state) {
            let course_rad = state.course_rad + leg.turn_onto_rad(state);
            let climb_rad = leg.climb_rad.limited(low, high);
            let maneuver = Maneuver::turn(0.0, course_rad, climb_rad);
            (
                maneuver,
                0.0,
                leg.position(state.position_m, state.time_s).along_m,
            )
        } else {
            let limits = JoinLimits {
                intercept_rad: INTERCEPT_RAD,
                climb_limits_rad: self.climb_limits_rad,
            };
            let found = (self.way_back(mission, state, flyer, &limits, MOST_LEGS))
                .or_else(|| self.way_from_here(mission, state, flyer));
            let joined = if let Some((joined, index)) = found {
                self.advance_to(index, mission, state, flyer);
                joined
            } else {
                let meter = self.meter();
                let joined = join(flyer, &leg, state, &limits, &meter);
                self.note(&meter);
                joined
            };
            (joined.maneuver, joined.joined_s, joined.along_m)
        };
        let bend = Bend {
            index: self.index,
            straight_s,
            along_m,
        };
        self.round_corners(mission, flyer, horizon_s, &mut maneuver, bend)
            .map_or((maneuver, straight_s), |straight_s| (maneuver, straight_s))
    }

    /// The rest of the turn round to the beginning of the leg; it begins now if none is in progress.
    fn turning(&mut self, state: &MotionState, flyer: &Flyer) -> Option<Join> {
        let leg = self.leg.filter(|_| self.from_start)?;
        let meter = self.meter();
        if self.turn.is_none() {
            let found = Self::round_to_beginning(&leg, state, &self.air(flyer, &meter));
            let Some(found) = found.filter(|_| !meter.is_spent()) else {
                self.note(&meter);
                return None;
            };
            self.turn = Some(Turn {
                maneuver: found.maneuver,
                from: *state,
                begun_s: self.time_s,
                arrives_s: self.time_s + found.joined_s,
            });
        }
        let turn = self.turn?;
        let along_m = leg
            .position(arrival(&leg, &self.air(flyer, &meter)).position_m, 0.0)
            .along_m;
        self.note(&meter);
        Some(Join {
            maneuver: turn.maneuver.after(self.time_s - turn.begun_s),
            joined_s: turn.arrives_s - self.time_s,
            along_m,
            cross_m: 0.0,
            above_m: 0.0,
        })
    }

    /// Appends the corners up to `horizon_s` to a manoeuvre that flies along a leg from `bend` on.
    /// Returns the moment from which it is straight, `None` without a corner.
    pub fn round_corners(
        &mut self,
        mission: &Mission<'_>,
        flyer: &Flyer,
        horizon_s: f64,
        maneuver: &mut Maneuver,
        bend: Bend,
    ) -> Option<f64> {
        let meter = self.meter();
        let air = self.air(flyer, &meter);
        let turned = self.add_corners(mission, &air, horizon_s, maneuver, bend);
        self.note(&meter);
        turned
    }

    fn add_corners(
        &self,
        mission: &Mission<'_>,
        air: &Air<'_>,
        horizon_s: f64,
        maneuver: &mut Maneuver,
        bend: Bend,
    ) -> Option<f64> {
        let Bend {
            mut index,
            mut straight_s,
            mut along_m,
        } = bend;
        let laid = self.laid(mission);
        let mut turned = None;
        let is_here = index == self.index;
        let mut leg = if is_here { self.leg } else { laid.leg(index) }?;
        let mut ahead = if is_here {
            self.corner
        } else {
            corner(&laid, index, &leg, air)
        };
        while let Some(here) = ahead {
            let left_m = leg.length_m - here.lead_m - along_m;
            let corner_s = straight_s + (left_m / leg.ground_speed_mps.max(0.1)).max(0.0);
            let stages = here.maneuver.stages();
            // Corners beyond the room are for a later cycle: straight on is also a complete flight.
            let is_full = maneuver.room() < stages.len() + ROOM_TO_AVOID;
            if corner_s > horizon_s || is_full || air.meter.is_met() {
                break;
            }
            let course_rad = maneuver.stages().last()?.course_rad;
            for stage in stages {
                maneuver.push(Stage {
                    start_s: corner_s + stage.start_s,
                    course_rad: course_rad + stage.course_rad,
                    ..*stage
                });
            }
            straight_s = corner_s + here.duration_s;
            turned = Some(straight_s);
            along_m = here.along_m;
            index = here.next;
            leg = laid.leg(index)?;
            ahead = corner(&laid, index, &leg, air);
        }
        let end_s = straight_s + (leg.length_m - along_m) / leg.ground_speed_mps.max(0.1);
        if ahead.is_none()
            && leg.climb_rad != 0.0
            && end_s < horizon_s
            && maneuver.room() > ROOM_TO_AVOID
        {
            // Beyond the last waypoint it flies level.
            let start_s = end_s.max(straight_s);
            let last = *maneuver.stages().last()?;
            maneuver.push(Stage {
                start_s,
                climb_rad: 0.0,
                ..last
            });
        }
        turned
    }
}

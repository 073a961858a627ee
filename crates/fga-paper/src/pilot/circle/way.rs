//! The way round one obstacle at rest, over the ground and in a wind.
//!
//! The three turns are Algorithm 4's: away at the largest rate until the track over the ground is tangent to the
//! circle, round the circle, and back at the largest rate onto the line and the course before. In calm air they are
//! its arcs. In a wind the turns at the largest rate are trochoids over the ground, and the rate on the circle
//! follows the ground speed. A turn away that ends outside the circle keeps clear of it in any wind below the
//! airspeed, because its track bends away from the circle; so does the turn back.

use core::f64::consts::{PI, TAU};

use fga::Vec3;
use fga::angle::{direction, wrap_pi};
use fga::limit::Limit as _;
use fga::maneuver::{Maneuver, Stage};
use fga::prediction::{Flyer, MotionState};

use crate::algorithm_4::Phase;

/// Natural frequency of the motion back to the circle, rad/s.
const BACK_RADPS: f64 = 0.25;

/// The damping ratio of that motion.
const DAMPING: f64 = 0.8;

/// The gentlest turn, as a share of the largest course rate.
const LEAST_SHARE: f64 = 0.01;

/// Step in which a turn is searched for its end, seconds.
const STEP_S: f64 = 0.1;

/// Bisections of a time.
const BISECTIONS: u32 = 30;

/// Most pieces of flight between two commands.
const MOST_PIECES: u32 = 64;

/// A way that begins earlier follows the aircraft's line, seconds.
const RENEWED_S: f64 = 2.0;

/// A way is widened at most this often until its prediction keeps clear.
const MOST_WIDENINGS: u32 = 12;

/// A way that takes longer is none, seconds.
const LONGEST_S: f64 = 900.0;

/// Distance by which a way is planned wider than necessary, metres: more than what is flown between two
/// predicted points.
const SLACK_M: f64 = 0.02;

/// A turn back within this of its course has ended, radians.
const BACK_RAD: f64 = 1e-3;

/// A course that is past that along the line by less is turned back to it the shorter way, radians.
const PAST_RAD: f64 = 0.5;

/// The least share of the airspeed that a turn moves towards the centre of the circle.
const LEAST_GRIP: f64 = 0.3;

/// The vehicle and its air.
#[derive(Debug, Clone, Copy)]
pub(super) struct Air<'a> {
    pub(super) flyer: &'a Flyer,
    /// Level, metres per second.
    pub(super) wind_mps: Vec3,
    /// Time constant of the bank, seconds.
    pub(super) lag_s: f64,
    /// Time between two decisions, seconds.
    pub(super) period_s: f64,
    /// Factor by which the vehicle may turn faster than planned.
    pub(super) excess: f64,
}

impl Air<'_> {
    /// The aircraft some seconds later, its position over the ground.
    fn after(&self, state: &MotionState, command: &Stage, for_s: f64) -> MotionState {
        let mut now = *state;
        let mut left_s = for_s;
        for _ in 0..MOST_PIECES {
            let piece = self.flyer.next_piece(&now, command, f64::INFINITY);
            let step_s = left_s.min(piece.duration_s);
            now = self.flyer.advance(&now, &piece, step_s);
            left_s -= step_s;
            if left_s <= 0.0 {
                break;
            }
        }
        now.position_m += self.wind_mps * for_s;
        now
    }

    /// The aircraft after some seconds with the wings level.
    pub(super) fn straight(&self, state: &MotionState, for_s: f64) -> MotionState {
        self.after(state, &toward(state, self.settled_rad(state), 1.0), for_s)
    }

    /// The aircraft after some seconds of a manoeuvre.
    fn flown(&self, state: &MotionState, maneuver: &Maneuver, for_s: f64) -> MotionState {
        let mut now = *state;
        let mut at_s = 0.0;
        let starts = maneuver.stages().iter().map(|stage| stage.start_s);
        for until_s in starts.filter(|start_s| *start_s > 0.0).chain([for_s]) {
            let until_s = until_s.min(for_s);
            if until_s <= at_s {
                continue;
            }
            let command = maneuver.stage_at(at_s).map_or_else(
                || toward(&now, self.settled_rad(&now), 1.0),
                |stage| toward(&now, stage.course_rad, stage.rate_share),
            );
            now = self.after(&now, &command, until_s - at_s);
            at_s = until_s;
        }
        now
    }

    /// Course once the wings are level, radians.
    fn settled_rad(&self, state: &MotionState) -> f64 {
        state.course_rad + self.flyer.rollout_rad(state.bank_rad)
    }

    /// Level velocity over the ground on a course through the air, metres per second.
    fn ground_mps(&self, state: &MotionState, course_rad: f64) -> Vec3 {
        let level_mps = self.flyer.airspeed_mps() * libm::cos(state.climb_rad);
        direction(course_rad, 0.0) * level_mps + self.wind_mps
    }
}

fn toward(state: &MotionState, course_rad: f64, rate_share: f64) -> Stage {
    Stage {
        rate_share,
        ..Stage::turn(0.0, course_rad, state.climb_rad)
    }
}

/// To the left of a level vector.
fn left_of(level: Vec3) -> Vec3 {
    Vec3::new(-level.y, level.x, 0.0)
}

/// A way round one obstacle, awaited or flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    phase: Phase,
    /// Side of the first and the third turn, +1 to the left.
    side: f64,
    /// A point of the line before and after it, and its direction over the ground.
    line_m: Vec3,
    along: Vec3,
    obstacle_m: Vec3,
    /// Distance from the obstacle that the way is planned to keep, metres.
    kept_m: f64,
    /// The circle of the second turn over the ground, metres. It touches the kept one from outside where the
    /// turn away ends.
    circle_m: f64,
    centre_m: Vec3,
    /// Start of the first turn and end of the present one, seconds on the situation's clock.
    start_s: f64,
    ends_s: f64,
}

impl Way {
    /// A way that begins at the latest moment from which it is predicted to keep `least_m` from the obstacle.
    ///
    /// `None` where no way keeps it: seen too late, or too much wind.
    pub(super) fn plan(
        (time_s, state): (f64, &MotionState),
        obstacle_m: Vec3,
        least_m: f64,
        air: &Air<'_>,
    ) -> Option<Self> {
        let along = air
            .ground_mps(state, air.settled_rad(state))
            .try_normalize()?;
        let offset_m = (obstacle_m - state.position_m).with_z(0.0);
        // Dead ahead the turn goes to the right, by the rules of the air.
        let is_right = left_of(along).dot(offset_m) < 0.0;
        let mut way = Self {
            phase: Phase::Waiting,
            side: if is_right { 1.0 } else { -1.0 },
            line_m: state.position_m,
            along,
            obstacle_m,
            kept_m: 0.0,
            circle_m: 0.0,
            centre_m: obstacle_m,
            start_s: time_s,
            ends_s: f64::INFINITY,
        };
        way.keep(least_m + SLACK_M, state, air);
        for _ in 0..MOST_WIDENINGS {
            let wait_s = way.wait_s(state, air);
            way.start_s = time_s + wait_s.unwrap_or(0.0);
            let begun = air.straight(state, wait_s.unwrap_or(0.0));
            let found_m = way.least_m(&begun, air)?;
            if found_m >= least_m {
                return Some(way);
            }
            // From here it cannot begin earlier.
            wait_s?;
            way.keep(way.kept_m + least_m - found_m + SLACK_M, state, air);
        }
        None
    }

    /// Plans to keep a distance.
    fn keep(&mut self, kept_m: f64, state: &MotionState, air: &Air<'_>) {
        self.kept_m = kept_m;
        // With the wind behind, the circle takes the largest rate at this radius.
        let level = libm::cos(state.climb_rad);
        let faster = 1.0 + air.wind_mps.length() / (air.flyer.airspeed_mps() * level);
        let tightest_m = air.flyer.turn_radius_m() * level * faster * faster;
        self.circle_m = kept_m.max(tightest_m);
    }

    /// Follows the aircraft's line shortly before the way begins; begins it if its moment is past.
    pub(super) fn renew(&mut self, (time_s, state): (f64, &MotionState), air: &Air<'_>) {
        if self.phase != Phase::Waiting || self.start_s - time_s > RENEWED_S {
            return;
        }
        let along = air
            .ground_mps(state, air.settled_rad(state))
            .try_normalize();
        self.along = along.unwrap_or(self.along);
        self.line_m = state.position_m;
        self.start_s = time_s + self.wait_s(state, air).unwrap_or(0.0);
    }

    /// Range at which a way begins, metres; see [`PaperPilot`](crate::pilot::PaperPilot)'s sight.
    pub(super) fn sight_m(along: Vec3, left_m: f64, least_m: f64, air: &Air<'_>) -> Option<f64> {
        let airspeed_mps = air.flyer.airspeed_mps();
        let across = air.wind_mps.dot(left_of(along)) / airspeed_mps;
        if across.abs() >= 1.0 {
            return None;
        }
        // A turn of three quarters of a circle begins nearer than this.
        let turn_s = 1.5 * PI / air.flyer.course_rate_radps() + 10.0 * air.lag_s;
        let far_m = 2.0 * least_m + turn_s * (airspeed_mps + air.wind_mps.length());
        let state = MotionState {
            time_s: 0.0,
            position_m: -along * far_m - left_of(along) * left_m,
            course_rad: libm::atan2(along.y, along.x) - libm::asin(across),
            climb_rad: 0.0,
            bank_rad: 0.0,
        };
        let closes = air.ground_mps(&state, state.course_rad).dot(along) > 0.0;
        let way = Self::plan((0.0, &state), Vec3::ZERO, least_m, air).filter(|_| closes)?;
        Some(way.distance_m(&air.straight(&state, way.start_s)))
    }

    pub(super) const fn phase(&self) -> Phase {
        self.phase
    }

    pub(super) const fn start_s(&self) -> f64 {
        self.start_s
    }

    /// Distance from the obstacle, metres.
    pub(super) fn distance_m(&self, state: &MotionState) -> f64 {
        (self.obstacle_m - state.position_m).with_z(0.0).length()
    }

    /// Direction of its line over the ground.
    pub(super) const fn along(&self) -> Vec3 {
        self.along
    }

    /// The longest time after which the turn away still ends outside the circle, seconds; `None` if none does.
    fn wait_s(&self, state: &MotionState, air: &Air<'_>) -> Option<f64> {
        let keeps = |wait_s: f64| {
            let begun = air.straight(state, wait_s);
            self.turn_away(&begun, air)
                .is_some_and(|(_, end)| self.distance_m(&end) >= self.kept_m)
        };
        if !keeps(0.0) {
            return None;
        }
        // Abeam it is too late.
        let ground_mps = air
            .ground_mps(state, air.settled_rad(state))
            .dot(self.along);
        let abeam_m = (self.obstacle_m - state.position_m).dot(self.along);
        let (mut early_s, mut late_s) = (0.0, abeam_m.max(0.0) / ground_mps.max(1e-3));
        for _ in 0..BISECTIONS {
            let middle_s = 0.5 * (early_s + late_s);
            if keeps(middle_s) {
                early_s = middle_s;
            } else {
                late_s = middle_s;
            }
        }
        Some(early_s)
    }

    /// The end of the turn away from here: its time, and the state from which rolling out ends tangent to the circle.
    fn turn_away(&self, state: &MotionState, air: &Air<'_>) -> Option<(f64, MotionState)> {
        let target = toward(state, state.course_rad + self.side * TAU, 1.0);
        let is_tangent = |now: &MotionState| {
            let ground_mps = air.ground_mps(now, air.settled_rad(now));
            ground_mps.dot((self.obstacle_m - now.position_m).with_z(0.0)) <= 0.0
        };
        let mut now = *state;
        let mut after_s = 0.0;
        while !is_tangent(&now) {
            if (now.course_rad - state.course_rad).abs() > 1.5 * PI || after_s > LONGEST_S {
                return None;
            }
            let next = air.after(&now, &target, STEP_S);
            if is_tangent(&next) {
                let (mut early_s, mut late_s) = (0.0, STEP_S);
                for _ in 0..BISECTIONS {
                    let middle_s = 0.5 * (early_s + late_s);
                    if is_tangent(&air.after(&now, &target, middle_s)) {
                        late_s = middle_s;
                    } else {
                        early_s = middle_s;
                    }
                }
                return Some((after_s + late_s, air.after(&now, &target, late_s)));
            }
            now = next;
            after_s += STEP_S;
        }
        Some((after_s, now))
    }

    /// Course rate that brings the aircraft onto its circle and keeps it there, radians per second, positive to
    /// the left. The bank follows with a lag, so the rate is that of the moment at which the bank has followed.
    fn round_radps(&self, state: &MotionState, air: &Air<'_>) -> f64 {
        let radps = air.flyer.rate_radps(state.bank_rad);
        let full_radps = air.flyer.course_rate_radps();
        let on = toward(
            state,
            state.course_rad + TAU.copysign(radps),
            (radps.abs() / full_radps).min(1.0),
        );
        let then = air.after(state, &on, air.lag_s);
        let offset_m = (self.centre_m - then.position_m).with_z(0.0);
        let distance_m = offset_m.length().max(1.0);
        let inwards = offset_m / distance_m;
        let ground_mps = air.ground_mps(&then, then.course_rad);
        let leaving_mps = -inwards.dot(ground_mps);
        let needed_mps2 = (ground_mps.length_squared() - leaving_mps * leaving_mps) / distance_m
            + 2.0 * DAMPING * BACK_RADPS * leaving_mps
            + BACK_RADPS * BACK_RADPS * (distance_m - self.circle_m);
        // A turn changes the velocity across the heading, which the wind holds off the tangent.
        let air_mps = ground_mps - air.wind_mps;
        let grip_mps = -self.side * left_of(air_mps).dot(inwards);
        -self.side * needed_mps2 / (grip_mps.max(LEAST_GRIP * air_mps.length()) * air.excess)
    }

    /// Angle of the turn back onto the course along the line, radians, negative where the course is a little past
    /// it; `None` where the wind across is too strong.
    fn left_rad(&self, state: &MotionState, air: &Air<'_>) -> Option<f64> {
        let across = air.wind_mps.dot(left_of(self.along))
            / (air.flyer.airspeed_mps() * libm::cos(state.climb_rad));
        let home_rad =
            libm::atan2(self.along.y, self.along.x) - libm::asin(across.limited(-1.0, 1.0));
        let left_rad = wrap_pi(self.side * (home_rad - state.course_rad));
        let is_past = left_rad < -PAST_RAD;
        (across.abs() < 1.0).then_some(if is_past { left_rad + TAU } else { left_rad })
    }

    /// Distance beside the line, on the side of the first turn, after a turn back from here, metres; `None`
    /// unless the aircraft flies towards the line.
    fn beside_m(&self, state: &MotionState, air: &Air<'_>) -> Option<f64> {
        let aside = left_of(self.along) * self.side;
        if air.ground_mps(state, air.settled_rad(state)).dot(aside) >= 0.0 {
            return None;
        }
        let left_rad = self.left_rad(state, air)?;
        let back = toward(state, state.course_rad + self.side * left_rad, 1.0);
        let for_s = left_rad.abs() / air.flyer.course_rate_radps() + 8.0 * air.lag_s;
        let end = air.after(state, &back, for_s);
        Some((end.position_m - self.line_m).dot(aside))
    }

    /// The command from now on, and the phase that it flies.
    pub(super) fn command(
        &mut self,
        (time_s, state): (f64, &MotionState),
        air: &Air<'_>,
    ) -> Maneuver {
        let mut now = *state;
        let mut at_s = 0.0;
        if matches!(self.phase, Phase::Waiting | Phase::TurningAway) {
            at_s = (self.start_s - time_s).max(0.0);
            // The period in which the first turn begins decides it.
            if at_s < air.period_s {
                self.phase = Phase::TurningAway;
            }
            if at_s > 0.0 {
                now = air.straight(state, at_s);
            }
        }
        let has_ended = time_s >= self.ends_s - 1e-9;
        if has_ended && matches!(self.phase, Phase::RoundObstacle | Phase::TurningBack) {
            self.phase = Phase::TurningBack;
            self.ends_s = f64::INFINITY;
        }
        let mut maneuver = Maneuver::hold();
        let stage = |start_s: f64, course_rad: f64, rate_share: f64| Stage {
            start_s,
            course_rad,
            climb_rad: state.climb_rad,
            rate_share: rate_share.limited(LEAST_SHARE, 1.0),
        };
        if matches!(self.phase, Phase::Waiting | Phase::TurningAway) {
            let end = self.turn_away(&now, air);
            let (after_s, end) = end.unwrap_or((f64::INFINITY, now));
            if self.phase == Phase::TurningAway && (has_ended || after_s <= 1e-9) {
                self.phase = Phase::RoundObstacle;
                self.ends_s = f64::INFINITY;
                self.centre_on(state);
            } else {
                let course_rad = if after_s.is_finite() {
                    air.settled_rad(&end)
                } else {
                    now.course_rad + self.side * PI
                };
                maneuver.push(stage(at_s, course_rad, 1.0));
                at_s += after_s;
                if self.phase == Phase::TurningAway {
                    self.ends_s = time_s + at_s;
                }
                if at_s >= air.period_s {
                    return maneuver;
                }
                self.centre_on(&end);
                now = end;
            }
        }
        if matches!(self.phase, Phase::TurningBack | Phase::Done) {
            let settled = MotionState {
                course_rad: air.settled_rad(state),
                ..*state
            };
            let left_rad = self.left_rad(&settled, air).unwrap_or(0.0);
            if left_rad < BACK_RAD {
                self.phase = Phase::Done;
            }
            let turn_rad = self.left_rad(state, air).unwrap_or(0.0);
            maneuver.push(stage(0.0, state.course_rad + self.side * turn_rad, 1.0));
            return maneuver;
        }
        let radps = self.round_radps(&now, air);
        let share = radps.abs() / air.flyer.course_rate_radps();
        let round = stage(at_s, now.course_rad + PI.copysign(radps), share);
        maneuver.push(round);
        if self.phase == Phase::RoundObstacle {
            let target = toward(&now, round.course_rad, round.rate_share);
            let next = air.after(&now, &target, air.period_s);
            let beside_m = [self.beside_m(&now, air), self.beside_m(&next, air)];
            let back_s = match beside_m {
                [Some(now_m), _] if now_m <= 0.0 => 0.0,
                [Some(now_m), Some(next_m)] if next_m <= 0.0 => {
                    air.period_s * now_m / (now_m - next_m)
                }
                _ => return maneuver,
            };
            let from = air.after(&now, &target, back_s);
            let turn_rad = self.left_rad(&from, air).unwrap_or(0.0);
            maneuver.push(stage(back_s, from.course_rad + self.side * turn_rad, 1.0));
            self.ends_s = time_s + back_s;
        }
        maneuver
    }

    /// Lays the circle where the turn away ends: tangent there, and about the kept one.
    fn centre_on(&mut self, state: &MotionState) {
        let to_obstacle = (self.obstacle_m - state.position_m)
            .with_z(0.0)
            .normalize_or_zero();
        self.centre_m = self.obstacle_m + to_obstacle * (self.circle_m - self.kept_m);
    }

    /// Least distance from the obstacle if the way begins now, metres; `None` if it does not end.
    fn least_m(&self, state: &MotionState, air: &Air<'_>) -> Option<f64> {
        let mut way = Self {
            line_m: state.position_m,
            start_s: 0.0,
            ..*self
        };
        let mut now = *state;
        let (mut time_s, mut least_m) = (0.0, self.distance_m(state));
        while time_s < LONGEST_S {
            let maneuver = way.command((time_s, &now), air);
            if way.phase == Phase::Done {
                return Some(least_m);
            }
            let half = air.flown(&now, &maneuver, 0.5 * air.period_s);
            now = air.flown(&now, &maneuver, air.period_s);
            least_m = least_m
                .min(self.distance_m(&half))
                .min(self.distance_m(&now));
            time_s += air.period_s;
        }
        None
    }
}

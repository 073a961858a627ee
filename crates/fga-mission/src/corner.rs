//! From one leg of the mission onto the next: the only place that plans corners.
//!
//! | corner | flight |
//! |---|---|
//! | fly-by, room for the tangent arc | the arc |
//! | fly-by of a sharp corner between short legs | a later turn, through the next leg and back onto it |
//! | no room for a turn of either kind: near survey lines, turns back | over the waypoint, then a teardrop, bulb or race-track to the beginning of the next sufficiently long leg |
//! | fly-over | over the waypoint; then the turn onto the next leg where it overshoots by little, else a loop back over the waypoint on the next leg's course |
//! | a chain of legs shorter than the turn | the first leg behind them that the aircraft can join |
//!
//! Course and cross-track distance as in [`super::leg`].

use crate::join::{Join, JoinLimits, join};
use crate::leg::Leg;
use crate::turnaround::{Arrival, turnaround};
use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::{COMPARED, Meter};
use fga_proof::prediction::{Flyer, MotionState, flown};
use fga_proof::situation::{FLY_OVER_WITHIN_M, Passing};

/// A turn beyond this never uses a fly-by, radians (137°): its arc would begin tan(1.2) = 2.6 turn radii before the waypoint.
const MOST_FLY_BY_RAD: f64 = 2.4;

/// A tangent arc may begin this share of the longer leg before the waypoint: cut at both ends, 91 % of a survey line are flown
/// (`fga-experiments missions` counts the share of each leg).
const CUT_SHARE: f64 = 0.045;

/// A sharper fly-by begins this many turn radii before its waypoint and overshoots the next leg (`fga-experiments missions`).
const LATE_RADII: f64 = 0.85;

/// Guidance, and an overshoot, come back onto a leg at this angle, radians (45°): as fast across it as along it.
pub(super) const INTERCEPT_RAD: f64 = 0.785;

/// A leg of at least this many turn radii is no part of a chain of short ones, and never skipped before it was begun; a way joins a
/// leg at most as far before its beginning. Two turn diameters (`fga-experiments missions`).
pub(super) const LONG_RADII: f64 = 4.0;

/// A leg shorter than this many turn radii between two corners may merge into one turn: half a circle spans two radii.
const SHORT_RADII: f64 = 2.0;

/// Most legs that one corner skips.
const MOST_IN_CHAIN: usize = 24;

/// The inputs of a corner besides the legs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Air<'a> {
    /// The vehicle's motion.
    pub(crate) flyer: &'a Flyer,
    /// Velocity of the air over the ground, metres per second.
    pub(crate) wind_mps: Vec3,
    /// Steepest descent and climb, radians.
    pub(crate) climb_limits_rad: (f64, f64),
    /// Counts the work.
    pub(crate) meter: &'a Meter,
}

impl Air<'_> {
    /// Radius of the tightest real turn, metres.
    pub(crate) fn radius_m(&self) -> f64 {
        self.flyer.turn_radius_m()
    }

    fn is_still_and_ideal(&self) -> bool {
        self.flyer.is_ideal() && self.wind_mps == Vec3::ZERO
    }

    /// Distance in which an aircraft with bank lag settles on a leg after a turn, metres.
    fn settling_m(&self) -> f64 {
        if self.flyer.is_ideal() {
            return 0.0;
        }
        let quarter = Maneuver::turn(0.0, core::f64::consts::FRAC_PI_2, 0.0);
        let end = flown(self.flyer, &still(0.0), &quarter, f64::INFINITY, self.meter);
        // The effect of the lag on a quarter turn, at either end of it.
        let late_m = (end.position_m.x - self.radius_m()).max(0.0);
        self.radius_m() + 4.0 * late_m
    }
}

fn still(course_rad: f64) -> MotionState {
    MotionState {
        course_rad,
        ..MotionState::ahead(0.0)
    }
}

/// A corner between two legs of the mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Distance of its start before the leg's end, metres.
    pub(crate) lead_m: f64,
    /// Index of the waypoint at the start of the next flown leg.
    pub(crate) next: usize,
    /// Whether the aircraft enters the next leg at its beginning, after a turn round.
    pub(crate) is_turnaround: bool,
    /// The manoeuvre, in time from its start, course from the leg's course through the air.
    pub(crate) maneuver: Maneuver,
    /// Its duration, seconds.
    pub(crate) duration_s: f64,
    /// Distance of its end along the next leg, metres.
    pub(crate) along_m: f64,
}

/// The legs of a mission, laid for an aircraft in a wind.
pub(crate) trait Legs {
    /// The leg that begins at a waypoint.
    fn leg(&self, index: usize) -> Option<Leg>;
    /// How the waypoint with an index is passed.
    fn passing(&self, index: usize) -> Passing;
}

/// Distance of the start of a fly-by before the end of the leg at `index`, metres; 0 for a fly-over
/// waypoint.
fn lead_m(legs: &impl Legs, index: usize, leg: &Leg, next: &Leg, air: &Air<'_>) -> f64 {
    if legs.passing(index + 1) == Passing::FlyOver {
        return 0.0;
    }
    let turn = wrap_pi(next.course_rad - leg.course_rad).abs();
    if turn > MOST_FLY_BY_RAD {
        return 0.0;
    }
    let radius_m = air.radius_m();
    let tangent = tangent_m(leg, next, air);
    let longer_m = leg.length_m.max(next.length_m);
    let lead = if tangent <= CUT_SHARE * longer_m {
        tangent
    } else {
        tangent.min(LATE_RADII * radius_m + (tangent - still_tangent_m(turn, radius_m)).max(0.0))
    };
    if lead > leg.length_m || lead > next.length_m {
        0.0
    } else {
        lead
    }
}

fn still_tangent_m(turn_rad: f64, radius_m: f64) -> f64 {
    radius_m * libm::tan(0.5 * turn_rad)
}

/// Distance before the waypoint of the start of the turn from one leg onto the next that ends on it, metres:
/// in wind and with bank lag from the displacement of the real turn.
fn tangent_m(leg: &Leg, next: &Leg, air: &Air<'_>) -> f64 {
    let turn = wrap_pi(next.course_rad - leg.course_rad);
    let plain = still_tangent_m(turn.abs(), air.radius_m());
    let (sin, cos) = libm::sincos(turn);
    if air.is_still_and_ideal() || sin.abs() < 0.02 {
        return plain;
    }
    let air_turn = wrap_pi(next.air_course_rad - leg.air_course_rad);
    let maneuver = Maneuver::turn(0.0, leg.air_course_rad + air_turn, 0.0);
    let from = still(leg.air_course_rad);
    let end = flown(air.flyer, &from, &maneuver, f64::INFINITY, air.meter);
    let moved = end.position_m + air.wind_mps * end.time_s;
    // In the frame of the leg: forward and left.
    let (s, c) = libm::sincos(leg.course_rad);
    let (forward, left) = (c * moved.x + s * moved.y, c * moved.y - s * moved.x);
    let on_next = left / sin;
    (forward - on_next * cos).max(0.0)
}

/// The corner at the end of a leg; `None` after the last one.
pub(crate) fn corner(legs: &impl Legs, index: usize, leg: &Leg, air: &Air<'_>) -> Option<Corner> {
    let next = legs.leg(index + 1)?;
    let turn = wrap_pi(next.course_rad - leg.course_rad).abs();
    let lead = lead_m(legs, index, leg, &next, air);
    let lead_after = |at: usize, leg: &Leg| {
        legs.leg(at + 1).map_or(f64::NEG_INFINITY, |after| {
            lead_m(legs, at, leg, &after, air)
        })
    };
    let is_over = legs.passing(index + 1) == Passing::FlyOver;
    let may_turn = if is_over {
        // Over the waypoint, then onto the next leg: how far beyond that one?
        let overshoot = still_tangent_m(turn.min(2.0), air.radius_m()) * libm::sin(turn).abs();
        turn < 0.5 && overshoot <= FLY_OVER_WITHIN_M
    } else {
        turn <= MOST_FLY_BY_RAD
    };
    if may_turn {
        if let Some(arc) = arc(index, leg, &next, lead, lead_after(index + 1, &next), air) {
            return Some(arc);
        }
        if let Some(found) = chain(legs, index, leg, lead, air, lead_after) {
            return Some(found);
        }
    }
    // Turn round: onto the next leg, or over a short one onto the leg behind it.
    let short = next.length_m < SHORT_RADII * air.radius_m();
    let target = if short && legs.leg(index + 2).is_some() {
        index + 2
    } else {
        index + 1
    };
    turn_round(legs, leg, target, air)
}

/// The tangent arc, if both legs have room for it.
fn arc(
    index: usize,
    leg: &Leg,
    next: &Leg,
    lead: f64,
    lead_after: f64,
    air: &Air<'_>,
) -> Option<Corner> {
    let turn = wrap_pi(next.air_course_rad - leg.air_course_rad);
    let ground_turn = wrap_pi(next.course_rad - leg.course_rad);
    let plain = still_tangent_m(ground_turn.abs(), air.radius_m());
    let is_tangent = if air.is_still_and_ideal() {
        lead == plain
    } else {
        lead > 0.0 && lead >= tangent_m(leg, next, air)
    };
    if !is_tangent || lead + lead_after.max(0.0) > next.length_m {
        return None;
    }
    let (low, high) = air.climb_limits_rad;
    Some(Corner {
        lead_m: lead,
        next: index + 1,
        is_turnaround: false,
        maneuver: Maneuver::turn(0.0, turn, next.climb_rad.limited(low, high)),
        duration_s: turn.abs() / air.flyer.course_rate_radps(),
        along_m: lead,
    })
}

/// The first leg behind the corner that the aircraft joins before its end.
fn chain(
    legs: &impl Legs,
    index: usize,
    leg: &Leg,
    lead: f64,
    air: &Air<'_>,
    lead_after: impl Fn(usize, &Leg) -> f64,
) -> Option<Corner> {
    let long_m = LONG_RADII * air.radius_m();
    let exit = at_exit(leg, lead, air);
    let limits = JoinLimits {
        intercept_rad: INTERCEPT_RAD,
        climb_limits_rad: air.climb_limits_rad,
    };
    for at in index + 1..=index + MOST_IN_CHAIN {
        if air.meter.is_met() {
            return None;
        }
        let candidate = legs.leg(at)?;
        let is_last = legs.leg(at + 1).is_none();
        let turn = wrap_pi(candidate.course_rad - leg.course_rad).abs();
        if at > index + 1
            && turn > MOST_FLY_BY_RAD
            && candidate.length_m >= SHORT_RADII * air.radius_m()
        {
            // A turn back beyond short legs: not deep into the leg, but onto its beginning.
            return turn_round(legs, leg, at, air);
        }
        let joined = join(air.flyer, &candidate, &exit, &limits, air.meter);
        let room_m = candidate.length_m - lead_after(at, &candidate).max(0.0);
        if joined.is_on_leg() && (joined.along_m <= room_m || is_last) {
            if !passes_all(legs, (index + 1, at), &exit, &joined, air) {
                return None;
            }
            return Some(Corner {
                lead_m: lead,
                next: at,
                is_turnaround: false,
                maneuver: relative(&joined.maneuver, leg.air_course_rad),
                duration_s: joined.joined_s,
                along_m: joined.along_m,
            });
        }
        if candidate.length_m >= long_m || legs.passing(at + 1) == Passing::FlyOver {
            return turn_round(legs, leg, at, air);
        }
    }
    None
}

/// Whether a way passes the waypoints from `first` to before `last` within a turn radius, or they
/// lie on a curve of gentle corners, which it follows as closely as it can.
fn passes_all(
    legs: &impl Legs,
    (first, last): (usize, usize),
    from: &MotionState,
    joined: &Join,
    air: &Air<'_>,
) -> bool {
    /// Corners up to this make a curve, radians (46°: circles drawn with eight corners or more).
    const GENTLE_RAD: f64 = 0.8;
    /// Number of checked positions on the way.
    const PLACES: usize = 24;
    if first == last {
        return true;
    }
    if !air.meter.take((last - first + 1) * PLACES / COMPARED) {
        return false;
    }
    let mut places = [Vec3::ZERO; PLACES + 1];
    let mut state = *from;
    for (k, place) in places.iter_mut().enumerate() {
        let at_s = joined.joined_s * k as f64 / PLACES as f64;
        state = flown(air.flyer, &state, &joined.maneuver, at_s, air.meter);
        *place = state.position_m + air.wind_mps * at_s;
    }
    let mut before = legs.leg(first.saturating_sub(1));
    let mut is_gentle = true;
    let mut misses = false;
    for at in first..=last {
        let here = legs.leg(at);
        if let (Some(before), Some(here)) = (before, here) {
            is_gentle &= wrap_pi(here.course_rad - before.course_rad).abs() <= GENTLE_RAD;
            let nearest_m = places
                .iter()
                .map(|place| *place - here.from_m)
                .map(|offset| libm::hypot(offset.x, offset.y))
                .fold(f64::INFINITY, f64::min);
            misses |= nearest_m > air.radius_m();
        }
        before = here;
    }
    is_gentle || !misses
}

/// Over the waypoint and round to the beginning of a leg.
fn turn_round(legs: &impl Legs, leg: &Leg, target: usize, air: &Air<'_>) -> Option<Corner> {
    let onto = legs.leg(target)?;
    let exit = at_exit(leg, 0.0, air);
    let to = arrival(&onto, air);
    let found = turnaround(air, &exit, &to);
    let (maneuver, duration_s) = found.map_or((Maneuver::hold(), 0.0), |found| {
        (
            relative(&found.maneuver, leg.air_course_rad),
            found.arrives_s,
        )
    });
    Some(Corner {
        lead_m: 0.0,
        next: target,
        is_turnaround: true,
        maneuver,
        duration_s,
        along_m: -air.settling_m(),
    })
}

/// The arrival of a turn round onto a leg: at its beginning, or before it with bank lag.
pub(crate) fn arrival(leg: &Leg, air: &Air<'_>) -> Arrival {
    let (low, high) = air.climb_limits_rad;
    Arrival {
        position_m: leg.level_point_m(-air.settling_m()),
        course_rad: leg.air_course_rad,
        climb_rad: leg.climb_rad.limited(low, high),
    }
}

/// The aircraft on its leg, some way before its end.
fn at_exit(leg: &Leg, lead_m: f64, air: &Air<'_>) -> MotionState {
    let (low, high) = air.climb_limits_rad;
    MotionState {
        time_s: 0.0,
        position_m: leg.point_m(leg.length_m - lead_m),
        course_rad: leg.air_course_rad,
        climb_rad: leg.climb_rad.limited(low, high),
        bank_rad: 0.0,
    }
}

fn relative(maneuver: &Maneuver, course_rad: f64) -> Maneuver {
    let mut turned = Maneuver::hold();
    for stage in maneuver.stages() {
        turned.push(Stage {
            course_rad: stage.course_rad - course_rad,
            ..*stage
        });
    }
    turned
}

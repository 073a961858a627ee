//! From one leg of the mission onto the next: the only place that plans corners.
//!
//! | corner | flight |
//! |---|---|
//! | fly-by, room for the tangent arc | the arc |
//! | fly-by of a sharp corner between short legs | a later turn, through the next leg and back onto it |
//! | no room for a turn of either kind: near survey lines, turns back | over the waypoint, then a teardrop, bulb or race-track to the beginning of the next sufficiently long leg |
//! | fly-over | over the waypoint; then the turn onto the next leg where it overshoots by little, else a loop back over the waypoint on the next leg's course |
//! | a chain of legs shorter than the turn | the first leg behind them that the aircraft can join |

use crate::join::{Join, join};
use crate::leg::Leg;
use crate::route::Legs;
use crate::turn_round::turn_round;
use fga_proof::angle::wrap_pi;
use fga_proof::meter::COMPARED;
use fga_proof::prediction::{MotionState, flown};
use fga_proof::situation::FLY_OVER_WITHIN_M;
use fga_proof::{Vec2, Vec3};

/// A turn beyond this never uses a fly-by, radians (137°): its arc would begin tan(1.2) = 2.6 turn radii before the waypoint.
const MOST_FLY_BY_RAD: f64 = 2.4;

/// A tangent arc may begin this share of the longer leg before the waypoint: cut at both ends, 91 % of a survey line are flown
/// (`fga-experiments missions` counts the share of each leg).
const CUT_SHARE: f64 = 0.045;

/// A sharper fly-by begins this many turn radii before its waypoint and overshoots the next leg (`fga-experiments missions`).
const LATE_RADII: f64 = 0.85;

/// Guidance, and an overshoot, come back onto a leg at this angle, radians (45°): as fast across it as along it.
pub(crate) const INTERCEPT_RAD: f64 = core::f64::consts::FRAC_PI_4;

/// A leg of at least this many turn radii ends a chain of short ones, and is skipped only once it was begun; a way joins a leg
/// at most this far before its beginning. Two turn diameters (`fga-experiments missions`).
pub(crate) const LONG_RADII: f64 = 4.0;

/// A leg shorter than this many turn radii between two corners may merge into one turn: half a circle spans two radii.
const SHORT_RADII: f64 = 2.0;

/// Most legs that one corner skips.
const MOST_IN_CHAIN: usize = 24;

/// Checked positions on a way over a chain of legs.
const PLACES: usize = 24;

/// A turn whose sine is smaller than this counts as one without lag and wind: its tangent is ill defined.
const LEAST_SINE: f64 = 0.02;

/// A corner between two legs of the mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Distance of its start before the leg's end, metres.
    pub(crate) lead_m: f64,
    /// Whether the aircraft enters the next leg at its beginning, after a turn round.
    pub(crate) is_turn_round: bool,
    /// The way onto the next flown leg, in time from the corner's start; its courses follow on the leg's course through the air.
    pub(crate) join: Join,
}

/// The change of course over the ground from a leg onto another, radians.
fn turn_rad(leg: &Leg, next: &Leg) -> f64 {
    wrap_pi(next.course_rad - leg.course_rad)
}

/// The corner at the end of a leg; `None` after the last one.
pub(crate) fn corner(legs: &Legs<'_>, index: usize, leg: &Leg) -> Option<Corner> {
    let route = legs.route;
    let radius_m = route.radius_m();
    let next = legs.leg(index + 1)?;
    let turn = turn_rad(leg, &next).abs();
    // Over the waypoint, then onto the next leg: how far beyond that one?
    let beyond_m = radius_m * (1.0 - libm::cos(turn));
    let overshoots = route.is_flown_over(index) && beyond_m > FLY_OVER_WITHIN_M;
    if turn <= MOST_FLY_BY_RAD && !overshoots {
        let lead_m = lead_m(legs, index, leg, &next);
        let turned = arc(legs, index, leg, &next, lead_m);
        if turned.is_some() {
            return turned;
        }
        match chain(legs, index, leg, lead_m) {
            Ok(turned) => return Some(turned),
            Err(Some(onto)) => return round(legs, leg, onto),
            Err(None) => {}
        }
    }
    // Turn round: onto the next leg, or over a short one onto the leg behind it.
    let is_short = next.length_m < SHORT_RADII * radius_m;
    let skipped = usize::from(is_short && legs.leg(index + 2).is_some());
    round(legs, leg, index + 1 + skipped)
}

/// Distance of the start of a fly-by before the end of the leg at `index`, metres; 0 for a fly-over
/// waypoint.
fn lead_m(legs: &Legs<'_>, index: usize, leg: &Leg, next: &Leg) -> f64 {
    let turn = turn_rad(leg, next).abs();
    if legs.route.is_flown_over(index) || turn > MOST_FLY_BY_RAD {
        return 0.0;
    }
    let radius_m = legs.route.radius_m();
    let tangent_m = tangent_m(legs, leg, next);
    let lead_m = if tangent_m <= CUT_SHARE * leg.length_m.max(next.length_m) {
        tangent_m
    } else {
        let late_m = (tangent_m - radius_m * libm::tan(0.5 * turn)).max(0.0);
        tangent_m.min(LATE_RADII * radius_m + late_m)
    };
    if lead_m > leg.length_m.min(next.length_m) {
        0.0
    } else {
        lead_m
    }
}

/// The same of the corner after a leg, none after the last one.
fn next_lead_m(legs: &Legs<'_>, index: usize, leg: &Leg) -> f64 {
    let next = legs.leg(index + 1);
    next.map_or(0.0, |next| lead_m(legs, index, leg, &next))
}

/// Distance before the waypoint of the start of the turn from one leg onto the next that ends on it, metres.
fn tangent_m(legs: &Legs<'_>, leg: &Leg, next: &Leg) -> f64 {
    let route = legs.route;
    let turn_rad = turn_rad(leg, next);
    let (sin, cos) = libm::sincos(turn_rad);
    if sin.abs() < LEAST_SINE {
        return route.radius_m() * libm::tan(0.5 * turn_rad.abs());
    }
    let air_turn_rad = wrap_pi(next.air_course_rad - leg.air_course_rad);
    let side = libm::copysign(1.0, air_turn_rad);
    let exit = route.exit(air_turn_rad.abs());
    // On the line on which the turn ends, in the frame of the leg: forward and left.
    let (ahead_m, aside_m) = (exit.from_m.x, side * exit.from_m.y);
    let (air_sin, air_cos) = libm::sincos(leg.air_course_rad - leg.course_rad);
    let drift = leg.position(leg.from_m, exit.begins_s);
    let forward_m = air_cos * ahead_m - air_sin * aside_m + drift.along_m;
    let left_m = air_cos * aside_m + air_sin * ahead_m + drift.cross_m;
    (forward_m - left_m / sin * cos).max(0.0)
}

/// The tangent arc, if both legs have room for it.
#[inline(never)]
fn arc(legs: &Legs<'_>, index: usize, leg: &Leg, next: &Leg, lead_m: f64) -> Option<Corner> {
    let turn_rad = wrap_pi(next.air_course_rad - leg.air_course_rad);
    let room_m = next.length_m - next_lead_m(legs, index + 1, next);
    if lead_m < tangent_m(legs, leg, next) || lead_m > room_m {
        return None;
    }
    let mut join = Join::new(index + 1, lead_m);
    join.stages
        .push(legs.route.stage(0.0, leg.air_course_rad + turn_rad, next));
    join.joined_s = turn_rad.abs() / legs.route.flyer.course_rate_radps();
    Some(Corner {
        lead_m,
        is_turn_round: false,
        join,
    })
}

/// The first leg behind the corner that the aircraft joins before its end; else the leg onto whose beginning it turns round, if any.
#[inline(never)]
fn chain(legs: &Legs<'_>, index: usize, leg: &Leg, lead_m: f64) -> Result<Corner, Option<usize>> {
    let route = legs.route;
    let radius_m = route.radius_m();
    let exit = exit(legs, leg, lead_m);
    for at in index + 1..=index + MOST_IN_CHAIN {
        if route.meter.is_met() {
            break;
        }
        let next = legs.leg(at).ok_or(None)?;
        let is_last = route.mission.waypoints_m.len() <= at + 2;
        let turns_back = turn_rad(leg, &next).abs() > MOST_FLY_BY_RAD;
        if at > index + 1 && turns_back && next.length_m >= SHORT_RADII * radius_m {
            // A turn back beyond short legs: not deep into the leg, but onto its beginning.
            return Err(Some(at));
        }
        let join = join(route, (at, &next), &exit, INTERCEPT_RAD);
        let room_m = next.length_m - next_lead_m(legs, at, &next);
        // Beyond its end the leg would be over before the aircraft is on it.
        let is_ahead = next.position(exit.position_m, 0.0).along_m < room_m;
        if join.is_on_leg() && (join.along_m <= room_m || is_last) {
            let keeps = is_ahead && keeps_waypoints(legs, index + 1, &exit, &join);
            let corner = keeps.then_some(Corner {
                lead_m,
                is_turn_round: false,
                join,
            });
            return corner.ok_or(None);
        }
        if next.length_m >= LONG_RADII * radius_m || route.is_flown_over(at) {
            return Err(Some(at));
        }
    }
    Err(None)
}

/// Whether a way passes the waypoints from `first` on, one after another, within a turn radius.
#[inline(never)]
fn keeps_waypoints(legs: &Legs<'_>, first: usize, from: &MotionState, join: &Join) -> bool {
    let route = legs.route;
    let skipped = join.index - first;
    if skipped == 0 {
        return true;
    }
    if !route.meter.take((skipped + 1) * PLACES / COMPARED) {
        return false;
    }
    let waypoints_m = route.mission.waypoints_m.get(first..=join.index);
    let mut state = *from;
    let places_m = [(); PLACES + 1].map(|()| {
        let at_m = (state.position_m + route.wind_mps * state.time_s).truncate();
        let next_s = state.time_s + join.joined_s / PLACES as f64;
        state = flown(route.flyer, &state, join.stages(), next_s, route.meter);
        at_m
    });
    let is_near = |place_m: &Vec2, waypoint_m: &Vec3| {
        let offset = *place_m - waypoint_m.truncate();
        libm::hypot(offset.x, offset.y) <= route.radius_m()
    };
    let mut ahead_m = places_m.as_slice();
    let passes = |waypoint_m: &Vec3| {
        let at = ahead_m
            .iter()
            .position(|place_m| is_near(place_m, waypoint_m));
        ahead_m = at.and_then(|at| ahead_m.get(at..)).unwrap_or_default();
        at.is_some()
    };
    waypoints_m.is_some_and(|waypoints_m| waypoints_m.iter().all(passes))
}

/// Over the waypoint and round to the beginning of a leg.
#[inline(never)]
fn round(legs: &Legs<'_>, leg: &Leg, index: usize) -> Option<Corner> {
    let onto = legs.leg(index)?;
    let exit = exit(legs, leg, 0.0);
    let join = turn_round(legs.route, (index, &onto), &exit);
    Some(Corner {
        lead_m: 0.0,
        is_turn_round: true,
        join: join.unwrap_or(Join::new(index, -legs.route.settling_m())),
    })
}

/// The aircraft on its leg, some way before its end.
fn exit(legs: &Legs<'_>, leg: &Leg, lead_m: f64) -> MotionState {
    MotionState {
        position_m: leg.point_m(leg.length_m - lead_m),
        course_rad: leg.air_course_rad,
        climb_rad: legs.route.climb_rad(leg),
        ..MotionState::ahead(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{along, table_4};
    use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};
    use fga_proof::situation::{Mission, Passing};
    use fga_proof::vehicle::Vehicle;

    /// The first corner of a route.
    fn first(route: &crate::Route<'_>) -> Corner {
        let legs = Legs {
            route,
            course_rad: 0.0,
            restart: None,
        };
        corner(&legs, 0, &legs.leg(0).unwrap()).unwrap()
    }

    /// The tangent of a right angle is one radius, 30 m: 3 % of the leg, which may be cut.
    #[test]
    fn a_corner_between_long_legs_is_the_tangent_arc() {
        let corner = table_4(&[(0.0, 0.0), (1000.0, 0.0), (1000.0, 400.0)], first);
        assert!((corner.lead_m - 30.0).abs() < 1e-9 && !corner.is_turn_round);
        let join = corner.join;
        assert_eq!(join.index, 1);
        assert!((join.joined_s - PI).abs() < 1e-9 && (join.along_m - 30.0).abs() < 1e-9);
        let [turn] = join.stages() else {
            panic!("{join:?}");
        };
        assert!((turn.course_rad - FRAC_PI_2).abs() < 1e-12);
    }

    /// Of shorter legs less may be cut: 0.85 radii before the waypoint, through the next leg and back.
    #[test]
    fn a_corner_between_shorter_legs_overshoots() {
        let corner = table_4(&[(0.0, 0.0), (400.0, 0.0), (400.0, 400.0)], first);
        assert!((corner.lead_m - 25.5).abs() < 1e-9 && !corner.is_turn_round);
        assert_eq!(corner.join.stages().len(), 2);
        assert!(corner.join.is_on_leg());
    }

    #[test]
    fn a_turn_back_goes_round_to_the_beginning_of_the_next_leg() {
        let corner = table_4(&[(0.0, 0.0), (400.0, 0.0), (0.0, 1.0)], first);
        assert!(corner.is_turn_round && corner.lead_m == 0.0 && corner.join.along_m == 0.0);
        // Survey lines: over the short leg between them.
        let lines_m = [(0.0, 0.0), (400.0, 0.0), (400.0, 20.0), (0.0, 20.0)];
        let corner = table_4(&lines_m, first);
        assert!(corner.is_turn_round && corner.join.index == 2);
    }

    /// A turn of 30° overshoots by 4.0 m behind the waypoint, one of 45° by 8.8 m; 5 m are allowed.
    #[test]
    fn a_waypoint_is_flown_over_and_the_next_leg_joined_where_that_is_near() {
        for (course_rad, is_turn_round) in [(FRAC_PI_6, false), (FRAC_PI_4, true)] {
            let to_m = Vec3::new(libm::cos(course_rad), libm::sin(course_rad), 0.0) * 400.0;
            let middle_m = Vec3::new(400.0, 0.0, 0.0);
            let waypoints_m = [Vec3::ZERO, middle_m, middle_m + to_m];
            let mission = Mission {
                passing: &[Passing::FlyOver; 3],
                ..Mission::new(&waypoints_m)
            };
            let corner = along(&Vehicle::table_4(), Vec3::ZERO, &mission, first);
            assert_eq!(corner.is_turn_round, is_turn_round, "{corner:?}");
            assert_eq!(corner.lead_m, 0.0);
        }
    }

    /// Legs of 10 m round a gentle curve are too short to be joined one by one.
    #[test]
    fn a_chain_of_short_legs_is_left_behind_at_the_first_that_can_be_joined() {
        let turn_rad = |k: i32| 0.5 * f64::from(k.clamp(0, 3));
        let mut waypoints_m = alloc::vec![(0.0, 0.0), (300.0, 0.0)];
        for k in 1..12 {
            let (x, y) = waypoints_m[waypoints_m.len() - 1];
            let (sin, cos) = libm::sincos(turn_rad(k));
            waypoints_m.push((x + 10.0 * cos, y + 10.0 * sin));
        }
        let corner = table_4(&waypoints_m, first);
        assert!(!corner.is_turn_round && corner.join.index > 1, "{corner:?}");
    }

    /// In wind and with bank lag the arc ends on the next leg, to a hundredth of the turn radius.
    #[test]
    fn the_tangent_arc_ends_on_the_next_leg() {
        for lag_s in [0.0, 0.6] {
            for wind_mps in [Vec3::ZERO, Vec3::new(4.0, -5.0, 0.0)] {
                for turn_rad in [-1.3, -0.4, 0.3, 1.2] {
                    let to_m = Vec3::new(libm::cos(turn_rad), libm::sin(turn_rad), 0.0);
                    let middle_m = Vec3::new(3000.0, 0.0, 0.0);
                    let waypoints_m = [Vec3::ZERO, middle_m, middle_m + to_m * 3000.0];
                    let mission = Mission::new(&waypoints_m);
                    along(&Vehicle::lagged(lag_s), wind_mps, &mission, |route| {
                        let legs = Legs {
                            route,
                            course_rad: 0.0,
                            restart: None,
                        };
                        let [leg, next] = [0, 1].map(|at| legs.leg(at).unwrap());
                        let corner = first(route);
                        assert_eq!(corner.join.stages().len(), 1);
                        let from = exit(&legs, &leg, corner.lead_m);
                        let stages = corner.join.stages();
                        let end = flown(route.flyer, &from, stages, f64::INFINITY, route.meter);
                        let off_m = next.position(end.position_m, end.time_s).cross_m;
                        assert!(off_m.abs() < 0.01 * route.radius_m(), "{off_m} m off");
                    });
                }
            }
        }
    }
}

//! Aiming at a leg: the moments of a join and where it leads, told from where turns end.
//!
//! The first turn ends on a straight line, on which the second one begins: both in closed form with bank lag too. The
//! predicted flight then confirms the one join that the search chose.

use core::cell::OnceCell;

use crate::join::{JoinLimits, ON_LEG_M, near_m};
use crate::leg::Leg;
use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::{BEND, Meter, SETUP};
use fga_proof::prediction::{Bend, Exit, Flyer, MotionState};

/// The two channels of a join before their moments are corrected.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shot {
    /// From this intercept angle on it is the same, radians; infinite where a larger one changes it.
    pub same_from_rad: f64,
    pub(crate) intercept_course: f64,
    course: f64,
    pub(crate) turn_at_s: f64,
    pub(crate) climb: f64,
    pub(crate) final_climb: f64,
    pub(crate) level_at_s: f64,
}

impl Shot {
    /// Its commands from a moment on, seconds.
    pub(crate) fn maneuver(&self, start_s: f64) -> Maneuver {
        let mut maneuver = Maneuver::hold();
        let (turn_s, level_s) = (self.turn_at_s, self.level_at_s);
        let mut before_s = f64::NEG_INFINITY;
        for at_s in [start_s, turn_s.min(level_s), turn_s.max(level_s)] {
            if at_s <= before_s {
                continue;
            }
            let turns = (turn_s, self.intercept_course, self.course);
            let levels = (level_s, self.climb, self.final_climb);
            let [course_rad, climb_rad] = [turns, levels]
                .map(|(from_s, before, after)| if at_s < from_s { before } else { after });
            maneuver.push(Stage {
                start_s: at_s,
                course_rad,
                climb_rad,
                rate_share: 1.0,
            });
            before_s = at_s;
        }
        maneuver
    }
}

/// A turn onto a leg begins at least this many time constants after the roll-out of the one before began: e^-2, 14 %, of the bank is left.
const SETTLES: f64 = 2.0;

/// A turn, and the course on which it begins.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Turning {
    /// Unit vector along the course.
    along: Vec3,
    /// 1 to the left, -1 to the right.
    pub(super) side: f64,
    pub(super) exit: Exit,
}

impl Turning {
    /// A place in the frame of its beginning, metres: forward and to its side.
    pub(super) fn turned_m(&self, (forward, aside): (f64, f64)) -> Vec3 {
        let (along, left) = (self.along, self.side * aside);
        Vec3::new(
            forward * along.x - left * along.y,
            forward * along.y + left * along.x,
            0.0,
        )
    }

    /// How far it moves the aircraft to the left of a leg by the time at which its roll-out begins, as if it then flew
    /// straight, metres.
    fn across_m(&self, leg: &Leg, drift_mps: f64) -> f64 {
        leg.left_of(self.turned_m(self.exit.from_m)) + drift_mps * self.exit.begins_s
    }
}

/// Unit vector along a course.
fn along(course_rad: f64) -> Vec3 {
    let (sin, cos) = libm::sincos(course_rad);
    Vec3::new(cos, sin, 0.0)
}

/// Turns from the bank of now to either side, and from level flight.
pub struct Turns<'a> {
    pub(super) flyer: &'a Flyer,
    /// Those from the bank of now: kept by the vehicle, or made when they are asked for.
    kept: [Option<&'a Bend>; 2],
    made: [OnceCell<Option<Bend>>; 2],
    banks_rad: [f64; 2],
    pub(super) level: Option<&'a Bend>,
    rolls_out_rad: f64,
}

/// Shows the turns from a state, of which the vehicle keeps some.
pub(super) fn with_turns<T>(
    flyer: &Flyer,
    state: &MotionState,
    meter: &Meter,
    look: impl FnOnce(&Turns<'_>) -> T,
) -> T {
    let most_rad = flyer.full_bank_rad();
    let bank_rad = state.bank_rad.limited(-most_rad, most_rad);
    let banks_rad = [bank_rad, -bank_rad];
    let kept = banks_rad.map(|bank_rad| flyer.bend_from(bank_rad));
    let is_kept = kept.iter().all(Option::is_some);
    let work = if is_kept { SETUP } else { SETUP + 2 * BEND };
    let turns = Turns {
        flyer,
        kept,
        made: [OnceCell::new(), OnceCell::new()],
        banks_rad,
        level: flyer.bend_from(0.0),
        rolls_out_rad: flyer.rollout_rad(bank_rad),
    };
    if !meter.take(work) {
        // Without work left there are none.
        for bend in &turns.made {
            let _ = bend.set(None);
        }
    }
    look(&turns)
}

impl Turns<'_> {
    /// A turn from now.
    fn first(&self, along: Vec3, by_rad: f64) -> Turning {
        let side = if by_rad < self.rolls_out_rad {
            -1.0
        } else {
            1.0
        };
        let exit = self
            .bend(side)
            .and_then(|bend| bend.exit(self.flyer, side * by_rad));
        Turning {
            along,
            side,
            exit: exit.unwrap_or_default(),
        }
    }

    /// A turn from level flight.
    fn second(&self, along: Vec3, by_rad: f64) -> Turning {
        let exit = self
            .level
            .and_then(|bend| bend.exit(self.flyer, by_rad.abs()));
        Turning {
            along,
            side: libm::copysign(1.0, by_rad),
            exit: exit.unwrap_or_default(),
        }
    }

    pub(super) fn bend(&self, side: f64) -> Option<&Bend> {
        let side = usize::from(side <= 0.0);
        let kept = self.kept.get(side).copied().flatten();
        kept.or_else(|| {
            let (made, bank_rad) = (self.made.get(side)?, self.banks_rad.get(side)?);
            if made.get().is_none() {
                let _ = made.set(Some(Bend::new(self.flyer, *bank_rad)));
            }
            made.get()?.as_ref()
        })
    }

    /// The moments of a join, exact for level flight without lag, and its two turns.
    pub(super) fn aim(
        &self,
        leg: &Leg,
        state: &MotionState,
        limits: &JoinLimits,
    ) -> (Shot, [Turning; 2]) {
        let flyer = self.flyer;
        let position = leg.position(state.position_m, state.time_s);
        let (low, high) = limits.climb_limits_rad;
        let final_climb = leg.climb_rad.limited(low, high);
        let onto = leg.turn_onto_rad(state);
        let speed_mps = flyer.airspeed_mps();
        let drift_mps = leg.cross_speed_mps(speed_mps, leg.course_rad);
        // The bank has mostly gone before it turns again.
        let settles_s = SETTLES * flyer.bank_time_constant_s();
        let begins = along(state.course_rad);
        let turns = |offset: f64, by_rad: f64| {
            let intercepts = along(leg.air_course_rad + offset);
            [self.first(begins, by_rad), self.second(intercepts, -offset)]
        };
        let mut both = [Turning::default(); 2];
        // Cross-track distance after a turn to `offset` from the leg's course, and from there onto it.
        let mut after_turns = |offset: f64, by_rad: f64| {
            both = turns(offset, by_rad);
            let across_m = both.map(|turn| turn.across_m(leg, drift_mps));
            let settling_mps = speed_mps * leg.left_of(both[1].along) + drift_mps;
            position.cross_m + across_m.iter().sum::<f64>() + settling_mps * settles_s
        };
        let (mut offset, mut by_rad) = (0.0, onto);
        let (mut straight_s, mut same_from_rad) = (0.0, 0.0);
        let cross_direct = after_turns(0.0, onto);
        if cross_direct.abs() >= ON_LEG_M {
            let side = if cross_direct > 0.0 { -1.0 } else { 1.0 };
            let steepest = leg.air_turn_rad(speed_mps, side * limits.intercept_rad);
            let is_windy = steepest != side * limits.intercept_rad;
            // The shorter way round, unless the leg is near on that side.
            by_rad = wrap_pi(onto + steepest);
            let mut left = after_turns(steepest, by_rad);
            if left * cross_direct <= 0.0 {
                by_rad = onto + steepest;
                left = after_turns(steepest, by_rad);
            }
            if left * cross_direct > 0.0 {
                (offset, same_from_rad) = (steepest, f64::INFINITY);
                let closing = leg.cross_speed_mps(speed_mps, leg.air_course_rad + offset);
                straight_s = if closing * side > 0.0 {
                    (-left / closing).max(0.0)
                } else {
                    0.0
                };
            } else {
                // The leg is near: the intercept angle that needs no straight piece.
                // Between two turns of one radius the distance is linear in its versed sine.
                let of = |versine: f64| {
                    libm::copysign(2.0 * libm::asin(libm::sqrt(0.5 * versine)), side)
                };
                let near = |versine: f64| {
                    let offset = of(versine);
                    after_turns(offset, onto + offset)
                };
                let ends = ((0.0, cross_direct), (1.0 - libm::cos(steepest), left));
                offset = of(root(near, ends, near_m(flyer)));
                by_rad = onto + offset;
                same_from_rad = if is_windy {
                    f64::INFINITY
                } else {
                    offset.abs()
                };
            }
        }
        // The last turns looked at are those of the join.
        let [first, second] = both;
        let intercept_course = state.course_rad + by_rad;
        let course = if offset == 0.0 {
            state.course_rad + onto
        } else {
            intercept_course + wrap_pi(leg.air_course_rad - intercept_course)
        };
        let turn_s = first.exit.begins_s + settles_s + straight_s;
        let (climb, climb_s) = climb_back(
            flyer,
            state.climb_rad,
            final_climb,
            -position.above_m,
            limits,
            turn_s + second.exit.begins_s,
        );
        let shot = Shot {
            same_from_rad,
            intercept_course,
            course,
            turn_at_s: state.time_s + turn_s,
            climb,
            final_climb,
            level_at_s: state.time_s + climb_s,
        };
        (shot, [first, second])
    }
}

/// Climb angle to hold, and its duration from now, to gain `gain_m` relative to the leg.
fn climb_back(
    flyer: &Flyer,
    now_rad: f64,
    final_rad: f64,
    gain_m: f64,
    limits: &JoinLimits,
    within_s: f64,
) -> (f64, f64) {
    let (low, high) = limits.climb_limits_rad;
    let speed = flyer.airspeed_mps();
    let rate = flyer.climb_rate_radps();
    if rate <= 0.0 || high <= low {
        return (final_rad, 0.0);
    }
    // Height gained relative to the leg while the climb angle moves from one value to another.
    let ramp = |from: f64, to: f64| {
        let turn = to - from;
        if turn.abs() < 1e-9 {
            return 0.0;
        }
        let seconds = turn.abs() / rate;
        speed * ((libm::cos(from) - libm::cos(to)) / turn - libm::sin(final_rad)) * seconds
    };
    let ramps = |climb: f64| ramp(now_rad, climb) + ramp(climb, final_rad);
    if (ramp(now_rad, final_rad) - gain_m).abs() < ON_LEG_M {
        return (final_rad, 0.0);
    }
    let limit = if gain_m > ramp(now_rad, final_rad) {
        high
    } else {
        low
    };
    let side = if limit == high { 1.0 } else { -1.0 };
    for share in [0.25, 0.5, 1.0] {
        let climb = final_rad + share * (limit - final_rad);
        let left = gain_m - ramps(climb);
        let climbing = speed * (libm::sin(climb) - libm::sin(final_rad));
        if left * side < 0.0 {
            break;
        }
        let hold_s = if climbing.abs() > 1e-6 {
            left / climbing
        } else {
            0.0
        };
        let ramp_s = (climb - now_rad).abs() / rate;
        if share == 1.0 || hold_s + ramp_s + (climb - final_rad).abs() / rate <= within_s {
            return (climb, ramp_s + hold_s);
        }
    }
    // Close to the height: the climb angle whose two ramps alone gain it.
    let left = |climb: f64| gain_m - ramps(climb);
    let ends = ((final_rad, left(final_rad)), (limit, left(limit)));
    let climb = root(left, ends, near_m(flyer));
    (climb, (climb - now_rad).abs() / rate)
}

/// Where a function with opposite signs at two points is within a bound of zero (the Illinois method).
fn root(
    mut function: impl FnMut(f64) -> f64,
    (low, high): ((f64, f64), (f64, f64)),
    within: f64,
) -> f64 {
    let ((mut a, mut at_a), (mut b, mut at_b)) = (low, high);
    for _ in 0..24 {
        let step = at_b - at_a;
        if at_b.abs() < within || step == 0.0 {
            break;
        }
        let c = b - at_b * (b - a) / step;
        let at_c = function(c);
        if at_c * at_b < 0.0 {
            (a, at_a) = (b, at_b);
        } else {
            at_a *= 0.5;
        }
        (b, at_b) = (c, at_c);
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Way;
    use crate::join::{join, join_roughly};
    use fga_proof::prediction::flown;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// A way that is not flown leads where the flown one does, to a tenth of a turn radius, at the same heights.
        #[test]
        fn a_way_leads_where_it_is_flown(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            bank in -1.0..1.0f64,
            (cross_m, course_rad) in (-300.0..300.0f64, -2.6..2.6f64),
            intercept_rad in 0.3..1.2f64,
            wind_mps in -6.0..6.0f64,
            (above_m, climb_rad) in prop_oneof![
                Just((0.0, 0.0)),
                (-40.0..40.0f64, -0.2..0.2f64),
            ],
        ) {
            let vehicle = Vehicle::lagged(lag_s);
            let mut flyer = Flyer::new(&vehicle);
            let bank_rad = bank * flyer.full_bank_rad();
            flyer.keep_rolls_from(bank_rad);
            let state = MotionState {
                time_s: 0.0,
                position_m: Vec3::new(0.0, cross_m, above_m),
                course_rad,
                climb_rad,
                bank_rad,
            };
            let speed_mps = vehicle.airspeed_mps;
            let wind_mps = Vec3::new(0.0, wind_mps, 0.0);
            let leg = Leg::endless(Vec3::ZERO, 0.0, speed_mps, wind_mps);
            let limits = JoinLimits {
                intercept_rad,
                climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
            };
            let meter = Meter::unlimited();
            let mut way = Way::default();
            with_turns(&flyer, &state, &meter, |turns| join_roughly(turns, &leg, &state, &limits, &mut way));
            let exact = join(&flyer, &leg, &state, &limits, &meter);
            // A climb shortens the way, which moves the second turn.
            let share = if above_m == 0.0 { 0.1 } else { 0.3 };
            let most_m = share * speed_mps / flyer.course_rate_radps();
            for place in way.places() {
                let (place_m, at_s) = (place.at_m, place.at_s);
                let there = flown(&flyer, &state, &exact.maneuver, at_s, &meter);
                let higher_m = there.position_m.z - place_m.z;
                prop_assert!(higher_m.abs() < 1.0, "{higher_m} m higher at {at_s} s of {way:?}");
                let off_m = there.position_m.distance(place_m);
                prop_assert!(off_m < most_m, "{off_m} m off at {at_s} s of {way:?}");
            }
            prop_assert!(above_m != 0.0 || exact.cross_m.abs() < 0.05, "{exact:?}");
        }
    }
}

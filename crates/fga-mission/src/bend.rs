//! Where a turn leads once it is over, without flying it.
//!
//! A turn ends on a straight line. Seen from the centre of the circle that the aircraft has rolled in to, and turned back by the turn, the
//! place where this line begins does not depend on the turn. It moves a little with turns that end while the aircraft still rolls in:
//! a table has those.

use fga_proof::Vec2;
use fga_proof::angle::unit;
use fga_proof::list::List;
use fga_proof::maneuver::Stage;
use fga_proof::prediction::{Flyer, GAUSS, MotionState};
use fga_proof::vehicle::Vehicle;

/// Most turns of a [`Bend`] that end while the aircraft rolls in. A longer roll-in counts as over after them.
const ENDS: usize = 22;

/// A roll-out is nearly over after this many time constants.
const ROLLS_OUT: f64 = 4.0;

/// How far the line at the end of a turn may be from the true one, between the ends of the pieces too, turn radii.
const INEXACT: f64 = 0.005;

/// The line on which a turn ends: where the aircraft would have begun it when the roll-out began.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exit {
    /// When the roll-out begins, seconds.
    pub begins_s: f64,
    /// When the roll-out is over, seconds.
    pub over_s: f64,
    /// From where it seems to have flown straight since it began, once it has rolled out: forward and to the side of the turn, metres.
    pub from_m: Vec2,
    /// Cosine and sine of the turn.
    pub turned: Vec2,
}

/// A turn that begins to roll out at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    /// The turn once rolled out, radians.
    turn_rad: f64,
    /// When the roll-out begins, seconds.
    begins_s: f64,
    /// From where it seems to have flown straight since then, once it has rolled out: from the centre of the circle, turned back by the turn,
    /// metres.
    from_m: Vec2,
}

/// Turns to one side from a bank, in level flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Bank at the beginning, radians, positive towards the side of the turn.
    bank_rad: f64,
    /// Those that end while the aircraft still rolls in, least first.
    ends: List<End, ENDS>,
    /// The centre of the circle once it has rolled in, forward and to the side of the turn, metres.
    center_m: Vec2,
}

impl Bend {
    /// No turns: zeros, which are written without a copy.
    pub const NONE: Self = Self {
        bank_rad: 0.0,
        ends: List::new(End {
            turn_rad: 0.0,
            begins_s: 0.0,
            from_m: Vec2::ZERO,
        }),
        center_m: Vec2::ZERO,
    };

    /// What [`Self::set`] takes, in units of work.
    pub const WORK: usize = 60;

    /// Becomes the turns from a bank towards their side.
    #[inline(never)]
    pub fn set(&mut self, flyer: &Flyer, bank_rad: f64) {
        self.bank_rad = bank_rad;
        self.ends.clear();
        let mut state = MotionState::ahead(bank_rad);
        // Without an end that matters.
        let turning_left = Stage::turn(0.0, 100.0, 0.0);
        loop {
            let (at_m, course) = (state.position_m.truncate(), unit(state.course_rad));
            let end = End {
                turn_rad: state.course_rad + flyer.rollout_rad(state.bank_rad),
                begins_s: state.time_s,
                from_m: at_m + course.rotate(roll_out_m(flyer, state.bank_rad)),
            };
            if self.ends.push(end).is_none() {
                break;
            }
            self.center_m = at_m + course.perp() * flyer.turn_radius_m();
            let piece = flyer.next_piece(&state, &turning_left, f64::INFINITY);
            if !piece.is_rolling() {
                break;
            }
            state = flyer.advance(&state, &piece, piece.duration_s);
        }
        for end in self.ends.iter_mut() {
            let back = unit(-end.turn_rad);
            end.from_m = back.rotate(end.from_m - self.center_m);
        }
    }

    /// Has no turns any more.
    pub const fn clear(&mut self) {
        self.ends.clear();
    }

    /// Whether it holds for a bank.
    pub fn is_from(&self, bank_rad: f64) -> bool {
        self.bank_rad == bank_rad && !self.ends.is_empty()
    }

    /// The least turn: rolling out at once, radians.
    #[inline]
    pub fn least_rad(&self) -> f64 {
        self.ends.first().map_or(0.0, |end| end.turn_rad)
    }

    /// How far its lines may be from the true ones, metres.
    #[inline]
    pub fn inexact_m(flyer: &Flyer) -> f64 {
        if flyer.is_ideal() {
            0.0
        } else {
            INEXACT * flyer.turn_radius_m()
        }
    }

    /// The line on which a turn ends, at least the least one.
    pub fn exit(&self, flyer: &Flyer, turn_rad: f64) -> Option<Exit> {
        let turn_rad = turn_rad.max(self.least_rad());
        let next = self.ends.partition_point(|end| end.turn_rad <= turn_rad);
        let before = self.ends.get(next.checked_sub(1)?)?;
        let beyond_rad = turn_rad - before.turn_rad;
        let (begins_s, from_m) = if let Some(after) = self.ends.get(next) {
            let share = beyond_rad / (after.turn_rad - before.turn_rad);
            (
                before.begins_s + share * (after.begins_s - before.begins_s),
                before.from_m.lerp(after.from_m, share),
            )
        } else {
            let turns_s = beyond_rad / flyer.course_rate_radps();
            (before.begins_s + turns_s, before.from_m)
        };
        let turned = unit(turn_rad);
        Some(Exit {
            begins_s,
            over_s: begins_s + ROLLS_OUT * flyer.bank_time_constant_s(),
            from_m: self.center_m + turned.rotate(from_m),
            turned,
        })
    }
}

/// Displacement of a roll-out from a bank, beyond straight flight on its final course: forward and left of the course at its start, metres.
///
/// With the time constant τ, the share s of the bank φ that is left and the turn r of a roll-out from a bank, the displacement is
/// V τ ∫ (e^(−i r(s φ)) − 1) ds / s, turned by r(φ).
fn roll_out_m(flyer: &Flyer, bank_rad: f64) -> Vec2 {
    let off = |share: f64| {
        let turned = unit(-flyer.rollout_rad(share * bank_rad));
        (turned - Vec2::X) / share
    };
    let moved: Vec2 = GAUSS
        .iter()
        .map(|(at, weight)| (off(*at) + off(1.0 - at)) * *weight)
        .sum();
    let turned = unit(flyer.rollout_rad(bank_rad));
    turned.rotate(moved) * flyer.airspeed_mps() * flyer.bank_time_constant_s()
}

/// The vehicle's motion, with its turns from level flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turner {
    flyer: Flyer,
    level: Bend,
}

impl core::ops::Deref for Turner {
    type Target = Flyer;

    #[inline]
    fn deref(&self) -> &Flyer {
        &self.flyer
    }
}

impl Turner {
    /// Of no use before [`Self::set`]: zeros, which are written without a copy.
    pub const NONE: Self = Self {
        flyer: Flyer::NONE,
        level: Bend::NONE,
    };

    /// The motion of a vehicle at its airspeed.
    pub fn new(vehicle: &Vehicle) -> Self {
        let mut turner = Self::NONE;
        turner.set(vehicle);
        turner
    }

    /// Takes the motion of a vehicle.
    pub fn set(&mut self, vehicle: &Vehicle) {
        self.flyer.set(vehicle);
        self.level.set(&self.flyer, 0.0);
    }

    /// Turns from level flight.
    pub const fn level(&self) -> &Bend {
        &self.level
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::maneuver::Maneuver;
    use fga_proof::prediction::FlightPath;

    fn bend(flyer: &Flyer, bank_rad: f64) -> Bend {
        let mut bend = Bend::NONE;
        bend.set(flyer, bank_rad);
        bend
    }

    #[test]
    fn the_table_has_room_for_rolling_in_from_the_other_side() {
        for lag_s in [0.1, 1.0, 3.0, 10.0] {
            for (speed_mps, radius_m) in
                [(15.0, 30.0), (22.0, 60.0), (70.0, 700.0), (200.0, 5000.0)]
            {
                let flyer = Flyer::new(&Vehicle {
                    airspeed_mps: speed_mps,
                    turn_radius_m: radius_m,
                    ..Vehicle::lagged(lag_s)
                });
                let bend = bend(&flyer, -flyer.full_bank_rad());
                assert!(
                    bend.ends.len() < ENDS,
                    "lag {lag_s}, {speed_mps} m/s: {}",
                    bend.ends.len()
                );
            }
        }
    }

    #[test]
    fn a_turn_shorter_than_the_least_one_ends_where_that_does() {
        for bank in [0.0, 0.3, 0.99, 1.0] {
            let flyer = Flyer::new(&Vehicle::lagged(0.6));
            let bend = bend(&flyer, bank * flyer.full_bank_rad());
            let (least, less) = (bend.least_rad(), bend.least_rad() - 0.1);
            let at = |turn_rad: f64| bend.exit(&flyer, turn_rad).unwrap().from_m;
            assert_eq!(at(less), at(least), "{bank}");
        }
    }

    #[test]
    fn a_turn_ends_on_the_line_that_was_told() {
        for (lag_s, speed_mps, radius_m) in [
            (0.0, 15.0, 30.0),
            (0.25, 12.0, 20.0),
            (0.6, 15.0, 30.0),
            (1.0, 22.0, 60.0),
            (1.2, 50.0, 400.0),
        ] {
            let vehicle = Vehicle {
                airspeed_mps: speed_mps,
                turn_radius_m: radius_m,
                ..Vehicle::lagged(lag_s)
            };
            let flyer = Flyer::new(&vehicle);
            let full_rad = if lag_s > 0.0 {
                flyer.bank_rad(flyer.course_rate_radps())
            } else {
                0.0
            };
            for share in [0.0, 0.4, -0.6, 1.0, 1.4, -1.4] {
                let bank_rad = share * full_rad;
                let bend = bend(&flyer, bank_rad);
                for k in 0..40 {
                    let turn_rad = bend.least_rad() + 0.1 * f64::from(k);
                    let exit = bend.exit(&flyer, turn_rad).unwrap();
                    let start = MotionState::ahead(bank_rad);
                    let mut path = FlightPath::new();
                    path.predict(&flyer, &start, &Maneuver::turn(0.0, turn_rad, 0.0), 200.0);
                    for after_s in [0.0, 2.0, 30.0] {
                        let at_s = exit.over_s + after_s;
                        let there = path.state_at(&flyer, at_s).unwrap();
                        let straight_m = speed_mps * (at_s - exit.begins_s);
                        let told_m = exit.from_m + exit.turned * straight_m;
                        let off_m = told_m.distance(there.position_m.truncate());
                        let most_m = Bend::inexact_m(&flyer) + 1e-6;
                        assert!(
                            off_m <= most_m,
                            "lag {lag_s}, bank {bank_rad}, turn {turn_rad}: {off_m} of {most_m}"
                        );
                    }
                }
            }
        }
    }
}

//! The straight line on which a turn ends: how close to obstacles it comes, and which other turns that rules out.
//!
//! The line is a necessary condition: a turn whose line comes too close does so itself. A turn that fails comes too close at a
//! moment τ after the turns part; a turn longer by Δψ has moved the aircraft by V (Δψ τ − Δψ² / 2ω) at most by then.

use crate::Side;
use fga_mission::Bend;
use fga_proof::assumptions::each;
use fga_proof::certificate::{Line, Obstruction as _};
use fga_proof::limit::Limit as _;
use fga_proof::prediction::MotionState;
use fga_proof::{Vec2, Vec3};

use super::lattice::{Prefix, Row};
use super::{Scene, Search};

/// What a line takes to be set up, in units of work.
const LINE: usize = 4;

/// The straight line on which a turn ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangent {
    /// The aircraft on it, all of its turn and climb over.
    pub state: MotionState,
    pub velocity_mps: Vec3,
    /// When longer turns part from this one, seconds.
    pub parts_s: f64,
    /// How far the line may be from the true one, metres.
    pub inexact_m: f64,
}

/// The closest approach on the line on which a turn ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// Upper bound of the margin of the turn, metres.
    pub margin_m: f64,
    /// From when longer turns part from this one to the closest approach, seconds.
    pub left_s: f64,
}

impl Search<'_> {
    /// The margin on the line on which a turn ends, at most `enough_m`; once it is below `floor_m` it may be that of any
    /// hazard. `None` where the turn is not over before the horizon.
    pub(super) fn look(
        &mut self,
        tangent: &Tangent,
        (floor_m, enough_m): (f64, f64),
    ) -> Option<Look> {
        let horizon_s = self.scene.horizon_s;
        let state = &tangent.state;
        if state.time_s >= horizon_s {
            return None;
        }
        self.evaluated += 1;
        let line = Line {
            from_m: state.position_m,
            velocity_mps: tangent.velocity_mps,
            at_s: state.time_s,
            duration_s: horizon_s - state.time_s,
        };
        let (margin_m, at_s) = self.least_on(&line, floor_m, enough_m);
        Some(Look {
            margin_m: margin_m + tangent.inexact_m,
            left_s: at_s - tangent.parts_s,
        })
    }

    /// The least margin on a line and its time, the hazard that decided last first, until it falls below `floor_m`.
    fn least_on(&mut self, line: &Line, floor_m: f64, enough_m: f64) -> (f64, f64) {
        let Self {
            scene,
            meter,
            culprit,
            ..
        } = self;
        let mut least = (enough_m, line.at_s);
        if let Some(hazard) = scene.around.rows.get(*culprit) {
            if !meter.take(1) {
                return least;
            }
            least = hazard.least_on_line(line, least.0, meter).unwrap_or(least);
            if least.0 < floor_m {
                return least;
            }
        }
        let mut places = 0..;
        let first = *culprit;
        each(scene.around.rows, meter, |hazard| {
            let place = places.next().filter(|place| *place != first);
            let found = place.and_then(|_| hazard.least_on_line(line, least.0, meter));
            if let Some((found, place)) = found.zip(place) {
                (least, *culprit) = (found, place);
            }
            least.0 >= floor_m
        });
        scene.around.fixed.lower(line, least, floor_m, meter)
    }

    /// How much farther a turn has to go on at least to move the aircraft by some metres until `left_s` after it leaves the
    /// shorter one, radians; infinite if it never does.
    ///
    /// Their courses differ by Δψ at most, and by ω s at most s seconds after they part: until then the turn moves the aircraft
    /// by V (Δψ t − Δψ² / 2ω) at most, and by V ω t² / 2 however far it goes.
    pub(super) fn least_more_rad(&self, short_m: f64, left_s: f64) -> f64 {
        if short_m <= 0.0 {
            return 0.0;
        }
        let flyer = self.scene.flyer;
        let rate_radps = flyer.course_rate_radps();
        let short_s2 = 2.0 * short_m / (flyer.airspeed_mps() * rate_radps);
        let left_s2 = left_s * left_s - short_s2;
        if left_s <= 0.0 || left_s2 <= 0.0 {
            return f64::INFINITY;
        }
        // As τ − √(τ² − s) without the loss of digits.
        rate_radps * short_s2 / (left_s + libm::sqrt(left_s2))
    }

    /// How much less of a turn moves the aircraft by some metres until `left_s` after the longer one ends, at least, radians:
    /// the same bound, for turns that part by the difference sooner.
    pub(super) fn least_less_rad(&self, short_m: f64, left_s: f64) -> f64 {
        let flyer = self.scene.flyer;
        let rate_radps = flyer.course_rate_radps();
        let short_s2 = 2.0 * short_m.max(0.0) / (flyer.airspeed_mps() * rate_radps);
        rate_radps * (libm::sqrt(left_s * left_s + short_s2) - left_s)
    }

    /// The line on which the next turn of a row ends.
    pub(super) fn line(&mut self, prefix: &Prefix, row: &Row) -> Option<Tangent> {
        if !self.meter.take(LINE) {
            return None;
        }
        let (from, climb_rad) = (&prefix.entry, row.climb_rad);
        let (sign, flyer) = (row.side.sign(), self.scene.flyer);
        let bend = self.bend(sign * from.bank_rad, row.side)?;
        let turn_rad = row.at_rad.max(bend.least_rad());
        let exit = bend.exit(flyer, turn_rad)?;
        let inexact_m = Bend::inexact_m(flyer);
        let ((up, level), climbs_s, (along_m, up_m)) = self.climbed(from.climb_rad, climb_rad);
        let speed_mps = flyer.airspeed_mps();
        let (sin, cos) = libm::sincos(from.course_rad);
        let course = Vec2::new(cos, sin);
        let to_side = Vec2::new(1.0, sign);
        let end = course.rotate(to_side * exit.turned);
        let after_s = exit.over_s.max(climbs_s);
        let straight_m = level * speed_mps * (after_s - exit.begins_s);
        // The course of the climb is unknown: half of it on either.
        let half_m = 0.5 * along_m;
        let begin_m = course.rotate(level * to_side * exit.from_m + Vec2::X * half_m);
        let moved_m = begin_m + end * (straight_m + half_m);
        let up_m = up * speed_mps * after_s + up_m;
        Some(Tangent {
            state: MotionState {
                time_s: from.time_s + after_s,
                position_m: from.position_m + moved_m.extend(up_m),
                course_rad: from.course_rad + sign * turn_rad,
                climb_rad,
                bank_rad: 0.0,
            },
            velocity_mps: (level * end).extend(up) * speed_mps,
            parts_s: from.time_s + exit.begins_s,
            inexact_m: inexact_m + along_m.abs(),
        })
    }

    /// Sine and cosine of a climb target, how long the change to it takes, seconds, and what the change moves the aircraft by along
    /// the course and up, metres, beyond flying at the target at once: by the means of cos θ and sin θ while θ changes.
    fn climbed(&self, from_rad: f64, climb_rad: f64) -> ((f64, f64), f64, (f64, f64)) {
        let flyer = self.scene.flyer;
        let (low, high) = self.scene.climb_limits_rad;
        let climb_rad = climb_rad.limited(low, high);
        let change_rad = climb_rad - from_rad;
        let (up_now, level_now) = libm::sincos(from_rad);
        if change_rad.abs() <= 1e-9 || flyer.climb_rate_radps() <= 0.0 {
            return ((up_now, level_now), 0.0, (0.0, 0.0));
        }
        let (up, level) = libm::sincos(climb_rad);
        let climbs_s = change_rad.abs() / flyer.climb_rate_radps();
        let path_m = flyer.airspeed_mps() * climbs_s;
        let along_m = path_m * ((up - up_now) / change_rad - level);
        let up_m = path_m * ((level_now - level) / change_rad - up);
        ((up, level), climbs_s, (along_m, up_m))
    }

    /// Turns to a side from a bank that is positive towards it.
    pub(super) fn bend(&mut self, bank_rad: f64, side: Side) -> Option<&Bend> {
        let Scene { flyer, start, .. } = self.scene;
        if bank_rad == 0.0 {
            return Some(flyer.level());
        }
        let is_later = bank_rad.abs() != start.bank_rad.abs();
        let place = 2 * usize::from(is_later) + usize::from(side == Side::Right);
        let slot = self.bends.get_mut(place)?;
        if !slot.is_from(bank_rad) {
            if !self.meter.take(Bend::WORK) {
                return None;
            }
            slot.set(flyer, bank_rad);
        }
        Some(slot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tables;
    use crate::tests::scene;
    use fga_mission::Turner;
    use fga_proof::maneuver::Maneuver;
    use fga_proof::meter::Meter;
    use fga_proof::prediction::FlightPath;
    use fga_proof::vehicle::Vehicle;

    #[test]
    fn a_turn_moves_the_aircraft_by_the_bound_exactly_where_it_is_least() {
        let vehicle = Vehicle::lagged(0.0);
        let flyer = Turner::new(&vehicle);
        let nominal = Maneuver::hold();
        let scene = scene(&flyer, &vehicle, (MotionState::ahead(0.0), &nominal), &[]);
        let (mut path, mut tables) = (FlightPath::new(), Tables::NONE);
        let search = Search::new(&scene, (&mut path, &mut tables), Meter::new(1000, u32::MAX));
        // By hand: V (Δψ τ − Δψ² / 2ω) at Δψ = 0.2 after τ = 4 s, and back.
        let (speed_mps, rate_radps) = (flyer.airspeed_mps(), flyer.course_rate_radps());
        let moved_m = speed_mps * (0.2 * 4.0 - 0.04 / (2.0 * rate_radps));
        assert!((search.least_more_rad(moved_m, 4.0) - 0.2).abs() < 1e-12);
        // A shorter turn parts sooner by the difference.
        let left_s = 4.0 - 0.2 / rate_radps;
        assert!((search.least_less_rad(moved_m, left_s) - 0.2).abs() < 1e-12);
        // However far it turns, V ω τ² / 2 is the most.
        let most_m = 0.5 * speed_mps * rate_radps * 16.0;
        assert_eq!(search.least_more_rad(1.001 * most_m, 4.0), f64::INFINITY);
    }
}

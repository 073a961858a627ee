//! The way back: the earliest certified rejoin of the mission, and the flight along it.

use core::f64::consts::PI;

use crate::avoider::demand::{Demand, RUNGS, WANTED};
use crate::avoider::intruders::{BACK_WITHSTANDS_S, Freedom};
use crate::avoider::tracks::zones::known_s;
use crate::avoider::{Against, Avoider, Now, Places, Plan, Returned};
use crate::certificate::Hazard;
use crate::command::Command;
use crate::limit::Limit as _;
use crate::maneuver::{Maneuver, Stage};
use crate::mission::Join;
use crate::prediction::MotionState;
use crate::search::Outcome;
use crate::situation::Situation;

use super::{Answer, ENOUGH_M, NEXT_ENCOUNTER_S};

/// Most legs that a way back may skip.
const MAX_SKIPPED: usize = 64;

/// Intercept angles of the way back, radians, preferred first.
const INTERCEPTS_RAD: [f64; 6] = [0.52, 0.79, 0.35, 1.05, 0.17, 1.45];

/// Smaller intercept angles are only for a near mission, radians.
const SHALLOW_RAD: f64 = 0.5;

/// A way back may skip a leg only this long after the avoidance began, seconds.
const SKIP_AFTER_S: f64 = 4.0;

/// Longest flight at a shallow intercept angle, seconds.
const SHALLOW_S: f64 = 15.0;

/// An obstacle of less speed relative to the aircraft than this share of its airspeed flies
/// alongside.
const SLOWER_SHARE: f64 = 0.5;

/// The mission waits at most this long for an obstacle that flies alongside, seconds.
const LONGEST_PASS_S: f64 = 20.0;

/// The turn and the flight after which the aircraft flies to the next waypoint, radians and turn radii, preferred first: a
/// near waypoint is reached from farther away.
const AWAY: [(f64, f64); 6] = [
    (0.0, 0.0),
    (0.0, 4.0),
    (0.0, 12.0),
    (PI, 6.0),
    (PI, 18.0),
    (0.0, 36.0),
];

/// Detours between walls that are looked at in one cycle: an odd number, so that each second look has one.
const LOOKS: usize = 9;

/// Memory of a way back: one that led back to the same obstacle is not repeated within this time,
/// seconds.
const TRIED_S: f64 = 60.0;

/// After so long an avoidance a way back need not withstand motions that are not expected, seconds.
const FLEES_S: f64 = 120.0;

/// The obstacles on a way back.
#[derive(Debug, Clone, Copy, PartialEq)]
enum WayAhead {
    /// Nothing over the whole horizon.
    Clear,
    /// Only obstacles of another encounter, once it is back on the mission.
    NextEncounter,
    /// An obstacle of this encounter, or any before the return, comes closer than asked for.
    Blocked,
}

/// When an obstacle has passed, as far as the mission waits for it, seconds.
fn passes_s(hazard: &Hazard, situation: &Situation<'_>) -> f64 {
    let own = situation.ownship;
    let offset = hazard.position_m - own.position_m;
    let relative = own.velocity_mps() - hazard.velocity_mps;
    let square = relative.length_squared().max(1e-9);
    let slow_mps = SLOWER_SHARE * own.velocity_mps().length();
    let is_slow = square < slow_mps * slow_mps;
    let longest_s = if is_slow { LONGEST_PASS_S } else { f64::MAX };
    (offset.dot(relative) / square).limited(0.0, longest_s)
}

/// The place of the intercept angle of a look for a way back: each second look is at the preferred one.
const fn place_of(look: usize) -> usize {
    if look.is_multiple_of(2) {
        0
    } else {
        1 + look / 2 % (INTERCEPTS_RAD.len() - 1)
    }
}

impl Avoider<dyn Places + '_> {
    /// Changes a plan to a certified way back to the mission, if there is one now and this is the cycle of a look, one in `every`; with
    /// `latest_s` only to one that joins the mission sooner than then, without another encounter. `back` takes its manoeuvre.
    #[inline(never)]
    pub(super) fn way_back(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        plan: &mut Plan,
        (every, latest_s): (u32, f64),
        back: &mut Command,
    ) -> bool {
        if !self.cycle.is_multiple_of(every) || self.meter.is_met() {
            return false;
        }
        // After a long search without room for the wanted margin less is enough.
        let given_up = plan.given_up(situation.time_s);
        let rung = (WANTED + given_up).min(RUNGS - 2);
        // Counted in looks, so that none of the angles is left out at any period.
        let look = (self.cycle / every) as usize;
        let waited_s = situation.time_s - plan.start_s;
        let has_detours = !look.is_multiple_of(2) && self.is_between_walls(now, waited_s);
        let more = if has_detours { LOOKS } else { 1 };
        self.before = self.progress;
        for look in (look * more..).step_by(2).take(more) {
            let asked = (look, given_up, waited_s, latest_s.is_finite());
            let mut found = *plan;
            let joined = self.way(situation, now, asked, back).filter(|joined| {
                situation.time_s + joined.joined_s <= latest_s
                    && self.fly_back(joined, &mut found, (situation, now), rung, back)
                    // Two that flee from each other side by side would never return: after long, what keeps a way back suffices, and
                    // then what is clear of the expected motion.
                    && (self.is_robust_back((back, joined.joined_s), now, rung)
                        || given_up > 1 && self.has_reserve(back, now)
                        || waited_s > FLEES_S)
                    && (latest_s.is_infinite()
                        || found.next_start_s.is_none() && found.joined_s < latest_s)
            });
            if let Some(joined) = joined {
                self.return_to(&joined, plan.against, (situation, now));
                *plan = found;
                return true;
            }
            self.progress = self.before;
            if !self.has_room_between_walls(now) {
                break;
            }
        }
        self.go_on(plan, situation.time_s, back);
        false
    }

    /// A way onto the mission, which a manoeuvre takes.
    #[inline(never)]
    fn way(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        (look, given_up, waited_s, is_flown): (usize, usize, f64, bool),
        back: &mut Command,
    ) -> Option<Join> {
        let intercept_rad = *INTERCEPTS_RAD.get(place_of(look))?;
        // Skipping a leg is only for a leg that the aircraft cannot join at any angle.
        let skipped = MAX_SKIPPED * usize::from(waited_s >= SKIP_AFTER_S);
        let is_any = look.is_multiple_of(2);
        let detour = if is_any {
            None
        } else {
            self.detour(situation, now, (waited_s, look / 2))
        };
        let mut first = detour.map(|(first, _)| first);
        let from = detour.map_or(now.state, |(_, from)| from);
        // A way that is flown is looked for from where the aircraft has come to, in turn with the other angles.
        let asked_rad = if is_any && is_flown {
            self.progress.leg(now).turn_onto_rad(now).abs()
        } else {
            intercept_rad
        };
        let way = self.on_mission(situation, |progress, route| {
            progress.way_back(route, &from, asked_rad, skipped)
        });
        let is_near = |joined: &Join| intercept_rad >= SHALLOW_RAD || joined.joined_s <= SHALLOW_S;
        let mut way = way.filter(|joined| joined.is_on_leg() && (is_any || is_near(joined)));
        // Straight to the next waypoint, as if the mission began here: no leg could be joined for long.
        for (turn_rad, radii) in AWAY.into_iter().filter(|_| is_any && given_up > 0) {
            if way.is_some() {
                break;
            }
            let away = Stage::turn(0.0, now.course_rad + turn_rad, 0.0);
            first = Some(away);
            let from = self.after(now, &[away], radii / self.flyer.course_rate_radps());
            self.progress = self.before;
            way = self.on_mission(situation, |progress, route| {
                progress.direct_way(route, &from)
            });
        }
        let joined = way?;
        back.edit()
            .set(first.into_iter().chain(joined.stages().iter().copied()));
        Some(joined)
    }

    /// Changes a plan to fly a way that joins a leg, and on; false where it leads to an obstacle, or to another encounter that cannot be
    /// avoided.
    #[inline(never)]
    fn fly_back(
        &mut self,
        joined: &Join,
        plan: &mut Plan,
        (situation, now): (&Situation<'_>, &Now<'_>),
        rung: usize,
        maneuver: &mut Command,
    ) -> bool {
        let far = Demand {
            horizon_s: self.far_s,
            ..self.demand_of(rung)
        };
        self.on_mission(situation, |progress, route| {
            progress.round_corners(route, far.horizon_s, maneuver.edit(), joined)
        });
        (maneuver.edit()).limit_climbs(self.level_rad.0, self.level_rad.1);
        let known_s = known_s(&self.flyer, situation.wind_mps, self.wanted_m());
        let back_s = self.progress.back_s(joined);
        let walls_s = back_s.min(known_s);
        self.predict(maneuver, now, far.horizon_s.max(back_s));
        if !self.is_clear_later(situation, (known_s, back_s)) {
            return false;
        }
        let ahead = self.way_ahead(plan, joined, (situation, now), &far);
        *plan = Plan {
            decided_s: situation.time_s,
            start_s: situation.time_s,
            joined_s: situation.time_s + joined.joined_s,
            margin_m: far.margin_m,
            rung,
            cost: 0.0,
            next_start_s: None,
            ..*plan
        };
        match ahead {
            WayAhead::Blocked => false,
            WayAhead::Clear => {
                let asked = (far.horizon_s, far.margin_m, ENOUGH_M);
                // Walls count on all of the way back, however long it is.
                let later = (walls_s.max(far.horizon_s), far.margin_m, far.margin_m);
                let is_proven = self.within_walls(walls_s, |avoider| {
                    avoider.prove_from(maneuver, now, later, true)
                        && avoider.prove(maneuver, now, asked)
                });
                if let Some(proof) = maneuver.proof() {
                    plan.outcome = Outcome::Proven;
                    plan.margin_m = proof.bound().margin_m;
                }
                is_proven
            }
            WayAhead::NextEncounter => {
                self.way_back_and_on(plan, joined.joined_s, now, &far, maneuver)
            }
        }
    }

    /// Remembers a chosen way back and goes on to its leg.
    fn return_to(
        &mut self,
        joined: &Join,
        against: Against,
        (situation, now): (&Situation<'_>, &Now<'_>),
    ) {
        self.returned = Some(Returned {
            against,
            leg: joined.index,
            time_s: situation.time_s + joined.joined_s,
        });
        self.on_mission(situation, |progress, route| {
            progress.advance_to(route, now, joined.index);
        });
    }

    /// Adds to a way back that meets other obstacles later the manoeuvre that avoids those; false without one.
    #[inline(never)]
    fn way_back_and_on(
        &mut self,
        back: &mut Plan,
        joined_s: f64,
        now: &Now<'_>,
        demand: &Demand,
        maneuver: &mut Command,
    ) -> bool {
        let Some((threat, against)) = self.first_threat(maneuver, now, demand) else {
            return false;
        };
        let found = self.search(maneuver, now, demand, |search| {
            let found = search.cheapest(joined_s)?;
            let proven = search.proven(found)?;
            Some(Answer::new(search, proven, back.rung))
        });
        let Some(found) = found else {
            return false;
        };
        *maneuver = self.tables.answer;
        *back = Plan {
            next_start_s: Some(back.joined_s),
            threat: Some(threat),
            threat_found_s: back.decided_s,
            against,
            ..back.with(&found, back.decided_s)
        };
        true
    }

    /// The clearance of the way back in the path, which joins a leg.
    #[inline(never)]
    fn way_ahead(
        &self,
        plan: &Plan,
        joined: &Join,
        (situation, now): (&Situation<'_>, &Now<'_>),
        demand: &Demand,
    ) -> WayAhead {
        let leg = self.progress.leg(now);
        let joined_s = joined.joined_s;
        let gained_m = if joined.index == self.progress.index() {
            joined.along_m - leg.position(now.position_m, now.time_s).along_m
        } else {
            f64::INFINITY
        };
        let (horizon_s, target_m) = (demand.horizon_s, demand.margin_m);
        let is_again = self.was_tried(plan, situation.time_s);
        let mut ahead = WayAhead::Clear;
        if self.meter.is_met() {
            return WayAhead::Blocked;
        }
        for hazard in self.tracks.obstacles() {
            let whole = self.certify_one(hazard, (horizon_s, target_m, target_m));
            if whole.holds(target_m) {
                continue;
            }
            let before = self.certify_one(hazard, (joined_s.min(horizon_s), target_m, target_m));
            if !before.holds(target_m) {
                return WayAhead::Blocked;
            }
            if plan.against.contains(hazard.id()) {
                // Before the obstacle has passed, or from farther behind it, it would be the same encounter again.
                let passes_s = passes_s(hazard, situation);
                let ground_mps = hazard.velocity_mps + situation.wind_mps;
                let (sin, cos) = libm::sincos(leg.course_rad);
                let its_m = (ground_mps.x * cos + ground_mps.y * sin) * joined_s;
                let falls_back = gained_m - its_m < -2.0 * self.flyer.turn_radius_m();
                if is_again || falls_back || whole.at_s < passes_s + NEXT_ENCOUNTER_S {
                    return WayAhead::Blocked;
                }
            }
            ahead = WayAhead::NextEncounter;
        }
        ahead
    }

    /// Whether a plan avoids an obstacle that a recent way back onto the same leg led to.
    fn was_tried(&self, plan: &Plan, time_s: f64) -> bool {
        let first_id = plan.threat.map(|threat| threat.id);
        self.returned.zip(first_id).is_some_and(|(returned, id)| {
            returned.leg == self.progress.index()
                && returned.against.contains(id)
                && plan.start_s - returned.time_s < TRIED_S
                && time_s - plan.start_s < TRIED_S
        })
    }

    /// Whether a way back withstands, for a time, all motions of the aircraft that do not move away from it: one that leads into another turn is another encounter.
    #[inline(never)]
    fn is_robust_back(
        &mut self,
        (back, joined_s): (&Maneuver, f64),
        now: &Now<'_>,
        rung: usize,
    ) -> bool {
        if !self.tracks.has_aircraft() {
            return true;
        }
        if self.meter.is_met() {
            return false;
        }
        let own_m = now.position_m;
        let mission_rad = now.course_rad + self.progress.leg(now).turn_onto_rad(now);
        let first = back.stages().first();
        let first_rad = first.map_or(now.course_rad, |stage| stage.course_rad);
        // An aircraft moves away if it does so now, on the way back and on the mission.
        let ours = [now.course_rad, first_rad, mission_rad].map(|course_rad| MotionState {
            course_rad,
            ..now.state
        });
        let ours_mps = ours.map(|state| self.flyer.velocity_mps(&state));
        let leaves = |hazard: &Hazard| {
            let offset_m = hazard.position_m - own_m;
            // What is above or below is clear by its height alone, and may change that.
            let is_beside = libm::hypot(offset_m.x, offset_m.y) > hazard.volume.radius_m();
            let mut ours_mps = ours_mps.iter();
            is_beside && ours_mps.all(|own_mps| offset_m.dot(hazard.velocity_mps - own_mps) > 0.0)
        };
        let freedom = |hazard: &Hazard| {
            if leaves(hazard) {
                Freedom::Expected
            } else {
                Freedom::Brief
            }
        };
        let target_m = self.demand_of(rung).margin_m;
        self.withstand(&freedom, (0.0, target_m));
        let asked = (BACK_WITHSTANDS_S, target_m, target_m);
        self.within_walls(joined_s, |avoider| avoider.margin_of(back, now, asked)) >= target_m
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{aircraft, among};
    use super::*;

    /// Among aircraft it withstands more than the expected motion, and with all of the drift's margin more than with half of it.
    #[test]
    fn a_way_back_keeps_room_for_turns_of_an_aircraft_that_comes() {
        let mut counts = [0; 4];
        for aside_m in (0..400).step_by(2) {
            let row = aircraft(1, (200.0, f64::from(aside_m)), (-20.0, 0.0));
            let (is_clear, is_robust) = among(&[row], |avoider, _, now| {
                avoider.drift_m = 40.0;
                let rungs = [WANTED, WANTED + 1];
                let is_robust =
                    rungs.map(|rung| avoider.is_robust_back((&Maneuver::HOLD, 60.0), now, rung));
                avoider.withstand(&|_| Freedom::Expected, (0.0, 0.0));
                let asked = (BACK_WITHSTANDS_S, 0.0, 0.0);
                (
                    avoider.margin_of(&Maneuver::HOLD, now, asked) >= 0.0,
                    is_robust,
                )
            });
            let held = [is_clear, is_robust[1], is_robust[0]];
            assert!(
                held.is_sorted_by(|more, less| more >= less),
                "{aside_m} m: {held:?}"
            );
            counts[held.iter().filter(|held| **held).count()] += 1;
        }
        assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
    }

    /// An earlier version derived the angle from the cycle: at one period in four each look had the same.
    #[test]
    fn looks_have_all_angles_in_turn_at_every_period() {
        for every in 1..16_u32 {
            let looks = (0..200 * every).filter(|cycle| cycle.is_multiple_of(every));
            let mut of_place = [0; INTERCEPTS_RAD.len()];
            looks.for_each(|cycle| of_place[place_of((cycle / every) as usize)] += 1);
            assert_eq!(of_place, [100, 20, 20, 20, 20, 20], "{every}");
        }
    }
}

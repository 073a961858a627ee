//! The way back: the earliest certified rejoin of the mission, and the flight along it.

use core::f64::consts::PI;

use crate::avoider::demand::{Demand, RUNGS, WANTED};
use crate::avoider::intruders::{Clearance, Freedom};
use crate::avoider::{Avoider, Plan, Returned};
use crate::certificate::{Hazard, Line, mark_close};
use crate::limit::Limit as _;
use crate::maneuver::Maneuver;
use crate::mission::join::{Join, JoinLimits};
use crate::mission::leg::Leg;
use crate::mission::{Bend, Progress, Turns, Way};
use crate::prediction::{MotionState, whole};
use crate::search::Proof;
use crate::situation::{Mission, Situation};

use super::{Answer, ENOUGH_M, NEXT_ENCOUNTER_S};

/// Most legs that a way back may skip.
const MAX_SKIPPED: usize = 64;

/// Intercept angles of the way back, radians, preferred first.
const INTERCEPTS_RAD: [f64; 6] = [0.52, 0.79, 0.35, 1.05, 0.17, 1.45];

/// Smaller intercept angles are only for a near mission, radians.
const SHALLOW_RAD: f64 = 0.5;

/// A way back may skip a leg only this long after the avoidance began, seconds.
const SKIP_AFTER_S: f64 = 4.0;

/// Another intercept angle is chosen if its way departs less by this share.
const CLEARLY_NEARER: f64 = 0.9;

/// Longest flight at a shallow intercept angle, seconds.
const SHALLOW_S: f64 = 15.0;

/// An obstacle of less speed relative to the aircraft than this share of its airspeed flies
/// alongside.
const ALONGSIDE: f64 = 0.5;

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

/// A way that is not flown leads hardly farther than this from where it seems to, turn radii: without bank lag and with it.
const ROUGHLY: [f64; 2] = [0.002, 0.02];

/// Memory of a way back: one that led back to the same obstacle is not repeated within this time,
/// seconds.
const TRIED_S: f64 = 60.0;

/// Cycles between two searches for a way back, each at one intercept angle.
pub(super) const LOOK_BACK_EVERY: u32 = 2;

/// A way back withstands all motions of aircraft for this long, seconds: a turn of 60° at the standard
/// rate takes as long.
const BACK_WITHSTANDS_S: f64 = 20.0;

/// Time of the search for a way back with all of the wanted margin, seconds; as long again for half of it.
const MORE_ROOM_S: f64 = 20.0;

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
    let slow_mps = ALONGSIDE * own.velocity_mps().length();
    let longest_s = if square < slow_mps * slow_mps {
        LONGEST_PASS_S
    } else {
        f64::MAX
    };
    (offset.dot(relative) / square).limited(0.0, longest_s)
}

/// How often the time of a search for a way back from a plan has passed.
pub(super) fn given_up(plan: &Plan, time_s: f64) -> usize {
    whole((time_s - plan.start_s) / MORE_ROOM_S, 4) - 1
}

/// The place of the intercept angle of a look for a way back: each second look is at the preferred one.
const fn place_of(look: usize) -> usize {
    if look.is_multiple_of(2) {
        0
    } else {
        1 + look / 2 % (INTERCEPTS_RAD.len() - 1)
    }
}

/// From which intercept angle on a way onto the leg that begins at waypoint `index` is the same, radians. A larger one may
/// lead onto a leg before it, if there is one after the present one.
const fn same_from_rad(way: &Way, index: usize, present: usize) -> f64 {
    if index == present {
        way.shot.same_from_rad
    } else {
        f64::INFINITY
    }
}

impl Avoider {
    /// A certified way back to the mission, if there is one now and this is the cycle of a look, one in `every`. Does not look at
    /// one that seems to join the mission after `latest_s`.
    pub(super) fn way_back(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        plan: &Plan,
        (every, latest_s): (u32, f64),
    ) -> Option<Plan> {
        if !self.cycle.is_multiple_of(every) || self.meter.is_met() {
            return None;
        }
        // After a long search without room for the wanted margin less is enough.
        let given_up = given_up(plan, situation.time_s);
        let rung = (WANTED + given_up).min(RUNGS - 2);
        let demand = &self.demand_of(rung);
        // Counted in looks, so that none of the angles is left out at any period.
        let look = (self.cycle / every) as usize;
        let intercept_rad = *INTERCEPTS_RAD.get(place_of(look))?;
        let mission = &situation.mission;
        // Skipping a leg is only for a leg that the aircraft cannot join at any angle.
        let waited_s = situation.time_s - plan.start_s;
        let skips = waited_s >= SKIP_AFTER_S;
        let skipped = if skips { MAX_SKIPPED } else { 0 };
        let detour = (look % 2 == 1)
            .then(|| self.detour(situation, now, (waited_s, look / 2)))
            .flatten();
        let is_any = look.is_multiple_of(2);
        let is_long = given_up > 2;
        let (mut first, from) = detour.unwrap_or((Maneuver::hold(), *now));
        // A way that is flown is looked for from where the aircraft has come to, in turn with the other angles.
        let flown_rad = self.progress.leg(now).turn_onto_rad(now).abs();
        let intercepts_rad: &[f64] = match (is_any, latest_s < f64::INFINITY) {
            (true, true) => core::slice::from_ref(&flown_rad),
            (true, false) => &INTERCEPTS_RAD,
            (false, _) => core::slice::from_ref(&intercept_rad),
        };
        let mut way = Way::default();
        let nearest = self.nearest_way_back(mission, &from, skipped, intercepts_rad, &mut way);
        let joins_s = nearest.and_then(|_| Some(way.end()?.at_s));
        let is_late = joins_s.is_some_and(|s| situation.time_s + s + self.late_s() > latest_s);
        let target_m = demand.margin_m;
        if detour.is_none() && (is_late || nearest.is_some() && self.is_blocked(&way, target_m)) {
            return None;
        }
        let limits = JoinLimits {
            intercept_rad: nearest.map_or(intercept_rad, |(nearest_rad, ..)| nearest_rad),
            climb_limits_rad: self.climb_limits_rad(),
        };
        let before = self.progress;
        let way = self.on_mission(|progress, flyer| {
            progress.way_back(mission, &from, flyer, &limits, skipped)
        });
        let is_near = |joined: &Join| intercept_rad >= SHALLOW_RAD || joined.joined_s <= SHALLOW_S;
        let mut way = way.filter(|(joined, _)| joined.is_on_leg() && (is_any || is_near(joined)));
        // Straight to the next waypoint, as if the mission began here: no leg could be joined for long.
        for (turn_rad, radii) in AWAY.into_iter().filter(|_| is_any && given_up > 0) {
            if way.is_some() {
                break;
            }
            first = Maneuver::turn(0.0, now.course_rad + turn_rad, 0.0);
            let from = self.after(now, &first, radii / self.flyer.course_rate_radps());
            way = self.on_mission(|progress, flyer| progress.way_from_here(mission, &from, flyer));
        }
        let (joined, index) = way?;
        let back = self.fly_back(&first, (&joined, index), plan, (situation, now), rung);
        // Two that flee from each other side by side would never return: after long, what keeps a way back suffices.
        let is_robust = |avoider: &mut Self, back: &Plan| {
            let back = &back.maneuver;
            avoider.is_robust_back(back, now, demand.margin_m)
                || is_long && avoider.has_reserve(back, now)
        };
        let Some(back) = back.filter(|back| is_robust(self, back)) else {
            self.progress = before;
            return None;
        };
        let late_s = joins_s.map_or(0.0, |joins_s| joined.joined_s - joins_s);
        self.return_to(index, plan, (joined.joined_s, late_s), (situation, now));
        Some(back)
    }

    /// The plan to fly a manoeuvre and a join of the leg that begins at a waypoint after it; `None` where it leads to an obstacle,
    /// or to another encounter that cannot be avoided.
    fn fly_back(
        &mut self,
        first: &Maneuver,
        (joined, index): (&Join, usize),
        plan: &Plan,
        (situation, now): (&Situation<'_>, &MotionState),
        rung: usize,
    ) -> Option<Plan> {
        let far = Demand {
            horizon_s: self.far_s,
            ..self.demand_of(rung)
        };
        let leg = self.progress.leg(now);
        let gained_m = if index == self.progress.index() {
            joined.along_m - leg.position(now.position_m, now.time_s).along_m
        } else {
            f64::INFINITY
        };
        let mut maneuver = *first;
        for stage in joined.maneuver.stages() {
            maneuver.push(*stage);
        }
        let bend = Bend {
            index,
            straight_s: joined.joined_s,
            along_m: joined.along_m,
        };
        self.on_mission(|progress, flyer| {
            let mission = &situation.mission;
            progress.round_corners(mission, flyer, far.horizon_s, &mut maneuver, bend)
        });
        let mut back = Plan {
            maneuver,
            decided_s: situation.time_s,
            start_s: situation.time_s,
            joined_s: situation.time_s + joined.joined_s,
            margin_m: far.margin_m,
            rung,
            cost: 0.0,
            next_start_s: None,
            basis: None,
            is_small: false,
            ..*plan
        };
        self.predict(&maneuver, now, far.horizon_s);
        match self.way_ahead(plan, (joined.joined_s, gained_m), (situation, &leg), &far) {
            WayAhead::Blocked => None,
            WayAhead::Clear => {
                let certified = self.prove((far.horizon_s, far.margin_m, ENOUGH_M));
                certified.map(|certified| {
                    back.proof = Proof::Certified(certified);
                    back.margin_m = certified.margin_m();
                    back.outlook = self.outlook(situation.wind_mps, 0.0);
                    let lasting = self.lasting(&back, situation, now, &far);
                    back.basis = lasting.and_then(|(basis, _)| basis);
                    back
                })
            }
            WayAhead::NextEncounter => self.way_back_and_on(&back, joined.joined_s, now, &far),
        }
    }

    /// How much later than it seemed to the last way back joined the mission, seconds.
    fn late_s(&self) -> f64 {
        self.returned.map_or(0.0, |returned| returned.late_s)
    }

    /// Whether a way back leads into an obstacle, wherever in its neighbourhood it lies.
    fn is_blocked(&self, way: &Way, target_m: f64) -> bool {
        let [ideal, lagged] = ROUGHLY;
        let radii = if self.flyer.is_ideal() { ideal } else { lagged };
        let inside_m = target_m - radii * self.flyer.turn_radius_m();
        let hazards = self.tracks.hazards().rows();
        way.lines().any(|(line, bow_m)| {
            let duration_s = line.duration_s.min(self.far_s - line.at_s);
            if duration_s <= 0.0 || !self.meter.take(hazards.len()) {
                return false;
            }
            let line = Line { duration_s, ..line };
            let into = |hazard: &Hazard| hazard.least_on_line(&line, inside_m - bow_m, &self.meter);
            hazards.iter().any(|hazard| into(hazard).is_some())
        })
    }

    /// Remembers a chosen way back and goes on to its leg.
    fn return_to(
        &mut self,
        leg: usize,
        plan: &Plan,
        (joined_s, late_s): (f64, f64),
        (situation, now): (&Situation<'_>, &MotionState),
    ) {
        self.returned = Some(Returned {
            against: plan.against,
            leg,
            time_s: situation.time_s + joined_s,
            late_s,
        });
        let mission = &situation.mission;
        self.on_mission(|progress, flyer| progress.advance_to(leg, mission, now, flyer));
    }

    /// Of the ways onto the mission at some intercept angles the one that departs least, with its angle and the index of the
    /// leg's first waypoint; the first, preferred one, unless another is clearly nearer.
    fn nearest_way_back(
        &mut self,
        mission: &Mission<'_>,
        from: &MotionState,
        skipped: usize,
        intercepts_rad: &[f64],
        nearest: &mut Way,
    ) -> Option<(f64, usize)> {
        let climb_limits_rad = self.climb_limits_rad();
        let is_only = intercepts_rad.len() == 1;
        let look = |progress: &mut Progress, turns: &Turns<'_>| {
            let mut other = Way::default();
            let mut best: Option<(f64, (f64, usize))> = None;
            for intercept_rad in intercepts_rad {
                let most_m = best.map_or(f64::INFINITY, |(away_m, _)| CLEARLY_NEARER * away_m);
                let same_from_rad = best.map_or(f64::INFINITY, |(_, (_, index))| {
                    same_from_rad(nearest, index, progress.index())
                });
                if *intercept_rad >= same_from_rad {
                    continue;
                }
                let limits = JoinLimits {
                    intercept_rad: *intercept_rad,
                    climb_limits_rad,
                };
                if !progress.may_measure(mission, skipped) {
                    break;
                }
                let way = if best.is_none() {
                    &mut *nearest
                } else {
                    &mut other
                };
                let asked = (&limits, skipped);
                let found = progress.way_back_roughly(mission, from, turns, asked, way);
                let Some(index) = found else { continue };
                let away_m = if is_only {
                    0.0
                } else {
                    progress.departure_m(mission, (way, index), most_m)
                };
                if best.is_some() {
                    if away_m >= most_m {
                        continue;
                    }
                    *nearest = other;
                }
                best = Some((away_m, (*intercept_rad, index)));
            }
            best.map(|(_, found)| found)
        };
        self.on_mission(|progress, flyer| progress.with_turns(flyer, from, look))
    }

    /// A way back that meets other obstacles later, with the manoeuvre that avoids those.
    fn way_back_and_on(
        &mut self,
        back: &Plan,
        joined_s: f64,
        now: &MotionState,
        demand: &Demand,
    ) -> Option<Plan> {
        let maneuver = back.maneuver;
        let (threat, against) = self.first_threat(&maneuver, now, demand)?;
        let found = self.search(&maneuver, now, demand, |search| {
            let found = search.cheapest(joined_s)?;
            let proven = search.proven(found)?;
            Some(Answer::new(search, proven, back.rung))
        })?;
        Some(Plan {
            next_start_s: Some(back.joined_s),
            threat: Some(threat),
            threat_found_s: back.decided_s,
            against,
            ..back.with(&found, back.decided_s)
        })
    }

    /// The clearance of the way back in the path, which arrives at a time with this much gained along the leg, metres.
    fn way_ahead(
        &self,
        plan: &Plan,
        (joined_s, gained_m): (f64, f64),
        (situation, leg): (&Situation<'_>, &Leg),
        demand: &Demand,
    ) -> WayAhead {
        let (horizon_s, target_m) = (demand.horizon_s, demand.margin_m);
        let is_again = self.was_tried(plan, situation.time_s);
        let mut ahead = WayAhead::Clear;
        if self.meter.is_met() {
            return WayAhead::Blocked;
        }
        let hazards = self.tracks.hazards();
        let reach = (horizon_s, target_m);
        let close = mark_close(&self.flyer, &self.path, hazards, reach, &self.meter);
        let is_whole = self.path.is_complete();
        for (hazard, close) in hazards.rows().iter().zip(close) {
            if is_whole && !close {
                continue;
            }
            let whole = self.certify_one(hazard, (horizon_s, target_m, target_m));
            if whole.holds(target_m) {
                continue;
            }
            let before = self.certify_one(hazard, (joined_s.min(horizon_s), target_m, target_m));
            if !before.holds(target_m) {
                return WayAhead::Blocked;
            }
            if plan.against.contains(hazard.id) {
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

    /// Whether a way back withstands, for a time, all motions of the aircraft that do not move away from it.
    fn is_robust_back(&mut self, back: &Maneuver, now: &MotionState, target_m: f64) -> bool {
        if !self.tracks.has_aircraft() {
            return true;
        }
        if self.meter.is_met() {
            return false;
        }
        let own_m = now.position_m;
        let mission_rad = now.course_rad + self.progress.leg(now).turn_onto_rad(now);
        let first_rad = back.stages().first().map(|stage| stage.course_rad);
        // An aircraft moves away if it does so now, on the way back and on the mission.
        let ours_mps = [Some(now.course_rad), first_rad, Some(mission_rad)].map(|course_rad| {
            let course_rad = course_rad.unwrap_or(now.course_rad);
            self.flyer.velocity_mps(&MotionState { course_rad, ..*now })
        });
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
        let clearance = Clearance {
            beyond_m: 0.0,
            is_unproven: false,
            margin_m: target_m,
        };
        self.tracks.withstand(freedom, clearance, &self.meter);
        self.margin_of(back, now, (BACK_WITHSTANDS_S, target_m, target_m)) >= target_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::avoider::Settings;
    use crate::situation::{Obstacles, Ownship};
    use crate::vehicle::Vehicle;

    const WAYPOINTS_M: [Vec3; 3] = [
        Vec3::ZERO,
        Vec3::new(300.0, 0.0, 0.0),
        Vec3::new(300.0, 900.0, 0.0),
    ];

    /// Aircraft at places beside the first leg of a mission with two, on their way alone.
    fn on_their_way(mut look: impl FnMut(Avoider, &Mission<'_>, &MotionState)) {
        let mission = Mission::new(&WAYPOINTS_M);
        for lag_s in [0.0, 0.6] {
            for case in 0..200_u32 {
                let mut avoider =
                    Avoider::new(Settings::default(), Vehicle::lagged(lag_s)).unwrap();
                let part = f64::from(case) / 200.0;
                let ownship = Ownship {
                    position_m: Vec3::new(60.0 + 200.0 * part, 120.0 * (17.0 * part).sin(), 0.0),
                    airspeed_mps: avoider.vehicle().airspeed_mps,
                    course_rad: 6.0 * (31.0 * part).sin(),
                    climb_rad: 0.0,
                    bank_rad: 0.0,
                };
                avoider.step(&Situation {
                    time_s: 0.0,
                    ownship,
                    obstacles: Obstacles::Rows(&[]),
                    mission,
                    wind_mps: Vec3::ZERO,
                });
                look(avoider, &mission, &MotionState::of(&ownship));
            }
        }
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

    /// The nearest way belongs to the angle told with it. A later way may be nearer than the first.
    #[test]
    fn the_nearest_way_back_is_that_of_its_angle() {
        let mut others = 0;
        on_their_way(|mut avoider, mission, state| {
            let (mut way, mut same) = (Way::default(), Way::default());
            let all = &INTERCEPTS_RAD;
            let found = avoider.nearest_way_back(mission, state, 1, all, &mut way);
            let Some((intercept_rad, index)) = found else {
                return;
            };
            others += u32::from(intercept_rad != all[0]);
            let alone = [intercept_rad];
            let found = avoider.nearest_way_back(mission, state, 1, &alone, &mut same);
            assert_eq!(found, Some((intercept_rad, index)), "{state:?}");
            assert_eq!(way.end(), same.end(), "{state:?}");
        });
        assert!(others > 10, "{others} ways of another angle than the first");
    }
}

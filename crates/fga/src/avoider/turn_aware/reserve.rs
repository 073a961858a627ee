//! A large turn in reserve: while one that begins later still withstands what may come, the aircraft flies on, along its
//! mission, a manoeuvre near its course, or a way back.
//!
//! A large turn late departs by the width of the volume. A climb or a slight turn that begins some seconds sooner departs by
//! much less, but the intruder may follow it. So the policy flies it like the mission: as long as a large turn remains.

use core::f64::consts::PI;

use crate::avoider::demand::{BEYOND_M, WANTED};
use crate::avoider::intruders::Freedom;
use crate::avoider::{Avoider, Decision, Now, Places, Reason, State, Threat};
use crate::maneuver::Maneuver;

use super::Answer;
use super::ladder::RUNG_SHARE;

/// The turn in reserve begins this much later, seconds.
pub(in crate::avoider) const WAIT_S: f64 = 2.0;

/// Only manoeuvres with at most this turn are in reserve, radians (74.5°).
const RESERVE_RAD: f64 = 1.3;

/// A small manoeuvre turns by at most this, radians (23°).
const SMALL_TURN_RAD: f64 = 0.4;

/// A small manoeuvre begins at most this long before the entry, seconds: sooner than that an intruder mostly turns before it
/// comes.
const BEGINS_WITHIN_S: f64 = 25.0;

/// About a volume with a smaller radius than this many of a turn, a large turn departs by little more than a small one.
const WIDE: f64 = 1.2;

/// An intruder that is faster than the aircraft by this factor leaves too little for a second manoeuvre.
const MUCH_FASTER: f64 = 2.0;

impl Avoider<dyn Places + '_> {
    /// Whether a large turn that begins later along a path withstands all that is wanted.
    pub(super) fn has_reserve(&mut self, along: &Maneuver, now: &Now<'_>) -> bool {
        self.may_wait(along, now, RESERVE_RAD)
    }

    /// Whether a manoeuvre goes on like the mission: near its course, where waiting costs no departure, with a large turn in reserve.
    pub(super) fn may_go_on(&mut self, along: &Maneuver, now: &Now<'_>) -> bool {
        self.away_rad(now).abs() <= SMALL_TURN_RAD && self.has_reserve(along, now)
    }

    fn may_wait(&mut self, along: &Maneuver, now: &Now<'_>, most_turn_rad: f64) -> bool {
        let demand = self.first_demand();
        self.ask(&demand, BEYOND_M);
        self.has_turn(along, now, (WAIT_S, most_turn_rad))
    }

    /// Whether a turn that begins now withstands all that aircraft do, as a way back does.
    pub(super) fn is_free(&mut self, now: &Now<'_>) -> bool {
        self.withstand(&|_| Freedom::Brief, (0.0, self.wanted_m()));
        self.has_turn(&Maneuver::HOLD, now, (0.0, PI))
    }

    /// Whether a turn that begins after some seconds along a path keeps clear of the hazards of now.
    fn has_turn(
        &mut self,
        along: &Maneuver,
        now: &Now<'_>,
        (after_s, most_turn_rad): (f64, f64),
    ) -> bool {
        let demand = self.first_demand();
        // As far from walls as if it began now.
        let walls_s = self.tracks.walls_s() + after_s;
        self.within_walls(walls_s, |avoider| {
            avoider.search(along, now, &demand, |search| {
                search.share_work(RUNG_SHARE);
                search.is_avoidable_within(after_s, most_turn_rad)
            })
        })
    }

    /// Flies on along the mission while a threat is known.
    pub(super) fn wait(&mut self, threat: &Threat, decision: &mut Decision) {
        self.state = State::Threatened;
        self.say(decision, Reason::WaitingForStart);
        decision.record.threat = Some(*threat);
        decision.record.start_s = Some(WAIT_S);
    }

    /// A small manoeuvre to begin now, because its last moment has come.
    #[inline(never)]
    pub(super) fn small_now(
        &mut self,
        nominal: &Maneuver,
        now: &Now<'_>,
        threat: &Threat,
    ) -> Option<Answer> {
        let is_time = threat.entry_s <= BEGINS_WITHIN_S && self.pays_small(threat.id);
        if !is_time || self.may_wait(nominal, now, SMALL_TURN_RAD) {
            return None;
        }
        self.highest(0..=WANTED, &Maneuver::HOLD, now, &mut |search| {
            search.cheapest(0.0)
        })
        .filter(|answer| answer.found.turns.turn_rad.abs() <= SMALL_TURN_RAD)
    }

    /// Whether a small manoeuvre saves much and may be followed by a large one: the volume is wide, the intruder not much faster.
    fn pays_small(&self, id: u32) -> bool {
        let wide_m = WIDE * self.flyer.turn_radius_m();
        let fast_mps = MUCH_FASTER * self.flyer.airspeed_mps();
        let mut hazards = self.tracks.rows().iter();
        self.tracks.has_aircraft()
            && hazards.any(|hazard| {
                hazard.id() == id
                    && hazard.volume.radius_m() > wide_m
                    && hazard.velocity_mps.length() < fast_mps
            })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{aircraft, among};
    use super::*;
    use crate::situation::{Obstacle, ProtectedVolume};

    fn has_reserve(row: Obstacle) -> bool {
        among(&[row], |avoider, _, now| {
            avoider.has_reserve(&Maneuver::turn(0.0, 0.0, 0.0), now)
        })
    }

    /// Two seconds later 80 m less are left: 40 m/s close.
    #[test]
    fn a_turn_is_in_reserve_while_there_is_time_for_it() {
        assert!(has_reserve(aircraft(1, (900.0, 0.0), (-20.0, 0.0))));
        assert!(!has_reserve(aircraft(1, (200.0, 0.0), (-20.0, 0.0))));
    }

    /// About a wide volume of an intruder that is not much faster.
    #[test]
    fn a_small_manoeuvre_pays_where_it_saves_much() {
        let pays = |radius_m: f64, speed_mps: f64| {
            let row = Obstacle {
                volume: ProtectedVolume::Sphere { radius_m },
                ..aircraft(1, (900.0, 0.0), (-speed_mps, 0.0))
            };
            among(&[row], |avoider, _, _| {
                assert!(!avoider.pays_small(2));
                avoider.pays_small(1)
            })
        };
        assert!(pays(400.0, 20.0));
        assert!(!pays(10.0, 20.0));
        assert!(!pays(400.0, 60.0));
    }
}

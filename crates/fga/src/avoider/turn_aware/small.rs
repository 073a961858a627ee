//! Small manoeuvres about aircraft: a slight turn or a climb, begun while a large turn would still do.
//!
//! A large turn late departs by the width of the volume. A climb or a slight turn that begins some seconds sooner departs by
//! much less, but the intruder may follow it. So the policy flies it like the mission: as long as a large turn that begins
//! later still withstands everything.

use crate::avoider::{Avoider, Decision, Plan, Reason, Threat};
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::search::Proof;
use crate::situation::Situation;

use super::aircraft::{Answer, WAIT_FOR_TURN_RAD, WAIT_S, WANTED_SHARE, side_of};

/// A small manoeuvre turns by at most this, radians (23°).
const SMALL_TURN_RAD: f64 = 0.4;

/// A small manoeuvre begins at most this long before the entry, seconds: sooner than that an intruder mostly turns before it
/// comes.
const BEGINS_WITHIN_S: f64 = 25.0;

/// A small manoeuvre that withstands less than this share is replaced.
const KEPT_SHARE: f64 = 0.25;

/// With this share a small manoeuvre needs no large turn in reserve.
const ALL: f64 = 1.0;

/// Where no large turn remains in reserve, a manoeuvre that withstands more than this share replaces a small one.
const CLEARLY_ALL: f64 = 0.6;

/// About a volume with a smaller radius than this many of a turn, a large turn departs by little more than a small one.
const WIDE: f64 = 1.2;

/// An intruder that is faster than the aircraft by this factor leaves too little for a second manoeuvre.
const MUCH_FASTER: f64 = 2.0;

impl Plan {
    /// The share that the manoeuvre withstands while it is kept.
    pub(super) const fn kept_share(&self) -> f64 {
        if self.is_small {
            KEPT_SHARE
        } else {
            WANTED_SHARE
        }
    }

    /// Whether the closest approach, as expected at the start, is over.
    pub(super) fn has_met_threat(&self, time_s: f64) -> bool {
        let closest_s = self.threat.map_or(0.0, |threat| threat.closest_s);
        time_s - self.threat_found_s >= closest_s
    }
}

impl Avoider {
    /// A small manoeuvre to begin now, because its last moment has come. The second value is the number of manoeuvres looked at.
    pub(super) fn small_now(
        &mut self,
        nominal: &Maneuver,
        now: &MotionState,
        threat: &Threat,
    ) -> (Option<Answer>, u32) {
        if threat.entry_s > BEGINS_WITHIN_S || !self.pays_small(threat.id) {
            return (None, 0);
        }
        let (later, candidates, _) = self.may_wait(nominal, now, SMALL_TURN_RAD, &self.demand());
        if later {
            return (None, candidates);
        }
        let (answer, looked_at) = self.cheapest_small(now);
        (answer, candidates + looked_at)
    }

    /// Whether a small manoeuvre saves much and may be followed by a large one: the volume is wide, the intruder not much faster.
    pub(super) fn pays_small(&self, id: u32) -> bool {
        let wide_m = WIDE * self.flyer.turn_radius_m();
        let fast_mps = MUCH_FASTER * self.flyer.airspeed_mps();
        let mut hazards = self.tracks.hazards().rows().iter();
        hazards.any(|hazard| {
            hazard.id == id
                && hazard.volume.radius_m() > wide_m
                && hazard.velocity_mps.length() < fast_mps
        })
    }

    /// A small manoeuvre that withstands the wanted share, if that is the cheapest.
    fn cheapest_small(&mut self, now: &MotionState) -> (Option<Answer>, u32) {
        let (answer, looked_at) =
            self.cheapest_within(now, None, (KEPT_SHARE, WANTED_SHARE), self.demand());
        (answer.filter(is_small), looked_at)
    }

    /// Flying a small manoeuvre that withstands the share `kept`, if any: keeps it while a large turn remains in reserve, else
    /// takes a manoeuvre that withstands more. None: it goes on as any other.
    pub(super) fn keep_small(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        plan: &Plan,
        (kept, proof): (Option<f64>, Proof),
    ) -> Option<Decision> {
        let time_s = situation.time_s;
        if kept.is_some_and(|kept| kept >= ALL) {
            return None;
        }
        let enough = kept.is_some_and(|kept| kept >= KEPT_SHARE);
        if !enough && let (Some(answer), _) = self.cheapest_small(now) {
            return Some(self.replace_small(plan, &answer, time_s));
        }
        let (in_reserve, ..) = self.may_wait(
            &plan.remaining(time_s),
            now,
            WAIT_FOR_TURN_RAD,
            &self.demand(),
        );
        if in_reserve {
            let Some(resilience) = kept else {
                return Some(self.fly_on(plan, time_s));
            };
            let plan = Plan {
                proof,
                resilience,
                ..*plan
            };
            self.plan = Some(plan);
            return Some(self.report(&plan, time_s, Reason::ManeuverKept));
        }
        let shares = if enough {
            (CLEARLY_ALL, ALL)
        } else {
            (kept.unwrap_or(-1.0), WANTED_SHARE)
        };
        let (answer, _) = self.cheapest_within(now, None, shares, self.demand());
        answer.map(|answer| {
            let large = Plan {
                start_s: time_s,
                is_small: false,
                ..*plan
            };
            self.replace_small(&large, &answer, time_s)
        })
    }

    /// Flies a small manoeuvre that comes too close to the expected motion, until the large one begins.
    fn fly_on(&mut self, plan: &Plan, time_s: f64) -> Decision {
        let plan = Plan {
            proof: Proof::Open,
            resilience: 0.0,
            ..*plan
        };
        self.plan = Some(plan);
        let mut decision = self.report(&plan, time_s, Reason::WaitingForStart);
        decision.record.start_s = Some(WAIT_S);
        decision
    }

    fn replace_small(&mut self, plan: &Plan, answer: &Answer, time_s: f64) -> Decision {
        let plan = Plan {
            side: side_of(&answer.found),
            ..plan.replaced_by(answer, time_s)
        };
        self.plan = Some(plan);
        self.report(&plan, time_s, Reason::ManeuverReplaced)
    }
}

/// Whether a manoeuvre is small.
pub(super) fn is_small(answer: &Answer) -> bool {
    answer.found.turns.turn_rad.abs() <= SMALL_TURN_RAD
}

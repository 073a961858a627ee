//! Walls: the zones and the ground of the mission, which may bound a manoeuvre.

use core::f64::consts::TAU;

use crate::assumptions::Assumptions;
use crate::avoider::tracks::zones::{is_clear, known_s};
use crate::avoider::turn_aware::ENOUGH_M;
use crate::avoider::turn_aware::detour::AFTER_RAD;
use crate::avoider::turn_aware::holding::KEEP_SHARE;
use crate::avoider::turn_aware::reserve::WAIT_S;
use crate::avoider::{Avoider, Now, Places};
use crate::certificate::{Line, certify_set};
use crate::limit::whole;
use crate::maneuver::{Maneuver, Stage};
use crate::situation::Situation;

/// With less of a step's work left a manoeuvre between walls is one turn, looked for once.
const WALLS_WORK: u32 = 50_000;

/// The longest way back that is looked at between walls, seconds.
const LONGEST_BACK_S: usize = 600;

impl Avoider<dyn Places + '_> {
    /// Whether zones or ground bound manoeuvres.
    pub(super) fn has_walls(&self, now: &Now<'_>) -> bool {
        !self.tracks.around(now.mission).fixed.is_empty()
    }

    /// Whether zones or ground bound manoeuvres, and the step has work for two turns between them beside the search for one.
    pub(super) fn has_room_between_walls(&self, now: &Now<'_>) -> bool {
        self.has_walls(now) && self.meter.left() >= WALLS_WORK
    }

    /// Whether zones or ground have kept it from a way back for long, seconds.
    pub(super) fn is_between_walls(&self, now: &Now<'_>, waited_s: f64) -> bool {
        self.has_walls(now) && waited_s * self.flyer.course_rate_radps() > 2.0 * AFTER_RAD
    }

    /// Does something while zones and ground count up to a moment, seconds. Of a way back that is its return: the mission itself is flown
    /// as it is given.
    pub(super) fn within_walls<T>(&mut self, until_s: f64, act: impl FnOnce(&mut Self) -> T) -> T {
        let before_s = self.tracks.until(until_s);
        let answer = act(self);
        self.tracks.until(before_s);
        answer
    }

    /// Between walls, looks for what stays between them until the encounter has passed, seconds, and can still turn away then.
    pub(super) fn inside<T>(
        &mut self,
        passes_s: f64,
        now: &Now<'_>,
        look: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let circle_s = self.tracks.walls_s();
        let until_s = circle_s.max(passes_s + KEEP_SHARE * circle_s);
        (self.has_room_between_walls(now)).then(|| self.within_walls(until_s, look))?
    }

    /// Whether the path that was predicted last keeps clear of zones and ground.
    pub(super) fn keeps_walls(&self, now: &Now<'_>, asked: (f64, f64, f64)) -> bool {
        let walls = Assumptions {
            rows: &[],
            ..self.tracks.around(now.mission)
        };
        certify_set(&self.flyer, &self.path, &walls, asked, &self.meter).holds(asked.1)
    }

    /// Whether that path keeps the wanted distance from zones and ground up to a moment, seconds.
    fn keeps_walls_until(&mut self, until_s: f64, now: &Now<'_>) -> bool {
        let asked = (until_s, self.wanted_m(), ENOUGH_M);
        self.within_walls(until_s, |avoider| avoider.keeps_walls(now, asked))
    }

    /// Gives the last waypoint up, to which the aircraft would fly back after a manoeuvre, where neither the way there nor a circle keeps
    /// clear of zones and ground: the mission alone is flown as it is given.
    pub(super) fn ends_before_walls(&mut self, situation: &Situation<'_>, now: &Now<'_>) {
        let is_bound = self.has_avoided && self.progress.returns() && self.has_walls(now);
        if is_bound
            && !self.can_circle(&Maneuver::HOLD, now, 0.0)
            && !self.can_return(situation, now)
        {
            self.on_mission(situation, |progress, route| {
                progress.advance_to(route, now, progress.index() + 1);
            });
        }
    }

    /// Whether zones and ground leave a level circle now, and none a little later along a path.
    pub(super) fn is_last_circle(&mut self, along: &Maneuver, now: &Now<'_>) -> bool {
        self.has_walls(now)
            && !self.can_circle(along, now, WAIT_S)
            && self.can_circle(&Maneuver::HOLD, now, 0.0)
    }

    /// Whether a level circle that begins after some seconds along a path keeps clear of zones and ground.
    fn can_circle(&mut self, along: &Maneuver, now: &Now<'_>, after_s: f64) -> bool {
        let until_s = after_s + self.tracks.walls_s();
        let from_rad = self.after(now, along.stages(), after_s).course_rad;
        [TAU, -TAU].into_iter().any(|turn_rad| {
            let mut circle = Maneuver::hold();
            circle.set(along.before(after_s));
            circle.push(Stage::turn(after_s, from_rad + turn_rad, 0.0));
            self.predict(&circle, now, until_s);
            self.keeps_walls_until(until_s, now)
        })
    }

    /// Whether the guidance to the end of the mission keeps clear of zones and ground.
    fn can_return(&mut self, situation: &Situation<'_>, now: &Now<'_>) -> bool {
        let (mut back, horizon_s) = (Maneuver::hold(), self.settings.horizon_s);
        let straight_s = self.guide((situation, now), horizon_s, &mut back);
        let joined = self.after(now, back.stages(), straight_s);
        let to_end_s = self.progress.to_end_s(&joined);
        let end_s = straight_s + to_end_s;
        to_end_s >= 0.0 && end_s <= known_s(&self.flyer, situation.wind_mps, self.wanted_m()) && {
            self.predict(&back, now, end_s);
            self.keeps_walls_until(end_s, now)
        }
    }

    /// Whether guidance keeps clear of zones and ground until it is back.
    pub(super) fn joins_before_walls(&mut self, guidance: &Maneuver, now: &Now<'_>) -> bool {
        let back_s = self.back_s(guidance, now);
        self.keeps_walls_until(back_s, now)
    }

    /// How long zones and ground count for guidance, seconds: on a way back up to its leg, because the mission itself is flown as it is
    /// given.
    pub(super) fn guidance_walls_s(&mut self, guidance: &Maneuver, now: &Now<'_>) -> f64 {
        if !self.has_walls(now) {
            self.tracks.walls_s()
        } else if self.state.is_away() {
            self.back_s(guidance, now)
        } else {
            0.0
        }
    }

    /// When guidance is back on its leg or at the end of it, whole seconds; the horizon if it is not within that.
    fn back_s(&mut self, guidance: &Maneuver, now: &Now<'_>) -> f64 {
        let (horizon_s, can_climb) = (self.settings.horizon_s, self.can_climb());
        self.predict(guidance, now, horizon_s);
        let mut seconds = (0..whole(horizon_s, LONGEST_BACK_S)).map(|second| second as f64);
        let back_s = seconds.find(|second| {
            let state = self.path.state_at(&self.flyer, *second);
            state.is_some_and(|state| {
                self.progress.is_back(&state, can_climb) || self.progress.to_end_s(&state) <= 0.0
            })
        });
        back_s.unwrap_or(horizon_s)
    }

    /// Whether the path leads clear of the mission's zones and ground between two moments, seconds, where they are beyond those that are
    /// near: each second of it is a line. It is proven once they are near.
    pub(super) fn is_clear_later(
        &self,
        situation: &Situation<'_>,
        (from_s, until_s): (f64, f64),
    ) -> bool {
        if until_s <= from_s {
            return true;
        }
        let place_m = |second: usize| {
            let at_s = (from_s + second as f64).min(until_s);
            let state = self.path.state_at(&self.flyer, at_s)?;
            Some(state.position_m + situation.wind_mps * at_s)
        };
        let seconds = whole(until_s - from_s, LONGEST_BACK_S);
        let Some(end_m) = place_m(seconds) else {
            return false;
        };
        let spared_m = [situation.ownship.position_m, end_m];
        let mut last_m = place_m(0);
        (1..=seconds).all(|second| {
            let before_m = core::mem::replace(&mut last_m, place_m(second));
            before_m.zip(last_m).is_some_and(|(from_m, to_m)| {
                let line = (&Line::between(from_m, to_m), self.wanted_m());
                is_clear(&situation.mission, line, &spared_m, &self.meter)
            })
        })
    }
}

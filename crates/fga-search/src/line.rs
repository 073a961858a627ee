//! The straight line on which a turn ends, and how close to obstacles it comes.

use fga_proof::Vec3;
use fga_proof::angle::Side;
use fga_proof::certificate::Certificate;
use fga_proof::limit::Limit as _;
use fga_proof::meter::BEND;
use fga_proof::prediction::{Bend, Exit, MotionState};

use super::{Search, Turns};

/// What a line takes to be set up, in units of work.
const LINE: usize = 4;

/// Where a turn begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub from: MotionState,
    /// Margin up to there, metres.
    pub before_m: f64,
    /// Cosine and sine of the course and of the climb angle.
    course: (f64, f64),
    climb: (f64, f64),
}

impl Entry {
    /// At the origin along +x.
    pub(super) const NONE: Self = Self {
        from: MotionState::ahead(0.0),
        before_m: 0.0,
        course: (1.0, 0.0),
        climb: (1.0, 0.0),
    };

    /// When it is, seconds.
    pub(super) const fn wait_s(&self) -> f64 {
        self.from.time_s
    }

    /// Where a turn's roll-out begins, metres.
    pub(super) fn place_m(&self, exit: &Exit, way: &Way) -> Vec3 {
        let Way { side, climbing } = *way;
        let Climbing {
            climbs_s,
            level,
            along_m,
            ..
        } = climbing;
        let share = if exit.begins_s < climbs_s {
            exit.begins_s / climbs_s
        } else {
            1.0
        };
        let ahead_m = level * exit.at_m.0 + share * along_m;
        let left_m = level * side.sign() * exit.at_m.1;
        let (cos, sin) = self.course;
        // While it climbs, by the angle halfway.
        let path_m = exit.path_m;
        let up_m = if share < 1.0 {
            path_m * (self.climb.1 + 0.5 * share * (climbing.up - self.climb.1))
        } else {
            path_m * climbing.up + climbing.up_m
        };
        self.from.position_m
            + Vec3::new(
                ahead_m * cos - left_m * sin,
                ahead_m * sin + left_m * cos,
                up_m,
            )
    }

    pub(super) const fn turns(&self, turn_rad: f64, climb_rad: f64) -> Turns {
        Turns {
            wait_s: self.from.time_s,
            turn_rad,
            climb_rad,
            second: None,
        }
    }
}

/// A change of climb angle, and what it moves the aircraft by beyond flying at its target at once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Climbing {
    /// The target, radians.
    pub climb_rad: f64,
    /// Sine and cosine of the target.
    up: f64,
    level: f64,
    /// How long it takes, seconds.
    pub climbs_s: f64,
    /// Along the course and up, metres.
    along_m: f64,
    up_m: f64,
}

impl Climbing {
    /// To the horizontal, from there.
    pub(super) const NONE: Self = Self {
        climb_rad: 0.0,
        up: 0.0,
        level: 1.0,
        climbs_s: 0.0,
        along_m: 0.0,
        up_m: 0.0,
    };
}

/// The side of turns and the climb target taken up during them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub side: Side,
    pub climbing: Climbing,
}

/// The straight line on which a turn ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangent {
    /// The turn, radians.
    pub turn_rad: f64,
    /// The aircraft on it, all of its turn and climb over.
    pub state: MotionState,
    pub velocity_mps: Vec3,
    /// When turns that go on leave this one, seconds.
    pub parts_s: f64,
    /// How far the line may be from the true one, metres.
    pub inexact_m: f64,
}

/// What the line on which a turn ends tells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub margin_m: f64,
    /// How far turning on by a radian moves the aircraft at most by the closest approach, metres.
    pub lever_m: f64,
    /// From when turns that go on leave this one to the closest approach, seconds.
    pub left_s: f64,
    pub inexact_m: f64,
}

impl Search<'_> {
    /// Where turns begin after a wait; `None` where that comes too close before.
    pub(super) fn entry(&mut self, wait_s: f64) -> Option<Entry> {
        let before_m = self.margin_before(wait_s);
        if before_m < self.scene.target_m {
            return None;
        }
        let from = self.departure(wait_s);
        let any = Turns {
            wait_s,
            turn_rad: 0.0,
            climb_rad: 0.0,
            second: None,
        };
        // The corners before it may leave no room for the turn.
        let is_whole = self.maneuver(&any, &from).is_whole();
        is_whole.then(|| Self::entry_at(&from, before_m))
    }

    pub(super) fn entry_at(from: &MotionState, before_m: f64) -> Entry {
        let unit = |angle_rad| {
            let (sin, cos) = libm::sincos(angle_rad);
            (cos, sin)
        };
        Entry {
            from: *from,
            before_m,
            course: unit(from.course_rad),
            climb: unit(from.climb_rad),
        }
    }

    /// Whether a turn may do as far as the line tells on which it ends.
    pub(super) fn may_do(
        &mut self,
        from: &MotionState,
        (climb_rad, side): (f64, Side),
        turn_rad: f64,
    ) -> bool {
        let entry = Self::entry_at(from, f64::INFINITY);
        let way = self.way(&entry, climb_rad, side);
        let target_m = self.scene.target_m;
        self.look(&entry, &way, turn_rad, target_m)
            .is_none_or(|look| look.margin_m + look.inexact_m >= target_m)
    }

    /// The margin on the line on which a turn ends, up to `enough_m`; once it is below the target it may be that of any
    /// hazard. `None` where the turn is not over before the horizon.
    pub(super) fn look(
        &mut self,
        entry: &Entry,
        way: &Way,
        turn_rad: f64,
        enough_m: f64,
    ) -> Option<Look> {
        let tangent = self.tangent(entry, way, turn_rad)?;
        self.look_along(&tangent, enough_m)
    }

    /// The same on a line that is known.
    pub(super) fn look_along(&mut self, tangent: &Tangent, enough_m: f64) -> Option<Look> {
        if tangent.state.time_s >= self.scene.horizon_s {
            return None;
        }
        let clear = Certificate::clear(enough_m);
        let (state, velocity_mps) = (&tangent.state, tangent.velocity_mps);
        let line = self.straight_on(state, velocity_mps, &clear, self.scene.target_m);
        let left_s = line.at_s - tangent.parts_s;
        Some(Look {
            margin_m: line.margin_m,
            lever_m: self.scene.flyer.airspeed_mps() * left_s,
            left_s,
            inexact_m: tangent.inexact_m,
        })
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

    /// The line on which a turn to a side at a climb target ends.
    pub(super) fn tangent(&mut self, entry: &Entry, way: &Way, turn_rad: f64) -> Option<Tangent> {
        if !self.meter.take(LINE) {
            return None;
        }
        let Entry { from, course, .. } = entry;
        let sign = way.side.sign();
        let bend = self.bend(sign * from.bank_rad, way.side)?;
        let turn_rad = turn_rad.max(bend.least_rad());
        let exit = bend.exit(turn_rad)?;
        let inexact_m = bend.inexact_m();
        let Climbing {
            climb_rad,
            up,
            level,
            climbs_s,
            along_m,
            up_m,
        } = way.climbing;
        let speed_mps = self.scene.flyer.airspeed_mps();
        let turned = (exit.turned.0, sign * exit.turned.1);
        let end = (
            course.0 * turned.0 - course.1 * turned.1,
            course.1 * turned.0 + course.0 * turned.1,
        );
        let after_s = exit.over_s.max(climbs_s);
        let straight_m = level * speed_mps * (after_s - exit.begins_s);
        // On which course it climbs is not told: half on either.
        let half_m = 0.5 * along_m;
        let (ahead_m, left_m) = (level * exit.from_m.0 + half_m, level * sign * exit.from_m.1);
        let end_m = straight_m + half_m;
        let moved_m = Vec3::new(
            ahead_m * course.0 - left_m * course.1 + end_m * end.0,
            ahead_m * course.1 + left_m * course.0 + end_m * end.1,
            up * speed_mps * after_s + up_m,
        );
        Some(Tangent {
            turn_rad,
            state: MotionState {
                time_s: from.time_s + after_s,
                position_m: from.position_m + moved_m,
                course_rad: from.course_rad + sign * turn_rad,
                climb_rad,
                bank_rad: 0.0,
            },
            velocity_mps: Vec3::new(level * end.0, level * end.1, up) * speed_mps,
            parts_s: from.time_s + exit.begins_s,
            inexact_m: inexact_m + along_m.abs(),
        })
    }

    /// The side of turns and a climb target.
    pub(super) fn way(&self, entry: &Entry, climb_rad: f64, side: Side) -> Way {
        Way {
            side,
            climbing: self.climbing(entry, climb_rad),
        }
    }

    /// What changing the climb angle moves the aircraft by, by the means of cos θ and sin θ while θ changes.
    pub(super) fn climbing(&self, entry: &Entry, climb_rad: f64) -> Climbing {
        let flyer = self.scene.flyer;
        let (low, high) = self.scene.climb_limits_rad;
        let target_rad = climb_rad;
        let climb_rad = climb_rad.limited(low, high);
        let change_rad = climb_rad - entry.from.climb_rad;
        let (level_now, up_now) = entry.climb;
        let mut climbing = Climbing {
            climb_rad: target_rad,
            up: up_now,
            level: level_now,
            climbs_s: 0.0,
            along_m: 0.0,
            up_m: 0.0,
        };
        if change_rad.abs() > 1e-9 && flyer.climb_rate_radps() > 0.0 {
            let (up, level) = libm::sincos(climb_rad);
            let climbs_s = change_rad.abs() / flyer.climb_rate_radps();
            let path_m = flyer.airspeed_mps() * climbs_s;
            climbing = Climbing {
                climb_rad: target_rad,
                up,
                level,
                climbs_s,
                along_m: path_m * ((up - up_now) / change_rad - level),
                up_m: path_m * ((level_now - level) / change_rad - up),
            };
        }
        climbing
    }

    /// Turns to a side from a bank that is positive towards it.
    pub(super) fn bend(&mut self, bank_rad: f64, side: Side) -> Option<&Bend> {
        let flyer = self.scene.flyer;
        if let Some(bend) = flyer.bend_from(bank_rad) {
            return Some(bend);
        }
        let known = |bend: &Option<Bend>| bend.as_ref().is_some_and(|bend| bend.is_from(bank_rad));
        if let Some(place) = self.bends.iter().position(known) {
            return self.bends.get(place)?.as_ref();
        }
        if !self.meter.take(BEND) {
            return None;
        }
        let slot = self.bends.get_mut(usize::from(side == Side::Right))?;
        *slot = Bend::new(flyer, bank_rad);
        slot.as_ref()
    }
}

//! One arc, all its tangents: the margins of every turn to one side at one climb target.

mod walk;

use fga_proof::Vec3;
use fga_proof::angle::Side;
use fga_proof::certificate::{Certificate, Chord, Hazard, HazardSet as _, Line};
use fga_proof::limit::Limit as _;
use fga_proof::meter::{LAGGED_STEP, Meter, SETUP};
use fga_proof::prediction::{CHORD_BOW_M, MAX_NODES, MotionState, Node, Target, chords};

use super::{CLIMB_STEP_RAD, Search, SecondTurn, Turns};

use walk::{LastStep, Walk};

/// Longest step along an arc, radians: it bows from its chord by less than a thousandth of its radius.
pub(super) const LONGEST_STEP_RAD: f64 = 0.1;

/// The step between the last turn that fails and the first that does is halved down to this share of it.
const FINEST: f64 = 1.0 / 128.0;

/// Accepted error of the end of a turn with bank lag, radians.
const ROLL_OUT_RAD: f64 = 1e-5;

/// Turns to one side at one climb target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sweep {
    /// The aircraft at the start of the turn.
    pub from: MotionState,
    /// The turn flown until then; without one the mission.
    pub first: Option<Turns>,
    /// Lower bound of the separation until then, metres.
    pub before_m: f64,
    /// The side of the turn.
    pub side: Side,
    /// Climb angle taken up during the turn, radians.
    pub climb_rad: f64,
    /// Smaller turns are known to be of no use, radians.
    pub from_rad: f64,
    /// Largest turn, radians.
    pub max_turn_rad: f64,
    /// Turns with a smaller margin are useless, metres.
    pub floor_m: f64,
    /// A turn with this margin is enough, metres.
    pub enough_m: f64,
}

/// A turn that ends where it leaves the arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leave {
    /// The turn, radians, left positive.
    pub turn_rad: f64,
    /// Climb angle taken up during the turn, radians.
    pub climb_rad: f64,
    /// Lower bound of the separation of the whole manoeuvre, metres.
    pub margin_m: f64,
    /// The aircraft at the end of the arc.
    pub state: MotionState,
    /// Lower bound of the separation until then, metres.
    pub before_m: f64,
}

impl Search<'_> {
    /// The first turn of a sweep with enough margin; without one, the one with the largest margin above the
    /// floor. With bank lag the margin after a roll-out is known to decimetres.
    pub(super) fn sweep(&mut self, sweep: &Sweep) -> Option<Leave> {
        self.is_rough = true;
        self.sweep_to(sweep).map(|(leave, _)| leave)
    }

    /// The first turn of a sweep with enough margin, shortened within its last step, or with
    /// less of a climb if it does not turn at all, as long as the margin is enough.
    pub(super) fn smallest(&mut self, sweep: &Sweep) -> Option<Leave> {
        self.is_rough = false;
        let (leave, last) = self.sweep_to(sweep)?;
        match last {
            Some(step) => self.with_less_turn(&leave, &step, sweep),
            None => Some(self.with_less_climb(&leave, sweep)),
        }
    }

    /// The answer of [`Self::sweep`], and its last step.
    ///
    /// Where a turn fails, an obstacle comes too close at some moment. The farther ahead that is, the
    /// more a small change of the turn has moved the aircraft by then. The sweep skips turns that cannot have
    /// moved it far enough, and examines the arc to them only once a turn succeeds.
    fn sweep_to(&mut self, sweep: &Sweep) -> Option<(Leave, Option<LastStep>)> {
        let sign = sweep.side.sign();
        let mut walk = Walk::new(self.scene.flyer, sweep);
        let mut seen = walk;
        let mut worst = Certificate::clear(sweep.before_m);
        let mut floor_m = sweep.floor_m;
        let mut best = None;
        let mut best_m = f64::MIN;
        let mut failing_rad = sweep.from_rad;
        let coarse_rad = if self.is_rough { self.coarse_rad } else { 0.0 };
        if !self.meter.take(SETUP) {
            return None;
        }
        loop {
            let turn_rad = self.turn_at(&walk.state, sweep);
            if sign * turn_rad >= failing_rad {
                let tail = self.tail(&walk.state, walk.velocity_mps(), sweep, &worst, floor_m);
                if tail.margin_m < floor_m {
                    let turned_rad = sign * (walk.state.course_rad - sweep.from.course_rad);
                    failing_rad = turned_rad + self.failing(&walk.state, &tail, sweep, floor_m);
                } else {
                    self.follow(&mut seen, &walk.state, floor_m, &mut worst);
                    if seen.state.time_s < walk.state.time_s && worst.margin_m >= floor_m {
                        // The limit was met before the whole arc was looked at.
                        return best;
                    }
                    let margin_m = tail.margin_m.min(worst.margin_m);
                    let leave = Leave {
                        turn_rad,
                        climb_rad: sweep.climb_rad,
                        margin_m,
                        state: walk.state,
                        before_m: worst.margin_m,
                    };
                    if margin_m >= sweep.enough_m {
                        return Some((leave, walk.last_step()));
                    }
                    if margin_m > floor_m {
                        best = Some((leave, walk.last_step()));
                        (best_m, floor_m) = (margin_m, margin_m);
                    }
                }
                failing_rad = failing_rad.max(sign * turn_rad + coarse_rad);
            }
            // An obstacle too close to the arc stays so however far the turn goes.
            let arc_fails = worst.margin_m < floor_m || worst.margin_m <= best_m;
            if arc_fails || failing_rad > sweep.max_turn_rad + ROLL_OUT_RAD || self.limit_met() {
                return best;
            }
            if !self.takes_step() || !walk.step() {
                return best;
            }
        }
    }

    /// Shows the ends of the steps along the arc of a sweep while it stays above the floor.
    pub(super) fn arc(&mut self, sweep: &Sweep, mut visit: impl FnMut(Leave)) {
        let mut walk = Walk::new(self.scene.flyer, sweep);
        let mut worst = Certificate::clear(sweep.before_m);
        if !self.meter.take(SETUP) {
            return;
        }
        loop {
            visit(Leave {
                turn_rad: self.turn_at(&walk.state, sweep),
                climb_rad: sweep.climb_rad,
                margin_m: worst.margin_m,
                state: walk.state,
                before_m: worst.margin_m,
            });
            if !self.takes_step() || !walk.step() {
                return;
            }
            self.along_step(&walk, sweep.floor_m, &mut worst);
            if worst.margin_m < sweep.floor_m || self.limit_met() {
                return;
            }
        }
    }

    /// Counts a step along an arc; false if it is refused.
    fn takes_step(&self) -> bool {
        self.scene.flyer.is_ideal() || self.meter.take(LAGGED_STEP)
    }

    /// Lowers `worst` by the last step of a walk.
    fn along_step(&mut self, walk: &Walk<'_>, floor_m: f64, worst: &mut Certificate) {
        if let Some(node) = walk.last_node() {
            self.along(&node, &walk.state, floor_m, worst);
        }
    }

    /// The turn for leaving the arc of a sweep at a state, radians.
    fn turn_at(&self, state: &MotionState, sweep: &Sweep) -> f64 {
        let flyer = self.scene.flyer;
        let rollout_rad = if flyer.is_ideal() {
            0.0
        } else {
            flyer.rollout_rad(state.bank_rad)
        };
        state.course_rad + rollout_rad - sweep.from.course_rad
    }

    /// Flies along an arc up to a state and lowers `worst` by it; ends early below `floor_m`.
    fn follow(
        &mut self,
        walk: &mut Walk<'_>,
        to: &MotionState,
        floor_m: f64,
        worst: &mut Certificate,
    ) {
        while walk.state.time_s < to.time_s && worst.margin_m >= floor_m {
            if self.limit_met() || !self.takes_step() || !walk.step() {
                return;
            }
            self.along_step(walk, floor_m, worst);
        }
    }

    /// The flight after leaving the arc of a sweep at a state.
    fn tail(
        &mut self,
        state: &MotionState,
        velocity_mps: Vec3,
        sweep: &Sweep,
        before: &Certificate,
        floor_m: f64,
    ) -> Certificate {
        let (low, high) = self.scene.climb_limits_rad;
        let climb_rad = sweep.climb_rad.limited(low, high);
        if self.is_settled(state, climb_rad) {
            return self.straight_on(state, velocity_mps, before, floor_m);
        }
        // The straight flight after a roll-out fails most often, and is one line.
        let flyer = self.scene.flyer;
        if self.is_rough
            && state.climb_rad == climb_rad
            && let Some(places) = flyer.settling(state)
        {
            return self.settles(state, &places, before, floor_m);
        }
        if floor_m > f64::MIN
            && let Some(end) = flyer
                .settled(state, climb_rad)
                .filter(|end| end.time_s < self.scene.horizon_s)
        {
            let straight = self.straight_on(&end, flyer.velocity_mps(&end), before, floor_m);
            if straight.margin_m < floor_m {
                return straight;
            }
        }
        self.rolled_out(state, climb_rad, before, floor_m)
    }

    fn is_settled(&self, state: &MotionState, climb_rad: f64) -> bool {
        self.scene.flyer.is_ideal() && (state.climb_rad - climb_rad).abs() < 1e-9
    }

    /// The additional turn, beyond a state with too small a margin, before a margin of `floor_m` is
    /// possible, radians; infinite if it never is.
    ///
    /// Longer turns have moved the aircraft only so far by the moment of the closest approach ([`Self::least_more_rad`]).
    fn failing(&self, state: &MotionState, tail: &Certificate, sweep: &Sweep, floor_m: f64) -> f64 {
        let flyer = self.scene.flyer;
        let (slack_m, slack_rad) = if self.is_settled(state, sweep.climb_rad) {
            (0.0, 0.0)
        } else {
            // The margin holds for the chords.
            let rollout_rad = if flyer.is_ideal() { 0.0 } else { ROLL_OUT_RAD };
            (2.0 * CHORD_BOW_M, rollout_rad)
        };
        let short_m = floor_m - tail.margin_m - slack_m;
        let turns_away = state.bank_rad * sweep.side.sign() < 0.0;
        if short_m <= 0.0 || turns_away {
            return 0.0;
        }
        let more_rad = self.least_more_rad(short_m, tail.at_s - state.time_s);
        (more_rad * (1.0 - 1e-9) - slack_rad).max(0.0)
    }

    /// A turn of a sweep, shortened within its last step; with bank lag, `None` if neither is certified as flown.
    fn with_less_turn(&mut self, leave: &Leave, last: &LastStep, sweep: &Sweep) -> Option<Leave> {
        let flyer = self.scene.flyer;
        let between_rad = (leave.turn_rad - self.turn_at(&last.from, sweep)).abs();
        let useless_rad = sweep.side.sign() * leave.turn_rad - sweep.from_rad;
        let most = (useless_rad / between_rad.max(f64::MIN_POSITIVE)).limited(0.0, 1.0);
        let less = self.halved(leave, most, |search, share| {
            let part_s = (1.0 - share) * last.lasts_s;
            let (turn_rad, state) = if flyer.is_ideal() {
                let between_rad = leave.turn_rad - search.turn_at(&last.from, sweep);
                (
                    leave.turn_rad - share * between_rad,
                    flyer.advance(&last.from, &last.piece, part_s),
                )
            } else {
                let state = flyer.advance(&last.begin, &last.piece, last.after_s + part_s);
                (search.turn_at(&state, sweep), state)
            };
            let left = Leave {
                turn_rad,
                state,
                ..*leave
            };
            search.evaluated_at(&left, sweep)
        });
        if flyer.is_ideal() {
            return Some(less);
        }
        // Once more, exactly as flown.
        let shorter = (less != *leave).then(|| self.certified(&less, sweep));
        shorter.flatten().or_else(|| self.certified(leave, sweep))
    }

    /// A change of climb, shortened.
    fn with_less_climb(&mut self, leave: &Leave, sweep: &Sweep) -> Leave {
        let beyond_rad = leave.climb_rad - self.scene.original.1;
        let back_rad = libm::copysign(CLIMB_STEP_RAD.min(beyond_rad.abs()), beyond_rad);
        if back_rad == 0.0 {
            return *leave;
        }
        self.halved(leave, 1.0, |search, share| {
            let climb_rad = leave.climb_rad - share * back_rad;
            let left = Leave {
                climb_rad,
                ..*leave
            };
            let sweep = Sweep {
                climb_rad,
                ..*sweep
            };
            if search.scene.flyer.is_ideal() {
                return search.evaluated_at(&left, &sweep);
            }
            let turn_rad = sweep.side.sign() * leave.turn_rad;
            let may_do = search.may_do(&sweep.from, (climb_rad, sweep.side), turn_rad);
            if may_do {
                search.certified(&left, &sweep)
            } else {
                None
            }
        })
    }

    /// The last of a manoeuvre and those with the share of its last step taken back that still do, up to `most`
    /// of it.
    fn halved(
        &mut self,
        leave: &Leave,
        most: f64,
        mut look: impl FnMut(&mut Self, f64) -> Option<Leave>,
    ) -> Leave {
        let mut best = *leave;
        let (mut share, mut width) = (0.0, most);
        while width > FINEST && !self.limit_met() {
            width *= 0.5;
            if let Some(leave) = look(self, share + width) {
                (best, share) = (leave, share + width);
            }
        }
        best
    }

    /// A turn with its margin, if that is enough; `before_m` covers its arc.
    fn evaluated_at(&mut self, leave: &Leave, sweep: &Sweep) -> Option<Leave> {
        let before = Certificate::clear(leave.before_m);
        let velocity_mps = self.scene.flyer.velocity_mps(&leave.state);
        let tail = self.tail(&leave.state, velocity_mps, sweep, &before, sweep.enough_m);
        let is_enough = tail.margin_m >= sweep.enough_m && !self.limit_met();
        is_enough.then_some(Leave {
            margin_m: tail.margin_m,
            ..*leave
        })
    }

    /// The whole manoeuvre of a turn.
    pub(super) fn turns(&self, leave: &Leave, sweep: &Sweep) -> Turns {
        let start = &self.scene.start;
        let Some(first) = sweep.first else {
            return Turns {
                wait_s: sweep.from.time_s,
                turn_rad: leave.turn_rad,
                climb_rad: leave.climb_rad,
                second: None,
            };
        };
        let on_rad = start.course_rad + first.turn_rad;
        let second = SecondTurn {
            after_s: sweep.from.time_s - start.time_s,
            turn_rad: sweep.from.course_rad + leave.turn_rad - on_rad,
            climb_rad: leave.climb_rad,
        };
        Turns {
            second: Some(second),
            ..first
        }
    }

    /// A turn with its margin as a whole manoeuvre, if that is enough.
    pub(super) fn certified(&mut self, leave: &Leave, sweep: &Sweep) -> Option<Leave> {
        let turns = self.turns(leave, sweep);
        let departure = match sweep.first {
            Some(_) => self.scene.start,
            None => sweep.from,
        };
        let margin_m = self.certify(&turns, &departure, sweep.enough_m).proven_m();
        (margin_m >= sweep.enough_m).then_some(Leave { margin_m, ..*leave })
    }

    /// Lowers `worst` by the chord from a node to a state.
    pub(super) fn along(
        &mut self,
        node: &Node,
        to: &MotionState,
        floor_m: f64,
        worst: &mut Certificate,
    ) {
        let flyer = self.scene.flyer;
        if let Some(chord) = Chord::new(node, to.position_m, to.time_s) {
            self.lower(
                &chord.line,
                chord.bow_m,
                floor_m,
                worst,
                |hazard, worst, meter| chord.bound(flyer, hazard, floor_m, worst, meter),
            );
        }
    }

    /// `before` lowered by straight flight.
    pub(super) fn straight_on(
        &mut self,
        state: &MotionState,
        velocity_mps: Vec3,
        before: &Certificate,
        floor_m: f64,
    ) -> Certificate {
        self.evaluated += 1;
        let line = Line {
            from_m: state.position_m,
            velocity_mps,
            at_s: state.time_s,
            duration_s: (self.scene.horizon_s - state.time_s).max(0.0),
        };
        self.on_line(&line, before, floor_m)
    }

    /// `before` lowered by a straight line.
    pub(super) fn on_line(
        &mut self,
        line: &Line,
        before: &Certificate,
        floor_m: f64,
    ) -> Certificate {
        let mut worst = *before;
        self.lower(line, 0.0, floor_m, &mut worst, |hazard, worst, meter| {
            if let Some((least_m, at_s)) = hazard.least_on_line(line, worst.margin_m, meter) {
                (worst.margin_m, worst.at_s) = (least_m, at_s);
            }
        });
        worst
    }

    /// Shows `look` the hazards near a line, the one that decided last first,
    /// until the margin falls below `floor_m`.
    fn lower(
        &mut self,
        line: &Line,
        bow_m: f64,
        floor_m: f64,
        worst: &mut Certificate,
        look: impl Fn(&Hazard, &mut Certificate, &Meter),
    ) {
        let hazards = self.scene.hazards;
        let first = hazards.rows().get(self.culprit);
        if let Some(hazard) = first {
            if !self.meter.take(1) {
                return;
            }
            look(hazard, worst, &self.meter);
            if worst.margin_m < floor_m {
                return;
            }
        }
        let meter = &self.meter;
        hazards.each_close(line, worst.margin_m + bow_m, meter, |hazard| {
            if first.is_some_and(|first| first.index == hazard.index) {
                return true;
            }
            look(hazard, worst, meter);
            let above = worst.margin_m >= floor_m;
            if !above {
                self.culprit = hazard.index as usize;
            }
            above
        });
    }

    /// `before` lowered by the flight after a turn that ends at `state`: roll-out and the rest of the
    /// climb change, then straight.
    fn rolled_out(
        &mut self,
        state: &MotionState,
        climb_rad: f64,
        before: &Certificate,
        floor_m: f64,
    ) -> Certificate {
        let flyer = self.scene.flyer;
        let mut worst = *before;
        let rest = Target {
            course_rad: state.course_rad + flyer.rollout_rad(state.bank_rad),
            climb_rad,
            rate_share: 1.0,
        };
        let state = self.glide(state, &rest, self.scene.horizon_s, floor_m, &mut worst);
        self.straight_on(&state, flyer.velocity_mps(&state), &worst, floor_m)
    }

    /// `before` lowered by a roll-out at a constant climb angle, along the lines between its moments, and by the straight
    /// flight after it: to decimetres.
    fn settles(
        &mut self,
        state: &MotionState,
        places: &[(Vec3, f64, f64)],
        before: &Certificate,
        floor_m: f64,
    ) -> Certificate {
        let flyer = self.scene.flyer;
        let mut worst = *before;
        if let Some((position_m, time_s, _)) = places.last().copied() {
            let end = MotionState {
                time_s,
                position_m,
                course_rad: state.course_rad + flyer.rollout_rad(state.bank_rad),
                ..*state
            };
            worst = self.straight_on(&end, flyer.velocity_mps(&end), before, floor_m);
        }
        let (mut from_m, mut at_s) = (state.position_m, state.time_s);
        for (place_m, until_s, bow_m) in places {
            if worst.margin_m < floor_m || at_s >= self.scene.horizon_s {
                break;
            }
            let duration_s = until_s - at_s;
            let line = Line {
                from_m,
                velocity_mps: (place_m - from_m) / duration_s,
                at_s,
                duration_s,
            };
            self.lower(
                &line,
                *bow_m,
                floor_m,
                &mut worst,
                |hazard, worst, meter| {
                    let below_m = worst.margin_m + bow_m;
                    if let Some((least_m, at_s)) = hazard.least_on_line(&line, below_m, meter) {
                        (worst.margin_m, worst.at_s) = (least_m - bow_m, at_s);
                    }
                },
            );
            (from_m, at_s) = (*place_m, *until_s);
        }
        worst
    }

    /// Flies on under one command up to `until_s` and lowers `worst` by it; ends early below
    /// `floor_m`.
    pub(super) fn fly_until(
        &mut self,
        from: &MotionState,
        target: &Target,
        until_s: f64,
        floor_m: f64,
        worst: &mut Certificate,
    ) -> MotionState {
        let state = self.glide(from, target, until_s, floor_m, worst);
        let left_s = until_s - state.time_s;
        if left_s <= 0.0 {
            return state;
        }
        let flyer = self.scene.flyer;
        let piece = flyer.next_piece(&state, target);
        let end = flyer.advance(&state, &piece, left_s);
        let node = Node {
            acceleration_mps2: 0.0,
            ..Node::on(flyer, &state, &piece, 0.0)
        };
        self.along(&node, &end, floor_m, worst);
        end
    }

    /// Flies on under one command up to `until_s`, or until it is straight, and lowers `worst` by
    /// it. Ends early below `floor_m`.
    pub(super) fn glide(
        &mut self,
        from: &MotionState,
        target: &Target,
        until_s: f64,
        floor_m: f64,
        worst: &mut Certificate,
    ) -> MotionState {
        let flyer = self.scene.flyer;
        let mut state = *from;
        while state.time_s < until_s && worst.margin_m >= floor_m && !self.limit_met() {
            let piece = flyer.next_piece_within(&state, target, until_s - state.time_s);
            if piece.duration_s == f64::INFINITY {
                return state;
            }
            let duration_s = piece.duration_s.min(until_s - state.time_s);
            let count = chords(flyer.acceleration_mps2(&piece), duration_s, MAX_NODES);
            let (begin, mut after_s) = (state, 0.0);
            for left in (0..count).rev() {
                if worst.margin_m < floor_m || !self.meter.take(flyer.piece_work()) {
                    return state;
                }
                let node = Node::on(flyer, &state, &piece, after_s);
                after_s = if left == 0 {
                    duration_s
                } else {
                    duration_s * (count - left) as f64 / count as f64
                };
                let end = flyer.advance(&begin, &piece, after_s);
                self.along(&node, &end, floor_m, worst);
                state = end;
            }
        }
        state
    }
}

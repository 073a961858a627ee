//! One arc, all its tangents: the margins of every turn to one side at one climb target.

use crate::Vec3;
use crate::angle::Side;
use crate::limit::Limit as _;
use crate::maneuver::{
    ArcSteps, CHORD_BOW_M, Certificate, Chord, Hazard, HazardSet as _, Line, MAX_NODES,
    MotionState, Node, Target, whole,
};

use super::Search;

/// Longest step along an arc, radians: it bows from its chord by less than a thousandth of its radius.
pub(super) const LONGEST_STEP_RAD: f64 = 0.1;

/// What it takes to set up a sweep, in line tests.
const SETUP_WORK: usize = 15;

/// Turns to one side at one climb target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sweep {
    /// The aircraft where the turn begins.
    pub from: MotionState,
    /// Lower bound of the separation up to there, metres.
    pub before_m: f64,
    /// To which side.
    pub side: Side,
    /// Climb angle taken up meanwhile, radians.
    pub climb_rad: f64,
    /// Largest turn, radians.
    pub max_turn_rad: f64,
    /// Turns with a margin below this may be shown with any margin below it; the sweep ends where
    /// the arc itself falls below, metres.
    pub floor_m: f64,
}

/// A turn that ends where the arc is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leave {
    /// The turn, radians, left positive.
    pub turn_rad: f64,
    /// Lower bound of the separation of the whole manoeuvre, metres.
    pub margin_m: f64,
    /// The aircraft where it leaves the arc.
    pub state: MotionState,
    /// Lower bound of the separation up to there, metres.
    pub before_m: f64,
}

impl Search<'_> {
    /// Shows `visit` each turn of a sweep in growing order until it returns true.
    pub(super) fn sweep(&mut self, sweep: &Sweep, mut visit: impl FnMut(Leave) -> bool) {
        let scene = self.scene;
        let flyer = scene.flyer;
        let Sweep { from, floor_m, .. } = *sweep;
        let target = Target {
            course_rad: from.course_rad + sweep.side.sign() * sweep.max_turn_rad,
            climb_rad: sweep.climb_rad,
            rate_share: 1.0,
        };
        let (low, high) = scene.climb_limits_rad;
        let climb_rad = sweep.climb_rad.limited(low, high);
        self.count(SETUP_WORK);
        let mut worst = Certificate::clear(sweep.before_m);
        let mut state = from;
        let settled = |s: &MotionState| flyer.is_ideal() && (s.climb_rad - climb_rad).abs() < 1e-9;
        let margin_m = if settled(&state) {
            self.straight_on(&state, flyer.velocity_mps(&state), &worst, floor_m)
        } else {
            self.rolled_out(&state, climb_rad, &worst, floor_m)
        };
        if visit(Leave {
            turn_rad: 0.0,
            margin_m,
            state,
            before_m: worst.margin_m,
        }) {
            return;
        }
        loop {
            let piece = flyer.next_piece(&state, &target);
            if piece.duration_s == f64::INFINITY || self.limit_met() {
                return;
            }
            let acceleration_mps2 = flyer.acceleration_mps2(&piece);
            let longest_s = LONGEST_STEP_RAD / flyer.course_rate_radps();
            // Equal steps but for the last, so that how far a sweep goes does not move its turns.
            let count = whole(piece.duration_s / longest_s, MAX_NODES);
            let begin = state;
            let mut steps = ArcSteps::new(flyer, &begin, &piece, longest_s);
            for step in 1..=count {
                let node = Node {
                    state: *steps.state(),
                    course_rate_radps: piece.course_rate_radps,
                    climb_rate_radps: piece.climb_rate_radps,
                    acceleration_mps2,
                };
                steps.advance();
                let mut velocity_mps = steps.velocity_mps();
                state = *steps.state();
                if step == count {
                    state = flyer.advance(&begin, &piece, piece.duration_s);
                    velocity_mps = flyer.velocity_mps(&state);
                }
                self.along(&node, &state, floor_m, &mut worst);
                if worst.margin_m < floor_m {
                    return;
                }
                let margin_m = if settled(&state) {
                    self.straight_on(&state, velocity_mps, &worst, floor_m)
                } else {
                    self.rolled_out(&state, climb_rad, &worst, floor_m)
                };
                let rollout_rad = flyer.rollout_rad(state.bank_rad);
                if visit(Leave {
                    turn_rad: state.course_rad + rollout_rad - from.course_rad,
                    margin_m,
                    state,
                    before_m: worst.margin_m,
                }) {
                    return;
                }
            }
        }
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
            self.lower(&chord.line, chord.bow_m, floor_m, worst, |hazard, worst| {
                chord.bound(flyer, hazard, floor_m, worst);
            });
        }
    }

    /// Margin when the aircraft flies straight on.
    fn straight_on(
        &mut self,
        state: &MotionState,
        velocity_mps: Vec3,
        before: &Certificate,
        floor_m: f64,
    ) -> f64 {
        self.evaluated += 1;
        let mut worst = *before;
        let line = Line {
            from_m: state.position_m,
            velocity_mps,
            at_s: state.time_s,
            duration_s: (self.scene.horizon_s - state.time_s).max(0.0),
        };
        self.lower(&line, 0.0, floor_m, &mut worst, |hazard, worst| {
            if let Some((least_m, _)) = hazard.least_on_line(&line, worst.margin_m) {
                worst.margin_m = least_m;
            }
        });
        worst.margin_m
    }

    /// Shows `look` the hazards that a line may come close to, the one that decided last first,
    /// until the margin falls below `floor_m`.
    fn lower(
        &mut self,
        line: &Line,
        bow_m: f64,
        floor_m: f64,
        worst: &mut Certificate,
        look: impl Fn(&Hazard, &mut Certificate),
    ) {
        let hazards = self.scene.hazards;
        if let Some(hazard) = hazards.rows().get(self.culprit) {
            look(hazard, worst);
            if worst.margin_m < floor_m {
                self.count(1);
                return;
            }
        }
        self.count(1 + hazards.block_count());
        hazards.each_close(line, worst.margin_m + bow_m, |hazard| {
            look(hazard, worst);
            let above = worst.margin_m >= floor_m;
            if !above {
                self.culprit = hazard.index as usize;
            }
            above
        });
    }

    /// Margin when the turn ends at `state`: roll-out and the rest of the climb change, then
    /// straight.
    fn rolled_out(
        &mut self,
        state: &MotionState,
        climb_rad: f64,
        before: &Certificate,
        floor_m: f64,
    ) -> f64 {
        self.evaluated += 1;
        let flyer = self.scene.flyer;
        let rest = Target {
            course_rad: state.course_rad + flyer.rollout_rad(state.bank_rad),
            climb_rad,
            rate_share: 1.0,
        };
        let mut worst = *before;
        let state = self.glide(state, &rest, self.scene.horizon_s, floor_m, &mut worst);
        self.straight_on(&state, flyer.velocity_mps(&state), &worst, floor_m)
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
            state,
            course_rate_radps: piece.course_rate_radps,
            climb_rate_radps: piece.climb_rate_radps,
            acceleration_mps2: 0.0,
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
            let acceleration_mps2 = flyer.acceleration_mps2(&piece);
            let longest_s = libm::sqrt(8.0 * CHORD_BOW_M / acceleration_mps2);
            let duration_s = piece.duration_s.min(until_s - state.time_s);
            let step_s = duration_s / whole(duration_s / longest_s, MAX_NODES) as f64;
            let node = Node {
                state,
                course_rate_radps: piece.course_rate_radps,
                climb_rate_radps: piece.climb_rate_radps,
                acceleration_mps2,
            };
            let end = flyer.advance(&state, &piece, step_s);
            self.along(&node, &end, floor_m, worst);
            state = end;
        }
        state
    }
}

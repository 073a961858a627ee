//! One arc, all its tangents: the margins of every turn to one side at one climb target.

use crate::angle::Side;
use crate::limit::Limit as _;
use crate::maneuver::{ArcSteps, MAX_NODES, whole};
use crate::maneuver::{
    Certificate, Chord, Hazard, Maneuver, MotionState, Node, Target, certify_all,
};

use super::{ENOUGH_M, Search};

/// Longest step along an arc, seconds; shorter where the arc would bow too far from its chord.
pub(super) const STEP_S_AT_MOST: f64 = 0.2;

/// What it takes to set up a sweep, in line tests.
const SETUP_WORK: u32 = 50;

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
    /// Turns from `from` to `side` while taking up `climb_rad`, and shows `visit` each turn in
    /// growing order, up to `max_turn_rad`, until it returns true.
    ///
    /// `before_m` is the margin so far. Turns whose margin is below `floor_m` may be shown with any
    /// margin below it; the sweep ends where the arc itself falls below.
    #[expect(
        clippy::too_many_arguments,
        reason = "one arc has that many parameters"
    )]
    pub(super) fn sweep(
        &mut self,
        from: &MotionState,
        before_m: f64,
        side: Side,
        climb_rad: f64,
        max_turn_rad: f64,
        floor_m: f64,
        mut visit: impl FnMut(Leave) -> bool,
    ) {
        let scene = self.scene;
        let flyer = scene.flyer;
        let target = Target {
            course_rad: from.course_rad + side.sign() * max_turn_rad,
            climb_rad,
            rate_share: 1.0,
        };
        let climb_rad = climb_rad.limited(scene.climb_limits_rad.0, scene.climb_limits_rad.1);
        self.work = self.work.saturating_add(SETUP_WORK);
        let mut worst = Certificate::clear(before_m);
        let mut state = *from;
        let straight = |s: &MotionState| flyer.is_ideal() && (s.climb_rad - climb_rad).abs() < 1e-9;
        let margin = self.tail(&state, climb_rad, straight(&state), worst.margin_m, floor_m);
        if visit(Leave {
            turn_rad: 0.0,
            margin_m: margin,
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
            let longest_s = STEP_S_AT_MOST.min(libm::sqrt(0.32 / acceleration_mps2));
            let count = whole(piece.duration_s / longest_s, MAX_NODES);
            let mut steps = ArcSteps::new(flyer, &state, &piece, piece.duration_s / count as f64);
            for step in 1..=count {
                let node = Node {
                    state: *steps.state(),
                    course_rate_radps: piece.course_rate_radps,
                    climb_rate_radps: piece.climb_rate_radps,
                    acceleration_mps2,
                };
                steps.advance();
                state = *steps.state();
                if step == count {
                    state = flyer.advance(&node.state, &piece, state.time_s - node.state.time_s);
                    state.bank_rad = piece.bank_end_rad;
                }
                self.along(&node, &state, floor_m, &mut worst);
                if worst.margin_m < floor_m {
                    return;
                }
                let margin = if straight(&state) {
                    self.straight_tail(&state, steps.velocity_mps(), worst.margin_m, floor_m)
                } else {
                    self.tail(&state, climb_rad, false, worst.margin_m, floor_m)
                };
                let turn_rad =
                    state.course_rad + flyer.rollout_rad(state.bank_rad) - from.course_rad;
                let before_m = worst.margin_m;
                if visit(Leave {
                    turn_rad,
                    margin_m: margin,
                    state,
                    before_m,
                }) {
                    return;
                }
            }
        }
    }

    /// Lowers `worst` by the chord from a node to a state, the culprit first.
    fn along(&mut self, node: &Node, to: &MotionState, floor_m: f64, worst: &mut Certificate) {
        let scene = self.scene;
        let Some(chord) = Chord::new(node, to.position_m, to.time_s) else {
            return;
        };
        let look = |hazard: &Hazard, worst: &mut Certificate| {
            chord.bound(scene.flyer, hazard, floor_m, worst);
            worst.margin_m < floor_m
        };
        self.work = self.work.saturating_add(1);
        if let Some(hazard) = scene.hazards.get(self.culprit)
            && look(hazard, worst)
        {
            return;
        }
        for (index, hazard) in scene.hazards.iter().enumerate() {
            if index == self.culprit {
                continue;
            }
            self.work = self.work.saturating_add(1);
            if look(hazard, worst) {
                self.culprit = index;
                return;
            }
        }
    }

    /// Margin when the aircraft flies straight on, not above `before_m`.
    fn straight_tail(
        &mut self,
        state: &MotionState,
        velocity_mps: crate::Vec3,
        before_m: f64,
        floor_m: f64,
    ) -> f64 {
        self.evaluated += 1;
        let scene = self.scene;
        let duration_s = (scene.horizon_s - state.time_s).max(0.0);
        let mut margin = before_m;
        let look = |hazard: &Hazard, margin: &mut f64| {
            if let Some((least, _)) = hazard.least_on_line(
                state.position_m,
                velocity_mps,
                state.time_s,
                duration_s,
                *margin,
            ) {
                *margin = least;
            }
            *margin < floor_m
        };
        self.work = self.work.saturating_add(1);
        if let Some(hazard) = scene.hazards.get(self.culprit)
            && look(hazard, &mut margin)
        {
            return margin;
        }
        for (index, hazard) in scene.hazards.iter().enumerate() {
            if index == self.culprit {
                continue;
            }
            self.work = self.work.saturating_add(1);
            if look(hazard, &mut margin) {
                self.culprit = index;
                return margin;
            }
        }
        margin
    }

    /// Margin when the turn ends at `state`: roll-out and the rest of the climb change, then
    /// straight.
    fn tail(
        &mut self,
        state: &MotionState,
        climb_rad: f64,
        straight: bool,
        before_m: f64,
        floor_m: f64,
    ) -> f64 {
        let scene = self.scene;
        if straight {
            let velocity_mps = scene.flyer.velocity_mps(state);
            return self.straight_tail(state, velocity_mps, before_m, floor_m);
        }
        self.evaluated += 1;
        self.count_work(4);
        let course_rad = state.course_rad + scene.flyer.rollout_rad(state.bank_rad);
        let rest = Maneuver::turn(state.time_s, course_rad, climb_rad);
        self.path.clear();
        self.path.extend(scene.flyer, state, &rest, scene.horizon_s);
        let enough_m = before_m.min(ENOUGH_M);
        certify_all(
            scene.flyer,
            self.path,
            scene.hazards,
            scene.horizon_s,
            floor_m,
            enough_m,
        )
        .margin_m
    }
}

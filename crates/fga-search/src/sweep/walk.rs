//! A walk along an arc, step by step.

use super::{LONGEST_STEP_RAD, Sweep};
use fga_proof::Vec3;
use fga_proof::prediction::{ArcSteps, Flyer, MAX_NODES, MotionState, Node, Piece, Target, whole};

/// A walk along the arc of a sweep, in steps of equal length except the last of each piece, so that
/// the extent of a sweep does not move its turns.
#[derive(Clone, Copy)]
pub(super) struct Walk<'a> {
    flyer: &'a Flyer,
    target: Target,
    pub(super) state: MotionState,
    /// Where the last step began.
    pub(super) before: MotionState,
    piece: Option<WalkPiece>,
}

/// A piece of constant rates and the number of its remaining steps.
#[derive(Clone, Copy)]
pub(super) struct WalkPiece {
    begin: MotionState,
    piece: Piece,
    steps: ArcSteps,
    left: usize,
    count: usize,
    longest_s: f64,
    /// When the last step began, seconds from the beginning of the piece.
    after_s: f64,
}

/// The last step of a walk.
#[derive(Clone, Copy)]
pub(super) struct LastStep {
    /// The aircraft at the start of the step, and at the start of its piece.
    pub(super) from: MotionState,
    pub(super) begin: MotionState,
    pub(super) piece: Piece,
    /// Start of the step, seconds from the beginning of the piece, and its duration.
    pub(super) after_s: f64,
    pub(super) lasts_s: f64,
}

impl<'a> Walk<'a> {
    pub(super) fn new(flyer: &'a Flyer, sweep: &Sweep) -> Self {
        let from = sweep.from;
        Self {
            flyer,
            target: Target {
                course_rad: from.course_rad + sweep.side.sign() * sweep.max_turn_rad,
                climb_rad: sweep.climb_rad,
                rate_share: 1.0,
            },
            state: from,
            before: from,
            piece: None,
        }
    }

    /// Goes one step on; false at the arc's end.
    pub(super) fn step(&mut self) -> bool {
        let at = match &mut self.piece {
            Some(at) if at.left > 0 => at,
            slot => {
                let flyer = self.flyer;
                let piece = flyer.next_piece(&self.state, &self.target);
                if piece.duration_s == f64::INFINITY {
                    return false;
                }
                let longest_s = LONGEST_STEP_RAD / flyer.course_rate_radps();
                let left = whole(piece.duration_s / longest_s, MAX_NODES);
                slot.insert(WalkPiece {
                    begin: self.state,
                    piece,
                    steps: ArcSteps::new(flyer, &self.state, &piece, longest_s),
                    left,
                    count: left,
                    longest_s,
                    after_s: 0.0,
                })
            }
        };
        self.before = self.state;
        at.after_s = at.longest_s * (at.count - at.left) as f64;
        at.left -= 1;
        self.state = if at.left == 0 {
            self.flyer
                .advance(&at.begin, &at.piece, at.piece.duration_s)
        } else if at.piece.is_rolling() {
            let after_s = at.after_s + at.longest_s;
            self.flyer.advance(&at.begin, &at.piece, after_s)
        } else {
            at.steps.advance();
            *at.steps.state()
        };
        true
    }

    /// Velocity now, metres per second.
    pub(super) fn velocity_mps(&self) -> Vec3 {
        match &self.piece {
            Some(at) if at.left > 0 && !at.piece.is_rolling() => at.steps.velocity_mps(),
            _ => self.flyer.velocity_mps(&self.state),
        }
    }

    /// The last step, to end earlier.
    pub(super) fn last_step(&self) -> Option<LastStep> {
        self.piece.map(|at| LastStep {
            from: self.before,
            begin: at.begin,
            piece: at.piece,
            after_s: at.after_s,
            lasts_s: self.state.time_s - self.before.time_s,
        })
    }

    /// The node from which the last step began.
    pub(super) fn last_node(&self) -> Option<Node> {
        self.piece
            .map(|at| Node::on(self.flyer, &self.before, &at.piece, at.after_s))
    }
}

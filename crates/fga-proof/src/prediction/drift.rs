//! How far the flight may be from its prediction: errors of course and bank, carried on from piece to piece (proof.md §6).

use core::f64::consts::FRAC_PI_2;

use crate::limit::{ROUNDED_M, ROUNDED_RAD};
use crate::maneuver::Stage;
use crate::prediction::{Flyer, MotionState, Piece};

/// Largest error of a bank, radians: so much steeper the flight's may be.
const MOST_BANK_RAD: f64 = 0.01;

/// The bounds at a moment of a predicted flight.
pub(super) struct DriftBounds {
    /// Of the difference of the courses once both have the same bank, radians.
    course_rad: f64,
    /// Of the difference of the banks, radians.
    bank_rad: f64,
    /// Change of course until both have the same bank, by its difference.
    per_bank: f64,
    /// The bank that both roll to, and the target of the turn.
    command: Option<(f64, Stage)>,
    /// Of the difference of the places so far, metres.
    place_m: f64,
}

impl DriftBounds {
    pub(super) fn new(flyer: &Flyer, start: &MotionState) -> Self {
        let steepest_rad = start.bank_rad.abs().max(flyer.full_bank_rad()) + MOST_BANK_RAD;
        let per_bank = if flyer.is_ideal() {
            0.0
        } else if steepest_rad < FRAC_PI_2 - MOST_BANK_RAD {
            let steep = libm::tan(steepest_rad);
            flyer.turn_at_45_rad() * (1.0 + steep * steep)
        } else {
            f64::INFINITY
        };
        Self {
            course_rad: 0.0,
            bank_rad: 0.0,
            per_bank,
            command: None,
            place_m: ROUNDED_M,
        }
    }

    /// Carries the errors over a piece that is flown for some seconds.
    pub(super) fn fly(&mut self, flyer: &Flyer, stage: &Stage, piece: &Piece, duration_s: f64) {
        if flyer.is_ideal() {
            return;
        }
        let command = Some((piece.bank_command_rad, *stage));
        if self.command != command {
            self.command = command;
            self.begin(flyer, stage, piece);
        }
        let tau = flyer.bank_time_constant_s();
        let left = libm::exp(-duration_s / tau);
        self.course_rad += piece.course_error_rad;
        let rolls_rad = self.per_bank * self.bank_rad * (1.0 - left);
        self.place_m += piece.remainder_m
            + flyer.airspeed_mps() * (self.course_rad * duration_s + rolls_rad * tau);
        self.bank_rad = self.bank_rad * left + piece.bank_error_rad;
        if piece.ends_turn && duration_s >= piece.duration_s {
            self.course_rad = 0.0;
        }
    }

    /// Counts that the flight may roll to another bank for a while where a command begins.
    fn begin(&mut self, flyer: &Flyer, stage: &Stage, piece: &Piece) {
        self.course_rad += 6.0 * self.per_bank * self.bank_rad;
        let is_level = piece.bank_command_rad == 0.0;
        if is_level || piece.beyond_rad <= self.course_rad {
            let unsure_rad = piece.beyond_rad + self.course_rad;
            let most_rad = flyer.bank_rad(flyer.course_rate_radps() * stage.rate_share);
            if unsure_rad > most_rad * flyer.turn_at_45_rad() {
                self.place_m = f64::INFINITY;
            }
            self.course_rad += unsure_rad;
            self.bank_rad += 2.0 * unsure_rad / flyer.turn_at_45_rad();
        }
        if self.bank_rad > MOST_BANK_RAD {
            self.place_m = f64::INFINITY;
        }
    }

    /// Bound of the distance of the flight from the predicted one up to a horizon, seconds, metres; it goes straight on from a
    /// moment, seconds.
    pub(super) fn remainder_m(&self, flyer: &Flyer, horizon_s: f64, straight_s: f64) -> f64 {
        let rolls_rad = self.per_bank * self.bank_rad * flyer.bank_time_constant_s();
        let straight_rad = self.course_rad * (horizon_s - straight_s).max(0.0);
        let rounded_rad = ROUNDED_RAD * horizon_s.max(straight_s);
        self.place_m + flyer.airspeed_mps() * (straight_rad + rolls_rad + rounded_rad)
    }
}

//! How the bank follows its command: dead time and a first-order lag, fitted by what they predict.

use fga::vehicle::STANDARD_GRAVITY_MPS2;
use fga_formats::flight_log::{FlightLog, SeriesPiece};

use super::figures::{Identified, MARGIN_AHEAD_S, mean, rows_of};
use crate::whole::whole;

/// Longest window, seconds.
pub(super) const WINDOW_S: f64 = 6.0;
const SHORTEST_WINDOW_S: f64 = 2.0;
/// A command that moves by less within half a second does not move, radians (5°).
pub(super) const MOVED_RAD: f64 = 5.0 * core::f64::consts::PI / 180.0;
const MOVING_S: f64 = 0.5;
const LONGEST_DEAD_TIME_S: f64 = 1.5;
const DEAD_TIME_STEP_S: f64 = 0.02;
const TIME_CONSTANTS_S: (f64, f64) = (0.02, 5.0);
const TIME_CONSTANTS: u32 = 80;
/// A fit that leaves more of the bank's movement unexplained is left out: the bank followed something else.
const MOST_UNEXPLAINED: f64 = 0.1;
/// Windows beyond this many are thinned out evenly.
const MOST_WINDOWS: usize = 150;
/// Between two predictions of where the aircraft will be, seconds.
const PREDICTION_STEP_S: f64 = 1.0;

/// What one window gives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub(super) dead_time_s: f64,
    pub(super) time_constant_s: f64,
}

/// What all windows give.
pub(super) struct Fits {
    pub(super) fits: Vec<Fit>,
    pub(super) left_out: usize,
}

/// Rows of a piece, from a movement of the command to the next one.
fn windows(piece: &SeriesPiece, period_s: f64) -> Vec<(usize, usize)> {
    let ahead = rows_of(MOVING_S, period_s);
    let (shortest, longest) = (
        rows_of(SHORTEST_WINDOW_S, period_s),
        rows_of(WINDOW_S, period_s),
    );
    let command = &piece.bank_command_rad;
    let moves = |row: usize| {
        let after = command.get(row + ahead).copied();
        after.is_some_and(|after| (after - command[row]).abs() >= MOVED_RAD)
    };
    let mut begins = Vec::new();
    let mut row = 0;
    while row + shortest < piece.len() {
        if moves(row) {
            // Where the movement begins to show within the half second.
            let still = command[row];
            let begin = (row..row + ahead)
                .find(|at| (command[at + 1] - still).abs() >= 0.2 * MOVED_RAD)
                .unwrap_or(row);
            begins.push(begin);
            row = begin + shortest;
        } else {
            row += 1;
        }
    }
    let ends = begins.iter().skip(1).copied().chain([piece.len()]);
    begins
        .iter()
        .zip(ends)
        .map(|(begin, end)| (*begin, end.min(begin + longest)))
        .filter(|(begin, end)| end - begin >= shortest)
        .collect()
}

/// The command some time before a row, between rows in proportion; the first one before the piece.
fn late(command: &[f64], row: usize, late_rows: f64) -> f64 {
    let rows = whole(late_rows) as usize;
    let part = late_rows - late_rows.floor();
    let newer = command[row.saturating_sub(rows)];
    let older = command[row.saturating_sub(rows + 1)];
    newer + part * (older - newer)
}

/// Squared error of a first-order lag over a window, with the share of the command that is reached at last
/// fitted too: that share is part of the largest bank, not of the lag.
fn error(piece: &SeriesPiece, window: (usize, usize), late_rows: f64, keeps: f64) -> f64 {
    let (begin, end) = window;
    let (mut free, mut forced) = (piece.bank_rad[begin], 0.0);
    let (mut across, mut along, mut square) = (0.0, 0.0, 0.0);
    for row in begin + 1..end {
        let command = late(&piece.bank_command_rad, row - 1, late_rows);
        free *= keeps;
        forced = keeps * forced + (1.0 - keeps) * command;
        let rest = piece.bank_rad[row] - free;
        across += rest * forced;
        along += forced * forced;
        square += rest * rest;
    }
    if along <= 0.0 {
        return square;
    }
    let share = (across / along).clamp(0.7, 1.3);
    square - 2.0 * share * across + share * share * along
}

/// The lag that follows best in one window; `None` where none does.
fn fit(piece: &SeriesPiece, window: (usize, usize), period_s: f64) -> Option<Fit> {
    let (begin, end) = window;
    let banks = &piece.bank_rad[begin..end];
    let middle = mean(banks);
    let moved: f64 = banks
        .iter()
        .map(|bank| (bank - middle) * (bank - middle))
        .sum();
    let mut best: Option<(f64, Fit)> = None;
    let mut dead_time_s = 0.0;
    while dead_time_s <= LONGEST_DEAD_TIME_S {
        for index in 0..TIME_CONSTANTS {
            let (shortest, longest) = TIME_CONSTANTS_S;
            let share = f64::from(index) / f64::from(TIME_CONSTANTS - 1);
            let time_constant_s = shortest * libm::pow(longest / shortest, share);
            let keeps = libm::exp(-period_s / time_constant_s);
            let found = error(piece, window, dead_time_s / period_s, keeps);
            if best.is_none_or(|(least, _)| found < least) {
                let fit = Fit {
                    dead_time_s,
                    time_constant_s,
                };
                best = Some((found, fit));
            }
        }
        dead_time_s += DEAD_TIME_STEP_S;
    }
    best.filter(|(least, _)| *least <= MOST_UNEXPLAINED * moved)
        .map(|(_, fit)| fit)
}

/// The lag of every window in which the command moves.
pub(super) fn fits(log: &FlightLog) -> Fits {
    let all: Vec<(&SeriesPiece, (usize, usize))> = log
        .pieces
        .iter()
        .flat_map(|piece| {
            let of = windows(piece, log.period_s).into_iter();
            of.map(move |window| (piece, window))
        })
        .collect();
    let step = all.len().div_ceil(MOST_WINDOWS).max(1);
    let mut result = Fits {
        fits: Vec::new(),
        left_out: 0,
    };
    for (piece, window) in all.into_iter().step_by(step) {
        match fit(piece, window, log.period_s) {
            Some(fit) => result.fits.push(fit),
            None => result.left_out += 1,
        }
    }
    result
}

/// Horizontal distances between where the aircraft is after some seconds, through the air, and where the
/// figures put it: from its bank, course and climb at a row, by the commands that it gets.
pub(super) fn position_errors_m(log: &FlightLog, figures: &Identified) -> Vec<f64> {
    let period_s = log.period_s;
    let ahead = rows_of(MARGIN_AHEAD_S, period_s);
    let late_rows = figures.dead_time_s.value / period_s;
    let keeps = libm::exp(-period_s / figures.bank_time_constant_s.value.max(1e-3));
    let factor = figures.turn_rate_factor.value;
    let mut errors = Vec::new();
    for piece in &log.pieces {
        let starts =
            (0..piece.len().saturating_sub(ahead)).step_by(rows_of(PREDICTION_STEP_S, period_s));
        for start in starts {
            // The airspeed of the moment is known and is taken to stay, as the avoider takes it.
            let (airspeed, climb) = (piece.airspeed_mps[start], piece.climb_rad[start]);
            let (mut bank, mut course) = (piece.bank_rad[start], piece.course_rad[start]);
            let (mut predicted, mut flown) = ((0.0, 0.0), (0.0, 0.0));
            for row in start..start + ahead {
                let level = airspeed * climb.cos() * period_s;
                predicted.0 += level * course.cos();
                predicted.1 += level * course.sin();
                course += factor * STANDARD_GRAVITY_MPS2 * bank.tan() / (airspeed * climb.cos())
                    * period_s;
                let command = late(&piece.bank_command_rad, row, late_rows);
                bank = keeps * bank + (1.0 - keeps) * command;
                let level = piece.airspeed_mps[row] * piece.climb_rad[row].cos() * period_s;
                flown.0 += level * piece.course_rad[row].cos();
                flown.1 += level * piece.course_rad[row].sin();
            }
            errors.push(libm::hypot(predicted.0 - flown.0, predicted.1 - flown.1));
        }
    }
    errors
}

//! What a flight log says about its aircraft, as figures of a vehicle file.
//!
//! | figure | from what |
//! |---|---|
//! | dead time, bank time constant | the first-order lag that follows best, window by window, where the command moves |
//! | turn-rate factor | course turned over that of the ideal coordinated turn at the flown bank |
//! | largest bank | banks that are held; where none is, means of 3 s |
//! | climb limits and rate | the climb angle, smoothed over a second |
//! | margin | where the aircraft is after 5 s, against where these figures put it |
//!
//! Every figure has an interval: the middle 90 % of what the windows give by themselves. A log shows what was
//! used, not what could be: limits are those of the flight, and never beyond the vehicle's own, which its guidance holds.

mod figures;
mod lag;
mod text;

pub use figures::{FigureEstimate, Identified, MARGIN_AHEAD_S};

use figures::{mean, percentile, rows_of};

use fga::vehicle::STANDARD_GRAVITY_MPS2;
use fga_formats::flight_log::{FlightLog, SeriesPiece};

/// A bank below this turns too little to be measured, radians (5°).
const TURNING_RAD: f64 = 5.0 * core::f64::consts::PI / 180.0;
/// A bank that varies less is held, radians (2.5°).
const HELD_RAD: f64 = 2.5 * core::f64::consts::PI / 180.0;
/// Length of the windows in which turns are measured, seconds.
const TURN_WINDOW_S: f64 = 3.0;
/// Fewer windows in which the command moves say nothing.
const FEWEST_WINDOWS: usize = 4;

/// What turns and straight flight of the windows say.
#[derive(Default)]
struct IdentifiedTurns {
    speeds_mps: Vec<f64>,
    factors: Vec<f64>,
    held_deg: Vec<f64>,
    mean_deg: Vec<f64>,
}

impl IdentifiedTurns {
    fn take(&mut self, piece: &SeriesPiece, period_s: f64) {
        let length = rows_of(TURN_WINDOW_S, period_s);
        let mut begin = 0;
        while begin + length < piece.len() {
            let window = begin..begin + length;
            begin += length;
            let (banks, speeds) = (
                &piece.bank_rad[window.clone()],
                &piece.airspeed_mps[window.clone()],
            );
            self.speeds_mps.push(mean(speeds));
            let middle = mean(banks);
            let spread = banks
                .iter()
                .fold(0.0, |most: f64, bank| most.max((bank - middle).abs()));
            self.mean_deg.push(middle.abs().to_degrees());
            if spread < HELD_RAD {
                self.held_deg.push(middle.abs().to_degrees());
            }
            if middle.abs() < TURNING_RAD {
                continue;
            }
            // The last row's rate leads out of the window.
            let ideal_rad: f64 = banks
                .iter()
                .zip(speeds)
                .zip(&piece.climb_rad[window.clone()])
                .map(|((bank, speed), climb)| {
                    STANDARD_GRAVITY_MPS2 * bank.tan() / (speed * climb.cos()) * period_s
                })
                .sum();
            let turned_rad = piece.course_rad[window.end] - piece.course_rad[window.start];
            self.factors.push(turned_rad / ideal_rad);
        }
    }

    /// The steepest banks that are held; where none is, the steepest means: a guidance loop holds none, and the
    /// aircraft has turned as if it had held the mean.
    fn steepest_deg(&self) -> Vec<f64> {
        let steepest = |banks: &[f64]| -> Vec<f64> {
            let most = banks.iter().copied().fold(0.0, f64::max);
            let near = |bank: &f64| *bank > 0.9 * most && *bank > TURNING_RAD.to_degrees();
            banks.iter().copied().filter(near).collect()
        };
        let held = steepest(&self.held_deg);
        if held.is_empty() {
            return steepest(&self.mean_deg);
        }
        held
    }
}

/// Climb angles, smoothed over a second, and the mean rates of their changes.
#[derive(Default)]
struct ClimbFit {
    smooth_rad: Vec<f64>,
    rates_radps: Vec<f64>,
}

impl ClimbFit {
    fn take(&mut self, piece: &SeriesPiece, period_s: f64) {
        let length = rows_of(1.0, period_s);
        let smooth: Vec<f64> = piece.climb_rad.windows(length).map(mean).collect();
        let rates = smooth
            .iter()
            .zip(smooth.iter().skip(length))
            .step_by(length)
            .map(|(before, after)| {
                let apart_s = length as f64 * period_s;
                (after - before).abs() / apart_s
            });
        self.rates_radps.extend(rates);
        self.smooth_rad.extend(smooth);
    }

    /// The outermost angles to one side, degrees.
    fn limits_deg(&mut self, shares: [f64; 3], within: fn(f64) -> f64) -> Vec<f64> {
        self.smooth_rad.sort_by(f64::total_cmp);
        let of = |share| within(percentile(&self.smooth_rad, share).to_degrees());
        shares.map(of).to_vec()
    }

    /// The rates of the changes that are near the fastest one.
    fn fastest_radps(mut self) -> Vec<f64> {
        self.rates_radps.sort_by(f64::total_cmp);
        let fastest = percentile(&self.rates_radps, 0.995);
        self.rates_radps.retain(|rate| *rate >= 0.5 * fastest);
        self.rates_radps
    }
}

/// What a log says about its aircraft.
///
/// # Errors
/// A log in which the commanded bank hardly moves, the bank does not follow it, or nothing turns, as one
/// sentence.
pub fn identify(log: &FlightLog) -> Result<Identified, String> {
    let period_s = log.period_s;
    let (mut turns, mut climbs) = (IdentifiedTurns::default(), ClimbFit::default());
    for piece in &log.pieces {
        turns.take(piece, period_s);
        climbs.take(piece, period_s);
    }
    let fitted = lag::fits(log);
    let windows = fitted.fits.len();
    if windows < FEWEST_WINDOWS {
        return Err(format!(
            "has {windows} windows of {} s in which the commanded bank moves by {:.0} degrees or more and the bank \
             follows it ({} in which it does not), expected at least {FEWEST_WINDOWS}",
            lag::WINDOW_S,
            lag::MOVED_RAD.to_degrees(),
            fitted.left_out
        ));
    }
    let no_turn = || "has no 3 s with a mean bank above 5 degrees, expected turns".to_owned();
    let steepest_deg = turns.steepest_deg();
    let mut identified = Identified {
        airspeed_mps: FigureEstimate::of(turns.speeds_mps).ok_or_else(no_turn)?,
        max_bank_deg: FigureEstimate::of(steepest_deg).ok_or_else(no_turn)?,
        dead_time_s: FigureEstimate::of(fitted.fits.iter().map(|fit| fit.dead_time_s).collect())
            .unwrap_or_default(),
        bank_time_constant_s: FigureEstimate::of(
            fitted.fits.iter().map(|fit| fit.time_constant_s).collect(),
        )
        .unwrap_or_default(),
        turn_rate_factor: FigureEstimate::of(turns.factors).ok_or_else(no_turn)?,
        climb_min_deg: FigureEstimate::of(
            climbs.limits_deg([0.0, 0.01, 0.02], |angle| angle.min(0.0)),
        )
        .unwrap_or_default(),
        climb_max_deg: FigureEstimate::of(
            climbs.limits_deg([0.98, 0.99, 1.0], |angle| angle.max(0.0)),
        )
        .unwrap_or_default(),
        climb_rate_radps: FigureEstimate::of(climbs.fastest_radps()).unwrap_or_default(),
        position_error_m: FigureEstimate::default(),
        windows,
        windows_left_out: fitted.left_out,
    };
    identified.cap(&log.limits);
    let errors_m = lag::position_errors_m(log, &identified);
    identified.position_error_m = FigureEstimate::of(errors_m).unwrap_or_default();
    Ok(identified)
}

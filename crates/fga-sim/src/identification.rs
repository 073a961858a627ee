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

mod lag;
mod text;

use fga::vehicle::STANDARD_GRAVITY_MPS2;
use fga_formats::flight_log::{FlightLog, Limits, Piece};

/// A bank below this turns too little to be measured, radians (5°).
const TURNING_RAD: f64 = 5.0 * core::f64::consts::PI / 180.0;
/// A bank that varies less is held, radians (2.5°).
const HELD_RAD: f64 = 2.5 * core::f64::consts::PI / 180.0;
/// Length of the windows in which turns are measured, seconds.
const TURN_WINDOW_S: f64 = 3.0;
/// How far ahead the margin looks, seconds: later on the avoider has decided again.
pub const MARGIN_AHEAD_S: f64 = 5.0;
/// Fewer windows in which the command moves say nothing.
const FEWEST_WINDOWS: usize = 4;

/// A figure with its interval: the middle 90 % of what windows of the log give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The median.
    pub value: f64,
    /// 5 % of the windows give less.
    pub low: f64,
    /// 5 % of the windows give more.
    pub high: f64,
}

/// The value below which a share of the sorted values lies, between neighbours in proportion.
fn percentile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    #[expect(clippy::cast_precision_loss, reason = "a number of windows")]
    let place = share * last as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the last place"
    )]
    let below = place.floor() as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    low + (high - low) * (place - place.floor())
}

impl Estimate {
    /// The same within limits.
    fn within(self, low: f64, high: f64) -> Self {
        let limited = |value: f64| value.max(low).min(high);
        Self {
            value: limited(self.value),
            low: limited(self.low),
            high: limited(self.high),
        }
    }

    fn of(mut values: Vec<f64>) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        values.sort_by(f64::total_cmp);
        Some(Self {
            value: percentile(&values, 0.5),
            low: percentile(&values, 0.05),
            high: percentile(&values, 0.95),
        })
    }
}

/// What a log says about its aircraft.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Airspeed.
    pub airspeed_mps: Estimate,
    /// Steepest bank that is held, or mean bank of 3 s where none is held.
    pub max_bank_deg: Estimate,
    /// Time before a command has any effect.
    pub dead_time_s: Estimate,
    /// Time constant of the first-order bank response.
    pub bank_time_constant_s: Estimate,
    /// Course rate over that of the ideal coordinated turn.
    pub turn_rate_factor: Estimate,
    /// Steepest descent.
    pub climb_min_deg: Estimate,
    /// Steepest climb.
    pub climb_max_deg: Estimate,
    /// Rate at which the climb angle changes.
    pub climb_rate_radps: Estimate,
    /// Horizontal distance from where these figures put the aircraft, after [`MARGIN_AHEAD_S`]; `high` is what
    /// becomes the margin.
    pub position_error_m: Estimate,
    /// Windows in which the command moves and the bank follows it.
    pub windows: usize,
    /// Windows in which the command moves and the bank does not follow it, which are left out.
    pub windows_left_out: usize,
}

impl Identified {
    /// Takes the vehicle's own limits as limits of the figures: an avoider cannot ask for more.
    fn cap(&mut self, limits: &Limits) {
        let infinite = f64::INFINITY;
        if let Some(bank_rad) = limits.bank_rad {
            self.max_bank_deg = self.max_bank_deg.within(0.0, bank_rad.to_degrees());
        }
        // Its guidance climbs at a speed: an angle at the airspeed of the flight.
        let airspeed_mps = self.airspeed_mps.value;
        let angle_deg = |speed_mps: Option<f64>| {
            speed_mps.map(|speed_mps| libm::asin((speed_mps / airspeed_mps).min(1.0)).to_degrees())
        };
        let least =
            |a: Option<f64>, b: Option<f64>| a.unwrap_or(infinite).min(b.unwrap_or(infinite));
        let climb_deg = least(
            angle_deg(limits.climb_mps),
            limits.pitch_max_rad.map(f64::to_degrees),
        );
        let sink_deg = least(
            angle_deg(limits.sink_mps),
            limits
                .pitch_min_rad
                .map(|pitch_rad| -pitch_rad.to_degrees()),
        );
        self.climb_max_deg = self.climb_max_deg.within(0.0, climb_deg.max(0.0));
        self.climb_min_deg = self.climb_min_deg.within(-sink_deg.max(0.0), 0.0);
    }
}

/// Rows that last so long.
fn rows_of(seconds: f64, period_s: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few seconds over some hundredths"
    )]
    let rows = (seconds / period_s).round() as usize;
    rows.max(1)
}

fn mean(values: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a number of rows")]
    let count = values.len().max(1) as f64;
    values.iter().sum::<f64>() / count
}

/// What turns and straight flight of the windows say.
#[derive(Default)]
struct Turns {
    speeds_mps: Vec<f64>,
    factors: Vec<f64>,
    held_deg: Vec<f64>,
    mean_deg: Vec<f64>,
}

impl Turns {
    fn take(&mut self, piece: &Piece, period_s: f64) {
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
struct Climbs {
    smooth_rad: Vec<f64>,
    rates_radps: Vec<f64>,
}

impl Climbs {
    fn take(&mut self, piece: &Piece, period_s: f64) {
        let length = rows_of(1.0, period_s);
        let smooth: Vec<f64> = piece.climb_rad.windows(length).map(mean).collect();
        let rates = smooth
            .iter()
            .zip(smooth.iter().skip(length))
            .step_by(length)
            .map(|(before, after)| {
                #[expect(clippy::cast_precision_loss, reason = "a number of rows")]
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
    let (mut turns, mut climbs) = (Turns::default(), Climbs::default());
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
    let level = || Estimate {
        value: 0.0,
        low: 0.0,
        high: 0.0,
    };
    let mut identified = Identified {
        airspeed_mps: Estimate::of(turns.speeds_mps).ok_or_else(no_turn)?,
        max_bank_deg: Estimate::of(steepest_deg).ok_or_else(no_turn)?,
        dead_time_s: Estimate::of(fitted.fits.iter().map(|fit| fit.dead_time_s).collect())
            .unwrap_or_else(level),
        bank_time_constant_s: Estimate::of(
            fitted.fits.iter().map(|fit| fit.time_constant_s).collect(),
        )
        .unwrap_or_else(level),
        turn_rate_factor: Estimate::of(turns.factors).ok_or_else(no_turn)?,
        climb_min_deg: Estimate::of(climbs.limits_deg([0.0, 0.01, 0.02], |angle| angle.min(0.0)))
            .unwrap_or_else(level),
        climb_max_deg: Estimate::of(climbs.limits_deg([0.98, 0.99, 1.0], |angle| angle.max(0.0)))
            .unwrap_or_else(level),
        climb_rate_radps: Estimate::of(climbs.fastest_radps()).unwrap_or_else(level),
        position_error_m: level(),
        windows,
        windows_left_out: fitted.left_out,
    };
    identified.cap(&log.limits);
    let errors_m = lag::position_errors_m(log, &identified);
    identified.position_error_m = Estimate::of(errors_m).unwrap_or_else(level);
    Ok(identified)
}

//! The figures that a log gives.

use fga_formats::flight_log::Limits;

use crate::whole::whole;

/// How far ahead the margin looks, seconds: later on the avoider has decided again.
pub const MARGIN_AHEAD_S: f64 = 5.0;

/// A figure with its interval: the middle 90 % of what windows of the log give.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FigureEstimate {
    /// The median.
    pub value: f64,
    /// 5 % of the windows give less.
    pub low: f64,
    /// 5 % of the windows give more.
    pub high: f64,
}

/// The value below which a share of the sorted values lies, between neighbours in proportion.
pub(super) fn percentile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share * last as f64;
    let below = whole(place) as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    low + (high - low) * (place - place.floor())
}

impl FigureEstimate {
    /// The same within limits.
    pub(super) fn within(self, low: f64, high: f64) -> Self {
        let limited = |value: f64| value.max(low).min(high);
        Self {
            value: limited(self.value),
            low: limited(self.low),
            high: limited(self.high),
        }
    }

    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
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
    pub airspeed_mps: FigureEstimate,
    /// Steepest bank that is held, or mean bank of 3 s where none is held.
    pub max_bank_deg: FigureEstimate,
    /// Time before a command has any effect.
    pub dead_time_s: FigureEstimate,
    /// Time constant of the first-order bank response.
    pub bank_time_constant_s: FigureEstimate,
    /// Course rate over that of the ideal coordinated turn.
    pub turn_rate_factor: FigureEstimate,
    /// Steepest descent.
    pub climb_min_deg: FigureEstimate,
    /// Steepest climb.
    pub climb_max_deg: FigureEstimate,
    /// Rate at which the climb angle changes.
    pub climb_rate_radps: FigureEstimate,
    /// Horizontal distance from where these figures put the aircraft, after [`MARGIN_AHEAD_S`]; `high` is what
    /// becomes the margin.
    pub position_error_m: FigureEstimate,
    /// Windows in which the command moves and the bank follows it.
    pub windows: usize,
    /// Windows in which the command moves and the bank does not follow it, which are left out.
    pub windows_left_out: usize,
}

impl Identified {
    /// Takes the vehicle's own limits as limits of the figures: an avoider cannot ask for more.
    pub(super) fn cap(&mut self, limits: &Limits) {
        if let Some(bank_rad) = limits.bank_rad {
            self.max_bank_deg = self.max_bank_deg.within(0.0, bank_rad.to_degrees());
        }
        // Its guidance climbs at a speed: an angle at the airspeed of the flight.
        let airspeed_mps = self.airspeed_mps.value;
        let angle_deg = |speed_mps: Option<f64>| {
            speed_mps.map(|speed_mps| libm::asin((speed_mps / airspeed_mps).min(1.0)).to_degrees())
        };
        let least = |speed_mps: Option<f64>, pitch_rad: Option<f64>| {
            let angles = angle_deg(speed_mps).into_iter();
            angles
                .chain(pitch_rad.map(f64::to_degrees))
                .fold(f64::INFINITY, f64::min)
        };
        let climb_deg = least(limits.climb_mps, limits.pitch_max_rad);
        let sink_deg = least(
            limits.sink_mps,
            limits.pitch_min_rad.map(|pitch_rad| -pitch_rad),
        );
        self.climb_max_deg = self.climb_max_deg.within(0.0, climb_deg.max(0.0));
        self.climb_min_deg = self.climb_min_deg.within(-sink_deg.max(0.0), 0.0);
    }
}

/// Rows that last so long.
pub(super) fn rows_of(seconds: f64, period_s: f64) -> usize {
    whole((seconds / period_s).round()).max(1) as usize
}

pub(super) fn mean(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    values.iter().sum::<f64>() / count
}

//! Axes: from data to pixels, and the round numbers to mark.

/// A linear or logarithmic map from data to pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    low: f64,
    high: f64,
    at_low: f64,
    at_high: f64,
}

impl Scale {
    /// Maps `low..high` to the pixels `at_low..at_high`; widens an empty range.
    pub(crate) fn new(low: f64, high: f64, at_low: f64, at_high: f64) -> Self {
        let (low, high) = if high > low {
            (low, high)
        } else {
            (low - 0.5, low + 0.5)
        };
        Self {
            low,
            high,
            at_low,
            at_high,
        }
    }

    pub(crate) fn low(&self) -> f64 {
        self.low
    }

    pub(crate) fn high(&self) -> f64 {
        self.high
    }

    pub(crate) fn at(&self, value: f64) -> f64 {
        self.at_low + (value - self.low) / (self.high - self.low) * (self.at_high - self.at_low)
    }
}

/// The largest of 1, 2, 5 × 10ⁿ that is at most `length` (1 unless `length` is positive).
pub(crate) fn round_down(length: f64) -> f64 {
    if !(length.is_finite() && length > 0.0) {
        return 1.0;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(length) + 1e-9));
    let lead = length / power;
    let step = if lead >= 5.0 - 1e-9 {
        5.0
    } else if lead >= 2.0 - 1e-9 {
        2.0
    } else {
        1.0
    };
    step * power
}

/// A round step that puts at most about `most` marks on a span.
pub(crate) fn step(span: f64, most: f64) -> f64 {
    let least = span / most;
    let below = round_down(least);
    for factor in [1.0, 2.0, 2.5, 5.0, 10.0] {
        let candidate = round_down(below * factor);
        if candidate >= least * (1.0 - 1e-9) {
            return candidate;
        }
    }
    below * 10.0
}

/// A round step of time: above ten seconds a clock's.
pub(crate) fn time_step(span_s: f64, most: f64) -> f64 {
    let least = span_s / most;
    [
        0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 1800.0,
        3600.0, 7200.0,
    ]
    .into_iter()
    .find(|step| *step >= least)
    .unwrap_or_else(|| step(span_s, most))
}

/// The multiples of `step` within `low..=high`.
pub(crate) fn marks(low: f64, high: f64, step: f64) -> Vec<f64> {
    if !(step > 0.0 && low.is_finite() && high.is_finite()) || (high - low) / step > 1000.0 {
        return Vec::new();
    }
    let mut index = libm::ceil(low / step - 1e-9);
    let mut values = Vec::new();
    while index * step <= high + step * 1e-9 {
        values.push(index * step);
        index += 1.0;
    }
    values
}

/// The text of a mark, with as many decimals as the step needs and a true minus sign.
pub(crate) fn mark_text(value: f64, step: f64) -> String {
    let decimals = if step >= 1.0 {
        0
    } else {
        // A step below one is a negative power of ten times 1, 2 or 5: at most a few decimals.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 9"
        )]
        let decimals = libm::ceil(-libm::log10(step) - 1e-9).clamp(0.0, 9.0) as usize;
        decimals
    };
    let text = format!("{value:.decimals$}");
    if let Some(rest) = text.strip_prefix('-') {
        if rest.chars().all(|c| c == '0' || c == '.') {
            rest.to_owned()
        } else {
            format!("−{rest}")
        }
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        assert_eq!(round_down(300.0), 200.0);
        assert_eq!(round_down(1000.0), 1000.0);
        assert_eq!(round_down(0.07), 0.05);
        assert_eq!(step(100.0, 5.0), 20.0);
        assert_eq!(step(95.0, 4.0), 50.0);
        assert_eq!(time_step(600.0, 10.0), 60.0);
    }

    #[test]
    fn marks_cover_the_range() {
        assert_eq!(marks(-5.0, 21.0, 10.0), vec![0.0, 10.0, 20.0]);
        assert_eq!(mark_text(-10.0, 10.0), "−10");
        assert_eq!(mark_text(-0.0, 0.5), "0.0");
        assert_eq!(mark_text(0.25, 0.05), "0.25");
    }
}

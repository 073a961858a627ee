//! A measured value with its interval.

/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_963_984_540_054;

/// A value between the ends of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value itself.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Estimate {
    /// A value known exactly.
    pub const fn exact(value: f64) -> Self {
        Self {
            value,
            low: value,
            high: value,
        }
    }

    /// The share `successes / trials` with Wilson's score interval at 95 %; `None` without trials
    /// or with more successes than trials.
    ///
    /// E. B. Wilson, Probable inference, the law of succession, and statistical inference,
    /// JASA 22 (1927).
    ///
    /// # Examples
    ///
    /// ```
    /// use fga_report::interval::Estimate;
    ///
    /// let share = Estimate::wilson(300, 300).unwrap();
    /// assert_eq!((share.value, share.high), (1.0, 1.0));
    /// assert!((share.low - 0.9874).abs() < 5e-5);
    /// ```
    pub fn wilson(successes: u64, trials: u64) -> Option<Self> {
        if trials == 0 || successes > trials {
            return None;
        }
        let n = trials as f64;
        let share = successes as f64 / n;
        let z2 = Z95 * Z95;
        let centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let half =
            Z95 / (1.0 + z2 / n) * libm::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
        Some(Self {
            value: share,
            // Rounding may not push an end past the value it holds.
            low: (centre - half).clamp(0.0, share),
            high: (centre + half).clamp(share, 1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_agrees_with_a_statistics_package() {
        // R 4: binom.confint(8, 10, methods = "wilson") and binom.confint(0, 20, …).
        let eight = Estimate::wilson(8, 10).unwrap();
        assert!((eight.low - 0.490_162_5).abs() < 1e-6);
        assert!((eight.high - 0.943_317_8).abs() < 1e-6);
        let none = Estimate::wilson(0, 20).unwrap();
        assert_eq!(none.low, 0.0);
        assert!((none.high - 0.161_125_2).abs() < 1e-6);
        assert_eq!(Estimate::wilson(0, 0), None);
        assert_eq!(Estimate::wilson(2, 1), None);
    }
}

//! A measured value with its interval.

/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_963_984_540_054;

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
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
            // Rounding must not push an end past the value.
            low: (centre - half).clamp(0.0, share),
            high: (centre + half).clamp(share, 1.0),
        })
    }

    /// The mean of the values with its 95 % interval by the normal approximation; `None` for
    /// fewer than two values or a value that is not finite.
    ///
    /// # Examples
    ///
    /// ```
    /// use fga_report::interval::Estimate;
    ///
    /// let mean = Estimate::mean(&[1.0, 2.0, 3.0]).unwrap();
    /// assert_eq!(mean.value, 2.0);
    /// // The standard error is 1/√3.
    /// assert!((mean.high - 2.0 - 1.959964 / 3.0_f64.sqrt()).abs() < 1e-6);
    /// ```
    pub fn mean(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        if values.len() < 2 || values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let half = Z95 * libm::sqrt(squares / (n - 1.0) / n);
        Some(Self {
            value: mean,
            low: mean - half,
            high: mean + half,
        })
    }

    /// Σ a / Σ b over pairs (a, b) with its 95 % interval by the delta method; `None` for fewer
    /// than two pairs, a pair that is not finite, or Σ b ≤ 0.
    ///
    /// W. G. Cochran, Sampling Techniques (1977), §6.4.
    pub fn ratio(pairs: &[(f64, f64)]) -> Option<Self> {
        let (a, b) = pairs
            .iter()
            .fold((0.0, 0.0), |(a, b), pair| (a + pair.0, b + pair.1));
        let ratio = a / b;
        if b <= 0.0 {
            return None;
        }
        // The ratio is as uncertain as the mean of the residuals a − R b over the mean of b.
        let residuals: Vec<f64> = pairs.iter().map(|(a, b)| a - ratio * b).collect();
        let mean = Self::mean(&residuals)?;
        let half = (mean.high - mean.value) * pairs.len() as f64 / b;
        Some(Self {
            value: ratio,
            low: ratio - half,
            high: ratio + half,
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

    #[test]
    fn a_ratio_with_its_interval_by_hand() {
        // R = 6/12; residuals 1 − 1 = 0, 2 − 3 = −1, 3 − 2 = 1: s = 1, over √3, over b̄ = 4.
        let ratio = Estimate::ratio(&[(1.0, 2.0), (2.0, 6.0), (3.0, 4.0)]).unwrap();
        assert!((ratio.value - 0.5).abs() < 1e-12);
        assert!((ratio.high - 0.5 - Z95 / 3.0_f64.sqrt() / 4.0).abs() < 1e-12);
        assert_eq!(Estimate::ratio(&[(1.0, 2.0)]), None);
        assert_eq!(Estimate::ratio(&[(1.0, 0.0), (1.0, 0.0)]), None);
        assert_eq!(Estimate::mean(&[1.0, f64::NAN]), None);
    }
}

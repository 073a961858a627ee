//! Axes.

/// One axis of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its quantity and unit, such as `"initial distance (m)"`.
    pub label: String,
    /// Equal steps, or equal ratios.
    pub spacing: Spacing,
    /// Ends of the axis; without them it spans the data with round ends.
    pub range: Option<(f64, f64)>,
}

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spacing {
    /// Equal lengths for equal differences.
    #[default]
    Linear,
    /// Equal lengths for equal ratios; omits values that are not positive.
    Log,
    /// Linear for shares between 0 and 1, marked in per cent.
    Percent,
}

impl Axis {
    /// A linear axis that spans its data.
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            spacing: Spacing::Linear,
            range: None,
        }
    }

    /// A logarithmic axis that spans its data.
    pub fn log(label: &str) -> Self {
        Self {
            spacing: Spacing::Log,
            ..Self::linear(label)
        }
    }

    /// Shares from 0 to 1, marked from 0 to 100 %.
    pub fn percent(label: &str) -> Self {
        Self {
            spacing: Spacing::Percent,
            range: Some((0.0, 1.0)),
            ..Self::linear(label)
        }
    }
}

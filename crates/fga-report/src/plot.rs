//! Plots of campaigns: lines with bands, grouped bars, distributions, decision times.
//!
//! Each chart is a plain struct with a `to_svg`. It omits values that are not finite, and says so when
//! it has no data. Series differ by colour and by mark, so that print without colour is enough.
//! Intervals show as bands or whiskers.

mod axis;
mod bars;
mod boxes;
mod distribution;
mod frame;
mod lines;

pub use axis::{Axis, Spacing};
pub use bars::{BarChart, BarSeries};
pub use boxes::{BoxChart, BoxSpread, SpreadRow};
pub use distribution::{Cdf, Histogram, SampleSeries};
pub use lines::{Claim, LineChart, LinePoint, PlotLine};

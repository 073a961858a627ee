//! Distributions: cumulative shares and histograms.

use super::frame::{HEIGHT, PlotFrame, Ruler, colour, draw_limits, line_look};
use super::{Axis, Spacing};
use crate::svg::{Point, Rect, Svg};

/// A named sample.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleSeries {
    /// Name in the legend.
    pub name: String,
    /// The values in any order; those that are not finite do not count.
    pub values: Vec<f64>,
}

impl SampleSeries {
    fn sorted(&self) -> Vec<f64> {
        let mut values: Vec<f64> = self
            .values
            .iter()
            .copied()
            .filter(|v| v.is_finite())
            .collect();
        values.sort_by(f64::total_cmp);
        values
    }
}

/// The picture of some samples with its frame, the samples sorted, and the scale along x.
fn begin(
    title: &str,
    series: &[SampleSeries],
    x: &Axis,
    limits: &[(f64, String)],
) -> (Svg, PlotFrame, Vec<Vec<f64>>, Ruler) {
    let (svg, frame) = PlotFrame::begin(title, &names(series), 74.0, HEIGHT);
    let sorted: Vec<Vec<f64>> = series.iter().map(SampleSeries::sorted).collect();
    let ends = sorted
        .iter()
        .flat_map(|v| v.first().into_iter().chain(v.last()).copied());
    let x = frame.x(x, ends.chain(limits.iter().map(|l| l.0)));
    (svg, frame, sorted, x)
}

fn names(series: &[SampleSeries]) -> Vec<&str> {
    series.iter().map(|s| s.name.as_str()).collect()
}

/// Cumulative shares: the part of each sample that is at most x.
#[derive(Debug, Clone, PartialEq)]
pub struct Cdf {
    /// Heading.
    pub title: String,
    /// The measured quantity.
    pub x: Axis,
    /// The samples.
    pub series: Vec<SampleSeries>,
    /// Vertical lines along x, with their names: `(30.0, "protected radius")`.
    pub limits: Vec<(f64, String)>,
}

impl Cdf {
    /// Draws the chart.
    pub fn to_svg(&self) -> String {
        let (mut svg, frame, sorted, x) = begin(&self.title, &self.series, &self.x, &self.limits);
        let axis = Axis::percent("cumulative share (%)");
        let y = frame.y(&axis, [0.0, 1.0].into_iter());
        frame.draw_x(&mut svg, &self.x, &x);
        frame.draw_y(&mut svg, &axis, &y);
        let area = frame.area;
        draw_limits(&mut svg, &area, &x, &self.limits);
        svg.begin_clip(&area);
        for (series, values) in sorted.iter().enumerate() {
            // Single steps of more values than pixels are invisible.
            let stride = (values.len() / 4000).max(1);
            let mut way: Vec<Point> = Vec::new();
            for (index, value) in values.iter().enumerate() {
                if index % stride != 0 && index + 1 != values.len() {
                    continue;
                }
                let (Some(px), Some(before), Some(after)) = (
                    x.at(*value),
                    y.at(index as f64 / values.len() as f64),
                    y.at((index + 1) as f64 / values.len() as f64),
                ) else {
                    continue;
                };
                if way.is_empty() {
                    way.push((area.x, before));
                }
                way.push((px, before));
                way.push((px, after));
            }
            way.push((area.right(), area.y));
            svg.polyline(&way, &line_look(series));
        }
        svg.end_clip();
        let empty = sorted.iter().all(Vec::is_empty);
        frame.finish(svg, &names(&self.series), empty, |svg, at, series| {
            svg.line((at.0 - 13.0, at.1), (at.0 + 13.0, at.1), &line_look(series));
        })
    }
}

/// Counts in equal bins, as shares of each sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Heading.
    pub title: String,
    /// The measured quantity; its range, if given, bounds the bins.
    pub x: Axis,
    /// Number of bins, at least 1.
    pub bins: usize,
    /// The samples.
    pub series: Vec<SampleSeries>,
    /// Vertical lines along x, with their names.
    pub limits: Vec<(f64, String)>,
}

impl Histogram {
    /// Draws the chart; values beyond the axis' range count for the share but belong to no bin.
    pub fn to_svg(&self) -> String {
        let (mut svg, frame, sorted, x) = begin(&self.title, &self.series, &self.x, &self.limits);
        let area = frame.area;
        let bins = self.bins.clamp(1, 400);
        let shares: Vec<Vec<f64>> = sorted
            .iter()
            .map(|values| {
                let mut shares = vec![0.0; bins];
                for value in values {
                    let Some(px) = x.at(*value) else { continue };
                    let place = (px - area.x) / area.width * bins as f64;
                    // The upper end belongs to the last bin.
                    let place = if place == bins as f64 {
                        place - 0.5
                    } else {
                        place
                    };
                    if place >= 0.0 && place < bins as f64 {
                        #[expect(
                            clippy::cast_possible_truncation,
                            clippy::cast_sign_loss,
                            reason = "within the bins"
                        )]
                        let bin = place as usize;
                        shares[bin] += 1.0 / values.len() as f64;
                    }
                }
                shares
            })
            .collect();
        let axis = Axis {
            label: "share of the sample (%)".to_owned(),
            spacing: Spacing::Percent,
            range: None,
        };
        let y = frame.y(&axis, shares.iter().flatten().copied().chain([0.0]));
        frame.draw_x(&mut svg, &self.x, &x);
        frame.draw_y(&mut svg, &axis, &y);
        let bin_width = area.width / bins as f64;
        for (series, shares) in shares.iter().enumerate() {
            let mut outline: Vec<Point> = vec![(area.x, area.bottom())];
            for (bin, share) in shares.iter().enumerate() {
                let top = y.at(*share).unwrap_or(area.bottom());
                let left = area.x + bin_width * bin as f64;
                outline.push((left, top));
                outline.push((left + bin_width, top));
            }
            outline.push((area.right(), area.bottom()));
            let fill = format!("fill=\"{}\" fill-opacity=\"0.22\"", colour(series));
            svg.polygon(&outline, &fill);
            svg.polyline(&outline, &line_look(series));
        }
        draw_limits(&mut svg, &area, &x, &self.limits);
        let empty = sorted.iter().all(Vec::is_empty);
        frame.finish(svg, &names(&self.series), empty, |svg, at, series| {
            let look = format!(
                "fill=\"{0}\" fill-opacity=\"0.22\" stroke=\"{0}\" stroke-width=\"1.6\"",
                colour(series)
            );
            svg.rect(&Rect::new(at.0 - 8.0, at.1 - 6.0, 16.0, 12.0), &look);
        })
    }
}

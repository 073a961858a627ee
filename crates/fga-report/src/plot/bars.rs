//! Grouped bars with whiskers for their intervals.

use super::Axis;
use super::frame::{HEIGHT, PlotFrame, colour};
use crate::interval::Estimate;
use crate::palette::MUTED;
use crate::svg::{Anchor, Rect, TextStyle, shorten, text_width};

/// One series of bars.
#[derive(Debug, Clone, PartialEq)]
pub struct BarSeries {
    /// Name in the legend.
    pub name: String,
    /// One value for each group; `None` leaves a gap.
    pub values: Vec<Option<Estimate>>,
}

/// Groups of bars side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct BarChart {
    /// Heading.
    pub title: String,
    /// The kind of group, below the chart.
    pub groups_label: String,
    /// Name of each group.
    pub groups: Vec<String>,
    /// The value axis; bars stand on its lower end.
    pub y: Axis,
    /// The series.
    pub series: Vec<BarSeries>,
}

impl BarChart {
    /// Draws the chart.
    pub fn to_svg(&self) -> String {
        let names: Vec<&str> = self.series.iter().map(|s| s.name.as_str()).collect();
        let (mut svg, frame) = PlotFrame::begin(&self.title, &names, 74.0, HEIGHT);
        let values = || {
            self.series
                .iter()
                .flat_map(|s| s.values.iter().flatten())
                .filter(|e| e.value.is_finite())
        };
        let y = frame.y(
            &self.y,
            values().flat_map(|e| [0.0, e.low, e.value, e.high]),
        );
        frame.draw_y(&mut svg, &self.y, &y);
        let area = frame.area;
        let group_width = area.width / self.groups.len().max(1) as f64;
        let bar = (group_width * 0.8 / self.series.len().max(1) as f64).min(60.0);
        let all = bar * self.series.len() as f64;
        for (group, name) in self.groups.iter().enumerate() {
            let centre = area.x + group_width * (group as f64 + 0.5);
            let mut size = 12.0;
            let name = shorten(name, 26);
            while size > 8.5 && text_width(&name, size) > group_width - 4.0 {
                size -= 0.5;
            }
            svg.text(
                (centre, area.bottom() + 17.0),
                &name,
                TextStyle::new(size, MUTED).anchor(Anchor::Middle),
            );
            for (series, values) in self.series.iter().enumerate() {
                let Some(Some(estimate)) = values.values.get(group) else {
                    continue;
                };
                let Some(top) = y.at(estimate.value) else {
                    continue;
                };
                let top = top.clamp(area.y, area.bottom());
                let x = centre - all / 2.0 + bar * series as f64;
                svg.rect(
                    &Rect::new(x + bar * 0.06, top, bar * 0.88, area.bottom() - top),
                    &format!("fill=\"{}\" fill-opacity=\"0.85\"", colour(series)),
                );
                if let (Some(low), Some(high)) = (y.at(estimate.low), y.at(estimate.high))
                    && estimate.high > estimate.low
                {
                    let (low, high) = (
                        low.clamp(area.y, area.bottom()),
                        high.clamp(area.y, area.bottom()),
                    );
                    let look = "fill=\"none\" stroke=\"#1f2328\" stroke-width=\"1.3\"";
                    let middle = x + bar / 2.0;
                    let cap = (bar * 0.2).min(6.0);
                    svg.line((middle, low), (middle, high), look);
                    svg.line((middle - cap, low), (middle + cap, low), look);
                    svg.line((middle - cap, high), (middle + cap, high), look);
                }
            }
        }
        frame.title_below(&mut svg, &self.groups_label);
        let empty = values().next().is_none();
        frame.finish(svg, &names, empty, |svg, at, series| {
            let look = format!("fill=\"{}\" fill-opacity=\"0.85\"", colour(series));
            svg.rect(&Rect::new(at.0 - 7.0, at.1 - 6.0, 14.0, 12.0), &look);
        })
    }
}

//! Lines with bands of intervals, and claims to compare them with.

use super::Axis;
use super::frame::{HEIGHT, PlotFrame, colour, draw_mark, line_look};
use crate::interval::Estimate;
use crate::label::Labels;
use crate::palette::INK;
use crate::svg::{Point, Svg, TextStyle};

/// Most lines whose bands are filled.
const MOST_FILLED: usize = 2;

/// A value of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePoint {
    /// Position along the x axis.
    pub x: f64,
    /// Value with its interval, drawn as a band.
    pub y: Estimate,
}

/// One series.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotLine {
    /// Name in the legend.
    pub name: String,
    /// Its values, in order of x.
    pub points: Vec<LinePoint>,
}

/// A claimed value, drawn as a labelled bar to compare with.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// The claim, short: `"paper: about 95 %"`.
    pub label: String,
    /// Start of its part of the x axis.
    pub from: f64,
    /// End of that part.
    pub to: f64,
    /// The claimed value.
    pub y: f64,
}

/// A chart of lines over a common x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct LineChart {
    /// Heading.
    pub title: String,
    /// The axis along the bottom.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series.
    pub lines: Vec<PlotLine>,
    /// Claimed values.
    pub claims: Vec<Claim>,
}

impl LineChart {
    /// Draws the chart.
    pub fn to_svg(&self) -> String {
        let names: Vec<&str> = self.lines.iter().map(|l| l.name.as_str()).collect();
        let (mut svg, frame) = PlotFrame::begin(&self.title, &names, 74.0, HEIGHT);
        let points = || self.lines.iter().flat_map(|l| &l.points);
        let claimed = self.claims.iter().flat_map(|c| [c.from, c.to]);
        let x = frame.x(&self.x, points().map(|p| p.x).chain(claimed));
        let bounds = points().flat_map(|p| [p.y.low, p.y.value, p.y.high]);
        let y = frame.y(&self.y, bounds.chain(self.claims.iter().map(|c| c.y)));
        frame.draw_x(&mut svg, &self.x, &x);
        frame.draw_y(&mut svg, &self.y, &y);
        let at = |px: f64, py: f64| -> Option<Point> { Some((x.at(px)?, y.at(py)?)) };
        let mut labels = Labels::new(frame.area.grown(-3.0));
        // Marks on the edge of the area stay whole.
        svg.begin_clip(&frame.area.grown(7.0));
        for (series, line) in self.lines.iter().enumerate() {
            let edge = |pick: fn(&Estimate) -> f64| {
                line.points
                    .iter()
                    .filter_map(move |p| at(p.x, pick(&p.y)))
                    .collect::<Vec<Point>>()
            };
            let mut band = edge(|e| e.high);
            if self.lines.len() > MOST_FILLED {
                // Many bands over each other mix to brown: their edges stay apart.
                let look = format!(
                    "fill=\"none\" stroke=\"{}\" stroke-width=\"1\" stroke-dasharray=\"2 3\"",
                    colour(series)
                );
                svg.polyline(&band, &look);
                svg.polyline(&edge(|e| e.low), &look);
                continue;
            }
            band.extend(edge(|e| e.low).into_iter().rev());
            if band.len() > 2 {
                let look = format!("fill=\"{}\" fill-opacity=\"0.16\"", colour(series));
                svg.polygon(&band, &look);
            }
        }
        for claim in &self.claims {
            if let (Some(from), Some(to)) = (at(claim.from, claim.y), at(claim.to, claim.y)) {
                // A claim about a single value stays visible.
                let wide = if to.0 - from.0 < 12.0 { 8.0 } else { 0.0 };
                svg.line(
                    (from.0 - wide, from.1),
                    (to.0 + wide, to.1),
                    "stroke=\"#1f2328\" stroke-width=\"4\" stroke-opacity=\"0.55\" stroke-dasharray=\"5 2\"",
                );
            }
        }
        for (series, line) in self.lines.iter().enumerate() {
            let way: Vec<Point> = line
                .points
                .iter()
                .filter_map(|p| at(p.x, p.y.value))
                .collect();
            svg.polyline(&way, &line_look(series));
            labels.avoid_line(&way);
            if way.len() <= 40 {
                for point in way {
                    draw_mark(&mut svg, point, series);
                }
            }
        }
        for claim in &self.claims {
            if let Some(middle) = at(f64::midpoint(claim.from, claim.to), claim.y) {
                let style = TextStyle::new(11.5, INK).halo();
                labels.place(&mut svg, middle, 6.0, &claim.label, style);
            }
        }
        svg.end_clip();
        let empty = points().next().is_none();
        frame.finish(svg, &names, empty, symbol)
    }
}

/// A legend's symbol of a line.
pub(super) fn symbol(svg: &mut Svg, at: Point, series: usize) {
    svg.line((at.0 - 13.0, at.1), (at.0 + 13.0, at.1), &line_look(series));
    draw_mark(svg, at, series);
}

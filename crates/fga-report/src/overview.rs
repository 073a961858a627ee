//! One run in one picture: top view, altitude profile, separation over time.
//!
//! [`Overview`] holds the data, in the local frame (x east, y north, z up; metres, seconds);
//! [`Overview::to_svg`] draws it. The picture omits samples that are not finite and escapes names.
//! A run of any size gives a picture: the closest of many obstacles have a name and a curve, the
//! others are faint.

mod altitude;
mod data;
mod look;
mod panel;
mod separation;
mod top;

pub use data::{
    ClosestApproach, MomentKind, Overview, OverviewMoment, OverviewObstacle, OverviewPoint,
    PathSample,
};

pub(crate) use look::{FRAME, GRID_LINE, axis_titles};

use crate::palette::{INK, MUTED, VERMILION};
use crate::svg::{Point, Rect, Svg, TextStyle, shorten, text_width};
use data::Focus;
use fga::avoider::State;
use look::{MISSION, Shape, TICK, VOLUME, marker, state_colour, state_look};

const WIDTH: f64 = 1160.0;
const MARGIN: f64 = 24.0;
/// Space for an axis' numbers and title on the left of a panel.
const AXIS: f64 = 58.0;

impl Overview {
    /// Draws the run as a self-contained SVG with a white background.
    pub fn to_svg(&self) -> String {
        let focus = Focus::new(self);
        let extent = top::extent(self, &focus);
        let legend = self.legend(&focus);
        let header = legend.last().map_or(74.0, |entry| entry.at.1) + 24.0;
        // Wide flights go above the two panels over time, others beside them.
        let aspect = extent.width / extent.height;
        let (top_panel, time_panels, height) = if aspect > 1.15 {
            let width = WIDTH - 2.0 * MARGIN - AXIS;
            let panel = Rect::new(
                MARGIN + AXIS,
                header,
                width,
                (width / aspect).clamp(210.0, 620.0),
            );
            let first = Rect::new(panel.x, panel.bottom() + 64.0, width, 150.0);
            let second = Rect::new(panel.x, first.bottom() + 38.0, width, 210.0);
            (panel, [first, second], second.bottom() + 52.0)
        } else {
            let width = 500.0;
            let panel = Rect::new(
                MARGIN + AXIS,
                header,
                width,
                (width / aspect).clamp(430.0, 720.0),
            );
            let x = panel.right() + 40.0 + AXIS;
            let wide = WIDTH - MARGIN - x;
            let split = (panel.height - 38.0) * 0.42;
            let first = Rect::new(x, header, wide, split);
            let second = Rect::new(x, first.bottom() + 38.0, wide, panel.height - 38.0 - split);
            (panel, [first, second], panel.bottom() + 52.0)
        };
        let mut svg = Svg::new(WIDTH, height, &self.title, &self.verdict(&focus));
        svg.follow_the_screen();
        self.draw_header(&mut svg, &focus, &legend);
        top::draw(self, &focus, &extent, top_panel, &mut svg);
        altitude::draw(self, &focus, time_panels[0], &mut svg);
        separation::draw(self, &focus, time_panels[1], &mut svg);
        svg.finish()
    }

    /// One sentence: whether every protected volume stayed clear, and by how much.
    fn verdict(&self, focus: &Focus) -> String {
        if self.samples.is_empty() {
            return "No samples.".to_owned();
        }
        let Some(worst) = focus.followed.first() else {
            return "No obstacle.".to_owned();
        };
        let name = shorten(&worst.obstacle.name, 32);
        let ClosestApproach {
            time_s, margin_m, ..
        } = worst.closest;
        if margin_m < 0.0 {
            format!(
                "Protected volume of {name} entered by {:.1} m at {time_s:.1} s.",
                -margin_m
            )
        } else {
            format!(
                "Every protected volume kept clear; least margin {margin_m:.1} m, to {name}, at {time_s:.1} s."
            )
        }
    }

    fn draw_header(&self, svg: &mut Svg, focus: &Focus, legend: &[OverviewEntry]) {
        let title = shorten(&self.title, 90);
        svg.text((MARGIN, 32.0), &title, TextStyle::new(19.0, INK).bold());
        let lost = focus
            .followed
            .first()
            .is_some_and(|f| f.closest.margin_m < 0.0);
        let verdict = TextStyle::new(13.0, if lost { VERMILION } else { MUTED });
        svg.text(
            (MARGIN, 53.0),
            &self.verdict(focus),
            if lost { verdict.bold() } else { verdict },
        );
        for entry in legend {
            let (x, y) = entry.at;
            let middle = (x + entry.symbol.width() / 2.0, y);
            match entry.symbol {
                Symbol::Line(look) => svg.line((x, y), (x + entry.symbol.width(), y), look),
                Symbol::Volume => svg.circle(middle, 7.0, VOLUME),
                Symbol::Tick => svg.line((middle.0, y - 4.5), (middle.0, y + 4.5), TICK),
                Symbol::Mark(shape) => marker(svg, middle, shape),
            }
            svg.text(
                (x + entry.symbol.width() + 6.0, y + 4.0),
                &entry.label,
                TextStyle::new(12.0, INK),
            );
        }
    }

    /// The legend, in as many rows as it needs; it names only what the picture shows.
    fn legend(&self, focus: &Focus) -> Vec<OverviewEntry> {
        let mut entries: Vec<(Symbol, String)> = Vec::new();
        for state in State::ALL {
            if self.samples.iter().any(|s| s.state == state) {
                entries.push((Symbol::Line(state_look(state)), state.name().to_owned()));
            }
        }
        if self.mission_m.len() > 1 {
            entries.push((Symbol::Line(MISSION), "mission".to_owned()));
        }
        if !self.obstacles.is_empty() {
            entries.push((Symbol::Volume, "protected volume".to_owned()));
        }
        for kind in MomentKind::ALL {
            if self.moments.iter().any(|m| m.kind == kind) {
                entries.push((Symbol::Mark(kind.shape()), kind.name().to_owned()));
            }
        }
        if !focus.followed.is_empty() {
            entries.push((Symbol::Mark(Shape::Closest), "closest approach".to_owned()));
        }
        if self.samples.len() > 1 {
            let step = top::tick_step_s(self);
            entries.push((Symbol::Tick, format!("tick every {step} s")));
        }
        let (mut x, mut y) = (MARGIN, 74.0);
        let mut placed = Vec::new();
        for (symbol, label) in entries {
            let width = symbol.width() + 6.0 + text_width(&label, 12.0);
            if x + width > WIDTH - MARGIN && x > MARGIN {
                (x, y) = (MARGIN, y + 20.0);
            }
            placed.push(OverviewEntry {
                at: (x, y),
                symbol,
                label,
            });
            x += width + 12.0;
        }
        placed
    }
}

/// One entry of the legend.
struct OverviewEntry {
    at: Point,
    symbol: Symbol,
    label: String,
}

#[derive(Clone, Copy)]
enum Symbol {
    Line(&'static str),
    Volume,
    Tick,
    Mark(Shape),
}

impl Symbol {
    const fn width(self) -> f64 {
        match self {
            Self::Line(_) => 18.0,
            Self::Tick => 4.0,
            Self::Volume | Self::Mark(_) => 14.0,
        }
    }
}

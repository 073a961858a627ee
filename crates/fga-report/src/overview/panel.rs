//! A panel over time: its axes, the band of states, lines at the critical moments.

use super::data::{Overview, OverviewMoment, PathSample};
use super::look::{GRID_LINE, axis_titles, state_colour};
use crate::palette::MUTED;
use crate::scale::{Scale, mark_text, marks, step, time_step};
use crate::svg::{Anchor, Point, Rect, Svg, TextStyle};
use fga::avoider::State;

/// A panel over time with its scales.
pub(super) struct Panel {
    pub(super) rect: Rect,
    pub(super) time: Scale,
    pub(super) value: Scale,
}

impl Panel {
    pub(super) fn new(overview: &Overview, rect: Rect, low: f64, high: f64) -> Self {
        let (start, end) = overview.times_s();
        // A run of one moment gets a second of width.
        let end = if end > start { end } else { start + 1.0 };
        Self {
            rect,
            time: Scale::new(start, end, rect.x, rect.right()),
            value: Scale::new(low, high, rect.bottom(), rect.y),
        }
    }

    pub(super) fn at(&self, time_s: f64, value: f64) -> Point {
        (self.time.at(time_s), self.value.at(value))
    }

    pub(super) fn draw_axes(&self, svg: &mut Svg, below: &str, title: &str) {
        let rect = &self.rect;
        let style = TextStyle::new(11.0, MUTED);
        let spacing = time_step(self.time.high() - self.time.low(), rect.width / 70.0);
        for time in marks(self.time.low(), self.time.high(), spacing) {
            let x = self.time.at(time);
            svg.line((x, rect.y), (x, rect.bottom()), GRID_LINE);
            svg.text(
                (x, rect.bottom() + 15.0),
                &mark_text(time, spacing),
                style.anchor(Anchor::Middle),
            );
        }
        let spacing = step(self.value.high() - self.value.low(), rect.height / 34.0);
        for value in marks(self.value.low(), self.value.high(), spacing) {
            let y = self.value.at(value);
            svg.line((rect.x, y), (rect.right(), y), GRID_LINE);
            svg.text(
                (rect.x - 6.0, y + 4.0),
                &mark_text(value, spacing),
                style.anchor(Anchor::End),
            );
        }
        axis_titles(svg, rect, below, title);
    }

    /// Thin lines at the critical moments.
    pub(super) fn draw_moments(&self, svg: &mut Svg, moments: &[OverviewMoment]) {
        for moment in moments {
            let x = self.time.at(moment.time_s);
            if moment.time_s.is_finite() {
                svg.line(
                    (x, self.rect.y),
                    (x, self.rect.bottom()),
                    "stroke=\"#59636e\" stroke-width=\"0.8\" stroke-dasharray=\"3 3\"",
                );
            }
        }
    }

    /// The band of states along the panel's upper edge.
    pub(super) fn draw_states(&self, overview: &Overview, svg: &mut Svg) {
        for (state, piece) in pieces(overview) {
            if let (Some(first), Some(last)) = (piece.first(), piece.last()) {
                let (x, end) = (self.time.at(first.time_s), self.time.at(last.time_s));
                svg.rect(
                    &Rect::new(x, self.rect.y - 6.0, end - x, 5.0),
                    &format!("fill=\"{}\"", state_colour(state)),
                );
            }
        }
    }
}

/// The flown track cut where the state changes; each piece reaches the start of the next one.
pub(super) fn pieces(overview: &Overview) -> Vec<(State, Vec<&PathSample>)> {
    let mut pieces: Vec<(State, Vec<&PathSample>)> = Vec::new();
    for sample in overview.finite_samples() {
        match pieces.last_mut() {
            Some((state, piece)) if *state == sample.state => piece.push(sample),
            last => {
                if let Some((_, piece)) = last {
                    piece.push(sample);
                }
                pieces.push((sample.state, vec![sample]));
            }
        }
    }
    pieces
}

//! Labels that do not overlap: each tries places around its point and takes the least crowded.

use crate::svg::{Point, Rect, Svg, TextStyle, text_width};

/// The areas and lines of a panel that labels avoid.
pub(crate) struct Labels {
    panel: Rect,
    taken: Vec<Rect>,
    lines: Vec<Point>,
}

/// Directions to try: right, left, above, below, then the diagonals.
const PLACES: [Point; 12] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (0.9, -0.7),
    (-0.9, -0.7),
    (0.9, 0.7),
    (-0.9, 0.7),
    (0.5, -1.0),
    (-0.5, -1.0),
    (0.5, 1.0),
    (-0.5, 1.0),
];

/// Cost of a point of a line under a label, against one pixel of distance from the labelled point.
const LINE_COST: f64 = 9.0;

impl Labels {
    pub(crate) fn new(panel: Rect) -> Self {
        Self {
            panel,
            taken: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Keeps labels out of `rect`.
    pub(crate) fn block(&mut self, rect: Rect) {
        self.taken.push(rect);
    }

    /// Makes labels prefer to stay off a line, sampled every few pixels.
    pub(crate) fn avoid_line(&mut self, points: &[Point]) {
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let length = libm::hypot(b.0 - a.0, b.1 - a.1);
            let pieces = libm::ceil(length / 6.0).clamp(1.0, 400.0);
            let mut piece = 0.0;
            while piece < pieces {
                let share = piece / pieces;
                let point = (a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share);
                if self.panel.contains(point) {
                    self.lines.push(point);
                }
                piece += 1.0;
            }
        }
    }

    /// Writes `text` near `at`, at least `gap` pixels away; `false` if there is no room.
    pub(crate) fn place(
        &mut self,
        svg: &mut Svg,
        at: Point,
        gap: f64,
        text: &str,
        style: TextStyle,
    ) -> bool {
        let width = text_width(text, style.size) * if style.bold { 1.06 } else { 1.0 };
        let height = style.size * 1.15;
        let mut best: Option<(f64, f64, Rect)> = None;
        for reach in [gap, gap + 12.0, gap + 26.0, gap + 46.0] {
            for (along, up) in PLACES {
                let side = if along == 0.0 { 0.0 } else { along.signum() };
                let centre = (
                    at.0 + along * reach + side * width / 2.0,
                    at.1 + up * (reach + height / 2.0),
                );
                let rect = Rect::new(
                    centre.0 - width / 2.0,
                    centre.1 - height / 2.0,
                    width,
                    height,
                );
                let wide = rect.grown(2.0);
                if !self.panel.holds(&rect) || self.taken.iter().any(|taken| taken.overlaps(&wide))
                {
                    continue;
                }
                let crossed = self.lines.iter().filter(|p| wide.contains(**p)).count();
                let cost = reach + LINE_COST * crossed as f64;
                if best.is_none_or(|(least, _, _)| cost < least) {
                    best = Some((cost, reach, rect));
                }
            }
        }
        let Some((_, reach, rect)) = best else {
            return false;
        };
        if reach > gap + 13.0 {
            let near = (
                at.0.clamp(rect.x, rect.right()),
                at.1.clamp(rect.y, rect.bottom()),
            );
            svg.line(at, near, "stroke=\"#8b949e\" stroke-width=\"0.6\"");
        }
        svg.text((rect.x, rect.y + style.size * 0.92), text, style);
        self.taken.push(rect);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_at_one_point_do_not_overlap_and_end_when_full() {
        let panel = Rect::new(0.0, 0.0, 200.0, 100.0);
        let mut svg = Svg::new(200.0, 100.0, "t", "d");
        let mut labels = Labels::new(panel);
        let placed = (0..40)
            .filter(|i| {
                labels.place(
                    &mut svg,
                    (100.0, 50.0),
                    5.0,
                    &format!("label {i}"),
                    TextStyle::new(11.0, "#000"),
                )
            })
            .count();
        assert!(placed > 2 && placed < 40, "{placed}");
        for (i, a) in labels.taken.iter().enumerate() {
            assert!(panel.holds(a));
            assert!(labels.taken[i + 1..].iter().all(|b| !a.overlaps(b)));
        }
    }
}

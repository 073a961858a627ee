//! A mission over the ground: altitude and terrain along the path.

use crate::label::Labels;
use crate::overview::{FRAME, GRID_LINE, axis_titles};
use crate::palette::{BLUE, GREEN, INK, MUTED, VERMILION};
use crate::scale::{Scale, mark_text, marks, step};
use crate::svg::{Anchor, Point, Rect, Svg, TextStyle, shorten, text_width};

const WIDTH: f64 = 1160.0;
const HEIGHT: f64 = 470.0;
const MARGIN: f64 = 24.0;
const AXIS: f64 = 58.0;
const UNKNOWN: &str = "fill=\"#8b949e\" fill-opacity=\"0.25\"";

/// A point of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Distance from the beginning of the mission, metres.
    pub along_m: f64,
    /// Altitude of the path, metres.
    pub path_m: f64,
    /// The ground below, metres; `None` where it is not known.
    pub ground_m: Option<f64>,
}

/// A mission over the ground.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// Its name.
    pub title: String,
    /// One sentence: whether the ground is cleared.
    pub verdict: String,
    /// What the path is of, in a word.
    pub path: &'static str,
    /// Whether the ground is known and cleared everywhere.
    pub is_clear: bool,
    /// What altitudes are above, in words.
    pub datum: String,
    /// Points of the path in their order.
    pub points: Vec<ProfilePoint>,
    /// Waypoints: distance from the beginning and altitude, metres.
    pub waypoints_m: Vec<[f64; 2]>,
    /// Least height of the path above the ground, metres.
    pub required_m: f64,
    /// Where the height above the ground is least: distance and altitude, metres.
    pub lowest_m: Option<[f64; 2]>,
}

impl Profile {
    /// Draws the profile as a self-contained SVG with a white background.
    pub fn to_svg(&self) -> String {
        let rect = Rect::new(
            MARGIN + AXIS,
            104.0,
            WIDTH - 2.0 * MARGIN - AXIS,
            HEIGHT - 160.0,
        );
        let mut svg = Svg::new(WIDTH, HEIGHT, &self.title, &self.verdict);
        let title = shorten(&self.title, 90);
        svg.text((MARGIN, 32.0), &title, TextStyle::new(19.0, INK).bold());
        let verdict = TextStyle::new(13.0, if self.is_clear { MUTED } else { VERMILION });
        svg.text((MARGIN, 53.0), &shorten(&self.verdict, 160), verdict);
        self.legend(&mut svg);
        let (along, altitude) = self.scales(&rect);
        self.axes(&mut svg, &rect, (&along, &altitude));
        svg.begin_clip(&rect);
        self.ground(&mut svg, &rect, (&along, &altitude));
        let mut labels = Labels::new(rect.grown(-2.0));
        self.path(&mut svg, &mut labels, (&along, &altitude));
        svg.end_clip();
        svg.rect(&rect, FRAME);
        svg.finish()
    }

    fn legend(&self, svg: &mut Svg) {
        let required = format!("{} m above the ground", mark_text(self.required_m, 0.1));
        let unknown = self.points.iter().any(|point| point.ground_m.is_none());
        let entries = [
            (path_look(BLUE), self.path, true),
            (path_look(VERMILION), "too low", !self.is_clear),
            (ground_look(), "ground", true),
            (required_look(), required.as_str(), true),
            (
                "stroke=\"#8b949e\" stroke-opacity=\"0.4\" stroke-width=\"9\"".into(),
                "ground not known",
                unknown,
            ),
        ];
        let mut x = MARGIN;
        for (look, label, is_shown) in entries {
            if is_shown {
                svg.line((x, 78.0), (x + 26.0, 78.0), &look);
                svg.text((x + 32.0, 82.0), label, TextStyle::new(12.0, INK));
                x += 32.0 + text_width(label, 12.0) + 24.0;
            }
        }
    }

    fn scales(&self, rect: &Rect) -> (Scale, Scale) {
        let end_m = self.points.last().map_or(1.0, |point| point.along_m);
        let mut low = f64::INFINITY;
        let mut high = f64::NEG_INFINITY;
        for point in &self.points {
            let ground_m = point.ground_m.unwrap_or(point.path_m);
            low = low.min(point.path_m).min(ground_m);
            high = high.max(point.path_m).max(ground_m);
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (0.0, 1.0);
        }
        let border = (0.08 * (high - low)).max(10.0);
        (
            Scale::new(0.0, end_m, rect.x, rect.right()),
            Scale::new(low - border, high + border, rect.bottom(), rect.y),
        )
    }

    fn axes(&self, svg: &mut Svg, rect: &Rect, (along, altitude): (&Scale, &Scale)) {
        let style = TextStyle::new(11.0, MUTED);
        let is_long = along.high() > 5_000.0;
        let spacing = step(along.high() - along.low(), rect.width / 70.0);
        for mark in marks(along.low(), along.high(), spacing) {
            let x = along.at(mark);
            svg.line((x, rect.y), (x, rect.bottom()), GRID_LINE);
            let (value, spacing) = if is_long {
                (mark / 1_000.0, spacing / 1_000.0)
            } else {
                (mark, spacing)
            };
            svg.text(
                (x, rect.bottom() + 15.0),
                &mark_text(value, spacing),
                style.anchor(Anchor::Middle),
            );
        }
        let spacing = step(altitude.high() - altitude.low(), rect.height / 34.0);
        for mark in marks(altitude.low(), altitude.high(), spacing) {
            let y = altitude.at(mark);
            svg.line((rect.x, y), (rect.right(), y), GRID_LINE);
            svg.text(
                (rect.x - 6.0, y + 4.0),
                &mark_text(mark, spacing),
                style.anchor(Anchor::End),
            );
        }
        let below = if is_long {
            "distance along the mission (km)"
        } else {
            "distance along the mission (m)"
        };
        axis_titles(svg, rect, below, "altitude (m)");
        let datum = format!("altitudes above {}", self.datum);
        let at = (rect.right(), rect.bottom() + 34.0);
        svg.text(at, &datum, style.anchor(Anchor::End));
    }

    fn ground(&self, svg: &mut Svg, rect: &Rect, (along, altitude): (&Scale, &Scale)) {
        let is_known = |point: &ProfilePoint| point.ground_m.is_some();
        for part in self.points.chunk_by(|a, b| is_known(a) == is_known(b)) {
            let (Some(first), Some(last)) = (part.first(), part.last()) else {
                continue;
            };
            let (from, to) = (along.at(first.along_m), along.at(last.along_m));
            if !is_known(first) {
                svg.rect(&Rect::new(from, rect.y, to - from, rect.height), UNKNOWN);
                continue;
            }
            let line = |above_m: f64| -> Vec<Point> {
                part.iter()
                    .filter_map(|point| {
                        let ground_m = point.ground_m?;
                        Some((along.at(point.along_m), altitude.at(ground_m + above_m)))
                    })
                    .collect()
            };
            let surface = line(0.0);
            let mut shape = crate::svg::thin(&surface, 0.08);
            shape.extend([(to, rect.bottom()), (from, rect.bottom())]);
            svg.polygon(&shape, &format!("fill=\"{GREEN}\" fill-opacity=\"0.22\""));
            svg.polyline(&surface, &ground_look());
            svg.polyline(&line(self.required_m), &required_look());
        }
    }

    fn path(&self, svg: &mut Svg, labels: &mut Labels, (along, altitude): (&Scale, &Scale)) {
        let at = |point: &ProfilePoint| (along.at(point.along_m), altitude.at(point.path_m));
        let line: Vec<Point> = self.points.iter().map(at).collect();
        svg.polyline(&line, &path_look(BLUE));
        let is_low = |point: &ProfilePoint| {
            let ground_m = point.ground_m.unwrap_or(f64::INFINITY);
            point.path_m - ground_m < self.required_m
        };
        for part in self.points.chunk_by(|a, b| is_low(a) == is_low(b)) {
            if part.first().is_some_and(is_low) {
                let low: Vec<Point> = part.iter().map(at).collect();
                svg.polyline(&low, &path_look(VERMILION));
            }
        }
        labels.avoid_line(&crate::svg::thin(&line, 1.0));
        let style = TextStyle::new(11.0, INK).halo();
        for (number, [along_m, altitude_m]) in self.waypoints_m.iter().enumerate() {
            let place = (along.at(*along_m), altitude.at(*altitude_m));
            svg.circle(
                place,
                3.5,
                &format!("fill=\"#fff\" stroke=\"{BLUE}\" stroke-width=\"1.6\""),
            );
            labels.block(Rect::new(place.0 - 5.0, place.1 - 5.0, 10.0, 10.0));
            labels.place(svg, place, 6.0, &format!("{}", number + 1), style);
        }
        if let Some([along_m, altitude_m]) = self.lowest_m {
            let place = (along.at(along_m), altitude.at(altitude_m));
            let look = format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.6\"");
            svg.circle(place, 6.0, &look);
            labels.place(svg, place, 9.0, "lowest", style);
        }
    }
}

fn path_look(colour: &str) -> String {
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.2\" stroke-linejoin=\"round\"")
}

fn ground_look() -> String {
    format!("fill=\"none\" stroke=\"{GREEN}\" stroke-width=\"1.6\" stroke-linejoin=\"round\"")
}

fn required_look() -> String {
    format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"1\" stroke-dasharray=\"5 4\"")
}

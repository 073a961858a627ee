//! The common parts of all charts: the frame with its axes, the legend, colours and marks of series.

use super::{Axis, Spacing};
use crate::palette::{BLACK, BLUE, GREEN, INK, MUTED, ORANGE, PURPLE, SKY, VERMILION};
use crate::scale::{Scale, mark_text, marks, step};
use crate::svg::{Anchor, Point, Rect, Svg, TextStyle, shorten, text_width};

pub(super) const WIDTH: f64 = 760.0;
pub(super) const HEIGHT: f64 = 440.0;

/// Colours of the series in order; then they repeat with another mark and dash.
const COLOURS: [&str; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK];
const DASHES: [&str; 3] = ["", " stroke-dasharray=\"7 3\"", " stroke-dasharray=\"2 3\""];

pub(super) fn colour(series: usize) -> &'static str {
    COLOURS[series % COLOURS.len()]
}

/// Line of a series.
pub(super) fn line_look(series: usize) -> String {
    format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"2\" stroke-linejoin=\"round\"{}",
        colour(series),
        DASHES[(series / COLOURS.len()) % DASHES.len()]
    )
}

/// The mark of a series: a shape besides the colour.
pub(super) fn draw_mark(svg: &mut Svg, (x, y): Point, series: usize) {
    let solid = format!(
        "fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.8\"",
        colour(series)
    );
    let open = format!(
        "fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.6\"",
        colour(series)
    );
    match series % 6 {
        0 => svg.circle((x, y), 4.0, &solid),
        1 => svg.rect(&Rect::new(x - 3.8, y - 3.8, 7.6, 7.6), &solid),
        2 => svg.polygon(
            &[(x, y - 5.0), (x + 4.6, y + 3.6), (x - 4.6, y + 3.6)],
            &solid,
        ),
        3 => svg.polygon(
            &[(x, y - 5.2), (x + 5.2, y), (x, y + 5.2), (x - 5.2, y)],
            &solid,
        ),
        4 => svg.circle((x, y), 3.6, &open),
        _ => svg.rect(&Rect::new(x - 3.4, y - 3.4, 6.8, 6.8), &open),
    }
}

/// An axis along pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ruler {
    scale: Scale,
    spacing: Spacing,
}

impl Ruler {
    /// Maps `axis` to `from..to`; `values` are the data that it must contain.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let log = axis.spacing == Spacing::Log;
        let usable = |value: &f64| value.is_finite() && (!log || *value > 0.0);
        let transform = |value: f64| if log { libm::log10(value) } else { value };
        let given = axis
            .range
            .filter(|(low, high)| usable(low) && usable(high) && low < high);
        let (low, high) = if let Some((low, high)) = given {
            (transform(low), transform(high))
        } else {
            let (low, high) = values
                .filter(usable)
                .map(transform)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
            if low > high {
                (0.0, 1.0)
            } else if log {
                let (low, high) = (libm::floor(low), libm::ceil(high));
                (low, if high > low { high } else { low + 1.0 })
            } else {
                let span = if high > low { high - low } else { 1.0 };
                let round = step(span, 8.0);
                // An axis that nearly reaches zero begins at zero.
                let low = if low >= 0.0 && low < 0.4 * high {
                    0.0
                } else {
                    libm::floor(low / round + 1e-9) * round
                };
                (low, libm::ceil(high / round - 1e-9) * round)
            }
        };
        Self {
            scale: Scale::new(low, high, from, to),
            spacing: axis.spacing,
        }
    }

    /// The position of a value; `None` if it has no position on the axis.
    pub(super) fn at(&self, value: f64) -> Option<f64> {
        let value = if self.spacing == Spacing::Log {
            if value <= 0.0 {
                return None;
            }
            libm::log10(value)
        } else {
            value
        };
        value.is_finite().then(|| self.scale.at(value))
    }

    /// Values to mark with their texts; an empty text for a line without one.
    fn marks(&self, most: f64) -> Vec<(f64, String)> {
        let (low, high) = (self.scale.low(), self.scale.high());
        match self.spacing {
            Spacing::Linear => {
                let step = step(high - low, most);
                marks(low, high, step)
                    .into_iter()
                    .map(|value| (value, mark_text(value, step)))
                    .collect()
            }
            Spacing::Percent => {
                let step = step((high - low) * 100.0, most);
                marks(low * 100.0, high * 100.0, step)
                    .into_iter()
                    .map(|value| (value / 100.0, mark_text(value, step)))
                    .collect()
            }
            Spacing::Log => {
                let every = libm::ceil((high - low) / most).max(1.0);
                let mut found = Vec::new();
                for decade in marks(libm::floor(low), high, 1.0) {
                    let value = libm::exp10(decade);
                    let labelled = libm::remainder(decade, every).abs() < 0.25;
                    let text = if labelled {
                        decade_text(decade)
                    } else {
                        String::new()
                    };
                    if decade >= low - 1e-9 {
                        found.push((value, text));
                    }
                    for lead in 2..10 {
                        let value = value * f64::from(lead);
                        let at = libm::log10(value);
                        if high - low <= 6.0 && at >= low - 1e-9 && at <= high + 1e-9 {
                            let text = if high - low < 1.4 && matches!(lead, 2 | 5) {
                                plain(value)
                            } else {
                                String::new()
                            };
                            found.push((value, text));
                        }
                    }
                }
                found
            }
        }
    }
}

/// A power of ten as people write it.
fn decade_text(decade: f64) -> String {
    if (-3.0..=4.0).contains(&decade) {
        return plain(libm::exp10(decade));
    }
    let exponent = format!("{decade:.0}");
    let raised: String = exponent
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            c => c
                .to_digit(10)
                .and_then(|digit| char::from_u32(0x2070 + digit))
                .unwrap_or(c),
        })
        .collect();
    format!("10{raised}")
}

/// A number with as few decimals as possible, at most six.
fn plain(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A chart's frame: title, plot area, rulers.
pub(super) struct PlotFrame {
    pub(super) area: Rect,
}

impl PlotFrame {
    /// Begins a chart with room for a legend of `names` on the right and `left` pixels of labels.
    pub(super) fn begin(title: &str, names: &[&str], left: f64, height: f64) -> (Svg, Self) {
        let mut svg = Svg::new(WIDTH, height, title, title);
        svg.text(
            (16.0, 26.0),
            &shorten(title, 84),
            TextStyle::new(15.0, INK).bold(),
        );
        let legend = names
            .iter()
            .map(|name| text_width(&shorten(name, 30), 12.0))
            .fold(0.0, f64::max);
        let right = if names.is_empty() {
            22.0
        } else {
            legend + 58.0
        };
        let area = Rect::new(left, 46.0, WIDTH - left - right, height - 46.0 - 52.0);
        (svg, Self { area })
    }

    /// Ruler along the bottom.
    pub(super) fn x(&self, axis: &Axis, values: impl Iterator<Item = f64>) -> Ruler {
        Ruler::new(axis, values, self.area.x, self.area.right())
    }

    /// Ruler along the left side.
    pub(super) fn y(&self, axis: &Axis, values: impl Iterator<Item = f64>) -> Ruler {
        Ruler::new(axis, values, self.area.bottom(), self.area.y)
    }

    pub(super) fn draw_x(&self, svg: &mut Svg, axis: &Axis, ruler: &Ruler) {
        let area = &self.area;
        for (value, text) in ruler.marks(area.width / 64.0) {
            let Some(x) = ruler.at(value) else { continue };
            svg.line((x, area.y), (x, area.bottom()), grid(&text));
            svg.text(
                (x, area.bottom() + 17.0),
                &text,
                TextStyle::new(12.0, MUTED).anchor(Anchor::Middle),
            );
        }
        self.title_below(svg, &axis.label);
    }

    pub(super) fn title_below(&self, svg: &mut Svg, label: &str) {
        svg.text(
            (
                self.area.x + self.area.width / 2.0,
                self.area.bottom() + 39.0,
            ),
            label,
            TextStyle::new(13.0, INK).anchor(Anchor::Middle),
        );
    }

    pub(super) fn draw_y(&self, svg: &mut Svg, axis: &Axis, ruler: &Ruler) {
        let area = &self.area;
        for (value, text) in ruler.marks(area.height / 40.0) {
            let Some(y) = ruler.at(value) else { continue };
            svg.line((area.x, y), (area.right(), y), grid(&text));
            svg.text(
                (area.x - 7.0, y + 4.0),
                &text,
                TextStyle::new(12.0, MUTED).anchor(Anchor::End),
            );
        }
        svg.turned_text(
            (22.0, area.y + area.height / 2.0),
            &axis.label,
            TextStyle::new(13.0, INK).anchor(Anchor::Middle),
            -90.0,
        );
    }

    /// The frame's edge, the legend, and a word where there is no data.
    pub(super) fn finish(
        &self,
        mut svg: Svg,
        names: &[&str],
        empty: bool,
        symbol: impl Fn(&mut Svg, Point, usize),
    ) -> String {
        let area = &self.area;
        svg.rect(area, "fill=\"none\" stroke=\"#8b949e\" stroke-width=\"1\"");
        for (series, name) in names.iter().enumerate() {
            let at = (area.right() + 28.0, area.y + 10.0 + 21.0 * series as f64);
            symbol(&mut svg, at, series);
            svg.text(
                (at.0 + 18.0, at.1 + 4.0),
                &shorten(name, 30),
                TextStyle::new(12.0, INK),
            );
        }
        if empty {
            svg.text(
                (area.x + area.width / 2.0, area.y + area.height / 2.0),
                "no data",
                TextStyle::new(14.0, MUTED).anchor(Anchor::Middle).halo(),
            );
        }
        svg.finish()
    }
}

/// Vertical lines with their names at the top.
pub(super) fn draw_limits(svg: &mut Svg, area: &Rect, ruler: &Ruler, limits: &[(f64, String)]) {
    for (index, (value, name)) in limits.iter().enumerate() {
        let Some(x) = ruler
            .at(*value)
            .filter(|x| *x >= area.x && *x <= area.right())
        else {
            continue;
        };
        svg.line(
            (x, area.y),
            (x, area.bottom()),
            "stroke=\"#1f2328\" stroke-width=\"1.3\" stroke-dasharray=\"6 4\"",
        );
        let left = x + 6.0 + text_width(name, 11.0) > area.right();
        let (at, anchor) = if left {
            (x - 5.0, Anchor::End)
        } else {
            (x + 5.0, Anchor::Start)
        };
        // Names of neighbouring lines go one below the other.
        let y = area.y + 14.0 + 15.0 * (index % 4) as f64;
        svg.text(
            (at, y),
            name,
            TextStyle::new(11.0, INK).anchor(anchor).halo(),
        );
    }
}

/// Lines at labelled marks are stronger.
fn grid(text: &str) -> &'static str {
    if text.is_empty() {
        "stroke=\"#e3e6ea\" stroke-width=\"0.5\""
    } else {
        "stroke=\"#e3e6ea\" stroke-width=\"1\""
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_written_plainly_near_one() {
        assert_eq!(decade_text(-2.0), "0.01");
        assert_eq!(decade_text(3.0), "1000");
        assert_eq!(decade_text(-6.0), "10⁻⁶");
        assert_eq!(decade_text(12.0), "10¹²");
    }

    #[test]
    fn a_log_ruler_has_no_place_for_zero() {
        let ruler = Ruler::new(&Axis::log("t"), [1.0, 1000.0].into_iter(), 0.0, 300.0);
        assert_eq!(ruler.at(0.0), None);
        assert!((ruler.at(10.0).unwrap() - 100.0).abs() < 1e-9);
    }

    #[test]
    fn an_axis_spans_its_data_with_round_ends() {
        let ruler = Ruler::new(&Axis::linear("d"), [103.0, 487.0].into_iter(), 0.0, 1.0);
        assert_eq!((ruler.scale.low(), ruler.scale.high()), (0.0, 500.0));
    }
}

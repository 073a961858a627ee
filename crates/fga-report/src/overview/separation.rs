//! Separation over time, against the protected volumes.

use fga::situation::ProtectedVolume;

use super::data::{CurvePoint, Focus, Overview};
use super::look::{FRAME, Shape, marker, obstacle_line};
use super::panel::Panel;
use crate::label::Labels;
use crate::palette::{INK, MUTED, VERMILION};
use crate::svg::{Anchor, Point, Rect, Svg, TextStyle, shorten, text_width, thin};

pub(super) fn draw(overview: &Overview, focus: &Focus, rect: Rect, svg: &mut Svg) {
    // Spheres compare the separation with their radius; with a cylinder only the distance to the
    // volume fits all.
    let by_margin = focus
        .followed
        .iter()
        .any(|f| matches!(f.obstacle.volume, ProtectedVolume::Cylinder { .. }));
    let value = |point: &CurvePoint| point.shown(by_margin);
    let (low, high) = range(focus, by_margin);
    let panel = Panel::new(overview, rect, low, high);
    let title = if by_margin {
        "distance to protected volume (m)"
    } else {
        "separation (m)"
    };
    panel.draw_axes(svg, "time (s)", title);
    panel.draw_states(overview, svg);
    svg.begin_clip(&rect);
    let mut labels = Labels::new(rect.grown(-2.0));
    draw_limits(&panel, focus, by_margin, svg, &mut labels);
    panel.draw_moments(svg, &overview.moments);
    let line = |points: &[CurvePoint]| -> Vec<Point> {
        points
            .iter()
            .map(|p| panel.at(p.time_s, value(p)))
            .collect()
    };
    let others = line(&focus.least_other);
    svg.polyline(
        &others,
        "fill=\"none\" stroke=\"#8b949e\" stroke-width=\"1\"",
    );
    labels.avoid_line(&thin(&others, 1.0));
    for (rank, followed) in focus.followed.iter().enumerate().rev() {
        let points = line(&followed.curve);
        svg.polyline(&points, &obstacle_line(rank, "1.8"));
        labels.avoid_line(&thin(&points, 1.0));
    }
    draw_closest(&panel, focus, by_margin, svg, &mut labels);
    svg.end_clip();
    svg.rect(&rect, FRAME);
    if focus.followed.is_empty() {
        svg.text(
            (rect.x + rect.width / 2.0, rect.y + rect.height / 2.0),
            "no obstacle",
            TextStyle::new(13.0, MUTED).anchor(Anchor::Middle).halo(),
        );
    }
}

/// The closest approaches, named.
fn draw_closest(panel: &Panel, focus: &Focus, by_margin: bool, svg: &mut Svg, labels: &mut Labels) {
    let rect = panel.rect;
    let value = |point: &CurvePoint| point.shown(by_margin);
    let style = TextStyle::new(11.0, INK).halo();
    let mut texts = Vec::new();
    for followed in &focus.followed {
        let closest = &followed.closest;
        let shown = if by_margin {
            closest.margin_m
        } else {
            closest.separation_m
        };
        let at = panel.at(closest.time_s, shown);
        if rect.contains(at) {
            marker(svg, at, Shape::Closest);
            labels.block(Rect::new(at.0 - 6.0, at.1 - 6.0, 12.0, 12.0));
            let name = shorten(&followed.obstacle.name, 24);
            let lost = closest.margin_m < 0.0;
            let style = if lost {
                TextStyle {
                    colour: VERMILION,
                    ..style
                }
                .bold()
            } else {
                style
            };
            texts.push((at, format!("{name} {shown:.1} m"), style));
        }
    }
    if let Some(least) = focus
        .least_other
        .iter()
        .min_by(|a, b| value(a).total_cmp(&value(b)))
    {
        let at = panel.at(least.time_s, value(least));
        let count = focus.others.len();
        let note = if count == 1 {
            "1 other".to_owned()
        } else {
            format!("least of {count} others")
        };
        texts.push((
            at,
            note,
            TextStyle {
                colour: MUTED,
                ..style
            },
        ));
    }
    for (at, text, style) in texts {
        if rect.contains(at) {
            labels.place(svg, at, 8.0, &text, style);
        }
    }
}

/// The range of values to show: near ones, down to the deepest entry.
fn range(focus: &Focus, by_margin: bool) -> (f64, f64) {
    let value = |point: &CurvePoint| point.shown(by_margin);
    let radius = focus
        .followed
        .iter()
        .map(|f| f.obstacle.volume.radius_m())
        .fold(0.0, f64::max);
    let mut low = 0.0_f64;
    let mut near = 0.0_f64;
    let mut far = 0.0_f64;
    for followed in &focus.followed {
        let least = followed
            .curve
            .iter()
            .map(value)
            .fold(f64::INFINITY, f64::min);
        low = low.min(least);
        near = near.max(least);
        far = followed.curve.iter().map(value).fold(far, f64::max);
    }
    let high = (6.0 * radius)
        .max(1.25 * near.min(12.0 * radius))
        .min(far * 1.05)
        .max(10.0);
    let low = if by_margin {
        (low * 1.1).min(-0.1 * high)
    } else {
        0.0
    };
    (low, high)
}

/// The protected radius of each followed obstacle, or the common boundary of all volumes.
fn draw_limits(panel: &Panel, focus: &Focus, by_margin: bool, svg: &mut Svg, labels: &mut Labels) {
    let rect = &panel.rect;
    let mut radii: Vec<f64> = if focus.followed.is_empty() {
        Vec::new()
    } else if by_margin {
        vec![0.0]
    } else {
        focus
            .followed
            .iter()
            .map(|f| f.obstacle.volume.radius_m())
            .collect()
    };
    radii.sort_by(f64::total_cmp);
    radii.dedup();
    for radius in &radii {
        let y = panel.value.at(*radius);
        if radii.len() == 1 {
            svg.rect(
                &Rect::new(rect.x, y, rect.width, rect.bottom() - y),
                "fill=\"#d55e00\" fill-opacity=\"0.10\"",
            );
        }
        svg.line(
            (rect.x, y),
            (rect.right(), y),
            "stroke=\"#d55e00\" stroke-width=\"1.4\" stroke-dasharray=\"7 4\"",
        );
        let text = if by_margin {
            "edge of the protected volume".to_owned()
        } else {
            format!("protected radius {radius:.0} m")
        };
        // Below the line, which a clear curve never crosses, if there is room.
        let base = if radii.len() == 1 && rect.bottom() - y > 16.0 {
            y + 12.0
        } else {
            y - 4.0
        };
        svg.text(
            (rect.right() - 6.0, base),
            &text,
            TextStyle {
                colour: VERMILION,
                ..TextStyle::new(11.0, INK)
            }
            .anchor(Anchor::End)
            .halo(),
        );
        let width = text_width(&text, 11.0);
        labels.block(Rect::new(
            rect.right() - 6.0 - width,
            base - 10.0,
            width,
            13.0,
        ));
        labels.avoid_line(&[(rect.x, y), (rect.right(), y)]);
    }
}

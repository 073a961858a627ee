//! The top view: equal axes, north up, with compass, scale and labels.

use fga::Vec3;
use fga::avoider::State;
use fga::situation::ProtectedVolume;

use super::data::{Focus, FollowedTrack, Overview, OverviewObstacle};
use super::look::{
    FRAME, GRID_LINE, MISSION, OBSTACLE_COLOURS, axis_titles, marker, obstacle_line, state_look,
};
use super::panel::pieces;
use crate::label::Labels;
use crate::palette::{INK, MUTED, VERMILION};
use crate::scale::{Scale, mark_text, marks, round_down, step, time_step};
use crate::svg::{Anchor, Point, Rect, Svg, TextStyle, shorten, text_width, thin};
use crate::zone::DrawnZone;

/// The bounding box of some points.
#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const NONE: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
    };

    fn take(&mut self, point: Vec3, around: f64) {
        if point.is_finite() && around.is_finite() {
            self.low = self.low.min(point - Vec3::splat(around));
            self.high = self.high.max(point + Vec3::splat(around));
        }
    }

    fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// The longer side of its ground, metres.
    fn size(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        (self.high.x - self.low.x).max(self.high.y - self.low.y)
    }
}

/// The part of the ground to show, metres: x, y are its south-west corner.
pub(super) fn extent(overview: &Overview, focus: &Focus) -> Rect {
    let mut bounds = Bounds::NONE;
    for sample in overview.finite_samples() {
        bounds.take(sample.position_m, 0.0);
    }
    let flown = bounds.size();
    for followed in &focus.followed {
        // A distant obstacle must not make the flight small,
        let radius = followed.obstacle.volume.radius_m();
        let near = followed.closest.margin_m <= (0.25 * flown).max(6.0 * radius);
        if let Some(at) = followed.obstacle.position_at_m(followed.closest.time_s)
            && near
        {
            bounds.take(at, radius);
        }
    }
    // nor must a mission that reaches far beyond it.
    let seen = bounds;
    for &waypoint in &overview.mission_m {
        let off = (waypoint.max(seen.low).min(seen.high) - waypoint).length();
        if seen.is_empty() || off <= 0.4 * seen.size().max(50.0) {
            bounds.take(waypoint, 0.0);
        }
    }
    if bounds.is_empty() {
        return Rect::new(-50.0, -25.0, 100.0, 50.0);
    }
    let border = 0.05 * bounds.size().max(20.0) + 2.0;
    let (low, high) = (bounds.low, bounds.high);
    Rect::new(
        low.x - border,
        low.y - border,
        high.x - low.x + 2.0 * border,
        high.y - low.y + 2.0 * border,
    )
}

struct TopView {
    panel: Rect,
    x: Scale,
    y: Scale,
    per_metre: f64,
}

impl TopView {
    fn new(extent: &Rect, panel: Rect) -> Self {
        let per_metre = (panel.width / extent.width).min(panel.height / extent.height);
        let (wide, high) = (panel.width / per_metre, panel.height / per_metre);
        let west = extent.x + (extent.width - wide) / 2.0;
        let south = extent.y + (extent.height - high) / 2.0;
        Self {
            panel,
            x: Scale::new(west, west + wide, panel.x, panel.right()),
            y: Scale::new(south, south + high, panel.bottom(), panel.y),
            per_metre,
        }
    }

    fn at(&self, position: Vec3) -> Point {
        (self.x.at(position.x), self.y.at(position.y))
    }
}

pub(super) fn draw(overview: &Overview, focus: &Focus, extent: &Rect, panel: Rect, svg: &mut Svg) {
    let view = TopView::new(extent, panel);
    draw_grid(&view, svg);
    let mut labels = Labels::new(panel.grown(-3.0));
    svg.begin_clip(&panel);
    for zone in &overview.zones {
        draw_zone(&view, zone, svg, &mut labels);
    }
    for (obstacle, closest_s) in &focus.others {
        draw_other(&view, obstacle, *closest_s, svg);
    }
    let mission: Vec<Point> = overview
        .mission_m
        .iter()
        .filter(|p| p.is_finite())
        .map(|p| view.at(*p))
        .collect();
    for (rank, followed) in focus.followed.iter().enumerate().rev() {
        draw_followed(overview, &view, followed, rank, svg, &mut labels);
    }
    svg.polyline(&mission, MISSION);
    labels.avoid_line(&mission);
    for point in &mission {
        svg.circle(
            *point,
            2.6,
            "fill=\"#ffffff\" stroke=\"#59636e\" stroke-width=\"1.2\"",
        );
    }
    draw_track(overview, &view, svg, &mut labels);
    draw_compass_and_scale(&view, svg, &mut labels);
    draw_marks(overview, focus, &view, svg, &mut labels);
    svg.end_clip();
    svg.rect(&panel, FRAME);
}

fn draw_grid(view: &TopView, svg: &mut Svg) {
    let panel = &view.panel;
    let spacing = step(view.x.high() - view.x.low(), panel.width / 90.0);
    let north_spacing = step(view.y.high() - view.y.low(), panel.height / 48.0).min(spacing);
    // Large areas have marks in kilometres.
    let far = spacing >= 1000.0;
    let (unit, per_unit) = if far { ("km", 1000.0) } else { ("m", 1.0) };
    let style = TextStyle::new(11.0, MUTED);
    for x in marks(view.x.low(), view.x.high(), spacing) {
        let at = view.x.at(x);
        svg.line((at, panel.y), (at, panel.bottom()), GRID_LINE);
        svg.text(
            (at, panel.bottom() + 15.0),
            &mark_text(x / per_unit, spacing / per_unit),
            style.anchor(Anchor::Middle),
        );
    }
    for y in marks(view.y.low(), view.y.high(), north_spacing) {
        let at = view.y.at(y);
        svg.line((panel.x, at), (panel.right(), at), GRID_LINE);
        svg.text(
            (panel.x - 6.0, at + 4.0),
            &mark_text(y / per_unit, north_spacing / per_unit),
            style.anchor(Anchor::End),
        );
    }
    axis_titles(
        svg,
        panel,
        &format!("east ({unit})"),
        &format!("north ({unit})"),
    );
}

/// Pieces of an edge among which one that is shown is looked for.
const EDGE_PIECES: u32 = 200;

/// A zone: its outline, and its area where the aircraft keeps out of it.
fn draw_zone(view: &TopView, zone: &DrawnZone, svg: &mut Svg, labels: &mut Labels) {
    let places = zone
        .ring_m
        .iter()
        .map(|[x_m, y_m]| Vec3::new(*x_m, *y_m, 0.0));
    let ring = places.filter(|at| at.is_finite()).map(|at| view.at(at));
    let ring: Vec<Point> = ring.collect();
    if zone.keep_in {
        svg.polyline(
            &ring,
            "fill=\"none\" stroke=\"#d55e00\" stroke-width=\"1.2\" stroke-dasharray=\"6 3\"",
        );
    } else {
        svg.polygon(
            &ring,
            "fill=\"#d55e00\" fill-opacity=\"0.13\" stroke=\"#d55e00\" stroke-width=\"1\"",
        );
    }
    labels.avoid_line(&ring);
    let style = TextStyle::new(10.0, VERMILION);
    let name = shorten(&zone.name, 24);
    let width = text_width(&name, 10.0);
    let style = if zone.keep_in {
        style
    } else {
        style.anchor(Anchor::Middle)
    };
    let (x, y) = if zone.keep_in {
        // Beside the first corner that is shown, or the first piece of an edge.
        let shown = view.panel.grown(-20.0);
        let edges = ring.windows(2).flat_map(|edge| {
            (0..=EDGE_PIECES).map(|piece| {
                let share = f64::from(piece) / f64::from(EDGE_PIECES);
                let along = |from: f64, to: f64| from + share * (to - from);
                (along(edge[0].0, edge[1].0), along(edge[0].1, edge[1].1))
            })
        });
        let mut places = ring.iter().copied().chain(edges);
        let Some((x, y)) = places.find(|at| shown.contains(*at)) else {
            return;
        };
        (x.min(view.panel.right() - width - 4.0) + 4.0, y + 12.0)
    } else {
        let count = ring.len().max(1) as f64;
        let (x, y) = ring
            .iter()
            .fold((0.0, 0.0), |sum, at| (sum.0 + at.0, sum.1 + at.1));
        (x / count, y / count + 4.0)
    };
    svg.text((x, y), &name, style);
    let left = if zone.keep_in { x } else { x - 0.5 * width };
    labels.block(Rect::new(left, y - 10.0, width, 13.0));
}

/// An obstacle that is not followed: its volume, faint.
fn draw_other(view: &TopView, obstacle: &OverviewObstacle, closest_s: f64, svg: &mut Svg) {
    let Some(at) = obstacle.position_at_m(closest_s) else {
        return;
    };
    let centre = view.at(at);
    let radius = obstacle.volume.radius_m() * view.per_metre;
    if view.panel.grown(radius).contains(centre) {
        svg.circle(
            centre,
            radius.max(1.2),
            "fill=\"#8b949e\" fill-opacity=\"0.12\" stroke=\"#8b949e\" stroke-width=\"0.6\" stroke-opacity=\"0.7\"",
        );
    }
}

fn draw_followed(
    overview: &Overview,
    view: &TopView,
    followed: &FollowedTrack,
    rank: usize,
    svg: &mut Svg,
    labels: &mut Labels,
) {
    let FollowedTrack {
        obstacle, closest, ..
    } = followed;
    let Some(at) = obstacle.position_at_m(closest.time_s) else {
        return;
    };
    let colour = OBSTACLE_COLOURS[rank % OBSTACLE_COLOURS.len()];
    if obstacle.moves() {
        let (start, end) = overview.times_s();
        let mut way: Vec<Point> = [start, end]
            .iter()
            .filter_map(|t| obstacle.position_at_m(*t))
            .map(|p| view.at(p))
            .collect();
        let inner = obstacle
            .track
            .iter()
            .filter(|p| p.time_s > start && p.time_s < end && p.position_m.is_finite());
        let split = way.len().min(1);
        let tail = way.split_off(split);
        way.extend(inner.map(|p| view.at(p.position_m)));
        way.extend(tail);
        let look = obstacle_line(rank, "1.2") + " stroke-opacity=\"0.55\"";
        svg.polyline(&way, &look);
        labels.avoid_line(&way);
        for time in marks(start, end, tick_step_s(overview)) {
            if let Some(p) = obstacle.position_at_m(time) {
                let dot = format!("fill=\"{colour}\" fill-opacity=\"0.7\"");
                svg.circle(view.at(p), 1.9, &dot);
            }
        }
    }
    let centre = view.at(at);
    let radius = obstacle.volume.radius_m() * view.per_metre;
    let lost = closest.margin_m < 0.0;
    let (edge, width) = if lost {
        (VERMILION, 2.4)
    } else {
        (colour, 1.4)
    };
    let look = format!(
        "fill=\"{}\" fill-opacity=\"0.16\" stroke=\"{edge}\" stroke-width=\"{width}\"",
        if lost { VERMILION } else { colour }
    );
    svg.circle(centre, radius.max(2.0), &look);
    svg.circle(centre, 2.2, &format!("fill=\"{colour}\""));
    labels.block(Rect::new(centre.0 - 3.0, centre.1 - 3.0, 6.0, 6.0));
}

/// The flown track in the colours of its states, with ticks of time.
fn draw_track(overview: &Overview, view: &TopView, svg: &mut Svg, labels: &mut Labels) {
    let samples: Vec<_> = overview.finite_samples().collect();
    for (state, piece) in pieces(overview) {
        let line: Vec<Point> = piece.iter().map(|s| view.at(s.position_m)).collect();
        svg.polyline(&line, state_look(state));
        labels.avoid_line(&thin(&line, 1.0));
    }
    if let [only] = samples.as_slice() {
        svg.circle(view.at(only.position_m), 4.0, "fill=\"#0072b2\"");
    }
    draw_ticks(overview, view, svg);
    if let (Some(first), Some(last)) = (samples.first(), samples.last()) {
        let at = view.at(first.position_m);
        svg.circle(
            at,
            4.2,
            "fill=\"#ffffff\" stroke=\"#0072b2\" stroke-width=\"2\"",
        );
        labels.block(Rect::new(at.0 - 5.0, at.1 - 5.0, 10.0, 10.0));
        let before = samples
            .iter()
            .rev()
            .map(|s| view.at(s.position_m))
            .find(|p| {
                let end = view.at(last.position_m);
                libm::hypot(p.0 - end.0, p.1 - end.1) > 4.0
            });
        if let Some(before) = before {
            draw_arrow(svg, before, view.at(last.position_m), last.state);
        }
    }
}

fn draw_arrow(svg: &mut Svg, from: Point, to: Point, state: State) {
    let length = libm::hypot(to.0 - from.0, to.1 - from.1);
    let (ux, uy) = ((to.0 - from.0) / length, (to.1 - from.1) / length);
    let point = |along: f64, across: f64| {
        (
            to.0 + along * ux - across * uy,
            to.1 + along * uy + across * ux,
        )
    };
    let look = format!(
        "fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.8\"",
        super::state_colour(state)
    );
    svg.polygon(
        &[
            point(7.0, 0.0),
            point(-7.0, 6.0),
            point(-3.5, 0.0),
            point(-7.0, -6.0),
        ],
        &look,
    );
}

fn draw_ticks(overview: &Overview, view: &TopView, svg: &mut Svg) {
    let (start, end) = overview.times_s();
    for time in marks(start, end, tick_step_s(overview)) {
        let (Some(here), Some(soon)) = (
            overview.position_at_m(time),
            overview.position_at_m(time + (end - start) * 1e-3),
        ) else {
            continue;
        };
        let (a, b) = (view.at(here), view.at(soon));
        let length = libm::hypot(b.0 - a.0, b.1 - a.1);
        if length > 0.0 && length.is_finite() {
            let (nx, ny) = (-(b.1 - a.1) / length * 4.5, (b.0 - a.0) / length * 4.5);
            svg.line((a.0 - nx, a.1 - ny), (a.0 + nx, a.1 + ny), super::TICK);
        }
    }
}

/// Time between two ticks on the tracks, seconds.
pub(super) fn tick_step_s(overview: &Overview) -> f64 {
    let (start, end) = overview.times_s();
    time_step(end - start, 12.0)
}

fn draw_compass_and_scale(view: &TopView, svg: &mut Svg, labels: &mut Labels) {
    let panel = &view.panel;
    // North arrow, top right.
    let (x, y) = (panel.right() - 22.0, panel.y + 14.0);
    let back = Rect::new(x - 14.0, y - 8.0, 28.0, 48.0);
    svg.rect(&back, "fill=\"#ffffff\" fill-opacity=\"0.85\"");
    svg.polygon(
        &[
            (x, y - 3.0),
            (x + 6.0, y + 17.0),
            (x, y + 12.5),
            (x - 6.0, y + 17.0),
        ],
        "fill=\"#1f2328\"",
    );
    svg.text(
        (x, y + 33.0),
        "N",
        TextStyle::new(12.0, INK).bold().anchor(Anchor::Middle),
    );
    labels.block(back);
    // Scale, bottom left.
    let length_m = round_down(130.0 / view.per_metre);
    let length = length_m * view.per_metre;
    let (x, y) = (panel.x + 14.0, panel.bottom() - 14.0);
    let text = if length_m >= 1000.0 {
        format!("{} km", length_m / 1000.0)
    } else {
        format!("{length_m} m")
    };
    let wide = length.max(text_width(&text, 11.0));
    let back = Rect::new(x - 6.0, y - 22.0, wide + 12.0, 30.0);
    svg.rect(&back, "fill=\"#ffffff\" fill-opacity=\"0.85\"");
    let bar = "fill=\"none\" stroke=\"#1f2328\" stroke-width=\"1.6\"";
    svg.polyline(
        &[(x, y - 4.0), (x, y), (x + length, y), (x + length, y - 4.0)],
        bar,
    );
    svg.text((x, y - 8.0), &text, TextStyle::new(11.0, INK));
    labels.block(back);
}

/// The critical moments and closest approaches, the most important labels first.
fn draw_marks(
    overview: &Overview,
    focus: &Focus,
    view: &TopView,
    svg: &mut Svg,
    labels: &mut Labels,
) {
    let mut texts: Vec<(Point, String, TextStyle, f64)> = Vec::new();
    let plain = TextStyle::new(11.5, INK).halo();
    for (rank, followed) in focus.followed.iter().enumerate() {
        let closest = &followed.closest;
        let (Some(own), Some(at)) = (
            overview.position_at_m(closest.time_s),
            followed.obstacle.position_at_m(closest.time_s),
        ) else {
            continue;
        };
        let lost = closest.margin_m < 0.0;
        let (own, at) = (view.at(own), view.at(at));
        let shown = rank < 3 || lost;
        if shown {
            svg.line(
                own,
                at,
                "stroke=\"#1f2328\" stroke-width=\"0.9\" stroke-dasharray=\"2 2\"",
            );
            labels.avoid_line(&[own, at]);
            marker(svg, own, super::Shape::Closest);
            labels.block(Rect::new(own.0 - 6.0, own.1 - 6.0, 12.0, 12.0));
            let style = if lost {
                TextStyle {
                    colour: VERMILION,
                    ..plain
                }
                .bold()
            } else {
                plain
            };
            let text = match followed.obstacle.volume {
                ProtectedVolume::Sphere { .. } => {
                    format!("{:.1} m at {:.1} s", closest.separation_m, closest.time_s)
                }
                // The distance to the centre says little about a flat volume.
                ProtectedVolume::Cylinder { .. } => {
                    let margin = format!("{:.1}", closest.margin_m).replace('-', "−");
                    format!("margin {margin} m at {:.1} s", closest.time_s)
                }
            };
            texts.push((own, text, style, 8.0));
        }
        let name = shorten(&followed.obstacle.name, 24);
        let radius = followed.obstacle.volume.radius_m() * view.per_metre;
        let gap = if radius < 60.0 { radius + 3.0 } else { 6.0 };
        texts.push((at, name, plain.bold(), gap));
    }
    let mut drawn = 0;
    for moment in &overview.moments {
        let Some(at) = overview.position_at_m(moment.time_s) else {
            continue;
        };
        drawn += 1;
        let at = view.at(at);
        marker(svg, at, moment.kind.shape());
        labels.block(Rect::new(at.0 - 6.0, at.1 - 6.0, 12.0, 12.0));
        // A crowded picture keeps only the times; the legend explains the shapes.
        let text = if overview.moments.len() > 6 {
            format!("{:.1} s", moment.time_s)
        } else {
            format!("{} {:.1} s", moment.kind.name(), moment.time_s)
        };
        texts.push((at, text, plain, 9.0));
    }
    if overview.moments.len() > 30 {
        texts.truncate(texts.len() - drawn);
    }
    for (at, text, style, gap) in texts {
        if view.panel.contains(at) {
            labels.place(svg, at, gap, &text, style);
        }
    }
}

//! The altitude profile, with the protected volumes where the track's vertical curtain cuts them.

use fga::situation::ProtectedVolume;

use super::data::{Focus, FollowedTrack, Overview};
use super::look::{FRAME, OBSTACLE_COLOURS, marker, state_look};
use super::panel::{Panel, pieces};
use crate::label::Labels;
use crate::palette::{INK, VERMILION};
use crate::svg::{Point, Rect, Svg, TextStyle, shorten, thin};

pub(super) fn draw(overview: &Overview, focus: &Focus, rect: Rect, svg: &mut Svg) {
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    for sample in overview.finite_samples() {
        low = low.min(sample.position_m.z);
        high = high.max(sample.position_m.z);
    }
    if !low.is_finite() {
        (low, high) = (0.0, 1.0);
    }
    let flown = high - low;
    let sections: Vec<_> = focus
        .followed
        .iter()
        .map(|f| (f, section(overview, f)))
        .collect();
    // Volumes above or below the track, if they do not flatten the climb.
    let reach = (2.0 * flown).max(60.0);
    for (_, cut) in &sections {
        for (_, bottom, top) in cut {
            low = low.min(bottom.max(low - reach));
            high = high.max(top.min(high + reach));
        }
    }
    let border = (0.08 * (high - low)).max((20.0 - (high - low)) / 2.0);
    let panel = Panel::new(overview, rect, low - border, high + border);
    panel.draw_axes(svg, "", "altitude (m)");
    panel.draw_states(overview, svg);
    svg.begin_clip(&rect);
    let mut levels: Vec<f64> = overview.mission_m.iter().map(|p| p.z).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() < 0.5);
    if levels.len() <= 3 {
        for level in levels {
            let y = panel.value.at(level);
            svg.line((rect.x, y), (rect.right(), y), super::MISSION);
        }
    }
    let mut labels = Labels::new(rect.grown(-2.0));
    let mut names = Vec::new();
    for (rank, (followed, cut)) in sections.iter().enumerate() {
        let colour = OBSTACLE_COLOURS[rank % OBSTACLE_COLOURS.len()];
        let lost = followed.closest.margin_m < 0.0;
        // One shape for each stay above, inside or below the volume.
        let gap = (panel.time.high() - panel.time.low()) * 0.02;
        for stay in cut.chunk_by(|a, b| b.0 - a.0 <= gap) {
            let mut shape: Vec<Point> = stay.iter().map(|c| panel.at(c.0, c.2)).collect();
            shape.extend(stay.iter().rev().map(|c| panel.at(c.0, c.1)));
            let look = format!(
                "fill=\"{0}\" fill-opacity=\"0.18\" stroke=\"{0}\" stroke-width=\"1.2\"",
                if lost { VERMILION } else { colour }
            );
            svg.polygon(&thin(&shape, 0.1), &look);
            if let Some(middle) = stay.get(stay.len() / 2) {
                names.push((
                    panel.at(middle.0, middle.2.min(panel.value.high())),
                    shorten(&followed.obstacle.name, 20),
                ));
            }
        }
    }
    panel.draw_moments(svg, &overview.moments);
    for (state, piece) in pieces(overview) {
        let line: Vec<Point> = piece
            .iter()
            .map(|s| panel.at(s.time_s, s.position_m.z))
            .collect();
        svg.polyline(&line, state_look(state));
        labels.avoid_line(&thin(&line, 1.0));
    }
    if let [only] = overview.samples.as_slice() {
        let at = panel.at(only.time_s, only.position_m.z);
        svg.circle(at, 4.0, "fill=\"#0072b2\"");
    }
    for moment in &overview.moments {
        if let Some(p) = overview.position_at_m(moment.time_s) {
            let at = panel.at(moment.time_s, p.z);
            marker(svg, at, moment.kind.shape());
            labels.block(Rect::new(at.0 - 6.0, at.1 - 6.0, 12.0, 12.0));
        }
    }
    let style = TextStyle::new(11.0, INK).halo();
    for (at, name) in names {
        labels.place(svg, at, 4.0, &name, style);
    }
    svg.end_clip();
    svg.rect(&rect, FRAME);
}

/// The section of a protected volume in the track's vertical curtain: time, lowest, highest.
fn section(overview: &Overview, followed: &FollowedTrack) -> Vec<(f64, f64, f64)> {
    let obstacle = followed.obstacle;
    overview
        .finite_samples()
        .filter_map(|sample| {
            let at = obstacle.position_at_m(sample.time_s)?;
            let off = libm::hypot(sample.position_m.x - at.x, sample.position_m.y - at.y);
            let half = match obstacle.volume {
                ProtectedVolume::Sphere { radius_m } => {
                    if off > radius_m {
                        return None;
                    }
                    libm::sqrt(radius_m * radius_m - off * off)
                }
                ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m,
                } => (off <= radius_m).then_some(half_height_m)?,
            };
            Some((sample.time_s, at.z - half, at.z + half))
        })
        .collect()
}

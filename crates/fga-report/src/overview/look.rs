//! Colours, lines and marks of the overview.

use fga::avoider::State;

use crate::palette::{BLACK, BLUE, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION};
use crate::svg::{Anchor, Point, Rect, Svg, TextStyle};

pub(super) const VOLUME: &str =
    "fill=\"#8b949e\" fill-opacity=\"0.18\" stroke=\"#59636e\" stroke-width=\"1.2\"";

pub(super) const TICK: &str = "stroke=\"#1f2328\" stroke-width=\"1\"";

pub(super) const MISSION: &str =
    "fill=\"none\" stroke=\"#59636e\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"";

/// Line of the aircraft's track in a state.
pub(super) const fn state_look(state: State) -> &'static str {
    match state {
        State::Cruise => {
            "fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2.4\" stroke-linecap=\"round\" stroke-linejoin=\"round\""
        }
        State::Threatened => {
            "fill=\"none\" stroke=\"#e69f00\" stroke-width=\"3\" stroke-linecap=\"round\" stroke-linejoin=\"round\""
        }
        State::Avoiding => {
            "fill=\"none\" stroke=\"#d55e00\" stroke-width=\"3\" stroke-linecap=\"round\" stroke-linejoin=\"round\""
        }
        State::Recovering => {
            "fill=\"none\" stroke=\"#009e73\" stroke-width=\"2.6\" stroke-linecap=\"round\" stroke-linejoin=\"round\""
        }
    }
}

/// Fill colour of a state.
pub(super) const fn state_colour(state: State) -> &'static str {
    match state {
        State::Cruise => BLUE,
        State::Threatened => ORANGE,
        State::Avoiding => VERMILION,
        State::Recovering => GREEN,
    }
}

/// Colours of the followed obstacles, closest first; the aircraft's states use other colours.
pub(super) const OBSTACLE_COLOURS: [&str; 3] = [PURPLE, SKY, BLACK];

/// The look of a followed obstacle's line: after three colours comes a dash pattern.
pub(super) fn obstacle_line(rank: usize, width: &str) -> String {
    let colour = OBSTACLE_COLOURS[rank % OBSTACLE_COLOURS.len()];
    let dash = if rank < OBSTACLE_COLOURS.len() {
        ""
    } else {
        " stroke-dasharray=\"8 3 2 3\""
    };
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dash}")
}

/// Shapes of the marks: each is different, so that colour is not needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Seen,
    Begun,
    Rejoined,
    Closest,
}

pub(super) fn marker(svg: &mut Svg, (x, y): Point, shape: Shape) {
    match shape {
        Shape::Seen => svg.polygon(
            &[(x, y - 6.5), (x + 6.0, y + 4.5), (x - 6.0, y + 4.5)],
            "fill=\"#e69f00\" stroke=\"#1f2328\" stroke-width=\"1.1\"",
        ),
        Shape::Begun => svg.polygon(
            &[(x, y - 6.5), (x + 6.5, y), (x, y + 6.5), (x - 6.5, y)],
            "fill=\"#d55e00\" stroke=\"#1f2328\" stroke-width=\"1.1\"",
        ),
        Shape::Rejoined => svg.rect(
            &Rect::new(x - 5.0, y - 5.0, 10.0, 10.0),
            "fill=\"#009e73\" stroke=\"#1f2328\" stroke-width=\"1.1\"",
        ),
        Shape::Closest => {
            svg.circle(
                (x, y),
                5.2,
                "fill=\"#ffffff\" stroke=\"#1f2328\" stroke-width=\"1.6\"",
            );
            svg.circle((x, y), 1.8, "fill=\"#1f2328\"");
        }
    }
}

/// An axis title, centred below or turned beside a panel.
pub(crate) fn axis_titles(svg: &mut Svg, panel: &Rect, below: &str, beside: &str) {
    let style = TextStyle::new(12.0, INK).anchor(Anchor::Middle);
    if !below.is_empty() {
        svg.text(
            (panel.x + panel.width / 2.0, panel.bottom() + 34.0),
            below,
            style,
        );
    }
    let at = (panel.x - 44.0, panel.y + panel.height / 2.0);
    svg.turned_text(at, beside, style, -90.0);
}

pub(crate) const GRID_LINE: &str = "stroke=\"#e3e6ea\" stroke-width=\"1\"";

pub(crate) const FRAME: &str = "fill=\"none\" stroke=\"#8b949e\" stroke-width=\"1\"";

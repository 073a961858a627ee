//! A small writer of SVG: shapes, text, clipped panels; deterministic bytes, names escaped.

use core::fmt::Write as _;

use crate::palette::PAPER;

/// Font stack of every text; [`text_width`] estimates by the widest of its fonts.
const FONTS: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// The neutral colours of the palette and of the grid, on a dark screen; the colours of series stay, but for the darkest.
const DARK: &str = "<style>@media screen and (prefers-color-scheme:dark){\
[fill=\"#ffffff\"]{fill:#14181d}[fill=\"#1f2328\"],[fill=\"#000000\"]{fill:#e6eaef}[fill=\"#59636e\"]{fill:#9aa6b2}[fill=\"#0072b2\"]{fill:#3d9bd6}\
[stroke=\"#ffffff\"]{stroke:#14181d}[stroke=\"#1f2328\"],[stroke=\"#000000\"]{stroke:#e6eaef}[stroke=\"#59636e\"]{stroke:#9aa6b2}\
[stroke=\"#e3e6ea\"]{stroke:#2a313a}[stroke=\"#0072b2\"]{stroke:#3d9bd6}}</style>\n";

/// A point of the picture, pixels from its top left corner.
pub(crate) type Point = (f64, f64);

/// An upright rectangle, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    pub(crate) const fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self {
            x,
            y,
            width,
            height,
        }
    }

    pub(crate) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.right()
            && other.x < self.right()
            && self.y < other.bottom()
            && other.y < self.bottom()
    }

    pub(crate) fn holds(&self, other: &Self) -> bool {
        other.x >= self.x
            && other.right() <= self.right()
            && other.y >= self.y
            && other.bottom() <= self.bottom()
    }

    pub(crate) fn contains(&self, (x, y): Point) -> bool {
        x >= self.x && x <= self.right() && y >= self.y && y <= self.bottom()
    }

    pub(crate) fn grown(&self, by: f64) -> Self {
        Self::new(
            self.x - by,
            self.y - by,
            self.width + 2.0 * by,
            self.height + 2.0 * by,
        )
    }
}

/// The position of a text relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    const fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// The look of a text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextStyle {
    pub(crate) size: f64,
    pub(crate) colour: &'static str,
    pub(crate) bold: bool,
    pub(crate) anchor: Anchor,
    /// A rim in the paper's colour, for text on lines.
    pub(crate) halo: bool,
}

impl TextStyle {
    pub(crate) const fn new(size: f64, colour: &'static str) -> Self {
        Self {
            size,
            colour,
            bold: false,
            anchor: Anchor::Start,
            halo: false,
        }
    }

    pub(crate) const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub(crate) const fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(crate) const fn halo(self) -> Self {
        Self { halo: true, ..self }
    }
}

/// A picture under construction.
///
/// The look of shapes is in presentation attributes (`fill="none" stroke="#000"`), which come
/// from constants of this crate and never from input.
pub(crate) struct Svg {
    body: String,
}

impl Svg {
    /// Begins a picture of `width` × `height` pixels with its background.
    pub(crate) fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        let (w, h) = (number(width), number(height));
        let mut body = String::with_capacity(1 << 14);
        let _ = write!(
            body,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"{FONTS}\" role=\"img\">\n\
             <title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"{PAPER}\"/>\n",
            escape(title),
            escape(description),
        );
        Self { body }
    }

    /// Exchanges the neutral colours by their values for a dark screen, where the picture is shown by itself.
    pub(crate) fn follow_the_screen(&mut self) {
        self.body.push_str(DARK);
    }

    pub(crate) fn line(&mut self, from: Point, to: Point, look: &str) {
        let _ = writeln!(
            self.body,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {look}/>",
            number(from.0),
            number(from.1),
            number(to.0),
            number(to.1),
        );
    }

    pub(crate) fn rect(&mut self, rect: &Rect, look: &str) {
        let _ = writeln!(
            self.body,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {look}/>",
            number(rect.x),
            number(rect.y),
            number(rect.width.max(0.0)),
            number(rect.height.max(0.0)),
        );
    }

    pub(crate) fn circle(&mut self, centre: Point, radius: f64, look: &str) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {look}/>",
            number(centre.0),
            number(centre.1),
            number(radius),
        );
    }

    /// An open line through `points`, without invisible ones.
    pub(crate) fn polyline(&mut self, points: &[Point], look: &str) {
        let points = thin(points, 0.08);
        if points.len() > 1 {
            self.points("polyline", &points, look);
        }
    }

    /// A closed shape.
    pub(crate) fn polygon(&mut self, points: &[Point], look: &str) {
        self.points("polygon", points, look);
    }

    fn points(&mut self, element: &str, points: &[Point], look: &str) {
        let _ = write!(self.body, "<{element} points=\"");
        for (index, point) in points.iter().enumerate() {
            let gap = if index == 0 { "" } else { " " };
            let _ = write!(self.body, "{gap}{},{}", number(point.0), number(point.1));
        }
        let _ = writeln!(self.body, "\" {look}/>");
    }

    pub(crate) fn text(&mut self, at: Point, text: &str, style: TextStyle) {
        self.turned_text(at, text, style, 0.0);
    }

    /// Text rotated by `degrees` clockwise about its point.
    pub(crate) fn turned_text(&mut self, at: Point, text: &str, style: TextStyle, degrees: f64) {
        let _ = write!(
            self.body,
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"",
            number(at.0),
            number(at.1),
            number(style.size),
            style.colour,
        );
        if style.anchor != Anchor::Start {
            let _ = write!(self.body, " text-anchor=\"{}\"", style.anchor.name());
        }
        if style.bold {
            self.body.push_str(" font-weight=\"bold\"");
        }
        if style.halo {
            let _ = write!(
                self.body,
                " stroke=\"{PAPER}\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            );
        }
        if degrees != 0.0 {
            let _ = write!(
                self.body,
                " transform=\"rotate({} {} {})\"",
                number(degrees),
                number(at.0),
                number(at.1)
            );
        }
        let _ = writeln!(self.body, ">{}</text>", escape(text));
    }

    /// Begins a panel that clips to `rect`; coordinates stay the picture's.
    pub(crate) fn begin_clip(&mut self, rect: &Rect) {
        let (x, y) = (number(rect.x), number(rect.y));
        let (w, h) = (number(rect.width), number(rect.height));
        let _ = writeln!(
            self.body,
            "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\" overflow=\"hidden\">"
        );
    }

    pub(crate) fn end_clip(&mut self) {
        self.body.push_str("</svg>\n");
    }

    pub(crate) fn finish(mut self) -> String {
        self.body.push_str("</svg>\n");
        self.body
    }
}

/// A coordinate to a hundredth, without a trailing zero or a negative zero, clamped to the range.
pub(crate) fn number(value: f64) -> String {
    let value = if value.is_nan() {
        0.0
    } else {
        value.clamp(-1.0e6, 1.0e6)
    };
    let mut text = format!("{value:.2}");
    while text.ends_with('0') {
        text.pop();
    }
    if text.ends_with('.') {
        text.pop();
    }
    if text == "-0" { "0".to_owned() } else { text }
}

/// Text for XML and HTML; characters that XML forbids become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// At most `limit` characters of `text`, with an ellipsis at the cut.
pub(crate) fn shorten(text: &str, limit: usize) -> String {
    if text.chars().count() <= limit {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(limit.saturating_sub(1)).collect();
    short.push('…');
    short
}

/// Estimated width of a text in the widest font of the stack, pixels.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let ems: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | 'I' | ' ' => 0.33,
            't' | 'f' | 'r' | '(' | ')' | '-' | '·' => 0.42,
            'm' | 'w' | 'M' | 'W' | '%' | '@' | '±' | '−' => 0.92,
            'A'..='Z' => 0.72,
            c if c.is_ascii() => 0.61,
            c if (c as u32) < 0x2000 => 0.65,
            _ => 1.0,
        })
        .sum();
    ems * size
}

/// The points without those within `tolerance` pixels of the line that they interrupt
/// (Ramer, Douglas and Peucker), and without repeats.
pub(crate) fn thin(points: &[Point], tolerance: f64) -> Vec<Point> {
    let mut distinct: Vec<Point> = Vec::with_capacity(points.len());
    for &point in points {
        if point.0.is_finite()
            && point.1.is_finite()
            && distinct
                .last()
                .is_none_or(|last| (last.0 - point.0).abs() + (last.1 - point.1).abs() > tolerance)
        {
            distinct.push(point);
        }
    }
    // The very end counts, however close to the previous point.
    if let (Some(&end), Some(kept)) = (points.last(), distinct.last_mut())
        && end.0.is_finite()
        && end.1.is_finite()
    {
        *kept = end;
    }
    if distinct.len() < 3 {
        return distinct;
    }
    let mut keep = vec![false; distinct.len()];
    keep[0] = true;
    keep[distinct.len() - 1] = true;
    let mut spans = vec![(0, distinct.len() - 1)];
    while let Some((first, last)) = spans.pop() {
        let (a, b) = (distinct[first], distinct[last]);
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length = libm::hypot(dx, dy);
        let mut worst = (tolerance, None);
        for (index, p) in distinct.iter().enumerate().take(last).skip(first + 1) {
            let off = if length > 0.0 {
                ((p.0 - a.0) * dy - (p.1 - a.1) * dx).abs() / length
            } else {
                libm::hypot(p.0 - a.0, p.1 - a.1)
            };
            if off > worst.0 {
                worst = (off, Some(index));
            }
        }
        if let Some(index) = worst.1 {
            keep[index] = true;
            spans.push((first, index));
            spans.push((index, last));
        }
    }
    distinct
        .into_iter()
        .zip(keep)
        .filter_map(|(point, kept)| kept.then_some(point))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_minus_zero() {
        assert_eq!(number(1.0), "1");
        assert_eq!(number(-0.001), "0");
        assert_eq!(number(2.504), "2.5");
        assert_eq!(number(f64::NAN), "0");
        assert_eq!(number(f64::INFINITY), "1000000");
        assert_eq!(number(100.0), "100");
    }

    #[test]
    fn names_cannot_break_out() {
        assert_eq!(
            escape("<script>\"&'\u{0}\u{1b}"),
            "&lt;script&gt;&quot;&amp;&#39;\u{fffd}\u{fffd}"
        );
    }

    #[test]
    fn thinning_keeps_corners_and_ends() {
        let straight: Vec<Point> = (0..100).map(|i| (f64::from(i), 0.0)).collect();
        assert_eq!(thin(&straight, 0.1), vec![(0.0, 0.0), (99.0, 0.0)]);
        let mut corner = straight.clone();
        corner.extend((1..50).map(|i| (99.0, f64::from(i))));
        assert_eq!(
            thin(&corner, 0.1),
            vec![(0.0, 0.0), (99.0, 0.0), (99.0, 49.0)]
        );
    }
}

//! Spreads of times or lengths, one row each, on a common axis.

use super::Axis;
use super::frame::{PlotFrame, WIDTH, colour, draw_limits};
use crate::palette::{INK, MUTED};
use crate::svg::{Anchor, Rect, TextStyle, shorten, text_width};

/// The spread of a sample: its order statistics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxSpread {
    /// Number of values.
    pub count: u64,
    /// Least value.
    pub least: f64,
    /// First percentile.
    pub p1: f64,
    /// Lower quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Upper quartile.
    pub q3: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest value.
    pub most: f64,
}

impl BoxSpread {
    /// The spread of `values`, which it sorts in place; `None` without finite values.
    ///
    /// Percentiles interpolate linearly in the sorted sample (type 7 of Hyndman
    /// and Fan, the default of R and `NumPy`).
    ///
    /// # Examples
    ///
    /// ```
    /// use fga_report::plot::BoxSpread;
    ///
    /// let spread = BoxSpread::of(&mut [4.0, 1.0, 3.0, 2.0]).unwrap();
    /// assert_eq!((spread.q1, spread.median, spread.q3), (1.75, 2.5, 3.25));
    /// ```
    pub fn of(values: &mut [f64]) -> Option<Self> {
        // Numbers that are not finite sort to the ends and are cut off.
        values.sort_by(f64::total_cmp);
        let first = values.iter().position(|v| v.is_finite())?;
        let last = values.iter().rposition(|v| v.is_finite())?;
        let finite = &values[first..=last];
        let at = |share: f64| {
            let place = share * (finite.len() - 1) as f64;
            let below = libm::floor(place);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within the sample"
            )]
            let index = below as usize;
            let low = finite[index];
            let high = finite[(index + 1).min(finite.len() - 1)];
            low + (high - low) * (place - below)
        };
        Some(Self {
            count: finite.len() as u64,
            least: finite[0],
            p1: at(0.01),
            q1: at(0.25),
            median: at(0.5),
            q3: at(0.75),
            p99: at(0.99),
            most: finite[finite.len() - 1],
        })
    }
}

/// One row of a [`BoxChart`].
#[derive(Debug, Clone, PartialEq)]
pub struct SpreadRow {
    /// Name on the left.
    pub name: String,
    /// The drawn statistics: box = quartiles, whiskers = 1st and 99th percentile, dot = largest value.
    pub spread: BoxSpread,
}

/// Rows of boxes along a common axis, for decision times on a logarithmic one.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxChart {
    /// Heading.
    pub title: String,
    /// The measured quantity.
    pub x: Axis,
    /// The rows, first on top.
    pub rows: Vec<SpreadRow>,
    /// Single values to compare with: value, name.
    pub limits: Vec<(f64, String)>,
}

impl BoxChart {
    /// Draws the chart; its height follows from the number of rows.
    pub fn to_svg(&self) -> String {
        let row_height = 34.0;
        let height = 46.0 + 74.0 + row_height * self.rows.len().max(3) as f64;
        let widest = self
            .rows
            .iter()
            .map(|r| text_width(&shorten(&r.name, 34), 12.5))
            .fold(40.0, f64::max);
        let left = (widest + 26.0).min(WIDTH * 0.45);
        let (mut svg, mut frame) = PlotFrame::begin(&self.title, &[], left, height);
        // Room for the medians on the right and the note at the foot.
        frame.area.width -= 64.0;
        frame.area.height -= 22.0;
        let area = frame.area;
        let all = self
            .rows
            .iter()
            .flat_map(|r| [r.spread.least.max(r.spread.p1), r.spread.most])
            .chain(self.limits.iter().map(|l| l.0));
        let x = frame.x(&self.x, all);
        frame.draw_x(&mut svg, &self.x, &x);
        draw_limits(&mut svg, &area, &x, &self.limits);
        for (index, row) in self.rows.iter().enumerate() {
            let y = area.y + area.height * (index as f64 + 0.5) / self.rows.len() as f64;
            let spread = &row.spread;
            svg.text(
                (area.x - 9.0, y + 4.0),
                &shorten(&row.name, 34),
                TextStyle::new(12.5, INK).anchor(Anchor::End),
            );
            let places = [
                spread.p1,
                spread.q1,
                spread.median,
                spread.q3,
                spread.p99,
                spread.most,
            ]
            .map(|value| x.at(value));
            let [
                Some(p1),
                Some(q1),
                Some(median),
                Some(q3),
                Some(p99),
                Some(most),
            ] = places
            else {
                continue;
            };
            let stroke = format!("stroke=\"{}\" stroke-width=\"1.6\"", colour(index));
            svg.line((p1, y), (q1, y), &stroke);
            svg.line((q3, y), (p99, y), &stroke);
            for end in [p1, p99] {
                svg.line((end, y - 5.0), (end, y + 5.0), &stroke);
            }
            svg.rect(
                &Rect::new(q1, y - 8.0, (q3 - q1).max(1.0), 16.0),
                &format!("fill=\"{}\" fill-opacity=\"0.3\" {stroke}", colour(index)),
            );
            svg.line(
                (median, y - 8.0),
                (median, y + 8.0),
                "stroke=\"#1f2328\" stroke-width=\"2.2\"",
            );
            svg.circle((most, y), 2.4, &format!("fill=\"{}\"", colour(index)));
            svg.text(
                (area.right() + 8.0, y + 4.0),
                &significant(spread.median),
                TextStyle::new(12.0, INK),
            );
        }
        svg.text(
            (area.right() + 8.0, area.y - 6.0),
            "median",
            TextStyle::new(11.0, MUTED),
        );
        svg.text(
            (WIDTH - 16.0, height - 10.0),
            "box: quartiles · whiskers: 1st and 99th percentile · dot: largest",
            TextStyle::new(11.0, MUTED).anchor(Anchor::End),
        );
        let empty = self.rows.is_empty();
        frame.finish(svg, &[], empty, |_, _, _| {})
    }
}

/// Three significant digits, without an exponent if that is short.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let decade = libm::floor(libm::log10(value.abs()));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a few decimals"
    )]
    let decimals = (2.0 - decade).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_numpy() {
        // numpy.percentile([15, 20, 35, 40, 50], [1, 25, 50, 75, 99])
        let mut values = [40.0, f64::NAN, 15.0, 50.0, 20.0, 35.0];
        let spread = BoxSpread::of(&mut values).unwrap();
        assert_eq!(spread.count, 5);
        assert!((spread.p1 - 15.2).abs() < 1e-12);
        assert_eq!((spread.q1, spread.median, spread.q3), (20.0, 35.0, 40.0));
        assert!((spread.p99 - 49.6).abs() < 1e-12);
        assert_eq!(BoxSpread::of(&mut [f64::NAN]), None);
    }

    #[test]
    fn three_significant_digits() {
        assert_eq!(significant(0.012_34), "0.0123");
        assert_eq!(significant(1.5), "1.50");
        assert_eq!(significant(1234.4), "1234");
    }
}

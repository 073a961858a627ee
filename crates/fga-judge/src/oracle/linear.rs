//! A small linear program: the largest t with t ≤ mⱼ + gⱼ·δ for all j and δ within a box.
//!
//! The simplex method on a condensed tableau; a dozen rows and seven columns.

/// Most unknowns.
pub(super) const UNKNOWNS: usize = 6;
/// Most rows gⱼ.
pub(super) const ROWS: usize = 20;
const WIDTH: usize = UNKNOWNS + 2;
const HEIGHT: usize = ROWS + UNKNOWNS + 1;
/// Far more exchanges than ever necessary.
const EXCHANGES: usize = 200;

/// One smooth function near the present point.
#[derive(Debug, Clone, Copy)]
pub(super) struct MarginRow {
    pub(super) value: f64,
    pub(super) gradient: [f64; UNKNOWNS],
}

/// The δ of the largest least value within `low..=high`, and the predicted value.
///
/// It uses at most [`ROWS`] rows and [`UNKNOWNS`] unknowns; a box with `low` = `high` fixes
/// an unknown.
#[expect(
    clippy::needless_range_loop,
    reason = "a tableau is read by row and column"
)]
pub(super) fn largest_least(
    rows: &[MarginRow],
    low: &[f64; UNKNOWNS],
    high: &[f64; UNKNOWNS],
) -> ([f64; UNKNOWNS], f64) {
    let count = rows.len().min(ROWS);
    let at_low =
        |row: &MarginRow| (0..UNKNOWNS).fold(row.value, |sum, k| sum + row.gradient[k] * low[k]);
    let floor = rows
        .iter()
        .take(count)
        .map(at_low)
        .fold(f64::INFINITY, f64::min);
    // Unknowns x = δ − low ≥ 0 and t' = t − floor ≥ 0 (column UNKNOWNS); the last column is the
    // right-hand side, the last row the cost.
    let mut table = [[0.0; WIDTH]; HEIGHT];
    let height = count + UNKNOWNS;
    for (j, row) in rows.iter().take(count).enumerate() {
        for k in 0..UNKNOWNS {
            table[j][k] = -row.gradient[k];
        }
        table[j][UNKNOWNS] = 1.0;
        table[j][WIDTH - 1] = at_low(row) - floor;
    }
    for k in 0..UNKNOWNS {
        table[count + k][k] = 1.0;
        table[count + k][WIDTH - 1] = (high[k] - low[k]).max(0.0);
    }
    table[height][UNKNOWNS] = -1.0;
    // The unknown of each column or row; slack variables count from WIDTH on.
    let mut column_of = [0; WIDTH - 1];
    let mut row_of = [0; HEIGHT];
    for (k, name) in column_of.iter_mut().enumerate() {
        *name = k;
    }
    for (j, name) in row_of.iter_mut().enumerate() {
        *name = WIDTH + j;
    }
    for _ in 0..EXCHANGES {
        let Some(column) = (0..WIDTH - 1)
            .filter(|&k| table[height][k] < -1e-10)
            .min_by(|&a, &b| table[height][a].total_cmp(&table[height][b]))
        else {
            break;
        };
        let ratio = |j: usize| table[j][WIDTH - 1] / table[j][column];
        let Some(row) = (0..height)
            .filter(|&j| table[j][column] > 1e-10)
            .min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)))
        else {
            break;
        };
        let pivot = table[row][column];
        for k in 0..WIDTH {
            if k != column {
                table[row][k] /= pivot;
            }
        }
        for j in 0..=height {
            if j != row {
                let factor = table[j][column];
                for k in 0..WIDTH {
                    if k != column {
                        table[j][k] -= factor * table[row][k];
                    }
                }
                table[j][column] = -factor / pivot;
            }
        }
        table[row][column] = 1.0 / pivot;
        core::mem::swap(&mut row_of[row], &mut column_of[column]);
    }
    let mut step = *low;
    let mut predicted = floor;
    for j in 0..height {
        let value = table[j][WIDTH - 1];
        match row_of[j] {
            k if k < UNKNOWNS => step[k] = (low[k] + value).clamp(low[k], high[k]),
            UNKNOWNS => predicted = floor + value,
            _ => {}
        }
    }
    (step, predicted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(value: f64, first: f64, second: f64) -> MarginRow {
        let mut gradient = [0.0; UNKNOWNS];
        gradient[0] = first;
        gradient[1] = second;
        MarginRow { value, gradient }
    }

    #[test]
    fn one_row_goes_to_the_corner_of_the_box() {
        let (step, value) = largest_least(&[row(1.0, 2.0, -3.0)], &[-0.5; 6], &[1.0; 6]);
        assert!((step[0] - 1.0).abs() < 1e-12 && (step[1] + 0.5).abs() < 1e-12);
        assert!((value - 4.5).abs() < 1e-12);
    }

    #[test]
    fn opposed_rows_meet_where_they_are_equal() {
        // t ≤ x, t ≤ 1 − x: largest 0.5 at x = 0.5.
        let rows = [row(0.0, 1.0, 0.0), row(1.0, -1.0, 0.0)];
        let (step, value) = largest_least(&rows, &[-1.0; 6], &[1.0; 6]);
        assert!((step[0] - 0.5).abs() < 1e-12 && (value - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_ridge_is_followed() {
        // t ≤ x + 0.1 y, t ≤ −x + 0.1 y: along y with x = 0.
        let rows = [row(0.0, 1.0, 0.1), row(0.0, -1.0, 0.1)];
        let (step, value) = largest_least(&rows, &[-1.0; 6], &[1.0; 6]);
        assert!(step[0].abs() < 1e-12 && (step[1] - 1.0).abs() < 1e-12);
        assert!((value - 0.1).abs() < 1e-12);
    }
}

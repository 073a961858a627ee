//! The quasi-random numbers of the futures: one fixed table, the same for all aircraft, steps and candidates, so that a
//! difference is one of candidates, not of luck.

/// Futures of an aircraft.
pub const FUTURES: usize = 28;

/// A Latin hypercube: each column is an order of the 28 strata, and no two columns correlate by more than 0.03, nor with the
/// order of the rows.
pub(crate) const TABLE: [[u8; 8]; FUTURES] = [
    [14, 18, 15, 8, 4, 15, 23, 23],
    [12, 10, 2, 5, 12, 22, 15, 15],
    [26, 8, 20, 27, 20, 1, 20, 8],
    [4, 19, 7, 26, 24, 12, 2, 11],
    [7, 3, 11, 12, 10, 8, 3, 14],
    [10, 2, 18, 17, 6, 27, 22, 16],
    [22, 5, 1, 23, 5, 14, 17, 22],
    [9, 17, 25, 6, 0, 6, 0, 20],
    [16, 27, 8, 0, 15, 0, 26, 2],
    [5, 6, 16, 11, 22, 2, 21, 10],
    [21, 12, 19, 3, 26, 24, 6, 24],
    [19, 23, 24, 25, 23, 16, 1, 17],
    [8, 25, 17, 14, 1, 11, 7, 5],
    [20, 13, 23, 20, 17, 26, 25, 3],
    [27, 22, 0, 7, 19, 17, 8, 7],
    [3, 26, 10, 24, 21, 23, 10, 19],
    [11, 15, 13, 4, 8, 13, 12, 26],
    [15, 9, 27, 9, 14, 21, 19, 4],
    [13, 7, 4, 10, 27, 4, 13, 13],
    [6, 24, 14, 2, 13, 20, 14, 6],
    [1, 14, 12, 21, 11, 9, 27, 12],
    [25, 4, 6, 13, 3, 25, 5, 0],
    [0, 11, 21, 15, 18, 18, 18, 18],
    [24, 20, 26, 19, 7, 5, 11, 9],
    [2, 1, 5, 18, 9, 10, 4, 1],
    [18, 0, 22, 1, 25, 7, 9, 21],
    [17, 21, 3, 16, 16, 19, 24, 25],
    [23, 16, 9, 22, 2, 3, 16, 27],
];

/// The middle of a stratum, in (0, 1).
pub(crate) fn unit(stratum: u8) -> f32 {
    (f32::from(stratum) + 0.5) / FUTURES as f32
}

/// A normal number of a stratum (Winitzki's approximation of the inverse error function, within 0.01).
pub(crate) fn normal(stratum: u8) -> f32 {
    let x = 2.0 * unit(stratum) - 1.0;
    let log = libm::logf(1.0 - x * x);
    let half = 4.3307 + 0.5 * log;
    let root = libm::sqrtf(libm::sqrtf(half * half - log / 0.147) - half);
    libm::copysignf(core::f32::consts::SQRT_2 * root, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_column_has_each_stratum_once() {
        for column in 0..8 {
            let strata = TABLE
                .iter()
                .fold(0_u32, |seen, row| seen | 1 << row[column]);
            assert_eq!(strata, (1 << FUTURES) - 1, "{column}");
        }
    }

    /// Quantiles by a table of the normal distribution.
    #[test]
    fn normal_numbers_are_quantiles() {
        for (stratum, quantile) in [(0, -2.1), (3, -1.15), (13, -0.0448), (27, 2.1)] {
            assert!(
                (normal(stratum) - quantile).abs() < 0.01,
                "{}",
                normal(stratum)
            );
        }
    }
}

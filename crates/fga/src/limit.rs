//! Keeping a number within limits without a panic.

/// Largest magnitude of a coordinate (metres) or a velocity (metres per second) that is accepted:
/// far beyond any flight, and small enough that no product of four overflows.
pub const LARGEST: f64 = 1e15;

/// Numbers that can be kept within limits.
pub trait Limit {
    /// Within [low, high]. Unlike `f64::clamp` it never panics: limits in the wrong order give the
    /// upper one, a limit that is not a number does not bind.
    fn limited(self, low: f64, high: f64) -> f64;
}

impl Limit for f64 {
    fn limited(self, low: f64, high: f64) -> f64 {
        self.max(low).min(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_hold_and_nothing_panics() {
        assert_eq!(2.0.limited(0.0, 1.0), 1.0);
        assert_eq!((-2.0).limited(0.0, 1.0), 0.0);
        assert_eq!(0.5.limited(0.0, 1.0), 0.5);
        assert_eq!(0.5.limited(1.0, 0.0), 0.0);
        assert_eq!(0.5.limited(f64::NAN, f64::NAN), 0.5);
    }
}

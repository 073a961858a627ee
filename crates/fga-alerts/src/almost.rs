//! When two computed numbers count as one.
//!
//! Whether an interval has a length, and on which side of a band edge a value lies, must not
//! depend on the last bits of a product. The resolutions are the same as in DAIDALUS, so that
//! decisions at an edge agree.

/// Largest difference of two numbers that count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Closeness {
    /// The rounding of a short computation: 16,348 units in the last place, about 4e-12 of the
    /// value; 1e-13 beside zero.
    Rounding,
    /// The resolution of band edges: 2^40 units in the last place, about 2e-4 of the value; 1e-5
    /// beside zero.
    Edge,
}

impl Closeness {
    const fn units_in_last_place(self) -> u64 {
        match self {
            Self::Rounding => 16_348,
            Self::Edge => 1 << 40,
        }
    }

    const fn beside_zero(self) -> f64 {
        match self {
            Self::Rounding => 1e-13,
            Self::Edge => 1e-5,
        }
    }

    /// Whether `a` and `b` count as one.
    pub(crate) fn same(self, a: f64, b: f64) -> bool {
        if a == b || !a.is_finite() || !b.is_finite() {
            return a == b;
        }
        if (a == 0.0 || b == 0.0) && a.abs().max(b.abs()) < self.beside_zero() {
            return true;
        }
        place(a).abs_diff(place(b)) <= self.units_in_last_place()
    }

    /// Whether `a` is below `b` by more than the resolution.
    pub(crate) fn less(self, a: f64, b: f64) -> bool {
        a < b && !self.same(a, b)
    }

    /// Whether `a` is below `b` or counts as the same.
    pub(crate) fn at_most(self, a: f64, b: f64) -> bool {
        a <= b || self.same(a, b)
    }
}

/// The index of a finite number in the order of all floats, from zero.
fn place(value: f64) -> i64 {
    #[expect(
        clippy::cast_possible_wrap,
        reason = "the bits without the sign are below 2^63"
    )]
    let magnitude = value.abs().to_bits() as i64;
    if value.is_sign_negative() {
        -magnitude
    } else {
        magnitude
    }
}

/// The remainder of `value` in `[0, modulus)`; `value` itself where `modulus` is zero.
pub(crate) fn wrapped(value: f64, modulus: f64) -> f64 {
    if modulus <= 0.0 {
        return value;
    }
    let rest = value - libm::floor(value / modulus) * modulus;
    if Closeness::Rounding.same(rest, modulus) {
        0.0
    } else {
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolution_is_relative_and_absolute_beside_zero() {
        let rounding = Closeness::Rounding;
        assert!(rounding.same(100.0, 100.0 * (1.0 + 1e-12)));
        assert!(!rounding.same(100.0, 100.0 * (1.0 + 1e-11)));
        assert!(rounding.same(0.0, -1e-14) && !rounding.same(0.0, 1e-12));
        // Two small numbers, neither of them zero, compare by their indices.
        assert!(!rounding.same(1e-14, 2e-14));
        assert!(Closeness::Edge.same(1.0, 1.000_1) && !Closeness::Edge.same(1.0, 1.001));
        assert!(!rounding.same(f64::NAN, f64::NAN) && !rounding.less(f64::NAN, 1.0));
        assert!(rounding.same(f64::INFINITY, f64::INFINITY));
        assert!(rounding.less(-1.0, 1.0) && rounding.at_most(1.0, 1.0));
    }

    #[test]
    fn remainders_are_never_the_modulus() {
        let turn = core::f64::consts::TAU;
        assert_eq!(wrapped(-1e-17, turn), 0.0);
        assert_eq!(wrapped(-1.0, 0.0), -1.0);
        assert!((wrapped(-1.0, turn) - (turn - 1.0)).abs() < 1e-15);
    }
}

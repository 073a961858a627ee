//! Complex numbers: horizontal vectors, x east and y north.

use core::ops::{Add, Mul, Sub};

use fga_proof::Vec3;

/// A horizontal vector x + iy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Complex {
    pub(crate) x: f32,
    pub(crate) y: f32,
}

impl Complex {
    pub(crate) const ZERO: Self = Self::new(0.0, 0.0);

    pub(crate) const fn new(x: f32, y: f32) -> Self {
        Self { x, y }
    }

    /// The horizontal part of a vector.
    pub(crate) const fn of(vector: Vec3) -> Self {
        Self::new(vector.x as f32, vector.y as f32)
    }

    /// The unit vector at an angle, radians.
    pub(crate) fn unit(angle_rad: f32) -> Self {
        let (y, x) = libm::sincosf(angle_rad);
        Self::new(x, y)
    }

    pub(crate) fn conj(self) -> Self {
        Self::new(self.x, -self.y)
    }

    pub(crate) fn squared(self) -> f32 {
        self.x * self.x + self.y * self.y
    }

    /// The vector turned left by a quarter.
    pub(crate) fn left(self) -> Self {
        Self::new(-self.y, self.x)
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(
            self.x * other.x - self.y * other.y,
            self.x * other.y + self.y * other.x,
        )
    }
}

impl Mul<f32> for Complex {
    type Output = Self;
    fn mul(self, by: f32) -> Self {
        Self::new(self.x * by, self.y * by)
    }
}

/// The displacements by a unit velocity, and by a unit acceleration, that turn at a rate, radians per second, for a time,
/// seconds: (e^iωt − 1) / iω and (e^iωt − 1 − iωt) / (iω)².
pub(crate) fn turned(rate_radps: f32, time_s: f32) -> (Complex, Complex) {
    let angle = rate_radps * time_s;
    let (sin, cos) = libm::sincosf(angle);
    // Below this angle the series is exact to single precision.
    if angle.abs() < 0.1 {
        let square = angle * angle;
        let first = Complex::new(1.0 - square / 6.0, angle * (0.5 - square / 24.0));
        let second = Complex::new(0.5 - square / 24.0, angle * (1.0 / 6.0 - square / 120.0));
        return (first * time_s, second * (time_s * time_s));
    }
    let first = Complex::new(sin / angle, (1.0 - cos) / angle);
    // (first − 1) / iθ
    let second = Complex::new(first.y / angle, (1.0 - first.x) / angle);
    (first * time_s, second * (time_s * time_s))
}

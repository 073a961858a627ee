//! A piece of flight with constant course rate and constant climb rate, in closed form.

use fga_proof::Vec3;

/// A piece of flown path: course and climb angle change linearly in time (Eq. 10–12 integrated
/// exactly), carried along by a constant wind.
///
/// With cos θ · cos ψ = ½[cos(ψ+θ) + cos(ψ−θ)] each coordinate is the integral of a cosine or sine
/// of an angle that is linear in time: T · sinc(ωT/2) times its value at half time, which holds
/// for rates near zero as well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Its start, seconds since the start of the run.
    pub start_s: f64,
    /// Its duration, seconds.
    pub duration_s: f64,
    /// Its first position, metres over the ground.
    pub position_m: Vec3,
    /// Course through the air at its start, radians.
    pub course_rad: f64,
    /// Climb angle through the air at its start, radians.
    pub climb_rad: f64,
    /// Rate of the course, radians per second, positive to the left.
    pub course_rate_radps: f64,
    /// Rate of the climb angle, radians per second.
    pub climb_rate_radps: f64,
    /// Total airspeed, metres per second.
    pub airspeed_mps: f64,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
}

/// sin(x)/x, by its series where the quotient loses digits.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        libm::sin(x) / x
    }
}

/// The unit vector of a course and a climb angle (Eq. 10–12 with V = 1).
fn direction(course_rad: f64, climb_rad: f64) -> Vec3 {
    let (sin_course, cos_course) = libm::sincos(course_rad);
    let (sin_climb, cos_climb) = libm::sincos(climb_rad);
    Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb)
}

impl Arc {
    /// Displacement through the air `after_s` seconds into the arc, metres.
    fn air_displacement_m(&self, after_s: f64) -> Vec3 {
        let (p, q) = (self.course_rate_radps, self.climb_rate_radps);
        if p == 0.0 && q == 0.0 {
            return direction(self.course_rad, self.climb_rad) * (self.airspeed_mps * after_s);
        }
        let half = 0.5 * after_s;
        let course = self.course_rad + p * half;
        let climb = self.climb_rad + q * half;
        if q == 0.0 {
            let (sin_climb, cos_climb) = libm::sincos(climb);
            let (sin_course, cos_course) = libm::sincos(course);
            let chord = self.airspeed_mps * after_s * sinc(p * half) * cos_climb;
            return Vec3::new(
                chord * cos_course,
                chord * sin_course,
                self.airspeed_mps * after_s * sin_climb,
            );
        }
        let distance = self.airspeed_mps * after_s;
        let (sin_sum, cos_sum) = libm::sincos(course + climb);
        let (sin_difference, cos_difference) = libm::sincos(course - climb);
        let sum = 0.5 * distance * sinc((p + q) * half);
        let difference = 0.5 * distance * sinc((p - q) * half);
        Vec3::new(
            sum * cos_sum + difference * cos_difference,
            sum * sin_sum + difference * sin_difference,
            distance * sinc(q * half) * libm::sin(climb),
        )
    }

    /// Whether neither the course nor the climb angle changes.
    pub fn is_straight(&self) -> bool {
        self.course_rate_radps == 0.0 && self.climb_rate_radps == 0.0
    }

    /// Position over the ground `after_s` seconds into the arc, metres.
    pub fn position_at_m(&self, after_s: f64) -> Vec3 {
        self.position_m + self.air_displacement_m(after_s) + self.wind_mps * after_s
    }

    /// Position over the ground at its end, metres.
    pub fn end_m(&self) -> Vec3 {
        self.position_at_m(self.duration_s)
    }

    /// Upper bound of the magnitude of the acceleration, metres per second squared:
    /// V·√(ψ̇² cos²θ + θ̇²) ≤ V·√(ψ̇² + θ̇²).
    pub fn acceleration_bound_mps2(&self) -> f64 {
        self.airspeed_mps
            * libm::sqrt(
                self.course_rate_radps * self.course_rate_radps
                    + self.climb_rate_radps * self.climb_rate_radps,
            )
    }

    /// Upper bound of the ground speed, metres per second.
    pub fn speed_bound_mps(&self) -> f64 {
        self.airspeed_mps + self.wind_mps.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Eq. 10–12 by the classical Runge–Kutta rule in small steps: an independent derivation.
    fn integrated(arc: &Arc, after_s: f64) -> Vec3 {
        let steps = 400;
        let h = after_s / f64::from(steps);
        let rate = |t: f64| {
            let course_rad = arc.course_rad + arc.course_rate_radps * t;
            let climb_rad = arc.climb_rad + arc.climb_rate_radps * t;
            direction(course_rad, climb_rad) * arc.airspeed_mps + arc.wind_mps
        };
        let mut position = arc.position_m;
        for k in 0..steps {
            let t = f64::from(k) * h;
            position += (rate(t) + rate(t + h / 2.0) * 4.0 + rate(t + h)) * (h / 6.0);
        }
        position
    }

    proptest! {
        #[test]
        fn closed_form_agrees_with_integration(
            course in -7.0..7.0f64,
            climb in -0.6..0.6f64,
            p in prop_oneof![Just(0.0), -1.0..1.0f64, -1e-7..1e-7f64],
            q in prop_oneof![Just(0.0), -0.3..0.3f64, -1e-7..1e-7f64],
            after in 0.0..3.0f64,
        ) {
            let arc = Arc {
                start_s: 0.0,
                duration_s: 3.0,
                position_m: Vec3::new(1.0, -2.0, 3.0),
                course_rad: course,
                climb_rad: climb,
                course_rate_radps: p,
                climb_rate_radps: q,
                airspeed_mps: 15.0,
                wind_mps: Vec3::new(2.0, -1.0, 0.0),
            };
            prop_assert!(arc.position_at_m(after).distance(integrated(&arc, after)) < 1e-8);
        }
    }

    #[test]
    fn a_half_circle_ends_two_radii_to_the_left() {
        let arc = Arc {
            start_s: 0.0,
            duration_s: core::f64::consts::PI * 2.0,
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            course_rate_radps: 0.5,
            climb_rate_radps: 0.0,
            airspeed_mps: 15.0,
            wind_mps: Vec3::ZERO,
        };
        assert!(arc.end_m().distance(Vec3::new(0.0, 60.0, 0.0)) < 1e-12);
    }
}

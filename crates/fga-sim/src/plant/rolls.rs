//! What a roll computes for its next step.

use fga::Vec3;

/// What a roll computes for its next step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PlantRolls {
    /// The end of the last step.
    pub(super) last: Option<RollMoment>,
    /// A course rate, radians per second, and its bank angle, radians.
    pub(super) full: (f64, f64),
}

/// A moment of a roll: the end of a step and the beginning of the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct RollMoment {
    pub(super) position_m: Vec3,
    pub(super) course_rad: f64,
    pub(super) climb_rad: f64,
    pub(super) bank_rad: f64,
    /// Tangent of the bank angle.
    pub(super) bank_tan: f64,
    /// Sine and cosine of the course and of the climb angle.
    pub(super) course: (f64, f64),
    pub(super) climb: (f64, f64),
}

impl RollMoment {
    pub(super) fn direction(&self) -> Vec3 {
        let ((sin_course, cos_course), (sin_climb, cos_climb)) = (self.course, self.climb);
        Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb)
    }
}

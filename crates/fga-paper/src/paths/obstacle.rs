//! A round obstacle in the way.

use fga::limit::Limit as _;
use fga::maneuver::{Maneuver, Stage};
use fga::search::Side;

pub(super) fn usable(turn_radius_m: f64, radius_m: f64, across_m: f64) -> bool {
    let positive = |value: f64| value.is_finite() && value > 0.0 && value <= 1e15;
    positive(turn_radius_m) && positive(radius_m) && (0.0..radius_m).contains(&across_m)
}

/// α, the largest deviation from the initial course, radians (Alg. 4 line 21, Fig. 8 and 24):
/// cos α = (ρ + s) / (ρ + `d_m`).
///
/// `None` unless ρ and `d_m` are positive and 0 ≤ s < `d_m`.
pub fn deviation_rad(turn_radius_m: f64, radius_m: f64, across_m: f64) -> Option<f64> {
    let share = (turn_radius_m + across_m) / (turn_radius_m + radius_m);
    usable(turn_radius_m, radius_m, across_m).then(|| libm::acos(share.limited(-1.0, 1.0)))
}

/// The latest manoeuvre round a static obstacle: away, round it the other way, back to the initial
/// course and line (Fig. 8, Fig. 24, Alg. 4 lines 33–38).
///
/// With ρ ≤ `d_m` (Fig. 8(a)) the aircraft follows the protected circle and the manoeuvre is
/// symmetric: α, 2α, α. With ρ > `d_m` (Fig. 8(b)) it cannot; it flies the circle of radius ρ that
/// touches the protected one from outside at the tangent point B, and comes back further out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundObstacle {
    /// Turn away, to the side of the pass: radius ρ, angle α.
    pub away: PathArc,
    /// Turn round the obstacle, to the other side: radius max(ρ, `d_m`).
    pub around: PathArc,
    /// Turn back onto the initial line, to the side of the pass: radius ρ.
    pub back: PathArc,
    /// Along-track distance to abeam at which it begins, metres: the tangent distance of Eq. 17.
    pub before_m: f64,
    /// Along-track distance from abeam at which it ends, metres.
    pub after_m: f64,
    /// Path from the begin to abeam, metres: `L_1`, or `L_1'` of Fig. 8(b).
    pub to_abeam_m: f64,
    /// Distance of the path from the initial line at its farthest, metres.
    pub widest_m: f64,
}

impl RoundObstacle {
    /// For a turn radius ρ, a protected radius `d_m` and the miss distance s.
    ///
    /// `None` unless ρ and `d_m` are positive and 0 ≤ s < `d_m`.
    pub fn new(turn_radius_m: f64, radius_m: f64, across_m: f64) -> Option<Self> {
        let alpha_rad = deviation_rad(turn_radius_m, radius_m, across_m)?;
        let (sin, cos) = libm::sincos(alpha_rad);
        let around_m = radius_m.max(turn_radius_m);
        // Distance of the second circle's centre from the obstacle, beyond it.
        let past_m = around_m - radius_m;
        let to_abeam_rad = alpha_rad - libm::asin((past_m * sin / around_m).limited(-1.0, 1.0));
        let widest_m = around_m - past_m * cos - across_m;
        // Down again by the two arcs: (ρ_around + ρ)(1 − cos δ).
        let share = 1.0 - widest_m / (around_m + turn_radius_m);
        let delta_rad = libm::acos(share.limited(-1.0, 1.0));
        let sum_m = around_m + turn_radius_m;
        Some(Self {
            away: PathArc {
                radius_m: turn_radius_m,
                angle_rad: alpha_rad,
            },
            around: PathArc {
                radius_m: around_m,
                angle_rad: alpha_rad + delta_rad,
            },
            back: PathArc {
                radius_m: turn_radius_m,
                angle_rad: delta_rad,
            },
            before_m: (turn_radius_m + radius_m) * sin,
            after_m: past_m * sin + sum_m * libm::sin(delta_rad),
            to_abeam_m: turn_radius_m * alpha_rad + around_m * to_abeam_rad,
            widest_m,
        })
    }

    /// Length of the whole manoeuvre, metres.
    pub fn length_m(&self) -> f64 {
        self.away.length_m() + self.around.length_m() + self.back.length_m()
    }

    /// Its excess over the straight line, metres.
    pub fn extra_path_m(&self) -> f64 {
        self.length_m() - self.before_m - self.after_m
    }

    /// The manoeuvre as stages that begin `start_s` seconds from the decision, for an aircraft on
    /// `course_rad` whose tightest turn has the radius `least_radius_m` (at most that of `away`);
    /// `side` is the side of the pass.
    ///
    /// `None` where a number is not finite or the radius or the speed is not positive.
    pub fn maneuver(
        &self,
        start_s: f64,
        course_rad: f64,
        climb_rad: f64,
        side: Side,
        (airspeed_mps, least_radius_m): (f64, f64),
    ) -> Option<Maneuver> {
        let level_mps = airspeed_mps * libm::cos(climb_rad);
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !positive(level_mps) || !positive(least_radius_m) || !course_rad.is_finite() {
            return None;
        }
        if !start_s.is_finite() || start_s < 0.0 {
            return None;
        }
        let sign = side.sign();
        let courses = [
            course_rad + sign * self.away.angle_rad,
            course_rad - sign * self.back.angle_rad,
            course_rad,
        ];
        let mut maneuver = Maneuver::hold();
        let mut at_s = start_s;
        for (arc, course_rad) in [self.away, self.around, self.back].iter().zip(courses) {
            maneuver.push(Stage {
                start_s: at_s,
                course_rad,
                climb_rad,
                rate_share: (least_radius_m / arc.radius_m).min(1.0),
            });
            at_s += arc.length_m() / level_mps;
        }
        Some(maneuver)
    }
}

/// An arc of a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathArc {
    /// Radius, metres.
    pub radius_m: f64,
    /// Angle of the arc, radians, positive.
    pub angle_rad: f64,
}

impl PathArc {
    /// Length, metres.
    pub fn length_m(&self) -> f64 {
        self.radius_m * self.angle_rad
    }
}

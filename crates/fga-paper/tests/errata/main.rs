//! Each slip of the paper as a concrete case: the printed formula gives a wrong answer, the
//! corrected one the right answer. The right answer comes from neither formula: it is worked out by
//! hand, or flown in fine steps. `docs/errata.md` lists them all.

mod algorithm_4;
mod bounds;
mod detection;
mod selection;
mod timing;

use fga::Vec3;
use fga::certificate::Hazard;
use fga::situation::{Ownship, ProtectedVolume};

/// An aircraft at the origin along +x at 15 m/s.
fn ownship() -> Ownship {
    Ownship {
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 15.0,
    }
}

/// A sphere of 30 m.
fn ball(x: f64, y: f64, velocity_mps: Vec3) -> Hazard {
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    Hazard::exact(1, Vec3::new(x, y, 0.0), velocity_mps, volume)
}

/// Flies level along +x from the origin, from `start_s` on a turn of `turn_radius_m` by at most
/// `turn_rad` (left positive), then straight: the least distance to a point that starts at
/// `target_m`, in steps of a millisecond, by adding up chords of the exact circle.
fn flown_separation(
    speed_mps: f64,
    turn_radius_m: f64,
    turn_rad: f64,
    start_s: f64,
    (target_m, target_mps): (Vec3, Vec3),
    duration_s: f64,
) -> f64 {
    let step_s = 0.001;
    let (mut position, mut course, mut at, mut least) = (Vec3::ZERO, 0.0_f64, 0.0, f64::INFINITY);
    while at < duration_s {
        let target = target_m + target_mps * at;
        least = least.min(position.distance(target));
        let turning = at >= start_s && course.abs() < turn_rad.abs();
        let turned = if turning {
            turn_rad.signum() * speed_mps * step_s / turn_radius_m
        } else {
            0.0
        };
        let mean = course + turned / 2.0;
        position += Vec3::new(mean.cos(), mean.sin(), 0.0) * (speed_mps * step_s);
        course += turned;
        at += step_s;
    }
    least
}

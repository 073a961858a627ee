//! A `Decision` as set-points of an autopilot: bank angle, course rate and altitude.
//!
//! The command of a decision is a list of stages in time. This program makes one decision against an intruder ahead and prints
//! the set-points of the next seconds, as a flight controller would track them.
//!
//! `cargo run --release -p fga --example set_points`

use fga::Vec3;
use fga::avoider::{Avoider, Settings};
use fga::maneuver::Maneuver;
use fga::situation::{Mission, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;

/// Standard gravity, metres per second squared.
const GRAVITY_MPS2: f64 = 9.806_65;

/// The input of an autopilot.
struct SetPoint {
    /// Bank angle, radians, positive in a left turn.
    bank_rad: f64,
    /// Course rate, radians per second, positive to the left.
    course_rate_radps: f64,
    /// Target altitude, metres.
    altitude_m: f64,
}

/// The set-point for this moment: full rate towards the course of the present stage, and the altitude that its climb
/// angle reaches in `ahead_s`.
fn set_point(
    command: &Maneuver,
    own: &Ownship,
    vehicle: &Vehicle,
    elapsed_s: f64,
    ahead_s: f64,
) -> SetPoint {
    let stage = command
        .stages()
        .iter()
        .rfind(|stage| stage.start_s <= elapsed_s);
    let (course_rad, climb_rad, share) = stage
        .map_or((own.course_rad, own.climb_rad, 1.0), |stage| {
            (stage.course_rad, stage.climb_rad, stage.rate_share)
        });
    let left_rad = course_rad - own.course_rad;
    let largest = share * vehicle.course_rate_radps();
    // Proportional near the end, so that the turn rolls out on its course.
    let course_rate_radps = (2.0 * left_rad).clamp(-largest, largest);
    SetPoint {
        bank_rad: (own.airspeed_mps * course_rate_radps / GRAVITY_MPS2).atan(),
        course_rate_radps,
        altitude_m: own.position_m.z + own.airspeed_mps * climb_rad.sin() * ahead_s,
    }
}

fn main() -> Result<(), fga::avoider::SettingsError> {
    let vehicle = Vehicle::table_4();
    let mut avoider = Avoider::new(Settings::default(), vehicle)?;
    let mut own = Ownship {
        position_m: Vec3::new(0.0, 0.0, 100.0),
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: vehicle.airspeed_mps,
    };
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let ahead = Vec3::new(90.0, 5.0, 100.0);
    let obstacles = [Obstacle::straight(1, ahead, Vec3::ZERO, volume)];
    let decision = avoider.step(&Situation {
        time_s: 0.0,
        ownship: own,
        obstacles: Obstacles::Rows(&obstacles),
        mission: Mission::new(&[own.position_m, Vec3::new(1000.0, 0.0, 100.0)]),
        wind_mps: Vec3::ZERO,
    });
    println!("{:?}: {:?}", decision.state, decision.record.reason);
    println!(" time  bank    course rate  altitude");
    let period_s = 0.2;
    for step in 0..12 {
        let elapsed_s = f64::from(step) * period_s;
        let point = set_point(&decision.command, &own, &vehicle, elapsed_s, period_s);
        println!(
            "{elapsed_s:4.1} s {:6.1}° {:8.1}°/s  {:7.1} m",
            point.bank_rad.to_degrees(),
            point.course_rate_radps.to_degrees(),
            point.altitude_m
        );
        // An autopilot would measure this; here the aircraft follows at once.
        own.course_rad += point.course_rate_radps * period_s;
        own.position_m.z = point.altitude_m;
    }
    Ok(())
}

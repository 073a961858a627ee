//! One decision by expected cost, about an aircraft that reports by the least ADS-B that is permitted.
//! `cargo run -p fga --example beliefs`.

use fga::avoider::belief::{BeliefAvoider, Errors};
use fga::avoider::{Settings, SettingsError};
use fga::situation::{Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::{Vec3, vehicle::Vehicle};

fn main() -> Result<(), SettingsError> {
    let vehicle = Vehicle::from_bank(28.0, 0.6)?;
    // Position within 92.6 m and velocity within 10 m/s in 95 of 100 reports.
    let errors = Errors::of_adsb(8, 1);
    let mut avoider = BeliefAvoider::new(Settings::default(), vehicle, errors)?;
    let leg = [Vec3::new(0.0, 0.0, 300.0), Vec3::new(9000.0, 0.0, 300.0)];
    let well_clear = ProtectedVolume::Cylinder {
        radius_m: 609.6,
        half_height_m: 76.2,
    };
    let (position_m, velocity_mps) = (Vec3::new(2500.0, 100.0, 290.0), Vec3::new(-40.0, 0.0, 0.0));
    let aircraft = Obstacle {
        movement: Movement::CREWED,
        ..Obstacle::straight(7, position_m, velocity_mps, well_clear)
    };
    let decision = avoider.step(&Situation {
        time_s: 0.0,
        ownship: Ownship {
            position_m: leg[0],
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: vehicle.airspeed_mps,
        },
        obstacles: Obstacles::Rows(&[aircraft]),
        mission: Mission::new(&leg),
        wind_mps: Vec3::ZERO,
    });
    let (Some(hold), Some(flies)) = (decision.record.p_loss_hold, decision.record.p_loss) else {
        panic!("an aircraft ahead is weighed");
    };
    println!("chance of a loss of well clear: {hold:.2} on the mission, {flies:.2} as it flies");
    assert!(hold > 0.5 && flies < 0.1);
    Ok(())
}

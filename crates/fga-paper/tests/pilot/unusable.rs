//! Numbers that cannot be used.

use fga::Vec3;
use fga::avoider::{SettingsError, Start};
use fga::vehicle::Vehicle;
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};

use crate::flight::{Flies as _, sphere, vehicle};
use crate::policies::POLICIES;

#[test]
fn an_obstacle_with_unusable_numbers_is_left_out() {
    for policy in POLICIES {
        let mut plain = policy.flight(vehicle(), 1.0, 300.0);
        let mut spoiled = policy.flight(vehicle(), 1.0, 300.0);
        let ahead = sphere(7, Vec3::new(200.0, 5.0, 0.0), Vec3::ZERO, 30.0);
        let with = [
            sphere(1, Vec3::new(f64::NAN, 0.0, 0.0), Vec3::ZERO, 30.0),
            ahead,
            sphere(2, Vec3::X * 100.0, Vec3::Y * f64::NEG_INFINITY, 30.0),
            sphere(3, Vec3::X * 100.0, Vec3::ZERO, -1.0),
            sphere(4, Vec3::X * 100.0, Vec3::ZERO, f64::NAN),
        ];
        for _ in 0..20 {
            let clean = plain.cycle(&mut [ahead]);
            assert_eq!(spoiled.cycle(&mut with.clone()), clean, "{policy:?}");
        }
    }
}

#[test]
fn limits_and_settings_that_are_not_numbers_are_refused() {
    let refused = |change: &dyn Fn(&mut PaperSettings, &mut Vehicle)| {
        let mut settings = PaperSettings::new(Rule::Circle);
        let mut vehicle = vehicle();
        change(&mut settings, &mut vehicle);
        let error: SettingsError = PaperPilot::new(settings, vehicle).unwrap_err();
        error.name
    };
    assert_eq!(refused(&|s, _| s.horizon_s = f64::INFINITY), "horizon_s");
    assert_eq!(refused(&|s, _| s.margin_m = f64::NAN), "margin_m");
    assert_eq!(
        refused(&|s, _| s.surveillance_radius_m = f64::NAN),
        "surveillance_radius_m"
    );
    assert_eq!(
        refused(&|s, _| s.grid.heading_step_rad = 0.0),
        "grid_heading_step_rad"
    );
    assert_eq!(refused(&|_, v| v.airspeed_mps = f64::NAN), "airspeed_mps");
    assert_eq!(
        refused(&|s, _| s.rule = Rule::Corrected(Start::Score(1.5))),
        "C_s"
    );
}

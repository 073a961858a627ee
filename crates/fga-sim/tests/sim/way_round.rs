//! The policy `circle` keeps a disc in every wind, or says beforehand that it cannot.

use core::f64::consts::FRAC_PI_4;
use std::path::Path;

use fga_files::TomlText;
use fga_sim::engine::{Engine, Outcome};
use fga_sim::plan::Plan;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::{scenario, way_round};

fn vehicle(name: &str) -> VehicleModel {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vehicles");
    VehicleModel::read(&folder.join(name)).unwrap()
}

/// One leg with a disc in its way.
fn plan(model: &VehicleModel, radius_m: f64, aside_m: f64, wind_mps: [f64; 2]) -> Plan {
    let [east, north] = wind_mps;
    let text = format!(
        "name = 'disc'\nduration_s = 2000\n[mission]\nwaypoints_m = [[0, 0, 100], [2400, 0, 100]]\n\
         [wind]\neast_mps = {east:?}\nnorth_mps = {north:?}\n\
         [[obstacle]]\nname = 'disc'\nkind = 'natural-barrier'\nposition_m = [1100, {aside_m:?}, 100]\nradius_m = {radius_m:?}\n"
    );
    let text = TomlText::new(Path::new("disc.toml"), &text);
    scenario::parse(text, Some(model.clone())).unwrap()
}

fn circle() -> PolicyChoice {
    PolicyChoice::parse("circle", None).unwrap()
}

/// The separation judges: code of its own over continuous time.
fn fly(plan: &Plan) -> Outcome {
    let mut pilot = circle()
        .pilot(&plan.world.settings, &plan.world.vehicle)
        .unwrap();
    Engine::new().fly(&plan.world, pilot.as_mut(), &mut ())
}

#[test]
fn d8_circle_keeps_its_disc_in_every_wind_or_refuses_before_the_flight() {
    let mut late = vehicle("rascal-110.toml");
    late.vehicle.response.dead_time_s = 0.25;
    let mut near = vehicle("rascal-110.toml");
    near.settings.avoider.surveillance_radius_m = 380.0;
    let models = [
        ("rascal", vehicle("rascal-110.toml")),
        ("ideal", {
            let mut model = vehicle("paper-planar.toml");
            model.settings.avoider.surveillance_radius_m = 1000.0;
            model
        }),
        ("dead time", late),
        ("seen at 380 m", near),
    ];
    let (mut flown, mut refused) = (0, 0);
    for (name, model) in &models {
        for radius_m in [30.0, 60.0, 150.0, 300.0] {
            for (strength, sides) in [(0.0, 1_u32), (0.4, 4), (0.8, 8)] {
                for side in 0..sides {
                    let speed_mps = strength * model.vehicle.airspeed_mps;
                    let angle = f64::from(side) * FRAC_PI_4 * 8.0 / f64::from(sides);
                    let wind_mps = [speed_mps * angle.cos(), speed_mps * angle.sin()];
                    let aside_m = [0.0, -0.7, 0.4][side as usize % 3] * radius_m;
                    let plan = plan(model, radius_m, aside_m, wind_mps);
                    let case =
                        format!("{name}, {radius_m} m, {aside_m} m aside, wind {wind_mps:?}");
                    if let Some(refusal) = way_round::refusal(&circle(), &plan) {
                        refused += 1;
                        assert_eq!(*name, "seen at 380 m", "{case}: {refusal}");
                        assert!(refusal.contains("which is known 380 m before"), "{refusal}");
                        continue;
                    }
                    flown += 1;
                    let outcome = fly(&plan);
                    assert!(outcome.separated(), "{case}: {outcome:?}");
                    assert!(outcome.mission_flown, "{case}: {outcome:?}");
                }
            }
        }
    }
    assert!(
        flown > 150 && refused > 0,
        "{flown} flown, {refused} refused"
    );
}

#[test]
fn d8_a_wind_that_it_cannot_fly_against_is_refused() {
    let plan = plan(&vehicle("rascal-110.toml"), 150.0, 0.0, [-21.9, 0.0]);
    let refusal = way_round::refusal(&circle(), &plan).unwrap();
    assert!(
        refusal.starts_with("policy circle cannot keep 150 m from disc in 21.9 m/s of wind"),
        "{refusal}"
    );
}

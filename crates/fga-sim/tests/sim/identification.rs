//! Logs of a plant of a few lines, with noise, and the figures that were put in.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "steps of some minutes"
)]

use fga_files::TomlText;
use fga_formats::flight_log::{FlightLog, Limits, SeriesPiece};
use fga_sim::identification::{FigureEstimate, identify};
use fga_sim::vehicle_file::VehicleModel;
use std::path::Path;

struct Plant {
    dead_time_s: f64,
    time_constant_s: f64,
    factor: f64,
    airspeed_mps: f64,
    noise: f64,
}

const PLANT: Plant = Plant {
    dead_time_s: 0.3,
    time_constant_s: 0.6,
    factor: 0.9,
    airspeed_mps: 20.0,
    noise: 1.0,
};

/// A log at 20 Hz; the plant itself is stepped at 1 kHz.
fn log(plant: &Plant, command: impl Fn(f64) -> f64, lasts_s: f64) -> FlightLog {
    let mut state = 7_u64;
    let mut noise = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
    };
    let mut piece = SeriesPiece {
        start_s: 0.0,
        airspeed_mps: Vec::new(),
        bank_command_rad: Vec::new(),
        bank_rad: Vec::new(),
        course_rad: Vec::new(),
        climb_rad: Vec::new(),
    };
    let (mut bank, mut course) = (command(-plant.dead_time_s), 0.0);
    for step in 0..(lasts_s * 1000.0) as usize {
        let time_s = step as f64 * 1e-3;
        if step % 50 == 0 {
            piece
                .airspeed_mps
                .push(plant.airspeed_mps + 0.4 * plant.noise * noise());
            piece.bank_command_rad.push(command(time_s));
            piece.bank_rad.push(bank + 0.01 * plant.noise * noise());
            piece.course_rad.push(course);
            piece.climb_rad.push(0.14 * (time_s / 10.0).sin());
        }
        let late = command(time_s - plant.dead_time_s);
        bank += (late - bank) / plant.time_constant_s * 1e-3;
        let climb = 0.14 * (time_s / 10.0).sin();
        course += plant.factor * 9.80665 * bank.tan() / (plant.airspeed_mps * climb.cos()) * 1e-3;
    }
    FlightLog {
        tally: fga_formats::tally::Tally::default(),
        period_s: 0.05,
        pieces: vec![piece],
        ..FlightLog::default()
    }
}

fn steps(time_s: f64) -> f64 {
    let banks: [f64; 10] = [0.0, 30.0, 0.0, -30.0, 0.0, 20.0, -20.0, 30.0, -30.0, 0.0];
    banks[((time_s.max(0.0) / 6.0) as usize).min(9)].to_radians()
}

/// What a guidance loop commands: no steps, ramps and waves.
fn guidance(time_s: f64) -> f64 {
    let wave = (time_s * 0.7).sin() + 0.6 * (time_s * 1.9 + 1.0).sin();
    (wave * 25.0_f64.to_radians()).clamp(-0.55, 0.55)
}

fn near(estimate: FigureEstimate, true_value: f64, within: f64) {
    assert!(
        (estimate.value - true_value).abs() < within,
        "{estimate:?}, {true_value}"
    );
    assert!(estimate.low <= estimate.value && estimate.value <= estimate.high);
}

#[test]
fn steps_give_the_figures_that_were_put_in() {
    let found = identify(&log(&PLANT, steps, 60.0)).unwrap();
    near(found.airspeed_mps, 20.0, 0.1);
    near(found.max_bank_deg, 30.0, 0.5);
    near(found.dead_time_s, 0.3, 0.06);
    near(found.bank_time_constant_s, 0.6, 0.08);
    near(found.turn_rate_factor, 0.9, 0.02);
    near(found.climb_max_deg, 8.0, 0.2);
    near(found.climb_min_deg, -8.0, 0.2);
    assert!(
        found.position_error_m.high < 3.0,
        "{:?}",
        found.position_error_m
    );
}

#[test]
fn waves_of_a_guidance_loop_give_them_too() {
    let found = identify(&log(&PLANT, guidance, 180.0)).unwrap();
    near(found.dead_time_s, 0.3, 0.08);
    near(found.bank_time_constant_s, 0.6, 0.12);
    near(found.turn_rate_factor, 0.9, 0.03);
    // No bank is held: the mean of 3 s says how steeply the aircraft has turned, below the peak of 31.5 degrees.
    let banks = found.max_bank_deg;
    assert!(banks.value > 10.0 && banks.high < 31.5, "{banks:?}");
}

#[test]
fn a_plant_without_lag_has_none() {
    let quick = Plant {
        dead_time_s: 0.0,
        time_constant_s: 0.03,
        ..PLANT
    };
    let found = identify(&log(&quick, steps, 60.0)).unwrap();
    near(found.dead_time_s, 0.0, 0.06);
    assert!(found.bank_time_constant_s.value < 0.08, "{found:?}");
}

#[test]
fn a_bank_that_does_not_follow_is_left_out() {
    let mut log = log(&PLANT, steps, 60.0);
    for (row, bank) in log.pieces[0].bank_rad.iter_mut().enumerate() {
        *bank = 0.3 * (row as f64 * 0.31).sin();
    }
    let error = identify(&log).unwrap_err();
    assert!(
        error.starts_with("has 0 windows of 6 s in which"),
        "{error}"
    );
}

#[test]
fn a_log_without_commands_is_refused() {
    let error = identify(&log(&PLANT, |_| 0.0, 60.0)).unwrap_err();
    assert!(error.contains("expected at least 4"), "{error}");
}

#[test]
fn the_file_that_is_written_is_read_again() {
    let found = identify(&log(&PLANT, steps, 60.0)).unwrap();
    let text = found.to_toml("a \"name\"", 40.0, Some(20.0)).unwrap();
    let model = VehicleModel::parse(TomlText::new(Path::new("v.toml"), &text)).unwrap();
    assert_eq!(model.name, "a \"name\"");
    assert!((model.vehicle.response.dead_time_s - found.dead_time_s.value).abs() < 1e-3);
    assert!((model.settings.avoider.margin_m - found.position_error_m.high).abs() < 0.06);
    assert_eq!(model.protection.radius_m(), 40.0);
}

/// What the vehicle's guidance holds by its parameters is the most that an avoider can ask for.
#[test]
fn n3_limits_of_the_vehicle_cap_the_figures() {
    let mut log = log(&PLANT, steps, 60.0);
    log.limits = Limits {
        bank_rad: Some(25.0_f64.to_radians()),
        climb_mps: Some(20.0 * 5.0_f64.to_radians().sin()),
        sink_mps: Some(10.0),
        pitch_max_rad: Some(20.0_f64.to_radians()),
        pitch_min_rad: Some(-3.0_f64.to_radians()),
    };
    let found = identify(&log).unwrap();
    near(found.max_bank_deg, 25.0, 1e-9);
    near(found.climb_max_deg, 5.0, 0.05);
    near(found.climb_min_deg, -3.0, 1e-9);
}

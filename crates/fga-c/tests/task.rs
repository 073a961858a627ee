//! The task of `fga_task.h`, in C, flies the plant of the emulator.
//!
//! A test whose tool is missing says so and is skipped; with `CI=true` it fails.

mod built;

use core::f64::consts::FRAC_PI_2;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};

use fga_emulator::{Parameters, PlantSettings, STEP_S, Target, VehiclePlant, Vertical};

use built::{SANITIZED, build_at, folder, have};

/// Steps of the plant in a period of the task.
const STEPS: u32 = 5;

/// Lets a program fly the plant: it prints `new WIND_NORTH` before each flight and `fly BANK CLIMB ALTITUDE` each period, and reads the
/// state. Left is positive, courses count from the east. Returns what else it printed.
fn fly(program: &Path, arguments: &[String], settings: PlantSettings) -> String {
    let mut flown = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut states, printed) = (flown.stdin.take().unwrap(), flown.stdout.take().unwrap());
    let begin = |wind_mps| VehiclePlant::new(settings, [0.0, 0.0, 100.0], FRAC_PI_2, wind_mps);
    let (mut plant, mut said) = (begin([0.0; 2]), String::new());
    for line in BufReader::new(printed).lines().map(Result::unwrap) {
        let (verb, numbers) = line.split_once(' ').unwrap_or((&line, ""));
        let numbers: Vec<f64> = numbers
            .split(' ')
            .filter_map(|word| word.parse().ok())
            .collect();
        match (verb, numbers.as_slice()) {
            ("new", [north_mps]) => plant = begin([0.0, *north_mps]),
            ("fly", [bank_rad, climb_rad, altitude_m]) => {
                let vertical = if *climb_rad == 0.0 {
                    Vertical::Altitude(*altitude_m)
                } else {
                    Vertical::Pitch(climb_rad + settings.level_pitch_rad)
                };
                let target = Target {
                    bank_rad: -bank_rad,
                    vertical,
                    airspeed_mps: None,
                };
                for _ in 0..STEPS {
                    plant.step(&target, &Parameters::default(), STEP_S);
                }
                let [east, north, up] = plant.position_m();
                let course_rad = FRAC_PI_2 - plant.heading_rad();
                let climb_rad = plant.pitch_rad() - settings.level_pitch_rad;
                let (bank_rad, speed_mps) = (-plant.bank_rad(), plant.airspeed_mps());
                writeln!(
                    states,
                    "{east} {north} {up} {course_rad} {climb_rad} {bank_rad} {speed_mps}"
                )
                .unwrap();
            }
            _ => {
                println!("{line}");
                said += &format!("{line}\n");
            }
        }
    }
    assert!(flown.wait().unwrap().success(), "{said}");
    said
}

#[test]
fn the_task_keeps_sixty_metres_and_hands_back_whatever_fails() {
    if !have(&[("cc", "build-essential")]) {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let options = [&["-std=c99", "-O1"], SANITIZED.as_slice()].concat();
    let source = folder().join("tests/task/flights.c");
    let program = build_at(&source, "cc", &options, into.path());
    let settings = PlantSettings::default();
    for wind_mps in [0.0, 8.0] {
        let arguments = [settings.turn_rate_factor.to_string(), wind_mps.to_string()];
        let said = fly(&program, &arguments, settings);
        assert_eq!(said.lines().count(), 24, "{said}");
    }
}

/// The companion `fga fly` decides when to take and when to give back by the same numbers.
#[test]
fn the_task_takes_and_gives_back_as_the_companion_does() {
    let number = |text: &str, name: &str| -> f64 {
        let (_, rest) = text.split_once(name).unwrap_or_else(|| panic!("no {name}"));
        let digits = |c: char| c.is_ascii_digit() || c == '.';
        let number = rest.trim_start().split(|c| !digits(c)).next();
        number.unwrap().parse().unwrap()
    };
    let header = include_str!("../include/fga_task.h");
    let handover = include_str!("../../fga-link/src/companion/handover.rs");
    let route = include_str!("../../fga-link/src/companion/route.rs");
    let hand = include_str!("../../fga-link/src/hand/attitude.rs");
    for (name, companion) in [
        ("PREPARE_S", handover),
        ("PAUSE_S", handover),
        ("ON_LEG_FOR_S", handover),
        ("LONGEST_WAY_BACK_S", handover),
        ("ON_LEG_M", route),
        ("ON_LEG_HEIGHT_M", route),
        ("ON_LEG_RAD", route),
        ("SHORTEST_ROLL_OUT_S", hand),
    ] {
        let theirs = number(companion, &format!("const {name}: f64 ="));
        let ours = number(header, &format!("#define FGA_TASK_{name} "));
        assert_eq!(ours, theirs, "{name}");
    }
}

//! The task of `fga_task.h`, alone and inside two autopilots, flies the plant of the emulator.
//!
//! A test whose tool is missing says so and is skipped; with `CI=true` it fails.

#[path = "built/shared.rs"]
mod built;

use core::f64::consts::FRAC_PI_2;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};

use fga_emulator::{Parameters, PlantSettings, STEP_S, Target, VehiclePlant, Vertical};

use built::{build_all, build_at, folder, have, library, ran, root, sanitized};

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
    let mut parameters = Parameters::default();
    assert!(parameters.set("ROLL_LIMIT_DEG", 65.0));
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
                    plant.step(&target, &parameters, STEP_S);
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
                said.push_str(&line);
                said.push('\n');
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
    let options = sanitized(&["-std=c99", "-O1"]);
    let source = folder().join("tests/task/flights.c");
    let program = build_at(&source, "cc", &options, into.path());
    let settings = PlantSettings::default();
    for wind_mps in [0.0, 8.0] {
        let arguments = [settings.turn_rate_factor.to_string(), wind_mps.to_string()];
        let said = fly(&program, &arguments, settings);
        assert_eq!(said.lines().count(), 33, "{said}");
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
    for (name, companion) in [
        ("PREPARE_S", handover),
        ("PAUSE_S", handover),
        ("ON_LEG_FOR_S", handover),
        ("LONGEST_WAY_BACK_S", handover),
        ("ON_LEG_M", route),
        ("ON_LEG_HEIGHT_M", route),
        ("ON_LEG_RAD", route),
    ] {
        let theirs = number(companion, &format!("const {name}: f64 ="));
        let ours = number(header, &format!("#define FGA_TASK_{name} "));
        assert_eq!(ours, theirs, "{name}");
    }
}

/// The sizes of a glue that a page promises: lines of code, without comments.
fn lines_of_code(path: &Path) -> usize {
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .count()
}

/// What a program of an autopilot says at its end: a number behind its name.
fn said(text: &str, name: &str) -> f64 {
    let mut words = text.split_whitespace().skip_while(|word| *word != name);
    let number = words.nth(1).unwrap_or_else(|| panic!("no {name}: {text}"));
    number.parse().unwrap()
}

/// Flies an autopilot with a fault, in calm air and in wind; with two changes of mode, on the leg, outside of 60 m.
fn flies_as_the_page_says(program: &Path) {
    let settings = PlantSettings::default();
    let fly = |fault: &str, wind: &str| fly(program, &[fault.into(), wind.into()], settings);
    for (fault, wind) in [
        ("none", "0"),
        ("none", "8"),
        ("none", "-8"),
        ("silent", "0"),
    ] {
        let text = fly(fault, wind);
        assert!(said(&text, "least") >= 60.0, "{fault}: {text}");
        assert_eq!(said(&text, "changes"), 2.0, "{fault}: {text}");
        assert!(said(&text, "beside") < 18.0, "{fault}: {text}");
        assert!(said(&text, "back") < said(&text, "taken") + 60.0, "{text}");
    }
    // The change that is asked for, then the pilot's, and none after it.
    assert_eq!(said(&fly("pilot", "0"), "changes"), 1.0);
    assert_eq!(said(&fly("refused", "0"), "changes"), 0.0);
    assert!(fly("refused", "0").contains("[fga: mode refused, not avoiding]"));
    for fault in ["stick", "state", "stopped"] {
        let text = fly(fault, "0");
        let held_s = said(&text, "back") - said(&text, "taken");
        assert!((2.0..2.6).contains(&held_s), "{fault}: {text}");
    }
    assert!(fly("state", "0").contains("[fga: no usable state, gave back]"));
    let unusable = fly("factor", "0");
    assert_eq!(said(&unusable, "changes"), 0.0);
    assert!(
        unusable.contains("turn_rate_factor is 5.00, "),
        "{unusable}"
    );
}

#[test]
fn inside_arduplanes_interfaces_an_intruder_is_kept_out_and_the_mode_handed_back() {
    if !have(&[("c++", "build-essential")]) {
        return;
    }
    let glue = root().join("examples/ardupilot");
    assert!(lines_of_code(&glue.join("fga_plane.cpp")) < 100);
    let stub = folder().join("tests/ardupilot");
    let into = tempfile::tempdir().unwrap();
    let (includes, stub_includes) = (
        format!("-I{}", glue.display()),
        format!("-I{}", stub.display()),
    );
    // As ArduPilot compiles: constants are floats, floats are not compared, and headers beside a file are found by quotes alone.
    let text = std::fs::read_to_string(glue.join("fga_plane.cpp")).unwrap();
    assert!(!text.contains("#include <fga"));
    let options = [
        "-std=gnu++11",
        "-O1",
        "-fsingle-precision-constant",
        "-Wfloat-equal",
        "-fno-exceptions",
        "-fno-rtti",
        "-Wno-conversion",
        "-Wno-float-conversion",
        &includes,
        &stub_includes,
    ];
    // Its parameters come first, as in ArduPilot, where they are constants.
    let sources = [glue.join("fga_plane.cpp"), stub.join("flights.cpp")];
    let options = sanitized(&options);
    let program = build_all(&sources, "c++", &options, into.path());
    flies_as_the_page_says(&program);
    let landing = fly(
        &program,
        &["landing".into(), "0".into()],
        PlantSettings::default(),
    );
    assert_eq!(said(&landing, "changes"), 0.0);
    // Shown too late for the normal bank, the bank in need.
    for (fault, steepest_deg) in [("none", 43.0), ("late", 63.0)] {
        let text = fly(
            &program,
            &[fault.into(), "0".into()],
            PlantSettings::default(),
        );
        assert!(
            (said(&text, "steepest") - steepest_deg).abs() < 1.0,
            "{fault}: {text}"
        );
        assert!(said(&text, "least") >= 60.0, "{fault}: {text}");
    }
    // AUTO goes on with its item, also where MIS_RESTART is 1, and on the leg of a mission uploaded in the manoeuvre.
    for fault in ["none", "restart", "mission"] {
        let text = fly(
            &program,
            &[fault.into(), "0".into()],
            PlantSettings::default(),
        );
        assert_eq!(said(&text, "item"), 2.0, "{fault}: {text}");
        assert_eq!(said(&text, "sets"), 0.0, "{fault}: {text}");
        assert!(said(&text, "beside") < 18.0, "{fault}: {text}");
    }
}

#[test]
fn inside_px4s_topics_an_intruder_is_kept_out_and_the_mode_handed_back() {
    if !have(&[("c++", "build-essential")]) {
        return;
    }
    let module = root().join("examples/px4/fga_module.cpp");
    let stub = folder().join("tests/px4");
    let into = tempfile::tempdir().unwrap();
    // Each header of PX4 that the module includes is the stub.
    let text = std::fs::read_to_string(&module).unwrap();
    let headers = text
        .lines()
        .filter_map(|line| line.strip_prefix("#include <")?.strip_suffix('>'));
    for header in headers.filter(|header| header.contains('/')) {
        let path = into.path().join("stub").join(header);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "#include \"px4.h\"\n").unwrap();
    }
    let (includes, stub_includes) = (
        format!("-I{}/stub", into.path().display()),
        format!("-I{}", stub.display()),
    );
    let options = [
        "-std=gnu++14",
        "-O1",
        "-fno-exceptions",
        "-Wno-conversion",
        "-Wno-float-conversion",
        "-Wno-unused-parameter",
        &includes,
        &stub_includes,
    ];
    let options = sanitized(&options);
    let sources = [module, stub.join("flights.cpp")];
    let program = build_all(&sources, "c++", &options, into.path());
    let settings = PlantSettings::default();
    let fly = |fault: &str, wind: &str| fly(&program, &[fault.into(), wind.into()], settings);
    for (fault, wind) in [("none", "0"), ("none", "8"), ("silent", "0")] {
        let text = fly(fault, wind);
        assert!(said(&text, "least") >= 60.0, "{fault}: {text}");
        assert_eq!(said(&text, "changes"), 2.0, "{fault}: {text}");
        assert!(said(&text, "beside") < 18.0, "{fault}: {text}");
        assert!(said(&text, "answers") > 90.0, "{text}");
    }
    for (fault, changes) in [("pilot", 1.0), ("refused", 0.0), ("landing", 0.0)] {
        assert_eq!(said(&fly(fault, "0"), "changes"), changes, "{fault}");
    }
    for fault in ["stick", "state"] {
        let text = fly(fault, "0");
        let held_s = said(&text, "back") - said(&text, "taken");
        assert!((2.0..2.8).contains(&held_s), "{fault}: {text}");
    }
}

/// What `apply.sh` adds to a tree of ArduPilot, and once only.
#[cfg(unix)]
#[test]
fn the_glue_is_put_into_a_tree_of_arduplane_once() {
    let into = tempfile::tempdir().unwrap();
    let (tree, prefix) = (into.path().join("tree"), into.path().join("prefix"));
    let plane = tree.join("ArduPlane");
    std::fs::create_dir_all(&plane).unwrap();
    std::fs::create_dir_all(prefix.join("include")).unwrap();
    for header in ["fga.h", "fga_task.h"] {
        std::fs::copy(
            folder().join("include").join(header),
            prefix.join("include").join(header),
        )
        .unwrap();
    }
    // The lines that it looks for.
    for (name, text) in [
        (
            "Plane.h",
            "class Plane {\n    friend class AP_Avoidance_Plane;\n",
        ),
        (
            "Parameters.h",
            "#pragma once\nclass ParametersG2 {\npublic:\n    ParametersG2(void);\n",
        ),
        (
            "Parameters.cpp",
            "const AP_Param::GroupInfo ParametersG2::var_info[] = {\n",
        ),
        (
            "Plane.cpp",
            "    SCHED_TASK(avoidance_adsb_update,  10,    100, 144),\n",
        ),
    ] {
        std::fs::write(plane.join(name), text).unwrap();
    }
    let script = root().join("examples/ardupilot/apply.sh");
    for _ in 0..2 {
        let (tree, prefix) = (tree.to_str().unwrap(), prefix.to_str().unwrap());
        ran(Command::new("sh").arg(&script).args([tree, prefix]));
        let added: usize = ["Plane.h", "Parameters.h", "Parameters.cpp", "Plane.cpp"]
            .iter()
            .map(|name| std::fs::read_to_string(plane.join(name)).unwrap())
            .map(|text| {
                text.lines()
                    .filter(|line| line.contains("fga") || line.contains("FgaPlane"))
                    .count()
            })
            .sum();
        assert_eq!(added, 5);
    }
    assert!(plane.join("fga_plane.cpp").exists() && plane.join("fga_task.h").exists());
}

/// A tree of ArduPilot that `ARDUPILOT` names is compiled with the glue; `examples/ardupilot/apply.sh` changes it.
#[test]
fn a_real_arduplane_compiles_and_links_with_the_glue() {
    let Some(tree) = std::env::var_os("ARDUPILOT") else {
        println!("ARDUPILOT names no tree of ArduPilot; skipped");
        return;
    };
    let into = tempfile::tempdir().unwrap();
    for (to, from) in [
        ("include/fga.h", folder().join("include/fga.h")),
        ("include/fga_task.h", folder().join("include/fga_task.h")),
        ("lib/libfga_c.a", library().join("libfga_c.a")),
    ] {
        let to = into.path().join(to);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(from, to).unwrap();
    }
    let script = root().join("examples/ardupilot/apply.sh");
    ran(Command::new("sh").arg(script).arg(&tree).arg(into.path()));
    let linked = format!("-L{}/lib -lfga_c", into.path().display());
    for arguments in [["configure", "--board", "sitl"].as_slice(), &["plane"]] {
        ran(Command::new("./waf")
            .args(arguments)
            .env("LDFLAGS", &linked)
            .current_dir(&tree));
    }
}

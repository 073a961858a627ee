//! The examples in C and C++ build with a plain compiler against the static library, and decide as `fga run` does.
//!
//! A test whose tool is missing says so and is skipped; with `CI=true` it fails.

#[path = "built/shared.rs"]
mod built;

use core::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use fga::avoider::Decision;
use fga::command::Proof;
use fga_sim::policy::PolicyChoice;
use fga_sim::run::{Plan, fly};

use built::{WARNINGS, build_at, folder, have, library, ran, root, sanitized};

/// Builds an example.
fn build(name: &str, compiler: &str, options: &[&str], into: &Path) -> PathBuf {
    build_at(
        &root().join("examples/c").join(name),
        compiler,
        options,
        into,
    )
}

#[test]
fn the_static_library_holds_no_panic_and_no_allocation() {
    if !have(&[("nm", "binutils")]) {
        return;
    }
    // Warnings are about objects without symbols.
    let output = Command::new("nm")
        .arg(library().join("libfga_c.a"))
        .output()
        .unwrap();
    let symbols = String::from_utf8_lossy(&output.stdout);
    assert!(symbols.contains("T fga_avoider_step") && symbols.contains("T fga_certify"));
    let unwanted = [
        "panicking",
        "rust_begin_unwind",
        "__rust_alloc",
        "__rg_alloc",
        "__rdl_alloc",
    ];
    let found: Vec<&str> = symbols
        .lines()
        .filter(|line| unwanted.iter().any(|name| line.contains(name)))
        .collect();
    assert!(found.is_empty(), "{found:?}");
}

/// The names that `nm` lists with some options.
fn symbols(options: &[&str]) -> Vec<String> {
    let listed = ran(Command::new("nm")
        .args(["--extern-only", "--format=posix"])
        .args(options)
        .arg(library().join("libfga_c.a")));
    let names = listed.lines().filter(|line| line.contains(' '));
    names
        .filter_map(|line| line.split(' ').next().map(str::to_owned))
        .collect()
}

/// Nothing of the compiler's runtime takes the place of a function of the program, and the program's C library is all that is needed.
#[test]
fn the_static_library_exports_its_interface_alone() {
    if !have(&[("nm", "binutils")]) {
        return;
    }
    let header = fs::read_to_string(folder().join("include/fga.h")).unwrap();
    let exported = symbols(&["--defined-only"]);
    let is_of_it = |name: &String| {
        header.contains(&format!(" {name}(")) || header.contains(&format!("*{name}("))
    };
    assert!(
        exported.len() > 20 && exported.iter().all(is_of_it),
        "{exported:?}"
    );
    let needed = symbols(&["--undefined-only"]);
    let is_basic =
        |name: &String| ["memcpy", "memmove", "memset", "memcmp", "bcmp"].contains(&name.as_str());
    assert!(needed.iter().all(is_basic), "{needed:?}");
}

/// Every function of `math.h` in each precision, and the runtime of C++, are the program's own: what it prints does not depend on
/// the library.
#[test]
fn mathematics_and_exceptions_are_those_of_the_program() {
    if !have(&[("cc", "build-essential"), ("c++", "build-essential")]) {
        return;
    }
    let links = [
        ("math.c", "cc", "-std=c11", 850),
        ("math.cpp", "c++", "-std=c++17", 50),
    ];
    for (name, compiler, standard, least) in links {
        let source = folder().join("tests/link").join(name);
        let [alone, linked] = [None, Some("-DWITH_FGA")].map(|with| {
            let into = tempfile::tempdir().unwrap();
            let mut options = vec![standard, "-fno-builtin"];
            options.extend(with);
            ran(&mut Command::new(build_at(
                &source,
                compiler,
                &options,
                into.path(),
            )))
        });
        assert_eq!(alone, linked);
        assert!(linked.lines().count() > least, "{linked}");
    }
}

/// Nothing that a program traps is seen by it, its rounding changes no decision, and is its own again.
#[test]
fn no_step_raises_a_floating_point_exception() {
    // Where the processor traps: see `floating`.
    if !cfg!(all(target_arch = "x86_64", target_env = "gnu")) || !have(&[("cc", "build-essential")])
    {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let source = folder().join("tests/link/traps.c");
    let program = build_at(&source, "cc", &["-std=gnu11", "-O1"], into.path());
    let printed = ran(Command::new(program).args(["0", "400"]));
    let counts: Vec<u32> = printed
        .split(' ')
        .filter_map(|word| word.parse().ok())
        .collect();
    assert!(counts[0] == 800 && counts[1] > 2_000, "{printed}");
}

#[test]
fn the_headers_compile_in_every_standard() {
    if !have(&[("cc", "build-essential"), ("c++", "build-essential")]) {
        return;
    }
    let compile = |compiler: &str, language: &str, standard: &str, header: &str| {
        ran(Command::new(compiler)
            .args(["-fsyntax-only", "-x", language])
            .arg(format!("-std={standard}"))
            .args(WARNINGS)
            .arg("-include")
            .arg(folder().join("include").join(header))
            .arg("/dev/null"));
    };
    for standard in ["c99", "c11", "c17"] {
        compile("cc", "c", standard, "fga.h");
        compile("cc", "c", standard, "fga_task.h");
    }
    for standard in ["c++11", "c++14", "c++17", "c++20"] {
        compile("c++", "c++", standard, "fga.h");
        compile("c++", "c++", standard, "fga_task.h");
    }
    for standard in ["c++17", "c++20"] {
        compile("c++", "c++", standard, "fga.hpp");
    }
}

#[test]
fn the_head_on_flies_under_the_sanitizers() {
    if !have(&[("cc", "build-essential")]) {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let options = sanitized(&["-std=c11", "-O1"]);
    let printed = ran(&mut Command::new(build(
        "head_on.c",
        "cc",
        &options,
        into.path(),
    )));
    assert!(
        printed.contains("a certified manoeuvre begins"),
        "{printed}"
    );
    assert!(printed.contains("back on the leg"), "{printed}");
}

#[test]
fn the_head_on_flies_under_valgrind() {
    if !have(&[("cc", "build-essential"), ("valgrind", "valgrind")]) {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let program = build("head_on.c", "cc", &["-std=c11", "-O1", "-g"], into.path());
    let suppressions = folder().join("tests/valgrind.supp");
    let printed = ran(Command::new("valgrind")
        .args(["--quiet", "--error-exitcode=9"])
        .arg(format!("--suppressions={}", suppressions.display()))
        .arg(program));
    assert!(printed.contains("back on the leg"), "{printed}");
}

/// What the example prints of a decision: names as numbers, and doubles with seventeen digits.
fn numbers(decision: &Decision) -> Vec<f64> {
    let record = &decision.record;
    let position = |place: Option<usize>| place.map_or(f64::NAN, |place| place as f64);
    let state = fga::avoider::State::ALL
        .iter()
        .position(|&state| state == decision.state);
    let reason = fga::avoider::Reason::ALL
        .iter()
        .position(|&reason| reason == record.reason);
    let has = [
        record.threat.is_some(),
        record.chosen.is_some(),
        decision.command.certified().is_some(),
        record.start_s.is_some(),
        record.latest_start_s.is_some(),
        record.resilience.is_some(),
        matches!(decision.command.proof(), Some(Proof::Leaving(_))),
    ];
    let bits: u32 = (0..).zip(has).map(|(bit, has)| u32::from(has) << bit).sum();
    let mut numbers = vec![position(state), position(reason), f64::from(bits)];
    for stage in decision.command.stages() {
        numbers.extend([
            stage.start_s,
            stage.course_rad,
            stage.climb_rad,
            stage.rate_share,
        ]);
    }
    numbers.extend([
        record.chosen.map_or(0.0, |chosen| chosen.margin_m),
        (decision.command.proof()).map_or(0.0, |proof| proof.bound().margin_m),
        record.start_s.unwrap_or(0.0),
    ]);
    numbers
}

#[test]
fn the_head_on_decides_as_fga_run_to_the_last_bit() {
    if !have(&[("cc", "build-essential")]) {
        return;
    }
    let plan = Plan::read(&root().join("examples/c/head_on.toml"), None).unwrap();
    let intruder = plan.world.obstacles[0].track.clone();
    let log = fly(plan, &PolicyChoice::default(), &mut |_| ()).unwrap();
    let mut states = String::new();
    for moment in &log.decisions {
        let own = &moment.ownship;
        let (place_m, _) = intruder.at(moment.time_s).unwrap();
        let (at, to) = (own.position_m, place_m);
        writeln!(
            states,
            "{:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e}",
            moment.time_s,
            at.x,
            at.y,
            at.z,
            own.course_rad,
            own.climb_rad,
            own.bank_rad,
            own.airspeed_mps,
            to.x,
            to.y,
            to.z
        )
        .unwrap();
    }
    let into = tempfile::tempdir().unwrap();
    let path = into.path().join("states.txt");
    fs::write(&path, states).unwrap();
    let program = build("head_on.c", "cc", &["-std=c11", "-O2"], into.path());
    let printed = ran(Command::new(program).arg(&path));
    assert_eq!(printed.lines().count(), log.decisions.len());
    assert!(log.decisions.len() > 500);
    for (line, moment) in printed.lines().zip(&log.decisions) {
        let found: Vec<u64> = line
            .split(' ')
            .map(|number| number.parse::<f64>().unwrap().to_bits())
            .collect();
        let expected: Vec<u64> = numbers(&moment.decision)
            .into_iter()
            .map(f64::to_bits)
            .collect();
        assert_eq!(found, expected, "at {} s: {line}", moment.time_s);
    }
}

#[test]
fn the_second_opinion_in_cpp_refutes_and_proves() {
    if !have(&[("c++", "build-essential")]) {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let options = sanitized(&["-std=c++17", "-fno-exceptions", "-O1"]);
    let program = build("second_opinion.cpp", "c++", &options, into.path());
    let printed = ran(&mut Command::new(program));
    assert!(printed.contains("40 degrees right proven"), "{printed}");
    assert!(printed.contains("over the village not proven"), "{printed}");
}

#[test]
fn the_classes_of_cpp_learn_hear_and_believe() {
    if !have(&[("c++", "build-essential")]) {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let options = sanitized(&["-std=c++17", "-O1"]);
    for (source, printed) in [("learned", "0.7\n"), ("traffic", "avoiding, avoiding\n")] {
        let source = folder().join(format!("tests/link/{source}.cpp"));
        let program = build_at(&source, "c++", &options, into.path());
        assert_eq!(ran(&mut Command::new(program)), printed);
    }
}

/// The page shows the program, its commands run as they are written, and print what it says.
#[cfg(unix)]
#[test]
fn the_first_flight_of_the_page_is_installed_built_and_flown() {
    if !have(&[("cmake", "cmake"), ("cc", "build-essential")]) {
        return;
    }
    let page = fs::read_to_string(root().join("docs/how-to-autopilot.md")).unwrap();
    let program = fs::read_to_string(root().join("examples/c/first_flight.c")).unwrap();
    assert!(page.contains(&format!("```c\n{program}```")));
    assert!(program.lines().count() <= 60);
    let block = |kind: &str| {
        let rest = page.split_once(&format!("```{kind}\n")).unwrap().1;
        rest.split_once("```").unwrap().0.to_owned()
    };
    let into = tempfile::tempdir().unwrap();
    for name in ["crates", "examples"] {
        std::os::unix::fs::symlink(root().join(name), into.path().join(name)).unwrap();
    }
    let mut printed = String::new();
    for line in block("sh").lines() {
        printed = ran(Command::new("sh")
            .args(["-c", line])
            .env_remove("RUSTFLAGS")
            .current_dir(into.path()));
    }
    let after = page.split_once("It prints:\n\n```\n").unwrap().1;
    assert_eq!(printed, after.split_once("```").unwrap().0);
}

#[test]
fn an_installed_library_is_found_by_cmake_and_pkg_config() {
    let tools = [
        ("cmake", "cmake"),
        ("pkg-config", "pkg-config"),
        ("make", "build-essential"),
        ("c++", "build-essential"),
    ];
    if !have(&tools) {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let (made, prefix) = (into.path().join("made"), into.path().join("prefix"));
    ran(Command::new("cmake")
        .arg("-S")
        .arg(folder())
        .arg("-B")
        .arg(&made)
        .args([
            format!("-DCMAKE_INSTALL_PREFIX={}", prefix.display()),
            "-DCMAKE_INSTALL_LIBDIR=lib".to_owned(),
            // The library is there already; a build would give the same.
            format!("-DFGA_LIBRARY={}", library().join("libfga_c.a").display()),
        ]));
    ran(Command::new("cmake").arg("--build").arg(&made));
    ran(Command::new("cmake").arg("--install").arg(&made));

    let flags = ran(Command::new("pkg-config")
        .args(["--cflags", "--libs", "fga"])
        .env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")));
    let program = into.path().join("by-pkg-config");
    ran(Command::new("cc")
        .arg("-std=c11")
        .arg(root().join("examples/c/head_on.c"))
        .args(flags.split_whitespace())
        .arg("-o")
        .arg(&program));
    assert!(ran(&mut Command::new(program)).contains("back on the leg"));

    let user = into.path().join("user");
    fs::create_dir(&user).unwrap();
    let example = root().join("examples/c/second_opinion.cpp");
    let text = format!(
        "cmake_minimum_required(VERSION 3.16)\nproject(user CXX)\nfind_package(fga {} REQUIRED)\n\
         add_executable(user \"{}\")\ntarget_link_libraries(user fga::fga)\n",
        env!("CARGO_PKG_VERSION"),
        example.display()
    );
    fs::write(user.join("CMakeLists.txt"), text).unwrap();
    let built = into.path().join("user-build");
    ran(Command::new("cmake")
        .arg("-S")
        .arg(&user)
        .arg("-B")
        .arg(&built)
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())));
    ran(Command::new("cmake").arg("--build").arg(&built));
    ran(&mut Command::new(built.join("user")));
}

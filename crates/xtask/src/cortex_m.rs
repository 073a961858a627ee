//! Flies seventeen encounters on an emulated Cortex-M7, and compares what they take with a committed table.
//!
//! The emulator counts instructions; a painted stack shows its depth. Drawn situations are decided there and here, and the
//! hash over all decisions must be one.

use alloc::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::{cargo, has_target, host, ran};
use crate::table::NumberTable;

const TABLE: NumberTable = NumberTable {
    path: "docs/benchmarks/cortex-m7.csv",
    header: "what,number",
    chore: "cortex-m",
};

/// The emulated machine.
const TARGET: &str = "thumbv7em-none-eabihf";

/// Drawn situations of each of the three aircraft, without another number.
const DRAWN: &str = "334";

/// Measures and compares with the table; `--write` writes the table instead. A number as option sets how many situations are drawn
/// for each aircraft.
pub(crate) fn check(options: &[&str]) -> Result<(), String> {
    let (write, drawn) = match options {
        [] => (false, DRAWN),
        ["--write"] => (true, DRAWN),
        [drawn] if drawn.parse::<u32>().is_ok() => (false, *drawn),
        _ => return Err("expected cargo xtask cortex-m, with --write, a number or neither".into()),
    };
    if let Some(sentence) = missing() {
        if env::var_os("CI").is_some() {
            return Err(sentence);
        }
        println!("{sentence}; skipped");
        return Ok(());
    }
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut numbers = BTreeMap::new();
    for (profile, name) in [("release", "for speed"), ("small", "for size")] {
        let mut largest = 0;
        for (program, part) in [
            ("flash", ""),
            ("beliefs", " with beliefs"),
            ("certificate", " of the certificate alone"),
        ] {
            let linked = build(&root, TARGET, profile, program, drawn)?;
            let flash = format!("bytes of flash{part}, compiled {name}");
            numbers.insert(flash, loaded(&linked)?);
            largest = largest.max(largest_frame(&linked)?);
            holds_no_panic(&linked)?;
        }
        let frame = format!("bytes of the largest frame, compiled {name}");
        numbers.insert(frame, largest);
    }
    let target = build(&root, TARGET, "release", "target", drawn)?;
    let printed = ran(Command::new("qemu-system-arm")
        .args(["-M", "mps2-an500", "-icount", "shift=0", "-nographic"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(target))?;
    print!("{printed}");
    if printed.contains("inside a volume") {
        return Err("an encounter is lost".into());
    }
    for line in printed.lines().filter(|line| !line.starts_with('#')) {
        if let Some((name, number)) = line.rsplit_once(',') {
            let number = number.parse().map_err(|_| format!("no number: {line}"))?;
            numbers.insert(name.to_owned(), number);
        }
    }
    let here = build(&root, &host()?, "release", "host", drawn)?;
    let hash = ran(Command::new(here).arg(drawn))?;
    if !printed.ends_with(&hash) {
        return Err(format!("the decisions on this machine are others: {hash}"));
    }
    TABLE.check(&root, &numbers, write)
}

/// What is not installed.
fn missing() -> Option<String> {
    let is_missing = |tool: &str| Command::new(tool).arg("--version").output().is_err();
    if is_missing("qemu-system-arm") {
        return Some("qemu-system-arm is not installed (Debian: qemu-system-arm)".into());
    }
    if is_missing("readelf") {
        return Some("readelf is not installed (Debian: binutils)".into());
    }
    (!has_target(TARGET))
        .then(|| format!("the core library is missing (rustup target add {TARGET})"))
}

/// Builds one of the programs.
fn build(
    root: &Path,
    target: &str,
    profile: &str,
    name: &str,
    drawn: &str,
) -> Result<PathBuf, String> {
    let folder = root.join("target/cortex-m7");
    ran(cargo()
        .args([
            "build",
            "--quiet",
            "--locked",
            "--target",
            target,
            "--profile",
            profile,
        ])
        .args(["--bin", name, "--target-dir"])
        .arg(&folder)
        .env("DRAWN", drawn)
        // The flags of the example's own configuration, and the frames' sizes beside the code, which stable Rust does not offer.
        .env_remove("RUSTFLAGS")
        .env("RUSTC_BOOTSTRAP", "1")
        .arg("--config")
        .arg(format!("target.{TARGET}.rustflags=['-Zemit-stack-sizes']"))
        .current_dir(root.join("examples/cortex-m7")))?;
    Ok(folder.join(target).join(profile).join(name))
}

/// Bytes that a program takes of flash: its loaded segments, without the vectors of interrupts.
fn loaded(program: &Path) -> Result<u64, String> {
    let printed = ran(Command::new("readelf")
        .args(["--sections", "--wide"])
        .arg(program))?;
    let size = |name: &str| {
        let line = printed.lines().find(|line| line.contains(name))?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let at = words.iter().position(|word| *word == "PROGBITS")?;
        u64::from_str_radix(words.get(at + 3)?, 16).ok()
    };
    let sizes = [".text", ".rodata", ".data"].map(|name| size(&format!(" {name} ")));
    sizes
        .into_iter()
        .sum::<Option<u64>>()
        .ok_or_else(|| format!("no sections: {printed}"))
}

/// Bytes of the largest frame of any function of a program, by the compiler: a section has the address and the size of each frame.
fn largest_frame(program: &Path) -> Result<u64, String> {
    let printed = ran(Command::new("readelf")
        .arg("--hex-dump=.stack_sizes")
        .arg(program))?;
    // A line has its address, four words and the same as text.
    let words = (printed.lines().filter(|line| line.starts_with("  0x")))
        .flat_map(|line| line.get(13..48).unwrap_or_default().split_whitespace())
        .collect::<String>();
    let mut bytes = (0..words.len() / 2)
        .filter_map(|place| u8::from_str_radix(words.get(2 * place..2 * place + 2)?, 16).ok());
    let mut largest = None;
    while bytes.by_ref().nth(3).is_some() {
        let (mut size, mut bits) = (0, 0);
        for byte in bytes.by_ref() {
            size |= u64::from(byte & 0x7f) << bits;
            bits += 7;
            if byte < 0x80 {
                break;
            }
        }
        largest = largest.max(Some(size));
    }
    largest.ok_or_else(|| format!("{}: no frames: {printed}", program.display()))
}

/// Refuses a program that can panic: the linker drops what nothing can reach.
fn holds_no_panic(program: &Path) -> Result<(), String> {
    let symbols = ran(Command::new("nm").arg(program))?;
    let found: Vec<&str> = (symbols.lines())
        .filter(|line| line.contains("panicking") || line.contains("rust_begin_unwind"))
        .collect();
    if found.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{}: the core can panic: {found:?}",
        program.display()
    ))
}

//! `cargo xtask dist`: what a release consists of, so that a user needs no compiler.
//!
//! | file | what |
//! |---|---|
//! | `fga-VERSION-TARGET.tar.gz` | the program, with scenarios, vehicles and campaigns |
//! | `fga-c-VERSION-TARGET.tar.gz` | the C library with headers, CMake package and pkg-config file; for this machine, and for a Cortex-M7 where its target is installed |
//! | `fga_daa-*.whl` | the Python package, with the tag of the oldest C library that its symbols allow |
//! | `*.spdx.json` | what program, C library and Python package are built of: name, version, licence and source of each crate |
//! | `SHA256SUMS` | checksums of all of them |

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::{built, cargo, has_target, host, ran};

/// The microcontroller that the C library is built for too.
const FIRMWARE_TARGET: &str = "thumbv7em-none-eabihf";

/// What is beside the program in its archive.
const BESIDE: [&str; 7] = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "scenarios",
    "vehicles",
    "campaigns",
];

/// Makes them all in `target/dist`, or in the folder behind `--out`, which must be empty or absent.
pub(crate) fn make(options: &[&str]) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().map_err(|error| error.to_string())?;
    let out = match options {
        [] => root.join("target/dist"),
        ["--out", folder] => {
            env::current_dir().map_or_else(|_| folder.into(), |here| here.join(folder))
        }
        _ => return Err("expected cargo xtask dist, with --out FOLDER or without".into()),
    };
    if fs::read_dir(&out).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(format!("{} is not empty", out.display()));
    }
    let release = Release {
        version: version(&root)?,
        root,
        out,
    };
    // The quick part first: it finds out what is not installed.
    release.parts()?;
    release.program()?;
    release.c_library(None)?;
    if has_target(FIRMWARE_TARGET) {
        release.c_library(Some(FIRMWARE_TARGET))?;
    } else {
        println!("without the C library for a Cortex-M7 (rustup target add {FIRMWARE_TARGET})");
    }
    release.wheel()?;
    release.checksums()
}

/// The version of the sources: that of the workspace, and the commit where the changelog has more than that release.
fn version(root: &Path) -> Result<String, String> {
    let git = |arguments: &[&str]| ran(Command::new("git").args(arguments).current_dir(root));
    if !git(&["status", "--porcelain"])?.is_empty() {
        return Err("the checkout has changes: a release is of a commit".into());
    }
    let changelog = fs::read_to_string(root.join("CHANGELOG.md"));
    let changelog = changelog.map_err(|error| format!("CHANGELOG.md: {error}"))?;
    let commit = git(&["rev-parse", "--short=10", "HEAD"])?;
    named(&changelog, env!("CARGO_PKG_VERSION"), commit.trim())
}

fn named(changelog: &str, version: &str, commit: &str) -> Result<String, String> {
    let mut sections = changelog.split("\n## [").skip(1);
    let newer = sections
        .next()
        .and_then(|section| section.strip_prefix("Unreleased]"));
    let newer = newer.ok_or("CHANGELOG.md begins without a section [Unreleased]")?;
    let newest = sections
        .next()
        .and_then(|section| section.split(']').next());
    if newest != Some(version) {
        return Err(format!(
            "the newest release of CHANGELOG.md is {}, expected {version}, the version of Cargo.toml",
            newest.unwrap_or("none")
        ));
    }
    if newer.trim().is_empty() {
        return Ok(version.to_owned());
    }
    Ok(format!("{version}+g{commit}"))
}

/// Refuses a wheel that says nothing about the C library that it needs, as package indexes do.
fn for_any_machine(wheel: &str) -> Result<(), String> {
    let tag = wheel.trim_end_matches(".whl").rsplit('-').next();
    match tag {
        Some(tag) if !tag.starts_with("linux_") => Ok(()),
        _ => Err(format!(
            "{wheel} has the tag of this machine, expected manylinux_ or musllinux_"
        )),
    }
}

struct Release {
    version: String,
    root: PathBuf,
    out: PathBuf,
}

impl Release {
    fn cargo(&self) -> Command {
        let mut cargo = cargo();
        cargo.current_dir(&self.root);
        cargo
    }

    fn program(&self) -> Result<(), String> {
        println!("the program");
        let build = [
            "build",
            "--locked",
            "--profile",
            "dist",
            "--package",
            "fga-cli",
        ];
        ran(self.cargo().args(build))?;
        let target = host()?;
        let folder = self.staged(&format!("fga-{}-{target}", self.version))?;
        let program = built(&self.root, "dist");
        let copied = BESIDE.map(|name| self.root.join(name));
        ran(Command::new("cp")
            .arg("-R")
            .arg(program)
            .args(copied)
            .arg(&folder))?;
        self.pack(&folder)
    }

    fn c_library(&self, target: Option<&str>) -> Result<(), String> {
        let name = target.map_or_else(host, |target| Ok(target.to_owned()))?;
        println!("the C library for {name}");
        let folder = self.staged(&format!("fga-c-{}-{name}", self.version))?;
        let build = self.out.join(".build").join(&name);
        let given = target.map(|target| format!("-DFGA_TARGET={target}"));
        ran(Command::new("cmake")
            .arg("-S")
            .arg(self.root.join("crates/fga-c"))
            .arg("-B")
            .arg(&build)
            .args(given))?;
        ran(Command::new("cmake").arg("--build").arg(&build))?;
        ran(Command::new("cmake")
            .arg("--install")
            .arg(&build)
            .arg("--prefix")
            .arg(&folder))?;
        let copied =
            ["CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"].map(|name| self.root.join(name));
        ran(Command::new("cp").args(copied).arg(&folder))?;
        self.pack(&folder)
    }

    fn wheel(&self) -> Result<(), String> {
        println!("the Python package");
        let python = env::var_os("FGA_PYTHON").unwrap_or_else(|| "python3".into());
        let wheel = ["-m", "pip", "wheel", "--no-deps", "--quiet", "--wheel-dir"];
        // Called by pip, maturin reads no symbols and gives the tag of this machine.
        ran(Command::new(python)
            .args(wheel)
            .arg(&self.out)
            .arg(self.root.join("python"))
            .env("MATURIN_PEP517_ARGS", "--compatibility pypi"))?;
        let made = fs::read_dir(&self.out).map_err(|error| error.to_string())?;
        let names = made.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        names
            .filter(|name| name.starts_with("fga_daa-"))
            .try_for_each(|name| for_any_machine(&name))
    }

    /// What each artifact is built of.
    fn parts(&self) -> Result<(), String> {
        let of = |(package, folder): (&str, &str)| {
            let mut cargo = self.cargo();
            let asked = [
                "--cargo-package",
                package,
                "--output-format",
                "spdx_json_2_3",
            ];
            cargo
                .arg("sbom")
                .args(asked)
                .arg("--project-directory")
                .arg(self.root.join(folder));
            let printed =
                ran(&mut cargo).map_err(|error| format!("{error} (cargo install cargo-sbom)"));
            Ok((format!("{package}-{}.spdx.json", self.version), printed?))
        };
        let packages = [
            ("fga-cli", "."),
            ("fga-c", "."),
            ("fga-python", "crates/fga-python"),
        ];
        let lists = packages
            .into_iter()
            .map(of)
            .collect::<Result<Vec<_>, String>>()?;
        let unusable = |error| format!("{}: {error}", self.out.display());
        fs::create_dir_all(&self.out).map_err(unusable)?;
        for (name, list) in lists {
            fs::write(self.out.join(name), list).map_err(unusable)?;
        }
        Ok(())
    }

    /// A folder of that name to fill.
    fn staged(&self, name: &str) -> Result<PathBuf, String> {
        let folder = self.out.join(".build").join(name);
        let made = fs::create_dir_all(&folder);
        made.map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(folder)
    }

    /// Packs a folder; the same sources give the same bytes.
    fn pack(&self, folder: &Path) -> Result<(), String> {
        let time = ran(Command::new("git")
            .args(["log", "-1", "--format=%cI"])
            .current_dir(&self.root))?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        ran(Command::new("tar")
            .args([
                "--sort=name",
                "--owner=0",
                "--group=0",
                "--numeric-owner",
                "--mode=u+rwX,go+rX,go-w",
            ])
            .arg(format!("--mtime={}", time.trim()))
            .args(["--use-compress-program", "gzip -n", "--create", "--file"])
            .arg(self.out.join(format!("{name}.tar.gz")))
            .arg("--directory")
            .arg(self.out.join(".build"))
            .arg(&*name))?;
        Ok(())
    }

    fn checksums(&self) -> Result<(), String> {
        let unusable = |error| format!("{}: {error}", self.out.display());
        fs::remove_dir_all(self.out.join(".build")).map_err(unusable)?;
        let entries = fs::read_dir(&self.out).map_err(unusable)?;
        let names = entries.map(|entry| Ok(entry.map_err(unusable)?.file_name()));
        let mut names = names.collect::<Result<Vec<_>, String>>()?;
        names.sort();
        let sums = ran(Command::new("sha256sum").args(names).current_dir(&self.out))?;
        fs::write(self.out.join("SHA256SUMS"), &sums).map_err(unusable)?;
        print!("{sums}");
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{for_any_machine, named};

    #[test]
    fn a_wheel_without_its_c_library_is_refused() {
        let of = |tag: &str| for_any_machine(&format!("fga_daa-0.1.0-cp310-abi3-{tag}.whl"));
        assert_eq!(of("manylinux_2_34_x86_64"), Ok(()));
        assert_eq!(of("macosx_11_0_arm64"), Ok(()));
        let refused = of("linux_x86_64").unwrap_err();
        assert!(refused.ends_with("expected manylinux_ or musllinux_"));
    }

    #[test]
    fn a_version_is_that_of_the_changelog_and_names_the_commit_where_there_is_more() {
        let log = "# Changelog\n\n## [Unreleased]\n\n## [0.2.0] - 2026-12-01\n- x\n";
        assert_eq!(named(log, "0.2.0", "abc"), Ok("0.2.0".into()));
        let more = log.replace("Unreleased]\n", "Unreleased]\n- y\n");
        assert_eq!(named(&more, "0.2.0", "abc"), Ok("0.2.0+gabc".into()));
        let refused = named(log, "0.3.0", "abc").unwrap_err();
        assert!(refused.contains("is 0.2.0, expected 0.3.0"), "{refused}");
    }
}

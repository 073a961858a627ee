//! What the tests of C programs share: the library as it is shipped, and the compiler.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

pub(crate) const WARNINGS: [&str; 5] =
    ["-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wpedantic"];
const SANITIZED: [&str; 3] = [
    "-g",
    "-fsanitize=address,undefined",
    "-fno-sanitize-recover=all",
];

/// These options of a compiler, and those of the sanitizers.
pub(crate) fn sanitized<'a>(options: &[&'a str]) -> Vec<&'a str> {
    [options, SANITIZED.as_slice()].concat()
}

pub(crate) fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn root() -> PathBuf {
    folder().join("../..")
}

/// Whether the tools are here.
pub(crate) fn have(tools: &[(&str, &str)]) -> bool {
    let missing = |tool: &str| Command::new(tool).arg("--version").output().is_err();
    for (tool, package) in tools {
        if missing(tool) {
            let sentence = format!("{tool} is not installed (Debian: {package}); skipped");
            assert!(std::env::var_os("CI").is_none(), "{sentence}");
            println!("{sentence}");
            return false;
        }
    }
    true
}

/// What a command printed; it must succeed.
pub(crate) fn ran(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let printed = String::from_utf8_lossy(&stdout).into_owned();
    let said = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{command:?}: {status}\n{printed}{said}");
    printed
}

/// The folder of the static library as it is shipped, built once.
pub(crate) fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("..");
        ran(Command::new(env!("CARGO"))
            .args([
                "rustc",
                "--quiet",
                "--package",
                "fga-c",
                "--lib",
                "--profile",
                "firmware",
            ])
            .args([
                "--crate-type",
                "staticlib",
                "--features",
                "staticlib",
                "--target-dir",
            ])
            .arg(&target)
            .env_remove("RUSTFLAGS")
            .current_dir(root()));
        let built = target.join("firmware/libfga_c.a");
        let folder = target.join("firmware/sealed");
        fs::create_dir_all(&folder).unwrap();
        ran(Command::new(self::folder().join("seal.sh"))
            .arg(built)
            .arg(folder.join("libfga_c.a")));
        folder
    })
}

/// Builds a program with the library.
pub(crate) fn build_at(source: &Path, compiler: &str, options: &[&str], into: &Path) -> PathBuf {
    build_all(&[source.to_owned()], compiler, options, into)
}

/// Builds a program of several files with the library.
pub(crate) fn build_all(
    sources: &[PathBuf],
    compiler: &str,
    options: &[&str],
    into: &Path,
) -> PathBuf {
    let program = into.join("program");
    ran(Command::new(compiler)
        .args(WARNINGS)
        .args(options)
        .args(sources)
        .arg("-I")
        .arg(folder().join("include"))
        .arg("-L")
        .arg(library())
        .args(["-lfga_c", "-lm", "-o"])
        .arg(&program));
    program
}

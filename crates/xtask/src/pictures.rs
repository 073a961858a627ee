//! `cargo xtask pictures`: makes every picture in `docs/pictures` from real runs.
//!
//! The program draws the pictures of runs; Chromium, driven by `viewer/pictures.mjs`, takes the
//! pictures of pages.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::command::{built, cargo};

/// A picture of a page.
struct Screenshot {
    /// File in `docs/pictures`.
    name: &'static str,
    /// Page below the folder of the runs.
    page: &'static str,
    /// More arguments of `viewer/pictures.mjs`.
    options: &'static [&'static str],
}

/// The runs: the arguments of `fga` without `--out`, and the folder of the results.
const RUNS: [(&[&str], &str); 6] = [
    (&["run", "scenarios/first-flight.toml"], "first-flight"),
    (
        &[
            "run",
            "scenarios/fig-17.toml",
            "--overlay",
            "published,none",
        ],
        "fig-17",
    ),
    (&["run", "scenarios/fig-10.toml"], "fig-10"),
    (&["run", "scenarios/fenced-valley.toml"], "fenced-valley"),
    (&["run", "scenarios/ridge.toml"], "ridge"),
    (
        &[
            "campaign",
            "run",
            "campaigns/table4-dynamic.toml",
            "--encounters",
            "3000",
        ],
        "campaign",
    ),
];

/// Pictures that the program itself draws: the file of a run, and its name in `docs/pictures`.
const DRAWN: [(&str, &str); 3] = [
    ("first-flight/overview.svg", "first-flight.svg"),
    ("fenced-valley/overview.svg", "zones.svg"),
    ("ridge/profile.svg", "ground.svg"),
];

/// Pictures of pages.
const SHOTS: [Screenshot; 4] = [
    Screenshot {
        name: "replay.png",
        page: "first-flight/replay.html",
        options: &[],
    },
    Screenshot {
        name: "replay-dark.png",
        page: "fig-17/replay.html",
        options: &["--theme", "dark"],
    },
    Screenshot {
        name: "replay-ground.png",
        page: "ridge/replay.html",
        options: &[],
    },
    Screenshot {
        name: "turn-aware.png",
        page: "fig-10/replay.html",
        options: &["--at", "28", "--press", "t", "--only", "#view"],
    },
];

/// A picture of what `fga view` serves of the campaign.
const TABLE: &str = "campaign.png";

/// Makes them all.
pub(crate) fn make() -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().map_err(|error| error.to_string())?;
    let workshop = Workshop {
        runs: root.join("target/pictures"),
        pictures: root.join("docs/pictures"),
        root,
    };
    workshop.build()?;
    for (arguments, folder) in RUNS {
        workshop.fly(arguments, folder)?;
    }
    for (from, to) in DRAWN {
        let to = workshop.pictures.join(to);
        fs::copy(workshop.runs.join(from), &to)
            .map_err(|error| format!("{}: {error}", to.display()))?;
        println!("{}", to.display());
    }
    workshop.animate("first-flight")?;
    for Screenshot {
        name,
        page,
        options,
    } in SHOTS
    {
        let page = workshop.runs.join(page);
        workshop.shoot(&page.to_string_lossy(), name, options)?;
    }
    let mut served = workshop.serve("campaign")?;
    let done = workshop.shoot(&served.address, TABLE, &["--table"]);
    served.stop();
    done
}

struct Workshop {
    root: PathBuf,
    runs: PathBuf,
    pictures: PathBuf,
}

/// `fga view` on a free port.
struct Served {
    process: Child,
    address: String,
}

impl Served {
    fn stop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Workshop {
    fn build(&self) -> Result<(), String> {
        self.succeed(cargo().args(["build", "--release", "--package", "fga-cli"]))
    }

    fn program(&self) -> Command {
        Command::new(built(&self.root, "release"))
    }

    /// Runs `fga`, with its results in the folder of that name.
    fn fly(&self, arguments: &[&str], folder: &str) -> Result<(), String> {
        let out = self.runs.join(folder);
        // A campaign does not start in a folder with results.
        let _ = fs::remove_dir_all(&out);
        let mut command = self.program();
        command.args(arguments).arg("--out").arg(&out);
        self.succeed(command.stdout(Stdio::null()))
    }

    /// The run as a picture that moves, in `docs/pictures`.
    fn animate(&self, run: &str) -> Result<(), String> {
        let picture = self.pictures.join(run).with_extension("gif");
        let mut command = self.program();
        command.arg("export").arg(self.runs.join(run));
        self.succeed(command.args(["--format", "gif", "--out"]).arg(picture))
    }

    fn serve(&self, folder: &str) -> Result<Served, String> {
        let mut command = self.program();
        command
            .arg("view")
            .arg(self.runs.join(folder))
            .args(["--listen", "127.0.0.1:0"])
            .stdout(Stdio::piped());
        let mut process = command
            .spawn()
            .map_err(|error| format!("fga view: {error}"))?;
        let mut address = String::new();
        if let Some(output) = process.stdout.take() {
            // Without an address the picture says what is wrong.
            let _ = BufReader::new(output).read_line(&mut address);
        }
        Ok(Served {
            process,
            address: address.trim().to_owned(),
        })
    }

    fn shoot(&self, page: &str, name: &str, options: &[&str]) -> Result<(), String> {
        let picture = self.pictures.join(name);
        let mut command = Command::new("node");
        command
            .arg("viewer/pictures.mjs")
            .args([page, &picture.to_string_lossy()])
            .args(options);
        self.succeed(&mut command).map_err(|error| {
            format!("{error}; pictures of pages need Node, Chromium and `npm ci` in viewer/")
        })?;
        println!("{}", picture.display());
        Ok(())
    }

    fn succeed(&self, command: &mut Command) -> Result<(), String> {
        let name = command.get_program().to_string_lossy().into_owned();
        match command.current_dir(&self.root).status() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(format!("{name} {status}")),
            Err(error) => Err(format!("{name}: {error}")),
        }
    }
}

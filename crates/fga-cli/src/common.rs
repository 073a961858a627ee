//! Common parts of the commands: options, output folder, threads, Ctrl-C, printing.

use core::net::SocketAddr;
use core::num::NonZeroUsize;
use core::sync::atomic::{AtomicBool, Ordering};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use fga_campaign::campaign::{MOST_ENCOUNTERS, parse_policy};
use fga_formats::InputError;
use fga_formats::tally::Tally;
use fga_sim::policy::{PolicyChoice, policy_names};
use fga_sim::vehicle_file::VehicleModel;

use crate::failure::Failure;

/// The policy.
#[derive(Args, Debug, Clone)]
pub(crate) struct PolicyArgs {
    /// The policy, with or without its start.
    #[arg(long, value_name = "POLICY", default_value = "turn-aware", help = policy_help())]
    pub(crate) policy: String,
    /// When a manoeuvre begins: t0, tc, latest, free or Cs=0.5.
    #[arg(long, value_name = "START")]
    pub(crate) start: Option<String>,
}

/// What `--policy` takes.
fn policy_help() -> String {
    format!(
        "The policy: {}, a program of your own. It may include a start, as in \"published --start t0\"",
        policy_names()
    )
}

impl PolicyArgs {
    /// The policy of these options.
    pub(crate) fn choice(&self) -> Result<PolicyChoice, Failure> {
        match (&self.start, self.policy.split_once(" --start ")) {
            (None, _) => parse_policy(&self.policy),
            (Some(start), None) => PolicyChoice::parse(&self.policy, Some(start)),
            (Some(start), Some(_)) => Err(format!(
                "--policy {} names a start and --start {start} is given, expected one of them",
                fga_formats::error::shown(&self.policy)
            )),
        }
        .map_err(Failure::Input)
    }
}

/// The form of a command's answer on standard output.
#[derive(Args, Debug, Clone, Copy)]
pub(crate) struct AnswerArgs {
    /// Print the answer as JSON.
    #[arg(long)]
    json: bool,
}

impl AnswerArgs {
    /// Prints the answer: in words that end with a line break, or as JSON.
    pub(crate) fn print(
        self,
        in_words: impl FnOnce() -> String,
        value: &serde_json::Value,
    ) -> Result<(), Failure> {
        if self.json {
            HAS_ANSWERED.store(true, Ordering::Relaxed);
            print(&format!("{value:#}\n"))
        } else {
            print(&in_words())
        }
    }
}

/// Whether an answer in JSON was printed: an answer may say what is wrong, and then the command fails.
static HAS_ANSWERED: AtomicBool = AtomicBool::new(false);

/// Prints a failure as JSON, where no answer says it.
pub(crate) fn print_failure(failure: &Failure) {
    if !HAS_ANSWERED.load(Ordering::Relaxed) {
        // The exit code says the rest, whoever reads.
        let _ = print(&format!(
            "{:#}\n",
            serde_json::json!({ "error": failure.to_string() })
        ));
    }
}

/// Says on standard error what was left out of an input: whole files by their faults, and parts of the others.
pub(crate) fn tell_left_out(damaged: &[String], tally: &Tally, parts: &str) {
    for sentence in damaged {
        eprintln!("fga: left out: {sentence}");
    }
    if let Some(words) = tally.words(parts) {
        eprintln!("fga: left out: {words}");
    }
}

/// Says on standard error how often policies of one's own failed.
pub(crate) fn tell_failures<'a>(policies: impl IntoIterator<Item = &'a PolicyChoice>) {
    for own in policies.into_iter().filter_map(PolicyChoice::own) {
        if let Some(sentence) = own.failures_in_words() {
            eprintln!("fga: {sentence}");
        }
    }
}

/// More flights for the replay page.
#[derive(Args, Debug, Clone)]
pub(crate) struct OverlayArgs {
    /// More policies for the replay page, as in "none,published --start t0".
    #[arg(long, value_name = "POLICIES", value_delimiter = ',')]
    overlay: Vec<String>,
}

impl OverlayArgs {
    /// The policies to show beside `flown`.
    pub(crate) fn choices(&self, flown: &PolicyChoice) -> Result<Vec<PolicyChoice>, Failure> {
        let mut names = vec![flown.name()];
        let mut choices = Vec::new();
        for text in &self.overlay {
            let choice = parse_policy(text).map_err(Failure::Input)?;
            let name = choice.name();
            if names.contains(&name) {
                let message =
                    format!("--overlay {name}: is flown already, expected another policy");
                return Err(Failure::Input(message));
            }
            names.push(name);
            choices.push(choice);
        }
        Ok(choices)
    }
}

/// The aircraft.
#[derive(Args, Debug, Clone)]
pub(crate) struct VehicleArgs {
    /// Vehicle file; without it the scenario's vehicle, for recordings the light aircraft of
    /// vehicles/general-aviation.toml, else the aircraft of the paper's Table 4.
    #[arg(long, value_name = "FILE")]
    pub(crate) vehicle: Option<PathBuf>,
}

impl VehicleArgs {
    /// The vehicle file, if given.
    pub(crate) fn given(&self) -> Result<Option<VehicleModel>, InputError> {
        self.vehicle.as_deref().map(VehicleModel::read).transpose()
    }

    /// The vehicle file, else the built-in vehicle.
    pub(crate) fn model(&self) -> Result<VehicleModel, InputError> {
        self.given()?.map_or_else(VehicleModel::built_in, Ok)
    }
}

/// The folder of the results.
#[derive(Args, Debug, Clone)]
pub(crate) struct OutArgs {
    /// Folder for the results; without it out/<name of the input>.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

impl OutArgs {
    /// The folder, created and proved writable.
    pub(crate) fn prepare(&self, input: &Path) -> Result<PathBuf, Failure> {
        let folder = self
            .out
            .clone()
            .unwrap_or_else(|| Path::new("out").join(input.file_stem().unwrap_or("run".as_ref())));
        fga_formats::atomic::prepare_folder(&folder)?;
        Ok(folder)
    }

    /// The folder of a flight. One that nobody named and that holds results of another input gets a number: `out/a-2`.
    pub(crate) fn prepare_run(&self, input: &Path) -> Result<PathBuf, Failure> {
        if self.out.is_some() {
            return self.prepare(input);
        }
        let stem = input.file_stem().unwrap_or("run".as_ref());
        let first = Path::new("out").join(stem);
        let numbered = (2..=MOST_NUMBERED).map(|number| {
            let mut name = stem.to_owned();
            name.push(format!("-{number}"));
            Path::new("out").join(name)
        });
        let mut folders = core::iter::once(first.clone()).chain(numbered);
        let folder = folders.find(|folder| !holds_another(folder, input)).ok_or_else(|| {
            let shown = first.display();
            let message = format!("{shown} to {shown}-{MOST_NUMBERED} hold results of other inputs, expected --out DIR");
            Failure::Input(message)
        })?;
        if folder != first {
            eprintln!(
                "fga: {} holds results of another input and stays as it is; these go to {}",
                first.display(),
                folder.display()
            );
        }
        fga_formats::atomic::prepare_folder(&folder)?;
        Ok(folder)
    }
}

/// The largest number behind the name of a folder.
const MOST_NUMBERED: u32 = 99;

/// Whether a folder holds results of another input: its `run.json` names another file, or is no flight's.
fn holds_another(folder: &Path, input: &Path) -> bool {
    let document = folder.join("run.json");
    let Ok(text) = std::fs::read_to_string(document) else {
        return false;
    };
    let value: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let Some(named) = value.get("input").and_then(serde_json::Value::as_str) else {
        return true;
    };
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    // A moved folder names a file that is no longer there: the name of the file decides.
    let named = Path::new(named);
    if named.exists() {
        whole(named) != whole(input)
    } else {
        named.file_name() != input.file_name()
    }
}

/// The number of threads.
#[derive(Args, Debug, Clone)]
pub(crate) struct ThreadArgs {
    /// Threads to use, 1 to 1024; without it one for each core.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

impl ThreadArgs {
    /// Runs `work` on this number of threads.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, NonZeroUsize::get))
            .build()
            .map_err(|error| Failure::Input(format!("threads cannot be started: {error}")))?;
        Ok(pool.install(work))
    }
}

/// More threads than this only take memory and time from each other.
const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let count: Option<NonZeroUsize> = text.parse().ok();
    count
        .filter(|count| count.get() <= MOST_THREADS)
        .ok_or_else(|| format!("expected a whole number from 1 to {MOST_THREADS}"))
}

/// A number of encounters, as `--encounters` takes it.
pub(crate) fn encounters(text: &str) -> Result<u64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (1..=MOST_ENCOUNTERS).contains(number))
        .ok_or_else(|| format!("expected a whole number from 1 to {MOST_ENCOUNTERS}"))
}

/// An address to listen on, as `--listen` takes it.
pub(crate) fn listen_address(text: &str) -> Result<SocketAddr, String> {
    text.parse()
        .map_err(|_| "expected ADDRESS:PORT, as in 127.0.0.1:8787".to_owned())
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C sets a flag, so that the program can remove unfinished files; a second Ctrl-C
/// ends it at once.
pub(crate) fn watch_for_interrupt() {
    // Without a handler Ctrl-C ends the program at once, which is also safe.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
}

/// Whether Ctrl-C was pressed.
pub(crate) fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// Prints to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(Failure::of_stdout)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_may_stand_with_the_policy_but_not_twice() {
        let choice = |policy: &str, start: Option<&str>| {
            PolicyArgs {
                policy: policy.into(),
                start: start.map(Into::into),
            }
            .choice()
            .map(|choice| choice.name())
        };
        assert_eq!(
            choice("published --start t0", None).unwrap(),
            "published --start t0"
        );
        assert_eq!(
            choice("published", Some("t0")).unwrap(),
            "published --start t0"
        );
        assert!(choice("published --start t0", Some("tc")).is_err());
    }
}

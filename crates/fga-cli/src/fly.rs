//! `fga fly`: the companion on a vehicle, or its decisions repeated from a recording.

use alloc::sync::Arc;
use core::net::SocketAddr;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga_formats::InputError;
use fga_formats::error::{read_bytes, read_text};
use fga_formats::gzip::unpacked;
use fga_formats::terrain::Terrain;
use fga_link::config::PolicyName;
use fga_link::endpoint::Endpoint;
use fga_link::fly::{FlyOptions, fly};
use fga_link::replay::{differences, replay};
use fga_link::traffic::receiver::ReceiverEndpoint;
use fga_link::{Companion, Config};

use crate::common::listen_address;
use crate::failure::Failure;
use crate::fly_live::FlyLive;

/// Flies avoiding manoeuvres on an ArduPlane vehicle over MAVLink.
#[derive(Args)]
pub(crate) struct FlyArgs {
    /// Endpoint of the vehicle: udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT
    /// or serial:PATH[:BAUD].
    #[arg(long, value_name = "ENDPOINT", required_unless_present = "replay")]
    connect: Option<Endpoint>,
    /// The configuration (TOML); without it every key has its default.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// What decides what is flown, worst-case or belief; without it the configuration's command.policy.
    #[arg(long, value_name = "POLICY", value_parser = policy)]
    policy: Option<PolicyName>,
    /// A receiver of traffic: sbs:HOST:PORT, beast:HOST:PORT, flarm:HOST:PORT, or gdl90:0.0.0.0:4000 for its datagrams to this port; may be given several times.
    #[arg(long, value_name = "RECEIVER")]
    traffic: Vec<ReceiverEndpoint>,
    /// Report only: send no commands.
    #[arg(long)]
    dry_run: bool,
    /// Repeat the decisions from a telemetry log instead of flying; print them on standard output.
    #[arg(long, value_name = "LOG", conflicts_with_all = ["connect", "traffic"])]
    replay: Option<PathBuf>,
    /// Folder for the telemetry log and the decision log.
    #[arg(long, value_name = "DIR", default_value = "out/fly")]
    out: PathBuf,
    /// Show the flight in the browser.
    #[arg(long, conflicts_with = "replay")]
    live: bool,
    /// With --live: address to listen on; port 0 takes a free one.
    #[arg(
        long,
        value_name = "ADDRESS:PORT",
        default_value = "127.0.0.1:0",
        requires = "live",
        value_parser = listen_address
    )]
    listen: SocketAddr,
    /// No status line.
    #[arg(long)]
    quiet: bool,
}

impl FlyArgs {
    /// A flight with a status line, on a vehicle alone.
    pub(crate) fn on(connect: Endpoint, config: Option<PathBuf>, out: PathBuf, live: bool) -> Self {
        Self {
            connect: Some(connect),
            config,
            policy: None,
            traffic: Vec::new(),
            dry_run: false,
            replay: None,
            out,
            live,
            listen: SocketAddr::from(([127, 0, 0, 1], 0)),
            quiet: false,
        }
    }
}

fn policy(name: &str) -> Result<PolicyName, String> {
    PolicyName::from_name(name).ok_or_else(|| "expected worst-case or belief".to_owned())
}

pub(crate) fn run(args: &FlyArgs) -> Result<ExitCode, Failure> {
    run_until(args, &count_interrupts())
}

/// Flies until the number of signals to end is not 0.
pub(crate) fn run_until(args: &FlyArgs, signals: &Arc<AtomicU32>) -> Result<ExitCode, Failure> {
    let (mut config, terrain) = read_config(args.config.as_ref())?;
    if let Some(policy) = args.policy {
        config.command.policy = policy;
    }
    if let Some(path) = &args.replay {
        return run_replay(config, terrain, path);
    }
    let Some(endpoint) = args.connect.clone() else {
        return Err(Failure::Input("--connect ENDPOINT is missing".to_owned()));
    };
    let options = FlyOptions {
        endpoint,
        config,
        traffic: args.traffic.clone(),
        terrain,
        dry_run: args.dry_run,
        out: args.out.clone(),
        status: !args.quiet,
        end_program: || std::process::abort(),
    };
    let mut live = args.live.then(|| begin_live(args.listen)).transpose()?;
    let flown = fly(&options, signals, &mut |companion| {
        if let Some(live) = &mut live {
            live.show(companion);
        }
    });
    if let Some(live) = live {
        live.end();
    }
    flown
        .map_err(|error| Failure::Input(format!("fly on {}: {error}", shown(&options.endpoint))))?;
    Ok(ExitCode::SUCCESS)
}

/// The endpoint as `--connect` takes it.
pub(crate) fn shown(endpoint: &Endpoint) -> String {
    match endpoint {
        Endpoint::UdpIn(address) => format!("udpin:{address}"),
        Endpoint::UdpOut(address) => format!("udpout:{address}"),
        Endpoint::Tcp(address) => format!("tcp:{address}"),
        Endpoint::TcpIn(address) => format!("tcpin:{address}"),
        Endpoint::Serial { path, baud } => format!("serial:{path}:{baud}"),
    }
}

fn begin_live(address: SocketAddr) -> Result<FlyLive, Failure> {
    let live = FlyLive::begin(address)
        .map_err(|error| Failure::Input(format!("cannot listen on {address}: {error}")))?;
    // It works without a reader too.
    let _ = writeln!(io::stderr(), "live at http://{}/", live.address());
    Ok(live)
}

/// A flag that SIGINT, SIGTERM and SIGHUP set: Ctrl-C, the end of the service or of the terminal.
pub(crate) fn stop_on_interrupt() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // A second handler is refused; then the first one serves.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    stop
}

/// The number of interrupts so far.
pub(crate) fn count_interrupts() -> Arc<AtomicU32> {
    let count = Arc::new(AtomicU32::new(0));
    let counter = Arc::clone(&count);
    let _ = ctrlc::set_handler(move || _ = counter.fetch_add(1, Ordering::Relaxed));
    count
}

fn read_config(path: Option<&PathBuf>) -> Result<(Config, Option<Arc<Terrain>>), Failure> {
    let Some(path) = path else {
        return Ok((Config::default(), None));
    };
    let (config, terrain) = config_file(path)?;
    for warning in config.warnings() {
        let _ = writeln!(io::stderr(), "fga: {}: warning: {warning}", path.display());
    }
    Ok((config, terrain))
}

/// Reads and checks a configuration and the heights of the ground that it names.
pub(crate) fn config_file(path: &Path) -> Result<(Config, Option<Arc<Terrain>>), Failure> {
    let text = read_text(path)?;
    let config = Config::parse(&text).map_err(|error| {
        let error = error.to_string();
        let shown = path.display();
        // The sentence begins with the line, or with the key, if it has one.
        let told = match line_of(&text, &error) {
            Some(line) => format!("{shown}, line {line}: {error}"),
            None if error.starts_with("line ") => format!("{shown}, {error}"),
            None => format!("{shown}: {error}"),
        };
        Failure::Input(told)
    })?;
    let terrain = config.read_terrain(path.parent().unwrap_or(Path::new("")))?;
    Ok((config, terrain))
}

/// The line of the key, as in `protection.radius_m`, with which a sentence begins.
fn line_of(text: &str, sentence: &str) -> Option<usize> {
    let dotted = sentence.split([' ', ':']).next()?;
    let (table, key) = dotted.split_once('.')?;
    let mut within = "";
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(header) = line.strip_prefix('[') {
            within = header.split(']').next().unwrap_or_default().trim();
        } else if let Some((name, _)) = line.split_once('=') {
            let name = name.trim();
            if (within == table && name == key) || (within.is_empty() && name == dotted) {
                return Some(index + 1);
            }
        }
    }
    None
}

fn run_replay(
    config: Config,
    terrain: Option<Arc<Terrain>>,
    path: &Path,
) -> Result<ExitCode, Failure> {
    let named = |error: io::Error| Failure::Input(format!("{}: {error}", path.display()));
    let bytes = read_bytes(path)?;
    let log = unpacked(&bytes, path)?;
    let mut companion =
        Companion::new(config, false).map_err(|error| Failure::Input(error.to_string()))?;
    companion.set_terrain(terrain);
    let mut failed = None;
    let mut lines = Vec::new();
    let mut out = io::stdout().lock();
    let done = replay(log.as_ref(), &mut companion, |line| {
        lines.push(line.to_string());
        writeln!(out, "{line}").inspect_err(|error| failed = Some(error.kind()))
    });
    let done = match (done, failed) {
        (Ok(done), _) => done,
        (Err(error), Some(_)) => return Err(Failure::of_stdout(error)),
        (Err(error), None) => return Err(named(error)),
    };
    if done.decisions == 0 {
        return Err(Failure::Input(format!(
            "{}: holds no decision ({} frames, {} not understood), expected the log of a flight",
            path.display(),
            done.frames,
            done.skipped
        )));
    }
    // The decisions are printed, but say nothing about the flight's.
    let not_compared =
        |why: String| Err(Failure::Input(format!("{why}: no decision was compared")));
    let log = path.display();
    if !done.has_steps {
        return not_compared(format!(
            "{log}: holds no steps of the program, expected a log of fga fly that has them"
        ));
    }
    if !done.repeats {
        return not_compared(format!(
            "{log}: was flown with another configuration, expected the flight's --config and --policy"
        ));
    }
    let flown = path.with_file_name(decision_log(path));
    let beside = flown.display();
    let text = match fs::read_to_string(&flown) {
        Ok(text) => text,
        Err(error) => {
            let error = InputError::unreadable(&flown, &error);
            return not_compared(format!("{error}, expected the flight's decision log"));
        }
    };
    if let Some((count, first)) = differences(&text, &lines) {
        return Err(Failure::Input(format!(
            "{log}: decides otherwise than its flight in {count} of the lines of {beside}, first in {first}"
        )));
    }
    eprintln!(
        "{} frames, {} not understood; all {} lines are those of {beside}",
        done.frames,
        done.skipped,
        lines.len()
    );
    Ok(ExitCode::SUCCESS)
}

/// The name of the decision log beside a telemetry log, which may be compressed.
fn decision_log(path: &Path) -> PathBuf {
    let name = PathBuf::from(path.file_name().unwrap_or_default());
    let is_packed = name.extension().is_some_and(|ending| ending == "gz");
    let name = if is_packed {
        name.with_extension("")
    } else {
        name
    };
    name.with_extension("jsonl")
}

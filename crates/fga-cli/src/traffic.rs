//! `fga traffic`: plays other aircraft to a vehicle or to readers of BaseStation lines.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga_formats::recordings::{self, Content};
use fga_link::endpoint::Endpoint;
use fga_link::play::{PlayOptions, Script, play};
use fga_link::player::{PlayerLine, from_recording, from_states, read_log};

use crate::common::tell_left_out;
use crate::failure::Failure;
use crate::fly::stop_on_interrupt;

/// Play intruders as `ADSB_VEHICLE` messages and as BaseStation lines.
#[derive(Args)]
pub(crate) struct TrafficArgs {
    /// The source: a recording, state vectors in JSON or a BaseStation log, as `fga batch` reads them.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// A straight line: `ICAO,LATITUDE,LONGITUDE,ALTITUDE_M,TRACK_DEG,SPEED_MPS[,CLIMB_MPS[,AT_S]]`.
    #[arg(long, conflicts_with = "file", allow_hyphen_values = true)]
    line: Vec<PlayerLine>,
    /// Send `ADSB_VEHICLE` to this endpoint: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT.
    #[arg(long, value_name = "ENDPOINT")]
    to: Option<Endpoint>,
    /// Serve BaseStation lines on this address, such as 127.0.0.1:30003.
    #[arg(long, value_name = "HOST:PORT", value_parser = host_and_port)]
    serve_sbs: Option<String>,
    /// Speed as a multiple of the recorded time, 0.01 to 1000.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    speed: f64,
    /// Reports of each aircraft per second, 0.1 to 50.
    #[arg(long, value_name = "HZ", default_value_t = 2.0)]
    rate: f64,
    /// Start again at the end.
    #[arg(long)]
    again: bool,
}

/// An address with a port; the name of the host is looked up later.
fn host_and_port(text: &str) -> Result<String, String> {
    text.rsplit_once(':')
        .filter(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok())
        .map(|_| text.to_owned())
        .ok_or_else(|| "expected HOST:PORT, as in 127.0.0.1:30003".to_owned())
}

pub(crate) fn run(args: &TrafficArgs) -> Result<ExitCode, Failure> {
    if !(0.01..=1000.0).contains(&args.speed) {
        return Err(Failure::Input(format!(
            "--speed is {}, expected 0.01 to 1000",
            args.speed
        )));
    }
    if !(0.1..=50.0).contains(&args.rate) {
        return Err(Failure::Input(format!(
            "--rate is {}, expected 0.1 to 50",
            args.rate
        )));
    }
    if args.file.is_none() && args.line.is_empty() {
        return Err(Failure::Input(
            "nothing to play is given, expected a FILE or --line (see fga traffic --help)".into(),
        ));
    }
    if args.to.is_none() && args.serve_sbs.is_none() {
        return Err(Failure::Input(
            "no receiver is given, expected --to or --serve-sbs (see fga traffic --help)".into(),
        ));
    }
    let script = match &args.file {
        Some(path) => read_script(path)?,
        None => Script::Aircraft(args.line.iter().map(|line| line.0.clone()).collect()),
    };
    let options = PlayOptions {
        to: args.to.clone(),
        serve_sbs: args.serve_sbs.clone(),
        speed: args.speed,
        rate_hz: args.rate,
        again: args.again,
    };
    let sent = play(&script, &options, &stop_on_interrupt())
        .map_err(|error| Failure::Input(format!("traffic: {error}")))?;
    let messages = options
        .to
        .as_ref()
        .map(|_| format!("{} messages sent", sent.messages));
    let lines = options.serve_sbs.as_ref().map(|_| {
        let plural = if sent.readers == 1 { "" } else { "s" };
        format!(
            "{} lines sent to {} reader{plural}",
            sent.lines, sent.readers
        )
    });
    let told: Vec<String> = messages.into_iter().chain(lines).collect();
    eprintln!("{}", told.join(", "));
    Ok(ExitCode::SUCCESS)
}

fn read_script(path: &Path) -> Result<Script, Failure> {
    let (script, tally, parts, expected) = match recordings::read_content(path)? {
        Content::Lines(text) => {
            let (lines, tally) = read_log(text.as_bytes());
            let expected = "line of BaseStation with a time";
            (Script::Log(lines), tally, "lines", expected)
        }
        Content::States(received) => (
            Script::Aircraft(from_states(&received)),
            received.tally,
            "state vectors",
            "aircraft in the air with a position and an altitude",
        ),
        Content::Recording(recording) => (
            Script::Aircraft(from_recording(&recording)),
            recording.tally,
            "rows",
            "aircraft with latitude and longitude",
        ),
    };
    tell_left_out(&[], &tally, parts);
    if script.is_empty() {
        return Err(Failure::Input(format!(
            "{}: has no {expected}, expected at least one",
            path.display()
        )));
    }
    Ok(script)
}

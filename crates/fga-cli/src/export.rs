//! `fga export`: converts a run for other programs.

use core::time::Duration;
use std::path::PathBuf;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::Instant;

use clap::Args;
use fga::avoider::State;
use fga_formats::export::flightgear::{self, FlightGearSender};
use fga_formats::export::{self, Format};
use fga_formats::flight::Flight;
use fga_formats::{InputError, atomic};
use fga_report::animation;
use fga_report::overview::{Overview, OverviewObstacle, OverviewPoint, PathSample};
use serde_json::json;

use crate::common::{AnswerArgs, interrupted, watch_for_interrupt};
use crate::failure::Failure;
use fga_results::flight_file;

/// Options of `fga export`.
#[derive(Args, Debug)]
pub(crate) struct ExportArgs {
    /// Folder that `fga run` wrote, or the flight.json in it.
    run: PathBuf,
    /// Write a file: kml (Google Earth), czml (Cesium), geojson (maps), mcap (Foxglove, PlotJuggler),
    /// gif (the top view as a picture that moves).
    #[arg(long, required_unless_present = "flightgear", value_parser = export_format)]
    format: Option<ExportFormat>,
    /// File to write; without it flight.<format> beside the run.
    #[arg(long, value_name = "FILE", requires = "format")]
    out: Option<PathBuf>,
    /// Play the flight to a FlightGear at this address, and write its protocol file fga.xml beside
    /// the run.
    #[arg(long, value_name = "HOST:PORT")]
    flightgear: Option<String>,
    /// Playing speed as a multiple of real time.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = factor, requires = "flightgear")]
    speed: f64,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// What can be written.
#[derive(Debug, Clone, Copy)]
enum ExportFormat {
    Data(Format),
    Gif,
}

impl ExportFormat {
    const fn name(self) -> &'static str {
        match self {
            Self::Data(format) => format.name(),
            Self::Gif => "gif",
        }
    }
}

fn export_format(name: &str) -> Result<ExportFormat, String> {
    if name.eq_ignore_ascii_case("gif") {
        return Ok(ExportFormat::Gif);
    }
    name.parse()
        .map(ExportFormat::Data)
        .map_err(|message: String| message.replace(" or mcap", ", mcap or gif"))
}

/// A factor from 0.01 to 1000.
fn factor(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|factor| (0.01..=1000.0).contains(factor))
        .ok_or_else(|| "expected a factor from 0.01 to 1000".into())
}

/// Reads the run and writes or plays it.
pub(crate) fn run(args: &ExportArgs) -> Result<ExitCode, Failure> {
    let file = if args.run.is_dir() {
        args.run.join(flight_file::NAME)
    } else {
        args.run.clone()
    };
    let flight = Flight::read(&file)?;
    let sender = args.flightgear.as_deref().map(sender).transpose()?;
    let mut written = Vec::new();
    if let Some(format) = args.format {
        let out = args
            .out
            .clone()
            .unwrap_or_else(|| file.with_file_name(format!("flight.{}", format.name())));
        match format {
            ExportFormat::Data(format) => export::write(&flight, format, &out)?,
            ExportFormat::Gif => {
                let bytes = animation::gif(&seen(&flight))
                    .map_err(|message| InputError::in_file(&file, message))?;
                atomic::write(&out, bytes)?;
            }
        }
        written.push(out.display().to_string());
    }
    if sender.is_some() {
        let protocol = file.with_file_name("fga.xml");
        atomic::write(&protocol, flightgear::PROTOCOL_XML)?;
        written.push(protocol.display().to_string());
    }
    args.answer
        .print(|| written.join("\n") + "\n", &json!({ "files": written }))?;
    if let Some(sender) = &sender {
        play(&flight, sender, args.speed)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// What the picture that moves shows of a flight.
fn seen(flight: &Flight) -> Overview {
    let state = |name: &str| State::ALL.into_iter().find(|state| state.name() == name);
    let samples = flight.samples.iter().map(|sample| PathSample {
        time_s: sample.time_s,
        position_m: sample.position_m,
        state: state(&sample.state).unwrap_or_default(),
    });
    let obstacles = flight.obstacles.iter().zip(1..).map(|(obstacle, id)| {
        let track = obstacle.track.iter().map(|row| OverviewPoint {
            time_s: row.time_s,
            position_m: row.position_m,
        });
        OverviewObstacle {
            id,
            name: obstacle.name.clone(),
            volume: obstacle.volume,
            track: track.collect(),
            closest: None,
        }
    });
    Overview {
        title: flight.name.clone(),
        mission_m: flight.mission.clone(),
        samples: samples.collect(),
        obstacles: obstacles.collect(),
        ..Overview::default()
    }
}

fn sender(target: &str) -> Result<FlightGearSender, Failure> {
    FlightGearSender::new(target).map_err(|error| {
        let message = format!("cannot be sent to: {error}, expected HOST:PORT of a FlightGear");
        InputError::in_file(target, message).into()
    })
}

/// Sends the flight at the chosen speed; Ctrl-C ends it.
fn play(flight: &Flight, sender: &FlightGearSender, speed: f64) -> Result<(), Failure> {
    watch_for_interrupt();
    let frame = flight.frame();
    let begun = Instant::now();
    let first_s = flight.span_s().0;
    for (index, sample) in flight.samples.iter().enumerate() {
        if interrupted() {
            return Err(Failure::Interrupted);
        }
        let due = Duration::try_from_secs_f64((sample.time_s - first_s) / speed);
        sleep(due.unwrap_or_default().saturating_sub(begun.elapsed()));
        // The speed over the ground since the sample before, for the instrument.
        let speed_mps = index
            .checked_sub(1)
            .and_then(|before| flight.samples.get(before))
            .or(flight.samples.get(1))
            .map_or(0.0, |other| {
                let distance_m = (sample.position_m - other.position_m).length();
                distance_m / (sample.time_s - other.time_s).abs().max(1e-9)
            });
        sender.send(&frame, sample, speed_mps);
    }
    Ok(())
}

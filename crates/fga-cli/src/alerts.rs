//! `fga alerts`: which alert levels do the standards give a recording?

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_formats::atomic;
use fga_formats::conf::{self, Configuration};
use fga_formats::daa::instants::{self, Instants};
use fga_formats::daa::tables::{DaaTables, watch};
use serde_json::json;

use crate::common::{AnswerArgs, OutArgs, tell_left_out};
use crate::failure::Failure;

/// Options of `fga alerts`.
#[derive(Args, Debug)]
pub(crate) struct AlertsArgs {
    #[command(flatten)]
    pub(crate) input: DetectArgs,
}

/// A recording and a configuration.
#[derive(Args, Debug)]
pub(crate) struct DetectArgs {
    /// Recording in the `.daa` format; its first aircraft is the ownship.
    pub(crate) recording: PathBuf,
    /// Configuration in the `.conf` format of DAIDALUS.
    #[arg(long, value_name = "FILE")]
    config: PathBuf,
    #[command(flatten)]
    pub(crate) out: OutArgs,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

impl DetectArgs {
    /// Reads both files.
    pub(crate) fn read(&self) -> Result<(Instants, Configuration), Failure> {
        let recording = instants::read(&self.recording)?;
        tell_left_out(&[], &recording.tally, "rows");
        let configuration = conf::read(&self.config)?;
        if recording.names.len() < 2 {
            return Err(Failure::Input(format!(
                "{}: holds one aircraft only, expected the ownship and at least one more",
                self.recording.display()
            )));
        }
        Ok((recording, configuration))
    }

    /// A state that the monitor refuses, with the file.
    pub(crate) fn refused(&self, message: &str) -> Failure {
        Failure::Input(format!("{}: {message}", self.recording.display()))
    }
}

/// Writes `alerts.csv`.
pub(crate) fn run(args: &AlertsArgs) -> Result<ExitCode, Failure> {
    let input = &args.input;
    let (recording, configuration) = input.read()?;
    let folder = input.out.prepare(&input.recording)?;
    let tables = DaaTables {
        recording: &recording,
        configuration: &configuration,
    };
    let mut text = tables.alerts_head();
    let mut times = 0;
    let mut highest: Option<(usize, f64)> = None;
    watch(&recording, &configuration, |monitor, scene| {
        tables.alerts_rows(monitor, scene, &mut text);
        times += 1;
        let level = monitor.highest_level();
        if level > 0 && highest.is_none_or(|(seen, _)| level > seen) {
            highest = Some((level, scene.time_s));
        }
    })
    .map_err(|message| input.refused(&message))?;
    let path = folder.join("alerts.csv");
    atomic::write(&path, text)?;
    let what = highest.map_or_else(
        || "no alert".to_owned(),
        |(level, time_s)| format!("highest level {level}, first at {time_s} s"),
    );
    input.answer.print(
        || format!("{times} instants, {what}; alerts in {}\n", path.display()),
        &json!({
            "instants": times,
            "highest_level": highest.map_or(0, |(level, _)| level),
            "highest_level_t_s": highest.map(|(_, time_s)| time_s),
            "left_out": recording.tally.to_json(),
            "file": path.display().to_string(),
        }),
    )?;
    Ok(ExitCode::SUCCESS)
}

//! Arguments of a batch.

use std::path::PathBuf;

use clap::Args;

use crate::common::{AnswerArgs, OutArgs, PolicyArgs, ThreadArgs, VehicleArgs};

/// Options of `fga batch`.
#[derive(Args, Debug)]
pub(crate) struct BatchArgs {
    /// Encounters: a table with the columns
    /// `encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m`, a recording, a folder of
    /// recordings, or a folder that `fga campaign draw` wrote.
    pub(crate) encounters: PathBuf,
    #[command(flatten)]
    pub(crate) policy: PolicyArgs,
    #[command(flatten)]
    pub(crate) vehicle: VehicleArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Longest time flown in an encounter, seconds; without it 60, for recordings until the way back ends.
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    pub(crate) horizon: Option<f64>,
    /// Exit with 0 although damaged recordings were left out.
    #[arg(long)]
    pub(crate) skip_damaged: bool,
    /// Also write tracks.csv: the aircraft's track, at most 0.1 s between rows.
    #[arg(long)]
    pub(crate) tracks: bool,
    /// Write replay pages of the N worst encounters: replay/<encounter>.html.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) replay: usize,
    /// Master seed for the sensor noise of the vehicle file.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

/// A positive number of seconds, at most a day.
pub(crate) fn positive_seconds(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|seconds| *seconds > 0.0 && *seconds <= 86_400.0)
        .ok_or_else(|| "expected a positive number of seconds, at most 86400".into())
}

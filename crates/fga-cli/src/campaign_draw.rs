//! `fga campaign draw`: writes a campaign's encounters as files for other programs.

use core::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_formats::{atomic, daa, encounters};
use fga_sim::campaign::file::{self, Overrides};
use fga_sim::campaign::{Campaign, Scene};
use serde_json::json;

use crate::campaign::SourceArgs;
use crate::common::{AnswerArgs, OutArgs};
use crate::failure::Failure;

/// Options of `fga campaign draw`.
#[derive(Args, Debug)]
pub(crate) struct DrawArgs {
    /// The campaign file (.toml).
    file: PathBuf,
    /// Number of encounters over all cells; without it the file's number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    encounters: Option<u64>,
    #[command(flatten)]
    sources: SourceArgs,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Writes `encounters.csv` of obstacles around the line, `recordings/` of aircraft with tracks, and
/// `drawn.csv` with the source and weight of each.
pub(crate) fn run(args: &DrawArgs) -> Result<ExitCode, Failure> {
    let overrides = Overrides {
        encounters: args.encounters,
        ..args.sources.overrides()
    };
    let configuration = file::read(&args.file, &overrides)?;
    let campaign = Campaign::new(configuration, &args.file)?;
    let folder = args.out.prepare(&args.file)?;
    let count = campaign.configuration.encounters;
    let mut rows = Vec::new();
    let mut recordings = 0_u64;
    let mut list = String::from("encounter,source,source_encounter,seed,weight,file\n");
    for number in 0..count {
        let drawn = campaign.draw(number)?;
        let source = campaign
            .source_names()
            .get(drawn.source as usize)
            .map_or("", String::as_str);
        let file = match drawn.scene {
            Scene::Rows(encounter) => {
                rows.push(encounter);
                "encounters.csv".to_owned()
            }
            Scene::Tracks(recording) => {
                if recordings == 0 {
                    atomic::prepare_folder(&folder.join("recordings"))?;
                }
                recordings += 1;
                let name = format!("recordings/{number:08}.daa");
                daa::write(&folder.join(&name), &recording)?;
                name
            }
        };
        let _ = writeln!(
            list,
            "{number},\"{}\",{},{},{:.9},{file}",
            source.replace('"', "\"\""),
            drawn.source_encounter,
            drawn.seed,
            drawn.weight
        );
    }
    let path = folder.join("encounters.csv");
    if !rows.is_empty() {
        encounters::write(&path, &rows)?;
    }
    atomic::write(&folder.join("drawn.csv"), list)?;
    let shown = if recordings == 0 { &path } else { &folder };
    args.answer.print(
        || format!("{count} encounters drawn: {}\n", shown.display()),
        &json!({
            "encounters": count,
            "file": shown.display().to_string(),
            "rows": rows.len(),
            "recordings": recordings,
        }),
    )?;
    Ok(ExitCode::SUCCESS)
}

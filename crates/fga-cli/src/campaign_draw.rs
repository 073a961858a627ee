//! `fga campaign draw`: writes a campaign's encounters as files for other programs.

use core::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga_campaign::campaign::file::{self, Overrides};
use fga_campaign::campaign::{Campaign, CampaignError, CampaignScene};
use fga_campaign::drawn::{
    DrawnContent, DrawnWriter, Origin, ROWS, SURROUNDINGS, TRACKS, write_surroundings,
};
use fga_formats::atomic::{AtomicFile, AtomicFolder};
use fga_formats::words::counted;
use fga_formats::{OutputError, atomic, daa, encounters};
use serde_json::json;

use crate::batch_input::PARTS;
use crate::campaign_source::SourceArgs;
use crate::common::{self, AnswerArgs, OutArgs, interrupted, watch_for_interrupt};
use crate::failure::Failure;

/// The list of what was drawn.
const LIST: &str = "drawn.csv";

/// The folder of the drawn recordings.
const RECORDINGS: &str = "recordings";

/// Options of `fga campaign draw`.
#[derive(Args, Debug)]
pub(crate) struct DrawArgs {
    /// The campaign file (.toml).
    file: PathBuf,
    /// Number of encounters over all cells; without it the file's number.
    #[arg(long, value_name = "N", value_parser = common::encounters)]
    encounters: Option<u64>,
    #[command(flatten)]
    sources: SourceArgs,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Writes obstacles around the line as `encounters.csv` and `encounters.parquet`, the ground and the zones around them as `surroundings/`; aircraft with tracks as
/// `recordings/` and `tracks.parquet`; and `drawn.csv` with the source and weight of each.
pub(crate) fn run(args: &DrawArgs) -> Result<ExitCode, Failure> {
    let overrides = Overrides {
        encounters: args.encounters,
        ..args.sources.overrides()
    };
    let configuration = file::read(&args.file, &overrides)?;
    common::tell_left_out(&configuration.damaged, &configuration.tally, PARTS);
    let campaign = Campaign::new(configuration, &args.file)?;
    watch_for_interrupt();
    let folder = args.out.prepare(&args.file)?;
    let whole = AtomicFolder::create(&folder)?;
    let drawn = draw(&campaign, whole.path()).map_err(|failure| match failure {
        Failure::Output(error) => Failure::Output(whole.named(error)),
        other => other,
    })?;
    // A draw that fails leaves the earlier one as it was.
    remove_earlier(&folder)?;
    whole.commit()?;
    let count = campaign.configuration.encounters;
    let shown = if drawn.recordings == 0 {
        &folder.join("encounters.csv")
    } else {
        &folder
    };
    args.answer.print(
        || {
            format!(
                "{} drawn: {}\n",
                counted(count, "encounter"),
                shown.display()
            )
        },
        &json!({
            "encounters": count,
            "file": shown.display().to_string(),
            "rows": drawn.rows,
            "recordings": drawn.recordings,
            "left_out": campaign.configuration.left_out(),
        }),
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Numbers of drawn encounters.
struct DrawnFiles {
    /// Obstacles around a line.
    rows: usize,
    /// Aircraft with tracks.
    recordings: u64,
}

/// Draws the encounters of a campaign into a folder.
fn draw(campaign: &Campaign, folder: &Path) -> Result<DrawnFiles, Failure> {
    let mut rows = Vec::new();
    let mut tracks: Option<DrawnTable> = None;
    let mut recordings = 0_u64;
    let mut list = String::from("encounter,source,source_encounter,seed,weight,file\n");
    for number in 0..campaign.configuration.encounters {
        let drawn = match campaign.draw_while(number, &|| !interrupted()) {
            Err(CampaignError::Stopped { .. }) => return Err(Failure::Interrupted),
            _ if interrupted() => return Err(Failure::Interrupted),
            drawn => drawn?,
        };
        let source = campaign
            .source_names()
            .get(drawn.source as usize)
            .map_or("", String::as_str);
        let file = match drawn.scene {
            CampaignScene::Rows(encounter) => {
                if campaign.has_surroundings() {
                    if rows.is_empty() {
                        atomic::prepare_folder(&folder.join(SURROUNDINGS))?;
                    }
                    write_surroundings(folder, number, &drawn.scenery)?;
                }
                rows.push(encounter);
                "encounters.csv".to_owned()
            }
            CampaignScene::Tracks(mut recording) => {
                if recordings == 0 {
                    atomic::prepare_folder(&folder.join(RECORDINGS))?;
                }
                recordings += 1;
                let origin = Origin {
                    number: Some(number),
                    seed: Some(drawn.seed),
                    weight: drawn.weight,
                };
                origin.mark(&mut recording);
                let table = match &mut tracks {
                    Some(table) => table,
                    None => {
                        tracks.insert(DrawnTable::create(folder, TRACKS, DrawnContent::Tracks)?)
                    }
                };
                let pushed = table.writer.push_tracks(&recording, &origin);
                pushed.map_err(|error| table.failed(error))?;
                let name = format!("{RECORDINGS}/{number:08}.daa");
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
    if !rows.is_empty() {
        encounters::write(&folder.join("encounters.csv"), &rows)?;
        let mut table = DrawnTable::create(folder, ROWS, DrawnContent::Rows)?;
        for encounter in &rows {
            let pushed = table.writer.push_rows(encounter);
            pushed.map_err(|error| table.failed(error))?;
        }
        table.commit()?;
    }
    if let Some(table) = tracks {
        table.commit()?;
    }
    atomic::write(&folder.join(LIST), list)?;
    Ok(DrawnFiles {
        rows: rows.len(),
        recordings,
    })
}

/// A Parquet file under construction.
struct DrawnTable {
    writer: DrawnWriter<AtomicFile>,
    path: PathBuf,
}

impl DrawnTable {
    fn create(folder: &Path, name: &str, content: DrawnContent) -> Result<Self, OutputError> {
        let path = folder.join(name);
        let file = AtomicFile::create(&path)?;
        match DrawnWriter::new(file, content) {
            Ok(writer) => Ok(Self { writer, path }),
            Err(error) => Err(OutputError::new(path, std::io::Error::other(error))),
        }
    }

    fn failed(&self, error: impl Into<Box<dyn core::error::Error + Send + Sync>>) -> OutputError {
        OutputError::new(&self.path, std::io::Error::other(error))
    }

    fn commit(self) -> Result<(), OutputError> {
        let path = self.path;
        match self.writer.finish() {
            Ok(file) => file.commit(),
            Err(error) => Err(OutputError::new(path, std::io::Error::other(error))),
        }
    }
}

/// Removes what an earlier draw wrote into the folder: its encounters are other ones.
fn remove_earlier(folder: &Path) -> Result<(), OutputError> {
    if !folder.join(LIST).is_file() {
        return Ok(());
    }
    let mut files: Vec<PathBuf> = [TRACKS, ROWS, "encounters.csv", LIST]
        .iter()
        .map(|name| folder.join(name))
        .filter(|path| path.is_file())
        .collect();
    for (name, ending) in [(RECORDINGS, "daa"), (SURROUNDINGS, "json")] {
        if let Ok(entries) = std::fs::read_dir(folder.join(name)) {
            let drawn = entries.filter_map(Result::ok).map(|entry| entry.path());
            files.extend(drawn.filter(|path| path.extension().is_some_and(|own| own == ending)));
        }
    }
    for path in files {
        std::fs::remove_file(&path).map_err(|error| OutputError::new(path, error))?;
    }
    // A folder that stays would stand for the next table's surroundings.
    let _ = std::fs::remove_dir(folder.join(SURROUNDINGS));
    Ok(())
}

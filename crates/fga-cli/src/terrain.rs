//! `fga terrain`: heights of the ground: what files hold, a part of them, and whether a mission clears them.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Subcommand};
use fga_formats::InputError;
use fga_formats::terrain::Area;
use fga_formats::words::counted;
use serde_json::{Value, json};

use crate::common::AnswerArgs;
use crate::failure::Failure;
use crate::terrain_check;
use crate::terrain_ground::{Facts, GroundArgs, area_json};

/// Heights of the ground.
#[derive(Args, Debug)]
pub(crate) struct TerrainArgs {
    #[command(subcommand)]
    command: TerrainCommand,
}

#[derive(Subcommand, Debug)]
enum TerrainCommand {
    /// Show what files of heights hold: area, spacing, datum, heights, holes, vertical error.
    Info(InfoArgs),
    /// Write the heights of an area as a GeoTIFF.
    Cut(CutArgs),
    /// Say whether files of heights are usable, and whether a mission clears their ground.
    Check(terrain_check::TerrainCheckArgs),
}

/// Options of `fga terrain info`.
#[derive(Args, Debug)]
struct InfoArgs {
    #[command(flatten)]
    ground: GroundArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Options of `fga terrain cut`.
#[derive(Args, Debug)]
struct CutArgs {
    #[command(flatten)]
    ground: GroundArgs,
    /// The area, degrees: south, west, north, east, as in 46.5,9.2,46.6,9.4.
    #[arg(long, value_name = "S,W,N,E", value_parser = area, allow_hyphen_values = true)]
    area: Area,
    /// GeoTIFF to write.
    #[arg(short, long, value_name = "OUT.tif")]
    out: PathBuf,
    #[command(flatten)]
    answer: AnswerArgs,
}

fn area(text: &str) -> Result<Area, String> {
    let sides: Vec<f64> = text
        .split(',')
        .map_while(|side| side.trim().parse().ok())
        .collect();
    let sides = <[f64; 4]>::try_from(sides)
        .map_err(|_| "expected four numbers: south,west,north,east".to_owned())?;
    Area::new(sides).map_err(|message| format!("has {message}"))
}

/// Runs one of the commands.
pub(crate) fn run(args: &TerrainArgs) -> Result<ExitCode, Failure> {
    match &args.command {
        TerrainCommand::Info(args) => info(args),
        TerrainCommand::Cut(args) => cut(args),
        TerrainCommand::Check(args) => terrain_check::run(args),
    }
}

fn info(args: &InfoArgs) -> Result<ExitCode, Failure> {
    let terrain = args.ground.read()?;
    let facts: Vec<Facts<'_>> = terrain.files().iter().map(Facts::new).collect();
    let values: Vec<Value> = facts.iter().map(Facts::to_json).collect();
    args.answer.print(
        || facts.iter().map(Facts::in_words).collect(),
        &json!({ "files": values }),
    )?;
    Ok(ExitCode::SUCCESS)
}

fn cut(args: &CutArgs) -> Result<ExitCode, Failure> {
    let terrain = args.ground.read()?;
    let out = args.out.display().to_string();
    let cut = terrain.cut(&args.area).map_err(|message| {
        let path: &Path = args
            .ground
            .files
            .first()
            .map_or("terrain".as_ref(), |path| path);
        InputError::in_file(path, message)
    })?;
    let grid = *cut.field.grid();
    let (range, holes) = cut.field.summary();
    cut.write(&args.out)?;
    let in_words = || {
        let resampled = if cut.is_resampled {
            ", interpolated between the posts of several grids"
        } else {
            ""
        };
        format!(
            "{out}: {} x {} heights of {}{resampled}, {}\n",
            grid.rows,
            grid.columns,
            grid.area(),
            counted(holes, "hole")
        )
    };
    let answer = json!({
        "file": out,
        "area": area_json(&grid.area()),
        "rows": grid.rows,
        "columns": grid.columns,
        "least_m": range.map(|range| range[0]),
        "largest_m": range.map(|range| range[1]),
        "holes": holes,
        "resampled": cut.is_resampled,
    });
    args.answer.print(in_words, &answer)?;
    Ok(ExitCode::SUCCESS)
}

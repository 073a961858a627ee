//! The campaign file: a grid of conditions, policies and seeds in TOML
//! (tables: [`fga_files::campaign`], with what each key means).

use std::path::{Path, PathBuf};

use fga_files::TomlText;
use fga_files::campaign::{CampaignFile, CellGrid, Model};
use fga_files::sensors::SensorSource;
use fga_formats::InputError;
use fga_formats::error::{read_text, shown};
use fga_sim::own::OwnPolicy;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::{self, VehicleModel};
use toml::Spanned;

use super::CampaignConfiguration;
use super::configuration::{
    FileSource, block_size, number_of_encounters, own_sha256, policy_called,
};
use super::sources::{self, ModelFile};
use crate::drawn;
use crate::encounters::EncounterSource;
use crate::encounters::modeled::Pairing;
use crate::encounters::parse;
use crate::recorded;

/// Families with a count, a distance and a speed.
const GRID_FAMILIES: [&str; 6] = [
    "threats",
    "from-anywhere",
    "valley",
    "ridges",
    "ground-wall",
    "corridor",
];

/// Number of encounters of a campaign that does not give one.
const ENCOUNTERS: u64 = 10_000;

/// Overrides of the file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Number of encounters.
    pub encounters: Option<u64>,
    /// Policies by their names on the command line, or of `own`.
    pub policies: Vec<String>,
    /// The policy of the intruders.
    pub intruders: Option<String>,
    /// Policies outside of this crate.
    pub own: Vec<OwnPolicy>,
    /// Text of a vehicle file.
    pub vehicle: Option<String>,
    /// Whether to ask the oracle.
    pub oracle: bool,
    /// Recordings or folders of them.
    pub recordings: Vec<PathBuf>,
    /// The file of every encounter model.
    pub model: Option<PathBuf>,
    /// Whether the file may leave its encounters to the command line.
    pub outline: bool,
}

/// Reads a campaign file.
///
/// # Errors
/// An unreadable file, a file of another kind, or an unknown name in it.
pub fn read(path: &Path, overrides: &Overrides) -> Result<CampaignConfiguration, InputError> {
    from_text(path, &read_text(path)?, overrides)
}

/// The same of a text that belongs into the file.
///
/// # Errors
/// As [`read`], but for the file itself.
pub fn from_text(
    path: &Path,
    text: &str,
    overrides: &Overrides,
) -> Result<CampaignConfiguration, InputError> {
    let text = TomlText::new(path, text);
    let file = CampaignFile::read(&text)?;
    let beside = |name: &str| path.parent().unwrap_or(Path::new("")).join(name);

    let vehicle = match (&overrides.vehicle, &file.vehicle) {
        (Some(text), _) => Some(text.clone()),
        (None, Some(name)) => Some(read_text(&beside(name.get_ref()))?),
        (None, None) => None,
    };
    let model = match &vehicle {
        None => VehicleModel::built_in()?,
        Some(vehicle) => {
            let name = file
                .vehicle
                .as_ref()
                .map_or("vehicle", |v| v.get_ref().as_str());
            VehicleModel::parse(TomlText::new(Path::new(name), vehicle))?
        }
    };
    let cells = cells(&text, &file, &model)?;
    let files = encounter_files(&file.files, &beside)?;
    let models = models(&text, &file.model, overrides, &beside)?;
    let mut folders: Vec<PathBuf> = file
        .recordings
        .iter()
        .map(|f| beside(f.get_ref()))
        .collect();
    folders.extend(overrides.recordings.iter().cloned());
    let is_empty = cells.is_empty() && files.is_empty() && folders.is_empty() && models.is_empty();
    if is_empty && !overrides.outline {
        return Err(text.error(
            "the grid is empty, expected a [[grid]], cells, files, recordings (also --recordings) or a [[model]]",
        ));
    }

    let seeds = match &file.seeds {
        None => vec![0],
        Some(seeds) if seeds.get_ref().is_empty() => {
            return Err(text.error_at(seeds, "seeds is empty, expected at least one"));
        }
        Some(seeds) => {
            let mut seen = alloc::collections::BTreeSet::new();
            if let Some(twice) = seeds.get_ref().iter().find(|seed| !seen.insert(**seed)) {
                let message = format!("seed {twice} is named twice, expected each once");
                return Err(text.error_at(seeds, message));
            }
            seeds.get_ref().clone()
        }
    };
    let policies = policies(&text, &file, overrides)?;
    let called = |name: &str| policy_called(name, &overrides.own);
    let intruders = match (&overrides.intruders, &file.intruders) {
        (Some(name), _) => Some(called(name).map_err(|message| text.error(message))?),
        (None, Some(name)) => Some(
            called(name.get_ref())
                .map_err(|message| text.error_at(name, format!("intruders: {message}")))?,
        ),
        (None, None) => None,
    };
    let horizon_s = match &file.horizon_s {
        None => 60.0,
        Some(horizon_s) => text.within("horizon_s", horizon_s, (1.0, 86_400.0))?,
    };
    let found = recorded::find(&folders, &model)?;
    let in_files = (files.iter().map(|f| f.encounters).sum::<u64>()
        + found.sources.iter().map(|f| f.encounters).sum::<u64>())
        * seeds.len() as u64;
    let encounters = match (overrides.encounters, &file.encounters) {
        (Some(number), _) => number,
        (None, Some(number)) => number_of_encounters(*number.get_ref())
            .map_err(|message| text.error_at(number, message))?,
        (None, None) if cells.is_empty() && models.is_empty() => in_files,
        (None, None) => in_files + ENCOUNTERS,
    };
    number_of_encounters(encounters).map_err(|message| text.error(message))?;
    Ok(CampaignConfiguration {
        name: file.name.unwrap_or_else(|| {
            path.file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
        }),
        version: env!("CARGO_PKG_VERSION").into(),
        encounters,
        block: block_size(encounters),
        seeds,
        own_sha256: own_sha256(&policies, intruders.as_ref()),
        intruders: intruders.as_ref().map(PolicyChoice::name),
        policies: policies.iter().map(PolicyChoice::name).collect(),
        horizon_s,
        oracle: overrides.oracle,
        cells: cells.into_iter().map(|(cell, _)| cell).collect(),
        files,
        recordings: found.sources,
        models,
        damaged: found.damaged,
        tally: found.tally,
        sensors: sensors(&text, file.sensor)?,
        plant: vehicle_file::plant(&file.plant, text)?,
        vehicle_sha256: model.sha256,
        vehicle,
        events: events(&text, &file.events, encounters)?,
    })
}

/// The cells, and the cells of the grids, each with its position in the file; encounters of each can be drawn around the aircraft.
fn cells(
    text: &TomlText<'_>,
    file: &CampaignFile,
    model: &VehicleModel,
) -> Result<Vec<(String, core::ops::Range<usize>)>, InputError> {
    let mut cells = Vec::new();
    for cell in &file.cells {
        cells.push((cell.get_ref().clone(), cell.span()));
    }
    for grid in &file.grid {
        let family = &grid.get_ref().family;
        if !GRID_FAMILIES.contains(&family.get_ref().as_str()) {
            let message = format!(
                "unknown family {}, expected {}",
                shown(family.get_ref()),
                GRID_FAMILIES.join(" or ")
            );
            return Err(text.error_at(family, message));
        }
        check_values(text, grid.get_ref())?;
        cells_of(grid.get_ref(), &mut cells, &grid.span());
    }
    for (cell, span) in &cells {
        EncounterSource::parse(cell, 0)
            .and_then(|source| {
                let drawn = source.around(model).encounter(0);
                drawn.map_err(|message| format!("{cell}: {message}"))
            })
            .map_err(|message| text.error_at(&Spanned::new(span.clone(), ()), message))?;
    }
    Ok(cells)
}

/// The files of encounters.
fn encounter_files(
    names: &[Spanned<String>],
    beside: &impl Fn(&str) -> PathBuf,
) -> Result<Vec<FileSource>, InputError> {
    let mut files = Vec::new();
    for name in names {
        let path = beside(name.get_ref());
        let rows = drawn::read_rows(&path)?;
        files.push(FileSource {
            encounters: rows.encounters.len() as u64,
            sha256: rows.sha256,
            path: std::path::absolute(&path).unwrap_or(path),
        });
    }
    Ok(files)
}

/// How the aircraft of a model meet.
fn pairing_of(model: &Model) -> Pairing {
    let usual = Pairing::default();
    Pairing {
        ownship: model.ownship.unwrap_or(usual.ownship),
        cpa_s: model.cpa_s.unwrap_or(usual.cpa_s),
        duration_s: model.duration_s.unwrap_or(usual.duration_s),
        cylinder_m: model.cylinder_m.unwrap_or(usual.cylinder_m),
        aimed_m: model.aimed_m.unwrap_or(usual.aimed_m),
        aimed_share: model.aimed_share.unwrap_or(usual.aimed_share),
        altitude_m: model.altitude_m,
        ownship_speed_mps: model.ownship_speed_mps,
        intruder_speed_mps: model.intruder_speed_mps,
    }
}

/// The encounter models, each with its file.
fn models(
    text: &TomlText<'_>,
    tables: &[Spanned<Model>],
    overrides: &Overrides,
    beside: &impl Fn(&str) -> PathBuf,
) -> Result<Vec<ModelFile>, InputError> {
    if let (Some(path), true) = (&overrides.model, tables.is_empty()) {
        return Err(InputError::in_file(
            path,
            "is a model for a campaign without a [[model]], expected a campaign with one",
        ));
    }
    tables
        .iter()
        .filter_map(|table| {
            let pairing = pairing_of(table.get_ref());
            if let Err(message) = pairing.check() {
                return Some(Err(text.error_at(table, message)));
            }
            let path = match (&overrides.model, &table.get_ref().file) {
                (Some(path), _) => path.clone(),
                (None, Some(name)) => beside(name),
                (None, None) if overrides.outline => return None,
                (None, None) => {
                    return Some(Err(text.error_at(
                        table,
                        "the model has no file, expected the key file, or --model FILE",
                    )));
                }
            };
            Some(sources::model_file(&path, pairing))
        })
        .collect()
}

/// The sources of the ownship's knowledge.
fn sensors(
    text: &TomlText<'_>,
    tables: Vec<Spanned<SensorSource>>,
) -> Result<Vec<SensorSource>, InputError> {
    tables
        .into_iter()
        .map(|table| {
            let span = table.span();
            let mut source = table.into_inner();
            match source.check() {
                Ok(()) => Ok(source),
                Err(message) => Err(text.error_at(&Spanned::new(span, ()), message)),
            }
        })
        .collect()
}

/// Encounters with logged events.
fn events(
    text: &TomlText<'_>,
    named: &[Spanned<u64>],
    encounters: u64,
) -> Result<Vec<u64>, InputError> {
    let last = encounters - 1;
    if let Some(number) = named.iter().find(|number| *number.get_ref() > last) {
        let message = format!(
            "events names encounter {}, expected 0 to {last}",
            number.get_ref()
        );
        return Err(text.error_at(number, message));
    }
    Ok(named.iter().map(|number| *number.get_ref()).collect())
}

/// The policies, each once.
fn policies(
    text: &TomlText<'_>,
    file: &CampaignFile,
    overrides: &Overrides,
) -> Result<Vec<PolicyChoice>, InputError> {
    let called = |name: &str| policy_called(name, &overrides.own);
    if !overrides.policies.is_empty() {
        let policies = overrides.policies.iter().map(|name| called(name));
        return policies
            .collect::<Result<_, _>>()
            .map_err(|message| text.error(message));
    }
    if file.policies.get_ref().is_empty() {
        return Err(text.error_at(&file.policies, "policies is empty, expected at least one"));
    }
    let mut policies: Vec<PolicyChoice> = Vec::new();
    for name in file.policies.get_ref() {
        let policy = called(name.get_ref()).map_err(|message| text.error_at(name, message))?;
        if policies.contains(&policy) {
            let message = format!(
                "policy {} is named twice, expected once",
                shown(&policy.name())
            );
            return Err(text.error_at(name, message));
        }
        policies.push(policy);
    }
    Ok(policies)
}

/// Whether each list of a grid holds values, and only usable ones.
fn check_values(text: &TomlText<'_>, grid: &CellGrid) -> Result<(), InputError> {
    check_list(text, "count", &grid.count, |value| {
        parse::count(value).map(drop)
    })?;
    let distances = [
        ("first_seen_m", &grid.first_seen_m),
        ("speed_mps", &grid.speed_mps),
    ];
    for (key, list) in distances {
        check_list(text, key, list, |value| parse::range(value).map(drop))?;
    }
    match &grid.planar {
        Some(planar) if planar.get_ref().is_empty() => {
            Err(text.error_at(planar, "planar is empty, expected at least one value"))
        }
        _ => Ok(()),
    }
}

fn check_list<T: core::fmt::Display>(
    text: &TomlText<'_>,
    key: &str,
    list: &Spanned<Vec<Spanned<T>>>,
    check: impl Fn(&str) -> Result<(), String>,
) -> Result<(), InputError> {
    if list.get_ref().is_empty() {
        let message = format!("{key} is empty, expected at least one value");
        return Err(text.error_at(list, message));
    }
    for value in list.get_ref() {
        check(&value.get_ref().to_string())
            .map_err(|message| text.error_at(value, format!("{key} {message}")))?;
    }
    Ok(())
}

/// Every combination of a grid as a cell's name.
fn cells_of(
    grid: &CellGrid,
    cells: &mut Vec<(String, core::ops::Range<usize>)>,
    span: &core::ops::Range<usize>,
) {
    let planar = grid.planar.as_ref().map_or(&[false][..], |p| p.get_ref());
    for planar in planar {
        for speed in grid.speed_mps.get_ref() {
            for seen in grid.first_seen_m.get_ref() {
                for count in grid.count.get_ref() {
                    let (count, seen, speed) = (count.get_ref(), seen.get_ref(), speed.get_ref());
                    let family = grid.family.get_ref();
                    let mut cell = format!("{family}:{count}:{seen}:{speed}");
                    if *planar {
                        cell.push_str(",planar");
                    }
                    if grid.bystanders {
                        cell.push_str(",bystanders");
                    }
                    cells.push((cell, span.clone()));
                }
            }
        }
    }
}

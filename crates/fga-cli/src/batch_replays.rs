//! `fga batch --replay N`: replay pages of the worst encounters, `replay/<encounter>.html`.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

use fga::avoider::SettingsError;
use fga_formats::OutputError;
use fga_formats::atomic;
use fga_formats::encounters::Encounter;
use fga_sim::batch::{BatchSettings, empty_world, plan, show};
use fga_sim::world::World;
use rayon::prelude::*;

use crate::failure::Failure;
use fga_results::replay_page;

/// Folder of the pages within the results.
const FOLDER: &str = "replay";

/// Flies these encounters again and writes a page for each, on the threads of the current pool.
pub(crate) fn write(
    results: &Path,
    encounters: &[&Encounter],
    settings: &BatchSettings,
) -> Result<(), Failure> {
    let Some(world) = empty_world(settings).filter(|_| !encounters.is_empty()) else {
        return Ok(());
    };
    let folder = results.join(FOLDER);
    atomic::prepare_folder(&folder)?;
    encounters.par_iter().try_for_each(|encounter| {
        let page = page(world.clone(), encounter, settings)?;
        Ok(atomic::write(&folder.join(file_of(encounter)), page)?)
    })
}

fn page(
    world: World,
    encounter: &Encounter,
    settings: &BatchSettings,
) -> Result<String, SettingsError> {
    let log = show(plan(world, encounter, &settings.model), &settings.policy)?;
    Ok(replay_page::page([&log]))
}

fn file_of(encounter: &Encounter) -> String {
    format!("{}.html", encounter.id)
}

/// Removes the pages of an earlier batch, whose results are gone.
pub(crate) fn remove_others(results: &Path, written: &[&Encounter]) -> Result<(), OutputError> {
    let Ok(entries) = fs::read_dir(results.join(FOLDER)) else {
        return Ok(());
    };
    let written: HashSet<OsString> = written.iter().map(|e| file_of(e).into()).collect();
    for entry in entries.filter_map(Result::ok) {
        let name = entry.file_name();
        let of_a_batch = name
            .to_str()
            .and_then(|name| name.strip_suffix(".html"))
            .is_some_and(|number| number.parse::<u64>().is_ok());
        if of_a_batch && !written.contains(&name) {
            let path = entry.path();
            fs::remove_file(&path).map_err(|error| OutputError::new(path, error))?;
        }
    }
    Ok(())
}

//! `fga batch --replay N`: replay pages of the worst encounters, `replay/<encounter>.html`.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

use fga_formats::OutputError;
use fga_formats::atomic;
use rayon::prelude::*;

use crate::batch_input::Input;
use crate::failure::Failure;
use fga_results::replay_page;

/// Folder of the pages within the results.
const FOLDER: &str = "replay";

/// Flies these encounters (number, place in the input) again and writes a page for each, on the threads of the
/// current pool.
pub(crate) fn write(
    results: &Path,
    encounters: &[(u64, usize)],
    input: &Input,
) -> Result<(), Failure> {
    if encounters.is_empty() {
        return Ok(());
    }
    let folder = results.join(FOLDER);
    atomic::prepare_folder(&folder)?;
    encounters.par_iter().try_for_each(|(number, place)| {
        let Some(log) = input.show(*place)? else {
            return Ok(());
        };
        Ok(atomic::write(
            &folder.join(file_of(*number)),
            replay_page::page([&log]),
        )?)
    })
}

fn file_of(number: u64) -> String {
    format!("{number}.html")
}

/// Removes the pages of an earlier batch, whose results are gone.
pub(crate) fn remove_others(results: &Path, written: &[(u64, usize)]) -> Result<(), OutputError> {
    let Ok(entries) = fs::read_dir(results.join(FOLDER)) else {
        return Ok(());
    };
    let written: HashSet<OsString> = written
        .iter()
        .map(|(number, _)| file_of(*number).into())
        .collect();
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

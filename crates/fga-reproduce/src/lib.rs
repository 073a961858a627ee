//! The paper's evaluation, flown again: its claims beside what was measured.
//!
//! | section | module |
//! |---|---|
//! | Tables 3, 4, 7 | `settings` |
//! | Figs. 12–15 | `curves` |
//! | bounds 1–3 | `bounds` |
//! | `L_1` < `L_3` | `paths` |
//! | Tables 5, 6 | `times` |
//! | "67 % shorter" | `shorter` |
//! | every method on identical encounters | `methods` |
//! | Figs. 16, 17, 25, 26 | `pictures` |
#![forbid(unsafe_code)]

extern crate alloc;

mod bounds;
mod curves;
mod flights;
mod methods;
mod paths;
mod pictures;
mod setting;
mod settings;
mod shorter;
mod times;

pub use setting::{ReproduceError, Setting};

use std::path::PathBuf;

use fga_formats::atomic;
use fga_report::report::ReportPage;
use fga_results::provenance::{Provenance, TARGET};
use fga_sim::vehicle_file::VehicleModel;
use serde_json::json;

/// Flies everything on the threads of the caller's pool and writes `report.html` and `data/`. Returns the page.
///
/// # Errors
/// A folder that cannot be written, or an interruption.
pub fn reproduce(setting: &Setting<'_>) -> Result<PathBuf, ReproduceError> {
    let provenance = Provenance::begin();
    let data = setting.data();
    atomic::prepare_folder(&data)?;
    let model = VehicleModel::built_in()?;
    let mut report = ReportPage::new("The paper's evaluation, flown again");
    report.summary = "Every section says what the paper states, what its published algorithm gives \
         in closed-loop simulation, what the turn-aware policy gives, and what an exhaustive search \
         (the oracle) allows. The figures of the paper are missing from its text; its sentences are \
         what is compared with."
        .into();
    report.facts = vec![
        ("version".into(), env!("CARGO_PKG_VERSION").into()),
        ("commit".into(), fga_formats::build::commit().into()),
        ("target".into(), TARGET.into()),
        ("seed".into(), setting.seed.to_string()),
        (
            "encounters".into(),
            format!("{} for each point", setting.encounters),
        ),
        (
            "vehicle".into(),
            "Table 4: 15 m/s, turn radius 30 m, protected radius 30 m".into(),
        ),
    ];
    let mut sections = settings::sections(&model);
    sections.extend(curves::sections(setting)?);
    sections.extend(bounds::sections(setting, &model)?);
    sections.push(paths::section(setting)?);
    sections.extend(methods::sections(setting)?);
    sections.extend(pictures::sections(setting, &model)?);
    report.sections = sections;
    let configuration = json!({
        "seed": setting.seed,
        "encounters": setting.encounters,
        "vehicle_sha256": model.sha256,
    });
    let more = json!({ "seed": setting.seed });
    let document = provenance.to_json("reproduce", &configuration, more);
    atomic::write(&data.join("run.json"), format!("{document:#}\n"))?;
    let page = setting.folder.join("report.html");
    atomic::write(&page, report.to_html())?;
    Ok(page)
}

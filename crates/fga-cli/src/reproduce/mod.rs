//! `fga reproduce`: flies the paper's evaluation again and shows its claims beside the results.
//!
//! | section | file |
//! |---|---|
//! | Tables 3, 4, 7 | [`settings`] |
//! | Figs. 12–15 | [`curves`] |
//! | bounds 1–3 | [`bounds`] |
//! | `L_1` < `L_3` | [`paths`] |
//! | Tables 5, 6 | [`times`] |
//! | "67 % shorter" | [`shorter`] |
//! | every method on identical encounters | [`methods`] |
//! | Figs. 16, 17, 25, 26 | [`pictures`] |

mod bounds;
mod curves;
mod flights;
mod methods;
mod paths;
mod pictures;
mod settings;
mod shorter;
mod times;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga_formats::atomic;
use fga_report::report::Report;
use fga_sim::vehicle_file::VehicleModel;
use serde_json::json;

use crate::common::{AnswerArgs, ThreadArgs, interrupted, watch_for_interrupt};
use crate::failure::Failure;
use crate::provenance::Provenance;

/// Options of `fga reproduce`.
#[derive(Args, Debug)]
pub(crate) struct ReproduceArgs {
    /// Number of encounters for each point of a curve.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..))]
    encounters: u64,
    /// Master seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the report and its data.
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    out: PathBuf,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// The input of the sections.
struct Setting<'a> {
    /// Number of encounters for each point.
    encounters: u64,
    /// Master seed.
    seed: u64,
    /// Folder of the data files.
    data: &'a Path,
}

/// Announces the next section on standard error; stops after Ctrl-C.
fn next(what: &str) -> Result<(), Failure> {
    if interrupted() {
        return Err(Failure::Interrupted);
    }
    eprintln!("{what}");
    Ok(())
}

/// Flies everything and writes `report.html` and `data/`.
pub(crate) fn run(args: &ReproduceArgs) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin();
    let data = args.out.join("data");
    atomic::prepare_folder(&data)?;
    watch_for_interrupt();
    let setting = Setting {
        encounters: args.encounters,
        seed: args.seed,
        data: &data,
    };
    let model = VehicleModel::built_in()?;
    let mut report = Report::new("The paper's evaluation, flown again");
    report.summary = "Every section says what the paper states, what its published algorithm gives \
         in closed-loop simulation, what the turn-aware policy gives, and what an exhaustive search \
         (the oracle) allows. The figures of the paper are missing from its text; its sentences are \
         what is compared with."
        .into();
    report.facts = vec![
        ("version".into(), env!("CARGO_PKG_VERSION").into()),
        ("target".into(), env!("FGA_TARGET").into()),
        ("seed".into(), args.seed.to_string()),
        (
            "encounters".into(),
            format!("{} for each point", args.encounters),
        ),
        (
            "vehicle".into(),
            "Table 4: 15 m/s, turn radius 30 m, protected radius 30 m".into(),
        ),
    ];
    report.sections = args.threads.install(|| {
        let mut sections = settings::sections(&model);
        sections.extend(curves::sections(&setting)?);
        sections.extend(bounds::sections(&setting, &model)?);
        sections.push(paths::section(&setting)?);
        sections.extend(methods::sections(&setting)?);
        sections.extend(pictures::sections(&setting, &model)?);
        Ok::<_, Failure>(sections)
    })??;
    let configuration = json!({
        "seed": args.seed,
        "encounters": args.encounters,
        "vehicle_sha256": model.sha256,
    });
    let document = provenance.to_json("reproduce", &configuration, json!({"seed": args.seed}));
    atomic::write(&data.join("run.json"), format!("{document:#}\n"))?;
    let page = args.out.join("report.html");
    atomic::write(&page, report.to_html())?;
    args.answer.print(
        || format!("report in {}\n", page.display()),
        &json!({ "report": page.display().to_string() }),
    )?;
    Ok(ExitCode::SUCCESS)
}

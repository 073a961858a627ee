//! `fga batch`: flies encounters from a file.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use fga_campaign::batch::{
    BatchRow, BatchSettings, MoreColumns, TIMING_COLUMNS, TRACK_COLUMNS, result_columns,
};
use fga_formats::OutputError;
use fga_formats::atomic::{self, AtomicFile};
use fga_formats::words::{counted, per_second};
use serde_json::json;

use crate::batch_args::BatchArgs;
use crate::batch_input::Input;
use crate::batch_replays;
use crate::common::{interrupted, tell_failures, watch_for_interrupt};
use crate::failure::Failure;
use fga_results::provenance::Provenance;
use fga_results::worst::Worst;

/// Files of a batch under construction.
struct BatchFiles {
    results: AtomicFile,
    timing: AtomicFile,
    tracks: Option<AtomicFile>,
    folder: PathBuf,
    line: Vec<u8>,
    more: MoreColumns,
}

impl BatchFiles {
    fn create(folder: PathBuf, tracks: bool, more: MoreColumns) -> Result<Self, OutputError> {
        let columns = result_columns(more);
        let begin = |name: &str, columns: &str| {
            let path = folder.join(name);
            let mut file = AtomicFile::create(&path)?;
            writeln!(file, "{columns}").map_err(|error| OutputError::new(path, error))?;
            Ok::<_, OutputError>(file)
        };
        Ok(Self {
            results: begin("results.csv", &columns)?,
            timing: begin("timing.csv", TIMING_COLUMNS)?,
            tracks: tracks
                .then(|| begin("tracks.csv", TRACK_COLUMNS))
                .transpose()?,
            line: Vec::new(),
            more,
            folder,
        })
    }

    fn take(&mut self, row: &BatchRow, name: Option<&str>) -> Result<(), OutputError> {
        let folder = &self.folder;
        let failed = |name: &'static str| move |error| OutputError::new(folder.join(name), error);
        self.line.clear();
        row.push_result(&mut self.line, self.more, name);
        self.results
            .write_all(&self.line)
            .map_err(failed("results.csv"))?;
        self.line.clear();
        row.push_timing(&mut self.line);
        self.timing
            .write_all(&self.line)
            .map_err(failed("timing.csv"))?;
        if let Some(tracks) = &mut self.tracks {
            tracks
                .write_all(&row.track_rows)
                .map_err(failed("tracks.csv"))?;
        }
        Ok(())
    }

    fn commit(self) -> Result<PathBuf, OutputError> {
        if let Some(tracks) = self.tracks {
            tracks.commit()?;
        }
        self.timing.commit()?;
        self.results.commit()?;
        Ok(self.folder)
    }
}

/// Figures over all encounters.
#[derive(Default)]
struct BatchTotals {
    encounters: usize,
    separated: usize,
    manoeuvred: usize,
    failed: usize,
    least_margin_m: Option<(f64, u64)>,
    cross_track_m: Vec<f64>,
    extra_path_m: Vec<f64>,
    median_ns: Vec<u64>,
    max_ns: u64,
    decisions: usize,
}

impl BatchTotals {
    fn take(&mut self, row: &BatchRow) {
        self.encounters += 1;
        self.decisions += row.decisions;
        self.separated += usize::from(row.separated());
        self.failed += usize::from(row.failure.is_some());
        let margin_m = row.outcome.min_margin_m;
        if self
            .least_margin_m
            .is_none_or(|(least, _)| margin_m < least)
        {
            self.least_margin_m = Some((margin_m, row.encounter));
        }
        if row.outcome.start_s.is_some() {
            self.manoeuvred += 1;
            self.cross_track_m.push(row.outcome.max_cross_track_m);
            self.extra_path_m.push(row.outcome.extra_path_m);
        }
        self.median_ns.push(row.decision_median_ns);
        self.max_ns = self.max_ns.max(row.decision_max_ns);
    }

    /// Decision times, microseconds: the median over encounters of the median, and the longest.
    fn decision_us(&mut self) -> (f64, f64) {
        let middle = self.median_ns.len() / 2;
        self.median_ns.sort_unstable();
        let median_ns = self.median_ns.get(middle).copied().unwrap_or_default();
        (median_ns as f64 / 1000.0, self.max_ns as f64 / 1000.0)
    }

    /// The results, a line each.
    fn in_words(&mut self, settings: &BatchSettings) -> Vec<String> {
        let (median_us, max_us) = self.decision_us();
        let mut lines = vec![
            format!(
                "{}, policy {}, vehicle {}",
                counted(self.encounters, "encounter"),
                settings.policy.name(),
                settings.model.name
            ),
            format!(
                "separated {} ({:.2} %), manoeuvred {}",
                self.separated,
                100.0 * self.separated as f64 / self.encounters as f64,
                self.manoeuvred
            ),
        ];
        if let Some((margin_m, encounter)) = self.least_margin_m {
            lines.push(format!(
                "least margin {margin_m:.2} m, in encounter {encounter}"
            ));
        }
        if let (Some(cross_m), Some(extra_m)) = (
            median(&mut self.cross_track_m),
            median(&mut self.extra_path_m),
        ) {
            lines.push(format!(
                "with a manoeuvre: median largest cross-track distance {cross_m:.1} m, median extra \
                 path {extra_m:.1} m"
            ));
        }
        lines.push(format!(
            "decision time: median over encounters of the median {median_us:.2} us, longest \
             {max_us:.1} us"
        ));
        lines
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Flies the encounters and writes `results.csv`, `timing.csv`, `run.json`, `tracks.csv`
/// and `replay/`.
pub(crate) fn run(args: &BatchArgs) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin();
    let input = Input::open(args)?;
    let settings = &input.settings;
    let folder = args.out.prepare(&args.encounters)?;
    watch_for_interrupt();
    let mut files = BatchFiles::create(folder, args.tracks, input.more_columns())?;
    let mut totals = BatchTotals::default();
    let mut worst = Worst::new(args.replay);
    let mut place = 0_usize;
    let begun = Instant::now();
    args.threads.install(|| {
        input.fly(|row| {
            if interrupted() {
                return Err(Failure::Interrupted);
            }
            totals.take(row);
            // Rows come in the order of the encounters.
            let outcome = &row.outcome;
            worst.take(
                [outcome.min_margin_m, outcome.min_separation_m],
                (row.encounter, place),
            );
            let name = input.names().and_then(|names| names.get(place));
            place += 1;
            Ok(files.take(row, name.map(String::as_str))?)
        })
    })??;
    let flown_s = begun.elapsed().as_secs_f64();
    tell_failures([&settings.policy]);
    let shown: Vec<(u64, usize)> = worst.into_items().collect();
    args.threads
        .install(|| batch_replays::write(&files.folder, &shown, &input))??;
    let folder = files.commit()?;
    batch_replays::remove_others(&folder, &shown)?;
    let configuration = json!({
        "policy": settings.policy.name(),
        "vehicle_sha256": settings.model.sha256,
        "horizon_s": settings.horizon_s.is_finite().then_some(settings.horizon_s),
        "seed": args.seed,
        "input_sha256": input.sha256,
    });
    let (median_us, max_us) = totals.decision_us();
    let mut summary = json!({
            "input": args.encounters.display().to_string(),
            "policy": settings.policy.name(),
            "vehicle": settings.model.name,
            "seed": args.seed,
            "encounters": totals.encounters,
            "left_out": input.left_out(),
            "separated": totals.separated,
            "manoeuvred": totals.manoeuvred,
            "policy_failures": totals.failed,
            "decisions": totals.decisions,
            "decision_median_us": median_us,
            "decision_max_us": max_us,
            "encounters_per_s": totals.encounters as f64 / flown_s,
    });
    let document = provenance.to_json("batch", &configuration, summary.clone());
    atomic::write(&folder.join("run.json"), format!("{document:#}\n"))?;
    summary["results"] = folder.display().to_string().into();
    args.answer.print(
        || {
            let mut lines = totals.in_words(settings);
            if !shown.is_empty() {
                lines.push(format!(
                    "replay pages of the {} worst encounters; fga view {} lists them",
                    shown.len(),
                    folder.display()
                ));
            }
            lines.push(format!(
                "{} encounters a second; results in {}\n",
                per_second(totals.encounters as f64 / flown_s),
                folder.display()
            ));
            lines.join("\n")
        },
        &summary,
    )?;
    input.verdict(args.skip_damaged)
}

//! Drawn encounters by the million: `fga campaign`, whole or block by block.

use core::sync::atomic::Ordering;
use std::path::{Path, PathBuf};

use fga_campaign::campaign::file::{self, Overrides};
use fga_campaign::campaign::folder::{encode_block, number_of};
use fga_campaign::campaign::metrics::Access;
use fga_campaign::campaign::{
    Campaign, CampaignConfiguration, CampaignError, CampaignFlyer, CampaignStamp, CampaignTask,
    Folder, Manifest, RESULTS, Row, Shard, assemble, reading, run as fly,
};
use fga_formats::error::read_text;
use fga_results::campaign::finish;
use fga_results::provenance::{Provenance, TARGET};
use fga_sim::own::OwnPolicy;
use fga_sim::run::RunLog;
use parquet::errors::ParquetError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};
use rayon::prelude::*;

use crate::failure::{campaign as failed, input, output};
use crate::own::{LIMIT_S, Owns, Pickled, choice, cloned, own, warn_of_failures};
use crate::table::{ArrayColumn, PyTable};
use crate::value::properties;
use crate::work::interruptible;

/// A campaign from its file: encounters drawn by number, flown under every policy, in blocks.
///
/// `Campaign(file)` reads a campaign file as the program does. It pickles as its configuration, so workers
/// need neither the file nor its folder; files of encounters in it must keep their paths.
#[pyclass(name = "Campaign", frozen, module = "fga")]
pub(crate) struct PyCampaign {
    core: Campaign,
    /// The policies of one's own.
    own: Vec<Pickled>,
    limit_s: f64,
}

/// A pickled campaign: what makes it again, of what.
type Remade<'py> = (Bound<'py, PyAny>, (String, Vec<Pickled>, f64));

impl PyCampaign {
    /// A campaign with the policies of one's own that it may name.
    pub(crate) const fn of(core: Campaign, own: Vec<Pickled>, limit_s: f64) -> Self {
        Self { core, own, limit_s }
    }

    fn stamp() -> CampaignStamp {
        CampaignStamp::of_this_build(TARGET)
    }

    fn manifest(&self) -> Manifest {
        Manifest {
            configuration_hash: self.core.hash.clone(),
            stamp: Self::stamp(),
            shard: Shard::WHOLE,
            configuration: self.core.configuration.clone(),
        }
    }

    /// Merges the blocks of a folder.
    fn finish(&self, folder: &Folder, csv: bool) -> Result<String, CampaignError> {
        let blocks = folder.blocks()?;
        let assembled = assemble(&blocks, &self.core, &Self::stamp(), folder, csv)?;
        let sha256 = assembled.sha256.clone();
        let provenance = Provenance::begin();
        finish(
            folder,
            &self.core,
            &self.manifest(),
            assembled,
            &provenance,
            serde_json::json!({}),
        )?;
        Ok(sha256)
    }
}

#[pymethods]
impl PyCampaign {
    #[new]
    #[pyo3(signature = (
        file, encounters = None, policies = Vec::new(), vehicle = None, oracle = false, recordings = Vec::new(),
        model = None, time_limit_s = LIMIT_S,
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "the options of the program, by name in Python"
    )]
    fn new(
        py: Python<'_>,
        file: PathBuf,
        encounters: Option<u64>,
        policies: Vec<Bound<'_, PyAny>>,
        vehicle: Option<PathBuf>,
        oracle: bool,
        recordings: Vec<PathBuf>,
        model: Option<PathBuf>,
        time_limit_s: f64,
    ) -> PyResult<Self> {
        if encounters == Some(0) {
            return Err(PyValueError::new_err(
                "encounters is 0, expected at least 1",
            ));
        }
        let mut owns = Owns::default();
        let names = policies.iter();
        let names = names.map(|policy| owns.named(policy, time_limit_s));
        let names = names.collect::<PyResult<_>>()?;
        let Owns { policies, pickled } = owns;
        let overrides = Overrides {
            encounters,
            policies: names,
            own: policies.clone(),
            recordings,
            model,
            vehicle: vehicle
                .as_deref()
                .map(read_text)
                .transpose()
                .map_err(input)?,
            oracle,
            ..Overrides::default()
        };
        py.detach(|| {
            let configuration = file::read(&file, &overrides)?;
            Campaign::with_own(configuration, &file, &policies)
        })
        .map(|core| Self::of(core, pickled, time_limit_s))
        .map_err(failed)
    }

    /// The campaign of a configuration from `to_json`; `own` are its policies that are no names, each with its fingerprint.
    #[staticmethod]
    #[pyo3(signature = (text, own = Vec::new(), time_limit_s = LIMIT_S))]
    fn from_json(
        py: Python<'_>,
        text: &str,
        own: Vec<Pickled>,
        time_limit_s: f64,
    ) -> PyResult<Self> {
        let wrong =
            |error| PyValueError::new_err(format!("is no configuration of a campaign: {error}"));
        let configuration: CampaignConfiguration = serde_json::from_str(text).map_err(wrong)?;
        let each = own.iter();
        let each =
            each.map(|(policy, sha256)| self::own(policy.bind(py), time_limit_s, Some(sha256)));
        let owns: Vec<OwnPolicy> = each.collect::<PyResult<_>>()?;
        Campaign::with_own(configuration, Path::new("the configuration"), &owns)
            .map(|core| Self::of(core, own, time_limit_s))
            .map_err(failed)
    }

    /// The configuration with all defaults written out, as one line of JSON.
    fn to_json(&self) -> String {
        self.core.configuration.to_json()
    }

    /// The text of campaign.json for a folder of this campaign.
    fn manifest_json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.manifest())
            .map(|text| text + "\n")
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Encounters of a block: its first number and the one after its last.
    fn range_of(&self, block: u64) -> PyResult<(u64, u64)> {
        self.check_block(block)?;
        let range = self.core.configuration.range_of(block);
        Ok((range.start, range.end))
    }

    /// Flies one block: the name of its file, which holds its checksum, the number of its rows, and its
    /// bytes. The same on every machine of one kind, on any number of threads.
    #[pyo3(signature = (block, threads = None, progress = None))]
    fn fly_block<'py>(
        &self,
        py: Python<'py>,
        block: u64,
        threads: Option<usize>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(String, usize, Bound<'py, PyBytes>)> {
        self.check_block(block)?;
        let range = self.core.configuration.range_of(block);
        let (name, rows, bytes) = interruptible(py, threads, progress, |shared| {
            shared
                .total
                .store(range.end - range.start, Ordering::Relaxed);
            let flown: Result<Vec<Vec<Row>>, CampaignError> = range
                .into_par_iter()
                .map_init(
                    || CampaignFlyer::new(&self.core),
                    |flyer, number| {
                        let Ok(flyer) = flyer else {
                            return Err(CampaignError::Other(
                                "the campaign cannot be flown".into(),
                            ));
                        };
                        let mut flown = Vec::new();
                        if shared.goes_on() {
                            flyer.fly(number, &mut flown)?;
                        }
                        shared.done.fetch_add(1, Ordering::Relaxed);
                        Ok(flown.into_iter().map(|flown| flown.row).collect())
                    },
                )
                .collect();
            let rows: Vec<Row> = flown?.into_iter().flatten().collect();
            let (name, bytes) = encode_block(block, &rows, &self.core, &Self::stamp())?;
            Ok::<_, CampaignError>((name, rows.len(), bytes))
        })?
        .map_err(failed)?;
        Ok((name, rows, PyBytes::new(py, &bytes)))
    }

    /// The number of a block by the name of its file; None for a file of another name.
    #[staticmethod]
    fn block_of(name: &str) -> Option<u64> {
        number_of(name)
    }

    /// Prepares a folder for blocks: writes campaign.json, or checks that the existing one belongs to this
    /// campaign.
    fn open(&self, folder: PathBuf) -> PyResult<()> {
        Folder::at(&folder)
            .open(&self.manifest(), true)
            .map_err(failed)
    }

    /// Merges the blocks of a folder: results.parquet, the summary and run.json, as from the program.
    /// Returns the SHA-256 of results.parquet.
    #[pyo3(signature = (folder, csv = false))]
    fn merge(&self, py: Python<'_>, folder: PathBuf, csv: bool) -> PyResult<String> {
        py.detach(|| self.finish(&Folder::at(&folder), csv))
            .map_err(failed)
    }

    /// Flies the missing blocks of a folder and merges them: `fga campaign run`. Returns the SHA-256 of
    /// results.parquet. Ctrl-C keeps the finished blocks, and the next call continues with them.
    #[pyo3(signature = (out, threads = None, resume = true, csv = false, progress = None))]
    fn run(
        &self,
        py: Python<'_>,
        out: PathBuf,
        threads: Option<usize>,
        resume: bool,
        csv: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let folder = Folder::at(&out);
        fga_formats::atomic::prepare_folder(&out).map_err(output)?;
        if resume && folder.file(RESULTS).exists() {
            folder.open(&self.manifest(), true).map_err(failed)?;
            let told = fga_campaign::campaign::reread(&folder, &self.core, None).map_err(failed)?;
            return Ok(told.sha256);
        }
        let task = CampaignTask {
            campaign: &self.core,
            shard: Shard::WHOLE,
            stamp: Self::stamp(),
            folder,
            resume,
            is_expected: false,
            ends_begun: false,
        };
        interruptible(py, threads, progress, |shared| {
            shared
                .total
                .store(self.core.configuration.encounters, Ordering::Relaxed);
            fly(&task, &|| shared.goes_on(), &mut |progress| {
                shared.done.store(progress.done, Ordering::Relaxed);
            })?;
            self.finish(&task.folder, csv)
        })?
        .map_err(failed)
        .and_then(|sha256| warn_of_failures(py, &self.core.policies).map(|()| sha256))
    }

    /// Flies one encounter again with everything logged, under the named policy or the first one.
    #[pyo3(signature = (encounter, policy = None))]
    fn decisions(
        &self,
        py: Python<'_>,
        encounter: u64,
        policy: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<crate::decision::PyDecision>> {
        let choice = match (policy, self.core.policies.first()) {
            (Some(policy), _) => choice(policy, self.limit_s)?,
            (None, Some(first)) => first.clone(),
            (None, None) => fga_sim::policy::PolicyChoice::default(),
        };
        let log: RunLog = py
            .detach(|| self.core.show(encounter, &choice))
            .map_err(failed)?;
        let decisions = log.decisions.iter();
        Ok(decisions
            .map(|log| crate::decision::PyDecision::of(&log.decision, log.ownship))
            .collect())
    }

    /// The rows of a results.parquet of this campaign.
    fn read(&self, py: Python<'_>, path: PathBuf) -> PyResult<PyTable> {
        let rows = py
            .detach(|| {
                let unreadable = |error| fga_formats::InputError::unreadable(&path, &error);
                let file = std::fs::File::open(&path).map_err(unreadable)?;
                let mut rows = Vec::new();
                reading::read(file, &self.core, |mut group| {
                    rows.append(&mut group);
                    Ok::<_, ParquetError>(())
                })
                .map_err(|error| {
                    fga_formats::InputError::in_file(&path, format!("cannot be used: {error}"))
                })?;
                Ok(rows)
            })
            .map_err(input)?;
        self.table_of(&rows)
    }

    fn __repr__(&self) -> String {
        let configuration = &self.core.configuration;
        format!(
            "Campaign({:?}, {} encounters in {} blocks, policies {})",
            configuration.name,
            configuration.encounters,
            configuration.blocks(),
            configuration.policies.join(", ")
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remade<'py>> {
        let class: Bound<'py, PyType> = slf.get_type();
        let this = slf.get();
        let own = cloned(slf.py(), &this.own);
        Ok((
            class.getattr("from_json")?,
            (this.to_json(), own, this.limit_s),
        ))
    }
}

properties! { PyCampaign, this,
    /// Its name.
    name: &str = &this.core.configuration.name;
    /// Fingerprint of everything that determines the results.
    hash: &str = &this.core.hash;
    /// Number of encounters.
    encounters: u64 = this.core.configuration.encounters;
    /// Number of blocks.
    blocks: u64 = this.core.configuration.blocks();
    /// The policies.
    policies: Vec<String> = this.core.configuration.policies.clone();
}

impl PyCampaign {
    fn check_block(&self, block: u64) -> PyResult<()> {
        let blocks = self.core.configuration.blocks();
        if block < blocks {
            return Ok(());
        }
        Err(PyValueError::new_err(format!(
            "there is no block {block}, expected 0 to {}",
            blocks.saturating_sub(1)
        )))
    }

    /// Rows with the columns of results.parquet.
    fn table_of(&self, rows: &[Row]) -> PyResult<PyTable> {
        let whole =
            |name, get: fn(&Row) -> u64| (name, ArrayColumn::Whole(rows.iter().map(get).collect()));
        let flag =
            |name, get: fn(&Row) -> bool| (name, ArrayColumn::Flag(rows.iter().map(get).collect()));
        let real =
            |name, get: fn(&Row) -> f64| (name, ArrayColumn::Real(rows.iter().map(get).collect()));
        let maybe = |name, get: fn(&Row) -> Option<f64>| {
            (name, ArrayColumn::MaybeReal(rows.iter().map(get).collect()))
        };
        let text = |name, names: &[String], get: fn(&Row) -> u32| {
            let named = |row| names.get(get(row) as usize).cloned().unwrap_or_default();
            (name, ArrayColumn::Text(rows.iter().map(named).collect()))
        };
        let names = self.core.encounter_names();
        let name_of = |row: &Row| names.get(row.name? as usize).cloned();
        let mut columns = vec![
            whole("encounter", |row| row.encounter),
            whole("source_encounter", |row| row.source_encounter),
            whole("seed", |row| row.seed),
            text("source", self.core.source_names(), |row| row.source),
            text("policy", &self.core.configuration.policies, |row| {
                row.policy
            }),
            whole("obstacles", |row| row.obstacles.into()),
            flag("threatened", Row::threatened),
            real("held_margin_m", |row| row.held_margin_m),
            flag("separated", |row| row.separated),
            flag("caused", |row| row.caused),
            flag("needless", Row::needless),
            real("min_separation_m", |row| row.min_separation_m),
            real("min_margin_m", |row| row.min_margin_m),
            maybe("start_s", |row| row.start_s),
            maybe("clear_s", |row| row.clear_s),
            maybe("rejoined_s", |row| row.rejoined_s),
            real("end_s", |row| row.end_s),
            maybe("time_away_s", Row::time_away_s),
            real("max_cross_track_m", |row| row.max_cross_track_m),
            real("extra_path_m", |row| row.extra_path_m),
            (
                "avoidable",
                ArrayColumn::MaybeFlag(rows.iter().map(Row::avoidable).collect()),
            ),
            maybe("oracle_margin_m", |row| row.oracle_margin_m),
            (
                "name",
                ArrayColumn::MaybeText(rows.iter().map(name_of).collect()),
            ),
            real("weight", |row| row.weight),
        ];
        columns.extend(self.core.metric_fields().iter().map(|field| {
            let values = rows.iter().map(|row| &row.metrics);
            let column = match field.access {
                Access::Real(get, _) => ArrayColumn::MaybeReal(values.map(get).collect()),
                Access::Flag(get, _) => ArrayColumn::MaybeFlag(values.map(get).collect()),
                Access::Failure(get, _) => {
                    let word = |metrics| Some(get(metrics)?.name().to_owned());
                    ArrayColumn::MaybeText(values.map(word).collect())
                }
            };
            (field.name, column)
        }));
        PyTable::of(columns)
    }
}

/// Versions: of the package, of its sources and of the build's target.
pub(crate) fn versions(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("version", env!("CARGO_PKG_VERSION"))?;
    dict.set_item("commit", fga_build::COMMIT)?;
    dict.set_item("target", TARGET)?;
    Ok(dict)
}

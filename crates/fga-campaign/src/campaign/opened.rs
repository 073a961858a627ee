//! A campaign ready to fly: its sources, and the encounter with a number.

use std::path::Path;

use fga::Vec3;
use fga::angle::direction;
use fga_files::TomlText;
use fga_formats::InputError;
use fga_formats::daa::Recording;
use fga_formats::encounters::Encounter;
use fga_formats::error::shown;
use fga_sim::own::OwnPolicy;
use fga_sim::policy::PolicyChoice;
use fga_sim::sensor::SensorSettings;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;

use super::CampaignError;
use super::configuration::{
    CampaignConfiguration, number_of_encounters, own_sha256, policy_called,
};
use super::metrics::{ALL_FIELDS, FIELDS, Field};
use super::sources;
use crate::batch::{self, BatchSettings};
use crate::drawn::{self, Origin, RowTable};
use crate::encounters::modeled::ModelSource;
use crate::encounters::{EncounterSource, Scenery};
use crate::oracle::{OracleSettings, OracleStart, OracleVehicle};
use crate::recorded::Recordings;
use crate::unchanged::changed;

/// A margin that is enough for the oracle, metres: well above the limit from which an encounter counts
/// as avoidable.
const ENOUGH_M: f64 = 0.5;

/// A campaign ready to fly.
#[derive(Debug)]
pub struct Campaign {
    /// Its configuration.
    pub configuration: CampaignConfiguration,
    /// Its fingerprint.
    pub hash: String,
    /// The aircraft.
    pub model: VehicleModel,
    /// The policies in their order.
    pub policies: Vec<PolicyChoice>,
    /// The policy by which intruders react.
    pub intruders: Option<PolicyChoice>,
    cells: Vec<EncounterSource>,
    models: Vec<ModelSource>,
    files: Vec<RowTable>,
    recordings: Recordings,
    /// Names of the sources: those of files, then the cells, folders of recordings, models.
    names: Vec<String>,
}

/// The content of an encounter.
#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "one scene at a time, and its tracks are far larger"
)]
pub enum CampaignScene {
    /// Obstacles around a straight line; the identifier is the number in the campaign.
    Rows(Encounter),
    /// Aircraft with tracks, the first one the ownship.
    Tracks(Recording),
}

/// An encounter of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Its content.
    pub scene: CampaignScene,
    /// The ground and the zones around it.
    pub scenery: Scenery,
    /// Its number in its file or folder, else its number in the campaign.
    pub source_encounter: u64,
    /// Its master seed.
    pub seed: u64,
    /// The stream of its sensor noise.
    pub stream: u64,
    /// Its source, an index into [`Campaign::source_names`].
    pub source: u32,
    /// Its name, an index into [`Campaign::encounter_names`], if it has one.
    pub name: Option<u32>,
    /// Number of encounters of its source that it represents.
    pub weight: f64,
}

impl Campaign {
    /// Opens a configuration: reads its files and checks everything.
    ///
    /// # Errors
    /// An unusable policy, cell, vehicle or file, or an empty campaign.
    pub fn new(
        configuration: CampaignConfiguration,
        campaign_file: &Path,
    ) -> Result<Self, CampaignError> {
        Self::with_own(configuration, campaign_file, &[])
    }

    /// The same, with policies outside of this crate by their names in the configuration.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_own(
        configuration: CampaignConfiguration,
        campaign_file: &Path,
        own: &[OwnPolicy],
    ) -> Result<Self, CampaignError> {
        let wrong = |message: String| InputError::in_file(campaign_file, message);
        let mut model = match &configuration.vehicle {
            None => VehicleModel::built_in()?,
            Some(text) => VehicleModel::parse(TomlText::new(campaign_file, text))?,
        };
        if let [first, more @ ..] = configuration.sensors.as_slice() {
            model.sensor = first.into();
            model.more_sensors = more.iter().map(SensorSettings::from).collect();
        }
        model.plant = configuration.plant.or(&model.plant);
        let policies = configuration
            .policies
            .iter()
            .map(|name| policy_called(name, own).map_err(wrong))
            .collect::<Result<Vec<_>, _>>()?;
        let intruders = configuration
            .intruders
            .as_ref()
            .map(|name| policy_called(name, own).map_err(wrong))
            .transpose()?;
        if own_sha256(&policies, intruders.as_ref()) != configuration.own_sha256 {
            let names: Vec<&str> = policies
                .iter()
                .chain(&intruders)
                .filter_map(|p| Some(p.own()?.name()))
                .collect();
            return Err(wrong(format!(
                "was begun with another program for {}, expected the same one; another folder begins again",
                names.join(", ")
            ))
            .into());
        }
        let mut cells = Vec::new();
        for &seed in &configuration.seeds {
            for cell in &configuration.cells {
                let source = EncounterSource::parse(cell, seed).map_err(wrong)?;
                cells.push(source.around(&model));
            }
        }
        let mut models = Vec::new();
        for &seed in &configuration.seeds {
            for file in &configuration.models {
                let airspeed_mps = model.vehicle.airspeed_mps;
                models.push(sources::open_model(file, airspeed_mps, seed)?);
            }
        }
        let recordings = Recordings::open(&configuration.recordings)?;
        let mut files = Vec::new();
        for source in &configuration.files {
            let rows = drawn::read_rows(&source.path)?;
            if rows.sha256 != source.sha256 {
                return Err(changed(&source.path).into());
            }
            files.push(rows);
        }
        let name_of = |path: &Path| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        let file_names = configuration.files.iter().map(|file| name_of(&file.path));
        let model_names = configuration.models.iter().map(|file| name_of(&file.path));
        let names = file_names
            .chain(configuration.cells.iter().cloned())
            .chain(recordings.folders())
            .chain(model_names)
            .collect();
        let campaign = Self {
            hash: configuration.hash(),
            configuration,
            model,
            policies,
            intruders,
            cells,
            models,
            files,
            recordings,
            names,
        };
        campaign.check().map_err(|error| match error {
            CampaignError::Other(message) => wrong(message).into(),
            other => other,
        })?;
        Ok(campaign)
    }

    fn check(&self) -> Result<(), CampaignError> {
        let configuration = &self.configuration;
        number_of_encounters(configuration.encounters).map_err(CampaignError::Other)?;
        if configuration.block == 0 {
            return Err(CampaignError::Other(
                "block is 0, expected at least 1".into(),
            ));
        }
        if configuration.seeds.is_empty() {
            return Err(CampaignError::Other(
                "seeds is empty, expected at least one".into(),
            ));
        }
        if configuration.policies.is_empty() {
            return Err(CampaignError::Other(
                "policies is empty, expected at least one".into(),
            ));
        }
        let drawn = configuration.cells.len() + configuration.models.len();
        if drawn + configuration.files.len() + configuration.recordings.len() == 0 {
            return Err(CampaignError::Other("the grid is empty, expected at least one cell, model, recording or file of encounters".into()));
        }
        let last = configuration.encounters - 1;
        if let Some(number) = configuration.events.iter().find(|number| **number > last) {
            return Err(CampaignError::Other(format!(
                "events names encounter {number}, expected 0 to {last}"
            )));
        }
        let in_files = self.encounters_of_files();
        if drawn == 0 && configuration.encounters > in_files {
            return Err(CampaignError::Other(format!(
                "encounters is {}, expected at most {in_files}, as many as its files and recordings hold",
                configuration.encounters
            )));
        }
        for (index, name) in configuration.policies.iter().enumerate() {
            if configuration.policies[..index].contains(name) {
                return Err(CampaignError::Other(format!(
                    "policy {} is named twice, expected once",
                    shown(name)
                )));
            }
        }
        if self.intruders.is_some() {
            if configuration.cells.len() + configuration.files.len() > 0 {
                return Err(CampaignError::Other("intruders is set for obstacles that fly straight (cells, grid or files), expected recordings or a model alone: aircraft with tracks".into()));
            }
            if configuration.oracle {
                return Err(CampaignError::Other("intruders is set and the oracle is asked, expected one of them: the oracle knows no reactions".into()));
            }
        }
        let world = self.world()?;
        for policy in self.policies.iter().chain(&self.intruders) {
            policy.pilot(&world.settings, &world.vehicle)?;
        }
        Ok(())
    }

    fn encounters_of_files(&self) -> u64 {
        let once = (self.files.iter().map(|rows| rows.encounters.len())).sum::<usize>()
            + self.recordings.len();
        once as u64 * self.configuration.seeds.len() as u64
    }

    /// The settings for the flights of a policy.
    pub fn settings(&self, policy: PolicyChoice) -> BatchSettings {
        BatchSettings {
            horizon_s: self.configuration.horizon_s,
            ..BatchSettings::of(self.model.clone(), policy)
        }
    }

    /// The world without obstacles.
    ///
    /// # Errors
    /// A wind that is too strong for the line.
    pub fn world(&self) -> Result<World, CampaignError> {
        let world = batch::empty_world(&self.settings(PolicyChoice::default()));
        let mut world = world.ok_or_else(|| {
            CampaignError::Other(format!(
                "wind of {} m/s at an airspeed of {} m/s, expected less: the line cannot be flown",
                self.model.wind_mps.length(),
                self.model.vehicle.airspeed_mps
            ))
        })?;
        if !self.configuration.sensors.is_empty() {
            // Around a line obstacles are known from the start, except where sources say otherwise.
            world.sensor = self.model.sensor;
            world.more_sensors.clone_from(&self.model.more_sensors);
        }
        Ok(world)
    }

    /// Velocity over the ground on the line, metres per second.
    pub(super) fn line_velocity_mps(&self, world: &World) -> Vec3 {
        direction(world.start.course_rad, world.start.climb_rad) * self.model.vehicle.airspeed_mps
            + self.model.wind_mps
    }

    /// Radius and half height of the cylinder around the ownship for which the encounters stand, metres, if all of them come from uncorrelated
    /// models with the same cylinder.
    pub fn cylinder_m(&self) -> Option<[f64; 2]> {
        let configuration = &self.configuration;
        let others =
            configuration.cells.len() + configuration.files.len() + configuration.recordings.len();
        let mut cylinders = self.models.iter().map(ModelSource::cylinder_m);
        let first = cylinders.next()??;
        let is_one = others == 0 && cylinders.all(|other| other == Some(first));
        is_one.then_some(first)
    }

    /// Names of the sources: files, cells, folders of recordings, models.
    pub fn source_names(&self) -> &[String] {
        &self.names
    }

    /// Whether ground or zones surround some of its encounters.
    pub fn has_surroundings(&self) -> bool {
        self.cells.iter().any(EncounterSource::has_surroundings)
            || self.files.iter().any(|rows| rows.surroundings.exist())
    }

    /// The metrics in its rows.
    pub fn metric_fields(&self) -> &'static [Field] {
        if self.has_surroundings() {
            ALL_FIELDS
        } else {
            FIELDS
        }
    }

    /// Names of the named encounters.
    pub fn encounter_names(&self) -> &[String] {
        self.recordings.names()
    }

    /// The encounter with this number.
    ///
    /// # Errors
    /// A number past the last.
    pub fn draw(&self, number: u64) -> Result<Drawn, CampaignError> {
        self.draw_while(number, &|| true)
    }

    /// The same; `go_on` ends a draw that takes long.
    ///
    /// # Errors
    /// A number past the last, or [`CampaignError::Stopped`].
    pub fn draw_while(
        &self,
        number: u64,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Drawn, CampaignError> {
        let configuration = &self.configuration;
        let not_drawn = |message: String| {
            if go_on() {
                return CampaignError::Other(message);
            }
            CampaignError::Stopped {
                done: number,
                total: configuration.encounters,
            }
        };
        let past = || {
            CampaignError::Other(format!(
                "there is no encounter {number}, expected 0 to {}",
                configuration.encounters.saturating_sub(1)
            ))
        };
        if number >= configuration.encounters {
            return Err(past());
        }
        let drawn = |source: usize, seed: u64, scene: CampaignScene| Drawn {
            scene,
            scenery: Scenery::default(),
            source_encounter: number,
            seed,
            stream: number,
            source: u32::try_from(source).unwrap_or(u32::MAX),
            name: None,
            weight: 1.0,
        };
        let in_files = self.encounters_of_files();
        if number < in_files {
            let once = in_files / configuration.seeds.len().max(1) as u64;
            let (turn, mut rest) = (index(number / once), index(number % once));
            let seed = *configuration.seeds.get(turn).ok_or_else(past)?;
            for (source, file) in self.files.iter().enumerate() {
                if let Some(encounter) = file.encounters.get(rest) {
                    let scene = CampaignScene::Rows(Encounter {
                        id: number,
                        obstacles: encounter.obstacles.clone(),
                    });
                    return Ok(Drawn {
                        source_encounter: encounter.id,
                        scenery: file.surroundings.scenery(encounter.id)?,
                        ..drawn(source, seed, scene)
                    });
                }
                rest -= file.encounters.len();
            }
            let (recording, folder) = self.recordings.get(rest)?.ok_or_else(past)?;
            let origin = Origin::of(&recording).map_err(CampaignError::Other)?;
            let source = self.source_called(folder);
            let seed = origin.seed.unwrap_or(seed);
            return Ok(Drawn {
                source_encounter: rest as u64,
                stream: origin.number.unwrap_or(number),
                name: u32::try_from(rest).ok(),
                weight: origin.weight,
                ..drawn(source, seed, CampaignScene::Tracks(recording))
            });
        }
        let each = configuration.cells.len() + configuration.models.len();
        let place =
            index((number - in_files) % ((self.cells.len() + self.models.len()).max(1) as u64));
        // All cells and models of the first seed, then the same of the next one.
        let (turn, kind) = (place / each.max(1), place % each.max(1));
        if let Some(model) = kind.checked_sub(configuration.cells.len()) {
            let source = self
                .models
                .get(turn * configuration.models.len() + model)
                .ok_or_else(past)?;
            let modeled = source.encounter_while(number, go_on).map_err(not_drawn)?;
            let first = self.names.len() - configuration.models.len();
            let scene = CampaignScene::Tracks(modeled.recording);
            return Ok(Drawn {
                weight: modeled.weight,
                ..drawn(first + model, source.seed(), scene)
            });
        }
        let source = self
            .cells
            .get(turn * configuration.cells.len() + kind)
            .ok_or_else(past)?;
        let encounter = source.encounter_while(number, go_on).map_err(|message| {
            let cell = &configuration.cells[kind];
            not_drawn(format!("{cell}: {message}"))
        });
        let scene = CampaignScene::Rows(encounter?);
        Ok(Drawn {
            scenery: source.scenery(number),
            ..drawn(self.files.len() + kind, source.seed, scene)
        })
    }

    /// The index of a source.
    fn source_called(&self, name: &str) -> usize {
        let folders = self.files.len() + self.configuration.cells.len();
        let mut names = self.names.iter().enumerate().skip(folders);
        names
            .find(|(_, known)| *known == name)
            .map_or(usize::MAX, |(index, _)| index)
    }

    /// The oracle's search: vehicle, start, settings.
    pub(super) fn oracle(&self, world: &World) -> (OracleVehicle, OracleStart, OracleSettings) {
        (
            OracleVehicle::from(&self.model.flies()),
            OracleStart {
                course_rad: world.start.course_rad,
                climb_rad: world.start.climb_rad,
                ..OracleStart::ORIGIN
            },
            OracleSettings {
                horizon_s: self.configuration.horizon_s,
                enough_m: Some(ENOUGH_M),
                ..OracleSettings::default()
            },
        )
    }
}

/// A number that indexes something in memory.
fn index(number: u64) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

//! The sets of a league: shipped ones and campaign files, each with the reactions of its intruders.

use std::path::{Path, PathBuf};

use fga_campaign::campaign::file::{self, Overrides};
use fga_campaign::campaign::{Campaign, CampaignError, policy_called};
use fga_campaign::drawn::{DrawnContent, DrawnWriter, Origin, TRACKS};
use fga_campaign::encounters::fleet::fleet;
use fga_formats::OutputError;
use fga_formats::atomic::{self, AtomicFile};
use fga_sim::policy::PolicyChoice;

use super::terms::Terms;
use crate::campaign::safety::file_name;

/// Data of a set.
enum Needs {
    /// None: the encounters are drawn from families.
    Nothing,
    /// None: fleets are drawn, whose aircraft all fly the policy.
    Fleets,
    /// A folder of recordings, below the folder of data.
    Recordings(&'static str),
    /// The file of an encounter model, below the folder of data.
    Model(&'static str),
}

/// A shipped set.
struct Shipped {
    name: &'static str,
    campaign: &'static str,
    vehicle: &'static str,
    needs: Needs,
}

const WELL_CLEAR: &str = include_str!("../../../../vehicles/general-aviation-well-clear.toml");

const SHIPPED: [Shipped; 6] = [
    Shipped {
        name: "flown",
        campaign: include_str!("../../../../campaigns/league/flown.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Recordings("flown"),
    },
    Shipped {
        name: "flown-1hz",
        campaign: include_str!("../../../../campaigns/league/flown-1hz.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Recordings("flown"),
    },
    Shipped {
        name: "low-altitude-1hz",
        campaign: include_str!("../../../../campaigns/league/low-altitude-1hz.toml"),
        vehicle: include_str!("../../../../vehicles/long-endurance.toml"),
        needs: Needs::Model("encounter-models/uncor_1200only_fwse_v1p2.txt"),
    },
    Shipped {
        name: "correlated-1hz",
        campaign: include_str!("../../../../campaigns/league/correlated-1hz.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Model("encounter-models/cor_v1.txt"),
    },
    Shipped {
        name: "drawn-1hz",
        campaign: include_str!("../../../../campaigns/league/drawn-1hz.toml"),
        vehicle: include_str!("../../../../vehicles/paper.toml"),
        needs: Needs::Nothing,
    },
    Shipped {
        name: "fleet-1hz",
        campaign: include_str!("../../../../campaigns/league/fleet-1hz.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Fleets,
    },
];

/// Fleets of a set without another number.
const FLEETS: u64 = 100;

/// Master seed of the fleets.
const FLEET_SEED: u64 = 1;

/// The reaction in which each policy meets itself.
const ITSELF: &str = "itself";

/// Names of the shipped sets, for messages and help.
pub fn shipped_names() -> String {
    SHIPPED.map(|set| set.name).join(", ")
}

/// How the intruders of a set react.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum LeagueReaction {
    /// They fly their tracks.
    None,
    /// By the policy of the ownship.
    Itself,
    /// By another policy.
    By(PolicyChoice),
}

impl LeagueReaction {
    /// Its name on the page and in tables.
    pub(super) fn name(&self) -> Option<String> {
        match self {
            Self::None => None,
            Self::Itself => Some(ITSELF.into()),
            Self::By(policy) => Some(policy.name()),
        }
    }

    /// The end of the name of a folder.
    pub(super) fn part(&self) -> String {
        match self {
            Self::None => String::new(),
            Self::Itself => format!("+{ITSELF}"),
            Self::By(policy) => format!("+{}", part(policy)),
        }
    }

    /// The policy of the intruders against a policy of the ownship.
    pub(super) fn against(&self, policy: &PolicyChoice) -> Option<String> {
        match self {
            Self::None => None,
            // Nobody reacts by flying the mission.
            Self::Itself => (*policy != PolicyChoice::Mission).then(|| policy.name()),
            Self::By(other) => Some(other.name()),
        }
    }
}

/// A set to fly.
#[derive(Clone)]
pub(super) struct Set {
    pub(super) name: String,
    pub(super) reaction: LeagueReaction,
    pub(super) path: PathBuf,
    pub(super) overrides: Overrides,
    shipped: Option<&'static Shipped>,
}

impl Set {
    /// Opens its campaign with all policies, whether its files are written or not; none of fleets, which fly what is written.
    fn open(
        &self,
        terms: &Terms,
        policies: &[PolicyChoice],
    ) -> Result<Option<Campaign>, CampaignError> {
        let overrides = Overrides {
            policies: policies.iter().map(PolicyChoice::name).collect(),
            intruders: policies.iter().find_map(|own| self.reaction.against(own)),
            ..self.overrides.clone()
        };
        let configuration = match self.shipped {
            Some(set) if matches!(set.needs, Needs::Fleets) => return Ok(None),
            Some(set) => file::from_text(&self.path, set.campaign, &overrides)?,
            None => file::read(&self.path, &overrides)?,
        };
        Campaign::with_own(configuration, &self.path, &terms.own).map(Some)
    }

    /// Writes the files of a shipped set into its folder.
    fn write(&self, terms: &Terms) -> Result<(), OutputError> {
        let (Some(shipped), Some(folder)) = (self.shipped, self.path.parent()) else {
            return Ok(());
        };
        if matches!(shipped.needs, Needs::Fleets) {
            draw_fleets(folder, terms.encounters.unwrap_or(FLEETS))?;
        }
        atomic::prepare_folder(folder)?;
        atomic::write(&self.path, shipped.campaign)
    }
}

/// The sets to fly, each with its reactions, and a sentence for each set that is left out. Writes the files of shipped ones once all
/// sets can be flown with the policies.
pub(super) fn sets(
    terms: &Terms,
    policies: &[PolicyChoice],
    out: &Path,
) -> Result<(Vec<Set>, Vec<String>), CampaignError> {
    let reactions = reactions(terms)?;
    let (sets, mut left_out) = chosen(terms, out)?;
    let mut all = Vec::new();
    for set in &sets {
        let has_tracks = set.open(terms, policies)?.is_none_or(|campaign| {
            let configuration = &campaign.configuration;
            configuration.cells.len() + configuration.files.len() == 0
        });
        if !reactions.is_empty() && !has_tracks {
            left_out.push(format!(
                "set {} with reactions: its obstacles fly straight and cannot react",
                set.name
            ));
        }
        all.push(set.clone());
        // A fleet reacts by itself only.
        let reacts = has_tracks && set.reaction == LeagueReaction::None;
        for reaction in reactions.iter().filter(|_| reacts) {
            let reacting = Set {
                reaction: reaction.clone(),
                ..set.clone()
            };
            reacting.open(terms, policies)?;
            all.push(reacting);
        }
    }
    for set in &sets {
        set.write(terms)?;
    }
    Ok((all, left_out))
}

/// The reactions besides none, each once.
fn reactions(terms: &Terms) -> Result<Vec<LeagueReaction>, CampaignError> {
    let mut reactions: Vec<LeagueReaction> = Vec::new();
    for name in &terms.intruders {
        let reaction = if name == ITSELF {
            LeagueReaction::Itself
        } else {
            let policy = policy_called(name, &terms.own).map_err(|message| {
                CampaignError::Other(format!("intruders: {message}, or {ITSELF}"))
            })?;
            LeagueReaction::By(policy)
        };
        if reactions.contains(&reaction) {
            return Err(CampaignError::Other(format!(
                "intruders {} are named twice, expected once",
                reaction.name().unwrap_or_default()
            )));
        }
        reactions.push(reaction);
    }
    reactions.retain(|reaction| *reaction != LeagueReaction::By(PolicyChoice::Mission));
    Ok(reactions)
}

/// The sets without the reactions asked for, and why others are left out.
fn chosen(terms: &Terms, out: &Path) -> Result<(Vec<Set>, Vec<String>), CampaignError> {
    let asked: Vec<&str> = if terms.sets.is_empty() {
        SHIPPED.iter().map(|set| set.name).collect()
    } else {
        terms.sets.iter().map(String::as_str).collect()
    };
    let (mut sets, mut left_out): (Vec<Set>, Vec<String>) = (Vec::new(), Vec::new());
    for name in asked {
        let set = match SHIPPED.iter().find(|set| set.name == name) {
            None if Path::new(name).extension().is_some_and(|is| is == "toml") => {
                of_file(Path::new(name), terms)
            }
            None => {
                return Err(CampaignError::Other(format!(
                    "there is no set {}, expected one of {}, or the path of a campaign file (.toml)",
                    fga_formats::error::shown(name),
                    shipped_names()
                )));
            }
            Some(set) => match of_shipped(set, terms, out) {
                Ok(found) => found,
                // A set that was asked for is needed.
                Err(why) if !terms.sets.is_empty() => return Err(CampaignError::Other(why)),
                Err(why) => {
                    left_out.push(why);
                    continue;
                }
            },
        };
        if sets.iter().any(|other| other.name == set.name) {
            return Err(CampaignError::Other(format!(
                "set {} is named twice, expected once",
                set.name
            )));
        }
        sets.push(set);
    }
    Ok((sets, left_out))
}

fn of_file(path: &Path, terms: &Terms) -> Set {
    Set {
        name: path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        reaction: LeagueReaction::None,
        path: path.to_owned(),
        overrides: Overrides {
            encounters: terms.encounters,
            own: terms.own.clone(),
            ..Overrides::default()
        },
        shipped: None,
    }
}

/// The campaign file of a shipped set, in its folder.
const CAMPAIGN: &str = "campaign.toml";

/// A shipped set, whose files belong into the folder; or why it cannot be flown.
fn of_shipped(set: &'static Shipped, terms: &Terms, out: &Path) -> Result<Set, String> {
    let mut overrides = Overrides {
        vehicle: Some(set.vehicle.to_owned()),
        own: terms.own.clone(),
        ..Overrides::default()
    };
    let folder = out.join(set.name);
    let mut reaction = LeagueReaction::None;
    match set.needs {
        Needs::Nothing => overrides.encounters = terms.encounters,
        Needs::Fleets => {
            overrides.recordings.push(folder.clone());
            reaction = LeagueReaction::Itself;
        }
        Needs::Recordings(place) | Needs::Model(place) => {
            let path = terms.data.as_ref().map(|data| data.join(place));
            let Some(path) = path.filter(|path| path.exists()) else {
                return Err(format!(
                    "set {} needs {place} in the folder of data (--data, or FGA_DATA), and it is not there",
                    set.name
                ));
            };
            if matches!(set.needs, Needs::Model(_)) {
                overrides.encounters = terms.encounters;
                overrides.model = Some(path);
            } else {
                overrides.recordings.push(path);
            }
        }
    }
    Ok(Set {
        name: set.name.to_owned(),
        reaction,
        path: folder.join(CAMPAIGN),
        overrides,
        shipped: Some(set),
    })
}

/// Draws fleets into a folder.
fn draw_fleets(folder: &Path, count: u64) -> Result<(), OutputError> {
    atomic::prepare_folder(folder)?;
    let path = folder.join(TRACKS);
    let failed = |error| OutputError::new(&path, std::io::Error::other(error));
    let mut table =
        DrawnWriter::new(AtomicFile::create(&path)?, DrawnContent::Tracks).map_err(failed)?;
    for number in 0..count {
        let origin = Origin {
            number: Some(number),
            seed: Some(FLEET_SEED),
            weight: 1.0,
        };
        let drawn = fleet(FLEET_SEED, number);
        table.push_tracks(&drawn, &origin).map_err(failed)?;
    }
    table.finish().map_err(failed)?.commit()
}

/// The name of a policy's folder; another program under the same name is another policy.
pub(super) fn part(policy: &PolicyChoice) -> String {
    let version = policy.own().map(|own| format!("-{}", &own.sha256()[..12]));
    file_name(&policy.name()) + &version.unwrap_or_default()
}

//! The league: every policy over sets of encounters, each a campaign of its own, and one page about all of them.
//!
//! A folder `SET/POLICY` holds each campaign. One that is complete is not flown again: a policy that joins, or whose program has
//! changed, flies alone, and an interrupted league goes on where it ended. Blocks that others have flown into such a folder count too.

mod sets;
mod standing;
mod terms;

use std::path::{Path, PathBuf};
use std::time::Instant;

use fga_campaign::campaign::file::{self, Overrides};
use fga_campaign::campaign::{
    Campaign, CampaignError, CampaignProgress, CampaignStamp, CampaignTask, Folder, RESULTS, Shard,
    assemble, policy_called, reread, run as fly,
};
use fga_formats::{InputError, atomic};
use fga_report::league::{League, LeagueSet};
use fga_sim::policy::PolicyChoice;
use serde_json::{Value, json};

use crate::campaign::safety::safety_case;
use crate::campaign::{decision_times, finish};
use crate::named_rows::{NamedRow, csv, objects};
use crate::parquet_rows::parquet;
use crate::provenance::{Provenance, TARGET};
use sets::{Set, part, sets};
use standing::{FlownCampaign, described, in_words, row, standing};

pub use sets::shipped_names;
pub use terms::Terms;

/// The policies of a league that names none.
pub const POLICIES: [&str; 15] = [
    "none",
    "turn-aware",
    "published --start t0",
    "waypoint-optimal",
    "waypoint-greedy",
    "orca",
    "mvp",
    "velocity-obstacles",
    "potential-field",
    "operator-f3442",
    "operator-do365",
    "right-of-way",
    "see-and-avoid",
    "tcas-like",
    "arduplane-rules",
];

/// The result of a league.
#[derive(Debug)]
pub struct LeagueFlown {
    /// The page.
    pub page: PathBuf,
    /// What was left out, one sentence each.
    pub left_out: Vec<String>,
    /// The standings in words.
    pub words: String,
    /// The standings, one object for each set and policy.
    pub rows: Value,
    /// The policies of one's own on both sides, for what they say of failures.
    pub own: Vec<PolicyChoice>,
}

/// A campaign of a league: a policy over a set.
#[derive(Debug)]
pub struct LeagueCampaign {
    /// Its folder below the league's.
    pub place: String,
    /// The campaign.
    pub campaign: Campaign,
}

/// The campaigns of a league, set by set; writes the files of shipped sets into the folder.
///
/// # Errors
/// Unknown sets or policies, unusable files, an unwritable folder.
pub fn campaigns(terms: &Terms, out: &Path) -> Result<Vec<LeagueCampaign>, CampaignError> {
    let policies = policies(terms)?;
    let (sets, _) = sets(terms, &policies, out)?;
    atomic::prepare_folder(out)?;
    let each = sets
        .iter()
        .flat_map(|set| policies.iter().map(move |policy| (set, policy)));
    each.map(|(set, policy)| campaign_of(terms, set, policy))
        .collect()
}

/// Flies what is missing of a league, and writes `league.html`, `league.parquet`, `league.csv` and `timing.csv` into a folder. `go_on`
/// and `show` are those of a campaign; `show` has the set and the policy.
///
/// # Errors
/// Unknown sets or policies, unusable files, an unwritable folder, or [`CampaignError::Stopped`].
pub fn run(
    terms: &Terms,
    out: &Path,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut (dyn FnMut(&str, &str, &CampaignProgress) + Send),
) -> Result<LeagueFlown, CampaignError> {
    let policies = policies(terms)?;
    // Every campaign asks the same ones, so that they know of all failures.
    let own = own_of(terms, &policies);
    let terms = &Terms {
        own: own
            .iter()
            .filter_map(|policy| policy.own().cloned())
            .collect(),
        ..terms.clone()
    };
    let (sets, left_out) = sets(terms, &policies, out)?;
    atomic::prepare_folder(out)?;
    let stamp = CampaignStamp::of_this_build(TARGET);
    let mut league = League {
        facts: vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("commit".into(), stamp.commit.clone()),
            ("target".into(), stamp.target.clone()),
        ],
        left_out: left_out.clone(),
        sets: Vec::new(),
    };
    let mut timing: Vec<NamedRow<String>> = Vec::new();
    for set in &sets {
        let mut shown = LeagueSet {
            name: set.name.clone(),
            intruders: set.reaction.name(),
            ..LeagueSet::default()
        };
        let title = shown.title();
        for policy in &policies {
            let LeagueCampaign { place, campaign } = campaign_of(terms, set, policy)?;
            if !go_on() {
                let total = campaign.configuration.encounters;
                return Err(CampaignError::Stopped { done: 0, total });
            }
            let folder = Folder::at(&out.join(&place));
            let name = policy.name();
            let flown = fly_one(&campaign, &stamp, &folder, go_on, &mut |progress| {
                show(&title, &name, progress);
            })?;
            timing.extend(timing_row(&folder, &title));
            let beside = rival(policy, &policies);
            let mut case = safety_case(
                &campaign,
                &flown.manifest,
                &folder,
                terms.worst,
                beside.as_ref(),
            )?;
            for worst in &mut case.worst {
                worst.href = format!("{place}/{}", worst.href);
            }
            shown.worst.append(&mut case.worst);
            if shown.about.is_empty() {
                (shown.about, shown.assumed) = described(&campaign, &case, &set.reaction);
            }
            shown.has_aircraft |= case.encounters > 0;
            shown.standings.extend(standing(case, &flown));
        }
        league.sets.push(shown);
    }
    let rows: Vec<NamedRow<String>> = league
        .sets
        .iter()
        .flat_map(|set| set.standings.iter().map(|standing| row(set, standing)))
        .collect();
    let table = parquet(&rows, env!("CARGO_PKG_VERSION"))
        .map_err(|error| CampaignError::Other(error.to_string()))?;
    atomic::write(&out.join("league.parquet"), table)?;
    atomic::write(&out.join("league.csv"), csv(&rows))?;
    if !timing.is_empty() {
        atomic::write(&out.join("timing.csv"), csv(&timing))?;
    }
    let page = out.join("league.html");
    atomic::write(&page, league.to_html())?;
    Ok(LeagueFlown {
        page,
        left_out,
        words: in_words(&league),
        rows: objects(rows),
        own,
    })
}

/// The policies of one's own on both sides, each once.
fn own_of(terms: &Terms, policies: &[PolicyChoice]) -> Vec<PolicyChoice> {
    let intruders = terms.intruders.iter();
    let intruders = intruders.filter_map(|name| policy_called(name, &terms.own).ok());
    let mut own: Vec<PolicyChoice> = Vec::new();
    for policy in policies.iter().cloned().chain(intruders) {
        if policy.own().is_some() && !own.contains(&policy) {
            own.push(policy);
        }
    }
    own
}

/// The policy whose flight a replay shows beside another one's: the default one, and beside that the first other one that acts.
fn rival(policy: &PolicyChoice, policies: &[PolicyChoice]) -> Option<PolicyChoice> {
    let default = PolicyChoice::default();
    if *policy != default {
        return Some(default);
    }
    let mut others = policies.iter().filter(|other| **other != default);
    let acts = others
        .clone()
        .find(|other| **other != PolicyChoice::Mission);
    acts.or_else(|| others.next()).cloned()
}

/// The campaign of a policy over a set.
fn campaign_of(
    terms: &Terms,
    set: &Set,
    policy: &PolicyChoice,
) -> Result<LeagueCampaign, CampaignError> {
    let overrides = Overrides {
        policies: vec![policy.name()],
        intruders: set.reaction.against(policy),
        own: terms.own.clone(),
        ..set.overrides.clone()
    };
    let configuration = file::read(&set.path, &overrides)?;
    Ok(LeagueCampaign {
        place: format!("{}{}/{}", set.name, set.reaction.part(), part(policy)),
        campaign: Campaign::with_own(configuration, &set.path, &terms.own)?,
    })
}

/// The policies, each once.
fn policies(terms: &Terms) -> Result<Vec<PolicyChoice>, CampaignError> {
    let mut policies: Vec<PolicyChoice> = Vec::new();
    let named: Vec<String> = if terms.policies.is_empty() {
        POLICIES.map(str::to_owned).to_vec()
    } else {
        terms.policies.clone()
    };
    for name in named {
        let policy = policy_called(&name, &terms.own).map_err(CampaignError::Other)?;
        if policies.contains(&policy) {
            return Err(CampaignError::Other(format!(
                "policy {} is named twice, expected once",
                policy.name()
            )));
        }
        policies.push(policy);
    }
    Ok(policies)
}

/// Flies what is missing of a campaign, and sums it up.
fn fly_one(
    campaign: &Campaign,
    stamp: &CampaignStamp,
    folder: &Folder,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut (dyn FnMut(&CampaignProgress) + Send),
) -> Result<FlownCampaign, CampaignError> {
    let task = CampaignTask {
        campaign,
        shard: Shard::WHOLE,
        stamp: stamp.clone(),
        folder: Folder::at(folder.path()),
        resume: true,
        is_expected: false,
        ends_begun: false,
    };
    let manifest = task.manifest();
    if folder.file(RESULTS).exists() {
        folder.open(&manifest, true)?;
        let there = reread(folder, campaign, None)?;
        return Ok(FlownCampaign {
            manifest,
            summary: there.summary,
            sha256: there.sha256,
        });
    }
    let provenance = Provenance::begin();
    let begun = Instant::now();
    let times = fly(&task, go_on, show)?;
    let fly_s = begun.elapsed().as_secs_f64();
    let assembled = assemble(&folder.blocks()?, campaign, stamp, folder, false)?;
    let sha256 = assembled.sha256.clone();
    let summary = finish(
        folder,
        campaign,
        &manifest,
        assembled,
        &provenance,
        json!({ "decision_times": decision_times(campaign, &times, fly_s) }),
    )?;
    Ok(FlownCampaign {
        manifest,
        summary,
        sha256,
    })
}

/// A row of `timing.csv`, of the run that completed the campaign; none where others flew it.
fn timing_row(folder: &Folder, set: &str) -> Option<NamedRow<String>> {
    let text = std::fs::read_to_string(folder.file("run.json")).ok()?;
    let document: Value = serde_json::from_str(&text).ok()?;
    let times = document
        .pointer("/decision_times/policies/0")?
        .as_object()?;
    let times = times
        .iter()
        .map(|(name, value)| (name.clone(), value.clone()));
    let set = ("set".to_owned(), json!(set));
    Some(core::iter::once(set).chain(times).collect())
}

/// The folder of third-party data that the environment names.
pub fn data_of_environment() -> Option<PathBuf> {
    std::env::var_os("FGA_DATA").map(PathBuf::from)
}

/// A folder of data that is there.
///
/// # Errors
/// One that is not.
pub fn checked_data(data: PathBuf) -> Result<PathBuf, InputError> {
    if data.is_dir() {
        Ok(data)
    } else {
        Err(InputError::in_file(
            data,
            "is no folder, expected one with third-party data such as flown and encounter-models",
        ))
    }
}

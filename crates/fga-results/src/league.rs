//! The league: every policy over sets of encounters, each a campaign of its own, and one page about all of them.
//!
//! A folder `SET/POLICY` holds each campaign. One that is complete is not flown again: a policy that joins, or whose program has
//! changed, flies alone, and an interrupted league goes on where it ended.

use std::path::{Path, PathBuf};

use fga_formats::{InputError, OutputError, atomic};
use fga_report::league::{League, LeagueSet, Standing};
use fga_report::safety_case::SafetyCase;
use fga_sim::campaign::file::{self, Overrides};
use fga_sim::campaign::{
    Campaign, CampaignError, DecisionTimes, Folder, Manifest, Progress, RESULTS, Shard, Stamp,
    Summary, Task, assemble, policy_called, reread, run as fly,
};
use fga_sim::own::OwnPolicy;
use fga_sim::policy::PolicyChoice;
use serde_json::{Value, json};

use crate::campaign::finish;
use crate::campaign::safety::{file_name, safety_case};
use crate::named_rows::{Row, csv, rounded};
use crate::parquet_rows::parquet;
use crate::provenance::{Provenance, TARGET};

/// Third-party data of a set, below the folder of data.
enum Needs {
    /// None: the encounters are drawn from families.
    Nothing,
    /// A folder of recordings.
    Recordings(&'static str),
    /// The file of an encounter model.
    Model(&'static str),
}

/// A shipped set.
struct Shipped {
    name: &'static str,
    campaign: &'static str,
    vehicle: &'static str,
    needs: Needs,
}

const WELL_CLEAR: &str = include_str!("../../../vehicles/general-aviation-well-clear.toml");

const SHIPPED: [Shipped; 5] = [
    Shipped {
        name: "flown",
        campaign: include_str!("../../../campaigns/league/flown.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Recordings("flown"),
    },
    Shipped {
        name: "flown-1hz",
        campaign: include_str!("../../../campaigns/league/flown-1hz.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Recordings("flown"),
    },
    Shipped {
        name: "low-altitude-1hz",
        campaign: include_str!("../../../campaigns/league/low-altitude-1hz.toml"),
        vehicle: include_str!("../../../vehicles/long-endurance.toml"),
        needs: Needs::Model("encounter-models/uncor_1200only_fwse_v1p2.txt"),
    },
    Shipped {
        name: "correlated-1hz",
        campaign: include_str!("../../../campaigns/league/correlated-1hz.toml"),
        vehicle: WELL_CLEAR,
        needs: Needs::Model("encounter-models/cor_v1.txt"),
    },
    Shipped {
        name: "drawn-1hz",
        campaign: include_str!("../../../campaigns/league/drawn-1hz.toml"),
        vehicle: include_str!("../../../vehicles/paper.toml"),
        needs: Needs::Nothing,
    },
];

/// Names of the shipped sets, for messages and help.
pub fn shipped_names() -> String {
    SHIPPED.map(|set| set.name).join(", ")
}

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

/// What a league flies.
#[derive(Debug, Clone, Default)]
pub struct Terms {
    /// Sets: names of shipped ones, or paths of campaign files; without any, all shipped ones whose data are there.
    pub sets: Vec<String>,
    /// Policies by their names on the command line, or of `own`; without any, [`POLICIES`].
    pub policies: Vec<String>,
    /// Policies by which intruders with tracks react, besides `none`, which is always flown: they fly their tracks.
    pub intruders: Vec<String>,
    /// Policies outside of this program.
    pub own: Vec<OwnPolicy>,
    /// Folder of third-party data, with `flown` and `encounter-models`.
    pub data: Option<PathBuf>,
    /// Encounters of each set that draws them; without it the set's number.
    pub encounters: Option<u64>,
    /// Worst encounters of each policy in each set with a replay.
    pub worst: usize,
}

/// A set to fly.
#[derive(Clone)]
struct Set {
    name: String,
    /// How its intruders react.
    intruders: Option<PolicyChoice>,
    path: PathBuf,
    overrides: Overrides,
}

/// The result of a league.
#[derive(Debug)]
pub struct Flown {
    /// The page.
    pub page: PathBuf,
    /// What was left out, one sentence each.
    pub left_out: Vec<String>,
    /// The standings in words.
    pub words: String,
    /// The standings, one object for each set and policy.
    pub rows: Value,
    /// The policies, for what they say of failures.
    pub policies: Vec<PolicyChoice>,
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
    show: &mut (dyn FnMut(&str, &str, &Progress) + Send),
) -> Result<Flown, CampaignError> {
    let policies = policies(terms)?;
    let reactions = reactions(terms)?;
    atomic::prepare_folder(out)?;
    let (sets, mut left_out) = sets(terms, out)?;
    let sets = with_reactions(sets, &reactions, &mut left_out)?;
    let beside = PolicyChoice::default();
    let stamp = Stamp::of_this_build(TARGET);
    let mut league = League {
        facts: vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("commit".into(), stamp.commit.clone()),
            ("target".into(), stamp.target.clone()),
        ],
        left_out: left_out.clone(),
        sets: Vec::new(),
    };
    let mut timing: Vec<Row<&str>> = Vec::new();
    for set in &sets {
        let mut about = None;
        let mut shown = LeagueSet {
            name: set.name.clone(),
            intruders: set.intruders.as_ref().map(PolicyChoice::name),
            ..LeagueSet::default()
        };
        let title = shown.title();
        let reaction = set.intruders.as_ref();
        let reaction = reaction.map_or_else(String::new, |policy| format!("+{}", part(policy)));
        for policy in &policies {
            let overrides = Overrides {
                policies: vec![policy.name()],
                own: terms.own.clone(),
                ..set.overrides.clone()
            };
            let configuration = file::read(&set.path, &overrides)?;
            let campaign = Campaign::with_own(configuration, &set.path, &terms.own)?;
            let place = format!("{}{reaction}/{}", set.name, part(policy));
            let one = fly_one(
                &campaign,
                &stamp,
                &out.join(&place),
                go_on,
                &mut |progress| {
                    show(&title, &policy.name(), progress);
                },
            )?;
            let times = one.times.as_ref();
            timing.extend(times.map(|times| timing_row(&title, &policy.name(), times)));
            let folder = Folder::at(&out.join(&place));
            let mut case = safety_case(
                &campaign,
                &one.manifest,
                &folder,
                terms.worst,
                Some(&beside),
            )?;
            for worst in &mut case.worst {
                worst.href = format!("{place}/{}", worst.href);
            }
            shown.worst.append(&mut case.worst);
            about.get_or_insert_with(|| described(&campaign, &case));
            shown.has_aircraft |= case.encounters > 0;
            shown.standings.extend(standing(case, &one));
        }
        if let Some((words, assumed)) = about {
            (shown.about, shown.assumed) = (words, assumed);
        }
        league.sets.push(shown);
    }
    let rows: Vec<Row<&str>> = league
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
    Ok(Flown {
        page,
        left_out,
        words: in_words(&league),
        rows: crate::named_rows::objects(rows),
        policies,
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

/// The name of a policy's folder; another program under the same name is another policy.
fn part(policy: &PolicyChoice) -> String {
    let version = policy.own().map(|own| format!("-{}", &own.sha256()[..12]));
    file_name(&policy.name()) + &version.unwrap_or_default()
}

/// The reactions besides none, each once.
fn reactions(terms: &Terms) -> Result<Vec<PolicyChoice>, CampaignError> {
    let mut reactions: Vec<PolicyChoice> = Vec::new();
    for name in &terms.intruders {
        let reaction = policy_called(name, &terms.own)
            .map_err(|message| CampaignError::Other(format!("intruders: {message}")))?;
        if reactions.contains(&reaction) {
            return Err(CampaignError::Other(format!(
                "intruders {} are named twice, expected once",
                reaction.name()
            )));
        }
        reactions.push(reaction);
    }
    reactions.retain(|reaction| *reaction != PolicyChoice::Mission);
    Ok(reactions)
}

/// Each set without reactions and with each of them, where its intruders have tracks.
fn with_reactions(
    sets: Vec<Set>,
    reactions: &[PolicyChoice],
    left_out: &mut Vec<String>,
) -> Result<Vec<Set>, CampaignError> {
    let mut all = Vec::new();
    for set in sets {
        let configuration = file::read(&set.path, &set.overrides)?;
        let has_tracks = configuration.cells.len() + configuration.files.len() == 0;
        if !reactions.is_empty() && !has_tracks {
            left_out.push(format!(
                "set {} with reactions: its obstacles fly straight and cannot react",
                set.name
            ));
        }
        all.push(set.clone());
        all.extend(reactions.iter().filter(|_| has_tracks).map(|reaction| Set {
            intruders: Some(reaction.clone()),
            overrides: Overrides {
                intruders: Some(reaction.name()),
                ..set.overrides.clone()
            },
            ..set.clone()
        }));
    }
    Ok(all)
}

/// The sets to fly, and why others are not.
fn sets(terms: &Terms, out: &Path) -> Result<(Vec<Set>, Vec<String>), CampaignError> {
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
            Some(set) => match of_shipped(set, terms, out)? {
                Ok(set) => set,
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
        intruders: None,
        path: path.to_owned(),
        overrides: Overrides {
            encounters: terms.encounters,
            own: terms.own.clone(),
            ..Overrides::default()
        },
    }
}

/// A shipped set, whose files are written into the folder; or why it cannot be flown.
fn of_shipped(
    set: &Shipped,
    terms: &Terms,
    out: &Path,
) -> Result<Result<Set, String>, OutputError> {
    let mut overrides = Overrides {
        vehicle: Some(set.vehicle.to_owned()),
        ..Overrides::default()
    };
    let needed = match set.needs {
        Needs::Nothing => None,
        Needs::Recordings(part) | Needs::Model(part) => {
            let path = terms.data.as_ref().map(|data| data.join(part));
            match path.filter(|path| path.exists()) {
                Some(path) => Some(path),
                None => {
                    return Ok(Err(format!(
                        "set {} needs {part} in the folder of data (--data, or FGA_DATA), and it is not there",
                        set.name
                    )));
                }
            }
        }
    };
    match (&set.needs, needed) {
        (Needs::Recordings(_), Some(path)) => overrides.recordings.push(path),
        (needs, path) => {
            overrides.encounters = terms.encounters;
            if matches!(needs, Needs::Model(_)) {
                overrides.model = path;
            }
        }
    }
    let folder = out.join(set.name);
    atomic::prepare_folder(&folder)?;
    let path = folder.join("campaign.toml");
    atomic::write(&path, set.campaign)?;
    Ok(Ok(Set {
        name: set.name.to_owned(),
        intruders: None,
        path,
        overrides,
    }))
}

/// A flown campaign of one policy.
struct One {
    manifest: Manifest,
    summary: Summary,
    sha256: String,
    /// Of the flights of this run.
    times: Option<DecisionTimes>,
}

/// Flies what is missing of a campaign, and sums it up.
fn fly_one(
    campaign: &Campaign,
    stamp: &Stamp,
    place: &Path,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut (dyn FnMut(&Progress) + Send),
) -> Result<One, CampaignError> {
    let task = Task {
        campaign,
        shard: Shard::WHOLE,
        stamp: stamp.clone(),
        folder: Folder::at(place),
        resume: true,
        is_expected: false,
    };
    let manifest = task.manifest();
    if task.folder.file(RESULTS).exists() {
        task.folder.open(&manifest, true)?;
        let there = reread(&task.folder, campaign, None)?;
        return Ok(One {
            manifest,
            summary: there.summary,
            sha256: there.sha256,
            times: None,
        });
    }
    let provenance = Provenance::begin();
    let times = fly(&task, go_on, show)?;
    let assembled = assemble(&task.folder.blocks()?, campaign, stamp, &task.folder, false)?;
    let sha256 = assembled.sha256.clone();
    let summary = finish(
        &task.folder,
        campaign,
        &manifest,
        assembled,
        &provenance,
        json!({}),
    )?;
    Ok(One {
        manifest,
        summary,
        sha256,
        times: times.into_iter().next(),
    })
}

/// What a set is, and what was assumed.
fn described(campaign: &Campaign, case: &SafetyCase) -> (Vec<String>, Vec<(String, String)>) {
    let configuration = &campaign.configuration;
    let effective = if case.encounters > 0 {
        format!(" (effective number {:.0})", case.effective)
    } else {
        String::new()
    };
    let reacts = campaign.intruders.as_ref().map_or_else(String::new, |policy| {
        format!(
            " Intruders fly their tracks until they react by the policy {}, as light aircraft with the same sight.",
            policy.name()
        )
    });
    let mut about = vec![format!(
        "{} encounters{effective} of {}; vehicle {}.{reacts}",
        configuration.encounters,
        campaign.source_names().join(", "),
        campaign.model.name
    )];
    about.extend(case.stands_for.iter().cloned());
    (about, case.assumed.clone())
}

/// The results of the one policy of a campaign.
fn standing(case: SafetyCase, one: &One) -> Option<Standing> {
    let case = case.policies.into_iter().next()?;
    let (_, totals) = one.summary.policies().next()?;
    let share = |share: f64| totals.cross_track_m.at(share);
    Some(Standing {
        encounters: totals.encounters,
        threatened: totals.threatened,
        entered: totals.encounters - totals.separated,
        caused: totals.caused,
        needless: totals.needless,
        manoeuvred: totals.manoeuvred,
        rejoined: totals.rejoined,
        cross_track_m: [share(0.5), share(0.9)],
        extra_path_m: totals.extra_path_m.at(0.5),
        away_s: totals.time_away_s.at(0.5),
        sha256: one.sha256.clone(),
        case,
    })
}

/// A row of `league.parquet`.
fn row<'a>(set: &LeagueSet, standing: &Standing) -> Row<&'a str> {
    let case = &standing.case;
    let real = |value: Option<f64>| json!(value.map(rounded));
    let mut row: Row<&str> = vec![
        ("set", json!(set.name)),
        (
            "intruders",
            json!(set.intruders.as_deref().unwrap_or("none")),
        ),
        ("policy", json!(case.policy)),
        ("encounters", json!(standing.encounters)),
        ("threatened", json!(standing.threatened)),
        ("entered", json!(standing.entered)),
        ("caused", json!(standing.caused)),
        ("needless", json!(standing.needless)),
        ("manoeuvred", json!(standing.manoeuvred)),
        ("rejoined", json!(standing.rejoined)),
        ("cross_track_p50_m", real(standing.cross_track_m[0])),
        ("cross_track_p90_m", real(standing.cross_track_m[1])),
        ("extra_path_p50_m", real(standing.extra_path_m)),
        ("time_away_p50_s", real(standing.away_s)),
        ("policy_failures", json!(case.failed)),
    ];
    let names = [
        [
            "nmac_nominal",
            "nmac",
            "nmac_induced",
            "nmac_ratio",
            "nmac_ratio_low",
            "nmac_ratio_high",
        ],
        [
            "lowc_nominal",
            "lowc",
            "lowc_induced",
            "lowc_ratio",
            "lowc_ratio_low",
            "lowc_ratio_high",
        ],
        [
            "do365_nominal",
            "do365",
            "do365_induced",
            "do365_ratio",
            "do365_ratio_low",
            "do365_ratio_high",
        ],
    ];
    for ([nominal, flown, induced, value, low, high], lost) in
        names.into_iter().zip([&case.nmac, &case.lowc, &case.do365])
    {
        let ratio = lost.ratio;
        row.push((nominal, json!(lost.nominal)));
        row.push((flown, json!(lost.flown)));
        row.push((induced, json!(lost.induced)));
        row.push((value, real(ratio.map(|ratio| ratio.value))));
        row.push((low, real(ratio.map(|ratio| ratio.low))));
        row.push((high, real(ratio.map(|ratio| ratio.high))));
    }
    row.push(("lowc_needless", json!(case.needless)));
    row.push(("lowc_clear", json!(case.clear)));
    row.push(("restless", json!(case.restless)));
    row.push(("results_sha256", json!(standing.sha256)));
    row
}

fn timing_row<'a>(set: &str, policy: &str, times: &DecisionTimes) -> Row<&'a str> {
    vec![
        ("set", json!(set)),
        ("policy", json!(policy)),
        ("encounters_flown", json!(times.encounters)),
        ("decisions", json!(times.decisions)),
        (
            "decision_median_us",
            json!(times.median_us.at(0.5).map(rounded)),
        ),
        ("decision_max_us", json!(times.max_ns as f64 / 1000.0)),
        (
            "flight_mean_us",
            json!(rounded(
                times.flight_ns as f64 / 1000.0 / times.encounters.max(1) as f64
            )),
        ),
    ]
}

/// The standings as tables of text.
fn in_words(league: &League) -> String {
    use core::fmt::Write as _;
    let mut text = String::new();
    for set in &league.sets {
        // Writing to a text does not fail.
        let _ = writeln!(
            text,
            "{:<28} {:>10} {:>10} {:>10} {:>10} {:>12} {:>12} {:>8}",
            set.title(),
            "NMAC",
            "LoWC",
            "entered",
            "needless",
            "aside (m)",
            "90 % (m)",
            "failed"
        );
        for standing in &set.standings {
            let case = &standing.case;
            let of = |left: u64, all: u64, is_there: bool| {
                if is_there {
                    format!("{left}/{all}")
                } else {
                    "-".into()
                }
            };
            let metres =
                |value: Option<f64>| value.map_or_else(|| "-".into(), |m| format!("{m:.0}"));
            let needless = if set.has_aircraft {
                of(case.needless, case.clear, true)
            } else {
                of(
                    standing.needless,
                    standing.encounters - standing.threatened,
                    true,
                )
            };
            let _ = writeln!(
                text,
                "{:<28} {:>10} {:>10} {:>10} {needless:>10} {:>12} {:>12} {:>8}",
                case.policy,
                of(case.nmac.flown, case.nmac.nominal, set.has_aircraft),
                of(case.lowc.flown, case.lowc.nominal, set.has_aircraft),
                of(standing.entered, standing.threatened, true),
                metres(standing.cross_track_m[0]),
                metres(standing.cross_track_m[1]),
                case.failed
            );
        }
    }
    text
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

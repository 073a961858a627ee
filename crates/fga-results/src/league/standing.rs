//! The results of the policies: for the page, for the tables, in words.

use fga_campaign::campaign::{Campaign, Manifest, Summary};
use fga_report::league::{League, LeagueSet, Standing};
use fga_report::safety_case::SafetyCase;
use serde_json::{Value, json};

use super::sets::LeagueReaction;
use crate::named_rows::{NamedRow, rounded};

/// What a set is, and what was assumed.
pub(super) fn described(
    campaign: &Campaign,
    case: &SafetyCase,
    reaction: &LeagueReaction,
) -> (Vec<String>, Vec<(String, String)>) {
    let configuration = &campaign.configuration;
    let effective = if case.encounters > 0 {
        format!(" (effective number {:.0})", case.effective)
    } else {
        String::new()
    };
    let by = match reaction {
        LeagueReaction::None => None,
        LeagueReaction::Itself => Some("the policy of the row".to_owned()),
        LeagueReaction::By(policy) => Some(format!("the policy {}", policy.name())),
    };
    let reacts = by.as_ref().map(|by| {
        format!("intruders fly their tracks until they react by {by}, as light aircraft with the same sight")
    });
    let mut about = vec![format!(
        "{} encounters{effective} of {}; vehicle {}{}.",
        configuration.encounters,
        campaign.source_names().join(", "),
        campaign.model.name,
        reacts
            .as_ref()
            .map_or_else(String::new, |reacts| format!("; {reacts}"))
    )];
    about.extend(case.stands_for.iter().cloned());
    let mut assumed: Vec<(String, String)> = case.assumed.all().cloned().collect();
    // The first policy's campaign knows its own intruders only.
    if let (Some(reacts), Some(row)) = (
        reacts,
        assumed.iter_mut().find(|(name, _)| name == "intruders"),
    ) {
        row.1 = reacts;
    }
    (about, assumed)
}

/// The results of the one policy of a campaign.
pub(super) fn standing(case: SafetyCase, flown: &FlownCampaign) -> Option<Standing> {
    let case = case.policies.into_iter().next()?;
    let (_, totals) = flown.summary.policies().next()?;
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
        work: [0.5, 1.0].map(|share| totals.work.at(share).map(f64::round)),
        sha256: flown.sha256.clone(),
        case,
    })
}

/// A row of `league.parquet`.
pub(super) fn row(set: &LeagueSet, standing: &Standing) -> NamedRow<String> {
    let case = &standing.case;
    let real = |value: Option<f64>| json!(value.map(rounded));
    let first = [
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
        ("work_p50", real(standing.work[0])),
        ("work_most", real(standing.work[1])),
        ("policy_failures", json!(case.failed)),
    ];
    let named = |(name, value): (&str, Value)| (name.to_owned(), value);
    let mut row: NamedRow<String> = first.into_iter().map(named).collect();
    for (loss, lost) in [
        ("nmac", &case.nmac),
        ("lowc", &case.lowc),
        ("do365", &case.do365),
    ] {
        let ratio = lost.ratio;
        row.extend([
            (format!("{loss}_nominal"), json!(lost.nominal)),
            (loss.into(), json!(lost.flown)),
            (format!("{loss}_induced"), json!(lost.induced)),
            (
                format!("{loss}_ratio"),
                real(ratio.map(|ratio| ratio.value)),
            ),
            (
                format!("{loss}_ratio_low"),
                real(ratio.map(|ratio| ratio.low)),
            ),
            (
                format!("{loss}_ratio_high"),
                real(ratio.map(|ratio| ratio.high)),
            ),
        ]);
    }
    let last = [
        ("lowc_needless", json!(case.needless)),
        ("lowc_clear", json!(case.clear)),
        ("restless", json!(case.restless)),
        ("results_sha256", json!(standing.sha256)),
    ];
    row.extend(last.into_iter().map(named));
    row
}

/// The standings as tables of text.
pub(super) fn in_words(league: &League) -> String {
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

/// A flown campaign of one policy.
pub(super) struct FlownCampaign {
    pub(super) manifest: Manifest,
    pub(super) summary: Summary,
    pub(super) sha256: String,
}

//! Which test holds which number of the page.

use crate::report::{Cell, Column, Section, SectionBlock, Table};

const AIRCRAFT: &str = "crates/fga-cli/tests/cli/aircraft_campaign.rs";
const RECOMPUTED: &str = "crates/fga-cli/tests/cli/recomputed.rs";
const RISK: &str = "crates/fga-campaign/src/campaign/risk.rs";
const JUDGE: &str = "crates/fga-campaign/src/campaign/judge.rs";
const MODELED: &str = "crates/fga-campaign/tests/campaign/modeled.rs";

/// Numbers of the page, how they are held, the file of the test, the test.
const TRACED: &[[&str; 4]] = &[
    [
        "NMAC and LoWC, with and without",
        "recordings worked out by hand",
        AIRCRAFT,
        "recordings_are_judged_as_worked_out_by_hand",
    ],
    [
        "the same; needless, induced, ratios and Wilson intervals",
        "a script of other code reads recordings and flown tracks",
        RECOMPUTED,
        "the_numbers_of_flown_encounters_are_those_of_a_script_that_reads_the_tracks",
    ],
    [
        "separations without avoidance",
        "another computation on the sphere, hundred samples a row",
        RECOMPUTED,
        "separations_of_every_flown_recording_are_those_of_another_computation",
    ],
    [
        "LoWC of DO-365B",
        "the check case of DEGAS",
        RECOMPUTED,
        "the_check_case_of_degas_loses_well_clear_as_it_should",
    ],
    [
        "DO-365B alerts",
        "tables of DAIDALUS, by diff",
        "crates/fga-cli/tests/cli/alerts.rs",
        "tables_of_h1_equal_the_reference_by_diff",
    ],
    [
        "weighted ratios, induced losses",
        "numbers by hand",
        RISK,
        "a_ratio_is_weighted_and_counts_what_is_induced",
    ],
    [
        "95 % intervals by bootstrap",
        "coverage over drawn campaigns",
        RISK,
        "the_intervals_cover_as_often_as_they_say",
    ],
    [
        "intervals where nothing is left",
        "Wilson's, by hand",
        RISK,
        "where_nothing_is_left_the_upper_end_is_wilsons",
    ],
    [
        "Wilson intervals",
        "a statistics package",
        "crates/fga-report/src/interval.rs",
        "wilson_agrees_with_a_statistics_package",
    ],
    [
        "verdicts on thresholds",
        "ends of intervals by hand",
        "crates/fga-report/src/safety_case.rs",
        "a_threshold_is_met_only_where_the_whole_interval_is_below",
    ],
    [
        "giving way",
        "counts and leads by hand",
        "crates/fga-report/src/safety_case.rs",
        "giving_way_leaves_out_what_the_policy_loses_itself",
    ],
    [
        "extrapolated NMAC ratio",
        "coverage over a distribution whose probability is known",
        "crates/fga-campaign/src/campaign/tail.rs",
        "the_interval_covers_the_probability_of_a_known_distribution",
    ],
    [
        "distances in units of the NMAC volume",
        "between samples, by hand",
        JUDGE,
        "the_scale_of_a_near_collision_is_found_between_samples",
    ],
    [
        "restless",
        "tracks by hand",
        JUDGE,
        "d9_changes_follow_from_the_track",
    ],
    [
        "weights of drawn encounters",
        "the same results as uniform draws",
        MODELED,
        "weights_reproduce_the_uniform_result",
    ],
    [
        "encounters drawn",
        "the closest approach is where it was put",
        MODELED,
        "the_closest_approach_is_where_it_was_put",
    ],
    [
        "encounters drawn",
        "none begins with its loss",
        MODELED,
        "no_encounter_begins_with_its_loss",
    ],
    [
        "losses in a flight hour",
        "in proportion to the density",
        AIRCRAFT,
        "losses_in_a_flight_hour_need_a_density_and_an_uncorrelated_model",
    ],
    [
        "all numbers",
        "the same bytes on any number of threads, in parts, resumed",
        AIRCRAFT,
        "the_same_bytes_on_one_and_two_threads_in_parts_and_resumed",
    ],
    [
        "worst encounters",
        "every replay of the page is there",
        AIRCRAFT,
        "the_safety_case_is_one_page_with_its_replays",
    ],
];

/// The table of tests.
pub(super) fn section() -> Section {
    let rows = TRACED
        .iter()
        .map(|row| row.iter().map(|text| Cell::Text((*text).into())).collect());
    Section {
        title: "8. Which test holds which number".into(),
        blocks: vec![SectionBlock::Table(Table {
            caption: "Tests of the repository of the program. Those of recordings and DAIDALUS need the third-party data that docs/sources.md names; without \
                them they are skipped, and fail in continuous integration."
                .into(),
            columns: ["number", "held against", "file", "test"].map(Column::text).into(),
            rows: rows.collect(),
        })],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_test_that_is_named_is_there() {
        let repository = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for [number, _, file, test] in TRACED {
            let text = std::fs::read_to_string(repository.join(file)).unwrap_or_default();
            let is_test = text.split("#[test]").skip(1).any(|rest| {
                rest.split('{')
                    .next()
                    .is_some_and(|head| head.contains(&format!("fn {test}(")))
            });
            assert!(is_test, "{number}: {file} {test}");
        }
    }
}

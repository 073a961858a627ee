//! The encounter models: drawn states against samples from another program, a network small
//! enough to work out by hand, and every refusal.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::encounter_model::{self, EncounterModel};
use proptest::prelude::*;
use std::io::Read;
use std::path::Path;

/// Uniform numbers in [0, 1) by `SplitMix64`.
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let value = ((z ^ (z >> 31)) >> 11) as f64;
        value / 9_007_199_254_740_992.0
    }
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (ma, mb) = (mean(a), mean(b));
    let cov = |a: &[f64], ma: f64, b: &[f64], mb: f64| {
        a.iter()
            .zip(b)
            .map(|(x, y)| (x - ma) * (y - mb))
            .sum::<f64>()
    };
    cov(a, ma, b, mb) / (cov(a, ma, a, ma) * cov(b, mb, b, mb)).sqrt()
}

#[test]
fn drawn_states_are_distributed_like_those_of_another_program() {
    let (Some(model), Some(reference)) = (
        data("encounter-models/cor_v1.txt"),
        data("encounter-models/reference/initial.txt.gz"),
    ) else {
        return;
    };
    let model = encounter_model::read(&model).unwrap();
    let mut text = String::new();
    flate2::read::GzDecoder::new(std::fs::File::open(reference).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    let theirs: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| {
            line.split_whitespace()
                .skip(1)
                .map(|v| v.parse().unwrap())
                .collect()
        })
        .collect();
    assert_eq!(theirs.len(), 10_000);
    let mut random = uniform(1);
    let ours: Vec<Vec<f64>> = (0..10_000)
        .map(|_| model.start(&mut random).values().to_vec())
        .collect();
    let column =
        |rows: &[Vec<f64>], index: usize| -> Vec<f64> { rows.iter().map(|r| r[index]).collect() };
    let variables = model.variables();
    assert_eq!(variables.len(), 16);
    for (index, variable) in variables.iter().enumerate() {
        let label = &variable.label;
        // The share of each bin, within five standard deviations of a difference of shares.
        let share = |rows: &[Vec<f64>]| {
            let mut shares = vec![0.0; variable.bins];
            for value in column(rows, index) {
                shares[variable.bin_of(value)] += 1.0 / 10_000.0;
            }
            shares
        };
        for (a, b) in share(&ours).iter().zip(share(&theirs)) {
            let p = f64::midpoint(*a, b);
            let deviation = (2.0 * p * (1.0 - p) / 10_000.0).sqrt();
            assert!((a - b).abs() <= 5.0 * deviation + 1e-12, "{label}: {a} {b}");
        }
        // The numbers of exact zeros agree.
        let zeros =
            |rows: &[Vec<f64>]| column(rows, index).iter().filter(|v| **v == 0.0).count() as f64;
        assert!(
            (zeros(&ours) - zeros(&theirs)).abs() < 5.0 * 71.0,
            "{label}"
        );
        // Correlations have a deviation of at most 1/√n each.
        for other in 0..index {
            let [a, b] = [&ours, &theirs]
                .map(|rows| correlation(&column(rows, index), &column(rows, other)));
            assert!(
                (a - b).abs() < 5.0 * (2.0_f64 / 10_000.0).sqrt(),
                "{label} {other}: {a} {b}"
            );
        }
    }
}

#[test]
fn uncorrelated_models_fly_within_their_limits() {
    for name in ["uncor_1200code_v2p1", "uncor_1200only_fwse_v1p2"] {
        let Some(path) = data(&format!("encounter-models/{name}.txt")) else {
            return;
        };
        let model = encounter_model::read(&path).unwrap();
        assert_eq!(model.variables().len(), 7);
        let mut random = uniform(7);
        let mut turned = 0;
        for _ in 0..200 {
            let rows = model.fly(60, &mut random).unwrap();
            assert_eq!(rows.len(), 61);
            for pair in rows.windows(2) {
                let speed_kn = pair[0].velocity_mps.length() / (1852.0 / 3600.0);
                assert!((0.0..300.0001).contains(&speed_kn), "{speed_kn}");
                // At most 2000 ft/min, and steps as long as the speed says.
                assert!(pair[0].velocity_mps.z.abs() <= 2000.0 * 0.00508 + 1e-9);
                let step = pair[1].position_m - pair[0].position_m;
                assert!(
                    (step.length() - pair[0].velocity_mps.length()).abs()
                        < 0.01 * step.length() + 1e-9
                );
            }
            let (first, last) = (rows[0].velocity_mps, rows[60].velocity_mps);
            turned += u32::from(first.truncate().perp_dot(last.truncate()).abs() > 1e-9);
        }
        assert!(turned > 20, "{turned}");
    }
}

/// A variable `a` of two bins, counted 1 : 3, on which the rate `r` depends. The rate of the next
/// second keeps its bin in 9 of 10 cases; the third bin has no counts.
pub(crate) const SMALL: &str = "# labels_initial\n\"a\", \"r\"\n# G_initial\n0 1\n0 0\n# r_initial\n2 3\n\
    # N_initial\n1 3 1 0 0 0 2 2\n\
    # labels_transition\n\"a\", \"r(t)\", \"r(t+1)\"\n# G_transition\n0 0 0\n0 0 1\n0 0 0\n# r_transition\n2 3 3\n\
    # N_transition\n9 1 0 1 9 0 0 0 0\n# boundaries\n*\n-3 -1 1 3\n# resample_rates\n0 0.25\n";

fn small() -> EncounterModel {
    encounter_model::parse(SMALL, Path::new("m.txt")).unwrap()
}

#[test]
fn a_small_model_is_as_worked_out_by_hand() {
    let model = small();
    let mut random = uniform(3);
    let [mut second, mut zero, mut wrong] = [0; 3];
    let [mut changes, mut redrawn, mut held, mut steps] = [0.0_f64; 4];
    for _ in 0..20_000 {
        let mut state = model.start(&mut random);
        let [a, r] = [0, 1].map(|i| state.values()[i]);
        second += u32::from(a == 2.0);
        // With a = 1 the rate is in its first bin; with a = 2 it is 0 or in the last one, half
        // and half.
        wrong += u32::from((a == 1.0) != (r < 0.0));
        zero += u32::from(a == 2.0 && r == 0.0);
        let before = (state.bins()[1], r);
        model.step(&mut state, &mut random);
        let after = (state.bins()[1], state.values()[1]);
        if before.0 == 2 {
            // No counts: the bin stays.
            assert_eq!(after.0, 2);
        } else if before.0 == 0 {
            steps += 1.0;
            changes += f64::from(u8::from(after.0 != 0));
            held += f64::from(u8::from(after.0 == 0));
            redrawn += f64::from(u8::from(after.0 == 0 && after.1 != before.1));
        }
    }
    // Within five standard deviations.
    let near =
        |found: f64, of: f64, p: f64| (found - of * p).abs() < 5.0 * (of * p * (1.0 - p)).sqrt();
    assert_eq!(wrong, 0);
    assert!(near(f64::from(second), 20_000.0, 0.75), "{second}");
    assert!(near(f64::from(zero), f64::from(second), 0.5), "{zero}");
    assert!(near(changes, steps, 0.1), "{changes} {steps}");
    assert!(near(redrawn, held, 0.25), "{redrawn} {held}");
}

#[test]
fn wrong_files_are_refused_with_file_line_and_reason() {
    for (from, to, message) in [
        (
            "# r_initial",
            "# q_initial",
            "m.txt: section r_initial is missing, expected it",
        ),
        (
            "1 3 1 0 0 0 2 2",
            "1 3 1 0 0 0 2",
            "m.txt, line 8: section N_initial has 7 numbers, expected 8",
        ),
        (
            "1 3 1 0 0 0 2 2",
            "1 3 1 0 0 -1 2 2",
            "m.txt, line 8: section N_initial holds \"-1\", expected a number from 0",
        ),
        (
            "1 3 1 0 0 0 2 2",
            "1 3 1 0 0 NaN 2 2",
            "m.txt, line 8: section N_initial holds \"NaN\", expected a number from 0",
        ),
        (
            "1 3 1 0 0 0 2 2",
            "0 0 1 0 0 0 2 2",
            "m.txt, line 8: section N_initial has counts of \"a\" whose sum is 0, expected a positive one",
        ),
        (
            "1 3 1 0 0 0 2 2",
            "1e308 1e308 1 0 0 0 2 2",
            "m.txt, line 8: section N_initial has counts of \"a\" whose sum is inf, expected a positive one",
        ),
        (
            "# boundaries",
            "# r_initial\n2 3\n# boundaries",
            "m.txt, line 20: section \"r_initial\" is on line 6 already, expected it once",
        ),
        (
            "# resample_rates\n0 0.25",
            "# resample_rates\n0 2.5",
            "m.txt, line 23: section resample_rates holds 2.5, expected chances from 0 to 1",
        ),
        (
            "0 1\n0 0\n",
            "0 1\n1 0\n",
            "m.txt, line 8: section N_initial has 8 numbers, expected 12",
        ),
        (
            "2 3\n# N",
            "2.5 3\n# N",
            "m.txt, line 6: section r_initial holds 2.5, expected 1 to 1000 bins",
        ),
        (
            "-3 -1 1 3",
            "-3 1 -1 3",
            "m.txt, line 20: section boundaries holds \"-3 1 -1 3\", expected * or 4 growing numbers",
        ),
        (
            "*\n-3",
            "-3",
            "m.txt, line 20: section boundaries has 1 lines, expected 2, one a variable",
        ),
        (
            "r(t+1)",
            "s(t+1)",
            "m.txt, line 10: section labels_transition has \"s(t+1)\", expected an initial variable with (t+1)",
        ),
        (
            "0 0 1\n",
            "0 0 x\n",
            "m.txt, line 12: section G_transition holds \"x\", expected a number from 0",
        ),
    ] {
        assert!(SMALL.contains(from), "{from}");
        let error = encounter_model::parse(&SMALL.replacen(from, to, 1), Path::new("m.txt"))
            .unwrap_err()
            .to_string();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    let circle = SMALL
        .replacen("0 0\n# r", "1 0\n# r", 1)
        .replace("1 3 1 0 0 0 2 2", "1 1 1 1 1 1 1 1 1 1 1 1");
    let error = encounter_model::parse(&circle, Path::new("m.txt"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("section G_initial has variables that depend on each other in a circle"),
        "{error}"
    );
}

proptest! {
    #[test]
    fn any_change_of_a_file_is_read_or_refused(at in 0..SMALL.len(), with in "[-0-9 #*\n.a\"]{0,3}") {
        let mut text = SMALL.to_owned();
        text.replace_range(at..=at, &with);
        if let Ok(model) = encounter_model::parse(&text, Path::new("m.txt")) {
            let mut random = uniform(5);
            let mut state = model.start(&mut random);
            for _ in 0..10 {
                model.step(&mut state, &mut random);
                prop_assert!(state.values().iter().all(|value| value.is_finite()));
            }
        }
    }
}

/// The counts of a network as its file has them: bins, parents, counts of each variable.
struct Tables {
    bins: Vec<usize>,
    parents: Vec<Vec<usize>>,
    counts: Vec<Vec<f64>>,
}

/// Reads the transition network with separate code; the present variables have no counts.
fn transition_counts(text: &str, now: usize) -> Tables {
    let section = |name: &str| -> Vec<&str> {
        let from = text.find(&format!("# {name}")).unwrap();
        text[from..]
            .lines()
            .skip(1)
            .take_while(|line| !line.starts_with('#'))
            .flat_map(str::split_whitespace)
            .collect()
    };
    let numbers =
        |name: &str| -> Vec<f64> { section(name).iter().map(|n| n.parse().unwrap()).collect() };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small"
    )]
    let bins: Vec<usize> = numbers("r_transition")
        .iter()
        .map(|n| *n as usize)
        .collect();
    let (graph, mut all) = (numbers("G_transition"), numbers("N_transition").into_iter());
    let count = bins.len();
    let parents: Vec<Vec<usize>> = (0..count)
        .map(|child| {
            (0..count)
                .filter(|p| graph[p * count + child] > 0.0)
                .collect()
        })
        .collect();
    let counts = (0..count)
        .map(|child| {
            let cases: usize = parents[child].iter().map(|p| bins[*p]).product();
            let size = if child < now { 0 } else { bins[child] * cases };
            all.by_ref().take(size).collect()
        })
        .collect();
    assert_eq!(all.next(), None);
    Tables {
        bins,
        parents,
        counts,
    }
}

/// χ² of drawn transitions against a model's own tables.
#[test]
fn transitions_are_distributed_like_the_tables_of_the_model() {
    let small =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../fga-campaign/tests/models/uncorrelated.txt");
    let others = ["uncor_1200code_v2p1", "cor_v1"]
        .iter()
        .filter_map(|name| data(&format!("encounter-models/{name}.txt")));
    for path in core::iter::once(small).chain(others) {
        let text = std::fs::read_to_string(&path).unwrap();
        let model = encounter_model::read(&path).unwrap();
        let now = model.variables().len();
        let tables = transition_counts(&text, now);
        let later: Vec<usize> = (now..tables.bins.len()).collect();
        // Each later variable becomes the parent-free present one with the same label.
        let labels: Vec<String> = text
            .lines()
            .skip_while(|line| !line.starts_with("# labels_transition"))
            .nth(1)
            .unwrap()
            .split(',')
            .map(|label| label.trim().trim_matches('"').to_owned())
            .collect();
        let becomes = |variable: usize| {
            let base = labels[variable].strip_suffix("(t+1)").unwrap();
            let this = format!("{base}(t)");
            labels.iter().position(|l| *l == this || l == base).unwrap()
        };
        let mut found: Vec<Vec<f64>> = tables.counts.iter().map(|c| vec![0.0; c.len()]).collect();
        let mut random = uniform(11);
        for _ in 0..3_000 {
            let mut state = model.start(&mut random);
            for _ in 0..20 {
                let mut bins = state.bins().to_vec();
                model.step(&mut state, &mut random);
                bins.extend(later.iter().map(|v| state.bins()[becomes(*v)]));
                for &variable in &later {
                    let (mut case, mut stride) = (0, 1);
                    for &parent in &tables.parents[variable] {
                        case += bins[parent] * stride;
                        stride *= tables.bins[parent];
                    }
                    found[variable][case * tables.bins[variable] + bins[variable]] += 1.0;
                }
            }
        }
        for &variable in &later {
            let bins = tables.bins[variable];
            if bins == 1 {
                continue;
            }
            let (mut chi2, mut freedom) = (0.0, 0.0);
            for (expected, found) in tables.counts[variable]
                .chunks(bins)
                .zip(found[variable].chunks(bins))
            {
                let (of, all): (f64, f64) = (expected.iter().sum(), found.iter().sum());
                if of <= 0.0 || all < 30.0 {
                    continue;
                }
                let mut kept = 0.0;
                for (expected, found) in expected.iter().zip(found) {
                    let expected = expected / of * all;
                    assert!(
                        expected > 0.0 || *found == 0.0,
                        "{variable}: never counted, yet drawn"
                    );
                    if expected >= 5.0 {
                        chi2 += (found - expected).powi(2) / expected;
                        kept += 1.0;
                    }
                }
                freedom += (kept - 1.0_f64).max(0.0);
            }
            assert!(freedom > 3.0, "{variable}: {freedom}");
            assert!(
                (chi2 - freedom).abs() < 5.0 * (2.0 * freedom).sqrt() + 5.0,
                "{}: variable {variable}: χ² {chi2} of {freedom}",
                path.display()
            );
        }
    }
}

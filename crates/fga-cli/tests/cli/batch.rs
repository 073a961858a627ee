//! `fga batch` on generated encounters: the same bytes on any number of threads, and margins that
//! anybody can recompute from the tracks.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::support::{columns, encounters, errors, fga_in};

type Rows = HashMap<u64, Vec<Vec<f64>>>;

/// The rows of a file by their first column.
fn by_encounter(path: &Path) -> Rows {
    let mut rows = Rows::new();
    for line in fs::read_to_string(path).unwrap().lines().skip(1) {
        let fields: Vec<f64> = line
            .split(',')
            .map(|f| f.parse().unwrap_or(f64::NAN))
            .collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an unsigned identifier"
        )]
        rows.entry(fields[0] as u64)
            .or_default()
            .push(fields[1..].to_vec());
    }
    rows
}

/// Least distance of two points with straight motions over one interval, from their offsets at
/// its ends.
fn least_distance(from: [f64; 3], to: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    let square = dot(along, along);
    let share = if square > 0.0 {
        (-dot(from, along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let at = [0, 1, 2].map(|k| from[k] + share * along[k]);
    dot(at, at).sqrt()
}

/// The least margin of an encounter from its track rows and obstacle rows.
fn recomputed(track: &[Vec<f64>], obstacles: &[Vec<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    for obstacle in obstacles {
        let offset = |row: &[f64]| {
            [0, 1, 2].map(|k| row[1 + k] - obstacle[1 + k] - obstacle[4 + k] * row[0])
        };
        for pair in track.windows(2) {
            least = least.min(least_distance(offset(&pair[0]), offset(&pair[1])) - obstacle[7]);
        }
        least = least.min(least_distance(offset(&track[0]), offset(&track[0])) - obstacle[7]);
    }
    least
}

/// Number of encounters in this test; more by `FGA_ENCOUNTERS`.
fn count() -> u32 {
    std::env::var("FGA_ENCOUNTERS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(300)
}

#[test]
fn the_same_bytes_on_one_and_two_threads_and_margins_that_follow_from_the_tracks() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("e.csv"), encounters(count(), 7)).unwrap();
    for (out, threads) in [("one", "1"), ("two", "2")] {
        let output = fga_in(
            folder.path(),
            &[
                "batch",
                "e.csv",
                "--out",
                out,
                "--threads",
                threads,
                "--tracks",
            ],
        );
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    }
    let read = |out: &str, name: &str| fs::read(folder.path().join(out).join(name)).unwrap();
    for name in ["results.csv", "tracks.csv"] {
        assert!(read("one", name) == read("two", name), "{name} differs");
    }

    let tracks = by_encounter(&folder.path().join("one/tracks.csv"));
    let input = by_encounter(&folder.path().join("e.csv"));
    let results = columns(&folder.path().join("one/results.csv"));
    assert_eq!(results["encounter"].len(), count() as usize);
    let mut largest_difference = 0.0_f64;
    for (index, number) in results["encounter"].iter().enumerate() {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an unsigned identifier"
        )]
        let number = *number as u64;
        let (track, obstacles) = (&tracks[&number], &input[&number]);
        let margin = results["min_margin_m"][index];
        largest_difference = largest_difference.max((recomputed(track, obstacles) - margin).abs());
        assert_eq!(results["separated"][index] == 1.0, margin >= 0.0);
        assert_eq!(track[0][0], 0.0);
        for pair in track.windows(2) {
            let step_s = pair[1][0] - pair[0][0];
            assert!(step_s > 0.0 && step_s <= 0.1 + 1e-9, "{step_s}");
            // Chord against the mean of the angles at its ends (Eq. 10–12).
            let chord = [1, 2, 3].map(|k| pair[1][k] - pair[0][k]);
            let turned = (pair[1][4] - pair[0][4] + core::f64::consts::PI)
                .rem_euclid(core::f64::consts::TAU)
                - core::f64::consts::PI;
            let course = pair[0][4] + 0.5 * turned;
            let across = chord[1] * course.cos() - chord[0] * course.sin();
            let length = (chord[0] * chord[0] + chord[1] * chord[1] + chord[2] * chord[2]).sqrt();
            if step_s > 0.05 {
                assert!((across / length).abs() < 0.002, "course off its chord");
                let climb = (chord[2] / length).asin();
                assert!((climb - 0.5 * (pair[0][5] + pair[1][5])).abs() < 0.002 + 0.01 * step_s);
                assert!((length / step_s - 15.0).abs() < 0.01, "{}", length / step_s);
            }
        }
    }
    eprintln!("largest difference of margins: {largest_difference:.4} m");
    assert!(largest_difference < 0.1, "{largest_difference}");
}

#[test]
fn without_a_policy_margins_are_those_of_straight_lines() {
    let folder = tempfile::tempdir().unwrap();
    let text = encounters(200, 3);
    fs::write(folder.path().join("e.csv"), &text).unwrap();
    let output = fga_in(
        folder.path(),
        &[
            "batch",
            "e.csv",
            "--policy",
            "none",
            "--out",
            "o",
            "--horizon",
            "45",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let input = by_encounter(&folder.path().join("e.csv"));
    let results = columns(&folder.path().join("o/results.csv"));
    for (index, number) in results["encounter"].iter().enumerate() {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an unsigned identifier"
        )]
        let obstacles = &input[&(*number as u64)];
        let ends = [vec![0.0; 4], vec![45.0, 675.0, 0.0, 0.0]];
        let margin = recomputed(&ends, obstacles);
        assert!((margin - results["min_margin_m"][index]).abs() < 1e-5);
        assert!(results["start_s"][index].is_nan() && results["clear_s"][index].is_nan());
        assert_eq!(results["max_cross_track_m"][index], 0.0);
        assert!(results["extra_path_m"][index].abs() < 1e-5);
    }
}

#[test]
fn wrong_input_is_one_sentence_and_leaves_nothing() {
    let header = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n";
    let folder = tempfile::tempdir().unwrap();
    for (text, expected) in [
        (header.to_string(), "e.csv"),
        (String::new(), "e.csv"),
        (
            header.replace("vz_mps,", "") + "0,0,1,1,1,0,0,3\n",
            "vz_mps",
        ),
        (format!("{header}0,0,1,1,1,0,0,0,-3\n"), "line 2"),
        (
            format!("{header}0,0,1,1,1,0,0,0,3\n0,0,9,9,9,0,0,0,3\n"),
            "line 3",
        ),
        (format!("{header}0,0,1,x,1,0,0,0,3\n"), "line 2"),
        (format!("{header}0,0,1,nan,1,0,0,0,3\n"), "line 2"),
        (format!("{header}-1,0,1,1,1,0,0,0,3\n"), "line 2"),
    ] {
        fs::write(folder.path().join("e.csv"), &text).unwrap();
        let output = fga_in(folder.path(), &["batch", "e.csv", "--out", "o"]);
        let message = errors(&output);
        assert_eq!(output.status.code(), Some(1), "{text}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(
            message.contains("e.csv") && message.contains(expected),
            "{message}"
        );
        assert!(!folder.path().join("o").exists(), "{message}");
    }
}

//! Keeps a page small: selects samples, records and points.

use super::{ReplayDecision, ReplayGround, ReplayPiece, ReplaySample};

/// Most samples of all runs of a page together.
const MAX_SAMPLES: usize = 24_000;
/// Most bytes of the records of one page, roughly.
const MAX_RECORD_BYTES: usize = 1_000_000;
/// Most posts of the ground a side.
const MAX_POSTS: usize = 256;
/// A path may lose points where it bends less than this, metres.
const PATH_TOLERANCE_M: f64 = 0.25;

/// The samples to write: every `stride`-th one, the last, and both sides of each change of state.
pub(super) fn samples(samples: &[ReplaySample], runs: usize) -> Vec<&ReplaySample> {
    let stride = samples
        .len()
        .div_ceil((MAX_SAMPLES / runs.max(1)).max(2))
        .max(1);
    let state = |i: usize| samples.get(i).map(|s| s.state);
    samples
        .iter()
        .enumerate()
        .filter(|&(i, sample)| {
            i % stride == 0
                || i + 1 == samples.len()
                || state(i.wrapping_sub(1)) != Some(sample.state)
                || state(i + 1) != Some(sample.state)
        })
        .map(|(_, sample)| sample)
        .collect()
}

/// The ground to write. A grid that is too large loses posts: every second, third, … post of a row and every such row stay. A post that
/// stays is as high as the highest post near it, and unknown where one of these is.
pub(super) fn ground(ground: &ReplayGround) -> ReplayGround {
    let columns = ground.columns.max(1);
    let rows = ground.heights_m.len() / columns;
    let every = (columns.max(rows).saturating_sub(1))
        .div_ceil(MAX_POSTS - 1)
        .max(1);
    let places = |count: usize| (0..=count.saturating_sub(1).div_ceil(every)).map(|k| k * every);
    let near = |place: usize, count: usize| {
        let place = place.min(count - 1);
        place.saturating_sub(every / 2)..(place + every / 2 + 1).min(count)
    };
    let highest_m = |row: usize, column: usize| {
        let columns_near = near(column, columns);
        let posts = near(row, rows).flat_map(|row| {
            let posts = columns_near.clone();
            posts.map(move |column| ground.heights_m[row * columns + column])
        });
        // `f32::max` would pass over what is unknown.
        posts.fold(f32::NEG_INFINITY, |most_m, post_m| {
            let is_known = !most_m.is_nan() && !post_m.is_nan();
            if is_known {
                most_m.max(post_m)
            } else {
                f32::NAN
            }
        })
    };
    let heights_m = places(rows).flat_map(|row| places(columns).map(move |column| (row, column)));
    #[expect(clippy::cast_precision_loss, reason = "a few posts")]
    let spacing_m = ground.spacing_m.map(|spacing_m| spacing_m * every as f64);
    ReplayGround {
        corner_m: ground.corner_m,
        spacing_m,
        columns: places(columns).count(),
        heights_m: heights_m
            .map(|(row, column)| highest_m(row, column))
            .collect(),
    }
}

/// The records to write: none that only repeats the previous one and, if all exceed the size limit
/// of the page, only as many per second as fit. The second value is the interval between kept
/// records, seconds; 0 if none is missing.
pub(super) fn decisions(decisions: &[ReplayDecision], runs: usize) -> (Vec<&ReplayDecision>, f64) {
    let mut distinct: Vec<&ReplayDecision> = Vec::new();
    for decision in decisions {
        if distinct.last().is_none_or(|last| differs(last, decision)) {
            distinct.push(decision);
        }
    }
    let costs: Vec<usize> = distinct.iter().map(|d| cost_bytes(d)).collect();
    let budget = MAX_RECORD_BYTES / runs.max(1);
    let mut interval_s = 0.0;
    let mut kept: Vec<usize> = (0..distinct.len()).collect();
    while interval_s < 100.0 && kept.iter().map(|&i| costs[i]).sum::<usize>() > budget {
        interval_s = if interval_s == 0.0 {
            0.2
        } else {
            2.0 * interval_s
        };
        kept.clear();
        for (i, decision) in distinct.iter().enumerate() {
            let worth = kept.last().is_none_or(|&last| {
                let last = distinct[last];
                last.state != decision.state
                    || last.threat != decision.threat
                    || decision.t_s - last.t_s >= interval_s - 1e-6
            });
            if worth {
                kept.push(i);
            }
        }
    }
    let kept = kept.into_iter().map(|i| distinct[i]).collect();
    (kept, interval_s)
}

fn differs(a: &ReplayDecision, b: &ReplayDecision) -> bool {
    a.state != b.state
        || a.lines != b.lines
        || a.threat != b.threat
        || a.latest_start_s != b.latest_start_s
        || a.paths != b.paths
        || a.p_loss != b.p_loss
        || !b.futures.is_empty()
}

/// Approximate size of a record in the page: text, and six bytes a point in base64.
fn cost_bytes(decision: &ReplayDecision) -> usize {
    let text: usize = decision.lines.iter().map(|line| line.len() + 3).sum();
    let ways = decision.futures.iter().flat_map(|one| &one.ways);
    let paths: usize = (decision.paths.iter().map(|path| &path.points_m))
        .chain(ways.map(|(_, points_m)| points_m))
        .map(|points_m| 16 + 8 * polyline(points_m).len())
        .sum();
    60 + text + paths
}

/// The points of a polyline that carry its shape (Ramer–Douglas–Peucker), without points that are
/// not finite.
pub(super) fn polyline(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let points: Vec<[f64; 3]> = points
        .iter()
        .copied()
        .filter(|point| point.iter().all(|c| c.is_finite()))
        .collect();
    let Some(last) = points.len().checked_sub(1) else {
        return points;
    };
    let mut keep = vec![false; points.len()];
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        keep[from] = true;
        keep[to] = true;
        let farthest = (from + 1..to)
            .map(|i| (i, off_chord_m(points[i], points[from], points[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, distance_m)) = farthest
            && distance_m > PATH_TOLERANCE_M
        {
            open.push((from, i));
            open.push((i, to));
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}

/// Distance of a point from the segment between two others, metres.
fn off_chord_m(point: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    let point = fga::Vec3::from_array(point);
    let from = fga::Vec3::from_array(from);
    let chord = fga::Vec3::from_array(to) - from;
    let along = (point - from).dot(chord) / chord.length_squared().max(1e-12);
    point.distance(from + chord * along.clamp(0.0, 1.0))
}

/// The pieces of a motion without those that only continue the previous one.
pub(super) fn motion(pieces: &[ReplayPiece]) -> Vec<ReplayPiece> {
    let mut kept: Vec<ReplayPiece> = Vec::new();
    for piece in pieces {
        if kept.last().is_none_or(|last| !continues(last, piece)) {
            kept.push(*piece);
        }
    }
    kept
}

fn continues(last: &ReplayPiece, next: &ReplayPiece) -> bool {
    let after_s = next.start_s - last.start_s;
    (0..3).all(|axis| {
        let expected_m = last.position_m[axis] + last.velocity_mps[axis] * after_s;
        (expected_m - next.position_m[axis]).abs() < 1e-3
            && (last.velocity_mps[axis] - next.velocity_mps[axis]).abs() < 1e-6
    })
}

#[cfg(test)]
mod tests {
    use super::super::ReplayState;
    use super::*;

    #[test]
    fn a_straight_line_keeps_its_ends_and_a_corner_stays() {
        let line: Vec<[f64; 3]> = (0..100).map(|i| [f64::from(i), 0.0, 5.0]).collect();
        assert_eq!(polyline(&line), [[0.0, 0.0, 5.0], [99.0, 0.0, 5.0]]);
        let corner = [[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [50.0, 50.0, 0.0]];
        assert_eq!(polyline(&corner), corner);
        assert!(polyline(&[[f64::NAN, 0.0, 0.0]]).is_empty());
    }

    #[test]
    fn many_samples_are_thinned_but_not_where_the_state_changes() {
        let sample = |i: u32| ReplaySample {
            t_s: f64::from(i) * 0.01,
            state: if i == 50_001 {
                ReplayState::Avoiding
            } else {
                ReplayState::Cruise
            },
            ..ReplaySample::default()
        };
        let all: Vec<ReplaySample> = (0..100_000).map(sample).collect();
        let kept = samples(&all, 2);
        assert!(kept.len() <= 12_010, "{}", kept.len());
        assert_eq!(kept.last().map(|s| s.t_s), Some(999.99));
        assert!(kept.iter().any(|s| s.state == ReplayState::Avoiding));
    }

    #[test]
    fn a_record_that_repeats_is_dropped_and_a_flood_is_thinned() {
        let record = |i: u32, text: String| ReplayDecision {
            t_s: f64::from(i) * 0.1,
            lines: vec![text],
            threat: Some(i / 30_000),
            ..ReplayDecision::default()
        };
        let calm: Vec<_> = (0..100).map(|i| record(i, "clear".into())).collect();
        assert_eq!(decisions(&calm, 1).0.len(), 1);
        let flood: Vec<_> = (0..60_000)
            .map(|i| record(i, format!("{i} {}", "x".repeat(100))))
            .collect();
        let (kept, interval_s) = decisions(&flood, 1);
        assert!(kept.len() < 7_000 && interval_s >= 0.5, "{}", kept.len());
        assert!(kept.iter().any(|d| d.t_s == 3_000.0), "the threat changes");
    }

    #[test]
    fn pieces_that_continue_are_one() {
        let piece = |start_s: f64, x: f64, v: f64| ReplayPiece {
            start_s,
            position_m: [x, 0.0, 0.0],
            velocity_mps: [v, 0.0, 0.0],
        };
        let kept = motion(&[
            piece(0.0, 0.0, 5.0),
            piece(1.0, 5.0, 5.0),
            piece(2.0, 10.0, 4.0),
        ]);
        assert_eq!(kept, [piece(0.0, 0.0, 5.0), piece(2.0, 10.0, 4.0)]);
    }
}

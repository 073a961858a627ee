//! Builds a path over sub-waypoints: one at a time, or the shortest of all.

use alloc::collections::BTreeSet;

use fga::Vec3;

use super::Cube;
use crate::baselines::View;

/// Most sub-waypoints of a greedy path.
const MOST_GREEDY: usize = 8;

/// Takes the best clear candidate, again and again, until the way to the goal is clear.
pub(super) fn greedy(cube: &Cube, view: &View<'_>, candidates: &[Vec3]) -> Vec<Vec3> {
    let goal = cube.goal_m(view);
    let mut points: Vec<Vec3> = Vec::new();
    let mut from = Vec3::ZERO;
    let mut flown_m = 0.0;
    while points.len() < MOST_GREEDY {
        let start_s = flown_m / view.speed_mps();
        if cube.clearance_m(view, from, goal, start_s) >= 0.0 {
            break;
        }
        // The shortest way over a clear point; without one, the clearest.
        let mut best: Option<(f64, Vec3)> = None;
        for offset in candidates {
            let to = from + *offset;
            let clearance = cube.clearance_m(view, from, to, start_s);
            let cost = if clearance >= 0.0 {
                offset.length() + goal.distance(to)
            } else {
                1e6 - clearance
            };
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, to));
            }
        }
        let Some((_, to)) = best else { break };
        flown_m += from.distance(to);
        from = to;
        points.push(to);
    }
    points.push(goal);
    points
}

/// A sub-waypoint in the search.
struct SearchNode {
    at_m: Vec3,
    flown_m: f64,
    from: usize,
}

/// Best-first search over the candidates, extending at most `most` sub-waypoints.
pub(super) fn shortest(
    cube: &Cube,
    view: &View<'_>,
    candidates: &[Vec3],
    most: usize,
) -> Vec<Vec3> {
    let goal = cube.goal_m(view);
    let mut nodes = vec![SearchNode {
        at_m: Vec3::ZERO,
        flown_m: 0.0,
        from: 0,
    }];
    // Ordered by estimate: the bits of numbers that are not negative order as the numbers do.
    let mut open: BTreeSet<(u64, usize)> = BTreeSet::from([(goal.length().to_bits(), 0)]);
    let mut seen: BTreeSet<[i64; 3]> = BTreeSet::new();
    let mut clearest: Option<(f64, Vec3)> = None;
    let mut extended = 0;
    while let Some((_, index)) = open.pop_first() {
        let (at_m, flown_m) = (nodes[index].at_m, nodes[index].flown_m);
        let start_s = flown_m / view.speed_mps();
        if cube.clearance_m(view, at_m, goal, start_s) >= 0.0 {
            return path_to(&nodes, index, goal);
        }
        extended += 1;
        if extended > most {
            break;
        }
        for offset in candidates {
            let to = at_m + *offset;
            let clearance = cube.clearance_m(view, at_m, to, start_s);
            if clearance < 0.0 {
                if index == 0 && clearest.is_none_or(|(most_clear, _)| clearance > most_clear) {
                    clearest = Some((clearance, to));
                }
                continue;
            }
            if !seen.insert(cell(to)) {
                continue;
            }
            let flown_m = flown_m + offset.length();
            open.insert(((flown_m + goal.distance(to)).to_bits(), nodes.len()));
            nodes.push(SearchNode {
                at_m: to,
                flown_m,
                from: index,
            });
        }
    }
    // No clear path: the most promising one found, else the clearest leg.
    let left = |node: &SearchNode| node.flown_m + goal.distance(node.at_m);
    let promising = (1..nodes.len()).min_by(|a, b| left(&nodes[*a]).total_cmp(&left(&nodes[*b])));
    match (promising, clearest) {
        (Some(index), _) => path_to(&nodes, index, goal),
        (None, Some((_, to))) => vec![to, goal],
        (None, None) => vec![goal],
    }
}

/// A cell of a metre: two ways to the same sub-waypoint count as one.
fn cell(point: Vec3) -> [i64; 3] {
    #[expect(clippy::cast_possible_truncation, reason = "some kilometres at most")]
    let whole = |value: f64| libm::round(value) as i64;
    [whole(point.x), whole(point.y), whole(point.z)]
}

fn path_to(nodes: &[SearchNode], mut index: usize, goal: Vec3) -> Vec<Vec3> {
    let mut points = vec![goal];
    while index != 0 {
        points.push(nodes[index].at_m);
        index = nodes[index].from;
    }
    points.reverse();
    points
}

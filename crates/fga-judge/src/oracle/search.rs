//! The exhaustive part: a tree over wait × first turn × straight × second turn with shared
//! prefixes, on chords of the ideal vehicle's path, cut off where the running minimum falls
//! below the best found. Its best leaves, one of each kind, are the seeds of the exact
//! refinement.

use fga_proof::Vec3;

use super::airspace::OracleAirspace;
use super::arc::{ArcNode, TurnArc};
use super::ascent::OracleAscent;
use super::flight::OracleFlight;
use super::grid::OracleGrid;
use super::separation::{OracleBody, OracleScene, least_margin};
use super::tree::{Here, Tree};
use super::{
    OracleAnswer, OracleManeuver, OracleObstacle, OracleSettings, OracleStart, OracleTrack,
    OracleVehicle, Stages,
};

/// The largest margin to all obstacles that any manoeuvre of the family keeps over the horizon.
///
/// Accurate to about a centimetre near zero. Cost with three obstacles: a tenth of a millisecond where
/// one turn gives `enough_m`, a millisecond where one turn gives ten metres, ten
/// to a hundred for a search over two turns.
pub fn best_margin(
    start: &OracleStart,
    vehicle: &OracleVehicle,
    obstacles: &[OracleObstacle],
    settings: &OracleSettings,
) -> OracleAnswer {
    best_margin_within(start, vehicle, obstacles, None, settings)
}

/// The same over ground, among zones and within altitude limits: the largest least of all these margins.
///
/// A search over two turns takes seconds where all turns end in the ground.
pub fn best_margin_within(
    start: &OracleStart,
    vehicle: &OracleVehicle,
    obstacles: &[OracleObstacle],
    airspace: Option<OracleAirspace>,
    settings: &OracleSettings,
) -> OracleAnswer {
    let bodies = obstacles.iter().map(OracleBody::new);
    search_within((start, vehicle), bodies, airspace, settings)
}

/// The same as [`best_margin_within`] among aircraft on known tracks.
///
/// The oracle knows how they will fly, which no policy does: an avoidable encounter is one that hindsight
/// saves, and a lost one is lost for every policy.
pub fn best_margin_on_tracks(
    start: &OracleStart,
    vehicle: &OracleVehicle,
    tracks: &[OracleTrack],
    airspace: Option<OracleAirspace>,
    settings: &OracleSettings,
) -> OracleAnswer {
    let bodies = tracks.iter().map(OracleBody::on_track);
    search_within((start, vehicle), bodies, airspace, settings)
}

/// Searches among bodies, within an airspace.
fn search_within(
    (start, vehicle): (&OracleStart, &OracleVehicle),
    bodies: impl Iterator<Item = OracleBody>,
    airspace: Option<OracleAirspace>,
    settings: &OracleSettings,
) -> OracleAnswer {
    let bounds = airspace.map(|airspace| OracleBody::bounds(airspace, start.position_m));
    let bodies: Vec<OracleBody> = bodies.chain(bounds).collect();
    search(start, vehicle, &bodies, settings)
}

impl OracleScene<'_> {
    /// The points at which the first turn can begin.
    fn after_wait(&self, wait_s: f64) -> Here {
        let (sin, cos) = libm::sincos(self.start.course_rad);
        let (sin_climb, cos_climb) = libm::sincos(self.start.climb_rad);
        // The vehicle's response delays a manoeuvre.
        let lead_s = self.vehicle.dead_time_s + self.vehicle.bank_time_constant_s;
        let begin_s = (wait_s + lead_s).min(self.horizon_s);
        let velocity =
            Vec3::new(cos_climb * cos, cos_climb * sin, sin_climb) * self.vehicle.airspeed_mps;
        let position = self.start.position_m + velocity * begin_s;
        let mut running = f64::INFINITY;
        for body in self.bodies {
            running = body.chord(0.0, self.start.position_m, begin_s, position, running);
        }
        Here {
            time_s: begin_s,
            position,
            cos,
            sin,
            running,
        }
    }

    /// The turns from a climb angle to each one of a grid.
    fn arcs(&self, from: f64, grid: &OracleGrid) -> Vec<TurnArc> {
        let climbs = grid.climbs.iter();
        let arc = |&to| TurnArc::new(self.vehicle, from, to, &grid.turns_rad);
        climbs.map(arc).collect()
    }

    /// The best leaves of a tree whose branches `visit` sees: a first turn with every wait, side, climb angle and angle.
    fn grown(
        &self,
        grid: &OracleGrid,
        kinds: usize,
        (best, enough): (f64, f64),
        mut visit: impl FnMut(&mut Tree<'_>, &OraclePrefix<'_>),
    ) -> Vec<(f64, OracleManeuver)> {
        let count = grid.climbs.len();
        let firsts = grid.waits_s.len() * 2 * count * 3;
        let mut tree = Tree {
            bodies: self.bodies,
            horizon_s: self.horizon_s,
            slack_m: grid.slack_m,
            best,
            enough,
            done: false,
            leaves: vec![(f64::NEG_INFINITY, OracleManeuver::default()); firsts * kinds],
        };
        let arcs = self.arcs(self.start.climb_rad, grid);
        for (w, &wait_s) in grid.waits_s.iter().enumerate() {
            let here = self.after_wait(wait_s);
            if here.running <= tree.threshold() {
                break;
            }
            for (c, arc) in arcs.iter().enumerate() {
                for (s, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let kind = ((w * 2 + s) * count + c) * 3;
                    tree.walk(arc, &here, sign, |tree, node, exit| {
                        let maneuver = OracleManeuver {
                            wait_s,
                            turn1_rad: sign * node.turned_rad,
                            climb1_rad: arc.target,
                            climb2_rad: arc.target,
                            ..OracleManeuver::default()
                        };
                        let prefix = OraclePrefix {
                            arc,
                            node,
                            exit,
                            maneuver,
                            kind: (kind + turn_bin(node.turned_rad)) * kinds,
                        };
                        visit(tree, &prefix);
                    });
                    if tree.done {
                        return tree.seeds(grid.seeds);
                    }
                }
            }
        }
        tree.seeds(grid.seeds)
    }

    /// One turn.
    fn one_turn(&self, best: f64, enough: f64) -> Vec<(f64, OracleManeuver)> {
        let grid = OracleGrid::one_turn(self.vehicle, self.horizon_s);
        self.grown(&grid, 1, (best, enough), |tree, prefix| {
            if let Some(margin) = tree.finish(prefix.arc, prefix.node, &prefix.exit) {
                tree.leaf(prefix.kind, margin, prefix.maneuver);
            }
        })
    }

    /// Two turns.
    fn two_turns(&self, grid: &OracleGrid, best: f64, enough: f64) -> Vec<(f64, OracleManeuver)> {
        let seconds = grid.climbs.iter().map(|&from| self.arcs(from, grid));
        let seconds: Vec<Vec<TurnArc>> = seconds.collect();
        let kinds = 2 * grid.climbs.len();
        self.grown(grid, kinds, (best, enough), |tree, prefix| {
            self.second_turn(tree, grid, &seconds, prefix);
        })
    }

    fn second_turn(
        &self,
        tree: &mut Tree<'_>,
        grid: &OracleGrid,
        arcs: &[Vec<TurnArc>],
        prefix: &OraclePrefix<'_>,
    ) {
        let exit = &prefix.exit;
        let (mut from_s, mut from, mut running) = (exit.time_s, exit.position, exit.running);
        for &straight_s in &grid.straights_s {
            let (along, up) = prefix.node.after(prefix.arc, straight_s);
            let place = exit.offset(along, 0.0, up);
            let place_s = exit.time_s + straight_s;
            running = tree.chord(from_s, from, place_s, place, running);
            if running <= tree.threshold() || place_s > self.horizon_s {
                return;
            }
            (from_s, from) = (place_s, place);
            let here = Here {
                time_s: place_s,
                position: place,
                running,
                ..*exit
            };
            // The present climb angle, rounded to the grid.
            let climb = prefix
                .node
                .climb_after(self.vehicle, prefix.arc.target, straight_s);
            let nearest = nearest(&grid.climbs, climb);
            let Some(arcs) = arcs.get(nearest) else {
                continue;
            };
            for (c, arc) in arcs.iter().enumerate() {
                for (s, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let kind = prefix.kind + s * grid.climbs.len() + c;
                    tree.walk(arc, &here, sign, |tree, node, exit| {
                        if let Some(margin) = tree.finish(arc, node, &exit) {
                            let maneuver = OracleManeuver {
                                straight_s,
                                turn2_rad: sign * node.turned_rad,
                                climb2_rad: arc.target,
                                ..prefix.maneuver
                            };
                            tree.leaf(kind, margin, maneuver);
                        }
                    });
                    if tree.done {
                        return;
                    }
                }
            }
        }
    }
}

/// A manoeuvre up to the end of its first turn.
struct OraclePrefix<'a> {
    arc: &'a TurnArc,
    node: &'a ArcNode,
    exit: Here,
    maneuver: OracleManeuver,
    kind: usize,
}

fn nearest(values: &[f64], to: f64) -> usize {
    let mut best = (0, f64::INFINITY);
    for (k, value) in values.iter().enumerate() {
        let off = (value - to).abs();
        if off < best.1 {
            best = (k, off);
        }
    }
    best.0
}

/// Small, large and more than half a turn are different kinds of manoeuvre.
fn turn_bin(turned_rad: f64) -> usize {
    if turned_rad < 1.0 {
        0
    } else if turned_rad < 2.8 {
        1
    } else {
        2
    }
}

/// A leaf of the tree must exceed enough by this before it stops the tree, metres: its chords cut the
/// corners.
const CHORD_ERROR_M: f64 = 0.5;

/// The fine tree runs only where the coarse one is within this of the limit, metres.
const DOUBTFUL_M: f64 = 5.0;

/// From this margin of single turns on no second turn is tried, metres: saved is saved.
const SETTLED_M: f64 = 10.0;

/// The largest lack of `enough_m` after single turns that a second turn may still add, metres; the
/// largest observed was 9.
const HOPELESS_M: f64 = 15.0;

/// A smaller gain does not count, metres.
const LIMIT_TOLERANCE_M: f64 = 0.01;

pub(super) fn hold_all_the_way(start: &OracleStart, horizon_s: f64) -> OracleManeuver {
    OracleManeuver {
        wait_s: horizon_s,
        climb1_rad: start.climb_rad,
        climb2_rad: start.climb_rad,
        ..OracleManeuver::default()
    }
}

pub(super) fn search(
    start: &OracleStart,
    vehicle: &OracleVehicle,
    bodies: &[OracleBody],
    settings: &OracleSettings,
) -> OracleAnswer {
    let nothing = hold_all_the_way(start, settings.horizon_s);
    let enough = settings.enough_m.unwrap_or(f64::INFINITY);
    let scene = OracleScene {
        start,
        vehicle,
        bodies,
        horizon_s: settings.horizon_s,
    };
    let mut ascent = OracleAscent::new(scene, enough);
    let do_nothing = ascent.look(&nothing);
    let stop = enough + CHORD_ERROR_M;
    let answer = |best: (f64, OracleManeuver)| OracleAnswer {
        best_margin_m: best.0,
        do_nothing_margin_m: do_nothing,
        maneuver: best.1,
    };
    if bodies.is_empty() || do_nothing >= enough {
        return answer(ascent.best);
    }
    let seeds = scene.one_turn(f64::NEG_INFINITY, stop);
    ascent.refine(&seeds, false);
    if ascent.best.0 >= enough || settings.stages == Stages::One {
        return answer(ascent.best);
    }
    // Where the flight is bounded, one turn alone often ends at a wall.
    let is_bounded = bodies.iter().any(OracleBody::is_bounds);
    if ascent.best.0 >= SETTLED_M
        || settings
            .enough_m
            .is_some_and(|enough| !is_bounded && ascent.best.0 < enough - HOPELESS_M)
        || at_its_limit(&scene, &ascent)
    {
        return answer(ascent.best);
    }
    let seeds = scene.two_turns(&OracleGrid::coarse(vehicle), ascent.best.0, stop);
    ascent.refine(&seeds, true);
    if ascent.best.0 < enough && ascent.best.0.abs() < DOUBTFUL_M {
        let seeds = scene.two_turns(&OracleGrid::fine(vehicle), ascent.best.0, stop);
        ascent.refine(&seeds, true);
    }
    answer(ascent.best)
}

/// Whether the obstacle that limits the best margin allows no more even when it is alone: then no
/// second turn, which only helps to get past several obstacles, is worth a try.
fn at_its_limit(scene: &OracleScene<'_>, found: &OracleAscent<'_>) -> bool {
    let (margin, maneuver) = found.best;
    let mut flight = OracleFlight::default();
    scene.fly(&maneuver, None, &mut flight);
    let Some(limiting) = scene.bodies.iter().find(|body| {
        least_margin(&flight, core::slice::from_ref(body), f64::NEG_INFINITY) <= margin + 1e-9
    }) else {
        return false;
    };
    if limiting.is_bounds() {
        return false;
    }
    let alone = OracleScene {
        bodies: core::slice::from_ref(limiting),
        ..*scene
    };
    let more = margin + LIMIT_TOLERANCE_M;
    let mut ascent = OracleAscent::new(alone, more);
    let seeds = alone.one_turn(f64::NEG_INFINITY, more + CHORD_ERROR_M);
    ascent.refine(&seeds, false);
    let best = ascent.best;
    ascent.refine(&[best], true);
    ascent.best.0 < more
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::situation::ProtectedVolume;

    const VOLUME: ProtectedVolume = ProtectedVolume::Sphere { radius_m: 30.0 };

    fn track(points_m: &[(f64, Vec3)]) -> OracleTrack {
        OracleTrack {
            points_m: points_m.to_vec(),
            volume: VOLUME,
        }
    }

    #[test]
    fn a_straight_track_is_the_same_as_a_straight_mover() {
        let (from_m, velocity_mps) = (Vec3::new(250.0, 8.0, 0.0), Vec3::new(-12.0, 1.0, 0.0));
        let obstacle = OracleObstacle {
            position_m: from_m,
            velocity_mps,
            volume: VOLUME,
        };
        let vehicle = OracleVehicle::table_4();
        let settings = OracleSettings::default();
        let straight = best_margin(&OracleStart::ORIGIN, &vehicle, &[obstacle], &settings);
        let points: Vec<(f64, Vec3)> = (0..=60)
            .map(|second| (f64::from(second), from_m + velocity_mps * f64::from(second)))
            .collect();
        let tracked = best_margin_on_tracks(
            &OracleStart::ORIGIN,
            &vehicle,
            &[track(&points)],
            None,
            &settings,
        );
        assert!((straight.best_margin_m - tracked.best_margin_m).abs() < 0.02);
        assert!((straight.do_nothing_margin_m - tracked.do_nothing_margin_m).abs() < 1e-3);
    }

    /// Level flight at 15 m/s along x. The other aircraft stands at (300, 0) until t = 10 s and is gone then:
    /// it is never nearer than 150 m, less its radius. If it comes back at t = 18 s, it is 30 m away.
    #[test]
    fn an_aircraft_counts_only_while_its_track_exists() {
        let place = Vec3::X * 300.0;
        let hold = |points: &[OracleTrack]| {
            let settings = OracleSettings::default();
            let vehicle = OracleVehicle::table_4();
            best_margin_on_tracks(&OracleStart::ORIGIN, &vehicle, points, None, &settings)
                .do_nothing_margin_m
        };
        let gone = track(&[(0.0, place), (10.0, place)]);
        assert!((hold(core::slice::from_ref(&gone)) - 120.0).abs() < 1e-3);
        let back = track(&[(18.0, place), (18.5, place)]);
        assert!((hold(&[gone, back]) + 7.5).abs() < 1e-3);
        // It turns away before it gets near: a straight mover would have hit.
        let turned = track(&[
            (0.0, Vec3::X * 600.0),
            (10.0, Vec3::X * 450.0),
            (30.0, Vec3::new(450.0, 600.0, 0.0)),
        ]);
        let margin_m = hold(&[turned]);
        // Nearest where 15 m/s along x and 30 m/s along y balance: by hand, at t = 14 s.
        let by_hand = (0..=3000)
            .map(|k| f64::from(k) * 0.01)
            .map(|t| {
                let own = Vec3::X * (15.0 * t);
                let its = if t < 10.0 {
                    Vec3::X * (600.0 - 15.0 * t)
                } else {
                    Vec3::new(450.0, 30.0 * (t - 10.0), 0.0)
                };
                own.distance(its) - 30.0
            })
            .fold(f64::INFINITY, f64::min);
        assert!((margin_m - by_hand).abs() < 0.01, "{margin_m} {by_hand}");
    }
}

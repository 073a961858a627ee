//! Judges an encounter by the volumes of the standards, from the tracks alone.
//!
//! Both aircraft fly straight between their known moments: rows of a recording, seconds of a model,
//! samples of the flown path at most 0.1 s apart. Only the time when both were recorded counts: from
//! the later first row to the earlier last one, even if the way back takes longer.

use fga::Vec3;
use fga::avoider::State as FlightState;
use fga_alerts::encounter::{EncounterOutcome, PairSample, judge};
use fga_alerts::volume::{Cylinder, Volume, WellClear};
use fga_alerts::{Aircraft, AircraftId, AircraftState, Monitor, schemes};
use fga_judge::separation::least_at;
use fga_judge::track::{Track, TrackPoint};
use fga_sim::engine::{Observer, Outcome as EngineFlight, Sample};
use fga_sim::progress::progress_of;
use fga_sim::world::World;

use super::metrics::Metrics;

/// Time between two evaluations of the alerts, seconds.
const ALERT_STEP_S: f64 = 1.0;

/// A track that turns by less from away to back, or the reverse, has not turned, metres.
const TURNED_M: f64 = 10.0;

/// Levels of DO-365B.
const CORRECTIVE: usize = 2;
const WARNING: usize = 3;

/// Follows the flown path.
#[derive(Debug, Default)]
pub struct FlownPath {
    path: Vec<TrackPoint>,
    /// When the aircraft left the recording, seconds.
    left_s: Option<f64>,
}

impl FlownPath {
    /// Ready for another flight.
    pub fn clear(&mut self) {
        self.path.clear();
        self.left_s = None;
    }
}

impl Observer for FlownPath {
    fn sample(&mut self, sample: &Sample) {
        if sample.state == FlightState::Avoiding && self.left_s.is_none() {
            self.left_s = Some(sample.time_s);
        }
        self.path.push(TrackPoint {
            time_s: sample.time_s,
            position_m: sample.position_m,
        });
    }
}

/// The metrics of a flight of its own in a recorded world; `None` for a world without a recording.
pub fn metrics_of(world: &World, flown: &FlownPath, outcome: &EngineFlight) -> Option<Metrics> {
    world.recorded.as_ref()?;
    let mut judge = WorldJudge::new();
    let mut metrics = judge.nominal(world);
    judge.flown((world, false), flown, &mut metrics);
    metrics.work = outcome.work();
    Some(metrics.rounded())
}

/// How often the flown track turns from going away from its line to coming back, or the reverse, by more than
/// [`TURNED_M`]: what a policy says of itself does not count.
fn changes(world: &World, flown: &FlownPath) -> u32 {
    let Some(left_s) = flown.left_s else {
        return 0;
    };
    let mut progress = progress_of(world);
    let nexts = flown.path.iter().skip(1).chain(flown.path.last());
    let beside_m = flown.path.iter().zip(nexts).filter_map(|(now, next)| {
        let moved_m = next.position_m - now.position_m;
        let velocity_mps = || moved_m / (next.time_s - now.time_s).max(1e-9);
        progress.follow(now.time_s, now.position_m, None, velocity_mps);
        (now.time_s >= left_s).then(|| progress.cross_track_m())
    });
    turns(beside_m)
}

/// How often a distance turns from growing to shrinking, or the reverse, by more than [`TURNED_M`].
fn turns(distances_m: impl Iterator<Item = f64>) -> u32 {
    let (mut turns, mut grows, mut extreme_m) = (0, false, 0.0_f64);
    for distance_m in distances_m {
        let turned_m = if grows {
            extreme_m - distance_m
        } else {
            distance_m - extreme_m
        };
        if turned_m > TURNED_M {
            (turns, grows, extreme_m) = (turns + 1, !grows, distance_m);
        } else if turned_m < 0.0 {
            extreme_m = distance_m;
        }
    }
    turns
}

/// The result against one intruder.
#[derive(Debug, Clone, Copy, Default)]
struct Losses {
    f3442: EncounterOutcome,
    do365: EncounterOutcome,
    /// Least of the larger of the separations in units of the volume of a near mid-air collision.
    scale: Option<f64>,
}

/// Judges recorded worlds.
pub(super) struct WorldJudge {
    monitor: Monitor,
    pairs: Vec<PairSample>,
}

impl WorldJudge {
    pub(super) fn new() -> Self {
        Self {
            monitor: Monitor::new(schemes::do_365b()),
            pairs: Vec::new(),
        }
    }

    /// The encounter without any avoidance.
    pub(super) fn nominal(&mut self, world: &World) -> Metrics {
        let Some(own) = &world.recorded else {
            return Metrics::default();
        };
        let mut metrics = Metrics::default();
        let Some((index, losses)) = self.worst(world, points_of(own)) else {
            return metrics;
        };
        losses.note(&mut metrics);
        metrics.nominal_nmac = metrics.nmac.take();
        metrics.nominal_lowc = metrics.lowc.take();
        metrics.nominal_do365 = metrics.do365.take();
        metrics.nominal_severity = metrics.severity.take();
        metrics.nominal_nmac_scale = metrics.nmac_scale.take();
        metrics.nominal_horizontal_m = metrics.horizontal_m.take();
        metrics.nominal_vertical_m = metrics.vertical_m.take();
        metrics.cpa_s = losses.f3442.slant.map(|least| least.time_s);
        let (Some(cpa_s), Some(intruder)) = (metrics.cpa_s, world.obstacles.get(index)) else {
            return metrics;
        };
        geometry(&mut metrics, own, &intruder.track, cpa_s);
        let [corrective_s, warning_s] = self.alerts(world, own, cpa_s);
        metrics.corrective_s = corrective_s.map(|time_s| cpa_s - time_s);
        metrics.warning_s = warning_s.map(|time_s| cpa_s - time_s);
        metrics
    }

    /// Adds the flown path in a world whose intruders may have flown otherwise than recorded.
    pub(super) fn flown(
        &mut self,
        (world, is_other): (&World, bool),
        flown: &FlownPath,
        metrics: &mut Metrics,
    ) {
        let Some(own) = &world.recorded else {
            return;
        };
        metrics.changes = Some(f64::from(changes(world, flown)));
        // While the aircraft follows the recording, the rows give its position.
        let Some(left_s) = flown.left_s.or(is_other.then_some(f64::INFINITY)) else {
            metrics.nmac = metrics.nominal_nmac;
            metrics.lowc = metrics.nominal_lowc;
            metrics.do365 = metrics.nominal_do365;
            metrics.severity = metrics.nominal_severity;
            metrics.nmac_scale = metrics.nominal_nmac_scale;
            metrics.horizontal_m = metrics.nominal_horizontal_m;
            metrics.vertical_m = metrics.nominal_vertical_m;
            return;
        };
        let recorded = points_of(own).iter().filter(|at| at.time_s < left_s);
        let left = flown.path.iter().filter(|at| at.time_s >= left_s);
        let path: Vec<TrackPoint> = recorded.chain(left).copied().collect();
        if let Some((_, losses)) = self.worst(world, &path) {
            losses.note(metrics);
        }
        let begun = metrics.cpa_s.zip(flown.left_s);
        metrics.action_s = begun.map(|(cpa_s, left_s)| cpa_s - left_s);
    }

    /// The nearest intruder of a path, and losses over all of them.
    fn worst(&mut self, world: &World, path: &[TrackPoint]) -> Option<(usize, Losses)> {
        let until_s = world.recorded.as_ref()?.presence_s().1;
        let mut worst: Option<(usize, Losses)> = None;
        for (index, obstacle) in world.obstacles.iter().enumerate() {
            together(path, points_of(&obstacle.track), until_s, &mut self.pairs);
            let losses = Losses {
                f3442: judge(&self.pairs, &Volume::Cylinder(Cylinder::F3442)),
                do365: judge(&self.pairs, &Volume::WellClear(WellClear::EN_ROUTE)),
                scale: nmac_scale(&self.pairs),
            };
            worst = Some(match worst {
                None => (index, losses),
                Some((nearest, before)) => {
                    let slant_m =
                        |of: &Losses| of.f3442.slant.map_or(f64::INFINITY, |least| least.value_m);
                    let is_nearer = slant_m(&losses) < slant_m(&before);
                    let mut both = if is_nearer { losses } else { before };
                    let other = if is_nearer { &before } else { &losses };
                    both.take(other);
                    (if is_nearer { index } else { nearest }, both)
                }
            });
        }
        worst
    }

    /// First corrective and first warning alert, before the closest approach.
    fn alerts(&mut self, world: &World, own: &Track, cpa_s: f64) -> [Option<f64>; 2] {
        let mut first = [None; 2];
        let begin_s = own.presence_s().0;
        let looks = libm::floor((cpa_s - begin_s) / ALERT_STEP_S);
        let mut look = 0.0;
        while look <= looks && first[1].is_none() {
            let time_s = begin_s + look * ALERT_STEP_S;
            look += 1.0;
            let aircraft = |id: u64, track: &Track| {
                let (position_m, velocity_mps) = track.at(time_s)?;
                Some(Aircraft::new(
                    AircraftId(id),
                    AircraftState {
                        position_m,
                        velocity_mps: velocity_mps - world.wind_mps,
                    },
                ))
            };
            let Some(ownship) = aircraft(0, own) else {
                continue;
            };
            let others = (1..).zip(&world.obstacles);
            let traffic: Vec<_> = others
                .filter_map(|(id, obstacle)| aircraft(id, &obstacle.track))
                .collect();
            // Recordings were checked: a refused state has no alert.
            let step = self.monitor.step_for(&[], time_s, &ownship, &traffic);
            if step.is_err() {
                continue;
            }
            let level = self.monitor.highest_level();
            for (first, least) in first.iter_mut().zip([CORRECTIVE, WARNING]) {
                if level >= least && first.is_none() {
                    *first = Some(time_s);
                }
            }
        }
        first
    }
}

impl Losses {
    /// Writes the losses as those of the flown encounter.
    fn note(&self, metrics: &mut Metrics) {
        metrics.nmac = Some(self.f3442.nmac_s.is_some());
        metrics.lowc = Some(self.f3442.loss_s.is_some());
        metrics.do365 = Some(self.do365.loss_s.is_some());
        metrics.severity = self.do365.severity;
        metrics.nmac_scale = self.scale;
        metrics.horizontal_m = self.f3442.horizontal.map(|least| least.value_m);
        metrics.vertical_m = self.f3442.vertical_then_m;
    }

    /// Adds the losses against another intruder.
    fn take(&mut self, other: &Self) {
        self.scale = match (self.scale, other.scale) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        for (mine, its) in [
            (&mut self.f3442, &other.f3442),
            (&mut self.do365, &other.do365),
        ] {
            mine.nmac_s = mine.nmac_s.or(its.nmac_s);
            mine.loss_s = mine.loss_s.or(its.loss_s);
            mine.severity = match (mine.severity, its.severity) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            };
        }
    }
}

/// Volume of a near mid-air collision: 500 ft and 100 ft, metres.
const NMAC_M: (f64, f64) = (152.4, 30.48);

/// Least over time of the larger of horizontal and vertical separation in units of that volume.
fn nmac_scale(pairs: &[PairSample]) -> Option<f64> {
    let offset_m = |pair: &PairSample| pair.intruder_m - pair.ownship_m;
    let scale = |offset_m: Vec3| {
        (libm::hypot(offset_m.x, offset_m.y) / NMAC_M.0).max(offset_m.z.abs() / NMAC_M.1)
    };
    let mut least = scale(offset_m(pairs.first()?));
    for pair in pairs.windows(2) {
        let [from, to] = pair else { continue };
        let (from_m, to_m) = (offset_m(from), offset_m(to));
        let moved_m = to_m - from_m;
        least = least.min(scale(to_m));
        let (across, along) = (from_m.truncate(), moved_m.truncate());
        let nearest = (-across.dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        if (across + along * nearest).length() / NMAC_M.0 >= least {
            continue;
        }
        // The larger of two convex functions is convex along a line.
        let scale_at = |share: f64| scale(from_m + moved_m * share);
        least = least.min(scale_at(least_at(scale_at, 1.0, 60)));
    }
    Some(least)
}

fn points_of(track: &Track) -> &[TrackPoint] {
    match track {
        Track::Straight { .. } => &[],
        Track::Points { points, .. } => points,
    }
}

/// Positions of both at all times at which either is known, while both exist.
fn together(
    own: &[TrackPoint],
    intruder: &[TrackPoint],
    until_s: f64,
    pairs: &mut Vec<PairSample>,
) {
    pairs.clear();
    let (Some(first), Some(last), Some(its_first), Some(its_last)) =
        (own.first(), own.last(), intruder.first(), intruder.last())
    else {
        return;
    };
    let to_s = last.time_s.min(its_last.time_s).min(until_s);
    let (mut a, mut b) = (0, 0);
    let mut time_s = first.time_s.max(its_first.time_s);
    while time_s <= to_s {
        pairs.push(PairSample {
            time_s,
            ownship_m: at(own, time_s, &mut a),
            intruder_m: at(intruder, time_s, &mut b),
        });
        if time_s >= to_s {
            break;
        }
        let next = |points: &[TrackPoint], from: usize| {
            let mut times_s = points.iter().skip(from).map(|point| point.time_s);
            times_s
                .find(|next_s| *next_s > time_s)
                .unwrap_or(f64::INFINITY)
        };
        time_s = next(own, a).min(next(intruder, b)).min(to_s);
    }
}

/// The position on a path at a time, linear between its points; `from` is the previous point.
fn at(points: &[TrackPoint], time_s: f64, from: &mut usize) -> Vec3 {
    while points
        .get(*from + 1)
        .is_some_and(|next| next.time_s <= time_s)
    {
        *from += 1;
    }
    match (points.get(*from), points.get(*from + 1)) {
        (Some(a), Some(b)) => {
            let share = (time_s - a.time_s) / (b.time_s - a.time_s);
            a.position_m + (b.position_m - a.position_m) * share
        }
        (Some(a), None) => a.position_m,
        _ => Vec3::ZERO,
    }
}

/// The geometry of the encounter.
fn geometry(metrics: &mut Metrics, own: &Track, intruder: &Track, cpa_s: f64) {
    let (Some((own_m, own_mps)), Some((_, its_mps))) = (own.at(cpa_s), intruder.at(cpa_s)) else {
        return;
    };
    let degrees_between = |a: Vec3, b: Vec3| {
        let across = a.x * b.y - a.y * b.x;
        let along = a.x * b.x + a.y * b.y;
        libm::atan2(across, along).to_degrees().abs()
    };
    metrics.ownship_mps = Some(own_mps.length());
    metrics.intruder_mps = Some(its_mps.length());
    metrics.closing_mps = Some((its_mps - own_mps).length());
    metrics.crossing_deg = Some(degrees_between(own_mps, its_mps));
    metrics.intruder_climb_mps = Some(its_mps.z);
    metrics.altitude_m = Some(own_m.z);
    let mut turn_deg: f64 = 0.0;
    let mut first = None;
    // Steps of seconds: rows of a recording are too close to give a direction.
    intruder.for_each_leg(f64::NEG_INFINITY, cpa_s, |leg| {
        let (Some(a), Some(b)) = (
            intruder.at(leg.from_s),
            intruder.at((leg.from_s + 1.0).min(cpa_s)),
        ) else {
            return;
        };
        let moved = b.0 - a.0;
        if libm::hypot(moved.x, moved.y) < 1.0 {
            return;
        }
        let first = *first.get_or_insert(moved);
        turn_deg = turn_deg.max(degrees_between(first, moved));
    });
    metrics.intruder_turn_deg = Some(turn_deg);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Away and back are two; a wobble below 10 m is none, whatever a policy calls its state.
    #[test]
    fn d9_changes_follow_from_the_track() {
        let of = |distances_m: &[f64]| turns(distances_m.iter().copied());
        assert_eq!(of(&[0.0, 4.0, 0.0, 9.0, 1.0]), 0);
        assert_eq!(of(&[0.0, 30.0, 90.0, 85.0, 120.0, 40.0, 0.0, 5.0]), 2);
        assert_eq!(of(&[0.0, 90.0, 70.0, 95.0, 60.0, 100.0, 0.0]), 6);
    }

    /// Past each other 100 m aside at 100 m/s; the other one climbs at 10 m/s and is level at the closest approach. 1,000 m before, and with
    /// samples 20 s apart, the least is between them: 100 / 152.4, for the vertical one is smaller there.
    #[test]
    fn the_scale_of_a_near_collision_is_found_between_samples() {
        let pair = |time_s: f64, above_m: f64| PairSample {
            time_s,
            ownship_m: Vec3::ZERO,
            intruder_m: Vec3::new(1000.0 - 100.0 * time_s, 100.0, above_m),
        };
        let least = nmac_scale(&[pair(0.0, -100.0), pair(20.0, 100.0)]).unwrap();
        assert!((least - 100.0 / 152.4).abs() < 1e-9, "{least}");
        // 61 m above all the time: twice the height counts.
        let least = nmac_scale(&[pair(0.0, 60.96), pair(20.0, 60.96)]).unwrap();
        assert!((least - 2.0).abs() < 1e-9, "{least}");
        assert_eq!(nmac_scale(&[]), None);
    }

    #[test]
    fn two_paths_are_put_together_at_the_times_of_either() {
        let point = |time_s: &f64| TrackPoint {
            time_s: *time_s,
            position_m: Vec3::X * *time_s,
        };
        let line = |times: &[f64]| -> Vec<TrackPoint> { times.iter().map(point).collect() };
        let mut pairs = Vec::new();
        together(
            &line(&[0.0, 1.0, 2.0, 9.0]),
            &line(&[0.5, 1.5, 4.0]),
            3.0,
            &mut pairs,
        );
        let times: Vec<f64> = pairs.iter().map(|pair| pair.time_s).collect();
        assert_eq!(times, [0.5, 1.0, 1.5, 2.0, 3.0]);
        for pair in &pairs {
            assert!((pair.ownship_m.x - pair.time_s).abs() < 1e-12);
            assert!((pair.intruder_m.x - pair.time_s).abs() < 1e-12);
        }
        together(&line(&[0.0, 1.0]), &line(&[2.0, 3.0]), 9.0, &mut pairs);
        assert!(pairs.is_empty());
    }
}

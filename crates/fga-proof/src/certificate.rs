//! A proven lower bound of the separation along a predicted flight, in continuous time.
//!
//! Between two nodes the flight bows from its chord by at most A·h²/8, where A bounds the acceleration. The least separation on the
//! chord, less that bow, is a lower bound (proof.md §7). Chords that decide the answer are split until the bow no longer matters. Far
//! from all obstacles one chord covers many nodes.

mod ground;
mod hazard;
mod zones;

pub use hazard::{ALWAYS, Assumption, Extent, Hazard, Line, NO_DEPTH, Obstruction};
pub use zones::{Fixed, MAX_ZONES, STEEPEST, Zones};

use crate::Vec3;
use crate::assumptions::{Assumptions, each};
use crate::meter::{LOOK, Meter};
use crate::prediction::{CHORD_BOW_M, FlightPath, Flyer, MotionState, Node};

/// A chord that decides the answer is split into this many, ...
const SPLITS: u32 = 5;

/// ... and for a proof into more while their bows decide, up to this many: 10 µm are left of a bow of 0.16 m.
pub(crate) const MOST_SPLITS: u32 = SPLITS * SPLITS * SPLITS;

/// Work for a look at it, and for flying to the ends of those.
const SPLIT_WORK: usize = LOOK + 12;

/// Whether the bound is proven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// The separation is at least the margin over the whole horizon.
    Proven,
    /// The margin is below the requested floor; the rest was not examined.
    BelowFloor,
    /// The path does not follow the manoeuvre up to the horizon, or the step's work ended before the whole path was
    /// examined: nothing is proven.
    LimitMet,
}

/// The certified separation along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Lower bound of the separation beyond the volumes, metres; infinite without obstacles.
    /// At most the requested `enough_m`.
    pub margin_m: f64,
    /// The obstacle that determines it, if one does.
    pub id: Option<u32>,
    /// Time of the least separation, seconds from the decision.
    pub at_s: f64,
    /// Whether it is proven.
    pub status: Status,
}

impl Closest {
    /// Nothing known yet: the requested margin.
    #[inline]
    pub const fn clear(enough_m: f64) -> Self {
        Self {
            margin_m: enough_m,
            id: None,
            at_s: 0.0,
            status: Status::Proven,
        }
    }

    /// The proven margin, metres: minus infinity if the path ended before the horizon.
    pub fn proven_m(&self) -> f64 {
        if self.status == Status::LimitMet {
            f64::NEG_INFINITY
        } else {
            self.margin_m
        }
    }

    /// Whether a separation of `margin_m` beyond the volumes is proven.
    pub fn holds(&self, margin_m: f64) -> bool {
        self.status == Status::Proven && self.margin_m >= margin_m
    }
}

/// Bounds the separation from all that is around along a path up to a horizon, seconds, as far as a meter allows: the rest is not
/// examined once a margin is below a floor, metres, and margins are capped, metres.
pub fn certify_set(
    flyer: &Flyer,
    path: &FlightPath,
    around: &Assumptions<'_>,
    asked: (f64, f64, f64),
    meter: &Meter,
) -> Closest {
    bounded(flyer, path, around, asked, (SPLITS, meter))
}

/// The same with chords split into this many at most.
#[inline(never)]
pub(crate) fn bounded(
    flyer: &Flyer,
    path: &FlightPath,
    Assumptions { rows, fixed }: &Assumptions<'_>,
    asked @ (horizon_s, floor_m, _): (f64, f64, f64),
    effort: (u32, &Meter),
) -> Closest {
    let found = bounded_from(flyer, path, rows, asked, effort);
    if found.status != Status::Proven || fixed.is_empty() {
        return found;
    }
    // The margin of a flight that enters nothing is its distance from zones and ground, and what it is spared of that: so much less
    // distance is asked for. A flight that enters something is spared nothing.
    let spare_m = fixed.zones.spare_m;
    let floor_m = (floor_m - spare_m).max(floor_m.min(0.0));
    let enough_m = (found.margin_m - spare_m).max(0.0);
    let fixed_alone = core::slice::from_ref(fixed);
    let asked = (horizon_s, floor_m, enough_m);
    let nearest = bounded_from(flyer, path, fixed_alone, asked, effort);
    if nearest.holds(enough_m) {
        return found;
    }
    let mut margin_m = found.margin_m.min(fixed.margin_m(nearest.margin_m));
    if margin_m < 0.0 && floor_m < 0.0 {
        // A chord tells only how far it leads out itself.
        let until_s = horizon_s.min(fixed.zones.until_s);
        let end = path.end_line(until_s).filter(|line| line.duration_s > 0.0);
        let end = end.map(|line| (until_s, line.from_m + line.velocity_mps * line.duration_s));
        let states = path.nodes().iter().map(|node| node.state);
        let places = states
            .map(|state| (state.time_s, state.position_m))
            .chain(end);
        let meter = effort.1;
        margin_m = places.fold(margin_m, |least_m, place| {
            least_m.min(-fixed.depth_m(place, meter))
        });
    }
    Closest {
        margin_m,
        ..nearest
    }
}

/// The same for obstructions of one kind.
fn bounded_from<O: Obstruction>(
    flyer: &Flyer,
    path: &FlightPath,
    hazards: &[O],
    (horizon_s, floor_m, enough_m): (f64, f64, f64),
    (most_splits, meter): (u32, &Meter),
) -> Closest {
    if meter.is_met() {
        return Closest {
            status: Status::LimitMet,
            ..Closest::clear(enough_m)
        };
    }
    // The prediction errs by at most this, so the certificate asks for that much more.
    let remainder_m = path.remainder_m();
    let (floor_m, most_m) = (floor_m + remainder_m, enough_m + remainder_m);
    let mut worst = Closest::clear(most_m);
    // First the long straight line at the end: what comes close there rules out most chords.
    let above = path.end_line(horizon_s).is_none_or(|line| {
        line.duration_s < 0.0
            || each(hazards, meter, |hazard| {
                if let Some((margin, at_s)) = hazard.least_on_line(&line, worst.margin_m, meter) {
                    lower(&mut worst, margin, at_s, hazard);
                }
                worst.margin_m >= floor_m
            })
    });
    // Then the unsplit chords, if there is anything between floor and ceiling: no margin is larger than the least of one and its bow, so
    // only chords that are nearer may decide.
    let scene = (flyer, hazards, (horizon_s, floor_m), meter);
    let above = above
        && (floor_m >= most_m
            || each_near(
                scene,
                path,
                &mut worst,
                &mut |chord, hazard, least, worst| {
                    lower(worst, least.0 + chord.bow_m, least.1, hazard);
                },
            ));
    // Those are split until the bow no longer matters.
    let above = above
        && each_near(scene, path, &mut worst, &mut |chord, hazard, _, worst| {
            chord.split(flyer, hazard, (floor_m, most_splits), worst, meter);
        });
    let below_floor = worst.margin_m < floor_m;
    // A sufficient margin is exactly the requested one, despite rounding.
    worst.margin_m = if worst.margin_m >= most_m {
        enough_m
    } else {
        worst.margin_m - remainder_m
    };
    worst.status = match (meter.is_spent(), below_floor) {
        (false, true) => Status::BelowFloor,
        (false, false) if above && path.is_complete() => Status::Proven,
        _ => Status::LimitMet,
    };
    worst
}

/// The straight line between two moments of a flight, at constant speed.
#[derive(Debug, Clone, Copy)]
struct Chord<'a> {
    node: &'a Node,
    end_m: Vec3,
    line: Line,
    /// Largest bow of the flight from it, metres.
    bow_m: f64,
}

impl<'a> Chord<'a> {
    /// From the first of some nodes to the last one, `None` without a duration; if that is after `horizon_s`, there is only one
    /// between two, cut there. One over several nodes stands for shorter ones: it counts the bow that each of these would subtract.
    #[inline]
    fn over(flyer: &Flyer, nodes: &'a [Node], horizon_s: f64) -> Option<Self> {
        let [node, within @ .., last] = nodes else {
            return None;
        };
        let mut end = last.state;
        if end.time_s > horizon_s {
            if !within.is_empty() {
                return None;
            }
            end = flyer.advance(&node.state, &node.piece(), horizon_s - node.state.time_s);
            end.time_s = horizon_s;
        }
        let duration_s = end.time_s - node.state.time_s;
        let fastest_mps2 = (within.iter().map(|node| node.acceleration_mps2))
            .fold(node.acceleration_mps2, f64::max);
        let shorter_m = if within.is_empty() { 0.0 } else { CHORD_BOW_M };
        (duration_s > 0.0).then(|| Self {
            node,
            end_m: end.position_m,
            line: Line::over(
                (node.state.position_m, end.position_m),
                node.state.time_s,
                duration_s,
            ),
            bow_m: fastest_mps2 * duration_s * duration_s / 8.0 + shorter_m,
        })
    }

    /// Lowers `worst` to a bound over the shorter chords between exact points in between, as short as it takes to decide
    /// whether it is at least `floor_m`, or as a limit allows.
    fn split(
        &self,
        flyer: &Flyer,
        hazard: &impl Obstruction,
        (floor_m, most_splits): (f64, u32),
        worst: &mut Closest,
        meter: &Meter,
    ) {
        if !meter.take(SPLIT_WORK) {
            lower(worst, f64::NEG_INFINITY, self.line.at_s, hazard);
            return;
        }
        let before = *worst;
        let mut splits = SPLITS;
        let mut bow_m = self.split_into(splits, flyer, hazard, worst, meter);
        let is_open =
            |margin_m: f64, bow_m| margin_m < floor_m && margin_m + 2.0 * bow_m >= floor_m;
        while is_open(worst.margin_m, bow_m) && splits < most_splits {
            let work = splits as usize * SPLIT_WORK;
            if meter.left() as usize <= work || !meter.take(work) {
                break;
            }
            *worst = before;
            splits *= SPLITS;
            bow_m = self.split_into(splits, flyer, hazard, worst, meter);
        }
    }

    /// The same over this many chords; returns the largest bow of one, metres.
    fn split_into(
        &self,
        splits: u32,
        flyer: &Flyer,
        hazard: &impl Obstruction,
        worst: &mut Closest,
        meter: &Meter,
    ) -> f64 {
        let mut from: MotionState = self.node.state;
        let piece = self.node.piece();
        let step_s = self.line.duration_s / f64::from(splits);
        let bow_m = self.bow_m / f64::from(splits * splits);
        for part in 1..=splits {
            let to = if part == splits {
                MotionState {
                    position_m: self.end_m,
                    ..from
                }
            } else if !piece.is_rolling() {
                flyer.advance(&from, &piece, step_s)
            } else {
                flyer.advance(&self.node.state, &piece, f64::from(part) * step_s)
            };
            let line = Line::over((from.position_m, to.position_m), from.time_s, step_s);
            let below_m = worst.margin_m + bow_m;
            if let Some((margin, at_s)) = hazard.least_on_line(&line, below_m, meter) {
                lower(worst, margin - bow_m, at_s, hazard);
            }
            from = to;
        }
        bow_m
    }
}

impl FlightPath {
    /// The straight line from the last node to `horizon_s`; its duration is negative where the path ends later.
    #[inline]
    pub fn end_line(&self, horizon_s: f64) -> Option<Line> {
        let last = self.nodes().last()?.state;
        Some(Line {
            from_m: last.position_m,
            velocity_mps: self.end_velocity_mps(),
            at_s: last.time_s,
            duration_s: horizon_s - last.time_s,
        })
    }
}

/// Looks at a hazard near a chord, with its least margin there and when.
type Visit<'a, O> = dyn FnMut(&Chord<'_>, &O, (f64, f64), &mut Closest) + 'a;

/// Shows the chords between nodes up to a horizon, seconds, the last one cut there, the hazards that may lower `worst` there,
/// and their least margins on the chord and when, until `worst` is below a floor, metres, or the work is done; returns whether
/// neither was. Where no hazard comes near the chord over several nodes, those in between need no look.
#[inline(never)]
fn each_near<O: Obstruction>(
    (flyer, hazards, (horizon_s, floor_m), meter): (&Flyer, &[O], (f64, f64), &Meter),
    path: &FlightPath,
    worst: &mut Closest,
    look: &mut Visit<'_, O>,
) -> bool {
    let mut rest = path.nodes();
    let mut count = rest.len();
    while let [node, _, ..] = rest
        && node.state.time_s < horizon_s
    {
        count = count.min(rest.len() - 1);
        let is_one = count == 1;
        let chord = Chord::over(flyer, rest.get(..=count).unwrap_or(rest), horizon_s);
        let goes_on = chord.map_or(is_one, |chord| {
            each(hazards, meter, |hazard| {
                let below_m = worst.margin_m + chord.bow_m;
                if !is_one {
                    return !hazard.is_near(&chord.line, below_m, meter);
                }
                if let Some(least) = hazard.least_on_line(&chord.line, below_m, meter) {
                    look(&chord, hazard, least, worst);
                    return worst.margin_m >= floor_m;
                }
                true
            }) && !meter.is_met()
        });
        if goes_on {
            rest = rest.get(count..).unwrap_or(&[]);
            count *= 2;
        } else if is_one {
            return false;
        } else {
            count /= 2;
        }
    }
    true
}

#[inline]
fn lower(worst: &mut Closest, margin_m: f64, at_s: f64, hazard: &impl Obstruction) {
    // After what is not a number nothing is proven.
    if margin_m < worst.margin_m || margin_m.is_nan() {
        *worst = Closest {
            margin_m,
            at_s,
            id: hazard.obstacle(),
            ..*worst
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maneuver::{Maneuver, Stage};
    use crate::situation::ProtectedVolume;
    use crate::vehicle::{Response, Vehicle};

    const RADIUS_M: f64 = 100.0;

    fn flyer() -> Flyer {
        Flyer::new(&Vehicle {
            airspeed_mps: 20.0,
            turn_radius_m: RADIUS_M,
            climb_min_rad: -0.2,
            climb_max_rad: 0.2,
            climb_rate_radps: 0.2,
            response: Response::default(),
        })
    }

    /// Straight on for 100 m, then a turn to the left by an angle.
    fn turned(flyer: &Flyer, by_rad: f64) -> FlightPath {
        let mut maneuver = Maneuver::hold();
        maneuver.push(Stage {
            start_s: 5.0,
            course_rad: by_rad,
            climb_rad: 0.0,
            rate_share: 1.0,
        });
        let mut path = FlightPath::new();
        path.predict(flyer, &MotionState::ahead(0.0), &maneuver, 60.0);
        path
    }

    fn sphere(id: u32, position_m: Vec3) -> Hazard {
        let volume = ProtectedVolume::Sphere { radius_m: 1.0 };
        Hazard::exact(id, position_m, Vec3::ZERO, volume)
    }

    #[test]
    fn a_chord_over_many_nodes_covers_what_the_flight_bows_from_it() {
        let flyer = flyer();
        let path = turned(&flyer, core::f64::consts::PI);
        // Beside the middle of the turn, and far from all chords over more than a part of it.
        for beside_m in [-10.0, -2.0, 0.0, 2.0, 10.0] {
            let apex_m = Vec3::new(RADIUS_M + RADIUS_M + beside_m, RADIUS_M, 0.0);
            let found = certify_set(
                &flyer,
                &path,
                &Assumptions::only(&[sphere(0, apex_m)]),
                (60.0, f64::MIN, 50.0),
                &Meter::unlimited(),
            );
            assert!((found.margin_m - (beside_m.abs() - 1.0)).abs() < 0.01);
        }
    }

    #[test]
    fn an_obstacle_far_from_a_long_turn_takes_few_looks() {
        let flyer = flyer();
        let path = turned(&flyer, 3.0);
        let meter = Meter::unlimited();
        let far = [sphere(0, Vec3::new(0.0, 2000.0, 0.0))];
        let found = certify_set(
            &flyer,
            &path,
            &Assumptions::only(&far),
            (60.0, 0.0, 50.0),
            &meter,
        );
        assert!(found.holds(50.0));
        assert!(path.nodes().len() > 15);
        assert!(meter.done() <= 3, "{} looks", meter.done());
    }
}

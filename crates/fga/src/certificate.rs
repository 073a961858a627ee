//! A proven lower bound of the separation along a predicted flight, in continuous time.
//!
//! Between two nodes the flight bows from its chord by at most A·h²/8, where A bounds the
//! acceleration. The chord, at constant speed, and an obstacle that moves in a straight line
//! have a straight relative motion, on which the least separation has a closed
//! form for a sphere and is the minimum of a convex function for a cylinder. Chord minimum less
//! bow is a lower bound; chords that decide the answer are split until the bow no longer matters.

mod hazards;

pub use hazards::{ALWAYS, Hazard, Hazards, MAX_HAZARDS, NO_DEPTH};
pub(crate) use hazards::{HazardSet, Line};

use crate::Vec3;
use crate::meter::{LOOK, Meter};
use crate::prediction::{FlightPath, Flyer, MotionState, Node};

/// A chord that decides the answer is split into this many.
const SPLITS: u32 = 5;

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
pub struct Certificate {
    /// Lower bound of the separation beyond the volumes, metres; infinite without obstacles.
    /// At most the requested `enough_m`.
    pub margin_m: f64,
    /// Index of the hazard that determines it.
    pub hazard: Option<u32>,
    /// Time of the least separation, seconds from the decision.
    pub at_s: f64,
    /// Whether it is proven.
    pub status: Status,
}

impl Certificate {
    /// Nothing known yet: the requested margin.
    pub const fn clear(enough_m: f64) -> Self {
        Self {
            margin_m: enough_m,
            hazard: None,
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

/// Bounds the separation from one hazard along a path up to `horizon_s`: [`certify_all`] of one.
pub fn certify(
    flyer: &Flyer,
    path: &FlightPath,
    hazard: &Hazard,
    horizon_s: f64,
    floor_m: f64,
    enough_m: f64,
) -> Certificate {
    let one = core::slice::from_ref(hazard);
    certify_all(flyer, path, one, horizon_s, floor_m, enough_m)
}

/// Bounds the separation from every hazard along a path up to `horizon_s`, seconds.
///
/// Stops early below `floor_m`; margins are capped at `enough_m`.
pub fn certify_all(
    flyer: &Flyer,
    path: &FlightPath,
    hazards: &[Hazard],
    horizon_s: f64,
    floor_m: f64,
    enough_m: f64,
) -> Certificate {
    let asked = Asked {
        horizon_s,
        floor_m,
        enough_m,
    };
    certify_set(flyer, path, hazards, &asked, &Meter::unlimited())
}

/// The requirements on a certificate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked {
    /// Horizon, seconds.
    pub(crate) horizon_s: f64,
    /// Margins below this stop the search, metres.
    pub(crate) floor_m: f64,
    /// Margins are capped at this value, metres.
    pub(crate) enough_m: f64,
}

/// [`certify_all`] for hazards that may be in blocks, as far as a meter allows.
pub(crate) fn certify_set<H: HazardSet + ?Sized>(
    flyer: &Flyer,
    path: &FlightPath,
    hazards: &H,
    asked: &Asked,
    meter: &Meter,
) -> Certificate {
    let horizon_s = asked.horizon_s;
    if meter.is_met() {
        return Certificate {
            status: Status::LimitMet,
            ..Certificate::clear(asked.enough_m)
        };
    }
    // The prediction errs by at most this, so the certificate asks for that much more.
    let remainder_m = path.remainder_m();
    let (floor_m, enough_m) = (asked.floor_m + remainder_m, asked.enough_m + remainder_m);
    let mut worst = Certificate::clear(enough_m);
    // First the long straight line at the end: what comes close there rules out most chords.
    let above = end_line(path, horizon_s).is_none_or(|line| {
        line.duration_s < 0.0
            || hazards.each_close(&line, worst.margin_m, meter, |hazard| {
                if let Some((margin, at_s)) = hazard.least_on_line(&line, worst.margin_m, meter) {
                    lower(&mut worst, margin, at_s, hazard);
                }
                worst.margin_m >= floor_m
            })
    });
    // Then the unsplit chords: only those whose margin less the bow is below what is known so far may decide, so the first and
    // the last of them bound what is split. Without a gap between floor and ceiling all may.
    let one_mark = floor_m >= enough_m;
    let mut deciding_s = if one_mark {
        (f64::NEG_INFINITY, f64::INFINITY)
    } else {
        (f64::INFINITY, f64::NEG_INFINITY)
    };
    let above = above
        && (one_mark
            || for_each_chord(flyer, path.nodes(), horizon_s, |chord| {
                let below_m = worst.margin_m + chord.bow_m;
                hazards.each_close(&chord.line, below_m, meter, |hazard| {
                    let below_m = worst.margin_m + chord.bow_m;
                    if let Some((margin, at_s)) = hazard.least_on_line(&chord.line, below_m, meter)
                    {
                        deciding_s = (deciding_s.0.min(chord.line.at_s), chord.line.at_s);
                        lower(&mut worst, margin + chord.bow_m, at_s, hazard);
                    }
                    worst.margin_m >= floor_m
                }) && !meter.is_met()
            }));
    // Those are split until the bow no longer matters.
    let above = above
        && for_each_chord(flyer, chords_begun(path, deciding_s), horizon_s, |chord| {
            let below_m = worst.margin_m + chord.bow_m;
            hazards.each_close(&chord.line, below_m, meter, |hazard| {
                let below_m = worst.margin_m + chord.bow_m;
                if hazard.least_on_line(&chord.line, below_m, meter).is_some() {
                    chord.split(flyer, hazard, &mut worst, meter);
                }
                worst.margin_m >= floor_m
            }) && !meter.is_met()
        });
    let below_floor = worst.margin_m < floor_m;
    // A sufficient margin is exactly the requested one, despite rounding.
    worst.margin_m = if worst.margin_m >= enough_m {
        asked.enough_m
    } else {
        worst.margin_m - remainder_m
    };
    worst.status = if meter.is_spent() {
        Status::LimitMet
    } else if below_floor {
        Status::BelowFloor
    } else if above && path.is_complete() {
        Status::Proven
    } else {
        Status::LimitMet
    };
    worst
}

/// Marks the hazards that may come closer than `below_m` anywhere along a path up to `horizon_s`, by
/// spheres about them: the margins of all others are at least that. Marks all if a meter refuses a look.
pub(crate) fn mark_close(
    flyer: &Flyer,
    path: &FlightPath,
    hazards: &Hazards,
    (horizon_s, below_m): (f64, f64),
    meter: &Meter,
) -> [bool; MAX_HAZARDS] {
    let mut marks = [false; MAX_HAZARDS];
    let mut mark = |hazard: &Hazard| {
        if let Some(mark) = marks.get_mut(hazard.index as usize) {
            *mark = true;
        }
        true
    };
    let below_m = below_m + path.remainder_m();
    let goes_on = for_each_chord(flyer, path.nodes(), horizon_s, |chord| {
        hazards.each_close(&chord.line, below_m + chord.bow_m, meter, &mut mark)
    });
    if goes_on && let Some(mut line) = end_line(path, horizon_s) {
        line.duration_s = line.duration_s.max(0.0);
        hazards.each_close(&line, below_m, meter, &mut mark);
    }
    if meter.is_spent() {
        return [true; MAX_HAZARDS];
    }
    marks
}

/// The straight line between two moments of a flight, at constant speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chord<'a> {
    node: &'a Node,
    end_m: Vec3,
    /// The line.
    pub(crate) line: Line,
    /// Largest bow of the flight from it, metres.
    pub(crate) bow_m: f64,
}

impl<'a> Chord<'a> {
    /// From a node to a later moment on its piece; `None` without a duration.
    #[inline]
    pub(crate) fn new(node: &'a Node, end_m: Vec3, end_s: f64) -> Option<Self> {
        let duration_s = end_s - node.state.time_s;
        (duration_s > 0.0).then(|| Self {
            node,
            end_m,
            line: Line {
                from_m: node.state.position_m,
                velocity_mps: (end_m - node.state.position_m) / duration_s,
                at_s: node.state.time_s,
                duration_s,
            },
            bow_m: node.acceleration_mps2 * duration_s * duration_s / 8.0,
        })
    }

    /// Lowers `worst` to a bound over the shorter chords between exact points in between.
    fn split(&self, flyer: &Flyer, hazard: &Hazard, worst: &mut Certificate, meter: &Meter) {
        let mut from: MotionState = self.node.state;
        let is_straight = self.bow_m == 0.0;
        if !meter.take(if is_straight { LOOK } else { SPLIT_WORK }) {
            lower(worst, f64::NEG_INFINITY, from.time_s, hazard);
            return;
        }
        if is_straight {
            if let Some((margin, at_s)) = hazard.least_on_line(&self.line, worst.margin_m, meter) {
                lower(worst, margin, at_s, hazard);
            }
            return;
        }
        let piece = self.node.piece();
        let step_s = self.line.duration_s / f64::from(SPLITS);
        let bow_m = self.bow_m / f64::from(SPLITS * SPLITS);
        for part in 1..=SPLITS {
            let to = if part == SPLITS {
                MotionState {
                    position_m: self.end_m,
                    ..from
                }
            } else if !piece.is_rolling() {
                flyer.advance(&from, &piece, step_s)
            } else {
                flyer.advance(&self.node.state, &piece, f64::from(part) * step_s)
            };
            let line = Line {
                from_m: from.position_m,
                velocity_mps: (to.position_m - from.position_m) / step_s,
                at_s: from.time_s,
                duration_s: step_s,
            };
            let below_m = worst.margin_m + bow_m;
            if let Some((margin, at_s)) = hazard.least_on_line(&line, below_m, meter) {
                lower(worst, margin - bow_m, at_s, hazard);
            }
            from = to;
        }
    }

    /// A bound of the margin, just fine enough to decide whether it is at least `floor_m`:
    /// lowers `worst` to it.
    #[inline]
    pub(crate) fn bound(
        &self,
        flyer: &Flyer,
        hazard: &Hazard,
        floor_m: f64,
        worst: &mut Certificate,
        meter: &Meter,
    ) {
        let below_m = worst.margin_m + self.bow_m;
        let Some((margin, at_s)) = hazard.least_on_line(&self.line, below_m, meter) else {
            return;
        };
        if margin - self.bow_m < floor_m && margin + self.bow_m >= floor_m {
            self.split(flyer, hazard, worst, meter);
        } else {
            lower(worst, margin - self.bow_m, at_s, hazard);
        }
    }
}

/// The straight line from the last node of a path to `horizon_s`; its duration is negative where the path ends later.
fn end_line(path: &FlightPath, horizon_s: f64) -> Option<Line> {
    let last = path.nodes().last()?.state;
    Some(Line {
        from_m: last.position_m,
        velocity_mps: path.end_velocity_mps(),
        at_s: last.time_s,
        duration_s: horizon_s - last.time_s,
    })
}

/// The nodes of the chords of a path that begin within two moments, seconds.
fn chords_begun(path: &FlightPath, (from_s, until_s): (f64, f64)) -> &[Node] {
    let nodes = path.nodes();
    let first = nodes.partition_point(|node| node.state.time_s < from_s);
    let end = nodes.partition_point(|node| node.state.time_s <= until_s) + 1;
    nodes.get(first..end.min(nodes.len())).unwrap_or(&[])
}

/// Shows the chords between nodes up to `horizon_s`, the last one cut there, until `visit` is false; returns whether it
/// never was.
#[inline]
fn for_each_chord(
    flyer: &Flyer,
    nodes: &[Node],
    horizon_s: f64,
    mut visit: impl FnMut(&Chord<'_>) -> bool,
) -> bool {
    for pair in nodes.windows(2) {
        let [node, next] = pair else { continue };
        if node.state.time_s >= horizon_s {
            return true;
        }
        let chord = if next.state.time_s > horizon_s {
            let end = flyer.advance(&node.state, &node.piece(), horizon_s - node.state.time_s);
            Chord::new(node, end.position_m, horizon_s)
        } else {
            Chord::new(node, next.state.position_m, next.state.time_s)
        };
        if chord.is_some_and(|chord| !visit(&chord)) {
            return false;
        }
    }
    true
}

fn lower(worst: &mut Certificate, margin_m: f64, at_s: f64, hazard: &Hazard) {
    if margin_m < worst.margin_m {
        *worst = Certificate {
            margin_m,
            at_s,
            hazard: Some(hazard.index),
            ..*worst
        };
    }
}

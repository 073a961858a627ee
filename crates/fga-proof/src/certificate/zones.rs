//! The zones near an aircraft, for the certificate.

use super::hazards::{HazardSet, Line, Obstruction};
use crate::list::List;
use crate::meter::{LOOK, Meter};
use crate::zone::{ALL_HEIGHTS_M, Outline, Span, Zone, meet, span_m};
use crate::{Vec2, Vec3};

/// Most zones near an aircraft, and most runs of their edges.
pub const MAX_ZONES: usize = 64;

/// Edges of a run.
const RUN: usize = 8;

/// Edges of a polygon that follow one another.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// The box around them.
    span_m: Span,
    corners_m: [Vec2; RUN + 1],
}

/// A zone, the edges of which are runs.
#[derive(Debug, Clone, Copy)]
struct Near {
    zone: Zone<'static>,
    /// The first of its runs and the one behind the last.
    runs: (usize, usize),
}

impl Near {
    /// Zeros, which are written without a copy.
    const NONE: Self = Self {
        zone: Zone {
            keep_in: false,
            outline: Outline::Circle(Vec2::ZERO, 0.0),
            heights_m: (0.0, 0.0),
        },
        runs: (0, 0),
    };
}

/// The zones near an aircraft.
#[derive(Debug, Clone)]
pub struct Zones {
    all: List<Near, MAX_ZONES>,
    runs: List<Run, MAX_ZONES>,
    wind_mps: Vec3,
    until_s: f64,
    /// The margin of a flight that enters none is its distance from the nearest one and this, metres.
    pub spare_m: f64,
}

impl Zones {
    pub(super) const NONE: Self = Self {
        all: List::new(Near::NONE),
        runs: List::new(Run {
            span_m: (Vec2::ZERO, Vec2::ZERO),
            corners_m: [Vec2::ZERO; RUN + 1],
        }),
        wind_mps: Vec3::ZERO,
        until_s: 0.0,
        spare_m: 0.0,
    };

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Least margin on a line and its time, where it is lower than another one.
    pub fn lower(&self, line: &Line, least: (f64, f64), meter: &Meter) -> (f64, f64) {
        let below_m = (least.0 - self.spare_m).max(0.0);
        let found = (!self.is_empty()).then(|| self.least_on_line(line, below_m, meter));
        let found = found.flatten();
        found.map_or(least, |(distance_m, at_s)| {
            (self.margin_m(distance_m), at_s)
        })
    }

    /// The margin of a flight at a distance, metres.
    pub(super) fn margin_m(&self, distance_m: f64) -> f64 {
        distance_m + if distance_m < 0.0 { 0.0 } else { self.spare_m }
    }

    /// Forgets all, in a wind, metres per second; those that follow count up to a moment, seconds.
    pub const fn clear(&mut self, wind_mps: Vec3, until_s: f64) {
        self.all.clear();
        self.runs.clear();
        (self.wind_mps, self.until_s, self.spare_m) = (wind_mps, until_s, 0.0);
    }

    /// Adds what of a zone is within a distance of the place where flights begin, metres. False where that place is on the wrong
    /// side, or there is no room: then everything counts as entered, and nothing is proven.
    pub fn add(&mut self, zone: &Zone<'_>, (at_m, within_m): (Vec3, f64)) -> bool {
        let fits = !zone.is_entered(at_m) && self.take(zone, at_m.truncate(), within_m).is_some();
        if !fits {
            self.all.clear();
            let mut nowhere = Near::NONE;
            nowhere.zone.keep_in = true;
            self.all.push(nowhere);
        }
        fits
    }

    fn take(&mut self, zone: &Zone<'_>, at: Vec2, within_m: f64) -> Option<()> {
        let near_m = (at - Vec2::splat(within_m), at + Vec2::splat(within_m));
        let first = self.runs.len();
        let (outline, whole_m) = match zone.outline {
            Outline::Circle(center_m, radius_m) => {
                let beside_m = Vec2::splat(radius_m);
                let whole_m = (center_m - beside_m, center_m + beside_m);
                (Outline::Circle(center_m, radius_m), whole_m)
            }
            Outline::Polygon(corners_m) => {
                (Outline::Polygon(&[]), span_m(corners_m.iter().copied()))
            }
        };
        if !zone.keep_in && !meet(&whole_m, &near_m) {
            return Some(());
        }
        // To know what is over a zone takes all its edges.
        let takes_all = !zone.keep_in && zone.heights_m != ALL_HEIGHTS_M;
        let mut edges = zone.edges().peekable();
        while let Some((from_m, _)) = edges.peek().copied() {
            let mut corners_m = [from_m; RUN + 1];
            let mut last_m = from_m;
            for slot in corners_m.iter_mut().skip(1) {
                last_m = edges.next().map_or(last_m, |(_, to_m)| to_m);
                *slot = last_m;
            }
            let span_m = span_m(corners_m);
            if takes_all || meet(&span_m, &near_m) {
                self.runs.push(Run { span_m, corners_m })?;
            }
        }
        let runs = (first, self.runs.len());
        let zone = Zone { outline, ..*zone };
        self.all.push(Near { zone, runs }).map(|_| ())
    }
}

impl HazardSet for Zones {
    type Each = Self;

    #[inline]
    fn each_close(
        &self,
        _: &Line,
        _: f64,
        _: &Meter,
        mut visit: impl FnMut(&Self) -> bool,
    ) -> bool {
        self.is_empty() || visit(self)
    }
}

/// All as one, by the distance from the nearest.
impl Obstruction for Zones {
    fn index(&self) -> u32 {
        u32::MAX
    }

    fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        // Over the ground, where they are at rest.
        let over = Line {
            from_m: line.from_m + self.wind_mps * line.at_s,
            velocity_mps: line.velocity_mps + self.wind_mps,
            at_s: line.at_s,
            duration_s: line.duration_s.min(self.until_s - line.at_s),
        };
        if over.duration_s < 0.0 {
            return None;
        }
        if !meter.take(LOOK + self.all.len().max(self.runs.len())) {
            return Some((f64::NEG_INFINITY, line.at_s));
        }
        let mut least = None;
        for Near { zone, runs } in self.all.iter() {
            let runs = self.runs.get(runs.0..runs.1).unwrap_or(&[]);
            let edges = |near_m: Span| {
                let runs = runs.iter().filter(move |run| meet(&run.span_m, &near_m));
                runs.flat_map(|run| {
                    let next_m = run.corners_m.iter().copied().skip(1);
                    run.corners_m.iter().copied().zip(next_m)
                })
            };
            let most_m = least.map_or(below_m, |(least_m, _)| least_m);
            least = zone.least_on_line(edges, &over, most_m).or(least);
        }
        least
    }
}

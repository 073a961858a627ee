//! What is fixed over the ground, for the certificate: how close a line comes to the zones near an aircraft, and to the ground.

use super::hazard::{Extent, Line, Obstruction};
use crate::ground::{Binding, Ground};
use crate::limit::Limit as _;
use crate::list::List;
use crate::meter::{LOOK, Meter};
use crate::situation::ProtectedVolume;
use crate::zone::{ALL_HEIGHTS_M, Outline, Span, Zone, meet, span_m};
use crate::{Vec2, Vec3};

/// Most zones near an aircraft, and most runs of their edges.
pub const MAX_ZONES: usize = 64;

/// Edges of a run.
const RUN: usize = 8;

/// Edges are this thick, metres: more than rounding moves them, so that no gap lies between two.
const ROUNDED_M: f64 = 1e-6;

/// A flight that enters a zone counts as no deeper than this, metres.
const DEEPEST_M: f64 = 1e3;

/// Ground is hardly steeper, metres up in each metre aside: so far from a line is the nearest one that clears what it enters.
pub const STEEPEST: f64 = 10.0;

/// Farther up or down than any flight, metres.
const HIGHEST_M: f64 = 1e6;

/// More work than the steps to the least distance from a circle take.
const CIRCLE_WORK: u32 = 100;

/// Edges of a polygon that follow one another.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// The box around them, metres, rounded outwards: from the west and the south to the east and the north.
    span_m: [f32; 4],
    /// The index of the first of them.
    first: u32,
}

impl Run {
    fn new((low_m, high_m): Span, first: u32) -> Self {
        let ((west, south), (east, north)) = (low_m.as_vec2().into(), high_m.as_vec2().into());
        let [west, south]: [f32; 2] = [west, south].map(f32::next_down);
        let [east, north] = [east, north].map(f32::next_up);
        Self {
            span_m: [west, south, east, north],
            first,
        }
    }

    fn meets(&self, span_m: &Span) -> bool {
        let [west, south, east, north] = self.span_m.map(f64::from);
        meet(&(Vec2::new(west, south), Vec2::new(east, north)), span_m)
    }
}

/// A zone, the edges of which are runs.
#[derive(Debug, Clone, Copy)]
struct Near {
    /// Its index among those of the mission.
    zone: u16,
    /// The first of its runs and the one behind the last.
    runs: (u8, u8),
}

/// The zones near an aircraft.
#[derive(Debug, Clone)]
pub struct Zones {
    all: List<Near, MAX_ZONES>,
    /// Whether one is entered, or there is no room for all.
    entered: bool,
    runs: List<Run, MAX_ZONES>,
    wind_mps: Vec3,
    /// Zones and ground count up to this moment, seconds.
    pub until_s: f64,
    /// The margin of a flight that enters none is its distance from the nearest one and this, metres.
    pub spare_m: f64,
    /// What binds of the ground.
    pub binding: Binding,
}

/// The zones near an aircraft, and the ground.
#[derive(Debug, Clone, Copy)]
pub struct Fixed<'a> {
    pub(crate) zones: &'a Zones,
    /// The zones of the mission.
    pub(crate) mission: &'a [Zone<'a>],
    pub(crate) ground: Option<&'a Ground<'a>>,
}

impl Fixed<'_> {
    /// Whether there is neither.
    pub fn is_empty(&self) -> bool {
        self.zones.is_empty() && self.ground.is_none()
    }

    /// How much less than is asked for is kept from them, metres.
    pub(crate) fn spared_m(&self) -> f64 {
        if self.is_empty() {
            0.0
        } else {
            self.zones.spare_m
        }
    }

    /// Least margin on a line and its time, if lower than another one, or anything below a floor: no flight that is nearer to the line than the
    /// margin is negative clears what the line enters.
    pub fn lower(
        &self,
        line: &Line,
        mut least: (f64, f64),
        floor_m: f64,
        meter: &Meter,
    ) -> (f64, f64) {
        let (zones, spare_m) = (self.zones, self.zones.spare_m);
        let Some(over) = zones.counted(line).filter(|_| !self.is_empty()) else {
            return least;
        };
        if let Some(found) = self.least_on(&over, (least.0 - spare_m).max(0.0), meter) {
            least = (self.margin_m(found.0), found.1);
        }
        if let Some(ground) = self.ground.filter(|_| least.0 >= floor_m) {
            let (beside_m, stop_m) = ((floor_m - spare_m).max(0.0), floor_m.min(0.0));
            let lowest = |beside_m| ground.lowest(&over, (beside_m, stop_m), zones.binding, meter);
            let near = lowest(beside_m);
            if near.0 < 0.0 {
                let entered = if beside_m > 0.0 { lowest(0.0) } else { near };
                let below = (floor_m - ROUNDED_M, near.1);
                let aside = (entered.0 / STEEPEST, entered.1);
                let (below_m, after_s) = if entered.0 < 0.0 { aside } else { below };
                least = (least.0.min(below_m), line.at_s + after_s);
            }
        }
        least
    }

    /// How deep a place at a moment, seconds, lies in a zone, metres; 0 outside of all, and where the meter refuses work.
    pub(super) fn depth_m(&self, (at_s, at_m): (f64, Vec3), meter: &Meter) -> f64 {
        let zones = self.zones;
        let over_m = at_m + zones.wind_mps * at_s;
        let all = zones
            .all
            .iter()
            .filter_map(|near| self.mission.get(usize::from(near.zone)));
        let counted = all.filter(|zone| at_s <= zones.until_s && meter.take(2 * zone.work()));
        let entered = counted.filter(|zone| zone.is_entered(over_m));
        entered
            .map(|zone| zone.way_out_m(over_m).length())
            .fold(0.0, f64::max)
    }

    /// The margin of a flight at a distance, metres.
    pub(super) fn margin_m(&self, distance_m: f64) -> f64 {
        let is_entered = distance_m < 0.0;
        distance_m + if is_entered { 0.0 } else { self.zones.spare_m }
    }

    /// The least distance of a line over the ground from the nearest zone, metres, and its moment, seconds, if below one.
    fn least_on(&self, over: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        let Zones { all, runs, .. } = self.zones;
        if !meter.take(LOOK + all.len().max(runs.len())) {
            return Some((f64::NEG_INFINITY, over.at_s));
        }
        if self.zones.entered {
            return Some((-DEEPEST_M, over.at_s));
        }
        let mut least = None;
        for Near { zone, runs: of } in all.iter() {
            let Some(zone) = self.mission.get(usize::from(*zone)) else {
                return Some((-DEEPEST_M, over.at_s));
            };
            let runs = runs.get(of.0.into()..of.1.into()).unwrap_or(&[]);
            let edges = |near_m: Span| {
                let runs = runs.iter().filter(move |run| run.meets(&near_m));
                runs.flat_map(|run| zone.edges_from(run.first as usize).take(RUN))
            };
            let most_m = least.map_or(below_m, |(least_m, _)| least_m);
            let found = zone.least_on_line(&edges, over, most_m, meter);
            least = found.or(least);
        }
        least
    }
}

impl Zones {
    /// No zones.
    pub const NONE: Self = Self {
        all: List::new(Near {
            zone: 0,
            runs: (0, 0),
        }),
        runs: List::new(Run {
            span_m: [0.0; 4],
            first: 0,
        }),
        entered: false,
        wind_mps: Vec3::ZERO,
        until_s: 0.0,
        spare_m: 0.0,
        binding: Binding::ALL,
    };

    /// Whether no zone is known.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty() && !self.entered
    }

    /// The part of a line that counts, over the ground, where all are at rest.
    fn counted(&self, line: &Line) -> Option<Line> {
        let duration_s = line.duration_s.min(self.until_s - line.at_s);
        (duration_s >= 0.0).then_some(Line {
            from_m: line.from_m + self.wind_mps * line.at_s,
            velocity_mps: line.velocity_mps + self.wind_mps,
            at_s: line.at_s,
            duration_s,
        })
    }

    /// Forgets all, in a wind, metres per second; those that follow count up to a moment, seconds.
    pub const fn clear(&mut self, wind_mps: Vec3, until_s: f64) {
        self.all.clear();
        self.runs.clear();
        (self.wind_mps, self.until_s, self.spare_m) = (wind_mps, until_s, 0.0);
        self.entered = false;
        self.binding = Binding::ALL;
    }

    /// Counts everything as entered: nothing is proven.
    pub const fn enter(&mut self) {
        self.entered = true;
    }

    /// Adds what of a zone of the mission, by its index, is within a distance of the place where flights begin, metres. False where that
    /// place is on the wrong side, or there is no room: then everything counts as entered, and nothing is proven.
    pub fn add(
        &mut self,
        mission: &[Zone<'_>],
        index: usize,
        (at_m, within_m): (Vec3, f64),
    ) -> bool {
        let zone = mission.get(index).filter(|zone| !zone.is_entered(at_m));
        let fits = zone.and_then(|zone| self.take(zone, index, (at_m.truncate(), within_m)));
        self.entered |= fits.is_none();
        !self.entered
    }

    fn take(&mut self, zone: &Zone<'_>, index: usize, (at, within_m): (Vec2, f64)) -> Option<()> {
        let near_m = (at - Vec2::splat(within_m), at + Vec2::splat(within_m));
        let begin = self.runs.len();
        let whole_m = match zone.outline {
            Outline::Circle(center_m, radius_m) => {
                let beside_m = Vec2::splat(radius_m);
                (center_m - beside_m, center_m + beside_m)
            }
            Outline::Polygon(corners_m) => span_m(corners_m.iter().copied()),
        };
        if !zone.keep_in && !meet(&whole_m, &near_m) {
            return Some(());
        }
        // To know what is over a zone takes all its edges.
        let takes_all = !zone.keep_in && zone.heights_m != ALL_HEIGHTS_M;
        for first in (0..zone.edges().count()).step_by(RUN) {
            let edges = zone.edges_from(first).take(RUN);
            let span_m = span_m(edges.flat_map(|(from_m, to_m)| [from_m, to_m]));
            if takes_all || meet(&span_m, &near_m) {
                let first = u32::try_from(first).ok()?;
                self.runs.push(Run::new(span_m, first))?;
            }
        }
        let place = |index| u8::try_from(index).ok();
        let runs = (place(begin)?, place(self.runs.len())?);
        let zone = u16::try_from(index).ok()?;
        self.all.push(Near { zone, runs }).map(|_| ())
    }
}

/// All as one, by the distance from the nearest.
impl Obstruction for Fixed<'_> {
    fn obstacle(&self) -> Option<u32> {
        None
    }

    fn is_near(&self, line: &Line, below_m: f64, meter: &Meter) -> bool {
        let zones = self.zones;
        let over = zones.counted(line);
        over.is_some_and(|over| {
            self.least_on(&over, below_m, meter).is_some()
                || self.ground.is_some_and(|ground| {
                    let asked = (below_m.max(0.0), 0.0);
                    ground.lowest(&over, asked, zones.binding, meter).0 < 0.0
                })
        })
    }

    fn least_on_line(&self, line: &Line, below_m: f64, meter: &Meter) -> Option<(f64, f64)> {
        let over = self.zones.counted(line)?;
        let least = self.least_on(&over, below_m, meter);
        let most_m = least.map_or(below_m, |(least_m, _)| least_m);
        let found = self
            .ground
            .and_then(|ground| ground.least_on_line(&over, most_m, self.zones.binding, meter));
        found.or(least)
    }
}

/// The least distance so far, metres, and its moment, seconds after the beginning of a line.
struct Least(f64, f64);

impl Least {
    fn note(&mut self, distance_m: f64, after_s: f64) {
        if distance_m - ROUNDED_M < self.0 {
            *self = Self(distance_m - ROUNDED_M, after_s);
        }
    }
}

/// A line with the heights at which a zone counts as one height: heights above and below that are left.
struct Flat<'a> {
    line: &'a Line,
    heights_m: (f64, f64),
}

impl Flat<'_> {
    fn at_m(&self, after_s: f64) -> Vec3 {
        let at_m = self.line.from_m + self.line.velocity_mps * after_s;
        let (low_m, high_m) = self.heights_m;
        at_m.with_z(at_m.z - at_m.z.limited(low_m, high_m))
    }

    /// Its parts above, within and below the heights, by their moments, seconds, and their ends, metres.
    fn parts(&self) -> impl Iterator<Item = ((f64, Vec3), (f64, Vec3))> {
        let (low_m, high_m) = self.heights_m;
        let Line {
            from_m,
            velocity_mps,
            duration_s,
            ..
        } = *self.line;
        let [low_s, high_s] =
            [low_m, high_m].map(|z_m| ((z_m - from_m.z) / velocity_mps.z).limited(0.0, duration_s));
        let (first_s, second_s) = (low_s.min(high_s), low_s.max(high_s));
        let parts_s = [(0.0, first_s), (first_s, second_s), (second_s, duration_s)];
        parts_s
            .into_iter()
            .filter(move |(from_s, to_s)| from_s < to_s || duration_s == 0.0)
            .map(|(from_s, to_s)| ((from_s, self.at_m(from_s)), (to_s, self.at_m(to_s))))
    }
}

impl Zone<'_> {
    /// The least distance of a line over the ground from it, metres, at most a given one; negative on the wrong side. It takes
    /// [`Self::work`].
    pub fn nearest_m(&self, line: &Line, most_m: f64) -> f64 {
        if self.is_entered(line.from_m) {
            return -ROUNDED_M;
        }
        let meter = Meter::new(CIRCLE_WORK, CIRCLE_WORK);
        let least = self.least_on_line(&|near_m| self.edges_near(near_m), line, most_m, &meter);
        least.map_or(most_m, |(least_m, _)| least_m)
    }

    /// What a look at it takes, in units of work.
    pub fn work(&self) -> usize {
        match self.outline {
            Outline::Polygon(corners_m) => corners_m.len(),
            Outline::Circle(..) => CIRCLE_WORK as usize,
        }
    }

    /// The least distance of a line over the ground from it, metres, and the moment of that, seconds, if below one. It is negative if
    /// the line, which begins on the right side, enters it: then as far as the line ends beyond its edges. Minus infinity if the
    /// meter refuses work.
    fn least_on_line<E: Iterator<Item = (Vec2, Vec2)>>(
        &self,
        edges: &impl Fn(Span) -> E,
        line: &Line,
        below_m: f64,
        meter: &Meter,
    ) -> Option<(f64, f64)> {
        let mut least = Least(below_m, 0.0);
        match self.outline {
            Outline::Circle(center_m, radius_m) if !self.keep_in => {
                let cylinder = self.cylinder(center_m, radius_m);
                if let Some((distance_m, at_s)) = cylinder.least_on_line(line, below_m, meter) {
                    least.note(distance_m, at_s - line.at_s);
                }
            }
            _ => {
                let mut flat = Flat {
                    line,
                    heights_m: self.heights_m,
                };
                if self.keep_in {
                    self.note_ends(line, &mut least);
                    flat.heights_m = ALL_HEIGHTS_M;
                }
                self.note_edges(edges, &flat, &mut least);
                if least.0 < 0.0 && matches!(self.outline, Outline::Polygon(_)) {
                    let deep_m = self.deep_m(edges, &flat).unwrap_or(0.0);
                    least.0 = least.0.min(-deep_m);
                }
            }
        }
        (least.0 < below_m).then_some((least.0, line.at_s + least.1))
    }

    /// A circle that the aircraft keeps out of.
    fn cylinder(&self, center_m: Vec2, radius_m: f64) -> Extent {
        let (floor_m, ceiling_m) = self.heights_m;
        let (floor_m, ceiling_m) = (floor_m.max(-HIGHEST_M), ceiling_m.min(HIGHEST_M));
        let volume = ProtectedVolume::Cylinder {
            radius_m,
            half_height_m: 0.5 * (ceiling_m - floor_m),
        };
        let center_m = center_m.extend(0.5 * (floor_m + ceiling_m));
        Extent::exact(center_m, Vec3::ZERO, volume)
    }

    /// What is inside of a convex volume is nearest to its surface at an end of a line: heights, and a circle.
    fn note_ends(&self, line: &Line, least: &mut Least) {
        let (floor_m, ceiling_m) = self.heights_m;
        for after_s in [0.0, line.duration_s] {
            let at_m = line.from_m + line.velocity_mps * after_s;
            least.note((at_m.z - floor_m).min(ceiling_m - at_m.z), after_s);
            if let Outline::Circle(center_m, radius_m) = self.outline {
                least.note(radius_m - at_m.truncate().distance(center_m), after_s);
            }
        }
    }

    /// A line is nearest to a polygon at an edge, or where it begins, ends, or meets floor or ceiling over it.
    fn note_edges<E: Iterator<Item = (Vec2, Vec2)>>(
        &self,
        edges: &impl Fn(Span) -> E,
        flat: &Flat<'_>,
        least: &mut Least,
    ) {
        let note_over = |at_m: Vec3, after_s: f64, least: &mut Least| {
            if flat.heights_m != ALL_HEIGHTS_M
                && at_m.z.abs() < least.0 + ROUNDED_M
                && self.surrounds(edges, at_m.truncate())
            {
                least.note(at_m.z.abs(), after_s);
            }
        };
        note_over(flat.at_m(0.0), 0.0, least);
        for ((from_s, from_m), (to_s, to_m)) in flat.parts() {
            note_over(to_m, to_s, least);
            let most_m = Vec2::splat(least.0.max(0.0) + ROUNDED_M);
            let (low_m, high_m) = span_m([from_m, to_m].map(Vec3::truncate));
            for edge_m in edges((low_m - most_m, high_m + most_m)) {
                let (distance_m, share) = to_edge((from_m, to_m), edge_m, most_m.x);
                least.note(distance_m, from_s + share * (to_s - from_s));
            }
        }
    }

    /// How far a line ends beyond the edges of a polygon that it enters, metres: the farther, the deeper it enters.
    fn deep_m<E: Iterator<Item = (Vec2, Vec2)>>(
        &self,
        edges: &impl Fn(Span) -> E,
        flat: &Flat<'_>,
    ) -> Option<f64> {
        let (begin_m, end_m) = (flat.at_m(0.0), flat.at_m(flat.line.duration_s));
        let (from, to) = (begin_m.truncate(), end_m.truncate());
        let is_left = |a: Vec2, b: Vec2, at: Vec2| (b - a).perp_dot(at - a) > 0.0;
        let (mut crosses, mut deep_m) = (false, DEEPEST_M);
        for (a, b) in edges((Vec2::NEG_INFINITY, Vec2::INFINITY)) {
            crosses ^= is_left(from, to, a) != is_left(from, to, b)
                && is_left(a, b, from) != is_left(a, b, to);
            deep_m = to_edge((end_m, end_m), (a, b), deep_m).0.min(deep_m);
        }
        // Of a zone with a floor or a ceiling all edges are known.
        let is_beyond = if flat.heights_m == ALL_HEIGHTS_M {
            crosses
        } else {
            end_m.z == 0.0 && self.surrounds(edges, to)
        };
        is_beyond.then_some(deep_m)
    }
}

/// The least distance of what moves from one place to another one from a level edge at height zero, metres, if below one, and the
/// share of its way: that from the straight line through the edge where it is beside the edge then, or else from a corner.
#[inline]
fn to_edge((from_m, to_m): (Vec3, Vec3), (a, b): (Vec2, Vec2), below_m: f64) -> (f64, f64) {
    let (a, b) = (a.extend(0.0), b.extend(0.0));
    let (way, edge) = (to_m - from_m, b - a);
    let nearest = |offset: Vec3, way: Vec3| {
        let share = -offset.dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
        let share = share.limited(0.0, 1.0);
        ((offset + way * share).length(), share)
    };
    let along = |way: Vec3| way.dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE);
    let (begins, goes_on) = (along(from_m - a), along(way));
    let beside = nearest(from_m - a - edge * begins, way - edge * goes_on);
    if beside.0 >= below_m || (0.0..=1.0).contains(&(begins + goes_on * beside.1)) {
        return beside;
    }
    let (of_a, of_b) = (nearest(from_m - a, way), nearest(from_m - b, way));
    if of_b.0 < of_a.0 { of_b } else { of_a }
}

//! TCAS II thresholds: sensitivity levels by the ownship's altitude.
//!
//! Source: RTCA DO-185B, table of sensitivity levels and alarm thresholds; Muñoz, Narkawicz,
//! Chamberlain, "A TCAS-II Resolution Advisory Detection Algorithm", AIAA 2013-4622.

use crate::aircraft::Pair;
use crate::almost::Closeness;
use crate::loss::Loss;
use crate::plane::{Crossing, circle_crossing_s, half_root, room, root, same_velocity};
use crate::units::{FOOT_M, NAUTICAL_MILE_M};
use crate::volume::cylinder::slab_crossing_s;
use alloc::vec::Vec;
use glam::DVec2;

/// Thresholds of one sensitivity level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Upper altitude limit of the level, metres; infinite for the last.
    pub up_to_m: f64,
    /// Modified tau, seconds.
    pub tau_s: f64,
    /// Time to co-altitude, seconds.
    pub coaltitude_s: f64,
    /// Distance (`DMOD`), metres.
    pub distance_m: f64,
    /// Horizontal miss distance (`HMD`), metres.
    pub miss_distance_m: f64,
    /// Vertical distance (`ZTHR`), metres.
    pub height_m: f64,
}

/// Thresholds of an advisory, by altitude.
#[derive(Debug, Clone, PartialEq)]
pub struct Advisory {
    /// The levels, lowest first, altitudes increasing.
    levels: Vec<Sensitivity>,
    /// Whether an approach that misses by `HMD` is no threat.
    pub filters_by_miss_distance: bool,
}

/// Altitude, ft; traffic advisory: tau s, DMOD nmi, ZTHR ft; resolution advisory: tau s, DMOD
/// nmi, ZTHR ft, HMD ft (RTCA DO-185B).
const TABLE: [(f64, [f64; 3], [f64; 4]); 8] = [
    (0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]),
    (1000.0, [20.0, 0.30, 850.0], [0.0, 0.0, 0.0, 0.0]),
    (2350.0, [25.0, 0.33, 850.0], [15.0, 0.20, 600.0, 1215.0]),
    (5000.0, [30.0, 0.48, 850.0], [20.0, 0.35, 600.0, 2126.0]),
    (10_000.0, [40.0, 0.75, 850.0], [25.0, 0.55, 600.0, 3342.0]),
    (20_000.0, [45.0, 1.0, 850.0], [30.0, 0.80, 600.0, 4861.0]),
    (42_000.0, [48.0, 1.3, 850.0], [35.0, 1.10, 700.0, 6683.0]),
    (
        f64::INFINITY,
        [48.0, 1.3, 1200.0],
        [35.0, 1.10, 800.0, 6683.0],
    ),
];

impl Advisory {
    /// Thresholds from levels, lowest first; `None` without a level, with altitudes that do not
    /// increase, or with a bounded last level.
    pub fn new(levels: Vec<Sensitivity>, filters_by_miss_distance: bool) -> Option<Self> {
        let grow = levels
            .iter()
            .zip(levels.iter().skip(1))
            .all(|(low, high)| low.up_to_m < high.up_to_m);
        let open = levels.last()?.up_to_m == f64::INFINITY;
        (grow && open).then_some(Self {
            levels,
            filters_by_miss_distance,
        })
    }

    /// Traffic advisories of TCAS II.
    pub fn traffic() -> Self {
        let levels = TABLE.map(|(up_to_ft, [tau_s, nmi, height_ft], _)| {
            Sensitivity::of(up_to_ft, tau_s, nmi, height_ft)
        });
        Self {
            levels: levels.into(),
            filters_by_miss_distance: false,
        }
    }

    /// Resolution advisories of TCAS II.
    pub fn resolution() -> Self {
        let levels = TABLE.map(
            |(up_to_ft, _, [tau_s, nmi, height_ft, miss_ft])| Sensitivity {
                miss_distance_m: miss_ft * FOOT_M,
                ..Sensitivity::of(up_to_ft, tau_s, nmi, height_ft)
            },
        );
        Self {
            levels: levels.into(),
            filters_by_miss_distance: true,
        }
    }

    /// The level at an altitude, metres.
    fn index_at(&self, altitude_m: f64) -> usize {
        self.levels
            .iter()
            .position(|level| altitude_m <= level.up_to_m)
            .unwrap_or(self.levels.len().saturating_sub(1))
    }

    /// The thresholds at an altitude, metres.
    pub fn at(&self, altitude_m: f64) -> Option<&Sensitivity> {
        self.levels.get(self.index_at(altitude_m))
    }

    /// Lower altitude limit of a level, metres.
    fn lower_bound_m(&self, index: usize) -> f64 {
        let below = self.levels.get(..index).unwrap_or_default();
        below
            .iter()
            .rev()
            .map(|level| level.up_to_m)
            .find(|altitude_m| *altitude_m != 0.0)
            .unwrap_or(0.0)
    }

    pub(super) fn violation(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        let (altitude_m, climb_mps) = (pair.ownship.position_m.z, pair.ownship.velocity_mps.z);
        let first = self.index_at(altitude_m + from_s * climb_mps);
        let last = self.index_at(altitude_m + to_s * climb_mps);
        if first == last || Closeness::Rounding.same(climb_mps, 0.0) {
            return self.level_violation(first, pair, from_s, to_s);
        }
        let mut found = Loss::NEVER;
        let mut begin_s = from_s;
        let climbs = first < last;
        let mut index = first;
        while begin_s < to_s {
            let bound_m = if climbs {
                self.levels
                    .get(index)
                    .map_or(f64::INFINITY, |level| level.up_to_m)
            } else {
                self.lower_bound_m(index)
            };
            let end_s = if bound_m.is_finite() {
                (bound_m - altitude_m) / climb_mps
            } else {
                f64::INFINITY
            };
            found = found.hull(self.level_violation(index, pair, begin_s, end_s.min(to_s)));
            begin_s = end_s;
            if index == last {
                break;
            }
            index = if climbs {
                index + 1
            } else {
                index.saturating_sub(1)
            };
        }
        found
    }

    /// The violation of one level's thresholds.
    fn level_violation(&self, index: usize, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        let none = Loss::NEVER;
        let Some(level) = self.levels.get(index) else {
            return none;
        };
        let (s, v) = pair.plane();
        let (height_m, climb_mps) = pair.vertical();
        if self.filters_by_miss_distance && !level.comes_within_miss(pair, from_s) {
            return none;
        }
        let level_flight =
            Closeness::Rounding.same(pair.ownship.velocity_mps.z, pair.intruder.velocity_mps.z);
        let vertical = if !level_flight {
            let entry_height_m = level.height_m.max(climb_mps.abs() * level.coaltitude_s);
            Loss::new(
                slab_crossing_s(height_m, climb_mps, entry_height_m, Crossing::Entry),
                slab_crossing_s(height_m, climb_mps, level.height_m, Crossing::Exit),
            )
        } else if height_m.abs() > level.height_m {
            return none;
        } else {
            Loss::new(from_s, to_s)
        };
        if vertical.exit_s < from_s || to_s < vertical.entry_s {
            return none;
        }
        let at_entry = s + v * vertical.entry_s;
        let leaves = at_entry.dot(v) >= 0.0;
        let misses = at_entry.length_squared() > level.miss_distance_m * level.miss_distance_m;
        let (begin_s, end_s) = (vertical.entry_s.max(from_s), vertical.exit_s.min(to_s));
        let plane = level.plane_window(pair, begin_s, end_s);
        let filters = self.filters_by_miss_distance && level.miss_distance_m < level.distance_m;
        if plane.entry_s > plane.exit_s
            || plane.exit_s < begin_s
            || plane.entry_s > end_s
            || (filters && leaves && misses)
        {
            return none;
        }
        let cut = |time_s: f64| time_s.min(end_s).max(begin_s);
        let mut exit_s = cut(plane.exit_s);
        if filters {
            let leaving_s = if v.length_squared() > 0.0 {
                circle_crossing_s(s, v, level.miss_distance_m, Crossing::Exit)
                    .map_or(f64::NEG_INFINITY, |time_s| time_s.min(to_s).max(from_s))
            } else {
                to_s
            };
            exit_s = exit_s.min(leaving_s);
        }
        Loss::new(cut(plane.entry_s), exit_s)
    }
}

impl Sensitivity {
    /// Thresholds in the units of the table, with the distance as miss distance.
    fn of(up_to_ft: f64, tau_s: f64, nmi: f64, height_ft: f64) -> Self {
        Self {
            up_to_m: up_to_ft * FOOT_M,
            tau_s,
            coaltitude_s: tau_s,
            distance_m: nmi * NAUTICAL_MILE_M,
            miss_distance_m: nmi * NAUTICAL_MILE_M,
            height_m: height_ft * FOOT_M,
        }
    }

    /// Whether the straight line is within the miss distance at or after a time.
    fn comes_within_miss(&self, pair: &Pair, after_s: f64) -> bool {
        let (s, v) = pair.plane();
        let (own, other) = (pair.ownship.velocity_mps, pair.intruder.velocity_mps);
        let reach_m = self.miss_distance_m;
        let exit_s = || circle_crossing_s(s, v, reach_m, Crossing::Exit);
        (same_velocity(own.truncate(), other.truncate()) && s.length_squared() <= reach_m * reach_m)
            || (v.length_squared() > 0.0
                && room(s, v, reach_m) >= 0.0
                && exit_s().is_some_and(|time_s| time_s >= after_s))
    }

    /// When distance or modified tau violate the thresholds, seconds from now.
    fn plane_window(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        let (s, v): (DVec2, DVec2) = pair.plane();
        let (own, other) = (pair.ownship.velocity_mps, pair.intruder.velocity_mps);
        let (square_m2, closing) = (s.length_squared(), s.dot(v));
        let speed2 = v.length_squared();
        let reach_m2 = self.distance_m * self.distance_m;
        if square_m2 <= reach_m2 {
            if same_velocity(own.truncate(), other.truncate()) {
                return Loss::new(from_s, to_s);
            }
            let exit = half_root(speed2, closing, square_m2 - reach_m2, Crossing::Exit);
            return Loss::new(from_s, exit.unwrap_or(f64::NEG_INFINITY));
        }
        let b = 2.0 * closing + self.tau_s * speed2;
        let c = square_m2 + self.tau_s * closing - reach_m2;
        if closing >= 0.0 || b * b - 4.0 * speed2 * c < 0.0 {
            return Loss::new(to_s + 1.0, 0.0);
        }
        let entry = root(speed2, b, c, Crossing::Entry);
        let exit = if room(s, v, self.distance_m) >= 0.0 {
            circle_crossing_s(s, v, self.distance_m, Crossing::Exit)
        } else {
            root(speed2, b, c, Crossing::Exit)
        };
        match (entry, exit) {
            (Some(entry_s), Some(exit_s)) => Loss::new(entry_s, exit_s),
            _ => Loss::NEVER,
        }
    }
}

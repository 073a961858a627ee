//! How far a manoeuvre departs from the mission, and which single turn departs least.

use fga_proof::Vec3;
use fga_proof::angle::Side;
use fga_proof::certificate::{Asked, MAX_HAZARDS, certify_set, mark_close};
use fga_proof::prediction::{MotionState, flown};

use super::front::Fronts;
use super::{Found, Objective, Search, Turns};

/// Starts that are compared, as shares of the time to the first entry.
const STARTS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// A start and a side each.
const PROSPECTS: usize = 2 * STARTS.len();

/// Obstacles are treated as passed after at most this long, s.
const LONGEST_PASS_S: f64 = 60.0;

/// Conflicts of which one unit of work tells when they have passed.
const PASSED: usize = 4;

/// Improving a certified manoeuvre may take one part in this many of the work that is left.
const IMPROVES: u32 = 8;

/// A start that may be better by no more than this is not looked at: a share, and turn radii.
const CLOSE: (f64, f64) = (0.02, 0.02);

/// The departure of a manoeuvre from the mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Distance from the mission when the last threatening obstacle has passed, metres.
    pub aside_m: f64,
    /// Its lag behind the mission at that time, metres.
    pub behind_m: f64,
}

impl Departure {
    /// Without work left to measure it: farther than any measured one.
    const UNKNOWN: Self = Self {
        aside_m: f64::MAX,
        behind_m: 0.0,
    };

    /// Its addition to the path until the aircraft is back, metres: a way back at a moderate
    /// intercept angle adds about a quarter of the distance.
    pub fn extra_path_m(&self) -> f64 {
        self.behind_m + 0.27 * self.aside_m
    }
}

impl Departure {
    /// Between where the aircraft is and where the mission would have brought it, on a mission's direction.
    fn between(offset_m: Vec3, along: Vec3) -> Self {
        let behind_m = -offset_m.dot(along);
        Self {
            aside_m: (offset_m + along * behind_m).length(),
            behind_m,
        }
    }

    /// What an objective counts, metres.
    pub(super) fn length_m(&self, objective: Objective) -> f64 {
        match objective {
            Objective::PaperCost => self.aside_m + self.extra_path_m(),
            Objective::LeastDeviation => self.aside_m,
            Objective::ShortestPath => self.extra_path_m(),
        }
    }
}

/// The hazards that come too close on the mission, and when each is closest, seconds.
#[derive(Debug)]
pub(super) struct Conflicts {
    all: [(usize, f64); MAX_HAZARDS],
    count: usize,
    is_known: bool,
}

impl Conflicts {
    /// Nothing known yet.
    pub(super) const UNKNOWN: Self = Self {
        all: [(0, 0.0); MAX_HAZARDS],
        count: 0,
        is_known: false,
    };
}

/// A start and a side, and about how far the cheapest turn departs, metres.
struct Prospect {
    fronts: [Fronts; 1],
    /// Infinite where there is none.
    departure_m: f64,
}

impl Prospect {
    const NONE: Self = Self {
        fronts: [Fronts::NONE],
        departure_m: f64::INFINITY,
    };
}

/// The prospect that seems to depart least, but for some that are passed over, and how far the next one seems to, metres.
fn next_of(prospects: &[Prospect; PROSPECTS], passed_over: usize) -> Option<(usize, f64)> {
    let mut place = 0;
    let mut order = prospects.each_ref().map(|prospect| {
        place += 1;
        (place - 1, prospect.departure_m)
    });
    order.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let is_left = |one: &&(usize, f64)| one.1 < f64::INFINITY;
    let left = order.iter().take_while(is_left).count();
    let first = passed_over.checked_rem(left)?;
    let (place, _) = *order.get(first)?;
    let next = order.get(first + 1);
    Some((place, next.map_or(f64::INFINITY, |next| next.1)))
}

impl Search<'_> {
    /// The cheapest certified single turn to each side, of several starts up to a first entry that which departs
    /// least; the side that departs least first.
    ///
    /// The lines on which turns end tell about how far each start and side would depart: the best is closed in on until
    /// another seems better, and only those are certified that could be better than what was. After searches that were `cut`
    /// it begins with another.
    pub fn least_departure(&mut self, entry_s: f64, cut: u32) -> [Option<Found>; 2] {
        let objective = self.scene.objective;
        if !self.meter.take_table::<[Prospect; PROSPECTS]>() {
            return [None; 2];
        }
        let mut prospects = [Prospect::NONE; PROSPECTS];
        for (share, pair) in STARTS.iter().zip(prospects.chunks_mut(2)) {
            let Some(entry) = self.entry(share * entry_s) else {
                continue;
            };
            for (side, prospect) in Side::BOTH.into_iter().zip(pair) {
                let [fronts] = &mut prospect.fronts;
                self.open(fronts, &entry, side);
                prospect.departure_m = self.departs_m(&mut prospect.fronts);
            }
        }
        self.improves_until = (self.meter.done()).saturating_add(self.meter.left() / IMPROVES);
        let mut best: [Option<(f64, Found)>; 2] = [None; 2];
        let slack_m = CLOSE.1 * self.scene.turn_radius_m();
        let enough_m = |departure_m: f64| departure_m + CLOSE.0 * departure_m.abs() + slack_m;
        let mut passed_over = cut as usize;
        while let Some((place, next_m)) = next_of(&prospects, passed_over) {
            passed_over = 0;
            if best.iter().any(Option::is_some) && self.is_good_enough() {
                break;
            }
            let Some(prospect) = prospects.get_mut(place) else {
                break;
            };
            let [Fronts { side, .. }] = prospect.fronts;
            let Some(best) = best.get_mut(usize::from(side == Side::Right)) else {
                break;
            };
            let least_m = best.map_or(f64::INFINITY, |(least_m, _)| least_m);
            if least_m <= enough_m(prospect.departure_m) {
                prospect.departure_m = f64::INFINITY;
                continue;
            }
            // What seems to depart more than another one is left for that.
            let most_m = enough_m(least_m.min(next_m));
            let mut left_m = f64::INFINITY;
            let found = self.cheapest_of(&mut prospect.fronts, |search, fronts| {
                let departure_m = search.departs_m(fronts);
                let goes_on = departure_m <= most_m;
                left_m = if goes_on { left_m } else { departure_m };
                goes_on
            });
            prospect.departure_m = left_m;
            let Some(found) = found else {
                continue;
            };
            let departure_m = self.departure_of(&found.turns).length_m(objective);
            if departure_m < least_m {
                *best = Some((departure_m, found));
            }
        }
        let [left, right] = best;
        let departure_m = |best: Option<(f64, Found)>| best.map_or(f64::INFINITY, |best| best.0);
        let ordered = if departure_m(right) < departure_m(left) {
            [right, left]
        } else {
            [left, right]
        };
        ordered.map(|best| best.map(|(_, found)| found))
    }

    /// Whether improving a certified manoeuvre ends.
    pub(super) const fn is_good_enough(&self) -> bool {
        self.meter.done() >= self.improves_until
    }

    /// About how far the cheapest turn of a front departs, metres; infinite where there is none.
    fn departs_m(&mut self, fronts: &mut [Fronts]) -> f64 {
        let objective = self.scene.objective;
        let Some(next) = self.next_ready(fronts, f64::INFINITY) else {
            return f64::INFINITY;
        };
        // What is cheapest by another objective lines do not tell.
        if objective != Objective::PaperCost {
            return f64::MIN;
        }
        let [Fronts { entry, .. }] = fronts else {
            return f64::MIN;
        };
        self.likely(entry, &next).map_or(f64::MIN, |tangent| {
            self.departure_on(entry.wait_s(), &tangent.state, tangent.velocity_mps)
                .length_m(objective)
        })
    }

    /// How far the line on which a turn ends departs from the mission until the obstacles have passed.
    pub(super) fn departure_on(
        &mut self,
        wait_s: f64,
        end: &MotionState,
        velocity_mps: Vec3,
    ) -> Departure {
        let until_s = self.passed_s(wait_s, end, velocity_mps);
        let there_m = end.position_m + velocity_mps * (until_s - end.time_s);
        self.departure_at(there_m, until_s)
    }

    /// How far a manoeuvre departs from the mission until the obstacles that it avoids have passed.
    pub fn departure_of(&mut self, turns: &Turns) -> Departure {
        if self.limit_met() {
            return Departure::UNKNOWN;
        }
        let scene = self.scene;
        let departure = self.departure(turns.wait_s);
        let maneuver = self.maneuver(turns, &departure);
        self.find_conflicts();
        self.predict(&maneuver);
        let last = self.path.nodes().last();
        let end = last.map_or(scene.start, |node| node.state);
        let until_s = self.passed_s(turns.wait_s, &end, self.path.end_velocity_mps());
        let there = self.path.state_at(scene.flyer, until_s);
        self.departure_at(there.unwrap_or(scene.start).position_m, until_s)
    }

    /// How far a place is from where the mission would have brought the aircraft by then.
    pub(super) fn departure_at(&self, there_m: Vec3, at_s: f64) -> Departure {
        let scene = self.scene;
        let planned = flown(scene.flyer, &scene.start, scene.nominal, at_s, &self.meter);
        Departure::between(there_m - planned.position_m, self.along)
    }

    /// When a manoeuvre that ends straight has passed what comes too close on the mission, seconds.
    fn passed_s(&mut self, wait_s: f64, end: &MotionState, end_velocity_mps: Vec3) -> f64 {
        self.find_conflicts();
        let conflicts = &self.conflicts;
        let mut until_s = wait_s;
        if !self.meter.take(conflicts.count.div_ceil(PASSED)) {
            return until_s;
        }
        for (place, closest_s) in conflicts.all.iter().take(conflicts.count) {
            let Some(hazard) = self.scene.hazards.rows().get(*place) else {
                continue;
            };
            let offset = end.position_m - hazard.position_after_m(end.time_s);
            let relative = end_velocity_mps - hazard.velocity_mps;
            let after_s = -offset.dot(relative) / relative.length_squared().max(1e-9);
            let passes_s = end.time_s + after_s.max(0.0);
            until_s = until_s.max(*closest_s).max(passes_s.min(LONGEST_PASS_S));
        }
        until_s
    }

    /// Finds what comes too close on the mission, once. Uses the path.
    fn find_conflicts(&mut self) {
        if self.conflicts.is_known || self.limit_met() {
            return;
        }
        self.conflicts.is_known = true;
        let scene = self.scene;
        self.predict(scene.nominal);
        let reach = (scene.horizon_s, scene.target_m);
        let marks = mark_close(scene.flyer, self.path, scene.hazards, reach, &self.meter);
        let asked = Asked {
            horizon_s: scene.horizon_s,
            floor_m: f64::MIN,
            enough_m: scene.target_m,
        };
        let rows = scene.hazards.rows().iter().zip(marks).enumerate();
        let conflicts = &mut self.conflicts;
        for (place, (hazard, _)) in rows.filter(|(_, (_, close))| *close) {
            if self.meter.is_met() {
                break;
            }
            let one = core::slice::from_ref(hazard);
            let closest = certify_set(scene.flyer, self.path, one, &asked, &self.meter);
            if closest.margin_m < scene.target_m
                && let Some(slot) = conflicts.all.get_mut(conflicts.count)
            {
                *slot = (place, closest.at_s);
                conflicts.count += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_prospect_is_next_and_those_passed_over_wait() {
        let mut prospects = [Prospect::NONE; PROSPECTS];
        assert_eq!(next_of(&prospects, 0), None);
        for (place, departure_m) in [(2, 30.0), (5, 10.0), (6, 20.0)] {
            prospects[place].departure_m = departure_m;
        }
        assert_eq!(next_of(&prospects, 0), Some((5, 20.0)));
        assert_eq!(next_of(&prospects, 1), Some((6, 30.0)));
        assert_eq!(next_of(&prospects, 2), Some((2, f64::INFINITY)));
        // Three are left: what would be passed over thrice is the first again.
        assert_eq!(next_of(&prospects, 3), Some((5, 20.0)));
    }
}

//! How far along its mission the aircraft is, how far beside it, and which waypoints it missed.
//!
//! The reference line is given: the path of the same mission without obstacles, as whoever flies it plans it.

use fga_proof::Vec3;

/// Distance between points of a planned line, metres.
pub const SPACING_M: f64 = 3.0;

/// A line that comes this near to a waypoint passes it there, as a share of its shorter leg: of laps each has its own passage.
const PASSES_WITHIN: f64 = 0.25;

/// A waypoint is missed when the aircraft passes it this much farther away than planned, metres.
const MISSED_BY_M: f64 = 5.0;

/// It has rejoined when it is this near, metres, and flies along the line.
const BACK_WITHIN_M: f64 = 10.0;

/// A missed waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MissedWaypoint {
    /// Its index in the mission.
    pub index: usize,
    /// Its position, metres.
    pub position_m: Vec3,
    /// Least distance of the aircraft from it, metres.
    pub distance_m: f64,
    /// The time of that distance, seconds.
    pub time_s: f64,
}

/// The passage of a waypoint.
#[derive(Debug, Clone, Copy)]
struct Passed {
    position_m: Vec3,
    /// The point on the line nearest to it, metres, and their distance.
    at_m: f64,
    planned_m: f64,
    /// Least distance of the aircraft while it is near this part of the line, and its time.
    flown_m: f64,
    time_s: f64,
    /// Least distance of the aircraft in the whole flight, and its time.
    nearest: (f64, f64),
    /// Whether the aircraft is as near as planned now.
    is_here: bool,
}

impl Passed {
    /// Whether a distance counts as a passage.
    fn is_near(&self, distance_m: f64) -> bool {
        distance_m <= self.planned_m + MISSED_BY_M
    }
}

/// Follows an aircraft along the line of its mission.
///
/// The present piece of the line advances to the next when the aircraft is nearer to that one
/// and has passed the first half of its own; it may skip one piece when the aircraft already
/// flies along the one after. Earlier pieces do not come back, so that neighbouring parallel legs are
/// not confused. The first and the last piece have no end.
#[derive(Debug, Clone)]
pub struct MissionProgress {
    line_m: Vec<Vec3>,
    waypoints: Vec<Passed>,
    /// Largest distance ahead at which the aircraft may rejoin the line, metres; 0 on a line of legs.
    ahead_m: f64,
    /// Index of the present leg.
    leg: usize,
    line: Option<MissionLeg>,
    /// Length of the earlier legs, metres.
    before_m: f64,
    along_m: f64,
    start_along_m: f64,
    cross_track_m: f64,
    max_cross_track_m: f64,
    /// The places since the aircraft left its line, each with the largest distance from the line up to there, metres.
    aside_m: Vec<(Vec3, f64)>,
    /// The place up to which the largest distance and the passed waypoints are recorded, metres, and how far along the mission it is.
    settled_m: (Vec3, f64),
    /// Whether that is the place that was followed last.
    is_settled: bool,
    /// The place that was followed last, metres, and its time, seconds.
    here: (Vec3, f64),
    /// Whether visits are noted: on a recorded track every row is a waypoint.
    notes_visits: bool,
    /// The waypoints that the aircraft came to, in order of time.
    visits: Vec<usize>,
}

/// A leg of positive length.
#[derive(Debug, Clone, Copy)]
struct MissionLeg {
    from_m: Vec3,
    direction: Vec3,
    length_m: f64,
    first: bool,
    last: bool,
}

impl MissionLeg {
    fn of(waypoints_m: &[Vec3], leg: usize) -> Option<Self> {
        let (from, to) = (*waypoints_m.get(leg)?, *waypoints_m.get(leg + 1)?);
        Some(Self {
            from_m: from,
            direction: (to - from).try_normalize()?,
            length_m: from.distance(to),
            first: leg == 0,
            last: leg + 2 == waypoints_m.len(),
        })
    }

    /// Distance along and beside the leg, metres.
    fn measure(&self, position_m: Vec3) -> (f64, f64) {
        let along = (position_m - self.from_m)
            .dot(self.direction)
            .max(if self.first { f64::NEG_INFINITY } else { 0.0 })
            .min(if self.last {
                f64::INFINITY
            } else {
                self.length_m
            });
        let foot_m = self.from_m + self.direction * along;
        (along, position_m.distance(foot_m))
    }
}

/// The point on a line of each waypoint, in order.
fn waypoints_on(line_m: &[Vec3], mission_m: &[Vec3]) -> Vec<Passed> {
    let mut along_m = 0.0;
    let mut places = Vec::with_capacity(line_m.len());
    for (index, place) in line_m.iter().enumerate() {
        if index > 0 {
            along_m += line_m[index - 1].distance(*place);
        }
        places.push((along_m, *place));
    }
    let mut from = 0;
    let row = |position_m: Vec3| Passed {
        position_m,
        at_m: 0.0,
        planned_m: 0.0,
        flown_m: f64::INFINITY,
        time_s: 0.0,
        nearest: (f64::INFINITY, 0.0),
        // The aircraft may begin where its mission ends.
        is_here: true,
    };
    let mut passed: Vec<Passed> = mission_m.iter().map(|place| row(*place)).collect();
    for (n, waypoint) in passed.iter_mut().enumerate() {
        let legs_m = mission_m[n.saturating_sub(1)..].windows(2).take(2);
        let shorter_m = legs_m
            .map(|leg| leg[0].distance(leg[1]))
            .fold(f64::INFINITY, f64::min);
        let near_m = (2.0 * SPACING_M).max(PASSES_WITHIN * shorter_m);
        // The first point from which the line leads away from it again.
        let mut best = (f64::INFINITY, from);
        for (index, pair) in places.windows(2).enumerate().skip(from) {
            let (a, b) = (pair[0].1, pair[1].1);
            let step = b - a;
            let share = share_of(waypoint.position_m - a, step);
            let distance_m = waypoint.position_m.distance(a + step * share);
            if distance_m < best.0 {
                best = (distance_m, index);
                waypoint.at_m = pair[0].0 + share * step.length();
            } else if best.0 < near_m && distance_m > best.0 + 2.0 * SPACING_M {
                break;
            }
        }
        waypoint.planned_m = best.0.min(1e9);
        from = best.1;
    }
    passed
}

/// Distance of an offset from a straight step, metres.
fn distance_m(offset_m: Vec3, step_m: Vec3) -> f64 {
    offset_m.distance(step_m * share_of(offset_m, step_m))
}

/// The share of a straight step at which it is nearest to an offset.
fn share_of(offset_m: Vec3, step_m: Vec3) -> f64 {
    let share = offset_m.dot(step_m) / step_m.length_squared().max(1e-12);
    share.clamp(0.0, 1.0)
}

impl MissionProgress {
    /// An aircraft at the start of a line that leads by waypoints; it may rejoin the line at a point this far ahead, metres.
    /// `notes_visits`: a waypoint that the aircraft comes to far from its place on the line counts as well.
    pub fn along(
        line_m: Vec<Vec3>,
        waypoints_m: &[Vec3],
        position_m: Vec3,
        ahead_m: f64,
        notes_visits: bool,
    ) -> Self {
        let waypoints = waypoints_on(&line_m, waypoints_m);
        let line = MissionLeg::of(&line_m, 0);
        let mut progress = Self {
            line_m,
            waypoints,
            ahead_m,
            leg: 0,
            line,
            before_m: 0.0,
            along_m: 0.0,
            start_along_m: 0.0,
            cross_track_m: 0.0,
            max_cross_track_m: 0.0,
            aside_m: Vec::new(),
            settled_m: (position_m, 0.0),
            is_settled: true,
            here: (position_m, 0.0),
            notes_visits: false,
            visits: Vec::new(),
        };
        progress.follow(0.0, position_m, None, || Vec3::ZERO);
        progress.start_along_m = progress.along_m;
        progress.notes_visits = notes_visits;
        progress
    }

    /// How far aside the line passes each waypoint, metres.
    pub fn planned_m(&self) -> impl Iterator<Item = f64> {
        self.waypoints.iter().map(|waypoint| waypoint.planned_m)
    }

    /// Updates with the aircraft's position and velocity over the ground, and the time since when it flies straight.
    ///
    /// Beside a single leg nothing can be largest or nearest between the first and the last place on a straight line, so that the
    /// places in between are not needed.
    pub fn follow(
        &mut self,
        time_s: f64,
        position_m: Vec3,
        straight_s: Option<f64>,
        velocity_mps: impl Fn() -> Vec3,
    ) {
        let goes_on = self.is_one_leg() && straight_s.is_some_and(|since_s| since_s <= self.here.1);
        if !goes_on {
            self.settle();
        }
        self.here = (position_m, time_s);
        self.is_settled = false;
        while let Some(line) = self.line {
            let (along, beside) = line.measure(position_m);
            self.along_m = self.before_m + along;
            self.cross_track_m = beside;
            if along <= 0.5 * line.length_m {
                break;
            }
            let nearer = |leg: &MissionLeg| leg.measure(position_m).1 < beside;
            let flies_along = |leg: &MissionLeg| {
                let velocity_mps = velocity_mps();
                velocity_mps.dot(leg.direction) > 0.8 * velocity_mps.length()
            };
            let after = |legs: usize| MissionLeg::of(&self.line_m, self.leg + legs);
            let next = after(1);
            if next.is_some_and(|leg| nearer(&leg)) {
                self.before_m += line.length_m;
                self.leg += 1;
                self.line = next;
            } else if let Some(second) = after(2).filter(|leg| nearer(leg) && flies_along(leg)) {
                self.before_m += line.length_m + self.length_m(self.leg + 1);
                self.leg += 2;
                self.line = Some(second);
            } else {
                break;
            }
        }
        if self.cross_track_m > BACK_WITHIN_M && self.ahead_m > 0.0 {
            self.look_ahead(position_m, velocity_mps());
        }
        if !goes_on {
            self.settle();
        }
    }

    /// Records the largest distance and the passed waypoints up to here.
    pub fn settle(&mut self) {
        if self.is_settled {
            return;
        }
        if self.notes_visits && !self.is_on_line() {
            let largest_m = self.max_aside_m().max(self.cross_track_m);
            self.aside_m.push((self.here.0, largest_m));
        } else {
            self.max_cross_track_m = self.max_cross_track_m().max(self.cross_track_m);
            self.aside_m.clear();
        }
        self.pass();
        self.settled_m = (self.here.0, self.along_m);
        self.is_settled = true;
    }

    /// Advances to a point of the line ahead along which the aircraft already flies.
    fn look_ahead(&mut self, position_m: Vec3, velocity_mps: Vec3) {
        let mut before_m = self.before_m;
        for index in self.leg.. {
            let Some(leg) = MissionLeg::of(&self.line_m, index) else {
                return;
            };
            if before_m - self.along_m > self.ahead_m {
                return;
            }
            let (along, beside) = leg.measure(position_m);
            let flies_along = velocity_mps.dot(leg.direction) > 0.9 * velocity_mps.length();
            if beside <= BACK_WITHIN_M && flies_along {
                self.rejoin(index);
                self.leg = index;
                self.line = Some(leg);
                self.before_m = before_m;
                self.along_m = before_m + along;
                self.cross_track_m = beside;
                return;
            }
            before_m += leg.length_m;
        }
    }

    /// The aircraft is back at a piece ahead and has left out the line in between. Up to one of its places the piece that was left
    /// counts, from there on those that lead to the piece ahead. That place is chosen by the least largest distance.
    fn rejoin(&mut self, mut leg: usize) {
        let (mut since, mut least) = (0.0_f64, self.max_aside_m());
        for (n, (place_m, _)) in self.aside_m.iter().enumerate().rev() {
            let until = n.checked_sub(1).map_or(0.0, |n| self.aside_m[n].1);
            let beside = |leg| {
                MissionLeg::of(&self.line_m, leg)
                    .map_or(f64::INFINITY, |leg| leg.measure(*place_m).1)
            };
            while leg > self.leg && beside(leg - 1) < beside(leg) {
                leg -= 1;
            }
            since = since.max(beside(leg));
            least = least.min(since.max(until));
        }
        self.max_cross_track_m = self.max_cross_track_m.max(least);
        self.aside_m.clear();
    }

    /// The flight is over: an aircraft that is at its last waypoint has come to the end of its line, though it came there off it.
    pub fn end(&mut self) {
        if self.is_on_line() || !self.is_at_end() {
            return;
        }
        self.rejoin(self.line_m.len().saturating_sub(2));
        let end_m = self.waypoints.last().map_or(0.0, |last| last.at_m);
        self.along_m = self.along_m.max(end_m);
    }

    /// Records the distances of the waypoints near here on the line.
    fn pass(&mut self) {
        let (from_m, before_m) = self.settled_m;
        let (here_m, time_s) = self.here;
        let step = here_m - from_m;
        self.visit(from_m, step, time_s);
        // The aircraft comes from the first one, which it cannot miss.
        for index in 1..self.waypoints.len() {
            let neighbour = |at: Option<usize>, none: f64| {
                at.and_then(|at| self.waypoints.get(at))
                    .map_or(none, |waypoint| waypoint.at_m)
            };
            let begins_m = neighbour(index.checked_sub(1), f64::NEG_INFINITY);
            if begins_m > self.along_m {
                break;
            }
            let ends_m = neighbour(Some(index + 1), f64::INFINITY);
            if ends_m < before_m {
                continue;
            }
            if let Some(waypoint) = self.waypoints.get_mut(index) {
                let distance_m = distance_m(waypoint.position_m - from_m, step);
                if distance_m < waypoint.flown_m {
                    waypoint.flown_m = distance_m;
                    waypoint.time_s = time_s;
                }
            }
        }
    }

    /// Notes how near the aircraft comes to each waypoint, and which ones it visits, wherever it is along the line: an aircraft that
    /// leaves its mission far behind is near none of the line.
    fn visit(&mut self, from_m: Vec3, step: Vec3, time_s: f64) {
        for (index, waypoint) in self.waypoints.iter_mut().enumerate().skip(1) {
            let distance_m = distance_m(waypoint.position_m - from_m, step);
            if distance_m < waypoint.nearest.0 {
                waypoint.nearest = (distance_m, time_s);
            }
            if !self.notes_visits {
                continue;
            }
            let is_here = waypoint.is_near(distance_m);
            if is_here && !waypoint.is_here {
                self.visits.push(index);
            }
            waypoint.is_here = is_here;
        }
    }

    /// The longest sequence of visits in the order of the mission; waypoints outside of it are not visited.
    fn visited(&self) -> Vec<usize> {
        // The best sequence that ends with each visit: its length, and the visit before.
        let mut best: Vec<(usize, Option<usize>)> = Vec::with_capacity(self.visits.len());
        for (place, index) in self.visits.iter().enumerate() {
            let before = (0..place)
                .filter(|before| self.visits[*before] < *index)
                .max_by_key(|before| (best[*before].0, core::cmp::Reverse(*before)));
            best.push((1 + before.map_or(0, |before| best[before].0), before));
        }
        let mut at =
            (0..best.len()).max_by_key(|place| (best[*place].0, core::cmp::Reverse(*place)));
        let mut visited = Vec::new();
        while let Some(place) = at {
            visited.push(self.visits[place]);
            at = best[place].1;
        }
        visited.reverse();
        visited
    }

    /// The waypoints that the aircraft left behind farther away than planned. `is_over`: the aircraft does not fly on, so
    /// that what it has not come to is missed.
    pub fn missed(&self, is_over: bool) -> Vec<MissedWaypoint> {
        let visited = self.visited();
        let last = visited.last().copied().unwrap_or(0);
        self.waypoints
            .iter()
            .enumerate()
            .skip(1)
            .filter(|(index, waypoint)| {
                let is_behind = waypoint.at_m <= self.along_m + MISSED_BY_M;
                let is_left = *index < last || is_over;
                !waypoint.is_near(waypoint.flown_m)
                    && (is_behind || is_left && !visited.contains(index))
            })
            .map(|(index, waypoint)| {
                let (distance_m, time_s) = if waypoint.flown_m.is_finite() {
                    (waypoint.flown_m, waypoint.time_s)
                } else {
                    waypoint.nearest
                };
                MissedWaypoint {
                    index,
                    position_m: waypoint.position_m,
                    distance_m,
                    time_s,
                }
            })
            .collect()
    }

    /// Flies straight on while the last command is under way, which counts for the last waypoint alone.
    pub fn coast(&mut self, step_m: Vec3) {
        let here_m = self.here.0;
        if let Some(last) = self.waypoints.last_mut() {
            let distance_m = distance_m(last.position_m - here_m, step_m);
            last.flown_m = last.flown_m.min(distance_m);
        }
    }

    /// Whether the aircraft came to the last waypoint, by its track.
    pub fn is_at_end(&self) -> bool {
        let last = self.waypoints.len().saturating_sub(1);
        self.waypoints
            .last()
            .is_some_and(|waypoint| waypoint.is_near(waypoint.flown_m))
            || self.visited().last() == Some(&last)
    }

    /// Whether the aircraft flies along its line, by its track.
    pub fn is_on_line(&self) -> bool {
        self.cross_track_m <= BACK_WITHIN_M
    }

    fn length_m(&self, leg: usize) -> f64 {
        MissionLeg::of(&self.line_m, leg).map_or(0.0, |leg| leg.length_m)
    }

    /// Present distance from the mission, metres.
    pub fn cross_track_m(&self) -> f64 {
        self.cross_track_m
    }

    /// Whether its line is a single leg.
    pub fn is_one_leg(&self) -> bool {
        self.line_m.len() == 2
    }

    /// Largest distance from the mission so far, metres.
    pub fn max_cross_track_m(&self) -> f64 {
        self.max_cross_track_m.max(self.max_aside_m())
    }

    /// Largest distance since the aircraft left its line, metres.
    fn max_aside_m(&self) -> f64 {
        self.aside_m.last().map_or(0.0, |(_, largest_m)| *largest_m)
    }

    /// Progress along the mission since the start, metres.
    pub fn along_m(&self) -> f64 {
        self.along_m - self.start_along_m
    }

    /// Direction of the present leg.
    pub fn direction(&self) -> Vec3 {
        self.line.map_or(Vec3::X, |leg| leg.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along_legs(waypoints_m: &[Vec3]) -> MissionProgress {
        MissionProgress::along(waypoints_m.to_vec(), waypoints_m, Vec3::ZERO, 0.0, false)
    }

    #[test]
    fn progress_follows_the_legs() {
        let mission = [
            Vec3::ZERO,
            Vec3::new(100.0, 0.0, 0.0),
            Vec3::new(100.0, 40.0, 0.0),
            Vec3::new(0.0, 40.0, 0.0),
        ];
        let mut progress = along_legs(&mission);
        progress.follow(0.0, Vec3::new(30.0, 25.0, 0.0), None, || Vec3::X);
        // Nearer to the third leg, but on the first.
        assert_eq!((progress.along_m(), progress.cross_track_m()), (30.0, 25.0));
        progress.follow(0.0, Vec3::new(98.0, 10.0, 0.0), None, || Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (110.0, 2.0));
        progress.follow(0.0, Vec3::new(50.0, 41.0, 0.0), None, || Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (190.0, 1.0));
        progress.follow(0.0, Vec3::new(-50.0, 40.0, 0.0), None, || Vec3::X);
        assert_eq!(progress.along_m(), 290.0);
        assert_eq!(progress.max_cross_track_m(), 25.0);
    }

    #[test]
    fn a_short_leg_may_be_left_out() {
        let mission = [
            Vec3::ZERO,
            Vec3::new(100.0, 0.0, 0.0),
            Vec3::new(100.0, 40.0, 0.0),
            Vec3::new(0.0, 40.0, 0.0),
        ];
        let mut progress = along_legs(&mission);
        // Abreast of the third leg, but not along it: still on the first.
        progress.follow(0.0, Vec3::new(60.0, 30.0, 0.0), None, || Vec3::X);
        assert_eq!(progress.cross_track_m(), 30.0);
        progress.follow(0.0, Vec3::new(60.0, 39.0, 0.0), None, || -Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (180.0, 1.0));
    }

    /// A flight that ends beside the beginning of its line comes to no waypoint, and has a distance from each.
    #[test]
    fn a_waypoint_that_is_never_come_to_has_its_nearest_distance() {
        let mission = [0.0, 100.0, 200.0, 300.0].map(|x_m| Vec3::new(x_m, 0.0, 0.0));
        let mut progress = along_legs(&mission);
        progress.follow(1.0, Vec3::new(20.0, 0.0, 0.0), None, || Vec3::X);
        progress.follow(2.0, Vec3::new(20.0, 50.0, 0.0), None, || Vec3::Y);
        let missed = progress.missed(true);
        let all = missed
            .iter()
            .map(|one| (one.index, one.distance_m, one.time_s));
        assert_eq!(
            all.collect::<Vec<_>>(),
            [(1, 80.0, 1.0), (2, 180.0, 1.0), (3, 280.0, 1.0)]
        );
    }

    /// Out to 300 m and back 30 m beside it, of which the last 200 m are left out: the way back is measured from the leg back.
    #[test]
    fn what_is_left_out_of_the_line_is_no_distance_from_it() {
        let line = [(0.0, 0.0), (300.0, 0.0), (300.0, 30.0), (0.0, 30.0)];
        let mission = line.map(|(x_m, y_m)| Vec3::new(x_m, y_m, 0.0));
        let follow = |last: (Vec3, Vec3)| {
            let mut progress =
                MissionProgress::along(mission.to_vec(), &mission, Vec3::ZERO, 1000.0, true);
            for (x_m, y_m, velocity) in [
                (90.0, 0.0, Vec3::X),
                (90.0, 40.0, Vec3::Y),
                (50.0, 60.0, Vec3::NEG_X),
            ] {
                progress.follow(0.0, Vec3::new(x_m, y_m, 0.0), None, || velocity);
            }
            assert_eq!(progress.max_cross_track_m(), 60.0);
            progress.follow(0.0, last.0, None, || last.1);
            progress.end();
            (progress.max_cross_track_m(), progress.along_m())
        };
        let along_the_leg = (Vec3::new(10.0, 30.0, 0.0), Vec3::NEG_X);
        assert_eq!(follow(along_the_leg), (30.0, 620.0));
        // Its end, which it comes to from beside.
        let across = (Vec3::new(0.0, 30.0, 0.0), Vec3::NEG_Y);
        assert_eq!(follow(across), (30.0, 630.0));
    }
}

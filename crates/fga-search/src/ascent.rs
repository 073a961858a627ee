//! Climbing from a manoeuvre to one nearby with a larger margin.
//!
//! Near a manoeuvre the margin of each obstacle is linear in the parameters, with the slope of the
//! position at the moment of the closest approach. The step in a box that lifts the least of the
//! margins most is a small linear program; the box shrinks where the truth falls short of it.

mod linear;
mod moves;

use fga_proof::certificate::{Hazard, Line, Obstruction as _};

use super::climbs::{Approach, Approaches, Ascent, CLOSEST, PARAMETERS, Seed, Vector, scales};
use super::{Found, MAX_TURN_RAD, Scene, Search, SecondTurn, Turns};

use linear::{Margin, lifted};
use moves::Moves;

/// Obstacles farther than the closest one by this do not matter to a climb, turn radii.
const NEAR: f64 = 1.3;

/// Step of the differences, in units of the natural steps.
const DIFFERENCE: f64 = 1e-4;

/// The work of the linear program, for each obstacle.
const PROGRAM_WORK: usize = 8;

/// The work of the slopes, beyond one unit for each obstacle.
const SLOPES_WORK: usize = 30;

/// The largest box of a step, in units of the natural steps.
const LARGEST_BOX: f64 = 2.0;

/// A climb with a smaller gain than this is over, metres.
const LEAST_GAIN_M: f64 = 2e-3;

/// So is one with a smaller gain than this share of what is missing.
const LEAST_SHARE: f64 = 0.005;

impl Ascent {
    /// Climbs some steps, until it is above the target, no longer rises, or meets the limit of work.
    pub(super) fn climb(&mut self, search: &mut Search<'_>, steps: u32) {
        if self.done {
            return;
        }
        self.find_closest(search);
        // Certified margins are a little less than these.
        let enough_m = search.scene.target_m + LEAST_GAIN_M;
        for _ in 0..steps {
            if self.done || self.least_m() >= enough_m || search.limit_met() {
                return;
            }
            self.step(search);
        }
    }

    /// The result, certified.
    pub(super) fn certified(&self, search: &mut Search<'_>, seed: &Seed) -> Found {
        // Without work left to prove it: its seed, with the seed's margin.
        let seed = Found {
            turns: seed.turns,
            margin_m: seed.margin_m.min(search.scene.target_m - LEAST_GAIN_M),
            cost: 0.0,
        };
        if search.limit_met() {
            return seed;
        }
        let turns = self.turns(&self.at);
        let from_rad = search.departure(turns.wait_s).course_rad;
        let certificate = search.certify(&turns, from_rad, f64::MIN);
        let proven_m = certificate.proven_m();
        if proven_m == f64::NEG_INFINITY && search.limit_met() {
            return seed;
        }
        Found {
            turns,
            margin_m: proven_m,
            cost: search.cost(&turns, from_rad),
        }
    }

    /// One step uphill.
    #[inline(never)]
    fn step(&mut self, search: &mut Search<'_>) {
        let scales = scales(search.scene.flyer);
        let mut margins = [Margin::NONE; CLOSEST];
        self.slopes(search, &scales, &mut margins);
        let margins = margins.get(..self.approaches.len()).unwrap_or(&[]);
        self.rise(search, margins, &scales);
    }

    /// A step in a box that shrinks until it goes up.
    #[inline(never)]
    fn rise(&mut self, search: &mut Search<'_>, margins: &[Margin], scales: &Vector) {
        let here_m = self.least_m();
        loop {
            let (step, lifted_m) = self.best_step(search, margins, scales);
            let promised_m = lifted_m - here_m;
            let least_m = LEAST_GAIN_M.max(LEAST_SHARE * (search.scene.target_m - here_m));
            if promised_m < least_m || search.limit_met() {
                self.done = true;
                return;
            }
            let mut tried = self.at;
            for ((x, step), scale) in tried.iter_mut().zip(step).zip(scales) {
                *x += step * scale;
            }
            search.evaluated += 1;
            let places = self.approaches.iter().map(|(place, _)| place);
            let there = self.look(search, &tried, places);
            let gained_m = (there.as_ref()).map_or(f64::MIN, |there| there.closest_m() - here_m);
            if let Some(there) = there
                && gained_m > 0.1 * promised_m
            {
                (self.at, self.approaches) = (tried, there);
                if gained_m > 0.5 * promised_m {
                    self.size = (2.0 * self.size).min(LARGEST_BOX);
                }
                return;
            }
            self.size *= 0.35;
        }
    }

    fn turns(&self, at: &Vector) -> Turns {
        let [wait_s, turn_rad, climb_rad, after_s, turn2_rad, climb2_rad] = *at;
        let second = (usize::from(self.used) == PARAMETERS).then_some(SecondTurn {
            after_s,
            turn_rad: turn2_rad,
            climb_rad: climb2_rad,
        });
        Turns {
            wait_s,
            turn_rad,
            climb_rad,
            second,
        }
    }

    /// Notes the closest obstacles now.
    #[inline(never)]
    fn find_closest(&mut self, search: &mut Search<'_>) {
        let all = (0..).take(search.scene.around.rows.len());
        let Some(closest) = self.look(search, &self.at, all) else {
            self.done = true;
            return;
        };
        let near_m = closest.closest_m() + NEAR * search.scene.turn_radius_m();
        self.approaches = Approaches::NONE;
        for (place, approach) in closest.iter().filter(|(_, it)| it.margin_m < near_m) {
            self.approaches.note(place, *approach);
        }
    }

    /// The approaches of the obstacles at some places with other parameters; `None` if the path is not predicted to its end, or the
    /// limit of work is met.
    #[inline(never)]
    fn look(
        &self,
        search: &mut Search<'_>,
        at: &Vector,
        places: impl Iterator<Item = u8>,
    ) -> Option<Approaches> {
        if !predict(search, &self.turns(at)) {
            return None;
        }
        let hazards = search.scene.around.rows;
        let mut approaches = Approaches::NONE;
        for place in places {
            let hazard = hazards.get(usize::from(place));
            if let Some(approach) = hazard.and_then(|hazard| nearest(search, hazard)) {
                approaches.note(place, approach);
            }
        }
        (!search.limit_met()).then_some(approaches)
    }

    /// The margin of each approach and its slope in each parameter, per natural step: that of the distance at the closest approach. The
    /// search's path is the flight from here.
    #[inline(never)]
    fn slopes(&self, search: &Search<'_>, scales: &Vector, margins: &mut [Margin; CLOSEST]) {
        let Scene { flyer, around, .. } = search.scene;
        for (margin, (_, known)) in margins.iter_mut().zip(self.approaches.iter()) {
            margin.now_m = known.margin_m;
        }
        if !search.meter.take(SLOPES_WORK + self.approaches.len()) {
            return;
        }
        let turns = self.turns(&self.at);
        let departure = search.departure(turns.wait_s);
        let moves = Moves::new(flyer, &departure, &turns, search.path);
        for (margin, (place, known)) in margins.iter_mut().zip(self.approaches.iter()) {
            let hazard = around.rows.get(usize::from(place));
            let now = search.path.state_at(flyer, known.at_s);
            let (Some(hazard), Some(now)) = (hazard, now) else {
                continue;
            };
            let moves = moves.at(&now);
            let slopes = margin.slope.iter_mut().take(self.used.into());
            for ((slope, move_m), scale) in slopes.zip(moves).zip(scales) {
                let moved_m = known.position_m + move_m * (DIFFERENCE * scale);
                let margin_m = hazard.margin_m(moved_m, known.at_s);
                *slope = (margin_m - known.margin_m) / DIFFERENCE;
            }
        }
    }

    /// The step within the box and the bounds that lifts the least margin most, to first order, and that margin.
    #[inline(never)]
    fn best_step(&self, search: &Search<'_>, margins: &[Margin], scales: &Vector) -> (Vector, f64) {
        if !search.meter.take(PROGRAM_WORK * margins.len()) {
            return ([0.0; PARAMETERS], self.least_m());
        }
        let bounds = bounds(search.scene.climb_limits_rad);
        let mut room = [(0.0, 0.0); PARAMETERS];
        let places = bounds.iter().zip(self.at.iter().zip(scales));
        for (room, ((low, high), (x, scale))) in room.iter_mut().zip(places) {
            let down = ((low - x) / scale).max(-self.size).min(0.0);
            let up = ((high - x) / scale).min(self.size).max(0.0);
            *room = (down, up);
        }
        lifted(margins, &room)
    }
}

/// Predicts a manoeuvre into the search's path; returns whether it is complete.
fn predict(search: &mut Search<'_>, turns: &Turns) -> bool {
    search.predict(turns, search.departure(turns.wait_s).course_rad);
    search.path.is_complete()
}

/// The closest approach to a hazard along the path: on its chords, then on the flight itself.
fn nearest(search: &Search<'_>, hazard: &Hazard) -> Option<Approach> {
    let scene = search.scene;
    let meter = &search.meter;
    if !meter.take(1 + search.path.nodes().len() / 2) {
        return None;
    }
    let mut least = (f64::INFINITY, 0.0);
    let mut look = |line: &Line| {
        if line.duration_s > 0.0
            && let Some(found) = hazard.least_on_line(line, least.0, meter)
        {
            least = found;
        }
    };
    let nodes = search.path.nodes();
    for pair in nodes.windows(2) {
        let [node, next] = pair else { continue };
        let (from, to) = (&node.state, &next.state);
        let duration_s = to.time_s - from.time_s;
        look(&Line::over(
            (from.position_m, to.position_m),
            from.time_s,
            duration_s,
        ));
    }
    look(&search.path.end_line(scene.horizon_s)?);
    if least.0 == f64::INFINITY {
        return None;
    }
    let at_s = least.1;
    let state = search.path.state_at(scene.flyer, at_s)?;
    Some(Approach {
        position_m: state.position_m,
        margin_m: hazard.margin_m(state.position_m, at_s),
        at_s,
    })
}

/// The least and largest value of each parameter.
fn bounds(climb: (f64, f64)) -> [(f64, f64); PARAMETERS] {
    let turn = (-MAX_TURN_RAD, MAX_TURN_RAD);
    let time = (0.0, 1e3);
    [time, turn, climb, time, turn, climb]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scene;
    use crate::{Tables, climbs::Climbs};
    use fga_mission::Turner;
    use fga_proof::Vec3;
    use fga_proof::maneuver::Maneuver;
    use fga_proof::meter::Meter;
    use fga_proof::prediction::{FlightPath, MotionState};
    use fga_proof::situation::ProtectedVolume;
    use fga_proof::vehicle::Vehicle;

    /// A climb from a single turn beside a sphere of 30 m that is 200 m ahead, to the left by some metres.
    fn climb_from<T>(
        turn_rad: f64,
        left_m: f64,
        act: impl Fn(&mut Ascent, &mut Search<'_>) -> T,
    ) -> T {
        let vehicle = Vehicle::lagged(0.0);
        let flyer = Turner::new(&vehicle);
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let at_m = Vec3::new(200.0, left_m, 0.0);
        let hazards = [Hazard::exact(0, at_m, Vec3::ZERO, volume)];
        let nominal = Maneuver::hold();
        let now = (MotionState::ahead(0.0), &nominal);
        let scene = scene(&flyer, &vehicle, now, &hazards);
        let mut climbs = Climbs::NONE;
        climbs.clear(0);
        let turns = Turns {
            wait_s: 0.0,
            turn_rad,
            climb_rad: 0.0,
            second: None,
        };
        climbs.take(Seed {
            turns,
            margin_m: 0.0,
        });
        climbs.begin(&Meter::unlimited());
        let (mut path, mut tables) = (FlightPath::new(), Tables::NONE);
        let mut search = Search::new(
            &scene,
            (&mut path, &mut tables),
            Meter::new(100_000, u32::MAX),
        );
        let [first, ..] = &mut climbs.climbers;
        act(first, &mut search)
    }

    /// By hand: a turn by 0.2 rad to the left leads 40 m nearer to a sphere 200 m ahead and to the left, later or higher it is as far.
    #[test]
    fn a_slope_is_what_a_natural_step_does_to_the_margin() {
        let margins = climb_from(0.0, 70.0, |climb, search| {
            climb.find_closest(search);
            let mut margins = [Margin::NONE; CLOSEST];
            climb.slopes(search, &scales(search.scene.flyer), &mut margins);
            margins
        });
        let [Margin { now_m, slope }, ..] = margins;
        assert!((now_m - 40.0).abs() < 1e-6, "{now_m}");
        let [wait, turn, climb, ..] = slope;
        assert!((turn + 40.0).abs() < 0.1, "{turn}");
        assert!(wait.abs() < 0.01 && climb.abs() < 0.01, "{slope:?}");
    }

    #[test]
    fn a_climb_ends_where_the_sphere_is_passed() {
        let (least_m, target_m) = climb_from(-0.05, 5.0, |climb, search| {
            climb.climb(search, 16);
            (climb.least_m(), search.scene.target_m)
        });
        assert!(least_m >= target_m, "{least_m}");
    }
}

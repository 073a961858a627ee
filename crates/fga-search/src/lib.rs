//! The search: which of the manoeuvres that the aircraft can fly is worth proving.
//!
//! All manoeuvres are members of one family ([`Turns`]): a wait on the mission, a turn with a climb, a gap, a second turn with
//! a climb. A *row* (`rows`) is all members that differ only in the last turn. The line on which a turn ends shows cheaply
//! whether it may stay clear and rules out its neighbours (`line`); best first, the rows yield the cheapest certified member
//! (`cheapest`). Where none is certified, the rows yield seeds, and small linear programs lift the least margin
//! (`largest`, `ascent`). All that the search returns is certified as flown.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

#[cfg(test)]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod ascent;
mod cheapest;
mod climbs;
mod departure;
mod largest;
mod lattice;
mod line;
mod rows;
mod terms;
mod tuned;

pub use terms::{Departure, Found, MAX_TURN_RAD, Objective, Outcome, SecondTurn, Side, Turns};
pub use tuned::PARTS as GRIDS_A_SEARCH;

use climbs::Climbs;
use lattice::Lattice;
use terms::ENOUGH_M;

use fga_mission::{Bend, Turner};
use fga_proof::Vec3;
use fga_proof::angle::direction;
use fga_proof::assumptions::{Assumptions, MAX_HAZARDS};
use fga_proof::certificate::{Closest, certify_set};
use fga_proof::command::{Command, Terms};
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, MotionState, flown};

/// A search keeps one part in this many of its work for the certificate of its answer.
const ANSWER_SHARE: u32 = 16;

/// The input of a search.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The vehicle's motion and turns.
    pub flyer: &'a Turner,
    /// The aircraft now.
    pub start: MotionState,
    /// The command without avoidance.
    pub nominal: &'a Maneuver,
    /// Course and climb angle from which deviations count, `ψ_ori` and `θ_ori`, radians.
    pub original: (f64, f64),
    /// The obstacles, zones and ground.
    pub around: Assumptions<'a>,
    /// Horizon of the certificate, seconds.
    pub horizon_s: f64,
    /// Separation beyond the volumes that a certified manoeuvre keeps, metres.
    pub target_m: f64,
    /// Steepest descent and climb, radians.
    pub climb_limits_rad: (f64, f64),
    /// `η_ψ` and `η_θ`, per radian.
    pub costs: (f64, f64),
    /// The measure of the cheapest manoeuvre.
    pub objective: Objective,
}

impl Scene<'_> {
    /// `η_ψ` |ψ − `ψ_ori`| + `η_θ` |θ − `θ_ori`| for a turn from `course_rad` (Alg. 2 line 20).
    fn cost(&self, course_rad: f64, climb_rad: f64) -> f64 {
        self.costs.0 * (course_rad - self.original.0).abs()
            + self.costs.1 * (climb_rad - self.original.1).abs()
    }

    /// Radius of the tightest real turn, metres.
    fn turn_radius_m(&self) -> f64 {
        self.flyer.turn_radius_m()
    }

    /// Climb targets: the original, then in equal steps up and down to the steepest ones, as far as they differ.
    fn climbs(&self, steps: usize) -> impl Iterator<Item = f64> + Clone + use<> {
        let (low, high) = self.climb_limits_rad;
        let original = self.original.1.limited(low, high);
        let limits = [high, low]
            .into_iter()
            .filter(move |limit| *limit != original);
        let aside = (0..steps).rev().flat_map(move |left| {
            let share = left as f64 / steps as f64;
            limits
                .clone()
                .map(move |limit| limit + share * (original - limit))
        });
        core::iter::once(original).chain(aside)
    }

    /// The few climb targets that matter for the largest margin: original, steepest up and down.
    fn extreme_climbs(&self) -> impl Iterator<Item = f64> + Clone + use<> {
        self.climbs(1)
    }
}

/// The hazards that come too close on the mission.
#[derive(Debug, Clone)]
struct Conflicts {
    marks: [bool; MAX_HAZARDS],
    /// When the last of them is closest, seconds.
    closest_s: f64,
    is_known: bool,
}

impl Conflicts {
    /// Nothing known yet.
    const UNKNOWN: Self = Self {
        marks: [false; MAX_HAZARDS],
        closest_s: 0.0,
        is_known: false,
    };
}

/// The rows of a search, or the seeds and climbs of one for the largest margin: in one place, because no search needs both at once.
#[derive(Debug, Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "the smaller one lies in the place of the larger one"
)]
enum Board {
    Lattice(Lattice),
    Climbs(Climbs),
}

impl Board {
    fn lattice(&mut self) -> Option<&mut Lattice> {
        if matches!(self, Self::Climbs(_)) {
            *self = Self::Lattice(Lattice::NONE);
        }
        let Self::Lattice(lattice) = self else {
            return None;
        };
        Some(lattice)
    }

    fn climbs(&mut self) -> Option<&mut Climbs> {
        if matches!(self, Self::Lattice(_)) {
            *self = Self::Climbs(Climbs::NONE);
        }
        let Self::Climbs(climbs) = self else {
            return None;
        };
        Some(climbs)
    }
}

/// The tables of searches: large, and zeros, so keep and reuse them.
#[derive(Debug, Clone)]
pub struct Tables {
    board: Board,
    bends: [Bend; 4],
    conflicts: Conflicts,
    /// The manoeuvre that was laid last: that of an answer.
    pub answer: Command,
}

impl Tables {
    /// With nothing in them.
    pub const NONE: Self = Self {
        // The larger variant makes all bytes zeros: the constant then takes no flash.
        board: if size_of::<Lattice>() > size_of::<Climbs>() {
            Board::Lattice(Lattice::NONE)
        } else {
            Board::Climbs(Climbs::NONE)
        },
        bends: [Bend::NONE; 4],
        conflicts: Conflicts::UNKNOWN,
        answer: Command::hold(),
    };

    /// Forgets the turns of a vehicle: before another one, or another step, flies.
    pub fn forget_turns(&mut self) {
        self.bends.iter_mut().for_each(Bend::clear);
    }
}

/// The scratch space of a search.
type Space<'a> = (&'a mut FlightPath, &'a mut Tables);

/// A search in progress: the scene, scratch space and a count of the work.
#[derive(Debug)]
pub struct Search<'a> {
    scene: &'a Scene<'a>,
    path: &'a mut FlightPath,
    /// Manoeuvres evaluated so far.
    pub evaluated: u32,
    /// Parts of the two-turn rows that it has begun, at least one once they were asked for.
    pub grids: u32,
    meter: Meter,
    /// Whether the reserve of work for the answer is in use.
    answering: bool,
    /// The hazard that decided last: checked first, because it decides most often again.
    culprit: usize,
    /// Not there while it is used.
    board: Option<&'a mut Board>,
    /// Turns to the left and to the right from the bank at the start, and from the banks that were looked at last.
    bends: &'a mut [Bend; 4],
    /// What comes too close on the mission, once that was asked.
    conflicts: &'a mut Conflicts,
    /// The manoeuvre that was laid last.
    maneuver: &'a mut Command,
    /// The mission's direction.
    along: Vec3,
}

impl<'a> Search<'a> {
    /// A search that ends at the limit of a meter, and takes no more than that has.
    pub fn new(scene: &'a Scene<'a>, (path, tables): Space<'a>, meter: Meter) -> Self {
        meter.reserve(ANSWER_SHARE);
        let Tables {
            board,
            bends,
            conflicts,
            answer,
        } = tables;
        *conflicts = Conflicts::UNKNOWN;
        Self {
            scene,
            path,
            evaluated: 0,
            grids: 0,
            meter,
            answering: false,
            culprit: 0,
            board: Some(board),
            bends,
            conflicts,
            maneuver: answer,
            along: direction(scene.original.0, scene.original.1),
        }
    }

    /// Work done so far, in tests of a line against four obstacles.
    pub const fn work(&self) -> u32 {
        self.meter.done()
    }

    /// Leaves all but one part of the work to other searches of the step.
    pub fn share_work(&mut self, parts: u32) {
        self.meter.share(parts);
    }

    /// Whether work was refused: then it has no answer.
    pub const fn is_spent(&self) -> bool {
        self.meter.is_spent()
    }

    /// Whether the limit of work was met.
    pub const fn limit_met(&self) -> bool {
        self.meter.is_met()
    }

    /// Looks for something on the board, whose filling takes some work; finds none if the meter refuses that.
    fn on_board<T: Default>(
        &mut self,
        work: usize,
        look: impl FnOnce(&mut Self, &mut Board) -> T,
    ) -> T {
        let is_given = self.meter.take(work);
        let Some(board) = self.board.take().filter(|_| is_given) else {
            return T::default();
        };
        let answer = look(self, board);
        self.board = Some(board);
        answer
    }

    /// Releases the reserve of work for the answer.
    fn answer(&mut self) {
        if !self.answering {
            self.answering = true;
            self.meter.extend(ANSWER_SHARE);
        }
    }

    /// Lays a manoeuvre and predicts it into the path.
    fn predict(&mut self, turns: &Turns, from_rad: f64) {
        self.lay(turns, from_rad);
        let scene = self.scene;
        let (flyer, start, meter) = (scene.flyer, &scene.start, &self.meter);
        self.path
            .predict_within(flyer, start, self.maneuver, scene.horizon_s, meter);
    }

    /// Certifies the path up to a moment.
    fn certify_path(&self, horizon_s: f64, (floor_m, enough_m): (f64, f64)) -> Closest {
        let asked = (horizon_s, floor_m, enough_m);
        let Scene { flyer, around, .. } = self.scene;
        certify_set(flyer, self.path, around, asked, &self.meter)
    }

    /// Lays the commands of a manoeuvre: the mission up to its start, then its turns from the course there, radians.
    fn lay(&mut self, turns: &Turns, from_rad: f64) {
        let Turns {
            wait_s, climb_rad, ..
        } = *turns;
        let maneuver = self.maneuver.edit();
        maneuver.set(self.scene.nominal.before(wait_s));
        let course_rad = from_rad + turns.turn_rad;
        maneuver.push(Stage::turn(wait_s, course_rad, climb_rad));
        if let Some(second) = turns.second {
            let (start_s, course_rad) = (wait_s + second.after_s, course_rad + second.turn_rad);
            maneuver.push(Stage::turn(start_s, course_rad, second.climb_rad));
        }
    }

    /// Lays the manoeuvre of an answer.
    #[inline(never)]
    pub fn keep(&mut self, turns: &Turns) {
        // A wait lets the bank roll out, which turns the aircraft.
        let from_rad = self.departure(turns.wait_s).course_rad;
        self.lay(turns, from_rad);
    }

    /// The manoeuvre that was laid last.
    pub const fn maneuver(&self) -> &Command {
        self.maneuver
    }

    /// The aircraft when a manoeuvre departs from the mission after a wait.
    #[inline(never)]
    pub fn departure(&self, wait_s: f64) -> MotionState {
        let Scene {
            flyer,
            start,
            nominal,
            ..
        } = self.scene;
        flown(flyer, start, nominal.stages(), wait_s, &self.meter)
    }

    /// Certifies one manoeuvre that departs from a course, radians; stops early below `floor_m`.
    pub fn certify(&mut self, turns: &Turns, from_rad: f64, floor_m: f64) -> Closest {
        self.evaluated += 1;
        self.predict(turns, from_rad);
        self.certify_path(self.scene.horizon_s, (floor_m, ENOUGH_M))
    }

    /// Lays the manoeuvre of an answer and proves that it keeps the separation asked for from all that is assumed, if it does. What it
    /// takes comes from the work that is kept for the answer.
    pub fn prove(&mut self, found: &Found) -> bool {
        self.answer();
        self.keep(&found.turns);
        let scene = self.scene;
        let terms = Terms::new(scene.horizon_s, scene.target_m, scene.target_m);
        let flight = (&**scene.flyer, &mut *self.path);
        terms.is_some_and(|terms| {
            let proof =
                self.maneuver
                    .prove(flight, &scene.start, &scene.around, &terms, &self.meter);
            proof.is_ok()
        })
    }

    /// An answer that is proven; none where it is not.
    pub fn proven(&mut self, found: Found) -> Option<(Found, Outcome)> {
        self.prove(&found).then_some((found, Outcome::Proven))
    }

    /// The cost of a manoeuvre that departs from a course, radians, by the scene's objective.
    pub fn cost(&mut self, turns: &Turns, from_rad: f64) -> f64 {
        match self.scene.objective {
            Objective::PaperCost => self.paper_cost(turns, from_rad),
            objective => self.departure_of(turns).length_m(objective),
        }
    }

    /// `η_ψ` |Δψ| + `η_θ` |Δθ| (Alg. 2 line 20) of the stage that departs most.
    fn paper_cost(&self, turns: &Turns, from_rad: f64) -> f64 {
        let course = from_rad + turns.turn_rad;
        let first = self.scene.cost(course, turns.climb_rad);
        turns.second.map_or(first, |second| {
            first.max(self.scene.cost(course + second.turn_rad, second.climb_rad))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::vehicle::Vehicle;

    /// A scene along +x, in which least cost is looked for.
    pub(super) fn scene<'a>(
        flyer: &'a Turner,
        vehicle: &Vehicle,
        (start, nominal): (MotionState, &'a Maneuver),
        hazards: &'a [fga_proof::certificate::Hazard],
    ) -> Scene<'a> {
        Scene {
            flyer,
            start,
            nominal,
            original: (0.0, 0.0),
            around: Assumptions::only(hazards),
            horizon_s: 60.0,
            target_m: 0.05,
            climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
            costs: (0.2, 0.5),
            objective: Objective::PaperCost,
        }
    }
}

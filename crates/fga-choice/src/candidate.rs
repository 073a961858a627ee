//! The ways that there are: manoeuvres, and the paths that they lead to.

use fga_mission::{Progress, Route};
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, MotionState, flown};

use crate::chance::{Chance, Path, SECONDS, time_s};
use crate::price;

/// Courses off the mission's leg, degrees: both sides, and on.
pub(crate) const TURNS_DEG: [f64; 19] = [
    0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0, 60.0, -60.0, 75.0, -75.0, 90.0, -90.0, 120.0,
    -120.0, 150.0, -150.0, 180.0, -180.0,
];

/// Farthest above and below the mission, metres.
const MOST_ASIDE_M: f64 = 150.0;

/// Not below this height, metres, unless the mission is.
const LOWEST_M: f64 = 60.0;

/// A climb, level flight or a descent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Up {
    /// Level flight.
    Level,
    /// As steep as the vehicle climbs, up to the height that is granted.
    Climb,
    /// The same downwards.
    Descent,
}

/// A way off the mission: a course and a climb, held until the others have passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Course through the air, radians, unwrapped as by [`Chooser::courses`](crate::Chooser::courses).
    pub course_rad: f64,
    /// Its climb.
    pub up: Up,
}

/// What may be flown from now on; moments on the situation's clock, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Plan {
    /// The mission, or the way back to it.
    #[default]
    Mission,
    /// The mission up to a moment, then a way off it.
    Off(Way, f64),
    /// A way up to a moment, then back.
    Back(Way, f64),
}

impl Plan {
    /// The way that is flown at a moment, seconds; `None` on the mission.
    pub fn way_at(&self, time_s: f64) -> Option<Way> {
        match *self {
            Self::Off(way, from_s) if from_s <= time_s => Some(way),
            Self::Back(way, until_s) if until_s > time_s => Some(way),
            _ => None,
        }
    }
}

/// What all candidates of a step share.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The mission and who flies it.
    pub route: &'a Route<'a>,
    /// The guidance along the mission from now on.
    pub mission: &'a Maneuver,
    /// Where it is on the mission.
    pub progress: &'a Progress,
    /// The clock, seconds.
    pub time_s: f64,
    /// The aircraft.
    pub now: MotionState,
    /// Steepest descent and climb of a manoeuvre, radians.
    pub climbs_rad: (f64, f64),
    /// The leg's course through the air, unwrapped, radians.
    pub leg_rad: f64,
    /// The aircraft's own course less its unwrapped one, radians: whole turns.
    pub turns_rad: f64,
    /// Altitude of the mission here, metres.
    pub altitude_m: f64,
    /// Price of a loss, metres.
    pub loss_m: f64,
    /// What is farther away does not count, metres.
    pub surveillance_radius_m: f64,
}

impl Scene<'_> {
    /// The price of some chances, metres.
    pub(crate) fn price_m(&self, chance: &Chance) -> f64 {
        self.loss_m * price::losses(chance)
    }

    /// Sets a command to a plan.
    pub fn set(&self, plan: &Plan, command: &mut Maneuver) {
        let own_m = self.now.position_m.z;
        command.set([]);
        match *plan {
            Plan::Off(way, from_s) => {
                let after_s = from_s - self.time_s;
                if after_s > 0.0 {
                    command.set(self.mission.before(after_s));
                }
                self.push(&way, after_s.max(0.0), own_m, command);
            }
            Plan::Back(way, until_s) if until_s > self.time_s => {
                self.push(&way, 0.0, own_m, command);
                self.then_back(until_s - self.time_s, command);
            }
            Plan::Mission | Plan::Back(..) => command.set(self.mission.stages().iter().copied()),
        }
    }

    /// Appends the stages of a way from a moment on, for an aircraft at an altitude.
    fn push(&self, way: &Way, from_s: f64, altitude_m: f64, command: &mut Maneuver) {
        let (floor_m, ceiling_m) = self.route.mission.limits_m;
        let highest_m = (self.altitude_m + MOST_ASIDE_M).min(ceiling_m);
        let lowest_m = LOWEST_M
            .min(self.altitude_m)
            .max(self.altitude_m - MOST_ASIDE_M)
            .max(floor_m);
        let (climb_rad, left_m) = match way.up {
            Up::Level => (0.0, 0.0),
            Up::Climb => (self.climbs_rad.1, highest_m - altitude_m),
            Up::Descent => (self.climbs_rad.0, altitude_m - lowest_m),
        };
        let climb_mps = self.route.flyer.airspeed_mps() * libm::sin(climb_rad.abs());
        let levels_s = left_m / climb_mps.max(0.1);
        let course_rad = way.course_rad + self.turns_rad;
        let mut levels_from_s = from_s;
        if levels_s > 0.5 {
            command.push(Stage::turn(from_s, course_rad, climb_rad));
            levels_from_s += levels_s;
        }
        if levels_s < SECONDS as f64 {
            command.push(Stage::turn(levels_from_s, course_rad, 0.0));
        }
    }

    /// Appends the way back to the mission after some seconds of a manoeuvre.
    #[inline(never)]
    fn then_back(&self, after_s: f64, command: &mut Maneuver) {
        let flyer = self.route.flyer;
        let meter = Meter::unlimited();
        let mut then = flown(flyer, &self.now, command.stages(), after_s, &meter);
        // As of a decision at that moment: where the air carries it until then.
        then.position_m += self.route.wind_mps * then.time_s;
        then.time_s = 0.0;
        let mut back = Maneuver::hold();
        let mut progress = *self.progress;
        progress.guidance(self.route, &then, SECONDS as f64, &mut back);
        command.truncate(command.before(after_s).count());
        for stage in back.stages() {
            command.push(Stage {
                start_s: stage.start_s + after_s,
                ..*stage
            });
        }
    }

    /// The path of a manoeuvre.
    pub(crate) fn fly(&self, command: &Maneuver, flight: &mut FlightPath, path: &mut Path) {
        let flyer = self.route.flyer;
        flight.predict(flyer, &self.now, command, SECONDS as f64);
        let mut last = [0.0; 3];
        for (at, moment) in path.iter_mut().zip(0..) {
            let second = time_s(moment).into();
            if let Some(state) = flight.state_at(flyer, second) {
                let off = state.position_m - self.now.position_m + self.route.wind_mps * second;
                last = [off.x as f32, off.y as f32, off.z as f32];
            }
            *at = last;
        }
    }
}

//! The choice: what is believed of the others, and the manoeuvre of the least expected cost.

use fga_belief::{Belief, Errors, Report};
use fga_index::situation::{MovementBounds, Obstacle, ProtectedVolume, Situation};
use fga_mission::{Progress, Route};
use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::SettingsError;
use fga_proof::list::List;
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};
use fga_proof::vehicle::Vehicle;

use crate::candidate::{Scene, TURNS_DEG, Up, Way};
use crate::chance::{Ahead, Chance, Path, SECONDS, chance};
use crate::price;

/// Most aircraft that are known.
const MOST_KNOWN: usize = 16;

/// Most aircraft whose futures are weighed: the nearest ones.
const MOST_WEIGHED: usize = 4;

/// Shortest and longest time between two choices, seconds: at a report, or without one.
const PERIOD_S: (f64, f64) = (0.45, 0.95);

/// Begins later, seconds.
const LATER_S: [f64; 3] = [2.0, 5.0, 10.0];

/// Goes back later, seconds.
const BACK_S: [f64; 2] = [3.0, 8.0];

/// Ways that are looked at as later ones.
const LATER_WAYS: usize = 12;

/// An aircraft that is known.
#[derive(Debug, Clone, Copy)]
struct Known {
    id: u32,
    volume: ProtectedVolume,
    belief: Belief,
}

/// What was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Choice {
    /// The command.
    pub command: Maneuver,
    /// Whether it leaves the mission.
    pub avoids: bool,
    /// The chance to enter a protected volume on the mission.
    pub p_loss_hold: f64,
    /// The same as it flies.
    pub p_loss: f64,
}

/// A way with its cost and its chances.
#[derive(Debug, Clone, Copy)]
struct Weighed {
    cost_m: f64,
    way: Option<Way>,
    chance: Chance,
}

/// Chooses at each step.
#[derive(Debug, Clone)]
pub struct Chooser {
    vehicle: Vehicle,
    flyer: Flyer,
    progress: Progress,
    known: List<Option<Known>, MOST_KNOWN>,
    /// The way that is flown.
    way: Option<Way>,
    chances: [f64; 2],
    chosen_s: f64,
    /// The aircraft's course, and that of the leg, unwrapped, radians.
    course_rad: f64,
    leg_rad: f64,
    flight: FlightPath,
    path: Path,
    ahead: [Ahead; MOST_WEIGHED],
}

impl Chooser {
    /// On the first leg of a mission.
    ///
    /// # Errors
    /// A limit of the vehicle that is not finite or out of range.
    #[expect(clippy::large_stack_arrays, reason = "made once, where it stays")]
    pub fn new(vehicle: Vehicle) -> Result<Self, SettingsError> {
        vehicle.check()?;
        Ok(Self {
            vehicle,
            flyer: Flyer::new(&vehicle),
            progress: Progress::new(),
            known: List::new(None),
            way: None,
            chances: [0.0; 2],
            chosen_s: f64::NEG_INFINITY,
            course_rad: 0.0,
            leg_rad: 0.0,
            flight: FlightPath::new(),
            path: [[0.0; 3]; SECONDS + 1],
            ahead: [Ahead::NONE; MOST_WEIGHED],
        })
    }

    /// Replaces the vehicle's limits; a refused one changes nothing.
    pub fn set_vehicle(&mut self, vehicle: &Vehicle) {
        if vehicle.check().is_ok() {
            self.vehicle = *vehicle;
            self.flyer.set(vehicle);
        }
    }

    /// Index of the waypoint at the start of the leg that is flown.
    pub const fn leg_index(&self) -> usize {
        self.progress.index()
    }

    /// Whether the last waypoint is passed.
    pub const fn is_complete(&self) -> bool {
        self.progress.is_complete()
    }

    /// Chooses. The obstacles are as reported, carried on along their velocities for their age; `errors` are those of
    /// their reports.
    pub fn step(&mut self, situation: &Situation<'_>, errors: &Errors) -> Choice {
        let own = &situation.ownship;
        let now = MotionState::of(own);
        let meter = Meter::unlimited();
        let (flyer, vehicle) = (self.flyer, self.vehicle);
        let route = Route {
            mission: &situation.mission,
            flyer: &flyer,
            wind_mps: situation.wind_mps,
            climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
            meter: &meter,
        };
        self.progress.update(&route, &now, situation.time_s);
        self.course_rad += wrap_pi(own.course_rad - self.course_rad);
        let leg = self.progress.leg(&now);
        let near = self.way.map_or(self.course_rad, |_| self.leg_rad);
        self.leg_rad = near + wrap_pi(leg.air_course_rad - near);
        let has_news = self.hear(situation, errors);
        let progress = self.progress;
        let along_m = leg.position(now.position_m, 0.0).along_m;
        let scene = Scene {
            route: &route,
            flyer: &flyer,
            vehicle: &vehicle,
            progress: &progress,
            now,
            leg_rad: self.leg_rad + own.course_rad - self.course_rad,
            altitude_m: leg.point_m(along_m).z,
        };
        let mission = scene.mission();
        let since_s = situation.time_s - self.chosen_s;
        if since_s >= PERIOD_S.1 || since_s < 0.0 || has_news && since_s >= PERIOD_S.0 {
            self.chosen_s = situation.time_s;
            self.choose(situation, &scene, &mission);
        }
        let [p_loss_hold, p_loss] = self.chances;
        Choice {
            command: self.way.map_or(mission, |way| scene.off(&way)),
            avoids: self.way.is_some(),
            p_loss_hold,
            p_loss,
        }
    }

    /// Takes the reports into the beliefs; whether there is a new one.
    fn hear(&mut self, situation: &Situation<'_>, errors: &Errors) -> bool {
        let mut has_news = false;
        for obstacle in situation.obstacles.iter().filter(Obstacle::is_valid) {
            let age_s = obstacle.age_s.max(0.0);
            let report = Report {
                time_s: situation.time_s - age_s,
                position_m: obstacle.position_m,
                velocity_mps: Some(obstacle.velocity_mps),
                carried_s: age_s as f32,
                errors: *errors,
            };
            let slot = self
                .known
                .iter_mut()
                .flatten()
                .find(|known| known.id == obstacle.id);
            if let Some(known) = slot {
                // Between reports it is carried on alone.
                if report.time_s > known.belief.time_s() + 1e-6 {
                    known.belief.update(&report);
                    has_news = true;
                }
                known.volume = obstacle.volume;
                continue;
            }
            let bounds = obstacle.movement.bounds();
            let known = Known {
                id: obstacle.id,
                volume: obstacle.volume,
                belief: Belief::new(&report, &bounds.unwrap_or(STILL)),
            };
            has_news = true;
            let free = self.known.iter_mut().find(|slot| slot.is_none());
            match free {
                Some(slot) => *slot = Some(known),
                None => _ = self.known.push(Some(known)),
            }
        }
        for slot in self.known.iter_mut() {
            *slot = slot.filter(|known| !known.belief.has_ended(situation.time_s));
        }
        has_news
    }

    /// Fills the futures of the nearest aircraft: how many.
    fn look_ahead(&mut self, situation: &Situation<'_>) -> usize {
        let own_m = situation.ownship.position_m;
        let mut after_m = (f64::NEG_INFINITY, 0);
        let mut count = 0;
        for ahead in &mut self.ahead {
            let away = |known: &Known| {
                let at_m = known.belief.at(situation.time_s).position_m;
                (at_m.distance(own_m), known.id)
            };
            let next = (self.known.iter().flatten())
                .map(|known| (away(known), known))
                .filter(|(away, _)| *away > after_m)
                .min_by(|a, b| a.0.0.total_cmp(&b.0.0).then(a.0.1.cmp(&b.0.1)));
            let Some((away, known)) = next else {
                break;
            };
            after_m = away;
            count += 1;
            let futures = known.belief.futures(situation.time_s);
            ahead.set(&futures, own_m, &known.volume);
        }
        count
    }

    /// The chances of a manoeuvre, whose path it leaves.
    fn look(&mut self, scene: &Scene<'_>, command: &Maneuver, count: usize) -> Chance {
        scene.fly(command, &mut self.flight, &mut self.path);
        chance(&self.path, self.ahead.get(..count).unwrap_or_default())
    }

    fn choose(&mut self, situation: &Situation<'_>, scene: &Scene<'_>, mission: &Maneuver) {
        let count = self.look_ahead(situation);
        let hold = self.look(scene, mission, count);
        self.chances = [hold.loss, hold.loss];
        if count == 0 || hold.loss < price::NO_CHANCE {
            self.way = None;
            return;
        }
        let best = self.cheapest(scene, mission, &hold, count);
        self.way = best.way;
        self.chances = [hold.loss, best.chance.loss];
    }

    /// The least expected cost of all candidates.
    fn cheapest(
        &mut self,
        scene: &Scene<'_>,
        mission: &Maneuver,
        hold: &Chance,
        count: usize,
    ) -> Weighed {
        let here = Aside::at(scene, scene.now.position_m);
        let mut best = Weighed {
            cost_m: loss_m(hold),
            way: None,
            chance: *hold,
        };
        let present = self.way;
        if let Some(way) = present {
            best.cost_m += here.off_m;
            for back_s in BACK_S {
                let command = scene.back_later(&way, back_s);
                let chance = self.look(scene, &command, count);
                let there = Aside::on(scene, &self.path, back_s);
                let cost_m =
                    loss_m(&chance) + there.off_m.max(here.off_m) + price::SECOND_M * back_s;
                best.take(cost_m, Some(way), chance);
            }
        }
        let likely = hold.loss.min(1.0);
        let starts_m = price::START_M * (1.0 - likely);
        let mut ways = List::<(f64, Way), LATER_WAYS>::new((f64::INFINITY, Way::ON));
        for up in [Up::Level, Up::Climb, Up::Descent] {
            if up != Up::Level && !scene.vehicle.can_climb() {
                continue;
            }
            for turn_deg in TURNS_DEG {
                let way = Way {
                    turn_rad: turn_deg.to_radians(),
                    up,
                };
                if present.is_none() && way == Way::ON {
                    continue;
                }
                let chance = self.look(scene, &scene.off(&way), count);
                let change_m = present.map_or(starts_m, |present| way.change_m(&present));
                let departs_m = self.departs_m(scene, &here, &chance, 0.0);
                let cost_m = loss_m(&chance) + departs_m + change_m;
                keep(&mut ways, (cost_m, way));
                best.take(cost_m, Some(way), chance);
            }
        }
        if present.is_some() || best.way.is_none() {
            return best;
        }
        // Is it worth waiting? In the mean time the conflict may dissolve.
        for (_, way) in ways.iter() {
            for later_s in LATER_S {
                let command = scene.off_later(mission, way, later_s);
                let chance = self.look(scene, &command, count);
                let stays = libm::exp(-later_s / price::DISSOLVES_S);
                let flown = likely + (1.0 - likely) * stays;
                let departs_m = self.departs_m(scene, &here, &chance, later_s);
                best.take(
                    loss_m(&chance) + flown * (departs_m + starts_m),
                    None,
                    chance,
                );
            }
        }
        best
    }

    /// What the last path costs in departure, extra path and time, from a moment on until the others have passed, metres.
    fn departs_m(&self, scene: &Scene<'_>, here: &Aside, chance: &Chance, from_s: f64) -> f64 {
        let until_s = chance.passed_s.max(from_s + 3.0).min(SECONDS as f64);
        let there = Aside::on(scene, &self.path, until_s);
        let flown_m = scene.vehicle.airspeed_mps * until_s;
        let extra_m = (flown_m - (there.along_m - here.along_m)).max(0.0);
        there.off_m.max(here.off_m)
            + price::EXTRA_PATH * extra_m
            + price::SECOND_M * (until_s - from_s)
    }
}

/// The bounds of what makes no manoeuvres.
const STILL: MovementBounds = MovementBounds {
    turn_rate_radps: 0.0,
    brief_turn_rate_radps: 0.0,
    turn_rad: 0.0,
    climb_change_mps: 0.0,
    acceleration_mps2: 0.0,
};

impl Way {
    /// The course of the mission, level.
    const ON: Self = Self {
        turn_rad: 0.0,
        up: Up::Level,
    };

    /// What it costs to change to it, metres.
    fn change_m(&self, present: &Self) -> f64 {
        let other_climb = if self.up == present.up { 0.0 } else { 0.5 };
        let turn = (self.turn_rad - present.turn_rad).abs().min(1.0);
        price::CHANGE_M * (turn + other_climb).min(1.0)
    }
}

impl Weighed {
    /// Takes a cheaper one.
    fn take(&mut self, cost_m: f64, way: Option<Way>, chance: Chance) {
        if cost_m < self.cost_m {
            *self = Self {
                cost_m,
                way,
                chance,
            };
        }
    }
}

/// A place off the mission's leg.
#[derive(Debug, Clone, Copy)]
struct Aside {
    /// Distance from the leg, metres.
    off_m: f64,
    /// Distance along it, metres.
    along_m: f64,
}

impl Aside {
    /// Of a place over the ground.
    fn at(scene: &Scene<'_>, place_m: Vec3) -> Self {
        let leg = scene.progress.leg(&scene.now);
        let position = leg.position(place_m, 0.0);
        Self {
            off_m: libm::hypot(position.cross_m, position.above_m),
            along_m: position.along_m,
        }
    }

    /// Of a path at a whole second.
    fn on(scene: &Scene<'_>, path: &Path, at_s: f64) -> Self {
        let second = fga_proof::limit::whole(at_s, SECONDS);
        let [x, y, z] = path.get(second).copied().unwrap_or_default();
        let off_m = Vec3::new(x.into(), y.into(), z.into());
        Self::at(scene, scene.now.position_m + off_m)
    }
}

/// The price of some chances, metres.
fn loss_m(chance: &Chance) -> f64 {
    price::LOSS_M
        * (chance.loss + price::INNER * chance.inner + price::COLLISION * chance.collision)
}

/// Keeps the cheapest ways, cheapest first.
fn keep<const N: usize>(ways: &mut List<(f64, Way), N>, new: (f64, Way)) {
    let mut new = new;
    for way in ways.iter_mut() {
        if new.0 < way.0 {
            core::mem::swap(way, &mut new);
        }
    }
    ways.push(new);
}

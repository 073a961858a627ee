//! The choice: what each plan costs in expectation, the cheapest first.

use fga_index::situation::{Obstacle, Obstacles};
use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::whole;
use fga_proof::list::List;
use fga_proof::maneuver::Maneuver;
use fga_proof::prediction::FlightPath;

use crate::beliefs::{Beliefs, Known};
use crate::candidate::{Plan, Scene, TURNS_DEG, Up, Way};
use crate::chance::{Ahead, Chance, Path, SECONDS};
use crate::price;

/// Most aircraft and other obstacles whose futures are weighed: the nearest ones.
pub const MOST_WEIGHED: usize = 6;

/// Begins later, seconds.
const LATER_S: [f64; 3] = [2.0, 5.0, 10.0];

/// Goes back later, seconds.
const BACK_S: [f64; 2] = [3.0, 8.0];

/// Ways that are looked at as later ones.
const LATER_WAYS: usize = 12;

/// Plans that are looked at together: courses with three climbs, the present way, and two ways back from it.
const TOGETHER: usize = 60;

/// Plans that are kept, the cheapest ones.
const RANKED: usize = 12;

/// A plan with its chances and its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked {
    /// The plan.
    pub plan: Plan,
    /// Its chances.
    pub chance: Chance,
    /// Its expected cost, metres.
    pub cost_m: f64,
}

impl Ranked {
    const NONE: Self = Self {
        plan: Plan::Mission,
        chance: Chance {
            loss: 0.0,
            inner: 0.0,
            collision: 0.0,
            passed_s: 0.0,
        },
        cost_m: f64::INFINITY,
    };
}

/// A plan that is looked at: its chances so far, and where it is once the others have passed.
#[derive(Debug, Clone, Copy)]
struct Looked {
    plan: Plan,
    chance: Chance,
    there: Aside,
}

impl Looked {
    /// At the beginning.
    const fn new(plan: Plan) -> Self {
        Self {
            plan,
            chance: Ranked::NONE.chance,
            there: Aside {
                off_m: 0.0,
                along_m: 0.0,
            },
        }
    }
}

/// What is near: an aircraft that is believed to be somewhere, or an obstacle that keeps its velocity.
#[derive(Clone, Copy)]
enum Other<'a> {
    Known(&'a Known),
    Straight(Obstacle),
}

/// Weighs plans. It holds its scratch space, some 30 kB.
#[derive(Debug, Clone)]
pub struct Chooser {
    ahead: Ahead,
    path: Path,
    looked: List<Looked, TOGETHER>,
    ranked: List<Ranked, RANKED>,
    /// The aircraft's course, and that of the leg, unwrapped, radians.
    course_rad: f64,
    leg_rad: f64,
}

impl Default for Chooser {
    fn default() -> Self {
        Self::new()
    }
}

impl Chooser {
    /// One that has weighed nothing.
    pub const fn new() -> Self {
        Self {
            ahead: Ahead::NONE,
            path: [[0.0; 3]; SECONDS + 1],
            looked: List::new(Looked::new(Plan::Mission)),
            ranked: List::new(Ranked::NONE),
            course_rad: 0.0,
            leg_rad: 0.0,
        }
    }

    /// The course of the leg through the air, unwrapped, and the whole turns between that and the aircraft's own course, radians. Off the
    /// mission the leg stays on its side, so that a turn of 180° goes on.
    pub fn courses(&mut self, own_rad: f64, air_course_rad: f64, is_off: bool) -> (f64, f64) {
        self.course_rad += wrap_pi(own_rad - self.course_rad);
        let near = if is_off {
            self.leg_rad
        } else {
            self.course_rad
        };
        self.leg_rad = near + wrap_pi(air_course_rad - near);
        (self.leg_rad, own_rad - self.course_rad)
    }

    /// Weighs the plans of a moment, while `present` is flown, for some seconds away from the mission. Returns the chances of the mission.
    /// The plans are in [`Self::ranked`]: the mission alone where its chance of a loss counts as 0.
    pub fn weigh(
        &mut self,
        scene: &Scene<'_>,
        (beliefs, obstacles): (&Beliefs, &Obstacles<'_>),
        (present, away_s): (&Plan, f64),
        flight: &mut FlightPath,
    ) -> Chance {
        let others = others(scene, beliefs, obstacles);
        let here = Aside::at(scene, scene.now.position_m);
        self.ranked.clear();
        self.begin([Plan::Mission]);
        self.look(scene, &others, flight);
        let hold = self
            .looked
            .first()
            .map_or(Chance::default(), |on| on.chance);
        if hold.loss < price::no_chance(away_s) {
            self.rank(Plan::Mission, &hold, 0.0);
            return hold;
        }
        let flown = present.way_at(scene.time_s);
        let back_m = flown.map_or(0.0, |_| here.off_m);
        self.rank(Plan::Mission, &hold, price::loss_m(&hold) + back_m);
        let likely = hold.loss.min(1.0);
        let starts_m = price::START_M * (1.0 - likely);
        self.begin(ways(scene, flown));
        self.look(scene, &others, flight);
        let mut changes_m = 0.0;
        for place in 0..self.looked.len() {
            let Some(one) = self.looked.get(place).copied() else {
                break;
            };
            let mut cost_m = price::loss_m(&one.chance);
            match (one.plan, flown) {
                (Plan::Mission, _) => continue,
                (Plan::Back(_, until_s), _) => {
                    let for_s = until_s - scene.time_s;
                    cost_m += one.there.off_m.max(here.off_m) + price::SECOND_M * for_s;
                }
                (Plan::Off(..), None) => cost_m += one.departs_m(scene, &here, 0.0) + starts_m,
                (Plan::Off(way, _), Some(flown)) => {
                    cost_m += one.departs_m(scene, &here, 0.0);
                    // The present way is the first one off the mission.
                    if way == flown {
                        changes_m = price::CHANGE_SHARE * cost_m.min(price::LOSS_M / 2.0);
                    } else {
                        cost_m += changes_m + way.change_m(&flown);
                    }
                }
            }
            self.rank(one.plan, &one.chance, cost_m);
        }
        let is_off = |ranked: &Ranked| ranked.plan != Plan::Mission;
        if flown.is_some() || !self.ranked.first().is_some_and(is_off) {
            return hold;
        }
        // Is it worth waiting? In the mean time the conflict may dissolve.
        let now = self.ranked;
        let off = now.iter().filter_map(|ranked| match ranked.plan {
            Plan::Off(way, _) => Some(way),
            _ => None,
        });
        let from = |way, later_s| Plan::Off(way, scene.time_s + later_s);
        self.begin(
            off.take(LATER_WAYS)
                .flat_map(|way| LATER_S.map(|later_s| from(way, later_s))),
        );
        self.look(scene, &others, flight);
        for place in 0..self.looked.len() {
            let Some(one) = self.looked.get(place).copied() else {
                break;
            };
            let Plan::Off(_, from_s) = one.plan else {
                continue;
            };
            let later_s = from_s - scene.time_s;
            let flown = likely + (1.0 - likely) * libm::exp(-later_s / price::DISSOLVES_S);
            let cost_m = flown * (one.departs_m(scene, &here, later_s) + starts_m);
            self.rank(one.plan, &one.chance, price::loss_m(&one.chance) + cost_m);
        }
        hold
    }

    /// The cheapest plans, cheapest first.
    pub fn ranked(&self) -> &[Ranked] {
        &self.ranked
    }

    /// Puts a plan among the cheapest ones; of two that cost the same the first one stays before.
    fn rank(&mut self, plan: Plan, chance: &Chance, cost_m: f64) {
        let chance = *chance;
        let new = Ranked {
            plan,
            chance,
            cost_m,
        };
        keep_least(&mut self.ranked, new, |ranked| ranked.cost_m);
    }

    /// Takes plans to look at.
    fn begin(&mut self, plans: impl IntoIterator<Item = Plan>) {
        self.looked.clear();
        for plan in plans {
            self.looked.push(Looked::new(plan));
        }
    }

    /// Adds up the chances of the plans with all others.
    fn look(
        &mut self,
        scene: &Scene<'_>,
        others: &List<(f64, Option<Other<'_>>), MOST_WEIGHED>,
        flight: &mut FlightPath,
    ) {
        let own_m = scene.now.position_m;
        let mut command = Maneuver::hold();
        for other in others.iter().filter_map(|other| other.1) {
            match other {
                Other::Known(known) => {
                    let futures = known.belief.futures(scene.time_s);
                    self.ahead.set(&futures, own_m, &known.volume);
                }
                Other::Straight(obstacle) => self.ahead.set_straight(&obstacle, own_m),
            }
            for looked in self.looked.iter_mut() {
                scene.set(&looked.plan, &mut command);
                scene.fly(&command, flight, &mut self.path);
                let waits = matches!(looked.plan, Plan::Off(_, from_s) if from_s > scene.time_s);
                let chance = self.ahead.meets(&self.path, !waits);
                let is_later = chance.passed_s >= looked.chance.passed_s;
                looked.chance = looked.chance.and(chance);
                let at_s = looked.measured_s(scene);
                if is_later {
                    looked.there = Aside::on(scene, &self.path, at_s);
                }
            }
        }
    }
}

/// Keeps the items with the least numbers, the least first; of equal ones the first stays before.
fn keep_least<T: Copy, const N: usize>(
    kept: &mut List<T, N>,
    mut new: T,
    number: impl Fn(&T) -> f64,
) {
    for one in kept.iter_mut() {
        if number(&new) < number(one) {
            core::mem::swap(one, &mut new);
        }
    }
    kept.push(new);
}

/// The nearest of what is around, by distance, metres.
fn others<'a>(
    scene: &Scene<'_>,
    beliefs: &'a Beliefs,
    obstacles: &Obstacles<'_>,
) -> List<(f64, Option<Other<'a>>), MOST_WEIGHED> {
    let own_m = scene.now.position_m;
    let mut nearest = List::new((f64::INFINITY, None));
    let mut keep = |away_m: f64, other| {
        keep_least(&mut nearest, (away_m, Some(other)), |other| other.0);
    };
    for known in beliefs.iter() {
        let at_m = known.belief.at(scene.time_s).position_m;
        keep(at_m.distance(own_m), Other::Known(known));
    }
    let keeps_on = |obstacle: &Obstacle| obstacle.movement.bounds().is_none();
    for obstacle in obstacles.iter().filter(keeps_on) {
        keep(
            obstacle.volume.margin_m(own_m - obstacle.position_m),
            Other::Straight(obstacle),
        );
    }
    nearest
}

/// The plans that begin now.
fn ways(scene: &Scene<'_>, flown: Option<Way>) -> impl Iterator<Item = Plan> {
    let (time_s, leg_rad) = (scene.time_s, scene.leg_rad);
    let backs = flown.map(|way| BACK_S.map(|back_s| Plan::Back(way, time_s + back_s)));
    let (low_rad, high_rad) = scene.climbs_rad;
    let can = move |up: &Up| match up {
        Up::Level => true,
        Up::Climb => high_rad > 0.0,
        Up::Descent => low_rad < 0.0,
    };
    let ups = [Up::Level, Up::Climb, Up::Descent].into_iter().filter(can);
    let all = ups.flat_map(move |up| {
        TURNS_DEG.map(|turn_deg| Way {
            course_rad: leg_rad + turn_deg.to_radians(),
            up,
        })
    });
    let is_on = move |way: &Way| way.course_rad == leg_rad && way.up == Up::Level;
    let off = all.filter(move |way| flown.is_some() || !is_on(way));
    let off = flown.into_iter().chain(off);
    let off = off.map(move |way| Plan::Off(way, time_s));
    backs.into_iter().flatten().chain(off)
}

impl Looked {
    /// When its departure is measured, seconds from now: as it turns back, or when the others have passed.
    fn measured_s(&self, scene: &Scene<'_>) -> f64 {
        match self.plan {
            Plan::Back(_, until_s) => until_s - scene.time_s,
            Plan::Mission => 0.0,
            Plan::Off(_, from_s) => self.until_s(from_s - scene.time_s),
        }
    }

    /// Until when it is flown, seconds from now: until the others have passed.
    fn until_s(&self, from_s: f64) -> f64 {
        self.chance.passed_s.max(from_s + 3.0).min(SECONDS as f64)
    }

    /// What it costs in departure, extra path and time, from a moment on until the others have passed, metres.
    fn departs_m(&self, scene: &Scene<'_>, here: &Aside, from_s: f64) -> f64 {
        let until_s = self.until_s(from_s);
        let flown_m = scene.route.flyer.airspeed_mps() * until_s;
        let extra_m = (flown_m - (self.there.along_m - here.along_m)).max(0.0);
        self.there.off_m.max(here.off_m)
            + price::EXTRA_PATH * extra_m
            + price::SECOND_M * (until_s - from_s)
    }
}

impl Way {
    /// What it costs to change to it, metres.
    fn change_m(&self, present: &Self) -> f64 {
        let other_climb = if self.up == present.up { 0.0 } else { 0.5 };
        let turn = (self.course_rad - present.course_rad).abs().min(1.0);
        price::CHANGE_M * (turn + other_climb).min(1.0)
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
        let second = whole(at_s, SECONDS);
        let [x, y, z] = path.get(second).copied().unwrap_or_default();
        let off_m = Vec3::new(x.into(), y.into(), z.into());
        Self::at(scene, scene.now.position_m + off_m)
    }
}

//! The choice: what each plan costs in expectation, the cheapest first.

use fga_belief::FUTURES;
use fga_index::situation::{Obstacle, Obstacles};
use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::whole;
use fga_proof::list::List;
use fga_proof::maneuver::Maneuver;
use fga_proof::prediction::FlightPath;

use crate::beliefs::{Beliefs, Known};
use crate::candidate::{Plan, Scene, TURNS_DEG, Up, Way};
use crate::chance::{Ahead, Chance, Looks, MOMENTS, Path, SECONDS, moment_at};
use crate::price;

/// Most aircraft and other obstacles whose futures are weighed: the nearest ones.
pub const MOST_WEIGHED: usize = 6;

/// Plans that are looked at together: courses with three climbs, the present way.
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
    /// What of that is for its start, or for a change from the present plan.
    pub(crate) change_m: f64,
}

impl Ranked {
    const NONE: Self = Self {
        plan: Plan::Mission,
        chance: Chance::NONE,
        cost_m: f64::INFINITY,
        change_m: 0.0,
    };
}

/// A plan that is looked at: its chances so far, and where it is once the others have passed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Looked {
    pub(crate) plan: Plan,
    pub(crate) chance: Chance,
    there: Aside,
}

impl Looked {
    /// At the beginning.
    const fn new(plan: Plan) -> Self {
        Self {
            plan,
            chance: Chance::NONE,
            there: Aside {
                off_m: 0.0,
                along_m: 0.0,
            },
        }
    }
}

/// What is near: an aircraft that is believed to be somewhere, or an obstacle that keeps its velocity.
#[derive(Clone, Copy)]
pub(crate) enum Other<'a> {
    Known(&'a Known),
    Straight(Obstacle),
}

/// One of the others, how many losses it is on the mission, its share of all of them, and when it is nearest there, seconds.
#[derive(Clone, Copy)]
pub(crate) struct Nearby<'a> {
    other: Option<Other<'a>>,
    /// How near it may come by its closing speed, metres.
    away_m: f64,
    pub(crate) losses: f64,
    share: f64,
    passes_s: f64,
}

impl Nearby<'_> {
    pub(crate) const NOTHING: Self = Self {
        other: None,
        away_m: f64::INFINITY,
        losses: 0.0,
        share: 0.0,
        passes_s: 0.0,
    };

    /// The age of what is known of it, seconds.
    pub(crate) fn age_s(&self, scene: &Scene<'_>) -> f64 {
        match &self.other {
            Some(Other::Known(known)) => (scene.time_s - known.belief.time_s()).max(0.0),
            _ => 0.0,
        }
    }

    /// Its futures as they will be known after some seconds.
    pub(crate) fn ahead(&self, scene: &Scene<'_>, learned_s: f32, ahead: &mut Ahead) {
        let own_m = scene.now.position_m;
        match &self.other {
            Some(Other::Known(known)) => {
                let futures = known.belief.futures(scene.time_s);
                ahead.set(&futures, own_m, &known.volume, learned_s);
            }
            Some(Other::Straight(obstacle)) => ahead.set_straight(obstacle, own_m),
            None => {}
        }
    }
}

/// All that is near.
pub(crate) type Others<'a> = List<Nearby<'a>, MOST_WEIGHED>;

/// Weighs plans. It holds its scratch space.
#[derive(Debug, Clone)]
pub struct Chooser {
    pub(crate) ahead: Ahead,
    pub(crate) looks: Looks,
    path: Path,
    pub(crate) looked: List<Looked, TOGETHER>,
    pub(crate) ranked: List<Ranked, RANKED>,
    /// The aircraft's course, and that of the leg, unwrapped, radians.
    course_rad: f64,
    leg_rad: f64,
    left_out: u32,
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
            looks: Looks::NONE,
            path: [[0.0; 3]; MOMENTS],
            looked: List::new(Looked::new(Plan::Mission)),
            ranked: List::new(Ranked::NONE),
            course_rad: 0.0,
            leg_rad: 0.0,
            left_out: 0,
        }
    }

    /// Forgets the flight.
    pub const fn forget(&mut self) {
        (self.course_rad, self.leg_rad, self.left_out) = (0.0, 0.0, 0);
    }

    /// How many of what was around were not weighed last, because more than [`MOST_WEIGHED`] are nearer.
    pub const fn left_out(&self) -> u32 {
        self.left_out
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
    #[inline(never)]
    pub fn weigh(
        &mut self,
        scene: &Scene<'_>,
        (beliefs, obstacles): (&Beliefs, &Obstacles<'_>),
        (present, away_s): (&Plan, f64),
        flight: &mut FlightPath,
    ) -> Chance {
        let (mut others, left_out) = others(scene, beliefs, obstacles);
        self.left_out = left_out;
        let here = Aside::at(scene, scene.now.position_m);
        self.ranked.clear();
        let mut hold = Chance::NONE;
        for near in others.iter_mut() {
            self.begin([Plan::Mission]);
            self.look_at(scene, near, flight);
            let one = self.looked.first().map_or(Chance::NONE, |on| on.chance);
            near.losses = price::losses(&one);
            near.passes_s = one.passed_s;
            hold = hold.and(one);
        }
        for near in others.iter_mut() {
            near.share = near.losses / price::losses(&hold).max(f64::MIN_POSITIVE);
        }
        if price::losses(&hold) < price::no_loss(away_s) {
            self.rank(Plan::Mission, &hold, (0.0, 0.0));
            return hold;
        }
        let flown = present.way_at(scene.time_s);
        let is_away = flown.is_some() || away_s > 0.0;
        let back_m = flown.map_or(0.0, |_| here.off_m);
        self.rank(Plan::Mission, &hold, (scene.price_m(&hold) + back_m, 0.0));
        self.begin(ways(scene, flown));
        self.look(scene, &others, flight);
        let mut changes_m = 0.0;
        for place in 0..self.looked.len() {
            let Some(one) = self.looked.get(place).copied() else {
                break;
            };
            let cost_m = scene.price_m(&one.chance) + one.departs_m(scene, &here);
            let change_m = match (flown, one.plan.way_at(scene.time_s)) {
                // The present way is the first one.
                (Some(flown), Some(way)) if way == flown => {
                    changes_m = price::CHANGE_SHARE * cost_m.min(scene.loss_m / 2.0);
                    0.0
                }
                (Some(flown), Some(way)) => changes_m + way.change_m(&flown),
                _ => price::starts_m(&hold, is_away),
            };
            self.rank(one.plan, &one.chance, (cost_m, change_m));
        }
        let is_off = |ranked: &Ranked| ranked.plan != Plan::Mission;
        if flown.is_some() || self.ranked.first().is_some_and(is_off) {
            self.weigh_recourse(scene, (&others, &hold), (&here, back_m, is_away), flight);
        }
        hold
    }

    /// The cheapest plans, cheapest first.
    pub fn ranked(&self) -> &[Ranked] {
        &self.ranked
    }

    /// Puts a plan among the cheapest ones, by its cost and that of a change to it, metres; of two that cost the same the first one stays before.
    pub(crate) fn rank(&mut self, plan: Plan, chance: &Chance, (cost_m, change_m): (f64, f64)) {
        let chance = *chance;
        let new = Ranked {
            plan,
            chance,
            cost_m: cost_m + change_m,
            change_m,
        };
        keep_least(&mut self.ranked, new, |ranked| ranked.cost_m);
    }

    /// Takes plans to look at.
    pub(crate) fn begin(&mut self, plans: impl IntoIterator<Item = Plan>) {
        self.looked.clear();
        for plan in plans {
            self.looked.push(Looked::new(plan));
        }
    }

    /// Adds up the chances of the plans with all others.
    pub(crate) fn look(&mut self, scene: &Scene<'_>, others: &Others<'_>, flight: &mut FlightPath) {
        for near in others.iter().filter(|near| near.other.is_some()) {
            self.look_at(scene, near, flight);
        }
    }

    /// Adds the chances of the plans with one of the others.
    fn look_at(&mut self, scene: &Scene<'_>, near: &Nearby<'_>, flight: &mut FlightPath) {
        near.ahead(scene, 0.0, &mut self.ahead);
        for place in 0..self.looked.len() {
            self.meet(scene, place, near, flight);
        }
    }

    /// Adds the chances of a plan with one of the others, and returns them for each of its futures. A plan has passed when it and the mission
    /// would have passed the others, each by its share of the losses.
    pub(crate) fn meet(
        &mut self,
        scene: &Scene<'_>,
        place: usize,
        near: &Nearby<'_>,
        flight: &mut FlightPath,
    ) -> [Chance; FUTURES] {
        let Some(looked) = self.looked.get_mut(place) else {
            return [Chance::NONE; FUTURES];
        };
        let mut command = Maneuver::hold();
        scene.set(&looked.plan, &mut command);
        scene.fly(&command, flight, &mut self.path);
        let waits = matches!(looked.plan, Plan::Off(_, from_s) if from_s > scene.time_s);
        let each = self.ahead.meets(&self.path, !waits);
        let mut chance = Chance::mean(&each, self.ahead.weights());
        // Who turns away from it has it before him again.
        chance.passed_s = near.share * near.passes_s.max(chance.passed_s);
        looked.chance = looked.chance.and(chance);
        looked.there = Aside::on(scene, &self.path, looked.off_s(scene).1);
        each
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

/// The nearest of what is around, and how many are left out.
fn others<'a>(
    scene: &Scene<'_>,
    beliefs: &'a Beliefs,
    obstacles: &Obstacles<'_>,
) -> (Others<'a>, u32) {
    let route = scene.route;
    let own_m = scene.now.position_m;
    let own_mps = route.flyer.velocity_mps(&scene.now) + route.wind_mps;
    let (mut nearest, mut all) = (List::new(Nearby::NOTHING), 0_u32);
    let mut keep = |[at_m, v_mps]: [Vec3; 2], margin_m: f64, other| {
        let off_m = at_m - own_m;
        let apart_m = off_m.length();
        if apart_m > scene.surveillance_radius_m {
            return;
        }
        let closing_mps = (own_mps - v_mps).dot(off_m) / apart_m.max(1.0);
        let near = Nearby {
            other: Some(other),
            away_m: margin_m - SECONDS as f64 * closing_mps.max(0.0),
            // Until the mission is weighed.
            losses: f64::INFINITY,
            share: 1.0,
            ..Nearby::NOTHING
        };
        keep_least(&mut nearest, near, |near| near.away_m);
        all += 1;
    };
    for known in beliefs.iter() {
        let at = known.belief.at(scene.time_s);
        let margin_m = known.volume.margin_m(own_m - at.position_m);
        keep(
            [at.position_m, at.velocity_mps],
            margin_m,
            Other::Known(known),
        );
    }
    let keeps_on = |obstacle: &Obstacle| obstacle.movement.bounds().is_none();
    for obstacle in obstacles.iter().filter(keeps_on) {
        let margin_m = obstacle.volume.margin_m(own_m - obstacle.position_m);
        let at = [obstacle.position_m, obstacle.velocity_mps];
        keep(at, margin_m, Other::Straight(obstacle));
    }
    (nearest, all.saturating_sub(MOST_WEIGHED as u32))
}

/// The plans that begin now.
fn ways(scene: &Scene<'_>, flown: Option<Way>) -> impl Iterator<Item = Plan> {
    let (time_s, leg_rad) = (scene.time_s, scene.leg_rad);
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
    let off = all.filter(move |way| flown.map_or(!is_on(way), |flown| flown != *way));
    let off = flown.into_iter().chain(off);
    off.map(move |way| Plan::Off(way, time_s))
}

impl Looked {
    /// From when until when it is off the mission, seconds from now: until it turns back, or until the others have passed.
    fn off_s(&self, scene: &Scene<'_>) -> (f64, f64) {
        match self.plan {
            Plan::Mission => (0.0, 0.0),
            Plan::Back(_, until_s) => (0.0, until_s - scene.time_s),
            Plan::Off(_, from_s) => {
                let from_s = from_s - scene.time_s;
                let until_s = self.chance.passed_s.max(from_s + 3.0).min(SECONDS as f64);
                (from_s, until_s)
            }
        }
    }

    /// What it costs in departure, extra path and time, until it is back or until the others have passed, metres.
    pub(crate) fn departs_m(&self, scene: &Scene<'_>, here: &Aside) -> f64 {
        if self.plan == Plan::Mission {
            return 0.0;
        }
        let off_m = self.there.off_m.max(here.off_m);
        let (from_s, until_s) = self.off_s(scene);
        let flown_m = scene.progress.leg(&scene.now).ground_speed_mps * until_s;
        let extra_m = (flown_m - (self.there.along_m - here.along_m)).max(0.0);
        off_m + price::EXTRA_PATH * extra_m + price::SECOND_M * (until_s - from_s)
    }
}

impl Way {
    /// What it costs to change to it, metres.
    pub(crate) fn change_m(&self, present: &Self) -> f64 {
        let other_climb = if self.up == present.up { 0.0 } else { 0.5 };
        let turn = (self.course_rad - present.course_rad).abs().min(1.0);
        price::CHANGE_M * (price::SMALL_CHANGE + turn + other_climb).min(1.0)
    }
}

/// A place off the mission's leg.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Aside {
    /// Distance from the leg, metres.
    pub(crate) off_m: f64,
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

    /// Of a path at the moment of a time, seconds.
    fn on(scene: &Scene<'_>, path: &Path, at_s: f64) -> Self {
        let moment = moment_at(whole(at_s, SECONDS));
        let [x, y, z] = path.get(moment).copied().unwrap_or_default();
        let off_m = Vec3::new(x.into(), y.into(), z.into());
        Self::at(scene, scene.now.position_m + off_m)
    }
}

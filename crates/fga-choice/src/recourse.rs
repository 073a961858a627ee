//! What is learned later: the value of waiting, and of a way that may be left again.
//!
//! A plan that is weighed as if it were flown whatever is heard costs too much: some seconds later more is known, and then the best way
//! from there on is flown. So a first step, the mission or a way, is weighed with what follows it as a program of two stages with recourse
//! (Dantzig, Linear Programming under Uncertainty, 1955): for each future that may happen, how likely each of them will look then, and the
//! least cost by that. What is known then is as sharp, and as late, as what is known now. The first step counts with the mean of these costs.

use fga_belief::FUTURES;
use fga_proof::limit::whole;
use fga_proof::prediction::FlightPath;

use crate::candidate::{Plan, Scene};
use crate::chance::Chance;
use crate::chooser::{Aside, Chooser, Nearby, Others};
use crate::price;

/// When more is known, seconds.
const LATER_S: [f64; 2] = [3.0, 8.0];

/// Ways that are looked at with what follows them, the cheapest ones without.
const WAYS: usize = 6;

/// A number for each future that may happen, or for each look that they may have.
type Each = [f64; FUTURES];

/// What a weighing with recourse is about: the aircraft whose future becomes known, the other aircraft, and the place beside the leg.
struct Studied<'a> {
    threat: Nearby<'a>,
    rest: Others<'a>,
    here: Aside,
    /// What the way back costs, metres.
    back_m: f64,
    is_away: bool,
}

impl Chooser {
    /// Weighs the mission and the cheapest ways again: after its first step each may be left for another one, by what reports show then.
    #[inline(never)]
    pub(crate) fn weigh_recourse(
        &mut self,
        scene: &Scene<'_>,
        (others, hold): (&Others<'_>, &Chance),
        (here, back_m, is_away): (&Aside, f64, bool),
        flight: &mut FlightPath,
    ) {
        let before = self.ranked;
        let Some(studied) = Studied::of(others, here, back_m, is_away) else {
            return;
        };
        self.ranked.clear();
        self.rank(Plan::Mission, hold, (scene.price_m(hold) + back_m, 0.0));
        let ways = before.iter().filter_map(|ranked| match ranked.plan {
            Plan::Off(way, _) => Some((way, ranked)),
            _ => None,
        });
        let ways = ways.take(WAYS);
        // A way back that may be left again is a change.
        let change_m = if is_away { price::CHANGE_M } else { 0.0 };
        let mut ways_m = [f64::INFINITY; WAYS];
        for later_s in LATER_S {
            let then_s = scene.time_s + later_s;
            let three = |(way, _)| {
                [
                    Plan::Off(way, scene.time_s),
                    Plan::Back(way, then_s),
                    Plan::Off(way, then_s),
                ]
            };
            let plans = ways.clone().flat_map(three);
            self.begin([Plan::Mission].into_iter().chain(plans));
            let (starts_m, mut least_m) = self.learn(scene, &studied, later_s, flight);
            let mut always_m = [f64::INFINITY; WAYS];
            let places = (1..self.looked.len()).step_by(3);
            let all = ways_m.iter_mut().zip(&mut always_m);
            for ((way_m, always_m), place) in all.zip(places.clone()) {
                let on_m = self.by_looks(scene, &studied, place, flight);
                let back_m = self.by_looks(scene, &studied, place + 1, flight);
                *way_m = way_m.min(self.looks.mean(&least(&on_m, &back_m)));
                let mut off_m = self.by_looks(scene, &studied, place + 2, flight);
                for (off_m, starts_m) in off_m.iter_mut().zip(&starts_m) {
                    *off_m += starts_m;
                }
                least_m = least(&least_m, &off_m);
                *always_m = self.looks.mean(&off_m);
            }
            let cost_m = self.looks.mean(&least_m);
            let cheapest_m = always_m.into_iter().fold(f64::INFINITY, f64::min);
            for (((way, _), always_m), place) in ways.clone().zip(always_m).zip(places) {
                let cost_m = cost_m + always_m - cheapest_m;
                let later = self.looked.get(place + 2).copied();
                let chance = later.map_or(Chance::NONE, |later| later.chance);
                self.rank(Plan::Off(way, then_s), &chance, (cost_m, change_m));
            }
        }
        for ((_, now), way_m) in ways.zip(ways_m) {
            self.rank(now.plan, &now.chance, (way_m, now.change_m));
        }
    }

    /// Meets the others on the plans, and takes what is learned after some seconds: by each look, what a start and what the mission costs, which
    /// is the first of the plans, metres.
    #[inline(never)]
    fn learn(
        &mut self,
        scene: &Scene<'_>,
        studied: &Studied<'_>,
        after_s: f64,
        flight: &mut FlightPath,
    ) -> (Each, Each) {
        self.look(scene, &studied.rest, flight);
        let known_s = (after_s - studied.threat.age_s(scene)).max(0.0);
        (studied.threat).ahead(scene, known_s as f32, &mut self.ahead);
        // At most the later one of `LATER_S`.
        let then = whole(known_s, 8);
        self.ahead.looks_after(then, &mut self.looks);
        let (each, rest_m) = self.met(scene, studied, 0, flight);
        let (mut starts_m, mut costs_m) = ([0.0; FUTURES], [0.0; FUTURES]);
        for ((cost_m, starts_m), looks) in (costs_m.iter_mut())
            .zip(&mut starts_m)
            .zip(&self.looks.futures)
        {
            let expected = Chance::mean(&each, looks);
            *starts_m = price::starts_m(&expected, studied.is_away);
            *cost_m = studied.back_m + rest_m + scene.price_m(&expected);
        }
        (starts_m, costs_m)
    }

    /// What a plan costs by each look, metres.
    #[inline(never)]
    fn by_looks(
        &mut self,
        scene: &Scene<'_>,
        studied: &Studied<'_>,
        place: usize,
        flight: &mut FlightPath,
    ) -> Each {
        let (each, rest_m) = self.met(scene, studied, place, flight);
        let mut costs_m = [0.0; FUTURES];
        for (cost_m, looks) in costs_m.iter_mut().zip(&self.looks.futures) {
            *cost_m = rest_m + scene.price_m(&Chance::mean(&each, looks));
        }
        costs_m
    }

    /// The chances of a plan with the aircraft that is studied, for each of its futures, and what it costs beside that, metres.
    fn met(
        &mut self,
        scene: &Scene<'_>,
        studied: &Studied<'_>,
        place: usize,
        flight: &mut FlightPath,
    ) -> ([Chance; FUTURES], f64) {
        let rest = self
            .looked
            .get(place)
            .map_or(Chance::NONE, |one| one.chance);
        let each = self.meet(scene, place, &studied.threat, flight);
        let departs_m = self
            .looked
            .get(place)
            .map(|one| one.departs_m(scene, &studied.here));
        let rest_m = scene.price_m(&rest) + departs_m.unwrap_or(0.0);
        (each, rest_m)
    }
}

impl<'a> Studied<'a> {
    /// The one that the mission is most likely to meet is studied.
    fn of(others: &Others<'a>, here: &Aside, back_m: f64, is_away: bool) -> Option<Self> {
        let mut rest = *others;
        let threat = (rest.iter_mut()).max_by(|a, b| a.losses.total_cmp(&b.losses))?;
        let threat = core::mem::replace(threat, Nearby::NOTHING);
        Some(Self {
            threat,
            rest,
            here: *here,
            back_m,
            is_away,
        })
    }
}

/// The lesser of two numbers, for each future.
fn least(a_m: &Each, b_m: &Each) -> Each {
    let mut least_m = *a_m;
    for (least_m, b_m) in least_m.iter_mut().zip(b_m) {
        *least_m = least_m.min(*b_m);
    }
    least_m
}

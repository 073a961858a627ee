//! What is learned later: the value of waiting, and of a way that may be left again.
//!
//! A plan that is weighed as if it were flown whatever is heard costs too much: some seconds later more is known, and then the best way
//! from there on is flown. So a first step, the mission or a way, is weighed with what follows it as a program of two stages with recourse
//! (Dantzig, Linear Programming under Uncertainty, 1955): for each future that may happen, how likely each of them will look then, and the
//! least cost by that. What is known then is as sharp as what is known now. The first step counts with the mean of these costs.

use fga_belief::FUTURES;
use fga_proof::limit::whole;
use fga_proof::prediction::FlightPath;

use crate::candidate::{Plan, Scene};
use crate::chance::{Chance, SECONDS};
use crate::chooser::{Aside, Chooser, Other, Others};
use crate::price;

/// Begins later, seconds.
const LATER_S: [f64; 3] = [2.0, 5.0, 10.0];

/// A way that begins now is left after this time, seconds, if it is known to be clear then.
const LEFT_S: f64 = 8.0;

/// Ways that are looked at with what follows them, the cheapest ones without.
const WAYS: usize = 8;

/// A number for each future that may happen.
type Each = [f64; FUTURES];

/// What a weighing with recourse is about: the aircraft whose future becomes known, the other aircraft, and the place beside the leg.
struct Studied<'a> {
    threat: Other<'a>,
    rest: Others<'a>,
    here: Aside,
}

/// How likely the futures look at some later moment, and the price of a start there.
struct Looks {
    looks: [[f32; FUTURES]; FUTURES],
    starts_m: Each,
}

impl Chooser {
    /// Ranks ways that begin now or later anew, each with what reports show after its first step.
    pub(crate) fn weigh_recourse(
        &mut self,
        scene: &Scene<'_>,
        others: &Others<'_>,
        here: &Aside,
        flight: &mut FlightPath,
    ) {
        let Some(studied) = self.studied(scene, others, here, flight) else {
            return;
        };
        let before = self.ranked;
        self.ranked.clear();
        for ranked in before.iter().filter(|one| one.plan == Plan::Mission) {
            self.rank(ranked.plan, &ranked.chance, ranked.cost_m);
        }
        let ways = before.iter().filter_map(|ranked| match ranked.plan {
            Plan::Off(way, _) => Some((way, ranked.chance)),
            _ => None,
        });
        let ways = ways.take(WAYS);
        let now_s = scene.time_s;
        let both = |(way, _)| [Plan::Off(way, now_s), Plan::Back(way, now_s + LEFT_S)];
        self.begin(
            [Plan::Mission]
                .into_iter()
                .chain(ways.clone().flat_map(both)),
        );
        let (looks, _) = self.learn(scene, &studied, LEFT_S, flight);
        for ((way, chance), place) in ways.clone().zip(0..) {
            let (on_m, _) = self.costs_m(scene, &studied, &looks, 1 + 2 * place, flight);
            let (back_m, _) = self.costs_m(scene, &studied, &looks, 2 + 2 * place, flight);
            let cost_m = self.mean_m(&least(&on_m, &back_m));
            self.rank(Plan::Off(way, now_s), &chance, cost_m);
        }
        for later_s in LATER_S {
            let later = ways.clone().map(|(way, _)| Plan::Off(way, now_s + later_s));
            self.begin([Plan::Mission].into_iter().chain(later));
            let (looks, mut least_m) = self.learn(scene, &studied, later_s, flight);
            let mut always_m = [f64::INFINITY; WAYS];
            for (always_m, place) in always_m.iter_mut().zip(1..self.looked.len()) {
                let (costs_m, mean_m) = self.costs_m(scene, &studied, &looks, place, flight);
                least_m = least(&least_m, &costs_m);
                *always_m = mean_m;
            }
            let cost_m = self.mean_m(&least_m);
            let cheapest_m = always_m.into_iter().fold(f64::INFINITY, f64::min);
            for (always_m, place) in always_m.iter().zip(1..) {
                if let Some(one) = self.looked.get(place).copied() {
                    self.rank(one.plan, &one.chance, cost_m + always_m - cheapest_m);
                }
            }
        }
    }

    /// The one that the mission is most likely to meet is studied.
    fn studied<'a>(
        &mut self,
        scene: &Scene<'_>,
        others: &Others<'a>,
        here: &Aside,
        flight: &mut FlightPath,
    ) -> Option<Studied<'a>> {
        let (mut most, mut at) = (-1.0, 0);
        for (place, other) in others.iter().enumerate().filter(|_| others.len() > 1) {
            let mut only = Others::new((0.0, None));
            only.push(*other);
            self.begin([Plan::Mission]);
            self.look(scene, &only, flight);
            let loss = self.looked.first().map_or(0.0, |on| on.chance.loss);
            if loss > most {
                (most, at) = (loss, place);
            }
        }
        let mut rest = *others;
        let threat = rest.get_mut(at)?.1.take()?;
        Some(Studied {
            threat,
            rest,
            here: *here,
        })
    }

    /// Meets the others on the plans, and takes what is learned after some seconds: how each future looks then, and what the mission costs by
    /// that, metres. It is the first of the plans.
    fn learn(
        &mut self,
        scene: &Scene<'_>,
        studied: &Studied<'_>,
        after_s: f64,
        flight: &mut FlightPath,
    ) -> (Looks, Each) {
        self.look(scene, &studied.rest, flight);
        (studied.threat).ahead(scene, after_s as f32, &mut self.ahead);
        let mut looks = Looks {
            looks: self.ahead.looks_after(whole(after_s, SECONDS - 1)),
            starts_m: [0.0; FUTURES],
        };
        let (each, rest_m) = self.met(scene, studied, 0, flight);
        let mut costs_m = [0.0; FUTURES];
        for ((cost_m, starts_m), looks) in (costs_m.iter_mut())
            .zip(&mut looks.starts_m)
            .zip(&looks.looks)
        {
            let expected = Chance::mean(&each, looks);
            *starts_m = price::starts_m(&expected);
            *cost_m = rest_m + price::loss_m(&expected);
        }
        (looks, costs_m)
    }

    /// What a way costs as each future looks by then, and what it costs whatever is learned, metres.
    fn costs_m(
        &mut self,
        scene: &Scene<'_>,
        studied: &Studied<'_>,
        looks: &Looks,
        place: usize,
        flight: &mut FlightPath,
    ) -> (Each, f64) {
        let (each, rest_m) = self.met(scene, studied, place, flight);
        let mut costs_m = looks.starts_m;
        for (cost_m, looks) in costs_m.iter_mut().zip(&looks.looks) {
            *cost_m += rest_m + price::loss_m(&Chance::mean(&each, looks));
        }
        let met = Chance::mean(&each, self.ahead.weights());
        (costs_m, rest_m + price::loss_m(&met))
    }

    /// The chances of a plan with the aircraft that is studied, for each of its futures, and what it costs beside that, metres.
    fn met(
        &mut self,
        scene: &Scene<'_>,
        studied: &Studied<'_>,
        place: usize,
        flight: &mut FlightPath,
    ) -> ([Chance; FUTURES], f64) {
        let rest = self.looked.get(place).map(|one| one.chance);
        let each = self.meet(scene, place, flight);
        let departs_m = self
            .looked
            .get(place)
            .map(|one| one.departs_m(scene, &studied.here));
        let rest_m = price::loss_m(&rest.unwrap_or_default()) + departs_m.unwrap_or(0.0);
        (each, rest_m)
    }

    /// The mean of a number over the futures that may happen.
    fn mean_m(&self, each_m: &Each) -> f64 {
        let all = each_m.iter().zip(self.ahead.weights());
        all.map(|(each_m, weight)| each_m * f64::from(*weight))
            .sum()
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

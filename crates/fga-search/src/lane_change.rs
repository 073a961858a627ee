//! Lane changes: out to the side, up or down, and back to the mission's direction beside it.
//!
//! A single turn that clears crossing traffic goes on for as long as the traffic takes to pass. A lane change waits for
//! it beside the mission: two opposite turns fly a longer way for the same distance along the mission, so that traffic
//! passes ahead, and a climb that levels off passes above.

use fga_proof::angle::Side;
use fga_proof::certificate::Certificate;
use fga_proof::prediction::{MotionState, Target};

use super::departure::Departure;
use super::sweep::Sweep;
use super::{Found, Search, SecondTurn, Turns};

/// First turns to either side, radians.
const FIRST_TURNS_RAD: [f64; 4] = [0.6, 0.9, 1.2, 1.5];

/// The second turn ends at most this much beyond the mission's direction, radians.
const BEYOND_RAD: f64 = 1.6;

/// Tries of the moment at which a climb or descent levels off, the first one after the flight of a turn radius, ...
const TRIES: usize = 6;

/// ... and what each adds to the margin that it lacks, turn radii.
const NEAR: f64 = 0.005;

/// A lane change takes the place of a single turn if it departs at most by this share of its departure.
const WORTH: f64 = 0.8;

/// A first turn, and a second one to the other side.
#[derive(Debug, Clone, Copy)]
struct Aside {
    /// What the first turn is commanded to.
    on: Target,
    /// The aircraft where the second one begins.
    from: MotionState,
    /// Margin until there, metres.
    before_m: f64,
    /// The side of the second turn.
    side: Side,
    /// The second turn that leads back to the mission's direction, radians.
    back_rad: f64,
    /// About how far both depart, metres.
    departure_m: f64,
}

/// The best lane change so far.
struct Best {
    found: Option<Found>,
    /// What departs by this or more is worth less, metres.
    most_m: f64,
}

impl Best {
    fn take(&mut self, found: Found, departure_m: f64) {
        if departure_m < self.most_m {
            (self.found, self.most_m) = (Some(found), departure_m);
        }
    }
}

impl Search<'_> {
    /// The certified lane change that begins now and departs least, if it departs clearly less than a single turn.
    pub fn lane_change(&mut self, single: &Found) -> Option<Found> {
        let objective = self.scene.objective;
        let single_m = self.departure_of(&single.turns).length_m(objective);
        let mut best = Best {
            found: None,
            most_m: WORTH * single_m,
        };
        if self.least_m(FIRST_TURNS_RAD[0]) >= best.most_m {
            return None;
        }
        self.change_altitude(&mut best);
        let mut ways = [None; 2 * FIRST_TURNS_RAD.len()];
        let sides = ways.chunks_mut(Side::BOTH.len());
        for (first_rad, pair) in FIRST_TURNS_RAD.into_iter().zip(sides) {
            if self.least_m(first_rad) >= best.most_m {
                break;
            }
            for (side, slot) in Side::BOTH.into_iter().zip(pair) {
                *slot = self.aside(first_rad, side);
            }
        }
        let departure_m = |way: &Option<Aside>| way.map_or(f64::INFINITY, |way| way.departure_m);
        ways.sort_unstable_by(|a, b| departure_m(a).total_cmp(&departure_m(b)));
        for way in ways.into_iter().flatten() {
            if way.departure_m >= best.most_m {
                break;
            }
            self.change_aside(&way, &mut best);
        }
        best.found
    }

    /// What a lane change with a first turn departs by at least: with tightest turns, and back at once, metres.
    fn least_m(&self, first_rad: f64) -> f64 {
        let diameter_m = 2.0 * self.scene.turn_radius_m();
        let (sin, cos) = libm::sincos(first_rad);
        let least = Departure {
            aside_m: diameter_m * (1.0 - cos),
            behind_m: diameter_m * (first_rad - sin),
        };
        least.length_m(self.scene.objective)
    }

    /// The first of two opposite turns, and about how far both depart; `None` where lines rule out every second one.
    fn aside(&mut self, first_rad: f64, side: Side) -> Option<Aside> {
        let scene = self.scene;
        let (start, climb_rad, target_m) = (scene.start, scene.original.1, scene.target_m);
        if self.limit_met() {
            return None;
        }
        let on = Target {
            course_rad: start.course_rad + side.sign() * first_rad,
            climb_rad,
            rate_share: 1.0,
        };
        let after_s = first_rad / scene.flyer.course_rate_radps();
        let mut before = Certificate::clear(super::ENOUGH_M);
        let from = self.fly_until(&start, &on, start.time_s + after_s, target_m, &mut before);
        let back_rad = (from.course_rad - scene.original.0) * side.sign();
        if before.margin_m < target_m || back_rad <= 0.0 || self.limit_met() {
            return None;
        }
        let entry = Self::entry_at(&from, before.margin_m);
        let other = side.other();
        let second = self.way(&entry, climb_rad, other);
        let turn_rad = self.turn_rad(&entry, &second, (back_rad, back_rad + BEYOND_RAD))?;
        let tangent = self.tangent(&entry, &second, turn_rad)?;
        let mut way = Aside {
            on,
            from,
            before_m: before.margin_m,
            side: other,
            back_rad,
            departure_m: f64::MAX,
        };
        let departure = self.departure_on(0.0, &tangent.state, tangent.velocity_mps);
        way.departure_m = self.with_swing(&way, &tangent.state, departure);
        Some(way)
    }

    /// What a way departs by, where it is farthest aside on the mission's direction, metres.
    fn with_swing(&mut self, way: &Aside, leave: &MotionState, departure: Departure) -> f64 {
        let scene = self.scene;
        let beyond_rad = (leave.course_rad - way.from.course_rad).abs() - way.back_rad;
        let there = self.departure_at(leave.position_m, leave.time_s);
        let bow_m = scene.turn_radius_m() * (1.0 - libm::cos(beyond_rad.max(0.0)));
        let departure = Departure {
            aside_m: departure.aside_m.max(there.aside_m + bow_m),
            ..departure
        };
        departure.length_m(scene.objective)
    }

    /// Certifies two opposite turns, the second one to the mission's direction or as little beyond it as is certified.
    fn change_aside(&mut self, way: &Aside, best: &mut Best) {
        let target_m = self.scene.target_m;
        if self.limit_met() {
            return;
        }
        self.evaluated += 1;
        let (start, climb_rad) = (self.scene.start, way.on.climb_rad);
        let first = Turns {
            wait_s: 0.0,
            turn_rad: way.on.course_rad - start.course_rad,
            climb_rad,
            second: None,
        };
        let sweep = Sweep {
            from: way.from,
            first: Some(first),
            before_m: way.before_m,
            side: way.side,
            climb_rad,
            from_rad: way.back_rad,
            max_turn_rad: way.back_rad + BEYOND_RAD,
            floor_m: target_m,
            enough_m: target_m,
        };
        let Some(leave) = self.smallest(&sweep) else {
            return;
        };
        let turns = self.turns(&leave, &sweep);
        let departure = self.departure_of(&turns);
        let departure_m = self.with_swing(way, &leave.state, departure);
        let found = Found {
            turns,
            margin_m: leave.margin_m,
            cost: self.paper_cost(&turns, &start),
        };
        best.take(found, departure_m);
    }

    /// The steepest climb and descent that level off about as soon as is certified.
    fn change_altitude(&mut self, best: &mut Best) {
        let scene = self.scene;
        let (start, target_m) = (scene.start, scene.target_m);
        let near_m = NEAR * scene.turn_radius_m();
        for climb_rad in scene.extreme_climbs().skip(1) {
            let rises_mps =
                scene.flyer.airspeed_mps() * libm::sin(climb_rad - scene.original.1).abs();
            let mut after_s = 1.0 / scene.flyer.course_rate_radps();
            for _ in 0..TRIES {
                let about = Departure {
                    aside_m: rises_mps * after_s,
                    behind_m: 0.0,
                };
                if self.limit_met() || about.length_m(scene.objective) >= best.most_m {
                    break;
                }
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad: 0.0,
                    climb_rad,
                    second: Some(SecondTurn {
                        after_s,
                        turn_rad: 0.0,
                        climb_rad: scene.original.1,
                    }),
                };
                let certificate = self.certify(&turns, &start, f64::MIN);
                if certificate.holds(target_m) {
                    let found = Found {
                        turns,
                        margin_m: certificate.proven_m(),
                        cost: self.paper_cost(&turns, &start),
                    };
                    let departure_m = self.departure_of(&turns).length_m(scene.objective);
                    best.take(found, departure_m);
                    break;
                }
                let lacks_m = target_m - certificate.margin_m + near_m;
                after_s += lacks_m / rises_mps;
            }
        }
    }
}

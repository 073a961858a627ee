//! A flight decision by decision, for callers that decide outside of the engine.

use fga::avoider::Decision;
use fga::situation::{Ownship, Situation};
use fga::vehicle::Vehicle;

use super::flight::{Engine, FlightState, situation};
use super::{Observer, Outcome};
use crate::separation::Separation;
use crate::world::{World, WorldObstacle, WorldZone};

/// A flight that waits for each decision.
///
/// Look, decide, fly until the next decision: the same steps as [`Engine::fly`], in the same order and
/// with the same results, one at a time.
#[derive(Debug)]
pub struct SteppedFlight {
    engine: Engine,
    world: World,
    state: FlightState,
    /// The aircraft at the last look, or at the end.
    ownship: Ownship,
    /// Limits of the vehicle for the pilot.
    retuned: Option<Vehicle>,
    ended_s: Option<f64>,
}

impl SteppedFlight {
    /// A flight at the start of its world, after the first look.
    pub fn new(world: World) -> Self {
        let mut engine = Engine::new();
        let mut state = engine.begin(&world);
        let ownship = engine.flight(&world, &mut state).plant.ownship();
        let mut flight = Self {
            engine,
            ownship,
            world,
            state,
            retuned: None,
            ended_s: None,
        };
        flight.look();
        flight
    }

    /// Starts again, in another world.
    pub fn restart(&mut self, world: World) {
        self.world = world;
        self.state = self.engine.begin(&self.world);
        self.retuned = None;
        self.ended_s = None;
        self.look();
    }

    /// Looks at the obstacles where they are now.
    pub(crate) fn look(&mut self) {
        let retuned = &mut self.retuned;
        let mut flight = self.engine.flight(&self.world, &mut self.state);
        let time_s = flight.time_s();
        flight.look(time_s, |vehicle| *retuned = Some(*vehicle));
        self.ownship = flight.plant.ownship();
    }

    /// The world.
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The obstacles, whose motion after this time may still change.
    pub(crate) fn obstacles_mut(&mut self) -> &mut [WorldObstacle] {
        &mut self.world.obstacles
    }

    /// The world at the end.
    pub(crate) fn into_world(self) -> World {
        self.world
    }

    /// Time of the next decision, seconds; the time of the end once it is reached.
    pub fn time_s(&self) -> f64 {
        let period_s = self.world.settings.avoider.decision_period_s;
        let due_s = f64::from(self.state.cycle) * period_s;
        self.ended_s.unwrap_or(due_s)
    }

    /// Its velocity over the ground now, metres per second.
    pub(crate) fn ground_velocity_mps(&mut self) -> fga::Vec3 {
        let flight = self.engine.flight(&self.world, &mut self.state);
        flight.plant.ground_velocity_mps()
    }

    /// The aircraft now; angles through the air.
    pub const fn ownship(&self) -> &Ownship {
        &self.ownship
    }

    /// The known obstacles now; without the world's zones and its ground, which [`SteppedFlight::show`] has. `None` once the flight has ended.
    pub fn situation(&self) -> Option<Situation<'_>> {
        let sensor = &self.engine.sensor;
        self.ended_s.is_none().then(|| {
            situation(
                (&self.world, (&[], None)),
                self.ownship,
                sensor,
                self.time_s(),
            )
        })
    }

    /// Shows the known obstacles with the world's zones and its ground. `None` once the flight has ended.
    pub fn show<T>(&self, to: impl FnOnce(&Situation<'_>) -> T) -> Option<T> {
        let zones: Vec<_> = self.world.zones.iter().map(WorldZone::zone).collect();
        let ground = (self.world.ground.as_ref()).and_then(|ground| ground.ground());
        self.ended_s.is_none().then(|| {
            let around = (zones.as_slice(), ground.as_ref());
            let sensor = &self.engine.sensor;
            to(&situation(
                (&self.world, around),
                self.ownship,
                sensor,
                self.time_s(),
            ))
        })
    }

    /// Changed limits of the vehicle, once: the caller applies them before the next decision, as
    /// [`fga::pilot::Pilot::retune`] does.
    pub const fn take_retuned(&mut self) -> Option<Vehicle> {
        self.retuned.take()
    }

    /// Flies a decision until the next one is due, and looks. Returns whether the flight goes on; after
    /// the end it flies no further.
    pub fn advance(&mut self, decision: &Decision, observer: &mut impl Observer) -> bool {
        let goes_on = self.fly(decision, observer);
        if goes_on {
            self.look();
        }
        goes_on
    }

    /// The same without the look: [`Self::look`] comes before the next decision.
    pub(crate) fn fly(&mut self, decision: &Decision, observer: &mut impl Observer) -> bool {
        if self.ended_s.is_some() {
            return false;
        }
        let mut flight = self.engine.flight(&self.world, &mut self.state);
        let time_s = flight.time_s();
        flight.take(time_s, decision);
        flight.show(time_s, decision.state, observer);
        flight.follow_mission(time_s);
        self.ended_s = flight.fly_on(&decision.command, decision.state, 1, observer);
        self.ownship = flight.plant.ownship();
        self.ended_s.is_none()
    }

    /// Least separations until now, in the order of the world's obstacles.
    pub fn separations(&self) -> impl Iterator<Item = Separation> {
        let measured = &self.engine.measured;
        let each = measured.separations.iter().zip(&self.world.obstacles);
        each.map(|(separation, obstacle)| {
            let mut separation = *separation;
            if let Some((arc, end_m)) = &measured.straight {
                separation.observe(arc, *end_m, &obstacle.track);
            }
            separation
        })
    }

    /// The result of the flight so far.
    pub fn outcome(&mut self) -> Outcome {
        let time_s = self.time_s();
        // The flight may go on, and what it flies now with it.
        let measured = self.engine.measured.clone();
        let mut state = self.state.clone();
        let outcome = (self.engine.flight(&self.world, &mut state)).outcome(time_s);
        self.engine.measured = measured;
        outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Sample;
    use crate::policy::PolicyChoice;
    use crate::run::{Plan, fly};
    use crate::separation::STRAIGHT_M;
    use std::path::Path;

    struct Samples(Vec<Sample>);

    impl Observer for Samples {
        fn sample(&mut self, sample: &Sample) {
            self.0.push(*sample);
        }
    }

    #[test]
    fn a_flight_step_by_step_is_the_flight_of_the_engine_to_the_bit() {
        let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
        for name in [
            "first-flight.toml",
            "fig-16.toml",
            "sfo.toml",
            "ridge.toml",
            "fenced-valley.toml",
            "adsb.toml",
        ] {
            let plan = Plan::read(&scenarios.join(name), None).unwrap();
            let choice = PolicyChoice::default();
            let seen = choice.sees(&plan.world);
            let world = seen.unwrap_or_else(|| plan.world.clone());
            let mut pilot = choice.pilot(&world.settings, &world.vehicle).unwrap();
            let log = fly(plan, &choice, &mut |_| ()).unwrap();
            let mut flight = SteppedFlight::new(world);
            let mut decisions = log.decisions.iter();
            let mut samples = Samples(Vec::new());
            while let Some(decision) = flight.show(|situation| pilot.step(situation)) {
                assert_eq!(Some(&decision), decisions.next().map(|log| &log.decision));
                flight.advance(&decision, &mut samples);
                if let Some(vehicle) = flight.take_retuned() {
                    pilot.retune(&vehicle);
                }
                // To ask in between changes nothing, and knows the straight arc that goes on.
                let least_m = flight.outcome().min_separation_m;
                let (time_s, own_m) = (flight.time_s(), flight.ownship().position_m);
                let obstacles = flight.world().obstacles.iter();
                for (obstacle, separation) in obstacles.zip(flight.separations()) {
                    assert!(separation.distance().value_m >= least_m);
                    if let Some((at_m, _)) = obstacle.track.at(time_s) {
                        assert!(separation.distance().value_m <= at_m.distance(own_m) + STRAIGHT_M);
                    }
                }
            }
            assert_eq!(decisions.next(), None);
            assert_eq!(samples.0, log.samples);
            assert_eq!(flight.outcome(), log.outcome);
            let above_m = log.ground.map(|above| above.least.value_m);
            let zones_m = log.zones.iter().map(|zone| zone.margin.value_m);
            assert_eq!(log.outcome.min_terrain_clearance_m, above_m);
            assert_eq!(log.outcome.min_zone_margin_m, zones_m.reduce(f64::min));
        }
    }
}

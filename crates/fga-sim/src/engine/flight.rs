//! The engine, and the flight that it flies.

use core::f64::consts::TAU;
use std::time::Instant;

use fga::angle::{climb_of, course_of};
use fga::avoider::{Decision, State};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Ownship;
use fga::situation::{Mission, Obstacles, Situation};
use fga::vehicle::Vehicle;
use fga::zone::Zone;
use fga_judge::ground::GroundSeparation;

use super::measured::{Measured, Milestones, Outcome};
use super::observer::{DecisionMoment, Observer};
use super::steps::{LONGEST_SAMPLE_S, fly_step, recorded_arcs, sample_of};
use crate::plant::{Arc, Plant};
use crate::progress::{MissedWaypoint, MissionProgress, progress_of};
use crate::sensor::Sensor;
use crate::separation::{Least, Separation};
use crate::track::Track;
use crate::world::{BACK_WITHIN_M, BACK_WITHIN_RAD, Ending, World, WorldObstacle, WorldZone};

/// Flies worlds; it keeps its buffers from one to the next.
#[derive(Debug, Default)]
pub struct Engine {
    pub(super) plant: Option<Plant>,
    pub(super) sensor: Sensor,
    pub(super) measured: Measured,
    elapsed_ns: Vec<u64>,
    missed: Vec<MissedWaypoint>,
}

impl Engine {
    /// An engine with empty buffers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Waypoints that the last flight missed, in order.
    pub fn missed(&self) -> &[MissedWaypoint] {
        &self.missed
    }

    /// Least separations of the last flight, in the order of the world's obstacles.
    pub fn separations(&self) -> &[Separation] {
        &self.measured.separations
    }

    /// Least margins of the last flight from the world's zones, in their order; negative where it was on the wrong side.
    pub fn zone_margins(&self) -> impl Iterator<Item = Least> {
        self.measured.from_zones.iter().copied()
    }

    /// Least height of the last flight above the world's ground.
    pub const fn ground_separation(&self) -> Option<GroundSeparation> {
        self.measured.from_ground
    }

    /// First sight of each obstacle in the last flight, in the order of the world's.
    pub fn first_seen_s(&self) -> &[Option<f64>] {
        self.sensor.first_seen_s()
    }

    /// Duration of each decision made in the last flight, nanoseconds, in any order.
    pub fn elapsed_ns(&mut self) -> &mut [u64] {
        &mut self.elapsed_ns
    }

    /// Flies a world to its end.
    pub fn fly(
        &mut self,
        world: &World,
        pilot: &mut (impl Pilot + ?Sized),
        observer: &mut impl Observer,
    ) -> Outcome {
        let mut state = self.begin(world);
        self.flight(world, &mut state).fly(pilot, observer)
    }

    /// Puts the aircraft at the start of a world.
    pub(super) fn begin(&mut self, world: &World) -> FlightState {
        let plant = self
            .plant
            .get_or_insert_with(|| Plant::new(world.flies(), world.autopilot, world.blows_mps()));
        plant.refit(world.flies(), world.autopilot, world.blows_mps());
        world.gust.into_iter().for_each(|gust| plant.meet(gust));
        let start = &world.start;
        plant.place(0.0, start.position_m, start.course_rad, start.climb_rad);
        self.sensor.begin_all(
            world.sensor,
            &world.more_sensors,
            world.obstacles.len(),
            world.seed,
            world.stream,
        );
        self.elapsed_ns.clear();
        self.measured.begin(world);
        FlightState {
            milestones: Milestones::default(),
            progress: progress_of(world),
            replaying: world.recorded.is_some(),
            tuned_mps: world.vehicle.airspeed_mps,
            cycle: 0,
        }
    }

    /// Continues the flight that [`Engine::begin`] began.
    pub(super) fn flight<'a>(
        &'a mut self,
        world: &'a World,
        state: &'a mut FlightState,
    ) -> EngineFlight<'a> {
        let plant = self
            .plant
            .get_or_insert_with(|| Plant::new(world.flies(), world.autopilot, world.blows_mps()));
        EngineFlight {
            world,
            plant,
            sensor: &mut self.sensor,
            measured: &mut self.measured,
            zones: world.zones.iter().map(WorldZone::zone).collect(),
            ground: world.ground.as_ref().and_then(|ground| ground.ground()),
            elapsed_ns: &mut self.elapsed_ns,
            missed: &mut self.missed,
            state,
        }
    }
}

/// The state of a flight besides the aircraft, the sensor and the measurements.
#[derive(Debug, Clone)]
pub(super) struct FlightState {
    milestones: Milestones,
    pub(super) progress: MissionProgress,
    /// Whether the aircraft still follows the recording.
    pub(super) replaying: bool,
    /// Airspeed of the pilot's present limits, metres per second.
    pub(super) tuned_mps: f64,
    /// Number of decisions flown.
    pub(super) cycle: u32,
}

/// A flight in progress.
pub(super) struct EngineFlight<'a> {
    pub(super) world: &'a World,
    pub(super) plant: &'a mut Plant,
    pub(super) sensor: &'a mut Sensor,
    measured: &'a mut Measured,
    /// The world's zones.
    zones: Vec<Zone<'a>>,
    /// The world's ground.
    ground: Option<Ground<'a>>,
    elapsed_ns: &'a mut Vec<u64>,
    missed: &'a mut Vec<MissedWaypoint>,
    pub(super) state: &'a mut FlightState,
}

impl<'a> EngineFlight<'a> {
    fn fly(mut self, pilot: &mut (impl Pilot + ?Sized), observer: &mut impl Observer) -> Outcome {
        let end_s = loop {
            let time_s = self.time_s();
            let decision = self.decide(time_s, pilot, observer);
            let cycles = if observer.watches() {
                1
            } else {
                self.cycles_alike(time_s, &decision, pilot)
            };
            let end_s = self.fly_on(&decision.command, decision.state, cycles, observer);
            if let Some(end_s) = end_s {
                break end_s;
            }
        };
        self.outcome(end_s)
    }

    /// Time of the next decision, seconds.
    pub(super) fn time_s(&self) -> f64 {
        f64::from(self.state.cycle) * self.world.settings.avoider.decision_period_s
    }

    /// The recording, until the aircraft leaves it.
    pub(super) fn replaying(&self) -> Option<&'a Track> {
        let world = self.world;
        world.recorded.as_ref().filter(|_| self.state.replaying)
    }

    /// Flies a manoeuvre for some cycles; returns the time of the end once it is reached.
    pub(super) fn fly_on(
        &mut self,
        command: &Maneuver,
        state: State,
        cycles: u32,
        observer: &mut impl Observer,
    ) -> Option<f64> {
        let period_s = self.world.settings.avoider.decision_period_s;
        let time_s = self.time_s();
        // A recording without a manoeuvre ends where it ends.
        let horizon_s = self.world.horizon_s;
        let limit_s = self
            .replaying()
            .map_or(horizon_s, |track| horizon_s.min(track.presence_s().1));
        let left_s = limit_s - time_s;
        if left_s <= 1e-9 || self.ended(time_s) {
            return Some(time_s);
        }
        // The end need not coincide with a decision.
        let last = left_s < period_s + 1e-9;
        if self.replaying().is_none() {
            self.plant.command(command, left_s.min(period_s));
        }
        let mut left = cycles;
        loop {
            let is_together =
                left > 1 && self.state.progress.is_one_leg() && self.plant.is_straight();
            let (together, longest_sample_s) = if is_together {
                (left, f64::INFINITY)
            } else {
                (1, LONGEST_SAMPLE_S)
            };
            let until_s = if last {
                limit_s
            } else {
                f64::from(self.state.cycle + together) * period_s
            };
            self.advance(state, (until_s, longest_sample_s), observer);
            if last {
                self.follow_recording(limit_s);
                self.follow_mission(limit_s);
                self.show(limit_s, state, observer);
                return Some(limit_s);
            }
            self.state.cycle += together;
            left -= together;
            if left == 0 {
                return None;
            }
            self.follow_mission(self.time_s());
        }
    }

    /// Updates the progress along the mission.
    pub(super) fn follow_mission(&mut self, time_s: f64) {
        let plant = &self.plant;
        let position_m = plant.ownship().position_m;
        let straight_s = plant.straight_since_s();
        self.state
            .progress
            .follow(time_s, position_m, straight_s, || {
                plant.ground_velocity_mps()
            });
        let is_on_line = self.state.progress.is_on_line();
        self.state.milestones.confirm(time_s, is_on_line);
    }

    /// Updates the aircraft's state, looks, and retunes a pilot with limits of another airspeed.
    pub(super) fn look(&mut self, time_s: f64, mut retune: impl FnMut(&Vehicle)) {
        self.follow_recording(time_s);
        let world = self.world;
        let vehicle = world.plant.shown(self.plant.vehicle(), &world.vehicle);
        let airspeed_mps = vehicle.airspeed_mps;
        // A recording's speed changes from row to row in its last digits.
        if (airspeed_mps - self.state.tuned_mps).abs() > 1e-3 * self.state.tuned_mps {
            retune(&vehicle);
            self.state.tuned_mps = airspeed_mps;
        }
        let ownship = self.plant.ownship();
        self.sensor.face(ownship.course_rad);
        self.sensor
            .look(time_s, ownship.position_m, &self.world.obstacles);
    }

    /// Applies a decision.
    pub(super) fn take(&mut self, time_s: f64, decision: &Decision) {
        self.state.milestones.note(time_s, decision);
        if decision.state == State::Avoiding {
            self.state.replaying = false;
        }
    }

    /// What is known now, after a look.
    pub(super) fn situation(&self, time_s: f64) -> Situation<'_> {
        let fixed = (self.zones.as_slice(), self.ground.as_ref());
        situation(
            (self.world, fixed),
            self.plant.ownship(),
            self.sensor,
            time_s,
        )
    }

    /// Looks and decides.
    fn decide(
        &mut self,
        time_s: f64,
        pilot: &mut (impl Pilot + ?Sized),
        observer: &mut impl Observer,
    ) -> Decision {
        self.look(time_s, |vehicle| pilot.retune(vehicle));
        let situation = self.situation(time_s);
        let begun = Instant::now();
        let decision = pilot.step(&situation);
        let elapsed_ns = u64::try_from(begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
        observer.decision(&DecisionMoment {
            time_s,
            situation: &situation,
            decision: &decision,
            beliefs: pilot.beliefs(),
            elapsed_ns,
        });
        self.elapsed_ns.push(elapsed_ns);
        self.take(time_s, &decision);
        self.show(time_s, decision.state, observer);
        self.follow_mission(time_s);
        decision
    }

    /// Shows the state now.
    pub(super) fn show(&self, time_s: f64, state: State, observer: &mut impl Observer) {
        let plant = &self.plant;
        observer.sample(&sample_of(
            &plant.ownship(),
            plant.wind_mps(),
            time_s,
            state,
        ));
    }

    /// Flies until the next decision and measures.
    fn advance(
        &mut self,
        state: State,
        (until_s, longest_sample_s): (f64, f64),
        observer: &mut impl Observer,
    ) {
        let (replaying, time_s) = (self.replaying(), self.time_s());
        let (world, measured) = (self.world, &mut self.measured);
        if let Some(recorded) = replaying {
            recorded_arcs(recorded, time_s, until_s, &mut |arc| {
                measured.take(world, arc, arc.end_m());
            });
        } else {
            let is_sampled = observer.watches();
            let sample = |ownship: &Ownship, wind, time| {
                observer.sample(&sample_of(ownship, wind, time, state));
            };
            let flown = |arc: &Arc, end_m| measured.take(world, arc, end_m);
            fly_step(
                self.plant,
                (until_s, longest_sample_s),
                is_sampled,
                flown,
                sample,
            );
        }
    }

    /// Places the aircraft on the recording while it follows it.
    fn follow_recording(&mut self, time_s: f64) {
        let Some(recorded) = self.replaying() else {
            return;
        };
        let (first_s, last_s) = recorded.presence_s();
        if let Some((position_m, velocity_mps)) = recorded.at(time_s.clamp(first_s, last_s)) {
            let air_mps = velocity_mps - self.world.blows_mps();
            // The course nearest to that of now.
            let now_rad = self.plant.ownship().course_rad;
            let course_rad = now_rad + libm::remainder(course_of(air_mps) - now_rad, TAU);
            self.plant
                .place(time_s, position_m, course_rad, climb_of(air_mps));
            self.plant.fly_at(air_mps.length());
        }
    }

    /// Whether the flight ends before its horizon.
    fn ended(&self, time_s: f64) -> bool {
        let (world, milestones) = (self.world, &self.state.milestones);
        match world.ending {
            Ending::Horizon => false,
            Ending::MissionFlown => milestones.says_flown && milestones.last == State::Cruise,
            // Most flights are not back: ask the cheap question first.
            Ending::BackAndPassed
                if milestones.last != State::Cruise
                    || self.state.progress.cross_track_m() > BACK_WITHIN_M =>
            {
                false
            }
            Ending::BackAndPassed => {
                let position_m = self.plant.ownship().position_m;
                let velocity_mps = self.plant.ground_velocity_mps();
                let passed = |obstacle: &WorldObstacle| {
                    obstacle.track.at(time_s).is_none_or(|(at_m, moving_mps)| {
                        (position_m - at_m).dot(velocity_mps - moving_mps) >= 0.0
                    })
                };
                world.obstacles.iter().all(passed)
                    && velocity_mps.angle_between(self.state.progress.direction())
                        <= BACK_WITHIN_RAD
            }
        }
    }

    pub(super) fn outcome(&mut self, end_s: f64) -> Outcome {
        self.measured.end(self.world);
        self.state.progress.settle();
        let is_over = self.state.milestones.says_flown;
        if is_over {
            let dead_time_s = self.world.flies().response.dead_time_s;
            let step_m = self.plant.ground_velocity_mps() * dead_time_s;
            self.state.progress.coast(step_m);
        }
        *self.missed = self.state.progress.missed(is_over);
        if is_over {
            self.state.progress.end();
        }
        let (missed, state) = (self.missed.len(), &self.state);
        self.measured
            .outcome(end_s, &state.milestones, &state.progress, missed)
    }
}

/// The known obstacles at a time, after a look.
pub(super) fn situation<'a>(
    (world, (zones, ground)): (&'a World, (&'a [Zone<'a>], Option<&'a Ground<'a>>)),
    ownship: Ownship,
    sensor: &'a Sensor,
    time_s: f64,
) -> Situation<'a> {
    Situation {
        time_s,
        ownship: world.plant.shown_state(ownship, &world.vehicle),
        obstacles: Obstacles::Rows(sensor.known()),
        mission: Mission {
            waypoints_m: &world.mission_m,
            passing: &world.passing,
            limits_m: world.limits_m,
            zones,
            ground,
        },
        wind_mps: world.wind_mps,
    }
}

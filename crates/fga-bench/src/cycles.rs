//! Drawn encounters flown cycle by cycle, and the kind of each cycle.
//!
//! Depends only on the core, so that `tests/instructions` builds nothing else.

use core::f64::consts::PI;

use fga::Vec3;
use fga::avoider::{Avoider, Decision, Reason, Settings, State};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::vehicle::{Response, Vehicle};

/// The kind of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepKind {
    /// The way ahead is clear.
    Quiet,
    /// Flies or awaits a manoeuvre or way back, without a search.
    Kept,
    /// Searched a manoeuvre and found a certified one.
    Choosing,
    /// Searched a manoeuvre and found no certified one.
    Searching,
    /// Nothing is certified, and there was no search.
    Hopeless,
}

impl StepKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Quiet,
        Self::Kept,
        Self::Choosing,
        Self::Searching,
        Self::Hopeless,
    ];

    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quiet => "quiet",
            Self::Kept => "kept",
            Self::Choosing => "choosing",
            Self::Searching => "searching",
            Self::Hopeless => "hopeless",
        }
    }

    /// The kind of a decision.
    pub fn of(decision: &Decision) -> Self {
        let record = &decision.record;
        let fails = matches!(record.reason, Reason::BestAvailable | Reason::InsideVolume);
        match (record.work.candidates > 0, fails) {
            (true, true) => Self::Searching,
            (true, false) => Self::Choosing,
            (false, true) => Self::Hopeless,
            (false, false) if decision.state == State::Cruise => Self::Quiet,
            (false, false) => Self::Kept,
        }
    }
}

/// The aircraft and the quality of its sight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BenchAircraft {
    /// Table 4: it turns at once, and sees exactly.
    Ideal,
    /// Its bank lags by 0.6 s and its turn rate is 0.74 of the ideal one.
    Lagged,
    /// The same, and positions are known with σ 5 m, velocities with 0.5 m/s.
    Noisy,
    /// The lagged one among aircraft that may turn and climb.
    Flown,
}

impl BenchAircraft {
    /// All aircraft.
    pub const ALL: [Self; 4] = [Self::Ideal, Self::Lagged, Self::Noisy, Self::Flown];

    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ideal => "ideal",
            Self::Lagged => "lagged",
            Self::Noisy => "noisy",
            Self::Flown => "flown",
        }
    }

    /// Its limits and response.
    pub fn vehicle(self) -> Vehicle {
        let ideal = Vehicle::table_4();
        if self == Self::Ideal {
            return ideal;
        }
        Vehicle {
            response: Response {
                dead_time_s: 0.0,
                bank_time_constant_s: 0.6,
                turn_rate_factor: 0.74,
            },
            ..ideal
        }
    }
}

/// `SplitMix64` (Steele, Lea and Flood 2014): the same cases on every machine.
#[derive(Debug, Clone)]
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// A number in a range.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }
}

/// Time from one step to the next, seconds.
const PERIOD_S: f64 = 0.1;

/// Longest flight, cycles.
const MOST_CYCLES: u32 = 400;

/// A drawn encounter.
#[derive(Debug, Clone)]
pub struct BenchEncounter {
    aircraft: BenchAircraft,
    settings: Settings,
    vehicle: Vehicle,
    wind_mps: Vec3,
    waypoints_m: Vec<Vec3>,
    obstacles: Vec<Obstacle>,
    random: SplitMix64,
}

impl BenchEncounter {
    /// Threats that each meet the aircraft within 25 s, a few metres off its line.
    pub fn threats(aircraft: BenchAircraft, count: u32, number: u64) -> Self {
        let mut random = SplitMix64(number.wrapping_mul(1_000_003) ^ u64::from(count));
        let vehicle = aircraft.vehicle();
        let obstacles = (0..count)
            .map(|id| {
                let meets_s = random.within(8.0, 25.0);
                let off = Vec3::new(0.0, random.within(-20.0, 20.0), random.within(-10.0, 10.0));
                let course = random.within(-PI, PI);
                let speed = random.within(0.0, 60.0);
                let velocity = Vec3::new(course.cos(), course.sin(), 0.0) * speed;
                let meets_m = Vec3::X * vehicle.airspeed_mps * meets_s + off;
                let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
                let mut obstacle =
                    Obstacle::straight(id, meets_m - velocity * meets_s, velocity, volume);
                if aircraft == BenchAircraft::Noisy {
                    obstacle.uncertainty.position_m = 5.0;
                    obstacle.uncertainty.velocity_mps = 0.5;
                }
                if aircraft == BenchAircraft::Flown {
                    obstacle.movement = Movement::SMALL_UAS;
                }
                obstacle
            })
            .collect();
        Self {
            aircraft,
            settings: Settings {
                surveillance_radius_m: f64::INFINITY,
                ..Settings::default()
            },
            vehicle,
            wind_mps: Vec3::ZERO,
            waypoints_m: vec![Vec3::ZERO, Vec3::X * 1e5],
            obstacles,
            random,
        }
    }

    /// The slowest case: 250 obstacles in a ring, layers above and below, one on top of the aircraft,
    /// lag of 0.2 to 1.2 s, σ of 10 m, wind of up to 0.95 of the airspeed, a mission of short legs.
    pub fn adversarial(number: u64) -> Self {
        let mut random = SplitMix64(number.wrapping_mul(7_919) ^ 0xad);
        let mut encounter = Self::threats(BenchAircraft::Noisy, 0, number);
        let vehicle = &mut encounter.vehicle;
        vehicle.response.bank_time_constant_s = random.within(0.2, 1.2);
        let airspeed_mps = vehicle.airspeed_mps;
        if random.within(0.0, 1.0) < 0.5 {
            encounter.wind_mps = Vec3::Y * random.within(0.0, 0.95) * airspeed_mps;
        }
        if random.within(0.0, 1.0) < 0.5 {
            let legs = (0..200).map(|k| {
                let angle = 0.05 * f64::from(k);
                Vec3::new(angle.sin(), 1.0 - angle.cos(), 0.0) * 400.0
            });
            encounter.waypoints_m = legs.collect();
        }
        let flown = random.within(0.0, 1.0) < 0.5;
        let reach_m = airspeed_mps * random.within(5.0, 40.0);
        let has_layers = random.within(0.0, 1.0) < 0.5;
        encounter.obstacles = (0..250)
            .map(|id| {
                let angle = f64::from(id) * core::f64::consts::TAU / 250.0;
                let beside = Vec3::new(angle.cos(), angle.sin(), 0.0) * reach_m;
                let beside = beside * random.within(0.8, 1.2);
                let velocity = -beside / random.within(3.0, 60.0);
                let (position, volume) = match id {
                    0 if has_layers => (Vec3::Z * 60.0, layer()),
                    1 if has_layers => (-Vec3::Z * 60.0, layer()),
                    2 => (Vec3::X, cylinder(30.0)),
                    _ if id % 2 == 0 => (beside, cylinder(0.05 * reach_m)),
                    _ => {
                        let radius_m = 0.05 * reach_m;
                        (beside, ProtectedVolume::Sphere { radius_m })
                    }
                };
                let mut obstacle = Obstacle::straight(id, position, velocity, volume);
                obstacle.uncertainty.position_m = 10.0;
                obstacle.uncertainty.velocity_mps = 1.0;
                if id < 2 && has_layers {
                    obstacle = Obstacle::straight(id, position, Vec3::ZERO, volume);
                    obstacle.movement = Movement::AtRest;
                } else if flown {
                    obstacle.movement = Movement::CREWED;
                }
                obstacle
            })
            .collect();
        encounter
    }

    /// The same with another limit of a step's work.
    #[must_use]
    pub const fn with_work_limit(mut self, work_limit: u32) -> Self {
        self.settings.work_limit = work_limit;
        self
    }

    /// Flies it and shows each cycle: the avoider before its step, the situation, and the decision;
    /// ends when `look` has seen enough.
    ///
    /// # Panics
    /// If the core refuses the vehicle, which is a fault of the encounter.
    pub fn fly(mut self, mut look: impl FnMut(&Avoider, &Situation<'_>, &Decision) -> bool) {
        let mut avoider = Avoider::new(self.settings, self.vehicle).expect("drawn within limits");
        let flyer = Flyer::new(&self.vehicle);
        let mut path = FlightPath::new();
        let mut own = Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: self.vehicle.airspeed_mps,
        };
        let mut seen = self.obstacles.clone();
        for cycle in 0..MOST_CYCLES {
            let time_s = f64::from(cycle) * PERIOD_S;
            for (seen, truth) in seen.iter_mut().zip(&self.obstacles) {
                seen.position_m = truth.position_after_m(time_s);
                if self.aircraft == BenchAircraft::Noisy {
                    let random = &mut self.random;
                    let mut off = || random.within(-5.0, 5.0);
                    seen.position_m += Vec3::new(off(), off(), off());
                }
            }
            let situation = Situation {
                time_s,
                ownship: own,
                obstacles: Obstacles::Rows(&seen),
                mission: Mission::new(&self.waypoints_m),
                wind_mps: self.wind_mps,
            };
            let before = avoider.clone();
            let decision = avoider.step(&situation);
            if look(&before, &situation, &decision) {
                return;
            }
            path.predict(
                &flyer,
                &MotionState::of(&own),
                &decision.command,
                2.0 * PERIOD_S,
            );
            let Some(state) = path.state_at(&flyer, PERIOD_S) else {
                return;
            };
            own.position_m = state.position_m + self.wind_mps * PERIOD_S;
            own.course_rad = state.course_rad;
            own.climb_rad = state.climb_rad;
            own.bank_rad = state.bank_rad;
        }
    }
}

fn cylinder(radius_m: f64) -> ProtectedVolume {
    ProtectedVolume::Cylinder {
        radius_m,
        half_height_m: 0.3 * radius_m,
    }
}

fn layer() -> ProtectedVolume {
    ProtectedVolume::Cylinder {
        radius_m: 1e5,
        half_height_m: 10.0,
    }
}

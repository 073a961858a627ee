//! What the caller gives, as structures of C, and its translation.

use fga::Vec3;
use fga::avoider::{Settings, Start};
use fga::limit::{LARGEST_M, LATEST_S, SettingsError};
use fga::maneuver::{Maneuver, Stage};
use fga::search::Objective;
use fga::situation::{
    Mission, Movement, MovementBounds, Obstacle, ObstacleKind, Obstacles, Ownship, Passing,
    ProtectedVolume, Situation, Uncertainty,
};
use fga::vehicle::{Response, Vehicle};

use crate::airspace::{fga_ground, fga_zone};
use crate::growable::{Growable, size_word};
use crate::status::{Refused, fga_status};

/// The parts of a position and of the wind, for a refusal.
const POSITION: [&str; 3] = ["position_m.east", "position_m.north", "position_m.up"];
pub(crate) const WIND: [&str; 3] = ["wind_mps.east", "wind_mps.north", "wind_mps.up"];

const FINITE: &str = "a finite number up to 1e7";

/// A vector in the local frame: east, north, up.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_enu {
    /// East.
    pub east: f64,
    /// North.
    pub north: f64,
    /// Up.
    pub up: f64,
}

impl fga_enu {
    /// The vector, if all of it can be calculated with; the names are those of its parts.
    pub(crate) fn usable(self, names: [&'static str; 3]) -> Result<Vec3, Refused> {
        let vector = self.vector();
        for (name, value) in names.into_iter().zip(vector.to_array()) {
            usable(name, value)?;
        }
        Ok(vector)
    }

    const fn vector(self) -> Vec3 {
        Vec3::new(self.east, self.north, self.up)
    }

    pub(crate) const fn of(vector: Vec3) -> Self {
        Self {
            east: vector.x,
            north: vector.y,
            up: vector.z,
        }
    }
}

/// The limits of the aircraft at its airspeed. `fga_vehicle_from_bank` fills it; then adapt it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_vehicle {
    /// `sizeof(fga_vehicle)`.
    pub size: u32,
    /// Constant total airspeed, metres per second: 1 to 1,000.
    pub airspeed_mps: f64,
    /// Least radius of the coordinated turn, metres: 1 to 1,000,000, and no turn of more than 10 g.
    pub turn_radius_m: f64,
    /// Steepest descent, radians: -80 degrees to 0.
    pub climb_min_rad: f64,
    /// Steepest climb, radians: 0 to 80 degrees; with 0 and 0 the aircraft stays at its altitude.
    pub climb_max_rad: f64,
    /// Largest rate of the climb angle, radians per second: 0 to 10.
    pub climb_rate_radps: f64,
    /// Delay from a command to its first effect, 0 to 10 seconds. With a delay, pass to a step the state predicted for its end
    /// (`fga_predict`).
    pub dead_time_s: f64,
    /// Time constant of the first-order response of the bank, seconds: 0, or 0.01 to 10.
    pub bank_time_constant_s: f64,
    /// Flown course rate over the ideal g tan(bank) / airspeed: 0.05 to 2, and 1 for the ideal turn.
    pub turn_rate_factor: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_vehicle {}

impl fga_vehicle {
    pub(crate) fn vehicle(&self) -> Result<Vehicle, Refused> {
        let vehicle = Vehicle {
            airspeed_mps: self.airspeed_mps,
            turn_radius_m: self.turn_radius_m,
            climb_min_rad: self.climb_min_rad,
            climb_max_rad: self.climb_max_rad,
            climb_rate_radps: self.climb_rate_radps,
            response: Response {
                dead_time_s: self.dead_time_s,
                bank_time_constant_s: self.bank_time_constant_s,
                turn_rate_factor: self.turn_rate_factor,
            },
        };
        vehicle.check()?;
        Ok(vehicle)
    }

    /// All but its size.
    pub(crate) const fn set(&mut self, vehicle: &Vehicle) {
        self.airspeed_mps = vehicle.airspeed_mps;
        self.turn_radius_m = vehicle.turn_radius_m;
        self.climb_min_rad = vehicle.climb_min_rad;
        self.climb_max_rad = vehicle.climb_max_rad;
        self.climb_rate_radps = vehicle.climb_rate_radps;
        self.dead_time_s = vehicle.response.dead_time_s;
        self.bank_time_constant_s = vehicle.response.bank_time_constant_s;
        self.turn_rate_factor = vehicle.response.turn_rate_factor;
    }
}

/// When a manoeuvre begins.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_start {
    /// Chosen with the manoeuvre for the least departure from the mission.
    Free = 0,
    /// At once, when the threat is first seen.
    AtDetection = 1,
    /// At the latest certified start.
    Latest = 2,
    /// At `start_score` times that, from 0 to 1.
    Score = 3,
}

/// What the cheapest manoeuvre is.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_objective {
    /// Least cost of the changes of course and climb angle.
    PaperCost = 0,
    /// Least distance from the mission.
    LeastDeviation = 1,
    /// Least extra path.
    ShortestPath = 2,
}

/// Settings of the decisions. `fga_settings_default` fills it; then adapt it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_settings {
    /// `sizeof(fga_settings)`.
    pub size: u32,
    /// When a manoeuvre begins: an `fga_start`; by default `FGA_START_FREE`.
    pub start: u32,
    /// The share of `FGA_START_SCORE`, 0 to 1; otherwise not read.
    pub start_score: f64,
    /// Time from one step to the next, seconds: 0.001 to 10; by default 0.1.
    pub decision_period_s: f64,
    /// Obstacles farther away than this are not considered, metres, above 0; by default `INFINITY`, which considers all.
    pub surveillance_radius_m: f64,
    /// How far ahead a manoeuvre is proven, seconds: 1 to 600; by default 60.
    pub horizon_s: f64,
    /// Distance kept beyond the protected volumes, metres: 0 to 10,000; by default 0.05.
    pub margin_m: f64,
    /// Standard deviation of the velocity with which gusts and the autopilot carry the aircraft off its prediction, as known
    /// beforehand, metres per second: 0 to 100. It is measured in flight too; by default 0.
    pub drift_mps: f64,
    /// Standard deviations of an obstacle's uncertainty by which its volume grows: 0 to 10; by default 3.
    pub confidence_sigmas: f64,
    /// Cost of a change of course, per radian: 0 to 1e6; by default 0.2.
    pub heading_cost: f64,
    /// Cost of a change of climb angle, per radian: 0 to 1e6; by default 0.5.
    pub pitch_cost: f64,
    /// What the cheapest manoeuvre is: an `fga_objective`; by default `FGA_OBJECTIVE_PAPER_COST`.
    pub objective: u32,
    /// Most work of one step, in tests of a line against four obstacles: 10,000 to 1e9; by default 100000.
    pub work_limit: u32,
    /// Price of a loss of a protected volume on beliefs, in metres of departure from the mission: 100 to 1e7; by default 42000.
    pub loss_price_m: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_settings {}

impl fga_settings {
    pub(crate) fn settings(&self) -> Result<Settings, Refused> {
        let start = match self.start {
            start if start == fga_start::Free as u32 => Start::Free,
            start if start == fga_start::AtDetection as u32 => Start::AtDetection,
            start if start == fga_start::Latest as u32 => Start::Latest,
            start if start == fga_start::Score as u32 => Start::Score(self.start_score),
            other => return Err(Refused::unknown("start", other, "an fga_start")),
        };
        let objective = match self.objective {
            objective if objective == fga_objective::PaperCost as u32 => Objective::PaperCost,
            objective if objective == fga_objective::LeastDeviation as u32 => {
                Objective::LeastDeviation
            }
            objective if objective == fga_objective::ShortestPath as u32 => Objective::ShortestPath,
            other => return Err(Refused::unknown("objective", other, "an fga_objective")),
        };
        let settings = Settings {
            start,
            decision_period_s: self.decision_period_s,
            surveillance_radius_m: self.surveillance_radius_m,
            horizon_s: self.horizon_s,
            margin_m: self.margin_m,
            drift_mps: self.drift_mps,
            confidence_sigmas: self.confidence_sigmas,
            heading_cost: self.heading_cost,
            pitch_cost: self.pitch_cost,
            objective,
            work_limit: self.work_limit,
            loss_price_m: self.loss_price_m,
        };
        settings.check()?;
        Ok(settings)
    }

    /// All but its size.
    pub(crate) const fn set(&mut self, settings: &Settings) {
        (self.start, self.start_score) = match settings.start {
            Start::Free => (fga_start::Free as u32, 0.0),
            Start::AtDetection => (fga_start::AtDetection as u32, 0.0),
            Start::Latest => (fga_start::Latest as u32, 0.0),
            Start::Score(score) => (fga_start::Score as u32, score),
        };
        self.decision_period_s = settings.decision_period_s;
        self.surveillance_radius_m = settings.surveillance_radius_m;
        self.horizon_s = settings.horizon_s;
        self.margin_m = settings.margin_m;
        self.drift_mps = settings.drift_mps;
        self.confidence_sigmas = settings.confidence_sigmas;
        self.heading_cost = settings.heading_cost;
        self.pitch_cost = settings.pitch_cost;
        self.objective = match settings.objective {
            Objective::PaperCost => fga_objective::PaperCost as u32,
            Objective::LeastDeviation => fga_objective::LeastDeviation as u32,
            Objective::ShortestPath => fga_objective::ShortestPath as u32,
        };
        self.work_limit = settings.work_limit;
        self.loss_price_m = settings.loss_price_m;
    }
}

/// How the aircraft passes a waypoint.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_passing {
    /// It turns before the waypoint onto the next leg.
    FlyBy = 0,
    /// It turns after the waypoint, which it passes within 5 m.
    FlyOver = 1,
}

/// A waypoint of the mission.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_waypoint {
    /// Its place, metres.
    pub position_m: fga_enu,
    /// How the aircraft passes it: an `fga_passing`.
    pub passing: u32,
}

impl fga_waypoint {
    pub(crate) fn waypoint(&self) -> Result<(Vec3, Passing), Refused> {
        let passing = match self.passing {
            passing if passing == fga_passing::FlyBy as u32 => Passing::FlyBy,
            passing if passing == fga_passing::FlyOver as u32 => Passing::FlyOver,
            other => return Err(Refused::unknown("passing", other, "an fga_passing")),
        };
        Ok((self.position_m.usable(POSITION)?, passing))
    }
}

/// The mission: from each waypoint to the next along the straight leg. With fewer than two waypoints the aircraft holds its
/// course and altitude.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_mission {
    /// `sizeof(fga_mission)`.
    pub size: u32,
    /// Number of waypoints.
    pub waypoint_count: u32,
    /// The waypoints, first to last; they are copied.
    pub waypoints: *const fga_waypoint,
    /// Lowest altitude that a manoeuvre may come to, metres up; `-INFINITY` without a limit.
    pub floor_m: f64,
    /// Highest altitude that a manoeuvre may come to, metres up; `INFINITY` without a limit.
    pub ceiling_m: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers and a pointer that may be null.
unsafe impl Growable for fga_mission {}

impl fga_mission {
    pub(crate) fn limits_m(&self) -> Result<(f64, f64), Refused> {
        let (floor_m, ceiling_m) = (self.floor_m, self.ceiling_m);
        if floor_m < ceiling_m {
            return Ok((floor_m, ceiling_m));
        }
        let below = "a number below ceiling_m, -INFINITY without a limit";
        Err(Refused::out_of_range("floor_m", floor_m, below))
    }
}

/// The state of the aircraft in the air mass.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_ownship {
    /// Position, metres.
    pub position_m: fga_enu,
    /// Course through the air, radians from east towards north; any number of turns.
    pub course_from_east_rad: f64,
    /// Climb angle, radians, positive upwards.
    pub climb_rad: f64,
    /// Bank angle, radians, positive in a left turn.
    pub bank_left_rad: f64,
    /// Total airspeed, metres per second, above 0.
    pub airspeed_mps: f64,
}

impl fga_ownship {
    pub(crate) fn ownship(&self) -> Result<Ownship, Refused> {
        let position_m = self.position_m.usable(POSITION)?;
        usable("course_from_east_rad", self.course_from_east_rad)?;
        usable("climb_rad", self.climb_rad)?;
        usable("bank_left_rad", self.bank_left_rad)?;
        usable("airspeed_mps", self.airspeed_mps)?;
        if self.airspeed_mps <= 0.0 {
            let positive = "a positive number";
            return Err(Refused::out_of_range(
                "airspeed_mps",
                self.airspeed_mps,
                positive,
            ));
        }
        Ok(Ownship {
            position_m,
            course_rad: self.course_from_east_rad,
            climb_rad: self.climb_rad,
            bank_rad: self.bank_left_rad,
            airspeed_mps: self.airspeed_mps,
        })
    }
}

/// The form of a protected volume.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_volume {
    /// A sphere of `radius_m`.
    Sphere = 1,
    /// An upright cylinder of `radius_m` that reaches `half_height_m` above and below the obstacle.
    Cylinder = 2,
}

/// The possible motion of an obstacle from now on. A decision relies on it.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_movement {
    /// It stays at its position: its velocity is 0, but for noise where `velocity_sigma_mps` is above 0.
    AtRest = 1,
    /// It keeps its velocity over the ground: optimistic for an aircraft.
    Straight = 2,
    /// A crewed aircraft: turns of 3 degrees a second, 6 for some seconds, 60 in all; changes of climb of 2.54 m/s; 0.5 m/s2.
    Crewed = 3,
    /// A small unmanned aircraft: 15 degrees a second, 37 for some seconds, 90 in all; 2.5 m/s; 2 m/s2.
    SmallUas = 4,
    /// An aircraft within the bounds of the obstacle.
    Bounded = 5,
}

/// The bounds of an aircraft, none below 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_bounds {
    /// Sustained turn rate, radians per second.
    pub turn_rate_radps: f64,
    /// Turn rate for some seconds, radians per second.
    pub brief_turn_rate_radps: f64,
    /// Turn that a decision withstands where possible, radians.
    pub turn_rad: f64,
    /// Change of its vertical speed, metres per second.
    pub climb_change_mps: f64,
    /// Change of its speed, metres per second squared.
    pub acceleration_mps2: f64,
}

/// An obstacle: a point that moves inside its protected volume.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_obstacle {
    /// `sizeof(fga_obstacle)`.
    pub size: u32,
    /// Its identifier, the same from step to step, and unique among the obstacles of a step.
    pub id: u32,
    /// Centre of its volume now, metres.
    pub position_m: fga_enu,
    /// Velocity over the ground, metres per second.
    pub velocity_mps: fga_enu,
    /// The form of its volume: an `fga_volume`. There is no default.
    pub volume: u32,
    /// Its possible motion: an `fga_movement`. There is no default.
    pub movement: u32,
    /// Radius of its volume, metres, 0 or more.
    pub radius_m: f64,
    /// Half height of a cylinder, metres, 0 or more; of a sphere not read.
    pub half_height_m: f64,
    /// Standard deviation of its position along any axis, metres; 0 if known exactly.
    pub position_sigma_m: f64,
    /// Standard deviation of its velocity along any axis, metres per second; 0 if known exactly.
    pub velocity_sigma_mps: f64,
    /// Age of the report from which its position and velocity are carried on, seconds: its motion may have changed since. One below 0 counts as 0.
    pub age_s: f64,
    /// The bounds of `FGA_MOVEMENT_BOUNDED`; otherwise not read.
    pub bounds: fga_bounds,
}

impl fga_obstacle {
    /// Checks the size that each of some obstacles says.
    pub(crate) fn sized(obstacles: &[Self]) -> Result<(), fga_status> {
        if (obstacles.iter()).all(|obstacle| obstacle.size == size_word::<Self>()) {
            Ok(())
        } else {
            Err(fga_status::WrongSize)
        }
    }

    /// Refused where a number is unusable, stands for no volume or movement, or surely moves what is at rest.
    pub(crate) fn obstacle(&self) -> Result<Obstacle, Refused> {
        let expected = "finite numbers, none negative, an fga_volume and an fga_movement";
        let unusable = || Refused::out_of_range("obstacles", f64::from(self.id), expected);
        let radius_m = self.radius_m;
        let volume = match self.volume {
            form if form == fga_volume::Sphere as u32 => ProtectedVolume::Sphere { radius_m },
            form if form == fga_volume::Cylinder as u32 => ProtectedVolume::Cylinder {
                radius_m,
                half_height_m: self.half_height_m,
            },
            _ => return Err(unusable()),
        };
        let movement = match self.movement {
            movement if movement == fga_movement::AtRest as u32 => Movement::AtRest,
            movement if movement == fga_movement::Straight as u32 => Movement::Straight,
            movement if movement == fga_movement::Crewed as u32 => Movement::CREWED,
            movement if movement == fga_movement::SmallUas as u32 => Movement::SMALL_UAS,
            movement if movement == fga_movement::Bounded as u32 => {
                Movement::Aircraft(MovementBounds {
                    turn_rate_radps: self.bounds.turn_rate_radps,
                    brief_turn_rate_radps: self.bounds.brief_turn_rate_radps,
                    turn_rad: self.bounds.turn_rad,
                    climb_change_mps: self.bounds.climb_change_mps,
                    acceleration_mps2: self.bounds.acceleration_mps2,
                })
            }
            _ => return Err(unusable()),
        };
        let obstacle = Obstacle {
            id: self.id,
            position_m: self.position_m.vector(),
            velocity_mps: self.velocity_mps.vector(),
            volume,
            kind: ObstacleKind::Unknown,
            uncertainty: Uncertainty {
                position_m: self.position_sigma_m,
                velocity_mps: self.velocity_sigma_mps,
            },
            movement,
            age_s: self.age_s,
        };
        if !obstacle.is_valid() {
            return Err(unusable());
        }
        if obstacle.moves_at_rest() {
            let largest_mps = obstacle.velocity_mps.abs().max_element();
            let expected = "0 of FGA_MOVEMENT_AT_REST, a velocity_sigma_mps, or another movement";
            let field = "obstacles.velocity_mps";
            return Err(Refused::out_of_range(field, largest_mps, expected));
        }
        Ok(obstacle)
    }
}

/// What is around the aircraft at a moment. Positions and velocities are over the ground.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_situation {
    /// `sizeof(fga_situation)`.
    pub size: u32,
    /// Number of obstacles.
    pub obstacle_count: u32,
    /// The obstacles; they are read during the call only.
    pub obstacles: *const fga_obstacle,
    /// Time of the state, seconds on any clock that does not run backwards.
    pub time_s: f64,
    /// The aircraft. Its course and climb angle describe its motion through the air.
    pub ownship: fga_ownship,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: fga_enu,
    /// Number of zones: at most `FGA_ZONES_MOST`.
    pub zone_count: u32,
    /// The zones; they and their corners are read during the call only.
    pub zones: *const fga_zone,
    /// The ground, read during the call only; null where it is not known and not asked for.
    pub ground: *const fga_ground,
}

// SAFETY: `repr(C)`, the size first, then numbers and pointers that may be null.
unsafe impl Growable for fga_situation {}

impl fga_situation {
    /// Says time, aircraft and wind.
    pub(crate) fn moment(&self, now: &mut Situation<'_>) -> Result<(), Refused> {
        now.time_s = usable_time("time_s", self.time_s)?;
        now.wind_mps = self.wind_mps.usable(WIND)?;
        now.ownship = self.ownship.ownship()?;
        Ok(())
    }
}

/// A situation of which nothing is said yet.
pub(crate) const UNSAID: Situation<'static> = Situation {
    time_s: 0.0,
    ownship: Ownship {
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 0.0,
    },
    obstacles: Obstacles::Rows(&[]),
    mission: Mission::NONE,
    wind_mps: Vec3::ZERO,
};

/// A command from a moment on, until the next stage begins.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_stage {
    /// Its start, seconds from the decision; at 0 or below it has begun.
    pub start_s: f64,
    /// Course to turn to, radians from east towards north. Not wrapped: the aircraft turns by the plain difference to its own
    /// course, which says to which side, and may be more than half a turn.
    pub course_from_east_rad: f64,
    /// Climb angle to take up, radians, positive upwards.
    pub climb_rad: f64,
    /// Share of the largest course rate to turn with, above 0 and up to 1.
    pub rate_share: f64,
}

impl fga_stage {
    pub(crate) const fn of(stage: &Stage) -> Self {
        Self {
            start_s: stage.start_s,
            course_from_east_rad: stage.course_rad,
            climb_rad: stage.climb_rad,
            rate_share: stage.rate_share,
        }
    }
}

/// Fills a manoeuvre, which is large, with some stages. Of those that have begun the last one is flown.
pub(crate) fn take_stages(maneuver: &mut Maneuver, stages: &[fga_stage]) -> Result<(), Refused> {
    maneuver.set([]);
    let mut last_s = f64::NEG_INFINITY;
    for (index, stage) in stages.iter().enumerate() {
        let (start_s, share) = (stage.start_s, stage.rate_share);
        let check = || -> Result<(), Refused> {
            usable("start_s", start_s)?;
            usable("course_from_east_rad", stage.course_from_east_rad)?;
            usable("climb_rad", stage.climb_rad)?;
            let in_order = "no stage before the one in front of it";
            SettingsError::unless(start_s >= last_s, "start_s", start_s, in_order)?;
            let is_share = share > 0.0 && share <= 1.0;
            SettingsError::unless(is_share, "rate_share", share, "above 0 and up to 1")?;
            Ok(())
        };
        check().map_err(|refused| refused.at(index))?;
        last_s = start_s;
        if start_s <= 0.0 {
            maneuver.set([]);
        }
        maneuver.push(Stage {
            start_s: start_s.max(0.0),
            course_rad: stage.course_from_east_rad,
            climb_rad: stage.climb_rad,
            rate_share: share,
        });
    }
    Ok(())
}

/// Refuses a number that is not finite, or too large to calculate with.
pub(crate) fn usable(field: &'static str, value: f64) -> Result<(), Refused> {
    SettingsError::unless(value.abs() <= LARGEST_M, field, value, FINITE)?;
    Ok(())
}

/// The volume of a radius and a half height, metres, neither below 0: a cylinder, or without height a sphere.
pub(crate) fn volume(radius_m: f64, half_height_m: f64) -> Result<ProtectedVolume, Refused> {
    for (field, length_m) in [("radius_m", radius_m), ("half_height_m", half_height_m)] {
        usable(field, length_m)?;
        if length_m < 0.0 {
            return Err(Refused::out_of_range(field, length_m, "0 or more"));
        }
    }
    Ok(if half_height_m > 0.0 {
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        }
    } else {
        ProtectedVolume::Sphere { radius_m }
    })
}

/// A time, seconds, if it can be calculated with.
pub(crate) fn usable_time(field: &'static str, time_s: f64) -> Result<f64, Refused> {
    let is_time = time_s.abs() <= LATEST_S;
    SettingsError::unless(is_time, field, time_s, "a finite number up to 1e10")?;
    Ok(time_s)
}

//! A flight of the ideal vehicle under a pilot's commands, and its surroundings.

use fga::Vec3;
use fga::avoider::Decision;
use fga::ground::Ground;
use fga::pilot::Pilot;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Obstacles, Situation};
use fga::situation::{Obstacle, Ownship, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};
use fga::zone::Zone;

pub(crate) const PERIOD_S: f64 = 0.1;

/// The aircraft of Table 4.
pub(crate) fn vehicle() -> Vehicle {
    let climb_rad = 15.0_f64.to_radians();
    Vehicle {
        airspeed_mps: 15.0,
        turn_radius_m: 30.0,
        climb_min_rad: -climb_rad,
        climb_max_rad: climb_rad,
        climb_rate_radps: 0.2,
        response: Response::default(),
    }
}

pub(crate) fn planar() -> Vehicle {
    Vehicle {
        climb_min_rad: 0.0,
        climb_max_rad: 0.0,
        ..vehicle()
    }
}

pub(crate) fn sphere(id: u32, position_m: Vec3, velocity_mps: Vec3, radius_m: f64) -> Obstacle {
    Obstacle::straight(
        id,
        position_m,
        velocity_mps,
        ProtectedVolume::Sphere { radius_m },
    )
}

/// The aircraft at the origin, level along +x, on a mission along +x.
pub(crate) struct Flight {
    pub(crate) pilot: Box<dyn Pilot>,
    pub(crate) own: Ownship,
    pub(crate) time_s: f64,
    pub(crate) waypoints_m: Vec<Vec3>,
    pub(crate) zones: Vec<Zone<'static>>,
    pub(crate) ground: Option<Ground<'static>>,
    pub(crate) wind_mps: Vec3,
    pub(crate) flyer: Flyer,
    pub(crate) path: FlightPath,
}

impl Flight {
    pub(crate) fn of(pilot: impl Pilot + 'static, vehicle: Vehicle) -> Self {
        Self {
            pilot: Box::new(pilot),
            own: Ownship {
                position_m: Vec3::ZERO,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: vehicle.airspeed_mps,
            },
            time_s: 0.0,
            waypoints_m: vec![Vec3::ZERO, Vec3::X * 1e5],
            zones: Vec::new(),
            ground: None,
            wind_mps: Vec3::ZERO,
            flyer: Flyer::new(&vehicle),
            path: FlightPath::new(),
        }
    }

    pub(crate) fn decide(&mut self, obstacles: &[Obstacle]) -> Decision {
        self.pilot.step(&Situation {
            time_s: self.time_s,
            ownship: self.own,
            obstacles: Obstacles::Rows(obstacles),
            mission: Mission {
                zones: &self.zones,
                ground: self.ground.as_ref(),
                ..Mission::new(&self.waypoints_m)
            },
            wind_mps: self.wind_mps,
        })
    }

    /// One step, flown; obstacles move on, unless they are at rest.
    pub(crate) fn cycle(&mut self, obstacles: &mut [Obstacle]) -> Decision {
        let decision = self.decide(obstacles);
        let start = MotionState::of(&self.own);
        self.path
            .predict(&self.flyer, &start, &decision.command, 2.0 * PERIOD_S);
        let next = self.path.state_at(&self.flyer, PERIOD_S).unwrap();
        self.own.position_m = next.position_m + self.wind_mps * PERIOD_S;
        self.own.course_rad = next.course_rad;
        self.own.climb_rad = next.climb_rad;
        self.own.bank_rad = next.bank_rad;
        self.time_s += PERIOD_S;
        for obstacle in obstacles {
            obstacle.position_m = obstacle.position_after_m(PERIOD_S);
        }
        decision
    }
}

/// A policy for the tests.
pub(crate) trait Flies {
    /// Whether its decision does not depend on the frame.
    fn weighs_exactly(self) -> bool;

    /// A flight by this policy, lengths `scale` times as large, with a surveillance radius of `radius_m`.
    fn flight(self, vehicle: Vehicle, scale: f64, radius_m: f64) -> Flight;
}

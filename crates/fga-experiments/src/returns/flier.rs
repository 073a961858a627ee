//! An aircraft that flies fga, and its judge.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole seconds are small and not negative"
)]

use fga::Vec3;
use fga::avoider::{Reason, Settings, State};
use fga::pilot::Pilot;
use fga::situation::{Mission, Movement, Obstacle, Obstacles, Passing, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;
use fga_sim::plant::{Autopilot, Plant};
use fga_sim::policy::PolicyChoice;
use fga_sim::settings::PolicySettings;
use fga_sim::wind::crab;

use crate::common::{HORIZON_S, PERIOD_S, Reversals};

/// Longest time of `avoiding` with nothing near, seconds.
pub(super) const STUCK_S: f64 = 30.0;

/// The distance to the mission is compared with the one so long ago, seconds.
const STRAYS_S: f64 = 120.0;

/// The last waypoint is flown when the aircraft passes it this near, metres.
const FLOWN_M: f64 = 10.0;

/// An aircraft flies on for so long after its mission, seconds.
const LANDS_S: f64 = 3.0;

/// An aircraft that flies fga, and what the judge saw.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a finding of its own"
)]
pub(super) struct Flier {
    pub(super) plant: Plant,
    pub(super) pilot: Box<dyn Pilot + Send>,
    pub(super) mission_m: Vec<Vec3>,
    /// It flies over the last waypoint.
    pub(super) passing: Vec<Passing>,
    pub(super) state: State,
    pub(super) is_complete: bool,
    /// How long it has flown on since then, seconds: with a dead time it is complete before the waypoint.
    pub(super) after_s: f64,
    /// How long it has avoided with nothing near, and at most, seconds.
    pub(super) alone_s: (f64, f64),
    /// How long it has flown since it last avoided an obstacle near it or flew back from it, seconds.
    pub(super) calm_s: f64,
    /// Distances to the mission with nothing near, one a second, metres.
    pub(super) away_m: Vec<f64>,
    pub(super) has_strayed: bool,
    /// Least distance to the last waypoint, metres.
    pub(super) end_m: f64,
    pub(super) lowest_m: f64,
    /// Length of its track until it is complete, metres.
    pub(super) flown_m: f64,
    /// How often it began to avoid, and how often its bank changed the side while it avoided.
    pub(super) avoided: u32,
    pub(super) reversals: Reversals,
    pub(super) has_entered: bool,
    pub(super) is_adrift: bool,
    /// Waypoints that it gave up.
    pub(super) given_up: usize,
}

/// Distance of a place from a line through points, metres.
pub(super) fn distance_m(line_m: &[Vec3], place_m: Vec3) -> f64 {
    let near = |pair: &[Vec3]| {
        let along = pair[1] - pair[0];
        let share = (place_m - pair[0]).dot(along) / along.length_squared().max(1e-9);
        place_m.distance(pair[0] + along * share.clamp(0.0, 1.0))
    };
    line_m.windows(2).map(near).fold(f64::INFINITY, f64::min)
}

impl Flier {
    /// An aircraft at the beginning of its mission; `None` where the wind is too strong for the first leg.
    pub(super) fn new(
        mission_m: Vec<Vec3>,
        (vehicle, wind_mps): (&Vehicle, Vec3),
        surveillance_m: f64,
    ) -> Option<Self> {
        let along = (mission_m[1] - mission_m[0]).normalize();
        let (course_rad, climb_rad) = crab(along, vehicle.airspeed_mps, wind_mps)?;
        let settings = PolicySettings {
            avoider: Settings {
                surveillance_radius_m: surveillance_m,
                horizon_s: HORIZON_S,
                ..Settings::default()
            },
            ..PolicySettings::default()
        };
        let pilot = PolicyChoice::default().pilot(&settings, vehicle);
        let mut plant = Plant::new(*vehicle, Autopilot::Direct, wind_mps);
        plant.place(0.0, mission_m[0], course_rad, climb_rad);
        let mut passing = vec![Passing::FlyBy; mission_m.len()];
        passing[mission_m.len() - 1] = Passing::FlyOver;
        Some(Self {
            plant,
            pilot: pilot.expect("usable settings"),
            lowest_m: mission_m[0].z,
            flown_m: 0.0,
            avoided: 0,
            reversals: Reversals::default(),
            passing,
            mission_m,
            state: State::Cruise,
            is_complete: false,
            after_s: 0.0,
            alone_s: (0.0, 0.0),
            calm_s: f64::INFINITY,
            away_m: Vec::new(),
            has_strayed: false,
            end_m: f64::INFINITY,
            has_entered: false,
            is_adrift: false,
            given_up: 0,
        })
    }

    /// The aircraft for others, until it has landed.
    pub(super) fn seen(&self, id: u32, volume: ProtectedVolume) -> Option<Obstacle> {
        (!self.has_landed()).then(|| Obstacle {
            movement: Movement::SMALL_UAS,
            ..Obstacle::straight(
                id,
                self.plant.ownship().position_m,
                self.plant.ground_velocity_mps(),
                volume,
            )
        })
    }

    pub(super) fn step(&mut self, time_s: f64, obstacles: &[Obstacle], wind_mps: Vec3) {
        let decision = self.pilot.step(&Situation {
            time_s,
            ownship: self.plant.ownship(),
            obstacles: Obstacles::Rows(obstacles),
            mission: Mission {
                limits_m: (self.floor_m(), f64::INFINITY),
                passing: &self.passing,
                ..Mission::new(&self.mission_m)
            },
            wind_mps,
        });
        let before = self.state;
        self.state = decision.state;
        self.is_complete |= decision.record.reason == Reason::MissionComplete;
        if self.is_complete {
            self.after_s += PERIOD_S;
        } else {
            self.flown_m += PERIOD_S * self.plant.ground_velocity_mps().length();
        }
        if self.state == State::Avoiding {
            if before != State::Avoiding {
                self.avoided += 1;
                self.reversals.begin();
            }
            self.reversals.bank(self.plant.ownship().bank_rad);
        }
        self.is_adrift = decision.record.reason == Reason::WindTooStrong;
        self.given_up += usize::from(decision.record.reason == Reason::WaypointGivenUp);
        self.plant.command(&decision.command, PERIOD_S);
        self.plant.advance(PERIOD_S, |_, _| ());
    }

    pub(super) fn judge(
        &mut self,
        (step, _): (u32, f64),
        obstacles: &[Obstacle],
        (vehicle, wind_mps, surveillance_m): (&Vehicle, Vec3, f64),
    ) {
        let position_m = self.plant.ownship().position_m;
        self.lowest_m = self.lowest_m.min(position_m.z);
        let last_m = self.mission_m.last().copied().unwrap_or_default();
        self.end_m = self.end_m.min(last_m.distance(position_m));
        let margin_m =
            |obstacle: &Obstacle| obstacle.volume.margin_m(position_m - obstacle.position_m);
        self.has_entered |= obstacles.iter().any(|obstacle| margin_m(obstacle) < -0.1);
        let is_near = obstacles.iter().any(|obstacle| {
            let reach_m = HORIZON_S
                * (vehicle.airspeed_mps + wind_mps.length() + obstacle.velocity_mps.length());
            obstacle.position_m.distance(position_m) < surveillance_m
                && margin_m(obstacle) < reach_m
        });
        if is_near {
            self.away_m.clear();
        } else if step.is_multiple_of(10) {
            self.away_m.push(distance_m(&self.mission_m, position_m));
        }
        if is_near && self.state.is_away() {
            self.calm_s = 0.0;
        } else if !self.is_complete {
            self.calm_s += PERIOD_S;
        }
        let is_alone = !is_near && self.state == State::Avoiding;
        self.alone_s.0 = if is_alone {
            self.alone_s.0 + PERIOD_S
        } else {
            0.0
        };
        self.alone_s.1 = self.alone_s.1.max(self.alone_s.0);
        // Until then it may avoid with nothing near, and a strong wind carries it off as fast.
        let later_m = self.away_m.get(STUCK_S as usize..).unwrap_or(&[]);
        let before = later_m
            .len()
            .checked_sub(STRAYS_S as usize)
            .and_then(|at| later_m.get(at));
        if let (Some(before_m), Some(now_m)) = (before, self.away_m.last()) {
            // A turn, and the drift in it.
            let turn_m = vehicle.turn_radius_m * (2.0 + core::f64::consts::TAU);
            self.has_strayed |= *now_m > *before_m + turn_m && !self.is_complete;
        }
    }

    /// Whether its mission is over, and its flight.
    pub(super) fn has_landed(&self) -> bool {
        self.after_s > LANDS_S
    }

    /// Whether it passed its last waypoint too far off, and whether an obstacle near it kept it from there.
    pub(super) fn misses(&self) -> [bool; 2] {
        let is_missed = self.is_complete && self.end_m > FLOWN_M;
        let is_kept_off = self.calm_s < STUCK_S;
        [is_missed && !is_kept_off, is_missed && is_kept_off]
    }

    /// The default floor: 30 m below the lowest waypoint, metres.
    pub(super) fn floor_m(&self) -> f64 {
        let lowest_m = self
            .mission_m
            .iter()
            .map(|waypoint| waypoint.z)
            .fold(f64::INFINITY, f64::min);
        lowest_m - 30.0
    }
}

//! Flights drawn from a model: positions and velocities, second by second.

use super::{EncounterModel, ModelState};
use crate::geodesy::{course_from_compass_rad, velocity_from_compass};
use crate::units::{DEGREE_RAD, FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS, NAUTICAL_MILE_M};
use core::f64::consts::PI;
use glam::DVec3;

/// An aircraft at one second of a drawn flight, in the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelRow {
    /// Time, seconds.
    pub time_s: f64,
    /// Position, metres; z is the altitude above ground.
    pub position_m: DVec3,
    /// Velocity, metres per second.
    pub velocity_mps: DVec3,
}

/// Two flights of a correlated model and how they pass.
///
/// Both begin at the origin, due north, at the same altitude: the caller rotates and moves the
/// second one.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelPair {
    /// The flights of the first and the second aircraft.
    pub flights: [Vec<ModelRow>; 2],
    /// Heading of the second aircraft at the closest approach, radians clockwise from that of the
    /// first (`\beta`).
    pub approach_rad: f64,
    /// Whether the second aircraft is ahead of the first at the closest approach, not behind it
    /// (`\chi` 1, 2).
    pub is_ahead: bool,
    /// Horizontal miss distance, metres (`hmd`).
    pub miss_m: f64,
    /// Vertical miss distance, metres (`vmd`), without a sign.
    pub height_m: f64,
}

/// Altitudes of the layers of correlated models, feet: the model itself has only their numbers.
///
/// Source: ATC-344, altitude layers of the correlated encounter model.
const CORRELATED_LAYERS_FT: [f64; 6] = [1000.0, 3000.0, 10_000.0, 18_000.0, 29_000.0, 41_000.0];

/// The indices of the variables that fly one aircraft.
#[derive(Debug, Clone, Copy)]
struct Variables {
    speed: usize,
    acceleration: usize,
    climb: usize,
    turn: usize,
    slowest_kn: f64,
    fastest_kn: f64,
}

/// An aircraft in flight.
#[derive(Debug, Clone, Copy)]
struct FlyingAircraft {
    variables: Variables,
    position_m: DVec3,
    compass_deg: f64,
}

impl FlyingAircraft {
    fn new(variables: Variables, altitude_m: f64) -> Self {
        Self {
            variables,
            position_m: DVec3::new(0.0, 0.0, altitude_m),
            compass_deg: 0.0,
        }
    }

    /// Returns the current row, flies for a second and returns the new speed, knots.
    fn second(&mut self, time_s: f64, state: &ModelState) -> (ModelRow, f64) {
        let value = |index: usize| state.values.get(index).copied().unwrap_or(0.0);
        let variables = self.variables;
        let speed_kn = value(variables.speed);
        // Airspeed is along the path: climb takes from the forward part.
        let speed_mps = speed_kn * KNOT_MPS;
        let climb_mps = value(variables.climb) * FOOT_PER_MINUTE_MPS;
        let climb_mps = climb_mps.clamp(-speed_mps, speed_mps);
        let level_mps = libm::sqrt((speed_mps * speed_mps - climb_mps * climb_mps).max(0.0));
        let row = ModelRow {
            time_s,
            position_m: self.position_m,
            velocity_mps: velocity_from_compass(self.compass_deg, level_mps, climb_mps),
        };
        // A second of flight is an arc: its chord has half the turn and is shorter by the sine of that
        // half over the half.
        let turn_rad = value(variables.turn) * DEGREE_RAD;
        let half_rad = turn_rad / 2.0;
        let chord = if half_rad.abs() > 1e-9 {
            libm::sin(half_rad) / half_rad
        } else {
            1.0
        };
        let (sin, cos) = libm::sincos(course_from_compass_rad(self.compass_deg) - half_rad);
        self.position_m += DVec3::new(level_mps * cos * chord, level_mps * sin * chord, climb_mps);
        self.compass_deg = libm::fmod(self.compass_deg + turn_rad * 180.0 / PI, 360.0);
        let next_kn = (speed_kn + value(variables.acceleration))
            .clamp(variables.slowest_kn, variables.fastest_kn);
        (row, next_kn)
    }
}

impl EncounterModel {
    fn flying_variables(&self, labels: [&str; 4]) -> Option<Variables> {
        let [speed, acceleration, climb, turn] = labels.map(|label| self.index_of(label));
        let speed = speed?;
        let speeds = self.variables.get(speed)?.boundaries.as_deref()?;
        Some(Variables {
            speed,
            acceleration: acceleration?,
            climb: climb?,
            turn: turn?,
            slowest_kn: *speeds.first()?,
            fastest_kn: *speeds.last()?,
        })
    }

    fn single(&self) -> Option<Variables> {
        self.flying_variables(["v", "\\dot v", "\\dot h", "\\dot \\psi"])
    }

    fn both(&self) -> Option<[Variables; 2]> {
        Some([
            self.flying_variables(["v_1", "\\dot v_1", "\\dot h_1", "\\dot \\psi_1"])?,
            self.flying_variables(["v_2", "\\dot v_2", "\\dot h_2", "\\dot \\psi_2"])?,
        ])
    }

    /// The fastest airspeed of an uncorrelated model, metres per second; `None` for another model.
    pub fn fastest_mps(&self) -> Option<f64> {
        self.single()
            .map(|variables| variables.fastest_kn * KNOT_MPS)
    }

    /// Whether the model draws both aircraft of an encounter at once.
    pub fn is_correlated(&self) -> bool {
        self.both().is_some()
            && ["L", "\\chi", "\\beta", "hmd", "vmd"]
                .iter()
                .all(|label| self.index_of(label).is_some())
    }

    /// Whether [`EncounterModel::fly`] can draw flights.
    pub fn is_uncorrelated(&self) -> bool {
        let altitudes = |layer: usize| self.variables.get(layer)?.boundaries.as_deref();
        self.single().is_some() && self.index_of("L").and_then(altitudes).is_some()
    }

    /// Draws a flight of an uncorrelated model: a row each second from 0 to `duration_s`, from
    /// the origin, first due north.
    ///
    /// Airspeed and altitude follow their rates and change the layer and speed bins; airspeed
    /// stays within the model's range. `None` if the model has no variables `L`, `v`,
    /// `\dot v`, `\dot h`, `\dot \psi`, or no altitudes for `L`.
    pub fn fly(&self, duration_s: u32, uniform: &mut impl FnMut() -> f64) -> Option<Vec<ModelRow>> {
        let variables = self.single()?;
        let layer = self.index_of("L")?;
        self.variables.get(layer)?.boundaries.as_deref()?;
        let mut state = self.start(uniform);
        let altitude_m = *state.values.get(layer)? * FOOT_M;
        let mut flying = FlyingAircraft::new(variables, altitude_m);
        let mut rows = Vec::new();
        for second in 0..=duration_s {
            let (row, next_kn) = flying.second(f64::from(second), &state);
            rows.push(row);
            self.step(&mut state, uniform);
            self.set(&mut state, variables.speed, next_kn);
            self.set(&mut state, layer, flying.position_m.z / FOOT_M);
        }
        Some(rows)
    }

    /// Draws the flights of both aircraft of a correlated model, as [`EncounterModel::fly`] draws
    /// one. The altitude layer holds for the whole encounter. `None` if the model lacks a
    /// variable of a correlated one.
    ///
    /// `keep` decides from the drawn miss distances, horizontal and vertical in metres, whether to
    /// draw the flights.
    pub fn fly_pair(
        &self,
        duration_s: u32,
        uniform: &mut impl FnMut() -> f64,
        keep: impl FnOnce(f64, f64) -> bool,
    ) -> Option<Option<ModelPair>> {
        let variables = self.both()?;
        let mut state = self.start(uniform);
        let value =
            |state: &ModelState, label: &str| state.values.get(self.index_of(label)?).copied();
        let miss_m = value(&state, "hmd")? * NAUTICAL_MILE_M;
        let height_m = value(&state, "vmd")? * FOOT_M;
        let approach_rad = value(&state, "\\beta")? * DEGREE_RAD;
        let is_ahead = value(&state, "\\chi")? < 1.5;
        let layer = *state.bins.get(self.index_of("L")?)?;
        let (low_ft, high_ft) = (
            *CORRELATED_LAYERS_FT.get(layer)?,
            *CORRELATED_LAYERS_FT.get(layer + 1)?,
        );
        let altitude_m = (low_ft + (high_ft - low_ft) * uniform()) * FOOT_M;
        if !keep(miss_m, height_m) {
            return Some(None);
        }
        let mut flying = variables.map(|variables| FlyingAircraft::new(variables, altitude_m));
        let mut flights = [Vec::new(), Vec::new()];
        for second in 0..=duration_s {
            let mut speeds_kn = [0.0; 2];
            for ((flying, rows), next_kn) in flying.iter_mut().zip(&mut flights).zip(&mut speeds_kn)
            {
                let (row, speed_kn) = flying.second(f64::from(second), &state);
                rows.push(row);
                *next_kn = speed_kn;
            }
            self.step(&mut state, uniform);
            for (variables, next_kn) in variables.iter().zip(speeds_kn) {
                self.set(&mut state, variables.speed, next_kn);
            }
        }
        Some(Some(ModelPair {
            flights,
            approach_rad,
            is_ahead,
            miss_m,
            height_m,
        }))
    }
}

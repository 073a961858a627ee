//! The pilot of the mission alone.

use fga::avoider::{Decision, Reason, State};
use fga::limit::SettingsError;
use fga::maneuver::Maneuver;
use fga::meter::Meter;
use fga::mission::{Progress, Route, Turner};
use fga::pilot::Pilot;
use fga::prediction::MotionState;
use fga::situation::Situation;
use fga::vehicle::Vehicle;

/// Flies the mission, whatever comes: the policy `none`, and the guidance under methods that only
/// give a direction.
#[derive(Debug, Clone)]
pub struct MissionPilot {
    horizon_s: f64,
    vehicle: Vehicle,
    made_for: Vehicle,
    flyer: Turner,
    progress: Progress,
}

impl MissionPilot {
    /// A pilot on the first leg, with a horizon of `horizon_s` seconds for corners.
    ///
    /// # Errors
    /// A horizon that is not a positive number, or a limit of the vehicle that is not finite or out
    /// of range.
    pub fn new(horizon_s: f64, vehicle: Vehicle) -> Result<Self, SettingsError> {
        let in_range = horizon_s > 0.0 && horizon_s.is_finite();
        SettingsError::unless(in_range, "horizon_s", horizon_s, "a positive number")?;
        vehicle.check()?;
        Ok(Self {
            horizon_s,
            vehicle,
            made_for: vehicle,
            flyer: Turner::new(&vehicle),
            progress: Progress::new(),
        })
    }

    /// The vehicle's present limits.
    pub const fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// Index of the waypoint at the start of the leg that is flown.
    pub const fn leg_index(&self) -> usize {
        self.progress.index()
    }

    /// Replaces the vehicle's limits.
    ///
    /// # Errors
    /// A limit that is not finite or out of range; nothing is changed then.
    pub fn set_vehicle(&mut self, vehicle: Vehicle) -> Result<(), SettingsError> {
        vehicle.check()?;
        self.vehicle = vehicle;
        self.flyer.set(&vehicle);
        Ok(())
    }
}

impl Pilot for MissionPilot {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        if !situation.is_usable() {
            return Decision::new(State::Cruise, &Maneuver::hold(), Reason::InvalidInput);
        }
        let now = MotionState::of(&situation.ownship);
        let route = Route {
            mission: &situation.mission,
            flyer: &self.flyer,
            wind_mps: situation.wind_mps,
            climb_limits_rad: (self.vehicle.climb_min_rad, self.vehicle.climb_max_rad),
            meter: &Meter::unlimited(),
        };
        self.progress.update(&route, &now, situation.time_s);
        let mut decision = Decision::default();
        let command = decision.command.edit();
        (self.progress).guidance(&route, &now, self.horizon_s, command);
        decision.record.reason = if self.progress.is_complete() {
            Reason::MissionComplete
        } else {
            Reason::Clear
        };
        decision
    }

    fn stands_s(&self, situation: &Situation<'_>) -> f64 {
        let now = MotionState::of(&situation.ownship);
        self.progress.straight_for_s(&now)
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        // If it refuses the limits, it keeps its present ones.
        let _ = self.set_vehicle(*vehicle);
    }

    fn replace_mission(&mut self, kept: usize) {
        self.progress.take_up(kept);
    }

    fn restart(&mut self) {
        self.progress = Progress::new();
        if self.vehicle != self.made_for {
            // It had these limits before.
            let _ = self.set_vehicle(self.made_for);
        }
    }
}

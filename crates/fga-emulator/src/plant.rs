//! The aircraft: a point mass with a rate, a limit and a lag of roll, and a lag of the climb angle.

use alloc::collections::VecDeque;
use core::f64::consts::FRAC_PI_4;

use crate::geometry::wrap;
use crate::parameters::Parameters;

const GRAVITY_MPS2: f64 = 9.806_65;

/// Parameters of the aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantSettings {
    /// Airspeed while no throttle stick sets it, metres per second.
    pub airspeed_mps: f64,
    /// Where the throttle stick sets it (CRUISE, FBWB), the airspeed follows with this time constant, seconds, …
    pub airspeed_time_constant_s: f64,
    /// … and is higher in a turn, metres per second for each g of load beyond 1: measured 1.0 at a bank of 45°, where the
    /// autopilot adds throttle for the load.
    pub airspeed_in_turn_mps: f64,
    /// The wanted roll rate is the error of the bank divided by this, seconds (ArduPlane's
    /// `RLL2SRV_TCONST`) …
    pub roll_time_constant_s: f64,
    /// … limited to this, radians per second …
    pub roll_rate_max_radps: f64,
    /// … with this lag, seconds.
    pub roll_rate_lag_s: f64,
    /// Steps between a command and its first effect. Measured for all four: after a step to 45° the bank is
    /// 7°, 18°, 32° and 43° after 0.23, 0.37, 0.53 and 0.67 s, and 4° too far at 0.83 s.
    pub roll_delay_steps: usize,
    /// Flown turn rate over g tan φ / V.
    pub turn_rate_factor: f64,
    /// Loss of that factor for each radian of bank beyond 45°. ArduPlane in software in the loop shows none up to 63°; a loaded wing may slow
    /// down.
    pub steep_loss: f64,
    /// Delay of the nose behind the course, seconds.
    pub nose_lag_s: f64,
    /// Time constant of the climb angle behind the pitch, seconds.
    pub climb_time_constant_s: f64,
    /// Pitch angle in level flight, radians.
    pub level_pitch_rad: f64,
}

impl Default for PlantSettings {
    fn default() -> Self {
        Self {
            airspeed_mps: 25.0,
            airspeed_time_constant_s: 1.2,
            airspeed_in_turn_mps: 2.4,
            roll_time_constant_s: 0.25,
            roll_rate_max_radps: 1.6,
            roll_rate_lag_s: 0.13,
            roll_delay_steps: 3,
            turn_rate_factor: 0.70,
            steep_loss: 0.0,
            nose_lag_s: 0.3,
            climb_time_constant_s: 0.5,
            level_pitch_rad: 0.035,
        }
    }
}

/// The demands of the autopilot's loops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Bank, radians, right positive.
    pub bank_rad: f64,
    /// The demand on the elevator.
    pub vertical: Vertical,
    /// The airspeed that the throttle stick asks for, metres per second.
    pub airspeed_mps: Option<f64>,
}

/// What the elevator holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Vertical {
    /// An altitude above home, metres.
    Altitude(f64),
    /// A pitch angle, radians.
    Pitch(f64),
}

/// The aircraft.
#[derive(Debug, Clone)]
pub struct VehiclePlant {
    settings: PlantSettings,
    airspeed_mps: f64,
    position_m: [f64; 3],
    heading_rad: f64,
    bank_rad: f64,
    commanded_bank_rad: f64,
    /// Commands in transit, oldest first.
    to_come_rad: VecDeque<f64>,
    roll_rate_radps: f64,
    climb_rad: f64,
    turn_rate_radps: f64,
    nose_rate_radps: f64,
    wind_mps: [f64; 2],
}

impl VehiclePlant {
    /// Level, at a place and a heading, radians clockwise from north, in a wind to the east and north.
    pub fn new(
        settings: PlantSettings,
        position_m: [f64; 3],
        heading_rad: f64,
        wind_mps: [f64; 2],
    ) -> Self {
        Self {
            settings,
            airspeed_mps: settings.airspeed_mps,
            position_m,
            heading_rad,
            bank_rad: 0.0,
            commanded_bank_rad: 0.0,
            to_come_rad: VecDeque::new(),
            roll_rate_radps: 0.0,
            climb_rad: 0.0,
            turn_rate_radps: 0.0,
            nose_rate_radps: 0.0,
            wind_mps,
        }
    }

    /// Position, metres, local frame.
    pub const fn position_m(&self) -> [f64; 3] {
        self.position_m
    }

    /// Heading, radians clockwise from north.
    pub const fn heading_rad(&self) -> f64 {
        self.heading_rad
    }

    /// Bank, radians, right positive.
    pub const fn bank_rad(&self) -> f64 {
        self.bank_rad
    }

    /// Bank demand of the loops, radians, right positive.
    pub const fn commanded_bank_rad(&self) -> f64 {
        self.commanded_bank_rad
    }

    /// Pitch angle, radians.
    pub const fn pitch_rad(&self) -> f64 {
        self.climb_rad + self.settings.level_pitch_rad
    }

    /// Turn rate, radians per second, clockwise positive.
    pub const fn turn_rate_radps(&self) -> f64 {
        self.turn_rate_radps
    }

    /// Roll rate, radians per second, right positive.
    pub const fn roll_rate_radps(&self) -> f64 {
        self.roll_rate_radps
    }

    /// Yaw rate of the nose, radians per second, clockwise positive.
    pub const fn nose_rate_radps(&self) -> f64 {
        self.nose_rate_radps
    }

    /// Airspeed, metres per second.
    pub const fn airspeed_mps(&self) -> f64 {
        self.airspeed_mps
    }

    /// Wind velocity east and north, metres per second.
    pub const fn wind_mps(&self) -> [f64; 2] {
        self.wind_mps
    }

    /// Velocity over the ground, metres per second: east, north, up.
    pub fn velocity_mps(&self) -> [f64; 3] {
        let level = self.airspeed_mps * libm::cos(self.climb_rad);
        [
            level * libm::sin(self.heading_rad) + self.wind_mps[0],
            level * libm::cos(self.heading_rad) + self.wind_mps[1],
            self.airspeed_mps * libm::sin(self.climb_rad),
        ]
    }

    /// The airspeed while no throttle stick sets it, metres per second, from now on.
    pub(crate) const fn set_airspeed(&mut self, mps: f64) {
        self.settings.airspeed_mps = mps;
    }

    pub(crate) fn displace(&mut self, by_m: [f64; 3]) {
        for (position, by) in self.position_m.iter_mut().zip(by_m) {
            *position += by;
        }
    }

    fn roll(&mut self, step_s: f64) {
        self.to_come_rad.push_back(self.commanded_bank_rad);
        let felt_rad = if self.to_come_rad.len() > self.settings.roll_delay_steps {
            self.to_come_rad.pop_front().unwrap_or(0.0)
        } else {
            self.bank_rad
        };
        let most = self.settings.roll_rate_max_radps;
        let wanted = (felt_rad - self.bank_rad) / self.settings.roll_time_constant_s;
        let lag = 1.0 - libm::exp(-step_s / self.settings.roll_rate_lag_s);
        self.roll_rate_radps += (wanted.clamp(-most, most) - self.roll_rate_radps) * lag;
        self.bank_rad += self.roll_rate_radps * step_s;
    }

    fn change_airspeed(&mut self, by_stick_mps: Option<f64>, step_s: f64) {
        let load = 1.0 / libm::cos(self.bank_rad).max(0.1) - 1.0;
        let in_turn_mps = self.settings.airspeed_in_turn_mps * load;
        let wanted_mps = by_stick_mps.map_or(self.settings.airspeed_mps, |mps| mps + in_turn_mps);
        let lag = 1.0 - libm::exp(-step_s / self.settings.airspeed_time_constant_s);
        self.airspeed_mps += (wanted_mps - self.airspeed_mps) * lag;
    }

    /// Flies a step on demands, within the limits of the parameters.
    pub fn step(&mut self, target: &Target, parameters: &Parameters, step_s: f64) {
        // The lift of the wing limits the bank, but never below 25°.
        let load = (self.airspeed_mps / parameters.value("AIRSPEED_MIN").max(1.0)).powi(2);
        let stall_rad = libm::acos(1.0 / load.max(1.0)).max(25.0_f64.to_radians());
        let limit = parameters
            .value("ROLL_LIMIT_DEG")
            .to_radians()
            .min(stall_rad);
        self.commanded_bank_rad = target.bank_rad.clamp(-limit, limit);
        self.roll(step_s);
        self.change_airspeed(target.airspeed_mps, step_s);
        let speed = self.airspeed_mps;
        let climb_max = libm::asin((parameters.value("TECS_CLMB_MAX") / speed).min(1.0));
        let climb_min = -libm::asin((parameters.value("TECS_SINK_MAX") / speed).min(1.0));
        let wanted = match target.vertical {
            Vertical::Altitude(altitude_m) => 0.5 * (altitude_m - self.position_m[2]) / speed,
            Vertical::Pitch(pitch_rad) => {
                let low = parameters.value("PTCH_LIM_MIN_DEG").to_radians();
                let high = parameters.value("PTCH_LIM_MAX_DEG").to_radians();
                pitch_rad.clamp(low, high) - self.settings.level_pitch_rad
            }
        };
        let climb_lag = 1.0 - libm::exp(-step_s / self.settings.climb_time_constant_s);
        self.climb_rad += (wanted.clamp(climb_min, climb_max) - self.climb_rad) * climb_lag;
        let beyond_rad = (self.bank_rad.abs() - FRAC_PI_4).max(0.0);
        let factor = self.settings.turn_rate_factor - self.settings.steep_loss * beyond_rad;
        self.turn_rate_radps = factor * GRAVITY_MPS2 * libm::tan(self.bank_rad) / speed;
        let nose_lag = 1.0 - libm::exp(-step_s / self.settings.nose_lag_s);
        self.nose_rate_radps += (self.turn_rate_radps - self.nose_rate_radps) * nose_lag;
        // Half the turn before and half after the move: second order in the step.
        self.heading_rad += 0.5 * self.turn_rate_radps * step_s;
        let velocity = self.velocity_mps();
        for (position, rate) in self.position_m.iter_mut().zip(velocity) {
            *position += rate * step_s;
        }
        self.heading_rad = wrap(self.heading_rad + 0.5 * self.turn_rate_radps * step_s);
    }
}

//! The vehicle's parameters: requested by name until they are known.

use alloc::collections::{BTreeMap, BTreeSet};

use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2, Vehicle};
use mavlink::dialects::ardupilotmega::{MavMessage, PARAM_REQUEST_READ_DATA, PARAM_VALUE_DATA};

use crate::config::Config;
use crate::outgoing::{AUTOPILOT, Outbox};

/// The requested parameters. If a figure has two names, the newer comes first; the factor beside the older
/// one scales it.
const WANTED: [(&str, &str, f64); 24] = [
    ("ROLL_LIMIT_DEG", "LIM_ROLL_CD", 0.01),
    ("PTCH_LIM_MAX_DEG", "LIM_PITCH_MAX", 0.01),
    ("PTCH_LIM_MIN_DEG", "LIM_PITCH_MIN", 0.01),
    ("AIRSPEED_CRUISE", "TRIM_ARSPD_CM", 0.01),
    ("AIRSPEED_MIN", "ARSPD_FBW_MIN", 1.0),
    ("AIRSPEED_MAX", "ARSPD_FBW_MAX", 1.0),
    ("MAV_GCS_SYSID", "SYSID_MYGCS", 1.0),
    ("TECS_CLMB_MAX", "TECS_CLMB_MAX", 1.0),
    ("TECS_SINK_MAX", "TECS_SINK_MAX", 1.0),
    ("GUIDED_TIMEOUT", "GUIDED_TIMEOUT", 1.0),
    ("RC_OVERRIDE_TIME", "RC_OVERRIDE_TIME", 1.0),
    ("AVD_ENABLE", "AVD_ENABLE", 1.0),
    ("AVD_F_ACTION", "AVD_F_ACTION", 1.0),
    ("FENCE_ENABLE", "FENCE_ENABLE", 1.0),
    ("FENCE_ACTION", "FENCE_ACTION", 1.0),
    ("MIS_RESTART", "MIS_RESTART", 1.0),
    ("RALLY_LIMIT_KM", "RALLY_LIMIT_KM", 1.0),
    ("RALLY_INCL_HOME", "RALLY_INCL_HOME", 1.0),
    ("WP_RADIUS", "WP_RADIUS", 1.0),
    ("STALL_PREVENTION", "STALL_PREVENTION", 1.0),
    ("AIRSPEED_STALL", "AIRSPEED_STALL", 1.0),
    ("FENCE_TYPE", "FENCE_TYPE", 1.0),
    (FENCE_OPTIONS, FENCE_OPTIONS, 1.0),
    (TERRAIN_ENABLE, TERRAIN_ENABLE, 1.0),
];
/// Counts with a fence alone, and is requested then.
pub const FENCE_OPTIONS: &str = "FENCE_OPTIONS";
/// Counts where the vehicle is asked for the ground alone, and is requested then.
pub const TERRAIN_ENABLE: &str = "TERRAIN_ENABLE";
/// It does not act without these: bank limit and cruise airspeed.
const NEEDED: [&str; 2] = ["ROLL_LIMIT_DEG", "AIRSPEED_CRUISE"];
/// Requests sent at once, time for their answers, and rounds before a name counts as absent.
const BATCH: usize = 4;
const ANSWER_S: f64 = 0.3;
const MOST_ROUNDS: u8 = 20;
/// Reserve below the vehicle's own bank limit, degrees.
const BELOW_LIMIT_DEG: f64 = 2.0;
/// With a smaller bank limit the vehicle does not turn, degrees; it may climb all the same.
const LEAST_LIMIT_DEG: f64 = 5.0;
/// Least bank in the plan, degrees: a turn radius of 3.6 km at 25 m/s.
const LEAST_BANK_DEG: f64 = 1.0;
/// `AVD_F_ACTION` up to this only reports.
const AVD_REPORTS: f64 = 1.0;
/// A bank in need must be steeper by at least this, radians (2°).
const CLEARLY_STEEPER_RAD: f64 = 0.035;
/// The autopilot prevents a stall: no bank may need more lift than the wing has at the airspeed.
/// It always allows this much, degrees.
const ALWAYS_LET_DEG: f64 = 25.0;
/// The airspeed falls in a turn: the plan uses this share of it.
const AIRSPEED_SHARE: f64 = 0.97;
/// Rate of change of the climb angle, radians per second: a second and a half to 15°.
const CLIMB_RATE_RADPS: f64 = 0.17;
/// Share of the vehicle's climb and sink rates in the plan.
const CLIMB_SHARE: f64 = 0.8;

/// The parameters known so far.
#[derive(Debug, Default)]
pub struct VehicleParameters {
    values: BTreeMap<&'static str, f64>,
    rounds: BTreeMap<&'static str, u8>,
    again_s: f64,
    /// Those requested of the ones that do not always count.
    also: BTreeSet<&'static str>,
}

impl VehicleParameters {
    /// A parameter by its newer name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied()
    }

    /// System id of the vehicle's ground station; ArduPilot's own value while it is unknown.
    pub fn ground_system(&self) -> f64 {
        self.get("MAV_GCS_SYSID").unwrap_or(255.0)
    }

    /// Whether every name has an answer or was given up; the needed ones are never given up.
    pub fn is_complete(&self) -> bool {
        WANTED.iter().all(|row| self.is_settled(row.0))
    }

    /// Whether everything needed to act is known.
    pub fn is_sufficient(&self) -> bool {
        NEEDED.iter().all(|name| self.values.contains_key(name))
    }

    /// Requests also one that does not always count.
    pub fn ask_for(&mut self, name: &'static str) {
        self.also.insert(name);
        self.again_s = 0.0;
    }

    fn is_settled(&self, name: &'static str) -> bool {
        self.values.contains_key(name)
            || [FENCE_OPTIONS, TERRAIN_ENABLE].contains(&name) && !self.also.contains(name)
            || !NEEDED.contains(&name)
                && self
                    .rounds
                    .get(name)
                    .is_some_and(|rounds| *rounds >= MOST_ROUNDS)
    }

    /// Takes a value; `true` if it was requested.
    pub fn take(&mut self, data: &PARAM_VALUE_DATA) -> bool {
        let (Ok(name), value) = (data.param_id.to_str(), f64::from(data.param_value)) else {
            return false;
        };
        for (newer, older, scale) in WANTED {
            let scale = if name == newer {
                1.0
            } else if name == older {
                scale
            } else {
                continue;
            };
            if value.is_finite() {
                self.values.insert(newer, value * scale);
                return true;
            }
        }
        false
    }

    /// Requests unknown values.
    pub fn tick(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) {
        if now_s < self.again_s {
            return;
        }
        if self.is_complete() {
            // It stays so.
            self.again_s = f64::INFINITY;
            return;
        }
        self.again_s = now_s + ANSWER_S;
        let missing: Vec<_> = WANTED
            .iter()
            .filter(|row| !self.is_settled(row.0))
            .take(BATCH)
            .collect();
        for (newer, older, _) in missing {
            let rounds = self.rounds.entry(newer).or_default();
            let first = rounds.is_multiple_of(2);
            *rounds = rounds.wrapping_add(1);
            // By both names at once, if nothing can begin without it.
            let both = NEEDED.contains(newer);
            for name in [
                (first || both).then_some(*newer),
                (!first || both).then_some(*older),
            ] {
                let Some(name) = name else { continue };
                outbox.send(MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
                    param_index: -1,
                    target_system,
                    target_component: AUTOPILOT,
                    param_id: name.into(),
                }));
            }
        }
    }

    /// Whether the vehicle avoids other aircraft by itself.
    pub fn avoids_by_itself(&self) -> bool {
        let value = |name| self.get(name).unwrap_or(0.0);
        value("AVD_ENABLE") != 0.0 && value("AVD_F_ACTION") > AVD_REPORTS
    }

    /// The largest bank under the autopilot's stall prevention, degrees: the load 1/cos φ is at most
    /// the square of airspeed over stall speed.
    fn stall_limit_deg(&self, airspeed_mps: f64) -> f64 {
        let known = |name| self.get(name).filter(|value| *value > 1.0);
        let stall_mps = known("AIRSPEED_STALL").or_else(|| known("AIRSPEED_MIN"));
        let (Some(stall_mps), true) = (stall_mps, self.get("STALL_PREVENTION") != Some(0.0)) else {
            return 90.0;
        };
        let share = AIRSPEED_SHARE * airspeed_mps / stall_mps;
        libm::acos(1.0 / (share * share).max(1.0))
            .to_degrees()
            .max(ALWAYS_LET_DEG)
    }

    /// The largest bank to command at an airspeed, radians; `None` until the vehicle's limit is known.
    pub fn bank_limit_rad(&self, config: &Config, airspeed_mps: f64) -> Option<f64> {
        self.bank_rad(config.vehicle.max_bank_deg, config, airspeed_mps)
    }

    /// The largest bank in need at an airspeed, radians; `None` if it is not clearly steeper than the
    /// normal one.
    pub fn bank_in_need_rad(&self, config: &Config, airspeed_mps: f64) -> Option<f64> {
        let normal_rad = self.bank_limit_rad(config, airspeed_mps)?;
        let most_deg = config.vehicle.max_bank_in_need_deg;
        let most_rad = self.bank_rad(most_deg, config, airspeed_mps)?;
        (most_rad >= normal_rad + CLEARLY_STEEPER_RAD).then_some(most_rad)
    }

    fn bank_rad(&self, most_deg: f64, config: &Config, airspeed_mps: f64) -> Option<f64> {
        let climbs = config.vehicle.vertical && self.get("TECS_CLMB_MAX").is_some();
        let least_deg = if climbs { 0.0 } else { LEAST_LIMIT_DEG };
        let limit_deg = self
            .get("ROLL_LIMIT_DEG")
            .filter(|limit| *limit > least_deg)?;
        let limit_deg = limit_deg.min(self.stall_limit_deg(airspeed_mps));
        let deg = (limit_deg - BELOW_LIMIT_DEG).min(most_deg);
        Some(deg.clamp(LEAST_BANK_DEG, 70.0).to_radians())
    }

    /// The vehicle's limits for the core, with a largest bank, at an airspeed.
    pub fn vehicle(
        &self,
        bank_rad: f64,
        config: &Config,
        airspeed_mps: f64,
        response: Response,
    ) -> Option<Vehicle> {
        if !(airspeed_mps.is_finite() && airspeed_mps > 1.0) {
            return None;
        }
        let turn_radius_m =
            airspeed_mps * airspeed_mps / (STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad));
        let limit_rad = config.vehicle.max_climb_deg.to_radians();
        let angle = |rate_mps: f64| {
            libm::asin((CLIMB_SHARE * rate_mps / airspeed_mps).clamp(0.0, 0.9)).min(limit_rad)
        };
        let (up, down) = if config.vehicle.vertical {
            let climb = angle(self.get("TECS_CLMB_MAX").unwrap_or(0.0));
            let sink = angle(self.get("TECS_SINK_MAX").unwrap_or(0.0));
            (climb, sink)
        } else {
            (0.0, 0.0)
        };
        Some(Vehicle {
            airspeed_mps,
            turn_radius_m,
            climb_min_rad: -down,
            climb_max_rad: up,
            climb_rate_radps: if config.vehicle.vertical {
                CLIMB_RATE_RADPS
            } else {
                0.0
            },
            response,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(name: &str, value: f32) -> PARAM_VALUE_DATA {
        PARAM_VALUE_DATA {
            param_value: value,
            param_id: name.into(),
            ..PARAM_VALUE_DATA::DEFAULT
        }
    }

    #[test]
    fn both_generations_of_names_are_read() {
        let mut parameters = VehicleParameters::default();
        assert!(parameters.take(&value("LIM_ROLL_CD", 4500.0)));
        assert!(parameters.take(&value("AIRSPEED_CRUISE", 22.0)));
        assert!(!parameters.take(&value("RC1_MIN", 1000.0)));
        assert_eq!(parameters.get("ROLL_LIMIT_DEG"), Some(45.0));
        assert!(parameters.is_sufficient());
    }

    #[test]
    fn limits_follow_from_parameters() {
        let mut parameters = VehicleParameters::default();
        parameters.take(&value("ROLL_LIMIT_DEG", 47.0));
        parameters.take(&value("TECS_CLMB_MAX", 5.0));
        let mut config = Config::default();
        config.vehicle.vertical = true;
        let bank_rad = parameters.bank_limit_rad(&config, 25.0).unwrap();
        let vehicle = parameters
            .vehicle(bank_rad, &config, 25.0, Response::default())
            .unwrap();
        // 25² / (9.80665 · tan 45°)
        assert!((vehicle.turn_radius_m - 63.73).abs() < 0.01);
        // asin(0.8 · 5 / 25) = 9.2° is limited to 8°.
        assert!((vehicle.climb_max_rad.to_degrees() - 8.0).abs() < 1e-9);
        assert_eq!(vehicle.climb_min_rad, 0.0);
    }

    #[test]
    fn near_the_stall_the_autopilots_limit_bounds_the_bank() {
        let mut parameters = VehicleParameters::default();
        parameters.take(&value("ROLL_LIMIT_DEG", 65.0));
        let config = Config::default();
        let limit_deg = |parameters: &VehicleParameters, airspeed_mps| {
            let limit_rad = parameters.bank_limit_rad(&config, airspeed_mps).unwrap();
            limit_rad.to_degrees()
        };
        assert!((limit_deg(&parameters, 11.0) - 45.0).abs() < 1e-9);
        parameters.take(&value("AIRSPEED_MIN", 10.0));
        // (0.97 · 11.5 / 10)² = 1.2444: arccos 0.8036 = 36.5°, 2° in hand.
        assert!((limit_deg(&parameters, 11.5) - 34.5).abs() < 0.1);
        assert!((limit_deg(&parameters, 9.0) - 23.0).abs() < 1e-9);
        assert!((limit_deg(&parameters, 22.0) - 45.0).abs() < 1e-9);
        parameters.take(&value("AIRSPEED_STALL", 8.0));
        assert!((limit_deg(&parameters, 11.5) - 45.0).abs() < 1e-9);
        parameters.take(&value("AIRSPEED_STALL", 11.0));
        parameters.take(&value("STALL_PREVENTION", 0.0));
        assert!((limit_deg(&parameters, 11.5) - 45.0).abs() < 1e-9);
    }

    /// By the vehicle's limit, by its stall prevention, and `None` if there is no more.
    #[test]
    fn the_bank_in_need_is_what_the_vehicle_allows() {
        let mut parameters = VehicleParameters::default();
        parameters.take(&value("ROLL_LIMIT_DEG", 65.0));
        parameters.take(&value("AIRSPEED_MIN", 12.0));
        let mut config = Config::default();
        let in_need_deg = |parameters: &VehicleParameters, config: &Config, airspeed_mps| {
            let limit_rad = parameters.bank_in_need_rad(config, airspeed_mps)?;
            Some(limit_rad.to_degrees().round())
        };
        assert_eq!(in_need_deg(&parameters, &config, 25.0), Some(63.0));
        // (0.97 · 16 / 12)² = 1.673: arccos 0.598 = 53.3°, 2° in hand.
        assert_eq!(in_need_deg(&parameters, &config, 16.0), Some(51.0));
        assert_eq!(in_need_deg(&parameters, &config, 12.5), None);
        config.vehicle.max_bank_in_need_deg = 45.0;
        assert_eq!(in_need_deg(&parameters, &config, 25.0), None);
        parameters.take(&value("ROLL_LIMIT_DEG", 47.0));
        assert_eq!(in_need_deg(&parameters, &Config::default(), 25.0), None);
    }

    #[test]
    fn l13_a_small_bank_limit_is_flown_and_none_needs_a_climb() {
        let mut parameters = VehicleParameters::default();
        let mut config = Config::default();
        let limit_deg = |parameters: &VehicleParameters, config: &Config| {
            let limit_rad = parameters.bank_limit_rad(config, 25.0)?;
            Some(limit_rad.to_degrees().round())
        };
        parameters.take(&value("ROLL_LIMIT_DEG", 9.0));
        assert_eq!(limit_deg(&parameters, &config), Some(7.0));
        parameters.take(&value("ROLL_LIMIT_DEG", 3.0));
        assert_eq!(limit_deg(&parameters, &config), None);
        parameters.take(&value("TECS_CLMB_MAX", 5.0));
        config.vehicle.vertical = true;
        assert_eq!(limit_deg(&parameters, &config), Some(1.0));
        let bank_rad = parameters.bank_limit_rad(&config, 25.0).unwrap();
        let vehicle = parameters.vehicle(bank_rad, &config, 25.0, Response::default());
        assert!(vehicle.unwrap().can_climb());
        parameters.take(&value("ROLL_LIMIT_DEG", -45.0));
        assert_eq!(limit_deg(&parameters, &config), None);
    }

    #[test]
    fn absent_parameters_are_given_up() {
        let (mut parameters, mut outbox) = (VehicleParameters::default(), Outbox::default());
        for n in 0..250_u8 {
            parameters.tick(f64::from(n), 1, &mut outbox);
        }
        assert!(!parameters.is_complete() && !parameters.is_sufficient());
        let asked = outbox.take().len() + usize::try_from(outbox.dropped).unwrap();
        // Most names some times each, but for those that do not always count; bank limit and cruise airspeed every time, by both names.
        let given_up = WANTED.len() - NEEDED.len() - 2;
        assert_eq!(asked, given_up * usize::from(MOST_ROUNDS) + 2 * 2 * 250);
        // A request or an answer that is lost for a long time does not keep it on the ground.
        parameters.take(&value("ROLL_LIMIT_DEG", 45.0));
        parameters.take(&value("AIRSPEED_CRUISE", 22.0));
        assert!(parameters.is_complete() && parameters.is_sufficient());
        // A fence that comes later asks for its own.
        parameters.tick(300.0, 1, &mut outbox);
        assert!(outbox.take().is_empty());
        parameters.ask_for(FENCE_OPTIONS);
        parameters.tick(301.0, 1, &mut outbox);
        assert!(outbox.take().len() == 1 && !parameters.is_complete());
        parameters.take(&value(FENCE_OPTIONS, 3.0));
        assert!(parameters.is_complete());
    }
}

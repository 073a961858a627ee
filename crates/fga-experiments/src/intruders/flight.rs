//! One flight among manoeuvring intruders. The aircraft, the reports and the separation are separate
//! code of this folder; only the decision comes from the program.

use fga::Vec3;
use fga::avoider::{Avoider, Settings, State};
use fga::maneuver::Maneuver;
use fga::situation::{
    Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation, Uncertainty,
};

use super::setting::{PERIOD_S, RADIUS_M, VEHICLE};
use super::traffic::{Intruder, SplitMix64};

/// Longest step of the integration, seconds.
const STEP_S: f64 = 0.02;

/// The aircraft: position over the ground, course and climb angle through the air.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Own {
    pub(crate) position_m: Vec3,
    pub(crate) course_rad: f64,
    pub(crate) climb_rad: f64,
}

impl Own {
    pub(crate) const START: Self = Self {
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
    };

    fn heading(course_rad: f64, climb_rad: f64) -> Vec3 {
        let level = climb_rad.cos();
        Vec3::new(
            level * course_rad.cos(),
            level * course_rad.sin(),
            climb_rad.sin(),
        )
    }

    pub(crate) fn velocity_mps(&self) -> Vec3 {
        Self::heading(self.course_rad, self.climb_rad) * VEHICLE.airspeed_mps
    }

    /// Flies towards a course and a climb angle for a time, in a wind, by the midpoint rule.
    pub(crate) fn fly(&mut self, course_rad: f64, climb_rad: f64, for_s: f64, wind_mps: Vec3) {
        let turn_radps = VEHICLE.airspeed_mps / VEHICLE.turn_radius_m;
        let mut left_s = for_s;
        while left_s > 1e-12 {
            let turn = course_rad - self.course_rad;
            let climb = climb_rad - self.climb_rad;
            let mut step_s = left_s.min(STEP_S);
            for rest_s in [
                turn.abs() / turn_radps,
                climb.abs() / VEHICLE.climb_rate_radps,
            ] {
                if rest_s > 1e-12 {
                    step_s = step_s.min(rest_s);
                }
            }
            let turned = turn.clamp(-turn_radps * step_s, turn_radps * step_s);
            let most = VEHICLE.climb_rate_radps * step_s;
            let climbed = climb.clamp(-most, most);
            let middle = Self::heading(
                self.course_rad + 0.5 * turned,
                self.climb_rad + 0.5 * climbed,
            );
            self.position_m += (middle * VEHICLE.airspeed_mps + wind_mps) * step_s;
            self.course_rad += turned;
            self.climb_rad += climbed;
            left_s -= step_s;
        }
    }

    /// Flies a command for one period; `visit` sees the time within it and the position every 50 ms.
    fn fly_command(
        &mut self,
        command: &Maneuver,
        wind_mps: Vec3,
        mut visit: impl FnMut(f64, Vec3),
    ) {
        let mut at_s = 0.0;
        let mut target = (self.course_rad, self.climb_rad);
        let mut marks: Vec<f64> = command.stages().iter().map(|s| s.start_s).collect();
        marks.extend([0.5 * PERIOD_S, PERIOD_S]);
        marks.retain(|mark| *mark > 0.0 && *mark <= PERIOD_S);
        marks.sort_by(f64::total_cmp);
        for mark_s in marks {
            for stage in command.stages().iter().filter(|s| s.start_s <= at_s) {
                target = (stage.course_rad, stage.climb_rad);
            }
            self.fly(target.0, target.1, mark_s - at_s, wind_mps);
            at_s = mark_s;
            visit(at_s, self.position_m);
        }
    }
}

/// Imperfections of sight and air.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Conditions {
    pub(crate) movement: Movement,
    /// Standard deviation of each component of the gusts, metres per second.
    pub(crate) gust_mps: f64,
    /// Standard deviation of each component of a reported position, metres.
    pub(crate) noise_m: f64,
    /// Age of a report on arrival, seconds.
    pub(crate) latency_s: f64,
    /// Share of the reports that are missing.
    pub(crate) missing: f64,
    pub(crate) margin_m: f64,
}

impl Conditions {
    pub(crate) const IDEAL: Self = Self {
        movement: Movement::CREWED,
        gust_mps: 0.0,
        noise_m: 0.0,
        latency_s: 0.0,
        missing: 0.0,
        margin_m: 0.05,
    };
}

/// The result of a flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlownEncounter {
    pub(crate) margin_m: f64,
    pub(crate) acted: bool,
    pub(crate) cross_m: f64,
    pub(crate) changes: u32,
    pub(crate) back: bool,
    pub(crate) most_work: u32,
}

/// Correlation time of the gusts, seconds.
const GUST_S: f64 = 3.0;

/// The report of one intruder: position and velocity, smoothed by fixed gains where reports are noisy.
#[derive(Default)]
struct HeardTraffic {
    track: Option<(Vec3, Vec3, f64)>,
}

impl HeardTraffic {
    /// A report of a position at a time.
    fn report(&mut self, place_m: Vec3, velocity_mps: Vec3, at_s: f64, noise_m: f64) {
        let (position_m, velocity_mps) = match self.track {
            Some((position_m, velocity, last_s)) if noise_m > 0.0 => {
                // Gains of an α-β tracker for a manoeuvring target at 10 Hz.
                let (alpha, beta) = (0.2, 0.02);
                let passed_s = at_s - last_s;
                let expected = position_m + velocity * passed_s;
                let off = place_m - expected;
                (
                    expected + off * alpha,
                    velocity + off * (beta / passed_s) + (velocity_mps - velocity) * 0.2,
                )
            }
            _ => (place_m, velocity_mps),
        };
        self.track = Some((position_m, velocity_mps, at_s));
    }
}

/// Flies among intruders for a time.
pub(crate) fn fly(
    intruders: &mut [Intruder],
    conditions: &Conditions,
    horizon_s: f64,
    random: &mut SplitMix64,
) -> FlownEncounter {
    let settings = Settings {
        decision_period_s: PERIOD_S,
        surveillance_radius_m: f64::INFINITY,
        margin_m: conditions.margin_m,
        ..Settings::default()
    };
    let mut avoider = Box::new(Avoider::new(settings, VEHICLE).expect("usable settings"));
    let mission_m = [Vec3::ZERO, Vec3::X * 1e6];
    let volume = ProtectedVolume::Sphere { radius_m: RADIUS_M };
    let mut own = Own::START;
    let mut gust_mps = Vec3::ZERO;
    let mut heard: Vec<HeardTraffic> = intruders.iter().map(|_| HeardTraffic::default()).collect();
    let mut last = State::Cruise;
    let mut flown = FlownEncounter {
        margin_m: f64::INFINITY,
        acted: false,
        cross_m: 0.0,
        changes: 0,
        back: true,
        most_work: 0,
    };
    let velocity_sigma_mps = 0.1 * conditions.noise_m;
    for step in 0..(horizon_s / PERIOD_S).round() as u32 {
        let time_s = f64::from(step) * PERIOD_S;
        for intruder in intruders.iter_mut() {
            intruder.decide(time_s, own.position_m, own.velocity_mps());
        }
        let mut obstacles = Vec::with_capacity(intruders.len());
        for (place, (intruder, heard)) in intruders.iter().zip(&mut heard).enumerate() {
            let at_s = time_s - conditions.latency_s;
            if at_s >= 0.0 && random.unit() >= conditions.missing {
                let (position_m, velocity_mps) = intruder.at(at_s);
                let noisy_m = position_m + random.gaussian3() * conditions.noise_m;
                let noisy_mps = velocity_mps + random.gaussian3() * velocity_sigma_mps;
                heard.report(noisy_m, noisy_mps, at_s, conditions.noise_m);
            } else if conditions.noise_m == 0.0 {
                // No report: the core must remember the obstacle.
                continue;
            }
            let Some((position_m, velocity_mps, heard_s)) = heard.track else {
                continue;
            };
            let mut obstacle = Obstacle::straight(
                u32::try_from(place).unwrap_or(u32::MAX),
                position_m + velocity_mps * (time_s - heard_s),
                velocity_mps,
                volume,
            );
            obstacle.movement = conditions.movement;
            // σ of the smoothed track: some 40 % of a single report's.
            obstacle.uncertainty = Uncertainty {
                position_m: 0.4 * conditions.noise_m,
                velocity_mps: 0.35 * velocity_sigma_mps,
            };
            obstacles.push(obstacle);
        }
        let decision = avoider.step(&Situation {
            time_s,
            ownship: Ownship {
                position_m: own.position_m,
                course_rad: own.course_rad,
                climb_rad: own.climb_rad,
                bank_rad: 0.0,
                airspeed_mps: VEHICLE.airspeed_mps,
            },
            obstacles: Obstacles::Rows(&obstacles),
            mission: Mission::new(&mission_m),
            wind_mps: Vec3::ZERO,
        });
        let state = decision.state;
        flown.acted |= state == State::Avoiding;
        flown.changes += u32::from((state == State::Avoiding) != (last == State::Avoiding));
        flown.most_work = flown.most_work.max(decision.record.work.work);
        last = state;
        let kept = (-PERIOD_S / GUST_S).exp();
        gust_mps = gust_mps * kept
            + random.gaussian3() * (conditions.gust_mps * (1.0 - kept * kept).sqrt());
        own.fly_command(&decision.command, gust_mps, |after_s, place_m| {
            for intruder in intruders.iter() {
                let (position_m, _) = intruder.at(time_s + after_s);
                flown.margin_m = flown.margin_m.min(place_m.distance(position_m) - RADIUS_M);
            }
        });
        let aside_m = own.position_m.y.hypot(own.position_m.z);
        flown.cross_m = flown.cross_m.max(aside_m);
    }
    flown.back = last == State::Cruise;
    flown
}

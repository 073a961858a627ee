//! The demands of the flight modes on the aircraft.

use core::f64::consts::FRAC_1_SQRT_2;

use mavlink::dialects::ardupilotmega::{MavCmd, MavFrame};

use crate::Emulator;
use crate::geometry::{bearing, distance_m, wrap};
use crate::mode::PlaneMode;
use crate::plant::{Target, VehiclePlant, Vertical};

const GRAVITY_MPS2: f64 = 9.806_65;
/// Damping of the path following.
const L1_DAMPING: f64 = 0.75;
/// CRUISE locks its heading this long after the stick returns to the centre.
const HEADING_LOCK_S: f64 = 0.5;
/// Most items without a place to pass at a time: jumps that lead nowhere end.
const MOST_SKIPPED: u32 = 100;
/// Climb rate of a full pitch stick, metres per second.
const STICK_CLIMB_MPS: f64 = 2.0;

/// Bank to follow the line through two points (L1 guidance).
fn follow_line(plant: &VehiclePlant, period_s: f64, from_m: [f64; 3], to_m: [f64; 3]) -> f64 {
    let velocity = plant.velocity_mps();
    let speed = libm::hypot(velocity[0], velocity[1]).max(1.0);
    let course = libm::atan2(velocity[0], velocity[1]);
    let position = plant.position_m();
    let l1_m = period_s * L1_DAMPING / core::f64::consts::PI * speed;
    let gain = 4.0 * L1_DAMPING * L1_DAMPING;
    let length = distance_m(from_m, to_m);
    let angle = if length < 1.0 || distance_m(position, to_m) < 1.0 {
        wrap(bearing(position, to_m) - course)
    } else {
        let along = [
            (to_m[0] - from_m[0]) / length,
            (to_m[1] - from_m[1]) / length,
        ];
        let offset = [position[0] - from_m[0], position[1] - from_m[1]];
        // Positive to the right of the line.
        let across = offset[0] * along[1] - offset[1] * along[0];
        let line = libm::atan2(along[0], along[1]);
        wrap(line - course) + libm::asin((-across / l1_m).clamp(-FRAC_1_SQRT_2, FRAC_1_SQRT_2))
    };
    let angle = angle.clamp(-core::f64::consts::FRAC_PI_2, core::f64::consts::FRAC_PI_2);
    let acceleration = gain * speed * speed / l1_m * libm::sin(angle);
    libm::atan(acceleration / GRAVITY_MPS2)
}

/// Bank to circle a point clockwise.
fn circle(plant: &VehiclePlant, point_m: [f64; 3], radius_m: f64) -> f64 {
    let position = plant.position_m();
    let velocity = plant.velocity_mps();
    let speed = libm::hypot(velocity[0], velocity[1]).max(1.0);
    let course = libm::atan2(velocity[0], velocity[1]);
    let distance = distance_m(position, point_m);
    let to_centre = bearing(position, point_m);
    // Far out towards the point, on the circle at a right angle to it.
    let wanted = if distance > 2.0 * radius_m {
        to_centre
    } else {
        let share = ((distance - radius_m) / radius_m).clamp(-1.0, 1.0);
        to_centre - core::f64::consts::FRAC_PI_2 * (1.0 - share)
    };
    let steady = if distance > 1.5 * radius_m {
        0.0
    } else {
        speed * speed / radius_m
    };
    let acceleration = steady + 0.6 * speed * wrap(wanted - course);
    libm::atan(acceleration / GRAVITY_MPS2)
}

impl Emulator {
    pub(crate) fn target(&mut self) -> Target {
        match self.mode {
            PlaneMode::Auto => self.auto_target(),
            PlaneMode::Guided => self.guided_target(),
            PlaneMode::Rtl
            | PlaneMode::Loiter
            | PlaneMode::Circle
            | PlaneMode::AvoidAdsb
            | PlaneMode::Newer => self.loiter_target(),
            PlaneMode::Cruise | PlaneMode::FlyByWireB => Target {
                airspeed_mps: self.stick_airspeed_mps(),
                ..self.stick_target()
            },
            PlaneMode::Manual | PlaneMode::Stabilize | PlaneMode::FlyByWireA => {
                let bank_rad = self.stick(1) * self.parameters.value("ROLL_LIMIT_DEG").to_radians();
                Target {
                    bank_rad,
                    vertical: Vertical::Pitch(self.plant.pitch_rad()),
                    airspeed_mps: None,
                }
            }
        }
    }

    /// Position of a stick, −1 to 1; centred without an override.
    fn stick(&self, channel: usize) -> f64 {
        if self.ignore_attitude {
            return 0.0;
        }
        let lifetime_s = self.parameters.value("RC_OVERRIDE_TIME");
        let value = self
            .overrides
            .channel(channel, self.time_s, lifetime_s)
            .unwrap_or(1500);
        ((f64::from(value) - 1500.0) / 500.0).clamp(-1.0, 1.0)
    }

    /// The airspeed that an overridden throttle stick asks for, metres per second.
    fn stick_airspeed_mps(&self) -> Option<f64> {
        let lifetime_s = self.parameters.value("RC_OVERRIDE_TIME");
        let stick_us = self.overrides.channel(3, self.time_s, lifetime_s)?;
        let share = ((f64::from(stick_us) - 1000.0) / 1000.0).clamp(0.0, 1.0);
        let (least_mps, most_mps) = (
            self.parameters.value("AIRSPEED_MIN"),
            self.parameters.value("AIRSPEED_MAX"),
        );
        Some(least_mps + share * (most_mps - least_mps))
    }

    /// The target of a flown item, metres.
    pub(crate) fn item_place_m(&self, item: u16) -> Option<[f64; 3]> {
        let item = self.mission.get(usize::from(item))?;
        let mut place_m = item
            .is_waypoint()
            .then(|| item.position_m(&self.settings.home))
            .flatten()?;
        // Heights above home move with it.
        let is_above_sea = matches!(
            item.frame,
            MavFrame::MAV_FRAME_GLOBAL | MavFrame::MAV_FRAME_GLOBAL_INT
        );
        if !is_above_sea {
            place_m[2] += self.home_up_m;
        }
        Some(place_m)
    }

    /// The flown item that follows an item, without a jump made or an item run.
    pub(crate) fn flown_from(&mut self, item: u16) -> u16 {
        let now = (
            self.guidance.item,
            self.guidance.jumps.clone(),
            self.guidance.ran.len(),
        );
        self.guidance.item = item;
        self.skip_to_flown();
        let flown = self.guidance.item;
        (self.guidance.item, self.guidance.jumps) = (now.0, now.1);
        self.guidance.ran.truncate(now.2);
        flown
    }

    /// Goes on to the next flown item: makes jumps, and runs items without a place at once.
    pub(crate) fn skip_to_flown(&mut self) {
        for _ in 0..MOST_SKIPPED {
            let Some(item) = self.mission.get(usize::from(self.guidance.item)) else {
                return;
            };
            if item.command == MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH
                || self.item_place_m(self.guidance.item).is_some()
            {
                return;
            }
            let is_jump = item.command == MavCmd::MAV_CMD_DO_JUMP;
            if !is_jump {
                self.guidance.ran.push((self.time_s, self.guidance.item));
            }
            self.guidance.item = self.after(self.guidance.item);
        }
    }

    /// The item after a finished one.
    fn after(&mut self, item: u16) -> u16 {
        let jump = self
            .mission
            .get(usize::from(item))
            .filter(|at| at.command == MavCmd::MAV_CMD_DO_JUMP);
        let Some([to, times, ..]) = jump.map(|jump| jump.parameters) else {
            return item + 1;
        };
        let made = self.guidance.jumps.iter().filter(|at| **at == item).count();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "numbers of items in float fields; casts saturate"
        )]
        let (to, times) = (to as u16, times as i32);
        if times < 0 || made < usize::try_from(times).unwrap_or(0) {
            self.guidance.jumps.push(item);
            return to;
        }
        item + 1
    }

    /// How long the aircraft circles an item, seconds; infinite for ever.
    fn circled_s(&self, item: u16) -> f64 {
        let Some(item) = self.mission.get(usize::from(item)) else {
            return 0.0;
        };
        let first = f64::from(item.parameters[0]);
        let radius_m = self.parameters.value("WP_LOITER_RAD");
        let turn_s = core::f64::consts::TAU * radius_m / self.plant.airspeed_mps();
        match item.command {
            MavCmd::MAV_CMD_NAV_LOITER_UNLIM => f64::INFINITY,
            MavCmd::MAV_CMD_NAV_LOITER_TIME => first,
            MavCmd::MAV_CMD_NAV_LOITER_TURNS => first * turn_s,
            MavCmd::MAV_CMD_NAV_LOITER_TO_ALT => turn_s,
            _ => 0.0,
        }
    }

    fn auto_target(&mut self) -> Target {
        self.skip_to_flown();
        let Some(to_m) = self.item_place_m(self.guidance.item) else {
            let item = self.mission.get(usize::from(self.guidance.item));
            if item.is_some_and(|item| item.command == MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH) {
                // The nearest one stays the nearest on the way to it.
                self.guided.point_m = self.return_place_m();
                self.guided.altitude_m = 100.0;
            }
            self.guidance.done = true;
            return self.loiter_target();
        };
        let from_m = self.guidance.previous_m;
        let position = self.plant.position_m();
        let length = distance_m(from_m, to_m);
        let along = if length > 1.0 {
            ((position[0] - from_m[0]) * (to_m[0] - from_m[0])
                + (position[1] - from_m[1]) * (to_m[1] - from_m[1]))
                / length
        } else {
            length
        };
        let item = self.guidance.item;
        let circled_s = self.circled_s(item);
        let reached = distance_m(position, to_m) < self.parameters.value("WP_RADIUS");
        if circled_s > 0.0 && (reached || self.guidance.circling_since_s.is_some()) {
            let since_s = *self.guidance.circling_since_s.get_or_insert(self.time_s);
            if self.time_s - since_s < circled_s {
                self.guided.point_m = to_m;
                self.guided.altitude_m = to_m[2];
                return self.loiter_target();
            }
        }
        if reached || along >= length || self.guidance.circling_since_s.is_some() {
            self.send_reached(item);
            let next = self.after(item);
            if usize::from(next) < self.mission.len() {
                self.guidance.previous_m = to_m;
                self.guidance.begin_item(next, &self.plant, true);
                self.skip_to_flown();
                self.say_item();
            } else {
                self.guidance.done = true;
                self.guided.point_m = to_m;
                self.guided.altitude_m = to_m[2];
                return self.loiter_target();
            }
        }
        let period_s = self.parameters.value("NAVL1_PERIOD");
        Target {
            bank_rad: follow_line(&self.plant, period_s, from_m, to_m),
            vertical: Vertical::Altitude(to_m[2]),
            airspeed_mps: None,
        }
    }

    /// The text at the beginning of an item.
    pub(crate) fn say_item(&mut self) {
        let words = format!("Mission: {} WP", self.guidance.item);
        self.send_text(&words);
    }

    fn loiter_target(&mut self) -> Target {
        let radius_m = self.parameters.value("WP_LOITER_RAD");
        Target {
            bank_rad: circle(&self.plant, self.guided.point_m, radius_m),
            vertical: Vertical::Altitude(self.guided.altitude_m),
            airspeed_mps: None,
        }
    }

    fn guided_target(&mut self) -> Target {
        let mut target = self.loiter_target();
        if self.ignore_attitude {
            return target;
        }
        if let Some(heading) = self.guided.heading {
            let now = if heading.is_course {
                let velocity = self.plant.velocity_mps();
                libm::atan2(velocity[0], velocity[1])
            } else {
                self.plant.heading_rad()
            };
            let limit = libm::atan(heading.acceleration_mps2 / GRAVITY_MPS2);
            let error = wrap(heading.heading_rad - now);
            // Slow exponential tail: 90 % of 60° took 7.8 s.
            let acceleration = 0.45 * error * self.plant.airspeed_mps();
            target.bank_rad = libm::atan(acceleration / GRAVITY_MPS2).clamp(-limit, limit);
        }
        let time_out_s = self.parameters.value("GUIDED_TIMEOUT");
        if let Some((bank_rad, heard_s)) = self.guided.bank
            && self.time_s - heard_s <= time_out_s
        {
            target.bank_rad = bank_rad;
        }
        if let Some((pitch_rad, heard_s)) = self.guided.pitch
            && self.time_s - heard_s <= time_out_s
        {
            target.vertical = Vertical::Pitch(pitch_rad);
        }
        target
    }

    fn stick_target(&mut self) -> Target {
        let roll = self.stick(1);
        self.guidance.stick_altitude_m += self.stick(2) * STICK_CLIMB_MPS * crate::STEP_S;
        let vertical = Vertical::Altitude(self.guidance.stick_altitude_m);
        let centred = roll.abs() < 0.02;
        if !centred {
            self.guidance.centred_since_s = None;
            self.guidance.locked_heading_rad = None;
        }
        if self.mode == PlaneMode::FlyByWireB || !centred {
            let bank_rad = roll * self.parameters.value("ROLL_LIMIT_DEG").to_radians();
            return Target {
                bank_rad,
                vertical,
                airspeed_mps: None,
            };
        }
        let since = *self.guidance.centred_since_s.get_or_insert(self.time_s);
        if self.guidance.locked_heading_rad.is_none() && self.time_s - since >= HEADING_LOCK_S {
            let velocity = self.plant.velocity_mps();
            self.guidance.locked_heading_rad = Some(libm::atan2(velocity[0], velocity[1]));
            self.guidance.line_from_m = self.plant.position_m();
        }
        let Some(heading) = self.guidance.locked_heading_rad else {
            return Target {
                bank_rad: 0.0,
                vertical,
                airspeed_mps: None,
            };
        };
        let from_m = self.guidance.line_from_m;
        let to_m = [
            from_m[0] + 1e5 * libm::sin(heading),
            from_m[1] + 1e5 * libm::cos(heading),
            from_m[2],
        ];
        let period_s = self.parameters.value("NAVL1_PERIOD");
        Target {
            bank_rad: follow_line(&self.plant, period_s, from_m, to_m),
            vertical,
            airspeed_mps: None,
        }
    }
}

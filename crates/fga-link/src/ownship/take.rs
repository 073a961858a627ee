//! Which reports of place and attitude count: new ones, and no leaps that no aircraft makes.

use core::f64::consts::FRAC_PI_2;

use fga::Vec3;
use fga::angle::wrap_pi;
use fga_formats::geodesy::{Earth, LocalFrame};
use mavlink::dialects::ardupilotmega::{ATTITUDE_DATA, GLOBAL_POSITION_INT_DATA};

use super::{Arrival, Attitude, FASTEST_MPS, OwnshipEstimate, Position, Update, turn_rate_radps};
use crate::clock::BootStamp;
use crate::number::flown;

/// Rolling means that the bank changes faster than this, radians per second.
const ROLLS_RADPS: f64 = 0.15;
/// A position farther from the last one than this, metres, and than the fastest aircraft flies, does not count …
const JUMP_M: f64 = 200.0;
/// … unless the last is older than this, seconds: longer than telemetry may be stale.
const BELIEVED_AGAIN_S: f64 = 3.0;
/// A velocity that differs from the last one by more than this, metres per second, and than the hardest turn makes of it,
/// metres per second squared, does not count either.
const SPEED_JUMP_MPS: f64 = 15.0;
const HARDEST_MPS2: f64 = 40.0;
/// A bank that differs from the last one by more than this, radians, and than the fastest roll makes of it, radians per
/// second, does not count, unless the last is older than this, seconds.
const BANK_JUMP_RAD: f64 = 0.35;
const FASTEST_ROLL_RADPS: f64 = 7.0;
const BANK_BELIEVED_AGAIN_S: f64 = 0.5;
/// No plane turns its nose faster, radians per second.
const FASTEST_NOSE_RADPS: f64 = 10.0;
/// Home seldom moves up or down by more than this, metres: until it has done so for the time after which a position is believed
/// again, the old height counts.
const HOME_JUMP_M: f64 = 50.0;

/// The time at which a new message was measured, seconds.
const fn stamped(stamp: BootStamp) -> Option<(f64, Update)> {
    match stamp {
        BootStamp::New { measured_s } => Some((measured_s, Update::Fresh)),
        BootStamp::Restarted { measured_s } => Some((measured_s, Update::Restarted)),
        BootStamp::Old => None,
    }
}

impl OwnshipEstimate {
    const fn hear(&mut self, measured_s: f64, now_s: f64) {
        self.heard = Some(Arrival {
            at_s: now_s,
            late_s: now_s - measured_s,
        });
    }

    /// Takes a position.
    pub fn take_position(&mut self, data: &GLOBAL_POSITION_INT_DATA, now_s: f64) -> Update {
        let Some((place, velocity_mps)) = flown(data).filter(|(_, v)| v.length() <= FASTEST_MPS)
        else {
            return Update::Ignored;
        };
        let Some((measured_s, update)) =
            stamped(self.position_clock.stamp(data.time_boot_ms, now_s))
        else {
            return Update::Ignored;
        };
        self.hear(measured_s, now_s);
        let frame = self
            .frame
            .get_or_insert_with(|| LocalFrame::new(place, Earth::Wgs84));
        let place_m = frame.to_local_m(place);
        if let Some(last) = self.position.filter(|_| update == Update::Fresh) {
            let gap_s = (measured_s - last.measured_s).max(0.0);
            let reached_m = JUMP_M + FASTEST_MPS * gap_s;
            let turned_mps = SPEED_JUMP_MPS + HARDEST_MPS2 * gap_s;
            let jumps = place_m.distance(last.place_m) > reached_m
                || velocity_mps.distance(last.velocity_mps) > turned_mps;
            if gap_s < BELIEVED_AGAIN_S && jumps {
                return Update::Ignored;
            }
        }
        let reported_m = f64::from(data.relative_alt) * 1e-3;
        let above_home_m = self.above_home_m(reported_m, place_m, measured_s, update);
        self.position = Some(Position {
            measured_s,
            place,
            place_m,
            velocity_mps,
            above_home_m,
        });
        update
    }

    /// The height above home: the reported one, unless home jumps with it or is held.
    fn above_home_m(&mut self, reported_m: f64, place_m: Vec3, now_s: f64, update: Update) -> f64 {
        let Some(last) = self.position.filter(|_| update == Update::Fresh) else {
            self.home_moved_s = None;
            return reported_m;
        };
        let known_m = last.above_home_m + place_m.z - last.place_m.z;
        if self.holds_home {
            self.home_rose_m = known_m - reported_m;
            return known_m;
        }
        if (reported_m - known_m).abs() <= HOME_JUMP_M {
            self.home_moved_s = None;
            return reported_m;
        }
        let since_s = *self.home_moved_s.get_or_insert(now_s);
        if now_s - since_s < BELIEVED_AGAIN_S {
            known_m
        } else {
            reported_m
        }
    }

    /// Takes an attitude.
    pub fn take_attitude(&mut self, data: &ATTITUDE_DATA, now_s: f64) -> Update {
        let finite = [
            data.roll,
            data.pitch,
            data.yaw,
            data.pitchspeed,
            data.yawspeed,
        ]
        .iter()
        .all(|v| v.is_finite());
        let plausible = data.roll.abs() <= 4.0
            && data.pitch.abs() <= 2.0
            && f64::from(data.pitchspeed).abs() <= FASTEST_NOSE_RADPS
            && f64::from(data.yawspeed).abs() <= FASTEST_NOSE_RADPS;
        if !finite || !plausible {
            return Update::Ignored;
        }
        let Some((measured_s, update)) =
            stamped(self.attitude_clock.stamp(data.time_boot_ms, now_s))
        else {
            return Update::Ignored;
        };
        self.hear(measured_s, now_s);
        let bank_rad = -f64::from(data.roll);
        if let Some(last) = self.attitude.filter(|_| update == Update::Fresh) {
            let gap_s = (measured_s - last.measured_s).max(0.0);
            let rolled_rad = wrap_pi(bank_rad - last.bank_rad).abs();
            let jumps = rolled_rad > BANK_JUMP_RAD + FASTEST_ROLL_RADPS * gap_s;
            if gap_s < BANK_BELIEVED_AGAIN_S && jumps {
                return Update::Ignored;
            }
        }
        self.attitude = Some(Attitude {
            measured_s,
            bank_rad,
            pitch_rad: f64::from(data.pitch),
            heading_rad: wrap_pi(FRAC_PI_2 - f64::from(data.yaw)),
            yaw_rate_radps: -turn_rate_radps(data),
            rolls: data.rollspeed.is_finite() && f64::from(data.rollspeed).abs() > ROLLS_RADPS,
        });
        update
    }
}

//! How the aircraft follows its commands and the wind, learned from its own states.

use ::fga_learned::{GAPS_S, IN_HAND, Interval, KnownAircraft, Learned, SeenState};
use fga::Vec2;
use fga::limit::SettingsError;
use fga::vehicle::Vehicle;

use crate::abi::{FGA_ABI_VERSION, FGA_ALIGN};
use crate::growable::Growable;
use crate::input::{fga_enu, fga_vehicle, usable, usable_time};
use crate::memory::{AtWork, Kind, LentSpan, Object, answered, apart, fill, given, sized, work};
use crate::status::{Refused, fga_refusal, fga_status};

/// Bytes of storage for a learner.
pub const FGA_LEARNED_BYTES: usize = 5120;

/// Bit of `fga_seen_state::has`: a bank is commanded, `bank_command_left_rad`.
pub const FGA_SEEN_COMMAND: u32 = 1;

/// Bit of `fga_seen_state::has`: the velocity over the ground was measured, `velocity_mps`.
pub const FGA_SEEN_VELOCITY: u32 = 2;

/// Bit of `fga_known_aircraft::has`: of `turn_rate_factor` the flight weighs more than what is believed beforehand.
pub const FGA_KNOWN_TURN_RATE: u32 = 1;

/// Bit of `fga_known_aircraft::has`: of `bank_time_constant_s`, `dead_time_s` and `late_s` the flight weighs more than that.
pub const FGA_KNOWN_LAG: u32 = 2;

/// Bit of `fga_known_aircraft::has`: of both parts of the wind the flight weighs more than what is believed beforehand.
pub const FGA_KNOWN_WIND: u32 = 4;

/// The wind that is believed before the flight: none, within this to the east and to the north, metres per second.
const WIND_MPS: f64 = 15.0;
/// A state this little after the last one adds nothing, seconds; one this much before it comes late, and beyond that the clock was set.
const LEAST_GAP_S: f64 = 0.015;
const LATE_S: f64 = 1.0;
/// Commands that are remembered: a dead time of up to 0.75 s and half of a gap, at the least gap.
const COMMANDS: usize = 64;
/// A bank that follows sooner counts as one that follows in this time, seconds: the least that a vehicle may have.
const LEAST_LAG_S: f64 = 0.01;

const _: () = {
    assert!(Object::<Learning>::BYTES <= FGA_LEARNED_BYTES);
    assert!(FGA_LEARNED_BYTES.is_multiple_of(FGA_ALIGN));
    assert!(align_of::<Object<Learning>>() <= FGA_ALIGN);
    assert!(COMMANDS as f64 * LEAST_GAP_S > 0.75 + 0.5 * GAPS_S.end);
};

/// What the aircraft's own flight shows of it and the wind, in storage of the caller. It holds no address of anything outside of that.
pub struct fga_learned {
    _opaque: [u8; 0],
}

/// A measured state of the aircraft, as raw as there is: what a filter has delayed adds to the lag.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_seen_state {
    /// `sizeof(fga_seen_state)`.
    pub size: u32,
    /// What else is known, bits `FGA_SEEN_...`.
    pub has: u32,
    /// When it was measured, seconds.
    pub time_s: f64,
    /// Bank angle, radians, positive in a left turn. 1.4 and more shows nothing.
    pub bank_left_rad: f64,
    /// Rate of turn about the vertical, or of the course through the air, radians per second, positive to the left.
    pub turn_rate_left_radps: f64,
    /// Total airspeed, metres per second. Below 3 and from 300 on it shows nothing: the aircraft does not fly.
    pub airspeed_mps: f64,
    /// Bank that is commanded from now until the next state, radians, positive to the left; without `FGA_SEEN_COMMAND` not read.
    pub bank_command_left_rad: f64,
    /// Velocity over the ground, metres per second, of which the way up does not count; without `FGA_SEEN_VELOCITY` not read.
    pub velocity_mps: fga_enu,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_seen_state {}

/// A value and the interval in which it lies; of drawn aircraft the truth was inside at least 97 times of 100.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_interval {
    /// Lower end.
    pub low: f64,
    /// The value that is expected.
    pub mean: f64,
    /// Upper end.
    pub high: f64,
}

/// What is known of the aircraft and the wind. Without evidence it is what is believed beforehand.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_known_aircraft {
    /// `sizeof(fga_known_aircraft)`.
    pub size: u32,
    /// Of what the flight weighs more than what is believed beforehand, bits `FGA_KNOWN_...`.
    pub has: u32,
    /// Flown course rate over g tan(bank) / airspeed.
    pub turn_rate_factor: fga_interval,
    /// Time constant of the first-order response of the bank, seconds.
    pub bank_time_constant_s: fga_interval,
    /// Delay from a command to its first effect, seconds.
    pub dead_time_s: fga_interval,
    /// Dead time and time constant together, seconds: known better than either.
    pub late_s: fga_interval,
    /// Velocity of the air to the east, metres per second.
    pub wind_east_mps: fga_interval,
    /// Velocity of the air to the north, metres per second.
    pub wind_north_mps: fga_interval,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_known_aircraft {}

impl fga_interval {
    const fn of(interval: &Interval) -> Self {
        let Interval { low, mean, high } = *interval;
        Self { low, mean, high }
    }
}

/// The evidence, beside what it is about.
struct Learning {
    learned: Learned,
    vehicle: Vehicle,
    last_s: Option<f64>,
    /// Times and commanded banks, seconds and radians, newest first; those of the end of time are none.
    commands: [(f64, f64); COMMANDS],
}

impl Kind for Learning {
    const MARK: usize = 0x6667_616c;
}

impl fga_seen_state {
    /// The state, if all of it can be calculated with.
    fn seen(&self) -> Result<SeenState, Refused> {
        const VELOCITY: [&str; 3] = ["velocity_mps.east", "velocity_mps.north", "velocity_mps.up"];
        if self.has > FGA_SEEN_COMMAND | FGA_SEEN_VELOCITY {
            return Err(Refused::unknown("has", self.has, "bits FGA_SEEN_..."));
        }
        usable("bank_left_rad", self.bank_left_rad)?;
        usable("turn_rate_left_radps", self.turn_rate_left_radps)?;
        usable("airspeed_mps", self.airspeed_mps)?;
        if self.has & FGA_SEEN_COMMAND != 0 {
            usable("bank_command_left_rad", self.bank_command_left_rad)?;
        }
        let velocity_mps = if self.has & FGA_SEEN_VELOCITY == 0 {
            None
        } else {
            Some(self.velocity_mps.usable(VELOCITY)?.truncate())
        };
        Ok(SeenState {
            time_s: usable_time("time_s", self.time_s)?,
            bank_rad: self.bank_left_rad,
            turn_rate_radps: self.turn_rate_left_radps,
            airspeed_mps: self.airspeed_mps,
            velocity_mps,
        })
    }
}

impl Learning {
    /// Nobody commanded a bank.
    const UNCOMMANDED: [(f64, f64); COMMANDS] = [(f64::INFINITY, 0.0); COMMANDS];

    fn see(&mut self, of: &fga_seen_state) -> Result<(), Refused> {
        let seen = of.seen()?;
        let gap_s = self.last_s.map_or(0.0, |last_s| seen.time_s - last_s);
        let is_in_order = !(-LATE_S..0.0).contains(&gap_s);
        let expected = "no time before the last state";
        SettingsError::unless(is_in_order, "time_s", seen.time_s, expected)?;
        if self.last_s.is_some() && (0.0..LEAST_GAP_S).contains(&gap_s) {
            return Ok(());
        }
        self.last_s = Some(seen.time_s);
        let is_commanded = of.has & FGA_SEEN_COMMAND != 0;
        if !is_commanded || !GAPS_S.contains(&gap_s) {
            self.commands = Self::UNCOMMANDED;
        }
        if is_commanded && let Some(oldest) = self.commands.last_mut() {
            *oldest = (seen.time_s, of.bank_command_left_rad);
            self.commands.rotate_right(1);
        }
        let commands = &self.commands;
        self.learned.see(&seen, |before_s| {
            let at_s = seen.time_s - before_s;
            let begun = commands.iter().find(|command| command.0 <= at_s);
            begun.map(|command| command.1)
        });
        Ok(())
    }

    fn known(&self) -> (KnownAircraft, u32) {
        let believed = KnownAircraft::of_file(&self.vehicle.response, Vec2::ZERO, WIND_MPS);
        let bits = [FGA_KNOWN_TURN_RATE, FGA_KNOWN_LAG, FGA_KNOWN_WIND];
        let outweighs = bits.into_iter().zip(self.learned.outweighs(&believed));
        let has = outweighs.map(|(bit, outweighs)| bit * u32::from(outweighs));
        (self.learned.known(&believed), has.sum())
    }

    /// The vehicle as plans should have it.
    fn vehicle(&self) -> Result<Vehicle, Refused> {
        let known = self.learned.planned(&self.vehicle.response, IN_HAND);
        let mut vehicle = self.vehicle;
        vehicle.response = known.response();
        let lag_s = &mut vehicle.response.bank_time_constant_s;
        if *lag_s > 0.0 {
            *lag_s = lag_s.max(LEAST_LAG_S);
        }
        vehicle.check()?;
        Ok(vehicle)
    }
}

/// Bytes of storage for a learner: `FGA_LEARNED_BYTES`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_learned_size() -> usize {
    FGA_LEARNED_BYTES
}

/// Alignment of the storage of a learner, bytes: `FGA_ALIGN`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_learned_align() -> usize {
    FGA_ALIGN
}

/// Constructs a learner in storage of the caller, as `fga_avoider_init` does an avoider. To forget all that was learned, construct it again.
///
/// `vehicle` is what is believed before the flight: its turn-rate factor within 25 %, its bank time constant within 0.3 s and its dead time
/// within 0.1 s. The wind is believed to be none, within 15 m/s to the east and to the north.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_learned_init(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    abi_version: u32,
    vehicle: *const fga_vehicle,
    learned: *mut *mut fga_learned,
    why: *mut fga_refusal,
) -> fga_status {
    if abi_version != FGA_ABI_VERSION {
        return fga_status::WrongVersion;
    }
    let make = |why: LentSpan| {
        let (object, storage) = Object::storage(storage.cast(), storage_size, FGA_LEARNED_BYTES)?;
        // SAFETY: the caller's word, in the header.
        let (vehicle, of) = unsafe { given(vehicle) }?;
        apart(&[storage, of, LentSpan::of(learned.cast_const(), 1)?, why])?;
        let vehicle = vehicle.vehicle()?;
        let construct = |learning: *mut Learning| -> Result<(), Refused> {
            // SAFETY: there is room for a `Learning`; all of its fields are written.
            unsafe {
                (&raw mut (*learning).learned).write(Learned::default());
                (&raw mut (*learning).vehicle).write(vehicle);
                (&raw mut (*learning).last_s).write(None);
                (&raw mut (*learning).commands).write(Learning::UNCOMMANDED);
            }
            Ok(())
        };
        // SAFETY: `storage` has accepted it, it overlaps nothing else, and the caller lends it.
        unsafe {
            Object::init(object, storage, construct)?;
            learned.write(object.cast());
        }
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { answered(why, make) }
}

/// Learns from a state of the aircraft: call it 3 to 50 times a second, whoever flies. Steady turns show the turn-rate factor, commanded
/// banks show lag and dead time, and velocities in several directions the wind; straight flight shows nothing.
///
/// A state less than 0.015 s after the last one adds nothing, and one that comes late by up to a second is refused. Where the clock was
/// set, or nothing came for 0.35 s, what was learned stays, and the commands before are not counted.
///
/// An aircraft that turns unlike before by more than chance, or whose airspeed has changed by 15 %, is another one: a tenth of the evidence
/// stays.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_learned_see(
    learned: *mut fga_learned,
    state: *const fga_seen_state,
    why: *mut fga_refusal,
) -> fga_status {
    let see = |learning: &mut AtWork<'_, Learning>, why| {
        // SAFETY: the caller's word, in the header.
        let (state, span) = unsafe { given(state) }?;
        apart(&[learning.span, span, why])?;
        learning.value().see(&state)?;
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { work(learned.cast(), why, see) }
}

/// What is known now, from what is believed beforehand and the flight.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_learned_known(
    learned: *mut fga_learned,
    known: *mut fga_known_aircraft,
) -> fga_status {
    let write = |learning: &mut AtWork<'_, Learning>, _| {
        // SAFETY: the caller's word, in the header.
        apart(&[learning.span, unsafe { sized(known) }?])?;
        let (now, has) = learning.value().known();
        let set = |known: &mut fga_known_aircraft| {
            known.has = has;
            known.turn_rate_factor = fga_interval::of(&now.turn_rate_factor);
            known.bank_time_constant_s = fga_interval::of(&now.bank_time_constant_s);
            known.dead_time_s = fga_interval::of(&now.dead_time_s);
            known.late_s = fga_interval::of(&now.late_s);
            [known.wind_east_mps, known.wind_north_mps] =
                now.wind_mps.each_ref().map(fga_interval::of);
        };
        // SAFETY: checked above.
        unsafe { fill(known, set) };
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { work(learned.cast(), core::ptr::null_mut(), write) }
}

/// The vehicle for decisions and proofs: the one of `fga_learned_init` with its response as it is known now, and 0.97 of the expected
/// turn-rate factor, so that a turn may be a little wider than expected. `fga fly` plans with the same.
///
/// Give it to `fga_avoider_set_vehicle` between manoeuvres, in `FGA_STATE_CRUISE`: a manoeuvre keeps the limits that it was proven with.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, and `OUT_OF_RANGE` where the bank lags more than a
/// proof allows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_learned_vehicle(
    learned: *mut fga_learned,
    vehicle: *mut fga_vehicle,
    why: *mut fga_refusal,
) -> fga_status {
    let write = |learning: &mut AtWork<'_, Learning>, why| {
        // SAFETY: the caller's word, in the header.
        apart(&[learning.span, unsafe { sized(vehicle) }?, why])?;
        let now = learning.value().vehicle()?;
        // SAFETY: checked above.
        unsafe { fill(vehicle, |vehicle: &mut fga_vehicle| vehicle.set(&now)) };
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { work(learned.cast(), why, write) }
}

/// Keeps a tenth of the evidence of turns and rolls: the aircraft has become another one, by its load, its flaps or a failure.
///
/// Refuses `NULL`, `MISALIGNED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_learned_forget(learned: *mut fga_learned) -> fga_status {
    let forget = |learning: &mut AtWork<'_, Learning>, _| {
        learning.value().learned.forget();
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { work(learned.cast(), core::ptr::null_mut(), forget) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_pointer_width = "64")]
    #[test]
    fn the_header_says_what_a_learner_takes() {
        assert_eq!(
            FGA_LEARNED_BYTES,
            Object::<Learning>::BYTES.next_multiple_of(512),
            "write the second number there, then HEADER=write cargo test -p fga-c --test header"
        );
    }
}

//! Beliefs about aircraft by their reports, on which an avoider decides by expected cost.

use fga::Vec3;
use fga::avoider::belief::{BeliefDecider, Errors, Report};
use fga::situation::ProtectedVolume;
use fga_belief::ENDS_AFTER_S;

use crate::abi::FGA_ABI_VERSION;
use crate::input::{fga_enu, fga_movement, usable_time, volume};
use crate::memory::{self, AtWork, Kind, LentSpan, Object, answered, apart, given};
use crate::reports::{fga_report, fga_report_counts};
use crate::status::{Refused, fga_refusal, fga_status};

/// Bytes of storage for beliefs.
pub const FGA_BELIEFS_BYTES: usize = 50_688;

const _: () = assert!(Object::<Believing>::BYTES <= FGA_BELIEFS_BYTES);

/// What is believed of at most 16 aircraft, in storage of the caller, for one avoider. It holds no address of anything outside of that.
pub struct fga_beliefs {
    _opaque: [u8; 0],
}

/// The beliefs, and the counts of reports.
pub(crate) struct Believing {
    pub(crate) decider: BeliefDecider,
    counts: fga_report_counts,
}

/// Checks a report from C. Returns the reported aircraft with its volume, the report, and the ownship's position, metres.
fn heard(
    of: &fga_report,
    (radius_m, half_height_m): (f64, f64),
    now_s: f64,
    own_m: fga_enu,
) -> Result<((u32, ProtectedVolume), Report, Vec3), Refused> {
    usable_time("now_s", now_s)?;
    let own_m = own_m.usable(["own_m.east", "own_m.north", "own_m.up"])?;
    let volume = volume(radius_m, half_height_m)?;
    let aircraft = fga_movement::Crewed as u32..=fga_movement::SmallUas as u32;
    if !aircraft.contains(&of.movement) {
        let expected = "FGA_MOVEMENT_CREWED or FGA_MOVEMENT_SMALL_UAS";
        return Err(Refused::unknown("movement", of.movement, expected));
    }
    Ok(((of.id, volume), of.report(now_s)?, own_m))
}

impl Kind for Believing {
    const MARK: usize = 0x6667_6162;
}

/// Bytes of storage for beliefs: `FGA_BELIEFS_BYTES`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_beliefs_size() -> usize {
    FGA_BELIEFS_BYTES
}

/// Constructs beliefs about nobody in storage of the caller, as `fga_avoider_init` does an avoider. It takes up to 51 kB of stack, once; a step on
/// beliefs takes 32 kB.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_beliefs_init(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    abi_version: u32,
    beliefs: *mut *mut fga_beliefs,
    why: *mut fga_refusal,
) -> fga_status {
    if abi_version != FGA_ABI_VERSION {
        return fga_status::WrongVersion;
    }
    let make = |why: LentSpan| {
        let (object, storage) = Object::storage(storage.cast(), storage_size, FGA_BELIEFS_BYTES)?;
        apart(&[storage, LentSpan::of(beliefs.cast_const(), 1)?, why])?;
        let construct = |place: *mut Believing| -> Result<(), Refused> {
            // SAFETY: there is room for a `Believing`, both fields of which are written.
            unsafe {
                (&raw mut (*place).decider).write(BeliefDecider::new(Errors::default()));
                (&raw mut (*place).counts).write(fga_report_counts::NONE);
            }
            Ok(())
        };
        // SAFETY: `storage` has accepted it, it overlaps nothing else, and the caller lends it.
        unsafe {
            Object::init(object, storage, construct)?;
            beliefs.write(object.cast());
        }
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { answered(why, make) }
}

/// Takes a report of an aircraft. `radius_m` and `half_height_m` are the volume around it; a half height of 0 means a sphere. Reports, situations
/// and `now_s` share one clock. `own_m` is the ownship's position, metres.
///
/// It counts each report. One that is late, or older than 8 s, changes nothing else. An aircraft without a report for 8 s is forgotten, unless the
/// situation has it. What rests or flies straight by contract is an obstacle of the situation; it takes the place of an aircraft with its
/// identifier.
///
/// `FGA_STATUS_INCOMPLETE`: of more than 16 aircraft the farthest one is left out.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_beliefs_hear(
    beliefs: *mut fga_beliefs,
    report: *const fga_report,
    radius_m: f64,
    half_height_m: f64,
    now_s: f64,
    own_m: fga_enu,
    why: *mut fga_refusal,
) -> fga_status {
    let hear = |believing: &mut AtWork<'_, Believing>, why| {
        // SAFETY: the caller's word, in the header.
        let (of, from) = unsafe { given(report) }?;
        apart(&[believing.span, from, why])?;
        let believing = believing.value();
        let count = |counted: &mut u32| *counted = counted.saturating_add(1);
        count(&mut believing.counts.heard);
        let taken = heard(&of, (radius_m, half_height_m), now_s, own_m);
        let (aircraft, report, own_m) =
            taken.inspect_err(|_| count(&mut believing.counts.unusable))?;
        let decider = &mut believing.decider;
        let is_new = if now_s - report.time_s > ENDS_AFTER_S {
            Some(false)
        } else {
            decider.hear(aircraft, &report, &of.bounds(), own_m)
        };
        match is_new {
            Some(true) => {}
            Some(false) => count(&mut believing.counts.late),
            None => {
                count(&mut believing.counts.left_out);
                return Ok(fga_status::Incomplete);
            }
        }
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { memory::work(beliefs.cast(), why, hear) }
}

/// Forgets what was chosen, as at the begin of another flight; who is around stays known. Call it where `fga_avoider_restart` is called.
///
/// Refuses `NULL`, `MISALIGNED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_beliefs_restart(beliefs: *mut fga_beliefs) -> fga_status {
    let restart = |believing: &mut AtWork<'_, Believing>, _| {
        believing.value().decider.restart();
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { memory::work(beliefs.cast(), core::ptr::null_mut(), restart) }
}

/// What became of the reports since it was initialized.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_beliefs_counts(
    beliefs: *mut fga_beliefs,
    counts: *mut fga_report_counts,
) -> fga_status {
    let write = |believing: &mut AtWork<'_, Believing>, _| {
        let now = believing.value().counts;
        // SAFETY: the caller's word, in the header.
        unsafe { now.write(counts, believing.span) }
    };
    // SAFETY: the caller's word, in the header.
    unsafe { memory::work(beliefs.cast(), core::ptr::null_mut(), write) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_pointer_width = "64")]
    #[test]
    fn the_header_says_what_beliefs_take() {
        assert_eq!(
            FGA_BELIEFS_BYTES,
            Object::<Believing>::BYTES.next_multiple_of(512),
            "write the second number there, then HEADER=write cargo test -p fga-c --test header"
        );
    }
}

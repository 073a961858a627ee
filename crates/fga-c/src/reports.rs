//! Reports of other aircraft, filtered: as they come in, and as obstacles of a moment out.

use fga::Vec3;
use fga::situation::MovementBounds;
use fga_belief::{Belief, Errors, Report, Sigma, Source};

use crate::abi::{FGA_ABI_VERSION, FGA_ALIGN, FGA_CAPACITY_MOST};
use crate::growable::{Growable, size_word};
use crate::input::{fga_enu, fga_movement, fga_obstacle, fga_volume, usable, usable_time, volume};
use crate::memory::{self, AtWork, Kind, LentSpan, Object, answered, apart, fill, given, sized};
use crate::status::{Refused, fga_refusal, fga_status};

/// Bytes of storage for reports without aircraft; see `FGA_REPORTS_BYTES`.
pub const FGA_REPORTS_FIXED_BYTES: usize = 128;

/// Bytes of storage for reports for each aircraft; see `FGA_REPORTS_BYTES`.
pub const FGA_REPORTS_AIRCRAFT_BYTES: usize = 512;

/// A report may be this much from the future, seconds: clocks differ.
const EARLY_S: f64 = 1.0;

const _: () = {
    assert!(Object::<FilteredTraffic>::BYTES <= FGA_REPORTS_FIXED_BYTES);
    assert!(FGA_REPORTS_FIXED_BYTES.is_multiple_of(FGA_ALIGN));
    assert!(size_of::<FilteredAircraft>() <= FGA_REPORTS_AIRCRAFT_BYTES);
    assert!(FGA_REPORTS_AIRCRAFT_BYTES.is_multiple_of(FGA_ALIGN));
    assert!(align_of::<FilteredAircraft>() <= FGA_ALIGN);
};

/// What is known of other aircraft by their reports, in storage of the caller. It holds no address of anything outside of that.
pub struct fga_reports {
    _opaque: [u8; 0],
}

/// A report of an aircraft or another obstacle, raw as it came, over the ground.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_report {
    /// `sizeof(fga_report)`.
    pub size: u32,
    /// Its identifier, the same in each report, such as the ICAO address.
    pub id: u32,
    /// Its possible motion: an `fga_movement` but `FGA_MOVEMENT_BOUNDED`. There is no default.
    pub movement: u32,
    /// Whether the report has a velocity (1), or not (0).
    pub has_velocity: u32,
    /// The moment of its position, seconds, on the clock of the caller.
    pub time_s: f64,
    /// Position, metres.
    pub position_m: fga_enu,
    /// Velocity over the ground, metres per second; without one not used, nor of what rests.
    pub velocity_mps: fga_enu,
    /// Standard deviation of the position along any axis, metres, 0 or more.
    pub position_sigma_m: f64,
    /// Standard deviation of the velocity along any axis, metres per second, 0 or more.
    pub velocity_sigma_mps: f64,
    /// Standard deviation of the altitude, metres; 0 means that of the position.
    pub altitude_sigma_m: f64,
    /// Standard deviation of an error of the position that lasts from report to report, metres, 0 or more.
    pub lasting_position_sigma_m: f64,
    /// The same of the altitude, as of pressure altitude, metres, 0 or more.
    pub lasting_altitude_sigma_m: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_report {}

/// What became of reports. The counts stay at their largest value.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct fga_report_counts {
    /// `sizeof(fga_report_counts)`.
    pub size: u32,
    /// Reports given.
    pub heard: u32,
    /// Of these, refused: a number that is not finite or negative, no such movement, or from the future.
    pub unusable: u32,
    /// Of these, older than one of the same aircraft, or than the lifetime.
    pub late: u32,
    /// Times that an aircraft had no room: the farthest one was left out.
    pub left_out: u32,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_report_counts {}

impl fga_report_counts {
    /// Of no reports.
    pub(crate) const NONE: Self = Self {
        size: size_word::<Self>(),
        heard: 0,
        unusable: 0,
        late: 0,
        left_out: 0,
    };

    /// Writes them for the caller, outside of an object.
    ///
    /// # Safety
    /// As [`given`].
    pub(crate) unsafe fn write(
        self,
        counts: *mut Self,
        object: LentSpan,
    ) -> Result<fga_status, Refused> {
        // SAFETY: as this function.
        apart(&[object, unsafe { sized(counts) }?])?;
        // SAFETY: checked above.
        unsafe { fill(counts, |counts| *counts = self) };
        Ok(fga_status::Ok)
    }
}

/// The aircraft behind it in the storage, and the counts.
struct FilteredTraffic {
    most: u32,
    count: u32,
    lifetime_s: f64,
    counts: fga_report_counts,
}

impl Kind for FilteredTraffic {
    const MARK: usize = 0x6667_6172;
}

/// One aircraft as of its last report, filtered.
#[derive(Debug, Clone, Copy)]
struct FilteredAircraft {
    id: u32,
    movement: u32,
    time_s: f64,
    position_m: Vec3,
    velocity_mps: Vec3,
    /// σ of position and velocity along any axis, metres and metres per second.
    sigmas: [f64; 2],
    belief: Belief,
}

/// Whether it is an obstacle at rest.
const fn rests(movement: u32) -> bool {
    movement == fga_movement::AtRest as u32
}

impl FilteredAircraft {
    /// An aircraft after its first report, or after another one.
    fn after(before: Option<&Self>, of: &fga_report, report: &Report) -> Self {
        let bounds = of.bounds();
        let belief = before.map(|before| before.belief);
        let belief = belief.filter(|belief| *belief.bounds() == bounds);
        let belief = Belief::after(belief, report, &bounds);
        let mut heard = Self {
            id: of.id,
            movement: of.movement,
            time_s: report.time_s,
            position_m: report.position_m,
            velocity_mps: Vec3::ZERO,
            sigmas: [of.position_sigma_m.max(of.altitude_sigma_m), 0.0],
            belief,
        };
        // What rests is where it is reported.
        if !rests(of.movement) {
            let estimate = belief.at(report.time_s);
            heard.position_m = estimate.position_m;
            heard.velocity_mps = estimate.velocity_mps;
            heard.sigmas = estimate.sigmas();
        }
        let lasting_m = of.lasting_position_sigma_m.max(of.lasting_altitude_sigma_m);
        heard.sigmas[0] = libm::hypot(heard.sigmas[0], lasting_m);
        heard
    }

    /// The obstacle at a moment, carried on by its age.
    fn obstacle(&self, now_s: f64, radius_m: f64, half_height_m: f64) -> fga_obstacle {
        let age_s = if rests(self.movement) {
            0.0
        } else {
            (now_s - self.time_s).max(0.0)
        };
        let volume = if half_height_m > 0.0 {
            fga_volume::Cylinder
        } else {
            fga_volume::Sphere
        };
        fga_obstacle {
            size: size_word::<fga_obstacle>(),
            id: self.id,
            position_m: fga_enu::of(self.position_m + self.velocity_mps * age_s),
            velocity_mps: fga_enu::of(self.velocity_mps),
            volume: volume as u32,
            movement: self.movement,
            radius_m,
            half_height_m,
            // A filtered place and its velocity err together; what a silent aircraft does meanwhile is not in either.
            position_sigma_m: self.sigmas[0] + self.sigmas[1] * age_s,
            velocity_sigma_mps: self.sigmas[1],
            age_s,
            bounds: crate::input::fga_bounds {
                turn_rate_radps: 0.0,
                brief_turn_rate_radps: 0.0,
                turn_rad: 0.0,
                climb_change_mps: 0.0,
                acceleration_mps2: 0.0,
            },
        }
    }
}

impl fga_report {
    /// The bounds of the aircraft.
    pub(crate) const fn bounds(&self) -> MovementBounds {
        if self.movement == fga_movement::SmallUas as u32 {
            MovementBounds::SMALL_UAS
        } else {
            MovementBounds::CREWED
        }
    }

    /// The report for the filter, if it can be used now.
    pub(crate) fn report(&self, now_s: f64) -> Result<Report, Refused> {
        const POSITION: [&str; 3] = ["position_m.east", "position_m.north", "position_m.up"];
        const VELOCITY: [&str; 3] = ["velocity_mps.east", "velocity_mps.north", "velocity_mps.up"];
        let movements = fga_movement::AtRest as u32..=fga_movement::SmallUas as u32;
        if !movements.contains(&self.movement) {
            let expected = "an fga_movement but FGA_MOVEMENT_BOUNDED";
            return Err(Refused::unknown("movement", self.movement, expected));
        }
        usable_time("time_s", self.time_s)?;
        if self.time_s > now_s + EARLY_S {
            return Err(Refused::out_of_range("time_s", self.time_s, "at most now"));
        }
        for (field, sigma) in [
            ("position_sigma_m", self.position_sigma_m),
            ("velocity_sigma_mps", self.velocity_sigma_mps),
            ("altitude_sigma_m", self.altitude_sigma_m),
            ("lasting_position_sigma_m", self.lasting_position_sigma_m),
            ("lasting_altitude_sigma_m", self.lasting_altitude_sigma_m),
        ] {
            usable(field, sigma)?;
            if sigma < 0.0 {
                return Err(Refused::out_of_range(field, sigma, "0 or more"));
            }
        }
        let velocity_mps = if self.has_velocity == 0 {
            None
        } else {
            Some(self.velocity_mps.usable(VELOCITY)?)
        };
        #[expect(clippy::cast_possible_truncation, reason = "single precision suffices")]
        let sigma = |value: f64| Sigma::new(value as f32, Source::Report);
        let (position, velocity) = (sigma(self.position_sigma_m), sigma(self.velocity_sigma_mps));
        let altitude = if self.altitude_sigma_m > 0.0 {
            sigma(self.altitude_sigma_m)
        } else {
            position
        };
        Ok(Report {
            time_s: self.time_s,
            position_m: self.position_m.usable(POSITION)?,
            velocity_mps,
            carried_s: 0.0,
            errors: Errors {
                position_m: position,
                altitude_m: altitude,
                velocity_mps: velocity,
                climb_mps: velocity,
                lasting_position_m: sigma(self.lasting_position_sigma_m),
                lasting_altitude_m: sigma(self.lasting_altitude_sigma_m),
            },
        })
    }
}

impl AtWork<'_, FilteredTraffic> {
    /// The aircraft.
    fn heard(&mut self) -> &mut [FilteredAircraft] {
        let count = self.value().count as usize;
        let places: *mut FilteredAircraft = self.list(FGA_REPORTS_FIXED_BYTES);
        // SAFETY: there is room for `most` of them behind the object, the first `count` are written, and the object is at work here.
        unsafe { core::slice::from_raw_parts_mut(places, count) }
    }

    /// Forgets who is heard no more.
    fn forget(&mut self, now_s: f64) {
        let lifetime_s = self.value().lifetime_s;
        let mut kept = 0;
        let heard = self.heard();
        for index in 0..heard.len() {
            let Some(&aircraft) = heard.get(index) else {
                break;
            };
            if rests(aircraft.movement) || now_s - aircraft.time_s <= lifetime_s {
                if let Some(place) = heard.get_mut(kept) {
                    *place = aircraft;
                }
                kept += 1;
            }
        }
        self.value().count = u32::try_from(kept).unwrap_or(0);
    }

    /// Takes a usable report.
    fn take(&mut self, of: &fga_report, report: &Report, now_s: f64, own_m: Vec3) -> fga_status {
        self.forget(now_s);
        let (most, lifetime_s) = (self.value().most as usize, self.value().lifetime_s);
        let known = self.heard().iter().position(|heard| heard.id == of.id);
        let before = known.and_then(|index| self.heard().get(index).copied());
        let is_older = before.is_some_and(|before| report.time_s < before.time_s);
        if is_older || !rests(of.movement) && now_s - report.time_s > lifetime_s {
            let late = &mut self.value().counts.late;
            *late = late.saturating_add(1);
            return fga_status::Ok;
        }
        let mut status = fga_status::Ok;
        let mut place = known.unwrap_or(self.heard().len());
        if place >= most {
            let left_out = &mut self.value().counts.left_out;
            *left_out = left_out.saturating_add(1);
            status = fga_status::Incomplete;
            let away_m = |position_m: Vec3| (position_m - own_m).length();
            let aways_m = self.heard().iter().map(|heard| away_m(heard.position_m));
            let farthest = (0..).zip(aways_m).max_by(|a, b| a.1.total_cmp(&b.1));
            match farthest {
                Some((index, far_m)) if away_m(report.position_m) < far_m => place = index,
                _ => return status,
            }
        } else if known.is_none() {
            self.value().count += 1;
        }
        let places: *mut FilteredAircraft = self.list(FGA_REPORTS_FIXED_BYTES);
        let heard = FilteredAircraft::after(before.as_ref(), of, report);
        // SAFETY: below `most`, so there is such a place.
        unsafe { places.add(place).write(heard) };
        status
    }
}

/// Bytes of storage for the reports of this number of aircraft; 0 where it is above `FGA_CAPACITY_MOST`. For static storage the macro
/// `FGA_REPORTS_BYTES` gives the same.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_reports_size(aircraft_most: u32) -> usize {
    if aircraft_most > FGA_CAPACITY_MOST {
        return 0;
    }
    FGA_REPORTS_FIXED_BYTES + aircraft_most as usize * FGA_REPORTS_AIRCRAFT_BYTES
}

/// Fills the standard deviations of a report by the `NACp` and `NACv` that ADS-B states (RTCA DO-260B; 14 CFR 91.217 for the altitude). A
/// category without a bound counts as the worst with one.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_report_set_adsb(
    report: *mut fga_report,
    nac_p: u8,
    nac_v: u8,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    if let Err(status) = unsafe { sized(report) } {
        return status;
    }
    let errors = Errors::of_adsb(nac_p, nac_v);
    // SAFETY: checked above.
    let report = unsafe { &mut *report };
    report.position_sigma_m = errors.position_m.value.into();
    report.velocity_sigma_mps = errors.velocity_mps.value.into();
    report.altitude_sigma_m = errors.altitude_m.value.into();
    report.lasting_position_sigma_m = errors.lasting_position_m.value.into();
    report.lasting_altitude_sigma_m = errors.lasting_altitude_m.value.into();
    fga_status::Ok
}

/// Constructs a filter of reports in storage of the caller, as `fga_avoider_init` does an avoider. An aircraft that is heard no more is
/// forgotten after `lifetime_s`, above 0, to 600 seconds; what rests is not.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`, `TOO_MANY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_reports_init(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    abi_version: u32,
    aircraft_most: u32,
    lifetime_s: f64,
    reports: *mut *mut fga_reports,
    why: *mut fga_refusal,
) -> fga_status {
    if abi_version != FGA_ABI_VERSION {
        return fga_status::WrongVersion;
    }
    let make = |why: LentSpan| {
        if aircraft_most > FGA_CAPACITY_MOST {
            let expected = "at most FGA_CAPACITY_MOST";
            return Err(Refused::too_many("aircraft_most", aircraft_most, expected));
        }
        let bytes = fga_reports_size(aircraft_most);
        let (object, storage) = Object::storage(storage.cast(), storage_size, bytes)?;
        apart(&[storage, LentSpan::of(reports.cast_const(), 1)?, why])?;
        if !(lifetime_s > 0.0 && lifetime_s <= 600.0) {
            let expected = "above 0, to 600";
            return Err(Refused::out_of_range("lifetime_s", lifetime_s, expected));
        }
        let traffic = FilteredTraffic {
            most: aircraft_most,
            count: 0,
            lifetime_s,
            counts: fga_report_counts::NONE,
        };
        let construct = |place: *mut FilteredTraffic| -> Result<(), Refused> {
            // SAFETY: there is room for a `FilteredTraffic`.
            unsafe { place.write(traffic) };
            Ok(())
        };
        // SAFETY: `storage` has accepted it, it overlaps nothing else, and the caller lends it.
        unsafe {
            Object::init(object, storage, construct)?;
            reports.write(object.cast());
        }
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { answered(why, make) }
}

/// Takes a report now, with the own aircraft at `own_m`; `now_s` is in seconds on the clock of the reports. It counts each report. A late
/// one changes nothing else.
///
/// The filter is the interacting multiple model filter of `fga-belief`: it weighs steady flight, wavering and turns by how well each
/// foretold the report, and so knows a velocity better than a noisy report says it, or without one in the report.
///
/// `FGA_STATUS_INCOMPLETE`: there is no room; of all aircraft the farthest one is left out.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_reports_hear(
    reports: *mut fga_reports,
    report: *const fga_report,
    now_s: f64,
    own_m: fga_enu,
    why: *mut fga_refusal,
) -> fga_status {
    let hear = |traffic: &mut AtWork<'_, FilteredTraffic>, why| {
        // SAFETY: the caller's word, in the header.
        let (of, from) = unsafe { given(report) }?;
        apart(&[traffic.span, from, why])?;
        usable_time("now_s", now_s)?;
        let own_m = own_m.usable(["own_m.east", "own_m.north", "own_m.up"])?;
        let counts = &mut traffic.value().counts;
        counts.heard = counts.heard.saturating_add(1);
        match of.report(now_s) {
            Ok(report) => Ok(traffic.take(&of, &report, now_s, own_m)),
            Err(refused) => {
                let unusable = &mut traffic.value().counts.unusable;
                *unusable = unusable.saturating_add(1);
                Err(refused)
            }
        }
    };
    // SAFETY: the caller's word, in the header.
    unsafe { memory::work(reports.cast(), why, hear) }
}

/// The obstacles of a moment, for a step: each aircraft carried on by the age of its last report, with the same volume around each, of
/// `half_height_m` 0 for a sphere. Forgets who is heard no more.
///
/// Refuses `NULL`, `MISALIGNED`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, and `TOO_MANY` where `obstacle_most` is below the
/// number of aircraft.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_reports_obstacles(
    reports: *mut fga_reports,
    now_s: f64,
    radius_m: f64,
    half_height_m: f64,
    obstacles: *mut fga_obstacle,
    obstacle_most: u32,
    obstacle_count: *mut u32,
    why: *mut fga_refusal,
) -> fga_status {
    let write = |traffic: &mut AtWork<'_, FilteredTraffic>, why| {
        let places = LentSpan::of(obstacles.cast_const(), obstacle_most as usize)?;
        let count = LentSpan::of(obstacle_count.cast_const(), 1)?;
        apart(&[traffic.span, places, count, why])?;
        usable_time("now_s", now_s)?;
        volume(radius_m, half_height_m)?;
        traffic.forget(now_s);
        let known = traffic.value().count;
        if known > obstacle_most {
            let expected = "at least the number of aircraft";
            return Err(Refused::too_many("obstacle_most", obstacle_most, expected));
        }
        for (index, heard) in traffic.heard().iter().enumerate() {
            let obstacle = heard.obstacle(now_s, radius_m, half_height_m);
            // SAFETY: below `obstacle_most`, whose places are writable by the caller's word.
            unsafe { obstacles.add(index).write(obstacle) };
        }
        // SAFETY: not null, aligned, and writable by the caller's word.
        unsafe { obstacle_count.write(known) };
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { memory::work(reports.cast(), why, write) }
}

/// What became of the reports since it was initialized.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_reports_counts(
    reports: *mut fga_reports,
    counts: *mut fga_report_counts,
) -> fga_status {
    let write = |traffic: &mut AtWork<'_, FilteredTraffic>, _| {
        let now = traffic.value().counts;
        // SAFETY: the caller's word, in the header.
        unsafe { now.write(counts, traffic.span) }
    };
    // SAFETY: the caller's word, in the header.
    unsafe { memory::work(reports.cast(), core::ptr::null_mut(), write) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_pointer_width = "64")]
    #[test]
    fn the_header_says_what_reports_take() {
        assert_eq!(
            FGA_REPORTS_AIRCRAFT_BYTES,
            size_of::<FilteredAircraft>().next_multiple_of(FGA_ALIGN),
            "write the second number there, then HEADER=write cargo test -p fga-c --test header"
        );
    }
}

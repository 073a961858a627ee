//! The avoider in storage that the caller lends.

use fga::Vec3;
use fga::assumptions::MAX_HAZARDS;
use fga::avoider::{
    Avoider, Decision, Known, LIMITS, Lent, MAX_TRACKED, Record, Settings, State, Tracks,
};
use fga::certificate::Hazard;
use fga::command::Command;
use fga::pilot::Pilot as _;
use fga::situation::{Mission, Obstacle, Obstacles, Ownship, Passing, Situation};
use fga::vehicle::Vehicle;

use crate::abi::{FGA_ABI_VERSION, FGA_ALIGN, FGA_CAPACITY_MOST};
use crate::airspace::{ZoneRoom, ground, zones};
use crate::beliefs::{Believing, fga_beliefs};
use crate::decision::fga_decision;
use crate::growable::{Growable, size_word};
use crate::input::{
    UNSAID, fga_mission, fga_obstacle, fga_settings, fga_situation, fga_vehicle, fga_waypoint,
};
use crate::memory;
use crate::memory::{AtWork, Kind, LentSpan, Object, answered, apart, fill, given, list, sized};
use crate::status::{Refused, fga_refusal, fga_status};

/// Bytes of an avoider without obstacles and waypoints; see `FGA_AVOIDER_BYTES`.
pub const FGA_AVOIDER_FIXED_BYTES: usize = 51_200;

/// Bytes of an avoider for each obstacle; see `FGA_AVOIDER_BYTES`.
pub const FGA_AVOIDER_OBSTACLE_BYTES: usize = 152;

/// Bytes of an avoider for each obstacle that a decision considers; see `FGA_AVOIDER_BYTES`.
pub const FGA_AVOIDER_TRACKED_BYTES: usize = 320;

/// Most obstacles that a decision considers: the most urgent ones.
pub const FGA_AVOIDER_TRACKED_MOST: usize = 126;

/// Bytes of an avoider for each waypoint; see `FGA_AVOIDER_BYTES`.
pub const FGA_AVOIDER_WAYPOINT_BYTES: usize = 32;

/// Hazards for which any avoider has room beside one for each obstacle: the turns of some four aircraft.
const TURNS: usize = 64;

/// Bytes of the places that any avoider has, for limits of altitude and turns.
const PLACES_BYTES: usize = LIMITS * size_of::<Known>() + TURNS * size_of::<Hazard>();

/// Where the places of obstacles begin, and before them the room for the zones of a step.
const OBSTACLES_AT: usize = FGA_AVOIDER_FIXED_BYTES - PLACES_BYTES;
const ZONES_AT: usize = OBSTACLES_AT - size_of::<ZoneRoom<'_>>();

const _: () = {
    assert!(Object::<Flying>::BYTES <= ZONES_AT && ZONES_AT.is_multiple_of(FGA_ALIGN));
    assert!(size_of::<Obstacle>() <= FGA_AVOIDER_OBSTACLE_BYTES);
    assert!(size_of::<Vec3>() + size_of::<Passing>() <= FGA_AVOIDER_WAYPOINT_BYTES);
    assert!(align_of::<Object<Flying>>() <= FGA_ALIGN && align_of::<Obstacle>() <= FGA_ALIGN);
    assert!(align_of::<Vec3>() <= FGA_ALIGN && align_of::<Passing>() == 1);
    assert!(FGA_AVOIDER_FIXED_BYTES.is_multiple_of(FGA_ALIGN));
    assert!(FGA_AVOIDER_OBSTACLE_BYTES.is_multiple_of(align_of::<Known>()));
    assert!(size_of::<Known>() + size_of::<Hazard>() <= FGA_AVOIDER_TRACKED_BYTES);
    assert!(align_of::<Known>() <= FGA_ALIGN && align_of::<Hazard>() == align_of::<Known>());
    assert!(FGA_AVOIDER_TRACKED_MOST == MAX_TRACKED);
};

/// Collision avoidance for one aircraft, in storage of the caller. It holds no address of anything outside of that.
pub struct fga_avoider {
    _opaque: [u8; 0],
}

/// What an avoider has done and refused since it was initialized. The counts stay at their largest value.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct fga_counts {
    /// `sizeof(fga_counts)`.
    pub size: u32,
    /// Steps with a decision.
    pub steps: u32,
    /// Calls on this avoider that refused what they were given.
    pub refused_calls: u32,
    /// Steps without some of their obstacles.
    pub incomplete_steps: u32,
    /// Obstacles without effect, because a number of theirs was unusable, all steps together.
    pub obstacles_ignored: u32,
    /// Obstacles without effect, because there was no room for them, all steps together.
    pub obstacles_left_out: u32,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_counts {}

/// The avoider in places that the caller lends.
type Flown = Avoider<Lent<'static>>;

/// The avoider and what it keeps for the caller.
struct Flying {
    avoider: Flown,
    decided: Decision,
    counts: fga_counts,
    /// Room for obstacles and waypoints, which lie behind the object: first all places of obstacles, then what the avoider knows of
    /// them and their hazards, then the waypoints, then how these are passed.
    obstacles_most: u32,
    waypoints_most: u32,
    /// Waypoints of the mission.
    waypoints: u32,
    limits_m: (f64, f64),
}

impl Kind for Flying {
    const MARK: usize = 0x6667_6161;
}

/// Bytes of an avoider with room for some obstacles and waypoints.
const fn bytes(obstacles_most: u32, waypoints_most: u32) -> usize {
    FGA_AVOIDER_FIXED_BYTES
        + obstacles_most as usize * FGA_AVOIDER_OBSTACLE_BYTES
        + tracked_most(obstacles_most) * FGA_AVOIDER_TRACKED_BYTES
        + waypoints_most as usize * FGA_AVOIDER_WAYPOINT_BYTES
}

/// Obstacles of an avoider that a decision considers.
const fn tracked_most(obstacles_most: u32) -> usize {
    if obstacles_most as usize > FGA_AVOIDER_TRACKED_MOST {
        FGA_AVOIDER_TRACKED_MOST
    } else {
        obstacles_most as usize
    }
}

/// The places for what an avoider knows of obstacles, and for hazards, in its storage.
///
/// # Safety
/// The storage of `object` has [`bytes`] for `obstacles_most` obstacles. Nobody else uses the bytes behind `object`.
unsafe fn places(object: *mut Object<Flying>, obstacles_most: u32) -> Lent<'static> {
    let tracked = tracked_most(obstacles_most);
    let (known_most, rows_most) = (tracked + LIMITS, (tracked + TURNS).min(MAX_HAZARDS));
    let after = OBSTACLES_AT + obstacles_most as usize * FGA_AVOIDER_OBSTACLE_BYTES;
    let known: *mut Known = object.wrapping_byte_add(after).cast();
    let rows: *mut Hazard = known.wrapping_add(known_most).cast();
    // SAFETY: they lie in the storage, aligned; all are written before there is a reference to them.
    unsafe {
        for place in 0..known_most {
            known.add(place).write(Known::NONE);
        }
        for place in 0..rows_most {
            rows.add(place).write(Hazard::NONE);
        }
        (
            core::slice::from_raw_parts_mut(known, known_most),
            core::slice::from_raw_parts_mut(rows, rows_most),
        )
    }
}

impl AtWork<'_, Flying> {
    const fn obstacle_places(&self) -> *mut Obstacle {
        self.list(OBSTACLES_AT)
    }

    fn waypoint_places(&mut self) -> (*mut Vec3, *mut Passing) {
        let (obstacles, waypoints) = (self.value().obstacles_most, self.value().waypoints_most);
        let places: *mut Vec3 = self.list(bytes(obstacles, 0));
        (places, places.wrapping_add(waypoints as usize).cast())
    }

    /// Copies the waypoints of a mission, after all of them are checked.
    fn take_mission(
        &mut self,
        mission: &fga_mission,
        waypoints: &[fga_waypoint],
    ) -> Result<(), Refused> {
        let most = self.value().waypoints_most;
        if mission.waypoint_count > most {
            let expected = "at most the waypoints_most of the avoider";
            return Err(Refused::too_many(
                "waypoint_count",
                mission.waypoint_count,
                expected,
            ));
        }
        let limits_m = mission.limits_m()?;
        for (index, waypoint) in waypoints.iter().enumerate() {
            waypoint.waypoint().map_err(|refused| refused.at(index))?;
        }
        let (places, passing) = self.waypoint_places();
        let before = self.value().waypoints;
        // The first waypoints that both missions have.
        let mut kept = 0;
        for (index, waypoint) in waypoints.iter().enumerate() {
            let (place_m, passes) = waypoint.waypoint()?;
            // SAFETY: the first `before` places are those of the mission before; there is room for `waypoints_most` of both behind the
            // obstacles, and there are no more waypoints.
            unsafe {
                let is_before = index < before as usize
                    && (*places.add(index), *passing.add(index)) == (place_m, passes);
                kept += usize::from(is_before && kept == index);
                places.add(index).write(place_m);
                passing.add(index).write(passes);
            }
        }
        let flying = self.value();
        (flying.waypoints, flying.limits_m) = (mission.waypoint_count, limits_m);
        if (before, kept) != (mission.waypoint_count, waypoints.len()) {
            flying.avoider.replace_mission(kept);
        }
        Ok(())
    }

    /// Copies the usable obstacles into their places. Where there are more obstacles than places, those stay that the aircraft could
    /// meet first. Returns how many obstacles have a place, how many are unusable, and how many have no place; and why the first one is
    /// unusable.
    fn take_obstacles(
        &mut self,
        obstacles: &[fga_obstacle],
        own: &Ownship,
    ) -> ([u32; 3], Option<Refused>) {
        let (places, most) = (self.obstacle_places(), self.value().obstacles_most);
        let [mut placed, mut ignored, mut left_out] = [0_u32; 3];
        let mut why = None;
        for (index, obstacle) in obstacles.iter().enumerate() {
            let obstacle = match obstacle.obstacle() {
                Ok(obstacle) => obstacle,
                Err(refused) => {
                    ignored += 1;
                    why = why.or(Some(refused.at(index)));
                    continue;
                }
            };
            let mut place = placed;
            if placed < most {
                placed += 1;
            } else {
                left_out += 1;
                // SAFETY: the first `placed` places were written in this call.
                let kept =
                    unsafe { core::slice::from_raw_parts(places.cast_const(), placed as usize) };
                let last = (0..)
                    .zip(kept)
                    .map(|(index, known)| (soonest_s(known, own), index));
                let last = last.max_by(|a, b| a.0.total_cmp(&b.0));
                match last {
                    Some((last_s, index)) if soonest_s(&obstacle, own) < last_s => place = index,
                    _ => continue,
                }
            }
            // SAFETY: below `most`, so there is such a place.
            unsafe { places.add(place as usize).write(obstacle) };
        }
        ([placed, ignored, left_out], why)
    }
}

/// A time before which an obstacle cannot be met, seconds, whatever both fly.
fn soonest_s(obstacle: &Obstacle, own: &Ownship) -> f64 {
    let gap_m = obstacle
        .volume
        .margin_m(own.position_m - obstacle.position_m);
    gap_m / (own.airspeed_mps + obstacle.velocity_mps.length())
}

/// Bytes of storage for an avoider with room for these numbers of obstacles a step and waypoints; 0 where one is above
/// `FGA_CAPACITY_MOST`. For static storage the macro `FGA_AVOIDER_BYTES` gives the same.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_avoider_size(obstacles_most: u32, waypoints_most: u32) -> usize {
    if obstacles_most > FGA_CAPACITY_MOST || waypoints_most > FGA_CAPACITY_MOST {
        return 0;
    }
    bytes(obstacles_most, waypoints_most)
}

/// Alignment of the storage of an avoider, bytes: `FGA_ALIGN`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_avoider_align() -> usize {
    FGA_ALIGN
}

/// Fills settings, but for their size, with the defaults.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_settings_default(settings: *mut fga_settings) -> fga_status {
    // SAFETY: the caller's word, in the header.
    let done = unsafe { sized(settings) };
    if let Err(status) = done {
        return status;
    }
    // SAFETY: checked above.
    unsafe { fill(settings, |settings| settings.set(&Settings::default())) };
    fga_status::Ok
}

/// Fills the limits of a vehicle, but for their size: it turns as tightly as its largest bank angle allows, without delay, and
/// stays at its altitude. Adapt them to what the aircraft flies.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `OUT_OF_RANGE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_vehicle_from_bank(
    airspeed_mps: f64,
    bank_max_rad: f64,
    vehicle: *mut fga_vehicle,
    why: *mut fga_refusal,
) -> fga_status {
    let make = |why: LentSpan| {
        // SAFETY: the caller's word, in the header.
        apart(&[unsafe { sized(vehicle) }?, why])?;
        let limits = Vehicle::from_bank(airspeed_mps, bank_max_rad)?;
        limits.check()?;
        // SAFETY: checked above.
        unsafe { fill(vehicle, |vehicle| vehicle.set(&limits)) };
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { answered(why, make) }
}

/// Constructs an avoider in storage of the caller, in cruise, without a mission.
///
/// The storage stays the caller's: it must live as long as the avoider is used, and it is given up by using it no more. It must
/// not be moved or copied. `abi_version` is `FGA_ABI_VERSION`. An avoider that lay in this storage is gone, whatever the answer.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`,
/// `UNKNOWN_VALUE`, `TOO_MANY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_init(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    abi_version: u32,
    obstacles_most: u32,
    waypoints_most: u32,
    settings: *const fga_settings,
    vehicle: *const fga_vehicle,
    avoider: *mut *mut fga_avoider,
    why: *mut fga_refusal,
) -> fga_status {
    if abi_version != FGA_ABI_VERSION {
        return fga_status::WrongVersion;
    }
    let make = |why: LentSpan| {
        for (field, most) in [
            ("obstacles_most", obstacles_most),
            ("waypoints_most", waypoints_most),
        ] {
            if most > FGA_CAPACITY_MOST {
                return Err(Refused::too_many(field, most, "at most FGA_CAPACITY_MOST"));
            }
        }
        let bytes = bytes(obstacles_most, waypoints_most);
        let (object, storage) = Object::storage(storage.cast(), storage_size, bytes)?;
        // SAFETY: the caller's word, in the header.
        let ((settings, from), (vehicle, of)) = unsafe { (given(settings)?, given(vehicle)?) };
        let answer = LentSpan::of(avoider.cast_const(), 1)?;
        apart(&[storage, from, of, answer, why])?;
        let (settings, vehicle) = (settings.settings()?, vehicle.vehicle()?);
        let construct = |flying: *mut Flying| -> Result<(), Refused> {
            // SAFETY: a `Flying` has room there; all of its fields and all fields of `decided` are written.
            unsafe {
                let tracks = Tracks::within(places(object, obstacles_most));
                (&raw mut (*flying).avoider).write(Avoider::within(settings, vehicle, tracks));
                (*flying).avoider.prepare()?;
                (&raw mut (*flying).decided.command).write(Command::hold());
                (&raw mut (*flying).decided.state).write(State::Cruise);
                (&raw mut (*flying).decided.record).write(Record::default());
                (&raw mut (*flying).counts).write_bytes(0, 1);
                (&raw mut (*flying).obstacles_most).write(obstacles_most);
                (&raw mut (*flying).waypoints_most).write(waypoints_most);
                (&raw mut (*flying).waypoints).write(0);
                (&raw mut (*flying).limits_m).write((f64::NEG_INFINITY, f64::INFINITY));
            }
            Ok(())
        };
        // SAFETY: `storage` has accepted it, it overlaps nothing else, and the caller lends it.
        unsafe {
            Object::init(object, storage, construct)?;
            avoider.write(object.cast());
        }
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { answered(why, make) }
}

/// Works on an avoider, and counts a refusal.
///
/// # Safety
/// As [`memory::work`].
unsafe fn work(
    avoider: *mut fga_avoider,
    why: *mut fga_refusal,
    work: impl FnOnce(&mut AtWork<'_, Flying>, LentSpan) -> Result<fga_status, Refused>,
) -> fga_status {
    let counted = |object: &mut AtWork<'_, Flying>, why| {
        let done = work(object, why);
        let is_refused = |why: &Refused| why.status != fga_status::Incomplete;
        if done.as_ref().is_err_and(is_refused) {
            let counts = &mut object.value().counts;
            counts.refused_calls = counts.refused_calls.saturating_add(1);
        }
        done
    };
    // SAFETY: as this function.
    unsafe { memory::work(avoider.cast(), why, counted) }
}

/// Sets the mission, whose waypoints are copied. It may be replaced at any time, also while a manoeuvre is flown, which then leads back
/// to the new mission.
///
/// The new mission begins at its first leg, by a turn round where that ends behind the aircraft, or at the first leg that the aircraft can
/// join. Where both missions have the same waypoints up to the end of the present leg, or of a mission that is complete, the flight
/// goes on from there. The same waypoints again change nothing.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`, `TOO_MANY`;
/// then the mission stays as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_set_mission(
    avoider: *mut fga_avoider,
    mission: *const fga_mission,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work(avoider, why, |at_work, why| {
            let (mission, span) = given(mission)?;
            let (waypoints, of) = list(mission.waypoints, mission.waypoint_count)?;
            apart(&[at_work.span, span, of, why])?;
            at_work.take_mission(&mission, waypoints)?;
            Ok(fga_status::Ok)
        })
    }
}

/// Replaces the limits of the vehicle, for instance by a turn-rate factor estimated in flight.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`; then the limits stay as they
/// were.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_set_vehicle(
    avoider: *mut fga_avoider,
    vehicle: *const fga_vehicle,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work(avoider, why, |at_work, why| {
            let (vehicle, span) = given(vehicle)?;
            apart(&[at_work.span, span, why])?;
            at_work.value().avoider.set_vehicle(vehicle.vehicle()?)?;
            Ok(fga_status::Ok)
        })
    }
}

/// Sets limits for cases without a certified manoeuvre under the normal ones, for instance a steeper bank; null for none.
///
/// Refuses `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`; then the limits stay as they were.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_set_vehicle_in_need(
    avoider: *mut fga_avoider,
    vehicle: *const fga_vehicle,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work(avoider, why, |at_work, why| {
            let mut limits = None;
            if !vehicle.is_null() {
                let (vehicle, span) = given(vehicle)?;
                apart(&[at_work.span, span, why])?;
                limits = Some(vehicle.vehicle()?);
            }
            at_work.value().avoider.set_vehicle_in_need(limits)?;
            Ok(fga_status::Ok)
        })
    }
}

/// Forgets the flight: the next step is the first of another one. Settings, mission and counts stay; the limits of the vehicle
/// are those of the construction again, without limits in need.
///
/// Refuses `NULL`, `MISALIGNED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_restart(avoider: *mut fga_avoider) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work(avoider, core::ptr::null_mut(), |at_work, _| {
            at_work.value().avoider.restart();
            Ok(fga_status::Ok)
        })
    }
}

/// Decides what to fly until the next step. Call it once each decision period, with the state of that moment.
///
/// `FGA_STATUS_INCOMPLETE`: the decision is made without some obstacles, which it counts. Obstacles with an unusable number, or at rest
/// with a velocity known exactly, have no effect, and `why` names the first of them; of more obstacles than there is room for, those
/// count that the aircraft could meet first.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE` (of time, ownship, wind, zones and
/// ground), `UNKNOWN_VALUE`, `TOO_MANY` (more than `FGA_CAPACITY_MOST` obstacles or `FGA_ZONES_MOST` zones); then the avoider has not decided, and `decision` stays as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_step(
    avoider: *mut fga_avoider,
    situation: *const fga_situation,
    decision: *mut fga_decision,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        step(
            avoider,
            LentSpan::NONE,
            (situation, decision),
            why,
            |avoider, now, decided| {
                avoider.step_into(now, decided);
                false
            },
        )
    }
}

/// Decides like `fga_avoider_step`, among aircraft by expected cost: what the reports that `beliefs` has heard say that they may do, and what
/// that costs. Obstacles of the situation that are aircraft count as reports of this moment too. The same beliefs go with the same avoider, which
/// needs room for the believed aircraft beside other obstacles. Chances and `proven_share` are those of the last choice, up to 0.95 s ago. A choice
/// weighs the six aircraft that may come nearest; `work_limit` does not bound it.
///
/// `FGA_STATUS_INCOMPLETE` also where believed aircraft are left out for want of room; `work_limit_met` then too, and where more than six are around.
///
/// Refuses what `fga_avoider_step` refuses, of either object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_step_on_beliefs(
    avoider: *mut fga_avoider,
    beliefs: *mut fga_beliefs,
    situation: *const fga_situation,
    decision: *mut fga_decision,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    let mut believing = match unsafe { Object::<Believing>::enter(beliefs.cast()) } {
        Ok(believing) => believing,
        Err(status) => return status,
    };
    let span = believing.span;
    // SAFETY: the same.
    unsafe {
        step(
            avoider,
            span,
            (situation, decision),
            why,
            |avoider, now, decided| {
                let decider = &mut believing.value().decider;
                !decider.step_into(avoider, now, decided)
            },
        )
    }
}

/// Decides by a function, which returns whether it left something out, with the memory of what that uses.
///
/// # Safety
/// The caller's word, in the header.
unsafe fn step(
    avoider: *mut fga_avoider,
    beliefs: LentSpan,
    (situation, decision): (*const fga_situation, *mut fga_decision),
    why: *mut fga_refusal,
    decide: impl FnOnce(&mut Flown, &Situation<'_>, &mut Decision) -> bool,
) -> fga_status {
    // SAFETY: as this function.
    unsafe {
        work(avoider, why, |at_work, why| {
            let ((situation, span), answer) = (given(situation)?, sized(decision)?);
            let count = situation.obstacle_count;
            if count > FGA_CAPACITY_MOST {
                let expected = "at most FGA_CAPACITY_MOST";
                return Err(Refused::too_many("obstacle_count", count, expected));
            }
            let (obstacles, of) = list(situation.obstacles, count)?;
            apart(&[at_work.span, beliefs, span, of, answer, why])?;
            fga_obstacle::sized(obstacles)?;
            let written = [at_work.span, beliefs, answer, why];
            let room: &mut ZoneRoom<'_> = &mut *at_work.list(ZONES_AT);
            let zones = zones((situation.zones, situation.zone_count), &written, room)?;
            let ground = ground(situation.ground, &written)?;
            let mut now = UNSAID;
            situation.moment(&mut now)?;
            let (taken, unusable) = at_work.take_obstacles(obstacles, &now.ownship);
            let [placed, ignored, left_out] = taken;
            let places = at_work.obstacle_places().cast_const();
            let (waypoints_m, passing) = at_work.waypoint_places();
            let flying = at_work.value();
            let count = flying.waypoints as usize;
            // The first `placed` are written just now.
            now.obstacles = Obstacles::Rows(core::slice::from_raw_parts(places, placed as usize));
            now.mission = Mission {
                // The first `count` of both are written by `take_mission`.
                waypoints_m: core::slice::from_raw_parts(waypoints_m, count),
                passing: core::slice::from_raw_parts(passing, count),
                limits_m: flying.limits_m,
                zones,
                ground: ground.as_ref(),
            };
            let leaves_out = decide(&mut flying.avoider, &now, &mut flying.decided);
            let is_incomplete = leaves_out || ignored > 0 || left_out > 0;
            let counts = &mut flying.counts;
            counts.steps = counts.steps.saturating_add(1);
            counts.incomplete_steps = counts.incomplete_steps.saturating_add(is_incomplete.into());
            counts.obstacles_ignored = counts.obstacles_ignored.saturating_add(ignored);
            counts.obstacles_left_out = counts.obstacles_left_out.saturating_add(left_out);
            let leg = u32::try_from(flying.avoider.leg_index()).unwrap_or(u32::MAX);
            fill(decision, |out| {
                out.set(&flying.decided);
                out.obstacles_ignored = ignored;
                out.obstacles_left_out = left_out;
                out.leg_index = leg;
            });
            let status = if is_incomplete {
                fga_status::Incomplete
            } else {
                fga_status::Ok
            };
            // As of a refusal, `why` is written.
            unusable.map_or(Ok(status), |unusable| Err(unusable.with(status)))
        })
    }
}

/// What the avoider has done and refused since it was initialized.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_avoider_counts(
    avoider: *mut fga_avoider,
    counts: *mut fga_counts,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work(avoider, core::ptr::null_mut(), |at_work, _| {
            apart(&[at_work.span, sized(counts)?])?;
            let size = size_word::<fga_counts>();
            counts.write(fga_counts {
                size,
                ..at_work.value().counts
            });
            Ok(fga_status::Ok)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An avoider takes the bytes that the header says, to the next 512.
    #[cfg(target_pointer_width = "64")]
    #[test]
    fn the_header_says_what_an_avoider_takes() {
        assert_eq!(
            FGA_AVOIDER_FIXED_BYTES,
            (Object::<Flying>::BYTES + size_of::<ZoneRoom<'_>>() + PLACES_BYTES)
                .next_multiple_of(512),
            "write the second number there, then HEADER=write cargo test -p fga-c --test header"
        );
        assert_eq!(FGA_AVOIDER_OBSTACLE_BYTES, size_of::<Obstacle>());
    }
}

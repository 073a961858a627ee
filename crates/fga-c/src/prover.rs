//! The certificate alone: somebody else's manoeuvre, our proof. And where a manoeuvre leads to.

use fga::Vec3;
use fga::assumptions::{Assumptions, MAX_HAZARDS};
use fga::certificate::{Hazard, Status, Zones, certify_set};
use fga::command::{Command, Terms};
use fga::limit::SettingsError;
use fga::list::List;
use fga::maneuver::MAX_STAGES;
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState, flown};
use fga::situation::{Mission, Movement};
use fga::zone::Zone;

use crate::abi::{FGA_ABI_VERSION, FGA_ALIGN};
use crate::airspace::{ZoneRoom, ground, zones};
use crate::growable::Growable;
use crate::input::{
    UNSAID, WIND, fga_enu, fga_obstacle, fga_ownship, fga_situation, fga_stage, fga_vehicle,
    take_stages,
};
use crate::memory::{Kind, LentSpan, Object, answered, apart, fill, given, list, sized, work};
use crate::status::{Refused, fga_refusal, fga_status};

/// Bytes of storage for a prover.
pub const FGA_PROVER_BYTES: usize = 39_936;

/// Most obstacles of a proof.
pub const FGA_PROVER_OBSTACLES_MOST: usize = 128;

/// Where the room for the zones of a proof begins.
const ZONES_AT: usize = FGA_PROVER_BYTES - size_of::<ZoneRoom<'_>>();

const _: () = {
    assert!(Object::<Proving>::BYTES <= ZONES_AT && ZONES_AT.is_multiple_of(FGA_ALIGN));
    assert!(align_of::<Object<Proving>>() <= FGA_ALIGN);
    assert!(FGA_PROVER_OBSTACLES_MOST <= MAX_HAZARDS);
};

/// Proves manoeuvres of one vehicle, in storage of the caller. It holds no address of anything else.
pub struct fga_prover {
    _opaque: [u8; 0],
}

/// What a proof came to.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_verdict {
    /// Nothing is proven: the work ended before the whole flight was examined.
    LimitMet = 0,
    /// The manoeuvre comes closer to an obstacle than was asked for, or the proof cannot exclude it.
    BelowTarget = 1,
    /// The manoeuvre keeps the separation asked for from every obstacle, up to the horizon, in continuous time.
    Proven = 2,
}

/// What is asked of a manoeuvre.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_question {
    /// `sizeof(fga_question)`.
    pub size: u32,
    /// Most work of the proof, in tests of a line against four obstacles.
    pub work_limit: u32,
    /// How far ahead, seconds: above 0, to 600.
    pub horizon_s: f64,
    /// Separation to be proven beyond every volume, metres, 0 to 10,000.
    pub target_m: f64,
    /// Standard deviations of an obstacle's uncertainty by which its volume grows: 0 to 10.
    pub confidence_sigmas: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers.
unsafe impl Growable for fga_question {}

impl fga_question {
    fn check(&self) -> Result<(), Refused> {
        let rows = [
            (
                "horizon_s",
                self.horizon_s,
                f64::MIN_POSITIVE,
                600.0,
                "above 0, to 600",
            ),
            ("target_m", self.target_m, 0.0, 1e4, "0 to 10,000"),
            (
                "confidence_sigmas",
                self.confidence_sigmas,
                0.0,
                10.0,
                "0 to 10",
            ),
        ];
        for (field, value, low, high, expected) in rows {
            SettingsError::unless((low..=high).contains(&value), field, value, expected)?;
        }
        Ok(())
    }
}

/// What is proven about a manoeuvre.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_certificate {
    /// `sizeof(fga_certificate)`.
    pub size: u32,
    /// What the proof came to.
    pub verdict: fga_verdict,
    /// Lower bound of the separation beyond every volume, metres, as far as it was examined: negative inside a volume, and no more
    /// than `target_m` where that is proven.
    pub margin_m: f64,
    /// Where the target is not proven: time of the least separation, seconds from the decision.
    pub at_s: f64,
    /// Where the target is not proven: identifier of the obstacle that comes closest. Else 0, as where that is a zone or the ground.
    pub obstacle_id: u32,
    /// Number of obstacles that the proof covers.
    pub obstacle_count: u32,
    /// Of these, the aircraft: the proof takes them to keep their velocity, and does not cover their turns and climbs.
    pub straight_aircraft: u32,
    /// Work done, in the unit of `work_limit`.
    pub work: u32,
}

// SAFETY: `repr(C)`, the size first, then numbers and an enumeration with a value 0.
unsafe impl Growable for fga_certificate {}

/// The vehicle, and the scratch space of a proof.
struct Proving {
    flyer: Flyer,
    command: Command,
    path: FlightPath,
    hazards: List<Hazard, MAX_HAZARDS>,
    zones: Zones,
}

impl Kind for Proving {
    const MARK: usize = 0x6667_6170;
}

/// What came of a proof.
struct FoundMargin {
    verdict: fga_verdict,
    margin_m: f64,
    at_s: f64,
    obstacle_id: u32,
    straight_aircraft: u32,
    work: u32,
}

impl Proving {
    /// Takes the obstacles as hazards; returns the number of aircraft among them.
    fn take_obstacles(
        &mut self,
        obstacles: &[fga_obstacle],
        wind_mps: Vec3,
        sigmas: f64,
    ) -> Result<u32, Refused> {
        self.hazards.clear();
        let mut aircraft = 0;
        for (place, given) in obstacles.iter().enumerate() {
            let obstacle = given.obstacle().map_err(|refused| refused.at(place))?;
            aircraft += u32::from(matches!(obstacle.movement, Movement::Aircraft(_)));
            let hazard = Hazard::new(&obstacle, wind_mps, sigmas);
            self.hazards.put(place, hazard);
        }
        Ok(aircraft)
    }

    /// Takes the zones within reach as hazards.
    fn take_zones(&mut self, zones: &[Zone<'_>], moment: (Vec3, Vec3), question: &fga_question) {
        let (place_m, wind_mps) = moment;
        let speed_mps = self.flyer.airspeed_mps() + wind_mps.length();
        let reach_m = question.target_m + speed_mps * question.horizon_s;
        let near = &mut self.zones;
        near.clear(wind_mps, question.horizon_s);
        for index in 0..zones.len() {
            near.add(zones, index, (place_m, reach_m));
        }
    }

    fn prove(
        &mut self,
        situation: &fga_situation,
        stages: &[fga_stage],
        (obstacles, mission): (&[fga_obstacle], &Mission<'_>),
        question: &fga_question,
    ) -> Result<FoundMargin, Refused> {
        let mut now = UNSAID;
        situation.moment(&mut now)?;
        let (ownship, wind_mps) = (now.ownship, now.wind_mps);
        take_stages(self.command.edit(), stages)?;
        let straight_aircraft =
            self.take_obstacles(obstacles, wind_mps, question.confidence_sigmas)?;
        self.take_zones(mission.zones, (ownship.position_m, wind_mps), question);
        let meter = within(question.work_limit);
        let (horizon_s, target_m) = (question.horizon_s, question.target_m);
        let now = MotionState::of(&ownship);
        let around = Assumptions::new(&self.hazards, &self.zones, mission);
        let terms = Terms::new(horizon_s, target_m, target_m);
        let flight = (&self.flyer, &mut self.path);
        let proof = terms.map(|terms| self.command.prove(flight, &now, &around, &terms, &meter));
        if let Some(Ok(proof)) = proof {
            return Ok(FoundMargin {
                verdict: fga_verdict::Proven,
                margin_m: proof.bound().margin_m,
                at_s: 0.0,
                obstacle_id: 0,
                straight_aircraft,
                work: meter.done(),
            });
        }
        let asked = (horizon_s, f64::MIN, target_m);
        let closest = certify_set(&self.flyer, &self.path, &around, asked, &meter);
        let is_examined = closest.status != Status::LimitMet && !meter.is_spent();
        Ok(FoundMargin {
            verdict: if is_examined {
                fga_verdict::BelowTarget
            } else {
                fga_verdict::LimitMet
            },
            margin_m: closest.margin_m,
            at_s: closest.at_s,
            obstacle_id: closest.id.unwrap_or(0),
            straight_aircraft,
            work: meter.done(),
        })
    }
}

/// Bytes of storage for a prover: `FGA_PROVER_BYTES`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_prover_size() -> usize {
    FGA_PROVER_BYTES
}

/// Alignment of the storage of a prover, bytes: `FGA_ALIGN`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_prover_align() -> usize {
    FGA_ALIGN
}

/// Constructs a prover of manoeuvres of a vehicle in storage of the caller, as `fga_avoider_init` does an avoider. To change the
/// vehicle, construct it again.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_prover_init(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    abi_version: u32,
    vehicle: *const fga_vehicle,
    prover: *mut *mut fga_prover,
    why: *mut fga_refusal,
) -> fga_status {
    if abi_version != FGA_ABI_VERSION {
        return fga_status::WrongVersion;
    }
    let make = |why: LentSpan| {
        let (object, storage) = Object::storage(storage.cast(), storage_size, FGA_PROVER_BYTES)?;
        // SAFETY: the caller's word, in the header.
        let (vehicle, of) = unsafe { given(vehicle) }?;
        apart(&[storage, of, LentSpan::of(prover.cast_const(), 1)?, why])?;
        let vehicle = vehicle.vehicle()?;
        let construct = |proving: *mut Proving| -> Result<(), Refused> {
            // SAFETY: there is room for a `Proving`; all of its fields are written.
            unsafe {
                (&raw mut (*proving).flyer).write(Flyer::NONE);
                (*proving).flyer.set(&vehicle);
                (&raw mut (*proving).command).write(Command::hold());
                (&raw mut (*proving).path).write(const { FlightPath::new() });
                (&raw mut (*proving).hazards).write(const { List::new(Hazard::NONE) });
                (&raw mut (*proving).zones).write(Zones::NONE);
            }
            Ok(())
        };
        // SAFETY: `storage` has accepted it, it overlaps nothing else, and the caller lends it.
        unsafe {
            Object::init(object, storage, construct)?;
            prover.write(object.cast());
        }
        Ok(fga_status::Ok)
    };
    // SAFETY: the caller's word, in the header.
    unsafe { answered(why, make) }
}

/// The stages of a manoeuvre of the caller.
///
/// # Safety
/// As [`list`].
unsafe fn stages<'a>(
    stages: *const fga_stage,
    stage_count: u32,
) -> Result<(&'a [fga_stage], LentSpan), Refused> {
    if stage_count as usize > MAX_STAGES {
        let expected = "at most FGA_STAGES_MOST, and 40";
        return Err(Refused::too_many("stage_count", stage_count, expected));
    }
    // SAFETY: as this function.
    Ok(unsafe { list(stages, stage_count) }?)
}

/// Proves that a manoeuvre, of whatever origin, keeps a separation from every obstacle of a situation, in continuous time: the
/// aircraft flies the stages, with the response of the prover's vehicle, and each obstacle keeps its velocity or its place.
///
/// It keeps the same separation from every zone, on the side that is allowed, and above the ground with its error and clearance. Where
/// the aircraft begins on the wrong side of a zone, or more edges are within its reach than there is room for, nothing is proven.
///
/// The proof covers neither turns of aircraft, which `straight_aircraft` counts, nor limits of altitude. With no stages the
/// manoeuvre holds course and climb angle.
///
/// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`, `TOO_MANY`: no
/// obstacle and no zone is left out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_certify(
    prover: *mut fga_prover,
    situation: *const fga_situation,
    stages: *const fga_stage,
    stage_count: u32,
    question: *const fga_question,
    certificate: *mut fga_certificate,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work::<Proving>(prover.cast(), why, |at_work, why| {
            let ((situation, span), (question, asked)) = (given(situation)?, given(question)?);
            let answer = sized(certificate)?;
            let (stages, of_stages) = self::stages(stages, stage_count)?;
            let count = situation.obstacle_count;
            if count as usize > FGA_PROVER_OBSTACLES_MOST {
                let expected = "at most FGA_PROVER_OBSTACLES_MOST";
                return Err(Refused::too_many("obstacle_count", count, expected));
            }
            let (obstacles, of) = list(situation.obstacles, count)?;
            apart(&[at_work.span, span, asked, answer, of_stages, of, why])?;
            fga_obstacle::sized(obstacles)?;
            question.check()?;
            let written = [at_work.span, answer, why];
            let ground = ground(situation.ground, &written)?;
            let room: &mut ZoneRoom<'_> = &mut *at_work.list(ZONES_AT);
            let zones = zones((situation.zones, situation.zone_count), &written, room)?;
            let mission = Mission {
                zones,
                ground: ground.as_ref(),
                ..Mission::NONE
            };
            let around = (obstacles, &mission);
            let found = at_work
                .value()
                .prove(&situation, stages, around, &question)?;
            fill(certificate, |out| {
                out.verdict = found.verdict;
                out.margin_m = found.margin_m;
                out.at_s = found.at_s;
                out.obstacle_id = found.obstacle_id;
                out.obstacle_count = count;
                out.straight_aircraft = found.straight_aircraft;
                out.work = found.work;
            });
            Ok(fga_status::Ok)
        })
    }
}

/// Where the aircraft is after some time on a manoeuvre, over the ground, with the response of the prover's vehicle. A vehicle
/// with a dead time needs it: a step is asked about the moment at which its command begins to have an effect.
///
/// The command of an earlier decision is flown on with its age taken from each `start_s`: of the stages that have begun, at 0 or below,
/// the last one counts.
///
/// `then` may not be `ownship`. Refuses `NULL`, `MISALIGNED`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE` (`after_s`: 0
/// to 600), `TOO_MANY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_predict(
    prover: *mut fga_prover,
    ownship: *const fga_ownship,
    stages: *const fga_stage,
    stage_count: u32,
    wind_mps: fga_enu,
    after_s: f64,
    then: *mut fga_ownship,
    why: *mut fga_refusal,
) -> fga_status {
    // SAFETY: the caller's word, in the header.
    unsafe {
        work::<Proving>(prover.cast(), why, |at_work, why| {
            let (from, to) = (
                LentSpan::of(ownship, 1)?,
                LentSpan::of(then.cast_const(), 1)?,
            );
            let (stages, of) = self::stages(stages, stage_count)?;
            apart(&[at_work.span, from, to, of, why])?;
            let wind_mps = wind_mps.usable(WIND)?;
            let is_within = (0.0..=600.0).contains(&after_s);
            SettingsError::unless(is_within, "after_s", after_s, "0 to 600")?;
            let own = (*ownship).ownship()?;
            let proving = at_work.value();
            take_stages(proving.command.edit(), stages)?;
            let state = flown(
                &proving.flyer,
                &MotionState::of(&own),
                proving.command.stages(),
                after_s,
                &within(u32::MAX),
            );
            then.write(fga_ownship {
                position_m: fga_enu::of(state.position_m + wind_mps * after_s),
                course_from_east_rad: state.course_rad,
                climb_rad: state.climb_rad,
                bank_left_rad: state.bank_rad,
                airspeed_mps: own.airspeed_mps,
            });
            Ok(fga_status::Ok)
        })
    }
}

/// Work of one call, no more than this.
const fn within(limit: u32) -> Meter {
    Meter::new(limit, limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A prover takes the bytes that the header says, to the next 512.
    #[cfg(target_pointer_width = "64")]
    #[test]
    fn the_header_says_what_a_prover_takes() {
        assert_eq!(
            FGA_PROVER_BYTES,
            (Object::<Proving>::BYTES + size_of::<ZoneRoom<'_>>()).next_multiple_of(512),
            "write the second number there, then HEADER=write cargo test -p fga-c --test header"
        );
    }
}

//! One cycle of a flight: its arcs, samples and recorded pieces.

use fga::Vec3;
use fga::angle::{climb_of, course_of, wrap_pi};
use fga::avoider::State;
use fga::situation::Ownship;
use fga::vehicle::STANDARD_GRAVITY_MPS2;

use super::Sample;
use crate::plant::{Arc, Plant};
use crate::track::Track;
use crate::whole::whole;

/// Samples are at most this far apart, seconds.
pub(super) const LONGEST_SAMPLE_S: f64 = 0.1;

/// A larger change of rate gets a sample, radians per second.
const CORNER_RADPS: f64 = 0.02;

/// Corners nearer than this to a sample get no sample, seconds.
const CORNER_APART_S: f64 = 1e-3;

/// Flies one cycle, or several alike. It samples long cycles, and the begin and end of turns and changes of climb, so
/// that rates are constant between two samples.
pub(super) fn fly_step(
    plant: &mut Plant,
    (end_s, longest_sample_s): (f64, f64),
    is_sampled: bool,
    mut flown: impl FnMut(&Arc, Vec3),
    mut sample: impl FnMut(&Ownship, Vec3, f64),
) {
    let from_s = plant.time_s();
    let step_s = end_s - from_s;
    let pieces = whole(libm::ceil(step_s / longest_sample_s - 1e-9)).max(1);
    let mut sampled_s = from_s;
    let mut rates = None;
    for k in 1..=pieces {
        let until_s = if k == pieces {
            end_s
        } else {
            from_s + step_s * f64::from(k) / f64::from(pieces)
        };
        plant.advance_until(until_s, |arc, end_m| {
            flown(arc, end_m);
            if !is_sampled {
                return;
            }
            let now = (arc.course_rate_radps, arc.climb_rate_radps);
            let (course_rate, climb_rate) = rates.replace(now).unwrap_or(now);
            let corner = (now.0 - course_rate).abs() > CORNER_RADPS
                || (now.1 - climb_rate).abs() > CORNER_RADPS;
            if corner
                && arc.start_s > sampled_s + CORNER_APART_S
                && arc.start_s < until_s - CORNER_APART_S
            {
                let ownship = Ownship {
                    position_m: arc.position_m,
                    course_rad: arc.course_rad,
                    climb_rad: arc.climb_rad,
                    bank_rad: libm::atan(
                        arc.course_rate_radps * arc.airspeed_mps / STANDARD_GRAVITY_MPS2,
                    ),
                    airspeed_mps: arc.airspeed_mps,
                };
                sample(&ownship, arc.wind_mps, arc.start_s);
                sampled_s = arc.start_s;
            }
        });
        if k < pieces {
            sample(&plant.ownship(), plant.wind_mps(), until_s);
            sampled_s = until_s;
        }
    }
}

/// The logged state: angles over the ground, which equal the angles through still air.
pub(super) fn sample_of(ownship: &Ownship, wind_mps: Vec3, time_s: f64, state: State) -> Sample {
    let (course_rad, climb_rad) = if wind_mps == Vec3::ZERO {
        (wrap_pi(ownship.course_rad), ownship.climb_rad)
    } else {
        let ground_mps = ownship.velocity_mps() + wind_mps;
        (course_of(ground_mps), climb_of(ground_mps))
    };
    Sample {
        time_s,
        position_m: ownship.position_m,
        course_rad,
        climb_rad,
        bank_rad: ownship.bank_rad,
        state,
    }
}

/// The recorded flight between two times, as straight arcs.
pub(super) fn recorded_arcs(
    recorded: &Track,
    from_s: f64,
    to_s: f64,
    flown: &mut impl FnMut(&Arc),
) {
    let (first_s, last_s) = recorded.presence_s();
    recorded.for_each_leg(from_s.max(first_s), to_s.min(last_s), |leg| {
        let from_m = leg.position_at_m(leg.from_s);
        let moved = leg.position_at_m(leg.to_s) - from_m;
        let duration_s = leg.to_s - leg.from_s;
        if duration_s > 0.0 {
            flown(&Arc {
                start_s: leg.from_s,
                duration_s,
                position_m: from_m,
                course_rad: course_of(moved),
                climb_rad: climb_of(moved),
                course_rate_radps: 0.0,
                climb_rate_radps: 0.0,
                airspeed_mps: moved.length() / duration_s,
                wind_mps: Vec3::ZERO,
            });
        }
    });
}

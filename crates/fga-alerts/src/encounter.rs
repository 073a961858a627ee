//! The losses between two tracks, in continuous time.
//!
//! Tracks are straight between samples. The least separations and the first violations are exact
//! on each straight piece; the severity is sampled ten times a second.

use crate::aircraft::{AircraftState, Pair};
use crate::severity::severity;
use crate::volume::{Cylinder, Volume, WellClear};
use glam::DVec3;

/// The positions of two aircraft at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairSample {
    /// Time, seconds.
    pub time_s: f64,
    /// The ownship, metres.
    pub ownship_m: DVec3,
    /// The other aircraft, metres.
    pub intruder_m: DVec3,
}

/// A least value and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Least {
    /// The value, metres.
    pub value_m: f64,
    /// Time, seconds.
    pub time_s: f64,
}

/// The result of an encounter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EncounterOutcome {
    /// First near mid-air collision, seconds; `None` for none.
    pub nmac_s: Option<f64>,
    /// First loss of well clear, seconds; `None` for none.
    pub loss_s: Option<f64>,
    /// Duration of the loss of well clear, seconds.
    pub lost_for_s: f64,
    /// Highest severity of the loss, 0 to 1; `None` for a volume without severity.
    pub severity: Option<f64>,
    /// Least horizontal separation.
    pub horizontal: Option<Least>,
    /// Vertical separation at the least horizontal one, metres.
    pub vertical_then_m: Option<f64>,
    /// Least distance in three dimensions.
    pub slant: Option<Least>,
}

/// The longest step between two samples of the severity, seconds.
const SEVERITY_STEP_S: f64 = 0.1;
/// The most samples of the severity on one piece.
const MOST_LOOKS: f64 = 10_000.0;

/// Judges an encounter against a well-clear volume.
///
/// Ignores samples whose time does not increase or that are not finite.
pub fn judge(samples: &[PairSample], volume: &Volume) -> EncounterOutcome {
    let mut outcome = EncounterOutcome::default();
    let nmac = Volume::Cylinder(Cylinder::NMAC);
    let well_clear = volume.well_clear();
    let mut last: Option<&PairSample> = None;
    for sample in samples {
        if !(sample.time_s.is_finite()
            && sample.ownship_m.is_finite()
            && sample.intruder_m.is_finite())
        {
            continue;
        }
        let Some(from) = last else {
            last = Some(sample);
            outcome.see(&piece(sample, sample, 1.0), sample.time_s, 0.0);
            continue;
        };
        let lasts_s = sample.time_s - from.time_s;
        if lasts_s <= 0.0 {
            continue;
        }
        let pair = piece(from, sample, lasts_s);
        outcome.see(&pair, from.time_s, lasts_s);
        let loss = nmac.violation(&pair, 0.0, lasts_s);
        if loss.is_conflict() && outcome.nmac_s.is_none() {
            outcome.nmac_s = Some(from.time_s + loss.entry_s);
        }
        let loss = volume.violation(&pair, 0.0, lasts_s);
        if loss.is_conflict() {
            outcome.loss_s.get_or_insert(from.time_s + loss.entry_s);
            outcome.lost_for_s += loss.exit_s - loss.entry_s;
            if let Some(well_clear) = well_clear {
                outcome.look_at_severity(well_clear, &pair, loss.entry_s, loss.exit_s);
            }
        }
        last = Some(sample);
    }
    outcome
}

fn piece(from: &PairSample, to: &PairSample, lasts_s: f64) -> Pair {
    let state = |begin: DVec3, end: DVec3| AircraftState {
        position_m: begin,
        velocity_mps: (end - begin) / lasts_s,
    };
    Pair::exact(
        state(from.ownship_m, to.ownship_m),
        state(from.intruder_m, to.intruder_m),
    )
}

/// The pair after a time.
fn after(pair: &Pair, time_s: f64) -> Pair {
    let moved = |state: &AircraftState| AircraftState {
        position_m: state.position_m + state.velocity_mps * time_s,
        ..*state
    };
    Pair::exact(moved(&pair.ownship), moved(&pair.intruder))
}

impl EncounterOutcome {
    /// Updates the least separations with a piece.
    fn see(&mut self, pair: &Pair, begin_s: f64, lasts_s: f64) {
        let offset_m = pair.ownship.position_m - pair.intruder.position_m;
        let relative_mps = pair.ownship.velocity_mps - pair.intruder.velocity_mps;
        let nearest_s = |closing: f64, speed2: f64| {
            if speed2 > 0.0 {
                (-closing / speed2).clamp(0.0, lasts_s)
            } else {
                0.0
            }
        };
        let sees = |least: &mut Option<Least>, value_m: f64, time_s: f64| {
            let is_less = least.is_none_or(|least| value_m < least.value_m);
            if is_less {
                let time_s = begin_s + time_s;
                *least = Some(Least { value_m, time_s });
            }
            is_less
        };
        let (s, v) = (offset_m.truncate(), relative_mps.truncate());
        let time_s = nearest_s(s.dot(v), v.length_squared());
        let there = after(pair, time_s);
        if sees(
            &mut self.horizontal,
            there.horizontal_separation_m(),
            time_s,
        ) {
            self.vertical_then_m = Some(there.vertical_separation_m());
        }
        let time_s = nearest_s(offset_m.dot(relative_mps), relative_mps.length_squared());
        let value_m = (offset_m + relative_mps * time_s).length();
        sees(&mut self.slant, value_m, time_s);
    }

    fn look_at_severity(&mut self, volume: &WellClear, pair: &Pair, from_s: f64, to_s: f64) {
        let looks = libm::ceil((to_s - from_s) / SEVERITY_STEP_S).clamp(1.0, MOST_LOOKS);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 1 and 10,000"
        )]
        let count = looks as u32;
        for look in 0..=count {
            let time_s = from_s + (to_s - from_s) * f64::from(look) / looks;
            if let Some(found) = severity(volume, &after(pair, time_s)) {
                self.severity = Some(self.severity.map_or(found, |most| most.max(found)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Head-on at 100 m/s in all, 100 m aside and 20 m above, once a second.
    fn head_on(aside_m: f64, above_m: f64) -> Vec<PairSample> {
        (0..=40)
            .map(|second| {
                let time_s = f64::from(second);
                PairSample {
                    time_s,
                    ownship_m: DVec3::new(0.0, 50.0 * time_s, 0.0),
                    intruder_m: DVec3::new(aside_m, 2030.0 - 50.0 * time_s, above_m),
                }
            })
            .collect()
    }

    #[test]
    fn an_nmac_between_two_samples_is_found() {
        let volume = Volume::Cylinder(Cylinder::F3442);
        let outcome = judge(&head_on(100.0, 20.0), &volume);
        // The closest approach is at 20.3 s, between samples at 70 m and 30 m along.
        let horizontal = outcome.horizontal.unwrap();
        assert!((horizontal.value_m - 100.0).abs() < 1e-9);
        assert!((horizontal.time_s - 20.3).abs() < 1e-9);
        // Pythagoras: the 152.4 m circle is entered 115.0 m before.
        let entry_s = 20.3 - (152.4_f64.powi(2) - 100.0_f64.powi(2)).sqrt() / 100.0;
        assert!((outcome.nmac_s.unwrap() - entry_s).abs() < 1e-6);
        let lost_for_s = 2.0 * (609.6_f64.powi(2) - 100.0_f64.powi(2)).sqrt() / 100.0;
        assert!((outcome.lost_for_s - lost_for_s).abs() < 1e-6);
        assert!((outcome.slant.unwrap().value_m - 100.0_f64.hypot(20.0)).abs() < 1e-9);
    }

    #[test]
    fn above_the_volume_nothing_is_lost() {
        let volume = Volume::Cylinder(Cylinder::F3442);
        let outcome = judge(&head_on(0.0, 77.0), &volume);
        assert_eq!((outcome.nmac_s, outcome.loss_s), (None, None));
        assert_eq!(outcome.severity, None);
    }

    #[test]
    fn samples_that_are_no_numbers_or_go_back_are_left_out() {
        let mut samples = head_on(100.0, 20.0);
        let whole = judge(&samples, &Volume::WellClear(WellClear::EN_ROUTE));
        samples[7].ownship_m.x = f64::NAN;
        samples[9].time_s = 3.0;
        let rest = judge(&samples, &Volume::WellClear(WellClear::EN_ROUTE));
        assert!((whole.slant.unwrap().value_m - rest.slant.unwrap().value_m).abs() < 1e-9);
        assert_eq!(
            judge(&[], &Volume::WellClear(WellClear::EN_ROUTE)),
            EncounterOutcome::default()
        );
    }
}

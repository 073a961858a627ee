//! Does the aircraft fly what was certified?
//!
//! A certificate leaves room: the separation that it proves. A flight that is off the certified one by more than that is not what was
//! certified: what was learned of the vehicle is wrong.

use fga::Vec3;
use fga::command::Command;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::vehicle::Vehicle;

use crate::ownship::OwnState;

/// A certified flight is compared this often, at these intervals, seconds: later the first plan has mostly been replaced.
const COMPARED: u8 = 10;
const EVERY_S: f64 = 0.5;

/// The certified flight that is compared, and what was found so far.
#[derive(Debug, Default)]
pub(super) struct Promise {
    /// When the aircraft is to be where over the ground, the last one first, seconds and metres.
    places_m: Vec<(f64, Vec3)>,
    /// Room that the certificate leaves, metres.
    room_m: f64,
    kept: u32,
    missed: u32,
}

impl Promise {
    /// Takes a certified manoeuvre that begins at a time, seconds, in this state.
    pub(super) fn make(&mut self, command: &Command, own: &OwnState, vehicle: &Vehicle, at_s: f64) {
        self.end();
        let Some(bound) = command.certified() else {
            return;
        };
        let flyer = Flyer::new(vehicle);
        let mut path = Box::new(FlightPath::new());
        path.predict(
            &flyer,
            &MotionState::of(&own.ownship),
            command,
            EVERY_S * f64::from(COMPARED),
        );
        let ahead_s = (1..=COMPARED).rev().map(|n| EVERY_S * f64::from(n));
        let place_m = |ahead_s: f64| {
            let at_m = path.state_at(&flyer, ahead_s)?.position_m;
            Some((at_s + ahead_s, at_m + own.wind_mps * ahead_s))
        };
        self.places_m = ahead_s.filter_map(place_m).collect();
        self.room_m = bound.margin_m;
    }

    /// The manoeuvre ends, or another one is flown.
    pub(super) fn end(&mut self) {
        self.places_m.clear();
    }

    /// Compares the state at a time, seconds; how far the flight is off what was certified, metres, if by more than there is room.
    pub(super) fn compare(&mut self, own: &OwnState, at_s: f64) -> Option<f64> {
        let due = self.places_m.pop_if(|(due_s, _)| *due_s <= at_s);
        let (due_s, place_m) = due?;
        let own_m = own.ownship.position_m - own.ground_velocity_mps * (at_s - due_s);
        let off_m = (own_m - place_m).truncate().length();
        if off_m <= self.room_m {
            self.kept += u32::from(self.places_m.is_empty());
            return None;
        }
        self.missed += 1;
        self.end();
        Some(off_m)
    }

    /// Certified flights that were flown to the end of what is compared, and those that were not flown.
    pub(super) const fn counts(&self) -> (u32, u32) {
        (self.kept, self.missed)
    }
}

#[cfg(test)]
mod tests {
    use fga::assumptions::Assumptions;
    use fga::command::Terms;
    use fga::meter::Meter;
    use fga::situation::Ownship;

    use super::*;

    const ROOM_M: f64 = 10.0;

    fn own(position_m: Vec3) -> OwnState {
        let ownship = Ownship {
            position_m,
            airspeed_mps: 20.0,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
        };
        let wind_mps = Vec3::new(0.0, 3.0, 0.0);
        OwnState {
            ownship,
            ground_velocity_mps: ownship.velocity_mps() + wind_mps,
            wind_mps,
            above_home_m: 100.0,
            pitch_rad: 0.0,
            course_rate_radps: 0.0,
        }
    }

    /// Straight on, certified with [`ROOM_M`].
    fn promised() -> Promise {
        let vehicle = Vehicle::from_bank(20.0, 0.6).unwrap();
        let (flyer, start) = (Flyer::new(&vehicle), own(Vec3::ZERO));
        let mut path = Box::new(FlightPath::new());
        let mut command = Command::hold();
        let terms = Terms::new(60.0, ROOM_M, ROOM_M).unwrap();
        let motion = MotionState::of(&start.ownship);
        let nothing = Assumptions::only(&[]);
        let meter = Meter::unlimited();
        let proof = command.prove((&flyer, &mut path), &motion, &nothing, &terms, &meter);
        assert!(proof.is_ok());
        let mut promise = Promise::default();
        promise.make(&command, &start, &vehicle, 100.0);
        promise
    }

    #[test]
    fn a_flight_within_the_room_of_its_certificate_is_kept() {
        let mut promise = promised();
        for step in 1..=100_u32 {
            let ahead_s = 0.1 * f64::from(step);
            let off = Vec3::Y * (0.9 * ROOM_M * (ahead_s / 10.0));
            let at_m = Vec3::new(20.0, 3.0, 0.0) * ahead_s + off;
            assert_eq!(promise.compare(&own(at_m), 100.0 + ahead_s), None);
        }
        assert_eq!(promise.counts(), (1, 0));
    }

    #[test]
    fn a_flight_that_is_off_by_more_is_missed_once() {
        let mut promise = promised();
        let at_m = |ahead_s: f64| Vec3::new(20.0, 3.0 - 3.0 * ahead_s, 0.0) * ahead_s;
        let mut found = Vec::new();
        for step in 1..=100_u32 {
            let ahead_s = 0.1 * f64::from(step);
            found.extend(promise.compare(&own(at_m(ahead_s)), 100.0 + ahead_s));
        }
        assert!(
            matches!(found[..], [off_m] if off_m > ROOM_M && off_m < 1.5 * ROOM_M),
            "{found:?}"
        );
        assert_eq!(promise.counts(), (0, 1));
    }

    #[test]
    fn what_is_not_certified_promises_nothing() {
        let mut promise = promised();
        let vehicle = Vehicle::from_bank(20.0, 0.6).unwrap();
        promise.make(&Command::hold(), &own(Vec3::ZERO), &vehicle, 100.0);
        assert_eq!(promise.compare(&own(Vec3::Y * 1e3), 108.0), None);
        assert_eq!(promise.counts(), (0, 0));
    }
}

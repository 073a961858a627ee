//! The policies of the core, for the tests.

use fga::avoider::{Avoider, Settings, Start};
use fga::vehicle::Vehicle;

use crate::flight::{Flies, Flight};
use crate::mission_pilot::MissionPilot;

/// A policy of the core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Policy {
    Avoider(Start),
    Mission,
}

/// Every policy.
pub(crate) const POLICIES: [Policy; 5] = [
    Policy::Avoider(Start::Free),
    Policy::Avoider(Start::AtDetection),
    Policy::Avoider(Start::Latest),
    Policy::Avoider(Start::Score(0.5)),
    Policy::Mission,
];

/// Those whose decision does not depend on the frame: the free start compares departures that are often
/// nearly equal.
pub(crate) const SYMMETRIC: [Policy; 4] = [
    Policy::Avoider(Start::AtDetection),
    Policy::Avoider(Start::Latest),
    Policy::Avoider(Start::Score(0.5)),
    Policy::Mission,
];

impl Flies for Policy {
    fn weighs_exactly(self) -> bool {
        self == Self::Mission
    }

    fn flight(self, vehicle: Vehicle, scale: f64, radius_m: f64) -> Flight {
        let plain = Settings::default();
        let settings = Settings {
            surveillance_radius_m: radius_m * scale,
            margin_m: plain.margin_m * scale,
            ..plain
        };
        match self {
            Self::Avoider(start) => {
                let settings = Settings { start, ..settings };
                Flight::of(Avoider::new(settings, vehicle).unwrap(), vehicle)
            }
            Self::Mission => {
                let pilot = MissionPilot::new(settings.horizon_s, vehicle).unwrap();
                Flight::of(pilot, vehicle)
            }
        }
    }
}

/// A flight of the avoider.
pub(crate) fn avoider(settings: Settings, vehicle: Vehicle) -> Flight {
    Flight::of(Avoider::new(settings, vehicle).unwrap(), vehicle)
}

/// Settings with a start.
pub(crate) fn settings(start: Start) -> Settings {
    Settings {
        start,
        ..Settings::default()
    }
}

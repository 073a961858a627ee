//! The paper's policies for the tests.

use fga::avoider::Start;
use fga::vehicle::Vehicle;
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};

use crate::flight::{Flies, Flight};

/// A rule of the paper.
pub(crate) type Policy = Rule;

/// Every policy.
pub(crate) const POLICIES: [Policy; 4] = [
    Rule::Corrected(Start::AtDetection),
    Rule::Corrected(Start::Latest),
    Rule::AsPrinted,
    Rule::Circle,
];

/// Those whose decision does not depend on the frame.
pub(crate) const SYMMETRIC: [Policy; 4] = POLICIES;

impl Flies for Policy {
    fn weighs_exactly(self) -> bool {
        true
    }

    fn flight(self, vehicle: Vehicle, scale: f64, radius_m: f64) -> Flight {
        let plain = PaperSettings::new(self);
        let settings = PaperSettings {
            surveillance_radius_m: radius_m * scale,
            margin_m: plain.margin_m * scale,
            ..plain
        };
        Flight::of(PaperPilot::new(settings, vehicle).unwrap(), vehicle)
    }
}

//! Flight modes by the numbers of ArduPlane.

/// A flight mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are ArduPlane's own")]
pub enum PlaneMode {
    Manual,
    Circle,
    Stabilize,
    FlyByWireA,
    FlyByWireB,
    Cruise,
    Auto,
    Rtl,
    Loiter,
    AvoidAdsb,
    Guided,
    /// A mode of a newer firmware, with a number that has no name here.
    Newer,
}

const NUMBERS: [(PlaneMode, u32); 12] = [
    (PlaneMode::Manual, 0),
    (PlaneMode::Circle, 1),
    (PlaneMode::Stabilize, 2),
    (PlaneMode::FlyByWireA, 5),
    (PlaneMode::FlyByWireB, 6),
    (PlaneMode::Cruise, 7),
    (PlaneMode::Auto, 10),
    (PlaneMode::Rtl, 11),
    (PlaneMode::Loiter, 12),
    (PlaneMode::AvoidAdsb, 14),
    (PlaneMode::Guided, 15),
    (PlaneMode::Newer, 99),
];

impl PlaneMode {
    /// The number in `HEARTBEAT.custom_mode`.
    pub fn number(self) -> u32 {
        NUMBERS
            .iter()
            .find(|row| row.0 == self)
            .map_or(0, |row| row.1)
    }

    /// The mode with a number.
    pub fn from_number(number: u32) -> Option<Self> {
        NUMBERS.iter().find(|row| row.1 == number).map(|row| row.0)
    }
}

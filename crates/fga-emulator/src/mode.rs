//! Flight modes by the numbers of ArduPlane.

/// A flight mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are ArduPlane's own")]
pub enum Mode {
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

const NUMBERS: [(Mode, u32); 12] = [
    (Mode::Manual, 0),
    (Mode::Circle, 1),
    (Mode::Stabilize, 2),
    (Mode::FlyByWireA, 5),
    (Mode::FlyByWireB, 6),
    (Mode::Cruise, 7),
    (Mode::Auto, 10),
    (Mode::Rtl, 11),
    (Mode::Loiter, 12),
    (Mode::AvoidAdsb, 14),
    (Mode::Guided, 15),
    (Mode::Newer, 99),
];

impl Mode {
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

//! ArduPlane's flight modes.

/// A flight mode: the numbers of `HEARTBEAT.custom_mode`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Mode(pub u32);

/// A requested change of the flight mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModeChange {
    /// The mode that it leaves: the request is valid only there.
    pub from: Mode,
    /// The mode that it leads to.
    pub to: Mode,
}

/// The name, or the number of a mode that has no name here.
impl core::fmt::Display for Mode {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.is_named() {
            f.write_str(self.name())
        } else {
            write!(f, "mode {}", self.0)
        }
    }
}

/// Names used by ArduPlane and its ground stations.
const NAMES: [(u32, &str); 26] = [
    (0, "MANUAL"),
    (1, "CIRCLE"),
    (2, "STABILIZE"),
    (3, "TRAINING"),
    (4, "ACRO"),
    (5, "FBWA"),
    (6, "FBWB"),
    (7, "CRUISE"),
    (8, "AUTOTUNE"),
    (10, "AUTO"),
    (11, "RTL"),
    (12, "LOITER"),
    (13, "TAKEOFF"),
    (14, "AVOID_ADSB"),
    (15, "GUIDED"),
    (16, "INITIALISING"),
    (17, "QSTABILIZE"),
    (18, "QHOVER"),
    (19, "QLOITER"),
    (20, "QLAND"),
    (21, "QRTL"),
    (22, "QAUTOTUNE"),
    (23, "QACRO"),
    (24, "THERMAL"),
    (25, "LOITER_ALT_QLAND"),
    (26, "AUTOLAND"),
];

impl Mode {
    /// FBWB: roll from the stick, altitude and airspeed held.
    pub const FBWB: Self = Self(6);
    /// CRUISE: heading and altitude held.
    pub const CRUISE: Self = Self(7);
    /// AUTO: the mission.
    pub const AUTO: Self = Self(10);
    /// RTL: home.
    pub const RTL: Self = Self(11);
    /// GUIDED: commands of a companion.
    pub const GUIDED: Self = Self(15);

    /// The name; `?` for a number without one.
    pub fn name(self) -> &'static str {
        NAMES
            .iter()
            .find(|row| row.0 == self.0)
            .map_or("?", |row| row.1)
    }

    /// Whether it is a mode of this firmware's generation.
    fn is_named(self) -> bool {
        NAMES.iter().any(|row| row.0 == self.0)
    }

    /// The mode with a name, in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        NAMES
            .iter()
            .find(|row| row.1.eq_ignore_ascii_case(name))
            .map(|row| Self(row.0))
    }

    /// Whether it has a path to leave and rejoin.
    pub fn can_be_taken_over(self) -> bool {
        [Self::AUTO, Self::CRUISE, Self::FBWB, Self::RTL].contains(&self)
    }
}

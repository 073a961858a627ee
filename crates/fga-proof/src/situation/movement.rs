//! The possible motion of an obstacle after a report.

/// The possible motion of an obstacle from now on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Movement {
    /// It stays at its position, whatever its velocity says.
    AtRest,
    /// It keeps its velocity over the ground. A decision relies on it.
    #[default]
    Straight,
    /// An aircraft: it may turn, climb and change its speed within bounds. A decision expects it to
    /// continue its motion, and withstands its bounds where possible.
    Aircraft(MovementBounds),
}

impl Movement {
    /// A crewed aircraft: [`MovementBounds::CREWED`].
    pub const CREWED: Self = Self::Aircraft(MovementBounds::CREWED);

    /// A small unmanned aircraft: [`MovementBounds::SMALL_UAS`].
    pub const SMALL_UAS: Self = Self::Aircraft(MovementBounds::SMALL_UAS);

    /// The bounds of its manoeuvres; `None` if it makes none.
    pub const fn bounds(&self) -> Option<MovementBounds> {
        match self {
            Self::Aircraft(bounds) => Some(*bounds),
            Self::AtRest | Self::Straight => None,
        }
    }

    /// Whether every bound is a finite number and none is negative.
    pub fn is_valid(&self) -> bool {
        self.bounds().is_none_or(|bounds| {
            [
                bounds.turn_rate_radps,
                bounds.brief_turn_rate_radps,
                bounds.turn_rad,
                bounds.climb_change_mps,
                bounds.acceleration_mps2,
            ]
            .iter()
            .all(|bound| bound.is_finite() && *bound >= 0.0)
        })
    }
}

/// The bounds of an aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovementBounds {
    /// Sustained turn rate, radians per second.
    pub turn_rate_radps: f64,
    /// Turn rate for some seconds, radians per second.
    pub brief_turn_rate_radps: f64,
    /// Turn that a decision withstands where possible, radians.
    pub turn_rad: f64,
    /// Change of its vertical speed, metres per second.
    pub climb_change_mps: f64,
    /// Change of its speed, metres per second squared.
    pub acceleration_mps2: f64,
}

impl MovementBounds {
    /// A crewed aircraft: the standard-rate turn of instrument flight (3° a second), twice as much for
    /// some seconds, a turn of 60°; a change of climb of 500 ft a minute, the usual one of instrument
    /// flight; 0.5 m/s².
    pub const CREWED: Self = Self {
        turn_rate_radps: 3.0 * DEGREE,
        brief_turn_rate_radps: 6.0 * DEGREE,
        turn_rad: 60.0 * DEGREE,
        climb_change_mps: 2.54,
        acceleration_mps2: 0.5,
    };

    /// A small unmanned aircraft: 15° a second is a bank of 22° at 15 m/s, 37° a second one of 45°; a
    /// turn of 90°; 2.5 m/s of climb; 2 m/s².
    pub const SMALL_UAS: Self = Self {
        turn_rate_radps: 15.0 * DEGREE,
        brief_turn_rate_radps: 37.0 * DEGREE,
        turn_rad: 90.0 * DEGREE,
        climb_change_mps: 2.5,
        acceleration_mps2: 2.0,
    };
}

/// One degree, radians.
const DEGREE: f64 = core::f64::consts::PI / 180.0;

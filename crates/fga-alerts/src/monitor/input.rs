//! What a step takes, and why it refuses it.

use crate::aircraft::{Aircraft, AircraftId};

/// The reason for refusing a step; the monitor is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepError {
    /// The time is not finite.
    Time,
    /// A number of an aircraft is not finite.
    Aircraft(AircraftId),
    /// Two aircraft have the same id.
    Twice(AircraftId),
}

impl core::fmt::Display for StepError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Time => write!(f, "the time is not finite"),
            Self::Aircraft(id) => write!(f, "aircraft {} has a number that is not finite", id.0),
            Self::Twice(id) => write!(f, "aircraft {} appears twice", id.0),
        }
    }
}

impl core::error::Error for StepError {}

pub(super) fn check(
    time_s: f64,
    ownship: &Aircraft,
    traffic: &[Aircraft],
) -> Result<(), StepError> {
    if !time_s.is_finite() {
        return Err(StepError::Time);
    }
    for (index, aircraft) in core::iter::once(ownship).chain(traffic).enumerate() {
        let place_is_finite = aircraft
            .terminal_distance_m
            .is_none_or(|distance_m| !distance_m.is_nan());
        if !aircraft.state.is_finite() || !aircraft.deviation.is_finite() || !place_is_finite {
            return Err(StepError::Aircraft(aircraft.id));
        }
        let others = core::iter::once(ownship).chain(traffic).skip(index + 1);
        if others.into_iter().any(|other| other.id == aircraft.id) {
            return Err(StepError::Twice(aircraft.id));
        }
    }
    Ok(())
}

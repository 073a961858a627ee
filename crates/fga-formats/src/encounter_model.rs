//! The Bayesian encounter models of MIT Lincoln Laboratory: how aircraft fly when they meet.
//!
//! A model is two Bayesian networks over binned variables. The *initial* one gives the state at
//! the start: airspace class, altitude layer, airspeed, accelerations, climb and turn rates. The
//! *transition* one gives the next second's rates from the present ones. [`EncounterModel::start`]
//! draws a state, [`EncounterModel::step`] advances it by a second. [`EncounterModel::fly`] draws a
//! whole flight of an uncorrelated model, [`EncounterModel::fly_pair`] both flights of a correlated one.
//!
//! A value is drawn uniformly within its bin; a bin that spans 0 gives exactly 0. A variable
//! without boundaries is a category, counted from 1. When a bin changes, the sampler draws a
//! new value; else it draws one with the variable's resample rate each second.
//!
//! Source: M. Kochenderfer and others, "Uncorrelated encounter model of the National Airspace
//! System", ATC-345, and "Correlated encounter model", ATC-344, Lincoln Laboratory 2008.

mod flight;
mod model;
mod network;
mod read;

pub use flight::{ModelPair, ModelRow};
pub use model::{EncounterModel, ModelState, Variable};
pub use read::{parse, read};

//! The oracle: can any manoeuvre save this encounter?
//!
//! It is the yardstick for every policy and no part of the aircraft: an exhaustive search over
//! *wait, turn, fly straight, turn again* with a change of climb angle in each turn, refined until the
//! best margin is accurate to about a centimetre. It shares no code with the policy: it has its own
//! flight paths, separation and search.
//!
//! | question | answer |
//! |---|---|
//! | what is the largest margin that a manoeuvre keeps? | [`best_margin`] |
//! | what is it over ground, among zones, within altitude limits? | [`best_margin_within`] |
//! | what is it among aircraft whose tracks are known? | [`best_margin_on_tracks`] |
//! | which safe manoeuvre leaves the x axis least? | [`least_departure`] |
//! | where does a manoeuvre lead? | [`OracleFlight`] |
//!
//! Frame: x east, y north, z up; course from +x towards +y; a left turn is positive. All in the air
//! mass: with wind, obstacles move with their velocity minus the wind
//! ([`OracleObstacle::in_wind`]). The oracle knows every given obstacle from the start; to model an
//! oracle that learns of an event later, start it from the state of that moment.
//!
//! Ground, zones and limits ([`OracleAirspace`]) stand over the ground. In a winding valley two turns are often too few.
//!
//! It does not try three or more turns, turns below the full rate, or any change of airspeed.
//! "Lost" therefore means: lost for every manoeuvre of this family.

mod airspace;
mod arc;
mod ascent;
mod departure;
mod flight;
mod grid;
mod linear;
mod pattern;
mod problem;
mod search;
mod separation;
mod tree;

pub use airspace::{OracleAirspace, OracleBoundary};
pub use departure::{DepartureAnswer, least_departure};
pub use flight::{FlightNode, OracleFlight};
pub use problem::{
    AVOIDABLE_MARGIN_M, OracleAnswer, OracleManeuver, OracleObstacle, OracleSettings, OracleStart,
    OracleTrack, OracleVehicle, Stages,
};
pub use search::{best_margin, best_margin_on_tracks, best_margin_within};

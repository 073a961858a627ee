//! The paper's pilot from outside: its symmetries, its reaction to unusable numbers, its circle.

mod circle;
#[path = "../../../fga/tests/avoider/flight.rs"]
mod flight;
mod policies;
#[path = "../../../fga/tests/avoider/properties.rs"]
mod properties;
mod unusable;

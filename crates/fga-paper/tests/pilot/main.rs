//! The paper's pilot from outside: its symmetries, what it does with unusable numbers, its circle.

mod circle;
#[path = "../../../fga/tests/avoider/flight.rs"]
mod flight;
mod policies;
#[path = "../../../fga/tests/avoider/properties.rs"]
mod properties;
mod unusable;

//! The avoider from outside: its states, its symmetries, what it does with unusable numbers.

mod aircraft;
mod flight;
mod need;
mod objectives;
mod policies;
mod properties;
mod states;

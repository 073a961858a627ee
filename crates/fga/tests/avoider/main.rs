//! The avoider from outside: its states, its symmetries, what it does with unusable numbers.

mod circle;
mod flight;
mod objectives;
mod properties;
mod states;

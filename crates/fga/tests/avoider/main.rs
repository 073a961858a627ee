//! The avoider from outside: its states, its symmetries, its reaction to unusable numbers.

mod aircraft;
mod entered;
mod flight;
mod ground;
mod inside;
mod kept;
mod lane_change;
mod lent;
mod need;
mod objectives;
mod policies;
mod properties;
mod small;
mod states;
mod zones;

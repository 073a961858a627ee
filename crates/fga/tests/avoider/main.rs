//! The avoider from outside: its states, its symmetries, its reaction to unusable numbers.

mod aircraft;
mod corner;
mod entered;
mod flight;
mod ground;
mod inside;
mod kept;
mod lane_change;
mod lent;
#[path = "../../../fga-sim/src/mission_pilot.rs"]
#[expect(dead_code, unreachable_pub, reason = "the simulator uses the rest")]
mod mission_pilot;
mod need;
mod objectives;
mod policies;
mod properties;
mod small;
mod states;
mod zones;

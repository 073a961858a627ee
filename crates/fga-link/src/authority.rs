//! Who flies: the states of authority, and what each fault does.
//!
//! ```text
//!            ready                 a manoeuvre begins        the vehicle confirms
//!  Waiting ─────────► Ready ─────────────────────► Taking ────────────────────► InCommand
//!     ▲  ◄─────────── │  ▲                            │                            │
//!     │   not ready      │ confirmed                  │ a fault                    │ back on the way
//!     │                  └──────── Returning ◄────────┴────────────────────────────┤ or a fault
//!     │                                                                            │
//!     └──── armed again ──── Released ◄──── the pilot changed the mode, a fault ───┘
//! ```
//!
//! The pilot always wins: a mode that nobody here asked for ends the authority with the message
//! that reports it, in every state, and nothing is sent that would change the pilot's mode. [`Hearing`] decides
//! whether a mode may be commanded at all, for the companion and the watchdog alike.

mod hearing;
mod keeper;
mod reactions;
mod state;
mod stray;
#[cfg(test)]
mod tests;
mod watchdog;

pub use hearing::{Beat, BeatOrder, Hearing};
pub use keeper::Keeper;
pub use reactions::{Fault, FaultReaction, HandBack, REACTIONS, Rearm, Severity, reaction};
pub use state::{Action, Authority, Late};
pub use watchdog::{LOOK_EVERY_S, Order, Owed, Watchdog};

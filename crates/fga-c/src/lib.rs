//! The C interface of fga: the decision core for autopilots, and the certificate alone.
//!
//! The header `include/fga.h` is generated from this crate, and is its manual: what each function expects and answers.
//! `include/fga.hpp` wraps it for C++17. The page "On a microcontroller" of the book says what a program around it looks like.
//!
//! The crate is `no_std`, allocates nothing, and no call can panic: every misuse that a library can find is an
//! [`fga_status`]. Storage comes from the caller. This is the only crate of the flying code with unsafe code: it reads and
//! writes what pointers of the caller lead to.
//!
//! | module | question |
//! |---|---|
//! | `status` | what does a call answer, and why does it refuse? |
//! | `memory` | is it safe to read and write where the caller says? |
//! | `floating` | in which floating-point environment does a call compute? |
//! | `input` | what does the caller give? |
//! | `airspace` | which zones and which ground does the caller lend? |
//! | `avoider` | what to fly until the next step? |
//! | `decision` | what was decided, and why? |
//! | `reports` | where are the others, by their reports? |
//! | `learned` | how does the aircraft follow its commands, by its own flight? |
//! | `prover` | how close does somebody else's manoeuvre come to the obstacles? |
#![no_std]
#![allow(
    unsafe_code,
    reason = "the border to C; every block says why it is sound"
)]
#![deny(clippy::undocumented_unsafe_blocks)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]
#![expect(non_camel_case_types, reason = "types are named as in C")]
#![expect(
    clippy::missing_safety_doc,
    reason = "the header states once, for all functions, what pointers must lead to"
)]

#[cfg(test)]
extern crate std;

mod abi;
mod airspace;
mod avoider;
mod beliefs;
mod decision;
mod floating;
mod growable;
mod input;
mod learned;
mod memory;
mod prover;
mod reports;
mod status;

pub use abi::{FGA_ABI_VERSION, FGA_ALIGN, FGA_CAPACITY_MOST, fga_abi_version};
pub use airspace::{
    FGA_GROUND_POSTS_MOST, FGA_ZONE_CORNERS_MOST, FGA_ZONES_MOST, fga_ground,
    fga_ground_fill_peaks, fga_ground_peak_count, fga_place, fga_zone, fga_zone_kind,
};
pub use avoider::*;
pub use beliefs::*;
pub use decision::*;
pub use input::{
    fga_bounds, fga_enu, fga_mission, fga_movement, fga_objective, fga_obstacle, fga_ownship,
    fga_passing, fga_settings, fga_situation, fga_stage, fga_start, fga_vehicle, fga_volume,
    fga_waypoint,
};
pub use learned::*;
pub use prover::*;
pub use reports::*;
pub use status::{
    FGA_REFUSAL_EXPECTED_BYTES, FGA_REFUSAL_FIELD_BYTES, fga_refusal, fga_status, fga_status_text,
};

/// A static library must have one. It is linked only if something can panic, and then it stays here.
#[cfg(feature = "staticlib")]
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

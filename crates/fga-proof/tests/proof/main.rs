//! Certificates against integrated flights, in one program: cargo runs programs one after another.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts drawn from floats"
)]

mod checker;
mod flown;
mod ground;
#[path = "../common/random.rs"]
mod random;
mod zones;

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

use fga_proof::assumptions::Assumptions;
use fga_proof::command::{Command, Proof, Terms};
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};

/// What is proven about a manoeuvre from the origin along x, with a horizon, a target and a cap of margins.
fn proven(
    flight: (&Flyer, &mut FlightPath),
    maneuver: &Maneuver,
    assumptions: &Assumptions<'_>,
    (horizon_s, target_m, enough_m): (f64, f64, f64),
    meter: &Meter,
) -> Option<Proof> {
    let (start, mut command) = (MotionState::ahead(0.0), Command::from(*maneuver));
    let terms = Terms::new(horizon_s, target_m, enough_m)?;
    command
        .prove(flight, &start, assumptions, &terms, meter)
        .ok()
}

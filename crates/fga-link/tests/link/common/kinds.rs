//! The encounters of the emulator and of a real ArduPlane: kinds of intruders and their velocities.
#![allow(unreachable_pub, reason = "a bench of tests and an example")]

use super::random::Random;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    HeadOn,
    Crossing,
    Overtaking,
    Climbing,
    Two,
}

pub const KINDS: [Kind; 5] = [
    Kind::HeadOn,
    Kind::Crossing,
    Kind::Overtaking,
    Kind::Climbing,
    Kind::Two,
];

/// One side or the other.
fn side(random: &mut Random) -> f64 {
    if random.uniform(0.0, 1.0) < 0.5 {
        1.0
    } else {
        -1.0
    }
}

/// Velocity of an intruder across the leg (to the right), along it, and up, metres per second.
pub fn velocity_mps(random: &mut Random, kind: Kind, own_mps: f64) -> [f64; 3] {
    let (speed_mps, track_deg) = match kind {
        Kind::HeadOn => (
            random.uniform(15.0, 40.0),
            180.0 + random.uniform(-10.0, 10.0),
        ),
        Kind::Crossing | Kind::Climbing | Kind::Two => (
            random.uniform(15.0, 40.0),
            side(random) * random.uniform(60.0, 120.0),
        ),
        Kind::Overtaking => (
            own_mps + random.uniform(13.0, 25.0),
            random.uniform(-8.0, 8.0),
        ),
    };
    let up_mps = if kind == Kind::Climbing {
        side(random) * random.uniform(2.0, 5.0)
    } else {
        0.0
    };
    let (sin, cos) = f64::to_radians(track_deg).sin_cos();
    [speed_mps * sin, speed_mps * cos, up_mps]
}

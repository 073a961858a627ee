//! Can the encounter be solved at all? The three bounds of §3.4, in the plane and in space.
//!
//! | question | function |
//! |---|---|
//! | is the first sight far enough away for the turn? (bound 1, Eq. 26–30) | [`distance_feasible`], [`least_distance_m`] |
//! | is the aircraft fast enough for any direction to work? (bound 2, Eq. 31–45, 49, 50) | [`speed_feasible_2d`], [`speed_feasible_3d`] |
//! | which courses stay clear? (bound 3, Eq. 46–48) | [`HeadingSet`] |
//! | which directions in space stay clear? (Eq. 51–53) | [`direction_admissible`], [`admissible_fraction`] |
//!
//! Bounds 2 and 3 assume that the aircraft flies a direction at once; they are necessary, and exact
//! for straight flight. Bound 1 is about the turn towards a direction, exact for a static obstacle.

mod distance;
mod heading;
mod solid_angle;
mod speed;

pub use distance::{distance_feasible, least_distance_m};
pub use heading::{HeadingSet, MAX_INTERVALS, Rotations};
pub use solid_angle::{admissible_fraction, direction_admissible};
pub use speed::{least_speed_2d_mps, least_speed_3d_mps, speed_feasible_2d, speed_feasible_3d};

//! Will an obstacle come too close? Relative geometry, collision cones, the threat decision.
//!
//! | question | function |
//! |---|---|
//! | where is the obstacle, seen from the aircraft, and how does it close? | [`Relative::of`] |
//! | when and how far is the closest point of approach? | [`Relative::closest`] |
//! | when is a volume entered and left? | [`inside_during`] |
//! | how far from the volume does the relative path stay? | [`least_margin`] |
//! | inside, threat, passing, receding? | [`assess`] |
//! | in a 2D or 3D collision cone (Eq. 1–6)? | [`cone_xy`], [`cone_xz`], [`cone_3d`] |
//! | which of many obstacles threaten (Alg. 1)? | [`detect`] |
//!
//! Convention (`docs/errata.md`): r = A − U points from the aircraft to the obstacle and
//! `V_r` = `V_u` − `V_a` is the aircraft's velocity seen from the obstacle, so that the bias angle
//! `θ_t0` between them is 0 on a collision course.

mod assess;
mod cone;
mod detect;
mod relative;

pub use assess::{Conflict, LeastMargin, assess, inside_during, least_margin};
pub use cone::{Cone, cone_3d, cone_xy, cone_xz};
pub use detect::{Detection, detect, threatens};
pub use relative::{ClosestApproach, Relative};

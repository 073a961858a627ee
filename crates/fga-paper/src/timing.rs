//! When must an avoiding turn begin? (Eq. 16–25, 57, 58, Table 2, §6)
//!
//! | question | function |
//! |---|---|
//! | when must a turn of radius ρ begin? | [`avoidance_time_s`] (Eq. 16, 17) |
//! | all times of one obstacle | [`Times::of`] (`t_L`, `t_c`, `r_c`, Eq. 17–25) |
//! | how urgent is it? | [`ThreatLevel::of`] (Table 2) |
//! | when does a policy with score `C_s` begin? | [`scored_start_s`] (§3.3) |
//! | the first of many, and their order | [`earliest_critical_s`], [`order_by_urgency`], [`simultaneous`] |
//! | several obstacles as one | [`merge_overlapping`], [`path_overlap`] (Fig. 10) |
//!
//! # Where these times hold
//!
//! They describe a turn away from a **static** obstacle, in the plane of r and `V_r`. Against a
//! moving obstacle the turn is a trochoid in the relative frame, not a circle, and the times are
//! too late (`docs/errata.md` has the numbers); the exact counterpart is the latest certified
//! start of the turn-aware search. A level turn past a sphere whose centre is above or below
//! needs its level section: [`Geometry::level_section`].

mod critical;
mod geometry;
mod merging;
mod urgency;

pub use critical::{Times, avoidance_time_s, critical_distance_m, last_feasible_distance_m};
pub use geometry::Geometry;
pub use merging::{PathOverlap, merge_overlapping, path_overlap};
pub use urgency::{
    ThreatLevel, Urgency, earliest_critical_s, order_by_urgency, scored_start_s, simultaneous,
};

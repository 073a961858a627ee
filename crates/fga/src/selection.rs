//! Which way?
//!
//! | question | module |
//! |---|---|
//! | which turns, climbs and second turns stay clear in continuous time? | [`turn_aware`] |
//! | the cheapest direction of the paper's grid that clears every obstacle | [`published`] (Alg. 2, corrected) |
//! | what the formulas give as they are printed | [`literal`] |

pub mod literal;
pub mod published;
pub mod turn_aware;

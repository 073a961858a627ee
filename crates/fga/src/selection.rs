//! Which way?
//!
//! | question | module |
//! |---|---|
//! | the cheapest direction of the paper's grid that clears every obstacle | [`published`] (Alg. 2, corrected) |
//! | what the formulas give as they are printed | [`literal`] |

pub mod literal;
pub mod published;

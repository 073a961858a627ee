//! Pictures of flights and campaigns: the overview of a run, plots of campaigns, a report page,
//! and the replay page.
//!
//! Every plot is a self-contained SVG of vector shapes and real text, the same to the byte for
//! the same input on any machine: coordinates are rounded to a hundredth of a pixel and every
//! transcendental function is libm's.
//!
//! | module | question |
//! |---|---|
//! | [`overview`] | where did the aircraft fly, and how close did it come? |
//! | [`animation`] | how did it go, in a picture that moves? |
//! | [`profile`] | does a mission clear the ground? |
//! | [`plot`] | what do many runs show together? |
//! | [`interval`] | how certain is a share? |
//! | [`report`] | how do figures, tables and their interpretation become one page? |
//! | [`safety_case`] | what does a campaign of aircraft show a regulator? |
//! | [`league`] | which policy keeps how many apart, at which cost? |
//! | [`listing`] | which of many runs deserve a look? |
//! | [`replay`] | why did it turn there? |
//! | [`zone`] | where may it not fly? |
//!
//! Colours are from Okabe and Ito (<https://jfly.uni-koeln.de/color/>), which people with any
//! common colour vision can distinguish.

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct FrontPage;

pub mod animation;
pub mod interval;
pub mod league;
pub mod listing;
pub mod overview;
pub mod plot;
pub mod profile;
pub mod replay;
pub mod report;
pub mod safety_case;
pub mod zone;

mod label;
mod page;
mod palette;
mod scale;
mod svg;

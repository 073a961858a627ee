//! Pictures of what fga did: the overview of a run, plots of campaigns, a report page,
//! and the replay page.
//!
//! Every plot is a self-contained SVG of vector shapes and real text, the same to the byte for
//! the same input on any machine: coordinates are rounded to a hundredth of a pixel and every
//! transcendental function is libm's.
//!
//! | module | question |
//! |---|---|
//! | [`overview`] | where did the aircraft fly, and how close did it come? |
//! | [`plot`] | what do many runs show together? |
//! | [`interval`] | how sure is a share? |
//! | [`report`] | how do figures, tables and their reading become one page? |
//! | [`safety_case`] | what does a campaign of aircraft say to a regulator? |
//! | [`listing`] | which of many runs is worth a look? |
//! | [`replay`] | why did it turn there? |
//!
//! Colours are those of Okabe and Ito (<https://jfly.uni-koeln.de/color/>), which people with any
//! common colour vision tell apart.

pub mod interval;
pub mod listing;
pub mod overview;
pub mod plot;
pub mod replay;
pub mod report;
pub mod safety_case;

mod label;
mod page;
mod palette;
mod scale;
mod svg;

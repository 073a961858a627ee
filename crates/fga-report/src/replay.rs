//! The replay page: flight, decisions and reasons in one HTML file.
//!
//! [`render`] writes a self-contained page: the viewer (built from `viewer/`, committed
//! in `assets/`) and the data are inside. A browser opens it from the disk, without a network.
//! The page holds one or several runs of the same encounter, for example under different
//! policies, and shows them in one scene.
//!
//! All lengths are metres, times seconds from the start of the run, angles radians, in the local
//! frame: x east, y north, z up; course ψ from +x towards +y; bank positive in a left turn.
//! Texts (titles, names, lines) may contain anything: the page escapes them and shows them as text.
//!
//! ```
//! use fga_report::replay::{Replay, ReplayRun, ReplaySample, ReplayState, render};
//!
//! let mut run = ReplayRun::named("turn-aware");
//! run.samples.push(ReplaySample {
//!     t_s: 0.0,
//!     position_m: [0.0, 0.0, 100.0],
//!     course_rad: 0.0,
//!     climb_rad: 0.0,
//!     bank_rad: 0.0,
//!     state: ReplayState::Cruise,
//! });
//! let page = render(&Replay { title: "one sample".into(), runs: vec![run], ground: None });
//! assert!(page.starts_with("<!doctype html>"));
//! ```

mod data;
mod encode;
mod live;
mod thin;

use crate::page;

pub use data::{
    Replay, ReplayAlert, ReplayBand, ReplayBands, ReplayDecision, ReplayDecisionTime, ReplayEvent,
    ReplayFutures, ReplayGround, ReplayGuidance, ReplayObstacle, ReplayOutcome, ReplayPath,
    ReplayPathKind, ReplayPiece, ReplayRegion, ReplayRun, ReplaySample, ReplayState,
};
pub use live::{LiveMessage, render_live};

/// Writes the page.
///
/// The same input gives the same bytes. A ten-minute flight sampled every 0.1 s among 50
/// obstacles stays below 3 MB. Records or samples beyond the size limit are thinned evenly in
/// time, but never where the state or the threat changes.
#[must_use]
pub fn render(replay: &Replay) -> String {
    let data = encode::replay_json(replay);
    page::fill(encode::TEMPLATE, &replay.title, &data, "'none'")
}

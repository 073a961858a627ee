//! The commands, run as programs. One test program, so that the flights in real time (`fly`) wait beside the
//! commands that compute: `cargo test -p fga-cli --test cli batch::` runs the tests of one file.

extern crate alloc;

#[cfg(all(feature = "fly", target_os = "linux"))]
#[path = "../../../fga-link/tests/link/common/live.rs"]
mod live;
mod support;

mod aircraft_campaign;
mod alerts;
mod answers;
mod batch;
mod campaign;
mod campaign_draw;
mod export;
mod files;
#[cfg(all(feature = "fly", target_os = "linux"))]
mod fly;
mod ground;
mod identify;
mod league;
mod left_out;
mod messages;
mod missions;
mod own_policy;
mod pages;
mod recomputed;
mod reference;
mod replay;
mod reproduce;
mod run;
mod stress;
mod terrain;
mod tracks;
mod tutorial;

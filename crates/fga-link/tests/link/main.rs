//! The companion against the ArduPlane-like emulator, receivers, other codecs and ground stations. One
//! program, so that tests which wait in real time (`program`, `mavproxy`) do so beside those that
//! compute: `cargo test -p fga-link --test link faults::` runs the tests of one file.

extern crate alloc;

mod common;

mod above_ground;
mod adversary;
mod alerts;
mod arduplane;
mod claims;
mod climb_unknown;
mod closed_loop;
mod degraded;
mod encounters;
mod faults;
mod feeds;
mod fence;
mod field_faults;
mod flights;
mod gaps;
mod how_to;
mod in_the_turn;
mod items;
mod latency;
mod learned;
mod mavproxy;
mod mission;
mod new_leg;
mod pressure;
mod program;
mod pymavlink;
mod rally;
mod rates;
mod receivers;
mod repeats;
mod robust;
mod safety;
mod safety_case;
mod sbs_log;
mod sequences;
mod station_terrain;
mod survivors;
mod terrain;
mod traffic;
mod trial;
mod vehicle_terrain;

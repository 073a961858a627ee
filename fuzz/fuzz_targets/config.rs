//! Any text as a configuration: refused in words, or a companion that starts; and whatever else is
//! text: endpoints, receivers, lines and tracks of traffic.
#![no_main]

use fga_formats::recordings::{self, Content};
use fga_link::endpoint::Endpoint;
use fga_link::player::{PlayerLine, from_states, read_log};
use fga_link::traffic::receiver::ReceiverEndpoint;
use fga_link::{Companion, Config};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let (lines, tally) = read_log(bytes);
    assert!(lines.len() as u64 <= tally.read());
    let Ok(text) = core::str::from_utf8(bytes) else {
        return;
    };
    match Config::parse(text) {
        Ok(config) => {
            if let Ok(mut companion) = Companion::new(config, false) {
                companion.tick(0.0);
                companion.tick(1.0);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    let _ = text.parse::<Endpoint>();
    let _ = text.parse::<ReceiverEndpoint>();
    if let Ok(line) = text.parse::<PlayerLine>() {
        if let Some(sample) = line.0.at(1e4) {
            assert!(sample.place.latitude_deg.is_finite());
        }
    }
    if let Ok(Content::States(states)) = recordings::parse_content(bytes, Path::new("a")) {
        let samples = from_states(&states)
            .into_iter()
            .flat_map(|flight| flight.samples);
        assert!(samples.into_iter().all(|sample| sample.time_s >= 0.0));
    }
});

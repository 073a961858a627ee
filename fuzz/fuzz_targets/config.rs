//! Any text as a configuration: refused in words, or a companion that starts; and whatever else is
//! text: endpoints, receivers, lines and tracks of traffic.
#![no_main]

use fga_link::endpoint::Endpoint;
use fga_link::player::{Line, read_sbs_log, read_tracks};
use fga_link::traffic::receiver::ReceiverEndpoint;
use fga_link::{Companion, Config};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = read_sbs_log(bytes);
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
    if let Ok(line) = text.parse::<Line>() {
        if let Some(sample) = line.0.at(1e4) {
            assert!(sample.place.latitude_deg.is_finite());
        }
    }
    let _ = read_tracks(text);
});

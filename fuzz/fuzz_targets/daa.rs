//! Any text is a recording with finite positions, or is refused.
#![no_main]

use fga_formats::daa;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|text: &str| {
    let Ok(recording) = daa::parse(text, Path::new("a.daa")) else {
        return;
    };
    assert!(recording.ownship().is_some());
    for track in &recording.aircraft {
        assert!(
            track
                .samples
                .windows(2)
                .all(|pair| pair[0].time_s < pair[1].time_s)
        );
        for sample in &track.samples {
            assert!(sample.position_m.is_finite() && sample.velocity_mps.is_finite());
            assert!(track.state_at(sample.time_s).is_some());
        }
    }
});

//! Any text is a mission of places on the earth, or is refused.
#![no_main]

use fga_formats::missions;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|text: &str| {
    let Ok(mission) = missions::parse(text, Path::new("a.plan")) else {
        return;
    };
    for waypoint in &mission.waypoints {
        assert!(waypoint.place.latitude_deg.is_finite() && waypoint.place.altitude_m.is_finite());
    }
});

//! Any flight that is taken can be exported in every format.
#![no_main]

use fga_formats::export::{czml, geojson, kml, mcap};
use fga_formats::flight::Flight;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(flight) = serde_json::from_str::<Flight>(text) else {
        return;
    };
    if flight.check().is_err() {
        return;
    }
    let _ = kml::text(&flight);
    let _ = czml::text(&flight);
    let _ = geojson::text(&flight);
    mcap::bytes(&flight).expect("memory takes all");
});

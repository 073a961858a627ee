//! Any bytes under any of the names are ground of sane heights, or are refused.
#![no_main]

use fga_formats::terrain::{Given, Terrain, parse};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    for name in ["N46E009.hgt", "N46E009.DAT", "a.dt0", "a.tif"] {
        let Ok(file) = parse(bytes, Path::new(name), &Given::default()) else {
            continue;
        };
        let Ok(ground) = Terrain::new(vec![file]) else {
            continue;
        };
        if let Some(area) = ground.area() {
            let height_m = ground.height_m(area.south_deg, area.west_deg);
            assert!(height_m.is_none_or(|height_m| height_m.abs() <= 9_000.0));
            let is_range = |[least_m, largest_m]: [f64; 2]| {
                least_m.is_finite() && largest_m.is_finite() && least_m <= largest_m
            };
            assert!(ground.range_m(&area).is_none_or(is_range));
        }
    }
});

//! Any text is a model that draws finite values, or is refused.
#![no_main]

use fga_formats::encounter_model;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|text: &str| {
    let Ok(model) = encounter_model::parse(text, Path::new("m.txt")) else {
        return;
    };
    let mut state = 1_u64;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / 9_007_199_254_740_992.0
    };
    let mut drawn = model.start(&mut uniform);
    for _ in 0..10 {
        model.step(&mut drawn, &mut uniform);
        assert!(drawn.values().iter().all(|value| value.is_finite()));
    }
});

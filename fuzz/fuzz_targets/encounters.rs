//! Any bytes are a batch file that is read back as it is written, or are refused.
#![no_main]

use fga_formats::encounters;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let Ok(found) = encounters::parse(bytes, Path::new("e.csv")) else {
        return;
    };
    assert!(found.iter().all(|encounter| !encounter.obstacles.is_empty()));
    let mut written = Vec::new();
    encounters::write_to(&mut written, &found).expect("memory takes all");
    let again = encounters::parse(written.as_slice(), Path::new("e.csv")).expect("our own file");
    assert_eq!(again.len(), found.len());
});

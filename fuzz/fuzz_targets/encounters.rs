//! Any bytes are a batch file that is read back as it is written, or are refused.
#![no_main]

use fga_formats::encounters::{self, EncounterWriter};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let Ok(found) = encounters::parse(bytes, Path::new("e.csv")) else {
        return;
    };
    let mut writer = EncounterWriter::new(Vec::new()).expect("memory takes all");
    for encounter in &found {
        assert!(!encounter.obstacles.is_empty());
        writer.write(encounter).expect("memory takes all");
    }
    let written = writer.into_inner();
    let again = encounters::parse(written.as_slice(), Path::new("e.csv")).expect("our own file");
    assert_eq!(again.len(), found.len());
});

//! Any bytes are a flight log with finite rows, or refused in one line.
#![no_main]

use std::path::Path;

use fga_formats::flight_log::parse;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| match parse(bytes, Path::new("log")) {
    Ok(log) => {
        let mut rows = log.pieces.iter().flat_map(|piece| &piece.bank_rad);
        assert!(rows.all(|bank_rad| bank_rad.is_finite()));
    }
    Err(error) => assert!(!error.message.contains('\n')),
});

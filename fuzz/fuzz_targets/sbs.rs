//! Any bytes of a connection are taken, and give the same reports however they are cut.
#![no_main]

use fga_formats::traffic::sbs::{Recording, Stream};
use libfuzzer_sys::fuzz_target;
use std::io::BufReader;

fuzz_target!(|bytes: &[u8]| {
    let collect = |size: usize| {
        let mut stream = Stream::new();
        let mut reports = Vec::new();
        for part in bytes.chunks(size) {
            stream.push(part, |report| {
                assert!(
                    report
                        .place_deg
                        .is_none_or(|[a, b]| a.abs() <= 90.0 && b.abs() <= 180.0)
                );
                reports.push(report);
            });
        }
        (reports, stream.counts())
    };
    assert_eq!(collect(1), collect(usize::MAX));
    let mut last_s = 0.0;
    for line in Recording::new(BufReader::new(bytes)) {
        assert!(line.time_s >= last_s);
        last_s = line.time_s;
    }
});

//! Any bytes of a connection are taken, and give the same reports however they are cut; every line is counted once.
#![no_main]

use fga_formats::traffic::sbs::{LineStream, Log};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let collect = |size: usize| {
        let mut stream = LineStream::default();
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
        (reports, stream.tally())
    };
    assert_eq!(collect(1), collect(usize::MAX));
    let lines = bytes.split_inclusive(|byte| *byte == b'\n').count() as u64;
    let mut log = Log::new(bytes);
    assert!((&mut log).all(|line| line.time_s.is_finite()));
    assert_eq!(log.tally().read(), lines);
});

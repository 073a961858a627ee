//! Any bytes of datagrams are taken, and give the same reports however they are cut.
#![no_main]

use fga_formats::traffic::gdl90::Datagrams;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let collect = |size: usize| {
        let mut stream = Datagrams::default();
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
});

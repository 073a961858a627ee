//! Any bytes of a connection are taken; so is any content in a whole squitter.
#![no_main]

use fga_formats::traffic::TrafficReport;
use fga_formats::traffic::beast::{Stream, push_frame};
use libfuzzer_sys::fuzz_target;

fn check(report: TrafficReport) {
    assert!(
        report
            .place_deg
            .is_none_or(|[a, b]| a.abs() <= 90.0 && b.abs() <= 180.0)
    );
    assert!(
        report
            .ground_speed_mps
            .is_none_or(|speed| (0.0..3000.0).contains(&speed))
    );
    assert!(report.course_rad.is_none_or(f64::is_finite));
}

/// The parity that makes a message whole.
fn parity(content: &[u8]) -> [u8; 3] {
    let mut remainder = 0_u32;
    for byte in content {
        remainder ^= u32::from(*byte) << 16;
        for _ in 0..8 {
            remainder <<= 1;
            if remainder & 0x100_0000 != 0 {
                remainder ^= 0x1FF_F409;
            }
        }
    }
    let [_, a, b, c] = remainder.to_be_bytes();
    [a, b, c]
}

fuzz_target!(|bytes: &[u8]| {
    let mut stream = Stream::default();
    stream.push(bytes, 0.0, check);
    let mut frames = Vec::new();
    for (content, second) in bytes.chunks_exact(11).zip(0_u32..) {
        let mut message = content.to_vec();
        message[0] = if content[0] & 0x80 == 0 {
            17 << 3
        } else {
            18 << 3
        } | content[0] & 7;
        // Few addresses, so that halves of positions meet.
        message[1..4].copy_from_slice(&[0xA0, 0, content[3] & 1 | 2]);
        let tail = parity(&message);
        message.extend(tail);
        frames.clear();
        push_frame(&mut frames, 0, 0, &message);
        stream.push(&frames, f64::from(second), check);
    }
    assert!(stream.aircraft() <= 4096);
});

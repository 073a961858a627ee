//! GDL 90 messages: the examples of the specification, and damage.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "tests fail by panicking"
)]

use fga_formats::tally::{LeftOut, Tally};
use fga_formats::traffic::gdl90::Datagrams;
use fga_formats::traffic::{Altitude, NON_ICAO, TrafficReport};
use proptest::prelude::*;

/// The heartbeat of 2.2.4, with its flags and its checksum.
const HEARTBEAT: [u8; 11] = [
    0x7E, 0x00, 0x81, 0x41, 0xDB, 0xD0, 0x08, 0x02, 0xB3, 0x8B, 0x7E,
];
/// The traffic report of 3.5.4.
const TRAFFIC: [u8; 28] = [
    0x14, 0x00, 0xAB, 0x45, 0x49, 0x1F, 0xEF, 0x15, 0xA8, 0x89, 0x78, 0x0F, 0x09, 0xA9, 0x07, 0xB0,
    0x01, 0x20, 0x01, 0x4E, 0x38, 0x32, 0x35, 0x56, 0x20, 0x20, 0x20, 0x00,
];

/// A message as it is sent: with the checksum by the table of 2.2.3, which the reader does not use, escapes and flags.
fn sent(message: &[u8]) -> Vec<u8> {
    let table: Vec<u16> = (0..256_u32)
        .map(|index| {
            let by = |sum: u32, _| (sum << 1) ^ if sum & 0x8000 != 0 { 0x1021 } else { 0 };
            (0..8).fold(index << 8, by) as u16
        })
        .collect();
    let sum = message.iter().fold(0_u16, |sum, byte| {
        table[usize::from(sum >> 8)] ^ (sum << 8) ^ u16::from(*byte)
    });
    let mut bytes = vec![0x7E];
    for byte in message.iter().copied().chain(sum.to_le_bytes()) {
        if matches!(byte, 0x7D | 0x7E) {
            bytes.extend([0x7D, byte ^ 0x20]);
        } else {
            bytes.push(byte);
        }
    }
    bytes.push(0x7E);
    bytes
}

fn read(bytes: &[u8]) -> (Vec<TrafficReport>, Tally) {
    let mut stream = Datagrams::default();
    let mut reports = Vec::new();
    stream.push(bytes, |report| reports.push(report));
    stream.reconnect();
    (reports, stream.tally())
}

/// The report of a message that differs from the specification's in some bytes.
fn changed(changes: &[(usize, u8)]) -> Result<TrafficReport, Vec<LeftOut>> {
    let mut message = TRAFFIC;
    for (at, byte) in changes {
        message[*at] = *byte;
    }
    let (reports, tally) = read(&sent(&message));
    let left_out = tally.reasons().map(|(reason, _)| reason);
    reports.first().copied().ok_or(left_out.collect())
}

#[test]
fn the_examples_of_the_specification_mean_what_it_says() {
    assert_eq!(sent(&HEARTBEAT[1..8]), HEARTBEAT);
    let (none, tally) = read(&HEARTBEAT);
    assert!(none.is_empty());
    assert_eq!((tally.left_out(LeftOut::NotNeeded), tally.read()), (1, 1));
    let found = changed(&[]).unwrap();
    assert_eq!(found.address, 0o52_642_511);
    assert_eq!(found.callsign.unwrap().as_str(), "N825V");
    let [latitude_deg, longitude_deg] = found.place_deg.unwrap();
    // One step of the field.
    let step_deg = 180.0 / 8_388_608.0;
    assert!((latitude_deg - 44.907_08).abs() < step_deg);
    assert!((longitude_deg + 122.994_88).abs() < step_deg);
    assert_eq!(found.altitude, Some(Altitude::Pressure(1524.0)));
    assert!((found.ground_speed_mps.unwrap() - 63.277).abs() < 1e-3);
    assert!((found.course_rad.unwrap() - core::f64::consts::FRAC_PI_4).abs() < 1e-12);
    assert!((found.climb_mps.unwrap() - 0.325_12).abs() < 1e-9);
    assert_eq!(found.on_ground, Some(false));
    // The specification calls it an HPL of 20 m and an HFOM of 25 m: the categories 10 and 9.
    assert_eq!(
        (found.containment_m, found.position_error_m),
        (Some(25.0), Some(30.0))
    );
}

#[test]
fn what_a_report_does_not_know_is_unknown() {
    let found = changed(&[(11, 0xFF), (12, 0xF9)]).unwrap();
    assert_eq!(found.altitude, None);
    let found = changed(&[(14, 0xFF), (15, 0xF8), (16, 0x00)]).unwrap();
    assert_eq!((found.ground_speed_mps, found.climb_mps), (None, None));
    // A heading is no track, and a descent is negative.
    let found = changed(&[(12, 0x0A), (15, 0xBF), (16, 0xFF)]).unwrap();
    assert_eq!(
        (found.course_rad, found.ground_velocity_mps()),
        (None, None)
    );
    assert!((found.climb_mps.unwrap() + 0.325_12).abs() < 1e-9);
    // Latitude, longitude and integrity of 0 are no place; with an integrity they are one.
    let nowhere = [(5, 0), (6, 0), (7, 0), (8, 0), (9, 0), (10, 0)];
    assert_eq!(changed(&nowhere).unwrap().place_deg, Some([0.0, 0.0]));
    let found = changed(&[&nowhere[..], &[(13, 0x09)]].concat()).unwrap();
    assert_eq!(
        (found.place_deg, found.containment_m),
        (None, Some(f64::INFINITY))
    );
    assert_eq!(changed(&[(12, 0x01)]).unwrap().on_ground, Some(true));
    assert_eq!(changed(&[(1, 0x03)]).unwrap().address, NON_ICAO | 0xAB_4549);
    for (changes, reason) in [
        (&[(1, 0x05)][..], LeftOut::NotNeeded),
        (&[(1, 0x0E)], LeftOut::UnreadableField),
        (&[(2, 0), (3, 0), (4, 0)], LeftOut::NoAddress),
        // Beyond the pole.
        (&[(5, 0x5F)], LeftOut::UnreadableField),
        (&[(0, 0x7C)], LeftOut::UnknownKind),
        (&[(0, 0x0A)], LeftOut::NotNeeded),
    ] {
        assert_eq!(changed(changes).unwrap_err(), [reason], "{changes:?}");
    }
}

#[test]
fn damaged_messages_are_counted_by_their_cause() {
    let good = sent(&TRAFFIC);
    let count = |bytes: &[u8]| {
        let (reports, tally) = read(bytes);
        let left_out: Vec<_> = tally.reasons().collect();
        (reports.len(), left_out)
    };
    // Each bit of a message.
    for bit in 8..8 * (good.len() - 1) {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(count(&bytes).0, 0, "{bit}");
        assert!(!count(&bytes).1.is_empty(), "{bit}");
    }
    assert_eq!(count(&good[5..]), (0, vec![(LeftOut::CutShort, 1)]));
    assert_eq!(count(&good[..20]), (0, vec![(LeftOut::CutShort, 1)]));
    assert_eq!(
        count(&sent(&TRAFFIC[..20])),
        (0, vec![(LeftOut::UnreadableField, 1)])
    );
    assert_eq!(
        count(&[0x7E, 0x14, 0x7E]),
        (0, vec![(LeftOut::CutShort, 1)])
    );
    let endless = [vec![0x7E], vec![1; 5000], good.clone()].concat();
    assert_eq!(count(&endless), (1, vec![(LeftOut::TooLong, 1)]));
    // Several in a datagram, also with one flag between them.
    assert_eq!(count(&[&good[..], &good, &HEARTBEAT].concat()).0, 2);
    assert_eq!(count(&[&good[..], &good[1..]].concat()).0, 2);
}

proptest! {
    #[test]
    fn a_stream_is_the_same_however_it_is_cut(
        bytes in prop::collection::vec(prop_oneof![4 => any::<u8>(), 1 => Just(0x7E_u8)], 0..300),
        size in 1_usize..40,
    ) {
        let bytes = [bytes, sent(&TRAFFIC)].concat();
        let mut stream = Datagrams::default();
        let mut reports = Vec::new();
        for part in bytes.chunks(size) {
            stream.push(part, |report| reports.push(report));
        }
        stream.reconnect();
        prop_assert_eq!((reports, stream.tally()), read(&bytes));
    }
}

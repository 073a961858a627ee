//! Sentences of FLARM, with checksums that are made here.

use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::tally::LeftOut;
use fga_formats::traffic::flarm::Sentences;
use fga_formats::traffic::{Altitude, NON_ICAO, TrafficReport};
use proptest::prelude::*;

const OWN: &str = "GPGGA,120000,4530.000,N,00515.000,E,1,08,1.0,1000.0,M,48.0,M,,";

fn sentence(content: &str) -> String {
    let sum = content.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${content}*{sum:02X}\r\n")
}

fn reports(sentences: &mut Sentences, contents: &[&str]) -> Vec<TrafficReport> {
    let mut found = Vec::new();
    for content in contents {
        sentences.push(sentence(content).as_bytes(), |report| found.push(report));
    }
    found
}

#[test]
fn an_aircraft_is_where_its_distances_from_the_own_place_put_it() {
    let mut sentences = Sentences::default();
    let found = reports(
        &mut sentences,
        &[
            OWN,
            "PFLAU,2,1,2,1,0,,0,,,",
            "PFLAA,0,1200,-3400,150,1,4B5C6D,90,,40,-1.5,1",
        ],
    );
    let [report] = &found[..] else {
        panic!("{found:?}");
    };
    let own = Geodetic::new(45.5, 5.25, 0.0).unwrap();
    let [latitude, longitude] = report.place_deg.unwrap();
    let place = Geodetic::new(latitude, longitude, 0.0).unwrap();
    let away_m = LocalFrame::new(own, Earth::Wgs84).to_local_m(place);
    assert!((away_m.x + 3400.0).abs() < 1e-3 && (away_m.y - 1200.0).abs() < 1e-3);
    assert_eq!(report.address, 0x4B_5C6D);
    assert_eq!(report.altitude, Some(Altitude::Ellipsoid(1198.0)));
    let velocity = report.ground_velocity_mps().unwrap();
    assert!((velocity[0] - 40.0).abs() < 1e-9 && velocity[1].abs() < 1e-9);
    assert_eq!(report.climb_mps, Some(-1.5));
    // A pressure altitude comes first; a number that is drawn is none of the ICAO; standing still has no course.
    let found = reports(
        &mut sentences,
        &[
            "PGRMZ,3281,F,2",
            "PFLAA,2,0,500,-20,2,DD8451!FLRDD8451,,,0,,8,0,0,-70.5",
        ],
    );
    assert_eq!(found[0].address, 0xDD_8451 | NON_ICAO);
    let altitude_m = found[0].altitude.unwrap();
    assert!(matches!(altitude_m, Altitude::Pressure(m) if (m - 980.05).abs() < 0.01));
    assert_eq!((found[0].course_rad, found[0].climb_mps), (None, None));
}

#[test]
fn what_cannot_be_placed_is_counted_by_its_reason() {
    let target = "PFLAA,0,100,200,10,1,4B5C6D,90,,40,0,1";
    for (contents, reason) in [
        (&[target][..], LeftOut::NoPosition),
        (
            &[OWN, "PFLAA,0,900,,10,1,4B5C6D,,,,,0"],
            LeftOut::NoPosition,
        ),
        (
            &[OWN, "PFLAU,", "PFLAU,", "PFLAU,", "PFLAU,", target],
            LeftOut::NoPosition,
        ),
        (
            &[OWN, "GPGGA,120001,,,,,0,,,,M,,M,,", target],
            LeftOut::NoPosition,
        ),
        (
            &[OWN, "PFLAA,0,100,200,10,1,,90,,40,0,1"],
            LeftOut::NoAddress,
        ),
        (
            &[OWN, "PFLAA,0,100,x,10,1,4B5C6D,90,,40,0,1"],
            LeftOut::UnreadableField,
        ),
        (&[OWN, "PFLAA,0,100"], LeftOut::UnreadableField),
        (
            &[OWN, "PFLAA,0,100,900000,10,1,4B5C6D,90,,40,0,1"],
            LeftOut::Jump,
        ),
        (
            &["GPGGA,120000,9930.0,N,00515.0,E,1,8,1,9,M,8,M,,"],
            LeftOut::UnreadableField,
        ),
    ] {
        let mut sentences = Sentences::default();
        assert!(reports(&mut sentences, contents).is_empty(), "{contents:?}");
        let tally = sentences.tally();
        assert_eq!(
            (tally.left_out(reason), tally.lost()),
            (1, 1),
            "{contents:?}"
        );
    }
    let mut sentences = Sentences::default();
    sentences.push(
        b"$PFLAA,0,1*00\r\n$PFLAA,0\r\nnoise\r\n\r\n$PFLAA,0",
        |_| (),
    );
    sentences.reconnect();
    let tally = sentences.tally();
    assert_eq!(tally.left_out(LeftOut::WrongChecksum), 1);
    assert_eq!(tally.left_out(LeftOut::CutShort), 2);
    assert_eq!(tally.left_out(LeftOut::UnknownKind), 1);
}

proptest! {
    /// No bytes stop the reader, however they are cut; each line is counted once.
    #[test]
    fn any_bytes_are_counted(
        lines in prop::collection::vec("[$!]?(PFLAA|GPGGA|PGRMZ)?[,0-9NSEWMF.*-]{0,40}", 0..20),
        cut in 1_usize..9,
    ) {
        let text = lines.concat() + &lines.join("\n") + &sentence(&lines.concat());
        let mut sentences = Sentences::default();
        for part in text.as_bytes().chunks(cut) {
            sentences.push(part, |report| {
                assert!(report.place_deg.unwrap().iter().all(|degrees| degrees.is_finite()));
            });
        }
        let count = text.bytes().filter(|byte| *byte == b'\n').count();
        prop_assert_eq!(sentences.tally().read(), count as u64);
    }
}

//! Changed inputs of each reader: bytes and words. `FGA_MUTATIONS=100000` for many.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "tests fail by panicking"
)]

use std::path::Path;

use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::Given;
use fga_formats::traffic::flarm::Sentences;
use fga_formats::{InputError, areas, flight_log, missions, recordings, terrain};

/// A generator that needs no crate: splitmix64.
struct Draws(u64);

impl Draws {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as usize % below.max(1)
    }
}

/// What stands in for a word: other units, signs, nulls, names, numbers out of range.
const WORDS: [&str; 24] = [
    "null",
    "-1",
    "0",
    "1e308",
    "NaN",
    "FT",
    "M",
    "FL",
    "AGL",
    "STD",
    "UNL",
    "",
    "lowerLimit",
    "upper_limit_unit",
    "Polygon",
    "Point",
    "-180",
    "180.1",
    "90",
    "[]",
    "{}",
    "true",
    "\"ground\"",
    "99999999999999999999",
];

fn changed(seed: &[u8], draws: &mut Draws) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=draws.next(3) {
        if bytes.is_empty() {
            break;
        }
        match draws.next(4) {
            0 => {
                let at = draws.next(bytes.len());
                bytes[at] = draws.next(256) as u8;
            }
            1 => {
                let (from, to) = (draws.next(bytes.len()), draws.next(bytes.len()));
                let part = bytes[from.min(to)..from.max(to)].to_vec();
                let at = draws.next(bytes.len());
                bytes.splice(at..at, part.into_iter().take(200));
            }
            2 => {
                let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b".-+_".contains(byte);
                let at = draws.next(bytes.len());
                let before = bytes[..at]
                    .iter()
                    .rev()
                    .take_while(|byte| is_word(byte))
                    .count();
                let after = bytes[at..].iter().take_while(|byte| is_word(byte)).count();
                let word = WORDS[draws.next(WORDS.len())];
                bytes.splice(at - before..at + after, word.bytes());
            }
            _ => bytes.truncate(draws.next(bytes.len() + 1)),
        }
    }
    bytes
}

fn one_line<T>(read: &Result<T, InputError>) {
    if let Err(error) = read {
        assert!(!error.message.contains('\n'), "{error}");
    }
}

fn areas_of(text: &str) {
    let read = areas::parse(text, Path::new("a"));
    one_line(&read);
    for area in read.map(|file| file.areas).unwrap_or_default() {
        let limits = area.limits.iter().flatten();
        assert!(limits.map(|limit| limit.height_m).all(f64::is_finite));
        let _ = area.check();
        let origin = Geodetic::new(45.0, 5.0, 0.0).unwrap();
        for keep_in in [false, true] {
            let plane = area.on_plane(&LocalFrame::new(origin, Earth::Wgs84), keep_in);
            let mut corners = plane.polygons.iter().flatten().flatten();
            assert!(corners.all(|at| at.is_finite()));
        }
    }
}

const SEEDS: [&str; 9] = [
    r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a","lower":"60 m AMSL","upperLimit":{"value":65,"unit":6,"referenceDatum":2}},"geometry":{"type":"Polygon","coordinates":[[[5.0,45.0],[5.1,45.0],[5.1,45.1],[5.0,45.0]],[[5.06,45.01],[5.07,45.01],[5.07,45.02],[5.06,45.01]]]}},{"type":"Feature","properties":{"restriction":"NO_RESTRICTION","geometry":{"uomDimensions":"M","lowerLimit":60,"lowerVerticalReference":"AMSL"}},"geometry":{"type":"Point","coordinates":[5.0,45.0]}}]}"#,
    "<kml><Placemark><name>a</name><ExtendedData><Data name=\"upper\"><value>120 m AGL</value></Data></ExtendedData><Polygon><altitudeMode>absolute</altitudeMode><outerBoundaryIs><LinearRing><coordinates>5,45,9 5.1,45,9 5.1,45.1,9 5,45,9</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></kml>",
    "* made\nAC R\nAN TEST\nAH 2000ft MSL\nAL GND\nV X=45:00:00 N 005:01:48 E\nDC 0.3\n\nAC D\nAN Arc\nAL 1500ft AGL\nAH FL65\nDP 45:00:00 N 005:00:00 E\nV X=45:00:00 N 005:06:00 E\nV D=+\nDB 45:06:00 N 005:06:00 E, 45:00:00 N 005:12:00 E\nDA 5,270,290\n",
    "<m:AIXMBasicMessage xmlns:m=\"m\"><AirspaceTimeSlice><name>a</name><AirspaceGeometryComponent><AirspaceVolume><upperLimit uom=\"FL\">65</upperLimit><upperLimitReference>STD</upperLimitReference><horizontalProjection srsName=\"urn:ogc:def:crs:EPSG::4326\"><exterior><ArcByCenterPoint><pos>45 5</pos><radius uom=\"km\">10</radius><startAngle>0</startAngle><endAngle>90</endAngle></ArcByCenterPoint><GeodesicString><posList>45 5.1 45 5</posList></GeodesicString></exterior></horizontalProjection></AirspaceVolume></AirspaceGeometryComponent></AirspaceTimeSlice></m:AIXMBasicMessage>",
    "45.0 5.0\n45.01 5.01\n44.99 5.01\n44.99 4.99\n45.01 4.99\n45.01 5.01\n",
    "QGC WPL 110\n0 1 3 16 0 0 0 0 45.0 5.0 343 1\n1 0 3 5001 3 1 0 0 45.0 5.0 0 1\n2 0 3 5001 3 1 0 0 45.1 5.0 0 1\n3 0 3 5001 3 1 0 0 45.1 5.1 0 1\n4 0 0 16 0 0 0 0 45.01 5 16 1\n",
    "time,icao24,lat,lon,velocity,heading,vertrate,callsign,onground,baroaltitude,geoaltitude,lastposupdate\n1700000000,aa0001,45.0,5.0,51.4,90,0,T,False,914.4,950,1700000000.0\n1700000001,aa0001,45.0,5.001,51.4,90,0,T,False,914.4,950,1700000001.0\n1700000000,aa0002,45.0,5.01,51.4,270,0,T,False,914.4,950,\n",
    r#"{"now":1700000000.0,"aircraft":[{"hex":"aa0001","altitude":3000,"speed":100,"track":90,"vert_rate":0,"lat":45.0,"lon":4.96,"seen_pos":0.1}]} {"icao":"aa0002","timestamp":1700000000,"trace":[[0,45.0,4.9,3000,99.9,90,8,0,null,"adsb_icao",3117,64,null,null],[1,45.0,4.91,"ground",9,90,0,0,{"flight":"T"},"mlat",null,null]]}"#,
    "00:00:00.00>ASAS ON\n00:00:00.00>CRE KL1,B744,45.0,4.9,90,FL030,100\n00:00:01.00>CRE KL2,B744,45.0,5.0,270,3000ft,M.2\n00:00:40>HDG KL1,90\n",
];

#[test]
fn changed_inputs_are_read_or_refused_in_one_line() {
    let count: usize = std::env::var("FGA_MUTATIONS").map_or(400, |count| count.parse().unwrap());
    let mut draws = Draws(7);
    let path = Path::new("a");
    for (seed, text) in SEEDS.iter().enumerate() {
        for _ in 0..count {
            let bytes = changed(text.as_bytes(), &mut draws);
            let text = String::from_utf8_lossy(&bytes);
            match seed {
                0..=4 => areas_of(&text),
                5 => {
                    one_line(&missions::parse(&text, path));
                    areas_of(&text);
                }
                _ => {
                    one_line(&recordings::parse(&bytes, path));
                    let received = recordings::parse_content(&bytes, path);
                    one_line(&received);
                }
            }
            one_line(&flight_log::parse(&bytes, path));
        }
    }
    let files: [&[u8]; 2] = [
        include_bytes!("terrain/masked.tif"),
        include_bytes!("terrain/utm.tif"),
    ];
    let path = Path::new("a.tif");
    for seed in files {
        for _ in 0..count {
            let bytes = changed(seed, &mut draws);
            one_line(&terrain::parse(&bytes, path, &Given::default()));
        }
    }
    let log = super::flight_log::ulog();
    for _ in 0..count {
        one_line(&flight_log::parse(&changed(&log, &mut draws), path));
    }
    let feed = b"$GPGGA,120000,4530.0,N,00515.0,E,1,8,1,9,M,8,M,,*54\n$PFLAA,0,1200,-3400,150,1,4B5C6D,90,,40,-1.5,1*23\n";
    for _ in 0..count {
        let bytes = changed(feed, &mut draws);
        let mut sentences = Sentences::new();
        sentences.push(&bytes, |report| {
            assert!(
                report
                    .place_deg
                    .unwrap()
                    .iter()
                    .all(|degrees| degrees.is_finite())
            );
        });
    }
}

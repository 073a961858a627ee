//! Changed inputs of each reader: bytes and words. `FGA_MUTATIONS=1000000` for many of each.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "tests fail by panicking"
)]

use core::time::Duration;
use std::io::{Cursor, Write as _};
use std::path::Path;
use std::time::Instant;

use fga_formats::flight::Flight;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::Given;
use fga_formats::traffic::flarm::Sentences;
use fga_formats::traffic::gdl90::Datagrams;
use fga_formats::traffic::{TrafficReport, sbs};
use fga_formats::{
    InputError, areas, conf, daa, encounter_model, encounters, flight_log, missions, recordings,
    terrain,
};

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

/// Longer than this a reader takes for no input of some kilobytes.
const LONGEST: Duration = Duration::from_secs(10);

fn mutations() -> usize {
    std::env::var("FGA_MUTATIONS").map_or(1000, |count| count.parse().unwrap())
}

/// Gives a reader changed inputs: as many as asked for, in turn from each seed.
fn mutate(seeds: &[&[u8]], take: impl Fn(&[u8])) {
    let count = mutations();
    let mut draws = Draws(7);
    for seed in seeds {
        take(seed);
    }
    for index in 0..count {
        let bytes = changed(seeds[index % seeds.len()], &mut draws);
        let begin = Instant::now();
        take(&bytes);
        let taken = begin.elapsed();
        assert!(
            taken < LONGEST,
            "{taken:?} for {:?}",
            String::from_utf8_lossy(&bytes)
        );
    }
}

/// The same of texts.
fn mutate_texts(seeds: &[&str], take: impl Fn(&str)) {
    let seeds: Vec<&[u8]> = seeds.iter().map(|seed| seed.as_bytes()).collect();
    mutate(&seeds, |bytes| take(&String::from_utf8_lossy(bytes)));
}

fn one_line<T>(read: Result<T, InputError>) -> Option<T> {
    read.inspect_err(|error| assert!(!error.message.contains('\n'), "{error}"))
        .ok()
}

fn is_sane(report: &TrafficReport) {
    let place = report.place_deg.into_iter().flatten();
    let numbers = place.chain(report.ground_speed_mps).chain(report.climb_mps);
    assert!(numbers.into_iter().all(f64::is_finite), "{report:?}");
}

fn areas_of(text: &str) {
    let read = one_line(areas::parse(text, Path::new("a")));
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

fn recording_of(bytes: &[u8]) {
    let path = Path::new("a");
    let read = one_line(recordings::parse(bytes, path));
    let samples = read.iter().flat_map(|read| &read.named);
    let samples = samples.flat_map(|named| &named.recording.aircraft);
    let mut samples = samples.flat_map(|track| &track.samples);
    assert!(samples.all(|sample| sample.position_m.is_finite() && sample.time_s.is_finite()));
    one_line(recordings::parse_content(bytes, path));
}

fn log_of(bytes: &[u8]) {
    one_line(flight_log::parse(bytes, Path::new("a")));
    recording_of(bytes);
}

#[test]
fn geojson_and_ed318() {
    mutate_texts(
        &[
            r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a","lower":"60 m AMSL","upperLimit":{"value":65,"unit":6,"referenceDatum":2}},"geometry":{"type":"Polygon","coordinates":[[[5.0,45.0],[5.1,45.0],[5.1,45.1],[5.0,45.0]],[[5.06,45.01],[5.07,45.01],[5.07,45.02],[5.06,45.01]]]}},{"type":"Feature","properties":{"restriction":"NO_RESTRICTION","geometry":{"uomDimensions":"M","lowerLimit":60,"lowerVerticalReference":"AMSL"}},"geometry":{"type":"Point","coordinates":[5.0,45.0]}}]}"#,
            r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":[{"text":"a"}],"limitedApplicability":[{}]},"geometry":{"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[5.0,45.0],"extent":{"subType":"Circle","radius":300},"layer":{"lower":0,"lowerReference":"AGL","upper":120,"upperReference":"AMSL","uom":"ft"}},{"type":"Polygon","coordinates":[[[5.0,45.0],[5.1,45.0],[5.0,45.1],[5.1,45.1],[5.0,45.0]]]}]}}]}"#,
        ],
        areas_of,
    );
}

#[test]
fn ed269() {
    mutate_texts(
        &[
            r#"{"features":[{"identifier":"A","restriction":"PROHIBITED","applicability":[{"permanent":"NO"}],"geometry":[{"uomDimensions":"M","lowerLimit":0,"lowerVerticalReference":"AGL","upperLimit":120,"upperVerticalReference":"WGS84","horizontalProjection":{"type":"Polygon","coordinates":[[[5.0,45.0],[5.1,45.0],[5.1,45.1],[5.05,44.99],[5.0,45.0]]]}},{"uomDimensions":"FT","horizontalProjection":{"type":"Circle","center":[5.0,45.0],"radius":500}}]}]}"#,
        ],
        areas_of,
    );
}

#[test]
fn kml() {
    mutate_texts(
        &[
            "<kml><Placemark><name>a</name><ExtendedData><Data name=\"upper\"><value>120 m AGL</value></Data></ExtendedData><Polygon><altitudeMode>absolute</altitudeMode><outerBoundaryIs><LinearRing><coordinates>5,45,9 5.1,45,9 5.1,45.1,9 5,45,9</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></kml>",
        ],
        areas_of,
    );
}

#[test]
fn openair() {
    mutate_texts(
        &[
            "* made\nAC R\nAN TEST\nAH 2000ft MSL\nAL GND\nV X=45:00:00 N 005:01:48 E\nDC 0.3\n\nAC D\nAN Arc\nAL 1500ft AGL\nAH FL65\nDP 45:00:00 N 005:00:00 E\nV X=45:00:00 N 005:06:00 E\nV D=+\nDB 45:06:00 N 005:06:00 E, 45:00:00 N 005:12:00 E\nDA 5,270,290\n",
        ],
        areas_of,
    );
}

#[test]
fn aixm() {
    mutate_texts(
        &[
            "<m:AIXMBasicMessage xmlns:m=\"m\"><AirspaceTimeSlice><name>a</name><AirspaceGeometryComponent><AirspaceVolume><upperLimit uom=\"FL\">65</upperLimit><upperLimitReference>STD</upperLimitReference><horizontalProjection srsName=\"urn:ogc:def:crs:EPSG::4326\"><exterior><ArcByCenterPoint><pos>45 5</pos><radius uom=\"km\">10</radius><startAngle>0</startAngle><endAngle>90</endAngle></ArcByCenterPoint><GeodesicString><posList>45 5.1 45 5</posList></GeodesicString></exterior></horizontalProjection></AirspaceVolume></AirspaceGeometryComponent></AirspaceTimeSlice></m:AIXMBasicMessage>",
        ],
        areas_of,
    );
}

#[test]
fn missions_and_fences() {
    let plan = r#"{"fileType":"Plan","version":1,"mission":{"version":2,"plannedHomePosition":[45.0,5.0,300],"cruiseSpeed":15,"items":[{"type":"SimpleItem","command":22,"frame":3,"params":[15,0,0,null,45.0,5.0,50],"doJumpId":1},{"type":"ComplexItem","complexItemType":"fwLandingPattern","altitudesAreRelative":true,"landingApproachCoordinate":[45.01,5.0,40]}]},"geoFence":{"version":2,"circles":[{"circle":{"center":[45.0,5.0],"radius":900},"inclusion":true}],"polygons":[{"polygon":[[45.0,5.0],[45.1,5.0],[45.1,5.1]],"inclusion":false}]},"rallyPoints":{"version":2,"points":[[45.0,5.0,60]]}}"#;
    mutate_texts(
        &[
            "45.0 5.0\n45.01 5.01\n44.99 5.01\n44.99 4.99\n45.01 4.99\n45.01 5.01\n",
            "QGC WPL 110\n0 1 3 16 0 0 0 0 45.0 5.0 343 1\n1 0 3 5001 3 1 0 0 45.0 5.0 0 1\n2 0 3 5001 3 1 0 0 45.1 5.0 0 1\n3 0 3 5001 3 1 0 0 45.1 5.1 0 1\n4 0 0 16 0 0 0 0 45.01 5 16 1\n",
            plan,
        ],
        |text| {
            one_line(missions::parse(text, Path::new("a")));
            areas_of(text);
        },
    );
}

#[test]
fn state_vectors() {
    mutate_texts(
        &[
            "time,icao24,lat,lon,velocity,heading,vertrate,callsign,onground,baroaltitude,geoaltitude,lastposupdate\n1700000000,aa0001,45.0,5.0,51.4,90,0,T,False,914.4,950,1700000000.0\n1700000001,aa0001,45.0,5.001,51.4,90,0,T,False,914.4,950,1700000001.0\n1700000000,aa0002,45.0,5.01,51.4,270,0,T,False,914.4,950,\n",
            r#"{"now":1700000000.0,"aircraft":[{"hex":"aa0001","altitude":3000,"speed":100,"track":90,"vert_rate":0,"lat":45.0,"lon":4.96,"seen_pos":0.1}]} {"icao":"aa0002","timestamp":1700000000,"trace":[[0,45.0,4.9,3000,99.9,90,8,0,null,"adsb_icao",3117,64,null,null],[1,45.0,4.91,"ground",9,90,0,0,{"flight":"T"},"mlat",null,null]]}"#,
            r#"{"time":1700000000,"states":[["aa0001","T","F",1700000000,1700000000,5.0,45.0,914.4,false,51.4,90,0,null,950,"1000",false,0]]} [{"icao24":"aa0001","timestamp":1700000000000,"latitude":45.0,"longitude":5.0,"altitude":3000,"groundspeed":100,"track":90,"vertical_rate":0,"onground":false}]"#,
        ],
        |text| recording_of(text.as_bytes()),
    );
}

#[test]
fn scenarios_of_bluesky() {
    mutate_texts(
        &[
            "00:00:00.00>ASAS ON\n00:00:00.00>CRE KL1,B744,45.0,4.9,90,FL030,100\n00:00:01.00>CRE KL2,B744,45.0,5.0,270,3000ft,M.2\n00:00:40>HDG KL1,90\n",
        ],
        |text| recording_of(text.as_bytes()),
    );
}

#[test]
fn recordings_in_rows() {
    let daa = "a = 1\nNAME lat lon alt trk gs vs time alerter s_EW_std\n[none] [deg] [deg] [ft] [deg] [knot] [fpm] [s] [none] [m]\nO 45 5 1000 90 100 0 0 1 3\nI 45 5.1 1000 270 100 0 0 1 3\nO 45 5.01 1000 90 100 0 0:00:01 1 3\n\" 45 5.02 1000 90 100 0 2 1 3\n";
    let degas = "# xE1,xE2,xN1,xN2,h1,h2,vE1,vE2,vN1,vN2,hdot1,hdot2 [ft, ft/s], 1 Hz\n0,9000,0,0,900,900,99,-99,0,0,0,0\n99,8900,0,0,900,900,99,-99,0,0,0,0\n";
    mutate_texts(&[daa, degas], |text| {
        recording_of(text.as_bytes());
        one_line(daa::instants::parse(text, Path::new("a")));
    });
}

#[test]
fn lines_of_base_station() {
    let lines = "MSG,3,1,1,4CA2D6,1,2026/01/01,10:00:00.000,2026/01/01,10:00:00.100,,3700,,,45.0,5.0,,,0,0,0,0\r\nMSG,4,1,1,4CA2D6,1,2026/01/01,10:00:01.000,2026/01/01,10:00:01.100,,,100,90,,,-64,,0,0,0,0\r\n12345,MLAT,3,1,1,~4CA2D7,1,2026/01/01,10:00:02.000,,,\"A,1\",3700H,,,45.0,5.01,,,0,0,0,0,,,30\r\n";
    mutate(&[lines.as_bytes()], |bytes| {
        recording_of(bytes);
        sbs::LineStream::default().push(bytes, |report| is_sane(&report));
    });
}

#[test]
fn sentences_and_datagrams() {
    let feed = b"$GPGGA,120000,4530.0,N,00515.0,E,1,8,1,9,M,8,M,,*54\n$PGRMZ,3000,F,2*06\n$PFLAA,0,1200,-3400,150,1,4B5C6D,90,,40,-1.5,1*23\n";
    let traffic = b"\x7e\x14\x00\xab\x45\x49\x1f\xef\x15\xa8\x89\x78\x0f\x09\xa9\x07\xb0\x01\x20\x01\x4e\x38\x32\x35\x56\x20\x20\x20\x00\x57\xd6\x7e";
    mutate(&[feed.as_slice(), traffic], |bytes| {
        Sentences::default().push(bytes, |report| is_sane(&report));
        Datagrams::default().push(bytes, |report| is_sane(&report));
        #[cfg(feature = "beast")]
        fga_formats::traffic::beast::Stream::default().push(bytes, 0.0, |report| is_sane(&report));
    });
}

#[test]
fn flight_logs() {
    let seeds = super::flight_log::short_logs();
    let seeds: Vec<&[u8]> = seeds.iter().map(Vec::as_slice).collect();
    mutate(&seeds, log_of);
}

fn heights_of(bytes: &[u8], name: &str) {
    let read = one_line(terrain::parse(bytes, Path::new(name), &Given::default()));
    for field in read.iter().flat_map(|file| &file.fields) {
        let (range_m, holes) = field.summary();
        let grid = field.grid();
        assert!(range_m.is_some() || holes == grid.rows * grid.columns);
        assert!(range_m.is_none_or(|range_m| range_m.iter().all(|m| m.abs() <= 9_000.0)));
    }
}

#[test]
fn heights() {
    let files: [(&str, &[u8]); 6] = [
        ("a.tif", include_bytes!("terrain/masked.tif")),
        ("a.tif", include_bytes!("terrain/strips.tif")),
        ("a.tif", include_bytes!("terrain/utm.tif")),
        ("a.tif", include_bytes!("terrain/scaled.tif")),
        ("a.tif", include_bytes!("terrain/tiles.tif")),
        ("N46E009.DAT", include_bytes!("terrain/old.dat")),
    ];
    for (name, seed) in files {
        mutate(&[seed], |bytes| heights_of(bytes, name));
    }
}

/// DTED of lines of 5 heights with the right checksum of each.
fn with_checksums(mut bytes: Vec<u8>) -> Vec<u8> {
    let records = bytes.get_mut(3428..).unwrap_or_default();
    for record in records.chunks_exact_mut(8 + 2 * 5 + 4) {
        let (content, sum) = record.split_at_mut(8 + 2 * 5);
        let total: u32 = content.iter().map(|byte| u32::from(*byte)).sum();
        sum.copy_from_slice(&total.to_be_bytes());
    }
    bytes
}

#[test]
fn dted() {
    let whole = super::terrain::unpacked(include_bytes!("terrain/s30_w178.dt0.gz"));
    let mut small = whole[..3428].to_vec();
    small[47..55].copy_from_slice(b"00030005");
    for line in 0..3_u8 {
        small.extend([0xAA, 0, 0, line, 0, line, 0, 0]);
        small.extend([0, 90, 0x80, 20, 3, line, 0xFF, 0xFF, 0, 7, 0, 0, 0, 0]);
    }
    let small = with_checksums(small);
    let read = terrain::parse(&small, Path::new("a.dt0"), &Given::default()).unwrap();
    assert_eq!(read.fields[0].post_m(3, 0), Some(-20.0));
    mutate(&[&small], |bytes| {
        heights_of(bytes, "a.dt0");
        heights_of(&with_checksums(bytes.to_vec()), "s30_w178.dt0");
    });
}

const SRTM: &[u8] = include_bytes!("terrain/S34W071.hgt.gz");

#[test]
fn packed_srtm() {
    mutate(&[SRTM], |bytes| heights_of(bytes, "S34W071.hgt.gz"));
}

/// A file is large and has no structure, so a hundredth of the changes does.
#[test]
fn srtm() {
    let plain = super::terrain::unpacked(SRTM);
    let mut draws = Draws(9);
    let mut bytes = plain.clone();
    for _ in 0..mutations() / 100 {
        let at = draws.next(bytes.len());
        bytes[at] = draws.next(256) as u8;
        heights_of(&bytes, "S34W071.hgt");
        bytes[at] = plain[at];
    }
    heights_of(&bytes[..bytes.len() - draws.next(4)], "S34W071.hgt");
}

#[test]
fn archives() {
    let kml = "<kml><Placemark><name>a</name><Polygon><outerBoundaryIs><LinearRing><coordinates>5,45,9 5.1,45,9 5.1,45.1,9 5,45,9</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></kml>";
    let archive = |method| {
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        for name in ["files/a.kml", "doc.kml"] {
            archive.start_file(name, options).unwrap();
            archive.write_all(kml.as_bytes()).unwrap();
        }
        archive.finish().unwrap().into_inner()
    };
    let seeds = [
        archive(zip::CompressionMethod::Stored),
        archive(zip::CompressionMethod::Deflated),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.kmz");
    mutate(&[&seeds[0], &seeds[1]], |bytes| {
        std::fs::write(&path, bytes).unwrap();
        one_line(areas::read(&path));
    });
}

#[test]
fn configurations_and_tables() {
    let conf_seed = "lookahead_time = 180 [s]\nleft_hdir = 180 [deg]\nalerters = A\nA_alert_1_region = NEAR\nA_alert_1_alerting_time = 55 [s]\nA_alert_1_detector = d\nA_load_core_detection_d = gov.WCV_TAUMOD\nA_d_WCV_DTHR = 0.66 [nmi]\nA_d_WCV_ZTHR = 450 [ft]\nA_d_WCV_TTHR = 35 [s]\nA_d_WCV_TCOA = 0 [s]\n";
    mutate_texts(&[conf_seed], |text| {
        one_line(conf::parse(text, Path::new("a")));
    });
    let rows = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m,kind\n1,1,100,0,0,-10,0,0,30,uas\n1,2,50,1,0,0,0,0,30,still\n2,1,1,2,3,4,5,6,7,\n";
    mutate_texts(&[rows], |text| {
        one_line(encounters::parse(text.as_bytes(), Path::new("a")));
    });
    mutate_texts(&[super::encounter_model::SMALL], |text| {
        one_line(encounter_model::parse(text, Path::new("a")));
    });
    let flight = r#"{"name":"a","policy":"p","origin":{"latitude_deg":45,"longitude_deg":5,"altitude_m":0},"samples":[{"time_s":0,"position_m":[0,0,0],"course_rad":0,"climb_rad":0,"bank_rad":0,"state":"cruise"}],"obstacles":[{"name":"o","volume":{"radius_m":3},"track":[{"time_s":0,"position_m":[9,9,9]}]}]}"#;
    mutate_texts(&[flight], |text| {
        let read = serde_json::from_str::<Flight>(text).ok();
        let _ = read.map(|flight| flight.check());
    });
}

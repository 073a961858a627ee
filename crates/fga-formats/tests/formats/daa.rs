//! Recordings in the `.daa` format: third-party files against expected output and against other
//! computations, every variant of the format, and every refusal.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::daa::{self, Recording, Track, TrackSample};
use glam::DVec3;
use proptest::prelude::*;
use std::path::Path;

const NAUTICAL_MILE_M: f64 = 1852.0;
const FOOT_M: f64 = 0.3048;
const KNOT_MPS: f64 = 1852.0 / 3600.0;

fn parse(text: &str) -> Result<Recording, String> {
    daa::parse(text, Path::new("a.daa")).map_err(|error| error.to_string())
}

/// The row of an aircraft at exactly this time.
fn row_at(track: &Track, time_s: f64) -> Option<&TrackSample> {
    track.samples.iter().find(|row| row.time_s == time_s)
}

/// DAIDALUS's own output for this file: columns 9 and 10 are the separations at each row.
#[test]
fn separations_equal_those_of_daidalus_row_by_row() {
    let (Some(recording), Some(gold)) = (
        data("daidalus/H1.daa"),
        data("daidalus/gold/DaidalusqAlerting-no_sum.csv"),
    ) else {
        return;
    };
    let recording = daa::read(&recording).unwrap();
    let gold = std::fs::read_to_string(gold).unwrap();
    let mut rows = 0;
    for line in gold.lines().skip(2).filter(|line| !line.trim().is_empty()) {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let time_s: f64 = fields[0].parse().unwrap();
        let horizontal_nmi: f64 = fields[8].parse().unwrap();
        let vertical_ft: f64 = fields[9].parse().unwrap();
        // The file has six decimals: half a unit of the last one, plus the rounding of the input.
        let [own, other] = [0, 1].map(|i| row_at(&recording.aircraft[i], time_s).unwrap());
        let found = Recording::separation(own, other);
        let difference = (found.horizontal_m / NAUTICAL_MILE_M - horizontal_nmi).abs();
        assert!(difference < 6e-7, "{time_s} s: {difference} nmi");
        assert!((found.vertical_m / FOOT_M - vertical_ft).abs() < 1e-6);
        // The single fixed frame differs from it by less than 20 parts per million.
        let offset_m = other.position_m - own.position_m;
        let fixed_m = offset_m.x.hypot(offset_m.y);
        let relative = fixed_m / (horizontal_nmi * NAUTICAL_MILE_M) - 1.0;
        assert!(relative.abs() < 2e-5, "{time_s} s: {relative}");
        rows += 1;
    }
    assert_eq!(rows, 230);
}

#[test]
fn optional_columns_are_read_where_they_have_values() {
    let head = "NAME sx sy sz trk gs vs heading airspeed time s_EW_std v_NS_std";
    let units = "- [m] [m] [m] [deg] [m/s] [m/s] [deg] [kn] [s] [ft] [m/s]";
    let text = format!(
        "{head}\n{units}\nA, 0, 0, 0, 90, 50, 0, 90, 100, 0, 10, 2\nA, 50, 0, 0, 90, 50, 0, -, , 1, -, 0\n"
    );
    let samples = parse(&text).unwrap().aircraft.remove(0).samples;
    let air_mps = samples[0].air_mps.unwrap();
    assert!((air_mps - DVec3::X * (100.0 * KNOT_MPS)).length() < 1e-9);
    assert!((samples[0].deviation.east_m - 10.0 * FOOT_M).abs() < 1e-12);
    assert_eq!(samples[0].deviation.north_mps, 2.0);
    assert_eq!(samples[1].air_mps, None);
    assert_eq!(samples[1].deviation, fga_alerts::Deviation::default());
    let without_units = text.replacen(units, "", 1);
    assert_eq!(
        parse(&without_units).unwrap_err(),
        "a.daa, line 3: column s_ew_std has no unit, expected one such as m, ft, nmi or km in a line of units"
    );
    let negative = text.replace("100, 0, 10,", "100, 0, -10,");
    assert_eq!(
        parse(&negative).unwrap_err(),
        "a.daa, line 3: column s_ew_std is negative, expected a deviation of 0 or more"
    );
}

/// Distance on the ellipsoid by its radii of curvature at the mean latitude (good to 1e-5 of the
/// distance up to 100 km), and vertical distance, metres.
fn ellipsoid_distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    let e2 = 0.006_694_379_990_14;
    let mean = f64::midpoint(a[0], b[0]).to_radians();
    let w2 = 1.0 - e2 * mean.sin().powi(2);
    let meridian = 6_378_137.0 * (1.0 - e2) / w2.powf(1.5);
    let normal = 6_378_137.0 / w2.sqrt();
    let north = meridian * (b[0] - a[0]).to_radians();
    let east = normal * mean.cos() * (b[1] - a[1]).to_radians();
    north.hypot(east)
}

/// Great-circle distance by the haversine formula on the sphere of one nautical mile a minute.
fn great_circle_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [a0, a1, b0, b1] = [a[0], a[1], b[0], b[1]].map(f64::to_radians);
    let h = ((b0 - a0) / 2.0).sin().powi(2) + a0.cos() * b0.cos() * ((b1 - a1) / 2.0).sin().powi(2);
    2.0 * 1852.0 * 60.0 * 180.0 / core::f64::consts::PI * h.sqrt().asin()
}

#[test]
fn separations_agree_with_great_circle_and_ellipsoid() {
    for (name, rows) in [("C0_0_120", 121), ("C1_0_120", 121), ("H1", 230)] {
        let Some(path) = data(&format!("daidalus/{name}.daa")) else {
            return;
        };
        let recording = daa::read(&path).unwrap();
        assert_eq!(recording.aircraft.len(), 2);
        let [own, other] = [0, 1].map(|i| &recording.aircraft[i]);
        assert_eq!(
            (own.name.as_str(), other.name.as_str()),
            ("Ownship", "Intruder")
        );
        assert_eq!(
            (own.samples.len(), other.samples.len()),
            (rows, rows),
            "{name}"
        );
        for (own, other) in own.samples.iter().zip(&other.samples) {
            let place =
                |s: &daa::TrackSample| s.place.map(|p| [p.latitude_deg, p.longitude_deg]).unwrap();
            let offset_m = other.position_m - own.position_m;
            let found_m = offset_m.x.hypot(offset_m.y);
            let sphere_m = great_circle_m(place(own), place(other));
            let ellipsoid_m = ellipsoid_distance_m(place(own), place(other));
            assert!(
                (found_m - sphere_m).abs() < 1e-4 * sphere_m + 0.01,
                "{name} {found_m} {sphere_m}"
            );
            assert!(
                (found_m - ellipsoid_m).abs() <= 5e-3 * ellipsoid_m,
                "{name} {found_m} {ellipsoid_m}"
            );
        }
    }
}

#[test]
fn recorded_velocity_matches_the_recorded_positions() {
    for name in ["C0_0_120", "C1_0_120", "H1"] {
        let Some(path) = data(&format!("daidalus/{name}.daa")) else {
            return;
        };
        let recording = daa::read(&path).unwrap();
        for track in &recording.aircraft {
            for pair in track.samples.windows(2) {
                let chord =
                    (pair[1].position_m - pair[0].position_m) / (pair[1].time_s - pair[0].time_s);
                let speed = pair[0].velocity_mps.length();
                let difference = (chord - pair[0].velocity_mps).length();
                assert!(
                    difference < 2e-3 * speed + 0.2,
                    "{name} {} {difference}",
                    track.name
                );
            }
        }
    }
}

/// Two aircraft that meet head-on on the equator.
const ROWS: &str =
    "Own 0 0 1000 90 100 -60 0\nOther 0 0.5 1000 270 100 0 0\nOwn 0 0.01 990 90 100 -60 10\n";
const NAMES: &str = "name lat lon alt trk gs vs time\n";

fn check(recording: &Recording) {
    let own = &recording.aircraft[0].samples[0];
    let expected = DVec3::new(100.0 * KNOT_MPS, 0.0, -FOOT_M);
    assert!(
        (own.velocity_mps - expected).length() < 1e-9,
        "{}",
        own.velocity_mps
    );
    let other = &recording.aircraft[1].samples[0];
    // Half a degree on the equator: 30 nautical miles of arc, by the sine in the plane.
    let radius_m = 1852.0 * 60.0 * 180.0 / core::f64::consts::PI;
    let x_m = radius_m * 0.5_f64.to_radians().sin();
    assert!((other.position_m - DVec3::new(x_m, 0.0, 0.0)).length() < 1e-6);
    assert_eq!(recording.aircraft[0].samples[1].time_s, 10.0);
    assert!((recording.aircraft[0].samples[1].position_m.z + 10.0 * FOOT_M).abs() < 1e-9);
}

#[test]
fn every_way_to_write_the_same_recording_is_read() {
    let plain = format!("{NAMES}{ROWS}");
    let units = "[none] [deg] [deg] [ft] [deg] [knot] [fpm] [s]\n";
    for text in [
        plain.clone(),
        format!("{NAMES}{units}{ROWS}"),
        format!("\u{feff}# comment\n\n filetype = state \nx = 3 [nmi]\n{NAMES}{units}\n# more\n{ROWS}\n\n").replace('\u{feff}', ""),
        plain.replace('\n', "\r\n"),
        plain.replace(' ', "\t"),
        plain.replace(' ', ", "),
        plain.replace(' ', " ;"),
        plain.replace(' ', ",").replace('\n', ",\n"),
        plain.to_uppercase(),
        plain.replace("name lat lon", "ID Latitude LONG").replace("time", "tm"),
        plain.replace("trk gs vs", "track groundspeed hdot").replace("time", "ST"),
        plain.replace("time", "clock").replace(" 10\n", " 00:00:10\n"),
        // Metres, radians, metres per second, minutes.
        "aircraft time lat lon alt trk gs vs note\n\
         - min rad degrees [m] rad m/s mps unspecified\n\
         Own 0 0 0 304.8 1.5707963267948966 51.444444444444443 -0.3048 a\n\
         Other 0 0 0.5 304.8 4.71238898038469 51.444444444444443 0 b\n\
         Own 0.16666666666666666 0 0.01 301.752 1.5707963267948966 51.444444444444443 -0.3048 c\n".into(),
        // East, north, up velocities beside latitudes; a name repeated by a quote mark.
        "name lat lon alt vx vy vz time\n\
         Other 0 0 0 0 0 0 -1\n".replace("Other", "Own").replace(" -1\n", " 0\n").replace("0 0 0 0 0 0 0\n", "0 0 1000 100 0 -60 0\n")
            + "Other 0 0.5 1000 -100 0 0 0\nOwn 0 0.01 990 100 0 -60 10\n\" 0 0.02 980 100 0 -60 20\n",
    ] {
        check(&parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}")));
    }
    let spaced = parse(&plain.replace(' ', ",").replace("Own", "Own ship 1")).unwrap();
    assert_eq!(spaced.aircraft[0].name, "Own ship 1");
}

#[test]
fn cartesian_positions_stay_as_they_are() {
    let recording = parse(
        "k = v\nName sx sy sz trk gs vs time\nA 1 2 1000 0 10 0 0\nB -1 0 500 90 10 600 5\nA 1 3 1000 0 10 0 10\n",
    )
    .unwrap();
    assert_eq!(recording.parameters, [("k".to_owned(), "v".to_owned())]);
    assert!(recording.frame.is_none());
    let sample = recording.aircraft[0].samples[0];
    assert!((sample.position_m - DVec3::new(1852.0, 3704.0, 304.8)).length() < 1e-9);
    assert!((sample.velocity_mps - DVec3::new(0.0, 10.0 * KNOT_MPS, 0.0)).length() < 1e-9);
    // B has a row only at 5 s, A none at that time: linear between its rows.
    assert!(row_at(&recording.aircraft[0], 5.0).is_none());
    let (position_m, velocity_mps) = recording.aircraft[0].state_at(5.0).unwrap();
    assert!((position_m.y - 2.5 * 1852.0).abs() < 1e-9 && (velocity_mps.y - 185.2).abs() < 1e-9);
    assert!(recording.aircraft[0].state_at(10.5).is_none());
    assert!(recording.aircraft[0].state_at(-0.5).is_none());
    assert!((recording.aircraft[0].state_at(10.0).unwrap().1.y - 185.2).abs() < 1e-9);
    assert_eq!(
        recording.aircraft[1].state_at(5.0).unwrap().0,
        recording.aircraft[1].samples[0].position_m
    );
}

#[test]
#[expect(clippy::too_many_lines, reason = "one line a case")]
fn wrong_files_are_refused_with_file_line_and_reason() {
    let with = |row: &str| format!("{NAMES}{ROWS}{row}\n");
    for (text, message) in [
        (
            String::new(),
            "a.daa: is empty, expected a line of column names",
        ),
        (
            "# only a comment\n".into(),
            "a.daa: is empty, expected a line of column names",
        ),
        (NAMES.into(), "a.daa: holds no rows, expected at least one"),
        (
            format!("{NAMES}[none] [deg] [deg] [ft] [deg] [knot] [fpm] [s]\n"),
            "a.daa: holds no rows, expected at least one",
        ),
        (
            format!("{NAMES}{ROWS}").replace("alt", "height"),
            "a.daa, line 1: the column alt|altitude is missing, expected name|aircraft|id, lat lon alt",
        ),
        (
            format!("{NAMES}{ROWS}").replace(" time", ""),
            "a.daa, line 1: the column time|tm|st|clock is missing",
        ),
        (
            format!("{NAMES}{ROWS}").replace("trk", "vx"),
            "a.daa, line 1: the column trk|track is missing",
        ),
        (
            format!("{NAMES}{ROWS}").replace("gs", "time"),
            "a.daa, line 1: the column gs|groundspeed|groundspd is missing",
        ),
        (
            format!("{NAMES}{ROWS}").replace("name lat", "name lat lat"),
            "a.daa, line 1: the column lat|latitude appears twice",
        ),
        (
            format!("{NAMES}[none] [deg] [deg] [furlong] [deg] [knot] [fpm] [s]\n{ROWS}"),
            "a.daa, line 2: column alt has the unknown unit \"[furlong]\", expected a length unit such as m, ft",
        ),
        (
            format!("{NAMES}[none] [deg] [deg] [knot] [deg] [knot] [fpm] [s]\n{ROWS}"),
            "a.daa, line 2: column alt has the unit \"[knot]\" of a speed, expected a length unit such as",
        ),
        (
            format!("{NAMES}[none] [deg] [deg] [ft] [deg] [knot] [fpm]\n{ROWS}"),
            "a.daa, line 2: has 7 units, expected 8",
        ),
        (
            with("Own 0 0.02"),
            "a.daa, line 5: has 3 fields, expected 8 as in the line of column names",
        ),
        (
            with("Own 0 0.02 980 90 100 -60 20 7"),
            "a.daa, line 5: has 9 fields, expected 8",
        ),
        (
            with("Own 0 0.02 980 90 100 -60 5"),
            "a.daa, line 5: the time of aircraft \"Own\" goes back from 10 s to 5 s, expected it to grow",
        ),
        (
            with("Own NaN 0.02 980 90 100 -60 20"),
            "a.daa, line 5: column lat holds \"NaN\", expected a finite number",
        ),
        (
            with("Own inf 0.02 980 90 100 -60 20"),
            "a.daa, line 5: column lat holds \"inf\", expected a finite number",
        ),
        (
            with("Own x 0.02 980 90 100 -60 20"),
            "a.daa, line 5: column lat holds \"x\", expected a number",
        ),
        (
            with("Own 91 0.02 980 90 100 -60 20"),
            "a.daa, line 5: column lat is 91",
        ),
        (
            with("Own 0 1000 980 90 100 -60 20"),
            "a.daa, line 5: column lon is 1000",
        ),
        (
            with("Own 0 0.02 9e9 90 100 -60 20"),
            "a.daa, line 5: column alt is 2743200000 m, expected at most 100000 m",
        ),
        (
            with("Own 0 0.02 980 90 1e6 -60 20"),
            "a.daa, line 5: column gs is",
        ),
        (
            with("Own 0 0.02 980 90 -1 -60 20"),
            "a.daa, line 5: column gs is negative",
        ),
        (
            with("Own 0 0.02 980 90 100 -60 1e300"),
            "a.daa, line 5: column time is",
        ),
        (
            with("Own 0 0.02 980 90 100 -60 1:99:00"),
            "a.daa, line 5: column time holds \"1:99:00\", expected seconds or hours:minutes:seconds",
        ),
        (
            with(", 0, 0.02, 980, 90, 100, -60, 20"),
            "a.daa, line 5: the aircraft has no name",
        ),
        (
            format!("{NAMES}\" 0 0.02 980 90 100 -60 20\n"),
            "a.daa, line 2: the first row repeats a name",
        ),
    ] {
        let error = parse(&text).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}", rows in "([A-C\"]?[, \t][-0-9.eN:\\[\\]a-z]{0,5}[, \t;]?){0,40}") {
        let _ = parse(&text);
        let _ = parse(&format!("{NAMES}{text}"));
        let _ = parse(&format!("{NAMES}{rows}"));
    }

    #[test]
    fn rows_of_numbers_are_read_or_refused(values in proptest::collection::vec(any::<f64>(), 7)) {
        let row: Vec<String> = values.iter().map(ToString::to_string).collect();
        if let Ok(recording) = parse(&format!("{NAMES}A {}\n", row.join(" "))) {
            let sample = recording.aircraft[0].samples[0];
            prop_assert!(sample.position_m.is_finite() && sample.velocity_mps.is_finite());
        }
    }
}

#[test]
fn a_compressed_recording_is_read_and_a_cut_one_is_named() {
    use std::io::Write as _;
    let text = "NAME sx sy sz vx vy vz time\nunitless [m] [m] [m] [m/s] [m/s] [m/s] [s]\n\
                own 0 0 0 1 0 0 0\nintruder 50 0 0 1 0 0 0\n";
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    let bytes = encoder.finish().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.daa.gz");
    std::fs::write(&path, &bytes).unwrap();
    assert_eq!(daa::read(&path).unwrap(), parse(text).unwrap());
    std::fs::write(&path, format!("\u{feff}{text}")).unwrap();
    assert_eq!(daa::read(&path).unwrap(), parse(text).unwrap());
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let said = daa::read(&path).unwrap_err().to_string();
    assert!(
        said.contains("a.daa.gz: holds damaged gzip data (")
            && said.ends_with("expected a whole file"),
        "{said}"
    );
}

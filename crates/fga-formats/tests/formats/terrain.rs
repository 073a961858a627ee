//! Heights of the ground: files that GDAL and a script wrote from a formula (`terrain/fixtures.py`), damaged ones, and
//! clearances against fine steps.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "heights of 16 bits and numbers of steps"
)]

use std::path::{Path, PathBuf};

use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::{Area, Datum, Given, RequestedBlock, Terrain, TerrainFile, parse, read};
use glam::DVec3;
use proptest::prelude::*;

const FILES: [(&str, &[u8]); 11] = [
    ("strips.tif", include_bytes!("terrain/strips.tif")),
    ("tiles.tif", include_bytes!("terrain/tiles.tif")),
    ("ellipsoid.tif", include_bytes!("terrain/ellipsoid.tif")),
    ("packed.tif", include_bytes!("terrain/packed.tif")),
    ("utm.tif", include_bytes!("terrain/utm.tif")),
    ("west.tif", include_bytes!("terrain/west.tif")),
    ("east.tif", include_bytes!("terrain/east.tif")),
    ("south.tif", include_bytes!("terrain/south.tif")),
    ("s30_w178.dt0.gz", include_bytes!("terrain/s30_w178.dt0.gz")),
    ("N46E009.DAT", include_bytes!("terrain/N46E009.DAT")),
    ("old.dat", include_bytes!("terrain/old.dat")),
];
const SRTM: &[u8] = include_bytes!("terrain/S34W071.hgt.gz");

fn bytes(name: &str) -> &'static [u8] {
    FILES.iter().find(|file| file.0 == name).unwrap().1
}

fn file(name: &str) -> TerrainFile {
    parse(bytes(name), Path::new(name), &Given::default()).unwrap()
}

fn terrain(names: &[&str]) -> Terrain {
    Terrain::new(names.iter().map(|name| file(name)).collect()).unwrap()
}

fn refusal(bytes: &[u8], name: &str) -> String {
    let error = parse(bytes, Path::new(name), &Given::default()).unwrap_err();
    let text = error.to_string();
    assert!(!text.contains('\n') && text.starts_with(name), "{text}");
    text
}

/// The formula of the files, metres.
fn formula(latitude: f64, longitude: f64) -> f64 {
    700.0
        + 400.0 * (7.0 * latitude).sin() * (5.0 * longitude).cos()
        + 90.0 * (40.0 * longitude).sin()
}

/// Every post of a file is within `tolerance_m` of the formula plus `offset_m`; the number of holes.
fn posts_follow(file: &TerrainFile, offset_m: f64, tolerance_m: f64) -> usize {
    let mut holes = 0;
    for field in &file.fields {
        let grid = field.grid();
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                let (latitude, longitude) = (grid.latitude_deg(row), grid.longitude_deg(column));
                let Some(height_m) = field.post_m(row, column) else {
                    holes += 1;
                    continue;
                };
                let expected_m = formula(latitude, longitude) + offset_m;
                assert!(
                    (height_m - expected_m).abs() <= tolerance_m,
                    "{} at {latitude}, {longitude}: {height_m}, not {expected_m}",
                    file.path.display()
                );
            }
        }
    }
    holes
}

#[test]
fn geotiff_of_gdal_is_read_in_strips_and_tiles_in_either_byte_order() {
    for (name, datum, source, tolerance_m, holes) in [
        ("strips.tif", Datum::Egm96, "the file's GeoKeys", 0.5, 1),
        ("tiles.tif", Datum::Egm2008, "the file's GeoKeys", 1e-4, 0),
        (
            "ellipsoid.tif",
            Datum::Ellipsoid,
            "the file's GeoKeys",
            0.5,
            0,
        ),
        (
            "packed.tif",
            Datum::Egm96,
            "assumed: the file does not say",
            0.5,
            0,
        ),
    ] {
        let file = file(name);
        assert_eq!(
            (file.datum.value, file.datum.source),
            (datum, source),
            "{name}"
        );
        assert_eq!(posts_follow(&file, 0.0, tolerance_m), holes, "{name}");
        assert_eq!(file.fields[0].summary().1, holes);
        let area = file.area().unwrap();
        let sides = [area.south_deg, area.west_deg, area.north_deg, area.east_deg];
        for (side, expected) in sides.iter().zip([46.5025, 9.2, 46.6, 9.3225]) {
            assert!((side - expected).abs() < 1e-9, "{name}: {area}");
        }
    }
}

#[test]
fn srtm_is_read_with_its_hole_and_the_corner_of_its_name() {
    let file = parse(SRTM, Path::new("S34W071.hgt.gz"), &Given::default()).unwrap();
    let field = &file.fields[0];
    assert_eq!(file.vertical_error_m.value, 16.0);
    assert_eq!(field.summary(), (Some([100.0, 370.0]), 1));
    // Row 40 from the north, column 60 from the west: 7 and 3 above the corner.
    let height_m = field.height_m(-33.0 - 40.0 / 1200.0, -71.0 + 60.0 / 1200.0);
    assert_eq!(height_m, Some(110.0));
    let hole = [-33.0 - 300.0 / 1200.0, -71.0 + 500.0 / 1200.0];
    assert_eq!(field.height_m(hole[0], hole[1]), None);
    assert_eq!(field.height_m(hole[0] + 0.5 / 1200.0, hole[1]), None);
    assert_eq!(field.height_m(hole[0] + 1.0 / 1200.0, hole[1]), Some(173.0));
    for outside in [
        [-32.999, -70.5],
        [-34.001, -70.5],
        [-33.5, -71.001],
        [-33.5, -69.999],
    ] {
        assert_eq!(field.height_m(outside[0], outside[1]), None);
    }
    assert_eq!(field.height_m(-34.0, -70.0), field.height_m(-34.0, 290.0));
}

#[test]
fn dted_of_gdal_is_read_with_signs_and_holes() {
    let file = file("s30_w178.dt0.gz");
    assert_eq!(posts_follow(&file, -700.0, 0.5), 1);
    let (range, _) = file.fields[0].summary();
    assert!(range.unwrap()[0] < -300.0);
    assert_eq!(file.datum.value, Datum::Egm96);
}

/// Corners of both generations of ArduPilot's files; the blocks of the new one are sheared by less than 10 m.
#[test]
fn blocks_of_ardupilot_are_read_where_its_flat_earth_puts_them() {
    let new = file("N46E009.DAT");
    assert_eq!((new.fields.len(), new.empty_blocks), (3, 1));
    // Unfilled: one piece of four by four.
    assert_eq!(posts_follow(&new, 0.0, 1.5), 16);
    assert_eq!(posts_follow(&file("old.dat"), 0.0, 0.51), 0);
    let ground = Terrain::new(vec![new]).unwrap();
    // Over the overlap of two blocks, and nowhere near a third.
    let [north, east] =
        [2.0 * 24.0 + 5.0, 4.0 * 28.0 + 1.0].map(|posts| posts * 100.0 / 111_318.85);
    let place = [
        46.0 + north,
        9.0 + east / f64::to_radians(46.0 + 0.5 * north).cos(),
    ];
    let height_m = ground.height_m(place[0], place[1]).unwrap();
    assert!((height_m - formula(place[0], place[1])).abs() < 2.0);
    assert_eq!(ground.height_m(46.5, 9.5), None);
}

/// Pieces over MAVLink, in any order, become the field of the block in the file.
#[test]
fn ground_sent_in_pieces_is_the_ground_of_the_file() {
    let blocks = file("N46E009.DAT").fields;
    for field in &blocks {
        let grid = field.grid();
        let inside = [grid.latitude_deg(14), grid.longitude_deg(14)];
        let mut block = RequestedBlock::around(inside, 100).unwrap();
        let corner_e7 = block.corner_e7();
        for piece in (0..56_u8).rev() {
            let (south, west) = (usize::from(piece) / 8 * 4, usize::from(piece) % 8 * 4);
            let heights_m = core::array::from_fn(|index| {
                let height_m = field.post_m(27 - south - index / 4, west + index % 4);
                height_m.unwrap_or(-1.0) as i16
            });
            assert!(!block.take([corner_e7[0] + 500, corner_e7[1]], 100, piece, &heights_m));
            assert!(!block.take(corner_e7, 90, piece, &heights_m));
            if heights_m != [-1; 16] {
                assert!(block.take(corner_e7, 100, piece, &heights_m));
            }
        }
        assert!(!block.take(corner_e7, 100, 56, &[0; 16]));
        let (_, holes) = field.summary();
        assert_eq!(block.mask().count_ones() as usize, holes / 16);
        let sent = block.field().unwrap();
        assert_eq!((sent.grid().rows, sent.summary()), (28, field.summary()));
        for row in 0..28 {
            for column in 0..32 {
                assert_eq!(sent.post_m(row, column), field.post_m(row, column));
            }
        }
        assert!((sent.grid().west_deg - grid.west_deg).abs() < 1e-9);
        assert!((sent.grid().south_deg - grid.south_deg).abs() < 1e-9);
    }
    assert!(RequestedBlock::around([90.0, 0.0], 100).is_none());
    assert!(RequestedBlock::around([46.0, f64::NAN], 100).is_none());
}

#[test]
fn neighbours_are_one_ground_across_the_gap_between_their_posts() {
    let ground = terrain(&["west.tif", "east.tif", "south.tif"]);
    let step = 1.0 / 400.0;
    let mut places = 0;
    for north in 0..58 * 3 {
        for east in 0..49 * 3 {
            let latitude = 46.6 - (f64::from(north) + 0.4) / 3.0 * step;
            let longitude = 9.2 + (f64::from(east) + 0.4) / 3.0 * step;
            let height_m = ground.height_m(latitude, longitude).unwrap();
            // Rounding of the posts, and the curve between them: 1/8 step² · 40² · 90.
            assert!((height_m - formula(latitude, longitude)).abs() < 0.8);
            places += 1;
        }
    }
    assert_eq!(places, 25_578);
    let area = Area::new([46.46, 9.21, 46.59, 9.32]).unwrap();
    let all: Vec<f64> = (0..=1300)
        .flat_map(|north| (0..=1100).map(move |east| (north, east)))
        .step_by(7)
        .filter_map(|(north, east)| {
            ground.height_m(
                46.46 + f64::from(north) * 1e-4,
                9.21 + f64::from(east) * 1e-4,
            )
        })
        .collect();
    let seen_m = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let largest_m = ground.largest_m(&area).unwrap();
    assert!(
        largest_m >= seen_m && largest_m < seen_m + 20.0,
        "{largest_m} {seen_m}"
    );
    let beyond = Area::new([46.46, 9.21, 46.61, 9.32]).unwrap();
    assert_eq!(ground.largest_m(&beyond), None);
    let alone = terrain(&["west.tif", "east.tif"]);
    assert_eq!(alone.largest_m(&area), None);
}

#[test]
fn files_above_different_datums_are_no_ground() {
    let files = vec![file("strips.tif"), file("ellipsoid.tif")];
    let error = Terrain::new(files).unwrap_err().to_string();
    let expected = "ellipsoid.tif: has heights above the ellipsoid (WGS84), expected mean sea level (EGM96) as in strips.tif";
    assert_eq!(error, expected);
    let given = Given {
        datum: Some(Datum::Egm96),
        vertical_error_m: Some(3.0),
    };
    let file = parse(bytes("ellipsoid.tif"), Path::new("a.tif"), &given).unwrap();
    assert_eq!(file.datum.value, Datum::Egm96);
    assert_eq!(file.vertical_error_m.source, "given by the user");
}

#[test]
fn a_cut_is_read_back_with_its_heights_datum_and_error() {
    let folder = tempfile::tempdir().unwrap();
    for (names, area, is_resampled) in [
        (
            &["west.tif", "east.tif"][..],
            [46.52, 9.23, 46.55, 9.28],
            false,
        ),
        (&["tiles.tif"][..], [46.52, 9.23, 46.55, 9.34], false),
        (&["N46E009.DAT"][..], [46.06, 9.12, 46.07, 9.13], true),
    ] {
        let ground = terrain(names);
        let cut = ground.cut(&Area::new(area).unwrap()).unwrap();
        assert_eq!(cut.is_resampled, is_resampled, "{names:?}");
        let path = folder.path().join("cut.tif");
        cut.write(&path).unwrap();
        let back = read(&path, &Given::default()).unwrap();
        assert_eq!(back.datum.value, ground.datum());
        assert_eq!(back.vertical_error_m.value, ground.vertical_error_m());
        let (found, expected) = (back.fields[0].grid(), cut.field.grid());
        assert_eq!(
            (found.rows, found.columns),
            (expected.rows, expected.columns)
        );
        for row in 0..found.rows {
            for column in 0..found.columns {
                let height_m = back.fields[0].post_m(row, column);
                assert_eq!(height_m, cut.field.post_m(row, column));
                let there =
                    ground.height_m(expected.latitude_deg(row), expected.longitude_deg(column));
                assert_eq!(height_m.map(|m| m as f32), there.map(|m| m as f32));
            }
        }
    }
    let outside = Area::new([10.0, 10.0, 11.0, 11.0]).unwrap();
    let error = terrain(&["west.tif"]).cut(&outside).unwrap_err();
    assert!(error.contains("no known ground"), "{error}");
}

/// Paths in any direction over several files, a hole and the outside, against steps of a metre.
#[test]
fn the_least_clearance_is_that_of_fine_steps() {
    let ground = terrain(&["strips.tif", "south.tif"]);
    let origin = Geodetic::new(46.55, 9.26, 100.0).unwrap();
    let frame = LocalFrame::new(origin, Earth::Wgs84);
    let mut checked = 0;
    for number in 1..=60_u32 {
        let draw = |factor: u32, span: f64| span * (f64::from(number * factor % 101) / 50.0 - 1.0);
        let from = DVec3::new(
            draw(17, 5_500.0),
            draw(29, 8_000.0),
            900.0 + draw(41, 400.0),
        );
        let to = DVec3::new(
            draw(59, 5_500.0),
            draw(71, 8_000.0),
            900.0 + draw(83, 400.0),
        );
        let found = ground.clearance(&frame, from, to);
        let length_m = (to - from).truncate().length();
        let steps = length_m.ceil();
        let (mut least_m, mut unknown) = (f64::INFINITY, 0.0);
        for step in 0..=steps as u32 {
            let place = frame.to_geodetic(from.lerp(to, f64::from(step) / steps));
            match ground.height_m(place.latitude_deg, place.longitude_deg) {
                Some(height_m) => least_m = least_m.min(place.altitude_m - height_m),
                None => unknown += 1.0,
            }
        }
        assert!(
            (found.unknown_m - unknown).abs() < 0.01 * length_m + 20.0,
            "{found:?} {unknown}"
        );
        assert_eq!(found.unknown_m > 0.0, found.unknown_at.is_some());
        if let Some(lowest) = found.lowest {
            // Steeper than 1 nowhere: a metre between steps is at most a metre of height.
            assert!(lowest.clearance_m <= least_m + 0.05, "{found:?} {least_m}");
            assert!(lowest.clearance_m >= least_m - 1.0, "{found:?} {least_m}");
            let there = ground.height_m(lowest.place.latitude_deg, lowest.place.longitude_deg);
            assert!(there.is_none_or(|height_m| (height_m - lowest.ground_m).abs() < 0.05));
            checked += 1;
        }
        let profile = ground.profile(&frame, from, to);
        assert!(
            profile
                .windows(2)
                .all(|pair| pair[0].along_m <= pair[1].along_m + 1e-6)
        );
        assert!((profile.last().unwrap().along_m - length_m).abs() < 1e-6);
    }
    assert!(checked > 50);
}

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(bytes), &mut plain).unwrap();
    plain
}

#[test]
fn srtm_that_cannot_be_right_is_refused_in_one_sentence() {
    let plain = unpacked(SRTM);
    let with = |index: usize, height: i16| {
        let mut changed = plain.clone();
        changed[2 * index..2 * index + 2].copy_from_slice(&height.to_be_bytes());
        changed
    };
    let swapped: Vec<u8> = plain
        .chunks(2)
        .flat_map(|pair| [pair[1], pair[0]])
        .collect();
    let low: Vec<u8> = (0..1201 * 1201_u32)
        .flat_map(|post| [(post / 7 % 30) as u8, 0])
        .collect();
    for (bytes, name, part) in [
        (
            &plain[1..],
            "S34W071.hgt",
            "has 2884801 bytes, expected 2884802 or 25934402",
        ),
        (&plain[..], "ground.hgt", "has no place in its name"),
        (&plain[..], "N90E008.hgt", "place N90E008 in its name"),
        (&plain[..], "S90E008.hgt", "reaches no pole"),
        (
            &with(1202, 9001)[..],
            "S34W071.hgt",
            "height 9001 m at latitude -33.0008, longitude -70.9992",
        ),
        (&swapped[..], "S34W071.hgt", "is its byte order another?"),
        (&low[..], "S34W071.hgt", "only multiples of 256 m"),
        (b"PK\x03\x04", "S34W071.hgt.zip", "is a zip archive"),
        (b"\x1f\x8b\x08", "S34W071.hgt.gz", "damaged gzip data"),
        (b"", "S34W071.xyz", "is of no known format"),
    ] {
        let error = refusal(bytes, name);
        assert!(error.contains(part), "{error}");
    }
}

/// A name that says other than the content, headers and records that do not agree.
#[test]
fn files_that_contradict_themselves_are_refused_in_one_sentence() {
    let dted = unpacked(bytes("s30_w178.dt0.gz"));
    let changed = |at: usize, text: &[u8]| {
        let mut changed = dted.clone();
        changed[at..at + text.len()].copy_from_slice(text);
        changed
    };
    let mut blocks = bytes("N46E009.DAT").to_vec();
    blocks[100] ^= 1;
    for (bytes, name, part) in [
        (&dted[..], "n30_w178.dt0", "is a hemisphere wrong?"),
        (
            &dted[..dted.len() - 1],
            "a.dt0",
            "expected 34162 for 121 lines of 121 heights",
        ),
        (&dted[..200], "a.dt0", "expected at least 3428"),
        (&changed(19, b"E"), "a.dt0", "as its origin"),
        (&changed(12, b"0890000N"), "a.dt0", "reaches no pole"),
        (&changed(4, b"1793000E"), "a.dt0", "antimeridian"),
        (&changed(47, b"9999"), "a.dt0", "has 34162 bytes, expected"),
        (
            &changed(51, b"99x9"),
            "a.dt0",
            "as number of heights of a line",
        ),
        (
            &changed(80 + 141, b"NAP"),
            "a.dt0",
            "vertical datum \"NAP\"",
        ),
        (&changed(80 + 144, b"ED50 "), "a.dt0", "horizontal datum"),
        (
            &changed(3428 + 20, b"\x01\x02"),
            "a.dt0",
            "longitude line 0 has the checksum",
        ),
        (&blocks[..], "N46E009.DAT", "block 0 has the checksum"),
        (
            &blocks[..4000],
            "N46E009.DAT",
            "expected whole blocks of 2048 bytes",
        ),
        (
            bytes("N46E009.DAT"),
            "N46W009.DAT",
            "is of the degree 46, 9",
        ),
        (
            &[0; 2048][..],
            "N46E009.DAT",
            "no heights in any of its 1 blocks",
        ),
        (bytes("utm.tif"), "a.tif", "projected coordinates"),
        (bytes("strips.tif"), "S46E009.tif", "is a hemisphere wrong?"),
        (&bytes("strips.tif")[..600], "a.tif", "is no usable TIFF"),
        (&bytes("tiles.tif")[..4000], "a.tif", "is no usable TIFF"),
    ] {
        let error = refusal(bytes, name);
        assert!(error.contains(part), "{name}, {part}: {error}");
    }
}

/// A header of a few bytes that promises 100,000 × 100,000 heights.
#[test]
fn a_promise_of_ten_thousand_million_heights_is_refused_before_memory_is_taken() {
    let mut tiff = b"II*\0\x08\0\0\0".to_vec();
    let entries: [(u16, u16, u32); 8] = [
        (256, 4, 100_000),
        (257, 4, 100_000),
        (258, 3, 16),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, 8),
        (278, 4, 100_000),
        (279, 4, 100),
    ];
    tiff.extend(8_u16.to_le_bytes());
    for (tag, kind, value) in entries {
        tiff.extend(tag.to_le_bytes());
        tiff.extend(kind.to_le_bytes());
        tiff.extend(1_u32.to_le_bytes());
        tiff.extend(value.to_le_bytes());
    }
    tiff.extend([0; 4]);
    let error = refusal(&tiff, "a.tif");
    assert!(
        error.contains("promises 100000 x 100000 heights in 110 bytes"),
        "{error}"
    );
}

#[test]
fn areas_without_sense_are_refused() {
    for (sides, part) in [
        ([47.0, 8.0, 46.0, 9.0], "south below north"),
        ([46.0, 8.0, 90.0, 9.0], "no pole"),
        ([46.0, 179.0, 47.0, -179.0], "antimeridian"),
        ([f64::NAN, 8.0, 47.0, 9.0], "latitudes NaN"),
    ] {
        let error = Area::new(sides).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Any change of any file is read as sane ground, or refused.
    #[test]
    fn changed_files_are_read_or_refused(
        number in 0..FILES.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        early in any::<bool>(),
        keep in prop::option::weighted(0.3, any::<prop::sample::Index>()),
    ) {
        let (name, whole) = FILES[number];
        let mut bytes = if whole.starts_with(&[0x1f, 0x8b]) { unpacked(whole) } else { whole.to_vec() };
        // Half of the cases change the headers.
        let span = if early { bytes.len().min(300) } else { bytes.len() };
        for (index, value) in changes {
            bytes[index.index(span)] = value;
        }
        if let Some(keep) = keep {
            bytes.truncate(keep.index(bytes.len()));
        }
        match parse(&bytes, Path::new(name), &Given::default()) {
            Ok(file) => {
                let area = file.area().unwrap();
                let (south, north) = (area.south_deg, area.north_deg);
                prop_assert!(south > -90.0 && north < 90.0 && area.west_deg >= -180.0);
                let place = [0.5 * (south + north), 0.5 * (area.west_deg + area.east_deg)];
                let ground = Terrain::new(vec![file]).unwrap();
                let height_m = ground.height_m(place[0], place[1]);
                prop_assert!(height_m.is_none_or(|height_m| height_m.abs() <= 9_000.0));
                let _ = ground.largest_m(&area);
            }
            Err(error) => {
                let text = error.to_string();
                prop_assert!(!text.contains('\n') && text.contains(", expected"), "{}", text);
            }
        }
    }
}

/// A file of the tests of the crate `dted2` 1.0.0, which the folder in `FGA_DTED2` or the sources of cargo hold.
fn dted2(name: &str) -> Option<PathBuf> {
    let folders = || {
        if let Some(folder) = std::env::var_os("FGA_DTED2") {
            return vec![PathBuf::from(folder)];
        }
        let home = std::env::var_os("CARGO_HOME")
            .map(PathBuf::from)
            .or_else(|| {
                let home = std::env::var_os("HOME")?;
                Some(Path::new(&home).join(".cargo"))
            });
        let sources = home.and_then(|home| std::fs::read_dir(home.join("registry/src")).ok());
        let sources = sources.into_iter().flatten().flatten();
        sources
            .map(|entry| entry.path().join("dted2-1.0.0/tests"))
            .collect()
    };
    let found = folders()
        .into_iter()
        .map(|folder| folder.join(name))
        .find(|path| path.exists());
    if found.is_none() {
        eprintln!(
            "skipped: {name} of the crate dted2 1.0.0 is absent (FGA_DTED2 names its folder)"
        );
    }
    found
}

/// SRTM as the United States publish it: the Adriatic at Split, and Raoul Island. Expected values from GDAL 3.10.
#[test]
fn dted_as_it_is_published_is_read_as_gdal_reads_it() {
    let Some(path) = dted2("test_data.dt2") else {
        return;
    };
    let file = read(&path, &Given::default()).unwrap();
    assert_eq!(file.fields[0].summary(), (Some([-4.0, 114.0]), 0));
    assert_eq!(
        (file.datum.value, file.vertical_error_m.value),
        (Datum::Egm96, 5.0)
    );
    let island = read(&dted2("test_data_negative.dt2").unwrap(), &Given::default()).unwrap();
    assert_eq!(island.fields[0].summary(), (Some([0.0, 466.0]), 0));
    assert_eq!(island.vertical_error_m.value, 16.0);
}

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

mod ground;
mod refused;

use std::path::{Path, PathBuf};

use fga::Vec3;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::{
    Datum, Given, RequestedBlock, Taken, Terrain, TerrainFile, parse, read,
};

const FILES: [(&str, &[u8]); 17] = [
    ("strips.tif", include_bytes!("terrain/strips.tif")),
    ("tiles.tif", include_bytes!("terrain/tiles.tif")),
    ("ellipsoid.tif", include_bytes!("terrain/ellipsoid.tif")),
    ("packed.tif", include_bytes!("terrain/packed.tif")),
    ("masked.tif", include_bytes!("terrain/masked.tif")),
    (
        "masked-tiles.tif",
        include_bytes!("terrain/masked-tiles.tif"),
    ),
    ("feet.tif", include_bytes!("terrain/feet.tif")),
    ("scaled.tif", include_bytes!("terrain/scaled.tif")),
    ("utm.tif", include_bytes!("terrain/utm.tif")),
    ("swiss.tif", include_bytes!("terrain/swiss.tif")),
    ("british.tif", include_bytes!("terrain/british.tif")),
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
fn masked_pixels_are_holes() {
    for name in ["masked.tif", "masked-tiles.tif"] {
        let file = file(name);
        let masked = |index: usize| (index / 50 + index % 50).is_multiple_of(9);
        let holes = (0..40 * 50).filter(|index| masked(*index)).count();
        assert_eq!(posts_follow(&file, 0.0, 0.5), holes, "{name}");
        let field = &file.fields[0];
        for index in 0..40 * 50 {
            let known = field.post_m(index / 50, index % 50).is_some();
            assert_eq!(known, !masked(index), "{name}, {index}");
        }
    }
    // A file of its own beside the image holds the mask, too.
    let folder = std::env::temp_dir().join(format!("fga-mask-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("a.tif");
    std::fs::write(&path, bytes("strips.tif")).unwrap();
    std::fs::write(folder.join("a.tif.msk"), bytes("strips.tif")).unwrap();
    let told = read(&path, &Given::default()).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(
        told.contains("has a mask (.msk) in a file beside it"),
        "{told}"
    );
}

#[test]
fn heights_in_feet_and_with_a_scale_are_metres() {
    assert_eq!(posts_follow(&file("feet.tif"), 0.0, 0.16), 0);
    assert_eq!(posts_follow(&file("scaled.tif"), 0.0, 0.051), 0);
    let unknown = String::from_utf8_lossy(bytes("feet.tif")).into_owned();
    assert!(unknown.contains(">ft<"));
    let mut furlongs = bytes("feet.tif").to_vec();
    let at = furlongs
        .windows(4)
        .position(|part| part == b">ft<")
        .unwrap();
    furlongs[at + 1..at + 3].copy_from_slice(b"fu");
    let error = refusal(&furlongs, "feet.tif");
    assert!(
        error.contains("heights in \"fu\", expected metres or feet"),
        "{error}"
    );
}

/// PROJ put the posts of these files where the formula was taken; shifts of old datums differ by up to 5 m.
#[test]
fn heights_on_grids_of_maps_lie_where_the_map_has_them_and_none_is_lowered() {
    for (name, tolerance_m, datum, south_deg) in [
        ("utm.tif", 0.1, Datum::Egm96, 46.5510),
        ("swiss.tif", 0.1, Datum::Egm2008, 46.5301),
        ("british.tif", 0.6, Datum::Egm96, 51.5661),
    ] {
        let file = file(name);
        let holes = posts_follow(&file, 0.0, tolerance_m);
        let field = &file.fields[0];
        let grid = field.grid();
        // Holes are the wedges beside a grid that is turned against north.
        assert!(holes * 7 < grid.rows * grid.columns, "{name}: {holes}");
        assert_eq!(file.datum.value, datum, "{name}");
        assert!(
            (grid.south_deg - south_deg).abs() < 1e-4,
            "{name}: {}",
            grid.south_deg
        );
        let spacing_m = [
            grid.step_north_deg,
            grid.step_east_deg * grid.south_deg.to_radians().cos(),
        ];
        for step_m in spacing_m.map(|step_deg| step_deg * 111_200.0) {
            assert!((step_m - 100.0).abs() < 1.0, "{name}: {step_m}");
        }
    }
    // One peak of one post is nowhere lost.
    let mut peak = bytes("utm.tif").to_vec();
    let middle = peak.len() - 4 * (24 * 40 + 20);
    peak[middle..middle + 4].copy_from_slice(&3000_f32.to_le_bytes());
    let peak = parse(&peak, Path::new("a.tif"), &Given::default()).unwrap();
    let (range, _) = peak.fields[0].summary();
    assert!(range.unwrap()[1] >= 3000.0, "{range:?}");
}

#[test]
fn dted_in_twos_complement_is_the_same_ground() {
    let signed = unpacked(bytes("s30_w178.dt0.gz"));
    let mut twos = signed.clone();
    let mut changed = 0;
    for column in 0..121 {
        let record = &mut twos[3428 + column * 254..3428 + (column + 1) * 254];
        for pair in record[8..250].chunks_exact_mut(2) {
            let raw = u16::from_be_bytes([pair[0], pair[1]]);
            let height = match raw {
                0xFFFF => -32_767,
                raw if raw & 0x8000 != 0 => -(raw.cast_signed() & i16::MAX),
                raw => raw.cast_signed(),
            };
            changed += i32::from(height.cast_unsigned() != raw);
            pair.copy_from_slice(&height.to_be_bytes());
        }
        let sum: u32 = record[..250].iter().map(|byte| u32::from(*byte)).sum();
        record[250..].copy_from_slice(&sum.to_be_bytes());
    }
    assert!(changed > 1_000, "{changed}");
    let read = |bytes: &[u8]| parse(bytes, Path::new("a.dt0"), &Given::default()).unwrap();
    // All bits set are a hole in the one and a metre below the sea in the other: a hole.
    let (twos, signed) = (&read(&twos).fields[0], &read(&signed).fields[0]);
    for index in 0..121 * 121 {
        let (row, column) = (index / 121, index % 121);
        let expected = signed
            .post_m(row, column)
            .filter(|height_m| *height_m != -1.0);
        assert_eq!(twos.post_m(row, column), expected, "{index}");
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
            let moved_e7 = [corner_e7[0] + 500, corner_e7[1]];
            assert_eq!(block.take(moved_e7, 100, piece, &heights_m), Taken::Other);
            assert_eq!(block.take(corner_e7, 90, piece, &heights_m), Taken::Other);
            if heights_m != [-1; 16] {
                assert_eq!(block.take(corner_e7, 100, piece, &heights_m), Taken::New);
                // Lower ground that comes later does not count.
                let lower_m = heights_m.map(|height_m| height_m - 60);
                let again = Taken::Again { higher_m: -60 };
                assert_eq!(block.take(corner_e7, 100, piece, &lower_m), again);
            }
        }
        assert_eq!(block.take(corner_e7, 100, 56, &[0; 16]), Taken::NoGround);
        assert_eq!(block.take(corner_e7, 100, 0, &[9_001; 16]), Taken::NoGround);
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

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, bytes).unwrap();
    packed.finish().unwrap()
}

pub(crate) fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(bytes), &mut plain).unwrap();
    plain
}

/// A file of the tests of the crate `dted2`, which cargo unpacks with its sources.
fn dted2(name: &str) -> PathBuf {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.unwrap_or_else(|| Path::new(&std::env::var_os("HOME").unwrap()).join(".cargo"));
    let sources = std::fs::read_dir(home.join("registry/src")).unwrap();
    let mut paths = sources.map(|source| source.unwrap().path().join("dted2-1.0.0/tests"));
    let folder = paths.find(|path| path.exists());
    folder.expect("the sources of dted2 1.0.0").join(name)
}

/// SRTM as the United States publish it: the Adriatic at Split, and Raoul Island. Expected values from GDAL 3.10; between the posts
/// those of another reader.
#[test]
fn dted_as_it_is_published_is_read_as_gdal_and_dted2_read_it() {
    for (name, range_m, error_m) in [
        ("test_data.dt2", [-4.0, 114.0], 5.0),
        ("test_data_negative.dt2", [0.0, 466.0], 16.0),
    ] {
        let path = dted2(name);
        let file = read(&path, &Given::default()).unwrap();
        let field = &file.fields[0];
        assert_eq!(field.summary(), (Some(range_m), 0));
        assert_eq!(
            (file.datum.value, file.vertical_error_m.value),
            (Datum::Egm96, error_m)
        );
        let other = dted2::DTEDData::read(path.to_str().unwrap()).unwrap();
        let area = file.area().unwrap();
        let mut land = 0;
        for step in 0..100_000 {
            let [north, east] =
                [0.618_034, 0.414_214].map(|share| (f64::from(step) * share).fract());
            let place = [
                area.south_deg + north * (area.north_deg - area.south_deg),
                area.west_deg + east * (area.east_deg - area.west_deg),
            ];
            let height_m = field.height_m(place[0], place[1]).unwrap();
            let expected_m = other.get_elevation(place[0], place[1]).unwrap();
            assert!(
                (height_m - expected_m).abs() < 1e-3,
                "{name} at {place:?}: {height_m}, not {expected_m}"
            );
            land += u32::from(height_m > 1.0);
        }
        // The most of both is sea.
        assert!(land > 40, "{name}: {land}");
    }
}

/// A leg that crosses a line of posts at a very small angle took a million steps for each kilometre.
#[test]
fn a_path_along_a_line_of_posts_takes_few_steps() {
    let terrain = terrain(&["strips.tif"]);
    // 0.4 millionths of a step beside the line of posts at 9.21, and as far beside it on the other side at the end.
    for side in [1.0, -1.0] {
        let place = Geodetic::new(46.51, 9.21 + side * 1e-9, 0.0).unwrap();
        let frame = LocalFrame::new(place, Earth::Wgs84);
        let (from_m, to_m) = (Vec3::ZERO, Vec3::new(-side * 1.5e-4, 5_000.0, 0.0));
        let points = terrain.profile(&frame, from_m, to_m).len();
        // A line of posts each 278 m.
        assert!((36..100).contains(&points), "{points}");
        let lowest = terrain.clearance(&frame, from_m, to_m).lowest.unwrap();
        let beside_m = terrain.clearance(&frame, from_m + Vec3::X, to_m + Vec3::X);
        let apart_m = lowest.clearance_m - beside_m.lowest.unwrap().clearance_m;
        assert!(apart_m.abs() < 2.0, "{apart_m}");
    }
}

/// The same heights as another program wrote them with LERC, to a hundredth of a metre, and with ZSTD.
#[test]
fn heights_of_lerc_are_those_of_the_same_file_without_it() {
    let of = |name: &str| {
        let path = crate::common::data(&format!("trials/2026-11-28/{name}.tif.gz"))?;
        Some(fga_formats::terrain::read(&path, &Given::default()).unwrap())
    };
    let (Some(with), Some(without)) = (of("dem_lerc"), of("dem_zstd")) else {
        return;
    };
    let (with, without) = (&with.fields[0], &without.fields[0]);
    assert_eq!(with.grid(), without.grid());
    let mut known = 0;
    for index in 0..with.grid().rows * with.grid().columns {
        let (row, column) = (index / with.grid().columns, index % with.grid().columns);
        let heights_m = (with.post_m(row, column), without.post_m(row, column));
        if let (Some(one_m), Some(other_m)) = heights_m {
            known += 1;
            assert!(
                (one_m - other_m).abs() <= 0.05,
                "{row} {column}: {heights_m:?}"
            );
        }
        assert_eq!(heights_m.0.is_some(), heights_m.1.is_some());
    }
    assert!(known > 10_000);
}

//! Files that cannot be right, and drawn changes of files.

use fga_formats::InputError;
use fga_formats::terrain::{Area, Given, Terrain, TerrainFile, parse};
use proptest::prelude::*;
use std::path::Path;

use super::{FILES, SRTM, bytes, packed, refusal, unpacked};

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
        (
            &vec![0; 30_000_000],
            "S34W071.hgt",
            "has at least 25936796 bytes, expected 2884802 or 25934402",
        ),
        (
            &[0x80, 0].repeat(1201 * 1201),
            "S34W071.hgt",
            "has only holes, expected at least one height",
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
    // GeoKey 3072 says which grid it is.
    let grid = |code: u16| {
        let mut changed = bytes("utm.tif").to_vec();
        let key = [0, 12, 0, 0, 1, 0, 0x78, 0x7F];
        let at = changed.windows(8).position(|entry| entry == key).unwrap();
        changed[at + 6..at + 8].copy_from_slice(&code.to_le_bytes());
        changed
    };
    let mut blocks = bytes("N46E009.DAT").to_vec();
    blocks[100] ^= 1;
    // The text of the projection, as that of GDAL and longer than the file.
    let mut long = bytes("utm.tif").to_vec();
    let at = long
        .windows(4)
        .position(|entry| entry == [0xB1, 0x87, 2, 0])
        .unwrap();
    long[at..at + 8].copy_from_slice(&[0x80, 0xA4, 2, 0, 0xFF, 0xFF, 0xFF, 0x7F]);
    // The bytes of the first tile.
    let mut sparse = bytes("tiles.tif").to_vec();
    sparse[218..220].fill(0);
    for (bytes, name, part) in [
        (&dted[..], "n30_w178.dt0", "is a hemisphere wrong?"),
        (
            &dted[..dted.len() - 1],
            "a.dt0",
            "has 34161 bytes, expected 34162 for 121 lines of 121 heights",
        ),
        (
            &[&dted[..], &[0]].concat(),
            "a.dt0",
            "has more than 34162 bytes, expected 34162",
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
            "has 4000 bytes, expected whole blocks of 2048 bytes",
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
        (&grid(32767), "a.tif", "has a projection of its own"),
        (&grid(26710), "a.tif", "whose datum cannot be shifted"),
        (&grid(4326), "a.tif", "which is no map's grid"),
        (&grid(1), "a.tif", "which is no known grid"),
        (bytes("strips.tif"), "S46E009.tif", "is a hemisphere wrong?"),
        (&bytes("strips.tif")[..600], "a.tif", "is no usable TIFF"),
        (&bytes("tiles.tif")[..4000], "a.tif", "is no usable TIFF"),
        (&sparse[..], "a.tif", "lacks a part (sparse)"),
        (&long[..], "a.tif", "of 2147483647 values in 8040 bytes"),
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
        let read = parse(&bytes, Path::new(name), &Given::default());
        // The same when it is compressed, in two parts.
        let (one, other) = bytes.split_at(bytes.len() / 2);
        let packed = [packed(one), packed(other)].concat();
        let told = |read: &Result<TerrainFile, InputError>| match read {
            Ok(file) => {
                let fields = file.fields.iter().map(|field| (field.grid(), field.summary()));
                format!("{:?}", fields.collect::<Vec<_>>())
            }
            Err(error) => error.to_string(),
        };
        let unpacked = parse(&packed, Path::new(name), &Given::default());
        prop_assert_eq!(told(&unpacked), told(&read));
        match read {
            Ok(file) => {
                let area = file.area().unwrap();
                let (south, north) = (area.south_deg, area.north_deg);
                prop_assert!(south > -90.0 && north < 90.0 && area.west_deg >= -180.0);
                let place = [0.5 * (south + north), 0.5 * (area.west_deg + area.east_deg)];
                let ground = Terrain::new(vec![file]).unwrap();
                let height_m = ground.height_m(place[0], place[1]);
                prop_assert!(height_m.is_none_or(|height_m| height_m.abs() <= 9_000.0));
                let _ = ground.range_m(&area);
            }
            Err(error) => {
                let text = error.to_string();
                prop_assert!(!text.contains('\n') && text.contains(", expected"), "{}", text);
            }
        }
    }
}

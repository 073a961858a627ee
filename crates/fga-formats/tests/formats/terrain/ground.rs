//! Several files as one ground, a part of it, and paths over it.

use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::{Area, Datum, Given, LocalGround, Terrain, parse, read};
use glam::{DVec2, DVec3};
use std::path::Path;

use super::{bytes, file, formula, terrain};

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
    let lowest_m = all.iter().copied().fold(f64::INFINITY, f64::min);
    let [least_m, largest_m] = ground.range_m(&area).unwrap();
    assert!(
        largest_m >= seen_m && largest_m < seen_m + 20.0,
        "{largest_m} {seen_m}"
    );
    assert!(
        least_m <= lowest_m && least_m > lowest_m - 20.0,
        "{least_m} {lowest_m}"
    );
    let beyond = Area::new([46.46, 9.21, 46.61, 9.32]).unwrap();
    assert_eq!(ground.range_m(&beyond), None);
    let alone = terrain(&["west.tif", "east.tif"]);
    assert_eq!(alone.range_m(&area), None);
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

/// The posts of a flight have the heights of the file at the exact latitude and longitude of each, and are higher by what the
/// ground between them would be too low by.
#[test]
fn local_ground_has_the_heights_of_the_file() {
    let terrain = terrain(&["strips.tif"]);
    let origin = Geodetic::new(46.55, 9.26, 700.0).unwrap();
    let frame = LocalFrame::new(origin, Earth::Wgs84);
    let ground = LocalGround::around(&terrain, &frame, &[DVec3::ZERO], 50.0).unwrap();
    assert_eq!(ground.error_m(), terrain.vertical_error_m());
    let size_m = DVec2::splat(6_000.0);
    let (spacing_m, count) = terrain.posts(46.55, size_m).unwrap();
    let exact_m = |at_m: DVec2| {
        let place = frame.to_geodetic(at_m.extend(0.0));
        let height_m = terrain.height_m(place.latitude_deg, place.longitude_deg)?;
        Some(height_m - 700.0)
    };
    let mut known = 0;
    for (column, row) in (0..count.x as u32).flat_map(|x| (0..count.y as u32).map(move |y| (x, y)))
    {
        let steps = DVec2::new(f64::from(column), f64::from(row));
        for (beside, most_m) in [
            ((0.0, 0.0), 1.0),
            ((0.5, 0.0), 2.0),
            ((0.0, 0.5), 2.0),
            ((0.5, 0.5), 2.0),
        ] {
            let at_m = -0.5 * size_m + spacing_m * (steps + DVec2::from(beside));
            if let Some((exact_m, height_m)) = exact_m(at_m).zip(ground.height_m(at_m)) {
                let higher_m = height_m - exact_m;
                assert!((-0.02..most_m).contains(&higher_m), "{higher_m} at {at_m}");
                known += 1;
            }
        }
    }
    assert!(known > 2000, "{known}");
}

/// A cliff makes the ground uncertain beside it, and nowhere else.
#[test]
fn local_ground_is_higher_beside_a_cliff_only() {
    let mut heights = Vec::new();
    for _ in 0..1201 {
        for column in 0..1201 {
            let height_m: i16 = if column < 601 { 100 } else { 600 };
            heights.extend(height_m.to_be_bytes());
        }
    }
    let file = parse(&heights, Path::new("N46E009.hgt"), &Given::default()).unwrap();
    let terrain = Terrain::new(vec![file]).unwrap();
    let origin = Geodetic::new(46.5, 9.5, 0.0).unwrap();
    let frame = LocalFrame::new(origin, Earth::Wgs84);
    let ground = LocalGround::around(&terrain, &frame, &[DVec3::ZERO], 50.0).unwrap();
    assert_eq!(ground.error_m(), terrain.vertical_error_m());
    // Posts are 64 m apart.
    let height_m = |east_m: f64| ground.height_m(DVec2::new(east_m, 0.0)).unwrap();
    for east_m in (-2900..2900).map(f64::from) {
        let place = frame.to_geodetic(DVec3::new(east_m, 0.0, 0.0));
        let exact_m = terrain.height_m(place.latitude_deg, place.longitude_deg);
        let higher_m = height_m(east_m) - exact_m.unwrap();
        let most_m = if east_m.abs() < 260.0 { 500.0 } else { 0.02 };
        assert!(higher_m < most_m, "{higher_m} at {east_m}");
    }
}

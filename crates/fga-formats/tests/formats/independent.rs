//! Files of heights and of areas, held to what independent readers in Python make of them.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "tests fail by panicking"
)]

use fga_formats::areas;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::{Given, read};
use glam::DVec2;

use crate::common::python;

/// Rows of numbers as a script prints them, each after its first word.
fn rows(text: &str) -> impl Iterator<Item = (&str, Vec<f64>)> {
    text.lines().map(|line| {
        let (word, numbers) = line.split_once(' ').unwrap();
        let numbers = numbers.split(' ').map(|number| number.parse().unwrap());
        (word, numbers.collect())
    })
}

/// GDAL writes files of each kind; what it reads of them at their pixels is what is read here. Heights of a map's grid may be raised to its
/// posts, and lie between.
#[test]
fn heights_are_those_that_gdal_reads() {
    let folder = tempfile::tempdir().unwrap();
    let script = include_str!("independent/heights.py");
    let Some(text) = python("rasterio", script, &[folder.path()]) else {
        return;
    };
    let mut count = 0;
    let mut last = None;
    for (name, numbers) in rows(&text) {
        let [latitude_deg, longitude_deg, height_m, slack_m] = numbers[..] else {
            panic!("{name}: {numbers:?}");
        };
        let path = folder.path().join(name);
        let file = match last.take().filter(|(known, _)| *known == path) {
            Some((_, file)) => file,
            None => read(&path, &Given::default()).unwrap(),
        };
        let found_m = file.fields[0].height_m(latitude_deg, longitude_deg);
        let found_m = found_m.unwrap_or(f64::NAN);
        let off_m = found_m - height_m;
        assert!(
            height_m.is_nan() == found_m.is_nan()
                && (height_m.is_nan() || (-0.02..=slack_m).contains(&off_m)),
            "{name} at {latitude_deg}, {longitude_deg}: {found_m} m, GDAL {height_m} m"
        );
        count += 1;
        last = Some((path, file));
    }
    assert!(count > 1000, "{count}");
}

/// Places some metres beside each edge are inside for us where they are for GEOS and PROJ.
#[test]
fn areas_are_those_of_geos_and_proj() {
    let folder = tempfile::tempdir().unwrap();
    let script = include_str!("independent/areas.py");
    let Some(text) = python("shapely, pyproj", script, &[folder.path()]) else {
        return;
    };
    let mut counts = [0; 2];
    for (name, numbers) in rows(&text) {
        let [latitude_deg, longitude_deg, is_inside] = numbers[..] else {
            panic!("{name}: {numbers:?}");
        };
        let (file, index) = name.split_once(':').unwrap();
        let file = areas::read(&folder.path().join(file)).unwrap();
        let at = Geodetic::new(latitude_deg, longitude_deg, 0.0).unwrap();
        let area = &file.areas[index.parse::<usize>().unwrap()];
        let frame = LocalFrame::new(at, Earth::Wgs84);
        let plane = area.on_plane(&frame, false);
        let rings = plane.polygons.iter().flatten();
        let edges = rings.flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        let is_beyond = |(a, b): &(&DVec2, &DVec2)| {
            (a.y > 0.0) != (b.y > 0.0) && ((**b - **a).perp_dot(-**a) > 0.0) == (b.y > a.y)
        };
        let found = edges.filter(is_beyond).count() % 2 == 1;
        assert_eq!(
            found,
            is_inside == 1.0,
            "{name} at {latitude_deg}, {longitude_deg}"
        );
        counts[usize::from(found)] += 1;
    }
    assert!(counts.into_iter().all(|count| count > 100), "{counts:?}");
}

//! Any text is areas of places on the earth, of which a polygon with holes is one ring, or is refused in one line.
#![no_main]

use fga_formats::areas::{self, AreaOutline};
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::zones;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|text: &str| {
    let all = match areas::parse(text, Path::new("areas")) {
        Ok(file) => file.areas,
        Err(error) => {
            assert!(!error.message.contains('\n'), "{error}");
            return;
        }
    };
    for area in all {
        let limits = area.limits.iter().flatten();
        assert!(limits.map(|limit| limit.height_m).all(f64::is_finite));
        assert!(!area.name.is_some_and(|name| name.contains('\n')));
        let rings_deg = match area.outline {
            AreaOutline::Circle { radius_m, .. } => {
                assert!(radius_m > 0.0 && radius_m.is_finite());
                continue;
            }
            AreaOutline::Polygon(rings_deg) => rings_deg,
        };
        let place = |[latitude_deg, longitude_deg]: [f64; 2]| {
            Geodetic::new(latitude_deg, longitude_deg, 0.0).expect("a place of an area")
        };
        let Some(origin) = rings_deg.iter().flatten().next() else {
            panic!("a polygon without corners");
        };
        let frame = LocalFrame::new(place(*origin), Earth::Wgs84);
        let local = |at: &[f64; 2]| frame.to_local_m(place(*at)).truncate();
        let mut rings = rings_deg
            .iter()
            .map(|ring| ring.iter().map(local).collect());
        let outline: Vec<_> = rings.next().unwrap_or_default();
        let holes: Vec<Vec<_>> = rings.collect();
        let corners = outline.len() + holes.iter().map(|hole| hole.len() + 2).sum::<usize>();
        if let Ok(ring) = zones::with_holes(outline, holes) {
            assert_eq!(ring.len(), corners);
            assert!(ring.len() <= zones::MAX_CORNERS);
        }
    }
});

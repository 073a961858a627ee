//! Drawn flights among zones that the mission keeps clear of: no certified one leaves a fence or enters a zone.
//!
//! 60 flights by default; `FGA_ZONE_FLIGHTS` sets another number.

use core::f64::consts::TAU;

use fga::Vec2;
use fga::avoider::Start;
use fga::situation::Movement;
use fga_formats::zones::polygon;
use fga_sim::batch::{BatchSettings, empty_world, populate};
use fga_sim::encounters::EncounterSource;
use fga_sim::engine::{DecisionMoment, Engine, Observer};
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::{WorldOutline, WorldZone};

/// `SplitMix64` (Steele, Lea and Flood 2014): the same cases on every machine.
struct Random(u64);

impl Random {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// A fence around the line east, 40 m to 300 m off it.
    fn fence(&mut self) -> WorldZone {
        let least_m = self.within(40.0, 200.0);
        let xs = || (0..18).map(|index| -300.0 + 150.0 * f64::from(index));
        let mut corners: Vec<Vec2> = xs()
            .map(|x| Vec2::new(x, -self.within(least_m, least_m + 100.0)))
            .collect();
        corners.extend([Vec2::new(2e6, -least_m), Vec2::new(2e6, least_m)]);
        corners.extend(
            xs().rev()
                .map(|x| Vec2::new(x, self.within(least_m, least_m + 100.0))),
        );
        zone("fence", true, &corners)
    }

    /// A polygon or a circle beside the line, 2 m off it or more.
    fn beside(&mut self, name: &str) -> WorldZone {
        let size_m = self.within(5.0, 80.0);
        let side = if self.within(0.0, 1.0) < 0.5 {
            -1.0
        } else {
            1.0
        };
        let off_m = side * (size_m + self.within(2.0, 80.0));
        let center_m = Vec2::new(self.within(100.0, 1200.0), off_m);
        if self.within(0.0, 1.0) < 0.3 {
            let outline = WorldOutline::Circle {
                center_m,
                radius_m: size_m,
            };
            return WorldZone::new(name.into(), false, outline, ALWAYS_M).unwrap();
        }
        let count = self.within(3.0, 12.0).floor();
        let mut corners = Vec::new();
        let mut corner = 0.0;
        while corner < count {
            let (sin, cos) = (TAU * (corner + self.within(0.0, 0.8)) / count).sin_cos();
            corners.push(center_m + self.within(0.3, 1.0) * size_m * Vec2::new(cos, sin));
            corner += 1.0;
        }
        zone(name, false, &corners)
    }
}

const ALWAYS_M: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

fn zone(name: &str, keep_in: bool, corners: &[Vec2]) -> WorldZone {
    let outline = WorldOutline::Polygon(polygon(corners.to_vec()).unwrap());
    WorldZone::new(name.into(), keep_in, outline, ALWAYS_M).unwrap()
}

/// Whether some decision was not certified.
#[derive(Default)]
struct Unproven(bool);

impl Observer for Unproven {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        self.0 |= moment.decision.record.reason.is_unproven();
    }
}

#[test]
fn no_certified_flight_is_on_the_wrong_side_of_a_zone() {
    let flights = std::env::var("FGA_ZONE_FLIGHTS").map_or(60, |text| text.parse().unwrap());
    let (mut entered, mut lost, mut unproven, mut manoeuvres) = (0, 0, 0, 0);
    for number in 0..flights {
        let random = &mut Random(number);
        let mut model = VehicleModel::built_in().unwrap();
        if number % 2 == 1 {
            model.vehicle.response.bank_time_constant_s = 0.6;
        }
        let settings = BatchSettings {
            model,
            policy: PolicyChoice::Avoider(Start::AtDetection),
            horizon_s: 90.0,
            seed: 3,
            tracks: false,
        };
        let mut world = empty_world(&settings).unwrap();
        let cell =
            ["threats:1:300-600:0-30", "threats:2:300-600:0-60"][usize::from(number % 4 > 1)];
        let encounter = EncounterSource::parse(cell, 11).unwrap().encounter(number);
        populate(&mut world, &encounter, &settings.model.protection);
        if number % 3 == 0 {
            for obstacle in &mut world.obstacles {
                obstacle.movement = Movement::CREWED;
            }
        }
        world.zones = vec![random.fence(), random.beside("one"), random.beside("other")];
        let mut engine = Engine::new();
        let mut pilot = settings
            .policy
            .pilot(&world.settings, &world.vehicle)
            .unwrap();
        let mut seen = Unproven::default();
        let outcome = engine.fly(&world, pilot.as_mut(), &mut seen);
        let worst_m = engine
            .zone_margins()
            .map(|least| least.value_m)
            .fold(f64::INFINITY, f64::min);
        manoeuvres += u64::from(outcome.start_s.is_some());
        unproven += u64::from(seen.0);
        entered += u64::from(worst_m < 0.0);
        lost += u64::from(outcome.min_margin_m < 0.0);
        if worst_m < 0.0 {
            println!("{number}: {worst_m} m, unproven {}", seen.0);
        }
        assert!(seen.0 || worst_m >= 0.0, "{number}: {worst_m} m");
    }
    println!(
        "{flights} flights, {manoeuvres} with a manoeuvre, {unproven} with a decision that is not certified; on the wrong side of \
         a zone {entered}, inside a protected volume {lost}"
    );
    assert!(manoeuvres > flights / 2, "{manoeuvres}");
}

/// A scenario at 47° north, 8° east with a file of areas beside it: the names of its zones and what it warns about, or the error.
fn with_areas(areas: &str) -> Result<(Vec<String>, Vec<String>), String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("areas.geojson"), areas).unwrap();
    let scenario = folder.path().join("a.toml");
    let text = "name = 'a'\nduration_s = 60.0\n[origin]\nlatitude_deg = 47.0\nlongitude_deg = 8.0\naltitude_m = 400.0\n[mission]\n\
        waypoints_m = [[0, 0, 0], [900, 0, 0]]\n[[zone]]\nfile = 'areas.geojson'\nkind = 'keep-out'\nceiling_m = 50.0\n";
    std::fs::write(&scenario, text).unwrap();
    let plan = fga_sim::scenario::read(&scenario, None).map_err(|error| error.to_string())?;
    let zones = &plan.world.zones;
    assert!(
        zones
            .iter()
            .all(|zone| zone.heights_m().1 == 50.0 && !zone.keep_in())
    );
    let names = zones.iter().map(|zone| zone.name().to_owned()).collect();
    Ok((names, plan.warnings()))
}

#[test]
fn every_polygon_of_a_file_is_a_zone_with_its_name() {
    let polygon = |name: &str, [west, south]: [f64; 2]| {
        let (east, north) = (west + 0.001, south + 0.001);
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"Polygon","coordinates":
            [[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}"#
        )
    };
    let file = |features: &[String]| {
        let features = features.join(",");
        format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#)
    };
    let near = [
        polygon("yard", [8.005, 47.002]),
        polygon("", [8.004, 47.01]),
    ];
    let (names, warnings) = with_areas(&file(&near)).unwrap();
    assert_eq!(names, ["yard", "zone 1"]);
    assert!(
        warnings.iter().all(|words| !words.contains("yard")),
        "{warnings:?}"
    );
    // West for east, and longitudes for latitudes; south for north is refused.
    for wrong in [[-8.005, 47.002], [47.002, 8.005]] {
        let (_, warnings) = with_areas(&file(&[polygon("yard", wrong)])).unwrap();
        let told = warnings
            .iter()
            .any(|words| words.contains("yard is ") && words.contains(" km from the start"));
        assert!(told, "{wrong:?} {warnings:?}");
    }
    for (file, expected) in [
        ("{", "areas.geojson, line 1: is no GeoJSON and no KML"),
        (
            r#"{"type":"Polygon","coordinates":[[[8.0,47.0],[8.1,47.1],[8.1,47.0],[8.0,47.1],[8.0,47.0]]]}"#,
            "polygon crosses itself",
        ),
        (
            r#"{"type":"Polygon","coordinates":[[[8.0,47.0],[8.1,47.1],[8.0,47.0]]]}"#,
            "2 corners",
        ),
        (&polygon("yard", [8.005, -47.002]), "km from the origin"),
    ] {
        let told = with_areas(file).unwrap_err();
        assert!(told.contains(expected) && !told.contains('\n'), "{told}");
    }
}

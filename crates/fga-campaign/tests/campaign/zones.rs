//! Drawn flights among zones that the mission keeps clear of: no certified one leaves a fence or enters a zone.
//!
//! 60 flights by default; `FGA_ZONE_FLIGHTS` sets another number.

use core::f64::consts::TAU;

use fga::Vec2;
use fga_campaign::batch::empty_world;
use fga_formats::zones::polygon;
use fga_sim::engine::{DecisionMoment, Engine, Observer};
use fga_sim::world::{WorldOutline, WorldZone};

use crate::drawn::{add_intruders, drawn_settings};
use crate::random::Random;

impl Random {
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
        let settings = drawn_settings(number);
        let mut world = empty_world(&settings).unwrap();
        add_intruders(&mut world, &settings, number);
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

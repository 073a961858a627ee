//! What the search finds, the certificate proves.
//!
//! `FIRST_DECISIONS=1000000 cargo test --release -p fga-search --test proven -- --nocapture` asks more often.

use core::f64::consts::PI;

use fga_mission::Turner;
use fga_proof::Vec3;
use fga_proof::assumptions::Assumptions;
use fga_proof::certificate::Hazard;
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, MotionState};
use fga_proof::situation::ProtectedVolume;
use fga_proof::vehicle::Vehicle;
use fga_search::{Found, Objective, Scene, Search, Tables};

/// Numbers of a linear congruential generator.
struct Draw(u64);

impl Draw {
    fn within(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        from + (self.0 >> 11) as f64 / (1_u64 << 53) as f64 * (to - from)
    }

    fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        self.within(0.0, 1.0);
        of[usize::try_from(self.0 >> 40).unwrap() % of.len()]
    }

    /// An obstacle that meets the aircraft, which flies along +x, or nearly, after some seconds.
    fn hazard(&mut self, index: u32, speed_mps: f64) -> (Hazard, f64) {
        let met_s = self.within(2.0, 25.0);
        let (course_rad, climb_mps) = (self.within(-PI, PI), self.one_of(&[0.0, -2.0, 2.0]));
        let own_speed_mps = self.one_of(&[0.0, 12.0, 20.0, 45.0, 60.0]);
        let (sin, cos) = course_rad.sin_cos();
        let climb_mps = if own_speed_mps > 0.0 { climb_mps } else { 0.0 };
        let velocity_mps = Vec3::new(own_speed_mps * cos, own_speed_mps * sin, climb_mps);
        let radius_m = self.within(10.0, 40.0);
        let volume = if self.within(0.0, 1.0) < 0.5 {
            ProtectedVolume::Sphere { radius_m }
        } else {
            let half_height_m = self.within(5.0, 30.0);
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            }
        };
        let off_m = [self.within(-30.0, 30.0), self.within(-15.0, 15.0)];
        let there_m = Vec3::new(speed_mps * met_s, off_m[0], off_m[1]);
        let mut hazard = Hazard::exact(index, there_m - velocity_mps * met_s, velocity_mps, volume);
        hazard = hazard.growing(self.one_of(&[0.0, 0.0, 0.3]));
        (hazard, met_s)
    }
}

/// What the search found and the certificate did not prove.
#[derive(Default)]
struct Count {
    answers: u32,
    unproven: u32,
    worst_m: f64,
}

impl Count {
    fn ask(&mut self, search: &mut Search<'_>, target_m: f64, found: Option<&Found>) {
        let Some(found) = found.filter(|found| found.margin_m >= target_m) else {
            return;
        };
        self.answers += 1;
        if !search.prove(found) {
            self.unproven += 1;
            let from_rad = search.departure(found.turns.wait_s).course_rad;
            let margin_m = search.certify(&found.turns, from_rad, f64::MIN).margin_m;
            self.worst_m = self.worst_m.max(target_m - margin_m);
        }
    }
}

#[test]
fn s1_what_the_search_finds_the_certificate_proves() {
    let asked = std::env::var("FIRST_DECISIONS");
    let decisions: u32 = asked.map_or(1500, |text| text.parse().unwrap());
    let mut draw = Draw(36);
    let (mut path, mut tables) = (FlightPath::new(), Tables::NONE);
    let mut counts = [(); 5].map(|()| Count::default());
    let mut made = 0;
    for number in 0_u64.. {
        draw.0 ^= number;
        if made >= decisions {
            break;
        }
        let vehicle = match number % 4 {
            0 => Vehicle::table_4(),
            1 => Vehicle::table_4().with_climb(-0.0, 0.0, 0.2),
            2 => Vehicle::lagged(0.6),
            _ => Vehicle {
                airspeed_mps: 22.0,
                turn_radius_m: 49.4,
                ..Vehicle::lagged(0.4)
            },
        };
        let flyer = Turner::new(&vehicle);
        let mut start = MotionState::ahead(0.0);
        if number % 4 >= 2 && number % 3 == 0 {
            start.bank_rad = draw.within(-0.5, 0.5);
        }
        let mut hazards = Vec::new();
        let mut entry_s = f64::INFINITY;
        for index in 0..draw.one_of(&[1, 1, 2, 3, 6]) {
            let (hazard, met_s) = draw.hazard(index, vehicle.airspeed_mps);
            entry_s = entry_s.min(met_s);
            hazards.push(hazard);
        }
        let nominal = Maneuver::hold();
        let scene = Scene {
            flyer: &flyer,
            start,
            nominal: &nominal,
            original: (0.0, 0.0),
            around: Assumptions::only(&hazards),
            horizon_s: 60.0,
            target_m: draw.one_of(&[0.05, 0.05, 2.7]),
            climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
            costs: (0.2, 0.5),
            objective: Objective::PaperCost,
        };
        let target_m = scene.target_m;
        let mut search = |look: &mut dyn FnMut(&mut Search<'_>, &mut [Count; 5])| {
            let mut search = Search::new(
                &scene,
                (&mut path, &mut tables),
                Meter::new(1_000_000, u32::MAX),
            );
            look(&mut search, &mut counts);
            made += 1;
        };
        search(&mut |search, counts| {
            let found = search.cheapest(0.0);
            counts[0].ask(search, target_m, found.as_ref());
        });
        search(&mut |search, counts| {
            let found = search.cheapest(1.5);
            counts[1].ask(search, target_m, found.as_ref());
        });
        search(&mut |search, counts| {
            let [found, other] = search.least_departure(entry_s);
            counts[2].ask(search, target_m, found.as_ref());
            counts[3].ask(search, target_m, other.as_ref());
        });
        if number % 10 == 0 {
            search(&mut |search, counts| {
                let found = search.best(None, fga_search::GRIDS_A_SEARCH, 0);
                counts[4].ask(search, target_m, found.map(|(found, _)| found).as_ref());
            });
        }
    }
    let names = [
        "cheapest",
        "cheapest later",
        "least departure",
        "other side",
        "best",
    ];
    for (name, count) in names.iter().zip(&counts) {
        let Count {
            answers,
            unproven,
            worst_m,
        } = count;
        println!("{name}: {unproven} of {answers} not proven, {worst_m} m short at most");
        assert!(*answers > decisions / 400, "{name}: {answers}");
    }
    let unproven: u32 = counts.iter().map(|count| count.unproven).sum();
    assert_eq!(unproven, 0);
}

//! Time of one decision of every method on the same situations, in one run (the paper's Table 6).
//!
//! `quiet`: three obstacles, none of them a threat, on the line. `first`: three threats at first
//! sight. `engaged`: two seconds into the avoidance, off the line, where every decision also looks for
//! the way back. All times include the guidance along the mission, which all methods share.

use core::hint::black_box;
use core::time::Duration;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use fga::Vec3;
use fga::situation::{Mission, Obstacles, Situation};
use fga::situation::{Obstacle, Ownship, ProtectedVolume};
use fga_sim::plant::{Autopilot, Plant};
use fga_sim::policy::{Pilot, PolicyChoice};
use fga_sim::vehicle_file::VehicleModel;

const POLICIES: [(&str, Option<&str>); 9] = [
    ("published", Some("t0")),
    ("published", Some("tc")),
    ("turn-aware", None),
    ("potential-field", None),
    ("waypoint-greedy", None),
    ("waypoint-optimal", None),
    ("orca", None),
    ("mvp", None),
    ("velocity-obstacles", None),
];

const MISSION_M: [Vec3; 2] = [Vec3::ZERO, Vec3::new(1e5, 0.0, 0.0)];

/// Three that meet the aircraft in 12 to 16 s, or the same moved aside.
fn obstacles(aside_m: f64) -> [Obstacle; 3] {
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let meeting = |id, meet_s: f64, velocity: Vec3| {
        let at = Vec3::new(15.0 * meet_s, aside_m, 0.0) - velocity * meet_s;
        Obstacle::new(id, at, velocity, volume)
    };
    [
        meeting(1, 12.0, Vec3::new(-18.0, 6.0, 0.0)),
        meeting(2, 14.0, Vec3::new(2.0, -20.0, 0.5)),
        meeting(3, 16.0, Vec3::new(-9.0, -9.0, -0.5)),
    ]
}

fn situation(time_s: f64, ownship: Ownship, obstacles: &[Obstacle]) -> Situation<'_> {
    Situation {
        time_s,
        ownship,
        obstacles: Obstacles::Rows(obstacles),
        mission: Mission::new(&MISSION_M),
        wind_mps: Vec3::ZERO,
    }
}

/// Flies `pilot` for two seconds; returns the next situation.
fn engage(pilot: &mut dyn Pilot, model: &VehicleModel) -> (f64, Ownship, [Obstacle; 3]) {
    let mut plant = Plant::new(model.vehicle, Autopilot::default(), Vec3::ZERO);
    plant.place(0.0, Vec3::ZERO, 0.0, 0.0);
    let start = obstacles(0.0);
    let period_s = model.settings.avoider.decision_period_s;
    let mut now = start;
    for cycle in 0..20 {
        let time_s = f64::from(cycle) * period_s;
        now = start.map(|o| Obstacle {
            position_m: o.position_after_m(time_s),
            ..o
        });
        let decision = pilot.step(&situation(time_s, plant.ownship(), &now));
        plant.command(&decision.command, period_s);
        plant.advance(period_s, |_, _| {});
    }
    (20.0 * period_s, plant.ownship(), now)
}

fn decision_times(criterion: &mut Criterion) {
    let model = VehicleModel::built_in().expect("the built-in vehicle");
    let mut settings = model.settings;
    settings.avoider.surveillance_radius_m = f64::INFINITY;
    let start = Ownship {
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: model.vehicle.airspeed_mps,
    };
    for (name, begin) in POLICIES {
        let choice = PolicyChoice::parse(name, begin).expect("a policy by its name");
        let pilot = || {
            choice
                .pilot(&settings, &model.vehicle)
                .expect("settings of Table 4")
        };
        let mut group = criterion.benchmark_group(choice.name().replace(" --start ", "-"));
        for (case, aside_m) in [("quiet", 400.0), ("first", 0.0)] {
            let around = obstacles(aside_m);
            let asked = situation(0.0, start, &around);
            group.bench_function(case, |bencher| {
                bencher.iter_batched_ref(
                    pilot,
                    |pilot| black_box(pilot.step(black_box(&asked))),
                    BatchSize::PerIteration,
                );
            });
        }
        group.bench_function("engaged", |bencher| {
            bencher.iter_batched_ref(
                || {
                    let mut pilot = pilot();
                    let asked = engage(pilot.as_mut(), &model);
                    (pilot, asked)
                },
                |(pilot, (time_s, ownship, around))| {
                    black_box(pilot.step(&situation(*time_s, *ownship, around)))
                },
                BatchSize::PerIteration,
            );
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    // Makes fresh pilots one at a time, in memory that the last one has warmed.
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500));
    targets = decision_times
}
criterion_main!(benches);

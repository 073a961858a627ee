//! Which obstacles threaten, and a step without a threat.

use core::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fga::Vec3;
use fga::avoider::Avoider;
use fga::situation::{Mission, Obstacles, Situation};
use fga_bench::{Crowd, ownship, settings, vehicle};
use fga_paper::conflict::detect;

const COUNTS: [usize; 6] = [1, 3, 10, 100, 1_000, 10_000];

fn detection(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("detection");
    for count in COUNTS {
        group.throughput(Throughput::Elements(count as u64));
        for (name, crowd) in [
            ("as drawn", Crowd::drawn(count, 1)),
            ("in the clear", Crowd::in_the_clear(count, 1)),
        ] {
            let hazards = crowd.hazards();
            group.bench_function(BenchmarkId::new(name, count), |bencher| {
                bencher.iter(|| {
                    detect(black_box(&ownship()), black_box(&hazards), f64::INFINITY)
                        .map(|found| found.index)
                        .sum::<usize>()
                });
            });
        }
    }
    group.finish();
}

fn quiet_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step in the clear");
    let waypoints = [Vec3::ZERO, Vec3::X * 1e5];
    for count in [3, 1_000, 10_000, 100_000] {
        group.throughput(Throughput::Elements(count as u64));
        let crowd = Crowd::in_the_clear(count, 1);
        for (name, obstacles) in [
            ("columns", Obstacles::Columns(crowd.columns())),
            ("rows", Obstacles::Rows(&crowd.rows)),
        ] {
            let settings = settings();
            let mut avoider = Avoider::new(settings, vehicle()).expect("settings are valid");
            let situation = Situation {
                time_s: 0.0,
                ownship: ownship(),
                obstacles,
                mission: Mission::new(&waypoints),
                wind_mps: Vec3::ZERO,
            };
            group.bench_function(BenchmarkId::new(name, count), |bencher| {
                bencher.iter(|| avoider.step(black_box(&situation)).state);
            });
        }
    }
    group.finish();
}

criterion_group!(benches, detection, quiet_step);
criterion_main!(benches);

//! A shortest path of bounded curvature, beside the crate that computes its words.

use core::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use dubins_paths::f64::{DubinsPath as Bare, PosRot};
use fga::Vec3;
use fga_campaign::encounters::{Random, Range};
use fga_paper::dubins::{ClimbLimits, DubinsPath, Pose};

/// Turn radius, metres.
const RADIUS_M: f64 = 30.0;

fn paths(criterion: &mut Criterion) {
    let mut random = Random::new(1, 0);
    let mut pose = || Pose {
        position_m: Vec3::new(
            random.within(Range(-300.0, 300.0)),
            random.within(Range(-300.0, 300.0)),
            0.0,
        ),
        course_rad: random.within(Range(-3.1, 3.1)),
    };
    let pairs: Vec<(Pose, Pose)> = (0..64).map(|_| (pose(), pose())).collect();
    let mut group = criterion.benchmark_group("64 Dubins paths");
    group.bench_function("fga", |bencher| {
        bencher.iter(|| {
            black_box(&pairs)
                .iter()
                .filter_map(|(from, to)| {
                    DubinsPath::shortest(*from, *to, RADIUS_M, ClimbLimits::LEVEL)
                })
                .map(|path| path.length_m())
                .sum::<f64>()
        });
    });
    let bare =
        |pose: &Pose| PosRot::from_floats(pose.position_m.x, pose.position_m.y, pose.course_rad);
    group.bench_function("dubins_paths", |bencher| {
        bencher.iter(|| {
            black_box(&pairs)
                .iter()
                .filter_map(|(from, to)| Bare::shortest_from(bare(from), bare(to), RADIUS_M).ok())
                .map(|path| path.length())
                .sum::<f64>()
        });
    });
    group.finish();
}

criterion_group!(benches, paths);
criterion_main!(benches);

//! Several sources, and faults of one.

use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};

use fga_files::sensors::SensorSource;

use super::{Sensor, SensorSettings};
use crate::obstacle::WorldObstacle;
use crate::track::Track;

fn obstacle(x: f64, vx: f64) -> WorldObstacle {
    WorldObstacle::new(
        7,
        Track::straight(Vec3::new(x, 0.0, 0.0), Vec3::new(vx, 0.0, 0.0)),
        ProtectedVolume::Sphere { radius_m: 1.0 },
    )
}

/// A source with a share of 0.3 shows 30 % of the obstacles, always the same ones.
#[test]
fn a_source_sees_only_the_equipped() {
    let world: Vec<WorldObstacle> = (0..400)
        .map(|id| WorldObstacle {
            id,
            ..obstacle(f64::from(id), 0.0)
        })
        .collect();
    let settings = SensorSettings {
        equipped_share: 0.3,
        ..SensorSettings::default()
    };
    let mut sensor = Sensor::new();
    sensor.begin(settings, world.len(), 1, 2);
    let first: Vec<u32> = ids(sensor.look(0.0, Vec3::ZERO, &world));
    assert_eq!(first, ids(sensor.look(5.0, Vec3::ZERO, &world)));
    // 120 ± 9.
    assert!((85..=155).contains(&first.len()), "{}", first.len());
}

fn ids(seen: &[Obstacle]) -> Vec<u32> {
    seen.iter().map(|seen| seen.id).collect()
}

/// A position error of σ 50 m and an altitude error of σ 20 m stay the same all through a run, and differ
/// from run to run.
#[test]
fn an_error_that_stays_is_the_same_at_every_look() {
    let world = [obstacle(1000.0, -10.0)];
    let settings = SensorSettings {
        position_bias_m: 50.0,
        altitude_bias_m: 20.0,
        ..SensorSettings::default()
    };
    let mut sensor = Sensor::new();
    let (mut across, mut up) = (0.0, 0.0);
    for stream in 0..2000 {
        sensor.begin(settings, 1, 9, stream);
        let off = |sensor: &mut Sensor, time_s: f64| {
            let seen = sensor.look(time_s, Vec3::ZERO, &world)[0];
            assert_eq!(seen.uncertainty.position_m, 50.0);
            seen.position_m - Vec3::X * (1000.0 - 10.0 * time_s)
        };
        let (first, later) = (off(&mut sensor, 0.0), off(&mut sensor, 3.0));
        assert!(first.distance(later) < 1e-9);
        across += first.y * first.y / 2000.0;
        up += first.z * first.z / 2000.0;
    }
    // Variances 2500 and 400, each ± 3.2 %.
    assert!((across / 2500.0 - 1.0).abs() < 0.13, "{across}");
    assert!((up / 400.0 - 1.0).abs() < 0.13, "{up}");
}

/// One look a second. Six interruptions a minute of 5 s each follow each other after 10 s on average, so a third
/// of the time is lost; with coasting of 20 s nothing is.
#[test]
fn interruptions_take_their_share_and_coasting_bridges_them() {
    let world = [obstacle(1e6, -10.0)];
    let run = |coast_s: f64| {
        let settings = SensorSettings {
            update_period_s: 1.0,
            dropouts_per_min: 6.0,
            dropout_s: 5.0,
            coast_s,
            ..SensorSettings::default()
        };
        let mut sensor = Sensor::new();
        sensor.begin(settings, 1, 4, 0);
        let seen = (0..6000).filter(|second| {
            let time_s = f64::from(*second);
            let seen = sensor.look(time_s, Vec3::ZERO, &world);
            // A coasted obstacle that keeps its velocity is where it should be.
            for seen in seen {
                assert!((seen.position_m.x - (1e6 - 10.0 * time_s)).abs() < 1e-6);
            }
            !seen.is_empty()
        });
        f64::from(u32::try_from(seen.count()).unwrap()) / 6000.0
    };
    let share = run(0.0);
    assert!((share - 2.0 / 3.0).abs() < 0.05, "{share}");
    assert!(run(20.0) >= 1.0);
}

/// A radar of 2 km with σ 30 m and a transponder with σ 3 m and no limit: far away only the transponder knows the
/// obstacle, and near it is still the better one; what has no transponder the radar sees within its range.
#[test]
fn of_several_sources_the_best_one_counts() {
    let radar = SensorSettings {
        range_m: 2000.0,
        position_sigma_m: 30.0,
        tracked: false,
        ..SensorSettings::default()
    };
    let transponder = |equipped_share| SensorSettings {
        position_sigma_m: 3.0,
        tracked: false,
        equipped_share,
        ..SensorSettings::default()
    };
    let mut sensor = Sensor::new();
    let mut look = |equipped_share, away_m| {
        let world = [obstacle(away_m, 0.0)];
        sensor.begin_all(radar, &[transponder(equipped_share)], 1, 3, 3);
        let seen = sensor.look(0.0, Vec3::ZERO, &world).first().copied();
        assert_eq!(sensor.known().len(), usize::from(seen.is_some()));
        assert_eq!(sensor.first_seen_s(), [seen.map(|_| 0.0)]);
        seen.map(|seen| seen.uncertainty.position_m)
    };
    assert_eq!(look(1.0, 5000.0), Some(3.0));
    assert_eq!(look(1.0, 1000.0), Some(3.0));
    assert_eq!(look(0.0, 5000.0), None);
    assert_eq!(look(0.0, 1000.0), Some(30.0));
}

#[test]
fn altitude_noise_of_its_own_is_as_large_as_it_says() {
    let world = [obstacle(0.0, 0.0)];
    let settings = SensorSettings {
        position_sigma_m: 2.0,
        altitude_sigma_m: Some(20.0),
        tracked: false,
        ..SensorSettings::default()
    };
    let mut sensor = Sensor::new();
    sensor.begin(settings, 1, 5, 5);
    let (mut across, mut up) = (0.0, 0.0);
    for second in 0..4000 {
        let seen = sensor.look(f64::from(second), Vec3::ZERO, &world)[0];
        across += seen.position_m.y * seen.position_m.y / 4000.0;
        up += seen.position_m.z * seen.position_m.z / 4000.0;
    }
    assert!((across / 4.0 - 1.0).abs() < 0.1 && (up / 400.0 - 1.0).abs() < 0.1);
}

/// What a campaign's `[[sensor]]` does not give is perfect.
#[test]
fn a_source_that_gives_nothing_is_perfect() {
    let perfect = SensorSettings {
        tracked: false,
        ..SensorSettings::default()
    };
    assert_eq!(SensorSettings::from(&SensorSource::default()), perfect);
    let far = SensorSource {
        range_m: None,
        delay_s: Some(0.4),
        ..SensorSource::default()
    };
    assert_eq!(SensorSettings::from(&far).range_m, f64::INFINITY);
    assert_eq!(SensorSettings::from(&far).delay_s, 0.4);
}

/// A receiver's noise, range and misses do not concern an obstacle on a chart, which has an error of its own.
#[test]
fn d7_a_charted_obstacle_has_the_error_of_its_chart() {
    let charted = |sigma_m| WorldObstacle {
        charted_sigma_m: Some(sigma_m),
        ..obstacle(500.0, 0.0)
    };
    let settings = SensorSettings {
        position_sigma_m: 10.0,
        velocity_sigma_mps: 1.0,
        altitude_bias_m: 30.0,
        range_m: 100.0,
        detection_probability: 0.1,
        delay_s: 2.0,
        ..SensorSettings::default()
    };
    let mut errors_m2 = 0.0;
    for stream in 0..200 {
        let mut sensor = Sensor::new();
        for sigma_m in [0.0, 4.0] {
            let world = [charted(sigma_m)];
            sensor.begin(settings, 1, 9, stream);
            let first = sensor.look(0.0, Vec3::ZERO, &world)[0];
            let later = sensor.look(3.0, Vec3::ZERO, &world)[0];
            assert_eq!(first, later);
            assert_eq!(first.velocity_mps, Vec3::ZERO);
            assert_eq!(first.uncertainty.position_m, sigma_m);
            let error_m = first.position_m.distance(Vec3::X * 500.0);
            assert_eq!(error_m == 0.0, sigma_m == 0.0, "{error_m}");
            errors_m2 += error_m * error_m;
        }
    }
    // 3 · 16 · 200 ± 4 standard errors.
    assert!(
        (errors_m2 / (3.0 * 16.0 * 200.0) - 1.0).abs() < 0.24,
        "{errors_m2}"
    );
}

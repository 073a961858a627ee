//! The aircraft's knowledge of the obstacles: what its sources see, and the tracks that follow from it.
//!
//! Each source has its own range, rate, noise and faults, and its own random streams. Where several see an
//! obstacle, the one with the smallest σ of its position counts; where these are equal, the first one.

mod noise;
mod settings;
mod source;

#[cfg(test)]
mod faults;

pub use settings::SensorSettings;

use fga::Vec3;
use fga::situation::Obstacle;

use crate::obstacle::WorldObstacle;
use source::SourceInUse;

/// The sources in use.
#[derive(Debug, Clone, Default)]
pub struct Sensor {
    sources: Vec<SourceInUse>,
    /// The best of what the sources see.
    fused: Vec<Obstacle>,
    first_seen_s: Vec<Option<f64>>,
}

impl Sensor {
    /// A sensor that has seen nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins a run with one source: noise from stream `stream` of `seed`.
    pub fn begin(&mut self, settings: SensorSettings, obstacles: usize, seed: u64, stream: u64) {
        self.begin_all(settings, &[], obstacles, seed, stream);
    }

    /// Begins a run with a source and more of them.
    pub fn begin_all(
        &mut self,
        first: SensorSettings,
        more: &[SensorSettings],
        obstacles: usize,
        seed: u64,
        stream: u64,
    ) {
        let settings = core::iter::once(&first).chain(more);
        self.sources
            .resize_with(1 + more.len(), SourceInUse::default);
        for ((source, settings), place) in self.sources.iter_mut().zip(settings).zip(0_u64..) {
            let seed = seed ^ place.wrapping_mul(noise::NEXT_SOURCE);
            source.begin(*settings, obstacles, seed, stream);
        }
        self.fused.clear();
        self.first_seen_s.clear();
        self.first_seen_s.resize(obstacles, None);
    }

    /// First sight of each obstacle, in the order of the world's.
    pub fn first_seen_s(&self) -> &[Option<f64>] {
        match self.sources.as_slice() {
            [one] => &one.first_seen_s,
            _ => &self.first_seen_s,
        }
    }

    /// The result of the last look, extrapolated to its time.
    pub fn known(&self) -> &[Obstacle] {
        match self.sources.as_slice() {
            [one] => &one.seen,
            _ => &self.fused,
        }
    }

    /// Turns the sensor with the aircraft; fields of regard are about this course, radians.
    pub fn face(&mut self, course_rad: f64) {
        for source in &mut self.sources {
            source.course_rad = course_rad;
        }
    }

    /// The known obstacles at `time_s`, with the sensor at `at_m`.
    pub fn look(&mut self, time_s: f64, at_m: Vec3, world: &[WorldObstacle]) -> &[Obstacle] {
        for source in &mut self.sources {
            source.look(time_s, at_m, world);
        }
        if self.sources.len() > 1 {
            self.fuse(time_s, world);
        }
        self.known()
    }

    /// Takes the best of what the sources see of each obstacle.
    fn fuse(&mut self, time_s: f64, world: &[WorldObstacle]) {
        self.fused.clear();
        for (obstacle, first_seen_s) in world.iter().zip(&mut self.first_seen_s) {
            let mut best: Option<Obstacle> = None;
            for source in &self.sources {
                let seen = source.seen.iter().find(|seen| seen.id == obstacle.id);
                let sigma_m = |of: &Obstacle| of.uncertainty.position_m;
                if let Some(seen) = seen
                    && best.is_none_or(|best| sigma_m(seen) < sigma_m(&best))
                {
                    best = Some(*seen);
                }
            }
            if let Some(best) = best {
                first_seen_s.get_or_insert(time_s);
                self.fused.push(best);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::Track;
    use crate::tracker::LookNoise;
    use crate::tracker::TrackEstimate;
    use fga::situation::{ProtectedVolume, Uncertainty};

    fn obstacle(x: f64, vx: f64) -> WorldObstacle {
        WorldObstacle::new(
            7,
            Track::straight(Vec3::new(x, 0.0, 0.0), Vec3::new(vx, 0.0, 0.0)),
            ProtectedVolume::Sphere { radius_m: 1.0 },
        )
    }

    #[test]
    fn range_appearance_and_first_sight_limit_what_is_seen() {
        let mut late = obstacle(10.0, 0.0);
        late.appears_s = 2.0;
        let mut near = obstacle(500.0, -100.0);
        near.first_seen_m = Some(200.0);
        let world = [obstacle(400.0, 0.0), late, near];
        let settings = SensorSettings {
            range_m: 300.0,
            ..SensorSettings::default()
        };
        let mut sensor = Sensor::new();
        sensor.begin(settings, world.len(), 0, 0);
        assert!(sensor.look(0.0, Vec3::ZERO, &world).is_empty());
        assert_eq!(sensor.look(2.0, Vec3::ZERO, &world).len(), 1);
        assert_eq!(sensor.look(3.0, Vec3::ZERO, &world).len(), 2);
        // Past the aircraft and beyond its first-seen distance it stays known.
        assert_eq!(sensor.look(7.5, Vec3::ZERO, &world).len(), 2);
        assert_eq!(sensor.first_seen_s(), [None, Some(2.0), Some(3.0)]);
    }

    #[test]
    fn obstacles_outside_the_field_of_regard_are_not_seen() {
        let side = WorldObstacle::new(
            8,
            Track::straight(Vec3::new(0.0, 100.0, 0.0), Vec3::ZERO),
            ProtectedVolume::Sphere { radius_m: 1.0 },
        );
        let world = [obstacle(100.0, 0.0), side];
        let settings = SensorSettings {
            field_of_regard_rad: core::f64::consts::FRAC_PI_2,
            ..SensorSettings::default()
        };
        let mut sensor = Sensor::new();
        sensor.begin(settings, world.len(), 0, 0);
        let mut ids = |course_rad: f64| {
            sensor.face(course_rad);
            let seen = sensor.look(course_rad, Vec3::ZERO, &world);
            seen.iter().map(|seen| seen.id).collect::<Vec<_>>()
        };
        assert_eq!(ids(0.0), [7]);
        assert_eq!(ids(0.8), [8]);
        assert_eq!(ids(3.0), [0; 0]);
    }

    #[test]
    fn looks_miss_as_often_as_they_should_and_are_as_old_as_they_should() {
        let world = [obstacle(1000.0, -10.0)];
        let settings = SensorSettings {
            detection_probability: 0.8,
            delay_s: 2.0,
            ..SensorSettings::default()
        };
        let mut sensor = Sensor::new();
        sensor.begin(settings, 1, 3, 4);
        let mut seen = 0;
        for look in 0..2000 {
            let time_s = f64::from(look) * 0.01;
            if let [found] = sensor.look(time_s, Vec3::ZERO, &world) {
                seen += 1;
                // It keeps its velocity, so the extrapolation is exact.
                assert!((found.position_m.x - (1000.0 - 10.0 * time_s)).abs() < 1e-9);
            }
        }
        // 1,600 ± 18.
        assert!((1530..=1670).contains(&seen), "{seen}");
    }

    #[test]
    fn between_looks_tracks_are_carried_on() {
        let world = [obstacle(100.0, -10.0)];
        let settings = SensorSettings {
            update_period_s: 1.0,
            ..SensorSettings::default()
        };
        let mut sensor = Sensor::new();
        sensor.begin(settings, 1, 0, 0);
        for k in 0..25 {
            let time = f64::from(k) * 0.1;
            let seen = sensor.look(time, Vec3::ZERO, &world)[0];
            assert!((seen.position_m.x - (100.0 - 10.0 * time)).abs() < 1e-9);
        }
    }

    #[test]
    fn noise_has_its_spread_and_is_the_same_again() {
        let world = [obstacle(0.0, 0.0)];
        let settings = SensorSettings {
            position_sigma_m: 3.0,
            velocity_sigma_mps: 0.5,
            tracked: false,
            ..SensorSettings::default()
        };
        let run = |stream| {
            let mut sensor = Sensor::new();
            sensor.begin(settings, 1, 42, stream);
            (0..4000)
                .map(|k| {
                    sensor.look(f64::from(k), Vec3::ZERO, &world)[0]
                        .position_m
                        .x
                })
                .collect::<Vec<_>>()
        };
        let (first, again, other) = (run(1), run(1), run(2));
        assert_eq!(first, again);
        assert_ne!(first, other);
        let mean = first.iter().sum::<f64>() / 4000.0;
        let variance = first.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 3999.0;
        // Four standard errors: 3/√4000 for the mean, 9·√(2/3999) for the variance.
        assert!(mean.abs() < 0.19, "{mean}");
        assert!((variance - 9.0).abs() < 0.81, "{variance}");
    }

    /// Over 400 tracks the squared error in units of the reported variance is 1 on average, at the
    /// first look as well as after ten seconds, while the reported σ shrinks to a fraction.
    #[test]
    fn a_track_is_as_good_as_it_says() {
        let world = [obstacle(0.0, 5.0)];
        let settings = SensorSettings {
            position_sigma_m: 3.0,
            velocity_sigma_mps: 0.5,
            ..SensorSettings::default()
        };
        let mut sensor = Sensor::new();
        for looks in [1_u32, 10, 100] {
            let (mut position, mut velocity, mut sigma) = (0.0, 0.0, Uncertainty::default());
            for stream in 0..400 {
                sensor.begin(settings, 1, 7, stream);
                let mut seen = None;
                for k in 0..looks {
                    seen = Some(sensor.look(f64::from(k) * 0.1, Vec3::ZERO, &world)[0]);
                }
                let seen = seen.unwrap();
                let at_m = Vec3::X * (5.0 * 0.1 * f64::from(looks - 1));
                sigma = seen.uncertainty;
                position += (seen.position_m - at_m).length_squared()
                    / 3.0
                    / (sigma.position_m * sigma.position_m);
                velocity += (seen.velocity_mps - Vec3::X * 5.0).length_squared()
                    / 3.0
                    / (sigma.velocity_mps * sigma.velocity_mps);
            }
            // Four standard errors of the mean of 1,200 squares: 4·√(2/1200). The filter allows for
            // an acceleration that is absent, so it may report more than its error.
            assert!(position / 400.0 < 1.17, "{looks}: {}", position / 400.0);
            assert!(velocity / 400.0 < 1.17, "{looks}: {}", velocity / 400.0);
            assert!(position / 400.0 > 0.6 && velocity / 400.0 > 0.4);
            let bound = 1.3 / libm::sqrt(f64::from(looks));
            assert!(sigma.position_m < 3.0 * bound, "{looks}: {sigma:?}");
            assert!(
                sigma.velocity_mps < 0.5 * bound.max(0.2),
                "{looks}: {sigma:?}"
            );
        }
    }

    /// The tracker follows an obstacle that turns off its line by 90° again within two seconds.
    #[test]
    fn a_track_follows_an_obstacle_that_turns() {
        let noise = LookNoise {
            position_m: 3.0,
            velocity_mps: 0.5,
        };
        let along = Vec3::new(20.0, 0.0, 0.0);
        let across = Vec3::new(0.0, 20.0, 0.0);
        let mut track = TrackEstimate::new(0.0, Vec3::ZERO, along, &noise);
        let mut at_m = Vec3::ZERO;
        for k in 1..=80 {
            let velocity = if k <= 60 { along } else { across };
            at_m += velocity * 0.1;
            track.look(f64::from(k) * 0.1, at_m, velocity, &noise);
        }
        assert!(track.velocity_mps.distance(across) < 0.1);
        assert!(track.position_m.distance(at_m) < 0.5);
    }

    /// An aircraft that turns at the standard rate is seen once a second: the velocity of the track is never far behind.
    #[test]
    fn a_track_follows_a_turn_at_the_standard_rate() {
        let noise = LookNoise {
            position_m: 15.0,
            velocity_mps: 1.0,
        };
        let moment = |time_s: f64| {
            let course = 0.052 * (time_s - 60.0).max(0.0);
            let turned_m = Vec3::new(course.sin(), 1.0 - course.cos(), 0.0) * (75.0 / 0.052);
            let at_m = turned_m + Vec3::X * 75.0 * time_s.min(60.0);
            (at_m, Vec3::new(course.cos(), course.sin(), 0.0) * 75.0)
        };
        let (at_m, velocity_mps) = moment(0.0);
        let mut track = TrackEstimate::new(0.0, at_m, velocity_mps, &noise);
        for second in 1..90 {
            let time_s = f64::from(second);
            let (at_m, velocity_mps) = moment(time_s);
            track.look(time_s, at_m, velocity_mps, &noise);
            let off_mps = track.velocity_mps.distance(velocity_mps);
            assert!(off_mps < 5.0, "{time_s} s: {off_mps} m/s");
        }
    }

    /// It knows its velocity better after a gap of some seconds than after one look, and ends after a longer one.
    #[test]
    fn a_missed_look_does_not_end_a_track() {
        let noise = LookNoise {
            position_m: 15.0,
            velocity_mps: 1.0,
        };
        let mut track = TrackEstimate::new(0.0, Vec3::ZERO, Vec3::ZERO, &noise);
        for second in 1..20 {
            track.look(f64::from(second), Vec3::ZERO, Vec3::ZERO, &noise);
        }
        assert!(!track.has_ended(23.0) && track.has_ended(25.0));
        track.look(23.0, Vec3::ZERO, Vec3::ZERO, &noise);
        assert!(track.uncertainty().velocity_mps < 0.4);
    }
}

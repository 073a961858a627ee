//! One source: what it sees, look by look.

use fga::Vec3;
use fga::situation::{MovementBounds, Obstacle, Uncertainty};
use fga_belief::{Belief, Report};

use super::SensorSettings;
use super::noise::{BIASES, CHART, DROPOUTS, EQUIPPED, MISSES, Noise};
use crate::obstacle::{TrackReport, WorldObstacle};
use crate::tracker::TrackEstimate;

/// What a source keeps about an obstacle of the world.
#[derive(Debug, Clone, Default)]
struct KeptObstacle {
    /// Its track, where looks are noisy.
    track: Option<TrackEstimate>,
    /// The belief about it, where beliefs make the tracks.
    belief: Option<Belief>,
    /// The error that its position keeps, metres.
    bias_m: Vec3,
    /// The error of the chart, metres, once it is drawn.
    chart_m: Option<Vec3>,
    /// Whether the source cannot see it at all.
    hidden: bool,
    /// The last sight and its time, seconds, where it coasts.
    last: Option<(f64, Obstacle)>,
}

/// A source in use.
#[derive(Debug, Clone, Default)]
pub(super) struct SourceInUse {
    settings: SensorSettings,
    /// Seed and stream of its random numbers.
    seed: (u64, u64),
    noise: Option<Noise>,
    /// Decides which looks miss; separate from the noise, so that each stays the same without the other.
    misses: Option<Noise>,
    dropouts: Option<Noise>,
    /// The end of the present interruption, seconds.
    out_until_s: f64,
    /// Course of the aircraft, radians.
    pub(super) course_rad: f64,
    /// Time of the last look, seconds.
    last_look_s: f64,
    /// Time of the extrapolated result, seconds.
    carried_to_s: f64,
    /// What is visible at that time.
    pub(super) seen: Vec<Obstacle>,
    known: Vec<KeptObstacle>,
    /// First sight of each obstacle of the world, seconds.
    pub(super) first_seen_s: Vec<Option<f64>>,
}

impl SourceInUse {
    pub(super) fn begin(
        &mut self,
        settings: SensorSettings,
        obstacles: usize,
        seed: u64,
        stream: u64,
    ) {
        self.settings = settings;
        self.seed = (seed, stream);
        self.noise = settings.is_noisy().then(|| Noise::new(seed, stream));
        self.misses =
            (settings.detection_probability < 1.0).then(|| Noise::new(seed ^ MISSES, stream));
        self.dropouts = (settings.dropouts_per_min > 0.0 && settings.dropout_s > 0.0)
            .then(|| Noise::new(seed ^ DROPOUTS, stream));
        self.out_until_s = f64::NEG_INFINITY;
        self.last_look_s = f64::NEG_INFINITY;
        self.seen.clear();
        self.first_seen_s.clear();
        self.first_seen_s.resize(obstacles, None);
        self.known.clear();
        self.known.resize(obstacles, KeptObstacle::default());
        if settings.bias_m() > 0.0 {
            let mut biases = Noise::new(seed ^ BIASES, stream);
            let across_m = settings.position_bias_m;
            let sigma = Vec3::new(across_m, across_m, settings.altitude_bias_m);
            for known in &mut self.known {
                known.bias_m = biases.vector(sigma);
            }
        }
        if settings.equipped_share < 1.0 {
            let mut equipped = Noise::new(seed ^ EQUIPPED, stream);
            for known in &mut self.known {
                known.hidden = equipped.unit() > settings.equipped_share;
            }
        }
    }

    /// The visible obstacles at `time_s`, with the source at `at_m`.
    pub(super) fn look(&mut self, time_s: f64, at_m: Vec3, world: &[WorldObstacle]) {
        let due = time_s >= self.last_look_s + self.settings.update_period_s - 1e-9;
        if due {
            self.see(time_s, at_m, world);
        } else {
            let since_s = time_s - self.carried_to_s;
            for seen in &mut self.seen {
                *seen = carried(seen, since_s);
            }
        }
        self.carried_to_s = time_s;
    }

    fn see(&mut self, time_s: f64, at_m: Vec3, world: &[WorldObstacle]) {
        let is_out = self.is_out(time_s);
        self.seen.clear();
        for (place, obstacle) in world.iter().enumerate() {
            if let Some(sigma_m) = obstacle.charted_sigma_m {
                let charted = self.charted(place, obstacle, sigma_m, (time_s, at_m));
                self.seen.extend(charted);
                continue;
            }
            // Every obstacle draws in every look, so that a miss of one does not change another.
            let missed = self
                .misses
                .as_mut()
                .is_some_and(|misses| misses.unit() > self.settings.detection_probability);
            let sight = if missed || is_out {
                None
            } else {
                self.sight(place, obstacle, time_s, at_m)
            };
            let Some(known) = self.known.get_mut(place) else {
                continue;
            };
            let coast_s = self.settings.coast_s;
            if let Some(sight) = sight {
                let seen = with_noise(sight, time_s, &self.settings, &mut self.noise, known);
                if coast_s > 0.0 {
                    known.last = Some((time_s, seen));
                }
                self.seen.push(seen);
                continue;
            }
            match known.last {
                Some((last_s, last)) if time_s - last_s <= coast_s => {
                    self.seen.push(carried(&last, time_s - last_s));
                }
                _ => known.last = None,
            }
        }
        self.last_look_s = time_s;
    }

    /// Whether the source is interrupted at a look. Interruptions begin as a Poisson process.
    fn is_out(&mut self, time_s: f64) -> bool {
        let Some(dropouts) = &mut self.dropouts else {
            return false;
        };
        let since_s = (time_s - self.last_look_s.max(self.out_until_s)).max(0.0);
        let unit = dropouts.unit();
        if time_s < self.out_until_s {
            return true;
        }
        let since_s = if since_s.is_finite() { since_s } else { 0.0 };
        let begins = 1.0 - libm::exp(-self.settings.dropouts_per_min / 60.0 * since_s);
        if unit <= begins {
            self.out_until_s = time_s + self.settings.dropout_s;
            return true;
        }
        false
    }

    /// An obstacle as the chart shows it.
    fn charted(
        &mut self,
        place: usize,
        obstacle: &WorldObstacle,
        sigma_m: f64,
        (time_s, at_m): (f64, Vec3),
    ) -> Option<Obstacle> {
        let mut seen =
            self.known_now(place, obstacle, obstacle.known_at(time_s)?, (time_s, at_m))?;
        if sigma_m > 0.0 {
            let (seed, stream) = self.seed;
            let error_m = self.known.get_mut(place)?.chart_m.get_or_insert_with(|| {
                let seed = seed ^ CHART ^ u64::from(obstacle.id);
                Noise::new(seed, stream).vector(Vec3::splat(sigma_m))
            });
            seen.position_m += *error_m;
            seen.uncertainty.position_m = sigma_m;
        }
        Some(seen)
    }

    /// Position and velocity of a visible obstacle.
    fn sight(
        &mut self,
        place: usize,
        obstacle: &WorldObstacle,
        time_s: f64,
        at_m: Vec3,
    ) -> Option<Obstacle> {
        let delay_s = self.settings.delay_s;
        let then = obstacle.known_at(time_s - delay_s)?;
        let now = if delay_s > 0.0 {
            then.carried_on(delay_s)
        } else {
            then
        };
        let hidden = self.known.get(place).is_none_or(|known| known.hidden);
        let then_m = then.position_m - at_m;
        if hidden || !self.settings.regards(then_m, self.course_rad) {
            return None;
        }
        let distance_m = now.position_m.distance(at_m);
        if self.settings.range_m < f64::INFINITY && distance_m > self.settings.range_m {
            return None;
        }
        self.known_now(place, obstacle, now, (time_s, at_m))
    }

    /// An obstacle as it is known now, unless it has not appeared or come near yet.
    fn known_now(
        &mut self,
        place: usize,
        obstacle: &WorldObstacle,
        now: TrackReport,
        (time_s, at_m): (f64, Vec3),
    ) -> Option<Obstacle> {
        if time_s < obstacle.appears_s {
            return None;
        }
        let distance_m = now.position_m.distance(at_m);
        let first_seen_s = self.first_seen_s.get_mut(place)?;
        if let Some(first_seen_m) = obstacle.first_seen_m
            && first_seen_s.is_none()
            && distance_m > first_seen_m
        {
            return None;
        }
        first_seen_s.get_or_insert(time_s);
        Some(Obstacle {
            id: obstacle.id,
            position_m: now.position_m,
            velocity_mps: now.velocity_mps,
            volume: obstacle.volume,
            kind: obstacle.kind,
            uncertainty: now.uncertainty,
            movement: obstacle.movement,
            age_s: now.age_s,
        })
    }
}

/// A sight with the errors of the source.
fn with_noise(
    mut seen: Obstacle,
    time_s: f64,
    settings: &SensorSettings,
    noise: &mut Option<Noise>,
    known: &mut KeptObstacle,
) -> Obstacle {
    if let Some(noise) = noise {
        let sigma_m = settings.position_sigma_m;
        seen.position_m += noise.vector(Vec3::new(sigma_m, sigma_m, settings.altitude_sigma_m()));
        let off_mps = noise.vector(Vec3::splat(settings.velocity_sigma_mps));
        seen.velocity_mps += off_mps;
        // It was carried on along the velocity that is seen.
        seen.position_m += off_mps * seen.age_s;
        if settings.tracked && settings.by_belief {
            return believed(seen, time_s, settings, known);
        }
        let sigmas = settings.look_noise();
        let (position_m, velocity_mps) = (seen.position_m, seen.velocity_mps);
        let first = TrackEstimate::new(time_s, position_m, velocity_mps, &sigmas);
        let track = known
            .track
            .take()
            .filter(|track| settings.tracked && !track.has_ended(time_s))
            .map_or(first, |mut track| {
                track.look(time_s, position_m, velocity_mps, &sigmas);
                track
            });
        seen.position_m = track.position_m;
        seen.velocity_mps = track.velocity_mps;
        seen.uncertainty = both(track.uncertainty(), seen.uncertainty);
        known.track = Some(track);
    }
    let bias_m = settings.bias_m();
    if bias_m > 0.0 {
        seen.position_m += known.bias_m;
        seen.uncertainty.position_m = libm::hypot(seen.uncertainty.position_m, bias_m);
    }
    seen
}

/// A noisy sight as the belief about it has it: its means, and the larger σ of position and altitude.
fn believed(
    mut seen: Obstacle,
    time_s: f64,
    settings: &SensorSettings,
    known: &mut KeptObstacle,
) -> Obstacle {
    #[expect(clippy::cast_possible_truncation, reason = "an age of seconds")]
    let carried_s = seen.age_s as f32;
    let report = Report {
        time_s: time_s - seen.age_s,
        position_m: seen.position_m,
        velocity_mps: Some(seen.velocity_mps),
        carried_s,
        errors: settings.errors(),
    };
    let bounds = seen.movement.bounds().unwrap_or(MovementBounds::CREWED);
    let old = known.belief.filter(|belief| !belief.has_ended(time_s));
    let belief = Belief::after(old, &report, &bounds);
    known.belief = Some(belief);
    let estimate = belief.at(time_s);
    let [position_m, velocity_mps] = estimate.sigmas();
    let sigma = Uncertainty {
        position_m,
        velocity_mps,
    };
    seen.position_m = estimate.position_m + known.bias_m;
    seen.velocity_mps = estimate.velocity_mps;
    seen.uncertainty = both(sigma, seen.uncertainty);
    seen.uncertainty.position_m = libm::hypot(seen.uncertainty.position_m, settings.bias_m());
    seen
}

/// Standard deviations of the sum of two independent errors.
fn both(a: Uncertainty, b: Uncertainty) -> Uncertainty {
    Uncertainty {
        position_m: libm::hypot(a.position_m, b.position_m),
        velocity_mps: libm::hypot(a.velocity_mps, b.velocity_mps),
    }
}

/// An obstacle some seconds later, in a straight line.
fn carried(seen: &Obstacle, since_s: f64) -> Obstacle {
    let mut later = *seen;
    later.position_m += seen.velocity_mps * since_s;
    later.age_s += since_s;
    later.uncertainty.position_m += seen.uncertainty.velocity_mps * since_s;
    later
}

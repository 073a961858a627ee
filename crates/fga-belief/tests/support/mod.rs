//! Aircraft whose motion the filter's constants were not chosen on, and reports of them.
#![allow(dead_code, reason = "each test uses a part")]

use std::path::PathBuf;

use fga_belief::{Errors, Report, Sigma, Source};
use fga_proof::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Numbers of one stream.
pub(crate) struct Draw(ChaCha8Rng);

impl Draw {
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    pub(crate) fn unit(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn gaussian(&mut self) -> f64 {
        libm::sqrt(-2.0 * libm::log(self.unit())) * libm::cos(core::f64::consts::TAU * self.unit())
    }

    pub(crate) fn vector(&mut self, across: f64, up: f64) -> Vec3 {
        Vec3::new(
            self.gaussian() * across,
            self.gaussian() * across,
            self.gaussian() * up,
        )
    }
}

/// What an aircraft does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// Straight on, with a constant climb rate.
    Straight,
    /// Round and round at the standard rate, 3° a second.
    Turning,
    /// Turns at the standard rate that begin every 50 s on average, by 20° to 180°, rolled in within three seconds; climbs and
    /// descents of 500 to 1,000 ft a minute and level-offs, every 40 s; speed changes of 0.5 m/s² for ten seconds.
    Mixed,
}

/// Time between two moments of a track, seconds.
pub(crate) const STEP_S: f64 = 0.1;

/// A moment of a track.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub(crate) time_s: f64,
    pub(crate) position_m: Vec3,
    pub(crate) velocity_mps: Vec3,
}

/// A track with a moment each 0.1 s.
pub(crate) fn flown(motion: Motion, duration_s: f64, draw: &mut Draw) -> Vec<Moment> {
    let mut at = Vec3::new(draw.between(-2e3, 2e3), draw.between(-2e3, 2e3), 500.0);
    let (mut course, mut speed) = (draw.between(-3.0, 3.0), draw.between(35.0, 80.0));
    let standard = 3_f64.to_radians();
    let (mut rate, mut rate_wanted, mut turn_ends_s) = (0.0, 0.0, 0.0);
    let mut climb = if draw.unit() < 0.6 {
        0.0
    } else {
        draw.between(-4.0, 4.0)
    };
    let mut climb_wanted = climb;
    let (mut faster, mut faster_ends_s) = (0.0, 0.0);
    if motion == Motion::Turning {
        rate = if draw.unit() < 0.5 {
            standard
        } else {
            -standard
        };
        rate_wanted = rate;
        turn_ends_s = f64::INFINITY;
    }
    let mut track = Vec::new();
    let mut t = 0.0;
    // Ten sub-steps each.
    let dt = STEP_S / 10.0;
    while t < duration_s {
        track.push(Moment {
            time_s: t,
            position_m: at,
            velocity_mps: Vec3::new(speed * libm::cos(course), speed * libm::sin(course), climb),
        });
        if motion == Motion::Mixed {
            let chance = |per_s: f64, draw: &mut Draw| draw.unit() < per_s * STEP_S;
            if rate_wanted == 0.0 && chance(1.0 / 50.0, draw) {
                rate_wanted = if draw.unit() < 0.5 {
                    standard
                } else {
                    -standard
                };
                turn_ends_s = t + draw.between(7.0, 60.0);
            } else if t >= turn_ends_s {
                rate_wanted = 0.0;
            }
            if chance(1.0 / 40.0, draw) {
                climb_wanted = if climb_wanted == 0.0 {
                    draw.between(2.5, 5.1) * if draw.unit() < 0.5 { 1.0 } else { -1.0 }
                } else {
                    0.0
                };
            }
            if t >= faster_ends_s {
                faster = 0.0;
                if chance(1.0 / 60.0, draw) {
                    let sign = if speed > 55.0 { -1.0 } else { 1.0 };
                    (faster, faster_ends_s) = (sign * 0.5, t + 10.0);
                }
            }
        }
        for _ in 0..10 {
            rate += (rate_wanted - rate).clamp(-standard / 3.0 * dt, standard / 3.0 * dt);
            climb += (climb_wanted - climb).clamp(-0.8 * dt, 0.8 * dt);
            speed += faster * dt;
            course += 0.5 * rate * dt;
            at += Vec3::new(speed * libm::cos(course), speed * libm::sin(course), climb) * dt;
            course += 0.5 * rate * dt;
        }
        t += STEP_S;
    }
    track
}

/// What a sensor makes of a track.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    /// Moments from one report to the next.
    pub(crate) every: usize,
    pub(crate) position_m: f64,
    pub(crate) altitude_m: f64,
    pub(crate) velocity_mps: f64,
    pub(crate) lasting_altitude_m: f64,
    /// For how long the sender carries a position on, by the velocity that it states.
    pub(crate) carried_s: f64,
    /// Share of the reports that arrive.
    pub(crate) arriving: f64,
    /// Share of false ones among those.
    pub(crate) is_false: f64,
}

impl Sight {
    pub(crate) fn of(position_m: f64, every: usize) -> Self {
        Self {
            every,
            position_m,
            altitude_m: position_m.min(10.0),
            velocity_mps: 0.1 * position_m.max(3.0),
            lasting_altitude_m: 0.0,
            carried_s: 0.0,
            arriving: 1.0,
            is_false: 0.0,
        }
    }

    pub(crate) fn errors(&self) -> Errors {
        #[expect(clippy::cast_possible_truncation, reason = "a standard deviation")]
        let sigma = |value: f64| Sigma::new(value as f32, Source::Sensor);
        Errors {
            position_m: sigma(self.position_m),
            altitude_m: sigma(self.altitude_m),
            velocity_mps: sigma(self.velocity_mps),
            climb_mps: sigma(self.velocity_mps),
            lasting_position_m: Sigma::default(),
            lasting_altitude_m: sigma(self.lasting_altitude_m),
        }
    }

    /// The report of a moment, if there is one.
    pub(crate) fn report(&self, truth: &Moment, draw: &mut Draw) -> Option<Report> {
        let noise = draw.vector(self.position_m, self.altitude_m);
        let noise_mps = draw.vector(self.velocity_mps, self.velocity_mps);
        let arrives = draw.unit() <= self.arriving;
        let far = if draw.unit() <= self.is_false {
            draw.vector(1000.0, 100.0)
        } else {
            Vec3::ZERO
        };
        arrives.then_some(Report {
            time_s: truth.time_s,
            position_m: truth.position_m
                + noise
                + far
                + (truth.velocity_mps + noise_mps) * self.carried_s,
            velocity_mps: Some(truth.velocity_mps + noise_mps),
            #[expect(clippy::cast_possible_truncation, reason = "seconds")]
            carried_s: self.carried_s as f32,
            errors: self.errors(),
        })
    }
}

/// The tracks of the recorded flights in `FGA_DATA`, or beside the repository. Without the folder none; where CI runs it must
/// be there.
pub(crate) fn recorded() -> Vec<Vec<Moment>> {
    let root = std::env::var_os("FGA_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let folder = root.join("flown");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        let missing = format!("{} is absent (FGA_DATA names its folder)", folder.display());
        assert!(std::env::var_os("CI").is_none(), "{missing}");
        eprintln!("skipped: {missing}");
        return Vec::new();
    };
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "daa"));
    paths.sort();
    let mut tracks = Vec::new();
    for path in paths {
        for aircraft in fga_formats::daa::read(&path).unwrap().aircraft {
            // Recorded climb rates differ from those of the recorded altitudes by up to 7 m/s: velocities are slopes over 1 s.
            let moments = aircraft.samples.windows(11).map(|rows| {
                let velocity_mps =
                    (rows[10].position_m - rows[0].position_m) / (rows[10].time_s - rows[0].time_s);
                Moment {
                    time_s: rows[5].time_s,
                    position_m: rows[5].position_m,
                    velocity_mps,
                }
            });
            tracks.push(moments.collect());
        }
    }
    tracks
}

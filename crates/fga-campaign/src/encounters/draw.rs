//! The families: Table 4's cells and the hard ones.

use fga::Vec3;

use super::family::{Family, Range};
use super::random::{Random, level};
use super::source::{Body, EncounterSource};

impl Family {
    pub(super) fn draw(&self, source: &EncounterSource, random: &mut Random) -> Option<Vec<Body>> {
        Some(match *self {
            Self::Threats(threats) | Self::Among(_, threats) => (0..threats.count)
                .map(|_| level_threat(source, random, threats.first_seen_m, threats.speed_mps))
                .collect::<Option<_>>()?,
            Self::FromAnywhere(threats) => (0..threats.count)
                .map(|_| threat(source, random, threats.first_seen_m, threats.speed_mps))
                .collect::<Option<_>>()?,
            Self::HeadOn {
                first_seen_m,
                speed_mps,
            } => vec![head_on(source, random, first_seen_m, speed_mps)],
            Self::Overtaking => overtaking(source, random),
            Self::Wall { gap } => wall(source, random, gap),
            Self::Stream { count } => stream(source, random, count),
            Self::Pincer { count } => pincer(source, random, count)?,
        })
    }
}

/// A threat meets the aircraft within this time, seconds: well within the horizon of 60 s.
pub(super) const LATEST_MEETING_S: f64 = 45.0;

/// A static obstacle ahead, in the way.
fn static_threat(source: &EncounterSource, random: &mut Random, seen: Range) -> Body {
    let distance = random.within(seen);
    let miss = random.offset(Vec3::X, source.radius_m * (1.0 - 1e-9), source.planar);
    let along = libm::sqrt((distance * distance - miss.dot(miss)).max(0.0));
    Body {
        position_m: Vec3::X * along + miss,
        velocity_mps: Vec3::ZERO,
    }
}

/// The sine of an angle of less than a turn, in turns, to within [`COARSE`]: a parabola a half turn, and its square.
fn coarse_sin(turns: f64) -> f64 {
    let turns = if turns.abs() > 0.5 {
        turns - libm::copysign(1.0, turns)
    } else {
        turns
    };
    let parabola = turns * (8.0 - 16.0 * turns.abs());
    parabola + 0.225 * (parabola * parabola.abs() - parabola)
}

/// Largest error of a coarse sine.
const COARSE: f64 = 0.0011;

/// A threat in level flight at the aircraft's altitude: redrawn until it is one.
fn level_threat(
    source: &EncounterSource,
    random: &mut Random,
    seen: Range,
    speed: Range,
) -> Option<Body> {
    if speed.1 <= 0.0 {
        return Some(static_threat(source, random, seen));
    }
    loop {
        random.again()?;
        let distance = random.within(seen);
        let (bearing, course) = (random.unit(), random.unit());
        let speed = random.within(speed);
        // Seen from the aircraft the body passes it at this sine times the distance; most pass far away.
        let both = speed + source.airspeed_mps;
        let across =
            speed * coarse_sin(course - bearing) + source.airspeed_mps * coarse_sin(bearing);
        if distance * (across.abs() - COARSE * both) > source.radius_m * both {
            continue;
        }
        let body = Body {
            position_m: level(bearing) * distance,
            velocity_mps: level(course) * speed,
        };
        if source.is_threat(&body) && meeting_s(source, &body) <= LATEST_MEETING_S {
            return Some(body);
        }
    }
}

/// The time of the closest approach of both on constant courses, seconds.
fn meeting_s(source: &EncounterSource, body: &Body) -> f64 {
    let relative = body.velocity_mps - Vec3::X * source.airspeed_mps;
    -body.position_m.dot(relative) / relative.dot(relative)
}

/// A threat at a distance, on any bearing from which its speed allows a threat.
fn threat(
    source: &EncounterSource,
    random: &mut Random,
    seen: Range,
    speed: Range,
) -> Option<Body> {
    if speed.1 <= 0.0 {
        return Some(static_threat(source, random, seen));
    }
    let own = Vec3::X * source.airspeed_mps;
    // Relative velocities just inside the cone: rounding must not remove the threat.
    let reach = source.radius_m * (1.0 - 1e-9);
    loop {
        random.again()?;
        let distance = random.within(seen);
        let bearing = random.direction(source.planar);
        let speed = random.within(speed);
        // The relative path passes the aircraft at `miss`; its direction leads from the obstacle
        // to that point, which lies on the perpendicular through the aircraft.
        let miss = random.offset(bearing, reach, source.planar);
        let pick = random.sign();
        let along = libm::sqrt((distance * distance - miss.dot(miss)).max(0.0));
        let position = bearing * along + miss;
        let relative = -bearing;
        // |own + λ·relative| = speed, λ > 0.
        let b = own.dot(relative);
        let root = b * b - own.dot(own) + speed * speed;
        if root < 0.0 {
            continue;
        }
        let lambda = -b + pick * libm::sqrt(root);
        // One root if the obstacle is the faster one: take it whatever the pick.
        let lambda = if speed >= source.airspeed_mps {
            -b + libm::sqrt(root)
        } else {
            lambda
        };
        let body = Body {
            position_m: position,
            velocity_mps: own + relative * lambda,
        };
        let soon = meeting_s(source, &body) <= LATEST_MEETING_S;
        if lambda > 0.0 && soon && source.is_threat(&body) {
            return Some(body);
        }
    }
}

fn head_on(source: &EncounterSource, random: &mut Random, seen: Range, speed: Range) -> Body {
    let distance = random.within(seen);
    let speed = random.within(speed);
    // Half of them exactly head-on, where left and right are equal.
    let off = if random.sign() > 0.0 {
        0.0
    } else {
        0.3 * source.radius_m
    };
    Body {
        position_m: Vec3::X * distance + random.offset(Vec3::X, off, source.planar),
        velocity_mps: -Vec3::X * speed,
    }
}

fn overtaking(source: &EncounterSource, random: &mut Random) -> Vec<Body> {
    let near = 0.5 * source.radius_m;
    let slow = Body {
        position_m: Vec3::X * random.within(Range(80.0, 200.0))
            + random.offset(Vec3::X, near, source.planar),
        velocity_mps: Vec3::X * (source.airspeed_mps * random.within(Range(0.2, 0.8))),
    };
    let fast = Body {
        position_m: -Vec3::X * random.within(Range(100.0, 400.0))
            + random.offset(Vec3::X, near, source.planar),
        velocity_mps: Vec3::X * random.within(Range(25.0, 60.0)),
    };
    vec![slow, fast]
}

fn wall(source: &EncounterSource, random: &mut Random, gap: bool) -> Vec<Body> {
    let ahead = random.within(Range(150.0, 350.0));
    let spacing = 2.0 * source.radius_m * random.within(Range(0.7, 0.95));
    // From one to five spheres on each side of the middle.
    let (left, right) = (random.count(1, 5), random.count(1, 5));
    let shift = spacing * (random.unit() - 0.5);
    // The gap lies between two neighbours, a few metres wider than the two radii.
    let width = 2.0 * source.radius_m + random.within(Range(3.0, 15.0));
    let gap_at = f64::from(random.count(0, left + right - 1)) - f64::from(right);
    let rows: &[f64] = if source.planar {
        &[0.0]
    } else {
        &[0.0, 1.0, -1.0]
    };
    let mut bodies = Vec::new();
    for k in 0..=(left + right) {
        let place = f64::from(k) - f64::from(right);
        let mut across = shift + spacing * place;
        if gap && place > gap_at {
            across += width - spacing;
        }
        for row in rows {
            bodies.push(Body {
                position_m: Vec3::new(ahead, across, row * spacing),
                velocity_mps: Vec3::ZERO,
            });
        }
    }
    bodies
}

fn stream(source: &EncounterSource, random: &mut Random, count: u32) -> Vec<Body> {
    (0..count)
        .map(|k| {
            // It crosses the course at `along` about when the aircraft arrives there.
            let along = 90.0 + 35.0 * f64::from(k) + random.within(Range(-15.0, 15.0));
            let arrival_s = along / source.airspeed_mps + random.within(Range(-3.0, 3.0));
            let speed = random.within(Range(10.0, 30.0));
            let (sin, cos) = libm::sincos(random.within(Range(-0.35, 0.35)));
            let climb = if source.planar {
                0.0
            } else {
                random.within(Range(-0.1, 0.1))
            };
            let velocity_mps = Vec3::new(sin, cos * random.sign(), climb)
                * (speed / libm::sqrt(1.0 + climb * climb));
            let up = if source.planar {
                0.0
            } else {
                random.within(Range(-20.0, 20.0))
            };
            Body {
                position_m: Vec3::new(along, 0.0, up) - velocity_mps * arrival_s,
                velocity_mps,
            }
        })
        .collect()
}

/// Fast threats that arrive within a second of each other.
fn pincer(source: &EncounterSource, random: &mut Random, count: u32) -> Option<Vec<Body>> {
    let arrival_s = random.within(Range(3.0, 6.5));
    (0..count)
        .map(|_| {
            loop {
                let body = level_threat(source, random, Range(180.0, 500.0), Range(40.0, 60.0))?;
                if (meeting_s(source, &body) - arrival_s).abs() < 0.5 {
                    return Some(body);
                }
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_sine_is_as_near_as_it_says() {
        let worst = (-2000..=2000)
            .map(|k| f64::from(k) / 2001.0)
            .map(|turns| (coarse_sin(turns) - libm::sin(turns * core::f64::consts::TAU)).abs())
            .fold(0.0, f64::max);
        assert!(worst < COARSE && worst > 0.9 * COARSE, "{worst}");
    }

    #[test]
    fn a_level_threat_is_the_first_one_that_is_drawn() {
        for cell in [
            "threats:1:100-500:0-60",
            "threats:1:300:15-20",
            "threats:1:40-60:1-5",
        ] {
            let source = EncounterSource::parse(cell, 5).unwrap();
            let Family::Threats(threats) = source.family else {
                unreachable!()
            };
            for number in 0..300 {
                let mut random = Random::new(7, number);
                let mut again = random.clone();
                let expected = loop {
                    let distance = again.within(threats.first_seen_m);
                    let body = Body {
                        position_m: again.direction(true) * distance,
                        velocity_mps: again.direction(true) * again.within(threats.speed_mps),
                    };
                    if source.is_threat(&body) && meeting_s(&source, &body) <= LATEST_MEETING_S {
                        break body;
                    }
                };
                let found = level_threat(
                    &source,
                    &mut random,
                    threats.first_seen_m,
                    threats.speed_mps,
                )
                .unwrap();
                assert_eq!(found.position_m, expected.position_m);
                assert_eq!(found.velocity_mps, expected.velocity_mps);
                assert_eq!(random.unit(), again.unit());
            }
        }
    }
}

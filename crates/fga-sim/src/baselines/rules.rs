//! Rules of the air: who gives way, and how.
//!
//! 14 CFR 91.113 and ICAO Annex 2, 3.2.2: aircraft that meet head-on both turn right; of two that converge, the one with the
//! other on its right gives way; one that overtakes passes to the right of the other, which keeps its course. Who gives way takes the smallest turn to
//! the right that keeps clear, and goes back once the mission does.
//!
//! A pilot who looks out of the window knows of an aircraft late: within sight, and after 12.5 s, the time that FAA AC
//! 90-48D gives from the first sight to the turn.

use core::f64::consts::PI;

use fga::Vec3;
use fga::angle::{course_of, direction, wrap_pi};

use super::Steering;
use super::view::{Sphere, View, levelled};

/// A conflict counts when the entry is within this time, seconds.
const AHEAD_S: f64 = 40.0;

/// Two courses within this of opposite ones meet head-on, radians.
const HEAD_ON_RAD: f64 = 20.0 * PI / 180.0;

/// An aircraft overtakes when it is within this of the other one's tail, radians (14 CFR 91.113 leaves the angle open; ICAO Annex 2: 70°).
const OVERTAKES_RAD: f64 = 70.0 * PI / 180.0;

/// Step and limit of the turn to the right, radians.
const STEP_RAD: f64 = 5.0 * PI / 180.0;
const STEPS: u32 = 18;

/// A pilot's sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eyes {
    /// Range, metres.
    pub range_m: f64,
    /// Field of view to either side of the course, radians.
    pub side_rad: f64,
    /// From the first sight to the turn, seconds.
    pub reaction_s: f64,
    /// Distance that the pilot keeps, metres.
    pub keeps_m: f64,
}

impl Eyes {
    /// One nautical mile, 110° to either side, 12.5 s, 300 m.
    pub const OF_A_PILOT: Self = Self {
        range_m: 1852.0,
        side_rad: 110.0 * PI / 180.0,
        reaction_s: 12.5,
        keeps_m: 300.0,
    };
}

/// The rules, followed with perfect knowledge or by sight.
#[derive(Debug, Default)]
pub struct RightOfWay {
    eyes: Option<Eyes>,
    time_s: f64,
    /// First sight of each aircraft in sight, seconds.
    seen_s: Vec<(u32, f64)>,
    /// The course that gives way, radians.
    course_rad: Option<f64>,
}

impl RightOfWay {
    /// By sight.
    pub fn by_sight(eyes: Eyes) -> Self {
        Self {
            eyes: Some(eyes),
            ..Self::default()
        }
    }

    /// The aircraft that count now.
    fn known(&mut self, view: &View<'_>) -> Vec<Sphere> {
        let Some(eyes) = self.eyes else {
            return view.spheres.to_vec();
        };
        let own_rad = course_of(view.velocity_mps);
        let in_sight = |sphere: &&Sphere| {
            let bearing_rad = wrap_pi(course_of(sphere.offset_m) - own_rad);
            sphere.offset_m.length() <= eyes.range_m && bearing_rad.abs() <= eyes.side_rad
        };
        let before = core::mem::take(&mut self.seen_s);
        let mut known = Vec::new();
        for sphere in view.spheres.iter().filter(in_sight) {
            let first = before.iter().find(|(id, _)| *id == sphere.id);
            let first_s = first.map_or(self.time_s, |(_, first_s)| *first_s);
            self.seen_s.push((sphere.id, first_s));
            if self.time_s - first_s >= eyes.reaction_s - 1e-9 {
                known.push(Sphere {
                    radius_m: eyes.keeps_m,
                    ..*sphere
                });
            }
        }
        known
    }
}

/// Whether a velocity enters a sphere soon.
fn conflicts(sphere: &Sphere, velocity_mps: Vec3) -> bool {
    sphere
        .entry_s(velocity_mps)
        .is_some_and(|entry_s| entry_s <= AHEAD_S)
}

/// Whether the ownship gives way to an aircraft.
fn gives_way(sphere: &Sphere, own_mps: Vec3) -> bool {
    let moves = levelled(sphere.velocity_mps);
    if moves.length() < 1.0 {
        // A balloon, or an obstacle at rest: it has the right of way.
        return true;
    }
    let (own_rad, its_rad) = (course_of(own_mps), course_of(moves));
    let bearing_rad = wrap_pi(course_of(sphere.offset_m) - own_rad);
    let crossing_rad = wrap_pi(its_rad - own_rad).abs();
    if crossing_rad >= PI - HEAD_ON_RAD {
        return true;
    }
    // Where the ownship is, seen from the other one's tail, and the other way round.
    let from_tail_rad = wrap_pi(course_of(sphere.offset_m) - its_rad).abs();
    if from_tail_rad < OVERTAKES_RAD {
        return true;
    }
    let is_overtaken = wrap_pi(bearing_rad - PI).abs() < OVERTAKES_RAD;
    // Left is positive.
    !is_overtaken && bearing_rad < 0.0
}

impl Steering for RightOfWay {
    fn restart(&mut self) {
        *self = Self {
            eyes: self.eyes,
            ..Self::default()
        };
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let known = self.known(view);
        let is_clear = |velocity_mps| !known.iter().any(|sphere| conflicts(sphere, velocity_mps));
        self.time_s += view.period_s;
        let level_mps = levelled(view.velocity_mps);
        if let Some(course_rad) = self.course_rad {
            if is_clear(view.preferred_mps) {
                self.course_rad = None;
                return None;
            }
            let kept_mps = direction(course_rad, 0.0) * view.speed_mps();
            if is_clear(kept_mps) {
                return Some(kept_mps);
            }
        } else if !known
            .iter()
            .any(|sphere| conflicts(sphere, level_mps) && gives_way(sphere, level_mps))
        {
            return None;
        }
        let from_rad = self.course_rad.unwrap_or_else(|| course_of(level_mps));
        let right = |step: u32| from_rad - STEP_RAD * f64::from(step);
        let clear =
            (1..=STEPS).find(|step| is_clear(direction(right(*step), 0.0) * view.speed_mps()));
        // A turn that goes on and on is no way out: a kept course stays where nothing is clear.
        let step = clear.unwrap_or(if self.course_rad.is_some() { 0 } else { STEPS });
        let course_rad = right(step);
        self.course_rad = Some(course_rad);
        Some(direction(course_rad, 0.0) * view.speed_mps())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::RelativeRoute;
    use fga::vehicle::Vehicle;

    fn asked(rules: &mut RightOfWay, offset_m: Vec3, velocity_mps: Vec3) -> Option<f64> {
        let vehicle = Vehicle {
            airspeed_mps: 50.0,
            ..Vehicle::table_4()
        };
        let spheres = [Sphere {
            id: 1,
            offset_m,
            velocity_mps,
            radius_m: 300.0,
        }];
        let view = View {
            velocity_mps: Vec3::X * 50.0,
            preferred_mps: Vec3::X * 50.0,
            route: RelativeRoute {
                foot_m: Vec3::ZERO,
                along: Vec3::X,
            },
            spheres: &spheres,
            vehicle: &vehicle,
            period_s: 1.0,
        };
        rules.steer(&view).map(course_of)
    }

    /// East at 50 m/s: head-on, from the right, from the left, ahead and slower, behind and faster, and past.
    #[test]
    fn who_gives_way_turns_right() {
        let first =
            |offset_m, velocity_mps| asked(&mut RightOfWay::default(), offset_m, velocity_mps);
        let away = Vec3::new(1500.0, 0.0, 0.0);
        for (offset_m, velocity_mps) in [
            (away, Vec3::X * -50.0),
            (Vec3::new(1000.0, -1000.0, 0.0), Vec3::Y * 50.0),
            (away, Vec3::X * 10.0),
            (away, Vec3::ZERO),
        ] {
            let course_rad = first(offset_m, velocity_mps);
            assert!(
                course_rad.is_some_and(|rad| rad < 0.0),
                "{offset_m} {velocity_mps}"
            );
        }
        for (offset_m, velocity_mps) in [
            (Vec3::new(1000.0, 1000.0, 0.0), Vec3::Y * -50.0),
            (Vec3::new(-800.0, 0.0, 0.0), Vec3::X * 80.0),
            (Vec3::new(1500.0, 2000.0, 0.0), Vec3::X * -50.0),
            (Vec3::new(9000.0, 0.0, 0.0), Vec3::X * -50.0),
        ] {
            assert_eq!(
                first(offset_m, velocity_mps),
                None,
                "{offset_m} {velocity_mps}"
            );
        }
    }

    #[test]
    fn a_pilot_turns_12_5_s_after_the_first_sight() {
        let mut pilot = RightOfWay::by_sight(Eyes::OF_A_PILOT);
        let turned = (0..40_i32).find(|second| {
            let ahead_m = 2600.0 - 50.0 * f64::from(*second);
            asked(&mut pilot, Vec3::X * ahead_m, Vec3::ZERO).is_some()
        });
        // Within 1,852 m from second 15 on; the first whole second 12.5 s later is 28.
        assert_eq!(turned, Some(28));
        // Behind the pilot nothing is seen.
        let mut pilot = RightOfWay::by_sight(Eyes::OF_A_PILOT);
        assert!((0..40).all(|_| asked(&mut pilot, Vec3::X * -500.0, Vec3::X * 60.0).is_none()));
    }
}

//! The motions of an intruder that are searched, and their usual distributions.

use core::f64::consts::{FRAC_1_SQRT_2, PI};
use core::fmt::Write as _;

use fga::Vec3;
use fga::angle::direction;
use fga::situation::{Movement, MovementBounds, ProtectedVolume, Uncertainty};
use fga::vehicle::Vehicle;
use fga_judge::track::{Track, TrackPoint};
use fga_sim::obstacle::{TrackReport, WorldObstacle};
use fga_sim::plant::Gust;
use fga_sim::whole::whole;

/// The name of a parameter, with its unit, and its usual distribution.
pub type Parameter = (&'static str, &'static str);

/// The parameters of a motion in their order.
pub const MOTION: [Parameter; 15] = [
    (
        "meeting_s",
        "uniform, 30 to 90: when both meet if neither turns",
    ),
    ("course_rad", "uniform, any direction; 0 the ownship's"),
    (
        "speed_mps",
        "uniform, 0.5 to 2 times the ownship's airspeed",
    ),
    (
        "miss_across_m",
        "uniform, within two radii of the volume to either side",
    ),
    (
        "miss_up_m",
        "uniform, within two half heights of the volume",
    ),
    ("turn_start_s", "uniform, up to the meeting"),
    (
        "turn_rate_radps",
        "normal, the bound at two standard deviations; left positive",
    ),
    ("turn_rad", "uniform, up to the bound"),
    (
        "second_turn_after_s",
        "uniform, up to 30 after the first turn",
    ),
    ("second_turn_rate_radps", "as the first"),
    ("second_turn_rad", "as the first"),
    ("climb_start_s", "uniform, up to the meeting"),
    ("climb_mps", "normal, the bound at two standard deviations"),
    ("loss_start_s", "uniform, up to the meeting"),
    (
        "loss_s",
        "exponential, 1 on average, at most 10: no report for as long",
    ),
];

/// The parameters of a gust in their order.
pub const GUST: [Parameter; 5] = [
    ("gust_start_s", "uniform, 0 to 90"),
    ("gust_s", "uniform, up to 30: its duration"),
    (
        "gust_along_mps",
        "normal with the given standard deviation, at most two of them; along the mission",
    ),
    ("gust_left_mps", "as along the mission"),
    ("gust_up_mps", "as along the mission"),
];

/// Points of the intruder's track from one report to the next: reports come once a second.
const POINTS_A_REPORT: u32 = 4;

/// Time between two points of its track, seconds.
const POINT_S: f64 = 0.25;

/// Longest loss of reports, seconds.
const LONGEST_LOSS_S: f64 = 10.0;

/// A motion of an intruder and the loss of its reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressMotion {
    /// The values of [`MOTION`].
    pub values: [f64; MOTION.len()],
    /// The ownship's airspeed, metres per second.
    own_mps: f64,
}

/// The gust at a point of the standard normal distribution, whose components have a standard deviation.
pub(super) fn gust_of(point: &[f64; GUST.len()], sigma_mps: f64) -> Gust {
    let component = |place: usize| sigma_mps * point[place].clamp(-2.0, 2.0);
    Gust {
        start_s: 90.0 * share_below(point[0]),
        duration_s: 30.0 * share_below(point[1]),
        velocity_mps: Vec3::new(component(2), component(3), component(4)),
    }
}

/// A gust in a few words.
pub(super) fn gust_in_words(gust: &Gust) -> String {
    let Vec3 { x, y, z } = gust.velocity_mps;
    format!(
        "a gust of {x:.1} m/s along the mission, {y:.1} to the left and {z:.1} up from {:.0} s for {:.0} s",
        gust.start_s, gust.duration_s
    )
}

/// Cumulative distribution of the standard normal distribution.
fn share_below(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

impl StressMotion {
    /// The motion at a point of the standard normal distribution.
    pub(super) fn of(
        point: &[f64; MOTION.len()],
        bounds: &MovementBounds,
        vehicle: &Vehicle,
        protection: &ProtectedVolume,
    ) -> Self {
        let within = |place: usize, least: f64, most: f64| {
            least + (most - least) * share_below(point[place])
        };
        let bounded = |place: usize, bound: f64| (0.5 * bound * point[place]).clamp(-bound, bound);
        let own_mps = vehicle.airspeed_mps;
        let (across_m, up_m) = (
            2.0 * protection.radius_m(),
            2.0 * protection.half_height_m(),
        );
        let meeting_s = within(0, 30.0, 90.0);
        // The quantile function of the exponential distribution.
        let loss_s = -libm::log(share_below(-point[14]).max(f64::MIN_POSITIVE));
        Self {
            values: [
                meeting_s,
                within(1, -PI, PI),
                within(2, 0.5 * own_mps, 2.0 * own_mps),
                within(3, -across_m, across_m),
                within(4, -up_m, up_m),
                within(5, 0.0, meeting_s),
                bounded(6, bounds.turn_rate_radps),
                within(7, 0.0, bounds.turn_rad),
                within(8, 0.0, 30.0),
                bounded(9, bounds.turn_rate_radps),
                within(10, 0.0, bounds.turn_rad),
                within(11, 0.0, meeting_s),
                bounded(12, bounds.climb_change_mps),
                within(13, 0.0, meeting_s),
                loss_s.min(LONGEST_LOSS_S),
            ],
            own_mps,
        }
    }

    /// Its velocity before any turn, and its place at the start, from the ownship's.
    fn start(&self) -> (Vec3, Vec3) {
        let [meeting_s, course_rad, speed_mps, across_m, up_m, ..] = self.values;
        let velocity_mps = direction(course_rad, 0.0) * speed_mps;
        let relative = (velocity_mps - Vec3::X * self.own_mps).normalize_or_zero();
        let across = Vec3::new(-relative.y, relative.x, 0.0) * across_m;
        let meeting_m = Vec3::X * (self.own_mps * meeting_s) + across + Vec3::Z * up_m;
        (meeting_m - velocity_mps * meeting_s, velocity_mps)
    }

    /// Whether it begins within three times the volume.
    pub(super) fn begins_too_near(&self, protection: &ProtectedVolume) -> bool {
        let (start_m, _) = self.start();
        start_m.length() < 3.0 * protection.bounding_radius_m()
    }

    /// Course and climb at a time.
    fn heading(&self, time_s: f64) -> (f64, f64) {
        let [
            _,
            course_rad,
            _,
            _,
            _,
            turn_s,
            rate_radps,
            turn_rad,
            after_s,
            again_radps,
            again_rad,
            climb_s,
            climb_mps,
            ..,
        ] = self.values;
        let turned = |start_s: f64, rate_radps: f64, most_rad: f64| {
            let so_far = rate_radps * (time_s - start_s).max(0.0);
            so_far.clamp(-most_rad, most_rad)
        };
        let lasts_s = if rate_radps == 0.0 {
            0.0
        } else {
            turn_rad / rate_radps.abs()
        };
        let again_s = turn_s + lasts_s + after_s;
        let course = course_rad
            + turned(turn_s, rate_radps, turn_rad)
            + turned(again_s, again_radps, again_rad);
        (course, if time_s < climb_s { 0.0 } else { climb_mps })
    }

    /// The intruder: its track, and its reports once a second but for the loss.
    pub(super) fn intruder(
        &self,
        id: u32,
        bounds: MovementBounds,
        volume: ProtectedVolume,
        until_s: f64,
    ) -> WorldObstacle {
        let [_, _, speed_mps, .., loss_start_s, loss_s] = self.values;
        let (mut position_m, _) = self.start();
        let (mut points, mut reports) = (Vec::new(), Vec::new());
        for number in 0..=whole(until_s / POINT_S) + 8 {
            let time_s = f64::from(number) * POINT_S;
            let velocity_at = |time_s: f64| {
                let (course_rad, climb_mps) = self.heading(time_s);
                direction(course_rad, 0.0) * speed_mps + Vec3::Z * climb_mps
            };
            points.push(TrackPoint { time_s, position_m });
            let is_lost = (loss_start_s..loss_start_s + loss_s).contains(&time_s);
            if number % POINTS_A_REPORT == 0 && !(is_lost && number > 0) {
                reports.push(TrackReport {
                    age_s: 0.0,
                    time_s,
                    position_m,
                    velocity_mps: velocity_at(time_s),
                    uncertainty: Uncertainty::default(),
                });
            }
            // The middle of the step.
            position_m += velocity_at(time_s + 0.5 * POINT_S) * POINT_S;
        }
        let track =
            Track::through(points).unwrap_or_else(|| Track::straight(Vec3::ZERO, Vec3::ZERO));
        WorldObstacle {
            movement: Movement::Aircraft(bounds),
            reports,
            ..WorldObstacle::new(id, track, volume)
        }
    }

    /// The motion in one sentence.
    pub fn in_words(&self) -> String {
        let [
            meeting_s,
            course_rad,
            speed_mps,
            across_m,
            up_m,
            turn_s,
            rate_radps,
            turn_rad,
            after_s,
            again_radps,
            again_rad,
            climb_s,
            climb_mps,
            loss_start_s,
            loss_s,
        ] = self.values;
        let mut words = format!(
            "comes at {speed_mps:.1} m/s on a course of {:.0}° to the ownship's and would miss it by {:.0} m to the {} and {up_m:.0} m in \
             altitude at {meeting_s:.0} s",
            course_rad.to_degrees(),
            across_m.abs(),
            if across_m < 0.0 { "right" } else { "left" },
        );
        let mut turn = |when: &str, rate_radps: f64, turn_rad: f64| {
            if rate_radps != 0.0 {
                // Writing to a text does not fail.
                let _ = write!(
                    words,
                    "; turns {:.0}° {} at {:.1} °/s {when}",
                    turn_rad.to_degrees(),
                    if rate_radps > 0.0 { "left" } else { "right" },
                    rate_radps.to_degrees().abs()
                );
            }
        };
        turn(&format!("from {turn_s:.0} s"), rate_radps, turn_rad);
        turn(&format!("{after_s:.0} s later"), again_radps, again_rad);
        if climb_mps != 0.0 {
            let _ = write!(words, "; climbs at {climb_mps:.1} m/s from {climb_s:.0} s");
        }
        let _ = write!(
            words,
            "; no report for {loss_s:.1} s from {loss_start_s:.0} s"
        );
        words
    }
}

//! The view of a method: the aircraft, its wish, and spheres that move straight.

use fga::Vec3;
use fga::angle::direction;
use fga::situation::Situation;
use fga::vehicle::Vehicle;

/// Offset by which the velocity methods see an obstacle at their own height lower, in protected radii.
/// Any value from 0.01 to 0.1 gives the same shares within the error of the search; without it they
/// keep fewer separated (`docs/baselines.md`).
pub(super) const LOWERED: f64 = 0.05;

/// An obstacle for the methods: a sphere on a straight line, relative to the aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its identifier.
    pub id: u32,
    /// From the aircraft to its centre, metres.
    pub offset_m: Vec3,
    /// Its velocity through the air, metres per second.
    pub velocity_mps: Vec3,
    /// Its protected radius plus the margin, metres.
    pub radius_m: f64,
}

impl Sphere {
    /// The same sphere with its radius multiplied by a factor.
    #[must_use]
    pub fn inflated(&self, times: f64) -> Self {
        Self {
            radius_m: self.radius_m * times,
            ..*self
        }
    }

    /// When the aircraft enters it at `velocity_mps`, seconds; 0 inside, `None` for never.
    pub fn entry_s(&self, velocity_mps: Vec3) -> Option<f64> {
        let closing = velocity_mps - self.velocity_mps;
        let c = self.offset_m.length_squared() - self.radius_m * self.radius_m;
        if c <= 0.0 {
            return Some(0.0);
        }
        let a = closing.length_squared();
        let half_b = self.offset_m.dot(closing);
        let discriminant = half_b * half_b - a * c;
        // Ahead and within the cone; the smaller root, written without cancellation.
        (half_b > 0.0 && discriminant > 0.0).then(|| c / (half_b + libm::sqrt(discriminant)))
    }

    /// Time of the closest approach at `velocity_mps`, seconds (negative: in the past), and
    /// the offset of the centre at that time, metres.
    pub fn closest(&self, velocity_mps: Vec3) -> (f64, Vec3) {
        let relative = self.velocity_mps - velocity_mps;
        let square = relative.length_squared();
        if square <= 0.0 {
            return (0.0, self.offset_m);
        }
        let time_s = -self.offset_m.dot(relative) / square;
        (time_s, self.offset_m + relative * time_s)
    }

    /// Least distance to its surface on the straight way from `from_m` to `to_m` (relative to the
    /// aircraft's place now), flown at `speed_mps` from `start_s` on; metres, negative inside.
    pub fn clearance_m(&self, from_m: Vec3, to_m: Vec3, start_s: f64, speed_mps: f64) -> f64 {
        let way = to_m - from_m;
        let duration_s = way.length() / speed_mps;
        let there = Self {
            offset_m: self.offset_m + self.velocity_mps * start_s - from_m,
            ..*self
        };
        if duration_s <= 0.0 {
            return there.offset_m.length() - self.radius_m;
        }
        let velocity = way / duration_s;
        let time_s = there.closest(velocity).0.clamp(0.0, duration_s);
        let offset = there.offset_m + (self.velocity_mps - velocity) * time_s;
        offset.length() - self.radius_m
    }
}

/// The mission relative to the aircraft, over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeRoute {
    /// From the aircraft to the nearest point of the present leg, metres.
    pub foot_m: Vec3,
    /// Unit vector along the leg.
    pub along: Vec3,
}

impl RelativeRoute {
    /// The leg that begins at this waypoint; without one the aircraft's own course, level.
    pub fn of(situation: &Situation<'_>, leg_index: usize) -> Self {
        let own_m = situation.ownship.position_m;
        let waypoints = situation.mission.waypoints_m;
        let leg = waypoints
            .get(leg_index)
            .zip(waypoints.get(leg_index + 1))
            .filter(|(from, to)| from.distance(**to) > 1e-3);
        let Some((from, to)) = leg else {
            return Self {
                foot_m: Vec3::ZERO,
                along: direction(situation.ownship.course_rad, 0.0),
            };
        };
        let along = (*to - *from).normalize_or_zero();
        Self {
            foot_m: *from + along * (own_m - *from).dot(along) - own_m,
            along,
        }
    }
}

/// The input of a method. Velocities are through the air.
#[derive(Debug, Clone)]
pub struct View<'a> {
    /// The aircraft's velocity, metres per second.
    pub velocity_mps: Vec3,
    /// The velocity along the mission, at the airspeed.
    pub preferred_mps: Vec3,
    /// The mission.
    pub route: RelativeRoute,
    /// The obstacles within the surveillance radius.
    pub spheres: &'a [Sphere],
    /// The vehicle's limits.
    pub vehicle: &'a Vehicle,
    /// Time until the next decision, seconds.
    pub period_s: f64,
}

impl View<'_> {
    /// Airspeed, metres per second.
    pub fn speed_mps(&self) -> f64 {
        self.vehicle.airspeed_mps
    }

    /// Whether a velocity is within the vehicle's climb angles.
    pub fn can_climb_along(&self, velocity_mps: Vec3) -> bool {
        let climb = fga::angle::climb_of(velocity_mps);
        climb >= self.vehicle.climb_min_rad - 1e-9 && climb <= self.vehicle.climb_max_rad + 1e-9
    }
}

/// A horizontal vector of the same length.
pub(super) fn levelled(vector: Vec3) -> Vec3 {
    Vec3::new(vector.x, vector.y, 0.0).normalize_or_zero() * vector.length()
}

/// The spheres for a method that may only turn: those that come to this height, cut at it if they
/// keep theirs, without height and without climb.
pub(super) fn flattened(spheres: &[Sphere]) -> impl Iterator<Item = Sphere> + '_ {
    spheres.iter().filter_map(|sphere| {
        let Sphere {
            offset_m,
            velocity_mps,
            radius_m,
            ..
        } = *sphere;
        let radius_m = if velocity_mps.z == 0.0 {
            if offset_m.z.abs() >= radius_m {
                return None;
            }
            libm::sqrt(radius_m * radius_m - offset_m.z * offset_m.z)
        } else {
            radius_m
        };
        Some(Sphere {
            offset_m: Vec3::new(offset_m.x, offset_m.y, 0.0),
            velocity_mps: Vec3::new(velocity_mps.x, velocity_mps.y, 0.0),
            radius_m,
            ..*sphere
        })
    })
}

//! The surroundings of the aircraft: its own state, the obstacles, their protected volumes.

mod movement;

pub use movement::{Movement, MovementBounds};

use crate::Vec3;
use crate::angle::direction;
use crate::ground::Ground;
use crate::zone::Zone;

/// The aircraft's own state in the air mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ownship {
    /// Position, metres, local frame.
    pub position_m: Vec3,
    /// Course through the air ψ, radians from +x towards +y; any turn count is allowed.
    pub course_rad: f64,
    /// Climb angle θ, radians, positive upwards.
    pub climb_rad: f64,
    /// Bank angle φ, radians, positive in a left turn (the course grows).
    pub bank_rad: f64,
    /// Total airspeed `V_u`, metres per second; climbing takes from the horizontal.
    pub airspeed_mps: f64,
}

impl Ownship {
    /// Velocity through the air (Eq. 10–12), metres per second.
    pub fn velocity_mps(&self) -> Vec3 {
        direction(self.course_rad, self.climb_rad) * self.airspeed_mps
    }

    /// Whether every field is a finite number and the airspeed is positive.
    pub fn is_valid(&self) -> bool {
        let angles_rad = [self.course_rad, self.climb_rad, self.bank_rad];
        self.position_m.is_finite()
            && angles_rad.iter().all(|angle_rad| angle_rad.is_finite())
            && self.airspeed_mps.is_finite()
            && self.airspeed_mps > 0.0
    }
}

/// The protected volume around an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProtectedVolume {
    /// A sphere of radius `d_m`.
    Sphere {
        /// `d_m`, metres.
        radius_m: f64,
    },
    /// An upright cylinder: radius `d_m,h`, half height `d_m,v`.
    Cylinder {
        /// `d_m,h`, metres.
        radius_m: f64,
        /// `d_m,v`, metres: the volume reaches this far above and below the obstacle's position.
        half_height_m: f64,
    },
}

impl ProtectedVolume {
    /// Horizontal radius `d_m` or `d_m,h`, metres.
    pub const fn radius_m(&self) -> f64 {
        match *self {
            Self::Sphere { radius_m } | Self::Cylinder { radius_m, .. } => radius_m,
        }
    }

    /// Half height `d_m` or `d_m,v`, metres.
    pub const fn half_height_m(&self) -> f64 {
        match *self {
            Self::Sphere { radius_m } => radius_m,
            Self::Cylinder { half_height_m, .. } => half_height_m,
        }
    }

    /// Radius of the smallest sphere about the centre that contains the volume, metres.
    pub fn bounding_radius_m(&self) -> f64 {
        match *self {
            Self::Sphere { radius_m } => radius_m,
            Self::Cylinder {
                radius_m,
                half_height_m,
            } => libm::sqrt(radius_m * radius_m + half_height_m * half_height_m),
        }
    }

    /// The volume with its surface moved outwards by `by_m` metres everywhere.
    ///
    /// A cylinder grows in radius and half height, which contains the exact offset surface.
    #[must_use]
    pub fn grown(&self, by_m: f64) -> Self {
        self.resized(self.radius_m() + by_m, self.half_height_m() + by_m)
    }

    /// The same shape with a radius and, for a cylinder, a half height, metres.
    pub(crate) const fn resized(&self, radius_m: f64, half_height_m: f64) -> Self {
        match *self {
            Self::Sphere { .. } => Self::Sphere { radius_m },
            Self::Cylinder { .. } => Self::Cylinder {
                radius_m,
                half_height_m,
            },
        }
    }

    /// Signed distance from the surface to a point at `offset_m` from the centre, metres:
    /// negative inside. For a cylinder the distance to the nearest of wall, rim and face.
    pub fn margin_m(&self, offset_m: Vec3) -> f64 {
        if let Self::Sphere { radius_m } = *self {
            return offset_m.length() - radius_m;
        }
        let wall = offset_m.truncate().length() - self.radius_m();
        let face = offset_m.z.abs() - self.half_height_m();
        if wall > 0.0 && face > 0.0 {
            libm::sqrt(wall * wall + face * face)
        } else {
            wall.max(face)
        }
    }
}

/// The nature of an obstacle; it sets the safety score `C_s` of §3.3, which the paper's rules follow. The
/// avoider plans by [`Movement`] instead.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ObstacleKind {
    /// Carries people: `C_s` = 0, the avoidance begins at once.
    Passengers,
    /// Unknown: `C_s` of the policy's setting.
    #[default]
    Unknown,
    /// A natural barrier or a building: `C_s` = 1, the avoidance may begin at the critical time.
    NaturalBarrier,
}

/// The uncertainty of an obstacle: standard deviations along any one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Uncertainty {
    /// σ of the position along an axis, metres.
    pub position_m: f64,
    /// σ of the velocity along an axis, metres per second.
    pub velocity_mps: f64,
}

/// An obstacle as the tracks give it: a point that moves inside its volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// Identifier; unique among the obstacles of one step.
    pub id: u32,
    /// Centre of the volume now, metres, local frame.
    pub position_m: Vec3,
    /// Velocity over the ground, metres per second; zero for an obstacle at rest.
    pub velocity_mps: Vec3,
    /// The protected volume.
    pub volume: ProtectedVolume,
    /// Its nature.
    pub kind: ObstacleKind,
    /// Its uncertainty; it widens the volume.
    pub uncertainty: Uncertainty,
    /// Its possible motion since its report.
    pub movement: Movement,
    /// The age of its report, seconds: position and velocity are carried on from it in a straight line, and its motion may have
    /// changed since. One below 0, as by a rounding, counts as 0.
    pub age_s: f64,
}

impl Obstacle {
    /// An obstacle known exactly, of no particular kind, that keeps its velocity: optimistic for an aircraft.
    pub const fn straight(
        id: u32,
        position_m: Vec3,
        velocity_mps: Vec3,
        volume: ProtectedVolume,
    ) -> Self {
        Self {
            id,
            position_m,
            velocity_mps,
            volume,
            kind: ObstacleKind::Unknown,
            uncertainty: Uncertainty {
                position_m: 0.0,
                velocity_mps: 0.0,
            },
            movement: Movement::Straight,
            age_s: 0.0,
        }
    }

    /// Centre of the volume `after_s` seconds from now, metres.
    pub fn position_after_m(&self, after_s: f64) -> Vec3 {
        self.position_m + self.velocity_mps * after_s
    }

    /// Whether every number is finite and no length is negative.
    pub fn is_valid(&self) -> bool {
        let length_ok = |length: f64| length.is_finite() && length >= 0.0;
        self.position_m.is_finite()
            && self.velocity_mps.is_finite()
            && length_ok(self.volume.radius_m())
            && length_ok(self.volume.half_height_m())
            && length_ok(self.uncertainty.position_m)
            && length_ok(self.uncertainty.velocity_mps)
            && self.age_s.is_finite()
            && self.movement.is_valid()
    }

    /// Whether it is at rest, and yet has a velocity that is known exactly: a measured one may be noise.
    pub fn moves_at_rest(&self) -> bool {
        let is_exact = self.uncertainty.velocity_mps == 0.0;
        self.movement == Movement::AtRest && is_exact && self.velocity_mps != Vec3::ZERO
    }
}

/// How the aircraft passes a waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Passing {
    /// It turns before the waypoint onto the next leg.
    #[default]
    FlyBy,
    /// It turns after the waypoint, which it passes within [`FLY_OVER_WITHIN_M`].
    FlyOver,
}

/// Largest distance at a fly-over waypoint, metres.
pub const FLY_OVER_WITHIN_M: f64 = 5.0;

/// The mission in the local frame: fly from each waypoint to the next along the straight leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mission<'a> {
    /// Waypoints, metres, at least two for a mission; fewer mean: hold course and altitude.
    pub waypoints_m: &'a [Vec3],
    /// The passing of each waypoint; fly-by beyond the end of this list.
    pub passing: &'a [Passing],
    /// The lowest and the highest altitude that a manoeuvre may come to, metres; infinite without a limit. It may come as low
    /// and as high as the waypoints.
    pub limits_m: (f64, f64),
    /// The zones that a manoeuvre keeps out of or within. One that the present leg soon is on the wrong side of does
    /// not bind: the mission is flown as it is given.
    pub zones: &'a [Zone<'a>],
    /// The ground that a manoeuvre keeps above. Where the mission itself soon comes lower, or is over unknown ground, so may
    /// a manoeuvre.
    pub ground: Option<&'a Ground<'a>>,
}

impl<'a> Mission<'a> {
    /// None, over unknown ground without zones.
    pub const NONE: Self = Self::new(&[]);

    /// A mission of fly-by waypoints.
    pub const fn new(waypoints_m: &'a [Vec3]) -> Self {
        Self {
            waypoints_m,
            passing: &[],
            limits_m: (f64::NEG_INFINITY, f64::INFINITY),
            zones: &[],
            ground: None,
        }
    }
}

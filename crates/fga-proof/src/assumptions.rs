//! What is assumed about everything around an aircraft: the only makers of hazards, and what each hazard stands for.
//!
//! | hazard | made by |
//! |---|---|
//! | an obstacle as it was reported, straight on | [`Hazard::new`], [`Hazard::exact`] |
//! | the same, made smaller because the aircraft is already in it | [`Hazard::seen`] |
//! | a turn and a change of climb that an aircraft may fly | [`Hazard::motion`] |
//! | a piece of a future that a belief allows | [`Hazard::passing`] |
//! | an extent of somebody else's model | [`Hazard::given`] |
//! | anything, to compare manoeuvres by | [`Hazard::compared`] |

mod leaving;
mod motion;

pub use crate::certificate::Assumption;
pub use leaving::LEAVING_SHARE;
pub use motion::{CLIMB_CHANGES_S, Changes, SPEED_CHANGES_S, Turn};

use crate::Vec3;
use crate::certificate::{Extent, Fixed, Hazard, NO_DEPTH, Zones};
use crate::meter::Meter;
use crate::situation::{Mission, Movement, Obstacle, ProtectedVolume};

/// Most hazards of a decision.
pub const MAX_HAZARDS: usize = 128;

/// Obstructions that a unit of work looks at.
const LOOKED_AT: usize = 4;

/// Where obstacles are seen from.
#[derive(Debug, Clone, Copy, Default)]
pub struct Viewpoint {
    /// Position of the aircraft, metres.
    pub own_m: Vec3,
    /// The wind, metres per second.
    pub wind_mps: Vec3,
    /// Standard deviations by which a volume is widened.
    pub sigmas: f64,
}

impl Hazard {
    /// Zeros, which are written without a copy.
    pub const NONE: Self = Self {
        extent: Extent {
            window_s: (0.0, 0.0),
            allowed_depth_m: 0.0,
            ..Extent::exact(
                Vec3::ZERO,
                Vec3::ZERO,
                ProtectedVolume::Sphere { radius_m: 0.0 },
            )
        },
        id: 0,
        stands_for: Assumption::Reported,
    };

    /// Of an extent; one out of range is for comparing alone.
    fn of(id: u32, extent: Extent, stands_for: Assumption) -> Self {
        let stands_for = if extent.is_valid() {
            stands_for
        } else {
            Assumption::Compared
        };
        Self {
            extent,
            id,
            stands_for,
        }
    }

    /// The same with its extent changed.
    fn with(&self, change: impl FnOnce(&mut Extent)) -> Self {
        let mut extent = self.extent;
        change(&mut extent);
        Self::of(self.id, extent, self.stands_for)
    }

    /// An extent of somebody else's model, who answers for it.
    pub fn given(id: u32, extent: Extent) -> Self {
        Self::of(id, extent, Assumption::Given)
    }

    /// An extent to compare manoeuvres by.
    pub fn compared(id: u32, extent: Extent) -> Self {
        Self::of(id, extent, Assumption::Compared)
    }

    /// A hazard known exactly, by its motion in the air mass.
    pub fn exact(id: u32, position_m: Vec3, velocity_mps: Vec3, volume: ProtectedVolume) -> Self {
        let extent = Extent::exact(position_m, velocity_mps, volume);
        Self::of(id, extent, Assumption::Reported)
    }

    /// The obstacle in an air mass that moves with `wind_mps`, its volume widened by `sigmas`
    /// standard deviations of position now and of velocity over time.
    pub fn new(obstacle: &Obstacle, wind_mps: Vec3, sigmas: f64) -> Self {
        let uncertainty = obstacle.uncertainty;
        let volume = obstacle.volume.grown(sigmas * uncertainty.position_m);
        let ground_mps = match obstacle.movement {
            Movement::AtRest => Vec3::ZERO,
            _ => obstacle.velocity_mps,
        };
        let (at_m, velocity_mps) = (obstacle.position_m, ground_mps - wind_mps);
        let hazard = Self::exact(obstacle.id, at_m, velocity_mps, volume);
        hazard.growing(sigmas * uncertainty.velocity_mps)
    }

    /// One of the motions of an aircraft, in an air mass that moves with a wind, metres per second. It flies from one place over the ground to
    /// another one, metres, between two moments, seconds, never farther from that line than a bow, metres.
    pub fn passing(
        (id, volume): (u32, ProtectedVolume),
        (from_m, to_m): (Vec3, Vec3),
        window_s: (f64, f64),
        bow_m: f64,
        wind_mps: Vec3,
    ) -> Self {
        let ground_mps = (to_m - from_m) / (window_s.1 - window_s.0);
        let extent = Extent {
            window_s,
            ..Extent::exact(
                from_m - ground_mps * window_s.0,
                ground_mps - wind_mps,
                volume.grown(bow_m),
            )
        };
        Self::of(id, extent, Assumption::Possible)
    }

    /// The obstacle as the aircraft sees it, up to a moment, seconds: a volume that it is already in is made smaller.
    pub fn seen(obstacle: &Obstacle, from: &Viewpoint, until_s: f64) -> Self {
        let mut hazard = Self::new(obstacle, from.wind_mps, from.sigmas);
        hazard.extent.window_s.1 = until_s;
        let offset_m = from.own_m - obstacle.position_m;
        if hazard.volume.margin_m(offset_m) < 0.0 {
            hazard.leave(obstacle, offset_m);
        }
        if until_s < f64::INFINITY {
            // It ends before a flight does: it leads the way out of a zone, or up from the ground.
            hazard.stands_for = hazard.stands_for.max(Assumption::Leaving);
        }
        hazard
    }

    /// The same with a surface that moves outwards, metres per second.
    #[must_use]
    pub fn growing(&self, growth_mps: f64) -> Self {
        self.with(|extent| extent.growth_mps = growth_mps)
    }

    /// The same with its surface moved outwards, metres.
    #[must_use]
    pub fn grown(&self, by_m: f64) -> Self {
        self.with(|extent| extent.volume = extent.volume.grown(by_m.max(0.0)))
    }

    /// The same to compare manoeuvres by: inside a cylinder by their depth.
    #[must_use]
    pub fn by_depth(&self) -> Self {
        let mut extent = self.extent;
        extent.allowed_depth_m = if self.is_cylinder() {
            self.allowed_depth_m.max(0.0)
        } else {
            NO_DEPTH
        };
        Self::compared(self.id, extent)
    }
}

/// Shows each of some obstructions until `visit` returns false. Returns whether none did, and the meter did not refuse it.
#[inline]
pub fn each<O>(all: &[O], meter: &Meter, visit: impl FnMut(&O) -> bool) -> bool {
    meter.take(all.len().div_ceil(LOOKED_AT).max(1)) && all.iter().all(visit)
}

/// All that is assumed around an aircraft.
#[derive(Debug, Clone, Copy)]
pub struct Assumptions<'a> {
    /// The hazards one by one.
    pub rows: &'a [Hazard],
    /// What is fixed over the ground.
    pub fixed: Fixed<'a>,
}

impl<'a> Assumptions<'a> {
    /// Hazards, the zones of a mission that are near, and its ground.
    pub const fn new(rows: &'a [Hazard], zones: &'a Zones, mission: &'a Mission<'a>) -> Self {
        let fixed = Fixed {
            zones,
            mission: mission.zones,
            ground: mission.ground,
        };
        Self { rows, fixed }
    }

    /// Hazards alone.
    pub const fn only(rows: &'a [Hazard]) -> Self {
        Self::new(rows, &Zones::NONE, &Mission::NONE)
    }

    /// The weakest of them.
    pub fn weakest(&self) -> Assumption {
        let all = self.rows.iter().map(Hazard::stands_for);
        all.max().unwrap_or(Assumption::Reported)
    }
}

//! A proven lower bound of the separation along a predicted flight, in continuous time.
//!
//! Between two nodes the flight bows from its chord by at most A·h²/8, where A bounds the
//! acceleration; the chord, taken at constant speed, and an obstacle that moves in a straight line
//! have a relative motion that is a straight line too, on which the least separation has a closed
//! form for a sphere and is the minimum of a convex function for a cylinder. Chord minimum less
//! bow is a lower bound; chords that decide the answer are split until the bow no longer matters.

use crate::Vec3;
use crate::limit::Limit as _;
use crate::maneuver::path::{FlightPath, Node};
use crate::maneuver::{Flyer, MotionState};
use crate::situation::{Obstacle, ProtectedVolume};

/// A chord that decides the answer is split into this many.
const SPLITS: u32 = 5;

/// Golden-section steps on a cylinder's chord: they shrink it by 0.618⁴⁸ ≈ 10⁻¹⁰.
const GOLDEN_STEPS: u32 = 48;

/// An obstacle as the certificate sees it: a volume that moves and grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hazard {
    /// Place of the obstacle in the caller's list.
    pub index: u32,
    /// Centre at time 0, metres, air-mass frame.
    pub position_m: Vec3,
    /// Velocity in the air mass, metres per second.
    pub velocity_mps: Vec3,
    /// The volume at time 0, uncertainty included.
    pub volume: ProtectedVolume,
    /// How fast its surface moves outwards as the prediction ages, metres per second.
    pub growth_mps: f64,
}

impl Hazard {
    /// The obstacle in an air mass that moves with `wind_mps`, its volume widened by `sigmas`
    /// standard deviations of position now and of velocity as time goes on.
    pub fn new(index: u32, obstacle: &Obstacle, wind_mps: Vec3, sigmas: f64) -> Self {
        let uncertainty = obstacle.uncertainty;
        Self {
            index,
            position_m: obstacle.position_m,
            velocity_mps: obstacle.velocity_mps - wind_mps,
            volume: obstacle.volume.grown(sigmas * uncertainty.position_m),
            growth_mps: sigmas * uncertainty.velocity_mps,
        }
    }

    fn offset_m(&self, position_m: Vec3, at_s: f64) -> Vec3 {
        position_m - (self.position_m + self.velocity_mps * at_s)
    }

    /// Signed distance from the volume's surface at a time, metres; negative inside.
    pub fn margin_m(&self, position_m: Vec3, at_s: f64) -> f64 {
        self.volume.margin_m(self.offset_m(position_m, at_s)) - self.growth_mps * at_s
    }

    /// Least margin of a point that moves straight for `duration_s`, and when, if it is below
    /// `below_m`.
    ///
    /// `from_m` and `velocity_mps` are the point's at time `at_s`.
    #[inline]
    pub(crate) fn least_on_line(
        &self,
        from_m: Vec3,
        velocity_mps: Vec3,
        at_s: f64,
        duration_s: f64,
        below_m: f64,
    ) -> Option<(f64, f64)> {
        let offset = self.offset_m(from_m, at_s);
        let velocity = velocity_mps - self.velocity_mps;
        let growth = self.growth_mps;
        let radius = match self.volume {
            ProtectedVolume::Sphere { radius_m } => radius_m,
            ProtectedVolume::Cylinder { .. } => self.volume.bounding_radius_m(),
        } + growth * at_s;
        let square = velocity.length_squared();
        let along = -offset.dot(velocity);
        // Squares only, until the sphere is close enough to matter.
        let nearest_s = if along <= 0.0 {
            0.0
        } else if along >= square * duration_s {
            duration_s
        } else {
            along / square
        };
        let reach = radius + below_m + growth * duration_s;
        if reach < 0.0 {
            return None;
        }
        let nearest_square = (offset + velocity * nearest_s).length_squared();
        if nearest_square >= reach * reach {
            return None;
        }
        let (margin, when) = match self.volume {
            ProtectedVolume::Sphere { .. } if growth == 0.0 => {
                (libm::sqrt(nearest_square) - radius, nearest_s)
            }
            ProtectedVolume::Sphere { .. } => {
                let when = growing_nearest_s(offset, velocity, square, along, growth, duration_s);
                let distance = (offset + velocity * when).length();
                (distance - radius - growth * when, when)
            }
            ProtectedVolume::Cylinder { .. } => {
                let margin =
                    |t: f64| self.volume.margin_m(offset + velocity * t) - growth * (at_s + t);
                let speed = libm::sqrt(square) + growth;
                least_of_convex(margin, duration_s, speed)
            }
        };
        (margin < below_m).then_some((margin, at_s + when))
    }
}

/// When |q + w t| − g t is least on [0, duration]: where the closing speed falls to the growth.
fn growing_nearest_s(
    offset: Vec3,
    velocity: Vec3,
    square: f64,
    along: f64,
    growth: f64,
    duration_s: f64,
) -> f64 {
    let faster = square - growth * growth;
    if faster <= 0.0 {
        // The volume grows faster than the aircraft can leave: the end is worst.
        return duration_s;
    }
    let foot_s = along / square;
    let miss = (offset + velocity * foot_s).length();
    let beyond_s = growth * miss / libm::sqrt(square * faster);
    (foot_s + beyond_s).limited(0.0, duration_s)
}

/// Minimum of a convex function with slope at most `speed` on [0, duration], from below.
fn least_of_convex(margin: impl Fn(f64) -> f64, duration_s: f64, speed: f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (0.0, duration_s);
    let mut left = high - RATIO * (high - low);
    let mut right = low + RATIO * (high - low);
    let (mut at_left, mut at_right) = (margin(left), margin(right));
    for _ in 0..GOLDEN_STEPS {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - RATIO * (high - low);
            at_left = margin(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + RATIO * (high - low);
            at_right = margin(right);
        }
    }
    let middle = 0.5 * (low + high);
    (margin(middle) - 0.5 * speed * (high - low), middle)
}

/// Whether the bound is proven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// The separation is at least the margin over the whole horizon.
    Proven,
    /// The margin is below the floor that was asked for; the rest was not looked at.
    BelowFloor,
    /// The path's nodes ran out before the horizon: nothing is proven beyond them.
    LimitMet,
}

/// What is known of the separation along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Lower bound of the separation beyond the volumes, metres; infinite without obstacles.
    /// No larger than the `enough_m` that was asked for.
    pub margin_m: f64,
    /// Index of the hazard that sets it.
    pub hazard: Option<u32>,
    /// When it is least, seconds from the decision.
    pub at_s: f64,
    /// Whether it is proven.
    pub status: Status,
}

impl Certificate {
    /// Nothing known yet: as good as asked for.
    pub const fn clear(enough_m: f64) -> Self {
        Self {
            margin_m: enough_m,
            hazard: None,
            at_s: 0.0,
            status: Status::Proven,
        }
    }

    /// Whether a separation of `margin_m` beyond the volumes is proven.
    pub fn holds(&self, margin_m: f64) -> bool {
        self.status == Status::Proven && self.margin_m >= margin_m
    }

    /// The worse of two.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        if other.margin_m < self.margin_m {
            other
        } else {
            self
        }
    }
}

/// Bounds the separation from one hazard along a path up to `horizon_s`.
///
/// Stops early below `floor_m`; margins beyond `enough_m` are not told apart.
pub fn certify(
    flyer: &Flyer,
    path: &FlightPath,
    hazard: &Hazard,
    horizon_s: f64,
    floor_m: f64,
    enough_m: f64,
) -> Certificate {
    let nodes = path.nodes();
    // First the chords as they are: none whose margin less its bow is above this can decide.
    let mut decides = Certificate::clear(enough_m);
    for_each_chord(flyer, path, horizon_s, |chord| {
        let below = decides.margin_m - chord.bow_m;
        if let Some((margin, at_s)) = chord.least(hazard, below) {
            lower(&mut decides, margin + chord.bow_m, at_s, hazard);
        }
        decides.margin_m >= floor_m
    });
    if decides.margin_m < floor_m {
        return Certificate {
            status: Status::BelowFloor,
            ..decides
        };
    }
    // Then those that can, split until the bow no longer matters.
    let mut worst = decides;
    for_each_chord(flyer, path, horizon_s, |chord| {
        if chord.least(hazard, worst.margin_m + chord.bow_m).is_some() {
            chord.split(flyer, hazard, &mut worst);
        }
        worst.margin_m >= floor_m
    });
    if worst.margin_m < floor_m {
        return Certificate {
            status: Status::BelowFloor,
            ..worst
        };
    }
    if let Some(last) = nodes.last().filter(|last| last.state.time_s <= horizon_s) {
        let state = &last.state;
        let duration_s = horizon_s - state.time_s;
        let velocity = path.end_velocity_mps();
        let below = worst.margin_m;
        if let Some((margin_m, at_s)) =
            hazard.least_on_line(state.position_m, velocity, state.time_s, duration_s, below)
        {
            worst = Certificate {
                margin_m,
                at_s,
                hazard: Some(hazard.index),
                ..worst
            };
        }
    }
    worst.status = if worst.margin_m < floor_m {
        Status::BelowFloor
    } else if path.is_complete() {
        Status::Proven
    } else {
        Status::LimitMet
    };
    worst
}

/// Bounds the separation from every hazard along a path: the worst of [`certify`].
pub fn certify_all(
    flyer: &Flyer,
    path: &FlightPath,
    hazards: &[Hazard],
    horizon_s: f64,
    floor_m: f64,
    enough_m: f64,
) -> Certificate {
    let mut worst = Certificate::clear(enough_m);
    for hazard in hazards {
        let one = certify(flyer, path, hazard, horizon_s, floor_m, worst.margin_m);
        worst = Certificate {
            status: worst.status,
            ..worst.worse(one)
        };
        if one.status != Status::Proven {
            worst.status = one.status;
            if one.status == Status::BelowFloor {
                return worst;
            }
        }
    }
    if !path.is_complete() {
        worst.status = Status::LimitMet;
    }
    worst
}

/// The straight line between two moments of a flight, taken at constant speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chord<'a> {
    node: &'a Node,
    end_m: Vec3,
    duration_s: f64,
    velocity_mps: Vec3,
    /// How far the flight may bow from it, metres.
    pub(crate) bow_m: f64,
}

impl<'a> Chord<'a> {
    /// From a node to a later moment on its piece; `None` where no time passes.
    #[inline]
    pub(crate) fn new(node: &'a Node, end_m: Vec3, end_s: f64) -> Option<Self> {
        let duration_s = end_s - node.state.time_s;
        (duration_s > 0.0).then(|| Self {
            node,
            end_m,
            duration_s,
            velocity_mps: (end_m - node.state.position_m) / duration_s,
            bow_m: node.acceleration_mps2 * duration_s * duration_s / 8.0,
        })
    }

    /// Least margin on the chord and when, if it is below `below_m`.
    #[inline]
    pub(crate) fn least(&self, hazard: &Hazard, below_m: f64) -> Option<(f64, f64)> {
        let from = &self.node.state;
        hazard.least_on_line(
            from.position_m,
            self.velocity_mps,
            from.time_s,
            self.duration_s,
            below_m,
        )
    }

    /// Lowers `worst` to a bound over the shorter chords between exact points in between.
    fn split(&self, flyer: &Flyer, hazard: &Hazard, worst: &mut Certificate) {
        let mut from: MotionState = self.node.state;
        if self.bow_m == 0.0 {
            if let Some((margin, at_s)) = self.least(hazard, worst.margin_m) {
                lower(worst, margin, at_s, hazard);
            }
            return;
        }
        let piece = self.node.piece();
        let step_s = self.duration_s / f64::from(SPLITS);
        let bow_m = self.bow_m / f64::from(SPLITS * SPLITS);
        for part in 1..=SPLITS {
            let to = if part == SPLITS {
                MotionState {
                    position_m: self.end_m,
                    ..from
                }
            } else {
                flyer.advance(&from, &piece, step_s)
            };
            let velocity = (to.position_m - from.position_m) / step_s;
            let below = worst.margin_m + bow_m;
            if let Some((margin, at_s)) =
                hazard.least_on_line(from.position_m, velocity, from.time_s, step_s, below)
            {
                lower(worst, margin - bow_m, at_s, hazard);
            }
            from = to;
        }
    }

    /// A bound of the margin, no finer than it takes to tell whether it is at least `floor_m`:
    /// lowers `worst` to it.
    #[inline]
    pub(crate) fn bound(
        &self,
        flyer: &Flyer,
        hazard: &Hazard,
        floor_m: f64,
        worst: &mut Certificate,
    ) {
        let Some((margin, at_s)) = self.least(hazard, worst.margin_m + self.bow_m) else {
            return;
        };
        if margin - self.bow_m < floor_m && margin + self.bow_m >= floor_m {
            self.split(flyer, hazard, worst);
        } else {
            lower(worst, margin - self.bow_m, at_s, hazard);
        }
    }
}

/// Shows the chords of a path up to `horizon_s`, the last one cut there, until `visit` is false.
#[inline]
fn for_each_chord(
    flyer: &Flyer,
    path: &FlightPath,
    horizon_s: f64,
    mut visit: impl FnMut(&Chord<'_>) -> bool,
) {
    for pair in path.nodes().windows(2) {
        let [node, next] = pair else { continue };
        if node.state.time_s >= horizon_s {
            return;
        }
        let chord = if next.state.time_s > horizon_s {
            let end = flyer.advance(&node.state, &node.piece(), horizon_s - node.state.time_s);
            Chord::new(node, end.position_m, horizon_s)
        } else {
            Chord::new(node, next.state.position_m, next.state.time_s)
        };
        if chord.is_some_and(|chord| !visit(&chord)) {
            return;
        }
    }
}

fn lower(worst: &mut Certificate, margin_m: f64, at_s: f64, hazard: &Hazard) {
    if margin_m < worst.margin_m {
        *worst = Certificate {
            margin_m,
            at_s,
            hazard: Some(hazard.index),
            ..*worst
        };
    }
}

//! The true distance of the aircraft from the obstacles, over continuous time.
//!
//! The least signed distance between flown [`Arc`]s and an obstacle's protected volume, to better
//! than a millimetre, without sampling every moment: between two moments the path departs
//! from its chord by at most a·h²/8, and a distant obstacle needs no check for the time that
//! closing the distance takes. This measures flights; nothing that decides uses it.

use fga_proof::Vec3;
use fga_proof::situation::ProtectedVolume;

use crate::arc::Arc;
use crate::track::Track;

/// Below this departure from the chord a piece counts as straight, metres.
pub const STRAIGHT_M: f64 = 1e-4;

/// The measured quantity.
#[derive(Debug, Clone, Copy)]
enum Measure {
    /// Distance between the centres.
    Distance,
    /// Signed distance to the volume.
    Margin(ProtectedVolume),
}

impl Measure {
    fn of(&self, offset_m: Vec3) -> f64 {
        match self {
            Self::Distance => offset_m.length(),
            Self::Margin(volume) => margin_m(volume, offset_m),
        }
    }

    /// Least value along the straight line from `from_m` to `to_m`, and its share of the line.
    /// Skipped (infinite) if it cannot be below `below_m`.
    fn least_on_chord(&self, from_m: Vec3, to_m: Vec3, below_m: f64) -> (f64, f64) {
        let along = to_m - from_m;
        let square = along.length_squared();
        let share = if square > 0.0 {
            (-from_m.dot(along) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let distance = (from_m + along * share).length();
        match self {
            Self::Distance => (distance, share),
            Self::Margin(ProtectedVolume::Sphere { radius_m }) => (distance - radius_m, share),
            Self::Margin(volume) => {
                if distance - bounding_m(volume) >= below_m
                    || self.at_least_on_chord(from_m, to_m) >= below_m
                {
                    return (f64::INFINITY, share);
                }
                // The signed distance to a convex body is convex along a line.
                let value = |share: f64| self.of(from_m + along * share);
                // To 1e-12 of the line. Tests the ends too: the search stays inside.
                [0.0, least_at(value, 1.0, 69), 1.0]
                    .map(|share| (value(share), share))
                    .into_iter()
                    .fold((f64::INFINITY, 0.0), |best, next| {
                        if next.0 < best.0 { next } else { best }
                    })
            }
        }
    }

    /// A lower bound of [`Self::of`] along the straight line from `from_m` to `to_m`: the least
    /// distance beside the axis and the least one above, each by itself.
    fn at_least_on_chord(&self, from_m: Vec3, to_m: Vec3) -> f64 {
        let along_m = to_m - from_m;
        let square = across(along_m, along_m);
        let share = if square > 0.0 {
            (-across(from_m, along_m) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let beside_m = from_m + along_m * share;
        let above_m = if from_m.z * to_m.z <= 0.0 {
            0.0
        } else {
            from_m.z.abs().min(to_m.z.abs())
        };
        self.of(Vec3::new(beside_m.x, beside_m.y, above_m))
    }
}

/// Signed distance from the surface of a volume to a point at an offset from its centre, metres: negative inside.
pub(crate) fn margin_m(volume: &ProtectedVolume, offset_m: Vec3) -> f64 {
    match *volume {
        ProtectedVolume::Sphere { radius_m } => offset_m.length() - radius_m,
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let wall_m = libm::sqrt(across(offset_m, offset_m)) - radius_m;
            let face_m = offset_m.z.abs() - half_height_m;
            if wall_m > 0.0 && face_m > 0.0 {
                libm::sqrt(wall_m * wall_m + face_m * face_m)
            } else {
                wall_m.max(face_m)
            }
        }
    }
}

/// Radius of the smallest sphere about the centre that contains a volume, metres.
pub(crate) fn bounding_m(volume: &ProtectedVolume) -> f64 {
    match *volume {
        ProtectedVolume::Sphere { radius_m } => radius_m,
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => libm::sqrt(radius_m * radius_m + half_height_m * half_height_m),
    }
}

/// Where a convex function is least between 0 and an end, by leaving out a third of the rest some times.
pub fn least_at(value: impl Fn(f64) -> f64, end: f64, times: u32) -> f64 {
    let (mut low, mut high) = (0.0, end);
    for _ in 0..times {
        let third = (high - low) / 3.0;
        let (left, right) = (low + third, high - third);
        if value(left) <= value(right) {
            high = right;
        } else {
            low = left;
        }
    }
    0.5 * (low + high)
}

/// The horizontal part of a dot product.
fn across(a: Vec3, b: Vec3) -> f64 {
    a.x * b.x + a.y * b.y
}

/// A least value and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Least {
    /// The value, metres; infinite before anything was measured.
    pub value_m: f64,
    /// When, seconds since the start of the run.
    pub time_s: f64,
}

impl Least {
    /// Nothing measured yet.
    pub const NONE: Self = Self {
        value_m: f64::INFINITY,
        time_s: 0.0,
    };

    /// Takes a value that is less.
    pub fn note(&mut self, value_m: f64, time_s: f64) {
        if value_m < self.value_m {
            *self = Self { value_m, time_s };
        }
    }
}

/// The least separation from one obstacle so far.
#[derive(Debug, Clone, Copy)]
pub struct Separation {
    volume: ProtectedVolume,
    margin: Least,
    distance: Least,
    /// Nothing can become smaller before this time.
    skip_until_s: f64,
}

impl Separation {
    /// Nothing measured yet.
    pub fn new(volume: ProtectedVolume) -> Self {
        Self {
            volume,
            margin: Least::NONE,
            distance: Least::NONE,
            skip_until_s: f64::NEG_INFINITY,
        }
    }

    /// Least signed distance to the protected volume: negative inside.
    pub fn margin(&self) -> Least {
        match self.volume {
            ProtectedVolume::Sphere { radius_m } => Least {
                value_m: self.distance.value_m - radius_m,
                time_s: self.distance.time_s,
            },
            ProtectedVolume::Cylinder { .. } => self.margin,
        }
    }

    /// Least distance between the centres.
    pub fn distance(&self) -> Least {
        self.distance
    }

    /// Measures a single moment.
    pub fn observe_moment(&mut self, time_s: f64, offset_m: Vec3) {
        self.distance.note(offset_m.length(), time_s);
        self.margin.note(margin_m(&self.volume, offset_m), time_s);
    }

    /// Measures a flown arc that ends at `end_m`.
    #[inline]
    pub fn observe(&mut self, arc: &Arc, end_m: Vec3, track: &Track) {
        if arc.start_s + arc.duration_s <= self.skip_until_s {
            return;
        }
        self.observe_near(arc, end_m, track);
    }

    fn observe_near(&mut self, arc: &Arc, end_m: Vec3, track: &Track) {
        let end_s = arc.start_s + arc.duration_s;
        let acceleration_mps2 = arc.acceleration_bound_mps2();
        if let Track::Straight {
            position_m,
            velocity_mps,
        } = *track
            && let ProtectedVolume::Sphere { .. } = self.volume
        {
            let from_m = arc.position_m - (position_m + velocity_mps * arc.start_s);
            let to_m = end_m - (position_m + velocity_mps * end_s);
            let departure_m = departure_m(acceleration_mps2, arc.duration_s);
            // Most arcs come nearer all the time. What is nearest at its end may come nearer at once.
            if recedes(to_m.dot(from_m - to_m), to_m.length_squared(), departure_m)
                && to_m.length() < self.distance.value_m
            {
                self.distance.note(to_m.length(), end_s);
                self.skip_until_s = end_s;
                return;
            }
        }
        let mut last = None;
        track.for_each_leg(arc.start_s, end_s, |leg| {
            let offset_at = |time_s: f64| {
                // Most pieces are whole arcs, whose ends are known.
                let at_m = if time_s == arc.start_s {
                    arc.position_m
                } else if time_s == end_s {
                    end_m
                } else {
                    arc.position_at_m(time_s - arc.start_s)
                };
                at_m - leg.position_at_m(time_s)
            };
            let piece = SeparationPiece {
                offset_at: &offset_at,
                acceleration_mps2,
                upward_mps2: arc.airspeed_mps * arc.climb_rate_radps.abs(),
            };
            let from = (leg.from_s, offset_at(leg.from_s));
            let to = (leg.to_s, offset_at(leg.to_s));
            piece.refine(Measure::Distance, from, to, &mut self.distance);
            if let ProtectedVolume::Cylinder { .. } = self.volume {
                piece.refine_margin(&self.volume, from, to, &mut self.margin);
            }
            last = Some(to.1);
        });
        // The distance shrinks by no more than both speeds a second.
        if let (Some(offset), Some(speed_bound)) = (last, track.speed_bound_mps()) {
            let closing = arc.speed_bound_mps() + speed_bound;
            let mut room = offset.length() - self.distance.value_m;
            if let ProtectedVolume::Cylinder { .. } = self.volume {
                room = room.min(margin_m(&self.volume, offset) - self.margin.value_m);
            }
            self.skip_until_s = if closing > 0.0 {
                end_s + (room - STRAIGHT_M).max(0.0) / closing
            } else {
                f64::INFINITY
            };
        }
    }
}

/// Largest distance of a path from its chord, metres.
fn departure_m(acceleration_mps2: f64, span_s: f64) -> f64 {
    acceleration_mps2 * span_s * span_s / 8.0
}

/// Relative motion while the obstacle flies straight.
struct SeparationPiece<'a, F: Fn(f64) -> Vec3> {
    offset_at: &'a F,
    acceleration_mps2: f64,
    /// Bound of the vertical acceleration, metres per second squared.
    upward_mps2: f64,
}

/// Whether a path moves on away from a place `end_m` all the time, seen from there along the chord `away_m`.
///
/// Between its ends the path is off the chord by less than a/2 · h times the time to the nearer one:
/// where the chord recedes faster than that, `end_m` is the nearest place. `departure_m` is a·h²/8.
fn recedes(along: f64, end_square: f64, departure_m: f64) -> bool {
    along > 0.0 && along * along > 16.0 * departure_m * departure_m * end_square
}

impl<F: Fn(f64) -> Vec3> SeparationPiece<'_, F> {
    fn refine(&self, measure: Measure, from: (f64, Vec3), to: (f64, Vec3), least: &mut Least) {
        let span_s = to.0 - from.0;
        let departure_m = departure_m(self.acceleration_mps2, span_s);
        // Most pieces come nearer or lead away all the time.
        if let Measure::Distance = measure {
            let along_m = to.1 - from.1;
            let nearer = if recedes(-to.1.dot(along_m), to.1.length_squared(), departure_m) {
                Some(to)
            } else if recedes(from.1.dot(along_m), from.1.length_squared(), departure_m) {
                Some(from)
            } else {
                None
            };
            if let Some((time_s, offset_m)) = nearer {
                least.note(measure.of(offset_m), time_s);
                return;
            }
        }
        let (chord_m, share) = measure.least_on_chord(from.1, to.1, least.value_m + departure_m);
        if chord_m - departure_m >= least.value_m {
            return;
        }
        if departure_m <= STRAIGHT_M || span_s < 1e-6 {
            let time_s = from.0 + share * span_s;
            let offset_m = if share == 0.0 {
                from.1
            } else if share == 1.0 {
                to.1
            } else {
                (self.offset_at)(time_s)
            };
            least.note(measure.of(offset_m), time_s);
            return;
        }
        let middle_s = f64::midpoint(from.0, to.0);
        let middle = (middle_s, (self.offset_at)(middle_s));
        self.refine(measure, from, middle, least);
        self.refine(measure, middle, to, least);
    }

    /// The least signed distance to a cylinder. Looks for the least value on a chord only where the path
    /// is straight and neither end is the least.
    fn refine_margin(
        &self,
        volume: &ProtectedVolume,
        from: (f64, Vec3),
        to: (f64, Vec3),
        least: &mut Least,
    ) {
        let measure = Measure::Margin(*volume);
        let span_s = to.0 - from.0;
        let departure_m = departure_m(self.acceleration_mps2, span_s);
        if measure.at_least_on_chord(from.1, to.1) - departure_m >= least.value_m {
            return;
        }
        let ends = [(to, from), (from, to)];
        if let Some((end, _)) = ends
            .into_iter()
            .find(|(end, other)| self.is_least(volume, end.1, other.1, span_s))
        {
            least.note(measure.of(end.1), end.0);
            return;
        }
        if departure_m <= STRAIGHT_M || span_s < 1e-6 {
            self.refine(measure, from, to, least);
            return;
        }
        let middle_s = f64::midpoint(from.0, to.0);
        let middle = (middle_s, (self.offset_at)(middle_s));
        self.refine_margin(volume, from, middle, least);
        self.refine_margin(volume, middle, to, least);
    }

    /// Whether a piece is nowhere nearer to a cylinder than at one of its ends: beside the axis and above
    /// the middle, or in the one of both that decides there.
    fn is_least(&self, volume: &ProtectedVolume, end_m: Vec3, other_m: Vec3, span_s: f64) -> bool {
        let beside_m = departure_m(self.acceleration_mps2, span_s);
        let above_m = departure_m(self.upward_mps2, span_s);
        let away_m = other_m - end_m;
        let is_beside = recedes(across(end_m, away_m), across(end_m, end_m), beside_m);
        let is_above = end_m.z * other_m.z >= 0.0
            && other_m.z.abs() >= end_m.z.abs()
            && away_m.z.abs() >= 4.0 * above_m;
        if is_beside && is_above {
            return true;
        }
        let wall_m = libm::sqrt(across(end_m, end_m)) - volume.radius_m();
        let face_m = end_m.z.abs() - volume.half_height_m();
        is_beside && face_m <= wall_m.min(0.0) || is_above && wall_m <= face_m.min(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn arc(course_rad: f64, p: f64, q: f64) -> Arc {
        Arc {
            start_s: 0.0,
            duration_s: 4.0,
            position_m: Vec3::ZERO,
            course_rad,
            climb_rad: 0.1,
            course_rate_radps: p,
            climb_rate_radps: q,
            airspeed_mps: 15.0,
            wind_mps: Vec3::ZERO,
        }
    }

    proptest! {
        #[test]
        fn agrees_with_fine_sampling(
            course in -3.0..3.0f64,
            p in -0.5..0.5f64,
            q in -0.2..0.2f64,
            x in -60.0..60.0f64, y in -60.0..60.0f64, z in -30.0..30.0f64,
            vx in -30.0..30.0f64, vy in -30.0..30.0f64,
            half in 2.0..20.0f64,
            cylinder: bool,
        ) {
            let volume = if cylinder {
                ProtectedVolume::Cylinder { radius_m: 20.0, half_height_m: half }
            } else {
                ProtectedVolume::Sphere { radius_m: half }
            };
            let arc = arc(course, p, q);
            let velocity = Vec3::new(vx, vy, 0.0);
            let track = Track::straight(Vec3::new(x, y, z), velocity);
            let mut separation = Separation::new(volume);
            // Flown as forty arcs, so that skipping is exercised.
            for k in 0..40 {
                let from = f64::from(k) * 0.1;
                let piece = Arc {
                    start_s: from,
                    duration_s: 0.1,
                    position_m: arc.position_at_m(from),
                    course_rad: arc.course_rad + p * from,
                    climb_rad: arc.climb_rad + q * from,
                    ..arc
                };
                separation.observe(&piece, piece.end_m(), &track);
            }
            let mut sampled = f64::INFINITY;
            let mut closest = f64::INFINITY;
            for k in 0..=40_000 {
                let t = f64::from(k) * 1e-4;
                let offset = arc.position_at_m(t) - Vec3::new(x, y, z) - velocity * t;
                sampled = sampled.min(volume.margin_m(offset));
                closest = closest.min(offset.length());
            }
            // Sampling at 0.1 ms misses at most half a step of closing, about 2 mm.
            prop_assert!((separation.margin().value_m - sampled).abs() < 3e-3);
            prop_assert!((separation.distance().value_m - closest).abs() < 3e-3);
        }
    }

    #[test]
    fn head_on_pass_at_a_known_distance() {
        let mut arc = arc(0.0, 0.0, 0.0);
        arc.climb_rad = 0.0;
        let track = Track::straight(Vec3::new(60.0, 7.0, 0.0), Vec3::new(-15.0, 0.0, 0.0));
        let mut separation = Separation::new(ProtectedVolume::Sphere { radius_m: 5.0 });
        separation.observe(&arc, arc.end_m(), &track);
        assert!((separation.margin().value_m - 2.0).abs() < 1e-12);
        assert!((separation.distance().time_s - 2.0).abs() < 1e-12);
    }
}

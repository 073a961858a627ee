//! One obstacle's volume against the straight relative path: time of entry, least margin, kind.

use super::Relative;
use fga::Vec3;
use fga::situation::ProtectedVolume;

/// The relation of an obstacle on a straight course to an aircraft on a straight course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Conflict {
    /// The aircraft is already inside the volume; the cone has no meaning.
    Inside {
        /// Signed distance to the surface, metres, negative.
        margin_m: f64,
    },
    /// The path enters the volume: `V_r` lies inside the collision cone (Eq. 3, 4).
    Threat {
        /// Time of the entry, seconds from now.
        entry_s: f64,
        /// Time of the least margin, seconds from now.
        closest_s: f64,
        /// Signed distance to the surface at that time, metres, not positive.
        margin_m: f64,
    },
    /// The obstacle comes nearer, but the path misses the volume: `V_r` lies in the safe cone (Eq. 5, 6).
    Passing {
        /// Time of the least margin, seconds from now.
        closest_s: f64,
        /// Signed distance to the surface at that time, metres, not negative.
        margin_m: f64,
    },
    /// The distance only grows, or stays (`V_r` = 0) outside the volume.
    Receding {
        /// Signed distance to the surface now, metres, not negative.
        margin_m: f64,
    },
}

impl Conflict {
    /// Whether the aircraft must act: inside, or on the way in.
    pub const fn is_threat(&self) -> bool {
        matches!(self, Self::Inside { .. } | Self::Threat { .. })
    }

    /// Least signed distance to the surface from now on, metres.
    pub const fn margin_m(&self) -> f64 {
        match *self {
            Self::Inside { margin_m }
            | Self::Threat { margin_m, .. }
            | Self::Passing { margin_m, .. }
            | Self::Receding { margin_m } => margin_m,
        }
    }
}

/// The point of the relative path nearest to a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastMargin {
    /// Time, seconds from now, not negative.
    pub time_s: f64,
    /// Signed distance to the surface at that time, metres.
    pub margin_m: f64,
}

/// The open interval of times, seconds from now, in which the straight relative path runs inside
/// the volume: negative times are in the past, an end may be infinite. `None` where it never does;
/// a path that only touches the surface is never inside.
pub fn inside_during(relative: &Relative, volume: &ProtectedVolume) -> Option<(f64, f64)> {
    let (r, v) = (relative.position_m(), relative.velocity_mps());
    match *volume {
        ProtectedVolume::Sphere { radius_m } => in_ball(r, v, radius_m),
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let level = |a: Vec3| Vec3::new(a.x, a.y, 0.0);
            let (from, to) = in_ball(level(r), level(v), radius_m)?;
            let (low, high) = in_slab(r.z, v.z, half_height_m)?;
            let (start, end) = (from.max(low), to.min(high));
            (start < end).then_some((start, end))
        }
    }
}

/// |r − v t| < radius.
fn in_ball(r: Vec3, v: Vec3, radius_m: f64) -> Option<(f64, f64)> {
    let speed_squared = v.length_squared();
    let outside = r.length_squared() - radius_m * radius_m;
    if speed_squared == 0.0 {
        return (outside < 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    // From the cross product rather than r² v² − (r·v)², which cancels far away.
    let discriminant = radius_m * radius_m * speed_squared - r.cross(v).length_squared();
    if discriminant <= 0.0 {
        return None;
    }
    let (closing, root) = (r.dot(v), libm::sqrt(discriminant));
    // The root of the larger magnitude is free of cancellation; the other one follows from the
    // product of the roots, `outside` / v².
    let (entry, exit) = if closing >= 0.0 {
        (outside / (closing + root), (closing + root) / speed_squared)
    } else {
        ((closing - root) / speed_squared, outside / (closing - root))
    };
    (entry < exit).then_some((entry, exit))
}

/// |z − v t| < `half_height`.
fn in_slab(z: f64, v: f64, half_height_m: f64) -> Option<(f64, f64)> {
    if v == 0.0 {
        return (z.abs() < half_height_m).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (one, other) = ((z - half_height_m) / v, (z + half_height_m) / v);
    let (low, high) = (one.min(other), one.max(other));
    (low < high).then_some((low, high))
}

/// The least signed distance between the surface and the relative path from now on.
///
/// Exact for a sphere. For a cylinder the margin is a convex function of time; the search is exact to
/// a nanosecond or the last bit, whichever is coarser.
pub fn least_margin(relative: &Relative, volume: &ProtectedVolume) -> LeastMargin {
    let margin_at = |time_s: f64| volume.margin_m(relative.position_after_m(time_s));
    match volume {
        ProtectedVolume::Sphere { radius_m } => {
            let closest = relative.closest();
            LeastMargin {
                time_s: closest.time_s,
                margin_m: closest.distance_m - radius_m,
            }
        }
        ProtectedVolume::Cylinder { .. } => {
            let time_s = cylinder_closest_s(relative, &margin_at);
            LeastMargin {
                time_s,
                margin_m: margin_at(time_s),
            }
        }
    }
}

/// The time of a cylinder's least margin lies between the times of the horizontal and of the vertical
/// closest approach, because outside that span both parts grow.
fn cylinder_closest_s(relative: &Relative, margin_at: &impl Fn(f64) -> f64) -> f64 {
    let (r, v) = (relative.position_m(), relative.velocity_mps());
    let later = |closing: f64, squared: f64| {
        let time = if squared > 0.0 {
            closing / squared
        } else {
            0.0
        };
        if time.is_finite() { time.max(0.0) } else { 0.0 }
    };
    let level_s = later(r.x * v.x + r.y * v.y, v.x * v.x + v.y * v.y);
    let vertical_s = later(r.z * v.z, v.z * v.z);
    if v.z == 0.0 {
        return level_s;
    }
    if v.x == 0.0 && v.y == 0.0 {
        return vertical_s;
    }
    let (mut low, mut high) = (level_s.min(vertical_s), level_s.max(vertical_s));
    // Golden section: 0.618^90 of the span is below the resolution of a double.
    let ratio = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_a, mut at_b) = (margin_at(a), margin_at(b));
    for _ in 0..90 {
        if high - low < 1e-9 {
            break;
        }
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = margin_at(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = margin_at(b);
        }
    }
    f64::midpoint(low, high)
}

/// The relation to the obstacle (Eq. 3–6 and Alg. 1, corrected: closing, inside and `V_r` = 0 differ).
pub fn assess(relative: &Relative, volume: &ProtectedVolume) -> Conflict {
    let now_m = volume.margin_m(relative.position_m());
    if now_m < 0.0 {
        return Conflict::Inside { margin_m: now_m };
    }
    let least = least_margin(relative, volume);
    if let Some((entry_s, exit_s)) = inside_during(relative, volume)
        && exit_s > 0.0
        && entry_s.is_finite()
    {
        return Conflict::Threat {
            entry_s: entry_s.max(0.0),
            closest_s: least.time_s,
            margin_m: least.margin_m.min(0.0),
        };
    }
    if least.time_s > 0.0 {
        Conflict::Passing {
            closest_s: least.time_s,
            margin_m: least.margin_m.max(0.0),
        }
    } else {
        Conflict::Receding { margin_m: now_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BALL: ProtectedVolume = ProtectedVolume::Sphere { radius_m: 30.0 };
    const DRUM: ProtectedVolume = ProtectedVolume::Cylinder {
        radius_m: 152.4,
        half_height_m: 30.48,
    };

    fn relative(r: [f64; 3], v: [f64; 3]) -> Relative {
        Relative::new(Vec3::from_array(r), Vec3::from_array(v)).unwrap()
    }

    #[test]
    fn head_on_from_300_m() {
        let conflict = assess(&relative([300.0, 0.0, 0.0], [15.0, 0.0, 0.0]), &BALL);
        let Conflict::Threat {
            entry_s,
            closest_s,
            margin_m,
        } = conflict
        else {
            panic!("{conflict:?}")
        };
        assert!((entry_s - 18.0).abs() < 1e-12);
        assert!((closest_s - 20.0).abs() < 1e-12);
        assert!((margin_m + 30.0).abs() < 1e-12);
    }

    #[test]
    fn each_kind_has_its_case() {
        let kind = |r, v| assess(&relative(r, v), &BALL);
        let inside = kind([10.0, 0.0, 0.0], [0.0; 3]);
        assert_eq!(inside, Conflict::Inside { margin_m: -20.0 });
        let receding = kind([50.0, 0.0, 0.0], [-15.0, 0.0, 0.0]);
        assert_eq!(receding, Conflict::Receding { margin_m: 20.0 });
        let still = kind([50.0, 0.0, 0.0], [0.0; 3]);
        assert_eq!(still, Conflict::Receding { margin_m: 20.0 });
        // Touching is not entering (Eq. 5).
        let grazing = kind([40.0, 30.0, 0.0], [10.0, 0.0, 0.0]);
        assert!(matches!(grazing, Conflict::Passing { .. }), "{grazing:?}");
        // On the surface: in is a threat at once, out is not.
        let going_in = kind([30.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        assert!(matches!(going_in, Conflict::Threat { entry_s, .. } if entry_s == 0.0));
        assert!(!kind([30.0, 0.0, 0.0], [-1.0, 0.0, 0.0]).is_threat());
    }

    #[test]
    fn a_cylinder_is_passed_above_within_its_radius() {
        let over = assess(&relative([400.0, 0.0, -40.0], [20.0, 0.0, 0.0]), &DRUM);
        let Conflict::Passing { margin_m, .. } = over else {
            panic!("{over:?}")
        };
        assert!((margin_m - 9.52).abs() < 1e-9);
        assert!(assess(&relative([400.0, 0.0, -20.0], [20.0, 0.0, 0.0]), &DRUM).is_threat());
    }

    /// Straight down beside the wall, and a climb that enters through the face.
    #[test]
    fn a_cylinder_is_entered_through_its_face() {
        let beside = assess(&relative([160.0, 0.0, -100.0], [0.0, 0.0, -5.0]), &DRUM);
        let Conflict::Passing { margin_m, .. } = beside else {
            panic!("{beside:?}")
        };
        assert!((margin_m - 7.6).abs() < 1e-9);
        let below = assess(&relative([0.0, 0.0, -100.0], [0.0, 0.0, -5.0]), &DRUM);
        let Conflict::Threat { entry_s, .. } = below else {
            panic!("{below:?}")
        };
        assert!((entry_s - (100.0 - 30.48) / 5.0).abs() < 1e-9);
    }

    fn volume() -> impl Strategy<Value = ProtectedVolume> {
        prop_oneof![
            (1.0..150.0f64).prop_map(|radius_m| ProtectedVolume::Sphere { radius_m }),
            (1.0..150.0f64, 1.0..60.0f64).prop_map(|(radius_m, half_height_m)| {
                ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m,
                }
            }),
        ]
    }

    proptest! {
        #[test]
        fn least_margin_agrees_with_brute_force(
            volume in volume(),
            r in [-300.0..300.0f64, -300.0..300.0, -80.0..80.0],
            v in [-40.0..40.0f64, -40.0..40.0, -8.0..8.0],
        ) {
            let relative = relative(r, v);
            let least = least_margin(&relative, &volume);
            let horizon = (least.time_s * 2.0).max(20.0);
            let sampled = (0..=20_000)
                .map(|i| volume.margin_m(relative.position_after_m(horizon * f64::from(i) / 20_000.0)))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(sampled >= least.margin_m - 1e-6);
            prop_assert!(sampled <= least.margin_m + horizon / 20_000.0 * relative.speed_mps());
        }

        #[test]
        fn the_interval_is_where_the_margin_is_negative(
            volume in volume(),
            r in [-300.0..300.0f64, -300.0..300.0, -80.0..80.0],
            v in [-40.0..40.0f64, -40.0..40.0, -8.0..8.0],
            at in -30.0..30.0f64,
        ) {
            let relative = relative(r, v);
            let margin = volume.margin_m(relative.position_after_m(at));
            let inside = inside_during(&relative, &volume)
                .is_some_and(|(from, to)| from < at && at < to);
            prop_assert!(inside == (margin < 0.0) || margin.abs() < 1e-6, "{margin}");
        }

        #[test]
        fn every_number_gives_a_number(
            a: [f64; 3], b: [f64; 3],
            radius_m in 0.0..1e15f64, half_height_m in 0.0..1e15f64, ball: bool,
        ) {
            let volume = if ball {
                ProtectedVolume::Sphere { radius_m }
            } else {
                ProtectedVolume::Cylinder { radius_m, half_height_m }
            };
            if let Some(relative) = Relative::new(Vec3::from_array(a), Vec3::from_array(b)) {
                prop_assert!(assess(&relative, &volume).margin_m().is_finite());
            }
        }
    }
}

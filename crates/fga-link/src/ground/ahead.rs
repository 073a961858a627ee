//! The height above the ground, here and ahead.

use core::fmt;

use fga::Vec3;
use fga_formats::terrain::LocalGround;

/// The height above the ground here, and the least one on the way ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AboveGround {
    /// Here, metres; `None` over unknown ground.
    pub here_m: Option<f64>,
    /// The least on the way ahead, metres, and how far ahead, seconds; `None` where no ground is known ahead.
    pub least: Option<(f64, f64)>,
    /// How far ahead the ground is first unknown, seconds.
    pub unknown_s: Option<f64>,
}

impl AboveGround {
    /// Along places of the way with their times ahead, seconds, the first one here; `None` without a place.
    pub(crate) fn along(
        ground: &LocalGround,
        way: impl IntoIterator<Item = (f64, Vec3)>,
    ) -> Option<Self> {
        let mut way = way.into_iter();
        let mut from_m = way.next()?.1;
        let here_m = ground.above_m(from_m);
        let mut found = Self {
            here_m,
            least: here_m.map(|here_m| (here_m, 0.0)),
            unknown_s: here_m.is_none().then_some(0.0),
        };
        for (ahead_s, to_m) in way {
            let (above_m, is_known) = ground.along_m(from_m, to_m);
            let is_less = found.least.is_none_or(|(least_m, _)| above_m < least_m);
            if is_less && above_m.is_finite() {
                found.least = Some((above_m, ahead_s));
            }
            if !is_known {
                found.unknown_s.get_or_insert(ahead_s);
            }
            from_m = to_m;
        }
        Some(found)
    }
}

/// Where a way leads each second at a speed, for as long as it lasts, with the times ahead; from a place on to the waypoints.
pub(crate) fn each_second(
    mut at_m: Vec3,
    mut way_m: &[Vec3],
    speed_mps: f64,
    horizon_s: f64,
) -> Vec<(f64, Vec3)> {
    let mut places = vec![(0.0, at_m)];
    let mut ahead_s = 0.0;
    while ahead_s < horizon_s && !way_m.is_empty() {
        ahead_s += 1.0;
        let mut left_m = speed_mps;
        while let Some((to_m, after_m)) = way_m.split_first().filter(|_| left_m > 0.0) {
            let step_m = at_m.distance(*to_m).min(left_m);
            at_m = at_m.move_towards(*to_m, step_m);
            left_m -= step_m;
            if at_m == *to_m {
                way_m = after_m;
            }
        }
        places.push((ahead_s, at_m));
    }
    places
}

/// A line for the operator: `132 m above ground, least 78 m in 12 s`.
impl fmt::Display for AboveGround {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.here_m {
            Some(here_m) => write!(f, "{here_m:.0} m above ground")?,
            None => f.write_str("over unknown ground")?,
        }
        // A metre or more below here; without ground here any.
        let high_m = self.here_m.map_or(f64::INFINITY, |here_m| here_m - 1.0);
        if let Some((least_m, in_s)) = self.least.filter(|least| least.0 <= high_m) {
            write!(f, ", least {least_m:.0} m in {in_s:.0} s")?;
        }
        match self.unknown_s.filter(|in_s| *in_s > 0.0) {
            Some(in_s) => write!(f, ", unknown in {in_s:.0} s"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use fga::Vec2;

    use super::*;

    /// A hill 80 m high, 500 m ahead, a hole beyond it.
    fn ground() -> LocalGround {
        let heights_m: Vec<f32> = (0..3)
            .flat_map(|_| {
                (0..16).map(|column| match column {
                    6 => 80.0,
                    12.. => f32::NAN,
                    _ => 0.0,
                })
            })
            .collect();
        let place = (Vec2::splat(-100.0), Vec2::splat(100.0));
        LocalGround::new(place, 16, heights_m, (0.0, 20.0)).unwrap()
    }

    #[test]
    fn the_least_height_ahead_is_told_with_its_time_and_unknown_ground_too() {
        let at_m = Vec3::new(0.0, 0.0, 100.0);
        let corner_m = Vec3::new(300.0, 0.0, 100.0);
        let along = |way_m: &[Vec3], horizon_s| {
            let way = each_second(at_m, way_m, 25.0, horizon_s);
            AboveGround::along(&ground(), way).unwrap().to_string()
        };
        let beyond_m = Vec3::new(1300.0, 0.0, 100.0);
        let to_beyond_m = [corner_m, beyond_m];
        let told = "100 m above ground, least 20 m in 20 s, unknown in 40 s";
        assert_eq!(along(&to_beyond_m, 60.0), told);
        assert_eq!(along(&to_beyond_m, 10.0), "100 m above ground");
        assert_eq!(along(&[], 60.0), "100 m above ground");
        // The way ends at its last waypoint, in the middle of a second.
        let ends = each_second(at_m, &[corner_m], 40.0, 60.0);
        assert_eq!(ends.len(), 9);
        assert_eq!(ends.last(), Some(&(8.0, corner_m)));
        let over = AboveGround::along(&ground(), [(0.0, beyond_m)]);
        assert_eq!(over.unwrap().to_string(), "over unknown ground");
    }
}

//! How far along its mission the aircraft is, and how far beside it.

use fga::Vec3;

/// Follows an aircraft along a mission of straight legs.
///
/// The leg in question moves on to the next when the aircraft is nearer to that one and has
/// passed the first half of its own; one leg may be left out when the aircraft already flies along
/// the one after. Legs that lie behind do not come back, so that neighbouring parallel legs are not
/// mistaken for one another. The first and the last leg go on for ever.
#[derive(Debug, Clone)]
pub struct MissionProgress<'a> {
    waypoints_m: &'a [Vec3],
    /// Index of the leg that is followed.
    leg: usize,
    line: Option<Leg>,
    /// Length of the legs before, metres.
    before_m: f64,
    along_m: f64,
    start_along_m: f64,
    cross_track_m: f64,
    max_cross_track_m: f64,
}

/// A leg that leads somewhere.
#[derive(Debug, Clone, Copy)]
struct Leg {
    from_m: Vec3,
    direction: Vec3,
    length_m: f64,
    first: bool,
    last: bool,
}

impl Leg {
    fn of(waypoints_m: &[Vec3], leg: usize) -> Option<Self> {
        let (from, to) = (*waypoints_m.get(leg)?, *waypoints_m.get(leg + 1)?);
        Some(Self {
            from_m: from,
            direction: (to - from).try_normalize()?,
            length_m: from.distance(to),
            first: leg == 0,
            last: leg + 2 == waypoints_m.len(),
        })
    }

    /// Distance along and beside the leg, metres.
    fn measure(&self, position_m: Vec3) -> (f64, f64) {
        let along = (position_m - self.from_m)
            .dot(self.direction)
            .max(if self.first { f64::NEG_INFINITY } else { 0.0 })
            .min(if self.last {
                f64::INFINITY
            } else {
                self.length_m
            });
        let foot_m = self.from_m + self.direction * along;
        (along, position_m.distance(foot_m))
    }
}

impl<'a> MissionProgress<'a> {
    /// An aircraft on the first leg.
    pub fn new(waypoints_m: &'a [Vec3], position_m: Vec3) -> Self {
        let mut progress = Self {
            waypoints_m,
            leg: 0,
            line: Leg::of(waypoints_m, 0),
            before_m: 0.0,
            along_m: 0.0,
            start_along_m: 0.0,
            cross_track_m: 0.0,
            max_cross_track_m: 0.0,
        };
        progress.follow(position_m, || Vec3::ZERO);
        progress.start_along_m = progress.along_m;
        progress
    }

    /// Takes the aircraft's position and velocity over the ground into account.
    pub fn follow(&mut self, position_m: Vec3, velocity_mps: impl Fn() -> Vec3) {
        while let Some(line) = self.line {
            let (along, beside) = line.measure(position_m);
            self.along_m = self.before_m + along;
            self.cross_track_m = beside;
            if along <= 0.5 * line.length_m {
                break;
            }
            let nearer = |leg: &Leg| leg.measure(position_m).1 < beside;
            let flies_along = |leg: &Leg| {
                let velocity_mps = velocity_mps();
                velocity_mps.dot(leg.direction) > 0.8 * velocity_mps.length()
            };
            let after = |legs: usize| Leg::of(self.waypoints_m, self.leg + legs);
            let next = after(1);
            if next.is_some_and(|leg| nearer(&leg)) {
                self.before_m += line.length_m;
                self.leg += 1;
                self.line = next;
            } else if let Some(second) = after(2).filter(|leg| nearer(leg) && flies_along(leg)) {
                self.before_m += line.length_m + self.length_m(self.leg + 1);
                self.leg += 2;
                self.line = Some(second);
            } else {
                break;
            }
        }
        self.max_cross_track_m = self.max_cross_track_m.max(self.cross_track_m);
    }

    fn length_m(&self, leg: usize) -> f64 {
        Leg::of(self.waypoints_m, leg).map_or(0.0, |leg| leg.length_m)
    }

    /// Distance from the mission now, metres.
    pub fn cross_track_m(&self) -> f64 {
        self.cross_track_m
    }

    /// Largest distance from the mission so far, metres.
    pub fn max_cross_track_m(&self) -> f64 {
        self.max_cross_track_m
    }

    /// Progress along the mission since the start, metres.
    pub fn along_m(&self) -> f64 {
        self.along_m - self.start_along_m
    }

    /// Direction of the present leg.
    pub fn direction(&self) -> Vec3 {
        self.line.map_or(Vec3::X, |leg| leg.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_follows_the_legs() {
        let mission = [
            Vec3::ZERO,
            Vec3::new(100.0, 0.0, 0.0),
            Vec3::new(100.0, 40.0, 0.0),
            Vec3::new(0.0, 40.0, 0.0),
        ];
        let mut progress = MissionProgress::new(&mission, Vec3::ZERO);
        progress.follow(Vec3::new(30.0, 25.0, 0.0), || Vec3::X);
        // Nearer to the third leg, but on the first.
        assert_eq!((progress.along_m(), progress.cross_track_m()), (30.0, 25.0));
        progress.follow(Vec3::new(98.0, 10.0, 0.0), || Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (110.0, 2.0));
        progress.follow(Vec3::new(50.0, 41.0, 0.0), || Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (190.0, 1.0));
        progress.follow(Vec3::new(-50.0, 40.0, 0.0), || Vec3::X);
        assert_eq!(progress.along_m(), 290.0);
        assert_eq!(progress.max_cross_track_m(), 25.0);
    }

    #[test]
    fn a_short_leg_may_be_left_out() {
        let mission = [
            Vec3::ZERO,
            Vec3::new(100.0, 0.0, 0.0),
            Vec3::new(100.0, 40.0, 0.0),
            Vec3::new(0.0, 40.0, 0.0),
        ];
        let mut progress = MissionProgress::new(&mission, Vec3::ZERO);
        // Abreast of the third leg, but not along it: still on the first.
        progress.follow(Vec3::new(60.0, 30.0, 0.0), || Vec3::X);
        assert_eq!(progress.cross_track_m(), 30.0);
        progress.follow(Vec3::new(60.0, 39.0, 0.0), || -Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (180.0, 1.0));
    }
}

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
    leg: usize,
    /// Length of the legs before, metres.
    before_m: f64,
    along_m: f64,
    start_along_m: f64,
    cross_track_m: f64,
    max_cross_track_m: f64,
}

impl<'a> MissionProgress<'a> {
    /// An aircraft on the first leg.
    pub fn new(waypoints_m: &'a [Vec3], position_m: Vec3) -> Self {
        let mut progress = Self {
            waypoints_m,
            leg: 0,
            before_m: 0.0,
            along_m: 0.0,
            start_along_m: 0.0,
            cross_track_m: 0.0,
            max_cross_track_m: 0.0,
        };
        progress.follow(position_m, Vec3::ZERO);
        progress.start_along_m = progress.along_m;
        progress
    }

    fn leg_ends(&self, leg: usize) -> Option<(Vec3, Vec3)> {
        Some((*self.waypoints_m.get(leg)?, *self.waypoints_m.get(leg + 1)?))
    }

    /// Distance along and beside a leg, metres.
    fn measure(&self, leg: usize, position_m: Vec3) -> Option<(f64, f64)> {
        let (from, to) = self.leg_ends(leg)?;
        let length_m = from.distance(to);
        let direction = (to - from).try_normalize()?;
        let last = leg + 2 == self.waypoints_m.len();
        let along = (position_m - from)
            .dot(direction)
            .max(if leg == 0 { f64::NEG_INFINITY } else { 0.0 })
            .min(if last { f64::INFINITY } else { length_m });
        Some((along, position_m.distance(from + direction * along)))
    }

    /// Takes the aircraft's position and velocity over the ground into account.
    pub fn follow(&mut self, position_m: Vec3, velocity_mps: Vec3) {
        while let Some((along, beside)) = self.measure(self.leg, position_m) {
            let length_m = self.length_m(self.leg);
            let nearer = |leg: usize| {
                self.measure(leg, position_m)
                    .is_some_and(|(_, beside_it)| beside_it < beside)
            };
            let flies_along = |leg: usize| {
                self.leg_ends(leg).is_some_and(|(from, to)| {
                    velocity_mps.dot(to - from) > 0.8 * velocity_mps.length() * from.distance(to)
                })
            };
            if along <= 0.5 * length_m {
                break;
            } else if nearer(self.leg + 1) {
                self.before_m += length_m;
                self.leg += 1;
            } else if nearer(self.leg + 2) && flies_along(self.leg + 2) {
                self.before_m += length_m + self.length_m(self.leg + 1);
                self.leg += 2;
            } else {
                break;
            }
        }
        if let Some((along, beside)) = self.measure(self.leg, position_m) {
            self.along_m = self.before_m + along;
            self.cross_track_m = beside;
            self.max_cross_track_m = self.max_cross_track_m.max(beside);
        }
    }

    fn length_m(&self, leg: usize) -> f64 {
        self.leg_ends(leg)
            .map_or(0.0, |(from, to)| from.distance(to))
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
        self.leg_ends(self.leg)
            .and_then(|(from, to)| (to - from).try_normalize())
            .unwrap_or(Vec3::X)
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
        progress.follow(Vec3::new(30.0, 25.0, 0.0), Vec3::X);
        // Nearer to the third leg, but on the first.
        assert_eq!((progress.along_m(), progress.cross_track_m()), (30.0, 25.0));
        progress.follow(Vec3::new(98.0, 10.0, 0.0), Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (110.0, 2.0));
        progress.follow(Vec3::new(50.0, 41.0, 0.0), Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (190.0, 1.0));
        progress.follow(Vec3::new(-50.0, 40.0, 0.0), Vec3::X);
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
        progress.follow(Vec3::new(60.0, 30.0, 0.0), Vec3::X);
        assert_eq!(progress.cross_track_m(), 30.0);
        progress.follow(Vec3::new(60.0, 39.0, 0.0), -Vec3::X);
        assert_eq!((progress.along_m(), progress.cross_track_m()), (180.0, 1.0));
    }
}

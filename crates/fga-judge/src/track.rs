//! The true position of an obstacle: on a straight line for ever, or on a recorded track.

use fga_proof::Vec3;

/// Two times this close are one, seconds.
const SAME_TIME_S: f64 = 1e-6;

/// A moment of a recorded track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    /// Seconds since the start of the run.
    pub time_s: f64,
    /// Position, metres.
    pub position_m: Vec3,
}

/// The true motion of an obstacle over the ground.
#[derive(Debug, Clone, PartialEq)]
pub enum Track {
    /// Straight at constant velocity, for ever.
    Straight {
        /// Position at time 0, metres.
        position_m: Vec3,
        /// Velocity, metres per second.
        velocity_mps: Vec3,
    },
    /// Linear from point to point; absent before the first and after the last.
    Points {
        /// At least one point, times strictly increasing.
        points: Vec<TrackPoint>,
        /// Largest speed between points, metres per second.
        speed_bound_mps: f64,
    },
}

/// A straight part of a track.
#[derive(Debug, Clone, Copy)]
pub struct TrackLeg {
    /// Its start within the requested interval, seconds.
    pub from_s: f64,
    /// Its end within the requested interval, seconds.
    pub to_s: f64,
    anchor_s: f64,
    anchor_m: Vec3,
    velocity_mps: Vec3,
}

impl TrackLeg {
    /// Position at a time within the leg, metres.
    pub fn position_at_m(&self, time_s: f64) -> Vec3 {
        self.anchor_m + self.velocity_mps * (time_s - self.anchor_s)
    }
}

impl Track {
    /// A straight line.
    pub const fn straight(position_m: Vec3, velocity_mps: Vec3) -> Self {
        Self::Straight {
            position_m,
            velocity_mps,
        }
    }

    /// A recorded track; `None` without points or if a time does not increase.
    pub fn through(points: Vec<TrackPoint>) -> Option<Self> {
        if points.is_empty() || !points.is_sorted_by(|a, b| a.time_s < b.time_s) {
            return None;
        }
        let speed_bound_mps = points
            .windows(2)
            .map(|pair| velocity_between(pair[0], pair[1]).length())
            .fold(0.0, f64::max);
        Some(Self::Points {
            points,
            speed_bound_mps,
        })
    }

    /// Goes another way from a time on.
    pub fn leave_at(&mut self, time_s: f64) {
        if let Self::Points { points, .. } = self {
            points.truncate(points.partition_point(|point| point.time_s <= time_s));
        }
    }

    /// Adds a point; one that is not later than the last is none.
    pub fn push(&mut self, point: TrackPoint) {
        if let Self::Points {
            points,
            speed_bound_mps,
        } = self
        {
            let last = points.last().copied();
            if last.is_none_or(|last| point.time_s > last.time_s + SAME_TIME_S) {
                let speed_mps = last.map(|last| velocity_between(last, point).length());
                *speed_bound_mps = speed_bound_mps.max(speed_mps.unwrap_or(0.0));
                points.push(point);
            }
        }
    }

    /// Largest speed unless the obstacle appears or disappears; `None` if it may appear
    /// anywhere.
    pub fn speed_bound_mps(&self) -> Option<f64> {
        match self {
            Self::Straight { velocity_mps, .. } => Some(velocity_mps.length()),
            Self::Points {
                speed_bound_mps, ..
            } => Some(*speed_bound_mps),
        }
    }

    /// First and last moment of its presence, seconds.
    pub fn presence_s(&self) -> (f64, f64) {
        match self {
            Self::Straight { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Points { points, .. } => (
                points.first().map_or(f64::INFINITY, |p| p.time_s),
                points.last().map_or(f64::NEG_INFINITY, |p| p.time_s),
            ),
        }
    }

    /// Position and velocity at a time; `None` while it is absent.
    pub fn at(&self, time_s: f64) -> Option<(Vec3, Vec3)> {
        match self {
            Self::Straight {
                position_m,
                velocity_mps,
            } => Some((*position_m + *velocity_mps * time_s, *velocity_mps)),
            Self::Points { points, .. } => {
                let (first_s, last_s) = self.presence_s();
                if !(first_s..=last_s).contains(&time_s) {
                    return None;
                }
                let next = points.partition_point(|p| p.time_s <= time_s);
                // At the last point the velocity of the last leg holds.
                let next = next.min(points.len() - 1);
                let Some(before) = next.checked_sub(1) else {
                    return Some((points[0].position_m, Vec3::ZERO));
                };
                let velocity = velocity_between(points[before], points[next]);
                let after_s = time_s - points[before].time_s;
                Some((points[before].position_m + velocity * after_s, velocity))
            }
        }
    }

    /// Shows the straight parts between two times, in order.
    pub fn for_each_leg(&self, from_s: f64, to_s: f64, mut show: impl FnMut(&TrackLeg)) {
        match self {
            Self::Straight {
                position_m,
                velocity_mps,
            } => show(&TrackLeg {
                from_s,
                to_s,
                anchor_s: 0.0,
                anchor_m: *position_m,
                velocity_mps: *velocity_mps,
            }),
            Self::Points { points, .. } => {
                let next = points.partition_point(|p| p.time_s <= from_s).max(1);
                for pair in points[next - 1..].windows(2) {
                    if pair[0].time_s > to_s {
                        break;
                    }
                    let leg = TrackLeg {
                        from_s: from_s.max(pair[0].time_s),
                        to_s: to_s.min(pair[1].time_s),
                        anchor_s: pair[0].time_s,
                        anchor_m: pair[0].position_m,
                        velocity_mps: velocity_between(pair[0], pair[1]),
                    };
                    if leg.from_s <= leg.to_s {
                        show(&leg);
                    }
                }
            }
        }
    }
}

fn velocity_between(from: TrackPoint, to: TrackPoint) -> Vec3 {
    (to.position_m - from.position_m) / (to.time_s - from.time_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(time_s: f64, x: f64) -> TrackPoint {
        TrackPoint {
            time_s,
            position_m: Vec3::new(x, 0.0, 0.0),
        }
    }

    #[test]
    fn a_recorded_track_is_straight_between_its_points() {
        let track =
            Track::through(vec![point(1.0, 0.0), point(2.0, 10.0), point(4.0, 0.0)]).unwrap();
        assert_eq!(track.at(0.9), None);
        assert_eq!(track.at(1.5).unwrap().0.x, 5.0);
        assert_eq!(track.at(3.0).unwrap(), (Vec3::X * 5.0, Vec3::X * -5.0));
        assert_eq!(track.at(4.0).unwrap().1, Vec3::X * -5.0);
        assert_eq!(track.at(4.1), None);
        let mut legs = 0;
        track.for_each_leg(0.0, 3.0, |leg| {
            legs += 1;
            assert!(leg.from_s >= 1.0 && leg.to_s <= 3.0);
        });
        assert_eq!(legs, 2);
        assert!(Track::through(vec![point(1.0, 0.0), point(1.0, 1.0)]).is_none());
    }
}

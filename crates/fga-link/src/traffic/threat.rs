//! Which aircraft matter most?
//!
//! An aircraft matters more the sooner it enters the protected volume on our way, straight ahead or along the
//! mission. Nearness comes second: the time in which it could reach us by any turn.

use fga::Vec3;

/// Most legs of the way ahead.
const MOST_LEGS: usize = 8;
/// A later conflict does not count yet, seconds.
const HORIZON_S: f64 = 90.0;
/// Added to a protected volume: an aircraft that passes this near counts as in conflict, metres.
const NEAR_M: f64 = 40.0;
/// Closing speed of any two aircraft, metres per second.
const CLOSING_MPS: f64 = 10.0;
/// Below this speed two aircraft do not come nearer to each other, metres per second.
const STEADY_MPS: f64 = 1.0;

/// A straight piece of the way ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
struct WayLeg {
    from_m: Vec3,
    velocity_mps: Vec3,
    begins_s: f64,
    ends_s: f64,
}

/// Our possible ways: straight ahead, and along the mission.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WaysAhead {
    own: Option<(Vec3, Vec3)>,
    at_s: f64,
    legs: Vec<WayLeg>,
}

/// The urgency of an aircraft; smaller is more urgent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackUrgency {
    /// Time until it enters the volume on the way ahead, seconds; infinite if it does not.
    pub conflict_s: f64,
    /// Time until it could arrive if it turned towards the aircraft, seconds.
    pub reach_s: f64,
}

impl TrackUrgency {
    /// The order for keeping tracks when there is no room for all, seconds: a conflict, or nearness
    /// with half the weight.
    pub const fn keep_s(&self) -> f64 {
        self.conflict_s.min(2.0 * self.reach_s)
    }
}

/// A volume and the uncertainty of its centre, metres.
#[derive(Debug, Clone, Copy)]
pub struct VolumeReach {
    /// Horizontal, metres.
    pub radius_m: f64,
    /// Vertical, metres.
    pub half_height_m: f64,
}

impl WaysAhead {
    /// From a position and velocity at `at_s`: straight on, and from `met_m`, a point of the way, along the
    /// waypoints. In a manoeuvre that point lies beside the aircraft, so that the avoided aircraft stays urgent.
    pub fn new(
        at_s: f64,
        (own_m, velocity_mps): (Vec3, Vec3),
        met_m: Vec3,
        waypoints_m: &[Vec3],
    ) -> Self {
        let mut legs = vec![WayLeg {
            from_m: own_m,
            velocity_mps,
            begins_s: 0.0,
            ends_s: HORIZON_S,
        }];
        let speed_mps = velocity_mps.length();
        let (mut from_m, mut begins_s) = (met_m, 0.0);
        for waypoint_m in waypoints_m {
            let way_m = *waypoint_m - from_m;
            let length_m = way_m.length();
            if length_m < 1.0 || speed_mps < 1.0 {
                continue;
            }
            if legs.len() >= MOST_LEGS || begins_s > HORIZON_S {
                break;
            }
            let ends_s = begins_s + length_m / speed_mps;
            legs.push(WayLeg {
                from_m,
                velocity_mps: way_m * (speed_mps / length_m),
                begins_s,
                ends_s: ends_s.min(HORIZON_S),
            });
            (from_m, begins_s) = (*waypoint_m, ends_s);
        }
        Self {
            own: Some((own_m, velocity_mps)),
            at_s,
            legs,
        }
    }

    /// Known position, metres.
    pub fn own_m(&self) -> Option<Vec3> {
        self.own.map(|(own_m, _)| own_m)
    }

    /// The urgency of an aircraft at `position_m` at `at_s`.
    pub fn urgency(
        &self,
        position_m: Vec3,
        velocity_mps: Vec3,
        at_s: f64,
        reach: VolumeReach,
    ) -> TrackUrgency {
        let Some((own_m, own_mps)) = self.own else {
            return TrackUrgency {
                conflict_s: f64::INFINITY,
                reach_s: f64::INFINITY,
            };
        };
        // Its position at the start of the way.
        let position_m = position_m + velocity_mps * (self.at_s - at_s);
        let distance_m = (position_m.distance(own_m) - reach.radius_m).max(0.0);
        let reach_s = distance_m / (velocity_mps.distance(own_mps) + CLOSING_MPS);
        let conflict_s = self
            .legs
            .iter()
            .filter_map(|leg| leg.entry_s(position_m, velocity_mps, reach))
            .fold(f64::INFINITY, f64::min);
        TrackUrgency {
            conflict_s,
            reach_s,
        }
    }
}

impl WayLeg {
    /// When an aircraft that flies straight from `position_m` enters the volume, seconds.
    fn entry_s(&self, position_m: Vec3, velocity_mps: Vec3, reach: VolumeReach) -> Option<f64> {
        let radius_m = reach.radius_m + NEAR_M;
        let half_height_m = reach.half_height_m + NEAR_M;
        let offset_m = position_m + velocity_mps * self.begins_s - self.from_m;
        let rate_mps = velocity_mps - self.velocity_mps;
        let a = rate_mps.x * rate_mps.x + rate_mps.y * rate_mps.y;
        let b = offset_m.x * rate_mps.x + offset_m.y * rate_mps.y;
        let c = offset_m.x * offset_m.x + offset_m.y * offset_m.y - radius_m * radius_m;
        let lasts_s = self.ends_s - self.begins_s;
        let (mut enters_s, leaves_s) = if a < STEADY_MPS * STEADY_MPS {
            // Beside each other: neither comes nearer, but one may climb into the other.
            if c > 0.0 || rate_mps.z.abs() < STEADY_MPS {
                return None;
            }
            (0.0, lasts_s)
        } else {
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            let root = libm::sqrt(root);
            (((-b - root) / a).max(0.0), ((-b + root) / a).min(lasts_s))
        };
        if enters_s > leaves_s {
            return None;
        }
        // Inside and leaving is no conflict.
        if c <= 0.0 && offset_m.dot(rate_mps) >= 0.0 {
            return None;
        }
        // When the heights meet.
        if rate_mps.z.abs() < 1e-6 {
            if offset_m.z.abs() > half_height_m {
                return None;
            }
        } else {
            let one = (-half_height_m - offset_m.z) / rate_mps.z;
            let other = (half_height_m - offset_m.z) / rate_mps.z;
            enters_s = enters_s.max(one.min(other));
            if enters_s > leaves_s.min(one.max(other)) {
                return None;
            }
        }
        Some(self.begins_s + enters_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: VolumeReach = VolumeReach {
        radius_m: 60.0,
        half_height_m: 60.0,
    };

    fn north() -> WaysAhead {
        let own_m = Vec3::new(0.0, 0.0, 100.0);
        WaysAhead::new(
            10.0,
            (own_m, Vec3::new(0.0, 25.0, 0.0)),
            own_m,
            &[
                Vec3::new(0.0, 500.0, 100.0),
                Vec3::new(1000.0, 500.0, 100.0),
            ],
        )
    }

    /// After the turn the aircraft has no conflict on its course, but still on its way.
    #[test]
    fn an_avoided_aircraft_stays_urgent() {
        let on_leg_m = Vec3::new(0.0, 100.0, 100.0);
        let own = (on_leg_m + Vec3::X * 120.0, Vec3::new(25.0, 0.0, 0.0));
        let ahead = WaysAhead::new(10.0, own, on_leg_m, &[Vec3::new(0.0, 2000.0, 100.0)]);
        let (at_m, velocity_mps) = (Vec3::new(0.0, 800.0, 100.0), Vec3::new(0.0, -25.0, 0.0));
        let urgency = ahead.urgency(at_m, velocity_mps, 10.0, REACH);
        assert!(urgency.conflict_s < 14.0, "{urgency:?}");
    }

    #[test]
    fn a_head_on_intruder_is_more_urgent_than_company_above() {
        let ahead = north();
        let intruder = ahead.urgency(
            Vec3::new(0.0, 1200.0, 100.0),
            Vec3::new(0.0, -25.0, 0.0),
            10.0,
            REACH,
        );
        assert!((intruder.conflict_s - 22.0).abs() < 1e-6, "{intruder:?}");
        let company = ahead.urgency(
            Vec3::new(0.0, 20.0, 250.0),
            Vec3::new(0.0, 25.0, 0.0),
            10.0,
            REACH,
        );
        assert_eq!(company.conflict_s, f64::INFINITY);
        assert!(company.reach_s < 10.0);
    }

    #[test]
    fn a_conflict_behind_the_next_corner_counts() {
        // After the corner at 20 s the way leads east.
        let urgency = north().urgency(
            Vec3::new(1400.0, 500.0, 100.0),
            Vec3::new(-10.0, 0.0, 0.0),
            10.0,
            REACH,
        );
        // 1,400 m − 200 m − 100 m over 35 m/s.
        assert!(
            (urgency.conflict_s - (20.0 + 1100.0 / 35.0)).abs() < 1e-6,
            "{urgency:?}"
        );
    }

    #[test]
    fn one_that_climbs_into_the_way_is_a_conflict() {
        let climbing = north().urgency(
            Vec3::new(0.0, 10.0, -300.0),
            Vec3::new(0.0, 25.0, 5.0),
            10.0,
            REACH,
        );
        assert!((climbing.conflict_s - 60.0).abs() < 1e-6, "{climbing:?}");
        let leaving = north().urgency(
            Vec3::new(0.0, -30.0, 100.0),
            Vec3::new(0.0, -25.0, 0.0),
            10.0,
            REACH,
        );
        assert_eq!(leaving.conflict_s, f64::INFINITY);
    }
}

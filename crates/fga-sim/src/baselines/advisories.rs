//! Vertical advisories in the manner of TCAS II, at one level of sensitivity.
//!
//! An aircraft is a threat while it closes, its modified tau is at most 25 s (or its range below DMOD), it is or will be within 600 ft of
//! height, and it would pass within DMOD: thresholds of sensitivity level 5 (5,000 to 10,000 ft) in FAA, *Introduction to TCAS II Version 7.1*
//! (2011), Table 2. The advisory is the climb or the descent of 1,500 ft/min, begun 5 s later, that leaves more height at the closest approach; the
//! pilot begins 5 s after the advisory and levels off once the aircraft part. No coordination, no strengthening, no reversal.

use fga::Vec3;

use super::Steering;
use super::view::{Sphere, View, levelled};

/// Modified tau of an advisory, seconds.
const TAU_S: f64 = 25.0;

/// Distance modification, 0.55 NM; also the largest predicted miss distance, metres.
const DMOD_M: f64 = 0.55 * 1852.0;

/// Height within which an aircraft is a threat, 600 ft, metres.
const HEIGHT_M: f64 = 182.88;

/// From the advisory to the climb, seconds.
const RESPONSE_S: f64 = 5.0;

/// Climb rate of an advisory, 1,500 ft/min, metres per second.
const RATE_MPS: f64 = 7.62;

/// The advisory and its pilot.
#[derive(Debug, Default)]
pub struct VerticalAdvisories {
    time_s: f64,
    /// The aircraft, the climb rate, and when the pilot begins.
    advised: Option<(u32, f64, f64)>,
}

/// Range, range rate and time of the horizontal closest approach; `None` while the aircraft part.
fn closing(sphere: &Sphere, own_mps: Vec3) -> Option<(f64, f64, f64)> {
    let offset_m = Vec3::new(sphere.offset_m.x, sphere.offset_m.y, 0.0);
    let relative = sphere.velocity_mps - own_mps;
    let relative_mps = Vec3::new(relative.x, relative.y, 0.0);
    let range_m = offset_m.length().max(1.0);
    let rate_mps = offset_m.dot(relative_mps) / range_m;
    let closest_s = -offset_m.dot(relative_mps) / relative_mps.length_squared().max(1e-9);
    (rate_mps < 0.0).then_some((range_m, rate_mps, closest_s))
}

/// Whether an aircraft is a threat, and the time of its closest approach.
fn threat(sphere: &Sphere, own_mps: Vec3) -> Option<f64> {
    let (range_m, rate_mps, closest_s) = closing(sphere, own_mps)?;
    let is_near =
        range_m <= DMOD_M || (range_m * range_m - DMOD_M * DMOD_M) / (range_m * -rate_mps) <= TAU_S;
    let relative_mps = sphere.velocity_mps - own_mps;
    let miss = sphere.offset_m + relative_mps * closest_s;
    let passes_near = libm::hypot(miss.x, miss.y) <= DMOD_M;
    let (height_m, climbs_mps) = (sphere.offset_m.z, relative_mps.z);
    let is_level = height_m.abs() <= HEIGHT_M
        || (height_m * climbs_mps < 0.0 && height_m.abs() / climbs_mps.abs() <= TAU_S);
    (is_near && passes_near && is_level).then_some(closest_s)
}

impl Steering for VerticalAdvisories {
    fn restart(&mut self) {
        *self = Self::default();
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let time_s = self.time_s;
        self.time_s += view.period_s;
        let own_mps = view.velocity_mps;
        self.advised = self.advised.filter(|(id, ..)| {
            let advised = view.spheres.iter().find(|sphere| sphere.id == *id);
            advised.is_some_and(|sphere| closing(sphere, own_mps).is_some())
        });
        if self.advised.is_none() {
            let threats = view.spheres.iter().filter_map(|sphere| {
                let closest_s = threat(sphere, own_mps)?;
                Some((sphere, closest_s))
            });
            let nearest = threats.min_by(|a, b| a.1.total_cmp(&b.1));
            self.advised = nearest.map(|(sphere, closest_s)| {
                let left_m = |rate_mps: f64| {
                    let own_m = own_mps.z * closest_s.min(RESPONSE_S)
                        + rate_mps * (closest_s - RESPONSE_S).max(0.0);
                    (sphere.offset_m.z + sphere.velocity_mps.z * closest_s - own_m).abs()
                };
                let rate_mps = if left_m(RATE_MPS) >= left_m(-RATE_MPS) {
                    RATE_MPS
                } else {
                    -RATE_MPS
                };
                (sphere.id, rate_mps, time_s + RESPONSE_S)
            });
        }
        let (_, rate_mps, begins_s) = self.advised?;
        if time_s < begins_s - 1e-9 {
            return None;
        }
        let speed_mps = view.speed_mps();
        let rate_mps = rate_mps.clamp(-0.9 * speed_mps, 0.9 * speed_mps);
        let level_mps = libm::sqrt(speed_mps * speed_mps - rate_mps * rate_mps);
        Some(levelled(view.preferred_mps).normalize_or_zero() * level_mps + Vec3::Z * rate_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::RelativeRoute;
    use fga::vehicle::Vehicle;

    /// Head-on at 100 m/s, 30 m below: modified tau reaches 25 s at r² − 1,018.6² = 2,500·r, r = 2,860 m; the pilot climbs 5 s later.
    #[test]
    fn the_pilot_climbs_above_what_is_below_5_s_after_tau() {
        let vehicle = Vehicle {
            airspeed_mps: 50.0,
            ..Vehicle::table_4()
        };
        let flown = |height_m: f64, aside_m: f64| {
            let mut advisories = VerticalAdvisories::default();
            (0..60_i32).find_map(|second| {
                let spheres = [Sphere {
                    id: 1,
                    offset_m: Vec3::new(4000.0 - 100.0 * f64::from(second), aside_m, height_m),
                    velocity_mps: Vec3::X * -50.0,
                    radius_m: 152.4,
                }];
                let view = View {
                    velocity_mps: Vec3::X * 50.0,
                    preferred_mps: Vec3::X * 50.0,
                    route: RelativeRoute {
                        foot_m: Vec3::ZERO,
                        along: Vec3::X,
                    },
                    spheres: &spheres,
                    vehicle: &vehicle,
                    period_s: 1.0,
                };
                advisories.steer(&view).map(|velocity| (second, velocity.z))
            })
        };
        // 4,000 m − 100 m/s · 12 s = 2,800 m is the first whole second within.
        assert_eq!(flown(-30.0, 0.0), Some((17, RATE_MPS)));
        assert_eq!(flown(30.0, 0.0), Some((17, -RATE_MPS)));
        // 250 m of height, or 1,200 m aside: no advisory.
        assert_eq!(flown(250.0, 0.0), None);
        assert_eq!(flown(0.0, 1200.0), None);
    }
}

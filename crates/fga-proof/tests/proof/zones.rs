//! Zones against code of this test: containment as `geo` has it, and the certificate never above what a flight keeps.
//!
//! The flights are integrated here in steps of a millisecond, the distances are measured here, at each step that can be the
//! nearest. 20,000 flights and 10⁵ places by default; `FGA_ZONE_CASES` and `FGA_ZONE_PLACES` set other numbers,
//! `FGA_FIRST_CASE` draws other flights.

use core::f64::consts::TAU;

use crate::flown::{Flown, INTEGRATED_M, STEP_S, drawn, number};
use crate::random::Random;
use fga_proof::assumptions::Assumptions;
use fga_proof::certificate::{MAX_ZONES, Status, Zones, certify_set};
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};
use fga_proof::situation::Mission;
use fga_proof::zone::{ALL_HEIGHTS_M, Outline, Zone};
use fga_proof::{Vec2, Vec3};

/// Most corners of a drawn polygon.
const MAX_CORNERS: usize = 256;

/// The certificate is at most this far below what is flown, besides the prediction's own bound, metres.
const SLACK_M: f64 = 0.02;

impl Random {
    /// Convex, concave, spiky, or a comb; 3 to 256 corners, either way round.
    fn corners(&mut self, center: Vec2, size_m: f64) -> Vec<Vec2> {
        let most = if self.chance(0.1) {
            MAX_CORNERS as f64
        } else {
            24.0
        };
        let count = self.within(3.0, most + 1.0) as usize;
        let (sin, cos) = self.within(0.0, TAU).sin_cos();
        let mut corners: Vec<Vec2> = if self.chance(0.2) && count >= 6 {
            // Teeth of a comb, on a back.
            let teeth = (count / 2).max(3);
            let mut comb = vec![Vec2::new(-1.0, -0.4), Vec2::new(1.0, -0.4)];
            for tooth in 0..2 * teeth - 2 {
                let x = 1.0 - 2.0 * tooth as f64 / (2 * teeth - 3) as f64;
                let y = if tooth % 2 == 0 {
                    1.0
                } else {
                    self.within(-0.35, 0.5)
                };
                comb.push(Vec2::new(x, y));
            }
            comb.truncate(MAX_CORNERS);
            comb
        } else {
            let least = [1.0, 0.4, 0.03][(self.unit() * 3.0) as usize];
            let mut angles: Vec<f64> = (0..count)
                .map(|step| (step as f64 + self.within(0.05, 0.95)) / count as f64 * TAU)
                .collect();
            angles.sort_by(f64::total_cmp);
            let around = angles.iter().map(|angle| {
                let (sin, cos) = angle.sin_cos();
                self.within(least, 1.0) * Vec2::new(cos, sin)
            });
            around.collect()
        };
        if self.chance(0.5) {
            corners.reverse();
        }
        for corner in &mut corners {
            let at = *corner * size_m;
            *corner = center + Vec2::new(cos * at.x - sin * at.y, sin * at.x + cos * at.y);
        }
        corners
    }
}

/// The signed distance to a zone from those to its outline and to its heights: negative on the wrong side.
fn margin(keep_in: bool, beside: f64, above: f64) -> f64 {
    let outside = if beside > 0.0 && above > 0.0 {
        beside.hypot(above)
    } else {
        beside.max(above)
    };
    if keep_in { -outside } else { outside }
}

/// The signed distance to heights: negative between them.
fn above((floor, ceiling): (f64, f64), z: f64) -> f64 {
    (floor - z).max(z - ceiling)
}

enum Shape {
    Polygon(Vec<Vec2>),
    Circle(Vec2, f64),
}

impl Shape {
    fn outline(&self) -> Outline<'_> {
        match self {
            Self::Polygon(corners) => Outline::Polygon(corners),
            Self::Circle(center, radius) => Outline::Circle(*center, *radius),
        }
    }

    /// The signed distance to the outline: negative inside.
    fn beside(&self, at: Vec2) -> f64 {
        match self {
            Self::Circle(center, radius) => (at - center).length() - radius,
            Self::Polygon(corners) => {
                let (mut least, mut inside) = (f64::INFINITY, false);
                let mut a = corners[corners.len() - 1];
                for &b in corners {
                    let (edge, from) = (b - a, at - a);
                    let share = (from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
                    least = least.min((from - share * edge).length_squared());
                    if (a.y > at.y) != (b.y > at.y)
                        && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x)
                    {
                        inside = !inside;
                    }
                    a = b;
                }
                if inside { -least.sqrt() } else { least.sqrt() }
            }
        }
    }
}

#[test]
#[expect(
    clippy::too_many_lines,
    reason = "a case from its draw to its judgement"
)]
fn no_zone_is_nearer_than_certified() {
    let cases = number("FGA_ZONE_CASES", 20_000);
    let (mut clear, mut entered, mut slackest) = (0, 0, 0.0_f64);
    for case in drawn(cases) {
        let random = &mut Random(0x5ee0_0000 + case);
        let vehicle = random.vehicle();
        let maneuver = random.maneuver();
        let wind = random.wind_mps(vehicle.airspeed_mps);
        let horizon_s = random.within(2.0, 30.0);
        let flyer = Flyer::new(&vehicle);
        let mut path = FlightPath::new();
        path.predict(&flyer, &MotionState::ahead(0.0), &maneuver, horizon_s);
        let keep_in = random.chance(0.5);
        let share = if keep_in { 0.2 } else { 1.0 };
        let near_s = random.within(0.0, share * horizon_s);
        // A steep roll may need more nodes than there are.
        if !path.is_complete() {
            continue;
        }
        let Some(near) = path.state_at(&flyer, near_s) else {
            continue;
        };
        let near = near.position_m + wind * near_s;
        let size_m = if keep_in {
            random.within(100.0, 1500.0)
        } else {
            random.within(10.0, 500.0)
        };
        let (sin, cos) = random.within(0.0, TAU).sin_cos();
        let off_m = random.within(0.0, if keep_in { 0.8 } else { 2.0 }) * size_m;
        let center = near.truncate() + off_m * Vec2::new(cos, sin);
        let height = |random: &mut Random| random.within(0.0, if keep_in { 300.0 } else { 60.0 });
        let heights = (
            if random.chance(0.3) {
                f64::NEG_INFINITY
            } else {
                near.z - height(random) + 20.0
            },
            if random.chance(0.3) {
                f64::INFINITY
            } else {
                near.z + height(random) + 20.5
            },
        );
        let shape = if random.chance(0.2) {
            Shape::Circle(center, size_m)
        } else {
            let mut corners = random.corners(center, size_m);
            // Edges that cross.
            if random.chance(0.15) {
                let count = corners.len();
                for index in 0..count {
                    corners.swap(index, (random.unit() * count as f64) as usize);
                }
            }
            Shape::Polygon(corners)
        };
        let measure = |at: Vec3| {
            let beside_m = shape.beside(at.truncate());
            (beside_m, margin(keep_in, beside_m, above(heights, at.z)))
        };
        let zone = Zone {
            keep_in,
            outline: shape.outline(),
            heights_m: heights,
        };
        let mission = Mission {
            zones: &[zone],
            ..Mission::NONE
        };
        let mut zones = Zones::NONE;
        zones.clear(wind, f64::INFINITY);
        let spare_m = if random.chance(0.7) {
            0.0
        } else {
            random.within(0.0, 20.0)
        };
        zones.spare_m = spare_m;
        let begins_well = zones.add(mission.zones, 0, (Vec3::ZERO, 1e9));
        let meter = Meter::unlimited();
        let asked = (horizon_s, f64::MIN, 1e3 + spare_m);
        let found = certify_set(
            &flyer,
            &path,
            &Assumptions::new(&[], &zones, &mission),
            asked,
            &meter,
        );
        assert_eq!(found.status, Status::Proven, "{case}");
        assert_eq!(begins_well, measure(Vec3::ZERO).1 >= 0.0, "{case}");
        // Also less than is spared: even then none is entered.
        let target_m = random.within(-20.0, 30.0).max(-spare_m);
        let scene = (horizon_s, target_m + spare_m, 1e3 + spare_m);
        let proven = crate::proven(
            (&flyer, &mut path),
            &maneuver,
            &Assumptions::new(&[], &zones, &mission),
            scene,
            &meter,
        );
        let proven_m = proven.map_or(f64::MIN, |proven| proven.bound().margin_m);
        let bound_m = found.margin_m.max(proven_m) - spare_m;
        let mut flown = Flown::new(&vehicle, &maneuver, wind);
        let speed_mps = vehicle.airspeed_mps + wind.length();
        let (mut places, mut least_m, mut nearest) = (Vec::new(), f64::INFINITY, Vec3::ZERO);
        while flown.time_s <= horizon_s && least_m >= -INTEGRATED_M {
            if places.len() % 50 == 0 {
                let (_, here_m) = measure(flown.at);
                if here_m < least_m {
                    (least_m, nearest) = (here_m, flown.at);
                }
            }
            places.push(flown.at);
            flown.step();
        }
        // Between two places no distance falls by more than the way between them.
        let way_m = speed_mps * STEP_S;
        let unknown_m = if keep_in {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
        let (mut index, mut measured, mut beside_m) = (0, 0, unknown_m);
        while index < places.len() && least_m >= -INTEGRATED_M {
            let at = places[index];
            let off_m = way_m * (index - measured) as f64;
            let worst_m = beside_m + if keep_in { off_m } else { -off_m };
            let mut here_m = margin(keep_in, worst_m, above(heights, at.z));
            if here_m < least_m {
                (measured, (beside_m, here_m)) = (index, measure(at));
                if here_m < least_m {
                    (least_m, nearest) = (here_m, at);
                }
            }
            index += (((here_m - least_m) / way_m) as usize).max(1);
        }
        // What begins on the wrong side is known exactly.
        if least_m < -INTEGRATED_M || !begins_well {
            entered += 1;
            assert!(found.margin_m < 0.0, "{case}: {} {least_m}", found.margin_m);
            assert!(proven.is_none(), "{case}: {least_m}");
            continue;
        }
        clear += 1;
        assert!(
            bound_m <= least_m + INTEGRATED_M,
            "{case}: {bound_m} above {least_m}"
        );
        let known_m = SLACK_M + 1e-3 * speed_mps;
        // So near a zone a flight is not known to enter none, and nothing is spared.
        let is_near = least_m < known_m + path.remainder_m();
        // So near above or below a zone it may count as deep as the zone is wide.
        if is_near && !keep_in && shape.beside(nearest.truncate()) < 0.0 {
            continue;
        }
        let spared_m = if is_near { 0.0 } else { spare_m };
        let slack_m = least_m.min(1e3) + spared_m - found.margin_m - path.remainder_m();
        slackest = slackest.max(slack_m);
        assert!(
            slack_m <= known_m,
            "{case}: {} below {least_m}",
            found.margin_m
        );
        if least_m > target_m.max(0.0) + known_m + path.remainder_m() {
            assert!(proven.is_some(), "{case}");
        }
    }
    println!("{clear} flights clear, {entered} on the wrong side, most slack {slackest:.4} m");
    assert!(
        clear > cases / 5 && entered > cases / 5,
        "{clear} {entered}"
    );
}

#[test]
fn containment_is_that_of_geo() {
    use geo::Intersects as _;
    let places = number("FGA_ZONE_PLACES", 100_000);
    let random = &mut Random(7);
    let grid = |at: Vec2| (at * 64.0).round() / 64.0;
    let (mut seen, mut on_edge) = (0, 0);
    while seen < places {
        let drawn = random.corners(Vec2::new(30.0, -50.0), 400.0);
        // On a grid, where products are exact.
        let corners: Vec<Vec2> = drawn.into_iter().map(grid).collect();
        let zone = Zone {
            keep_in: false,
            outline: Outline::Polygon(&corners),
            heights_m: ALL_HEIGHTS_M,
        };
        let ring = corners.iter().map(|at| (at.x, at.y)).collect::<Vec<_>>();
        let theirs = geo::Polygon::new(geo::LineString::from(ring), vec![]);
        for _ in 0..200 {
            let index = (random.unit() * corners.len() as f64) as usize;
            let (a, b) = (corners[index], corners[(index + 1) % corners.len()]);
            let at = match (random.unit() * 5.0) as usize {
                0 => a,
                // Exactly on the edge, if it is even.
                1 => a + 0.5 * (b - a),
                2 => grid(a + random.unit() * (b - a)),
                // At the height of a corner.
                3 => Vec2::new(grid(Vec2::new(random.within(-400.0, 460.0), 0.0)).x, a.y),
                _ => Vec2::new(random.within(-400.0, 460.0), random.within(-480.0, 380.0)),
            };
            let is_inside = zone.is_entered(at.extend(50.0));
            assert_eq!(
                is_inside,
                theirs.intersects(&geo::Point::new(at.x, at.y)),
                "{at} {corners:?}"
            );
            seen += 1;
            on_edge += u64::from((0.5 * (a + b) == at || a == at) && is_inside);
        }
    }
    assert!(on_edge > places / 4, "{on_edge}");
}

#[test]
fn the_way_out_is_the_nearest() {
    let corners = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 200.0], [0.0, 200.0]].map(Vec2::from_array);
    let way_m = |keep_in, outline, at_m| {
        let heights_m = (0.0, 100.0);
        let zone = Zone {
            keep_in,
            outline,
            heights_m,
        };
        assert!(zone.is_entered(at_m));
        zone.way_out_m(at_m)
    };
    let corridor = Outline::Polygon(&corners);
    let circle = Outline::Circle(Vec2::ZERO, 50.0);
    assert_eq!(
        way_m(false, corridor, Vec3::new(500.0, 150.0, 99.0)),
        Vec3::Y * 50.0
    );
    assert_eq!(
        way_m(true, corridor, Vec3::new(-30.0, 150.0, 500.0)),
        Vec3::X * 30.0
    );
    assert_eq!(
        way_m(true, corridor, Vec3::new(30.0, 150.0, 110.0)),
        Vec3::Z * -10.0
    );
    assert_eq!(
        way_m(true, corridor, Vec3::new(30.0, 150.0, -5.0)),
        Vec3::Z * 5.0
    );
    assert_eq!(way_m(false, circle, Vec3::ZERO), Vec3::X * 50.0);
    assert_eq!(way_m(true, circle, Vec3::Y * -80.0), Vec3::Y * 30.0);
}

#[test]
fn without_room_for_all_zones_nothing_is_proven() {
    let corners: Vec<Vec2> = (0..MAX_CORNERS)
        .map(|corner| {
            let (sin, cos) = (corner as f64 / MAX_CORNERS as f64 * TAU).sin_cos();
            Vec2::new(1e4 * cos, 1e4 * sin)
        })
        .collect();
    let zone = Zone {
        keep_in: true,
        outline: Outline::Polygon(&corners),
        heights_m: (-1e3, 1e3),
    };
    let far = Zone {
        keep_in: false,
        outline: Outline::Circle(Vec2::splat(6e3), 50.0),
        heights_m: ALL_HEIGHTS_M,
    };
    let mission = Mission {
        zones: &[zone, far],
        ..Mission::NONE
    };
    let flyer = Flyer::new(&Random(1).vehicle());
    let mut path = FlightPath::new();
    let mut zones = Zones::NONE;
    zones.clear(Vec3::ZERO, 10.0);
    let mut proven = |zones: &Zones| {
        crate::proven(
            (&flyer, &mut path),
            &Maneuver::hold(),
            &Assumptions::new(&[], zones, &mission),
            (10.0, 0.0, 1e3),
            &Meter::unlimited(),
        )
        .is_some()
    };
    for _ in 0..2 {
        assert!(zones.add(mission.zones, 0, (Vec3::ZERO, 1e9)));
        assert!(proven(&zones));
    }
    assert!(!zones.add(mission.zones, 0, (Vec3::ZERO, 1e9)));
    assert!(!proven(&zones));
    // Far edges, and what is far as a whole, take no room.
    zones.clear(Vec3::ZERO, 10.0);
    for _ in 0..MAX_ZONES {
        assert!(zones.add(mission.zones, 0, (Vec3::ZERO, 5e3)));
        assert!(zones.add(mission.zones, 1, (Vec3::ZERO, 5e3)));
    }
    assert!(proven(&zones));
    assert!(!zones.add(mission.zones, 0, (Vec3::ZERO, 5e3)));
    assert!(!proven(&zones));
}

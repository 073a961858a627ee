//! The safe manoeuvre that leaves the mission least: the reference for the policy's cross-track
//! deviation.

use super::flight::OracleFlight;
use super::pattern::Refiner;
use super::search::hold_all_the_way;
use super::separation::{OracleBody, OracleScene, least_margin};
use super::{OracleManeuver, OracleObstacle, OracleSettings, OracleStart, OracleVehicle};

/// A safe manoeuvre and its distance from the mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepartureAnswer {
    /// The manoeuvre.
    pub maneuver: OracleManeuver,
    /// Its margin, metres.
    pub margin_m: f64,
    /// Largest distance from the line of the start's course, metres, when a turn back to that
    /// course follows as soon as every obstacle has passed.
    pub max_cross_track_m: f64,
    /// The moment from which no obstacle comes closer any more, seconds.
    pub passed_s: f64,
}

/// The manoeuvre of least largest distance from the line of the start's course among those that
/// keep `required_margin_m`; `None` if none of the tried ones keeps it.
///
/// Once no obstacle comes closer any more the aircraft turns back to its course, keeping the
/// margin; the way back to the line is not part of it. Wait, turn, fly on and turn back, on a grid
/// and refined, in the family of [`super::search::best_margin`]. Costs tens of milliseconds.
pub fn least_departure(
    start: &OracleStart,
    vehicle: &OracleVehicle,
    obstacles: &[OracleObstacle],
    settings: &OracleSettings,
    required_margin_m: f64,
) -> Option<DepartureAnswer> {
    let bodies: Vec<OracleBody> = obstacles.iter().map(OracleBody::new).collect();
    let horizon_s = settings.horizon_s;
    let mut judge = DepartureJudge {
        scene: OracleScene {
            start,
            vehicle,
            bodies: &bodies,
            horizon_s,
        },
        obstacles,
        required_margin_m,
        flight: OracleFlight::default(),
    };
    let nothing = hold_all_the_way(start, horizon_s);
    let safest = super::search::best_margin(
        start,
        vehicle,
        obstacles,
        &OracleSettings {
            enough_m: Some(required_margin_m),
            ..*settings
        },
    );
    if safest.best_margin_m < required_margin_m {
        return None;
    }
    let mut seeds: Vec<_> = [nothing, safest.maneuver]
        .into_iter()
        .map(|maneuver| (judge.value(&maneuver, f64::NEG_INFINITY), maneuver))
        .collect();
    lane_changes(&mut judge, &mut seeds);
    seeds.sort_by(|a, b| b.0.total_cmp(&a.0));
    seeds.truncate(24);
    let mut refiner = Refiner::new(
        vehicle,
        horizon_s,
        |maneuver: &OracleManeuver, than: f64| judge.value(maneuver, than),
        *seeds.first()?,
    );
    refiner.refine(&seeds);
    let (_, best) = refiner.best;
    let max_cross_track_m = -judge.value(&best, f64::NEG_INFINITY);
    let margin_m = judge.margin(&best, None, f64::NEG_INFINITY);
    let passed_s = judge.all_passed_s();
    (max_cross_track_m < -UNSAFE).then_some(DepartureAnswer {
        maneuver: best,
        margin_m,
        max_cross_track_m,
        passed_s,
    })
}

/// The best safe lane change of every wait, side and climb angle.
fn lane_changes(judge: &mut DepartureJudge<'_>, seeds: &mut Vec<(f64, OracleManeuver)>) {
    let vehicle = judge.scene.vehicle;
    let (low, high) = (vehicle.climb_min_rad, vehicle.climb_max_rad);
    let climbs: &[f64] = if vehicle.can_climb() {
        &[0.0, 1.0, -1.0, 0.4, -0.4]
    } else {
        &[0.0]
    };
    for wait in 0..20 {
        for sign in [1.0, -1.0] {
            for &share in climbs {
                let climb_rad = if share < 0.0 {
                    -share * low
                } else {
                    share * high
                };
                let mut best = (f64::NEG_INFINITY, OracleManeuver::default());
                for turn in [
                    0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 75.0, 90.0, 120.0, 150.0_f64,
                ] {
                    for straight_s in [0.0, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0, f64::INFINITY] {
                        let turn_rad = sign * turn.to_radians();
                        // The last of these: straight on until all have passed.
                        let back = straight_s.is_finite();
                        let maneuver = OracleManeuver {
                            wait_s: 1.5 * f64::from(wait),
                            turn1_rad: turn_rad,
                            climb1_rad: climb_rad,
                            straight_s: if back { straight_s } else { 0.0 },
                            turn2_rad: if back { -turn_rad } else { 0.0 },
                            climb2_rad: if back { 0.0 } else { climb_rad },
                        };
                        let value = judge.value(&maneuver, best.0);
                        if value > best.0 {
                            best = (value, maneuver);
                        }
                    }
                }
                seeds.push(best);
            }
        }
    }
}

struct DepartureJudge<'a> {
    scene: OracleScene<'a>,
    obstacles: &'a [OracleObstacle],
    required_margin_m: f64,
    flight: OracleFlight,
}

/// Value of an unsafe manoeuvre, before subtracting its lack of margin.
const UNSAFE: f64 = -1e6;

impl DepartureJudge<'_> {
    /// The margin of a manoeuvre that turns back from a time on.
    fn margin(&mut self, maneuver: &OracleManeuver, back_s: Option<f64>, stop_below: f64) -> f64 {
        self.scene.fly(maneuver, back_s, &mut self.flight);
        least_margin(&self.flight, self.scene.bodies, stop_below)
    }

    /// Minus the departure of a safe manoeuvre; an unsafe one is worse than every safe one.
    fn value(&mut self, maneuver: &OracleManeuver, than: f64) -> f64 {
        let stop_below = if than > UNSAFE {
            self.required_margin_m
        } else {
            f64::NEG_INFINITY
        };
        let mut back_s = None;
        for _ in 0..2 {
            let margin = self.margin(maneuver, back_s, stop_below);
            if margin < self.required_margin_m {
                return UNSAFE + (margin - self.required_margin_m);
            }
            back_s = Some(self.all_passed_s());
        }
        -self.departure()
    }

    /// Largest distance from the line of the start's course in the last flight.
    fn departure(&self) -> f64 {
        let start = self.scene.start;
        let (sin, cos) = libm::sincos(start.course_rad);
        self.flight.nodes().iter().fold(0.0_f64, |largest, node| {
            let offset = node.position_m - start.position_m;
            let left = cos * offset.y - sin * offset.x;
            largest.max(libm::sqrt(left * left + offset.z * offset.z))
        })
    }

    /// The moment from which no obstacle comes closer in the last flight, seconds.
    fn all_passed_s(&self) -> f64 {
        self.obstacles
            .iter()
            .map(|obstacle| self.passed_s(obstacle))
            .fold(0.0, f64::max)
    }

    /// The last moment at which the distance to the obstacle shrinks, seconds.
    fn passed_s(&self, obstacle: &OracleObstacle) -> f64 {
        let rate = |at: &super::FlightNode| {
            let offset = at.position_m - obstacle.position_m - obstacle.velocity_mps * at.time_s;
            offset.dot(at.velocity_mps - obstacle.velocity_mps)
        };
        let nodes = self.flight.nodes();
        let Some(last) = nodes.iter().rposition(|node| rate(node) < 0.0) else {
            return 0.0;
        };
        let (Some(a), Some(b)) = (nodes.get(last), nodes.get(last + 1)) else {
            return self.scene.horizon_s;
        };
        // Between these nodes the sign changes; on a straight piece the rate is linear.
        let (before, after) = (rate(a), rate(b));
        a.time_s + (b.time_s - a.time_s) * before / (before - after)
    }
}

//! The last resorts: back to a waypoint that was missed, and straight on from here as if the mission had just begun.

use core::f64::consts::FRAC_PI_2;

use crate::Progress;
use crate::join::Join;
use crate::leg::Leg;
use crate::route::{MOST_LEGS, Route};
use fga_proof::Vec3;
use fga_proof::limit::Limit as _;
use fga_proof::prediction::MotionState;
use fga_proof::situation::FLY_OVER_WITHIN_M;

pub(crate) use crate::route::Restart;

/// Most returns to the last waypoint that bring the aircraft no nearer: gusts can keep the aircraft aside for ever.
const MOST_PASSES: u8 = 3;

/// A waypoint is given up after obstacles at rest have kept the aircraft from coming nearer to it for this long, seconds.
const KEPT_OFF_S: f64 = 120.0;

impl Progress {
    /// Whether the aircraft passed the last waypoint aside and returns to it. A pass nearer than those before does not count, for
    /// an aircraft comes down in circles. The leg then leads over the waypoint with the wind, which gains room for the turn back.
    pub(crate) fn returns_over_waypoint(
        &mut self,
        route: &Route<'_>,
        (leg, state): (&Leg, &MotionState),
        passed_s: f64,
    ) -> bool {
        let position = leg.position(state.position_m, state.time_s);
        let since_m = (leg.ground_speed_mps * passed_s).limited(0.0, route.radius_m());
        let beyond_m = position.along_m - leg.length_m - since_m;
        let aside_m = position.cross_m.abs().max(position.above_m.abs());
        let wind_mps = route.wind_mps;
        let is_missed = route.is_flown_over(self.index)
            && aside_m.max(beyond_m) > FLY_OVER_WITHIN_M
            && self.corner.is_none()
            && self.passes <= MOST_PASSES
            && wind_mps.length() < route.flyer.airspeed_mps();
        if is_missed {
            let moved_m = (route.flyer.velocity_mps(state) + wind_mps) * passed_s;
            let before = leg.position(state.position_m - moved_m, state.time_s);
            let is_now = before.along_m < leg.length_m;
            if is_now && aside_m < self.nearest_m - FLY_OVER_WITHIN_M {
                (self.passes, self.nearest_m) = (0, aside_m);
            } else {
                self.passes += u8::from(is_now);
            }
            let along = Vec3::new(wind_mps.x, wind_mps.y, 0.0);
            let along = along.normalize_or(leg.level_point_m(1.0) - leg.from_m);
            let (index, from_m) = (self.index, leg.point_m(leg.length_m) - along);
            self.restart = Some(Restart { index, from_m });
            self.go_to(route, state, index, false);
        }
        is_missed
    }

    /// Gives the waypoint at the end of the leg up, and goes on to the next one, once obstacles at rest have kept the aircraft from it
    /// for long; an obstacle at rest is avoided for another `passed_s`, seconds. Whether it does.
    #[inline(never)]
    pub fn gives_up(&mut self, route: &Route<'_>, state: &MotionState, passed_s: f64) -> bool {
        let Some(leg) = self.leg.filter(|_| !self.is_complete) else {
            return false;
        };
        let position = leg.position(state.position_m, state.time_s);
        let off_m = libm::hypot(leg.length_m - position.along_m, position.cross_m);
        let (nearest_m, for_s) = self.kept_off;
        let is_nearer = off_m < nearest_m - route.radius_m();
        self.kept_off = if is_nearer {
            (off_m, 0.0)
        } else {
            (nearest_m, for_s + passed_s)
        };
        let gives_up = self.kept_off.1 > KEPT_OFF_S;
        if gives_up {
            self.go_to(route, state, self.index + 1, false);
        }
        gives_up
    }

    /// Restarts the mission where the aircraft is: the present leg leads straight from there to its end, or to the first
    /// waypoint after it that the wind does not keep the aircraft from.
    pub(crate) fn restart_here(&mut self, route: &Route<'_>, state: &MotionState) {
        let from_m = state.position_m + route.wind_mps * state.time_s;
        let last = route.mission.waypoints_m.len().saturating_sub(1);
        let found = (self.index..last).take(MOST_LEGS).find_map(|index| {
            let mut restart = Restart { index, from_m };
            let mut legs = self.legs(route);
            legs.restart = Some(restart);
            let leg = legs.leg(index).filter(|leg| leg.length_m.is_finite())?;
            let climb_rad = route.climb_rad(&leg);
            if climb_rad != leg.climb_rad {
                // Too steep to fly: as steep as can be flown, to the same end.
                let airspeed_mps = route.flyer.airspeed_mps();
                let climb_mps = airspeed_mps * libm::sin(climb_rad) + route.wind_mps.z;
                let rise_m = climb_mps * leg.length_m / leg.ground_speed_mps;
                restart.from_m.z = route.mission.waypoints_m.get(index + 1)?.z - rise_m;
            }
            leg.can_be_flown().then_some(restart)
        });
        if let Some(restart) = found {
            self.restart = found;
            self.go_to(route, state, restart.index, false);
        }
    }

    /// A way straight to the next waypoint, as if the mission began where the aircraft is; it does so afterwards, with a way or
    /// without.
    #[inline(never)]
    pub fn direct_way(&mut self, route: &Route<'_>, state: &MotionState) -> Option<Join> {
        self.restart_here(route, state);
        // The steepest way joins soonest, before a near waypoint too. It need not end on the leg: guidance goes on from there.
        let found = self.way_back(route, state, FRAC_PI_2, MOST_LEGS);
        found.filter(|_| !self.is_adrift())
    }

    /// The same; without a way the mission stays as it was.
    #[inline(never)]
    pub(crate) fn direct_way_or_none(
        &mut self,
        route: &Route<'_>,
        state: &MotionState,
    ) -> Option<Join> {
        let before = *self;
        let found = self.direct_way(route, state);
        if found.is_none() {
            *self = before;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::along;
    use core::f64::consts::PI;
    use fga_proof::angle::direction;
    use fga_proof::maneuver::{Maneuver, Stage};
    use fga_proof::prediction::flown;
    use fga_proof::situation::{Mission, Passing};
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    /// Two turns back at most, and the drift in them.
    const STRAYS_RADII: f64 = 8.0;

    /// How a mission to 500 m ahead went.
    struct Flown {
        is_complete: bool,
        /// The least distance from its end, metres.
        least_m: f64,
        /// How far from its end the aircraft came, farther than at first, turn radii.
        strays_radii: f64,
    }

    /// Flies the mission for some steps from a state. With a turn and turn radii, the aircraft first finds a way from as far away, and
    /// drops it.
    fn fly(
        lag_s: f64,
        mut state: MotionState,
        wind_mps: Vec3,
        (steps, away): (u32, Option<(f64, f64)>),
    ) -> Flown {
        let vehicle = Vehicle::lagged(lag_s);
        let waypoints_m = [Vec3::ZERO, Vec3::new(500.0, 0.0, 0.0)];
        let passing = [Passing::FlyBy, Passing::FlyOver];
        let mission = Mission {
            passing: &passing,
            ..Mission::new(&waypoints_m)
        };
        along(&vehicle, wind_mps, &mission, |route| {
            let flyer = route.flyer;
            let there = away.map(|(turn_rad, radii)| {
                let away = Stage::turn(0.0, state.course_rad + turn_rad, 0.0);
                let away_s = radii / flyer.course_rate_radps();
                flown(flyer, &state, &[away], away_s, route.meter)
            });
            let off_m = |state: &MotionState| state.position_m.distance(waypoints_m[1]);
            let first_m = off_m(&state);
            let (mut least_m, mut farthest_m) = (f64::INFINITY, 0.0_f64);
            let (mut progress, mut command) = (Progress::new(), Maneuver::hold());
            for step in 0..steps {
                progress.update(route, &state, 0.1 * f64::from(step));
                least_m = off_m(&state).min(least_m);
                if progress.is_complete() {
                    break;
                }
                if step == 0
                    && let Some(there) = &there
                {
                    progress.direct_way(route, there);
                }
                farthest_m = off_m(&state).max(farthest_m);
                progress.guidance(route, &state, 0.2, &mut command);
                state = flown(flyer, &state, command.stages(), 0.1, route.meter);
                state.position_m += wind_mps * 0.1;
                state.time_s = 0.0;
            }
            Flown {
                is_complete: progress.is_complete(),
                least_m,
                strays_radii: (farthest_m - first_m) / flyer.turn_radius_m(),
            }
        })
    }

    /// How far the aircraft strays, turn radii, after a way from elsewhere was dropped; infinite where the mission does not end.
    fn strays(lag_s: f64, state: MotionState, wind_mps: Vec3, away: (f64, f64)) -> f64 {
        let flown = fly(lag_s, state, wind_mps, (6000, Some(away)));
        if flown.is_complete {
            flown.strays_radii
        } else {
            f64::INFINITY
        }
    }

    /// Of a mission of three waypoints the second one is given up after 120 s without coming a turn radius nearer, then the third.
    #[test]
    fn a_waypoint_is_given_up_after_two_minutes_without_coming_nearer() {
        let waypoints_m = [0.0, 500.0, 900.0].map(|x_m| Vec3::new(x_m, 0.0, 0.0));
        let mission = Mission::new(&waypoints_m);
        along(&Vehicle::lagged(0.0), Vec3::ZERO, &mission, |route| {
            let mut progress = Progress::new();
            let mut given_up_s = [0.0; 2];
            let mut times = given_up_s.iter_mut();
            for step in 0..4000 {
                let time_s = 0.1 * f64::from(step);
                // It comes 100 m nearer after 60 s.
                let x_m = if time_s < 60.0 { 100.0 } else { 200.0 };
                let state = MotionState {
                    position_m: Vec3::new(x_m, 80.0, 0.0),
                    ..MotionState::ahead(0.0)
                };
                progress.update(route, &state, time_s);
                if progress.gives_up(route, &state, 0.1) {
                    *times.next().expect("two waypoints ahead") = libm::round(time_s);
                }
            }
            assert_eq!(given_up_s, [180.0, 300.0]);
            assert!(progress.is_complete());
        });
    }

    /// Restarted within a millimetre of the leg's end, the mission once went on for ever along a leg without end.
    #[test]
    fn d1_a_leg_that_restarts_at_its_end_has_an_end() {
        for before_m in [0.0, 1e-9, 5e-4, 9e-4] {
            let state = MotionState {
                position_m: Vec3::new(500.0 - before_m, 0.0, 0.0),
                course_rad: 0.5,
                ..MotionState::ahead(0.0)
            };
            assert!(
                fly(0.0, state, Vec3::ZERO, (3000, None)).is_complete,
                "{before_m} m before its end"
            );
        }
    }

    /// Past the end of a leg that began elsewhere, the aircraft once flew on against the wind, 430 m away.
    #[test]
    fn d1_past_the_end_of_a_dropped_way_no_aircraft_flies_away() {
        let state = MotionState {
            position_m: Vec3::new(551.0, -39.0, 0.0),
            course_rad: -1.45,
            ..MotionState::ahead(0.0)
        };
        let radii = strays(0.7, state, Vec3::new(3.2, 11.5, 0.0), (PI, 18.0));
        assert!(radii < STRAYS_RADII, "{radii} turn radii");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        /// Wherever a way to the last waypoint was dropped, the aircraft flies to it in any wind from about there.
        #[test]
        fn d1_near_the_end_no_aircraft_flies_away(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            (x, y, z) in (300.0..600.0f64, -100.0..100.0f64, -20.0..20.0f64),
            course_rad in -3.1..3.1f64,
            (wind_share, wind_rad) in (0.0..0.85f64, -3.1..3.1f64),
            away in prop_oneof![Just((0.0, 4.0)), Just((0.0, 12.0)), Just((PI, 6.0)), Just((PI, 18.0))],
        ) {
            let state = MotionState { position_m: Vec3::new(x, y, z), course_rad, ..MotionState::ahead(0.0) };
            let wind_mps = direction(wind_rad, 0.0) * (15.0 * wind_share);
            let radii = strays(lag_s, state, wind_mps, away);
            prop_assert!(radii < STRAYS_RADII, "{radii} turn radii");
        }

        /// From wherever it is near the end of its mission the aircraft flies over the last waypoint, and the mission ends then, not
        /// where it comes back to the line beyond. From far above it comes down in circles.
        #[test]
        fn d10_a_mission_is_flown_over_its_last_waypoint(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            (x, y, z) in (300.0..560.0f64, -80.0..80.0f64, -90.0..90.0f64),
            course_rad in -3.1..3.1f64,
            (wind_share, wind_rad) in (prop_oneof![Just(0.0), 0.0..0.85f64], -3.1..3.1f64),
        ) {
            let state = MotionState { position_m: Vec3::new(x, y, z), course_rad, ..MotionState::ahead(0.0) };
            let wind_mps = direction(wind_rad, 0.0) * (15.0 * wind_share);
            let flown = fly(lag_s, state, wind_mps, (9000, None));
            prop_assert!(flown.is_complete && flown.least_m < 10.0, "{} m off", flown.least_m);
        }
    }
}

//! Which way would the vehicle fly by itself, and is the aircraft on it?

use fga::Vec3;
use fga::angle::{course_of, wrap_pi};
use fga::maneuver::Maneuver;
use fga::situation::{Obstacle, ObstacleKind, Ownship};
use serde_json::json;

use super::lists::Lists;
use super::rally::{ReturnPlaces, SAME_TARGET_M};
use super::voice::Voice;
use crate::mission::{LegsAhead, way_ahead};
use crate::mode::Mode;
use crate::ownship::{OwnState, OwnshipEstimate};
use crate::parameters::VehicleParameters;

/// Length of the line in CRUISE, metres.
const CRUISE_AHEAD_M: f64 = 50_000.0;
/// In CRUISE a new line begins when the aircraft is off the old one by this, m and rad.
const CRUISE_OFF_M: f64 = 12.0;
const CRUISE_OFF_RAD: f64 = 0.05;
/// Back on the leg: this close, this well aligned. A way back from far ends up to 16 m beside the leg; the vehicle flies these
/// last metres by itself.
const ON_LEG_M: f64 = 18.0;
const ON_LEG_RAD: f64 = 0.06;
const ON_LEG_HEIGHT_M: f64 = 12.0;
/// How far ahead the check of the restored course looks, and its steps, seconds.
const GIVEN_BACK_S: f64 = 30.0;
const GIVEN_BACK_STEP_S: f64 = 0.2;

/// The aircraft when its way is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct RouteMoment {
    /// Where it is, metres, and its course over the ground, radians.
    pub(super) own_m: Vec3,
    pub(super) track_rad: f64,
    /// The mode that the way belongs to: in a manoeuvre, and after one while its debt is left, the one from before.
    pub(super) mode: Mode,
    /// Whether the companion flies it with a plan.
    pub(super) is_engaged: bool,
    /// Whether the plan is not to cruise.
    pub(super) is_busy: bool,
}

/// The way, and the leg of it that is flown.
#[derive(Debug, Default)]
pub(super) struct LaidRoute {
    way: LegsAhead,
    /// Index of the waypoint at the start of the present leg.
    leg: usize,
    mode: Option<Mode>,
    /// The vehicle's mission item when the way was laid.
    item: Option<u16>,
    /// The number of the mission behind the way; `None` if it leads to the vehicle's own target.
    mission: Option<u32>,
}

impl LaidRoute {
    #[cfg(test)]
    pub(super) fn of(way: LegsAhead, leg: usize) -> Self {
        Self {
            way,
            leg,
            ..Self::default()
        }
    }

    pub(super) const fn way(&self) -> &LegsAhead {
        &self.way
    }

    pub(super) fn waypoints_m(&self) -> &[Vec3] {
        &self.way.waypoints_m
    }

    /// Index of the waypoint at the start of the present leg.
    pub(super) const fn leg(&self) -> usize {
        self.leg
    }

    /// The mode that the way belongs to.
    pub(super) const fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// Whether the way is a mission's.
    pub(super) fn is_mission(&self) -> bool {
        self.mode == Some(Mode::AUTO) && self.mission.is_some()
    }

    /// Another leg is flown.
    pub(super) const fn fly_leg(&mut self, leg: usize) {
        self.leg = leg;
    }

    /// The local frame has moved.
    pub(super) const fn forget(&mut self) {
        self.mode = None;
    }

    /// Lays the way that the vehicle would fly by itself. While the companion flies, a way that is laid changes for another mission alone.
    /// Whether another way counts from here on.
    pub(super) fn renew(
        &mut self,
        at: &RouteMoment,
        lists: &Lists,
        ownship: &OwnshipEstimate,
        parameters: &VehicleParameters,
        voice: &mut Voice,
    ) -> bool {
        let now_s = voice.now_s();
        let is_laid = self.mode == Some(at.mode);
        let rally = ReturnPlaces {
            items: lists.rally(),
            own_m: at.own_m,
            frame: ownship.frame(),
        };
        let home_m = lists.home_m(ownship, at.own_m.z);
        let return_place_m = || rally.return_place_m(home_m, parameters);
        let lays = match at.mode {
            Mode::RTL if at.is_engaged && is_laid => {
                let laid_m = self.way.waypoints_m.last().copied();
                let other_m = rally.other_return_place_m(return_place_m(), laid_m);
                other_m.is_some() && self.lay_line(at.own_m, other_m)
            }
            Mode::AUTO => self.renew_mission_way(at, lists, ownship, now_s),
            _ if at.is_engaged => false,
            Mode::RTL => {
                // Home, or a rally point: the vehicle's own target is better than the list.
                let reported_m = lists
                    .own_target_m(now_s)
                    .map(|to_m| to_m.with_z(at.own_m.z));
                let moved = reported_m.is_some_and(|to_m| !self.leads_to(to_m));
                (!is_laid || moved && !at.is_busy)
                    && self.lay_line(at.own_m, reported_m.or_else(return_place_m))
            }
            _ => {
                let (sin, cos) = libm::sincos(at.track_rad);
                let to_m = at.own_m + Vec3::new(cos, sin, 0.0) * CRUISE_AHEAD_M;
                !(at.is_busy || is_laid && self.leads_along(at))
                    && self.lay_line(at.own_m, Some(to_m))
            }
        };
        if lays {
            self.mode = Some(at.mode);
            self.item = lists.item();
            self.leg = 0;
            let waypoints_m: Vec<[f64; 3]> =
                self.way.waypoints_m.iter().map(Vec3::to_array).collect();
            voice.note(
                "way",
                json!({ "mode": at.mode.name(), "item": self.item, "waypoints_m": waypoints_m }),
            );
        }
        lays
    }

    /// Lays a way to one place, or none; always `true`.
    fn lay_line(&mut self, own_m: Vec3, to_m: Option<Vec3>) -> bool {
        self.way = LegsAhead {
            waypoints_m: to_m.map_or_else(Vec::new, |to_m| vec![own_m, to_m]),
            items: vec![None, None],
            ..LegsAhead::default()
        };
        true
    }

    /// Whether the way ends at a place.
    fn leads_to(&self, to_m: Vec3) -> bool {
        let laid_m = self.way.waypoints_m.last();
        laid_m.is_some_and(|laid_m| (to_m - laid_m).truncate().length() <= SAME_TARGET_M)
    }

    /// Whether the line of CRUISE still leads where the aircraft flies.
    fn leads_along(&self, at: &RouteMoment) -> bool {
        let mut waypoints_m = self.way.waypoints_m.iter();
        let Some(from_m) = waypoints_m.next() else {
            return false;
        };
        let ahead_m = waypoints_m.next().map_or(Vec3::X, |to_m| *to_m - *from_m);
        let along = ahead_m.normalize_or_zero();
        let across_m = (at.own_m - *from_m).cross(along).length();
        across_m <= CRUISE_OFF_M
            && wrap_pi(course_of(ahead_m) - at.track_rad).abs() <= CRUISE_OFF_RAD
    }

    /// Lays the way along the mission, or to the vehicle's own target while the mission is in doubt;
    /// `false` if it stays the same.
    fn renew_mission_way(
        &mut self,
        at: &RouteMoment,
        lists: &Lists,
        ownship: &OwnshipEstimate,
        now_s: f64,
    ) -> bool {
        let is_laid = self.mode == Some(Mode::AUTO);
        let in_doubt = lists.is_in_doubt(ownship, now_s);
        let target_m = lists.own_target_m(now_s).filter(|_| !at.is_engaged);
        if in_doubt && let Some(target_m) = target_m {
            let to_m = target_m.with_z(at.own_m.z);
            if is_laid && self.mission.is_none() && self.leads_to(to_m) {
                return false;
            }
            self.way = LegsAhead {
                waypoints_m: vec![at.own_m, to_m],
                items: vec![None, lists.item()],
                ..LegsAhead::default()
            };
            self.mission = None;
            return true;
        }
        let same_mission = self.mission == Some(lists.mission_number());
        // The decider and the vehicle pass a waypoint at slightly different moments.
        let same_item = self.item == lists.item() || self.leg_item() == lists.item();
        let is_ahead = || lists.item().is_some() && self.way.items.contains(&lists.item());
        let goes_on = same_item || at.is_engaged || (at.is_busy && is_ahead());
        // While the companion reads the new way, it keeps the old one.
        if is_laid && ((same_mission && goes_on) || (at.is_engaged && in_doubt)) {
            return false;
        }
        let Some(way) = lists
            .item()
            .and_then(|item| way_to(item, at.own_m, lists, ownship))
        else {
            return false;
        };
        self.way = way;
        self.mission = Some(lists.mission_number());
        true
    }

    /// The mission item at the end of the present leg.
    fn leg_item(&self) -> Option<u16> {
        let last = self.way.items.len().saturating_sub(1);
        let end = (self.leg + 1).min(last);
        self.way.items.get(end).copied().flatten()
    }

    /// The rest of the way: the point of the present leg nearest to the aircraft, and the waypoints after it.
    pub(super) fn left_m(&self, own_m: Vec3) -> (Vec3, &[Vec3]) {
        let from = self.way.waypoints_m.get(self.leg..);
        let Some((from_m, left_m)) = from.and_then(<[Vec3]>::split_first) else {
            return (own_m, &[]);
        };
        let along_m = left_m.first().map_or(Vec3::ZERO, |to_m| *to_m - *from_m);
        let share = (own_m - *from_m).dot(along_m) / along_m.length_squared().max(1.0);
        (*from_m + along_m * share.clamp(0.0, 1.0), left_m)
    }

    /// Begin and end of the present leg.
    fn leg_m(&self) -> Option<(Vec3, Vec3)> {
        let begin_m = self.way.waypoints_m.get(self.leg).copied();
        begin_m.zip(self.way.waypoints_m.get(self.leg + 1).copied())
    }

    /// Whether a command leads along the leg in this wind: the last turn of the way back, or the leg itself.
    pub(super) fn turns_onto_leg(&self, command: &Maneuver, state: &OwnState) -> bool {
        let leg_and_stage = self.leg_m().zip(command.stage_at(0.0));
        leg_and_stage.is_some_and(|((from, to), stage)| {
            let turned = Ownship {
                course_rad: stage.course_rad,
                ..state.ownship
            };
            let track_rad = course_of(turned.velocity_mps() + state.wind_mps);
            wrap_pi(track_rad - course_of(to - from)).abs() < ON_LEG_RAD
        })
    }

    /// Distance from the line of the present leg, metres; `None` without a leg.
    pub(super) fn beside_leg_m(&self, state: &OwnState) -> Option<f64> {
        let (from, to) = self.leg_m()?;
        let level = (to - from).with_z(0.0).normalize_or_zero();
        let offset = state.ownship.position_m - from;
        Some((offset.x * level.y - offset.y * level.x).abs())
    }

    /// Whether the aircraft is on the present leg; its height counts where it `climbs`.
    pub(super) fn is_on_leg(&self, state: &OwnState, climbs: bool) -> bool {
        let Some(((from, to), across_m)) = self.leg_m().zip(self.beside_leg_m(state)) else {
            return true;
        };
        let ahead = to - from;
        let level = ahead.with_z(0.0).normalize_or_zero();
        let offset = state.ownship.position_m - from;
        let along = (offset.x * level.x + offset.y * level.y).max(0.0);
        let length_m = libm::hypot(ahead.x, ahead.y).max(1.0);
        let height_m = from.z + ahead.z * (along / length_m).min(1.0);
        let angle_rad = wrap_pi(course_of(state.ground_velocity_mps) - course_of(level));
        across_m < ON_LEG_M
            && angle_rad.abs() < ON_LEG_RAD
            && (!climbs || (state.ownship.position_m.z - height_m).abs() < ON_LEG_HEIGHT_M)
    }

    /// Whether the vehicle, with its mode restored now, is known to come nearer to a volume than `clear_m`: it turns to
    /// its next waypoint, at `rate_radps`, and flies there.
    pub(super) fn given_back_collides(
        &self,
        state: &OwnState,
        rate_radps: f64,
        obstacles: &[Obstacle],
        clear_m: f64,
    ) -> bool {
        let to_m = self.way.waypoints_m.get(self.leg + 1).copied();
        let (mut at_m, mut course_rad) = (state.ownship.position_m, state.ownship.course_rad);
        let mut after_s = 0.0;
        while after_s < GIVEN_BACK_S {
            // Fences, floor and ceiling are the mission's own business.
            let mut beings = obstacles
                .iter()
                .filter(|obstacle| obstacle.kind != ObstacleKind::NaturalBarrier);
            let enters = beings.any(|obstacle| {
                let offset_m = at_m - obstacle.position_after_m(after_s);
                obstacle.volume.margin_m(offset_m) < clear_m
            });
            if enters {
                return true;
            }
            if let Some(to_m) = to_m {
                let ahead = to_m - at_m;
                let error_rad = wrap_pi(libm::atan2(ahead.y, ahead.x) - course_rad);
                let most_rad = rate_radps * GIVEN_BACK_STEP_S;
                course_rad += error_rad.clamp(-most_rad, most_rad);
            }
            let air_mps = Vec3::new(libm::cos(course_rad), libm::sin(course_rad), 0.0)
                * state.ownship.airspeed_mps;
            at_m += (air_mps + state.wind_mps) * GIVEN_BACK_STEP_S;
            after_s += GIVEN_BACK_STEP_S;
        }
        false
    }
}

/// The way along the mission from an item on; `None` until the mission and the aircraft's place are known.
pub(super) fn way_to(
    item: u16,
    own_m: Vec3,
    lists: &Lists,
    ownship: &OwnshipEstimate,
) -> Option<LegsAhead> {
    let home_m = ownship.home_altitude_m()?;
    Some(way_ahead(
        lists.mission()?,
        item,
        own_m,
        ownship.frame()?,
        home_m,
    ))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_6;

    use fga::situation::ProtectedVolume;

    use super::*;

    fn corner() -> LaidRoute {
        let way = LegsAhead {
            waypoints_m: vec![Vec3::ZERO, Vec3::X * 1e3, Vec3::new(1e3, 1e3, 0.0)],
            items: vec![Some(1), Some(2), Some(3)],
            ..LegsAhead::default()
        };
        LaidRoute::of(way, 0)
    }

    fn flies(at_m: Vec3, course_rad: f64) -> OwnState {
        OwnState {
            ownship: Ownship {
                position_m: at_m,
                course_rad,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: 20.0,
            },
            ground_velocity_mps: Vec3::new(course_rad.cos(), course_rad.sin(), 0.0) * 20.0,
            wind_mps: Vec3::ZERO,
            above_home_m: 100.0,
            pitch_rad: 0.0,
            course_rate_radps: 0.0,
        }
    }

    #[test]
    fn on_the_leg_is_near_it_along_it_and_at_its_height_where_it_climbs() {
        let mut route = corner();
        let at = |y, z| Vec3::new(500.0, y, z);
        assert!(route.is_on_leg(&flies(at(17.0, 0.0), 0.05), true));
        assert!(!route.is_on_leg(&flies(at(19.0, 0.0), 0.0), true));
        assert!(!route.is_on_leg(&flies(at(0.0, 0.0), 0.07), true));
        assert!(!route.is_on_leg(&flies(at(0.0, 13.0), 0.0), true));
        assert!(route.is_on_leg(&flies(at(0.0, 13.0), 0.0), false));
        let turn = |course_rad| Maneuver::turn(0.0, course_rad, 0.0);
        assert!(route.turns_onto_leg(&turn(0.05), &flies(at(0.0, 0.0), 0.0)));
        // 10 m/s from the left: 30° into the wind lead along the leg.
        let mut crabs = flies(at(0.0, 0.0), 0.0);
        crabs.wind_mps = Vec3::NEG_Y * 10.0;
        assert!(route.turns_onto_leg(&turn(FRAC_PI_6), &crabs));
        assert!(!route.turns_onto_leg(&turn(0.0), &crabs));
        assert_eq!(
            route.left_m(at(40.0, 0.0)),
            (at(0.0, 0.0), &route.way.waypoints_m[1..])
        );
        // The next leg leads north.
        route.fly_leg(1);
        assert!(!route.is_on_leg(&flies(at(0.0, 0.0), 0.0), true));
        assert!(!route.turns_onto_leg(&turn(0.05), &flies(at(0.0, 0.0), 0.0)));
        assert_eq!(route.leg_item(), Some(3));
    }

    #[test]
    fn in_cruise_a_line_holds_until_the_aircraft_leaves_it_and_no_plan_is_busy() {
        let (mut route, mut voice) = (LaidRoute::default(), Voice::default());
        let (lists, ownship) = (Lists::new(false, false), OwnshipEstimate::default());
        let parameters = VehicleParameters::default();
        let mut renews = |y, track_rad, is_busy| {
            let moment = RouteMoment {
                own_m: Vec3::new(100.0, y, 0.0),
                track_rad,
                mode: Mode::CRUISE,
                is_engaged: false,
                is_busy,
            };
            route.renew(&moment, &lists, &ownship, &parameters, voice.at(0.0))
        };
        assert!(renews(0.0, 0.0, false));
        assert!(!renews(11.0, 0.04, false));
        assert!(!renews(13.0, 0.0, true));
        assert!(renews(13.0, 0.0, false));
        assert!(renews(13.0, 0.06, false));
    }

    #[test]
    fn given_back_it_turns_to_its_waypoint_and_meets_what_stands_there() {
        let route = corner();
        let north = flies(Vec3::ZERO, core::f64::consts::FRAC_PI_2);
        let collides = |x, y, clear_m| {
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let stands = Obstacle::straight(1, Vec3::new(x, y, 0.0), Vec3::ZERO, volume);
            route.given_back_collides(&north, 0.3, &[stands], clear_m)
        };

        // Half a kilometre east, on the leg; and as far north, where it flies now.
        assert!(collides(500.0, 60.0, 0.0));
        assert!(!collides(500.0, 300.0, 0.0));
        assert!(!collides(0.0, 300.0, 0.0));
        assert!(collides(0.0, 300.0, 250.0));
        // Farther than it flies in 30 s.
        assert!(!collides(900.0, 60.0, 0.0));
    }
}

//! The pilot that all methods share: guidance, limits, states, records.

use crate::mission_pilot::MissionPilot;
use fga::Vec3;
use fga::angle::{climb_of, course_of, direction, wrap_pi};
use fga::avoider::{Decision, Reason, Settings, SettingsError, State, Threat};
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Obstacle;
use fga::situation::Situation;
use fga::vehicle::Vehicle;

use super::view::{RelativeRoute, Sphere, View, flattened};
use crate::policy_pilot::PolicyPilot;
use crate::wind::crab;
use crate::world::{BACK_WITHIN_M, BACK_WITHIN_RAD};

/// A smaller change of direction is none, radians (a tenth of a degree).
const SAME_DIRECTION_RAD: f64 = 1.745e-3;

/// Two heights this close are the same, metres.
const SAME_HEIGHT_M: f64 = 1.0;

/// The wish points at the route this far ahead, seconds of flight.
const WISH_AHEAD_S: f64 = 10.0;

/// A method: the velocity that it would like to fly, or `None` where the aircraft may fly the mission.
pub trait Steering {
    /// Forgets the last flight.
    fn restart(&mut self) {}

    /// Decides; only the direction of the velocity through the air counts.
    fn steer(&mut self, view: &View<'_>) -> Option<Vec3>;

    /// Where everything happens at one height, a method that works with normals and displacements
    /// sees no way up: the pilot shows it an obstacle at the aircraft's height this many protected
    /// radii lower, if the vehicle can climb.
    fn lowered(&self) -> f64 {
        0.0
    }
}

/// Flies a method under the vehicle's limits, and the mission where the method sees no danger.
#[derive(Debug)]
pub struct BaselinePilot<S> {
    method: S,
    settings: Settings,
    /// The core's own guidance along the mission.
    guide: MissionPilot,
    state: State,
    spheres: Vec<Sphere>,
}

impl<S: Steering> BaselinePilot<S> {
    /// A pilot on its mission.
    ///
    /// # Errors
    /// Settings or limits that the core's guidance refuses.
    pub fn new(method: S, settings: &Settings, vehicle: Vehicle) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            method,
            settings: *settings,
            guide: MissionPilot::new(settings.horizon_s, vehicle)?,
            state: State::Cruise,
            spheres: Vec::new(),
        })
    }

    /// Fills the list of spheres within the surveillance radius.
    fn look(&mut self, situation: &Situation<'_>) {
        self.spheres.clear();
        let own_m = situation.ownship.position_m;
        let valid = situation.obstacles.iter().filter(Obstacle::is_valid);
        for obstacle in valid {
            let mut offset_m = obstacle.position_m - own_m;
            if offset_m.length() > self.settings.surveillance_radius_m {
                continue;
            }
            if offset_m.z.abs() < SAME_HEIGHT_M && self.guide.vehicle().can_climb() {
                offset_m.z = -self.method.lowered() * obstacle.volume.bounding_radius_m();
            }
            let spread = self.settings.confidence_sigmas * obstacle.uncertainty.position_m;
            self.spheres.push(Sphere {
                id: obstacle.id,
                offset_m,
                velocity_mps: obstacle.velocity_mps - situation.wind_mps,
                radius_m: obstacle.volume.bounding_radius_m() + self.settings.margin_m + spread,
            });
        }
        if !self.guide.vehicle().can_climb() {
            self.spheres = flattened(&self.spheres).collect();
        }
    }

    /// The velocity through the air towards the route ahead; `None` where the wind is too strong.
    fn wish(&self, route: &RelativeRoute, wind_mps: Vec3) -> Option<Vec3> {
        let airspeed_mps = self.guide.vehicle().airspeed_mps;
        let ahead_m = airspeed_mps * WISH_AHEAD_S;
        let aim = (route.foot_m + route.along * ahead_m).normalize_or_zero();
        let (course_rad, climb_rad) = crab(aim, airspeed_mps, wind_mps)?;
        let (least, most) = (
            self.guide.vehicle().climb_min_rad,
            self.guide.vehicle().climb_max_rad,
        );
        Some(direction(course_rad, climb_rad.clamp(least, most)) * airspeed_mps)
    }

    /// Whether the guidance's straight way back to the route meets an obstacle.
    fn is_blocked(&self, route: &RelativeRoute, guided_mps: Vec3) -> bool {
        /// The guidance comes back at 45°, after a turn of a few seconds.
        const TURN_S: f64 = 3.0;
        let back_s =
            core::f64::consts::SQRT_2 * route.foot_m.length() / guided_mps.length() + TURN_S;
        self.spheres.iter().any(|sphere| {
            sphere
                .entry_s(guided_mps)
                .is_some_and(|entry_s| entry_s <= back_s)
        })
    }

    /// Turns the shorter way into a direction, as steeply as necessary and possible.
    fn turn_to(&self, velocity: Vec3, course_rad: f64) -> Maneuver {
        // A vertical velocity has no course.
        let level = Vec3::new(velocity.x, velocity.y, 0.0).length();
        let turn_rad = if level > 1e-6 * velocity.length() {
            wrap_pi(course_of(velocity) - course_rad)
        } else {
            0.0
        };
        let climb_rad = climb_of(velocity).clamp(
            self.guide.vehicle().climb_min_rad,
            self.guide.vehicle().climb_max_rad,
        );
        Maneuver::turn(0.0, course_rad + turn_rad, climb_rad)
    }

    /// The most urgent obstacle for an aircraft that flies `velocity_mps`.
    fn threat(&self, velocity_mps: Vec3) -> Option<Threat> {
        self.spheres
            .iter()
            .filter_map(|sphere| {
                let entry_s = sphere.entry_s(velocity_mps)?;
                let (closest_s, offset) = sphere.closest(velocity_mps);
                Some(Threat {
                    id: sphere.id,
                    entry_s,
                    closest_s: closest_s.max(0.0),
                    margin_m: offset.length() - sphere.radius_m,
                })
            })
            .min_by(|a, b| a.entry_s.total_cmp(&b.entry_s))
    }
}

/// Why a policy avoids in a step, and the state after it.
pub(crate) fn avoiding(state: &mut State) -> Reason {
    match core::mem::replace(state, State::Avoiding) {
        State::Avoiding => Reason::ManeuverKept,
        _ => Reason::ManeuverChosen,
    }
}

/// The state after a step in which a policy left the mission alone, and why.
pub(crate) fn returning(
    before: State,
    situation: &Situation<'_>,
    route: &RelativeRoute,
    reason: Reason,
) -> (State, Reason) {
    if before == State::Cruise {
        return (before, reason);
    }
    let ground_mps = situation.ownship.velocity_mps() + situation.wind_mps;
    let on_route = route.foot_m.length() <= BACK_WITHIN_M
        && ground_mps.angle_between(route.along) <= BACK_WITHIN_RAD;
    let state = if on_route || reason == Reason::MissionComplete {
        State::Cruise
    } else {
        State::Recovering
    };
    let reason = match (reason, before, state) {
        (Reason::Clear, _, State::Cruise) => Reason::Rejoined,
        (Reason::Clear, State::Avoiding, _) => Reason::RejoinChosen,
        (Reason::Clear, _, _) => Reason::RejoinKept,
        (reason, _, _) => reason,
    };
    (state, reason)
}

impl<S: Steering> PolicyPilot for BaselinePilot<S> {}

impl<S: Steering> Pilot for BaselinePilot<S> {
    fn restart(&mut self) {
        self.method.restart();
        self.guide.restart();
        self.state = State::Cruise;
    }

    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        let mut decision = self.guide.step(situation);
        if decision.record.reason == Reason::InvalidInput {
            return decision;
        }
        self.look(situation);
        let own = situation.ownship;
        let guided_mps = decision
            .command
            .stage_at(0.0)
            .map_or(own.velocity_mps(), |stage| {
                direction(stage.course_rad, stage.climb_rad) * self.guide.vehicle().airspeed_mps
            });
        let route = RelativeRoute::of(situation, self.guide.leg_index());
        let preferred_mps = self.wish(&route, situation.wind_mps).unwrap_or(guided_mps);
        let view = View {
            velocity_mps: own.velocity_mps(),
            preferred_mps,
            route,
            spheres: &self.spheres,
            vehicle: self.guide.vehicle(),
            period_s: self.settings.decision_period_s,
        };
        let chosen = self
            .method
            .steer(&view)
            .filter(|velocity| velocity.is_finite() && velocity.length() > 1e-6)
            .filter(|velocity| velocity.angle_between(preferred_mps) > SAME_DIRECTION_RAD);
        if let Some(velocity) = chosen {
            decision.command = self.turn_to(velocity, own.course_rad).into();
            decision.record.reason = avoiding(&mut self.state);
        } else {
            let reason = decision.record.reason;
            (self.state, decision.record.reason) = returning(self.state, situation, &route, reason);
            if self.state == State::Recovering && self.is_blocked(&route, guided_mps) {
                decision.command = self.turn_to(preferred_mps, own.course_rad).into();
            }
        }
        decision.state = self.state;
        decision.record.threat = self.threat(preferred_mps);
        decision.record.work.tracked = u32::try_from(self.spheres.len()).unwrap_or(u32::MAX);
        decision.record.work.threats = u32::from(decision.record.threat.is_some());
        decision
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.guide.retune(vehicle);
    }
}

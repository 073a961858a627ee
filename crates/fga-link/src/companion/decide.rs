//! From telemetry and tracks to a decision, and from the decision to who flies.

use fga::Vec3;
use fga::algorithm4::Phase;
use fga::angle::{course_of, wrap_pi};
use fga::avoider::{
    Avoider, Decision, Mission, Obstacles, Policy, Reason, Record, Settings, Situation, Start,
    State as AvoiderState, Threat,
};
use fga::maneuver::Maneuver;
use fga::situation::{Obstacle, ObstacleKind, ProtectedVolume};
use fga_formats::geodesy::Geodetic;
use mavlink::dialects::ardupilotmega::MavCmd;
use serde_json::json;

use super::{Companion, Decided};
use crate::authority::{Authority, Fault, Severity};
use crate::commands::Command;
use crate::config::{CommandMode, Config, VirtualObstacle};
use crate::mission::{Way, item_position_m, way_ahead};
use crate::mode::Mode;
use crate::number::single;
use crate::ownship::State;
use crate::telling;
use crate::traffic::fence::{CEILING_ID, FLOOR_ID, layer};
use crate::traffic::report::Quality;
use crate::traffic::{Report, Source};

/// Identifier of the first virtual obstacle.
pub(super) const FIRST_VIRTUAL_ID: usize = 1_000;
/// Tracks that one decision takes into account.
const MOST_TRACKS: usize = 64;
/// Length of the line that is flown on in CRUISE, metres.
const CRUISE_AHEAD_M: f64 = 50_000.0;
/// In CRUISE the line is laid anew when the aircraft is off it by this, metres and radians.
const CRUISE_OFF_M: f64 = 12.0;
const CRUISE_OFF_RAD: f64 = 0.05;
/// Back on the leg: this close, this well aligned, for so long.
const ON_LEG_M: f64 = 12.0;
const ON_LEG_RAD: f64 = 0.06;
const ON_LEG_HEIGHT_M: f64 = 12.0;
const ON_LEG_FOR_S: f64 = 0.4;
/// A manoeuvre that begins within this is prepared for by taking over, seconds.
const PREPARE_S: f64 = 0.6;
/// A difference of airspeed or response that makes new limits worth while, as a share.
const LIMITS_CHANGE: f64 = 0.02;
/// After so many refusals in a row the operator has to arm it again.
const MOST_REFUSALS: u32 = 3;

/// The configuration's obstacles: a report each, the volume, and when they were at that place.
pub(super) fn virtual_reports(config: &Config) -> Vec<(Report, ProtectedVolume, f64)> {
    config.obstacle.iter().filter_map(virtual_report).collect()
}

fn virtual_report(obstacle: &VirtualObstacle) -> Option<(Report, ProtectedVolume, f64)> {
    let place = Geodetic::new(
        obstacle.latitude_deg,
        obstacle.longitude_deg,
        obstacle.altitude_m,
    )?;
    let track_rad = obstacle.track_deg.to_radians();
    let velocity = Vec3::new(
        obstacle.speed_mps * libm::sin(track_rad),
        obstacle.speed_mps * libm::cos(track_rad),
        obstacle.climb_mps,
    );
    let volume = match obstacle.half_height_m {
        Some(half_height_m) => ProtectedVolume::Cylinder {
            radius_m: obstacle.radius_m,
            half_height_m,
        },
        None => ProtectedVolume::Sphere {
            radius_m: obstacle.radius_m,
        },
    };
    let report = Report {
        source: Source::Virtual,
        icao: 0,
        callsign: obstacle.name.clone(),
        place,
        velocity_mps: Some(velocity),
        valid_s: 0.0,
        quality: Quality {
            position_m: 0.0,
            geometric_altitude: true,
        },
    };
    Some((report, volume, 0.0))
}

impl Companion {
    /// The state at the moment at which a command sent now takes effect.
    pub(super) fn state_ahead(&mut self, now_s: f64) -> Option<State> {
        let response = self.response.response();
        let commanded = self
            .keeper
            .commands()
            .then_some((self.commanded.bank_rad, response.bank_time_constant_s));
        self.ownship.state_at(
            now_s + response.dead_time_s,
            commanded,
            response.turn_rate_factor,
        )
    }

    pub(super) fn decide(&mut self, now_s: f64) {
        self.due.decision_s = now_s + self.config.command.decision_period_s;
        let stale_s = self.config.safety.telemetry_stale_s;
        let fresh = self
            .ownship
            .age_s(now_s)
            .is_some_and(|age_s| age_s <= stale_s);
        let state = if fresh { self.state_ahead(now_s) } else { None };
        let ready = self.is_ready(now_s, state.as_ref());
        let before = self.keeper.state();
        let actions = self.keeper.readiness(ready, now_s);
        self.perform(&actions, now_s);
        if before == Authority::Waiting && self.keeper.state() == Authority::Ready {
            self.forget_plan();
        }
        let Some(state) = state else { return };
        self.lay_fence(now_s);
        if self.keeper.is_engaged() && state.above_home_m < self.config.safety.floor_m - 10.0 {
            self.fault(Fault::BelowFloor, now_s);
        }
        if !self.keeper.commands() {
            self.pitch.observe(state.pitch_rad, state.ownship.climb_rad);
        }
        let Some(decision) = self.decision_for(&state, now_s) else {
            return;
        };
        self.counts.decisions += 1;
        let ahead_s = self.response.response().dead_time_s;
        self.decided = Some(Decided {
            decision,
            for_s: now_s + ahead_s,
            own: state,
        });
        self.log_decision(now_s);
        self.send_collision(now_s);
        self.act_on(&decision, &state, now_s);
    }

    /// Whether all holds that must hold to take over.
    fn is_ready(&self, now_s: f64, state: Option<&State>) -> bool {
        let (Some(heard), Some(state)) = (self.heard, state) else {
            return false;
        };
        let floor_m = self.config.safety.floor_m;
        // A little above the floor to begin with, so that it is not crossed at once.
        let high_enough = state.above_home_m >= floor_m + 5.0
            || (self.keeper.is_engaged() && state.above_home_m >= floor_m - 10.0);
        let mode_fits = self.keeper.is_engaged() || self.take_over.contains(&heard.mode);
        let mission_known = heard.mode != Mode::AUTO
            || (self.mission.items().is_some() && self.mission_item.is_some());
        heard.armed
            && now_s - heard.heartbeat_s <= self.config.safety.link_lost_s
            && high_enough
            && mode_fits
            && mission_known
            && self.parameters.is_sufficient()
    }

    fn decision_for(&mut self, state: &State, now_s: f64) -> Option<Decision> {
        self.renew_way(state, now_s);
        self.renew_avoider(now_s)?;
        self.gather_obstacles(state, now_s);
        if self.config.command.mode == CommandMode::Paper {
            return self.paper_decision(state, now_s);
        }
        let situation = Situation {
            time_s: now_s + self.response.response().dead_time_s,
            ownship: state.ownship,
            obstacles: Obstacles::Rows(&self.obstacles),
            mission: Mission {
                waypoints_m: &self.way.waypoints_m,
            },
            wind_mps: state.wind_mps,
        };
        Some(self.avoider.as_mut()?.step(&situation))
    }

    fn paper_decision(&mut self, state: &State, now_s: f64) -> Option<Decision> {
        let limit_rad = self.parameters.bank_limit_rad(&self.config)?;
        let full_rad = self.parameters.get("ROLL_LIMIT_DEG")?.to_radians();
        let response = self.response.response();
        let sticks = self.paper.step(
            now_s + response.dead_time_s,
            &state.ownship,
            &self.obstacles,
            self.config.protection.margin_m,
            &response,
            (limit_rad, full_rad),
        );
        let threat = self.paper.obstacle().map(|obstacle| {
            let offset = obstacle.position_m - state.ownship.position_m;
            let margin_m = obstacle.volume.margin_m(offset);
            let entry_s = margin_m / state.ownship.airspeed_mps;
            Threat {
                id: obstacle.id,
                entry_s,
                closest_s: entry_s,
                margin_m,
            }
        });
        let (avoider_state, reason) = match sticks.map(|sticks| sticks.phase) {
            None | Some(Phase::Done) => (AvoiderState::Cruise, Reason::Clear),
            Some(Phase::Waiting) => (AvoiderState::Threatened, Reason::WaitingForStart),
            Some(Phase::TurningBack) => (AvoiderState::Recovering, Reason::RejoinKept),
            Some(_) => (AvoiderState::Avoiding, Reason::ManeuverKept),
        };
        self.paper_roll_us = sticks.map_or(1500, |sticks| sticks.roll_us);
        self.commanded.bank_rad = sticks.map_or(0.0, |sticks| sticks.bank_rad);
        let record = Record {
            reason,
            threat,
            ..Record::default()
        };
        Some(Decision {
            state: avoider_state,
            command: Maneuver::hold(),
            record,
        })
    }

    /// The way ahead as the vehicle would fly it by itself; not touched while the companion flies.
    fn renew_way(&mut self, state: &State, now_s: f64) {
        let Some(heard) = self.heard else { return };
        if self.keeper.is_engaged() && self.avoider.is_some() {
            return;
        }
        let own_m = state.ownship.position_m;
        let track_rad = course_of(state.ground_velocity_mps);
        let busy = self
            .avoider
            .as_ref()
            .is_some_and(|a| a.state() != AvoiderState::Cruise);
        match heard.mode {
            Mode::AUTO => {
                let same_item = self.way_mode == Some(Mode::AUTO)
                    && self.current_leg_item() == self.mission_item;
                if same_item || (busy && self.way_mode == Some(Mode::AUTO) && self.item_is_ahead())
                {
                    return;
                }
                let (Some(items), Some(item), Some(frame), Some(home_m)) = (
                    self.mission.items(),
                    self.mission_item,
                    self.ownship.frame(),
                    self.ownship.home_altitude_m(),
                ) else {
                    return;
                };
                self.way = way_ahead(items, item, own_m, frame, home_m);
            }
            Mode::RTL => {
                if self.way_mode == Some(Mode::RTL) {
                    return;
                }
                let home = self.home_m(own_m);
                self.way = Way {
                    waypoints_m: home.map_or_else(Vec::new, |home_m| vec![own_m, home_m]),
                    items: vec![None, None],
                };
            }
            mode => {
                let off = self.way.waypoints_m.first().is_none_or(|from| {
                    let ahead = self
                        .way
                        .waypoints_m
                        .get(1)
                        .map_or(Vec3::X, |to| *to - *from);
                    let along = ahead.normalize_or_zero();
                    let across = (own_m - *from).cross(along).length();
                    across > CRUISE_OFF_M
                        || wrap_pi(course_of(ahead) - track_rad).abs() > CRUISE_OFF_RAD
                });
                if busy || (self.way_mode == Some(mode) && !off) {
                    return;
                }
                let ahead = Vec3::new(libm::cos(track_rad), libm::sin(track_rad), 0.0);
                self.way = Way {
                    waypoints_m: vec![own_m, own_m + ahead * CRUISE_AHEAD_M],
                    items: vec![None, None],
                };
            }
        }
        self.way_mode = Some(heard.mode);
        self.avoider = None;
        self.note(
            now_s,
            "way",
            json!({
                "mode": heard.mode.name(),
                "item": self.mission_item,
                "waypoints_m": self.way.waypoints_m.iter().map(|w| [w.x, w.y, w.z]).collect::<Vec<_>>(),
            }),
        );
    }

    fn home_m(&self, own_m: Vec3) -> Option<Vec3> {
        let item = self.mission.items()?.first()?.as_ref()?;
        let frame = self.ownship.frame()?;
        let mut home_m = item_position_m(item, frame, self.ownship.home_altitude_m()?, own_m.z)?;
        home_m.z = own_m.z;
        Some(home_m)
    }

    /// The mission item at the end of the leg that the avoider is on.
    fn current_leg_item(&self) -> Option<u16> {
        let leg = self
            .avoider
            .as_ref()
            .map_or(0, |avoider| avoider.leg_index());
        let last = self.way.items.len().saturating_sub(1);
        self.way.items.get((leg + 1).min(last)).copied().flatten()
    }

    /// Whether the vehicle's item is one of the way's.
    fn item_is_ahead(&self) -> bool {
        self.mission_item.is_some() && self.way.items.contains(&self.mission_item)
    }

    fn renew_avoider(&mut self, now_s: f64) -> Option<()> {
        let mut response = self.response.response();
        // The dead time is spent before the state that the avoider is given; the rest is planned.
        response.dead_time_s = 0.0;
        if self.config.command.mode == CommandMode::Heading {
            // Heading commands are followed with a slow tail.
            response.bank_time_constant_s += 0.6;
        }
        let cruise_mps = self.parameters.get("AIRSPEED_CRUISE");
        let airspeed_mps = self
            .ownship
            .airspeed_mps()
            .filter(|v| *v > 5.0)
            .or(cruise_mps)?;
        let wanted = self
            .parameters
            .vehicle(&self.config, airspeed_mps, response)?;
        if let Some(avoider) = &mut self.avoider {
            let known = *avoider.vehicle();
            let off = |a: f64, b: f64| (a - b).abs() > LIMITS_CHANGE * b.abs();
            let changed = off(wanted.airspeed_mps, known.airspeed_mps)
                || off(wanted.course_rate_radps(), known.course_rate_radps())
                || off(
                    wanted.response.bank_time_constant_s,
                    known.response.bank_time_constant_s,
                );
            // Limits that get worse count at once; better ones only between manoeuvres.
            let worse = wanted.course_rate_radps() < known.course_rate_radps();
            if changed && (worse || avoider.state() == AvoiderState::Cruise) {
                // Checked by the same rules when the avoider was made.
                let _ = avoider.set_vehicle(wanted);
            }
            return Some(());
        }
        let protection = &self.config.protection;
        let start = protection.safety_score.map_or(Start::Free, Start::Score);
        let settings = Settings {
            policy: Policy::TurnAware(start),
            decision_period_s: self.config.command.decision_period_s,
            // What is too far away is left out before.
            surveillance_radius_m: f64::INFINITY,
            horizon_s: protection.horizon_s,
            margin_m: protection.margin_m,
            confidence_sigmas: protection.confidence_sigmas,
            ..Settings::default()
        };
        match Avoider::new(settings, wanted) {
            Ok(avoider) => {
                self.avoider = Some(Box::new(avoider));
                Some(())
            }
            Err(error) => {
                self.note(now_s, "limits", json!({ "error": error.to_string() }));
                None
            }
        }
    }

    fn gather_obstacles(&mut self, state: &State, now_s: f64) {
        self.obstacles.clear();
        let at_s = now_s + self.response.response().dead_time_s;
        let own_m = state.ownship.position_m;
        let within_m = self.config.protection.surveillance_m;
        if let Some(frame) = self.ownship.frame() {
            for (index, (report, volume, since_s)) in self.virtual_reports.iter().enumerate() {
                let Ok(id) = u32::try_from(FIRST_VIRTUAL_ID + index) else {
                    break;
                };
                let velocity_mps =
                    frame.velocity_mps(report.place, report.velocity_mps.unwrap_or(Vec3::ZERO));
                let position_m = frame.to_local_m(report.place) + velocity_mps * (at_s - since_s);
                if (position_m - own_m).length() - volume.bounding_radius_m() < within_m {
                    self.obstacles
                        .push(Obstacle::new(id, position_m, velocity_mps, *volume));
                }
            }
        }
        let protection = &self.config.protection;
        let volume = match protection.half_height_m {
            Some(half_height_m) => ProtectedVolume::Cylinder {
                radius_m: protection.radius_m,
                half_height_m,
            },
            None => ProtectedVolume::Sphere {
                radius_m: protection.radius_m,
            },
        };
        self.tracks.obstacles(
            at_s,
            own_m,
            within_m,
            volume,
            MOST_TRACKS,
            &mut self.obstacles,
        );
        if self.config.safety.use_fence {
            self.fence.obstacles(own_m, &mut self.obstacles);
        }
        let climbs = self
            .avoider
            .as_ref()
            .is_some_and(|avoider| avoider.vehicle().can_climb());
        if climbs {
            let home_z = own_m.z - state.above_home_m;
            let floor_z = home_z + self.config.safety.floor_m;
            let clearance = 2.0 * self.config.protection.margin_m;
            if self
                .way
                .waypoints_m
                .iter()
                .all(|w| w.z > floor_z + clearance)
                && own_m.z > floor_z + clearance
            {
                self.obstacles.push(layer(FLOOR_ID, floor_z, true, own_m));
            }
            if let Some(ceiling_m) = self.config.safety.ceiling_m {
                let ceiling_z = home_z + ceiling_m;
                if self
                    .way
                    .waypoints_m
                    .iter()
                    .all(|w| w.z < ceiling_z - clearance)
                    && own_m.z < ceiling_z - clearance
                {
                    self.obstacles
                        .push(layer(CEILING_ID, ceiling_z, false, own_m));
                }
            }
        }
        for obstacle in &mut self.obstacles {
            if matches!(obstacle.kind, ObstacleKind::NaturalBarrier) {
                obstacle.kind = ObstacleKind::Unknown;
            }
        }
    }

    /// Takes over, goes on, or hands back.
    fn act_on(&mut self, decision: &Decision, state: &State, now_s: f64) {
        let wants = match decision.state {
            AvoiderState::Avoiding => true,
            AvoiderState::Threatened => {
                decision
                    .record
                    .start_s
                    .is_some_and(|start_s| start_s < PREPARE_S)
                    && self.config.command.mode != CommandMode::Paper
            }
            AvoiderState::Cruise | AvoiderState::Recovering => false,
        };
        if self.keeper.state() == Authority::Ready && wants && now_s >= self.pause_until_s {
            let Some(heard) = self.heard else { return };
            if self.dry_run {
                self.pause_until_s = now_s + 5.0;
                self.tell_dry(decision, now_s);
                return;
            }
            if self.refusals >= MOST_REFUSALS {
                self.refusals = 0;
                self.set_enabled(false, now_s);
                self.tell(
                    Severity::Critical,
                    "fga: refused too often, switched off",
                    now_s,
                );
                return;
            }
            let actions = self.keeper.take_over(heard.mode, now_s);
            self.perform(&actions, now_s);
            self.command(now_s);
            return;
        }
        if !self.keeper.commands() {
            return;
        }
        let done = match self.config.command.mode {
            CommandMode::Paper => !self.paper.is_turning(),
            _ => self.is_back(decision, state, now_s),
        };
        if done {
            self.resume_item(now_s);
            let actions = self.keeper.hand_back(now_s);
            self.perform(&actions, now_s);
        }
    }

    fn tell_dry(&mut self, decision: &Decision, now_s: f64) {
        let name = decision
            .record
            .threat
            .map_or("?".to_owned(), |t| self.obstacle_name(t.id));
        self.tell(
            Severity::Warning,
            &format!("fga: would avoid {name} (dry run)"),
            now_s,
        );
    }

    /// Whether the way is met again and nothing threatens.
    fn is_back(&mut self, decision: &Decision, state: &State, now_s: f64) -> bool {
        let on_way = decision.state == AvoiderState::Cruise && self.is_on_leg(state);
        if !on_way {
            self.on_way_since_s = None;
            return false;
        }
        now_s - *self.on_way_since_s.get_or_insert(now_s) >= ON_LEG_FOR_S
    }

    fn is_on_leg(&self, state: &State) -> bool {
        let leg = self
            .avoider
            .as_ref()
            .map_or(0, |avoider| avoider.leg_index());
        let ends = self
            .way
            .waypoints_m
            .get(leg)
            .zip(self.way.waypoints_m.get(leg + 1));
        let Some((from, to)) = ends else { return true };
        let ahead = *to - *from;
        let level = Vec3::new(ahead.x, ahead.y, 0.0).normalize_or_zero();
        let offset = state.ownship.position_m - *from;
        let across_m = (offset.x * level.y - offset.y * level.x).abs();
        let along = (offset.x * level.x + offset.y * level.y).max(0.0);
        let length_m = libm::hypot(ahead.x, ahead.y).max(1.0);
        let height_m = from.z + ahead.z * (along / length_m).min(1.0);
        let angle_rad = wrap_pi(course_of(state.ground_velocity_mps) - course_of(level));
        let climbs = self
            .avoider
            .as_ref()
            .is_some_and(|avoider| avoider.vehicle().can_climb());
        across_m < ON_LEG_M
            && angle_rad.abs() < ON_LEG_RAD
            && (!climbs || (state.ownship.position_m.z - height_m).abs() < ON_LEG_HEIGHT_M)
    }

    /// Tells the vehicle which item to fly to, where waypoints were passed meanwhile.
    fn resume_item(&mut self, now_s: f64) {
        if self.owed_mode() != Some(Mode::AUTO) {
            return;
        }
        let (Some(item), Some(known)) = (self.current_leg_item(), self.mission_item) else {
            return;
        };
        if item != known {
            self.commands.send(
                Command::long(
                    MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
                    single(f64::from(item)),
                    0.0,
                ),
                true,
            );
            self.note(now_s, "set-item", json!({ "item": item }));
        }
    }

    fn log_decision(&mut self, now_s: f64) {
        let Some(decided) = self.decided else { return };
        let (state, reason) = (decided.decision.state, decided.decision.record.reason);
        let again = match self.last_logged {
            Some((last_state, last_reason, at_s)) => {
                (last_state, last_reason) != (state, reason)
                    || (state != AvoiderState::Cruise && now_s - at_s >= 1.0)
            }
            None => true,
        };
        if !again {
            return;
        }
        self.last_logged = Some((state, reason, now_s));
        let line = telling::decision_line(
            now_s,
            &decided.decision,
            &decided.own,
            &self.keeper.state(),
            |id| self.obstacle_name(id),
        );
        self.push_log(line);
    }
}

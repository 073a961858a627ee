//! The surroundings of the aircraft: virtual obstacles, tracks, the fence, floor and ceiling.

use fga::Vec3;
use fga::situation::{Movement, Obstacle, ProtectedVolume};
use fga_formats::geodesy::Geodetic;

use super::Companion;
use crate::config::{Config, VirtualObstacle};
use crate::mode::Mode;
use crate::ownship::State;
use crate::traffic::fence::{CEILING_ID, FLOOR_ID, layer};
use crate::traffic::report::{Quality, Sender};
use crate::traffic::table::Wanted;
use crate::traffic::threat::Ahead;
use crate::traffic::{AltitudeReference, Class, Report, Source, Volumes};

/// Identifier of the first virtual obstacle.
pub(super) const FIRST_VIRTUAL_ID: usize = 1_000;
/// Most tracks of one decision.
const MOST_TRACKS: usize = 64;
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
        sender: Sender {
            source: Source::Virtual,
            number: 0,
        },
        icao: 0,
        key: None,
        callsign: obstacle.name.clone(),
        place,
        velocity_mps: Some(velocity),
        valid_s: 0.0,
        movement: if obstacle.speed_mps == 0.0 && obstacle.climb_mps == 0.0 {
            Movement::AtRest
        } else {
            Movement::Straight
        },
        class: Class::Crewed,
        quality: Quality {
            position_m: 0.0,
            velocity_mps: 0.0,
            velocity_sigma_is_known: true,
            height_m: 0.0,
            altitude: AltitudeReference::MeanSeaLevel,
        },
    };
    Some((report, volume, 0.0))
}

impl Companion {
    /// Tells once where the mission crosses the fence.
    pub(super) fn watch_crossing(&mut self, own_m: Vec3) {
        // Until the vehicle has answered which kinds of fence count, all do.
        if self.route.mode() != Some(Mode::AUTO) || !self.parameters.is_complete() {
            return;
        }
        let (met_m, left_m) = self.route.left_m(own_m);
        let way_m: Vec<Vec3> = core::iter::once(met_m)
            .chain(left_m.iter().copied())
            .collect();
        let mission = self.lists.mission_number();
        let (parameters, voice) = (&self.parameters, &mut self.voice);
        self.boundary
            .watch_crossing(mission, &way_m, parameters, voice);
    }

    pub(super) fn gather_obstacles(&mut self, state: &State, now_s: f64) {
        self.obstacles.clear();
        let at_s = self.lead.acts_s(now_s);
        let own_m = state.ownship.position_m;
        let within_m = self.config.surveillance_m(state.ownship.airspeed_mps);
        if let Some(frame) = self.ownship.frame() {
            for (index, (report, volume, since_s)) in self.virtual_reports.iter().enumerate() {
                let Ok(id) = u32::try_from(FIRST_VIRTUAL_ID + index) else {
                    break;
                };
                let velocity_mps =
                    frame.velocity_mps(report.place, report.velocity_mps.unwrap_or(Vec3::ZERO));
                let position_m = frame.to_local_m(report.place) + velocity_mps * (at_s - since_s);
                if (position_m - own_m).length() - volume.bounding_radius_m() < within_m {
                    self.obstacles.push(Obstacle {
                        movement: report.movement,
                        ..Obstacle::straight(id, position_m, velocity_mps, *volume)
                    });
                }
            }
        }
        let (met_m, left_m) = self.route.left_m(own_m);
        let own = (own_m, state.ground_velocity_mps);
        self.tracks.set_ahead(Ahead::new(at_s, own, met_m, left_m));
        let wanted = Wanted {
            at_s,
            own_m,
            own_altitude_m: own_m.z + self.ownship.frame().map_or(0.0, |f| f.origin().altitude_m),
            within_m,
            volumes: Volumes::new(&self.config),
            most: MOST_TRACKS,
        };
        self.tracks.obstacles(&wanted, &mut self.obstacles);
        if self.tracks.is_new_overload(now_s) {
            self.voice.warn("fga: traffic overload, most urgent kept");
        }
        let climbs = self
            .decider
            .as_ref()
            .is_some_and(|decider| decider.vehicle().can_climb());
        if climbs {
            let home_z = own_m.z - state.above_home_m;
            let floor_z = home_z + self.config.limits.floor_m;
            let clearance = 2.0 * self.config.protection.margin_m;
            if self
                .route
                .waypoints_m()
                .iter()
                .all(|w| w.z > floor_z + clearance)
                && own_m.z > floor_z + clearance
            {
                self.obstacles.push(layer(FLOOR_ID, floor_z, true, own_m));
            }
            if let Some(ceiling_m) = self.config.limits.ceiling_m {
                let ceiling_z = home_z + ceiling_m;
                if self
                    .route
                    .waypoints_m()
                    .iter()
                    .all(|w| w.z < ceiling_z - clearance)
                    && own_m.z < ceiling_z - clearance
                {
                    self.obstacles
                        .push(layer(CEILING_ID, ceiling_z, false, own_m));
                }
            }
        }
    }
}

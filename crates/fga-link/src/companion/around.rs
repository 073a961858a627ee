//! Who and what is around the aircraft: virtual obstacles, tracks, floor and ceiling?

use fga::avoider::LIMIT_ID;
use fga::situation::{Movement, Obstacle};
use fga_formats::geodesy::{Geodetic, LocalFrame};

use super::route::LaidRoute;
use super::voice::Voice;
use crate::config::{Config, ConfigError, PolicyName, VirtualObstacle};
use crate::number::velocity_mps;
use crate::ownship::OwnState;
use crate::traffic::class::volume_of;
use crate::traffic::fence::{CEILING_ID, FLOOR_ID, layer};
use crate::traffic::table::Wanted;
use crate::traffic::threat::WaysAhead;
use crate::traffic::{TrackTable, Volumes};

/// Identifier of the first virtual obstacle.
const FIRST_VIRTUAL_ID: usize = 1_000;
/// Most tracks of one decision.
const MOST_TRACKS: usize = 64;

impl VirtualObstacle {
    /// The obstacle at a time since the start, seconds.
    fn at(&self, id: u32, frame: &LocalFrame, at_s: f64) -> Option<Obstacle> {
        let place = Geodetic::new(self.latitude_deg, self.longitude_deg, self.altitude_m)?;
        let track_rad = self.track_deg.to_radians();
        let velocity_mps = velocity_mps(self.speed_mps, track_rad, self.climb_mps);
        let velocity_mps = frame.velocity_mps(place, velocity_mps);
        let position_m = frame.to_local_m(place) + velocity_mps * at_s;
        let volume = volume_of(self.radius_m, self.half_height_m);
        Some(Obstacle {
            movement: if self.speed_mps == 0.0 && self.climb_mps == 0.0 {
                Movement::AtRest
            } else {
                Movement::Straight
            },
            ..Obstacle::straight(id, position_m, velocity_mps, volume)
        })
    }
}

/// The surroundings.
#[derive(Debug)]
pub(super) struct ObstaclesAround {
    tracks: TrackTable,
    /// The configuration's obstacles.
    virtual_obstacles: Vec<VirtualObstacle>,
    /// What a decision is about.
    obstacles: Vec<Obstacle>,
}

impl ObstaclesAround {
    pub(super) fn new(config: &Config) -> Result<Self, ConfigError> {
        Ok(Self {
            tracks: TrackTable::new(&config.traffic, config.own_icao()?),
            virtual_obstacles: config.obstacle.clone(),
            obstacles: Vec::new(),
        })
    }

    pub(super) const fn tracks(&self) -> &TrackTable {
        &self.tracks
    }

    pub(super) const fn tracks_mut(&mut self) -> &mut TrackTable {
        &mut self.tracks
    }

    pub(super) fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Name of an obstacle.
    pub(super) fn name(&self, id: u32) -> String {
        if let Some(track) = self.tracks.get(id) {
            return track.name();
        }
        let index = usize::try_from(id).unwrap_or(usize::MAX);
        let own = index
            .checked_sub(FIRST_VIRTUAL_ID)
            .and_then(|index| self.virtual_obstacles.get(index));
        match (id, own) {
            (FLOOR_ID, _) => "floor".to_owned(),
            (CEILING_ID, _) => "ceiling".to_owned(),
            (_, Some(own)) if !own.name.is_empty() => own.name.clone(),
            (_, Some(_)) => "virtual obstacle".to_owned(),
            (LIMIT_ID, _) => "fence".to_owned(),
            _ => "lost traffic".to_owned(),
        }
    }

    /// Number of an obstacle in messages: its address, where it has one.
    pub(super) fn number(&self, id: u32) -> u32 {
        let icao = self.tracks.get(id).map_or(0, |track| track.icao);
        if icao == 0 { id } else { icao }
    }

    /// Gathers the obstacles at `at_s`, in seconds, of the aircraft in its state then.
    pub(super) fn gather(
        &mut self,
        (state, at_s): (&OwnState, f64),
        frame: Option<&LocalFrame>,
        route: &LaidRoute,
        config: &Config,
        voice: &mut Voice,
    ) {
        self.obstacles.clear();
        let own_m = state.ownship.position_m;
        let within_m = config.surveillance_m(state.ownship.airspeed_mps);
        let is_near = |obstacle: &Obstacle| {
            let away_m = (obstacle.position_m - own_m).length();
            away_m - obstacle.volume.bounding_radius_m() < within_m
        };
        let virtual_obstacles = frame.into_iter().flat_map(|frame| {
            let numbered = (FIRST_VIRTUAL_ID..).zip(&self.virtual_obstacles);
            numbered.filter_map(move |(id, own)| own.at(u32::try_from(id).ok()?, frame, at_s))
        });
        self.obstacles.extend(virtual_obstacles.filter(is_near));
        let (met_m, left_m) = route.left_m(own_m);
        let own = (own_m, state.ground_velocity_mps);
        self.tracks
            .set_ahead(WaysAhead::new(at_s, own, met_m, left_m));
        let wanted = Wanted {
            at_s,
            own_m,
            own_altitude_m: own_m.z + frame.map_or(0.0, |frame| frame.origin().altitude_m),
            within_m,
            volumes: Volumes::new(config),
            most: MOST_TRACKS,
            as_reported: config.command.policy == PolicyName::Belief,
        };
        self.tracks.obstacles(&wanted, &mut self.obstacles);
        if self.tracks.is_new_overload(voice.now_s()) {
            voice.warn("fga: traffic overload, most urgent kept");
        }
    }

    /// Adds floor and ceiling of a vehicle that can climb, where neither the aircraft nor its way comes near them.
    pub(super) fn add_layers(&mut self, state: &OwnState, route: &LaidRoute, config: &Config) {
        let own_m = state.ownship.position_m;
        let home_z = own_m.z - state.above_home_m;
        let clearance_m = 2.0 * config.protection.margin_m;
        let mut heights = route.waypoints_m().iter().map(|w| w.z).chain([own_m.z]);
        let floor_z = home_z + config.limits.floor_m;
        if heights.clone().all(|z| z > floor_z + clearance_m) {
            self.obstacles.push(layer(FLOOR_ID, floor_z, true, own_m));
        }
        if let Some(ceiling_m) = config.limits.ceiling_m
            && heights.all(|z| z < home_z + ceiling_m - clearance_m)
        {
            let ceiling = layer(CEILING_ID, home_z + ceiling_m, false, own_m);
            self.obstacles.push(ceiling);
        }
    }

    /// Grows the obstacles by the uncertainty of our own position, m.
    pub(super) fn grow(&mut self, by_m: f64) {
        if by_m > 0.0 {
            for obstacle in &mut self.obstacles {
                obstacle.volume = obstacle.volume.grown(by_m);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fga::Vec3;
    use fga::situation::Ownship;

    use super::*;
    use crate::mission::LegsAhead;

    #[test]
    fn floor_and_ceiling_count_where_neither_the_aircraft_nor_its_way_is_near() {
        let mut config = Config::default();
        config.limits.floor_m = 30.0;
        config.limits.ceiling_m = Some(300.0);
        config.protection.margin_m = 10.0;
        let layers = |own_m: f64, way_m: f64| {
            let mut around = ObstaclesAround::new(&config).unwrap();
            let state = OwnState {
                ownship: Ownship {
                    position_m: Vec3::Z * own_m,
                    course_rad: 0.0,
                    climb_rad: 0.0,
                    bank_rad: 0.0,
                    airspeed_mps: 20.0,
                },
                ground_velocity_mps: Vec3::X * 20.0,
                wind_mps: Vec3::ZERO,
                above_home_m: own_m,
                pitch_rad: 0.0,
                course_rate_radps: 0.0,
            };
            let way = LegsAhead {
                waypoints_m: vec![Vec3::Z * way_m],
                ..LegsAhead::default()
            };
            around.add_layers(&state, &LaidRoute::of(way, 0), &config);
            let names = around.obstacles().iter().map(|o| around.name(o.id));
            names.collect::<Vec<_>>()
        };
        assert_eq!(layers(100.0, 100.0), ["floor", "ceiling"]);
        assert_eq!(layers(49.0, 100.0), ["ceiling"]);
        assert_eq!(layers(100.0, 281.0), ["floor"]);
        assert_eq!(layers(100.0, 45.0), ["ceiling"]);
    }
}

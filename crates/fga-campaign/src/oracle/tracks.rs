//! Asks the oracle about recorded or drawn aircraft.
//!
//! The oracle knows the whole tracks of the others. Its search begins where the ownship could first know one of
//! them: within the range of its sensor and of its surveillance, but at most two thirds of the horizon before
//! the first loss of separation, or before the closest approach if none is lost. The ownship starts there as recorded, with its recorded airspeed.

use fga::Vec3;
use fga::angle::{climb_of, course_of};
use fga_judge::oracle::{
    OracleSettings, OracleStart, OracleTrack, OracleVehicle, best_margin_on_tracks,
};
use fga_judge::track::Track;
use fga_sim::plant::at_airspeed;
use fga_sim::world::World;

use super::airspace_of;

/// Share of the horizon that lies before the first loss or the closest approach.
const BEFORE: f64 = 2.0 / 3.0;

/// Time between two checks of range, seconds.
const CHECK_S: f64 = 0.5;

/// The oracle's answer about aircraft with tracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracksAnswer {
    /// The largest margin found, metres, with six decimals.
    pub best_margin_m: f64,
    /// Where the search begins, seconds after the ownship's first row.
    pub start_s: f64,
}

/// The largest margin that any manoeuvre keeps to the recorded aircraft of a world; `None` for a world without
/// a recorded ownship. It counts over the settings' horizon, as far as the ownship is recorded.
pub fn best_margin_of_tracks(world: &World, settings: &OracleSettings) -> Option<TracksAnswer> {
    let own = world.recorded.as_ref()?;
    let start_s = start_of(world, own, settings.horizon_s);
    let (position_m, velocity_mps) = own.at(start_s)?;
    let air_mps = velocity_mps - world.blows_mps();
    let vehicle = at_airspeed(&world.flies(), air_mps.length());
    let start = OracleStart {
        position_m,
        course_rad: course_of(air_mps),
        climb_rad: climb_of(air_mps),
        bank_rad: 0.0,
    };
    let until_s = own.presence_s().1.min(start_s + settings.horizon_s);
    let tracks: Vec<OracleTrack> = world
        .obstacles
        .iter()
        .map(|obstacle| OracleTrack {
            points_m: points(&obstacle.track, start_s, until_s, world.blows_mps()),
            volume: obstacle.volume,
        })
        .filter(|track| track.points_m.len() > 1)
        .collect();
    let settings = OracleSettings {
        horizon_s: (until_s - start_s).max(1.0),
        ..*settings
    };
    let airspace = airspace_of(world);
    let vehicle = OracleVehicle::from(&vehicle);
    let answer = best_margin_on_tracks(&start, &vehicle, &tracks, airspace, &settings);
    Some(TracksAnswer {
        best_margin_m: libm::rint(answer.best_margin_m * 1e6) / 1e6,
        start_s,
    })
}

/// Where the search begins.
fn start_of(world: &World, own: &Track, horizon_s: f64) -> f64 {
    let farthest_m = core::iter::once(&world.sensor)
        .chain(&world.more_sensors)
        .map(|sensor| sensor.range_m)
        .fold(0.0, f64::max);
    let range_m = world.settings.avoider.surveillance_radius_m.min(farthest_m);
    let (first_s, last_s) = own.presence_s();
    let (mut known_s, mut lost_s, mut closest) = (None, None, (f64::INFINITY, first_s));
    let mut time_s = first_s;
    while time_s <= last_s {
        let own_m = own.at(time_s).map(|(position_m, _)| position_m);
        for obstacle in &world.obstacles {
            let its_m = obstacle.track.at(time_s).map(|(position_m, _)| position_m);
            let (Some(own_m), Some(its_m)) = (own_m, its_m) else {
                continue;
            };
            let offset_m = own_m - its_m;
            if obstacle.volume.margin_m(offset_m) < 0.0 {
                lost_s.get_or_insert(time_s);
            }
            let distance_m = offset_m.length();
            if distance_m <= range_m && time_s >= obstacle.appears_s {
                known_s.get_or_insert(time_s);
            }
            if distance_m < closest.0 {
                closest = (distance_m, time_s);
            }
        }
        time_s += CHECK_S;
    }
    known_s
        .unwrap_or(first_s)
        .max(lost_s.unwrap_or(closest.1) - BEFORE * horizon_s)
        .max(first_s)
}

/// A track in the air mass, in time from the start.
fn points(track: &Track, start_s: f64, until_s: f64, wind_mps: Vec3) -> Vec<(f64, Vec3)> {
    let mut points: Vec<(f64, Vec3)> = Vec::new();
    let mut take = |time_s: f64, position_m: Vec3| {
        let since_s = time_s - start_s;
        if points.last().is_none_or(|last| since_s > last.0) {
            points.push((since_s, position_m - wind_mps * since_s));
        }
    };
    track.for_each_leg(start_s, until_s, |leg| {
        take(leg.from_s, leg.position_at_m(leg.from_s));
        take(leg.to_s, leg.position_at_m(leg.to_s));
    });
    points
}

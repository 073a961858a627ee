//! Asks the oracle about recorded or drawn aircraft.
//!
//! The oracle knows the whole tracks of the others. Its search begins where the ownship could first know one of
//! them: within the range of its sensor and of its surveillance, but at most two thirds of the horizon before
//! the first loss of separation, or before the closest approach if none is lost. The ownship starts there as recorded, with its recorded airspeed.

use fga::Vec3;
use fga::angle::{climb_of, course_of};

use super::{
    OracleAirspace, OracleSettings, OracleStart, OracleTrack, OracleVehicle, best_margin_on_tracks,
};
use crate::plant::at_airspeed;
use crate::track::Track;
use crate::world::World;

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
    let airspace = OracleAirspace::of(world);
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

#[cfg(test)]
mod tests {
    use super::super::{OracleObstacle, best_margin};
    use super::*;
    use fga::situation::ProtectedVolume;

    const VOLUME: ProtectedVolume = ProtectedVolume::Sphere { radius_m: 30.0 };

    fn track(points_m: &[(f64, Vec3)]) -> OracleTrack {
        OracleTrack {
            points_m: points_m.to_vec(),
            volume: VOLUME,
        }
    }

    #[test]
    fn a_straight_track_is_the_same_as_a_straight_mover() {
        let (from_m, velocity_mps) = (Vec3::new(250.0, 8.0, 0.0), Vec3::new(-12.0, 1.0, 0.0));
        let obstacle = OracleObstacle {
            position_m: from_m,
            velocity_mps,
            volume: VOLUME,
        };
        let vehicle = OracleVehicle::table_4();
        let settings = OracleSettings::default();
        let straight = best_margin(&OracleStart::ORIGIN, &vehicle, &[obstacle], &settings);
        let points: Vec<(f64, Vec3)> = (0..=60)
            .map(|second| (f64::from(second), from_m + velocity_mps * f64::from(second)))
            .collect();
        let tracked = best_margin_on_tracks(
            &OracleStart::ORIGIN,
            &vehicle,
            &[track(&points)],
            None,
            &settings,
        );
        assert!((straight.best_margin_m - tracked.best_margin_m).abs() < 0.02);
        assert!((straight.do_nothing_margin_m - tracked.do_nothing_margin_m).abs() < 1e-3);
    }

    /// Level flight at 15 m/s along x. The other aircraft stands at (300, 0) until t = 10 s and is gone then:
    /// it is never nearer than 150 m, less its radius. If it comes back at t = 18 s, it is 30 m away.
    #[test]
    fn an_aircraft_counts_only_while_its_track_exists() {
        let place = Vec3::X * 300.0;
        let hold = |points: &[OracleTrack]| {
            let settings = OracleSettings::default();
            let vehicle = OracleVehicle::table_4();
            best_margin_on_tracks(&OracleStart::ORIGIN, &vehicle, points, None, &settings)
                .do_nothing_margin_m
        };
        let gone = track(&[(0.0, place), (10.0, place)]);
        assert!((hold(core::slice::from_ref(&gone)) - 120.0).abs() < 1e-3);
        let back = track(&[(18.0, place), (18.5, place)]);
        assert!((hold(&[gone, back]) + 7.5).abs() < 1e-3);
        // It turns away before it gets near: a straight mover would have hit.
        let turned = track(&[
            (0.0, Vec3::X * 600.0),
            (10.0, Vec3::X * 450.0),
            (30.0, Vec3::new(450.0, 600.0, 0.0)),
        ]);
        let margin_m = hold(&[turned]);
        // Nearest where 15 m/s along x and 30 m/s along y balance: by hand, at t = 14 s.
        let by_hand = (0..=3000)
            .map(|k| f64::from(k) * 0.01)
            .map(|t| {
                let own = Vec3::X * (15.0 * t);
                let its = if t < 10.0 {
                    Vec3::X * (600.0 - 15.0 * t)
                } else {
                    Vec3::new(450.0, 30.0 * (t - 10.0), 0.0)
                };
                own.distance(its) - 30.0
            })
            .fold(f64::INFINITY, f64::min);
        assert!((margin_m - by_hand).abs() < 0.01, "{margin_m} {by_hand}");
    }
}

//! Families of missions: the share of each survey line that is flown, the missed waypoints, and the way
//! back to curved missions. The counts come from the flown positions alone, with code of this file.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fga::Vec3;
use fga::avoider::State;
use fga::situation::{Passing, ProtectedVolume};
use fga_sim::engine::{Engine, Observer, Outcome, Sample};
use fga_sim::policy::PolicyChoice;
use fga_sim::track::Track;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::wind::crab;
use fga_sim::world::{Ending, StartState, World, WorldObstacle};

/// The track must come this near for a line to count as flown, metres.
const FLOWN_WITHIN_M: f64 = 5.0;

const PROTECTED: ProtectedVolume = ProtectedVolume::Sphere { radius_m: 30.0 };

/// Options of `missions`.
#[derive(Args, Debug)]
pub(crate) struct MissionsArgs {
    family: MissionFamily,
    /// Vehicle file; without it the aircraft of Table 4.
    vehicle: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MissionFamily {
    /// Survey lines 10 to 100 m apart.
    Survey,
    /// Zigzags with corners up to 180°.
    Corners,
    /// Half circles in short legs with an obstacle on them.
    Curves,
}

#[derive(Default)]
struct MissionFlight {
    samples: Vec<Sample>,
}

impl Observer for MissionFlight {
    fn sample(&mut self, sample: &Sample) {
        self.samples.push(*sample);
    }
}

impl MissionFlight {
    /// Distances of a place from the pieces of the path, metres.
    fn distances_m(&self, place_m: Vec3) -> impl Iterator<Item = f64> {
        self.samples.windows(2).map(move |pair| {
            let (a, b) = (pair[0].position_m, pair[1].position_m);
            let along = b - a;
            let share = (place_m - a).dot(along) / along.length_squared().max(1e-12);
            place_m.distance(a + along * share.clamp(0.0, 1.0))
        })
    }

    /// Share of the points of a line, 1 m apart, that the aircraft passed, per cent.
    fn flown_percent(&self, from_m: Vec3, to_m: Vec3) -> f64 {
        let length_m = from_m.distance(to_m);
        let places: Vec<f64> = (0..100_000)
            .map(|k| f64::from(k) / length_m)
            .take_while(|share| *share <= 1.0)
            .collect();
        let is_flown = |share: &&f64| {
            let mut distances_m = self.distances_m(from_m.lerp(to_m, **share));
            distances_m.any(|distance_m| distance_m <= FLOWN_WITHIN_M)
        };
        100.0 * places.iter().filter(is_flown).count() as f64 / places.len() as f64
    }

    /// The least flown share of any line, per cent, and the largest distance to a waypoint, metres.
    fn measured<'a>(
        &self,
        lines_m: impl Iterator<Item = &'a [Vec3]>,
        waypoints_m: &[Vec3],
    ) -> (f64, f64) {
        let least = lines_m
            .map(|line| self.flown_percent(line[0], line[1]))
            .fold(f64::INFINITY, f64::min);
        let farthest_m = waypoints_m
            .iter()
            .map(|waypoint| self.distances_m(*waypoint).fold(f64::INFINITY, f64::min))
            .fold(0.0, f64::max);
        (least, farthest_m)
    }

    /// Changes in and out of avoiding.
    fn changes(&self) -> usize {
        let avoids = |sample: &Sample| sample.state == State::Avoiding;
        self.samples
            .windows(2)
            .filter(|pair| avoids(&pair[0]) != avoids(&pair[1]))
            .count()
    }

    fn path_m(&self) -> f64 {
        self.samples
            .windows(2)
            .map(|pair| pair[0].position_m.distance(pair[1].position_m))
            .sum()
    }
}

fn world(model: &VehicleModel, mission_m: Vec<Vec3>, wind_mps: Vec3, horizon_s: f64) -> World {
    let along = (mission_m[1] - mission_m[0]).normalize();
    let (course_rad, climb_rad) =
        crab(along, model.vehicle.airspeed_mps, wind_mps).expect("a leg that can be flown");
    let start = StartState {
        position_m: mission_m[0],
        course_rad,
        climb_rad,
    };
    let until = (horizon_s, Ending::MissionFlown);
    let mut world = World::of(model, mission_m, start, until);
    world.wind_mps = wind_mps;
    world.sensor.range_m = f64::INFINITY;
    world
}

fn fly(world: &World) -> (MissionFlight, Outcome) {
    let mut pilot = PolicyChoice::default()
        .pilot(&world.settings, &world.vehicle)
        .expect("usable settings");
    let mut flown = MissionFlight::default();
    let outcome = Engine::new().fly(world, pilot.as_mut(), &mut flown);
    (flown, outcome)
}

/// Lines of `length_m`, `apart_m` apart, flown back and forth.
fn survey_m(apart_m: f64, length_m: f64, lines: u32) -> Vec<Vec3> {
    (0..lines)
        .flat_map(|line| {
            let y = f64::from(line) * apart_m;
            let (from, to) = if line % 2 == 0 {
                (0.0, length_m)
            } else {
                (length_m, 0.0)
            };
            [Vec3::new(from, y, 100.0), Vec3::new(to, y, 100.0)]
        })
        .collect()
}

fn survey(model: &VehicleModel) {
    println!("apart_m,length_m,passing,least_percent,farthest_waypoint_m,path_m,mission_flown");
    for length_m in [400.0, 800.0] {
        for apart_m in (10..=100).step_by(10) {
            for passing in [Passing::FlyBy, Passing::FlyOver] {
                let mission_m = survey_m(f64::from(apart_m), length_m, 10);
                let mut world = world(model, mission_m.clone(), Vec3::ZERO, 4000.0);
                world.passing = vec![passing; mission_m.len()];
                let (flown, outcome) = fly(&world);
                let (least, farthest_m) = flown.measured(mission_m.chunks(2), &mission_m);
                println!(
                    "{apart_m},{length_m},{passing:?},{least:.1},{farthest_m:.1},{:.0},{}",
                    flown.path_m(),
                    outcome.mission_flown
                );
            }
        }
    }
}

fn corners(model: &VehicleModel) {
    println!("turn_deg,leg_m,passing,farthest_waypoint_m,least_percent,path_m,mission_flown");
    for leg_m in [10.0, 20.0, 40.0, 60.0, 100.0, 300.0] {
        for turn_deg in [5, 30, 60, 90, 120, 150, 170, 178, 180] {
            for passing in [Passing::FlyBy, Passing::FlyOver] {
                let turn_rad = f64::from(turn_deg).to_radians();
                let mut mission_m = vec![Vec3::new(-200.0, 0.0, 100.0)];
                let (mut place_m, mut course_rad) = (Vec3::new(0.0, 0.0, 100.0), 0.0_f64);
                for k in 0..6 {
                    mission_m.push(place_m);
                    course_rad += if k % 2 == 0 { turn_rad } else { -turn_rad };
                    let length_m = if k == 5 { 300.0 } else { leg_m };
                    place_m += Vec3::new(course_rad.cos(), course_rad.sin(), 0.0) * length_m;
                }
                mission_m.push(place_m);
                let mut world = world(model, mission_m.clone(), Vec3::ZERO, 2000.0);
                world.passing = vec![passing; mission_m.len()];
                let (flown, outcome) = fly(&world);
                let (least, farthest_m) = flown.measured(mission_m.windows(2), &mission_m);
                println!(
                    "{turn_deg},{leg_m},{passing:?},{farthest_m:.1},{least:.1},{:.0},{}",
                    flown.path_m(),
                    outcome.mission_flown
                );
            }
        }
    }
}

/// An arc of a mission in short legs, with an obstacle on it and one that crosses it.
fn curve_m(radius_m: f64, leg_m: f64, turn_rad: f64) -> Vec<Vec3> {
    let mut mission_m = vec![Vec3::new(-300.0, 0.0, 100.0)];
    let count = (radius_m * turn_rad / leg_m).round();
    let shares = (0..10_000).map(|k| f64::from(k) / count);
    for share in shares.take_while(|share| *share < 1.0 + 1e-9) {
        let angle = turn_rad * share;
        let place = Vec3::new(angle.sin(), 1.0 - angle.cos(), 0.0) * radius_m;
        mission_m.push(place + Vec3::new(0.0, 0.0, 100.0));
    }
    let last = mission_m[mission_m.len() - 1];
    mission_m.push(last + Vec3::new(turn_rad.cos(), turn_rad.sin(), 0.0) * 300.0);
    mission_m
}

fn curves(model: &VehicleModel) {
    println!(
        "radius_m,leg_m,obstacle,margin_m,cross_before_m,cross_after_m,rejoined,changes,path_m,end_s"
    );
    for radius_m in [60.0, 200.0, 900.0] {
        for leg_m in [20.0, 60.0, 300.0] {
            if leg_m > radius_m {
                continue;
            }
            for obstacle in 0..6 {
                let mission_m = curve_m(radius_m, leg_m, core::f64::consts::PI);
                let mut world = world(model, mission_m.clone(), Vec3::ZERO, 1500.0);
                let middle = mission_m[mission_m.len() / 2];
                let reach_s = 0.5
                    * mission_m
                        .windows(2)
                        .map(|leg| leg[0].distance(leg[1]))
                        .sum::<f64>()
                    / model.vehicle.airspeed_mps;
                let velocity_mps = match obstacle {
                    0 => Vec3::ZERO,
                    1 => Vec3::new(0.0, -20.0, 0.0),
                    2 => Vec3::new(0.0, 14.0, 0.0),
                    3 => Vec3::new(20.0, 0.0, 0.0),
                    4 => Vec3::new(-20.0, 0.0, 0.0),
                    _ => Vec3::new(12.0, 12.0, 0.0),
                };
                let track = Track::straight(middle - velocity_mps * reach_s, velocity_mps);
                world.obstacles = vec![WorldObstacle::new(1, track, PROTECTED)];
                let (flown, outcome) = fly(&world);
                let cross_m = |sample: &Sample| {
                    mission_m
                        .windows(2)
                        .map(|leg| {
                            let along = leg[1] - leg[0];
                            let offset = sample.position_m - leg[0];
                            let share = offset.dot(along) / along.length_squared();
                            offset.distance(along * share.clamp(0.0, 1.0))
                        })
                        .fold(f64::INFINITY, f64::min)
                };
                let back = flown
                    .samples
                    .iter()
                    .position(|sample| sample.state == State::Recovering)
                    .unwrap_or(flown.samples.len());
                let most = |samples: &[Sample]| samples.iter().map(cross_m).fold(0.0, f64::max);
                let last = flown.samples.last().map(|sample| sample.state);
                println!(
                    "{radius_m},{leg_m},{obstacle},{:.2},{:.1},{:.1},{},{},{:.0},{:.0}",
                    outcome.min_margin_m,
                    most(&flown.samples[..back]),
                    most(&flown.samples[back..]),
                    last == Some(State::Cruise),
                    flown.changes(),
                    flown.path_m(),
                    outcome.end_s
                );
            }
        }
    }
}

/// Flies a family and shows its rows.
pub(crate) fn run(args: &MissionsArgs) -> Result<(), String> {
    let model = match &args.vehicle {
        Some(file) => VehicleModel::read(file),
        None => VehicleModel::built_in(),
    };
    let model = model.map_err(|error| error.to_string())?;
    match args.family {
        MissionFamily::Survey => survey(&model),
        MissionFamily::Corners => corners(&model),
        MissionFamily::Curves => curves(&model),
    }
    Ok(())
}

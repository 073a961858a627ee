//! Scenario files: a mission and its obstacles in TOML
//! (tables: [`fga_files::scenario`], with what each key means).
//!
//! Local frame: x east, y north, z up, metres. With `[origin] latitude_deg, longitude_deg,
//! altitude_m` places may be geodetic: `waypoints_deg = [[latitude, longitude, altitude_m], …]` and
//! `position_deg`, `polygon_deg`, `center_deg`. A moving obstacle has `velocity_mps`, or a `track_m = [[t, x, y, z], …]`, which
//! also bounds its existence. Optional: `seed`, `[start]`, `[limits] floor_m, ceiling_m`, `[wind]`, `[noise]`, `[sensor]`, with
//! the keys of vehicle files. An unknown key is an error.

mod places;
mod terrain;
mod zones;

use std::path::Path;

use fga::Vec3;
use fga::angle::direction;
use fga::situation::{Passing, ProtectedVolume};
use fga_files::TomlText;
use fga_files::scenario::{KindName, MissionTable, MovementName, ObstacleTable, ScenarioFile};
use fga_formats::InputError;
use fga_formats::error::read_text;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::words::counted;
use toml::Spanned;

use self::places::FilePlaces;
use crate::plan::Plan;
use crate::track::{Track, TrackPoint};
use crate::vehicle_file::VehicleModel;
use crate::vehicle_file::checks;
use crate::wind::crab;
use crate::world::{Ending, StartState, World, WorldObstacle};

/// Longest flight, seconds.
const LONGEST_S: f64 = 86_400.0;

/// The floor of a file that gives none lies this far below the mission and the start, metres.
const FLOOR_BELOW_M: f64 = 30.0;

/// A mission is flown so far inside of the limits of altitude, metres.
const INSIDE_M: f64 = 1.0;

/// Heights that are farther apart than this, where some count from the sea and others from the origin, are named, metres.
const MIXED_M: f64 = 50.0;

/// A sentence about an obstacle far above or below a mission, where the height of one of them counts from the sea, in degrees, and that
/// of the other one from the origin, in metres.
fn mixed(
    [mission, obstacle]: [bool; 2],
    origin_m: f64,
    name: &str,
    at_m: Vec3,
    mission_m: &[Vec3],
) -> Option<String> {
    let apart_m = |waypoint: &Vec3| (waypoint.z - at_m.z).abs();
    let apart_m = mission_m.iter().map(apart_m).fold(f64::INFINITY, f64::min);
    if mission == obstacle || origin_m.abs() <= MIXED_M || apart_m <= MIXED_M {
        return None;
    }
    let [sea, local] = if mission {
        [name, "the mission"]
    } else {
        ["the mission", name]
    };
    Some(format!(
        "{name} begins {apart_m:.0} m above or below all waypoints: heights of {sea} (degrees) count from the sea, those of {local} (metres) from the origin, which is {origin_m:.0} m above it"
    ))
}

/// Reads a scenario; `vehicle` replaces the vehicle in the file.
///
/// # Errors
/// An unreadable file, an unknown or missing key, a value out of range, a mission of fewer
/// than two waypoints, a doubled obstacle number, an obstacle on top of the aircraft at the start.
pub fn read(path: &Path, vehicle: Option<VehicleModel>) -> Result<Plan, InputError> {
    let text = read_text(path)?;
    parse(TomlText::new(path, &text), vehicle)
}

/// Reads a scenario from its text; see [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: TomlText<'_>, vehicle: Option<VehicleModel>) -> Result<Plan, InputError> {
    let file = ScenarioFile::read(&text)?;
    let mut model = match (vehicle, &file.vehicle) {
        (Some(model), _) => model,
        (None, Some(named)) => {
            let folder = text.path().parent().unwrap_or(Path::new(""));
            VehicleModel::read(&folder.join(named))?
        }
        (None, None) => VehicleModel::built_in()?,
    };
    model.plant = checks::plant(&file.plant, text)?.or(&model.plant);
    let frame = frame(&file, &text)?;
    let places = FilePlaces { text, frame };
    let horizon_s = text.within("duration_s", &file.duration_s, (0.1, LONGEST_S))?;
    let mission_m = waypoints(&file.mission, &places)?;
    let passing = passing(&file.mission, &text, mission_m.len())?;
    let wind_mps = match &file.wind {
        Some(wind) => checks::wind(wind, text)?,
        None => model.wind_mps,
    };
    let (sensor, noise) = (file.sensor.clone(), file.noise.clone());
    let (sensor, noise) = (sensor.unwrap_or_default(), noise.unwrap_or_default());
    let sensor = checks::sensor(&sensor, &noise, text, model.sensor)?;
    let start = start_state(&file, &places, &model, &mission_m, wind_mps)?;
    let limits_m = limits_m(&file, &text, &model, (&mission_m, start.position_m))?;
    let flies_m = horizon_s * (model.vehicle.airspeed_mps + wind_mps.length());
    let flown_m = [mission_m.as_slice(), &[start.position_m]].concat();
    let terrain = file.terrain.as_ref();
    let terrain = terrain.map(|table| terrain::read(table, &places, &flown_m));
    let (terrain, ground) = terrain.transpose()?.unzip();
    let reach_m = (start.position_m, flies_m);
    let (zones, mut notes) = zones::all(&file.zone, &places, terrain.as_ref(), reach_m)?;
    notes.extend(old_names(&file.obstacle));
    let (mut names, mut obstacles) = (Vec::new(), Vec::<WorldObstacle>::new());
    for (entry, number) in file.obstacle.iter().zip(1..) {
        let obstacle = obstacle(entry, number, &places, &model)?;
        if obstacles.iter().any(|other| other.id == obstacle.id) {
            return Err(text.error_at(
                entry,
                format!(
                    "obstacle number {} is used twice, expected a number of its own for each",
                    obstacle.id
                ),
            ));
        }
        let name = entry.get_ref().name.clone();
        let name = name.unwrap_or_else(|| format!("obstacle {}", obstacle.id));
        if let Some((position_m, _)) = obstacle.track.at(0.0) {
            let margin_m = obstacle.volume.margin_m(start.position_m - position_m);
            if margin_m < 0.0 {
                return Err(text.error_at(
                    entry,
                    format!(
                        "{name} is on top of the aircraft at the start ({:.1} m inside its \
                         protected volume), expected the aircraft outside",
                        -margin_m
                    ),
                ));
            }
        }
        let table = entry.get_ref();
        let is_local = [
            file.mission.waypoints_m.is_some(),
            table.position_m.is_some(),
        ];
        let origin_m = places
            .frame
            .as_ref()
            .map_or(0.0, |frame| frame.origin().altitude_m);
        if let Some((at_m, _)) = obstacle.track.at(0.0) {
            notes.extend(mixed(is_local, origin_m, &name, at_m, &mission_m));
        }
        names.push(name);
        obstacles.push(obstacle);
    }
    Ok(Plan {
        name: file.name,
        description: file.description,
        names,
        notes,
        frame: places.frame,
        time_offset_s: 0.0,
        world: World {
            passing,
            limits_m,
            zones,
            ground,
            wind_mps,
            obstacles,
            sensor,
            more_sensors: Vec::new(),
            seed: file.seed,
            ..World::of(&model, mission_m, start, (horizon_s, Ending::MissionFlown))
        },
        model,
    })
}

/// The local frame of a file.
fn frame(file: &ScenarioFile, text: &TomlText<'_>) -> Result<Option<LocalFrame>, InputError> {
    let Some(origin) = &file.origin else {
        return Ok(None);
    };
    let place = origin.get_ref();
    let place = Geodetic::new(place.latitude_deg, place.longitude_deg, place.altitude_m);
    let Some(place) = place else {
        return Err(text.error_at(
            origin,
            "origin is out of range, expected latitude_deg from -90 to 90, longitude_deg from -180 to 180 and a finite altitude_m",
        ));
    };
    Ok(Some(LocalFrame::new(place, Earth::Wgs84)))
}

/// The lowest and the highest altitude of a manoeuvre, metres: of this file, else of the vehicle's; without a floor in either one
/// below the mission and the start.
fn limits_m(
    file: &ScenarioFile,
    text: &TomlText<'_>,
    model: &VehicleModel,
    (mission_m, start_m): (&[Vec3], Vec3),
) -> Result<(f64, f64), InputError> {
    let own = [&file.limits.floor_m, &file.limits.ceiling_m];
    let (own_floor_m, own_ceiling_m) = checks::limits(own, *text)?;
    let heights_m = mission_m.iter().map(|waypoint| waypoint.z);
    let lowest_m = heights_m.clone().fold(f64::INFINITY, f64::min);
    let highest_m = heights_m.fold(f64::NEG_INFINITY, f64::max);
    let below_m = lowest_m.min(start_m.z) - FLOOR_BELOW_M;
    let given = |limits: [f64; 2]| limits.into_iter().find(|limit_m| limit_m.is_finite());
    let floor_m = given([own_floor_m, model.limits_m.0]).unwrap_or(below_m);
    let ceiling_m = given([own_ceiling_m, model.limits_m.1]).unwrap_or(f64::INFINITY);
    if lowest_m < floor_m + INSIDE_M || highest_m > ceiling_m - INSIDE_M {
        return Err(text.error(format!(
            "mission is flown from {lowest_m} to {highest_m} m, expected at least {INSIDE_M} m inside the limits of altitude, \
             {floor_m} to {ceiling_m} m"
        )));
    }
    Ok((floor_m, ceiling_m))
}

/// How the aircraft passes each waypoint: where the file does not say, it flies by all but the last and over that.
fn passing(
    mission: &MissionTable,
    text: &TomlText<'_>,
    waypoints: usize,
) -> Result<Vec<Passing>, InputError> {
    let Some(list) = &mission.passing else {
        let mut passing = vec![Passing::FlyBy; waypoints];
        if let Some(last) = passing.last_mut() {
            *last = Passing::FlyOver;
        }
        return Ok(passing);
    };
    if list.get_ref().len() != waypoints {
        return Err(text.error_at(
            list,
            format!(
                "mission has {waypoints} waypoints and passing {}, expected as many",
                list.get_ref().len()
            ),
        ));
    }
    let names = list.get_ref().iter();
    Ok(names.map(|name| (*name.get_ref()).into()).collect())
}

/// The mission's waypoints, local, metres.
fn waypoints(mission: &MissionTable, places: &FilePlaces<'_>) -> Result<Vec<Vec3>, InputError> {
    let text = places.text;
    let (list, is_local) = match (&mission.waypoints_m, &mission.waypoints_deg) {
        (Some(list), None) => (list, true),
        (None, Some(list)) => (list, false),
        (None, None) => {
            let message = "mission has no waypoints, expected waypoints_m or waypoints_deg";
            return Err(text.error(message));
        }
        (Some(_), Some(list)) => {
            let message = "both waypoints_m and waypoints_deg are given, expected one of them";
            return Err(text.error_at(list, message));
        }
    };
    let place = |at| {
        if is_local {
            places.local("a waypoint", at)
        } else {
            places.geodetic("a waypoint", at)
        }
    };
    let waypoints: Vec<Vec3> = list.get_ref().iter().map(place).collect::<Result<_, _>>()?;
    if waypoints.len() < 2 {
        let count = counted(waypoints.len(), "waypoint");
        let message = format!("mission has {count}, expected at least two");
        return Err(text.error_at(list, message));
    }
    let is_short = |pair: &[Vec3]| pair[0].distance(pair[1]) < 1.0;
    if let Some(index) = waypoints.windows(2).position(is_short) {
        let message = "a waypoint is less than 1 m from the one before, expected another place";
        return Err(text.error_at(&list.get_ref()[index + 1], message));
    }
    Ok(waypoints)
}

fn start_state(
    file: &ScenarioFile,
    places: &FilePlaces<'_>,
    model: &VehicleModel,
    mission_m: &[Vec3],
    wind_mps: Vec3,
) -> Result<StartState, InputError> {
    let text = places.text;
    let (first, second) = (mission_m[0], mission_m[1]);
    let along = (second - first).normalize_or(Vec3::X);
    let Some((course_rad, climb_rad)) = crab(along, model.vehicle.airspeed_mps, wind_mps) else {
        return Err(text.error(format!(
            "wind of {:.1} m/s is too strong for an airspeed of {} m/s, expected a wind in which \
             the first leg can be flown",
            wind_mps.length(),
            model.vehicle.airspeed_mps
        )));
    };
    let mut start = StartState {
        position_m: first,
        course_rad,
        climb_rad: climb_rad
            .max(model.vehicle.climb_min_rad)
            .min(model.vehicle.climb_max_rad),
    };
    if let Some(table) = &file.start {
        if let Some(position_m) =
            places.either(table.position_m.as_ref(), table.position_deg.as_ref())?
        {
            start.position_m = position_m;
        }
        if let Some(course) = &table.course_deg {
            // Compass degrees: north is 0, east is 90.
            let compass_deg = text.within("course_deg", course, (-360.0, 360.0))?;
            let along = direction(
                fga_formats::geodesy::course_from_compass_rad(compass_deg),
                0.0,
            );
            if let Some((course_rad, _)) = crab(along, model.vehicle.airspeed_mps, wind_mps) {
                start.course_rad = course_rad;
            }
            start.climb_rad = 0.0;
        }
        if let Some(climb) = &table.climb_deg {
            let limits = (
                model.vehicle.climb_min_rad.to_degrees(),
                model.vehicle.climb_max_rad.to_degrees(),
            );
            start.climb_rad = text.within("climb_deg", climb, limits)?.to_radians();
        }
    }
    Ok(start)
}

fn obstacle(
    entry: &Spanned<ObstacleTable>,
    number: u32,
    places: &FilePlaces<'_>,
    model: &VehicleModel,
) -> Result<WorldObstacle, InputError> {
    let text = places.text;
    let table = entry.get_ref();
    let position = places.either(table.position_m.as_ref(), table.position_deg.as_ref())?;
    let track = match (position, &table.track_m) {
        (Some(position_m), None) => Track::straight(
            position_m,
            match &table.velocity_mps {
                Some(velocity) => places.local("velocity_mps", velocity)?,
                None => Vec3::ZERO,
            },
        ),
        (None, Some(points)) => recorded(&text, points)?,
        (None, None) => {
            return Err(text.error_at(
                entry,
                "the obstacle has no place, expected position_m, position_deg or track_m",
            ));
        }
        (Some(_), Some(points)) => {
            return Err(text.error_at(
                points,
                "both a position and track_m are given, expected one of them",
            ));
        }
    };
    let radius_m = match &table.radius_m {
        Some(radius) => text.positive("radius_m", radius)?,
        None => model.protection.radius_m(),
    };
    let volume = match (&table.half_height_m, model.protection) {
        (Some(half_height), _) => ProtectedVolume::Cylinder {
            radius_m,
            half_height_m: text.positive("half_height_m", half_height)?,
        },
        (None, ProtectedVolume::Cylinder { half_height_m, .. }) if table.radius_m.is_none() => {
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            }
        }
        (None, _) => ProtectedVolume::Sphere { radius_m },
    };
    let mut obstacle = WorldObstacle::new(
        table.id.as_ref().map_or(number, |id| *id.get_ref()),
        track,
        volume,
    );
    if let (Some(_), Some(kind)) = (table.nature, &table.kind) {
        let message = "kind and nature are given, expected nature alone: they are one key";
        return Err(text.error_at(kind, message));
    }
    obstacle.kind = table.nature().into();
    stands_still(table, &text)?;
    obstacle.movement = table.movement.into();
    obstacle.charted_sigma_m = charted_sigma_m(table, &text)?;
    if let Some(appears) = &table.appears_s {
        obstacle.appears_s = text.not_negative("appears_s", appears)?;
    }
    Ok(obstacle)
}

/// Refuses an obstacle that is said to be still and moves: decisions would rely on its rest.
fn stands_still(table: &ObstacleTable, text: &TomlText<'_>) -> Result<(), InputError> {
    let message = "an obstacle with movement = \"still\" moves, expected another movement, or neither velocity_mps nor track_m";
    match (&table.velocity_mps, &table.track_m) {
        _ if !matches!(table.movement, MovementName::Still) => Ok(()),
        (Some(velocity), _) if *velocity.get_ref() != [0.0; 3] => {
            Err(text.error_at(velocity, message))
        }
        (_, Some(points))
            if points
                .get_ref()
                .windows(2)
                .any(|pair| pair[0][1..] != pair[1][1..]) =>
        {
            Err(text.error_at(points, message))
        }
        _ => Ok(()),
    }
}

/// A note about keys that have other names now; one, however many obstacles have them.
fn old_names(obstacles: &[Spanned<ObstacleTable>]) -> Option<String> {
    let is_old = obstacles.iter().any(|each| each.get_ref().kind.is_some());
    is_old.then(|| "kind of an obstacle is called nature now: kind is read as before".to_owned())
}

/// The error of an obstacle that stands on a chart: one that is said to be still, and a natural barrier at rest.
fn charted_sigma_m(table: &ObstacleTable, text: &TomlText<'_>) -> Result<Option<f64>, InputError> {
    let is_at_rest = table.velocity_mps.is_none() && table.track_m.is_none();
    let is_still = matches!(table.movement, MovementName::Still);
    let is_charted = is_at_rest && (is_still || matches!(table.nature(), KindName::NaturalBarrier));
    match &table.chart_error_m {
        Some(error) if !is_charted => Err(text.error_at(
            error,
            "chart_error_m is given for an obstacle that is on no chart, expected movement = \"still\" or \
             nature = \"natural-barrier\", and neither velocity_mps nor track_m",
        )),
        Some(error) => text.not_negative("chart_error_m", error).map(Some),
        None => Ok(is_charted.then_some(0.0)),
    }
}

fn recorded(text: &TomlText<'_>, points: &Spanned<Vec<[f64; 4]>>) -> Result<Track, InputError> {
    let rows = points.get_ref();
    if let Some(pair) = rows.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let (before_s, after_s) = (pair[0][0], pair[1][0]);
        let message =
            format!("track_m has time {after_s} after time {before_s}, expected growing times");
        return Err(text.error_at(points, message));
    }
    let usable = rows.len() >= 2 && rows.iter().flatten().all(|v| v.is_finite());
    let track = rows.iter().map(|&[time_s, x, y, z]| TrackPoint {
        time_s,
        position_m: Vec3::new(x, y, z),
    });
    let track = Track::through(track.collect()).filter(|_| usable);
    let message =
        "track_m is not usable, expected at least two rows [t, x, y, z] of finite numbers";
    track.ok_or_else(|| text.error_at(points, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "name = 'a'
duration_s = 60.0
[mission]
waypoints_m = [[0, 0, 0], [900, 0, 0]]
[[obstacle]]
id = 4
position_m = [300, 0, 0]
radius_m = 20.0
[[obstacle]]
track_m = [[0, 100, 100, 0], [5, 100, 50, 0]]
";

    fn parsed(text: &str) -> Result<Plan, String> {
        parse(TomlText::new(Path::new("s.toml"), text), None).map_err(|e| e.to_string())
    }

    #[test]
    fn a_scenario_becomes_a_world() {
        let plan = parsed(GOOD).unwrap();
        assert_eq!(plan.world.obstacles.len(), 2);
        assert_eq!(plan.world.obstacles[0].id, 4);
        assert_eq!(
            plan.world.obstacles[1].volume,
            ProtectedVolume::Sphere { radius_m: 30.0 }
        );
        assert_eq!(plan.names, ["obstacle 4", "obstacle 2"]);
        assert_eq!(plan.world.start.course_rad, 0.0);
    }

    #[test]
    fn wrong_input_is_named_with_its_line() {
        for (from, to, expected) in [
            (
                "radius_m = 20",
                "radius = 20",
                "s.toml, line 8: unknown field `radius`",
            ),
            (
                "[[0, 0, 0], [900, 0, 0]]",
                "[[0, 0, 0]]",
                "s.toml, line 4: mission has 1 waypoint, expected at least two",
            ),
            (
                "[300, 0, 0]",
                "[10, 0, 0]",
                "s.toml, line 5: obstacle 4 is on top of the aircraft at the start (10.0 m inside",
            ),
            (
                "id = 4",
                "id = 2",
                "s.toml, line 9: obstacle number 2 is used twice",
            ),
            (
                "radius_m = 20",
                "radius_m = -1",
                "s.toml, line 8: radius_m is -1, expected a positive number",
            ),
            (
                "[5, 100",
                "[0, 100",
                "s.toml, line 10: track_m has time 0 after time 0, expected growing times",
            ),
            (
                "position_m = [300, 0, 0]",
                "position_deg = [1, 2, 3]",
                "s.toml, line 7: position_deg is geodetic, expected an [origin]",
            ),
            (
                "radius_m = 20",
                "movement = 'still'\nvelocity_mps = [-20, 0, 0]\nradius_m = 20",
                "s.toml, line 9: an obstacle with movement = \"still\" moves, expected another movement",
            ),
            (
                "track_m",
                "movement = 'still'\ntrack_m",
                "s.toml, line 11: an obstacle with movement = \"still\" moves",
            ),
            (
                "radius_m = 20",
                "chart_error_m = 3",
                "s.toml, line 8: chart_error_m is given for an obstacle that is on no chart",
            ),
            (
                "duration_s = 60.0",
                "duration_s = 0",
                "s.toml, line 2: duration_s is 0, expected a number from 0.1",
            ),
        ] {
            let error = parsed(&GOOD.replacen(from, to, 1)).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}

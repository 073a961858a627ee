//! Flies a `.daa` recording again: one aircraft is the ownship, the others fly as recorded.
//!
//! Until it manoeuvres the ownship follows the recording, linear between rows. It
//! manoeuvres at the airspeed recorded at that time, with the bank of the vehicle file. Its mission
//! is its recorded track, without the rows that lie within half a metre of straight legs, and the
//! protected volume comes from the vehicle file. Times count from the ownship's first row.
//!
//! An aircraft exists from its first to its last row, but for gaps (`pieces`); separations hold along the straight lines
//! between its rows. The avoider knows only the record so far: the last row, extrapolated with its recorded
//! velocity for at most two seconds, with the row's standard deviations: the largest in any direction.
//!
//! Where the ownship's rows have a velocity through the air, the wind is the mean difference of its velocities
//! over the ground and through the air; without one the wind comes from the vehicle file.

use std::path::Path;

use fga::Vec3;
use fga::angle::{climb_of, course_of};
use fga::situation::{Movement, Uncertainty};
use fga_formats::InputError;
use fga_formats::daa::{self, TrackSample};

use crate::obstacle::CARRIED_ON_S;
use crate::plan::Plan;
use crate::plant::at_airspeed;
use crate::track::{Track, TrackPoint};
use crate::vehicle_file::VehicleModel;
use crate::world::{Ending, StartState, TrackReport, World, WorldObstacle};

/// Rows nearer than this to a straight leg are not waypoints, metres.
const STRAIGHT_WITHIN_M: f64 = 0.5;

/// Rows of an aircraft are in one piece up to this many of its usual steps apart.
const STEPS_IN_A_ROW: f64 = 3.0;

/// Time for the way back after the recording's end, seconds.
const WAY_BACK_S: f64 = 300.0;

/// A flight from the text of a recording; `ownship` names the ownship, without it the first aircraft is the ownship.
///
/// # Errors
/// A text that is not a recording, an ownship that does not move, a wind that is too strong.
pub fn parse(
    text: &str,
    path: &Path,
    model: VehicleModel,
    ownship: Option<&str>,
) -> Result<Plan, InputError> {
    let mut recording = daa::parse(text, path)?;
    if let Some(name) = ownship {
        make_ownship(&mut recording, name, path)?;
    }
    let name = path
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let left_out = recording.tally.words("rows");
    let left_out = left_out.map_or_else(String::new, |words| format!("; left out: {words}"));
    let description = format!("recording {}{left_out}", path.display());
    plan(&recording, name, description, model).map_err(|message| InputError::in_file(path, message))
}

/// A recording with an aircraft for each piece of another one's rows between two gaps; the ownship's rows stay together.
///
/// A gap is longer than [`CARRIED_ON_S`] and than three usual steps (the median) between the rows of the aircraft. In DAIDALUS an
/// aircraft is there at the times of its rows alone.
pub(crate) fn pieces(recording: &daa::Recording) -> daa::Recording {
    let (own, others) = recording.aircraft.split_at(recording.aircraft.len().min(1));
    let pieces = others.iter().flat_map(|aircraft| {
        let pairs = aircraft.samples.windows(2);
        let mut steps_s: Vec<f64> = pairs.map(|pair| pair[1].time_s - pair[0].time_s).collect();
        steps_s.sort_by(f64::total_cmp);
        let usual_s = steps_s.get(steps_s.len() / 2).copied().unwrap_or(0.0);
        let longest_s = CARRIED_ON_S.max(STEPS_IN_A_ROW * usual_s);
        let pieces = (aircraft.samples).chunk_by(move |a, b| b.time_s - a.time_s <= longest_s);
        pieces.map(|samples| daa::Track {
            name: aircraft.name.clone(),
            samples: samples.to_vec(),
        })
    });
    daa::Recording {
        aircraft: own.iter().cloned().chain(pieces).collect(),
        ..recording.clone()
    }
}

/// A recording as a flight: the first aircraft is the ownship.
///
/// # Errors
/// An ownship that does not move; one sentence.
pub fn plan(
    recording: &daa::Recording,
    name: String,
    description: String,
    model: VehicleModel,
) -> Result<Plan, String> {
    plan_of_pieces(&pieces(recording), name, description, model)
}

/// The same, of aircraft without gaps.
pub(crate) fn plan_of_pieces(
    recording: &daa::Recording,
    name: String,
    description: String,
    model: VehicleModel,
) -> Result<Plan, String> {
    let ownship = recording
        .ownship()
        .filter(|track| track.samples.len() >= 2)
        .ok_or_else(|| {
            "the first aircraft has fewer than two rows, expected its flight".to_owned()
        })?;
    let time_offset_s = ownship.samples[0].time_s;
    let points = |samples: &[TrackSample]| {
        samples
            .iter()
            .map(|sample| TrackPoint {
                time_s: sample.time_s - time_offset_s,
                position_m: sample.position_m,
            })
            .collect::<Vec<_>>()
    };
    let own_points = points(&ownship.samples);
    let end_s = own_points[own_points.len() - 1].time_s;
    let mission_m = simplified(&own_points);
    if mission_m.len() < 2 {
        return Err("the first aircraft does not move, expected a flight".into());
    }
    let recorded = Track::through(own_points).ok_or_else(|| {
        "the first aircraft's times do not grow, expected growing times".to_owned()
    })?;
    let (position_m, velocity_mps) = recorded.at(0.0).unwrap_or((mission_m[0], Vec3::X));
    let wind_mps = recorded_wind_mps(&ownship.samples).unwrap_or(model.wind_mps);
    let air_mps = velocity_mps - wind_mps;
    let mut names = Vec::new();
    let mut obstacles = Vec::new();
    for (aircraft, id) in recording.intruders().iter().zip(1..) {
        let Some(track) = Track::through(points(&aircraft.samples)) else {
            continue;
        };
        names.push(aircraft.name.clone());
        obstacles.push(WorldObstacle {
            movement: Movement::CREWED,
            reports: aircraft
                .samples
                .iter()
                .map(|sample| TrackReport {
                    age_s: 0.0,
                    time_s: sample.time_s - time_offset_s,
                    position_m: sample.position_m,
                    velocity_mps: sample.velocity_mps,
                    uncertainty: Uncertainty {
                        position_m: sample.deviation.largest_m(),
                        velocity_mps: sample.deviation.largest_mps(),
                    },
                })
                .collect(),
            ..WorldObstacle::new(id, track, model.protection)
        });
    }
    let start = StartState {
        position_m,
        course_rad: course_of(air_mps),
        climb_rad: climb_of(air_mps),
    };
    let until = (end_s + WAY_BACK_S, Ending::MissionFlown);
    Ok(Plan {
        name,
        description,
        names,
        notes: Vec::new(),
        frame: recording.frame,
        time_offset_s,
        world: World {
            vehicle: at_airspeed(&model.vehicle, air_mps.length()),
            wind_mps,
            obstacles,
            recorded: Some(recorded),
            ..World::of(&model, mission_m, start, until)
        },
        model,
    })
}

/// Moves the aircraft with this name to the front. Positions stay in the frame of the file's first aircraft.
fn make_ownship(recording: &mut daa::Recording, name: &str, path: &Path) -> Result<(), InputError> {
    let place = recording.aircraft.iter().position(|a| a.name == name);
    let Some(place) = place else {
        let names: Vec<&str> = recording.aircraft.iter().map(|a| a.name.as_str()).collect();
        return Err(InputError::in_file(
            path,
            format!(
                "has no aircraft {}, expected one of {}",
                fga_formats::error::shown(name),
                names.join(", ")
            ),
        ));
    };
    let ownship = recording.aircraft.remove(place);
    recording.aircraft.insert(0, ownship);
    Ok(())
}

/// The mean wind of the rows with a velocity through the air, metres per second.
fn recorded_wind_mps(samples: &[TrackSample]) -> Option<Vec3> {
    let winds = samples.iter().filter_map(|sample| {
        let wind_mps = sample.velocity_mps - sample.air_mps?;
        Some(Vec3::new(wind_mps.x, wind_mps.y, 0.0))
    });
    let (sum_mps, count) = winds.fold((Vec3::ZERO, 0_u32), |(sum_mps, count), wind_mps| {
        (sum_mps + wind_mps, count + 1)
    });
    (count > 0).then(|| sum_mps / f64::from(count))
}

/// The corners of a track: each row in between is within half a metre of the straight legs
/// (Douglas and Peucker).
fn simplified(points: &[TrackPoint]) -> Vec<Vec3> {
    let places: Vec<Vec3> = points.iter().map(|p| p.position_m).collect();
    let Some(last) = places.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut keep = vec![false; places.len()];
    keep[0] = true;
    keep[last] = true;
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let (a, b) = (places[from], places[to]);
        let along = b - a;
        let farthest = (from + 1..to)
            .map(|index| {
                let offset = places[index] - a;
                let share = offset.dot(along) / along.length_squared().max(1e-12);
                (offset.distance(along * share.clamp(0.0, 1.0)), index)
            })
            .max_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((distance_m, index)) = farthest
            && distance_m > STRAIGHT_WITHIN_M
        {
            keep[index] = true;
            spans.push((from, index));
            spans.push((index, to));
        }
    }
    let mut corners: Vec<Vec3> = Vec::new();
    for (place, _) in places.iter().zip(&keep).filter(|(_, kept)| **kept) {
        if corners
            .last()
            .is_none_or(|last| last.distance(*place) > 1.0)
        {
            corners.push(*place);
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use core::fmt::Write as _;

    use super::*;

    #[test]
    fn a_straight_track_has_two_corners_and_a_bent_one_three() {
        let track = |bend: f64| {
            (0..=20)
                .map(|k| TrackPoint {
                    time_s: f64::from(k),
                    position_m: Vec3::new(
                        f64::from(k) * 50.0,
                        f64::from((k - 10).max(0)) * bend,
                        0.0,
                    ),
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(simplified(&track(0.0)).len(), 2);
        assert_eq!(
            simplified(&track(10.0)),
            [
                Vec3::ZERO,
                Vec3::new(500.0, 0.0, 0.0),
                Vec3::new(1000.0, 100.0, 0.0)
            ]
        );
    }

    /// An ownship that flies east over the ground at 100 kn with its nose to the south-east, and an intruder
    /// with these deviations (metres, metres per second).
    fn flown_in_wind(deviations: &str) -> Plan {
        let mut text = String::from(
            "NAME sx sy sz vx vy vz heading airspeed time s_EW_std s_NS_std s_EN_std sz_std v_EW_std vz_std\n\
             - [m] [m] [m] [m/s] [m/s] [m/s] [deg] [m/s] [s] [m] [m] [m] [m] [m/s] [m/s]\n",
        );
        for k in 0..60 {
            let x = 50.0 * f64::from(k);
            writeln!(
                text,
                "own, {x}, 0, 1000, 50, 0, 0, 100, 55, {k}, 0, 0, 0, 0, 0, 0"
            )
            .unwrap();
            let x = 4800.0 - 40.0 * f64::from(k);
            writeln!(
                text,
                "other, {x}, 0, 1000, -40, 0, 0, -, -, {k}, {deviations}"
            )
            .unwrap();
        }
        let recording = daa::parse(&text, Path::new("a.daa")).unwrap();
        let model = VehicleModel::built_in().unwrap();
        plan(&recording, "a".into(), "a".into(), model).unwrap()
    }

    #[test]
    fn the_wind_is_that_between_the_recorded_velocities_over_the_ground_and_through_the_air() {
        let world = flown_in_wind("0, 0, 0, 0, 0, 0").world;
        let (east, north) = (100.0_f64.to_radians().sin(), 100.0_f64.to_radians().cos());
        let expected = Vec3::new(50.0 - 55.0 * east, -55.0 * north, 0.0);
        assert!(
            (world.wind_mps - expected).length() < 1e-9,
            "{}",
            world.wind_mps
        );
        assert!((world.vehicle.airspeed_mps - 55.0).abs() < 1e-9);
    }

    #[test]
    fn recorded_deviations_reach_the_decision_and_grow_while_a_row_is_carried_on() {
        let exact = flown_in_wind("0, 0, 0, 0, 0, 0").world.obstacles;
        assert_eq!(
            exact[0].known_at(3.5).unwrap().uncertainty,
            Uncertainty::default()
        );
        // Errors in the direction of the diagonal alone: 30 m east and 40 m north are 50 m along it.
        let joint = (30.0_f64 * 40.0).sqrt();
        let known = flown_in_wind(&format!("30, 40, {joint}, 20, 3, 2"))
            .world
            .obstacles;
        let then = known[0].known_at(3.0).unwrap().uncertainty;
        assert!((then.position_m - 50.0).abs() < 1e-9, "{then:?}");
        assert_eq!(then.velocity_mps, 3.0);
        let later = known[0].known_at(3.5).unwrap().uncertainty;
        assert!((later.position_m - 51.5).abs() < 1e-9, "{later:?}");
    }

    /// An intruder that was missing for 40 s in a recording of each second was judged on the straight line between.
    #[test]
    fn an_aircraft_is_not_there_in_a_gap_of_its_rows() {
        let plan_without = |missing: core::ops::Range<i32>, step: i32| {
            let mut text =
                String::from("NAME sx sy sz vx vy vz time\n- [m] [m] [m] [m/s] [m/s] [m/s] [s]\n");
            for k in 0..60 {
                let (time_s, x) = (k * step, 50 * k * step);
                writeln!(text, "own {x} 0 1000 50 0 0 {time_s}").unwrap();
                if !missing.contains(&k) {
                    writeln!(text, "other {} 0 1000 -50 0 0 {time_s}", 6000 - x).unwrap();
                }
            }
            let recording = daa::parse(&text, Path::new("a.daa")).unwrap();
            let model = VehicleModel::built_in().unwrap();
            plan(&recording, "a".into(), "a".into(), model).unwrap()
        };
        let present = |plan: &Plan| -> Vec<(f64, f64)> {
            let tracks = plan.world.obstacles.iter().map(|each| &each.track);
            tracks.map(Track::presence_s).collect()
        };
        let gap = plan_without(20..40, 1);
        assert_eq!(present(&gap), [(0.0, 19.0), (40.0, 59.0)]);
        assert_eq!(gap.names, ["other", "other"]);
        // A row or two that are lost are none, and neither are the steps of a slow radar.
        assert_eq!(present(&plan_without(20..22, 1)), [(0.0, 59.0)]);
        assert_eq!(present(&plan_without(20..22, 10)), [(0.0, 590.0)]);
    }
}

//! A scenario from the mission of a ground station.

use core::fmt::Write as _;
use std::path::{Path, PathBuf};

use fga::situation::Passing;
use fga::vehicle::Vehicle;
use fga_formats::InputError;
use fga_formats::areas::AreaOutline;
use fga_formats::geodesy::{Earth, LocalFrame};
use fga_formats::missions::MissionFile;
use fga_formats::terrain::{Given, Terrain};
use fga_formats::words::counted;

/// Longest flight of a scenario, seconds.
const LONGEST_S: f64 = 86_400.0;
/// Time allowed beside twice that of the mission in still air, seconds.
const SPARE_S: f64 = 60.0;

/// The mission in the file `path` over the ground of these files, for a vehicle that climbs and descends as steeply as it can.
///
/// # Errors
/// Unusable files of heights; as [`MissionFile::over`].
pub fn over(
    mission: MissionFile,
    path: &Path,
    terrain: &[PathBuf],
    vehicle: &Vehicle,
) -> Result<MissionFile, InputError> {
    if terrain.is_empty() {
        return Ok(mission);
    }
    let terrain = Terrain::read(terrain, &Given::default())?;
    let steepest_rad = vehicle.climb_max_rad.min(-vehicle.climb_min_rad).max(0.0);
    let steepest = libm::tan(steepest_rad);
    let over = mission.over(&terrain, steepest);
    over.map_err(|message| InputError::in_file(path, message))
}

/// The text of a scenario that flies the mission in the file `path` at about this airspeed, over the ground of these files. Its origin is home, or the
/// first waypoint; altitudes are above mean sea level. Fences are zones; what is not flown stands in comments.
///
/// # Errors
/// A file of fences or rally points alone; waypoints above the ground, which [`over`] puts above the sea; a folder that is gone.
pub fn scenario_text(
    mission: &MissionFile,
    path: &Path,
    airspeed_mps: f64,
    terrain: &[PathBuf],
) -> Result<String, InputError> {
    let above = mission.above_ground();
    if above > 0 {
        let message = format!(
            "has {} above the ground, expected --terrain with files of the heights of its area",
            counted(above, "waypoint")
        );
        return Err(InputError::in_file(path, message));
    }
    let Some(first) = mission.waypoints.first() else {
        let message = format!("holds {}, expected a mission", mission.holds());
        return Err(InputError::in_file(path, message));
    };
    let origin = mission.home.unwrap_or(first.place);
    let frame = LocalFrame::new(origin, Earth::Wgs84);
    let length_m: f64 = mission
        .waypoints
        .windows(2)
        .map(|pair| match pair {
            [from, to] => frame
                .to_local_m(from.place)
                .distance(frame.to_local_m(to.place)),
            _ => 0.0,
        })
        .sum();
    let duration_s = (2.0 * length_m / airspeed_mps + SPARE_S)
        .min(LONGEST_S)
        .ceil();
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let one_line = |text: &str| text.replace(|c: char| c.is_control(), " ");
    let mut text = format!("# The mission of {}.\n", one_line(&file));
    for note in &mission.notes {
        let _ = writeln!(text, "# {}.", one_line(note));
    }
    let _ = write!(
        text,
        "name = {}\n\
         # Twice the time that the mission takes at {airspeed_mps} m/s in still air, and a minute.\n\
         duration_s = {duration_s:?}\n\
         # Without it the aircraft of the paper's Table 4.\n\
         # vehicle = \"vehicle.toml\"\n\n\
         [origin]\nlatitude_deg = {:?}\nlongitude_deg = {:?}\n# Altitudes are above mean sea level.\naltitude_m = {:?}\n\n\
         [mission]\nwaypoints_deg = [\n",
        toml::Value::String(name.into_owned()),
        origin.latitude_deg,
        origin.longitude_deg,
        origin.altitude_m
    );
    for waypoint in &mission.waypoints {
        let place = waypoint.place;
        let _ = writeln!(
            text,
            "    [{:?}, {:?}, {:?}],",
            place.latitude_deg, place.longitude_deg, place.altitude_m
        );
    }
    let last = mission.waypoints.len().saturating_sub(1);
    let passing: Vec<&str> = mission
        .waypoints
        .iter()
        .enumerate()
        .map(|(index, waypoint)| match waypoint.passing {
            Passing::FlyBy if index < last => "\"fly-by\"",
            Passing::FlyBy | Passing::FlyOver => "\"fly-over\"",
        })
        .collect();
    let _ = writeln!(text, "]\npassing = [{}]", passing.join(", "));
    text += &terrain_table(terrain)?;
    for (fence, number) in mission.fences.iter().zip(1..) {
        let kind = if fence.keep_in { "keep-in" } else { "keep-out" };
        let _ = write!(
            text,
            "\n[[zone]]\nname = \"fence {number}\"\nkind = \"{kind}\"\n"
        );
        let _ = match &fence.outline {
            AreaOutline::Circle {
                center_deg,
                radius_m,
            } => writeln!(text, "center_deg = {center_deg:?}\nradius_m = {radius_m:?}"),
            // One ring.
            AreaOutline::Polygon(rings) => writeln!(text, "polygon_deg = {:?}", rings.concat()),
        };
    }
    for place in &mission.rally {
        let _ = writeln!(
            text,
            "\n# Rally point: [{:?}, {:?}, {:?}].",
            place.latitude_deg, place.longitude_deg, place.altitude_m
        );
    }
    Ok(text)
}

/// The ground of a scenario, if there are files of it.
fn terrain_table(files: &[PathBuf]) -> Result<String, InputError> {
    if files.is_empty() {
        return Ok(String::new());
    }
    let absolute = |file: &PathBuf| {
        let absolute = std::path::absolute(file);
        let absolute = absolute.map_err(|error| InputError::unreadable(file, &error))?;
        Ok(absolute.to_string_lossy().into_owned().into())
    };
    let files = files.iter().map(absolute);
    let files: Vec<toml::Value> = files.collect::<Result<_, InputError>>()?;
    Ok(format!(
        "\n[terrain]\nfile = {}\n# Height above the ground that manoeuvres keep, beside its vertical error.\nclearance_m = 0.0\n",
        toml::Value::Array(files)
    ))
}

//! `fga terrain check`: usable files of heights, and a mission that clears their ground.

use core::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga::Vec3;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::terrain::{Clearance, Terrain};
use fga_formats::words::counted;
use fga_formats::{InputError, atomic, missions};
use fga_report::profile::{Profile, ProfilePoint};
use fga_sim::scenario;
use serde_json::{Value, json};

use crate::common::AnswerArgs;
use crate::failure::Failure;
use crate::terrain_ground::{Facts, GroundArgs, metres};

/// Options of `fga terrain check`.
#[derive(Args, Debug)]
pub(crate) struct TerrainCheckArgs {
    #[command(flatten)]
    ground: GroundArgs,
    /// A mission (.plan, .waypoints) or a scenario (.toml) with an [origin], whose legs must clear the ground.
    #[arg(long, value_name = "MISSION", requires = "clearance")]
    mission: Option<PathBuf>,
    /// Least height above the ground, metres; the vertical error of the ground is added.
    #[arg(long, value_name = "M", value_parser = metres, requires = "mission")]
    clearance: Option<f64>,
    /// Draw the mission over the ground.
    #[arg(long, value_name = "OUT.svg", requires = "mission")]
    profile: Option<PathBuf>,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Reads the files, and flies the mission over them.
pub(crate) fn run(args: &TerrainCheckArgs) -> Result<ExitCode, Failure> {
    let terrain = args.ground.read()?;
    let mut text = String::new();
    for file in terrain.files() {
        let counts = Facts::new(file).counts();
        let _ = writeln!(
            text,
            "{}: usable {}: {counts}",
            file.path.display(),
            file.format
        );
    }
    let files: Vec<String> = terrain
        .files()
        .iter()
        .map(|file| file.path.display().to_string())
        .collect();
    let (Some(mission), Some(clearance_m)) = (&args.mission, args.clearance) else {
        let answer = json!({ "files": files, "usable": true });
        args.answer.print(|| text, &answer)?;
        return Ok(ExitCode::SUCCESS);
    };
    let check = Check::new(&terrain, mission, clearance_m)?;
    if let Some(path) = &args.profile {
        atomic::write(path, check.profile(&terrain).to_svg())?;
    }
    let answer = check.to_json(&files);
    args.answer.print(|| text + &check.in_words(), &answer)?;
    match check.fault() {
        Some(fault) => Err(InputError::in_file(mission, fault).into()),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// A mission over the ground.
struct Check<'a> {
    mission: &'a Path,
    frame: LocalFrame,
    waypoints_m: Vec<Vec3>,
    /// Of each leg.
    legs: Vec<Clearance>,
    clearance_m: f64,
    error_m: f64,
    datum: &'static str,
}

/// The places of a mission in a local frame.
fn read_mission(terrain: &Terrain, path: &Path) -> Result<(LocalFrame, Vec<Vec3>), InputError> {
    if missions::is_mission_file(path) {
        let mission = missions::read(path)?.over(terrain, f64::INFINITY);
        let mission = mission.map_err(|message| InputError::in_file(path, message))?;
        let Some(first) = mission.waypoints.first() else {
            let message = format!("holds {}, expected a mission", mission.holds());
            return Err(InputError::in_file(path, message));
        };
        let frame = LocalFrame::new(mission.home.unwrap_or(first.place), Earth::Wgs84);
        let places = mission.waypoints.iter();
        let waypoints_m = places.map(|waypoint| frame.to_local_m(waypoint.place));
        return Ok((frame, waypoints_m.collect()));
    }
    let plan = scenario::read(path, None)?;
    let frame = plan.frame.ok_or_else(|| {
        InputError::in_file(
            path,
            "has no [origin], expected a scenario with latitude_deg, longitude_deg and altitude_m of its origin",
        )
    })?;
    Ok((frame, plan.world.mission_m))
}

impl<'a> Check<'a> {
    fn new(terrain: &Terrain, mission: &'a Path, clearance_m: f64) -> Result<Self, InputError> {
        let datum = terrain.datum();
        if !datum.is_sea_level() {
            let message = format!(
                "has heights above {}, expected mean sea level, as altitudes of missions are; --datum says otherwise",
                datum.words()
            );
            let path = terrain.files().first().map_or(mission, |file| &file.path);
            return Err(InputError::in_file(path, message));
        }
        let (frame, waypoints_m) = read_mission(terrain, mission)?;
        let legs = waypoints_m
            .windows(2)
            .filter_map(|leg| match leg {
                [from, to] => Some(terrain.clearance(&frame, *from, *to)),
                _ => None,
            })
            .collect();
        Ok(Self {
            mission,
            frame,
            waypoints_m,
            legs,
            clearance_m,
            error_m: terrain.vertical_error_m(),
            datum: datum.words(),
        })
    }

    fn required_m(&self) -> f64 {
        self.clearance_m + self.error_m
    }

    fn is_clear(&self, leg: &Clearance) -> bool {
        let is_high = |lowest_m: f64| lowest_m >= self.required_m();
        leg.unknown_at.is_none() && leg.lowest.is_some_and(|lowest| is_high(lowest.clearance_m))
    }

    /// The first leg that fails, in words; `None` if all are clear.
    fn fault(&self) -> Option<String> {
        let failed = self.legs.iter().filter(|leg| !self.is_clear(leg)).count();
        let (index, leg) = self
            .legs
            .iter()
            .enumerate()
            .find(|(_, leg)| !self.is_clear(leg))?;
        let low = leg
            .lowest
            .filter(|lowest| lowest.clearance_m < self.required_m());
        let found = match (low, leg.unknown_at) {
            (Some(low), _) => format!(
                "is {} at {} (altitude {:.1} m, ground {:.1} m), expected at least {} m above it: {} m of clearance and {} m of \
                 vertical error",
                over_ground(low.clearance_m),
                place(low.place),
                low.place.altitude_m,
                low.ground_m,
                self.required_m(),
                self.clearance_m,
                self.error_m
            ),
            (None, Some(begin)) => format!(
                "is over unknown ground for {:.0} m from {}, expected files that know it",
                leg.unknown_m,
                place(begin)
            ),
            (None, None) => "is over no ground, expected files that know it".into(),
        };
        let number = index + 1;
        Some(format!(
            "leg {number} (waypoint {number} to {}) {found}; {failed} of {} not clear",
            number + 1,
            counted(self.legs.len(), "leg")
        ))
    }

    /// One line for each leg.
    fn in_words(&self) -> String {
        let mut text = format!(
            "{}: {} over ground above {}\n",
            self.mission.display(),
            counted(self.legs.len(), "leg"),
            self.datum
        );
        for (number, leg) in (1..).zip(&self.legs) {
            let _ = write!(text, "  leg {number}: ");
            let _ = match leg.lowest {
                Some(low) => write!(
                    text,
                    "{} at {}, altitude {:.1} m",
                    over_ground(low.clearance_m),
                    place(low.place),
                    low.place.altitude_m
                ),
                None => write!(text, "no known ground"),
            };
            if leg.unknown_at.is_some() {
                let _ = write!(text, ", {:.0} m over unknown ground", leg.unknown_m);
            }
            let verdict = if self.is_clear(leg) {
                "clear"
            } else {
                "NOT CLEAR"
            };
            let _ = writeln!(text, ": {verdict}");
        }
        text
    }

    fn to_json(&self, files: &[String]) -> Value {
        let legs: Vec<Value> = self
            .legs
            .iter()
            .map(|leg| {
                let at = |place: Geodetic| [place.latitude_deg, place.longitude_deg];
                json!({
                    "clear": self.is_clear(leg),
                    "least_height_m": leg.lowest.map(|low| low.clearance_m),
                    "at_deg": leg.lowest.map(|low| at(low.place)),
                    "altitude_m": leg.lowest.map(|low| low.place.altitude_m),
                    "ground_m": leg.lowest.map(|low| low.ground_m),
                    "along_m": leg.lowest.map(|low| low.along_m),
                    "unknown_m": leg.unknown_m,
                    "unknown_at_deg": leg.unknown_at.map(at),
                })
            })
            .collect();
        json!({
            "files": files,
            "usable": true,
            "mission": self.mission.display().to_string(),
            "clearance_m": self.clearance_m,
            "vertical_error_m": self.error_m,
            "clear": self.legs.iter().all(|leg| self.is_clear(leg)),
            "legs": legs,
        })
    }

    fn profile(&self, terrain: &Terrain) -> Profile {
        let origin_m = self.frame.origin().altitude_m;
        let mut profile = Profile {
            title: self
                .mission
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            path: "mission",
            is_clear: self.fault().is_none(),
            datum: self.datum.to_owned(),
            required_m: self.required_m(),
            ..Profile::default()
        };
        let mut begin_m = 0.0;
        let mut lowest: Option<(f64, [f64; 2])> = None;
        for (leg, clearance) in self.waypoints_m.windows(2).zip(&self.legs) {
            let [from, to] = leg else { continue };
            profile.waypoints_m.push([begin_m, from.z + origin_m]);
            let points = terrain.profile(&self.frame, *from, *to);
            profile
                .points
                .extend(points.iter().map(|point| ProfilePoint {
                    along_m: begin_m + point.along_m,
                    path_m: point.path_m,
                    ground_m: point.ground_m,
                }));
            if let Some(low) = clearance.lowest
                && lowest.is_none_or(|(least_m, _)| low.clearance_m < least_m)
            {
                let at_m = [begin_m + low.along_m, low.place.altitude_m];
                lowest = Some((low.clearance_m, at_m));
            }
            begin_m += (to.truncate() - from.truncate()).length();
        }
        if let Some(last) = self.waypoints_m.last() {
            profile.waypoints_m.push([begin_m, last.z + origin_m]);
        }
        let least = lowest.map_or("over no known ground".into(), |(least_m, _)| {
            format!("lowest {}", over_ground(least_m))
        });
        let failed = self.legs.iter().filter(|leg| !self.is_clear(leg)).count();
        profile.verdict = if failed == 0 {
            format!("Clear: {least}.")
        } else {
            let legs = counted(self.legs.len(), "leg");
            format!("Not clear: {failed} of {legs}, {least}.")
        };
        profile.lowest_m = lowest.map(|(_, at_m)| at_m);
        profile
    }
}

/// A height over the ground, as in "12.0 m above the ground".
fn over_ground(height_m: f64) -> String {
    let side = if height_m < 0.0 { "below" } else { "above" };
    format!("{:.1} m {side} the ground", height_m.abs())
}

fn place(place: Geodetic) -> String {
    format!("{:.5}, {:.5}", place.latitude_deg, place.longitude_deg)
}

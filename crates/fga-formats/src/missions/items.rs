//! The items of a mission, one by one, and what they mean for a flight.
//!
//! Commands are those of MAVLink (`MAV_CMD`) as ArduPlane reads them.

use alloc::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fga::situation::Passing;

use super::{MissionFence, MissionFile, Waypoint};
use crate::areas::{AreaOutline, LARGEST_M};
use crate::error::InputError;
use crate::geodesy::Geodetic;
use crate::number;
use crate::words::counted;

/// A place nearer than this to the one before adds no leg, metres.
const SAME_PLACE_M: f64 = 1.0;
/// A place farther below home is named, metres.
const BELOW_HOME_M: f64 = 50.0;
/// How far before the only place of a mission its flight begins, metres.
const RUN_UP_M: f64 = 1000.0;
/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_320.0;

/// A mission leads at most this far from its beginning, kilometres: there a plane shows distances 0.3 % too short.
const MOST_AWAY_KM: f64 = 500.0;

/// An item as a file gives it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Item {
    /// Its number in the file.
    pub number: u64,
    /// Its line, if the file has lines.
    pub line: Option<u64>,
    pub command: u16,
    pub frame: u16,
    pub first_parameter: Option<f64>,
    /// The group of a corner of a fence to stay in.
    pub group: Option<f64>,
    /// Latitude and longitude, degrees; altitude, metres.
    pub at: [Option<f64>; 3],
}

/// What the items have led to so far.
#[derive(Debug, Default)]
pub(super) struct ItemReader {
    path: PathBuf,
    file: MissionFile,
    /// The corners of an unfinished polygon, how many there will be, and whether it keeps in.
    corners: Option<(Vec<[f64; 2]>, usize, bool)>,
    /// The groups of the fences to stay in.
    groups: Vec<f64>,
    begun: bool,
    ended: bool,
    left_out: BTreeMap<String, usize>,
    after_end: usize,
    circled: usize,
    repeated: usize,
}

impl ItemReader {
    pub(super) fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            ..Self::default()
        }
    }

    pub(super) const fn file(&mut self) -> &mut MissionFile {
        &mut self.file
    }

    /// An error about an item.
    pub(super) fn error(&self, item: &Item, message: &str) -> InputError {
        let message = format!("item {} {message}", item.number);
        InputError::at(&self.path, item.line, message)
    }

    /// Takes home; latitude and longitude are 0 where the station knew none.
    pub(super) fn take_home(&mut self, item: &Item) -> Result<(), InputError> {
        let [latitude, longitude, _] = item.at;
        if (latitude, longitude) != (Some(0.0), Some(0.0)) {
            self.file.home = Some(self.waypoint(item)?.place);
        }
        Ok(())
    }

    /// Takes the next item.
    pub(super) fn take(&mut self, item: &Item) -> Result<(), InputError> {
        if (5000..=5100).contains(&item.command) {
            return self.take_fence_or_rally(item);
        }
        if self.ended {
            self.after_end += 1;
            return Ok(());
        }
        match item.command {
            // Waypoint, spline waypoint.
            16 | 82 => self.go_to(item, Passing::FlyBy),
            // Circles for ever, by turns, by time, to an altitude.
            17 | 18 | 19 | 31 => {
                self.circled += 1;
                self.ended = item.command == 17;
                self.go_to(item, Passing::FlyOver)
            }
            // Take-off, also vertical.
            22 | 84 => self.take_off(item),
            // Landing, also vertical.
            21 | 85 => {
                self.ended = true;
                self.note("the landing is not flown: the flight ends at the place before it");
                Ok(())
            }
            // Return to launch.
            20 => {
                self.ended = true;
                self.note("the return ends over home at the height of the last waypoint");
                if let Some(last) = self.file.waypoints.last().copied() {
                    self.add_over_home(last);
                }
                Ok(())
            }
            other => {
                let name = name_of(other).map_or_else(|| format!("command {other}"), str::to_owned);
                *self.left_out.entry(name).or_default() += 1;
                Ok(())
            }
        }
    }

    /// The mission, and what of it is not flown.
    pub(super) fn finish(mut self) -> Result<MissionFile, InputError> {
        if let Some((corners, expected, _)) = self.corners {
            let message = format!("the last fence has {} of {expected} corners", corners.len());
            return Err(InputError::in_file(&self.path, message));
        }
        if let [only] = self.file.waypoints[..] {
            let mut before = only;
            before.place.latitude_deg -= RUN_UP_M / DEGREE_M;
            self.file.waypoints.insert(0, before);
            let sentence =
                format!("the mission has one place: the flight begins {RUN_UP_M} m south of it");
            self.note(&sentence);
        }
        if self.groups.len() > 1 {
            let groups = self.groups.len();
            let sentence = format!(
                "the fences to stay in are of {groups} groups, of which MAVLink asks for one: the aircraft stays in all of them, as ArduPilot does by default (FENCE_OPTIONS)"
            );
            self.note(&sentence);
        }
        let skipped: usize = self.left_out.values().sum();
        let left_out = self.left_out.iter();
        let names = left_out.map(|(name, count)| format!("{name} {count}"));
        let names: Vec<String> = names.collect();
        let names = format!("without a leg not flown: {}", names.join(", "));
        let rally = self.file.rally.len();
        self.note_count(self.circled, "loiter item", "flown past, not circled");
        self.note_count(skipped, "item", &names);
        self.note_count(self.repeated, "item", "at the place before left out");
        self.note_count(self.after_end, "item", "after the end not flown");
        let unused = "read, not used in a simulated flight";
        self.note_count(rally, "rally point", unused);
        Ok(self.file)
    }

    fn note_count(&mut self, count: usize, thing: &str, rest: &str) {
        if count > 0 {
            self.note(&format!("{} {rest}", counted(count, thing)));
        }
    }

    /// Notes once a difference between the file and the flight.
    pub(super) fn note(&mut self, sentence: &str) {
        if !self.file.notes.iter().any(|note| note == sentence) {
            self.file.notes.push(sentence.to_owned());
        }
    }

    fn go_to(&mut self, item: &Item, passing: Passing) -> Result<(), InputError> {
        let [latitude, longitude, _] = item.at;
        if (latitude, longitude) == (Some(0.0), Some(0.0)) {
            // ArduPilot: where the aircraft is.
            self.repeated += 1;
            return Ok(());
        }
        let waypoint = Waypoint {
            passing,
            ..self.waypoint(item)?
        };
        self.begin(waypoint);
        self.add(waypoint);
        Ok(())
    }

    /// The flight begins over home at the height of the first place.
    fn begin(&mut self, first: Waypoint) {
        if !self.begun {
            self.begun = true;
            self.add_over_home(first);
        }
    }

    /// Adds home, if the file gives it, at the height of a waypoint.
    fn add_over_home(&mut self, like: Waypoint) {
        if let Some(home) = self.file.home {
            let altitude_m = like.place.altitude_m;
            self.add(Waypoint {
                place: Geodetic { altitude_m, ..home },
                passing: Passing::FlyBy,
                ..like
            });
        }
    }

    fn take_off(&mut self, item: &Item) -> Result<(), InputError> {
        if self.begun {
            return Err(self.error(
                item,
                "is a take-off in flight, expected it before the first waypoint",
            ));
        }
        self.note("the take-off is not flown: the flight begins over home at its height");
        // ArduPlane climbs straight ahead whatever place the item gives, which may be 0, 0.
        let mut item = *item;
        if let Some(home) = self.file.home {
            (item.at[0], item.at[1]) = (Some(home.latitude_deg), Some(home.longitude_deg));
        } else if item.at[0].unwrap_or(0.0) == 0.0 && item.at[1].unwrap_or(0.0) == 0.0 {
            return Ok(());
        }
        let waypoint = self.waypoint(&item)?;
        self.begun = true;
        self.add(waypoint);
        Ok(())
    }

    fn add(&mut self, waypoint: Waypoint) {
        let place = waypoint.place;
        let same = self.file.waypoints.last().is_some_and(|last| {
            let north_m = (place.latitude_deg - last.place.latitude_deg) * DEGREE_M;
            let east_m = (place.longitude_deg - last.place.longitude_deg)
                * DEGREE_M
                * libm::cos(place.latitude_deg.to_radians());
            libm::hypot(north_m, east_m) < SAME_PLACE_M
        });
        if same {
            self.repeated += usize::from(self.file.waypoints.len() > 1);
            // An aeroplane does not climb on the spot: the later height counts.
            self.file.waypoints.pop();
        }
        self.file.waypoints.push(waypoint);
    }

    /// Where an item leads, flown by.
    fn waypoint(&mut self, item: &Item) -> Result<Waypoint, InputError> {
        let [Some(latitude_deg), Some(longitude_deg), given_m] = item.at else {
            return Err(self.error(
                item,
                "has no place, expected latitude, longitude and altitude",
            ));
        };
        let Some(given_m) = given_m else {
            return Err(self.error(
                item,
                "has a place without an altitude, expected one: some stations leave it to the vehicle or to their terrain",
            ));
        };
        let altitude_m = match item.frame {
            0 | 5 | 10 | 11 => given_m,
            3 | 6 => {
                if self.file.home.is_none() {
                    self.note("the file gives no home: heights above home count from sea level");
                }
                given_m + self.file.home.map_or(0.0, |home| home.altitude_m)
            }
            frame => {
                let message = format!(
                    "has frame {frame}, expected 0 or 5 (above mean sea level), 3 or 6 (above home), 10 or 11 (above the terrain)"
                );
                return Err(self.error(item, &message));
            }
        };
        let above_ground = matches!(item.frame, 10 | 11);
        if !above_ground
            && let Some(home) = self.file.home
            && home.altitude_m - altitude_m > BELOW_HOME_M
        {
            let sentence = format!(
                "item {} is {:.0} m below home: it is {altitude_m:.0} m above the sea, home {:.0} m; is one of them above another level?",
                item.number,
                home.altitude_m - altitude_m,
                home.altitude_m
            );
            self.note(&sentence);
        }
        Ok(Waypoint {
            place: self.on_earth(item, [latitude_deg, longitude_deg, altitude_m])?,
            passing: Passing::FlyBy,
            above_ground,
        })
    }

    /// A place that a mission can have: latitude and longitude, degrees; altitude, metres.
    fn on_earth(
        &self,
        item: &Item,
        [latitude_deg, longitude_deg, altitude_m]: [f64; 3],
    ) -> Result<Geodetic, InputError> {
        let place = Geodetic::new(latitude_deg, longitude_deg, altitude_m).ok_or_else(|| {
            let message = format!(
                "is at latitude {latitude_deg:?}, longitude {longitude_deg:?}, altitude {altitude_m:?} m, expected -90 to 90 degrees, \
                 -180 to 180 degrees, -20 to 1000 km"
            );
            self.error(item, &message)
        })?;
        let first = self.file.waypoints.first().map(|first| first.place);
        let origin = self.file.home.or(first);
        let away_km = origin.map_or(0.0, |origin| 1e-3 * origin.distance_m(place));
        if away_km > MOST_AWAY_KM {
            let message = format!(
                "is {away_km:.0} km from where the mission begins, expected at most {MOST_AWAY_KM} km"
            );
            return Err(self.error(item, &message));
        }
        Ok(place)
    }

    fn take_fence_or_rally(&mut self, item: &Item) -> Result<(), InputError> {
        let (Some(latitude_deg), Some(longitude_deg)) = (item.at[0], item.at[1]) else {
            return Err(self.error(item, "has no place, expected latitude and longitude"));
        };
        let at_deg = [latitude_deg, longitude_deg];
        match item.command {
            5001 | 5002 => {
                let keep_in = item.command == 5001;
                let expected = item
                    .first_parameter
                    .filter(|count| (3.0..=1e4).contains(count));
                let Some(expected) = expected.map(number::count) else {
                    return Err(self.error(
                        item,
                        "is a corner of a fence, expected 3 corners or more as its first parameter",
                    ));
                };
                let group = item.group.unwrap_or(0.0);
                if keep_in && !self.groups.contains(&group) {
                    self.groups.push(group);
                }
                let begun = (Vec::new(), expected, keep_in);
                let (mut corners_deg, count, kept_in) = self.corners.take().unwrap_or(begun);
                if (count, kept_in) != (expected, keep_in) {
                    return Err(self.error(
                        item,
                        "is a corner of another fence, expected the rest of the one before",
                    ));
                }
                corners_deg.push(at_deg);
                if corners_deg.len() < count {
                    self.corners = Some((corners_deg, count, keep_in));
                    return Ok(());
                }
                let outline = AreaOutline::Polygon(vec![corners_deg]);
                self.add_fence(item, MissionFence { outline, keep_in })
            }
            // The last one is a circle around home, wherever that is.
            5003..=5005 if item.command != 5005 || self.file.home.is_some() => {
                let home_deg = |home: Geodetic| [home.latitude_deg, home.longitude_deg];
                let home = self.file.home.filter(|_| item.command == 5005);
                let outline = AreaOutline::Circle {
                    center_deg: home.map_or(at_deg, home_deg),
                    radius_m: item.first_parameter.unwrap_or(0.0),
                };
                let keep_in = item.command != 5004;
                self.add_fence(item, MissionFence { outline, keep_in })
            }
            5100 if !matches!(item.frame, 10 | 11) => {
                let place = self.waypoint(item)?.place;
                self.file.rally.push(place);
                Ok(())
            }
            // Where ArduPlane returns to after it has left a fence, or what needs ground or a home that is not known here.
            other => {
                let name = match other {
                    5000 => "fence return point".into(),
                    5005 => "fence around a home that the file does not give".into(),
                    5100 => "rally point above the terrain".into(),
                    other => format!("command {other}"),
                };
                *self.left_out.entry(name).or_default() += 1;
                Ok(())
            }
        }
    }

    /// Adds a fence that can be one.
    pub(super) fn add_fence(&mut self, item: &Item, fence: MissionFence) -> Result<(), InputError> {
        let (places, usable) = match &fence.outline {
            AreaOutline::Circle {
                center_deg,
                radius_m,
            } => (
                core::slice::from_ref(center_deg),
                *radius_m > 0.0 && *radius_m <= LARGEST_M,
            ),
            AreaOutline::Polygon(rings) => {
                let corners = rings.first().map(Vec::as_slice).unwrap_or_default();
                (corners, corners.len() >= 3)
            }
        };
        for [latitude_deg, longitude_deg] in places {
            self.on_earth(item, [*latitude_deg, *longitude_deg, 0.0])?;
        }
        if !usable {
            return Err(self.error(
                item,
                "is no fence, expected a circle of a positive radius or a polygon of three corners or more",
            ));
        }
        self.file.fences.push(fence);
        Ok(())
    }
}

/// The name of a command that leads to no place.
const fn name_of(command: u16) -> Option<&'static str> {
    Some(match command {
        30 => "CONTINUE_AND_CHANGE_ALT",
        33 => "FOLLOW",
        36 => "ARC_WAYPOINT",
        42 => "SCRIPT_TIME",
        83 => "ALTITUDE_WAIT",
        92 => "GUIDED_ENABLE",
        93 => "DELAY",
        94 => "PAYLOAD_PLACE",
        112 => "CONDITION_DELAY",
        114 => "CONDITION_DISTANCE",
        115 => "CONDITION_YAW",
        177 => "DO_JUMP",
        178 => "DO_CHANGE_SPEED",
        179 => "DO_SET_HOME",
        181 => "DO_SET_RELAY",
        183 => "DO_SET_SERVO",
        184 => "DO_REPEAT_SERVO",
        189 => "DO_LAND_START",
        195 | 197 | 201 => "DO_SET_ROI",
        203 => "DO_DIGICAM_CONTROL",
        205 => "DO_MOUNT_CONTROL",
        206 => "DO_SET_CAM_TRIGG_DIST",
        207 => "DO_FENCE_ENABLE",
        208 => "DO_PARACHUTE",
        210 => "DO_INVERTED_FLIGHT",
        211 => "DO_GRIPPER",
        212 => "DO_AUTOTUNE_ENABLE",
        216 => "DO_SPRAYER",
        218 => "DO_AUX_FUNCTION",
        222 => "DO_GUIDED_LIMITS",
        530 => "SET_CAMERA_MODE",
        600 => "JUMP_TAG",
        601 => "DO_JUMP_TAG",
        1000 => "DO_GIMBAL_MANAGER_PITCHYAW",
        2000 => "IMAGE_START_CAPTURE",
        2001 => "IMAGE_STOP_CAPTURE",
        2500 => "VIDEO_START_CAPTURE",
        2501 => "VIDEO_STOP_CAPTURE",
        3000 => "DO_VTOL_TRANSITION",
        _ => return None,
    })
}

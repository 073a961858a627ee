//! Missions above the ground, as heights above the sea over ground that is known.

use fga::Vec3;
use fga::situation::Passing;

use super::{MissionFile, Waypoint};
use crate::geodesy::{Earth, LocalFrame};
use crate::terrain::Terrain;
use crate::words::counted;

/// Legs above the ground are flown as high above it as is asked, up or down within this, metres.
const WITHIN_M: f64 = 2.0;
/// Most legs above the ground together, metres.
const MOST_M: f64 = 2e6;

/// A place of the way.
#[derive(Debug, Clone, Copy)]
struct WayPlace {
    at_m: Vec3,
    /// The waypoint of the file, if it is one.
    passing: Option<Passing>,
    above_ground: bool,
}

impl MissionFile {
    /// How many waypoints are above the ground.
    pub fn above_ground(&self) -> usize {
        let above = self.waypoints.iter().filter(|each| each.above_ground);
        above.count()
    }

    /// The same mission with all waypoints above mean sea level. A leg to a waypoint above the ground follows the ground, as `ArduPlane` does:
    /// its height above it grows or falls evenly from that at the leg's beginning. Waypoints between are added where it takes them to keep
    /// within 2 m of that; what is steeper than `steepest`, metres of height for each metre of way, begins earlier and ends later, and is higher there.
    ///
    /// # Errors
    /// Heights that are not above the sea, ground that is not known, legs above the ground of more than 2,000 km: a sentence without its
    /// subject.
    pub fn over(mut self, terrain: &Terrain, steepest: f64) -> Result<Self, String> {
        let above = self.above_ground();
        let Some(first) = self.waypoints.first().filter(|_| above > 0) else {
            return Ok(self);
        };
        terrain.sea_level()?;
        let frame = LocalFrame::new(self.home.unwrap_or(first.place), Earth::Wgs84);
        let asked = self.points(terrain, &frame)?;
        let flown = flyable(&asked, steepest);
        let raised_m = asked.iter().zip(&flown);
        let raised_m = raised_m.map(|(asked, flown)| flown.at_m.z - asked.at_m.z);
        let raised_m = raised_m.fold(0.0, f64::max);
        let before = self.waypoints.len();
        self.waypoints = thinned(&flown)
            .map(|point| Waypoint {
                place: frame.to_geodetic(point.at_m),
                passing: point.passing.unwrap_or(Passing::FlyBy),
                above_ground: false,
            })
            .collect();
        self.notes.push(format!(
            "{} above the ground, with {} between that follow it",
            counted(above, "waypoint"),
            counted(self.waypoints.len() - before, "waypoint")
        ));
        if raised_m > WITHIN_M {
            self.notes.push(format!(
                "the ground is steeper than the aircraft flies: the way is up to {raised_m:.0} m higher above it than asked"
            ));
        }
        Ok(self)
    }

    /// The way with a place at each line of posts, metres above the frame's origin.
    fn points(&self, terrain: &Terrain, frame: &LocalFrame) -> Result<Vec<WayPlace>, String> {
        let mut points: Vec<WayPlace> = Vec::new();
        let mut followed_m = 0.0;
        for (waypoint, number) in self.waypoints.iter().zip(1..) {
            let place = waypoint.place;
            let (latitude_deg, longitude_deg) = (place.latitude_deg, place.longitude_deg);
            let unknown = || {
                format!(
                    "leads over unknown ground to waypoint {number} (latitude {latitude_deg}, longitude {longitude_deg}), expected files of heights of its area"
                )
            };
            let mut sea = place;
            if waypoint.above_ground {
                let ground_m = terrain.height_m(latitude_deg, longitude_deg);
                sea.altitude_m += ground_m.ok_or_else(unknown)?;
            }
            let at_m = frame.to_local_m(sea);
            if waypoint.above_ground
                && let Some(from) = points.last().copied()
            {
                let length_m = at_m.truncate().distance(from.at_m.truncate());
                followed_m += length_m;
                if followed_m > MOST_M {
                    return Err("has legs above the ground of more than 2000 km".into());
                }
                let ground = terrain.profile(frame, from.at_m, at_m);
                let above_m = match ground.first().and_then(|point| point.ground_m) {
                    Some(ground_m) => from.at_m.z + frame.origin().altitude_m - ground_m,
                    None => return Err(unknown()),
                };
                for point in ground {
                    let ground_m = point.ground_m.ok_or_else(unknown)?;
                    let share = point.along_m / length_m.max(f64::MIN_POSITIVE);
                    let height_m = above_m + share * (place.altitude_m - above_m);
                    let z = ground_m + height_m - frame.origin().altitude_m;
                    if 0.0 < share && share < 1.0 {
                        let at_m = from.at_m.lerp(at_m, share).with_z(z);
                        points.push(WayPlace {
                            at_m,
                            passing: None,
                            above_ground: true,
                        });
                    }
                }
            }
            points.push(WayPlace {
                at_m,
                passing: Some(waypoint.passing),
                above_ground: waypoint.above_ground,
            });
        }
        Ok(points)
    }
}

/// The way raised so that no part above the ground is steeper than this.
fn flyable(asked: &[WayPlace], steepest: f64) -> Vec<WayPlace> {
    let mut flown = asked.to_vec();
    let raise = |point: &mut WayPlace, from: &mut Option<Vec3>| {
        if let (Some(from), true) = (*from, point.above_ground) {
            let way_m = from.truncate().distance(point.at_m.truncate());
            point.at_m.z = point.at_m.z.max(from.z - steepest * way_m);
        }
        *from = Some(point.at_m);
    };
    let mut from = None;
    for each in flown.iter_mut().rev() {
        raise(each, &mut from);
    }
    from = None;
    for each in &mut flown {
        raise(each, &mut from);
    }
    flown
}

/// The waypoints, and of the places between those that it takes.
fn thinned(points: &[WayPlace]) -> impl Iterator<Item = WayPlace> {
    let mut kept = Vec::new();
    let mut from: Option<WayPlace> = None;
    // Slopes from there that pass all places since within reach.
    let mut slopes = (f64::NEG_INFINITY, f64::INFINITY);
    let mut before: Option<WayPlace> = None;
    for point in points {
        let slope_to = |from: &WayPlace, off_m: f64| {
            let way_m = from.at_m.truncate().distance(point.at_m.truncate());
            (point.at_m.z + off_m - from.at_m.z) / way_m.max(1e-3)
        };
        if let (Some(start), Some(last)) = (from, before) {
            let slope = slope_to(&start, 0.0);
            if slope < slopes.0 || slope > slopes.1 {
                kept.push(last);
                from = Some(last);
                slopes = (f64::NEG_INFINITY, f64::INFINITY);
            }
        }
        if point.passing.is_some() {
            kept.push(*point);
            (from, before) = (Some(*point), None);
            slopes = (f64::NEG_INFINITY, f64::INFINITY);
            continue;
        }
        if let Some(start) = from {
            slopes.0 = slopes.0.max(slope_to(&start, -WITHIN_M));
            slopes.1 = slopes.1.min(slope_to(&start, WITHIN_M));
        }
        before = Some(*point);
    }
    kept.into_iter()
}

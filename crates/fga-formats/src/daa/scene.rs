//! One time of a recording as the ownship sees it, in the plane that touches the earth below it, with
//! velocities through the air.
//!
//! The earth is the sphere on which one minute of arc is one nautical mile, as in DAIDALUS.
//! A position is projected straight down onto the plane that touches the sphere at the ownship's
//! latitude and longitude; a velocity is the difference of two positions 10 s apart on its great
//! circle. The order of the operations also follows DAIDALUS: distances of some metres are differences
//! of the earth's radius, and six printed decimals show the rounding.

use super::instants::Instant;
use super::report::{DaaMotion, DaaReport, EarthPlace, Place};
use crate::geodesy::DAIDALUS_RADIUS_M;
use crate::units::NAUTICAL_MILE_M;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use fga_alerts::{Aircraft, AircraftId, AircraftState, Deviation, FutureStates};
use glam::DVec3;

/// Time between the two positions that give a velocity, seconds.
const VELOCITY_STEP_S: f64 = 10.0;
/// East is undefined closer to the poles' axis than this, metres.
const POLE_M: f64 = 1e-7;

/// The plane that touches the sphere at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TangentPlane {
    east: DVec3,
    south: DVec3,
}

/// A place on the sphere, earth-centred: x towards 180° longitude, z north.
fn centred_m(place: &EarthPlace) -> DVec3 {
    let from_pole_rad = FRAC_PI_2 - place.latitude_rad;
    let around_rad = PI - place.longitude_rad;
    let axis_m = DAIDALUS_RADIUS_M * libm::sin(from_pole_rad);
    DVec3::new(
        axis_m * libm::cos(around_rad),
        axis_m * libm::sin(around_rad),
        DAIDALUS_RADIUS_M * libm::cos(from_pole_rad),
    )
}

fn unit(v: DVec3) -> DVec3 {
    v / libm::sqrt(v.x * v.x + v.y * v.y + v.z * v.z)
}

impl TangentPlane {
    fn at(place: &EarthPlace) -> Self {
        let up = centred_m(place);
        let eastward = if up.x.abs() < POLE_M && up.y.abs() < POLE_M {
            DVec3::X
        } else {
            DVec3::new(up.y, -up.x, 0.0)
        };
        Self {
            east: unit(eastward),
            south: unit(up.cross(eastward)),
        }
    }

    fn project_m(&self, place: &EarthPlace) -> DVec3 {
        let centred = centred_m(place);
        let (east_m, south_m) = (self.east.dot(centred), self.south.dot(centred));
        DVec3::new(east_m, -south_m, place.altitude_m)
    }
}

/// An angle in (−π, π].
fn to_half_turn(angle_rad: f64) -> f64 {
    let rest = angle_rad - libm::floor(angle_rad / TAU) * TAU;
    if rest > PI { rest - TAU } else { rest }
}

/// The position on a great circle after a time.
fn advanced(place: Place, motion: &DaaMotion, after_s: f64) -> Place {
    if after_s == 0.0 || motion.velocity_mps == DVec3::ZERO {
        return place;
    }
    match place {
        Place::Local(position_m) => Place::Local(position_m + motion.velocity_mps * after_s),
        Place::Geodetic(at) => {
            let arc_rad = motion.speed_mps * after_s / NAUTICAL_MILE_M * PI / (180.0 * 60.0);
            let (sin_lat, cos_lat) = (libm::sin(at.latitude_rad), libm::cos(at.latitude_rad));
            let (sin_arc, cos_arc) = (libm::sin(arc_rad), libm::cos(arc_rad));
            let (sin_track, cos_track) = (libm::sin(motion.track_rad), libm::cos(motion.track_rad));
            let sine = sin_lat * cos_arc + cos_lat * sin_arc * cos_track;
            let latitude = libm::asin(sine.clamp(-1.0, 1.0));
            let turned = libm::atan2(
                sin_track * sin_arc * cos_lat,
                cos_arc - sin_lat * libm::sin(latitude),
            );
            Place::Geodetic(EarthPlace {
                latitude_rad: latitude,
                longitude_rad: to_half_turn(at.longitude_rad + turned),
                altitude_m: at.altitude_m + motion.velocity_mps.z * after_s,
            })
        }
    }
}

/// Distance over the ground, metres; infinite between a place on the earth and one in a plane.
fn distance_m(a: Place, b: Place) -> f64 {
    match (a, b) {
        (Place::Geodetic(a), Place::Geodetic(b)) => {
            let half_lat = libm::sin((a.latitude_rad - b.latitude_rad) / 2.0);
            let half_lon = libm::sin((a.longitude_rad - b.longitude_rad) / 2.0);
            let shrunk = libm::cos(a.latitude_rad) * libm::cos(b.latitude_rad);
            let square = half_lat * half_lat + shrunk * (half_lon * half_lon);
            2.0 * DAIDALUS_RADIUS_M * libm::asin(libm::sqrt(square).clamp(0.0, 1.0))
        }
        (Place::Local(a), Place::Local(b)) => {
            let d = a.truncate() - b.truncate();
            libm::sqrt(d.length_squared())
        }
        _ => f64::INFINITY,
    }
}

/// An aircraft of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The aircraft: its index in the recording's names.
    pub aircraft: usize,
    /// Its position.
    pub place: Place,
    /// Its velocity over the ground.
    pub ground: DaaMotion,
    /// Its velocity through the air.
    pub air: DaaMotion,
    /// The alerter that judges it, counted from 1; 0 for none.
    pub alerter: u32,
    /// The uncertainty of its state.
    pub deviation: Deviation,
}

/// One time of a recording as the ownship sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct DaaScene {
    /// Time, seconds.
    pub time_s: f64,
    /// The ownship.
    pub ownship: Seen,
    /// The others, in the order of the recording.
    pub traffic: Vec<Seen>,
    plane: Option<TangentPlane>,
    terminal: Option<Place>,
}

/// The wind from the ownship's rows, kept from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wind {
    /// The air's velocity over the ground, metres per second.
    pub velocity_mps: DVec3,
}

impl Wind {
    /// The velocity through the air of an aircraft with this velocity over the ground.
    fn through_air(&self, ground: &DaaMotion) -> DaaMotion {
        DaaMotion::from_velocity(ground.velocity_mps - self.velocity_mps)
    }
}

impl DaaScene {
    /// The scene of an instant; `None` where the ownship (aircraft 0) has no row.
    ///
    /// If the ownship's row has an air velocity, it sets the wind for all aircraft from then on.
    pub fn of(instant: &Instant, wind: &mut Wind, terminal: Option<Place>) -> Option<Self> {
        let own = instant.reports.iter().find(|report| report.aircraft == 0)?;
        let own_air = match own.air {
            Some((heading_rad, airspeed_mps)) => {
                let air =
                    DaaMotion::from_track(heading_rad, airspeed_mps, own.ground.velocity_mps.z);
                wind.velocity_mps = own.ground.velocity_mps - air.velocity_mps;
                air
            }
            None => wind.through_air(&own.ground),
        };
        let seen = |report: &DaaReport, air: DaaMotion| Seen {
            aircraft: report.aircraft,
            place: report.place,
            ground: report.ground,
            air,
            alerter: report.alerter.unwrap_or(1),
            deviation: report.deviation,
        };
        let plane = match own.place {
            Place::Geodetic(at) => Some(TangentPlane::at(&at)),
            Place::Local(_) => None,
        };
        Some(Self {
            time_s: instant.time_s,
            ownship: seen(own, own_air),
            traffic: instant
                .reports
                .iter()
                .filter(|report| report.aircraft != 0)
                .map(|report| seen(report, wind.through_air(&report.ground)))
                .collect(),
            plane,
            terminal,
        })
    }

    /// The state of an aircraft after a time, in the plane.
    fn state_after(&self, seen: &Seen, after_s: f64) -> AircraftState {
        let place = advanced(seen.place, &seen.ground, after_s);
        let position_m = self.to_plane(place);
        let velocity_mps = if self.plane.is_some() {
            (self.to_plane(advanced(place, &seen.air, VELOCITY_STEP_S)) - position_m)
                * (1.0 / VELOCITY_STEP_S)
        } else {
            seen.air.velocity_mps
        };
        AircraftState {
            position_m,
            velocity_mps,
        }
    }

    fn to_plane(&self, place: Place) -> DVec3 {
        match (place, &self.plane) {
            (Place::Geodetic(at), Some(plane)) => plane.project_m(&at),
            (Place::Geodetic(at), None) => DVec3::new(0.0, 0.0, at.altitude_m),
            (Place::Local(position_m), _) => position_m,
        }
    }

    fn aircraft(&self, seen: &Seen) -> Aircraft {
        let mut aircraft = Aircraft::new(
            AircraftId(seen.aircraft as u64),
            self.state_after(seen, 0.0),
        );
        aircraft.alerter = (seen.alerter as usize).checked_sub(1);
        aircraft.deviation = seen.deviation;
        aircraft.terminal_distance_m = self.terminal_distance_m(seen);
        aircraft
    }

    /// Distance of an aircraft from the center of the terminal area, metres.
    pub fn terminal_distance_m(&self, seen: &Seen) -> Option<f64> {
        self.terminal.map(|center| distance_m(seen.place, center))
    }

    /// The ownship for the monitor.
    pub fn ownship_aircraft(&self) -> Aircraft {
        self.aircraft(&self.ownship)
    }

    /// The others for the monitor, in the order of [`DaaScene::traffic`].
    pub fn traffic_aircraft(&self) -> Vec<Aircraft> {
        self.traffic
            .iter()
            .map(|seen| self.aircraft(seen))
            .collect()
    }
}

impl FutureStates for DaaScene {
    fn ownship(&self, after_s: f64) -> AircraftState {
        self.state_after(&self.ownship, after_s)
    }

    fn intruder(&self, index: usize, after_s: f64) -> AircraftState {
        self.traffic
            .get(index)
            .map_or_else(AircraftState::default, |seen| {
                self.state_after(seen, after_s)
            })
    }
}

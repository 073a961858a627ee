//! Warnings about usable files: what they say is probably not what they mean. Each is one sentence.
//!
//! Each check needs keys of several tables, or of several files, so that no single value is wrong.

use fga::Vec3;
use fga::avoider::Settings;
use fga::certificate::Line;
use fga::situation::ProtectedVolume;
use fga::vehicle::Vehicle;
use fga_files::surveillance::{CREWED_MPS, Evasion};
use fga_formats::error::legible;
use fga_formats::geodesy::{Geodetic, LocalFrame};
use fga_formats::words::counted;

use super::Plan;
use crate::engine::{Engine, Observer, Sample};
use crate::policy::PolicyChoice;
use crate::progress::progress_of;
use crate::sensor::SensorSettings;
use crate::vehicle_file::VehicleModel;
use crate::wind::crab;
use crate::world::{Ending, World, WorldZone};

/// A place nearer to the origin is not suspected of exchanged coordinates, metres.
const NEAR_M: f64 = 100e3;
/// Exchanged coordinates bring a place nearer to the origin by this factor at least.
const MUCH_NEARER: f64 = 10.0;

/// What is nearer to a limit or a zone is not known to be beyond it, metres.
const KNOWN_M: f64 = 0.1;

/// The least margin so far, metres, and its time, seconds.
struct Deepest(f64, f64);

impl Deepest {
    const NONE: Self = Self(-KNOWN_M, 0.0);

    fn note(&mut self, margin_m: f64, at_s: f64) {
        if margin_m < self.0 {
            *self = Self(margin_m, at_s);
        }
    }
}

/// How far a flight comes to the wrong side of some zones and of the limits of altitude, and how much too low over ground.
struct Overshoot<'a> {
    world: &'a World,
    zones: Vec<(&'a WorldZone, Deepest)>,
    limits: Deepest,
    ground: Deepest,
}

impl Observer for Overshoot<'_> {
    fn sample(&mut self, sample: &Sample) {
        let (at_m, at_s) = (sample.position_m, sample.time_s);
        for (zone, worst) in &mut self.zones {
            worst.note(zone.margin_m(at_m), at_s);
        }
        let (floor_m, ceiling_m) = self.world.limits_m;
        self.limits
            .note((at_m.z - floor_m).min(ceiling_m - at_m.z), at_s);
        let ground = self.world.ground.as_ref();
        let above_m = ground.and_then(|ground| {
            Some(ground.above_m(at_m)? - ground.clearance_m() - ground.error_m())
        });
        self.ground.note(above_m.unwrap_or(0.0), at_s);
    }
}

impl Plan {
    /// Warnings about the flight, the gravest first; empty for most files.
    pub fn warnings(&self) -> Vec<String> {
        let world = &self.world;
        let mut warnings = Vec::new();
        warnings.extend(self.refusal());
        warnings.extend(self.notes.iter().cloned());
        // A recorded aircraft flew what it flew.
        if world.recorded.is_none() {
            warnings.extend(unflyable(world));
            warnings.extend(self.covered());
            warnings.extend(self.absent());
            warnings.extend(self.passed_aside());
            warnings.extend(self.crossed());
            let (beyond, low) = (self.beyond_limits(), self.low());
            let overshot = self.overshot(beyond.is_none(), low.is_empty());
            warnings.extend(beyond);
            warnings.extend(overshot);
            warnings.extend(self.distant());
            warnings.extend(low);
        }
        warnings.extend(self.unseen());
        warnings.iter().map(|warning| legible(warning)).collect()
    }

    /// Why the flight is not flown though each key is right: a place whose latitude and longitude seem to be exchanged.
    pub fn refusal(&self) -> Option<String> {
        let frame = self.frame.as_ref()?;
        let places = self.world.mission_m.iter().zip(1..);
        let waypoints = places.map(|(at_m, number)| (format!("waypoint {number}"), *at_m));
        let obstacles = self.names.iter().zip(&self.world.obstacles);
        let obstacles = obstacles.filter_map(|(name, each)| {
            let begins_s = each.track.presence_s().0.max(0.0);
            Some((name.clone(), each.track.at(begins_s)?.0))
        });
        let zones = self.world.zones.iter().filter_map(|zone| {
            let corner_m = zone.ring_m().first()?.extend(0.0);
            Some((zone.name().to_owned(), corner_m))
        });
        let mut places = waypoints.chain(obstacles).chain(zones);
        places.find_map(|(name, at_m)| {
            let away_m = at_m.truncate().length();
            let exchanged_m = exchanged_m(frame, frame.to_geodetic(at_m))?;
            (away_m > NEAR_M && exchanged_m * MUCH_NEARER < away_m).then(|| {
                format!(
                    "{name} is {:.0} km from the origin, with latitude and longitude exchanged it would be {:.1} km: \
                     expected the latitude first here, the longitude first in a file of areas",
                    away_m / 1e3,
                    exchanged_m / 1e3
                )
            })
        })
    }

    /// A waypoint inside the volume of an obstacle at rest.
    fn covered(&self) -> Option<String> {
        let world = &self.world;
        let obstacles = self.names.iter().zip(&world.obstacles);
        obstacles
            .filter(|(_, each)| each.track.speed_bound_mps() == Some(0.0))
            .find_map(|(name, each)| {
                let (at_m, _) = each.track.at(each.track.presence_s().0.max(0.0))?;
                let inside = |place_m: &Vec3| each.volume.margin_m(*place_m - at_m) < 0.0;
                let index = world.mission_m.iter().position(inside)?;
                Some(format!(
                    "waypoint {} lies inside the protected volume of {name}: it cannot be reached",
                    index + 1
                ))
            })
    }

    /// The first waypoint that the aircraft passes farther away than its turn radius with nobody near.
    fn passed_aside(&self) -> Option<String> {
        let vehicle = &self.world.vehicle;
        let radius_m = vehicle.airspeed_mps / vehicle.course_rate_radps();
        let progress = progress_of(&self.world);
        let mut aside = progress.planned_m().zip(1..);
        let (aside_m, number) = aside.find(|(aside_m, _)| *aside_m > radius_m)?;
        Some(format!(
            "the aircraft passes waypoint {number} by {aside_m:.0} m with nobody near: it turns with a radius of {radius_m:.0} m at best, and \
             the legs there are too short for its turns or for its roll"
        ))
    }

    /// The zones that the mission itself is on the wrong side of.
    fn crossed(&self) -> impl Iterator<Item = String> {
        let (mission_m, start_m) = (&self.world.mission_m, self.world.start.position_m);
        self.world.zones.iter().filter_map(move |each| {
            let (zone, name) = (each.zone(), each.name());
            let (enters, on) = if each.keep_in() { ("leaves", "outside") } else { ("enters", "inside") };
            let mut legs = mission_m.windows(2);
            let leg = legs.position(|leg| zone.nearest_m(&Line::between(leg[0], leg[1]), 0.0) < 0.0);
            match leg {
                Some(index) => Some(format!(
                    "leg {} of the mission {enters} {name}: it is flown as it is given, and there the zone holds back no manoeuvre",
                    index + 1
                )),
                None if zone.is_entered(start_m) => {
                    Some(format!("the aircraft starts {on} {name}: it flies its mission as it is given"))
                }
                None => None,
            }
        })
    }

    /// The first leg of the mission beyond a limit of altitude.
    fn beyond_limits(&self) -> Option<String> {
        let (floor_m, ceiling_m) = self.world.limits_m;
        let beyond = |at_m: &Vec3| !(floor_m - KNOWN_M..=ceiling_m + KNOWN_M).contains(&at_m.z);
        let index = self.world.mission_m.iter().position(beyond)?;
        let at_m = self.world.mission_m[index].z;
        let (side, key, limit_m) = if at_m < floor_m {
            ("below", "floor_m", floor_m)
        } else {
            ("above", "ceiling_m", ceiling_m)
        };
        Some(format!(
            "waypoint {} at {at_m} m is {side} {key} of {limit_m} m: the mission is flown as it is given",
            index + 1
        ))
    }

    /// What the flown mission is on the wrong side of where its legs are not: a turn overshoots. `is_within`: the legs keep the limits of
    /// altitude; `is_high`: they are high enough over known ground.
    fn overshot(&self, is_within: bool, is_high: bool) -> Vec<String> {
        let is_clear = |zone: &&WorldZone| {
            let mut legs = self.world.mission_m.windows(2);
            legs.all(|leg| zone.zone().nearest_m(&Line::between(leg[0], leg[1]), 0.0) >= 0.0)
        };
        let zones: Vec<&WorldZone> = self.world.zones.iter().filter(is_clear).collect();
        let alone = World {
            obstacles: Vec::new(),
            ending: Ending::MissionFlown,
            ..self.world.clone()
        };
        let policy = PolicyChoice::Mission.pilot(&alone.settings, &alone.vehicle);
        let has_limits = self.world.limits_m != (f64::NEG_INFINITY, f64::INFINITY);
        let is_bound = !zones.is_empty() || has_limits || self.world.ground.is_some();
        let Some(mut pilot) = policy.ok().filter(|_| is_bound) else {
            return Vec::new();
        };
        let mut flown = Overshoot {
            world: &self.world,
            zones: zones
                .into_iter()
                .map(|zone| (zone, Deepest::NONE))
                .collect(),
            limits: Deepest::NONE,
            ground: Deepest::NONE,
        };
        Engine::new().fly(&alone, pilot.as_mut(), &mut flown);
        let zones = flown.zones.iter().map(|(zone, worst)| {
            let enters = if zone.keep_in() { "leaves" } else { "enters" };
            (format!("{enters} {}", zone.name()), worst)
        });
        let limits = is_within.then(|| ("passes a limit of altitude".to_owned(), &flown.limits));
        let ground = is_high.then(|| ("comes too low over the ground".to_owned(), &flown.ground));
        let overshot = zones
            .chain(limits)
            .chain(ground)
            .filter(|(_, worst)| worst.0 < -KNOWN_M);
        let sentences = overshot.map(|(what, Deepest(margin_m, at_s))| {
            format!(
                "a turn of the mission {what} by {:.1} m at {at_s:.1} s, where its legs do not: it is flown as it is given",
                -margin_m
            )
        });
        sentences.collect()
    }

    /// The lowest leg of the mission that is lower than it takes to clear the ground, and the first one over unknown ground; otherwise the
    /// start, where it is too low.
    fn low(&self) -> Vec<String> {
        let Some(ground) = &self.world.ground else {
            return Vec::new();
        };
        let needed_m = ground.clearance_m() + ground.error_m();
        let asked = format!(
            "expected at least {needed_m:.1} m above it, {:.1} m of clearance and {:.1} m of vertical error",
            ground.clearance_m(),
            ground.error_m()
        );
        let (mut low, mut warnings) = (Vec::new(), Vec::new());
        for (leg, number) in self.world.mission_m.windows(2).zip(1..) {
            let (above_m, is_known) = ground.along_m(leg[0], leg[1]);
            if above_m < needed_m {
                low.push((above_m, number));
            }
            if !is_known && warnings.is_empty() {
                warnings.push(format!(
                    "leg {number} of the mission is over unknown ground, expected files that know it: it is flown as it is given, and \
                     there unknown ground holds back no manoeuvre"
                ));
            }
        }
        low.sort_by(|(one_m, _), (other_m, _): &(f64, usize)| one_m.total_cmp(other_m));
        if let Some((above_m, number)) = low.first() {
            let count = low.len();
            let of = format!(", the lowest of {count} that are too low");
            let of = if count > 1 { &of } else { "" };
            warnings.push(format!(
                "leg {number} of the mission comes as low as {above_m:.1} m above the ground{of}, {asked}: it is flown as it is given, and \
                 there a manoeuvre may be as low"
            ));
        }
        let above_m = ground.above_m(self.world.start.position_m);
        if let Some(above_m) = above_m.filter(|above_m| *above_m < needed_m)
            && warnings.is_empty()
        {
            warnings.push(format!(
                "the aircraft starts {above_m:.1} m above the ground, {asked}: it flies its mission as it is given"
            ));
        }
        warnings
    }

    /// The zones that no flight comes near, as with the wrong hemisphere.
    fn distant(&self) -> Option<String> {
        let World {
            zones,
            vehicle,
            wind_mps,
            horizon_s,
            start,
            ..
        } = &self.world;
        let flies_m = (vehicle.airspeed_mps + wind_mps.length()) * horizon_s;
        let zones = zones.iter().filter(|zone| !zone.keep_in());
        let zones = zones.map(|zone| (zone.name(), zone.margin_m(start.position_m)));
        let mut zones = zones.filter(|(_, away_m)| *away_m > NEAR_M.max(flies_m));
        let (name, away_m) = zones.next()?;
        let more = match zones.count() {
            0 => String::new(),
            more => format!(", and {} with it", counted(more, "more zone")),
        };
        let away_km = away_m / 1e3;
        Some(format!(
            "{name} is {away_km:.0} km from the start, beyond all that the aircraft flies to{more}"
        ))
    }

    /// An obstacle that is there or known only after the flight.
    fn absent(&self) -> Option<String> {
        let end_s = self.world.horizon_s;
        let obstacles = self.names.iter().zip(&self.world.obstacles);
        obstacles
            .map(|(name, each)| (name, each.appears_s.max(each.track.presence_s().0)))
            .find(|(_, from_s)| *from_s > end_s)
            .map(|(name, from_s)| {
                format!("{name} appears at {from_s} s, after the flight: duration_s is {end_s}")
            })
    }

    /// The obstacle that is seen too late by the largest distance.
    fn unseen(&self) -> Option<String> {
        self.farthest()?.1
    }

    /// The distance at which the aircraft must see the obstacle that it must see first, metres; `None` without obstacles.
    pub fn must_see_m(&self) -> Option<f64> {
        Some(self.farthest()?.0)
    }

    /// The largest distance at which an obstacle must be seen, metres, and a warning if it is not.
    fn farthest(&self) -> Option<(f64, Option<String>)> {
        let world = &self.world;
        let own_mps = world.vehicle.airspeed_mps + world.wind_mps.length();
        let sight = Sight::of(&world.vehicle, &world.settings.avoider, &world.sensor);
        let warnings = self.names.iter().zip(&world.obstacles).map(|(name, each)| {
            let closing_mps = own_mps + each.track.speed_bound_mps().unwrap_or(0.0);
            sight.of_volume(each.volume, closing_mps, name)
        });
        warnings.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl VehicleModel {
    /// Warnings about the aircraft among crewed traffic.
    pub fn warnings(&self) -> Vec<String> {
        let warning = self.among_crewed().1;
        warning.iter().map(|warning| legible(warning)).collect()
    }

    /// The distance at which the aircraft must see crewed traffic that comes head-on, metres.
    pub fn must_see_m(&self) -> f64 {
        self.among_crewed().0
    }

    /// The distance at which crewed traffic must be seen, metres, and a warning if it is not.
    fn among_crewed(&self) -> (f64, Option<String>) {
        let closing_mps = self.vehicle.airspeed_mps + CREWED_MPS;
        let whom = format!("crewed traffic at {CREWED_MPS} m/s");
        let sight = Sight::of(&self.vehicle, &self.settings.avoider, &self.sensor);
        sight.of_volume(self.protection, closing_mps, &whom)
    }
}

/// What an aircraft sees, and how late.
struct Sight<'a> {
    vehicle: &'a Vehicle,
    settings: &'a Settings,
    sensor: &'a SensorSettings,
}

impl<'a> Sight<'a> {
    const fn of(vehicle: &'a Vehicle, settings: &'a Settings, sensor: &'a SensorSettings) -> Self {
        Self {
            vehicle,
            settings,
            sensor,
        }
    }

    /// The distance at which a volume must be seen, metres, and a warning if it is not.
    fn of_volume(
        &self,
        volume: ProtectedVolume,
        closing_mps: f64,
        whom: &str,
    ) -> (f64, Option<String>) {
        let (settings, sensor) = (self.settings, self.sensor);
        let evasion = Evasion {
            vehicle: *self.vehicle,
            late_s: settings.decision_period_s + sensor.update_period_s + sensor.delay_s,
            volume,
            margin_m: settings.margin_m,
        };
        let seen = if sensor.range_m < settings.surveillance_radius_m {
            ("range_m", sensor.range_m)
        } else {
            ("surveillance_radius_m", settings.surveillance_radius_m)
        };
        (
            evasion.needed_m(closing_mps),
            evasion.shortfall(seen, settings.horizon_s, closing_mps, whom),
        )
    }
}

/// Distance of a place from the origin with latitude and longitude exchanged, metres; `None` where that is no place.
fn exchanged_m(frame: &LocalFrame, place: Geodetic) -> Option<f64> {
    let place = Geodetic::new(place.longitude_deg, place.latitude_deg, place.altitude_m)?;
    Some(frame.to_local_m(place).truncate().length())
}

/// Why the mission cannot be flown: a wind, a climb, or the time.
fn unflyable(world: &World) -> Option<String> {
    let vehicle = &world.vehicle;
    let mut time_s = 0.0;
    let mut length_m = 0.0;
    let mut steep = None;
    for (pair, number) in world.mission_m.windows(2).zip(1..) {
        let &[from_m, to_m] = pair else { continue };
        let along = (to_m - from_m).normalize_or(Vec3::X);
        let Some((course_rad, climb_rad)) = crab(along, vehicle.airspeed_mps, world.wind_mps)
        else {
            return Some(format!(
                "leg {number} cannot be flown: the wind of {:.1} m/s is too strong for an airspeed of {} m/s",
                world.wind_mps.length(),
                vehicle.airspeed_mps
            ));
        };
        let air_mps = fga::angle::direction(course_rad, climb_rad) * vehicle.airspeed_mps;
        length_m += from_m.distance(to_m);
        time_s += from_m.distance(to_m) / (air_mps + world.wind_mps).dot(along);
        // A hundredth of a degree is rounding.
        let limits = vehicle.climb_min_rad - 2e-4..=vehicle.climb_max_rad + 2e-4;
        if steep.is_none() && !limits.contains(&climb_rad) {
            steep = Some(format!(
                "leg {number} cannot be flown: it needs a climb angle of {:.1} degrees, the vehicle has {:.1} to {:.1}",
                climb_rad.to_degrees(),
                vehicle.climb_min_rad.to_degrees(),
                vehicle.climb_max_rad.to_degrees()
            ));
        }
    }
    if time_s > world.horizon_s {
        return Some(format!(
            "the mission cannot be flown to its end: its {:.1} km take {time_s:.0} s at {} m/s, duration_s is {}",
            length_m / 1e3,
            vehicle.airspeed_mps,
            world.horizon_s
        ));
    }
    steep
}

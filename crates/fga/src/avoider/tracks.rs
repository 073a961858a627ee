//! The obstacles that matter for a decision, in a buffer of fixed size.

mod memory;

use core::f64::consts::TAU;

use self::memory::{Known, Memory, known_as};
use crate::Vec3;
use crate::avoider::Kept;
use crate::avoider::intruders::{Clearance, Freedom, MOTIONS, Motions, Trend};
use crate::certificate::{Hazard, Hazards, Line, MAX_HAZARDS, Rows};
use crate::limit::Limit as _;
use crate::meter::{COMPARED, MOTION, Meter};
use crate::prediction::Flyer;
use crate::situation::{Movement, Obstacle, Obstacles, ProtectedVolume, Situation};
use crate::zone::Zone;
use fga_proof::list::List;

/// Most obstacles of a decision: the most urgent ones.
pub const MAX_TRACKED: usize = MAX_HAZARDS;

/// A missing obstacle is extrapolated for this long, seconds.
const COASTED_S: f64 = 5.0;

/// Work for learning an obstacle's motion.
const LEARN_WORK: usize = 8;

/// Radius of a limit of altitude, metres: within some kilometres its surface is flat to a centimetre.
const FLAT_M: f64 = 1e9;

/// The centre of a limit of altitude lies on a grid, so that it stays from step to step, metres.
const FLAT_WITHIN_M: f64 = 1e4;

/// Zones are known at least this far beyond the flight of a full circle, metres: margins are capped there.
const ZONE_REACH_M: f64 = 1e3;

/// Most legs ahead that decide whether a zone binds.
const MAX_LEGS_AHEAD: usize = 16;

/// The plane that follows an aircraft out of a zone has this share of its speed, and begins so many turn radii behind it.
const OUT_SHARE: f64 = 0.9;
const TURNS_ROUND: f64 = 2.9;

/// An aircraft turns into a direction after this time, seconds, and so many time constants of its bank.
const DECIDES_S: f64 = 1.0;
const ROLLS: f64 = 3.0;

/// How near to the centre of a volume the aircraft may come again while leaving it, as a share of its offset.
const LEAVING_SHARE: f64 = 0.98;

/// The hazards of one step.
#[derive(Debug, Clone)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is an answer about the same step, and any of them may hold with any other"
)]
pub struct Tracks {
    /// Each obstacle's expected motion.
    hazards: Rows,
    /// The same obstacles as known, over the ground.
    obstacles: [Obstacle; MAX_TRACKED],
    /// The turn of each.
    trend: [Trend; MAX_TRACKED],
    /// The obstacles at the last two steps.
    memory: [Memory; 2],
    /// Index of the last step among the two.
    last: usize,
    /// What hazards there are: one for each, or on demand their possible motions.
    motions: Motions,
    /// Whether those are the possible motions.
    moving: bool,
    /// Number of aircraft among them.
    aircraft: usize,
    /// Where our aircraft was when their motions were asked for, metres.
    own_m: Vec3,
    /// Work for taking in the obstacles of this step.
    work: usize,
    /// The farthest hazard of a full set: its index and distance, metres.
    farthest: Option<(usize, f64)>,
    /// The distances of a full set, metres, once it has been asked for the farthest.
    distances_m: [f64; MAX_TRACKED],
    has_distances: bool,
    /// Obstacles within the surveillance radius.
    pub seen: u32,
    /// Unusable ones.
    pub unusable: u32,
    /// Whether the aircraft is inside a protected volume.
    pub inside: bool,
    /// Whether some obstacles found no room.
    pub overflow: bool,
    /// Whether any has an uncertainty.
    pub uncertain: bool,
}

impl Default for Tracks {
    fn default() -> Self {
        Self::new()
    }
}

impl Tracks {
    /// No obstacles.
    #[expect(
        clippy::large_stack_arrays,
        reason = "no allocation: the caller says where it lies"
    )]
    pub const fn new() -> Self {
        Self {
            hazards: Rows::new(Hazard::NONE),
            obstacles: [Known::NONE.obstacle; MAX_TRACKED],
            trend: [Trend::STRAIGHT; MAX_TRACKED],
            memory: [const { Memory::new(Known::NONE) }; 2],
            last: 0,
            motions: Motions::new(),
            moving: false,
            aircraft: 0,
            own_m: Vec3::ZERO,
            work: 0,
            farthest: None,
            distances_m: [0.0; MAX_TRACKED],
            has_distances: false,
            seen: 0,
            unusable: 0,
            inside: false,
            overflow: false,
            uncertain: false,
        }
    }

    /// Forgets the obstacles of this step.
    pub fn clear(&mut self) {
        self.hazards.clear();
        self.motions.clear();
        self.motions.hazards_mut().zones.clear(Vec3::ZERO, 0.0);
        self.moving = false;
        self.aircraft = 0;
        self.work = 0;
        (self.farthest, self.has_distances) = (None, false);
        (self.seen, self.unusable) = (0, 0);
        (self.inside, self.overflow, self.uncertain) = (false, false, false);
    }

    /// Also forgets the obstacles of earlier steps.
    pub fn forget(&mut self) {
        self.clear();
        for memory in &mut self.memory {
            memory.clear();
        }
    }

    /// The hazards.
    pub const fn hazards(&self) -> &Hazards {
        self.motions.hazards()
    }

    /// Whether any obstacle is an aircraft, which may depart from its expected motion.
    pub(super) const fn has_aircraft(&self) -> bool {
        self.aircraft > 0
    }

    /// The number of aircraft without room for their turns of a share of the bounds: they count as flying straight on.
    pub(super) fn straight_aircraft(&self, share: f64, meter: &Meter) -> u32 {
        let turning = self.turning(&|_| Freedom::Share(share), self.own_m, meter);
        let turning = turning.map_or(0, |(turning, ..)| turning);
        u32::try_from(self.aircraft - turning).unwrap_or(u32::MAX)
    }

    /// The aircraft with room for all their motions, the nearest ones: their number, the distance and place of the last, and the
    /// hazards left beside one for each other obstacle. `None` if the meter refuses work.
    fn turning(
        &self,
        freedom: &impl Fn(&Hazard) -> Freedom,
        own_m: Vec3,
        meter: &Meter,
    ) -> Option<(usize, (f64, usize), usize)> {
        let rows = &*self.hazards;
        let mut left = MAX_HAZARDS - rows.len();
        let mut last = (f64::NEG_INFINITY, 0);
        for turning in 0..self.aircraft {
            meter.take(rows.len() / 2).then_some(())?;
            let mut next = (f64::INFINITY, usize::MAX);
            let mut more = 0;
            let known = self.obstacles.iter().zip(&self.trend);
            for (place, (hazard, (known, trend))) in rows.iter().zip(known).enumerate() {
                let here = (hazard.margin_m(own_m, 0.0), place);
                if known.movement.bounds().is_some() && here > last && here < next {
                    next = here;
                    more = Motions::most(freedom(hazard), (known, *trend)) - 1;
                }
            }
            if more > left {
                return Some((turning, last, left));
            }
            (last, left) = (next, left - more);
        }
        Some((self.aircraft, last, left))
    }

    /// Whether every aircraft of some moves away from ours.
    pub(super) fn all_pass(&self, own_m: Vec3, own_mps: Vec3, of: impl Fn(u32) -> bool) -> bool {
        let rows = self.hazards.iter().zip(&self.obstacles);
        rows.filter(|(_, known)| known.movement.bounds().is_some() && of(known.id))
            .all(|(hazard, _)| (hazard.position_m - own_m).dot(hazard.velocity_mps - own_mps) > 0.0)
    }

    /// Replaces the hazards by the possible motions of aircraft; obstacles that keep their velocity stay the same. Some are
    /// missing if the meter refuses work.
    pub(super) fn withstand(
        &mut self,
        freedom: impl Fn(&Hazard) -> Freedom,
        own_m: Vec3,
        clearance: Clearance,
        meter: &Meter,
    ) {
        self.motions.clear();
        self.moving = true;
        self.own_m = own_m;
        let rows = &*self.hazards;
        if !meter.take(rows.len()) {
            return;
        }
        let Some((turning, last, left)) = self.turning(&freedom, own_m, meter) else {
            return;
        };
        let straight = usize::from(left >= rows.len() - turning);
        for (place, (hazard, (known, trend))) in rows
            .iter()
            .zip(self.obstacles.iter().zip(&self.trend))
            .enumerate()
        {
            let may_turn = turning > 0 && (hazard.margin_m(own_m, 0.0), place) <= last;
            let motions = if may_turn { MOTIONS } else { straight };
            let freedom = (freedom(hazard), clearance);
            let mut hazard = *hazard;
            if clearance.is_unproven && known.volume.margin_m(own_m - known.position_m) >= 0.0 {
                (hazard.volume, hazard.growth_mps) = (known.volume, 0.0);
            }
            let before = self.motions.hazards().rows().len();
            self.motions
                .add_aircraft(&hazard, (known, *trend), freedom, motions);
            let added = self.motions.hazards().rows().len() - before;
            if !meter.take(MOTION * added) {
                return;
            }
        }
    }

    /// The hazards are their expected motions again.
    pub(super) fn as_expected(&mut self) {
        if self.moving {
            self.moving = false;
            self.motions.clear();
            for (place, hazard) in self.hazards.iter().enumerate() {
                self.motions.hazards_mut().put(place, *hazard);
            }
        }
    }

    /// Whether there is any obstacle but the limits of altitude.
    pub(super) fn has_obstacles(&self) -> bool {
        let mut rows = self.hazards.iter();
        rows.any(|hazard| hazard.volume.radius_m() < FLAT_M)
    }

    /// Adds the altitudes between which the aircraft stays, metres: a floor and a ceiling are obstacles like any other, spheres so
    /// large that they are flat.
    pub(super) fn stay_between(&mut self, limits_m: [f64; 2], situation: &Situation<'_>) {
        let own_m = situation.ownship.position_m;
        for (side, limit_m) in [-1.0, 1.0].into_iter().zip(limits_m) {
            if !limit_m.is_finite() {
                continue;
            }
            let [x, y] =
                [own_m.x, own_m.y].map(|at_m| FLAT_WITHIN_M * libm::rint(at_m / FLAT_WITHIN_M));
            let volume = ProtectedVolume::Sphere { radius_m: FLAT_M };
            let limit = Obstacle {
                movement: Movement::AtRest,
                ..Obstacle::straight(
                    u32::MAX,
                    Vec3::new(x, y, limit_m + side * FLAT_M),
                    Vec3::ZERO,
                    volume,
                )
            };
            self.add_limit(&limit, f64::INFINITY, situation);
        }
    }

    /// Adds what is no obstacle but limits the flight, up to a moment, seconds, where there is room.
    fn add_limit(&mut self, limit: &Obstacle, until_s: f64, situation: &Situation<'_>) {
        let place = self.hazards.len();
        if let Some((known, trend)) = self.obstacles.get_mut(place).zip(self.trend.get_mut(place)) {
            (*known, *trend) = (*limit, Trend::STRAIGHT);
            let index = u32::try_from(place).unwrap_or(u32::MAX);
            let mut hazard = Hazard::new(index, limit, situation.wind_mps, 0.0);
            hazard.window_s.1 = until_s;
            self.hazards.put(place, hazard);
            self.motions.hazards_mut().put(place, hazard);
        }
    }

    /// Adds the zones of the mission, for the time of a full circle: so long the aircraft can turn back from a wall. One that the
    /// mission ahead is on the wrong side of within that time does not bind. Of one that the aircraft has entered, a plane follows
    /// it out.
    pub(super) fn add_zones(
        &mut self,
        leg: usize,
        (flyer, climb_limits_rad): (&Flyer, (f64, f64)),
        wanted_m: f64,
        situation: &Situation<'_>,
    ) {
        let (own_m, speed_mps) = (situation.ownship.position_m, flyer.airspeed_mps());
        let circle_s = TAU / flyer.course_rate_radps();
        let reach_m = circle_m(flyer, situation.wind_mps) + ZONE_REACH_M.max(2.0 * wanted_m);
        let ahead = mission_ahead(situation, leg, flyer);
        let zones = &mut self.motions.hazards_mut().zones;
        zones.clear(situation.wind_mps, circle_s);
        // A manoeuvre comes no nearer to any than the mission leads, or the aircraft is.
        let mut least_m = wanted_m;
        for zone in situation.mission.zones {
            self.work += zone.edges().count() * (2 + ahead.len());
            let of_mission_m = nearest_m(zone, &ahead, least_m);
            if of_mission_m < 0.0 {
                continue;
            }
            let of_own_m = zone.nearest_m(&Line::at(own_m), of_mission_m);
            if of_own_m < 0.0 {
                let (way_m, (low_rad, high_rad)) = (zone.way_out_m(own_m), climb_limits_rad);
                let climbs = libm::sin(if way_m.z > 0.0 { high_rad } else { -low_rad });
                let out_mps = OUT_SHARE * speed_mps * if way_m.z == 0.0 { 1.0 } else { climbs };
                let direction = way_m.normalize_or(Vec3::X);
                // Turning round to the way out takes the aircraft back by less.
                let rolls_s = DECIDES_S + ROLLS * flyer.bank_time_constant_s();
                let behind_m = TURNS_ROUND * flyer.turn_radius_m() + rolls_s * speed_mps + wanted_m;
                let center_m = own_m - direction * (FLAT_M + behind_m);
                let volume = ProtectedVolume::Sphere { radius_m: FLAT_M };
                let plane = Obstacle::straight(u32::MAX, center_m, direction * out_mps, volume);
                let out_s = (way_m.length() + behind_m + wanted_m) / out_mps;
                self.inside = true;
                self.add_limit(&plane, out_s, situation);
                continue;
            }
            least_m = of_own_m;
            if !self.motions.hazards_mut().zones.add(zone, (own_m, reach_m)) {
                self.overflow = true;
                return;
            }
        }
        if least_m < wanted_m {
            self.motions.hazards_mut().zones.spare_m = wanted_m - LEAVING_SHARE * least_m;
        }
    }

    /// Work for taking in the obstacles of this step.
    pub(super) const fn work(&self) -> usize {
        self.work
    }

    /// Takes the obstacles within the surveillance radius that the aircraft could meet within the horizon.
    pub fn load(
        &mut self,
        situation: &Situation<'_>,
        surveillance_radius_m: f64,
        horizon_s: f64,
        sigmas: f64,
    ) {
        self.clear();
        let limits = (surveillance_radius_m, horizon_s);
        match situation.obstacles {
            // Read in place.
            Obstacles::Rows(rows) => rows
                .iter()
                .for_each(|obstacle| self.consider(situation, obstacle, limits, sigmas)),
            Obstacles::Columns(_) => (situation.obstacles.iter())
                .for_each(|obstacle| self.consider(situation, &obstacle, limits, sigmas)),
        }
        self.complete(situation, limits, sigmas);
    }

    /// The same for kept obstacles, in place of those of the situation.
    pub(super) fn load_kept(
        &mut self,
        kept: &mut Kept<'_>,
        situation: &Situation<'_>,
        limits: (f64, f64),
        sigmas: f64,
    ) {
        self.clear();
        let others = kept.each_near(situation, limits, |obstacle| {
            self.consider(situation, obstacle, limits, sigmas);
        });
        self.seen = self.seen.saturating_add(others);
        self.complete(situation, limits, sigmas);
    }

    /// Adds those that are missing for a short time, and learns.
    fn complete(&mut self, situation: &Situation<'_>, limits: (f64, f64), sigmas: f64) {
        let heard = self.hazards.len();
        self.work += self.seen as usize / 2;
        // A missing one is extrapolated, for a limited time.
        let mut place = 0;
        while let Some(known) = self.remembered().get(place).copied() {
            place += 1;
            let missing_s = situation.time_s - known.heard_s;
            let missing = (0.0..=COASTED_S).contains(&missing_s) && {
                let mut rows = self.obstacles.iter().take(heard);
                !rows.any(|obstacle| obstacle.id == known.obstacle.id)
            };
            if missing && self.hazards.len() < MAX_TRACKED {
                self.consider(situation, &known.coasted(missing_s), limits, sigmas);
            }
        }
        self.learn(situation, heard);
        self.moving = true;
        self.as_expected();
    }

    /// The obstacles at the last step.
    fn remembered(&self) -> &Memory {
        let [one, other] = &self.memory;
        if self.last == 0 { one } else { other }
    }

    /// Learns the turns of the obstacles, and remembers them; the first `heard` were reported now.
    fn learn(&mut self, situation: &Situation<'_>, heard: usize) {
        let [one, other] = &mut self.memory;
        let (before, now) = if self.last == 0 {
            (one, other)
        } else {
            (other, one)
        };
        self.last = 1 - self.last;
        now.clear();
        let count = self.hazards.len();
        // Searches each among those of the last step, twice.
        self.work += count * (LEARN_WORK + before.len() / 16);
        let tracked = self.obstacles.iter().zip(&mut self.trend).take(count);
        for (place, (known, trend)) in tracked.enumerate() {
            let is_aircraft = known.movement.bounds().is_some();
            self.aircraft += usize::from(is_aircraft);
            let last = known_as(known.id, place, before);
            *trend = last.map_or_else(|| Trend::of(known), |last| last.trend);
            if let Some(last) = last.filter(|_| place >= heard) {
                now.push(last);
                continue;
            }
            // What keeps its velocity has no turn to learn.
            if let Some(last) = last.filter(|_| is_aircraft) {
                trend.learn(
                    last.obstacle.velocity_mps - situation.wind_mps,
                    known.velocity_mps - situation.wind_mps,
                    situation.time_s - last.heard_s,
                );
            }
            now.push(Known {
                obstacle: *known,
                heard_s: situation.time_s,
                trend: *trend,
            });
        }
    }

    fn consider(
        &mut self,
        situation: &Situation<'_>,
        obstacle: &Obstacle,
        (surveillance_radius_m, horizon_s): (f64, f64),
        sigmas: f64,
    ) {
        if !obstacle.is_valid() {
            self.unusable += 1;
            return;
        }
        let offset = obstacle.position_m - situation.ownship.position_m;
        if offset.length_squared() > surveillance_radius_m * surveillance_radius_m {
            return;
        }
        self.seen += 1;
        if !situation.is_out_of_reach(obstacle, horizon_s) {
            self.keep(situation, obstacle, sigmas);
        }
    }

    fn keep(&mut self, situation: &Situation<'_>, obstacle: &Obstacle, sigmas: f64) {
        let own = situation.ownship.position_m;
        let mut place = self.hazards.len();
        if place >= MAX_TRACKED {
            self.overflow = true;
            let new = Hazard::new(0, obstacle, situation.wind_mps, sigmas);
            let (index, distance_m) = self.farthest(own);
            if distance_m <= new.margin_m(own, 0.0) {
                return;
            }
            place = index;
            self.farthest = None;
        }
        let index = u32::try_from(place).unwrap_or(u32::MAX);
        let mut hazard = Hazard::new(index, obstacle, situation.wind_mps, sigmas);
        let offset_m = own - obstacle.position_m;
        if hazard.volume.margin_m(offset_m) < 0.0 {
            let is_inside = obstacle.volume.margin_m(offset_m) < 0.0;
            self.inside |= is_inside;
            if is_inside && hazard.is_cylinder() {
                hazard.allowed_depth_m = 0.0;
                let nearer_m = hazard.position_m + LEAVING_SHARE * offset_m;
                hazard.allowed_depth_m = -hazard.margin_m(nearer_m, 0.0);
            } else {
                hazard.volume = relaxed(&hazard.volume, &obstacle.volume, offset_m);
            }
        }
        if obstacle.movement == Movement::AtRest {
            hazard.velocity_mps = -situation.wind_mps;
        }
        if self.hazards.put(place, hazard)
            && let Some(known) = self.obstacles.get_mut(place)
        {
            *known = *obstacle;
        }
        if self.has_distances
            && let Some(distance_m) = self.distances_m.get_mut(place)
        {
            *distance_m = hazard.margin_m(own, 0.0);
        }
        let uncertainty = obstacle.uncertainty;
        self.uncertain |= uncertainty.position_m > 0.0 || uncertainty.velocity_mps > 0.0;
    }
}

impl Tracks {
    /// The index of the farthest hazard from the aircraft, and its distance, metres. The result is kept until
    /// that hazard is replaced.
    fn farthest(&mut self, own_m: Vec3) -> (usize, f64) {
        if let Some(known) = self.farthest {
            return known;
        }
        if !self.has_distances {
            self.has_distances = true;
            let rows = &*self.hazards;
            self.work += rows.len() / 2;
            for (slot, hazard) in self.distances_m.iter_mut().zip(rows) {
                *slot = hazard.margin_m(own_m, 0.0);
            }
        }
        self.work += MAX_TRACKED / COMPARED;
        let farthest = self
            .distances_m
            .iter()
            .copied()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f64::NEG_INFINITY));
        self.farthest = Some(farthest);
        farthest
    }
}

/// The lines of the mission from beside the aircraft on the leg that begins at a waypoint, for the way of a full circle.
fn mission_ahead(
    situation: &Situation<'_>,
    leg: usize,
    flyer: &Flyer,
) -> List<Line, MAX_LEGS_AHEAD> {
    let (waypoints_m, own_m) = (situation.mission.waypoints_m, situation.ownship.position_m);
    let mut left_m = circle_m(flyer, situation.wind_mps);
    let mut lines = List::new(Line::at(own_m));
    // After the last leg, where it ends.
    let leg = leg.min(waypoints_m.len().saturating_sub(2));
    for (place, end_m) in waypoints_m.iter().enumerate().skip(leg + 1) {
        let mut from_m = waypoints_m.get(place - 1).map_or(own_m, |from_m| *from_m);
        if lines.is_empty() {
            let along_m = *end_m - from_m;
            let flown_m2 = (own_m - from_m).dot(along_m);
            let share = flown_m2 / along_m.length_squared().max(f64::MIN_POSITIVE);
            from_m += along_m * share.limited(0.0, 1.0);
        }
        let rest_m = (*end_m - from_m).clamp_length_max(left_m);
        let has_room = lines.push(Line::between(from_m, from_m + rest_m)).is_some();
        left_m -= rest_m.length();
        if left_m <= 0.0 || !has_room {
            break;
        }
    }
    lines
}

/// The way over the ground in the time of a full circle, at most, metres.
fn circle_m(flyer: &Flyer, wind_mps: Vec3) -> f64 {
    TAU / flyer.course_rate_radps() * (flyer.airspeed_mps() + wind_mps.length())
}

/// The least distance of some lines from a zone, metres; at most a given one, and negative on the wrong side.
fn nearest_m(zone: &Zone<'_>, lines: &[Line], most_m: f64) -> f64 {
    let lines = lines.iter();
    lines.fold(most_m, |least_m, line| zone.nearest_m(line, least_m))
}

/// Whether the aircraft is on the wrong side of a zone that binds.
pub(super) fn has_entered(situation: &Situation<'_>, leg: usize, flyer: &Flyer) -> bool {
    let mut zones = situation.mission.zones.iter();
    zones.any(|zone| {
        zone.is_entered(situation.ownship.position_m)
            && nearest_m(zone, &mission_ahead(situation, leg, flyer), 0.0) >= 0.0
    })
}

/// A sphere around the aircraft, or a widened cylinder around it that it has not entered itself, shrunk so that
/// the aircraft is just outside: a manoeuvre certified against it leads out. While the aircraft is outside of the
/// volume itself, the result is at least as large as that one.
fn relaxed(widened: &ProtectedVolume, itself: &ProtectedVolume, offset_m: Vec3) -> ProtectedVolume {
    let (true_m, true_half_m) = (itself.radius_m(), itself.half_height_m());
    match *widened {
        ProtectedVolume::Sphere { .. } => {
            let distance_m = offset_m.length();
            let least_m = if distance_m >= true_m { true_m } else { 0.0 };
            ProtectedVolume::Sphere {
                radius_m: (LEAVING_SHARE * distance_m).max(least_m),
            }
        }
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let horizontal = libm::sqrt(offset_m.x * offset_m.x + offset_m.y * offset_m.y);
            let share = (horizontal / radius_m).max(offset_m.z.abs() / half_height_m);
            let mut radius_m = (LEAVING_SHARE * share * radius_m).max(true_m);
            let mut half_height_m = (LEAVING_SHARE * share * half_height_m).max(true_half_m);
            // Being beyond either of the two keeps it outside.
            if horizontal >= true_m {
                radius_m = radius_m.min(LEAVING_SHARE * horizontal).max(true_m);
            } else {
                let above_m = LEAVING_SHARE * offset_m.z.abs();
                half_height_m = half_height_m.min(above_m).max(true_half_m);
            }
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An earlier version used a volume smaller than the true one when the aircraft was outside of the volume
    /// itself but inside its widened one, near the surface.
    #[test]
    fn a_relaxed_volume_is_as_large_as_the_true_one_until_that_is_entered() {
        let places = [
            Vec3::new(30.1, 0.0, 0.0),
            Vec3::new(0.0, 31.0, 9.0),
            Vec3::new(3.0, 4.0, 10.05),
            Vec3::new(29.0, 0.0, 11.0),
            Vec3::new(38.0, 0.0, 9.9),
        ];
        let cylinder = ProtectedVolume::Cylinder {
            radius_m: 30.0,
            half_height_m: 10.0,
        };
        let sphere = ProtectedVolume::Sphere { radius_m: 30.0 };
        for offset_m in places {
            for itself in [cylinder, sphere] {
                let widened = itself.grown(12.0);
                if itself.margin_m(offset_m) < 0.0 || widened.margin_m(offset_m) >= 0.0 {
                    continue;
                }
                let shrunk = relaxed(&widened, &itself, offset_m);
                assert!(shrunk.radius_m() >= itself.radius_m(), "{shrunk:?}");
                assert!(
                    shrunk.half_height_m() >= itself.half_height_m(),
                    "{shrunk:?}"
                );
                assert!(shrunk.margin_m(offset_m) >= 0.0, "{shrunk:?} {offset_m}");
            }
        }
    }

    /// In an earlier version some of more than sixty aircraft had no hazard at all.
    #[test]
    fn each_of_many_aircraft_keeps_a_hazard() {
        use crate::situation::{Mission, Obstacles, Ownship};
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        for count in [1_u32, 6, 7, 50, 62, 64, 107, 108, 128] {
            let rows: alloc::vec::Vec<Obstacle> = (0..count)
                .map(|id| Obstacle {
                    movement: Movement::CREWED,
                    // Pairs at one distance.
                    ..Obstacle::straight(
                        id,
                        Vec3::new(300.0 + f64::from(id / 2), 0.0, 0.0),
                        Vec3::new(-40.0, 0.0, 0.0),
                        volume,
                    )
                })
                .collect();
            let situation = Situation {
                time_s: 0.0,
                ownship: Ownship {
                    position_m: Vec3::ZERO,
                    course_rad: 0.0,
                    climb_rad: 0.0,
                    bank_rad: 0.0,
                    airspeed_mps: 20.0,
                },
                obstacles: Obstacles::Rows(&rows),
                mission: Mission::new(&[]),
                wind_mps: Vec3::ZERO,
            };
            let mut tracks = Tracks::new();
            tracks.load(&situation, f64::INFINITY, 60.0, 3.0);
            let exact = Clearance {
                beyond_m: 0.0,
                margin_m: 0.0,
                is_unproven: false,
            };
            let meter = Meter::unlimited();
            tracks.withstand(|_| Freedom::Share(1.0), Vec3::ZERO, exact, &meter);
            for id in 0..count {
                let has = tracks.hazards().rows().iter().any(|hazard| hazard.id == id);
                assert!(has, "{id} of {count}");
            }
            // The nearest may turn.
            let of_first = tracks.hazards().rows().iter().filter(|h| h.id == 0);
            assert!(of_first.count() > 2 || count > 107, "{count}");
        }
    }
}

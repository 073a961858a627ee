//! The obstacles that matter for a decision, in a buffer of fixed size.

mod known;
mod places;
pub(super) mod zones;

pub use self::known::Known;
pub use self::places::{AllPlaces, LIMITS, Lent, MAX_TRACKED, Places};
use crate::Vec3;
use crate::assumptions::{Assumptions, MAX_HAZARDS, Viewpoint};
use crate::avoider::intruders::{
    AT_ONCE, Clearance, Freedom, MOTIONS, Trend, add_aircraft, most_hazards,
};
use crate::avoider::{Against, Kept};
use crate::certificate::{Hazard, Zones};
use crate::meter::{COMPARED, Meter};
use crate::situation::{
    Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation,
};

/// A missing obstacle is extrapolated for this long, seconds.
const COASTED_S: f64 = 5.0;

/// Work for learning an obstacle's motion.
const LEARN_WORK: usize = 8;

/// Work for making the hazard of a motion.
const MOTION: usize = 4;

/// Radius of a limit of altitude, metres: within some kilometres its surface is flat to a centimetre.
const FLAT_M: f64 = 1e9;

/// The centre of a limit of altitude lies on a grid, so that it stays from step to step, metres.
const FLAT_WITHIN_M: f64 = 1e4;

/// Identifier of a limit of altitude, and of a plane that leads out of a zone.
pub const LIMIT_ID: u32 = u32::MAX;

/// The hazards of one step.
#[derive(Debug, Clone)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is an answer about the same step, and any of them may hold with any other"
)]
pub struct Tracks<P: ?Sized = AllPlaces> {
    /// The zones near the aircraft.
    zones: Zones,
    /// Number of hazards.
    hazards: usize,
    /// Whether they are all motions that were asked for, not the expected motion of each obstacle.
    moving: bool,
    /// Number of obstacles of this step.
    count: usize,
    /// Number of all that the next step remembers: the limits of altitude are not among them.
    len: usize,
    /// Number of aircraft among them.
    pub aircraft: usize,
    /// When they are seen, seconds, and from where.
    time_s: f64,
    seen_from: Viewpoint,
    /// Work for taking in the obstacles of this step.
    pub(super) work: usize,
    /// The farthest hazard of a full set: its index and distance, metres.
    farthest: Option<(usize, f64)>,
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
    /// Whether any is new, or has another velocity than in the last step.
    pub changed: bool,
    /// The obstacles of this step, and behind them those of the last one of which nothing is heard yet; the hazards.
    places: P,
}

/// The aircraft that have room for their motions, the nearest ones.
struct Turning {
    /// The number of motions of each, at most.
    motions: usize,
    /// Their number.
    aircraft: usize,
    /// Distance and place of the last one, metres.
    last: (f64, usize),
    /// The hazards left beside one for each other obstacle.
    left: usize,
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
        Self::within(([Known::NONE; MAX_HAZARDS], [Hazard::NONE; MAX_HAZARDS]))
    }
}

impl<P: Places> Tracks<P> {
    /// No obstacles, with room for some.
    pub const fn within(places: P) -> Self {
        Self {
            zones: Zones::NONE,
            hazards: 0,
            moving: false,
            count: 0,
            len: 0,
            aircraft: 0,
            time_s: 0.0,
            seen_from: Viewpoint {
                own_m: Vec3::ZERO,
                wind_mps: Vec3::ZERO,
                sigmas: 0.0,
            },
            work: 0,
            // Of none; `None` would leave bytes unsaid, and the zones beside them would be copied.
            farthest: Some((0, f64::NEG_INFINITY)),
            seen: 0,
            unusable: 0,
            inside: false,
            overflow: false,
            uncertain: false,
            changed: false,
            places,
        }
    }
}

impl<P: Places + ?Sized> Tracks<P> {
    /// Forgets the obstacles of this step.
    pub fn clear(&mut self) {
        self.hazards = 0;
        self.zones.clear(Vec3::ZERO, 0.0);
        self.moving = false;
        (self.count, self.aircraft, self.work) = (0, 0, 0);
        self.farthest = None;
        (self.seen, self.unusable) = (0, 0);
        (self.inside, self.overflow, self.uncertain, self.changed) = (false, false, false, false);
    }

    /// Also forgets the obstacles of earlier steps.
    pub fn forget(&mut self) {
        self.clear();
        self.len = 0;
    }

    /// The hazards one by one.
    pub fn rows(&self) -> &[Hazard] {
        self.places.all().1.get(..self.hazards).unwrap_or(&[])
    }

    /// The hazards, and what the mission has of zones and ground.
    pub(super) fn around<'a>(&'a self, mission: &'a Mission<'a>) -> Assumptions<'a> {
        Assumptions::new(self.rows(), &self.zones, mission)
    }

    /// All places of obstacles.
    fn all_known(&self) -> &[Known] {
        self.places.all().0
    }

    /// Puts a hazard at an index: replaces one, or appends behind the last one.
    fn put_hazard(&mut self, place: usize, hazard: Hazard) {
        let slot = self.places.all_mut().1.get_mut(place);
        if let Some(slot) = slot.filter(|_| place <= self.hazards) {
            *slot = hazard;
            self.hazards = self.hazards.max(place + 1);
        }
    }

    /// The obstacles of this step as last heard of.
    fn known(&self) -> &[Known] {
        self.all_known().get(..self.count).unwrap_or(&[])
    }

    /// An obstacle of this step.
    #[inline(never)]
    fn obstacle(&self, place: usize) -> Option<Known> {
        let known = self.known().get(place)?;
        let missing_s = self.time_s - known.heard_s;
        Some(Known {
            obstacle: known.coasted(missing_s),
            ..*known
        })
    }

    /// Whether any obstacle is an aircraft, which may depart from its expected motion.
    pub(super) const fn has_aircraft(&self) -> bool {
        self.aircraft > 0
    }

    /// The number of aircraft without room for their turns of a share of the bounds: they count as flying straight on.
    pub(super) fn straight_aircraft(&self, share: f64, meter: &Meter) -> u32 {
        let turning = self.turning(&|_| Freedom::Share(share, 0.0), meter);
        let turning = turning.map_or(0, |turning| turning.aircraft);
        u32::try_from(self.aircraft - turning).unwrap_or(u32::MAX)
    }

    /// The nearest aircraft, with room for all their motions where every aircraft has it, otherwise for those that begin at once. `None` if
    /// the meter refuses work.
    fn turning(&self, freedom: &dyn Fn(&Hazard) -> Freedom, meter: &Meter) -> Option<Turning> {
        let all = self.turning_by(MOTIONS, freedom, meter)?;
        if all.aircraft == self.aircraft {
            return Some(all);
        }
        self.turning_by(AT_ONCE, freedom, meter)
    }

    /// The nearest aircraft with room for some motions.
    fn turning_by(
        &self,
        motions: usize,
        freedom: &dyn Fn(&Hazard) -> Freedom,
        meter: &Meter,
    ) -> Option<Turning> {
        let mut turning = Turning {
            motions,
            aircraft: 0,
            last: (f64::NEG_INFINITY, 0),
            left: self.places.all().1.len().saturating_sub(self.count),
        };
        while turning.aircraft < self.aircraft {
            meter.take(self.count / 2).then_some(())?;
            let mut next = (f64::INFINITY, usize::MAX);
            for (place, known) in self.known().iter().enumerate() {
                let here = (known.distance_m, place);
                let may_turn = known.obstacle.movement.bounds().is_some();
                if may_turn && here > turning.last && here < next {
                    next = here;
                }
            }
            let Some(known) = self.obstacle(next.1) else {
                break;
            };
            let hazard = Hazard::seen(&known.obstacle, &self.seen_from, known.until_s);
            let of = (&known.obstacle, known.trend);
            let more = most_hazards(freedom(&hazard), of, motions) - 1;
            if more > turning.left {
                break;
            }
            turning.aircraft += 1;
            turning.last = next;
            turning.left -= more;
        }
        Some(turning)
    }

    /// Whether every aircraft of an encounter moves away from ours.
    pub(super) fn all_pass(&self, own: &Ownship, against: &Against) -> bool {
        (0..self.count)
            .filter_map(|place| self.obstacle(place))
            .map(|known| known.obstacle)
            .filter(|known| known.movement.bounds().is_some() && against.contains(known.id))
            .all(|known| {
                let velocity_mps = known.velocity_mps - self.seen_from.wind_mps;
                (known.position_m - own.position_m).dot(velocity_mps - own.velocity_mps()) > 0.0
            })
    }

    /// Replaces the hazards by the possible motions of aircraft; obstacles that keep their velocity stay the same. Some are
    /// missing if the meter refuses work.
    pub(super) fn withstand(
        &mut self,
        freedom: &dyn Fn(&Hazard) -> Freedom,
        clearance: Clearance,
        meter: &Meter,
    ) {
        self.hazards = 0;
        self.moving = true;
        if !meter.take(self.count) {
            return;
        }
        let Some(turning) = self.turning(freedom, meter) else {
            return;
        };
        let straight = usize::from(turning.left >= self.count - turning.aircraft);
        let own_m = self.seen_from.own_m;
        for place in 0..self.count {
            let Some(tracked) = self.obstacle(place) else {
                return;
            };
            let (known, trend) = (tracked.obstacle, tracked.trend);
            let may_turn = turning.aircraft > 0 && (tracked.distance_m, place) <= turning.last;
            let motions = if may_turn { turning.motions } else { straight };
            let mut hazard = Hazard::seen(&known, &self.seen_from, tracked.until_s);
            let asked = (freedom(&hazard), clearance);
            if clearance.is_unproven && known.volume.margin_m(own_m - known.position_m) >= 0.0 {
                let exactly = Viewpoint {
                    sigmas: 0.0,
                    ..self.seen_from
                };
                hazard = Hazard::seen(&known, &exactly, tracked.until_s);
            }
            let before = self.hazards;
            let mut add = |hazard| self.put_hazard(self.hazards, hazard);
            add_aircraft(&mut add, &hazard, (&known, trend), asked, motions);
            let added = self.hazards - before;
            if !meter.take(MOTION * added) {
                return;
            }
        }
    }

    /// The hazards are their expected motions again.
    pub(super) fn as_expected(&mut self) {
        if !self.moving {
            return;
        }
        self.moving = false;
        self.hazards = 0;
        for place in 0..self.count {
            if let Some(known) = self.obstacle(place) {
                let hazard = Hazard::seen(&known.obstacle, &self.seen_from, known.until_s);
                self.put_hazard(place, hazard);
            }
        }
    }

    /// The hazards that are obstacles: without limits of altitude and planes that lead out of a zone.
    pub(super) fn obstacles(&self) -> impl Iterator<Item = &Hazard> {
        self.rows().iter().filter(|hazard| !is_limit(hazard))
    }

    /// The others.
    pub(super) fn limits(&self) -> impl Iterator<Item = &Hazard> {
        self.rows().iter().filter(|hazard| is_limit(hazard))
    }

    /// Whether zones are near.
    pub(super) fn has_zones(&self) -> bool {
        !self.zones.is_empty()
    }

    /// How long zones and ground count, seconds.
    pub(super) const fn walls_s(&self) -> f64 {
        self.zones.until_s
    }

    /// Zones and ground count up to another moment, seconds; returns the one before.
    pub(super) const fn until(&mut self, until_s: f64) -> f64 {
        core::mem::replace(&mut self.zones.until_s, until_s)
    }

    /// Adds the altitudes between which the aircraft stays, metres: a floor and a ceiling are obstacles like any other, spheres so
    /// large that they are flat.
    pub(super) fn stay_between(&mut self, limits_m: [f64; 2]) {
        let own_m = self.seen_from.own_m;
        for (side, limit_m) in [-1.0, 1.0].into_iter().zip(limits_m) {
            if !limit_m.is_finite() {
                continue;
            }
            let [x, y] =
                [own_m.x, own_m.y].map(|at_m| FLAT_WITHIN_M * libm::rint(at_m / FLAT_WITHIN_M));
            let volume = ProtectedVolume::Sphere { radius_m: FLAT_M };
            let centre_m = Vec3::new(x, y, limit_m + side * FLAT_M);
            let limit = Obstacle {
                movement: Movement::AtRest,
                ..Obstacle::straight(LIMIT_ID, centre_m, Vec3::ZERO, volume)
            };
            self.add_limit(&limit, f64::INFINITY);
        }
    }

    /// Adds what is no obstacle but limits the flight, up to a moment, seconds; false where there is no room.
    fn add_limit(&mut self, limit: &Obstacle, until_s: f64) -> bool {
        let has_room = self.count < self.all_known().len();
        if has_room {
            let known = Known {
                obstacle: *limit,
                heard_s: self.time_s,
                until_s,
                ..Known::NONE
            };
            self.put(self.count, limit, known);
        }
        has_room
    }

    /// Takes the obstacles within the surveillance radius that the aircraft could meet within the horizon.
    pub fn load(
        &mut self,
        situation: &Situation<'_>,
        surveillance_radius_m: f64,
        horizon_s: f64,
        sigmas: f64,
    ) {
        let before = self.begin(situation, sigmas);
        let limits = (surveillance_radius_m, horizon_s);
        match situation.obstacles {
            // Read in place.
            Obstacles::Rows(rows) => rows
                .iter()
                .for_each(|obstacle| self.consider(situation, obstacle, limits)),
            Obstacles::Columns(_) => (situation.obstacles.iter())
                .for_each(|obstacle| self.consider(situation, &obstacle, limits)),
        }
        self.complete(situation, limits, before);
    }

    /// The same for kept obstacles, in place of those of the situation.
    pub(super) fn load_kept(
        &mut self,
        kept: &mut Kept<'_>,
        situation: &Situation<'_>,
        limits: (f64, f64),
        sigmas: f64,
    ) {
        let before = self.begin(situation, sigmas);
        let others = kept.for_each_near(situation, limits, |obstacle| {
            self.consider(situation, obstacle, limits);
        });
        self.seen = self.seen.saturating_add(others);
        self.complete(situation, limits, before);
    }

    /// Begins a step; returns the number of obstacles of the last one.
    fn begin(&mut self, situation: &Situation<'_>, sigmas: f64) -> usize {
        self.clear();
        self.time_s = situation.time_s;
        self.seen_from = Viewpoint {
            own_m: situation.ownship.position_m,
            wind_mps: situation.wind_mps,
            sigmas,
        };
        self.len
    }

    /// Adds those that are missing, extrapolated for a short time.
    fn complete(&mut self, situation: &Situation<'_>, limits: (f64, f64), before: usize) {
        self.work += self.seen as usize / 2;
        for place in self.count..self.len {
            let Some(last) = self.all_known().get(place).copied() else {
                break;
            };
            let missing_s = situation.time_s - last.heard_s;
            let seen = last.coasted(missing_s);
            if (0.0..=COASTED_S).contains(&missing_s) && self.is_near(situation, &seen, limits) {
                self.put(self.count, &seen, last);
            }
        }
        self.len = self.count;
        let aircraft = |known: &&Known| known.obstacle.movement.bounds().is_some();
        self.aircraft = self.known().iter().filter(aircraft).count();
        // Searches each among those of the last step, twice.
        self.work += self.count * (LEARN_WORK + before / 16);
    }

    /// Whether an obstacle is usable and may matter.
    fn is_near(
        &mut self,
        situation: &Situation<'_>,
        obstacle: &Obstacle,
        (surveillance_radius_m, horizon_s): (f64, f64),
    ) -> bool {
        if !obstacle.is_valid() {
            self.unusable += 1;
            return false;
        }
        let offset = obstacle.position_m - situation.ownship.position_m;
        if offset.length_squared() > surveillance_radius_m * surveillance_radius_m {
            return false;
        }
        self.seen += 1;
        if situation.is_out_of_reach(obstacle, horizon_s) {
            return false;
        }
        self.inside |= obstacle.volume.margin_m(-offset) < 0.0;
        let uncertainty = obstacle.uncertainty;
        self.uncertain |= uncertainty.position_m > 0.0 || uncertainty.velocity_mps > 0.0;
        true
    }

    /// Takes an obstacle that is heard of. It comes from behind, with its turn, or takes the place of the farthest one if there is no
    /// room.
    fn consider(&mut self, situation: &Situation<'_>, obstacle: &Obstacle, limits: (f64, f64)) {
        if !self.is_near(situation, obstacle, limits) {
            return;
        }
        let time_s = self.time_s;
        let Viewpoint {
            own_m,
            wind_mps,
            sigmas,
        } = self.seen_from;
        let mut known = Known {
            obstacle: *obstacle,
            heard_s: time_s,
            distance_m: 0.0,
            trend: Trend::of(obstacle),
            until_s: f64::INFINITY,
        };
        let mut place = self.count;
        let known_before = self.all_known().iter().take(self.len);
        let mut last = known_before.enumerate().skip(place);
        let mut changed = true;
        let from =
            if let Some((from, last)) = last.find(|(_, last)| last.obstacle.id == obstacle.id) {
                changed = last.obstacle.velocity_mps != obstacle.velocity_mps;
                known.trend = last.trend;
                // What keeps its velocity has no turn to learn.
                if obstacle.movement.bounds().is_some() {
                    known.trend.learn(
                        last.obstacle.velocity_mps - wind_mps,
                        obstacle.velocity_mps - wind_mps,
                        time_s - last.heard_s,
                    );
                }
                from
            } else if self.len + LIMITS < self.all_known().len() {
                self.len += 1;
                self.len - 1
            } else {
                let (farthest, distance_m) = self.farthest();
                let is_nearer =
                    distance_m > Hazard::new(obstacle, wind_mps, sigmas).margin_m(own_m, 0.0);
                self.overflow |= !is_nearer || farthest < place;
                if !is_nearer {
                    return;
                }
                place = place.min(farthest);
                farthest
            };
        self.changed |= changed;
        let mut moved = known;
        for slot in self
            .places
            .all_mut()
            .0
            .iter_mut()
            .take(from + 1)
            .skip(place)
        {
            core::mem::swap(slot, &mut moved);
        }
        self.put(place, obstacle, known);
    }

    /// Takes an obstacle at a place with its expected motion, and what is remembered of it.
    fn put(&mut self, place: usize, seen: &Obstacle, known: Known) {
        let hazard = Hazard::seen(seen, &self.seen_from, known.until_s);
        self.put_hazard(place, hazard);
        let own_m = self.seen_from.own_m;
        if let Some(slot) = self.places.all_mut().0.get_mut(place) {
            *slot = known;
            slot.distance_m = hazard.margin_m(own_m, 0.0);
            self.count = self.count.max(place + 1);
            self.farthest = None;
        }
    }

    /// The index of the farthest of all that are known, and its distance, metres. The result is kept until one is put.
    fn farthest(&mut self) -> (usize, f64) {
        if let Some(known) = self.farthest {
            return known;
        }
        if !self.overflow {
            self.work += MAX_TRACKED / 2;
        }
        self.work += MAX_TRACKED / COMPARED;
        let distances_m = self
            .all_known()
            .iter()
            .take(self.len)
            .map(|known| known.distance_m);
        let farthest = (distances_m.enumerate())
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f64::NEG_INFINITY));
        self.farthest = Some(farthest);
        farthest
    }
}

/// Whether a hazard is a limit of altitude, or a plane that leads out of a zone.
fn is_limit(hazard: &Hazard) -> bool {
    hazard.volume.radius_m() >= 0.5 * FLAT_M
}

#[cfg(test)]
mod tests;

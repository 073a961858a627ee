//! The obstacles that matter for a decision, in a buffer of fixed size.

use crate::Vec3;
use crate::avoider::intruders::{Freedom, Motions, Turning};
use crate::certificate::{Hazard, Hazards, MAX_HAZARDS};
use crate::situation::Situation;
use crate::situation::{Movement, Obstacle, ProtectedVolume};

/// Most obstacles that a decision takes into account: the most urgent ones.
pub const MAX_TRACKED: usize = MAX_HAZARDS;

/// For this long an obstacle that is missing is taken to fly on, seconds.
const COASTED_S: f64 = 2.0;

/// How far inside a volume the aircraft may come again while it leaves it, as a share of its depth.
const LEAVING_SHARE: f64 = 0.98;

/// What tells whether the obstacles still do what they did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Picture {
    count: usize,
    /// Sum of their velocities, metres per second.
    velocity_mps: Vec3,
}

impl Picture {
    /// Whether obstacles came, went, or turned, by more than the velocities are uncertain.
    pub(super) fn differs_from(&self, other: &Self) -> bool {
        let change_mps = (self.velocity_mps - other.velocity_mps).length();
        self.count != other.count || change_mps > NEWS_MPS
    }
}

/// A change of velocities by this is not noise, metres per second.
const NEWS_MPS: f64 = 3.0;

/// The hazards of one step.
#[derive(Debug, Clone)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is an answer about the same step, and any of them may hold with any other"
)]
pub struct Tracks {
    hazards: Hazards,
    /// The same obstacles as they are known, over the ground.
    obstacles: [Obstacle; MAX_TRACKED],
    /// How each of them turns.
    turning: [Turning; MAX_TRACKED],
    /// What was known at the last two steps.
    memory: [Memory; 2],
    /// Which of the two is of the last step.
    last: usize,
    /// What they may do, where that is asked for.
    motions: Motions,
    /// Whether `motions` take the place of the hazards.
    moving: bool,
    /// How many of them are flown.
    aircraft: usize,
    /// Obstacles within the surveillance radius.
    pub seen: u32,
    /// Whether the aircraft is inside a protected volume.
    pub inside: bool,
    /// Whether some could not be kept.
    pub overflow: bool,
    /// Whether any is known with an uncertainty only.
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
            hazards: Hazards::new(),
            obstacles: [Known::NONE.obstacle; MAX_TRACKED],
            turning: [Turning::STRAIGHT; MAX_TRACKED],
            memory: [Memory::NONE; 2],
            last: 0,
            motions: Motions::new(),
            moving: false,
            aircraft: 0,
            seen: 0,
            inside: false,
            overflow: false,
            uncertain: false,
        }
    }

    /// Forgets the obstacles of this step.
    pub fn clear(&mut self) {
        self.hazards.clear();
        self.motions.clear();
        self.moving = false;
        self.aircraft = 0;
        self.seen = 0;
        (self.inside, self.overflow, self.uncertain) = (false, false, false);
    }

    /// Forgets what was known at earlier steps too.
    pub fn forget(&mut self) {
        self.clear();
        for memory in &mut self.memory {
            memory.len = 0;
        }
    }

    /// The hazards.
    pub const fn hazards(&self) -> &Hazards {
        if self.moving {
            self.motions.hazards()
        } else {
            &self.hazards
        }
    }

    /// Whether any obstacle is flown, so that it may do something else than go on.
    pub(super) const fn has_aircraft(&self) -> bool {
        self.aircraft > 0
    }

    /// Whether every aircraft of some moves away from ours.
    pub(super) fn all_pass(&self, own_m: Vec3, own_mps: Vec3, of: impl Fn(u32) -> bool) -> bool {
        let rows = self.hazards.rows().iter().zip(&self.obstacles);
        rows.filter(|(_, known)| known.movement.bounds().is_some() && of(known.id))
            .all(|(hazard, _)| (hazard.position_m - own_m).dot(hazard.velocity_mps - own_mps) > 0.0)
    }

    /// Makes the hazards those of what aircraft may do; obstacles that keep their velocity stay what
    /// they are.
    pub(super) fn withstand(&mut self, freedom: Freedom, own_m: Vec3) {
        self.withstand_by(freedom, own_m, 0.0);
    }

    /// The same, and that much beyond the volumes of aircraft, metres.
    pub(super) fn withstand_by(&mut self, freedom: Freedom, own_m: Vec3, beyond_m: f64) {
        self.motions.clear();
        self.moving = true;
        let rows = self.hazards.rows();
        let room = Motions::room_for(rows.len());
        // Where there is no room for all, the nearest ones may turn.
        let mut within_m = f64::INFINITY;
        if self.aircraft > room {
            let mut distances = [f64::INFINITY; MAX_TRACKED];
            for (slot, (hazard, known)) in
                distances.iter_mut().zip(rows.iter().zip(&self.obstacles))
            {
                if known.movement.bounds().is_some() {
                    *slot = hazard.margin_m(own_m, 0.0);
                }
            }
            // The largest one with fewer than `room` smaller ones; a sort could panic.
            let nearer = |than: &f64| distances.iter().filter(|other| *other < than).count();
            within_m = distances
                .iter()
                .filter(|distance| nearer(distance) < room)
                .copied()
                .fold(f64::NEG_INFINITY, f64::max);
        }
        for ((hazard, known), turning) in rows.iter().zip(&self.obstacles).zip(&self.turning) {
            let far = hazard.margin_m(own_m, 0.0) > within_m;
            self.motions
                .add_aircraft(hazard, (known, *turning), (freedom, beyond_m), far);
        }
    }

    /// The obstacles now, to be compared with later.
    pub(super) fn picture(&self) -> Picture {
        let rows = self.hazards.rows();
        Picture {
            count: rows.len(),
            velocity_mps: rows.iter().map(|hazard| hazard.velocity_mps).sum(),
        }
    }

    /// Takes the obstacles within the surveillance radius that could be met within the horizon.
    pub fn load(
        &mut self,
        situation: &Situation<'_>,
        surveillance_radius_m: f64,
        horizon_s: f64,
        sigmas: f64,
    ) {
        self.clear();
        let limits = (surveillance_radius_m, horizon_s);
        for obstacle in situation.obstacles.iter() {
            self.consider(situation, &obstacle, limits, sigmas);
        }
        let heard = self.hazards.rows().len();
        // One that is missing is where it was heading for, until it has been for long.
        let mut place = 0;
        while let Some(known) = self.remembered().known(place) {
            place += 1;
            let missing_s = situation.time_s - known.heard_s;
            let missing = (0.0..=COASTED_S).contains(&missing_s) && {
                let mut rows = self.obstacles.iter().take(heard);
                !rows.any(|obstacle| obstacle.id == known.obstacle.id)
            };
            if missing && self.hazards.rows().len() < MAX_TRACKED {
                self.consider(situation, &known.coasted(missing_s), limits, sigmas);
            }
        }
        self.learn(situation, heard);
    }

    /// What was known at the last step.
    fn remembered(&self) -> &Memory {
        let [one, other] = &self.memory;
        if self.last == 0 { one } else { other }
    }

    /// Learns how the obstacles turn, and remembers them; the first `heard` of them were reported now.
    fn learn(&mut self, situation: &Situation<'_>, heard: usize) {
        let [one, other] = &mut self.memory;
        let (before, now) = if self.last == 0 {
            (one, other)
        } else {
            (other, one)
        };
        self.last = 1 - self.last;
        now.len = 0;
        let count = self.hazards.rows().len();
        let tracked = self.obstacles.iter().zip(&mut self.turning).take(count);
        for (place, (known, turning)) in tracked.enumerate() {
            self.aircraft += usize::from(known.movement.bounds().is_some());
            let last = before.of(known.id, place);
            *turning = last.map_or(Turning::STRAIGHT, |last| last.turning);
            if let Some(last) = last.filter(|_| place >= heard) {
                now.add(last);
                continue;
            }
            if let Some(last) = last {
                turning.learn(
                    last.obstacle.velocity_mps - situation.wind_mps,
                    known.velocity_mps - situation.wind_mps,
                    situation.time_s - last.heard_s,
                );
            }
            now.add(Known {
                obstacle: *known,
                heard_s: situation.time_s,
                turning: *turning,
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
        let mut place = self.hazards.rows().len();
        if place >= MAX_TRACKED {
            self.overflow = true;
            let urgency = |hazard: &Hazard| hazard.margin_m(own, 0.0);
            let new = Hazard::new(0, obstacle, situation.wind_mps, sigmas);
            let farthest = self
                .hazards
                .rows()
                .iter()
                .enumerate()
                .max_by(|a, b| urgency(a.1).total_cmp(&urgency(b.1)));
            match farthest {
                Some((index, hazard)) if urgency(hazard) > urgency(&new) => place = index,
                _ => return,
            }
        }
        let index = u32::try_from(place).unwrap_or(u32::MAX);
        let mut hazard = Hazard::new(index, obstacle, situation.wind_mps, sigmas);
        let depth_m = hazard.margin_m(own, 0.0);
        if depth_m < 0.0 {
            self.inside |= obstacle.volume.margin_m(own - obstacle.position_m) < 0.0;
            hazard.volume = relaxed(&hazard.volume, &obstacle.volume, own - obstacle.position_m);
        }
        if obstacle.movement == Movement::AtRest {
            hazard.velocity_mps = -situation.wind_mps;
        }
        if self.hazards.put(place, hazard)
            && let Some(known) = self.obstacles.get_mut(place)
        {
            *known = *obstacle;
        }
        let uncertainty = obstacle.uncertainty;
        self.uncertain |= uncertainty.position_m > 0.0 || uncertainty.velocity_mps > 0.0;
    }
}

/// Obstacles that were known at the last step.
#[derive(Debug, Clone)]
struct Memory {
    known: [Known; MAX_TRACKED],
    len: usize,
}

impl Memory {
    #[expect(
        clippy::large_stack_arrays,
        reason = "no allocation: the caller says where it lies"
    )]
    const NONE: Self = Self {
        known: [Known::NONE; MAX_TRACKED],
        len: 0,
    };

    fn known(&self, place: usize) -> Option<Known> {
        let known = self.known.get(..self.len)?;
        known.get(place).copied()
    }

    /// The obstacle with an identifier; it is most often in the same place as before.
    fn of(&self, id: u32, place: usize) -> Option<Known> {
        let is_it = |known: &Known| known.obstacle.id == id;
        self.known(place)
            .filter(is_it)
            .or_else(|| self.known.iter().take(self.len).copied().find(is_it))
    }

    fn add(&mut self, known: Known) {
        if let Some(slot) = self.known.get_mut(self.len) {
            *slot = known;
            self.len += 1;
        }
    }
}

/// An obstacle as it was last heard of, over the ground.
#[derive(Debug, Clone, Copy)]
struct Known {
    obstacle: Obstacle,
    heard_s: f64,
    turning: Turning,
}

impl Known {
    const NONE: Self = Self {
        obstacle: Obstacle::new(
            0,
            Vec3::ZERO,
            Vec3::ZERO,
            ProtectedVolume::Sphere { radius_m: 0.0 },
        ),
        heard_s: f64::NEG_INFINITY,
        turning: Turning::STRAIGHT,
    };

    /// Where it is when it was not heard of for a while: straight on, and within what its bounds allow.
    fn coasted(&self, missing_s: f64) -> Obstacle {
        let mut obstacle = self.obstacle;
        obstacle.position_m = obstacle.position_after_m(missing_s);
        if let Some(bounds) = obstacle.movement.bounds() {
            let speed_mps = obstacle.velocity_mps.length();
            let across_mps2 = speed_mps * bounds.turn_rate_radps;
            let change_mps2 = across_mps2.max(bounds.acceleration_mps2);
            obstacle.uncertainty.position_m += 0.5 * change_mps2 * missing_s * missing_s;
        }
        obstacle
    }
}

/// A widened volume that the aircraft is inside of, shrunk so that it is just outside: what is
/// certified against it leads out. While the aircraft is outside the volume itself, it stays as large as
/// that one.
fn relaxed(widened: &ProtectedVolume, itself: &ProtectedVolume, offset_m: Vec3) -> ProtectedVolume {
    let horizontal = libm::sqrt(offset_m.x * offset_m.x + offset_m.y * offset_m.y);
    let outside = itself.margin_m(offset_m) >= 0.0;
    match *widened {
        ProtectedVolume::Sphere { .. } => {
            let leaving_m = LEAVING_SHARE * offset_m.length();
            let least_m = if outside { itself.radius_m() } else { 0.0 };
            ProtectedVolume::Sphere {
                radius_m: leaving_m.max(least_m),
            }
        }
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let share = (horizontal / radius_m).max(offset_m.z.abs() / half_height_m);
            let mut radius_m = LEAVING_SHARE * share * radius_m;
            let mut half_height_m = LEAVING_SHARE * share * half_height_m;
            if outside {
                let (true_m, true_half_m) = (itself.radius_m(), itself.half_height_m());
                radius_m = radius_m.max(true_m);
                half_height_m = half_height_m.max(true_half_m);
                // Whichever of the two it is beyond keeps it outside.
                if horizontal >= true_m {
                    radius_m = radius_m.min(LEAVING_SHARE * horizontal).max(true_m);
                } else {
                    let above_m = LEAVING_SHARE * offset_m.z.abs();
                    half_height_m = half_height_m.min(above_m).max(true_half_m);
                }
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

    /// Outside the volume itself but within its widened one, the aircraft was shown a smaller volume
    /// than the true one when it was near the surface.
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
}

//! The aircraft that are known: reports in, a belief of each.

use fga_belief::{Belief, ENDS_AFTER_S, Errors, Report, Sigma, Source};
use fga_index::situation::{
    Movement, MovementBounds, Obstacle, ProtectedVolume, Situation, Uncertainty,
};
use fga_proof::Vec3;
use fga_proof::list::List;

/// Most aircraft that are known.
pub const MOST_KNOWN: usize = 16;

/// A report holds later than the last one if it is younger by more than this, seconds: between reports obstacles are carried on.
const LATER_S: f64 = 1e-6;

/// A report may be this much from the future, seconds, and somewhat more: clocks differ.
const EARLY_S: f64 = 1.5;

/// An aircraft that is known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known {
    id: u32,
    pub(crate) volume: ProtectedVolume,
    pub(crate) belief: Belief,
}

impl Known {
    /// Whether a situation has it.
    fn is_in(&self, situation: &Situation<'_>) -> bool {
        let mut obstacles = situation.obstacles.iter();
        obstacles.any(|obstacle| obstacle.id == self.id && obstacle.is_valid())
    }
}

/// The errors of a report with this uncertainty: its own σ in the place of one that is only assumed.
fn errors_of(uncertainty: Uncertainty, errors: &Errors) -> Errors {
    let sigma = |own: f64, known: Sigma| {
        if own > 0.0 && known.source == Source::Assumed {
            Sigma::new(own as f32, Source::Report)
        } else {
            known
        }
    };
    Errors {
        position_m: sigma(uncertainty.position_m, errors.position_m),
        altitude_m: sigma(uncertainty.position_m, errors.altitude_m),
        velocity_mps: sigma(uncertainty.velocity_mps, errors.velocity_mps),
        climb_mps: sigma(uncertainty.velocity_mps, errors.climb_mps),
        // NACp bounds the whole error (EPU of RTCA DO-260B) and does not say which part lasts: σ counts as noise and as lasting.
        lasting_position_m: sigma(uncertainty.position_m, errors.lasting_position_m),
        ..*errors
    }
}

/// The beliefs about all aircraft, in the order in which they were first heard.
#[derive(Debug, Clone)]
pub struct Beliefs {
    known: List<Option<Known>, MOST_KNOWN>,
    /// When an aircraft was last heard that found no room, seconds.
    left_out_s: f64,
}

impl Default for Beliefs {
    fn default() -> Self {
        Self::new()
    }
}

impl Beliefs {
    /// Of nobody.
    pub const fn new() -> Self {
        Self {
            known: List::new(None),
            left_out_s: f64::NEG_INFINITY,
        }
    }

    /// Forgets all.
    pub const fn forget(&mut self) {
        self.known.clear();
        self.left_out_s = f64::NEG_INFINITY;
    }

    /// Forgets the aircraft that a situation does not have.
    pub fn forget_absent(&mut self, situation: &Situation<'_>) {
        self.retain(|known| known.is_in(situation));
    }

    fn retain(&mut self, is_kept: impl Fn(&Known) -> bool) {
        for slot in self.known.iter_mut() {
            *slot = slot.filter(|known| is_kept(known));
        }
    }

    /// Whether nobody is known.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// The aircraft.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Known> {
        self.known.iter().flatten()
    }

    /// What is believed of each aircraft: its identifier, its volume, the belief.
    pub fn each(&self) -> impl Iterator<Item = (u32, ProtectedVolume, &Belief)> {
        let known = self.iter();
        known.map(|known| (known.id, known.volume, &known.belief))
    }

    /// Whether an aircraft may be around that found no room, farther away than all that are known.
    pub fn leaves_out(&self, time_s: f64) -> bool {
        time_s - self.left_out_s <= ENDS_AFTER_S
    }

    /// Takes the reports of aircraft, whose errors are these: whether there is a new one. A σ that these only assume gives way to that of
    /// the obstacle, where it has one. Obstacles are as reported, carried on along their velocities for their age; one that keeps its
    /// velocity by contract, or rests, is no aircraft.
    pub fn hear(&mut self, situation: &Situation<'_>, errors: &Errors) -> bool {
        let mut has_news = false;
        // A report from later than now was of a clock that was set back since.
        let is_of_now = |known: &Known| {
            known.belief.time_s() <= situation.time_s + EARLY_S
                && !known.belief.has_ended(situation.time_s)
        };
        self.retain(|known| is_of_now(known) || known.is_in(situation));
        for obstacle in situation.obstacles.iter().filter(Obstacle::is_valid) {
            let Some(bounds) = obstacle.movement.bounds() else {
                self.retain(|known| known.id != obstacle.id);
                continue;
            };
            let age_s = obstacle.age_s.max(0.0);
            let report = Report {
                time_s: situation.time_s - age_s,
                position_m: obstacle.position_m,
                velocity_mps: Some(obstacle.velocity_mps),
                carried_s: age_s as f32,
                errors: errors_of(obstacle.uncertainty, errors),
            };
            let aircraft = (obstacle.id, obstacle.volume);
            let heard = self.take(aircraft, &report, &bounds, situation.ownship.position_m);
            has_news |= heard != Some(false);
        }
        has_news
    }

    /// Takes a [valid](Report::is_valid) report of an aircraft with a volume. Returns whether the report is new. Returns `None` if there is no
    /// room for all aircraft; it then leaves out the farthest one.
    pub fn take(
        &mut self,
        (id, volume): (u32, ProtectedVolume),
        report: &Report,
        bounds: &MovementBounds,
        own_m: Vec3,
    ) -> Option<bool> {
        let mut known = self.known.iter_mut().flatten();
        if let Some(known) = known.find(|known| known.id == id) {
            let is_new = report.time_s > known.belief.time_s() + LATER_S;
            if is_new {
                known.volume = volume;
                let before = Some(known.belief).filter(|belief| belief.bounds() == bounds);
                known.belief = Belief::after(before, report, bounds);
            }
            return Some(is_new);
        }
        let belief = Belief::new(report, bounds);
        self.add(own_m, &Known { id, volume, belief })
    }

    /// Adds an aircraft, or leaves the farthest one out.
    fn add(&mut self, own_m: Vec3, new: &Known) -> Option<bool> {
        let now_s = new.belief.time_s();
        if self.known.push(Some(*new)).is_some() {
            return Some(true);
        }
        // The rank of a place: free, of nobody heard of, of the farthest one.
        let rank = |slot: &Option<Known>| match slot {
            None => (2, 0.0),
            Some(known) if known.belief.has_ended(now_s) => (1, 0.0),
            Some(known) => (0, known.belief.reported_m().distance_squared(own_m)),
        };
        let by_rank = |a: &(u8, f64), b: &(u8, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        let place = self
            .known
            .iter_mut()
            .max_by(|a, b| by_rank(&rank(a), &rank(b)))?;
        let (is_free, away_m2) = rank(place);
        if is_free > 0 {
            *place = Some(*new);
            return Some(true);
        }
        self.left_out_s = now_s;
        if away_m2 > new.belief.reported_m().distance_squared(own_m) {
            *place = Some(*new);
        }
        None
    }

    /// The aircraft that a situation does not have, as they are expected to be now.
    pub fn absent(&self, situation: &Situation<'_>) -> impl Iterator<Item = Obstacle> {
        let absent = self.iter().filter(|known| !known.is_in(situation));
        absent.map(|known| {
            let now = known.belief.at(situation.time_s);
            let (at_m, v_mps) = (now.position_m, now.velocity_mps);
            Obstacle {
                movement: Movement::Aircraft(*known.belief.bounds()),
                ..Obstacle::straight(known.id, at_m, v_mps, known.volume)
            }
        })
    }

    /// An obstacle as it is expected to be now: an aircraft where it is believed to be, everything else as it is.
    pub fn expected(&self, obstacle: &Obstacle, time_s: f64) -> Obstacle {
        let known = self.iter().find(|known| known.id == obstacle.id);
        known.map_or(*obstacle, |known| {
            let now = known.belief.at(time_s);
            Obstacle {
                position_m: now.position_m,
                velocity_mps: now.velocity_mps,
                uncertainty: Uncertainty::default(),
                age_s: 0.0,
                ..*obstacle
            }
        })
    }
}

//! The ground below the flight: ordered, used for decisions, and what the operator reads of it.

use alloc::sync::Arc;

use fga::avoider::{Decision, Reason};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga_formats::terrain::{LocalGround, Terrain};
use serde_json::json;

use super::Companion;
use crate::authority::Severity;
use crate::ground::{GroundOrder, MadeGround, Place};
use crate::ownship::State;

/// The ground is looked up this far ahead on the present course, seconds …
const AHEAD_S: f64 = 5.0;
/// … each so many seconds.
const AHEAD_STEP_S: f64 = 0.5;
/// Manoeuvres whose courses or climbs differ by more than this are two, radians.
const OTHER_RAD: f64 = 0.05;

/// What is known of the ground, and what was told of it.
#[derive(Debug, Default)]
pub(super) struct OverGround {
    terrain: Option<Arc<Terrain>>,
    /// Waits for the one who drives the companion.
    order: Option<GroundOrder>,
    ordered: Option<Place>,
    made: Option<MadeGround>,
    /// The last reports about the mission.
    told_mission: [Option<String>; 3],
    /// Whether the last choice is another one without the ground.
    bounds: bool,
    told: Told,
}

/// The reports of one manoeuvre.
#[derive(Debug, Default, Clone, Copy)]
struct Told {
    bounds: bool,
    unknown: bool,
    low: bool,
}

/// Whether a decision has just chosen its manoeuvre.
const fn chooses(decision: &Decision) -> bool {
    matches!(
        decision.record.reason,
        Reason::ManeuverChosen | Reason::ManeuverReplaced | Reason::BestAvailable
    )
}

/// Whether manoeuvres lead elsewhere, whenever they begin.
fn differ(one: &Maneuver, other: &Maneuver) -> bool {
    let (one, other) = (one.stages(), other.stages());
    one.len() != other.len()
        || one.iter().zip(other).any(|(one, other)| {
            (one.course_rad - other.course_rad).abs() > OTHER_RAD
                || (one.climb_rad - other.climb_rad).abs() > OTHER_RAD
        })
}

impl Companion {
    /// Gives it the heights of the ground, before the flight.
    pub fn set_terrain(&mut self, terrain: Option<Arc<Terrain>>) {
        self.over.terrain = terrain;
    }

    /// Ground to make, if any is due: [`GroundOrder::make`] takes longer than a decision may.
    pub fn ground_order(&mut self) -> Option<GroundOrder> {
        self.over.order.take()
    }

    /// Makes the ground that is due, where nobody waits for a decision.
    pub fn make_ground(&mut self, now_s: f64) {
        if let Some(order) = self.ground_order() {
            self.take_ground(order.make(), now_s);
        }
    }

    /// Takes ground that was made.
    pub fn take_ground(&mut self, made: MadeGround, now_s: f64) {
        let is_here = |frame| made.place.is_in(frame);
        if !self.ownship.frame().is_some_and(is_here) {
            return;
        }
        let known = made.ground.as_ref();
        self.note(
            now_s,
            "ground",
            json!({
                "vertical_error_m": known.ok().map(LocalGround::error_m),
                "unusable": known.err(),
                "low_legs": made.legs.low.iter().map(|(item, above_m)| json!([item, above_m.round()])).collect::<Vec<_>>(),
                "unknown_legs": made.legs.unknown,
            }),
        );
        let lowest = made.legs.low.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let low = lowest.map(|(item, above_m)| match made.legs.low.len() {
            1 => format!("fga: item {item} is {above_m:.0} m above ground: too low"),
            count => format!("fga: {count} legs too low, item {item}: {above_m:.0} m"),
        });
        let unknown = made.legs.unknown.first();
        let words = [
            known
                .is_err()
                .then(|| "fga: no ground is known here".to_owned()),
            low,
            unknown.map(|item| format!("fga: item {item} is over unknown ground")),
        ];
        for (words, told) in words
            .iter()
            .zip(core::mem::take(&mut self.over.told_mission))
        {
            if let Some(words) = words.as_ref().filter(|words| told.as_ref() != Some(words)) {
                self.tell(Severity::Warning, words, now_s);
            }
        }
        self.over.told_mission = words;
        self.over.made = Some(made);
    }

    /// Orders the ground where the present one does not serve any more.
    pub(super) fn order_ground(&mut self, state: &State) {
        let Some(terrain) = &self.over.terrain else {
            return;
        };
        let (Some(frame), Some(home_m)) = (self.ownship.frame(), self.ownship.home_altitude_m())
        else {
            return;
        };
        let numbers = (self.mission_laid, 0);
        let place = Place::new(frame, state.ownship.position_m, numbers);
        if self
            .over
            .ordered
            .as_ref()
            .is_some_and(|ordered| ordered.serves(&place))
        {
            return;
        }
        let items = self.mission.items().unwrap_or_default();
        let clearance_m = self.config.terrain.clearance_m.unwrap_or(0.0);
        self.over.ordered = Some(place.clone());
        self.over.order = Some(GroundOrder::new(
            place,
            terrain,
            (items, home_m),
            clearance_m,
        ));
    }

    /// The local frame has moved.
    pub(super) fn forget_ground(&mut self) {
        self.over.ordered = None;
        self.over.made = None;
    }

    /// Whether the ground that it was given is not made yet.
    pub(super) const fn waits_for_ground(&self) -> bool {
        self.over.terrain.is_some() && self.over.made.is_none()
    }

    /// The ground as it is known now.
    pub(super) fn known_ground(&self) -> Option<&LocalGround> {
        self.over.made.as_ref()?.ground.as_ref().ok()
    }

    /// The ground for a decision, higher by what our own height is uncertain in a gap of the telemetry.
    pub(super) fn bounding_ground(&self, now_s: f64) -> Option<Ground<'_>> {
        self.known_ground()?.raised(self.growth_m(now_s))
    }

    /// Notes whether a decision that has just chosen its manoeuvre chooses another one without the ground.
    pub(super) fn note_bounds(&mut self, decision: &Decision, without: Option<&Decision>) {
        if let Some(without) = without {
            self.over.bounds = differ(&decision.command, &without.command);
        }
    }

    /// Whether to ask what would have been chosen without the ground.
    pub(super) fn asks_without_ground(&self, decision: &Decision) -> bool {
        self.known_ground().is_some() && chooses(decision)
    }

    /// Reports each once in a manoeuvre: that the ground decides where it leads, that it leads over unknown ground, or too low.
    pub(super) fn watch_ground(&mut self, decision: &Decision, state: &State, now_s: f64) {
        if !self.keeper.is_engaged() {
            self.over.told = Told::default();
        }
        let Some(ground) = self.known_ground().filter(|_| self.keeper.commands()) else {
            return;
        };
        let needed_m = ground.clearance_m() + ground.error_m();
        let steps = libm::ceil(AHEAD_S / AHEAD_STEP_S);
        let (mut least_m, mut is_known, mut step) = (f64::INFINITY, true, 0.0);
        while step <= steps {
            let ahead_m = state.ground_velocity_mps * (step * AHEAD_STEP_S);
            match ground.above_m(state.ownship.position_m + ahead_m) {
                Some(above_m) => least_m = least_m.min(above_m),
                None => is_known = false,
            }
            step += 1.0;
        }
        let name = decision
            .record
            .threat
            .map(|threat| self.obstacle_name(threat.id));
        let name = name.unwrap_or_else(|| "traffic".to_owned());
        let told = &mut self.over.told;
        let mut words = Vec::new();
        if self.over.bounds && !core::mem::replace(&mut told.bounds, true) {
            words.push(format!("fga: the ground bounds the way round {name}"));
        }
        if !is_known && !core::mem::replace(&mut told.unknown, true) {
            words.push("fga: avoids over unknown ground".to_owned());
        }
        if least_m < needed_m && !core::mem::replace(&mut told.low, true) {
            words.push(format!(
                "fga: {least_m:.0} m above ground, asked {needed_m:.0} m"
            ));
        }
        for words in words {
            self.tell(Severity::Warning, &words, now_s);
        }
    }
}

//! The ground below the flight: ordered or asked for, used for decisions, checked, and what the operator reads of it.

use alloc::sync::Arc;

use fga::Vec3;
use fga::avoider::{Decision, Reason};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga_formats::geodesy::LocalFrame;
use fga_formats::terrain::{LocalGround, Terrain};
use mavlink::dialects::ardupilotmega::{
    DISTANCE_SENSOR_DATA, MavCmd, MavMessage, MavSensorOrientation, TERRAIN_DATA_DATA,
    TERRAIN_REPORT_DATA,
};
use serde_json::json;

use super::Companion;
use crate::authority::Severity;
use crate::commands::Command;
use crate::ground::{Asked, GroundOrder, MadeGround, Place};
use crate::number::degrees_from_e7;
use crate::ownship::State;

/// The ground is looked up this far ahead on the present course, seconds …
const AHEAD_S: f64 = 5.0;
/// … each so many seconds.
const AHEAD_STEP_S: f64 = 0.5;
/// Manoeuvres whose courses or climbs differ by more than this are two, radians.
const OTHER_RAD: f64 = 0.05;
/// Ground is asked for this far along the way, and to each side of the vehicle, metres, at places this far apart.
const ASKED_AHEAD_M: f64 = 10_000.0;
const ASKED_BESIDE_M: f64 = 4_000.0;
const ASKED_STEP_M: f64 = 2_000.0;
/// The message of a rangefinder, and how often it is asked for, microseconds.
const DISTANCE_SENSOR: f32 = 132.0;
const DISTANCE_EACH_US: f32 = 500_000.0;
/// A measured height above the ground is wrong by up to this beyond the error of the ground, metres, and as a share of the height: the
/// vehicle's own height, trees, slopes.
const MEASURED_M: f64 = 20.0;
const MEASURED_SHARE: f64 = 0.1;
/// It disagrees after this long, seconds.
const DISAGREES_S: f64 = 3.0;

/// Who knows the ground.
#[derive(Debug, Default)]
enum Source {
    #[default]
    Nobody,
    Files(Arc<Terrain>),
    /// A ground station, with what it sent so far.
    Station(Box<Asked>, Option<Arc<Terrain>>),
}

/// Somebody else's opinion of the height above the ground.
#[derive(Debug, Clone, Copy, Default)]
struct Opinion {
    heard: u32,
    disagreeing: u32,
    since_s: Option<f64>,
    told: bool,
}

/// What is known of the ground, and what was told of it.
#[derive(Debug, Default)]
pub(super) struct OverGround {
    source: Source,
    /// Waits for the one who drives the companion.
    order: Option<GroundOrder>,
    /// Where the last ground was ordered.
    ordered: Option<Place>,
    /// The number of the mission that was checked last.
    checked: Option<u32>,
    made: Option<Result<LocalGround, String>>,
    /// The last reports about the mission.
    told_mission: [Option<String>; 3],
    told_unanswered: bool,
    /// Of the rangefinder, and of the vehicle's own terrain.
    opinions: [Opinion; 2],
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

/// The places whose ground is wanted, latitudes and longitudes in degrees: here, along a way, around here.
fn places(frame: &LocalFrame, at_m: Vec3, way_m: &[Vec3]) -> Vec<[f64; 2]> {
    let mut places_m = vec![at_m];
    let (mut from_m, mut left_m) = (at_m, ASKED_AHEAD_M);
    for to_m in way_m {
        let length_m = from_m.distance(*to_m).min(left_m);
        let along = (*to_m - from_m).normalize_or_zero();
        let mut step_m = 0.5 * ASKED_STEP_M;
        while step_m <= length_m {
            places_m.push(from_m + along * step_m);
            step_m += 0.5 * ASKED_STEP_M;
        }
        left_m -= length_m;
        from_m = *to_m;
    }
    let mut aside = Vec3::splat(-ASKED_BESIDE_M).with_z(0.0);
    while aside.y <= ASKED_BESIDE_M {
        places_m.push(at_m + aside);
        aside.x += ASKED_STEP_M;
        if aside.x > ASKED_BESIDE_M {
            aside = Vec3::new(-ASKED_BESIDE_M, aside.y + ASKED_STEP_M, 0.0);
        }
    }
    let places = places_m.into_iter().map(|at_m| frame.to_geodetic(at_m));
    let places = places.map(|place| [place.latitude_deg, place.longitude_deg]);
    places.collect()
}

impl OverGround {
    /// With a ground station to ask, or without anybody.
    pub(super) fn new(asks: bool) -> Self {
        let source = if asks {
            Source::Station(Box::default(), None)
        } else {
            Source::Nobody
        };
        Self {
            source,
            ..Self::default()
        }
    }
}

impl Companion {
    /// Gives it the heights of the ground, before the flight.
    pub fn set_terrain(&mut self, terrain: Option<Arc<Terrain>>) {
        if let Some(terrain) = terrain {
            self.over.source = Source::Files(terrain);
        }
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

    /// Takes ground that was made, and what it means for the mission.
    pub fn take_ground(&mut self, made: MadeGround, now_s: f64) {
        let is_here = |frame| made.place.is_in(frame);
        if !self.ownship.frame().is_some_and(is_here) {
            return;
        }
        if let Some(ground) = made.ground {
            self.over.made = Some(ground);
        }
        let unusable = self.over.made.as_ref().and_then(|made| made.as_ref().err());
        let low = &made.legs.low;
        let content = json!({
            "vertical_error_m": self.known_ground().map(LocalGround::error_m),
            "unusable": unusable,
            "low_legs": low.iter().map(|(item, above_m)| json!([item, above_m.round()])).collect::<Vec<_>>(),
            "unknown_legs": made.legs.unknown,
        });
        let lowest = low.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = lowest.map(|(item, above_m)| match low.len() {
            1 => format!("fga: item {item} is {above_m:.0} m above ground: too low"),
            count => format!("fga: {count} legs too low, item {item}: {above_m:.0} m"),
        });
        // What a ground station has not sent yet may still come.
        let is_settled = match &self.over.source {
            Source::Station(asked, _) => asked.is_settled(now_s),
            _ => true,
        };
        let unknown = made.legs.unknown.first().filter(|_| is_settled);
        let words = [
            unusable.map(|_| "fga: no ground is known here".to_owned()),
            lowest,
            unknown.map(|item| format!("fga: item {item} is over unknown ground")),
        ];
        self.note(now_s, "ground", content);
        let told = core::mem::replace(&mut self.over.told_mission, words.clone());
        for (words, told) in words.iter().zip(told) {
            if let Some(words) = words.as_ref().filter(|words| told.as_ref() != Some(words)) {
                self.tell(Severity::Warning, words, now_s);
            }
        }
    }

    /// Asks for ground, and orders it where the present one does not serve any more.
    pub(super) fn order_ground(&mut self, state: &State, now_s: f64) {
        let at_m = state.ownship.position_m;
        let (Some(frame), Some(home_m)) = (
            self.ownship.frame().copied(),
            self.ownship.home_altitude_m(),
        ) else {
            return;
        };
        self.ask_for_ground(&frame, at_m, now_s);
        let over = &mut self.over;
        let (terrain, number) = match &mut over.source {
            Source::Nobody => return,
            Source::Files(terrain) => (Arc::clone(terrain), 0),
            Source::Station(asked, terrain) => {
                let number = asked.number(now_s);
                let is_new = over
                    .ordered
                    .as_ref()
                    .is_none_or(|ordered| ordered.is_older(number));
                if is_new {
                    *terrain = asked.terrain();
                }
                let Some(terrain) = terrain else { return };
                (Arc::clone(terrain), number)
            }
        };
        let place = Place::new(&frame, at_m, number);
        let serves = over
            .ordered
            .as_ref()
            .is_some_and(|ordered| ordered.serves(&place));
        let is_checked = over.checked == Some(self.mission_laid);
        if serves && is_checked {
            return;
        }
        over.checked = Some(self.mission_laid);
        if !serves {
            over.ordered = Some(place.clone());
            if let Some(heard) = &self.heard {
                // A vehicle without a rangefinder never sends it.
                let asks = Command::long(
                    MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                    DISTANCE_SENSOR,
                    DISTANCE_EACH_US,
                );
                self.outbox.send(asks.message(heard.system_id, 0));
            }
        }
        // An order that still waits is to be carried out too.
        let makes = !serves || over.order.as_ref().is_some_and(GroundOrder::makes);
        let items = self.mission.items().unwrap_or_default();
        let clearance_m = self.config.terrain.clearance_m.unwrap_or(0.0);
        let asked = (clearance_m, makes);
        over.order = Some(GroundOrder::new(place, &terrain, (items, home_m), asked));
    }

    /// Asks the ground station for what is missing.
    fn ask_for_ground(&mut self, frame: &LocalFrame, at_m: Vec3, now_s: f64) {
        let (met_m, left_m) = self.way_left(at_m);
        let way_m: Vec<Vec3> = core::iter::once(met_m)
            .chain(left_m.iter().copied())
            .collect();
        let Source::Station(asked, _) = &mut self.over.source else {
            return;
        };
        let was_settled = asked.is_settled(now_s);
        let request = asked.request(now_s, || places(frame, at_m, &way_m));
        if asked.is_settled(now_s) && !was_settled {
            self.over.checked = None;
        }
        let is_unanswered = asked.is_unanswered(now_s);
        if let Some(request) = request {
            self.outbox.send(MavMessage::TERRAIN_REQUEST(request));
        }
        if is_unanswered && !core::mem::replace(&mut self.over.told_unanswered, true) {
            let words = "fga: no terrain from the ground station";
            self.tell(Severity::Warning, words, now_s);
        }
    }

    /// Takes a piece of ground.
    pub(super) fn take_terrain(&mut self, data: &TERRAIN_DATA_DATA, now_s: f64) {
        if let Source::Station(asked, _) = &mut self.over.source
            && let Some(words) = asked.take(data)
        {
            self.tell(Severity::Warning, words, now_s);
        }
    }

    /// The local frame has moved.
    pub(super) fn forget_ground(&mut self) {
        self.over.order = None;
        self.over.ordered = None;
        self.over.made = None;
    }

    /// Whether ground from files is not made yet. What a ground station does not send, nobody waits for.
    pub(super) const fn waits_for_ground(&self) -> bool {
        matches!(self.over.source, Source::Files(_)) && self.over.made.is_none()
    }

    /// The ground as it is known now.
    pub(super) fn known_ground(&self) -> Option<&LocalGround> {
        self.over.made.as_ref()?.as_ref().ok()
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
        let (mut least_m, mut is_known, mut after_s) = (f64::INFINITY, true, 0.0);
        while after_s <= AHEAD_S {
            let ahead_m = state.ground_velocity_mps * after_s;
            match ground.above_m(state.ownship.position_m + ahead_m) {
                Some(above_m) => least_m = least_m.min(above_m),
                None => is_known = false,
            }
            after_s += AHEAD_STEP_S;
        }
        let threat = decision.record.threat;
        let name = threat.map_or_else(
            || "traffic".to_owned(),
            |threat| self.obstacle_name(threat.id),
        );
        let bounds = self.over.bounds;
        let told = &mut self.over.told;
        let reports = [
            (
                bounds,
                &mut told.bounds,
                format!("fga: the ground bounds the way round {name}"),
            ),
            (
                !is_known,
                &mut told.unknown,
                "fga: avoids over unknown ground".to_owned(),
            ),
            (
                least_m < needed_m,
                &mut told.low,
                format!("fga: {least_m:.0} m above ground, asked {needed_m:.0} m"),
            ),
        ];
        let due = reports.into_iter().filter_map(|(is_so, told, words)| {
            (is_so && !core::mem::replace(told, true)).then_some(words)
        });
        for words in due.collect::<Vec<_>>() {
            self.tell(Severity::Warning, &words, now_s);
        }
    }

    /// Compares a measured distance to the ground below, metres, with the known ground.
    pub(super) fn take_distance(&mut self, distance_m: f64, now_s: f64) {
        let (Some(ground), Some(at_m), Some(decided)) = (
            self.known_ground(),
            self.ownship.position_m(now_s),
            &self.decided,
        ) else {
            return;
        };
        let Some(above_m) = ground.above_m(at_m) else {
            return;
        };
        let own = &decided.own;
        let measured_m = distance_m * libm::cos(own.ownship.bank_rad) * libm::cos(own.pitch_rad);
        let allowed_m = ground.error_m() + MEASURED_M + MEASURED_SHARE * measured_m.abs();
        self.take_opinion(0, (above_m - measured_m, allowed_m), now_s);
    }

    /// Takes a rangefinder that looks down.
    pub(super) fn take_rangefinder(&mut self, data: &DISTANCE_SENSOR_DATA, now_s: f64) {
        let range = data.min_distance.saturating_add(1)..data.max_distance;
        let looks_down = data.orientation == MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270;
        // A quality of 1 is no signal.
        if looks_down && range.contains(&data.current_distance) && data.signal_quality != 1 {
            self.take_distance(f64::from(data.current_distance) * 1e-2, now_s);
        }
    }

    /// Takes what the vehicle itself knows of the ground.
    pub(super) fn take_terrain_report(&mut self, data: &TERRAIN_REPORT_DATA, now_s: f64) {
        let (Some(ground), Some(frame)) = (self.known_ground(), self.ownship.frame()) else {
            return;
        };
        let height_m = f64::from(data.terrain_height);
        let [latitude_deg, longitude_deg] = [data.lat, data.lon].map(degrees_from_e7);
        let place = fga_formats::geodesy::Geodetic::new(latitude_deg, longitude_deg, height_m);
        // Without a spacing it knows nothing.
        let Some(place) = place.filter(|_| data.spacing > 0) else {
            return;
        };
        let Some(below_m) = ground.above_m(frame.to_local_m(place)) else {
            return;
        };
        let allowed_m = 2.0 * ground.error_m() + MEASURED_M;
        self.take_opinion(1, (-below_m, allowed_m), now_s);
    }

    /// Takes by how much the ground of somebody else is higher than the known one, and what that may be, metres. It is told once, and
    /// changes no ground.
    fn take_opinion(&mut self, index: usize, (higher_m, allowed_m): (f64, f64), now_s: f64) {
        let Some(opinion) = self.over.opinions.get_mut(index) else {
            return;
        };
        opinion.heard += 1;
        if higher_m.abs() <= allowed_m {
            opinion.since_s = None;
            return;
        }
        opinion.disagreeing += 1;
        let since_s = *opinion.since_s.get_or_insert(now_s);
        if now_s - since_s < DISAGREES_S || core::mem::replace(&mut opinion.told, true) {
            return;
        }
        let whose = if index == 0 {
            "rangefinder"
        } else {
            "vehicle's terrain"
        };
        let side = if higher_m > 0.0 { "higher" } else { "lower" };
        let words = format!("fga: {whose}: ground {:.0} m {side}", higher_m.abs());
        self.tell(Severity::Warning, &words, now_s);
    }

    /// What was heard of the ground, for the log.
    pub(super) fn note_ground_heard(&mut self, now_s: f64) {
        let answers = match &self.over.source {
            Source::Nobody => return,
            Source::Files(_) => None,
            Source::Station(asked, _) => Some(asked.answers()),
        };
        let [rangefinder, vehicle] = self
            .over
            .opinions
            .map(|opinion| json!({ "heard": opinion.heard, "disagreeing": opinion.disagreeing }));
        let answers = answers.map(|answers| {
            json!({ "taken": answers.taken, "wrong": answers.wrong, "contradicting": answers.contradicting })
        });
        self.note(
            now_s,
            "ground-heard",
            json!({ "rangefinder": rangefinder, "vehicle": vehicle, "pieces": answers }),
        );
    }
}

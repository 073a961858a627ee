//! The ground below the flight: ordered or asked for, used for decisions, checked, and what the operator reads of it.

use alloc::sync::Arc;

use fga::avoider::{Decision, Reason};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga::{Vec2, Vec3};
use fga_formats::geodesy::{Geodetic, LocalFrame};
use fga_formats::terrain::{LocalGround, Terrain};
use mavlink::MessageData as _;
use mavlink::dialects::ardupilotmega::{
    DISTANCE_SENSOR_DATA, MavCmd, MavMessage, MavSensorOrientation, TERRAIN_DATA_DATA,
};
use serde_json::json;

use super::Companion;
use crate::authority::Severity;
use crate::commands::Command;
use crate::ground::{AskedBlocks, GroundOrder, MadeGround, Square};
use crate::ownship::State;

/// The ground is looked up here and each second ahead in the present turn, so often.
const LOOKS_AHEAD: u8 = 6;
/// Manoeuvres whose courses or climbs differ by more than this are two, radians.
const OTHER_RAD: f64 = 0.05;
/// Ground is asked for this far along the way, metres …
const ASKED_AHEAD_M: f64 = 10_000.0;
/// … and around the vehicle at twice this, metres: less than a block is wide.
const ASKED_STEP_M: f64 = 2_000.0;
/// A measured height is wrong by up to this beyond the error of the ground, metres: our own height, trees, slopes.
const MEASURED_M: f64 = 20.0;
/// It disagrees after this long, seconds.
const DISAGREES_S: f64 = 3.0;

/// Who knows the ground.
#[derive(Debug, Default)]
enum GroundSource {
    #[default]
    Nobody,
    Files(Arc<Terrain>),
    /// A ground station, with what it sent so far and its number.
    Station(Box<AskedBlocks>, Option<(Arc<Terrain>, u32)>),
}

/// What a rangefinder says of the known ground.
#[derive(Debug, Clone, Copy, Default)]
struct Rangefinder {
    heard: u32,
    disagreeing: u32,
    since_s: Option<f64>,
    told: bool,
}

/// The known ground, and the reports about it that the operator has read.
#[derive(Debug, Default)]
pub(super) struct OverGround {
    heights: GroundSource,
    /// Waits for the one who drives the companion.
    order: Option<GroundOrder>,
    /// The last square that was ordered.
    ordered: Option<Square>,
    made: Option<Result<LocalGround, String>>,
    /// The last reports about the mission.
    told_mission: [Option<String>; 3],
    told_unanswered: bool,
    rangefinder: Rangefinder,
    /// Whether the last choice is another one without the ground.
    bounds: bool,
    told: Reports,
}

/// The reports of one manoeuvre.
#[derive(Debug, Default, Clone, Copy)]
struct Reports {
    bounds: bool,
    unknown: bool,
    low: bool,
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
    let mut left_m = ASKED_AHEAD_M;
    for (from_m, to_m) in core::iter::once(&at_m).chain(way_m).zip(way_m) {
        let length_m = from_m.distance(*to_m).min(left_m);
        let along = (*to_m - *from_m).normalize_or_zero();
        let mut step_m = 0.0;
        while step_m <= length_m {
            places_m.push(*from_m + along * step_m);
            step_m += 0.5 * ASKED_STEP_M;
        }
        left_m -= length_m;
    }
    let steps = || (-2..=2).map(|step| f64::from(step) * ASKED_STEP_M);
    places_m.extend(steps().flat_map(|x| steps().map(move |y| at_m + Vec3::new(x, y, 0.0))));
    let places = places_m.into_iter().map(|at_m| frame.to_geodetic(at_m));
    let places = places.map(|place| [place.latitude_deg, place.longitude_deg]);
    places.collect()
}

impl OverGround {
    /// With a ground station to ask, or without anybody.
    pub(super) fn new(asks: bool) -> Self {
        Self {
            heights: if asks {
                GroundSource::Station(Box::default(), None)
            } else {
                GroundSource::Nobody
            },
            ..Self::default()
        }
    }
}

impl Companion {
    /// Gives it the heights of the ground, before the flight.
    pub fn set_terrain(&mut self, terrain: Option<Arc<Terrain>>) {
        if let Some(terrain) = terrain {
            self.over.heights = GroundSource::Files(terrain);
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
        let is_here = |frame| made.square.is_in(frame);
        if !self.ownship.frame().is_some_and(is_here) {
            return;
        }
        let content = json!({
            "vertical_error_m": made.ground.as_ref().ok().map(LocalGround::error_m),
            "unusable": made.ground.as_ref().err(),
            "low_legs": made.low,
            "unknown_legs": made.unknown.iter().map(|(item, _)| item).collect::<Vec<_>>(),
        });
        self.note(now_s, "ground", content);
        let lowest = made.low.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = lowest.map(|(item, above_m)| match made.low.len() {
            1 => format!("fga: item {item} is {above_m:.0} m above ground: too low"),
            count => format!("fga: {count} legs too low, item {item}: {above_m:.0} m"),
        });
        let is_settled = |place: &Geodetic| match &self.over.heights {
            GroundSource::Station(asked, _) => asked.is_settled(place),
            _ => true,
        };
        let unknown = made.unknown.iter().find(|(_, place)| is_settled(place));
        let unusable = made.ground.as_ref().err();
        let words = [
            unusable.map(|_| "fga: no ground is known here".to_owned()),
            lowest,
            unknown.map(|(item, _)| format!("fga: item {item} is over unknown ground")),
        ];
        let told = core::mem::replace(&mut self.over.told_mission, words.clone());
        for (words, told) in words.into_iter().zip(told) {
            if let Some(words) = words.filter(|words| told.as_ref() != Some(words)) {
                self.tell(Severity::Warning, &words, now_s);
            }
        }
        self.over.made = Some(made.ground);
    }

    /// Asks for ground, and orders it where the present one does not serve any more.
    pub(super) fn order_ground(&mut self, now_s: f64) {
        let (Some(frame), Some(home_m), Some(at_m)) = (
            self.ownship.frame().copied(),
            self.ownship.home_altitude_m(),
            self.ownship.position_m(now_s),
        ) else {
            return;
        };
        self.ask_for_ground(&frame, at_m, now_s);
        let (terrain, number) = match &self.over.heights {
            GroundSource::Files(terrain) => (terrain, 0),
            GroundSource::Station(_, Some((terrain, number))) => (terrain, *number),
            _ => return,
        };
        let square = Square::new(&frame, at_m, (self.mission_laid, number));
        let ordered = self.over.ordered.as_ref();
        if ordered.is_some_and(|ordered| ordered.serves(&square)) {
            return;
        }
        let items = self.mission.items().unwrap_or_default();
        let clearance_m = self.config.terrain.clearance_m.unwrap_or(0.0);
        let order = GroundOrder::new(square.clone(), terrain, (items, home_m), clearance_m);
        self.over.order = Some(order);
        self.over.ordered = Some(square);
        if let Some(heard) = &self.heard {
            // Each half second; a vehicle without a rangefinder never sends it.
            let id = DISTANCE_SENSOR_DATA::ID as f32;
            let asks = Command::long(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, id, 0.5e6);
            self.outbox.send(asks.message(heard.system_id, 0));
        }
    }

    /// Asks the ground station for what is missing, and takes what has come.
    fn ask_for_ground(&mut self, frame: &LocalFrame, at_m: Vec3, now_s: f64) {
        let (_, left_m) = self.way_left(at_m);
        let way_m = left_m.to_vec();
        let GroundSource::Station(asked, terrain) = &mut self.over.heights else {
            return;
        };
        let request = asked.request(now_s, || places(frame, at_m, &way_m));
        let number = asked.number(now_s);
        if terrain.as_ref().is_none_or(|(_, laid)| *laid != number) {
            *terrain = asked.terrain().map(|terrain| (terrain, number));
        }
        let is_unanswered = asked.is_unanswered();
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
        if let GroundSource::Station(asked, _) = &mut self.over.heights
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
        matches!(self.over.heights, GroundSource::Files(_)) && self.over.made.is_none()
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
        let reason = decision.record.reason;
        let has_chosen = matches!(reason, Reason::ManeuverChosen | Reason::ManeuverReplaced);
        has_chosen && self.known_ground().is_some()
    }

    /// Reports each once in a manoeuvre: that the ground decides where it leads, that it leads over unknown ground, or too low.
    pub(super) fn watch_ground(&mut self, decision: &Decision, state: &State, now_s: f64) {
        if !self.keeper.is_engaged() {
            self.over.told = Reports::default();
        }
        let Some(ground) = self.known_ground().filter(|_| self.keeper.commands()) else {
            return;
        };
        let needed_m = ground.clearance_m() + ground.error_m();
        let climb_mps = state.ownship.airspeed_mps * libm::sin(self.lasting_climb_rad(state));
        let (mut at_m, mut is_known, mut least_m) = (state.ownship.position_m, true, f64::INFINITY);
        for second in 0..LOOKS_AHEAD {
            let above_m = ground.above_m(at_m);
            is_known &= above_m.is_some();
            least_m = least_m.min(above_m.unwrap_or(f64::INFINITY));
            let turned = Vec2::from_angle(state.course_rate_radps * (f64::from(second) + 0.5));
            let flown_m = turned.rotate(state.ground_velocity_mps.truncate());
            at_m += flown_m.extend(climb_mps);
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

    /// Compares the measured distance to the ground below, metres, with the known ground. The first difference that lasts makes one report;
    /// the known ground stays as it is.
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
        let (own, allowed_m) = (&decided.own, ground.error_m() + MEASURED_M);
        let upright = libm::cos(own.ownship.bank_rad) * libm::cos(own.pitch_rad);
        let higher_m = above_m - distance_m * upright;
        let measured = &mut self.over.rangefinder;
        measured.heard += 1;
        if higher_m.abs() <= allowed_m {
            measured.since_s = None;
            return;
        }
        measured.disagreeing += 1;
        let since_s = *measured.since_s.get_or_insert(now_s);
        if now_s - since_s >= DISAGREES_S && !core::mem::replace(&mut measured.told, true) {
            let side = if higher_m > 0.0 { "higher" } else { "lower" };
            let words = format!("fga: rangefinder: ground {:.0} m {side}", higher_m.abs());
            self.tell(Severity::Warning, &words, now_s);
        }
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

    /// What was heard of the ground, for the log.
    pub(super) fn note_ground_heard(&mut self, now_s: f64) {
        let answers = match &self.over.heights {
            GroundSource::Nobody => return,
            GroundSource::Files(_) => None,
            GroundSource::Station(asked, _) => Some(asked.answers()),
        };
        let answers = answers.map(|answers| {
            json!({ "taken": answers.taken, "wrong": answers.wrong, "contradicting": answers.contradicting })
        });
        let Rangefinder {
            heard, disagreeing, ..
        } = self.over.rangefinder;
        let rangefinder = json!({ "heard": heard, "disagreeing": disagreeing });
        let content = json!({ "rangefinder": rangefinder, "pieces": answers });
        self.note(now_s, "ground-heard", content);
    }
}

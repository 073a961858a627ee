//! The ground below the flight: ordered or asked for, used for decisions, checked, and what the operator reads of it.

use alloc::sync::Arc;

use fga::avoider::{Decision, Reason, State as AvoiderState};
use fga::ground::Ground;
use fga::maneuver::Maneuver;
use fga::{Vec2, Vec3};
use fga_formats::geodesy::{Geodetic, LocalFrame};
use fga_formats::terrain::{LocalGround, Terrain};
use mavlink::MessageData as _;
use mavlink::dialects::ardupilotmega::{
    DISTANCE_SENSOR_DATA, MavCmd, MavMessage, MavSensorOrientation, TERRAIN_DATA_DATA,
    TERRAIN_REPORT_DATA,
};
use serde_json::json;

use super::around::ObstaclesAround;
use super::lists::Lists;
use super::route::LaidRoute;
use super::voice::Voice;
use crate::authority::Keeper;
use crate::commands::VehicleCommand;
use crate::config::TerrainSource;
use crate::ground::{AskedBlocks, GroundOrder, MadeGround, Square};
use crate::ownship::{OwnState, OwnshipEstimate};

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
    /// Somebody is asked; with what came so far and its number.
    Asked(TerrainSource, Box<AskedBlocks>, Option<(Arc<Terrain>, u32)>),
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
    clearance_m: f64,
    /// Waits for the one who drives the companion.
    order: Option<GroundOrder>,
    /// The last square that was ordered.
    ordered: Option<Square>,
    made: Option<Result<Arc<LocalGround>, String>>,
    /// The last reports about the mission.
    told_mission: [Option<String>; 3],
    told_unanswered: bool,
    rangefinder: Rangefinder,
    is_armed: bool,
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

/// The places whose ground is wanted, latitudes and longitudes in degrees: here, along a way, around here; and how many of them are
/// here or on the way.
fn places(frame: &LocalFrame, at_m: Vec3, way_m: &[Vec3]) -> (Vec<[f64; 2]>, usize) {
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
    let on_way = places_m.len();
    let steps = || (-2..=2).map(|step| f64::from(step) * ASKED_STEP_M);
    places_m.extend(steps().flat_map(|x| steps().map(move |y| at_m + Vec3::new(x, y, 0.0))));
    let places = places_m.into_iter().map(|at_m| frame.to_geodetic(at_m));
    let places = places.map(|place| [place.latitude_deg, place.longitude_deg]);
    (places.collect(), on_way)
}

impl OverGround {
    /// With somebody to ask, or without; manoeuvres keep `clearance_m` above the ground.
    pub(super) fn new(asked: Option<TerrainSource>, clearance_m: f64) -> Self {
        let heights = asked.map_or(GroundSource::Nobody, |source| {
            GroundSource::Asked(source, Box::default(), None)
        });
        Self {
            heights,
            clearance_m,
            ..Self::default()
        }
    }

    /// Takes the heights of the ground from files.
    pub(super) fn set_terrain(&mut self, terrain: Arc<Terrain>) {
        self.heights = GroundSource::Files(terrain);
    }

    /// Ground to make, if any is due.
    pub(super) fn take_order(&mut self) -> Option<GroundOrder> {
        self.order.take()
    }

    /// Takes ground that was made around here, and reports what it means for the mission.
    pub(super) fn take_ground(&mut self, made: MadeGround, voice: &mut Voice) {
        let content = json!({
            "vertical_error_m": made.ground.as_ref().ok().map(|ground| ground.error_m()),
            "unusable": made.ground.as_ref().err(),
            "low_legs": made.low,
            "unknown_legs": made.unknown.iter().map(|(item, _)| item).collect::<Vec<_>>(),
        });
        voice.note("ground", content);
        let lowest = made.low.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = lowest.map(|(item, above_m)| match made.low.len() {
            1 => format!("fga: item {item} is {above_m:.0} m above ground: too low"),
            count => format!("fga: {count} legs too low, item {item}: {above_m:.0} m"),
        });
        let is_settled = |place: &Geodetic| match &self.heights {
            GroundSource::Asked(_, asked, _) => asked.is_settled(place),
            _ => true,
        };
        let unknown = made.unknown.iter().find(|(_, place)| is_settled(place));
        let unusable = made.ground.as_ref().err();
        let words = [
            unusable.map(|_| "fga: no ground is known here".to_owned()),
            lowest,
            unknown.map(|(item, _)| format!("fga: item {item} is over unknown ground")),
        ];
        let told = core::mem::replace(&mut self.told_mission, words.clone());
        for (words, told) in words.into_iter().zip(told) {
            if let Some(words) = words.filter(|words| told.as_ref() != Some(words)) {
                voice.warn(&words);
            }
        }
        self.made = Some(made.ground);
    }

    /// ArduPilot shifts its ground as it arms, by up to `TERRAIN_OFS_MAX`, so that it stands on it: heights from before do not belong to the
    /// altitudes that it reports from then on, and are asked of it again.
    pub(super) fn follow_arming(&mut self, is_armed: bool) {
        let arms = !core::mem::replace(&mut self.is_armed, is_armed) && is_armed;
        if let GroundSource::Asked(TerrainSource::Vehicle, asked, _) = &mut self.heights
            && arms
        {
            asked.ask_again();
        }
    }

    /// Asks for ground, the vehicle only if it has terrain, and orders it where the present one does not serve any more.
    pub(super) fn order(
        &mut self,
        route: &LaidRoute,
        lists: &Lists,
        (ownship, has_terrain): (&OwnshipEstimate, bool),
        voice: &mut Voice,
    ) {
        let (Some(frame), Some(home_m), Some(at_m)) = (
            ownship.frame(),
            ownship.home_altitude_m(),
            ownship.position_m(voice.now_s()),
        ) else {
            return;
        };
        self.ask(frame, at_m, route, has_terrain, voice);
        let (terrain, number) = match &self.heights {
            GroundSource::Files(terrain) => (terrain, 0),
            GroundSource::Asked(_, _, Some((terrain, number))) => (terrain, *number),
            _ => return,
        };
        let square = Square::new(frame, at_m, (lists.mission_number(), number));
        let ordered = self.ordered.as_ref();
        if ordered.is_some_and(|ordered| ordered.serves(&square)) {
            return;
        }
        let mission = (lists.mission().unwrap_or_default(), home_m);
        let order = GroundOrder::new(square.clone(), terrain, mission, self.clearance_m);
        self.order = Some(order);
        self.ordered = Some(square);
        // Each half second; a vehicle without a rangefinder never sends it.
        let id = DISTANCE_SENSOR_DATA::ID as f32;
        let asks = VehicleCommand::long(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, id, 0.5e6);
        voice.send(asks.message(voice.system(), 0));
    }

    /// Asks for what is missing, and takes what has come.
    fn ask(
        &mut self,
        frame: &LocalFrame,
        at_m: Vec3,
        route: &LaidRoute,
        has_terrain: bool,
        voice: &mut Voice,
    ) {
        let now_s = voice.now_s();
        let GroundSource::Asked(source, asked, terrain) = &mut self.heights else {
            return;
        };
        let is_off = *source == TerrainSource::Vehicle && !has_terrain;
        let places = || places(frame, at_m, route.left_m(at_m).1);
        let (requests, nobody): (Vec<MavMessage>, _) = match source {
            TerrainSource::GroundStation => {
                let request = asked.request(now_s, || places().0);
                let request = request.map(MavMessage::TERRAIN_REQUEST);
                (
                    request.into_iter().collect(),
                    "fga: no terrain from the ground station",
                )
            }
            _ if is_off => (Vec::new(), "fga: no terrain: TERRAIN_ENABLE is 0"),
            TerrainSource::Vehicle => {
                let checks = asked.checks(now_s, places).into_iter();
                (
                    checks.map(MavMessage::TERRAIN_CHECK).collect(),
                    "fga: no terrain from the vehicle",
                )
            }
        };
        let number = asked.number(now_s);
        if terrain.as_ref().is_none_or(|(_, laid)| *laid != number) {
            *terrain = asked.terrain().map(|terrain| (terrain, number));
        }
        let is_unanswered = is_off || asked.is_unanswered();
        for request in requests {
            voice.send(request);
        }
        if is_unanswered && !core::mem::replace(&mut self.told_unanswered, true) {
            voice.warn(nobody);
        }
    }

    /// Takes a piece of ground.
    pub(super) fn take_terrain(&mut self, data: &TERRAIN_DATA_DATA, voice: &mut Voice) {
        if let GroundSource::Asked(TerrainSource::GroundStation, asked, _) = &mut self.heights
            && let Some(words) = asked.take(data)
        {
            voice.warn(words);
        }
    }

    /// Takes the height of a place from the vehicle.
    pub(super) fn take_report(&mut self, data: &TERRAIN_REPORT_DATA, voice: &mut Voice) {
        if let GroundSource::Asked(TerrainSource::Vehicle, asked, _) = &mut self.heights
            && let Some(words) = asked.take_report(data)
        {
            voice.warn(words);
        }
    }

    /// The local frame has moved.
    pub(super) fn forget(&mut self) {
        self.order = None;
        self.ordered = None;
        self.made = None;
    }

    /// Whether ground from files is not made yet. What a ground station does not send, nobody waits for.
    pub(super) const fn is_awaited(&self) -> bool {
        matches!(self.heights, GroundSource::Files(_)) && self.made.is_none()
    }

    /// The ground as it is known now.
    pub(super) fn known(&self) -> Option<&Arc<LocalGround>> {
        self.made.as_ref()?.as_ref().ok()
    }

    /// The ground for a decision, higher by what our own height is uncertain, metres.
    pub(super) fn raised(&self, by_m: f64) -> Option<Ground<'_>> {
        self.known()?.raised(by_m)
    }

    /// Notes whether a decision that has just chosen its manoeuvre chooses another one without the ground.
    pub(super) fn note_bounds(&mut self, decision: &Decision, without: Option<&Decision>) {
        if let Some(without) = without {
            self.bounds = differ(&decision.command, &without.command);
        }
    }

    /// Whether to ask what would have been chosen without the ground.
    pub(super) fn asks_without(&self, decision: &Decision) -> bool {
        let reason = decision.record.reason;
        let has_chosen = matches!(reason, Reason::ManeuverChosen | Reason::ManeuverReplaced);
        has_chosen && self.known().is_some()
    }

    /// Reports each once in a manoeuvre: that the ground decides where it leads, that it leads over unknown ground, or too low.
    pub(super) fn watch(
        &mut self,
        decision: &Decision,
        state: &OwnState,
        around: &ObstaclesAround,
        keeper: &Keeper,
        voice: &mut Voice,
    ) {
        if !keeper.is_engaged() {
            self.told = Reports::default();
        }
        if matches!(self.heights, GroundSource::Nobody) || !keeper.commands() {
            return;
        }
        let ground = self.known();
        let needed_m = ground.map_or(0.0, |ground| ground.clearance_m() + ground.error_m());
        let (mut at_m, mut is_known, mut least_m) = (state.ownship.position_m, true, f64::INFINITY);
        for second in 0..LOOKS_AHEAD {
            let above_m = ground.and_then(|ground| ground.above_m(at_m));
            is_known &= above_m.is_some();
            least_m = least_m.min(above_m.unwrap_or(f64::INFINITY));
            let turned = Vec2::from_angle(state.course_rate_radps * (f64::from(second) + 0.5));
            let flown_m = turned.rotate(state.ground_velocity_mps.truncate());
            at_m += flown_m.extend(state.ground_velocity_mps.z);
        }
        let threat = decision.record.threat;
        let name = threat.map_or_else(|| "traffic".to_owned(), |threat| around.name(threat.id));
        let bounds = self.bounds;
        // A way back turns onto its leg: where it would lead straight on says nothing.
        let is_led_there = decision.state == AvoiderState::Avoiding && !is_known;
        let told = &mut self.told;
        let reports = [
            (
                bounds,
                &mut told.bounds,
                format!("fga: the ground bounds the way round {name}"),
            ),
            (
                is_led_there,
                &mut told.unknown,
                "fga: avoids over unknown ground".to_owned(),
            ),
            (
                least_m < needed_m,
                &mut told.low,
                format!("fga: {least_m:.0} m above ground, asked {needed_m:.0} m"),
            ),
        ];
        for (is_so, told, words) in reports {
            if is_so && !core::mem::replace(told, true) {
                voice.warn(&words);
            }
        }
    }

    /// Compares the measured distance to the ground below, metres, with the known ground. The first difference that lasts makes one report;
    /// the known ground stays as it is.
    pub(super) fn take_distance(
        &mut self,
        distance_m: f64,
        at_m: Vec3,
        own: &OwnState,
        voice: &mut Voice,
    ) {
        let Some((ground, above_m)) = self
            .known()
            .and_then(|ground| Some((ground, ground.above_m(at_m)?)))
        else {
            return;
        };
        let (now_s, allowed_m) = (voice.now_s(), ground.error_m() + MEASURED_M);
        let upright = libm::cos(own.ownship.bank_rad) * libm::cos(own.pitch_rad);
        let higher_m = above_m - distance_m * upright;
        let measured = &mut self.rangefinder;
        measured.heard += 1;
        if higher_m.abs() <= allowed_m {
            measured.since_s = None;
            return;
        }
        measured.disagreeing += 1;
        let since_s = *measured.since_s.get_or_insert(now_s);
        if now_s - since_s >= DISAGREES_S && !core::mem::replace(&mut measured.told, true) {
            let side = if higher_m > 0.0 { "higher" } else { "lower" };
            voice.warn(&format!(
                "fga: rangefinder: ground {:.0} m {side}",
                higher_m.abs()
            ));
        }
    }

    /// What was heard of the ground, for the log.
    pub(super) fn note_heard(&self, voice: &mut Voice) {
        let answers = match &self.heights {
            GroundSource::Nobody => return,
            GroundSource::Files(_) => None,
            GroundSource::Asked(_, asked, _) => Some(asked.answers()),
        };
        let answers = answers.map(|answers| {
            json!({ "taken": answers.taken, "wrong": answers.wrong, "contradicting": answers.contradicting })
        });
        let Rangefinder {
            heard, disagreeing, ..
        } = self.rangefinder;
        let rangefinder = json!({ "heard": heard, "disagreeing": disagreeing });
        let content = json!({ "rangefinder": rangefinder, "pieces": answers });
        voice.note("ground-heard", content);
    }
}

/// The distance that a rangefinder measures, metres, if it looks down and has a signal.
pub(super) fn distance_m(data: &DISTANCE_SENSOR_DATA) -> Option<f64> {
    let range = data.min_distance.saturating_add(1)..data.max_distance;
    let looks_down = data.orientation == MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270;
    // A quality of 1 is no signal.
    let is_usable =
        looks_down && range.contains(&data.current_distance) && data.signal_quality != 1;
    is_usable.then(|| f64::from(data.current_distance) * 1e-2)
}

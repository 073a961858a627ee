//! Rally points: where RTL leads instead of home.
//!
//! ArduPlane chooses when RTL begins: the nearest rally point, if it is within `RALLY_LIMIT_KM` and, with
//! `RALLY_INCL_HOME`, nearer than home. It chooses again when RTL resumes after a manoeuvre. The list
//! matters only if the companion may take over RTL; it is read again when its number, one of its items or the
//! vehicle's number for it changes.

use fga::Vec3;
use mavlink::dialects::ardupilotmega::{
    MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavMissionResult, MavMissionType,
};
use serde_json::json;

use super::Companion;
use super::way::SAME_TARGET_M;
use crate::authority::Severity;
use crate::mission::Download;
use crate::mode::Mode;

/// Interval of requests for the number of points, seconds.
const COUNT_S: f64 = 1.5;
/// Time for requesting the points one after the other, all of them, …
const SEEN_S: f64 = 1.2;
/// … with at least this interval, seconds.
const POINT_S: f64 = 0.15;
/// A rally point must be nearer than the present target by this to replace it, metres.
const NEARER_M: f64 = 50.0;
/// ArduPlane's own value of `RALLY_LIMIT_KM`.
const LIMIT_KM: f64 = 5.0;

/// The vehicle's rally points.
#[derive(Debug)]
pub(super) struct Rally {
    download: Download,
    /// The number of the list download that the operator read about.
    told: u32,
    counted_s: f64,
    point_s: f64,
    point: u16,
    /// The vehicle knows no rally points.
    unsupported: bool,
}

impl Default for Rally {
    fn default() -> Self {
        Self {
            download: Download::new(MavMissionType::MAV_MISSION_TYPE_RALLY),
            told: 0,
            counted_s: f64::NEG_INFINITY,
            point_s: f64::NEG_INFINITY,
            point: 0,
            unsupported: false,
        }
    }
}

impl Companion {
    /// Whether the list matters: RTL may be taken over.
    fn uses_rally(&self) -> bool {
        self.take_over.contains(&Mode::RTL) && !self.rally.unsupported
    }

    pub(super) fn read_rally_again(&mut self) {
        if self.uses_rally() && !self.rally.download.is_busy() {
            self.rally.download.begin();
        }
    }

    /// Goes on reading, or asks for what would show another list.
    pub(super) fn look_at_rally(&mut self, system: u8, now_s: f64) {
        let busy = self.mission.is_busy() || self.fence_download.is_busy();
        if busy || !self.uses_rally() {
            return;
        }
        let rally = &mut self.rally;
        if rally.download.tick(now_s, system, self.voice.outbox()) {
            self.rally_arrived(now_s);
            return;
        }
        let Some(points) = rally.download.items().map(<[_]>::len) else {
            return;
        };
        if rally.download.is_busy() {
            return;
        }
        if now_s - rally.counted_s >= COUNT_S {
            rally.counted_s = now_s;
            self.voice.send(rally.download.count_request(system));
        }
        let Some(points) = u16::try_from(points).ok().filter(|points| *points > 0) else {
            return;
        };
        if now_s >= rally.point_s {
            rally.point_s = now_s + (SEEN_S / f64::from(points)).max(POINT_S);
            rally.point = rally.point.wrapping_add(1) % points;
            let request = rally.download.item_request(rally.point, system);
            self.voice.send(request);
        }
    }

    pub(super) fn take_rally_count(&mut self, data: &MISSION_COUNT_DATA, now_s: f64) {
        if self.rally.download.contradicts_count(data) {
            self.read_rally_again();
        } else if self.rally.download.take_count(data) {
            self.rally_arrived(now_s);
        }
    }

    pub(super) fn take_rally_point(&mut self, data: &MISSION_ITEM_INT_DATA, now_s: f64) {
        if self.rally.download.contradicts_item(data) {
            self.read_rally_again();
        }
        if self.rally.download.take_item(data) {
            self.rally_arrived(now_s);
        }
    }

    /// The vehicle refuses a known point, or has no such list.
    pub(super) fn take_rally_refusal(&mut self, result: MavMissionResult) {
        if result == MavMissionResult::MAV_MISSION_UNSUPPORTED {
            self.rally.unsupported = true;
        } else {
            self.read_rally_again();
        }
    }

    fn rally_arrived(&mut self, now_s: f64) {
        if let Some(system) = self.vehicle_system() {
            self.voice.send(self.rally.download.closing(system));
        }
        let changes = self.rally.download.changes();
        let before = core::mem::replace(&mut self.rally.told, changes);
        if before == changes {
            return;
        }
        let count = self.rally.download.items().map_or(0, <[_]>::len);
        self.voice.note(now_s, "rally", json!({ "points": count }));
        if before > 0 {
            let words = "fga: the rally points have changed";
            self.voice.tell(Severity::Notice, words, now_s);
        }
    }

    /// The target of RTL from here by the lists, metres, local frame, at the aircraft's height.
    pub(super) fn return_place_m(&self, own_m: Vec3) -> Option<Vec3> {
        let away_m = |place_m: &Vec3| (*place_m - own_m).truncate().length();
        let home_m = self.home_m(own_m);
        let limit_m = 1e3 * self.parameters.get("RALLY_LIMIT_KM").unwrap_or(LIMIT_KM);
        let with_home = self.parameters.get("RALLY_INCL_HOME") == Some(1.0);
        let rally_m = self
            .rally_points_m(own_m)
            .min_by(|a, b| away_m(a).total_cmp(&away_m(b)))
            .filter(|at_m| limit_m <= 0.0 || away_m(at_m) <= limit_m)
            .filter(|at_m| {
                !with_home || home_m.is_none_or(|home_m| away_m(at_m) < away_m(&home_m))
            });
        rally_m.or(home_m)
    }

    /// The target of RTL once it is restored, if it differs from the present way's.
    pub(super) fn other_return_place_m(&self, own_m: Vec3) -> Option<Vec3> {
        // Without a list only the vehicle's report from before the manoeuvre is known.
        self.rally.download.items()?;
        let to_m = self.return_place_m(own_m)?;
        let away_m = |place_m: Vec3| (place_m - own_m).truncate().length();
        let laid_m = self.way.waypoints_m.last().copied()?;
        if (to_m - laid_m).truncate().length() <= SAME_TARGET_M {
            return None;
        }
        let still_there = self
            .rally_points_m(own_m)
            .any(|at_m| (at_m - laid_m).truncate().length() < 1.0);
        let nearer = away_m(to_m) + NEARER_M < away_m(laid_m);
        (!still_there || nearer).then_some(to_m)
    }

    /// The points, metres, local frame, at the aircraft's height.
    fn rally_points_m(&self, own_m: Vec3) -> impl Iterator<Item = Vec3> + '_ {
        let items = self.rally.download.items().unwrap_or_default();
        let frame = self.ownship.frame();
        items.iter().filter_map(move |item| {
            let item = item.as_ref()?;
            if item.command != MavCmd::MAV_CMD_NAV_RALLY_POINT {
                return None;
            }
            let place = crate::mission::place_of(item, own_m.z)?;
            Some(frame?.to_local_m(place).with_z(own_m.z))
        })
    }
}

//! Whether the vehicle still flies the known mission.
//!
//! A ground station may upload another mission on another link, and no message says so. The vehicle's
//! behaviour shows it: the item that it begins, its target, the numbers of its lists. Any such hint, and the
//! clock, trigger a request for the present item alone; if that differs from the known item, the companion
//! reads the list again. Until then the way leads to the vehicle's own target.

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use mavlink::dialects::ardupilotmega::{
    MISSION_ACK_DATA, MISSION_CURRENT_DATA, MISSION_ITEM_INT_DATA, MavMissionResult,
    MavMissionType, NAV_CONTROLLER_OUTPUT_DATA, POSITION_TARGET_GLOBAL_INT_DATA, STATUSTEXT_DATA,
};

use super::Companion;
use crate::mission::item_position_m;
use crate::mode::Mode;
use crate::number::degrees_from_e7;
use crate::outgoing::OWN_COMPONENT;

/// Interval of requests for the present item without a hint, seconds.
const PROBE_S: f64 = 1.0;
/// … and the least interval with one, or after a download, seconds.
const HINTED_PROBE_S: f64 = 0.3;
/// Number of items ahead that are requested in turn: as far as a way is laid.
const PROBED_ITEMS: u16 = 12;
/// Interval of requests for the number of the fence's items, seconds.
const FENCE_COUNT_S: f64 = 2.0;
/// Time for requesting the fence's items one after the other, all of them, …
const FENCE_SEEN_S: f64 = 1.2;
/// … with at least this interval, seconds.
const FENCE_ITEM_S: f64 = 0.1;
/// The vehicle's target belongs to its present mode from this long after a change of mode, s.
const MODE_SETTLES_S: f64 = 0.7;
/// An older target is unknown, seconds.
const TARGET_LIFETIME_S: f64 = 2.5;
/// Least distance between the target and the item's position that shows another item, metres.
const OTHER_TARGET_M: f64 = 15.0;
/// Accuracy of a target from distance and bearing in whole metres and degrees, metres and as a share of the distance.
const BEARING_TARGET_M: f64 = 60.0;
const BEARING_TARGET_SHARE: f64 = 0.03;
/// The target disagrees only after this time: item and target arrive at different moments, seconds.
const DISAGREES_S: f64 = 1.2;

/// The vehicle's own target.
#[derive(Debug, Clone, Copy)]
struct VehicleTarget {
    position_m: Vec3,
    heard_s: f64,
    /// Its accuracy, metres.
    within_m: f64,
}

/// Observations of the vehicle's lists.
#[derive(Debug, Clone)]
pub(super) struct MissionWatch {
    target: Option<VehicleTarget>,
    mode_since_s: f64,
    disagrees_since_s: Option<f64>,
    hinted: bool,
    probed_s: f64,
    probes: u16,
    /// Probes left at the pace of a hint: a list may have changed while it was read.
    brisk: u16,
    fence_counted_s: f64,
    fence_item_s: f64,
    fence_items: u16,
    /// Numbers of the vehicle's lists, if it sends them.
    ids: [Option<u32>; 3],
}

impl Default for MissionWatch {
    fn default() -> Self {
        Self {
            target: None,
            mode_since_s: f64::NEG_INFINITY,
            disagrees_since_s: None,
            hinted: false,
            probed_s: f64::NEG_INFINITY,
            probes: 0,
            brisk: 0,
            fence_counted_s: f64::NEG_INFINITY,
            fence_item_s: f64::NEG_INFINITY,
            fence_items: 0,
            ids: [None; 3],
        }
    }
}

impl MissionWatch {
    /// A hint of another mission: requests the present item.
    pub(super) fn hint(&mut self) {
        self.hinted = true;
    }

    /// A list has just been read.
    pub(super) const fn read(&mut self) {
        self.brisk = 2 * PROBED_ITEMS;
    }

    /// The mode has changed, and so the target.
    pub(super) fn mode_changed(&mut self, now_s: f64) {
        self.mode_since_s = now_s;
        self.target = None;
        self.disagrees_since_s = None;
    }

    /// Whether item and target have disagreed for too long to be only messages from different moments.
    fn disagrees(&self, now_s: f64) -> bool {
        self.disagrees_since_s
            .is_some_and(|since_s| now_s - since_s >= DISAGREES_S)
    }
}

impl Companion {
    /// The vehicle's own target in its present mode, metres, local frame.
    pub(super) fn own_target_m(&self, now_s: f64) -> Option<Vec3> {
        let target = self.watch.target?;
        (now_s - target.heard_s <= TARGET_LIFETIME_S).then_some(target.position_m)
    }

    /// Whether the mission cannot give the way: the companion is reading it again, or the vehicle flies elsewhere.
    pub(super) fn mission_in_doubt(&self, now_s: f64) -> bool {
        self.mission.is_busy() || self.watch.disagrees(now_s) || self.item_place_m().is_none()
    }

    /// Place of the present item, metres, local frame.
    fn item_place_m(&self) -> Option<Vec3> {
        let index = usize::from(self.mission_item?);
        let item = self.mission.items()?.get(index)?.as_ref()?;
        let home_m = self.ownship.home_altitude_m()?;
        item_position_m(item, self.ownship.frame()?, home_m, 0.0)
    }

    pub(super) fn take_position_target(
        &mut self,
        data: &POSITION_TARGET_GLOBAL_INT_DATA,
        now_s: f64,
    ) {
        let place = Geodetic::new(
            degrees_from_e7(data.lat_int),
            degrees_from_e7(data.lon_int),
            0.0,
        );
        let known = place.filter(|_| data.lat_int != 0 || data.lon_int != 0);
        let (Some(place), Some(frame)) = (known, self.ownship.frame()) else {
            return;
        };
        let position_m = frame.to_local_m(place);
        self.take_target(position_m, OTHER_TARGET_M, now_s);
    }

    pub(super) fn take_nav(&mut self, data: &NAV_CONTROLLER_OUTPUT_DATA, now_s: f64) {
        let exact = self.watch.target.is_some_and(|target| {
            target.within_m <= OTHER_TARGET_M && now_s - target.heard_s <= TARGET_LIFETIME_S
        });
        // Distances beyond 65 km do not fit the message.
        let usable = data.wp_dist > 0 && data.wp_dist < u16::MAX;
        let Some(own_m) = self.ownship.position_m(now_s).filter(|_| usable && !exact) else {
            return;
        };
        let distance_m = f64::from(data.wp_dist);
        let (sin, cos) = f64::from(data.target_bearing).to_radians().sin_cos();
        let position_m = own_m + Vec3::new(sin, cos, 0.0) * distance_m;
        let within_m = BEARING_TARGET_M + BEARING_TARGET_SHARE * distance_m;
        self.take_target(position_m, within_m, now_s);
    }

    fn take_target(&mut self, position_m: Vec3, within_m: f64, now_s: f64) {
        if now_s - self.watch.mode_since_s < MODE_SETTLES_S {
            return;
        }
        self.watch.target = Some(VehicleTarget {
            position_m,
            heard_s: now_s,
            within_m,
        });
        let in_auto = self.session.mode() == Some(Mode::AUTO);
        let off = |place_m: Vec3| (place_m - position_m).truncate().length() > within_m;
        if !in_auto || !self.item_place_m().is_some_and(off) {
            self.watch.disagrees_since_s = None;
            return;
        }
        self.watch.disagrees_since_s.get_or_insert(now_s);
        self.watch.hint();
    }

    pub(super) fn take_mission_current(&mut self, data: &MISSION_CURRENT_DATA) {
        let before = self.mission_item.replace(data.seq);
        self.mission.read_first(data.seq);
        if before.is_some_and(|before| data.seq != before) {
            self.watch.hint();
        }
        // Newer autopilots send the number of items: another number is another mission.
        if data.total != 0 && data.total != u16::MAX {
            let changed = self.mission_total.is_some_and(|total| total != data.total);
            self.mission_total = Some(data.total);
            if changed {
                self.read_mission_again();
            }
        }
        let told = [data.mission_id, data.fence_id, data.rally_points_id];
        let mut changed = [false; 3];
        for ((known, told), changed) in self.watch.ids.iter_mut().zip(told).zip(&mut changed) {
            // A vehicle without such a number sends 0.
            if told != 0 {
                *changed = known.replace(told).is_some_and(|known| known != told);
            }
        }
        let [mission, fence, rally] = changed;
        if mission {
            self.read_mission_again();
        }
        if fence {
            self.read_fence_again();
        }
        if rally {
            self.read_rally_again();
        }
    }

    /// The vehicle describes its actions in words.
    pub(super) fn take_vehicle_text(&mut self, data: &STATUSTEXT_DATA) {
        let Ok(text) = data.text.to_str() else { return };
        if text.starts_with("Mission:") || text.contains("light plan") {
            self.watch.hint();
        }
        if text.contains("ence") {
            self.watch.fence_counted_s = f64::NEG_INFINITY;
        }
    }

    /// The vehicle refuses an item of the known list, or lets nobody read because somebody uploads: either way
    /// the list is another one.
    pub(super) fn take_mission_refusal(&mut self, data: &MISSION_ACK_DATA) {
        let accepted = data.mavtype == MavMissionResult::MAV_MISSION_ACCEPTED;
        if accepted || data.target_component != OWN_COMPONENT {
            return;
        }
        if data.mission_type == self.mission.kind() {
            self.mission.refused();
        } else if data.mission_type == self.fence_download.kind() {
            if self.config.safety.use_fence {
                self.fence_download.refused();
            }
        } else if data.mission_type == MavMissionType::MAV_MISSION_TYPE_RALLY {
            self.take_rally_refusal(data.mavtype);
        }
    }

    pub(super) fn compare_item(&mut self, data: &MISSION_ITEM_INT_DATA) {
        if self.mission.contradicts_item(data) {
            self.read_mission_again();
        }
        if self.fence_download.contradicts_item(data) {
            self.read_fence_again();
        }
    }

    pub(super) fn read_mission_again(&mut self) {
        if !self.mission.is_busy() {
            self.mission.begin();
        }
    }

    pub(super) fn read_fence_again(&mut self) {
        if self.config.safety.use_fence && !self.fence_download.is_busy() {
            self.fence_download.begin();
        }
    }

    /// Requests messages that would show another list.
    pub(super) fn probe_lists(&mut self, system: u8, now_s: f64) {
        let since_s = now_s - self.watch.probed_s;
        let brisk = self.watch.hinted || self.watch.brisk > 0;
        let due = since_s >= PROBE_S || (brisk && since_s >= HINTED_PROBE_S);
        if let Some(items) = self.mission.items()
            && due
            && !self.mission.is_busy()
            && !items.is_empty()
        {
            self.watch.probed_s = now_s;
            self.watch.hinted = false;
            self.watch.brisk = self.watch.brisk.saturating_sub(1);
            self.watch.probes = self.watch.probes.wrapping_add(1);
            let last = u16::try_from(items.len() - 1).unwrap_or(u16::MAX);
            let item = self.mission_item.unwrap_or(0);
            // The present item, and those ahead in turn.
            let (turn, half) = (self.watch.probes / 2, self.watch.probes % 2);
            let item = item
                .saturating_add(half * (1 + turn % PROBED_ITEMS))
                .min(last);
            self.voice.send(self.mission.item_request(item, system));
        }
        let counts = self.config.safety.use_fence && self.fence_download.items().is_some();
        if counts
            && !self.fence_download.is_busy()
            && now_s - self.watch.fence_counted_s >= FENCE_COUNT_S
        {
            self.watch.fence_counted_s = now_s;
            self.voice.send(self.fence_download.count_request(system));
        }
        self.probe_fence_items(system, now_s);
    }

    /// Requests the fence's items in turn: a moved item does not change their number.
    fn probe_fence_items(&mut self, system: u8, now_s: f64) {
        let count = self.fence_download.items().map_or(0, <[_]>::len);
        let busy = self.fence_download.is_busy() || self.mission.is_busy();
        let Ok(count) = u16::try_from(count) else {
            return;
        };
        if busy || count == 0 || now_s < self.watch.fence_item_s || !self.config.safety.use_fence {
            return;
        }
        self.watch.fence_item_s = now_s + (FENCE_SEEN_S / f64::from(count)).max(FENCE_ITEM_S);
        self.watch.fence_items = self.watch.fence_items.wrapping_add(1) % count;
        let request = self
            .fence_download
            .item_request(self.watch.fence_items, system);
        self.voice.send(request);
    }
}

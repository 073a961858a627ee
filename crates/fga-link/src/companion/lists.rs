//! What does the vehicle intend: which mission, fence and rally points does it have now?
//!
//! A ground station may upload another mission on another link, and no message says so. The vehicle's
//! behaviour shows it: the item that it begins, its target, the numbers of its lists. Any such hint, and the
//! clock, trigger a request for the present item alone; if that differs from the known item, the companion
//! reads the list again. Until then the way leads to the vehicle's own target.

use fga::Vec3;
use mavlink::dialects::ardupilotmega::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_CURRENT_DATA, MISSION_ITEM_INT_DATA, MavMessage,
    MavMissionResult, MavMissionType, STATUSTEXT_DATA,
};

use super::target::OwnTarget;
use super::voice::Voice;
use super::watched::Watched;
use crate::mission::{ListItem, item_position_m};
use crate::outgoing::OWN_COMPONENT;
use crate::ownship::OwnshipEstimate;

/// Interval of requests for the present item without a hint, seconds.
const PROBE_S: f64 = 1.0;
/// … and the least interval with one, or after a download, seconds.
const HINTED_PROBE_S: f64 = 0.3;
/// Number of items ahead that are requested in turn: as far as a way is laid.
const PROBED_ITEMS: u16 = 12;
/// Interval of requests for the number of the fence's items, seconds.
const FENCE_COUNT_S: f64 = 2.0;
/// Least interval of requests for the fence's items, seconds.
const FENCE_ITEM_S: f64 = 0.1;
/// Interval between downloads of the fence, seconds.
const FENCE_AGAIN_S: f64 = 10.0;
/// The same two intervals for the rally points, seconds.
const RALLY_COUNT_S: f64 = 1.5;
const RALLY_POINT_S: f64 = 0.15;

/// The vehicle's lists, and its place in the mission.
#[derive(Debug)]
pub(super) struct Lists {
    mission: Watched,
    /// The vehicle's present item, and the number of items that it reports.
    item: Option<u16>,
    total: Option<u16>,
    target: OwnTarget,
    hinted: bool,
    probed_s: f64,
    /// The number of the mission that was probed last.
    probed_number: u32,
    probes: u16,
    /// Probes left at the pace of a hint: a list may have changed while it was read.
    brisk: u16,
    fence: Watched,
    fence_due_s: f64,
    rally: Watched,
}

impl Lists {
    /// Nothing is known yet. Fence and rally points are read only where they matter.
    pub(super) fn new(use_fence: bool, use_rally: bool) -> Self {
        let mission = MavMissionType::MAV_MISSION_TYPE_MISSION;
        let fence = MavMissionType::MAV_MISSION_TYPE_FENCE;
        let rally = MavMissionType::MAV_MISSION_TYPE_RALLY;
        let of_mission = ["mission", "items", "fga: the mission has changed"];
        let of_rally = ["rally", "points", "fga: the rally points have changed"];
        Self {
            mission: Watched::new(mission, Some(of_mission), true, [f64::INFINITY; 2]),
            item: None,
            total: None,
            target: OwnTarget::default(),
            hinted: false,
            probed_s: f64::NEG_INFINITY,
            probed_number: 0,
            probes: 0,
            brisk: 0,
            fence: Watched::new(fence, None, use_fence, [FENCE_COUNT_S, FENCE_ITEM_S]),
            fence_due_s: f64::NEG_INFINITY,
            rally: Watched::new(
                rally,
                Some(of_rally),
                use_rally,
                [RALLY_COUNT_S, RALLY_POINT_S],
            ),
        }
    }

    /// The vehicle's present mission item.
    pub(super) const fn item(&self) -> Option<u16> {
        self.item
    }

    /// The mission, once read.
    pub(super) fn mission(&self) -> Option<&[ListItem]> {
        self.mission.items()
    }

    /// An item of the mission, also of one that is being read for the first time.
    pub(super) fn mission_item(&self, index: u16) -> Option<&MISSION_ITEM_INT_DATA> {
        self.mission.download.item(index)
    }

    /// Number of missions read so far that differed from the one before.
    pub(super) const fn mission_number(&self) -> u32 {
        self.mission.download.changes()
    }

    /// The fence, once read, and the number of fences so far.
    pub(super) fn fence(&self) -> Option<(&[ListItem], u32)> {
        Some((self.fence.items()?, self.fence.download.changes()))
    }

    /// The rally points, once read.
    pub(super) fn rally(&self) -> Option<&[ListItem]> {
        self.rally.items()
    }

    /// The vehicle's own target in its present mode, metres, local frame.
    pub(super) fn own_target_m(&self, now_s: f64) -> Option<Vec3> {
        self.target.position_m(now_s)
    }

    /// Whether the way in AUTO is known: the mission, or while it is read the vehicle's own target and its item.
    pub(super) fn is_way_known(&self, now_s: f64) -> bool {
        let Some(item) = self.item else { return false };
        let has_target = || self.own_target_m(now_s).is_some();
        self.mission().is_some() || (self.mission_item(item).is_some() && has_target())
    }

    /// Whether the mission cannot give the way: it is being read again, or the vehicle flies elsewhere.
    pub(super) fn is_in_doubt(&self, ownship: &OwnshipEstimate, now_s: f64) -> bool {
        self.mission.is_busy()
            || self.target.disagrees(now_s)
            || self.item_place_m(ownship).is_none()
    }

    /// Place of the present item, metres, local frame.
    fn item_place_m(&self, ownship: &OwnshipEstimate) -> Option<Vec3> {
        let item = self.mission()?.get(usize::from(self.item?))?.as_ref()?;
        let home_m = ownship.home_altitude_m()?;
        item_position_m(item, ownship.frame()?, home_m, 0.0)
    }

    /// Place of home by the mission, metres, local frame, at a height.
    pub(super) fn home_m(&self, ownship: &OwnshipEstimate, height_m: f64) -> Option<Vec3> {
        let item = self.mission()?.first()?.as_ref()?;
        let home_m = ownship.home_altitude_m()?;
        let at_m = item_position_m(item, ownship.frame()?, home_m, height_m)?;
        Some(at_m.with_z(height_m))
    }

    const fn all(&mut self) -> [&mut Watched; 3] {
        [&mut self.mission, &mut self.fence, &mut self.rally]
    }

    /// The vehicle was heard for the first time.
    pub(super) fn begin(&mut self) {
        self.all().into_iter().for_each(Watched::read_again);
    }

    /// The mode has changed, and so the target; or the local frame.
    pub(super) const fn mode_changed(&mut self, now_s: f64) {
        self.target.mode_changed(now_s);
    }

    /// Takes a number of items.
    pub(super) fn take_count(&mut self, data: &MISSION_COUNT_DATA, voice: &mut Voice) {
        for list in self.all() {
            list.take_count(data, voice);
        }
    }

    /// Takes an item.
    pub(super) fn take_item(&mut self, data: &MISSION_ITEM_INT_DATA, voice: &mut Voice) {
        for list in self.all() {
            list.take_item(data, voice);
        }
    }

    /// Takes a target that the vehicle reports by its place, or by distance and bearing; `in_auto` while it flies its mission.
    pub(super) fn take_target(
        &mut self,
        message: &MavMessage,
        ownship: &OwnshipEstimate,
        in_auto: bool,
        now_s: f64,
    ) {
        let reported = match message {
            MavMessage::POSITION_TARGET_GLOBAL_INT(data) => OwnTarget::of_place(data, ownship),
            MavMessage::NAV_CONTROLLER_OUTPUT(data) => self.target.of_bearing(data, ownship, now_s),
            _ => None,
        };
        let item_m = self.item_place_m(ownship).filter(|_| in_auto);
        if self.target.take(reported, item_m, now_s) {
            self.hinted = true;
        }
    }

    /// Takes the present item, and the numbers of the lists.
    pub(super) fn take_current(&mut self, data: &MISSION_CURRENT_DATA) {
        let before = self.item.replace(data.seq);
        self.mission.download.read_first(data.seq);
        if before.is_some_and(|before| data.seq != before) {
            self.hinted = true;
        }
        // Newer autopilots send the number of items: another number is another mission.
        if data.total != 0 && data.total != u16::MAX {
            let before = self.total.replace(data.total);
            if before.is_some_and(|before| before != data.total) {
                self.mission.read_again();
            }
        }
        let told = [data.mission_id, data.fence_id, data.rally_points_id];
        for (list, number) in self.all().into_iter().zip(told) {
            list.take_number(number);
        }
    }

    /// The vehicle describes its actions in words.
    pub(super) fn take_text(&mut self, data: &STATUSTEXT_DATA) {
        let Ok(text) = data.text.to_str() else { return };
        if text.starts_with("Mission:") || text.contains("light plan") {
            self.hinted = true;
        }
        if text.contains("ence") {
            self.fence.hint();
        }
    }

    /// Takes the end of a transfer. Somebody else has just uploaded a list; or the vehicle refuses an item of the known
    /// list, or lets nobody read because somebody uploads. Either way the list is another one.
    pub(super) fn take_ack(&mut self, data: &MISSION_ACK_DATA) {
        let for_us = data.target_component == OWN_COMPONENT;
        let accepted = data.mavtype == MavMissionResult::MAV_MISSION_ACCEPTED;
        let uploaded = !for_us && data.target_system != 0;
        if !(uploaded || for_us && !accepted) {
            return;
        }
        let list = match data.mission_type {
            MavMissionType::MAV_MISSION_TYPE_MISSION => &mut self.mission,
            MavMissionType::MAV_MISSION_TYPE_FENCE => &mut self.fence,
            MavMissionType::MAV_MISSION_TYPE_RALLY => {
                // A vehicle may have no such list.
                if !uploaded && data.mavtype == MavMissionResult::MAV_MISSION_UNSUPPORTED {
                    self.rally.leave();
                }
                return self.rally.read_again();
            }
            MavMissionType::MAV_MISSION_TYPE_ALL => return,
        };
        if uploaded {
            list.read_again();
        } else {
            list.refused();
        }
    }

    /// Goes on reading, and requests what would show another list; `engaged` in a manoeuvre.
    pub(super) fn tick(&mut self, engaged: bool, voice: &mut Voice) {
        let now_s = voice.now_s();
        self.mission.tick(voice);
        if !self.mission.is_busy() {
            self.fence.tick(voice);
        }
        self.probe_mission(voice);
        let is_read = !self.mission.is_busy();
        self.fence.look(is_read, voice);
        if is_read && !self.fence.is_busy() && !self.rally.tick(voice) {
            self.rally.look(true, voice);
        }
        // Now and then the whole fence.
        if self.fence.is_busy() {
            self.fence_due_s = now_s + FENCE_AGAIN_S;
        } else if now_s >= self.fence_due_s && self.fence.items().is_some() && !engaged {
            self.fence.read_again();
        }
    }

    /// Requests the present item, and those ahead in turn.
    fn probe_mission(&mut self, voice: &mut Voice) {
        let (system, now_s) = (voice.system(), voice.now_s());
        let number = self.mission_number();
        if core::mem::replace(&mut self.probed_number, number) != number {
            self.brisk = 2 * PROBED_ITEMS;
        }
        let since_s = now_s - self.probed_s;
        let brisk = self.hinted || self.brisk > 0;
        let due = since_s >= PROBE_S || (brisk && since_s >= HINTED_PROBE_S);
        let count = self.mission().map_or(0, <[_]>::len);
        if !due || self.mission.is_busy() || count == 0 {
            return;
        }
        self.probed_s = now_s;
        self.hinted = false;
        self.brisk = self.brisk.saturating_sub(1);
        self.probes = self.probes.wrapping_add(1);
        let last = u16::try_from(count - 1).unwrap_or(u16::MAX);
        let item = self.item.unwrap_or(0);
        let (turn, half) = (self.probes / 2, self.probes % 2);
        let item = item
            .saturating_add(half * (1 + turn % PROBED_ITEMS))
            .min(last);
        voice.send(self.mission.download.item_request(item, system));
    }
}

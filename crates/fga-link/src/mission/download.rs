//! A list of mission, fence or rally items, downloaded from the vehicle.

use mavlink::dialects::ardupilotmega::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA,
    MISSION_REQUEST_LIST_DATA, MavMessage, MavMissionResult, MavMissionType,
};

use crate::outgoing::{ANSWER_S, AUTOPILOT, Outbox};

/// Longest accepted list.
pub const MOST_ITEMS: usize = 2000;
/// Most items requested at a time.
const WINDOW: usize = 5;
/// Attempts before an item counts as unreadable (a command that this dialect lacks): enough that no
/// link loses all of them.
const MOST_ATTEMPTS: u8 = 25;
/// Attempts before giving up the whole list, to begin again later.
const LIST_PAUSE_S: f64 = 3.0;

/// An item; `None` for one that could not be read.
pub type ListItem = Option<MISSION_ITEM_INT_DATA>;

/// An item without the fields that differ between messages about the same item.
fn bare(data: &MISSION_ITEM_INT_DATA) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        current: 0,
        target_system: 0,
        target_component: 0,
        ..data.clone()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum DownloadStage {
    Idle,
    Count,
    Items,
}

/// An item in transit.
#[derive(Debug, Clone)]
struct Awaited {
    /// The result; the inner `None` is an item that was given up.
    item: Option<ListItem>,
    attempts: u8,
    again_s: f64,
}

impl Awaited {
    const NEW: Self = Self {
        item: None,
        attempts: 0,
        again_s: f64::NEG_INFINITY,
    };
}

/// A download of one kind of list.
#[derive(Debug)]
pub struct Download {
    kind: MavMissionType,
    stage: DownloadStage,
    arriving: Vec<Awaited>,
    attempts: u8,
    again_s: f64,
    /// The item to read first.
    first: u16,
    items: Option<Vec<ListItem>>,
    changes: u32,
}

impl Download {
    /// Nothing downloaded yet.
    pub const fn new(kind: MavMissionType) -> Self {
        Self {
            kind,
            stage: DownloadStage::Idle,
            arriving: Vec::new(),
            attempts: 0,
            again_s: f64::NEG_INFINITY,
            first: 0,
            items: None,
            changes: 0,
        }
    }

    /// Number of downloads that differed from the previous one.
    pub const fn changes(&self) -> u32 {
        self.changes
    }

    /// An item of the last complete list, or one that has arrived of the list that is being read for the first time.
    pub fn item(&self, index: u16) -> Option<&MISSION_ITEM_INT_DATA> {
        let index = usize::from(index);
        match &self.items {
            Some(items) => items.get(index)?.as_ref(),
            None => self.arriving.get(index)?.item.as_ref()?.as_ref(),
        }
    }

    /// Reads this item before the others.
    pub const fn read_first(&mut self, index: u16) {
        self.first = index;
    }

    /// The vehicle refuses an item: the list has changed while it was read. Begins again.
    pub fn refused(&mut self) {
        if self.stage != DownloadStage::Count {
            self.begin();
        }
    }

    /// The last complete list.
    pub fn items(&self) -> Option<&[ListItem]> {
        self.items.as_deref()
    }

    /// Whether a download is in progress.
    pub fn is_busy(&self) -> bool {
        self.stage != DownloadStage::Idle
    }

    /// Begins to download.
    pub fn begin(&mut self) {
        self.stage = DownloadStage::Count;
        self.arriving.clear();
        self.attempts = 0;
        self.again_s = f64::NEG_INFINITY;
    }

    /// Whether an unrequested number of items differs from the known list.
    pub fn contradicts_count(&self, data: &MISSION_COUNT_DATA) -> bool {
        data.mission_type == self.kind
            && self.stage == DownloadStage::Idle
            && self
                .items()
                .is_some_and(|items| items.len() != usize::from(data.count).min(MOST_ITEMS))
    }

    /// Whether a single requested item differs from the one in the known list.
    pub fn contradicts_item(&self, data: &MISSION_ITEM_INT_DATA) -> bool {
        data.mission_type == self.kind
            && self.stage == DownloadStage::Idle
            && self
                .items()
                .and_then(|items| items.get(usize::from(data.seq)))
                .is_none_or(|known| known.as_ref().is_some_and(|known| *known != bare(data)))
    }

    /// Takes the number of items; `true` if that completes the list.
    pub fn take_count(&mut self, data: &MISSION_COUNT_DATA) -> bool {
        if data.mission_type != self.kind || self.stage != DownloadStage::Count {
            return false;
        }
        self.arriving = vec![Awaited::NEW; usize::from(data.count).min(MOST_ITEMS)];
        self.stage = DownloadStage::Items;
        self.finish_if_whole()
    }

    /// Takes an item, in any order; `true` if that completes the list.
    pub fn take_item(&mut self, data: &MISSION_ITEM_INT_DATA) -> bool {
        if data.mission_type != self.kind || self.stage != DownloadStage::Items {
            return false;
        }
        match self.arriving.get_mut(usize::from(data.seq)) {
            Some(awaited) if awaited.item.is_none() => awaited.item = Some(Some(bare(data))),
            _ => return false,
        }
        self.finish_if_whole()
    }

    fn finish_if_whole(&mut self) -> bool {
        if self.arriving.iter().any(|awaited| awaited.item.is_none()) {
            return false;
        }
        let arrived = core::mem::take(&mut self.arriving);
        let arrived: Option<Vec<ListItem>> =
            arrived.into_iter().map(|awaited| awaited.item).collect();
        if arrived != self.items {
            self.items = arrived;
            self.changes += 1;
        }
        self.stage = DownloadStage::Idle;
        true
    }

    /// Requests missing items; `true` if giving up the rest completes the list.
    pub fn tick(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) -> bool {
        match self.stage {
            DownloadStage::Idle => false,
            DownloadStage::Count => {
                self.ask_for_count(now_s, target_system, outbox);
                false
            }
            DownloadStage::Items => {
                self.ask_for_items(now_s, target_system, outbox);
                self.finish_if_whole()
            }
        }
    }

    fn ask_for_count(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) {
        if now_s < self.again_s {
            return;
        }
        if self.attempts >= MOST_ATTEMPTS {
            self.attempts = 0;
            self.again_s = now_s + LIST_PAUSE_S;
            return;
        }
        self.attempts += 1;
        self.again_s = now_s + ANSWER_S;
        outbox.send(self.count_request(target_system));
    }

    fn ask_for_items(&mut self, now_s: f64, target_system: u8, outbox: &mut Outbox) {
        let kind = self.kind;
        // From the first wanted one on, then those before it.
        let first = usize::from(self.first).min(self.arriving.len());
        let (before, from) = self.arriving.split_at_mut(first);
        let missing = (first..)
            .zip(from)
            .chain((0..).zip(before))
            .filter(|(_, awaited)| awaited.item.is_none());
        for (index, awaited) in missing.take(WINDOW) {
            if now_s < awaited.again_s {
                continue;
            }
            if awaited.attempts >= MOST_ATTEMPTS {
                awaited.item = Some(None);
                continue;
            }
            awaited.attempts += 1;
            awaited.again_s = now_s + ANSWER_S;
            let seq = u16::try_from(index).unwrap_or(u16::MAX);
            outbox.send(item_request(kind, seq, target_system));
        }
    }

    /// The message that requests the number of items.
    pub fn count_request(&self, target_system: u8) -> MavMessage {
        MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
            target_system,
            target_component: AUTOPILOT,
            mission_type: self.kind,
        })
    }

    /// The message that requests one item.
    pub fn item_request(&self, seq: u16, target_system: u8) -> MavMessage {
        item_request(self.kind, seq, target_system)
    }

    /// The closing message of a download, which the vehicle waits for.
    pub fn closing(&self, target_system: u8) -> MavMessage {
        MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system,
            target_component: AUTOPILOT,
            mavtype: MavMissionResult::MAV_MISSION_ACCEPTED,
            mission_type: self.kind,
            opaque_id: 0,
        })
    }
}

fn item_request(kind: MavMissionType, seq: u16, target_system: u8) -> MavMessage {
    MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
        seq,
        target_system,
        target_component: AUTOPILOT,
        mission_type: kind,
    })
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega::MavCmd;

    use super::*;
    use crate::mission::tests::item;

    #[test]
    fn a_list_is_downloaded_through_losses() {
        let mut outbox = Outbox::default();
        let mut download = Download::new(MavMissionType::MAV_MISSION_TYPE_MISSION);
        download.begin();
        download.tick(0.0, 1, &mut outbox);
        download.tick(1.0, 1, &mut outbox);
        assert_eq!(outbox.take().len(), 2);
        let count = MISSION_COUNT_DATA {
            count: 2,
            ..MISSION_COUNT_DATA::DEFAULT
        };
        assert!(!download.take_count(&count));
        let first = item(0, MavCmd::MAV_CMD_NAV_WAYPOINT, 1, 1);
        let second = item(1, MavCmd::MAV_CMD_NAV_WAYPOINT, 2, 2);
        download.tick(1.0, 1, &mut outbox);
        assert_eq!(outbox.take().len(), 2, "both at once");
        assert!(!download.take_item(&second), "out of order");
        assert!(!download.take_item(&second), "a copy");
        assert!(download.take_item(&first));
        let items = download.items().unwrap();
        assert_eq!(items.len(), 2);
        assert_eq!(items[1].as_ref().unwrap().x, 2);
        // The same list again is no change, whatever its current item.
        download.begin();
        download.take_count(&count);
        download.take_item(&first);
        let flown_to = MISSION_ITEM_INT_DATA {
            current: 1,
            target_system: 1,
            ..second
        };
        assert!(download.take_item(&flown_to));
        assert_eq!(download.changes(), 1);
        assert!(!download.contradicts_item(&flown_to));
        let moved = MISSION_ITEM_INT_DATA { x: 3, ..flown_to };
        assert!(download.contradicts_item(&moved));
    }

    #[test]
    fn an_unreadable_item_does_not_stop_the_list() {
        let mut outbox = Outbox::default();
        let mut download = Download::new(MavMissionType::MAV_MISSION_TYPE_MISSION);
        download.begin();
        download.take_count(&MISSION_COUNT_DATA {
            count: 1,
            ..MISSION_COUNT_DATA::DEFAULT
        });
        for n in 0..40_u8 {
            download.tick(f64::from(n), 1, &mut outbox);
        }
        assert_eq!(download.items(), Some(&[None][..]));
    }
}

//! A list of the vehicle: read, read again where it may have changed, and looked at, because no message reports every change.

use mavlink::dialects::ardupilotmega::{MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavMissionType};
use serde_json::json;

use super::voice::Voice;
use crate::authority::Severity;
use crate::mission::{Download, ListItem};

/// Time for requesting the items one after the other, all of them, seconds.
const SEEN_S: f64 = 1.2;

/// A list, and when it is looked at again.
#[derive(Debug)]
pub(super) struct Watched {
    pub(super) download: Download,
    /// Names of the list and of its items in the log, and what the operator reads of another one; `None` where somebody else reports it.
    names: Option<[&'static str; 3]>,
    /// Whether the list matters.
    is_used: bool,
    /// The vehicle's number for it, if it sends one.
    number: Option<u32>,
    /// The number of the download that was reported.
    told: u32,
    /// Interval of requests for the number of items, and the least one of requests for an item, seconds.
    count_every_s: f64,
    item_every_s: f64,
    counted_s: f64,
    item_due_s: f64,
    item: u16,
}

impl Watched {
    /// Nothing is read yet. The number of items and an item are requested at these intervals, seconds.
    pub(super) const fn new(
        kind: MavMissionType,
        names: Option<[&'static str; 3]>,
        is_used: bool,
        [count_every_s, item_every_s]: [f64; 2],
    ) -> Self {
        Self {
            download: Download::new(kind),
            names,
            is_used,
            number: None,
            told: 0,
            count_every_s,
            item_every_s,
            counted_s: f64::NEG_INFINITY,
            item_due_s: f64::NEG_INFINITY,
            item: 0,
        }
    }

    /// The last complete list.
    pub(super) fn items(&self) -> Option<&[ListItem]> {
        self.download.items()
    }

    pub(super) fn is_busy(&self) -> bool {
        self.download.is_busy()
    }

    /// The list does not matter: the vehicle has none.
    pub(super) const fn leave(&mut self) {
        self.is_used = false;
    }

    /// Reads the list again, unless that is in progress.
    pub(super) fn read_again(&mut self) {
        if self.is_used && !self.is_busy() {
            self.download.begin();
        }
    }

    /// Takes the vehicle's number for the list: another one is another list. A vehicle without such a number sends 0.
    pub(super) fn take_number(&mut self, number: u32) {
        if number != 0
            && self
                .number
                .replace(number)
                .is_some_and(|known| known != number)
        {
            self.read_again();
        }
    }

    /// The vehicle refuses an item: the list has changed while it was read.
    pub(super) fn refused(&mut self) {
        if self.is_used {
            self.download.refused();
        }
    }

    /// A hint of another list: requests the number of items at once.
    pub(super) const fn hint(&mut self) {
        self.counted_s = f64::NEG_INFINITY;
    }

    /// Takes a number of items; `true` if the list has been read.
    pub(super) fn take_count(&mut self, data: &MISSION_COUNT_DATA, voice: &mut Voice) -> bool {
        if self.download.contradicts_count(data) {
            self.read_again();
            return false;
        }
        let is_read = self.download.take_count(data);
        self.close(is_read, voice)
    }

    /// Takes an item; `true` if the list has been read.
    pub(super) fn take_item(&mut self, data: &MISSION_ITEM_INT_DATA, voice: &mut Voice) -> bool {
        if self.download.contradicts_item(data) {
            self.read_again();
        }
        let is_read = self.download.take_item(data);
        self.close(is_read, voice)
    }

    /// Goes on reading; `true` if the list has been read.
    pub(super) fn tick(&mut self, voice: &mut Voice) -> bool {
        let (system, now_s) = (voice.system(), voice.now_s());
        let is_read = self.is_used && self.download.tick(now_s, system, voice.outbox());
        self.close(is_read, voice)
    }

    /// Ends a download that is complete, and reports a list that differs from the one before.
    fn close(&mut self, is_read: bool, voice: &mut Voice) -> bool {
        if !is_read {
            return false;
        }
        voice.send(self.download.closing(voice.system()));
        let before = core::mem::replace(&mut self.told, self.download.changes());
        if let Some([kind, items, words]) = self.names
            && before != self.told
        {
            let count = self.items().map_or(0, <[_]>::len);
            voice.note(kind, json!({ items: count }));
            if before > 0 {
                voice.tell(Severity::Notice, words);
            }
        }
        true
    }

    /// Requests the number of items, and `with_items` the items in turn: a moved item does not change their number.
    pub(super) fn look(&mut self, with_items: bool, voice: &mut Voice) {
        let (system, now_s) = (voice.system(), voice.now_s());
        let known = self
            .download
            .items()
            .filter(|_| self.is_used && !self.is_busy());
        let Some(count) = known.map(|items| u16::try_from(items.len()).unwrap_or(0)) else {
            return;
        };
        if now_s - self.counted_s >= self.count_every_s {
            self.counted_s = now_s;
            voice.send(self.download.count_request(system));
        }
        if with_items && count > 0 && now_s >= self.item_due_s {
            self.item_due_s = now_s + (SEEN_S / f64::from(count)).max(self.item_every_s);
            self.item = self.item.wrapping_add(1) % count;
            voice.send(self.download.item_request(self.item, system));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_four_is_seen_again_within_1_2_s_and_counted_every_2_s() {
        let (mut voice, kind) = (Voice::default(), MavMissionType::MAV_MISSION_TYPE_FENCE);
        let words = "fga: another fence";
        let names = Some(["fence", "items", words]);
        let mut list = Watched::new(kind, names, true, [2.0, 0.1]);
        list.look(true, voice.at(0.0));
        assert!(voice.take_messages().is_empty(), "nothing known yet");
        list.read_again();
        let count = MISSION_COUNT_DATA {
            count: 4,
            mission_type: kind,
            ..MISSION_COUNT_DATA::DEFAULT
        };
        assert!(!list.take_count(&count, &mut voice));
        let mut item = MISSION_ITEM_INT_DATA {
            mission_type: kind,
            ..MISSION_ITEM_INT_DATA::DEFAULT
        };
        for seq in 0..4 {
            item.seq = seq;
            assert_eq!(list.take_item(&item, &mut voice), seq == 3);
        }
        assert_eq!(voice.take_messages().len(), 1, "it is closed");
        assert_eq!(voice.texts(), 0, "the first one is no change");
        let log = voice.take_log();
        assert!(log.len() == 1 && log[0]["kind"] == "fence" && log[0]["items"] == 4);
        let mut sent = |from: u8, until: u8, with_items| {
            for tenth in from..until {
                let now_s = f64::from(tenth) * 0.1 + 1e-9 * f64::from(tenth);
                list.look(with_items, voice.at(now_s));
            }
            voice.take_messages().len()
        };
        // A count, and each item once.
        assert_eq!(sent(0, 12, true), 5);
        // The second count, and no items.
        assert_eq!(sent(12, 21, false), 1);
        // Another number: it is read again.
        let count = MISSION_COUNT_DATA { count: 5, ..count };
        assert!(!list.take_count(&count, &mut voice) && list.is_busy());
    }
}

//! Requests that show a change of a list: no message reports every one.

use super::voice::Voice;
use crate::mission::Download;

/// Time for requesting the items one after the other, all of them, seconds.
const SEEN_S: f64 = 1.2;

/// When a known list is looked at again.
#[derive(Debug)]
pub(super) struct Probes {
    /// Interval of requests for the number of items, and the least one of requests for an item, seconds.
    count_every_s: f64,
    item_every_s: f64,
    counted_s: f64,
    item_due_s: f64,
    item: u16,
}

impl Probes {
    /// Requests the number of items and an item at these intervals, seconds.
    pub(super) const fn new(count_every_s: f64, item_every_s: f64) -> Self {
        Self {
            count_every_s,
            item_every_s,
            counted_s: f64::NEG_INFINITY,
            item_due_s: f64::NEG_INFINITY,
            item: 0,
        }
    }

    /// A hint of another list: requests the number of items at once.
    pub(super) const fn hint(&mut self) {
        self.counted_s = f64::NEG_INFINITY;
    }

    /// Requests the number of items, and `with_items` the items in turn: a moved item does not change their number.
    pub(super) fn tick(&mut self, list: &Download, with_items: bool, voice: &mut Voice) {
        let (system, now_s) = (voice.system(), voice.now_s());
        let Some(items) = list.items().filter(|_| !list.is_busy()) else {
            return;
        };
        if now_s - self.counted_s >= self.count_every_s {
            self.counted_s = now_s;
            voice.send(list.count_request(system));
        }
        let count = u16::try_from(items.len()).unwrap_or(0);
        if with_items && count > 0 && now_s >= self.item_due_s {
            self.item_due_s = now_s + (SEEN_S / f64::from(count)).max(self.item_every_s);
            self.item = self.item.wrapping_add(1) % count;
            voice.send(list.item_request(self.item, system));
        }
    }
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega::{
        MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavMissionType,
    };

    use super::*;

    #[test]
    fn a_list_of_four_is_seen_again_within_1_2_s_and_counted_every_2_s() {
        let kind = MavMissionType::MAV_MISSION_TYPE_FENCE;
        let (mut list, mut voice) = (Download::new(kind), Voice::default());
        let mut probes = Probes::new(2.0, 0.1);
        probes.tick(&list, true, voice.at(0.0));
        assert!(voice.take_messages().is_empty(), "nothing known yet");
        list.begin();
        list.take_count(&MISSION_COUNT_DATA {
            count: 4,
            mission_type: kind,
            ..MISSION_COUNT_DATA::DEFAULT
        });
        for seq in 0..4 {
            list.take_item(&MISSION_ITEM_INT_DATA {
                seq,
                mission_type: kind,
                ..MISSION_ITEM_INT_DATA::DEFAULT
            });
        }
        let mut sent = |from: u8, until: u8, with_items| {
            for tenth in from..until {
                let now_s = f64::from(tenth) * 0.1 + 1e-9 * f64::from(tenth);
                probes.tick(&list, with_items, voice.at(now_s));
            }
            voice.take_messages().len()
        };
        // A count, and each item once.
        assert_eq!(sent(0, 12, true), 5);
        // The second count, and no items.
        assert_eq!(sent(12, 21, false), 1);
    }
}

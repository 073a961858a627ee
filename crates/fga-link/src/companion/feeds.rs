//! What the receivers of traffic deliver, and the operator's texts about them.

use fga_formats::tally::LeftOut;
use serde_json::{Value, json};

use super::lacking::Lacking;
use super::voice::Voice;
use crate::traffic::receiver::FeedStatus;

/// A feed without any position is not understood when it has this many unusable parts, and one of this many is
/// unusable: single ones may be cut by the connection.
const FEWEST_LOST: u64 = 3;
const ONE_LOST_OF: u64 = 10;

/// The receivers of traffic.
#[derive(Debug, Default)]
pub(super) struct Feeds(Vec<Feed>);

#[derive(Debug)]
struct Feed {
    status: FeedStatus,
    /// The reasons that the operator has read.
    told: Vec<LeftOut>,
}

impl Feeds {
    /// The missing condition of feeds: a usable position, or the word that nothing is received.
    pub(super) fn lacking(&self) -> Option<Lacking> {
        let lacks = |is: fn(&FeedStatus) -> bool| self.0.iter().any(|feed| is(&feed.status));
        if lacks(is_not_understood) {
            Some(Lacking::FeedUnreadable)
        } else if lacks(|feed| !feed.was_connected) {
            Some(Lacking::FeedSilent)
        } else {
            None
        }
    }
}

/// Whether a feed sends data, but no position of an aircraft.
fn is_not_understood(feed: &FeedStatus) -> bool {
    let lost = feed.tally.lost();
    let needed = feed.tally.used + lost;
    // A line that never ends is one part only.
    let endless = feed.tally.left_out(LeftOut::TooLong) == feed.tally.read() && lost > 0;
    feed.positions == 0 && (endless || lost >= FEWEST_LOST && lost * ONE_LOST_OF >= needed)
}

impl Feeds {
    /// Takes what a receiver has given so far.
    pub(super) fn take(&mut self, status: FeedStatus, voice: &mut Voice) {
        voice.note(
            "feed",
            json!({
                "source": status.sender.source.name(),
                "connected": status.was_connected,
                "read": status.tally.read(),
                "used": status.tally.used,
                "positions": status.positions,
                "left_out": Value::Object(status.tally.to_json()),
            }),
        );
        let same = |feed: &&mut Feed| feed.status.sender == status.sender;
        match self.0.iter_mut().find(same) {
            Some(feed) => feed.status = status,
            None => self.0.push(Feed {
                status,
                told: Vec::new(),
            }),
        }
    }

    /// Tells the operator once of each reason for which a feed's parts are left out.
    pub(super) fn tell(&mut self, voice: &mut Voice) {
        for feed in &mut self.0 {
            for (reason, count) in feed.status.tally.reasons() {
                if reason != LeftOut::NotNeeded && !feed.told.contains(&reason) {
                    feed.told.push(reason);
                    voice.warn(&words_of(reason, count));
                }
            }
        }
    }

    /// The end of the status line about feeds; empty while all of them are well.
    pub(super) fn words(&self) -> String {
        let mut words = String::new();
        for Feed { status, .. } in &self.0 {
            if !status.was_connected {
                words.push_str(" | no traffic feed");
            } else if let Some(left_out) = status.tally.words("reports") {
                words.push_str(" | left out ");
                words.push_str(&left_out);
            }
        }
        words
    }
}

fn words_of(reason: LeftOut, count: u64) -> String {
    format!("fga: traffic feed: {count} {}", reason.words())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_fits_into_one_message() {
        for reason in LeftOut::all() {
            assert!(words_of(reason, 123_456).len() <= 50, "{reason:?}");
        }
    }
}

//! What the receivers of traffic deliver, and the operator's texts about them.

use fga_formats::tally::LeftOut;
use serde_json::{Value, json};

use super::lacking::Lacking;
use super::voice::Voice;
use crate::traffic::receiver::{FeedStatus, SILENT_S};

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
    /// When it last gave something, seconds.
    heard_s: f64,
    /// Whether the operator has read that it is silent.
    told_silent: bool,
    /// The reasons that the operator has read.
    told: Vec<LeftOut>,
}

impl Feed {
    /// How long it has been silent, seconds; `None` while it gives something, or was never there.
    fn silent_s(&self, now_s: f64) -> Option<f64> {
        let silent_s = now_s - self.heard_s;
        (self.status.was_connected && silent_s > SILENT_S).then_some(silent_s)
    }
}

impl Feeds {
    /// The missing condition of feeds: a usable position, or the word that nothing is received. In flight one that falls silent takes
    /// nothing away: what others report is still avoided.
    pub(super) fn lacking(&self, now_s: f64, is_armed: bool) -> Option<Lacking> {
        let is_missing = |feed: &Feed| {
            !feed.status.was_connected || (!is_armed && feed.silent_s(now_s).is_some())
        };
        if self.0.iter().any(|feed| is_not_understood(&feed.status)) {
            Some(Lacking::FeedUnreadable)
        } else if self.0.iter().any(is_missing) {
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
        let heard_s = voice.now_s();
        match self.0.iter_mut().find(same) {
            // Each change is one of its bytes or its connection.
            Some(feed) if feed.status != status => {
                (feed.status, feed.heard_s, feed.told_silent) = (status, heard_s, false);
            }
            Some(_) => {}
            None => self.0.push(Feed {
                status,
                heard_s,
                told_silent: false,
                told: Vec::new(),
            }),
        }
    }

    /// Tells the operator once of each reason for which a feed's parts are left out, and of each silence.
    pub(super) fn tell(&mut self, voice: &mut Voice) {
        for feed in &mut self.0 {
            if let Some(silent_s) = feed.silent_s(voice.now_s())
                && !core::mem::replace(&mut feed.told_silent, true)
            {
                voice.warn(&format!("fga: {}", silent_words(silent_s)));
            }
            for (reason, count) in feed.status.tally.reasons() {
                if reason != LeftOut::NotNeeded && !feed.told.contains(&reason) {
                    feed.told.push(reason);
                    voice.warn(&words_of(reason, count));
                }
            }
        }
    }

    /// The end of the status line about feeds; empty while all of them are well.
    pub(super) fn words(&self, now_s: f64) -> String {
        let mut words = String::new();
        for feed in &self.0 {
            let status = &feed.status;
            if !status.was_connected {
                words.push_str(" | no traffic feed");
            } else if let Some(silent_s) = feed.silent_s(now_s) {
                words.push_str(" | ");
                words.push_str(&silent_words(silent_s));
            } else if let Some(left_out) = status.tally.words("reports") {
                words.push_str(" | left out ");
                words.push_str(&left_out);
            }
        }
        words
    }
}

fn silent_words(silent_s: f64) -> String {
    format!("no traffic feed for {silent_s:.0} s")
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
        assert!("fga: ".len() + silent_words(123_456.0).len() <= 50);
    }
}

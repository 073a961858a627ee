//! Passes the messages of a running flight to every listening browser.
//!
//! There is one history, and each browser has its place in it: a browser costs no memory, however slow it is.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use core::time::Duration;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use fga_report::replay::LiveMessage;
use tokio::sync::watch;

/// Messages kept for late browsers, and their bytes; beyond that every second sample is dropped.
const REMEMBERED: usize = 40_000;
const REMEMBERED_BYTES: usize = 8 * 1024 * 1024;
/// Messages that a browser gets at once.
const AT_ONCE: usize = 16;
/// A browser that takes no message for this long is gone.
const GONE_AFTER: Duration = Duration::from_secs(15);

/// The sending end of a live run. Clones send to the same browsers.
#[derive(Debug, Clone)]
pub struct Live {
    shared: Arc<Mutex<SharedPage>>,
    /// Wakes the browsers.
    news: watch::Sender<()>,
}

#[derive(Debug, Default)]
struct SharedPage {
    history: Vec<KeptMessages>,
    bytes: usize,
    /// Number of the next message.
    next: u64,
    /// The next message of each listening browser.
    browsers: BTreeMap<u64, u64>,
    next_browser: u64,
}

#[derive(Debug)]
struct KeptMessages {
    number: u64,
    text: Utf8Bytes,
    /// Whether the picture stays the same, if coarser, without it.
    spare: bool,
    /// The run and obstacle that a later message of this kind replaces.
    obstacle: Option<(usize, u32)>,
    /// The run whose ground this is; it is large, and the next one replaces it at once.
    ground: Option<usize>,
}

impl Live {
    pub(crate) fn new() -> Self {
        Self {
            shared: Arc::default(),
            news: watch::Sender::new(()),
        }
    }

    /// Nothing here can panic half-way, so data behind a poisoned lock is complete.
    fn lock(&self) -> MutexGuard<'_, SharedPage> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends a message without waiting for any browser. A browser that is slower than the flight gets a coarser one.
    pub fn send(&self, message: &LiveMessage) {
        let text = Utf8Bytes::from(message.to_json());
        let spare = matches!(
            message,
            LiveMessage::Sample { .. }
                | LiveMessage::Decision { .. }
                | LiveMessage::DecisionTime { .. }
        );
        let obstacle = match message {
            LiveMessage::Obstacle { run, obstacle } => Some((*run, obstacle.id)),
            _ => None,
        };
        let ground = match message {
            LiveMessage::Ground { run, .. } => Some(*run),
            _ => None,
        };
        let mut shared = self.lock();
        if ground.is_some() {
            shared.history.retain(|kept| kept.ground != ground);
            shared.count();
        }
        let number = shared.next;
        shared.next += 1;
        shared.bytes += text.len();
        shared.history.push(KeptMessages {
            number,
            text,
            spare,
            obstacle,
            ground,
        });
        shared.forget();
        drop(shared);
        self.news.send_replace(());
    }

    /// Waits until the browsers that keep up have taken everything, or until the time is over.
    pub fn drain(&self, at_most: Duration) {
        let since = Instant::now();
        let behind = || {
            let shared = self.lock();
            shared.browsers.values().any(|next| *next < shared.next)
        };
        while since.elapsed() < at_most && behind() {
            std::thread::sleep(Duration::from_millis(10));
        }
        if self.listeners() > 0 {
            // The last message from the queue is still on its way.
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    /// Number of listening browsers.
    pub fn listeners(&self) -> usize {
        self.lock().browsers.len()
    }

    /// A browser at the beginning of the history.
    fn join(&self) -> Browser<'_> {
        let mut shared = self.lock();
        let number = shared.next_browser;
        shared.next_browser += 1;
        shared.browsers.insert(number, 0);
        Browser { live: self, number }
    }

    /// Sends the run so far and then each message, until the browser goes; then there is nobody to report an error to.
    pub(crate) async fn serve(self, mut socket: WebSocket) {
        let browser = self.join();
        let _ = browser.follow(&mut socket).await;
    }
}

/// A listening browser; it counts until it is dropped.
struct Browser<'a> {
    live: &'a Live,
    number: u64,
}

impl Browser<'_> {
    /// Its next messages; it has taken those before them.
    fn next(&self) -> Vec<Utf8Bytes> {
        let mut shared = self.live.lock();
        let next = shared.browsers.get(&self.number).copied().unwrap_or(0);
        let from = shared.history.partition_point(|kept| kept.number < next);
        let some = shared.history.iter().skip(from).take(AT_ONCE);
        let (numbers, texts): (Vec<u64>, Vec<Utf8Bytes>) =
            some.map(|kept| (kept.number, kept.text.clone())).unzip();
        if let Some(last) = numbers.last() {
            shared.browsers.insert(self.number, last + 1);
        }
        texts
    }

    /// `None` when the browser went.
    async fn follow(&self, socket: &mut WebSocket) -> Option<()> {
        let mut news = self.live.news.subscribe();
        loop {
            news.mark_unchanged();
            let texts = self.next();
            let idle = texts.is_empty();
            for text in texts {
                send(socket, Message::Text(text)).await?;
            }
            if !idle {
                continue;
            }
            tokio::select! {
                word = news.changed() => word.ok()?,
                // The server ignores what a browser sends, but not its end.
                word = socket.recv() => match word {
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
                    Some(Ok(_)) => {}
                },
                () = tokio::time::sleep(GONE_AFTER) => {
                    send(socket, Message::Ping(Bytes::new())).await?;
                }
            }
        }
    }
}

impl Drop for Browser<'_> {
    fn drop(&mut self) {
        self.live.lock().browsers.remove(&self.number);
    }
}

async fn send(socket: &mut WebSocket, message: Message) -> Option<()> {
    tokio::time::timeout(GONE_AFTER, socket.send(message))
        .await
        .ok()?
        .ok()
}

impl SharedPage {
    fn is_full(&self) -> bool {
        self.history.len() > REMEMBERED || self.bytes > REMEMBERED_BYTES
    }

    /// Drops every second sample, decision and duration, and replaced obstacles; and where that is not enough, the older
    /// half, but not the ground and the first message, which names the run.
    fn forget(&mut self) {
        if !self.is_full() {
            return;
        }
        thin(&mut self.history);
        self.count();
        if self.history.len() > 3 * REMEMBERED / 4 || self.bytes > 3 * REMEMBERED_BYTES / 4 {
            let half = self.history.len() / 2;
            let mut place = 0;
            self.history.retain(|kept| {
                place += 1;
                place == 1 || place > half || kept.ground.is_some()
            });
            self.count();
        }
    }

    fn count(&mut self) {
        self.bytes = self.history.iter().map(|kept| kept.text.len()).sum();
    }
}

/// Drops every second sample, decision and duration, and replaced obstacles.
fn thin(history: &mut Vec<KeptMessages>) {
    let mut latest = std::collections::HashSet::new();
    let mut last: Vec<bool> = history
        .iter()
        .rev()
        .map(|kept| kept.obstacle.is_none_or(|key| latest.insert(key)))
        .collect();
    last.reverse();
    let mut place = 0;
    // Counts down, so that the newest one stays.
    let mut spare = history.iter().filter(|kept| kept.spare).count();
    history.retain(|kept| {
        let stays = last[place] && !(kept.spare && spare.is_multiple_of(2));
        place += 1;
        spare -= usize::from(kept.spare);
        stays
    });
}

#[cfg(test)]
mod tests {
    use fga_report::replay::{ReplayEvent, ReplayGround, ReplayRun, ReplaySample};

    use super::*;

    #[test]
    fn only_the_newest_ground_is_remembered_and_it_stays() {
        let live = Live::new();
        live.send(&LiveMessage::Run(Box::new(ReplayRun::named("over ground"))));
        for corner_m in [1.0, 2.0] {
            let ground = ReplayGround {
                corner_m: [corner_m, 0.0],
                spacing_m: [30.0, 30.0],
                columns: 2,
                heights_m: vec![100.0; 4],
            };
            live.send(&LiveMessage::Ground { run: 0, ground });
        }
        let grounds = || {
            let shared = live.lock();
            let texts = shared.history.iter().map(|kept| kept.text.to_string());
            let is_ground = |text: &String| text.contains("\"type\":\"ground\"");
            texts.filter(is_ground).collect::<Vec<_>>()
        };
        let first = grounds();
        assert_eq!(first.len(), 1);
        assert!(first[0].contains("\"corner\":[2.0,0.0]"), "{}", first[0]);
        for step in 0..100_000_u32 {
            let event = ReplayEvent {
                t_s: f64::from(step),
                text: "news".into(),
            };
            live.send(&LiveMessage::Event { run: 0, event });
        }
        assert_eq!(grounds(), first, "after older messages were dropped");
        assert!(!live.lock().is_full());
    }

    #[test]
    fn a_long_run_is_remembered_within_bounds() {
        let live = Live::new();
        live.send(&LiveMessage::Run(Box::new(ReplayRun::named("long"))));
        for step in 0..100_000_u32 {
            let t_s = f64::from(step) * 0.1;
            let sample = ReplaySample {
                t_s,
                ..ReplaySample::default()
            };
            live.send(&LiveMessage::Sample { run: 0, sample });
        }
        let shared = live.lock();
        let told = &shared.history;
        assert!(
            !shared.is_full(),
            "{} of {} bytes",
            told.len(),
            shared.bytes
        );
        assert!(told.len() > REMEMBERED / 4);
        assert!(told[0].text.as_str().contains("\"long\""));
        assert!(told[told.len() - 1].text.as_str().contains("9999.9"));
    }
}

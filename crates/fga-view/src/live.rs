//! Passes the messages of a running flight to every listening browser.

use alloc::sync::Arc;
use core::time::Duration;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use fga_report::replay::LiveMessage;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::broadcast::{self, Receiver};

/// Messages that wait for a slow browser; a browser further behind gets the whole run again.
const WAITING: usize = 1024;
/// Messages kept for late browsers; beyond that every second sample is dropped.
const REMEMBERED: usize = 40_000;
/// A browser that takes no message for this long is gone.
const GONE_AFTER: Duration = Duration::from_secs(15);
/// Time for a browser to catch up before it gets the whole run again.
const PAUSE: Duration = Duration::from_millis(500);

/// The sending end of a live run. Clones send to the same browsers.
#[derive(Debug, Clone)]
pub struct Live {
    shared: Arc<Mutex<Shared>>,
}

#[derive(Debug)]
struct Shared {
    history: Vec<Kept>,
    sender: broadcast::Sender<Utf8Bytes>,
}

#[derive(Debug)]
struct Kept {
    text: Utf8Bytes,
    /// Whether the picture stays the same, if coarser, without it.
    spare: bool,
    /// The run and obstacle that a later message of this kind replaces.
    obstacle: Option<(usize, u32)>,
}

impl Live {
    pub(crate) fn new() -> Self {
        let (sender, _) = broadcast::channel(WAITING);
        let history = Vec::new();
        Self {
            shared: Arc::new(Mutex::new(Shared { history, sender })),
        }
    }

    /// Nothing here can panic half-way, so data behind a poisoned lock is complete.
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends a message without waiting for any browser. A slow browser misses messages and gets the
    /// whole run again when it has caught up.
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
        let mut shared = self.lock();
        shared.history.push(Kept {
            text: text.clone(),
            spare,
            obstacle,
        });
        if shared.history.len() > REMEMBERED {
            forget(&mut shared.history);
        }
        // Without a browser nobody receives it, which is no error.
        let _ = shared.sender.send(text);
    }

    /// Waits until the browsers that keep up have taken everything, or until the time is over.
    pub fn drain(&self, at_most: Duration) {
        let since = Instant::now();
        while since.elapsed() < at_most && !self.lock().sender.is_empty() {
            std::thread::sleep(Duration::from_millis(10));
        }
        if self.listeners() > 0 {
            // The last message from the queue is still on its way.
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    /// Number of listening browsers.
    pub fn listeners(&self) -> usize {
        self.lock().sender.receiver_count()
    }

    /// The messages sent so far, and a receiver of the following ones.
    fn join(&self) -> (Vec<Utf8Bytes>, Receiver<Utf8Bytes>) {
        let shared = self.lock();
        let told = shared
            .history
            .iter()
            .map(|kept| kept.text.clone())
            .collect();
        (told, shared.sender.subscribe())
    }

    pub(crate) async fn serve(self, mut socket: WebSocket) {
        // Until the browser goes; then there is nobody to report an error to.
        while self.tell(&mut socket).await.is_some() {
            tokio::time::sleep(PAUSE).await;
            if send(&mut socket, Utf8Bytes::from_static(RESET))
                .await
                .is_none()
            {
                return;
            }
        }
    }

    /// Sends the whole run and then each message; `Some` when the browser fell behind, `None` when it went.
    async fn tell(&self, socket: &mut WebSocket) -> Option<()> {
        let (told, mut news) = self.join();
        for text in told {
            send(socket, text).await?;
        }
        loop {
            tokio::select! {
                text = news.recv() => match text {
                    Ok(text) => send(socket, text).await?,
                    Err(RecvError::Lagged(_)) => return Some(()),
                    Err(RecvError::Closed) => return None,
                },
                // The server ignores what a browser sends, but not its end.
                word = socket.recv() => match word {
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
                    Some(Ok(_)) => {}
                },
                () = tokio::time::sleep(GONE_AFTER) => {
                    send_message(socket, Message::Ping(Bytes::new())).await?;
                }
            }
        }
    }
}

/// Tells the page to clear itself before the whole run is sent again.
const RESET: &str = "{\"type\":\"reset\"}";

async fn send(socket: &mut WebSocket, text: Utf8Bytes) -> Option<()> {
    send_message(socket, Message::Text(text)).await
}

async fn send_message(socket: &mut WebSocket, message: Message) -> Option<()> {
    tokio::time::timeout(GONE_AFTER, socket.send(message))
        .await
        .ok()?
        .ok()
}

/// Drops every second sample, decision and duration, and replaced obstacles.
fn forget(history: &mut Vec<Kept>) {
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
    use fga_report::replay::{ReplayRun, ReplaySample};

    use super::*;

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
        let (told, _) = live.join();
        assert!(told.len() <= REMEMBERED, "{}", told.len());
        assert!(told[0].as_str().contains("\"long\""));
        assert!(told[told.len() - 1].as_str().contains("9999.9"));
    }
}

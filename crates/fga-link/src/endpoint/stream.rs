//! A stream of bytes that is opened again when it is lost, shared by its two halves.

use alloc::sync::Arc;
use core::fmt::Debug;
use core::time::Duration;
use std::io::{self, Read};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Time-out of a read.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(100);
/// Pause between attempts to connect.
const RECONNECT_PAUSE: Duration = Duration::from_millis(500);

/// The result of a read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkRead {
    /// This number of bytes of a stream, or one datagram.
    Bytes(usize),
    /// Nothing came in time.
    Nothing,
    /// The connection is new: a begun frame is lost.
    NewConnection,
}

/// The reading half of a socket or a port.
pub(super) trait ReadingHalf: Debug + Send {
    /// Reads once; what `is_silent` may be connected again.
    fn read(&mut self, buffer: &mut [u8], is_silent: bool) -> LinkRead;

    /// Sets the time-out of a read; `false` if there is nothing more to read from.
    fn wait_for(&self, time: Duration) -> bool;

    /// Reads what is discarded; `false` if nothing came.
    fn discard(&mut self, buffer: &mut [u8]) -> bool;

    /// From now on it answers only senders named by [`Self::answer_sender`].
    fn be_wary(&mut self) {}

    /// From now on it answers the sender of the last datagram.
    fn answer_sender(&self) {}

    /// Whether each read is a separate datagram.
    fn is_datagrams(&self) -> bool {
        false
    }
}

/// The writing half of a socket or a port.
pub(super) trait WritingHalf: Debug + Send + Sync {
    /// Sends; `false` without a peer or after a failure.
    fn write(&self, bytes: &[u8]) -> bool;
}

/// What both halves have of a stream.
pub(super) type Halves<T> = Arc<Mutex<Option<T>>>;

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(super) fn nothing_came(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

/// The reading half.
#[derive(Debug)]
pub(super) struct ByteStream<T> {
    own: Option<T>,
    shared: Halves<T>,
}

impl<T: Read> ByteStream<T> {
    /// A stream that is not open yet, and what its writing half needs.
    pub(super) fn closed() -> (Self, Halves<T>) {
        let shared = Halves::default();
        let stream = Self {
            own: None,
            shared: Arc::clone(&shared),
        };
        (stream, shared)
    }

    /// Takes an open one with its copy for the writing half.
    pub(super) fn take(&mut self, (own, copy): (T, T)) {
        *locked(&self.shared) = Some(copy);
        self.own = Some(own);
    }

    pub(super) const fn own(&self) -> Option<&T> {
        self.own.as_ref()
    }

    /// Reads; drops a stream that is lost or given up, so that the next call opens a new one.
    pub(super) fn read(
        &mut self,
        buffer: &mut [u8],
        is_given_up: bool,
        open: impl FnOnce() -> io::Result<(T, T)>,
    ) -> LinkRead {
        if let Some(own) = &mut self.own {
            match own.read(buffer) {
                Ok(count) if count > 0 => return LinkRead::Bytes(count),
                Err(error) if nothing_came(&error) && !is_given_up => return LinkRead::Nothing,
                _ => {
                    self.own = None;
                    *locked(&self.shared) = None;
                }
            }
        }
        if let Ok(opened) = open() {
            self.take(opened);
            return LinkRead::NewConnection;
        }
        std::thread::sleep(RECONNECT_PAUSE);
        LinkRead::Nothing
    }

    /// Reads what is discarded; `false` if nothing came.
    pub(super) fn discard(&mut self, buffer: &mut [u8]) -> bool {
        let own = self.own.as_mut();
        own.is_some_and(|own| own.read(buffer).is_ok_and(|count| count > 0))
    }
}

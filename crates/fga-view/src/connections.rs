//! Accepts connections within limits: on their number, their time, their buffers.
//!
//! Whoever connects shares a process with a flight. So no number of connections costs more memory or descriptors than
//! [`MOST_CONNECTIONS`] do, and none is kept for a client that does not ask, read or answer.

use alloc::sync::Arc;
use core::net::SocketAddr;
use core::time::Duration;
use std::io;
use std::sync::OnceLock;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Most connections at once; further ones are closed at once.
pub(crate) const MOST_CONNECTIONS: usize = 32;
/// Most pages of a catalogue in memory at once: each may have megabytes.
const MOST_PAGES: usize = 4;
/// A client sends its request within this time.
const ASKED_WITHIN: Duration = Duration::from_secs(5);
/// A client takes its answer within this time.
const ANSWERED_WITHIN: Duration = Duration::from_mins(1);
/// Pause after a refused connection, and after one that the system could not accept: a flood takes little of a processor.
const PAUSE: Duration = Duration::from_millis(1);
/// Buffer for a request, bytes: the least that hyper takes.
const REQUEST_BYTES: usize = 8192;
/// The system's buffer for what a client does not take, bytes.
const SEND_BYTES: u32 = 64 * 1024;
/// Connections that wait to be accepted.
const WAITING: u32 = 128;

/// A connection's share of the limits, given back when the connection and everything behind it has ended.
#[derive(Debug)]
pub(crate) struct Share {
    _connection: OwnedSemaphorePermit,
    pages: Arc<Semaphore>,
    page: OnceLock<OwnedSemaphorePermit>,
}

impl Share {
    /// Waits until there is room for a page in memory.
    pub(crate) async fn page(&self) {
        if self.page.get().is_none()
            && let Ok(page) = Arc::clone(&self.pages).acquire_owned().await
        {
            // Another request of this connection may have room already.
            let _ = self.page.set(page);
        }
    }
}

/// Listens on an address; needs a runtime.
pub(crate) fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = match address {
        SocketAddr::V4(_) => TcpSocket::new_v4()?,
        SocketAddr::V6(_) => TcpSocket::new_v6()?,
    };
    // As the standard library does: a port is free again when its server has ended.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    // Accepted connections inherit it.
    socket.set_send_buffer_size(SEND_BYTES)?;
    socket.bind(address)?;
    socket.listen(WAITING)
}

/// Serves for ever.
pub(crate) async fn serve(listener: TcpListener, router: Router) {
    let room = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    let pages = Arc::new(Semaphore::new(MOST_PAGES));
    loop {
        let accepted = listener.accept().await;
        let (Ok((stream, _)), Ok(permit)) = (accepted, Arc::clone(&room).try_acquire_owned())
        else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let share = Arc::new(Share {
            _connection: permit,
            pages: Arc::clone(&pages),
            page: OnceLock::new(),
        });
        tokio::spawn(answer(stream, router.clone().layer(Extension(share))));
    }
}

/// Answers one request; a WebSocket goes on by itself.
async fn answer(stream: TcpStream, router: Router) {
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(ASKED_WITHIN)
        .max_buf_size(REQUEST_BYTES)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    // A client that goes or is too slow gets nothing.
    let _ = tokio::time::timeout(ANSWERED_WITHIN, connection).await;
}

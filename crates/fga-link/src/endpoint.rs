//! Endpoints of the vehicle: UDP, TCP or a serial port, and their sockets.
//!
//! | endpoint | meaning |
//! |---|---|
//! | `udpin:HOST:PORT` | waits on this port and answers recent senders (as `--out` of a ground station) |
//! | `udpout:HOST:PORT` | sends there and takes the answers |
//! | `tcp:HOST:PORT` | connects, and again after a failure |
//! | `tcpin:HOST:PORT` | waits for a connection |
//! | `serial:PATH[:BAUD]` | a serial port, 115,200 baud unless given |

mod address;
#[cfg(feature = "serial")]
mod serial;
mod stream;
mod tcp;
mod udp;

use alloc::sync::Arc;
use core::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use core::time::Duration;
use std::io;
use std::net::ToSocketAddrs as _;
use std::time::Instant;

pub use address::{Endpoint, EndpointError};
pub use stream::LinkRead;

use stream::{READ_TIMEOUT, ReadingHalf, WritingHalf};

/// Time-out of a read that empties a queue: waiting data comes at once.
const DRAIN_TIMEOUT: Duration = Duration::from_millis(1);
/// Most reads that empty a queue.
const MOST_DRAINED: u32 = 20_000;
/// A connection that is silent for this long is made again: the system of a frozen program still answers
/// for it. A vehicle sends something every second.
const SILENT: Duration = Duration::from_secs(5);

fn resolve(address: &str) -> io::Result<SocketAddr> {
    address
        .to_socket_addrs()?
        .next()
        .ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, format!("no address for {address}")))
}

/// The reading half of an open endpoint; it reconnects by itself.
#[derive(Debug)]
pub struct LinkReader {
    socket: Box<dyn ReadingHalf>,
    /// A connection silent for this long is made again.
    silent: Duration,
    heard: Instant,
}

/// The writing half of an open endpoint; it drops what it cannot send.
#[derive(Debug, Clone)]
pub struct LinkWriter(Arc<dyn WritingHalf>);

/// The halves of a socket or a port.
fn halves(
    (reading, writing): (impl ReadingHalf + 'static, impl WritingHalf + 'static),
) -> (Box<dyn ReadingHalf>, Arc<dyn WritingHalf>) {
    (Box::new(reading), Arc::new(writing))
}

/// An error to listen on a port, with what to do where another program has it.
fn taken(error: io::Error) -> io::Error {
    if error.kind() == io::ErrorKind::AddrInUse {
        let message = "another program uses this port, expected a free one: end that program, or name another port";
        return io::Error::new(error.kind(), message);
    }
    error
}

/// Opens an endpoint.
///
/// # Errors
/// An address that does not resolve, a port that is taken, a serial port that cannot be opened.
/// A TCP server that does not answer is no error: the reader tries again.
pub fn open(endpoint: &Endpoint) -> io::Result<(LinkReader, LinkWriter)> {
    let (socket, writer) = match endpoint {
        Endpoint::UdpIn(address) => halves(udp::open(resolve(address)?, None).map_err(taken)?),
        Endpoint::UdpOut(address) => {
            let remote = resolve(address)?;
            let local = if remote.is_ipv4() {
                Ipv4Addr::UNSPECIFIED.into()
            } else {
                Ipv6Addr::UNSPECIFIED.into()
            };
            halves(udp::open(SocketAddr::new(local, 0), Some(remote))?)
        }
        Endpoint::Tcp(address) => halves(tcp::connect(resolve(address)?)),
        Endpoint::TcpIn(address) => halves(tcp::listen(resolve(address)?).map_err(taken)?),
        #[cfg(feature = "serial")]
        Endpoint::Serial { path, baud } => halves(serial::open(path, *baud)?),
        #[cfg(not(feature = "serial"))]
        Endpoint::Serial { .. } => {
            return Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "this program was built without serial ports",
            ));
        }
    };
    let reader = LinkReader {
        socket,
        silent: SILENT,
        heard: Instant::now(),
    };
    Ok((reader, LinkWriter(writer)))
}

impl LinkReader {
    /// From now on a waiting UDP port answers only senders named by [`Self::answer_sender`].
    pub fn be_wary(&mut self) {
        self.socket.be_wary();
    }

    /// From now on it answers the sender of the last datagram.
    pub fn answer_sender(&mut self) {
        self.socket.answer_sender();
    }

    /// Connects again only after this long a silence.
    pub fn set_silent(&mut self, silent: Duration) {
        self.silent = silent;
    }

    /// Reads once; waits a tenth of a second at most, longer only while it reconnects.
    pub fn read(&mut self, buffer: &mut [u8]) -> LinkRead {
        let is_silent = self.heard.elapsed() > self.silent;
        let received = self.socket.read(buffer, is_silent);
        if received != LinkRead::Nothing {
            self.heard = Instant::now();
        }
        received
    }

    /// Reads and discards all waiting data.
    pub fn drain(&mut self, buffer: &mut [u8]) {
        if !self.socket.wait_for(DRAIN_TIMEOUT) {
            return;
        }
        let mut reads = 0..MOST_DRAINED;
        while reads.next().is_some() && self.socket.discard(buffer) {}
        self.socket.wait_for(READ_TIMEOUT);
        self.heard = Instant::now();
    }

    /// Whether each read is a separate datagram.
    pub fn is_datagrams(&self) -> bool {
        self.socket.is_datagrams()
    }
}

impl LinkWriter {
    /// Sends a frame; `false` without a peer or after a failure.
    pub fn write(&self, bytes: &[u8]) -> bool {
        self.0.write(bytes)
    }
}

#[cfg(test)]
mod tests;

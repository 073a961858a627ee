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

use core::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use core::time::Duration;
use std::io;
use std::net::ToSocketAddrs as _;
use std::time::Instant;

pub use address::{Endpoint, EndpointError};
pub use stream::Received;

use stream::READ_TIMEOUT;

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
pub struct Reader {
    kind: ReaderKind,
    /// A connection silent for this long is made again.
    silent: Duration,
    heard: Instant,
}

#[derive(Debug)]
enum ReaderKind {
    Udp(udp::UdpReader),
    Tcp(tcp::TcpReader),
    #[cfg(feature = "serial")]
    Serial(serial::SerialReader),
}

/// The writing half of an open endpoint; it drops what it cannot send.
#[derive(Debug, Clone)]
pub struct Writer(WriterKind);

#[derive(Debug, Clone)]
enum WriterKind {
    Udp(udp::UdpWriter),
    Tcp(tcp::TcpWriter),
    #[cfg(feature = "serial")]
    Serial(serial::SerialWriter),
}

/// Opens an endpoint.
///
/// # Errors
/// An address that does not resolve, a port that is taken, a serial port that cannot be opened.
/// A TCP server that does not answer is no error: the reader tries again.
pub fn open(endpoint: &Endpoint) -> io::Result<(Reader, Writer)> {
    let over_udp = |(reader, writer)| (ReaderKind::Udp(reader), WriterKind::Udp(writer));
    let over_tcp = |(reader, writer)| (ReaderKind::Tcp(reader), WriterKind::Tcp(writer));
    let (kind, writer) = match endpoint {
        Endpoint::UdpIn(address) => over_udp(udp::open(resolve(address)?, None)?),
        Endpoint::UdpOut(address) => {
            let remote = resolve(address)?;
            let local = if remote.is_ipv4() {
                Ipv4Addr::UNSPECIFIED.into()
            } else {
                Ipv6Addr::UNSPECIFIED.into()
            };
            over_udp(udp::open(SocketAddr::new(local, 0), Some(remote))?)
        }
        Endpoint::Tcp(address) => over_tcp(tcp::connect(resolve(address)?)),
        Endpoint::TcpIn(address) => over_tcp(tcp::listen(resolve(address)?)?),
        #[cfg(feature = "serial")]
        Endpoint::Serial { path, baud } => {
            let (reader, writer) = serial::open(path, *baud)?;
            (ReaderKind::Serial(reader), WriterKind::Serial(writer))
        }
        #[cfg(not(feature = "serial"))]
        Endpoint::Serial { .. } => {
            return Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "this program was built without serial ports",
            ));
        }
    };
    let reader = Reader {
        kind,
        silent: SILENT,
        heard: Instant::now(),
    };
    Ok((reader, Writer(writer)))
}

impl Reader {
    /// From now on a waiting UDP port answers only senders named by [`Self::answer_sender`].
    pub fn be_wary(&mut self) {
        if let ReaderKind::Udp(udp) = &mut self.kind {
            udp.wary = true;
        }
    }

    /// From now on it answers the sender of the last datagram.
    pub fn answer_sender(&mut self) {
        if let ReaderKind::Udp(udp) = &self.kind {
            udp.answer_sender();
        }
    }

    /// Connects again only after this long a silence.
    pub fn set_silent(&mut self, silent: Duration) {
        self.silent = silent;
    }

    /// Reads once; waits a tenth of a second at most, longer only while it reconnects.
    pub fn read(&mut self, buffer: &mut [u8]) -> Received {
        let is_silent = self.heard.elapsed() > self.silent;
        let received = match &mut self.kind {
            ReaderKind::Udp(udp) => udp.read(buffer),
            ReaderKind::Tcp(tcp) => tcp.read(buffer, is_silent),
            #[cfg(feature = "serial")]
            ReaderKind::Serial(serial) => serial.read(buffer),
        };
        if received != Received::Nothing {
            self.heard = Instant::now();
        }
        received
    }

    /// Sets the time-out of a read; `false` if there is nothing more to read from.
    fn wait_for(&self, time: Duration) -> bool {
        match &self.kind {
            ReaderKind::Udp(udp) => udp.wait_for(time),
            ReaderKind::Tcp(tcp) => tcp.wait_for(time),
            #[cfg(feature = "serial")]
            ReaderKind::Serial(serial) => {
                serial.clear();
                false
            }
        }
    }

    /// Reads and discards all waiting data.
    pub fn drain(&mut self, buffer: &mut [u8]) {
        if !self.wait_for(DRAIN_TIMEOUT) {
            return;
        }
        for _ in 0..MOST_DRAINED {
            let came = match &mut self.kind {
                ReaderKind::Udp(udp) => udp.discard(buffer),
                ReaderKind::Tcp(tcp) => tcp.discard(buffer),
                #[cfg(feature = "serial")]
                ReaderKind::Serial(_) => false,
            };
            if !came {
                break;
            }
        }
        self.wait_for(READ_TIMEOUT);
        self.heard = Instant::now();
    }

    /// Whether each read is a separate datagram.
    pub const fn is_datagrams(&self) -> bool {
        matches!(self.kind, ReaderKind::Udp(_))
    }
}

impl Writer {
    /// Sends a frame; `false` without a peer or after a failure.
    pub fn write(&self, bytes: &[u8]) -> bool {
        match &self.0 {
            WriterKind::Udp(udp) => udp.write(bytes),
            WriterKind::Tcp(tcp) => tcp.write(bytes),
            #[cfg(feature = "serial")]
            WriterKind::Serial(serial) => serial.write(bytes),
        }
    }
}

#[cfg(test)]
mod tests;

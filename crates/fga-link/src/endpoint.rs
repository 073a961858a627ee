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

use alloc::sync::Arc;
use core::net::SocketAddr;
use core::time::Duration;
use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs, UdpSocket};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

pub use address::{Endpoint, EndpointError};

/// Time-out of a read.
const READ_TIMEOUT: Duration = Duration::from_millis(100);
/// Pause between attempts to connect.
const RECONNECT_PAUSE: Duration = Duration::from_millis(500);
/// Time-out of an attempt to connect.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
/// Most senders that a waiting UDP port answers, and the time after their last message.
const MOST_PEERS: usize = 8;
const PEER_LIFETIME: Duration = Duration::from_secs(15);
/// Time-out of a read that empties a queue: waiting data comes at once.
const DRAIN_TIMEOUT: Duration = Duration::from_millis(1);
/// Most reads that empty a queue.
const MOST_DRAINED: u32 = 20_000;
/// The system notices a vanished peer within this …
const GONE: Duration = Duration::from_secs(4);
/// … by probing after silence of this length, at this interval.
const ASK_AFTER: Duration = Duration::from_secs(2);
const ASK_EVERY: Duration = Duration::from_secs(1);
/// A connection that is silent for this long is made again: the system of a frozen program still answers
/// for it. A vehicle sends something every second.
const SILENT: Duration = Duration::from_secs(5);

/// The result of a read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Received {
    /// This number of bytes of a stream, or one datagram.
    Bytes(usize),
    /// Nothing came in time.
    Nothing,
    /// The connection is new: a begun frame is lost.
    NewConnection,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn resolve(address: &str) -> io::Result<SocketAddr> {
    address
        .to_socket_addrs()?
        .next()
        .ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, format!("no address for {address}")))
}

type Peers = Arc<Mutex<Vec<(SocketAddr, Instant)>>>;
type Stream = Arc<Mutex<Option<TcpStream>>>;
#[cfg(feature = "serial")]
type Port = Arc<Mutex<Option<Box<dyn serialport::SerialPort>>>>;

/// The reading half of an open endpoint; it reconnects by itself.
#[derive(Debug)]
pub struct Reader {
    kind: ReaderKind,
    /// A connection silent for this long is made again.
    silent: Duration,
    heard: Instant,
    /// It answers only senders named by [`Self::answer_sender`].
    wary: bool,
    sender: Option<SocketAddr>,
}

#[derive(Debug)]
enum ReaderKind {
    Udp {
        socket: UdpSocket,
        peers: Option<Peers>,
    },
    Tcp {
        address: SocketAddr,
        own: Option<TcpStream>,
        shared: Stream,
    },
    TcpIn {
        listener: TcpListener,
        own: Option<TcpStream>,
        shared: Stream,
    },
    #[cfg(feature = "serial")]
    Serial {
        path: String,
        baud: u32,
        own: Option<Box<dyn serialport::SerialPort>>,
        shared: Port,
    },
}

/// The writing half of an open endpoint; it drops what it cannot send.
#[derive(Debug, Clone)]
pub struct Writer(WriterKind);

#[derive(Debug, Clone)]
enum WriterKind {
    Udp {
        socket: Arc<UdpSocket>,
        peers: Peers,
    },
    Stream(Stream),
    #[cfg(feature = "serial")]
    Serial(Port),
}

/// Opens an endpoint.
///
/// # Errors
/// An address that does not resolve, a port that is taken, a serial port that cannot be opened.
/// A TCP server that does not answer is no error: the reader tries again.
pub fn open(endpoint: &Endpoint) -> io::Result<(Reader, Writer)> {
    match endpoint {
        Endpoint::UdpIn(address) => {
            let socket = UdpSocket::bind(resolve(address)?)?;
            socket.set_read_timeout(Some(READ_TIMEOUT))?;
            let peers = Peers::default();
            let writer = WriterKind::Udp {
                socket: Arc::new(socket.try_clone()?),
                peers: Arc::clone(&peers),
            };
            Ok((
                Reader::of(ReaderKind::Udp {
                    socket,
                    peers: Some(peers),
                }),
                Writer(writer),
            ))
        }
        Endpoint::UdpOut(address) => {
            let remote = resolve(address)?;
            let local = if remote.is_ipv4() {
                "0.0.0.0:0"
            } else {
                "[::]:0"
            };
            let socket = UdpSocket::bind(local)?;
            socket.set_read_timeout(Some(READ_TIMEOUT))?;
            let peers: Peers = Arc::new(Mutex::new(vec![(remote, Instant::now())]));
            let writer = WriterKind::Udp {
                socket: Arc::new(socket.try_clone()?),
                peers,
            };
            Ok((
                Reader::of(ReaderKind::Udp {
                    socket,
                    peers: None,
                }),
                Writer(writer),
            ))
        }
        Endpoint::Tcp(address) => {
            let shared = Stream::default();
            let reader = ReaderKind::Tcp {
                address: resolve(address)?,
                own: None,
                shared: Arc::clone(&shared),
            };
            Ok((Reader::of(reader), Writer(WriterKind::Stream(shared))))
        }
        Endpoint::TcpIn(address) => {
            let listener = TcpListener::bind(resolve(address)?)?;
            listener.set_nonblocking(true)?;
            let shared = Stream::default();
            let reader = ReaderKind::TcpIn {
                listener,
                own: None,
                shared: Arc::clone(&shared),
            };
            Ok((Reader::of(reader), Writer(WriterKind::Stream(shared))))
        }
        #[cfg(feature = "serial")]
        Endpoint::Serial { path, baud } => {
            let port = serialport::new(path, *baud).timeout(READ_TIMEOUT).open()?;
            let shared: Port = Arc::new(Mutex::new(Some(port.try_clone()?)));
            let reader = ReaderKind::Serial {
                path: path.clone(),
                baud: *baud,
                own: Some(port),
                shared: Arc::clone(&shared),
            };
            Ok((Reader::of(reader), Writer(WriterKind::Serial(shared))))
        }
        #[cfg(not(feature = "serial"))]
        Endpoint::Serial { .. } => Err(io::Error::new(
            io::ErrorKind::Unsupported,
            "this program was built without serial ports",
        )),
    }
}

fn nothing_came(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

fn adopt(stream: TcpStream, own: &mut Option<TcpStream>, shared: &Stream) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_TIMEOUT))?;
    stream.set_write_timeout(Some(READ_TIMEOUT))?;
    let socket = socket2::SockRef::from(&stream);
    let keep_alive = socket2::TcpKeepalive::new()
        .with_time(ASK_AFTER)
        .with_interval(ASK_EVERY)
        .with_retries(2);
    socket.set_tcp_keepalive(&keep_alive)?;
    #[cfg(target_os = "linux")]
    socket.set_tcp_user_timeout(Some(GONE))?;
    *locked(shared) = Some(stream.try_clone()?);
    *own = Some(stream);
    Ok(())
}

/// Reads from a connection; drops a lost one, so that the next call makes a new one.
fn read_stream(
    own: &mut Option<TcpStream>,
    shared: &Stream,
    buffer: &mut [u8],
    is_silent: bool,
    connect: impl FnOnce() -> io::Result<TcpStream>,
) -> Received {
    if let Some(stream) = own {
        match stream.read(buffer) {
            Ok(count) if count > 0 => return Received::Bytes(count),
            Err(error) if nothing_came(&error) && !is_silent => return Received::Nothing,
            _ => {
                *own = None;
                *locked(shared) = None;
            }
        }
    }
    if connect()
        .and_then(|stream| adopt(stream, own, shared))
        .is_ok()
    {
        Received::NewConnection
    } else {
        std::thread::sleep(RECONNECT_PAUSE);
        Received::Nothing
    }
}

impl Reader {
    fn of(kind: ReaderKind) -> Self {
        Self {
            kind,
            silent: SILENT,
            heard: Instant::now(),
            wary: false,
            sender: None,
        }
    }

    /// From now on a waiting UDP port answers only senders named by [`Self::answer_sender`].
    pub fn be_wary(&mut self) {
        self.wary = true;
    }

    /// From now on it answers the sender of the last datagram.
    pub fn answer_sender(&mut self) {
        if let (
            ReaderKind::Udp {
                peers: Some(peers), ..
            },
            Some(sender),
        ) = (&self.kind, self.sender)
        {
            remember(&mut locked(peers), sender);
        }
    }

    /// Connects again only after this long a silence.
    pub fn set_silent(&mut self, silent: Duration) {
        self.silent = silent;
    }

    /// Reads once; waits a tenth of a second at most, longer only while it reconnects.
    pub fn read(&mut self, buffer: &mut [u8]) -> Received {
        let received = self.read_once(buffer);
        if received != Received::Nothing {
            self.heard = Instant::now();
        }
        received
    }

    /// Sets the time-out of a read; `false` if there is nothing to read from.
    fn wait_for(&self, time: Duration) -> bool {
        match &self.kind {
            ReaderKind::Udp { socket, .. } => socket.set_read_timeout(Some(time)).is_ok(),
            ReaderKind::Tcp { own, .. } | ReaderKind::TcpIn { own, .. } => own
                .as_ref()
                .is_some_and(|stream| stream.set_read_timeout(Some(time)).is_ok()),
            #[cfg(feature = "serial")]
            ReaderKind::Serial { own, .. } => {
                if let Some(port) = own {
                    // The next read opens a failed port again.
                    let _ = port.clear(serialport::ClearBuffer::Input);
                }
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
                ReaderKind::Udp { socket, .. } => socket.recv_from(buffer).is_ok(),
                ReaderKind::Tcp { own, .. } | ReaderKind::TcpIn { own, .. } => own
                    .as_mut()
                    .is_some_and(|stream| stream.read(buffer).is_ok_and(|count| count > 0)),
                #[cfg(feature = "serial")]
                ReaderKind::Serial { .. } => false,
            };
            if !came {
                break;
            }
        }
        self.wait_for(READ_TIMEOUT);
        self.heard = Instant::now();
    }

    fn read_once(&mut self, buffer: &mut [u8]) -> Received {
        let is_silent = self.heard.elapsed() > self.silent;
        match &mut self.kind {
            ReaderKind::Udp { socket, peers } => match socket.recv_from(buffer) {
                Ok((count, from)) => {
                    self.sender = Some(from);
                    if let Some(peers) = peers
                        && !self.wary
                    {
                        remember(&mut locked(peers), from);
                    }
                    Received::Bytes(count)
                }
                Err(error) => {
                    if !nothing_came(&error) {
                        std::thread::sleep(Duration::from_millis(10));
                    }
                    Received::Nothing
                }
            },
            ReaderKind::Tcp {
                address,
                own,
                shared,
            } => read_stream(own, shared, buffer, is_silent, || {
                TcpStream::connect_timeout(address, CONNECT_TIMEOUT)
            }),
            ReaderKind::TcpIn {
                listener,
                own,
                shared,
            } => read_stream(own, shared, buffer, is_silent, || {
                listener.accept().map(|(stream, _)| stream)
            }),
            #[cfg(feature = "serial")]
            ReaderKind::Serial {
                path,
                baud,
                own,
                shared,
            } => {
                if let Some(port) = own {
                    match port.read(buffer) {
                        Ok(count) if count > 0 => return Received::Bytes(count),
                        Err(error) if nothing_came(&error) => return Received::Nothing,
                        _ => {
                            *own = None;
                            *locked(shared) = None;
                        }
                    }
                }
                let opened = serialport::new(path.as_str(), *baud)
                    .timeout(READ_TIMEOUT)
                    .open();
                if let Ok(port) = opened
                    && let Ok(clone) = port.try_clone()
                {
                    *locked(shared) = Some(clone);
                    *own = Some(port);
                    return Received::NewConnection;
                }
                std::thread::sleep(RECONNECT_PAUSE);
                Received::Nothing
            }
        }
    }

    /// Whether each read is a separate datagram.
    pub const fn is_datagrams(&self) -> bool {
        matches!(self.kind, ReaderKind::Udp { .. })
    }
}

fn remember(peers: &mut Vec<(SocketAddr, Instant)>, from: SocketAddr) {
    let now = Instant::now();
    if let Some(peer) = peers.iter_mut().find(|peer| peer.0 == from) {
        peer.1 = now;
        return;
    }
    peers.retain(|peer| now.duration_since(peer.1) < PEER_LIFETIME);
    if peers.len() >= MOST_PEERS {
        // The one heard longest ago makes room: the vehicle sends all the time.
        let oldest = peers.iter().enumerate().min_by_key(|(_, peer)| peer.1);
        if let Some((index, _)) = oldest {
            peers.swap_remove(index);
        }
    }
    peers.push((from, now));
}

impl Writer {
    /// Sends a frame; `false` without a peer or after a failure.
    pub fn write(&self, bytes: &[u8]) -> bool {
        match &self.0 {
            WriterKind::Udp { socket, peers } => {
                let mut sent = false;
                for (address, _) in locked(peers).iter() {
                    sent |= socket.send_to(bytes, address).is_ok();
                }
                sent
            }
            WriterKind::Stream(shared) => {
                let mut guard = locked(shared);
                let done = guard
                    .as_mut()
                    .is_some_and(|stream| stream.write_all(bytes).is_ok());
                if !done {
                    // Half a frame may be out: only a new connection is clean.
                    if let Some(stream) = guard.take() {
                        drop(stream.shutdown(std::net::Shutdown::Both));
                    }
                }
                done
            }
            #[cfg(feature = "serial")]
            WriterKind::Serial(shared) => locked(shared)
                .as_mut()
                .is_some_and(|port| port.write_all(bytes).is_ok()),
        }
    }
}

#[cfg(test)]
mod tests;

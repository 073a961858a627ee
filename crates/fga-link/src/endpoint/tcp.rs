//! A TCP connection, which is made again when it is lost or silent.

use core::net::SocketAddr;
use core::time::Duration;
use std::io::{self, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};

use super::stream::{ByteStream, Halves, LinkRead, READ_TIMEOUT, ReadingHalf, WritingHalf, locked};

/// Time-out of an attempt to connect.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
/// The system notices a vanished peer within this …
const GONE: Duration = Duration::from_secs(4);
/// … by probing after silence of this length, at this interval.
const ASK_AFTER: Duration = Duration::from_secs(2);
const ASK_EVERY: Duration = Duration::from_secs(1);

/// Where connections come from.
#[derive(Debug)]
enum Peer {
    Address(SocketAddr),
    Listener(TcpListener),
}

#[derive(Debug)]
pub(super) struct TcpReader {
    peer: Peer,
    stream: ByteStream<TcpStream>,
}

#[derive(Debug)]
pub(super) struct TcpWriter(Halves<TcpStream>);

/// Connects to an address when it is read.
pub(super) fn connect(address: SocketAddr) -> (TcpReader, TcpWriter) {
    from(Peer::Address(address))
}

/// Waits for connections on an address.
pub(super) fn listen(address: SocketAddr) -> io::Result<(TcpReader, TcpWriter)> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    Ok(from(Peer::Listener(listener)))
}

fn from(peer: Peer) -> (TcpReader, TcpWriter) {
    let (stream, shared) = ByteStream::closed();
    (TcpReader { peer, stream }, TcpWriter(shared))
}

/// A new connection and its copy.
fn adopt(stream: TcpStream) -> io::Result<(TcpStream, TcpStream)> {
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
    let copy = stream.try_clone()?;
    Ok((stream, copy))
}

impl ReadingHalf for TcpReader {
    fn read(&mut self, buffer: &mut [u8], is_silent: bool) -> LinkRead {
        let peer = &self.peer;
        let connect = || match peer {
            Peer::Address(address) => TcpStream::connect_timeout(address, CONNECT_TIMEOUT),
            Peer::Listener(listener) => listener.accept().map(|(stream, _)| stream),
        };
        let stream = &mut self.stream;
        stream.read(buffer, is_silent, || connect().and_then(adopt))
    }

    fn wait_for(&self, time: Duration) -> bool {
        let own = self.stream.own();
        own.is_some_and(|stream| stream.set_read_timeout(Some(time)).is_ok())
    }

    fn discard(&mut self, buffer: &mut [u8]) -> bool {
        self.stream.discard(buffer)
    }
}

impl WritingHalf for TcpWriter {
    fn write(&self, bytes: &[u8]) -> bool {
        let mut guard = locked(&self.0);
        let done = guard
            .as_mut()
            .is_some_and(|stream| stream.write_all(bytes).is_ok());
        if !done {
            // Half a frame may be out: only a new connection is clean.
            if let Some(stream) = guard.take() {
                drop(stream.shutdown(Shutdown::Both));
            }
        }
        done
    }
}

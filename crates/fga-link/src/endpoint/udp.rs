//! A UDP port.

use alloc::sync::Arc;
use core::net::SocketAddr;
use core::time::Duration;
use std::io;
use std::net::UdpSocket;
use std::sync::Mutex;
use std::time::Instant;

use super::stream::{LinkRead, READ_TIMEOUT, ReadingHalf, WritingHalf, locked, nothing_came};

/// Most senders that a waiting port answers, and the time after their last message.
const MOST_PEERS: usize = 8;
const PEER_LIFETIME: Duration = Duration::from_secs(15);

/// Who is answered, and when each was last heard.
type Peers = Arc<Mutex<Vec<(SocketAddr, Instant)>>>;

#[derive(Debug)]
pub(super) struct UdpReader {
    pub(super) socket: UdpSocket,
    /// Those whom a waiting port answers.
    peers: Option<Peers>,
    /// It answers only senders named by [`Self::answer_sender`].
    wary: bool,
    sender: Option<SocketAddr>,
}

#[derive(Debug)]
pub(super) struct UdpWriter {
    socket: UdpSocket,
    peers: Peers,
}

/// Opens a local port, which sends to a remote address, or waits and answers.
pub(super) fn open(
    local: SocketAddr,
    remote: Option<SocketAddr>,
) -> io::Result<(UdpReader, UdpWriter)> {
    let socket = UdpSocket::bind(local)?;
    socket.set_read_timeout(Some(READ_TIMEOUT))?;
    let first = remote.map(|remote| (remote, Instant::now()));
    let peers: Peers = Arc::new(Mutex::new(first.into_iter().collect()));
    let writer = UdpWriter {
        socket: socket.try_clone()?,
        peers: Arc::clone(&peers),
    };
    let reader = UdpReader {
        socket,
        peers: remote.is_none().then_some(peers),
        wary: false,
        sender: None,
    };
    Ok((reader, writer))
}

impl ReadingHalf for UdpReader {
    fn be_wary(&mut self) {
        self.wary = true;
    }

    fn is_datagrams(&self) -> bool {
        true
    }

    fn answer_sender(&self) {
        if let (Some(peers), Some(sender)) = (&self.peers, self.sender) {
            remember(&mut locked(peers), sender);
        }
    }

    fn read(&mut self, buffer: &mut [u8], _is_silent: bool) -> LinkRead {
        match self.socket.recv_from(buffer) {
            Ok((count, from)) => {
                self.sender = Some(from);
                if !self.wary {
                    self.answer_sender();
                }
                LinkRead::Bytes(count)
            }
            Err(error) => {
                if !nothing_came(&error) {
                    std::thread::sleep(Duration::from_millis(10));
                }
                LinkRead::Nothing
            }
        }
    }

    fn wait_for(&self, time: Duration) -> bool {
        self.socket.set_read_timeout(Some(time)).is_ok()
    }

    fn discard(&mut self, buffer: &mut [u8]) -> bool {
        self.socket.recv_from(buffer).is_ok()
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

impl WritingHalf for UdpWriter {
    /// Sends a datagram to each peer.
    fn write(&self, bytes: &[u8]) -> bool {
        let mut sent = false;
        for (address, _) in locked(&self.peers).iter() {
            sent |= self.socket.send_to(bytes, address).is_ok();
        }
        sent
    }
}

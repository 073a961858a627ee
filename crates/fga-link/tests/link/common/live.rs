//! The ArduPlane-like emulator behind a socket, in real time, and a disc on its leg.
#![allow(
    dead_code,
    unreachable_pub,
    clippy::std_instead_of_alloc,
    clippy::std_instead_of_core,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a bench that the tests of two crates use in part"
)]

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use fga_emulator::{Emulator, EmulatorSettings, MissionItem, PlaneMode};
use fga_link::wire::{Framer, Signing, encode};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{MavCmd, MavMessage};

/// The disc on the leg, metres ahead of the start, and its radius.
pub const AHEAD_M: f64 = 500.0;
pub const RADIUS_M: f64 = 60.0;
/// Longest wait of a test.
const LONGEST: Duration = Duration::from_mins(1);

/// A configuration with the disc. The margin is for a machine that is busy with other tests: these tests
/// are about stalls, not about the distance.
pub fn config() -> String {
    let emulator = Emulator::new(EmulatorSettings::default());
    let place = emulator.home().to_place([0.0, AHEAD_M, 100.0]);
    format!(
        "[protection]\nmargin_m = 15.0\n[[obstacle]]\nname = \"disc\"\nlatitude_deg = {:.7}\nlongitude_deg = {:.7}\naltitude_m = 104.0\nradius_m = {RADIUS_M}\n",
        f64::from(place.latitude_e7) * 1e-7,
        f64::from(place.longitude_e7) * 1e-7,
    )
}

/// A command of a mode that reached the vehicle: the mode asked for, and the one it was in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeCommand {
    pub asked: u32,
    pub was: PlaneMode,
}

#[derive(Default)]
struct Seen {
    commands: Vec<ModeCommand>,
    least_m: f64,
    /// Every frame that the vehicle sent.
    sent: Vec<Vec<u8>>,
}

/// The vehicle, flying in a thread of its own.
pub struct Live {
    pub address: SocketAddr,
    emulator: Arc<Mutex<Emulator>>,
    seen: Arc<Mutex<Seen>>,
    stop: Arc<AtomicBool>,
    /// While this is set the vehicle neither reads nor writes.
    pub frozen: Arc<AtomicBool>,
    /// TCP connections so far.
    pub connections: Arc<AtomicU32>,
    /// The vehicle's peer, once known.
    pub peer: Arc<Mutex<Option<SocketAddr>>>,
}

enum Wire {
    Udp(UdpSocket),
    Tcp(TcpListener, Option<TcpStream>),
}

impl Live {
    /// A vehicle on a UDP port that answers who speaks to it, or speaks to `peer` by itself.
    pub fn udp(peer: Option<SocketAddr>, key: Option<[u8; 32]>) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        socket
            .set_read_timeout(Some(Duration::from_millis(2)))
            .expect("a time-out");
        let address = socket.local_addr().expect("an address");
        Self::begin(address, Wire::Udp(socket), peer, key)
    }

    /// A vehicle that waits for a TCP connection.
    pub fn tcp() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        listener.set_nonblocking(true).expect("non-blocking");
        let address = listener.local_addr().expect("an address");
        Self::begin(address, Wire::Tcp(listener, None), None, None)
    }

    fn begin(
        address: SocketAddr,
        wire: Wire,
        peer: Option<SocketAddr>,
        key: Option<[u8; 32]>,
    ) -> Self {
        let mut emulator = Emulator::new(EmulatorSettings::default());
        let home = *emulator.home();
        let points = [[0.0, 0.0, 4.0], [0.0, 0.0, 100.0], [0.0, 9000.0, 100.0]];
        emulator.set_mission(
            points
                .map(|point| MissionItem::waypoint(&home, point))
                .to_vec(),
            2,
        );
        let live = Self {
            address,
            emulator: Arc::new(Mutex::new(emulator)),
            seen: Arc::new(Mutex::new(Seen {
                least_m: f64::INFINITY,
                ..Seen::default()
            })),
            stop: Arc::default(),
            frozen: Arc::default(),
            connections: Arc::default(),
            peer: Arc::new(Mutex::new(peer)),
        };
        let flying = Flying {
            emulator: Arc::clone(&live.emulator),
            seen: Arc::clone(&live.seen),
            stop: Arc::clone(&live.stop),
            frozen: Arc::clone(&live.frozen),
            connections: Arc::clone(&live.connections),
            peer: Arc::clone(&live.peer),
            signing: key.map(|key| Signing::new(key, 7, false)),
        };
        thread::spawn(move || flying.fly(wire));
        live
    }

    pub fn emulator(&self) -> MutexGuard<'_, Emulator> {
        self.emulator.lock().expect("the vehicle")
    }

    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().expect("what was seen")
    }

    pub fn mode(&self) -> PlaneMode {
        self.emulator().mode()
    }

    /// Commands of a mode that have reached the vehicle.
    pub fn commands(&self) -> Vec<ModeCommand> {
        self.seen().commands.clone()
    }

    /// Least distance to the centre of the disc, metres.
    pub fn least_m(&self) -> f64 {
        self.seen().least_m
    }

    /// All frames that the vehicle sent.
    pub fn sent(&self) -> Vec<Vec<u8>> {
        self.seen().sent.clone()
    }

    pub fn was_told(&self, words: &str) -> bool {
        self.emulator()
            .texts()
            .iter()
            .any(|text| text.contains(words))
    }

    /// Waits until something holds.
    pub fn wait_until(&self, what: &str, holds: impl Fn(&Self) -> bool) {
        let since = Instant::now();
        while !holds(self) {
            assert!(
                since.elapsed() < LONGEST,
                "waited for: {what}; {:?}, {:?}",
                self.mode(),
                self.emulator().texts()
            );
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until the companion flies a turn.
    pub fn wait_for_maneuver(&self) {
        self.wait_until("a manoeuvre", |live| {
            live.mode() == PlaneMode::Guided && live.emulator().plant().bank_rad().abs() > 0.15
        });
    }

    /// Waits until the disc is passed and the mission flown again.
    pub fn wait_for_mission(&self) {
        self.wait_until("the mission", |live| {
            live.mode() == PlaneMode::Auto
                && live.emulator().plant().position_m()[1] > AHEAD_M + 30.0
        });
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

struct Flying {
    emulator: Arc<Mutex<Emulator>>,
    seen: Arc<Mutex<Seen>>,
    stop: Arc<AtomicBool>,
    frozen: Arc<AtomicBool>,
    connections: Arc<AtomicU32>,
    peer: Arc<Mutex<Option<SocketAddr>>>,
    signing: Option<Signing>,
}

impl Flying {
    fn fly(self, mut wire: Wire) {
        let mut framer = Framer::new(self.signing.clone());
        let (start, mut flown_s, mut sequence) = (Instant::now(), 0.0, 0_u8);
        while !self.stop.load(Ordering::Relaxed) {
            let is_frozen = self.frozen.load(Ordering::Relaxed);
            if !is_frozen {
                self.read(&mut wire, &mut framer);
            }
            thread::sleep(Duration::from_millis(2));
            let now_s = start.elapsed().as_secs_f64();
            let mut emulator = self.emulator.lock().expect("the vehicle");
            emulator.advance(now_s - flown_s);
            flown_s = now_s;
            let [east, north, _] = emulator.plant().position_m();
            let range_m = east.hypot(north - AHEAD_M);
            let messages = emulator.drain();
            drop(emulator);
            let mut seen = self.seen.lock().expect("what was seen");
            seen.least_m = seen.least_m.min(range_m);
            for message in messages {
                let header = MavHeader {
                    system_id: 1,
                    component_id: 1,
                    sequence,
                };
                sequence = sequence.wrapping_add(1);
                let raw = encode(header, &message, self.signing.as_ref());
                seen.sent.push(raw.raw_bytes().to_vec());
                if !is_frozen {
                    self.write(&mut wire, raw.raw_bytes());
                }
            }
        }
    }

    fn read(&self, wire: &mut Wire, framer: &mut Framer) {
        let mut buffer = [0; 4096];
        match wire {
            Wire::Udp(socket) => {
                while let Ok((count, from)) = socket.recv_from(&mut buffer) {
                    self.take(framer, &buffer[..count]);
                    *self.peer.lock().expect("the peer") = Some(from);
                }
            }
            Wire::Tcp(listener, stream) => {
                if let Ok((new, _)) = listener.accept() {
                    new.set_nodelay(true).expect("no delay");
                    new.set_nonblocking(true).expect("non-blocking");
                    self.connections.fetch_add(1, Ordering::Relaxed);
                    framer.reset();
                    *stream = Some(new);
                }
                while let Some(count) = stream
                    .as_mut()
                    .and_then(|stream| stream.read(&mut buffer).ok())
                    .filter(|count| *count > 0)
                {
                    self.take(framer, &buffer[..count]);
                }
            }
        }
    }

    fn take(&self, framer: &mut Framer, bytes: &[u8]) {
        let mut emulator = self.emulator.lock().expect("the vehicle");
        framer.push(bytes, |frame| {
            if let MavMessage::COMMAND_LONG(data) = &frame.message
                && data.command == MavCmd::MAV_CMD_DO_SET_MODE
            {
                let command = ModeCommand {
                    asked: data.param2 as u32,
                    was: emulator.mode(),
                };
                self.seen.lock().expect("seen").commands.push(command);
            }
            emulator.receive(&frame.header, &frame.message);
        });
    }

    fn write(&self, wire: &mut Wire, bytes: &[u8]) {
        match wire {
            Wire::Udp(socket) => {
                if let Some(peer) = *self.peer.lock().expect("the peer") {
                    let _ = socket.send_to(bytes, peer);
                }
            }
            Wire::Tcp(_, stream) => {
                if let Some(open) = stream
                    && open.write_all(bytes).is_err()
                {
                    *stream = None;
                }
            }
        }
    }
}

/// A folder of a test, empty.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

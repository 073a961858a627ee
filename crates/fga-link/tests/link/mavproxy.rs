//! `fga fly` behind MAVProxy, in real time: the ArduPlane-like emulator on MAVProxy's master link,
//! `fga fly` on one output, a ground station on another. One obstacle is flown round.
//!
//! Needs Python with `MAVProxy`; `FGA_PYTHON` names the interpreter. Without it the test is skipped,
//! except in CI.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::time::Duration;
use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Instant;

use fga_emulator::{Emulator, EmulatorSettings, MissionItem, PlaneMode, VehicleModeChange};
use fga_link::Config;
use fga_link::fly::{FlyOptions, fly};
use fga_link::wire::{Framer, encode};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{MavMessage, PARAM_REQUEST_READ_DATA};

/// The disc on the leg.
const AHEAD_M: f64 = 700.0;
const RADIUS_M: f64 = 60.0;
/// The flight is over when the mission is resumed, or given up after this.
const LONGEST: Duration = Duration::from_mins(3);

fn python() -> Option<String> {
    let python = std::env::var("FGA_PYTHON").unwrap_or_else(|_| "python3".into());
    let present = Command::new(&python)
        .args(["-c", "import MAVProxy.mavproxy"])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    if present {
        return Some(python);
    }
    let missing = format!("{python} has no module MAVProxy (FGA_PYTHON names another)");
    assert!(std::env::var("CI").is_err(), "{missing}");
    eprintln!("skipped: {missing}");
    None
}

/// A UDP port that is free now.
fn free_port() -> u16 {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    socket.local_addr().expect("an address").port()
}

/// Ends with the test.
struct Peer(Child);

impl Drop for Peer {
    fn drop(&mut self) {
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

fn start_mavproxy(python: &str, master: &str, outputs: [u16; 2], folder: &Path) -> Peer {
    let said = File::create(folder.join("mavproxy.txt")).expect("a file");
    let child = Command::new(python)
        .args(["-m", "MAVProxy.mavproxy", "--non-interactive"])
        .args(["--default-modules=", "--master", master])
        .args(outputs.map(|port| format!("--out=udpout:127.0.0.1:{port}")))
        .arg(format!("--state-basedir={}", folder.display()))
        .env("HOME", folder)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(said.try_clone().expect("a file"))
        .stderr(said)
        .spawn()
        .expect("MAVProxy starts");
    Peer(child)
}

/// What the flight was like, seen from the vehicle.
struct Flown {
    changes: Vec<VehicleModeChange>,
    /// Least distance to the disc, metres.
    least_m: f64,
    /// The texts that it got for the operator; it passes them on to its other links.
    texts: Vec<String>,
}

/// Flies north in AUTO, in real time, until the mission is resumed.
fn fly_emulator(server: &TcpListener) -> Flown {
    let mut emulator = Emulator::new(EmulatorSettings::default());
    emulator.set_card(|_| Some(4.0));
    let home = *emulator.home();
    let points = [[0.0, 0.0, 4.0], [0.0, 0.0, 100.0], [0.0, 9000.0, 100.0]];
    emulator.set_mission(
        points
            .map(|point| MissionItem::waypoint(&home, point))
            .to_vec(),
        2,
    );
    let (mut stream, _) = server.accept().expect("MAVProxy");
    stream.set_nodelay(true).expect("no delay");
    stream
        .set_read_timeout(Some(Duration::from_millis(5)))
        .expect("a time-out");
    let (start, mut flown_s) = (Instant::now(), 0.0);
    let (mut framer, mut buffer) = (Framer::new(None), [0; 4096]);
    let (mut sequence, mut least_m) = (0_u8, f64::INFINITY);
    while emulator.mode_changes().len() < 2 && start.elapsed() < LONGEST {
        if let Ok(count) = stream.read(&mut buffer) {
            framer.push(&buffer[..count], |frame| {
                emulator.receive(&frame.header, &frame.message);
            });
        }
        let now_s = start.elapsed().as_secs_f64();
        emulator.advance(now_s - flown_s);
        flown_s = now_s;
        let [east, north, _] = emulator.plant().position_m();
        least_m = least_m.min(east.hypot(north - AHEAD_M));
        for message in emulator.drain() {
            let header = MavHeader {
                system_id: 1,
                component_id: 1,
                sequence,
            };
            sequence = sequence.wrapping_add(1);
            let raw = encode(header, &message, None);
            stream.write_all(raw.raw_bytes()).expect("MAVProxy");
        }
    }
    Flown {
        changes: emulator.mode_changes().to_vec(),
        least_m,
        texts: emulator.texts().to_vec(),
    }
}

/// A ground station: it listens, and asks for a parameter again and again. Gives the modes it was told
/// and how often the parameter came.
fn watch_from_ground(ground: &UdpSocket, stop: &AtomicBool) -> (Vec<u32>, u32) {
    let (mut framer, mut buffer) = (Framer::new(None), [0; 4096]);
    let (mut modes, mut answers, mut asked) = (Vec::new(), 0, None::<Instant>);
    while !stop.load(Ordering::Relaxed) {
        let Ok((count, mavproxy)) = ground.recv_from(&mut buffer) else {
            continue;
        };
        framer.push(&buffer[..count], |frame| match frame.message {
            MavMessage::HEARTBEAT(data)
                if frame.header.component_id == 1 && modes.last() != Some(&data.custom_mode) =>
            {
                modes.push(data.custom_mode);
            }
            MavMessage::PARAM_VALUE(data) => {
                answers += u32::from(data.param_id.to_str() == Ok("WP_LOITER_RAD"));
            }
            _ => {}
        });
        framer.reset();
        if asked.is_none_or(|asked| asked.elapsed() > Duration::from_secs(1)) {
            asked = Some(Instant::now());
            let message = MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
                param_index: -1,
                param_id: "WP_LOITER_RAD".into(),
                target_system: 1,
                target_component: 1,
            });
            let header = MavHeader {
                system_id: 254,
                component_id: 190,
                sequence: 0,
            };
            let raw = encode(header, &message, None);
            ground.send_to(raw.raw_bytes(), mavproxy).expect("MAVProxy");
        }
    }
    (modes, answers)
}

#[test]
fn a_ground_station_and_fga_fly_work_side_by_side_behind_mavproxy() {
    let Some(python) = python() else { return };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("mavproxy");
    drop(fs::remove_dir_all(&folder));
    fs::create_dir_all(&folder).expect("a folder");
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let master = format!("tcp:{}", server.local_addr().expect("an address"));
    let ground = UdpSocket::bind("127.0.0.1:0").expect("a port");
    ground
        .set_read_timeout(Some(Duration::from_millis(100)))
        .expect("a time-out");
    let ground_port = ground.local_addr().expect("an address").port();
    let fly_port = free_port();

    let place = EmulatorSettings::default()
        .home
        .to_place([0.0, AHEAD_M, 100.0]);
    let config = format!(
        "[[obstacle]]\nname = \"disc\"\nlatitude_deg = {}\nlongitude_deg = {}\naltitude_m = {}\nradius_m = {RADIUS_M:?}\n[terrain]\nsource = \"vehicle\"\nclearance_m = 20.0\n",
        f64::from(place.latitude_e7) * 1e-7,
        f64::from(place.longitude_e7) * 1e-7,
        f64::from(place.altitude_mm) * 1e-3
    );
    let options = FlyOptions {
        endpoint: format!("udpin:127.0.0.1:{fly_port}")
            .parse()
            .expect("valid"),
        config: Config::parse(&config).expect("valid"),
        traffic: Vec::new(),
        terrain: None,
        dry_run: false,
        out: folder.join("logs"),
        status: false,
        end_program: || panic!("the program must not be ended"),
    };
    let (stop, landed) = (Arc::new(AtomicU32::new(0)), AtomicBool::new(false));
    let peer = start_mavproxy(&python, &master, [fly_port, ground_port], &folder);
    let (flown, modes, answers) = thread::scope(|scope| {
        let flying = scope.spawn(|| fly(&options, &stop, &mut |_| {}));
        let watching = scope.spawn(|| watch_from_ground(&ground, &landed));
        let flown = fly_emulator(&server);
        stop.store(1, Ordering::Relaxed);
        landed.store(true, Ordering::Relaxed);
        flying.join().expect("ends").expect("flies");
        let (modes, answers) = watching.join().expect("ends");
        (flown, modes, answers)
    });
    drop(peer);
    let said = fs::read_to_string(folder.join("mavproxy.txt")).expect("text");
    let changes: Vec<(PlaneMode, u8)> = flown
        .changes
        .iter()
        .map(|change| (change.mode, change.component_id))
        .collect();
    let texts = flown.texts;
    assert_eq!(
        changes,
        [(PlaneMode::Guided, 196), (PlaneMode::Auto, 196)],
        "{texts:?} {said}"
    );
    assert!(flown.least_m >= RADIUS_M, "{}", flown.least_m);
    let avoiding = |text: &String| text.starts_with("fga: avoiding disc");
    assert!(texts.iter().any(avoiding), "{texts:?}");
    // MAVProxy and the ground station see the manoeuvre, and the ground station is answered.
    assert!(said.contains("Mode GUIDED"), "{said}");
    assert!(modes.starts_with(&[10, 15]), "{modes:?}");
    assert!(answers > 0);
    // Behind MAVProxy too the vehicle says how high the ground is.
    let log = fs::read_dir(folder.join("logs")).expect("logs").flatten();
    let mut log = log.filter(|entry| entry.path().extension().is_some_and(|end| end == "jsonl"));
    let log = fs::read_to_string(log.next().expect("a log").path()).expect("text");
    let heard = log.lines().find(|line| line.contains("\"ground-heard\""));
    let heard: serde_json::Value = serde_json::from_str(heard.expect("counts")).expect("JSON");
    assert!(heard["pieces"]["taken"].as_u64() > Some(10), "{heard}");
    assert!(log.contains("\"above_ground_m\":"));
}

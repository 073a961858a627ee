//! `fga emulate`: an ArduPlane-like vehicle in real time, with an intruder, for a first manoeuvre without a vehicle.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::time::Instant;

use clap::Args;
use fga::Vec3;
use fga_emulator::{Emulator, EmulatorSettings, MissionItem, PlaneMode};
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_link::endpoint::{Endpoint, LinkRead, LinkReader, LinkWriter, open};
use fga_link::mavlink::MavHeader;
use fga_link::mavlink::dialects::ardupilotmega::MavMessage;
use fga_link::player::{Played, PlayerLine};
use fga_link::wire::{Framer, WireFrame, encode};

use crate::failure::Failure;
use crate::fly::{self, FlyArgs};

/// The intruder without `--intruder`: head-on on the first leg, 2.5 km away.
const HEAD_ON: &str = "ABC123,37.6414,-122.375,104,180,25";
/// The corners of the mission, metres east, north and up of home; the flight begins at the second one.
const MISSION_M: [[f64; 3]; 6] = [
    [0.0, 0.0, 4.0],
    [0.0, 0.0, 100.0],
    [0.0, 3000.0, 100.0],
    [3000.0, 3000.0, 100.0],
    [3000.0, 0.0, 100.0],
    [0.0, 0.0, 100.0],
];
/// With `--fly` the flight ends this long after the mode was given back, seconds.
const ENDS_AFTER_S: f64 = 5.0;
/// Reports of the intruders come each second, as from a vehicle's own list.
const REPORT_EVERY_S: f64 = 1.0;
const STEP: Duration = Duration::from_millis(5);

/// Emulate an ArduPlane-like vehicle and an intruder in real time (it is not ArduPlane).
#[derive(Args)]
pub(crate) struct EmulateArgs {
    /// Endpoint on which the vehicle is served: tcpin:HOST:PORT, udpin:HOST:PORT, udpout:HOST:PORT.
    #[arg(long, value_name = "ENDPOINT", default_value = "tcpin:127.0.0.1:5760")]
    serve: Endpoint,
    /// An intruder, which the vehicle reports: `ICAO,LATITUDE,LONGITUDE,ALTITUDE_M,TRACK_DEG,SPEED_MPS[,CLIMB_MPS[,AT_S]]`; without
    /// one an aircraft comes head-on.
    #[arg(long, value_name = "LINE", allow_hyphen_values = true)]
    intruder: Vec<PlayerLine>,
    /// No intruder.
    #[arg(long, conflicts_with = "intruder")]
    alone: bool,
    /// Run `fga fly` on it too, and end after its first manoeuvre.
    #[arg(long)]
    fly: bool,
    /// With --fly: the configuration of `fga fly` (TOML).
    #[arg(long, value_name = "FILE", requires = "fly")]
    config: Option<PathBuf>,
    /// With --fly: show the flight in the browser.
    #[arg(long, requires = "fly")]
    live: bool,
    /// With --fly: folder for the logs.
    #[arg(long, value_name = "DIR", default_value = "out/fly")]
    out: PathBuf,
    /// End after this time, seconds.
    #[arg(long, value_name = "SECONDS")]
    seconds: Option<f64>,
}

pub(crate) fn run(args: &EmulateArgs) -> Result<ExitCode, Failure> {
    if args.seconds.is_some_and(|s| !(s > 0.0 && s.is_finite())) {
        return Err(Failure::Input("--seconds must be above 0".to_owned()));
    }
    let connect = args.fly.then(|| own_endpoint(&args.serve)).transpose()?;
    let named = |error| Failure::Input(format!("emulate on {}: {error}", fly::shown(&args.serve)));
    let link = open(&args.serve).map_err(named)?;
    let mut vehicle = EmulatedFlight::new(args, link)?;
    let Some(connect) = connect else {
        let stop = fly::stop_on_interrupt();
        tell(&format!("emulating on {}", fly::shown(&args.serve)));
        vehicle.fly(&stop, args.seconds);
        vehicle.tell_least();
        return Ok(ExitCode::SUCCESS);
    };
    let flown = FlyArgs::on(connect, args.config.clone(), args.out.clone(), args.live);
    let (signals, over) = (fly::count_interrupts(), Arc::new(AtomicBool::new(false)));
    let (to_end, until, seconds) = (Arc::clone(&signals), Arc::clone(&over), args.seconds);
    vehicle.ends_after_maneuver = true;
    let emulated = thread::spawn(move || {
        vehicle.fly(&until, seconds);
        to_end.fetch_add(1, Ordering::Relaxed);
        // It answers until `fga fly` has ended too.
        vehicle.ends_after_maneuver = false;
        vehicle.fly(&until, None);
        vehicle
    });
    let done = fly::run_until(&flown, &signals);
    over.store(true, Ordering::Relaxed);
    // Without `fga fly`, as with a bad link file, nothing was avoided.
    if let (Ok(vehicle), Ok(_)) = (emulated.join(), &done) {
        vehicle.tell_least();
    }
    done
}

/// The other end of an endpoint of this computer.
fn own_endpoint(served: &Endpoint) -> Result<Endpoint, Failure> {
    match served {
        Endpoint::TcpIn(address) => Ok(Endpoint::Tcp(address.clone())),
        Endpoint::UdpIn(address) => Ok(Endpoint::UdpOut(address.clone())),
        _ => Err(Failure::Input(
            "--fly needs an endpoint that waits, expected --serve tcpin:HOST:PORT or udpin:HOST:PORT"
                .to_owned(),
        )),
    }
}

/// Tells the terminal, if anybody reads it.
fn tell(words: &str) {
    let _ = writeln!(io::stderr(), "{words}");
}

/// The vehicle behind its link, and who flies beside it.
struct EmulatedFlight {
    emulator: Emulator,
    writer: LinkWriter,
    heard: Receiver<WireFrame>,
    frame: LocalFrame,
    intruders: Vec<Played>,
    /// Least distance to each intruder, metres, and when, seconds.
    least: Vec<(f64, f64)>,
    flown_s: f64,
    report_s: f64,
    sequence: u8,
    told_changes: usize,
    ends_after_maneuver: bool,
}

impl EmulatedFlight {
    fn new(args: &EmulateArgs, link: (LinkReader, LinkWriter)) -> Result<Self, Failure> {
        let mut emulator = Emulator::new(EmulatorSettings::default());
        let home = *emulator.home();
        let items = MISSION_M.map(|corner_m| MissionItem::waypoint(&home, corner_m));
        emulator.set_mission(items.to_vec(), 2);
        let mut lines = args.intruder.clone();
        if lines.is_empty() && !args.alone {
            lines.extend(HEAD_ON.parse::<PlayerLine>());
        }
        let named = |PlayerLine(intruder)| Played {
            callsign: format!("{:06X}", intruder.icao),
            ..intruder
        };
        let intruders: Vec<Played> = lines.into_iter().map(named).collect();
        let place = Geodetic::new(home.latitude_deg, home.longitude_deg, home.altitude_m)
            .ok_or_else(|| Failure::Input("home is no place".to_owned()))?;
        let (reader, writer) = link;
        Ok(Self {
            emulator,
            writer,
            heard: read(reader),
            frame: LocalFrame::new(place, Earth::Wgs84),
            least: vec![(f64::INFINITY, 0.0); intruders.len()],
            intruders,
            flown_s: 0.0,
            report_s: 0.0,
            sequence: 0,
            told_changes: 0,
            ends_after_maneuver: false,
        })
    }

    /// Flies in real time until told to stop, for a time, or until a manoeuvre is over.
    fn fly(&mut self, stop: &AtomicBool, seconds: Option<f64>) {
        let (start, began_s) = (Instant::now(), self.flown_s);
        let mut back_s = None;
        while !stop.load(Ordering::Relaxed) && seconds.is_none_or(|s| self.flown_s < s) {
            let now_s = began_s + start.elapsed().as_secs_f64();
            self.step(now_s);
            let changes = self.emulator.mode_changes();
            let is_back = changes
                .last()
                .is_some_and(|change| change.mode == PlaneMode::Auto);
            back_s = is_back.then(|| back_s.unwrap_or(now_s));
            if self.ends_after_maneuver && back_s.is_some_and(|s| now_s - s >= ENDS_AFTER_S) {
                break;
            }
            thread::sleep(STEP);
        }
    }

    fn step(&mut self, now_s: f64) {
        while let Ok(frame) = self.heard.try_recv() {
            self.emulator.receive(&frame.header, &frame.message);
        }
        self.emulator.advance(now_s - self.flown_s);
        self.flown_s = now_s;
        let own_m = Vec3::from_array(self.emulator.plant().position_m());
        for (intruder, least) in self.intruders.iter().zip(&mut self.least) {
            if let Some(state) = intruder.at(now_s) {
                let apart_m = (self.frame.to_local_m(state.place) - own_m).length();
                if apart_m < least.0 {
                    *least = (apart_m, now_s);
                }
            }
        }
        let mut messages = self.emulator.drain();
        if now_s >= self.report_s {
            self.report_s = now_s + REPORT_EVERY_S;
            messages.extend(self.intruders.iter().filter_map(|i| i.message_at(now_s)));
        }
        for message in &messages {
            self.send(message);
        }
        for change in self.emulator.mode_changes().iter().skip(self.told_changes) {
            let by = change.component_id;
            tell(&format!(
                "{now_s:8.2} s  emulator: {:?}, asked by component {by}",
                change.mode
            ));
        }
        self.told_changes = self.emulator.mode_changes().len();
    }

    fn send(&mut self, message: &MavMessage) {
        let header = MavHeader {
            system_id: u32::from(self.emulator.system_id()),
            component_id: 1,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write(encode(header, message, None).raw_bytes());
    }

    /// Tells how near each intruder came, by the true places.
    fn tell_least(&self) {
        for (intruder, (apart_m, at_s)) in self.intruders.iter().zip(&self.least) {
            if apart_m.is_finite() {
                let icao = intruder.icao;
                tell(&format!(
                    "emulator: least distance to {icao:06X} {apart_m:.0} m, after {at_s:.1} s"
                ));
            }
        }
    }
}

/// Reads the link on a thread of its own, which ends with the program.
fn read(mut reader: LinkReader) -> Receiver<WireFrame> {
    let (to, heard) = sync_channel(1024);
    thread::spawn(move || {
        let mut framer = Framer::new(None);
        let mut buffer = [0; 4096];
        loop {
            match reader.read(&mut buffer) {
                // A full queue loses frames, as a link does.
                LinkRead::Bytes(count) => {
                    let bytes = buffer.get(..count).unwrap_or(&[]);
                    framer.push(bytes, |frame| {
                        let _ = to.try_send(frame);
                    });
                }
                LinkRead::NewConnection => framer.reset(),
                LinkRead::Nothing => {}
            }
        }
    });
    heard
}

//! The program: sockets, clock and files around the companion.
//!
//! One thread reads the link, one reads each receiver, one keeps watch over the others; the main
//! thread decides and sends. All queues are bounded: what comes faster than it can be taken is
//! dropped, telemetry last.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use core::time::Duration;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{COMMAND_LONG_DATA, MavCmd, MavMessage};

use crate::endpoint::{Endpoint, Reader, Received, Writer, open};
use crate::number::{single, to_u64};
use crate::outgoing::{AUTOPILOT, OWN_COMPONENT};
use crate::player::{Sample, adsb_message};
use crate::tlog::TlogWriter;
use crate::traffic::Report;
use crate::traffic::receiver::{self, ReceiverEndpoint};
use crate::wire::{Frame, Framer, Signing, encode};
use crate::{Companion, Config};

/// Events that wait between the reading threads and the main thread.
const QUEUE: usize = 2048;
/// Under these a receiver's reports stand in the telemetry log (`MAV_COMP_ID_ADSB`).
const RECEIVER_SYSTEM: u8 = 200;
const RECEIVER_COMPONENT: u8 = 156;
/// Longest time without a tick.
const TICK: Duration = Duration::from_millis(10);
/// The main thread has stopped when it did not tick for so long; then the mode is restored for it.
const STALLED: Duration = Duration::from_millis(1500);

/// What `fga fly` is told.
#[derive(Debug, Clone)]
pub struct FlyOptions {
    /// Where the vehicle is.
    pub endpoint: Endpoint,
    /// The configuration.
    pub config: Config,
    /// Receivers of traffic.
    pub traffic: Vec<ReceiverEndpoint>,
    /// Only report.
    pub dry_run: bool,
    /// Where the logs go.
    pub out: PathBuf,
    /// Whether a status line is kept on standard error.
    pub status: bool,
}

enum Event {
    Frame(Box<Frame>),
    Traffic(Box<Report>),
}

fn send_or_drop(to: &SyncSender<Event>, event: Event) -> bool {
    !matches!(to.try_send(event), Err(TrySendError::Disconnected(_)))
}

fn read_link(
    mut reader: Reader,
    signing: Option<Signing>,
    to: &SyncSender<Event>,
    stop: &AtomicBool,
) {
    let mut framer = Framer::new(signing);
    let mut buffer = vec![0; 4096];
    while !stop.load(Ordering::Relaxed) {
        match reader.read(&mut buffer) {
            Received::Bytes(count) => {
                let bytes = buffer.get(..count).unwrap_or_default();
                framer.push(bytes, |frame| {
                    send_or_drop(to, Event::Frame(Box::new(frame)));
                });
                if reader.is_datagrams() {
                    framer.reset();
                }
            }
            Received::NewConnection => framer.reset(),
            Received::Nothing => {}
        }
    }
}

/// What the watching thread needs to know, written by the main thread.
#[derive(Debug, Default)]
struct Watch {
    /// Milliseconds since the start at the last tick.
    ticked_ms: AtomicU64,
    /// Vehicle and mode to restore.
    owed: Mutex<Option<(u8, u32)>>,
}

/// Restores the mode when the main thread hangs in mid-manoeuvre: a heading command would be held
/// for ever.
fn keep_watch(
    watch: &Watch,
    writer: &Writer,
    signing: Option<&Signing>,
    start: Instant,
    stop: &AtomicBool,
) {
    while !stop.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(200));
        let now_ms = u64::try_from(start.elapsed().as_millis()).unwrap_or(u64::MAX);
        let silent_ms = now_ms.saturating_sub(watch.ticked_ms.load(Ordering::Relaxed));
        if u128::from(silent_ms) < STALLED.as_millis() {
            continue;
        }
        let owed = *watch.owed.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((system, mode)) = owed {
            let message = MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
                command: MavCmd::MAV_CMD_DO_SET_MODE,
                param1: 1.0,
                param2: single(f64::from(mode)),
                target_system: system,
                target_component: AUTOPILOT,
                ..COMMAND_LONG_DATA::DEFAULT
            });
            let header = MavHeader {
                system_id: u32::from(system),
                component_id: OWN_COMPONENT,
                sequence: 0,
            };
            writer.write(encode(header, &message, signing).raw_bytes());
        }
    }
}

/// Sequence numbers by sender.
#[derive(Debug, Default)]
struct Sequences(Vec<(u8, u8)>);

impl Sequences {
    fn next(&mut self, system_id: u8) -> u8 {
        if let Some(entry) = self.0.iter_mut().find(|entry| entry.0 == system_id) {
            entry.1 = entry.1.wrapping_add(1);
            return entry.1;
        }
        self.0.push((system_id, 0));
        0
    }
}

/// The two logs of a flight.
struct Logs {
    tlog: TlogWriter<BufWriter<File>>,
    decisions: BufWriter<File>,
    flushed: Instant,
}

impl Logs {
    fn create(folder: &Path, unix_us: u64) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let name = format!("fly-{}", unix_us / 1_000_000);
        let tlog = File::create(folder.join(format!("{name}.tlog")))?;
        let decisions = File::create(folder.join(format!("{name}.jsonl")))?;
        Ok(Self {
            tlog: TlogWriter::new(BufWriter::new(tlog)),
            decisions: BufWriter::new(decisions),
            flushed: Instant::now(),
        })
    }

    fn flush_now_and_then(&mut self) -> io::Result<()> {
        if self.flushed.elapsed() >= Duration::from_secs(1) {
            self.flushed = Instant::now();
            self.tlog.flush()?;
            self.decisions.flush()?;
        }
        Ok(())
    }
}

/// Flies until `stop` is set; hands the vehicle back before it returns. `watch` sees the companion
/// after each step; the flight waits for it.
///
/// # Errors
/// An endpoint that cannot be opened, or logs that cannot be written.
pub fn fly(
    options: &FlyOptions,
    stop: &Arc<AtomicBool>,
    watch: &mut dyn FnMut(&Companion),
) -> io::Result<()> {
    let invalid = |error: crate::config::ConfigError| {
        io::Error::new(io::ErrorKind::InvalidInput, error.to_string())
    };
    let signing = options
        .config
        .signing_key()
        .map_err(invalid)?
        .map(|key| Signing::new(key, 1, options.config.link.allow_unsigned));
    let mut companion = Companion::new(options.config.clone(), options.dry_run).map_err(invalid)?;
    let (reader, writer) = open(&options.endpoint)?;
    let start = Instant::now();
    let begin = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    let begin_us = u64::try_from(begin.as_micros()).unwrap_or(0);
    let mut logs = Logs::create(&options.out, begin_us)?;
    let (to, events) = sync_channel(QUEUE);
    let ticks = Arc::new(Watch::default());
    thread::scope(|scope| {
        let (link_to, link_signing, link_stop) = (to.clone(), signing.clone(), Arc::clone(stop));
        scope.spawn(move || read_link(reader, link_signing, &link_to, &link_stop));
        for endpoint in &options.traffic {
            let (to, stop) = (to.clone(), Arc::clone(stop));
            scope.spawn(move || {
                let clock_s = || start.elapsed().as_secs_f64();
                receiver::read(endpoint, clock_s, &stop, |report| {
                    send_or_drop(&to, Event::Traffic(Box::new(report)))
                });
            });
        }
        let (watched, watch_writer, watch_signing) =
            (Arc::clone(&ticks), writer.clone(), signing.clone());
        let watch_stop = Arc::clone(stop);
        scope.spawn(move || {
            keep_watch(
                &watched,
                &watch_writer,
                watch_signing.as_ref(),
                start,
                &watch_stop,
            );
        });
        let mut pilot = Pilot {
            companion: &mut companion,
            writer: &writer,
            signing: signing.as_ref(),
            start,
            begin_us,
            sequences: Sequences::default(),
        };
        let result = pilot.run(&events, &mut logs, stop, &ticks, watch, options.status);
        stop.store(true, Ordering::Relaxed);
        result
    })
}

struct Pilot<'a> {
    companion: &'a mut Companion,
    writer: &'a Writer,
    signing: Option<&'a Signing>,
    start: Instant,
    begin_us: u64,
    sequences: Sequences,
}

impl Pilot<'_> {
    fn run(
        &mut self,
        events: &Receiver<Event>,
        logs: &mut Logs,
        stop: &AtomicBool,
        ticks: &Watch,
        watch: &mut dyn FnMut(&Companion),
        status: bool,
    ) -> io::Result<()> {
        let mut shown = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            match events.recv_timeout(TICK) {
                Ok(Event::Frame(frame)) => {
                    let now_s = self.now_s();
                    logs.tlog.write(self.unix_us(now_s), frame.bytes())?;
                    self.companion.receive(&frame.header, &frame.message, now_s);
                }
                Ok(Event::Traffic(report)) => {
                    let now_s = self.now_s();
                    self.record_report(logs, &report, now_s)?;
                    self.companion.take_report(&report, now_s);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            let now_s = self.now_s();
            self.companion.tick(now_s);
            self.send(logs, now_s)?;
            watch(self.companion);
            ticks
                .ticked_ms
                .store(to_u64(now_s * 1e3), Ordering::Relaxed);
            let owed = self
                .companion
                .owed_mode()
                .zip(self.companion.vehicle_system());
            *ticks.owed.lock().unwrap_or_else(PoisonError::into_inner) =
                owed.map(|(mode, system)| (system, mode.0));
            logs.flush_now_and_then()?;
            if status && shown.elapsed() >= Duration::from_millis(500) {
                shown = Instant::now();
                eprint!("\r\x1b[K{}", self.companion.status_line(now_s));
            }
        }
        if status {
            eprintln!();
        }
        // Several times: one may be lost, and nobody waits for the answer any more.
        for _ in 0..3 {
            let now_s = self.now_s();
            self.companion.shut_down(now_s);
            self.send(logs, now_s)?;
            thread::sleep(Duration::from_millis(300));
        }
        logs.tlog.flush()?;
        logs.decisions.flush()
    }

    /// Puts a receiver's report into the telemetry log, as the message that says the same, so that
    /// the recording holds all that decisions were made from.
    fn record_report(&mut self, logs: &mut Logs, report: &Report, now_s: f64) -> io::Result<()> {
        let sample = Sample {
            time_s: now_s,
            place: report.place,
            velocity_mps: report.velocity_mps.unwrap_or_default(),
        };
        let message = adsb_message(report.icao, &report.callsign, &sample);
        let header = MavHeader {
            system_id: u32::from(RECEIVER_SYSTEM),
            component_id: RECEIVER_COMPONENT,
            sequence: self.sequences.next(RECEIVER_SYSTEM),
        };
        let raw = encode(header, &message, None);
        logs.tlog.write(self.unix_us(now_s), raw.raw_bytes())
    }

    fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn unix_us(&self, now_s: f64) -> u64 {
        self.begin_us + to_u64(now_s * 1e6)
    }

    fn send(&mut self, logs: &mut Logs, now_s: f64) -> io::Result<()> {
        for outgoing in self.companion.outbox() {
            let header = MavHeader {
                system_id: u32::from(outgoing.system_id),
                component_id: OWN_COMPONENT,
                sequence: self.sequences.next(outgoing.system_id),
            };
            let raw = encode(header, &outgoing.message, self.signing);
            self.writer.write(raw.raw_bytes());
            logs.tlog.write(self.unix_us(now_s), raw.raw_bytes())?;
        }
        for line in self.companion.take_log() {
            writeln!(logs.decisions, "{line}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_hangs_in_a_manoeuvre_has_its_mode_restored() {
        let vehicle = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
        let address = vehicle.local_addr().unwrap().to_string();
        let (_reader, writer) = open(&Endpoint::UdpOut(address)).unwrap();
        let watch = Watch {
            ticked_ms: AtomicU64::new(0),
            owed: Mutex::new(Some((1, 10))),
        };
        let stop = AtomicBool::new(false);
        let start = Instant::now();
        let mut heard = None;
        thread::scope(|scope| {
            scope.spawn(|| keep_watch(&watch, &writer, None, start, &stop));
            let mut buffer = [0; 300];
            let count = vehicle.recv(&mut buffer).unwrap();
            stop.store(true, Ordering::Relaxed);
            Framer::new(None).push(&buffer[..count], |frame| heard = Some(frame.message));
        });
        let Some(MavMessage::COMMAND_LONG(command)) = heard else {
            panic!("{heard:?}");
        };
        assert_eq!(command.command, MavCmd::MAV_CMD_DO_SET_MODE);
        assert_eq!((command.target_system, command.param2), (1, 10.0));
        assert!(start.elapsed() >= STALLED);
    }
}

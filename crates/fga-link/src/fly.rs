//! The program: sockets, clock and files around the companion.
//!
//! | thread | does |
//! |---|---|
//! | the caller's | decides; waits for nothing but the clock and its inbox |
//! | `fga-read` | reads the link, and hears the vehicle's mode |
//! | `fga-write` | writes the link; checks each command of a mode at the last moment |
//! | `fga-traffic` | reads a receiver, one thread each |
//! | `fga-ground` | makes the ground around the flight |
//! | `fga-log`, `fga-notes`, `fga-status` | write files and the terminal, whose stalls affect nobody else |
//! | `fga-guard` | restores the mode and ends the program when the deciding thread stands still |
//!
//! All queues between them are bounded: a full queue drops, and the companion says so once.

mod guard;
mod link;
mod notebook;
mod recorder;
mod shared;
mod status;

use alloc::sync::Arc;
use core::sync::atomic::{AtomicU32, Ordering};
use core::time::Duration;
use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use fga_formats::terrain::Terrain;
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{AdsbAltitudeType, AdsbFlags, MavMessage};

use self::link::{Parcel, post};
use self::notebook::Notebook;
use self::recorder::Recorder;
use self::shared::{FlightShared, locked, spawn};
use self::status::StatusLine;
use crate::endpoint::{Endpoint, open};
use crate::ground::{GroundOrder, MadeGround};
use crate::outgoing::{OWN_COMPONENT, Outgoing, RECEIVER_COMPONENT, RECEIVER_SYSTEM};
use crate::player::{PlayedState, adsb_data};
use crate::steps::Step;
use crate::traffic::receiver::{self, FeedStatus, ReceiverEndpoint};
use crate::traffic::{AltitudeReference, PlaceReport};
use crate::wire::{Signing, WireFrame, encode};
use crate::{Companion, Config};

/// Most events between the reading threads and the deciding one.
const INBOX: usize = 2048;
/// Frames that wait to be written.
const OUTBOX: usize = 512;
/// Most events before the next tick.
const AT_ONCE: usize = 64;
/// An event that waited longer is history, seconds.
const HISTORY_S: f64 = 1.0;
/// Longest time without a tick.
const TICK: Duration = Duration::from_millis(10);
/// Longest wait at the end of a flight for a heartbeat with the mode from before.
const LAST_WORDS: Duration = Duration::from_secs(5);
/// Pause before a failed receiver's thread starts again.
const RECEIVER_PAUSE: Duration = Duration::from_secs(1);

/// Options of `fga fly`.
#[derive(Debug, Clone)]
pub struct FlyOptions {
    /// The vehicle's endpoint.
    pub endpoint: Endpoint,
    /// The configuration.
    pub config: Config,
    /// Receivers of traffic.
    pub traffic: Vec<ReceiverEndpoint>,
    /// Heights of the ground ([`Config::read_terrain`]).
    pub terrain: Option<Arc<Terrain>>,
    /// Only report.
    pub dry_run: bool,
    /// Folder of the logs, and of the notes for a restarted program.
    pub out: PathBuf,
    /// Whether to show a status line, and what the operator reads, on standard error.
    pub status: bool,
    /// Ends the program when its deciding thread stands still; `std::process::abort` in real flight.
    pub end_program: fn(),
}

enum InboxEvent {
    Frame(Box<WireFrame>, f64),
    Traffic(Box<PlaceReport>),
    Feed(Box<FeedStatus>),
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

/// Flies until `stop`, the number of signals to end, is not 0; restores the vehicle's mode before it returns, also after a
/// panic: after the first signal as soon as nothing threatens, after the second at once. `watch` sees the companion after each
/// step; the flight waits for it.
///
/// # Errors
/// An unusable configuration or endpoint, or a part of the program that has failed. An unwritable log
/// is no error; the companion reports it.
pub fn fly(
    options: &FlyOptions,
    stop: &Arc<AtomicU32>,
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
    if let Some(signing) = &signing
        && let Some(kept) = notebook::read_timestamps(&options.out)
    {
        signing.go_on_from(&kept);
    }
    let (notes, troubles) = notebook::read_notes(&options.out);
    let mut companion = Companion::new(options.config.clone(), options.dry_run).map_err(invalid)?;
    // A dry run gives no mode back, so it leaves the notes to a later run.
    let left = if options.dry_run {
        Vec::new()
    } else {
        notes.clone()
    };
    companion.set_notes(notes);
    companion.set_terrain(options.terrain.clone());
    let shared = Arc::new(FlightShared::new(
        Arc::clone(stop),
        options.config.vehicle.system_id,
    ));
    for words in troubles {
        shared.trouble(words);
    }
    let (to, events) = sync_channel(INBOX);
    let (parcels, to_write) = sync_channel(OUTBOX);
    let mut threads = start(
        options,
        &shared,
        signing.as_ref(),
        &to,
        (&parcels, to_write),
    )?;
    drop(to);
    let (orders, to_make) = sync_channel(1);
    let (made_to, made) = sync_channel(1);
    threads.push(spawn(&shared, "fga-ground", move |shared| {
        make_ground(shared, &to_make, &made_to);
    })?);
    let mut recorder = Recorder::begin(&shared, &options.out)?;
    let begin = Step::Begin {
        configuration: companion.fingerprint(),
        dry_run: options.dry_run,
    };
    recorder.step(&shared, 0.0, &begin);
    let mut pilot = DecidingThread {
        companion: &mut companion,
        shared: &shared,
        parcels: &parcels,
        signing: signing.as_ref(),
        recorder,
        notebook: Notebook::begin(&shared, &options.out, signing.clone(), left)?,
        status: StatusLine::begin(&shared, options.status)?,
        sequences: Sequences::default(),
        held: Vec::new(),
        ground: (orders, made),
        makes_ground: false,
    };
    let flown = std::panic::catch_unwind(core::panic::AssertUnwindSafe(|| {
        pilot.run(&events, watch);
    }));
    if flown.is_err() {
        guard::stand_in(&shared, &parcels, signing.as_ref());
    }
    // The last frames are still on their way.
    thread::sleep(Duration::from_millis(50));
    shared.over.store(true, Ordering::Relaxed);
    pilot.status.say(&pilot.companion.least_in_words());
    let missed = pilot.companion.missed_in_words();
    if !missed.is_empty() {
        pilot.status.say(&missed);
    }
    pilot.notebook.end();
    pilot.recorder.end();
    pilot.status.end();
    drop(parcels);
    let since = Instant::now();
    while threads.iter().any(|thread| !thread.is_finished()) && since.elapsed() < TICK * 50 {
        thread::sleep(TICK);
    }
    let failed = *locked(&shared.failed);
    if flown.is_err() || failed.is_some() {
        // In case printing the error never ends: nobody flies here any more.
        let end_program = options.end_program;
        thread::spawn(move || {
            thread::sleep(LAST_WORDS);
            end_program();
        });
    }
    match (flown, failed) {
        (Ok(()), None) => Ok(()),
        (Ok(()), Some(name)) => Err(io::Error::other(format!("the thread {name} has failed"))),
        (Err(_), _) => Err(io::Error::other("the deciding thread has failed")),
    }
}

/// Starts the threads around the deciding one.
fn start(
    options: &FlyOptions,
    shared: &Arc<FlightShared>,
    signing: Option<&Signing>,
    to: &SyncSender<InboxEvent>,
    (parcels, to_write): (&SyncSender<Parcel>, Receiver<Parcel>),
) -> io::Result<Vec<JoinHandle<()>>> {
    let (mut reader, writer) = open(&options.endpoint)?;
    reader.be_wary();
    let (link_to, link_signing) = (to.clone(), signing.cloned());
    let mut threads = vec![
        spawn(shared, "fga-read", move |shared| {
            link::read(shared, reader, link_signing.as_ref(), |frame, heard_s| {
                let _ = link_to.try_send(InboxEvent::Frame(Box::new(frame), heard_s));
            });
        })?,
        spawn(shared, "fga-write", move |shared| {
            link::write(shared, &writer, &to_write);
        })?,
    ];
    let (guard_to, guard_signing, end_program) =
        (parcels.clone(), signing.cloned(), options.end_program);
    threads.push(spawn(shared, "fga-guard", move |shared| {
        guard::watch(shared, &guard_to, guard_signing.as_ref(), end_program);
    })?);
    for endpoint in &options.traffic {
        let (to, endpoint) = (to.clone(), endpoint.clone());
        threads.push(spawn(shared, "fga-traffic", move |shared| {
            read_traffic(shared, &endpoint, &to);
        })?);
    }
    Ok(threads)
}

/// Reads a receiver until the flight is over. No data of a receiver can end the flight or the other
/// receivers.
fn read_traffic(shared: &FlightShared, endpoint: &ReceiverEndpoint, to: &SyncSender<InboxEvent>) {
    while !shared.is_over() {
        let reading = core::panic::AssertUnwindSafe(|| {
            receiver::read(
                endpoint,
                || shared.now_s(),
                &shared.over,
                |report| {
                    let _ = to.try_send(InboxEvent::Traffic(Box::new(report)));
                    true
                },
                |status| to.try_send(InboxEvent::Feed(Box::new(status))).is_ok(),
            );
        });
        if std::panic::catch_unwind(reading).is_err() {
            shared.trouble("fga: a traffic receiver failed, begun again".to_owned());
            thread::sleep(RECEIVER_PAUSE);
        }
    }
}

/// Makes ground until the flight is over. No heights can end the flight.
fn make_ground(shared: &FlightShared, orders: &Receiver<GroundOrder>, to: &SyncSender<MadeGround>) {
    while !shared.is_over() {
        let Ok(order) = orders.recv_timeout(TICK) else {
            continue;
        };
        let making = core::panic::AssertUnwindSafe(|| order.clone().make());
        let made = std::panic::catch_unwind(making).unwrap_or_else(|_| order.fail());
        // Nobody waits for it any more where the flight is over.
        let _ = to.send(made);
    }
}

/// The message with the content of a report at a time, seconds.
fn message_of(report: &PlaceReport, time_s: f64) -> MavMessage {
    let sample = PlayedState {
        time_s,
        place: report.place,
        velocity_mps: report.velocity_mps.unwrap_or_default(),
    };
    let mut data = adsb_data(report.icao, &report.callsign, &sample);
    if report.velocity_mps.is_none() {
        data.flags.remove(
            AdsbFlags::ADSB_FLAGS_VALID_HEADING
                | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY
                | AdsbFlags::ADSB_FLAGS_VERTICAL_VELOCITY_VALID,
        );
    }
    match report.quality.altitude {
        AltitudeReference::Unknown => {
            data.flags.remove(AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE);
        }
        AltitudeReference::Pressure => {
            data.altitude_type = AdsbAltitudeType::ADSB_ALTITUDE_TYPE_PRESSURE_QNH;
        }
        _ => {}
    }
    MavMessage::ADSB_VEHICLE(data)
}

/// The deciding thread.
struct DecidingThread<'a> {
    companion: &'a mut Companion,
    shared: &'a FlightShared,
    parcels: &'a SyncSender<Parcel>,
    signing: Option<&'a Signing>,
    recorder: Recorder,
    notebook: Notebook,
    status: StatusLine,
    sequences: Sequences,
    /// Commands of a mode that wait until the disk has the note.
    held: Vec<Outgoing>,
    /// Ground to make, and what was made; and whether some is being made.
    ground: (SyncSender<GroundOrder>, Receiver<MadeGround>),
    makes_ground: bool,
}

impl DecidingThread<'_> {
    fn run(&mut self, events: &Receiver<InboxEvent>, watch: &mut dyn FnMut(&Companion)) {
        let signals = || self.shared.stop.load(Ordering::Relaxed);
        while signals() == 0 && locked(&self.shared.failed).is_none() && self.turn(events) {
            watch(self.companion);
            let (companion, now_s) = (&*self.companion, self.shared.now_s());
            self.status
                .show(|| companion.status_line(now_s) + &companion.feeds_in_words());
        }
        let (now_s, mut since) = (self.shared.now_s(), Instant::now());
        self.end(locked(&self.shared.failed).is_some(), now_s);
        while self.turn(events) && self.companion.owed().is_some() && since.elapsed() < LAST_WORDS {
            watch(self.companion);
            if self.companion.flies() {
                since = Instant::now();
                let is_urgent = signals() > 1 || locked(&self.shared.failed).is_some();
                if is_urgent {
                    self.end(true, self.shared.now_s());
                }
            }
        }
    }

    /// The flight is to end; at once, or when nothing threatens.
    fn end(&mut self, at_once: bool, now_s: f64) {
        self.recorder
            .step(self.shared, now_s, &Step::End { at_once });
        if at_once {
            self.companion.shut_down_at_once(now_s);
        } else {
            self.companion.shut_down(now_s);
        }
    }

    /// Takes events, advances the time and sends; `false` when nothing can come any more.
    fn turn(&mut self, events: &Receiver<InboxEvent>) -> bool {
        match events.recv_timeout(TICK) {
            Ok(event) => {
                self.take(event);
                for event in events.try_iter().take(AT_ONCE) {
                    self.take(event);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        let now_s = self.shared.now_s();
        for words in self.shared.take_troubles() {
            self.companion.tell_trouble(&words, now_s);
        }
        match self.shared.version1.load(Ordering::Relaxed) {
            0 => {}
            system_id => self.companion.hear_version1(system_id, now_s),
        }
        if let Ok(made) = self.ground.1.try_recv() {
            self.makes_ground = false;
            self.recorder.step(self.shared, now_s, &Step::Ground);
            self.companion.take_ground(made, now_s);
        }
        self.recorder.step(self.shared, now_s, &Step::Tick);
        self.companion.tick(now_s);
        if !self.makes_ground
            && let Some(order) = self.companion.ground_order()
        {
            self.makes_ground = self.ground.0.try_send(order).is_ok();
        }
        *locked(&self.shared.owed) = self.companion.owed();
        let (note, system_id) = (
            self.companion.restart_note(now_s),
            self.companion.vehicle_system(),
        );
        self.notebook.set(note, system_id);
        self.send(now_s);
        self.shared.ticks.fetch_add(1, Ordering::Relaxed);
        true
    }

    fn take(&mut self, event: InboxEvent) {
        let now_s = self.shared.now_s();
        match event {
            InboxEvent::Frame(frame, heard_s) => {
                if now_s - heard_s <= HISTORY_S {
                    self.recorder.frame(self.shared, now_s, frame.bytes());
                    self.companion.receive(&frame.header, &frame.message, now_s);
                }
            }
            InboxEvent::Traffic(report) => {
                self.record_report(&report, now_s);
                self.companion.take_report(&report, now_s);
            }
            InboxEvent::Feed(status) => {
                self.recorder.step(self.shared, now_s, &Step::Feed(*status));
                self.companion.take_feed(*status, now_s);
            }
        }
    }

    /// Adds a receiver's report to the telemetry log, so that the recording holds the whole input of the decisions; and the message with
    /// the same content, for other readers.
    fn record_report(&mut self, report: &PlaceReport, now_s: f64) {
        let step = Step::Report(report.clone());
        self.recorder.step(self.shared, now_s, &step);
        let message = message_of(report, now_s);
        let header = MavHeader {
            system_id: u32::from(RECEIVER_SYSTEM),
            component_id: RECEIVER_COMPONENT,
            sequence: self.sequences.next(RECEIVER_SYSTEM),
        };
        let raw = encode(header, &message, None);
        self.recorder.frame(self.shared, now_s, raw.raw_bytes());
    }

    fn send(&mut self, now_s: f64) {
        let mut waiting = core::mem::take(&mut self.held);
        waiting.extend(self.companion.outbox());
        let noted = self.notebook.is_kept();
        for outgoing in waiting {
            if outgoing.change.is_some() && !noted {
                self.held.push(outgoing);
                continue;
            }
            if let MavMessage::STATUSTEXT(data) = &outgoing.message {
                self.status.say(data.text.to_str().unwrap_or_default());
            }
            let header = MavHeader {
                system_id: u32::from(outgoing.system_id),
                component_id: OWN_COMPONENT,
                sequence: self.sequences.next(outgoing.system_id),
            };
            let raw = encode(header, &outgoing.message, self.signing);
            self.recorder.frame(self.shared, now_s, raw.raw_bytes());
            let change = outgoing.change;
            post(self.parcels, Parcel { raw, change });
        }
        for line in self.companion.take_log() {
            self.recorder.line(self.shared, line.to_string());
        }
    }
}

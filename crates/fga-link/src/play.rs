//! Plays a script of traffic in real time: to a MAVLink endpoint, to readers of BaseStation lines, or
//! both.

use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::io::{self, Write as _};
use std::net::{TcpListener, TcpStream};
use std::time::Instant;

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{MavMessage, MavType};

use crate::endpoint::{Endpoint, LinkWriter, open};
use crate::outgoing::{RECEIVER_COMPONENT, RECEIVER_SYSTEM};
use crate::player::{LineTranslator, LoggedLine, Played, sbs_lines};
use crate::telling::heartbeat;
use crate::wire::encode;

/// Most readers of lines.
const MOST_READERS: usize = 16;
const STEP: Duration = Duration::from_millis(20);

/// The script.
#[derive(Debug, Clone)]
pub enum Script {
    /// Aircraft on paths.
    Aircraft(Vec<Played>),
    /// A BaseStation log.
    Log(Vec<LoggedLine>),
}

impl Script {
    /// Whether there is nothing to play.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Aircraft(aircraft) => aircraft.is_empty(),
            Self::Log(lines) => lines.is_empty(),
        }
    }
}

/// The settings of the playing.
#[derive(Debug, Clone)]
pub struct PlayOptions {
    /// Endpoint for `ADSB_VEHICLE`.
    pub to: Option<Endpoint>,
    /// Address on which BaseStation lines are served.
    pub serve_sbs: Option<String>,
    /// Times faster than recorded.
    pub speed: f64,
    /// Reports of each aircraft a second.
    pub rate_hz: f64,
    /// Begins again at the end.
    pub again: bool,
}

/// What was sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlaySent {
    /// Messages to the endpoint, heartbeats among them.
    pub messages: u64,
    /// BaseStation lines, to all readers together.
    pub lines: u64,
    /// Readers that connected.
    pub readers: u64,
}

struct Outputs {
    writer: Option<LinkWriter>,
    sequence: u8,
    listener: Option<TcpListener>,
    readers: Vec<TcpStream>,
    sent: PlaySent,
}

impl Outputs {
    fn message(&mut self, message: &MavMessage) {
        let Some(writer) = &self.writer else { return };
        let header = MavHeader {
            system_id: u32::from(RECEIVER_SYSTEM),
            component_id: RECEIVER_COMPONENT,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.sent.messages += 1;
        writer.write(encode(header, message, None).raw_bytes());
    }

    fn lines(&mut self, text: &str) {
        let lines = text.lines().count() as u64;
        self.readers.retain_mut(|reader| {
            let is_sent = reader.write_all(text.as_bytes()).is_ok();
            self.sent.lines += if is_sent { lines } else { 0 };
            is_sent
        });
    }

    fn accept(&mut self) {
        let Some(listener) = &self.listener else {
            return;
        };
        while let Ok((stream, _)) = listener.accept() {
            let ready = stream.set_nodelay(true).is_ok()
                && stream.set_nonblocking(false).is_ok()
                && stream
                    .set_write_timeout(Some(Duration::from_millis(200)))
                    .is_ok();
            if ready && self.readers.len() < MOST_READERS {
                self.readers.push(stream);
                self.sent.readers += 1;
            }
        }
    }

    /// Takes new readers, and sends the heartbeat when it is due, at a time since the start in seconds.
    fn turn(&mut self, real_s: f64, beat_s: &mut f64) {
        self.accept();
        if real_s >= *beat_s {
            *beat_s = real_s + 1.0;
            self.message(&heartbeat(MavType::MAV_TYPE_ADSB));
        }
    }
}

/// Plays until the script ends or `stop` is set; returns what was sent.
///
/// # Errors
/// An endpoint or an address that cannot be opened.
pub fn play(script: &Script, options: &PlayOptions, stop: &AtomicBool) -> io::Result<PlaySent> {
    // The reading half only connects.
    let (mut reader, writer) = options.to.as_ref().map(open).transpose()?.unzip();
    let listener = match &options.serve_sbs {
        Some(address) => {
            let listener = TcpListener::bind(address)?;
            listener.set_nonblocking(true)?;
            Some(listener)
        }
        None => None,
    };
    let mut outputs = Outputs {
        writer,
        sequence: 0,
        listener,
        readers: Vec::new(),
        sent: PlaySent::default(),
    };
    let ended = &AtomicBool::new(false);
    std::thread::scope(|scope| {
        if let Some(reader) = &mut reader {
            scope.spawn(move || {
                let mut buffer = [0; 2048];
                while !ended.load(Ordering::Relaxed) {
                    reader.read(&mut buffer);
                }
            });
        }
        loop {
            let finished = match script {
                Script::Aircraft(aircraft) => play_aircraft(aircraft, options, &mut outputs, stop),
                Script::Log(lines) => play_log(lines, options, &mut outputs, stop),
            };
            if !finished || !options.again {
                break;
            }
        }
        ended.store(true, Ordering::Relaxed);
    });
    Ok(outputs.sent)
}

fn play_aircraft(
    aircraft: &[Played],
    options: &PlayOptions,
    outputs: &mut Outputs,
    stop: &AtomicBool,
) -> bool {
    let start = Instant::now();
    let end_s = aircraft.iter().map(Played::end_s).fold(0.0, f64::max);
    let (mut next_s, mut beat_s) = (0.0, 0.0);
    loop {
        if stop.load(Ordering::Relaxed) {
            return false;
        }
        let real_s = start.elapsed().as_secs_f64();
        outputs.turn(real_s, &mut beat_s);
        let time_s = real_s * options.speed;
        if time_s > end_s {
            return true;
        }
        if real_s >= next_s {
            next_s = real_s + 1.0 / options.rate_hz;
            for played in aircraft {
                if let Some(message) = played.message_at(time_s) {
                    outputs.message(&message);
                }
                if let Some(sample) = played.at(time_s)
                    && !outputs.readers.is_empty()
                {
                    outputs.lines(&sbs_lines(played.icao, &played.callsign, &sample));
                }
            }
        }
        std::thread::sleep(STEP);
    }
}

fn play_log(
    lines: &[LoggedLine],
    options: &PlayOptions,
    outputs: &mut Outputs,
    stop: &AtomicBool,
) -> bool {
    let start = Instant::now();
    let mut translator = LineTranslator::default();
    let mut beat_s = 0.0;
    let begin_s = lines.first().map_or(0.0, |line| line.time_s);
    for line in lines {
        loop {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            let real_s = start.elapsed().as_secs_f64();
            outputs.turn(real_s, &mut beat_s);
            let wait_s = (line.time_s - begin_s) / options.speed - real_s;
            if wait_s <= 0.0 {
                break;
            }
            std::thread::sleep(STEP.min(Duration::from_secs_f64(wait_s)));
        }
        if !outputs.readers.is_empty() {
            outputs.lines(&format!("{}\r\n", line.line));
        }
        if outputs.writer.is_some()
            && let Some(message) = translator.message(line)
        {
            outputs.message(&message);
        }
    }
    true
}

//! The two logs of a flight, written by a separate thread.
//!
//! The flight never waits for a disk: entries that the thread cannot take in time are dropped, and when it
//! cannot write, the log stops. The companion reports each once.

use alloc::sync::Arc;
use core::time::Duration;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::shared::{FlightShared, await_end, spawn};
use mavlink::MavHeader;

use crate::number::to_u64;
use crate::outgoing::OWN_COMPONENT;
use crate::steps::Step;
use crate::tlog::TlogWriter;
use crate::wire::encode;

/// Most entries in the queue: more than ten seconds of a busy link.
const WAITING: usize = 4096;
/// Interval for handing the files to the system.
const FLUSH: Duration = Duration::from_secs(1);
/// Longest wait for the disk at the end of a flight.
const LAST_WORDS: Duration = Duration::from_secs(2);

/// An entry of the log.
#[derive(Debug)]
enum LogEntry {
    Frame(u64, Box<[u8]>),
    Line(String),
}

/// A short text for an error of the disk.
pub(super) fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull => "disk full".to_owned(),
        io::ErrorKind::FileTooLarge => "file too large".to_owned(),
        io::ErrorKind::QuotaExceeded => "quota exceeded".to_owned(),
        io::ErrorKind::NotFound => "no such folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "disk is read-only".to_owned(),
        kind => kind.to_string(),
    }
}

/// The flight's side of its logs.
pub(super) struct Recorder {
    to: SyncSender<LogEntry>,
    thread: JoinHandle<()>,
    begin_us: u64,
    behind: bool,
}

impl Recorder {
    /// Begins the logs in a folder.
    pub(super) fn begin(shared: &Arc<FlightShared>, folder: &Path) -> io::Result<Self> {
        let begin = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        let begin_us = u64::try_from(begin.as_micros())
            .unwrap_or(0)
            .saturating_sub(to_u64(shared.now_s() * 1e6));
        let (to, entries) = sync_channel(WAITING);
        let folder = folder.to_owned();
        let name = format!("fly-{}", begin.as_secs());
        let thread = spawn(shared, "fga-log", move |shared| {
            record(shared, &folder, &name, &entries);
        })?;
        Ok(Self {
            to,
            thread,
            begin_us,
            behind: false,
        })
    }

    /// Logs a frame, received or sent at a time of the flight, seconds.
    pub(super) fn frame(&mut self, shared: &FlightShared, at_s: f64, bytes: &[u8]) {
        let unix_us = self.begin_us + to_u64((at_s * 1e6).round());
        self.put(shared, LogEntry::Frame(unix_us, bytes.into()));
    }

    /// Logs a step of the flight, at a time of the flight, seconds.
    pub(super) fn step(&mut self, shared: &FlightShared, at_s: f64, step: &Step) {
        let header = MavHeader {
            system_id: 0,
            component_id: OWN_COMPONENT,
            sequence: 0,
        };
        if let Some(message) = step.message() {
            let raw = encode(header, &message, None);
            self.frame(shared, at_s, raw.raw_bytes());
        }
    }

    /// Logs a line about a decision.
    pub(super) fn line(&mut self, shared: &FlightShared, line: String) {
        self.put(shared, LogEntry::Line(line));
    }

    fn put(&mut self, shared: &FlightShared, entry: LogEntry) {
        match self.to.try_send(entry) {
            Ok(()) => self.behind = false,
            Err(TrySendError::Full(_)) if !self.behind => {
                self.behind = true;
                shared.trouble("fga: log has gaps: disk too slow".to_owned());
            }
            Err(_) => {}
        }
    }

    /// Waits a moment until everything is written.
    pub(super) fn end(self) {
        let Self { to, thread, .. } = self;
        drop(to);
        await_end(&thread, LAST_WORDS);
    }
}

/// The files of a flight.
struct LogFiles {
    tlog: TlogWriter<BufWriter<File>>,
    decisions: BufWriter<File>,
    paths: [PathBuf; 2],
}

impl LogFiles {
    fn create(folder: &Path, name: &str) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let paths = ["tlog", "jsonl"].map(|ending| folder.join(format!("{name}.{ending}")));
        let [tlog, decisions] = paths.each_ref().map(File::create);
        Ok(Self {
            tlog: TlogWriter::new(BufWriter::new(tlog?)),
            decisions: BufWriter::new(decisions?),
            paths,
        })
    }

    fn write(&mut self, entry: &LogEntry) -> io::Result<()> {
        match entry {
            LogEntry::Frame(unix_us, bytes) => self.tlog.write(*unix_us, bytes),
            LogEntry::Line(line) => writeln!(self.decisions, "{line}"),
        }
    }

    /// Hands waiting data to the system; an error if somebody has removed the files.
    fn flush(&mut self) -> io::Result<()> {
        self.tlog.flush()?;
        self.decisions.flush()?;
        for path in &self.paths {
            fs::metadata(path)?;
        }
        Ok(())
    }
}

fn record(shared: &FlightShared, folder: &Path, name: &str, entries: &Receiver<LogEntry>) {
    let stopped = |error: &io::Error| {
        shared.trouble(format!("fga: log stopped: {}", reason(error)));
        None
    };
    let mut files = LogFiles::create(folder, name).map_or_else(|error| stopped(&error), Some);
    let mut flushed = Instant::now();
    loop {
        let ended = match entries.recv_timeout(FLUSH) {
            Ok(entry) => {
                if let Some(open) = &mut files
                    && let Err(error) = open.write(&entry)
                {
                    files = stopped(&error);
                }
                false
            }
            Err(RecvTimeoutError::Timeout) => false,
            Err(RecvTimeoutError::Disconnected) => true,
        };
        if ended || flushed.elapsed() >= FLUSH {
            flushed = Instant::now();
            if let Some(open) = &mut files
                && let Err(error) = open.flush()
            {
                files = stopped(&error);
            }
        }
        if ended {
            break;
        }
    }
}

//! Notes for a later run of the program, kept on the disk by a separate thread: the owed mode, and the
//! timestamps of signed frames.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Instant, SystemTime};

use super::recorder::reason;
use super::shared::{FlightShared, await_end, spawn};
use crate::restart::Note;
use crate::wire::{Signing, Timestamps};

/// Interval for saving the timestamps of signed frames.
const KEEP_TIMESTAMPS: Duration = Duration::from_millis(500);
/// Longest wait of a take-over for its note; then it goes on without one.
const LONGEST_WAIT: Duration = Duration::from_millis(250);
/// Longest wait for the disk at the end of a flight.
const LAST_WORDS: Duration = Duration::from_secs(1);
const TIMESTAMPS: &str = "signing.json";

fn note_path(folder: &Path, system_id: u8) -> PathBuf {
    folder.join(format!("owed-{system_id}.json"))
}

/// Writes a file completely: under another name, then renamed.
fn write_whole(path: &Path, content: &str) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let begun = path.with_extension("json.part");
    let mut file = File::create(&begun)?;
    file.write_all(content.as_bytes())?;
    fs::rename(&begun, path)
}

/// Waits until a file would survive a loss of power.
fn settle(path: &Path) -> io::Result<()> {
    File::open(path)?.sync_data()
}

/// The text of a regular file: a pipe under its name would never end.
fn read_regular(path: &Path) -> Option<String> {
    path.is_file().then(|| fs::read_to_string(path).ok())?
}

/// Seconds since 1970 by this computer's clock.
fn unix_s() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

/// The notes of an earlier run in a folder, and what the operator should know of the others. Notes that have expired are
/// removed.
pub(super) fn read_notes(folder: &Path) -> (Vec<Note>, Vec<String>) {
    let (mut notes, mut troubles) = (Vec::new(), Vec::new());
    for system_id in 1..=u8::MAX {
        let path = note_path(folder, system_id);
        let Some(text) = read_regular(&path) else {
            continue;
        };
        match serde_json::from_str::<Note>(&text).map(|note| note.read_at(unix_s())) {
            Ok(note) if note.system_id == system_id && !note.has_expired() => notes.push(note),
            Ok(_) => {
                // Where it cannot be removed, the next run reports it again.
                let _ = fs::remove_file(&path);
                troubles.push(format!("fga: old note of vehicle {system_id} removed"));
            }
            Err(_) => troubles.push(format!("fga: owed-{system_id}.json is no note")),
        }
    }
    (notes, troubles)
}

/// The note with the time at which it was first written.
fn dated(note: Note) -> Note {
    Note {
        written_unix_s: match note.written_unix_s {
            0 => unix_s(),
            written_s => written_s,
        },
        ..note
    }
}

/// The timestamps of an earlier run in a folder.
pub(super) fn read_timestamps(folder: &Path) -> Option<Timestamps> {
    let text = read_regular(&folder.join(TIMESTAMPS))?;
    serde_json::from_str(&text).ok()
}

/// What the disk must hold of a vehicle: a note, or none.
struct Wish {
    number: u64,
    system_id: u8,
    note: Option<Note>,
}

/// The flight's side of the notebook.
pub(super) struct Notebook {
    to: SyncSender<Wish>,
    thread: JoinHandle<()>,
    kept: Arc<AtomicU64>,
    /// The notes of an earlier run that are still on the disk.
    left: Vec<Note>,
    system_id: u8,
    wanted: Option<Note>,
    number: u64,
    /// A change that the thread had no room for yet.
    unsent: bool,
    changed: Instant,
}

impl Notebook {
    /// Starts with the notes of an earlier run.
    pub(super) fn begin(
        shared: &Arc<FlightShared>,
        folder: &Path,
        signing: Option<Signing>,
        left: Vec<Note>,
    ) -> io::Result<Self> {
        let (to, wishes) = sync_channel(16);
        let kept = Arc::new(AtomicU64::new(0));
        let (folder, done) = (folder.to_owned(), Arc::clone(&kept));
        let thread = spawn(shared, "fga-notes", move |shared| {
            keep(shared, &folder, signing.as_ref(), &wishes, &done);
        })?;
        Ok(Self {
            to,
            thread,
            kept,
            left,
            system_id: 0,
            wanted: None,
            number: 0,
            unsent: false,
            changed: Instant::now(),
        })
    }

    /// Sets the note that the disk must hold from now on of a vehicle, once that is heard.
    pub(super) fn set(&mut self, note: Option<Note>, system_id: Option<u8>) {
        self.system_id = system_id.unwrap_or(self.system_id);
        let is_of = |left: &Note| left.system_id == self.system_id;
        if let Some(place) = self.left.iter().position(is_of) {
            self.wanted = Some(self.left.swap_remove(place));
        }
        if note != self.wanted {
            self.wanted = note;
            self.number += 1;
            self.changed = Instant::now();
            self.unsent = true;
        }
        let wish = Wish {
            number: self.number,
            system_id: self.system_id,
            note: self.wanted,
        };
        if self.unsent && self.to.try_send(wish).is_ok() {
            self.unsent = false;
        }
    }

    /// Whether the disk has the note, or the wait was long enough.
    pub(super) fn is_kept(&self) -> bool {
        self.kept.load(Ordering::Acquire) >= self.number || self.changed.elapsed() >= LONGEST_WAIT
    }

    /// Waits a moment until everything is written.
    pub(super) fn end(self) {
        let Self { to, thread, .. } = self;
        drop(to);
        await_end(&thread, LAST_WORDS);
    }
}

fn keep(
    shared: &FlightShared,
    folder: &Path,
    signing: Option<&Signing>,
    wishes: &Receiver<Wish>,
    done: &AtomicU64,
) {
    let mut told = false;
    let mut tell = |what: &str, error: &io::Error| {
        if !told {
            told = true;
            shared.trouble(format!("fga: {what} not kept: {}", reason(error)));
        }
    };
    loop {
        let wish = wishes.recv_timeout(KEEP_TIMESTAMPS);
        if let Ok(wish) = &wish {
            let path = note_path(folder, wish.system_id);
            let result = match wish.note {
                Some(note) => serde_json::to_string(&dated(note))
                    .map_err(io::Error::other)
                    .and_then(|text| write_whole(&path, &text)),
                None => fs::remove_file(&path),
            };
            done.store(wish.number, Ordering::Release);
            // From here on the note covers a sudden end of the program; the disk may take its time.
            let result = match wish.note {
                Some(_) => result.and_then(|()| settle(&path)),
                None => result,
            };
            if let Err(error) = result
                && error.kind() != io::ErrorKind::NotFound
            {
                tell("note of the mode", &error);
            }
        }
        if let Some(signing) = signing {
            let result = serde_json::to_string(&signing.timestamps())
                .map_err(io::Error::other)
                .and_then(|text| write_whole(&folder.join(TIMESTAMPS), &text));
            if let Err(error) = result {
                tell("signing timestamps", &error);
            }
        }
        if matches!(wish, Err(RecvTimeoutError::Disconnected)) {
            break;
        }
    }
}

//! The shared knowledge of the threads of a flight.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering};
use core::time::Duration;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::MavMessage;

use crate::authority::{Beat, Hearing, Owed};
use crate::companion::round_trip_of;
use crate::mode::ModeChange;
use crate::outgoing::AUTOPILOT;

/// Most troubles in the queue.
const MOST_TROUBLES: usize = 8;

/// Locks a mutex, also after a panic elsewhere: the data are single values.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The vehicle as the reading thread hears it.
#[derive(Debug, Default)]
struct HeardPlane {
    /// System id; 0 before the first heartbeat.
    system_id: u8,
    hearing: Hearing,
}

/// Shared by all threads.
#[derive(Debug)]
pub(super) struct FlightShared {
    start: Instant,
    /// Number of signals to end the flight.
    pub(super) stop: Arc<AtomicU32>,
    /// Set to end all threads, after the flight.
    pub(super) over: AtomicBool,
    /// System id of a sender of MAVLink 1; 0 without one.
    pub(super) version1: AtomicU8,
    /// Steps of the deciding thread.
    pub(super) ticks: AtomicU64,
    /// The mode that the deciding thread would leave owed.
    pub(super) owed: Mutex<Option<Owed>>,
    /// A needed thread has ended by a panic.
    pub(super) failed: Mutex<Option<&'static str>>,
    vehicle: Mutex<HeardPlane>,
    troubles: Mutex<Vec<String>>,
}

impl FlightShared {
    /// Nothing heard yet; `system_id` is the vehicle's if configured, else 0.
    pub(super) fn new(stop: Arc<AtomicU32>, system_id: u8) -> Self {
        Self {
            start: Instant::now(),
            stop,
            over: AtomicBool::new(false),
            version1: AtomicU8::new(0),
            ticks: AtomicU64::new(0),
            owed: Mutex::new(None),
            failed: Mutex::new(None),
            vehicle: Mutex::new(HeardPlane {
                system_id,
                hearing: Hearing::default(),
            }),
            troubles: Mutex::new(Vec::new()),
        }
    }

    /// Time since the start of the flight, seconds, in whole microseconds: as the log has it.
    pub(super) fn now_s(&self) -> f64 {
        #[expect(
            clippy::cast_precision_loss,
            reason = "microseconds of a flight are exact for 285 years"
        )]
        let micros = self.start.elapsed().as_micros() as f64;
        micros * 1e-6
    }

    pub(super) fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }

    /// Takes a valid frame; returns whether it is from the vehicle.
    pub(super) fn hear(&self, header: MavHeader, message: &MavMessage, now_s: f64) -> bool {
        let Ok(system_id) = u8::try_from(header.system_id) else {
            return false;
        };
        let mut vehicle = locked(&self.vehicle);
        if let MavMessage::HEARTBEAT(data) = message
            && let Some(beat) = Beat::of_plane(header, data)
        {
            if vehicle.system_id == 0 {
                vehicle.system_id = system_id;
            }
            if vehicle.system_id == system_id {
                vehicle.hearing.hear(beat, now_s);
            }
        }
        if vehicle.system_id != system_id || system_id == 0 {
            return false;
        }
        if let MavMessage::ATTITUDE(data) = message
            && header.component_id == AUTOPILOT
        {
            vehicle.hearing.stamp(data.time_boot_ms, now_s);
        }
        if let MavMessage::TIMESYNC(data) = message
            && header.component_id == AUTOPILOT
            && let Some((sent_s, boot_s)) = round_trip_of(data, now_s)
        {
            vehicle.hearing.round_trip(sent_s, boot_s, now_s);
        }
        true
    }

    /// Messages from before a pause of this program are history.
    pub(super) fn forget_heard(&self) {
        locked(&self.vehicle).hearing.forget();
    }

    /// Whether the program may now send a command of another mode; if so, it counts as sent.
    pub(super) fn asks(&self, change: ModeChange) -> bool {
        let now_s = self.now_s();
        locked(&self.vehicle).hearing.ask(change, now_s)
    }

    /// The vehicle's reported mode, for the watchdog.
    pub(super) fn hearing(&self) -> Hearing {
        locked(&self.vehicle).hearing.clone()
    }

    /// Records a trouble of this program for the operator.
    pub(super) fn trouble(&self, words: String) {
        let mut troubles = locked(&self.troubles);
        if troubles.len() < MOST_TROUBLES {
            troubles.push(words);
        }
    }

    /// The troubles since the last call.
    pub(super) fn take_troubles(&self) -> Vec<String> {
        core::mem::take(&mut *locked(&self.troubles))
    }
}

/// Waits until a thread has ended, for a while at most.
pub(super) fn await_end(thread: &JoinHandle<()>, most: Duration) {
    let since = Instant::now();
    while !thread.is_finished() && since.elapsed() < most {
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Starts a thread; a panic of a needed one ends the flight and restores the mode.
pub(super) fn spawn(
    shared: &Arc<FlightShared>,
    name: &'static str,
    run: impl FnOnce(&FlightShared) + Send + 'static,
) -> std::io::Result<JoinHandle<()>> {
    let shared = Arc::clone(shared);
    std::thread::Builder::new()
        .name(name.to_owned())
        .spawn(move || {
            let run = core::panic::AssertUnwindSafe(|| run(&shared));
            if std::panic::catch_unwind(run).is_err() {
                *locked(&shared.failed) = Some(name);
            }
        })
}

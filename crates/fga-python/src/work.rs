//! Long work without the interpreter's lock: Ctrl-C ends it, a function shows its progress.

use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use core::time::Duration;
use std::panic::resume_unwind;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Pause between two checks of Ctrl-C.
const PAUSE: Duration = Duration::from_millis(50);

/// More than any machine has cores; a machine that runs out of threads may end the interpreter.
const MOST_THREADS: usize = 1024;

/// The shared state of work and interpreter.
#[derive(Debug, Default)]
pub(crate) struct SharedWork {
    stop: AtomicBool,
    /// Finished part.
    pub(crate) done: AtomicU64,
    /// Total.
    pub(crate) total: AtomicU64,
}

impl SharedWork {
    /// Whether the work should continue.
    pub(crate) fn goes_on(&self) -> bool {
        !self.stop.load(Ordering::Relaxed)
    }
}

fn checked(threads: Option<usize>) -> PyResult<usize> {
    match threads {
        Some(threads) if !(1..=MOST_THREADS).contains(&threads) => Err(PyValueError::new_err(
            format!("threads is {threads}, expected 1 to {MOST_THREADS}"),
        )),
        threads => Ok(threads.unwrap_or(0)),
    }
}

/// Runs work on threads of its own, which end before this returns: a fork finds no lock of a thread that
/// does not exist. This thread calls `progress(done, total)` some times a second; its exceptions, and
/// Ctrl-C, end the work and are raised.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&SharedWork) -> T + Send,
) -> PyResult<T> {
    let threads = checked(threads)?;
    let shared = SharedWork::default();
    let show = || -> PyResult<()> {
        let Some(progress) = progress else {
            return Ok(());
        };
        let total = shared.total.load(Ordering::Relaxed);
        if total > 0 {
            progress.call1((shared.done.load(Ordering::Relaxed), total))?;
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let install = |pool: &ThreadPool| pool.install(|| work(&shared));
            ThreadPoolBuilder::new()
                .num_threads(threads)
                .build_scoped(rayon::ThreadBuilder::run, install)
        });
        let mut failed = None;
        while !worker.is_finished() {
            py.detach(|| std::thread::park_timeout(PAUSE));
            if failed.is_none() {
                failed = py.check_signals().and_then(|()| show()).err();
                if failed.is_some() {
                    shared.stop.store(true, Ordering::Relaxed);
                }
            }
        }
        let result = worker
            .join()
            .unwrap_or_else(|panic| resume_unwind(panic))
            .map_err(|error| {
                PyValueError::new_err(format!("threads cannot be started: {error}"))
            })?;
        match failed {
            Some(error) => Err(error),
            None => show().map(|()| result),
        }
    })
}

//! The processor time of the thread.

use rustix::time::{ClockId, clock_gettime};

/// Processor time of this thread, microseconds.
pub(crate) fn thread_us() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

/// Time of reading the clock, microseconds.
pub(crate) fn reading_us() -> f64 {
    (0..1000)
        .map(|_| {
            let begun = thread_us();
            thread_us() - begun
        })
        .fold(f64::INFINITY, f64::min)
}

/// The quickest of `runs`, without the time of reading the clock, microseconds; `prepare` is not measured.
pub(crate) fn quickest_us<T, R>(
    runs: usize,
    clock_us: f64,
    mut prepare: impl FnMut() -> T,
    mut step: impl FnMut(&mut T) -> R,
) -> f64 {
    (0..runs)
        .map(|_| {
            let mut prepared = prepare();
            let begun = thread_us();
            core::hint::black_box(step(&mut prepared));
            thread_us() - begun - clock_us
        })
        .fold(f64::INFINITY, f64::min)
        .max(0.0)
}

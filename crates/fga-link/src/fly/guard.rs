//! The thread that watches the one that decides, and what is done when that one has ended.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::sync::mpsc::SyncSender;
use std::thread;

use super::link::{Parcel, post};
use super::shared::{Shared, locked};
use crate::authority::{LOOK_EVERY_S, Order, Watchdog};
use crate::wire::Signing;

/// Looks until the flight is over. `end_program` is called when the deciding thread stands still and
/// all was tried.
pub(super) fn watch(
    shared: &Shared,
    to: &SyncSender<Parcel>,
    signing: Option<&Signing>,
    end_program: impl Fn(),
) {
    let mut watchdog = Watchdog::default();
    while !shared.is_over() {
        thread::sleep(Duration::from_secs_f64(LOOK_EVERY_S));
        if !look(shared, &mut watchdog, to, signing) {
            end_program();
            return;
        }
    }
}

/// Restores the mode for a deciding thread that has ended.
pub(super) fn stand_in(shared: &Shared, to: &SyncSender<Parcel>, signing: Option<&Signing>) {
    let mut watchdog = Watchdog::of_ended(shared.ticks.load(Ordering::Relaxed));
    while look(shared, &mut watchdog, to, signing) {
        thread::sleep(Duration::from_secs_f64(LOOK_EVERY_S));
    }
}

/// One look; `false` when nothing is left to be done.
fn look(
    shared: &Shared,
    watchdog: &mut Watchdog,
    to: &SyncSender<Parcel>,
    signing: Option<&Signing>,
) -> bool {
    let ticks = shared.ticks.load(Ordering::Relaxed);
    let owed = *locked(&shared.owed);
    match watchdog.look(ticks, owed, &shared.hearing(), shared.now_s()) {
        Order::Wait => true,
        Order::Restore(owed) => {
            post(to, Parcel::restoring(owed, signing));
            true
        }
        Order::EndProgram => false,
    }
}

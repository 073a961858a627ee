//! The thread that watches the deciding one, and the reaction when that one has ended.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::sync::mpsc::SyncSender;
use std::thread;

use super::link::{Parcel, post};
use super::shared::{Shared, locked};
use crate::authority::{LOOK_EVERY_S, Order, Watchdog};
use crate::wire::Signing;

/// Looks until the flight is over. Calls `end_program` when the deciding thread stands still and
/// all attempts are over.
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

/// Restores the mode after the deciding thread has ended.
pub(super) fn stand_in(shared: &Shared, to: &SyncSender<Parcel>, signing: Option<&Signing>) {
    let mut watchdog = Watchdog::of_ended(shared.ticks.load(Ordering::Relaxed));
    while look(shared, &mut watchdog, to, signing) {
        thread::sleep(Duration::from_secs_f64(LOOK_EVERY_S));
    }
}

/// One look; `false` when nothing is left to do.
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

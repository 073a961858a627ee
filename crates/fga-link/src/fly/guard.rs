//! The thread that watches the deciding one, and the reaction when that one has ended.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::sync::mpsc::SyncSender;
use std::thread;

use super::link::{Parcel, post};
use super::shared::{FlightShared, locked};
use crate::authority::{LOOK_EVERY_S, Order, Watchdog};
use crate::wire::Signing;

/// Looks until the flight is over. Calls `end_program` when the deciding thread stands still and
/// all attempts are over.
pub(super) fn watch(
    shared: &FlightShared,
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
pub(super) fn stand_in(shared: &FlightShared, to: &SyncSender<Parcel>, signing: Option<&Signing>) {
    let mut watchdog = Watchdog::of_ended(shared.ticks.load(Ordering::Relaxed));
    while look(shared, &mut watchdog, to, signing) {
        thread::sleep(Duration::from_secs_f64(LOOK_EVERY_S));
    }
}

/// One look; `false` when nothing is left to do.
fn look(
    shared: &FlightShared,
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

#[cfg(test)]
mod tests {
    use alloc::sync::Arc;
    use core::sync::atomic::{AtomicBool, AtomicU32};
    use std::sync::mpsc::{Receiver, sync_channel};

    use mavlink::MavHeader;
    use mavlink::dialects::ardupilotmega::{
        HEARTBEAT_DATA, MavAutopilot, MavMessage, MavModeFlag, MavType,
    };

    use super::*;
    use crate::authority::Owed;
    use crate::mode::Mode;
    use crate::outgoing::AUTOPILOT;

    const OWED: Owed = Owed {
        system_id: 1,
        owned: Mode::GUIDED,
        previous: Mode::AUTO,
    };

    /// A flight in which the mode is owed or not.
    fn flight(owed: Option<Owed>) -> Arc<FlightShared> {
        let shared = FlightShared::new(Arc::new(AtomicU32::new(0)), 1);
        *locked(&shared.owed) = owed;
        Arc::new(shared)
    }

    /// The vehicle reports its mode four times a second until the flight is over.
    fn tell(shared: &Arc<FlightShared>, mode: &Arc<AtomicU32>) {
        let (shared, mode) = (Arc::clone(shared), Arc::clone(mode));
        thread::spawn(move || {
            let mut sequence = 0_u8;
            while !shared.is_over() {
                sequence = sequence.wrapping_add(9);
                let header = MavHeader {
                    system_id: 1,
                    component_id: AUTOPILOT,
                    sequence,
                };
                let beat = MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                    custom_mode: mode.load(Ordering::Relaxed),
                    mavtype: MavType::MAV_TYPE_FIXED_WING,
                    autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
                    base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
                    ..HEARTBEAT_DATA::DEFAULT
                });
                shared.hear(header, &beat, shared.now_s());
                thread::sleep(Duration::from_millis(250));
            }
        });
    }

    /// Watches until the flight is over or the program is ended; whether it was ended, and the commands.
    fn watched(shared: &FlightShared) -> (bool, Receiver<Parcel>) {
        let (to, parcels) = sync_channel(64);
        let ended = AtomicBool::new(false);
        watch(shared, &to, None, || ended.store(true, Ordering::Relaxed));
        (ended.into_inner(), parcels)
    }

    #[test]
    fn a_thread_that_stands_still_and_owes_nothing_ends_the_program() {
        let shared = flight(None);
        let late = Arc::clone(&shared);
        thread::spawn(move || {
            // Otherwise a watchdog that waits for ever would never end this test.
            thread::sleep(Duration::from_mins(1));
            late.over.store(true, Ordering::Relaxed);
        });
        let (ended, parcels) = watched(&shared);
        assert!(ended);
        assert!(parcels.try_recv().is_err(), "nothing was owed");
    }

    #[test]
    fn a_thread_that_works_is_left_alone_until_the_flight_is_over() {
        let shared = flight(Some(OWED));
        tell(&shared, &Arc::new(AtomicU32::new(Mode::GUIDED.0)));
        let working = Arc::clone(&shared);
        thread::spawn(move || {
            for _ in 0..40 {
                working.ticks.fetch_add(1, Ordering::Relaxed);
                thread::sleep(Duration::from_millis(50));
            }
            working.over.store(true, Ordering::Relaxed);
        });
        let (ended, parcels) = watched(&shared);
        assert!(!ended && shared.is_over());
        assert!(parcels.try_recv().is_err());
    }

    #[test]
    fn an_ended_thread_has_its_mode_restored_and_then_nothing_is_left_to_do() {
        let shared = flight(Some(OWED));
        let mode = Arc::new(AtomicU32::new(Mode::GUIDED.0));
        tell(&shared, &mode);
        let (to, parcels) = sync_channel(64);
        let vehicle = thread::spawn(move || {
            let parcel: Parcel = parcels
                .recv()
                .expect("a command before the sender is dropped");
            mode.store(Mode::AUTO.0, Ordering::Relaxed);
            parcel.change.expect("a command of another mode")
        });
        stand_in(&shared, &to, None);
        drop(to);
        let change = vehicle.join().expect("the command");
        assert_eq!((change.from, change.to), (Mode::GUIDED, Mode::AUTO));
        shared.over.store(true, Ordering::Relaxed);
    }
}

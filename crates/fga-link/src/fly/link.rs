//! The threads that read and write the link.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Instant;

use mavlink::{MAVLinkV2MessageRaw, MavHeader};

use super::shared::FlightShared;
use crate::authority::Owed;
use crate::commands::VehicleCommand;
use crate::endpoint::{LinkRead, LinkReader, LinkWriter};
use crate::mode::ModeChange;
use crate::outgoing::OWN_COMPONENT;
use crate::wire::{Framer, Signing, WireFrame, encode};

/// A longer turn of the reading thread was a pause of the whole program: the data that waits in the
/// socket is history.
const PAUSED: Duration = Duration::from_secs(1);
/// Interval at which the writing thread checks for the end of the flight.
const LOOK: Duration = Duration::from_millis(100);

/// A frame on its way out.
#[derive(Debug)]
pub(super) struct Parcel {
    /// The frame.
    pub(super) raw: MAVLinkV2MessageRaw,
    /// A command of another mode, sent only while the vehicle is in the mode that it leaves.
    pub(super) change: Option<ModeChange>,
}

impl Parcel {
    /// The command that restores the owed mode, outside of the companion.
    pub(super) fn restoring(owed: Owed, signing: Option<&Signing>) -> Self {
        let message =
            VehicleCommand::set_mode(owed.previous, owed.owned).message(owed.system_id, 0);
        let header = MavHeader {
            system_id: u32::from(owed.system_id),
            component_id: OWN_COMPONENT,
            sequence: 0,
        };
        Self {
            raw: encode(header, &message, signing),
            change: Some(ModeChange {
                from: owed.owned,
                to: owed.previous,
            }),
        }
    }
}

/// Reads the link until the flight is over; `sink` takes each valid frame and its time.
pub(super) fn read(
    shared: &FlightShared,
    mut reader: LinkReader,
    signing: Option<&Signing>,
    mut sink: impl FnMut(WireFrame, f64),
) {
    let mut framer = Framer::new(signing.cloned());
    let mut buffer = vec![0; 4096];
    let mut turned = Instant::now();
    while !shared.is_over() {
        let received = reader.read(&mut buffer);
        let paused = turned.elapsed() > PAUSED;
        turned = Instant::now();
        if paused {
            reader.drain(&mut buffer);
            framer.reset();
            shared.forget_heard();
            continue;
        }
        match received {
            LinkRead::Bytes(count) => {
                let bytes = buffer.get(..count).unwrap_or_default();
                let now_s = shared.now_s();
                let mut from_vehicle = false;
                framer.push(bytes, |frame| {
                    from_vehicle |= shared.hear(frame.header, &frame.message, now_s);
                    sink(frame, now_s);
                });
                if let Some(system_id) = framer.counts().version1 {
                    shared.version1.store(system_id, Ordering::Relaxed);
                }
                if let Some(refusal) = signing.and_then(Signing::refusal_to_tell) {
                    shared.trouble(refusal.words().to_owned());
                }
                if from_vehicle {
                    reader.answer_sender();
                }
                if reader.is_datagrams() {
                    framer.reset();
                }
            }
            LinkRead::NewConnection => framer.reset(),
            LinkRead::Nothing => {}
        }
    }
}

/// Writes frames until the flight is over. Checks a command of another mode here, at the last moment.
pub(super) fn write(shared: &FlightShared, writer: &LinkWriter, parcels: &Receiver<Parcel>) {
    loop {
        match parcels.recv_timeout(LOOK) {
            Ok(parcel) => {
                if parcel.change.is_none_or(|change| shared.asks(change)) {
                    writer.write(parcel.raw.raw_bytes());
                }
            }
            Err(RecvTimeoutError::Timeout) if !shared.is_over() => {}
            Err(_) => break,
        }
    }
}

/// Hands a frame to the writing thread, or drops it if the queue is full.
pub(super) fn post(to: &SyncSender<Parcel>, parcel: Parcel) -> bool {
    to.try_send(parcel).is_ok()
}

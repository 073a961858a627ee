//! Outgoing messages and their sender ids.

use mavlink::dialects::ardupilotmega::MavMessage;

use crate::mode::ModeChange;

/// Component id of obstacle avoidance (`MAV_COMP_ID_OBSTACLE_AVOIDANCE`).
pub const OWN_COMPONENT: u8 = 196;
/// Component id of the autopilot.
pub const AUTOPILOT: u8 = 1;

/// Ids of a receiver of traffic, in the telemetry log and of the player: `MAV_COMP_ID_ADSB`.
pub(crate) const RECEIVER_SYSTEM: u8 = 200;
pub(crate) const RECEIVER_COMPONENT: u8 = 156;
/// Time to wait for the vehicle's answer to a command or a request of an item before it is sent again, seconds.
pub(crate) const ANSWER_S: f64 = 0.4;

/// A message to send.
#[derive(Debug, Clone, PartialEq)]
pub struct Outgoing {
    /// System id of the sender.
    pub system_id: u8,
    /// The message.
    pub message: MavMessage,
    /// A command of another mode, sent only while the vehicle is in the mode that it leaves.
    pub change: Option<ModeChange>,
}

/// Most messages in the queue; further ones are dropped.
const MOST_WAITING: usize = 256;

/// Messages waiting to be sent.
#[derive(Debug, Default)]
pub struct Outbox {
    own_system: u8,
    waiting: Vec<Outgoing>,
    /// Number of dropped messages.
    pub dropped: u64,
}

impl Outbox {
    /// Sets the sender's system id: the vehicle's.
    pub(crate) fn set_own_system(&mut self, system_id: u8) {
        self.own_system = system_id;
    }

    /// Adds a message under our identity.
    pub(crate) fn send(&mut self, message: MavMessage) {
        self.send_as(self.own_system, message);
    }

    /// Adds a message under another system's identity.
    pub(crate) fn send_as(&mut self, system_id: u8, message: MavMessage) {
        if self.waiting.len() < MOST_WAITING {
            self.waiting.push(Outgoing {
                system_id,
                message,
                change: None,
            });
        } else {
            self.dropped += 1;
        }
    }

    /// Adds a command of another mode. It goes first: it must not wait behind the others.
    pub(crate) fn send_change(&mut self, change: ModeChange, message: MavMessage) {
        let urgent = Outgoing {
            system_id: self.own_system,
            message,
            change: Some(change),
        };
        self.waiting.insert(0, urgent);
        if self.waiting.len() > MOST_WAITING {
            self.waiting.pop();
            self.dropped += 1;
        }
    }

    /// Takes the waiting messages.
    pub fn take(&mut self) -> Vec<Outgoing> {
        core::mem::take(&mut self.waiting)
    }
}

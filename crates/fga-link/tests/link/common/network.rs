//! A bad network: packets that are lost, late, doubled.

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAVLinkV2MessageRaw, MavHeader};

/// The network's effect on packets.
#[derive(Debug, Clone, Copy)]
pub struct Network {
    pub loss: f64,
    pub delay_s: f64,
    pub jitter_s: f64,
    pub copies: f64,
}

pub const GOOD: Network = Network {
    loss: 0.0,
    delay_s: 0.01,
    jitter_s: 0.0,
    copies: 0.0,
};
/// 5 % lost, up to 200 ms late and so out of order, 3 % twice.
pub const BAD: Network = Network {
    loss: 0.05,
    delay_s: 0.02,
    jitter_s: 0.2,
    copies: 0.03,
};

pub(super) struct Packet {
    pub(super) due_us: u64,
    pub(super) number: u64,
    pub(super) to_vehicle: bool,
    pub(super) header: MavHeader,
    pub(super) message: MavMessage,
    /// Its frame, on a signed link.
    pub(super) signed: Option<MAVLinkV2MessageRaw>,
}

impl PartialEq for Packet {
    fn eq(&self, other: &Self) -> bool {
        (self.due_us, self.number) == (other.due_us, other.number)
    }
}
impl Eq for Packet {}
impl PartialOrd for Packet {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Packet {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (other.due_us, other.number).cmp(&(self.due_us, self.number))
    }
}

//! Does somebody else command the vehicle in the mode that the companion flies it in?
//!
//! No heartbeat shows it: the mode stays GUIDED. The vehicle's own target does, because the companion's attitudes and headings leave the
//! target where GUIDED began; and so does a command that is heard on its way.

use fga::Vec3;
use mavlink::dialects::ardupilotmega::{MavCmd, MavMessage};

use crate::mode::Mode;

/// The vehicle's target is the one of GUIDED from this long after the change of mode, milliseconds of its clock.
const SETTLES_MS: u32 = 700;
/// The target of GUIDED stays within this, metres.
const STAYS_M: f64 = 15.0;

/// The vehicle's targets in the manoeuvre, metres, local frame.
#[derive(Debug, Default)]
pub(super) struct OtherOrders {
    /// The vehicle's clock when the mode was confirmed, milliseconds.
    confirmed_ms: Option<u32>,
    first_m: Option<Vec3>,
    last_m: Vec3,
}

impl OtherOrders {
    /// Takes a target, and when the vehicle reported it, milliseconds of its clock; `boot_ms` is the newest time of that clock. Whether
    /// somebody else has set it: twice in a row it is another one than at first.
    pub(super) fn is_set_by_others(&mut self, target_m: Vec3, at_ms: u32, boot_ms: u32) -> bool {
        let confirmed_ms = *self.confirmed_ms.get_or_insert(boot_ms);
        if at_ms < confirmed_ms.saturating_add(SETTLES_MS) {
            return false;
        }
        let off_m = |from_m: Vec3| (target_m - from_m).truncate().length();
        let first_m = *self.first_m.get_or_insert(target_m);
        let stays_m = off_m(core::mem::replace(&mut self.last_m, target_m));
        off_m(first_m) > STAYS_M && stays_m <= STAYS_M
    }
}

/// Whether a message from another system orders something of a vehicle in the mode of the manoeuvre.
pub(super) fn is_order(message: &MavMessage, vehicle: Option<u8>, mode: Mode) -> bool {
    let is_ours = |system: u8| vehicle == Some(system);
    match message {
        MavMessage::SET_MODE(data) => is_ours(data.target_system) && data.custom_mode == mode.0,
        MavMessage::COMMAND_LONG(data) => {
            is_ours(data.target_system)
                && data.command == MavCmd::MAV_CMD_DO_SET_MODE
                && f64::from(data.param2) == f64::from(mode.0)
        }
        MavMessage::COMMAND_INT(data) => {
            is_ours(data.target_system) && data.command == MavCmd::MAV_CMD_DO_REPOSITION
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_that_moves_and_stays_there_is_somebody_elses() {
        let mut others = OtherOrders::default();
        let mut takes =
            |x_m: f64, at_ms| others.is_set_by_others(Vec3::new(x_m, 0.0, 90.0), at_ms, 1000);
        // Of the mode before, reported before the change or soon after it.
        assert!(!takes(900.0, 990) && !takes(900.0, 1600));
        assert!(!takes(40.0, 1700) && !takes(54.0, 2200));
        assert!(!takes(900.0, 2700), "one may be late");
        assert!(!takes(40.0, 3200) && !takes(900.0, 3700) && takes(905.0, 4200));
    }
}

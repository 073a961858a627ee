//! Does somebody else command the vehicle in the mode that the companion flies it in?
//!
//! No heartbeat shows it: the mode stays GUIDED. The vehicle's own target does, because the companion's attitudes and headings leave the
//! target where GUIDED began; and so does a command that is heard on its way.

use fga::Vec3;
use mavlink::dialects::ardupilotmega::{MavCmd, MavMessage, POSITION_TARGET_GLOBAL_INT_DATA};

use super::Companion;
use crate::authority::{Authority, Fault};
use crate::mode::Mode;
use crate::number::place_from_e7;

/// The vehicle's target is the one of GUIDED from this long after the change of mode, seconds.
const SETTLES_S: f64 = 0.7;
/// The target of GUIDED stays within this, metres.
const STAYS_M: f64 = 15.0;
/// The target of GUIDED begins within this of the aircraft, metres: the way in the time in which the change is confirmed.
const BEGINS_M: f64 = 200.0;

/// The vehicle's target in the manoeuvre.
#[derive(Debug, Default)]
pub(super) struct OtherOrders {
    /// Where the companion took over, metres, local frame.
    began_m: Option<Vec3>,
    /// The first target of the manoeuvre, metres.
    first_m: Option<Vec3>,
}

impl OtherOrders {
    /// A manoeuvre begins at a place, metres; `None` where it goes on from before.
    pub(super) const fn begin(&mut self, began_m: Option<Vec3>) {
        self.began_m = began_m;
        self.first_m = None;
    }

    /// Takes the vehicle's target, metres; whether somebody else has set it.
    fn is_set_by_others(&mut self, target_m: Vec3) -> bool {
        let off_m = |from_m: &Vec3| (target_m - from_m).truncate().length();
        let first_m = *self.first_m.get_or_insert(target_m);
        off_m(&first_m) > STAYS_M || self.began_m.as_ref().map_or(0.0, off_m) > BEGINS_M
    }
}

impl Companion {
    /// Takes the vehicle's target: one that moves while the companion commands is somebody else's order.
    pub(super) fn watch_target(&mut self, data: &POSITION_TARGET_GLOBAL_INT_DATA, now_s: f64) {
        let Authority::InCommand { since_s, .. } = self.keeper.state() else {
            return;
        };
        let place = place_from_e7(data.lat_int, data.lon_int, 0.0);
        let Some((place, frame)) = place.zip(self.ownship.frame()) else {
            return;
        };
        let target_m = frame.to_local_m(place);
        if self.keeper.target() == Mode::GUIDED
            && now_s - since_s >= SETTLES_S
            && self.others.is_set_by_others(target_m)
        {
            self.fault(Fault::OthersCommand, now_s);
        }
    }

    /// Takes a message to the vehicle from another system: an order in the mode of the manoeuvre ends the manoeuvre.
    pub(super) fn overhear(&mut self, message: &MavMessage, now_s: f64) {
        let (own, target) = (self.vehicle_system(), self.keeper.target());
        let is_ours = |system: u8| own == Some(system);
        let orders = match message {
            MavMessage::SET_MODE(data) => {
                is_ours(data.target_system) && data.custom_mode == target.0
            }
            MavMessage::COMMAND_LONG(data) => {
                let sets_mode = data.command == MavCmd::MAV_CMD_DO_SET_MODE;
                is_ours(data.target_system)
                    && sets_mode
                    && f64::from(data.param2) == f64::from(target.0)
            }
            MavMessage::COMMAND_INT(data) => {
                is_ours(data.target_system) && data.command == MavCmd::MAV_CMD_DO_REPOSITION
            }
            _ => false,
        };
        if orders && matches!(self.keeper.state(), Authority::InCommand { .. }) {
            self.fault(Fault::OthersCommand, now_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_that_moves_or_begins_far_away_is_somebody_elses() {
        let mut others = OtherOrders::default();
        others.begin(Some(Vec3::ZERO));
        assert!(!others.is_set_by_others(Vec3::X * 40.0));
        assert!(!others.is_set_by_others(Vec3::new(54.0, 0.0, 90.0)));
        assert!(others.is_set_by_others(Vec3::X * 56.0));
        others.begin(Some(Vec3::ZERO));
        assert!(others.is_set_by_others(Vec3::X * 201.0));
        others.begin(None);
        assert!(!others.is_set_by_others(Vec3::X * 201.0));
    }
}

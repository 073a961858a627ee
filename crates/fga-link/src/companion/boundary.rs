//! What of the vehicle's fence binds a manoeuvre?

use fga::Vec3;
use fga::zone::Zone;
use fga_formats::geodesy::LocalFrame;
use mavlink::dialects::ardupilotmega::{MavSysStatusSensor, SYS_STATUS_DATA};
use serde_json::json;

use super::voice::Voice;
use crate::authority::Severity;
use crate::mission::ListItem;
use crate::number;
use crate::parameters::VehicleParameters;
use crate::traffic::fence::VehicleFence;

/// Bit of `FENCE_TYPE`: circles and polygons.
const FENCE_TYPE_PLACES: u16 = 4;
/// Bit of `FENCE_OPTIONS`: the vehicle may be in any of the areas to stay in.
const FENCE_OPTIONS_JOINED: u16 = 2;
/// `FENCE_ACTION`: to the return point in GUIDED, with the pilot's throttle or not.
const FENCE_ACTS_IN_GUIDED: [f64; 2] = [6.0, 7.0];

/// The fence in the local frame.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    fence: VehicleFence,
    /// Its number among the fences that were read; 0 before the first.
    number: u32,
    /// Whether the vehicle's status says that its fence is enabled.
    enabled: Option<bool>,
    /// The mission and the fence of the report that one crosses the other.
    told_crossing: Option<(u32, u32)>,
}

impl Boundary {
    /// The local frame has moved.
    pub(super) fn forget(&mut self) {
        self.fence = VehicleFence::default();
        self.number = 0;
    }

    /// Takes the vehicle's status.
    pub(super) const fn take_status(&mut self, data: &SYS_STATUS_DATA) {
        let fence = MavSysStatusSensor::MAV_SYS_STATUS_GEOFENCE;
        self.enabled = Some(data.onboard_control_sensors_enabled.contains(fence));
    }

    /// Lays a fence that has been read, unless it is the present one; `true` if there is now any zone that is new.
    pub(super) fn lay(
        &mut self,
        (items, number): (&[ListItem], u32),
        frame: &LocalFrame,
        voice: &mut Voice,
    ) -> bool {
        let before = core::mem::replace(&mut self.number, number);
        if before == number {
            return false;
        }
        self.fence = VehicleFence::new(items, frame);
        let incomplete = self.fence.incomplete;
        let content = json!({ "items": items.len(), "incomplete": incomplete });
        voice.note("fence", content);
        if before > 0 {
            voice.tell(Severity::Notice, "fga: the fence has changed");
        }
        if incomplete {
            voice.warn("fga: part of the fence was not understood");
        }
        self.fence.zones().next().is_some()
    }

    /// Whether the stored fence counts for the vehicle. Its status says so, also where the mission or a switch enabled
    /// it; a fence that only reports has no status.
    fn is_active(&self, parameters: &VehicleParameters) -> bool {
        let value = |name| parameters.get(name);
        let is_enabled = value("FENCE_ENABLE").is_none_or(|enabled| enabled != 0.0);
        let is_enabled = match self.enabled {
            Some(enabled) if value("FENCE_ACTION") != Some(0.0) => enabled,
            _ => is_enabled,
        };
        let bars_places =
            value("FENCE_TYPE").is_none_or(|kinds| number::to_u16(kinds) & FENCE_TYPE_PLACES != 0);
        is_enabled && bars_places
    }

    /// What of the fence binds at a place, metres; nothing while it does not count.
    pub(super) fn zones(&self, parameters: &VehicleParameters, own_m: Vec3) -> Vec<Zone<'_>> {
        if self.is_active(parameters) {
            self.fence.binding(is_joined(parameters), own_m)
        } else {
            Vec::new()
        }
    }

    /// Whether a place, metres, is outside of the fence.
    pub(super) fn is_outside(&self, own_m: Vec3, parameters: &VehicleParameters) -> bool {
        let zones = self.zones(parameters, own_m);
        zones.iter().any(|zone| zone.is_entered(own_m))
    }

    /// Tells once where the rest of the mission of a number, from here on, crosses the fence.
    pub(super) fn watch_crossing(
        &mut self,
        mission: u32,
        way_m: &[Vec3],
        parameters: &VehicleParameters,
        voice: &mut Voice,
    ) {
        let lists = Some((mission, self.number));
        let Some(own_m) = way_m.first() else { return };
        if self.told_crossing == lists || self.zones(parameters, *own_m).is_empty() {
            return;
        }
        if self.fence.is_crossed(is_joined(parameters), way_m) {
            self.told_crossing = lists;
            voice.warn("fga: the mission crosses the fence: flown as it is");
        }
    }
}

/// Whether the vehicle joins the areas to stay in.
fn is_joined(parameters: &VehicleParameters) -> bool {
    let options = parameters.get("FENCE_OPTIONS");
    options.is_some_and(|bits| number::to_u16(bits) & FENCE_OPTIONS_JOINED != 0)
}

/// Whether the fence flies the vehicle in GUIDED: that mode would not be the companion's alone.
pub(super) fn acts_in_guided(parameters: &VehicleParameters) -> bool {
    let value = |name| parameters.get(name).unwrap_or(0.0);
    value("FENCE_ENABLE") != 0.0 && FENCE_ACTS_IN_GUIDED.contains(&value("FENCE_ACTION"))
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega::PARAM_VALUE_DATA;

    use super::*;

    #[test]
    fn the_fence_counts_by_the_vehicles_status_unless_it_only_reports() {
        let (mut boundary, mut parameters) = (Boundary::default(), VehicleParameters::default());
        let set = |parameters: &mut VehicleParameters, name: &str, value| {
            let data = PARAM_VALUE_DATA {
                param_id: name.into(),
                param_value: value,
                ..PARAM_VALUE_DATA::DEFAULT
            };
            assert!(parameters.take(&data), "{name}");
        };
        assert!(boundary.is_active(&parameters), "nothing is known");
        set(&mut parameters, "FENCE_ENABLE", 0.0);
        assert!(!boundary.is_active(&parameters) && !acts_in_guided(&parameters));
        boundary.take_status(&SYS_STATUS_DATA {
            onboard_control_sensors_enabled: MavSysStatusSensor::MAV_SYS_STATUS_GEOFENCE,
            ..SYS_STATUS_DATA::DEFAULT
        });
        assert!(boundary.is_active(&parameters), "a switch enabled it");
        set(&mut parameters, "FENCE_ACTION", 0.0);
        assert!(!boundary.is_active(&parameters), "it only reports");
        set(&mut parameters, "FENCE_ACTION", 6.0);
        // Heights alone: no place is barred.
        set(&mut parameters, "FENCE_TYPE", 1.0);
        assert!(!boundary.is_active(&parameters));
        set(&mut parameters, "FENCE_ENABLE", 1.0);
        assert!(acts_in_guided(&parameters));
    }
}

//! Where does the vehicle itself say that it flies, and does its mission say the same?

use fga::Vec3;
use mavlink::dialects::ardupilotmega::{
    NAV_CONTROLLER_OUTPUT_DATA, POSITION_TARGET_GLOBAL_INT_DATA,
};

use crate::number::place_from_e7;
use crate::ownship::OwnshipEstimate;

/// The vehicle's target belongs to its present mode from this long after a change of mode, s.
const MODE_SETTLES_S: f64 = 0.7;
/// An older target is unknown, seconds.
const TARGET_LIFETIME_S: f64 = 2.5;
/// Least distance between the target and the item's position that shows another item, metres.
const OTHER_TARGET_M: f64 = 15.0;
/// Accuracy of a target from distance and bearing in whole metres and degrees, metres and as a share of the distance.
const BEARING_TARGET_M: f64 = 60.0;
const BEARING_TARGET_SHARE: f64 = 0.03;
/// The target disagrees only after this time: item and target arrive at different moments, seconds.
const DISAGREES_S: f64 = 1.2;

/// A reported target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reported {
    position_m: Vec3,
    /// Its accuracy, metres.
    within_m: f64,
}

/// The vehicle's own target.
#[derive(Debug)]
pub(super) struct OwnTarget {
    last: Option<(Reported, f64)>,
    mode_since_s: f64,
    disagrees_since_s: Option<f64>,
}

impl Default for OwnTarget {
    fn default() -> Self {
        Self {
            last: None,
            mode_since_s: f64::NEG_INFINITY,
            disagrees_since_s: None,
        }
    }
}

impl OwnTarget {
    /// The mode has changed, and so the target.
    pub(super) const fn mode_changed(&mut self, now_s: f64) {
        self.mode_since_s = now_s;
        self.last = None;
        self.disagrees_since_s = None;
    }

    fn present(&self, now_s: f64) -> Option<Reported> {
        let last = self.last.filter(|last| now_s - last.1 <= TARGET_LIFETIME_S);
        last.map(|(reported, _)| reported)
    }

    /// The target in the present mode, metres, local frame.
    pub(super) fn position_m(&self, now_s: f64) -> Option<Vec3> {
        self.present(now_s).map(|reported| reported.position_m)
    }

    /// Whether item and target have disagreed for too long to be only messages from different moments.
    pub(super) fn disagrees(&self, now_s: f64) -> bool {
        self.disagrees_since_s
            .is_some_and(|since_s| now_s - since_s >= DISAGREES_S)
    }

    /// The target in a message that names its place.
    pub(super) fn of_place(
        data: &POSITION_TARGET_GLOBAL_INT_DATA,
        ownship: &OwnshipEstimate,
    ) -> Option<Reported> {
        let place = place_from_e7(data.lat_int, data.lon_int, 0.0)?;
        Some(Reported {
            position_m: ownship.frame()?.to_local_m(place),
            within_m: OTHER_TARGET_M,
        })
    }

    /// The target in a message that has its distance and bearing; `None` where a better one is known.
    pub(super) fn of_bearing(
        &self,
        data: &NAV_CONTROLLER_OUTPUT_DATA,
        ownship: &OwnshipEstimate,
        now_s: f64,
    ) -> Option<Reported> {
        let exact = self
            .present(now_s)
            .is_some_and(|reported| reported.within_m <= OTHER_TARGET_M);
        // Distances beyond 65 km do not fit the message.
        let usable = data.wp_dist > 0 && data.wp_dist < u16::MAX;
        let own_m = ownship.position_m(now_s).filter(|_| usable && !exact)?;
        let distance_m = f64::from(data.wp_dist);
        let (sin, cos) = f64::from(data.target_bearing).to_radians().sin_cos();
        Some(Reported {
            position_m: own_m + Vec3::new(sin, cos, 0.0) * distance_m,
            within_m: BEARING_TARGET_M + BEARING_TARGET_SHARE * distance_m,
        })
    }

    /// Takes a target, and the place of the mission's present item where the vehicle flies its mission; whether they
    /// differ.
    pub(super) fn take(
        &mut self,
        reported: Option<Reported>,
        item_m: Option<Vec3>,
        now_s: f64,
    ) -> bool {
        let Some(reported) = reported.filter(|_| now_s - self.mode_since_s >= MODE_SETTLES_S)
        else {
            return false;
        };
        self.last = Some((reported, now_s));
        let off =
            |place_m: Vec3| (place_m - reported.position_m).truncate().length() > reported.within_m;
        let is_off = item_m.is_some_and(off);
        if is_off {
            self.disagrees_since_s.get_or_insert(now_s);
        } else {
            self.disagrees_since_s = None;
        }
        is_off
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_beside_the_item_disagrees_after_a_while_and_counts_for_a_while() {
        let mut target = OwnTarget::default();
        let reported = Some(Reported {
            position_m: Vec3::X * 100.0,
            within_m: 15.0,
        });
        target.mode_changed(0.0);
        assert!(!target.take(reported, Some(Vec3::ZERO), 0.5));
        assert_eq!(
            target.position_m(0.5),
            None,
            "the target of the mode before"
        );
        assert!(target.take(reported, Some(Vec3::ZERO), 1.0));
        assert!(!target.disagrees(2.1) && target.disagrees(2.2));
        assert_eq!(target.position_m(3.5), Some(Vec3::X * 100.0));
        assert_eq!(target.position_m(3.6), None);
        // 10 m beside it is the same; without an item nothing disagrees.
        assert!(!target.take(reported, Some(Vec3::X * 110.0), 4.0));
        assert!(!target.disagrees(9.0));
        assert!(!target.take(reported, None, 10.0));
    }
}

//! Reports without a vertical rate: the climb follows from the altitudes, and nobody calls the velocity false.

use mavlink::dialects::ardupilotmega::AdsbFlags;

use crate::claims::{PROTECTED_M, flown, lead_s};
use crate::common::Intruder;

#[test]
fn an_aircraft_without_a_vertical_rate_climbs_as_its_altitudes_do() {
    for climb_mps in [-6.0, -3.0, 3.0, 6.0, 10.0] {
        for interval_s in [0.5, 1.0] {
            // It meets ours after a minute, at its height.
            let from_m = [5.0, 3000.0, 100.0 - 60.0 * climb_mps];
            let intruder = Intruder::straight(0x00AB_CDEF, from_m, [0.0, -25.0, climb_mps]);
            let control = flown(intruder, interval_s, 1013.25, false, |_| {});
            let without = flown(intruder, interval_s, 1013.25, false, |data| {
                data.ver_velocity = 0;
                data.flags
                    .remove(AdsbFlags::ADSB_FLAGS_VERTICAL_VELOCITY_VALID);
            });
            let texts = without.world.emulator.texts();
            let is_false = texts.iter().any(|text| text.contains("false velocity"));
            let (with_s, without_s) = (lead_s(&control), lead_s(&without));
            let least_m = without.world.least_m[0].0;
            eprintln!(
                "{climb_mps} {interval_s}: {without_s:.1} s of {with_s:.1} s, {least_m:.1} m, false {is_false}"
            );
            assert!(!is_false, "{climb_mps} m/s each {interval_s} s");
            assert!(
                without_s >= 0.8 * with_s,
                "{climb_mps} m/s each {interval_s} s: {without_s} s of {with_s} s"
            );
            assert!(
                least_m >= PROTECTED_M,
                "{climb_mps} m/s each {interval_s} s: {least_m} m"
            );
        }
    }
}

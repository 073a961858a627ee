//! One encounter on a good network: does it fly at all?

use crate::common::{GOOD, Intruder, World};
use fga_emulator::PlaneMode;
use fga_link::authority::Authority;

#[test]
fn a_head_on_intruder_is_avoided_and_the_mission_resumed() {
    let mut world = World::new("", GOOD, 1);
    let mut intruder = Intruder::straight(0x00AB_CDEF, [0.0, 3000.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 1000.0;
    world.add(intruder);
    world.run_while(40.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
    let mut largest_m = 0.0_f64;
    while world.time_s < 110.0 {
        world.step();
        largest_m = largest_m.max(world.off_leg().0);
    }
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert_eq!(world.emulator.mission_item(), 2);
    assert_eq!(world.emulator.mode_changes().len(), 2);
    assert!(largest_m < 90.0, "{largest_m}");
}

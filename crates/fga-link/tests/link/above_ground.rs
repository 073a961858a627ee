//! The height above the ground, here and ahead, as the status line and the live page have it.

use alloc::sync::Arc;

use fga_emulator::EmulatorSettings;
use fga_formats::terrain::Terrain;
use fga_link::authority::Authority;

use crate::common::World;
use crate::terrain::{head_on, tile};

/// A plateau 50 m above the sea that the mission flies over, 2 km north of home.
fn plateau() -> Arc<Terrain> {
    tile(|_, north_m| {
        Some(if (2000.0..2300.0).contains(&north_m) {
            50
        } else {
            4
        })
    })
}

fn is_in_command(world: &World) -> bool {
    matches!(world.companion.authority(), Authority::InCommand { .. })
}

#[test]
fn the_status_line_has_the_height_above_the_ground_and_the_least_ahead() {
    let mut world = head_on(EmulatorSettings::default(), Some(&plateau()));
    let line = |world: &World| world.companion.status_line(world.time_s);
    // The mission is 104 m above the sea.
    let (mut ahead, mut evading) = (false, false);
    while world.time_s < 130.0 && !(ahead && evading) {
        world.step();
        let Some(picture) = world.companion.picture() else {
            assert!(!line(&world).contains("ground"), "{}", line(&world));
            continue;
        };
        let Some(above) = picture.above_ground else {
            continue;
        };
        assert!(
            line(&world).contains(&above.to_string()),
            "{}",
            line(&world)
        );
        let here_m = above.here_m.expect("known ground");
        let (least_m, in_s) = above.least.expect("known ground");
        assert!(above.unknown_s.is_none() && least_m <= here_m && in_s <= 60.0);
        let north_m = world.emulator.plant().position_m()[1];
        let speed_mps = picture.own.ground_velocity_mps.length();
        let left_s = (2000.0 - north_m) / speed_mps;
        if !is_in_command(&world) && (20.0..45.0).contains(&left_s) {
            ahead = true;
            assert!((95.0..105.0).contains(&here_m), "{here_m}");
            assert!((50.0..58.0).contains(&least_m), "{least_m}");
            // A post stands each 90 m, and those beside an edge are raised.
            let there_m = north_m + speed_mps * in_s;
            assert!((1850.0..2500.0).contains(&there_m), "{there_m}");
        }
        evading |= is_in_command(&world);
    }
    assert!(ahead && evading);
}

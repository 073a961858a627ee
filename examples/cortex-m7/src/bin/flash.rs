//! The avoider alone, as a firmware links it: what it takes of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

fga_cortex_m7::linked! {
    // Pointers that the compiler knows nothing of.
    let storage = black_box(null_mut());
    let mut avoider = null_mut();
    fga_avoider_init(
        storage,
        black_box(0),
        1,
        16,
        32,
        black_box(null_mut()),
        black_box(null_mut()),
        &raw mut avoider,
        null_mut(),
    );
    fga_avoider_set_mission(avoider, black_box(null_mut()), null_mut());
    fga_avoider_step(
        avoider,
        black_box(null_mut()),
        black_box(null_mut()),
        null_mut(),
    );
}

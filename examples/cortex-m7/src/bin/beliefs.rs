//! The avoider on beliefs, as a firmware links it: what it takes of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

fga_cortex_m7::linked! {
    let avoider = fga_cortex_m7::linked_avoider();
    let mut beliefs = null_mut();
    fga_beliefs_init(black_box(null_mut()), black_box(0), 1, &raw mut beliefs, null_mut());
    let here = fga_enu {
        east: 0.0,
        north: 0.0,
        up: black_box(0.0),
    };
    fga_beliefs_hear(
        beliefs,
        black_box(null_mut()),
        black_box(60.0),
        black_box(0.0),
        black_box(0.0),
        here,
        null_mut(),
    );
    fga_avoider_step_on_beliefs(
        avoider,
        beliefs,
        black_box(null_mut()),
        black_box(null_mut()),
        null_mut(),
    );
}

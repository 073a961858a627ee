//! The avoider alone, as a firmware links it: what it takes of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

fga_cortex_m7::linked! {
    let avoider = fga_cortex_m7::linked_avoider();
    fga_avoider_step(
        avoider,
        black_box(null_mut()),
        black_box(null_mut()),
        null_mut(),
    );
}

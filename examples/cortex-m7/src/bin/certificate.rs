//! The certificate alone, as a firmware links it: what it takes of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

fga_cortex_m7::linked! {
    // Pointers that the compiler knows nothing of.
    let storage = black_box(null_mut());
    let mut prover = null_mut();
    fga_prover_init(
        storage,
        black_box(0),
        1,
        black_box(null_mut()),
        &raw mut prover,
        null_mut(),
    );
    fga_certify(
        prover,
        black_box(null_mut()),
        black_box(null_mut()),
        black_box(1),
        black_box(null_mut()),
        black_box(null_mut()),
        null_mut(),
    );
    let still = fga_enu {
        east: 0.0,
        north: 0.0,
        up: 0.0,
    };
    fga_predict(
        prover,
        black_box(null_mut()),
        black_box(null_mut()),
        black_box(1),
        still,
        black_box(1.0),
        black_box(null_mut()),
        null_mut(),
    );
}

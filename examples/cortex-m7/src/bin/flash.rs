//! The avoider alone, as a firmware links it: what it takes of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use core::hint::black_box;
    use core::ptr::null_mut;
    use fga_c::*;
    // Pointers that the compiler knows nothing of: this program is linked, not run.
    let storage = black_box(null_mut());
    let mut avoider = null_mut();
    loop {
        // SAFETY: never run.
        unsafe {
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
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}

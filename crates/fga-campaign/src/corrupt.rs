//! The one place at which reading a corrupt Parquet file fails.
//!
//! The `parquet` crate panics on some corrupt files, where it expects of metadata what nothing has checked. Every
//! reader of this crate goes through [`guarded`], which makes an error of that.

use core::cell::Cell;
use core::panic::AssertUnwindSafe;
use std::panic::{catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether a panic of this thread is about a file, and needs no report of its own.
    static IS_ABOUT_A_FILE: Cell<bool> = const { Cell::new(false) };
}

/// Runs a part of a reader; `corrupt` makes the error of a panic's message.
pub(crate) fn guarded<T, E>(
    read: impl FnOnce() -> Result<T, E>,
    corrupt: impl FnOnce(&str) -> E,
) -> Result<T, E> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_ABOUT_A_FILE.get() {
                usual(panic);
            }
        }));
    });
    let before = IS_ABOUT_A_FILE.replace(true);
    let result = catch_unwind(AssertUnwindSafe(read));
    IS_ABOUT_A_FILE.set(before);
    result.unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<&str>().copied();
        let words = words.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        Err(corrupt(words.unwrap_or("it contradicts itself")))
    })
}

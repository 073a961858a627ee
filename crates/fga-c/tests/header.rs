//! The header that is committed is the one of this crate.

use std::path::Path;
use std::{env, fs};

#[test]
fn the_header_is_that_of_the_crate() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = folder.join("include/fga.h");
    let config = cbindgen::Config::from_root_or_default(folder);
    let made = cbindgen::generate_with_config(folder, config).expect("a header");
    let mut text = Vec::new();
    made.write(&mut text);
    let text = String::from_utf8(text).expect("a header in UTF-8");
    if env::var("HEADER").as_deref() == Ok("write") {
        fs::write(&path, &text).expect("a writable header");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == text,
        "include/fga.h is not that of the crate: HEADER=write cargo test -p fga-c --test header"
    );
}

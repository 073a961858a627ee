//! The header that is committed is the one of this crate.

use std::path::Path;
use std::{env, fs};

use fga::avoider::Settings;

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

/// The pages say the limit of zones that the header has.
#[test]
fn the_pages_say_the_limit_of_zones() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("a file");
    let header = read("include/fga.h");
    let limit = header
        .lines()
        .find_map(|line| line.strip_prefix("#define FGA_ZONES_MOST "))
        .expect("a limit");
    let zones = read("../../docs/how-to-zones.md");
    assert!(zones.contains(&format!("(in C more than {limit}, `FGA_ZONES_MOST`,")));
    let small = read("../../docs/how-to-microcontroller.md");
    assert!(small.contains(&format!("`FGA_ZONES_MOST` ({limit})")));
}

/// Each number of the settings has its default beside it.
#[test]
fn the_header_says_the_defaults() {
    let of = Settings::default();
    let header = include_str!("../include/fga.h");
    for (field, default) in [
        ("decision_period_s", of.decision_period_s),
        ("horizon_s", of.horizon_s),
        ("margin_m", of.margin_m),
        ("drift_mps", of.drift_mps),
        ("confidence_sigmas", of.confidence_sigmas),
        ("heading_cost", of.heading_cost),
        ("pitch_cost", of.pitch_cost),
        ("work_limit", of.work_limit.into()),
        ("loss_price_m", of.loss_price_m),
    ] {
        let said = ["double", "uint32_t"]
            .map(|kind| header.contains(&format!("by default {default}.\n  {kind} {field};")));
        assert!(said.contains(&true), "{field}: {default}");
    }
}

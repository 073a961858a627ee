//! Pictures and pages: `cargo test -p fga-report --test report overview::` runs the tests of one file.

mod cases;
mod charts;
mod overview;
mod plot;
mod well_formed;

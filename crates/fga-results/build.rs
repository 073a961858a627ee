//! Passes the target's name to the program, which writes it into `run.json`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Ok(target) = std::env::var("TARGET") {
        println!("cargo::rustc-env=FGA_TARGET={target}");
    }
}

//! Writes the overviews of the tests' runs into a folder.
//!
//! `cargo run -p fga-report --example overview_gallery -- FOLDER`

#[path = "../tests/report/cases.rs"]
mod cases;

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "gallery".into());
    std::fs::create_dir_all(&folder)?;
    for (name, overview) in cases::all() {
        std::fs::write(format!("{folder}/{name}.svg"), overview.to_svg())?;
    }
    Ok(())
}

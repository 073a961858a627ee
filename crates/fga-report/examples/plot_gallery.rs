//! Writes the charts and the report of the tests into a folder.
//!
//! `cargo run -p fga-report --example plot_gallery -- FOLDER`

#[path = "../tests/report/charts.rs"]
mod charts;

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "gallery".into());
    std::fs::create_dir_all(&folder)?;
    for (name, svg) in charts::all() {
        std::fs::write(format!("{folder}/{name}.svg"), svg)?;
    }
    std::fs::write(format!("{folder}/report.html"), charts::report().to_html())
}
